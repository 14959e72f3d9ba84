//! Every public function of modal with bad numbers, sizes and empty lists.

use stationary_calculus::{Covector, DiagonalMetric, FIXED, Potential, Vector};
use stationary_modal::problems::{fixed_chain, free_chain, membrane};
use stationary_modal::{Linearized, ModalError, Modes, Motion, Reduced, RigidMotions};

use super::prescribed::Quadratic;
use crate::{Draw, Verdict};

/// A number that is usually good.
fn number(draw: &mut Draw) -> f64 {
    if draw.chance(0.3) { draw.any_f64() } else { draw.symmetric() }
}

/// So many numbers, now and then another count, with bad ones now and then.
fn numbers(draw: &mut Draw, n: usize) -> Vec<f64> {
    let n = if draw.chance(0.15) { draw.below(n + 3) } else { n };
    let bad = draw.chance(0.4);
    (0..n).map(|_| if bad { number(draw) } else { draw.symmetric() }).collect()
}

fn finite(what: &str, numbers: &[f64]) -> Verdict {
    match numbers.iter().find(|x| !x.is_finite()) {
        None => Verdict::due(),
        Some(x) => Verdict::wrong(format!("Ok with {x} in {what}")),
    }
}

pub(super) fn trial(draw: &mut Draw) -> Verdict {
    match draw.below(6) {
        0 => systems(draw),
        1 => foreign_rigid_motions(draw),
        _ => {
            let n = draw.between(1, 6);
            let chain = if draw.chance(0.5) { fixed_chain(n) } else { free_chain(n + 1) };
            let Ok(chain) = chain else { return Verdict::wrong("a chain is refused") };
            let at = Linearized::at(&chain.metric, &chain.potential, &chain.q, 1e-12);
            let Ok(mut system) = at else { return Verdict::wrong("a chain is no equilibrium") };
            let count = draw.between(1, system.dim());
            let Ok(modes) = system.lowest(count, &RigidMotions::none()) else {
                return Verdict::wrong("a chain's modes are refused");
            };
            match draw.below(5) {
                0 => motions(draw, &system, &modes),
                1 => bodies(draw, &modes),
                2 => answers(draw, &mut system, &modes),
                3 => subspaces(draw, &mut system, &modes),
                _ => counts(draw, &mut system, modes),
            }
        }
    }
}

/// Masses and stiffnesses of any size, and places that are none.
fn systems(draw: &mut Draw) -> Verdict {
    let sizes = [draw.below(4), draw.below(4), draw.below(40)];
    draw.note(format!("problems of {sizes:?}"));
    let _ = fixed_chain(sizes[0]);
    let _ = free_chain(sizes[1]);
    let _ = membrane(sizes[2]);
    if draw.chance(0.05) {
        let huge = draw.one_of(&[usize::MAX, usize::MAX - 1, 1 << 40, 1 << 62]);
        draw.note(format!("problems of {huge}"));
        if fixed_chain(huge).is_ok() || free_chain(huge).is_ok() || membrane(huge).is_ok() {
            return Verdict::wrong("a chain longer than memory");
        }
    }
    let n = draw.between(1, 4);
    let q = numbers(draw, n);
    let entries = numbers(draw, n);
    let blocks: Vec<_> = entries.iter().enumerate().map(|(i, x)| (vec![i], vec![*x])).collect();
    let stiffness = Quadratic { q0: vec![0.0; entries.len()], blocks };
    let masses: Vec<f64> = numbers(draw, n).iter().map(|m| m.abs()).collect();
    let tolerance = if draw.chance(0.5) { 1e9 } else { draw.any_f64() };
    draw.note(format!("masses {masses:?}, stiffness {entries:?}, at {q:?} within {tolerance:e}"));
    let Ok(metric) = DiagonalMetric::new(masses) else { return Verdict::due() };
    let Ok(mut system) = Linearized::at(&metric, &stiffness, &q, tolerance) else {
        return Verdict::due();
    };
    let verdict = finite("the scale", &[system.scale()]);
    let _ = system.kind(&RigidMotions::none());
    let wild = [[0, 1], [draw.below(4), FIXED], [FIXED, draw.one_of(&[2, 3, usize::MAX - 1])]];
    let places = [[number(draw), number(draw)]; 3];
    let _ = RigidMotions::of_points::<2>(&system, q.as_chunks().0);
    let _ =
        RigidMotions::of_freedoms::<2>(&system, &places[..draw.below(4)], &wild[..draw.below(4)]);
    match system.lowest(draw.between(0, n + 1), &RigidMotions::none()) {
        Ok(modes) => verdict.and(of_modes(&modes)),
        Err(_) => verdict,
    }
}

