//! One island of contacts, solved: projected exactly where that is enough, else settled by sweeps,
//! and polished to rounding where it is small.
//!
//! ```text
//! x = (J.n, J.t, ..),   the projection or sweeps,   J = x_n n + x_t t + ..
//! 0 <= lambda,  g + h u >= 0           lifting: overlaps alone, positions alone, no friction
//! ```
//! `J` impulses on second bodies in world axes (N s), from those that are guessed; `n`, `t` normal
//! and tangents, made once for contacts that share a normal. See [`FreeMotion`] and [`Sweeps`].

use std::fmt::Debug;
use std::ops::{Add, Mul};

use stationary_calculus::array;

use crate::solve::body_state::BodyState;
use crate::solve::exact_projection::{FreeMotion, Room};
use crate::solve::friction::into_cone;
use crate::solve::polish::Polish;
use crate::solve::rigid_contact::{Directions, RigidContact};
use crate::solve::sweeps::{AMPLIFICATION, Goal, Island, Sweeps};
use crate::solve::unsettled_parts::UnsettledParts;
use crate::{ContactError, ContactIn, Dimension, WorldReport};

/// What solves the contacts of one island after another. There is one; the trait is how a dimension
/// names it with its numbers of freedoms and directions.
pub trait SolvesIslands<G: Dimension>: Debug + Default {
    /// So many bodies before any impulse.
    fn start(&mut self, bodies: usize);

    /// Solves the contacts of these numbers between these bodies, from and into their impulses;
    /// says what is left of the normal conditions and of Coulomb's law, m/s.
    ///
    /// # Errors
    /// [`ContactError::Immovable`] for a contact of two that nothing moves.
    fn solve(
        &mut self,
        island: [&[usize]; 2],
        conditions: Conditions<G>,
        impulses: &mut [G::Vector],
        report: &mut WorldReport,
    ) -> Result<[f64; 2], ContactError>;

    /// Pushes apart what approaches its limit, without friction, from rest: velocities of positions, to be
    /// read as [`SolvesIslands::change`].
    ///
    /// # Errors
    /// [`ContactError::Immovable`] for a contact of two that nothing moves.
    fn lift(
        &mut self,
        island: [&[usize]; 2],
        overlaps: Overlaps<G>,
        settled: f64,
    ) -> Result<(), ContactError>;

    /// What rounding of the impulses leaves in the rates of the island solved last, m/s.
    fn rounding(&self) -> f64;

    /// The scaled change of a body's velocity.
    fn change(&self, body: usize) -> &G::Velocity;
}

/// The contacts of the islands of a step, packed, and the impulses of one.
#[derive(Debug)]
pub struct IslandSolver<V, const F: usize, const D: usize> {
    /// Room for contacts, so many of them packed: one island after another in the same place, which stays near.
    contacts: Vec<RigidContact<F, D>>,
    packed: usize,
    directions: Vec<[V; D]>,
    x: Vec<[f64; D]>,
    sweeps: Sweeps<F, D>,
    parts: UnsettledParts<F, D>,
    polish: Polish<D>,
    exact: Room,
    rounding: f64,
}

impl<V, const F: usize, const D: usize> Default for IslandSolver<V, F, D> {
    fn default() -> Self {
        IslandSolver {
            contacts: Vec::new(),
            packed: 0,
            directions: Vec::new(),
            x: Vec::new(),
            sweeps: Sweeps::default(),
            parts: UnsettledParts::default(),
            polish: Polish::default(),
            exact: Room::default(),
            rounding: 0.0,
        }
    }
}

/// What is to be met, and how far.
#[derive(Clone, Copy)]
pub struct Conditions<'a, G: Dimension> {
    pub(crate) free: FreeMotion<'a, G>,
    pub(crate) states: &'a [BodyState<G>],
    pub(crate) within: Within,
}

