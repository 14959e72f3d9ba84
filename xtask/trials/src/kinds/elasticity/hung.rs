//! Bodies that may turn as a whole, and that their load brings to rest all the same: a cloth on two
//! pins, a flag on an edge, a block on a hinge, a pendulum. And bodies that nothing brings to rest.
//!
//! ```text
//! turning potential   sum f . R(t) (x - c)      least where the load hangs below the hinge
//! ```
//! The referee takes one more step of Newton's method, dense, with a density of its own.

use stationary_elasticity::{
    DeadLoad, ElasticityError, Elements, Freedoms, Held, Lame, LinearTetrahedron, LinearTriangle,
    NeoHookean, SaintVenantKirchhoff,
};
use stationary_mesh::{Diagonals, Mesh, cuboid, rectangle};

use super::body::Body;
use super::law::{Law, Moduli};
use super::statics::problem::{Problem, clamp, plain};
use super::statics::rest::judged;
use crate::{Draw, Verdict};

pub fn trial(draw: &mut Draw) -> Verdict {
    match draw.below(6) {
        0 => pendulum(draw),
        1 => hinged(draw),
        2 => cloth(draw, true),
        3 => cloth(draw, false),
        4 => adrift(draw),
        _ => spinning(draw),
    }
}

/// Equal weights at all vertices, along a direction.
fn weights<const D: usize>(count: usize, weight: f64, direction: &[f64]) -> Vec<[f64; D]> {
    let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-9);
    vec![std::array::from_fn(|i| weight * direction[i] / length); count]
}

/// A sheet in its plane on a single pin, under forces in any direction.
fn pendulum(draw: &mut Draw) -> Verdict {
    let (length, young) = (draw.log_uniform(1e-6, 1e6), draw.log_uniform(1.0, 1e12));
    let (cells, strain) = ([draw.between(1, 3), draw.between(1, 2)], draw.log_uniform(1e-7, 1e-2));
    let height = length * draw.log_uniform(0.3, 1.0);
    let Ok(mesh) = rectangle([length, height], cells, Diagonals::Alternating) else {
        return Verdict::not_judged("no mesh");
    };
    let places: Vec<[f64; 2]> = mesh.nodes();
    let pin = draw.below(places.len());
    let direction = draw.vector(2);
    let rubber = draw.chance(0.5);
    let weight = strain * young * height / places.len() as f64;
    draw.note(format!("pendulum {length:e} x {height:e} m in {cells:?}, E = {young:e}, pin {pin}, weight {weight:e} N each along {direction:?}, rubber: {rubber}"));
    let forces = weights::<2>(places.len(), weight, &direction);
    let held = clamp([pin], &places);
    let ends: Vec<f64> = held.iter().map(|h| h.place).collect();
    let Ok(lame) = Lame::<2>::from_young_poisson(young, 0.3) else {
        return Verdict::refused("moduli");
    };
    let problem = Problem { held: &held, ends: &ends, density: 1.0, section: 1.0, steps: 1 };
    let load = |freedoms: &Freedoms<2>| DeadLoad::new(freedoms, forces.clone());
    let solved = if rubber {
        match NeoHookean::new(lame) {
            Ok(rubber) => problem.solve(LinearTriangle, &mesh, rubber, &places, &load),
            Err(error) => Err(error),
        }
    } else {
        problem.solve::<_, _, 3, 2, 1>(
            LinearTriangle,
            &mesh,
            SaintVenantKirchhoff::new(lame),
            &places,
            &load,
        )
    };
    // On its middle it has no moment: any angle is as good.
    let middle: [f64; 2] =
        std::array::from_fn(|i| places.iter().map(|x| x[i]).sum::<f64>() / places.len() as f64);
    let arm = (0..2).map(|i| (middle[i] - places[pin][i]).powi(2)).sum::<f64>().sqrt();
    if arm < 1e-9 * length {
        return due_or_wrong(solved.map(|_| ()));
    }
    let law = if rubber { Law::NeoHookean } else { Law::Quadratic };
    let pair = Moduli { lambda: lame.lambda(), mu: lame.mu() };
    let elements = mesh.simplices().iter().map(|nodes| nodes.to_vec());
    let body = Body::new((law, pair), &plain(&places), elements, 1.0);
    judged(solved, &body, &places, &forces, &held)
}

