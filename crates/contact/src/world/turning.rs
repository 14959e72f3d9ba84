//! What turns in a step onto features that nobody looked at.
//!
//! ```text
//! depth+ <= depth + turn + s sum h w + h r + overlap/2          a pair, m
//! turn = max(sum R (h w)^2,  1/2 (R_1 + R_2) |h w_2 - h w_1|^2)
//! ```
//! `R` the radii of the bodies, `w` their spins over the step, `s` how far they slide, `r` what is left of the
//! normal conditions: so far a gap that is linear over a step may err. Bodies that turn by a good part of a
//! radian may meet by other corners and edges than those that were near, and deeper. The step then says that
//! it is not settled: it is too long for what turns in it.

use stationary_calculus::Potential;
use stationary_rigid::LieGroup;

use crate::world::memory::Memory;
use crate::{ContactError, ContactIn, Dimension, World, WorldReport};

/// Pairs whose gaps err by less than this part of the smaller radius are not looked at again.
const TURNED: f64 = 1e-2;
/// What may be deeper than gaps err, as a part of the smaller radius.
const DEEPER: f64 = 5e-3;

impl<G: Dimension, P: Potential> World<G, P> {
    /// Whether a pair ends the step deeper in each other than linear gaps err.
    pub(super) fn turns_into(
        &mut self,
        h: f64,
        report: &WorldReport,
    ) -> Result<bool, ContactError> {
        let World { detector, kept, memory, .. } = self;
        let Memory { after, next, .. } = memory;
        for of_pair in kept.found().chunk_by(ContactIn::same_pair) {
            let ContactIn { bodies, id, .. } = of_pair[0];
            let moving = || bodies.into_iter().flatten();
            // What has no end errs by how far from its centre it touches.
            let arm = |side: usize| {
                let arms = of_pair.iter().map(|contact| contact.arms[side]);
                arms.map(|arm| G::dot(&arm, &arm).sqrt()).fold(0.0, f64::max)
            };
            let radius = |body: usize| match detector.reach_of(body) {
                f64::MAX => arm(usize::from(bodies[1] == Some(body))),
                radius => radius,
            };
            let smaller = detector.smaller_radius(bodies);
            let both: f64 = moving().map(radius).sum();
            let spin = |body: usize| h * G::spin_speed(&after[body].1);
            let spins: f64 = moving().map(spin).sum();
            let seen = bodies.into_iter().zip([-1.0, 1.0]).filter_map(|(b, sign)| Some((b?, sign)));
            let (mut slide, mut turn) = (G::Vector::default(), G::Spin::default());
            for (body, sign) in seen {
                slide = slide + after[body].0 * (sign * h);
                turn = turn + after[body].1 * (sign * h);
            }
            let own: f64 = moving().map(|body| radius(body) * spin(body).powi(2)).sum();
            let errs = own.max(0.5 * both * G::spin_speed(&turn).powi(2))
                + G::dot(&slide, &slide).sqrt() * spins;
            if errs < TURNED * smaller {
                continue;
            }
            let pose = |q: &[f64], side: usize| {
                bodies[side].map_or_else(G::Motion::identity, |body| G::pose(q, body))
            };
            let depth = |contacts: &[ContactIn<G>]| {
                contacts.iter().map(|contact| -contact.gap).fold(0.0, f64::max)
            };
            let before = depth(of_pair);
            let allowed = before + errs + h * report.residual + 0.5 * report.overlap;
            let relative = pose(&next.q, 0).inverse().compose(&pose(&next.q, 1));
            let (_, found) = detector.meet_alone(id.pair(), &relative, 0.0)?;
            if depth(found) > allowed + DEEPER * smaller {
                return Ok(true);
            }
        }
        Ok(false)
    }
}
