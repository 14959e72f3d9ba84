//! Statics of bad numbers, and of a load that was made for other supports.

use stationary_calculus::{DiagonalMetric, Newton};
use stationary_elasticity::{
    DeadLoad, Elements, Freedoms, Held, LinearTetrahedron, Solid, Statics,
};

use super::{clamped, finite, rubber, small_block};
use crate::{Draw, Verdict};

pub fn statics(draw: &mut Draw) -> Verdict {
    let mesh = small_block();
    let freedoms = clamped(&mesh);
    let Ok(mut solid) = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber(), freedoms.clone())
    else {
        return Verdict::not_judged("no solid");
    };
    let Ok(load) = DeadLoad::new(&freedoms, vec![[0.0, 0.0, 1.0]; 8]) else {
        return Verdict::not_judged("no load");
    };
    let n = freedoms.dim();
    let masses = vec![1.0; if draw.chance(0.2) { draw.between(1, 2 * n) } else { n }];
    let Ok(metric) = DiagonalMetric::new(masses.clone()) else {
        return Verdict::not_judged("no mass");
    };
    let Ok(mut q) = freedoms.gathered(&mesh.nodes()) else {
        return Verdict::not_judged("no places");
    };
    if draw.chance(0.3) {
        q.resize(draw.below(2 * n), 0.0);
    }
    if draw.chance(0.3) && !q.is_empty() {
        let k = draw.below(q.len());
        q[k] = draw.any_f64();
    }
    let mut places = freedoms.places().to_vec();
    if draw.chance(0.3) {
        places.resize(draw.below(20), 0.0);
    }
    if draw.chance(0.3) && !places.is_empty() {
        let k = draw.below(places.len());
        places[k] = draw.any_f64();
    }
    let tolerance = if draw.chance(0.2) { draw.any_f64() } else { 0.0 };
    let newton = Newton { tolerance, iterations: draw.between(0, 50) };
    let statics = Statics { steps: draw.between(0, 2), newton, ..Statics::default() };
    draw.note(format!("{statics:?}, {} masses, q {q:?}, places {places:?}", masses.len()));
    let before = q.clone();
    match statics.solve(&mut solid, &load, &metric, &places, &mut q) {
        Ok(rest) => {
            if masses.len() != n || tolerance.is_nan() || tolerance < 0.0 {
                return Verdict::wrong("what does not fit is accepted");
            }
            finite("rest", &q).and(finite("reactions", &rest.reactions))
        }
        Err(_) if before.iter().map(|x| x.to_bits()).eq(q.iter().map(|x| x.to_bits())) => {
            Verdict::due()
        }
        Err(_) => Verdict::wrong("a failure that moves the body"),
    }
}

/// As many held coordinates, but others.
pub fn other_supports(draw: &mut Draw) -> Verdict {
    let mesh = small_block();
    let places: Vec<[f64; 3]> = mesh.nodes();
    let side = draw.below(3);
    let (first, other) = (side, (side + draw.between(0, 2)) % 3);
    let reordered = draw.chance(0.3);
    let hold = |axis: usize, backwards: bool| {
        let mut held: Vec<Held> = Vec::new();
        for (vertex, x) in places.iter().enumerate().filter(|(_, x)| x[axis] == 0.0) {
            held.extend((0..3).map(|component| Held { vertex, component, place: x[component] }));
        }
        if backwards {
            held.reverse();
        }
        Freedoms::<3>::new(8, &held)
    };
    draw.note(format!(
        "held on side {first}, loaded for side {other}, in another order: {reordered}"
    ));
    let (Ok(mine), Ok(theirs)) = (hold(first, false), hold(other, reordered)) else {
        return Verdict::not_judged("no supports");
    };
    let forces: Vec<[f64; 3]> = (0..8).map(|_| std::array::from_fn(|_| draw.symmetric())).collect();
    let Ok(load) = DeadLoad::new(&theirs, forces) else { return Verdict::not_judged("no load") };
    let Ok(mut solid) = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber(), mine.clone()) else {
        return Verdict::not_judged("no solid");
    };
    let Ok(metric) = DiagonalMetric::new(vec![1.0; mine.dim()]) else {
        return Verdict::not_judged("no mass");
    };
    let Ok(mut q) = mine.gathered(&places) else { return Verdict::not_judged("no places") };
    let solved = Statics::default().solve(&mut solid, &load, &metric, mine.places(), &mut q);
    match (solved, first == other && !reordered) {
        (Ok(_), true) | (Err(_), false) => Verdict::due(),
        (Err(error), true) => Verdict::refused(error),
        (Ok(_), false) => Verdict::wrong("a load of other supports is accepted"),
    }
}
