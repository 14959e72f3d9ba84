//! Masses, loads, damping, bending and statics of whole bodies.

use nalgebra::{Vector3, vector};
use proptest::prelude::*;
use stationary_calculus::{
    ConjugateGradient, Covector, Curvature, DenseSink, Force, Metric, Newton, Ordering, Potential,
    Stencils, Vector, assert_derivatives,
};
use stationary_elasticity::{
    DeadLoad, ElasticityError, Elements, Freedoms, Held, Hinge, Lame, Linear, LinearSegment,
    LinearTetrahedron, LinearTriangle, Material, NeoHookean, QuadraticSegment,
    QuadraticTetrahedron, QuadraticTriangle, Rayleigh, Reference, SaintVenantKirchhoff, Solid,
    Solves, Statics, StrainRate, averaged_stress, cauchy, galerkin_mass, hinges, lumped_mass,
};
use stationary_mesh::{
    Diagonals, Mesh, QuadraticTetrahedra, QuadraticTriangles, bar, cuboid, curved_disc, rectangle,
};

fn lame() -> Lame<3> {
    Lame::from_young_poisson(2e4, 0.3).unwrap()
}

/// Total mass along each direction and first moment about the origin, of both masses.
fn moments<F, const N: usize, const D: usize, const Q: usize>(
    family: F,
    mesh: &impl Elements<D, N>,
) -> [[f64; 2]; 2]
where
    F: Reference<N, D, Q> + Copy,
{
    let freedoms = Freedoms::<D>::free(mesh.count()).unwrap();
    let galerkin = galerkin_mass(family, mesh, [3.0, 0.5], &freedoms).unwrap();
    let lumped = lumped_mass(family, mesh, [3.0, 0.5], &freedoms).unwrap();
    let along: Vec<f64> = (0..D * mesh.count()).map(|i| f64::from(i % D == 0)).collect();
    let places: Vec<f64> = mesh
        .nodes()
        .iter()
        .flat_map(|x| std::array::from_fn::<_, D, _>(|c| if c == 0 { x[0] } else { 0.0 }))
        .collect();
    let (along, places) = (Vector(&along[..]), Vector(&places[..]));
    [
        [galerkin.inner(along, along), galerkin.inner(along, places)],
        [lumped.inner(along, along), lumped.inner(along, places)],
    ]
}

#[test]
fn both_masses_have_the_bodys_mass_and_centre() {
    let space = cuboid([2.0, 1.0, 1.0], [2, 1, 1]).unwrap();
    let plane = rectangle([2.0, 1.0], [2, 2], Diagonals::Alternating).unwrap();
    let all = [
        (moments(LinearTetrahedron, &space), 2.0),
        (moments(QuadraticTetrahedron, &QuadraticTetrahedra::straight(&space)), 2.0),
        (moments(LinearTriangle, &plane), 2.0),
        (moments(QuadraticTriangle, &QuadraticTriangles::straight(&plane)), 2.0),
        (moments(LinearSegment, &bar(2.0, 3).unwrap()), 2.0),
    ];
    for ([galerkin, lumped], size) in all {
        for [mass, first] in [galerkin, lumped] {
            assert!((mass - 1.5 * size).abs() < 1e-13, "{mass}");
            assert!((first - 1.5 * size).abs() < 1e-13, "{first}");
        }
    }
    // A curved disc has its own area, and still its centre.
    let disc = curved_disc(1.0, 3).unwrap();
    let [galerkin, lumped] = moments(QuadraticTriangle, &disc);
    assert!((galerkin[0] - 1.5 * disc.measure()).abs() < 1e-13);
    assert!((lumped[0] - galerkin[0]).abs() < 1e-13 && lumped[1].abs() < 1e-13);
}

