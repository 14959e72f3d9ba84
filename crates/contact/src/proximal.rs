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
//! Source: Rockafellar 1976 (proximal points); Hintermueller, Ito and Kunisch 2003 (Newton's method
//! for who pushes); Todorov 2014, Castro and others 2022 (the same for contact).

use crate::block_cholesky::{Block, BlockCholesky};
use crate::friction::disc;
use crate::rigid_contact::{RigidContact, Six};
use crate::sweeps::Island;

/// The most steps of Newton's method.
const NEWTONS: usize = 8;
/// Slopes along a step of Newton's method that are tried.
const TRIES: usize = 12;
/// The part of the slope at the start that may be left at the end.
const FLAT: f64 = 0.05;
/// A decrease, relative to the kinetic energy and to the energy of what is left, that ends Newton's
/// method.
const SMALL: f64 = 1e-28;
const DONE: f64 = 0.03;
/// Friction this close to its reach slides.
const SLIDES: f64 = 1.0 - 1e-9;

/// The memory of a step.
#[derive(Debug, Default)]
pub(crate) struct Proximal {
    /// The number of each body of the island, in order.
    number: Vec<usize>,
    joints: Vec<[usize; 2]>,
    matrix: BlockCholesky,
    /// Where the step starts, impulses and velocities, and these without the impulses.
    centre: Vec<[f64; 3]>,
    from: Vec<Six>,
    base: Vec<Six>,
    /// The rates, and how much Newton's step changes them.
    rates: Vec<[f64; 3]>,
    turn: Vec<[f64; 3]>,
    /// How stiffly each contact answers in the matrix.
    stiff: Vec<Stiffness>,
    /// Newton's step, by the numbers of the bodies.
    step: Vec<Six>,
    /// One over the compliance that is added to a row, relative to the row's own.
    firm: f64,
}

/// What a contact answers to rates.
#[derive(Clone, Copy)]
struct Answer {
    x: [f64; 3],
    /// The impulse wanted across, its length, and the reach that cuts it.
    wanted: [f64; 2],
    length: f64,
    reach: f64,
}

impl Answer {
    #[inline]
    fn of(contact: &RigidContact, a: &[f64; 3], [n, s, t]: [f64; 3], firm: f64) -> Self {
        let mass = &contact.compliance;
        let across = firm * mass.across_mass;
        let reach = contact.friction * a[0];
        let wanted = [a[1] - s * across, a[2] - t * across];
        let length = (wanted[0] * wanted[0] + wanted[1] * wanted[1]).sqrt();
        let scale = if length > reach { reach / length } else { 1.0 };
        let push = (a[0] - n * firm * mass.normal_mass).max(0.0);
        Answer { x: [push, wanted[0] * scale, wanted[1] * scale], wanted, length, reach }
    }

    /// How stiffly it answers.
    #[inline]
    fn stiffness(&self, contact: &RigidContact, firm: f64) -> Stiffness {
        let normal = if self.x[0] > 0.0 { firm * contact.compliance.normal_mass } else { 0.0 };
        let across = firm * contact.compliance.across_mass;
        if self.reach <= 0.0 {
            return [normal, 0.0, 0.0, 0.0];
        }
        if self.length < SLIDES * self.reach {
            return [normal, across, across, 0.0];
        }
        // What slides answers across its sliding alone.
        let [p, q] = [self.wanted[0] / self.length, self.wanted[1] / self.length];
        let across = across * self.reach / self.length;
        [normal, across * q * q, across * p * p, -across * p * q]
    }
}

/// How stiffly a contact answers: along its normal, along its tangents, and from one to the other.
type Stiffness = [f64; 4];

