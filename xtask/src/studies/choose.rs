//! The chooser against exhaustive search, on the scenes that ship with the crate.
//!
//! For each scene and tolerance the question is asked as a user would ask it; then every rung of
//! the ladder that could be cheaper is run as well, and all are judged by a reference that is far
//! better than the one the chooser made for itself.

use std::fs;
use std::path::Path;
use std::time::Duration;

use stationary_chart::{Axis, Lines, Mark, Series};
use stationary_choose::{
    Found, MeasuredRuns, Reference, Verdict, answer, exhaustive, preferred, refer, way_error,
};
use stationary_measure::{Column, Table};
use stationary_scene::choose::{Question, SceneLadder, scene_ladder};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// The study.
pub const STUDY: Entry<'static> = Entry {
    id: "choosing",
    krate: "scene",
    chapter: "choosing",
    kind: Kind::Ladder,
    title: "Shipped scenes: cost of the chosen method against exhaustive search",
    tested: Tested::ByReport,
    run: &study,
};

/// A shipped scene, what is asked of it, and over which horizons: short, and its own or the longest
/// over which it can be predicted. None is short where a scene takes too long for the default size, which is
/// to take some seconds: it shows that no claim has broken, and the full size what they are worth.
struct Asked {
    scene: &'static str,
    observable: &'static str,
    short: Option<f64>,
    long: f64,
    /// Work that a question may take: where no run of a scene comes to an answer, it must end.
    most_work: u64,
}

const fn asked(
    scene: &'static str,
    observable: &'static str,
    short: Option<f64>,
    long: f64,
    most_work: u64,
) -> Asked {
    Asked { scene, observable, short, long, most_work }
}

/// All but the arch, in which nothing moves.
const ASKED: [Asked; 16] = [
    asked("outer-solar-system", "position=jupiter", Some(60_000.0), 200_000.0, 10_000_000),
    asked("spring-net", "position=net.19.0", None, 0.8, 1_000_000),
    asked("pendulum-chain", "position=j10", Some(0.3), 0.8, 10_000_000),
    asked("breaking-bridge", "position=load", Some(0.1), 0.1, 10_000_000),
    asked("thrown-racket", "angular_velocity=racket", Some(2.0), 4.0, 10_000_000),
    asked("heavy-top", "position=top.1", Some(1.0), 2.0, 10_000_000),
    asked("newtons-cradle", "position=ball5", Some(1.5), 4.5, 1_000_000),
    asked("nine-ball-break", "position=ball9", Some(0.3), 0.3, 1_000_000),
    asked("cloth-on-a-ball", "position=cloth.middle", None, 0.1, 5_000_000),
    asked("box-stack", "position=falling", None, 0.5, 2_000_000),
    asked("block-on-incline", "position=block", Some(1.5), 1.5, 10_000_000),
    asked("tumbling-wrench", "position=wrench.0", Some(0.6), 0.6, 10_000_000),
    asked("slinky-release", "position=slinky.top", Some(0.05), 0.22, 100_000_000),
    asked("cantilever", "position=beam.tip", Some(0.02), 0.5, 100_000_000),
    asked("struck-bell", "position=bell.struck", None, 0.0005, 100_000_000),
    asked("warm-sphere", "temperature=sphere.pole", Some(0.2), 1.0, 100_000_000),
];

/// The tolerances asked for; the default size leaves out the tightest.
const TOLERANCES: [f64; 4] = [1e-1, 1e-2, 1e-3, 1e-4];

/// How much better than the tightest tolerance the truth is made, where it can be.
const TRUTH: f64 = 50.0;
/// How much better than a tolerance it must be to judge by.
const BETTER: f64 = 10.0;

/// The study is of counted work: no budget of time ends it early.
const BUDGET: Duration = Duration::from_secs(24 * 3600);

