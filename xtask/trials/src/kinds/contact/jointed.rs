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
    Along, Body, BodyMetric, BodyMotion, Drive, Joint, JointEnd, JointFriction, JointKind,
    JointLimits, LieGroup, PointMass, Poses, RigidMotion, Rotation, Steady, Weight,
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
    trial: |draw| trial(draw, Joints::Alike, 1.0),
};

pub(super) const LIMITED: Kind = Kind {
    name: "limited-contact",
    krate: "contact",
    rule: "such chains, their joints also universal or welded, and hinges with limits and dry friction: as of \
           jointed-contact; axes of a hinge apart, or a weld turned, by 1e-9; a turn beyond its limits by 1e-9; \
           friction of a joint beyond its bound, or along its turn",
    in_tests: 50,
    trial: |draw| trial(draw, Joints::Limited, 1.0),
};

pub(super) const OF_ANY_SIZE: Kind = Kind {
    name: "jointed-sizes",
    krate: "contact",
    rule: "the chains of jointed-contact and limited-contact, of which a metre is 1e-9 to 1e9 metres long and weight \
           grows with it: as of those, in parts of that metre",
    in_tests: 50,
    trial: |draw| {
        let metre = draw.log_uniform(1e-9, 1e9);
        let of = draw.one_of(&[Joints::Alike, Joints::Limited]);
        draw.note(format!("of a metre of {metre:e} m"));
        trial(draw, of, metre)
    },
};

/// Half of the distance between joints, and of the boxes along it, m of a chain whose metre is one.
const REACH: f64 = 0.2;
const HALF: f64 = 0.15;
const GRAVITY: f64 = 9.81;
const STEPS: usize = 60;

/// The joints of a chain.
#[derive(Clone, Copy, PartialEq)]
enum Joints {
    /// All balls or all hinges.
    Alike,
    /// Some universal or welded, the hinges with limits and friction.
    Limited,
}

type Turn = Drive<Poses, Steady>;

/// Joints, limits of their turns, and friction.
type Links = (Kept<Vec<Joint<Poses>>>, Vec<JointLimits<Turn>>, Vec<JointFriction<Turn>>);

struct Chain {
    /// How long a metre of it is, m.
    metre: f64,
    world: SpatialWorld<Weight<Poses>>,
    metric: BodyMetric<Poses>,
    links: Links,
    limits: [f64; 2],
    bound: f64,
    state: State<Vec<f64>>,
    masses: Vec<f64>,
    half: Vector3<f64>,
    hung: bool,
    step: f64,
}

