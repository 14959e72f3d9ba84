//! An elastic body of any dimension: the sum of its elements, four at a time.
//!
//! ```text
//! F = sum_a x_a (x) g_a                        D x R at each quadrature point            (13.2)
//! V = sum w W(F),   dV_a = sum w P g_a,   d2V_ab = sum w K(g_a, g_b)
//! ```
//! `x_a` the nodes of an element (m), `g_a` gradients of its shape functions at rest (1/m), `w` volumes:
//! sizes of the element times its section, the thickness of a sheet (m) or the cross-section of a bar
//! (m^2), 1 for solids. V in joules.
//!
//! Four elements are computed side by side, in the order of the mesh, and summed in that order: the
//! same bits in every run. Node 0 is the origin of its element and takes what the others leave, so
//! that forces of an element add up to zero to the last bit and a translation costs none.
//! Elements that are turned inside out keep whatever energy the material gives them; they are listed
//! by [`Solid::inverted`]. Source: notes 12.1, 13.2, 13.3; /crates/calculus' stencils do the same one by one.

use stationary_calculus::{Covector, Curvature, Potential, Sink, StencilHessian};

use crate::lanes::LANES;
use crate::shape::points;
use crate::tensor::{apply, determinant, scaled};
use crate::{ElasticityError, Elements, Freedoms, Lanes, Material, Real, Reference, Tangent};

/// Elements of `N` nodes and `Q` quadrature points, of `R` dimensions in `D`, of one material.
#[derive(Clone, Debug)]
pub struct Solid<M, const N: usize, const D: usize, const R: usize, const Q: usize> {
    freedoms: Freedoms<D>,
    material: M,
    pub(crate) groups: Vec<Group<N, R, Q>>,
    elements: usize,
    curvature: Curvature,
}

/// Four elements side by side.
#[derive(Clone, Debug)]
pub(crate) struct Group<const N: usize, const R: usize, const Q: usize> {
    /// What stands for each node, lane by lane.
    pub(crate) nodes: [[u32; N]; LANES],
    /// How many of the lanes are elements; the others repeat the last one, without weight.
    pub(crate) filled: usize,
    pub(crate) weights: [Lanes; Q],
    pub(crate) gradients: [[[Lanes; R]; N]; Q],
}

