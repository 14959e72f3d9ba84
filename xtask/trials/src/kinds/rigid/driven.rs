//! Random trees of all joints, some closed by a rod, under random forces: in joint coordinates, in full ones, and in motion.
//!
//! ```text
//! reduced   d/dt of bodies' velocities along (q., v.) of the tree, by differences
//! full      accelerations at an instant, under the joints' equations
//! ```
//! The forces are told twice, by functions that share nothing.

use nalgebra::{Matrix3, Vector3};
use stationary_calculus::{Metric, Vector};
use stationary_constraints::{ConstrainedIntegrator, Forced, Rattle, Redundancy, SparseDiagonal};
use stationary_integrators::VectorField;
use stationary_rigid::tree::{Tree, TreeBuilder, TreeField, TreeForces, TreeLoops, TreeMotion};
use stationary_rigid::{
    Attachment, Body, BodyForces, BodyMetric, ConstantVelocity, FreeBodies, Joint, JointEnd,
    JointKind, LieGroup, PointMass, Poses, RigidMotion, Rotation, Weight, instant,
    spatial_angular_momentum,
};

use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "driven-trees",
    krate: "rigid",
    rule: "the accelerations of a random tree under springs, dampers, motors and loads differ from those \
           of the same bodies under the joints' equations by more than 1e-6 of the largest; forces \
           between bodies of a free tree change its momenta by more than 1e-11 in twenty steps of RATTLE, \
           or a joint opens",
    in_tests: 50,
    trial,
};

pub(super) fn direction(draw: &mut Draw) -> Vector3<f64> {
    let v = Vector3::from_fn(|_, _| draw.symmetric());
    if v.norm() < 1e-3 { Vector3::z() } else { v.normalize() }
}

pub(super) fn frame(draw: &mut Draw) -> RigidMotion {
    RigidMotion {
        translation: direction(draw) * draw.log_uniform(0.05, 1.0),
        rotation: Rotation::exp(direction(draw) * draw.uniform(0.0, 3.0)),
    }
}

pub(super) fn kind(draw: &mut Draw) -> JointKind {
    let axis = direction(draw);
    let across = axis.cross(&direction(draw));
    let across = if across.norm() < 1e-2 { axis.yzx() - axis } else { across.normalize() };
    match draw.below(9) {
        0 => JointKind::Ball,
        1 => JointKind::Weld,
        2 => JointKind::Slider { axis },
        3 => JointKind::Screw { axis, pitch: draw.log_uniform(0.01, 1.0) },
        4 => JointKind::Cylinder { axis },
        5 => JointKind::Universal { axes: [axis, across] },
        6 => JointKind::Planar { axes: [axis, axis.cross(&across)] },
        _ => JointKind::Hinge { axis },
    }
}

/// Something between two bodies, or a body and the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    bodies: [Option<usize>; 2],
    points: [Vector3<f64>; 2],
    stiffness: f64,
    rest: f64,
    damping: f64,
    /// A torque about an axis of the first body, with a damping of its own.
    torque: f64,
    axis: Vector3<f64>,
}

impl Link {
    fn law(&self, t: f64, length: f64, rate: f64) -> f64 {
        self.stiffness * (self.rest - length) - self.damping * rate + 0.3 * t.sin()
    }

    fn draw(draw: &mut Draw, bodies: [Option<usize>; 2], mass: f64) -> Self {
        Link {
            bodies,
            points: [0; 2].map(|_| direction(draw) * draw.log_uniform(0.05, 1.0)),
            stiffness: mass * draw.log_uniform(0.1, 10.0),
            rest: draw.uniform(0.0, 2.0),
            damping: mass * draw.log_uniform(1e-3, 1.0),
            torque: mass * draw.symmetric(),
            axis: direction(draw),
        }
    }

