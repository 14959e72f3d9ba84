//! Shapes of bodies as they are drawn: points in body axes, triangles between them, and lines that show how
//! a body turns.
//!
//! ```text
//! (r cos a, r sin a, z),   a = 2 pi k / N           what is round about an axis, ring after ring
//! ```
//! A ring without a radius is one point. A drawing alone: what touches is round.

use stationary_calculus::array;
use std::f64::consts::{PI, TAU};

use nalgebra::Vector3;

use crate::model::body_shape::{BodyPart, BodyShape};
use crate::model::particle::Motion;
use crate::model::turned::turn;
use crate::run::fields::BodyField;
use crate::run::samples::Run;
use crate::show::drawing::{convex as turns_one_way, sides};

/// Corners of what is round, and rings of half a ball.
const AROUND: usize = 32;
const RINGS: usize = 8;

/// A shape as it is drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct BodySurface {
    pub(crate) points: Vec<[f64; 3]>,
    pub(crate) triangles: Vec<[usize; 3]>,
    pub(crate) lines: Vec<[usize; 2]>,
}

/// A circle about the third axis: its radius, its height, and whether the surface has an edge there.
struct Ring(f64, f64, bool);

impl BodySurface {
    /// What a body is drawn by where its points do not show it: every part of it, none of boxes, polygons
    /// and hulls, whose corners are among the body's points, and of balls.
    pub(crate) fn of(shape: &BodyShape, dimension: usize) -> Vec<Self> {
        match shape {
            BodyShape::Parts(parts) => parts.iter().map(|part| of_part(part, dimension)).collect(),
            BodyShape::Capsule { .. }
            | BodyShape::Cylinder { .. }
            | BodyShape::Cone { .. }
            | BodyShape::Ellipsoid(_) => vec![convex(shape, dimension)],
            _ => Vec::new(),
        }
    }

    /// All of them as one.
    pub(crate) fn joined(surfaces: Vec<Self>) -> Self {
        let mut all = BodySurface::default();
        for BodySurface { points, triangles, lines } in surfaces {
            let before = all.points.len();
            all.points.extend(points);
            all.triangles.extend(triangles.into_iter().map(|t| t.map(|k| before + k)));
            all.lines.extend(lines.into_iter().map(|ends| ends.map(|k| before + k)));
        }
        all
    }

    /// The corners of a plate in their order, without its middle.
    pub(crate) fn rim(&self) -> &[[f64; 3]] {
        self.points.split_last().map_or(&[], |(_, rim)| rim)
    }

    /// The farthest that it reaches.
    pub(crate) fn reach(&self) -> f64 {
        self.points.iter().map(|&p| Vector3::from(p).norm()).fold(0.0, f64::max)
    }
}

impl BodyField {
    /// A vector of the body's axes in the world's.
    pub(crate) fn turned(&self, vector: [f64; 3]) -> [f64; 3] {
        turn(self.orientation, vector)
    }
}

impl Run {
    /// The surfaces of bodies that no points of theirs show, each with its body and the particle at the
    /// body's centre.
    pub(crate) fn surfaces(&self) -> impl Iterator<Item = (usize, usize, Vec<BodySurface>)> + '_ {
        let centres = self.scene.particles.iter().enumerate();
        let of_body = |(particle, of): (usize, &crate::Particle)| match of.motion {
            Motion::Carried { body, point: [0.0, 0.0, 0.0] } => Some((body, particle)),
            _ => None,
        };
        let mut seen = vec![false; self.scene.bodies.len()];
        centres.filter_map(of_body).filter_map(move |(body, particle)| {
            // The centre comes before points that are there too.
            if std::mem::replace(&mut seen[body], true) {
                return None;
            }
            let shape = &self.scene.bodies[body].shape;
            let surfaces = BodySurface::of(shape, self.scene.dimension);
            (!surfaces.is_empty()).then_some((body, particle, surfaces))
        })
    }

    /// A point of a body at a sample.
    pub(crate) fn placed(
        &self,
        sample: usize,
        centre: usize,
        field: &BodyField,
        point: [f64; 3],
    ) -> [f64; 3] {
        let (x, arm) = (self.position(sample, centre), field.turned(point));
        array(|c| x[c] + arm[c])
    }
}

