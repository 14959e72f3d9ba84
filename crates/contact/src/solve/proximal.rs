//! All contacts of an island at once: a step of the proximal-point method, by Newton's.
//!
//! ```text
//! min_w 1/2 |w - b|^2 + sum_i max_(x_i in C_i) (-x_i.u_i(w) - e_i/2 |x_i - a_i|^2)
//! x_i(w) = proj_i (a_i - u_i(w)/e_i),     w = J~^T x(w) + b        where that is smallest
//! (1 + J~^T D J~) dw = J~^T x(w) + b - w,     D = -dx/du         Newton's step, with a line search
//! x <- a + t (x(w) - a)                                            0 <= t <= 1, of least energy
//! ```
//! `w` scaled velocities, `b` those by the impulses of what is not of the island, `u = J~ w + o`
//! rates (m/s), `a` the impulses (N s) that the step starts from, `C_i` those that push, with
//! friction within `mu` times the normal impulse of `a_i`, `e` a small part of each row's
//! compliance. The problem is convex and has one solution, whatever contacts are redundant and
//! however their gaps fail to fit each other; after a few such steps `x` stays where it is, and `e`
//! has no say any more. Newton's matrix joins bodies as contacts do. From one Newton step to the
//! next only contacts that answer otherwise are added to it again, and it is factored where it has
//! changed, sparsely: a heap is nearly a tree. Where Newton's method is cut short, the last line
//! still lowers the energy.
//!
//! Where contacts are taken to hold, `x = a - u/e`, and to let go where `x` would pull (see [`Grip`]), what stands on
//! them is at rest after a few systems, however high a tower is. `u` is then what it was plus what steps change, as
//! rounding of `w` over so small an `e` would be seen in `x`.
//!
//! Source: Rockafellar 1976 (proximal points); Hintermueller, Ito and Kunisch 2003 (Newton's method
//! for who pushes, as active sets); Todorov 2014, Castro and others 2022 (the same for contact).

use crate::solve::block_cholesky::{Block, BlockCholesky};
use crate::solve::friction::{disc, into_cone, square_across};
use crate::solve::grip::Grip;
use crate::solve::rigid_contact::{RigidContact, dot};
use crate::solve::sweeps::Island;
use stationary_calculus::array;

/// The most steps of Newton's method.
const NEWTONS: usize = 8;
/// The most systems of contacts that are let hold, and those of the same ones: more than one, for what is so stiff
/// leaves its rounding.
const HOLDS: usize = 12;
const REFINEMENTS: usize = 3;
/// Slopes along a step of Newton's method that are tried.
const TRIES: usize = 12;
/// The part of the slope at the start that may be left at the end.
const LINE_SEARCH_SLOPE: f64 = 0.05;
/// A decrease, relative to the kinetic energy and to the energy of what is left, that ends Newton's
/// method.
const ENERGY_ROUNDING: f64 = 1e-28;
const ENERGY_PART: f64 = 0.03;
/// Friction this close to its reach slides.
const SLIDES: f64 = 1.0 - 1e-9;

/// The memory of a step.
#[derive(Debug, Default)]
pub(crate) struct Proximal<const F: usize, const D: usize> {
    /// The number of each body of the island, in order.
    number: Vec<usize>,
    joints: Vec<[usize; 2]>,
    matrix: BlockCholesky<F>,
    /// Where the step starts, impulses and velocities, and these without the impulses.
    centre: Vec<[f64; D]>,
    from: Vec<[f64; F]>,
    base: Vec<[f64; F]>,
    /// The rates, and how much Newton's step changes them.
    rates: Vec<[f64; D]>,
    turn: Vec<[f64; D]>,
    /// How stiffly each contact answers in the matrix.
    stiff: Vec<[[f64; D]; D]>,
    /// Newton's step, by the numbers of the bodies.
    step: Vec<[f64; F]>,
    /// One over the compliance that is added to a row, relative to the row's own.
    firm: f64,
    /// How each contact is taken to grip.
    grips: Vec<Grip>,
}

