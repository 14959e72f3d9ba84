//! The second derivative of an energy along a direction, by second differences.
//!
//! ```text
//! R_k0 = (V(+h_k) - 2 V(0) + V(-h_k)) / h_k^2,    h_k = h_0 / 2^k          error ~ h^2
//! R_km = R_k(m-1) + (R_k(m-1) - R_(k-1)(m-1)) / (4^m - 1)                  error ~ h^(2 m + 2)
//! bar  = max(|R_km - R_k(m-1)|, |R_km - R_(k-1)(m-1)|) + 8 eps (max|V| + L |V'|) / h_k^2
//! ```
//! `L` the size of the arguments, which are rounded. The estimate is the R of the smallest bar that no
//! smaller step contradicts: over steps far longer than its waves a bounded energy seems not to bend
//! at all. It knows half the digits of a first difference, which is enough to say which of two
//! derivatives belongs to the energy. Source: Richardson (1911), Ridders (1982).

use super::ladder::Estimate;

/// Extrapolations of one step.
const ORDERS: usize = 4;
/// How far rounding may exceed one unit of it.
const SAFETY: f64 = 8.0;

/// The second derivative at 0 of an energy, by steps from the largest to the smallest, and how well it
/// is known. `arguments`: the size of the numbers that the energy is computed from.
pub(super) fn second_derivative(
    (largest, smallest): (f64, f64),
    arguments: f64,
    energy: impl Fn(f64) -> f64,
) -> Estimate {
    let centre = energy(0.0);
    let mut estimates: Vec<Estimate> = Vec::new();
    let mut before: Vec<f64> = Vec::new();
    let mut h = largest;
    while h >= smallest {
        let (plus, minus) = (energy(h), energy(-h));
        let bend = ((plus - centre) + (minus - centre)) / (h * h);
        if bend.is_finite() {
            let size = plus.abs().max(minus.abs()).max(centre.abs());
            let slope = (plus - minus).abs() / (2.0 * h);
            let rounding = SAFETY * f64::EPSILON * (size + arguments * slope) / (h * h);
            let row = extrapolated(bend, &before);
            estimates.extend(best_of_row(&row, &before, rounding));
            before = row;
        } else {
            before.clear();
        }
        h *= 0.5;
    }
    uncontradicted(&estimates)
}

/// The row of the tableau that begins with `bend`, from the row of the step before.
fn extrapolated(bend: f64, before: &[f64]) -> Vec<f64> {
    let mut row = vec![bend];
    for (m, &last) in before.iter().take(ORDERS).enumerate() {
        let weight = 4.0_f64.powi(m as i32 + 1) - 1.0;
        row.push(row[m] + (row[m] - last) / weight);
    }
    row
}

/// The entry of a row that is known best; none of the first row.
fn best_of_row(row: &[f64], before: &[f64], rounding: f64) -> Option<Estimate> {
    let estimate = |(pair, last): (&[f64], &f64)| {
        let value = pair[1];
        let bar = (value - pair[0]).abs().max((value - last).abs()) + rounding;
        Estimate { value, bar }
    };
    let estimates = row.windows(2).zip(before).map(estimate);
    estimates.min_by(|a, b| a.bar.total_cmp(&b.bar))
}

/// The estimate of the smallest bar that none of a smaller step contradicts.
fn uncontradicted(estimates: &[Estimate]) -> Estimate {
    let contradicts = |a: &Estimate, b: &Estimate| (a.value - b.value).abs() > a.bar + b.bar;
    let stands = |k: &usize| estimates[k + 1..].iter().all(|b| !contradicts(b, &estimates[*k]));
    let standing = (0..estimates.len()).filter(stands).map(|k| estimates[k]);
    standing.min_by(|a, b| a.bar.total_cmp(&b.bar)).unwrap_or(Estimate::NONE)
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEPS: (f64, f64) = (0.25, 1e-12);

    #[test]
    fn a_second_derivative_is_known_to_eight_digits_within_its_bar() {
        for q in [-1.3, 0.0, 0.4, 2.0] {
            let energy = |h: f64| (q + h).exp() + (q + h).powi(3);
            let found = second_derivative(STEPS, 1.0, energy);
            let exact = q.exp() + 6.0 * q;
            assert!((found.value - exact).abs() <= found.bar, "{q} {found:?} {exact}");
            assert!(found.bar < 1e-8, "{q} {found:?}");
        }
    }

    #[test]
    fn a_load_a_million_times_the_energy_leaves_five_digits() {
        let found = second_derivative(STEPS, 1.0, |h| 1e6 * (0.7 + h) + (0.3 + h).powi(4));
        let exact = 12.0 * 0.3 * 0.3;
        assert!((found.value - exact).abs() <= found.bar, "{found:?}");
        assert!(found.bar < 1e-5, "{found:?}");
    }

    #[test]
    fn waves_far_shorter_than_the_first_steps_are_seen_all_the_same() {
        let wave = 1e6;
        let found = second_derivative(STEPS, 1.0, |h| (0.3 + wave * h).cos());
        let exact = -wave * wave * 0.3_f64.cos();
        assert!((found.value - exact).abs() <= found.bar, "{found:?}");
        assert!(found.bar < 1e-5 * exact.abs(), "{found:?}");
    }
}
