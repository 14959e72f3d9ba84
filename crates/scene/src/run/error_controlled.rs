//! Bodies that touch, in steps chosen by their error and read off at the scene's own.
//!
//! ```text
//! a = tol L                              the accuracy, m: L the scene's size
//! t_i .. t_i+k                           a stretch of k steps of the scene, which starts without memory
//! k' = 2 k, k, k/2                       with fewer than 32, up to 128 and more steps tried in it
//! ```
//! What is read between the ends of chosen steps is straight, within half of what these may be off. A stretch is
//! as long as what it keeps is little and as its first short steps do not count; a run goes on from its start,
//! so that nothing but the state is remembered. Where a stretch fails, a single step of the scene is tried.
//!
//! Joints, rods and motors are rows of each step, pins that move and touch obstacles, which the scene's states leave
//! out. Works and impulses of contacts are those of the chosen steps, each in the part of it that falls into a step of
//! the scene: what is left of the energy's budget is the error of the steps.

use std::borrow::Cow;

use stationary_calculus::{Covector, Force, Potential};
use stationary_contact::{
    BodiesIn, ColliderIn, ContactError, ErrorControlled, ErrorControlledReport, EventKind, Flies,
    World,
};
use stationary_integrators::{Horizon, Saved, State, StepError, StepReport};

use crate::assemble::body_system::{InSpace, InThePlane};
use crate::assemble::colliders::Colliders;
use crate::assemble::error::AssemblyError;
use crate::model::built::Built;
use crate::model::items::SceneContact;
use crate::model::scene::Scene;
use crate::model::stepping::ERROR_CONTROLLED;
use crate::run::checkpoint::{Before, CheckpointError};
use crate::run::contact_impulses::Push;
use crate::run::error::StepFailure;
use crate::run::given::Given;
use crate::run::joint_set::JointSet;
use crate::run::samples::{ChosenSteps, Impacts};
use crate::run::stepper::{Stepped, Stepper};
use crate::run::touching;

type Made<'a> = Result<Box<dyn Stepper + 'a>, AssemblyError>;

/// The works of bodies before those of what acts.
const WORKS: usize = 6;
/// Tried steps between which a stretch keeps its length.
const TRIED: [usize; 2] = [32, 128];
/// The most steps of the scene in a stretch.
const LONGEST: u64 = 1024;
/// The part of a step of the scene by which its end may be missed by rounding.
const ROUNDING: f64 = 1e-9;

/// Steps of bodies in space.
pub(crate) fn in_space<'a>(scene: &'a Scene, of: &'a InSpace, tolerance: f64) -> Made<'a> {
    match scene.with_obstacles() {
        Some(with) => {
            let of_all = with.in_space()?;
            spatial((scene, &of.initial), Cow::Owned(with), &of_all, tolerance)
        }
        None => spatial((scene, &of.initial), Cow::Borrowed(scene), of, tolerance),
    }
}

/// Steps of bodies in the plane.
pub(crate) fn in_the_plane<'a>(scene: &'a Scene, of: &'a InThePlane, tolerance: f64) -> Made<'a> {
    match scene.with_obstacles() {
        Some(with) => {
            let of_all = with.in_the_plane()?;
            planar((scene, &of.initial), Cow::Owned(with), &of_all, tolerance)
        }
        None => planar((scene, &of.initial), Cow::Borrowed(scene), of, tolerance),
    }
}

/// A scene with its obstacles, where it has any.
type With<'a> = Cow<'a, Scene>;

/// A scene's steps, made of the scene with its obstacles. A start that overlaps is refused as with other steps.
fn spatial<'a>(
    own: (&'a Scene, &State<Vec<f64>>),
    with: With<'a>,
    of: &InSpace,
    tolerance: f64,
) -> Made<'a> {
    let contact = own.0.contact.as_ref().ok_or(AssemblyError::Bodies)?;
    touching::detecting_in_space(&with, of)?;
    let (system, joints) = (of.system.clone(), touching::joints_in_space(&with, of)?);
    let shapes = with.colliders(contact)?;
    let parts = Parts::of(own.0, with, (move || system.clone(), shapes), tolerance)?;
    stepper(own, parts, joints)
}

