//! What both formats say, at the start: parts in the world, and what joins them.

use std::collections::HashSet;

use nalgebra::{Isometry3, Vector3};

use crate::ImportError;
use crate::inertia::{Inertia, solid_ball, solid_box};

/// The name of what does not move.
pub(crate) const WORLD: &str = "world";
/// Parts of a body by which a shape's place and moments may differ from the body's own: digits of a file.
const DIGITS: f64 = 1e-6;

/// A shape that scenes have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Outline {
    /// Of these sides.
    Box([f64; 3]),
    /// Of this radius.
    Ball(f64),
}

/// A body: all that is fixed to one another.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub(crate) name: String,
    /// In the world.
    pub(crate) inertia: Inertia,
    /// The shapes that it has, in the world; none where one is of another kind.
    pub(crate) outlines: Option<Vec<(Outline, Isometry3<f64>)>>,
}

impl Part {
    /// The one shape that is the body: solid, and where the body's mass is.
    pub(crate) fn outline(&self) -> Option<(Outline, Isometry3<f64>)> {
        let &[(outline, pose)] = &self.outlines.as_ref()?[..] else { return None };
        let mass = self.inertia.mass;
        let solid = match outline {
            Outline::Box(sides) => solid_box(mass, sides),
            Outline::Ball(radius) => solid_ball(mass, radius),
        };
        let (solid, own) = (solid.seen(&pose), &self.inertia);
        let largest = own.moments.amax();
        let near = (solid.moments - own.moments).amax() <= DIGITS * largest
            && (solid.centre - own.centre).norm_squared() * mass <= DIGITS * DIGITS * largest;
        near.then_some((outline, pose))
    }
}

/// What a joint leaves free.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    Ball,
    /// Its axis in the world; a spring's stiffness and the turn at which it rests, and a damper.
    Hinge {
        axis: Vector3<f64>,
        stiffness: f64,
        rest: f64,
        damping: f64,
    },
    Slider {
        axis: Vector3<f64>,
    },
    Fixed,
}

/// A joint at a place of the world.
#[derive(Clone, Debug)]
pub(crate) struct Link {
    pub(crate) kind: Kind,
    pub(crate) between: [String; 2],
    pub(crate) at: Vector3<f64>,
}

/// All of it.
#[derive(Clone, Debug)]
pub(crate) struct Robot {
    pub(crate) title: String,
    pub(crate) format: &'static str,
    pub(crate) gravity: [f64; 3],
    pub(crate) step: f64,
    pub(crate) parts: Vec<Part>,
    pub(crate) links: Vec<Link>,
    /// Planes: a normal and a point.
    pub(crate) walls: Vec<[Vector3<f64>; 2]>,
    /// Coulomb's coefficient, where all shapes have one and the same.
    pub(crate) friction: Option<f64>,
    pub(crate) left_out: Vec<String>,
}

impl Robot {
    /// The part of this name; none of the world.
    pub(crate) fn part(&mut self, name: &str) -> Option<&mut Part> {
        self.parts.iter_mut().find(|part| part.name == name)
    }

    /// Names that a scene accepts, each once.
    pub(crate) fn check_names(&self, what: &'static str) -> Result<(), ImportError> {
        let mut seen = HashSet::from([WORLD]);
        match self.parts.iter().find(|part| !seen.insert(&part.name)) {
            None => Ok(()),
            Some(part) => Err(ImportError::Duplicate { what, name: part.name.clone() }),
        }
    }
}

/// A name as scenes have them: letters, digits, spaces, `-` and `_`, the first a letter or a digit.
pub(crate) fn plain_name(name: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() || matches!(c, ' ' | '-' | '_') { c } else { '_' };
    let name: String = name.chars().map(plain).collect();
    let start = name.chars().next().is_some_and(char::is_alphanumeric);
    if start { name } else { format!("x{name}") }
}

/// The direction of a joint's axis in the world.
pub(crate) fn axis_in_world(
    joint: &str,
    pose: &Isometry3<f64>,
    axis: [f64; 3],
) -> Result<Vector3<f64>, ImportError> {
    let axis = pose.rotation * Vector3::from(axis);
    let length = axis.norm();
    if length.is_nan() || length.is_infinite() {
        return Err(ImportError::NonFinite { what: "the axis", name: joint.to_owned() });
    }
    if length == 0.0 {
        return Err(ImportError::Axis { joint: joint.to_owned() });
    }
    Ok(axis / length)
}
