//! Few bodies: flight of order 2 or 4, impacts at their instant, lasting contact by the steps of a [`World`].
//!
//! ```text
//! flight until something is within the skin      F2 or F4, proved free until then       (flight.rs, free_time.rs)
//! dg v < -2 |dg k|  where it touches             impact, by the world's laws             v <- v+
//! dg v >  2 |dg k|  wherever it touches          it leaves: flight again
//! else                                           a step of the world, of r seconds or what is left
//! ```
//! `dg` differentials of gaps, `v` velocities, `k` the velocity increment by the forces in a contact step of `r` seconds.
//! Approach of the order of that increment is rest, as in a world: so a series of bounces that grow shorter ends
//! once they are shorter than about `4 r`, with an error of order `g r^2` in place. While anything rests or
//! slides the whole world takes steps of `r`, of order 1; all other errors are those of flight.
//!
//! Things touch at gaps of up to a skin, [`SKIN`] of the largest coordinate or radius: an instant is early by no
//! more than the skin over the speed of approach, and friction across it changes the angular momentum by up to the skin
//! times its impulse. What a flight's force does inside of it is bounded by its values at both ends (`flight.rs`).
//!
//! Each step may take [`EVENTS`] events; what has more of them, as many bodies that keep hitting each other, is
//! for a world's own steps. Forces beside the potential's act in flights and in contact steps, of which each ends at
//! their next corner; obstacles move as they are told. There are no joints. Source: notes 11.4 (at the instant);
//! Mirtich and Canny 1995 (flight between impacts found conservatively).

use stationary_calculus::{Metric, Potential, SizeError, Vector};
use stationary_constraints::VelocityRows;
use stationary_integrators::{Saved, State, StepError};

use crate::error::{check_finite, check_time};
use crate::impact::rounds::ImpactRounds;
use crate::impact::touching::Touching;
use crate::order::event::{Event, EventKind};
use crate::order::flight::{Flies, Flight, FlightOrder};
use crate::order::flight_forces::FlightForces;
use crate::order::free_time::FreeTimeSearch;
use crate::order::pieces::{Motion, Pieces, between};
use crate::{BodiesIn, ContactError, DetectorIn, Dimension, ImpactLaw, InverseMass, Touch, World};

/// Gaps up to this part of the largest coordinate or radius count as touching.
pub const SKIN: f64 = 1e-11;
/// The most events in a step.
pub const EVENTS: usize = 10_000;
/// The most contact steps in a step.
const CONTACT_STEPS: f64 = 1e6;
/// Velocities and increments below this part of the largest are rounding: what touches and is neither
/// pressed together nor approaches may go on in flight.
const STILL: f64 = 1e-9;
/// The name under which it is saved.
const NAME: &str = "event-driven";

/// What a step took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EventDrivenReport {
    /// Instants at which something hit.
    pub impacts: usize,
    /// Pieces of flight.
    pub flights: usize,
    /// Steps of the world, while contact lasted, and the time that they took, s: of order 1.
    pub contact_steps: usize,
    /// See [`EventDrivenReport::contact_steps`].
    pub contact_time: f64,
    /// Differentials of the potential.
    pub evaluations: usize,
    /// Detections of contact points, those of the world's steps counted once each.
    pub detections: usize,
    /// Pairs of colliders whose paths were looked at.
    pub queries: usize,
    /// Contacts relaxed and systems solved by the world's steps, and passes of the impact law.
    pub solves: usize,
    /// The kinetic energy that impacts took, those within contact steps too, J.
    pub impact_energy: f64,
    /// The work that obstacles did, J.
    pub work: f64,
    /// The energies that friction took in contact steps, and that lifting out of overlap gave, J: those of
    /// [`WorldReport`](crate::WorldReport).
    pub friction_energy: f64,
    /// See [`EventDrivenReport::friction_energy`].
    pub lifting_energy: f64,
    /// By how much contact steps missed their conditions at most, as
    /// [`WorldReport::residual`](crate::WorldReport::residual) and `coulomb` measure it.
    pub residual: f64,
    /// Whether all impacts and contact steps met their conditions.
    pub settled: bool,
}

