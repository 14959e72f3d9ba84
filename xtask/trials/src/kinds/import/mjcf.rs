//! Random robots as MJCF, in random spellings.

use nalgebra::{Isometry3, Matrix3, Point3, UnitQuaternion, Vector3};
use stationary_import::scene_of_mjcf;

use super::element::Element;
use super::judged::judged;
use super::numbers::{about_fixed_axes, about_own_axes, number, numbers};
use super::robot::{Free, Link, Piece, Robot, Says, Solid, robot, turn, vector};
use crate::{Draw, Kind, Verdict};

mod classes;

/// Robots in MJCF.
pub const KIND: Kind = Kind {
    name: "robots-in-mjcf",
    krate: "import",
    rule: "the scene of a random tree of bodies, in any order, its turns by any word, in degrees or radians, \
           in frames, by classes in classes, weighed by moments, tensors or shapes, has a mass, a centre, an \
           inertia tensor, a joint, an axis, a spring or a limit that is off by more than 1e-12 of its size, or \
           has others; or something is left out",
    in_tests: 500,
    trial,
};

/// Settings of the whole file.
#[derive(Clone, Copy, Debug)]
struct Settings {
    degrees: bool,
    sequence: &'static str,
    /// Shapes weigh, whatever else is written.
    by_shapes: bool,
    autolimits: bool,
}

fn trial(draw: &mut Draw) -> Verdict {
    let robot = robot(draw, Says { more: true });
    let text = written(draw, &robot);
    draw.note(text.clone());
    judged(&robot, scene_of_mjcf(&text, "."))
}

fn written(draw: &mut Draw, robot: &Robot) -> String {
    let solid = |piece: &Piece| piece.solid.is_some();
    let all = robot.links.iter().all(|link| link.pieces.iter().all(solid));
    let settings = Settings {
        degrees: draw.chance(0.5),
        sequence: draw.one_of(&["xyz", "XYZ", "zyx", "ZYX"]),
        by_shapes: all && draw.chance(0.5),
        autolimits: draw.chance(0.7),
    };
    let mut compiler = Element::new("compiler")
        .says("eulerseq", settings.sequence)
        .says("angle", if settings.degrees { "degree" } else { "radian" })
        .says("autolimits", if settings.autolimits { "true" } else { "false" });
    if settings.by_shapes {
        compiler = compiler.says("inertiafromgeom", "true");
    }
    let tops = (0..robot.links.len()).filter(|&k| robot.links[k].parent.is_none());
    let mut world = Element::new("worldbody");
    for top in tops {
        let body = body(draw, robot, top, &settings);
        world = world.with(framed(draw, &settings, robot.unit, body, &robot.links[top].at));
    }
    let defaults = classes::classes(draw, &mut world);
    let rest = if draw.chance(0.5) { [defaults, world] } else { [world, defaults] };
    // The reader refuses angles whose unit stands after them.
    let root = Element::new("mujoco").with(compiler);
    let root = rest.into_iter().fold(root, Element::with);
    let mut out = String::new();
    root.write(draw, &["mujoco"], &mut out);
    out
}

/// A body without its pose, with all that hangs on it.
fn body(draw: &mut Draw, robot: &Robot, link: usize, settings: &Settings) -> Element {
    let own = &robot.links[link];
    let mut body = Element::new("body").says("name", &own.name);
    let solid = own.pieces.iter().all(|piece| piece.solid.is_some()) && !own.pieces.is_empty();
    if solid {
        for piece in &own.pieces {
            body = body.with(geom(draw, robot.unit, piece, settings));
        }
        if settings.by_shapes && draw.chance(0.3) {
            let wrong = Element::new("inertial").says("pos", "7 7 7").says("mass", "99");
            body = body.with(wrong.says("diaginertia", "9 9 9"));
        }
    } else if let Some(piece) = own.pieces.first() {
        body = body.with(inertial(draw, piece, settings));
        if draw.chance(0.3) {
            let wrong = Element::new("geom").says("type", "sphere").says("size", "1");
            body = body.with(wrong.says("contype", "0").says("conaffinity", "0"));
        }
    }
    body = body.with_some(joint(draw, own, settings));
    for below in (0..robot.links.len()).filter(|&k| robot.links[k].parent == Some(link)) {
        let inside = self::body(draw, robot, below, settings);
        body = body.with(framed(draw, settings, robot.unit, inside, &robot.links[below].at));
    }
    body
}

/// An element at its pose, some in a frame of their own.
fn framed(
    draw: &mut Draw,
    settings: &Settings,
    unit: f64,
    mut inside: Element,
    at: &Isometry3<f64>,
) -> Element {
    if !draw.chance(0.2) {
        inside.said.extend(pose(draw, settings, at));
        return inside;
    }
    let frame = Isometry3::from_parts(vector(draw, unit).into(), turn(draw));
    let own = frame.inverse() * at;
    inside.said.extend(pose(draw, settings, &own));
    let mut out = Element::new("frame").with(inside);
    out.said.extend(pose(draw, settings, &frame));
    out
}

fn pose(draw: &mut Draw, settings: &Settings, at: &Isometry3<f64>) -> Vec<(&'static str, String)> {
    let place = at.translation.vector;
    vec![("pos", numbers(draw, place.as_slice())), turned(draw, settings, &at.rotation)]
}

