//! Damping takes power, and from what it should.

use nalgebra::Vector3;
use proptest::prelude::*;
use stationary_calculus::{Covector, Curvature, DenseSink, Force, Vector};
use stationary_elasticity::{
    ElasticityError, Elements, Freedoms, Held, Lame, LinearTetrahedron, Rayleigh,
    SaintVenantKirchhoff, Solid, StrainRate, lumped_mass,
};
use stationary_mesh::{Mesh, cuboid};

fn lame() -> Lame<3> {
    Lame::from_young_poisson(2e4, 0.3).unwrap()
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
        let mut random = stationary_measure::SplitMix64::new(seed);
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
        let mut random = stationary_measure::SplitMix64::new(seed);
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

#[test]
fn a_velocity_that_is_too_short_is_no_force_at_all() {
    let (mesh, solid) = cube();
    let freedoms = solid.freedoms().clone();
    let mass = lumped_mass(LinearTetrahedron, &mesh, [1.0, 1.0], &freedoms).unwrap();
    let viscous = StrainRate::new(&solid, Lame::new(0.3, 2.0).unwrap()).unwrap();
    let rayleigh = Rayleigh::new([0.5, 0.1], mass, solid).unwrap();
    let (q, v) = (mesh.nodes().concat(), vec![1.0; 24]);
    assert!(force(&viscous, &q, &v[..23]).iter().all(|f| f.is_nan()));
    assert!(force(&rayleigh, &q, &v[..23]).iter().all(|f| f.is_nan()));
    // What belongs to others is left to them.
    let longer = [&q[..], &[0.0; 3]].concat();
    assert!(force(&rayleigh, &longer, &[1.0; 27])[24..].iter().all(|f| *f == 0.0));
}

#[test]
fn held_vertices_that_are_moved_damp_where_they_are() {
    let mesh = cuboid([1.0, 1.0, 1.0], [1, 1, 1]).unwrap();
    let nodes: Vec<[f64; 3]> = mesh.nodes();
    let law = SaintVenantKirchhoff::new(lame());
    let viscosity = || Lame::new(0.3, 2.0).unwrap();
    // The left face, held where it is or moved away and stretched.
    let damping = |shift: f64| {
        let at = |vertex: usize, c: usize| nodes[vertex][c] * (1.0 + shift) - shift;
        let left = (0..8).filter(|&vertex| nodes[vertex][0] == 0.0);
        let held: Vec<Held> = left
            .flat_map(|vertex| (0..3).map(move |component| (vertex, component)))
            .map(|(vertex, component)| Held { vertex, component, place: at(vertex, component) })
            .collect();
        let freedoms = Freedoms::<3>::new(8, &held).unwrap();
        let places = freedoms.places().to_vec();
        let solid = Solid::new(LinearTetrahedron, &mesh, 1.0, law, freedoms).unwrap();
        (StrainRate::new(&solid, viscosity()).unwrap(), places)
    };
    let ((mut moved, _), (there, places)) = (damping(0.0), damping(0.25));
    let q: Vec<f64> = (0..12).map(|k| 1.0 + 0.1 * f64::from(k).sin()).collect();
    let v: Vec<f64> = (0..12).map(|k| f64::from(k).cos()).collect();
    assert_ne!(force(&moved, &q, &v), force(&there, &q, &v));
    moved.hold_at(&places).unwrap();
    assert_eq!(force(&moved, &q, &v), force(&there, &q, &v));
    let short = moved.hold_at(&places[1..]);
    assert_eq!(short, Err(ElasticityError::HeldPlaces { expected: 12, got: 11 }));
    assert_eq!(force(&moved, &q, &v), force(&there, &q, &v));
}