fn drawn(draw: &mut Draw, of: Joints, metre: f64) -> Result<Chain, ContactError> {
    let count = draw.between(2, 6);
    let half = Vector3::new(HALF, draw.uniform(0.03, 0.1), draw.uniform(0.03, 0.1)) * metre;
    let spread = draw.one_of(&[1.0, 10.0, 1e3]);
    let masses: Vec<f64> = (0..count).map(|_| draw.log_uniform(1.0, 1.001 * spread)).collect();
    let [hinges, hung] = [0.4, 0.3].map(|chance| draw.chance(chance));
    let friction = if draw.chance(0.2) { 0.0 } else { draw.unit() };
    let restitution = if draw.chance(0.3) { draw.unit() } else { 0.0 };
    let step = draw.one_of(&[5e-4, 2e-3, 5e-3]);
    let spin = Vector3::from_fn(|_, _| draw.symmetric());
    let speed =
        Vector3::new(draw.symmetric(), draw.symmetric(), draw.symmetric() - 1.0) * (2.0 * metre);
    let speed = if hung { Vector3::zeros() } else { speed };
    let turn = UnitQuaternion::from_scaled_axis(Vector3::y() * (0.5 * draw.symmetric()));
    let along = turn * Vector3::x();
    // The lowest of the chain is a little above the floor.
    let reach = REACH * metre;
    let length = 2.0 * reach * (count - 1) as f64;
    let lowest = (length * along.z).min(0.0) - half.norm();
    let height = draw.uniform(0.0, 0.05) * metre - lowest;
    draw.note(format!(
        "{count} boxes half {half:?} masses {masses:?}, hinges {hinges}, hung {hung}, friction {friction}, \
         restitution {restitution}, step {step:e}, turned {turn}, height {height}, v {speed:?}, w {spin:?}"
    ));
    let rotation = Rotation::from_quaternion([turn.w, turn.i, turn.j, turn.k])?;
    let first = Vector3::z() * height - along * reach;
    let mut motions = Vec::new();
    let (mut bodies, mut colliders) = (Vec::new(), Vec::new());
    for (body, mass) in masses.iter().enumerate() {
        let arm = along * (reach * (2 * body + 1) as f64);
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
    let others = [JointKind::Weld, JointKind::Universal { axes: [Vector3::y(), Vector3::z()] }];
    let hinge = JointKind::Hinge { axis: Vector3::y() };
    let limited = of == Joints::Limited;
    let [low, high, bound] = match of {
        Joints::Alike => [0.0; 3],
        Joints::Limited => [[-1.0, -0.05], [0.05, 1.0], [0.0, GRAVITY * metre * reach * masses[0]]]
            .map(|[least, most]| draw.uniform(least, most)),
    };
    let limits = [low, high];
    let (mut joints, mut stops, mut rubs) = (Vec::new(), Vec::new(), Vec::new());
    for body in usize::from(!hung)..count {
        let before = match body.checked_sub(1) {
            Some(before) => JointEnd::on(before, Vector3::x() * reach),
            None => {
                let frame = RigidMotion { translation: first, rotation };
                JointEnd { body: None, frame }
            }
        };
        let ends = [before, JointEnd::on(body, Vector3::x() * -reach)];
        let kind = match hinges {
            _ if limited && draw.chance(0.3) => draw.one_of(&others),
            true => hinge,
            false => JointKind::Ball,
        };
        draw.note(format!("{} {limits:?} {bound}", kind.name()));
        joints.push(Joint::new(Poses, count, kind, ends)?);
        if limited && kind == hinge {
            let turn = (Along::Turn, Vector3::y());
            stops.push(JointLimits::new(Poses, count, turn, ends, limits)?);
            rubs.push(JointFriction::new(Poses, count, turn, ends, bound)?);
        }
    }
    let links = (Kept(joints), stops, rubs);
    let points = masses.iter().map(|&mass| PointMass { mass, point: Vector3::zeros() });
    let gravity = Vector3::z() * (-GRAVITY * metre);
    let weight = Weight { gravity, masses: points.collect(), space: Poses };
    let metric = BodyMetric::<Poses>::new(bodies);
    let state = metric.state(&motions)?;
    let detector = Detector::new(colliders, count)?;
    let world = SpatialWorld::new(metric.clone().under(weight)?, detector)?;
    Ok(Chain { metre, world, metric, links, limits, bound, state, masses, half, hung, step })
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

    /// How far the ends of the joint that is open most are apart, in parts of a metre of the chain, or axes that it
    /// keeps together, rad.
    fn open(&self, motions: &[Motion]) -> f64 {
        let placed = |end: &JointEnd| {
            let own = end.frame.rotation.matrix();
            match end.body {
                Some(body) => {
                    let Motion { x, r, .. } = motions[body];
                    (x + r * end.frame.translation, r * own)
                }
                None => (end.frame.translation, own),
            }
        };
        let apart = |joint: &Joint<Poses>| {
            let [(a, turned_a), (b, turned_b)] = joint.ends().each_ref().map(placed);
            let turned = match joint.kind() {
                JointKind::Hinge { axis } => (turned_a * axis - turned_b * axis).norm(),
                JointKind::Universal { axes } => {
                    (turned_a * axes[0]).dot(&(turned_b * axes[1])).abs()
                }
                JointKind::Weld => (turned_a - turned_b).norm(),
                _ => 0.0,
            };
            ((a - b).norm() / self.metre).max(turned)
        };
        self.links.0.0.iter().map(apart).fold(0.0, f64::max)
    }

    /// How far the turn that is farthest out of its limits is beyond them, rad.
    fn beyond(&self, motions: &[Motion]) -> f64 {
        let beyond = |joint: &Joint<Poses>| {
            let turned = joint.ends().map(|end| match end.body {
                Some(body) => motions[body].r * end.frame.rotation.matrix(),
                None => end.frame.rotation.matrix(),
            });
            // The turn about y of the second in the axes of the first.
            let turn = turned[0].transpose() * turned[1];
            let angle = turn[(0, 2)].atan2(turn[(0, 0)]);
            (self.limits[0] - angle).max(angle - self.limits[1])
        };
        self.hinges().into_iter().map(beyond).fold(0.0, f64::max)
    }

    fn hinges(&self) -> Vec<&Joint<Poses>> {
        let hinge = |joint: &&Joint<Poses>| matches!(joint.kind(), JointKind::Hinge { .. });
        self.links.0.0.iter().filter(hinge).collect()
    }

    fn judge(&self, before: &Seen, after: &Seen, report: &WorldReport) -> Verdict {
        let (h, metre) = (self.step, self.metre);
        let gravity = GRAVITY * metre;
        let touches: Vec<Touch<Spatial>> = self.world.touches().collect();
        let mass: f64 = self.masses.iter().sum();
        let fastest = |seen: &Seen| {
            let speed = seen.motions.iter().zip(&self.masses).map(|(b, m)| b.p.norm() / m);
            let spin = seen.motions.iter().map(|b| b.turn / h * self.half.norm());
            speed.chain(spin).fold(gravity * h, f64::max)
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
            let off = sum(after) - sum(before) - given + Vector3::z() * (mass * gravity * h);
            let promised = 1e-9 * (mass * fastest + pushed);
            verdict = verdict.and(Verdict::of(off.norm(), promised, "the chain's momentum"));
        }
        let turned =
            |seen: &Seen| seen.motions.iter().map(|b| b.turning * b.turn.powi(3)).sum::<f64>();
        let scale = before.energies[0] + after.energies[0] + mass * (gravity * h).powi(2);
        let slack = 1e-9 * (scale + mass * gravity * h * fastest)
            + 2.0 * (turned(before) + turned(after))
            + 2.0 * left * (pushed + mass * fastest);
        // Of what the world says: its load does its work at the mean of the velocities that it tells.
        let taken = report.impact_energy + report.friction_energy + report.joint_energy;
        let [from, to] = self.world.velocities();
        let falls = self.masses.iter().zip(from.0.chunks_exact(6).zip(to.0.chunks_exact(6)));
        let load: f64 = falls.map(|(m, (a, b))| -0.5 * h * gravity * m * (a[2] + b[2])).sum();
        let off = (after.energies[0] - before.energies[0] - load + taken).abs();
        verdict = verdict.and(Verdict::of(off, slack, "what is told of energies"));
        let gained = after.energies.iter().sum::<f64>() - before.energies.iter().sum::<f64>();
        let above = (gained - report.lifting_energy).max(0.0);
        verdict = verdict.and(Verdict::of(above, slack, "energy grows"));
        if report.settled {
            verdict = verdict.and(Verdict::of(self.open(&after.motions), 1e-9, "a joint opens"));
            if !self.links.1.is_empty() {
                let beyond = self.beyond(&after.motions);
                verdict = verdict.and(Verdict::of(beyond, 1e-9, "a turn leaves its limits"));
            }
        }
        let turned = |seen: &Seen| {
            seen.motions
                .iter()
                .map(|b| 2.0 * (REACH * metre + self.half.norm()) * b.turn.powi(2))
                .sum::<f64>()
        };
        // Dry friction is the last that asks for rows.
        let (rubs, impulses) = (self.hinges(), self.world.joint_impulses());
        let rubs = if self.links.2.is_empty() { &[] } else { &rubs[..] };
        for (joint, x) in rubs.iter().rev().zip(impulses.iter().rev()) {
            let spin = |end: &JointEnd| end.body.map_or(0.0, |body| to.0[6 * body + 4]);
            let [a, b] = joint.ends().each_ref().map(spin);
            let over = x.abs() - self.bound * h;
            verdict = verdict.and(Verdict::of(
                over,
                1e-12 * metre * metre,
                "friction of a joint is out of its bound",
            ));
            let allowed = self.bound * h * (left + 1e-9 * fastest) / (REACH * metre);
            verdict =
                verdict.and(Verdict::of(x * (b - a), allowed, "friction of a joint drives it"));
        }
        let deeper = (self.depth(&after.motions) - self.depth(&before.motions)).max(0.0);
        let allowed = 1e-12 * metre + h * left + turned(before) + turned(after);
        verdict.and(Verdict::of(deeper, allowed, "the floor lets a corner in"))
    }
}

/// Bodies and energies at one time.
struct Seen {
    motions: Vec<Motion>,
    energies: [f64; 2],
}

fn trial(draw: &mut Draw, of: Joints, metre: f64) -> Verdict {
    let mut chain = match drawn(draw, of, metre) {
        Ok(chain) => chain,
        Err(error) => return Verdict::refused(error),
    };
    let seen = |chain: &Chain| Seen { motions: chain.motions(), energies: chain.energies() };
    let mut verdict = Verdict::due();
    let mut before = seen(&chain);
    for step in 0..STEPS {
        let report = match chain.world.step_with(&mut chain.state, chain.step, &chain.links) {
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
