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
//! same bits in every run and on any number of threads ([`Solid::in_parts`]). The node of the lowest
//! number is the origin of its element and takes what the others leave, so that forces of an element
//! add up to zero to the last bit and a translation costs none. Elements that are turned inside out
//! keep whatever energy the material gives them; they are listed by [`Solid::inverted`]. Source: notes
//! 12.1, 13.2, 13.3.

use stationary_calculus::{
    Covector, Curvature, Parts, Potential, Sink, StencilHessian, in_parts, side_by_side,
};

use crate::division::Division;
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
    division: Division,
}

/// Groups whose energies are summed in a row: a thousand elements are worth a thread's while.
const ROW: usize = 256;

/// Four elements side by side.
#[derive(Clone, Debug)]
pub(crate) struct Group<const N: usize, const R: usize, const Q: usize> {
    /// What stands for each node, lane by lane, in the order of their numbers.
    pub(crate) nodes: [[u32; N]; LANES],
    /// How many of the lanes are elements; the others repeat the last one, without weight.
    pub(crate) filled: usize,
    pub(crate) weights: [Lanes; Q],
    pub(crate) gradients: [[[Lanes; R]; N]; Q],
}

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
        freedoms.check_vertices(mesh.count())?;
        if !(section > 0.0 && section.is_finite()) {
            return Err(ElasticityError::Section(section));
        }
        let points = points::<F, N, R, Q, G>(mesh, &F::POINTS)?;
        let ordered = mesh.elements().iter().map(|nodes| Order::of(nodes, &freedoms));
        let pairs: Vec<_> = ordered.zip(&points).collect();
        let groups = pairs.chunks(LANES).map(|pairs| {
            let filled = pairs.len();
            let lane = |lane: usize| &pairs[lane.min(filled - 1)];
            let weight =
                |l: usize, q: usize| if l < filled { lane(l).1[q].size * section } else { 0.0 };
            let from_lanes = |of: &dyn Fn(usize) -> f64| Lanes(std::array::from_fn(of));
            Group {
                nodes: std::array::from_fn(|l| lane(l).0.starts),
                filled,
                weights: std::array::from_fn(|q| from_lanes(&|l| weight(l, q))),
                gradients: std::array::from_fn(|q| {
                    std::array::from_fn(|a| {
                        std::array::from_fn(|k| {
                            from_lanes(&|l| lane(l).1[q].gradients[lane(l).0.places[a]][k])
                        })
                    })
                }),
            }
        });
        Ok(Solid {
            groups: groups.collect(),
            elements: pairs.len(),
            division: Division::whole(freedoms.dim()),
            freedoms,
            material,
            curvature: Curvature::Exact,
        })
    }

    /// The same body computed in so many parts, side by side with the feature `threads`: energy,
    /// differential and Hessian keep their bits. One for each thread is right; elements at the
    /// borders between parts are computed twice, few of them where neighbours in the mesh have close
    /// numbers. A matrix that was analysed for another number of parts refuses this one.
    #[must_use]
    pub fn in_parts(self, count: usize) -> Self {
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
    pub fn hold_at(&mut self, places: &[f64]) -> Result<(), ElasticityError> {
        self.freedoms.hold_at(places)
    }

    /// How many elements there are.
    pub fn elements(&self) -> usize {
        self.elements
    }

    /// Which of the body's pieces each vertex belongs to, from 0 in the order of their first vertices:
    /// elements join what they share, and a vertex without elements is a piece of its own.
    pub(crate) fn pieces(&self) -> Vec<usize> {
        let starts: Vec<u32> =
            (0..self.freedoms.vertices()).map(|vertex| self.freedoms.start(vertex)).collect();
        let most = starts.iter().max().map_or(0, |&most| most as usize + 1);
        let mut leader: Vec<u32> = (0..most as u32).collect();
        for nodes in self.groups.iter().flat_map(|group| &group.nodes) {
            for &node in &nodes[1..] {
                let (a, b) = (leading(&mut leader, nodes[0]), leading(&mut leader, node));
                leader[a.max(b) as usize] = a.min(b);
            }
        }
        let (mut numbers, mut count) = (vec![usize::MAX; most], 0);
        let number = |start: &u32| {
            let number = &mut numbers[leading(&mut leader, *start) as usize];
            if *number == usize::MAX {
                *number = count;
                count += 1;
            }
            *number
        };
        starts.iter().map(number).collect()
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
            self.visit_group(q, group, &mut add);
        }
    }

    #[inline(always)]
    fn visit_group(&self, q: &[f64], group: &Group<N, R, Q>, add: &mut impl FnMut(u32, &[f64; D])) {
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

    /// Summed by halves that depend on the number of groups only.
    fn energy_of(&self, q: &[f64], groups: &[Group<N, R, Q>]) -> f64 {
        if groups.len() > ROW {
            let (one, other) = groups.split_at((groups.len() / 2).next_multiple_of(ROW));
            let (one, other) = if self.division.is_whole() {
                (self.energy_of(q, one), self.energy_of(q, other))
            } else {
                side_by_side(|| self.energy_of(q, one), || self.energy_of(q, other))
            };
            return one + other;
        }
        let mut sum = Lanes::default();
        for group in groups {
            let x = Self::corners(&self.freedoms, group, q);
            for (gradients, &weight) in group.gradients.iter().zip(&group.weights) {
                let density = self.material.energy(&Self::deformation(&x, gradients));
                sum = density.multiply_add(weight, sum);
            }
        }
        sum.0.iter().sum()
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
        sink: &mut impl Sink,
    ) {
        let mut block: StencilHessian<N, D> = [[[[0.0; D]; N]; D]; N];
        for (lane, nodes) in group.nodes.iter().enumerate().take(group.filled) {
            of_lane(lanes, lane, &mut block);
            if reads_both(sink) {
                mirror(&mut block);
            }
            sink.add_vertices(&nodes.map(|node| self.freedoms.freedoms(node)), &block);
        }
    }

    /// The lower triangle of the Hessians of four elements.
    #[inline(always)]
    fn fill_hessian(
        &self,
        group: &Group<N, R, Q>,
        x: &[[Lanes; D]; N],
        hessian: &mut LaneHessian<N, D>,
    ) {
        begin::<N, D, Q>(hessian);
        for (gradients, &weight) in group.gradients.iter().zip(&group.weights) {
            let f = Self::deformation(x, gradients);
            if self.curvature == Curvature::Exact || self.material.is_semidefinite(&f) {
                let tangent = self.material.tangent(&f, weight);
                accumulate::<_, N, D, R, Q>(hessian, &tangent, gradients);
            } else {
                let tangent = self.material.semidefinite(&f, weight);
                accumulate::<_, N, D, R, Q>(hessian, &tangent, gradients);
            }
        }
        complete(hessian);
    }
}

