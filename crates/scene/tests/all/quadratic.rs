//! Elastic bodies of quadratic elements in scenes: their mass, their rest, their convergence, their
//! drawing, and what their file may not say.

use std::f64::consts::PI;
use std::path::Path;

use stationary_calculus::{Covector, Potential};
use stationary_scene::{Motion, Scene, SceneProblem};

fn scene(text: &str) -> Scene {
    Scene::parse("quadratic.toml", text).unwrap_or_else(|error| panic!("{error}"))
}

fn solid(dimension: usize, shape: &str, more: &str) -> String {
    format!(
        "dimension = {dimension}\nintegrator = \"stormer-verlet\"\nstep = 0.1\nhorizon = 1\n\
         [[solids]]\nname = \"it\"\nelement = \"quadratic\"\nshape = {{ {shape} }}\ndensity = 3\n\
         young = 100\n{more}\n"
    )
}

/// Shapes that fit into a dimension, with the key that says how thick they are, and their measure.
const STRAIGHT: [(usize, &str, &str, f64); 7] = [
    (1, "kind = \"bar\", size = [2], cells = [7]", "section = 0.1", 0.2),
    (1, "kind = \"bar\", size = [2], cells = [7], across = [-1]", "section = 0.1", 0.2),
    (2, "kind = \"bar\", size = [2], cells = [7], across = [3, 4]", "section = 0.1", 0.2),
    (
        2,
        "kind = \"rectangle\", size = [2, 1], cells = [3, 4], origin = [5, 6]",
        "thickness = 0.1",
        0.2,
    ),
    (
        2,
        "kind = \"rectangle\", size = [2, 1], cells = [3, 4], up = [0, -1]",
        "thickness = 0.1",
        0.2,
    ),
    (
        3,
        "kind = \"rectangle\", size = [2, 1], cells = [3, 4], up = [0, 0, 1]",
        "thickness = 0.1",
        0.2,
    ),
    (3, "kind = \"box\", size = [2, 1, 0.5], cells = [3, 2, 1]", "", 1.0),
];

/// A shape's measure, the largest force on it where it is laid, and its energy when drawn out by a
/// tenth along the first axis.
fn measured<const D: usize>(scene: &Scene) -> (f64, f64, f64) {
    let SceneProblem { system, initial, .. } = scene.problem().unwrap();
    let mut dv = Covector(vec![0.0; system.dim()]);
    system.potential().add_differential(&initial.q, dv.view_mut());
    let force = dv.0.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let stretch = |(i, x): (usize, &f64)| if i % D == 0 { 1.1 * x } else { *x };
    let q: Vec<f64> = initial.q.iter().enumerate().map(stretch).collect();
    let mass: f64 = system.metric().masses().iter().sum();
    (mass / (3.0 * D as f64), force, system.potential().energy(&q))
}

fn measured_in(dimension: usize, scene: &Scene) -> (f64, f64, f64) {
    match dimension {
        1 => measured::<1>(scene),
        2 => measured::<2>(scene),
        _ => measured::<3>(scene),
    }
}

#[test]
fn straight_bodies_weigh_and_stretch_as_their_shapes_say_and_are_at_rest_where_they_are_laid() {
    let strain: f64 = 0.5 * (1.1 * 1.1 - 1.0);
    for (dimension, shape, section, measure) in STRAIGHT {
        let (own, force, energy) =
            measured_in(dimension, &scene(&solid(dimension, shape, section)));
        assert!((own / measure - 1.0).abs() < 1e-12, "{shape}: {own}");
        assert!(force < 1e-11, "{shape}: {force:e}");
        // A bar that lies askew is drawn out by less.
        if !shape.contains("[3, 4]") || shape.contains("rectangle") {
            let expected = 0.5 * 100.0 * strain * strain * measure;
            assert!((energy / expected - 1.0).abs() < 1e-12, "{shape}: {energy}");
        }
    }
}

#[test]
fn round_bodies_are_curved_and_weigh_far_more_nearly_what_they_should() {
    for (dimension, shape, section, exact) in [
        (2, "kind = \"disc\", size = [1], cells = [4]", "thickness = 1", PI),
        (3, "kind = \"ball\", size = [1], cells = [2]", "", 4.0 / 3.0 * PI),
        (3, "kind = \"sphere\", size = [1], cells = [2]", "thickness = 1", 4.0 * PI),
        (3, "kind = \"torus\", size = [2, 0.5], cells = [24, 12]", "thickness = 1", 4.0 * PI * PI),
    ] {
        let quadratic = solid(dimension, shape, section);
        let linear = quadratic.replace("\"quadratic\"", "\"linear\"");
        let off = |text: &str| (measured_in(dimension, &scene(text)).0 / exact - 1.0).abs();
        let (curved, flat) = (off(&quadratic), off(&linear));
        assert!(curved < 1e-3 && curved < flat / 30.0, "{shape}: {curved:e} and {flat:e}");
        let (_, force, _) = measured_in(dimension, &scene(&quadratic));
        assert!(force < 1e-11, "{shape}: {force:e}");
    }
}