#[test]
fn a_triangle_and_a_tetrahedron_have_the_masses_of_the_errata() {
    let triangle =
        Mesh::new(vec![vector![0.0, 0.0], vector![1.0, 0.0], vector![0.3, 2.0]], vec![[0, 1, 2]])
            .unwrap();
    let tetrahedron = Mesh::new(
        vec![Vector3::zeros(), Vector3::x(), Vector3::y(), vector![0.1, 0.2, 3.0]],
        vec![[0, 1, 2, 3]],
    )
    .unwrap();
    let mut matrix = [0.0; 36];
    let freedoms = Freedoms::<2>::free(3).unwrap();
    let mass = galerkin_mass(LinearTriangle, &triangle, [12.0, 1.0], &freedoms).unwrap();
    mass.add_matrix(&mut DenseSink::new(1.0, 6, &mut matrix).unwrap());
    assert!((matrix[0] - 2.0).abs() < 1e-14 && (matrix[2] - 1.0).abs() < 1e-14 && matrix[1] == 0.0);
    let mut matrix = [0.0; 144];
    let freedoms = Freedoms::<3>::free(4).unwrap();
    let mass = galerkin_mass(LinearTetrahedron, &tetrahedron, [40.0, 1.0], &freedoms).unwrap();
    mass.add_matrix(&mut DenseSink::new(1.0, 12, &mut matrix).unwrap());
    assert!((matrix[0] - 2.0).abs() < 1e-14 && (matrix[3] - 1.0).abs() < 1e-14);
    let lumped = lumped_mass(LinearTetrahedron, &tetrahedron, [40.0, 1.0], &freedoms).unwrap();
    assert!(lumped.masses().iter().all(|m| (m - 5.0).abs() < 1e-14));
}

/// A bar of cells along x, its left end held, with the boundary of its right end.
struct Clamped {
    mesh: Mesh<3, 4>,
    freedoms: Freedoms<3>,
}

fn clamped(cells: usize) -> Clamped {
    let mesh = cuboid([2.0, 1.0, 1.0], [2 * cells, cells, cells]).unwrap();
    let held: Vec<Held> = (0..mesh.count())
        .filter(|&vertex| mesh.vertices()[vertex].x == 0.0)
        .flat_map(|vertex| {
            let x = mesh.vertices()[vertex];
            // Free to thin, but neither to shift nor to turn.
            let all = [true, x.y == 0.0, x.z == 0.0];
            (0..3).filter(move |&c| all[c]).map(move |component| Held {
                vertex,
                component,
                place: x[component],
            })
        })
        .collect();
    let freedoms = Freedoms::new(mesh.count(), &held).unwrap();
    Clamped { mesh, freedoms }
}

fn end_face(mesh: &Mesh<3, 4>) -> Mesh<3, 3> {
    let facets = mesh.boundary_facets();
    let at_end = |facet: &[usize; 3]| facet.iter().all(|&v| mesh.vertices()[v].x == 2.0);
    Mesh::new(mesh.vertices().to_vec(), facets.into_iter().filter(at_end).collect()).unwrap()
}

