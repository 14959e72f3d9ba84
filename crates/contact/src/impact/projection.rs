//! The inelastic projection: of all velocities that no contact forbids, the closest one.
//!
//! ```text
//! min 1/2 |v - v-|^2 in the metric M,   dg v >= 0                                         (11.1)
//! v = v- + M^-1 dg^T lambda,   lambda >= 0,   dg v >= 0,   lambda_i dg_i v = 0              (11.2)
//! residual = max_i |min(d_i lambda_i, dg_i v)|,   d_i = dg_i M^-1 dg_i^T                    m/s
//! ```
//! A convex quadratic programme: `v` is unique, `lambda` only if no contact is redundant. Solved
//! exactly by active sets, on each island of bodies on its own: the contact that approaches fastest
//! joins those that push, those that would have to pull leave, and the system of those that push is
//! solved by its factor; one that depends on those that push takes the place of another. Every
//! round ends at a lower kinetic energy, so that no set comes twice. A guess of the active set (the
//! last step's) saves most of the rounds.
//!
//! Kinetic energy never grows, and momentum is kept. Source: notes 11.5.1 (errata: the conditions
//! are on gaps and their rates, and v is the pre-impact velocity plus impulses); Lawson and Hanson
//! 1974, chapter 23.

use stationary_calculus::Vector;

use crate::impact::active_set::ActiveSet;
use crate::impact::inverse_mass::Groups;
use crate::{ContactError, Impact};

/// What a projection took.
#[derive(Clone, Debug, PartialEq)]
pub struct Projected {
    /// The impulse of each contact, N s.
    pub impulses: Vec<f64>,
    /// How far the conditions (11.2) are from being met, m/s.
    pub residual: f64,
    /// Linear systems solved.
    pub solves: usize,
}

/// Projects a velocity on those that no contact forbids.
///
/// # Errors
/// [`ContactError::Size`] and [`ContactError::NonFinite`] for the velocity;
/// [`ContactError::NotConverged`] where contacts still approach at the bound on the rounds. The
/// velocity is then as it was.
pub fn project(impact: &Impact, v: Vector<&mut [f64]>) -> Result<Projected, ContactError> {
    project_onto(impact, &all(impact.len()), &vec![0.0; impact.len()], v)
}

/// The same with a guess of the active set by impulses, whatever their size.
///
/// # Errors
/// [`ContactError::Size`] unless there is a guess for each contact; those of [`project`].
pub fn project_from(
    impact: &Impact,
    guess: &[f64],
    v: Vector<&mut [f64]>,
) -> Result<Projected, ContactError> {
    stationary_calculus::SizeError::check("the guessed impulses", impact.len(), guess.len())?;
    project_onto(impact, &all(impact.len()), guess, v)
}

/// Every contact.
pub(crate) fn all(contacts: usize) -> Vec<usize> {
    (0..contacts).collect()
}

/// The projection on `dg v + bias >= 0`: contacts with a gap left may use it up.
pub(crate) fn project_biased(
    impact: &Impact,
    bias: &[f64],
    v: Vector<&mut [f64]>,
) -> Result<Projected, ContactError> {
    project_with(impact, &all(impact.len()), bias, &vec![0.0; impact.len()], v)
}

/// The projection that knows only some of the contacts.
pub(crate) fn project_onto(
    impact: &Impact,
    contacts: &[usize],
    guess: &[f64],
    v: Vector<&mut [f64]>,
) -> Result<Projected, ContactError> {
    project_with(impact, contacts, &vec![0.0; impact.len()], guess, v)
}

/// The projection of some contacts, biased, with a guess of the active set.
pub(crate) fn project_with(
    impact: &Impact,
    contacts: &[usize],
    bias: &[f64],
    guess: &[f64],
    v: Vector<&mut [f64]>,
) -> Result<Projected, ContactError> {
    let mut projector = Projector::default();
    let solves = projector.project(impact, contacts, bias, guess, v.view())?;
    let Projector { impulses, after, .. } = projector;
    let residual = biased_residual(impact, contacts, bias, &impulses, Vector(&after));
    v.0.copy_from_slice(&after);
    Ok(Projected { impulses, residual, solves })
}

/// Projects once and again, in the same memory.
#[derive(Debug, Default)]
pub(crate) struct Projector {
    /// The impulse of each contact, N s, of the last projection.
    pub(crate) impulses: Vec<f64>,
    /// The velocity after them.
    after: Vec<f64>,
    islands: Islands,
    room: Room,
}

