//! The moments of rolling and torsional friction of an island together with all of its impulses.
//!
//! ```text
//! rows     n.u, t.u            of a contact,   |x_t| <= mu x_n
//!          l a.s               of its moments, |x_a| <= (r/l) x_n     a = n x t across the normal, t1 x t2 along it
//! w = J~^T x,   u = u_f + J~ w                                        J~ = J M^-1/2
//! ```
//! `u` how fast the second point leaves the first (m/s), `u_f` before any impulse, `s` the spin of the second body as
//! seen from the first (rad/s), `l` the longer arm of the contact (m), so that moments are impulses at its end, `r`
//! their length (m), `w` scaled changes of velocities. The laws and the method are those of [`CoupledRows`]; where
//! masses differ much Newton's last steps take their rates from velocities, and no impulses give energy. Source: Leine
//! and Glocker 2003.

use stationary_constraints::RowLaw;

use crate::coupled::coupled_rows::{CoupledRows, Solved};
use crate::coupled::row_laws::Left;
use crate::solve::body_state::BodyState;
use crate::solve::island_solver::unequal;
use crate::solve::polish::REFINEMENTS;
use crate::solve::rolling::Moment;
use crate::solve::sweeps::ENERGY_ROUNDING;
use crate::{ContactIn, Dimension};

/// The most rows of an island: their work grows with the cube.
const ROWS: usize = 300;

/// What moves bodies.
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
    /// Those that move.
    bodies: [Option<usize>; 2],
    sides: [G::Velocity; 2],
    /// Its rate before any impulse, m/s, and how much of that is of a gap.
    free: f64,
    bias: f64,
}

/// The rows of an island, and the memory of solving them.
#[derive(Debug)]
pub(crate) struct RollingRows<G: Dimension> {
    rows: CoupledRows,
    pulls: Vec<Pull<G>>,
    x: Vec<f64>,
    before: Vec<f64>,
    /// Scaled changes of velocities.
    w: Vec<f64>,
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
        RollingRows {
            rows: CoupledRows::default(),
            pulls: Vec::new(),
            x: Vec::new(),
            before: Vec::new(),
            w: Vec::new(),
            failed: Vec::new(),
            left: f64::INFINITY,
            seen: 0,
            insists: false,
        }
    }
}

impl<G: Dimension> RollingRows<G> {
    /// Forgets what failed before.
    pub(crate) fn start(&mut self) {
        self.failed.clear();
        (self.left, self.insists) = (f64::INFINITY, false);
    }

    /// The most that was left where rows did not settle an island, m/s; infinite where they settled all.
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
    /// is left of their laws, and writes the velocities of its bodies; says what is left, and how many systems were
    /// solved, or nothing where it has no moments, is too large, or more than `reached` is left.
    pub(crate) fn solve(
        &mut self,
        [members, bodies]: [&[usize]; 2],
        island: Rolling<G>,
        moments: &mut [Moment<G>],
        impulses: &mut [G::Vector],
        [enough, reached]: [f64; 2],
        v: &mut [f64],
    ) -> Option<(Left, usize)> {
        let first = *members.first()?;
        let rolling = members.iter().filter(|i| place_of(moments, **i).is_some()).count();
        if rolling == 0 || G::TRANSLATION * (members.len() + rolling) > ROWS {
            return None;
        }
        self.seen += rolling;
        if !self.insists && self.failed.contains(&first) {
            return None;
        }
        self.list(members, island, moments, impulses);
        // Normals may have turned since the guess.
        self.rows.admit(&mut self.x);
        let Solved { mut systems, .. } = self.rows.solve(&mut self.x, enough);
        self.w.resize(G::FREEDOMS * island.states.len(), 0.0);
        let mut left = self.measure(bodies);
        if unequal::<G>(bodies, island.states) {
            systems += self.refine(bodies, &mut left);
        }
        if self.bound_energy(bodies) {
            left = self.measure(bodies);
        }
        if left.worst() > reached && !self.insists {
            let others = if self.failed.is_empty() { 0.0 } else { self.left };
            self.left = left.worst().max(others);
            self.failed.push(first);
            return None;
        }
        self.write(members, island, moments, impulses);
        for &body in bodies {
            let of = G::FREEDOMS * body..G::FREEDOMS * (body + 1);
            let scale = island.states[body].scale;
            let changes = self.w[of.clone()].iter().zip(scale.as_ref()).map(|(w, scale)| w * scale);
            let free = island.free[of.clone()].iter();
            v[of].iter_mut().zip(free.zip(changes)).for_each(|(v, (free, by))| *v = free + by);
        }
        Some((left, systems))
    }

    /// The rows, and a guess of their impulses.
    fn list(
        &mut self,
        members: &[usize],
        island: Rolling<G>,
        moments: &[Moment<G>],
        impulses: &[G::Vector],
    ) {
        let RollingRows { rows, pulls, x, .. } = self;
        rows.clear();
        pulls.clear();
        x.clear();
        for &i in members {
            let point = &island.contacts[i];
            let directions = G::directions(&point.normal);
            let normal = pulls.len();
            for (k, along) in directions.as_ref().iter().enumerate() {
                let bias = if k == 0 { island.bias[i] } else { 0.0 };
                pulls.push(Pull::new(point, island, bias, |state, side, sign| {
                    let arm = G::rotate(&state.frame, &point.arms[side]);
                    G::row(&state.frame, &arm, &(*along * sign))
                }));
                x.push(G::dot(&impulses[i], along));
            }
            rows.push(RowLaw::Cone(point.friction), pulls[normal..].iter().map(|pull| pull.free));
            let Some(own) = place_of(moments, i) else { continue };
            let (moment, length) = (&moments[own], arm(point, island.states));
            for part in (0..2).filter(|&part| moment.lengths[part] > 0.0) {
                let start = pulls.len();
                for axis in axes::<G>(&directions, part) {
                    pulls.push(Pull::new(point, island, 0.0, |state, _, sign| {
                        G::join(&state.frame, &G::Vector::default(), &(axis * (sign * length)))
                    }));
                    x.push(G::along_spin(&moment.now[part], &axis) / length);
                }
                if start < pulls.len() {
                    let reach = moment.lengths[part] / length;
                    rows.push_disc(normal, reach, pulls[start..].iter().map(|pull| pull.free));
                }
            }
        }
        rows.couple(|row, line| {
            let own = &pulls[row];
            for (other, w) in pulls[row..].iter().zip(line) {
                for (body, mine) in own.bodies.iter().zip(&own.sides) {
                    for (of, theirs) in other.bodies.iter().zip(&other.sides) {
                        if body.is_some() && body == of {
                            *w += product(mine.as_ref(), theirs.as_ref());
                        }
                    }
                }
            }
        });
    }

