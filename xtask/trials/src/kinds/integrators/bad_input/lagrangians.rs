//! Lagrangians, their actions and the paths on which these are stationary.

use stationary_calculus::{Covector, Energy, Number, Vector};
use stationary_integrators::{
    Action, EulerLagrange, Integrator, Mechanical, Quadrature, Sampled, State, Variational,
};

use super::{judge, number, positive};
use crate::{Draw, Verdict};

/// `V = x^4 - x y`.
#[derive(Clone, Copy, Debug)]
struct Well;

impl Energy<2> for Well {
    fn energy<R: Number>(&self, [x, y]: [R; 2]) -> R {
        x.powi(4) - x * y
    }
}

pub(super) fn lagrangians(draw: &mut Draw) -> Verdict {
    let mass = [positive(draw), positive(draw)];
    let pair = |draw: &mut Draw| [number(draw), number(draw)];
    let (q, v) = (pair(draw), pair(draw));
    let h = positive(draw);
    let path: Vec<[f64; 2]> = (0..draw.below(5)).map(|_| pair(draw)).collect();
    let steps: Vec<f64> = (0..draw.below(4)).map(|_| positive(draw)).collect();
    draw.note(format!("masses {mass:?}, {q:?}, {v:?}, step {h}, path {path:?}, steps {steps:?}"));
    let Ok(lagrangian) = Mechanical::new(mass, Well) else { return Verdict::due() };
    let mut equations = EulerLagrange::new(lagrangian);
    let a = judge("acceleration", equations.acceleration(q, Vector(v)).map(|a| a.0.to_vec()));
    let b = judge("velocity", equations.velocity(q, Covector(v)).map(|v| v.0.to_vec()));
    let quadrature = draw.one_of(&Quadrature::ALL);
    let sampled = Sampled { lagrangian, quadrature };
    let mut now = State::new(q, Covector(v));
    let c = match Variational::new(sampled) {
        Err(_) => Verdict::due(),
        Ok(mut variational) => {
            let answer = variational.step(&mut now, h);
            judge("variational", answer.map(|_| now.q.iter().chain(&now.p.0).copied().collect()))
        }
    };
    let d = match Action::new(sampled, steps) {
        Err(_) => Verdict::due(),
        Ok(action) => {
            let _ = (action.of(&path), action.differential(&path));
            let answer = action.stationary_path(path);
            judge("a stationary path", answer.map(|path| path.path.concat()))
        }
    };
    a.and(b).and(c).and(d)
}
