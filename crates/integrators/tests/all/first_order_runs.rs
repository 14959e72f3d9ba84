//! Runs of first-order systems: their problems' answers, saving, and bad input.

use std::ops::ControlFlow;

use nalgebra::DMatrix;
use stationary_calculus::{Covector, check_jacobian};
use stationary_calculus::{DiagonalMetric, Force, Sink, System, Vector, assert_jacobian};
use stationary_integrators::problems::{
    StiffProblem, constrained_robertson, hires, robertson, spring_pendulum, van_der_pol,
};
use stationary_integrators::{
    AdaptiveError, AdaptiveMethod, BackwardDifferences, ControlError, DormandPrince853,
    FunctionField, Jacobian, MechanicalField, Moment, Outcome, OutputTimes, RadauIia5, StepControl,
    Tolerance, VectorField, integrate,
};

use crate::first_order_methods::{all, control};

/// The error of both stiff methods at the end of a problem, each at its own tolerance.
fn stiff_errors<F: VectorField, const N: usize>(
    problem: &StiffProblem<F, N>,
    [radau, bdf]: [f64; 2],
) -> [f64; 2] {
    let control = |relative: f64| {
        let absolute = problem.scale.iter().map(|scale| relative * scale).collect();
        StepControl::from(Tolerance::componentwise(relative, absolute).unwrap())
    };
    let start = || problem.initial.clone();
    let mut radau = RadauIia5::new(&problem.field, control(radau), start()).unwrap();
    let mut bdf = BackwardDifferences::new(&problem.field, control(bdf), start()).unwrap();
    integrate(&mut radau, problem.end, |_| ControlFlow::Continue(())).unwrap();
    integrate(&mut bdf, problem.end, |_| ControlFlow::Continue(())).unwrap();
    [radau.moment(), bdf.moment()].map(|moment| problem.error(&moment.y).unwrap())
}

#[test]
fn two_methods_confirm_the_published_answers() {
    fn confirmed<F: VectorField, const N: usize>(problem: StiffProblem<F, N>) {
        let [radau, bdf] = stiff_errors(&problem, [1e-12, 1e-12]);
        assert!(radau < problem.solution_error, "{}: radau {radau:e}", problem.name);
        assert!(bdf < 1e-9, "{}: bdf {bdf:e}", problem.name);
    }
    confirmed(van_der_pol(1000.0).unwrap());
    confirmed(hires());
    confirmed(robertson());
}

#[test]
fn a_constraint_of_index_one_is_kept_and_changes_no_answer() {
    let problem = constrained_robertson();
    for error in stiff_errors(&problem, [1e-8, 1e-10]) {
        assert!(error < 1e-7, "{error:e}");
    }
    let absolute = problem.scale.iter().map(|scale| 1e-6 * scale).collect();
    let control = Tolerance::componentwise(1e-6, absolute).unwrap().into();
    let mut radau = RadauIia5::new(&problem.field, control, problem.initial.clone()).unwrap();
    integrate(&mut radau, problem.end, |step| {
        let sum: f64 = step.moment().y.iter().sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sum} at t = {}", step.to());
        ControlFlow::Continue(())
    })
    .unwrap();
}

fn value(field: &impl VectorField) -> impl Fn(&[f64]) -> Vec<f64> {
    |y| {
        let mut f = vec![f64::NAN; y.len()];
        field.evaluate(0.0, y, &mut f);
        f
    }
}

fn derivative(field: &impl VectorField) -> impl Fn(&[f64]) -> DMatrix<f64> {
    |y| {
        let mut df = DMatrix::from_element(y.len(), y.len(), f64::NAN);
        assert_eq!(field.jacobian(0.0, y, df.as_mut_slice()), Jacobian::Written);
        df
    }
}

#[test]
fn jacobians_of_the_problems_are_derivatives_of_their_fields() {
    fn checked<F: VectorField, const N: usize>(problem: &StiffProblem<F, N>, y: [f64; N]) {
        let (f, df) = (value(&problem.field), derivative(&problem.field));
        assert_jacobian(f, df, &y);
    }
    checked(&van_der_pol(5.0).unwrap(), [1.3, -0.4]);
    checked(&hires(), [0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2]);
    // Scaled so that differences can be taken: b as large as a.
    checked(&robertson(), [0.3, 0.2, 0.5]);
    checked(&constrained_robertson(), [0.3, 0.2, 0.5]);
}