    /// Adds the force and the torque to a tree, in world axes.
    fn push(&self, t: f64, motion: &TreeMotion, forces: &mut TreeForces) {
        let still = (Vector3::zeros(), Vector3::zeros(), Matrix3::identity());
        let at = |k: usize| match self.bodies[k].and_then(|body| motion.body(body).ok()) {
            None => (self.points[k], still.0, still.1, still.2),
            Some(body) => {
                let matrix = body.pose.rotation.matrix();
                let (arm, spin) = (matrix * self.points[k], matrix * body.angular_velocity);
                let place = body.pose.translation + arm;
                (place, body.velocity + spin.cross(&arm), spin, matrix)
            }
        };
        let (one, other) = (at(0), at(1));
        let apart = other.0 - one.0;
        let unit = apart.try_normalize(0.0).unwrap_or_else(Vector3::zeros);
        let rate = unit.dot(&(other.1 - one.1));
        let force = unit * self.law(t, apart.norm(), rate);
        let axis = one.3 * self.axis;
        let torque = axis * (self.torque - self.damping * axis.dot(&(other.2 - one.2)));
        for (k, sign) in [(0, -1.0), (1, 1.0)] {
            let Some(body) = self.bodies[k] else { continue };
            let added = forces
                .add_force(motion, body, &self.points[k], force * sign)
                .and_then(|()| forces.add_torque(body, torque * sign));
            added.expect("forces of a body that is there");
        }
    }

    /// The same on bodies in full coordinates.
    fn add(&self, forces: &mut BodyForces<Poses>) {
        let link = *self;
        let end = |k: usize| match link.bodies[k] {
            None => Attachment::World(link.points[k]),
            Some(body) => Attachment::Body(body, link.points[k]),
        };
        let law = move |t: f64, length: f64, rate: f64| link.law(t, length, rate);
        forces.between_points([end(0), end(1)], law).expect("a body that is there");
        let joined = |k: usize| match link.bodies[k] {
            None => JointEnd::world(Vector3::zeros()),
            Some(body) => JointEnd::on(body, Vector3::zeros()),
        };
        let law = move |_: f64, _: f64, rate: f64| link.torque - link.damping * rate;
        forces.about_axis([joined(0), joined(1)], link.axis, law).expect("an axis");
    }
}

