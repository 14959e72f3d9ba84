//! The page's charts: the drift of the energy, the energies, and an observable each.
//!
//! ```text
//! r = eps s sqrt(n)        what rounding makes of a number
//! ```
//! `eps` 2^-52, `s` the largest magnitude of what the number is made of, `n` steps of the run, whose
//! roundings add up like a random walk. No axis is less than `ROUNDINGS` of it up and down: what is
//! nothing but rounding does not fill a chart.

use serde::Serialize;

use super::singles;
use crate::model::observable::Observable;
use crate::run::samples::Run;

/// Half the least height of an axis, in roundings. Those of a stack at rest add up to 14, others to
/// less.
const ROUNDINGS: f64 = 64.0;

/// Lines over one axis.
#[derive(Serialize)]
pub(super) struct Chart {
    title: String,
    unit: String,
    /// Half the least height of its axis.
    least: f64,
    /// Values are shown even where they hardly move.
    whole: bool,
    lines: Vec<Line>,
}

#[derive(Serialize)]
pub(super) struct Line {
    word: String,
    start: f64,
    changes: String,
}

/// A chart whose values are still where the run keeps them.
pub(super) struct Plan<'a> {
    title: String,
    unit: String,
    /// The largest magnitude of what its values are made of, where that is more than themselves.
    scale: f64,
    steps: u64,
    words: Vec<String>,
    value: Box<dyn Fn(usize, usize) -> f64 + 'a>,
    kind: Kind,
}

/// What a chart shows of its values.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Their changes.
    Drift,
    /// Themselves.
    Values,
    /// Themselves, or their changes where those are small.
    Either,
}

impl Plan<'_> {
    /// The chart of these samples.
    pub(super) fn encoded(&self, samples: &[usize]) -> Chart {
        let line = |(k, word): (usize, &String)| {
            let start = (self.value)(0, k);
            let changes = samples.iter().map(|&sample| (self.value)(sample, k) - start);
            let shown = if self.kind == Kind::Drift { 0.0 } else { start };
            Line { word: word.clone(), start: shown, changes: singles(changes) }
        };
        let all = samples
            .iter()
            .flat_map(|&sample| (0..self.words.len()).map(move |k| (self.value)(sample, k)));
        let scale = all.fold(self.scale, |scale, x| scale.max(x.abs()));
        Chart {
            title: self.title.clone(),
            unit: self.unit.clone(),
            least: ROUNDINGS * rounding(scale, self.steps),
            whole: self.kind == Kind::Values,
            lines: self.words.iter().enumerate().map(line).collect(),
        }
    }
}

/// What rounding makes of a number of this scale in so many steps.
fn rounding(scale: f64, steps: u64) -> f64 {
    f64::EPSILON * scale * (steps.max(1) as f64).sqrt()
}

/// The ends of a scale, moved apart where nothing but rounding is between them.
pub(super) fn beyond_rounding([low, high]: [f64; 2], steps: u64) -> [f64; 2] {
    let least = ROUNDINGS * rounding(low.abs().max(high.abs()), steps);
    let middle = low + 0.5 * (high - low);
    if high - low < 2.0 * least { [middle - least, middle + least] } else { [low, high] }
}

/// The drift of the energy, the energies, and every other observable.
pub(super) fn charts(run: &Run) -> impl Iterator<Item = Plan<'_>> {
    let unit = run.scene.units.energy();
    let (kinetic, potential) = (&run.samples.kinetic, &run.samples.potential);
    let most = largest(kinetic.iter().chain(potential).copied());
    let steps = run.cost.steps;
    let drift = Plan {
        title: "drift of the energy".to_owned(),
        unit: unit.clone(),
        scale: most,
        steps,
        words: vec![String::new()],
        value: Box::new(|sample, _| kinetic[sample] + potential[sample]),
        kind: Kind::Drift,
    };
    let energies = Plan {
        title: "energy".to_owned(),
        unit,
        scale: most,
        steps,
        words: ["kinetic", "potential", "both"].map(str::to_owned).to_vec(),
        value: Box::new(|sample, k| match k {
            0 => kinetic[sample],
            1 => potential[sample],
            _ => kinetic[sample] + potential[sample],
        }),
        kind: Kind::Values,
    };
    // Heat has no energy of motion.
    let energies = [drift, energies].into_iter().filter(|_| run.scene.heat.is_none());
    energies.chain(observables(run))
}