impl<M: Material<D, R>, const N: usize, const D: usize, const R: usize, const Q: usize>
    Solid<M, N, D, R, Q>
{
    /// A body of these elements at rest. `section` is the thickness of a sheet (m), the cross-section
    /// of a bar (m^2), and 1 for what fills its space.
    ///
    /// # Errors
    /// Elements that are flat or inside out, all of them listed; a section that is not positive; a
    /// numbering of another mesh.
    pub fn new<F: Reference<N, R, Q>, const G: usize>(
        _family: F,
        mesh: &impl Elements<G, N>,
        section: f64,
        material: M,
        freedoms: Freedoms<D>,
    ) -> Result<Self, ElasticityError> {
        const { assert!(R <= D && R <= G, "a body fits into its space") };
        freedoms.check_vertices(mesh.count())?;
        if !(section > 0.0 && section.is_finite()) {
            return Err(ElasticityError::Section(section));
        }
        let points = points::<F, N, R, Q, G>(mesh, &F::POINTS)?;
        let pairs: Vec<_> = mesh.elements().iter().zip(&points).collect();
        let groups = pairs.chunks(LANES).map(|pairs| {
            let filled = pairs.len();
            let lane = |lane: usize| pairs[lane.min(filled - 1)];
            let weight =
                |l: usize, q: usize| if l < filled { lane(l).1[q].size * section } else { 0.0 };
            let from_lanes = |of: &dyn Fn(usize) -> f64| Lanes(std::array::from_fn(of));
            Group {
                nodes: std::array::from_fn(|l| lane(l).0.map(|node| freedoms.start(node))),
                filled,
                weights: std::array::from_fn(|q| from_lanes(&|l| weight(l, q))),
                gradients: std::array::from_fn(|q| {
                    std::array::from_fn(|a| {
                        std::array::from_fn(|k| from_lanes(&|l| lane(l).1[q].gradients[a][k]))
                    })
                }),
            }
        });
        Ok(Solid {
            groups: groups.collect(),
            elements: pairs.len(),
            freedoms,
            material,
            curvature: Curvature::Exact,
        })
    }

    /// The same body with another choice of Hessian.
    #[must_use]
    pub fn with_curvature(self, curvature: Curvature) -> Self {
        Solid { curvature, ..self }
    }

    /// The same elements of another material.
    pub fn of_material<O: Material<D, R>>(&self, material: O) -> Solid<O, N, D, R, Q> {
        Solid {
            freedoms: self.freedoms.clone(),
            material,
            groups: self.groups.clone(),
            elements: self.elements,
            curvature: self.curvature,
        }
    }

    /// Its material.
    pub fn material(&self) -> &M {
        &self.material
    }

    /// Which coordinates move, and where the others are held.
    pub fn freedoms(&self) -> &Freedoms<D> {
        &self.freedoms
    }

    /// Moves the held coordinates, all of them, in their order.
    pub fn hold_at(&mut self, places: &[f64]) -> Result<(), ElasticityError> {
        self.freedoms.hold_at(places)
    }

    /// How many elements there are.
    pub fn elements(&self) -> usize {
        self.elements
    }

    /// The differential at the held coordinates, in their order: what the supports push against but
    /// for the loads, newtons.
    pub fn held_differential(&self, q: &[f64]) -> Result<Vec<f64>, ElasticityError> {
        self.freedoms.check(q.len())?;
        let mut held = vec![0.0; self.freedoms.places().len()];
        self.visit_differential(q, |node, part| self.freedoms.add_held(node, part, &mut held));
        Ok(held)
    }

    #[inline(always)]
    pub(crate) fn corners(
        freedoms: &Freedoms<D>,
        group: &Group<N, R, Q>,
        q: &[f64],
    ) -> [[Lanes; D]; N] {
        let mut x = [[Lanes::default(); D]; N];
        for (lane, nodes) in group.nodes.iter().enumerate() {
            for (corner, &node) in x.iter_mut().zip(nodes) {
                let position = freedoms.position(node, q);
                for c in 0..D {
                    corner[c].0[lane] = position[c];
                }
            }
        }
        for a in 1..N {
            for c in 0..D {
                x[a][c] = x[a][c] - x[0][c];
            }
        }
        x
    }

    /// F at a quadrature point, from the corners less the first one.
    #[inline(always)]
    pub(crate) fn deformation(x: &[[Lanes; D]; N], gradients: &[[Lanes; R]; N]) -> [[Lanes; D]; R] {
        let mut f = [[Lanes::default(); D]; R];
        for k in 0..R {
            for c in 0..D {
                let mut sum = x[1][c] * gradients[1][k];
                for a in 2..N {
                    sum = x[a][c].multiply_add(gradients[a][k], sum);
                }
                f[k][c] = sum;
            }
        }
        f
    }

    #[inline(always)]
    fn visit_differential(&self, q: &[f64], mut add: impl FnMut(u32, &[f64; D])) {
        for group in &self.groups {
            let forces = self.differential_of(group, &Self::corners(&self.freedoms, group, q));
            for (lane, nodes) in group.nodes.iter().enumerate().take(group.filled) {
                for (&node, force) in nodes.iter().zip(&forces) {
                    let mut part = [0.0; D];
                    for c in 0..D {
                        part[c] = force[c].0[lane];
                    }
                    add(node, &part);
                }
            }
        }
    }

    #[inline(always)]
    fn differential_of(&self, group: &Group<N, R, Q>, x: &[[Lanes; D]; N]) -> [[Lanes; D]; N] {
        let mut forces = [[Lanes::default(); D]; N];
        for (gradients, &weight) in group.gradients.iter().zip(&group.weights) {
            let stress = self.material.stress(&Self::deformation(x, gradients));
            let stress = scaled(&stress, weight);
            for a in 1..N {
                let force = apply(&stress, &gradients[a]);
                for c in 0..D {
                    forces[a][c] += force[c];
                }
            }
        }
        for a in 1..N {
            for c in 0..D {
                forces[0][c] = forces[0][c] - forces[a][c];
            }
        }
        forces
    }

    /// Hands the matrices of four elements to a sink, one after the other.
    #[inline(always)]
    pub(crate) fn scatter(
        &self,
        group: &Group<N, R, Q>,
        lanes: &LaneHessian<N, D>,
        block: &mut StencilHessian<N, D>,
        sink: &mut impl Sink,
    ) {
        for (lane, nodes) in group.nodes.iter().enumerate().take(group.filled) {
            of_lane(lanes, lane, block);
            let freedoms = nodes.map(|node| self.freedoms.freedoms(node));
            let block = block.as_flattened().as_flattened().as_flattened();
            sink.add_symmetric(freedoms.as_flattened(), block);
        }
    }

    /// The lower triangle of the Hessians of four elements.
    #[inline(always)]
    fn hessian_of(&self, group: &Group<N, R, Q>, x: &[[Lanes; D]; N]) -> LaneHessian<N, D> {
        let mut hessian = [[[[Lanes::default(); D]; D]; N]; N];
        for (gradients, &weight) in group.gradients.iter().zip(&group.weights) {
            let f = Self::deformation(x, gradients);
            if self.curvature == Curvature::Exact || self.material.is_semidefinite(&f) {
                accumulate(&mut hessian, &self.material.tangent(&f, weight), gradients);
            } else {
                accumulate(&mut hessian, &self.material.semidefinite(&f, weight), gradients);
            }
        }
        complete(&mut hessian);
        hessian
    }
}

