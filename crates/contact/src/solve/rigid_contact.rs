//! A contact of two rigid bodies, packed for many visits: how each rubs and pushes the other.
//!
//! ```text
//! w = M^1/2 (v - v_f),   J~ = J M^-1/2          scaled velocities, and rows in their terms
//! u = J~ w + o,          o = J v_f + (bias, 0, ..)           rates along normal and tangents, m/s
//! w += J~^T x,           x = (lambda, beta)                  impulses, N s
//! W = J~ J~^T                                                the contact's compliance, 1/kg
//! ```
//! `J` (D x F a body: F freedoms, 3 or 6, D directions, 2 or 3) the rates at which the second point
//! leaves the first along the normal and the tangents, `v_f` the velocity before any impulse, `M`
//! the masses. In scaled velocities a row is its own lift, so that a visit reads each number once.
//! What no impulse moves has no rows; its velocity is in `o`. Source: notes 11.4.1, 11.4.2.

use crate::solve::body_state::BodyState;
use crate::{ContactIn, Dimension};
use stationary_calculus::array;
use wide::f64x2;

/// A contact, packed: F freedoms of a body, D directions, the normal first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RigidContact<const F: usize, const D: usize> {
    /// Whose velocities it reads and changes; the number of bodies for what does not move.
    pub(crate) bodies: [usize; 2],
    /// Its coefficient of friction.
    pub(crate) friction: f64,
    /// The rates before any impulse, and how much of the gap is left over the step.
    pub(crate) offset: [f64; D],
    /// What unit impulses change of the rates.
    pub(crate) compliance: Compliance<D>,
    rows: [[[f64; F]; D]; 2],
}

/// The directions of a contact, the normal first: in world axes, and as each body sees them.
#[derive(Clone, Copy)]
pub(crate) struct Directions<V, const D: usize> {
    world: [V; D],
    seen: [[V; D]; 2],
}

impl<V: Copy + Default, const D: usize> Directions<V, D> {
    /// Those of a contact between bodies in these states.
    #[inline]
    pub(crate) fn of<G>(world: [V; D], point: &ContactIn<G>, states: &[BodyState<G>]) -> Self
    where
        G: Dimension<Vector = V>,
    {
        let seen = point.bodies.map(|body| match body {
            Some(body) => world.map(|direction| G::rotate_back(&states[body].frame, &direction)),
            None => [V::default(); D],
        });
        Directions { world, seen }
    }
}

/// The symmetric matrix `W` of a contact, and what is divided by it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Compliance<const D: usize> {
    /// Of the normal with itself, and with each tangent in its place.
    pub(crate) normal: [f64; D],
    /// The largest eigenvalue of `W_tt`.
    pub(crate) across: f64,
    /// One over the compliance along the normal.
    pub(crate) normal_mass: f64,
    /// The inverse of `W_tt`: its diagonal in the places of the tangents, what is beside it in that of the normal;
    /// zeros where one direction does not give way.
    pub(crate) tangent_mass: [f64; D],
    /// One over `across`.
    pub(crate) across_mass: f64,
}

/// An inverse is taken where the smaller eigenvalue is more than rounding of the larger.
const SINGULAR: f64 = 1e-12;

impl<const D: usize> Compliance<D> {
    const NONE: Self = Compliance {
        normal: [0.0; D],
        across: 0.0,
        normal_mass: 0.0,
        tangent_mass: [0.0; D],
        across_mass: 0.0,
    };

    #[inline]
    fn of<const F: usize>(rows: &[[[f64; F]; D]; 2]) -> Self {
        let [a, b] = rows;
        let product = |k: usize, l: usize| dot_two([&a[k], &b[k]], [&a[l], &b[l]]);
        let normal: [f64; D] = array(|k| product(0, k));
        let mut tangent_mass = [0.0; D];
        let xx = product(1, 1);
        let mut across = xx;
        if D > 2 {
            let (yy, xy) = (product(D - 1, D - 1), product(1, D - 1));
            let half = 0.5 * (xx - yy);
            across = 0.5 * (xx + yy) + (half * half + xy * xy).sqrt();
            let determinant = xx * yy - xy * xy;
            if determinant > SINGULAR * across * across {
                tangent_mass[1] = yy / determinant;
                tangent_mass[D - 1] = xx / determinant;
                tangent_mass[0] = -xy / determinant;
            }
        } else if xx > 0.0 {
            tangent_mass[1] = xx.recip();
        }
        let (normal_mass, across_mass) = (normal[0].recip(), across.recip());
        Compliance { normal, across, normal_mass, tangent_mass, across_mass }
    }
}

impl<const F: usize, const D: usize> RigidContact<F, D> {
    /// Between two that nothing moves.
    pub(crate) const NONE: Self = RigidContact {
        bodies: [0; 2],
        friction: 0.0,
        offset: [0.0; D],
        compliance: Compliance::NONE,
        rows: [[[0.0; F]; D]; 2],
    };

    /// Becomes the contact at a point with these directions, between bodies in these states.
    #[inline]
    pub(crate) fn set<G>(
        &mut self,
        point: &ContactIn<G>,
        directions: &Directions<G::Vector, D>,
        bias: f64,
        states: &[BodyState<G>],
    ) where
        G: Dimension<Velocity = [f64; F]>,
    {
        self.bodies = [states.len(); 2];
        self.friction = point.friction;
        self.offset = [0.0; D];
        self.offset[0] = bias;
        for (side, sign) in [(0, -1.0), (1, 1.0)] {
            let Some(body) = point.bodies[side] else {
                self.rows[side] = [[0.0; F]; D];
                continue;
            };
            let state = &states[body];
            let arm = point.arms[side] * sign;
            for k in 0..D {
                let along = directions.world[k] * sign;
                let row = G::seen_row(&arm, &along, &directions.seen[side][k]);
                self.offset[k] += dot(&row, &state.velocity);
                self.rows[side][k] = array(|f| row[f] * state.scale[f]);
            }
            if state.moves() {
                self.bodies[side] = body;
            }
        }
        self.compliance = Compliance::of(&self.rows);
    }

