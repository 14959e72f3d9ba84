//! All contacts of an island at once: a step of the proximal-point method, by Newton's.
//!
//! ```text
//! min_w 1/2 |w|^2 + sum_i max_(x_i in C_i) (-x_i.u_i(w) - e_i/2 |x_i - a_i|^2)
//! x_i(w) = proj_i (a_i - u_i(w)/e_i),     w = J~^T x(w)            where that is smallest
//! (1 + J~^T D J~) dw = J~^T x(w) - w,     D = -dx/du             Newton's step, with a line search
//! x <- a + t (x(w) - a)                                            0 <= t <= 1, of least energy
//! ```
//! `w` scaled velocities, `u = J~ w + o` rates (m/s), `a` the impulses (N s) that the step starts
//! from, `C_i` those that push, with friction within `mu` times the normal impulse of `a_i`, `e` a
//! small part of each row's compliance. The problem is convex and has one solution, whatever
//! contacts are redundant and however their gaps fail to fit each other; after a few such steps `x`
//! stays where it is, and `e` has no say any more. Newton's matrix joins bodies as contacts do, and
//! is factored sparsely; a heap is nearly a tree. Where Newton's method is cut short, the last line
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
const DONE: f64 = 1e-3;
/// Friction this close to its reach slides.
const SLIDES: f64 = 1.0 - 1e-9;

/// The memory of a step.
#[derive(Debug, Default)]
pub(crate) struct Proximal {
    /// The number of each body of the island, in order.
    number: Vec<usize>,
    joints: Vec<[usize; 2]>,
    matrix: BlockCholesky,
    /// Where the step starts, impulses and velocities.
    centre: Vec<[f64; 3]>,
    from: Vec<Six>,
    /// The rates, those by which contacts are judged, and how much Newton's step changes them.
    rates: Vec<[f64; 3]>,
    judged: Vec<[f64; 3]>,
    turn: Vec<[f64; 3]>,
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
        let [p, q] = disc(wanted, reach);
        let push = (a[0] - n * firm * mass.normal_mass).max(0.0);
        let length = (wanted[0] * wanted[0] + wanted[1] * wanted[1]).sqrt();
        Answer { x: [push, p, q], wanted, length, reach }
    }

    /// How stiffly it answers along the normal and along two directions across, and these; rows
    /// that do not answer have zeros.
    #[inline]
    fn stiffness(&self, contact: &RigidContact, firm: f64) -> ([f64; 3], [[f64; 2]; 2]) {
        let normal = if self.x[0] > 0.0 { firm * contact.compliance.normal_mass } else { 0.0 };
        let across = firm * contact.compliance.across_mass;
        if self.reach <= 0.0 {
            return ([normal, 0.0, 0.0], [[0.0; 2]; 2]);
        }
        if self.length < SLIDES * self.reach {
            return ([normal, across, across], [[1.0, 0.0], [0.0, 1.0]]);
        }
        let [p, q] = self.wanted.map(|wanted| wanted / self.length);
        ([normal, across * self.reach / self.length, 0.0], [[-q, p], [0.0; 2]])
    }
}

impl Proximal {
    /// Changes the impulses of an island, and the velocities with them, given the compliance that
    /// is added relative to each row's own and the energy of what is left; says how many systems it
    /// solved.
    pub(crate) fn step(
        &mut self,
        island: Island,
        contacts: &[RigidContact],
        [soft, left]: [f64; 2],
        x: &mut [[f64; 3]],
        w: &mut [Six],
    ) -> usize {
        self.firm = soft.recip();
        self.start(island, contacts, x, w);
        let mut solved = 0;
        for _ in 0..NEWTONS {
            self.assemble(island, contacts, w);
            if !self.matrix.factor() {
                break;
            }
            let promised = self.matrix.solve(&mut self.step);
            solved += 1;
            let part = self.search(island, contacts, w, promised);
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
            self.judged.clone_from(&self.rates);
        }
        self.go(island, contacts, x, w);
        solved
    }

    /// Numbers the bodies of an island, says which are joined, and remembers where it starts.
    fn start(&mut self, island: Island, contacts: &[RigidContact], x: &[[f64; 3]], w: &[Six]) {
        let still = w.len() - 1;
        self.number.resize(still, 0);
        for (number, &body) in island.bodies.iter().enumerate() {
            self.number[body] = number;
        }
        self.joints.clear();
        let mut last = [still; 2];
        for &i in island.contacts {
            let bodies = contacts[i].bodies;
            if bodies != last && !bodies.contains(&still) {
                self.joints.push(bodies.map(|body| self.number[body]));
            }
            last = bodies;
        }
        self.from.clear();
        self.from.extend(island.bodies.iter().map(|&body| w[body]));
        self.centre.clear();
        self.centre.extend(island.contacts.iter().map(|&i| x[i]));
        self.rates.clear();
        self.rates.extend(island.contacts.iter().map(|&i| contacts[i].rates(w)));
        // At first, whoever pushes and sticks is taken to go on.
        self.judged.clear();
        self.judged.resize(self.rates.len(), [0.0; 3]);
    }