fn due_or_wrong(solved: Result<(), ElasticityError>) -> Verdict {
    match solved {
        Ok(()) => Verdict::wrong("Ok with one of many places of rest"),
        Err(_) => Verdict::due(),
    }
}

/// A block on one of its edges.
fn hinged(draw: &mut Draw) -> Verdict {
    let (length, young) = (draw.log_uniform(1e-6, 1e6), draw.log_uniform(1.0, 1e12));
    let strain = draw.log_uniform(1e-7, 1e-2);
    let cells = [draw.between(1, 2), draw.between(1, 2), 1];
    let size = [length, length * draw.log_uniform(0.3, 1.0), length * draw.log_uniform(0.3, 1.0)];
    let Ok(mesh) = cuboid(size, cells) else { return Verdict::not_judged("no mesh") };
    let places: Vec<[f64; 3]> = mesh.nodes();
    let direction = draw.vector(3);
    let weight = strain * young * size[1] * size[2] / places.len() as f64;
    draw.note(format!("hinged block {size:?} m in {cells:?}, E = {young:e}, weight {weight:e} N each along {direction:?}"));
    let forces = weights::<3>(places.len(), weight, &direction);
    let low = |v: &usize| places[*v][0] <= 1e-9 * size[0] && places[*v][2] <= 1e-9 * size[2];
    let held = clamp((0..places.len()).filter(low), &places);
    let ends: Vec<f64> = held.iter().map(|h| h.place).collect();
    let Ok(lame) = Lame::<3>::from_young_poisson(young, 0.3) else {
        return Verdict::refused("moduli");
    };
    let problem = Problem { held: &held, ends: &ends, density: 1.0, section: 1.0, steps: 1 };
    let load = |freedoms: &Freedoms<3>| DeadLoad::new(freedoms, forces.clone());
    let material = SaintVenantKirchhoff::new(lame);
    let solved = problem.solve::<_, _, 4, 3, 1>(LinearTetrahedron, &mesh, material, &places, &load);
    // Along the hinge the load turns nothing.
    if direction[0].hypot(direction[2]) < 1e-6 * direction[1].abs() {
        return due_or_wrong(solved.map(|_| ()));
    }
    let pair = Moduli { lambda: lame.lambda(), mu: lame.mu() };
    let elements = mesh.simplices().iter().map(|nodes| nodes.to_vec());
    let body = Body::new((Law::Quadratic, pair), &plain(&places), elements, 1.0);
    judged(solved, &body, &places, &forces, &held)
}

/// A cloth on two pins, or a flag on an edge, in space, laid out at some angle to its weight.
fn cloth(draw: &mut Draw, on_pins: bool) -> Verdict {
    let (length, young) = (draw.log_uniform(1e-6, 1e6), draw.log_uniform(1.0, 1e12));
    let (strain, thin) = (draw.log_uniform(1e-4, 3e-2), draw.log_uniform(1e-4, 1e-1));
    let cells = [draw.between(1, 4), draw.between(1, 4)];
    let Ok(flat) = rectangle([length, length], cells, Diagonals::Alternating) else {
        return Verdict::not_judged("no mesh");
    };
    // A little out of its plane, as every cloth is, but for the edge.
    let tilt = draw.uniform(-3.0, 3.0);
    let bump = 0.02 * length;
    let noise = draw.vector(flat.vertices().len());
    let straight = |v: usize| flat.vertices()[v][1] <= 1e-9 * length;
    let lift = |v: usize| if straight(v) { 0.0 } else { bump * noise[v] };
    let rest: Vec<[f64; 3]> = flat
        .vertices()
        .iter()
        .enumerate()
        .map(|(v, x)| {
            let (s, c) = tilt.sin_cos();
            let z = lift(v);
            [x[0], c * x[1] - s * z, s * x[1] + c * z]
        })
        .collect();
    let Ok(mesh) =
        Mesh::<3, 3>::new(rest.iter().map(|&x| x.into()).collect(), flat.simplices().to_vec())
    else {
        return Verdict::not_judged("no mesh");
    };
    let places = rest;
    let top = |v: &usize| flat.vertices()[*v][1] <= 1e-9 * length;
    let corner = |v: &usize| {
        let x = flat.vertices()[*v][0];
        x <= 1e-9 * length || x >= (1.0 - 1e-9) * length
    };
    let pins = (0..places.len()).filter(|v| top(v) && (!on_pins || corner(v)));
    let section = thin * length;
    let weight = strain * young * section * length / places.len() as f64;
    draw.note(format!("cloth {length:e} m in {cells:?}, E = {young:e}, thickness {section:e}, on pins: {on_pins}, tilted by {tilt}, weight {weight:e} N each"));
    let forces = weights::<3>(places.len(), weight, &[0.0, 1.0, 0.0]);
    let held = clamp(pins, &places);
    let ends: Vec<f64> = held.iter().map(|h| h.place).collect();
    let Ok(lame) = Lame::<3>::from_young_poisson(young, 0.3) else {
        return Verdict::refused("moduli");
    };
    let lame = lame.plane_stress();
    let problem = Problem { held: &held, ends: &ends, density: 1.0, section, steps: 1 };
    let load = |freedoms: &Freedoms<3>| DeadLoad::new(freedoms, forces.clone());
    let material = SaintVenantKirchhoff::new(lame);
    let solved = problem.solve::<_, _, 3, 2, 1>(LinearTriangle, &mesh, material, &places, &load);
    let pair = Moduli { lambda: lame.lambda(), mu: lame.mu() };
    let elements = mesh.simplices().iter().map(|nodes| nodes.to_vec());
    let body = Body::new((Law::Quadratic, pair), &plain(&places), elements, section);
    judged(solved, &body, &places, &forces, &held)
}

