//! The scene's text.

use std::collections::HashSet;
use std::fmt::Write as _;

use nalgebra::Vector3;
use stationary_rigid::LieGroup;

use crate::robot::{Kind, Link, Outline, Part, Robot, Solid, WORLD, wall_name};
use crate::{Description, ImportError};

/// Seconds that the scene runs, at most by half a step more or less.
const HORIZON: f64 = 1.0;
/// Steps that it takes at most, of a step so short that a scene would not have as many.
const STEPS: f64 = 1e9;
/// Samples that it takes at most.
const SAMPLES: f64 = 1e4;

fn numbers(numbers: impl IntoIterator<Item = f64>) -> String {
    // A zero has no sign that anyone would want to read.
    let written = numbers.into_iter().map(|x| format!("{:?}", x + 0.0));
    format!("[{}]", written.collect::<Vec<_>>().join(", "))
}

fn vector(v: &Vector3<f64>) -> String {
    numbers(v.iter().copied())
}

/// A text in quotes.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

fn shape(outline: &Outline) -> String {
    let long =
        |[length, radius]: &[f64; 2]| format!("{{ length = {length:?}, radius = {radius:?} }}");
    match outline {
        Outline::Box(sides) => format!("box = {}", numbers(*sides)),
        Outline::Ball(radius) => format!("ball = {radius:?}"),
        Outline::Cylinder(size) => format!("cylinder = {}", long(size)),
        Outline::Capsule(size) => format!("capsule = {}", long(size)),
        #[cfg(feature = "mjcf")]
        Outline::Ellipsoid(half) => format!("ellipsoid = {}", numbers(*half)),
    }
}

fn body(name: &String, solid: &Solid, links: &[Link]) -> String {
    let Solid { body, pose: axes, outline } = solid;
    let (shape, pose) = match outline {
        Some((outline, pose)) => (shape(outline), pose),
        None => {
            let ends = links.iter().filter(|link| link.between.contains(name));
            let points = ends.map(|link| vector(&axes.inverse().apply(&link.at)));
            let points = points.collect::<Vec<_>>().join(", ");
            (format!("moments = {}\npoints = [{points}]", vector(&body.moments())), axes)
        }
    };
    format!(
        "\n[[bodies]]\nname = {}\nmass = {:?}\n{shape}\nposition = {}\nrotation = {}\n",
        quoted(name),
        body.mass(),
        vector(&pose.translation),
        vector(&pose.rotation.log())
    )
}

fn joint(link: &Link) -> String {
    let [first, second] = &link.between;
    let mut out = String::from("\n[[joints]]\n");
    let (kind, axis) = match link.kind {
        Kind::Ball => ("ball", None),
        Kind::Hinge { axis, .. } => ("hinge", Some(axis)),
        Kind::Slider { axis } => ("slider", Some(axis)),
        #[cfg(feature = "mjcf")]
        Kind::Fixed => ("fixed", None),
    };
    let _ = writeln!(out, "kind = \"{kind}\"\nbetween = [{}, {}]", quoted(first), quoted(second));
    let _ = writeln!(out, "at = {}", vector(&link.at));
    if let Some(axis) = axis {
        let _ = writeln!(out, "axis = {}", vector(&axis));
    }
    if let Kind::Hinge { stiffness, rest, damping, .. } = link.kind {
        if stiffness != 0.0 {
            let _ = writeln!(out, "stiffness = {stiffness:?}\nrest = {rest:?}");
        }
        if damping != 0.0 {
            let _ = writeln!(out, "damping = {damping:?}");
        }
    }
    if let Some(limits) = link.bounds.limits {
        let _ = writeln!(out, "limits = {}", numbers(limits));
    }
    if link.bounds.friction != 0.0 {
        let _ = writeln!(out, "friction = {:?}", link.bounds.friction);
    }
    out
}