/// By which answers of the contacts Newton's matrix is made.
#[derive(Clone, Copy)]
enum Judged {
    /// Those to the rates as they are.
    Now,
    /// Whoever pushes and sticks is taken to go on.
    Before,
    /// What each is taken to grip.
    Gripping,
}

/// What a contact answers to rates.
#[derive(Clone, Copy)]
struct Answer<const D: usize> {
    x: [f64; D],
    /// The impulse wanted across, its length, and the radius of the disc that cuts it.
    wanted: [f64; D],
    length: f64,
    radius: f64,
}

impl<const D: usize> Answer<D> {
    #[inline]
    fn of<const F: usize>(
        contact: &RigidContact<F, D>,
        a: &[f64; D],
        rates: [f64; D],
        firm: f64,
    ) -> Self {
        let mass = &contact.compliance;
        let across = firm * mass.across_mass;
        let radius = contact.friction * a[0];
        let wanted: [f64; D] = array(|k| a[k] - rates[k] * across);
        let length = square_across(&wanted).sqrt();
        let scale = if length > radius { radius / length } else { 1.0 };
        let mut x: [f64; D] = array(|k| wanted[k] * scale);
        x[0] = (a[0] - rates[0] * firm * mass.normal_mass).max(0.0);
        Answer { x, wanted, length, radius }
    }

    /// How stiffly it answers: along its normal, and along its tangents.
    #[inline]
    fn stiffness<const F: usize>(&self, contact: &RigidContact<F, D>, firm: f64) -> [[f64; D]; D] {
        let mut stiff = [[0.0; D]; D];
        if self.x[0] > 0.0 {
            stiff[0][0] = firm * contact.compliance.normal_mass;
        }
        let across = firm * contact.compliance.across_mass;
        if self.radius <= 0.0 {
            return stiff;
        }
        if self.length < SLIDES * self.radius {
            (1..D).for_each(|k| stiff[k][k] = across);
            return stiff;
        }
        // What slides answers across its sliding alone.
        let across = across * self.radius / self.length;
        let along: [f64; D] = array(|k| self.wanted[k] / self.length);
        for (k, row) in stiff.iter_mut().enumerate().skip(1) {
            for (l, stiff) in row.iter_mut().enumerate().skip(1) {
                *stiff = -across * along[k] * along[l];
            }
            row[k] += across;
        }
        if D == 2 {
            stiff[1][1] = 0.0;
        }
        stiff
    }
}

impl<const F: usize, const D: usize> Proximal<F, D> {
    /// Changes the impulses of an island, and the velocities with them, given the compliance that
    /// is added relative to each row's own and the energy of what is left; says how many systems it
    /// solved.
    pub(crate) fn step(
        &mut self,
        island: Island<F, D>,
        [soft, left]: [f64; 2],
        x: &mut [[f64; D]],
        w: &mut [[f64; F]],
    ) -> usize {
        self.firm = soft.recip();
        self.start(island, x, w);
        let mut solved = 0;
        for newton in 0..NEWTONS {
            let judged = if newton == 0 { Judged::Before } else { Judged::Now };
            let changed = self.assemble(island, w, judged);
            if (newton == 0 || changed) && !self.matrix.factor() {
                break;
            }
            let promised = self.matrix.solve(&mut self.step);
            solved += 1;
            let part = self.search(island, w, promised);
            for (&body, step) in island.bodies.iter().zip(&self.step) {
                (0..F).for_each(|f| w[body][f] += part * step[f]);
            }
            for (rates, turn) in self.rates.iter_mut().zip(&self.turn) {
                (0..D).for_each(|k| rates[k] += part * turn[k]);
            }
            let kinetic: f64 = island.bodies.iter().map(|&body| dot(&w[body], &w[body])).sum();
            if promised <= ENERGY_ROUNDING * kinetic + ENERGY_PART * left {
                break;
            }
        }
        self.go(island, x, w);
        solved
    }

