//! What does it cost to stretch something? Springs, in any number of dimensions.
//!
//! ```text
//! Cauchy    eps = (l - L)/L               V = 1/2 k L^2 eps^2 = 1/2 k (l - L)^2     (3.1)
//! Green     eps = (l^2 - L^2)/(2 L^2)     V = 1/2 k L^2 eps^2                       (3.2)
//! network   V(q) = sum over springs                                                (3.3)
//! ```
//! `l` the length of a spring in metres, `L` its length at rest, `k` its stiffness in N/m. Both
//! strains give Hooke's law near rest; they part ways at large strain, and at length zero.
//!
//! ```
//! use stationary_calculus::{Covector, Potential, Stencils};
//! use stationary_elasticity::{Spring, Strain};
//!
//! // A unit spring from a fixed hook at the origin to a free end, stretched by a half.
//! let spring = Spring::new([0, 1], 1.0, 2.0, Strain::Cauchy)?;
//! let network = Stencils::<_, 2, 2>::new(1, vec![[0.0, 0.0]], vec![spring])?;
//! let mut dv = Covector([0.0; 2]);
//! network.add_differential(&[0.9, 1.2], dv.view_mut());
//! assert!((dv.0[0] - 0.6).abs() < 1e-15 && (dv.0[1] - 0.8).abs() < 1e-15);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Reading order: [`Spring`] and its [`Strain`], then [`net`], a rectangular network. The crate
//! gives potentials only; it knows nothing of time.

mod error;
mod net;
mod spring;

pub use error::SpringError;
pub use net::{Net, net};
pub use spring::{Spring, Strain};
