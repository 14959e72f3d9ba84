//! The moments of rolling and torsional friction of an island together with all of its impulses.
//!
//! ```text
//! rows     n.u, t.u            of a contact,   |x_t| <= mu x_n
//!          l a.w               of its moments, |x_a| <= (r/l) x_n     a = n x t across the normal, t1 x t2 along it
//! ```
//! `u` how fast the second point leaves the first (m/s), `w` the spin of the second body as seen from the first (rad/s),
//! `l` the longer arm of the contact (m), so that moments are impulses at its end, `r` their length (m). The laws and the
//! method are those of [`CoupledRows`]. Source: Leine and Glocker 2003.

use stationary_constraints::RowLaw;

use crate::coupled::coupled_rows::{CoupledRows, Solved};
use crate::coupled::row_laws::Left;
use crate::solve::body_state::BodyState;
use crate::solve::rolling::Moment;
use crate::{ContactIn, Dimension};

/// The most rows of an island: their work grows with the cube.
const ROWS: usize = 300;

/// What moves bodies, and the impulses that they are given.
#[derive(Clone, Copy)]
pub(crate) struct Rolling<'a, G: Dimension> {
    pub(crate) contacts: &'a [ContactIn<G>],
    /// How much of each gap is left over the step, m/s.
    pub(crate) bias: &'a [f64],
    pub(crate) states: &'a [BodyState<G>],
    /// Velocities before any impulse and moment.
    pub(crate) free: &'a [f64],
}

/// One row: how it pulls at both bodies of its contact, in scaled velocities.
#[derive(Clone, Copy, Debug)]
struct Pull<G: Dimension> {
    contact: usize,
    sides: [G::Velocity; 2],
}

/// The rows of an island, and the memory of solving them.
#[derive(Debug)]
pub(crate) struct RollingRows<G: Dimension> {
    rows: CoupledRows,
    pulls: Vec<Pull<G>>,
    rates: Vec<f64>,
    x: Vec<f64>,
    /// The first contacts of the islands of a step that rows did not settle, and the most that was left of them, m/s.
    failed: Vec<usize>,
    left: f64,
    /// How many moments there were in islands that are small enough.
    seen: usize,
    /// Whether what rows leave is taken all the same.
    insists: bool,
}

impl<G: Dimension> Default for RollingRows<G> {
    fn default() -> Self {
        let (rows, pulls) = (CoupledRows::default(), Vec::new());
        let (rates, x, failed) = (Vec::new(), Vec::new(), Vec::new());
        RollingRows { rows, pulls, rates, x, failed, left: 0.0, seen: 0, insists: false }
    }
}

impl<G: Dimension> RollingRows<G> {
    /// Forgets what failed before.
    pub(crate) fn start(&mut self) {
        self.failed.clear();
        (self.left, self.insists) = (f64::INFINITY, false);
    }

    /// The most that was left where rows did not settle an island, m/s; infinite where they had no say.
    pub(crate) fn left(&self) -> f64 {
        self.left
    }

    /// Counts moments from now on.
    pub(crate) fn count(&mut self) {
        self.seen = 0;
    }

    /// Whether moments were left to others, of so many.
    pub(crate) fn misses_some(&self, of: usize) -> bool {
        self.seen < of
    }

    /// Takes from now on what rows leave.
    pub(crate) fn insist(&mut self) {
        self.insists = true;
    }

