//! Resting contact and friction: each island of bodies that hang together on its own.

use stationary_calculus::Potential;

use crate::solve::body_state::speed;
use crate::solve::exact_projection::FreeMotion;
use crate::solve::island_solver::{Conditions, IMPULSE_ROUNDING, SolvesIslands, Within};
use crate::solve::rolling_rows::Rolling;
use crate::world::memory::Memory;
use crate::world::resting::{CHANGE, Guessed};
use crate::world::tolerances::{CHANGE_IN_PILE, LARGE, REST_TOLERANCE, ROUNDING, Settled};
use crate::{ContactError, ContactIn, Dimension, World, WorldReport};

impl<G: Dimension, P: Potential> World<G, P> {
    /// Resting contact and friction in a step of `h` seconds, within limits.
    pub(super) fn rest(
        &mut self,
        contacts: &[ContactIn<G>],
        q: &[f64],
        (h, limits): (f64, Settled),
        report: &mut WorldReport,
    ) -> Result<(), ContactError> {
        let Settled { finest, enough, still, .. } = limits;
        let f = G::FREEDOMS;
        let Memory {
            v,
            increment,
            states,
            bias,
            impulses,
            islands,
            resting,
            solver,
            linked,
            with_joints,
            free,
            moments,
            rolling,
            ..
        } = &mut self.memory;
        for (state, v) in states.iter_mut().zip(v.0.chunks_exact(f)) {
            state.velocity.as_mut().copy_from_slice(v);
        }
        islands.find(
            states.len(),
            contacts
                .iter()
                .map(|contact| {
                    let moves = |&body: &usize| states[body].moves();
                    contact.bodies.map(|body| body.filter(moves).unwrap_or(states.len()))
                })
                .chain(linked.iter().copied()),
        );
        let radius = |body: usize| self.detector.radius_of(body);
        bias.clear();
        // What is not worth a change of velocity is closed; what overlaps is lifted afterwards.
        bias.extend(contacts.iter().map(|contact| {
            let bias = contact.gap.max(0.0) / h;
            if bias <= finest { 0.0 } else { bias }
        }));
        let guessed = Guessed { points: contacts, impulses, bias };
        resting.start(states, radius, &increment.0, guessed);
        solver.start(states.len());
        with_joints.clear();
        // Where nothing is asked for, no island of a pile gets the work of one that is alone.
        let pile = self.tolerance.is_none() && contacts.len() > LARGE;
        for (members, bodies) in islands.iter() {
            if has_joints(members, contacts.len()) {
                with_joints.extend(members.iter().filter(|&&i| i < contacts.len()));
                continue;
            }
            let guessed = Guessed { points: contacts, impulses, bias };
            let mut settled = if members.len() > LARGE { enough } else { finest };
            let mut reached = limits.reached(settled);
            let off = match resting.off(members, guessed, settled) {
                Some(off) => {
                    let change = bodies.iter().map(|&body| resting.change(body));
                    let change = change.fold(0.0, f64::max);
                    let stands = change <= CHANGE * settled.min(still);
                    // What is left of a velocity by rounding of what holds a body is none.
                    let rounding = IMPULSE_ROUNDING * resting.fastest_push(members, guessed);
                    let speed =
                        |&body: &usize| speed::<G>(resting.before(body).as_ref(), radius(body));
                    let fastest = bodies.iter().map(speed).fold(0.0, f64::max);
                    let still = stands && fastest <= rounding;
                    let none = G::Velocity::default();
                    for &body in bodies {
                        let velocity = match (still, stands) {
                            (true, _) => &none,
                            (false, true) => resting.before(body),
                            (false, false) => resting.after(body),
                        };
                        v.0[f * body..][..f].copy_from_slice(velocity.as_ref());
                    }
                    // What stands without any force needs no impulse to stand.
                    let forces = |body: &usize| &increment.0[f * body..][..f];
                    if stands && bodies.iter().flat_map(forces).all(|&gain| gain == 0.0) {
                        members.iter().for_each(|&i| impulses[i] = G::Vector::default());
                    }
                    // What is kept, though the impulses would change it, moves at most two against each other.
                    let kept = match (still, stands) {
                        (true, _) => change + fastest,
                        (false, true) => change,
                        (false, false) => 0.0,
                    };
                    off.map(|off| off + 2.0 * kept)
                }
                None => {
                    let gains =
                        |body: usize| speed::<G>(&increment.0[f * body..][..f], radius(body));
                    let slow = |&body: &usize| {
                        speed::<G>(resting.before(body).as_ref(), radius(body)) <= gains(body)
                    };
                    let slow = bodies.iter().all(slow);
                    let finest = REST_TOLERANCE * settled;
                    if pile {
                        let speed = |&body: &usize| speed::<G>(&v.0[f * body..][..f], radius(body));
                        let moving = limits.moving(bodies.iter().map(speed).fold(0.0, f64::max));
                        (settled, reached) = match slow {
                            true => (enough, limits.reached(enough)),
                            false => (CHANGE_IN_PILE * moving, moving),
                        };
                    }
                    let large = self.tolerance.is_none() && members.len() > LARGE;
                    // What is large comes to rest at once, if it can, or not at all.
                    let finest = if large { 0.0 } else { finest };
                    let fine = slow.then(|| {
                        let gain = bodies.iter().map(|&body| gains(body)).fold(0.0, f64::max);
                        finest.max(ROUNDING * gain)
                    });
                    let of = Rolling { contacts, bias, states, free: &free.0 };
                    let within = [settled, reached];
                    let own = &mut moments.moments;
                    let island = [members, bodies];
                    if let Some((left, systems)) =
                        rolling.solve(island, of, own, impulses, within, &mut v.0)
                    {
                        report.islands += 1;
                        report.solved += systems;
                        report.settled &= left.worst() <= reached;
                        report.residual = report.residual.max(left.normal);
                        report.coulomb = report.coulomb.max(left.friction);
                        continue;
                    }
                    let free = FreeMotion { points: contacts, q, v: &v.0, mass: &self.mass, bias };
                    let within = Within { settled, enough, still, reached, fine, of_pile: pile };
                    let conditions = Conditions { free, states, within };
                    let off = solver.solve([members, bodies], conditions, impulses, report)?;
                    if self.tolerance.is_none() {
                        // What impulses cancel in velocities leaves their rounding.
                        reached = reached.max(solver.rounding().min(limits.reached(enough)));
                    }
                    for &body in bodies {
                        let (state, change) = (&states[body], solver.change(body));
                        for (k, v) in v.0[f * body..][..f].iter_mut().enumerate() {
                            *v = state.velocity.as_ref()[k]
                                + state.scale.as_ref()[k] * change.as_ref()[k];
                        }
                    }
                    off
                }
            };
            report.islands += 1;
            report.settled &= off[0].max(off[1]) <= reached;
            report.residual = report.residual.max(off[0]);
            report.coulomb = report.coulomb.max(off[1]);
        }
        if self.memory.joints.rows() > 0 {
            self.rest_jointed(contacts, q, finest, report)?;
        }
        Ok(())
    }
}

/// Whether links of joints are among the members of an island, which come in ascending order.
pub(super) fn has_joints(members: &[usize], contacts: usize) -> bool {
    members.last().is_some_and(|&last| last >= contacts)
}