/// How far the tip of a short cantilever sags in cells along and across.
fn sag(element: &str, cells: [u32; 2]) -> f64 {
    let text = format!(
        "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.1\nhorizon = 1\n\
         uniform_gravity = {{ acceleration = [0, -9.81] }}\n[[solids]]\nname = \"beam\"\n\
         shape = {{ kind = \"rectangle\", size = [1, 0.2], cells = {cells:?} }}\n\
         element = \"{element}\"\nthickness = 0.1\ndensity = 1000\nmaterial = \"neo-hookean\"\n\
         young = 1e6\npoisson = 0.3\npinned = [\"left\"]\nhung = [\"left\"]\n\
         marks = {{ tip = [1, 0.1] }}\n"
    );
    let scene = scene(&text);
    let tip = scene.particles().iter().position(|p| p.name == "beam.tip").unwrap();
    let pinned = scene.particles()[..tip].iter().filter(|p| p.motion == Motion::Pinned).count();
    0.1 - scene.problem().unwrap().initial.q[2 * (tip - pinned) + 1]
}

#[test]
fn the_tip_of_a_cantilever_is_nearer_to_where_it_hangs_than_with_four_times_as_many_linear_cells() {
    let exact = sag("quadratic", [40, 8]);
    assert!(exact > 0.1, "{exact}");
    let off = |element: &str, cells| (sag(element, cells) / exact - 1.0).abs();
    let [coarse, fine] = [[5, 2], [10, 4]].map(|cells| off("quadratic", cells));
    let [coarse_linear, fine_linear] = [[10, 2], [20, 4]].map(|cells| off("linear", cells));
    println!("quadratic {coarse:.2e} {fine:.2e}, linear {coarse_linear:.2e} {fine_linear:.2e}");
    assert!(coarse < fine_linear / 5.0, "{coarse:e} and {fine_linear:e}");
    // Second order, and what a corner that is clamped leaves of fourth.
    assert!(coarse_linear / fine_linear > 2.5 && coarse / fine > 3.0);
}

#[test]
fn a_free_body_of_quadratic_elements_keeps_its_momenta() {
    let text = "dimension = 3\nintegrator = \"stormer-verlet\"\nstep = 0.0002\nhorizon = 0.1\n\
         [[solids]]\nname = \"it\"\nelement = \"quadratic\"\ndensity = 1000\nyoung = 1e5\n\
         poisson = 0.3\nmaterial = \"fixed-corotated\"\nvelocity = [1, 0.5, 0.3]\n\
         shape = { kind = \"box\", size = [1, 0.3, 0.2], cells = [3, 1, 1] }\n\
         struck = { at = [1, 0.3, 0.2], radius = 0.4, velocity = [0, 4, 0.3] }\n";
    let run = scene(text).run().unwrap();
    let strayed = |of: &[[f64; 3]]| {
        let far = |p: &[f64; 3]| (0..3).map(|c| (p[c] - of[0][c]).abs()).fold(0.0, f64::max);
        of.iter().map(far).fold(0.0, f64::max)
    };
    let [linear, angular] = run.momentum_scales();
    assert!(strayed(run.linear_momenta()) < 1e-12 * linear);
    assert!(strayed(run.angular_momenta()) < 1e-12 * angular);
    let energies = run.energies();
    let kinetic = run.kinetic_energies().iter().copied().fold(0.0, f64::max);
    let drift = energies.iter().map(|e| (e - energies[0]).abs()).fold(0.0, f64::max);
    assert!(drift < 1e-2 * kinetic, "{:e}", drift / kinetic);
}

#[test]
fn a_triangle_is_drawn_as_four_and_an_edge_as_two() {
    let sheet = scene(&solid(2, STRAIGHT[3].1, STRAIGHT[3].2));
    assert_eq!((sheet.solids()[0].simplices.len(), sheet.faces().len()), (24, 96));
    assert_eq!(sheet.particles().len(), 7 * 9);
    let block = scene(&solid(3, STRAIGHT[6].1, ""));
    // The box has 2 (3 x 2 + 3 x 1 + 2 x 1) squares of two triangles on its outside.
    assert_eq!(block.faces().len(), 4 * 44);
    let held = scene(&solid(2, STRAIGHT[3].1, "thickness = 0.1\npinned = [\"rim\"]"));
    let pinned = held.particles().iter().filter(|p| p.motion == Motion::Pinned).count();
    assert_eq!(pinned, 2 * (6 + 8), "nodes in the middle of the rim's edges, too");
    let left = scene(&solid(2, STRAIGHT[3].1, "thickness = 0.1\npinned = [\"left\"]"));
    let pinned = left.particles().iter().filter(|p| p.motion == Motion::Pinned).count();
    assert_eq!(pinned, 9);
}

