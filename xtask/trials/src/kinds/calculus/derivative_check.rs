//! Right derivatives, which a check must pass, and derivatives with one mistake, which it must name.

use nalgebra::DMatrix;
use stationary_calculus::{
    Covector, Derivative, DerivativeCheck, DerivativeError, Potential, Sink,
};

use super::landscape::{Coordinate, End, Landscape, Shape, Term};
use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "derivative-check",
    krate: "calculus",
    rule: "a right potential that is not passed; a mistake of 1e-4 of its row's largest entry or more, \
           at the configuration or on a branch within half a typical length of it, that is passed by a \
           report that does not say it was blind to it; a mistake of the differential that is blamed on the Hessian, or the other way round",
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

/// Any sum of smooth terms, in units of its own.
fn smooth(draw: &mut Draw) -> Case {
    let n = draw.one_of(&[1, 1, 2, 3, 5, 8, 40]);
    let (length, energy) = match draw.below(3) {
        0 => (1.0, 1.0),
        _ => (draw.log_uniform(1e-12, 1e6), draw.log_uniform(1e-26, 1e20)),
    };
    let q: Vec<f64> = draw.vector(n).iter().map(|x| x * length).collect();
    let shapes = [
        Shape::Linear,
        Shape::Quadratic,
        Shape::Hill,
        Shape::TwoWells,
        Shape::Fall,
        Shape::Power(4.0),
        Shape::Cosine,
        Shape::Fade,
    ];
    let count = n + draw.below(3);
    let mut terms = Vec::new();
    for k in 0..count {
        let mut a = vec![(k % n, draw.uniform(0.3, 1.0))];
        if n > 1 && draw.chance(0.5) {
            a.push(((k + 1 + draw.below(n - 1)) % n, draw.symmetric()));
        }
        let term = Term::along(a, length * draw.symmetric(), draw.one_of(&shapes));
        let scale = length * draw.uniform(0.7, 3.0);
        terms.push(term.scaled(energy * draw.log_uniform(0.1, 10.0), scale));
    }
    // A typical length that q does not show has to be told.
    let shown = q.iter().fold(0.0_f64, |m, x| m.max(x.abs())) > 0.2 * length;
    let told = !shown || draw.chance(0.3);
    let case_length = told.then_some(length);
    Case { v: Landscape { freedoms: n, terms }, q, length: case_length }
}

/// Functions that end or bend sharply at a place very near, without a length told.
fn singular(draw: &mut Draw) -> Case {
    let n = draw.between(1, 3);
    let mut terms = Vec::new();
    let mut q = Vec::new();
    for i in 0..n {
        let distance = draw.log_uniform(1e-10, 1.0);
        let shape = draw.one_of(&[
            Shape::Power(1.5),
            Shape::Power(2.5),
            Shape::Ground,
            Shape::SoftGround,
            Shape::Barrier,
            Shape::Inverse,
        ]);
        let k = draw.log_uniform(1e-3, 1e6);
        terms.push(Term::along(vec![(i, 1.0)], 0.0, shape).scaled(k, 1.0));
        let one_sided = matches!(shape, Shape::Barrier | Shape::Inverse);
        q.push(if !one_sided && draw.chance(0.5) { -distance } else { distance });
    }
    Case { v: Landscape { freedoms: n, terms }, q, length: None }
}

/// Walls and grounds beside which the configuration lies, away from the origin.
fn walls(draw: &mut Draw) -> Case {
    let n = draw.between(1, 3);
    let mut terms = Vec::new();
    let mut q = Vec::new();
    for i in 0..n {
        let wall = draw.uniform(-2.0, 2.0);
        let distance = draw.log_uniform(1e-10, 1.0);
        let shape = draw.one_of(&[Shape::Barrier, Shape::Ground, Shape::Power(2.5)]);
        let k = draw.log_uniform(1e-3, 1e6);
        terms.push(Term::along(vec![(i, 1.0)], wall, shape).scaled(k, 1.0));
        let below = shape != Shape::Barrier && draw.chance(0.7);
        q.push(wall + if below { -distance } else { distance });
    }
    Case { v: Landscape { freedoms: n, terms }, q, length: None }
}

