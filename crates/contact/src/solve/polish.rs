//! A small island with friction, to rounding: semismooth Newton on what pushes, sticks and slides.
//!
//! ```text
//! x_n <= r_n u_n          open       x_n = 0
//! x_n >  r_n u_n          pushes     u_n = 0
//! |z| <= mu x_n           sticks     u_t = 0                            z = x_t - r_t u_t
//! |z| >  mu x_n           slides     x_t = mu x_n z/|z|
//! u = W x + o,   W + e diag(W)       in the matrix, and not in what is left
//! ```
//! `x` impulses (N s), `u` rates (m/s), `W` the compliance of the island (1/kg), `r` one over a
//! contact's own. Each of Newton's steps solves the equations of the sets that it finds, linearized,
//! by a dense factor of unknowns that are scaled to a unit diagonal. Redundant contacts make `W`
//! singular: the small compliance `e` keeps their impulses where they are, and as what is left is
//! measured without it, it has no say in what comes out. Coulomb's law has no energy that all of
//! this would lower, so that nothing is taken on trust: only impulses that leave less than those
//! before are kept, and where none do all is as it was. Source: Alart and Curnier 1991.

use crate::solve::friction::{disc, square_across};
use crate::solve::rigid_contact::RigidContact;
use crate::solve::sweeps::{Island, Sweeps};

/// Islands of more contacts are left as they are: the work grows with the cube.
pub(crate) const CONTACTS: usize = 20;
/// The most steps of Newton's method. Sets that change still after these go in circles.
const NEWTONS: usize = 12;
/// The compliance that is added to each row, relative to its own: far above the rounding of a
/// factor, so that redundant contacts have one, and so small that few steps take off what it leaves.
const COMPLIANCE: f64 = 1e-10;
/// What is left relative to the fastest rate before any impulse that is rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Pivots below this are none.
const PIVOT: f64 = 1e-30;

/// The memory of a polish.
#[derive(Debug, Default)]
pub(crate) struct Polish<const F: usize, const D: usize> {
    /// The compliance between each two rows, the equations by rows, and their right side.
    compliance: Vec<f64>,
    matrix: Vec<f64>,
    right: Vec<f64>,
    /// The least that was left so far, by which impulses, and the velocities without impulses.
    best: Vec<[f64; D]>,
    base: Vec<[f64; F]>,
    /// The impulses that are tried.
    tried: Vec<[f64; D]>,
}

impl<const F: usize, const D: usize> Polish<F, D> {
    /// Changes the impulses of an island until no more than rounding is left, if it can; says how
    /// many systems it solved.
    pub(crate) fn polish(
        &mut self,
        sweeps: &mut Sweeps<F, D>,
        island: Island<F, D>,
        x: &mut [[f64; D]],
    ) -> usize {
        let worst = |left: [f64; 2]| left[0].max(left[1]);
        let offsets = island.contacts.iter().flat_map(|contact| contact.offset);
        let settled = ROUNDING * offsets.fold(0.0_f64, |most, rate| most.max(rate.abs()));
        let mut least = worst(sweeps.residuals(island, x));
        if island.contacts.len() > CONTACTS || least <= settled || least.is_nan() {
            return 0;
        }
        self.start(sweeps, island, x);
        let mut solved = 0;
        while solved < NEWTONS && least > settled {
            self.assemble(sweeps, island);
            solved += 1;
            if !self.solve() {
                break;
            }
            for (k, (contact, tried)) in island.contacts.iter().zip(&mut self.tried).enumerate() {
                (0..D).for_each(|d| tried[d] += scale(contact, d) * self.right[D * k + d]);
                tried[0] = tried[0].max(0.0);
                *tried = disc(*tried, contact.friction * tried[0]);
            }
            if self.tried.iter().flatten().any(|x| !x.is_finite()) {
                break;
            }
            self.give(sweeps, island, &self.tried);
            let left = worst(sweeps.residuals(island, &self.tried));
            if left < least {
                least = left;
                self.best.copy_from_slice(&self.tried);
            }
        }
        x.copy_from_slice(&self.best);
        self.give(sweeps, island, &self.best);
        solved
    }

    /// Remembers where it starts, and multiplies the rows of all contacts.
    fn start(&mut self, sweeps: &mut Sweeps<F, D>, island: Island<F, D>, x: &[[f64; D]]) {
        for list in [&mut self.best, &mut self.tried] {
            list.clear();
            list.extend_from_slice(x);
        }
        let back = |(contact, x): (&RigidContact<F, D>, &[f64; D])| {
            contact.push(&x.map(|x| -x), &mut sweeps.w);
        };
        island.contacts.iter().zip(x).for_each(back);
        self.base.clear();
        self.base.extend(island.bodies.iter().map(|&body| sweeps.w[body]));
        self.give(sweeps, island, x);
        let n = D * island.contacts.len();
        self.compliance.clear();
        self.compliance.resize(n * n, 0.0);
        for (i, a) in island.contacts.iter().enumerate() {
            for (j, b) in island.contacts.iter().enumerate() {
                for (k, l) in (0..D).flat_map(|k| (0..D).map(move |l| (k, l))) {
                    let product = a.joint_compliance(k, b, l) * scale(a, k) * scale(b, l);
                    self.compliance[(D * i + k) * n + D * j + l] = product;
                }
            }
        }
    }

