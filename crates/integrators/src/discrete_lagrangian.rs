//! Discrete Lagrangians: one function of two configurations, and the momenta at both ends.
//!
//! ```text
//! S = sum_i h_i L_d(q_i, q_i+1, h_i)       the action of a path, joule seconds            (5.4)
//! p0 = -h d1 L_d(q0, q1, h)                momentum before the step
//! p1 =  h d2 L_d(q0, q1, h)                momentum after the step
//! ```
//! `q0 q1` configurations (N), `h` the time between them in seconds, `p0 p1` momentum covectors (N),
//! `d1 d2` differentials by the first and the second configuration.
//!
//! L_d is in joules: a mean of the Lagrangian over the step, *not* multiplied by h. Other authors
//! write the integral, h L_d, for it; here the h stands in the action and in both discrete Legendre
//! transforms. That p1 of one step is p0 of the next is the discrete Euler-Lagrange equation
//! `h_i-1 d2 L_d(q_i-1, q_i) + h_i d1 L_d(q_i, q_i+1) = 0`, so a step from (q0, p0) to (q1, p1) is a
//! symplectic map whatever L_d is: see [`Variational`](crate::Variational).
//! Source: notes 5.4, 5.5; errata 5.5 and conventions; Marsden and West (2001).

use stationary_calculus::{Covector, Number, array, directional_derivative, second_differential};

use crate::lagrangian::{ALONG, FIRST, SECOND};
use crate::{
    Conservation, Damping, EnergyBehavior, ErrorGrowth, Evaluation, Facts, Stability, Symplecticity,
};

/// The least that is true of the integrator of any consistent discrete Lagrangian: order 1, not
/// symmetric, no promise of stability. Momenta are kept where the discrete Lagrangian has the
/// symmetry.
pub const VARIATIONAL: Facts = Facts {
    name: "variational",
    order: 1,
    stages: 1,
    evaluation: Evaluation::Implicit,
    symmetric: false,
    symplecticity: Symplecticity::Symplectic,
    energy: EnergyBehavior::Bounded,
    linear_momentum: Conservation::Exact,
    angular_momentum: Conservation::Exact,
    stability: Stability::Below(0.0),
    damping: Damping::Conditional,
    error_growth: ErrorGrowth::Linear,
};

/// A discrete Lagrangian of N freedoms, written once over any [`Number`].
pub trait DiscreteLagrangian<const N: usize> {
    /// `L_d(q0, q1, h)`, joules: a mean of the Lagrangian over the step.
    fn value<R: Number>(&self, q0: [R; N], q1: [R; N], h: f64) -> R;

    /// What is known of its integrator.
    fn facts(&self) -> Facts {
        VARIATIONAL
    }

    /// The momentum before the step, `-h d1 L_d`.
    fn momentum_before(&self, q0: [f64; N], q1: [f64; N], h: f64) -> Covector<[f64; N]> {
        differential(self, [q0, q1], h, End::First, -h)
    }

    /// The momentum after the step, `h d2 L_d`.
    fn momentum_after(&self, q0: [f64; N], q1: [f64; N], h: f64) -> Covector<[f64; N]> {
        differential(self, [q0, q1], h, End::Last, h)
    }
}

impl<L: DiscreteLagrangian<N>, const N: usize> DiscreteLagrangian<N> for &L {
    fn value<R: Number>(&self, q0: [R; N], q1: [R; N], h: f64) -> R {
        L::value(self, q0, q1, h)
    }

    fn facts(&self) -> Facts {
        L::facts(self)
    }
}

/// An end of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    First = 0,
    Last = 1,
}

/// `scale` times the differential of L_d by the configuration at one end.
fn differential<L: DiscreteLagrangian<N> + ?Sized, const N: usize>(
    lagrangian: &L,
    ends: [[f64; N]; 2],
    h: f64,
    end: End,
    scale: f64,
) -> Covector<[f64; N]> {
    Covector(array(|i| {
        let along = |[s]: [_; 1]| shifted(lagrangian, ends, h, [(end, i, s)]);
        let derivative: f64 = directional_derivative(along, [0.0], ALONG);
        scale * derivative
    }))
}

/// Adds h times the second differential of L_d to an N x N matrix by columns: the derivative of row
/// i of the differential at the end `row` by freedom j of the end `column`.
pub(crate) fn add_second_differential<L: DiscreteLagrangian<N>, const N: usize>(
    lagrangian: &L,
    ends: [[f64; N]; 2],
    h: f64,
    (row, column): (End, End),
    matrix: &mut [f64],
) {
    for (k, entry) in matrix.iter_mut().enumerate() {
        let (i, j) = (k % N, k / N);
        let both = |[s, t]: [_; 2]| shifted(lagrangian, ends, h, [(row, i, s), (column, j, t)]);
        let derivative: f64 = second_differential(both, [0.0; 2], FIRST, SECOND);
        *entry += h * derivative;
    }
}

/// L_d where some freedoms of the ends are moved.
fn shifted<R: Number, L: DiscreteLagrangian<N> + ?Sized, const N: usize, const K: usize>(
    lagrangian: &L,
    ends: [[f64; N]; 2],
    h: f64,
    shifts: [(End, usize, R); K],
) -> R {
    let mut ends = ends.map(|q| q.map(R::from));
    for (end, freedom, by) in shifts {
        ends[end as usize][freedom] += by;
    }
    lagrangian.value(ends[0], ends[1], h)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A unit mass in the field V = q^3/3, sampled at the end of the step (notes 5.5).
    struct Worked;

    impl DiscreteLagrangian<1> for Worked {
        fn value<R: Number>(&self, [q0]: [R; 1], [q1]: [R; 1], h: f64) -> R {
            let v = (q1 - q0) / h;
            v * v * 0.5 - q1.powi(3) / 3.0
        }
    }

    #[test]
    fn the_momenta_are_those_of_the_worked_example() {
        let (q0, q1, h) = (0.3, 0.45, 0.1);
        let v = (q1 - q0) / h;
        let before = Worked.momentum_before([q0], [q1], h).0[0];
        let after = Worked.momentum_after([q0], [q1], h).0[0];
        assert!((before - v).abs() < 1e-15);
        assert!((after - (v - h * q1 * q1)).abs() < 1e-15);
    }

    #[test]
    fn second_differentials_are_those_of_the_worked_example() {
        let (q0, q1, h) = (0.3, 0.45, 0.1);
        let block = |ends| {
            let mut block = [10.0];
            add_second_differential(&Worked, [[q0], [q1]], h, ends, &mut block);
            block[0] - 10.0
        };
        assert!((block((End::First, End::First)) - 1.0 / h).abs() < 1e-14);
        assert!((block((End::First, End::Last)) + 1.0 / h).abs() < 1e-14);
        assert!((block((End::Last, End::Last)) - (1.0 / h - h * 2.0 * q1)).abs() < 1e-14);
    }
}