    /// What impulses leave, by the velocities that they give.
    fn measure(&mut self, bodies: &[usize]) -> Left {
        let RollingRows { rows, pulls, x, w, .. } = self;
        for &body in bodies {
            w[G::FREEDOMS * body..][..G::FREEDOMS].fill(0.0);
        }
        pulls.iter().zip(&*x).for_each(|(pull, x)| pull.push(*x, w));
        rows.left_at(x, pulls.iter().map(|pull| pull.rate(w)))
    }

    /// Newton's steps whose rates come from velocities: where masses differ much the rounding of large impulses is in
    /// the velocities of what is light alone. Says how many systems were solved.
    fn refine(&mut self, bodies: &[usize], left: &mut Left) -> usize {
        for solved in 0..REFINEMENTS {
            let RollingRows { rows, pulls, x, before, w, .. } = self;
            before.clear();
            before.extend_from_slice(x);
            let taken = rows.refine(x, pulls.iter().map(|pull| pull.rate(w)));
            let after = self.measure(bodies);
            if !taken || after.worst() >= left.worst() {
                self.x.copy_from_slice(&self.before);
                *left = self.measure(bodies);
                return solved + 1;
            }
            *left = after;
        }
        REFINEMENTS
    }

    /// Shortens impulses that would give energy: `x.u_f + 1/2 |w|^2 <= 0`. Says whether it did.
    fn bound_energy(&mut self, bodies: &[usize]) -> bool {
        let pulls = self.pulls.iter().zip(&self.x);
        let work: f64 = pulls.map(|(pull, x)| x * (pull.free - pull.bias)).sum();
        let of = |&body: &usize| &self.w[G::FREEDOMS * body..][..G::FREEDOMS];
        let square: f64 = bodies.iter().flat_map(of).map(|w| w * w).sum();
        if work + 0.5 * square <= ENERGY_ROUNDING * square {
            return false;
        }
        let part = (-work / square).clamp(0.0, 1.0);
        self.x.iter_mut().for_each(|x| *x *= part);
        true
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
            let Some(own) = place_of(moments, i) else { continue };
            let (moment, length) = (&mut moments[own], arm(point, island.states));
            for part in (0..2).filter(|&part| moment.lengths[part] > 0.0) {
                let along = axes::<G>(&directions, part).zip(found.by_ref());
                moment.now[part] =
                    along.fold(G::Spin::default(), |sum, (axis, x)| sum + axis * (x * length));
            }
        }
    }
}

impl<G: Dimension> Pull<G> {
    /// Of a contact, by the velocity that it reads of each body.
    fn new(
        point: &ContactIn<G>,
        island: Rolling<G>,
        bias: f64,
        row: impl Fn(&BodyState<G>, usize, f64) -> G::Velocity,
    ) -> Self {
        let (mut free, mut sides) = (bias, [G::Velocity::default(); 2]);
        for (side, sign) in [(0, -1.0), (1, 1.0)] {
            let Some(body) = point.bodies[side] else { continue };
            let state = &island.states[body];
            let own = row(state, side, sign);
            free += product(own.as_ref(), &island.free[G::FREEDOMS * body..][..G::FREEDOMS]);
            let scaled = own.as_ref().iter().zip(state.scale.as_ref()).map(|(row, s)| row * s);
            sides[side].as_mut().iter_mut().zip(scaled).for_each(|(to, scaled)| *to = scaled);
        }
        let moves = |body: &usize| island.states[*body].moves();
        Pull { bodies: point.bodies.map(|body| body.filter(moves)), sides, free, bias }
    }

    fn sides(&self) -> impl Iterator<Item = (usize, &G::Velocity)> {
        self.bodies.iter().zip(&self.sides).filter_map(|(body, side)| Some(((*body)?, side)))
    }

    /// Its rate at these scaled changes of velocities.
    fn rate(&self, w: &[f64]) -> f64 {
        let change = |(body, side): (usize, &G::Velocity)| {
            product(side.as_ref(), &w[G::FREEDOMS * body..][..G::FREEDOMS])
        };
        self.free + self.sides().map(change).sum::<f64>()
    }

    /// Gives the bodies an impulse.
    fn push(&self, x: f64, w: &mut [f64]) {
        for (body, side) in self.sides() {
            let w = w[G::FREEDOMS * body..][..G::FREEDOMS].iter_mut();
            w.zip(side.as_ref()).for_each(|(w, pull)| *w += pull * x);
        }
    }
}

/// Where the moment of a contact is, if it has one.
fn place_of<G: Dimension>(moments: &[Moment<G>], contact: usize) -> Option<usize> {
    moments.binary_search_by_key(&contact, |moment| moment.contact).ok()
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
