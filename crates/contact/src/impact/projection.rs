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
    impact.check_velocity(v.0)?;
    let rounding = impact.rounding(Vector(v.0));
    let mut next = Vector(v.0.to_vec());
    let mut done = Projected { impulses: vec![0.0; impact.len()], residual: 0.0, solves: 0 };
    let mut scratch = vec![0.0; impact.freedoms()];
    for island in islands(impact, contacts) {
        let mut work = Island {
            impact,
            contacts: &island,
            bias,
            rounding,
            before: Vector(v.0),
            after: Vector(&mut next.0),
            scratch: &mut scratch,
            set: ActiveSet::default(),
            lambda: Vec::new(),
        };
        done.solves += work.solve(guess)?;
        for (&contact, &lambda) in work.set.members().iter().zip(&work.lambda) {
            done.impulses[contact] = lambda;
        }
    }
    done.residual = biased_residual(impact, contacts, bias, &done.impulses, next.view());
    v.0.copy_from_slice(&next.0);
    Ok(done)
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
pub(crate) fn islands(impact: &Impact, contacts: &[usize]) -> Vec<Vec<usize>> {
    let mut groups = Groups::new(impact.freedoms());
    for &contact in contacts {
        let mut reached = impact.reached(contact);
        if let Some(first) = reached.next() {
            reached.for_each(|other| groups.join(first, other));
        }
    }
    let mut island_of = vec![usize::MAX; impact.freedoms()];
    let mut islands: Vec<Vec<usize>> = Vec::new();
    for &contact in contacts {
        let Some(root) = impact.reached(contact).next().map(|f| groups.find(f)) else { continue };
        if island_of[root] == usize::MAX {
            island_of[root] = islands.len();
            islands.push(Vec::new());
        }
        islands[island_of[root]].push(contact);
    }
    islands
}

/// Gains below this part of what was gained are rounding.
const GAIN: f64 = 1e-13;

struct Island<'a> {
    impact: &'a Impact,
    contacts: &'a [usize],
    bias: &'a [f64],
    rounding: f64,
    before: Vector<&'a [f64]>,
    after: Vector<&'a mut [f64]>,
    scratch: &'a mut [f64],
    set: ActiveSet,
    lambda: Vec<f64>,
}