fn of_part(part: &BodyPart, dimension: usize) -> BodySurface {
    let axis_angle = Vector3::from(part.rotation);
    let half = 0.5 * axis_angle.norm();
    let imaginary = axis_angle * if half > 0.0 { half.sin() / (2.0 * half) } else { 0.5 };
    let quaternion = [half.cos(), imaginary.x, imaginary.y, imaginary.z];
    let mut surface = convex(&part.shape, dimension);
    for point in &mut surface.points {
        let turned = turn(quaternion, *point);
        *point = array(|c| part.position[c] + turned[c]);
    }
    surface
}

/// One shape about its own centre.
fn convex(shape: &BodyShape, dimension: usize) -> BodySurface {
    match (shape, dimension) {
        (BodyShape::Ball(radius), 2) => outline(&stadium(0.0, *radius), Some(AROUND / 4)),
        (BodyShape::Capsule { length, radius }, 2) => {
            outline(&stadium(0.5 * length, *radius), Some(AROUND / 4))
        }
        (BodyShape::Box(_), 2) => {
            let corners = shape.corners(2);
            outline(&sides(2)[0].map(|corner| corners[corner]), None)
        }
        (BodyShape::Polygon(_), _) => outline(&shape.corners(2), None),
        (BodyShape::Ball(radius), _) => ellipsoid([*radius; 3]),
        (BodyShape::Ellipsoid(half_axes), _) => ellipsoid(*half_axes),
        (BodyShape::Capsule { length, radius }, _) => capsule(0.5 * length, *radius),
        (BodyShape::Cylinder { length, radius }, _) => {
            let (a, r) = (0.5 * length, *radius);
            let rings =
                [Ring(0.0, -a, false), Ring(r, -a, true), Ring(r, a, true), Ring(0.0, a, false)];
            revolved(&rings)
        }
        (BodyShape::Cone { height, radius }, _) => {
            let (base, apex) = (-0.25 * height, 0.75 * height);
            let rings = [Ring(0.0, base, false), Ring(*radius, base, true), Ring(0.0, apex, false)];
            revolved(&rings)
        }
        (BodyShape::Box(_), _) => {
            let quads = sides(3);
            let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
            BodySurface {
                points: shape.corners(3),
                triangles: triangles.collect(),
                lines: shape.edges(3),
            }
        }
        (BodyShape::Hull { corners, triangles }, _) => BodySurface {
            points: corners.clone(),
            triangles: triangles.clone(),
            lines: shape.edges(3),
        },
        (BodyShape::Moments | BodyShape::Parts(_), _) => BodySurface::default(),
    }
}

/// A disc, or two half discs and the strip between, counterclockwise from the lowest point on the right.
fn stadium(half: f64, radius: f64) -> Vec<[f64; 3]> {
    let at = |k: usize, middle: f64| {
        let (sin, cos) = (TAU * k as f64 / AROUND as f64 - 0.5 * PI).sin_cos();
        [middle + radius * cos, radius * sin, 0.0]
    };
    let right = (0..=AROUND / 2).map(|k| at(k, half));
    right.chain((AROUND / 2..=AROUND).map(|k| at(k, -half))).collect()
}

/// A plate by its corners, and last its middle, from which a line leads to this corner.
fn outline(corners: &[[f64; 3]], mark: Option<usize>) -> BodySurface {
    let count = corners.len();
    let rim = (0..count).map(|k| [k, (k + 1) % count]);
    let fan = if turns_one_way(corners) { 2..count } else { 0..0 };
    BodySurface {
        points: corners.iter().copied().chain([[0.0; 3]]).collect(),
        triangles: fan.map(|k| [0, k - 1, k]).collect(),
        lines: rim.chain(mark.map(|corner| [count, corner])).collect(),
    }
}

