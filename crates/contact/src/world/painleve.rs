//! Painleve's paradox: a contact that slides so that friction presses it into what it slides on.
//!
//! ```text
//! u_n. = ... + (W_nn - mu s.W_tn) lambda.,   s = u_t/|u_t|        while it slides
//! W_nn - mu s.W_tn <= 0                                        no finite force parts the bodies
//! mu < 2 sqrt(I_min/m)/rho, of both bodies                                  it cannot come to that
//! ```
//! `W` the compliance of the contact (1/kg), `u_t` how it slides before the step (m/s), `mu` its
//! friction; `m` a body's mass, `I_min` its least moment and `rho` the radius of its shapes. There
//! forces that obey Coulomb's law do not exist, or are not the only ones: whatever presses more rubs
//! more, and approaches more. What does exist is an impulse that stops the sliding: the body jams, and
//! the step gives it (an impact without a collision). It is in the cone and gains no energy, but no
//! law of forces says that it happens, so the report names it. The last line is the least of
//! `(1/m + a^2)/(a b)` with `a` and `b` the lever arms over the root of the moments, `b <= rho/sqrt
//! I_min`. Source: Painleve 1895; Genot and Brogliato 1999; Stewart 2000 for impulses in its place.

use crate::solve::body_state::BodyState;
use crate::{ContactIn, Dimension};

/// A contact in Painleve's paradox.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Painleve {
    /// Which of [`crate::World::touches`].
    pub contact: usize,
    /// How much an impulse that slides changes the normal velocity, 1/kg: zero or negative.
    pub compliance: f64,
}

/// Compliances along the normal that are this part of its own terms are zero.
const ROUNDING: f64 = 1e-12;
/// What slides slower than this part of how fast its bodies move there rests.
const STICKS: f64 = 1e-9;

/// The contact in the paradox whose compliance is least, among those that impulses press.
pub(crate) fn painleve<G: Dimension>(
    contacts: &[ContactIn<G>],
    presses: impl Fn(usize) -> bool,
    states: &[BodyState<G>],
    radius: impl Fn(usize) -> f64,
    v: &[f64],
) -> Option<Painleve> {
    let mut worst: Option<Painleve> = None;
    for (i, contact) in contacts.iter().enumerate() {
        let moving = contact.bodies.into_iter().flatten().filter(|&body| states[body].moves());
        let bound = moving.map(|body| least_friction(&states[body], radius(body)));
        if contact.friction < bound.fold(f64::INFINITY, f64::min) || !presses(i) {
            continue;
        }
        let still = STICKS * contact.speed(v);
        let Some(compliance) = sliding_compliance(contact, states, v, still) else { continue };
        if compliance <= 0.0 && worst.is_none_or(|worst| compliance < worst.compliance) {
            worst = Some(Painleve { contact: i, compliance });
        }
    }
    worst
}

/// The friction below which a body does not come to it.
fn least_friction<G: Dimension>(state: &BodyState<G>, radius: f64) -> f64 {
    let scale = state.scale.as_ref();
    let turns = scale[G::TRANSLATION..].iter().fold(0.0, |m: f64, scale| m.max(*scale));
    2.0 * scale[0] / (turns * radius)
}

/// `W_nn - mu s.W_tn`, zero where that is rounding; none of what does not slide.
fn sliding_compliance<G: Dimension>(
    contact: &ContactIn<G>,
    states: &[BodyState<G>],
    v: &[f64],
    still: f64,
) -> Option<f64> {
    // Rates and scaled rows along a direction.
    let along = |direction: &G::Vector| {
        let (mut rate, mut rows) = (0.0, [G::Velocity::default(); 2]);
        for (side, sign) in [(0, -1.0), (1, 1.0)] {
            let Some(body) = contact.bodies[side] else { continue };
            let state = &states[body];
            let arm = G::rotate(&state.frame, &contact.arms[side]);
            rows[side] = G::row(&state.frame, &arm, &(*direction * sign));
            let v = &v[G::FREEDOMS * body..][..G::FREEDOMS];
            rate += rows[side].as_ref().iter().zip(v).map(|(row, v)| row * v).sum::<f64>();
            let scale = state.scale.as_ref();
            rows[side].as_mut().iter_mut().zip(scale).for_each(|(row, scale)| *row *= scale);
        }
        (rate, rows)
    };
    let product = |a: &[G::Velocity; 2], b: &[G::Velocity; 2]| -> f64 {
        let sides = a.iter().zip(b);
        sides.flat_map(|(a, b)| a.as_ref().iter().zip(b.as_ref())).map(|(a, b)| a * b).sum()
    };
    let (_, normal) = along(&contact.normal);
    let (mut slip, mut coupled) = (0.0, 0.0);
    for tangent in contact.tangents() {
        let (rate, rows) = along(&tangent);
        slip += rate * rate;
        coupled += rate * product(&normal, &rows);
    }
    let slip = slip.sqrt();
    let own = product(&normal, &normal);
    let pressed = contact.friction * coupled / slip;
    let compliance = own - pressed;
    let rounded = if compliance.abs() <= ROUNDING * own { 0.0 } else { compliance };
    (slip > still).then_some(rounded)
}
