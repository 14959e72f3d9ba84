//! Dead loads: forces that keep their size and direction however the body moves.
//!
//! ```text
//! V = -<f, x>,    f_a = int N_a b   over a body,     b a force per volume   (N/m^3), as rho g
//!                 f_a = int N_a t   over a boundary, t a traction           (N/m^2)
//! ```
//! Integrals over the shape at rest, times the section. `f` newtons at each vertex, `x` positions;
//! the energy is that of the free coordinates only. A traction that follows the surface has no
//! potential here. A point load is added by hand: it belongs to a vertex and not to a shape.

use stationary_calculus::{Covector, Potential, Sink, array};

use crate::shape::{jacobian, visit_points};
use crate::{ElasticityError, Elements, Freedoms, Reference};

/// Constant forces at the vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct DeadLoad<const D: usize> {
    freedoms: Freedoms<D>,
    forces: Vec<[f64; D]>,
    free: Vec<f64>,
}

impl<const D: usize> DeadLoad<D> {
    /// These forces, newtons, one for each vertex.
    ///
    /// # Errors
    /// [`ElasticityError::Load`] for a force that is not finite, and [`ElasticityError::Vertices`].
    pub fn new(freedoms: &Freedoms<D>, forces: Vec<[f64; D]>) -> Result<Self, ElasticityError> {
        let bad = |force: &[f64; D]| force.iter().any(|f| !f.is_finite());
        if let Some(vertex) = forces.iter().position(bad) {
            return Err(ElasticityError::Load { vertex });
        }
        let free = freedoms.gathered(&forces)?;
        Ok(DeadLoad { freedoms: freedoms.clone(), forces, free })
    }

    /// A force per volume at each place of the body at rest, N/m^3.
    ///
    /// # Errors
    /// [`ElasticityError::Vertices`] for a numbering of another mesh; [`ElasticityError::Section`]
    /// unless that is positive and finite; [`ElasticityError::Mesh`] for elements that are flat or
    /// inside out; [`ElasticityError::Load`] for a force that is not finite.
    pub fn body<F, const N: usize, const R: usize, const Q: usize, const G: usize>(
        _family: F,
        mesh: &impl Elements<G, N>,
        section: f64,
        freedoms: &Freedoms<D>,
        force: impl Fn(&[f64; G]) -> [f64; D],
    ) -> Result<Self, ElasticityError>
    where
        F: Reference<N, R, Q>,
    {
        DeadLoad::integrated::<F, N, R, Q, G>(mesh, section, freedoms, |_, place| force(place))
    }

    /// A traction at each place of a boundary at rest, N/m^2: the function gets the place and the
    /// unit normal, which points to the right of a segment and to where a triangle runs
    /// counterclockwise.
    ///
    /// # Errors
    /// [`ElasticityError::Vertices`] for a numbering of another mesh; [`ElasticityError::Section`]
    /// unless that is positive and finite; [`ElasticityError::Mesh`] for pieces that are flat;
    /// [`ElasticityError::Load`] for a force that is not finite.
    pub fn traction<F, const N: usize, const R: usize, const Q: usize>(
        _family: F,
        boundary: &impl Elements<D, N>,
        section: f64,
        freedoms: &Freedoms<D>,
        traction: impl Fn(&[f64; D], &[f64; D]) -> [f64; D],
    ) -> Result<Self, ElasticityError>
    where
        F: Reference<N, R, Q>,
    {
        const { assert!(R + 1 == D, "a boundary has one dimension less than its space") };
        DeadLoad::integrated::<F, N, R, Q, D>(boundary, section, freedoms, |columns, place| {
            traction(place, &normal(columns))
        })
    }

