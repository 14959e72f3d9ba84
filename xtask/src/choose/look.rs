//! What a run does at the moments of a grid: the observable, its energies, and places of its things.

use std::time::Instant;

use stationary_scene::{Checkpoint, Observable, Progress, Scene, Stepping, Watcher, Wish};
use toml::{Table, Value};

use super::declaration::{Change, changed, number};
use super::grid::{Grid, inside, is_at};
use super::ladder::{Kind, Rung};
use super::model::{Model, Sight};
use super::run::{distance, norm};

/// A run at the moments of a grid.
#[derive(Clone, Debug)]
pub struct Look {
    /// The observable's numbers at the start, and then at each moment.
    pub values: Vec<Vec<f64>>,
    /// The energy at the same moments; none of heat.
    pub energies: Vec<f64>,
    /// The largest kinetic energy.
    pub kinetic: f64,
    /// Places of some things at the same moments, one after the other.
    pub places: Vec<Vec<f64>>,
    /// The largest sums of the parts' momenta and angular momenta, at the ends of steps.
    pub momenta: [f64; 2],
    /// Counted work.
    pub work: u64,
}

/// Places that are compared beside the observable.
const PLACES: usize = 6;

/// Steps between two looks at the clock.
const CLOCK: u64 = 256;

/// Runs a setting of a model and looks at it at the moments of a grid; nothing where it fails, or the
/// time is over. The work is that of the run; parts of steps of equal size are counted as steps.
pub fn look(
    name: &str,
    model: &Model,
    (kind, rung): (Kind, &Rung),
    grid: Grid,
    deadline: Instant,
) -> Option<Look> {
    let asked =
        toml::from_str::<Table>(&model.text).ok()?.get("observables")?.as_array()?.first()?.clone();
    let heat = model.scene.heat().is_some();
    let beside = if heat { Vec::new() } else { beside(model) };
    let columns = model.scene.observables().first()?.headings(&model.scene).len();
    let observables = Value::Array([asked].into_iter().chain(beside).collect());
    let mut text = changed(&model.text, &rung.changes);
    let horizon = model.scene.timing().horizon();
    if kind != Kind::EqualSteps {
        text = changed(&text, &[Change::to("step", number(horizon / grid.parts() as f64))]);
    }
    let steps = Scene::parse_at(name, &text).ok()?.timing().steps();
    // A fine run is sampled where the grid's parts end, a coarse one at every step.
    let every = if lines(model, kind) { 1 } else { (steps * grid.stride() / grid.parts()).max(1) };
    let changes = [
        Change::to("observables", observables.to_string()),
        Change::to("sample_every", every.to_string()),
    ];
    let scene = Scene::parse_at(name, &changed(&text, &changes)).ok()?;
    let h = scene.timing().step();
    let times = grid.times(horizon);
    let mut looking = Looking {
        times: &times,
        h,
        lines: lines(model, kind),
        parts: Vec::new(),
        found: Vec::with_capacity(times.len()),
        ends: Vec::new(),
        deadline,
    };
    let run = scene.run_from(None, &mut looking).ok()?;
    let start = run.observed(0).to_vec();
    if looking.lines {
        looking.found = joined(&times, &start, &looking.ends)?;
    }
    if looking.found.len() < times.len() {
        return None;
    }
    let cost = run.cost();
    let counted =
        cost.steps.max(cost.differentials + cost.energies) + rung.hessian_work * cost.hessians;
    let parts =
        if kind == Kind::EqualSteps && !looking.lines { times.len() as u64 * 3 / 4 } else { 0 };
    let work = model.pieces * (counted as f64 * (1.0 + parts as f64 / steps as f64)) as u64;
    let rows: Vec<Vec<f64>> = [start].into_iter().chain(looking.found).collect();
    if rows.iter().flatten().any(|x| !x.is_finite()) {
        return None;
    }
    let energies = if heat { Vec::new() } else { rows.iter().map(|row| row[columns]).collect() };
    let kinetic =
        if heat { 0.0 } else { rows.iter().map(|row| row[columns + 1]).fold(0.0, f64::max) };
    let kinetic = run.kinetic_energies().iter().copied().fold(kinetic, f64::max);
    let skipped = columns + if heat { 0 } else { 2 };
    Some(Look {
        energies,
        kinetic,
        places: rows.iter().map(|row| row[skipped..].to_vec()).collect(),
        values: rows
            .into_iter()
            .map(|mut row| {
                row.truncate(columns);
                row
            })
            .collect(),
        momenta: run.momentum_scales(),
        work,
    })
}

/// Whether steps have no parts: straight lines join their ends.
fn lines(model: &Model, kind: Kind) -> bool {
    let breaking = model.scene.rods().iter().any(|rod| rod.strength.is_finite());
    breaking || model.scene.heat().is_some() && kind == Kind::EqualSteps
}

