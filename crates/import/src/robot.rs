//! What both formats say, at the start: parts in the world, and what joins them.

use std::collections::HashSet;

use nalgebra::{Matrix3, Vector3};
use stationary_rigid::{Body, PrincipalFrame, RigidError, RigidMotion, SpatialMass};

use crate::ImportError;

/// The name of what does not move.
pub(crate) const WORLD: &str = "world";
/// The largest limit of a turn: in space turns are known up to whole ones.
pub(crate) const HALF_A_TURN: f64 = std::f64::consts::PI;
/// Parts by which moments may differ from those of a shape or of a plate: digits of a file.
const DIGITS: f64 = 1e-6;

/// A shape that scenes have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Outline {
    /// Of these sides.
    Box([f64; 3]),
    /// Of this radius.
    Ball(f64),
    /// Of this length and radius, about the third axis.
    Cylinder([f64; 2]),
    /// The same, the length that of the straight part.
    Capsule([f64; 2]),
    /// Of these half axes.
    #[cfg(feature = "mjcf")]
    Ellipsoid([f64; 3]),
}

/// A body: all that is fixed to one another.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub(crate) name: String,
    /// In the world.
    pub(crate) pieces: Vec<SpatialMass>,
    /// The shapes that it has, in the world; none where one is of another kind.
    pub(crate) outlines: Option<Vec<(Outline, RigidMotion)>>,
}

/// A part as one solid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solid {
    pub(crate) body: Body,
    /// Of its principal axes.
    pub(crate) pose: RigidMotion,
    /// The one shape that is the body: solid, and where the body's mass is.
    pub(crate) outline: Option<(Outline, RigidMotion)>,
}

impl Part {
    /// Adds what is fixed to it.
    pub(crate) fn join(
        &mut self,
        pieces: Vec<SpatialMass>,
        outlines: Option<Vec<(Outline, RigidMotion)>>,
    ) {
        self.pieces.extend(pieces);
        self.outlines = self.outlines.take().zip(outlines).map(|(mut all, own)| {
            all.extend(own);
            all
        });
    }

    /// All of it as one.
    pub(crate) fn solid(&self) -> Result<Solid, ImportError> {
        let name = &self.name;
        if self.pieces.iter().all(|piece| piece.mass == 0.0) {
            return Err(ImportError::Massless { name: name.clone() });
        }
        let solid = || -> Result<Solid, RigidError> {
            let all = SpatialMass::composite(&self.pieces)?;
            let frame = PrincipalFrame::of(&((all.inertia + all.inertia.transpose()) * 0.5))?;
            let [a, b, mut c] = frame.moments;
            // A plate's moments, written with few digits.
            if c > a + b && c <= (a + b) * (1.0 + DIGITS) {
                c = a + b;
            }
            let body = Body::new(all.mass, [a, b, c])?;
            let pose = RigidMotion { translation: all.centre, rotation: frame.rotation };
            Ok(Solid { body, pose, outline: self.outline(&all) })
        };
        solid().map_err(|source| ImportError::Body { name: name.clone(), source: Box::new(source) })
    }

    fn outline(&self, own: &SpatialMass) -> Option<(Outline, RigidMotion)> {
        let &[(outline, pose)] = &self.outlines.as_ref()?[..] else { return None };
        let solid = match outline {
            Outline::Box(sides) => Body::solid_box(own.mass, sides.map(|side| 0.5 * side)),
            Outline::Ball(radius) => Body::solid_ball(own.mass, radius),
            Outline::Cylinder([length, radius]) => {
                Body::solid_cylinder(own.mass, 0.5 * length, radius)
            }
            Outline::Capsule([length, radius]) => {
                Body::solid_capsule(own.mass, 0.5 * length, radius)
            }
            #[cfg(feature = "mjcf")]
            Outline::Ellipsoid(half) => Body::solid_ellipsoid(own.mass, half),
        };
        let solid = piece(&solid.ok()?).moved(&pose);
        let largest = own.inertia.amax();
        let near = (solid.inertia - own.inertia).amax() <= DIGITS * largest
            && (solid.centre - own.centre).norm_squared() * own.mass <= DIGITS * DIGITS * largest;
        near.then_some((outline, pose))
    }
}

/// A body in its own frame.
pub(crate) fn piece(body: &Body) -> SpatialMass {
    let inertia = Matrix3::from_diagonal(&body.moments());
    SpatialMass { mass: body.mass(), centre: Vector3::zeros(), inertia }
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
    #[cfg(feature = "mjcf")]
    Fixed,
}

