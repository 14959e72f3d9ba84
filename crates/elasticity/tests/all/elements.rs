//! What every element must obey, with every material that it can be made of.

use nalgebra::{Rotation3, SVector, Vector3, vector};
use stationary_calculus::{
    Covector, Curvature, DenseSink, Number, Potential, SymmetricMatrix, assert_derivatives,
};
use stationary_elasticity::{
    AutomaticMaterial, Density, Elements, FixedCorotated, Freedoms, Lame, Linear, LinearSegment,
    LinearTetrahedron, LinearTriangle, Material, NeoHookean, Orthotropic, QuadraticSegment,
    QuadraticTetrahedron, QuadraticTriangle, Reference, SaintVenantKirchhoff, Solid, Weave,
};
use stationary_measure::SplitMix64;
use stationary_mesh::{
    Diagonals, Mesh, QuadraticSegments, QuadraticTetrahedra, QuadraticTriangles, cuboid, rectangle,
    segment,
};

/// What a test is told of an element: the body, and where its nodes are at rest, in its space.
trait Law {
    fn check<M, F, const N: usize, const D: usize, const R: usize, const Q: usize>(
        &mut self,
        solid: &Solid<M, N, D, R, Q>,
        rest: &[[f64; D]],
        family: F,
        invariant: bool,
    ) where
        M: Material<D, R>,
        F: Reference<N, R, Q>;
}

fn lame() -> Lame<3> {
    Lame::from_young_poisson(2.0, 0.3).unwrap()
}

fn cloth() -> Orthotropic {
    let weave = Weave { warp: 4.0, weft: 1.0, poisson: 0.3, shear: 0.4, angle: 0.3 };
    Orthotropic::new(weave).unwrap()
}

/// A material of one's own, equal to Saint Venant-Kirchhoff's in space.
#[derive(Clone, Copy)]
struct Own;

impl Density<3, 3> for Own {
    fn density<N: Number>(&self, f: [[N; 3]; 3]) -> N {
        let (mut trace, mut square) = (N::from(0.0), N::from(0.0));
        for k in 0..3 {
            for l in 0..3 {
                let gram = f[k][0] * f[l][0] + f[k][1] * f[l][1] + f[k][2] * f[l][2];
                let strain = (gram - if k == l { 1.0 } else { 0.0 }) * 0.5;
                square += strain * strain;
                if k == l {
                    trace += strain;
                }
            }
        }
        square * lame().mu() + trace * trace * (0.5 * lame().lambda())
    }
}

/// Moves the inner vertices of a structured mesh a little, so that nothing is symmetric.
fn shaken<const D: usize>(x: &SVector<f64, D>) -> SVector<f64, D> {
    let phase: f64 = x.iter().enumerate().map(|(k, x)| (2.0 + k as f64) * x).sum();
    x.map_with_location(|i, _, x| x + 0.04 * (3.0 * phase + i as f64).sin())
}

fn body<M, F, const N: usize, const D: usize, const R: usize, const Q: usize, const G: usize>(
    law: &mut impl Law,
    (family, mesh): (F, &impl Elements<G, N>),
    material: M,
    invariant: bool,
) where
    M: Material<D, R>,
    F: Reference<N, R, Q> + Copy,
{
    let freedoms = Freedoms::<D>::free(mesh.count()).unwrap();
    let solid = Solid::new(family, mesh, 0.7, material, freedoms).unwrap();
    let nodes: Vec<[f64; D]> = mesh
        .nodes()
        .iter()
        .map(|x| std::array::from_fn(|c| if c < G { x[c] } else { 0.0 }))
        .collect();
    law.check(&solid, &nodes, family, invariant);
}

fn in_space<const N: usize, F: Reference<N, 3, Q> + Copy, const Q: usize>(
    law: &mut impl Law,
    family: F,
    mesh: &impl Elements<3, N>,
) {
    let lame = lame();
    body::<_, _, N, 3, 3, Q, 3>(law, (family, mesh), SaintVenantKirchhoff::new(lame), true);
    body::<_, _, N, 3, 3, Q, 3>(law, (family, mesh), NeoHookean::new(lame).unwrap(), true);
    body::<_, _, N, 3, 3, Q, 3>(law, (family, mesh), FixedCorotated::new(lame).unwrap(), true);
    body::<_, _, N, 3, 3, Q, 3>(law, (family, mesh), Linear::new(lame), false);
}

