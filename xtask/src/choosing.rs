//! Random questions to `choose` about random scenes: is what it recommends true along the whole way?
//!
//! The truth is the scene's own model, in closed form or by other solvers at a far tighter setting.
//! The recommended run is looked at in every step, at its end and at parts of it that the chooser does
//! not look at.

mod flow;
mod scenes;
mod truth;

use std::collections::VecDeque;
use std::time::Duration;

use stationary_choose::Kind as SettingKind;
use stationary_choose::{
    Answer, At, Doubt, Experiment, Failure, Judgement, MOMENTS, MeasuredRuns, Moments,
    QuestionError, Row, Verdict as Said, answer,
};
use stationary_scene::choose::{Change, ChooseError, Question, SceneLadder, changed, scene_ladder};
use stationary_scene::{Checkpoint, Control, Observer, Progress, Scene};
use stationary_trials::{Draw, Kind, Verdict};

pub use scenes::Asked;

/// The kinds of trials of the chooser.
pub const KINDS: &[Kind] = &[Kind {
    name: "choosing",
    krate: "xtask",
    rule: "a choice without a warning whose observable is farther from the truth than the tolerance \
           times the scale that it states, at the end of a step or at five parts of it; \
           a run rejected for wrong physics or for its error that keeps to half of the tolerance, \
           and whose energy is right, at these parts and wherever the chooser may look; refused where a \
           run of a sixtieth of the work that the question may take keeps to the tolerance, else apart, as \
           is a contact that leads elsewhere itself",
    in_tests: 20,
    trial,
}];

/// Parts of a step, none of which the chooser looks at.
const PARTS: [f64; 5] = [0.118, 0.317, 0.5, 0.618, 0.871];
/// Halvings of the horizon's twentieths from which on the chooser looks at the same parts of each step.
const EVERY_STEP: u32 = 3;
/// Moments within steps that are looked at; of more steps every so manieth.
const INSIDE: u64 = 20_000;
/// Readings of a run that chooses its own steps.
const READINGS: u64 = 4000;
/// Counted work that a question may take.
const MOST_WORK: u64 = 8_000_000;
/// The work of a choice that is found within that: choosing costs up to sixty runs of it.
const EXPECTED: u64 = MOST_WORK / 60;
/// The part of the tolerance that the truth must be known to.
const CERTAIN: f64 = 0.01;
/// Tolerances that a reference may be from the truth where a choice is right by both, and a half.
const APART: f64 = 2.5;
/// Rejected runs that are looked at.
const REJECTED: usize = 3;

/// Time that choosing may take.
const BUDGET: Duration = Duration::from_secs(120);

/// A random question, and the ladder of its scene.
pub fn posed(draw: &mut Draw) -> (Asked, Result<SceneLadder, ChooseError>) {
    let asked = scenes::asked(draw);
    let ladder = scene_ladder("case.toml", &asked.text, &Question::new(&asked.observable));
    (asked, ladder)
}

/// The ladder with nothing measured, and the work that a question may take.
pub fn bounded_runs(ladder: &SceneLadder) -> Result<MeasuredRuns<'_>, QuestionError> {
    Ok(MeasuredRuns::new(ladder, BUDGET)?.bounded(MOST_WORK))
}

fn trial(draw: &mut Draw) -> Verdict {
    let (asked, ladder) = posed(draw);
    let ladder = match ladder {
        Ok(ladder) => ladder,
        Err(error) => return Verdict::refused(format!("{}: {error}", asked.family)),
    };
    let answered = bounded_runs(&ladder)
        .and_then(|mut runs| answer(&mut runs, asked.tolerance).map(|answer| (answer, runs)));
    let (answer, mut runs) = match answered {
        Ok(answered) => answered,
        Err(error) => return Verdict::refused(format!("{}: {error}", asked.family)),
    };
    let family = asked.family;
    let refused = |runs: &mut MeasuredRuns<'_>, why: &str| refused((runs, &ladder), &asked, why);
    let row = match answer.verdict {
        Said::Chosen(at) => at,
        Said::Unconfirmed(_) => return refused(&mut runs, "not confirmed"),
        Said::NoneMeets => return refused(&mut runs, "none meets"),
        Said::Uncertain => return refused(&mut runs, "uncertain"),
        Said::Doubtful(doubt) => return refused(&mut runs, word(doubt)),
        Said::Still if is_still(&ladder) => return Verdict::due(),
        Said::Still => return Verdict::wrong(format!("{family}: it moves, and is said not to")),
    };
    let Some(scale) = answer.reference.as_ref().map(|reference| reference.course.scale) else {
        return Verdict::wrong("a choice without a reference");
    };
    let promised = asked.tolerance * scale;
    let verdict = match judged(&ladder, row, promised) {
        Ok(error) if error > promised && contact_errs(&ladder, row, promised) => {
            return Verdict::apart(format!(
                "{family}: contact itself leads elsewhere, by {error:.1e} of {promised:.1e}"
            ));
        }
        Ok(error) => {
            let name = &runs.family(row.family).name;
            let setting = runs.family(row.family).rungs[row.rung].setting;
            Verdict::of(error, promised, &format!("{family} by {name} at {setting:.3e}"))
        }
        Err(why) => return Verdict::not_judged(format!("{family}: {why}")),
    };
    if !matches!(verdict, Verdict::Right { .. }) {
        return verdict;
    }
    rejected(&ladder, &answer, promised, family).into_iter().fold(verdict, Verdict::and)
}