#[test]
fn a_pulled_bar_stretches_uniformly_and_its_support_pulls_back() {
    let Clamped { mesh, freedoms } = clamped(2);
    let pull = 3e3;
    let load = DeadLoad::traction(LinearTriangle, &end_face(&mesh), 1.0, &freedoms, |_, n| {
        assert_eq!(*n, [1.0, 0.0, 0.0]);
        n.map(|n| pull * n)
    })
    .unwrap();
    let metric = lumped_mass(LinearTetrahedron, &mesh, [1e3, 1.0], &freedoms).unwrap();
    let rubber = SaintVenantKirchhoff::new(lame());
    let mut solid = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms.clone()).unwrap();
    let mut q = freedoms.gathered(&mesh.nodes()).unwrap();
    let statics = Statics { steps: 3, ..Statics::default() };
    let places = freedoms.places().to_vec();
    let rest = statics.solve(&mut solid, &load, &metric, &places, &mut q).unwrap();
    let positions = freedoms.positions(&q).unwrap();
    // Uniaxial: E s (s^2 - 1)/2 = pull per area at rest.
    let stretch = positions.iter().map(|x| x[0]).fold(0.0, f64::max) / 2.0;
    let force = 2e4 * stretch * 0.5 * (stretch * stretch - 1.0);
    assert!((force / pull - 1.0).abs() < 1e-12, "{stretch}");
    let thinned = positions.iter().map(|x| x[1]).fold(0.0, f64::max);
    let expected = (1.0 - 0.3 * (stretch * stretch - 1.0)).sqrt();
    assert!((thinned - expected).abs() < 1e-12);
    let along: f64 = freedoms
        .held()
        .iter()
        .zip(&rest.reactions)
        .filter(|((_, component), _)| *component == 0)
        .map(|(_, force)| force)
        .sum();
    assert!((along + pull).abs() < 1e-8, "{along}");
    // Stress: the pull over the area that is left.
    let stress = averaged_stress(LinearTetrahedron, &mesh, &rubber, &positions).unwrap();
    for sigma in stress {
        assert!((sigma[0][0] * thinned * thinned / pull - 1.0).abs() < 1e-11);
        assert!(sigma[1][1].abs() < 1e-8 && sigma[0][1].abs() < 1e-8);
    }
    assert!(rest.iterations() < 20 && rest.steps.len() == 3);
}

#[test]
fn supports_that_move_carry_the_body_along() {
    let Clamped { mesh, freedoms } = clamped(1);
    let metric = lumped_mass(LinearTetrahedron, &mesh, [1e3, 1.0], &freedoms).unwrap();
    let rubber = NeoHookean::new(lame()).unwrap();
    let mut solid = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms.clone()).unwrap();
    let none = DeadLoad::new(&freedoms, vec![[0.0; 3]; mesh.count()]).unwrap();
    let mut q = freedoms.gathered(&mesh.nodes()).unwrap();
    let moved: Vec<f64> = freedoms.places().iter().map(|place| place + 0.25).collect();
    let statics = Statics { steps: 2, ..Statics::default() };
    let rest = statics.solve(&mut solid, &none, &metric, &moved, &mut q).unwrap();
    for (x, rest) in solid.freedoms().positions(&q).unwrap().iter().zip(mesh.nodes()) {
        assert!((0..3).all(|c| (x[c] - rest[c] - 0.25).abs() < 1e-12));
    }
    assert!(rest.reactions.iter().all(|f| f.abs() < 1e-8));
}

#[test]
fn a_weight_is_borne_by_the_supports() {
    let Clamped { mesh, freedoms } = clamped(2);
    let metric = lumped_mass(LinearTetrahedron, &mesh, [1.0, 1.0], &freedoms).unwrap();
    let mut solid =
        Solid::new(LinearTetrahedron, &mesh, 1.0, Linear::new(lame()), freedoms.clone()).unwrap();
    let weight =
        DeadLoad::body(LinearTetrahedron, &mesh, 1.0, &freedoms, |_| [0.0, 0.0, -9.81]).unwrap();
    let mut q = freedoms.gathered(&mesh.nodes()).unwrap();
    let before = q.clone();
    let places = freedoms.places().to_vec();
    let rest = Statics::default().solve(&mut solid, &weight, &metric, &places, &mut q).unwrap();
    let up: f64 = freedoms
        .held()
        .iter()
        .zip(&rest.reactions)
        .filter(|((_, c), _)| *c == 2)
        .map(|(_, f)| f)
        .sum();
    assert!((up - 2.0 * 9.81).abs() < 1e-9, "{up}");
    assert_ne!(q, before);
    let double = weight.plus(&weight).unwrap();
    assert_eq!(double, weight.scaled(2.0));
    assert_derivatives(&(&solid, &weight), &q);
}

