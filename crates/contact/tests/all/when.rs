//! A ball that falls and bounces, for each choice of when the impulse is given (notes 11.4).

use stationary_calculus::{Covector, DiagonalMetric, Potential, Sink, System};
use stationary_contact::{
    Balls, ContactError, FixedBall, ImpactLaw, Impacting, Inequality, OneSidedPenalty, Wall, When,
};
use stationary_integrators::{State, UniformGravity};
use stationary_measure::loglog_slope;

type Fall = System<DiagonalMetric<Vec<f64>>, UniformGravity<1>>;
const G: f64 = 10.0;

fn fall(balls: usize) -> Fall {
    let potential = UniformGravity { acceleration: [-G], masses: vec![1.0; balls] };
    System::new(DiagonalMetric::new(vec![1.0; balls]).unwrap(), potential).unwrap()
}

fn floor(balls: usize) -> Inequality<Balls<1>> {
    let wall = Wall { normal: [1.0], offset: 0.0 };
    Inequality(Balls::new(vec![0.25; balls], vec![wall]).unwrap())
}

/// The largest height of the ball between its first and its second bounce.
fn rebound(when: When, c: f64, h: f64) -> f64 {
    let (system, gaps) = (fall(1), floor(1));
    let law = ImpactLaw::GeneralizedReflections;
    let mut impacting = Impacting::new(&system, &gaps, c, law, when).unwrap();
    let mut state = State::new(vec![1.25], Covector(vec![0.0]));
    let (mut hits, mut energy) = (0, 0.0_f64);
    while hits < 2 && state.t < 3.0 {
        hits += impacting.step(&mut state, h).unwrap().impacts;
        if hits == 1 {
            energy = energy.max(state.p.0[0].powi(2) / (2.0 * G) + state.q[0] - 0.25);
        }
    }
    energy
}

#[test]
fn the_rebound_height_is_c_squared_to_1e_minus_9_at_the_instant_and_to_order_h_otherwise() {
    for c in [0.5, 0.9, 1.0] {
        for h in [0.0371, 0.0123, 1e-3] {
            let height = rebound(When::AtTheInstant, c, h);
            assert!((height - c * c).abs() < 1e-9, "{c} {h}: {height}");
        }
        if c == 1.0 {
            // An elastic impact after overlap keeps energy, and so the height, whenever it comes.
            assert!((rebound(When::AfterOverlap, c, 0.0123) - 1.0).abs() < 1e-12);
            continue;
        }
        for when in [When::AfterOverlap, When::VelocityFilter] {
            // The largest error over steps of about a size: how a step happens to fall does not
            // count.
            let worst = |h: f64| {
                let steps = (0..8).map(|k| h * (1.0 - 0.0371 * f64::from(k)));
                steps.map(|h| (rebound(when, c, h) - c * c).abs()).fold(0.0, f64::max)
            };
            let points: Vec<_> =
                (0..5).map(|k| 1e-2 / f64::from(1 << k)).map(|h| (h, worst(h))).collect();
            let slope = loglog_slope(&points).unwrap();
            assert!((slope - 1.0).abs() < 0.2, "{when:?} {c}: {slope} {points:?}");
        }
    }
}

#[test]
fn zenos_ball_comes_to_rest_at_the_closed_forms_time_after_finitely_many_impacts() {
    let (c, h): (f64, f64) = (0.5, 0.01);
    let (system, gaps) = (fall(1), floor(1));
    let law = ImpactLaw::GeneralizedReflections;
    let mut impacting = Impacting::new(&system, &gaps, c, law, When::AtTheInstant).unwrap();
    let mut state = State::new(vec![1.25], Covector(vec![0.0]));
    let first = (2.0 / G).sqrt();
    let total = first * (1.0 + c) / (1.0 - c);
    let (mut impacts, mut last, mut rested) = (0, 0.0, false);
    for _ in 0..200 {
        let report = impacting.step(&mut state, h).unwrap();
        impacts += report.impacts;
        if report.impacts > 0 && !rested {
            last = report.last_impact;
        }
        rested |= report.rested;
    }
    assert!((last - total).abs() < 5e-6, "{last} against {total}");
    // Speeds halve from 4.5 m/s to those of bounces of 1e-12 m: 20 halvings.
    assert!(rested && impacts < 25, "{impacts}");
    assert!((state.q[0] - 0.25).abs() < 1e-12 && state.p.0[0].abs() < 1e-12, "{state:?}");
}