#[test]
fn differences_serve_where_the_jacobian_is_not_known() {
    let problem = robertson();
    let bare = FunctionField::new(3, |t, y: &[f64], f: &mut [f64]| problem.field.evaluate(t, y, f));
    let absolute = problem.scale.iter().map(|scale| 1e-6 * scale).collect();
    let control: StepControl = Tolerance::componentwise(1e-6, absolute).unwrap().into();
    fn run<F: VectorField>(field: F, control: &StepControl, end: f64) -> (u64, [f64; 3]) {
        let start = Moment::new(0.0, [1.0, 0.0, 0.0]);
        let mut radau = RadauIia5::new(field, control.clone(), start).unwrap();
        integrate(&mut radau, end, |_| ControlFlow::Continue(())).unwrap();
        (radau.work().steps, radau.moment().y)
    }
    let known = run(problem.field, &control, problem.end);
    let differences = run(&bare, &control, problem.end);
    assert!(differences.0 < known.0 + known.0 / 10, "{differences:?} against {known:?}");
    for run in [known, differences] {
        assert!(problem.error(&run.1).unwrap() < 1e-6);
    }
}

/// Drag in proportion to velocity, with a coefficient for each freedom.
struct Drag([f64; 2]);

impl Force for Drag {
    fn dim(&self) -> usize {
        2
    }

    fn add_force(&self, _t: f64, _q: &[f64], v: Vector<&[f64]>, f: Covector<&mut [f64]>) {
        for ((f, v), c) in f.0.iter_mut().zip(v.0).zip(self.0) {
            *f -= c * v;
        }
    }

    fn add_damping(&self, _t: f64, _q: &[f64], _v: Vector<&[f64]>, damping: &mut impl Sink) {
        damping.add_symmetric(&[0, 1], &[self.0[0], 0.0, 0.0, self.0[1]]);
    }
}

#[test]
fn a_mechanical_field_knows_its_jacobian() {
    let problem = spring_pendulum(50.0).unwrap();
    let metric = DiagonalMetric::new([2.0, 3.0]).unwrap();
    let system = System::new(metric, problem.system.potential()).unwrap();
    let field = MechanicalField::forced(&system, Drag([0.7, 0.2])).unwrap();
    let y = [0.6, -0.9, 0.3, 0.5];
    assert_jacobian(value(&field), derivative(&field), &y);
    let unforced = MechanicalField::new(&system);
    assert!(check_jacobian(value(&field), derivative(&unforced), &y).is_err());
}

