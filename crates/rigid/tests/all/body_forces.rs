//! Forces, drives and springs on bodies: their derivatives, works and momenta, under every stepper.

use nalgebra::Vector3;
use stationary_calculus::{
    Covector, Force, Metric, Potential, ProductSink, Vector, assert_derivatives_on,
};
use stationary_constraints::{
    ConstrainedIntegrator, Constraint, ConstraintError, Forced, Pairing, Rattle, Redundancy,
    SparseDiagonal,
};
use stationary_integrators::{Integrator, State, StepError};
use stationary_measure::loglog_slope;
use stationary_rigid::{
    Along, Attachment, AxisRotations, Body, BodyForces, BodyMethod, BodyMetric, BodyMotion,
    BodySpring, ConstantVelocity, Drive, ExactRotation, Free, FreeBodies, FreeRotation, Joint,
    JointEnd, JointKind, LieGroup, LieVerlet, Orientations, PointMass, PoseEnergy, PoseOf,
    PosePotential, Poses, RigidError, RigidMotion, Rotation, Schedule, Steady, TorsionSpring,
    Weight, spatial_angular_momentum,
};

const POINT: Vector3<f64> = Vector3::new(0.1, 0.4, -0.3);
const OTHER: Vector3<f64> = Vector3::new(-0.2, 0.3, 0.6);
const AXIS: Vector3<f64> = Vector3::new(0.6, 0.0, 0.8);

fn turned(body: usize) -> Rotation {
    Rotation::exp([Vector3::new(0.3, -0.8, 1.1), Vector3::new(-1.0, 0.2, 0.5)][body])
}

fn two_poses() -> Vec<f64> {
    let mut q = vec![0.4, -0.2, 0.9];
    q.extend(turned(0).quaternion());
    q.extend([-0.5, 0.1, 0.3]);
    q.extend(turned(1).quaternion());
    q
}

fn two_orientations() -> Vec<f64> {
    [0, 1].into_iter().flat_map(|body| turned(body).quaternion()).collect()
}

fn ends() -> [[JointEnd; 2]; 2] {
    let second = JointEnd::on(1, OTHER).turned(Rotation::exp(-OTHER));
    [
        [JointEnd::on(0, POINT).turned(Rotation::exp(POINT)), second],
        [JointEnd::world(OTHER), second],
    ]
}

#[test]
fn springs_with_a_rest_and_of_a_turn_or_a_shift_have_right_derivatives() {
    for along in [Along::Turn, Along::Shift] {
        for ends in ends() {
            let spring = TorsionSpring::new(Poses, 2, (along, AXIS), ends, [3.0, 0.4]).unwrap();
            assert_derivatives_on(&Poses, &spring, &two_poses());
            let spring = TorsionSpring::new(Orientations, 2, (along, AXIS), ends, [3.0, 0.4]);
            assert_derivatives_on(&Orientations, &spring.unwrap(), &two_orientations());
        }
    }
    for rest in [0.0, 0.3, 5.0] {
        let ends = [Attachment::Body(0, POINT), Attachment::Body(1, OTHER)];
        let spring = BodySpring::new(Poses, 2, 3.0, ends).unwrap().with_rest_length(rest).unwrap();
        assert_derivatives_on(&Poses, &spring, &two_poses());
    }
}

/// A turn that is not steady.
struct Swing;
impl Schedule for Swing {
    fn at<R: stationary_calculus::Number>(&self, t: R) -> R {
        (t * 1.7).sin() * 0.8
    }
}

#[test]
fn a_drive_has_right_derivatives_along_poses_and_in_time() {
    for along in [Along::Turn, Along::Shift] {
        for ends in ends() {
            let drive = || Drive::new(Poses, 2, along, AXIS, ends, Swing).unwrap();
            assert_derivatives_on(
                &Poses,
                &Pairing::new(drive(), vec![0.7], 0.3).unwrap(),
                &two_poses(),
            );
            let (q, mut rate) = (two_poses(), [0.0]);
            let value = |t: f64| {
                let mut g = [0.0];
                drive().value(t, &q, &mut g).unwrap();
                g[0]
            };
            drive().rate(0.3, &q, &mut rate).unwrap();
            let e = 1e-6;
            assert!((rate[0] - (value(0.3 + e) - value(0.3 - e)) / (2.0 * e)).abs() < 1e-9);
        }
    }
}