/// A refusal: was there a choice? Where things overlap at the start, there is no motion to choose for.
fn refused(
    (runs, ladder): (&mut MeasuredRuns<'_>, &SceneLadder),
    asked: &Asked,
    why: &str,
) -> Verdict {
    let family = asked.family;
    if let Err(error) = ladder.written().scene.run()
        && error.to_string().contains("overlap")
    {
        return Verdict::apart(format!("{family}: it starts overlapping"));
    }
    match existed((runs, ladder), asked.tolerance) {
        Ok(Some(name)) => Verdict::refused(format!("{family}: {why}, though {name} does")),
        Ok(None) => Verdict::apart(format!("{family}: {why}, and no choice exists")),
        Err(unknown) => Verdict::not_judged(format!("{family}: {why}; {unknown}")),
    }
}

/// A method that keeps to the tolerance along its way, by the truth, for so little work that choosing it
/// was to be expected; every setting of each is tried, and the first few that do at the moments are looked
/// at along their way.
fn existed(
    (runs, ladder): (&mut MeasuredRuns<'_>, &SceneLadder),
    tolerance: f64,
) -> Result<Option<String>, String> {
    let scene = ladder.written().scene.clone();
    let horizon = scene.timing().horizon();
    let times: Vec<f64> = (1..=MOMENTS).map(|k| k as f64 * horizon / MOMENTS as f64).collect();
    let known = truth::truth(&scene, &times)?;
    let mut looked = 0;
    for family in 0..runs.ladder().families.len() {
        if !runs.family(family).converges() {
            continue;
        }
        for rung in 0..runs.family(family).rungs.len() {
            let at = At { family, rung };
            if looked >= WITNESSES || runs.family(family).rungs[rung].least_work > EXPECTED {
                break;
            }
            runs.forget();
            let run = runs.measure(at);
            if run.work > EXPECTED {
                break;
            }
            let Some(course) = run.whole() else { continue };
            let promised = tolerance * course.scale;
            let errors = course.values.iter().skip(1).zip(&known.values).map(|(x, truth)| {
                x.iter().zip(truth).map(|(x, truth)| (x - truth).powi(2)).sum::<f64>().sqrt()
            });
            let close = errors.fold(0.0, f64::max) <= promised;
            if !close {
                continue;
            }
            looked += 1;
            if judged(ladder, at, promised).is_ok_and(|error| error <= promised) {
                return Ok(Some(runs.family(family).name.clone()));
            }
        }
    }
    Ok(None)
}

/// Runs that are looked at along their way, where a question was refused.
const WITNESSES: usize = 3;

/// Whether a scene in which things touch comes to another motion than the truth, however fine its steps:
/// then it is its contact that errs.
fn contact_errs(ladder: &SceneLadder, at: At, promised: f64) -> bool {
    let rungs = &ladder.ladder().families[at.family].rungs;
    let touches = ladder.written().scene.contact().is_some();
    let mut finest: Vec<usize> = (at.rung + 1..rungs.len()).collect();
    finest.retain(|&rung| rungs[rung].least_work < EXPECTED);
    finest.drain(..finest.len().saturating_sub(2));
    let errs = |&rung: &usize| {
        judged(ladder, At { rung, ..at }, promised).is_ok_and(|error| error > promised)
    };
    touches && finest.len() == 2 && finest.iter().all(errs)
}

/// A doubt without its number.
fn word(doubt: Doubt) -> &'static str {
    match doubt {
        Doubt::Unseen => "not followed over the whole way",
        Doubt::Energy(_) => "the reference's energy changes",
        Doubt::Uncertain(_) => "uncertain over the whole way",
        Doubt::Disagrees(_) => "two kinds disagree",
        Doubt::Restless => "too many wrong choices",
    }
}

/// Whether the observable truly moves by no more than rounding of what is there.
fn is_still(ladder: &SceneLadder) -> bool {
    let Ok(scene) = Scene::parse("case.toml", &ladder.written().text) else { return false };
    let horizon = scene.timing().horizon();
    let times: Vec<f64> = (1..=200).map(|k| f64::from(k) * horizon / 200.3).collect();
    let Ok(known) = truth::truth(&scene, &times) else { return true };
    let first = &known.values[0];
    let size = known.values.iter().flatten().fold(1e-3_f64, |size, x| size.max(x.abs()));
    let way = known.values.iter().flat_map(|x| x.iter().zip(first).map(|(x, y)| (x - y).abs()));
    way.fold(0.0, f64::max) <= 1e-9 * size
}

/// Runs that were rejected though they keep to the truth.
fn rejected(ladder: &SceneLadder, answer: &Answer, promised: f64, family: &str) -> Vec<Verdict> {
    // The choice is right by the truth and by the reference: what errs by more against the one errs against
    // the other.
    let far = APART * answer.tolerance;
    let wrong = |row: &&Row| {
        matches!(row.judgement, Some(Judgement::Failed(Failure::WrongPhysics(_))))
            || matches!(row.judgement, Some(Judgement::Misses(error)) if error <= far)
                && row.word() == "misses it"
    };
    let judged = |row: &Row| {
        // As it was run, and read off wherever the chooser may have.
        let error = closely_judged(ladder, row.at, promised).ok()?;
        let error = error.max(as_run(ladder, row.at, promised).ok()?);
        if error > 0.5 * promised || energy_is_off(ladder, row.at) {
            return None;
        }
        let what =
            format!("{family}: {} at {} is rejected: {}", row.method, row.setting, row.word());
        Some(Verdict::wrong(format!("{what}, and errs by {error:.1e} of {promised:.1e}")))
    };
    // The finest of them are the likeliest to be right.
    answer.rows.iter().rev().filter(wrong).take(REJECTED).filter_map(judged).collect()
}

/// Whether the energy of a run is off by a tenth of the largest kinetic energy, or is not known.
fn energy_is_off(ladder: &SceneLadder, at: At) -> bool {
    let text = |word: &str, text: &str| {
        changed(text, &[Change::to("observables", format!("[\"{word}\"]"))])
    };
    let kind = ladder.ladder().families[at.family].kind;
    let written = &ladder.written().text;
    let off = |word: &str| {
        let written = text(word, written);
        let run = text(word, &ladder.text(at));
        compared(&written, &run, kind, f64::INFINITY)
    };
    let kinetic =
        Scene::parse("case.toml", &text("kinetic-energy", written)).ok().and_then(|scene| {
            let moments: Vec<f64> =
                (1..=100).map(|k| 0.01 * f64::from(k) * scene.timing().horizon()).collect();
            let known = truth::truth(&scene, &moments).ok()?;
            Some(known.values.iter().flatten().copied().fold(0.0, f64::max))
        });
    match (off("energy"), kinetic) {
        // What is not known may be off.
        (Ok(off), Some(kinetic)) if off.is_finite() => off > 0.1 * kinetic,
        _ => true,
    }
}

/// The largest error of a setting's run along its way.
fn judged(ladder: &SceneLadder, at: At, promised: f64) -> Result<f64, String> {
    let kind = ladder.ladder().families[at.family].kind;
    compared(&ladder.written().text, &ladder.text(at), kind, promised)
}

/// The same at all parts of a step at which the chooser may look, too: a step may err in a small part of it
/// alone, as that in which a block stops.
fn closely_judged(ladder: &SceneLadder, at: At, promised: f64) -> Result<f64, String> {
    let kind = ladder.ladder().families[at.family].kind;
    let every = [Moments::equal(EVERY_STEP, 1.0), Moments::closely(0, 1.0)];
    let first = every.iter().flat_map(|moments| {
        let parts = (moments.times.len() / (moments.within + 1)) as f64;
        moments.times[..moments.within].iter().map(move |t| t * parts)
    });
    let mut parts: Vec<f64> = first.chain(PARTS).collect();
    parts.sort_by(f64::total_cmp);
    off(&ladder.written().text, &way(&ladder.text(at), kind, &parts)?, promised)
}

/// The same at the samples of the chooser's own run: an adaptive method may take a long step by halves
/// where it is asked for what lies within.
fn as_run(ladder: &SceneLadder, at: At, promised: f64) -> Result<f64, String> {
    let run = Scene::parse("case.toml", &ladder.text(at)).map_err(|error| error.to_string())?;
    let run = run.run().map_err(|error| error.to_string())?;
    let samples = run.times().iter().enumerate().skip(1);
    let way: Vec<_> = samples.map(|(k, &t)| (t, run.observed(k).to_vec())).collect();
    off(&ladder.written().text, &way, promised)
}

fn compared(written: &str, run: &str, kind: SettingKind, promised: f64) -> Result<f64, String> {
    off(written, &way(run, kind, &PARTS)?, promised)
}

/// The largest error of what was observed at times.
fn off(written: &str, way: &[(f64, Vec<f64>)], promised: f64) -> Result<f64, String> {
    let scene = Scene::parse("case.toml", written).map_err(|error| error.to_string())?;
    let times: Vec<f64> = way.iter().map(|(t, _)| *t).collect();
    let known = truth::truth(&scene, &times)?;
    if known.uncertain.is_nan() || known.uncertain > CERTAIN * promised {
        return Err("two solvers disagree".to_owned());
    }
    let errors = way.iter().zip(&known.values).map(|((_, x), truth)| {
        x.iter().zip(truth).map(|(x, truth)| (x - truth).powi(2)).sum::<f64>().sqrt()
    });
    Ok(errors.fold(0.0, |a: f64, b| if b > a || b.is_nan() { b } else { a }))
}

/// What a run observed: at the ends of its steps and at parts of them.
fn way(text: &str, kind: SettingKind, within: &[f64]) -> Result<Vec<(f64, Vec<f64>)>, String> {
    let parse = |text: &str| Scene::parse("case.toml", text).map_err(|error| error.to_string());
    let mut scene = parse(text)?;
    let horizon = scene.timing().horizon();
    let mut changes = vec![Change::to("sample_every", "1")];
    if kind != SettingKind::EqualSteps {
        changes.push(Change::to("step", format!("{:?}", horizon / READINGS as f64)));
    }
    scene = match parse(&changed(text, &changes)) {
        Ok(scene) => scene,
        Err(_) => scene,
    };
    let stride = scene.timing().steps().div_ceil(INSIDE / within.len() as u64).max(1);
    let mut looking = Looking {
        reads: match kind {
            SettingKind::EqualSteps => Reads::Parts { stride },
            _ => Reads::Ends,
        },
        h: scene.timing().step(),
        within,
        parts: Vec::new(),
        ends: Vec::new(),
        found: Vec::new(),
    };
    let mut run = scene.run_from(None, &mut looking).map_err(|error| error.to_string())?;
    if kind == SettingKind::Adaptive {
        // A spike within a short accepted step would be passed over.
        looking.reads = Reads::Times { ahead: moments(&looking.ends, within).into() };
        looking.found.clear();
        run = scene.run_from(None, &mut looking).map_err(|error| error.to_string())?;
    }
    let mut found = looking.found;
    if scene.heat().is_some() && kind == SettingKind::EqualSteps {
        // Steps of heat have no parts: straight lines.
        let ends = found.clone();
        let mut before = (0.0, run.observed(0).to_vec());
        for end in ends {
            for &part in within {
                let line = before.1.iter().zip(&end.1).map(|(a, b)| a + part * (b - a)).collect();
                found.push((before.0 + part * (end.0 - before.0), line));
            }
            before = end;
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    Ok(found)
}

/// Parts of accepted steps, and their ends.
fn moments(ends: &[f64], within: &[f64]) -> Vec<f64> {
    let starts = [0.0].into_iter().chain(ends.iter().copied());
    let each = starts.zip(ends).flat_map(|(start, &end)| {
        within.iter().copied().chain([1.0]).map(move |part| start + part * (end - start))
    });
    let horizon = ends.last().copied().unwrap_or_default();
    each.filter(|&t| t < horizon).collect()
}

/// What is looked at besides the ends of a scene's steps.
enum Reads {
    /// Parts of every so manieth of them.
    Parts { stride: u64 },
    /// Nothing.
    Ends,
    /// These times.
    Times { ahead: VecDeque<f64> },
}

/// Keeps what it sees.
struct Looking<'w> {
    reads: Reads,
    h: f64,
    /// Parts of a step.
    within: &'w [f64],
    parts: Vec<f64>,
    /// The ends of accepted steps.
    ends: Vec<f64>,
    found: Vec<(f64, Vec<f64>)>,
}

impl Observer for Looking<'_> {
    fn stepped(&mut self, now: Progress<'_>) -> Control {
        self.found.push((now.time, now.observed.to_vec()));
        Control::Continue
    }

    fn keep(&mut self, _: &Checkpoint) {}

    fn parts(&mut self, step: u64) -> &[f64] {
        let end = step as f64 * self.h;
        self.parts.clear();
        match &mut self.reads {
            Reads::Parts { stride } if step.is_multiple_of(*stride) => {
                self.parts.extend(self.within)
            }
            Reads::Parts { .. } | Reads::Ends => {}
            Reads::Times { ahead } => {
                let due = ahead.partition_point(|&t| t < end);
                let part = |t: f64| ((t - (end - self.h)) / self.h).clamp(0.0, 1.0);
                self.parts.extend(ahead.drain(..due).map(part));
            }
        }
        &self.parts
    }

    fn inside(&mut self, time: f64, observed: &[f64]) {
        self.found.push((time, observed.to_vec()));
    }

    fn own_ends(&mut self, ends: &[f64]) {
        self.ends.extend_from_slice(ends);
    }
}