#[test]
fn a_saved_run_goes_on_to_the_same_bits() {
    let problem = van_der_pol(100.0).unwrap();
    for place in 0..4 {
        for cut in [1, 7, 150] {
            let fresh = || {
                let methods = all(&problem.field, &control(1e-6), &problem.initial);
                methods.into_iter().nth(place).unwrap()
            };
            let mut whole = fresh();
            let mut steps = 0;
            let outcome = integrate(&mut *whole, 200.0, |_| {
                steps += 1;
                if steps == cut { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            assert_eq!(outcome, Ok(Outcome::BrokenOff));
            let saved = whole.save();
            let mut resumed = fresh();
            resumed.load(&saved).unwrap();
            assert_eq!(resumed.moment(), whole.moment());
            for method in [&mut whole, &mut resumed] {
                integrate(&mut **method, 200.0, |_| ControlFlow::Continue(())).unwrap();
            }
            let bits = |y: &[f64; 2]| y.map(f64::to_bits);
            assert_eq!(bits(&resumed.moment().y), bits(&whole.moment().y), "{}", saved.method);
            assert_eq!(resumed.work(), whole.work());
        }
    }
}

#[test]
fn what_was_not_saved_by_the_method_is_refused_and_changes_nothing() {
    let problem = van_der_pol(10.0).unwrap();
    let [mut dop, mut radau, mut bdf, mut low] =
        all(&problem.field, &control(1e-6), &problem.initial);
    let foreign = radau.save();
    for method in [&mut dop, &mut bdf, &mut low] {
        assert!(matches!(method.load(&foreign), Err(AdaptiveError::Saved(_))));
    }
    for method in [&mut dop, &mut radau, &mut bdf, &mut low] {
        method.step(1.0).unwrap();
        let before = method.save();
        for place in 0..before.numbers.len() {
            for bad in [f64::NAN, f64::INFINITY] {
                let mut broken = before.clone();
                broken.numbers[place] = bad;
                let error = method.load(&broken).unwrap_err();
                assert!(
                    matches!(error, AdaptiveError::SavedNumber { slot, .. } if slot == place),
                    "{}: {error}",
                    before.method
                );
                assert_eq!(method.save(), before);
            }
        }
        let mut short = before.clone();
        short.numbers.pop();
        assert!(matches!(method.load(&short), Err(AdaptiveError::Saved(_))));
    }
    // Half a step, and fewer than none, were never counted.
    for count in [0.5, -1.0] {
        let mut broken = dop.save();
        let last = broken.numbers.len() - 1;
        broken.numbers[last] = count;
        assert!(matches!(dop.load(&broken), Err(AdaptiveError::SavedNumber { .. })));
    }
    // More than can be counted: the next one would be none.
    for mut method in [dop, radau, bdf, low] {
        let before = method.save();
        for place in before.numbers.len() - 7..before.numbers.len() {
            let mut broken = before.clone();
            broken.numbers[place] = 1e300;
            assert!(matches!(method.load(&broken), Err(AdaptiveError::SavedNumber { .. })));
            assert_eq!(method.save(), before);
        }
    }
}

#[test]
fn a_system_without_unknowns_reaches_its_end() {
    let nothing = FunctionField::new(0, |_t, _y: &[f64], _f: &mut [f64]| ());
    for mut method in all(&nothing, &control(1e-6), &Moment::new(0.0, Vec::new())) {
        integrate(&mut *method, 1.0, |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(method.moment().t, 1.0);
    }
}

/// Radau on HIRES, a tolerance for each fortieth part of a decade.
#[test]
fn radau_ends_no_run_of_hires_a_tenth_wrong_whatever_the_tolerance() {
    let problem = hires();
    let mut evaluations = 0;
    for i in 0..121 {
        let relative = 10_f64.powf(-2.0 - f64::from(i) / 40.0);
        let control = Tolerance::new(relative, 0.01 * relative).unwrap().into();
        let start = problem.initial.clone();
        let mut radau = RadauIia5::new(&problem.field, control, start).unwrap();
        integrate(&mut radau, problem.end, |_| ControlFlow::Continue(())).unwrap();
        evaluations += radau.work().evaluations;
        let truth = problem.solution.unwrap();
        for (y, truth) in radau.moment().y.iter().zip(truth) {
            assert!((y / truth - 1.0).abs() < 0.1, "{relative:e}: {y:e} for {truth:e}");
        }
    }
    // Without a second iterate, and loose tolerances as they are asked for, they were 44,797, of
    // which 26 runs were short and wrong.
    assert!(evaluations < 59_000, "{evaluations}");
}

/// y' = -rate (y - cos 5t) - 5 sin 5t: the slow motion between steps, where a polynomial of order 3
/// leaves it.
#[test]
fn radau_holds_a_stiff_part_that_is_driven_to_a_hundred_tolerances() {
    let [a, w, b] = [-0.210_543_824_387_653_5, 0.484_363_629_962_881_3, 0.162_628_202_506_376_43];
    let at = |t: f64| 1.0 + a * (w * t).sin() + b * (w * t).cos();
    let rate = 458.709_141_095_205_4;
    let driven = FunctionField::new(1, |t, y: &[f64], f: &mut [f64]| {
        let slope = w * (a * (w * t).cos() - b * (w * t).sin());
        f[0] = -rate * (y[0] - at(t)) + slope;
    });
    let (relative, absolute) = (1.223_447_109_428_041_2e-8, 4.551_113_571_776_856e-10);
    for end in [2.0, 3.0, 3.609_359_832_885_931] {
        let control = StepControl::from(Tolerance::new(relative, absolute).unwrap());
        let start = Moment::new(0.0, [at(0.0)]);
        let mut radau = RadauIia5::new(&driven, control, start).unwrap();
        integrate(&mut radau, end, |_| ControlFlow::Continue(())).unwrap();
        let off = (radau.moment().y[0] - at(end)).abs() / (absolute + relative * at(end).abs());
        assert!(off < 100.0, "{off} tolerances at t = {end}");
    }
}

#[test]
fn a_tolerance_of_zero_or_nan_is_refused() {
    for bad in [0.0, -1e-6, f64::NAN, 1.0, 1e-15] {
        assert!(matches!(Tolerance::new(bad, 1e-6), Err(ControlError::Relative(_))));
    }
    for bad in [0.0, -1e-6, f64::NAN, f64::INFINITY] {
        let error = Tolerance::componentwise(1e-6, vec![1e-6, bad]).unwrap_err();
        assert!(matches!(error, ControlError::Absolute { component: 1, .. }), "{error}");
        assert!(matches!(control(1e-6).first_step(bad), Err(ControlError::Step(_))));
        assert!(matches!(control(1e-6).longest_step(bad), Err(ControlError::Step(_))));
        assert!(matches!(control(1e-6).constant_step(bad), Err(ControlError::Step(_))));
    }
    assert_eq!(control(1e-6).most_steps(0), Err(ControlError::NoSteps));
}

#[test]
fn sizes_ends_and_starts_that_do_not_fit_are_named() {
    let field = FunctionField::new(2, |_t, y: &[f64], f: &mut [f64]| f.copy_from_slice(y));
    let start = Moment::new(0.0, [1.0, 2.0]);
    let three = Tolerance::componentwise(1e-6, vec![1e-6; 3]).unwrap();
    let error = RadauIia5::new(&field, three.into(), start.clone()).unwrap_err();
    assert!(matches!(error, AdaptiveError::Size(_)), "{error}");
    let wrong = Moment::new(0.0, vec![1.0; 3]);
    let error = BackwardDifferences::new(&field, control(1e-6), wrong).unwrap_err();
    assert!(matches!(error, AdaptiveError::Size(_)), "{error}");
    let error = BackwardDifferences::of_order_at_most(6, &field, control(1e-6), start.clone());
    assert!(matches!(error, Err(AdaptiveError::Order { got: 6, highest: 5 })));
    let bad = Moment::new(0.0, [1.0, f64::NAN]);
    let error = DormandPrince853::new(&field, control(1e-6), bad).unwrap_err();
    assert!(matches!(error, AdaptiveError::NonFinite { component: 1, .. }), "{error}");
    let mass = constrained_robertson();
    let error = DormandPrince853::new(&mass.field, control(1e-6), mass.initial).unwrap_err();
    assert_eq!(error, AdaptiveError::MassMatrix { method: "dormand-prince-853" });
    for mut method in all(&field, &control(1e-6), &start) {
        for end in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = method.step(end).unwrap_err();
            assert!(matches!(error, AdaptiveError::End { .. }), "{error}");
        }
        method.step(1.0).unwrap();
        let error = method.interpolate(1.5, &mut [0.0; 2]).unwrap_err();
        assert!(matches!(error, AdaptiveError::OutsideStep { .. }), "{error}");
    }
    for times in [[0.0, 0.0], [1.0, 0.5], [0.0, f64::NAN]] {
        let error = OutputTimes::<[f64; 2]>::new(2, &times).unwrap_err();
        assert!(matches!(error, AdaptiveError::OutputTimes { place: 1, .. }), "{error}");
    }
}

/// On a slope near overflow, with steps that are chosen and with steps taken whatever their error.
#[test]
fn what_is_written_between_steps_is_finite_or_refused() {
    let huge = FunctionField::new(1, |_t, _y: &[f64], f: &mut [f64]| f[0] = 1e308);
    let start = Moment::new(0.0, [1.0]);
    let whatever = control(1e-6).constant_step(0.1).unwrap();
    for control in [control(1e-6), whatever] {
        for mut method in all(&huge, &control, &start) {
            let (name, mut y) = (method.facts().name, [0.0]);
            method.interpolate(0.0, &mut y).unwrap();
            assert_eq!(y, [1.0], "{name}: the start is known");
            if method.step(0.1).is_err() {
                continue;
            }
            let (begin, end) = (method.last_begin().unwrap(), method.moment().t);
            for t in [begin, begin + 0.3 * (end - begin), end] {
                match method.interpolate(t, &mut y) {
                    Ok(()) => assert!(y[0].is_finite(), "{name}: {y:?} at {t}"),
                    Err(error) => {
                        assert!(matches!(error, AdaptiveError::NonFinite { .. }), "{error}");
                    }
                }
            }
        }
    }
}

/// DOP853 and Radau hold at most 1e-4, DOPRI5 1e-3, BDF a twentieth of at most 1e-3.
#[test]
fn a_loose_tolerance_is_held_as_a_tighter_one() {
    let field = FunctionField::new(2, |_t, y: &[f64], f: &mut [f64]| {
        f.copy_from_slice(&[-y[0] + 3.0 * y[1], -3.0 * y[0] - y[1]]);
    });
    let start = Moment::new(0.0, [1.0, 0.0]);
    let end = |mut method: Box<dyn AdaptiveMethod<[f64; 2]> + '_>| {
        integrate(&mut *method, 4.0, |_| ControlFlow::Continue(())).unwrap();
        method.moment().y
    };
    let [dormand_prince, radau, _, _] = all(&field, &control(1e-4), &start).map(end);
    let [_, _, differences, low] = all(&field, &control(1e-3), &start).map(end);
    for loose in [2e-3, 1e-2, 0.5] {
        let ends = all(&field, &control(loose), &start).map(end);
        for (end, held) in ends.iter().zip([dormand_prince, radau, differences, low]) {
            let apart = (end[0] - held[0]).abs().max((end[1] - held[1]).abs());
            assert!(apart < 1e-9, "{loose:e}: {end:?} {held:?}");
        }
    }
}

#[test]
fn a_step_that_shrinks_below_the_clock_is_an_error_with_the_last_good_moment() {
    // y' = y^2 from 1 runs off to infinity at t = 1.
    let field = FunctionField::new(1, |_t, y: &[f64], f: &mut [f64]| f[0] = y[0] * y[0]);
    let start = Moment::new(0.0, [1.0]);
    for mut method in all(&field, &control(1e-8), &start) {
        let error = integrate(&mut *method, 2.0, |_| ControlFlow::Continue(())).unwrap_err();
        let AdaptiveError::StepTooSmall { last, .. } = &error else { panic!("{error}") };
        let name = method.facts().name;
        assert!((last.t - 1.0).abs() < 1e-5, "{name}: {error}");
        assert!(last.y[0].is_finite() && last.y[0] > 1e5, "{name}: {error}");
        assert_eq!((method.moment().t, method.moment().y[0]), (last.t, last.y[0]));
    }
}

#[test]
fn a_field_that_is_nowhere_finite_ends_and_says_so() {
    let field = FunctionField::new(1, |t: f64, _y: &[f64], f: &mut [f64]| {
        f[0] = if t > 0.5 { f64::NAN } else { 1.0 };
    });
    let start = Moment::new(0.0, [0.0]);
    for mut method in all(&field, &control(1e-6), &start) {
        let error = integrate(&mut *method, 2.0, |_| ControlFlow::Continue(())).unwrap_err();
        assert!(matches!(error, AdaptiveError::StepTooSmall { .. }), "{error}");
        assert!(method.moment().y[0].is_finite() && method.moment().t <= 0.5);
    }
}

#[test]
fn a_state_that_overflows_is_no_step_of_dormand_prince() {
    let steady = FunctionField::new(1, |_, _: &[f64], f: &mut [f64]| f[0] = 1e307);
    let control = StepControl::from(Tolerance::new(1e-6, 1.0).unwrap());
    let mut method = DormandPrince853::new(&steady, control, Moment::new(0.0, [1.7e308])).unwrap();
    let answer = integrate(&mut method, 100.0, |_| ControlFlow::Continue(()));
    assert!(matches!(answer, Err(AdaptiveError::StepTooSmall { .. })), "{answer:?}");
    assert!(method.moment().y[0].is_finite());
}

#[test]
fn the_number_of_steps_is_bounded() {
    let problem = van_der_pol(1000.0).unwrap();
    let bounded = control(1e-6).most_steps(20).unwrap();
    for mut method in all(&problem.field, &bounded, &problem.initial) {
        let error = integrate(&mut *method, 2000.0, |_| ControlFlow::Continue(())).unwrap_err();
        let AdaptiveError::TooManySteps { steps: 20, last } = &error else { panic!("{error}") };
        assert_eq!(last.t, method.moment().t);
    }
}

#[test]
fn a_run_after_an_impulse_starts_anew() {
    let field = FunctionField::new(2, |_t, y: &[f64], f: &mut [f64]| {
        f.copy_from_slice(&[y[1], -y[0]]);
    });
    let start = Moment::new(0.0, [1.0, 0.0]);
    for mut method in all(&field, &control(1e-10), &start) {
        integrate(&mut *method, 1.0, |_| ControlFlow::Continue(())).unwrap();
        let mut moment = method.moment().clone();
        moment.y[1] += 1.0;
        method.restart(&moment).unwrap();
        integrate(&mut *method, 3.0, |_| ControlFlow::Continue(())).unwrap();
        let expected = 3.0_f64.cos() + 2.0_f64.sin();
        let name = method.facts().name;
        assert!((method.moment().y[0] - expected).abs() < 1e-7, "{name}");
        let bad = Moment::new(3.0, [f64::NAN, 0.0]);
        let before = method.moment().clone();
        assert!(method.restart(&bad).is_err());
        assert_eq!(method.moment(), &before);
    }
}

#[test]
fn a_restart_where_f_is_not_a_number_changes_nothing() {
    let field = FunctionField::new(2, |_t, y: &[f64], f: &mut [f64]| {
        f.copy_from_slice(&[y[1], if y[0] > 10.0 { f64::NAN } else { -y[0] }]);
    });
    let start = Moment::new(0.0, [1.0, 0.0]);
    for at in 0..3 {
        let control = control(1e-8);
        let (mut one, mut other) = (all(&field, &control, &start), all(&field, &control, &start));
        let (one, other) = (&mut one[at], &mut other[at]);
        one.step(3.0).unwrap();
        other.step(3.0).unwrap();
        let error = other.restart(&Moment::new(1.0, [11.0, 0.0])).unwrap_err();
        assert!(matches!(error, AdaptiveError::NonFinite { component: 1, .. }), "{error}");
        let name = one.facts().name;
        assert_eq!(one.last_begin(), other.last_begin(), "{name}");
        for method in [&mut *one, &mut *other] {
            integrate(&mut **method, 3.0, |_| ControlFlow::Continue(())).unwrap();
        }
        assert_eq!(one.moment(), other.moment(), "{name}");
    }
}

#[test]
fn radau_takes_no_step_whose_error_is_not_a_number() {
    // The solution falls from the edge of where f is defined; with one of the two signs the filter of
    // the error looks beyond that edge.
    for k in [0.3, -0.3] {
        let field = FunctionField::new(1, move |t: f64, y: &[f64], f: &mut [f64]| {
            f[0] = if y[0] > 1.0 { f64::NAN } else { -1.0 + k * (2.0 * t).sin() };
        });
        let control = control(1e-9).first_step(1.5).unwrap();
        let mut radau = RadauIia5::new(&field, control, Moment::new(0.0, [1.0])).unwrap();
        while radau.moment().t < 1.5 {
            radau.step(1.5).unwrap();
            let Moment { t, y } = radau.moment();
            let error = (y[0] - (1.0 - t + k * t.sin().powi(2))).abs();
            assert!(error < 1e-7, "{error:e} at {t}");
        }
    }
}

#[cfg(feature = "serde")]
#[test]
fn saved_runs_and_states_survive_text_bit_by_bit() {
    use stationary_integrators::{Saved, State};

    let problem = van_der_pol(100.0).unwrap();
    for mut method in all(&problem.field, &control(1e-6), &problem.initial) {
        for _ in 0..20 {
            method.step(200.0).unwrap();
        }
        let saved = method.save();
        let text = serde_json::to_string(&saved).unwrap();
        assert_eq!(serde_json::from_str::<Saved>(&text).unwrap(), saved);
    }
    let mut state = State::new([0.1 + 0.2, -0.0], Covector([f64::MIN_POSITIVE, 1.0 / 3.0]));
    state.t = 1e22 / 3.0;
    let text = serde_json::to_string(&state).unwrap();
    let read: State<[f64; 2]> = serde_json::from_str(&text).unwrap();
    let bits =
        |s: &State<[f64; 2]>| (s.t.to_bits(), s.q.map(f64::to_bits), s.p.0.map(f64::to_bits));
    assert_eq!(bits(&read), bits(&state));
    assert!(serde_json::from_str::<State<[f64; 3]>>(&text).is_err());
    assert!(serde_json::from_str::<Saved>(r#"{"method": "x", "numbers": ["1,5"]}"#).is_err());
}
