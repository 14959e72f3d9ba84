//! Steps that the method chooses, read off at moments of the scene's choice.
//!
//! A method moves numbers of its own, from which the scene's state is read: places and momenta of particles,
//! or coordinates and speeds of joints.

use std::time::Instant;

use stationary_calculus::{Covector, Metric, Vector};
use stationary_integrators::{
    AdaptiveMethod, BackwardDifferences, DormandPrince54, DormandPrince853, MechanicalField,
    Moment, RadauIia5, Saved, State, StepControl, StepReport, Tolerance, Work,
};

use crate::assemble::acting::Acting;
use crate::assemble::error::AssemblyError;
use crate::assemble::system::SceneProblem;
use crate::model::scene::Scene;
use crate::model::stepping::Adaptive;
use crate::run::checkpoint::{Before, CheckpointError};
use crate::run::error::StepFailure;
use crate::run::stepper::{Stepped, Stepper};

/// What steps as a method chooses.
pub(crate) fn stepper<'s>(
    scene: &Scene,
    problem: &'s SceneProblem,
    method: Adaptive,
    tolerance: f64,
) -> Result<Box<dyn Stepper + 's>, AssemblyError> {
    let acting = Acting::of(scene);
    let method = adaptive(method, problem, acting.clone(), tolerance)?;
    Ok(read_off(scene, &problem.initial, method, Box::new(PlacesAndMomenta), acting))
}

/// How the scene's state, and what holds it, are read from a method's numbers at a time.
pub(crate) trait Reader {
    /// Writes the scene's state.
    fn read(&mut self, t: f64, y: &[f64], state: &mut State<Vec<f64>>) -> Result<(), StepFailure>;

    /// Brings the numbers where what is held is held; where that changed them by more than an error may, or the speed
    /// of a motor or of a pin jumps, the work of the jump.
    fn restore(&mut self, _t: f64, _y: &mut [f64]) -> Result<Option<f64>, StepFailure> {
        Ok(None)
    }

    /// Goes on from numbers at a time that were brought there.
    fn go_on_from(&mut self, _t: f64) {}

    /// The first time after `t` at which what it knows is not smooth.
    fn next_corner(&self, _t: f64) -> Option<f64> {
        None
    }

    /// The power of motors with a speed and of pins that move rods.
    fn driven_power(&mut self, _t: f64, _y: &[f64]) -> Result<f64, StepFailure> {
        Ok(0.0)
    }

    /// The multipliers of what is held, where it was read last.
    fn multipliers(&self) -> &[f64] {
        &[]
    }
}

/// Steps between two looks at the clock.
const LOOK: usize = 256;

/// Numbers that are those of the state.
struct PlacesAndMomenta;

impl Reader for PlacesAndMomenta {
    fn read(&mut self, _: f64, y: &[f64], state: &mut State<Vec<f64>>) -> Result<(), StepFailure> {
        let (q, p) = y.split_at(state.q.len());
        state.q.copy_from_slice(q);
        state.p.components_mut().copy_from_slice(p);
        Ok(())
    }
}

/// What reads a method's numbers off, and counts the works of what acts.
pub(crate) fn read_off<'s>(
    scene: &Scene,
    initial: &State<Vec<f64>>,
    method: Box<dyn AdaptiveMethod<Vec<f64>> + 's>,
    reader: Box<dyn Reader + 's>,
    acting: Option<Acting>,
) -> Box<dyn Stepper + 's> {
    let end = scene.timing.horizon();
    let y = vec![0.0; method.moment().y.len()];
    let leads = scene.drives.has_speeds() || scene.moves_rods();
    let driven = (acting.is_some() || leads).then(|| {
        let v = vec![0.0; initial.p.components().len()];
        Worked { acting, to: 0.0, at: initial.clone(), v, of_speeds: 0.0 }
    });
    let own = Own { parts: Vec::new(), states: Vec::new(), like: initial.clone() };
    let again = Moment::new(0.0, y.clone());
    Box::new(Reading {
        method,
        reader,
        end,
        y,
        again,
        before: Vec::new(),
        ends: Vec::new(),
        own,
        driven,
        deadline: None,
    })
}

