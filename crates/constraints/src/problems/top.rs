//! The highest point of a periodic function that is smooth but for some angles: the largest of its maxima, each
//! refined to rounding.

use std::f64::consts::TAU;

/// Angles between which a function has one maximum at most.
const ANGLES: u32 = 512;
/// How often the distance to a sharp angle is halved.
const HALVINGS: i32 = 40;
/// Steps of the golden section: each leaves 0.618 of two angles' distance, and the value is flat there.
const STEPS: u32 = 45;
/// What a step of the golden section leaves.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// The angle of the highest value, and that value; `None` where no angle has one. Beside the angles `sharp` there may
/// be maxima however narrow.
pub(super) fn top(value: impl Fn(f64) -> f64, sharp: &[f64]) -> Option<(f64, f64)> {
    let step = TAU / f64::from(ANGLES);
    let at = |i: u32| value(step * f64::from(i % ANGLES));
    let (mut before, mut here) = (at(ANGLES - 1), at(0));
    let mut highest: Option<(f64, f64)> = None;
    let mut look = |angle: f64, within: f64| {
        let found = refined(&value, angle, within);
        if highest.is_none_or(|(_, height)| found.1 > height) {
            highest = Some(found);
        }
    };
    for i in 0..ANGLES {
        let after = at(i + 1);
        if here >= before && here >= after {
            look(step * f64::from(i), step);
        }
        (before, here) = (here, after);
    }
    for end in sharp {
        for way in [step, -step] {
            let beside = |k: i32| end + way * 0.5_f64.powi(k);
            for k in 0..HALVINGS {
                let [outer, here, inner] = [k - 1, k, k + 1].map(|k| value(beside(k)));
                if here >= outer && here >= inner {
                    look(beside(k), (beside(k) - end).abs());
                }
            }
        }
    }
    highest
}

/// The maximum within a distance of an angle, by the golden section.
fn refined(value: &impl Fn(f64) -> f64, angle: f64, within: f64) -> (f64, f64) {
    let (mut low, mut high) = (angle - within, angle + within);
    let mut best = (angle, value(angle));
    let mut inner = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
    let mut values = inner.map(value);
    for _ in 0..STEPS {
        for (angle, value) in inner.into_iter().zip(values) {
            if value > best.1 {
                best = (angle, value);
            }
        }
        if values[0] > values[1] {
            high = inner[1];
            inner = [high - GOLDEN * (high - low), inner[0]];
            values = [value(inner[0]), values[0]];
        } else {
            low = inner[0];
            inner = [inner[1], low + GOLDEN * (high - low)];
            values = [values[1], value(inner[1])];
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_higher_of_two_near_maxima_is_found_where_the_sampled_one_is_lower() {
        for shift in [0.0, 0.003, 0.006, 1.234] {
            // Maxima of 1 + 1e-5 at `shift` and of 1 - 1e-5 half a turn on.
            let (angle, height) =
                top(|a| (2.0 * (a - shift)).cos() + 1e-5 * (a - shift).cos(), &[]).unwrap();
            assert!((height - 1.0 - 1e-5).abs() < 1e-15, "{shift}: {height}");
            assert!(((angle - shift).cos() - 1.0).abs() < 1e-12, "{shift}: {angle}");
        }
    }

    #[test]
    fn what_has_no_value_has_no_top() {
        assert_eq!(top(|_| f64::NAN, &[]), None);
        assert!(top(|_| 1.0, &[]).is_some_and(|(_, height)| height == 1.0));
    }
}