fn planar<'a>(
    own: (&'a Scene, &State<Vec<f64>>),
    with: With<'a>,
    of: &InThePlane,
    tolerance: f64,
) -> Made<'a> {
    let contact = own.0.contact.as_ref().ok_or(AssemblyError::Bodies)?;
    touching::detecting_in_the_plane(&with, of)?;
    let (system, joints) = (of.system.clone(), touching::joints_in_the_plane(&with, of)?);
    let shapes = with.planar_colliders(contact)?;
    let parts = Parts::of(own.0, with, (move || system.clone(), shapes), tolerance)?;
    stepper(own, parts, joints)
}

fn stepper<'a, G: Flies + 'a, P: Potential + 'a>(
    (scene, initial): (&'a Scene, &State<Vec<f64>>),
    parts: Parts<'a, G, P>,
    joints: JointSet,
) -> Made<'a> {
    let (bodies, now) = (parts.start()?, initial.clone());
    Ok(Box::new(Chosen {
        parts,
        bodies,
        joints,
        forces: Vec::new(),
        rubs: scene.joints.iter().any(|joint| joint.friction > 0.0),
        holds: scene.has_joints(),
        steps: scene.timing.stepping(),
        stretch: Stretch { from: 0, length: 1, first: now.clone() },
        next: 1,
        to: 0,
        settled: true,
        seen: 0,
        pins: touching::RoundPins::of(scene),
        read: [now.t; 2],
        told: Vec::new(),
        works: Vec::new(),
        given: Given::of(scene),
        own: Vec::new(),
        ends: Vec::new(),
        states: Vec::new(),
        now,
    }))
}

/// What bodies are made of that remember nothing.
struct Parts<'a, G: Flies, P> {
    /// With obstacles.
    scene: With<'a>,
    contact: &'a SceneContact,
    system: Box<dyn Fn() -> BodiesIn<G, P> + 'a>,
    colliders: Vec<ColliderIn<G>>,
    obstacles: std::ops::Range<usize>,
    accuracy: f64,
}

impl<'a, G: Flies, P: Potential> Parts<'a, G, P> {
    fn of(
        own: &'a Scene,
        scene: With<'a>,
        (system, colliders): (impl Fn() -> BodiesIn<G, P> + 'a, Vec<ColliderIn<G>>),
        tolerance: f64,
    ) -> Result<Self, AssemblyError> {
        Ok(Parts {
            contact: own.contact.as_ref().ok_or(AssemblyError::Bodies)?,
            system: Box::new(system),
            colliders,
            obstacles: own.bodies.len()..scene.bodies.len(),
            accuracy: tolerance * own.scale(),
            scene,
        })
    }

    fn start(&self) -> Result<ErrorControlled<G, P>, ContactError> {
        let detector = self.scene.detector(&self.colliders, self.contact)?;
        let world = World::new((self.system)(), detector)?.with_law(touching::law(&self.scene));
        let world = world.with_obstacles(self.obstacles.clone().collect())?;
        // An error of velocity goes on until the end of the run.
        ErrorControlled::new(world, self.accuracy)?.with_horizon(self.scene.timing.horizon())
    }
}

/// Steps of the scene that are taken in one go.
struct Stretch {
    /// Steps before it, and in it.
    from: u64,
    length: u64,
    /// Where it starts.
    first: State<Vec<f64>>,
}

/// Bodies in steps that are chosen, read off.
struct Chosen<'a, G: Flies, P> {
    parts: Parts<'a, G, P>,
    bodies: ErrorControlled<G, P>,
    joints: JointSet,
    /// The forces of joints and the tensions of rods at the end of the last step, and whether joints rub and hold.
    forces: Vec<f64>,
    rubs: bool,
    holds: bool,
    steps: Horizon,
    /// The last stretch, and the steps of the scene in the next.
    stretch: Stretch,
    next: u64,
    /// Steps before its end, its end, and whether all of it is settled.
    to: u64,
    now: State<Vec<f64>>,
    settled: bool,
    /// Events of the stretch that were counted.
    seen: usize,
    given: Given,
    pins: touching::RoundPins,
    /// The interval of which works and impulses were told last.
    read: [f64; 2],
    /// Works as the bodies tell them.
    told: Vec<f64>,
    /// What acts, then friction, impacts, obstacles, lifting and joints, as [`Scene::works_of`] names them.
    works: Vec<f64>,
    /// Parts of the scene's steps at which states are kept, the end of the last step, and its states.
    own: Vec<f64>,
    ends: Vec<f64>,
    states: Vec<State<Vec<f64>>>,
}