fn in_plane<const N: usize, F: Reference<N, 2, Q> + Copy, const Q: usize>(
    law: &mut impl Law,
    family: F,
    mesh: &impl Elements<2, N>,
) {
    let lame = lame().plane_stress();
    body::<_, _, N, 2, 2, Q, 2>(law, (family, mesh), SaintVenantKirchhoff::new(lame), true);
    body::<_, _, N, 2, 2, Q, 2>(law, (family, mesh), NeoHookean::new(lame).unwrap(), true);
    body::<_, _, N, 2, 2, Q, 2>(law, (family, mesh), FixedCorotated::new(lame).unwrap(), true);
    body::<_, _, N, 2, 2, Q, 2>(law, (family, mesh), Linear::new(lame), false);
    body::<_, _, N, 2, 2, Q, 2>(law, (family, mesh), cloth(), true);
    // The same sheets in space, as membranes.
    body::<_, _, N, 3, 2, Q, 2>(law, (family, mesh), SaintVenantKirchhoff::new(lame), true);
    body::<_, _, N, 3, 2, Q, 2>(law, (family, mesh), cloth(), true);
}

fn on_lines<const N: usize, F: Reference<N, 1, Q> + Copy, const Q: usize>(
    law: &mut impl Law,
    family: F,
    mesh: &impl Elements<1, N>,
) {
    let rubber = SaintVenantKirchhoff::new(lame().uniaxial_stress());
    body::<_, _, N, 1, 1, Q, 1>(law, (family, mesh), rubber, true);
    body::<_, _, N, 2, 1, Q, 1>(law, (family, mesh), rubber, true);
    body::<_, _, N, 3, 1, Q, 1>(law, (family, mesh), rubber, true);
}

fn plane_mesh() -> Mesh<2, 3> {
    rectangle([1.0, 0.8], [2, 2], Diagonals::Alternating).unwrap().mapped(shaken).unwrap()
}

fn space_mesh() -> Mesh<3, 4> {
    cuboid([1.0, 0.8, 0.9], [1, 1, 1]).unwrap().mapped(shaken).unwrap()
}

fn line_mesh() -> Mesh<1, 2> {
    segment(vector![0.0], vector![1.5], 3).unwrap().mapped(shaken).unwrap()
}

/// Every family, curved ones too, with every material.
fn for_all(law: &mut impl Law) {
    on_lines(law, LinearSegment, &line_mesh());
    let curved = QuadraticSegments::straight(&line_mesh()).mapped(shaken).unwrap();
    on_lines(law, QuadraticSegment, &curved);
    in_plane(law, LinearTriangle, &plane_mesh());
    let curved = QuadraticTriangles::straight(&plane_mesh()).mapped(shaken).unwrap();
    in_plane(law, QuadraticTriangle, &curved);
    in_space(law, LinearTetrahedron, &space_mesh());
    let curved = QuadraticTetrahedra::straight(&space_mesh()).mapped(shaken).unwrap();
    in_space(law, QuadraticTetrahedron, &curved);
    body::<_, _, 4, 3, 3, 1, 3>(
        law,
        (LinearTetrahedron, &space_mesh()),
        AutomaticMaterial(Own),
        true,
    );
    // A membrane whose rest shape is curved in space.
    let bent = plane_mesh().mapped(|x| vector![x.x, x.y, 0.3 * x.x * x.x]).unwrap();
    let rubber = SaintVenantKirchhoff::new(lame().plane_stress());
    body::<_, _, 3, 3, 2, 1, 3>(law, (LinearTriangle, &bent), rubber, true);
}

fn moved<const D: usize>(rest: &[[f64; D]], size: f64, seed: u64) -> Vec<f64> {
    let mut random = SplitMix64::new(seed);
    rest.as_flattened().iter().map(|x| x + size * random.symmetric()).collect()
}

fn differential(potential: &impl Potential, q: &[f64]) -> Vec<f64> {
    let mut dv = vec![0.0; potential.dim()];
    potential.add_differential(q, Covector(&mut dv));
    dv
}

fn largest(numbers: &[f64]) -> f64 {
    numbers.iter().fold(0.0, |largest, x| x.abs().max(largest))
}

struct Derivatives(usize);

impl Law for Derivatives {
    fn check<M, F, const N: usize, const D: usize, const R: usize, const Q: usize>(
        &mut self,
        solid: &Solid<M, N, D, R, Q>,
        rest: &[[f64; D]],
        _family: F,
        _invariant: bool,
    ) where
        M: Material<D, R>,
        F: Reference<N, R, Q>,
    {
        self.0 += 1;
        assert_derivatives(solid, &moved(rest, 0.05, 1));
    }
}

