//! Sweeps over the contacts of an island, each relaxed in turn, and between them steps of the
//! proximal-point method for all at once.
//!
//! ```text
//! x <- sweep(x),   e = 4 (|dx|^2/|x|^2)^1/2,    x <- proximal step (x, e),    x <- sweep(x), ...
//! ln(s/max_i |dx_i|)/ln r < n,   r = |dx|/|dx before|                   where sweeps alone will do
//! ```
//! `x` the impulses of the island, `|.|` in the norm of their compliance, `dx` what a sweep
//! changes, `s` what counts as settled, `n` 30, and 200 in a pile that moves. Sweeps find the active,
//! sticking and sliding sets, and how far the conditions are from being met, but carry far only
//! slowly: a column that rocks takes hundreds of them. Proximal steps carry far at once (see
//! [`Proximal`]), the farther the closer `x` is already, and cost as much as dozens of sweeps; what
//! is to rest takes them all the same, for what sweeps change slowly they leave.
//! The last sweep is taken as it is, so that no impulse pulls and no friction exceeds its reach.
//! What nearly rests is first asked whether it stands where contacts hold (see [`Sweeps::hold`]), and then
//! takes steps of far smaller `e`; one that leaves more than before is taken back (see [`Sweeps::rest`]).

use stationary_calculus::array;

use crate::solve::friction::into_cone;
use crate::solve::proximal::Proximal;
use crate::solve::rigid_contact::RigidContact;

/// The compliance that a proximal step adds to a row, relative to the row's own, per part of the
/// impulses that the last sweep changed: of the order of one, so that steps lengthen as sweeps settle.
const COMPLIANCE_PER_CHANGE: f64 = 4.0;
/// The most of it: softer steps carry no farther than a sweep.
const MAX_COMPLIANCE: f64 = 0.2;
/// The least of it: at less, rounding of rates shows in impulses.
const MIN_COMPLIANCE: f64 = 1e-6;
/// The least of it where it is seen whether a step has helped: a tower bends so softly that more would hold it.
const RESTING_COMPLIANCE: f64 = 1e-10;
/// What one contact changes last, others feel by no more than so many times that.
pub(crate) const AMPLIFICATION: f64 = 30.0;
/// A proximal step helps if the next sweep changes no more than this part of the energy of the one
/// before; if it does not, as where it has come down to rounding, some sweeps follow without.
const MIN_REDUCTION: f64 = 0.25;
/// The most proximal steps that bring what nearly rests to rest; each must leave no more than this part of what
/// the one before has left.
const RESTING_STEPS: usize = 16;
const RESTING_REDUCTION: f64 = 0.7;
/// Contacts are let hold with this compliance, less than that with which a tower of a thousand bends, so many times at
/// most, as long as no more than this part of what was left is left.
const HOLDING_COMPLIANCE: f64 = 1e-12;
const HOLDS: usize = 4;
const HOLDING_REDUCTION: f64 = 0.5;
/// A sparse system takes as long as so many sweeps.
pub(crate) const SYSTEM_COST: usize = 8;
/// A proximal step takes as long as so many sweeps.
const PROXIMAL_COST: f64 = 30.0;
/// In a pile that moves it is worth so many: most of what is unsettled has just landed, and settles in its place.
const PROXIMAL_COST_IN_PILE: f64 = 200.0;
/// There unsettled parts are taken one by one where sweeps over all of them would be more than this.
const TOGETHER_IN_PILE: f64 = 50.0;

/// Energy given by impulses that is rounding, relative to theirs.
pub(crate) const ENERGY_ROUNDING: f64 = 1e-9;

/// Scaled velocities of all bodies, and the memory of the sweeps.
#[derive(Debug, Default)]
pub(crate) struct Sweeps<const F: usize, const D: usize> {
    /// The scaled change of each body's velocity, and zeros for what does not move.
    pub(crate) w: Vec<[f64; F]>,
    /// What the last sweep over chosen contacts changed at each, as a velocity, m/s.
    pub(crate) changes: Vec<f64>,
    proximal: Proximal<F, D>,
    /// The impulses before a step that may not help.
    before: Vec<[f64; D]>,
}

