//! Bending of thin sheets: a spring at the fold between two triangles.
//!
//! ```text
//! theta = signed angle between the normals of (x0, x1, x2) and (x1, x0, x3)      radians
//! V = 1/2 k |e|^2/A (theta - theta_rest)^2          |e| edge, A both areas, at rest
//! ```
//! `x0 x1` the edge, `x2 x3` the corners on either side (m), counterclockwise seen from one side.
//! `k` a bending stiffness in joules: the plate's `B = E h^3/(12 (1 - nu^2))` where the sheet bends
//! along the sides of right triangles; bent askew, or on another mesh, the two differ by a factor
//! of order one.
//!
//! The angle is the signed one of atan2, of full accuracy folded or flat; it jumps at a full fold,
//! where the sheet would pass through itself. The gradient is the closed one of Bridson et al.
//! (2003); second derivatives are its exact derivatives by dual numbers. A flat triangle has no
//! normal: at rest it is refused, and where it becomes flat later the force is not finite, for the
//! step to report. Source: Grinspun et al., Discrete
//! Shells (2003).

use num_dual::Dual64;
use stationary_calculus::{
    Curvature, Number, Stencil, StencilHessian, array, project_semidefinite,
};
use stationary_mesh::Mesh;

use crate::ElasticityError;

/// A triangle whose angles' sines are below this is flat: its normal is rounding.
const FLAT: f64 = 1e-12;

/// A fold between two triangles: a [`Stencil`] of four vertices in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hinge {
    vertices: [usize; 4],
    stiffness: f64,
    rest: f64,
}

impl Hinge {
    /// A hinge of stiffness k, joules, at rest where the vertices are. `vertices` are the ends of
    /// the edge, then the corner on its left and the one on its right; `x` their places.
    ///
    /// # Errors
    /// [`ElasticityError::Bending`], and [`ElasticityError::FlatHinge`] for a triangle whose angles'
    /// sines are below 1e-12, for a vertex that is named twice, and for places that are not finite or
    /// whose powers in a second derivative are not.
    pub fn new(
        vertices: [usize; 4],
        x: &[[f64; 3]; 4],
        stiffness: f64,
    ) -> Result<Self, ElasticityError> {
        if !(stiffness > 0.0 && stiffness.is_finite()) {
            return Err(ElasticityError::Bending(stiffness));
        }
        let repeated = (0..4).any(|a| vertices[..a].contains(&vertices[a]));
        if repeated || !x.as_flattened().iter().all(|x| x.is_finite()) {
            return Err(ElasticityError::FlatHinge { vertices });
        }
        let fold = Fold::of(x);
        let is_flat = |corner: usize, square: f64| {
            let side = |end: usize| {
                let apart = minus(&x[corner], &x[end]);
                dot(&apart, &apart)
            };
            // Twice the area over the product of two sides: the sine of an angle.
            let longest = fold.edge * fold.edge * side(0).max(side(1));
            square.is_nan() || square <= FLAT * FLAT * longest
        };
        if is_flat(2, fold.left.1) || is_flat(3, fold.right.1) {
            return Err(ElasticityError::FlatHinge { vertices });
        }
        let area = 0.5 * (fold.left.1.sqrt() + fold.right.1.sqrt());
        let (stiffness, rest) = (stiffness * fold.edge * fold.edge / area, fold.angle());
        if !rest.is_finite() {
            return Err(ElasticityError::FlatHinge { vertices });
        }
        // A stiffness whose forces and curvatures leave the range of numbers.
        let steepest = fold.gradient().as_flattened().iter().fold(1.0, |m: f64, x| m.max(x.abs()));
        if !(stiffness > 0.0 && (1e3 * stiffness * steepest * steepest).is_finite()) {
            return Err(ElasticityError::Bending(stiffness));
        }
        let hinge = Hinge { vertices, stiffness, rest };
        let hessian = hinge.hessian(x, Curvature::Exact);
        match hessian.as_flattened().as_flattened().as_flattened().iter().all(|x| x.is_finite()) {
            true => Ok(hinge),
            false => Err(ElasticityError::FlatHinge { vertices }),
        }
    }

    /// The same hinge with another angle at rest, radians: a crease.
    ///
    /// # Errors
    /// [`ElasticityError::Angle`] where it is not finite.
    pub fn resting_at(self, angle: f64) -> Result<Self, ElasticityError> {
        match angle.is_finite() {
            true => Ok(Hinge { rest: angle, ..self }),
            false => Err(ElasticityError::Angle(angle)),
        }
    }

    /// The angle of the fold, radians: zero where the sheet is flat.
    pub fn angle(x: &[[f64; 3]; 4]) -> f64 {
        Fold::of(x).angle()
    }
}

