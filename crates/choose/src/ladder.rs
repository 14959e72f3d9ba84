//! A ladder: every way to run something, from coarse to fine, as data.
//!
//! ```text
//! equal steps    h = T / (20 2^k)     k = 0, 1, ...     one family a method and a model
//! adaptive       tolerance = 10^-k    k = K, ..., 12    read off at T/2560, 2 T/2560, ...
//! modes          N = 2^k              k = 0, 1, ...     a sum in closed form
//! ```
//! `T` the horizon, `10^-K` the loosest tolerance that the method does not hold as a tighter one: two
//! such would be one run, and each would seem to confirm the other.

use stationary_integrators::Evaluation;

/// Moments at which runs are compared in the search, equally spaced over the horizon, the start left
/// out. What is chosen is then compared over its whole way ([`Moments`](crate::Moments)).
pub const MOMENTS: u64 = 20;

/// Samples from one moment to the next, of which scales are taken, where there are so many steps; of a
/// few things many more, by which runs are read off between them.
pub const SAMPLES: u64 = 16;
const MOST_SAMPLES: u64 = 128;
/// Freedoms of all samples.
const MOST_NUMBERS: u64 = 1_000_000;

/// Halvings of the coarsest step: at most this many, and at most so many steps.
const HALVINGS: u32 = 20;
const MOST_STEPS: u64 = 1 << 26;
/// Steps that a method of adaptive steps is expected to take at least: less than one between two moments.
const LEAST_STEPS: u64 = 10;
/// The tightest tolerance tried, as a power of a tenth.
const TIGHTEST: i32 = 12;
/// Powers of ten are rounded.
const NEARLY: f64 = 1.01;

/// What a family's rungs differ in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Equal steps, halved from rung to rung.
    EqualSteps,
    /// Steps that the method chooses, to a tolerance that is a tenth from rung to rung.
    Adaptive,
    /// Modes, twice as many from rung to rung.
    Modes,
}

/// A rung's place: its family and its place in that, from coarse to fine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct At {
    /// The family.
    pub family: usize,
    /// The rung.
    pub rung: usize,
}

/// One way to run something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// The step, the tolerance or the number of modes.
    pub setting: f64,
    /// The work that it takes where every equation is solved at once.
    pub least_work: u64,
}

/// Rungs of one kind, from coarse to fine.
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    /// The method, and the model where that is not what was asked about itself.
    pub name: String,
    /// The model, by a number: 0 is what was asked about itself, others are simpler.
    pub model: usize,
    /// How much simpler: of runs that cost the same, the simplest is chosen.
    pub simplicity: u32,
    /// Whether it stands on a mesh that could be finer.
    pub on_mesh: bool,
    /// What its rungs differ in.
    pub kind: Kind,
    /// The power of the step in the error, of smooth motion without constraints.
    pub order: u32,
    /// Whether its steps solve equations.
    pub evaluation: Evaluation,
    /// Whether constraints are a part of its steps; others are projected back after each.
    pub holds_constraints: bool,
    /// Whether its finest rung is in closed form: a sum of all modes.
    pub is_closed: bool,
    /// Its rungs.
    pub rungs: Vec<Setting>,
}

/// What errors of an observable are relative to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// The largest kinetic energy: of energies.
    Kinetic,
    /// The largest way from its start: of places.
    Way,
    /// Its largest value.
    Largest,
    /// What each run tells, in these words: of momenta.
    Told(&'static str),
}

impl Scale {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Scale::Kinetic => "the largest kinetic energy",
            Scale::Way => "the largest way from its start",
            Scale::Largest => "its largest value",
            Scale::Told(words) => words,
        }
    }
}

/// A finer mesh, which nobody asks for: it shows the mesh's own error.
#[derive(Clone, Debug, PartialEq)]
pub struct Finer {
    /// In words, such as `with 20 x 4 cells`.
    pub words: String,
    /// The work of a step over that on the mesh as it is.
    pub work: f64,
}