#[test]
fn bodies_that_may_move_as_a_whole_are_refused_by_name() {
    let mesh = cuboid([1.0, 1.0, 1.0], [1, 1, 1]).unwrap();
    let hold = |held: &[(usize, usize)]| {
        let held: Vec<Held> = held
            .iter()
            .map(|&(vertex, component)| Held {
                vertex,
                component,
                place: mesh.vertices()[vertex][component],
            })
            .collect();
        let freedoms = Freedoms::<3>::new(mesh.count(), &held).unwrap();
        let metric = lumped_mass(LinearTetrahedron, &mesh, [1.0, 1.0], &freedoms).unwrap();
        let rubber = SaintVenantKirchhoff::new(lame());
        let mut solid =
            Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms.clone()).unwrap();
        let none = DeadLoad::new(&freedoms, vec![[0.0; 3]; mesh.count()]).unwrap();
        let mut q = freedoms.gathered(&mesh.nodes()).unwrap();
        let places = freedoms.places().to_vec();
        Statics::default().solve(&mut solid, &none, &metric, &places, &mut q).unwrap_err()
    };
    let ElasticityError::RigidMotions { count, names, .. } = hold(&[]) else { panic!() };
    assert_eq!((count, names.split(", ").count()), (6, 6));
    let corner = (0..8).find(|&v| mesh.vertices()[v] == Vector3::zeros()).unwrap();
    let along = (0..8).find(|&v| mesh.vertices()[v] == Vector3::x()).unwrap();
    let pinned = [(corner, 0), (corner, 1), (corner, 2), (along, 1), (along, 2)];
    let error = hold(&pinned);
    // It still turns about the edge along x, which is no axis through the middle.
    assert_eq!(error.to_string(), "1 rigid motions are free: others that are not along an axis");
    let floor: Vec<(usize, usize)> =
        (0..8).filter(|&v| mesh.vertices()[v].z == 0.0).map(|v| (v, 2)).collect();
    let error = hold(&floor).to_string();
    assert_eq!(error, "3 rigid motions are free: translation x, translation y, rotation about z");
}

#[test]
fn a_load_without_an_equilibrium_is_an_error_that_changes_nothing() {
    let Clamped { mesh, freedoms } = clamped(1);
    let metric = lumped_mass(LinearTetrahedron, &mesh, [1.0, 1.0], &freedoms).unwrap();
    let rubber = SaintVenantKirchhoff::new(lame());
    let mut solid = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms.clone()).unwrap();
    let load =
        DeadLoad::body(LinearTetrahedron, &mesh, 1.0, &freedoms, |_| [1e9, 0.0, 0.0]).unwrap();
    let mut q = freedoms.gathered(&mesh.nodes()).unwrap();
    let (before, places) = (q.clone(), freedoms.places().to_vec());
    let moved: Vec<f64> = places.iter().map(|p| p + 1.0).collect();
    let newton = Newton { iterations: 2, tolerance: 0.0 };
    let hasty = Statics { newton, ..Statics::default() };
    let error = hasty.solve(&mut solid, &load, &metric, &moved, &mut q).unwrap_err();
    assert!(matches!(error, ElasticityError::Statics { step: 1, steps: 1, .. }), "{error}");
    assert_eq!((q, solid.freedoms().places().to_vec()), (before, places.clone()));
    let none = Statics { steps: 0, ..hasty };
    let mut q = freedoms.gathered(&mesh.nodes()).unwrap();
    let error = none.solve(&mut solid, &load, &metric, &places, &mut q).unwrap_err();
    assert_eq!(error, ElasticityError::NoSteps);
}

