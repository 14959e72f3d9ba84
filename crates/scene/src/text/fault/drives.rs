//! What is wrong with loads, motors, motions and strengths in time.

use stationary_calculus::Readable;

/// What is wrong with loads, motors, motions and strengths in time.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DriveFault {
    /// A load that acts on nothing that moves.
    #[error("`{0}` is pinned, so that a load on it does nothing; [[motions]] move a pin")]
    LoadOnPin(String),
    /// A load that is none.
    #[error("a load needs a `force` or a `torque`")]
    NoLoad,
    /// What does not turn has no torque.
    #[error("`{0}` is a particle, which does not turn; only a body takes a `torque`")]
    TorqueOnParticle(String),
    /// A motor gives one of the two.
    #[error("a motor needs a `torque` or a `speed`, and not both")]
    TorqueOrSpeed,
    /// A motor without a joint.
    #[error("no joint is between these two; a motor needs a pin or a hinge there")]
    NoJoint,
    /// A joint that does not turn about one axis.
    #[error("a motor turns a `pin` or a `hinge`; this joint has no one axis to turn about")]
    MotorWithoutAxis,
    /// Two speeds of one joint.
    #[error("this joint already has a motor with a speed")]
    TwoSpeeds,
    /// Only what is pinned is moved.
    #[error("`{0}` is not pinned; only a pinned particle moves as it is told")]
    MotionOfFree(String),
    /// A pin that would push what it touches.
    #[error(
        "`{0}` has a `radius` and touches what is there, which a pin that moves does only where impulses move bodies in \
         the plane or in space: leave out its `radius`, or the `stiffness` of contact"
    )]
    MotionOfRound(String),
    /// Two motions of one pin.
    #[error("`{0}` already has a motion")]
    TwoMotions(String),
    /// A motion begins where the particle is.
    #[error(
        "the strength of a motion is {} at the start; it must be 0, where the particle is",
        Readable(.0)
    )]
    MotionFromElsewhere(f64),
    /// A strength in time is told in one way.
    #[error("a strength in time needs one of `step`, `ramp`, `sine` and `table`")]
    NotOneStrength,
    /// A strength in time that lacks a key.
    #[error("a `{0}` needs `{1}`")]
    StrengthKey(&'static str, &'static str),
    /// A key that belongs to another kind of strength.
    #[error("`{key}` is of a `{of}`, not of a `{kind}`")]
    KeyOfAnother {
        /// The key.
        key: &'static str,
        /// Where it belongs.
        of: &'static str,
        /// Where it stands.
        kind: &'static str,
    },
    /// Two values, of a strength before and after, of limits the least and the largest.
    #[error("{key} has {got} values; it needs two")]
    TwoValues {
        /// The key.
        key: &'static str,
        /// How many there are.
        got: usize,
    },
    /// A ramp that ends before it begins.
    #[error(
        "the ramp ends at {to}, not after its start at {from}",
        to = Readable(to), from = Readable(from)
    )]
    Backwards {
        /// When it begins.
        from: f64,
        /// When it ends.
        to: f64,
    },
}
