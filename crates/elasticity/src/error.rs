//! What can be wrong with a spring, a net, a material or a body.

use stationary_calculus::{
    MetricError, NewtonError, Readable, SizeError, SparseError, UnknownVertex,
};
use stationary_mesh::{MeshError, Places};

use crate::Weave;

/// A spring or a net that cannot be.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SpringError {
    /// Both ends are the same vertex.
    #[error("both ends of the spring are vertex {0}")]
    Loop(usize),
    /// A stiffness must be positive and finite.
    #[error("the stiffness is {} N/m; it must be positive and finite", Readable(.0))]
    Stiffness(f64),
    /// A rest length must be finite, and positive or, for Cauchy strain, zero.
    #[error(
        "the rest length is {} m; it must be finite and positive, or zero with Cauchy strain",
        Readable(.0)
    )]
    RestLength(f64),
    /// Indices have 32 bits.
    #[error("a net of {rows} x {columns} vertices has more than 32-bit indices can tell apart")]
    TooMany {
        /// Vertices down.
        rows: usize,
        /// Vertices across.
        columns: usize,
    },
    /// A net needs two rows and two columns.
    #[error("a net of {rows} x {columns} vertices has no cells; each side needs at least two")]
    NetSize {
        /// Vertices down.
        rows: usize,
        /// Vertices across.
        columns: usize,
    },
}