    /// Gives the bodies the velocities by these impulses.
    fn give(&self, sweeps: &mut Sweeps<F, D>, island: Island<F, D>, x: &[[f64; D]]) {
        for (&body, base) in island.bodies.iter().zip(&self.base) {
            sweeps.w[body] = *base;
        }
        sweeps.push(island, x);
    }

    /// The equations of the sets at the impulses that are tried, in scaled impulses and rates.
    fn assemble(&mut self, sweeps: &Sweeps<F, D>, island: Island<F, D>) {
        let Polish { compliance, matrix, right, tried, .. } = self;
        let n = D * island.contacts.len();
        matrix.clear();
        matrix.resize(n * n, 0.0);
        right.clear();
        right.resize(n, 0.0);
        for (i, (contact, x)) in island.contacts.iter().zip(tried).enumerate() {
            let rates = contact.rates(&sweeps.w);
            let y: [f64; D] = std::array::from_fn(|d| x[d] / scale(contact, d));
            let u: [f64; D] = std::array::from_fn(|d| rates[d] * scale(contact, d));
            let mut own = |d: usize, other: usize, value: f64| {
                matrix[(D * i + d) * n + D * i + other] += value;
            };
            if y[0] <= u[0] {
                (0..D).for_each(|d| {
                    own(d, d, 1.0);
                    right[D * i + d] = -y[d];
                });
                continue;
            }
            let wanted: [f64; D] = std::array::from_fn(|d| y[d] - u[d]);
            let length = square_across(&wanted).sqrt();
            // Friction in scaled impulses.
            let mu = contact.friction * scale(contact, 0) / scale(contact, 1);
            let radius = mu * y[0];
            let slides = length > radius || contact.friction == 0.0;
            for d in 0..D {
                if d > 0 && slides {
                    continue;
                }
                let row = (D * i + d) * n;
                matrix[row..row + n].copy_from_slice(&compliance[row..row + n]);
                matrix[row + D * i + d] += COMPLIANCE;
                right[D * i + d] = -u[d];
            }
            if !slides {
                continue;
            }
            let along = wanted.map(|z| if length > 0.0 { z / length } else { 0.0 });
            let part = if length > 0.0 { radius / length } else { 0.0 };
            for d in 1..D {
                let row = (D * i + d) * n;
                matrix[row + D * i + d] += 1.0;
                matrix[row + D * i] -= mu * along[d];
                // The direction of sliding turns with the rates.
                for e in 1..D {
                    let turn = part * (f64::from(u8::from(d == e)) - along[d] * along[e]);
                    matrix[row + D * i + e] -= turn;
                    let of = (D * i + e) * n;
                    for column in 0..n {
                        matrix[row + column] += turn * compliance[of + column];
                    }
                }
                right[D * i + d] = radius * along[d] - y[d];
            }
        }
    }

    /// Solves by elimination with pivots of columns, the solution in the place of the right side;
    /// says whether there was one.
    fn solve(&mut self) -> bool {
        let n = self.right.len();
        let (matrix, right) = (&mut self.matrix, &mut self.right);
        for column in 0..n {
            let size = |row: usize| matrix[row * n + column].abs();
            let pivot = (column..n).max_by(|&a, &b| size(a).total_cmp(&size(b))).unwrap_or(column);
            if !(size(pivot) > PIVOT && size(pivot).is_finite()) {
                return false;
            }
            if pivot != column {
                (0..n).for_each(|k| matrix.swap(pivot * n + k, column * n + k));
                right.swap(pivot, column);
            }
            let (above, below) = matrix.split_at_mut((column + 1) * n);
            let from = &above[column * n..];
            for (row, to) in below.chunks_exact_mut(n).enumerate() {
                let part = to[column] / from[column];
                if part != 0.0 {
                    (column..n).for_each(|k| to[k] -= part * from[k]);
                    right[column + 1 + row] -= part * right[column];
                }
            }
        }
        for row in (0..n).rev() {
            let known: f64 = (row + 1..n).map(|k| matrix[row * n + k] * right[k]).sum();
            right[row] = (right[row] - known) / matrix[row * n + row];
        }
        true
    }
}

/// What makes an impulse in this direction one of a unit compliance.
fn scale<const F: usize, const D: usize>(contact: &RigidContact<F, D>, direction: usize) -> f64 {
    let compliance = &contact.compliance;
    let mass = if direction == 0 { compliance.normal_mass } else { compliance.across_mass };
    if mass.is_finite() { mass.sqrt() } else { 1.0 }
}
