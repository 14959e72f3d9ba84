//! An elastic body of any dimension: the sum of its elements, four at a time.
//!
//! ```text
//! F = sum_a x_a (x) g_a                        D x R at each quadrature point            (13.2)
//! V = sum w W(F),   dV_a = sum w P g_a,   d2V_ab = sum w K(g_a, g_b)
//! ```
//! `x_a` the nodes of an element (m), `g_a` gradients of its shape functions at rest (1/m), `w`
//! volumes: sizes of the element times its section, the thickness of a sheet (m) or the
//! cross-section of a bar (m^2), 1 for solids. V in joules.
//!
//! Four elements are computed side by side, in the order of the mesh, and summed in that order: the
//! same bits in every run and on any number of threads ([`Solid::in_parts`]). The node of the
//! lowest number is the origin of its element and takes what the others leave, so that forces of an
//! element add up to zero to the last bit and a translation costs none. Elements that are turned
//! inside out keep whatever energy the material gives them; they are listed by [`Solid::inverted`].
//! Source: notes 12.1, 13.2, 13.3.

use stationary_calculus::{
    Covector, Curvature, Parts, Potential, Sink, array, in_parts, side_by_side,
};

use crate::division::Division;
use crate::group::{Group, deformation};
use crate::lane_hessian::{Accumulation, LaneHessian, begin, complete};
use crate::lanes::LANES;
use crate::material::TakesTangent;
use crate::shape::visit_points;
use crate::singular::square_determinant;
use crate::tensor::{apply, scaled};
use crate::{ElasticityError, Elements, Freedoms, Lanes, Material, Real, Reference};

/// Elements of `N` nodes and `Q` quadrature points, of `R` dimensions in `D`, of one material.
#[derive(Clone, Debug)]
pub struct Solid<M, const N: usize, const D: usize, const R: usize, const Q: usize> {
    freedoms: Freedoms<D>,
    material: M,
    pub(crate) groups: Vec<Group<N, R, Q>>,
    elements: usize,
    pub(crate) curvature: Curvature,
    division: Division,
}

/// Groups whose energies are summed in a row: a thousand elements are worth a thread's while.
const ROW: usize = 256;

/// Quadrature points whose energy densities are computed at once.
const BATCH: usize = 16;

