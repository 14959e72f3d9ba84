//! How far a state is from what its constraint asks, in lengths that can be judged.
//!
//! ```text
//! |g_i| / slope_i  <=  1e-12 length_i + 8 eps |q|         feasible: rounding explains the rest
//! |J v + dg/dt|_i / slope_i  <=  1e-9 |v| + 1e-12 w       a velocity that stays
//! ```
//! `slope` and `length` the [`Scale`](crate::Scale) of each equation, `|q|`, `|v|` the largest
//! component, `w = sqrt(|a| L)` of `a = -M^-1 dV` and the largest length L, or L a second where nothing pulls. For
//! a rod in square form the first number is `||d| - L|`, metres, up to its square. Among bodies a turn counts as the
//! way that it makes at their size, the largest of their radii of gyration and arms as a power of two, which is the
//! length of what has none; `|q|` is then the largest length.

use stationary_calculus::{Covector, Metric, Vector, first_non_finite};

use crate::critical_point::power_of_two;
use crate::{BodyNumbers, Constraint, ConstraintError, Measure, Scale};

/// Violations looked at side by side.
const LANES: usize = 4;
/// What is allowed of a violation, relative to the length of the thing constrained.
pub(crate) const RELATIVE: f64 = 1e-12;
/// Roundings of the configuration that a violation may consist of.
const ROUNDINGS: f64 = 8.0;
/// What is allowed of a rate, relative to the largest velocity, and to that of a fall through the largest length.
const RATE: (f64, f64) = (1e-9, 1e-12);