/// Blocks `[b][a][d][c]` of four elements, a >= b: rows of node a, columns of node b.
pub(crate) type LaneHessian<const N: usize, const D: usize> = [[[[Lanes; D]; D]; N]; N];

/// Makes room for the sum over the points; a single point needs none.
#[inline(always)]
pub(crate) fn begin<const N: usize, const D: usize, const Q: usize>(
    hessian: &mut LaneHessian<N, D>,
) {
    if Q > 1 {
        *hessian = [[[[Lanes::default(); D]; D]; N]; N];
    }
}

/// Adds the lower triangle of the blocks between the nodes after the first; sets it where there is
/// only one point.
#[inline(always)]
pub(crate) fn accumulate<
    A: Tangent<Lanes, D, R>,
    const N: usize,
    const D: usize,
    const R: usize,
    const Q: usize,
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
                    if Q == 1 {
                        hessian[b][a][d][c] = block[d][c];
                    } else {
                        hessian[b][a][d][c] += block[d][c];
                    }
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

/// The matrix of one of four elements: its lower triangle, and what else is there.
#[inline(always)]
fn of_lane<const N: usize, const D: usize>(
    lanes: &LaneHessian<N, D>,
    lane: usize,
    hessian: &mut StencilHessian<N, D>,
) {
    for b in 0..N {
        for d in 0..D {
            for a in b..N {
                for c in 0..D {
                    hessian[b][d][a][c] = lanes[b][a][d][c].0[lane];
                }
            }
        }
    }
}

fn reads_both<S: Sink>(_: &S) -> bool {
    S::READS_BOTH_TRIANGLES
}

/// Fills the upper triangle from the lower one: exactly symmetric.
#[inline(always)]
fn mirror<const N: usize, const D: usize>(hessian: &mut StencilHessian<N, D>) {
    for b in 0..N {
        for d in 0..D {
            for a in 0..=b {
                for c in 0..if a == b { d } else { D } {
                    hessian[b][d][a][c] = hessian[a][c][b][d];
                }
            }
        }
    }
}

/// The leader of a node's piece; the way to it is shortened.
fn leading(leader: &mut [u32], mut node: u32) -> u32 {
    while leader[node as usize] != node {
        leader[node as usize] = leader[leader[node as usize] as usize];
        node = leader[node as usize];
    }
    node
}

/// The nodes of an element by their numbers, in whose order freedoms are numbered too: its matrix has
/// its lower triangle where the whole one has it.
struct Order<const N: usize> {
    starts: [u32; N],
    places: [usize; N],
}

impl<const N: usize> Order<N> {
    fn of<const D: usize>(nodes: &[usize; N], freedoms: &Freedoms<D>) -> Self {
        let mut places: [usize; N] = std::array::from_fn(|a| a);
        places.sort_by_key(|&a| nodes[a]);
        Order { starts: places.map(|a| freedoms.start(nodes[a])), places }
    }
}

impl<M: Material<D, R>, const N: usize, const D: usize, const R: usize, const Q: usize> Potential
    for Solid<M, N, D, R, Q>
{
    fn dim(&self) -> usize {
        self.freedoms.dim()
    }

    fn energy(&self, q: &[f64]) -> f64 {
        self.energy_of(&q[..self.freedoms.dim()], &self.groups)
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let n = self.freedoms.dim();
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

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        hessian.add_parts(&Hessians { solid: self, q: &q[..self.freedoms.dim()] });
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
    #[inline(always)]
    fn add_all<'b>(&self, groups: impl Iterator<Item = &'b Group<N, R, Q>>, sink: &mut impl Sink) {
        let mut hessian = [[[[Lanes::default(); D]; D]; N]; N];
        for group in groups {
            let x = Solid::<M, N, D, R, Q>::corners(&self.solid.freedoms, group, self.q);
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
        let groups = self.solid.division.groups(part).iter();
        self.add_all(groups.map(|&group| &self.solid.groups[group as usize]), sink);
    }

    fn visit_all(&self, sink: &mut impl Sink) {
        self.add_all(self.solid.groups.iter(), sink);
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
                    let volume = determinant(&Self::deformation(&x, gradients)).0[lane];
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