    /// Takes so many contacts to hold, all of them.
    pub(crate) fn grip(&mut self, contacts: usize) {
        self.grips.clear();
        self.grips.resize(contacts, Grip::Holds);
    }

    /// Changes the impulses of an island, and the velocities with them, to those with which contacts hold what they
    /// touch, given the compliance that is added relative to each row's own: from those that gripped last on, until it
    /// is the same ones, neither those that would pull nor the friction of those that would slide. What no contact can
    /// have is taken back into its cone. Says how many systems it solved.
    pub(crate) fn hold(
        &mut self,
        island: Island<F, D>,
        soft: f64,
        x: &mut [[f64; D]],
        w: &mut [[f64; F]],
    ) -> usize {
        self.firm = soft.recip();
        self.start(island, x, w);
        let (mut solved, mut same) = (0, 0);
        while solved < HOLDS && same < REFINEMENTS {
            if same == 0 {
                // Made anew: what lets go would leave its rounding in the matrix.
                self.matrix.reset(island.bodies.len(), &self.joints);
                self.stiff.fill([[0.0; D]; D]);
            }
            let changed = self.assemble(island, w, Judged::Gripping);
            if changed && !self.matrix.factor() {
                break;
            }
            self.matrix.solve(&mut self.step);
            solved += 1;
            for (&body, step) in island.bodies.iter().zip(&self.step) {
                (0..F).for_each(|f| w[body][f] += step[f]);
            }
            self.turn_by_step(island);
            same += 1;
            for (k, contact) in island.contacts.iter().enumerate() {
                // Not from velocities: their rounding would be in what is so stiff, and nothing would balance.
                let rates = array(|d| self.rates[k][d] + self.turn[k][d]);
                let a = &self.centre[k];
                self.rates[k] = rates;
                let x = self.grips[k].answer(contact, a, rates, self.firm);
                let next = self.grips[k].next(&x, rates[0], contact.friction);
                if next != self.grips[k] {
                    same = 0;
                }
                self.grips[k] = next;
            }
        }
        give(island, &self.from, w);
        for (k, (contact, x)) in island.contacts.iter().zip(x.iter_mut()).enumerate() {
            let a = self.centre[k];
            let answer = self.grips[k].answer(contact, &a, self.rates[k], self.firm);
            *x = into_cone(answer, contact.friction);
            contact.push(&array(|k| x[k] - a[k]), w);
        }
        solved
    }

    /// Numbers the bodies of an island, says which are joined, and remembers where it starts.
    fn start(&mut self, island: Island<F, D>, x: &[[f64; D]], w: &mut [[f64; F]]) {
        let still = w.len() - 1;
        self.number.resize(still, 0);
        for (number, &body) in island.bodies.iter().enumerate() {
            self.number[body] = number;
        }
        self.joints.clear();
        let mut last = [still; 2];
        for contact in island.contacts {
            let bodies = contact.bodies;
            if bodies != last && !bodies.contains(&still) {
                self.joints.push(bodies.map(|body| self.number[body]));
            }
            last = bodies;
        }
        self.from.clear();
        self.from.extend(island.bodies.iter().map(|&body| w[body]));
        self.base.clear();
        for (contact, x) in island.contacts.iter().zip(x) {
            contact.push(&array(|k| -x[k]), w);
        }
        self.base.extend(island.bodies.iter().map(|&body| w[body]));
        give(island, &self.from, w);
        self.centre.clear();
        self.centre.extend(x.iter().copied());
        self.rates.clear();
        self.rates.extend(island.contacts.iter().map(|contact| contact.rates(w)));
        self.matrix.reset(island.bodies.len(), &self.joints);
        self.stiff.clear();
        self.stiff.resize(self.rates.len(), [[0.0; D]; D]);
    }

