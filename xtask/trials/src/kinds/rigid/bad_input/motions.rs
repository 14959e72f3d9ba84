//! Bodies, their states and their motions of bad numbers.

use nalgebra::Vector3;
use stationary_calculus::Covector;
use stationary_constraints::{ConstrainedIntegrator, Dense, Rattle, Redundancy, SparseDiagonal};
use stationary_integrators::State;
use stationary_rigid::{
    Body, BodyMethod, BodyMetric, BodyMotion, BodyStore, ConstantVelocity, Free, FreeBodies,
    FreeTop, Joint, JointEnd, JointKind, LieGroup, Poses, RigidMotion, Rotation,
};

use super::{box_of_one, finite, number, unit, vector};
use crate::{Draw, Verdict};

/// A state with a bad number or a quaternion of another length, stepped by every method.
pub(super) fn states(draw: &mut Draw) -> Verdict {
    let metric = BodyMetric::<Poses>::new(vec![box_of_one(); 2]);
    let mut state = State::new(
        vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.6, 0.8, 0.0],
        Covector(vec![0.0, 0.0, 0.0, 0.1, 0.0, 0.2, 0.0, 0.0, 0.0, 0.1, 0.0, 0.2]),
    );
    let mut h = 0.01;
    match draw.below(6) {
        0 => state.q[draw.below(14)] = draw.any_f64(),
        1 => state.p.0[draw.below(12)] = draw.any_f64(),
        2 => state.t = draw.any_f64(),
        3 => h = draw.any_f64(),
        4 => {
            let (body, scale) = (draw.below(2), draw.log_uniform(0.1, 10.0));
            state.q[7 * body + 3..7 * body + 7].iter_mut().for_each(|c| *c *= scale);
        }
        _ => {
            state.q.truncate(draw.below(15));
            state.p.0.truncate(draw.below(13));
        }
    }
    let which = draw.below(BodyMethod::ALL.len() + 2);
    draw.note(format!("{state:?}, h {h:e}, method {which}"));
    let sized = state.q.len() == 14 && state.p.0.len() == 12;
    let good = sized
        && state.t.is_finite()
        && finite(&state.q)
        && finite(&state.p.0)
        && unit(&state.q[3..7])
        && unit(&state.q[10..14]);
    let Ok(system) = metric.under(Free { freedoms: 12 }) else {
        return Verdict::wrong("no system");
    };
    let before = state.clone();
    let stepped = match BodyMethod::ALL.get(which) {
        Some(method) => match method.integrator(&system) {
            Ok(mut integrator) => {
                integrator.step(&mut state, h).map(|_| ()).map_err(|e| e.to_string())
            }
            Err(error) => return Verdict::wrong(format!("no method: {error}")),
        },
        None => {
            let ends = [
                JointEnd::on(0, Vector3::new(0.5, 0.0, 0.0)),
                JointEnd::on(1, Vector3::new(-0.5, 0.0, 0.0)),
            ];
            // A joint whose feasibility does not tell: at the centres, or none at all.
            let joints: Vec<Joint<Poses>> = match draw.chance(0.5) {
                true => vec![],
                false => match Joint::new(Poses, 2, JointKind::Ball, ends) {
                    Ok(joint) => vec![joint],
                    Err(error) => return Verdict::wrong(format!("no joint: {error}")),
                },
            };
            let motion = FreeBodies(ConstantVelocity);
            let made = match which == BodyMethod::ALL.len() {
                true => {
                    Rattle::along(motion, &system, &joints, &state, Dense::<3>(Redundancy::Refuse))
                        .and_then(|mut rattle| rattle.step(&mut state, h))
                }
                false => Rattle::along(
                    motion,
                    &system,
                    &joints,
                    &state,
                    SparseDiagonal(Redundancy::Refuse),
                )
                .and_then(|mut rattle| rattle.step(&mut state, h)),
            };
            made.map(|_| ()).map_err(|e| e.to_string())
        }
    };
    match stepped {
        Ok(()) if !good => Verdict::wrong("a bad state is moved"),
        Ok(()) if !(finite(&state.q) && finite(&state.p.0) && state.t.is_finite()) => {
            Verdict::wrong("a step leads to what is not finite")
        }
        Ok(()) => Verdict::due(),
        Err(_) => {
            let bits = |a: &[f64], b: &[f64]| {
                a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
            };
            match bits(&state.q, &before.q) && bits(&state.p.0, &before.p.0) {
                true => Verdict::due(),
                false => Verdict::wrong("a failed step moved the state"),
            }
        }
    }
}

pub(super) fn bodies(draw: &mut Draw) -> Verdict {
    let mass = number(draw, 1.0, 0.4);
    let three = [number(draw, 0.1, 0.4), number(draw, 0.2, 0.4), number(draw, 0.25, 0.4)];
    draw.note(format!("mass {mass:e}, {three:?}"));
    match draw.below(3) {
        0 => match Body::new(mass, three) {
            Ok(body)
                if !(mass > 0.0
                    && three.iter().all(|&i| i > 0.0)
                    && finite(body.moments().as_slice())) =>
            {
                Verdict::wrong("what is no body is taken")
            }
            _ => Verdict::due(),
        },
        1 => match Body::solid_box(mass, three) {
            Ok(body) => {
                let sizes = three.iter().all(|&a| a >= 0.0);
                match sizes && mass > 0.0 && finite(body.moments().as_slice()) {
                    true => Verdict::due(),
                    false => Verdict::wrong("a box of no size is taken"),
                }
            }
            Err(_) => Verdict::due(),
        },
        _ => {
            let motion = BodyMotion {
                pose: RigidMotion {
                    translation: vector(draw, 0.3),
                    rotation: Rotation::identity(),
                },
                velocity: vector(draw, 0.3),
                angular_velocity: vector(draw, 0.3),
            };
            let gravity = vector(draw, 0.3);
            let count = draw.between(0, 2);
            match BodyStore::new(
                vec![box_of_one(); count],
                &vec![motion; draw.between(0, 2)],
                gravity,
            ) {
                Ok(mut store) => {
                    let moved = store.step(number(draw, 0.1, 0.3)).and_then(|()| store.check());
                    let motion = store.motion(draw.below(3));
                    let numbers = motion.is_none_or(|m| finite(m.velocity.as_slice()));
                    match moved.is_ok() && !(numbers && store.time().is_finite()) {
                        true => Verdict::wrong("a store checks what is not finite"),
                        false => Verdict::due(),
                    }
                }
                Err(_) => Verdict::due(),
            }
        }
    }
}

pub(super) fn tops(draw: &mut Draw) -> Verdict {
    let w = vector(draw, 0.6) * draw.one_of(&[1.0, 1e-200, 1e200]);
    let t = number(draw, 1.0, 0.5);
    draw.note(format!("w {w:?}, t {t:e}"));
    let body = box_of_one();
    match FreeTop::new(body, Rotation::identity(), w) {
        Ok(top) => {
            let _ = top.period();
            match (top.orientation(t), top.momentum(t)) {
                (Ok(turn), Ok(m)) if !(unit(&turn.quaternion()) && finite(m.as_slice())) => {
                    Verdict::wrong("a top that is nowhere")
                }
                (Ok(_), Ok(_)) if !t.is_finite() => Verdict::wrong("a top at no time"),
                _ => Verdict::due(),
            }
        }
        Err(_) => Verdict::due(),
    }
}