/// What is to be pushed apart: no contact may approach faster than `bias`, and none comes farther below `least`.
#[derive(Clone, Copy)]
pub struct Overlaps<'a, G: Dimension> {
    pub(crate) points: &'a [ContactIn<G>],
    pub(crate) bias: &'a [f64],
    pub(crate) least: &'a [f64],
    pub(crate) states: &'a [BodyState<G>],
    /// Whether they are of a pile.
    pub(crate) of_pile: bool,
}

/// What may be left, m/s.
#[derive(Clone, Copy)]
pub(crate) struct Within {
    /// Changes that settle an island, and those that are enough where it takes too much work.
    pub(crate) settled: f64,
    pub(crate) enough: f64,
    /// Changes from which what nearly rests is brought to rest.
    pub(crate) still: f64,
    /// The residual within which the island is settled.
    pub(crate) reached: f64,
    /// What may be left of what nearly rests, if these bodies hardly move.
    pub(crate) fine: Option<f64>,
    /// Whether it is of a pile, in which no island gets the work of one that is alone.
    pub(crate) of_pile: bool,
}

/// Rounding of rates relative to the velocities that single impulses give.
pub(crate) const IMPULSE_ROUNDING: f64 = 64.0 * f64::EPSILON;
/// The most work at an island in a step, in sweeps.
const SWEEPS: usize = 2_000;
/// Sweeps that find the active, sticking and sliding sets of a small island, which is then polished.
const FIRST_SWEEPS: usize = 32;
/// Islands of no more contacts are polished at once; of no more than these where sweeps do not settle
/// them: the work grows with the cube.
const SMALL: usize = 20;
const POLISHED: usize = 100;
/// Islands of no more contacts are tried from more and more sweeps where nothing else settles them.
const PERSISTED: usize = 40;
/// The most visits to contacts of an island in a step that settle it finer than is enough: as much work as
/// all sweeps over the largest island that counts as small, halved.
const VISITS_PAST_ENOUGH: usize = 100_000;
/// Where the heaviest body of an island is so many times heavier than the lightest, a velocity that is rounding
/// to the lightest is energy to the heaviest: such islands are refined.
const MASS_RATIO: f64 = 100.0;
/// An island of a pile whose impulses, as far as they are settled, give energy is settled to this part of that.
const FINER: f64 = 0.25;
/// The most work that pushes apart what overlaps, in sweeps: the next step goes on.
const LIFTS: usize = 20;
/// What hardly moves and is off by no more than so many times what may be left will soon rest, if
/// only its impulses are good enough to be kept.
const NEARLY_SETTLED: f64 = 30.0;

/// Not generic, so that the solver is compiled here and not in every crate that steps a world.
macro_rules! solves_islands {
    ($dimension:ty, $vector:ty, $freedoms:literal, $directions:literal) => {
        impl SolvesIslands<$dimension> for IslandSolver<$vector, $freedoms, $directions> {
            fn start(&mut self, bodies: usize) {
                self.sweeps.start(bodies);
            }

            fn solve(
                &mut self,
                island: [&[usize]; 2],
                conditions: Conditions<$dimension>,
                impulses: &mut [$vector],
                report: &mut WorldReport,
            ) -> Result<[f64; 2], ContactError> {
                self.solve_contacts(island, conditions, impulses, report)
            }

            fn lift(
                &mut self,
                island: [&[usize]; 2],
                overlaps: Overlaps<$dimension>,
                settled: f64,
            ) -> Result<(), ContactError> {
                self.lift_contacts(island, overlaps, settled)
            }

            fn rounding(&self) -> f64 {
                self.rounding
            }

            fn change(&self, body: usize) -> &[f64; $freedoms] {
                &self.sweeps.w[body]
            }
        }
    };
}

#[cfg(feature = "2d")]
solves_islands!(crate::Planar, nalgebra::Vector2<f64>, 3, 2);
#[cfg(feature = "3d")]
solves_islands!(crate::Spatial, nalgebra::Vector3<f64>, 6, 3);