impl Projector {
    /// Projects a velocity on those that some contacts do not forbid; says how many systems it solved.
    pub(crate) fn project(
        &mut self,
        impact: &Impact,
        contacts: &[usize],
        bias: &[f64],
        guess: &[f64],
        v: Vector<&[f64]>,
    ) -> Result<usize, ContactError> {
        impact.check_velocity(v.0)?;
        let Projector { impulses, after, islands, room } = self;
        after.clear();
        after.extend_from_slice(v.0);
        impulses.clear();
        impulses.resize(impact.len(), 0.0);
        room.scratch.clear();
        room.scratch.resize(impact.freedoms(), 0.0);
        islands.find(impact, contacts);
        let (rounding, mut solves) = (impact.rounding(v), 0);
        for contacts in islands.iter() {
            room.set.clear();
            room.lambda.clear();
            let mut island = Island { impact, contacts, bias, rounding, before: v.0, after, room };
            solves += island.solve(guess)?;
            for (&contact, &lambda) in room.set.members().iter().zip(&room.lambda) {
                impulses[contact] = lambda;
            }
        }
        Ok(solves)
    }
}

/// How far impulses and the velocity after them are from the conditions (11.2), m/s.
pub fn residual(impact: &Impact, impulses: &[f64], v: Vector<&[f64]>) -> f64 {
    biased_residual(impact, &all(impact.len()), &vec![0.0; impact.len()], impulses, v)
}

fn biased_residual(
    impact: &Impact,
    contacts: &[usize],
    bias: &[f64],
    impulses: &[f64],
    v: Vector<&[f64]>,
) -> f64 {
    let one = |&i: &usize| {
        let push = impact.compliance(i) * impulses[i];
        push.min(impact.relative_velocity(i, v) + bias[i]).abs()
    };
    contacts.iter().map(one).fold(0.0, f64::max)
}

/// Contacts that share no movable freedom do not know of each other.
#[derive(Debug, Default)]
pub(crate) struct Islands {
    groups: Groups,
    /// Of each freedom that stands for its group.
    island: Vec<usize>,
    /// Where the contacts of each island end in the list of all of them.
    ends: Vec<usize>,
    contacts: Vec<usize>,
}

impl Islands {
    /// Parts some contacts.
    pub(crate) fn find(&mut self, impact: &Impact, contacts: &[usize]) {
        let Islands { groups, island, ends, contacts: parted } = self;
        groups.reset(impact.freedoms());
        for &contact in contacts {
            let mut reached = impact.reached(contact);
            if let Some(first) = reached.next() {
                reached.for_each(|other| groups.join(first, other));
            }
        }
        island.clear();
        island.resize(impact.freedoms(), usize::MAX);
        ends.clear();
        let mut root = |contact: usize| impact.reached(contact).next().map(|f| groups.find(f));
        for root in contacts.iter().filter_map(|&contact| root(contact)) {
            if island[root] == usize::MAX {
                island[root] = ends.len();
                ends.push(0);
            }
            ends[island[root]] += 1;
        }
        // From sizes to starts, which become ends as the contacts come.
        let mut before = 0;
        for size in ends.iter_mut() {
            (*size, before) = (before, before + *size);
        }
        parted.clear();
        parted.resize(before, 0);
        for &contact in contacts {
            let Some(root) = root(contact) else { continue };
            let end = &mut ends[island[root]];
            parted[*end] = contact;
            *end += 1;
        }
    }

    /// The contacts of one island after another.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &[usize]> {
        let starts = [0].into_iter().chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.contacts[start..end])
    }
}

/// Gains below this part of what was gained are rounding.
const GAIN: f64 = 1e-13;

/// Room for the numbers of an island.
#[derive(Debug, Default)]
struct Room {
    /// A number a freedom, zero between uses.
    scratch: Vec<f64>,
    set: ActiveSet,
    /// Of the set's members: impulses, those that would stop them, what these leave, how far to go.
    lambda: Vec<f64>,
    target: Vec<f64>,
    off: Vec<f64>,
    parts: Vec<f64>,
    refused: Vec<bool>,
}

struct Island<'a> {
    impact: &'a Impact,
    contacts: &'a [usize],
    bias: &'a [f64],
    rounding: f64,
    before: &'a [f64],
    after: &'a mut [f64],
    room: &'a mut Room,
}

