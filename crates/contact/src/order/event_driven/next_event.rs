//! From event to event: flight while nothing touches, an impact where something hits, else a contact step.
//!
//! The rules are those of the front page of `event_driven.rs`.

use stationary_calculus::{Metric, Potential};

use super::{EVENTS, EventDriven, EventDrivenReport, SKIN};
use crate::error::check_finite;
use crate::impact::rounds::ImpactRounds;
use crate::impact::touching::Touching;
use crate::order::event::{Event, EventKind};
use crate::order::flight::Flies;
use crate::order::flight_forces::FlightForces;
use crate::order::pieces::Motion;
use crate::{ContactError, Dimension, Touch};

/// Velocities and increments below this part of those of the bodies that touch are rounding: what touches and is
/// neither pressed together nor approaches may go on in flight.
const STILL: f64 = 1e-9;

/// What to do next with what touches.
enum Choice {
    Fly,
    Again,
    Stay,
}

impl<G: Flies, P: Potential> EventDriven<G, P> {
    /// Moves `now` to a time; says whether the world took a step, before which what it remembered is saved.
    pub(super) fn go(
        &mut self,
        end: f64,
        forces: &mut impl FlightForces,
        stepped: &mut bool,
    ) -> Result<EventDrivenReport, ContactError> {
        let start = self.now.t;
        let mut report = EventDrivenReport { settled: true, ..EventDrivenReport::default() };
        while self.now.t < end {
            if self.events.len() > EVENTS {
                return Err(ContactError::TooManyImpacts { bound: EVENTS, time: start });
            }
            let goal = forces.next_corner(self.now.t).map_or(end, |corner| corner.min(end));
            let choice = match self.touch(forces, &mut report)? {
                Choice::Fly => self.fly(goal, forces, &mut report)?,
                choice => choice,
            };
            if let Choice::Stay = choice {
                if !*stepped {
                    *stepped = true;
                    self.world.save_into(&mut self.saved);
                }
                self.contact_step(goal, forces, &mut report)?;
            }
        }
        self.now.t = end;
        report.evaluations = self.flight.evaluations;
        Ok(report)
    }

    /// Flies until something touches, at most to a time; stays where it touches at once.
    fn fly(
        &mut self,
        end: f64,
        forces: &mut impl FlightForces,
        report: &mut EventDrivenReport,
    ) -> Result<Choice, ContactError> {
        let (skin, left) = (self.skin(), end - self.now.t);
        let system = self.world.system();
        self.flight.fly::<G, P>(system, &self.now, left, forces, &mut self.next)?;
        self.next.t = end;
        keep_flown(forces, &mut self.flown);
        let (system, detector) = self.world.system_and_detector();
        let ends = [&self.now, &self.next];
        let flight = &mut self.flight;
        let free = self.search.free_time::<P>(flight, system, detector, ends, forces, skin)?;
        report.queries += free.queries;
        if free.touches {
            if free.time <= 0.0 || self.now.t + free.time <= self.now.t {
                return Ok(Choice::Stay);
            }
            let system = self.world.system();
            self.flight.fly::<G, P>(system, &self.now, free.time, forces, &mut self.next)?;
            keep_flown(forces, &mut self.flown);
        }
        self.works.iter_mut().zip(&self.flown).for_each(|(work, flown)| *work += flown);
        if self.touches {
            self.touches = false;
            self.note(EventKind::ContactEnds, [None; 2], 0.0);
        }
        report.flights += 1;
        self.pieces.push(&self.now, Motion::Flight);
        std::mem::swap(&mut self.now, &mut self.next);
        Ok(Choice::Again)
    }

    /// Gives what touches its impacts; says whether all that touches leaves.
    fn touch(
        &mut self,
        forces: &mut impl FlightForces,
        report: &mut EventDrivenReport,
    ) -> Result<Choice, ContactError> {
        let skin = self.skin();
        let contacts = self.world.detector().detect(&self.now.q, 2.0 * skin)?;
        report.detections += 1;
        if contacts.is_empty() {
            return Ok(Choice::Fly);
        }
        // What touches has no gap.
        self.touching.fill(contacts, &self.now.q, |_| 0.0);
        forces.prepare(&mut self.now, self.contact_step);
        forces.place(&mut self.now);
        let system = self.world.system();
        system.metric().sharp(self.now.p.view(), self.v.view_mut());
        self.flight.find_increment::<G, P>(
            system,
            (&self.now, &self.v),
            self.contact_step,
            (&*forces, &self.mass),
            &mut self.increment,
        );
        let Touching { contacts, rows, across, gap, friction, restitution } = &self.touching;
        let rounds = ImpactRounds {
            contacts,
            rows,
            across,
            gap,
            restitution,
            friction,
            mass: &self.mass,
            joints: &self.no_joints,
            law: self.law,
            increment: &self.increment,
            h: self.contact_step,
        };
        // Most instants of lasting contact hit nothing, and need no room for impulses.
        if rounds.hits(&self.v) {
            let given = rounds.apply(&mut self.v)?;
            report.impacts += 1;
            report.solves += given.passes;
            report.settled &= given.converged;
            report.residual = report.residual.max(given.left);
            check_finite("the velocity after an impact", &self.v.0)?;
            let before = system.metric().kinetic_energy(self.now.p.view());
            system.metric().flat(self.v.view(), self.now.p.view_mut());
            let mut energy = before - system.metric().kinetic_energy(self.now.p.view());
            for touch in self.touching.pushed(&given).filter(|_| !self.obstacles.is_empty()) {
                let work = work_of_obstacles::<G>(&touch, &self.obstacles, &self.now.q, &self.v.0);
                report.work += work;
                energy += work;
            }
            report.impact_energy += energy;
            let pushed = |&(_, a): &(usize, f64), &(_, b): &(usize, f64)| a.total_cmp(&b);
            let hardest = given.normal.iter().copied().enumerate().max_by(|a, b| pushed(a, b));
            let bodies = hardest.map_or([None; 2], |(i, _)| contacts[i].bodies);
            let time = self.now.t;
            self.events.push(Event { time, kind: EventKind::Impact, bodies, energy });
            self.pushes.extend(self.touching.pushed(&given).map(|touch| (time, touch)));
        }
        let leaves = |i: usize| {
            let still = STILL * contacts[i].speed(&self.v.0);
            let pressed = STILL * contacts[i].speed(&self.increment.0);
            let own = rows.along(i, self.v.view());
            let by_force = rows.along(i, self.increment.view());
            own > 2.0 * by_force.abs() || (own >= -still && by_force >= -pressed)
        };
        let all_leave = (0..contacts.len()).all(leaves);
        Ok(if all_leave { Choice::Fly } else { Choice::Stay })
    }

