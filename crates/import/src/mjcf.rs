//! MJCF, of MuJoCo: bodies in bodies, each with its joints and its shapes, of which its mass may come.

use std::collections::HashMap;
use std::f64::consts::PI;
use std::path::Path;

use mjcf_rs::Model;
use mjcf_rs::body::{Body, Geom, GeomType, InertiaSpec, Joint, JointType};
use mjcf_rs::compiler::InertiaFromGeom;
use mjcf_rs::equality::Equality;
use nalgebra::{Isometry3, Matrix3, Quaternion, Translation3, UnitQuaternion, Vector3};

use crate::inertia::{Inertia, solid_ball, solid_box};
use crate::robot::{Kind, Link, Outline, Part, Robot, WORLD, axis_in_world, plain_name};
use crate::text::scene;
use crate::{Description, ImportError};

fn isometry(pose: &mjcf_rs::Pose) -> Isometry3<f64> {
    let (t, r) = (pose.translation, pose.rotation);
    let turn = UnitQuaternion::from_quaternion(Quaternion::new(r.w, r.x, r.y, r.z));
    Isometry3::from_parts(Translation3::new(t.x, t.y, t.z), turn)
}

/// The scene of a model of MuJoCo: where it is with all joints at their reference, at rest, with its gravity and its
/// step. Bodies without joints are part of their parents. Files that it includes are sought in `folder`.
///
/// Planes are walls, and spheres and boxes touch, where each body is one of these; there contacts are rigid and have
/// no restitution.
///
/// # Errors
/// [`ImportError`] of what is not read, names nothing, has no mass, or cannot be told.
pub fn scene_of_mjcf(text: &str, folder: impl AsRef<Path>) -> Result<Description, ImportError> {
    let model = Model::from_str(text, folder)
        .map_err(|error| ImportError::Syntax { format: "MJCF", message: error.to_string() })?;
    let (compiler, option) = (&model.compiler, &model.option);
    if compiler.set_total_mass > 0.0 || compiler.bound_mass > 0.0 || compiler.bound_inertia > 0.0 {
        let name = "settotalmass, boundmass or boundinertia".to_owned();
        return Err(ImportError::Unsupported { what: "masses that the compiler changes", name });
    }
    if !(option.timestep > 0.0 && option.timestep.is_finite()) {
        return Err(ImportError::NonFinite { what: "the time step", name: "option".to_owned() });
    }
    let mut robot = Robot {
        title: model.name.clone().filter(|name| !name.is_empty()).unwrap_or("robot".to_owned()),
        format: "MJCF",
        gravity: option.gravity,
        step: option.timestep,
        parts: Vec::new(),
        links: Vec::new(),
        walls: Vec::new(),
        friction: None,
        left_out: Vec::new(),
    };
    // A parent stands before its children.
    let mut placed: Vec<(Isometry3<f64>, String)> = Vec::with_capacity(model.bodies.len());
    for (id, entry) in model.bodies.iter().enumerate() {
        let own = isometry(&entry.body.pose);
        let (pose, parent) = match entry.parent {
            Some(parent) => (placed[parent].0 * own, placed[parent].1.clone()),
            None => (own, WORLD.to_owned()),
        };
        let name = if id == 0 {
            ground(&mut robot, &entry.body, &pose);
            WORLD.to_owned()
        } else {
            place(&mut robot, &model, id, &pose, &parent)?
        };
        placed.push((pose, name));
    }
    equalities(&mut robot, &model, &placed)?;
    let mut leave = |what: &str, name: Option<&String>| {
        robot.left_out.push(format!("{what} `{}`", name.map_or("without a name", String::as_str)));
    };
    model.actuators.iter().for_each(|one| leave("actuator", one.name.as_ref()));
    model.keyframes.iter().for_each(|one| leave("keyframe", one.name.as_ref()));
    if !model.tendons.is_empty() {
        robot.left_out.push(format!("{} tendons", model.tendons.len()));
    }
    robot.friction = friction(&model, &mut robot.left_out);
    robot.check_names("body")?;
    scene(robot)
}

/// The planes of the world; its other shapes are left out.
fn ground(robot: &mut Robot, body: &Body, pose: &Isometry3<f64>) {
    for geom in &body.geoms {
        if geom.type_ == GeomType::Plane {
            let at = pose * isometry(&geom.pose);
            robot.walls.push([at.rotation * Vector3::z(), at.translation.vector]);
        } else {
            robot.left_out.push(format!("what touches geom `{}`", named(geom)));
        }
    }
}

