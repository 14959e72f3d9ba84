//! Does the error of a fixed-step method fall with the power of the step that it claims?
//!
//! ```text
//! error(h) ~ C h^k,      error the largest at sixteen times along the way
//! ```
//! The time over which a motion is followed is chosen for the method: such that a few long steps are
//! off by about as much as is asymptotic still. Where the slope is too low, but another one from each
//! pair of steps to the next, it is that of no power and says nothing of the order.

use std::rc::Rc;

use nalgebra::DMatrix;
use stationary_calculus::{BilinearForm, Covector, DiagonalMetric, System};
use stationary_integrators::{Filter, Gautschi, Imex, Integrator, Method, State, StepError};
use stationary_measure::loglog_slope;

use super::problem::{InitialValue, mechanics, motion};
use super::runs::Forces;
use super::{encounters, smooth};
use crate::{Draw, Verdict};

/// Times at which the error is looked at.
pub const TIMES: usize = 16;
/// Errors above are as large as the motion, errors below are rounding.
const ASYMPTOTIC: std::ops::Range<f64> = 1e-10..1e-3;
/// The same for methods of order 1, whose errors are never small.
const ASYMPTOTIC_OF_ORDER_1: std::ops::Range<f64> = 1e-10..1e-2;
/// Errors below so many times the doubt about the truth say nothing.
pub const DOUBTS: f64 = 10.0;
/// Steps between two of the times in the coarsest run.
const COARSE: usize = 4;
/// Most steps between two of the times.
const FINE: usize = 512;
/// Times of motion that are tried for the coarsest run to be in the range.
const FITTINGS: usize = 16;
/// The slope may be this much below the order.
const BAND: f64 = 0.4;
/// The slopes of a power differ by less than this.
const POWER: f64 = 0.15;

type Mass = DiagonalMetric<Vec<f64>>;

/// A motion whose forces have a potential.
pub fn conservative(draw: &mut Draw) -> InitialValue {
    match draw.below(3) {
        0 => smooth::oscillators(draw),
        1 => smooth::stiffening_chain(draw),
        _ => {
            let rest = draw.uniform(0.5, 1.0);
            encounters::orbit_of(draw, rest)
        }
    }
}

/// Draws a method and a system, and judges the slope.
pub fn trial(draw: &mut Draw) -> Verdict {
    if draw.chance(0.15) {
        return split(draw);
    }
    let method = draw.one_of(Method::ALL);
    let problem = conservative(draw);
    draw.note(format!("{method}"));
    let metric = DiagonalMetric::new(problem.masses.clone().expect("mechanics"));
    let system = System::new(metric.expect("masses"), Forces(&problem)).expect("one size");
    let mut stepper = match method.integrator::<_, _, Vec<f64>>(&system) {
        Ok(stepper) => stepper,
        Err(error) => return Verdict::refused(error),
    };
    judge(&mut *stepper, &problem)
}

/// A stiff linear part and a soft one that is not, for the methods that treat them apart.
fn split(draw: &mut Draw) -> Verdict {
    let soft = smooth::stiffening_chain(draw);
    let masses = soft.masses.clone().expect("mechanics");
    let n = masses.len();
    let modes = smooth::orthogonal(draw, n);
    let values = nalgebra::DVector::from_fn(n, |_, _| draw.log_uniform(0.1, 100.0));
    let stiffness = &modes * DMatrix::from_diagonal(&values) * modes.transpose();
    let stiffness = 0.5 * (&stiffness + stiffness.transpose());
    let filter = draw.one_of(&[
        None,
        Some(Filter::Impulse),
        Some(Filter::Mollified),
        Some(Filter::Gautschi),
    ]);
    draw.note(format!("{filter:?}, stiffness {stiffness}"));
    let zero = linear_part(&soft, &stiffness);
    let slope = Rc::new(soft.slope);
    let (soft_slope, added) = (slope.clone(), stiffness.clone());
    let soft = InitialValue { slope: Box::new(move |t, y, f| soft_slope(t, y, f)), ..soft };
    let problem = InitialValue {
        name: "split",
        slope: Box::new(move |t, y, f| {
            slope(t, y, f);
            let force = &added * nalgebra::DVector::from_column_slice(&y[..n]);
            f[n..].iter_mut().zip(force.iter()).for_each(|(f, k)| *f -= k);
        }),
        derivative: Box::new(|_, _, _| {}),
        start: soft.start.clone(),
        end: soft.end.min(2.0),
        sizes: soft.sizes.clone(),
        truth: None,
        stiff: false,
        masses: soft.masses.clone(),
        energy: None,
    };
    let metric: Mass = DiagonalMetric::new(masses).expect("masses");
    match filter {
        None => {
            let system = System::new(metric, Forces(&zero)).expect("one size");
            match Imex::<_, _, _, Vec<f64>>::new(&system, Forces(&soft)) {
                Ok(mut imex) => judge(&mut imex, &problem),
                Err(error) => Verdict::refused(error),
            }
        }
        Some(filter) => {
            let system = System::new(metric, Forces(&soft)).expect("one size");
            match Gautschi::<_, _, Vec<f64>>::new(&system, &BilinearForm(stiffness), filter) {
                Ok(mut gautschi) => judge(&mut gautschi, &problem),
                Err(error) => Verdict::refused(error),
            }
        }
    }
}

/// The linear part alone.
fn linear_part(soft: &InitialValue, stiffness: &DMatrix<f64>) -> InitialValue {
    let [force, hessian, energy] = [(); 3].map(|()| stiffness.clone());
    let masses = soft.masses.clone().expect("mechanics");
    let field = mechanics(
        masses.clone(),
        move |q, dv| {
            dv.copy_from_slice((&force * nalgebra::DVector::from_column_slice(q)).as_slice());
        },
        move |_, h| h.copy_from_slice(hessian.as_slice()),
    );
    let course = (soft.start.clone(), soft.sizes.clone(), soft.end);
    motion("linear part", masses, field, Some(smooth::quadratic(&energy)), course)
}

