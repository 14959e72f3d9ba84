//! Every promise on random cases: how many were tried, refused and wrong, and how near the worst came.

use std::time::Duration;

use stationary_chart::{Axis, Chart, Lines, Series};
use stationary_measure::{Column, Table};
use stationary_trials::{Kind as Promise, Plan, Tally};

use crate::study::{Claim, Entry, Kind, Size, Study, Tested};

/// All kinds of trials.
pub const STUDY: Entry<'static> = Entry {
    id: "trials",
    krate: "trials",
    chapter: "all",
    kind: Kind::Trials,
    title: "Random cases of all crates: error over what was promised",
    tested: Tested::ByReport,
    run: &|size| Ok(study(size)),
};

/// The seed of the report's cases.
const SEED: u64 = 77;

/// Errors below this part of what was promised are not told apart.
const FLOOR: f64 = 1e-9;

fn plan(promise: &Promise, size: Size) -> Plan {
    let cases = match size {
        Size::Default => 50,
        Size::Full => 10 * promise.in_tests,
    };
    Plan { seed: SEED, cases, shard: (0, 1), limit: Duration::MAX }
}

fn study(size: Size) -> Study {
    let columns = ["kind", "crate", "tried", "right", "refused", "not judged", "wrong"];
    let mut columns = columns.map(Column::exact).to_vec();
    columns.push(Column::rounded("worst error over what was promised", 2, FLOOR));
    columns.push(Column::exact("wrong is"));
    let mut table = Table::new(columns);
    let (mut claims, mut charts) = (Vec::new(), Vec::new());
    let (mut tried, mut refused) = (0, 0);
    for promises in stationary_trials::KINDS {
        let mut curves = Vec::new();
        for promise in *promises {
            let tally = plan(promise, size).run(promise);
            (tried, refused) = (tried + tally.tried, refused + tally.refused);
            table.push([
                promise.name.into(),
                promise.krate.into(),
                tally.tried.into(),
                tally.right.into(),
                tally.refused.into(),
                tally.not_judged.into(),
                tally.wrong.into(),
                tally.worst.into(),
                promise.rule.into(),
            ]);
            let text = format!("{}: none of {} random cases is wrong", promise.name, tally.tried);
            claims.push(Claim::number(text, "0", tally.wrong as f64, (0.0, 0.0)));
            curves.extend(distribution(&tally));
        }
        if let (Some(promise), false) = (promises.first(), curves.is_empty()) {
            charts.push(chart(promise.krate, curves));
        }
    }
    Study {
        conclusion: format!(
            "{tried} cases were drawn at random and judged by referees that share no code with \
             what they judge; {refused} had an answer and were refused. A curve that ends left of \
             1 keeps its promise: the share of cases whose error is at most that part of what was \
             promised."
        ),
        table,
        charts,
        claims,
        ..STUDY.heading()
    }
}

/// The share of cases whose error is at most a part of what was promised; none where nothing but
/// yes or no was judged.
fn distribution(tally: &Tally) -> Option<Series> {
    let mut ratios: Vec<f64> = tally.ratios.iter().map(|ratio| ratio.max(FLOOR)).collect();
    ratios.sort_by(f64::total_cmp);
    let measured = ratios.last().is_some_and(|&worst| worst > FLOOR);
    let count = ratios.len() as f64;
    let points = ratios.into_iter().enumerate().map(|(i, ratio)| (ratio, (i + 1) as f64 / count));
    measured.then(|| Series::new(tally.kind, points))
}

fn chart(krate: &str, series: Vec<Series>) -> Chart {
    Lines {
        series,
        ..Lines::new(
            krate,
            Axis::log("error over what was promised", ""),
            Axis::linear("share of cases", ""),
        )
    }
    .into()
}
