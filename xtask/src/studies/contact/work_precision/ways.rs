//! Three ways to step bodies in contact: where they are at some moments, and what that takes.

use std::time::Instant;

use nalgebra::Vector3;
use stationary_contact::{ContactError, ErrorControlled};
use stationary_integrators::State;
use stationary_rigid::{BodySpace, Poses};

use super::scenes::Scene;

/// Moments at which places are compared.
pub const MOMENTS: usize = 10;

/// How bodies are stepped, with its setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    /// Steps of so many seconds, at most.
    Fixed(f64),
    /// Steps chosen for an accuracy, m.
    Chosen(f64),
    /// Impacts at the instant, with contact steps of so many seconds.
    AtTheInstant(f64),
}

impl Way {
    /// Their names, in the order of the charts.
    pub const NAMES: [&'static str; 3] = ["fixed", "chosen", "at the instant"];

    /// Which it is.
    pub fn name(self) -> &'static str {
        match self {
            Way::Fixed(_) => Self::NAMES[0],
            Way::Chosen(_) => Self::NAMES[1],
            Way::AtTheInstant(_) => Self::NAMES[2],
        }
    }

    /// Seconds or metres.
    pub fn setting(self) -> f64 {
        match self {
            Way::Fixed(x) | Way::Chosen(x) | Way::AtTheInstant(x) => x,
        }
    }
}

/// Where points of bodies were at the moments, and what that took.
pub struct Run {
    /// The centre of each body, and the point that was a size from it along x.
    pub places: Vec<Vec<Vector3<f64>>>,
    /// Detections and solves.
    pub work: usize,
    /// Whether every step was.
    pub settled: bool,
    /// On the clock.
    pub seconds: f64,
}

/// Runs a scene.
pub fn run(scene: &Scene, way: Way) -> Result<Run, ContactError> {
    let clock = Instant::now();
    let mut state = scene.start()?;
    let part = scene.duration / MOMENTS as f64;
    let mut run = Run { places: Vec::new(), work: 0, settled: true, seconds: 0.0 };
    match way {
        Way::Fixed(h) => {
            let mut world = scene.world()?;
            let steps = (part / h).ceil();
            for _ in 0..MOMENTS {
                for _ in 0..steps as usize {
                    let done = world.step(&mut state, part / steps)?;
                    run.work += 1 + done.relaxed + done.solved + done.projected + done.impacts;
                    run.settled &= done.settled;
                }
                run.places.push(places(scene, &state));
            }
        }
        Way::Chosen(accuracy) => {
            let mut chosen = ErrorControlled::new(scene.world()?, accuracy)?;
            for _ in 0..MOMENTS {
                let done = chosen.advance(&mut state, part)?;
                run.work += done.world_steps + done.solves;
                run.settled &= done.settled;
                run.places.push(places(scene, &state));
            }
        }
        Way::AtTheInstant(contact_step) => {
            let mut bodies = scene.event_driven(contact_step)?;
            for _ in 0..MOMENTS {
                let done = bodies.step(&mut state, part)?;
                run.work += done.detections + done.queries + done.solves;
                run.settled &= done.settled;
                run.places.push(places(scene, &state));
            }
        }
    }
    run.seconds = clock.elapsed().as_secs_f64();
    Ok(run)
}

/// The centre of each body, and the point that was a size from it along x.
pub fn places(scene: &Scene, state: &State<Vec<f64>>) -> Vec<Vector3<f64>> {
    let points = |body: usize| {
        let pose = Poses::pose_at(&state.q, body);
        [pose.translation, pose.apply(&(Vector3::x() * scene.size))]
    };
    (0..state.q.len() / 7).flat_map(points).collect()
}

/// The largest distance of points, over all moments, m.
pub fn apart(a: &[Vec<Vector3<f64>>], b: &[Vec<Vector3<f64>>]) -> f64 {
    let both = a.iter().flatten().zip(b.iter().flatten());
    both.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

/// What is asked where steps chosen by error fail.
pub const SHORT: (Way, Way) = (Way::Fixed(2e-5), Way::Fixed(5e-5));

/// A fine way and a coarser one: their distance is how well the limit of small steps is known.
pub fn limit(scene: &Scene) -> (Way, Way) {
    match scene.name {
        "pile" => (Way::Fixed(5e-4), Way::Fixed(1e-3)),
        "box" => (Way::AtTheInstant(2e-5), Way::Fixed(1e-5)),
        "Euler's disc" => SHORT,
        "rattleback" => (Way::Chosen(3e-6), Way::Fixed(2e-5)),
        _ => (Way::Chosen(1e-6), Way::Chosen(3e-6)),
    }
}
