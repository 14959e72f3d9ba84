//! Which freedom is accelerated the most: where a step or a search for rest goes wrong.
//!
//! ```text
//! a = M^-1 dV(q)
//! ```

use stationary_calculus::{Covector, Metric, Potential, Vector, first_non_finite};

/// The freedom of the largest acceleration, or the first whose acceleration is not finite.
pub(crate) fn most_accelerated(
    metric: &impl Metric,
    potential: &impl Potential,
    q: &[f64],
) -> usize {
    let (mut dv, mut a) = (Covector(vec![0.0; q.len()]), Vector(vec![0.0; q.len()]));
    potential.add_differential(q, dv.view_mut());
    metric.sharp(dv.view(), a.view_mut());
    let a = a.components();
    let larger = |largest: usize, i: usize| if a[i].abs() > a[largest].abs() { i } else { largest };
    first_non_finite(a).unwrap_or_else(|| (0..a.len()).fold(0, larger))
}
