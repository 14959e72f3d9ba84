//! Every constructor and function of the crate with bad numbers and sizes.

use nalgebra::{DMatrix, Matrix3, Vector2, Vector3};
use stationary_calculus::{Covector, Potential, Sink, System, Vector};
use stationary_constraints::{
    ConstrainedIntegrator, Constraint, Few, Many, Rattle, Redundancy, Rows,
};
use stationary_integrators::{State, Symmetry};
use stationary_rigid::{
    Attachment, Body, BodyMethod, BodyMetric, BodyMotion, BodySpace, BodySpring, BodyStore,
    Carried, ConstantVelocity, EulerAngles, Free, FreeBodies, FreeTop, Joint, LieGroup,
    Orientations, PlanarAttachment, PlanarJoint, PlanarMass, PointMass, Poses, PrincipalFrame,
    RigidMotion, Rotation, SpatialMass, Spun, Weight, apply_impulse, matrix_exponential,
    matrix_logarithm, null_space, spatial_angular_momentum,
};

use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "bad-input-rigid",
    krate: "rigid",
    rule: "a panic or a hang; Ok where numbers or sizes are bad or a body is absent, or Ok with \
           numbers that are not finite",
    in_tests: 2000,
    trial,
};

fn trial(draw: &mut Draw) -> Verdict {
    match draw.below(9) {
        0 => states(draw),
        1 => bodies(draw),
        2 => absent(draw),
        3 => short(draw),
        4 => rotations(draw),
        5 => matrices(draw),
        6 => masses(draw),
        7 => tops(draw),
        _ => joints(draw),
    }
}

fn number(draw: &mut Draw, good: f64, bad: f64) -> f64 {
    if draw.chance(bad) { draw.any_f64() } else { good }
}

fn vector(draw: &mut Draw, bad: f64) -> Vector3<f64> {
    let mut v = Vector3::from_fn(|_, _| draw.symmetric());
    if draw.chance(bad) {
        v[draw.below(3)] = draw.any_f64();
    }
    v
}

fn finite(numbers: &[f64]) -> bool {
    numbers.iter().all(|x| x.is_finite())
}

fn unit(q: &[f64]) -> bool {
    (q.iter().map(|c| c * c).sum::<f64>().sqrt() - 1.0).abs() < 1e-6
}

fn box_of_one() -> Body {
    Body::solid_box(1.0, [0.1, 0.2, 0.3]).expect("a box")
}

