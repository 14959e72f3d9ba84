//! How far a motion is from the true one: its global error, estimated along the way.
//!
//! ```text
//! x_h(t) = x(t) + c(t) h^k + d(t) h^(k+1) + ...           the error of a run with steps h
//! e = a (x_{h/4} - x_{h/2}),    a = 1/(2^k - 1)           its first estimate, for steps h/4
//! e + b (x_{h/4} - x_{h/2} + e - a (x_{h/2} - x_h)),      b = 1/(2^(k+1) - 1): the second, which is told
//! r = max |x_{h/2} - x_h| / max |x_{h/4} - x_{h/2}|       2^k where the runs converge, of q and of p
//! ```
//! `x = (q, p)`, `k` the order, the maxima over the way so far; where q shrinks otherwise at this time, all of the
//! estimate is doubtful. What a step is off (a tolerance) says
//! little of this: errors of steps add up, cancel and grow with the flow. Three runs tell how good the
//! estimate is: by its last correction, which stands beside it as its doubt, and by `r`. Where that is
//! not the order's, the steps are too long, the motion is chaotic or all is rounding; this is said with
//! every estimate.
//!
//! Source: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, II.4 and II.8.

use std::ops::ControlFlow;

use stationary_calculus::Storage;

use crate::{Cost, Horizon, Integrator, SimulationError, State, StepError};

/// What the observer sees after a step of the longest.
#[derive(Debug)]
pub struct Estimated<'a, C> {
    /// The number of the longest steps so far.
    pub step: u64,
    /// The state, in steps of a quarter, with its time.
    pub state: &'a State<C>,
    /// The true state minus this one, as far as can be told; its time is zero.
    pub error: &'a State<C>,
    /// How far the configuration's estimate may itself be off: the norm of its last correction, and all of it
    /// where the runs do not shrink by the method's order at this time.
    pub doubt: f64,
    /// Whether the three runs so far come nearer to each other as the method's order says.
    pub trust: Trust,
}

/// An estimate that may be off by this part of itself is one no more.
pub(crate) const DOUBTFUL: f64 = 0.25;

impl<C: AsRef<[f64]>> Estimated<'_, C> {
    /// Whether the estimate can be relied on: the runs converge, and its doubt is at most a quarter of it.
    /// It is then good to a factor of two in all but one or two of a thousand, and to one of four in all but one
    /// run of several thousand: three runs cannot tell a power from another law that looks like it.
    pub fn is_sure(&self) -> bool {
        self.trust.converges() && self.doubt <= DOUBTFUL * self.distance()
    }

    /// The estimated distance of the configuration from the true one, in its own unit.
    pub fn distance(&self) -> f64 {
        norm(self.error.q.as_ref())
    }
}

/// Whether an estimate is one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Trust {
    /// The runs converge with this order, which is the method's or a better one.
    Converging {
        /// log2 r.
        order: f64,
    },
    /// They do not: the difference of the two finest runs stands for the error, which may be larger.
    NotConverging {
        /// log2 r; NaN where there is no difference to speak of.
        order: f64,
    },
}

impl Trust {
    /// Whether the runs converge.
    pub fn converges(self) -> bool {
        matches!(self, Trust::Converging { .. })
    }
}

/// Runs that differ by more than this part of the largest numbers differ by as much as they move.
const MOTION: f64 = 0.1;
/// The measured order may be so much below the method's, and so much above it.
const BELOW: f64 = 0.3;
const ABOVE: f64 = 1.2;
/// Differences below this part of the numbers are rounding, added up.
pub(crate) const ROUNDING: f64 = 1e-14;

/// Three runs of one method, in steps of h, h/2 and h/4.
struct Three<I, C> {
    runs: [I; 3],
    states: [State<C>; 3],
    error: State<C>,
    /// The largest differences of neighbours so far, of configurations and momenta.
    differences: [[f64; 2]; 2],
    /// The largest numbers so far, of the same.
    sizes: [f64; 2],
    order: f64,
    cost: Cost,
}