fn trial(draw: &mut Draw) -> Verdict {
    let n = draw.between(1, 6);
    let free = draw.chance(0.3);
    let ratio = draw.one_of(&[1.0 + 1e-9, 1e1, 1e3, 1e6]);
    let (mut builder, mut joints, mut bodies) = (TreeBuilder::default(), vec![], vec![]);
    for body in 0..n {
        let mass = draw.log_uniform(1.0, ratio);
        let half = [0; 3].map(|_| draw.log_uniform(0.05, 0.5));
        let own = Body::solid_box(mass, half).expect("a box");
        let parent = (body > 0).then(|| draw.below(body));
        let kind = if body == 0 && free { JointKind::Free } else { kind(draw) };
        let frames = [frame(draw), frame(draw)];
        builder.hang(parent, kind, frames, own);
        bodies.push(own);
        let ends = [
            JointEnd { body: parent, frame: frames[0] },
            JointEnd { body: Some(body), frame: frames[1] },
        ];
        match Joint::new(Poses, n, kind, ends) {
            Ok(joint) => joints.push(joint),
            Err(error) => return Verdict::wrong(error),
        }
    }
    let tree = match builder.build() {
        Ok(tree) => tree,
        Err(error) => return Verdict::wrong(error),
    };
    let alone = free && n == 1;
    let links: Vec<Link> = (0..if alone { 0 } else { draw.between(1, 3) })
        .map(|_| {
            let second = draw.below(n);
            let first = if free {
                Some((second + draw.between(1, n - 1)) % n)
            } else {
                (second > 0).then(|| draw.below(second))
            };
            let mass = bodies[second].mass().min(first.map_or(f64::MAX, |b| bodies[b].mass()));
            Link::draw(draw, [first, Some(second)], mass)
        })
        .collect();
    draw.note(format!("{n} bodies, free {free}, ratio {ratio:.0e}, {links:?}"));
    draw.note(format!("{:?}", joints.iter().map(|joint| joint.kind()).collect::<Vec<_>>()));
    let (mut q, mut v) = (tree.rest(), vec![0.0; tree.speeds()]);
    q.iter_mut().for_each(|q| *q += draw.symmetric());
    v.iter_mut().for_each(|v| *v = 2.0 * draw.symmetric());
    for (body, joint) in joints.iter().enumerate() {
        let Ok(range) = tree.coordinates_of(body) else { continue };
        if matches!(joint.kind(), JointKind::Ball | JointKind::Free) {
            let quaternion = &mut q[range.end - 4..range.end];
            let length = quaternion.iter().map(|c| c * c).sum::<f64>().sqrt();
            quaternion.iter_mut().for_each(|c| *c /= length);
        }
    }
    let gravity = if free { Vector3::zeros() } else { Vector3::new(0.0, 0.3, -1.0) * 9.0 };
    let mut loops = TreeLoops::new(&tree);
    if n > 1 && draw.chance(0.3) {
        // A rod as long as its ends are apart, and speeds that it allows.
        let first = draw.below(n);
        let second = (first + draw.between(1, n - 1)) % n;
        let ends = [first, second]
            .map(|body| JointEnd::on(body, direction(draw) * draw.log_uniform(0.05, 1.0)));
        let mut motion = TreeMotion::new(tree.clone());
        if motion.place(&q, &v).is_err() {
            return Verdict::refused("the tree has no such place");
        }
        let place = |end: &JointEnd| {
            let pose = end.body.and_then(|body| motion.pose(body).ok())?;
            Some(pose.translation + pose.rotation.matrix() * end.frame.translation)
        };
        let (Some(one), Some(other)) = (place(&ends[0]), place(&ends[1])) else {
            return Verdict::wrong("a body that is there has no pose");
        };
        let kind = JointKind::Rod { length: (one - other).norm() };
        draw.note(format!("{kind:?} {ends:?}"));
        let closed =
            loops.join(&tree, kind, ends).and_then(|()| loops.close(&mut motion, &mut q, &mut v));
        if let Err(error) = closed {
            // Of bodies that one weld or pin holds at this distance.
            return Verdict::not_judged(error);
        }
        match Joint::new(Poses, n, kind, ends) {
            Ok(joint) => joints.push(joint),
            Err(error) => return Verdict::wrong(error),
        }
    }
    compare(draw, (&tree, loops), &bodies, &joints, &links, gravity, &[q, v].concat())
}

/// Velocities of all bodies, six numbers each, where the tree is.
fn velocities(motion: &TreeMotion, bodies: usize) -> Vec<f64> {
    (0..bodies)
        .flat_map(|body| {
            let body = motion.body(body).expect("a body that is there");
            let (v, w) = (body.velocity, body.angular_velocity);
            [v.x, v.y, v.z, w.x, w.y, w.z]
        })
        .collect()
}