/// Everything that acts, on two bodies: dampers, a motor, a load and a torque.
fn everything() -> BodyForces<Poses> {
    let mut forces = BodyForces::new(Poses, 2);
    let ends_of = [Attachment::Body(0, POINT), Attachment::Body(1, OTHER)];
    forces.between_points(ends_of, |_, l, rate| -0.8 * rate * (1.0 + l)).unwrap();
    let tied = [Attachment::World(OTHER), Attachment::Body(1, POINT)];
    forces.between_points(tied, |t, _, rate| 0.3 * t.cos() - 0.2 * rate.powi(3)).unwrap();
    forces
        .about_axis(ends()[0], AXIS, |t, turn, rate| 0.4 * (turn - t).sin() - 0.02 * rate)
        .unwrap();
    let drag = |t: f64, x: Vector3<f64>, v: Vector3<f64>| {
        Vector3::new(0.1, 0.0, t.sin()) - v * (0.3 * v.norm()) + x.cross(&AXIS) * 0.2
    };
    forces.at_point(0, POINT, drag).unwrap();
    let spin = |t: f64, _: Rotation, w: Vector3<f64>| AXIS * (0.2 * t) - w * 0.1;
    forces.on_body(1, spin).unwrap();
    forces
}

fn velocity() -> Vector<Vec<f64>> {
    Vector(vec![0.3, -0.7, 0.2, 1.1, -0.4, 0.6, -0.2, 0.5, 0.9, -0.3, 0.8, 0.1])
}

#[test]
fn the_damping_of_every_force_is_the_symmetric_part_of_its_slope_with_velocity() {
    let (forces, q, v, t) = (everything(), two_poses(), velocity(), 0.7);
    let force = |v: &Vector<Vec<f64>>| {
        let mut f = Covector(vec![0.0; 12]);
        forces.add_force(t, &q, v.view(), f.view_mut());
        f.0
    };
    let e = 1e-5;
    let slope = |i: usize, j: usize| {
        let moved = |e: f64| {
            let mut v = v.clone();
            v.0[j] += e;
            force(&v)[i]
        };
        (moved(-e) - moved(e)) / (2.0 * e)
    };
    for j in 0..12 {
        let (mut unit, mut column) = ([0.0; 12], [0.0; 12]);
        unit[j] = 1.0;
        let mut sink = ProductSink::new(1.0, &unit, &mut column).unwrap();
        forces.add_damping(t, &q, v.view(), &mut sink);
        for (i, entry) in column.iter().enumerate() {
            let expected = 0.5 * (slope(i, j) + slope(j, i));
            assert!((entry - expected).abs() < 1e-7, "({i}, {j}): {entry} {expected}");
        }
    }
}

#[test]
fn the_powers_of_all_things_add_up_to_that_of_the_force_and_of_virtual_work() {
    let (forces, q, v) = (everything(), two_poses(), velocity());
    let mut f = Covector(vec![0.0; 12]);
    forces.add_force(0.7, &q, v.view(), f.view_mut());
    let mut powers = vec![0.0; forces.works()];
    forces.add_powers(0.7, &q, v.view(), v.view(), &mut powers);
    assert_eq!(powers.len(), 5);
    assert!((powers.iter().sum::<f64>() - f.apply(&v)).abs() < 1e-14);
    // A damper's power is -c l'^2 (1 + l): the length's rate by a difference along the motion.
    let length = |s: f64| {
        let mut q = q.clone();
        stationary_calculus::Space::advance(&Poses, &mut q, s, v.view());
        let place = |body: usize, c: &Vector3<f64>| {
            <Poses as stationary_rigid::BodySpace>::pose(&q, body).unwrap().apply(c)
        };
        (place(1, &OTHER) - place(0, &POINT)).norm()
    };
    let rate = (length(1e-5) - length(-1e-5)) / 2e-5;
    assert!((powers[0] + 0.8 * rate * rate * (1.0 + length(0.0))).abs() < 1e-8);
}

