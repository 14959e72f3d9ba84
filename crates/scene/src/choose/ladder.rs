//! The ladder of a scene: every way to run it that the scene allows, from coarse to fine.
//!
//! A setting is what to say otherwise in the text of a [`Model`]. Whether a model allows a kind is asked of
//! the scene itself, by parsing. Modes of heat are all of them where these are few.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::time::Instant;

use stationary_choose::{
    At, Experiment, Family, Finer, Kind, Ladder, Look, MOMENTS, Moments, Record, SAMPLES, Setting,
    Watch, adaptive_steps, equal_steps, numbers_of_steps, powers, samples, work_of_step,
};
use stationary_elasticity::Strain;
use stationary_integrators::Evaluation;

use super::candidate::{Candidate, Variation, candidates};
use super::declaration::{Change, changed, number};
use super::model::{Model, Simplification, moved};
use super::observable::{in_words, scale};
use super::{ChooseError, look, run};
use crate::model::items::Link;
use crate::model::scene::Scene;
use crate::model::stepping::{CONTACT_STEPS, EVENT_DRIVEN, Stepping};

/// Doublings of the number of modes.
const DOUBLINGS: u32 = 8;
/// Factorizations that the search for modes takes at least, with that for rest, and its solves.
const FACTORIZATIONS: u64 = 5;
const SOLVES: u64 = 48;

/// Every way to run a scene.
#[derive(Clone, Debug)]
pub struct SceneLadder {
    /// The scene's file, whose name stands in errors.
    name: String,
    /// The scene, asked for one observable to one horizon, and what can be made of it.
    models: Vec<Model>,
    /// The scene on finer meshes.
    finer: Vec<Model>,
    /// What each rung of each family says.
    settings: Vec<Vec<Variation>>,
    ladder: Ladder,
    /// Runs of equal steps that can be looked at again.
    kept: RefCell<BTreeMap<At, run::Kept>>,
}

/// The way to hold rods that keeps its order.
const RATTLE: &str = "rattle";

impl SceneLadder {
    /// The ladder of a scene whose text asks for one observable.
    ///
    /// # Errors
    /// [`ChooseError::NoSetting`] where the scene allows none.
    pub fn of(name: &str, text: &str, scene: &Scene) -> Result<Self, ChooseError> {
        let models = Model::all(name, text, scene);
        let (mut families, mut settings) = (Vec::new(), Vec::new());
        let mut refusal = String::new();
        for (place, model) in models.iter().enumerate() {
            let lasts = model.scene.contact().is_some() && contact_lasts(name, model);
            for mut candidate in candidates(&model.scene) {
                // While something rests or slides these take a world's own steps, of order 1, and many of them.
                if lasts && EVENT_DRIVEN.iter().any(|(word, _)| *word == candidate.name) {
                    continue;
                }
                if !model.scene.rods().is_empty() && model.scene.bodies().is_empty() {
                    // A step back to the rods is a solve, whatever went before, and has order 1.
                    candidate.evaluation = Evaluation::Implicit;
                    candidate.order = if candidate.name == RATTLE { 2 } else { 1 };
                }
                let (rungs, says) = rungs(&candidate, model);
                match Scene::parse_at(name, &changed(&model.text, &says[0].changes)) {
                    Ok(_) => {
                        families.push(family(&candidate, place, model, rungs));
                        settings.push(says);
                    }
                    Err(error) => refusal = error.to_string(),
                }
            }
        }
        if !families.iter().any(|family| family.model == 0 && family.kind != Kind::Modes) {
            return Err(ChooseError::NoSetting(refusal));
        }
        let finer = Model::finer(name, &models[0]);
        let own = scene.stepping().name();
        let asks = families.iter().position(|family| {
            family.converges() && family.kind == Kind::Adaptive && family.name == own
        });
        let pieces = models[0].pieces as f64;
        let ladder = Ladder {
            title: scene.title().to_owned(),
            observable: in_words(scene),
            scale: scale(scene),
            horizon: scene.timing().horizon(),
            time: scene.units().time.clone(),
            keeps_energy: keeps_energy(scene),
            is_smooth: is_smooth(name, &models[0]),
            is_joined: scene.heat().is_some() || breaks(scene),
            placed: placed(scene, &models[0]),
            is_constrained: !scene.rods().is_empty(),
            asks,
            families,
            finer: finer
                .iter()
                .map(|model| Finer {
                    words: model.words.clone(),
                    work: model.pieces as f64 / pieces,
                })
                .collect(),
        };
        let kept = RefCell::default();
        Ok(SceneLadder { name: name.to_owned(), models, finer, settings, ladder, kept })
    }

