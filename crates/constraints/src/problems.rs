//! Problems with known answers: one definition each for tests, studies and benches.
//!
//! | problem | system | answer |
//! | --- | --- | --- |
//! | [`pendulum`] | a unit mass on a unit rod, pushed at the bottom | Jacobi's elliptic functions |
//! | [`chain`] | n unit masses on n unit rods | none; its lowest mode is Bessel's |
//! | [`square`] | four masses, four sides, one or two diagonals, free | its momenta |
//! | [`four_bar`] | crank, coupler and rocker on two hooks | the time of a revolution |
//! | [`slider_crank`] | a piston driven by a crank | the time of a revolution |
//!
//! All are dimensionless: masses, lengths and the strength of the field are 1.

mod chain;
mod four_bar;
mod pendulum;
mod revolution;
mod slider_crank;
mod square;
mod top;

use stationary_calculus::{Covector, DiagonalMetric, Storage, System, first_non_finite};
use stationary_integrators::{State, UniformGravity};

use crate::{ConstraintError, Rods};
use revolution::revolution;

pub use chain::{Chain, chain, folded_chain, writhing_chain};
pub use four_bar::{Crank, FourBar, four_bar};
pub use pendulum::{Pendulum, pendulum};
pub use revolution::time_of_revolution;
pub use slider_crank::{SliderCrank, slider_crank};
pub use square::{Square, square};

/// Points of unit mass in the plane under unit gravity.
pub type Hanging<C> = System<DiagonalMetric<C>, UniformGravity<2>>;

/// A system of rods with initial data.
#[derive(Clone, Debug)]
pub struct RodProblem<C> {
    /// Its masses and its weight.
    pub system: Hanging<C>,
    /// Its rods.
    pub rods: Rods<2>,
    /// Where it starts; feasible.
    pub initial: State<C>,
}

/// An error unless a parameter is finite.
fn check_finite(what: &'static str, value: f64) -> Result<(), ConstraintError> {
    let range = "finite";
    if value.is_finite() { Ok(()) } else { Err(ConstraintError::Parameter { what, value, range }) }
}

/// Unit masses at places with velocities, under gravity `g` downward. Velocities that overflow are an
/// error.
fn hanging<C: Storage>(
    q: C,
    p: C,
    g: f64,
    rods: Rods<2>,
) -> Result<RodProblem<C>, ConstraintError> {
    let n = q.as_ref().len();
    for (what, numbers) in [("configuration", q.as_ref()), ("momentum", p.as_ref())] {
        if let Some(index) = first_non_finite(numbers) {
            return Err(ConstraintError::NonFinite { what, index });
        }
    }
    let mut mass = q.clone();
    mass.as_mut().fill(1.0);
    let metric = DiagonalMetric::new(mass)
        .map_err(|_| ConstraintError::NonFinite { what: "mass", index: 0 })?;
    let gravity = UniformGravity { acceleration: [0.0, -g], masses: vec![1.0; n / 2] };
    let system = System::new(metric, gravity)?;
    Ok(RodProblem { system, rods, initial: State::new(q, Covector(p)) })
}
