//! What a run does at the moments of a grid: the observable, its energies, and places of its things.

use std::rc::Rc;
use std::time::Instant;

use stationary_choose::{Energies, Kind, Look, Moments, Samples, counted, inside, is_at, until};
use stationary_integrators::Cost;
use toml::{Table, Value};

use super::candidate::Variation;
use super::declaration::changed;
use super::model::{Model, moved};
use super::run::{Kept, own, told};
use crate::model::scene::Scene;
use crate::run::checkpoint::Checkpoint;
use crate::run::observer::{Control, Observer, Progress};
use crate::run::start::Start;

/// Steps between two looks at the clock.
const CLOCK: u64 = 256;

/// Runs a setting of a model and looks at it at the moments of a grid; nothing where it fails, or the
/// time is over. The work is that of the run, or nothing where its steps were kept; parts of steps of equal
/// size are counted as steps.
pub(super) fn look(
    name: &str,
    model: &Model,
    (kind, setting): (Kind, &Variation),
    kept: Option<Kept>,
    moments: &Moments,
    deadline: Instant,
) -> Option<Look> {
    let mut table = toml::from_str::<Table>(&changed(&model.text, &setting.changes)).ok()?;
    let asked = table.get("observables")?.as_array()?.first()?.clone();
    let heat = model.scene.heat().is_some();
    let beside = if heat { Vec::new() } else { beside(model) };
    let columns = model.scene.observables().first()?.headings(&model.scene).len();
    let observables = Value::Array([asked].into_iter().chain(beside).collect());
    let steps = Scene::parse_at(name, &table.to_string()).ok()?.timing().steps();
    let (joins, parts) = (joins(model, kind), moments.parts.filter(|_| kind == Kind::EqualSteps));
    // A fine run is sampled where the parts end, a coarse one at every step.
    let every = match parts {
        _ if joins => 1,
        Some(parts) => (steps / parts).max(1),
        None => (steps / SAMPLED).max(1),
    };
    table.insert("observables".to_owned(), observables);
    table.insert("sample_every".to_owned(), Value::Integer(every as i64));
    let scene = Scene::parse_at(name, &table.to_string()).ok()?;
    let h = scene.timing().step();
    let times = &moments.times;
    let mut looking = Looking {
        times,
        h,
        reads: match (joins, parts) {
            (true, _) => Reads::Lines,
            (false, Some(_)) => Reads::Ends,
            (false, None) => Reads::Parts,
        },
        parts: Vec::new(),
        taken: 0,
        found: Vec::with_capacity(times.len()),
        ends: Vec::new(),
        deadline,
        kept: kept.as_ref().map(|kept| kept.starts.clone()),
    };
    let run = scene.run_from(None, &mut looking).ok()?;
    let start = run.observed(0).to_vec();
    let mut is_own = vec![true; times.len() + 1];
    if joins {
        (looking.found, is_own) = joined(times, &start, &looking.ends)?;
    }
    if looking.found.len() < times.len() {
        return None;
    }
    let parts = looking.taken;
    let work = match &kept {
        Some(kept) => kept.work * parts / steps,
        None => model.pieces * taken(run.cost(), setting, (kind, parts, steps)),
    };
    let mut samples = Samples::default();
    for row in [start].iter().chain(&looking.found) {
        let (observed, rest) = row.split_at_checked(columns)?;
        let (energies, places) = match heat {
            true => (None, rest),
            false => {
                let [total, kinetic, ref places @ ..] = *rest else { return None };
                (Some(Energies { total, kinetic }), places)
            }
        };
        samples.push(observed, energies, places);
    }
    let look = Look::of(&samples, work);
    let kinetic = if heat { 0.0 } else { look.kinetic };
    let kinetic = run.kinetic_energies().iter().copied().fold(kinetic, f64::max);
    let (most, told) = match kept {
        Some(kept) => (kept.kinetic, kept.told),
        None => (0.0, told(&run)),
    };
    Some(Look { kinetic: kinetic.max(most), is_own, told, ..look })
}

