//! The turn from a direction that separates two solids best, by a model of the pairs of parts that were farthest.
//!
//! ```text
//! max over |d| <= bound of   min_k (s_k + b_k.d) + d^T Q d/2
//! ```
//! `d` across the direction, `s` `b` the separation and the slope of each pair (m, m a radian), `Q` how they bend. The
//! largest is where one pair is level, two meet, or three: each is tried, and the best is taken. Where two meet it is
//! a top along the line on which they do, however the value bends across that: `Q` itself counts there, and what is
//! negative definite elsewhere, so that there is a top at all.

use nalgebra::{Matrix2, Vector2};

/// A pair of parts that was farthest, at the direction of now.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cut {
    pub(crate) parts: [usize; 2],
    pub(crate) value: f64,
    pub(crate) slope: Vector2<f64>,
    pub(crate) weight: f64,
}

/// A second derivative, and a negative definite one for a model that has a largest value.
pub(crate) struct Bends {
    own: Matrix2<f64>,
    pub(crate) model: Matrix2<f64>,
}

impl Bends {
    pub(crate) fn new(own: Matrix2<f64>, scale: f64) -> Self {
        Bends { own, model: negative(own, scale) }
    }
}

/// A second derivative, shifted where it is not negative definite.
fn negative(mut bend: Matrix2<f64>, scale: f64) -> Matrix2<f64> {
    let (mean, half) = (0.5 * bend.trace(), 0.5 * (bend.m11 - bend.m22));
    let largest = mean + half.hypot(bend.m12);
    let least = -1e-9 * scale;
    if largest > least {
        let shift = largest - least;
        bend.m11 -= shift;
        bend.m22 -= shift;
    }
    bend
}

/// Weights that are negative by less are zero: rounding.
const SLACK: f64 = 1e-9;
/// Cuts that are kept at once.
pub(crate) const MOST: usize = 8;

/// The turn within a bound that maximizes the least of the models, which of them meet there, and the
/// value there.
pub(crate) fn maximize(
    cuts: &[Cut],
    bends: &Bends,
    bound: f64,
) -> Option<(Vector2<f64>, Vec<usize>, f64)> {
    let bend = &bends.model;
    let inverse = bend.try_inverse()?;
    let value = |d: &Vector2<f64>| {
        let least = cuts.iter().map(|c| c.value + c.slope.dot(d)).fold(f64::INFINITY, f64::min);
        least + 0.5 * d.dot(&(bend * d))
    };
    let mut best: Option<(Vector2<f64>, Vec<usize>, f64)> = None;
    let mut offer = |d: Vector2<f64>, used: &[usize]| {
        let length = d.norm();
        let d = if length > bound { d * (bound / length) } else { d };
        let there = value(&d);
        if there.is_finite() && best.as_ref().is_none_or(|best| there > best.2) {
            best = Some((d, used.to_vec(), there));
        }
    };
    for (i, one) in cuts.iter().enumerate() {
        offer(-inverse * one.slope, &[i]);
        if let Some(steepest) = one.slope.try_normalize(0.0) {
            offer(steepest * bound, &[i]);
        }
        for (j, other) in cuts.iter().enumerate().skip(i + 1) {
            // On the line on which both are equal.
            let (off, step) = (other.slope - one.slope, other.value - one.value);
            let square = off.norm_squared();
            if square == 0.0 {
                continue;
            }
            let foot = off * (-step / square);
            let along = Vector2::new(-off.y, off.x) / square.sqrt();
            // There the value has a top wherever it bends down along the line, however it bends across.
            let own = along.dot(&(bends.own * along)) < 0.0;
            let bend = if own { &bends.own } else { bend };
            let curve = along.dot(&(bend * along));
            let rise = along.dot(&(one.slope + bend * foot));
            let d = foot - along * (rise / curve);
            // Beyond one of them, that one alone is the least.
            let t = (one.slope + bend * d).dot(&-off) / square;
            if d.norm() > bound {
                // As far along the line as the bound lets.
                let left = (bound * bound - foot.norm_squared()).max(0.0).sqrt();
                offer(foot + along * left.copysign(-rise / curve), &[i, j]);
            } else if (-SLACK..=1.0 + SLACK).contains(&t) {
                offer(d, &[i, j]);
            }
            for (k, third) in cuts.iter().enumerate().skip(j + 1) {
                let both = Matrix2::from_rows(&[
                    (other.slope - one.slope).transpose(),
                    (third.slope - one.slope).transpose(),
                ]);
                let rest = -Vector2::new(step, third.value - one.value);
                let Some(inverse) = both.try_inverse() else { continue };
                let d = inverse * rest;
                let weights = -(inverse.transpose() * (one.slope + bend * d));
                let inside = weights.min() >= -SLACK && weights.sum() <= 1.0 + SLACK;
                if inside || d.norm() > bound {
                    offer(d, &[i, j, k]);
                }
            }
        }
    }
    best
}

/// The weights of the cuts that meet at a turn: their slopes and the bend cancel as far as they can.
pub(crate) fn weigh(cuts: &mut [Cut], used: &[usize], d: &Vector2<f64>, bend: &Matrix2<f64>) {
    cuts.iter_mut().for_each(|cut| cut.weight = 0.0);
    let down = bend * d;
    let slope = |k: usize| cuts[k].slope + down;
    let weights = match *used {
        [i, j] => {
            let off = slope(i) - slope(j);
            let t = (slope(i).dot(&off) / off.norm_squared()).clamp(0.0, 1.0);
            [1.0 - t, t, 0.0]
        }
        [i, j, k] => {
            let sides = Matrix2::from_columns(&[slope(j) - slope(i), slope(k) - slope(i)]);
            let solved = sides.try_inverse().map(|inverse| -(inverse * slope(i)));
            let [t, u] = solved.map_or([0.0; 2], |t| [t.x.max(0.0), t.y.max(0.0)]);
            let sum = (t + u).max(1.0);
            let (t, u) = (t / sum, u / sum);
            [1.0 - t - u, t, u]
        }
        _ => [1.0, 0.0, 0.0],
    };
    for (&k, weight) in used.iter().zip(weights) {
        cuts[k].weight = weight;
    }
}
