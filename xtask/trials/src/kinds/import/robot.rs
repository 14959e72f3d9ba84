//! A random robot as data, and what its scene must be by rigid motions and parallel axes.
//!
//! ```text
//! X_k = X_parent(k) A_k                          frames, all joints at zero
//! m = sum m_i,  c = sum m_i c_i / m              of all that is fixed to one another
//! J = sum R_i diag(J_i) R_i^T + m_i (d^2 1 - d d^T),    d = c_i - c
//! ```

use std::f64::consts::PI;

use nalgebra::{Isometry3, Matrix3, Translation3, Unit, UnitQuaternion, Vector3};

use crate::Draw;

/// What a joint leaves free.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Free {
    Nothing,
    All,
    Ball,
    Turn,
    Shift,
}

/// What a body weighs, in its link's frame.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub(super) mass: f64,
    pub(super) centre: Vector3<f64>,
    pub(super) turn: UnitQuaternion<f64>,
    pub(super) moments: [f64; 3],
    /// A solid of this density, where it is one.
    pub(super) solid: Option<(Solid, f64)>,
}

/// A solid about its own third axis: half sides, half axes, a radius and half a length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Solid {
    Sphere(f64),
    Box([f64; 3]),
    Ellipsoid([f64; 3]),
    Cylinder(f64, f64),
    Capsule(f64, f64),
}

/// A link with the joint that it hangs on.
#[derive(Clone, Debug)]
pub(super) struct Link {
    pub(super) name: String,
    /// What it hangs on; the world where there is none.
    pub(super) parent: Option<usize>,
    /// Its frame in its parent's.
    pub(super) at: Isometry3<f64>,
    pub(super) pieces: Vec<Piece>,
    pub(super) free: Free,
    /// Where the joint is, and its axis, of any length, in the link's frame.
    pub(super) place: Vector3<f64>,
    pub(super) axis: Vector3<f64>,
    pub(super) stiffness: f64,
    pub(super) rest: f64,
    pub(super) damping: f64,
    pub(super) friction: f64,
    pub(super) limits: Option<[f64; 2]>,
}

/// A random robot: a forest on the world.
#[derive(Clone, Debug)]
pub(super) struct Robot {
    pub(super) links: Vec<Link>,
    /// Its unit of length.
    pub(super) unit: f64,
}

/// What a format can say.
#[derive(Clone, Copy, Debug)]
pub(super) struct Says {
    /// Joints beside the origin of their link, springs at hinges, and solids that weigh.
    pub(super) more: bool,
}

pub(super) fn turn(draw: &mut Draw) -> UnitQuaternion<f64> {
    let angle = draw.one_of(&[0.0, 0.5 * PI, -0.5 * PI, PI, 1.0, 3.0, -2.0]);
    let angle = if draw.chance(0.5) { angle + 0.1 * draw.symmetric() } else { angle };
    let axis = match draw.below(6) {
        0 => Vector3::x(),
        1 => Vector3::y(),
        2 => Vector3::z(),
        _ => vector(draw, 1.0),
    };
    let axis = if axis.norm() < 0.01 { Vector3::x() } else { axis };
    UnitQuaternion::from_axis_angle(&Unit::new_normalize(axis), angle)
}

pub(super) fn vector(draw: &mut Draw, size: f64) -> Vector3<f64> {
    Vector3::from_vec(draw.vector(3)) * size
}

pub(super) fn robot(draw: &mut Draw, says: Says) -> Robot {
    let unit = draw.log_uniform(1e-3, 1e3);
    let mass = draw.log_uniform(1e-6, 1e6);
    let count = draw.between(1, 6);
    let mut links: Vec<Link> = Vec::with_capacity(count);
    for k in 0..count {
        let parent = if k > 0 && !draw.chance(0.2) { Some(draw.below(k)) } else { None };
        links.push(link(draw, (unit, mass), (k, parent), says));
    }
    // Something moves.
    if links.iter().all(|link| link.free == Free::Nothing) {
        links[0].free = Free::Turn;
    }
    // What moves has mass.
    for link in &mut links {
        if link.free != Free::Nothing && link.pieces.is_empty() {
            link.pieces.push(piece(draw, unit, mass, false));
        }
    }
    Robot { links, unit }
}

