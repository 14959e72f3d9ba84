//! Random robots as URDF.

use nalgebra::{Isometry3, Matrix3};
use stationary_import::scene_of_urdf;

use super::element::Element;
use super::judged::judged;
use super::numbers::{about_fixed_axes, number, numbers};
use super::robot::{Free, Link, Piece, Robot, Says, robot, turn};
use crate::{Draw, Kind, Verdict};

/// Robots in URDF.
pub const KIND: Kind = Kind {
    name: "robots-in-urdf",
    krate: "import",
    rule: "the scene of a random tree of links, its elements and attributes in any order and its turns by angles or \
           quaternions, has a mass, a centre, an inertia tensor, a joint, an axis or a limit that is off by more than \
           1e-12 of its size, or has others; or something is left out",
    in_tests: 500,
    trial,
};

fn trial(draw: &mut Draw) -> Verdict {
    let robot = robot(draw, Says { more: false });
    let text = written(draw, &robot);
    draw.note(text.clone());
    judged(&robot, scene_of_urdf(&text))
}

fn written(draw: &mut Draw, robot: &Robot) -> String {
    // By angles a turn near a pitch of a right angle is not told to all digits.
    let pieces = robot.links.iter().flat_map(|link| &link.pieces).map(|piece| piece.turn);
    let mut turns = robot.links.iter().map(|link| link.at.rotation).chain(pieces);
    let quaternions = turns.any(|turn| about_fixed_axes(&turn).is_none()) || draw.chance(0.3);
    let mut root = Element::new("robot").says("name", "random").with(base());
    if quaternions {
        root = root.says("version", "1.1");
    }
    for link in &robot.links {
        let mut own = Element::new("link").says("name", &link.name);
        if let Some(piece) = link.pieces.first() {
            own = own.with(inertial(draw, piece, quaternions));
        }
        let parent = link.parent.map_or("base", |parent| &robot.links[parent].name);
        root = root.with(own).with(joint(draw, link, parent, quaternions));
    }
    let mut out = String::new();
    root.write(draw, &[], &mut out);
    out
}

/// What has no mass and hangs on nothing is the world.
fn base() -> Element {
    Element::new("link").says("name", "base")
}

fn origin(draw: &mut Draw, at: &Isometry3<f64>, quaternions: bool) -> Element {
    let place = at.translation.vector;
    let origin = Element::new("origin").says("xyz", numbers(draw, place.as_slice()));
    let angles = about_fixed_axes(&at.rotation).filter(|_| !quaternions || draw.chance(0.5));
    let Some(angles) = angles else {
        let parts = at.rotation.coords * draw.log_uniform(0.1, 10.0);
        return origin.says("quat_xyzw", numbers(draw, parts.as_slice()));
    };
    origin.says("rpy", numbers(draw, &angles))
}

fn inertial(draw: &mut Draw, piece: &Piece, quaternions: bool) -> Element {
    // The frame in which the tensor is written is any.
    let other = turn(draw);
    let told = quaternions || about_fixed_axes(&other).is_some();
    let frame = if told && draw.chance(0.5) { other } else { piece.turn };
    let own = (frame.inverse() * piece.turn).to_rotation_matrix();
    let tensor = own.matrix() * Matrix3::from_diagonal(&piece.moments.into()) * own.inverse();
    let at = Isometry3::from_parts(piece.centre.into(), frame);
    let mut inertia = Element::new("inertia");
    for (word, i, j) in
        [("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2)]
    {
        inertia = inertia.says(word, number(draw, tensor[(i, j)]));
    }
    let mass = Element::new("mass").says("value", number(draw, piece.mass));
    Element::new("inertial").with(origin(draw, &at, quaternions)).with(mass).with(inertia)
}

fn joint(draw: &mut Draw, link: &Link, parent: &str, quaternions: bool) -> Element {
    let kind = match (link.free, link.limits) {
        (Free::Nothing, _) => "fixed",
        (Free::All, _) => "floating",
        (Free::Ball, _) => "spherical",
        (Free::Turn, Some(_)) => "revolute",
        (Free::Turn, None) => "continuous",
        (Free::Shift, _) => "prismatic",
    };
    let mut joint = Element::new("joint")
        .says("name", format!("joint of {}", link.name))
        .says("type", kind)
        .with(Element::new("parent").says("link", parent))
        .with(Element::new("child").says("link", &link.name))
        .with(origin(draw, &link.at, quaternions));
    if matches!(link.free, Free::Turn | Free::Shift) {
        joint = joint.with(Element::new("axis").says("xyz", numbers(draw, link.axis.as_slice())));
    }
    if let Some([low, high]) = link.limits {
        let limit = Element::new("limit").says("lower", number(draw, low));
        let limit = limit.says("upper", number(draw, high)).says("effort", "1");
        joint = joint.with(limit.says("velocity", "1"));
    }
    if link.damping != 0.0 || link.friction != 0.0 {
        let dynamics = Element::new("dynamics").says("damping", number(draw, link.damping));
        joint = joint.with(dynamics.says("friction", number(draw, link.friction)));
    }
    joint
}
