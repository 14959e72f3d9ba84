//! MJCF, of MuJoCo: bodies in bodies, each with its joints and its shapes, of which its mass may come.

use std::cmp::Ordering;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;

use mjcf_rs::body::{Body, Geom, GeomType, InertiaSpec, Joint, JointType};
use mjcf_rs::compiler::InertiaFromGeom;
use mjcf_rs::equality::Equality;
use mjcf_rs::{Model, Tristate};
use nalgebra::{Matrix3, Vector3};
use stationary_rigid::{LieGroup, RigidMotion, SpatialMass};

use crate::passed_over::{PassedOver, passed_over};
use crate::robot::{
    Bounds, HALF_A_TURN, Kind, Link, Part, Robot, WORLD, axis_in_world, piece, scene_names,
    wall_name,
};
use crate::shapes::{frame, motion, named, outline, solid};
use crate::text::scene;
use crate::{Description, ImportError};

/// The scene of a model of MuJoCo: where it is with all joints at their reference, at rest, with its gravity and its
/// step. Bodies without joints are part of their parents. Files that it includes are sought in `folder`.
///
/// Planes are walls, and spheres and boxes touch, where each body is one of these; there contacts are rigid and have
/// no restitution.
///
/// # Errors
/// [`ImportError`] of what is not read, names nothing, has no mass, or cannot be told.
pub fn scene_of_mjcf(text: &str, folder: impl AsRef<Path>) -> Result<Description, ImportError> {
    let PassedOver { left_out, weightless } = passed_over(text, folder.as_ref())?;
    let model = Model::from_str(text, &folder)
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
        gravity: if weightless { [0.0; 3] } else { option.gravity },
        step: option.timestep,
        parts: Vec::new(),
        links: Vec::new(),
        walls: Vec::new(),
        apart: Vec::new(),
        friction: None,
        left_out,
    };
    let own: Vec<_> = model.bodies.iter().skip(1).map(|entry| own_name(&entry.body)).collect();
    let planes = model.bodies.iter().flat_map(|entry| &entry.body.geoms);
    let planes = planes.filter(|geom| geom.type_ == GeomType::Plane).count();
    let names = scene_names("body", &[&[Some(WORLD)], &own[..]].concat(), planes)?;
    let geoms = model.bodies.iter().flat_map(|entry| &entry.body.geoms);
    let joints = model.bodies.iter().flat_map(|entry| &entry.body.joints);
    each_once("geom", geoms.map(|geom| &geom.name))?;
    each_once("joint", joints.map(|joint| &joint.name))?;
    // A parent stands before its children.
    let mut placed: Vec<(RigidMotion, String)> = Vec::with_capacity(model.bodies.len());
    let mut touching = Vec::new();
    for (id, entry) in model.bodies.iter().enumerate() {
        let own = motion(entry.body.name.as_deref().unwrap_or(WORLD), &entry.body.pose)?;
        let (pose, parent) = match entry.parent {
            Some(parent) => (placed[parent].0.compose(&own), placed[parent].1.clone()),
            None => (own, WORLD.to_owned()),
        };
        let name = if id == 0 {
            WORLD.to_owned()
        } else {
            place(&mut robot, &model, (id, &names[id]), &pose, &parent)?
        };
        let geoms = entry.body.geoms.iter().filter(|geom| geom.contype | geom.conaffinity != 0);
        if name == WORLD {
            ground(&mut robot, geoms, (id, &pose), &mut touching)?;
        } else {
            touching.extend(geoms.map(|geom| Touching { body: id, of: name.clone(), geom }));
        }
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
    surfaces(&mut robot, &model, &touching)?;
    robot.check_names("body")?;
    scene(robot)
}

/// The planes of what stands still; its other shapes are left out.
fn ground<'a>(
    robot: &mut Robot,
    geoms: impl Iterator<Item = &'a Geom>,
    (body, pose): (usize, &RigidMotion),
    touching: &mut Vec<Touching<'a>>,
) -> Result<(), ImportError> {
    for geom in geoms {
        if geom.type_ == GeomType::Plane {
            let at = pose.compose(&motion(named(geom), &geom.pose)?);
            let of = wall_name(robot.walls.len());
            touching.push(Touching { body, of, geom });
            robot.walls.push([at.rotation.rotate(&Vector3::z()), at.translation]);
        } else {
            robot.left_out.push(format!("what touches geom `{}`", named(geom)));
        }
    }
    Ok(())
}