fn of_modes(modes: &Modes) -> Verdict {
    let columns: Vec<f64> =
        (0..modes.len()).filter_map(|i| modes.vector(i)).flat_map(|v| v.0.to_vec()).collect();
    finite("the values", modes.values())
        .and(finite("the vectors", &columns))
        .and(finite("the residuals", modes.residuals()))
}

/// Rigid motions of one system given to another.
fn foreign_rigid_motions(draw: &mut Draw) -> Verdict {
    let points = draw.between(2, 8);
    let free = free_chain(points).expect("a chain");
    let there = Linearized::at(&free.metric, &free.potential, &free.q, 1e-12).expect("at rest");
    let q: Vec<f64> = (0..points).map(|i| i as f64).collect();
    let rigid = RigidMotions::of_points::<1>(&there, q.as_chunks().0).expect("a drift");
    let other = if draw.chance(0.5) { points } else { draw.between(2, 8) };
    draw.note(format!("motions of {points} free masses for {other} held ones"));
    let held = fixed_chain(other).expect("a chain");
    let mut system =
        Linearized::at(&held.metric, &held.potential, &held.q, 1e-12).expect("at rest");
    let _ = system.kind(&rigid);
    let own = system.lowest(1, &RigidMotions::none()).expect("a mode");
    if own.with_rigid(&rigid).is_ok() {
        return Verdict::wrong("rigid motions of another system beside the modes");
    }
    match system.lowest(1, &rigid) {
        Ok(modes) => Verdict::of(
            (modes.values()[0] - held.spectrum[0]).abs(),
            1e-9,
            "the lowest value beside motions of another system",
        ),
        Err(_) => Verdict::due(),
    }
}

fn motions<P: Potential>(
    draw: &mut Draw,
    system: &Linearized<'_, DiagonalMetric<Vec<f64>>, P>,
    modes: &Modes,
) -> Verdict {
    let n = modes.dim();
    let (d, v, t) = (numbers(draw, n), numbers(draw, n), number(draw));
    let ratios: Vec<f64> =
        if draw.chance(0.5) { vec![0.1; modes.len()] } else { numbers(draw, modes.len()) };
    draw.note(format!("d {d:?}, v {v:?}, t {t:e}, ratios {ratios:?}"));
    let Ok(motion) = Motion::new(modes, system.mass(), Vector(&d), Vector(&v)) else {
        return Verdict::due();
    };
    let left = [motion.left_out(), motion.left_out_of_velocity()];
    let verdict = finite("left_out", &left);
    let motion = match motion.clone().with_damping(&ratios) {
        Ok(damped) => damped,
        Err(_) => motion,
    };
    let (mut end, mut speed) = (numbers(draw, n), numbers(draw, n));
    let energy = motion.energy(draw.below(modes.len() + 1), t);
    let verdict = match energy {
        Ok(energy) => verdict.and(finite("energy", &[energy])),
        Err(_) => verdict,
    };
    match motion.at(t, Vector(&mut end), Vector(&mut speed)) {
        Ok(()) => verdict.and(finite("d", &end)).and(finite("v", &speed)),
        Err(_) => verdict,
    }
}

