//! Which curve of a chart of error against cost meets an error at the least cost.

use stationary_chart::Lines;

use crate::study::Answer;

/// The least cost at which a tolerance is met, by runs of growing cost: read off between the first
/// that meets it and the one before.
pub(super) fn cost_at(tolerance: f64, runs: &[(f64, f64)]) -> Option<f64> {
    let first = runs.iter().position(|&(_, error)| error <= tolerance)?;
    let (cost, error) = runs[first];
    let Some(&(less_cost, more_error)) = first.checked_sub(1).map(|before| &runs[before]) else {
        return Some(cost);
    };
    let part = (more_error / tolerance).ln() / (more_error / error).ln();
    Some(less_cost * (cost / less_cost).powf(part))
}

/// A question that the curves of a chart answer.
pub(super) struct Asked<'a> {
    /// What is asked: `Planets, to 1e-6`.
    pub(super) question: &'a str,
    /// The error that may be made.
    pub(super) error: f64,
    /// What is counted: `evaluations`.
    pub(super) cost: &'a str,
    /// The curve that the cheapest is compared with; the next best where that is the cheapest, or
    /// does not come so close.
    pub(super) rival: &'a str,
}

impl Asked<'_> {
    /// The cheapest curve, and its cost over that of the rival. None where fewer than two come so
    /// close.
    pub(super) fn of(&self, chart: &Lines) -> Option<Answer> {
        let curves = chart.series.iter();
        let mut costs: Vec<(&str, f64)> = curves
            .filter_map(|curve| Some((curve.name.as_str(), cost_at(self.error, &curve.points)?)))
            .collect();
        costs.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (&(best, least), others) = costs.split_first()?;
        let &(rival, cost) = others.iter().find(|other| other.0 == self.rival).or(others.first())?;
        Some(Answer {
            question: self.question.to_owned(),
            method: known_as(best),
            figure: format!(
                "at {} of the {} of {}",
                part(least / cost),
                self.cost,
                known_as(rival).split(" (").next().unwrap_or(rival)
            ),
        })
    }
}

/// The name that a newcomer may know, with the one to write into a scene.
pub(super) fn known_as(name: &str) -> String {
    const KNOWN: [(&str, &str); 10] = [
        ("dormand-el-mikkawy-prince-8", "Nystrom 8(6)"),
        ("dormand-el-mikkawy-prince-12", "Nystrom 12(10)"),
        ("dormand-prince-853", "DOP853"),
        ("blanes-moan-nystrom-6", "Blanes and Moan's Nystrom splitting of order 6"),
        ("stormer-verlet", "Stormer-Verlet"),
        ("radau-iia-5", "Radau IIA of order 5"),
        ("crank-nicolson", "Crank-Nicolson"),
        ("munthe-kaas-4", "Munthe-Kaas of order 4"),
        ("explicit-euler", "explicit Euler"),
        ("inelastic", "projection"),
    ];
    match KNOWN.iter().find(|known| known.0 == name) {
        Some((_, known)) if known.to_lowercase().replace(' ', "-") == name => (*known).to_owned(),
        Some((_, known)) => format!("{known} ({name})"),
        None => name.to_owned(),
    }
}

/// A part of one with two digits after its zeros: `0.35`, `0.0042`.
pub(super) fn part(x: f64) -> String {
    let zeros = (-x.log10().floor()).max(1.0) as usize;
    format!("{x:.*}", zeros + 1 - usize::from(x >= 0.1 && zeros > 1))
}

#[cfg(test)]
mod tests {
    use stationary_chart::{Axis, Series};

    use super::*;

    fn chart() -> Lines {
        let line = |name, points: &[(f64, f64)]| Series::new(name, points.to_vec());
        Lines::new("", Axis::log("evaluations", ""), Axis::log("error", ""))
            .with(line("slow", &[(100.0, 1e-2), (10_000.0, 1e-4)]))
            .with(line("fast", &[(100.0, 1e-2), (1_000.0, 1e-4)]))
            .with(line("coarse", &[(10.0, 1e-1)]))
    }

    #[test]
    fn the_cheapest_is_named_with_its_cost_over_that_of_its_rival() {
        let asked =
            Asked { question: "Any, to 1e-4", error: 1e-4, cost: "evaluations", rival: "slow" };
        let answer = asked.of(&chart()).unwrap();
        assert_eq!(answer.method, "fast");
        assert_eq!(answer.figure, "at 0.10 of the evaluations of slow");
        assert_eq!(Asked { error: 1e-9, ..asked }.of(&chart()), None);
    }

    #[test]
    fn methods_are_called_as_a_newcomer_knows_them() {
        assert_eq!(known_as("dormand-prince-853"), "DOP853 (dormand-prince-853)");
        assert_eq!(known_as("explicit-euler"), "explicit Euler");
        assert_eq!(known_as("quadratic triangles"), "quadratic triangles");
    }

    #[test]
    fn parts_have_two_digits() {
        assert_eq!([0.352, 0.1, 0.0421, 0.00078].map(part), ["0.35", "0.10", "0.042", "0.00078"]);
    }
}