/// The scene of a robot.
pub(crate) fn scene(mut robot: Robot) -> Result<Description, ImportError> {
    if robot.parts.is_empty() {
        return Err(ImportError::Empty);
    }
    // A place that is none would be read as a word.
    let places = robot.links.iter().map(|link| &link.at).chain(robot.walls.iter().flatten());
    if !places.flatten().chain(&robot.gravity).all(|x| x.is_finite()) {
        return Err(ImportError::NonFinite {
            what: "a joint, a wall or the gravity",
            name: robot.title,
        });
    }
    for link in &robot.links {
        let [stiffness, rest, damping] = match link.kind {
            Kind::Hinge { stiffness, rest, damping, .. } => [stiffness, rest, damping],
            _ => [0.0; 3],
        };
        if ![stiffness, rest, damping, link.bounds.friction].iter().all(|x| x.is_finite()) {
            return Err(ImportError::NonFinite {
                what: "the spring, the damper or the friction at the joint",
                name: link.between[1].clone(),
            });
        }
        for (what, value) in [
            ("the stiffness at the joint", stiffness),
            ("the damping at the joint", damping),
            ("the friction at the joint", link.bounds.friction),
        ] {
            if value < 0.0 {
                return Err(ImportError::Negative { what, name: link.between[1].clone(), value });
            }
        }
    }
    let solids = robot.parts.iter().map(Part::solid).collect::<Result<Vec<_>, _>>()?;
    let bodies: String = robot
        .parts
        .iter()
        .zip(&solids)
        .map(|(part, solid)| body(&part.name, solid, &robot.links))
        .collect();
    let mut contact = String::new();
    // Whatever has a shape, of a kind that scenes have or of another.
    let touches = |part: &&Part| part.outlines.as_ref().is_none_or(|all| !all.is_empty());
    let alone = robot.walls.is_empty() && robot.parts.len() == 1;
    if !alone && solids.iter().all(|solid| solid.outline.is_some()) {
        contact.push_str("\n[contact]\n");
        if let Some(friction) = robot.friction.filter(|&friction| friction > 0.0) {
            let _ = writeln!(contact, "friction = {friction:?}");
        }
        // Neighbours at a joint pass through each other.
        let joined = robot.links.iter().map(|link| &link.between);
        let joined = joined.filter(|between| between.iter().all(|name| name != WORLD));
        let mut told = HashSet::new();
        for [a, b] in joined.chain(&robot.apart) {
            // A scene takes each pair once, whichever of the two stands first.
            if !told.insert([a.min(b), a.max(b)]) {
                continue;
            }
            let _ = writeln!(
                contact,
                "\n[[contact.pairs]]\nof = [{}, {}]\nmeet = false",
                quoted(a),
                quoted(b)
            );
        }
        for (k, [normal, at]) in robot.walls.iter().enumerate() {
            let name = wall_name(k);
            let named = robot.apart.iter().flatten().any(|other| *other == name);
            let name = if named { format!("name = {}\n", quoted(&name)) } else { String::new() };
            let _ = writeln!(
                contact,
                "\n[[contact.walls]]\n{name}normal = {}\nat = {}",
                vector(normal),
                vector(at)
            );
        }
    } else if !alone {
        let left = robot.parts.iter().filter(touches);
        robot.left_out.extend(left.map(|part| format!("what `{}` touches", part.name)));
    }
    let mut text = format!("# From a description in {}.\n", robot.format);
    if !robot.left_out.is_empty() {
        text.push_str(
            "#\n# Left out, so that this motion is another one than that of the description:\n",
        );
        for one in &robot.left_out {
            let _ = writeln!(text, "# - {}", one.replace(char::is_control, " "));
        }
    }
    let steps = (HORIZON / robot.step).round().clamp(1.0, STEPS);
    let _ = write!(
        text,
        "\ntitle = {}\ndimension = 3\nintegrator = \"variational-rotation\"\nstep = {:?}\nhorizon = \"= {steps}*{:?}\"\n",
        quoted(&robot.title),
        robot.step,
        robot.step
    );
    if steps > SAMPLES {
        let _ = writeln!(text, "sample_every = {}", (steps / SAMPLES).ceil());
    }
    let _ = writeln!(text, "observables = [\"energy\"]");
    if robot.gravity.iter().any(|&g| g != 0.0) {
        let _ = writeln!(text, "\n[uniform_gravity]\nacceleration = {}", numbers(robot.gravity));
    }
    text.push_str(&bodies);
    text.extend(robot.links.iter().map(joint));
    text.push_str(&contact);
    Ok(Description { text, left_out: robot.left_out })
}