fn bodies(draw: &mut Draw, modes: &Modes) -> Verdict {
    let mut body = Reduced::at_rest(modes);
    for _ in 0..3 {
        let (h, force) = (number(draw), numbers(draw, modes.dim()));
        draw.note(format!("h {h:e}, force {force:?}"));
        let before = body.clone();
        if body.step(h, Covector(&force)).is_err() && body != before {
            return Verdict::wrong("a failed step leaves another state");
        }
        if body.alpha().iter().any(|x| !x.is_finite()) {
            return Verdict::wrong(format!("alpha is {:?}", body.alpha()));
        }
    }
    let mut d = numbers(draw, modes.dim());
    match body.displacement(Vector(&mut d)) {
        Ok(()) => finite("the displacement", &d),
        Err(_) => Verdict::due(),
    }
}

fn answers<P: Potential>(
    draw: &mut Draw,
    system: &mut Linearized<'_, DiagonalMetric<Vec<f64>>, P>,
    modes: &Modes,
) -> Verdict {
    let (load, seen) = (numbers(draw, modes.dim()), numbers(draw, modes.dim()));
    draw.note(format!("load {load:?}, observable {seen:?}"));
    let zero = draw.chance(0.1);
    let load = if zero { vec![0.0; load.len()] } else { load };
    match system.answer(modes, Covector(&load), Covector(&seen)) {
        Ok(answer) => {
            let _ = answer.least_modes(draw.any_f64());
            let _ = answer.least_modes_in_motion(draw.any_f64());
            finite("the whole", &[answer.whole])
                .and(finite("the errors", &answer.errors))
                .and(finite("the bounds", &answer.bounds))
        }
        Err(_) => Verdict::due(),
    }
}

fn subspaces<P: Potential>(
    draw: &mut Draw,
    system: &mut Linearized<'_, DiagonalMetric<Vec<f64>>, P>,
    modes: &Modes,
) -> Verdict {
    let reach = number(draw);
    draw.note(format!("reach {reach:e}"));
    let mut none = modes.clone();
    none.truncate(0);
    if system.subspace(&none).is_ok() {
        return Verdict::wrong("a subspace of no modes");
    }
    let _ = system.subspace_with_derivatives(modes, reach);
    let Ok(subspace) = system.subspace(modes) else { return Verdict::wrong("no subspace") };
    let (a, mut q) = (numbers(draw, modes.len()), numbers(draw, modes.dim()));
    let finite_input = a.iter().all(|x| x.abs() < 1e100);
    let verdict = match subspace.configuration(&a, &mut q) {
        Ok(()) if finite_input => finite("the configuration", &q),
        _ => Verdict::due(),
    };
    let p = numbers(draw, modes.dim());
    match subspace.pulled_back(Covector(&p)) {
        Ok(reduced) if p.iter().all(|x| x.abs() < 1e100) => {
            verdict.and(finite("the covector", &reduced.0))
        }
        _ => verdict,
    }
}

fn counts<P: Potential>(
    draw: &mut Draw,
    system: &mut Linearized<'_, DiagonalMetric<Vec<f64>>, P>,
    modes: Modes,
) -> Verdict {
    let (mu, asked) = (draw.any_f64(), draw.one_of(&[0, 1, 2, 1000, usize::MAX, FIXED - 1]));
    draw.note(format!("below {mu:e}; {asked} modes"));
    if system.count_below(mu).is_ok() && !mu.is_finite() {
        return Verdict::wrong(format!("a count below {mu}"));
    }
    let few = match system.lowest(asked, &RigidMotions::none()) {
        Ok(modes) if modes.len() == asked => of_modes(&modes),
        Ok(_) => Verdict::wrong("another number of modes"),
        Err(ModalError::Count { .. }) => Verdict::due(),
        Err(error) => Verdict::refused(error),
    };
    let mut modes = modes;
    let other = fixed_chain(modes.dim() + 1).expect("a chain");
    let there = Linearized::at(&other.metric, &other.potential, &other.q, 1e-12).expect("at rest");
    if modes.orthogonality(there.mass()).is_ok() {
        return Verdict::wrong("products in the mass of another size");
    }
    modes.truncate(asked);
    let _ = (modes.vector(asked), modes.frequencies().count(), modes.is_empty());
    few.and(of_modes(&modes))
}
