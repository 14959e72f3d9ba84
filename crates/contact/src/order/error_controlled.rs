//! Steps of a [`World`] whose length is chosen by their error.
//!
//! ```text
//! s1 = S(h) s,   s2 = S(h/2) S(h/2) s,   accepted where off <= SHARE a
//! s+ = s2 + (s2 - s1)        smooth: nothing hits, and the same surfaces stick and slide in all three
//! s+ = s2                    elsewhere
//! ```
//!
//! | in the step | off |
//! | --- | --- |
//! | slip of the same surfaces starts, ends or turns | `max(|x1 - x2|, T |x~. - x.| + T |x2. - x~.|)` |
//! | a gap `g` hits, a limit of a joint does | `max(|x1 - x2|, (1 + c) g)` |
//! | all else | `|x1 - x2|` |
//! | any | `|x~ - (x0 + x2)/2|`, `x~` after half of the step: what is read in between is straight |
//! | any under forces that change in time | what their means leave out, see `swings.rs` |
//!
//! `S` a step of the world, with its own solution of contact and friction; `x` points of bodies (m) and `x.`
//! their velocities (m/s), `a` the accuracy that is asked for (m), `h` the step (s), `T` for how long an error of
//! velocity goes on (s, 1 unless said). Where slip ends both ways to step may agree on a velocity of zero and be
//! wrong by what the step changes of it; where a gap closes a world's velocity closes it in the step and
//! is stopped in the next, so that it says nothing yet. A world turns back what hits where the step starts, before
//! its gap is closed, however the step is divided after that. Steps of a world are of order 1, so that `off` is of order
//! `h^2` and the extrapolated step is of order 2; across an event all three are of order `h`, and a step across it is as
//! short as its share asks. A step that is off by more is tried again, shorter; state and time stay as they were.
//! The next length comes from `off`. Works and impulses of contacts are extrapolated as the step is (see `ledger.rs`),
//! so that the budget of energy closes to the steps' own defect.
//!
//! Joints are rows of each step of the world, as with [`World::step_with`]; in addition velocities at its end are those
//! that joints ask for there, so that the three steps differ by no more than their error, and what is extrapolated is
//! closed again. Limits count as surfaces that push, dry friction of joints as slip. A step ends where a speed that is
//! told jumps, and the next one counts as an event.
//!
//! The accuracy bounds what single steps add, not what motion makes of it: where neighbouring motions part fast (a
//! tumbling box, an edge on which a block may fall either way) the error at the end is that much larger.
//! Source: Hairer, Norsett and Wanner 1993, II.4 (step doubling, extrapolated); Kurtz and Castro 2025 (step
//! doubling with a convex contact solve).

mod accept;
mod attempt;

use stationary_calculus::{Covector, Potential, Vector};
use stationary_integrators::{State, StepError};

use self::attempt::Within;
use crate::error::check_time;
use crate::order::event::Event;
use crate::order::flight::Flies;
use crate::order::ledger::{Ledger, OF_CONTACT};
use crate::order::pieces::{Pieces, between};
use crate::order::pushing::Seen;
use crate::order::step_forces::StepForces;
use crate::order::swings::Swings;
use crate::{ContactError, JointRows, Touch, World};

/// The most steps in one call, rejected ones counted too.
pub const STEPS: usize = 1_000_000;
/// The part of the accuracy that a step may be off.
const SHARE: f64 = 0.1;
/// The first step, as a part of the time that is asked for.
const FIRST: f64 = 1e-2;
/// The shortest step, as a part of the time or of where it starts: rounding of both.
const SHORTEST: f64 = 1e-14;
/// By how much lengths change at most from a step to the next, and what is left below the length that
/// would just do.
const CHANGE: [f64; 2] = [0.1, 5.0];
const SAFETY: f64 = 0.9;
/// For how long an error of velocity goes on, s, where nothing is said.
const HORIZON: f64 = 1.0;
/// Roundings of a coordinate below which a difference of two steps means nothing.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

/// What a call took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorControlledReport {
    /// Steps taken.
    pub steps: usize,
    /// Steps tried and not taken.
    pub rejected: usize,
    /// Steps that were extrapolated.
    pub extrapolated: usize,
    /// Steps of the world: three for each that is tried.
    pub world_steps: usize,
    /// Contacts relaxed and systems solved in them, and passes of the impact law.
    pub solves: usize,
    /// The shortest and the longest step that was taken, s.
    pub shortest: f64,
    /// See [`ErrorControlledReport::shortest`].
    pub longest: f64,
    /// By how much single steps were off, summed, m: before extrapolation.
    pub off: f64,
    /// Whether all steps that were taken met their contact conditions.
    pub settled: bool,
}

