//! Mechanisms of the IFToMM benchmark library.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::Vector3;

use super::{Mechanism, Parts, Strut, placed, still, turned};
use crate::{
    Attachment, Body, BodyMotion, JointEnd, JointKind, LieGroup, RigidError, RigidMotion, Rotation,
};

const GRAVITY: f64 = 9.81;

/// `loops` four-bars in a row, each bar of 1 m and 1 kg, upright, their tops at 1 m/s, for 10 s: parallelograms, all
/// singular where they lie flat. Cranks come first; as a tree the last joint of each parallelogram is left out.
///
/// # Errors
/// None for one loop and more.
pub fn four_bars(loops: usize) -> Result<Mechanism, RigidError> {
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    let cranks = loops + 1;
    let upright = Body::solid_box(1.0, [1e-3, 0.5, 1e-3])?;
    let flat = Body::solid_box(1.0, [0.5, 1e-3, 1e-3])?;
    let mut bodies = vec![upright; cranks];
    bodies.extend(vec![flat; loops]);
    let hinge = |ends: [JointEnd; 2]| (JointKind::Hinge { axis: z }, ends);
    let (mut motions, mut joints) = (Vec::new(), Vec::new());
    let (mut rest, mut closing) = (Vec::new(), Vec::new());
    for k in 0..cranks {
        let pose = placed(x * k as f64 + y * 0.5, Rotation::identity());
        motions.push(BodyMotion { pose, velocity: x * 0.5, angular_velocity: -z });
        joints.push(hinge([JointEnd::world(x * k as f64), JointEnd::on(k, -y * 0.5)]));
    }
    for k in 0..loops {
        let pose = placed(x * (k as f64 + 0.5) + y, Rotation::identity());
        motions.push(BodyMotion { pose, velocity: x, angular_velocity: Vector3::zeros() });
        joints.push(hinge([JointEnd::on(k, y * 0.5), JointEnd::on(cranks + k, -x * 0.5)]));
        let ends = [JointEnd::on(k + 1, y * 0.5), JointEnd::on(cranks + k, x * 0.5)];
        rest.push(hinge(ends));
        closing.push((JointKind::OnLine { axis: z }, ends));
    }
    joints.extend(rest);
    let speeds = (0..cranks + loops).map(|k| if k < cranks { -1.0 } else { 1.0 }).collect();
    let start = [vec![0.0; cranks + loops], speeds];
    let parts = Parts { joints, closing, struts: Vec::new(), torques: Vec::new(), start };
    Mechanism::new(("four-bars", 10.0), bodies, &motions, -y * GRAVITY, parts)
}

/// Bricard's six-bar: five bars of 1 m and 1 kg, 0.1 m thick, along edges of a cube, on six hinges whose equations
/// leave no freedom by number and one in truth, let go for 10 s.
///
/// # Errors
/// None: its numbers are given.
pub fn bricard() -> Result<Mechanism, RigidError> {
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    let corners = [Vector3::zeros(), x, x - y, x - y + z, z - y, z];
    let axes = [y, z, x, y, z, x];
    // A bar's own x leads along its edge.
    let rotations = [
        Rotation::identity(),
        turned(z, -FRAC_PI_2),
        turned(y, -FRAC_PI_2),
        turned(z, PI),
        turned(z, FRAC_PI_2),
    ];
    let body = Body::solid_box(1.0, [0.5, 0.05, 0.05])?;
    let poses: Vec<_> =
        (0..5).map(|k| placed((corners[k] + corners[k + 1]) * 0.5, rotations[k])).collect();
    let end = |body: usize, place: Vector3<f64>| {
        JointEnd::where_it_stands(body, &poses[body], &placed(place, Rotation::identity()))
    };
    let hung = |k: usize| {
        let foot = match k {
            0 => JointEnd::world(corners[0]),
            _ => end(k - 1, corners[k]),
        };
        (JointKind::Hinge { axis: axes[k] }, [foot, end(k, corners[k])])
    };
    let mut joints: Vec<_> = (0..5).map(hung).collect();
    let last = [JointEnd::world(corners[5]), end(4, corners[5])];
    joints.push((JointKind::Hinge { axis: axes[5] }, last));
    // Four of the five rows of the last hinge: the fifth follows from them.
    let closing = vec![(JointKind::Universal { axes: [x, y] }, last)];
    let motions: Vec<_> = poses.iter().copied().map(still).collect();
    let start = [vec![0.0; 5], vec![0.0; 5]];
    let parts = Parts { joints, closing, struts: Vec::new(), torques: Vec::new(), start };
    Mechanism::new(("bricard", 10.0), vec![body; 5], &motions, -y * GRAVITY, parts)
}