impl Proximal {
    /// Changes the impulses of an island, and the velocities with them, given the compliance that
    /// is added relative to each row's own and the energy of what is left; says how many systems it
    /// solved.
    pub(crate) fn step(
        &mut self,
        island: Island,
        [soft, left]: [f64; 2],
        x: &mut [[f64; 3]],
        w: &mut [Six],
    ) -> usize {
        self.firm = soft.recip();
        self.start(island, x, w);
        let mut solved = 0;
        for newton in 0..NEWTONS {
            let changed = self.assemble(island, w, newton == 0);
            if (newton == 0 || changed) && !self.matrix.factor() {
                break;
            }
            let promised = self.matrix.solve(&mut self.step);
            solved += 1;
            let part = self.search(island, w, promised);
            for (&body, step) in island.bodies.iter().zip(&self.step) {
                (0..6).for_each(|f| w[body][f] += part * step[f]);
            }
            for (rates, turn) in self.rates.iter_mut().zip(&self.turn) {
                (0..3).for_each(|k| rates[k] += part * turn[k]);
            }
            let kinetic: f64 = island.bodies.iter().map(|&body| product(&w[body], &w[body])).sum();
            if promised <= SMALL * kinetic + DONE * left {
                break;
            }
        }
        self.go(island, x, w);
        solved
    }

