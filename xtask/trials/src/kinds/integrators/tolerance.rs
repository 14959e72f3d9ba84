//! What a tolerance promises of the error at the end, and between the steps.
//!
//! ```text
//! error <= min(0.1, 100 tol max(1, A))       in the scale of the tolerance, root mean square
//! ```
//! `A` how far two reference runs that start `tol` apart are apart at that time, in units of `tol`.
//! Where `A tol > 0.01` a motion is too chaotic to be judged; reactions only above 0.1, and wrong
//! between the two where the error exceeds `max(0.1, 5 A tol)`. A motion that is too chaotic is cut in
//! half until it is not. In close encounters, and of predators whose few decide what comes later, the
//! methods for first-order systems are held to runs that part on the way, too: what they get wrong
//! within the tolerance at a pericentre is amplified more than what is wrong before. The Nystrom pairs
//! are not. What amplifies most is one direction among many: where a motion seems wrong, more are drawn.

use super::problem::InitialValue;
use super::runs::{Adaptive, Setting};
use super::{encounters, kinetics, smooth};
use crate::{Draw, Verdict};

/// Where `A tol` is above, a motion is too chaotic to be judged.
const CHAOTIC: f64 = 0.01;
/// The same for reactions, which are not chaotic: between the two, five times `A tol` is wrong.
const DISSIPATIVE: f64 = 0.1;
/// Places on the way at which reference runs part.
const PARTINGS: usize = 8;
/// How often further directions are drawn in which runs part.
const DIRECTIONS: usize = 4;
/// How often a motion that is too chaotic is cut in half: beyond that it is too chaotic at its start.
const SHORTENINGS: u32 = 8;

/// A problem of any family.
fn problem(draw: &mut Draw) -> InitialValue {
    match draw.below(16) {
        0 => smooth::linear(draw, false),
        1 => smooth::linear(draw, true),
        2 => smooth::oscillators(draw),
        3 => smooth::stiffening_chain(draw),
        4 => smooth::predators(draw),
        5 => smooth::lorenz(draw),
        6..=8 => encounters::orbit(draw),
        9 => encounters::stars(draw),
        10 | 11 => kinetics::response(draw),
        12 => kinetics::network(draw),
        13 => kinetics::catalysis(draw),
        14 => kinetics::relaxation(draw),
        _ => kinetics::driven(draw),
    }
}

/// The error at the end against the tolerance.
pub fn at_the_end(draw: &mut Draw) -> Verdict {
    if draw.chance(0.06) {
        let (problem, part) = encounters::fall(draw);
        let setting = Setting::draw(draw, &problem);
        draw.note(format!("{setting:?}"));
        if part > 1.0 {
            return match setting.states(&problem, &[problem.end]) {
                Err(_) => Verdict::due(),
                Ok(states) => Verdict::wrong(format!("passes a collision, to {states:?}")),
            };
        }
        return judge(draw, &problem, &setting, (&[problem.end], Looked::AtTheEnd));
    }
    let problem = problem(draw);
    let setting = Setting::draw(draw, &problem);
    draw.note(format!("{setting:?}"));
    judge(draw, &problem, &setting, (&[problem.end], Looked::AtTheEnd))
}

/// The error of dense output at random times against the tolerance.
pub fn between_the_steps(draw: &mut Draw) -> Verdict {
    let problem = problem(draw);
    let setting = Setting::draw(draw, &problem);
    draw.note(format!("{setting:?}"));
    let mut times: Vec<f64> =
        (0..draw.between(1, 8)).map(|_| problem.end * draw.uniform(1e-3, 1.0)).collect();
    times.push(problem.end);
    times.sort_by(f64::total_cmp);
    times.dedup();
    judge(draw, &problem, &setting, (&times, Looked::Between))
}

/// The root mean square of the differences in a scale.
fn distance(a: &[f64], b: &[f64], scale: &[f64]) -> f64 {
    let squares = a.iter().zip(b).zip(scale).map(|((a, b), s)| ((a - b) / s).powi(2));
    (squares.sum::<f64>() / a.len() as f64).sqrt()
}