fn named(geom: &Geom) -> &str {
    geom.name.as_deref().unwrap_or("without a name")
}

/// Coulomb's coefficient, where it is the same of all shapes.
fn friction(model: &Model, left_out: &mut Vec<String>) -> Option<f64> {
    let geoms = model.bodies.iter().flat_map(|entry| &entry.body.geoms);
    let mut all = geoms.map(|geom| geom.friction[0]);
    let first = all.next()?;
    if all.all(|friction| friction == first) {
        return Some(first);
    }
    left_out.push("friction, which differs from shape to shape".to_owned());
    None
}

/// Puts a body where it is, with its joint; says of which body it is a part.
fn place(
    robot: &mut Robot,
    model: &Model,
    id: usize,
    pose: &Isometry3<f64>,
    parent: &str,
) -> Result<String, ImportError> {
    let body = &model.bodies[id].body;
    let name = body.name.as_deref().map_or_else(|| format!("body {id}"), plain_name);
    let unsupported = |what| ImportError::Unsupported { what, name: name.clone() };
    if body.mocap {
        return Err(unsupported("a body that follows a motion"));
    }
    if body.gravcomp != 0.0 {
        robot.left_out.push(format!("gravity compensation of `{name}`"));
    }
    let inertia = inertia(model, body, &name)?.seen(pose);
    let outlines = body.geoms.iter().filter(|geom| geom.contype | geom.conaffinity != 0);
    let outlines =
        outlines.map(|geom| Some((outline(geom)?, pose * isometry(&geom.pose)))).collect();
    let part = Part { name: name.clone(), inertia, outlines };
    match &body.joints[..] {
        [] => {
            // What is fixed to the world does not move; the rest is one body.
            if let Some(above) = robot.part(parent) {
                above.inertia = above.inertia.with(&part.inertia);
                above.outlines = above.outlines.take().zip(part.outlines).map(|(mut all, own)| {
                    all.extend(own);
                    all
                });
            }
            Ok(parent.to_owned())
        }
        [joint] => {
            if let Some(kind) = kind(robot, joint, pose, &name)? {
                let at = pose.transform_point(&Vector3::from(joint.pos).into()).coords;
                robot.links.push(Link { kind, between: [parent.to_owned(), name.clone()], at });
            }
            robot.parts.push(part);
            Ok(name)
        }
        _ => Err(unsupported("several joints of one body")),
    }
}

/// What a joint leaves free; nothing where all is.
fn kind(
    robot: &mut Robot,
    joint: &Joint,
    pose: &Isometry3<f64>,
    body: &str,
) -> Result<Option<Kind>, ImportError> {
    let name = joint.name.clone().unwrap_or_else(|| format!("joint of {body}"));
    let mut leave = |what: &str| robot.left_out.push(format!("{what} of joint `{name}`"));
    let autolimits = true;
    let checks = [
        (joint.limited.resolve(autolimits, joint.range.is_some()), "limits"),
        (joint.frictionloss != 0.0, "friction"),
        (joint.armature != 0.0, "armature"),
        (joint.springdamper.is_some(), "springdamper"),
    ];
    checks.iter().filter(|(has, _)| *has).for_each(|(_, what)| leave(what));
    let hinge = joint.type_ == JointType::Hinge;
    if !hinge && joint.stiffness != 0.0 {
        leave("stiffness");
    }
    if !hinge && joint.damping != 0.0 {
        leave("damping");
    }
    let axis = || axis_in_world(&name, pose, joint.axis);
    Ok(match joint.type_ {
        JointType::Free => None,
        JointType::Ball => Some(Kind::Ball),
        JointType::Slide => Some(Kind::Slider { axis: axis()? }),
        JointType::Hinge => {
            let (stiffness, damping) = (joint.stiffness, joint.damping);
            let rest = joint.springref - joint.ref_;
            Some(Kind::Hinge { axis: axis()?, stiffness, rest, damping })
        }
    })
}