/// A method that chooses its own steps, read off.
struct Reading<'s> {
    method: Box<dyn AdaptiveMethod<Vec<f64>> + 's>,
    reader: Box<dyn Reader + 's>,
    end: f64,
    y: Vec<f64>,
    /// Where it starts again where what is held was brought back.
    again: Moment<Vec<f64>>,
    /// The method's numbers before its last step, whose polynomial is read off.
    before: Vec<f64>,
    /// The ends of its steps since it was asked last.
    ends: Vec<f64>,
    own: Own,
    driven: Option<Worked>,
    /// When it breaks off.
    deadline: Option<Instant>,
}

/// States within the method's own steps since it was asked last.
struct Own {
    parts: Vec<f64>,
    states: Vec<State<Vec<f64>>>,
    like: State<Vec<f64>>,
}

/// What acts and drives, the time up to which its works are counted, and room for a state and its velocity.
struct Worked {
    acting: Option<Acting>,
    to: f64,
    at: State<Vec<f64>>,
    v: Vec<f64>,
    /// The work of motors with a speed and of pins that move rods.
    of_speeds: f64,
}

/// Gauss' three places in an interval from 0 to 1, and their weights.
const PLACES: [(f64, f64); 3] = [
    (0.112_701_665_379_258_3, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

impl Reading<'_> {
    /// Keeps the states within the method's last step, and at its end.
    fn keep_last(&mut self) -> Result<(), StepFailure> {
        let (to, Some(from)) = (self.method.moment().t, self.method.last_begin()) else {
            return Ok(());
        };
        for &part in self.own.parts.iter().chain(&[1.0]) {
            let t = if part < 1.0 { from + part * (to - from) } else { to };
            self.method.interpolate(t, &mut self.y)?;
            let mut state = self.own.like.clone();
            self.reader.read(t, &self.y, &mut state)?;
            state.t = t;
            self.own.states.push(state);
        }
        Ok(())
    }

    /// Counts the works up to a time within the method's last step.
    fn count_works(&mut self, to: f64) -> Result<(), StepFailure> {
        let Some(Worked { acting, to: from, at, v, of_speeds }) = &mut self.driven else {
            return Ok(());
        };
        let to = to.min(self.method.moment().t);
        let length = to - *from;
        if length > 0.0 {
            for (place, weight) in PLACES {
                let t = *from + place * length;
                self.method.interpolate(t, &mut self.y)?;
                *of_speeds += weight * length * self.reader.driven_power(t, &self.y)?;
                if let Some(acting) = acting {
                    self.reader.read(t, &self.y, at)?;
                    let (q, p) = (&at.q, at.p.components());
                    acting.velocity(p, v);
                    acting.add_powers(weight * length, t, q, p, v);
                }
            }
            *from = to;
        }
        Ok(())
    }
}

impl Stepper for Reading<'_> {
    /// Steps past the time `to` where that is needed, and reads the state there.
    fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        _: f64,
        to: f64,
    ) -> Result<Stepped, StepFailure> {
        let before = *self.method.work();
        self.ends.clear();
        self.own.states.clear();
        if let Some(driven) = &mut self.driven {
            driven.of_speeds = 0.0;
            driven.acting.iter_mut().for_each(Acting::begin);
        }
        if self.method.last_begin().is_some() {
            self.count_works(to)?;
        }
        while self.method.moment().t < to {
            let t = self.method.moment().t;
            self.again.clone_from(self.method.moment());
            if let Some(work) = self.reader.restore(t, &mut self.again.y)? {
                self.method.restart(&self.again)?;
                self.driven.iter_mut().for_each(|driven| driven.of_speeds += work);
            }
            self.before.clear();
            self.method.visit(&mut |number| self.before.push(*number));
            // A step ends where a strength is not smooth: none is passed over.
            let acting = self.driven.as_ref().and_then(|driven| driven.acting.as_ref());
            let corners =
                [acting.and_then(|acting| acting.next_corner(t)), self.reader.next_corner(t)];
            let end = corners.into_iter().flatten().fold(self.end, f64::min);
            self.method.step(end)?;
            self.ends.push(self.method.moment().t);
            if self.ends.len().is_multiple_of(LOOK)
                && self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
            {
                return Err(StepFailure::TimeIsOver);
            }
            self.count_works(to)?;
            if !self.own.parts.is_empty() {
                self.keep_last()?;
            }
        }
        self.method.interpolate(to, &mut self.y)?;
        self.reader.read(to, &self.y, state)?;
        state.t = to;
        let after = self.method.work();
        let since = |count: fn(&Work) -> u64| (count(after) - count(&before)) as u32;
        Ok(Stepped::done(StepReport {
            differentials: since(|work| work.evaluations),
            hessians: since(|work| work.factorizations),
            ..StepReport::default()
        }))
    }

    fn reads_off(&self) -> bool {
        true
    }

    fn own_ends(&self) -> &[f64] {
        &self.ends
    }

    fn keep_own(&mut self, parts: &[f64]) {
        self.own.parts = parts.to_vec();
    }

    fn break_off_at(&mut self, deadline: Option<Instant>) {
        self.deadline = deadline;
    }

    fn own_states(&self) -> &[State<Vec<f64>>] {
        &self.own.states
    }

    fn works(&self) -> &[f64] {
        let acting = self.driven.as_ref().and_then(|driven| driven.acting.as_ref());
        acting.map_or(&[], Acting::works)
    }

    fn driven_work(&self) -> f64 {
        self.driven.as_ref().map_or(0.0, |driven| driven.of_speeds)
    }

    fn multipliers(&self) -> &[f64] {
        self.reader.multipliers()
    }

    fn save(&mut self) -> Saved {
        if self.before.is_empty() {
            return self.method.save();
        }
        // Its last step is taken once more, for the polynomial within it.
        Saved { method: self.method.facts().name.to_owned(), numbers: self.before.clone() }
    }

    fn load(&mut self, before: &Before) -> Result<(), CheckpointError> {
        if let Some(driven) = &mut self.driven {
            // The works up to the checkpoint's last sample are in its samples.
            driven.to = before.state.t;
        }
        self.method.load(&before.memory)?;
        self.reader.go_on_from(self.method.moment().t);
        Ok(())
    }
}

