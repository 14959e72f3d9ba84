//! Bodies that touch, with impacts at their instant: flight in between, contact that lasts by steps of a world.
//!
//! The work of impacts is that of all impacts of a step, with their friction; the works of friction and of
//! lifting are those of contact steps. What is left of the energy's budget is the defect of flight, of order 2
//! or 4, and of order 1 while anything rests or slides.

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
use crate::run::samples::Impacts;
use crate::run::stepper::{Stepped, Stepper};
use crate::run::touching;

type Made<'a> = Result<Box<dyn Stepper + 'a>, AssemblyError>;

/// Steps of bodies in space.
pub(crate) fn in_space<'a>(scene: &Scene, of: &'a InSpace, flights: FlightSteps) -> Made<'a> {
    let detecting = touching::detecting_in_space(scene, of)?;
    stepper(scene, of.system.clone(), detecting, flights)
}

/// Steps of bodies in the plane.
pub(crate) fn in_the_plane<'a>(
    scene: &Scene,
    of: &'a InThePlane,
    flights: FlightSteps,
) -> Made<'a> {
    let detecting = touching::detecting_in_the_plane(scene, of)?;
    stepper(scene, of.system.clone(), detecting, flights)
}

fn stepper<'a, G: Flies + 'a, P: Potential + 'a>(
    scene: &Scene,
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
    let bodies = bodies.with_law(touching::law(scene));
    let pins = touching::RoundPins::of(scene);
    Ok(Box::new(Flying { bodies, colliders, pins, works: [0.0; 3] }))
}

/// Bodies between and at their impacts.
struct Flying<G: Flies, P> {
    bodies: EventDriven<G, P>,
    colliders: Colliders,
    pins: touching::RoundPins,
    /// Those of friction, impacts and lifting, as [`Scene::works_of`] names them.
    works: [f64; 3],
}

impl<G: Flies, P: Potential> Stepper for Flying<G, P> {
    fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        _: f64,
    ) -> Result<Stepped, StepFailure> {
        let met = self.bodies.step(state, h)?;
        self.works = [-met.friction_energy, -met.impact_energy, met.lifting_energy];
        let mut impacts = self.bodies.events().iter().filter(|e| e.kind == EventKind::Impact);
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