/// A question answered and searched.
struct Case {
    scene: &'static str,
    tolerance: f64,
    chosen: Found,
    best: Found,
    /// Work of choosing, in runs of the choice.
    effort: f64,
    /// Work of choosing, in the cheapest runs of the scene as it is written that would do.
    effort_written: f64,
    names: [String; 2],
    confirmed: bool,
}

/// What became of all questions.
#[derive(Default)]
struct Cases {
    answered: Vec<Case>,
    /// Questions to which the chooser knew no answer.
    undecided: Vec<String>,
    /// Questions that nothing here can judge: the truth itself is too uncertain.
    unknown: Vec<String>,
    scenes: usize,
}

fn study(size: Size) -> Result<Study, StudyError> {
    let mut cases = Cases::default();
    for asked in &ASKED {
        let horizon = match size {
            Size::Default => asked.short,
            Size::Full => Some(asked.long),
        };
        let Some(horizon) = horizon else { continue };
        let ladder = ladder(asked, horizon)?;
        let runs = MeasuredRuns::new(&ladder, BUDGET).map_err(StudyError::at(asked.scene))?;
        let mut runs = runs.bounded(asked.most_work);
        cases.scenes += 1;
        let tolerances = match size {
            Size::Default => &TOLERANCES[..3],
            Size::Full => &TOLERANCES[..],
        };
        let enough = tolerances[tolerances.len() - 1] / TRUTH;
        let families = preferred(&runs, enough);
        let truth = refer(&mut runs, &families, enough);
        for &tolerance in tolerances {
            let name = || format!("{} at {tolerance:e}", asked.scene);
            let judge = truth.as_ref().filter(|made| made.uncertainty <= tolerance / BETTER);
            let Some(truth) = judge else {
                cases.unknown.push(name());
                continue;
            };
            match case(asked, &mut runs, truth, tolerance) {
                Some(case) => cases.answered.push(case),
                None => cases.undecided.push(name()),
            }
        }
    }
    Ok(shown(&cases, &left_out(size)))
}

/// What a size leaves out, in words.
fn left_out(size: Size) -> String {
    if size == Size::Full {
        return String::new();
    }
    let large = ASKED.iter().filter(|asked| asked.short.is_none()).map(|asked| asked.scene);
    format!(
        " By default horizons are short and tolerances end at {:e}; {}, and the scenes' own horizons, are \
         under `--full`.",
        TOLERANCES[TOLERANCES.len() - 2],
        large.collect::<Vec<_>>().join(", ")
    )
}

fn ladder(asked: &Asked, horizon: f64) -> Result<SceneLadder, StudyError> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/scene/scenes");
    let file = folder.join(format!("{}.toml", asked.scene));
    let name = file.display().to_string();
    let text = fs::read_to_string(&file).map_err(StudyError::at(name.as_str()))?;
    let question = Question { observable: asked.observable.to_owned(), horizon: Some(horizon) };
    scene_ladder(&name, &text, &question).map_err(StudyError::at(asked.scene))
}

fn case(
    asked: &Asked,
    runs: &mut MeasuredRuns<'_>,
    truth: &Reference,
    tolerance: f64,
) -> Option<Case> {
    runs.forget();
    let answer = answer(runs, tolerance).ok()?;
    let row = answer.choice()?;
    let error = way_error(runs, truth, row.at, tolerance)?;
    let chosen = Found { at: row.at, work: row.work, error };
    let spent = answer.spent.total() as f64;
    let written = written(runs, truth, &chosen, tolerance) as f64;
    let (effort, effort_written) = (spent / row.work as f64, spent / written);
    let all: Vec<usize> = (0..runs.ladder().families.len()).collect();
    let best = exhaustive(runs, &all, truth, tolerance, row.work).unwrap_or(chosen);
    let name = |found: &Found| {
        let family = runs.family(found.at.family);
        format!("{} {:.3e}", family.name, family.rungs[found.at.rung].setting)
    };
    let names = [name(&chosen), name(&best)];
    let confirmed = matches!(answer.verdict, Verdict::Chosen(_));
    let scene = asked.scene;
    Some(Case { scene, tolerance, chosen, best, effort, effort_written, names, confirmed })
}