#[test]
fn what_rests_stays_for_ten_thousand_steps_and_does_not_rattle() {
    for &when in &[When::AtTheInstant, When::VelocityFilter] {
        for c in [0.0, 0.5, 1.0] {
            let (system, gaps) = (fall(2), floor(2));
            let law = ImpactLaw::GeneralizedReflections;
            let mut impacting = Impacting::new(&system, &gaps, c, law, when).unwrap();
            let mut state = State::new(vec![0.25, 0.75], Covector(vec![0.0; 2]));
            for _ in 0..10_000 {
                impacting.step(&mut state, 1e-3).unwrap();
                assert!(state.p.0.iter().all(|p| p.abs() < 1e-12), "{when:?} {c} {state:?}");
            }
            assert!((state.q[0] - 0.25).abs() < 1e-10 && (state.q[1] - 0.75).abs() < 1e-10);
        }
    }
}

#[test]
fn the_filter_never_overlaps_at_any_speed() {
    for speed in [1.0, 1e2, 1e4, 1e6] {
        for c in [0.0, 0.7, 1.0] {
            let (system, gaps) = (fall(3), floor(3));
            let law = ImpactLaw::GeneralizedReflections;
            let filter = When::VelocityFilter;
            let mut impacting = Impacting::new(&system, &gaps, c, law, filter).unwrap();
            let mut state =
                State::new(vec![0.3, 1.1, 1.9], Covector(vec![0.0, -speed, -0.5 * speed]));
            for _ in 0..500 {
                impacting.step(&mut state, 1e-3).unwrap();
                let smallest = gaps.gaps(0.0, &state.q).into_iter().fold(f64::MAX, f64::min);
                assert!(smallest > -1e-11 * state.q[2].max(1.0), "{speed} {c}: {smallest}");
                assert!(state.q[0] < state.q[1] && state.q[1] < state.q[2]);
            }
        }
    }
}

#[test]
fn steps_down_to_a_microsecond_gain_no_energy() {
    for &when in When::ALL {
        for h in [1e-3, 1e-4, 1e-5, 1e-6] {
            let (system, gaps) = (fall(3), floor(3));
            let law = ImpactLaw::GeneralizedReflections;
            let mut impacting = Impacting::new(&system, &gaps, 1.0, law, when).unwrap();
            let mut state = State::new(vec![0.26, 0.80, 1.40], Covector(vec![-1.0, -2.0, -3.0]));
            let energy = |state: &State<Vec<f64>>| system.energy(&state.q, state.p.view());
            let start = energy(&state);
            for _ in 0..3_000 {
                impacting.step(&mut state, h).unwrap();
            }
            // Symplectic Euler's own energy error is about h g v/2 for each ball.
            let bound = if when == When::VelocityFilter { 100.0 * h } else { 1e-9 };
            assert!(energy(&state) - start < bound, "{when:?} {h}: {}", energy(&state) - start);
        }
    }
}

