//! Sweeps over the contacts of an island, each relaxed in turn, and the best of what they reach.
//!
//! ```text
//! y_k = sweep(x_k),   f_k = y_k - x_k                            what a sweep changes
//! x_k+1 = sum a_j y_j   with  |sum a_j f_j| smallest,  sum a_j = 1      over the last few sweeps
//! ```
//! `x` the impulses of the island, `|.|` in the norm of their compliance. Where no contact changes
//! between open, sticking and sliding, a sweep is linear, and that is the method of minimal
//! residuals; where the sweep's change grows, it goes back and starts afresh. The last sweep is
//! taken as it is, so that no impulse pulls and no friction exceeds its reach. Source: Anderson
//! 1965; Walker and Ni 2011.

use nalgebra::{SMatrix, SVector};

use crate::rigid_contact::{RigidContact, Six};

/// Sweeps that are combined.
const KEPT: usize = 6;
/// A change whose square is so many times that of the one before leads away.
const GROWTH: f64 = 4.0;
/// Shares as large as this would leave what the sweeps have seen, and are not taken.
const FAR: f64 = 1e4;
/// What is added to the products of changes, relative to the largest: their rounding.
const ROUNDING: f64 = 1e-13;

/// Products of what the sweeps kept changed.
type Products = SMatrix<f64, KEPT, KEPT>;

/// Scaled velocities of all bodies, and the memory of the sweeps.
#[derive(Debug, Default)]
pub(crate) struct Sweeps {
    /// The scaled change of each body's velocity, and zeros for what does not move.
    pub(crate) w: Vec<Six>,
    /// What the sweeps kept reached, and what they changed, as roots of energies.
    reached_w: [Vec<Six>; KEPT],
    reached: [Vec<[f64; 3]>; KEPT],
    changes: [Vec<[f64; 3]>; KEPT],
}

/// One island: its contacts and its bodies, by their numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Island<'a> {
    pub(crate) contacts: &'a [usize],
    pub(crate) bodies: &'a [usize],
}

impl Sweeps {
    /// Starts from impulses on bodies whose velocities are as they were.
    pub(crate) fn start(&mut self, bodies: usize, contacts: &[RigidContact], x: &[[f64; 3]]) {
        self.w.clear();
        self.w.resize(bodies + 1, [0.0; 6]);
        self.reached_w.iter_mut().for_each(|w| w.resize(bodies + 1, [0.0; 6]));
        let impulses = self.reached.iter_mut().chain(&mut self.changes);
        impulses.for_each(|x| x.resize(contacts.len(), [0.0; 3]));
        for (contact, x) in contacts.iter().zip(x) {
            contact.push(x, &mut self.w);
        }
    }

    /// How far the normal conditions and Coulomb's law of an island are from being met, m/s.
    pub(crate) fn residuals(
        &self,
        island: Island,
        contacts: &[RigidContact],
        x: &[[f64; 3]],
    ) -> [f64; 2] {
        let one = |&i: &usize| contacts[i].residuals(&x[i], &self.w);
        let worst = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a.max(c), b.max(d)];
        island.contacts.iter().map(one).fold([0.0; 2], worst)
    }

    /// Sweeps over an island until none of its contacts changes a velocity by more than `settled`,
    /// at most `bound` times; says how many times.
    pub(crate) fn settle(
        &mut self,
        island: Island,
        contacts: &[RigidContact],
        x: &mut [[f64; 3]],
        settled: f64,
        bound: usize,
    ) -> usize {
        let mut products = Products::identity();
        let (mut kept, mut last) = (0, f64::INFINITY);
        for sweep in 1..=bound {
            let place = kept % KEPT;
            let (fastest, square) = self.sweep(island, contacts, x, place);
            if fastest <= settled || sweep == bound {
                return sweep;
            }
            if square > GROWTH * last {
                // What was combined leads away: back to the sweep before it.
                let before = (kept - 1) % KEPT;
                (kept, last) = (0, f64::INFINITY);
                self.return_to(island, before, x);
                continue;
            }
            last = square;
            kept += 1;
            self.multiply(island, place, kept.min(KEPT), &mut products);
            match shares(&products, kept.min(KEPT)) {
                Some(shares) => self.combine(island, &shares, kept.min(KEPT), x),
                None => (kept, last) = (0, f64::INFINITY),
            }
        }
        bound
    }

    /// Relaxes each contact once and keeps what that reached at a place; the largest change as a
    /// velocity, and the square of all.
    fn sweep(
        &mut self,
        island: Island,
        contacts: &[RigidContact],
        x: &mut [[f64; 3]],
        place: usize,
    ) -> (f64, f64) {
        let (mut fastest, mut square) = (0.0_f64, 0.0);
        let (reached, changes) = (&mut self.reached[place], &mut self.changes[place]);
        for &i in island.contacts {
            let contact = &contacts[i];
            let change = contact.relax(&mut x[i], &mut self.w);
            fastest = fastest.max(contact.speed(&change));
            reached[i] = x[i];
            changes[i] = contact.root(&change);
            square += product(&changes[i], &changes[i]);
        }
        for &body in island.bodies {
            self.reached_w[place][body] = self.w[body];
        }
        (fastest, square)
    }

    /// The products of the change at a place with all that are kept.
    fn multiply(&self, island: Island, place: usize, kept: usize, products: &mut Products) {
        let own = &self.changes[place];
        for (k, other) in self.changes[..kept].iter().enumerate() {
            let sum = island.contacts.iter().map(|&i| product(&own[i], &other[i])).sum();
            (products[(place, k)], products[(k, place)]) = (sum, sum);
        }
    }

    /// Goes back to what the sweep at a place reached.
    fn return_to(&mut self, island: Island, place: usize, x: &mut [[f64; 3]]) {
        island.contacts.iter().for_each(|&i| x[i] = self.reached[place][i]);
        island.bodies.iter().for_each(|&body| self.w[body] = self.reached_w[place][body]);
    }

    /// Goes to the combination of what the sweeps kept reached.
    fn combine(&mut self, island: Island, shares: &[f64; KEPT], kept: usize, x: &mut [[f64; 3]]) {
        let (reached, reached_w) = (&self.reached[..kept], &self.reached_w[..kept]);
        for &i in island.contacts {
            x[i] = combination(reached, shares, i);
        }
        for &body in island.bodies {
            self.w[body] = combination(reached_w, shares, body);
        }
    }
}

#[inline]
fn product(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
fn combination<const N: usize>(kept: &[Vec<[f64; N]>], shares: &[f64], at: usize) -> [f64; N] {
    let mut sum = [0.0; N];
    for (values, share) in kept.iter().zip(shares) {
        let value = &values[at];
        (0..N).for_each(|k| sum[k] += share * value[k]);
    }
    sum
}

/// The shares, adding up to one, with which the combined change is smallest; none where that is
/// decided by rounding.
fn shares(products: &Products, kept: usize) -> Option<[f64; KEPT]> {
    let scale = (0..kept).map(|k| products[(k, k)]).fold(0.0, f64::max);
    let mut matrix = Products::identity();
    for k in 0..kept {
        for l in 0..kept {
            matrix[(k, l)] = products[(k, l)] / scale;
        }
        matrix[(k, k)] += ROUNDING;
    }
    let ones = SVector::<f64, KEPT>::from_fn(|k, _| if k < kept { 1.0 } else { 0.0 });
    let solution = matrix.cholesky()?.solve(&ones);
    let shares = solution / solution.sum();
    // A share that is not a number is not smaller either.
    shares.iter().all(|share| share.abs() < FAR).then(|| shares.into())
}
