//! Searches for the lowest place of landscapes of which it is known whether they have one.

mod families;

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use stationary_calculus::{
    DenseSolver, DiagonalMetric, Equilibrium, EquilibriumReport, HessianSolver, Newton,
    NewtonError, NewtonFailure, Potential, SparseSolver, Stationary,
};

use super::landscape::{Coordinate, End, Landscape, Term};
use crate::{Draw, Kind, Verdict};
use families::{
    barrier, beam, bowl, cubic_ground, fade, fall, flat, ground, kink, molecule, ridge, wells,
};

pub(super) const KIND: Kind = Kind {
    name: "equilibria",
    krate: "calculus",
    rule: "a minimum whose force exceeds a thousand roundings of its terms, or of which the Hessian \
           has a negative eigenvalue; Ok where the energy falls without end, or where no force is ever \
           zero; an error that does not say `unbounded` where it is; a singular equation named where a \
           force acts; a direction called down along which the energy does not bend downwards",
    in_tests: 400,
    trial,
};

/// Roundings of the terms that a force at rest may be.
const ROUNDINGS: f64 = 1e3;

/// What is known of a landscape.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Known {
    /// Smooth, grows in all directions: it has a minimum.
    Minimum,
    /// Falls without end.
    Unbounded,
    /// Bounded, but no force is ever zero.
    NoRest,
    /// Its lowest place is a kink.
    Kink,
}

struct Case {
    v: Landscape,
    start: Vec<f64>,
    known: Known,
}

/// The units of a case.
struct Units {
    length: f64,
    energy: f64,
}

fn trial(draw: &mut Draw) -> Verdict {
    let units = units(draw);
    let family = draw.below(12);
    let Case { v, start, known } = match family {
        0 => bowl(draw),
        1 => ground(draw),
        2 => kink(draw),
        3 => ridge(draw),
        4 => wells(draw),
        5 => fall(draw),
        6 => fade(draw),
        7 => flat(draw),
        8 => beam(draw),
        9 => barrier(draw),
        10 => cubic_ground(draw),
        _ => molecule(draw),
    };
    let v = in_units(v, &units);
    let start: Vec<f64> = start.iter().map(|q| q * units.length).collect();
    let mass = masses(draw, v.freedoms);
    let case = Case { v, start, known };
    draw.note(format!("family {family}, {known:?}, {} freedoms", case.v.freedoms));
    draw.note(format!("length {:e}, energy {:e}", units.length, units.energy));
    draw.note(format!("masses {mass:?}"));
    draw.note(format!("start {:?}", case.start));
    for term in case.v.terms.iter().take(12) {
        draw.note(format!("{term:?}"));
    }
    let Ok(metric) = DiagonalMetric::new(mass) else {
        return Verdict::not_judged("no metric");
    };
    let mut q = case.start.clone();
    let found = if draw.chance(0.5) {
        match SparseSolver::new(&metric, &case.v, &q) {
            Ok(solver) => find(&metric, &case.v, solver, &mut q),
            Err(error) => return Verdict::wrong(format!("no solver: {error}")),
        }
    } else {
        match DenseSolver::<Vec<f64>>::new(case.v.freedoms) {
            Some(solver) => find(&metric, &case.v, solver, &mut q),
            None => return Verdict::wrong("no solver"),
        }
    };
    judge(&case, &q, found)
}

fn find(
    metric: &DiagonalMetric<Vec<f64>>,
    v: &Landscape,
    solver: impl HessianSolver,
    q: &mut [f64],
) -> Result<EquilibriumReport, NewtonError> {
    // From millions of lengths away into a quartic well Newton takes fifty steps and more.
    let newton = Newton { iterations: 200, ..Newton::default() };
    match Equilibrium::new(metric, v, solver, newton) {
        Ok(mut search) => search.find(q),
        Err(error) => panic!("{error}"),
    }
}