/// The work of the cheapest run of the scene as it is written that keeps to the tolerance: what a
/// simpler model saves is measured by it.
fn written(runs: &mut MeasuredRuns<'_>, truth: &Reference, chosen: &Found, tolerance: f64) -> u64 {
    if runs.family(chosen.at.family).converges() {
        return chosen.work;
    }
    let families = (0..runs.ladder().families.len()).filter(|&f| runs.family(f).converges());
    let families: Vec<usize> = families.collect();
    let known = runs.used().filter(|(at, run)| {
        let error = run.whole().map(|course| truth.error(course));
        families.contains(&at.family) && matches!(error, Some(Ok(error)) if error <= tolerance)
    });
    let Some(most) = known.map(|(_, run)| run.work).min() else { return chosen.work };
    exhaustive(runs, &families, truth, tolerance, most).map_or(most, |found| found.work)
}

impl Case {
    fn ratio(&self) -> f64 {
        self.chosen.work as f64 / self.best.work as f64
    }
}

fn shown(all: &Cases, left_out: &str) -> Study {
    let cases = &all.answered;
    let mut table = Table::new([
        Column::exact("scene"),
        Column::exact("tolerance"),
        Column::exact("chosen"),
        Column::rounded("work", 2, 0.0),
        Column::rounded("true error", 2, 1e-12),
        Column::exact("cheapest of all"),
        Column::rounded("chosen / cheapest work", 3, 0.0),
        Column::rounded("choosing / chosen work", 2, 0.0),
        Column::rounded("choosing / work of the scene as written", 2, 0.0),
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
            case.effort_written.into(),
        ]);
    }
    let largest = |of: &dyn Fn(&Case) -> f64| cases.iter().map(of).fold(0.0, f64::max);
    let part = |of: &dyn Fn(&Case) -> bool| {
        cases.iter().filter(|case| of(case)).count() as f64 / cases.len() as f64
    };
    Study {
        id: STUDY.id,
        krate: STUDY.krate,
        chapter: STUDY.chapter,
        kind: STUDY.kind,
        title: STUDY.title.to_owned(),
        conclusion: conclusion(all) + left_out,
        table,
        charts: vec![work(cases).into(), effort(cases).into(), distribution(cases).into()],
        claims: vec![
            Claim::words(
                "questions that are left undecided",
                "none",
                listed(all.undecided.clone()),
            ),
            Claim::words(
                "references that no run of another kind confirms, where the scene allows one",
                "none",
                names(cases.iter().filter(|case| !case.confirmed)),
            ),
            Claim::number(
                "part of the pairs in which the choice costs at most 1.1 times the cheapest rung",
                "0.94 or more",
                part(&|case| case.ratio() <= 1.1),
                (0.94, 1.0),
            ),
            Claim::number(
                "the choice's work over the cheapest rung's, at most",
                "4 or less",
                largest(&Case::ratio),
                (1.0, 4.0),
            ),
            Claim::number(
                "the true error over the tolerance, at most",
                "1 or less",
                largest(&|case| case.chosen.error / case.tolerance),
                (0.0, 1.0),
            ),
            Claim::number(
                "work of choosing over that of the choice, in the middle",
                "18 or less",
                middle(cases),
                (1.0, 18.0),
            ),
            Claim::number(
                "part of the pairs in which choosing costs at most forty runs of the choice",
                "0.75 or more",
                part(&|case| case.effort <= FORTY),
                (0.75, 1.0),
            ),
            Claim::number(
                "part in which it costs at most forty of the cheapest run of the scene as it is \
                 written that would do",
                "0.85 or more",
                part(&|case| case.effort_written <= FORTY),
                (0.85, 1.0),
            ),
        ],
        answers: Vec::new(),
    }
}

