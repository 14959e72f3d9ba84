//! What can be wrong with a mesh, and where.

use std::fmt;

/// The places where something is wrong, all of them, in the mesh's order.
#[derive(Clone, Debug, PartialEq)]
pub struct Places<T>(pub Vec<T>);

impl<T: fmt::Debug> fmt::Display for Places<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const SHOWN: usize = 5;
        for (k, place) in self.0.iter().take(SHOWN).enumerate() {
            write!(f, "{}{place:?}", if k == 0 { "" } else { ", " })?;
        }
        match self.0.len() {
            ..=SHOWN => Ok(()),
            all => write!(f, " and {} more", all - SHOWN),
        }
    }
}

impl<T> Places<T> {
    /// `Err` with the error made of these places, if there are any.
    pub(crate) fn refuse(
        places: Vec<T>,
        error: impl FnOnce(Places<T>) -> MeshError,
    ) -> Result<(), MeshError> {
        if places.is_empty() { Ok(()) } else { Err(error(Places(places))) }
    }
}

/// A mesh, an outline or a shape that cannot be. Faces are named by their vertices.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// A coordinate is infinite or not a number.
    #[error("component {component} of vertex {vertex} is {value}; coordinates must be finite")]
    NonFinite {
        /// Which vertex.
        vertex: usize,
        /// Which of its coordinates.
        component: usize,
        /// Its value.
        value: f64,
    },
    /// A coordinate whose powers leave the range of numbers.
    #[error(
        "component {component} of vertex {vertex} is {value:e}; the limit is {limit:e} in size"
    )]
    TooFar {
        /// Which vertex.
        vertex: usize,
        /// Which of its coordinates.
        component: usize,
        /// Its value.
        value: f64,
        /// The largest size.
        limit: f64,
    },
    /// A simplex names a vertex that does not exist.
    #[error("simplex {simplex} names vertex {vertex}; there are {vertices}")]
    NoSuchVertex {
        /// Which simplex.
        simplex: usize,
        /// The vertex it names.
        vertex: usize,
        /// How many there are.
        vertices: usize,
    },
    /// Simplices that name a vertex twice.
    #[error("a vertex appears twice in simplices {0}")]
    RepeatedVertex(Places<usize>),
    /// Simplices without length, area or volume.
    #[error("simplices of no size: {0}")]
    Degenerate(Places<usize>),
    /// Simplices of negative area or volume.
    #[error("simplices turned inside out: {0}")]
    Inverted(Places<usize>),
    /// Vertices that no simplex names.
    #[error("vertices that no simplex names: {0}")]
    Unreferenced(Places<usize>),
    /// Faces shared by more than two simplices.
    #[error("more than two simplices meet at {0}")]
    NonManifold(Places<Vec<usize>>),
    /// Vertices or edges at which sheets or solids touch that are not neighbours across a face.
    #[error("simplices touch without sharing a face at {0}")]
    Pinched(Places<Vec<usize>>),
    /// Faces of a surface that ought to be closed, with a simplex on one side only.
    #[error("open at {0}")]
    Open(Places<Vec<usize>>),
    /// Faces whose two simplices are oriented against each other.
    #[error("neighbours are oriented against each other at {0}")]
    Inconsistent(Places<Vec<usize>>),
    /// No choice of orientations agrees everywhere, as on a Moebius strip.
    #[error("not orientable; the contradiction shows at {0}")]
    NotOrientable(Places<Vec<usize>>),
    /// Components that face inward where they ought to face outward, or outward around a cavity.
    #[error("inside out: components of the simplices {0}")]
    InsideOut(Places<usize>),
    /// Closed components that enclose nothing, each named by its first simplex.
    #[error("nothing is enclosed by the components of the simplices {0}")]
    NothingEnclosed(Places<usize>),
    /// Simplices that pass through each other, the first thousand pairs.
    #[error("simplices that pass through each other: {0}")]
    Overlapping(Places<(usize, usize)>),
    /// Nothing to work on.
    #[error("there are no simplices")]
    Empty,
    /// An outline needs three corners.
    #[error("outline {outline} has {corners} corners; it needs at least three")]
    ShortOutline {
        /// Which outline.
        outline: usize,
        /// How many it has.
        corners: usize,
    },
    /// An outline so small that products of its coordinates leave the range of numbers.
    #[error("outline {outline} is {size:e} across; the least is {least:e}")]
    SmallOutline {
        /// Which outline.
        outline: usize,
        /// The longer side of the box around it.
        size: f64,
        /// The least that it may be.
        least: f64,
    },
    /// A corner of an outline in the same place as the one before it.
    #[error("corner {corner} of outline {outline} is where the one before it is")]
    RepeatedCorner {
        /// Which outline.
        outline: usize,
        /// Which of its corners.
        corner: usize,
    },
    /// Edges of outlines that cross or touch; an edge is (outline, its first corner).
    #[error("edges (outline, corner) that cross or touch: {0}")]
    Crossing(Places<((usize, usize), (usize, usize))>),
    /// Three lengths that no triangle has.
    #[error("no triangle has the edge lengths of simplices {0}")]
    TriangleInequality(Places<usize>),
    /// Flips that do not come to an end.
    #[error("edges are not Delaunay after {limit} flips")]
    TooManyFlips {
        /// How many were made.
        limit: usize,
    },
    /// Boundary sides that face obtuse angles however often they are split.
    #[error("after {rounds} rounds and {splits} splits boundary sides still face obtuse angles")]
    TooManySplits {
        /// How many rounds there were.
        rounds: usize,
        /// How many sides were split.
        splits: usize,
    },
    /// A size that must be positive and finite.
    #[error("{what} is {value:?}; it must be positive and finite")]
    Size {
        /// Which size.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// Two sizes in the wrong order.
    #[error("{smaller} is {value:?}; it must be less than {larger}, {bound:?}")]
    Order {
        /// What must be smaller.
        smaller: &'static str,
        /// Its value.
        value: f64,
        /// What must be larger.
        larger: &'static str,
        /// The value of that.
        bound: f64,
    },
    /// Too few cells for a shape.
    #[error("{what} is {given}; the least is {least}")]
    TooFew {
        /// Cells along what.
        what: &'static str,
        /// How many were asked for.
        given: usize,
        /// How many there must be.
        least: usize,
    },
    /// More simplices than a mesh may have.
    #[error("{what} would have more than {limit} simplices")]
    TooMany {
        /// Which shape.
        what: &'static str,
        /// The limit.
        limit: usize,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_shows_the_first_places_and_counts_the_rest() {
        let few = MeshError::Degenerate(Places(vec![3, 5]));
        assert_eq!(few.to_string(), "simplices of no size: 3, 5");
        let many = MeshError::Unreferenced(Places((0..9).collect()));
        assert_eq!(many.to_string(), "vertices that no simplex names: 0, 1, 2, 3, 4 and 4 more");
    }
}
