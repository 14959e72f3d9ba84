//! A hanging chain of a thousand hinged bodies: nanoseconds a link and step, by RATTLE and in joint coordinates.
//!
//! `cargo bench --bench chain_of_bodies` prints both, by the least of a few runs, with the iterations of a step, and
//! their ratio. Both make the same motion.

use std::time::Instant;

use nalgebra::Vector3;
use stationary_constraints::{ConstrainedIntegrator, Rattle, SparseDiagonal};
use stationary_integrators::Integrator;
use stationary_rigid::tree::{Tree, TreeBuilder, TreeMotion, TreeVariational};
use stationary_rigid::{
    Body, BodyMetric, ConstantVelocity, FreeBodies, Joint, JointEnd, JointKind, LieGroup,
    PointMass, Poses, RigidMotion, Rotation, Weight,
};

const LINKS: usize = 1_000;
/// The time of a run, seconds: later the chain whips.
const HORIZON: f64 = 0.15;
/// Steps before the clock runs, which the first guesses need.
const BEFORE: u32 = 6;
const RUNS: usize = 5;
const HALF: f64 = 0.5;
const GRAVITY: Vector3<f64> = Vector3::new(0.0, 0.0, -9.81);

struct Chain {
    tree: Tree,
    bodies: Vec<Body>,
    joints: Vec<Joint<Poses>>,
    q: Vec<f64>,
    v: Vec<f64>,
}

/// Nanoseconds a link and step, and iterations a step.
type Cost = (f64, f64);

fn chain() -> Chain {
    let at = |z| RigidMotion { translation: Vector3::z() * z, rotation: Rotation::identity() };
    let body = Body::solid_box(1.0, [0.05, 0.08, HALF]).expect("a link");
    let hinge = JointKind::Hinge { axis: Vector3::y() };
    let (mut builder, mut joints) = (TreeBuilder::default(), Vec::new());
    for k in 0..LINKS {
        let parent = k.checked_sub(1);
        let foot = if k == 0 { 0.0 } else { -HALF };
        builder.hang(parent, hinge, [at(foot), at(HALF)], body);
        let foot = Vector3::z() * foot;
        let up = parent.map_or(JointEnd::world(foot), |parent| JointEnd::on(parent, foot));
        let ends = [up, JointEnd::on(k, Vector3::z() * HALF)];
        joints.push(Joint::new(Poses, LINKS, hinge, ends).expect("a hinge"));
    }
    let tree = builder.build().expect("a chain");
    let q = (0..LINKS).map(|k| 0.05 * (0.37 * k as f64).sin()).collect();
    let v = (0..LINKS).map(|k| 0.5 * (0.9 * k as f64).cos()).collect();
    Chain { tree, bodies: vec![body; LINKS], joints, q, v }
}

fn timed(h: f64, mut step: impl FnMut() -> u32) -> Cost {
    (0..BEFORE).for_each(|_| _ = step());
    let (start, steps) = (Instant::now(), (HORIZON / h).round());
    let iterations: u32 = (0..steps as u32).map(|_| step()).sum();
    (start.elapsed().as_secs_f64() * 1e9 / (steps * LINKS as f64), f64::from(iterations) / steps)
}

impl Chain {
    fn reduced(&self, h: f64) -> Cost {
        let mut method = TreeVariational::new(self.tree.clone(), GRAVITY).expect("a method");
        let mut state = method.state(&self.q, &self.v).expect("a start");
        timed(h, || method.step(&mut state, h).expect("a step").hessians)
    }

    fn full(&self, h: f64) -> Cost {
        let mut motion = TreeMotion::new(self.tree.clone());
        motion.place(&self.q, &self.v).expect("a start");
        let motions: Vec<_> = (0..LINKS).map(|body| motion.body(body).expect("a link")).collect();
        let metric = BodyMetric::<Poses>::new(self.bodies.clone());
        let mut state = metric.state(&motions).expect("a start");
        let load = |body: &Body| PointMass { mass: body.mass(), point: Vector3::zeros() };
        let masses = self.bodies.iter().map(load).collect();
        let weight = Weight { gravity: GRAVITY, masses, space: Poses };
        let system = metric.under(weight).expect("as many bodies");
        let free = FreeBodies(ConstantVelocity);
        let choice = SparseDiagonal::default();
        let mut rattle =
            Rattle::along(free, &system, &self.joints, &state, choice).expect("a start");
        timed(h, || rattle.step(&mut state, h).expect("a step").iterations)
    }
}

fn main() {
    let chain = chain();
    println!("a chain of {LINKS} hinged bodies: ns a link and step (iterations a step)");
    for h in [3e-4, 1e-3, 2e-3] {
        let (mut full, mut reduced) = ((f64::INFINITY, 0.0), (f64::INFINITY, 0.0));
        for _ in 0..RUNS {
            let less = |a: Cost, b: Cost| if a.0 < b.0 { a } else { b };
            full = less(full, chain.full(h));
            reduced = less(reduced, chain.reduced(h));
        }
        println!(
            "  step {h:.0e} s   RATTLE {:6.0} ({:.1})   joint coordinates {:6.0} ({:.1})   ratio {:.3}",
            full.0,
            full.1,
            reduced.0,
            reduced.1,
            reduced.0 / full.0
        );
    }
}
