//! Rolling and torsional friction: moments of contacts, bounded by lengths times the normal impulse.
//!
//! ```text
//! |tau_r| <= r lambda,   |tau_n| <= s lambda          across the normal and along it, N m s
//! min 1/2 |v - v_f - M^-1 (J^T x + W^T tau)|^2 over tau,   x kept       against w = W v
//! x from v_f + M^-1 W^T tau,   by turns
//! ```
//! `r s` lengths of a pair (m), `lambda` normal impulses (N s), `w` the spin of the second body as
//! seen from the first (rad/s), `x` impulses of contacts, `v_f` velocities before any. Small islands
//! are solved at once (`rolling_rows.rs`); these turns are for what has joints, and for large islands. They are
//! alternating minima of one energy, moments contact after contact. What rolls on one contact is held
//! by friction there, and gives way as if it turned about it: a turn takes what would stop that. Where
//! turns help no more the step is not settled; moments that would then give energy are dropped.
//!
//! Impacts with restitution carry no moments. Source: Leine and Glocker 2003 (the cones); staggered as
//! friction is.

use crate::solve::body_state::BodyState;
use crate::{ContactIn, DetectorIn, Dimension};

/// The most turns between moments and impulses, about contacts and then about centres alone.
const TURNS: usize = 30;
/// So many turns are to halve what is off: slower ones would not come to rounding in all that there are.
const HALVING_TURNS: usize = 8;
/// Sweeps over the moments in a turn.
const SWEEPS: usize = 10;
/// Friction within this part of its bound sticks.
const STICKS: f64 = 1.0 - 1e-9;

/// Energy gained that is rounding, relative to the terms of its sum.
const ENERGY_ROUNDING: f64 = 1e-11;

/// Turns between moments and impulses: about contacts, then about centres, each as long as they help.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turns {
    pub(crate) about_contacts: bool,
    taken: usize,
    /// The least that was off, m/s, and how many turns ago.
    least: f64,
    since: usize,
}

impl Default for Turns {
    fn default() -> Self {
        Turns { about_contacts: true, taken: 0, least: f64::INFINITY, since: 0 }
    }
}

impl Turns {
    /// Counts a turn by what is off after it, m/s; says whether it was the last.
    pub(crate) fn end_with(&mut self, off: f64) -> bool {
        self.taken += 1;
        self.since += 1;
        if off <= 0.5 * self.least {
            (self.least, self.since) = (off, 0);
        }
        if self.since < HALVING_TURNS && self.taken < TURNS {
            return false;
        }
        let last = !self.about_contacts;
        *self = Turns { about_contacts: false, ..Turns::default() };
        last
    }
}

/// What the moments of a step took, J.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Taken {
    /// At the mean of the velocities before and after.
    pub(crate) friction: f64,
    /// What obstacles did by them.
    pub(crate) work: f64,
    /// Whether the first is negative by more than rounding.
    pub(crate) gains: bool,
}

/// The moments of a step's contacts.
#[derive(Debug)]
pub(crate) struct ContactMoments<G: Dimension> {
    pub(crate) moments: Vec<Moment<G>>,
    /// Velocities as moments change them in a turn, and how many moments each body has.
    spun: Vec<f64>,
    shared: Vec<usize>,
}

impl<G: Dimension> Default for ContactMoments<G> {
    fn default() -> Self {
        ContactMoments { moments: Vec::new(), spun: Vec::new(), shared: Vec::new() }
    }
}

/// A contact that has moments.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment<G: Dimension> {
    pub(crate) contact: usize,
    /// Of rolling and of torsion, m.
    pub(crate) lengths: [f64; 2],
    /// Of rolling and of torsion, on the second body, world axes, N m s.
    pub(crate) now: [G::Spin; 2],
}

impl<G: Dimension> Moment<G> {
    /// What a part of a moment becomes that is to stop a spin, within its length times the normal impulse.
    fn fit(&self, part: usize, from: G::Spin, spin: &G::Spin, gives: f64, pushed: f64) -> G::Spin {
        let stop = if gives > 0.0 { *spin * -gives.recip() } else { *spin * 0.0 };
        let wanted = from + stop;
        let (bound, length) = (self.lengths[part] * pushed, G::spin_speed(&wanted));
        if length > bound { wanted * (bound / length) } else { wanted }
    }
}