/// A block that may shift: nothing brings it to rest, or it rests anywhere.
fn adrift(draw: &mut Draw) -> Verdict {
    let length = draw.log_uniform(1e-6, 1e6);
    let young = draw.log_uniform(1.0, 1e12);
    let Ok(mesh) = cuboid([length; 3], [1; 3]) else { return Verdict::not_judged("no mesh") };
    let places: Vec<[f64; 3]> = mesh.nodes();
    let way = draw.below(3);
    let mut held = Vec::new();
    for (vertex, x) in places.iter().enumerate() {
        let components = (0..3).filter(|&c| c != way && draw.chance(0.5));
        held.extend(components.map(|component| Held { vertex, component, place: x[component] }));
    }
    let loaded = draw.chance(0.5);
    draw.note(format!(
        "block of {length:e} m, E = {young:e}, may shift along {way}, loaded: {loaded}, {} held",
        held.len()
    ));
    let weight = if loaded { 1e-3 * young * length * length } else { 0.0 };
    let forces = weights::<3>(8, weight, &draw.vector(3));
    restless(&mesh, young, &held, &forces)
}

/// A block on one point in space, or on a hinge without a load: it may turn for nothing.
fn spinning(draw: &mut Draw) -> Verdict {
    let length = draw.log_uniform(1e-6, 1e6);
    let young = draw.log_uniform(1.0, 1e12);
    let Ok(mesh) = cuboid([length; 3], [1; 3]) else { return Verdict::not_judged("no mesh") };
    let places: Vec<[f64; 3]> = mesh.nodes();
    let point = draw.chance(0.5);
    let first = draw.below(8);
    let other = (first + draw.between(1, 7)) % 8;
    let pins = if point { vec![first] } else { vec![first, other] };
    let weight = if point { 1e-3 * young * length * length } else { 0.0 };
    let forces = weights::<3>(8, weight, &draw.vector(3));
    draw.note(format!(
        "block of {length:e} m, E = {young:e}, on {pins:?}, weight {weight:e} N each"
    ));
    let held = clamp(pins, &places);
    restless(&mesh, young, &held, &forces)
}

/// A block that has no place of rest of its own under these forces.
fn restless(mesh: &Mesh<3, 4>, young: f64, held: &[Held], forces: &[[f64; 3]]) -> Verdict {
    let ends: Vec<f64> = held.iter().map(|h| h.place).collect();
    let Ok(lame) = Lame::<3>::from_young_poisson(young, 0.3) else {
        return Verdict::refused("moduli");
    };
    let problem = Problem { held, ends: &ends, density: 1.0, section: 1.0, steps: 1 };
    let load = |freedoms: &Freedoms<3>| DeadLoad::new(freedoms, forces.to_vec());
    let (material, places) = (SaintVenantKirchhoff::new(lame), mesh.nodes());
    let solved = problem.solve::<_, _, 4, 3, 1>(LinearTetrahedron, mesh, material, &places, &load);
    due_or_wrong(solved.map(|_| ()))
}
