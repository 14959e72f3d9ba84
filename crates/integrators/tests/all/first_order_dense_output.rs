//! What a run is between its steps.

use std::ops::ControlFlow;

use stationary_integrators::{
    AdaptiveMethod, DormandPrince853, FunctionField, Moment, RadauIia5, Tolerance, VectorField,
    integrate,
};

use crate::first_order_methods::control;

/// The largest error within a step that starts right, in tolerances: at nine places of each.
fn worst_within<const N: usize>(
    field: &impl VectorField,
    [relative, absolute]: [f64; 2],
    start: [f64; N],
    end: f64,
) -> f64 {
    let control = |relative: f64, absolute: f64| Tolerance::new(relative, absolute).unwrap().into();
    let (start, usual) = (Moment::new(0.0, start), control(relative, absolute));
    let mut method = DormandPrince853::new(field, usual, start).unwrap();
    let mut worst = 0.0_f64;
    while method.moment().t < end {
        let begin = method.moment().clone();
        method.step(end).unwrap();
        for part in 1..10 {
            let t = begin.t + 0.1 * f64::from(part) * (method.moment().t - begin.t);
            let mut y = [0.0; N];
            method.interpolate(t, &mut y).unwrap();
            let mut fine =
                DormandPrince853::new(field, control(1e-12, 1e-15), begin.clone()).unwrap();
            integrate(&mut fine, t, |_| ControlFlow::Continue(())).unwrap();
            for (y, exact) in y.iter().zip(fine.moment().y) {
                worst = worst.max((y - exact).abs() / (absolute + relative * exact.abs()));
            }
        }
    }
    worst
}

#[test]
fn no_step_of_dormand_prince_is_off_by_many_tolerances_within_it() {
    // At t = 0.8 the estimate of order 5 is near zero by chance, on a step three times too long.
    let [s, r, b] = [11.064_717, 10.964_275, 1.867_876];
    let lorenz = FunctionField::new(3, |_, y: &[f64], f: &mut [f64]| {
        f[0] = s * (y[1] - y[0]);
        f[1] = r * y[0] - y[1] - y[0] * y[2];
        f[2] = y[0] * y[1] - b * y[2];
    });
    let start = [9.311_543, -6.948_107, 21.549_059];
    assert!(worst_within(&lorenz, [1.703_417e-5, 1e-9], start, 2.3) < 50.0);
}

#[test]
fn a_long_step_whose_ends_are_right_by_luck_is_taken_by_halves_where_it_is_asked_for() {
    // Of two days without predators the end is right to three tolerances, the polynomial to 230.
    let [a, b, c, d] = [0.3, 2.836_208_6, 0.337_728_07, 0.548_022_97];
    let predators = FunctionField::new(2, |_, y: &[f64], f: &mut [f64]| {
        f[0] = a * y[0] - b * y[0] * y[1];
        f[1] = -c * y[1] + d * y[0] * y[1];
    });
    let start = [2.498_952_02, 4.539_871_26];
    assert!(worst_within(&predators, [3.548_148_8e-7, 8.9e-7], start, 9.0) < 10.0);
    // Whichever half is asked for first.
    let tolerance = Tolerance::new(3.548_148_8e-7, 8.9e-7).unwrap();
    let mut method =
        DormandPrince853::new(&predators, tolerance.into(), Moment::new(0.0, start)).unwrap();
    while method.moment().t < 9.0 {
        let begin = method.moment().t;
        method.step(9.0).unwrap();
        let at = |part: f64| begin + part * (method.moment().t - begin);
        let times = [0.2, 0.8, 0.2, 0.6].map(at);
        let [early, late, again, _] = times.map(|t| {
            let mut y = [0.0; 2];
            method.interpolate(t, &mut y).unwrap();
            y
        });
        assert_eq!(early, again);
        assert!(late.iter().all(|y| y.is_finite()));
    }
}

#[test]
fn radau_follows_a_stiff_part_between_its_steps_too() {
    for rate in [1e3, 1e5, 1e7] {
        let field = FunctionField::new(1, move |t: f64, y: &[f64], f: &mut [f64]| {
            let (sin, cos) = (5.0 * t).sin_cos();
            f[0] = -rate * (y[0] - cos) - 5.0 * sin;
        });
        let mut radau = RadauIia5::new(&field, control(1e-6), Moment::new(0.0, [1.0])).unwrap();
        let mut worst = 0.0_f64;
        integrate(&mut radau, 3.0, |mut step| {
            for part in 1..10 {
                let t = step.from() + 0.1 * f64::from(part) * (step.to() - step.from());
                let mut y = [0.0];
                step.interpolate(t, &mut y).unwrap();
                worst = worst.max((y[0] - (5.0 * t).cos()).abs());
            }
            ControlFlow::Continue(())
        })
        .unwrap();
        assert!(worst < 1e-4, "rate {rate:e}: {worst:e}");
    }
}