fn observables(run: &Run) -> impl Iterator<Item = Plan<'_>> {
    let mut column = 0;
    run.scene.observables.iter().filter_map(move |observable| {
        let headings = observable.headings(&run.scene);
        let first = column;
        column += headings.len();
        let energy = [Observable::Energy, Observable::KineticEnergy, Observable::PotentialEnergy];
        if energy.contains(observable) || headings.is_empty() {
            return None;
        }
        let scale = scale(run, *observable);
        let (title, unit, words) = parts(&headings);
        let value = Box::new(move |sample, k| run.observed(sample)[first + k]);
        let steps = run.cost.steps;
        Some(Plan { title, unit, scale, steps, words, value, kind: Kind::Either })
    })
}

/// The largest magnitude in a run of what an observable is made of: a ball at the origin is as exact
/// as the places of all others. Zero where its own values say so.
fn scale(run: &Run, observable: Observable) -> f64 {
    let samples = 0..run.times().len();
    match observable {
        Observable::LinearMomentum => run.samples.linear_scale,
        Observable::AngularMomentum => run.samples.angular_scale,
        Observable::Position(_) | Observable::Distance(_) => {
            largest(samples.flat_map(|sample| run.positions(sample).iter().copied()))
        }
        Observable::Velocity(_) => {
            largest(samples.flat_map(|sample| run.velocities(sample).into_iter().flatten()))
        }
        Observable::AngularVelocity(_) => largest(
            samples.flat_map(|sample| run.bodies(sample)).flat_map(|body| body.angular_velocity),
        ),
        Observable::Temperature(_) => {
            largest(samples.flat_map(|sample| run.temperatures(sample).iter().copied()))
        }
        _ => 0.0,
    }
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |most, x| most.max(x.abs()))
}

/// What headings such as `velocity of a x [m/s]` share, their unit, and what tells them apart.
fn parts(headings: &[String]) -> (String, String, Vec<String>) {
    let split = |heading: &String| -> (String, String) {
        let (title, unit) = heading.rsplit_once(" [").unwrap_or((heading, ""));
        (title.to_owned(), unit.trim_end_matches(']').to_owned())
    };
    let all: Vec<(String, String)> = headings.iter().map(split).collect();
    let unit = all.first().map_or(String::new(), |(_, unit)| unit.clone());
    if let [(title, unit)] = all.as_slice() {
        return (title.clone(), unit.clone(), vec![String::new()]);
    }
    let cut = |title: &str| -> (String, String) {
        let (title, word) = title.rsplit_once(' ').unwrap_or((title, ""));
        (title.to_owned(), word.to_owned())
    };
    let (titles, words): (Vec<String>, Vec<String>) =
        all.iter().map(|(title, _)| cut(title)).unzip();
    (titles.into_iter().next().unwrap_or_default(), unit, words)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_are_taken_apart() {
        let of = |headings: &[&str]| {
            parts(&headings.iter().map(|&heading| heading.to_owned()).collect::<Vec<_>>())
        };
        let (title, unit, words) = of(&["velocity of a b x [m/s]", "velocity of a b y [m/s]"]);
        assert_eq!((title.as_str(), unit.as_str()), ("velocity of a b", "m/s"));
        assert_eq!(words, ["x", "y"]);
        let (title, unit, words) = of(&["distance a to b [au]"]);
        assert_eq!((title.as_str(), unit.as_str()), ("distance a to b", "au"));
        assert_eq!(words, [""]);
    }
}
