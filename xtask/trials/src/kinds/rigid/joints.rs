//! Bodies on joints: open, closed, with more equations than they need, heavy beside light.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use stationary_calculus::System;
use stationary_constraints::{
    ConstrainedHamilton, ConstrainedIntegrator, Constraint, ConstraintError, Projection, Rattle,
    Redundancy, SparseDiagonal, SparseGeneral,
};
use stationary_integrators::State;
use stationary_rigid::{
    AxisRotations, BodyMetric, BodyMotion, BodySpace, ConstantVelocity, ExactRotation, FreeBodies,
    Joint, LieGroup, PointMass, Poses, RigidMotion, Weight, spatial_angular_momentum,
};

use super::independence::independence;
use super::linkage::{Linkage, Shape};
use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "joints",
    krate: "rigid",
    rule: "a joint opens, a free linkage loses momentum, or a body on a ball joint is not where \
           Euler's equations lead, to the differences of three steps; one solver refuses a step that \
           another makes that has seen the same positions, above what the page says of shared forces, and \
           not as beside a singular position where the step begins or ends beside one; an error names an \
           absurd violation",
    in_tests: 60,
    trial,
};

type Problem = System<BodyMetric<Poses>, Weight<Poses>, Poses>;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    Constant,
    Axes,
    Exact,
    /// What a newcomer writes: straight motions, before they were refused for bodies.
    Plain,
    Hamilton,
}

/// What is independent by less than this, masses counted, need not be shared by least norm.
const SHARED: f64 = 1e-4;
/// Places less independent than this part of the most independent one are beside a singular position, as the
/// page has it: there slow iterations and unlike impulses are told by rounding, which two solvers do not share.
const BESIDE: f64 = 0.2;
/// Steps between two looks at how independent the equations are.
const EVERY: usize = 10;

type Made<'s> = Result<Box<dyn ConstrainedIntegrator<Vec<f64>> + 's>, ConstraintError>;

fn method<'s>(
    way: Way,
    many: bool,
    redundancy: Redundancy,
    system: &'s Problem,
    joints: &'s Vec<Joint<Poses>>,
    state: &State<Vec<f64>>,
) -> Made<'s> {
    macro_rules! with {
        ($choice:expr) => {
            match way {
                Way::Constant => {
                    let motion = FreeBodies(ConstantVelocity);
                    Box::new(Rattle::along(motion, system, joints, state, $choice)?)
                }
                Way::Axes => {
                    let motion = FreeBodies(AxisRotations);
                    Box::new(Rattle::along(motion, system, joints, state, $choice)?)
                }
                Way::Exact => {
                    let motion = FreeBodies(ExactRotation);
                    Box::new(Rattle::along(motion, system, joints, state, $choice)?)
                }
                Way::Plain => {
                    let motion = FreeBodies(ConstantVelocity);
                    Box::new(Rattle::along(motion, system, joints, state, $choice)?)
                }
                Way::Hamilton => {
                    let motion = FreeBodies(ConstantVelocity);
                    Box::new(ConstrainedHamilton::along(motion, system, joints, state, $choice)?)
                }
            }
        };
    }
    Ok(match many {
        false if redundancy == Redundancy::Refuse => with!(SparseGeneral),
        _ => with!(SparseDiagonal(redundancy)),
    })
}

fn is_absurd(error: &ConstraintError) -> bool {
    let violation = match *error {
        ConstraintError::NotConverged { violation, .. }
        | ConstraintError::Diverged { violation, .. }
        | ConstraintError::Infeasible { violation, .. } => violation,
        _ => 0.0,
    };
    violation.is_nan() || violation > 1e6
}

fn poses(q: &[f64]) -> Vec<RigidMotion> {
    (0..q.len() / 7).map(|body| Poses::pose_at(q, body)).collect()
}

