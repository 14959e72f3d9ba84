//! The methods that a scene may name, before the scene is asked.

use stationary_choose::Kind;
use stationary_integrators::{Evaluation, FirstOrderFacts, Method};
use stationary_laplacian::HeatMethod;
use stationary_rigid::BodyMethod;

use super::declaration::Change;
use crate::model::scene::Scene;
use crate::model::stepping::{Adaptive, Constrained, FlightSteps, Stepping};

/// A method as a scene names it.
pub struct Candidate {
    /// Its word.
    pub name: &'static str,
    /// What its rungs differ in.
    pub kind: Kind,
    /// The power of the step in its error.
    pub order: u32,
    /// Differentials a step.
    pub stages: u64,
    /// Whether its steps solve equations.
    pub evaluation: Evaluation,
    /// The loosest tolerance that is not held as a tighter one.
    pub loosest: f64,
    /// Whether it solves by one factor, made before the first step.
    pub factors_once: bool,
    /// Whether rods are a part of its steps; others are projected back after each.
    pub holds_rods: bool,
}

impl Candidate {
    fn of(stepping: Stepping, kind: Kind, order: u32, stages: u64, evaluation: Evaluation) -> Self {
        let factors_once =
            matches!(stepping, Stepping::Heat(method) if method != HeatMethod::ExplicitEuler);
        let holds_rods = matches!(stepping, Stepping::Constrained(_));
        let name = stepping.name();
        let facts = FirstOrderFacts::all().into_iter().find(|facts| facts.name == name);
        let loosest = facts.map_or(1.0, |facts| facts.loosest);
        Candidate { name, kind, order, stages, evaluation, loosest, factors_once, holds_rods }
    }
}

/// Every method that may do for such a scene.
pub fn candidates(scene: &Scene) -> Vec<Candidate> {
    let modes = Stepping::LinearModes { count: 1 };
    let modes = Candidate::of(modes, Kind::Modes, 0, 1, Evaluation::Implicit);
    if scene.heat().is_some() {
        return heat().chain([modes]).collect();
    }
    let equal = Method::ALL.iter().map(|method| (Stepping::Equal(*method), method.facts()));
    let bodies = BodyMethod::ALL.iter().map(|method| (Stepping::Bodies(*method), method.facts()));
    let known = equal.chain(bodies).map(|(stepping, facts)| {
        let stages = facts.stages.into();
        Candidate::of(stepping, Kind::EqualSteps, facts.order, stages, facts.evaluation)
    });
    let own = [
        (Adaptive::DormandPrince853, 8, 15, Evaluation::Explicit),
        (Adaptive::DormandPrince54, 5, 6, Evaluation::Explicit),
        (Adaptive::RadauIia5, 5, 3, Evaluation::Implicit),
        (Adaptive::BackwardDifferences, 5, 3, Evaluation::Implicit),
    ];
    let own = own.map(|(method, order, stages, evaluation)| {
        let stepping = Stepping::Adaptive { method, tolerance: 0.1 };
        Candidate::of(stepping, Kind::Adaptive, order, stages, evaluation)
    });
    let held = [(Constrained::Rattle, 2), (Constrained::Hamilton, 1)];
    let held = held.map(|(method, order)| {
        let stepping = Stepping::Constrained(method);
        Candidate::of(stepping, Kind::EqualSteps, order, 1, Evaluation::Implicit)
    });
    // An iteration of it goes through the joints as a differential does, and it takes one or two.
    let joints = Stepping::JointCoordinates;
    let joints = Candidate::of(joints, Kind::EqualSteps, 2, 3, Evaluation::Explicit);
    // Flight of one and of five differentials; what rests or slides makes it a world of order 1.
    let flights = [(FlightSteps::Second, 2, 1), (FlightSteps::Fourth, 4, 5)];
    let flights = flights.map(|(flights, order, stages)| {
        let stepping = Stepping::EventDriven(flights);
        Candidate::of(stepping, Kind::EqualSteps, order, stages, Evaluation::Explicit)
    });
    // Of order 2 between impacts, three steps of a world each.
    let chosen = Stepping::ErrorControlled { tolerance: 0.1 };
    let chosen = Candidate::of(chosen, Kind::Adaptive, 2, 3, Evaluation::Explicit);
    let elastic = (!scene.solids().is_empty()).then_some(modes);
    let all = known.chain(own).chain(held).chain([joints, chosen]).chain(flights).chain(elastic);
    // Springs of touch have a kink where things meet: no order above two holds.
    let kink = scene.contact().is_some_and(|contact| contact.stiffness.is_some());
    all.filter(|candidate| !kink || candidate.name == Method::StormerVerlet.facts().name).collect()
}

/// The methods of heat. A solve with the one factor counts as a differential.
fn heat() -> impl Iterator<Item = Candidate> {
    HeatMethod::ALL.into_iter().map(|method| {
        let (order, stages) = match method {
            HeatMethod::ExplicitEuler => (1, 1),
            HeatMethod::ImplicitEuler => (1, 2),
            HeatMethod::CrankNicolson => (2, 2),
        };
        let stepping = Stepping::Heat(method);
        Candidate::of(stepping, Kind::EqualSteps, order, stages, Evaluation::Explicit)
    })
}

/// What a rung says otherwise than its model.
#[derive(Clone, Debug, PartialEq)]
pub struct Variation {
    /// What the model's text says otherwise.
    pub changes: Vec<Change>,
    /// What a Hessian with its factorization and its solves counts, in differentials.
    pub hessian_work: u64,
}