#[test]
fn differentials_and_hessians_are_derivatives() {
    let mut law = Derivatives(0);
    for_all(&mut law);
    assert_eq!(law.0, 30);
}

struct RigidMotions;

/// The positions after a turn about an axis that suits the dimension, and a shift.
fn rigidly<const D: usize>(rest: &[[f64; D]], turn: [f64; 3]) -> Vec<f64> {
    let turn = match D {
        1 => [0.0; 3],
        2 => [0.0, 0.0, turn[2]],
        _ => turn,
    };
    let rotation = Rotation3::new(Vector3::from(turn));
    let place = |x: &[f64; D]| -> [f64; D] {
        let x = rotation * Vector3::from_fn(|c, _| if c < D { x[c] } else { 0.0 });
        std::array::from_fn(|c| x[c] + 3.0 + c as f64)
    };
    rest.iter().flat_map(place).collect()
}

impl Law for RigidMotions {
    fn check<M, F, const N: usize, const D: usize, const R: usize, const Q: usize>(
        &mut self,
        solid: &Solid<M, N, D, R, Q>,
        rest: &[[f64; D]],
        _family: F,
        invariant: bool,
    ) where
        M: Material<D, R>,
        F: Reference<N, R, Q>,
    {
        let turn = if invariant { [0.8, -1.1, 2.3] } else { [0.0; 3] };
        let q = rigidly(rest, turn);
        assert!(solid.energy(&q).abs() < 1e-14, "{}", solid.energy(&q));
        assert!(largest(&differential(solid, &q)) < 3e-14);
    }
}

#[test]
fn rigid_motions_have_neither_energy_nor_force() {
    for_all(&mut RigidMotions);
}

struct FrameInvariance;

impl Law for FrameInvariance {
    fn check<M, F, const N: usize, const D: usize, const R: usize, const Q: usize>(
        &mut self,
        solid: &Solid<M, N, D, R, Q>,
        rest: &[[f64; D]],
        _family: F,
        invariant: bool,
    ) where
        M: Material<D, R>,
        F: Reference<N, R, Q>,
    {
        let q = moved(rest, 0.05, 7);
        let turn = if invariant { [1.8, 0.1, -2.0] } else { [0.0; 3] };
        let turned = rigidly(q.as_chunks::<D>().0, turn);
        let (a, b) = (solid.energy(&q), solid.energy(&turned));
        assert!((a - b).abs() < 1e-13 * (1.0 + a), "{a} {b}");
        let (f, g) = (differential(solid, &q), differential(solid, &turned));
        let back = rigidly(f.as_chunks::<D>().0, turn);
        for (c, (back, g)) in back.iter().zip(&g).enumerate() {
            assert!((back - 3.0 - (c % D) as f64 - g).abs() < 2e-13);
        }
        // The forces of a body on itself add up to nothing, to the last bits.
        for c in 0..D {
            assert!(f.iter().skip(c).step_by(D).sum::<f64>().abs() < 1e-15 * (f.len() as f64));
        }
    }
}

#[test]
fn forces_turn_with_the_body() {
    for_all(&mut FrameInvariance);
}

struct PatchTest;

impl Law for PatchTest {
    /// Uniform strain everywhere: the inner nodes feel no force, and the energy is W times the
    /// size.
    fn check<M, F, const N: usize, const D: usize, const R: usize, const Q: usize>(
        &mut self,
        solid: &Solid<M, N, D, R, Q>,
        rest: &[[f64; D]],
        _family: F,
        _invariant: bool,
    ) where
        M: Material<D, R>,
        F: Reference<N, R, Q>,
    {
        let f: [[f64; D]; D] = std::array::from_fn(|k| {
            std::array::from_fn(|i| f64::from(i == k) + 0.1 * ((3 * k + i + 1) as f64).sin())
        });
        let image = |x: &[f64; D]| -> [f64; D] {
            std::array::from_fn(|i| (0..D).map(|k| f[k][i] * x[k]).sum())
        };
        let q: Vec<f64> = rest.iter().flat_map(image).collect();
        let dv = differential(solid, &q);
        let inner = inner_nodes(rest);
        for &node in &inner {
            assert!(largest(&dv[D * node..D * (node + 1)]) < 3e-15, "{node}: {dv:?}");
        }
    }
}

