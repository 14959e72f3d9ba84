//! URDF: links that joints hang on one another, each frame given in its parent's.

use std::collections::{HashMap, HashSet};
use std::iter;

use nalgebra::{Matrix3, Vector3};
use stationary_rigid::{LieGroup, RigidMotion, Rotation, SpatialMass};
use urdf_rs::{Geometry, JointType, Pose};

use crate::robot::{
    Bounds, HALF_A_TURN, Kind, Link, Outline, Part, Robot, WORLD, axis_in_world, scene_names,
};
use crate::text::scene;
use crate::urdf_words::{Source, Turned};
use crate::{Description, ImportError};

/// The step of the scene, s: the format has none.
const STEP: f64 = 1e-3;
/// The weight of the scene, m/s^2: the format has none.
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// A frame in its parent's: turned by a quaternion, or about x, then about y, then about z.
fn motion(pose: &Pose, turned: Option<Rotation>) -> RigidMotion {
    let translation = Vector3::from(pose.xyz.0);
    if let Some(rotation) = turned {
        return RigidMotion { translation, rotation };
    }
    let [roll, pitch, yaw] = pose.rpy.0;
    let turn = |axis: Vector3<f64>, angle: f64| Rotation::exp(axis * angle);
    let last = turn(Vector3::z(), yaw).compose(&turn(Vector3::y(), pitch));
    let rotation = last.compose(&turn(Vector3::x(), roll));
    RigidMotion { translation, rotation }
}

/// The scene of a robot in the Unified Robot Description Format: where it is with all joints at zero, at rest, under
/// a weight of 9.81 m/s^2 against z. Links without mass that are fixed to another are part of it; a root without mass
/// is the world, and a root with mass is free.
///
/// # Errors
/// [`ImportError`] of what is not read, names nothing, is no tree, has no mass, or cannot be told.
pub fn scene_of_urdf(text: &str) -> Result<Description, ImportError> {
    let source = Source::new(text)?;
    let turned = source.turned()?;
    let read = urdf_rs::read_from_string(text)
        .map_err(|error| ImportError::Syntax { format: "URDF", message: error.to_string() })?;
    let title = if read.name.is_empty() { "robot" } else { &read.name };
    let mut robot = Robot {
        title: title.to_owned(),
        format: "URDF",
        gravity: GRAVITY,
        step: STEP,
        parts: Vec::new(),
        links: Vec::new(),
        walls: Vec::new(),
        apart: Vec::new(),
        friction: None,
        left_out: source.unread(),
    };
    let own: Vec<_> = read.links.iter().map(|link| link.name.as_str()).collect();
    let index: HashMap<_, _> = own.iter().enumerate().map(|(k, &name)| (name, k)).collect();
    let names = scene_names("link", &own.into_iter().map(Some).collect::<Vec<_>>(), 0)?;
    let mut seen = HashSet::new();
    if let Some(joint) = read.joints.iter().find(|joint| !seen.insert(&joint.name)) {
        return Err(ImportError::Duplicate { what: "joint", name: joint.name.clone() });
    }
    // The joint that a link hangs on, and those that hang on it.
    let mut above: Vec<Option<usize>> = vec![None; read.links.len()];
    let mut below = vec![Vec::new(); read.links.len()];
    for (j, joint) in read.joints.iter().enumerate() {
        let find = |link: &str| {
            index.get(link).copied().ok_or_else(|| ImportError::UnknownLink {
                joint: joint.name.clone(),
                link: link.to_owned(),
            })
        };
        let (parent, child) = (find(&joint.parent.link)?, find(&joint.child.link)?);
        if let Some(first) = above[child].replace(j) {
            return Err(ImportError::TwoParents {
                link: joint.child.link.clone(),
                first: read.joints[first].name.clone(),
                second: joint.name.clone(),
            });
        }
        below[parent].push((j, child));
    }
    let roots: Vec<_> = (0..above.len()).filter(|&link| above[link].is_none()).collect();
    let &[root] = &roots[..] else {
        let names = roots.iter().map(|&root| read.links[root].name.as_str());
        let names = names.collect::<Vec<_>>().join(", ");
        return Err(ImportError::Roots { count: roots.len(), names });
    };
    let mut waiting = vec![(root, RigidMotion::identity(), None)];
    let mut reached = 0;
    while let Some((k, pose, above)) = waiting.pop() {
        reached += 1;
        let body = place(&mut robot, (k, &read.links[k], &names[k]), &turned, &pose, above)?;
        for &(j, child) in below[k].iter().rev() {
            let joint = &read.joints[j];
            waiting.push((
                child,
                pose.compose(&motion(&joint.origin, turned.joints.get(j).copied().flatten())),
                Some((joint, body.clone())),
            ));
        }
    }
    if reached < read.links.len() {
        // A circle of links has no root of its own.
        let all = read.joints.iter().map(|joint| joint.name.as_str()).collect::<Vec<_>>();
        return Err(ImportError::Roots { count: 0, names: all.join(", ") });
    }
    robot.check_names("link")?;
    scene(robot)
}