fn capsule(half: f64, radius: f64) -> BodySurface {
    let cap = |k: usize| (0.5 * PI * k as f64 / RINGS as f64).sin_cos();
    let lower = (0..=RINGS).map(|k| {
        let (sin, cos) = cap(k);
        Ring(radius * sin, -half - radius * cos, k == RINGS)
    });
    let upper = (0..=RINGS).map(|k| {
        let (sin, cos) = cap(k);
        Ring(radius * cos, half + radius * sin, k == 0)
    });
    revolved(&lower.chain(upper).collect::<Vec<_>>())
}

fn ellipsoid(half_axes: [f64; 3]) -> BodySurface {
    let rings = (0..=2 * RINGS).map(|k| {
        let (sin, cos) = (0.5 * PI * k as f64 / RINGS as f64).sin_cos();
        Ring(sin, -cos, k == RINGS)
    });
    let mut surface = revolved(&rings.collect::<Vec<_>>());
    for point in &mut surface.points {
        (0..3).for_each(|c| point[c] *= half_axes[c]);
    }
    surface
}

/// A radius below this is that of a point.
const POINT: f64 = 1e-12;

/// What rings bound, from the lowest to the highest; drawn with its edges and four lines along it.
fn revolved(rings: &[Ring]) -> BodySurface {
    let mut surface = BodySurface::default();
    let mut before: Option<(usize, usize)> = None;
    let largest = rings.iter().map(|ring| ring.0).fold(0.0, f64::max);
    for &Ring(radius, height, edge) in rings {
        let first = surface.points.len();
        let count = if radius > POINT * largest { AROUND } else { 1 };
        surface.points.extend((0..count).map(|k| {
            let (sin, cos) = (TAU * k as f64 / AROUND as f64).sin_cos();
            if count == 1 { [0.0, 0.0, height] } else { [radius * cos, radius * sin, height] }
        }));
        if edge {
            surface.lines.extend((0..count).map(|k| [first + k, first + (k + 1) % count]));
        }
        if let Some((lower, of_lower)) = before {
            let below = |k: usize| lower + k % of_lower;
            let above = |k: usize| first + k % count;
            for k in 0..AROUND {
                let (next, lower_side, upper_side) = (k + 1, of_lower > 1, count > 1);
                if lower_side {
                    surface.triangles.push([below(k), below(next), above(k)]);
                }
                if upper_side {
                    surface.triangles.push([below(next), above(next), above(k)]);
                }
            }
            let quarters = (0..AROUND).step_by(AROUND / 4);
            surface.lines.extend(quarters.map(|k| [below(k), above(k)]));
        }
        before = Some((first, count));
    }
    surface
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Its volume, by the tetrahedra that its triangles span with the origin.
    fn volume(surface: &BodySurface) -> f64 {
        let tetrahedron = |t: &[usize; 3]| {
            let [a, b, c] = t.map(|k| Vector3::from(surface.points[k]));
            a.dot(&b.cross(&c)) / 6.0
        };
        surface.triangles.iter().map(tetrahedron).sum()
    }

    #[test]
    fn surfaces_enclose_the_volume_of_their_shapes_and_face_outward() {
        let (length, radius, height) = (1.4, 0.3, 0.9);
        let tube = PI * radius * radius;
        let shapes = [
            (BodyShape::Cylinder { length, radius }, tube * length),
            (BodyShape::Cone { height, radius }, tube * height / 3.0),
            (BodyShape::Capsule { length, radius }, tube * (length + 4.0 / 3.0 * radius)),
            (BodyShape::Ellipsoid([0.3, 0.5, 0.7]), 4.0 / 3.0 * PI * 0.3 * 0.5 * 0.7),
        ];
        for (shape, expected) in shapes {
            let [surface] = &BodySurface::of(&shape, 3)[..] else { panic!("one surface") };
            let found = volume(surface);
            assert!(found < expected && found > 0.97 * expected, "{shape:?}: {found} {expected}");
            let position = [5.0, 0.0, 0.0];
            let part = BodyPart { shape, position, rotation: [0.3, -0.2, 0.9] };
            let moved = volume(&of_part(&part, 3));
            assert!((moved / found - 1.0).abs() < 1e-12, "{moved} {found}");
        }
    }
}
