//! Whether an estimated error is the true one, at every time, and whether it is said where it is not.

use std::ops::ControlFlow;

use stationary_calculus::{Covector, DiagonalMetric, Metric, Potential, Sink, SizeError, System};
use stationary_integrators::problems::{Problem, kepler, oscillator, pendulum, van_der_pol};
use stationary_integrators::{
    AdaptiveError, AdaptiveMethod, Composition, DormandPrince853, Horizon, Integrator,
    MechanicalField, Method, Moment, RadauIia5, Scheme, State, StepControl, StepError, StepReport,
    Tolerance, Trust, integrate_with_error, simulate, simulate_with_error,
};

/// True errors that are neither rounding nor as large as the motion.
const JUDGED: std::ops::Range<f64> = 1e-9..3e-2;

/// The least and the largest estimate in units of the true error, over all times at which it can be
/// relied on; nothing where there is none.
fn effectivity<M: Metric, P: Potential, const N: usize>(
    problem: &Problem<M, P, [f64; N]>,
    method: Method,
    steps: u64,
) -> Option<(f64, f64)> {
    let horizon = Horizon::divided(problem.period, steps).unwrap();
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    let mut state = problem.initial.clone();
    let make = || method.integrator::<_, _, [f64; N]>(&problem.system);
    simulate_with_error(make, &mut state, horizon, |now| {
        let truth = problem.error(now.state.t, &now.state.q).unwrap();
        if JUDGED.contains(&truth) && now.is_sure() {
            let ratio = now.distance() / problem.scale / truth;
            (least, most) = (least.min(ratio), most.max(ratio));
        }
        ControlFlow::Continue(())
    })
    .ok()?;
    (most > 0.0).then_some((least, most))
}

#[test]
fn an_estimate_is_half_to_twice_the_true_error_at_every_time() {
    let mut judged = 0;
    for &method in Method::ALL {
        for steps in [64, 128, 256, 512, 1024] {
            let orbit = effectivity(&kepler(0.3).unwrap(), method, steps);
            let swing = effectivity(&pendulum(2.0).unwrap(), method, steps);
            let spring = effectivity(&oscillator(1.0).unwrap(), method, steps);
            for (least, most) in [orbit, swing, spring].into_iter().flatten() {
                assert!(least > 0.5 && most < 2.0, "{method}, {steps}: {least} to {most}");
                judged += 1;
            }
        }
    }
    assert!(judged > 150, "{judged}");
}

/// Two masses between walls, on springs whose force is `k d + b d^3`.
struct StiffeningChain;

impl StiffeningChain {
    const LINEAR: f64 = 1.7796816501387025;
    const CUBIC: f64 = 1.1312054626277597;
}

impl Potential for StiffeningChain {
    fn dim(&self) -> usize {
        2
    }

    fn energy(&self, q: &[f64]) -> f64 {
        let stretches = [q[0], q[1] - q[0], -q[1]];
        stretches.iter().map(|d| d * d * (0.5 * Self::LINEAR + 0.25 * Self::CUBIC * d * d)).sum()
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let [a, b, c] =
            [q[0], q[1] - q[0], -q[1]].map(|d: f64| Self::LINEAR * d + Self::CUBIC * d.powi(3));
        dv.0[0] += a - b;
        dv.0[1] += b - c;
    }

    /// Nothing: explicit methods ask for none.
    fn add_hessian(&self, _: &[f64], _: &mut impl Sink) {}
}

#[test]
fn runs_that_shrink_in_places_alone_or_by_another_power_here_are_not_sure() {
    let system =
        System::new(DiagonalMetric::new([1.6494209015330825, 0.3]).unwrap(), StiffeningChain);
    let system = system.unwrap();
    let start = State::new([0.0, 1.2168799276825104], Covector([0.0; 2]));
    let (end, steps, finer) = (4.85082111207118, 16, 64);
    let follow = |scheme: Scheme, steps: u64| {
        let mut states = Vec::new();
        let mut state = start.clone();
        let mut run = Composition::new(&system, scheme).unwrap();
        simulate(&mut run, &mut state, Horizon::divided(end, steps).unwrap(), |now| {
            states.push(now.state.q);
            ControlFlow::Continue(())
        })
        .unwrap();
        states
    };
    let truth = follow(Scheme::KahanLi8, steps * finer);
    let (mut state, mut converging) = (start.clone(), 0);
    let make = || Composition::new(&system, Scheme::BlanesMoanNystrom6);
    simulate_with_error(make, &mut state, Horizon::divided(end, steps).unwrap(), |now| {
        let there = truth[(now.step * finer) as usize - 1];
        let off = (there[0] - now.state.q[0]).hypot(there[1] - now.state.q[1]);
        let ratio = now.distance() / off;
        converging += u32::from(now.trust.converges());
        // The steps of h and of h/2 are on the way to the method's order; those of h/4 are far beyond.
        assert!(!now.is_sure() || (0.25..4.0).contains(&ratio), "{ratio} at step {}", now.step);
        ControlFlow::Continue(())
    })
    .unwrap();
    assert!(converging > 0);
}

#[test]
fn steps_that_are_too_long_are_told() {
    let planet = kepler(0.95).unwrap();
    let horizon = Horizon::divided(planet.period, 32).unwrap();
    let mut state = planet.initial.clone();
    let make = || Method::RungeKutta4.integrator::<_, _, [f64; 2]>(&planet.system);
    let mut last = Trust::Converging { order: 4.0 };
    simulate_with_error(make, &mut state, horizon, |now| {
        last = now.trust;
        ControlFlow::Continue(())
    })
    .unwrap();
    assert!(matches!(last, Trust::NotConverging { .. }), "{last:?}");
}

