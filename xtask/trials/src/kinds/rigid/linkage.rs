//! Random bodies on random joints: open chains, loops of hinges that have more equations than they
//! need (planar ones, and Bennett's in space), and pendulums beside them.
//!
//! ```text
//! Bennett:   lengths a b a b, twists alpha beta alpha beta,   sin(alpha)/a = sin(beta)/b
//!            F_i+1 = F_i Rz(theta_i) Tx(a_i) Rx(alpha_i),     F_4 = F_0
//! ```

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use stationary_rigid::{
    Body, Joint, JointEnd, JointKind, LieGroup, Poses, RigidError, RigidMotion, Rotation,
};

use crate::Draw;

/// What a joint leaves free; axes in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Held {
    Ball,
    Hinge(Vector3<f64>),
    Fixed,
    Slider(Vector3<f64>),
    Cylinder(Vector3<f64>),
    Universal([Vector3<f64>; 2]),
}

/// A joint at a point of the world; no body is the world itself.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pin {
    pub(super) ends: [Option<usize>; 2],
    pub(super) point: Vector3<f64>,
    pub(super) held: Held,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shape {
    /// One body on a ball joint.
    Single,
    Chain,
    PlanarLoop,
    Bennett,
}

#[derive(Clone, Debug)]
pub(super) struct Linkage {
    pub(super) shape: Shape,
    pub(super) bodies: Vec<Body>,
    pub(super) poses: Vec<RigidMotion>,
    pub(super) pins: Vec<Pin>,
    pub(super) hung: bool,
}

fn direction(draw: &mut Draw) -> Vector3<f64> {
    let v = Vector3::new(draw.symmetric(), draw.symmetric(), draw.symmetric());
    if v.norm() < 1e-3 { Vector3::z() } else { v.normalize() }
}

fn rotation(draw: &mut Draw) -> Rotation {
    Rotation::exp(direction(draw) * (3.0 * draw.unit()))
}

fn random_box(draw: &mut Draw, ratio: f64) -> Body {
    let half = [0; 3].map(|_| draw.log_uniform(0.05, 0.5));
    let mass = draw.log_uniform(1.0, ratio);
    // Half sizes and masses that any box may have.
    Body::solid_box(mass, half).expect("a box")
}

impl Linkage {
    pub(super) fn draw(draw: &mut Draw) -> Self {
        let shape = draw.one_of(&[
            Shape::Single,
            Shape::Chain,
            Shape::Chain,
            Shape::PlanarLoop,
            Shape::Bennett,
        ]);
        let ratio = draw.one_of(&[1.0 + 1e-9, 1.0 + 1e-9, 1e1, 1e3, 1e6]);
        let mut linkage =
            Linkage { shape, bodies: vec![], poses: vec![], pins: vec![], hung: true };
        match shape {
            Shape::Single => {
                let point = direction(draw) * draw.log_uniform(1e-3, 1.0);
                linkage.hang(draw, ratio, Vector3::zeros(), point, Held::Ball);
            }
            Shape::Chain => linkage.chain(draw, ratio),
            Shape::PlanarLoop => {
                let turned = rotation(draw);
                let flat = |draw: &mut Draw| {
                    turned.rotate(&Vector3::new(draw.symmetric(), draw.symmetric(), 0.0))
                };
                let points = [0; 4].map(|_| flat(draw));
                let axis = turned.rotate(&Vector3::z());
                linkage.close(draw, ratio, points, [axis; 4]);
            }
            Shape::Bennett => {
                let (points, axes) = bennett(draw);
                linkage.close(draw, ratio, points, axes);
            }
        }
        if matches!(shape, Shape::PlanarLoop | Shape::Bennett) {
            for k in 0..draw.below(4) {
                let at = Vector3::x() * (5.0 + 3.0 * k as f64);
                let arm = direction(draw) * draw.log_uniform(0.2, 1.0);
                let held = match draw.chance(0.5) {
                    true => Held::Ball,
                    false => Held::Hinge(arm.cross(&direction(draw)).normalize()),
                };
                linkage.hang(draw, ratio, at, at - arm, held);
            }
        }
        linkage
    }

    /// A body whose centre is at a point, held where it hangs.
    fn hang(
        &mut self,
        draw: &mut Draw,
        ratio: f64,
        at: Vector3<f64>,
        centre: Vector3<f64>,
        held: Held,
    ) {
        let ends = [None, Some(self.bodies.len())];
        self.bodies.push(random_box(draw, ratio));
        self.poses.push(RigidMotion { translation: centre, rotation: rotation(draw) });
        self.pins.push(Pin { ends, point: at, held });
    }

    fn chain(&mut self, draw: &mut Draw, ratio: f64) {
        self.hung = draw.chance(0.5);
        let n = draw.between(2, 4);
        let mut at = Vector3::zeros();
        for k in 0..n {
            let along = direction(draw) * draw.log_uniform(0.2, 1.0);
            let across = direction(draw);
            let held = match draw.below(6) {
                0 => Held::Ball,
                1 => Held::Hinge(across),
                2 => Held::Fixed,
                3 => Held::Slider(across),
                4 => Held::Cylinder(across),
                _ => Held::Universal([across, across.cross(&direction(draw)).normalize()]),
            };
            if k > 0 || self.hung {
                let before = (k > 0).then(|| k - 1);
                let held = if k == 0 && held == Held::Fixed { Held::Ball } else { held };
                self.pins.push(Pin { ends: [before, Some(k)], point: at, held });
            }
            self.bodies.push(random_box(draw, ratio));
            self.poses
                .push(RigidMotion { translation: at + along * 0.5, rotation: rotation(draw) });
            at += along;
        }
    }