#[test]
fn bad_bodies_are_refused_and_their_elements_listed() {
    let rubber = SaintVenantKirchhoff::new(lame().plane_stress());
    let vertices = vec![vector![0.0, 0.0], vector![1.0, 0.0], vector![0.0, 1.0], vector![2.0, 0.0]];
    let solid = |triangles: Vec<[usize; 3]>, section| {
        let mesh = Mesh::new(vertices.clone(), triangles).unwrap();
        let freedoms = Freedoms::<2>::free(4).unwrap();
        Solid::new(LinearTriangle, &mesh, section, rubber, freedoms).map(|_| ())
    };
    let error = solid(vec![[0, 1, 2], [0, 2, 1], [1, 2, 3], [2, 1, 3]], 1.0).unwrap_err();
    assert_eq!(error.to_string(), "simplices turned inside out: 1, 2");
    let error = solid(vec![[0, 1, 2], [0, 1, 3]], 1.0).unwrap_err();
    assert_eq!(error.to_string(), "simplices of no size: 1");
    for section in [0.0, -1.0, f64::NAN] {
        assert!(matches!(solid(vec![[0, 1, 2]], section), Err(ElasticityError::Section(_))));
    }
    let mesh = Mesh::new(vertices.clone(), vec![[0, 1, 2]]).unwrap();
    let freedoms = Freedoms::<2>::free(4).unwrap();
    let error = lumped_mass(LinearTriangle, &mesh, [1.0, 1.0], &freedoms).unwrap_err();
    assert_eq!(error.to_string(), "vertices that no element names: 3");
    let error = galerkin_mass(LinearTriangle, &mesh, [0.0, 1.0], &freedoms).unwrap_err();
    assert_eq!(error, ElasticityError::Density(0.0));
    let few = Freedoms::<2>::free(3).unwrap();
    let error = Solid::new(LinearTriangle, &mesh, 1.0, rubber, few).unwrap_err();
    assert_eq!(error, ElasticityError::Vertices { expected: 3, got: 4 });
    let error = DeadLoad::new(&freedoms, vec![[0.0, f64::NAN]; 4]).unwrap_err();
    assert_eq!(error, ElasticityError::Load { vertex: 0 });
}

#[test]
fn a_pressure_on_a_curved_edge_pulls_along_its_normal() {
    // The boundary of a disc, seen counterclockwise: outward normals, which add up to nothing, and
    // with the place to twice the area.
    let disc = curved_disc(1.0, 3).unwrap();
    let nodes = disc.nodes().to_vec();
    let corners =
        Mesh::new(nodes.clone(), disc.elements().iter().map(|e| [e[0], e[1], e[2]]).collect())
            .unwrap();
    let middle = |a: usize, b: usize| {
        disc.elements()
            .iter()
            .flat_map(|e| [([e[0], e[1]], e[3]), ([e[1], e[2]], e[4]), ([e[2], e[0]], e[5])])
            .find(|(ends, _)| *ends == [a, b])
            .unwrap()
            .1
    };
    let edges = corners.boundary_facets().into_iter().map(|[a, b]| [a, b, middle(a, b)]).collect();
    let rim = stationary_mesh::QuadraticSegments::new(nodes, edges).unwrap();
    let freedoms = Freedoms::<2>::free(rim.count()).unwrap();
    let load = DeadLoad::traction(QuadraticSegment, &rim, 0.5, &freedoms, |_, n| *n).unwrap();
    let sum = |c: usize| load.forces().iter().map(|f| f[c]).sum::<f64>();
    assert!(sum(0).abs() < 1e-14 && sum(1).abs() < 1e-14);
    let work: f64 =
        load.forces().iter().zip(rim.nodes()).map(|(f, x)| f[0] * x.x + f[1] * x.y).sum();
    assert!((work - 0.5 * 2.0 * disc.measure()).abs() < 1e-13, "{work}");
}

fn cube() -> (Mesh<3, 4>, Solid<SaintVenantKirchhoff<3>, 4, 3, 3, 1>) {
    let mesh = cuboid([1.0, 1.0, 1.0], [1, 1, 1]).unwrap();
    let freedoms = Freedoms::<3>::free(8).unwrap();
    let solid =
        Solid::new(LinearTetrahedron, &mesh, 1.0, SaintVenantKirchhoff::new(lame()), freedoms);
    (mesh, solid.unwrap())
}