/// The middles of the meshes above are the only nodes far from their boundary.
fn inner_nodes<const D: usize>(rest: &[[f64; D]]) -> Vec<usize> {
    let size = [[1.5, 0.0, 0.0], [1.0, 0.8, 0.0], [1.0, 0.8, 0.9]][D - 1];
    let inside = |x: &[f64; D]| (0..D).all(|c| x[c] > 0.15 && x[c] < size[c] - 0.15);
    (0..rest.len()).filter(|&node| inside(&rest[node])).collect()
}

fn patch<M, F, const N: usize, const D: usize, const R: usize, const Q: usize>(
    family: F,
    mesh: &impl Elements<D, N>,
    material: M,
) where
    M: Material<D, R>,
    F: Reference<N, R, Q> + Copy,
{
    let freedoms = Freedoms::<D>::free(mesh.count()).unwrap();
    let solid = Solid::new(family, mesh, 1.0, material, freedoms).unwrap();
    assert!(!inner_nodes(&mesh.nodes()).is_empty());
    PatchTest.check(&solid, &mesh.nodes(), family, true);
}

#[test]
fn uniform_strain_leaves_inner_nodes_alone() {
    let space = cuboid([1.0, 0.8, 0.9], [3, 3, 3]).unwrap().mapped(shaken).unwrap();
    let plane = rectangle([1.0, 0.8], [4, 4], Diagonals::Alternating).unwrap();
    let plane = plane.mapped(shaken).unwrap();
    let lame = lame();
    let sheet = lame.plane_stress();
    let curved_plane = QuadraticTriangles::straight(&plane).mapped(shaken).unwrap();
    let bar = SaintVenantKirchhoff::new(lame.uniaxial_stress());
    patch(LinearSegment, &line_mesh(), bar);
    patch(
        QuadraticSegment,
        &QuadraticSegments::straight(&line_mesh()).mapped(shaken).unwrap(),
        bar,
    );
    patch(LinearTriangle, &plane, SaintVenantKirchhoff::new(sheet));
    patch(LinearTriangle, &plane, NeoHookean::new(sheet).unwrap());
    patch(LinearTriangle, &plane, FixedCorotated::new(sheet).unwrap());
    patch(LinearTriangle, &plane, Linear::new(sheet));
    patch(LinearTriangle, &plane, cloth());
    patch(QuadraticTriangle, &curved_plane, SaintVenantKirchhoff::new(sheet));
    patch(QuadraticTriangle, &curved_plane, NeoHookean::new(sheet).unwrap());
    patch(QuadraticTriangle, &curved_plane, FixedCorotated::new(sheet).unwrap());
    patch(QuadraticTriangle, &curved_plane, Linear::new(sheet));
    patch(QuadraticTriangle, &curved_plane, cloth());
    patch(LinearTetrahedron, &space, SaintVenantKirchhoff::new(lame));
    patch(LinearTetrahedron, &space, NeoHookean::new(lame).unwrap());
    patch(LinearTetrahedron, &space, FixedCorotated::new(lame).unwrap());
    patch(LinearTetrahedron, &space, Linear::new(lame));
    patch(LinearTetrahedron, &space, AutomaticMaterial(Own));
    // Straight edges in space: a curved one has a Jacobian of degree three, beyond the four points.
    let straight = QuadraticTetrahedra::straight(&space);
    patch(QuadraticTetrahedron, &straight, SaintVenantKirchhoff::new(lame));
    patch(QuadraticTetrahedron, &straight, NeoHookean::new(lame).unwrap());
    patch(QuadraticTetrahedron, &straight, FixedCorotated::new(lame).unwrap());
    patch(QuadraticTetrahedron, &straight, Linear::new(lame));
}

#[test]
fn elements_of_ones_own_density_are_the_closed_ones() {
    let mesh = space_mesh();
    let freedoms = Freedoms::<3>::free(mesh.count()).unwrap();
    let rubber = SaintVenantKirchhoff::new(lame());
    let closed = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms.clone()).unwrap();
    let own = AutomaticMaterial(Own);
    let own = Solid::new(LinearTetrahedron, &mesh, 1.0, own, freedoms).unwrap();
    for curvature in [Curvature::Exact, Curvature::Semidefinite] {
        let (closed, own) =
            (closed.clone().with_curvature(curvature), own.clone().with_curvature(curvature));
        let q: Vec<f64> = moved(&mesh.nodes(), 0.2, 3).iter().map(|x| 0.8 * x).collect();
        assert!((closed.energy(&q) - own.energy(&q)).abs() < 1e-14);
        let (a, b) = (dense(&closed, &q), dense(&own, &q));
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-13));
    }
}