    /// Three bodies and the world on four hinges.
    fn close(
        &mut self,
        draw: &mut Draw,
        ratio: f64,
        points: [Vector3<f64>; 4],
        axes: [Vector3<f64>; 4],
    ) {
        for k in 0..3 {
            self.bodies.push(random_box(draw, ratio));
            let translation = (points[k] + points[k + 1]) * 0.5;
            self.poses.push(RigidMotion { translation, rotation: rotation(draw) });
        }
        for k in 0..4_usize {
            let ends = [k.checked_sub(1), (k < 3).then_some(k)];
            self.pins.push(Pin { ends, point: points[k], held: Held::Hinge(axes[k]) });
        }
    }

    /// The crate's joints for these pins.
    pub(super) fn joints(&self) -> Result<Vec<Joint<Poses>>, RigidError> {
        let one = |pin: &Pin| {
            let frame = RigidMotion { translation: pin.point, rotation: Rotation::identity() };
            let ends = pin.ends.map(|body| match body {
                None => JointEnd { body, frame },
                Some(k) => JointEnd::where_it_stands(k, &self.poses[k], &frame),
            });
            let kind = match pin.held {
                Held::Ball => JointKind::Ball,
                Held::Hinge(axis) => JointKind::Hinge { axis },
                Held::Fixed => JointKind::Weld,
                Held::Slider(axis) => JointKind::Slider { axis },
                Held::Cylinder(axis) => JointKind::Cylinder { axis },
                Held::Universal(axes) => JointKind::Universal { axes },
            };
            Joint::new(Poses, self.bodies.len(), kind, ends)
        };
        self.pins.iter().map(one).collect()
    }

    pub(super) fn mass_ratio(&self) -> f64 {
        let masses = || self.bodies.iter().map(Body::mass);
        masses().fold(0.0, f64::max) / masses().fold(f64::INFINITY, f64::min)
    }

    /// How far joints are open at poses: gaps in metres, and angles.
    pub(super) fn opening(&self, poses: &[RigidMotion]) -> f64 {
        let carried = |body: Option<usize>, point: Vector3<f64>| match body {
            None => point,
            Some(k) => {
                let arm = point - self.poses[k].translation;
                poses[k].translation + self.turned(poses, k, arm)
            }
        };
        let mut worst = 0.0_f64;
        for pin in &self.pins {
            let seen =
                |end: usize, v: Vector3<f64>| pin.ends[end].map_or(v, |k| self.turned(poses, k, v));
            let [a, b] = pin.ends.map(|body| carried(body, pin.point));
            let apart = match pin.held {
                Held::Slider(axis) | Held::Cylinder(axis) => seen(0, axis).cross(&(a - b)),
                _ => a - b,
            };
            worst = worst.max(apart.norm());
            let parallel = match pin.held {
                Held::Ball | Held::Universal(_) => vec![],
                Held::Hinge(axis) | Held::Cylinder(axis) => vec![axis],
                Held::Fixed | Held::Slider(_) => vec![Vector3::x(), Vector3::y()],
            };
            for axis in parallel {
                worst = worst.max(seen(0, axis).cross(&seen(1, axis)).norm());
            }
            if let Held::Universal([one, other]) = pin.held {
                worst = worst.max((seen(0, one).dot(&seen(1, other)) - one.dot(&other)).abs());
            }
        }
        worst
    }

    /// A vector of the world at the start, carried by a body to where it is now.
    fn turned(&self, poses: &[RigidMotion], body: usize, v: Vector3<f64>) -> Vector3<f64> {
        poses[body].rotation.matrix() * (self.poses[body].rotation.matrix().transpose() * v)
    }
}

/// Points and axes of the four joints of a Bennett linkage.
fn bennett(draw: &mut Draw) -> ([Vector3<f64>; 4], [Vector3<f64>; 4]) {
    let alpha = draw.uniform(0.2, 2.9);
    let beta = draw.uniform(0.2, 2.9);
    let a = draw.log_uniform(0.3, 2.0);
    let b = a * beta.sin() / alpha.sin();
    let first = draw.uniform(0.1, 3.0) * draw.one_of(&[1.0, -1.0]);
    let ratio = (0.5 * (beta + alpha)).sin() / (0.5 * (beta - alpha)).sin();
    let frames = |second: f64| {
        let part = |theta: f64, a: f64, alpha: f64| {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), theta);
            let twist = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), alpha);
            Isometry3::from_parts(Translation3::identity(), turn)
                * Isometry3::from_parts(Translation3::new(a, 0.0, 0.0), twist)
        };
        let parts = [
            part(first, a, alpha),
            part(second, b, beta),
            part(-first, a, alpha),
            part(-second, b, beta),
        ];
        let mut frames = vec![Isometry3::identity()];
        for part in parts {
            let last = frames[frames.len() - 1];
            frames.push(last * part);
        }
        frames
    };
    let gap = |frames: &[Isometry3<f64>]| {
        let last = frames[frames.len() - 1];
        last.translation.vector.norm() + last.rotation.angle()
    };
    let tangent = (0.5 * first).tan();
    let seconds =
        [ratio / tangent, -ratio / tangent, 1.0 / (ratio * tangent), -1.0 / (ratio * tangent)];
    let closed = seconds
        .iter()
        .map(|tangent| frames(2.0 * tangent.atan()))
        .min_by(|a, b| gap(a).total_cmp(&gap(b)))
        .unwrap_or_default();
    assert!(gap(&closed) < 1e-9, "Bennett's linkage closes: {}", gap(&closed));
    let at = |k: usize| closed[k];
    (
        [0, 1, 2, 3].map(|k| at(k).translation.vector),
        [0, 1, 2, 3].map(|k| at(k).rotation * Vector3::z()),
    )
}
