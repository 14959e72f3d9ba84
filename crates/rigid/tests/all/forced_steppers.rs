//! Steps of bodies under forces: order, momenta, works, and where damping is stable.

use nalgebra::Vector3;
use stationary_integrators::{Integrator, State};
use stationary_measure::loglog_slope;
use stationary_rigid::{
    Attachment, AxisRotations, Body, BodyForces, BodyMethod, BodyMetric, BodyMotion,
    ConstantVelocity, ExactRotation, Free, FreeRotation, JointEnd, LieGroup, LieVerlet, Poses,
    RigidMotion, Rotation, spatial_angular_momentum,
};

use crate::body_forces::{AXIS, OTHER, POINT, Sprung, boxes, ends, everything, far};

#[test]
fn every_stepper_keeps_its_order_under_forces_of_time_place_and_velocity() {
    let (system, initial) = boxes();
    let run = |method: BodyMethod, steps: u32, every: u32| {
        let mut integrator = method.forced(&system, everything()).unwrap();
        let mut state = initial.clone();
        let mut seen = Vec::new();
        for step in 1..=steps {
            integrator.step(&mut state, 1.0 / f64::from(steps)).unwrap();
            if step % every == 0 {
                seen.extend(state.q.iter().chain(&state.p.0));
            }
        }
        seen
    };
    let truth = run(BodyMethod::MuntheKaas4, 3200, 400);
    for &method in BodyMethod::ALL {
        let points = [160_u32, 320, 640].map(|steps| {
            let error = far(&run(method, steps, steps / 8), &truth);
            (1.0 / f64::from(steps), error)
        });
        let order = f64::from(method.facts().order);
        let slope = loglog_slope(&points).unwrap();
        assert!((slope - order).abs() < 0.2, "{method}: {slope} {points:?}");
    }
}

#[test]
fn what_acts_between_bodies_leaves_both_momenta_and_a_load_brings_its_impulse() {
    let (system, initial) = boxes();
    let mut inner = BodyForces::new(Poses, 2);
    let points = [Attachment::Body(0, POINT), Attachment::Body(1, OTHER)];
    inner.between_points(points, |_, _, rate| 0.3 - 2.0 * rate).unwrap();
    inner.about_axis(ends()[0], AXIS, |t, _, rate| t.sin() - 0.5 * rate).unwrap();
    let linear = |p: &[f64]| Vector3::new(p[0] + p[6], p[1] + p[7], p[2] + p[8]);
    fn kept<R: FreeRotation>(
        system: &Sprung,
        forces: BodyForces<Poses>,
        initial: &State<Vec<f64>>,
    ) -> State<Vec<f64>> {
        let mut verlet = LieVerlet::<_, _, R, _>::forced(system, forces).unwrap();
        let mut state = initial.clone();
        (0..500).for_each(|_| assert!(verlet.step(&mut state, 0.02).is_ok()));
        state
    }
    for state in [
        kept::<ConstantVelocity>(&system, inner.clone(), &initial),
        kept::<AxisRotations>(&system, inner.clone(), &initial),
        kept::<ExactRotation>(&system, inner.clone(), &initial),
    ] {
        let spin = |state| spatial_angular_momentum::<Poses>(state).unwrap();
        assert!((linear(&state.p.0) - linear(&initial.p.0)).norm() < 1e-13);
        assert!((spin(&state) - spin(&initial)).norm() < 1e-13);
    }
    // A load that depends on time: its impulse is the trapezoid sum, to rounding.
    let (h, load) = (0.02, |t: f64| Vector3::new(t.cos(), 0.5 * t, (3.0 * t).sin()));
    inner.at_point(1, OTHER, move |t, _, _| load(t)).unwrap();
    let state = kept::<ConstantVelocity>(&system, inner, &initial);
    let impulse: Vector3<f64> = (0..500)
        .map(|step| (load(h * f64::from(step)) + load(h * f64::from(step + 1))) * (0.5 * h))
        .sum();
    assert!((linear(&state.p.0) - linear(&initial.p.0) - impulse).norm() < 1e-12);
}