fn force(damping: &impl Force, q: &[f64], v: &[f64]) -> Vec<f64> {
    let mut f = vec![0.0; q.len()];
    damping.add_force(0.0, q, Vector(v), Covector(&mut f));
    f
}

proptest! {
    #[test]
    fn strain_rate_damping_takes_power_and_its_matrix_is_its_derivative(seed in 0_u64..1000) {
        let (mesh, solid) = cube();
        let damping = StrainRate::new(&solid, Lame::new(0.3, 2.0).unwrap()).unwrap();
        let mut random = stationary_calculus::SplitMix64::new(seed);
        let q: Vec<f64> =
            mesh.nodes().as_flattened().iter().map(|x| x + 0.2 * random.symmetric()).collect();
        let v: Vec<f64> = q.iter().map(|_| random.symmetric()).collect();
        let f = force(&damping, &q, &v);
        let power = Covector(&f[..]).apply(&Vector(&v[..]));
        prop_assert!(power < 0.0);
        let mut matrix = vec![0.0; 24 * 24];
        let mut sink = DenseSink::new(1.0, 24, &mut matrix).unwrap();
        damping.add_damping(0.0, &q, Vector(&v), &mut sink);
        for i in 0..24 {
            let row: f64 = (0..24).map(|j| matrix[i + 24 * j] * v[j]).sum();
            prop_assert!((row + f[i]).abs() < 1e-12, "{} {}", row, f[i]);
        }
    }

    #[test]
    fn rigid_motion_is_not_damped(w in prop::array::uniform3(-2.0..2.0_f64), seed in 0_u64..1000) {
        let (mesh, solid) = cube();
        let damping = StrainRate::new(&solid, Lame::new(0.3, 2.0).unwrap()).unwrap();
        let mut random = stationary_calculus::SplitMix64::new(seed);
        let q: Vec<f64> =
            mesh.nodes().as_flattened().iter().map(|x| x + 0.2 * random.symmetric()).collect();
        let v: Vec<f64> = q
            .as_chunks::<3>()
            .0
            .iter()
            .flat_map(|x| {
                let turning = Vector3::from(w).cross(&Vector3::from(*x));
                [turning.x + 1.0, turning.y - 2.0, turning.z]
            })
            .collect();
        prop_assert!(force(&damping, &q, &v).iter().all(|f| f.abs() < 1e-13));
    }
}

#[test]
fn rayleigh_damping_is_mass_and_stiffness_times_the_velocity() {
    let (mesh, solid) = cube();
    let metric = lumped_mass(LinearTetrahedron, &mesh, [6.0, 1.0], solid.freedoms()).unwrap();
    let stiffness = solid.with_curvature(Curvature::Semidefinite);
    let q: Vec<f64> = mesh.nodes().as_flattened().iter().map(|x| 0.9 * x).collect();
    let v: Vec<f64> = (0..24).map(|i| (i as f64).sin()).collect();
    let drag = Rayleigh::new([2.0, 0.0], metric.clone(), &stiffness).unwrap();
    for ((f, v), m) in force(&drag, &q, &v).iter().zip(&v).zip(metric.masses()) {
        assert!((f + 2.0 * m * v).abs() < 1e-14);
    }
    let damping = Rayleigh::new([2.0, 1e-3], metric.clone(), &stiffness).unwrap();
    let f = force(&damping, &q, &v);
    assert!(Covector(&f[..]).apply(&Vector(&v[..])) < 0.0);
    let mut matrix = vec![0.0; 24 * 24];
    damping.add_damping(0.0, &q, Vector(&v), &mut DenseSink::new(1.0, 24, &mut matrix).unwrap());
    for i in 0..24 {
        let row: f64 = (0..24).map(|j| matrix[i + 24 * j] * v[j]).sum();
        assert!((row + f[i]).abs() < 1e-10);
    }
    for bad in [[-1.0, 0.0], [0.0, f64::NAN]] {
        assert!(Rayleigh::new(bad, metric.clone(), &stiffness).is_err());
    }
}