/// Loops that are closed beside the tree.
fn equalities(
    robot: &mut Robot,
    model: &Model,
    placed: &[(Isometry3<f64>, String)],
) -> Result<(), ImportError> {
    let ids: HashMap<_, _> = model
        .bodies
        .iter()
        .enumerate()
        .filter_map(|(id, entry)| Some((entry.body.name.as_deref()?, id)))
        .collect();
    let find = |what: &Option<String>, body: &str| {
        ids.get(body).copied().ok_or_else(|| ImportError::UnknownLink {
            joint: what.clone().unwrap_or("equality".to_owned()),
            link: body.to_owned(),
        })
    };
    for equality in &model.equality {
        let common = match equality {
            Equality::Connect(one) => &one.common,
            Equality::Weld(one) => &one.common,
            Equality::Joint(one) => &one.common,
            Equality::Tendon(one) => &one.common,
        };
        if !common.active {
            continue;
        }
        let name = common.name.clone().unwrap_or("without a name".to_owned());
        let (kind, first, second, anchor) = match equality {
            Equality::Connect(one) => (Kind::Ball, &one.body1, &one.body2, one.anchor),
            Equality::Weld(one) if one.relpose.is_none() => {
                (Kind::Fixed, &one.body1, &one.body2, one.anchor.unwrap_or_default())
            }
            Equality::Weld(_) => {
                return Err(ImportError::Unsupported { what: "a weld in another pose", name });
            }
            Equality::Joint(_) | Equality::Tendon(_) => {
                return Err(ImportError::Unsupported {
                    what: "a joint or tendon that follows another",
                    name,
                });
            }
        };
        let first = &placed[find(&common.name, first)?];
        let second = match second {
            Some(second) => placed[find(&common.name, second)?].1.clone(),
            None => WORLD.to_owned(),
        };
        let at = first.0.transform_point(&Vector3::from(anchor).into()).coords;
        robot.links.push(Link { kind, between: [first.1.clone(), second], at });
    }
    Ok(())
}

/// A shape that scenes have.
fn outline(geom: &Geom) -> Option<Outline> {
    match (geom.type_, geom.fromto) {
        (GeomType::Sphere, _) => Some(Outline::Ball(geom.size[0])),
        (GeomType::Box, None) => Some(Outline::Box(geom.size.map(|half| 2.0 * half))),
        _ => None,
    }
}

/// The inertia of a body in its own frame, as it is written or from its shapes.
fn inertia(model: &Model, body: &Body, name: &str) -> Result<Inertia, ImportError> {
    let written = body
        .inertial
        .as_ref()
        .filter(|_| model.compiler.inertia_from_geom != InertiaFromGeom::True);
    if let Some(inertial) = written {
        let moments = match inertial.inertia {
            InertiaSpec::Diagonal(moments) => Matrix3::from_diagonal(&Vector3::from(moments)),
            InertiaSpec::Full([xx, yy, zz, xy, xz, yz]) => {
                Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
            }
        };
        let own = Inertia { mass: inertial.mass, centre: Vector3::zeros(), moments };
        return Ok(own.seen(&isometry(&inertial.pose)));
    }
    if model.compiler.inertia_from_geom == InertiaFromGeom::False {
        return Ok(Inertia::NONE);
    }
    let mut sum = Inertia::NONE;
    for geom in &body.geoms {
        let missing = ImportError::Unsupported {
            what: "the mass of a surface",
            name: format!("geom {} of {name}", named(geom)),
        };
        sum = sum.with(&of_shape(geom, model.compiler.inertia_density).ok_or(missing)?);
    }
    Ok(sum)
}

