//! Chains of boxes that land on a floor, joints and contacts together, judged at every step.
//!
//! ```text
//! p+ - p = h m g + J_c              the chain's momentum, where nothing holds it
//! T+ - T = g.p h - impacts - friction - joints,     T+ + V+ <= T + V + lifting          to the turning's third order
//! |x_a - x_b| = 0                   the ends of each joint, after the step
//! ```
//! The referee knows masses, places and momenta, and what the world says of impulses and energies.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use stationary_calculus::{Metric, Potential};
use stationary_contact::{
    Collider, ContactError, Detector, Kept, Shape, Spatial, SpatialWorld, Touch, WorldReport,
};
use stationary_integrators::State;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, Joint, JointEnd, JointKind, LieGroup, PointMass, Poses,
    RigidMotion, Rotation, Weight,
};

use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "jointed-contact",
    krate: "contact",
    rule: "a chain of two to six boxes on ball joints or hinges, free or hung from the world, that lands on a floor: \
           its momentum off the impulses told where it is free, or the energies off what is told, by 1e-9 and the \
           third order of the turn of a step; energy above what lifting gave, by the same; an impulse that pulls or \
           is out of its cone by more than reported; a joint open by 1e-9; a corner deeper in the floor than before, \
           turning and the residual allow. A step that is not settled is refused",
    in_tests: 50,
    trial,
};

/// Half of the distance between joints, m, and of the boxes along it.
const REACH: f64 = 0.2;
const HALF: f64 = 0.15;
const GRAVITY: f64 = 9.81;
const STEPS: usize = 60;

struct Chain {
    world: SpatialWorld<Weight<Poses>>,
    metric: BodyMetric<Poses>,
    joints: Vec<Joint<Poses>>,
    ends: Vec<[JointEnd; 2]>,
    state: State<Vec<f64>>,
    masses: Vec<f64>,
    half: Vector3<f64>,
    hung: bool,
    step: f64,
}

fn drawn(draw: &mut Draw) -> Result<Chain, ContactError> {
    let count = draw.between(2, 6);
    let half = Vector3::new(HALF, draw.uniform(0.03, 0.1), draw.uniform(0.03, 0.1));
    let spread = draw.one_of(&[1.0, 10.0, 1e3]);
    let masses: Vec<f64> = (0..count).map(|_| draw.log_uniform(1.0, 1.001 * spread)).collect();
    let [hinges, hung] = [0.4, 0.3].map(|chance| draw.chance(chance));
    let friction = if draw.chance(0.2) { 0.0 } else { draw.unit() };
    let restitution = if draw.chance(0.3) { draw.unit() } else { 0.0 };
    let step = draw.one_of(&[5e-4, 2e-3, 5e-3]);
    let spin = Vector3::from_fn(|_, _| draw.symmetric());
    let speed = Vector3::new(draw.symmetric(), draw.symmetric(), draw.symmetric() - 1.0) * 2.0;
    let speed = if hung { Vector3::zeros() } else { speed };
    let turn = UnitQuaternion::from_scaled_axis(Vector3::y() * (0.5 * draw.symmetric()));
    let along = turn * Vector3::x();
    // The lowest of the chain is a little above the floor.
    let length = 2.0 * REACH * (count - 1) as f64;
    let lowest = (length * along.z).min(0.0) - half.norm();
    let height = draw.uniform(0.0, 0.05) - lowest;
    draw.note(format!(
        "{count} boxes half {half:?} masses {masses:?}, hinges {hinges}, hung {hung}, friction {friction}, \
         restitution {restitution}, step {step:e}, turned {turn}, height {height}, v {speed:?}, w {spin:?}"
    ));
    let rotation = Rotation::from_quaternion([turn.w, turn.i, turn.j, turn.k])?;
    let first = Vector3::z() * height - along * REACH;
    let mut motions = Vec::new();
    let (mut bodies, mut colliders) = (Vec::new(), Vec::new());
    for (body, mass) in masses.iter().enumerate() {
        let arm = along * (REACH * (2 * body + 1) as f64);
        bodies.push(Body::solid_box(*mass, half.into())?);
        motions.push(BodyMotion {
            pose: RigidMotion { translation: first + arm, rotation },
            velocity: speed + spin.cross(&arm),
            angular_velocity: turn.inverse() * spin,
        });
        let collider = Collider::on_body(body, Shape::cuboid(half.into())?);
        colliders.push(collider.with_friction(friction).with_restitution(restitution));
    }
    let floor = Collider::fixed(RigidMotion::identity(), Shape::half_space(Vector3::z())?);
    colliders.push(floor.with_friction(friction).with_restitution(restitution));
    let kind = match hinges {
        true => JointKind::Hinge { axis: Vector3::y() },
        false => JointKind::Ball,
    };
    let (mut joints, mut ends) = (Vec::new(), Vec::new());
    for body in usize::from(!hung)..count {
        let before = match body.checked_sub(1) {
            Some(before) => JointEnd::on(before, Vector3::x() * REACH),
            None => {
                let frame = RigidMotion { translation: first, rotation };
                JointEnd { body: None, frame }
            }
        };
        ends.push([before, JointEnd::on(body, Vector3::x() * -REACH)]);
        joints.push(Joint::new(Poses, count, kind, ends[ends.len() - 1])?);
    }
    let points = masses.iter().map(|&mass| PointMass { mass, point: Vector3::zeros() });
    let gravity = Vector3::z() * -GRAVITY;
    let weight = Weight { gravity, masses: points.collect(), space: Poses };
    let metric = BodyMetric::<Poses>::new(bodies);
    let state = metric.state(&motions)?;
    let detector = Detector::new(colliders, count)?;
    let world = SpatialWorld::new(metric.clone().under(weight)?, detector)?;
    Ok(Chain { world, metric, joints, ends, state, masses, half, hung, step })
}

