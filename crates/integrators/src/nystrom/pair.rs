//! A Runge-Kutta-Nystrom pair: the numbers that make a method of high order and its error estimate.
//!
//! ```text
//! p_i = c_i p - h sum_j a_ij dV_j        q_i = q + h M^-1 p_i        dV_i = dV(q_i)    i = 1..S
//! q'  = q + h M^-1 (p - h sum_j b_j dV_j)
//! p'  = p - h sum_j b'_j dV_j
//! ```
//! `q` configuration (n), `p` momentum covector (n), `M` the metric, `h` step in seconds; `c`
//! nodes, `a` (S x S) strictly lower triangular, `b` weights of the configuration and `b'` of the
//! momentum. It is made for q.. = -M^-1 dV(q): forces that depend on velocity have no place in it,
//! and for that it needs far fewer evaluations than a Runge-Kutta method of its order.
//!
//! A second pair of weights, of lower order, gives another end of the same step; the difference is
//! the estimate of the step's error. Necessary order conditions are tested here; the order itself
//! is measured beside the stages.

/// The coefficients of a pair with `S` stages.
pub trait NystromPair<const S: usize> {
    /// The method's name in the field, with lower-case letters and hyphens.
    const NAME: &'static str;
    /// The order of the method, and of its error estimate.
    const ORDERS: (u32, u32);
    /// Whether the last stage is the end of the step, and so the first of the next.
    const FIRST_SAME_AS_LAST: bool;
    /// `c`: where in the step a stage lies.
    const NODES: [f64; S];
    /// `a`: by rows.
    const A: [[f64; S]; S];
    /// `b`.
    const B: [f64; S];
    /// `b'`.
    const B_MOMENTUM: [f64; S];
    /// The weights of lower order for the configuration.
    const LOWER: [f64; S];
    /// The weights of lower order for the momentum.
    const LOWER_MOMENTUM: [f64; S];
    /// `b` less the weights of lower order: the error of the configuration.
    const ERROR: [f64; S] = difference(Self::B, Self::LOWER);
    /// `b'` less the weights of lower order: the error of the momentum.
    const ERROR_MOMENTUM: [f64; S] = difference(Self::B_MOMENTUM, Self::LOWER_MOMENTUM);
}

const fn difference<const S: usize>(a: [f64; S], b: [f64; S]) -> [f64; S] {
    let mut difference = [0.0; S];
    let mut i = 0;
    while i < S {
        difference[i] = a[i] - b[i];
        i += 1;
    }
    difference
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Pair8, Pair12};

    /// Products of coefficients as large as 50 cancel.
    const ROUNDING: f64 = 1e-13;

    fn powers<const S: usize>(weights: [f64; S], nodes: [f64; S], k: u32) -> f64 {
        weights.iter().zip(nodes).map(|(w, c)| w * c.powi(k as i32)).sum()
    }

    /// The largest order for which weights of configuration and momentum integrate every power, and
    /// every power of a power's double integral.
    fn order_met<T: NystromPair<S>, const S: usize>(b: [f64; S], b_momentum: [f64; S]) -> u32 {
        let meets = |order: u32| {
            let (k, x) = (order - 1, f64::from(order));
            let momentum = (powers(b_momentum, T::NODES, k) - 1.0 / x).abs();
            let mut worst = momentum;
            if order > 1 {
                let exact = 1.0 / (x * (x - 1.0));
                worst = worst.max((powers(b, T::NODES, k - 1) - exact).abs());
            }
            for inner in 0..order.saturating_sub(2) {
                let outer = order - 3 - inner;
                let stage = T::A.map(|row| powers(row, T::NODES, inner));
                let weights = std::array::from_fn(|i| b_momentum[i] * stage[i]);
                let exact = 1.0 / (f64::from((inner + 1) * (inner + 2)) * x);
                worst = worst.max((powers(weights, T::NODES, outer) - exact).abs());
            }
            worst < ROUNDING
        };
        (1..20).take_while(|&order| meets(order)).last().unwrap_or(0)
    }

    fn coefficients_are_those_of_their_orders<T: NystromPair<S>, const S: usize>() {
        assert_eq!(order_met::<T, S>(T::B, T::B_MOMENTUM), T::ORDERS.0, "{}", T::NAME);
        assert_eq!(order_met::<T, S>(T::LOWER, T::LOWER_MOMENTUM), T::ORDERS.1, "{}", T::NAME);
        for (i, row) in T::A.iter().enumerate() {
            assert!(row[i..].iter().all(|&a| a == 0.0), "stage {i} is explicit");
            let half_square = 0.5 * T::NODES[i] * T::NODES[i];
            assert!((row.iter().sum::<f64>() - half_square).abs() < ROUNDING, "stage {i}");
        }
        let last_is_the_end = T::A[S - 1] == T::B && T::NODES[S - 1] == 1.0;
        assert_eq!(last_is_the_end, T::FIRST_SAME_AS_LAST);
    }

    #[test]
    fn the_coefficients_meet_the_order_conditions_of_powers_up_to_their_order_and_no_further() {
        coefficients_are_those_of_their_orders::<Pair8, 9>();
        coefficients_are_those_of_their_orders::<Pair12, 17>();
    }
}
