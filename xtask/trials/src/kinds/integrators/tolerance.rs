//! What a tolerance promises of the error at the end, and between the steps.
//!
//! ```text
//! error <= min(0.1, 100 tol max(1, A))       in the scale of the tolerance, root mean square
//! ```
//! `A` how far two reference runs that start `tol` apart are apart at that time, in units of `tol`.
//! Where `A tol > 0.01` a motion is too chaotic to be judged; reactions only above 0.1, and wrong
//! between the two where the error exceeds `max(0.1, 5 A tol)`. In close encounters the methods for
//! first-order systems are held to runs that part on the way, too: what they get wrong within the
//! tolerance at a pericentre is amplified more than what is wrong before. The Nystrom pairs are not.

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

fn judge(
    draw: &mut Draw,
    problem: &InitialValue,
    setting: &Setting,
    (times, looked): (&[f64], Looked),
) -> Verdict {
    let tolerance = setting.relative;
    let fine = (1e-3 * tolerance).clamp(1e-13, 1e-7);
    let begin = problem.begin();
    let Some(reference) = problem.reference(&begin, times, fine) else {
        return Verdict::not_judged("the reference does not reach the end");
    };
    let (truth, doubt) = match &problem.truth {
        Some(at) => (times.iter().map(|&t| at(t)).collect(), None),
        None => match problem.reference(&begin, times, 30.0 * fine) {
            Some(coarser) => (reference.states, Some(coarser.states)),
            None => return Verdict::not_judged("the coarser reference does not reach the end"),
        },
    };
    // Runs that part by tol at the start, and on the way.
    let mut amplified = vec![1.0_f64; times.len()];
    let partings = match (setting.method, problem.name) {
        (Adaptive::Nystrom8 | Adaptive::Nystrom12, _) => 0,
        (_, "orbit" | "stars") => PARTINGS,
        _ => 0,
    };
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
            return Verdict::not_judged("a reference from nearby does not reach the end");
        };
        for (k, state) in (first..).zip(&apart.states) {
            let apart = distance(state, &truth[k], &setting.scale(&truth[k])) / tolerance;
            amplified[k] = amplified[k].max(apart);
        }
    }
    let found = match setting.states(problem, times) {
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
    for (k, &t) in times.iter().enumerate() {
        let scale = setting.scale(&truth[k]);
        let amplified = amplified[k];
        let by_order = matches!(setting.method, Adaptive::BackwardDifferences(1 | 2));
        let reacts = matches!(problem.name, "response" | "kinetics") && !by_order;
        let limit = if reacts { DISSIPATIVE } else { CHAOTIC };
        if amplified * tolerance > limit {
            continue;
        }
        let beyond = amplified * tolerance > CHAOTIC;
        let promised = if beyond {
            (5.0 * amplified * tolerance).max(0.1)
        } else {
            promised(setting, amplified)
        };
        // Its dense output is held to its own tolerance where a stiff part is driven.
        let own = match (setting.method, problem.stiff, looked) {
            (Adaptive::Radau, true, Looked::Between) => 10.0 * tolerance.powf(2.0 / 3.0),
            _ => 0.0,
        };
        let promised = promised.max((own * amplified).min(0.1));
        if doubt.as_ref().is_some_and(|d| distance(&d[k], &truth[k], &scale) > 0.1 * promised) {
            return Verdict::not_judged("the reference is not sure");
        }
        let error = distance(&found[k], &truth[k], &scale);
        let method = setting.method;
        let what = format!(
            "{} by {method:?} at {tolerance:.1e}, t = {t} of {}, A = {amplified:.1e}",
            problem.name, problem.end
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
