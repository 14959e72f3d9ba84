//! The chooser against exhaustive search, on the scenes that ship with the crate.
//!
//! For each scene and tolerance the question is asked as a user would ask it; then every rung of
//! the ladder that could be cheaper is run as well, and all are judged by a reference that is far better
//! than the one the chooser made for itself.

use std::fs;
use std::path::Path;
use std::time::Duration;

use stationary_calculus::{Column, Table};

use crate::chart::{Axis, Lines, Mark, Series};
use crate::choose::{
    Found, Lab, Question, Reference, Verdict, answer, exhaustive, laboratory, preferred, refer,
};
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError};

/// The study.
pub const STUDY: Entry<'static> = Entry {
    id: "choosing",
    krate: "scene",
    chapter: "choosing",
    kind: Kind::Ladder,
    title: "The cheapest way to run a scene, chosen and searched for",
    run: &study,
};

/// A shipped scene, what is asked of it, and over which horizons: short, and its own or the longest
/// over which it can be predicted.
struct Asked {
    scene: &'static str,
    observable: &'static str,
    short: f64,
    long: f64,
}

const ASKED: [Asked; 5] = [
    Asked {
        scene: "outer-solar-system",
        observable: "position=jupiter",
        short: 60_000.0,
        long: 200_000.0,
    },
    Asked { scene: "pendulum-chain", observable: "position=j10", short: 0.3, long: 0.8 },
    Asked { scene: "breaking-bridge", observable: "position=load", short: 0.1, long: 0.1 },
    Asked { scene: "thrown-racket", observable: "angular_velocity=racket", short: 2.0, long: 4.0 },
    Asked { scene: "heavy-top", observable: "position=top.1", short: 1.0, long: 2.0 },
];

/// The tolerances asked for.
const TOLERANCES: [f64; 4] = [1e-1, 1e-2, 1e-3, 1e-4];

/// How much better than the tightest tolerance the truth is.
const TRUTH: f64 = 50.0;

/// The study is of counted work: no budget ends it early.
const BUDGET: Duration = Duration::from_secs(24 * 3600);

/// A question answered and searched.
struct Case {
    scene: &'static str,
    tolerance: f64,
    chosen: Found,
    best: Found,
    /// Work of choosing, in runs of the choice.
    effort: f64,
    names: [String; 2],
    confirmed: bool,
}

fn study(size: Size) -> Result<Study, StudyError> {
    let mut cases = Vec::new();
    let mut undecided = Vec::new();
    for asked in &ASKED {
        let mut lab = lab(asked, size)?;
        let tightest = TOLERANCES[TOLERANCES.len() - 1];
        let truth = truth(&mut lab, tightest / TRUTH).ok_or_else(|| StudyError::NotFinite {
            what: format!("the uncertainty of the truth of {}", asked.scene),
            value: f64::INFINITY,
        })?;
        for tolerance in TOLERANCES {
            match case(asked, &mut lab, &truth, tolerance) {
                Some(case) => cases.push(case),
                None => undecided.push(format!("{} at {tolerance:e}", asked.scene)),
            }
        }
    }
    Ok(shown(&cases, &undecided))
}

fn lab(asked: &Asked, size: Size) -> Result<Lab, StudyError> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/scene/scenes");
    let file = folder.join(format!("{}.toml", asked.scene));
    let text = fs::read_to_string(&file).map_err(StudyError::at(file.display().to_string()))?;
    let question = Question {
        observable: asked.observable.to_owned(),
        tolerance: TOLERANCES[0],
        budget: BUDGET,
        horizon: Some(match size {
            Size::Default => asked.short,
            Size::Full => asked.long,
        }),
    };
    laboratory(asked.scene, &text, &question).map_err(StudyError::at(asked.scene))
}

fn truth(lab: &mut Lab, enough: f64) -> Option<Reference> {
    let families = preferred(lab, enough);
    refer(lab, &families, enough).filter(|made| made.uncertainty <= enough)
}

fn case(asked: &Asked, lab: &mut Lab, truth: &Reference, tolerance: f64) -> Option<Case> {
    lab.forget();
    let answer = answer(lab, tolerance);
    let row = answer.choice()?;
    let run = lab.measure(row.at).outcome.clone().ok()?;
    let chosen = Found { at: row.at, work: row.work, error: truth.error(&run).ok()? };
    let effort = answer.spent as f64 / row.work as f64;
    let best = exhaustive(lab, truth, tolerance, row.work).unwrap_or(chosen);
    let name = |found: &Found| {
        let family = lab.family(found.at.family);
        format!("{} {:.3e}", family.name, family.rungs[found.at.rung].setting)
    };
    let names = [name(&chosen), name(&best)];
    let confirmed = matches!(answer.verdict, Verdict::Chosen(_));
    Some(Case { scene: asked.scene, tolerance, chosen, best, effort, names, confirmed })
}

