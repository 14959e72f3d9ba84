//! The slope of a power law: what an order of convergence is measured by.
//!
//! ```text
//! y ~ C x^k,    k = cov(ln x, ln y)/var(ln x)           least squares in log-log
//! ```
//! Points that do not obey the law, errors as large as the motion and errors of rounding, are left
//! out by the caller or by [`truncation_regime`]: `loglog_slope(truncation_regime(&points))`.

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
    // Equal ones differ from their mean by its rounding.
    if logs.iter().all(|p| p.0 == logs[0].0) {
        return None;
    }
    let n = logs.len() as f64;
    let mean = |part: fn(&(f64, f64)) -> f64| logs.iter().map(part).sum::<f64>() / n;
    let (x_mean, y_mean) = (mean(|p| p.0), mean(|p| p.1));
    let variance: f64 = logs.iter().map(|p| (p.0 - x_mean).powi(2)).sum();
    let covariance: f64 = logs.iter().map(|p| (p.0 - x_mean) * (p.1 - y_mean)).sum();
    (variance > 0.0).then(|| covariance / variance)
}

/// The longest run of neighbours that obey one power law with an exponent above 0.25: the slopes of all of
/// its pairs lie within 0.25 of one another. The points come in the order of their x; without three in a
/// row there is no such run, and the slice is empty.
pub fn truncation_regime(points: &[(f64, f64)]) -> &[(f64, f64)] {
    let slopes: Vec<f64> =
        points.windows(2).map(|pair| loglog_slope(pair).unwrap_or(f64::NAN)).collect();
    let run = |start: usize| {
        let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
        let obeys = |slope: &&f64| {
            (low, high) = (low.min(**slope), high.max(**slope));
            **slope > 0.25 && high - low <= 0.25
        };
        slopes[start..].iter().take_while(obeys).count()
    };
    let mut longest = (0, 1);
    for start in 0..slopes.len() {
        let length = run(start);
        if length > longest.1 {
            longest = (start, length);
        }
    }
    let (start, length) = longest;
    if length < 2 { &[] } else { &points[start..=start + length] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_and_errors_as_large_as_the_motion_are_left_out() {
        let error = |h: f64| (3.0 * h * h + 1e-12 / h).min(0.01);
        let points: Vec<_> = (0..24).map(|k| 2_f64.powi(-k)).map(|h| (h, error(h))).collect();
        let kept = truncation_regime(&points);
        assert!((loglog_slope(kept).unwrap() - 2.0).abs() < 0.03);
        assert!(kept.len() > 6 && kept[0].0 < 0.1 && kept[kept.len() - 1].0 > 1e-5);
    }

    #[test]
    fn noise_and_constants_have_no_truncation_regime() {
        let noise: Vec<_> = (0..16).map(|k| (2_f64.powi(-k), 1e-16 * 2_f64.powi(k))).collect();
        assert!(truncation_regime(&noise).is_empty());
        let zeros: Vec<_> = (0..16).map(|k| (2_f64.powi(-k), 0.0)).collect();
        assert!(truncation_regime(&zeros).is_empty());
        assert!(truncation_regime(&[]).is_empty());
    }

    #[test]
    fn one_law_has_one_exponent_above_a_quarter_over_the_whole_run() {
        let slow: Vec<_> = (0..10).map(|k| 2_f64.powi(-k)).map(|x: f64| (x, x.powf(0.2))).collect();
        assert!(truncation_regime(&slow).is_empty());
        // Slopes 1, 1.2, 1.4 and so on: each is near the next, two of them are all of one law.
        let steps =
            (0..7).map(|k| (2_f64.powi(k), 2_f64.powf(f64::from(k) * (0.9 + 0.1 * f64::from(k)))));
        let bent: Vec<_> = steps.collect();
        assert_eq!(truncation_regime(&bent).len(), 3);
    }

    #[test]
    fn the_slope_of_a_power_law_is_its_exponent() {
        let points: Vec<_> =
            (1..6).map(|i| (f64::from(i), 7.0 * f64::from(i).powf(-2.5))).collect();
        assert!((loglog_slope(&points).unwrap() + 2.5).abs() < 1e-12);
    }

    #[test]
    fn what_has_no_slope_has_none() {
        assert_eq!(loglog_slope(&[(1.0, 1.0)]), None);
        assert_eq!(loglog_slope(&[(2.0, 1.0), (2.0, 3.0)]), None);
        for x in (1..200).map(|k| 0.1 * f64::from(k)) {
            let above: Vec<(f64, f64)> = (1..19).map(|k| (x, f64::from(k))).collect();
            assert!((2..18).all(|n| loglog_slope(&above[..n]).is_none()), "{x}");
        }
        assert_eq!(loglog_slope(&[(1.0, 1.0), (2.0, 0.0)]), None);
        assert_eq!(loglog_slope(&[(1.0, f64::NAN), (2.0, 1.0)]), None);
    }
}
