//! Supports and loads of bad numbers and other sizes.

use stationary_elasticity::{DeadLoad, Freedoms, Held, LinearTetrahedron, LinearTriangle};
use stationary_mesh::Mesh;

use super::{clamped, count, finite, small_block};
use crate::{Draw, Verdict};

pub fn freedoms(draw: &mut Draw) -> Verdict {
    let vertices = count(draw);
    let held: Vec<Held> = (0..draw.below(5))
        .map(|_| Held {
            vertex: draw.below(5),
            component: draw.below(4),
            place: if draw.chance(0.3) { draw.any_f64() } else { 1.0 },
        })
        .collect();
    draw.note(format!("{vertices} vertices, {held:?}"));
    let Ok(mut freedoms) = Freedoms::<3>::new(vertices, &held) else { return Verdict::due() };
    let places = vec![draw.any_f64(); draw.below(6)];
    let moved = freedoms.hold_at(&places);
    let q = vec![0.0; draw.below(130)];
    let (n, positions) = (freedoms.dim(), freedoms.positions(&q));
    let gathered = freedoms.gathered(&vec![[0.0; 3]; draw.below(50)]);
    let verdict = finite("places", freedoms.places());
    if moved.is_ok() && places.len() != held.len() || positions.is_ok() && q.len() != n {
        return Verdict::wrong("wrong sizes are accepted");
    }
    match gathered {
        Ok(gathered) if gathered.len() != n => Verdict::wrong("wrong sizes are accepted"),
        _ => verdict,
    }
}

pub fn loads(draw: &mut Draw) -> Verdict {
    let mesh = small_block();
    let freedoms = clamped(&mesh);
    let count = draw.between(0, 10);
    let mut forces = vec![[1.0, 2.0, 3.0]; count];
    let bad = draw.chance(0.5) && count > 0;
    if bad {
        forces[draw.below(count)][draw.below(3)] = draw.any_f64();
    }
    let factor = draw.any_f64();
    draw.note(format!("{forces:?} times {factor:e}"));
    let Ok(load) = DeadLoad::new(&freedoms, forces) else { return Verdict::due() };
    if count != 8 {
        return Verdict::wrong("forces of another mesh");
    }
    let scaled = scaled(&load, factor);
    let verdict = finite("a load", load.forces().as_flattened());
    let verdict = match scaled {
        Some(scaled) => verdict.and(finite("a scaled load", scaled.forces().as_flattened())),
        None => verdict,
    };
    match load.plus(&load) {
        Ok(sum) => verdict.and(finite("a sum of loads", sum.forces().as_flattened())),
        Err(_) => verdict,
    }
}

/// The load times a factor, or `None` where that is refused.
fn scaled(load: &DeadLoad<3>, factor: f64) -> Option<DeadLoad<3>> {
    load.scaled(factor).ok()
}

pub fn densities(draw: &mut Draw) -> Verdict {
    let mesh = small_block();
    let freedoms =
        if draw.chance(0.3) { Freedoms::free(draw.below(9)) } else { Ok(clamped(&mesh)) };
    let Ok(freedoms) = freedoms else { return Verdict::due() };
    let (section, force) = (draw.any_f64(), draw.any_f64());
    draw.note(format!("section {section:e}, force {force:e}, {} vertices", freedoms.vertices()));
    let body = DeadLoad::body(LinearTetrahedron, &mesh, section, &freedoms, |_| [force; 3]);
    let Ok(rim) = Mesh::<3, 3>::new(mesh.vertices().to_vec(), mesh.boundary_facets()) else {
        return Verdict::not_judged("no rim");
    };
    let traction =
        DeadLoad::traction(LinearTriangle, &rim, section, &freedoms, |_, n| n.map(|n| force * n));
    [body, traction].into_iter().flatten().fold(Verdict::due(), |verdict, load| {
        verdict.and(finite("a load", load.forces().as_flattened()))
    })
}