impl<V, const F: usize, const D: usize> IslandSolver<V, F, D>
where
    V: Copy + Debug + Default + PartialEq + Add<Output = V> + Mul<f64, Output = V>,
{
    fn solve_contacts<G>(
        &mut self,
        [members, bodies]: [&[usize]; 2],
        conditions: Conditions<G>,
        impulses: &mut [V],
        report: &mut WorldReport,
    ) -> Result<[f64; 2], ContactError>
    where
        G: Dimension<Vector = V, Velocity = [f64; F], Directions = [V; D]>,
    {
        let Conditions { free, states, within } = conditions;
        self.pack::<G>(members, free.points, free.bias, states)?;
        self.x.clear();
        for (&i, directions) in members.iter().zip(&self.directions) {
            let guess: [f64; D] = array(|k| G::dot(&impulses[i], &directions[k]));
            // The normal may have turned since: a guess pulls no more than any impulse does.
            self.x.push(into_cone(guess, free.points[i].friction));
        }
        let (x, sweeps) = (&mut self.x, &mut self.sweeps);
        let island = Island { contacts: &self.contacts[..self.packed], bodies };
        sweeps.push(island, x);
        let settled = within.settled;
        let rubs = |(contact, x): (&RigidContact<F, D>, &[f64; D])| {
            let mut across = *x;
            across[0] = 0.0;
            contact.speed(&across)
        };
        let smooth = island.contacts.iter().zip(x.iter()).map(rubs).all(|speed| speed <= settled);
        // What rubs in a moving pile is swept in any case.
        let mut left = match within.of_pile && within.fine.is_none() && !smooth {
            true => [f64::INFINITY; 2],
            false => sweeps.residuals(island, x),
        };
        let near = left.iter().all(|left| *left <= NEARLY_SETTLED * settled);
        let large = within.of_pile || members.len() > POLISHED;
        let within = Within { fine: within.fine.filter(|_| near || large), ..within };
        let met = |left: &[f64; 2]| left.iter().all(|left| *left <= within.fine.unwrap_or(settled));
        let smooth = smooth && left[1] <= settled;
        let room = &mut self.exact;
        if !met(&left) && smooth && free.project(members, island, x, sweeps, room)? {
            report.projected += 1;
            left = sweeps.residuals(island, x);
        }
        // What sweeps alone have settled in a pile has been looked at already.
        let mut looked = None;
        if !met(&left) {
            let [relaxed, solved] = match within.of_pile {
                true => self.settle_of_pile(bodies, within),
                false => self.settle_alone(bodies, within),
            };
            report.relaxed += relaxed;
            report.solved += solved;
            looked =
                self.parts.left.filter(|_| within.of_pile && within.fine.is_none() && solved == 0);
        }
        let (x, sweeps) = (&mut self.x, &mut self.sweeps);
        let island = Island { contacts: &self.contacts[..self.packed], bodies };
        if members.len() <= POLISHED && unequal::<G>(bodies, states) {
            report.solved += self.polish.refine(sweeps, island, x);
        }
        let mut left = looked.unwrap_or_else(|| sweeps.conclude(island, x));
        if looked.is_some() {
            let contacts = x.iter_mut().zip(island.contacts);
            contacts.for_each(|(x, contact)| *x = into_cone(*x, contact.friction));
        }
        if within.of_pile && left.iter().any(|left| *left > within.reached) {
            report.solved += self.polish.polish(sweeps, island, x, (SMALL, within.reached));
            left = sweeps.conclude(island, x);
        }
        let mut gives = sweeps.part_without_energy(island, x, free.bias, members);
        if gives.is_some() && within.of_pile {
            let goal = Goal::in_pile(FINER * settled, FINER * within.reached);
            let more = self.parts.settle(sweeps, island, x, goal, SWEEPS);
            (report.relaxed, report.solved) = (report.relaxed + more[0], report.solved + more[1]);
            left = sweeps.conclude(island, x);
            gives = sweeps.part_without_energy(island, x, free.bias, members);
        }
        // Rounding of very different masses may have misled them.
        if let Some(part) = gives {
            sweeps.shorten(island, x, part);
            left = sweeps.residuals(island, x);
        }
        let pushed = island.contacts.iter().zip(x.iter()).map(|(contact, x)| contact.speed(x));
        self.rounding = IMPULSE_ROUNDING * pushed.fold(0.0, f64::max);
        for ((&i, directions), x) in members.iter().zip(&self.directions).zip(x) {
            let along = |k: usize| directions[k] * x[k];
            impulses[i] = (1..D).fold(along(0), |sum, k| sum + along(k));
        }
        Ok(left)
    }

    fn lift_contacts<G>(
        &mut self,
        [members, bodies]: [&[usize]; 2],
        Overlaps { points, bias, least, states, of_pile }: Overlaps<G>,
        settled: f64,
    ) -> Result<(), ContactError>
    where
        G: Dimension<Vector = V, Velocity = [f64; F], Directions = [V; D]>,
    {
        self.pack::<G>(members, points, bias, states)?;
        let contacts = &mut self.contacts[..self.packed];
        for (contact, &i) in contacts.iter_mut().zip(members) {
            contact.friction = 0.0;
            contact.offset = [0.0; D];
            contact.offset[0] = bias[i];
        }
        bodies.iter().for_each(|&body| self.sweeps.w[body] = [0.0; F]);
        self.x.clear();
        self.x.resize(members.len(), [0.0; D]);
        let island = Island { contacts, bodies };
        if members.len() <= POLISHED && !of_pile {
            let goal = Goal { residual: f64::INFINITY, ..Goal::moving(settled) };
            self.sweeps.alternate(island, &mut self.x, goal, LIFTS);
        } else {
            // One contact that is left limits the lift of all: sweeps go on where it is.
            let goal = Goal::lifted(settled);
            self.parts.settle(&mut self.sweeps, island, &mut self.x, goal, LIFTS);
        }
        // What few sweeps have not settled must press none deeper than the step's velocities leave another.
        let left = |&i: &usize| bias[i] - least[i];
        let deepest = members.iter().map(|i| -left(i)).fold(settled, f64::max);
        let mut part = 1.0_f64;
        for (contact, i) in island.contacts.iter().zip(members) {
            let change = contact.rates(&self.sweeps.w)[0] - bias[*i];
            let room = left(i) + deepest;
            if change < 0.0 {
                part = part.min(room / -change);
            }
        }
        let w = &mut self.sweeps.w;
        bodies.iter().for_each(|&body| w[body] = array(|f| part * w[body][f]));
        Ok(())
    }
}