/// Where a body is, and how it moves.
struct Motion {
    x: Vector3<f64>,
    r: Matrix3<f64>,
    p: Vector3<f64>,
    /// The angle that a step turns it by, and the energy of that.
    turn: f64,
    turning: f64,
}

impl Chain {
    fn motions(&self) -> Vec<Motion> {
        let mut v = stationary_calculus::Vector(vec![0.0; self.state.p.0.len()]);
        self.metric.sharp(self.state.p.view(), v.view_mut());
        let bodies = self.state.q.chunks_exact(7).zip(self.state.p.0.chunks_exact(6));
        let motion = |((q, p), v): ((&[f64], &[f64]), &[f64])| {
            let turn = UnitQuaternion::from_quaternion(Quaternion::new(q[3], q[4], q[5], q[6]));
            let spin = Vector3::new(v[3], v[4], v[5]);
            Motion {
                x: Vector3::new(q[0], q[1], q[2]),
                r: turn.to_rotation_matrix().into_inner(),
                p: Vector3::new(p[0], p[1], p[2]),
                turn: self.step * spin.norm(),
                turning: 0.5 * (p[3] * v[3] + p[4] * v[4] + p[5] * v[5]),
            }
        };
        bodies.zip(v.0.chunks_exact(6)).map(motion).collect()
    }

    fn energies(&self) -> [f64; 2] {
        let kinetic = self.metric.kinetic_energy(self.state.p.view());
        [kinetic, self.world.system().potential().energy(&self.state.q)]
    }

    /// How deep the deepest corner is in the floor, m.
    fn depth(&self, motions: &[Motion]) -> f64 {
        let half = self.half;
        let corner = |motion: &Motion| motion.r.row(2).abs().dot(&half.transpose()) - motion.x.z;
        motions.iter().map(corner).fold(0.0, f64::max)
    }

    /// How far the ends of the joint that is open most are apart, m.
    fn open(&self, motions: &[Motion]) -> f64 {
        let place = |end: &JointEnd| match end.body {
            Some(body) => motions[body].x + motions[body].r * end.frame.translation,
            None => end.frame.translation,
        };
        let apart = |ends: &[JointEnd; 2]| (place(&ends[0]) - place(&ends[1])).norm();
        self.ends.iter().map(apart).fold(0.0, f64::max)
    }