fn trial(draw: &mut Draw) -> Verdict {
    let linkage = Linkage::draw(draw);
    let loops = matches!(linkage.shape, Shape::PlanarLoop | Shape::Bennett);
    let way = draw.one_of(&[Way::Constant, Way::Axes, Way::Exact, Way::Plain, Way::Hamilton]);
    let redundancy = if loops {
        Redundancy::LeastNorm
    } else {
        draw.one_of(&[Redundancy::Refuse, Redundancy::LeastNorm])
    };
    let many = draw.chance(0.5);
    let turn = draw.log_uniform(1e-3, 0.2) / linkage.mass_ratio().sqrt().min(30.0);
    let gravity = if draw.chance(0.5) { Vector3::new(0.0, 0.3, -1.0) } else { Vector3::zeros() };
    let steps = draw.one_of(&[20, 20, 20, 400]);
    let joints = match linkage.joints() {
        Ok(joints) => joints,
        Err(error) => return Verdict::refused(error),
    };
    draw.note(format!(
        "{:?} {way:?} many {many} {redundancy:?}, {} bodies, {} equations, turn {turn:.2e}, {steps} steps, \
         gravity {gravity:?}, hung {}, masses {:?}",
        linkage.shape,
        linkage.bodies.len(),
        joints.count(),
        linkage.hung,
        linkage.bodies.iter().map(|b| b.mass()).collect::<Vec<_>>()
    ));
    draw.note(format!("pins {:?}", linkage.pins));
    let metric = BodyMetric::<Poses>::new(linkage.bodies.clone());
    let motions: Vec<BodyMotion> = linkage
        .poses
        .iter()
        .map(|&pose| BodyMotion {
            pose,
            velocity: Vector3::from_fn(|_, _| draw.symmetric()),
            angular_velocity: Vector3::from_fn(|_, _| draw.symmetric()),
        })
        .collect();
    let mut state = match metric.state(&motions) {
        Ok(state) => state,
        Err(error) => return Verdict::refused(error),
    };
    let load =
        |body: &stationary_rigid::Body| PointMass { mass: body.mass(), point: Vector3::zeros() };
    let masses = linkage.bodies.iter().map(load).collect();
    let Ok(system) = metric.under(Weight { gravity, masses, space: Poses }) else {
        return Verdict::wrong("no system");
    };
    // A velocity that opens nothing, the fastest body turning by 1 rad/s.
    let shared = SparseDiagonal(Redundancy::LeastNorm);
    let projected = Projection::new(&system, &joints, &state, shared)
        .and_then(|mut projection| projection.project(&mut state));
    if let Err(error) = projected {
        return if loops { Verdict::not_judged(error) } else { Verdict::refused(error) };
    }
    let fastest = (0..linkage.bodies.len())
        .map(|k| {
            let m = Vector3::from_column_slice(&state.p.0[6 * k + 3..][..3]);
            linkage.bodies[k].angular_velocity(&m).norm()
        })
        .fold(1e-3, f64::max);
    state.p.0.iter_mut().for_each(|p| *p /= fastest);
    let verdict =
        stepped(draw, &linkage, &system, &joints, &state, (way, many, redundancy), turn, steps);
    let judged = linkage.shape == Shape::Single && matches!(verdict, Verdict::Right { .. });
    if !judged {
        return verdict;
    }
    verdict.and(about_the_point(&linkage, &system, &joints, &state, (way, many, redundancy), turn))
}

fn linear(p: &[f64]) -> Vector3<f64> {
    p.chunks_exact(6).map(|p| Vector3::new(p[0], p[1], p[2])).sum()
}

#[expect(clippy::too_many_arguments, reason = "one case in its parts")]
fn stepped(
    draw: &mut Draw,
    linkage: &Linkage,
    system: &Problem,
    joints: &Vec<Joint<Poses>>,
    start: &State<Vec<f64>>,
    (way, many, redundancy): (Way, bool, Redundancy),
    h: f64,
    steps: usize,
) -> Verdict {
    let mut state = start.clone();
    let begin = method(way, many, redundancy, system, joints, &state);
    let mut integrator = match begin {
        Ok(integrator) => integrator,
        Err(error) => return Verdict::refused(error),
    };
    // Goes along, so that it has seen the same positions.
    let mut other = method(way, !many, redundancy, system, joints, &state);
    let independent = |q: &[f64]| independence(&linkage.bodies, joints, q);
    let mut typical = 0.0_f64;
    let mut verdict = Verdict::due();
    let largest = start.q.iter().fold(1.0_f64, |a, x| a.max(x.abs()));
    for step in 0..steps {
        let before = state.clone();
        let mut again = before.clone();
        let by_other = match &mut other {
            Ok(other) => other.step(&mut again, h),
            Err(error) => Err(error.clone()),
        };
        if step % EVERY == 0 {
            typical = typical.max(independent(&before.q));
        }
        if let Err(error) = integrator.step(&mut state, h) {
            draw.note(format!("step {step}: {error}"));
            if state != before {
                return Verdict::wrong("a failed step moved the state");
            }
            if is_absurd(&error) {
                return Verdict::wrong(format!("step {step} says: {error}"));
            }
            // Rounding may hide the rank there, as the page says.
            if redundancy == Redundancy::LeastNorm
                && matches!(error, ConstraintError::RankUnclear { .. })
                && independent(&before.q) < SHARED
            {
                return Verdict::refused(error);
            }
            let beside = [&before, &again].map(|state| independent(&state.q));
            let beside = beside.into_iter().any(|place| place < BESIDE * typical);
            return match by_other {
                Ok(_) if beside && matches!(error, ConstraintError::SingularPosition { .. }) => {
                    Verdict::refused(error)
                }
                Ok(_) => Verdict::wrong(format!("only one solver refuses step {step}: {error}")),
                Err(_) => Verdict::refused(error),
            };
        }
        // A body on a slider may go far, and what is rounding grows with the distance.
        let largest = state.q.iter().fold(largest, |a, x| a.max(x.abs()));
        let open = linkage.opening(&poses(&state.q));
        verdict = verdict.and(Verdict::of(open, 3e-12 + 2e-14 * largest, "a joint's opening"));
        if matches!(verdict, Verdict::Wrong { .. }) {
            return verdict;
        }
    }
    let free = !linkage.hung && system.potential().gravity == Vector3::zeros();
    if free {
        let scale: f64 = start.p.0.iter().chain(&state.p.0).map(|p| p.abs()).sum::<f64>().max(1e-6);
        let off = (linear(&state.p.0) - linear(&start.p.0)).norm();
        verdict = verdict.and(Verdict::of(off, 1e-12 * scale, "linear momentum"));
        let spins = [&state, start].map(spatial_angular_momentum::<Poses>);
        let [Ok(end), Ok(begin)] = spins else { return Verdict::wrong("no momentum") };
        let spin = end - begin;
        let reach = state.q.iter().fold(largest, |a, x| a.max(x.abs()));
        let allowed = 2e-12 * scale * reach;
        verdict = verdict.and(Verdict::of(spin.norm(), allowed, "spatial angular momentum"));
    }
    verdict
}

