//! Trigonometric methods with their filters.

use nalgebra::DMatrix;
use stationary_calculus::BilinearForm;
use stationary_integrators::{Filter, Gautschi, Integrator};

use super::{judge, length, number, planet, positive, state};
use crate::{Draw, Verdict};

pub(super) fn split(draw: &mut Draw) -> Verdict {
    let system = planet();
    let (rows, columns) = (length(draw, 2), length(draw, 2));
    let mut stiffness = DMatrix::from_fn(rows, columns, |_, _| number(draw));
    if rows == columns && draw.chance(0.7) {
        stiffness = &stiffness * stiffness.transpose();
    }
    let filter = draw.one_of(&[Filter::Impulse, Filter::Mollified, Filter::Gautschi]);
    let (mut now, h) = (state(draw, 2), positive(draw));
    draw.note(format!("{filter:?} {stiffness} {now:?} step {h}"));
    let answer = Gautschi::<_, _, Vec<f64>>::new(&system, &BilinearForm(stiffness), filter);
    let Ok(mut gautschi) = answer else { return Verdict::due() };
    let answer = gautschi.step(&mut now, h);
    judge("gautschi", answer.map(|_| now.q.iter().chain(now.p.components()).copied().collect()))
}