/// One island: its contacts, and its bodies by their numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Island<'a, const F: usize, const D: usize> {
    pub(crate) contacts: &'a [RigidContact<F, D>],
    pub(crate) bodies: &'a [usize],
}

/// What sweeps are to reach.
#[derive(Clone, Copy)]
pub(crate) struct Goal {
    /// No contact changes a velocity by more than this, m/s.
    pub(crate) change: f64,
    /// Nor is any off by more than this, m/s.
    pub(crate) residual: f64,
    /// No proximal steps are taken where fewer sweeps than this would do, at their rate.
    pub(crate) alone: f64,
    /// Nor are unsettled parts taken one by one where fewer sweeps over all of them would do: never, if infinite.
    pub(crate) together: f64,
}

impl Goal {
    /// What moves takes them where sweeps would take longer.
    pub(crate) fn moving(change: f64) -> Self {
        let residual = AMPLIFICATION * change;
        Goal { change, residual, alone: PROXIMAL_COST, together: 0.0 }
    }

    /// What moves in a pile is asked for few digits.
    pub(crate) fn in_pile(change: f64, residual: f64) -> Self {
        Goal { change, residual, alone: PROXIMAL_COST_IN_PILE, together: TOGETHER_IN_PILE }
    }

    /// What is lifted in a pile is swept alone: the pattern of a large system would be found twice a step.
    pub(crate) fn lifted(change: f64) -> Self {
        let endless = f64::INFINITY;
        Goal { change, residual: endless, alone: endless, together: endless }
    }

    /// What is to rest takes proximal steps from the first.
    pub(crate) fn at_rest(change: f64) -> Self {
        Goal { alone: 0.0, ..Goal::moving(change) }
    }

    /// Whether fewer than so many sweeps will do, at their rate: after a change, and the energy of the one before.
    pub(crate) fn is_within(&self, sweeps: f64, change: &Change, last: f64) -> bool {
        let rate = (change.energy / last).sqrt();
        let needed = || (self.change / change.fastest).ln() / rate.ln();
        sweeps == f64::INFINITY || (rate < 1.0 && needed() < sweeps)
    }
}

/// What a sweep changed.
pub(crate) struct Change {
    /// The most at one contact, as a velocity, m/s.
    pub(crate) fastest: f64,
    /// Of all, J.
    pub(crate) energy: f64,
}

impl<const F: usize, const D: usize> Sweeps<F, D> {
    /// So many bodies whose velocities are as they were.
    pub(crate) fn start(&mut self, bodies: usize) {
        self.w.clear();
        self.w.resize(bodies + 1, [0.0; F]);
    }

    /// Gives the bodies of an island impulses.
    pub(crate) fn push(&mut self, island: Island<F, D>, x: &[[f64; D]]) {
        island.contacts.iter().zip(x).for_each(|(contact, x)| contact.push(x, &mut self.w));
    }

    /// Makes the velocities of an island again from its impulses alone: changes that were added one by
    /// one leave their rounding behind, which shows where masses differ much.
    pub(crate) fn refresh(&mut self, island: Island<F, D>, x: &[[f64; D]]) {
        island.bodies.iter().for_each(|&body| self.w[body] = [0.0; F]);
        self.push(island, x);
    }

    /// Takes impulses back into their cones, for changes leave their rounding in them, which is large for those that
    /// have become small; says how far the conditions are from being met then, m/s.
    pub(crate) fn conclude(&mut self, island: Island<F, D>, x: &mut [[f64; D]]) -> [f64; 2] {
        island.bodies.iter().for_each(|&body| self.w[body] = [0.0; F]);
        for (x, contact) in x.iter_mut().zip(island.contacts) {
            *x = into_cone(*x, contact.friction);
            contact.push(x, &mut self.w);
        }
        self.residuals(island, x)
    }

