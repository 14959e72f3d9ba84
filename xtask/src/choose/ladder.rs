//! The ladder of a scene: every way to run it that the scene allows, from coarse to fine.
//!
//! ```text
//! equal steps    h = T / (20 2^k)     k = 0, 1, ...     one family a method and a model
//! own steps      tolerance = 10^-k    k = K, ..., 12    read off at T/320, 2 T/320, ...
//! modes          N = 2^k              k = 0, 1, ...     in closed form; of heat also all
//! ```
//! `T` the horizon, `10^-K` the loosest tolerance that the method does not hold as a tighter one: two
//! such would be one run, and each would seem to confirm the other. All of it is data: a [`Rung`] is what
//! to say otherwise in the text of a [`Model`], and a [`Family`] is a row of rungs of one kind. Whether a model allows a kind is
//! asked of the scene itself, by parsing.

use stationary_integrators::Evaluation;
use stationary_scene::Scene;

use super::ChooseError;
use super::candidate::{Candidate, candidates};
use super::declaration::{Change, changed, number};
use super::model::{Model, Sight};

/// Moments at which runs are compared in the search, equally spaced over the horizon, the start left
/// out. What is chosen is then compared over its whole way (`grid.rs`).
pub const MOMENTS: u64 = 20;

/// Samples from one moment to the next, of which scales are taken, where there are so many steps; of a
/// few things many more, by which runs are read off between them (`track.rs`).
const SAMPLES: u64 = 16;
const MOST_SAMPLES: u64 = 128;
/// Freedoms of all samples.
const MOST_NUMBERS: u64 = 1_000_000;

/// Halvings of the coarsest step: at most this many, and at most so many steps.
const HALVINGS: u32 = 20;
const MOST_STEPS: u64 = 1 << 26;
/// Steps between two moments that a method of its own steps is expected to take.
const OWN: u64 = 2;
/// The tightest tolerance tried, as a power of a tenth.
const TIGHTEST: i32 = 12;
/// Powers of ten are rounded.
const NEARLY: f64 = 1.01;
/// Doublings of the number of modes.
const DOUBLINGS: u32 = 8;
/// Factorizations that the search for modes takes at least, with that for rest, and its solves.
const FACTORIZATIONS: u64 = 5;
const SOLVES: u64 = 48;

/// What a family's rungs differ in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Equal steps, halved from rung to rung.
    EqualSteps,
    /// Steps that the method chooses, to a tolerance that is a tenth from rung to rung.
    OwnSteps,
    /// Modes, twice as many from rung to rung.
    Modes,
}

/// One way to run a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Rung {
    /// What the model's text says otherwise.
    pub changes: Vec<Change>,
    /// The step, the tolerance or the number of modes.
    pub setting: f64,
    /// The work that it takes where every equation is solved at once.
    pub least_work: u64,
    /// What a Hessian with its factorization and its solves counts, in differentials.
    pub hessian_work: u64,
}

/// Rungs of one kind, from coarse to fine.
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    /// The method, and the model where that is not the scene itself.
    pub name: String,
    /// The model, by its place in [`Ladder::models`].
    pub model: usize,
    /// What its rungs differ in.
    pub kind: Kind,
    /// The power of the step in the error, of smooth motion without constraints.
    pub order: u32,
    /// Whether its steps solve equations.
    pub evaluation: Evaluation,
    /// Whether rods are a part of its steps; others are projected back after each.
    pub holds_rods: bool,
    /// Whether its finest rung is the scene itself in closed form: all modes of heat.
    pub is_closed: bool,
    /// Its rungs.
    pub rungs: Vec<Rung>,
}

/// Every way to run a scene.
#[derive(Clone, Debug)]
pub struct Ladder {
    /// The scene's file, whose name stands in errors.
    pub name: String,
    /// The scene, asked for one observable to one horizon, and what can be made of it.
    pub models: Vec<Model>,
    /// The scene on finer meshes, which nobody asks for: they show its own mesh's error.
    pub finer: Vec<Model>,
    /// The families that the models allow.
    pub families: Vec<Family>,
}

/// The way to hold rods that keeps its order.
const RATTLE: &str = "rattle";

impl Ladder {
    /// The ladder of a scene whose text asks for one observable.
    ///
    /// # Errors
    /// [`ChooseError::NoRung`] where the scene allows none.
    pub fn of(name: &str, text: &str, scene: &Scene) -> Result<Self, ChooseError> {
        let models = Model::all(name, text, scene);
        let mut families = Vec::new();
        let mut refusal = String::new();
        for (place, model) in models.iter().enumerate() {
            for mut candidate in candidates(&model.scene) {
                if !scene.rods().is_empty() {
                    // A step back to the rods is a solve, whatever went before, and has order 1.
                    candidate.evaluation = Evaluation::Implicit;
                    candidate.order = if candidate.name == RATTLE { 2 } else { 1 };
                }
                let rungs = rungs(&candidate, model);
                match Scene::parse_at(name, &changed(&model.text, &rungs[0].changes)) {
                    Ok(_) => families.push(family(&candidate, place, model, rungs)),
                    Err(error) => refusal = error.to_string(),
                }
            }
        }
        if !families.iter().any(|family| family.model == 0 && family.kind != Kind::Modes) {
            return Err(ChooseError::NoRung(refusal));
        }
        let finer = Model::finer(name, &models[0]);
        Ok(Ladder { name: name.to_owned(), models, finer, families })
    }