/// A turn in one of its words.
fn turned(
    draw: &mut Draw,
    settings: &Settings,
    turn: &UnitQuaternion<f64>,
) -> (&'static str, String) {
    let unit = if settings.degrees { 1.0_f64.to_degrees() } else { 1.0 };
    let scale = draw.log_uniform(0.1, 10.0);
    let angles = match settings.sequence {
        "xyz" => about_own_axes(turn),
        "XYZ" => about_fixed_axes(turn),
        "zyx" => about_fixed_axes(turn).map(|[x, y, z]| [z, y, x]),
        _ => about_own_axes(turn).map(|[x, y, z]| [z, y, x]),
    };
    match (draw.below(4), angles) {
        (0, Some(angles)) => ("euler", numbers(draw, &angles.map(|angle| angle * unit))),
        (1, _) => {
            let (axis, angle) = turn
                .axis_angle()
                .map_or((Vector3::z(), 0.0), |(axis, angle)| (axis.into_inner(), angle));
            let [x, y, z] = (axis * scale).into();
            ("axisangle", numbers(draw, &[x, y, z, angle * unit]))
        }
        (2, _) => {
            let (x, y) = (turn * Vector3::x() * scale, turn * Vector3::y());
            let y = y / scale + x * draw.symmetric();
            ("xyaxes", numbers(draw, &[x.x, x.y, x.z, y.x, y.y, y.z]))
        }
        _ => {
            let q = turn.quaternion();
            ("quat", numbers(draw, &[q.w, q.i, q.j, q.k].map(|part| part * -scale)))
        }
    }
}

fn inertial(draw: &mut Draw, piece: &Piece, settings: &Settings) -> Element {
    let inertial = Element::new("inertial")
        .says("pos", numbers(draw, piece.centre.as_slice()))
        .says("mass", number(draw, piece.mass));
    if draw.chance(0.5) {
        let turn = piece.turn.to_rotation_matrix();
        let t = turn.matrix() * Matrix3::from_diagonal(&piece.moments.into()) * turn.inverse();
        let six = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|place| t[place]);
        return inertial.says("fullinertia", numbers(draw, &six));
    }
    let (word, turn) = turned(draw, settings, &piece.turn);
    inertial.says("diaginertia", numbers(draw, &piece.moments)).says(word, turn)
}

fn geom(draw: &mut Draw, unit: f64, piece: &Piece, settings: &Settings) -> Element {
    let Some((solid, density)) = piece.solid else { return Element::new("geom") };
    let (kind, mut size, ends) = match solid {
        Solid::Sphere(r) => ("sphere", vec![r], None),
        Solid::Box([a, b, c]) => ("box", vec![a, b, c], (a == b).then_some(c)),
        Solid::Ellipsoid([a, b, c]) => ("ellipsoid", vec![a, b, c], (a == b).then_some(c)),
        Solid::Cylinder(r, half) => ("cylinder", vec![r, half], Some(half)),
        Solid::Capsule(r, half) => ("capsule", vec![r, half], Some(half)),
    };
    let mut geom =
        Element::new("geom").says("type", kind).says("contype", "0").says("conaffinity", "0");
    let by_mass = draw.chance(0.3);
    let (word, weight) = if by_mass { ("mass", piece.mass) } else { ("density", density) };
    geom = geom.says(word, number(draw, weight));
    let at = Isometry3::from_parts(piece.centre.into(), piece.turn);
    if let Some(half) = ends.filter(|_| draw.chance(0.4)) {
        size.truncate(1);
        let mut two = [half, -half].map(|z| at * Point3::new(0.0, 0.0, z));
        if draw.chance(0.5) {
            two.reverse();
        }
        let ends: Vec<f64> = two.iter().flat_map(|end| end.iter().copied()).collect();
        return geom.says("size", numbers(draw, &size)).says("fromto", numbers(draw, &ends));
    }
    let geom = geom.says("size", numbers(draw, &size));
    framed(draw, settings, unit, geom, &at)
}

fn joint(draw: &mut Draw, link: &Link, settings: &Settings) -> Option<Element> {
    let kind = match link.free {
        Free::Nothing => return None,
        Free::All if draw.chance(0.5) => return Some(Element::new("freejoint")),
        Free::All => "free",
        Free::Ball => "ball",
        Free::Turn => "hinge",
        Free::Shift => "slide",
    };
    let mut joint = Element::new("joint").says("type", kind);
    if !matches!(link.free, Free::Turn | Free::Shift) {
        return Some(joint);
    }
    let turns = link.free == Free::Turn;
    let unit = if turns && settings.degrees { 1.0_f64.to_degrees() } else { 1.0 };
    let from = if draw.chance(0.5) {
        draw.uniform(-1.0, 1.0) * if turns { 1.0 } else { link.at.translation.vector.norm() }
    } else {
        0.0
    };
    joint = joint
        .says("pos", numbers(draw, link.place.as_slice()))
        .says("axis", numbers(draw, link.axis.as_slice()))
        .says("damping", number(draw, link.damping))
        .says("stiffness", number(draw, link.stiffness))
        .says("frictionloss", number(draw, link.friction))
        .says("ref", number(draw, from * unit))
        .says("springref", number(draw, (link.rest + from) * unit));
    let limits = link.limits.map(|limits| limits.map(|limit| (limit + from) * unit));
    let told = !settings.autolimits || draw.chance(0.3);
    if let Some(limits) = limits {
        joint = joint.says("range", numbers(draw, &limits));
    }
    if told {
        joint = joint.says("limited", if limits.is_some() { "true" } else { "false" });
        if limits.is_none() && draw.chance(0.5) {
            joint = joint.says("range", "-1 1");
        }
    }
    Some(joint)
}
