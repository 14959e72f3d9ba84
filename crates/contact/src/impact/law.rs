//! Impact laws by name: what to do where several contacts approach at once.
//!
//! | law | one pass |
//! | --- | --- |
//! | Gauss-Seidel | each contact in turn, with its restitution |
//! | Jacobi | all contacts from the same velocity, at once |
//! | inelastic | the closest velocity that no contact forbids (11.1) |
//! | blended | that projection, and c times as far again |
//! | generalized reflections | the same, of the approaching contacts only |
//!
//! All but the inelastic one repeat their pass until no contact approaches. Which of them keeps
//! what is data ([`ImpactLaw::facts`]), and tests and a study measure it. Source: notes 11.5.

use stationary_calculus::Vector;

use crate::error::check_finite;
use crate::impact::{gauss_seidel, jacobi, reflection};
use crate::{ContactError, Impact};

/// A rule for impacts of several contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ImpactLaw {
    /// One contact after another, in the order in which they are listed.
    GaussSeidel,
    /// All contacts at once, each as if it were alone.
    Jacobi,
    /// The projection (11.1): every contact comes to rest, restitution is not read.
    Inelastic,
    /// The projection of all touching contacts, overshot by the restitution.
    Blended,
    /// The projection of the approaching contacts, overshot by the restitution.
    GeneralizedReflections,
}

/// What a law keeps in every impact, or does not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImpactFacts {
    /// Its name, lower case and with hyphens.
    pub name: &'static str,
    /// Kinetic energy never grows.
    pub energy_never_grows: bool,
    /// Kinetic energy is kept where every restitution is 1.
    pub keeps_energy: bool,
    /// A symmetric impact stays symmetric.
    pub symmetric: bool,
    /// The order in which contacts are listed does not matter.
    pub order_free: bool,
    /// What touches without approaching is not held back by what approaches beside it.
    pub breaks_away: bool,
}

/// What an impact took.
#[derive(Clone, Debug, PartialEq)]
pub struct ImpactReport {
    /// The impulse of each contact, N s.
    pub impulses: Vec<f64>,
    /// Passes over the contacts.
    pub passes: usize,
    /// Contacts solved on their own, or linear systems.
    pub solves: usize,
}

/// How many passes an impact may take before it is an error.
pub const PASSES: usize = 10_000;

impl ImpactLaw {
    /// All of them, in the order of the table.
    pub const ALL: &'static [ImpactLaw] = &[
        ImpactLaw::GaussSeidel,
        ImpactLaw::Jacobi,
        ImpactLaw::Inelastic,
        ImpactLaw::Blended,
        ImpactLaw::GeneralizedReflections,
    ];

    /// What it keeps.
    pub fn facts(self) -> ImpactFacts {
        let best = ImpactFacts {
            name: "generalized-reflections",
            energy_never_grows: true,
            keeps_energy: true,
            symmetric: true,
            order_free: true,
            breaks_away: true,
        };
        match self {
            ImpactLaw::GeneralizedReflections => best,
            ImpactLaw::GaussSeidel => {
                ImpactFacts { name: "gauss-seidel", symmetric: false, order_free: false, ..best }
            }
            ImpactLaw::Jacobi => ImpactFacts {
                name: "jacobi",
                energy_never_grows: false,
                keeps_energy: false,
                ..best
            },
            ImpactLaw::Inelastic => {
                ImpactFacts { name: "inelastic", keeps_energy: false, breaks_away: false, ..best }
            }
            ImpactLaw::Blended => ImpactFacts { name: "blended", breaks_away: false, ..best },
        }
    }

    /// Changes a velocity by the impact, until no contact approaches.
    ///
    /// # Errors
    /// A velocity of the wrong size or not finite, and contacts that still approach after
    /// [`PASSES`] passes; then the velocity is as it was.
    pub fn apply(
        self,
        impact: &Impact,
        v: Vector<&mut [f64]>,
    ) -> Result<ImpactReport, ContactError> {
        self.apply_within(impact, PASSES, v)
    }

    /// The same where an approach of up to `still`, m/s, is rest.
    #[cfg(any(feature = "2d", feature = "3d"))]
    pub(crate) fn apply_down_to(
        self,
        impact: &Impact,
        still: f64,
        v: Vector<&mut [f64]>,
    ) -> Result<ImpactReport, ContactError> {
        self.run(impact, PASSES, still, v)
    }

    /// The same with another bound on the passes.
    ///
    /// # Errors
    /// Those of [`ImpactLaw::apply`], after `bound` passes.
    pub fn apply_within(
        self,
        impact: &Impact,
        bound: usize,
        v: Vector<&mut [f64]>,
    ) -> Result<ImpactReport, ContactError> {
        self.run(impact, bound, 0.0, v)
    }

    fn run(
        self,
        impact: &Impact,
        bound: usize,
        still: f64,
        v: Vector<&mut [f64]>,
    ) -> Result<ImpactReport, ContactError> {
        impact.check_velocity(v.0)?;
        let mut rounding = impact.rounding(Vector(v.0)).max(still);
        let mut next = Vector(v.0.to_vec());
        let mut report = ImpactReport { impulses: vec![0.0; impact.len()], passes: 0, solves: 0 };
        while impact.approach(next.view()) > rounding {
            if report.passes == bound {
                return Err(ContactError::NotConverged {
                    what: self.facts().name,
                    iterations: bound,
                    residual: impact.approach(next.view()),
                    velocity: next.0,
                });
            }
            report.passes += 1;
            match self {
                ImpactLaw::GaussSeidel => {
                    gauss_seidel::pass(impact, rounding, &mut next, &mut report)
                }
                ImpactLaw::Jacobi => jacobi::pass(impact, rounding, &mut next, &mut report),
                ImpactLaw::Inelastic => reflection::project(impact, &mut next, &mut report)?,
                ImpactLaw::Blended => reflection::overshoot_all(impact, &mut next, &mut report)?,
                ImpactLaw::GeneralizedReflections => {
                    reflection::overshoot_approaching(impact, rounding, &mut next, &mut report)?;
                }
            }
            // Speeds may grow, and their rounding with them.
            rounding = rounding.max(impact.rounding(next.view()));
        }
        check_finite("the velocity after the impact", &next.0)?;
        v.0.copy_from_slice(&next.0);
        Ok(report)
    }
}