/// Steps `state` to the horizon in quarters of its steps, beside runs in halves and in whole ones, and
/// shows the estimated error after each whole one; the start is taken for exact. `make` makes one
/// method three times: each run has its own memory. The work is 7/4 of that of the quarters alone.
///
/// The estimate is that of the numbers that store a state: of rotations that of their quaternions.
///
/// ```
/// use std::ops::ControlFlow;
/// use stationary_integrators::{Horizon, StormerVerlet, problems::kepler, simulate_with_error};
///
/// let planet = kepler(0.3)?;
/// let mut state = planet.initial.clone();
/// let horizon = Horizon::divided(planet.period, 1000)?;
/// simulate_with_error(|| StormerVerlet::new(&planet.system), &mut state, horizon, |now| {
///     let truth = planet.error(now.state.t, &now.state.q).unwrap();
///     assert!(now.trust.converges());
///     assert!((now.distance() / truth - 1.0).abs() < 0.05, "{} of {truth}", now.distance());
///     ControlFlow::Continue(())
/// })?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Those of `make`, and of [`simulate`](crate::simulate) from any of the runs: the step is the longest
/// one that failed, and the state is that after the last good one.
pub fn simulate_with_error<C, I, E>(
    mut make: impl FnMut() -> Result<I, E>,
    state: &mut State<C>,
    horizon: Horizon,
    mut observe: impl FnMut(Estimated<'_, C>) -> ControlFlow<()>,
) -> Result<Cost, SimulationError>
where
    C: Storage,
    I: Integrator<C>,
    E: Into<StepError>,
{
    let (first, end) = horizon.span();
    let steps = horizon.left();
    let failed = |step, time, source| SimulationError { step, time, source };
    if let Some(&time) = [first, end].iter().find(|time| !time.is_finite()) {
        return Err(failed(*steps.start(), state.t, StepError::Time(time)));
    }
    let mut method = || make().map_err(|error| failed(*steps.start(), state.t, error.into()));
    let runs = [method()?, method()?, method()?];
    state.t = first;
    let mut three = Three::new(runs, state);
    for step in steps {
        let time = state.t;
        let (from, to) = (horizon.time(step - 1), horizon.time(step));
        three.step(horizon.step(), (from, to)).map_err(|source| failed(step, time, source))?;
        state.clone_from(&three.states[2]);
        let (trust, doubt) = three.estimate();
        let now = Estimated { step, state, error: &three.error, doubt, trust };
        if observe(now).is_break() {
            break;
        }
    }
    Ok(three.cost)
}

impl<C: Storage, I: Integrator<C>> Three<I, C> {
    fn new(runs: [I; 3], start: &State<C>) -> Self {
        Three {
            order: f64::from(runs[0].facts().order),
            runs,
            states: [start.clone(), start.clone(), start.clone()],
            error: start.clone(),
            differences: [[0.0; 2]; 2],
            sizes: [0.0; 2],
            cost: Cost::default(),
        }
    }

    /// All runs by h, from one time to another, in one step, two and four.
    fn step(&mut self, h: f64, (from, to): (f64, f64)) -> Result<(), StepError> {
        for (halvings, (run, state)) in self.runs.iter_mut().zip(&mut self.states).enumerate() {
            let parts = 1_u32 << halvings;
            for part in 1..=parts {
                let report = run.step(state, h / f64::from(parts))?;
                self.cost.add(&report);
                state.t = from + h * f64::from(part) / f64::from(parts);
            }
            state.t = to;
        }
        Ok(())
    }

    /// Writes the error of the finest run, and returns how far it may itself be off.
    fn estimate(&mut self) -> (Trust, f64) {
        let [coarse, middle, fine] = &self.states;
        for (slot, pair) in [(0, (coarse, middle)), (1, (middle, fine))] {
            let largest = &mut self.differences[slot];
            largest[0] = largest[0].max(distance(pair.0.q.as_ref(), pair.1.q.as_ref()));
            largest[1] = largest[1].max(distance(pair.0.p.components(), pair.1.p.components()));
        }
        self.sizes[0] = self.sizes[0].max(norm(fine.q.as_ref()));
        self.sizes[1] = self.sizes[1].max(norm(fine.p.components()));
        let trust = self.trust();
        let [first, second] = [self.order, self.order + 1.0].map(|k| 1.0 / (k.exp2() - 1.0));
        let each = |error: &mut [f64], coarse: &[f64], middle: &[f64], fine: &[f64]| {
            let mut correction = 0.0;
            for (i, error) in error.iter_mut().enumerate() {
                let (last, before) = (fine[i] - middle[i], middle[i] - coarse[i]);
                let next = second * (last + first * (last - before));
                *error = if trust.converges() { first * last + next } else { last };
                correction += next * next;
            }
            correction.sqrt()
        };
        self.error.t = 0.0;
        let [a, b, c] = [coarse, middle, fine].map(|state| state.p.components());
        each(self.error.p.components_mut(), a, b, c);
        let [a, b, c] = [coarse, middle, fine].map(|state| state.q.as_ref());
        let correction = each(self.error.q.as_mut(), a, b, c);
        let here = (distance(a, b) / distance(b, c)).log2();
        let doubt = if self.is_of_order(here) { correction } else { norm(self.error.q.as_ref()) };
        (trust, doubt)
    }

    /// Whether differences that shrink with this order shrink as the method's errors do.
    fn is_of_order(&self, order: f64) -> bool {
        (self.order - BELOW..=self.order + ABOVE).contains(&order)
    }

    /// The order by which the differences shrink: that of what moves more clearly, configurations or
    /// momenta. Both must shrink as the method's errors do, where they are more than rounding.
    fn trust(&self) -> Trust {
        let [wide, narrow] = self.differences;
        let (mut order, mut clearest) = (f64::NAN, 0.0);
        let mut converges = wide[0] <= MOTION * self.sizes[0] && wide[1] <= MOTION * self.sizes[1];
        for part in 0..2 {
            let clear = narrow[part] / self.sizes[part];
            if clear > 16.0 * ROUNDING {
                let own = (wide[part] / narrow[part]).log2();
                converges &= self.is_of_order(own);
                if clear > clearest {
                    (order, clearest) = (own, clear);
                }
            }
        }
        converges &= !order.is_nan();
        if converges { Trust::Converging { order } } else { Trust::NotConverging { order } }
    }
}

pub(crate) fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
