//! Mechanisms that stand still to be asked: how free they are, what force holds them, whether they close,
//! and how they swing.
//!
//! ```text
//! mobility = n - rank J                                   which equations are redundant
//! M a = f - J^T lambda,    J a + v^T d2g v + d2g/dt2 = 0  accelerations and forces at an instant
//! min 1/2 |g(q)|^2                                        assembly: a closed pose, or none near
//! N^T M N,   N^T (d2V + lambda d2g) N,    J N = 0         small swings about an equilibrium
//! ```
//! `n` freedoms of all bodies, `J` the differential of the equations `g` (m x n), `M` the metric, `f` all
//! other forces, gyroscopic torques among them; `N` a basis of the motions that the joints allow. Ranks are
//! read in reference [scales](stationary_constraints::Scale) and radii of gyration, whatever the masses.
//! All of it is dense, and takes the singular values of J: for questions about a
//! mechanism, not for its steps. Source: notes 6.4; Haug (1989), 3 and 4.

mod assembly;
mod differential;
mod error;
mod instant;
mod linearization;
mod mobility;
mod second_rate;

pub use assembly::{Assembly, assemble};
pub use error::MechanismError;
pub use instant::{Instant, instant};
pub use linearization::{Linearization, linearize};
pub use mobility::{Mobility, mobility};
