//! How far a state is from what its constraint asks, in lengths that can be judged.
//!
//! ```text
//! |g_i| / slope_i  <=  1e-12 length_i + 8 eps |q|         feasible: rounding explains the rest
//! |J v + dg/dt|_i / slope_i  <=  1e-9 |v| + 1e-12         a velocity that stays
//! ```
//! `slope` and `length` the [`Scale`](crate::Scale) of each equation, `|q|`, `|v|` the largest
//! component. For a rod in square form the first number is `||d| - L|`, metres, up to its square.

use stationary_calculus::first_non_finite;

use crate::{Constraint, ConstraintError};

/// Violations looked at side by side.
const LANES: usize = 4;
/// What is allowed of a violation, relative to the length of the thing constrained.
pub(crate) const RELATIVE: f64 = 1e-12;
/// Roundings of the configuration that a violation may consist of.
const ROUNDINGS: f64 = 8.0;
/// What is allowed of a rate, relative to the largest velocity, and absolutely (m/s).
const RATE: (f64, f64) = (1e-9, 1e-12);

/// The scales of all equations, and one over them.
#[derive(Clone, Debug)]
pub(crate) struct Scales {
    slope: Vec<f64>,
    inverse_slope: Vec<f64>,
    length: Vec<f64>,
    inverse_length: Vec<f64>,
}

/// The worst of all equations.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Worst {
    pub(crate) row: usize,
    /// `|g| / slope`, a length.
    pub(crate) distance: f64,
    /// The same beyond what is allowed relative to the length.
    pub(crate) excess: f64,
}

pub(crate) fn largest(x: &[f64]) -> f64 {
    let larger = |largest: f64, x: &f64| if x.abs() > largest { x.abs() } else { largest };
    let (chunks, rest) = x.as_chunks::<LANES>();
    let mut lanes = [0.0; LANES];
    for chunk in chunks {
        (0..LANES).for_each(|lane| lanes[lane] = larger(lanes[lane], &chunk[lane]));
    }
    rest.iter().chain(&lanes).fold(0.0, larger)
}

/// What rounding of a configuration makes of a distance.
pub(crate) fn rounding(q: &[f64]) -> f64 {
    ROUNDINGS * f64::EPSILON * largest(q)
}

/// Watches iterations towards a feasible configuration for those that lead away from it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Flight {
    /// How much an equation was violated at most before the first iteration, relative to its length, and which, where
    /// that is much.
    start: Option<(f64, Option<usize>)>,
}

/// Iterations that are this many lengths away, or this many times as far as they began, do not come
/// back.
const AWAY: f64 = 1e3;
/// Equations that are violated by less than this part of their length were all nearly kept.
const NEARLY: f64 = 1e-3;

impl Flight {
    /// An error where the values g, of which the largest relative violation is `now`, are far away, or no
    /// numbers.
    #[inline]
    pub(crate) fn check(
        &mut self,
        scales: &Scales,
        (g, now): (&[f64], f64),
        regularity: Option<f64>,
    ) -> Result<(), ConstraintError> {
        let begun = || (now, (now > NEARLY).then(|| scales.worst_row(g)));
        let (violation, row) = *self.start.get_or_insert_with(begun);
        if now <= AWAY * violation.max(1.0) {
            return Ok(());
        }
        let row = row.unwrap_or_else(|| scales.worst_row(g));
        Err(ConstraintError::Diverged { row, violation, regularity })
    }
}

impl Scales {
    pub(crate) fn new(constraint: &impl Constraint) -> Result<Self, ConstraintError> {
        let scales: Vec<_> = (0..constraint.count()).map(|row| constraint.scale(row)).collect();
        for scale in &scales {
            for (what, value) in [("slope", scale.slope), ("length", scale.length)] {
                if !(value > 0.0 && value.is_finite() && value.recip().is_finite()) {
                    let range = "positive and finite";
                    return Err(ConstraintError::Parameter { what, value, range });
                }
            }
        }
        Ok(Scales {
            slope: scales.iter().map(|scale| scale.slope).collect(),
            inverse_slope: scales.iter().map(|scale| scale.slope.recip()).collect(),
            length: scales.iter().map(|scale| scale.length).collect(),
            inverse_length: scales.iter().map(|scale| scale.length.recip()).collect(),
        })
    }