/// A hinge at every inner edge of a sheet, at rest as the sheet is.
///
/// # Errors
/// [`ElasticityError::Mesh`] for a sheet with an edge of more than two triangles; those of
/// [`Hinge::new`].
pub fn hinges(sheet: &Mesh<3, 3>, stiffness: f64) -> Result<Vec<Hinge>, ElasticityError> {
    let neighbours = sheet.neighbours()?;
    let place = |vertex: usize| -> [f64; 3] { sheet.vertices()[vertex].into() };
    let mut hinges = Vec::new();
    for (triangle, corners) in sheet.simplices().iter().enumerate() {
        for opposite in 0..3 {
            let Some(other) = neighbours[triangle][opposite].filter(|&other| other > triangle)
            else {
                continue;
            };
            let [a, b] = [corners[(opposite + 1) % 3], corners[(opposite + 2) % 3]];
            let across = sheet.simplices()[other].into_iter().find(|&v| v != a && v != b);
            let Some(across) = across else { continue };
            let vertices = [a, b, corners[opposite], across];
            hinges.push(Hinge::new(vertices, &vertices.map(place), stiffness)?);
        }
    }
    Ok(hinges)
}

/// Two triangles at an edge.
struct Fold<R> {
    /// The edge's length.
    edge: R,
    /// The normals, twice the area long, with their squares.
    left: ([R; 3], R),
    right: ([R; 3], R),
    /// Along the edge: from its first end to the corners' feet, as parts of the edge.
    feet: [R; 2],
    direction: [R; 3],
}

fn minus<R: Number>(a: &[R; 3], b: &[R; 3]) -> [R; 3] {
    array(|i| a[i] - b[i])
}

fn dot<R: Number>(a: &[R; 3], b: &[R; 3]) -> R {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross<R: Number>(a: &[R; 3], b: &[R; 3]) -> [R; 3] {
    array(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}

impl<R: Number> Fold<R> {
    fn of([x0, x1, x2, x3]: &[[R; 3]; 4]) -> Self {
        let (e, l, r) = (minus(x1, x0), minus(x2, x0), minus(x3, x0));
        let (left, right) = (cross(&e, &l), cross(&r, &e));
        let square = dot(&e, &e);
        Fold {
            edge: square.sqrt(),
            left: (left, dot(&left, &left)),
            right: (right, dot(&right, &right)),
            feet: [dot(&l, &e) / square, dot(&r, &e) / square],
            direction: e,
        }
    }

    fn angle(&self) -> R {
        let sine = dot(&cross(&self.left.0, &self.right.0), &self.direction) / self.edge;
        sine.atan2(dot(&self.left.0, &self.right.0))
    }

    /// The gradient of the angle: a corner turns the fold by one over its height.
    fn gradient(&self) -> [[R; 3]; 4] {
        let of_left = self.left.0.map(|n| -n * self.edge / self.left.1);
        let of_right = self.right.0.map(|n| -n * self.edge / self.right.1);
        let [s, t] = self.feet;
        let one = R::from(1.0);
        let end = |a: R, b: R| array(|i| -(of_left[i] * a) - of_right[i] * b);
        [end(one - s, one - t), end(s, t), of_left, of_right]
    }
}

impl Stencil<4, 3> for Hinge {
    fn vertices(&self) -> [usize; 4] {
        self.vertices
    }

    fn energy(&self, x: &[[f64; 3]; 4]) -> f64 {
        let bent = Fold::of(x).angle() - self.rest;
        0.5 * self.stiffness * bent * bent
    }

    fn differential(&self, x: &[[f64; 3]; 4]) -> [[f64; 3]; 4] {
        let fold = Fold::of(x);
        let torque = self.stiffness * (fold.angle() - self.rest);
        fold.gradient().map(|corner| corner.map(|slope| torque * slope))
    }

    fn hessian(&self, x: &[[f64; 3]; 4], curvature: Curvature) -> StencilHessian<4, 3> {
        let fold = Fold::of(x);
        let (gradient, torque) = (fold.gradient(), self.stiffness * (fold.angle() - self.rest));
        let dual = x.map(|corner| corner.map(Dual64::from_re));
        let mut hessian: StencilHessian<4, 3> = [[[[0.0; 3]; 4]; 3]; 4];
        for b in 0..4 {
            for d in 0..3 {
                let mut x = dual;
                x[b][d].eps = 1.0;
                let change = Fold::of(&x).gradient();
                for a in 0..=b {
                    for c in 0..if a == b { d + 1 } else { 3 } {
                        let entry = self.stiffness * gradient[a][c] * gradient[b][d]
                            + torque * change[a][c].eps;
                        hessian[b][d][a][c] = entry;
                        hessian[a][c][b][d] = entry;
                    }
                }
            }
        }
        match curvature {
            Curvature::Exact => hessian,
            Curvature::Semidefinite => project_semidefinite(&hessian),
        }
    }
}