    /// What can be made of the scene, itself first.
    pub fn models(&self) -> &[Model] {
        &self.models
    }

    /// The model that a rung runs.
    pub fn model(&self, at: At) -> &Model {
        &self.models[self.ladder.families[at.family].model]
    }

    /// What a rung says.
    pub fn setting(&self, at: At) -> &Variation {
        &self.settings[at.family][at.rung]
    }

    /// The text of a rung: its model's, with what it says otherwise.
    pub fn text(&self, at: At) -> String {
        changed(&self.model(at).text, &self.setting(at).changes)
    }

    /// The scene itself.
    pub fn written(&self) -> &Model {
        &self.models[0]
    }
}

impl Experiment for SceneLadder {
    fn ladder(&self) -> &Ladder {
        &self.ladder
    }

    fn run(&self, at: At, finer: Option<usize>, watch: &mut Watch<'_>) -> Record {
        let model = finer.and_then(|finer| self.finer.get(finer)).unwrap_or_else(|| self.model(at));
        let kind = self.ladder.families[at.family].kind;
        let (record, kept) = run::run(&self.name, model, (kind, self.setting(at)), watch);
        if let Some(kept) = kept.filter(|_| finer.is_none()) {
            self.kept.borrow_mut().insert(at, kept);
        }
        record
    }

    fn look(&self, at: At, moments: &Moments, deadline: Instant) -> Option<Look> {
        let (kind, setting) = (self.ladder.families[at.family].kind, self.setting(at));
        let kept = self.kept.borrow().get(&at).cloned();
        look::look(&self.name, self.model(at), (kind, setting), kept, moments, deadline)
    }
}

/// Whether something rests or slides from the start, as steps with impacts at their instant find it in a step.
fn contact_lasts(name: &str, model: &Model) -> bool {
    let horizon = model.scene.timing().horizon();
    let step = number(horizon / (MOMENTS * u64::from(CONTACT_STEPS)) as f64);
    let changes = [
        Change::to("integrator", format!("\"{}\"", EVENT_DRIVEN[0].0)),
        Change::to("step", step.clone()),
        Change::to("horizon", step),
        Change::to("sample_every", "1"),
    ];
    let scene = Scene::parse_at(name, &changed(&model.text, &changes));
    let run = scene.ok().and_then(|scene| scene.run().ok());
    run.is_some_and(|run| 2.0 * run.lasting_contact().time > run.scene().timing().horizon())
}

/// Whether nothing in a scene takes energy, so that a true motion keeps it.
fn keeps_energy(scene: &Scene) -> bool {
    let elastic =
        scene.contact().is_none_or(|contact| contact.stiffness.is_some() || contact.is_elastic());
    scene.heat().is_none()
        && !scene.is_driven()
        && !scene.has_bounds()
        && scene.drives().is_empty()
        && elastic
        && !breaks(scene)
        && !matches!(scene.stepping(), Stepping::Heat(_))
}

/// The names of what moves.
fn placed(scene: &Scene, model: &Model) -> Vec<String> {
    moved(model).into_iter().map(|number| scene.particles()[number].name.clone()).collect()
}

/// Whether nothing happens at once: an impact, a rod that breaks, what is switched on, a spring whose ends pass.
fn is_smooth(name: &str, model: &Model) -> bool {
    let scene = &model.scene;
    let is_continuous = scene.contact().is_none() && scene.drives().is_empty() && !breaks(scene);
    is_continuous && !ends_pass(name, model)
}

