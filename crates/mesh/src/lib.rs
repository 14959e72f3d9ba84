//! What is a shape, to a computer, and how large, how round, how whole is it?
//!
//! ```text
//! x_a in R^D,  s = (a_1 ... a_K)                    vertices and simplices                (12, 13)
//! d [v0 ... vn] = sum (-1)^i [... vi-1 vi+1 ...]    facets, orientation, boundary         (7.2)
//! V - E + F - T                                     what a shape is made of
//! int 1, x, x x^T over simplices, closed outlines   mass, centre and inertia for
//!   and closed surfaces                               density one                 (7.1-7.3, 9.4)
//! x(l) = sum N_i(l) x_i                             curved elements                       (13)
//! cot alpha, A from edge lengths                    what a Laplacian needs                (15)
//! ```
//! `x` points (m) of `D` dimensions, `s` a segment, triangle or tetrahedron of `K` corners, `l`
//! barycentric coordinates. The numbers name sections of the notes.
//!
//! ```
//! use stationary_mesh::{ClosedSurface, Polygon, Quality, ball, icosphere};
//! use nalgebra::{Vector2};
//!
//! let plate = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]].map(Vector2::from);
//! assert_eq!(Polygon::new(vec![plate.to_vec()])?.moments().measure, 2.0);
//! let sphere = icosphere(1.0, 3)?;
//! assert_eq!(sphere.euler_characteristic(), 2);
//! let inside_out = ClosedSurface::new(sphere.reversed()).unwrap_err();
//! assert_eq!(inside_out.to_string(), "inside out: components of the simplices 0");
//! let central = ClosedSurface::new(sphere)?.moments().central().ok_or("empty")?;
//! assert!((central.inertia()[(0, 0)] / central.measure - 0.4).abs() < 0.01); // 2/5 m r^2
//! let worst = ball(1.0, 2)?.quality(Quality::MeanRatio).into_iter().fold(1.0, f64::min);
//! assert!(worst > 0.5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Reading order: a simplex and its facets; the [`Mesh`]; who shares what (facets, edges,
//! components, manifolds, orientation); measures and [`Moments`]; closed shapes ([`Polygon`],
//! [`ClosedSurface`]) with the exact signs that they rest on, and the [`convex_hull`] of points; shapes of simplices ([`Quality`],
//! refinement; [`IntrinsicSurface`], known by edge lengths); curved elements ([`Quadratic`]);
//! generators; and files: Gmsh's MSH, OBJ, and VTK.
//!
//! Every list comes in the order of vertex numbers, so that the same mesh gives the same answer
//! everywhere. The crate knows nothing of mass, time or materials.

mod error;
mod simplex;
mod mesh;
mod buckets;
mod facets;
mod edges;
mod components;
mod fans;
mod manifold;
mod orientation;
mod measure;
mod moments;
mod side;
mod sweep;
mod crossing;
mod polygon;
mod overlap;
mod enclosed;
mod hull;
mod quality;
mod intrinsic;
mod intrinsic_surface;
mod obtuse_boundary;
mod refinement;
mod quadrature;
mod quadratic;
mod generators;
mod triangulation;
mod msh;
mod obj;
mod vtk;

pub use components::Components;
pub use edges::{Adjacency, Edges};
pub use enclosed::ClosedSurface;
pub use error::{MeshError, Places};
pub use facets::FacetUse;
pub use generators::{
    Diagonals, ball, bar, circle, cuboid, curved_ball, curved_cylinder, curved_disc,
    curved_elliptic_membrane, curved_sphere, curved_torus, cylinder, disc, elliptic_membrane,
    extruded, icosphere, rectangle, segment, tapered_membrane, torus,
};
pub use hull::convex_hull;
pub use intrinsic::IntrinsicTriangle;
pub use intrinsic_surface::{IntrinsicSurface, Side};
pub use measure::measure;
pub use mesh::{Mesh, Part};
pub use moments::Moments;
pub use msh::{Msh, MshError, Tagged, parse_msh, read_msh};
pub use obj::{Obj, ObjError, parse_obj, read_obj};
pub use obtuse_boundary::Split;
pub use polygon::Polygon;
pub use quadratic::{Quadratic, QuadraticSegments, QuadraticTetrahedra, QuadraticTriangles};
pub use quadrature::simplex_quadrature;
pub use quality::Quality;
pub use refinement::MOST_SIMPLICES;
pub use simplex::Simplex;
pub use vtk::{VtkField, write_vtk};