impl Case {
    fn ratio(&self) -> f64 {
        self.chosen.work as f64 / self.best.work as f64
    }
}

fn shown(cases: &[Case], undecided: &[String]) -> Study {
    let mut table = Table::new([
        Column::exact("scene"),
        Column::exact("tolerance"),
        Column::exact("chosen"),
        Column::rounded("work", 2, 0.0),
        Column::rounded("true error", 2, 1e-12),
        Column::exact("cheapest of all"),
        Column::rounded("chosen / cheapest work", 3, 0.0),
        Column::rounded("choosing / chosen work", 2, 0.0),
    ]);
    for case in cases {
        let [chosen, best] = &case.names;
        table.push([
            case.scene.into(),
            format!("{:e}", case.tolerance).into(),
            chosen.as_str().into(),
            (case.chosen.work as f64).into(),
            case.chosen.error.into(),
            best.as_str().into(),
            case.ratio().into(),
            case.effort.into(),
        ]);
    }
    let largest = |of: &dyn Fn(&Case) -> f64| cases.iter().map(of).fold(0.0, f64::max);
    let near = cases.iter().filter(|case| case.ratio() <= 1.1).count() as f64;
    Study {
        id: STUDY.id,
        krate: STUDY.krate,
        chapter: STUDY.chapter,
        kind: STUDY.kind,
        title: STUDY.title.to_owned(),
        conclusion: conclusion(cases),
        table,
        charts: vec![work(cases).into(), effort(cases).into()],
        claims: vec![
            Claim::words("questions that are left undecided", "none", listed(undecided.to_vec())),
            Claim::words(
                "references that no run of another kind confirms, where the scene allows one",
                "none",
                names(cases.iter().filter(|case| !case.confirmed)),
            ),
            Claim::number(
                "part of the pairs in which the choice costs at most 1.1 times the cheapest rung",
                "0.95 or more",
                near / cases.len() as f64,
                (0.95, 1.0),
            ),
            Claim::number(
                "the choice's work over the cheapest rung's, at most",
                "1.5 or less",
                largest(&Case::ratio),
                (1.0, 1.5),
            ),
            Claim::number(
                "the true error over the tolerance, at most",
                "1 or less",
                largest(&|case| case.chosen.error / case.tolerance),
                (0.0, 1.0),
            ),
        ],
    }
}

fn names<'c>(cases: impl Iterator<Item = &'c Case>) -> String {
    let names = cases.map(|case| format!("{} at {:e}", case.scene, case.tolerance));
    listed(names.collect())
}

fn listed(names: Vec<String>) -> String {
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

fn conclusion(cases: &[Case]) -> String {
    let same = cases.iter().filter(|case| case.chosen.work == case.best.work).count();
    let efforts = cases.iter().map(|case| case.effort);
    let (least, most) =
        efforts.fold((f64::INFINITY, 0.0), |(a, b): (f64, f64), x| (a.min(x), b.max(x)));
    format!(
        "Five shipped scenes, four tolerances each: in {same} of {} pairs the chooser names the very \
         rung that running the whole ladder finds to be the cheapest, or one that costs the same. \
         Choosing takes from {least:.0} to {most:.0} times the work of the choice, its own reference \
         and its confirmation included: the most where the choice is among the coarsest rungs of \
         all, or where many methods fail in the same way before one does not.",
        cases.len()
    )
}

fn by_scene(cases: &[Case], mut lines: Lines, point: impl Fn(&Case) -> (f64, f64)) -> Lines {
    for cases in cases.chunk_by(|a, b| a.scene == b.scene) {
        let series = Series::new(cases[0].scene, cases.iter().map(&point));
        lines = lines.with(series.marked(Mark::LineAndMarkers));
    }
    lines
}

fn work(cases: &[Case]) -> Lines {
    let x = Axis::log("tolerance", "");
    let lines = Lines::new("Work of the choice", x, Axis::log("counted work", "differentials"));
    by_scene(cases, lines, |case| (case.tolerance, case.chosen.work as f64))
}

fn effort(cases: &[Case]) -> Lines {
    let x = Axis::log("tolerance", "");
    let y = Axis::linear("work of choosing / work of the choice", "");
    let lines = Lines::new("Work of choosing", x, y);
    by_scene(cases, lines, |case| (case.tolerance, case.effort))
}