    /// The largest of `|g| / slope`, a length, and of the same relative to its equation's length; neither a
    /// number if a value is not finite.
    #[inline]
    pub(crate) fn largest(&self, g: &[f64]) -> [f64; 2] {
        // A few at a time, so that none waits for the one before it.
        let (mut sums, mut far, mut relative) = ([0.0; LANES], [0.0_f64; LANES], [0.0_f64; LANES]);
        let mut see = |lane: usize, g: f64, slope: f64, length: f64| {
            let d = g.abs() * slope;
            // What is not a number stays in the sum and is lost in a maximum.
            sums[lane] += d;
            far[lane] = if d > far[lane] { d } else { far[lane] };
            let d = d * length;
            relative[lane] = if d > relative[lane] { d } else { relative[lane] };
        };
        let count = g.len().min(self.inverse_slope.len());
        let (values, values_left) = g[..count].as_chunks::<LANES>();
        let (slopes, slopes_left) = self.inverse_slope[..count].as_chunks::<LANES>();
        let (lengths, lengths_left) = self.inverse_length[..count].as_chunks::<LANES>();
        for ((g, slope), length) in values.iter().zip(slopes).zip(lengths) {
            (0..LANES).for_each(|lane| see(lane, g[lane], slope[lane], length[lane]));
        }
        for ((g, slope), length) in values_left.iter().zip(slopes_left).zip(lengths_left) {
            see(0, *g, *slope, *length);
        }
        if !sums.iter().sum::<f64>().is_finite() {
            return [f64::NAN; 2];
        }
        [far, relative].map(|lanes| lanes.into_iter().fold(0.0, f64::max))
    }

    /// The largest of `|g| / slope`, a length; not a number if a value is not finite.
    #[inline]
    pub(crate) fn distance(&self, g: &[f64]) -> f64 {
        self.largest(g)[0]
    }

    /// Makes distances of values.
    pub(crate) fn scale(&self, g: &mut [f64]) {
        g.iter_mut().zip(&self.inverse_slope).for_each(|(g, slope)| *g *= slope);
    }

    /// Makes values of distances, times a factor.
    pub(crate) fn unscale(&self, g: &mut [f64], factor: f64) {
        g.iter_mut().zip(&self.slope).for_each(|(g, slope)| *g *= factor * slope);
    }

    /// The worst of the values g.
    pub(crate) fn worst(&self, g: &[f64]) -> Result<Worst, ConstraintError> {
        let distance = self.distance(g);
        if !distance.is_finite() {
            let index = first_non_finite(g).unwrap_or(0);
            return Err(ConstraintError::NonFinite { what: "constraint", index });
        }
        let scales = self.inverse_slope.iter().zip(&self.length);
        let excess =
            |(g, (slope, length)): (&f64, (&f64, &f64))| g.abs() * slope - RELATIVE * length;
        let worst = g.iter().zip(scales).map(excess).enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        let (row, excess) = worst.unwrap_or((0, f64::NEG_INFINITY));
        Ok(Worst { row, distance, excess })
    }

    /// The violation of an equation relative to its length, and what is allowed of it.
    pub(crate) fn relative(&self, row: usize, g: &[f64], q: &[f64]) -> (f64, f64) {
        let length = self.length.get(row).copied().unwrap_or(1.0);
        let distance = g.get(row).map_or(0.0, |g| g.abs() * self.inverse_slope[row]);
        (distance / length, RELATIVE + rounding(q) / length)
    }

    /// The largest violation relative to its equation's length; not a number if a value is not finite.
    pub(crate) fn largest_relative(&self, g: &[f64]) -> f64 {
        self.largest(g)[1]
    }

    /// The equation that is violated most relative to its length.
    fn worst_row(&self, g: &[f64]) -> usize {
        let relative = |row: usize| self.relative(row, g, &[]).0;
        (0..g.len()).max_by(|&a, &b| relative(a).total_cmp(&relative(b))).unwrap_or(0)
    }

    /// An error unless the values g belong to a feasible configuration.
    pub(crate) fn check(&self, g: &[f64], q: &[f64]) -> Result<(), ConstraintError> {
        let worst = self.worst(g)?;
        if worst.excess <= rounding(q) {
            return Ok(());
        }
        let (violation, allowed) = self.relative(worst.row, g, q);
        Err(ConstraintError::Infeasible { row: worst.row, violation, allowed })
    }

    /// An error unless the rates `J v + dg/dt` belong to a velocity that stays.
    pub(crate) fn check_rates(&self, rates: &[f64], v: &[f64]) -> Result<(), ConstraintError> {
        let allowed = RATE.0 * largest(v) + RATE.1;
        if self.distance(rates) <= allowed {
            return Ok(());
        }
        self.worst(rates)?;
        let rate = |row: usize| rates[row].abs() * self.inverse_slope[row];
        let row = (0..rates.len()).max_by(|&a, &b| rate(a).total_cmp(&rate(b))).unwrap_or(0);
        Err(ConstraintError::InfeasibleVelocity { row, rate: rate(row), allowed })
    }
}