/// The accelerations of a tree beside those of the same bodies in full coordinates.
pub(super) fn compare(
    draw: &mut Draw,
    (tree, loops): (&Tree, TreeLoops),
    bodies: &[Body],
    joints: &Vec<Joint<Poses>>,
    links: &[Link],
    gravity: Vector3<f64>,
    y: &[f64],
) -> Verdict {
    let n = bodies.len();
    let t = draw.symmetric();
    let weight = TreeForces::weight(tree, gravity).expect("finite");
    let drive = |t: f64, motion: &TreeMotion, forces: &mut TreeForces| {
        links.iter().for_each(|link| link.push(t, motion, forces));
    };
    let field = match TreeField::driven(tree.clone(), weight, drive) {
        Ok(field) => field.closed(loops),
        Err(error) => return Verdict::wrong(error),
    };
    let mut rate = vec![0.0; y.len()];
    field.evaluate(t, y, &mut rate);
    let mut motion = TreeMotion::new(tree.clone());
    let mut seen = |e: f64| {
        let moved: Vec<f64> = y.iter().zip(&rate).map(|(y, rate)| y + e * rate).collect();
        let (q, v) = moved.split_at(tree.coordinates());
        motion.place(q, v).map(|()| velocities(&motion, n))
    };
    let largest = rate.iter().fold(1.0_f64, |largest, rate| largest.max(rate.abs()));
    let e = 1e-4 / largest;
    let (Ok(ahead), Ok(behind), Ok(ahead2), Ok(behind2), Ok(here)) =
        (seen(e), seen(-e), seen(2.0 * e), seen(-2.0 * e), seen(0.0))
    else {
        return Verdict::refused("the tree has no motion here");
    };
    let reduced: Vec<f64> = (0..here.len())
        .map(|k| (8.0 * (ahead[k] - behind[k]) - (ahead2[k] - behind2[k])) / (12.0 * e))
        .collect();
    let motions: Vec<_> = (0..n).map(|body| motion.body(body).expect("a body")).collect();
    let metric = BodyMetric::<Poses>::new(bodies.to_vec());
    let mut state = match metric.state(&motions) {
        Ok(state) => state,
        Err(error) => return Verdict::wrong(error),
    };
    state.t = t;
    let masses =
        bodies.iter().map(|b| PointMass { mass: b.mass(), point: Vector3::zeros() }).collect();
    let system = match metric.under(Weight { gravity, masses, space: Poses }) {
        Ok(system) => system,
        Err(error) => return Verdict::wrong(error),
    };
    let mut forces = BodyForces::new(Poses, n);
    links.iter().for_each(|link| link.add(&mut forces));
    let full = match instant(&system, joints, &forces, (t, &state.q, &here)) {
        Ok(full) => full.accelerations,
        Err(error) => return Verdict::refused(error),
    };
    let size = full.iter().fold(1e-3_f64, |size, a| size.max(a.abs()));
    let off = full.iter().zip(&reduced).fold(0.0_f64, |off, (a, b)| off.max((a - b).abs()));
    // A difference of velocities has the rounding of both over its step.
    let rounding = 1e-14 * here.iter().fold(1.0_f64, |v, w| v.max(w.abs())) / e;
    let verdict =
        Verdict::of(off / size, 1e-6 + rounding / size, "accelerations, reduced and full");
    if gravity != Vector3::zeros() {
        return verdict;
    }
    // Steps that turn nothing by more than a hundredth of a radian.
    let fastest = here.iter().fold(1.0_f64, |v, w| v.max(w.abs()));
    let h = 0.01 / (fastest + size.sqrt());
    let motion = Forced::new(FreeBodies(ConstantVelocity), forces);
    let equations = SparseDiagonal(Redundancy::LeastNorm);
    let mut rattle = match Rattle::along(motion, &system, joints, &state, equations) {
        Ok(rattle) => rattle,
        Err(error) => return verdict.and(Verdict::refused(error)),
    };
    let momenta = |state: &stationary_integrators::State<Vec<f64>>| {
        let linear: Vector3<f64> =
            state.p.0.chunks_exact(6).map(|p| Vector3::new(p[0], p[1], p[2])).sum();
        let angular = spatial_angular_momentum::<Poses>(state);
        (linear, angular.unwrap_or_else(|_| Vector3::repeat(f64::NAN)))
    };
    let start = momenta(&state);
    for _ in 0..20 {
        if let Err(error) = rattle.step(&mut state, h) {
            return verdict.and(Verdict::refused(error));
        }
    }
    let end = momenta(&state);
    let scale = state.p.0.iter().fold(1e-3_f64, |p, q| p.max(q.abs()))
        * (1.0 + state.q.iter().fold(0.0_f64, |p, q| p.max(q.abs())));
    let change = (end.0 - start.0).norm().max((end.1 - start.1).norm()) / scale;
    let mut v = Vector(vec![0.0; 6 * n]);
    system.metric().sharp(state.p.view(), v.view_mut());
    verdict.and(Verdict::of(change, 1e-11, "momenta of a free tree under inner forces"))
}
