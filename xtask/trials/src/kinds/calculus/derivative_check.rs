//! Right derivatives, which a check must pass, and derivatives with one mistake, which it must name.

mod potentials;
mod mistakes;

use stationary_calculus::{Derivative, DerivativeCheck, DerivativeError};

use super::landscape::Landscape;
use crate::{Draw, Kind, Verdict};
use mistakes::{Mistaken, mistake};
use potentials::{atoms, singular, smooth, walls};

pub(super) const KIND: Kind = Kind {
    name: "derivative-check",
    krate: "calculus",
    rule: "a right potential that is not passed; a mistake of 1e-4 of its row's largest entry or more, \
           at the configuration or on a branch within half a typical length of it, that is passed; a \
           mistake of the differential that is blamed on the Hessian, or the other way round",
    in_tests: 600,
    trial,
};

/// A mistake of less than this, relative to the row's largest entry, need not be found.
const VISIBLE: f64 = 1e-4;

fn trial(draw: &mut Draw) -> Verdict {
    if draw.chance(0.5) { wrong(draw) } else { right(draw) }
}

/// A right potential, its configuration, and the typical length that is given with it, if any.
#[derive(Clone)]
struct Case {
    v: Landscape,
    q: Vec<f64>,
    length: Option<f64>,
}

fn check(draw: &mut Draw, length: Option<f64>) -> DerivativeCheck {
    DerivativeCheck { length, seed: draw.word(), ..DerivativeCheck::default() }
}

fn note(draw: &mut Draw, case: &Case) {
    draw.note(format!("{} freedoms, length {:?}", case.v.freedoms, case.length));
    draw.note(format!("q {:?}", case.q.iter().take(8).collect::<Vec<_>>()));
    for term in case.v.terms.iter().take(8) {
        draw.note(format!("{term:?}"));
    }
}

fn right(draw: &mut Draw) -> Verdict {
    let case = match draw.below(5) {
        0 => singular(draw),
        1 => atoms(draw),
        2 => walls(draw),
        _ => smooth(draw),
    };
    note(draw, &case);
    match check(draw, case.length).potential(&case.v, &case.q) {
        Ok(_) => Verdict::due(),
        Err(error) => Verdict::wrong(format!("a false alarm: {error}")),
    }
}

fn wrong(draw: &mut Draw) -> Verdict {
    let mut case = smooth(draw);
    if case.length.is_none() && case.q.iter().all(|q| q.abs() < 1e-6) {
        // So small a problem has to be told from small displacements.
        case.length = Some(case.v.terms[0].length);
    }
    let Some(mistake) = mistake(draw, &mut case) else {
        return Verdict::due();
    };
    note(draw, &case);
    draw.note(format!("{mistake:?}"));
    let mistaken = Mistaken { v: case.v.clone(), mistake: mistake.clone() };
    let error = match check(draw, case.length).potential(&mistaken, &case.q) {
        Err(error) => error,
        Ok(_) => return Verdict::wrong(format!("missed: {mistake:?}")),
    };
    let blamed = match &error {
        DerivativeError::Wrong(entry) => Some(entry.derivative),
        DerivativeError::NotSymmetric { .. } => Some(Derivative::Hessian),
        _ => None,
    };
    let guilty = if mistake.is_of_the_differential() {
        Derivative::Differential
    } else {
        Derivative::Hessian
    };
    match blamed {
        Some(Derivative::DifferentialOrHessian) => Verdict::refused("cannot tell which is wrong"),
        Some(blamed) if blamed == guilty && !mistake.is_of_the_visit() => Verdict::due(),
        Some(blamed) => Verdict::wrong(format!("{mistake:?} is blamed on the {blamed}")),
        None => Verdict::due(),
    }
}