fn judge(case: &Case, q: &[f64], found: Result<EquilibriumReport, NewtonError>) -> Verdict {
    if q.iter().any(|q| !q.is_finite()) {
        return Verdict::wrong(format!("q is {q:?} after {found:?}"));
    }
    let unbounded = |error: &NewtonError| error.failure == NewtonFailure::Unbounded;
    match (found, case.known) {
        (Ok(report), Known::Minimum | Known::Kink) => at_rest(case, q, &report),
        (Ok(report), Known::Unbounded) => {
            // On a saddle there is no force; it is no minimum, and the report has to say so.
            let verdict = at_rest(case, q, &report);
            if report.kind == Stationary::Minimum {
                Verdict::wrong(format!("a minimum of what falls without end, at {q:?}"))
            } else {
                verdict
            }
        }
        (Ok(_), Known::NoRest) => Verdict::wrong(format!("at rest where none is, at {q:?}")),
        (Err(error), Known::Unbounded) if unbounded(&error) => Verdict::due(),
        (Err(error), Known::NoRest) if !unbounded(&error) => Verdict::due(),
        (Err(error), Known::Kink) => {
            if error.to_string().contains("singular") {
                Verdict::wrong(format!("a kink: {error}"))
            } else {
                Verdict::due()
            }
        }
        // It has an answer, which was not found, and says so.
        (Err(error), Known::Minimum | Known::Unbounded)
            if matches!(error.failure, NewtonFailure::Stalled | NewtonFailure::NotConverged) =>
        {
            Verdict::refused(error.failure)
        }
        (Err(error), known) => Verdict::wrong(format!("{known:?}: {error}")),
    }
}

/// No force, and where a minimum is named no curvature downwards.
fn at_rest(case: &Case, q: &[f64], report: &EquilibriumReport) -> Verdict {
    let force = DVector::from_vec(case.v.differential(q));
    let sizes = case.v.size_of_terms(q);
    let mut verdict = Verdict::due();
    for (i, (f, size)) in force.iter().zip(sizes.iter()).enumerate() {
        let promised = ROUNDINGS * f64::EPSILON * size + f64::MIN_POSITIVE;
        verdict = verdict.and(Verdict::of(f.abs(), promised, &format!("force {i}")));
    }
    if case.v.energy(q) > case.v.energy(&case.start) + 1e-12 * case.v.energy(&case.start).abs() {
        return Verdict::wrong("the energy rose");
    }
    match &report.kind {
        Stationary::Minimum if !q.is_empty() => {
            let h = equilibrated(case.v.hessian(q));
            let smallest = SymmetricEigen::new(h).eigenvalues.min();
            if smallest < -1e-9 {
                return Verdict::wrong(format!("a minimum, with an eigenvalue of {smallest:e}"));
            }
        }
        Stationary::Saddle { down, .. } => {
            let w = DVector::from_column_slice(down.components());
            let bend = w.dot(&(case.v.hessian(q) * &w));
            if bend.is_nan() || bend >= 0.0 {
                return Verdict::wrong(format!("down is up, with a curvature of {bend:e}"));
            }
        }
        _ => {}
    }
    verdict
}

/// The matrix with rows and columns scaled so that no entry exceeds one.
fn equilibrated(h: DMatrix<f64>) -> DMatrix<f64> {
    let largest = h.amax();
    if largest == 0.0 {
        return h;
    }
    let h = h / largest;
    let scale: Vec<f64> = h
        .row_iter()
        .enumerate()
        .map(|(i, row)| h[(i, i)].abs().max(row.amax() * row.amax()).sqrt())
        .collect();
    let one = |x: f64| if x > 0.0 { x } else { 1.0 };
    DMatrix::from_fn(h.nrows(), h.ncols(), |i, j| h[(i, j)] / one(scale[i]) / one(scale[j]))
}

fn units(draw: &mut Draw) -> Units {
    let [length, energy] = match draw.below(4) {
        0 | 1 => [1.0, 1.0],
        2 => [draw.log_uniform(1e-9, 1e6), draw.log_uniform(1e-25, 1e25)],
        _ => [1.0, 10.0_f64.powf(draw.uniform(-220.0, 220.0))],
    };
    Units { length, energy }
}

/// A landscape in other units. Directions are pure numbers.
fn in_units(v: Landscape, units: &Units) -> Landscape {
    let term = |term: Term| {
        let coordinate = match term.coordinate {
            Coordinate::Distance(a, End::Held(place), d) => {
                Coordinate::Distance(a, End::Held(place.map(|x| x * units.length)), d)
            }
            other => other,
        };
        Term {
            coordinate,
            offset: term.offset * units.length,
            energy: term.energy * units.energy,
            length: term.length * units.length,
            ..term
        }
    };
    Landscape { terms: v.terms.into_iter().map(term).collect(), ..v }
}

fn masses(draw: &mut Draw, n: usize) -> Vec<f64> {
    let spread = draw.one_of(&[1.0, 1e2, 1e6]);
    let common = draw.log_uniform(1e-6, 1e6);
    (0..n).map(|_| common * draw.log_uniform(1.0, spread)).collect()
}
