//! How a scene is stepped: the word `integrator`, and what goes with it.
//!
//! ```text
//! equal       (q, p) -> Phi_h(q, p); with rods, then back to the nearest feasible configuration
//! adaptive    steps chosen to a tolerance, read off at every moment i h
//! rattle, constrained-hamilton       equal steps that hold rods by their forces
//! joint-coordinates    equal steps of bodies, of numbers that are free
//! event-driven-2, event-driven-4     bodies that touch: flight, impacts at their instant
//! error-controlled    bodies that touch: steps chosen to a tolerance, read off at every moment i h
//! linear-modes    no steps: a sum of modes in closed form, read off at every moment i h
//! ```
//! `h` the scene's step.

use stationary_integrators::{Evaluation, Method};

use crate::model::drives::{Drives, MotorDrive};
use crate::model::scene::Scene;
use crate::model::stepping::{
    ADAPTIVE, Adaptive, CONSTRAINED, Constrained, LINEAR_MODES, Stepping,
};
#[cfg(feature = "rigid")]
use crate::model::stepping::{ERROR_CONTROLLED, EVENT_DRIVEN, FlightSteps, JOINT_COORDINATES};
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::text::{check, limits};
use crate::words::Declaration;
use crate::words::word::{CONSTRAINTS, MODAL};
#[cfg(feature = "laplacian")]
use stationary_laplacian::HeatMethod;
#[cfg(feature = "rigid")]
use stationary_rigid::BodyMethod;

/// The order of kicks before and after a step.
const KICKS: u32 = 2;

/// What the word `integrator` may say.
#[derive(Clone, Copy)]
enum Word {
    Equal(Method),
    Adaptive(Adaptive),
    Constrained(Constrained),
    LinearModes,
    #[cfg(feature = "laplacian")]
    Heat(HeatMethod),
    #[cfg(feature = "rigid")]
    Bodies(BodyMethod),
    #[cfg(feature = "rigid")]
    JointCoordinates,
    #[cfg(feature = "rigid")]
    EventDriven(FlightSteps),
    #[cfg(feature = "rigid")]
    ErrorControlled,
}

impl Word {
    /// Whether its steps are chosen to a tolerance.
    fn takes_a_tolerance(self) -> bool {
        match self {
            Word::Adaptive(_) => true,
            #[cfg(feature = "rigid")]
            Word::ErrorControlled => true,
            _ => false,
        }
    }
}

/// The words that a scene of this kind may say.
fn words(declared: &Declaration, dimension: usize) -> Vec<(&'static str, Word)> {
    #[cfg(feature = "laplacian")]
    if declared.heat.is_some() {
        let steps = HeatMethod::ALL.map(|method| (method.name(), Word::Heat(method)));
        return steps.into_iter().chain([(LINEAR_MODES, Word::LinearModes)]).collect();
    }
    let adaptive = ADAPTIVE.map(|(name, method)| (name, Word::Adaptive(method)));
    #[cfg(feature = "rigid")]
    let of_bodies =
        [(JOINT_COORDINATES, Word::JointCoordinates), (ERROR_CONTROLLED, Word::ErrorControlled)]
            .into_iter()
            .chain(EVENT_DRIVEN.map(|(name, flights)| (name, Word::EventDriven(flights))));
    #[cfg(feature = "rigid")]
    if declared.is_of_bodies(dimension) && dimension == 3 {
        let word = |&method: &BodyMethod| (method.facts().name, Word::Bodies(method));
        return BodyMethod::ALL.iter().map(word).chain(of_bodies).chain(adaptive).collect();
    }
    let _ = (declared, dimension);
    let word = |&method: &Method| (method.facts().name, Word::Equal(method));
    let mut words: Vec<_> = Method::ALL.iter().map(word).chain(adaptive).collect();
    words.extend(CONSTRAINED.map(|(name, method)| (name, Word::Constrained(method))));
    words.push((LINEAR_MODES, Word::LinearModes));
    #[cfg(feature = "rigid")]
    if declared.is_of_bodies(dimension) {
        words.extend(of_bodies);
    }
    words
}

