//! The variational step of random open trees beside RATTLE on the same bodies: one discrete principle, told twice.

use nalgebra::Vector3;
use stationary_constraints::{ConstrainedIntegrator, Rattle, Redundancy, SparseDiagonal};
use stationary_integrators::Integrator;
use stationary_rigid::tree::{TreeBuilder, TreeMotion, TreeVariational};
use stationary_rigid::{
    Body, BodyMetric, BodySpace, ConstantVelocity, FreeBodies, Joint, JointEnd, JointKind,
    LieGroup, PointMass, Poses, RigidMotion, Weight,
};

use super::driven::{frame, kind};
use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "variational-trees",
    krate: "rigid",
    rule: "in thirty steps of one to three lengths, of up to a tenth of the fastest turn, a body of a random tree is \
           farther from where RATTLE has it than 1e-8 of the largest distance, times the root of the ratio of masses, \
           or than what both make of a start that is off by 1e-9, or turned against it",
    in_tests: 50,
    trial,
};

const STEPS: usize = 30;

fn trial(draw: &mut Draw) -> Verdict {
    let n = draw.between(1, 8);
    let ratio = draw.one_of(&[1.0 + 1e-9, 1e1, 1e3]);
    let (mut builder, mut joints, mut bodies) = (TreeBuilder::default(), vec![], vec![]);
    for body in 0..n {
        let half = [0; 3].map(|_| draw.log_uniform(0.05, 0.5));
        let own = Body::solid_box(draw.log_uniform(1.0, ratio), half).expect("a box");
        let parent = (body > 0).then(|| draw.below(body));
        let kind = if body == 0 && draw.chance(0.3) { JointKind::Free } else { kind(draw) };
        let frames = [frame(draw), frame(draw)];
        builder.hang(parent, kind, frames, own);
        bodies.push(own);
        let ends = [
            JointEnd { body: parent, frame: frames[0] },
            JointEnd { body: Some(body), frame: frames[1] },
        ];
        joints.push(Joint::new(Poses, n, kind, ends).expect("a checked joint"));
    }
    let tree = builder.build().expect("a tree of bodies with masses");
    draw.note(format!("{n} bodies, ratio {ratio:.0e}"));
    let v: Vec<f64> = (0..tree.speeds()).map(|_| 2.0 * draw.symmetric()).collect();
    let mut q = tree.rest();
    let by: Vec<f64> = v.iter().map(|_| draw.symmetric()).collect();
    tree.advance(&mut q, &by).expect("as many numbers");
    let gravity = Vector3::new(0.3, 0.0, -1.0) * draw.one_of(&[0.0, 9.0]);
    let lengths: Vec<f64> = (0..draw.between(1, 3)).map(|_| draw.uniform(0.3, 1.0)).collect();
    let mut motion = TreeMotion::new(tree.clone());
    motion.place(&q, &v).expect("a place");
    let motions: Vec<_> = (0..n).map(|body| motion.body(body).expect("a body")).collect();
    let metric = BodyMetric::<Poses>::new(bodies.clone());
    let mut state = metric.state(&motions).expect("finite motions");
    let masses = bodies.iter().map(|b| PointMass { mass: b.mass(), point: Vector3::zeros() });
    let weight = Weight { gravity, masses: masses.collect(), space: Poses };
    let system = metric.under(weight).expect("as many bodies");
    // Turns of all joints may add up.
    let fastest = motions.iter().map(|m| m.angular_velocity.norm()).fold(1.0, f64::max);
    let h = 0.1 / (fastest + gravity.norm().sqrt() * 3.0);
    let mut rattle = match Rattle::along(
        FreeBodies(ConstantVelocity),
        &system,
        &joints,
        &state,
        SparseDiagonal(Redundancy::LeastNorm),
    ) {
        Ok(rattle) => rattle,
        Err(error) => return Verdict::not_judged(error),
    };
    let run = |q: &[f64]| -> Result<Vec<RigidMotion>, String> {
        let mut method =
            TreeVariational::new(tree.clone(), gravity).map_err(|error| error.to_string())?;
        let mut reduced = method.state(q, &v).map_err(|error| error.to_string())?;
        for step in 0..STEPS {
            let h = h * lengths[step % lengths.len()];
            method.step(&mut reduced, h).map_err(|error| error.to_string())?;
        }
        let moved = method.motion(&reduced).map_err(|error| error.to_string())?;
        (0..n).map(|body| moved.pose(body).map_err(|error| error.to_string())).collect()
    };
    let mut off = q.clone();
    let slight: Vec<f64> = v.iter().map(|_| 1e-9 * draw.symmetric()).collect();
    tree.advance(&mut off, &slight).expect("as many numbers");
    let (found, other) = match (run(&q), run(&off)) {
        (Ok(found), Ok(other)) => (found, other),
        (Err(error), _) | (_, Err(error)) => return Verdict::refused(error),
    };
    for step in 0..STEPS {
        if let Err(error) = rattle.step(&mut state, h * lengths[step % lengths.len()]) {
            return Verdict::not_judged(error);
        }
    }
    let far = |a: &RigidMotion, b: &RigidMotion| {
        (a.translation - b.translation).norm() + a.rotation.direction_to(&b.rotation).norm()
    };
    let reach = found.iter().map(|pose| pose.translation.norm()).fold(1.0, f64::max);
    let sensitive = found.iter().zip(&other).map(|(a, b)| far(a, b)).fold(0.0, f64::max);
    let apart = (0..n).map(|body| far(&found[body], &Poses::pose_at(&state.q, body)));
    let promised = (1e-8 * reach * ratio.sqrt()).max(sensitive);
    Verdict::of(apart.fold(0.0, f64::max), promised, "places, by the tree and by RATTLE")
}
