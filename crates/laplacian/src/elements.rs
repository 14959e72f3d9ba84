//! Dirichlet energy of functions that are linear on each simplex.
//!
//! ```text
//! V(f) = 1/2 int |grad f|^2 = 1/2 sum_s f_s^T W_s f_s
//! segment       W_01 = -1/l
//! triangle      W_ij = e_i.e_j / 4A = -1/2 cot(angle at k)         e_i the edge opposite to i
//! tetrahedron   W_ij = n_i.n_j / 9V                             n_i the area vector opposite to i
//! ```
//! `f` one number a vertex, `l A V` length, area, volume. Rows sum to zero by construction, so
//! that constants cost nothing. Weights of embedded simplices come from edge vectors: the area of
//! a sliver is a cross product and keeps its digits. Those of an [`IntrinsicSurface`] come from
//! lengths alone, by Kahan's formula: a flat obtuse triangle of area below 1e-8 of its edges'
//! square has nothing left of it in its lengths. Source: notes 15.1, 15.3; Pinkall and Polthier
//! 1993.

use nalgebra::{SVector, Vector3};
use stationary_calculus::{Curvature, Stencil, StencilHessian, array};
use stationary_mesh::{IntrinsicSurface, Mesh, MeshError, Places, Simplex};

use crate::LaplacianError;
use crate::error::positive;

/// A simplex and the energy of linear functions on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Element<const K: usize> {
    pub(crate) vertices: [usize; K],
    pub(crate) weights: [[f64; K]; K],
    pub(crate) measure: f64,
}

impl<const K: usize> Element<K> {
    /// An element with these weights off the diagonal.
    #[inline(always)]
    fn new(vertices: [usize; K], measure: f64, weight: impl Fn(usize, usize) -> f64) -> Self {
        let mut weights = [[0.0; K]; K];
        for j in 1..K {
            for i in 0..j {
                let w = weight(i, j);
                (weights[i][j], weights[j][i]) = (w, w);
                weights[i][i] -= w;
                weights[j][j] -= w;
            }
        }
        Element { vertices, weights, measure }
    }

    /// The numbers of its vertices.
    pub fn corners(&self) -> [usize; K] {
        self.vertices
    }

    /// Its length, area or volume.
    pub fn measure(&self) -> f64 {
        self.measure
    }

    /// The matrix `W_s`.
    pub fn weights(&self) -> &[[f64; K]; K] {
        &self.weights
    }
}

impl<const K: usize> Stencil<K, 1> for Element<K> {
    fn vertices(&self) -> [usize; K] {
        self.vertices
    }

    fn energy(&self, f: &[[f64; 1]; K]) -> f64 {
        // Differences first: the energy of a constant is zero, not rounding.
        let pairs = (0..K).flat_map(|j| (0..j).map(move |i| (i, j)));
        pairs.map(|(i, j)| -0.5 * self.weights[i][j] * (f[i][0] - f[j][0]).powi(2)).sum()
    }

    fn differential(&self, f: &[[f64; 1]; K]) -> [[f64; 1]; K] {
        let row = |i: usize| {
            let others = (0..K).filter(|&j| j != i);
            others.map(|j| self.weights[i][j] * (f[j][0] - f[i][0])).sum()
        };
        array(|i| [row(i)])
    }

    fn hessian(&self, _: &[[f64; 1]; K], _: Curvature) -> StencilHessian<K, 1> {
        array(|i| [self.weights[i].map(|w| [w])])
    }
}

/// The elements of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Elements<const K: usize> {
    pub(crate) vertices: usize,
    pub(crate) elements: Vec<Element<K>>,
}

impl<const K: usize> Elements<K>
where
    [usize; K]: Simplex,
{
    /// The elements of a mesh of segments, triangles or tetrahedra. The energy is a sum over them:
    /// any number may meet at a face or touch at a vertex. A vertex that none of them names has no
    /// freedom in a [`crate::Domain`].
    ///
    /// # Errors
    /// [`MeshError::Empty`], and [`MeshError::Degenerate`] for simplices without size.
    pub fn of<const D: usize>(mesh: &Mesh<D, K>) -> Result<Self, LaplacianError> {
        if mesh.simplices().is_empty() {
            return Err(MeshError::Empty.into());
        }
        mesh.check_nondegenerate()?;
        let numbered = mesh.simplices().iter().zip(mesh.measures());
        let element = |(simplex, measure): (&[usize; K], f64)| {
            let (corners, size) = (mesh.corners(simplex), measure.abs());
            let corners: [_; K] = array(|k| in_space(&corners[k]));
            Element::new(*simplex, size, |i, j| weight(&corners, size, i, j))
        };
        Ok(Elements { vertices: mesh.vertices().len(), elements: numbered.map(element).collect() })
    }
}