/// Bodies whose impacts happen at their instant.
#[derive(Debug)]
pub struct EventDriven<G: Flies, P> {
    world: World<G, P>,
    mass: InverseMass,
    law: ImpactLaw,
    contact_step: f64,
    flight: Flight,
    search: FreeTimeSearch<G>,
    touching: Touching<G>,
    no_joints: VelocityRows,
    obstacles: Vec<usize>,
    /// Of each thing that acts, in the last step, in its last flight and in a contact step.
    works: Vec<f64>,
    flown: Vec<f64>,
    mean: Vector<Vec<f64>>,
    before: State<Vec<f64>>,
    /// What the world remembered before its first step of this one.
    saved: Saved,
    pieces: Pieces,
    events: Vec<Event>,
    /// What pushed in the last step, and when.
    pushes: Vec<(f64, Touch<G>)>,
    touches: bool,
    now: State<Vec<f64>>,
    next: State<Vec<f64>>,
    v: Vector<Vec<f64>>,
    increment: Vector<Vec<f64>>,
}

/// What to do next with what touches.
enum Choice {
    Fly,
    Again,
    Stay,
}

impl<G: Flies, P: Potential> EventDriven<G, P> {
    /// A system of bodies with these colliders, flight of this order, and contact steps of so many seconds;
    /// impacts by generalized reflections.
    ///
    /// # Errors
    /// Those of [`World::new`]; [`ContactError::Step`] for a contact step that is not positive and finite.
    pub fn new(
        system: BodiesIn<G, P>,
        detector: DetectorIn<G>,
        order: FlightOrder,
        contact_step: f64,
    ) -> Result<Self, ContactError> {
        if !(contact_step > 0.0 && contact_step.is_finite()) {
            return Err(StepError::Step(contact_step).into());
        }
        let n = system.dim();
        let mass = InverseMass::of(system.metric())?;
        let flight = Flight::new(order, n, detector.bodies());
        Ok(EventDriven {
            world: World::new(system, detector)?,
            mass,
            law: ImpactLaw::GeneralizedReflections,
            contact_step,
            flight,
            search: FreeTimeSearch::default(),
            touching: Touching::default(),
            no_joints: VelocityRows::default(),
            obstacles: Vec::new(),
            works: Vec::new(),
            flown: Vec::new(),
            mean: Vector(vec![0.0; n]),
            before: State::default(),
            saved: Saved::default(),
            pieces: Pieces::default(),
            events: Vec::new(),
            pushes: Vec::new(),
            touches: false,
            now: State::default(),
            next: State::default(),
            v: Vector(vec![0.0; n]),
            increment: Vector(vec![0.0; n]),
        })
    }

    /// The same with another impact law.
    pub fn with_law(self, law: ImpactLaw) -> Self {
        EventDriven { world: self.world.with_law(law), law, ..self }
    }

    /// The same with these bodies as moving obstacles, which nothing slows down.
    ///
    /// # Errors
    /// [`ContactError::Size`] where an obstacle is no body.
    pub fn with_obstacles(mut self, obstacles: Vec<usize>) -> Result<Self, ContactError> {
        self.world = self.world.with_obstacles(obstacles.clone())?;
        let f = G::FREEDOMS;
        self.mass = self.mass.holding(obstacles.iter().flat_map(|&body| f * body..f * body + f));
        self.obstacles = obstacles;
        Ok(self)
    }

    /// The system.
    pub fn system(&self) -> &BodiesIn<G, P> {
        self.world.system()
    }

    /// The world that steps while contact lasts.
    pub fn world(&mut self) -> &mut World<G, P> {
        &mut self.world
    }

    /// What happened in the last step that was taken, in the order of time.
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// The contacts of the last step that was taken with their impulses, in the order of time: at the instant of
    /// an impact, and at the end of each contact step, s.
    pub fn pushes(&self) -> &[(f64, Touch<G>)] {
        &self.pushes
    }

    /// The works of each thing that acts in the last step that was taken, J.
    pub fn works(&self) -> &[f64] {
        &self.works
    }

    /// The state at a time of the last step that was taken: of the order of its flights, and straight between
    /// the ends of contact steps. At an instant of impact the state after it.
    ///
    /// # Errors
    /// [`ContactError::Step`] for a time outside of that step; those of flight.
    pub fn state_at(&mut self, t: f64) -> Result<State<Vec<f64>>, ContactError> {
        self.state_under(t, &mut ())
    }

