//! The chooser on scenes that nobody has chosen: true, shy, cheap?
//!
//! Random scenes of nine families and random questions, as `cargo xtask trials --only choosing` asks
//! them: right and wrong are said by that referee. Of some of them every setting that could have been
//! cheaper is run as well.

use stationary_chart::{Axis, Lines, Mark, Series};
use stationary_choose::{At, Verdict, answer, exhaustive, preferred, refer};
use stationary_measure::{Column, Table};
use stationary_trials::{Draw, Plan};

use crate::choosing::{KINDS, bounded_runs, posed};
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// The study.
pub const STUDY: Entry<'static> = Entry {
    id: "choosing-unseen",
    krate: "scene",
    chapter: "choosing",
    kind: Kind::Ladder,
    title: "Random scenes: cost of the chosen method against exhaustive search",
    tested: Tested::ByReport,
    run: &study,
};

/// The seed of the report's cases.
const SEED: u64 = 76;

/// How much better than the tolerance the reference of the exhaustive search is made, where it can be.
const TRUTH: f64 = 50.0;

/// Questions that are judged, and how many of these are searched exhaustively.
fn counts(size: Size) -> (u64, u64) {
    match size {
        Size::Default => (24, 16),
        Size::Full => (500, 200),
    }
}

/// A question with a choice, of which every setting was run that could have been cheaper.
struct Searched {
    family: &'static str,
    tolerance: f64,
    /// The choice's work over that of the cheapest.
    ratio: f64,
    /// Work of choosing over that of the choice.
    effort: f64,
    names: [String; 2],
}

fn study(size: Size) -> Result<Study, StudyError> {
    let (cases, searches) = counts(size);
    let plan = Plan { seed: SEED, cases, shard: (0, 1), limit: std::time::Duration::MAX };
    let tally = plan.run(&KINDS[0]);
    let (mut searched, mut refused) = (Vec::new(), 0);
    for case in 0..searches {
        match search(SEED.wrapping_mul(1 << 32).wrapping_add(case)) {
            Some(found) => searched.push(found),
            None => refused += 1,
        }
    }
    let mut table = Table::new([
        Column::exact("scene"),
        Column::exact("tolerance"),
        Column::exact("chosen"),
        Column::exact("cheapest of all"),
        Column::rounded("chosen / cheapest work", 3, 0.0),
        Column::rounded("choosing / chosen work", 2, 0.0),
    ]);
    for one in &searched {
        let [chosen, best] = &one.names;
        table.push([
            one.family.into(),
            format!("{:e}", one.tolerance).into(),
            chosen.as_str().into(),
            best.as_str().into(),
            one.ratio.into(),
            one.effort.into(),
        ]);
    }
    let ratios = sorted(&searched, |one| one.ratio);
    let efforts = sorted(&searched, |one| one.effort);
    let had_one = (tally.right + tally.refused + tally.wrong) as f64;
    let shy = tally.refused as f64 / had_one;
    Ok(Study {
        conclusion: format!(
            "{} random questions: {} right, {} refused though a choice existed, {} wrong, {} that have no \
             choice or whose contact itself errs, {} that the referee could not judge. {} more were \
             searched exhaustively: the choice costs at most {:.2} times the cheapest in 19 of 20, and \
             choosing {:.0} runs of the choice in the middle, {:.0} in 19 of 20; {} have no answer.",
            tally.tried,
            tally.right,
            tally.refused,
            tally.wrong,
            tally.apart,
            tally.not_judged,
            searches,
            at(&ratios, 0.95),
            at(&efforts, 0.5),
            at(&efforts, 0.95),
            refused,
        ),
        table,
        charts: vec![distribution(&ratios, &efforts).into()],
        claims: vec![
            Claim::number("wrong answers", "0", tally.wrong as f64, (0.0, 0.0)),
            Claim::number(
                "part of the questions with a choice that is refused",
                "0.05 or less",
                shy,
                (0.0, 0.05),
            ),
            Claim::number(
                "the choice's work over that of the cheapest setting, in 19 of 20",
                "1.5 or less",
                at(&ratios, 0.95),
                (0.0, 1.5),
            ),
            Claim::number(
                "work of choosing over that of the choice, in the middle",
                "18 or less",
                at(&efforts, 0.5),
                (0.0, 18.0),
            ),
            Claim::number(
                "work of choosing over that of the choice, in 19 of 20",
                "60 or less",
                at(&efforts, 0.95),
                (0.0, 60.0),
            ),
        ],
        ..STUDY.heading()
    })
}

/// A question answered and searched; nothing where it has no answer.
fn search(case: u64) -> Option<Searched> {
    let mut draw = Draw::new(case);
    let (asked, ladder) = posed(&mut draw);
    let ladder = ladder.ok()?;
    let mut runs = bounded_runs(&ladder).ok()?;
    let answer = answer(&mut runs, asked.tolerance).ok()?;
    let Verdict::Chosen(at) = answer.verdict else { return None };
    let (work, spent) = (answer.choice()?.work, answer.spent.total());
    runs.forget();
    let enough = asked.tolerance / TRUTH;
    let families = preferred(&runs, enough);
    let truth = refer(&mut runs, &families, enough)
        .filter(|made| made.uncertainty <= enough)
        .or(answer.reference)?;
    let all: Vec<usize> = (0..runs.ladder().families.len()).collect();
    let best = exhaustive(&mut runs, &all, &truth, asked.tolerance, work);
    let name = |at: At| {
        let family = runs.family(at.family);
        format!("{} {:.3e}", family.name, family.rungs[at.rung].setting)
    };
    Some(Searched {
        family: asked.family,
        tolerance: asked.tolerance,
        ratio: best.map_or(1.0, |best| work as f64 / best.work as f64),
        effort: spent as f64 / work as f64,
        names: [name(at), name(best.map_or(at, |best| best.at))],
    })
}

fn sorted(all: &[Searched], of: fn(&Searched) -> f64) -> Vec<f64> {
    let mut all: Vec<f64> = all.iter().map(of).collect();
    all.sort_by(f64::total_cmp);
    all
}

/// The value that this part of them does not exceed.
fn at(sorted: &[f64], part: f64) -> f64 {
    let last = sorted.len().saturating_sub(1);
    sorted.get((part * last as f64).round() as usize).copied().unwrap_or(f64::NAN)
}

fn distribution(ratios: &[f64], efforts: &[f64]) -> Lines {
    let x = Axis::log("work over that of the choice, or of the cheapest", "");
    let lines = Lines::new("All questions", x, Axis::linear("part of the questions", ""));
    let curve = |name: &'static str, all: &[f64]| {
        let count = all.len() as f64;
        let points = all.iter().enumerate().map(|(k, &x)| (x, (k + 1) as f64 / count));
        Series::new(name, points).marked(Mark::LineAndMarkers)
    };
    lines
        .with(curve("choosing, in runs of the choice", efforts))
        .with(curve("the choice, in the cheapest of all", ratios))
}