#[test]
fn a_step_that_is_none_or_at_no_time_and_a_state_of_another_size_are_refused_whenever_the_impulse_is_given()
 {
    let (system, gaps) = (fall(1), floor(1));
    for when in [When::AfterOverlap, When::AtTheInstant, When::VelocityFilter] {
        let law = ImpactLaw::GeneralizedReflections;
        let mut impacting = Impacting::new(&system, &gaps, 0.5, law, when).unwrap();
        let start = State::new(vec![1.25], Covector(vec![0.0]));
        for h in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let mut state = start.clone();
            assert!(matches!(impacting.step(&mut state, h), Err(ContactError::Step(_))), "{h}");
            assert_eq!(state, start);
        }
        for t in [f64::NAN, f64::INFINITY, f64::MAX] {
            let h = if t == f64::MAX { f64::MAX } else { 0.1 };
            let mut state = State { t, ..start.clone() };
            assert!(matches!(impacting.step(&mut state, h), Err(ContactError::Step(_))), "{t}");
            assert_eq!((&state.q, &state.p), (&start.q, &start.p));
        }
        let mut other = State::new(vec![1.25; 2], Covector(vec![0.0; 2]));
        assert!(matches!(impacting.step(&mut other, 0.1), Err(ContactError::Size(_))));
    }
}

#[test]
fn a_restitution_outside_zero_to_one_is_refused() {
    let (system, gaps) = (fall(1), floor(1));
    let law = ImpactLaw::GaussSeidel;
    let error = Impacting::new(&system, &gaps, 1.5, law, When::AfterOverlap).unwrap_err();
    assert_eq!(error, ContactError::Restitution { contact: 0, value: 1.5 });
}

#[test]
fn a_ball_that_comes_onto_the_floor_it_touches_bounces_and_does_not_rest() {
    let (system, gaps) = (fall(1), floor(1));
    let law = ImpactLaw::GeneralizedReflections;
    let mut impacting = Impacting::new(&system, &gaps, 1.0, law, When::AtTheInstant).unwrap();
    let mut state = State::new(vec![0.25], Covector(vec![-1.0]));
    let report = impacting.step(&mut state, 1e-3).unwrap();
    assert!(report.impacts == 1 && !report.rested, "{report:?}");
    assert!((state.p.0[0] - (1.0 - G * 1e-3)).abs() < 1e-9, "{state:?}");
}

#[test]
fn a_ball_that_starts_inside_the_floor_is_stopped_or_bounces_at_once() {
    let (system, gaps) = (fall(1), floor(1));
    let law = ImpactLaw::GeneralizedReflections;
    for speed in [0.0, 1e-3, 1.0] {
        let mut impacting = Impacting::new(&system, &gaps, 0.5, law, When::AtTheInstant).unwrap();
        let mut state = State::new(vec![0.2], Covector(vec![-speed]));
        impacting.step(&mut state, 1e-3).unwrap();
        assert!(state.q[0] > 0.2 - 1e-12, "{speed}: {state:?}");
        let bounced = if speed == 1.0 { 0.5 - G * 1e-3 } else { 0.0 };
        assert!((state.p.0[0] - bounced).abs() < 1e-9, "{speed}: {state:?}");
    }
}

#[test]
fn the_impulses_that_a_step_shows_and_the_weight_are_the_change_of_momentum() {
    for &when in When::ALL {
        let (system, gaps) = (fall(1), floor(1));
        let law = ImpactLaw::GeneralizedReflections;
        let mut impacting = Impacting::new(&system, &gaps, 0.7, law, when).unwrap();
        let mut state = State::new(vec![1.25], Covector(vec![0.3]));
        let (mut given, mut moments) = (0.0, 0);
        for _ in 0..400 {
            let before = state.t;
            let met = impacting.step_seen(&mut state, 0.01, &mut |shown| {
                assert_eq!(shown.gaps, [0]);
                assert!((before..=before + 0.01 + 1e-12).contains(&shown.time), "{when:?}");
                given += shown.impulses[0];
                moments += 1;
            });
            met.unwrap();
        }
        let change = state.p.0[0] - 0.3 + G * state.t;
        assert!(moments > 2 && (given - change).abs() < 1e-11 * given, "{when:?} {given} {change}");
    }
}