    /// Numbers the bodies of an island, says which are joined, and remembers where it starts.
    fn start(&mut self, island: Island, x: &[[f64; 3]], w: &mut [Six]) {
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
            contact.push(&x.map(|x| -x), w);
        }
        self.base.extend(island.bodies.iter().map(|&body| w[body]));
        give(island, &self.from, w);
        self.centre.clear();
        self.centre.extend(x.iter().copied());
        self.rates.clear();
        self.rates.extend(island.contacts.iter().map(|contact| contact.rates(w)));
        self.matrix.reset(island.bodies.len(), &self.joints);
        self.stiff.clear();
        self.stiff.resize(self.rates.len(), [0.0; 4]);
    }

    /// Brings Newton's matrix up to date, and writes the right side in the place of the step; says
    /// whether the matrix has changed. At first, whoever pushes and sticks is taken to go on.
    fn assemble(&mut self, island: Island, w: &[Six], first: bool) -> bool {
        let still = w.len() - 1;
        self.step.clear();
        self.step.resize(island.bodies.len(), [0.0; 6]);
        for ((step, &body), base) in self.step.iter_mut().zip(island.bodies).zip(&self.base) {
            (0..6).for_each(|f| step[f] = base[f] - w[body][f]);
        }
        let mut changed = false;
        for (k, contact) in island.contacts.iter().enumerate() {
            let answer = Answer::of(contact, &self.centre[k], self.rates[k], self.firm);
            let judged = match first {
                true => Answer::of(contact, &self.centre[k], [0.0; 3], self.firm),
                false => answer,
            };
            let x = answer.x;
            let [a, b] = contact.bodies;
            let number = |body: usize| if body < still { Some(self.number[body]) } else { None };
            let numbers = [number(a), number(b)];
            for (side, &number) in numbers.iter().enumerate() {
                let Some(number) = number else { continue };
                let [n, s, t] = contact.rows(side);
                for (f, step) in self.step[number].iter_mut().enumerate() {
                    *step += x[0] * n[f] + x[1] * s[f] + x[2] * t[f];
                }
            }
            let stiffness = judged.stiffness(contact, self.firm);
            let before = std::mem::replace(&mut self.stiff[k], stiffness);
            if stiffness == before {
                continue;
            }
            changed = true;
            let more: Stiffness = std::array::from_fn(|c| stiffness[c] - before[c]);
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

    /// The part of Newton's step to go: all of it, or to where the function is flat along it.
    fn search(&mut self, island: Island, w: &[Six], promised: f64) -> f64 {
        let still = w.len() - 1;
        let (number, step) = (&self.number, &self.step);
        let of = |body: usize| if body < still { step[number[body]] } else { [0.0; 6] };
        self.turn.clear();
        self.turn.extend(island.contacts.iter().map(|contact| {
            let [a, b] = contact.bodies;
            contact.pull(&of(a), &of(b))
        }));
        let all = island.bodies.iter().zip(&self.base).zip(step);
        let (along, own) = all.fold((0.0, 0.0), |(along, own), ((&body, base), step)| {
            (along + product(&w[body], step) - product(base, step), own + product(step, step))
        });
        let slope = |part: f64| {
            let mut sum = along + part * own;
            for (k, contact) in island.contacts.iter().enumerate() {
                let (u, turn) = (&self.rates[k], &self.turn[k]);
                let u = [u[0] + part * turn[0], u[1] + part * turn[1], u[2] + part * turn[2]];
                let x = Answer::of(contact, &self.centre[k], u, self.firm).x;
                sum -= x[0] * turn[0] + x[1] * turn[1] + x[2] * turn[2];
            }
            sum
        };
        flat(slope, promised)
    }

    /// Goes towards the answers to the velocities that were found, as far as the energy falls.
    fn go(&mut self, island: Island, x: &mut [[f64; 3]], w: &mut [Six]) {
        give(island, &self.from, w);
        let mut slope = 0.0;
        self.turn.clear();
        for (k, contact) in island.contacts.iter().enumerate() {
            let to = Answer::of(contact, &self.centre[k], self.rates[k], self.firm).x;
            let u = contact.rates(w);
            let from = &self.centre[k];
            let change = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
            slope += u[0] * change[0] + u[1] * change[1] + u[2] * change[2];
            self.turn.push(change);
        }
        for (contact, change) in island.contacts.iter().zip(&self.turn) {
            contact.push(change, w);
        }
        let changed = |(&body, from): (&usize, &Six)| {
            let change: Six = std::array::from_fn(|f| w[body][f] - from[f]);
            product(&change, &change)
        };
        let curve: f64 = island.bodies.iter().zip(&self.from).map(changed).sum();
        let part = if slope < 0.0 && curve > 0.0 { (-slope / curve).min(1.0) } else { 0.0 };
        give(island, &self.from, w);
        for (k, (contact, x)) in island.contacts.iter().zip(x).enumerate() {
            let a = self.centre[k];
            let [n, s, t] = self.turn[k];
            let [n, s, t] = [a[0] + part * n, a[1] + part * s, a[2] + part * t];
            let [s, t] = disc([s, t], contact.friction * n);
            *x = [n, s, t];
            contact.push(&[n - a[0], s - a[1], t - a[2]], w);
        }
    }
}

/// Gives the bodies of an island these velocities.
fn give(island: Island, velocities: &[Six], w: &mut [Six]) {
    island.bodies.iter().zip(velocities).for_each(|(&body, velocity)| w[body] = *velocity);
}

/// Where a slope that grows from `-promised` is flat between 0 and 1; 1 where it is not positive
/// there.
fn flat(slope: impl Fn(f64) -> f64, promised: f64) -> f64 {
    let (mut low, mut at_low) = (0.0, -promised);
    let (mut high, mut at_high) = (1.0, slope(1.0));
    let mut part = 1.0;
    if at_high <= FLAT * promised {
        return part;
    }
    for _ in 0..TRIES {
        // By the secant, but not too close to either end; at the lower where the secant is no number.
        let secant = low - at_low * (high - low) / (at_high - at_low);
        let tenth = 0.1 * (high - low);
        part = secant.max(low + tenth).min(high - tenth);
        let here = slope(part);
        if here.abs() <= FLAT * promised {
            break;
        }
        match here < 0.0 {
            true => (low, at_low) = (part, here),
            false => (high, at_high) = (part, here),
        }
    }
    part
}

#[inline]
fn product(a: &Six, b: &Six) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The rows of a body times a stiffness.
#[inline]
fn stiff([n, s, t]: &[Six; 3], [normal, first, second, both]: &Stiffness) -> [Six; 3] {
    [
        std::array::from_fn(|f| normal * n[f]),
        std::array::from_fn(|f| first * s[f] + both * t[f]),
        std::array::from_fn(|f| both * s[f] + second * t[f]),
    ]
}

/// `block += row^T column`
#[inline]
fn add(block: &mut Block, row: &[Six; 3], column: &[Six; 3]) {
    for (c, to) in block.iter_mut().enumerate() {
        let by = [column[0][c], column[1][c], column[2][c]];
        for (r, to) in to.iter_mut().enumerate() {
            *to += row[0][r] * by[0] + row[1][r] * by[1] + row[2][r] * by[2];
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
