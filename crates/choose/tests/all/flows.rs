//! Flows of first-order fields.

use std::time::Duration;

use stationary_choose::{
    Experiment, Flow, MeasuredRuns, QuestionError, Verdict, answer, preferred, refer,
};
use stationary_integrators::{Evaluation, FunctionField, Moment, VectorField};

const LONG: Duration = Duration::from_secs(600);

/// `x' = y`, `y' = mu (1 - x^2) y - x`.
fn van_der_pol(mu: f64) -> impl VectorField {
    FunctionField::new(2, move |_, y: &[f64], f: &mut [f64]| {
        f[0] = y[1];
        f[1] = mu * (1.0 - y[0] * y[0]) * y[1] - y[0];
    })
}

#[test]
fn the_stiff_field_is_given_to_an_implicit_method_and_the_other_to_an_explicit_one() {
    for (mu, horizon, implicit) in [(1.0, 10.0, false), (1000.0, 300.0, true)] {
        let start = Moment::new(0.0, vec![2.0, 0.0]);
        let place = |moment: &Moment<Vec<f64>>| vec![moment.y[0]];
        let flow = Flow::new(van_der_pol(mu), start, horizon, place).unwrap();
        for tolerance in [1e-2, 1e-4] {
            let mut runs = MeasuredRuns::new(&flow, LONG).unwrap();
            let answer = answer(&mut runs, tolerance).unwrap();
            let Verdict::Chosen(at) = answer.verdict else { panic!("{answer}") };
            let explicit = runs.family(at.family).evaluation == Evaluation::Explicit;
            assert_ne!(explicit, implicit, "{answer}");
            let families = preferred(&runs, 1e-2 * tolerance);
            let truth = refer(&mut runs, &families, 1e-2 * tolerance).unwrap();
            let course = runs.measure(at).whole().unwrap().clone();
            assert!(truth.error(&course).unwrap() <= tolerance, "{answer}");
        }
    }
}

#[test]
fn the_choice_for_a_decay_keeps_to_the_exponential() {
    let field = FunctionField::new(1, |_, y: &[f64], f: &mut [f64]| f[0] = -2.0 * y[0]);
    let start = Moment::new(1.0, vec![3.0]);
    let flow = Flow::new(field, start, 2.0, |moment| moment.y.clone()).unwrap();
    let flow = flow.relative_to_largest().named("a decay", "what is left");
    let mut runs = MeasuredRuns::new(&flow, LONG).unwrap();
    let answer = answer(&mut runs, 1e-6).unwrap();
    let at = answer.choice().unwrap_or_else(|| panic!("{answer}")).at;
    for (moment, y) in runs.measure(at).whole().unwrap().values.iter().enumerate() {
        let truth = 3.0 * (-0.2 * moment as f64).exp();
        assert!((y[0] - truth).abs() <= 3e-6, "{answer}");
    }
}

/// `M y' = f` with a matrix: one equation is algebraic.
struct Constrained([f64; 4]);

impl VectorField for Constrained {
    fn dim(&self) -> usize {
        2
    }

    fn evaluate(&self, _: f64, y: &[f64], f: &mut [f64]) {
        f[0] = -y[0] + y[1];
        f[1] = y[0] - 2.0 * y[1];
    }

    fn mass(&self) -> Option<&[f64]> {
        Some(&self.0)
    }
}

#[test]
fn a_mass_matrix_is_given_to_the_methods_that_know_it() {
    let field = Constrained([1.0, 0.0, 0.0, 0.0]);
    let start = Moment::new(0.0, vec![2.0, 1.0]);
    let flow = Flow::new(field, start, 3.0, |moment| vec![moment.y[0]]).unwrap();
    assert!(flow.ladder().families.iter().all(|family| family.name != "dormand-prince-853"));
    let answer = answer(&mut MeasuredRuns::new(&flow, LONG).unwrap(), 1e-3).unwrap();
    // `y1 = y0 / 2`, so that `y0' = -y0 / 2`.
    let at = answer.choice().unwrap_or_else(|| panic!("{answer}")).at;
    let mut runs = MeasuredRuns::new(&flow, LONG).unwrap();
    let last = runs.measure(at).whole().unwrap().values[20][0];
    assert!((last - 2.0 * (-1.5_f64).exp()).abs() < 1e-3, "{last}");
}

#[test]
fn a_field_that_no_method_takes_is_refused() {
    let field = FunctionField::new(2, |_, _: &[f64], f: &mut [f64]| f.fill(0.0));
    let wrong = Flow::new(field, Moment::new(0.0, vec![1.0]), 1.0, |m| m.y.clone());
    assert!(matches!(wrong.map(|_| ()).unwrap_err(), QuestionError::Size(_)));
    let infinite = FunctionField::new(1, |_, _: &[f64], f: &mut [f64]| f[0] = f64::NAN);
    let flow = Flow::new(infinite, Moment::new(0.0, vec![1.0]), 1.0, |m| m.y.clone()).unwrap();
    let answer = answer(&mut MeasuredRuns::new(&flow, LONG).unwrap(), 1e-3).unwrap();
    assert!(answer.choice().is_none(), "{answer}");
}
