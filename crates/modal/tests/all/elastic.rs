//! Elastic bodies against frequencies that are known: published ones, waves, and theories of beams.

use std::f64::consts::TAU;

use stationary_calculus::{Metric, Potential};
use stationary_elasticity::problems::{
    BeamTheory, Ends, FV32_HERTZ, bar_frequencies, fv32, sliding_block, sliding_block_frequencies,
    vibrating_bar, vibrating_beam,
};
use stationary_elasticity::{
    LinearSegment, LinearTetrahedron, LinearTriangle, QuadraticTetrahedron, QuadraticTriangle,
};
use stationary_mesh::{
    Diagonals, QuadraticTetrahedra, QuadraticTriangles, bar, cuboid, rectangle, tapered_membrane,
};
use stationary_modal::{Kind, Linearized, RigidMotions};

/// The lowest angular frequencies of a held body, rad/s.
fn frequencies(metric: &impl Metric, potential: &impl Potential, q: &[f64], n: usize) -> Vec<f64> {
    let mut body = Linearized::at(metric, potential, q, 1e-3).unwrap();
    body.lowest(n, &RigidMotions::none()).unwrap().frequencies().collect()
}

#[test]
fn the_bar_has_its_closed_forms_above_the_continuum_with_one_mass_and_below_with_the_other() {
    let (length, cells) = (2.0, 30);
    let body = vibrating_bar(LinearSegment, &bar(length, cells).unwrap()).unwrap();
    let lumped = frequencies(&body.lumped, &body.solid, &body.q, 10);
    let galerkin = frequencies(&body.galerkin, &body.solid, &body.q, 10);
    for (k, (below, above)) in lumped.iter().zip(&galerkin).enumerate() {
        let [exact, exact_lumped, exact_galerkin] = bar_frequencies(length, cells, k + 1).unwrap();
        assert!((below / exact_lumped - 1.0).abs() < 1e-10, "{k}: {below} {exact_lumped}");
        assert!((above / exact_galerkin - 1.0).abs() < 1e-10, "{k}: {above} {exact_galerkin}");
        assert!(*below < exact && exact < *above);
    }
}

#[test]
fn the_tapered_membrane_has_the_frequencies_that_nafems_gives() {
    let straight = tapered_membrane([24, 12]).unwrap();
    let body = fv32(QuadraticTriangle, &QuadraticTriangles::straight(&straight)).unwrap();
    let quadratic = frequencies(&body.galerkin, &body.solid, &body.q, 6);
    let body = fv32(LinearTriangle, &straight).unwrap();
    let linear = frequencies(&body.galerkin, &body.solid, &body.q, 6);
    for ((quadratic, linear), hertz) in quadratic.iter().zip(&linear).zip(FV32_HERTZ) {
        let error = quadratic / (TAU * hertz) - 1.0;
        assert!(error.abs() < 1e-3, "{hertz}: {error:e}");
        // The linear space is part of the quadratic one: its frequencies are no lower.
        assert!(linear > quadratic);
    }
}

#[test]
fn a_block_on_six_sliding_faces_has_the_frequencies_of_its_waves_from_above() {
    let size = [1.0, 0.8, 0.6];
    let exact = sliding_block_frequencies(size, 8).unwrap();
    let mesh = cuboid(size, [5, 4, 3]).unwrap();
    let body = sliding_block(LinearTetrahedron, &mesh, size).unwrap();
    let linear = frequencies(&body.galerkin, &body.solid, &body.q, 8);
    let mesh = QuadraticTetrahedra::straight(&mesh);
    let body = sliding_block(QuadraticTetrahedron, &mesh, size).unwrap();
    let quadratic = frequencies(&body.galerkin, &body.solid, &body.q, 8);
    for ((linear, quadratic), exact) in linear.iter().zip(&quadratic).zip(&exact) {
        assert!(quadratic > exact && linear > quadratic, "{exact} {quadratic} {linear}");
        assert!(quadratic / exact - 1.0 < 1e-2, "{}", quadratic / exact - 1.0);
    }
}

#[test]
fn beams_swing_as_timoshenko_says_and_a_free_one_has_three_rigid_motions() {
    let size = [10.0, 1.0];
    let mesh = rectangle(size, [20, 2], Diagonals::Alternating).unwrap();
    let mesh = QuadraticTriangles::straight(&mesh);
    for (ends, motions) in [(Ends::Clamped, 0), (Ends::Free, 3)] {
        let body = vibrating_beam(QuadraticTriangle, &mesh, ends).unwrap();
        let mut beam = Linearized::at(&body.galerkin, &body.solid, &body.q, 1e-10).unwrap();
        let rigid = match ends {
            Ends::Clamped => RigidMotions::none(),
            Ends::Free => RigidMotions::of_points::<2>(&beam, body.q.as_chunks().0).unwrap(),
        };
        assert_eq!((rigid.len(), beam.kind(&rigid).unwrap()), (motions, Kind::Stable));
        let modes = beam.lowest(2, &rigid).unwrap();
        let timoshenko = BeamTheory::Timoshenko.frequencies(ends, size, 2);
        let thin = BeamTheory::EulerBernoulli.frequencies(ends, size, 2);
        for (i, omega) in modes.frequencies().enumerate() {
            let off = omega / timoshenko[i] - 1.0;
            assert!(off.abs() < 2e-3, "{ends:?} {i}: {off:e}");
            assert!(thin[i] / omega - 1.0 > 3.0 * off.abs(), "{ends:?} {i}");
        }
    }
}
