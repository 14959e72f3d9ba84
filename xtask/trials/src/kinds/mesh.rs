//! What mesh promises, on random problems.

mod bad_input;
mod polygons;
mod surface_files;

use crate::Kind;

/// The kinds of trials of mesh.
pub const KINDS: &[Kind] = &[
    Kind {
        name: "surface-files",
        krate: "mesh",
        rule: "a well-formed OBJ or MSH text refused, or read with other triangles, places or node \
               numbers than those written; a polygon whose triangles turn over or miss its area by \
               1e-9; a broken line accepted, or refused without its number",
        in_tests: 1500,
        trial: surface_files::trial,
    },
    Kind {
        name: "polygons",
        krate: "mesh",
        rule: "simple outlines refused, or others accepted, or other pairs of edges listed than whole \
               numbers find; area or inside off by 1e-12",
        in_tests: 1500,
        trial: polygons::trial,
    },
    Kind {
        name: "bad-input-mesh",
        krate: "mesh",
        rule: "a panic; Ok with a number that is not finite",
        in_tests: 1500,
        trial: bad_input::trial,
    },
];