/// Atoms of a real or of another gas, in SI units or in their own.
fn atoms(draw: &mut Draw) -> Case {
    let (sigma, epsilon) = match draw.below(2) {
        0 => (draw.log_uniform(1e-10, 1e-9), draw.log_uniform(1e-23, 1e-20)),
        _ => (draw.log_uniform(1e-3, 1e3), draw.log_uniform(1e-6, 1e6)),
    };
    let (dimension, atoms) = (draw.between(2, 3), draw.between(2, 4));
    let mut q = Vec::new();
    for k in 0..atoms {
        let corner = [(k % 2) as f64, (k / 2) as f64, 0.0];
        let spread = draw.uniform(1.0, 1.8);
        q.extend(corner[..dimension].iter().map(|x| sigma * (spread * x + 0.1 * draw.symmetric())));
    }
    let mut terms = Vec::new();
    for a in 0..atoms {
        for b in 0..a {
            let coordinate =
                Coordinate::Distance(dimension * a, End::Free(dimension * b), dimension);
            let shape = Shape::LennardJones;
            terms.push(Term { coordinate, offset: 0.0, energy: epsilon, length: sigma, shape });
        }
    }
    let length = draw.chance(0.3).then_some(sigma);
    Case { v: Landscape { freedoms: dimension * atoms, terms }, q, length }
}

/// One mistake.
#[derive(Clone, Debug)]
enum Mistake {
    /// One component of the differential times a factor.
    Component(usize, f64),
    /// A number added to one component.
    Constant(usize, f64),
    /// A term left out of the differential.
    ForgottenForce(usize),
    /// Two components exchanged.
    Exchanged(usize, usize),
    /// The last term's components are written over what was there.
    Assigned(usize),
    /// The component is right up to a bound and times a factor beyond it.
    Branch { freedom: usize, bound: f64, above: bool, factor: f64 },
    /// A ripple too low to be seen in the differential, but not in its slope.
    Ripple { freedom: usize, height: f64, wave: f64 },
    /// A term's block times a factor.
    Block(usize, f64),
    /// A term's block left out.
    ForgottenBlock(usize),
    /// A term's block times a factor beyond a bound of a freedom.
    BlockBranch { term: usize, freedom: usize, bound: f64, above: bool, factor: f64 },
    /// One coupling of a block with the other sign, in both triangles.
    Coupling(usize),
    /// One triangle only.
    Unsymmetric(usize),
    /// The blocks come in another order beyond a bound of a freedom.
    Order { freedom: usize, bound: f64, above: bool },
    /// The block of a term is not visited beyond a bound, where it is zero.
    Visit { freedom: usize, bound: f64, above: bool },
}

impl Mistake {
    fn is_of_the_differential(&self) -> bool {
        use Mistake::*;
        matches!(
            self,
            Component(..)
                | Constant(..)
                | ForgottenForce(_)
                | Exchanged(..)
                | Assigned(_)
                | Branch { .. }
                | Ripple { .. }
        )
    }

    /// Whether the blocks' order is what is wrong.
    fn is_of_the_visit(&self) -> bool {
        matches!(self, Mistake::Order { .. } | Mistake::Visit { .. })
    }
}

fn beyond(q: f64, bound: f64, above: bool) -> bool {
    (q > bound) == above
}

/// A potential with a mistake.
struct Mistaken {
    v: Landscape,
    mistake: Mistake,
}

impl Potential for Mistaken {
    fn dim(&self) -> usize {
        self.v.freedoms
    }