/// Every way to run something, and what is asked of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Ladder {
    /// What it is, for headings.
    pub title: String,
    /// What is observed, for headings.
    pub observable: String,
    /// What errors of that are relative to.
    pub scale: Scale,
    /// The time to which it is run.
    pub horizon: f64,
    /// The unit of time, for headings.
    pub time: String,
    /// Whether a true motion keeps the energy.
    pub keeps_energy: bool,
    /// Whether nothing happens at once, such as an impact: what is looked into in some steps tells of the
    /// others.
    pub is_smooth: bool,
    /// Whether straight lines join the ends of equal steps: what lies between them is known from these alone.
    pub is_joined: bool,
    /// Names of the things whose places are looked at beside the observable, as runs give them.
    pub placed: Vec<String>,
    /// Whether constraints are held: then all methods solve the same equations, whatever their order.
    pub is_constrained: bool,
    /// The family of adaptive steps of which the tolerance to set is asked beside, cheap or not.
    pub asks: Option<usize>,
    /// The families.
    pub families: Vec<Family>,
    /// Finer meshes, each of half the length of the one before.
    pub finer: Vec<Finer>,
}

impl Family {
    /// Whether its rungs come ever nearer to what was asked about itself.
    pub fn converges(&self) -> bool {
        self.model == 0 && (self.kind != Kind::Modes || self.is_closed)
    }

    /// The coarsest rung whose setting is at most this, else the finest.
    pub fn at_most(&self, setting: f64) -> usize {
        let fine = self.rungs.iter().position(|rung| rung.setting <= NEARLY * setting);
        fine.unwrap_or(self.rungs.len().saturating_sub(1))
    }

    /// A rung's setting in words: `step = 0.5`, `tolerance = 1e-3` or `modes = 4`.
    pub fn setting(&self, rung: usize) -> String {
        let value = self.rungs.get(rung).map_or(f64::NAN, |rung| rung.setting);
        match self.kind {
            Kind::EqualSteps => format!("step = {value}"),
            Kind::Adaptive => format!("tolerance = {value:e}"),
            Kind::Modes => format!("modes = {value}"),
        }
    }
}

/// What a step takes at least, in differentials: so many stages, or a solve from a first guess and a
/// look that it found the state, where a Hessian with its factorization counts as so many.
pub fn work_of_step(evaluation: Evaluation, stages: u64, hessian: u64) -> u64 {
    match evaluation {
        Evaluation::Explicit => stages,
        Evaluation::Implicit => stages.max(1) + 1 + hessian,
    }
}

/// Numbers of equal steps, from the fewest: each twice the one before.
pub fn numbers_of_steps() -> impl Iterator<Item = u64> {
    (0..=HALVINGS).map(|k| MOMENTS << k).take_while(|&steps| steps <= MOST_STEPS)
}

/// The rungs of equal steps: what is made ahead, and each step, counts so much.
pub fn equal_steps(horizon: f64, ahead: u64, step: u64) -> impl Iterator<Item = Setting> {
    numbers_of_steps().map(move |steps| Setting {
        setting: horizon / steps as f64,
        least_work: ahead + step * steps,
    })
}

/// The powers of a tenth that a method tells apart as tolerances, from the loosest.
pub fn powers(loosest: f64) -> impl Iterator<Item = i32> {
    (1..=TIGHTEST).filter(move |k| 10_f64.powi(-k) <= NEARLY * loosest)
}

/// The rungs of adaptive steps, each of which counts so much.
pub fn adaptive_steps(loosest: f64, step: u64) -> impl Iterator<Item = Setting> {
    let least_work = LEAST_STEPS * step;
    powers(loosest).map(move |k| Setting { setting: 10_f64.powi(-k), least_work })
}

/// Samples from one moment to the next that there is room for: a power of two.
pub fn samples(freedoms: usize) -> u64 {
    let room = MOST_NUMBERS / (MOMENTS * freedoms.max(1) as u64);
    let power = 1_u64 << room.max(1).ilog2();
    power.clamp(SAMPLES, MOST_SAMPLES)
}