/// A world, and the accuracy to which it steps.
#[derive(Debug)]
pub struct ErrorControlled<G: Flies, P> {
    world: World<G, P>,
    accuracy: f64,
    horizon: f64,
    /// The length that the last step suggests, s.
    length: Option<f64>,
    pieces: Pieces,
    events: Vec<Event>,
    ledger: Ledger<G>,
    /// The columns of the ledger before impulses of joints.
    acting: usize,
    /// What pushes in the last step that was taken, and whether there was one.
    last: Seen<G>,
    begun: bool,
    seen: [Seen<G>; 3],
    /// What the three steps of the one that is tried did, as the ledger has it, and what touched in the halves.
    works: [Vec<f64>; 3],
    touches: [Vec<Touch<G>>; 2],
    swings: Swings,
    mean: Vector<Vec<f64>>,
    difference: Covector<Vec<f64>>,
    /// What each half changes of velocities.
    rates: [Vector<Vec<f64>>; 2],
    now: State<Vec<f64>>,
    start: State<Vec<f64>>,
    whole: State<Vec<f64>>,
    halves: State<Vec<f64>>,
    /// After the first half.
    middle: State<Vec<f64>>,
}

impl<G: Flies, P: Potential> ErrorControlled<G, P> {
    /// A world, and how far (m) a body may be off by what its steps add.
    ///
    /// # Errors
    /// [`ContactError::Accuracy`] for one that is not positive and finite.
    pub fn new(world: World<G, P>, accuracy: f64) -> Result<Self, ContactError> {
        if !(accuracy > 0.0 && accuracy.is_finite()) {
            return Err(ContactError::Accuracy(accuracy));
        }
        let n = world.system().dim();
        Ok(ErrorControlled {
            difference: Covector(vec![0.0; n]),
            rates: [Vector(vec![0.0; n]), Vector(vec![0.0; n])],
            mean: Vector(vec![0.0; n]),
            swings: Swings::new(n),
            world,
            accuracy,
            horizon: HORIZON,
            length: None,
            pieces: Pieces::default(),
            events: Vec::new(),
            ledger: Ledger::default(),
            acting: OF_CONTACT,
            last: Seen::default(),
            begun: false,
            seen: Default::default(),
            works: Default::default(),
            touches: Default::default(),
            now: State::default(),
            start: State::default(),
            whole: State::default(),
            halves: State::default(),
            middle: State::default(),
        })
    }

    /// The same where an error of velocity goes on for so many seconds.
    ///
    /// # Errors
    /// [`ContactError::Step`] for a time that is negative or not finite.
    pub fn with_horizon(self, horizon: f64) -> Result<Self, ContactError> {
        match horizon >= 0.0 && horizon.is_finite() {
            true => Ok(ErrorControlled { horizon, ..self }),
            false => Err(StepError::Time(horizon).into()),
        }
    }

    /// The world.
    pub fn world(&mut self) -> &mut World<G, P> {
        &mut self.world
    }

    /// What happened in the last call, in the order of time: an impact and a change of contact are
    /// noted at the end of the step in which they were found.
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// Adds the works between two times of the last call, J: of friction, of impacts, of obstacles, of lifting out of
    /// overlap and closing joints, of dry friction of joints, of joints, then of each thing that acts. They change the
    /// energy by what the potential does not give, but for the steps' defect.
    pub fn add_works(&self, between: (f64, f64), works: &mut [f64]) {
        self.ledger.add_works(between, works);
    }

    /// Writes the forces along the equations of joints at a time of the last call, N or N m: one of their impulses each
    /// that are equalities, in their order, over the step.
    pub fn joint_forces(&self, t: f64, forces: &mut Vec<f64>) {
        self.ledger.rates(t, self.acting, forces);
    }

    /// Shows what touched between two times of the last call, with the part of its impulses that fell into them,
    /// and when the last of it did, s. Their sum is what contact changed momenta by.
    pub fn show_touches(&self, between: (f64, f64), see: &mut dyn FnMut(f64, &Touch<G>)) {
        self.ledger.show(between, see);
    }

    /// The state at a time of the last call: straight between steps, which adds no more than
    /// half of what these may be off.
    ///
    /// # Errors
    /// [`ContactError::Step`] for a time outside of it.
    pub fn state_at(&self, t: f64) -> Result<State<Vec<f64>>, ContactError> {
        between::<G>(self.pieces.at(t).ok_or(StepError::Time(t))?, t)
    }