    /// How far the normal conditions and Coulomb's law of an island are from being met, m/s.
    pub(crate) fn residuals(&self, island: Island<F, D>, x: &[[f64; D]]) -> [f64; 2] {
        let one = |(contact, x): (&RigidContact<F, D>, _)| contact.residuals(x, &self.w);
        let worst = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a.max(c), b.max(d)];
        island.contacts.iter().zip(x).map(one).fold([0.0; 2], worst)
    }

    /// To which part impulses have to be shortened so that they give no energy, `x.u + 1/2 |w|^2 <= 0` with `u` the
    /// rates before; none where they give none.
    pub(crate) fn part_without_energy(
        &self,
        island: Island<F, D>,
        x: &[[f64; D]],
        bias: &[f64],
        members: &[usize],
    ) -> Option<f64> {
        let mut work = 0.0;
        for ((contact, x), &i) in island.contacts.iter().zip(x).zip(members) {
            work += (0..D).map(|k| x[k] * contact.offset[k]).sum::<f64>() - x[0] * bias[i];
        }
        let square = |&body: &usize| self.w[body].iter().map(|w| w * w).sum::<f64>();
        let square: f64 = island.bodies.iter().map(square).sum();
        let gives = work + 0.5 * square > ENERGY_ROUNDING * square;
        gives.then(|| (-2.0 * work / square).clamp(0.0, 1.0))
    }

    /// How far the conditions of each contact are from being met, m/s, in the place of what a sweep changed there; says
    /// the most of each kind.
    pub(crate) fn look_at(&mut self, island: Island<F, D>, x: &[[f64; D]]) -> [f64; 2] {
        let Sweeps { w, changes, .. } = self;
        changes.clear();
        let mut most = [0.0_f64; 2];
        changes.extend(island.contacts.iter().zip(x).map(|(contact, x)| {
            let [normal, coulomb] = contact.residuals(x, w);
            most = [most[0].max(normal), most[1].max(coulomb)];
            normal.max(coulomb)
        }));
        most
    }

    /// Shortens impulses to a part of them.
    pub(crate) fn shorten(&mut self, island: Island<F, D>, x: &mut [[f64; D]], part: f64) {
        x.iter_mut().flatten().for_each(|x| *x *= part);
        let w = &mut self.w;
        island.bodies.iter().for_each(|&body| w[body] = array(|f| part * w[body][f]));
    }

    /// Whether a sweep changed no velocity by more than this, and no contact is off by more than that.
    pub(crate) fn has_settled(
        &self,
        change: &Change,
        island: Island<F, D>,
        x: &[[f64; D]],
        [by, residual]: [f64; 2],
    ) -> bool {
        let met = || self.residuals(island, x).iter().all(|&left| left <= residual);
        change.fastest <= by && (residual == f64::INFINITY || met())
    }

    /// Sweeps over an island, and proximal steps where sweeps alone would take long, until it has
    /// settled, for at most as much work as `bound` sweeps; says how many contacts were relaxed, and
    /// how many sparse systems were solved.
    pub(crate) fn alternate(
        &mut self,
        island: Island<F, D>,
        x: &mut [[f64; D]],
        goal: Goal,
        bound: usize,
    ) -> [usize; 2] {
        let (mut solved, mut last) = (0, f64::INFINITY);
        // Sweeps to come without a step, and after the next step that does not help; whether the
        // last sweep came after a step.
        let (mut wait, mut patience, mut stepped) = (0, 1, false);
        for sweep in 1..=bound {
            let change = self.sweep(island, x);
            if sweep + SYSTEM_COST * solved >= bound
                || self.has_settled(&change, island, x, [goal.change, goal.residual])
            {
                return [sweep * x.len(), solved];
            }
            let energy = change.energy;
            if stepped && energy > MIN_REDUCTION * last {
                (wait, patience) = (patience, 2 * patience);
            }
            let soon = !stepped && goal.is_within(goal.alone, &change, last);
            last = energy;
            stepped = wait == 0 && !soon;
            if stepped {
                let soft = compliance(&change, island, x, MIN_COMPLIANCE);
                solved += self.proximal.step(island, soft, x, &mut self.w);
            } else if !soon {
                wait -= 1;
            }
        }
        [bound * x.len(), solved]
    }

    /// Lets the contacts of an island hold until no more than `least` is left, m/s, or it helps too little; what leaves
    /// more than before is taken back. Says how many sparse systems were solved.
    pub(crate) fn hold(&mut self, island: Island<F, D>, x: &mut [[f64; D]], least: f64) -> usize {
        let (mut left, mut solved) = (self.worst(island, x), 0);
        self.proximal.grip(x.len());
        for _ in 0..HOLDS {
            if left <= least {
                break;
            }
            self.before.clear();
            self.before.extend_from_slice(x);
            solved += self.proximal.hold(island, HOLDING_COMPLIANCE, x, &mut self.w);
            let now = self.keep_better(island, x, left);
            if now > HOLDING_REDUCTION * left || now.is_nan() {
                break;
            }
            left = now;
        }
        solved
    }

    /// Takes back impulses that leave more than those before have `left`, m/s; says what they left.
    fn keep_better(&mut self, island: Island<F, D>, x: &mut [[f64; D]], left: f64) -> f64 {
        let now = self.worst(island, x);
        if now > left || now.is_nan() {
            x.copy_from_slice(&self.before);
            self.refresh(island, x);
        }
        now
    }

    /// The larger of what is left of an island's conditions, m/s.
    fn worst(&self, island: Island<F, D>, x: &[[f64; D]]) -> f64 {
        let [normal, coulomb] = self.residuals(island, x);
        normal.max(coulomb)
    }

    /// Proximal steps for an island that nearly rests, until no more than `least` is left, m/s, or one helps too
    /// little; one that leaves more than before is taken back. Says how many contacts were relaxed, and how many
    /// sparse systems were solved.
    pub(crate) fn rest(
        &mut self,
        island: Island<F, D>,
        x: &mut [[f64; D]],
        least: f64,
    ) -> [usize; 2] {
        let [mut relaxed, mut solved] = [0; 2];
        let mut left = self.worst(island, x);
        for _ in 0..RESTING_STEPS {
            if left <= least {
                break;
            }
            self.before.clear();
            self.before.extend_from_slice(x);
            let change = self.sweep(island, x);
            let soft = compliance(&change, island, x, RESTING_COMPLIANCE);
            solved += self.proximal.step(island, soft, x, &mut self.w);
            self.sweep(island, x);
            relaxed += 2 * x.len();
            let now = self.keep_better(island, x, left);
            if now > RESTING_REDUCTION * left || now.is_nan() {
                break;
            }
            left = now;
        }
        [relaxed, solved]
    }

    /// Relaxes each contact once.
    pub(crate) fn sweep(&mut self, island: Island<F, D>, x: &mut [[f64; D]]) -> Change {
        let mut change = Change::NONE;
        for (contact, x) in island.contacts.iter().zip(x) {
            change.relax(contact, x, &mut self.w);
        }
        change
    }

    /// Relaxes each of these contacts once.
    pub(crate) fn sweep_of(
        &mut self,
        members: &[usize],
        island: Island<F, D>,
        x: &mut [[f64; D]],
    ) -> Change {
        let Sweeps { w, changes, .. } = self;
        let mut change = Change::NONE;
        changes.clear();
        let relax = |&i: &usize| change.relax(&island.contacts[i], &mut x[i], w);
        changes.extend(members.iter().map(relax));
        change
    }
}