/// Whether the masses of these bodies differ much.
pub(crate) fn unequal<G: Dimension>(bodies: &[usize], states: &[BodyState<G>]) -> bool {
    let scales = bodies.iter().map(|&body| states[body].scale.as_ref()[0]);
    let [least, most] = scales.fold([f64::INFINITY, 0.0_f64], |[a, b], s| [a.min(s), b.max(s)]);
    most * most > MASS_RATIO * least * least
}

impl<V: Copy + Default + PartialEq, const F: usize, const D: usize> IslandSolver<V, F, D> {
    /// Settles an island of a pile as far as asked, and what nearly rests a little finer in every step, until it
    /// rests; says how many contacts were relaxed, and how many systems solved.
    fn settle_of_pile(&mut self, bodies: &[usize], within: Within) -> [usize; 2] {
        let IslandSolver { contacts, packed, x, sweeps, parts, .. } = self;
        let island = Island { contacts: &contacts[..*packed], bodies };
        let Within { settled, reached, fine, .. } = within;
        let held = fine.map_or(0, |change| sweeps.hold(island, x, change));
        let goal = match fine {
            Some(_) => Goal { residual: reached, ..Goal::moving(settled) },
            None => Goal::in_pile(settled, reached),
        };
        let [mut relaxed, mut solved] = parts.settle(sweeps, island, x, goal, SWEEPS);
        solved += held;
        if let Some(change) = fine {
            let more = sweeps.rest(island, x, change);
            (relaxed, solved) = (relaxed + more[0], solved + more[1]);
        }
        [relaxed, solved]
    }