    /// Whether any impulse along its normal moves a body.
    #[inline]
    pub(crate) fn moves(&self) -> bool {
        self.compliance.normal_mass.is_finite()
    }

    /// The rates along the normal and the tangents, m/s.
    #[inline]
    pub(crate) fn rates(&self, w: &[[f64; F]]) -> [f64; D] {
        let (a, b) = (&w[self.bodies[0]], &w[self.bodies[1]]);
        array(|k| self.rate(k, a, b))
    }

    #[inline]
    fn rate(&self, k: usize, a: &[f64; F], b: &[f64; F]) -> f64 {
        self.offset[k] + dot_two([&self.rows[0][k], &self.rows[1][k]], [a, b])
    }

    /// The rows of one of its bodies.
    #[inline]
    pub(crate) fn rows(&self, side: usize) -> &[[f64; F]; D] {
        &self.rows[side]
    }

    /// How much a unit impulse of another contact along its direction `l` changes the rate of this
    /// one along `k`, 1/kg.
    pub(crate) fn joint_compliance(&self, k: usize, other: &Self, l: usize) -> f64 {
        let mut sum = 0.0;
        for (mine, &body) in self.rows.iter().zip(&self.bodies) {
            for (theirs, &of) in other.rows.iter().zip(&other.bodies) {
                // What does not move has rows of zeros.
                if body == of {
                    sum += dot(&mine[k], &theirs[l]);
                }
            }
        }
        sum
    }

    /// How much the rates change with these changes of the bodies' velocities.
    #[inline]
    pub(crate) fn pull(&self, a: &[f64; F], b: &[f64; F]) -> [f64; D] {
        array(|k| dot_two([&self.rows[0][k], &self.rows[1][k]], [a, b]))
    }

    /// Gives the bodies impulses.
    #[inline]
    pub(crate) fn push(&self, impulse: &[f64; D], w: &mut [[f64; F]]) {
        for (rows, &body) in self.rows.iter().zip(&self.bodies) {
            add(rows, impulse, &mut w[body]);
        }
    }

    /// Lets its impulses `x` be changed by what `respond` makes of the rates; says by how much.
    #[inline]
    pub(crate) fn visit(
        &self,
        w: &mut [[f64; F]],
        x: &[f64; D],
        respond: impl FnOnce([f64; D]) -> [f64; D],
    ) -> [f64; D] {
        let [a, b] = self.bodies;
        let (mut first, mut second) = (w[a], w[b]);
        let mut rates = [0.0; D];
        rates[0] = self.rate(0, &first, &second);
        // What neither pushes nor closes needs no other rate: a good third of all visits. No bit is set in zeros.
        if x.iter().fold(0, |bits, x| bits | x.to_bits()) == 0 && rates[0] >= 0.0 {
            return [0.0; D];
        }
        (1..D).for_each(|k| rates[k] = self.rate(k, &first, &second));
        let change = respond(rates);
        add(&self.rows[0], &change, &mut first);
        add(&self.rows[1], &change, &mut second);
        (w[a], w[b]) = (first, second);
        change
    }
}

/// The sum of products, in two chains that do not wait for each other.
#[inline]
pub(crate) fn dot<const F: usize>(a: &[f64; F], b: &[f64; F]) -> f64 {
    let (mut even, mut odd) = (a[0] * b[0], a[1] * b[1]);
    (2..F).step_by(2).for_each(|f| even += a[f] * b[f]);
    (3..F).step_by(2).for_each(|f| odd += a[f] * b[f]);
    even + odd
}

/// Two neighbours in a list.
#[inline]
fn pair<const F: usize>(of: &[f64; F], f: usize) -> f64x2 {
    f64x2::new([of[f], of[f + 1]])
}

/// The sum of two sums of products, in two chains.
#[inline]
fn dot_two<const F: usize>(a: [&[f64; F]; 2], b: [&[f64; F]; 2]) -> f64 {
    let (mut first, mut second) = (pair(a[0], 0) * pair(b[0], 0), pair(a[1], 0) * pair(b[1], 0));
    for f in (2..F - 1).step_by(2) {
        first += pair(a[0], f) * pair(b[0], f);
        second += pair(a[1], f) * pair(b[1], f);
    }
    let sum = (first + second).to_array();
    let mut sum = sum[0] + sum[1];
    if F % 2 == 1 {
        sum += a[0][F - 1] * b[0][F - 1] + a[1][F - 1] * b[1][F - 1];
    }
    sum
}

#[inline]
fn add<const F: usize, const D: usize>(rows: &[[f64; F]; D], impulse: &[f64; D], w: &mut [f64; F]) {
    for f in (0..F - 1).step_by(2) {
        let mut sum = pair(&rows[0], f) * impulse[0];
        (1..D).for_each(|k| sum += pair(&rows[k], f) * impulse[k]);
        [w[f], w[f + 1]] = (pair(w, f) + sum).to_array();
    }
    if F % 2 == 1 {
        let f = F - 1;
        let mut sum = rows[0][f] * impulse[0];
        (1..D).for_each(|k| sum += rows[k][f] * impulse[k]);
        w[f] += sum;
    }
}