/// Whether the ends of a spring on a line pass each other in the run as written: there its force jumps, unless it
/// has no length at rest or is none of Cauchy's strain.
fn ends_pass(name: &str, model: &Model) -> bool {
    let jumps = |link: &&Link| link.rest_length > 0.0 && link.strain == Strain::Cauchy;
    let jumping: Vec<&Link> = model.scene.links().iter().filter(jumps).collect();
    if model.scene.dimension() > 1 || jumping.is_empty() {
        return false;
    }
    let every = Change::to("sample_every", "1");
    let scene = Scene::parse_at(name, &changed(&model.text, &[every]));
    let Some(run) = scene.ok().and_then(|scene| scene.run().ok()) else { return true };
    let apart = |sample: usize, link: &Link| {
        let [a, b] = link.ends.map(|end| run.positions(sample)[end]);
        b > a
    };
    jumping.iter().any(|link| (1..run.times().len()).any(|k| apart(k, link) != apart(0, link)))
}

fn breaks(scene: &Scene) -> bool {
    scene.rods().iter().any(|rod| rod.strength.is_finite())
}

fn family(candidate: &Candidate, place: usize, model: &Model, rungs: Vec<Setting>) -> Family {
    let name = match &model.simplification {
        Simplification::AsWritten => candidate.name.to_owned(),
        _ => format!("{} {}", candidate.name, model.words),
    };
    let Candidate { kind, order, evaluation, holds_rods, .. } = *candidate;
    let meshed = !model.scene.solids().is_empty() || model.scene.heat().is_some();
    let all = all_modes(&model.scene).map(|all| all as f64);
    let is_closed = kind == Kind::Modes && all == rungs.last().map(|rung| rung.setting);
    Family {
        name,
        model: place,
        simplicity: model.simplicity(),
        on_mesh: meshed,
        kind,
        order,
        evaluation,
        holds_constraints: holds_rods,
        is_closed,
        rungs,
    }
}

fn rungs(candidate: &Candidate, model: &Model) -> (Vec<Setting>, Vec<Variation>) {
    let (scene, pieces) = (&model.scene, model.pieces);
    let horizon = scene.timing().horizon();
    let hessian_work = match candidate.kind {
        // Their matrices are full.
        Kind::Adaptive => scene.freedoms() as u64,
        Kind::EqualSteps | Kind::Modes => model.hessian_work(),
    };
    let step = work_of_step(candidate.evaluation, candidate.stages, hessian_work);
    let method = Change::to("integrator", format!("\"{}\"", candidate.name));
    let says = |says: [(&'static str, Option<String>); 4]| {
        let says = says.map(|(key, value)| Change { key, value });
        let changes = [method.clone()].into_iter().chain(says).collect();
        Variation { changes, hessian_work }
    };
    let read_off = |each: u64, tolerance: Option<String>, modes: Option<String>| {
        says([
            ("tolerance", tolerance),
            ("modes", modes),
            ("step", Some(number(horizon / (MOMENTS * each) as f64))),
            ("sample_every", Some("1".to_owned())),
        ])
    };
    let (rungs, says): (Vec<Setting>, Vec<Variation>) = match candidate.kind {
        Kind::EqualSteps => {
            let ahead = if candidate.factors_once { hessian_work } else { 0 };
            let rungs = equal_steps(horizon, ahead, step);
            let settings = numbers_of_steps().map(|steps| {
                let every = steps / MOMENTS / samples(scene.freedoms());
                says([
                    ("tolerance", None),
                    ("modes", None),
                    ("step", Some(number(horizon / steps as f64))),
                    ("sample_every", Some(every.max(1).to_string())),
                ])
            });
            rungs.zip(settings).unzip()
        }
        Kind::Adaptive => {
            let each = samples(scene.freedoms());
            let settings =
                powers(candidate.loosest).map(|k| read_off(each, Some(format!("1e-{k}")), None));
            adaptive_steps(candidate.loosest, step).zip(settings).unzip()
        }
        Kind::Modes => (0..=DOUBLINGS)
            .map(|k| 1_u64 << k)
            .take_while(|&modes| modes == 1 || modes < scene.freedoms() as u64)
            .filter(|&modes| all_modes(scene).is_none_or(|all| modes < all))
            .chain(all_modes(scene))
            .map(|modes| {
                let least_work = FACTORIZATIONS * hessian_work + SOLVES + 2 * modes;
                let rung = Setting { setting: modes as f64, least_work };
                (rung, read_off(SAMPLES, None, Some(modes.to_string())))
            })
            .unzip(),
    };
    let rungs =
        rungs.into_iter().map(|rung| Setting { least_work: pieces * rung.least_work, ..rung });
    (rungs.collect(), says)
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
