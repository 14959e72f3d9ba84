//! First-order systems of any size, with any mass matrix, and any method on them.

use stationary_integrators::{
    AdaptiveError, AdaptiveMethod, BackwardDifferences, ControlError, DormandPrince853, Moment,
    RadauIia5, StepControl, Tolerance, VectorField,
};

use super::{length, numbers, positive};
use crate::Draw;

/// A field of any size with a mass matrix of any size.
pub(super) struct AnyField {
    pub(super) n: usize,
    pub(super) bad: Option<f64>,
    pub(super) mass: Option<Vec<f64>>,
}

impl VectorField for AnyField {
    fn dim(&self) -> usize {
        self.n
    }

    fn evaluate(&self, t: f64, y: &[f64], f: &mut [f64]) {
        for (f, y) in f.iter_mut().zip(y) {
            *f = t.cos() - y + self.bad.unwrap_or(0.0);
        }
    }

    fn mass(&self) -> Option<&[f64]> {
        self.mass.as_deref()
    }
}

pub(super) fn field(draw: &mut Draw) -> AnyField {
    let n = draw.below(4);
    let bad = draw.chance(0.2).then(|| draw.any_f64());
    let mass = draw.chance(0.3).then(|| {
        let count = length(draw, n * n);
        numbers(draw, count)
    });
    AnyField { n, bad, mass }
}

pub(super) fn control(draw: &mut Draw, n: usize) -> Result<StepControl, ControlError> {
    let relative = if draw.chance(0.1) { draw.any_f64() } else { draw.log_uniform(1e-2, 1e-12) };
    let tolerance = match draw.chance(0.5) {
        true => Tolerance::new(relative, if draw.chance(0.2) { draw.any_f64() } else { 1e-3 }),
        false => {
            let n = length(draw, n);
            Tolerance::componentwise(relative, (0..n).map(|_| draw.unit() + 1e-9).collect())
        }
    }?;
    let mut control = StepControl::from(tolerance).most_steps(2000)?;
    if draw.chance(0.1) {
        control = control.first_step(positive(draw))?;
    }
    if draw.chance(0.1) {
        control = control.longest_step(positive(draw))?;
    }
    if draw.chance(0.1) {
        control = control.constant_step(positive(draw))?;
    }
    Ok(control)
}

pub(super) type Boxed<'f> = Box<dyn AdaptiveMethod<Vec<f64>> + 'f>;

pub(super) fn any_method<'f>(
    draw: &mut Draw,
    field: &'f AnyField,
    control: StepControl,
    start: Moment<Vec<f64>>,
) -> Result<Boxed<'f>, AdaptiveError> {
    Ok(match draw.below(3) {
        0 => Box::new(DormandPrince853::new(field, control, start)?),
        1 => Box::new(RadauIia5::new(field, control, start)?),
        _ => {
            let highest = draw.below(8);
            Box::new(BackwardDifferences::of_order_at_most(highest, field, control, start)?)
        }
    })
}

pub(super) fn of_moment(method: &dyn AdaptiveMethod<Vec<f64>>) -> Vec<f64> {
    let Moment { t, y } = method.moment();
    y.iter().copied().chain([*t]).collect()
}
