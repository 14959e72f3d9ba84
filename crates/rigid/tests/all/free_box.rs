//! MuJoCo's tumbling box: what each integrator does to its energy and angular momentum.

use stationary_rigid::{BodyMethod, Poses, problems::tumbling_box, spatial_angular_momentum};

/// The largest relative errors of energy and angular momentum over many steps.
fn errors(method: BodyMethod, h: f64, steps: u32) -> (f64, f64) {
    let problem = tumbling_box().unwrap();
    let mut state = problem.initial.clone();
    let (energy, momentum) =
        (problem.energy(&state), spatial_angular_momentum::<Poses>(&state).unwrap());
    let mut integrator = method.integrator(&problem.system).unwrap();
    let mut largest = (0.0_f64, 0.0_f64);
    for _ in 0..steps {
        integrator.step(&mut state, h).unwrap();
        largest.0 = largest.0.max((problem.energy(&state) / energy - 1.0).abs());
        let off = spatial_angular_momentum::<Poses>(&state).unwrap() - momentum;
        largest.1 = largest.1.max(off.norm() / momentum.norm());
    }
    largest
}

#[test]
fn the_variational_rotation_holds_energy_within_2e_minus_5_and_four_times_closer_at_half_the_step()
{
    for method in [BodyMethod::VariationalRotation, BodyMethod::AxisRotations] {
        let energies = [0, 1, 2, 3].map(|k| errors(method, 0.01 / f64::from(1 << k), 500 << k).0);
        assert!(energies[0] < 2e-5, "{method}: {:e}", energies[0]);
        for pair in energies.windows(2) {
            let ratio = pair[0] / pair[1];
            assert!((ratio - 4.0).abs() < 0.05, "{method}: {ratio}");
        }
    }
}

#[test]
fn over_100_000_steps_angular_momentum_moves_by_less_than_1e_minus_12_and_energy_has_no_trend() {
    for method in
        [BodyMethod::VariationalRotation, BodyMethod::AxisRotations, BodyMethod::ExactRotation]
    {
        let short = errors(method, 0.01, 1_000);
        let long = errors(method, 0.01, 100_000);
        assert!(long.1 < 1e-12, "{method}: angular momentum {:e}", long.1);
        assert!(long.0 < 1.001 * short.0 + 1e-12, "{method}: {:e} {:e}", short.0, long.0);
    }
}

#[test]
fn a_body_that_turns_steadily_gathers_no_rounding_either() {
    use nalgebra::Vector3;
    use stationary_rigid::{
        Body, BodyMetric, BodyMotion, Free, LieGroup, Orientations, RigidMotion,
    };
    // The same angle in every step: an error of length that a turn makes would be made each time.
    for moments in [[0.1, 0.1, 0.15], [0.1, 0.1, 0.1]] {
        for method in [BodyMethod::VariationalRotation, BodyMethod::AxisRotations] {
            let metric = BodyMetric::<Orientations>::new(vec![Body::new(1.0, moments).unwrap()]);
            let motion = BodyMotion {
                pose: RigidMotion::identity(),
                velocity: Vector3::zeros(),
                angular_velocity: Vector3::new(0.1, 0.0, 30.0),
            };
            let mut state = metric.state(&[motion]).unwrap();
            let system = metric.under(Free { freedoms: 3 }).unwrap();
            let momentum = spatial_angular_momentum::<Orientations>(&state).unwrap();
            let mut integrator = method.integrator(&system).unwrap();
            for _ in 0..100_000 {
                integrator.step(&mut state, 0.01).unwrap();
            }
            let off = spatial_angular_momentum::<Orientations>(&state).unwrap() - momentum;
            assert!(off.norm() < 1e-12 * momentum.norm(), "{method}: {:e}", off.norm());
        }
    }
}

#[test]
fn what_promises_no_angular_momentum_loses_it() {
    let munthe_kaas = |h: f64, steps| errors(BodyMethod::MuntheKaas4, h, steps).1;
    assert!(munthe_kaas(0.01, 500) > 1e-9);
    let order = (munthe_kaas(0.02, 250) / munthe_kaas(0.01, 500)).log2();
    assert!((order - 4.0).abs() < 0.1, "{order}");
    let game = errors(BodyMethod::RenormalizedEuler, 0.01, 500);
    assert!(game.0 > 0.05 && game.1 > 0.05, "{game:?}");
    let order = (errors(BodyMethod::RenormalizedEuler, 0.005, 1_000).1 / game.1).log2();
    assert!((order + 1.0).abs() < 0.1, "{order}");
}

#[test]
fn a_step_of_more_than_half_a_turn_is_an_error_and_leaves_the_state() {
    let problem = tumbling_box().unwrap();
    let mut integrator = BodyMethod::VariationalRotation.integrator(&problem.system).unwrap();
    let mut state = problem.initial.clone();
    let error = integrator.step(&mut state, 1.5).unwrap_err();
    assert!(error.to_string().contains("Newton"), "{error}");
    assert_eq!(state, problem.initial);
    // The explicit one has no such limit, and no accuracy there either.
    let mut explicit = BodyMethod::AxisRotations.integrator(&problem.system).unwrap();
    assert!(explicit.step(&mut state, 1.5).is_ok());
}