impl Island<'_> {
    /// Projects the part of `after` that the island reaches; says how many systems it solved.
    fn solve(&mut self, guess: &[f64]) -> Result<usize, ContactError> {
        self.room.refused.clear();
        self.room.refused.resize(self.contacts.len(), false);
        let mut solves = self.take_guess(guess);
        let mut best = self.gain();
        let bound = 10 * self.contacts.len() + 20;
        for _ in 0..bound {
            self.move_by(|room| &room.lambda);
            let Some(place) = self.fastest_approach() else {
                return Ok(solves);
            };
            let contact = self.contacts[place];
            if !self.take_in(contact) {
                self.room.refused[place] = true;
                continue;
            }
            solves += self.settle();
            let stayed = self.room.set.members().contains(&contact);
            let gain = self.gain();
            // A contact that leaves at once came in by rounding only; so did one that takes over from another
            // and gains nothing, and the other would take over from it again.
            if stayed && gain > best + GAIN * best.abs() {
                best = gain;
                self.room.refused.fill(false);
            } else {
                self.room.refused[place] = true;
            }
        }
        Err(ContactError::NotConverged {
            what: "the inelastic projection",
            iterations: bound,
            residual: self.impact.approach(Vector(&*self.after)),
            velocity: self.after.to_vec(),
        })
    }

    /// What the impulses of the set gain in the dual programme, J: `-1/2 sum lambda (dg v- + bias)`, where they
    /// solve its equations. No set comes twice while it grows.
    fn gain(&self) -> f64 {
        let rates = self.rates(self.before);
        -0.5 * rates.zip(&self.room.lambda).map(|(rate, lambda)| rate * lambda).sum::<f64>()
    }

    /// Lets a contact push. Where its row depends on those that push already, it takes over from
    /// them, at the same velocity, until the first of them is free to leave; says whether it can.
    fn take_in(&mut self, contact: usize) -> bool {
        let Room { set, lambda, scratch, .. } = &mut *self.room;
        let Err(depends) = set.append(self.impact, contact, scratch) else {
            lambda.push(0.0);
            return true;
        };
        let largest = depends.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
        let shares = lambda.iter().zip(depends).enumerate();
        let leaves = shares
            .filter(|(_, (_, c))| **c > 1e-9 * largest)
            .map(|(place, (lambda, c))| (place, lambda / c))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        let Some((leaving, taken)) = leaves else { return false };
        for (lambda, c) in lambda.iter_mut().zip(depends) {
            *lambda = (*lambda - taken * c).max(0.0);
        }
        set.remove(leaving);
        lambda.remove(leaving);
        if set.append(self.impact, contact, scratch).is_err() {
            return false;
        }
        lambda.push(taken);
        true
    }

    fn take_guess(&mut self, guess: &[f64]) -> usize {
        let Room { set, lambda, scratch, .. } = &mut *self.room;
        for &contact in self.contacts.iter().filter(|&&contact| guess[contact] > 0.0) {
            if set.append(self.impact, contact, scratch).is_ok() {
                lambda.push(0.0);
            }
        }
        if lambda.is_empty() { 0 } else { self.settle() }
    }

    /// Moves the impulses towards the solution of the set's equations, and lets go of those that
    /// would have to pull, until none has to.
    fn settle(&mut self) -> usize {
        let mut solves = 0;
        loop {
            self.aim();
            solves += 1;
            let Room { set, lambda, target, parts, .. } = &mut *self.room;
            if target.iter().all(|&to| to > 0.0) {
                std::mem::swap(lambda, target);
                return solves;
            }
            let part = |(&from, &to): (&f64, &f64)| match to <= 0.0 {
                true if from > 0.0 => from / (from - to),
                true => 0.0,
                false => f64::INFINITY,
            };
            parts.clear();
            parts.extend(lambda.iter().zip(&*target).map(part));
            let reach = parts.iter().copied().fold(f64::INFINITY, f64::min);
            for (lambda, to) in lambda.iter_mut().zip(target) {
                *lambda += reach * (*to - *lambda);
            }
            for place in (0..parts.len()).rev().filter(|&place| parts[place] == reach) {
                set.remove(place);
                lambda.remove(place);
            }
        }
    }

    /// Finds the impulses that stop all of the set's contacts, with one step of refinement.
    fn aim(&mut self) {
        let mut z = std::mem::take(&mut self.room.target);
        z.clear();
        z.extend(self.rates(self.before).map(|rate| -rate));
        self.room.set.solve(&mut z);
        self.room.target = z;
        self.move_by(|room| &room.target);
        let mut off = std::mem::take(&mut self.room.off);
        off.clear();
        off.extend(self.rates(self.after).map(|rate| -rate));
        self.room.set.solve(&mut off);
        self.room.target.iter_mut().zip(&off).for_each(|(z, off)| *z += off);
        self.room.off = off;
    }

    /// The rates of the set's members at a velocity.
    fn rates(&self, v: &[f64]) -> impl Iterator<Item = f64> {
        let members = self.room.set.members().iter();
        members.map(move |&i| self.impact.relative_velocity(i, Vector(v)) + self.bias[i])
    }

    /// Writes the velocity after some impulses of the set into the freedoms of the island.
    fn move_by(&mut self, impulses: impl Fn(&Room) -> &[f64]) {
        for &contact in self.contacts {
            for freedom in self.impact.reached(contact) {
                self.after[freedom] = self.before[freedom];
            }
        }
        for (&contact, &lambda) in self.room.set.members().iter().zip(impulses(self.room)) {
            self.impact.push(contact, lambda, Vector(&mut *self.after));
        }
    }

    /// The place of the contact whose approach would cost the most energy.
    fn fastest_approach(&self) -> Option<usize> {
        let mut worst = (0.0, None);
        let stays_out = |place: usize| self.room.refused[place];
        for (place, &contact) in self.contacts.iter().enumerate().filter(|&(p, _)| !stays_out(p)) {
            let u =
                self.impact.relative_velocity(contact, Vector(&*self.after)) + self.bias[contact];
            let weighed = u / self.impact.compliance(contact).sqrt();
            let pushes = || self.room.set.members().contains(&contact);
            if u < -self.rounding && weighed < worst.0 && !pushes() {
                worst = (weighed, Some(place));
            }
        }
        worst.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ContactRows, InverseMass};
    use stationary_calculus::DiagonalMetric;
    use stationary_measure::SplitMix64;

    /// Gaps that no rigid motion makes: of the points of a face more than three are redundant, and
    /// which of them push is decided by taking each other's places.
    #[test]
    fn redundant_contacts_with_gaps_that_do_not_fit_each_other_are_solved_exactly() {
        let mut random = SplitMix64::new(21);
        let masses = vec![1.0, 1.0, 1.0, 0.1, 0.2, 0.15];
        let mass = InverseMass::of(&DiagonalMetric::new(masses).unwrap()).unwrap();
        for count in [4, 5, 20, 60] {
            for _ in 0..50 {
                let mut rows = ContactRows::new();
                for _ in 0..count {
                    let (x, y) = (random.symmetric(), random.symmetric());
                    rows.push([(2, 1.0), (3, y), (4, -x)]);
                }
                let impact = Impact::new(rows, &mass, vec![0.0; count]).unwrap();
                let bias: Vec<f64> = (0..count).map(|_| 0.3 * random.symmetric()).collect();
                let mut v = Vector(vec![0.1, 0.0, -1.0, 0.2, -0.1, 0.0]);
                let done = project_biased(&impact, &bias, v.view_mut()).unwrap();
                assert!(done.residual < 1e-12, "{count}: {}", done.residual);
                assert!(done.impulses.iter().filter(|&&lambda| lambda > 0.0).count() <= 3);
            }
        }
    }

    #[test]
    fn contacts_that_contradict_each_other_end_with_their_residual() {
        // Between two walls that close at 1 m/s each.
        let mass = InverseMass::of(&DiagonalMetric::new([2.0]).unwrap()).unwrap();
        let mut rows = ContactRows::new();
        rows.push([(0, 1.0)]);
        rows.push([(0, -1.0)]);
        let impact = Impact::new(rows, &mass, vec![0.0; 2]).unwrap();
        let mut v = Vector([0.0]);
        let done = project_biased(&impact, &[-1.0; 2], v.view_mut()).unwrap();
        assert!((done.residual - 2.0).abs() < 1e-15, "{done:?}");
        assert_eq!(v.0[0].abs(), 1.0);
        let open = project_biased(&impact, &[1.0; 2], v.view_mut()).unwrap();
        assert_eq!((open.residual, open.impulses), (0.0, vec![0.0; 2]));
    }
}