    /// The same of a step under these forces.
    ///
    /// # Errors
    /// Those of [`EventDriven::state_at`].
    pub fn state_under(
        &mut self,
        t: f64,
        forces: &mut impl FlightForces,
    ) -> Result<State<Vec<f64>>, ContactError> {
        let outside = StepError::Time(t);
        let piece = self.pieces.at(t).ok_or(outside)?;
        if piece.motion != Motion::Flight {
            return between::<G>(piece, t);
        }
        let start = piece.start;
        let mut state = State::default();
        let system = self.world.system();
        self.flight.fly::<G, P>(system, start, t - start.t, forces, &mut state)?;
        Ok(state)
    }

    /// Everything on which the next steps depend beside the state.
    pub fn save(&self) -> Saved {
        let mut numbers = vec![f64::from(u8::from(self.touches))];
        numbers.extend(self.world.save().numbers);
        Saved { method: NAME.to_owned(), numbers }
    }

    /// Takes over what the same method had saved.
    ///
    /// # Errors
    /// Those of [`World::load`].
    pub fn load(&mut self, saved: &Saved) -> Result<(), StepError> {
        if saved.method != NAME {
            return Err(StepError::Saved("it is another method's"));
        }
        let short = || StepError::Saved("it has fewer numbers than it says");
        let (&touches, numbers) = saved.numbers.split_first().ok_or_else(short)?;
        let mut own = self.world.save();
        own.numbers = numbers.to_vec();
        self.world.load(&own)?;
        self.touches = touches != 0.0;
        Ok(())
    }

    /// Moves a state by `h` seconds.
    ///
    /// # Errors
    /// [`ContactError::Step`] for `h`, also where it is more than a million contact steps;
    /// [`ContactError::TooManyImpacts`] for more than [`EVENTS`] events; [`ContactError::Size`] and
    /// [`ContactError::NonFinite`] for the state and for what comes out; those of [`World::step`] and of
    /// [`DetectorIn::detect`]. The state is then as it was.
    pub fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
    ) -> Result<EventDrivenReport, ContactError> {
        self.step_under(state, h, &mut ())
    }

    /// The same under forces beside those of the potential.
    ///
    /// # Errors
    /// Those of [`EventDriven::step`] and of [`World::step_under`].
    pub fn step_under(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        forces: &mut impl FlightForces,
    ) -> Result<EventDrivenReport, ContactError> {
        if !(h > 0.0 && h <= CONTACT_STEPS * self.contact_step) {
            return Err(StepError::Step(h).into());
        }
        let (n, bodies) = (self.system().dim(), self.system().dim() / G::FREEDOMS);
        SizeError::check("the momentum's components", n, state.p.0.len())?;
        SizeError::check("the poses' numbers", G::STORED * bodies, state.q.len())?;
        check_finite("the momentum", &state.p.0)?;
        check_time(state.t + h)?;
        let mut stepped = false;
        let touched = self.touches;
        self.now.clone_from(state);
        self.pieces.clear();
        self.events.clear();
        self.pushes.clear();
        self.flight.evaluations = 0;
        self.works.clear();
        self.works.resize(forces.works(), 0.0);
        forces.place(&mut self.now);
        match self.go(state.t + h, forces, &mut stepped) {
            Ok(report) => {
                self.pieces.finish(&self.now);
                state.clone_from(&self.now);
                Ok(report)
            }
            Err(error) => {
                self.pieces.clear();
                self.events.clear();
                self.pushes.clear();
                self.touches = touched;
                if stepped {
                    self.world.load(&self.saved)?;
                }
                Err(error)
            }
        }
    }

    /// Moves `now` to a time; says whether the world took a step, before which what it remembered is saved.
    fn go(
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
                let work = work_of_obstacles::<G>(&touch, &self.obstacles, &self.v.0);
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
        let fastest = |v: &Vector<Vec<f64>>| v.0.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        let still = STILL * fastest(&self.v);
        let pressed = STILL * fastest(&self.increment);
        let leaves = |i: usize| {
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

/// The work that obstacles, which do not turn, do by an impulse at velocities.
fn work_of_obstacles<G: Dimension>(touch: &Touch<G>, obstacles: &[usize], v: &[f64]) -> f64 {
    let whole = touch.contact.normal * (touch.impact + touch.normal) + touch.friction;
    let of_side = |(body, sign): (Option<usize>, f64)| {
        let body = body.filter(|body| obstacles.contains(body))?;
        let own = &v[G::FREEDOMS * body..][..G::TRANSLATION];
        Some(sign * own.iter().enumerate().map(|(k, v)| v * whole[k]).sum::<f64>())
    };
    touch.contact.bodies.into_iter().zip([1.0, -1.0]).filter_map(of_side).sum()
}