    fn judge(&self, before: &Seen, after: &Seen, report: &WorldReport) -> Verdict {
        let h = self.step;
        let touches: Vec<Touch<Spatial>> = self.world.touches().collect();
        let mass: f64 = self.masses.iter().sum();
        let fastest = |seen: &Seen| {
            let speed = seen.motions.iter().zip(&self.masses).map(|(b, m)| b.p.norm() / m);
            let spin = seen.motions.iter().map(|b| b.turn / h * self.half.norm());
            speed.chain(spin).fold(GRAVITY * h, f64::max)
        };
        let fastest = fastest(before).max(fastest(after));
        let left = report.residual.max(report.coulomb).max(report.impact_residual);
        let mut verdict = Verdict::due();
        let pushed = touches.iter().map(|t| t.normal + t.impact).sum::<f64>();
        for touch in &touches {
            let normal = touch.normal + touch.impact;
            let reach = touch.contact.friction * normal;
            let slack = 1e-9 * (mass * fastest + pushed) + mass * left;
            verdict = verdict.and(Verdict::of((-normal).max(0.0), slack, "an impulse pulls"));
            let over = (touch.friction.norm() - reach).max(0.0);
            verdict = verdict.and(Verdict::of(over, slack, "friction is out of its cone"));
        }
        if !self.hung {
            // Impulses between the boxes are of both signs.
            let of_floor = |touch: &Touch<Spatial>| {
                let impulse = touch.contact.normal * (touch.normal + touch.impact) + touch.friction;
                let sides = touch.contact.bodies.map(|body| body.is_some());
                impulse * (f64::from(u8::from(sides[1])) - f64::from(u8::from(sides[0])))
            };
            let given: Vector3<f64> = touches.iter().map(of_floor).sum();
            let sum = |seen: &Seen| seen.motions.iter().map(|b| b.p).sum::<Vector3<f64>>();
            let off = sum(after) - sum(before) - given + Vector3::z() * (mass * GRAVITY * h);
            let promised = 1e-9 * (mass * fastest + pushed);
            verdict = verdict.and(Verdict::of(off.norm(), promised, "the chain's momentum"));
        }
        let turned =
            |seen: &Seen| seen.motions.iter().map(|b| b.turning * b.turn.powi(3)).sum::<f64>();
        let scale = before.energies[0] + after.energies[0] + mass * (GRAVITY * h).powi(2);
        let slack = 1e-9 * (scale + mass * GRAVITY * h * fastest)
            + 2.0 * (turned(before) + turned(after))
            + 2.0 * left * (pushed + mass * fastest);
        // Of what the world says: its load does its work at the mean of the velocities that it tells.
        let taken = report.impact_energy + report.friction_energy + report.joint_energy;
        let [from, to] = self.world.velocities();
        let falls = self.masses.iter().zip(from.0.chunks_exact(6).zip(to.0.chunks_exact(6)));
        let load: f64 = falls.map(|(m, (a, b))| -0.5 * h * GRAVITY * m * (a[2] + b[2])).sum();
        let off = (after.energies[0] - before.energies[0] - load + taken).abs();
        verdict = verdict.and(Verdict::of(off, slack, "what is told of energies"));
        let gained = after.energies.iter().sum::<f64>() - before.energies.iter().sum::<f64>();
        let above = (gained - report.lifting_energy).max(0.0);
        verdict = verdict.and(Verdict::of(above, slack, "energy grows"));
        if report.settled {
            verdict = verdict.and(Verdict::of(self.open(&after.motions), 1e-9, "a joint opens"));
        }
        let turned = |seen: &Seen| {
            seen.motions
                .iter()
                .map(|b| 2.0 * (REACH + self.half.norm()) * b.turn.powi(2))
                .sum::<f64>()
        };
        let deeper = (self.depth(&after.motions) - self.depth(&before.motions)).max(0.0);
        let allowed = 1e-12 + h * left + turned(before) + turned(after);
        verdict.and(Verdict::of(deeper, allowed, "the floor lets a corner in"))
    }
}

/// Bodies and energies at one time.
struct Seen {
    motions: Vec<Motion>,
    energies: [f64; 2],
}

fn trial(draw: &mut Draw) -> Verdict {
    let mut chain = match drawn(draw) {
        Ok(chain) => chain,
        Err(error) => return Verdict::refused(error),
    };
    let seen = |chain: &Chain| Seen { motions: chain.motions(), energies: chain.energies() };
    let mut verdict = Verdict::due();
    let mut before = seen(&chain);
    for step in 0..STEPS {
        let joints = Kept(&chain.joints);
        let report = match chain.world.step_with(&mut chain.state, chain.step, &joints) {
            Ok(report) => report,
            Err(error) => return verdict.and(Verdict::refused(error)),
        };
        let after = seen(&chain);
        let word = chain.judge(&before, &after, &report);
        if let Verdict::Wrong { ratio, what } = word {
            return Verdict::Wrong { ratio, what: format!("step {step}: {what}") };
        }
        verdict = verdict.and(word);
        if !report.settled {
            verdict = verdict.and(Verdict::refused("not settled"));
        }
        before = after;
    }
    verdict
}
