//! What a scene's file may say: every word of the vocabulary, in the order in which they are declared.
//!
//! Every value keeps its place in the text, so that whoever finds it impossible can point at it.

pub(crate) mod bodies;
#[cfg(feature = "rigid")]
pub(crate) mod body_methods;
#[cfg(feature = "rigid")]
pub(crate) mod body_parts;
#[cfg(feature = "rigid")]
pub(crate) mod body_shape;
pub(crate) mod body_tables;
pub(crate) mod chains;
pub(crate) mod claims;
pub(crate) mod contact;
pub(crate) mod draft;
pub(crate) mod drag;
pub(crate) mod frame;
pub(crate) mod gravity;
pub(crate) mod heat;
pub(crate) mod integrator;
#[cfg(feature = "rigid")]
pub(crate) mod joint_velocities;
pub(crate) mod joints;
pub(crate) mod laid_shape;
pub(crate) mod loads;
pub(crate) mod mesh_file;
pub(crate) mod motions;
pub(crate) mod motors;
pub(crate) mod nets;
#[cfg(feature = "elasticity")]
pub(crate) mod node_shares;
pub(crate) mod observables;
pub(crate) mod particle_table;
pub(crate) mod particles;
#[cfg(feature = "rigid")]
pub(crate) mod point_masses;
pub(crate) mod quadratic_shape;
pub(crate) mod rods;
pub(crate) mod shape;
pub(crate) mod shape_kinds;
pub(crate) mod solids;
pub(crate) mod springs;
pub(crate) mod strength;
pub(crate) mod table;
pub(crate) mod units;
pub mod vocabulary;
pub(crate) mod word;

use std::collections::BTreeMap;
use std::ops::Range;

use toml::Spanned;

use crate::text::diagnostic::Checked;
use crate::text::number::{Components, Count, Number};
use crate::words::bodies::BodyDeclaration;
use crate::words::chains::ChainDeclaration;
use crate::words::claims::ClaimDeclaration;
use crate::words::contact::ContactDeclaration;
use crate::words::draft::Draft;
use crate::words::drag::DragDeclaration;
use crate::words::frame::FrameDeclaration;
use crate::words::gravity::{NewtonianGravityDeclaration, UniformGravityDeclaration};
use crate::words::heat::HeatDeclaration;
use crate::words::joints::JointDeclaration;
use crate::words::loads::LoadDeclaration;
use crate::words::motions::MotionDeclaration;
use crate::words::motors::MotorDeclaration;
use crate::words::nets::NetDeclaration;
use crate::words::observables::ObservableDeclaration;
use crate::words::particles::ParticleDeclaration;
use crate::words::rods::RodDeclaration;
use crate::words::solids::SolidDeclaration;
use crate::words::springs::SpringDeclaration;
use crate::words::table::{Kind, table};
use crate::words::units::UnitsDeclaration;
use crate::words::word::{Feature, Of, Word, check_feature};

