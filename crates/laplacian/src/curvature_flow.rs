//! Mean-curvature flow: a surface that lets its area go, like a soap film.
//!
//! ```text
//! dx/dt = Lap x = 2 H n           each step:  (M + h W) d = -h W x,   x <- x + d
//! ```
//! `x` the vertices (m), `H` the mean curvature, `n` the normal, `M W` lumped mass and Dirichlet
//! energy of the surface as it is when the step begins, `h` the step (m^2). A boundary is held.
//! Linear in the step's end, so stable at any step, of order 1; the pattern is analysed once. A
//! sphere shrinks like `r^2 = r0^2 - 4 t`; a surface that comes near a point or a line loses its
//! triangles, and the step that meets one without area is an error. Nothing keeps triangles well
//! shaped. Source: Dziuk 1990; Desbrun, Meyer, Schroeder and Barr 1999.

use nalgebra::Vector3;
use stationary_calculus::{Metric, Potential, SparseCholesky, Stencil, SymmetricMatrix};
use stationary_mesh::Mesh;

use crate::error::{check_finite, positive};
use crate::{Domain, Elements, LaplacianError};

/// A surface on its way.
#[derive(Debug)]
pub struct MeanCurvatureFlow {
    mesh: Mesh<3, 3>,
    held: Vec<(usize, f64)>,
    matrix: SymmetricMatrix,
    factor: SparseCholesky,
}

impl MeanCurvatureFlow {
    /// The flow from a surface; its boundary, if it has one, stays where it is.
    ///
    /// # Errors
    /// Those of [`Elements::of`], and [`LaplacianError::NothingFree`].
    pub fn new(mesh: Mesh<3, 3>) -> Result<Self, LaplacianError> {
        let held: Vec<_> =
            mesh.boundary().vertices.into_iter().map(|vertex| (vertex, 0.0)).collect();
        let domain = Domain::held(Elements::of(&mesh)?, &held)?;
        let (metric, anywhere) = (domain.lumped()?, vec![0.0; domain.dim()]);
        let matrix = SymmetricMatrix::analyse(domain.dim(), |sink| {
            metric.add_matrix(sink);
            domain.dirichlet().add_hessian(&anywhere, sink);
        })?;
        let factor = SparseCholesky::analyse(&matrix)?;
        Ok(MeanCurvatureFlow { mesh, held, matrix, factor })
    }

    /// The surface as it is.
    pub fn mesh(&self) -> &Mesh<3, 3> {
        &self.mesh
    }

    /// One step of `h`, in m^2. After an error the surface is as it was.
    ///
    /// # Errors
    /// [`LaplacianError::Parameter`], [`LaplacianError::Mesh`] for triangles that have lost their
    /// area, [`LaplacianError::Sparse`] and [`LaplacianError::NonFinite`].
    pub fn step(&mut self, h: f64) -> Result<(), LaplacianError> {
        positive("the step", h)?;
        let domain = Domain::held(Elements::of(&self.mesh)?, &self.held)?;
        let (metric, anywhere) = (domain.lumped()?, vec![0.0; domain.dim()]);
        self.matrix.refill(|sink| {
            metric.add_matrix(sink.weighted(1.0));
            domain.dirichlet().add_hessian(&anywhere, sink.weighted(h));
        })?;
        self.factor.factor(&self.matrix)?;
        let differential = self.differential(&domain.elements());
        let free = domain.free_vertices();
        let component = |c: usize| free.iter().map(move |&vertex| (vertex, c));
        let mut change: Vec<f64> =
            (0..3).flat_map(component).map(|(vertex, c)| -h * differential[vertex][c]).collect();
        self.factor.solve(&mut change);
        check_finite(&change)?;
        let mut vertices = self.mesh.vertices().to_vec();
        for (freedom, &vertex) in free.iter().enumerate() {
            for c in 0..3 {
                vertices[vertex][c] += change[freedom + c * free.len()];
            }
        }
        self.mesh = Mesh::new(vertices, self.mesh.simplices().to_vec())?;
        Ok(())
    }

    /// `W x` for the three coordinates of all vertices.
    fn differential(&self, elements: &Elements<3>) -> Vec<Vector3<f64>> {
        let vertices = self.mesh.vertices();
        let mut sums = vec![Vector3::zeros(); vertices.len()];
        for element in elements.elements() {
            let corners = element.corners();
            for c in 0..3 {
                let parts = element.differential(&corners.map(|vertex| [vertices[vertex][c]]));
                for (vertex, [part]) in corners.into_iter().zip(parts) {
                    sums[vertex][c] += part;
                }
            }
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stationary_measure::loglog_slope;
    use stationary_mesh::{MeshError, disc, icosphere};

    #[test]
    fn a_sphere_shrinks_by_its_law_at_order_one() {
        let error = |steps: usize| {
            let mut flow = MeanCurvatureFlow::new(icosphere(1.0, 4).unwrap()).unwrap();
            let h = 0.1 / steps as f64;
            (0..steps).for_each(|_| flow.step(h).unwrap());
            let vertices = flow.mesh().vertices();
            let mean = vertices.iter().map(|x| x.norm()).sum::<f64>() / vertices.len() as f64;
            (h, (mean - 0.6_f64.sqrt()).abs())
        };
        let slope = loglog_slope(&[error(4), error(8), error(16)]).unwrap();
        assert!((slope - 1.0).abs() < 0.15, "{slope}");
    }

    #[test]
    fn a_film_in_a_flat_ring_becomes_flat_and_its_area_only_falls() {
        let bump = disc(1.0, 8).unwrap();
        let bump = bump.mapped(|x| Vector3::new(x.x, x.y, 0.8 * (1.0 - x.norm_squared())));
        let mut flow = MeanCurvatureFlow::new(bump.unwrap()).unwrap();
        let rim = flow.mesh().boundary().mesh;
        for _ in 0..40 {
            let before = flow.mesh().measure();
            flow.step(0.05).unwrap();
            assert!(flow.mesh().measure() <= before * (1.0 + 1e-14));
        }
        assert!(flow.mesh().vertices().iter().all(|x| x.z.abs() < 1e-3));
        assert_eq!(flow.mesh().boundary().mesh, rim);
    }

    #[test]
    fn a_surface_that_vanishes_is_an_error_and_stays_as_it_was() {
        let mut flow = MeanCurvatureFlow::new(icosphere(1.0, 2).unwrap()).unwrap();
        let mut last = flow.mesh().clone();
        let mut failure = None;
        for _ in 0..2000 {
            if let Err(error) = flow.step(1e3) {
                failure = Some(error);
                break;
            }
            last = flow.mesh().clone();
        }
        assert!(failure.is_some());
        assert_eq!(*flow.mesh(), last);
        assert!(flow.step(f64::NAN).is_err());
        let two = Mesh::new(vec![Vector3::zeros(), Vector3::x(), Vector3::y()], vec![[0, 1, 2]]);
        let error = MeanCurvatureFlow::new(two.unwrap()).unwrap_err();
        assert_eq!(error, LaplacianError::NothingFree);
        let flat =
            Mesh::new(vec![Vector3::zeros(), Vector3::x(), Vector3::x() * 2.0], vec![[0, 1, 2]]);
        let error = MeanCurvatureFlow::new(flat.unwrap()).unwrap_err();
        assert!(matches!(error, LaplacianError::Mesh(MeshError::Degenerate(_))));
    }
}
