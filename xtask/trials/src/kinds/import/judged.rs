//! A scene against what a robot's scene must be.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use stationary_import::{Description, ImportError};
use stationary_scene::{JointKind, RigidBody, Scene, SceneJoint};

use super::robot::{Free, Robot, TrueBody, TrueJoint};
use crate::Verdict;

/// What is promised, of the size of what is compared.
const PROMISED: f64 = 1e-12;

/// The verdict on a scene of the robot.
pub(super) fn judged(robot: &Robot, read: Result<Description, ImportError>) -> Verdict {
    let read = match read {
        Ok(read) => read,
        Err(error) => return Verdict::refused(error),
    };
    if !read.left_out.is_empty() {
        return Verdict::wrong(format!("left out: {:?}", read.left_out));
    }
    let scene = match Scene::parse("robot.toml", &read.text) {
        Ok(scene) => scene,
        Err(error) => return Verdict::wrong(format!("no scene: {error}")),
    };
    let bodies = robot.bodies();
    if scene.bodies().len() != bodies.len() {
        return Verdict::wrong(format!("{} bodies, not {}", scene.bodies().len(), bodies.len()));
    }
    let size = robot.size();
    let mut off = 0.0_f64;
    for expected in &bodies {
        let Some(own) = scene.bodies().iter().find(|own| own.name == expected.name) else {
            return Verdict::wrong(format!("no body `{}`", expected.name));
        };
        off = largest([off, body_off(own, expected, size)]);
    }
    let joints = robot.joints();
    if scene.joints().len() != joints.len() {
        return Verdict::wrong(format!("{} joints, not {}", scene.joints().len(), joints.len()));
    }
    for expected in &joints {
        let ends = |joint: &SceneJoint| {
            joint.between.map(|end| end.map(|body| scene.bodies()[body].name.clone()))
        };
        let Some(own) = scene.joints().iter().find(|own| ends(own) == expected.between) else {
            return Verdict::wrong(format!("no joint between {:?}", expected.between));
        };
        match joint_off(robot, own, expected, size) {
            Some(joint) => off = largest([off, joint]),
            None => return Verdict::wrong(format!("another joint at {:?}", expected.between)),
        }
    }
    Verdict::of(off, PROMISED, "the scene")
}

/// The largest; what is no number is larger than all.
fn largest<const N: usize>(numbers: [f64; N]) -> f64 {
    numbers.into_iter().fold(0.0, |most, x| if x.is_nan() { f64::INFINITY } else { most.max(x) })
}

fn body_off(own: &RigidBody, expected: &TrueBody, size: f64) -> f64 {
    let turn = UnitQuaternion::from_scaled_axis(Vector3::from(own.rotation)).to_rotation_matrix();
    let tensor = turn.matrix() * Matrix3::from_diagonal(&own.moments.into()) * turn.inverse();
    let place = (Vector3::from(own.position) - expected.centre).amax() / size;
    // A centre that is off by rounding of the size moves the tensor by as much.
    let tensor = (tensor - expected.tensor).amax() / (expected.size + expected.mass * size * size);
    largest([(own.mass / expected.mass - 1.0).abs(), place, tensor])
}

/// How far off it is; nothing where it is of another kind.
fn joint_off(robot: &Robot, own: &SceneJoint, expected: &TrueJoint, size: f64) -> Option<f64> {
    let link = &robot.links[expected.of];
    let kind = match link.free {
        Free::Ball => JointKind::Ball,
        Free::Turn => JointKind::Hinge,
        Free::Shift => JointKind::Slider,
        Free::Nothing | Free::All => return None,
    };
    if own.kind != kind || own.limits.is_some() != link.limits.is_some() {
        return None;
    }
    let axis = match link.free {
        Free::Ball => 0.0,
        _ => (Vector3::from(own.axis) - expected.axis).amax(),
    };
    // A turn is of the order of one, and of more where it is measured from elsewhere.
    let reach = if link.free == Free::Turn { 10.0 } else { size };
    let limits = own.limits.zip(link.limits).map_or(0.0, |(own, limits)| {
        largest([(own[0] - limits[0]).abs(), (own[1] - limits[1]).abs()]) / reach
    });
    let of = |own: f64, expected: f64| (own - expected).abs() / expected.abs().max(1e-300);
    Some(largest([
        (Vector3::from(own.place) - expected.place).amax() / size,
        axis,
        limits,
        (own.rest - link.rest).abs() / 10.0,
        of(own.stiffness, link.stiffness),
        of(own.damping, link.damping),
        of(own.friction, link.friction),
    ]))
}