/// The states at the times until the end, in this many steps between each two of them.
fn path(
    stepper: &mut dyn Integrator<Vec<f64>>,
    start: &[f64],
    (end, steps): (f64, usize),
) -> Result<Vec<Vec<f64>>, StepError> {
    let (q, p) = start.split_at(start.len() / 2);
    let mut state = State::new(q.to_vec(), Covector(p.to_vec()));
    let h = end / (TIMES * steps) as f64;
    let mut path = Vec::with_capacity(TIMES);
    for _ in 0..TIMES {
        for _ in 0..steps {
            stepper.step(&mut state, h)?;
        }
        path.push(state.q.iter().chain(state.p.components()).copied().collect());
    }
    Ok(path)
}

/// The largest difference of two paths, in parts of the motion's size.
fn distance(path: &[Vec<f64>], other: &[Vec<f64>], sizes: &[f64]) -> f64 {
    let pairs = path.iter().zip(other).flat_map(|(a, b)| a.iter().zip(b).zip(sizes));
    pairs.map(|((a, b), size)| (a - b).abs() / size).fold(0.0, f64::max)
}

/// The time in which the coarsest run goes wrong by about `aim`, as a run of half its step says.
fn fitting_end(
    stepper: &mut dyn Integrator<Vec<f64>>,
    (problem, start): (&InitialValue, &[f64]),
    aim: f64,
) -> f64 {
    let mut end = problem.end;
    let power = 1.0 / f64::from(stepper.facts().order + 1);
    for _ in 0..FITTINGS {
        let mut follow = |steps| path(stepper, start, (end, steps));
        let error = match (follow(COARSE), follow(2 * COARSE)) {
            (Ok(coarse), Ok(fine)) => distance(&coarse, &fine, &problem.sizes),
            _ => f64::INFINITY,
        };
        if (0.2 * aim..aim).contains(&error) {
            break;
        }
        end *= (0.5 * aim / error.max(1e-300)).powf(power).clamp(0.3, 3.0);
    }
    end
}

/// The states at these times, and how far a coarser reference is from them.
pub fn truth(
    (problem, start): (&InitialValue, &[f64]),
    times: &[f64],
) -> Option<(Vec<Vec<f64>>, f64)> {
    if let Some(at) = &problem.truth
        && start == problem.start
    {
        return Some((times.iter().map(|&t| at(t)).collect(), 0.0));
    }
    let follow = |tolerance| problem.reference(&(0.0, start.to_vec()), times, tolerance);
    let (found, coarser) = (follow(1e-13)?.states, follow(1e-12)?.states);
    let doubt = distance(&coarser, &found, &problem.sizes);
    Some((found, doubt))
}

/// The slope on a stretch of the motion; where it lacks, on the next, too. Once in some ten thousand
/// motions the errors of a high order follow a lower power for three steps that are still too long.
fn judge(stepper: &mut dyn Integrator<Vec<f64>>, problem: &InitialValue) -> Verdict {
    match judge_from(stepper, problem, &problem.start) {
        (Verdict::Wrong { .. }, Some(next)) => judge_from(stepper, problem, &next).0,
        (verdict, _) => verdict,
    }
}

/// The slope from a start, and the state at the end.
fn judge_from(
    stepper: &mut dyn Integrator<Vec<f64>>,
    problem: &InitialValue,
    start: &[f64],
) -> (Verdict, Option<Vec<f64>>) {
    let facts = stepper.facts();
    let range = if facts.order == 1 { ASYMPTOTIC_OF_ORDER_1 } else { ASYMPTOTIC };
    let end = fitting_end(stepper, (problem, start), range.end);
    let times: Vec<f64> = (1..=TIMES).map(|i| end * i as f64 / TIMES as f64).collect();
    let Some((truth, doubt)) = truth((problem, start), &times) else {
        return (Verdict::not_judged("the reference does not reach the end"), None);
    };
    let range = range.start.max(DOUBTS * doubt)..range.end;
    let mut points: Vec<(f64, f64)> = Vec::new();
    for i in 0.. {
        let steps = (COARSE as f64 * 2.0_f64.powf(0.5 * f64::from(i))).round() as usize;
        if steps > FINE || (facts.order <= 2 && steps > FINE / 4) {
            break;
        }
        // A step that is too long for an implicit method to be solved says nothing of its order.
        let Ok(found) = path(stepper, start, (end, steps)) else { continue };
        let error = distance(&found, &truth, &problem.sizes);
        if error < range.start {
            break;
        }
        if error < range.end {
            points.push((1.0 / steps as f64, error));
        }
    }
    // More of them would reach back to steps that are too long for a slope.
    let last = &points[points.len().saturating_sub(3)..];
    if last.len() < 3 {
        return (Verdict::not_judged(format!("{}: too few errors in the range", facts.name)), None);
    }
    let slopes = (loglog_slope(last), loglog_slope(&last[..2]), loglog_slope(&last[1..]));
    let (Some(slope), Some(first), Some(second)) = slopes else {
        return (Verdict::not_judged("no slope"), None);
    };
    let missing = (f64::from(facts.order) - slope).max(0.0);
    if missing > BAND && (first - second).abs() > POWER {
        let why = format!("{}: the errors follow no power yet", facts.name);
        return (Verdict::not_judged(why), None);
    }
    let what = format!("{}: slope {slope:.2} of {last:?} over {end}", facts.name);
    (Verdict::of(missing, BAND, &what), truth.last().cloned())
}