/// What bounds the turn of a hinge (rad, N m) or the shift of a slider (m, N).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Bounds {
    pub(crate) limits: Option<[f64; 2]>,
    /// The largest torque or force of dry friction.
    pub(crate) friction: f64,
}

impl Bounds {
    /// Takes limits that a scene can have: they are finite, the start lies between them, and none is beyond `most`;
    /// says whether.
    pub(crate) fn take(&mut self, [low, high]: [f64; 2], most: f64) -> bool {
        let finite = low.is_finite() && high.is_finite();
        let fits =
            finite && low <= 0.0 && high >= 0.0 && low < high && low >= -most && high <= most;
        if fits {
            self.limits = Some([low, high]);
        }
        fits
    }
}

/// A joint at a place of the world.
#[derive(Clone, Debug)]
pub(crate) struct Link {
    pub(crate) kind: Kind,
    pub(crate) between: [String; 2],
    pub(crate) at: Vector3<f64>,
    pub(crate) bounds: Bounds,
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
    /// Planes: a normal and a point. The first is `wall 1`.
    pub(crate) walls: Vec<[Vector3<f64>; 2]>,
    /// Pairs of parts, or of a part and a wall, that pass through each other.
    pub(crate) apart: Vec<[String; 2]>,
    /// Coulomb's coefficient, where all shapes have one and the same.
    pub(crate) friction: Option<f64>,
    pub(crate) left_out: Vec<String>,
}

impl Robot {
    /// The part of this name; none of the world.
    pub(crate) fn part(&mut self, name: &str) -> Option<&mut Part> {
        self.parts.iter_mut().find(|part| part.name == name)
    }

    /// Whether nothing that moves has the world's name.
    pub(crate) fn check_names(&self, what: &'static str) -> Result<(), ImportError> {
        match self.parts.iter().find(|part| part.name == WORLD) {
            None => Ok(()),
            Some(part) => Err(ImportError::Duplicate { what, name: part.name.clone() }),
        }
    }
}

/// The longest name of a scene, in characters.
const NAME: usize = 64;

/// Names that a scene accepts, each once: what has none is called by its number, and of names that are alike to a
/// scene all but the first are counted. So many walls have names of their own.
pub(crate) fn scene_names(
    what: &'static str,
    own: &[Option<&str>],
    walls: usize,
) -> Result<Vec<String>, ImportError> {
    let mut seen = HashSet::new();
    if let Some(name) = own.iter().flatten().find(|name| !seen.insert(*name)) {
        return Err(ImportError::Duplicate { what, name: (*name).to_owned() });
    }
    let mut taken: HashSet<_> = (0..walls).map(wall_name).collect();
    let mut free = |wished: String| {
        let counted = (2..).map(|k| {
            let count = format!(" {k}");
            wished.chars().take(NAME - count.len()).collect::<String>() + &count
        });
        let all = std::iter::once(wished.chars().take(NAME).collect()).chain(counted);
        let name: String = all.into_iter().find(|name| !taken.contains(name)).unwrap_or_default();
        taken.insert(name.clone());
        name
    };
    // What has a name keeps it beside what has none.
    let named: Vec<_> = own.iter().map(|own| own.map(|own| free(plain_name(own)))).collect();
    let numbered = named.into_iter().enumerate();
    Ok(numbered.map(|(k, name)| name.unwrap_or_else(|| free(format!("{what} {k}")))).collect())
}

/// The name of a wall, counted from zero.
pub(crate) fn wall_name(k: usize) -> String {
    format!("wall {}", k + 1)
}

/// A name as scenes have them: letters, digits, spaces, `-` and `_`, the first a letter or a digit.
fn plain_name(name: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() || matches!(c, ' ' | '-' | '_') { c } else { '_' };
    let name: String = name.chars().map(plain).collect();
    let start = name.chars().next().is_some_and(char::is_alphanumeric);
    if start { name } else { format!("x{name}") }
}

/// The direction of a joint's axis in the world.
pub(crate) fn axis_in_world(
    joint: &str,
    pose: &RigidMotion,
    axis: [f64; 3],
) -> Result<Vector3<f64>, ImportError> {
    let axis = pose.rotation.rotate(&Vector3::from(axis));
    let length = axis.norm();
    if length.is_nan() || length.is_infinite() {
        return Err(ImportError::NonFinite { what: "the axis", name: joint.to_owned() });
    }
    if length == 0.0 {
        return Err(ImportError::Axis { joint: joint.to_owned() });
    }
    Ok(axis / length)
}
