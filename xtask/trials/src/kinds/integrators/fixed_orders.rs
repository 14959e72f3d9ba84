//! Does the error of a fixed-step method fall with the power of the step that it claims?
//!
//! ```text
//! error(h) ~ C h^k,      error the largest at sixteen times along the way
//! ```

use std::rc::Rc;

use nalgebra::DMatrix;
use stationary_calculus::{BilinearForm, Covector, DiagonalMetric, System, loglog_slope};
use stationary_integrators::{Filter, Gautschi, Imex, Integrator, Method, State, StepError};

use super::problem::InitialValue;
use super::runs::Forces;
use super::{encounters, smooth};
use crate::{Draw, Verdict};

/// Times at which the error is looked at.
const TIMES: usize = 16;
/// Errors above are as large as the motion, errors below are rounding.
const ASYMPTOTIC: std::ops::Range<f64> = 1e-10..1e-3;
/// The same for methods of order 1, whose errors are never small.
const ASYMPTOTIC_OF_ORDER_1: std::ops::Range<f64> = 1e-10..1e-2;
/// The slope may be this much below the order.
const BAND: f64 = 0.4;

type Mass = DiagonalMetric<Vec<f64>>;

/// Draws a method and a system, and judges the slope.
pub fn trial(draw: &mut Draw) -> Verdict {
    if draw.chance(0.15) {
        return split(draw);
    }
    let method = draw.one_of(Method::ALL);
    let mut problem = match draw.below(3) {
        0 => smooth::oscillators(draw),
        1 => smooth::stiffening_chain(draw),
        _ => {
            let rest = draw.uniform(0.5, 1.0);
            encounters::orbit_of(draw, rest)
        }
    };
    if problem.dim() < 4 || problem.truth.is_none() {
        problem.end = problem.end.min(2.0);
    }
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
    let (slope, derivative) = super::problem::mechanics(
        soft.masses.clone().expect("mechanics"),
        move |q, dv| {
            dv.copy_from_slice((&force * nalgebra::DVector::from_column_slice(q)).as_slice());
        },
        move |_, h| h.copy_from_slice(hessian.as_slice()),
    );
    InitialValue {
        name: "linear part",
        slope,
        derivative,
        start: soft.start.clone(),
        end: soft.end,
        sizes: soft.sizes.clone(),
        truth: None,
        stiff: false,
        masses: soft.masses.clone(),
        energy: Some(smooth::quadratic(&energy)),
    }
}

/// The largest error in this many steps between two of the times, in parts of the motion's size.
fn error(
    stepper: &mut dyn Integrator<Vec<f64>>,
    problem: &InitialValue,
    truth: &[Vec<f64>],
    steps: usize,
) -> Result<f64, StepError> {
    let n = problem.dim() / 2;
    let (q, p) = problem.start.split_at(n);
    let mut state = State::new(q.to_vec(), Covector(p.to_vec()));
    let h = problem.end / (TIMES * steps) as f64;
    let mut worst = 0.0_f64;
    for truth in truth {
        for _ in 0..steps {
            stepper.step(&mut state, h)?;
        }
        let found = state.q.iter().chain(state.p.components());
        let terms = found.zip(truth).zip(&problem.sizes);
        worst = terms.map(|((a, b), size)| (a - b).abs() / size).fold(worst, f64::max);
    }
    Ok(worst)
}

fn judge(stepper: &mut dyn Integrator<Vec<f64>>, problem: &InitialValue) -> Verdict {
    let facts = stepper.facts();
    let times: Vec<f64> = (1..=TIMES).map(|i| problem.end * i as f64 / TIMES as f64).collect();
    let truth = match &problem.truth {
        Some(at) => times.iter().map(|&t| at(t)).collect(),
        None => match problem.reference(&problem.begin(), &times, 1e-13) {
            Some(found) => found.states,
            None => return Verdict::not_judged("the reference does not reach the end"),
        },
    };
    let range = if facts.order == 1 { ASYMPTOTIC_OF_ORDER_1 } else { ASYMPTOTIC };
    let mut points: Vec<(f64, f64)> = Vec::new();
    for i in 0..24 {
        let steps = 2.0_f64.powf(0.5 * f64::from(i)).round() as usize;
        if steps > 2048 || (facts.order > 1 && steps > 512) {
            break;
        }
        if points.iter().any(|&(h, _)| h == 1.0 / steps as f64) {
            continue;
        }
        // A step that is too long for an implicit method to be solved says nothing of its order.
        let Ok(error) = error(stepper, problem, &truth, steps) else { continue };
        if error < range.start {
            break;
        }
        if error < range.end {
            points.push((1.0 / steps as f64, error));
        }
    }
    let last = &points[points.len().saturating_sub(4)..];
    let falls = |points: &[(f64, f64)]| points[0].1 > 1e3 * points[points.len() - 1].1;
    if last.len() < 2 || (last.len() < 3 && !falls(last)) {
        return Verdict::not_judged(format!("{}: too few errors in the range", facts.name));
    }
    let Some(slope) = loglog_slope(last) else {
        return Verdict::not_judged("no slope");
    };
    let what = format!("{}: slope {slope:.2} of {last:?}", facts.name);
    Verdict::of((f64::from(facts.order) - slope).max(0.0), BAND, &what)
}
