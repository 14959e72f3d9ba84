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

mod next_event;

use stationary_calculus::{Potential, SizeError, Vector};
use stationary_constraints::VelocityRows;
use stationary_integrators::{Saved, State, StepError};

use crate::error::{check_finite, check_time};
use crate::impact::touching::Touching;
use crate::order::event::Event;
use crate::order::flight::{Flies, Flight, FlightOrder};
use crate::order::flight_forces::FlightForces;
use crate::order::free_time::FreeTimeSearch;
use crate::order::pieces::{Motion, Pieces, between};
use crate::world::check_forces;
use crate::{BodiesIn, ContactError, DetectorIn, ImpactLaw, InverseMass, Touch, World};

/// Gaps up to this part of the largest coordinate or radius count as touching.
pub const SKIN: f64 = 1e-11;
/// The most events in a step.
pub const EVENTS: usize = 10_000;
/// The most contact steps in a step.
const CONTACT_STEPS: f64 = 1e6;
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
        check_forces(n, forces)?;
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
}