/// The inertia of a solid shape in its body's frame; none of a surface.
fn of_shape(geom: &Geom, density: f64) -> Option<Inertia> {
    let density = geom.density.unwrap_or(density);
    if geom.mass == Some(0.0) || (geom.mass.is_none() && density == 0.0) {
        return Some(Inertia::NONE);
    }
    let (mut half, mut pose) = (geom.size[1], isometry(&geom.pose));
    if let Some([a, b, c, d, e, f]) = geom.fromto {
        let (from, to) = (Vector3::new(a, b, c), Vector3::new(d, e, f));
        half = 0.5 * (to - from).norm();
        let turn = UnitQuaternion::rotation_between(&Vector3::z(), &(to - from));
        let turn = turn.unwrap_or(UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI));
        pose = Isometry3::from_parts(((from + to) * 0.5).into(), turn);
    }
    let r = geom.size[0];
    let mass = |volume: f64| geom.mass.unwrap_or(density * volume);
    let own = match geom.type_ {
        GeomType::Sphere => solid_ball(mass(4.0 / 3.0 * PI * r.powi(3)), r),
        GeomType::Box if geom.fromto.is_some() => return None,
        GeomType::Box => {
            let sides = geom.size.map(|half| 2.0 * half);
            solid_box(mass(sides.iter().product()), sides)
        }
        GeomType::Ellipsoid if geom.fromto.is_some() => return None,
        GeomType::Ellipsoid => {
            let [a, b, c] = geom.size;
            let m = mass(4.0 / 3.0 * PI * a * b * c);
            let over = |x: f64, y: f64| m * (x * x + y * y) / 5.0;
            Inertia::about_axes(m, [over(b, c), over(a, c), over(a, b)])
        }
        GeomType::Cylinder => cylinder(mass(2.0 * PI * r * r * half), r, half),
        GeomType::Capsule => {
            let [body, ends] = [2.0 * PI * r * r * half, 4.0 / 3.0 * PI * r.powi(3)];
            let m = mass(body + ends);
            let tube = cylinder(m * body / (body + ends), r, half);
            // Two halves of a ball, their centres 3 r/8 beyond the ends.
            let m = m * ends / (body + ends);
            let across = m * (0.4 * r * r + half * half + 0.75 * half * r);
            tube.with(&Inertia::about_axes(m, [across, across, 0.4 * m * r * r]))
        }
        GeomType::Plane => return Some(Inertia::NONE),
        GeomType::Hfield | GeomType::Mesh | GeomType::Sdf => return None,
    };
    Some(own.seen(&pose))
}

/// A solid cylinder about z.
fn cylinder(mass: f64, radius: f64, half: f64) -> Inertia {
    let across = mass * (radius * radius / 4.0 + half * half / 3.0);
    Inertia::about_axes(mass, [across, across, mass * radius * radius / 2.0])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Slices across z: a disc of radius r(z) each.
    fn slices(density: f64, reach: f64, radius: impl Fn(f64) -> f64) -> [f64; 3] {
        let n = 200_000;
        let dz = 2.0 * reach / f64::from(n);
        (0..n).fold([0.0; 3], |[m, across, along], k| {
            let z = -reach + dz * (f64::from(k) + 0.5);
            let (r2, part) = (radius(z).powi(2), density * PI * radius(z).powi(2) * dz);
            [m + part, across + part * (r2 / 4.0 + z * z), along + part * r2 / 2.0]
        })
    }

    #[test]
    fn masses_and_moments_of_shapes_are_those_of_their_slices() {
        let (r, half, density) = (0.3, 0.5, 700.0);
        let tube = |_: f64| r;
        let capsule = |z: f64| {
            let beyond = (z.abs() - half).max(0.0);
            (r * r - beyond * beyond).max(0.0).sqrt()
        };
        let round = |z: f64| r * (1.0 - (z / half).powi(2)).max(0.0).sqrt();
        for (type_, size, expected) in [
            (GeomType::Cylinder, [r, half, 0.0], slices(density, half, tube)),
            (GeomType::Capsule, [r, half, 0.0], slices(density, half + r, capsule)),
            (GeomType::Ellipsoid, [r, r, half], slices(density, half, round)),
        ] {
            let geom = Geom { type_, size, density: Some(density), ..Geom::default() };
            let found = of_shape(&geom, 1.0).unwrap();
            let of = [found.mass, found.moments[(0, 0)], found.moments[(2, 2)]];
            for (a, b) in of.iter().zip(expected) {
                assert!((a / b - 1.0).abs() < 1e-8, "{type_:?}: {of:?} {expected:?}");
            }
            assert_eq!(found.moments[(0, 0)], found.moments[(1, 1)]);
        }
    }

    #[test]
    fn a_capsule_between_two_points_is_the_one_that_is_turned_there() {
        let geom = |fromto| Geom {
            type_: GeomType::Capsule,
            size: [0.1, 0.0, 0.0],
            fromto: Some(fromto),
            mass: Some(2.0),
            ..Geom::default()
        };
        let along = of_shape(&geom([1.0, 0.0, 0.0, 3.0, 0.0, 0.0]), 1.0).unwrap();
        let back = of_shape(&geom([0.0, 0.0, 1.0, 0.0, 0.0, -1.0]), 1.0).unwrap();
        assert_eq!(along.centre, Vector3::new(2.0, 0.0, 0.0));
        assert!((along.moments[(0, 0)] - back.moments[(2, 2)]).abs() < 1e-15);
        assert!((along.moments[(1, 1)] - back.moments[(0, 0)]).abs() < 1e-15);
        assert!(along.moments[(1, 1)] > 10.0 * along.moments[(0, 0)]);
    }
}
