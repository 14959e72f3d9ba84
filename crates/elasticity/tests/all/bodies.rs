//! Masses, loads, bending and stress of whole bodies.

use nalgebra::{Vector3, vector};
use stationary_calculus::{
    Covector, Curvature, DenseSink, Metric, Potential, Stencil, Stencils, Vector,
    assert_derivatives,
};
use stationary_elasticity::{
    DeadLoad, ElasticityError, Elements, Freedoms, Hinge, Lame, Linear, LinearSegment,
    LinearTetrahedron, LinearTriangle, Material, NeoHookean, QuadraticSegment,
    QuadraticTetrahedron, QuadraticTriangle, Reference, SaintVenantKirchhoff, Solid,
    averaged_stress, cauchy, galerkin_mass, hinges, lumped_mass,
};
use stationary_mesh::{
    Diagonals, Mesh, MeshError, Places, QuadraticTetrahedra, QuadraticTriangles, bar, cuboid,
    curved_disc, rectangle,
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

/// A bar of three nodes that turns back, so that its middle node is its first one.
struct TurnedBack([[usize; 3]; 1]);

impl Elements<2, 3> for TurnedBack {
    fn count(&self) -> usize {
        2
    }

    fn node(&self, node: usize) -> [f64; 2] {
        [[0.0, 0.0], [1.0, 2.0]][node]
    }

    fn elements(&self) -> &[[usize; 3]] {
        &self.0
    }
}

#[test]
fn an_element_that_names_a_node_twice_has_no_mass_of_either_kind() {
    let bar = TurnedBack([[0, 1, 0]]);
    let freedoms = Freedoms::<2>::free(2).unwrap();
    let expected = ElasticityError::Mesh(MeshError::RepeatedVertex(Places(vec![0])));
    let lumped = lumped_mass(QuadraticSegment, &bar, [1.0, 1.0], &freedoms);
    assert_eq!(lumped.unwrap_err(), expected);
    let galerkin = galerkin_mass(QuadraticSegment, &bar, [1.0, 1.0], &freedoms);
    assert_eq!(galerkin.unwrap_err(), expected);
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
fn a_hinge_whose_second_derivative_leaves_the_range_of_numbers_is_refused() {
    let far = [[0.0, 0.0, 1e-4], [1e-16, 0.0, 0.0], [1e107, 0.0, 0.0], [0.0; 3]];
    let error = Hinge::new([0, 1, 2, 3], &far, 1.0).unwrap_err();
    assert_eq!(error, ElasticityError::FlatHinge { vertices: [0, 1, 2, 3] });
    for size in [1e-60, 1e-20, 1e20, 1e60] {
        let x = folded(0.5).map(|x| x.map(|x| size * x));
        let Ok(hinge) = Hinge::new([0, 1, 2, 3], &x, 1.0) else { continue };
        let hessian = hinge.hessian(&x, Curvature::Exact);
        let finite = hessian.as_flattened().as_flattened().as_flattened();
        assert!(finite.iter().all(|x| x.is_finite()), "{size:e} m");
    }
}

#[test]
fn a_hinge_with_one_flat_triangle_or_a_vertex_twice_is_refused() {
    let good = folded(0.5);
    for flat in 2..4 {
        let mut x = good;
        // In a row with the ends of the edge, or on one of them.
        x[flat] = std::array::from_fn(|i| 0.3 * x[0][i] + 0.7 * x[1][i]);
        let error = Hinge::new([0, 1, 2, 3], &x, 1.0).unwrap_err();
        assert_eq!(error, ElasticityError::FlatHinge { vertices: [0, 1, 2, 3] });
        x[flat] = x[0];
        assert!(Hinge::new([0, 1, 2, 3], &x, 1.0).is_err());
    }
    assert!(Hinge::new([0, 1, 2, 2], &good, 1.0).is_err());
    assert!(Hinge::new([0, 1, 2, 3], &good, 1e308).is_err(), "its curvature is not finite");
    let hinge = Hinge::new([0, 1, 2, 3], &good, 1.0).unwrap();
    assert!(hinge.resting_at(f64::NAN).is_err() && hinge.resting_at(0.1).is_ok());
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

/// A linear triangle that is integrated at two points, neither of them close to a corner.
struct TwoPoints;

impl Reference<3, 2, 2> for TwoPoints {
    const POINTS: [([f64; 2], f64); 2] = [([0.25, 0.25], 0.25), ([0.5, 0.25], 0.25)];
    const NODES: [[f64; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    const DEGREE: usize = 1;

    fn functions(l: &[f64; 2]) -> [f64; 3] {
        <LinearTriangle as Reference<3, 2, 1>>::functions(l)
    }

    fn gradients(l: &[f64; 2]) -> [[f64; 2]; 3] {
        <LinearTriangle as Reference<3, 2, 1>>::gradients(l)
    }

    fn rule(degree: usize) -> Vec<([f64; 2], f64)> {
        <LinearTriangle as Reference<3, 2, 1>>::rule(degree)
    }
}

#[test]
fn stress_at_the_nodes_is_that_of_linear_elasticity_for_the_linear_law() {
    let mesh = rectangle([2.0, 1.0], [2, 1], Diagonals::Same).unwrap();
    let pair = lame().plane_strain();
    // G = [0.02 0.05; 0.01 -0.03], by rows.
    let moved = |x: [f64; 2]| [1.02 * x[0] + 0.05 * x[1], 0.01 * x[0] + 0.97 * x[1]];
    let positions: Vec<[f64; 2]> = mesh.nodes().into_iter().map(moved).collect();
    let law = Linear::new(pair);
    let sigma = |e: [f64; 2], shear: f64| {
        let pressure = pair.lambda() * (e[0] + e[1]);
        let off = 2.0 * pair.mu() * shear;
        [[2.0 * pair.mu() * e[0] + pressure, off], [off, 2.0 * pair.mu() * e[1] + pressure]]
    };
    let expected = sigma([0.02, -0.03], 0.03);
    let quadratic = QuadraticTriangles::straight(&mesh);
    let curved: Vec<[f64; 2]> = quadratic.nodes().iter().map(|x| moved([x[0], x[1]])).collect();
    for stresses in [
        averaged_stress(LinearTriangle, &mesh, &law, &positions).unwrap(),
        averaged_stress(QuadraticTriangle, &quadratic, &law, &curved).unwrap(),
        averaged_stress(TwoPoints, &mesh, &law, &positions).unwrap(),
    ] {
        for stress in stresses {
            for (got, expected) in stress.as_flattened().iter().zip(expected.as_flattened()) {
                assert!((got - expected).abs() < 1e-9, "{got} {expected}");
            }
        }
    }
}

#[test]
fn stress_at_the_nodes_is_refused_where_it_has_no_value() {
    let mesh = rectangle([1.0, 1.0], [1, 1], Diagonals::Same).unwrap();
    let law = SaintVenantKirchhoff::new(lame().plane_strain());
    let mut positions = mesh.nodes();
    positions[1][0] = f64::NAN;
    let error = averaged_stress(LinearTriangle, &mesh, &law, &positions).unwrap_err();
    assert_eq!(error, ElasticityError::Position { vertex: 1 });
    let flat: Vec<[f64; 2]> = mesh.nodes().iter().map(|x| [x[0], 0.0]).collect();
    let error = averaged_stress(LinearTriangle, &mesh, &law, &flat).unwrap_err();
    assert_eq!(error, ElasticityError::Stress { vertex: 0 });
    // A law of small displacements has a stress there as well.
    let linear = Linear::new(lame().plane_strain());
    assert!(averaged_stress(LinearTriangle, &mesh, &linear, &flat).is_ok());
}

#[test]
fn a_configuration_that_is_too_short_is_not_a_number() {
    let mesh = rectangle([1.0, 1.0], [1, 1], Diagonals::Same).unwrap();
    let freedoms = Freedoms::<2>::free(4).unwrap();
    let law = SaintVenantKirchhoff::new(lame().plane_strain());
    let solid: Solid<_, 3, 2, 2, 1> =
        Solid::new(LinearTriangle, &mesh, 1.0, law, freedoms.clone()).unwrap();
    let load = DeadLoad::new(&freedoms, vec![[0.0, 1.0]; 4]).unwrap();
    let short = [0.0; 7];
    assert!(solid.energy(&short).is_nan() && load.energy(&short).is_nan());
    let mut dv = [0.0; 8];
    solid.add_differential(&short, Covector(&mut dv));
    assert!(dv.iter().all(|x| x.is_nan()));
}