table! {
    /// A scene of Stationary.
    pub(crate) struct Declaration = "a scene" {
        /// What it is called; the file's name where it is missing.
        title: Option<Spanned<String>> = Kind::Text,
        /// Numbers with names, for expressions such as `"= 2*L"` wherever a number may stand.
        parameters: Option<BTreeMap<Spanned<String>, Spanned<Number>>> = Kind::Numbers,
        /// The dimensions of space.
        dimension: Spanned<Count> = Kind::Dimension,
        /// The method that steps it. Which ones a scene may name depends on what is in it.
        integrator: Spanned<String> = Kind::OneOf(&["explicit-euler", "implicit-euler", "trapezoid", "implicit-midpoint", "symplectic-euler-drift-kick", "symplectic-euler-kick-drift", "stormer-verlet", "runge-kutta-4", "nystrom-4", "triple-jump-4", "suzuki-4", "blanes-moan-4", "blanes-moan-nystrom-4", "yoshida-6", "kahan-li-6", "blanes-moan-6", "blanes-moan-nystrom-6", "yoshida-8", "kahan-li-8", "gauss-legendre-4", "gauss-legendre-6", "gauss-legendre-8", "newmark", "generalized-alpha", "dormand-prince-853", "dormand-prince-54", "radau-iia-5", "bdf-5", "rattle", "constrained-hamilton", "linear-modes", "variational-rotation", "axis-rotations", "exact-rotation", "munthe-kaas-4", "renormalized-euler", "joint-coordinates", "event-driven-2", "event-driven-4", "error-controlled", "crank-nicolson"]),
        /// The error allowed in a step, for methods that choose their own steps, and only for
        /// them.
        tolerance: Option<Spanned<Number>> = Kind::Tolerance,
        /// How many modes linear-modes adds up.
        modes: Option<Spanned<Count>> = Kind::Count(1),
        /// The step, in the scene's unit of time.
        step: Spanned<Number> = Kind::Positive,
        /// The time to which it runs: a whole number of steps.
        horizon: Spanned<Number> = Kind::Positive,
        /// Steps from one sample to the next; 1 where it is missing.
        sample_every: Option<Spanned<Count>> = Kind::Count(1),
        /// What is written down besides the positions; energy and momenta where it is missing.
        observables: Option<Vec<Spanned<ObservableDeclaration>>> = Kind::List(&Kind::Observable),
        /// The direction to the eye, for the picture of a scene in space.
        view: Option<Components> = Kind::Vector,
        /// Words for headings; they change no number. Without them m, s and kg.
        #[serde(default)]
        units: UnitsDeclaration = Kind::Table(&UnitsDeclaration::TABLE),
        /// A uniform field of gravity.
        uniform_gravity: Option<UniformGravityDeclaration> = Kind::Table(&UniformGravityDeclaration::TABLE),
        /// Attraction between every two particles and, in space, balls.
        newtonian_gravity: Option<NewtonianGravityDeclaration> = Kind::Table(&NewtonianGravityDeclaration::TABLE),
        /// A force that holds back every free particle and the centre of every body, in proportion to its velocity.
        drag: Option<DragDeclaration> = Kind::Table(&DragDeclaration::TABLE),
        /// A frame that turns, in which everything is seen.
        frame: Option<FrameDeclaration> = Kind::Table(&FrameDeclaration::TABLE),
        /// How things with a radius, or bodies, touch.
        contact: Option<ContactDeclaration> = Kind::Table(&ContactDeclaration::TABLE),
        /// Point masses, and points that stay.
        #[serde(default)]
        particles: Vec<ParticleDeclaration> = Kind::List(&Kind::Table(&ParticleDeclaration::TABLE)),
        /// Particles joined by rods, on the line between two others.
        #[serde(default)]
        chains: Vec<ChainDeclaration> = Kind::List(&Kind::Table(&ChainDeclaration::TABLE)),
        /// Springs between particles and points of bodies.
        #[serde(default)]
        springs: Vec<SpringDeclaration> = Kind::List(&Kind::Table(&SpringDeclaration::TABLE)),
        /// Rods between particles and points of bodies, as long as at the start.
        #[serde(default)]
        rods: Vec<RodDeclaration> = Kind::List(&Kind::Table(&RodDeclaration::TABLE)),
        /// Rows and columns of particles joined by springs.
        #[serde(default)]
        nets: Vec<NetDeclaration> = Kind::List(&Kind::Table(&NetDeclaration::TABLE)),
        /// Elastic bodies.
        #[serde(default)]
        solids: Vec<SolidDeclaration> = Kind::List(&Kind::Table(&SolidDeclaration::TABLE)),
        /// Heat that flows through a shape.
        heat: Option<HeatDeclaration> = Kind::Table(&HeatDeclaration::TABLE),
        /// Rigid bodies.
        #[serde(default)]
        bodies: Vec<BodyDeclaration> = Kind::List(&Kind::Table(&BodyDeclaration::TABLE)),
        /// Joints between bodies, or a body and the world.
        #[serde(default)]
        joints: Vec<JointDeclaration> = Kind::List(&Kind::Table(&JointDeclaration::TABLE)),
        /// Motors at joints.
        #[serde(default)]
        motors: Vec<MotorDeclaration> = Kind::List(&Kind::Table(&MotorDeclaration::TABLE)),
        /// Forces on particles and bodies, torques on bodies.
        #[serde(default)]
        loads: Vec<LoadDeclaration> = Kind::List(&Kind::Table(&LoadDeclaration::TABLE)),
        /// Pinned particles that move as they are told.
        #[serde(default)]
        motions: Vec<MotionDeclaration> = Kind::List(&Kind::Table(&MotionDeclaration::TABLE)),
        /// What it says of its own run, checked at the end.
        #[serde(default)]
        claims: Vec<ClaimDeclaration> = Kind::List(&Kind::Table(&ClaimDeclaration::TABLE)),
    }
}

/// The tables that add to a scene, in the order in which they do.
macro_rules! words {
    ($($word:ident)*) => {
        impl Declaration {
            /// Every word with the feature that it needs.
            pub(crate) fn features() -> Vec<(&'static str, Option<Feature>)> {
                fn of<W: Word>(_: fn(&Declaration) -> &W) -> Option<Feature> {
                    W::FEATURE
                }
                vec![$((stringify!($word), of(|said| &said.$word))),*]
            }

            /// An error at the first word whose feature is not on.
            pub(crate) fn check_features(&self) -> Checked<()> {
                $(check_feature(stringify!($word), &self.$word)?;)*
                Ok(())
            }

            /// The first place where the text says a word of this kind.
            pub(crate) fn first(&self, of: Of) -> Option<Range<usize>> {
                fn place<W: Word>(word: &W, of: Of) -> Option<Range<usize>> {
                    if W::OF == of { word.place() } else { None }
                }
                None$(.or_else(|| place(&self.$word, of)))*
            }

            /// Checks every word, and adds what it says.
            pub(crate) fn declare(&self, draft: &mut Draft<'_>) -> Checked<()> {
                $(
                    self.$word.declare(draft)?;
                    #[cfg(feature = "rigid")]
                    if stringify!($word) == "rods" {
                        draft.embody_particles(self.has_impulses(), self.moves_what_touches());
                    }
                )*
                Ok(())
            }
        }
    };
}

impl Declaration {
    /// Whether things touch by impulses.
    pub(crate) fn has_impulses(&self) -> bool {
        self.contact.as_ref().is_some_and(|contact| contact.stiffness.is_none())
    }

    /// Whether it is stepped as bodies are: bodies, or particles that touch and that rods join or a pin pushes.
    pub(crate) fn is_of_bodies(&self, dimension: usize) -> bool {
        let rods = !self.rods.is_empty() || !self.chains.is_empty();
        let joined = rods || self.moves_what_touches();
        !self.bodies.is_empty() || (joined && self.has_impulses() && dimension > 1)
    }

    /// Whether a particle that has a radius moves as it is told.
    fn moves_what_touches(&self) -> bool {
        let round = |name: &str| {
            let own = |particle: &&ParticleDeclaration| particle.name.get_ref() == name;
            self.particles.iter().find(own).is_some_and(|particle| particle.radius.is_some())
        };
        self.motions.iter().any(|motion| round(motion.of.get_ref()))
    }
}

// Rods come right before what touches: then particles beside bodies become point masses.
words! {
    bodies joints particles chains heat nets solids springs rods contact
    uniform_gravity newtonian_gravity drag frame loads motors motions
}