/// The stepping that is declared; whether it can step the scene is asked later.
pub(crate) fn declare(declared: &Declaration, dimension: usize) -> Checked<Stepping> {
    let all = words(declared, dimension);
    let integrator = &declared.integrator;
    let word = check::word("integrator", integrator.get_ref(), integrator.span(), &all)?;
    if let (Some(modes), false) = (&declared.modes, matches!(word, Word::LinearModes)) {
        return Err(at(modes.span(), Fault::Modes));
    }
    let tolerance = match (&declared.tolerance, word.takes_a_tolerance()) {
        (Some(tolerance), true) => {
            let value = tolerance_in_range(tolerance.get_ref().0);
            value.map_err(|fault| at(tolerance.span(), fault))?
        }
        (None, true) => return Err(at(integrator.span(), Fault::NoTolerance)),
        (Some(tolerance), false) => return Err(at(tolerance.span(), Fault::EqualSteps)),
        (None, false) => 0.0,
    };
    Ok(match word {
        Word::Adaptive(method) => Stepping::Adaptive { method, tolerance },
        #[cfg(feature = "rigid")]
        Word::ErrorControlled => Stepping::ErrorControlled { tolerance },
        Word::Equal(method) => Stepping::Equal(method),
        #[cfg(feature = "laplacian")]
        Word::Heat(method) => Stepping::Heat(method),
        Word::LinearModes => match &declared.modes {
            Some(modes) => {
                let count = modes_in_range(modes.get_ref().0);
                let count = count.map_err(|fault| at(modes.span(), fault))?;
                Stepping::LinearModes { count: count as usize }
            }
            None => return Err(at(integrator.span(), Fault::NoModes)),
        },
        Word::Constrained(method) => Stepping::Constrained(method),
        #[cfg(feature = "rigid")]
        Word::Bodies(method) => Stepping::Bodies(method),
        #[cfg(feature = "rigid")]
        Word::JointCoordinates => Stepping::JointCoordinates,
        #[cfg(feature = "rigid")]
        Word::EventDriven(flights) => Stepping::EventDriven(flights),
    })
}

/// A tolerance: below one, and above what rounding allows.
fn tolerance_in_range(value: f64) -> Result<f64, Fault> {
    match (limits::TOLERANCE..1.0).contains(&value) {
        true => Ok(value),
        false => Err(Fault::Tolerance { value }),
    }
}

fn modes_in_range(modes: u64) -> Result<u64, Fault> {
    match (1..=limits::MODES).contains(&modes) {
        true => Ok(modes),
        false => Err(Fault::NumberOfModes { modes }),
    }
}

impl Scene {
    /// An error where the scene's method cannot step what the scene has.
    pub(crate) fn check_kind(&self) -> Result<(), Fault> {
        #[cfg(feature = "rigid")]
        if !self.bodies.is_empty() {
            return self.check_bodies();
        }
        self.check_particles()
    }

    /// The same scene with another method, which must be one that moves such a scene.
    ///
    /// # Errors
    /// [`Fault::MethodOfAnother`], [`Fault::MethodOfJoints`] and [`Fault::MethodCannot`] where it
    /// does not; [`Fault::Tolerance`] and [`Fault::NumberOfModes`] where its number is out of range;
    /// [`BodyFault::Untouchable`](crate::BodyFault::Untouchable); [`Fault::TooMany`] numbers of modes;
    /// [`Fault::NotCompiled`].
    pub fn with_method(self, method: impl Into<Stepping>) -> Result<Scene, Fault> {
        let scene = Scene { stepping: method.into(), ..self };
        scene.check_stepping()?;
        Ok(scene)
    }

    /// Whether forces act on it that no potential gives.
    pub(crate) fn is_driven(&self) -> bool {
        let Drives { loads, motors, motions, gravity, .. } = &self.drives;
        let damped = self.links.iter().any(|link| link.damping > 0.0)
            || self.joints.iter().any(|joint| joint.damping > 0.0);
        let torques = motors.iter().any(|motor| motor.drive == MotorDrive::Torque);
        self.drag.is_some()
            || self.frame.is_some()
            || !loads.is_empty()
            || torques
            || !motions.is_empty()
            || gravity.is_some()
            || damped
    }

    /// Whether the method takes forces that change with the place, as springs to pins that move do.
    fn moves_pins(&self) -> bool {
        match self.stepping {
            Stepping::Equal(method) => {
                let explicit = method.facts().evaluation == Evaluation::Explicit;
                explicit || method.weights_with_force().is_some()
            }
            Stepping::Adaptive { .. } => true,
            // Its kicks are those of an explicit method.
            Stepping::Constrained(Constrained::Rattle) => true,
            _ => false,
        }
    }

    fn mode_numbers(&self, modes: usize) -> u64 {
        (self.freedoms() as u64).saturating_mul(modes as u64)
    }