/// Whether each of these names, where there is one, is another.
fn each_once<'a>(
    what: &'static str,
    names: impl Iterator<Item = &'a Option<String>>,
) -> Result<(), ImportError> {
    let mut seen = HashSet::new();
    let mut named = names.flatten().filter(|name| !name.is_empty());
    match named.find(|name| !seen.insert(*name)) {
        Some(name) => Err(ImportError::Duplicate { what, name: name.clone() }),
        None => Ok(()),
    }
}

/// The name that a body is given; an empty one is none.
fn own_name(body: &Body) -> Option<&str> {
    body.name.as_deref().filter(|name| !name.is_empty())
}

/// Puts a body where it is, with its joint; says of which body it is a part.
fn place(
    robot: &mut Robot,
    model: &Model,
    (id, name): (usize, &String),
    pose: &RigidMotion,
    parent: &str,
) -> Result<String, ImportError> {
    let body = &model.bodies[id].body;
    let unsupported = |what| ImportError::Unsupported { what, name: name.clone() };
    if body.mocap {
        return Err(unsupported("a body that follows a motion"));
    }
    if body.gravcomp != 0.0 {
        robot.left_out.push(format!("gravity compensation of `{name}`"));
    }
    if body.joints.is_empty() && parent == WORLD {
        // What is fixed to the world does not move.
        return Ok(parent.to_owned());
    }
    let pieces = pieces(model, body, name)?.iter().map(|piece| piece.moved(pose)).collect();
    let mut outlines = Some(Vec::new());
    for geom in body.geoms.iter().filter(|geom| geom.contype | geom.conaffinity != 0) {
        let at = pose.compose(&frame(geom, named(geom))?);
        outlines = outlines.zip(outline(geom)).map(|(mut all, one)| {
            all.push((one, at));
            all
        });
    }
    let part = Part { name: name.clone(), pieces, outlines };
    let not_allowed = |what| ImportError::NotAllowed { format: "MJCF", what, name: name.clone() };
    if body.geoms.iter().any(|geom| geom.type_ == GeomType::Plane) {
        return Err(not_allowed("a plane that moves"));
    }
    let free = body.joints.iter().any(|joint| joint.type_ == JointType::Free);
    if free && model.bodies[id].parent != Some(0) {
        return Err(not_allowed("a free joint within a body"));
    }
    match &body.joints[..] {
        [] => {
            if let Some(above) = robot.part(parent) {
                above.join(part.pieces, part.outlines);
            }
            Ok(parent.to_owned())
        }
        [joint] => {
            if let Some((kind, bounds)) = kind(robot, model, joint, pose, name)? {
                let at = pose.apply(&Vector3::from(joint.pos));
                let between = [parent.to_owned(), name.clone()];
                robot.links.push(Link { kind, between, at, bounds });
            }
            robot.parts.push(part);
            Ok(name.clone())
        }
        _ => Err(unsupported("several joints of one body")),
    }
}