/// Blocks `[b][a][d][c]` of four elements, a >= b: rows of node a, columns of node b.
pub(crate) type LaneHessian<const N: usize, const D: usize> = [[[[Lanes; D]; D]; N]; N];

/// Adds the lower triangle of the blocks between the nodes after the first.
#[inline(always)]
pub(crate) fn accumulate<
    A: Tangent<Lanes, D, R>,
    const N: usize,
    const D: usize,
    const R: usize,
>(
    hessian: &mut LaneHessian<N, D>,
    tangent: &A,
    gradients: &[[Lanes; R]; N],
) {
    let mut nodes = [tangent.node(&gradients[0]); N];
    for a in 1..N {
        nodes[a] = tangent.node(&gradients[a]);
    }
    for b in 1..N {
        for a in b..N {
            let block = tangent.block(&nodes[a], &nodes[b]);
            for d in 0..D {
                for c in 0..D {
                    hessian[b][a][d][c] += block[d][c];
                }
            }
        }
    }
}

/// Gives the first node what the others leave: no translation costs anything.
#[inline(always)]
pub(crate) fn complete<const N: usize, const D: usize>(hessian: &mut LaneHessian<N, D>) {
    for d in 0..D {
        for c in 0..D {
            let mut corner = Lanes::default();
            for a in 1..N {
                // Row c of node a, column d of node 0: what is left over of that row.
                let mut sum = Lanes::default();
                for b in 1..N {
                    sum += if a >= b { hessian[b][a][d][c] } else { hessian[a][b][c][d] };
                }
                hessian[0][a][d][c] = -sum;
                corner += sum;
            }
            hessian[0][0][d][c] = corner;
        }
    }
}

/// The whole matrix of one of four elements, both triangles, exactly symmetric.
#[inline(always)]
pub(crate) fn of_lane<const N: usize, const D: usize>(
    lanes: &LaneHessian<N, D>,
    lane: usize,
    hessian: &mut StencilHessian<N, D>,
) {
    for b in 0..N {
        for d in 0..D {
            for c in d..D {
                let entry = lanes[b][b][d][c].0[lane];
                hessian[b][d][b][c] = entry;
                hessian[b][c][b][d] = entry;
            }
            for a in b + 1..N {
                for c in 0..D {
                    let entry = lanes[b][a][d][c].0[lane];
                    hessian[b][d][a][c] = entry;
                    hessian[a][c][b][d] = entry;
                }
            }
        }
    }
}

impl<M: Material<D, R>, const N: usize, const D: usize, const R: usize, const Q: usize> Potential
    for Solid<M, N, D, R, Q>
{
    fn dim(&self) -> usize {
        self.freedoms.dim()
    }

    fn energy(&self, q: &[f64]) -> f64 {
        let q = &q[..self.freedoms.dim()];
        let mut sum = Lanes::default();
        for group in &self.groups {
            let x = Self::corners(&self.freedoms, group, q);
            for (gradients, &weight) in group.gradients.iter().zip(&group.weights) {
                let density = self.material.energy(&Self::deformation(&x, gradients));
                sum = density.multiply_add(weight, sum);
            }
        }
        sum.0.iter().sum()
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let n = self.freedoms.dim();
        let (q, dv) = (&q[..n], &mut dv.0[..n]);
        self.visit_differential(q, |node, part| self.freedoms.add(node, part, dv));
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        let q = &q[..self.freedoms.dim()];
        let mut block: StencilHessian<N, D> = [[[[0.0; D]; N]; D]; N];
        for group in &self.groups {
            let lanes = self.hessian_of(group, &Self::corners(&self.freedoms, group, q));
            self.scatter(group, &lanes, &mut block, hessian);
        }
    }
}

impl<M: Material<D, D>, const N: usize, const D: usize, const Q: usize> Solid<M, N, D, D, Q> {
    /// The elements that are turned inside out, or flat, at some quadrature point.
    pub fn inverted(&self, q: &[f64]) -> Result<Vec<usize>, ElasticityError> {
        self.freedoms.check(q.len())?;
        let mut inverted = Vec::new();
        for (number, group) in self.groups.iter().enumerate() {
            let x = Self::corners(&self.freedoms, group, q);
            for lane in 0..group.filled {
                let bad = |gradients: &[[Lanes; D]; N]| {
                    !(determinant(&Self::deformation(&x, gradients)).0[lane] > 0.0)
                };
                if group.gradients.iter().any(bad) {
                    inverted.push(LANES * number + lane);
                }
            }
        }
        Ok(inverted)
    }
}