impl<G: Dimension> ContactMoments<G> {
    /// Takes the contacts whose pairs have lengths; says whether there are any.
    pub(crate) fn start(&mut self, contacts: &[ContactIn<G>], detector: &DetectorIn<G>) -> bool {
        self.moments.clear();
        let none = [G::Spin::default(); 2];
        let with_lengths = contacts.iter().enumerate().filter_map(|(contact, point)| {
            let lengths = detector.rolling(point.id.pair())?;
            Some(Moment { contact, lengths, now: none })
        });
        self.moments.extend(with_lengths);
        !self.moments.is_empty()
    }

    /// Changes moments to what fits velocities and impulses.
    pub(crate) fn turn(
        &mut self,
        about_contacts: bool,
        contacts: &[ContactIn<G>],
        impulses: &[G::Vector],
        states: &[BodyState<G>],
        v: &[f64],
    ) {
        self.spun.clear();
        self.spun.extend_from_slice(v);
        self.shared.clear();
        self.shared.resize(states.len(), 0);
        for moment in &self.moments {
            sides(&contacts[moment.contact]).for_each(|(body, _)| self.shared[body] += 1);
        }
        for _ in 0..SWEEPS {
            for k in 0..self.moments.len() {
                let moment = self.moments[k];
                let Moment { contact, now, .. } = moment;
                let (point, impulse) = (&contacts[contact], &impulses[contact]);
                let pushed = G::dot(impulse, &point.normal).max(0.0);
                let across = *impulse - point.normal * pushed;
                let rubbed = G::dot(&across, &across).sqrt();
                let alone = sides(point).all(|(body, _)| self.shared[body] == 1);
                let sticks = rubbed < STICKS * point.friction * pushed;
                let about_contact = about_contacts && alone && sticks;
                let spins =
                    G::parts_of_spin(&relative_spin(point, states, &self.spun), &point.normal);
                let fit = [0, 1].map(|k| {
                    let gives = compliance(point, states, &spins[k], about_contact);
                    moment.fit(k, now[k], &spins[k], gives, pushed)
                });
                self.moments[k].now = fit;
                // A change about the contact is for the next turn: friction answers to it.
                let change = (fit[0] - now[0]) + (fit[1] - now[1]);
                if !about_contact {
                    turn_by(point, states, &change, &mut self.spun);
                }
            }
            if self.moments.len() == 1 {
                break;
            }
        }
    }

    /// How far moments are from what stops turning about the centres, or opposes it at their bounds, m/s.
    pub(crate) fn off(
        &self,
        contacts: &[ContactIn<G>],
        impulses: &[G::Vector],
        states: &[BodyState<G>],
        v: &[f64],
    ) -> f64 {
        let one = |moment: &Moment<G>| {
            let point = &contacts[moment.contact];
            let pushed = G::dot(&impulses[moment.contact], &point.normal).max(0.0);
            let spins = G::parts_of_spin(&relative_spin(point, states, v), &point.normal);
            let change = |k: usize| {
                let gives = compliance(point, states, &spins[k], false);
                let fit = moment.fit(k, moment.now[k], &spins[k], gives, pushed);
                reaction(point, states, &(fit - moment.now[k]), &spins[k])
            };
            change(0).max(change(1))
        };
        self.moments.iter().map(one).fold(0.0, f64::max)
    }

    /// Drops all moments.
    pub(crate) fn drop_all(&mut self) {
        self.moments.iter_mut().for_each(|moment| moment.now = [G::Spin::default(); 2]);
    }

    /// The moment of each contact in turn, N m s, and zeros without end behind the last that has one.
    pub(crate) fn of_each(&self) -> impl Iterator<Item = G::Spin> {
        let mut moments = self.moments.iter().peekable();
        (0..).map(move |contact| {
            let own = moments.next_if(|moment| moment.contact == contact);
            own.map_or_else(G::Spin::default, |moment| moment.now[0] + moment.now[1])
        })
    }

    /// Adds the changes of velocities that the moments make.
    pub(crate) fn add(&self, contacts: &[ContactIn<G>], states: &[BodyState<G>], v: &mut [f64]) {
        for Moment { contact, now, .. } in &self.moments {
            turn_by(&contacts[*contact], states, &(now[0] + now[1]), v);
        }
    }