    /// Changes impulses and moments of an island, whose contacts have these numbers, until no more than `enough` (m/s)
    /// is left of their laws, and writes the velocities of its bodies; says what is left, or nothing where it has no
    /// moments, is too large, or more than `reached` is left.
    pub(crate) fn solve(
        &mut self,
        [members, bodies]: [&[usize]; 2],
        island: Rolling<G>,
        moments: &mut [Moment<G>],
        impulses: &mut [G::Vector],
        [enough, reached]: [f64; 2],
        v: &mut [f64],
    ) -> Option<(Left, usize)> {
        let of = |i: &usize| moments.binary_search_by_key(i, |moment| moment.contact);
        let rolling = members.iter().filter(|i| of(i).is_ok()).count();
        let first = *members.first()?;
        if rolling == 0 || G::TRANSLATION * (members.len() + rolling) > ROWS {
            return None;
        }
        self.seen += rolling;
        if !self.insists && self.failed.contains(&first) {
            return None;
        }
        self.rows.clear();
        self.pulls.clear();
        self.x.clear();
        for &i in members {
            let point = &island.contacts[i];
            let directions = G::directions(&point.normal);
            let normal = self.pulls.len();
            for (k, along) in directions.as_ref().iter().enumerate() {
                let bias = if k == 0 { island.bias[i] } else { 0.0 };
                self.pull(i, island, bias, |state, side, sign| {
                    let arm = G::rotate(&state.frame, &point.arms[side]);
                    G::row(&state.frame, &arm, &(*along * sign))
                });
                self.x.push(G::dot(&impulses[i], along));
            }
            self.rows.push(RowLaw::Cone(point.friction), self.rates.drain(..));
            let Ok(own) = moments.binary_search_by_key(&i, |moment| moment.contact) else {
                continue;
            };
            let (moment, length) = (&moments[own], arm(point, island.states));
            for part in 0..2 {
                if moment.lengths[part] == 0.0 {
                    continue;
                }
                for axis in axes::<G>(&directions, part) {
                    self.pull(i, island, 0.0, |state, _, sign| {
                        let along = axis * (sign * length);
                        G::join(&state.frame, &G::Vector::default(), &along)
                    });
                    self.x.push(G::along_spin(&moment.now[part], &axis) / length);
                }
                if !self.rates.is_empty() {
                    let reach = moment.lengths[part] / length;
                    self.rows.push_disc(normal, reach, self.rates.drain(..));
                }
            }
        }
        let RollingRows { rows, pulls, x, .. } = self;
        let touched = |pull: &Pull<G>| island.contacts[pull.contact].bodies;
        rows.couple(|row, line| {
            let own = &pulls[row];
            for (other, w) in pulls[row..].iter().zip(line) {
                for (body, mine) in touched(own).iter().zip(&own.sides) {
                    for (of, theirs) in touched(other).iter().zip(&other.sides) {
                        if body.is_some() && body == of {
                            *w += product(mine.as_ref(), theirs.as_ref());
                        }
                    }
                }
            }
        });
        // Normals may have turned since the guess.
        rows.admit(x);
        let Solved { left, systems, .. } = rows.solve(x, enough);
        if left.worst() > reached && !self.insists {
            self.failed.push(first);
            self.left =
                if self.failed.len() > 1 { self.left.max(left.worst()) } else { left.worst() };
            return None;
        }
        self.write(members, island, moments, impulses);
        let f = G::FREEDOMS;
        for &body in bodies {
            v[f * body..][..f].copy_from_slice(&island.free[f * body..][..f]);
        }
        for (pull, x) in self.pulls.iter().zip(&self.x) {
            for (body, side) in island.contacts[pull.contact].bodies.iter().zip(&pull.sides) {
                let Some(body) = *body else { continue };
                let scaled = side.as_ref().iter().zip(island.states[body].scale.as_ref());
                let v = v[f * body..][..f].iter_mut();
                v.zip(scaled).for_each(|(v, (pull, scale))| *v += pull * scale * x);
            }
        }
        Some((left, systems))
    }

    /// Appends a row, by the velocity that it reads of each body.
    fn pull(
        &mut self,
        contact: usize,
        island: Rolling<G>,
        bias: f64,
        row: impl Fn(&BodyState<G>, usize, f64) -> G::Velocity,
    ) {
        let (mut rate, mut sides) = (bias, [G::Velocity::default(); 2]);
        for (side, sign) in [(0, -1.0), (1, 1.0)] {
            let Some(body) = island.contacts[contact].bodies[side] else { continue };
            let state = &island.states[body];
            let own = row(state, side, sign);
            rate += product(own.as_ref(), &island.free[G::FREEDOMS * body..][..G::FREEDOMS]);
            let scaled = own.as_ref().iter().zip(state.scale.as_ref()).map(|(row, s)| row * s);
            sides[side].as_mut().iter_mut().zip(scaled).for_each(|(to, scaled)| *to = scaled);
        }
        self.pulls.push(Pull { contact, sides });
        self.rates.push(rate);
    }

    /// Writes what was found.
    fn write(
        &self,
        members: &[usize],
        island: Rolling<G>,
        moments: &mut [Moment<G>],
        impulses: &mut [G::Vector],
    ) {
        let mut found = self.x.iter();
        for &i in members {
            let point = &island.contacts[i];
            let directions = G::directions(&point.normal);
            let along = directions.as_ref().iter().zip(found.by_ref());
            impulses[i] = along.fold(G::Vector::default(), |sum, (along, x)| sum + *along * *x);
            let Ok(own) = moments.binary_search_by_key(&i, |moment| moment.contact) else {
                continue;
            };
            let (moment, length) = (&mut moments[own], arm(point, island.states));
            for part in (0..2).filter(|&part| moment.lengths[part] > 0.0) {
                let along = axes::<G>(&directions, part).zip(found.by_ref());
                moment.now[part] =
                    along.fold(G::Spin::default(), |sum, (axis, x)| sum + axis * (x * length));
            }
        }
    }
}

/// The axes of rolling, or of torsion, which the plane has not.
fn axes<G: Dimension>(
    directions: &G::Directions,
    part: usize,
) -> impl Iterator<Item = G::Spin> + use<G> {
    let directions = *directions;
    let count = directions.as_ref().len();
    // Of the plane neither the third direction nor an axis along the normal.
    let of = if part == 0 { 1..count } else { 3..count + 1 };
    of.map(move |k| {
        let d = directions.as_ref();
        if k < count { G::torque(&d[0], &d[k]) } else { G::torque(&d[1], &d[2]) }
    })
}

/// The longer arm of a contact's bodies that move; one metre where it has none.
fn arm<G: Dimension>(point: &ContactIn<G>, states: &[BodyState<G>]) -> f64 {
    let length = |side: usize| {
        let state = &states[point.bodies[side]?];
        let arm = point.points[side] - state.centre;
        state.moves().then(|| G::dot(&arm, &arm).sqrt())
    };
    let longest = (0..2).filter_map(length).fold(0.0, f64::max);
    if longest > 0.0 { longest } else { 1.0 }
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
