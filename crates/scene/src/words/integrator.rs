//! How a scene is stepped: the word `integrator`, and what goes with it.
//!
//! ```text
//! equal       (q, p) -> Phi_h(q, p); with rods, then back to the nearest feasible configuration
//! adaptive    steps chosen to a tolerance, read off at every moment i h
//! rattle, constrained-hamilton       equal steps that hold rods by their forces
//! linear-modes    no steps: a sum of modes in closed form, read off at every moment i h
//! ```
//! `h` the scene's step.

use std::fmt;

use stationary_integrators::{Evaluation, Method};

use crate::model::scene::Scene;
use crate::model::upper::{BodyMethod, HeatMethod};
use crate::run::sparse_steps;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::text::{check, limits};
use crate::words::declaration::Declaration;
use crate::words::features;

/// How a scene is stepped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stepping {
    /// Equal steps of a method; in a scene with rods each is followed by a projection. Bodies in
    /// the plane that have joints take Stormer-Verlet, which holding them turns into RATTLE.
    Equal(Method),
    /// Steps that the method chooses, for an error of at most `tolerance` a step, relative to the
    /// scene's size and speed.
    Adaptive {
        /// The method.
        method: Adaptive,
        /// The tolerance.
        tolerance: f64,
    },
    /// Rods held by their forces.
    Constrained(Constrained),
    /// The lowest modes about the place where the scene comes to rest, in closed form; of heat
    /// about what it comes to in the end.
    LinearModes {
        /// How many, besides rigid motions and the constant.
        count: usize,
    },
    /// Heat, in equal steps.
    Heat(HeatMethod),
    /// Bodies in space. Where they have joints it is RATTLE along the free motion that the method
    /// is named after.
    Bodies(BodyMethod),
}

/// A method that chooses its own steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Adaptive {
    /// [`DormandPrince853`](stationary_integrators::DormandPrince853).
    DormandPrince853,
    /// [`RadauIia5`](stationary_integrators::RadauIia5).
    RadauIia5,
    /// [`BackwardDifferences`](stationary_integrators::BackwardDifferences) up to order 5.
    BackwardDifferences,
}

/// A method that holds rods by their forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Constrained {
    /// [`Rattle`](stationary_constraints::Rattle).
    Rattle,
    /// [`ConstrainedHamilton`](stationary_constraints::ConstrainedHamilton).
    Hamilton,
}

/// What the word `integrator` may say.
#[derive(Clone, Copy)]
enum Word {
    Equal(Method),
    Adaptive(Adaptive),
    Constrained(Constrained),
    LinearModes,
    Heat(HeatMethod),
    Bodies(BodyMethod),
}

/// The word for motion in closed form.
const LINEAR_MODES: &str = "linear-modes";

const ADAPTIVE: [(&str, Adaptive); 3] = [
    ("dormand-prince-853", Adaptive::DormandPrince853),
    ("radau-iia-5", Adaptive::RadauIia5),
    ("bdf-5", Adaptive::BackwardDifferences),
];

const CONSTRAINED: [(&str, Constrained); 2] =
    [("rattle", Constrained::Rattle), ("constrained-hamilton", Constrained::Hamilton)];

impl Stepping {
    /// Its name in a scene's file.
    pub fn name(self) -> &'static str {
        match self {
            Stepping::Equal(method) => method.facts().name,
            Stepping::Adaptive { method, .. } => named(&ADAPTIVE, method),
            Stepping::Constrained(method) => named(&CONSTRAINED, method),
            Stepping::LinearModes { .. } => LINEAR_MODES,
            Stepping::Heat(method) => method.name(),
            Stepping::Bodies(method) => method.facts().name,
        }
    }

    /// Whether its steps solve equations, and so count iterations that depend on rounding.
    pub fn evaluation(self) -> Evaluation {
        match self {
            Stepping::Equal(method) => method.facts().evaluation,
            Stepping::Bodies(method) => method.facts().evaluation,
            // Heat solves its one matrix, without iterations.
            Stepping::Heat(_) => Evaluation::Explicit,
            Stepping::Adaptive { .. } | Stepping::Constrained(_) | Stepping::LinearModes { .. } => {
                Evaluation::Implicit
            }
        }
    }
}

impl From<Method> for Stepping {
    fn from(method: Method) -> Self {
        Stepping::Equal(method)
    }
}

impl From<BodyMethod> for Stepping {
    fn from(method: BodyMethod) -> Self {
        Stepping::Bodies(method)
    }
}

