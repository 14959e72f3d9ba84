//! The slope of a power law: what an order of convergence is measured by.
//!
//! ```text
//! y ~ C x^k,    k = cov(ln x, ln y)/var(ln x)           least squares in log-log
//! ```
//! The caller leaves out points that do not obey the law: errors as large as the motion, errors of
//! rounding.

/// The slope of the least-squares line through (ln x, ln y), of at least two distinct x.
///
/// Points with a coordinate that is not positive and finite have no logarithm; with any of them
/// there is no slope.
pub fn loglog_slope(points: &[(f64, f64)]) -> Option<f64> {
    let usable = |x: f64| x > 0.0 && x.is_finite();
    if points.len() < 2 || !points.iter().all(|&(x, y)| usable(x) && usable(y)) {
        return None;
    }
    let logs: Vec<(f64, f64)> = points.iter().map(|&(x, y)| (x.ln(), y.ln())).collect();
    let n = logs.len() as f64;
    let mean = |part: fn(&(f64, f64)) -> f64| logs.iter().map(part).sum::<f64>() / n;
    let (x_mean, y_mean) = (mean(|p| p.0), mean(|p| p.1));
    let variance: f64 = logs.iter().map(|p| (p.0 - x_mean).powi(2)).sum();
    let covariance: f64 = logs.iter().map(|p| (p.0 - x_mean) * (p.1 - y_mean)).sum();
    (variance > 0.0).then(|| covariance / variance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_of_a_power_law_is_its_exponent() {
        let points: Vec<_> = (1..6).map(|i| (f64::from(i), 7.0 * f64::from(i).powf(-2.5))).collect();
        assert!((loglog_slope(&points).unwrap() + 2.5).abs() < 1e-12);
    }

    #[test]
    fn what_has_no_slope_has_none() {
        assert_eq!(loglog_slope(&[(1.0, 1.0)]), None);
        assert_eq!(loglog_slope(&[(2.0, 1.0), (2.0, 3.0)]), None);
        assert_eq!(loglog_slope(&[(1.0, 1.0), (2.0, 0.0)]), None);
        assert_eq!(loglog_slope(&[(1.0, f64::NAN), (2.0, 1.0)]), None);
    }
}
