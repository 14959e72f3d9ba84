//! Places and forces between adaptive steps, against those at an instant and against small steps.

use nalgebra::Vector3;
use stationary_calculus::{Metric, System, Vector};
use stationary_constraints::{
    Adaptive, Composed, ConstrainedIntegrator, Constraint, Rattle, Redundancy, SparseDiagonal,
    StepTolerance,
};
use stationary_integrators::{Scheme, State};
use stationary_measure::{SplitMix64, loglog_slope};
use stationary_rigid::{
    Body, BodyForces, BodyMetric, BodyMotion, ExactRotation, FreeBodies, Joint, JointEnd,
    JointKind, LieGroup, PointMass, Poses, RigidMotion, Rotation, Weight, instant,
};

type Weighed = System<BodyMetric<Poses>, Weight<Poses>, Poses>;

/// A body on a universal joint, and another on a ball below it, at rest and aslant.
fn double() -> (Weighed, Vec<Joint<Poses>>, State<Vec<f64>>) {
    let body = Body::new(1.0, [0.1, 0.2, 0.15]).unwrap();
    let masses = vec![PointMass { mass: 1.0, point: Vector3::zeros() }; 2];
    let weight = Weight { gravity: Vector3::z() * -9.81, masses, space: Poses };
    let system = BodyMetric::new(vec![body; 2]).under(weight).unwrap();
    let z = Vector3::z() * 0.5;
    let axes = [Vector3::x(), Vector3::y()];
    let joints = vec![
        Joint::new(
            Poses,
            2,
            JointKind::Universal { axes },
            [JointEnd::world(Vector3::zeros()), JointEnd::on(0, z)],
        ),
        Joint::new(Poses, 2, JointKind::Ball, [JointEnd::on(0, -z), JointEnd::on(1, z)]),
    ];
    let joints = joints.into_iter().collect::<Result<Vec<_>, _>>().unwrap();
    let first = Rotation::exp(axes[0] * 0.9).compose(&Rotation::exp(axes[1] * 0.6));
    let second = Rotation::exp(Vector3::new(0.3, -0.8, 0.2));
    let at = |translation, rotation| BodyMotion {
        pose: RigidMotion { translation, rotation },
        velocity: Vector3::zeros(),
        angular_velocity: Vector3::zeros(),
    };
    let motions =
        [at(-first.rotate(&z), first), at(-first.rotate(&z) * 2.0 - second.rotate(&z), second)];
    let state = system.metric().state(&motions).unwrap();
    (system, joints, state)
}

#[test]
fn forces_and_places_between_steps_are_those_of_an_instant_and_of_small_steps() {
    let (system, joints, initial) = double();
    let choice = SparseDiagonal(Redundancy::Refuse);
    let free = FreeBodies(ExactRotation);
    let rattle = || Rattle::along(free, &system, &joints, &initial, choice).unwrap();
    // Small steps of order 8 to the next of the times.
    let fine = |state: &mut State<Vec<f64>>, until: f64| {
        let mut method = Composed::new(rattle(), Scheme::KahanLi8, &initial).unwrap();
        let (from, steps) = (state.t, ((until - state.t) / 5e-3).ceil());
        for _ in 0..steps as u32 {
            method.step(state, (until - from) / steps).unwrap();
        }
        state.t = until;
    };
    let none = BodyForces::new(Poses, 2);
    let errors = |tolerance: f64| {
        let composed = Composed::new(rattle(), Scheme::Suzuki4, &initial).unwrap();
        let tolerance = StepTolerance { absolute: tolerance, relative: 0.0 };
        let mut method = Adaptive::new(composed, tolerance, 0.01, &initial).unwrap();
        let (mut state, mut truth) = (initial.clone(), initial.clone());
        let (mut noise, mut largest, mut steps) = (SplitMix64::new(8), [0.0_f64; 3], 0);
        while state.t < 1.0 {
            let step = method.advance(&mut state, 1.0).unwrap();
            steps += 1;
            let t = step.from + (0.5 + 0.5 * noise.symmetric()) * (step.to - step.from);
            let (mut between, mut lambda) = (initial.clone(), vec![0.0; joints.count()]);
            method.at(t, &mut between, &mut lambda).unwrap();
            if t - truth.t > 1e-3 {
                fine(&mut truth, t);
                let off = between.q.iter().zip(&truth.q).map(|(a, b)| (a - b).abs());
                largest[0] = off.fold(largest[0], f64::max);
            }
            let mut g = vec![0.0; joints.count()];
            joints.value(t, &between.q, &mut g).unwrap();
            largest[2] = g.iter().fold(largest[2], |g, x| g.max(x.abs()));
            let mut v = Vector(vec![0.0; 12]);
            system.metric().sharp(between.p.view(), v.view_mut());
            let exact = instant(&system, &joints, &none, (t, &between.q, &v.0)).unwrap();
            let off = exact.multipliers.iter().zip(&lambda).map(|(a, b)| (a - b).abs());
            largest[1] = off.fold(largest[1], f64::max);
        }
        (largest, 1.0 / f64::from(steps))
    };
    let runs = [1e-5, 1e-7, 1e-9].map(errors);
    println!("{runs:?}");
    assert!(runs.iter().all(|(largest, _)| largest[2] < 1e-12));
    let slopes = [0, 1].map(|k| loglog_slope(&runs.map(|(off, h)| (h, off[k]))).unwrap());
    assert!(slopes[0] > 3.5 && slopes[1] > 1.7, "{slopes:?} {runs:?}");
}