/// Two triangles, the second turned up by an angle.
fn folded(angle: f64) -> [[f64; 3]; 4] {
    [[0.0, 0.0, 0.0], [0.0, 2.0, 0.0], [-1.0, 0.5, 0.0], [angle.cos(), 1.2, angle.sin()]]
}

#[test]
fn a_hinge_measures_its_fold_with_its_sign() {
    for angle in [-3.0, -1.0, -1e-9, 0.0, 1e-9, 0.5, 2.0, 3.1] {
        let measured = Hinge::angle(&folded(angle));
        assert!((measured.abs() - f64::abs(angle)).abs() < 1e-15, "{angle}: {measured}");
        assert!((measured + Hinge::angle(&folded(-angle))).abs() < 1e-15);
    }
    assert!(Hinge::new([0, 1, 2, 3], &folded(0.0), -1.0).is_err());
    let flat = [[0.0; 3], [0.0, 2.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.5, 0.0]];
    assert!(Hinge::new([0, 1, 2, 3], &flat, 1.0).is_err());
}

#[test]
fn the_differential_and_hessian_of_hinges_are_derivatives() {
    for angle in [-2.0, 0.0, 0.7] {
        let hinge = Hinge::new([0, 1, 2, 3], &folded(0.3), 2.0).unwrap();
        let fold = Stencils::new(4, Vec::new(), vec![hinge]).unwrap();
        assert_derivatives(&fold, folded(angle).as_flattened());
        let q = folded(angle);
        let mut matrix = vec![0.0; 144];
        let projected = fold.with_curvature(Curvature::Semidefinite);
        projected.add_hessian(q.as_flattened(), &mut DenseSink::new(1.0, 12, &mut matrix).unwrap());
        let matrix = nalgebra::DMatrix::from_vec(12, 12, matrix);
        assert!(matrix.symmetric_eigenvalues().min() > -1e-12);
    }
}

/// A strip bent to a circle: half the bending stiffness times the curvature squared, times the
/// area.
#[test]
fn a_bent_strip_costs_what_a_plate_does() {
    let (length, width, plate) = (1.0, 0.2, 3.0);
    let energy = |cells: usize| {
        let flat = rectangle([length, width], [cells, cells / 5], Diagonals::Alternating).unwrap();
        let sheet = flat.mapped(|x| vector![x.x, x.y, 0.0]).unwrap();
        let hinges = hinges(&sheet, plate).unwrap();
        let hinges = Stencils::new(sheet.count(), Vec::new(), hinges).unwrap();
        let radius = 0.8;
        let bent = sheet.vertices().iter().flat_map(|x| {
            let angle = x.x / radius;
            [radius * angle.sin(), x.y, radius * (1.0 - angle.cos())]
        });
        let q: Vec<f64> = bent.collect();
        hinges.energy(&q) / (0.5 * plate / (radius * radius) * length * width)
    };
    // There are folds between cells, one less than cells.
    for cells in [10, 40] {
        let folds = (cells - 1) as f64 / cells as f64;
        assert!((energy(cells) / folds - 1.0).abs() < 2e-3, "{cells}: {}", energy(cells));
    }
}

#[test]
fn cauchys_stress_is_symmetric() {
    let f = [[1.2, 0.1, 0.3], [-0.2, 0.9, 0.0], [0.4, 0.1, 1.1]];
    for sigma in [
        cauchy(&SaintVenantKirchhoff::new(lame()), &f),
        cauchy(&NeoHookean::new(lame()).unwrap(), &f),
    ] {
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            assert!((sigma[i][j] / sigma[j][i] - 1.0).abs() < 1e-12);
        }
    }
    let material = NeoHookean::new(lame()).unwrap();
    assert!(Material::<3, 3>::energy::<f64>(&material, &f) > 0.0);
}