    /// Moves a state by `duration` seconds, in as many steps as the accuracy asks.
    ///
    /// # Errors
    /// [`ContactError::Step`] for a duration that is not positive and finite; [`ContactError::Tolerance`] for an
    /// accuracy below the rounding of the coordinates;
    /// [`ContactError::StepTooShort`] where no step is short enough; [`ContactError::TooManySteps`] beyond
    /// [`STEPS`]; those of [`World::step`]. The state is then as it was.
    pub fn advance(
        &mut self,
        state: &mut State<Vec<f64>>,
        duration: f64,
    ) -> Result<ErrorControlledReport, ContactError> {
        self.advance_under(state, duration, &mut ())
    }

    /// The same under forces beside those of the potential.
    ///
    /// # Errors
    /// Those of [`ErrorControlled::advance`] and of [`World::step_under`].
    pub fn advance_under(
        &mut self,
        state: &mut State<Vec<f64>>,
        duration: f64,
        forces: &mut impl StepForces,
    ) -> Result<ErrorControlledReport, ContactError> {
        self.advance_with(state, duration, &(), forces)
    }

    /// The same with joints, whose rows are solved together with the contacts that they answer to.
    ///
    /// # Errors
    /// Those of [`ErrorControlled::advance_under`] and of [`World::step_with`].
    pub fn advance_with(
        &mut self,
        state: &mut State<Vec<f64>>,
        duration: f64,
        joints: &impl JointRows,
        forces: &mut impl StepForces,
    ) -> Result<ErrorControlledReport, ContactError> {
        if !(duration > 0.0 && duration.is_finite()) {
            return Err(StepError::Step(duration).into());
        }
        check_time(state.t + duration)?;
        // Turns are no lengths.
        let places = state.q.chunks(G::STORED).flat_map(|q| &q[..G::TRANSLATION.min(q.len())]);
        let far = places.fold(0.0, |m: f64, x| m.max(x.abs()));
        let detector = self.world.detector();
        let radii = (0..detector.bodies()).map(|body| detector.radius_of(body));
        let largest = radii.fold(far, f64::max);
        if SHARE * self.accuracy < ROUNDINGS * largest {
            return Err(ContactError::Tolerance(self.accuracy));
        }
        let (length, last, begun) = (self.length, self.last.clone(), self.begun);
        self.acting = OF_CONTACT + forces.works();
        self.pieces.clear();
        self.events.clear();
        self.ledger.clear();
        self.now.clone_from(state);
        match self.go(state.t + duration, duration, joints, forces) {
            Ok(report) => {
                self.pieces.finish(&self.now);
                state.clone_from(&self.now);
                Ok(report)
            }
            Err(error) => {
                self.pieces.clear();
                self.events.clear();
                self.ledger.clear();
                (self.length, self.last, self.begun) = (length, last, begun);
                Err(error)
            }
        }
    }

    fn go(
        &mut self,
        end: f64,
        duration: f64,
        joints: &impl JointRows,
        forces: &mut impl StepForces,
    ) -> Result<ErrorControlledReport, ContactError> {
        let mut report = ErrorControlledReport {
            shortest: f64::INFINITY,
            settled: true,
            ..ErrorControlledReport::default()
        };
        let share = SHARE * self.accuracy;
        let mut length = self.length.unwrap_or(FIRST * duration);
        while self.now.t < end {
            if report.steps + report.rejected >= STEPS {
                return Err(ContactError::TooManySteps { bound: STEPS, time: self.now.t });
            }
            let goal = forces.next_corner(self.now.t).map_or(end, |corner| corner.min(end));
            let left = goal - self.now.t;
            // No step is much shorter than its neighbours only because the end is near.
            let h = match left / length {
                steps if steps <= 1.0 => left,
                steps if steps < 2.0 => 0.5 * left,
                _ => length,
            };
            let tried = self.attempt(h, joints, forces, &mut report)?;
            let order = if tried.within == Within::Smooth { 2.0 } else { 1.0 };
            let fitting = SAFETY * (share / tried.off).powf(1.0 / order);
            length = h * fitting.clamp(CHANGE[0], CHANGE[1]);
            if tried.off > share {
                report.rejected += 1;
                if h <= SHORTEST * duration.max(self.now.t.abs()) {
                    let (time, off) = (self.now.t, tried.off);
                    return Err(ContactError::StepTooShort { time, step: h, off, share });
                }
                continue;
            }
            self.accept((h, goal), &tried, joints, &mut report)?;
        }
        self.length = Some(length);
        Ok(report)
    }
}
