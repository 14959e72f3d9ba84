use super::*;
use crate::{FunctionEquation, Unsolvable};

/// The root, the report and the residuals' history of one equation in one unknown.
fn root(
    newton: Newton,
    guess: f64,
    f: impl FnMut(f64) -> f64,
    df: impl FnMut(f64) -> f64,
) -> (f64, Result<NewtonReport, NewtonError>, Vec<f64>) {
    let (mut f, mut df) = (f, df);
    let mut equation = FunctionEquation::new(
        1,
        |x: &[f64], value: &mut [f64]| value[0] = f(x[0]),
        |x: &[f64], value: &mut [f64]| value[0] = df(x[0]),
    );
    let mut memory = NewtonMemory::<[f64; 1]>::new(1, newton.iterations).unwrap();
    let mut x = [guess];
    let report = newton.solve(&mut equation, &mut x, &mut memory);
    (x[0], report, memory.history().to_vec())
}

#[test]
fn convergence_to_a_simple_root_is_quadratic() {
    // x^2 + y^2 = 4, x y = 1, with x > y > 0.
    let exact = [(2.0 + 3.0_f64.sqrt()).sqrt(), (2.0 - 3.0_f64.sqrt()).sqrt()];
    let mut errors = Vec::new();
    let mut equation = FunctionEquation::new(
        2,
        |x: &[f64], f: &mut [f64]| {
            f.copy_from_slice(&[x[0] * x[0] + x[1] * x[1] - 4.0, x[0] * x[1] - 1.0]);
        },
        |x: &[f64], df: &mut [f64]| {
            errors.push((x[0] - exact[0]).hypot(x[1] - exact[1]));
            df.copy_from_slice(&[2.0 * x[0], x[1], 2.0 * x[1], x[0]]);
        },
    );
    let mut memory = NewtonMemory::<[f64; 2]>::new(2, 20).unwrap();
    let mut x = [2.5, 0.2];
    let report = Newton::default().solve(&mut equation, &mut x, &mut memory).unwrap();
    assert!((x[0] - exact[0]).hypot(x[1] - exact[1]) < 1e-15);
    assert!(report.iterations <= 7, "{report:?}");
    let orders: Vec<f64> = errors
        .windows(3)
        .filter(|e| e[0] < 0.3 && e[2] > 1e-14)
        .map(|e| (e[2] / e[1]).ln() / (e[1] / e[0]).ln())
        .collect();
    let order = orders.last().unwrap();
    assert!((order - 2.0).abs() < 0.1, "order {order}, errors {errors:?}");
}

#[test]
fn each_step_towards_a_double_root_halves_the_error() {
    let mut errors = Vec::new();
    let newton = Newton { tolerance: 1e-16, iterations: 50 };
    // g(x)^2 with g = x^2 - 2.
    let g = |x: f64| x * x - 2.0;
    let (x, report, history) = root(
        newton,
        2.0,
        |x| g(x).powi(2),
        |x| {
            errors.push(x - 2.0_f64.sqrt());
            4.0 * x * g(x)
        },
    );
    let iterations = report.unwrap().iterations;
    assert!((20..=30).contains(&iterations), "{iterations}");
    assert!((x - 2.0_f64.sqrt()).abs() < 1e-8);
    let last = &errors[errors.len() - 5..];
    for pair in last.windows(2) {
        assert!((pair[1] / pair[0] - 0.5).abs() < 1e-3, "{errors:?}");
    }
    for pair in history[history.len() - 5..].windows(2) {
        assert!((pair[1] / pair[0] - 0.25).abs() < 1e-3, "{history:?}");
    }
}

#[test]
fn an_equation_without_a_root_ends_with_a_typed_failure_and_its_history() {
    for guess in [-3.0, -0.1, 1e-3, 0.7, 1e6] {
        let newton = Newton { tolerance: 1e-12, iterations: 40 };
        let (_, result, _) = root(newton, guess, |x| x * x + 1.0, |x| 2.0 * x);
        let error = result.unwrap_err();
        assert!(
            matches!(error.failure, NewtonFailure::Stalled | NewtonFailure::NotConverged),
            "{error}"
        );
        assert!(error.history.len() <= 41);
        assert_eq!(error.history[0], guess * guess + 1.0);
        assert!(error.history.windows(2).all(|pair| pair[1] < pair[0]));
    }
}

#[test]
fn a_vanishing_derivative_is_singular() {
    let (_, result, _) = root(Newton::default(), 0.0, |x| x * x + 1.0, |x| 2.0 * x);
    let error = result.unwrap_err();
    assert_eq!(error.failure, NewtonFailure::Unsolvable(Unsolvable::Singular));
    assert_eq!(error.history, [1.0]);
}