fn names<'c>(cases: impl Iterator<Item = &'c Case>) -> String {
    let names = cases.map(|case| format!("{} at {:e}", case.scene, case.tolerance));
    listed(names.collect())
}

fn listed(names: Vec<String>) -> String {
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

fn conclusion(all: &Cases) -> String {
    let cases = &all.answered;
    let same = cases.iter().filter(|case| case.chosen.work == case.best.work).count();
    let efforts = sorted(cases, |case| case.effort);
    let written = sorted(cases, |case| case.effort_written);
    let middle = middle(cases);
    let [most, most_written] =
        [&efforts, &written].map(|all| all.last().copied().unwrap_or(f64::NAN));
    let within = |most: f64| efforts.iter().filter(|&&effort| effort <= most).count();
    let [twenty, forty] = [20.0, FORTY].map(within);
    let forty_written = written.iter().filter(|&&effort| effort <= FORTY).count();
    let unknown = match all.unknown.as_slice() {
        [] => String::new(),
        some => format!(
            " {} more questions have no known answer to judge by: {}.",
            some.len(),
            some.join(", ")
        ),
    };
    format!(
        "{} shipped scenes, each at several tolerances: in {same} of {} pairs the chooser names the very \
         rung that running the whole ladder finds to be the cheapest, or one that costs the same. \
         Choosing takes {middle:.1} times the work of the choice in the middle, at most twenty times \
         in {twenty} pairs, forty in {forty}, and {most:.0} times at the worst, its own reference, its \
         confirmation, a look into every step and a finer mesh included: the most where a simple model \
         will do, for only the scene itself can show that, and one run of that is worth many of the \
         choice. Against the cheapest run of the scene as it is written that would do, it is at most \
         forty in {forty_written} pairs and {most_written:.0} at the worst.{unknown}",
        all.scenes,
        cases.len()
    )
}

/// What choosing cost in the middle.
fn middle(cases: &[Case]) -> f64 {
    let efforts = sorted(cases, |case| case.effort);
    efforts.get(efforts.len() / 2).copied().unwrap_or(f64::NAN)
}

/// What choosing cost, in runs of one kind.
type Effort = fn(&Case) -> f64;

fn sorted(cases: &[Case], of: Effort) -> Vec<f64> {
    let mut all: Vec<f64> = cases.iter().map(of).collect();
    all.sort_by(f64::total_cmp);
    all
}

/// Runs of the choice that choosing costs at most, mostly.
const FORTY: f64 = 40.0;

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
    let y = Axis::log("work of choosing / work of the choice", "");
    let lines = Lines::new("Work of choosing", x, y);
    let ends = [TOLERANCES[TOLERANCES.len() - 1], TOLERANCES[0]];
    let lines = lines.curve("forty runs of the choice", ends.map(|tolerance| (tolerance, FORTY)));
    by_scene(cases, lines, |case| (case.tolerance, case.effort))
}

/// Which part of the pairs costs at most so much.
fn distribution(cases: &[Case]) -> Lines {
    let x = Axis::log("work of choosing / work of the run", "");
    let lines = Lines::new("Work of choosing, all pairs", x, Axis::linear("part of the pairs", ""));
    let kinds: [(&str, Effort); 2] = [
        ("the run that is chosen", |case| case.effort),
        ("the cheapest of the scene as written", |case| case.effort_written),
    ];
    let lines = kinds.into_iter().fold(lines, |lines, (name, of)| {
        let all = sorted(cases, of);
        let count = all.len() as f64;
        let points = all.into_iter().enumerate().map(|(k, x)| (x, (k + 1) as f64 / count));
        lines.with(Series::new(name, points).marked(Mark::LineAndMarkers))
    });
    lines.curve("forty runs", [(FORTY, 0.0), (FORTY, 1.0)])
}