    /// Brings Newton's matrix up to date, and writes the right side in the place of the step; says
    /// whether the matrix has changed.
    fn assemble(&mut self, island: Island<F, D>, w: &[[f64; F]], judged: Judged) -> bool {
        let still = w.len() - 1;
        self.step.clear();
        self.step.resize(island.bodies.len(), [0.0; F]);
        for ((step, &body), base) in self.step.iter_mut().zip(island.bodies).zip(&self.base) {
            (0..F).for_each(|f| step[f] = base[f] - w[body][f]);
        }
        let mut changed = false;
        for (k, contact) in island.contacts.iter().enumerate() {
            let (a, rates, firm) = (&self.centre[k], self.rates[k], self.firm);
            let answer = |rates: [f64; D]| Answer::of(contact, a, rates, firm);
            let (x, stiffness) = match judged {
                Judged::Now => {
                    let answer = answer(rates);
                    (answer.x, answer.stiffness(contact, firm))
                }
                Judged::Before => (answer(rates).x, answer([0.0; D]).stiffness(contact, firm)),
                Judged::Gripping => {
                    let grip = self.grips[k];
                    (grip.answer(contact, a, rates, firm), grip.stiffness(contact, firm))
                }
            };
            let [a, b] = contact.bodies;
            let number = |body: usize| if body < still { Some(self.number[body]) } else { None };
            let numbers = [number(a), number(b)];
            for (side, &number) in numbers.iter().enumerate() {
                let Some(number) = number else { continue };
                let rows = contact.rows(side);
                for (f, step) in self.step[number].iter_mut().enumerate() {
                    *step += (0..D).map(|k| x[k] * rows[k][f]).sum::<f64>();
                }
            }
            let before = std::mem::replace(&mut self.stiff[k], stiffness);
            if stiffness == before {
                continue;
            }
            changed = true;
            let more = array(|k| array(|l| stiffness[k][l] - before[k][l]));
            for (side, &number) in numbers.iter().enumerate() {
                let Some(number) = number else { continue };
                let rows = contact.rows(side);
                add(self.matrix.of(number), rows, &stiff(rows, &more));
            }
            if let [Some(a), Some(b)] = numbers {
                let (block, of_first) = self.matrix.between(a, b);
                let [row, column] = if of_first { [0, 1] } else { [1, 0] };
                add(block, contact.rows(row), &stiff(contact.rows(column), &more));
            }
        }
        changed
    }

    /// How much Newton's step changes the rates.
    fn turn_by_step(&mut self, island: Island<F, D>) {
        let (number, step) = (&self.number, &self.step);
        let of = |body: usize| number.get(body).map_or([0.0; F], |&number| step[number]);
        self.turn.clear();
        self.turn.extend(island.contacts.iter().map(|contact| {
            let [a, b] = contact.bodies;
            contact.pull(&of(a), &of(b))
        }));
    }

    /// The part of Newton's step to go: all of it, or to where the function is flat along it.
    fn search(&mut self, island: Island<F, D>, w: &[[f64; F]], promised: f64) -> f64 {
        self.turn_by_step(island);
        let step = &self.step;
        let all = island.bodies.iter().zip(&self.base).zip(step);
        let (along, own) = all.fold((0.0, 0.0), |(along, own), ((&body, base), step)| {
            (along + dot(&w[body], step) - dot(base, step), own + dot(step, step))
        });
        let slope = |part: f64| {
            let mut sum = along + part * own;
            for (k, contact) in island.contacts.iter().enumerate() {
                let (u, turn) = (&self.rates[k], &self.turn[k]);
                let u = array(|k| u[k] + part * turn[k]);
                let x = Answer::of(contact, &self.centre[k], u, self.firm).x;
                sum -= (0..D).map(|k| x[k] * turn[k]).sum::<f64>();
            }
            sum
        };
        flat(slope, promised)
    }

