//! Small motions of random mechanisms about a pose where they rest: full coordinates beside joint coordinates.
//!
//! ```text
//! full      stiffness N^T (d2V + sum lambda_i d2g_i) N, J N = 0, by `linearize`
//! reduced   K = d tau/dq by differences of inverse dynamics,  K x = omega^2 M x  by the tree's mass matrix
//! ```
//! The pose is found in joint coordinates, by Newton's method.

use nalgebra::{DMatrix, DVector, Vector3};
use stationary_calculus::{Space, Vector};
use stationary_constraints::Constraint;
use stationary_rigid::tree::{Tree, TreeBuilder, TreeForces, TreeMotion};
use stationary_rigid::{
    Attachment, Body, BodyMetric, BodySpring, Joint, JointEnd, PointMass, Poses, Weight, assemble,
    linearize, mobility,
};

use super::driven::{direction, frame, kind};
use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "small-motions",
    krate: "rigid",
    rule: "a square frequency of a random tree of bodies under weight and springs, about a pose where it \
           rests, differs from that of the same tree in joint coordinates by more than 1e-9 of itself, 1e-11 \
           of the largest and what differences and the tree's own rounding lose; its freedoms are counted \
           wrongly; an assembled pose is open by more than 1e-12 or far from a guess beside a closed one",
    in_tests: 50,
    trial,
};

/// A spring between a point of a body and one of the world.
#[derive(Clone, Copy, Debug)]
struct Tie {
    body: usize,
    points: [Vector3<f64>; 2],
    stiffness: f64,
    rest: f64,
}

/// A tree in joint coordinates under weight and ties.
struct Reduced<'a> {
    tree: &'a Tree,
    motion: TreeMotion,
    gravity: Vector3<f64>,
    ties: &'a [Tie],
}

impl Reduced<'_> {
    /// What the joints would have to push to hold the pose.
    fn torques(&mut self, q: &[f64]) -> Option<DVector<f64>> {
        let still = vec![0.0; self.tree.speeds()];
        self.motion.place(q, &still).ok()?;
        let mut forces = TreeForces::weight(self.tree, self.gravity).ok()?;
        for tie in self.ties {
            let pose = self.motion.pose(tie.body).ok()?;
            let place = pose.translation + pose.rotation.rotate(&tie.points[0]);
            let apart = tie.points[1] - place;
            let force = apart.normalize() * (tie.stiffness * (apart.norm() - tie.rest));
            forces.add_force(&self.motion, tie.body, &tie.points[0], force).ok()?;
        }
        let mut torques = still.clone();
        self.motion.inverse_dynamics(&forces, &still, &mut torques).ok()?;
        Some(DVector::from_vec(torques))
    }

    fn moved(&self, q: &[f64], by: &[f64]) -> Option<Vec<f64>> {
        let mut moved = q.to_vec();
        self.tree.advance(&mut moved, by).ok()?;
        Some(moved)
    }

    /// The slope of the torques, by differences of fourth order.
    fn stiffness(&mut self, q: &[f64], step: f64) -> Option<DMatrix<f64>> {
        let n = self.tree.speeds();
        let mut columns = Vec::new();
        for k in 0..n {
            let mut column = DVector::zeros(n);
            for (steps, weight) in [(-2.0, 1.0), (-1.0, -8.0), (1.0, 8.0), (2.0, -1.0)] {
                let mut by = vec![0.0; n];
                by[k] = steps * step;
                let moved = self.moved(q, &by)?;
                column += self.torques(&moved)? * (weight / (12.0 * step));
            }
            columns.push(column);
        }
        Some(DMatrix::from_columns(&columns))
    }

    fn mass(&mut self, q: &[f64]) -> Option<DMatrix<f64>> {
        let n = self.tree.speeds();
        self.motion.place(q, &vec![0.0; n]).ok()?;
        let mut matrix = DMatrix::zeros(n, n);
        self.motion.mass_matrix(matrix.as_mut_slice()).ok()?;
        Some(matrix)
    }

    /// A pose without torques, near `q`.
    fn rest(&mut self, mut q: Vec<f64>) -> Option<Vec<f64>> {
        let size = |torques: &DVector<f64>, mass: &DMatrix<f64>| {
            torques.iter().zip(mass.diagonal().iter()).map(|(t, m)| t * t / m).sum::<f64>().sqrt()
        };
        let mut torques = self.torques(&q)?;
        for _ in 0..60 {
            let (mass, stiffness) = (self.mass(&q)?, self.stiffness(&q, STEP)?);
            let mut step = -stiffness.lu().solve(&torques)?;
            let largest = step.amax();
            if largest < 1e-13 {
                return Some(q);
            }
            step *= f64::min(1.0, 0.5 / largest);
            let mut taken = false;
            for _ in 0..12 {
                let tried = self.moved(&q, step.as_slice())?;
                let left = self.torques(&tried)?;
                if size(&left, &mass) < size(&torques, &mass) {
                    (q, torques, taken) = (tried, left, true);
                    break;
                }
                step *= 0.5;
            }
            if !taken {
                return (largest < 1e-10).then_some(q);
            }
        }
        None
    }
}