fn link(
    draw: &mut Draw,
    (unit, mass): (f64, f64),
    (k, parent): (usize, Option<usize>),
    says: Says,
) -> Link {
    let mut kinds = vec![Free::Turn, Free::Shift, Free::Ball, Free::Nothing, Free::Turn];
    if parent.is_none() {
        kinds.push(Free::All);
    }
    let free = draw.one_of(&kinds);
    let at = Isometry3::from_parts(Translation3::from(vector(draw, unit)), turn(draw));
    let solid = says.more && draw.chance(0.5);
    let pieces = match draw.below(4) {
        0 => Vec::new(),
        _ if solid => (0..draw.between(1, 3)).map(|_| piece(draw, unit, mass, true)).collect(),
        _ => vec![piece(draw, unit, mass, false)],
    };
    let turns = free == Free::Turn;
    let of_one = turns || free == Free::Shift;
    let mut some = |of: bool, size: f64| if of && draw.chance(0.5) { size } else { 0.0 };
    let damping = some(turns, 0.3 * mass * unit * unit);
    let stiffness = some(turns && says.more, 0.7 * mass * unit * unit);
    let friction = some(of_one, 0.1 * mass * unit);
    let rest = draw.uniform(-3.0, 3.0);
    let reach = if turns { 3.0 } else { unit };
    let limits = [-reach * draw.unit(), reach * (0.01 + 0.99 * draw.unit())];
    let axis = vector(draw, 1.0);
    Link {
        name: format!("link{k}"),
        parent,
        at,
        pieces,
        free,
        place: if says.more && of_one { vector(draw, unit) } else { Vector3::zeros() },
        axis: if axis.norm() < 0.01 { Vector3::y() } else { axis },
        stiffness,
        rest: if stiffness > 0.0 { rest } else { 0.0 },
        damping,
        friction,
        // URDF has no shift without limits.
        limits: (of_one && (draw.chance(0.5) || !says.more && !turns)).then_some(limits),
    }
}

fn piece(draw: &mut Draw, unit: f64, mass: f64, solid: bool) -> Piece {
    let (centre, turn) = (vector(draw, unit), turn(draw));
    let mut side = || unit * draw.log_uniform(0.1, 1.0);
    let (a, b, c) = (side(), side(), side());
    if solid {
        let solid = draw.one_of(&[
            Solid::Sphere(a),
            Solid::Box([a, b, c]),
            Solid::Ellipsoid([a, b, c]),
            Solid::Cylinder(a, b),
            Solid::Capsule(a, b),
            // As what lies between two ends is.
            Solid::Box([a, a, c]),
            Solid::Ellipsoid([a, a, c]),
        ]);
        let density = mass / (unit * unit * unit);
        let mass = density * volume(solid);
        let moments = per_mass(solid).map(|moment| mass * moment);
        return Piece { mass, centre, turn, moments, solid: Some((solid, density)) };
    }
    let mass = mass * draw.log_uniform(0.1, 10.0);
    // Second moments along the axes: some alike.
    let b = draw.one_of(&[a, b]);
    let [x, y, z] = [a, b, c].map(|side| mass * side * side);
    Piece { mass, centre, turn, moments: [y + z, z + x, x + y], solid: None }
}

fn volume(solid: Solid) -> f64 {
    match solid {
        Solid::Sphere(r) => 4.0 / 3.0 * PI * r * r * r,
        Solid::Box([a, b, c]) => 8.0 * a * b * c,
        Solid::Ellipsoid([a, b, c]) => 4.0 / 3.0 * PI * a * b * c,
        Solid::Cylinder(r, half) => 2.0 * PI * r * r * half,
        Solid::Capsule(r, half) => PI * r * r * (2.0 * half + 4.0 / 3.0 * r),
    }
}