/// A flyball governor: a shaft that turns by 0.16 of a turn a second, a slider on it, two rods on its top, 30 degrees
/// below level, that carry 5 kg each, and stiff springs with dampers of `damping` N s/m between, published with 4e4;
/// for 10 s.
///
/// # Errors
/// None: its numbers are given.
pub fn governor(damping: f64) -> Result<Mechanism, RigidError> {
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    let solid = |half: [f64; 3]| Body::solid_box(3000.0 * 8.0 * half.iter().product::<f64>(), half);
    let shaft = solid([0.005, 0.005, 0.5])?;
    let block = solid([0.05; 3])?;
    let rod = solid([0.5, 0.005, 0.005])?;
    // The rod and its ball as one body: the centre lies beyond the rod's middle.
    let ball = 5.0;
    let whole = rod.mass() + ball;
    let shift = ball * 0.5 / whole;
    let across = rod.mass() * shift * shift + ball * (0.5 - shift).powi(2);
    let bare = rod.moments();
    let rod = Body::new(whole, [bare.x, bare.y + across, bare.z + across])?;
    let spin = z * (0.16 * 2.0 * PI);
    let lean = turned(y, PI / 6.0);
    let other = turned(z, PI).compose(&lean);
    let hang = |rotation: &Rotation, side: f64| {
        z + x * (0.05 * side) + rotation.rotate(&x) * (0.5 + shift)
    };
    let middle = placed(z * 0.5, Rotation::identity());
    let poses: [RigidMotion; 4] =
        [middle, middle, placed(hang(&lean, 1.0), lean), placed(hang(&other, -1.0), other)];
    let motions = poses.map(|pose| BodyMotion {
        pose,
        velocity: spin.cross(&pose.translation),
        angular_velocity: pose.rotation.rotate_back(&spin),
    });
    let near = -x * (0.5 + shift);
    let opposite = JointEnd::on(0, z * 0.5 - x * 0.05).turned(turned(z, PI));
    let joints = vec![
        (
            JointKind::Hinge { axis: z },
            [JointEnd::world(Vector3::zeros()), JointEnd::on(0, -z * 0.5)],
        ),
        (
            JointKind::Slider { axis: z },
            [JointEnd::on(0, Vector3::zeros()), JointEnd::on(1, Vector3::zeros())],
        ),
        (
            JointKind::Hinge { axis: y },
            [JointEnd::on(0, z * 0.5 + x * 0.05), JointEnd::on(2, near)],
        ),
        (JointKind::Hinge { axis: y }, [opposite, JointEnd::on(3, near)]),
    ];
    let strut = |on_slider: Vector3<f64>, rod: usize| Strut {
        ends: [Attachment::Body(1, on_slider), Attachment::Body(rod, -x * shift)],
        stiffness: 8e5,
        damping,
        rest: 0.5,
    };
    let start = [vec![0.0, 0.0, PI / 6.0, PI / 6.0], vec![spin.z, 0.0, 0.0, 0.0]];
    let struts = vec![strut(x * 0.05, 2), strut(-x * 0.05, 3)];
    let parts = Parts { joints, closing: Vec::new(), struts, torques: Vec::new(), start };
    let bodies = vec![shaft, block, rod, rod];
    Mechanism::new(("governor", 10.0), bodies, &motions, -z * GRAVITY, parts)
}
