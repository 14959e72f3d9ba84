//! How does a body move near rest, and how few freedoms describe it? Modes, and what they are good for.
//!
//! ```text
//! dV(q0) = 0                                        an equilibrium                      (14.1)
//! signs of H +- sigma M                             stable, saddle, undecided           (14.1)
//! H v = lambda M v,   V^T M V = I                   modes, and how many below a limit   (14.2)
//! d(t) = sum v_i (mu_i cos w_i t + nu_i sin(w_i t)/w_i)       motion in closed form     (14.2)
//! alpha_i'' = -lambda_i alpha_i + <F, v_i>          N freedoms instead of n             (14.3)
//! V_r(a) = V(q0 + U a)                              the same for larger motion
//! ```
//! `q0` an equilibrium (n), `H` the Hessian of the potential there, `M` the mass matrix, `lambda` in
//! 1/s^2. The numbers name sections of the notes. An equilibrium is found by
//! [`Equilibrium`](stationary_calculus::Equilibrium).
//!
//! ```
//! use stationary_modal::{Linearized, RigidMotions, problems::fixed_chain};
//!
//! let chain = fixed_chain(100)?; // 100 masses of 1 kg between two walls, springs of 1 N/m
//! let mut near_rest = Linearized::at(&chain.metric, &chain.potential, &chain.q, 1e-12)?;
//! let modes = near_rest.lowest(3, &RigidMotions::none())?;
//! let exact = 2.0 * (0.5 * std::f64::consts::PI / 101.0).sin();
//! assert!((modes.frequencies().next().unwrap() - exact).abs() < 1e-12);
//! assert_eq!(near_rest.count_below(modes.complete_below())?, 3);
//! # Ok::<(), stationary_modal::ModalError>(())
//! ```
//!
//! Reading order: [`Linearized`], a system near an equilibrium; [`RigidMotions`]; [`Kind`]; [`Modes`];
//! [`Motion`] in closed form; [`Reduced`], and how many modes an [`Answer`] needs; a [`Subspace`] of
//! modes and their derivatives for larger motion; [`problems`] with known spectra.
//!
//! The crate knows nothing of elements, meshes or files: any metric and potential will do.

mod error;
mod linearized;
mod rigid_motions;
mod kind;
mod dense;
mod krylov;
mod small;
mod modes;
mod motion;
mod reduced;
mod refined;
mod answer;
mod subspace;
pub mod problems;

pub use answer::Answer;
pub use error::ModalError;
pub use kind::Kind;
pub use linearized::Linearized;
pub use modes::Modes;
pub use motion::Motion;
pub use reduced::Reduced;
pub use rigid_motions::RigidMotions;
pub use subspace::Subspace;