impl Elements<3> {
    /// The elements of a surface that is known by its edge lengths.
    ///
    /// # Errors
    /// [`MeshError::Empty`], and [`MeshError::Degenerate`] for triangles whose lengths leave no area
    /// (mollify the surface, or flip its edges).
    pub fn of_surface(surface: &IntrinsicSurface) -> Result<Self, LaplacianError> {
        let (mut elements, mut flat) = (Vec::new(), Vec::new());
        for (triangle, &vertices) in surface.triangles().iter().enumerate() {
            let shape = surface.shape(triangle);
            let (area, cotangents) = (shape.area(), shape.cotangents());
            if cotangents.iter().any(|c| !c.is_finite()) {
                flat.push(triangle);
            }
            elements.push(Element::new(vertices, area, |i, j| -0.5 * cotangents[3 - i - j]));
        }
        if elements.is_empty() {
            return Err(MeshError::Empty.into());
        }
        if !flat.is_empty() {
            return Err(MeshError::Degenerate(Places(flat)).into());
        }
        Ok(Elements { vertices: surface.vertices(), elements })
    }
}

impl<const K: usize> Elements<K> {
    /// The same elements with an energy that is this many times as large: conductivity, or the
    /// square of a wave's speed.
    ///
    /// # Errors
    /// [`LaplacianError::Parameter`].
    pub fn scaled(mut self, coefficient: f64) -> Result<Self, LaplacianError> {
        positive("the coefficient", coefficient)?;
        for element in &mut self.elements {
            element.weights.as_flattened_mut().iter_mut().for_each(|w| *w *= coefficient);
        }
        Ok(self)
    }

    /// How many vertices there are.
    pub fn vertices(&self) -> usize {
        self.vertices
    }

    /// The elements.
    pub fn elements(&self) -> &[Element<K>] {
        &self.elements
    }

    /// Vertices that no element names.
    pub(crate) fn unnamed(&self) -> Vec<usize> {
        let mut named = vec![false; self.vertices];
        self.elements.iter().flat_map(|e| e.vertices).for_each(|vertex| named[vertex] = true);
        (0..self.vertices).filter(|&vertex| !named[vertex]).collect()
    }

    /// Length, area or volume of the whole.
    pub fn measure(&self) -> f64 {
        self.elements.iter().map(|element| element.measure).sum()
    }
}

#[inline]
fn in_space<const D: usize>(x: &SVector<f64, D>) -> Vector3<f64> {
    Vector3::from_fn(|c, _| if c < D { x[c] } else { 0.0 })
}

