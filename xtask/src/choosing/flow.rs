//! A smooth motion at many moments, by one method and confirmed by another.
//!
//! The first is Dormand and Prince's pair of order 8 with its dense output, the second the trials' own
//! extrapolation of the midpoint rule, which shares no formula with anything that is judged.

use std::ops::ControlFlow;

use stationary_integrators::{
    DormandPrince853, FunctionField, Moment, StepControl, Tolerance, integrate,
};
use stationary_trials::kinds::integrators::reference::{Extrapolation, Slope, follow};

use super::truth::Known;

/// Both are held to this.
const TOLERANCE: f64 = 1e-13;
/// Steps after which the first gives up.
const MOST_STEPS: u64 = 1_000_000;
/// Moments at which the second looks.
const CONFIRMED: usize = 24;

/// What is observed of a flow from `start`, whose components are of these sizes, at ascending times;
/// and by how much the two methods differ in it.
pub fn observed(
    slope: Slope,
    start: Vec<f64>,
    sizes: &[f64],
    times: &[f64],
    observe: &dyn Fn(&[f64]) -> Vec<f64>,
) -> Result<Known, String> {
    let first = dense(&slope, start.clone(), sizes, times)?;
    let every = times.len().div_ceil(CONFIRMED).max(1);
    let picked: Vec<usize> =
        (0..times.len()).filter(|k| k % every == every - 1 || k + 1 == times.len()).collect();
    let moments: Vec<f64> = picked.iter().map(|&k| times[k]).collect();
    let rule = Extrapolation::Midpoint;
    let second = follow(&slope, rule, (&(0.0, start), sizes), &moments, TOLERANCE)
        .ok_or("the second method does not get there")?;
    let values: Vec<Vec<f64>> = first.iter().map(|y| observe(y)).collect();
    let apart = picked.iter().zip(&second.states).map(|(&k, y)| {
        let other = observe(y);
        other.iter().zip(&values[k]).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    });
    let uncertain = apart.fold(0.0, |a: f64, b| if b > a || b.is_nan() { b } else { a });
    Ok(Known { values, uncertain })
}

fn dense(
    slope: &Slope,
    start: Vec<f64>,
    sizes: &[f64],
    times: &[f64],
) -> Result<Vec<Vec<f64>>, String> {
    let failed = |error: &dyn std::fmt::Display| error.to_string();
    let n = start.len();
    let field = FunctionField::new(n, |t, y: &[f64], f: &mut [f64]| slope(t, y, f));
    let absolute = sizes.iter().map(|size| TOLERANCE * size).collect();
    let tolerance = Tolerance::componentwise(TOLERANCE, absolute).map_err(|e| failed(&e))?;
    let control = StepControl::from(tolerance).most_steps(MOST_STEPS).map_err(|e| failed(&e))?;
    let at_start = start.clone();
    let mut method =
        DormandPrince853::new(&field, control, Moment::new(0.0, start)).map_err(|e| failed(&e))?;
    let Some(&end) = times.last() else { return Ok(Vec::new()) };
    let mut states = Vec::with_capacity(times.len());
    while states.len() < times.len() && times[states.len()] <= 0.0 {
        states.push(at_start.clone());
    }
    let mut wrong = None;
    integrate(&mut method, end, |mut step| {
        while states.len() < times.len() && times[states.len()] <= step.to() {
            let mut y = vec![0.0; n];
            if let Err(error) = step.interpolate(times[states.len()], &mut y) {
                wrong = Some(error.to_string());
                return ControlFlow::Break(());
            }
            states.push(y);
        }
        ControlFlow::Continue(())
    })
    .map_err(|e| failed(&e))?;
    match wrong {
        Some(error) => Err(error),
        None if states.len() < times.len() => Err("the first method ends early".to_owned()),
        None => Ok(states),
    }
}