impl Change {
    const NONE: Self = Change { fastest: 0.0, energy: 0.0 };

    /// Relaxes a contact; says what that changed there, m/s.
    #[inline]
    fn relax<const F: usize, const D: usize>(
        &mut self,
        contact: &RigidContact<F, D>,
        x: &mut [f64; D],
        w: &mut [[f64; F]],
    ) -> f64 {
        let change = contact.relax(x, w);
        let speed = contact.speed(&change);
        if speed > self.fastest {
            self.fastest = speed;
        }
        self.energy += contact.energy(&change);
        speed
    }
}

/// The energy of impulses, J.
fn energy_of<const F: usize, const D: usize>(island: Island<F, D>, x: &[[f64; D]]) -> f64 {
    island.contacts.iter().zip(x).map(|(contact, x)| contact.energy(x)).sum()
}

/// The compliance of a proximal step after a sweep that changed so much, no less than `least`, and the energy of
/// what is left.
fn compliance<const F: usize, const D: usize>(
    change: &Change,
    island: Island<F, D>,
    x: &[[f64; D]],
    least: f64,
) -> [f64; 2] {
    let part = (change.energy / energy_of(island, x)).sqrt();
    // Of no energy at all the part is no number: the least is then as good as any.
    [(COMPLIANCE_PER_CHANGE * part).max(least).min(MAX_COMPLIANCE), change.energy]
}
