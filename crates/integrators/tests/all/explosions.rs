//! What begins below the tolerance and grows, which no estimate of an error sees.

use std::ops::ControlFlow;

use stationary_integrators::{
    AdaptiveError, AdaptiveMethod, BackwardDifferences, Jacobian, Moment, RadauIia5, StepControl,
    Tolerance, VectorField, integrate,
};

/// Decay that starts an explosion: `a' = -k a - K a b`, `b' = k a + K a b`, b from 0 to 1.
struct Explosion {
    jacobian: Jacobian,
    mass: Option<[f64; 9]>,
}

const SLOW: f64 = 2e-3;
const FAST: f64 = 7e3;

impl VectorField for Explosion {
    fn dim(&self) -> usize {
        3
    }

    /// The third equation is c' = -c, or, where its row of M is zero, 0 = a + b - c.
    fn evaluate(&self, _t: f64, y: &[f64], f: &mut [f64]) {
        let speed = SLOW * y[0] + FAST * y[0] * y[1];
        let sign = self.mass.map_or(1.0, |mass| mass[0]);
        f[0] = -sign * speed;
        f[1] = speed;
        f[2] = match self.mass {
            Some(_) => y[0] + y[1] - y[2],
            None => -y[2],
        };
    }

    fn jacobian(&self, _t: f64, y: &[f64], df: &mut [f64]) -> Jacobian {
        let sign = self.mass.map_or(1.0, |mass| mass[0]);
        let (by_a, by_b) = (SLOW + FAST * y[1], FAST * y[0]);
        let last = if self.mass.is_some() { [1.0, 1.0] } else { [0.0, 0.0] };
        let (a, b) = ([-sign * by_a, by_a, last[0]], [-sign * by_b, by_b, last[1]]);
        df.copy_from_slice(&[a, b, [0.0, 0.0, -1.0]].concat());
        self.jacobian
    }

    fn mass(&self) -> Option<&[f64]> {
        self.mass.as_ref().map(|mass| &mass[..])
    }
}

fn burnt(method: Result<impl AdaptiveMethod<[f64; 3]>, AdaptiveError>) -> f64 {
    let mut method = method.unwrap();
    // It takes ln(FAST / SLOW) / FAST = 2e-3 s to explode.
    integrate(&mut method, 0.1, |_| ControlFlow::Continue(())).unwrap();
    method.moment().y[1]
}

#[test]
fn an_explosion_from_below_the_tolerance_is_not_stepped_over() {
    let masses = [None, Some(1.0), Some(-1.0)]
        .map(|sign| sign.map(|sign| [sign, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]));
    for (mass, jacobian) in
        masses.into_iter().flat_map(|mass| [(mass, Jacobian::Written), (mass, Jacobian::Unknown)])
    {
        let field = Explosion { jacobian, mass };
        let third = if mass.is_some() { 1.0 } else { 0.5 };
        let start = Moment::new(0.0, [1.0, 0.0, third]);
        for tolerance in [1e-2, 1e-3, 1e-4] {
            let control = StepControl::from(Tolerance::new(tolerance, tolerance).unwrap());
            let of = |highest: usize| {
                let control = control.clone();
                BackwardDifferences::of_order_at_most(highest, &field, control, start.clone())
            };
            let radau = RadauIia5::new(&field, control.clone(), start.clone());
            for b in [burnt(radau), burnt(of(1)), burnt(of(2)), burnt(of(5))] {
                assert!((b - 1.0).abs() < 0.1, "{mass:?} {jacobian:?} at {tolerance}: {b}");
            }
        }
    }
}