    /// Settles an island whose work need not be shared: to rounding where it is small, and by all means where
    /// what is left is more than asked.
    fn settle_alone(&mut self, bodies: &[usize], within: Within) -> [usize; 2] {
        let IslandSolver { contacts, packed, x, sweeps, parts, polish, .. } = self;
        let island = Island { contacts: &contacts[..*packed], bodies };
        let n = island.contacts.len();
        let Within { settled, enough, still, reached, fine, .. } = within;
        let met = |left: &[f64; 2]| left.iter().all(|left| *left <= fine.unwrap_or(settled));
        let finer = enough > settled || fine.is_some();
        let most = if finer { VISITS_PAST_ENOUGH.div_ceil(n) } else { SWEEPS };
        let small = n <= SMALL && fine.is_none();
        let [mut relaxed, mut solved] = match fine {
            Some(change) => {
                // From rough sweeps on, as sweeps leave what they change slowly, and it would move what is to rest.
                let rough = settled.max(still);
                let held = if n > POLISHED { sweeps.hold(island, x, change) } else { 0 };
                let first = parts.settle(sweeps, island, x, Goal::moving(rough), SWEEPS);
                let then = sweeps.rest(island, x, change);
                let last = match met(&sweeps.residuals(island, x)) {
                    true => [0; 2],
                    false => sweeps.alternate(island, x, Goal::at_rest(change), most),
                };
                [first[0] + then[0] + last[0], held + first[1] + then[1] + last[1]]
            }
            None if small => parts.settle(sweeps, island, x, Goal::moving(settled), FIRST_SWEEPS),
            None => parts.settle(sweeps, island, x, Goal::moving(settled), most),
        };
        solved += polish.polish(sweeps, island, x, (SMALL, reached));
        let mut left = sweeps.residuals(island, x);
        if small && !met(&left) {
            let more = parts.settle(sweeps, island, x, Goal::moving(settled), most);
            (relaxed, solved) = (relaxed + more[0], solved + more[1]);
        }
        left = sweeps.residuals(island, x);
        let off = left.iter().any(|left| *left > reached);
        if off || (small && !met(&left)) {
            solved += polish.polish(sweeps, island, x, (POLISHED, reached));
            left = sweeps.residuals(island, x);
        }
        if left.iter().any(|left| *left > reached) {
            solved += polish.persist(sweeps, island, x, (PERSISTED, reached));
            left = sweeps.residuals(island, x);
        }
        if left.iter().any(|left| *left > AMPLIFICATION * enough) {
            let more = parts.settle(sweeps, island, x, Goal::moving(enough), SWEEPS);
            (relaxed, solved) = (relaxed + more[0], solved + more[1]);
        }
        [relaxed, solved]
    }

    fn pack<G>(
        &mut self,
        members: &[usize],
        points: &[ContactIn<G>],
        bias: &[f64],
        states: &[BodyState<G>],
    ) -> Result<(), ContactError>
    where
        G: Dimension<Vector = V, Velocity = [f64; F], Directions = [V; D]>,
    {
        self.packed = members.len();
        self.directions.clear();
        for &i in members {
            let normal = &points[i].normal;
            self.directions.push(match self.directions.last() {
                Some(&last) if last[0] == *normal => last,
                _ => G::directions(normal),
            });
        }
        if self.contacts.len() < self.packed {
            self.contacts.resize(self.packed, RigidContact::NONE);
        }
        let contacts = &mut self.contacts[..self.packed];
        let mut shared: Option<(usize, Directions<V, D>)> = None;
        for ((contact, &i), &world) in contacts.iter_mut().zip(members).zip(&self.directions) {
            // Points of two faces have the same directions.
            let same = |j: usize| {
                points[j].bodies == points[i].bodies && points[j].normal == points[i].normal
            };
            let directions = match &shared {
                Some((j, directions)) if same(*j) => directions,
                _ => &shared.insert((i, Directions::of(world, &points[i], states))).1,
            };
            contact.set(&points[i], directions, bias[i], states);
            if !contact.moves() {
                return Err(ContactError::Immovable { contact: i });
            }
        }
        Ok(())
    }
}