type Sprung = stationary_calculus::System<BodyMetric<Poses>, BodySpring<Poses>, Poses>;

/// Two boxes on a spring with a rest.
fn boxes() -> (Sprung, State<Vec<f64>>) {
    let metric = BodyMetric::<Poses>::new(vec![
        Body::solid_box(1.0, [0.1, 0.2, 0.3]).unwrap(),
        Body::solid_box(0.7, [0.3, 0.1, 0.2]).unwrap(),
    ]);
    let at = |x: f64, w| BodyMotion {
        pose: RigidMotion { translation: Vector3::x() * x, rotation: turned(usize::from(x > 0.5)) },
        velocity: Vector3::new(0.1, 0.4 * x, -0.2),
        angular_velocity: w,
    };
    let motions = [at(0.0, Vector3::new(1.0, 0.5, -0.3)), at(1.2, Vector3::new(-0.4, 1.2, 0.6))];
    let initial = metric.state(&motions).unwrap();
    let ends = [Attachment::Body(0, POINT), Attachment::Body(1, OTHER)];
    let spring = BodySpring::new(Poses, 2, 9.0, ends).unwrap().with_rest_length(0.7).unwrap();
    (metric.under(spring).unwrap(), initial)
}

fn far(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |far, (a, b)| f64::max(far, (a - b).abs()))
}

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

/// A bar of 1 kg, half a metre from its hinge, that a drive turns about y under its weight.
fn arm() -> (stationary_calculus::System<BodyMetric<Poses>, Weight<Poses>, Poses>, [JointEnd; 2]) {
    let metric = BodyMetric::<Poses>::new(vec![Body::new(1.0, [0.1, 0.1, 0.01]).unwrap()]);
    let masses = vec![PointMass { mass: 1.0, point: Vector3::zeros() }];
    let weight = Weight { gravity: Vector3::z() * -9.81, masses, space: Poses };
    let ends = [JointEnd::world(Vector3::zeros()), JointEnd::on(0, Vector3::z() * 0.5)];
    (metric.under(weight).unwrap(), ends)
}

fn hanging(angle: f64, speed: f64) -> BodyMotion {
    let rotation = Rotation::exp(Vector3::y() * angle);
    let arm = rotation.rotate(&(Vector3::z() * 0.5));
    BodyMotion {
        pose: RigidMotion { translation: -arm, rotation },
        velocity: (Vector3::y() * speed).cross(&-arm),
        angular_velocity: Vector3::y() * speed,
    }
}

#[test]
fn a_drive_turns_as_told_and_its_torque_and_work_are_those_of_the_closed_form() {
    let (system, ends) = arm();
    let hinge = Joint::new(Poses, 1, JointKind::Hinge { axis: Vector3::y() }, ends).unwrap();
    let inertia = 0.1 + 0.25;
    let points = [100, 200, 400].map(|steps| {
        let h = 2.0 / f64::from(steps);
        let drive = Drive::new(Poses, 1, Along::Turn, Vector3::y(), ends, Swing).unwrap();
        let mut state = system.metric().state(&[hanging(0.0, 0.8 * 1.7)]).unwrap();
        let held = (hinge.clone(), drive);
        let equations = SparseDiagonal(Redundancy::Refuse);
        let motion = FreeBodies(ConstantVelocity);
        let mut rattle = Rattle::along(motion, &system, &held, &state, equations).unwrap();
        let (mut error, mut work, start) = (0.0_f64, 0.0, system.energy(&state.q, state.p.view()));
        for _ in 0..steps {
            let middle = state.t + 0.5 * h;
            work += rattle.step(&mut state, h).unwrap().work;
            let angle = 0.8 * (1.7 * middle).sin();
            let torque = -inertia * 1.7 * 1.7 * angle + 9.81 * 0.5 * angle.sin();
            error = error.max((-rattle.multipliers()[5] - torque).abs());
            let mut g = [0.0; 6];
            held.value(state.t, &state.q, &mut g).unwrap();
            assert!(g.iter().all(|g| g.abs() < 1e-12));
            let energy = system.energy(&state.q, state.p.view());
            assert!((energy - start - work).abs() < 3.0 * h * h, "{} {h}", energy - start - work);
        }
        (h, error)
    });
    let slope = loglog_slope(&points).unwrap();
    assert!((slope - 2.0).abs() < 0.1, "{slope} {points:?}");
}