/// A state with a bad number or a quaternion of another length, stepped by every method.
fn states(draw: &mut Draw) -> Verdict {
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
                Attachment::Body(0, Vector3::new(0.5, 0.0, 0.0)),
                Attachment::Body(1, Vector3::new(-0.5, 0.0, 0.0)),
            ];
            // A joint whose feasibility does not tell: at the centres, or none at all.
            let joints: Vec<Joint<Poses>> = match draw.chance(0.5) {
                true => vec![],
                false => match Joint::ball(Poses, 2, ends) {
                    Ok(joint) => vec![joint],
                    Err(error) => return Verdict::wrong(format!("no joint: {error}")),
                },
            };
            let motion = FreeBodies(ConstantVelocity);
            let made = match which == BodyMethod::ALL.len() {
                true => {
                    Rattle::along(motion, &system, &joints, &state, Few::<3>(Redundancy::Refuse))
                        .and_then(|mut rattle| rattle.step(&mut state, h))
                }
                false => Rattle::along(motion, &system, &joints, &state, Many(Redundancy::Refuse))
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

fn bodies(draw: &mut Draw) -> Verdict {
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

struct Nothing;

impl Sink for Nothing {
    fn add_symmetric(&mut self, _: &[usize], _: &[f64]) {}
}

impl Rows for Nothing {
    fn add(&mut self, _: usize, _: usize, _: f64) {}
}

/// Springs, spins, impulses and poses of bodies that may not be there.
fn absent(draw: &mut Draw) -> Verdict {
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
fn short(draw: &mut Draw) -> Verdict {
    let (stored, given) = (draw.between(0, 15), draw.between(0, 6));
    let q: Vec<f64> = (0..stored).map(|_| draw.symmetric()).collect();
    draw.note(format!("{stored} places, {given} values"));
    let ends = [Attachment::Body(0, Vector3::x()), Attachment::Body(1, Vector3::y())];
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
            let ends =
                [PlanarAttachment::Body(0, Vector2::x()), PlanarAttachment::Body(1, Vector2::y())];
            match PlanarJoint::weld(2, ends, 0.1) {
                Ok(joint) => asked(&joint, &q, &mut g, 6),
                Err(error) => Verdict::wrong(error),
            }
        }
        2 => match Joint::hinge(Orientations, 2, ends, [Vector3::z(); 2]) {
            Ok(joint) => asked(&joint, &q, &mut g, 8),
            Err(error) => Verdict::wrong(error),
        },
        _ => match Joint::fixed(Poses, 2, ends, [Rotation::identity(); 2]) {
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

fn rotations(draw: &mut Draw) -> Verdict {
    let v = vector(draw, 0.6);
    let angle = number(draw, 0.3, 0.4);
    draw.note(format!("{v:?}, {angle:e}"));
    let made = match draw.below(4) {
        0 => Rotation::about(v, angle),
        1 => Rotation::from_quaternion([angle, v.x, v.y, v.z]),
        2 => EulerAngles { roll: v.x, pitch: angle, yaw: v.z }.rotation(),
        _ => {
            let mut matrix = Rotation::exp(Vector3::new(0.3, 0.2, -1.0)).matrix();
            if draw.chance(0.5) {
                matrix[(draw.below(3), draw.below(3))] = angle;
            }
            if draw.chance(0.2) {
                matrix *= -1.0;
            }
            Rotation::from_matrix(&matrix)
        }
    };
    match made {
        Ok(rotation) => {
            let right = unit(&rotation.quaternion());
            let _ = (rotation.axis_angle(), EulerAngles::of(&rotation));
            if right { Verdict::due() } else { Verdict::wrong("a rotation that is none") }
        }
        Err(_) => Verdict::due(),
    }
}

fn matrices(draw: &mut Draw) -> Verdict {
    let (rows, columns) = (draw.between(0, 4), draw.between(0, 4));
    let size = draw.one_of(&[1.0, 1e-160, 1e160, 1e-310, 1e300]);
    let bad = draw.chance(0.3);
    let square = draw.chance(0.7);
    let columns = if square { rows } else { columns };
    let matrix = DMatrix::from_fn(rows, columns, |_, _| {
        if bad && draw.chance(0.3) { draw.any_f64() } else { size * draw.symmetric() }
    });
    draw.note(format!("{matrix:?}"));
    let made = match draw.below(3) {
        0 => matrix_exponential(&matrix),
        1 => matrix_logarithm(&matrix),
        _ => null_space(&matrix),
    };
    match made {
        Ok(result) if !finite(result.as_slice()) => {
            Verdict::wrong("Ok with numbers that are not finite")
        }
        Ok(_) if !finite(matrix.as_slice()) => {
            Verdict::wrong("a matrix that is not finite is taken")
        }
        _ => Verdict::due(),
    }
}

fn masses(draw: &mut Draw) -> Verdict {
    let size = draw.one_of(&[1.0, 1e-160, 1e160, 1e-310, 1e300]);
    match draw.below(3) {
        0 => {
            let mut tensor = Matrix3::from_fn(|_, _| 0.1 * draw.symmetric());
            tensor = (tensor + tensor.transpose()) * 0.5 + Matrix3::identity();
            tensor *= size;
            if draw.chance(0.4) {
                tensor[(draw.below(3), draw.below(3))] = draw.any_f64();
            }
            draw.note(format!("{tensor:?}"));
            match PrincipalFrame::of(&tensor) {
                Ok(frame) => {
                    let q = frame.rotation.matrix();
                    let back =
                        q * Matrix3::from_diagonal(&Vector3::from(frame.moments)) * q.transpose();
                    Verdict::of((back - tensor).amax(), 1e-11 * tensor.amax(), "a principal frame")
                }
                Err(_) => Verdict::due(),
            }
        }
        1 => {
            let mut piece = SpatialMass {
                mass: number(draw, 1.0, 0.3),
                centre: vector(draw, 0.3),
                inertia: Matrix3::identity() * size,
            };
            if draw.chance(0.3) {
                piece.inertia[draw.below(9)] = draw.any_f64();
            }
            let count = draw.between(0, 3);
            draw.note(format!("{count} of {piece:?}"));
            if let Ok(all) = SpatialMass::composite(&vec![piece; count]) {
                let numbers = finite(all.centre.as_slice()) && finite(all.inertia.as_slice());
                if !numbers {
                    return Verdict::wrong("a composite that is not finite");
                }
            }
            match piece.body() {
                Ok((_, pose)) if !finite(pose.translation.as_slice()) => {
                    Verdict::wrong("a body's centre is not finite")
                }
                _ => Verdict::due(),
            }
        }
        _ => {
            let piece = PlanarMass {
                mass: number(draw, 1.0, 0.4),
                centre: vector(draw, 0.4).xy(),
                inertia: number(draw, 1.0, 0.4),
            };
            let count = draw.between(0, 3);
            draw.note(format!("{count} of {piece:?}"));
            match PlanarMass::composite(&vec![piece; count]) {
                Ok(all) if !(finite(all.centre.as_slice()) && all.inertia.is_finite()) => {
                    Verdict::wrong("a composite that is not finite")
                }
                _ => Verdict::due(),
            }
        }
    }
}

fn tops(draw: &mut Draw) -> Verdict {
    let w = vector(draw, 0.6) * draw.one_of(&[1.0, 1e-200, 1e200]);
    let t = number(draw, 1.0, 0.5);
    draw.note(format!("w {w:?}, t {t:e}"));
    let body = box_of_one();
    match FreeTop::new(body, Rotation::identity(), w) {
        Ok(top) => {
            let (q, m) = (top.orientation(t).quaternion(), top.momentum(t));
            let _ = top.period();
            // Turns that double precision can count.
            let counted = t.is_finite() && (t * w.amax()).abs() < 1e6;
            match counted && !(finite(&q) && unit(&q) && finite(m.as_slice())) {
                true => Verdict::wrong("a top that is nowhere"),
                false => Verdict::due(),
            }
        }
        Err(_) => Verdict::due(),
    }
}

fn joints(draw: &mut Draw) -> Verdict {
    let bodies = draw.between(0, 2);
    let end = |draw: &mut Draw| match draw.chance(0.3) {
        true => Attachment::World(vector(draw, 0.3)),
        false => Attachment::Body(draw.between(0, 3), vector(draw, 0.3)),
    };
    let ends = [end(draw), end(draw)];
    draw.note(format!("{ends:?} of {bodies}"));
    let named = |end: &Attachment| match *end {
        Attachment::World(v) => finite(v.as_slice()),
        Attachment::Body(body, v) => body < bodies && finite(v.as_slice()),
    };
    let axes = [vector(draw, 0.4), vector(draw, 0.4)];
    let made = match draw.below(2) {
        0 => Joint::ball(Poses, bodies, ends),
        _ => Joint::hinge(Poses, bodies, ends, axes),
    };
    match made {
        Ok(_) if !ends.iter().all(named) => Verdict::wrong("a joint at no body or no point"),
        Ok(joint) => {
            // Of a system that has fewer bodies.
            let metric = BodyMetric::<Poses>::new(vec![box_of_one()]);
            let Ok(system) = System::on(Poses, metric, Free { freedoms: 6 }) else {
                return Verdict::wrong("no system");
            };
            let state = State::new(vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], Covector(vec![0.0; 6]));
            let motion = FreeBodies(ConstantVelocity);
            let few = Few::<6>(Redundancy::Refuse);
            match Rattle::along(motion, &system, &joint, &state, few) {
                Ok(_) if bodies > 1 => Verdict::wrong("a joint of more bodies than there are"),
                _ => Verdict::due(),
            }
        }
        Err(_) => Verdict::due(),
    }
}