    /// Writes Newton's matrix, and the right side in the place of the step.
    fn assemble(&mut self, island: Island, contacts: &[RigidContact], w: &[Six]) {
        let still = w.len() - 1;
        self.matrix.reset(island.bodies.len(), &self.joints);
        self.step.clear();
        self.step.extend(island.bodies.iter().map(|&body| w[body].map(|w| -w)));
        for (k, &i) in island.contacts.iter().enumerate() {
            let contact = &contacts[i];
            let answer = |rates| Answer::of(contact, &self.centre[k], rates, self.firm);
            let (x, judged) = (answer(self.rates[k]).x, answer(self.judged[k]));
            let numbers = contact.bodies.map(|body| (body < still).then(|| self.number[body]));
            let (stiffness, along) = judged.stiffness(contact, self.firm);
            let rows = [0, 1].map(|side| turned(contact.rows(side), &along));
            for (side, number) in numbers.into_iter().enumerate() {
                let Some(number) = number else { continue };
                add(self.matrix.of(number), &rows[side], &rows[side], &stiffness);
                for (row, x) in contact.rows(side).iter().zip(&x) {
                    (0..6).for_each(|f| self.step[number][f] += x * row[f]);
                }
            }
            if let [Some(a), Some(b)] = numbers {
                let (block, first) = self.matrix.between(a, b);
                let [row, column] = if first { [0, 1] } else { [1, 0] };
                add(block, &rows[row], &rows[column], &stiffness);
            }
        }
    }

    /// The part of Newton's step to go: all of it, or to where the function is flat along it.
    fn search(
        &mut self,
        island: Island,
        contacts: &[RigidContact],
        w: &[Six],
        promised: f64,
    ) -> f64 {
        let still = w.len() - 1;
        let (number, step) = (&self.number, &self.step);
        let of = |body: usize| if body < still { step[number[body]] } else { [0.0; 6] };
        self.turn.clear();
        self.turn.extend(island.contacts.iter().map(|&i| {
            let [a, b] = contacts[i].bodies;
            contacts[i].pull(&of(a), &of(b))
        }));
        let both = island.bodies.iter().zip(step);
        let (along, own) = both.fold((0.0, 0.0), |(along, own), (&body, step)| {
            (along + product(&w[body], step), own + product(step, step))
        });
        let slope = |part: f64| {
            let mut sum = along + part * own;
            for (k, &i) in island.contacts.iter().enumerate() {
                let (u, turn) = (&self.rates[k], &self.turn[k]);
                let u = [0, 1, 2].map(|k| u[k] + part * turn[k]);
                let x = Answer::of(&contacts[i], &self.centre[k], u, self.firm).x;
                sum -= x[0] * turn[0] + x[1] * turn[1] + x[2] * turn[2];
            }
            sum
        };
        flat(slope, promised)
    }

    /// Goes towards the answers to the velocities that were found, as far as the energy falls.
    fn go(&mut self, island: Island, contacts: &[RigidContact], x: &mut [[f64; 3]], w: &mut [Six]) {
        let back = |from: &[Six], w: &mut [Six]| {
            island.bodies.iter().zip(from).for_each(|(&body, from)| w[body] = *from);
        };
        back(&self.from, w);
        let mut slope = 0.0;
        self.turn.clear();
        for (k, &i) in island.contacts.iter().enumerate() {
            let to = Answer::of(&contacts[i], &self.centre[k], self.rates[k], self.firm).x;
            let u = contacts[i].rates(w);
            let change = [0, 1, 2].map(|c| to[c] - self.centre[k][c]);
            slope += u[0] * change[0] + u[1] * change[1] + u[2] * change[2];
            self.turn.push(change);
        }
        for (&i, change) in island.contacts.iter().zip(&self.turn) {
            contacts[i].push(change, w);
        }
        let changed = |(&body, from): (&usize, &Six)| {
            let change: Six = std::array::from_fn(|f| w[body][f] - from[f]);
            product(&change, &change)
        };
        let curve: f64 = island.bodies.iter().zip(&self.from).map(changed).sum();
        let part = if slope < 0.0 && curve > 0.0 { (-slope / curve).min(1.0) } else { 0.0 };
        back(&self.from, w);
        for (k, &i) in island.contacts.iter().enumerate() {
            let a = self.centre[k];
            let [n, s, t] = [0, 1, 2].map(|c| a[c] + part * self.turn[k][c]);
            let [s, t] = disc([s, t], contacts[i].friction * n);
            x[i] = [n, s, t];
            contacts[i].push(&[n - a[0], s - a[1], t - a[2]], w);
        }
    }
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
        // By the secant, but not too close to either end.
        let secant = low - at_low * (high - low) / (at_high - at_low);
        let tenth = 0.1 * (high - low);
        part = secant.clamp(low + tenth, high - tenth);
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

/// The normal row, and the rows across combined along two directions.
#[inline]
fn turned(rows: &[Six; 3], along: &[[f64; 2]; 2]) -> [Six; 3] {
    let across = |[p, q]: [f64; 2]| std::array::from_fn(|f| p * rows[1][f] + q * rows[2][f]);
    [rows[0], across(along[0]), across(along[1])]
}

/// `block += row^T stiffness column`
#[inline]
fn add(block: &mut Block, row: &[Six; 3], column: &[Six; 3], stiffness: &[f64; 3]) {
    for k in (0..3).filter(|&k| stiffness[k] > 0.0) {
        for (to, by) in block.iter_mut().zip(&column[k]) {
            let by = stiffness[k] * by;
            (0..6).for_each(|r| to[r] += row[k][r] * by);
        }
    }
}
