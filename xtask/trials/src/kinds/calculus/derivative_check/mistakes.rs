//! One mistake in a right potential: of its differential, of a block of its Hessian, or of the order of the
//! blocks; drawn so that it can be seen where it has to be looked for.

use nalgebra::DMatrix;
use stationary_calculus::{Covector, Potential, Sink};

use super::{Case, VISIBLE};
use crate::Draw;
use crate::kinds::calculus::landscape::{Coordinate, Landscape, Shape, Term};

/// One mistake.
#[derive(Clone, Debug)]
pub(super) enum Mistake {
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
    pub(super) fn is_of_the_differential(&self) -> bool {
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
    pub(super) fn is_of_the_visit(&self) -> bool {
        matches!(self, Mistake::Order { .. } | Mistake::Visit { .. })
    }
}

fn beyond(q: f64, bound: f64, above: bool) -> bool {
    (q > bound) == above
}

/// A potential with a mistake.
pub(super) struct Mistaken {
    pub(super) v: Landscape,
    pub(super) mistake: Mistake,
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

/// How large the mistake is somewhere it must be looked for, relative to its row.
pub(super) fn mistake(draw: &mut Draw, case: &mut Case) -> Option<Mistake> {
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
            let wave = draw.log_uniform(1.0, 1e3) / far;
            let seen = height * wave * (wave * q[freedom]).cos().abs() >= 3e-5 * row;
            (n <= 8 && seen && row > 0.0).then_some(Mistake::Ripple { freedom, height, wave })
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
            (differ && defined).then_some(Mistake::Order { freedom, bound, above })
        }
        _ => defined.then_some(Mistake::Visit { freedom, bound, above }),
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
