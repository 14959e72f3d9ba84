//! Positions where a linkage may go on in two ways.

use stationary_calculus::{Covector, DiagonalMetric, System, Vector};
use stationary_constraints::{
    Adaptive, ConstrainedIntegrator, ConstraintError, Dense, Linear, Multipliers, Rattle,
    Redundancy, Rod, Rods, Solver, SparseDiagonal, StepTolerance,
};
use stationary_integrators::{State, UniformGravity, linear_momentum};
use stationary_measure::SplitMix64;

type Problem = System<DiagonalMetric<[f64; 4]>, UniformGravity<2>>;

/// Two points of masses 1 and 3 kg on cranks of 1 m whose hooks are as far apart as the coupler is long, 0.7 m.
/// The weights are not in proportion, so that the coupler carries force.
fn parallelogram() -> (Problem, Rods<2>) {
    let metric = DiagonalMetric::new([1.0, 1.0, 3.0, 3.0]).unwrap();
    let gravity = UniformGravity { acceleration: [0.0, -1.0], masses: vec![2.0, 0.5] };
    let rods = vec![Rod::new([2, 0], 1.0), Rod::new([3, 1], 1.0), Rod::new([0, 1], 0.7)];
    let rods = Rods::new(2, vec![[0.0, 0.0], [0.7, 0.0]], rods).unwrap();
    (System::new(metric, gravity).unwrap(), rods)
}

/// One pendulum as heavy as both.
fn pendulum() -> (System<DiagonalMetric<[f64; 2]>, UniformGravity<2>>, Rods<2>) {
    let metric = DiagonalMetric::new([4.0, 4.0]).unwrap();
    let gravity = UniformGravity { acceleration: [0.0, -1.0], masses: vec![2.5] };
    let rods = Rods::new(1, vec![[0.0, 0.0]], vec![Rod::new([1, 0], 1.0)]).unwrap();
    (System::new(metric, gravity).unwrap(), rods)
}

/// The parallelogram that moves as a pendulum does.
fn both(one: &State<[f64; 2]>) -> State<[f64; 4]> {
    let ([x, y], [px, py]) = (one.q, one.p.0);
    let p = [0.25 * px, 0.25 * py, 0.75 * px, 0.75 * py];
    State { t: one.t, q: [x, y, x + 0.7, y], p: Covector(p) }
}

#[derive(Debug)]
enum Outcome {
    /// The largest distance from the pendulum's places.
    Passed(f64),
    /// In this step.
    Failed(usize, ConstraintError),
}

/// Steps that land at an angle beside the flat position after five steps, and five more.
fn outcome<X>(choice: X, h: f64, offset: f64, speed: f64) -> Outcome
where
    X: Solver<[f64; 4]> + Copy,
{
    let (system, rods) = pendulum();
    let (sine, cosine) = offset.sin_cos();
    let landing = State::new([cosine, sine], Covector([-4.0 * speed * sine, 4.0 * speed * cosine]));
    let mut one = Rattle::new(&system, rods, &landing, Dense::<1>(Redundancy::Refuse)).unwrap();
    let mut path = landing.clone();
    for _ in 0..5 {
        one.step_either_way(&mut path, -h).unwrap();
    }
    let (system, rods) = parallelogram();
    let mut state = both(&path);
    let mut rattle = match Rattle::new(&system, rods, &state, choice) {
        Ok(rattle) => rattle,
        Err(error) => return Outcome::Failed(0, error),
    };
    let mut off = 0.0_f64;
    for k in 1..=10 {
        one.step(&mut path, h).unwrap();
        if let Err(error) = rattle.step(&mut state, h) {
            return Outcome::Failed(k, error);
        }
        let there = both(&path);
        off = state.q.iter().zip(there.q).fold(off, |off, (a, b)| off.max((a - b).abs()));
    }
    Outcome::Passed(off)
}

/// Where steps land beside the position, in steps.
const PARTS: [f64; 22] = [
    0.5, 0.3, 0.7, -0.4, 0.1, 0.05, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-9, 1e-12, 0.0, -1e-10,
    -1e-7, -1e-5, -1e-3, -1e-2, -0.05, -0.1,
];