impl<G: Flies, P: Potential> Chosen<'_, G, P> {
    /// Takes the next stretch.
    fn go_on(&mut self) -> Result<ErrorControlledReport, ContactError> {
        let (first, from) = (self.now.clone(), self.to);
        let mut length = self.next.min(self.steps.steps().saturating_sub(from)).max(1);
        let report = loop {
            let end = self.steps.time(from + length);
            self.bodies = self.parts.start()?;
            let Chosen { bodies, now, joints, given, .. } = self;
            given.obstacles().place(now, end - first.t);
            let taken = bodies.advance_with(now, end - first.t, &*joints, given);
            given.obstacles().leave_out(now);
            match taken {
                Ok(report) => {
                    self.now.t = end;
                    break report;
                }
                Err(_) if length > 1 => length = 1,
                Err(error) => return Err(error),
            }
        };
        (self.to, self.seen, self.settled) = (from + length, 0, report.settled);
        self.stretch = Stretch { from, length, first };
        self.next = match report.steps + report.rejected {
            tried if tried < TRIED[0] => (2 * length).min(LONGEST),
            tried if tried > TRIED[1] => (length / 2).max(1),
            _ => length,
        };
        Ok(report)
    }

    /// A time up to which rounding may move the end of a step.
    fn about(&self, t: f64) -> f64 {
        t + ROUNDING * self.steps.step()
    }

    /// The state at a time of the stretch.
    fn at(&self, t: f64) -> Result<State<Vec<f64>>, ContactError> {
        if self.about(t) >= self.now.t {
            return Ok(self.now.clone());
        }
        let mut state = self.bodies.state_at(t)?;
        self.given.obstacles().leave_out(&mut state);
        Ok(state)
    }

    /// Reads the works of the interval that is told next.
    fn read_works(&mut self, to: f64) {
        self.read = [self.read[1], to];
        let acting = self.given.works();
        self.told.clear();
        self.told.resize(WORKS + acting, 0.0);
        self.bodies.add_works(self.read.into(), &mut self.told);
        let (of_bodies, of_forces) = self.told.split_at(WORKS);
        let &[friction, impacts, obstacles, lifting, rubbing, joints] = of_bodies else { return };
        self.works.clear();
        self.works.extend(of_forces);
        self.works.extend([friction, impacts]);
        self.works.extend((!self.given.obstacles().is_empty()).then_some(obstacles));
        self.works.push(lifting);
        self.works.extend(self.rubs.then_some(rubbing));
        self.works.extend(self.holds.then_some(joints));
    }

    /// Keeps states within a step of the scene and at its end, where they are asked for.
    fn keep(&mut self, (from, to): (f64, f64)) -> Result<(), ContactError> {
        if self.own.is_empty() {
            return Ok(());
        }
        for &part in self.own.iter().chain(&[1.0]) {
            let t = if part < 1.0 { from + part * (to - from) } else { to };
            self.states.push(State { t, ..self.at(t)? });
        }
        Ok(())
    }
}