/// Counted work with that of parts of steps: what is read off from modes is a reading, from the steps that a
/// method chose itself it takes nothing.
fn taken(cost: Cost, setting: &Variation, (kind, parts, steps): (Kind, u64, u64)) -> u64 {
    if kind != Kind::EqualSteps {
        let read = own(Cost { steps: cost.steps + parts, ..cost }, kind);
        return counted(read, setting.hessian_work);
    }
    let whole = counted(cost, setting.hessian_work);
    (whole as f64 * (1.0 + parts as f64 / steps as f64)) as u64
}

/// Whether steps have no parts: straight lines join their ends.
fn joins(model: &Model, kind: Kind) -> bool {
    let breaking = model.scene.rods().iter().any(|rod| rod.strength.is_finite());
    breaking || model.scene.heat().is_some() && kind == Kind::EqualSteps
}

/// What is observed beside the observable: energies, and places of the first things that move. What
/// stands for something else has not the same ones.
fn beside(model: &Model) -> Vec<Value> {
    let mut all = vec![Value::from("energy"), Value::from("kinetic-energy")];
    for number in moved(model) {
        let mut place = Table::new();
        let name = model.scene.particles()[number].name.as_str();
        place.insert("position".to_owned(), name.into());
        all.push(Value::Table(place));
    }
    all
}

/// What is observed at moments, on straight lines between the ends of steps, and whether it is at
/// an end: the start first.
fn joined(times: &[f64], start: &[f64], ends: &[(f64, Vec<f64>)]) -> Option<(Rows, Vec<bool>)> {
    let (mut next, mut found, mut is_own) = (0, Vec::with_capacity(times.len()), vec![true]);
    let first = (0.0, start.to_vec());
    for &t in times {
        while ends.get(next).is_some_and(|end| end.0 < t * (1.0 - 1e-12)) {
            next += 1;
        }
        let end = ends.get(next)?;
        let before = if next == 0 { &first } else { &ends[next - 1] };
        let part = ((t - before.0) / (end.0 - before.0)).min(1.0);
        is_own.push(part > 1.0 - 1e-9);
        found.push(before.1.iter().zip(&end.1).map(|(a, b)| a + part * (b - a)).collect());
    }
    Some((found, is_own))
}

/// Samples of a run whose moments are not those of equal parts: scales are taken of them.
const SAMPLED: u64 = 320;

/// How what is between the ends of steps is known.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Reads {
    /// By straight lines.
    Lines,
    /// By steps of those parts; what is at an end was sampled there.
    Ends,
    /// All by steps of those parts.
    Parts,
}

type Rows = Vec<Vec<f64>>;

/// Looks at a run at the moments.
struct Looking<'t> {
    times: &'t [f64],
    h: f64,
    reads: Reads,
    parts: Vec<f64>,
    /// Parts of steps that were taken besides the steps.
    taken: u64,
    found: Vec<Vec<f64>>,
    /// The ends of steps, where these are joined by lines.
    ends: Vec<(f64, Vec<f64>)>,
    deadline: Instant,
    kept: Option<Rc<[Start]>>,
}

impl Observer for Looking<'_> {
    fn stepped(&mut self, now: Progress<'_>) -> Control {
        match self.reads {
            Reads::Lines => self.ends.push((now.time, now.observed.to_vec())),
            Reads::Ends => {
                if self.times.get(self.found.len()).is_some_and(|&t| is_at(t, now.time, self.h)) {
                    self.found.push(now.observed.to_vec());
                }
            }
            Reads::Parts => {}
        }
        let late = now.step.is_multiple_of(CLOCK) && Instant::now() >= self.deadline;
        if late { Control::Stop } else { Control::Continue }
    }

    fn keep(&mut self, _: &Checkpoint) {}

    fn parts(&mut self, step: u64) -> &[f64] {
        let ahead = &self.times[self.found.len().min(self.times.len())..];
        let from = (step - 1) as f64 * self.h;
        self.parts.clear();
        match self.reads {
            Reads::Lines => {}
            Reads::Ends => self.parts.extend(inside(ahead, from, self.h)),
            Reads::Parts => self.parts.extend(until(ahead, from, self.h)),
        }
        &self.parts
    }

    fn kept(&self) -> Option<Rc<[Start]>> {
        self.kept.clone()
    }

    fn inside(&mut self, _: f64, observed: &[f64]) {
        self.taken += 1;
        self.found.push(observed.to_vec());
    }
}