/// Puts a link where it is, with the joint that it hangs on; says of which body it is a part.
fn place(
    robot: &mut Robot,
    (k, link, name): (usize, &urdf_rs::Link, &String),
    turned: &Turned,
    pose: &RigidMotion,
    above: Option<(&urdf_rs::Joint, String)>,
) -> Result<String, ImportError> {
    let i = &link.inertial.inertia;
    let moments = Matrix3::new(i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz);
    let mass = link.inertial.mass.value;
    let own = SpatialMass { mass, centre: Vector3::zeros(), inertia: moments };
    let at = motion(&link.inertial.origin, turned.inertias.get(k).copied().flatten());
    let pieces = vec![own.moved(&pose.compose(&at))];
    let mut outlines = Some(Vec::new());
    let touching = turned.touching.get(k).into_iter().flatten().copied().chain(iter::repeat(None));
    for (collision, turned) in link.collision.iter().zip(touching) {
        let outline = match &collision.geometry {
            Geometry::Box { size } => Some(Outline::Box(size.0)),
            Geometry::Sphere { radius } => Some(Outline::Ball(*radius)),
            Geometry::Cylinder { radius, length } => Some(Outline::Cylinder([*length, *radius])),
            Geometry::Capsule { radius, length } => Some(Outline::Capsule([*length, *radius])),
            _ => None,
        };
        let at = pose.compose(&motion(&collision.origin, turned));
        match (outline, &mut outlines) {
            (Some(outline), Some(outlines)) => outlines.push((outline, at)),
            _ => outlines = None,
        }
    }
    let Some((joint, parent)) = above else {
        if mass == 0.0 && moments.amax() == 0.0 {
            stands(robot, link);
            return Ok(WORLD.to_owned());
        }
        robot.parts.push(Part { name: name.clone(), pieces, outlines });
        return Ok(name.clone());
    };
    let unsupported = |what| ImportError::Unsupported { what, name: joint.name.clone() };
    if joint.mimic.is_some() {
        return Err(unsupported("a joint that follows another"));
    }
    if joint.joint_type == JointType::Fixed {
        // What is fixed to the world does not move; the rest is one body.
        match robot.part(&parent) {
            Some(part) => part.join(pieces, outlines),
            None => stands(robot, link),
        }
        return Ok(parent);
    }
    let mut leave = |what: &str| robot.left_out.push(format!("{what} of joint `{}`", joint.name));
    let dynamics = joint.dynamics.as_ref();
    let [damping, friction] = dynamics.map_or([0.0; 2], |d| [d.damping, d.friction]);
    let mut bounds = Bounds::default();
    let of_one = matches!(
        joint.joint_type,
        JointType::Revolute | JointType::Continuous | JointType::Prismatic
    );
    if of_one {
        bounds.friction = friction;
    } else if friction != 0.0 {
        leave("friction");
    }
    let limits = [joint.limit.lower, joint.limit.upper];
    let turns = joint.joint_type == JointType::Revolute;
    let most = if turns { HALF_A_TURN } else { f64::INFINITY };
    // Since version 1.2 a joint may have none.
    let bounded = limits != [f64::NEG_INFINITY, f64::INFINITY];
    let may = turns || joint.joint_type == JointType::Prismatic;
    if may && bounded && !bounds.take(limits, most) {
        leave("limits");
    }
    let axis = || axis_in_world(&joint.name, pose, joint.axis.xyz.0);
    let kind = match joint.joint_type {
        JointType::Revolute | JointType::Continuous => {
            Some(Kind::Hinge { axis: axis()?, stiffness: 0.0, rest: 0.0, damping })
        }
        JointType::Prismatic => {
            if damping != 0.0 {
                leave("damping");
            }
            Some(Kind::Slider { axis: axis()? })
        }
        JointType::Spherical => {
            if damping != 0.0 {
                leave("damping");
            }
            Some(Kind::Ball)
        }
        JointType::Floating => None,
        JointType::Planar => return Err(unsupported("a planar joint")),
        JointType::Fixed => None,
    };
    if let Some(kind) = kind {
        let between = [parent, name.clone()];
        robot.links.push(Link { kind, between, at: pose.translation, bounds });
    }
    robot.parts.push(Part { name: name.clone(), pieces, outlines });
    Ok(name.clone())
}

/// Tells that a link which does not move touches nothing in the scene: walls are all that stands there.
fn stands(robot: &mut Robot, link: &urdf_rs::Link) {
    if !link.collision.is_empty() {
        robot.left_out.push(format!("what touches link `{}`", link.name));
    }
}
