//! Where two shapes that face each other meet: the contact at two of their points.
//!
//! ```text
//! x_k = R_k y_k + t_k,   n = R_1 m         y_k in the axes of its shape, m from the first to the second
//! mu = (mu_1 mu_2)^1/2,   c = min c_k      friction and restitution, where a pair has none of its own
//! ```

use stationary_calculus::array;

use crate::shapes::dimension::Facing;
use crate::{ContactIn, DetectorIn, Dimension};

/// What all contacts of a pair share.
pub(super) struct MetPair<G: Dimension> {
    colliders: [usize; 2],
    bodies: [Option<usize>; 2],
    /// Where the shapes are, and where in their bodies.
    placed: [(G::Frame, G::Vector); 2],
    own: [(G::Frame, G::Vector); 2],
    /// Restitution and friction.
    surface: [f64; 2],
}

impl<G: Dimension> MetPair<G> {
    /// The contact where two points face each other.
    #[inline]
    pub(super) fn point(&self, facing: &Facing<G::Vector>) -> ContactIn<G> {
        let at = |places: &[(G::Frame, G::Vector); 2]| {
            array(|side| {
                let (frame, from) = &places[side];
                G::rotate(frame, &facing.points[side]) + *from
            })
        };
        let [restitution, friction] = self.surface;
        ContactIn {
            id: facing.id(self.colliders),
            bodies: self.bodies,
            gap: facing.gap,
            normal: G::rotate(&self.placed[0].0, &facing.normal),
            points: at(&self.placed),
            arms: at(&self.own),
            restitution,
            friction,
        }
    }
}

impl<G: Dimension> DetectorIn<G> {
    /// What all contacts of a pair share.
    pub(super) fn met(&self, pair: [usize; 2], placed: &[G::Motion; 2]) -> MetPair<G> {
        let [first, second] = pair.map(|i| &self.colliders[i]);
        let own = || {
            [first.restitution.min(second.restitution), (first.friction * second.friction).sqrt()]
        };
        let place = |motion: &G::Motion| (G::frame(motion), G::translation(motion));
        MetPair {
            colliders: pair,
            bodies: [first.body(), second.body()],
            placed: placed.each_ref().map(place),
            own: [place(&first.place), place(&second.place)],
            surface: self.surfaces.get(&pair).copied().unwrap_or_else(own),
        }
    }
}
