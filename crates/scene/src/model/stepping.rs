//! How a scene is stepped.

#[cfg(feature = "laplacian")]
use stationary_laplacian::HeatMethod;
#[cfg(feature = "rigid")]
use stationary_rigid::BodyMethod;
use std::fmt;

use stationary_integrators::{Evaluation, Method};

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
    #[cfg(feature = "laplacian")]
    Heat(HeatMethod),
    /// Bodies in space. Where they have joints it is RATTLE along the free motion that the method
    /// is named after.
    #[cfg(feature = "rigid")]
    Bodies(BodyMethod),
    /// Bodies whose joints close no loop, in the coordinates of these, in equal steps:
    /// [`TreeVariational`](stationary_rigid::tree::TreeVariational).
    #[cfg(feature = "rigid")]
    JointCoordinates,
    /// Bodies that touch, in equal steps of flight with impacts at their instant: `EventDriven` of
    /// `stationary_contact`. While anything rests or slides all takes steps of a world.
    #[cfg(feature = "rigid")]
    EventDriven(FlightSteps),
    /// Bodies that touch, in steps chosen by their error: `ErrorControlled` of `stationary_contact`, whose
    /// accuracy is `tolerance` times the scene's size.
    #[cfg(feature = "rigid")]
    ErrorControlled {
        /// The tolerance.
        tolerance: f64,
    },
}

/// How bodies fly between impacts that are met at their instant.
#[cfg(feature = "rigid")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlightSteps {
    /// Of order 2.
    Second,
    /// Of order 4.
    Fourth,
}

/// A method that chooses its own steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Adaptive {
    /// [`DormandPrince853`](stationary_integrators::DormandPrince853).
    DormandPrince853,
    /// [`DormandPrince54`](stationary_integrators::DormandPrince54).
    DormandPrince54,
    /// [`RadauIia5`](stationary_integrators::RadauIia5).
    RadauIia5,
    /// [`BackwardDifferences`](stationary_integrators::BackwardDifferences) up to order 5.
    BackwardDifferences,
}

impl Adaptive {
    /// Whether its steps solve no equations.
    pub(crate) fn is_explicit(self) -> bool {
        matches!(self, Adaptive::DormandPrince853 | Adaptive::DormandPrince54)
    }
}

/// A method that holds rods by their forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Constrained {
    /// [`Rattle`](stationary_constraints::Rattle).
    Rattle,
    /// [`ConstrainedHamilton`](stationary_constraints::ConstrainedHamilton).
    Hamilton,
}

/// The word for equal steps in the coordinates of joints.
#[cfg(feature = "rigid")]
pub(crate) const JOINT_COORDINATES: &str = "joint-coordinates";

/// The words for impacts at their instant.
#[cfg(feature = "rigid")]
pub(crate) const EVENT_DRIVEN: [(&str, FlightSteps); 2] =
    [("event-driven-2", FlightSteps::Second), ("event-driven-4", FlightSteps::Fourth)];

/// The word for contact in steps that are chosen by their error.
#[cfg(feature = "rigid")]
pub(crate) const ERROR_CONTROLLED: &str = "error-controlled";

/// Steps of lasting contact in a step of these: bounces end as rest where they are shorter than four of them.
pub(crate) const CONTACT_STEPS: u32 = 64;

/// The word for motion in closed form.
pub(crate) const LINEAR_MODES: &str = "linear-modes";

pub(crate) const ADAPTIVE: [(&str, Adaptive); 4] = [
    ("dormand-prince-853", Adaptive::DormandPrince853),
    ("dormand-prince-54", Adaptive::DormandPrince54),
    ("radau-iia-5", Adaptive::RadauIia5),
    ("bdf-5", Adaptive::BackwardDifferences),
];

pub(crate) const CONSTRAINED: [(&str, Constrained); 2] =
    [("rattle", Constrained::Rattle), ("constrained-hamilton", Constrained::Hamilton)];

impl Stepping {
    /// Its name in a scene's file.
    pub fn name(self) -> &'static str {
        match self {
            Stepping::Equal(method) => method.facts().name,
            Stepping::Adaptive { method, .. } => named(&ADAPTIVE, method),
            Stepping::Constrained(method) => named(&CONSTRAINED, method),
            Stepping::LinearModes { .. } => LINEAR_MODES,
            #[cfg(feature = "laplacian")]
            Stepping::Heat(method) => method.name(),
            #[cfg(feature = "rigid")]
            Stepping::Bodies(method) => method.facts().name,
            #[cfg(feature = "rigid")]
            Stepping::JointCoordinates => JOINT_COORDINATES,
            #[cfg(feature = "rigid")]
            Stepping::EventDriven(flights) => named(&EVENT_DRIVEN, flights),
            #[cfg(feature = "rigid")]
            Stepping::ErrorControlled { .. } => ERROR_CONTROLLED,
        }
    }

    /// The tolerance of a method that chooses its own steps.
    pub(crate) fn tolerance(self) -> Option<f64> {
        match self {
            Stepping::Adaptive { tolerance, .. } => Some(tolerance),
            #[cfg(feature = "rigid")]
            Stepping::ErrorControlled { tolerance } => Some(tolerance),
            _ => None,
        }
    }

    /// Whether its steps solve equations or are chosen, so that counts depend on rounding.
    pub fn evaluation(self) -> Evaluation {
        match self {
            Stepping::Equal(method) => method.facts().evaluation,
            #[cfg(feature = "rigid")]
            Stepping::Bodies(method) => method.facts().evaluation,
            // Heat solves its one matrix, without iterations.
            #[cfg(feature = "laplacian")]
            Stepping::Heat(_) => Evaluation::Explicit,
            #[cfg(feature = "rigid")]
            Stepping::JointCoordinates => Evaluation::Implicit,
            // Of impacts and contact steps none counts iterations.
            #[cfg(feature = "rigid")]
            Stepping::EventDriven(_) => Evaluation::Explicit,
            #[cfg(feature = "rigid")]
            Stepping::ErrorControlled { .. } => Evaluation::Implicit,
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

#[cfg(feature = "rigid")]
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
