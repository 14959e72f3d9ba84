//! The matrices of four elements side by side: their lower triangles, summed over the points.
//!
//! ```text
//! H_ab = sum w K(g_a, g_b)                    D x D, for nodes a >= b > 0                  (13.2)
//! H_a0 = -sum_b>0 H_ab,   H_00 = sum_ab>0 H_ab        no translation costs anything
//! ```
//! `K` the second derivative of the energy density between gradients of shape functions (Pa/m^2),
//! `w` volumes (m^3). What a body's Hessian and the matrix of its damping have in common.

use crate::material::TakesTangent;
use crate::{Lanes, Tangent};

/// Blocks `[b][a][d][c]` of four elements, a >= b: rows of node a, columns of node b.
pub(crate) type LaneHessian<const N: usize, const D: usize> = [[[[Lanes; D]; D]; N]; N];

/// Makes room for the sum over the points; a single point needs none.
#[inline(always)]
pub(crate) fn begin<const N: usize, const D: usize, const Q: usize>(
    hessian: &mut LaneHessian<N, D>,
) {
    if Q > 1 {
        *hessian = [[[[Lanes::default(); D]; D]; N]; N];
    }
}

/// Sums the lower triangle of the blocks between the nodes after the first.
pub(crate) struct Accumulation<'a, const N: usize, const D: usize, const R: usize, const Q: usize> {
    pub(crate) hessian: &'a mut LaneHessian<N, D>,
    pub(crate) gradients: &'a [[Lanes; R]; N],
}

impl<const N: usize, const D: usize, const R: usize, const Q: usize> Accumulation<'_, N, D, R, Q> {
    #[inline(always)]
    fn visit<A: Tangent<Lanes, D, R>>(&mut self, tangent: &A, put: impl Fn(&mut Lanes, Lanes)) {
        let mut nodes = [tangent.node(&self.gradients[1]); N];
        for a in 2..N {
            nodes[a] = tangent.node(&self.gradients[a]);
        }
        for b in 1..N {
            for a in b..N {
                let block = tangent.block(&nodes[a], &nodes[b]);
                for d in 0..D {
                    for c in 0..D {
                        put(&mut self.hessian[b][a][d][c], block[d][c]);
                    }
                }
            }
        }
    }
}

impl<const N: usize, const D: usize, const R: usize, const Q: usize> TakesTangent<Lanes, D, R>
    for Accumulation<'_, N, D, R, Q>
{
    /// Adds it, or sets the sum where there is only one point.
    #[inline(always)]
    fn take(&mut self, tangent: &impl Tangent<Lanes, D, R>) {
        if Q == 1 {
            self.visit(tangent, |sum, entry| *sum = entry);
        } else {
            self.visit(tangent, |sum, entry| *sum += entry);
        }
    }

    // Once in the program for all the directions that are added.
    #[inline(never)]
    fn add(&mut self, tangent: &impl Tangent<Lanes, D, R>) {
        self.visit(tangent, |sum, entry| *sum += entry);
    }
}

/// Gives the first node what the others leave: no translation costs anything.
#[inline(always)]
pub(crate) fn complete<const N: usize, const D: usize>(hessian: &mut LaneHessian<N, D>) {
    for d in 0..D {
        for c in 0..D {
            let mut corner = Lanes::default();
            for a in 1..N {
                // Row c of node a, column d of node 0: what is left over of that row.
                let mut sum = Lanes::default();
                for b in 1..N {
                    sum += if a >= b { hessian[b][a][d][c] } else { hessian[a][b][c][d] };
                }
                hessian[0][a][d][c] = -sum;
                corner += sum;
            }
            hessian[0][0][d][c] = corner;
        }
    }
}