#[test]
fn a_ball_thrown_at_a_ceiling_turns_there_however_long_the_step() {
    let potential = UniformGravity::<2> { masses: vec![1.0], acceleration: [0.0, -9.81] };
    let system = System::new(DiagonalMetric::new(vec![1.0; 2]).unwrap(), potential).unwrap();
    let ceiling = Wall { normal: [0.0, -1.0], offset: -1.001 };
    let gaps = Inequality(Balls::<2>::new(vec![1e-3], vec![ceiling]).unwrap());
    let at_the_ceiling = (25.0_f64 - 2.0 * 9.81).sqrt();
    for steps in [1, 2, 9, 90] {
        let law = ImpactLaw::GeneralizedReflections;
        let mut method = Impacting::new(&system, &gaps, 1.0, law, When::AtTheInstant).unwrap();
        let mut state = State::new(vec![0.0; 2], Covector(vec![0.0, 5.0]));
        let impacts: usize = (0..steps)
            .map(|_| method.step(&mut state, 0.9 / f64::from(steps)).unwrap().impacts)
            .sum();
        let left = 0.9 - (5.0 - at_the_ceiling) / 9.81;
        let expected = 1.0 - at_the_ceiling * left - 0.5 * 9.81 * left * left;
        assert_eq!(impacts, 1, "{steps}");
        assert!((state.q[1] - expected).abs() < 1e-11, "{steps}: {} {expected}", state.q[1]);
    }
}

#[test]
fn a_particle_that_clears_a_ball_by_a_millimetre_meets_nothing_however_long_the_step() {
    let potential = UniformGravity::<2> { masses: vec![1.0], acceleration: [0.0, -9.81] };
    let system = System::new(DiagonalMetric::new(vec![1.0; 2]).unwrap(), potential).unwrap();
    // The top of the way is 0.5 g 0.125^2 above the start.
    let top = 0.5 * 9.81 * 0.125 * 0.125;
    for (clearance, expected) in [(1e-3, 0), (1e-6, 0), (-1e-6, 1), (-1e-3, 1)] {
        let fixed = FixedBall { centre: [0.0, top - 0.6 - clearance], radius: 0.5 };
        let balls = Balls::<2>::new(vec![0.1], vec![]).unwrap().with_fixed(vec![fixed]).unwrap();
        let gaps = Inequality(balls);
        for steps in [1, 4, 50] {
            let law = ImpactLaw::GeneralizedReflections;
            let mut method = Impacting::new(&system, &gaps, 1.0, law, When::AtTheInstant).unwrap();
            let mut state = State::new(vec![-1.25, 0.0], Covector(vec![10.0, 9.81 * 0.125]));
            let impacts: usize = (0..steps)
                .map(|_| method.step(&mut state, 0.25 / f64::from(steps)).unwrap().impacts)
                .sum();
            assert_eq!(impacts, expected, "{clearance} {steps}");
        }
    }
}

#[test]
fn balls_with_one_centre_are_pushed_apart_along_the_first_axis() {
    let fixed = FixedBall { centre: [1.0, 2.0], radius: 0.5 };
    let balls = Balls::<2>::new(vec![0.5, 0.25], vec![]).unwrap().with_fixed(vec![fixed]).unwrap();
    let q = [1.0, 2.0, 1.0, 2.0];
    let penalty = OneSidedPenalty::new(Inequality(balls), 3.0).unwrap();
    let mut force = [0.0; 4];
    penalty.add_differential(&q, Covector(&mut force[..]));
    // Gaps of -1, -0.75 and -0.75; the second ball is pushed on by the first and the fixed one.
    assert_eq!(force, [-0.75, 0.0, -4.5, 0.0]);
    struct Finite;
    impl Sink for Finite {
        fn add_symmetric(&mut self, _: &[usize], block: &[f64]) {
            assert!(block.iter().all(|entry| entry.is_finite()), "{block:?}");
        }
    }
    penalty.add_hessian(&q, &mut Finite);
}
