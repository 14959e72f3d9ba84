//! A closed surface and the solid within: its moments, and what may be wrong with it.
//!
//! ```text
//! m = 1/6 sum d     f = 1/24 sum d s     C = 1/120 sum d (a a^T + b b^T + c c^T + s s^T)
//! d = a.(b x c),  s = a + b + c        w(p) = 1/4pi sum of the solid angles seen from p
//! ```
//! `a b c` the corners of a triangle (m) seen from the middle of its component, counterclockwise
//! from outside. A component inside an odd number of others bounds a cavity and must face inward,
//! the others outward; the winding number `w` of a closed surface is 0 outside and +-1 inside. A
//! surface is taken if it is closed, a manifold, oriented outward, without flat triangles or
//! components that enclose nothing, and if no edge is found to pass through a triangle. Source:
//! notes 7.1, 9.4; Van Oosterom and Strackee 1983 (the angle).

use std::f64::consts::PI;

use nalgebra::Vector3;

use crate::components::Components;
use crate::mesh::Mesh;
use crate::moments::{Moments, middle};
use crate::overlap::overlaps;
use crate::polygon::cone_moments;
use crate::{MeshError, Places};

/// The surface of a solid: closed, oriented outward, with cavities oriented into them.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedSurface {
    mesh: Mesh<3, 3>,
    moments: Moments<3>,
}

impl ClosedSurface {
    /// A surface as it is, refused if anything is wrong with it.
    ///
    /// # Errors
    /// [`MeshError::Empty`], [`MeshError::Open`], [`MeshError::NonManifold`],
    /// [`MeshError::Pinched`], [`MeshError::Degenerate`], [`MeshError::Inconsistent`],
    /// [`MeshError::NothingEnclosed`], [`MeshError::Overlapping`] and [`MeshError::InsideOut`].
    pub fn new(mesh: Mesh<3, 3>) -> Result<Self, MeshError> {
        check_shape(&mesh)?;
        mesh.check_oriented()?;
        let bodies = Bodies::of(&mesh)?;
        Places::refuse(bodies.inside_out(), MeshError::InsideOut)?;
        Ok(bodies.surface(mesh))
    }

    /// A surface with its triangles turned over where that makes it right.
    ///
    /// # Errors
    /// Those of [`ClosedSurface::new`], but [`MeshError::NotOrientable`] in place of
    /// [`MeshError::Inconsistent`] and [`MeshError::InsideOut`].
    pub fn oriented(mesh: &Mesh<3, 3>) -> Result<Self, MeshError> {
        check_shape(mesh)?;
        let mesh = mesh.oriented()?;
        let wrong = Bodies::of(&mesh)?.inside_out();
        let components = mesh.components();
        let turned =
            mesh.simplices().iter().zip(&components.of_simplices).map(|(&[a, b, c], &k)| {
                let turn = wrong.contains(&components.first_simplices[k]);
                if turn { [b, a, c] } else { [a, b, c] }
            });
        let mesh = Mesh::known(mesh.vertices().to_vec(), turned.collect());
        Ok(Bodies::of(&mesh)?.surface(mesh))
    }

    /// The surface.
    pub fn mesh(&self) -> &Mesh<3, 3> {
        &self.mesh
    }

    /// Volume, first and second moments of the solid within, about the middle of the first
    /// component.
    pub fn moments(&self) -> Moments<3> {
        self.moments
    }

    /// How often the surface goes around a point: 1 within the solid, 0 outside and in cavities, in
    /// between on the surface itself; NaN for a point with a coordinate that is not a number.
    pub fn winding_number(&self, point: &Vector3<f64>) -> f64 {
        // Beside the box, however far, squares of distances need not stay in range.
        let beside = |c: usize| {
            let own = || self.mesh.vertices().iter().map(|x| x[c]);
            own().all(|x| x < point[c]) || own().all(|x| x > point[c])
        };
        if !point.iter().any(|x| x.is_nan()) && (0..3).any(beside) {
            return 0.0;
        }
        winding_number(self.mesh.simplices().iter().map(|t| self.mesh.corners(t)), point)
    }
}