/// What a joint leaves free, and what bounds it; nothing where all is.
fn kind(
    robot: &mut Robot,
    model: &Model,
    joint: &Joint,
    pose: &RigidMotion,
    body: &str,
) -> Result<Option<(Kind, Bounds)>, ImportError> {
    let name = joint.name.clone().unwrap_or_else(|| format!("joint of {body}"));
    let mut leave = |what: &str| robot.left_out.push(format!("{what} of joint `{name}`"));
    let hinge = joint.type_ == JointType::Hinge;
    let mut bounds = Bounds::default();
    let of_one = hinge || joint.type_ == JointType::Slide;
    if of_one {
        bounds.friction = joint.frictionloss;
    }
    let limited = limited(joint, model.compiler.autolimits)
        .map_err(|what| ImportError::NotAllowed { format: "MJCF", what, name: name.clone() })?;
    let range = joint.range.filter(|_| of_one).map(|range| range.map(|limit| limit - joint.ref_));
    let most = if hinge { HALF_A_TURN } else { f64::INFINITY };
    let beyond = limited && !range.is_some_and(|range| bounds.take(range, most));
    let checks = [
        (beyond, "limits"),
        (!of_one && joint.frictionloss != 0.0, "friction"),
        (joint.armature != 0.0, "armature"),
        (joint.springdamper.is_some(), "springdamper"),
    ];
    checks.iter().filter(|(has, _)| *has).for_each(|(_, what)| leave(what));
    if !hinge && joint.stiffness != 0.0 {
        leave("stiffness");
    }
    if !hinge && joint.damping != 0.0 {
        leave("damping");
    }
    let axis = || axis_in_world(&name, pose, joint.axis);
    let kind = match joint.type_ {
        JointType::Free => None,
        JointType::Ball => Some(Kind::Ball),
        JointType::Slide => Some(Kind::Slider { axis: axis()? }),
        JointType::Hinge => {
            let (mut stiffness, damping) = (joint.stiffness, joint.damping);
            let rest = joint.springref - joint.ref_;
            if rest.abs() > HALF_A_TURN && stiffness != 0.0 {
                leave("spring, which rests beyond half a turn,");
                stiffness = 0.0;
            }
            Some(Kind::Hinge { axis: axis()?, stiffness, rest, damping })
        }
    };
    Ok(kind.map(|kind| (kind, bounds)))
}

/// Whether a joint has limits: of what is not told, a range that does not grow is none.
fn limited(joint: &Joint, autolimits: bool) -> Result<bool, &'static str> {
    let [low, high] = joint.range.unwrap_or_default();
    match (joint.type_, joint.limited) {
        (JointType::Free, _) | (_, Tristate::False) => Ok(false),
        (JointType::Ball, Tristate::True) => Ok(true),
        (_, Tristate::True) if low < high => Ok(true),
        (_, Tristate::True) => Err("limits that do not grow"),
        (_, Tristate::Auto) if !autolimits && [low, high] != [0.0; 2] => {
            Err("a range of which nothing says whether it limits")
        }
        (_, Tristate::Auto) => Ok(low < high),
    }
}

/// Bodies by name; the world is the first.
fn ids(model: &Model) -> HashMap<&str, usize> {
    let bodies = model.bodies.iter().enumerate();
    let named = bodies.filter_map(|(id, entry)| Some((entry.body.name.as_deref()?, id)));
    named.chain([(WORLD, 0)]).collect()
}

fn find(
    ids: &HashMap<&str, usize>,
    what: &Option<String>,
    kind: &str,
    body: &str,
) -> Result<usize, ImportError> {
    ids.get(body).copied().ok_or_else(|| ImportError::UnknownBody {
        what: what.as_ref().map_or(kind.to_owned(), |name| format!("{kind} `{name}`")),
        body: body.to_owned(),
    })
}

/// Loops that are closed beside the tree.
fn equalities(
    robot: &mut Robot,
    model: &Model,
    placed: &[(RigidMotion, String)],
) -> Result<(), ImportError> {
    let ids = ids(model);
    let find = |what: &Option<String>, body: &str| find(&ids, what, "equality", body);
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
            // A pose without a turn stands for that of the start.
            Equality::Weld(one) if one.relpose.is_none_or(|pose| pose.rotation.length() == 0.0) => {
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
        // What is one body in the scene is held together by itself.
        if first.1 == second {
            continue;
        }
        let at = first.0.apply(&Vector3::from(anchor));
        let between = [first.1.clone(), second];
        robot.links.push(Link { kind, between, at, bounds: Bounds::default() });
    }
    Ok(())
}

/// A shape that touches others.
struct Touching<'a> {
    /// The body of the model.
    body: usize,
    /// The body or the wall of the scene.
    of: String,
    geom: &'a Geom,
}

impl Touching<'_> {
    /// Where they touch, if they do: the dimension of contact, and Coulomb's coefficient.
    fn with(&self, other: &Self) -> Option<(u32, f64)> {
        let (a, b) = (self.geom, other.geom);
        if (a.contype & b.conaffinity) | (b.contype & a.conaffinity) == 0 {
            return None;
        }
        // The one of higher priority decides; of two alike, the larger numbers.
        let (dimension, friction) = match a.priority.cmp(&b.priority) {
            Ordering::Less => (b.condim, b.friction[0]),
            Ordering::Greater => (a.condim, a.friction[0]),
            Ordering::Equal => (a.condim.max(b.condim), a.friction[0].max(b.friction[0])),
        };
        Some((dimension, if dimension == 1 { 0.0 } else { friction }))
    }
}