/// A material, a body or a static problem that cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ElasticityError {
    /// A spring that cannot be.
    #[error(transparent)]
    Spring(#[from] SpringError),
    /// A pair that gives energy away for some strain.
    #[error(
        "lambda = {lambda} Pa and mu = {mu} Pa in {dimensions} dimensions: mu and the bulk modulus \
         must be positive, and their sums finite",
        lambda = Readable(lambda), mu = Readable(mu)
    )]
    Lame {
        /// The first parameter, Pa.
        lambda: f64,
        /// The second parameter, Pa.
        mu: f64,
        /// The dimension that they are meant for.
        dimensions: usize,
    },
    /// Poisson's ratio out of its bounds.
    #[error(
        "Poisson's ratio is {poisson}; it must be between -1 and {bound}, both excluded",
        poisson = Readable(poisson), bound = Readable(bound)
    )]
    Poisson {
        /// The ratio.
        poisson: f64,
        /// What it must be below.
        bound: f64,
    },
    /// Young's modulus must be positive and finite.
    #[error("Young's modulus is {} Pa; it must be positive and finite", Readable(.0))]
    Young(f64),
    /// The neo-Hookean energy has no lower bound for so negative a Poisson's ratio in the plane.
    #[error(
        "a neo-Hookean sheet needs Poisson's ratio above -1/2; it is {poisson}",
        poisson = Readable(poisson)
    )]
    NeoHookean {
        /// The ratio.
        poisson: f64,
    },
    /// The corotated energy has no lower bound for a negative Poisson's ratio.
    #[error(
        "a corotated body needs a Poisson's ratio of at least 0; it is {poisson}",
        poisson = Readable(poisson)
    )]
    Corotated {
        /// The ratio.
        poisson: f64,
    },
    /// Moduli of a woven sheet that give energy away for some strain, or are not finite.
    #[error("no woven sheet has these moduli: {0:?}")]
    Weave(Weave),
    /// A damping that would give energy, or is not finite.
    #[error("the damping is {}; it must be finite and not negative", Readable(.0))]
    Damping(f64),
    /// A density must be positive and finite.
    #[error("the density is {}; it must be positive and finite", Readable(.0))]
    Density(f64),
    /// A thickness or cross-section must be positive and finite.
    #[error("the section is {}; it must be positive and finite", Readable(.0))]
    Section(f64),
    /// A length must be positive and finite, and so must what follows from it.
    #[error(
        "a length is {0:e} m; it must be positive and finite, and so must be frequencies and their \
         squares"
    )]
    Length(f64),
    /// A number of things, or the number of one of them, that there is not.
    #[error("{asked} was asked for; the least is {least} and the most {most}")]
    Count {
        /// What was asked for.
        asked: usize,
        /// The least there is.
        least: usize,
        /// The most there is.
        most: usize,
    },
    /// A bending stiffness must be positive and finite.
    #[error("the bending stiffness is {}; it must be positive and finite", Readable(.0))]
    Bending(f64),
    /// Indices have 32 bits.
    #[error("{vertices} vertices are more than 32-bit indices can tell apart")]
    TooMany {
        /// How many.
        vertices: usize,
    },
    /// A coordinate that does not exist, is held twice, or nowhere.
    #[error(
        "component {component} of vertex {vertex} cannot be held at {place}",
        place = Readable(place)
    )]
    Held {
        /// The vertex.
        vertex: usize,
        /// Its component.
        component: usize,
        /// Where it should be, m.
        place: f64,
    },
    /// As many places as there are held coordinates.
    #[error("{expected} coordinates are held, but {got} places given")]
    HeldPlaces {
        /// The held coordinates.
        expected: usize,
        /// The places.
        got: usize,
    },
    /// A configuration of another size.
    #[error("the configuration has {got} freedoms; there are {expected}")]
    Freedoms {
        /// The freedoms there are.
        expected: usize,
        /// Those that were given.
        got: usize,
    },
    /// A mesh of another size.
    #[error("{got} vertices were given; there are {expected}")]
    Vertices {
        /// The vertices there are.
        expected: usize,
        /// Those that were given.
        got: usize,
    },
    /// Vertices that no element gives a mass to.
    #[error("vertices that no element names: {0}")]
    Massless(Places<usize>),
    /// A load that is not finite.
    #[error("the load at vertex {vertex} is not finite")]
    Load {
        /// The vertex.
        vertex: usize,
    },
    /// A load that was made for a body that is held elsewhere.
    #[error(
        "the load is for other supports than the body's: give both the same numbering of freedoms"
    )]
    OtherSupports,
    /// A place that is not finite.
    #[error("the position of vertex {vertex} is not finite")]
    Position {
        /// The vertex.
        vertex: usize,
    },
    /// A stress without bound.
    #[error("the stress at vertex {vertex} is not finite: an element there is flat now")]
    Stress {
        /// The vertex.
        vertex: usize,
    },
    /// A hinge with a flat triangle, or with a vertex twice.
    #[error("a hinge needs two triangles that are not flat; vertices {vertices:?} make none")]
    FlatHinge {
        /// The ends of the edge, and the corners on either side.
        vertices: [usize; 4],
    },
    /// An angle at rest that is not finite.
    #[error("the angle of a hinge at rest is {}; it must be finite", Readable(.0))]
    Angle(f64),
    /// Errors are told relative to a displacement that is known; nothing is known of none.
    #[error(
        "the squared {what}, integrated, is {value:e}; it must be finite, and that of a known \
         displacement at least 1e-200"
    )]
    Integral {
        /// What is squared.
        what: &'static str,
        /// Its integral.
        value: f64,
    },
    /// A tolerance must not be negative, nor NaN.
    #[error(
        "the tolerance of Newton's method is {} kg^1/2 m/s^2; it must be zero or positive",
        Readable(.0)
    )]
    Tolerance(f64),
    /// A rest in which elements are turned inside out.
    #[error(
        "at rest elements are turned inside out or flat: {0}; load the body in smaller steps, or less"
    )]
    InsideOut(Places<usize>),
    /// A body, or a piece of it, that may still move as a whole.
    #[error("{count} rigid motions are free: {names}{}", of_piece(*piece, *pieces, *vertex))]
    RigidMotions {
        /// The first piece that moves, from 1, in the order of their first vertices.
        piece: usize,
        /// How many pieces there are, which no element joins.
        pieces: usize,
        /// The piece's first vertex.
        vertex: usize,
        /// How many independent ones.
        count: usize,
        /// Translations and rotations by name.
        names: String,
    },
    /// A load step that found no equilibrium.
    #[error("load step {step} of {steps}: {source}")]
    Statics {
        /// The step, from 1.
        step: usize,
        /// How many there are.
        steps: usize,
        /// Why.
        source: NewtonError,
    },
    /// A load step whose rest rounding leaves open.
    #[error(
        "load step {step} of {steps}: rounding leaves open where the body rests: {left:e} m are left of a \
         displacement of {displacement:e} m"
    )]
    Unsettled {
        /// The step, from 1.
        step: usize,
        /// How many there are.
        steps: usize,
        /// How far the rest is still off, m.
        left: f64,
        /// How far load and supports lead, m.
        displacement: f64,
    },
    /// A rest whose supports do not bear the load.
    #[error(
        "rounding leaves open what holds the body: of forces of {load:e} N the supports miss {missing:e} N"
    )]
    Unbalanced {
        /// What load and reactions leave of each other, N.
        missing: f64,
        /// The sizes of the forces, summed, N.
        load: f64,
    },
    /// No load steps at all.
    #[error("a load needs at least one step")]
    NoSteps,
    /// A mesh that cannot be: among others its elements that are flat or inside out.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A stencil names a vertex that does not exist.
    #[error(transparent)]
    UnknownVertex(#[from] UnknownVertex),
    /// Sizes that do not agree.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// A mass that is no metric.
    #[error(transparent)]
    Metric(#[from] MetricError),
    /// A sparse matrix that cannot be assembled or factored.
    #[error(transparent)]
    Sparse(#[from] SparseError),
}

/// Which of several pieces is meant.
fn of_piece(piece: usize, pieces: usize, vertex: usize) -> String {
    match pieces {
        1 => String::new(),
        _ => format!("; piece {piece} of {pieces}, that of vertex {vertex}"),
    }
}
