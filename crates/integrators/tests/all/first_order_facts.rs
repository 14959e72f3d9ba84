//! Every fact of the methods for first-order systems, measured.

use std::ops::ControlFlow;

use stationary_calculus::Storage;
use stationary_integrators::problems::{kepler, van_der_pol};
use stationary_integrators::{
    AdaptiveMethod, BackwardDifferences, Damping, DormandPrince54, DormandPrince853, Evaluation,
    FunctionField, MechanicalField, Moment, RadauIia5, StepControl, Tolerance, VectorField,
    integrate,
};
use stationary_measure::loglog_slope;

use crate::first_order_methods::{all, control};

type Method<'f, const N: usize> = Box<dyn AdaptiveMethod<[f64; N]> + 'f>;

/// Every method on a field, by its place: two of one step, the formulas of order 1 to 5, DOPRI5.
fn every<'f, F: VectorField, const N: usize>(
    field: &'f F,
    control: &StepControl,
    start: [f64; N],
) -> Vec<Method<'f, N>> {
    let start = Moment::new(0.0, start);
    let mut methods: Vec<Method<'f, N>> = vec![
        Box::new(DormandPrince853::new(field, control.clone(), start.clone()).unwrap()),
        Box::new(RadauIia5::new(field, control.clone(), start.clone()).unwrap()),
    ];
    for highest in 1..=5 {
        let (control, start) = (control.clone(), start.clone());
        let bdf = BackwardDifferences::of_order_at_most(highest, field, control, start);
        methods.push(Box::new(bdf.unwrap()));
    }
    methods.push(Box::new(DormandPrince54::new(field, control.clone(), start).unwrap()));
    methods
}

fn constant(h: f64) -> StepControl {
    let tight = Tolerance::new(1e-13, 1e-14).unwrap();
    StepControl::from(tight).constant_step(h).unwrap()
}

/// A planet's start as y = (q, p), eccentricity 0.1 (problems::kepler starts at the pericentre).
fn orbit() -> (impl VectorField, [f64; 4], impl Fn(f64, &[f64]) -> f64) {
    let planet = Box::leak(Box::new(kepler(0.1).unwrap()));
    let planet: &'static _ = planet;
    let [q, p] = [planet.initial.q, planet.initial.p.0];
    let error = |t: f64, y: &[f64]| planet.error(t, &[y[0], y[1]]).unwrap();
    (MechanicalField::new(&planet.system), [q[0], q[1], p[0], p[1]], error)
}

/// The largest errors of a run at the ends of steps, and at five points within each.
fn errors<const N: usize>(
    method: &mut dyn AdaptiveMethod<[f64; N]>,
    end: f64,
    error: &impl Fn(f64, &[f64]) -> f64,
) -> (f64, f64) {
    let (mut at_steps, mut within) = (0.0_f64, 0.0_f64);
    integrate(method, end, |mut step| {
        at_steps = at_steps.max(error(step.to(), &step.moment().y));
        let mut y = [0.0; N];
        for part in 1..6 {
            let t = step.from() + (step.to() - step.from()) * f64::from(part) / 6.0;
            step.interpolate(t, &mut y).unwrap();
            within = within.max(error(t, &y));
        }
        ControlFlow::Continue(())
    })
    .unwrap();
    (at_steps, within)
}

#[test]
fn the_order_at_constant_steps_is_the_claimed_one() {
    let (field, start, error) = orbit();
    // Finest and coarsest number of steps, and how far the slope may be off.
    for (place, steps, band) in [(0, 16..90, 0.3), (1, 60..500, 0.1), (7, 60..500, 0.2)] {
        let mut points = Vec::new();
        let mut n = steps.start as f64;
        while n < steps.end as f64 {
            let control = constant(6.0 / n.round());
            let mut method = every(&field, &control, start).swap_remove(place);
            points.push((6.0 / n.round(), errors(&mut *method, 6.0, &error).0));
            n *= 2.0_f64.powf(0.25);
        }
        let facts = every(&field, &constant(0.1), start)[place].facts();
        let slope = loglog_slope(&points).unwrap();
        assert!((slope - f64::from(facts.order)).abs() < band, "{}: {slope}", facts.name);
    }
}

