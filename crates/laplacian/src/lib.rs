//! How do values on a line, a surface or a solid even out, and how far is it from here to there?
//!
//! ```text
//! V(f) = 1/2 int |grad f|^2,     Lap f = -grad V in the mass          (15.1, 15.2)
//! W_ij = -1/2 (cot alpha + cot beta),   Lap = -M^-1 W                 (15.3)
//! df/dt = alpha Lap f            explicit, implicit, exact            (15.2, 15.3)
//! -Lap u = s,   Lap v = -lambda v,   u'' = c^2 Lap u                  (15.2)
//! dx/dt = Lap x                                                       a surface that shrinks
//! d(x) = min over paths of their length                               shortest paths
//! (M + t W) u = delta,   Lap phi = div(-grad u / |grad u|)            distance from heat
//! ```
//! `f u v phi` functions on vertices, linear in between, `W` the Hessian of V, `M` the mass,
//! lumped or exact. The numbers name sections of the notes.
//!
//! ```
//! use stationary_laplacian::{Domain, Elements, Heat, HeatMethod};
//! use stationary_mesh::icosphere;
//!
//! let sphere = icosphere(1.0, 3)?;
//! let domain = Domain::free(Elements::of(&sphere)?)?;
//! let mass = domain.lumped()?;
//! let mut heat = Heat::new(&mass, domain.dirichlet(), HeatMethod::CrankNicolson, 1.0, 0.01)?;
//! let mut f: Vec<f64> = sphere.vertices().iter().map(|x| x.z).collect();
//! for _ in 0..50 {
//!     heat.step(&mut f)?; // z is a mode of the sphere: it decays like exp(-2 t)
//! }
//! assert!((f[0] / sphere.vertices()[0].z - (-1.0_f64).exp()).abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Reading order: an [`Element`]'s energy; a [`Domain`], its masses and its [`laplacian`]; the
//! spectrum; [`Heat`], stepped and exact; [`Poisson`]; [`MeanCurvatureFlow`];
//! [`ShortestPaths`] and [`GeodesicDistance`]; [`problems`] with known spectra. Waves are any integrator on a system of
//! the mass and the energy of [`Elements::scaled`] by the square of their speed.
//!
//! The crate knows nothing of files, of scenes or of materials.

mod error;
mod elements;
mod domain;
mod spectrum;
mod largest_eigenvalue;
mod differences;
mod heat;
mod exact_heat;
mod poisson;
mod curvature_flow;
mod shortest_paths;
mod heat_time;
mod geodesic;
pub mod problems;

pub use curvature_flow::MeanCurvatureFlow;
pub use domain::{Dirichlet, Domain, laplacian};
pub use elements::{Element, Elements};
pub use error::LaplacianError;
pub use exact_heat::ExactHeat;
pub use geodesic::{Distances, GeodesicDistance};
pub use heat::{Heat, HeatMethod};
pub use largest_eigenvalue::largest_eigenvalue;
pub use poisson::{Poisson, harmonic};
pub use shortest_paths::{ShortestDistances, ShortestPaths};
pub use spectrum::lowest_modes;
