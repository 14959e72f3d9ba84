//! Bodies that are not there, and numbers that are too few.

use nalgebra::{Vector2, Vector3};
use stationary_calculus::{Covector, Potential, Sink, Vector};
use stationary_constraints::{Constraint, Rows};
use stationary_integrators::{State, Symmetry};
use stationary_rigid::{
    Attachment, BodySpace, BodySpring, Carried, Joint, JointEnd, JointKind, Orientations,
    PlanarEnd, PlanarJoint, PlanarJointKind, PointMass, Poses, Spun, Weight, apply_impulse,
    spatial_angular_momentum,
};

use super::{finite, number, vector};
use crate::{Draw, Verdict};

struct Nothing;

impl Sink for Nothing {
    fn add_symmetric(&mut self, _: &[usize], _: &[f64]) {}
}

impl Rows for Nothing {
    fn add(&mut self, _: usize, _: usize, _: f64) {}
}

/// Springs, spins, impulses and poses of bodies that may not be there.
pub(super) fn absent(draw: &mut Draw) -> Verdict {
    let bodies = draw.between(0, 3);
    let body = draw.between(0, 4);
    let stored = draw.between(0, 7 * bodies);
    let full = draw.chance(0.6);
    let mut q: Vec<f64> = (0..bodies).flat_map(|_| [0.1, 0.2, 0.3, 1.0, 0.0, 0.0, 0.0]).collect();
    let mut p = vec![0.1; 6 * bodies];
    if !full {
        q.truncate(stored);
        p.truncate(draw.between(0, 6 * bodies));
    }
    // Numbers that were cut off may leave whole bodies.
    let there = q.len().is_multiple_of(7) && p.len() == 6 * (q.len() / 7) && body < q.len() / 7;
    draw.note(format!("body {body} of {bodies}, {} places, {} momenta", q.len(), p.len()));
    match draw.below(4) {
        0 => {
            let ends =
                [Attachment::World(vector(draw, 0.1)), Attachment::Body(body, vector(draw, 0.1))];
            let spring = match BodySpring::new(Poses, bodies, number(draw, 3.0, 0.2), ends) {
                Ok(_) if body >= bodies => return Verdict::wrong("a spring pulls at no body"),
                Ok(spring) => spring,
                Err(_) => return Verdict::due(),
            };
            let mut dv = vec![0.0; 6 * bodies];
            let energy = spring.energy(&q);
            spring.add_differential(&q, Covector(&mut dv));
            spring.add_hessian(&q, &mut Nothing);
            match !there && 7 * (body + 1) > q.len() && energy.is_finite() {
                true => Verdict::wrong("a spring pulls at no body"),
                false => Verdict::due(),
            }
        }
        1 => {
            let spun = match Spun::new(Poses, bodies, body, Vector3::z()) {
                Ok(_) if body >= bodies => return Verdict::wrong("no body spins"),
                Ok(spun) => spun,
                Err(_) => return Verdict::due(),
            };
            let (mut xi, mut dxi) = (vec![0.0; 6 * bodies], vec![0.0; 6 * bodies]);
            spun.generator(&q, Vector(&mut xi));
            spun.generator_along(&q, Vector(&p), Vector(&mut dxi));
            let all =
                Carried { velocity: Vector3::x(), angular_velocity: Vector3::z(), space: Poses };
            all.generator(&q, Vector(&mut xi));
            all.generator_along(&q, Vector(&p), Vector(&mut dxi));
            Verdict::due()
        }
        2 => {
            let mut state = State::new(q, Covector(p));
            let before = state.clone();
            let impulse = vector(draw, 0.3) * draw.one_of(&[1.0, 1e308]);
            match apply_impulse::<Poses>(&mut state, body, &vector(draw, 0.3), impulse) {
                Ok(()) if !there => Verdict::wrong("an impulse acts on no body"),
                Ok(()) if !finite(&state.p.0) => Verdict::wrong("a momentum that is not finite"),
                Err(_) if state != before => Verdict::wrong("a refused impulse acts"),
                _ => Verdict::due(),
            }
        }
        _ => {
            let place = Poses::pose(&q, body).is_ok();
            let turned = Orientations::pose(&q, body).is_ok();
            if place != (body < q.len() / 7) || turned != (body < q.len() / 4) {
                return Verdict::wrong(
                    "a body that is absent has a pose, or one that is there none",
                );
            }
            let fit = q.len().is_multiple_of(7) && p.len() == 6 * (q.len() / 7);
            match spatial_angular_momentum::<Poses>(&State::new(q, Covector(p))) {
                Ok(_) if !fit => Verdict::wrong("a momentum of sizes that do not fit"),
                Err(error) if fit => Verdict::wrong(error),
                _ => Verdict::due(),
            }
        }
    }
}

/// Potentials and joints asked of too few numbers.
pub(super) fn short(draw: &mut Draw) -> Verdict {
    let (stored, given) = (draw.between(0, 15), draw.between(0, 6));
    let q: Vec<f64> = (0..stored).map(|_| draw.symmetric()).collect();
    draw.note(format!("{stored} places, {given} values"));
    let ends = [JointEnd::on(0, Vector3::x()), JointEnd::on(1, Vector3::y())];
    let mut g = vec![0.0; given];
    match draw.below(4) {
        0 => {
            let masses = vec![PointMass { mass: 1.0, point: Vector3::x() }; 2];
            let weight = Weight { gravity: Vector3::z(), masses, space: Poses };
            let mut dv = vec![0.0; draw.between(0, 12)];
            let energy = weight.energy(&q);
            weight.add_differential(&q, Covector(&mut dv));
            weight.add_hessian(&q, &mut Nothing);
            match stored < 14 && energy.is_finite() {
                true => Verdict::wrong("too few numbers have a weight"),
                false => Verdict::due(),
            }
        }
        1 => {
            let ends = [PlanarEnd::on(0, Vector2::x()), PlanarEnd::on(1, Vector2::y())];
            match PlanarJoint::new(2, PlanarJointKind::Weld, ends) {
                Ok(joint) => asked(&joint, &q, &mut g, 6),
                Err(error) => Verdict::wrong(error),
            }
        }
        2 => match Joint::new(Orientations, 2, JointKind::Hinge { axis: Vector3::z() }, ends) {
            Ok(joint) => asked(&joint, &q, &mut g, 8),
            Err(error) => Verdict::wrong(error),
        },
        _ => match Joint::new(Poses, 2, JointKind::Weld, ends) {
            Ok(joint) => asked(&joint, &q, &mut g, 14),
            Err(error) => Verdict::wrong(error),
        },
    }
}

fn asked(joint: &impl Constraint, q: &[f64], g: &mut [f64], needed: usize) -> Verdict {
    let (enough, fit) = (q.len() >= needed, g.len() == joint.count());
    let value = joint.value(0.0, q, g).is_ok() == (enough && fit);
    let differential = joint.differential(0.0, q, &mut Nothing).is_ok() == enough;
    let hessian = joint.add_hessian(0.0, q, g, &mut Nothing).is_ok() == (enough && fit);
    if !(value && differential && hessian) {
        return Verdict::wrong("a joint takes sizes that do not fit, or refuses those that do");
    }
    let scale = joint.scale(g.len() + 3);
    match scale.slope > 0.0 && scale.length > 0.0 {
        true => Verdict::due(),
        false => Verdict::wrong("a scale that is not positive"),
    }
}