fn dense(potential: &impl Potential, q: &[f64]) -> Vec<f64> {
    let n = potential.dim();
    let mut values = vec![0.0; n * n];
    potential.add_hessian(q, &mut DenseSink::new(1.0, n, &mut values).unwrap());
    values
}

struct Semidefinite(usize);

impl Law for Semidefinite {
    fn check<M, F, const N: usize, const D: usize, const R: usize, const Q: usize>(
        &mut self,
        solid: &Solid<M, N, D, R, Q>,
        rest: &[[f64; D]],
        _family: F,
        _invariant: bool,
    ) where
        M: Material<D, R>,
        F: Reference<N, R, Q>,
    {
        let n = solid.dim();
        let projected = solid.clone().with_curvature(Curvature::Semidefinite);
        for (seed, shrink) in [(1, 1.02), (2, 0.7), (3, 0.4)] {
            let q: Vec<f64> = moved(rest, 0.1, seed).iter().map(|x| shrink * x).collect();
            let matrix = nalgebra::DMatrix::from_vec(n, n, dense(&projected, &q));
            assert_eq!(matrix, matrix.transpose());
            let least = matrix.symmetric_eigenvalues().min();
            assert!(least > -1e-12, "{least}");
            let exact = nalgebra::DMatrix::from_vec(n, n, dense(solid, &q));
            if exact.symmetric_eigenvalues().min() < -1e-3 {
                self.0 += 1;
            }
        }
    }
}

#[test]
fn projected_hessians_are_positive_semidefinite_where_exact_ones_are_not() {
    let mut law = Semidefinite(0);
    for_all(&mut law);
    assert!(law.0 > 30, "{}", law.0);
}

#[test]
fn held_coordinates_leave_the_derivatives_of_the_others() {
    use stationary_elasticity::Held;
    let mesh = space_mesh();
    let held: Vec<Held> = [(0, 0), (0, 1), (0, 2), (3, 1), (5, 0), (5, 2)]
        .map(|(vertex, component)| Held { vertex, component, place: 0.1 * component as f64 })
        .to_vec();
    let freedoms = Freedoms::new(mesh.count(), &held).unwrap();
    let free = Freedoms::<3>::free(mesh.count()).unwrap();
    let rubber = SaintVenantKirchhoff::new(lame());
    let solid = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms.clone()).unwrap();
    let all = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, free).unwrap();
    let q = freedoms.gathered(moved(&mesh.nodes(), 0.05, 5).as_chunks::<3>().0).unwrap();
    assert_derivatives(&solid, &q);
    let positions = freedoms.positions(&q).unwrap();
    let whole = positions.as_flattened();
    assert_eq!(solid.energy(&q), all.energy(whole));
    let dv = differential(&all, whole);
    assert_eq!(freedoms.gathered(dv.as_chunks::<3>().0).unwrap(), differential(&solid, &q));
    let reactions = solid.held_differential(&q).unwrap();
    for (held, reaction) in held.iter().zip(reactions) {
        assert_eq!(reaction, dv[3 * held.vertex + held.component]);
    }
    // A state with more freedoms than the body's is none of its business.
    let longer = [&q[..], &[f64::NAN; 5]].concat();
    assert_eq!(solid.energy(&longer), solid.energy(&q));
    assert!(SymmetricMatrix::hessian(&solid, &q).is_ok());
}

#[test]
fn elements_that_turned_inside_out_are_named() {
    let mesh = cuboid([3.0, 1.0, 1.0], [3, 1, 1]).unwrap();
    let freedoms = Freedoms::<3>::free(mesh.count()).unwrap();
    let rubber = NeoHookean::new(lame()).unwrap();
    let solid = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms).unwrap();
    let mut nodes = mesh.nodes();
    assert_eq!(solid.inverted(nodes.as_flattened()).unwrap(), []);
    // The vertices of the end face are pushed through the one before it.
    nodes.iter_mut().filter(|x| x[0] == 3.0).for_each(|x| x[0] = 1.5);
    let inverted = solid.inverted(nodes.as_flattened()).unwrap();
    let expected: Vec<usize> = (0..mesh.simplices().len())
        .filter(|&e| mesh.corners(&mesh.simplices()[e]).iter().any(|x| x.x == 3.0))
        .collect();
    assert_eq!(inverted, expected);
    assert!(solid.energy(nodes.as_flattened()).is_finite());
}