#[test]
fn the_formulas_of_order_one_and_two_converge_with_their_order() {
    // Those of higher order start with a step of order 1, which their constant steps never make up.
    let (field, start, error) = orbit();
    for (place, order) in [(2, 1.0), (3, 2.0)] {
        let points: Vec<(f64, f64)> = (0..5)
            .map(|halvings| {
                let h = 6.0 / f64::from(8000 << halvings);
                let mut method = every(&field, &constant(h), start).swap_remove(place);
                (h, errors(&mut *method, 6.0, &error).0)
            })
            .collect();
        let slope = loglog_slope(&points).unwrap();
        assert!((slope - order).abs() < 0.1, "bdf-{order}: {slope}");
    }
}

#[test]
fn with_every_order_the_work_grows_as_the_highest_order_foretells() {
    // error ~ tolerance, steps ~ tolerance^(-1/(k + 1)) for an error of order k + 1 a step.
    let (field, start, error) = orbit();
    for highest in 1..=5 {
        let points: Vec<(f64, f64)> = (0..5)
            .map(|i| {
                let coarsest = [-4.0, -5.0, -7.0, -9.0, -10.5][highest - 1];
                let tolerance = 10_f64.powf(coarsest - 0.5 * f64::from(i));
                let control = Tolerance::new(tolerance, tolerance).unwrap().into();
                let mut method = every(&field, &control, start).swap_remove(highest + 1);
                let error = errors(&mut *method, 6.0, &error).0;
                (1.0 / method.work().steps as f64, error)
            })
            .collect();
        let slope = loglog_slope(&points).unwrap();
        assert!((slope - highest as f64).abs() < 0.5, "bdf-{highest}: {slope}");
    }
}

#[test]
fn dense_output_has_the_claimed_order() {
    // One step from the exact state: the error within it is of one order more than over a run.
    let (field, start, error) = orbit();
    for (place, coarsest) in [(0, 0.25), (1, 0.05), (7, 0.05)] {
        let points: Vec<(f64, f64)> = (0..9)
            .map(|i| {
                let h = coarsest * 2.0_f64.powf(-0.25 * f64::from(i));
                let mut method = every(&field, &constant(h), start).swap_remove(place);
                (h, errors(&mut *method, h, &error).1)
            })
            .collect();
        let facts = every(&field, &constant(0.1), start)[place].facts();
        let slope = loglog_slope(&points).unwrap() - 1.0;
        assert!((slope - f64::from(facts.dense_order)).abs() < 0.3, "{}: {slope}", facts.name);
    }
}

/// y' = lambda y as a rotation and decay in the plane, lambda = re + i im.
fn linear(re: f64, im: f64) -> FunctionField<impl Fn(f64, &[f64], &mut [f64])> {
    FunctionField::new(2, move |_t, y: &[f64], f: &mut [f64]| {
        f.copy_from_slice(&[re * y[0] - im * y[1], im * y[0] + re * y[1]]);
    })
}