/// Passed to rounding, or named; and how many passed.
fn judge<X: Solver<[f64; 4]> + Copy>(choice: X) -> usize {
    let mut passed = 0;
    for h in [1e-1, 3e-2, 1e-2, 1e-3, 1e-4] {
        for speed in [1.5, -1.5, 3.0, 0.5] {
            for part in PARTS {
                let found = outcome(choice, h, part * speed * h, speed);
                let told = format!("h {h}, speed {speed}, part {part}: {found:?}");
                match found {
                    Outcome::Passed(off) => {
                        assert!(off < 1e-6, "{told}");
                        passed += 1;
                    }
                    Outcome::Failed(
                        step,
                        ConstraintError::SingularPosition { rows, names, .. },
                    ) => {
                        assert!((4..=6).contains(&step), "{told}");
                        assert!(!rows.is_empty() && names.contains("rod between"), "{told}");
                        // A slow one is turned by more in a step.
                        let far = part.abs() >= 0.3 && h < 0.1 && speed.abs() > 1.0;
                        assert!(!far, "{told}");
                    }
                    Outcome::Failed(..) => panic!("{told}"),
                }
            }
        }
    }
    passed
}

#[test]
fn a_parallelogram_passes_where_it_lies_flat_on_its_branch_or_the_position_is_named() {
    for redundancy in [Redundancy::Refuse, Redundancy::LeastNorm] {
        let (dense, sparse) = (judge(Dense::<3>(redundancy)), judge(SparseDiagonal(redundancy)));
        println!("{redundancy:?}: {dense} and {sparse} of {} passed", 5 * 4 * PARTS.len());
        assert!(dense > 150 && sparse > 150);
    }
}

/// A crank of 1 m that carries 1 kg, a rod as long, and a slider of 2 kg that goes through the crank's pivot.
fn slider_crank() -> (Problem, (Rods<2>, Linear)) {
    let metric = DiagonalMetric::new([1.0, 1.0, 2.0, 2.0]).unwrap();
    let gravity = UniformGravity { acceleration: [0.0, -1.0], masses: vec![1.0, 2.0] };
    let rods = vec![Rod::new([2, 0], 1.0), Rod::new([0, 1], 1.0)];
    let rods = Rods::new(2, vec![[0.0, 0.0]], rods).unwrap();
    let line = Linear::new(vec![(vec![(3, 1.0)], 0.0)]).unwrap();
    (System::new(metric, gravity).unwrap(), (rods, line))
}

#[test]
fn a_slider_crank_of_equal_lengths_passes_its_pivot_on_its_branch_or_the_position_is_named() {
    let (mut passed, mut named) = (0, 0);
    for h in [5e-2, 1e-2, 1e-3] {
        for begin in 0..60 {
            // The crank turns to upright, at 2 rad/s, in five steps or so.
            let angle = std::f64::consts::FRAC_PI_2 - 2.0 * h * (5.0 + f64::from(begin) / 60.0);
            let (sine, cosine) = angle.sin_cos();
            let (u, w) = (-2.0 * sine, 2.0 * cosine);
            let (system, constraint) = slider_crank();
            let mut state =
                State::new([cosine, sine, 2.0 * cosine, 0.0], Covector([u, w, 4.0 * u, 0.0]));
            let energy = |state: &State<[f64; 4]>| {
                let [a, b, c, _] = state.p.0;
                0.5 * (a * a + b * b) + 0.25 * c * c + state.q[1]
            };
            let start = energy(&state);
            let sparse = SparseDiagonal(Redundancy::Refuse);
            let mut rattle = Rattle::new(&system, constraint, &state, sparse).unwrap();
            for _ in 0..12 {
                match rattle.step(&mut state, h) {
                    Ok(_) => {}
                    Err(ConstraintError::SingularPosition { .. }) => {
                        named += 1;
                        break;
                    }
                    Err(error) => panic!("h {h}, {begin}: {error}"),
                }
                let off = (state.q[2] - 2.0 * state.q[0]).abs();
                assert!(off < 1e-6, "h {h}, {begin}: the slider is {off} off its branch");
                assert!((energy(&state) - start).abs() < 40.0 * h * h, "h {h}, {begin}");
            }
            passed += usize::from(state.q[0] < 0.0);
        }
    }
    println!("{passed} passed, {named} named");
    assert!(passed > 100 && passed + named >= 180);
}