    /// An error where the scene's method cannot step what the scene has.
    pub(crate) fn check_stepping(&self) -> Result<(), Fault> {
        match self.stepping {
            Stepping::Constrained(_) => CONSTRAINTS.check(self.stepping.name())?,
            Stepping::LinearModes { .. } => MODAL.check(self.stepping.name())?,
            // Whoever has one of the others has its crate.
            _ => {}
        }
        if let Some(tolerance) = self.stepping.tolerance() {
            tolerance_in_range(tolerance)?;
        }
        if let Stepping::LinearModes { count } = self.stepping {
            modes_in_range(count as u64)?;
        }
        self.check_kind()
    }

    /// An error where the scene's method cannot step its particles, or let its heat flow.
    pub(crate) fn check_particles(&self) -> Result<(), Fault> {
        let (driven, rods) = (self.is_driven(), !self.rods.is_empty());
        let breaking = self.rods.iter().any(|rod| rod.strength.is_finite());
        let of_heat = match self.stepping {
            #[cfg(feature = "laplacian")]
            Stepping::Heat(_) => true,
            Stepping::LinearModes { .. } => self.heat.is_some(),
            _ => false,
        };
        if self.heat.is_some() != of_heat {
            return Err(Fault::MethodOfAnother(self.stepping.name().to_owned()));
        }
        let method = self.stepping.name();
        let refused = |what, instead| Err(Fault::MethodCannot { method, what, instead });
        if let Some(contact) = &self.contact {
            return match self.stepping {
                _ if rods && contact.stiffness.is_some() => {
                    refused("rods beside contact by springs", "leave `stiffness` out")
                }
                _ if rods => refused(
                    "contact with rods on a line, where a rod leaves its ends nothing to do",
                    "leave one of them out",
                ),
                _ if contact.stiffness.is_some() => match self.stepping {
                    Stepping::Equal(own) if own.facts().evaluation == Evaluation::Explicit => {
                        Ok(())
                    }
                    Stepping::Adaptive { method, .. } if method.is_explicit() => Ok(()),
                    _ => refused("what touches by springs", "name an explicit method"),
                },
                Stepping::Equal(Method::StormerVerlet) => Ok(()),
                _ => refused("what touches", "name `stormer-verlet`"),
            };
        }
        match self.stepping {
            _ if driven && rods && self.stepping != Stepping::Constrained(Constrained::Rattle) => {
                refused(
                    "rods beside drag, loads, changing gravity or pins that move",
                    "name `rattle`",
                )
            }
            _ if !self.drives.motions.is_empty() && !self.moves_pins() => refused(
                "pins that move",
                "name a method up to order 2, such as `stormer-verlet` or `newmark`, or an adaptive method",
            ),
            Stepping::Constrained(_) if !rods => {
                refused("a scene without rods", "name any other method")
            }
            Stepping::Adaptive { .. } if rods => {
                refused("rods", "name a method of equal steps, such as `rattle`")
            }
            Stepping::LinearModes { count } if self.mode_numbers(count) > limits::MODE_NUMBERS => {
                let (what, count) = ("numbers of modes", self.mode_numbers(count));
                Err(Fault::TooMany { what, count, limit: limits::MODE_NUMBERS })
            }
            Stepping::LinearModes { .. } if rods || driven || !self.drives.sources.is_empty() => {
                refused("rods, drag, loads or sources", "name a method of equal steps")
            }
            Stepping::Equal(equal) if driven && equal.facts().order > KICKS => refused(
                "drag, loads or changing gravity to its order",
                "name a method up to order 2, such as `stormer-verlet`, or an adaptive method",
            ),
            Stepping::Adaptive { method: adaptive, .. }
                if !adaptive.is_explicit() && self.freedoms() > limits::FULL_MATRIX_FREEDOMS =>
            {
                refused("so many freedoms with full matrices", "name a method of equal steps")
            }
            Stepping::Equal(equal)
                if equal.facts().evaluation == Evaluation::Implicit
                    && !can_factor(self.freedoms()) =>
            {
                refused("so many freedoms with full matrices", "name an explicit method")
            }
            #[cfg(feature = "rigid")]
            Stepping::Bodies(_)
            | Stepping::JointCoordinates
            | Stepping::EventDriven(_)
            | Stepping::ErrorControlled { .. } => Err(Fault::MethodOfAnother(method.to_owned())),
            Stepping::Constrained(Constrained::Rattle) => Ok(()),
            _ if breaking => refused("rods that break", "name `rattle`"),
            _ => Ok(()),
        }
    }
}

/// Whether a matrix of so many freedoms can be factored: a sparse one, where it is compiled.
fn can_factor(freedoms: usize) -> bool {
    cfg!(any(feature = "constraints", feature = "elasticity", feature = "modal"))
        || freedoms <= limits::FULL_MATRIX_FREEDOMS
}