    /// One step of the world.
    fn contact_step(
        &mut self,
        end: f64,
        forces: &mut impl FlightForces,
        report: &mut EventDrivenReport,
    ) -> Result<(), ContactError> {
        if !self.touches {
            self.touches = true;
            self.note(EventKind::ContactStarts, [None; 2], 0.0);
        }
        self.pieces.push(&self.now, Motion::Straight);
        let left = end - self.now.t;
        // The last two steps share what is left: none is much shorter than the others.
        let h = match left / self.contact_step {
            steps if steps <= 1.0 => left,
            steps if steps < 2.0 => 0.5 * left,
            _ => self.contact_step,
        };
        forces.prepare(&mut self.now, h);
        self.before.clone_from(&self.now);
        let done = self.world.step_under(&mut self.now, h, &(), &*forces)?;
        if h == left {
            self.now.t = end;
        }
        if !self.works.is_empty() {
            let [before, after] = self.world.velocities();
            self.mean.copy_from(before);
            self.mean.add_scaled(1.0, after);
            self.mean.0.iter_mut().for_each(|v| *v *= 0.5);
            forces.add_works([&self.before, &self.now], self.mean.view(), &mut self.works);
        }
        forces.place(&mut self.now);
        report.contact_steps += 1;
        report.contact_time += h;
        report.detections += 1;
        report.impacts += usize::from(done.impacts > 0);
        report.impact_energy += done.impact_energy;
        report.work += done.work;
        report.friction_energy += done.friction_energy;
        report.lifting_energy += done.lifting_energy;
        let pushed = self.world.touches().map(|touch| (self.now.t, touch));
        self.pushes.extend(pushed);
        report.solves += done.relaxed + done.solved + done.projected + done.impacts;
        report.settled &= done.settled;
        report.residual = report.residual.max(done.residual).max(done.coulomb);
        Ok(())
    }

    fn note(&mut self, kind: EventKind, bodies: [Option<usize>; 2], energy: f64) {
        self.events.push(Event { time: self.now.t, kind, bodies, energy });
    }

    /// The gap up to which things touch, m.
    fn skin(&mut self) -> f64 {
        let bodies = self.system().dim() / G::FREEDOMS;
        let coordinates = (0..bodies).flat_map(|body| {
            self.now.q[G::STORED * body..][..G::TRANSLATION].iter().map(|x| x.abs())
        });
        let far = coordinates.fold(0.0, f64::max);
        let detector = self.world.detector();
        (0..bodies).map(|body| detector.radius_of(body)).fold(far, f64::max) * SKIN
    }
}

/// Keeps the works of the flight that was flown last.
fn keep_flown(forces: &impl FlightForces, flown: &mut Vec<f64>) {
    flown.clear();
    flown.resize(forces.works(), 0.0);
    forces.add_flown_works(flown);
}

/// The work that obstacles do by an impulse, at the velocities of where it acts on them.
fn work_of_obstacles<G: Dimension>(
    touch: &Touch<G>,
    obstacles: &[usize],
    q: &[f64],
    v: &[f64],
) -> f64 {
    let whole = touch.contact.normal * (touch.impact + touch.normal) + touch.friction;
    let of_side = |(side, sign): (usize, f64)| {
        let body = touch.contact.bodies[side].filter(|body| obstacles.contains(body))?;
        let (pose, mut velocity) = (G::pose(q, body), G::Velocity::default());
        velocity.as_mut().copy_from_slice(&v[G::FREEDOMS * body..][..G::FREEDOMS]);
        let (straight, turn) = G::split(&G::frame(&pose), &velocity);
        let arm = touch.contact.points[side] - G::translation(&pose);
        Some(sign * G::dot(&whole, &(straight + G::swing(&turn, &arm))))
    };
    [(0, 1.0), (1, -1.0)].into_iter().filter_map(of_side).sum()
}
