//! Solids, masses, stresses and damping of damaged meshes and other sizes.

use stationary_calculus::{Covector, DiagonalMetric, Metric, Potential, Vector};
use stationary_elasticity::{
    Elements, Freedoms, Lame, LinearTetrahedron, Rayleigh, Solid, StrainRate, averaged_stress,
    galerkin_mass, lumped_mass,
};
use stationary_mesh::Mesh;

use super::{clamped, count, finite, rubber, small_block};
use crate::{Draw, Verdict};

/// A block of which some elements are flat, inside out or far away.
fn damaged(draw: &mut Draw) -> Option<Mesh<3, 4>> {
    let mesh = small_block();
    let mut vertices = mesh.vertices().to_vec();
    match draw.below(4) {
        0 => {}
        1 => vertices[draw.below(8)] = vertices[draw.below(8)],
        2 => vertices[draw.below(8)] *= draw.any_f64(),
        _ => vertices.iter_mut().for_each(|x| x[2] = 0.0),
    }
    draw.note(format!("vertices {vertices:?}"));
    Mesh::new(vertices, mesh.simplices().to_vec()).ok()
}

pub fn solids(draw: &mut Draw) -> Verdict {
    let Some(mesh) = damaged(draw) else { return Verdict::due() };
    let section = if draw.chance(0.3) { draw.any_f64() } else { 1.0 };
    let vertices = if draw.chance(0.2) { draw.below(12) } else { 8 };
    let parts = count(draw);
    draw.note(format!("section {section:e}, {vertices} vertices, {parts} parts"));
    let Ok(freedoms) = Freedoms::<3>::free(vertices) else { return Verdict::due() };
    let Ok(solid) = Solid::new(LinearTetrahedron, &mesh, section, rubber(), freedoms) else {
        return Verdict::due();
    };
    let solid = solid.in_parts(parts);
    let q: Vec<f64> = mesh.nodes().into_iter().flatten().collect();
    let mut dv = vec![0.0; q.len()];
    solid.add_differential(&q, Covector(&mut dv));
    let short = vec![0.0; draw.below(30)];
    let _ = (solid.held_differential(&short), solid.inverted(&short));
    if short.len() < q.len() && !solid.energy(&short).is_nan() {
        return Verdict::wrong("the energy of half a configuration");
    }
    let large = mesh.vertices().iter().any(|x| x.amax() > 1e9) || section > 1e9;
    if large {
        Verdict::due()
    } else {
        finite("energy", &[solid.energy(&q)]).and(finite("force", &dv))
    }
}

/// What a mass makes of velocities of one.
fn momentum(mass: &impl Metric) -> Vec<f64> {
    let (v, mut p) = (vec![1.0; mass.dim()], vec![0.0; mass.dim()]);
    mass.flat(Vector(&v), Covector(&mut p));
    p
}

pub fn masses(draw: &mut Draw) -> Verdict {
    let Some(mesh) = damaged(draw) else { return Verdict::due() };
    let mut number = || if draw.chance(0.5) { draw.any_f64() } else { 1.0 };
    let numbers = [number(), number()];
    let vertices = if draw.chance(0.2) { draw.below(12) } else { 8 };
    draw.note(format!("density and section {numbers:?}, {vertices} vertices"));
    let Ok(freedoms) = Freedoms::<3>::free(vertices) else { return Verdict::due() };
    let verdict = match lumped_mass(LinearTetrahedron, &mesh, numbers, &freedoms) {
        Ok(mass) => finite("lumped mass", &momentum(&mass)),
        Err(_) => Verdict::due(),
    };
    verdict.and(match galerkin_mass(LinearTetrahedron, &mesh, numbers, &freedoms) {
        Ok(mass) => finite("Galerkin's mass", &momentum(&mass)),
        Err(_) => Verdict::due(),
    })
}

pub fn stresses(draw: &mut Draw) -> Verdict {
    let Some(mesh) = damaged(draw) else { return Verdict::due() };
    let mut positions: Vec<[f64; 3]> = small_block().nodes();
    if draw.chance(0.3) {
        positions.resize(draw.below(12), [0.0; 3]);
    }
    if draw.chance(0.5) && !positions.is_empty() {
        let k = draw.below(positions.len());
        positions[k][draw.below(3)] = draw.any_f64();
    }
    draw.note(format!("positions {positions:?}"));
    match averaged_stress(LinearTetrahedron, &mesh, &rubber(), &positions) {
        Ok(stress) => finite("stress", stress.as_flattened().as_flattened()),
        Err(_) => Verdict::due(),
    }
}

pub fn parameters(draw: &mut Draw) -> Verdict {
    let mesh = small_block();
    let freedoms = clamped(&mesh);
    let Ok(solid) = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber(), freedoms) else {
        return Verdict::not_judged("no solid");
    };
    let (q, v) = (vec![draw.symmetric(); draw.below(40)], vec![draw.symmetric(); draw.below(40)]);
    draw.note(format!("{} and {} numbers", q.len(), v.len()));
    let fits = q.len() == solid.dim();
    let energy = solid.energy_by_parameters::<2>(&q);
    let force = solid.differential_by_parameters::<2>(&q, &v);
    if energy.is_ok() != fits || force.is_ok() != (fits && v.len() == solid.dim()) {
        return Verdict::wrong("wrong sizes are accepted");
    }
    Verdict::due()
}

pub fn damping(draw: &mut Draw) -> Verdict {
    let mesh = small_block();
    let freedoms = clamped(&mesh);
    let Ok(solid) = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber(), freedoms.clone()) else {
        return Verdict::not_judged("no solid");
    };
    let (alpha, beta) = (draw.any_f64(), draw.any_f64());
    let n = if draw.chance(0.5) { freedoms.dim() } else { draw.between(1, 30) };
    draw.note(format!("alpha {alpha:e}, beta {beta:e}, {n} masses"));
    let Ok(metric) = DiagonalMetric::new(vec![1.0; n]) else { return Verdict::due() };
    let verdict = match Rayleigh::new([alpha, beta], metric, &solid) {
        Ok(_) if !(alpha >= 0.0 && beta >= 0.0 && alpha.is_finite() && beta.is_finite()) => {
            Verdict::wrong("a damping that gives energy")
        }
        _ => Verdict::due(),
    };
    let Ok(pair) = Lame::<3>::from_young_poisson(draw.any_f64(), 0.3) else { return verdict };
    let rate = StrainRate::new(&solid, pair);
    let mut rate = match rate {
        Ok(rate) => rate,
        Err(_) => return verdict,
    };
    let _ = rate.hold_at(&vec![draw.any_f64(); draw.below(20)]);
    verdict
}