impl<M: Material<D, R>, const N: usize, const D: usize, const R: usize, const Q: usize>
    Solid<M, N, D, R, Q>
{
    /// A body of these elements at rest. `section` is the thickness of a sheet (m), the
    /// cross-section of a bar (m^2), and 1 for what fills its space.
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
        const { assert!(1 <= Q && Q <= BATCH, "an element is computed at once") };
        freedoms.check_vertices(mesh.count())?;
        if !(section > 0.0 && section.is_finite()) {
            return Err(ElasticityError::Section(section));
        }
        let mut points = Vec::with_capacity(Q * mesh.elements().len());
        visit_points::<F, N, R, Q, G>(mesh, &F::POINTS, |_, of_element| {
            points.extend_from_slice(of_element);
        })?;
        Ok(Solid {
            groups: Group::all(mesh.elements(), &points, section, &freedoms),
            elements: mesh.elements().len(),
            division: Division::whole(freedoms.dim()),
            freedoms,
            material,
            curvature: Curvature::Exact,
        })
    }

    /// The same body computed in so many parts, side by side with the feature `threads`: energy,
    /// differential and Hessian keep their bits. One for each thread is right; elements at the
    /// borders between parts are computed twice, few of them where neighbours in the mesh have
    /// close numbers. A matrix that was analysed for another number of parts refuses this one. From
    /// outside the threads' pool each call has to wake two of them, from within it one: what calls
    /// often had better run there. There are no more parts than groups of four elements.
    #[must_use]
    pub fn in_parts(self, count: usize) -> Self {
        let count = count.min(self.groups.len());
        let division = Division::new(&self.freedoms, &self.groups, count);
        Solid { division, ..self }
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
            division: self.division.clone(),
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
    ///
    /// # Errors
    /// Those of [`Freedoms::hold_at`]; the body is then as it was.
    pub fn hold_at(&mut self, places: &[f64]) -> Result<(), ElasticityError> {
        self.freedoms.hold_at(places)
    }

    /// How many elements there are.
    pub fn elements(&self) -> usize {
        self.elements
    }

    /// The differential at the held coordinates, in their order: what the supports push against but
    /// for the loads, newtons.
    ///
    /// # Errors
    /// [`ElasticityError::Freedoms`] unless `q` has a number for each freedom.
    pub fn held_differential(&self, q: &[f64]) -> Result<Vec<f64>, ElasticityError> {
        self.freedoms.check(q.len())?;
        let mut held = vec![0.0; self.freedoms.places().len()];
        self.visit_differential(q, |node, part| self.freedoms.add_held(node, part, &mut held));
        Ok(held)
    }

    #[inline(always)]
    fn visit_differential(&self, q: &[f64], mut add: impl FnMut(u32, &[f64; D])) {
        for group in &self.groups {
            self.visit_group(q, group, &mut add);
        }
    }

    #[inline(always)]
    fn visit_group(&self, q: &[f64], group: &Group<N, R, Q>, add: &mut impl FnMut(u32, &[f64; D])) {
        let forces = self.differential_of(group, &group.corners(&self.freedoms, q));
        for (lane, nodes) in group.nodes.iter().enumerate().take(group.filled) {
            for (&node, force) in nodes.iter().zip(&forces) {
                let mut part = [0.0; D];
                for c in 0..D {
                    part[c] = force[c].lane(lane);
                }
                add(node, &part);
            }
        }
    }

    /// Summed by halves that depend on the number of groups only.
    fn energy_of(&self, q: &[f64], groups: &[Group<N, R, Q>]) -> f64 {
        if groups.len() > ROW {
            let (one, other) = groups.split_at((groups.len() / 2).next_multiple_of(ROW));
            let [mut first, mut second] = [0.0; 2];
            let (mut one, mut other) =
                (|| first = self.energy_of(q, one), || second = self.energy_of(q, other));
            if self.division.is_whole() {
                one();
                other();
            } else {
                side_by_side(&mut one, &mut other);
            }
            return first + second;
        }
        let (mut sum, mut densities) = (Lanes::default(), [Lanes::default(); BATCH]);
        for groups in groups.chunks(BATCH / Q) {
            let densities = &mut densities[..Q * groups.len()];
            let mut x = [[Lanes::default(); D]; N];
            let deformation = |k: usize| {
                let (group, point) = (&groups[k / Q], k % Q);
                if point == 0 {
                    x = group.corners(&self.freedoms, q);
                }
                deformation(&x, &group.gradients[point])
            };
            self.material.energies(deformation, densities);
            let weights = groups.iter().flat_map(|group| group.weights);
            for (density, weight) in densities.iter().zip(weights) {
                sum = density.multiply_add(weight, sum);
            }
        }
        (0..LANES).map(|lane| sum.lane(lane)).sum()
    }

    #[inline(always)]
    fn differential_of(&self, group: &Group<N, R, Q>, x: &[[Lanes; D]; N]) -> [[Lanes; D]; N] {
        let mut forces = [[Lanes::default(); D]; N];
        for (gradients, &weight) in group.gradients.iter().zip(&group.weights) {
            let stress = self.material.stress(&deformation(x, gradients));
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
        sink: &mut impl Sink,
    ) {
        for (lane, nodes) in group.nodes.iter().enumerate().take(group.filled) {
            let freedoms: [[usize; D]; N] = array(|a| self.freedoms.freedoms(nodes[a]));
            sink.add_lower(&freedoms, |b, d, a| array(|c| lanes[b][a][d][c].lane(lane)));
        }
    }

    /// The lower triangle of the Hessians of four elements.
    // Not for each sink again: it is most of what is compiled.
    #[inline(never)]
    fn fill_hessian(
        &self,
        group: &Group<N, R, Q>,
        x: &[[Lanes; D]; N],
        hessian: &mut LaneHessian<N, D>,
    ) {
        begin::<N, D, Q>(hessian);
        for (gradients, &weight) in group.gradients.iter().zip(&group.weights) {
            let f = deformation(x, gradients);
            let mut sum = Accumulation::<'_, N, D, R, Q> { hessian, gradients };
            if self.curvature == Curvature::Exact || self.material.is_semidefinite(&f) {
                sum.take(&self.material.tangent(&f, weight));
            } else {
                self.material.hand_semidefinite(&f, weight, &mut sum);
            }
        }
        complete(hessian);
    }
}

impl<M: Material<D, R>, const N: usize, const D: usize, const R: usize, const Q: usize> Potential
    for Solid<M, N, D, R, Q>
{
    fn dim(&self) -> usize {
        self.freedoms.dim()
    }

    /// NaN of a configuration that is too short.
    fn energy(&self, q: &[f64]) -> f64 {
        q.get(..self.freedoms.dim()).map_or(f64::NAN, |q| self.energy_of(q, &self.groups))
    }

    /// NaN in every component where the configuration or the covector is too short.
    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let n = self.freedoms.dim();
        if q.len() < n || dv.0.len() < n {
            return dv.0.fill(f64::NAN);
        }
        let (q, dv) = (&q[..n], &mut dv.0[..n]);
        if self.division.is_whole() {
            return self.visit_differential(q, |node, part| self.freedoms.add(node, part, dv));
        }
        in_parts(self.division.bounds(), dv, &|bound| bound, &|part, first, dv: &mut [f64]| {
            for &group in self.division.groups(part) {
                self.visit_group(q, &self.groups[group as usize], &mut |node, force| {
                    self.freedoms.add_within(node, force, first, dv);
                });
            }
        });
    }

    /// A single NaN where the configuration is too short.
    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        match q.get(..self.freedoms.dim()) {
            Some(q) => hessian.add_parts(&Hessians { solid: self, q }),
            None => hessian.add_symmetric(&[0], &[f64::NAN]),
        }
    }
}

