//! Physical simulation from geometric first principles: each crate by a feature of its name, and the
//! program that runs scene files.
//!
//! ```text
//! measure      how good is a method?                         tables, slopes, seeded numbers
//! chart        how is a measurement shown?                   curves, maps, bars, ladders as SVG
//! calculus     is this derivative right?                     assert_derivatives(&potential, &q)
//! mesh         what does space consist of?                   segments, triangles, tetrahedra
//! integrators  how does a system get to a moment later?      (q, p) -> Phi_h(q, p)
//! choose       which method, and which step?             min work, error <= tolerance
//! constraints  how is g(q) = 0 kept?                         M a = -dV + dg^T lambda
//! rigid        how do rotations move?                        R. = R [omega]x
//! contact      what if things touch?                         0 <= gap, 0 <= lambda
//! elasticity   what does bending cost?                       V(q) = integral of Psi(F)
//! modal        how does it vibrate?                          K phi = omega^2 M phi
//! laplacian    how does heat spread?                         M u. = -alpha L u
//! scene        all of these, from a file
//! ```
//! A library takes what it needs:
//!
//! ```toml
//! [dependencies]
//! stationary = { version = "0.1", default-features = false, features = ["integrators"] }
//! ```
//!
//! With nothing said the program comes along, `cargo install --path crates/stationary`:
//!
//! ```text
//! stationary new top.toml --like heavy-top       a scene to begin with, commented
//! stationary words friction                      what may be said of friction
//! stationary run top.toml --out top              a trajectory, tables, pictures and a page that plays
//! stationary choose top.toml --observable energy --tolerance 1e-3
//!                                                the cheapest way to run it within that error
//! stationary import robot.urdf > robot.toml      URDF or MJCF as a scene, with the feature `import`
//! ```

#[cfg(feature = "calculus")]
pub use stationary_calculus as calculus;
#[cfg(feature = "chart")]
pub use stationary_chart as chart;
#[cfg(feature = "choose")]
pub use stationary_choose as choose;
#[cfg(feature = "constraints")]
pub use stationary_constraints as constraints;
#[cfg(feature = "contact")]
pub use stationary_contact as contact;
#[cfg(feature = "elasticity")]
pub use stationary_elasticity as elasticity;
#[cfg(feature = "integrators")]
pub use stationary_integrators as integrators;
#[cfg(feature = "laplacian")]
pub use stationary_laplacian as laplacian;
#[cfg(feature = "measure")]
pub use stationary_measure as measure;
#[cfg(feature = "mesh")]
pub use stationary_mesh as mesh;
#[cfg(feature = "modal")]
pub use stationary_modal as modal;
#[cfg(feature = "rigid")]
pub use stationary_rigid as rigid;
#[cfg(feature = "scene")]
pub use stationary_scene as scene;

#[cfg(feature = "program")]
pub mod program;