/// What is observed beside the observable: energies, and places of the first things that move. What
/// stands for something else has not the same ones.
fn beside(model: &Model) -> Vec<Value> {
    let mut all = vec![Value::from("energy"), Value::from("kinetic-energy")];
    if matches!(model.sight, Sight::AsWritten | Sight::Contact { .. } | Sight::Springs { .. }) {
        let moves = |particle: &&stationary_scene::Particle| {
            particle.motion != stationary_scene::Motion::Pinned
        };
        for particle in model.scene.particles().iter().filter(moves).take(PLACES) {
            let mut place = Table::new();
            place.insert("position".to_owned(), particle.name.as_str().into());
            all.push(Value::Table(place));
        }
    }
    all
}

/// What is observed at moments, on straight lines between the ends of steps.
fn joined(times: &[f64], start: &[f64], ends: &[(f64, Vec<f64>)]) -> Option<Vec<Vec<f64>>> {
    let (mut next, mut found) = (0, Vec::with_capacity(times.len()));
    let first = (0.0, start.to_vec());
    for &t in times {
        while ends.get(next).is_some_and(|end| end.0 < t * (1.0 - 1e-12)) {
            next += 1;
        }
        let end = ends.get(next)?;
        let before = if next == 0 { &first } else { &ends[next - 1] };
        let part = ((t - before.0) / (end.0 - before.0)).min(1.0);
        found.push(before.1.iter().zip(&end.1).map(|(a, b)| a + part * (b - a)).collect());
    }
    Some(found)
}

/// Looks at a run at the moments.
struct Looking<'t> {
    times: &'t [f64],
    h: f64,
    lines: bool,
    parts: Vec<f64>,
    found: Vec<Vec<f64>>,
    /// The ends of steps, where these are joined by lines.
    ends: Vec<(f64, Vec<f64>)>,
    deadline: Instant,
}

impl Watcher for Looking<'_> {
    fn stepped(&mut self, now: Progress<'_>) -> Wish {
        if self.lines {
            self.ends.push((now.time, now.observed.to_vec()));
        } else if self.times.get(self.found.len()).is_some_and(|&t| is_at(t, now.time, self.h)) {
            self.found.push(now.observed.to_vec());
        }
        let late = now.step % CLOCK == 0 && Instant::now() >= self.deadline;
        if late { Wish::Stop } else { Wish::GoOn }
    }

    fn keep(&mut self, _: &Checkpoint) {}

    fn parts(&mut self, step: u64) -> &[f64] {
        let ahead = &self.times[self.found.len().min(self.times.len())..];
        self.parts = inside(ahead, (step - 1) as f64 * self.h, self.h);
        &self.parts
    }

    fn inside(&mut self, _: f64, observed: &[f64]) {
        self.found.push(observed.to_vec());
    }
}

impl Look {
    /// What errors of the observable are relative to, over the whole way.
    pub fn scale(&self, observable: &Observable) -> f64 {
        match observable {
            Observable::Energy | Observable::KineticEnergy | Observable::PotentialEnergy => {
                self.kinetic
            }
            Observable::LinearMomentum => self.momenta[0],
            Observable::AngularMomentum => self.momenta[1],
            Observable::Position(_) => {
                self.values.iter().map(|x| distance(x, &self.values[0])).fold(0.0, f64::max)
            }
            _ => self.values.iter().map(|x| norm(x)).fold(0.0, f64::max),
        }
    }

    /// The largest change of the energy, relative to the largest kinetic energy.
    pub fn drift(&self) -> f64 {
        let Some(&first) = self.energies.first() else { return 0.0 };
        let most = self.energies.iter().map(|energy| (energy - first).abs()).fold(0.0, f64::max);
        most / self.kinetic.max(f64::MIN_POSITIVE)
    }
}

/// The largest distance of two rows of numbers.
pub fn apart(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let each = a.iter().zip(b).map(|(a, b)| distance(a, b));
    each.fold(0.0, |most: f64, x| if x > most || x.is_nan() { x } else { most })
}

/// Whether nothing in a scene takes energy, so that a true motion keeps it.
pub fn keeps_energy(scene: &Scene) -> bool {
    let elastic = scene.contact().is_none_or(|contact| {
        contact.stiffness.is_some() || contact.restitution == 1.0 && contact.friction == 0.0
    });
    let breaking = scene.rods().iter().any(|rod| rod.strength.is_finite());
    scene.heat().is_none()
        && scene.drag().is_none()
        && elastic
        && !breaking
        && !matches!(scene.stepping(), Stepping::Heat(_))
}