fn named<T: PartialEq>(words: &[(&'static str, T)], meant: T) -> &'static str {
    words.iter().find(|(_, meaning)| *meaning == meant).map_or("", |(name, _)| name)
}

impl fmt::Display for Stepping {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The stepping that is declared; whether it can step the scene is asked later.
pub(crate) fn declare(declared: &Declaration, dimension: usize) -> Checked<Stepping> {
    let bodies = BodyMethod::ALL.iter().map(|&method| (method.facts().name, Word::Bodies(method)));
    let particles = Method::ALL
        .iter()
        .map(|&method| (method.facts().name, Word::Equal(method)))
        .chain(ADAPTIVE.map(|(name, method)| (name, Word::Adaptive(method))))
        .chain(CONSTRAINED.map(|(name, method)| (name, Word::Constrained(method))))
        .chain([(LINEAR_MODES, Word::LinearModes)]);
    let heat = HeatMethod::ALL.map(|method| (method.name(), Word::Heat(method)));
    let in_space = !declared.bodies.is_empty() && dimension == 3;
    let all: Vec<_> = match &declared.heat {
        Some(_) => heat.into_iter().chain([(LINEAR_MODES, Word::LinearModes)]).collect(),
        None if in_space => bodies.collect(),
        None => particles.collect(),
    };
    let integrator = &declared.integrator;
    let word = check::word("integrator", integrator.get_ref(), integrator.span(), &all)?;
    if let (Some(modes), false) = (&declared.modes, matches!(word, Word::LinearModes)) {
        return Err(at(modes.span(), Fault::Modes));
    }
    Ok(match (word, &declared.tolerance) {
        (Word::Adaptive(method), Some(tolerance)) => {
            let value = tolerance_in_range(tolerance.get_ref().0);
            let tolerance = value.map_err(|fault| at(tolerance.span(), fault))?;
            Stepping::Adaptive { method, tolerance }
        }
        (Word::Adaptive(_), None) => return Err(at(integrator.span(), Fault::NoTolerance)),
        (_, Some(tolerance)) => return Err(at(tolerance.span(), Fault::EqualSteps)),
        (Word::Equal(method), None) => Stepping::Equal(method),
        (Word::Heat(method), None) => Stepping::Heat(method),
        (Word::LinearModes, None) => match &declared.modes {
            Some(modes) => {
                let count = modes_in_range(modes.get_ref().0);
                let count = count.map_err(|fault| at(modes.span(), fault))?;
                Stepping::LinearModes { count: count as usize }
            }
            None => return Err(at(integrator.span(), Fault::NoModes)),
        },
        (Word::Constrained(method), None) => Stepping::Constrained(method),
        (Word::Bodies(method), None) => Stepping::Bodies(method),
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
    fn mode_numbers(&self, modes: usize) -> u64 {
        (self.freedoms() as u64).saturating_mul(modes as u64)
    }

    /// An error where the scene's method cannot step what the scene has.
    pub(crate) fn check_stepping(&self) -> Result<(), Fault> {
        features::check_stepping(self.stepping)?;
        match self.stepping {
            Stepping::Adaptive { tolerance, .. } => tolerance_in_range(tolerance).map(drop)?,
            Stepping::LinearModes { count } => modes_in_range(count as u64).map(drop)?,
            _ => {}
        }
        self.check_kind()
    }

    /// An error where the scene's method cannot step its particles, or let its heat flow.
    pub(crate) fn check_particles(&self) -> Result<(), Fault> {
        let (drag, rods) = (self.drag.is_some(), !self.rods.is_empty());
        let breaking = self.rods.iter().any(|rod| rod.strength.is_finite());
        let of_heat = match self.stepping {
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
                _ if drag || rods => refused("contact with rods or drag", "leave one of them out"),
                _ if contact.stiffness.is_some() => match self.stepping {
                    Stepping::Equal(own) if own.facts().evaluation == Evaluation::Explicit => {
                        Ok(())
                    }
                    Stepping::Adaptive { method: Adaptive::DormandPrince853, .. } => Ok(()),
                    _ => refused("what touches by springs", "name an explicit method"),
                },
                Stepping::Equal(Method::StormerVerlet) => Ok(()),
                _ => refused("what touches", "name `stormer-verlet`"),
            };
        }
        match self.stepping {
            _ if drag && rods => refused("rods and drag at once", "leave one of them out"),
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
            Stepping::LinearModes { .. } if rods || drag => {
                refused("rods or drag", "name a method of equal steps")
            }
            Stepping::Equal(equal) if drag && equal.newmark_weights().is_none() => {
                refused("drag", "name `newmark`, `generalized-alpha` or an adaptive method")
            }
            Stepping::Adaptive { method: adaptive, .. }
                if adaptive != Adaptive::DormandPrince853
                    && self.freedoms() > limits::FULL_MATRIX_FREEDOMS =>
            {
                refused("so many freedoms with full matrices", "name a method of equal steps")
            }
            Stepping::Equal(equal)
                if equal.facts().evaluation == Evaluation::Implicit
                    && !sparse_steps::can_factor(self.freedoms()) =>
            {
                refused("so many freedoms with full matrices", "name an explicit method")
            }
            Stepping::Bodies(_) => Err(Fault::MethodOfAnother(method.to_owned())),
            Stepping::Constrained(Constrained::Rattle) => Ok(()),
            _ if breaking => refused("rods that break", "name `rattle`"),
            _ => Ok(()),
        }
    }
}