#[test]
fn energy_less_the_works_of_all_forces_is_off_by_order_two_of_the_step() {
    let (system, initial) = boxes();
    let points = [50, 100, 200, 400].map(|steps| {
        let mut verlet =
            LieVerlet::<_, _, ConstantVelocity, _>::forced(&system, everything()).unwrap();
        let (mut state, h) = (initial.clone(), 2.0 / f64::from(steps));
        let (mut works, mut defect) = (0.0, 0.0_f64);
        for _ in 0..steps {
            verlet.step(&mut state, h).unwrap();
            works += verlet.works().iter().sum::<f64>();
            let energy = |s: &State<Vec<f64>>| system.energy(&s.q, s.p.view());
            defect = defect.max((energy(&state) - energy(&initial) - works).abs());
        }
        assert!(works.abs() > 0.1, "the forces work: {works}");
        (h, defect)
    });
    let slope = loglog_slope(&points).unwrap();
    assert!((slope - 2.0).abs() < 0.1, "{slope} {points:?}");
}

#[test]
fn without_a_potential_the_works_are_the_change_of_energy_to_rounding() {
    let (system, initial) = boxes();
    let system = BodyMetric::<Poses>::new(system.metric().bodies().to_vec())
        .under(Free { freedoms: 12 })
        .unwrap();
    let mut verlet = LieVerlet::<_, _, ExactRotation, _>::forced(&system, everything()).unwrap();
    let (mut state, mut works) = (initial.clone(), 0.0);
    for _ in 0..200 {
        verlet.step(&mut state, 0.01).unwrap();
        works += verlet.works().iter().sum::<f64>();
    }
    let energy = |s: &State<Vec<f64>>| system.energy(&s.q, s.p.view());
    assert!((energy(&state) - energy(&initial) - works).abs() < 1e-13);
}

/// A flywheel on a fixed hinge: inertia 1 about z, with a damper of `damping` N m s.
fn braked(damping: f64) -> (BodyMetric<Poses>, BodyForces<Poses>, BodyMotion) {
    let metric = BodyMetric::<Poses>::new(vec![Body::new(1.0, [1.0, 1.0, 1.0]).unwrap()]);
    let mut forces = BodyForces::new(Poses, 1);
    let ends = [JointEnd::world(Vector3::zeros()), JointEnd::on(0, Vector3::zeros())];
    forces.about_axis(ends, Vector3::z(), move |_, _, rate| -damping * rate).unwrap();
    let pose = RigidMotion { translation: Vector3::zeros(), rotation: Rotation::identity() };
    let motion = BodyMotion { pose, velocity: Vector3::zeros(), angular_velocity: Vector3::z() };
    (metric, forces, motion)
}

#[test]
fn damping_is_stable_at_every_step_where_it_is_implicit_and_up_to_its_border_where_explicit() {
    // Spin after 60 steps of 1 s under a damping c, which multiplies it by a factor a step.
    let spin = |method: BodyMethod, damping: f64| {
        let (metric, forces, motion) = braked(damping);
        let mut state = metric.state(&[motion]).unwrap();
        let system = metric.under(Free { freedoms: 6 }).unwrap();
        let mut integrator = method.forced(&system, forces).unwrap();
        for _ in 0..60 {
            integrator.step(&mut state, 1.0).unwrap();
        }
        state.p.0[5].abs()
    };
    for c in [0.5_f64, 3.0, 100.0, 1e6] {
        let expected = ((1.0 - 0.5 * c) / (1.0 + 0.5 * c)).abs().powi(60);
        let found = spin(BodyMethod::ExactRotation, c);
        assert!((found - expected).abs() < 1e-9, "{c}: {found} {expected}");
    }
    for (method, border) in
        [(BodyMethod::RenormalizedEuler, 2.0), (BodyMethod::MuntheKaas4, 2.785_293_563_405_282)]
    {
        assert!(spin(method, 0.99 * border) < 1.0 && spin(method, 1.01 * border) > 1.0, "{method}");
    }
}

#[test]
fn a_step_that_fails_leaves_the_works_of_the_last_one() {
    let (system, mut state) = boxes();
    let mut verlet = LieVerlet::<_, _, ConstantVelocity, _>::forced(&system, everything()).unwrap();
    verlet.step(&mut state, 0.01).unwrap();
    let works = verlet.works().to_vec();
    for h in [1e3, 1e200] {
        verlet.step(&mut state, h).unwrap_err();
        assert_eq!(verlet.works(), works, "{h:e}");
    }
}