#[test]
fn a_start_in_a_singular_position_is_named_where_equations_may_depend_on_each_other() {
    let (system, rods) = parallelogram();
    let state = State::new([1.0, 0.0, 1.7, 0.0], Covector([0.0, 1.5, 0.0, 4.5]));
    let sparse = SparseDiagonal(Redundancy::Refuse);
    let refused = Rattle::new(&system, rods.clone(), &state, sparse);
    assert!(matches!(refused, Err(ConstraintError::Singular { .. })));
    for h in [0.1, 1e-2, 1e-3, 1e-4] {
        let shared = SparseDiagonal(Redundancy::LeastNorm);
        let mut rattle = Rattle::new(&system, rods.clone(), &state, shared).unwrap();
        let mut moved = state.clone();
        let error = rattle.step(&mut moved, h).unwrap_err();
        assert!(matches!(error, ConstraintError::SingularPosition { .. }), "{h}: {error}");
        assert_eq!(moved, state);
    }
}

#[test]
fn adaptive_steps_lead_a_parallelogram_through_every_flat_position() {
    let (system, rods) = parallelogram();
    for absolute in [1e-4, 1e-6] {
        let mut state = State::new([0.0, -1.0, 0.7, -1.0], Covector([3.0, 0.0, 9.0, 0.0]));
        let sparse = SparseDiagonal(Redundancy::Refuse);
        let rattle = Rattle::new(&system, &rods, &state, sparse).unwrap();
        let tolerance = StepTolerance { absolute, relative: 0.0 };
        let mut method = Adaptive::new(rattle, tolerance, 0.01, &state).unwrap();
        let (mut turned, mut before) = (0.0, -std::f64::consts::FRAC_PI_2);
        while state.t < 20.0 {
            method.advance(&mut state, 20.0).unwrap();
            let [x, y, other, _] = state.q;
            assert!((other - x - 0.7).abs() < 1e-6, "at {}", state.t);
            let angle = y.atan2(x);
            turned += (angle - before).rem_euclid(2.0 * std::f64::consts::PI);
            before = angle;
        }
        assert!(turned > 8.0 * 2.0 * std::f64::consts::PI, "{turned}");
    }
}

#[cfg(feature = "sparse")]
#[test]
fn without_a_rank_revealing_factor_a_singular_position_is_named_and_a_long_step_is_not_one() {
    use stationary_constraints::SparseGeneral;
    // On this side: a parallelogram that ends beside the flat position is named or passes on its branch. Of an
    // indefinite matrix the last five digits are not there: it is named farther off than by other solvers.
    let (mut named, mut passed) = (0, 0);
    for h in [1e-1, 3e-2, 1e-2] {
        for part in PARTS {
            match outcome(SparseGeneral, h, part * 1.5 * h, 1.5) {
                Outcome::Passed(off) if off < 1e-6 => passed += 1,
                Outcome::Failed(4..=6, ConstraintError::SingularPosition { rows, .. })
                    if !rows.is_empty() =>
                {
                    named += 1;
                }
                other => panic!("h {h}, part {part}: {other:?}"),
            }
        }
    }
    assert!(named > 0 && passed > 0, "{named} {passed}");
    // On that side: steps that are too long, and not singular by a factor that reveals the rank, are not named so.
    let (system, rods) = parallelogram();
    let refusal = |choice: &dyn Fn(&State<[f64; 4]>) -> Option<ConstraintError>, angle: f64| {
        let (sine, cosine) = f64::sin_cos(angle);
        choice(&both(&State::new([cosine, sine], Covector([-12.0 * sine, 12.0 * cosine]))))
    };
    let mut refused = 0;
    for angle in [1.2, 1.5, 1.9, -1.4] {
        for h in [0.3, 0.6, 1.0, 2.0, 5.0] {
            let own = |state: &State<[f64; 4]>| {
                let mut rattle = Rattle::new(&system, rods.clone(), state, SparseGeneral).unwrap();
                rattle.step(&mut state.clone(), h).err()
            };
            let other = |state: &State<[f64; 4]>| {
                let choice = SparseDiagonal(Redundancy::Refuse);
                let mut rattle = Rattle::new(&system, rods.clone(), state, choice).unwrap();
                rattle.step(&mut state.clone(), h).err()
            };
            let singular = |error: &Option<ConstraintError>| {
                matches!(error, Some(ConstraintError::SingularPosition { .. }))
            };
            let (own, other) = (refusal(&own, angle), refusal(&other, angle));
            // A step that is taken there may end near one, by a measure of its own.
            if other.is_some() && !singular(&other) {
                assert!(own.is_some() && !singular(&own), "{angle} {h}: {own:?} {other:?}");
                refused += 1;
            }
        }
    }
    assert!(refused > 5, "{refused}");
}