/// Which pairs pass through each other, and the friction of the others where it is the same of all.
fn surfaces(
    robot: &mut Robot,
    model: &Model,
    touching: &[Touching<'_>],
) -> Result<(), ImportError> {
    let ids = ids(model);
    let mut excluded = HashSet::new();
    for one in &model.contact.excludes {
        let [a, b] = [&one.body1, &one.body2].map(|body| find(&ids, &one.name, "exclude", body));
        let (a, b) = (a?, b?);
        excluded.extend([(a, b), (b, a)]);
    }
    for one in &model.contact.pairs {
        robot.left_out.push(format!("contact pair of `{}` and `{}`", one.geom1, one.geom2));
    }
    let ends = robot.links.iter().map(|link| link.between.each_ref());
    let joined: HashSet<_> = ends.flat_map(|[a, b]| [[a, b], [b, a]]).collect();
    let mut met: BTreeMap<[&String; 2], bool> = BTreeMap::new();
    let (mut coefficients, mut rolls) = (Vec::new(), false);
    for (k, one) in touching.iter().enumerate() {
        for other in &touching[k + 1..] {
            let pair = [&one.of, &other.of];
            let fixed = [one, other].iter().all(|one| one.geom.type_ == GeomType::Plane);
            if one.of == other.of || fixed || joined.contains(&pair) {
                continue;
            }
            let with = one.with(other).filter(|_| !excluded.contains(&(one.body, other.body)));
            *met.entry(pair).or_default() |= with.is_some();
            if let Some((dimension, friction)) = with {
                coefficients.push(friction);
                rolls |= dimension > 3;
            }
        }
    }
    let apart = met.iter().filter(|(_, meet)| !**meet).map(|(pair, _)| pair.map(String::clone));
    robot.apart = apart.collect();
    robot.friction = coefficients.first().copied();
    if coefficients.windows(2).any(|two| two[0] != two[1]) {
        robot.left_out.push("friction, which differs from shape to shape".to_owned());
        robot.friction = None;
    }
    if rolls {
        robot.left_out.push("torsional and rolling friction of shapes".to_owned());
    }
    Ok(())
}

/// The pieces of a body in its own frame: as it is written, or its shapes.
fn pieces(model: &Model, body: &Body, name: &str) -> Result<Vec<SpatialMass>, ImportError> {
    let from = model.compiler.inertia_from_geom;
    // A body without shapes keeps what is written, whatever the compiler says.
    let written = from != InertiaFromGeom::True || body.geoms.is_empty();
    if let Some(inertial) = body.inertial.as_ref().filter(|_| written) {
        let inertia = match inertial.inertia {
            InertiaSpec::Diagonal(moments) => Matrix3::from_diagonal(&Vector3::from(moments)),
            InertiaSpec::Full([xx, yy, zz, xy, xz, yz]) => {
                Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
            }
        };
        let own = SpatialMass { mass: inertial.mass, centre: Vector3::zeros(), inertia };
        return Ok(vec![own.moved(&motion(name, &inertial.pose)?)]);
    }
    if from == InertiaFromGeom::False {
        return Ok(Vec::new());
    }
    let mut all = Vec::new();
    for geom in &body.geoms {
        let name = || format!("geom {} of {name}", named(geom));
        let density = geom.density.unwrap_or(model.compiler.inertia_density);
        let weightless = geom.mass == Some(0.0) || (geom.mass.is_none() && density == 0.0);
        if weightless || geom.type_ == GeomType::Plane {
            continue;
        }
        let solid = solid(geom, density)
            .ok_or_else(|| ImportError::Unsupported {
                what: "the mass of a surface",
                name: name(),
            })?
            .map_err(|source| ImportError::Body { name: name(), source: Box::new(source) })?;
        all.push(piece(&solid).moved(&frame(geom, named(geom))?));
    }
    Ok(all)
}