/// The method that chooses its own steps, at the scene's start.
fn adaptive<'s>(
    method: Adaptive,
    problem: &'s SceneProblem,
    force: Option<Acting>,
    tolerance: f64,
) -> Result<Box<dyn AdaptiveMethod<Vec<f64>> + 's>, AssemblyError> {
    let system = &problem.system;
    let field = MechanicalField::forced(system, force)?;
    let initial = &problem.initial;
    let y = initial.q.iter().chain(initial.p.components()).copied().collect();
    let start = Moment::new(0.0, y);
    let control =
        StepControl::from(Tolerance::componentwise(tolerance, allowed(problem, tolerance))?);
    Ok(match method {
        Adaptive::DormandPrince853 => Box::new(DormandPrince853::new(field, control, start)?),
        Adaptive::DormandPrince54 => Box::new(DormandPrince54::new(field, control, start)?),
        Adaptive::RadauIia5 => Box::new(RadauIia5::new(field, control, start)?),
        Adaptive::BackwardDifferences => Box::new(BackwardDifferences::new(field, control, start)?),
    })
}

/// The absolute tolerance of each position and momentum: that part of the scene's size, and of each
/// particle's momentum at the scene's fastest speed, or where all is at rest at its size over its
/// horizon.
fn allowed(problem: &SceneProblem, tolerance: f64) -> Vec<f64> {
    let system = &problem.system;
    let n = system.dim();
    let mut v = vec![0.0; n];
    system.metric().sharp(problem.initial.p.view(), Vector(v.as_mut_slice()));
    let speed = v.iter().fold(problem.scale / problem.horizon, |speed, v| speed.max(v.abs()));
    let mut p = vec![0.0; n];
    system.metric().flat(Vector(vec![speed; n].as_slice()), Covector(p.as_mut_slice()));
    let q = std::iter::repeat_n(tolerance * problem.scale, n);
    q.chain(p.into_iter().map(|p| tolerance * p)).collect()
}