#[test]
fn every_piece_of_a_body_needs_its_own_supports() {
    let one = cuboid([1.0; 3], [1; 3]).unwrap();
    let apart: Vec<_> = one.vertices().iter().map(|x| x + Vector3::x() * 3.0).collect();
    let vertices = [one.vertices(), &apart].concat();
    let second = one.simplices().iter().map(|nodes| nodes.map(|node| node + 8));
    let both = one.simplices().iter().copied().chain(second).collect();
    let mesh = Mesh::new(vertices, both).unwrap();
    let clamp = |vertices: std::ops::Range<usize>, components: usize| -> Vec<Held> {
        let all = vertices.flat_map(|v| (0..components).map(move |c| (v, c)));
        let place =
            |(v, c): (usize, usize)| Held { vertex: v, component: c, place: mesh.vertices()[v][c] };
        all.map(place).collect()
    };
    let solve = |held: &[Held]| {
        let freedoms = Freedoms::<3>::new(mesh.count(), held).unwrap();
        let metric = lumped_mass(LinearTetrahedron, &mesh, [1.0, 1.0], &freedoms).unwrap();
        let rubber = SaintVenantKirchhoff::new(lame());
        let mut solid =
            Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms.clone()).unwrap();
        let none = DeadLoad::new(&freedoms, vec![[0.0; 3]; mesh.count()]).unwrap();
        let (mut q, places) = (freedoms.gathered(&mesh.nodes()).unwrap(), freedoms.places());
        Statics::default().solve(&mut solid, &none, &metric, places, &mut q)
    };
    // One piece held twice over does nothing for the other.
    let error = solve(&clamp(0..8, 3)).unwrap_err().to_string();
    assert!(error.starts_with("6 rigid motions are free: translation x, "), "{error}");
    assert!(error.ends_with("; piece 2 of 2, that of vertex 8"), "{error}");
    let error = solve(&[clamp(0..4, 3), clamp(8..16, 1)].concat()).unwrap_err().to_string();
    let names = "3 rigid motions are free: translation y, translation z, rotation about x";
    assert_eq!(error, format!("{names}; piece 2 of 2, that of vertex 8"));
    solve(&[clamp(0..4, 3), clamp(8..12, 3)].concat()).unwrap();
}

#[test]
fn iteration_brings_a_body_to_rest_where_the_factor_does() {
    let Clamped { mesh, freedoms } = clamped(3);
    let metric = lumped_mass(LinearTetrahedron, &mesh, [1.0, 1.0], &freedoms).unwrap();
    let rubber = NeoHookean::new(lame()).unwrap();
    let load =
        DeadLoad::body(LinearTetrahedron, &mesh, 1.0, &freedoms, |_| [0.0, 0.0, -150.0]).unwrap();
    let method = ConjugateGradient { tolerance: 1e-10, iterations: 2000 };
    let orders = [Ordering::MinimumDegree, Ordering::NestedDissection].map(Solves::Factor);
    let rests = [orders[0], orders[1], Solves::Iterate(method)].map(|solves| {
        let body = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms.clone()).unwrap();
        let mut body = body.with_curvature(Curvature::Semidefinite);
        let (mut q, places) = (freedoms.gathered(&mesh.nodes()).unwrap(), freedoms.places());
        let statics = Statics { solves, ..Statics::default() };
        let rest = statics.solve(&mut body, &load, &metric, places, &mut q).unwrap();
        assert!(rest.iterations() < 25, "{}", rest.iterations());
        q
    });
    let still = freedoms.gathered(&mesh.nodes()).unwrap();
    assert!(rests[0].iter().zip(&still).any(|(a, b)| (a - b).abs() > 0.1), "it moves");
    for (a, b) in rests[0].iter().zip(&rests[2]).chain(rests[0].iter().zip(&rests[1])) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
}