/// Principal moments of a unit of mass.
fn per_mass(solid: Solid) -> [f64; 3] {
    let of = |x: f64, y: f64, z: f64| [y + z, z + x, x + y];
    match solid {
        Solid::Sphere(r) => [0.4 * r * r; 3],
        Solid::Box([a, b, c]) => of(a * a / 3.0, b * b / 3.0, c * c / 3.0),
        Solid::Ellipsoid([a, b, c]) => of(a * a / 5.0, b * b / 5.0, c * c / 5.0),
        Solid::Cylinder(r, half) => of(r * r / 4.0, r * r / 4.0, half * half / 3.0),
        Solid::Capsule(r, half) => {
            let ends = 4.0 / 3.0 * r / (2.0 * half + 4.0 / 3.0 * r);
            let tube = 1.0 - ends;
            // Half a ball has its centre 3/8 r from its base.
            let across = tube * r * r / 4.0 + ends * r * r / 5.0;
            let along =
                tube * half * half / 3.0 + ends * (r * r / 5.0 + half * half + 0.75 * half * r);
            of(across, across, along)
        }
    }
}

/// A body that the scene must have.
#[derive(Clone, Debug)]
pub(super) struct TrueBody {
    pub(super) name: String,
    pub(super) mass: f64,
    pub(super) centre: Vector3<f64>,
    pub(super) tensor: Matrix3<f64>,
    /// What its parts come to without their signs.
    pub(super) size: f64,
}

/// A joint that the scene must have; its ends are bodies, or the world.
#[derive(Clone, Debug)]
pub(super) struct TrueJoint {
    pub(super) of: usize,
    pub(super) between: [Option<String>; 2],
    pub(super) place: Vector3<f64>,
    pub(super) axis: Vector3<f64>,
}

impl Robot {
    /// Where the frame of a link is in the world.
    pub(super) fn frame(&self, link: usize) -> Isometry3<f64> {
        let own = self.links[link].at;
        self.links[link].parent.map_or(own, |parent| self.frame(parent) * own)
    }

    /// The link that a link is one body with; none of the world.
    fn owner(&self, link: usize) -> Option<usize> {
        match self.links[link].free {
            Free::Nothing => self.links[link].parent.and_then(|parent| self.owner(parent)),
            _ => Some(link),
        }
    }

    pub(super) fn bodies(&self) -> Vec<TrueBody> {
        let owners = (0..self.links.len()).filter(|&k| self.owner(k) == Some(k));
        owners.map(|owner| self.body(owner)).collect()
    }

    fn body(&self, owner: usize) -> TrueBody {
        let own = (0..self.links.len()).filter(|&k| self.owner(k) == Some(owner));
        let pieces: Vec<_> = own
            .flat_map(|k| self.links[k].pieces.iter().map(move |piece| (self.frame(k), piece)))
            .map(|(frame, piece)| {
                let turn = (frame.rotation * piece.turn).to_rotation_matrix();
                let own = turn.matrix() * Matrix3::from_diagonal(&piece.moments.into());
                (piece.mass, frame * nalgebra::Point3::from(piece.centre), own * turn.inverse())
            })
            .collect();
        let mass: f64 = pieces.iter().map(|piece| piece.0).sum();
        let centre =
            pieces.iter().map(|piece| piece.1.coords * piece.0).sum::<Vector3<f64>>() / mass;
        let (mut tensor, mut size) = (Matrix3::zeros(), 0.0);
        for (mass, at, own) in pieces {
            let d = at.coords - centre;
            tensor += own + (Matrix3::identity() * d.norm_squared() - d * d.transpose()) * mass;
            size += own.amax() + mass * d.norm_squared();
        }
        TrueBody { name: self.links[owner].name.clone(), mass, centre, tensor, size }
    }

    pub(super) fn joints(&self) -> Vec<TrueJoint> {
        let held = |k: &usize| !matches!(self.links[*k].free, Free::Nothing | Free::All);
        let name = |k: usize| self.links[k].name.clone();
        let joint = |k: usize| {
            let (link, frame) = (&self.links[k], self.frame(k));
            TrueJoint {
                of: k,
                between: [
                    link.parent.and_then(|parent| self.owner(parent)).map(name),
                    Some(name(k)),
                ],
                place: (frame * nalgebra::Point3::from(link.place)).coords,
                axis: frame.rotation * link.axis.normalize(),
            }
        };
        (0..self.links.len()).filter(held).map(joint).collect()
    }

    /// The largest coordinate of what it has.
    pub(super) fn size(&self) -> f64 {
        let places = (0..self.links.len()).map(|k| self.frame(k).translation.vector.amax());
        places.fold(self.unit, f64::max)
    }
}