    fn energy(&self, q: &[f64]) -> f64 {
        self.v.energy(q)
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let mut own = self.v.differential(q);
        let one = |term: usize| Landscape { terms: vec![self.v.terms[term].clone()], ..self.v };
        match self.mistake {
            Mistake::Component(i, factor) => own[i] *= factor,
            Mistake::Constant(i, constant) => own[i] += constant,
            Mistake::ForgottenForce(term) => {
                let lost = one(term).differential(q);
                own.iter_mut().zip(lost).for_each(|(own, lost)| *own -= lost);
            }
            Mistake::Exchanged(i, j) => own.swap(i, j),
            Mistake::Branch { freedom, bound, above, factor }
                if beyond(q[freedom], bound, above) =>
            {
                own[freedom] *= factor;
            }
            Mistake::Ripple { freedom, height, wave } => {
                own[freedom] += height * (wave * q[freedom]).sin();
            }
            Mistake::Assigned(i) => dv.0[i] = 0.0,
            _ => {}
        }
        dv.0.iter_mut().zip(own).for_each(|(dv, own)| *dv += own);
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        let mut blocks = self.v.blocks(q);
        match self.mistake {
            Mistake::Block(term, factor) => blocks[term].1.iter_mut().for_each(|x| *x *= factor),
            Mistake::ForgottenBlock(term) => blocks[term].1.fill(0.0),
            Mistake::BlockBranch { term, freedom, bound, above, factor }
                if beyond(q[freedom], bound, above) =>
            {
                blocks[term].1.iter_mut().for_each(|x| *x *= factor);
            }
            Mistake::Coupling(term) => {
                let k = blocks[term].0.len();
                blocks[term].1[1] *= -1.0;
                blocks[term].1[k] *= -1.0;
            }
            Mistake::Unsymmetric(term) => blocks[term].1[1] = 0.0,
            Mistake::Order { freedom, bound, above } if beyond(q[freedom], bound, above) => {
                blocks.reverse();
            }
            Mistake::Visit { freedom, bound, above } if beyond(q[freedom], bound, above) => {
                hessian.add_symmetric(&[freedom], &[0.0]);
            }
            _ => {}
        }
        for (freedoms, block) in blocks {
            hessian.add_symmetric(&freedoms, &block);
        }
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
        Ok(report) if report.unseen() >= VISIBLE => {
            return Verdict::refused("blind, and says so");
        }
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
        Some(blamed) if blamed == guilty && !mistake.is_of_the_visit() => Verdict::due(),
        Some(blamed) => Verdict::wrong(format!("{mistake:?} is blamed on the {blamed}")),
        None => Verdict::due(),
    }
}