#[test]
fn a_drive_that_starts_at_another_speed_or_place_is_refused() {
    let (system, ends) = arm();
    let start = |angle: f64, speed: f64| {
        let steady = Steady { start: 0.3, speed: 2.0 };
        let drive = Drive::new(Poses, 1, Along::Turn, Vector3::y(), ends, steady).unwrap();
        let hinge = Joint::new(Poses, 1, JointKind::Hinge { axis: Vector3::y() }, ends).unwrap();
        let state = system.metric().state(&[hanging(angle, speed)]).unwrap();
        let equations = SparseDiagonal(Redundancy::Refuse);
        Rattle::along(FreeBodies(ExactRotation), &system, (hinge, drive), &state, equations).err()
    };
    assert!(start(0.3, 2.0).is_none());
    assert!(matches!(start(0.3, 0.0), Some(ConstraintError::InfeasibleVelocity { .. })));
    assert!(matches!(start(0.0, 2.0), Some(ConstraintError::Infeasible { .. })));
}

#[test]
fn rattle_keeps_its_order_and_its_balance_of_energy_under_a_motor_and_a_damper() {
    let (system, ends) = arm();
    let hinge = Joint::new(Poses, 1, JointKind::Hinge { axis: Vector3::y() }, ends).unwrap();
    let initial = system.metric().state(&[hanging(0.4, 0.0)]).unwrap();
    let run = |steps: u32, every: u32| {
        let mut forces = BodyForces::new(Poses, 1);
        forces
            .about_axis(ends, Vector3::y(), |t, a, rate| (2.0 * t).sin() - 0.3 * a - 0.2 * rate)
            .unwrap();
        let drag = |_: f64, _: Vector3<f64>, v: Vector3<f64>| v * (-0.3 * v.norm());
        forces.at_point(0, Vector3::z() * -0.4, drag).unwrap();
        let motion = Forced::new(FreeBodies(ConstantVelocity), forces);
        let equations = SparseDiagonal(Redundancy::Refuse);
        let mut rattle = Rattle::along(motion, &system, &hinge, &initial, equations).unwrap();
        let (mut state, h) = (initial.clone(), 3.0 / f64::from(steps));
        let (mut seen, mut works, mut defect) = (Vec::new(), [0.0; 2], 0.0_f64);
        for step in 1..=steps {
            rattle.step(&mut state, h).unwrap();
            works.iter_mut().zip(rattle.motion().works()).for_each(|(sum, w)| *sum += w);
            let energy = |s: &State<Vec<f64>>| system.energy(&s.q, s.p.view());
            let change = energy(&state) - energy(&initial);
            defect = defect.max((change - works[0] - works[1]).abs());
            if step % every == 0 {
                seen.extend(state.q.iter().chain(&state.p.0));
            }
        }
        assert!(works[1] < -0.01, "drag only takes: {works:?}");
        (seen, defect)
    };
    let truth = run(6400, 800).0;
    let steps = [48, 96, 192, 384];
    let found = steps.map(|steps| (steps, run(steps, steps / 8)));
    for values in [
        found.each_ref().map(|(n, (seen, _))| (1.0 / f64::from(*n), far(seen, &truth))),
        found.each_ref().map(|(n, (_, defect))| (1.0 / f64::from(*n), *defect)),
    ] {
        let slope = loglog_slope(&values).unwrap();
        assert!((slope - 2.0).abs() < 0.12, "{slope} {values:?}");
    }
}

/// Wilberforce's pendulum at resonance: stretch and twist of one spring, coupled.
struct Wilberforce;
impl PoseEnergy<1> for Wilberforce {
    fn energy<R: stationary_calculus::Number>(&self, [bob]: [PoseOf<R>; 1]) -> R {
        let (z, turn) = (bob.position[2], bob.turn_about([0.0, 0.0, 1.0]));
        (z * z * 2.0 + turn * turn * 2e-4 + z * turn * 2e-3) * 0.5
    }
}