fn check_shape(mesh: &Mesh<3, 3>) -> Result<(), MeshError> {
    if mesh.simplices().is_empty() {
        return Err(MeshError::Empty);
    }
    mesh.check_manifold()?;
    mesh.check_closed()?;
    mesh.check_nondegenerate()?;
    Places::refuse(overlaps(mesh), MeshError::Overlapping)
}

/// A component's triangles, its moments, and a box around it.
struct Body {
    triangles: Vec<[Vector3<f64>; 3]>,
    moments: Moments<3>,
    low: Vector3<f64>,
    high: Vector3<f64>,
}

/// The components of a closed surface.
struct Bodies {
    components: Components,
    bodies: Vec<Body>,
}

/// Volumes below this part of the extent's cube are rounding.
const FLAT: f64 = 1e-14;

impl Bodies {
    fn of(mesh: &Mesh<3, 3>) -> Result<Self, MeshError> {
        let components = mesh.components();
        let mut triangles = vec![Vec::new(); components.first_simplices.len()];
        for (simplex, &component) in mesh.simplices().iter().zip(&components.of_simplices) {
            triangles[component].push(mesh.corners(simplex));
        }
        let bodies: Vec<Body> = triangles.into_iter().map(Body::of).collect();
        let named = components.first_simplices.iter().zip(&bodies);
        let empty = named.filter(|(_, body)| body.is_flat()).map(|(&first, _)| first);
        Places::refuse(empty.collect(), MeshError::NothingEnclosed)?;
        Ok(Bodies { components, bodies })
    }

    /// The first simplices of the components that face the wrong way.
    fn inside_out(&self) -> Vec<usize> {
        let wrong = |k: &usize| {
            let within = self.bodies.iter().enumerate().filter(|(other, body)| {
                other != k && body.goes_around(&self.bodies[*k].triangles[0][0])
            });
            (self.bodies[*k].moments.measure > 0.0) != (within.count() % 2 == 0)
        };
        let wrong = (0..self.bodies.len()).filter(wrong);
        wrong.map(|k| self.components.first_simplices[k]).collect()
    }

    fn surface(self, mesh: Mesh<3, 3>) -> ClosedSurface {
        let start = Moments::zero(self.bodies[0].moments.about);
        let moments = self.bodies.iter().fold(start, |sum, body| sum.with(&body.moments));
        ClosedSurface { mesh, moments }
    }
}

impl Body {
    fn of(triangles: Vec<[Vector3<f64>; 3]>) -> Self {
        let corners = || triangles.iter().flatten().copied();
        let about = middle(corners()).unwrap_or_else(Vector3::zeros);
        let (low, high) = corners().fold((about, about), |(l, h), c| (l.inf(&c), h.sup(&c)));
        let moments = cone_moments(about, triangles.iter().copied());
        Body { triangles, moments, low, high }
    }

    fn is_flat(&self) -> bool {
        let extent = (self.high - self.low).amax();
        self.moments.measure.abs() <= FLAT * extent.powi(3)
    }

    fn goes_around(&self, point: &Vector3<f64>) -> bool {
        let in_box = (0..3).all(|c| self.low[c] <= point[c] && point[c] <= self.high[c]);
        in_box && winding_number(self.triangles.iter().copied(), point).abs() > 0.5
    }
}

fn winding_number(triangles: impl Iterator<Item = [Vector3<f64>; 3]>, point: &Vector3<f64>) -> f64 {
    triangles.map(|corners| solid_angle(corners.map(|c| c - point))).sum::<f64>() / (4.0 * PI)
}

/// The angle under which a triangle is seen from the origin, positive from behind.
fn solid_angle([a, b, c]: [Vector3<f64>; 3]) -> f64 {
    let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
    let across = a.dot(&b.cross(&c));
    let along = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
    2.0 * across.atan2(along)
}

#[cfg(test)]
#[path = "enclosed_tests.rs"]
mod tests;