/// Where the error is looked at.
#[derive(Clone, Copy, PartialEq)]
enum Looked {
    AtTheEnd,
    Between,
}

/// Judges at these times; where all of them are too chaotic, at half of them, and so on.
fn judge(
    draw: &mut Draw,
    problem: &InitialValue,
    setting: &Setting,
    (times, looked): (&[f64], Looked),
) -> Verdict {
    let mut times = times.to_vec();
    for _ in 0..SHORTENINGS {
        match sensitivity(draw, problem, setting, &times) {
            Ok(known) => return judge_known(draw, problem, setting, known, looked),
            Err(Unclear::Reference(why)) => return Verdict::not_judged(why),
            Err(Unclear::Chaotic) => times.iter_mut().for_each(|t| *t *= 0.5),
        }
    }
    Verdict::not_judged("too chaotic everywhere")
}

/// Judges by what is known. The directions in which runs part are drawn: before a motion with encounters
/// is called wrong, more of them are asked how far it amplifies an error.
fn judge_known(
    draw: &mut Draw,
    problem: &InitialValue,
    setting: &Setting,
    mut known: Vec<Known>,
    looked: Looked,
) -> Verdict {
    let times: Vec<f64> = known.iter().map(|known| known.t).collect();
    for _ in 0..DIRECTIONS {
        let verdict = compare(problem, setting, &known, looked);
        if partings(problem, setting) == 0 || !matches!(verdict, Verdict::Wrong { .. }) {
            return verdict;
        }
        match sensitivity(draw, problem, setting, &times) {
            Ok(more) => {
                for (known, more) in known.iter_mut().zip(more) {
                    known.amplified = known.amplified.max(more.amplified);
                }
            }
            Err(Unclear::Reference(why)) => return Verdict::not_judged(why),
            Err(Unclear::Chaotic) => return Verdict::not_judged("too chaotic in some direction"),
        }
    }
    compare(problem, setting, &known, looked)
}

/// At how many places on the way runs part.
fn partings(problem: &InitialValue, setting: &Setting) -> usize {
    match (setting.method, problem.name) {
        (Adaptive::Nystrom8 | Adaptive::Nystrom12, _) => 0,
        (_, "orbit" | "stars" | "predators") => PARTINGS,
        _ => 0,
    }
}

/// What the references know of a motion at a time.
struct Known {
    t: f64,
    truth: Vec<f64>,
    /// A coarser run, where there is no closed form.
    coarser: Option<Vec<f64>>,
    /// A: by how much an error of the tolerance was amplified until then.
    amplified: f64,
}

