//! The second derivative of an energy along a direction, by second differences.
//!
//! ```text
//! D_k = (V(+h_k) - 2 V(0) + V(-h_k)) / h_k^2,    h_k = h_0 / 8^k      error ~ h^2
//! R_k = D_k + (D_k - D_(k-1)) / 63                                    Richardson, error ~ h^4
//! bar_k = |R_k - R_(k-1)| + 8 eps max|V| / h_k^2
//! ```
//! The estimate is the R of the smallest bar. It knows half the digits of a first difference: enough to
//! say which of two derivatives belongs to the energy.

use super::ladder::Estimate;

/// The second derivative at 0 of an energy along steps, and how well it is known.
pub(super) fn second_derivative(steps: &[f64], energy: impl Fn(f64) -> f64) -> Estimate {
    let centre = energy(0.0);
    let mut best = Estimate { value: 0.0, bar: f64::INFINITY };
    let mut before: Option<(f64, f64)> = None;
    for &h in steps {
        let (plus, minus) = (energy(h), energy(-h));
        let bend = ((plus - centre) + (minus - centre)) / (h * h);
        if !bend.is_finite() {
            before = None;
            continue;
        }
        let refined = before.map_or(bend, |(last, _)| bend + (bend - last) / 63.0);
        if let Some((_, last)) = before {
            let size = plus.abs().max(minus.abs()).max(centre.abs());
            let bar = (refined - last).abs() + 8.0 * f64::EPSILON * size / (h * h);
            if bar < best.bar {
                best = Estimate { value: refined, bar };
            }
        }
        before = Some((bend, refined));
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_derivative_is_known_to_six_digits_within_its_bar() {
        let steps: Vec<f64> = (0..12).map(|k| 0.25 * 8.0_f64.powi(-k)).collect();
        for q in [-1.3, 0.0, 0.4, 2.0] {
            let found = second_derivative(&steps, |h| (q + h).exp() + (q + h).powi(3));
            let exact = q.exp() + 6.0 * q;
            assert!((found.value - exact).abs() <= found.bar.max(1e-9), "{q} {found:?} {exact}");
            assert!(found.bar < 1e-5, "{q} {found:?}");
        }
    }
}