    fn integrated<F, const N: usize, const R: usize, const Q: usize, const G: usize>(
        mesh: &impl Elements<G, N>,
        section: f64,
        freedoms: &Freedoms<D>,
        force: impl Fn(&[[f64; G]; R], &[f64; G]) -> [f64; D],
    ) -> Result<Self, ElasticityError>
    where
        F: Reference<N, R, Q>,
    {
        freedoms.check_vertices(mesh.count())?;
        if !(section > 0.0 && section.is_finite()) {
            return Err(ElasticityError::Section(section));
        }
        let rule = F::rule(4 * F::DEGREE);
        let mut forces = vec![[0.0; D]; mesh.count()];
        visit_points::<F, N, R, Q, G>(mesh, &rule, |number, points| {
            let element = &mesh.elements()[number];
            let nodes = mesh.corners(element);
            for ((l, _), point) in rule.iter().zip(points) {
                let functions = F::functions(l);
                let place = array(|i| (0..N).map(|a| functions[a] * nodes[a][i]).sum());
                let density = force(&jacobian(&nodes, &F::gradients(l)), &place);
                for (&node, n) in element.iter().zip(functions) {
                    for c in 0..D {
                        forces[node][c] += section * point.size * n * density[c];
                    }
                }
            }
        })?;
        DeadLoad::new(freedoms, forces)
    }

    /// The forces at all vertices, held ones included, newtons.
    pub fn forces(&self) -> &[[f64; D]] {
        &self.forces
    }

    /// The supports that it was made for.
    pub(crate) fn freedoms(&self) -> &Freedoms<D> {
        &self.freedoms
    }

    /// The forces at the free coordinates, in their order.
    pub(crate) fn at_free(&self) -> &[f64] {
        &self.free
    }

    /// The same load times a factor.
    ///
    /// # Errors
    /// [`ElasticityError::Load`] where the product is not finite.
    pub fn scaled(&self, factor: f64) -> Result<Self, ElasticityError> {
        let forces = self.forces.iter().map(|force| force.map(|f| factor * f)).collect();
        DeadLoad::new(&self.freedoms, forces)
    }

    /// The sum of two loads on the same vertices.
    ///
    /// # Errors
    /// [`ElasticityError::Vertices`] for loads on different numbers of vertices;
    /// [`ElasticityError::Load`] where the sum is not finite.
    pub fn plus(&self, other: &Self) -> Result<Self, ElasticityError> {
        self.freedoms.check_vertices(other.forces.len())?;
        let sum = |(a, b): (&[f64; D], &[f64; D])| array(|c| a[c] + b[c]);
        DeadLoad::new(&self.freedoms, self.forces.iter().zip(&other.forces).map(sum).collect())
    }

    /// The forces at the held coordinates, in their order.
    pub fn at_held(&self) -> Vec<f64> {
        self.freedoms.held().iter().map(|&(vertex, c)| self.forces[vertex][c]).collect()
    }
}

/// The unit normal of a boundary piece with these tangents.
fn normal<const D: usize, const R: usize>(columns: &[[f64; D]; R]) -> [f64; D] {
    let normal: [f64; D] = match R {
        1 => array(|i| if i == 0 { columns[0][1] } else { -columns[0][0] }),
        _ => crate::tensor::cross(&columns[0], &columns[1]),
    };
    let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
    normal.map(|x| x / length)
}

impl<const D: usize> Potential for DeadLoad<D> {
    fn dim(&self) -> usize {
        self.free.len()
    }

    /// NaN of a configuration that is too short.
    fn energy(&self, q: &[f64]) -> f64 {
        if q.len() < self.free.len() {
            return f64::NAN;
        }
        -self.free.iter().zip(q).map(|(f, q)| f * q).sum::<f64>()
    }

    /// NaN in every component of a covector that is too short.
    fn add_differential(&self, _q: &[f64], dv: Covector<&mut [f64]>) {
        if dv.0.len() < self.free.len() {
            return dv.0.fill(f64::NAN);
        }
        for (dv, f) in dv.0.iter_mut().zip(&self.free) {
            *dv -= f;
        }
    }

    fn add_hessian(&self, _q: &[f64], _hessian: &mut impl Sink) {}
}
