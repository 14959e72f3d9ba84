//! What can be wrong with a constraint, with a state, and with a step that must keep it.

use stationary_calculus::{NewtonError, Readable, SizeError};
use stationary_integrators::StepError;

/// A constraint that cannot be, or cannot be kept. The state is as it was.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConstraintError {
    /// A scheme of kicks and drifts composes no whole steps.
    #[error("the scheme {scheme} is one of kicks and drifts; it must be one of whole steps")]
    NotOfSteps {
        /// The scheme.
        scheme: &'static str,
    },
    /// Two things that must have the same size do not.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// A rod has a length.
    #[error(
        "rod {rod} has length {length} m; it must be positive and finite",
        length = Readable(length)
    )]
    RodLength {
        /// The rod, counted from 0.
        rod: usize,
        /// Its length, metres.
        length: f64,
    },
    /// A strength is positive; infinity is a rod that never breaks.
    #[error(
        "rod {rod} has strength {strength} N; it must be positive",
        strength = Readable(strength)
    )]
    RodStrength {
        /// The rod, counted from 0.
        rod: usize,
        /// Its strength, newtons.
        strength: f64,
    },
    /// Both ends of a rod are the same vertex.
    #[error("both ends of rod {rod} are vertex {vertex}")]
    RodLoop {
        /// The rod, counted from 0.
        rod: usize,
        /// The vertex.
        vertex: usize,
    },
    /// A rod between two hooks constrains nothing.
    #[error("rod {rod} joins two fixed hooks")]
    RodBetweenHooks {
        /// The rod, counted from 0.
        rod: usize,
    },
    /// Two rods join the same vertices.
    #[error("rod {rod} joins the vertices that rod {earlier} joins")]
    RepeatedRod {
        /// The later rod, counted from 0.
        rod: usize,
        /// The earlier one.
        earlier: usize,
    },
    /// A constraint names a vertex that is not there.
    #[error("constraint {index} names vertex {vertex}, but there are only {vertices}")]
    UnknownVertex {
        /// The constraint, counted from 0.
        index: usize,
        /// The vertex.
        vertex: usize,
        /// How many there are.
        vertices: usize,
    },
    /// A fixed place is a point of space.
    #[error("the place at which vertex {vertex} is fixed is not finite")]
    Hook {
        /// The vertex.
        vertex: usize,
    },
    /// A linear equation has finite numbers, each freedom once, and a coefficient that is not zero.
    #[error("equation {row}: numbers must be finite, freedoms differ, one coefficient not be zero")]
    Equation {
        /// The equation, counted from 0.
        row: usize,
    },
    /// A function reads each freedom once.
    #[error("the function reads freedom {freedom} twice")]
    RepeatedFreedom {
        /// The freedom.
        freedom: usize,
    },
    /// A parameter outside its range.
    #[error("{what} is {value}; it must be {range}", value = Readable(value))]
    Parameter {
        /// The parameter.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The values it may have.
        range: &'static str,
    },
    /// The constraint reads freedoms that the system does not have.
    #[error("the constraint needs {needed} freedoms, but the system has only {freedoms}")]
    Freedoms {
        /// Freedoms that it needs.
        needed: usize,
        /// Freedoms that there are.
        freedoms: usize,
    },
    /// An entry of the differential lies outside of the matrix.
    #[error(
        "the differential has an entry at row {row}, freedom {freedom}, but is {rows} x {freedoms}"
    )]
    UnknownFreedom {
        /// Its row.
        row: usize,
        /// Its freedom.
        freedom: usize,
        /// How many rows there are.
        rows: usize,
        /// How many freedoms there are.
        freedoms: usize,
    },
    /// The differential does not bring the entries that were analysed, in the same order.
    #[error("entry {entry} of the differential is not where it was when it was analysed")]
    PatternChanged {
        /// The first entry that differs, counted from 0.
        entry: usize,
    },
    /// A number that everything else rests on is not finite.
    #[error("the {what} is not finite, first at {index}")]
    NonFinite {
        /// What is not finite.
        what: &'static str,
        /// Where.
        index: usize,
    },
    /// The configuration does not satisfy the constraint. `project` moves it to one that does.
    #[error(
        "the configuration violates equation {row} by {violation:e} of its length, \
         more than {allowed:e}"
    )]
    Infeasible {
        /// The equation that is violated most, counted from 0.
        row: usize,
        /// Its violation relative to its length, `|g| / (slope length)`: | |d|/L - 1 | of a rod.
        violation: f64,
        /// What rounding explains.
        allowed: f64,
    },
    /// The velocity leaves the feasible set. `project` removes the part that does.
    #[error("the velocity violates equation {row} by {rate:e} m/s, more than {allowed:e}")]
    InfeasibleVelocity {
        /// The equation that is violated most, counted from 0.
        row: usize,
        /// Its rate `|dg v + dg/dt| / slope`.
        rate: f64,
        /// What is allowed.
        allowed: f64,
    },
    /// The rows of the differential depend on each other: no regular value, or redundant equations.
    #[error(
        "the constraint's differential has not full rank: singular values down to {ratio:e} of the \
         largest, equation {row} is involved most"
    )]
    Singular {
        /// The smallest over the largest singular value of J M^-1/2 in reference scales.
        ratio: f64,
        /// The equation with the largest part in the dependence, counted from 0.
        row: usize,
    },
    /// A step begins, ends or passes too close to a position where the linkage may go on in several ways.
    #[error(
        "the step begins or ends too close to a singular position{}, where dependent equations are: {names}; \
         take steps that end farther from it",
        if *ratio > 0.0 { format!(" ({ratio:e} of a regular one)") } else { String::new() }
    )]
    SingularPosition {
        /// How far the weakest equation is from depending on others, relative to a normal one.
        ratio: f64,
        /// The equations that depend on each other there, or the one at which it was noticed.
        rows: Vec<usize>,
        /// The same with their names, as [`Constraint::describe`](crate::Constraint::describe) has them.
        names: String,
    },
    /// Reduced coordinates do not determine the places' velocities, nor these the coordinates'
    /// rates.
    #[error(
        "the reduced coordinates are singular: singular values down to {ratio:e} of the largest"
    )]
    SingularCoordinates {
        /// The smallest over the largest singular value of M^1/2 Dq.
        ratio: f64,
    },
    /// An elimination met a pivot that is zero to working precision: equations depend on each
    /// other.
    #[error(
        "the equations depend on each other to working precision{}",
        row.map_or(String::new(), |row| format!(", equation {row} on others"))
    )]
    Dependent {
        /// The equation at which it was noticed, where that is known, counted from 0.
        row: Option<usize>,
    },
    /// Multipliers are solved for only after their matrix was prepared.
    #[error("the multipliers' matrix was not prepared, or could not be; call `prepare` first")]
    NotPrepared,
    /// There are more equations than the solver has room for.
    #[error("the solver has room for {room} equations, not for {count}")]
    TooMany {
        /// Its room.
        room: usize,
        /// The equations.
        count: usize,
    },
    /// A block of rows has one row, and for a cone a normal and up to two tangents.
    #[error("block {block} has {rows} rows; a cone has one to three, any other law one")]
    Block {
        /// The block, counted from 0.
        block: usize,
        /// Its rows.
        rows: usize,
    },
    /// Rounding hides whether an equation depends on others, because those it almost depends on
    /// almost depend on each other.
    #[error(
        "equation {row} is {distance:e} of its size away from depending on others, which is known to \
         {error:e} only; remove an equation, or move off the singular configuration"
    )]
    RankUnclear {
        /// The equation, counted from 0.
        row: usize,
        /// How far its row is from the span of others, relative to a normal row.
        distance: f64,
        /// What rounding may have made of it.
        error: f64,
    },
    /// The shortest multipliers of redundant equations were not found.
    #[error("the shared forces of redundant equations did not settle in {iterations} iterations")]
    NotShared {
        /// Iterations made.
        iterations: usize,
    },
    /// The solver needs masses that do not couple freedoms.
    #[error("the metric couples freedom {freedom} to others; this solver needs a diagonal one")]
    Coupled {
        /// The freedom.
        freedom: usize,
    },
    /// No feasible configuration was found: the equations contradict each other, or the step or
    /// the way to the feasible set is too long.
    #[error(
        "after {iterations} iterations, equation {row} is still violated by {violation:e} of its \
         length"
    )]
    NotConverged {
        /// Iterations made.
        iterations: u32,
        /// The equation that is violated most, counted from 0.
        row: usize,
        /// Its violation relative to its length.
        violation: f64,
    },
    /// No step that can be told from none meets the tolerance of an adaptive method.
    #[error(
        "at t = {t} s no step meets the tolerance: one of {h:e} s is off by {error:e} tolerances in stored \
         number {number} of the configuration; loosen the tolerance, or start farther from a singular position",
        t = Readable(t)
    )]
    StepTooShort {
        /// The time at which the step starts, seconds.
        t: f64,
        /// The shortest length that was tried, seconds.
        h: f64,
        /// Its estimated error, in units of the tolerance.
        error: f64,
        /// The number of the configuration that is off most, counted from 0.
        number: usize,
    },
    /// The iterations towards a feasible configuration went away from it: the step is too long, or the
    /// constraint is nearly singular where it starts.
    #[error(
        "no feasible configuration was found: the iterations went away from equation {row}, violated \
         by {violation:e} of its length before them{}; shorten the step",
        regularity.map_or(String::new(), |r| {
            format!(", where singular values go down to {r:e} of the largest")
        })
    )]
    Diverged {
        /// The equation that was violated most before the iterations, counted from 0; where all were nearly kept then,
        /// the one that is now.
        row: usize,
        /// The largest violation before them, relative to its equation's length.
        violation: f64,
        /// The smallest over the largest singular value of J M^-1/2 in reference scales, where the
        /// solver knows it.
        regularity: Option<f64>,
    },
    /// A state is at a configuration of the system's space.
    #[error(
        "number {number} is where the state stops being a configuration of its space: quaternions \
         have length 1"
    )]
    Configuration {
        /// The first such number.
        number: usize,
    },
    /// The explicit step in the pendulum's angle exists while the bob moves less than a rod's
    /// length.
    #[error(
        "the bob moves {ratio} rods in a step; the angle's step needs at most one",
        ratio = Readable(ratio)
    )]
    TooFast {
        /// h |speed| / L.
        ratio: f64,
    },
    /// A step of an integrator without constraints failed.
    #[error(transparent)]
    Step(#[from] StepError),
    /// Newton's method found no critical point.
    #[error("no critical point was found: {0}")]
    CriticalPoint(#[from] NewtonError),
    /// The sparse matrix was not assembled, factored or solved.
    #[cfg(feature = "sparse")]
    #[error(transparent)]
    Sparse(#[from] stationary_calculus::SparseError),
}
