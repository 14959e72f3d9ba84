//! Bodies that touch, with impacts at their instant: flight in between, contact that lasts by steps of a world.
//!
//! What acts gives kicks before and after each drift of a flight, and impulses over contact steps; pins that move and
//! touch are obstacles, which the scene's states leave out. The work of impacts is that of all impacts of a step, with
//! their friction; the works of friction and of lifting are those of contact steps. What is left of the energy's budget
//! is the defect of flight, of order 2 or 4, and of order 1 while anything rests or slides.

use stationary_calculus::Potential;
use stationary_contact::{BodiesIn, DetectorIn, EventDriven, EventKind, Flies, FlightOrder};
use stationary_integrators::{Saved, State, StepReport};

use crate::assemble::body_system::{InSpace, InThePlane};
use crate::assemble::colliders::Colliders;
use crate::assemble::error::AssemblyError;
use crate::model::built::Built;
use crate::model::scene::Scene;
use crate::model::stepping::{CONTACT_STEPS, FlightSteps};
use crate::run::checkpoint::{Before, CheckpointError};
use crate::run::contact_impulses::Push;
use crate::run::error::StepFailure;
use crate::run::given::Given;
use crate::run::samples::Impacts;
use crate::run::stepper::{Stepped, Stepper};
use crate::run::touching;

type Made<'a> = Result<Box<dyn Stepper + 'a>, AssemblyError>;

/// Steps of bodies in space.
pub(crate) fn in_space<'a>(scene: &Scene, of: &'a InSpace, flights: FlightSteps) -> Made<'a> {
    match scene.with_obstacles() {
        Some(with) => {
            let of = with.in_space()?;
            let detecting = touching::detecting_in_space(&with, &of)?;
            stepper((scene, &with), of.system.clone(), detecting, flights)
        }
        None => {
            let detecting = touching::detecting_in_space(scene, of)?;
            stepper((scene, scene), of.system.clone(), detecting, flights)
        }
    }
}

/// Steps of bodies in the plane.
pub(crate) fn in_the_plane<'a>(
    scene: &Scene,
    of: &'a InThePlane,
    flights: FlightSteps,
) -> Made<'a> {
    match scene.with_obstacles() {
        Some(with) => {
            let of = with.in_the_plane()?;
            let detecting = touching::detecting_in_the_plane(&with, &of)?;
            stepper((scene, &with), of.system.clone(), detecting, flights)
        }
        None => {
            let detecting = touching::detecting_in_the_plane(scene, of)?;
            stepper((scene, scene), of.system.clone(), detecting, flights)
        }
    }
}

/// A scene's steps, made of the scene with its obstacles.
fn stepper<'a, G: Flies + 'a, P: Potential + 'a>(
    (scene, with): (&Scene, &Scene),
    system: BodiesIn<G, P>,
    (detector, colliders): (DetectorIn<G>, Colliders),
    flights: FlightSteps,
) -> Made<'a> {
    let order = match flights {
        FlightSteps::Second => FlightOrder::Second,
        FlightSteps::Fourth => FlightOrder::Fourth,
    };
    let bodies =
        EventDriven::new(system, detector, order, scene.timing.step() / f64::from(CONTACT_STEPS))?;
    let obstacles = (scene.bodies.len()..with.bodies.len()).collect();
    let bodies = bodies.with_law(touching::law(scene)).with_obstacles(obstacles)?;
    let pins = touching::RoundPins::of(scene);
    let (given, with, works) = (Given::of(scene), State::default(), Vec::new());
    Ok(Box::new(Flying { bodies, colliders, pins, given, with, works }))
}

/// Bodies between and at their impacts.
struct Flying<G: Flies, P> {
    bodies: EventDriven<G, P>,
    colliders: Colliders,
    pins: touching::RoundPins,
    given: Given,
    /// The state with obstacles.
    with: State<Vec<f64>>,
    /// What acts, then friction, impacts, obstacles and lifting, as [`Scene::works_of`] names them.
    works: Vec<f64>,
}

impl<G: Flies, P: Potential> Stepper for Flying<G, P> {
    fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        _: f64,
    ) -> Result<Stepped, StepFailure> {
        let Flying { bodies, given, with, works, .. } = self;
        with.clone_from(state);
        given.obstacles().place_now(with);
        let met = bodies.step_under(with, h, given)?;
        given.check_solved()?;
        given.obstacles().leave_out(with);
        std::mem::swap(state, with);
        works.clear();
        works.extend(bodies.works());
        works.extend([-met.friction_energy, -met.impact_energy]);
        works.extend((!given.obstacles().is_empty()).then_some(met.work));
        works.push(met.lifting_energy);
        let mut impacts = bodies.events().iter().filter(|e| e.kind == EventKind::Impact);
        let last = impacts.next_back().map_or(state.t, |event| event.time);
        let differentials = (met.evaluations + met.contact_steps + met.impacts) as u32;
        let report = StepReport { differentials, ..StepReport::default() };
        let impacts = (met.impacts > 0).then_some(Impacts { time: last, count: met.impacts });
        let unsettled = (!met.settled).then_some(met.residual);
        let lasting = met.contact_time;
        Ok(Stepped { impacts, unsettled, lasting, ..Stepped::done(report) })
    }

    fn works(&self) -> &[f64] {
        &self.works
    }

    fn save(&mut self) -> Saved {
        self.bodies.save()
    }

    fn load(&mut self, before: &Before) -> Result<(), CheckpointError> {
        Ok(self.bodies.load(&before.memory)?)
    }

    fn pushes(&self, _: f64, see: &mut dyn FnMut(Push)) {
        let of = (self.colliders, &self.pins);
        for (time, touch) in self.bodies.pushes() {
            see(touching::push(of, touch, *time));
        }
    }

    fn built(&self) -> Built {
        Built { colliders: self.colliders.count() as u64, ..Built::default() }
    }
}