/// The matrices of a body's elements at one configuration.
struct Hessians<'a, M, const N: usize, const D: usize, const R: usize, const Q: usize> {
    solid: &'a Solid<M, N, D, R, Q>,
    q: &'a [f64],
}

impl<M: Material<D, R>, const N: usize, const D: usize, const R: usize, const Q: usize>
    Hessians<'_, M, N, D, R, Q>
{
    /// Adds the matrices of the elements of one part, or of all: one loop for both, so that it is
    /// compiled once.
    fn add_all(&self, part: Option<usize>, sink: &mut impl Sink) {
        let mut hessian = [[[[Lanes::default(); D]; D]; N]; N];
        let some = part.map(|part| self.solid.division.groups(part));
        for k in 0..some.map_or(self.solid.groups.len(), <[u32]>::len) {
            let group = &self.solid.groups[some.map_or(k, |groups| groups[k] as usize)];
            let x = group.corners(&self.solid.freedoms, self.q);
            self.solid.fill_hessian(group, &x, &mut hessian);
            self.solid.scatter(group, &hessian, sink);
        }
    }
}

impl<M: Material<D, R>, const N: usize, const D: usize, const R: usize, const Q: usize> Parts
    for Hessians<'_, M, N, D, R, Q>
{
    fn bounds(&self) -> &[usize] {
        self.solid.division.bounds()
    }

    fn visit(&self, part: usize, sink: &mut impl Sink) {
        self.add_all(Some(part), sink);
    }

    fn visit_all(&self, sink: &mut impl Sink) {
        self.add_all(None, sink);
    }
}

impl<M: Material<D, R>, const N: usize, const D: usize, const R: usize, const Q: usize>
    Solid<M, N, D, R, Q>
{
    /// The elements that are turned inside out, or flat, at some quadrature point. A bar, sheet or
    /// membrane in more dimensions than its own has no inside: none are.
    ///
    /// # Errors
    /// [`ElasticityError::Freedoms`].
    pub fn inverted(&self, q: &[f64]) -> Result<Vec<usize>, ElasticityError> {
        self.freedoms.check(q.len())?;
        let mut inverted = Vec::new();
        if D != R {
            return Ok(inverted);
        }
        for (number, group) in self.groups.iter().enumerate() {
            let x = group.corners(&self.freedoms, q);
            for lane in 0..group.filled {
                let bad = |gradients: &[[Lanes; R]; N]| {
                    let volume = square_determinant(&deformation(&x, gradients)).lane(lane);
                    volume <= 0.0 || volume.is_nan()
                };
                if group.gradients.iter().any(bad) {
                    inverted.push(LANES * number + lane);
                }
            }
        }
        Ok(inverted)
    }
}
