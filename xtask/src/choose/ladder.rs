//! The ladder of a scene: every way to run it that the scene allows, from coarse to fine.
//!
//! ```text
//! equal steps    h = T / (20 2^k)     k = 0, 1, ...     one family a method
//! own steps      tolerance = 10^-k    k = 1, ..., 12    read off at T/20, 2 T/20, ...
//! ```
//! `T` the horizon. All of it is data: a [`Rung`] is what to say otherwise in the scene's text, and
//! a [`Family`] is a row of rungs of one kind. Whether a scene allows a kind is asked of the scene
//! itself, by parsing. Rungs of other kinds (a contact law, a model of a body) are other changes.

use stationary_integrators::{Evaluation, Method};
use stationary_rigid::BodyMethod;
use stationary_scene::{Adaptive, Constrained, Scene, Stepping};

use super::ChooseError;
use super::declaration::{Change, changed, number};

/// Moments at which runs are compared, equally spaced over the horizon, the start left out.
pub const MOMENTS: u64 = 20;

/// Halvings of the coarsest step: at most this many, and at most so many steps.
const HALVINGS: u32 = 20;
const MOST_STEPS: u64 = 1 << 26;
/// Steps between two moments that a method of its own steps is expected to take.
const OWN: u64 = 2;
/// The tightest tolerance tried, as a power of a tenth.
const TIGHTEST: i32 = 12;

/// What a family's rungs differ in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Equal steps, halved from rung to rung.
    EqualSteps,
    /// Steps that the method chooses, to a tolerance that is a tenth from rung to rung.
    OwnSteps,
}

/// One way to run a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Rung {
    /// What the scene says otherwise.
    pub changes: Vec<Change>,
    /// The step or the tolerance.
    pub setting: f64,
    /// The work that it takes where every equation is solved at once.
    pub least_work: u64,
}

/// Rungs of one kind, from coarse to fine.
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    /// The method.
    pub name: &'static str,
    /// What its rungs differ in.
    pub kind: Kind,
    /// The power of the step in the error, of smooth motion without constraints.
    pub order: u32,
    /// Whether its steps solve equations.
    pub evaluation: Evaluation,
    /// Its rungs.
    pub rungs: Vec<Rung>,
}

/// Every way to run a scene.
#[derive(Clone, Debug)]
pub struct Ladder {
    /// The scene's name in errors.
    pub name: String,
    /// The scene's text, asked for one observable to one horizon.
    pub text: String,
    /// The families that the scene allows.
    pub families: Vec<Family>,
    /// The work of a Hessian, its factorization and its solves, in differentials.
    pub hessian_work: u64,
}

/// A method as a scene names it, before the scene is asked.
struct Candidate {
    name: &'static str,
    kind: Kind,
    order: u32,
    stages: u64,
    evaluation: Evaluation,
}

fn candidates() -> Vec<Candidate> {
    let equal = Method::ALL.iter().map(|method| method.facts());
    let bodies = BodyMethod::ALL.iter().map(|method| method.facts());
    let known = equal.chain(bodies).map(|facts| Candidate {
        name: facts.name,
        kind: Kind::EqualSteps,
        order: facts.order,
        stages: facts.stages.into(),
        evaluation: facts.evaluation,
    });
    let own = [
        (Adaptive::DormandPrince853, 8, 15, Evaluation::Explicit),
        (Adaptive::RadauIia5, 5, 3, Evaluation::Implicit),
        (Adaptive::BackwardDifferences, 5, 3, Evaluation::Implicit),
    ];
    let own = own.map(|(method, order, stages, evaluation)| Candidate {
        name: Stepping::Adaptive { method, tolerance: 0.1 }.name(),
        kind: Kind::OwnSteps,
        order,
        stages,
        evaluation,
    });
    let held = [(Constrained::Rattle, 2), (Constrained::Hamilton, 1)];
    let held = held.map(|(method, order)| Candidate {
        name: Stepping::Constrained(method).name(),
        kind: Kind::EqualSteps,
        order,
        stages: 1,
        evaluation: Evaluation::Implicit,
    });
    known.chain(own).chain(held).collect()
}

/// The way to hold rods that keeps its order.
const RATTLE: &str = "rattle";

impl Ladder {
    /// The ladder of a scene whose text asks for one observable.
    ///
    /// # Errors
    /// [`ChooseError::NoRung`] where the scene allows none.
    pub fn of(name: &str, text: &str, scene: &Scene) -> Result<Self, ChooseError> {
        let hessian_work = hessian_work(scene);
        let mut families = Vec::new();
        let mut refusal = String::new();
        for mut candidate in candidates() {
            if !scene.rods().is_empty() {
                // A step back to the rods is a solve, whatever went before, and has order 1.
                candidate.evaluation = Evaluation::Implicit;
                candidate.order = if candidate.name == RATTLE { 2 } else { 1 };
            }
            let rungs = rungs(&candidate, scene.timing().horizon(), hessian_work);
            match Scene::parse(name, &changed(text, &rungs[0].changes)) {
                Ok(_) => families.push(Family {
                    name: candidate.name,
                    kind: candidate.kind,
                    order: candidate.order,
                    evaluation: candidate.evaluation,
                    rungs,
                }),
                Err(error) => refusal = error.to_string(),
            }
        }
        if families.is_empty() {
            return Err(ChooseError::NoRung(refusal));
        }
        Ok(Ladder { name: name.to_owned(), text: text.to_owned(), families, hessian_work })
    }

    /// The scene's text on a rung.
    pub fn text(&self, rung: &Rung) -> String {
        changed(&self.text, &rung.changes)
    }
}

fn rungs(candidate: &Candidate, horizon: f64, hessian_work: u64) -> Vec<Rung> {
    let per_step = match candidate.evaluation {
        Evaluation::Explicit => candidate.stages,
        // Two solves find the state, and another that it was found.
        Evaluation::Implicit => 3 * (1 + hessian_work),
    };
    let method = Change::to("integrator", format!("\"{}\"", candidate.name));
    match candidate.kind {
        Kind::EqualSteps => (0..=HALVINGS)
            .map(|k| (1_u64 << k, MOMENTS << k))
            .take_while(|&(_, steps)| steps <= MOST_STEPS)
            .map(|(every, steps)| {
                let step = horizon / steps as f64;
                let changes = vec![
                    method.clone(),
                    Change::without("tolerance"),
                    Change::to("step", number(step)),
                    Change::to("sample_every", every.to_string()),
                ];
                Rung { changes, setting: step, least_work: per_step * steps }
            })
            .collect(),
        Kind::OwnSteps => (1..=TIGHTEST)
            .map(|k| {
                let tolerance = 10_f64.powi(-k);
                let changes = vec![
                    method.clone(),
                    Change::to("tolerance", format!("1e-{k}")),
                    Change::to("step", number(horizon / MOMENTS as f64)),
                    Change::to("sample_every", "1"),
                ];
                Rung { changes, setting: tolerance, least_work: OWN * per_step * MOMENTS }
            })
            .collect(),
    }
}

/// Freedoms up to which matrices are full.
const FEW: usize = 32;

/// What a Hessian with its factorization and its solves counts, in differentials: as many as there
/// are freedoms where it is full, as a difference quotient would; four times their root where it is
/// sparse, as the fill of a net's factor grows.
fn hessian_work(scene: &Scene) -> u64 {
    let n = scene.freedoms();
    if n <= FEW { n as u64 } else { (4.0 * (n as f64).sqrt()).round() as u64 }
}
