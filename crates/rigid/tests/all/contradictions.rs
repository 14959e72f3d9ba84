//! Joints that contradict each other: two between the same bodies, of every pair of kinds, and two drives.

use nalgebra::Vector3;
use stationary_calculus::System;
use stationary_constraints::{Constraint, ConstraintError, Rattle, Redundancy, SparseDiagonal};
use stationary_integrators::State;
use stationary_rigid::{
    Along, Body, BodyForces, BodyMetric, BodyMotion, ConstantVelocity, Drive, FreeBodies, Joint,
    JointEnd, JointKind, LieGroup, MechanismError, PointMass, Poses, RigidMotion, Rotation, Steady,
    Weight, assemble, instant,
};

use crate::joints::{KINDS, OTHER, POINT, apart, ends, left_free, numbers};

type Weighed = System<BodyMetric<Poses>, Weight<Poses>, Poses>;

fn bodies(count: usize) -> Weighed {
    let body = Body::new(1.0, [0.1, 0.2, 0.15]).unwrap();
    let masses = vec![PointMass { mass: 1.0, point: Vector3::zeros() }; count];
    let weight = Weight { gravity: Vector3::z() * -9.81, masses, space: Poses };
    BodyMetric::new(vec![body; count]).under(weight).unwrap()
}

/// The ends of a second joint, 5 m and a turn off those of the first.
fn displaced() -> [JointEnd; 2] {
    let [first, second] = ends()[0];
    let off = RigidMotion {
        translation: Vector3::new(2.0, -4.0, 2.2),
        rotation: Rotation::exp(Vector3::new(0.4, -0.7, 0.9)),
    };
    [JointEnd { frame: first.frame.compose(&off), ..first }, second]
}

#[test]
fn two_joints_that_cannot_both_be_closed_are_refused_by_name_for_every_pair_of_kinds() {
    let (mut closed, mut open) = (0, 0);
    for first in KINDS {
        for second in KINDS {
            let joints = vec![
                Joint::new(Poses, 2, first, ends()[0]).unwrap(),
                Joint::new(Poses, 2, second, displaced()).unwrap(),
            ];
            let told = format!("{} and {}", joints[0].name(), joints[1].name());
            let system = bodies(2);
            let guess = numbers(apart(&ends()[0], &left_free(&first)[1]));
            // As it stands the first is closed and the second is not: no motion starts there.
            let start = State::new(guess.clone(), stationary_calculus::Covector(vec![0.0; 12]));
            let free = FreeBodies(ConstantVelocity);
            let shared = SparseDiagonal(Redundancy::LeastNorm);
            let error = Rattle::along(free, &system, &joints, &start, shared).unwrap_err();
            let ConstraintError::Infeasible { row, .. } = error else { panic!("{told}: {error}") };
            let name = joints.describe(row).unwrap();
            assert!(name.contains(&joints[1].name().to_string()), "{told}: {name}");
            match assemble(system.metric(), &joints, 0.0, &guess) {
                Ok(found) => {
                    let mut g = vec![0.0; joints.count()];
                    joints.value(0.0, &found.q, &mut g).unwrap();
                    assert!(g.iter().all(|g| g.abs() < 1e-11), "{told}: {g:?}");
                    // What a weld holds is open by as much as the frames are off.
                    let held = [first, second].contains(&JointKind::Weld);
                    assert!(!held, "{told}: closed");
                    closed += 1;
                }
                Err(
                    MechanismError::NotAssembled { name, gap, .. }
                    | MechanismError::TooFar { name, gap, .. },
                ) => {
                    assert!(
                        gap > 1e-11 && name.contains("between body 0 and body 1"),
                        "{told}: {name}"
                    );
                    open += 1;
                }
                Err(other) => panic!("{told}: {other}"),
            }
        }
    }
    // Such as a point on a line and a plane that the line meets.
    assert!(closed >= 2 && open > 100, "{closed} {open}");
}

#[test]
fn two_drives_of_one_coordinate_at_different_speeds_are_refused() {
    let system = bodies(1);
    let z = Vector3::z() * 0.5;
    let hung = [JointEnd::world(Vector3::zeros()), JointEnd::on(0, z)];
    let hinge = Joint::new(Poses, 1, JointKind::Hinge { axis: Vector3::y() }, hung).unwrap();
    let drive = |speed| {
        let steady = Steady { start: 0.0, speed };
        Drive::new(Poses, 1, Along::Turn, Vector3::y(), hung, steady).unwrap()
    };
    let turning = |speed: f64| BodyMotion {
        pose: RigidMotion { translation: -z, rotation: Rotation::identity() },
        velocity: (Vector3::y() * speed).cross(&-z),
        angular_velocity: Vector3::y() * speed,
    };
    let state = system.metric().state(&[turning(0.7)]).unwrap();
    let begin = |speeds: [f64; 2], redundancy| {
        let held = (hinge.clone(), vec![drive(speeds[0]), drive(speeds[1])]);
        let choice = SparseDiagonal(redundancy);
        Rattle::along(FreeBodies(ConstantVelocity), &system, held, &state, choice).map(|_| ())
    };
    assert_eq!(begin([0.7, 0.7], Redundancy::LeastNorm), Ok(()));
    let singular = begin([0.7, 0.7], Redundancy::Refuse).unwrap_err();
    assert!(matches!(singular, ConstraintError::Singular { .. }), "{singular}");
    let error = begin([0.7, 0.9], Redundancy::LeastNorm).unwrap_err();
    assert!(matches!(error, ConstraintError::InfeasibleVelocity { row: 6, .. }), "{error}");
}

/// A schedule that gathers speed.
#[derive(Clone, Copy, Debug)]
struct Gathering(f64);

impl stationary_rigid::Schedule for Gathering {
    fn at<R: stationary_calculus::Number>(&self, t: R) -> R {
        t * t * self.0
    }
}

#[test]
fn drives_that_ask_for_different_accelerations_have_no_forces_at_an_instant() {
    let system = bodies(1);
    let hung = [JointEnd::world(OTHER), JointEnd::on(0, POINT)];
    let slider = Joint::new(Poses, 1, JointKind::Slider { axis: Vector3::x() }, hung).unwrap();
    let drive =
        |rate| Drive::new(Poses, 1, Along::Shift, Vector3::x(), hung, Gathering(rate)).unwrap();
    let pose = RigidMotion { translation: OTHER - POINT, rotation: Rotation::identity() };
    let q = numbers([pose, pose])[..7].to_vec();
    let none = BodyForces::new(Poses, 1);
    let at = |rates: [f64; 2]| {
        let held = (slider.clone(), vec![drive(rates[0]), drive(rates[1])]);
        instant(&system, &held, &none, (0.0, &q, &[0.0; 6]))
    };
    let agreed = at([0.4, 0.4]).unwrap();
    assert!((agreed.accelerations[0] - 0.8).abs() < 1e-8, "{agreed:?}");
    let error = at([0.4, 0.5]).unwrap_err();
    assert!(matches!(error, MechanismError::Contradictory { .. }), "{error}");
}