/// Why a motion is not judged.
enum Unclear {
    Chaotic,
    Reference(&'static str),
}

/// The truth and its sensitivity at these times, at one of which at least it can be judged.
fn sensitivity(
    draw: &mut Draw,
    problem: &InitialValue,
    setting: &Setting,
    times: &[f64],
) -> Result<Vec<Known>, Unclear> {
    let tolerance = setting.relative;
    let fine = (1e-3 * tolerance).clamp(1e-13, 1e-7);
    let begin = problem.begin();
    let Some(reference) = problem.reference(&begin, times, fine) else {
        return Err(Unclear::Reference("the reference does not reach the end"));
    };
    let coarser = match &problem.truth {
        Some(_) => None,
        None => match problem.reference(&begin, times, 30.0 * fine) {
            Some(coarser) => Some(coarser.states),
            None => return Err(Unclear::Reference("the coarser reference does not reach the end")),
        },
    };
    let truth: Vec<Vec<f64>> = match &problem.truth {
        Some(at) => times.iter().map(|&t| at(t)).collect(),
        None => reference.states,
    };
    let mut known: Vec<Known> = (times.iter().zip(truth).enumerate())
        .map(|(k, (&t, truth))| Known {
            t,
            truth,
            coarser: coarser.as_ref().map(|states| states[k].clone()),
            amplified: 1.0,
        })
        .collect();
    // Runs that part by tol at the start, and on the way.
    let partings = partings(problem, setting);
    let places = (1..=partings).map(|i| &reference.way[i * (reference.way.len() - 1) / partings]);
    for place in [&begin, &begin].into_iter().chain(places) {
        let first = times.partition_point(|&t| t <= place.0);
        if first == times.len() {
            continue;
        }
        let signs = draw.word();
        let moved: Vec<f64> = (place.1.iter().zip(setting.scale(&place.1)).enumerate())
            .map(|(i, (y, s))| {
                let up = *y == 0.0 || signs >> i & 1 == 0;
                y + tolerance * if up { s } else { -s }
            })
            .collect();
        let Some(apart) = problem.reference(&(place.0, moved), &times[first..], fine) else {
            return Err(Unclear::Chaotic);
        };
        for (known, state) in known[first..].iter_mut().zip(&apart.states) {
            let apart = distance(state, &known.truth, &setting.scale(&known.truth)) / tolerance;
            known.amplified = known.amplified.max(apart);
        }
        if known.iter().all(|known| known.amplified * tolerance > most_chaotic(problem, setting)) {
            return Err(Unclear::Chaotic);
        }
    }
    Ok(known)
}

/// Where `A tol` is above, the motion is not judged.
fn most_chaotic(problem: &InitialValue, setting: &Setting) -> f64 {
    let by_order = matches!(setting.method, Adaptive::BackwardDifferences(1 | 2));
    let reacts = matches!(problem.name, "response" | "kinetics") && !by_order;
    if reacts { DISSIPATIVE } else { CHAOTIC }
}

/// What the method says, against what is known.
fn compare(problem: &InitialValue, setting: &Setting, known: &[Known], looked: Looked) -> Verdict {
    let (tolerance, method) = (setting.relative, setting.method);
    let times: Vec<f64> = known.iter().map(|known| known.t).collect();
    let found = match setting.states(problem, &times) {
        Ok(found) => found,
        Err(error) => {
            let what = error.to_string();
            return Verdict::refused(what.split(" at t").next().unwrap_or_default());
        }
    };
    if found.len() != times.len() {
        return Verdict::wrong(format!("{} of {} times were given", found.len(), times.len()));
    }
    let mut verdict = Verdict::not_judged("too chaotic everywhere");
    for (Known { t, truth, coarser, amplified }, found) in known.iter().zip(&found) {
        let scale = setting.scale(truth);
        let amplified = *amplified;
        if amplified * tolerance > most_chaotic(problem, setting) {
            continue;
        }
        let beyond = amplified * tolerance > CHAOTIC;
        let promised = if beyond {
            (5.0 * amplified * tolerance).max(0.1)
        } else {
            promised(setting, amplified)
        };
        // Its dense output is held to its own tolerance where a stiff part is driven.
        let own = match (method, problem.stiff, looked) {
            (Adaptive::Radau, true, Looked::Between) => 10.0 * tolerance.powf(2.0 / 3.0),
            _ => 0.0,
        };
        let promised = promised.max((own * amplified).min(0.1));
        if coarser.as_ref().is_some_and(|state| distance(state, truth, &scale) > 0.1 * promised) {
            return Verdict::not_judged("the reference is not sure");
        }
        let error = distance(found, truth, &scale);
        let what = format!(
            "{} by {method:?} at {tolerance:.1e}, t = {t} of {}, A = {amplified:.1e}",
            problem.name,
            times[times.len() - 1]
        );
        let here = Verdict::of(error, promised, &what);
        verdict = match verdict {
            Verdict::NotJudged { .. } => here,
            other => other.and(here),
        };
    }
    verdict
}

/// The bound that holds where errors of `tol` are amplified so many times. A formula that is held to
/// order k needs `tol^(-1/(k + 1))` steps, whose errors add up.
fn promised(setting: &Setting, amplified: f64) -> f64 {
    let tolerance = setting.relative;
    match setting.method {
        Adaptive::BackwardDifferences(k @ (1 | 2)) => {
            100.0 * tolerance.powf(k as f64 / (k + 1) as f64) * amplified
        }
        _ => (100.0 * tolerance * amplified).min(0.1),
    }
}