/// How large the mistake is somewhere it must be looked for, relative to its row.
fn mistake(draw: &mut Draw, case: &mut Case) -> Option<Mistake> {
    let Case { v, q, length } = &case.clone();
    let n = v.freedoms;
    let dv = v.differential(q);
    let h = v.hessian(q);
    let largest = dv.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let freedom = draw.below(n);
    let term = draw.below(v.terms.len());
    let shown = q.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let far = length.unwrap_or(if shown < 1e-6 { shown } else { shown.max(1.0) });
    let factor = match draw.below(3) {
        0 => 1.0 + draw.log_uniform(1e-3, 1.0),
        1 => 1.0 - draw.log_uniform(1e-3, 1.0),
        _ => -1.0,
    };
    let above = draw.chance(0.5);
    let bound = {
        let way = far * draw.log_uniform(1e-2, 0.45);
        q[freedom] + if above { way } else { -way }
    };
    // Where a branch is looked for the terms must not be flat or enormous: the length is theirs.
    let branches = (0.2..=3.0).contains(&(far / v.terms[0].length));
    let moved = |way: f64| {
        let mut q = q.clone();
        q[freedom] += way;
        q
    };
    let beyond = moved(if above { 0.7 * far } else { -0.7 * far });
    // Where the energy is out of all bounds, the check moves less far.
    let defined = v.energy(&beyond).abs() < 1e100
        && v.energy(&moved(if above { far } else { -far })).abs() < 1e100;
    let mistake = match draw.below(15) {
        0 => {
            let there = (factor - 1.0).abs() * dv[freedom].abs();
            (there >= VISIBLE * largest).then_some(Mistake::Component(freedom, factor))
        }
        1 => Some(Mistake::Constant(freedom, largest * draw.log_uniform(10.0 * VISIBLE, 1.0))),
        2 => {
            let one = Landscape { terms: vec![v.terms[term].clone()], ..v.clone() };
            let lost = one.differential(q).iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            (lost >= VISIBLE * largest).then_some(Mistake::ForgottenForce(term))
        }
        3 => {
            let other = draw.below(n);
            let off = (dv[freedom] - dv[other]).abs();
            (off >= VISIBLE * largest).then_some(Mistake::Exchanged(freedom, other))
        }
        4 => Some(Mistake::Assigned(freedom)),
        5 => {
            let there = v.differential(&beyond);
            let row = there.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            let seen = (factor - 1.0).abs() * there[freedom].abs() >= 0.1 * row;
            let mistake = Mistake::Branch { freedom, bound, above, factor };
            (n <= 8 && branches && seen).then_some(mistake)
        }
        6 => {
            let row = h.row(freedom).amax();
            let height = largest * draw.log_uniform(1e-8, 3e-7);
            let wave = draw.log_uniform(1.0, 1e2) / far;
            // The energy has to show it as well: it knows its second derivative to half its digits.
            let slope = height * wave * (wave * q[freedom]).cos().abs();
            let seen = slope >= 3e-5 * row && slope >= 1e-6 * v.energy(q).abs() / far / far;
            let known = length.is_some() || shown > 1e-6;
            (n <= 8 && seen && known && row > 0.0).then_some(Mistake::Ripple {
                freedom,
                height,
                wave,
            })
        }
        7 if n > 1 => {
            // A load on another freedom beside which this one's force is too small to be seen.
            let load = largest * draw.log_uniform(1e4, 3e7);
            let other = (freedom + 1 + draw.below(n - 1)) % n;
            let term = Term::along(vec![(other, 1.0)], 0.0, Shape::Linear);
            case.v.terms.push(term.scaled(load, 1.0));
            let seen = (factor - 1.0).abs() >= 1e-2 && h.row(freedom).amax() > 0.0;
            let own = h[(freedom, freedom)].abs() >= 0.1 * h.row(freedom).amax();
            (n <= 8 && seen && own && dv[freedom].abs() > 1e-3 * largest)
                .then_some(Mistake::Component(freedom, factor))
        }
        8 => block(&h, v, q, term, |factor| Mistake::Block(term, factor), factor),
        9 => block(&h, v, q, term, |_| Mistake::ForgottenBlock(term), 0.0),
        10 => {
            let row = (0..n).filter(|_| n <= 8 && branches).find(|&i| {
                let whole = v.hessian(&beyond).row(i).amax();
                let own = own_hessian(v, term, &beyond).row(i).amax();
                own * (factor - 1.0).abs() >= 0.1 * whole && whole > 0.0
            });
            row.map(|_| Mistake::BlockBranch { term, freedom, bound, above, factor })
        }
        11 | 12 => {
            let own = own_hessian(v, term, q);
            let Coordinate::Along(a) = &v.terms[term].coordinate else { return None };
            let [(i, _), (j, _)] = a[..] else { return None };
            let seen = own[(i, j)].abs() >= 10.0 * VISIBLE * h.row(i).amax().max(h.row(j).amax());
            (i != j && seen && own[(i, j)] != 0.0).then(|| {
                if draw.chance(0.5) { Mistake::Coupling(term) } else { Mistake::Unsymmetric(term) }
            })
        }
        13 => {
            let blocks = v.blocks(q);
            let differ = blocks.iter().zip(blocks.iter().rev()).any(|(a, b)| a.0 != b.0);
            (n <= 8 && differ && defined).then_some(Mistake::Order { freedom, bound, above })
        }
        _ => (n <= 8 && defined).then_some(Mistake::Visit { freedom, bound, above }),
    };
    mistake.filter(|_| largest > 0.0 && h.amax() > 0.0)
}

fn own_hessian(v: &Landscape, term: usize, q: &[f64]) -> DMatrix<f64> {
    Landscape { terms: vec![v.terms[term].clone()], ..*v }.hessian(q)
}

/// A mistake of a block, where a row shows it.
fn block(
    h: &DMatrix<f64>,
    v: &Landscape,
    q: &[f64],
    term: usize,
    mistake: impl Fn(f64) -> Mistake,
    factor: f64,
) -> Option<Mistake> {
    let own = own_hessian(v, term, q) * (factor - 1.0);
    let rows = 0..h.nrows();
    let seen =
        |i: usize| own.row(i).amax() >= 10.0 * VISIBLE * h.row(i).amax() && own.row(i).amax() > 0.0;
    rows.into_iter().any(seen).then(|| mistake(factor))
}