/// A closed polygon of rods whose points of 1 kg are this far from one line, with a velocity that stretches none.
fn flat_polygon(
    noise: &mut SplitMix64,
    width: f64,
) -> Result<(Rods<2>, State<Vec<f64>>), ConstraintError> {
    let points = 4 + (3.0 * noise.symmetric().abs()) as usize;
    let mut numbers = |size: [f64; 2]| -> Vec<f64> {
        (0..2 * points).map(|i| size[i % 2] * noise.symmetric()).collect()
    };
    let (q, mut p) = (numbers([width, 3.0]), Covector(numbers([1.0, 1.0])));
    let rods = (0..points).map(|i| {
        let (a, b) = (i, (i + 1) % points);
        Rod::new([a, b], (q[2 * a] - q[2 * b]).hypot(q[2 * a + 1] - q[2 * b + 1]))
    });
    let rods = Rods::new(points, vec![], rods.collect())?;
    let metric = DiagonalMetric::new(vec![1.0; 2 * points]).unwrap();
    let choice = SparseDiagonal(Redundancy::Refuse);
    let mut solver = Solver::<Vec<f64>>::analyse(&choice, &metric, &rods, 0.0, &q)?;
    solver.prepare(&metric, &rods, 0.0, &q)?;
    for _ in 0..3 {
        let mut rates = vec![0.0; points];
        solver.add_along(Vector(&p.0), &mut rates);
        solver.solve(&mut rates)?;
        solver.add_pulled_back(-1.0, &rates, p.view_mut());
    }
    Ok((rods, State::new(q, p)))
}

#[test]
fn impulses_that_all_but_cancel_leave_linear_momentum() {
    let mut noise = SplitMix64::new(3);
    let mut steps = 0;
    for _ in 0..200 {
        let Ok((rods, mut state)) = flat_polygon(&mut noise, 3e-7) else { continue };
        let points = state.q.len() / 2;
        let metric = DiagonalMetric::new(vec![1.0; 2 * points]).unwrap();
        let nothing = UniformGravity { acceleration: [0.0; 2], masses: vec![1.0; points] };
        let system = System::new(metric, nothing).unwrap();
        let start = linear_momentum::<2>(&state);
        let choice = SparseDiagonal(Redundancy::Refuse);
        let Ok(mut rattle) = Rattle::new(&system, rods, &state, choice) else { continue };
        for _ in 0..20 {
            if rattle.step(&mut state, 1e-4).is_err() {
                break;
            }
            steps += 1;
            let now = linear_momentum::<2>(&state);
            let off = (now[0] - start[0]).abs() + (now[1] - start[1]).abs();
            let largest = state.p.0.iter().fold(0.0_f64, |x, p| x.max(p.abs()));
            assert!(off < 1e-11 * largest, "{off:e} of {largest:e}");
        }
    }
    assert!(steps > 300, "{steps}");
}