/// The size of y after `steps` steps of length 1 on y' = lambda y, from size 1.
fn size_after(place: usize, (re, im): (f64, f64), steps: i32) -> f64 {
    let field = linear(re, im);
    let mut method = every(&field, &constant(1.0), [1.0, 0.0]).swap_remove(place);
    let run = integrate(&mut *method, f64::from(steps), |step| {
        let y = step.moment().y;
        if y[0].hypot(y[1]) > 1e12 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    let y = method.moment().y;
    if run.is_err() { f64::INFINITY } else { y[0].hypot(y[1]) }
}

fn places() -> impl Iterator<Item = (usize, stationary_integrators::FirstOrderFacts)> {
    let field = linear(-1.0, 0.0);
    let methods = every(&field, &constant(1.0), [1.0, 0.0]);
    methods.into_iter().map(|m| m.facts()).collect::<Vec<_>>().into_iter().enumerate()
}

#[test]
fn decay_is_damped_as_the_facts_say() {
    for (place, facts) in places() {
        let far = size_after(place, (-1e8, 0.0), 40);
        match facts.damping {
            Damping::LStable => assert!(far < 1e-6, "{}: {far:e}", facts.name),
            Damping::AStable => unreachable!("no method is A-stable only"),
            // Formulas of high order damp fast decay, too, but not in all of the half plane.
            Damping::Conditional if facts.sector > 0.0 => assert!(far < 1e-6, "{}", facts.name),
            Damping::Conditional => assert!(far > 1e6, "{}: {far:e}", facts.name),
        }
        assert_eq!(facts.sector == 90.0, facts.damping == Damping::LStable, "{}", facts.name);
    }
}

#[test]
fn the_sector_of_stability_is_as_wide_as_the_facts_say() {
    for (place, facts) in places() {
        let worst = |angle: f64| {
            let ray = (-angle.to_radians().cos(), angle.to_radians().sin());
            let lengths = (0..40).map(|i| 0.05 * 1.25_f64.powi(i));
            lengths.map(|r| size_after(place, (r * ray.0, r * ray.1), 2000)).fold(0.0_f64, f64::max)
        };
        if facts.sector > 0.0 {
            let inside = worst(facts.sector - 0.5);
            assert!(inside < 10.0, "{} inside its sector: {inside:e}", facts.name);
        }
        if facts.sector < 90.0 {
            let outside = worst(facts.sector + 3.0);
            assert!(outside > 1e3, "{} outside its sector: {outside:e}", facts.name);
        }
    }
}

#[test]
fn bdf_of_high_order_blows_up_near_the_imaginary_axis() {
    // A lightly damped oscillation, h omega = 1: it should decay.
    let lambda = (-0.01, 1.0);
    assert!(size_after(6, lambda, 300) > 1e3);
    assert!(size_after(3, lambda, 300) < 1.0 && size_after(1, lambda, 300) < 1.0);
}

/// Prothero and Robinson: y' = lambda (y - cos t) - sin t, whose solution is cos t for every
/// lambda.
fn prothero_robinson(lambda: f64, steps: u32) -> f64 {
    let field = FunctionField::new(1, move |t: f64, y: &[f64], f: &mut [f64]| {
        f[0] = lambda * (y[0] - t.cos()) - t.sin();
    });
    let mut method = every(&field, &constant(1.0 / f64::from(steps)), [1.0]).swap_remove(1);
    let mut worst = 0.0_f64;
    integrate(&mut *method, 1.0, |step| {
        worst = worst.max((step.moment().y[0] - step.to().cos()).abs());
        ControlFlow::Continue(())
    })
    .unwrap();
    worst
}

#[test]
fn radau_loses_order_on_a_stiff_part_that_is_driven() {
    // Where h lambda is large the error is of order s + 1 = 4 in h, divided by h lambda: order 3.
    let order = |lambda: f64, coarsest: u32| {
        let points: Vec<(f64, f64)> = (0..4)
            .map(|i| coarsest << i)
            .map(|steps| (1.0 / f64::from(steps), prothero_robinson(lambda, steps)))
            .collect();
        loglog_slope(&points).unwrap()
    };
    let (mild, stiff) = (order(-1.0, 4), order(-1e5, 4));
    assert!((mild - 5.0).abs() < 0.2, "{mild}");
    assert!((stiff - 3.0).abs() < 0.3, "{stiff}");
}

#[test]
fn stages_count_the_evaluations_of_a_step() {
    let field = FunctionField::new(2, |t: f64, y: &[f64], f: &mut [f64]| {
        f.copy_from_slice(&[y[1], t.sin() - y[0]]);
    });
    let control = StepControl::from(Tolerance::new(1e-6, 1e-6).unwrap());
    let control = control.constant_step(0.01).unwrap();
    for (place, facts) in places() {
        let mut method = every(&field, &control, [1.0, 0.0]).swap_remove(place);
        let before = *method.work();
        method.step(1.0).unwrap();
        let work = *method.work();
        let evaluations = work.evaluations - before.evaluations;
        match facts.evaluation {
            Evaluation::Explicit => {
                assert_eq!(evaluations, u64::from(facts.stages));
                let mut y = [0.0; 2];
                for t in [0.001, 0.002] {
                    method.interpolate(t, &mut y).unwrap();
                    let dense = method.work().evaluations - work.evaluations;
                    assert_eq!(dense, u64::from(facts.dense_stages));
                }
            }
            Evaluation::Implicit => {
                let jacobians = 3 * (work.jacobians - before.jacobians);
                let arrival = u64::from(place == 1);
                let each = u64::from(facts.stages) * work.iterations;
                assert_eq!(evaluations, each + jacobians + arrival, "{}", facts.name);
            }
        }
    }
}

#[test]
fn an_explicit_method_pays_for_stiffness_with_steps() {
    let steps = |mu: f64| {
        let problem = van_der_pol(mu).unwrap();
        let control = Tolerance::new(1e-6, 1e-6).unwrap().into();
        let start = problem.initial.clone();
        let mut method = DormandPrince853::new(&problem.field, control, start).unwrap();
        integrate(&mut method, problem.end, |_| ControlFlow::Continue(())).unwrap();
        *method.work()
    };
    let (mild, stiff) = (steps(10.0), steps(1000.0));
    // h is bounded by about 6 over the rate 3 mu, over 2 mu seconds: mu^2 steps.
    assert!(stiff.steps > 300_000 && stiff.steps > 500 * mild.steps, "{mild:?} {stiff:?}");
    assert!(stiff.stiff * 16 > stiff.steps / 2, "{stiff:?}");
    assert!(mild.stiff * 16 < mild.steps / 2, "{mild:?}");
    let problem = van_der_pol(1000.0).unwrap();
    let control = Tolerance::new(1e-6, 1e-6).unwrap().into();
    let mut radau = RadauIia5::new(&problem.field, control, problem.initial.clone()).unwrap();
    integrate(&mut radau, problem.end, |_| ControlFlow::Continue(())).unwrap();
    assert!(radau.work().steps < 1000, "{:?}", radau.work());
}

#[test]
fn vectors_give_the_same_numbers_as_arrays() {
    fn end<C: Storage>(mut method: impl AdaptiveMethod<C>) -> Vec<f64> {
        integrate(&mut method, 3.0, |_| ControlFlow::Continue(())).unwrap();
        method.moment().y.as_ref().to_vec()
    }
    let (field, start, _) = orbit();
    let control = || StepControl::from(Tolerance::new(1e-8, 1e-8).unwrap());
    let (array, vector) = (Moment::new(0.0, start), Moment::new(0.0, start.to_vec()));
    assert_eq!(
        end(DormandPrince853::new(&field, control(), array.clone()).unwrap()),
        end(DormandPrince853::new(&field, control(), vector.clone()).unwrap()),
    );
    assert_eq!(
        end(DormandPrince54::new(&field, control(), array.clone()).unwrap()),
        end(DormandPrince54::new(&field, control(), vector.clone()).unwrap()),
    );
    assert_eq!(
        end(RadauIia5::new(&field, control(), array.clone()).unwrap()),
        end(RadauIia5::new(&field, control(), vector.clone()).unwrap()),
    );
    assert_eq!(
        end(BackwardDifferences::new(&field, control(), array).unwrap()),
        end(BackwardDifferences::new(&field, control(), vector).unwrap()),
    );
}

#[test]
fn a_motion_of_ages_that_begins_late_is_begun_by_a_step_that_the_clock_resolves() {
    // An oscillation of 2e5 years, told in seconds since long ago.
    const RATE: f64 = 1e-12;
    let field = FunctionField::new(2, |_t, y: &[f64], f: &mut [f64]| {
        f.copy_from_slice(&[RATE * y[1], -RATE * y[0]]);
    });
    let start = Moment::new(1e14, [1.0, 0.0]);
    for mut method in all(&field, &control(1e-6), &start) {
        let name = method.facts().name;
        let ran = integrate(&mut *method, 1e14 + 1.0 / RATE, |_| ControlFlow::Continue(()));
        ran.unwrap_or_else(|error| panic!("{name}: {error}"));
        let off = (method.moment().y[0] - 1.0_f64.cos()).abs();
        assert!(off < 1e-5, "{name}: {off:e}");
    }
}
