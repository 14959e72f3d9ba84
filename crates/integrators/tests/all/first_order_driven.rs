//! Radau where parts are stiff, or algebraic, and driven.

use std::ops::ControlFlow;

use stationary_integrators::{
    AdaptiveMethod, FunctionField, Jacobian, Moment, RadauIia5, Tolerance, VectorField, integrate,
};

/// Before the estimate was counted three times the largest were 38 to 52 tolerances.
#[test]
fn radau_ends_steps_of_a_driven_stiff_part_within_twenty_tolerances() {
    for rate in [300.0, 1e3, 1e4] {
        let field = FunctionField::new(1, move |t: f64, y: &[f64], f: &mut [f64]| {
            let (sin, cos) = (2.0 * t).sin_cos();
            f[0] = -rate * (y[0] - 2.0 - cos) - 2.0 * sin;
        });
        let tolerance = 1e-8;
        let control = Tolerance::new(tolerance, tolerance).unwrap().into();
        let mut radau = RadauIia5::new(&field, control, Moment::new(0.0, [3.0])).unwrap();
        let mut worst = 0.0_f64;
        integrate(&mut radau, 10.0, |step| {
            let exact = 2.0 + (2.0 * step.to()).cos();
            let off = (step.moment().y[0] - exact).abs() / (tolerance * (1.0 + exact));
            worst = worst.max(off);
            ControlFlow::Continue(())
        })
        .unwrap();
        assert!(worst < 25.0, "rate {rate:e}: {worst}");
    }
}

/// `0 = x + x^2/5 - sin 3t`: no error bounds the step, as each end is right.
struct Algebraic;

impl VectorField for Algebraic {
    fn dim(&self) -> usize {
        1
    }
    fn evaluate(&self, t: f64, y: &[f64], f: &mut [f64]) {
        f[0] = y[0] + 0.2 * y[0] * y[0] - (3.0 * t).sin();
    }
    fn mass(&self) -> Option<&[f64]> {
        Some(&[0.0])
    }
    fn jacobian(&self, _t: f64, y: &[f64], jacobian: &mut [f64]) -> Jacobian {
        jacobian[0] = 1.0 + 0.4 * y[0];
        Jacobian::Written
    }
}

#[test]
fn between_steps_of_radau_an_algebraic_equation_holds_to_the_tolerance() {
    let tolerance = 1e-8;
    let control = Tolerance::new(tolerance, tolerance).unwrap().into();
    let mut radau = RadauIia5::new(&Algebraic, control, Moment::new(0.0, [0.0])).unwrap();
    let mut worst = 0.0_f64;
    while radau.moment().t < 6.0 {
        let from = radau.moment().t;
        radau.step(6.0).unwrap();
        for part in 1..20 {
            let t = from + 0.05 * f64::from(part) * (radau.moment().t - from);
            let mut y = [0.0];
            radau.interpolate(t, &mut y).unwrap();
            let exact = 2.5 * ((1.0 + 0.8 * (3.0 * t).sin()).sqrt() - 1.0);
            worst = worst.max((y[0] - exact).abs() / (tolerance * (1.0 + exact.abs())));
        }
    }
    assert!(worst < 10.0, "{worst:e} tolerances");
}