impl Island<'_> {
    /// Projects the part of `after` that the island reaches; says how many systems it solved.
    fn solve(&mut self, guess: &[f64]) -> Result<usize, ContactError> {
        let mut refused = vec![false; self.contacts.len()];
        let mut solves = self.take_guess(guess);
        let mut best = self.gain();
        let bound = 10 * self.contacts.len() + 20;
        for _ in 0..bound {
            self.move_by(&self.lambda.clone());
            let Some(place) = self.fastest_approach(&refused) else {
                return Ok(solves);
            };
            let contact = self.contacts[place];
            if !self.take_in(contact) {
                refused[place] = true;
                continue;
            }
            solves += self.settle();
            let stayed = self.set.members().contains(&contact);
            let gain = self.gain();
            // A contact that leaves at once came in by rounding only; so did one that takes over from another
            // and gains nothing, and the other would take over from it again.
            if stayed && gain > best + GAIN * best.abs() {
                best = gain;
                refused.fill(false);
            } else {
                refused[place] = true;
            }
        }
        Err(ContactError::NotConverged {
            what: "the inelastic projection",
            iterations: bound,
            residual: self.impact.approach(Vector(self.after.0)),
            velocity: self.after.0.to_vec(),
        })
    }

    /// What the impulses of the set gain in the dual programme, J: `-1/2 sum lambda (dg v- + bias)`, where they
    /// solve its equations. No set comes twice while it grows.
    fn gain(&self) -> f64 {
        let rates = self.rates(self.before);
        -0.5 * rates.iter().zip(&self.lambda).map(|(rate, lambda)| rate * lambda).sum::<f64>()
    }

    /// Lets a contact push. Where its row depends on those that push already, it takes over from
    /// them, at the same velocity, until the first of them is free to leave; says whether it can.
    fn take_in(&mut self, contact: usize) -> bool {
        let Err(depends) = self.set.append(self.impact, contact, self.scratch) else {
            self.lambda.push(0.0);
            return true;
        };
        let largest = depends.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
        let shares = self.lambda.iter().zip(&depends).enumerate();
        let leaves = shares
            .filter(|(_, (_, c))| **c > 1e-9 * largest)
            .map(|(place, (lambda, c))| (place, lambda / c))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        let Some((leaving, taken)) = leaves else { return false };
        for (lambda, c) in self.lambda.iter_mut().zip(&depends) {
            *lambda = (*lambda - taken * c).max(0.0);
        }
        self.set.remove(leaving);
        self.lambda.remove(leaving);
        if self.set.append(self.impact, contact, self.scratch).is_err() {
            return false;
        }
        self.lambda.push(taken);
        true
    }

    fn take_guess(&mut self, guess: &[f64]) -> usize {
        for &contact in self.contacts.iter().filter(|&&contact| guess[contact] > 0.0) {
            if self.set.append(self.impact, contact, self.scratch).is_ok() {
                self.lambda.push(0.0);
            }
        }
        if self.lambda.is_empty() { 0 } else { self.settle() }
    }

    /// Moves the impulses towards the solution of the set's equations, and lets go of those that
    /// would have to pull, until none has to.
    fn settle(&mut self) -> usize {
        let mut solves = 0;
        loop {
            let target = self.target();
            solves += 1;
            if target.iter().all(|&to| to > 0.0) {
                self.lambda = target;
                return solves;
            }
            let part = |(&from, &to): (&f64, &f64)| match to <= 0.0 {
                true if from > 0.0 => from / (from - to),
                true => 0.0,
                false => f64::INFINITY,
            };
            let parts: Vec<f64> = self.lambda.iter().zip(&target).map(part).collect();
            let reach = parts.iter().copied().fold(f64::INFINITY, f64::min);
            for (lambda, to) in self.lambda.iter_mut().zip(&target) {
                *lambda += reach * (to - *lambda);
            }
            for place in (0..parts.len()).rev().filter(|&place| parts[place] == reach) {
                self.set.remove(place);
                self.lambda.remove(place);
            }
        }
    }

    /// The impulses that stop all of the set's contacts, with one step of refinement.
    fn target(&mut self) -> Vec<f64> {
        let mut z: Vec<f64> = self.rates(self.before).iter().map(|rate| -rate).collect();
        self.set.solve(&mut z);
        self.move_by(&z);
        let mut off: Vec<f64> = self.rates(Vector(self.after.0)).iter().map(|rate| -rate).collect();
        self.set.solve(&mut off);
        z.iter_mut().zip(&off).for_each(|(z, off)| *z += off);
        z
    }

    fn rates(&self, v: Vector<&[f64]>) -> Vec<f64> {
        let rate = |&i: &usize| self.impact.relative_velocity(i, v) + self.bias[i];
        self.set.members().iter().map(rate).collect()
    }

    /// Writes the velocity after the set's impulses into the freedoms of the island.
    fn move_by(&mut self, lambda: &[f64]) {
        for &contact in self.contacts {
            for freedom in self.impact.reached(contact) {
                self.after.0[freedom] = self.before.0[freedom];
            }
        }
        for (&contact, &lambda) in self.set.members().iter().zip(lambda) {
            self.impact.push(contact, lambda, self.after.view_mut());
        }
    }

    /// The place of the contact whose approach would cost the most energy.
    fn fastest_approach(&self, refused: &[bool]) -> Option<usize> {
        let mut worst = (0.0, None);
        for (place, &contact) in self.contacts.iter().enumerate().filter(|&(p, _)| !refused[p]) {
            let u =
                self.impact.relative_velocity(contact, Vector(self.after.0)) + self.bias[contact];
            let weighed = u / self.impact.compliance(contact).sqrt();
            if u < -self.rounding && weighed < worst.0 && !self.set.members().contains(&contact) {
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