    /// Goes towards the answers to the velocities that were found, as far as the energy falls.
    fn go(&mut self, island: Island<F, D>, x: &mut [[f64; D]], w: &mut [[f64; F]]) {
        give(island, &self.from, w);
        let mut slope = 0.0;
        self.turn.clear();
        for (k, contact) in island.contacts.iter().enumerate() {
            let to = Answer::of(contact, &self.centre[k], self.rates[k], self.firm).x;
            let u = contact.rates(w);
            let from = &self.centre[k];
            let change: [f64; D] = array(|k| to[k] - from[k]);
            slope += (0..D).map(|k| u[k] * change[k]).sum::<f64>();
            self.turn.push(change);
        }
        for (contact, change) in island.contacts.iter().zip(&self.turn) {
            contact.push(change, w);
        }
        let changed = |(&body, from): (&usize, &[f64; F])| {
            let change: [f64; F] = array(|f| w[body][f] - from[f]);
            dot(&change, &change)
        };
        let curve: f64 = island.bodies.iter().zip(&self.from).map(changed).sum();
        let part = if slope < 0.0 && curve > 0.0 { (-slope / curve).min(1.0) } else { 0.0 };
        give(island, &self.from, w);
        for (k, (contact, x)) in island.contacts.iter().zip(x).enumerate() {
            let a = self.centre[k];
            let to: [f64; D] = array(|c| a[c] + part * self.turn[k][c]);
            *x = disc(to, contact.friction * to[0]);
            contact.push(&array(|c| x[c] - a[c]), w);
        }
    }
}

/// Gives the bodies of an island these velocities.
fn give<const F: usize, const D: usize>(
    island: Island<F, D>,
    velocities: &[[f64; F]],
    w: &mut [[f64; F]],
) {
    island.bodies.iter().zip(velocities).for_each(|(&body, velocity)| w[body] = *velocity);
}

/// Where a slope that grows from `-promised` is flat between 0 and 1; 1 where it is not positive
/// there.
fn flat(slope: impl Fn(f64) -> f64, promised: f64) -> f64 {
    let (mut low, mut at_low) = (0.0, -promised);
    let (mut high, mut at_high) = (1.0, slope(1.0));
    let mut part = 1.0;
    if at_high <= LINE_SEARCH_SLOPE * promised {
        return part;
    }
    for _ in 0..TRIES {
        // By the secant, but not too close to either end; at the lower where the secant is no number.
        let secant = low - at_low * (high - low) / (at_high - at_low);
        let tenth = 0.1 * (high - low);
        part = secant.max(low + tenth).min(high - tenth);
        let here = slope(part);
        if here.abs() <= LINE_SEARCH_SLOPE * promised {
            break;
        }
        match here < 0.0 {
            true => (low, at_low) = (part, here),
            false => (high, at_high) = (part, here),
        }
    }
    part
}

/// The rows of a body times a stiffness.
#[inline]
fn stiff<const F: usize, const D: usize>(
    rows: &[[f64; F]; D],
    stiffness: &[[f64; D]; D],
) -> [[f64; F]; D] {
    let of = |k: usize, f: usize| -> f64 {
        if k == 0 {
            return stiffness[0][0] * rows[0][f];
        }
        (1..D).map(|l| stiffness[k][l] * rows[l][f]).sum()
    };
    array(|k| array(|f| of(k, f)))
}

/// `block += row^T column`
#[inline]
fn add<const F: usize, const D: usize>(
    block: &mut Block<F>,
    row: &[[f64; F]; D],
    column: &[[f64; F]; D],
) {
    for (c, to) in block.iter_mut().enumerate() {
        for (r, to) in to.iter_mut().enumerate() {
            *to += (0..D).map(|k| row[k][r] * column[k][c]).sum::<f64>();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_that_is_no_number_leaves_a_part_between_zero_and_one() {
        assert!((0.0..=1.0).contains(&flat(|_| f64::NAN, 1.0)));
        assert!((0.0..=1.0).contains(&flat(|part| part - 0.25, 0.25)));
    }
}