#[test]
fn a_guess_outside_of_the_domain_is_refused() {
    for guess in [-1.0, f64::NAN, f64::INFINITY] {
        let (_, result, _) = root(Newton::default(), guess, f64::ln, f64::recip);
        assert_eq!(result.unwrap_err().failure, NewtonFailure::NonFinite(0));
    }
}

#[test]
fn steps_out_of_the_domain_are_shortened() {
    // The full step from 3 leads to 3 - 3 ln 3 < 0, where the logarithm is not defined.
    let (x, report, _) = root(Newton::default(), 3.0, f64::ln, f64::recip);
    let report = report.unwrap();
    assert!((x - 1.0).abs() < 1e-15);
    assert!(report.residuals > report.iterations + 1);
    assert_eq!(report.energies, 0, "there is no energy to evaluate");
}

#[test]
fn the_line_search_rescues_the_arc_tangent_from_a_far_guess() {
    // Without it the iteration diverges from |x| > 1.3917.
    for guess in [1.4, -10.0, 1e4] {
        let (mut f, mut x) = (f64::atan(guess), guess);
        for _ in 0..4 {
            x -= f * (1.0 + x * x);
            f = x.atan();
        }
        assert!(x.abs() > guess.abs(), "plain Newton should diverge from {guess}");
        let (x, report, _) = root(Newton::default(), guess, f64::atan, |x| (1.0 + x * x).recip());
        assert!(x.abs() < 1e-15, "{x}");
        assert!(report.unwrap().iterations < 20);
    }
}

#[test]
fn a_derivative_of_the_wrong_sign_stalls() {
    let (_, result, _) = root(Newton::default(), 1.0, |x| x.powi(3) - 8.0, |x| -3.0 * x * x);
    assert_eq!(result.unwrap_err().failure, NewtonFailure::Stalled);
}

#[test]
fn the_bound_on_the_iterations_is_kept() {
    let newton = Newton { tolerance: 0.0, iterations: 3 };
    let (_, result, history) = root(newton, 100.0, |x| x * x - 2.0, |x| 2.0 * x);
    assert_eq!(result.unwrap_err().failure, NewtonFailure::NotConverged);
    assert_eq!(history.len(), 4);
}

#[test]
fn a_residual_within_the_tolerance_costs_no_step() {
    let newton = Newton { tolerance: 0.5, iterations: 0 };
    let (x, report, _) = root(newton, 1.5, |x| x * x - 2.0, |x| 2.0 * x);
    assert_eq!((x, report.unwrap().iterations), (1.5, 0));
}

/// A step towards a point mass, `x - y + a/x^2 = 0`, with the energy `1/2 (x - y)^2 - a/x`, which has
/// no lower bound: where it is not convex, the step is shifted to descend.
struct Fall {
    y: f64,
    a: f64,
}

impl Equation for Fall {
    fn residual(&mut self, x: &[f64], f: &mut [f64]) {
        f[0] = x[0] - self.y + self.a / x[0].powi(2);
    }

    fn solve(&mut self, x: &[f64], f: &mut [f64]) -> Result<(), Unsolvable> {
        let curvature = 1.0 - 2.0 * self.a / x[0].powi(3);
        f[0] /= curvature.abs();
        Ok(())
    }

    fn norm(&mut self, f: &[f64]) -> f64 {
        f[0].abs()
    }

    fn energy(&mut self, x: &[f64]) -> Option<f64> {
        Some(0.5 * (x[0] - self.y).powi(2) - self.a / x[0])
    }
}

#[test]
fn falling_into_an_abyss_of_the_energy_is_a_failure() {
    // The equation has a root as long as y >= 3 (a/4)^(1/3).
    let a = 1e-4;
    let fold = 3.0 * (a / 4.0_f64).cbrt();
    for (factor, solvable) in [(2.0, true), (1.01, true), (0.99, false), (0.5, false)] {
        let mut x = [factor * fold];
        let mut memory = NewtonMemory::<[f64; 1]>::new(1, 200).unwrap();
        let newton = Newton { tolerance: 0.0, iterations: 200 };
        let mut fall = Fall { y: x[0], a };
        let result = newton.solve(&mut fall, &mut x, &mut memory);
        assert_eq!(result.is_ok(), solvable, "{factor}: {result:?} at {x:?}");
    }
}

#[test]
fn a_residual_that_stands_still_at_a_root_near_zero_is_rounding() {
    // What is left of p = (x - q)/h is too small to move x - q, but not too small to move x.
    let h = 0.01;
    for k in 1..100 {
        let q = 0.01 + 1e-4 * f64::from(k);
        let p = -q / h * (1.0 + 2.0 * f64::EPSILON);
        let (x, report, _) = root(Newton::default(), q, |x| (x - q) / h - p, |_| 1.0 / h);
        assert!(x.abs() < 1e-15, "{x}");
        assert!(report.unwrap().iterations < 12);
    }
}

