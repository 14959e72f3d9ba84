//! Elements four at a time: their nodes, and what is known of them at rest.
//!
//! ```text
//! x_a - x_0          corners of four elements (m), node 0 the one of the lowest number
//! F = sum_a>0 (x_a - x_0) (x) g_a             D x R, at one quadrature point           (13.2)
//! ```
//! `g_a` gradients of the shape functions at rest (1/m). They add up to zero, hence the corner that
//! is left out.

use crate::lanes::LANES;
use crate::shape::Point;
use crate::{Freedoms, Lanes, Real};
use stationary_calculus::array;

/// Four elements side by side.
#[derive(Clone, Debug)]
pub(crate) struct Group<const N: usize, const R: usize, const Q: usize> {
    /// What stands for each node, lane by lane, in the order of their numbers.
    pub(crate) nodes: [[u32; N]; LANES],
    /// How many of the lanes are elements; the others repeat the last one, without weight.
    pub(crate) filled: usize,
    pub(crate) weights: [Lanes; Q],
    pub(crate) gradients: [[[Lanes; R]; N]; Q],
}

impl<const N: usize, const R: usize, const Q: usize> Group<N, R, Q> {
    /// Groups of elements in their order, by their nodes and by what they are at their points.
    pub(crate) fn all<const D: usize>(
        elements: &[[usize; N]],
        points: &[Point<N, R>],
        section: f64,
        freedoms: &Freedoms<D>,
    ) -> Vec<Self> {
        let ordered = elements.iter().map(|nodes| Order::of(nodes, freedoms));
        let pairs: Vec<_> = ordered.zip(points.chunks_exact(Q)).collect();
        let groups = pairs.chunks(LANES).map(|pairs| {
            let filled = pairs.len();
            let lane = |lane: usize| &pairs[lane.min(filled - 1)];
            let weight =
                |l: usize, q: usize| if l < filled { lane(l).1[q].size * section } else { 0.0 };
            let from_lanes = |of: &dyn Fn(usize) -> f64| Lanes::from(array(of));
            Group {
                nodes: array(|l| lane(l).0.starts),
                filled,
                weights: array(|q| from_lanes(&|l| weight(l, q))),
                gradients: array(|q| {
                    array(|a| {
                        array(|k| from_lanes(&|l| lane(l).1[q].gradients[lane(l).0.places[a]][k]))
                    })
                }),
            }
        });
        groups.collect()
    }

    /// The corners at a configuration, all but the first one relative to that.
    #[inline(always)]
    pub(crate) fn corners<const D: usize>(
        &self,
        freedoms: &Freedoms<D>,
        q: &[f64],
    ) -> [[Lanes; D]; N] {
        let mut x = [[Lanes::default(); D]; N];
        for a in 0..N {
            // A loop, for a closure handed to `map` may stay a call.
            let mut positions = [[0.0; D]; LANES];
            for (position, nodes) in positions.iter_mut().zip(&self.nodes) {
                *position = freedoms.position(nodes[a], q);
            }
            for c in 0..D {
                x[a][c] = Lanes::from(array(|lane| positions[lane][c]));
            }
        }
        for a in 1..N {
            for c in 0..D {
                x[a][c] = x[a][c] - x[0][c];
            }
        }
        x
    }
}

/// F at a quadrature point, from the corners less the first one.
#[inline(always)]
pub(crate) fn deformation<const N: usize, const D: usize, const R: usize>(
    x: &[[Lanes; D]; N],
    gradients: &[[Lanes; R]; N],
) -> [[Lanes; D]; R] {
    let mut f = [[Lanes::default(); D]; R];
    for k in 0..R {
        for c in 0..D {
            let mut sum = x[1][c] * gradients[1][k];
            for a in 2..N {
                sum = x[a][c].multiply_add(gradients[a][k], sum);
            }
            f[k][c] = sum;
        }
    }
    f
}

/// The nodes of an element by their numbers, in whose order freedoms are numbered too: its matrix
/// has its lower triangle where the whole one has it.
struct Order<const N: usize> {
    starts: [u32; N],
    places: [usize; N],
}

impl<const N: usize> Order<N> {
    fn of<const D: usize>(nodes: &[usize; N], freedoms: &Freedoms<D>) -> Self {
        let mut places: [usize; N] = array(|a| a);
        places.sort_by_key(|&a| nodes[a]);
        Order { starts: array(|a| freedoms.start(nodes[places[a]])), places }
    }
}