    /// The model that a family runs.
    pub fn model(&self, family: &Family) -> &Model {
        &self.models[family.model]
    }

    /// The scene itself.
    pub fn written(&self) -> &Model {
        &self.models[0]
    }
}

impl Family {
    /// Whether its rungs come ever nearer to the scene itself.
    pub fn converges(&self) -> bool {
        self.model == 0 && (self.kind != Kind::Modes || self.is_closed)
    }

    /// The coarsest rung whose setting is at most this, else the finest.
    pub fn at_most(&self, setting: f64) -> usize {
        let fine = self.rungs.iter().position(|rung| rung.setting <= NEARLY * setting);
        fine.unwrap_or(self.rungs.len() - 1)
    }
}

fn family(candidate: &Candidate, place: usize, model: &Model, rungs: Vec<Rung>) -> Family {
    let name = match &model.sight {
        Sight::AsWritten => candidate.name.to_owned(),
        _ => format!("{} {}", candidate.name, model.words),
    };
    let Candidate { kind, order, evaluation, holds_rods, .. } = *candidate;
    let all = all_modes(&model.scene).map(|all| all as f64);
    let is_closed = kind == Kind::Modes && all == rungs.last().map(|rung| rung.setting);
    Family { name, model: place, kind, order, evaluation, holds_rods, is_closed, rungs }
}

fn rungs(candidate: &Candidate, model: &Model) -> Vec<Rung> {
    let (scene, pieces) = (&model.scene, model.pieces);
    let horizon = scene.timing().horizon();
    let hessian = match candidate.kind {
        // Their matrices are full.
        Kind::OwnSteps => scene.freedoms() as u64,
        Kind::EqualSteps | Kind::Modes => model.hessian_work(),
    };
    let per_step = match candidate.evaluation {
        Evaluation::Explicit => candidate.stages,
        // One solve, from a first guess, and a look that it found the state.
        Evaluation::Implicit => candidate.stages.max(1) + 1 + hessian,
    };
    let method = Change::to("integrator", format!("\"{}\"", candidate.name));
    let rung = |setting: f64, says: [(&'static str, Option<String>); 4], least_work: u64| {
        let says = says.map(|(key, value)| Change { key, value });
        let changes = [method.clone()].into_iter().chain(says).collect();
        Rung { changes, setting, least_work: pieces * least_work, hessian_work: hessian }
    };
    let moment = number(horizon / (MOMENTS * SAMPLES) as f64);
    match candidate.kind {
        Kind::EqualSteps => (0..=HALVINGS)
            .map(|k| (1_u64 << k, MOMENTS << k))
            .take_while(|&(_, steps)| steps <= MOST_STEPS)
            .map(|(every, steps)| {
                let step = horizon / steps as f64;
                let says = [
                    ("tolerance", None),
                    ("modes", None),
                    ("step", Some(number(step))),
                    ("sample_every", Some((every / samples(scene)).max(1).to_string())),
                ];
                let ahead = if candidate.factors_once { hessian } else { 0 };
                rung(step, says, ahead + per_step * steps)
            })
            .collect(),
        Kind::OwnSteps => (1..=TIGHTEST)
            .filter(|k| 10_f64.powi(-k) <= NEARLY * candidate.loosest)
            .map(|k| {
                let says = [
                    ("tolerance", Some(format!("1e-{k}"))),
                    ("modes", None),
                    ("step", Some(moment.clone())),
                    ("sample_every", Some("1".to_owned())),
                ];
                rung(10_f64.powi(-k), says, OWN * per_step * MOMENTS)
            })
            .collect(),
        Kind::Modes => (0..=DOUBLINGS)
            .map(|k| 1_u64 << k)
            .take_while(|&modes| modes == 1 || modes < scene.freedoms() as u64)
            .filter(|&modes| all_modes(scene).is_none_or(|all| modes < all))
            .chain(all_modes(scene))
            .map(|modes| {
                let says = [
                    ("tolerance", None),
                    ("modes", Some(modes.to_string())),
                    ("step", Some(moment.clone())),
                    ("sample_every", Some("1".to_owned())),
                ];
                rung(modes as f64, says, FACTORIZATIONS * hessian + SOLVES + 2 * modes)
            })
            .collect(),
    }
}

/// Samples from one moment to the next: a power of two.
fn samples(scene: &Scene) -> u64 {
    let room = MOST_NUMBERS / (MOMENTS * scene.freedoms().max(1) as u64);
    let power = 1_u64 << room.max(1).ilog2();
    power.clamp(SAMPLES, MOST_SAMPLES)
}

/// The number of all modes of a heated body, where they are few enough to be found: besides the
/// constant one where nothing is held.
fn all_modes(scene: &Scene) -> Option<u64> {
    let constant = scene.heat()?.held.iter().all(|held| !held);
    let all = scene.freedoms() as u64 - u64::from(constant);
    (1..=1 << DOUBLINGS).contains(&all).then_some(all)
}

/// Freedoms up to which matrices are full.
const FEW: usize = 32;

impl Model {
    /// What a Hessian with its factorization and its solves counts, in differentials: as many as
    /// there are freedoms where it is full, as a difference quotient would; four times their root
    /// where it is sparse, as the fill of a net's factor grows.
    pub fn hessian_work(&self) -> u64 {
        let n = self.scene.freedoms();
        if n <= FEW { n as u64 } else { (4.0 * (n as f64).sqrt()).round() as u64 }
    }
}