/// The scales of all equations, and one over them.
#[derive(Clone, Debug)]
pub(crate) struct Scales {
    slope: Vec<f64>,
    inverse_slope: Vec<f64>,
    length: Vec<f64>,
    inverse_length: Vec<f64>,
    /// The largest length.
    size: f64,
    /// How the numbers of bodies lie, and the size of these, a length.
    bodies: Option<(BodyNumbers, f64)>,
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

/// The largest of the lengths of bodies, each of so many numbers, and the largest of their other numbers.
fn largest_of_bodies(x: &[f64], numbers: &BodyNumbers, each: usize) -> [f64; 2] {
    let (of_bodies, rest) = x.split_at(x.len().min(numbers.bodies.saturating_mul(each)));
    let start = [largest(rest), 0.0];
    of_bodies.chunks(each.max(1)).fold(start, |[length, turn], body| {
        let (lengths, turns) = body.split_at(body.len().min(numbers.lengths));
        [length.max(largest(lengths)), turn.max(largest(turns))]
    })
}

/// The largest of these lengths and of the radii of gyration of bodies, as a power of two.
fn size_of_bodies(metric: &impl Metric, numbers: &BodyNumbers, lengths: f64) -> f64 {
    let n = metric.dim();
    // 1/m and 1/I
    let [shifted, turned] = [false, true].map(|turns| {
        let one = |k| if numbers.turns(k) == turns { 1.0 } else { 0.0 };
        let (p, mut v) = ((0..n).map(one).collect::<Vec<_>>(), Vector(vec![0.0; n]));
        metric.sharp(Covector(&p[..]), v.view_mut());
        v.0
    });
    let bodies =
        shifted.chunks(numbers.freedoms.max(1)).zip(turned.chunks(numbers.freedoms.max(1)));
    let gyration = |(shifted, turned): (&[f64], &[f64])| {
        let split = numbers.lengths.min(shifted.len());
        let least = turned[split..].iter().fold(f64::INFINITY, |least, x| least.min(x.abs()));
        (largest(&shifted[..split]) / least).sqrt()
    };
    let radii = bodies.take(numbers.bodies).map(gyration).filter(|radius| radius.is_finite());
    power_of_two(radii.fold(lengths, f64::max))
}

/// The scales of a constraint's equations.
///
/// # Errors
/// One that is no number, not positive or out of range; a length may be 0 where there are bodies.
pub(crate) fn checked(constraint: &impl Constraint) -> Result<Vec<Scale>, ConstraintError> {
    let scales: Vec<_> = (0..constraint.count()).map(|row| constraint.scale(row)).collect();
    for scale in &scales {
        let of_bodies = scale.length == 0.0 && scale.measure != Measure::Plain;
        for (what, value, none) in
            [("slope", scale.slope, false), ("length", scale.length, of_bodies)]
        {
            if !(none || value > 0.0 && value.is_finite() && value.recip().is_finite()) {
                let range = "positive and finite";
                return Err(ConstraintError::Parameter { what, value, range });
            }
        }
    }
    Ok(scales)
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
    pub(crate) fn new(
        constraint: &impl Constraint,
        metric: &impl Metric,
    ) -> Result<Self, ConstraintError> {
        let mut scales = checked(constraint)?;
        let numbers = scales.iter().find_map(|scale| match scale.measure {
            Measure::Plain => None,
            Measure::Length(numbers) | Measure::Turn(numbers) => Some(numbers),
        });
        let is_turn = |scale: &Scale| matches!(scale.measure, Measure::Turn(_));
        let lengths = scales.iter().filter(|scale| !is_turn(scale)).map(|scale| scale.length);
        let longest = lengths.fold(0.0, f64::max);
        let bodies = numbers.map(|numbers| (numbers, size_of_bodies(metric, &numbers, longest)));
        if let Some((_, size)) = bodies {
            for scale in &mut scales {
                if is_turn(scale) {
                    (scale.slope, scale.length) = (scale.slope / size, scale.length * size);
                } else if scale.length == 0.0 {
                    scale.length = size;
                }
            }
        }
        Ok(Scales {
            slope: scales.iter().map(|scale| scale.slope).collect(),
            inverse_slope: scales.iter().map(|scale| scale.slope.recip()).collect(),
            length: scales.iter().map(|scale| scale.length).collect(),
            inverse_length: scales.iter().map(|scale| scale.length.recip()).collect(),
            size: scales.iter().map(|scale| scale.length).fold(0.0, f64::max),
            bodies,
        })
    }

    /// What rounding of a configuration makes of a distance.
    pub(crate) fn rounding(&self, q: &[f64]) -> f64 {
        let far = match &self.bodies {
            None => largest(q),
            Some((numbers, size)) => largest_of_bodies(q, numbers, numbers.stored)[0].max(*size),
        };
        ROUNDINGS * f64::EPSILON * far
    }

    /// The largest component of a velocity, of turns the way that they make.
    fn speed(&self, v: &[f64]) -> f64 {
        let Some((numbers, size)) = &self.bodies else { return largest(v) };
        let [length, turn] = largest_of_bodies(v, numbers, numbers.freedoms);
        length.max(size * turn)
    }

    /// The length that a unit of this freedom counts as.
    pub(crate) fn unit(&self, freedom: usize) -> f64 {
        match &self.bodies {
            Some((numbers, size)) if numbers.turns(freedom) => *size,
            _ => 1.0,
        }
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
        (distance / length, RELATIVE + self.rounding(q) / length)
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
        if worst.excess <= self.rounding(q) {
            return Ok(());
        }
        let (violation, allowed) = self.relative(worst.row, g, q);
        Err(ConstraintError::Infeasible { row: worst.row, violation, allowed })
    }

    /// Whether rates are what rounding leaves of others.
    pub(crate) fn are_left_of(&self, rates: &[f64], distance: f64) -> bool {
        self.distance(rates) <= RATE.0 * distance
    }

    /// An error unless the rates `J v + dg/dt` belong to a velocity that stays, where such accelerations are free.
    pub(crate) fn check_rates(
        &self,
        rates: &[f64],
        v: &[f64],
        accelerations: &[f64],
    ) -> Result<(), ConstraintError> {
        let pull = self.speed(accelerations);
        let fall = if pull > 0.0 { pull.sqrt() * self.size.sqrt() } else { self.size };
        let allowed = RATE.0 * self.speed(v) + RATE.1 * fall;
        if self.distance(rates) <= allowed {
            return Ok(());
        }
        self.worst(rates)?;
        let rate = |row: usize| rates[row].abs() * self.inverse_slope[row];
        let row = (0..rates.len()).max_by(|&a, &b| rate(a).total_cmp(&rate(b))).unwrap_or(0);
        Err(ConstraintError::InfeasibleVelocity { row, rate: rate(row), allowed })
    }
}
