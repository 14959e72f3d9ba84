//! The page's charts: the drift of the energy, the energies, and an observable each.

use serde::Serialize;

use super::singles;
use crate::{Observable, Run};

/// Lines over one axis.
#[derive(Serialize)]
pub(super) struct Chart {
    title: String,
    unit: String,
    /// What rounding is measured by.
    scale: f64,
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
    scale: f64,
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
        Chart {
            title: self.title.clone(),
            unit: self.unit.clone(),
            scale: self.scale,
            whole: self.kind == Kind::Values,
            lines: self.words.iter().enumerate().map(line).collect(),
        }
    }
}

/// The drift of the energy, the energies, and every other observable.
pub(super) fn charts(run: &Run) -> impl Iterator<Item = Plan<'_>> {
    let unit = run.scene.units.energy();
    let (kinetic, potential) = (&run.samples.kinetic, &run.samples.potential);
    let most = kinetic.iter().copied().fold(0.0, f64::max);
    let drift = Plan {
        title: "drift of the energy".to_owned(),
        unit: unit.clone(),
        scale: most,
        words: vec![String::new()],
        value: Box::new(|sample, _| kinetic[sample] + potential[sample]),
        kind: Kind::Drift,
    };
    let energies = Plan {
        title: "energy".to_owned(),
        unit,
        scale: most,
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
        let scale = match observable {
            Observable::LinearMomentum => run.samples.linear_scale,
            Observable::AngularMomentum => run.samples.angular_scale,
            _ => 0.0,
        };
        let (title, unit, words) = parts(&headings);
        let value = Box::new(move |sample, k| run.observed(sample)[first + k]);
        Some(Plan { title, unit, scale, words, value, kind: Kind::Either })
    })
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