/// Radians or metres between two poses of a difference.
const STEP: f64 = 1e-3;

fn trial(draw: &mut Draw) -> Verdict {
    let n = draw.between(1, 5);
    let ratio = draw.one_of(&[1.0 + 1e-9, 1e1, 1e3, 1e6, 1e9]);
    let (mut builder, mut joints, mut bodies) = (TreeBuilder::default(), vec![], vec![]);
    for body in 0..n {
        let mass = draw.log_uniform(1.0, ratio);
        let half = [0; 3].map(|_| draw.log_uniform(0.05, 0.5));
        let own = Body::solid_box(mass, half).expect("a box");
        let parent = (body > 0).then(|| draw.below(body));
        let (kind, frames) = (kind(draw), [frame(draw), frame(draw)]);
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
    if draw.chance(0.2) {
        // Said twice: every equation of it is redundant.
        let again = joints[draw.below(n)].clone();
        joints.push(again);
    }
    let tree = match builder.build() {
        Ok(tree) => tree,
        Err(error) => return Verdict::wrong(error),
    };
    if tree.speeds() == 0 {
        return Verdict::not_judged("all welded");
    }
    let gravity = Vector3::new(0.0, 0.3, -1.0) * 9.0;
    let ties: Vec<Tie> = (0..n)
        .flat_map(|body| [body; 2])
        .filter(|_| draw.chance(0.8))
        .collect::<Vec<_>>()
        .into_iter()
        .map(|body| Tie {
            body,
            points: [0; 2].map(|_| direction(draw) * draw.log_uniform(0.05, 2.0)),
            stiffness: bodies[body].mass() * draw.log_uniform(1.0, 1e3),
            rest: draw.one_of(&[0.0, 0.5, 1.0]),
        })
        .collect();
    draw.note(format!("{n} bodies, ratio {ratio:.0e}, {ties:?}"));
    draw.note(format!("{:?}", joints.iter().map(|joint| joint.kind()).collect::<Vec<_>>()));
    let mut reduced =
        Reduced { tree: &tree, motion: TreeMotion::new(tree.clone()), gravity, ties: &ties };
    let Some(q) = reduced.rest(tree.rest()) else {
        return Verdict::not_judged("no pose where it rests was found");
    };
    // The mass matrix last: it leaves the tree where it rests.
    let (Some(stiffness), Some(rougher), Some(mass)) =
        (reduced.stiffness(&q, STEP), reduced.stiffness(&q, 2.0 * STEP), reduced.mass(&q))
    else {
        return Verdict::not_judged("no stiffness");
    };
    let Some(scaled) =
        [&stiffness, &rougher].map(|k| in_metric(&mass, k)).into_iter().collect::<Option<Vec<_>>>()
    else {
        return Verdict::not_judged("a mass matrix without a factor");
    };
    let truth = sorted(&((&scaled[0] + scaled[0].transpose()) * 0.5));
    let lost = (&scaled[0] - scaled[0].transpose()).norm() + (&scaled[0] - &scaled[1]).norm();
    let motions: Vec<_> =
        (0..n).map(|body| reduced.motion.body(body).expect("a body that is there")).collect();
    let metric = BodyMetric::<Poses>::new(bodies.clone());
    let state = match metric.state(&motions) {
        Ok(state) => state,
        Err(error) => return Verdict::wrong(error),
    };
    let masses =
        bodies.iter().map(|b| PointMass { mass: b.mass(), point: Vector3::zeros() }).collect();
    let springs: Result<Vec<_>, _> = ties
        .iter()
        .map(|tie| {
            let ends =
                [Attachment::Body(tie.body, tie.points[0]), Attachment::World(tie.points[1])];
            BodySpring::new(Poses, n, tie.stiffness, ends)?.with_rest_length(tie.rest)
        })
        .collect();
    let springs = match springs {
        Ok(springs) => springs,
        Err(error) => return Verdict::wrong(error),
    };
    let system = match metric.under((Weight { gravity, masses, space: Poses }, springs)) {
        Ok(system) => system,
        Err(error) => return Verdict::wrong(error),
    };
    let free = match mobility(system.metric(), &joints, 0.0, &state.q) {
        Ok(found) if found.freedoms == truth.len() => Verdict::due(),
        Ok(found) => {
            return Verdict::wrong(format!("{} freedoms of {}", found.freedoms, truth.len()));
        }
        Err(error) => Verdict::refused(format!("mobility: {error}")),
    };
    let shaken: Vec<f64> = (0..6 * n).map(|_| 0.02 * draw.symmetric()).collect();
    let mut guess = state.q.clone();
    Poses.advance(&mut guess, 1.0, Vector(&shaken));
    let closed = match assemble(system.metric(), &joints, 0.0, &guess) {
        Ok(closed) => {
            let mut gaps = vec![0.0; joints.count()];
            let read = joints.value(0.0, &closed.q, &mut gaps).is_ok();
            let open = gaps.iter().fold(0.0_f64, |open, g| open.max(g.abs()));
            draw.note(format!("{} iterations", closed.iterations));
            let far =
                closed.q.iter().zip(&state.q).fold(0.0_f64, |far, (a, b)| far.max((a - b).abs()));
            let near =
                Verdict::of(far, 1.0, "an assembled pose beside one that is shaken by a fiftieth");
            if read {
                near.and(Verdict::of(open, 1e-12, "what is open of an assembled pose"))
            } else {
                Verdict::wrong("no gaps")
            }
        }
        Err(error) => Verdict::refused(format!("assemble: {error}")),
    };
    let free = free.and(closed);
    let found = match linearize(&system, &joints, 0.0, &state.q) {
        Ok(found) => found,
        Err(error) => return free.and(Verdict::refused(error)),
    };
    if found.stiffness.nrows() != truth.len() {
        let (found, truth) = (found.stiffness.nrows(), truth.len());
        return Verdict::wrong(format!("{found} small motions of {truth} freedoms"));
    }
    let largest = scaled[0].norm();
    // Heavy bodies on a light one: their sum rounds its share of the mass matrix away.
    let rounded = 1e-9 + 30.0 * f64::EPSILON * condition(&mass);
    let off = sorted(&found.stiffness).iter().zip(&truth).fold(0.0_f64, |off, (a, b)| {
        off.max((a - b).abs() / (rounded * b.abs() + 1e-11 * largest + lost))
    });
    free.and(Verdict::of(off, 1.0, "square frequencies, full and reduced"))
}

/// `L^-1 K L^-T` of the Cholesky factor of the masses.
fn in_metric(mass: &DMatrix<f64>, stiffness: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let factor = mass.clone().cholesky()?.l();
    let left = factor.solve_lower_triangular(stiffness)?;
    Some(factor.solve_lower_triangular(&left.transpose())?.transpose())
}

fn sorted(matrix: &DMatrix<f64>) -> Vec<f64> {
    let mut values: Vec<f64> = matrix.symmetric_eigenvalues().iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values
}

fn condition(mass: &DMatrix<f64>) -> f64 {
    let values = sorted(mass);
    values.last().map_or(1.0, |largest| largest / values[0].max(f64::MIN_POSITIVE))
}