    /// The energy that they take, from the velocities before and after the step's impulses.
    pub(crate) fn energy(
        &self,
        contacts: &[ContactIn<G>],
        states: &[BodyState<G>],
        [before, after]: [&[f64]; 2],
    ) -> Taken {
        let (mut taken, mut terms) = (Taken::default(), 0.0);
        for moment in &self.moments {
            let point = &contacts[moment.contact];
            let whole = moment.now[0] + moment.now[1];
            for spin in [before, after].map(|v| relative_spin(point, states, v)) {
                let term = -0.5 * G::along_spin(&whole, &spin);
                (taken.friction, terms) = (taken.friction + term, terms + term.abs());
            }
            for (body, sign) in sides(point).filter(|&(body, _)| !states[body].moves()) {
                let spin = spin_of(body, states, after);
                taken.work -= sign * G::along_spin(&whole, &spin);
            }
        }
        taken.gains = taken.friction < -ENERGY_ROUNDING * terms;
        taken
    }
}

/// The bodies of a contact, and with which sign they take its moments.
fn sides<G: Dimension>(point: &ContactIn<G>) -> impl Iterator<Item = (usize, f64)> {
    let signed = point.bodies.into_iter().zip([-1.0, 1.0]);
    signed.filter_map(|(body, sign)| Some((body?, sign)))
}

fn relative_spin<G: Dimension>(
    point: &ContactIn<G>,
    states: &[BodyState<G>],
    v: &[f64],
) -> G::Spin {
    let spin = |(body, sign)| spin_of(body, states, v) * sign;
    sides(point).map(spin).fold(G::Spin::default(), |sum, spin| sum + spin)
}

fn spin_of<G: Dimension>(body: usize, states: &[BodyState<G>], v: &[f64]) -> G::Spin {
    let mut stored = G::Velocity::default();
    stored.as_mut().copy_from_slice(&v[G::FREEDOMS * body..][..G::FREEDOMS]);
    G::split(&states[body].frame, &stored).1
}

/// Gives the bodies of a contact a moment.
fn turn_by<G: Dimension>(
    point: &ContactIn<G>,
    states: &[BodyState<G>],
    moment: &G::Spin,
    v: &mut [f64],
) {
    for (body, sign) in sides(point) {
        let state = &states[body];
        let turned = G::join(&state.frame, &G::Vector::default(), &(*moment * sign));
        let v = &mut v[G::FREEDOMS * body..][..G::FREEDOMS];
        let scaled = state.scale.as_ref().iter().zip(turned.as_ref());
        v.iter_mut().zip(scaled).for_each(|(v, (scale, turned))| *v += scale * scale * turned);
    }
}

/// How much a moment along a spin changes it, 1/(kg m^2): about the contact or about the centres; zero
/// of no spin.
fn compliance<G: Dimension>(
    point: &ContactIn<G>,
    states: &[BodyState<G>],
    spin: &G::Spin,
    about_contact: bool,
) -> f64 {
    let speed = G::spin_speed(spin);
    if speed == 0.0 {
        return 0.0;
    }
    let axis = *spin * speed.recip();
    let of = |body: usize, side: usize| {
        let state = &states[body];
        let own = turning::<G>(state, &axis);
        let arm = point.points[side] - state.centre;
        let swung = G::swing(&axis, &arm);
        let mass = state.scale.as_ref()[0].powi(-2);
        match about_contact && own > 0.0 {
            true => (own.recip() + mass * G::dot(&swung, &swung)).recip(),
            false => own,
        }
    };
    (0..2).filter_map(|side| Some(of(point.bodies[side]?, side))).sum()
}

/// How fast the contact point moves by what a moment changes of spins, as if it were along the present one, m/s.
fn reaction<G: Dimension>(
    point: &ContactIn<G>,
    states: &[BodyState<G>],
    moment: &G::Spin,
    spin: &G::Spin,
) -> f64 {
    let (length, speed) = (G::spin_speed(moment), G::spin_speed(spin));
    if length == 0.0 {
        return 0.0;
    }
    let axis = if speed > 0.0 { *spin * speed.recip() } else { *moment * length.recip() };
    let of = |body: usize, side: usize| {
        let arm = point.points[side] - states[body].centre;
        length * turning::<G>(&states[body], &axis) * G::dot(&arm, &arm).sqrt()
    };
    (0..2).filter_map(|side| Some(of(point.bodies[side]?, side))).sum()
}

/// How much a moment along an axis changes a body's spin about it.
fn turning<G: Dimension>(state: &BodyState<G>, axis: &G::Spin) -> f64 {
    let own = G::join(&state.frame, &G::Vector::default(), axis);
    let scaled = own.as_ref().iter().zip(state.scale.as_ref());
    scaled.map(|(axis, scale)| axis * axis * scale * scale).sum()
}