#[test]
fn an_unknown_far_larger_than_another_does_not_end_the_search_for_it() {
    for far in [1.0, 1e6, 1e9, 1e12, 1e15] {
        for unit in [1e-9, 1e-6, 1.0] {
            let mut equation = FunctionEquation::new(
                2,
                |x: &[f64], f: &mut [f64]| {
                    f[0] = x[0] / far - 1.0;
                    f[1] = (x[1] / unit).powi(2) - 1.0;
                },
                |x: &[f64], df: &mut [f64]| {
                    df.copy_from_slice(&[1.0 / far, 0.0, 0.0, 2.0 * x[1] / unit / unit]);
                },
            );
            let mut memory = NewtonMemory::<[f64; 2]>::new(2, 50).unwrap();
            let mut x = [far, 10.0 * unit];
            Newton::default().solve(&mut equation, &mut x, &mut memory).unwrap();
            assert!((x[1] / unit - 1.0).abs() < 1e-13, "{far} {unit}: {x:?}");
        }
    }
}

#[test]
fn a_root_at_zero_among_rounding_noise_is_found() {
    // Near x = 0 the residual is the rounding noise of two forces of size 1e3.
    let f = |x: f64| (1e3 + x) * (1.0 + x / 3e3) - (1e3 - x) * (1.0 - x / 7e3);
    let df = |x: f64| 2.0 + 1e3 / 3e3 + 1e3 / 7e3 + x * (2.0 / 3e3 - 2.0 / 7e3);
    for k in 1..100 {
        let guess = 0.1 * k as f64;
        let (x, report, _) = root(Newton::default(), guess, f, df);
        assert!(x.abs() < 1e-13, "{x}");
        report.unwrap();
    }
}

#[test]
fn a_failure_is_told_in_a_line_however_many_steps_it_took() {
    let tells = |history: Vec<f64>| {
        NewtonError { failure: NewtonFailure::NotConverged, history }.to_string()
    };
    let why = "Newton's method reached its bound on the iterations; the residual was";
    assert_eq!(tells(vec![]), format!("{why} never computed"));
    assert_eq!(tells(vec![0.04]), format!("{why} 4.0e-2"));
    let grown = tells((0..51).map(|k| 0.04 * 2.0_f64.powi(k)).collect());
    assert_eq!(grown, format!("{why} 4.0e-2 at first, 4.5e13 after 50 steps"));
}

#[test]
fn a_tolerance_that_is_negative_or_none_is_refused() {
    for tolerance in [f64::NAN, -1.0, f64::NEG_INFINITY] {
        let newton = Newton { tolerance, iterations: 50 };
        let (x, result, _) = root(newton, 2.0, |x| x * x - 2.0, |x| 2.0 * x);
        let failure = result.unwrap_err().failure;
        assert!(matches!(failure, NewtonFailure::Tolerance(_)), "{failure}");
        assert_eq!(x, 2.0);
    }
}

#[test]
fn a_root_is_found_at_every_scale_of_the_equation() {
    for scale in [1e-300, 1e-200, 1e-160, 1.0, 1e160, 1e300] {
        let (x, report, _) =
            root(Newton::default(), 2.0, |x| scale * (x * x - 2.0), |x| scale * 2.0 * x);
        assert!((x - 2.0_f64.sqrt()).abs() < 1e-15, "{scale}: {x}");
        assert!(report.unwrap().iterations > 2);
    }
}

#[test]
fn sizes_that_do_not_fit_are_refused() {
    let equation = || {
        FunctionEquation::new(
            2,
            |x: &[f64], f: &mut [f64]| f.copy_from_slice(&[x[0], x[1]]),
            |_: &[f64], df: &mut [f64]| df.copy_from_slice(&[1.0, 0.0, 0.0, 1.0]),
        )
    };
    for (held, n) in [(2, 1), (2, 3), (1, 2), (3, 3), (0, 0)] {
        let mut memory = NewtonMemory::<Vec<f64>>::new(held, 5).unwrap();
        let result = Newton::default().solve(&mut equation(), &mut vec![1.0; n], &mut memory);
        let failure = result.unwrap_err().failure;
        assert!(matches!(failure, NewtonFailure::Size(_)), "{failure}");
    }
}

#[test]
fn memory_that_cannot_be_had_is_none_and_a_bound_without_end_takes_little() {
    assert!(NewtonMemory::<[f64; 1]>::new(1, 1 << 50).is_some());
    assert!(NewtonMemory::<[f64; 1]>::new(1, usize::MAX).is_some());
    assert!(NewtonMemory::<Vec<f64>>::new(1 << 60, 1).is_none());
}