/// The entry `W_ij` of a simplex, i not j.
#[inline(always)]
fn weight<const K: usize>(corners: &[Vector3<f64>; K], size: f64, i: usize, j: usize) -> f64 {
    if K == 2 {
        return -1.0 / size;
    }
    if K == 3 {
        let k = corners[3 - i - j];
        return -(corners[i] - k).dot(&(corners[j] - k)) / (4.0 * size);
    }
    // Both faces contain the edge kl; seen along it, this is the cotangent of the angle between.
    let [k, l] = [0, 1].map(|place| {
        let mut others = (0..K).filter(|&other| other != i && other != j);
        others.nth(place).map_or(corners[0], |other| corners[other])
    });
    let along = l - k;
    let (u, v) = (along.cross(&(corners[i] - k)), along.cross(&(corners[j] - k)));
    -u.dot(&v) / (36.0 * size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Domain;
    use nalgebra::{Rotation3, Vector2};
    use stationary_mesh::{Diagonals, ball, bar, cuboid, icosphere, rectangle};

    /// The energy of a function of place.
    fn energy<const D: usize, const K: usize>(
        mesh: &Mesh<D, K>,
        f: impl Fn(&SVector<f64, D>) -> f64,
    ) -> f64
    where
        [usize; K]: Simplex,
    {
        let values: Vec<f64> = mesh.vertices().iter().map(f).collect();
        let elements = Elements::of(mesh).unwrap();
        elements.elements().iter().map(|e| e.energy(&e.vertices.map(|v| [values[v]]))).sum()
    }

    #[test]
    fn linear_functions_have_half_the_square_of_their_slope_times_the_size() {
        let line = bar(3.0, 7).unwrap().mapped(|x| Vector3::new(x.x, 2.0 * x.x, 0.0)).unwrap();
        assert!((energy(&line, |x| x.y) - 0.5 * 0.8 * 3.0 * 5.0_f64.sqrt()).abs() < 1e-13);
        let plate = rectangle([2.0, 1.0], [3, 4], Diagonals::Alternating).unwrap();
        assert!((energy(&plate, |x| 3.0 * x.x - x.y) - 0.5 * 10.0 * 2.0).abs() < 1e-13);
        let solid = ball(1.0, 2).unwrap();
        let slope = Vector3::new(1.0, -2.0, 0.5);
        let exact = 0.5 * slope.norm_squared() * solid.measure();
        assert!((energy(&solid, |x| slope.dot(x)) - exact).abs() < 1e-12);
    }

    #[test]
    fn turning_a_mesh_over_or_around_changes_nothing() {
        let turn = Rotation3::new(Vector3::new(0.3, -1.0, 2.0));
        let mesh = cuboid([1.0, 2.0, 1.5], [2, 2, 2]).unwrap();
        let here = Elements::of(&mesh).unwrap();
        let there = Elements::of(&mesh.mapped(|x| turn * x).unwrap()).unwrap();
        for (a, b) in here.elements().iter().zip(there.elements()) {
            let pairs = a.weights.as_flattened().iter().zip(b.weights.as_flattened());
            assert!(pairs.into_iter().all(|(x, y)| (x - y).abs() < 1e-14));
        }
        assert!((Elements::of(&mesh.reversed()).unwrap().measure() - here.measure()).abs() < 1e-14);
    }

    #[test]
    fn lengths_alone_give_the_weights_of_a_surface_in_space() {
        let sphere = icosphere(1.0, 2).unwrap();
        let by_vectors = Elements::of(&sphere).unwrap();
        let by_lengths = Elements::of_surface(&IntrinsicSurface::of(&sphere).unwrap()).unwrap();
        for (a, b) in by_vectors.elements().iter().zip(by_lengths.elements()) {
            assert!((a.measure - b.measure).abs() < 1e-15);
            let pairs = a.weights.as_flattened().iter().zip(b.weights.as_flattened());
            assert!(pairs.into_iter().all(|(x, y)| (x - y).abs() < 1e-12));
        }
    }

    #[test]
    fn slivers_keep_their_weights_by_vectors_and_needles_by_lengths_too() {
        let triangle = |height: f64, at: f64| {
            let corners = [[0.0, 0.0], [1.0, 0.0], [at, height]].map(Vector2::from).to_vec();
            Mesh::new(corners, vec![[0, 1, 2]]).unwrap()
        };
        // The angle at the apex over the middle of the base: cot = (h^2 - 1/4)/h.
        for height in [1e-3, 1e-6, 1e-12] {
            let cap = Elements::of(&triangle(height, 0.5)).unwrap();
            let exact = -0.5 * (height * height - 0.25) / height;
            assert!((cap.elements()[0].weights[0][1] / exact - 1.0).abs() < 1e-14);
        }
        let cap = IntrinsicSurface::of(&triangle(1e-12, 0.5));
        let lost = cap.map_err(LaplacianError::from).and_then(|s| Elements::of_surface(&s));
        assert!(matches!(lost, Err(LaplacianError::Mesh(MeshError::Degenerate(_)))));
        // A needle: its short edge is a length of its own.
        let needle = Mesh::new(
            [[0.0, 0.0], [1e-12, 0.0], [0.0, 1.0]].map(Vector2::from).to_vec(),
            vec![[0, 1, 2]],
        );
        let needle = IntrinsicSurface::of(&needle.unwrap()).unwrap();
        let weight = Elements::of_surface(&needle).unwrap().elements()[0].weights[0][1];
        assert!((weight / -0.5e12 - 1.0).abs() < 1e-9, "{weight:e}");
    }

    #[test]
    fn sheets_that_meet_and_vertices_that_nothing_names_leave_the_energy_a_sum_over_elements() {
        let points = |count: usize| {
            let at = |k: usize| Vector3::new(k as f64, (k * k) as f64, (k * k * k) as f64);
            (0..count).map(at).collect::<Vec<_>>()
        };
        let sheets = [[0, 1, 2], [1, 0, 3], [0, 1, 4]];
        let alone = |sheet: [usize; 3]| {
            let one = Mesh::new(points(5), vec![sheet]).unwrap();
            Elements::of(&one).unwrap().elements()[0]
        };
        let book = Elements::of(&Mesh::new(points(5), sheets.to_vec()).unwrap()).unwrap();
        assert_eq!(book.elements(), sheets.map(alone));
        let bow = Mesh::new(points(6), vec![[0, 1, 2], [0, 3, 5]]).unwrap();
        let domain = Domain::free(Elements::of(&bow).unwrap()).unwrap();
        assert_eq!(domain.free_vertices(), [0, 1, 2, 3, 5]);
        assert_eq!(domain.lumped().unwrap().masses().len(), 5);
    }

    #[test]
    fn what_is_no_domain_is_refused() {
        let flat = Mesh::new(vec![Vector3::zeros(), Vector3::x(), -Vector3::x()], vec![[0, 1, 2]]);
        let error = Elements::of(&flat.unwrap()).unwrap_err();
        assert!(matches!(error, LaplacianError::Mesh(MeshError::Degenerate(_))));
        let empty = Mesh::<3, 3>::new(vec![], vec![]).unwrap();
        assert_eq!(Elements::of(&empty), Err(LaplacianError::Mesh(MeshError::Empty)));
        let elements = Elements::of(&bar(1.0, 2).unwrap()).unwrap();
        assert!(elements.scaled(f64::NAN).is_err());
    }
}