fn folder(name: &str) -> std::path::PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("quadratic").join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn meshes_of_second_order_are_read_as_they_are_and_others_get_straight_middles() {
    let folder = folder("gmsh");
    let msh = |nodes: &str, elements: &str| {
        let count = |lines: &str| lines.lines().count();
        let (n, e) = (count(nodes), count(elements));
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{n}\n{nodes}\n$EndNodes\n$Elements\n{e}\n\
             {elements}\n$EndElements\n"
        )
    };
    // A triangle whose long side bulges by 0.1 along its normal: a parabola of area 2/3 c h more.
    let (c, h) = (2_f64.sqrt(), 0.1 * 2_f64.sqrt());
    let triangle = "1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0.5 0 0\n5 0.6 0.6 0\n6 0 0.5 0";
    std::fs::write(folder.join("curved.msh"), msh(triangle, "1 9 0 1 2 3 4 5 6")).unwrap();
    std::fs::write(folder.join("turned.msh"), msh(triangle, "1 9 0 1 3 2 6 5 4")).unwrap();
    std::fs::write(folder.join("straight.msh"), msh(triangle, "1 2 0 1 2 3")).unwrap();
    // Gmsh's edges of a tetrahedron: 01 12 20 30 23 13.
    let block = "1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 0.5 0 0\n6 0.5 0.5 0\n7 0 0.5 0\n8 0 0 0.5\n\
                 9 0 0.5 0.5\n10 0.5 0 0.5";
    std::fs::write(folder.join("block.msh"), msh(block, "1 11 0 1 2 3 4 5 6 7 8 9 10")).unwrap();
    std::fs::write(folder.join("one.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let read = |dimension: usize, file: &str, element: &str| {
        let section = if file == "block.msh" { "" } else { "thickness = 1" };
        let text = solid(dimension, &format!("file = \"{file}\""), section);
        let path = folder.join("scene.toml");
        std::fs::write(&path, text.replace("\"quadratic\"", element)).unwrap();
        Scene::read(&path).map_err(|error| error.to_string())
    };
    for (dimension, file, measure, nodes) in [
        (2, "curved.msh", 0.5 + 2.0 / 3.0 * c * h, 6),
        (2, "straight.msh", 0.5, 6),
        (3, "straight.msh", 0.5, 6),
        (3, "one.obj", 0.5, 6),
        (3, "block.msh", 1.0 / 6.0, 10),
    ] {
        let scene = read(dimension, file, "\"quadratic\"").unwrap();
        let (own, force, _) = measured_in(dimension, &scene);
        assert!((own / measure - 1.0).abs() < 1e-12, "{file}: {own} and {measure}");
        assert!(force < 1e-12, "{file}: {force}");
        assert_eq!(scene.particles().len(), nodes, "{file}");
    }
    for (dimension, file, element, message) in [
        (2, "curved.msh", "\"linear\"", "which only a solid with `element = \"quadratic\"` has"),
        (2, "block.msh", "\"quadratic\"", "its tetrahedra do not fit into the plane"),
        (2, "turned.msh", "\"quadratic\"", "turned inside out: 0"),
    ] {
        let error = read(dimension, file, element).expect_err(file);
        assert!(error.contains(message), "{error}");
    }
}

#[test]
fn quadratic_elements_that_cannot_be_are_refused_where_the_file_says_so() {
    let refused = |text: String, place: &str, message: &str| {
        let error = Scene::parse("a.toml", &text).map(|_| "nothing is wrong").unwrap_err();
        let error = error.to_string();
        assert!(error.contains(message) && error.contains(place), "{error}");
    };
    let sheet = "kind = \"rectangle\", size = [2, 1], cells = [3, 4]";
    refused(
        solid(3, sheet, "thickness = 0.1\nbending = 2"),
        "bending = 2",
        "a sheet of quadratic elements has no bending stiffness",
    );
    let text = solid(2, sheet, "thickness = 0.1");
    refused(
        text.replace("\"quadratic\"", "\"qadratic\""),
        "a.toml:7:11",
        "did you mean `quadratic`?",
    );
    refused(text.replace("element =", "elements ="), "a.toml:7:1", "did you mean `element`?");
    refused(text.replace("[3, 4]", "[600, 600]"), "cells", "particles; there may be at most");
    let heat = "dimension = 2\nintegrator = \"implicit-euler\"\nstep = 0.1\nhorizon = 1\n[heat]\n\
                name = \"it\"\nelement = \"quadratic\"\ndiffusivity = 1\n\
                shape = { kind = \"disc\", size = [1], cells = [3] }\n";
    refused(heat.to_owned(), "a.toml:7:1", "unknown field `element`");
}