/// One body on a ball joint by Euler's equations about the joint, in steps a sixteenth as long.
fn about_the_point(
    linkage: &Linkage,
    system: &Problem,
    joints: &Vec<Joint<Poses>>,
    start: &State<Vec<f64>>,
    (way, many, redundancy): (Way, bool, Redundancy),
    h: f64,
) -> Verdict {
    let steps = 20;
    let run = |parts: usize| -> Result<RigidMotion, ConstraintError> {
        let mut state = start.clone();
        let mut integrator = method(way, many, redundancy, system, joints, &state)?;
        for _ in 0..parts * steps {
            integrator.step(&mut state, h / parts as f64)?;
        }
        Ok(poses(&state.q)[0])
    };
    let (coarse, fine, finest) = match (run(1), run(2), run(4)) {
        (Ok(coarse), Ok(fine), Ok(finest)) => (coarse, fine, finest),
        (Err(error), ..) | (_, Err(error), _) | (.., Err(error)) => return Verdict::refused(error),
    };
    let body = &linkage.bodies[0];
    let first = poses(&start.q)[0];
    let [w, x, y, z] = first.rotation.quaternion();
    let mut q = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
    // From the joint to the centre, in body axes.
    let arm = q.inverse() * (first.translation - linkage.pins[0].point);
    let about = Matrix3::from_diagonal(&body.moments())
        + (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * body.mass();
    let Some(inverse) = about.try_inverse() else { return Verdict::not_judged("no inertia") };
    let mut m = about * body.angular_velocity(&Vector3::from_column_slice(&start.p.0[3..6]));
    let gravity = system.potential().gravity;
    let slope = |q: &Quaternion<f64>, m: &Vector3<f64>| {
        let w = inverse * m;
        let pull = UnitQuaternion::from_quaternion(*q).inverse() * gravity * body.mass();
        (q * Quaternion::from_imag(w) * 0.5, m.cross(&w) + arm.cross(&pull))
    };
    let e = h / 16.0;
    for _ in 0..16 * steps {
        let at = *q.quaternion();
        let (a, b) = slope(&at, &m);
        let (c, d) = slope(&(at + a * (0.5 * e)), &(m + b * (0.5 * e)));
        let (f, g) = slope(&(at + c * (0.5 * e)), &(m + d * (0.5 * e)));
        let (i, j) = slope(&(at + f * e), &(m + g * e));
        q = UnitQuaternion::from_quaternion(at + (a + (c + f) * 2.0 + i) * (e / 6.0));
        m += (b + (d + g) * 2.0 + j) * (e / 6.0);
    }
    let exact = linkage.pins[0].point + q * arm;
    let off = (finest.translation - exact).norm();
    let attitude = (finest.rotation.matrix() - q.to_rotation_matrix().matrix()).norm();
    // Errors a h + b h^2 may be the same at two steps, but not at three.
    let moved = |a: &RigidMotion, b: &RigidMotion| (a.translation - b.translation).norm();
    let apart = moved(&coarse, &fine) + moved(&fine, &finest);
    let turn =
        |a: &RigidMotion, b: &RigidMotion| (a.rotation.matrix() - b.rotation.matrix()).norm();
    let turned = turn(&coarse, &fine) + turn(&fine, &finest);
    let reach = arm.norm();
    Verdict::of(off, 2.0 * apart + 1e-9 * reach, "the body's place").and(Verdict::of(
        attitude,
        2.0 * turned + 1e-9,
        "the body's attitude",
    ))
}