impl<G: Flies, P: Potential> Stepper for Chosen<'_, G, P> {
    fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        to: f64,
    ) -> Result<Stepped, StepFailure> {
        let (mut report, mut chosen) = (StepReport::default(), ChosenSteps::default());
        while self.now.t < to - ROUNDING * self.steps.step() {
            let taken = self.go_on()?;
            self.given.check_solved()?;
            report.differentials += taken.world_steps as u32;
            chosen.accepted += taken.steps as u64;
            chosen.rejected += taken.rejected as u64;
        }
        *state = State { t: to, ..self.at(to)? };
        self.bodies.joint_forces(to, &mut self.told);
        self.joints.forces(&self.told, 1.0, &mut self.forces);
        self.ends.clear();
        self.states.clear();
        if self.about(h) > self.steps.step() {
            self.ends.push(to);
            self.read_works(to);
            self.keep((to - h, to))?;
        }
        let last = self.about(to);
        let events = self.bodies.events().iter().skip(self.seen);
        let met = events.take_while(|event| event.time <= last);
        let (mut count, mut time) = (0, to);
        for event in met {
            self.seen += 1;
            if event.kind == EventKind::Impact {
                (count, time) = (count + 1, event.time.min(to));
            }
        }
        let impacts = (count > 0).then_some(Impacts { time, count });
        // How far conditions were missed is not told.
        let unsettled = (!self.settled).then_some(0.0);
        Ok(Stepped { impacts, unsettled, chosen, ..Stepped::done(report) })
    }

    fn reads_off(&self) -> bool {
        true
    }

    fn own_ends(&self) -> &[f64] {
        &self.ends
    }

    fn keep_own(&mut self, parts: &[f64]) {
        self.own = parts.to_vec();
    }

    fn own_states(&self) -> &[State<Vec<f64>>] {
        &self.states
    }

    fn works(&self) -> &[f64] {
        &self.works
    }

    fn multipliers(&self) -> &[f64] {
        &self.forces
    }

    fn pushes(&self, _: f64, see: &mut dyn FnMut(Push)) {
        let Parts { colliders, contact, .. } = &self.parts;
        let of = (Colliders::of(colliders, contact), &self.pins);
        self.bodies.show_touches(self.read.into(), &mut |time, touch| {
            see(touching::push(of, touch, time));
        });
    }

    /// Where the stretch starts: it is taken once more.
    fn save(&mut self) -> Saved {
        let Stretch { from, length, first } = &self.stretch;
        let mut numbers = vec![*from as f64, *length as f64, first.t];
        numbers.extend(first.q.iter().chain(first.p.components()));
        Saved { method: ERROR_CONTROLLED.to_owned(), numbers }
    }

    fn load(&mut self, before: &Before) -> Result<(), CheckpointError> {
        let Before { state, memory, .. } = before;
        let (q, p) = (state.q.len(), state.p.components().len());
        let [from, length, t, ref numbers @ ..] = memory.numbers[..] else {
            return Err(StepError::Saved("it has fewer numbers than it says").into());
        };
        if memory.method != ERROR_CONTROLLED || numbers.len() != q + p {
            return Err(StepError::Saved("it is another method's").into());
        }
        let whole = |x: f64| x >= 0.0 && x.fract() == 0.0;
        if !(whole(from) && whole(length) && from + length <= self.steps.steps() as f64) {
            return Err(StepError::Saved("its steps are none of the scene's").into());
        }
        let (q, p) = numbers.split_at(q);
        self.now = State { t, ..State::new(q.to_vec(), Covector(p.to_vec())) };
        (self.to, self.next) = (from as u64, length as u64);
        self.stretch = Stretch { from: self.to, length: self.next, first: self.now.clone() };
        if self.about(self.now.t) < state.t {
            self.go_on().map_err(AssemblyError::from)?;
        }
        self.read = [state.t; 2];
        let last = self.about(state.t);
        self.seen = self.bodies.events().iter().take_while(|event| event.time <= last).count();
        Ok(())
    }

    fn built(&self) -> Built {
        let Parts { colliders, contact, .. } = &self.parts;
        let colliders = Colliders::of(colliders, contact).count() as u64;
        let equations = self.joints.equations() as u64;
        Built { colliders, equations, ..Built::default() }
    }
}