#[test]
fn a_wilberforce_pendulum_beats_as_its_two_modes_say() {
    // Mass 0.5 kg and inertia 5e-5 kg m^2: both alone swing at 2 rad/s.
    let metric = BodyMetric::<Poses>::new(vec![Body::new(0.5, [4e-5, 4e-5, 5e-5]).unwrap()]);
    let pose = RigidMotion { translation: Vector3::z() * 0.01, rotation: Rotation::identity() };
    let still = BodyMotion { pose, velocity: Vector3::zeros(), angular_velocity: Vector3::zeros() };
    let initial = metric.state(&[still]).unwrap();
    let potential = PosePotential::new(Poses, 1, [0], Wilberforce).unwrap();
    assert_derivatives_on(&Poses, &potential, &initial.q);
    assert_derivatives_on(&Poses, &potential, &two_poses()[..7]);
    let system = metric.under(potential).unwrap();
    let coupling = 1e-3 / (0.5_f64 * 5e-5).sqrt();
    let modes = [4.0 + coupling, 4.0 - coupling].map(f64::sqrt);
    let points = [2000_u32, 4000, 8000].map(|steps| {
        let h = 40.0 / f64::from(steps);
        let mut verlet = LieVerlet::<_, _, ExactRotation>::new(&system).unwrap();
        let (mut state, mut error, mut least) = (initial.clone(), 0.0_f64, f64::INFINITY);
        for step in 1..=steps {
            verlet.step(&mut state, h).unwrap();
            let t = h * f64::from(step);
            let z = 0.005 * ((modes[0] * t).cos() + (modes[1] * t).cos());
            error = error.max((state.q[2] - z).abs());
            let swing = 0.5 * state.p.0[2].powi(2) / 0.5 + state.q[2].powi(2);
            least = least.min(swing);
        }
        assert!(least < 1e-3 * 1e-4, "all of the energy goes into the twist once: {least}");
        (h, error)
    });
    let slope = loglog_slope(&points).unwrap();
    assert!((slope - 2.0).abs() < 0.05, "{slope} {points:?}");
}

#[test]
fn forces_that_cannot_be_are_refused_by_name() {
    let mut forces = BodyForces::new(Poses, 1);
    let none = |_: f64, _: f64, _: f64| 0.0;
    let absent = [Attachment::Body(1, POINT), Attachment::World(OTHER)];
    let error = forces.between_points(absent, none).unwrap_err();
    assert_eq!(error, RigidError::NoSuchBody { body: 1, bodies: 1 });
    let here = [JointEnd::world(POINT), JointEnd::on(0, OTHER)];
    let error = forces.about_axis(here, Vector3::zeros(), none).unwrap_err().to_string();
    assert!(error.starts_with("motor between the world and body 0: axis"), "{error}");
    let steady = Steady { start: 0.0, speed: f64::NAN };
    let itself = [JointEnd::on(0, POINT), JointEnd::on(0, OTHER)];
    let error = Drive::new(Poses, 1, Along::Turn, AXIS, itself, steady).unwrap_err().to_string();
    assert!(error.starts_with("turning drive between body 0 and body 0: it holds"), "{error}");
    let spring =
        BodySpring::new(Poses, 1, 1.0, [Attachment::World(POINT), Attachment::World(OTHER)]);
    let error = spring.unwrap().with_rest_length(-1.0).unwrap_err();
    assert!(matches!(error, RigidError::Negative { value: -1.0, .. }));
    // Of another number of bodies, and a law that is no number: typed, and the state stays.
    let (system, initial) = boxes();
    assert!(LieVerlet::<_, _, ExactRotation, _>::forced(&system, forces).is_err());
    let mut wild = BodyForces::new(Poses, 2);
    wild.on_body(0, |_, _, _| Vector3::repeat(f64::NAN)).unwrap();
    for &method in BodyMethod::ALL {
        let mut state = initial.clone();
        let error = method.forced(&system, wild.clone()).unwrap().step(&mut state, 0.1);
        let named = [
            matches!(error, Err(StepError::Newton(_))),
            matches!(error, Err(StepError::NonFiniteMomentum { .. })),
            matches!(error, Err(StepError::NonFiniteConfiguration { .. })),
        ];
        assert!(named.contains(&true), "{method}: {error:?}");
        assert_eq!(state, initial);
    }
}