/// Steps that fail after so many.
struct Breaking<I>(I, u32);

impl<C, I: Integrator<C>> Integrator<C> for Breaking<I> {
    fn facts(&self) -> stationary_integrators::Facts {
        self.0.facts()
    }

    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<StepReport, StepError> {
        self.1 = self.1.checked_sub(1).ok_or(StepError::SingularLegendreTransform)?;
        self.0.step(state, h)
    }
}

#[test]
fn a_step_that_fails_leaves_the_state_after_the_last_good_one() {
    let planet = kepler(0.3).unwrap();
    let horizon = Horizon::divided(planet.period, 100).unwrap();
    let make = || {
        let inner = Method::StormerVerlet.integrator::<_, _, [f64; 2]>(&planet.system)?;
        // The quarters come to their third long step, and half of it.
        Ok::<_, SizeError>(Breaking(inner, 10))
    };
    let (mut state, mut last) = (planet.initial.clone(), planet.initial.clone());
    let failed = simulate_with_error(make, &mut state, horizon, |now| {
        last = now.state.clone();
        ControlFlow::Continue(())
    })
    .unwrap_err();
    assert_eq!((failed.step, failed.source), (3, StepError::SingularLegendreTransform));
    assert_eq!(state, last);
    assert_eq!(state.t, horizon.time(2));
}

#[test]
fn a_storage_of_another_size_is_refused_before_the_first_step() {
    let planet = kepler(0.3).unwrap();
    let horizon = Horizon::divided(1.0, 10).unwrap();
    let make = || Method::StormerVerlet.integrator::<_, _, [f64; 3]>(&planet.system);
    let mut state = State::new([0.0; 3], Covector([0.0; 3]));
    let refused = simulate_with_error(make, &mut state, horizon, |_| ControlFlow::Continue(()));
    assert!(matches!(refused.unwrap_err().source, StepError::Size(_)));
}

#[test]
fn a_run_of_a_smaller_tolerance_tells_the_error_of_chosen_steps() {
    let planet = kepler(0.6).unwrap();
    let field = MechanicalField::new(&planet.system);
    let start = [planet.initial.q.as_slice(), planet.initial.p.components()].concat();
    let at = |tolerance| {
        let control = StepControl::from(Tolerance::new(tolerance, tolerance).unwrap());
        DormandPrince853::new(&field, control, Moment::new(0.0, start.clone())).unwrap()
    };
    let (mut loose, mut middle, mut tight, mut judged) = (at(1e-6), at(1e-7), at(1e-8), 0);
    integrate_with_error([&mut loose, &mut middle, &mut tight], planet.horizon, |now| {
        let q = [now.moment.y[0], now.moment.y[1]];
        let truth = planet.error(now.moment.t, &q).unwrap() * planet.scale;
        if JUDGED.contains(&truth) && now.is_sure() {
            let ratio = now.error[..2].iter().map(|x| x * x).sum::<f64>().sqrt() / truth;
            assert!((0.5..2.0).contains(&ratio), "{ratio} at {}", now.moment.t);
            judged += 1;
        }
        ControlFlow::Continue(())
    })
    .unwrap();
    assert!(judged > 20, "{judged}");
}

#[test]
fn the_error_of_a_stiff_run_is_told_too() {
    let relaxation = van_der_pol(1000.0).unwrap();
    let at = |tolerance| {
        let control = StepControl::from(Tolerance::new(tolerance, tolerance).unwrap());
        RadauIia5::new(&relaxation.field, control, relaxation.initial.clone()).unwrap()
    };
    let (mut loose, mut middle, mut tight) = (at(1e-4), at(1e-5), at(1e-7));
    let mut last = Vec::new();
    integrate_with_error([&mut loose, &mut middle, &mut tight], relaxation.end, |now| {
        last = now.error.to_vec();
        ControlFlow::Continue(())
    })
    .unwrap();
    let reached = loose.moment().y;
    let told = [reached[0] + last[0], reached[1] + last[1]];
    let (before, after) = (relaxation.error(&reached).unwrap(), relaxation.error(&told).unwrap());
    assert!(after < 0.1 * before, "{after} of {before}");
}

#[test]
fn runs_that_stand_at_two_moments_are_refused() {
    let planet = kepler(0.6).unwrap();
    let field = MechanicalField::new(&planet.system);
    let start = [planet.initial.q.as_slice(), planet.initial.p.components()].concat();
    let at = |t| {
        let control = StepControl::from(Tolerance::new(1e-6, 1e-6).unwrap());
        DormandPrince853::new(&field, control, Moment::new(t, start.clone())).unwrap()
    };
    let runs = [&mut at(0.0), &mut at(0.0), &mut at(1.0)];
    let run = integrate_with_error(runs, 2.0, |_| ControlFlow::Continue(()));
    assert!(matches!(run, Err(AdaptiveError::OutsideStep { t: 1.0, .. })), "{run:?}");
}

#[test]
fn runs_of_one_tolerance_are_sure_of_nothing() {
    let planet = kepler(0.6).unwrap();
    let field = MechanicalField::new(&planet.system);
    let start = [planet.initial.q.as_slice(), planet.initial.p.components()].concat();
    let at = || {
        let control = StepControl::from(Tolerance::new(1e-6, 1e-6).unwrap());
        DormandPrince853::new(&field, control, Moment::new(0.0, start.clone())).unwrap()
    };
    integrate_with_error([&mut at(), &mut at(), &mut at()], 20.0, |now| {
        assert!(!now.is_sure());
        ControlFlow::Continue(())
    })
    .unwrap();
}
