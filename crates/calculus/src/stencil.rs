//! Stencils: what most potentials are made of, and the one scatter that sums them.
//!
//! ```text
//! V(q) = sum over stencils s of  W_s(x),    x = the V vertices of s, in D dimensions each
//! ```
//! A stencil knows a few vertices, a dense energy, differential and Hessian of fixed size (notes
//! 3.3, "local coordinates"); [`Stencils`] adds a list of them up in list order, so that the
//! sum has the same bits in every run. Vertices past the free ones are fixed: pins cost no freedom.
//!
//! Freedoms are interleaved by vertex: component c of vertex a is freedom `D a + c`.

use crate::{Covector, FIXED, Potential, Sink, array};

/// A Hessian of V vertices in D dimensions, indexed `[b][d][a][c]`: the second derivative by
/// component d of vertex b and component c of vertex a. Flattened, it is the matrix by columns.
pub type StencilHessian<const V: usize, const D: usize> = [[[[f64; D]; V]; D]; V];

/// Which Hessian a stencil gives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Curvature {
    /// The second derivative itself, whatever its signs.
    #[default]
    Exact,
    /// Its projection to the nearest positive semidefinite matrix: Newton's direction then
    /// descends, but convergence is no longer quadratic where the two differ.
    Semidefinite,
}

/// An energy of V vertices in D dimensions.
pub trait Stencil<const V: usize, const D: usize> {
    /// The vertices it joins.
    fn vertices(&self) -> [usize; V];

    /// Its energy, in joules, at the vertices' positions.
    fn energy(&self, x: &[[f64; D]; V]) -> f64;

    /// The differential of its energy.
    fn differential(&self, x: &[[f64; D]; V]) -> [[f64; D]; V];

    /// The Hessian of its energy, or the projection that `curvature` names.
    fn hessian(&self, x: &[[f64; D]; V], curvature: Curvature) -> StencilHessian<V, D>;
}

/// A list of stencils over the same vertices: a [`Potential`].
#[derive(Clone, Debug)]
pub struct Stencils<S, const V: usize, const D: usize> {
    free: usize,
    fixed: Vec<[f64; D]>,
    stencils: Vec<S>,
    curvature: Curvature,
}

/// A stencil names a vertex that is neither free nor fixed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("stencil {stencil} names vertex {vertex}, but there are only {vertices}")]
pub struct UnknownVertex {
    /// The stencil's place in the list.
    pub stencil: usize,
    /// The vertex that it names.
    pub vertex: usize,
    /// How many vertices there are, free and fixed.
    pub vertices: usize,
}

impl<S: Stencil<V, D>, const V: usize, const D: usize> Stencils<S, V, D> {
    /// Stencils over `free` moving vertices, numbered from 0, and the fixed ones after them.
    ///
    /// # Errors
    /// [`UnknownVertex`] for the first stencil that names a vertex which is neither free nor fixed.
    pub fn new(free: usize, fixed: Vec<[f64; D]>, stencils: Vec<S>) -> Result<Self, UnknownVertex> {
        let vertices = free + fixed.len();
        for (index, stencil) in stencils.iter().enumerate() {
            if let Some(vertex) = stencil.vertices().into_iter().find(|&v| v >= vertices) {
                return Err(UnknownVertex { stencil: index, vertex, vertices });
            }
        }
        Ok(Stencils { free, fixed, stencils, curvature: Curvature::Exact })
    }

    /// The same potential with another choice of Hessian.
    pub fn with_curvature(self, curvature: Curvature) -> Self {
        Stencils { curvature, ..self }
    }

    /// The stencils, in the order in which they are summed.
    pub fn stencils(&self) -> &[S] {
        &self.stencils
    }

    #[inline]
    fn gather(&self, vertices: &[usize; V], points: &[[f64; D]]) -> [[f64; D]; V] {
        array(|a| match vertices[a] {
            v if v < self.free => points[v],
            v => self.fixed[v - self.free],
        })
    }
}

impl<S: Stencil<V, D>, const V: usize, const D: usize> Potential for Stencils<S, V, D> {
    fn dim(&self) -> usize {
        D * self.free
    }

    #[inline]
    fn energy(&self, q: &[f64]) -> f64 {
        let points = &q.as_chunks::<D>().0[..self.free];
        let mut sum = 0.0;
        for stencil in &self.stencils {
            sum += stencil.energy(&self.gather(&stencil.vertices(), points));
        }
        sum
    }

    #[inline]
    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let points = &q.as_chunks::<D>().0[..self.free];
        let rows = &mut dv.0.as_chunks_mut::<D>().0[..self.free];
        for stencil in &self.stencils {
            let vertices = stencil.vertices();
            let differential = stencil.differential(&self.gather(&vertices, points));
            for (&vertex, part) in vertices.iter().zip(&differential) {
                if vertex < self.free {
                    for (sum, part) in rows[vertex].iter_mut().zip(part) {
                        *sum += part;
                    }
                }
            }
        }
    }

    #[inline]
    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        let points = &q.as_chunks::<D>().0[..self.free];
        for stencil in &self.stencils {
            let vertices = stencil.vertices();
            let block = stencil.hessian(&self.gather(&vertices, points), self.curvature);
            let freedom =
                |vertex: usize, c: usize| if vertex < self.free { D * vertex + c } else { FIXED };
            let freedoms: [[usize; D]; V] = array(|a| array(|c| freedom(vertices[a], c)));
            hessian.add_vertices(&freedoms, &block);
        }
    }
}