#[test]
fn points_that_meet_are_damped_along_their_way_through_each_other() {
    let mut forces = BodyForces::new(Poses, 2);
    let points = [Attachment::Body(0, Vector3::zeros()), Attachment::Body(1, Vector3::zeros())];
    forces.between_points(points, |_, _, rate| -2.0 * rate).unwrap();
    let mut q = two_poses();
    q.copy_within(0..3, 7);
    let (v, mut f) = (velocity(), Covector(vec![0.0; 12]));
    forces.add_force(0.0, &q, v.view(), f.view_mut());
    for k in 0..3 {
        assert!((f.0[k] - 2.0 * (v.0[6 + k] - v.0[k])).abs() < 1e-15);
        assert!((f.0[6 + k] + f.0[k]).abs() < 1e-15);
    }
    assert!(Metric::dim(boxes().0.metric()) == 12 && boxes().0.potential().dim() == 12);
}

#[test]
fn rattle_under_a_damper_of_any_stiffness_runs_and_only_loses_energy() {
    let (system, ends) = arm();
    let hinge = Joint::new(Poses, 1, JointKind::Hinge { axis: Vector3::y() }, ends).unwrap();
    for damping in [1.0, 3.0, 100.0, 1e6] {
        // In units of the inertia 0.35 about the hinge, over a step of 0.1 s.
        let c = damping * 0.35 / 0.1;
        let mut forces = BodyForces::new(Poses, 1);
        forces.about_axis(ends, Vector3::y(), move |_, _, rate| -c * rate).unwrap();
        let initial = system.metric().state(&[hanging(0.4, 1.0)]).unwrap();
        let motion = Forced::new(FreeBodies(ConstantVelocity), forces);
        let equations = SparseDiagonal(Redundancy::Refuse);
        let mut rattle = Rattle::along(motion, &system, &hinge, &initial, equations).unwrap();
        let (mut state, start) = (initial.clone(), system.energy(&initial.q, initial.p.view()));
        for _ in 0..50 {
            rattle.step(&mut state, 0.1).unwrap();
            assert!(system.energy(&state.q, state.p.view()) < start + 1e-9, "{damping}");
        }
    }
}

#[test]
fn a_step_with_forces_allocates_nothing() {
    let (system, initial) = boxes();
    let mut verlet = LieVerlet::<_, _, ConstantVelocity, _>::forced(&system, everything()).unwrap();
    let mut state = initial.clone();
    verlet.step(&mut state, 0.01).unwrap();
    let count = allocation_counter::measure(|| {
        (0..10).for_each(|_| assert!(verlet.step(&mut state, 0.01).is_ok()));
    });
    assert_eq!(count.count_total, 0, "{count:?}");
    let (system, ends) = arm();
    let hinge = Joint::new(Poses, 1, JointKind::Hinge { axis: Vector3::y() }, ends).unwrap();
    let drive = Drive::new(Poses, 1, Along::Turn, Vector3::y(), ends, Swing).unwrap();
    let mut forces = BodyForces::new(Poses, 1);
    forces.at_point(0, POINT, |t, x, v| x * t.sin() - v).unwrap();
    let motion = Forced::new(FreeBodies(ConstantVelocity), forces);
    let mut state = system.metric().state(&[hanging(0.0, 0.8 * 1.7)]).unwrap();
    let equations = SparseDiagonal(Redundancy::Refuse);
    let mut rattle = Rattle::along(motion, &system, (hinge, drive), &state, equations).unwrap();
    rattle.step(&mut state, 0.01).unwrap();
    let count = allocation_counter::measure(|| {
        (0..10).for_each(|_| assert!(rattle.step(&mut state, 0.01).is_ok()));
    });
    assert_eq!(count.count_total, 0, "{count:?}");
}
