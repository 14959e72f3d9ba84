//! The scene's method at work: one way to step, whatever makes the steps.

use stationary_calculus::{Covector, DiagonalMetric, Flat, Metric, SparseSolver, System, Vector};
use stationary_constraints::{
    ConstrainedHamilton, ConstrainedIntegrator, Many, Rattle, Rods, SchurMultipliers,
    StepAndProject,
};
use stationary_contact::{Balls, Impacting, Inequality};
use stationary_integrators::{
    AdaptiveError, AdaptiveMethod, BackwardDifferences, DampedPattern, DormandPrince853, Drag,
    Facts, Integrator, MechanicalField, Method, Moment, Newmark, NewmarkWeights, RadauIia5, Saved,
    State, StepControl, StepError, StepReport, Tolerance, Work,
};

use crate::error::StepFailure;
use crate::linear_modes::{LinearModes, Moving};
use crate::run::{BrokenRod, Impacts};
use crate::stepping::{Adaptive, Constrained, Stepping};
use crate::system::{ScenePotential, SceneProblem};
use crate::{AssemblyError, Scene, SceneContact};

type Masses = DiagonalMetric<Vec<f64>>;
type Breaking<'s, const D: usize> =
    Rattle<'s, Masses, ScenePotential<D>, Flat, Rods<D>, Vec<f64>, SchurMultipliers>;

/// A scene's method, bound to its system.
pub(crate) enum Stepper<'s, const D: usize> {
    Equal(Box<dyn Integrator<Vec<f64>> + 's>),
    Adaptive(Box<Reading<'s>>),
    Constrained(Box<dyn ConstrainedIntegrator<Vec<f64>> + 's>),
    Rattle(Box<Breaking<'s, D>>),
    LinearModes(Box<Moving<'s>>, &'s Masses),
    Impacting(Box<Impacting<'s, Masses, ScenePotential<D>, Balls<D>>>),
}

/// What a method borrows besides the system.
pub(crate) struct Ground<const D: usize> {
    modes: Option<LinearModes>,
    gaps: Option<Inequality<Balls<D>>>,
}

impl<const D: usize> Ground<D> {
    pub(crate) fn new(scene: &Scene, problem: &SceneProblem<D>) -> Result<Self, AssemblyError> {
        let springs = scene.contact().is_some_and(|contact| contact.stiffness.is_some());
        let gaps = if springs { None } else { scene.gaps()? };
        Ok(Ground { modes: scene.linear_modes(problem)?, gaps })
    }

    /// What making it took.
    pub(crate) fn prepared(&self) -> StepReport {
        self.modes.as_ref().map(LinearModes::prepared).unwrap_or_default()
    }
}

/// A method that chooses its own steps, read off at moments of the scene's choice.
pub(crate) struct Reading<'s> {
    pub(crate) method: Box<dyn AdaptiveMethod<Vec<f64>> + 's>,
    end: f64,
    y: Vec<f64>,
    /// The method's numbers before its last step, whose polynomial is read off.
    pub(crate) before: Vec<f64>,
}

/// What a step did beside moving the state.
pub(crate) struct Stepped {
    pub(crate) report: StepReport,
    /// The rod that broke; its place is that among the rods that were left.
    pub(crate) broken: Option<BrokenRod>,
    pub(crate) impacts: Option<Impacts>,
}

impl Stepped {
    pub(crate) fn done(report: StepReport) -> Self {
        Stepped { report, broken: None, impacts: None }
    }

    /// A step in which the law of impact was applied so often, the last time at this one. To apply
    /// it counts as a differential.
    pub(crate) fn met(count: usize, time: f64) -> Self {
        let report = StepReport { differentials: 1 + count as u32, ..StepReport::default() };
        let impacts = (count > 0).then_some(Impacts { time, count });
        Stepped { impacts, ..Stepped::done(report) }
    }
}

impl<'s, const D: usize> Stepper<'s, D> {
    pub(crate) fn new(
        scene: &Scene,
        problem: &'s SceneProblem<D>,
        ground: &'s Ground<D>,
    ) -> Result<Self, AssemblyError> {
        let (system, initial) = (&problem.system, &problem.initial);
        if let Some(modes) = &ground.modes {
            return Ok(Stepper::LinearModes(Box::new(modes.motion()?), system.metric()));
        }
        if let (Some(gaps), Some(contact)) = (&ground.gaps, &scene.contact) {
            let SceneContact { restitution, law, when, .. } = *contact;
            let impacting = Impacting::new(system, gaps, restitution, law, when)?;
            return Ok(Stepper::Impacting(Box::new(impacting)));
        }
        match scene.stepping {
            Stepping::Equal(method) => match (scene.drag(), scene.rods()) {
                (Some(drag), _) => held_back(method, problem, drag).map(Stepper::Equal),
                (None, []) => Ok(Stepper::Equal(scene.integrator(problem, method)?)),
                (None, _) => {
                    let integrator = Owned(scene.integrator(problem, method)?);
                    let rods = scene.constraint::<D>()?;
                    let kept =
                        StepAndProject::new(integrator, system, rods, initial, Many::default())?;
                    Ok(Stepper::Constrained(Box::new(kept)))
                }
            },
            Stepping::Adaptive { method, tolerance } => {
                let end = scene.timing().horizon();
                let method = adaptive(method, problem, scene.drag(), tolerance)?;
                let y = vec![0.0; 2 * system.dim()];
                Ok(Stepper::Adaptive(Box::new(Reading { method, end, y, before: Vec::new() })))
            }
            Stepping::Constrained(Constrained::Rattle) => {
                let rattle =
                    Rattle::new(system, scene.constraint::<D>()?, initial, Many::default())?;
                Ok(Stepper::Rattle(Box::new(rattle)))
            }
            Stepping::Bodies(_) => Err(AssemblyError::Bodies),
            Stepping::Heat(_) | Stepping::LinearModes { .. } => Err(AssemblyError::Heat),
            Stepping::Constrained(Constrained::Hamilton) => {
                let rods = scene.constraint::<D>()?;
                let kept = ConstrainedHamilton::new(system, rods, initial, Many::default())?;
                Ok(Stepper::Constrained(Box::new(kept)))
            }
        }
    }

    /// Makes the state one that the method can be in: of modes, what they know of it.
    pub(crate) fn start(&mut self, state: &mut State<Vec<f64>>) -> Result<(), AssemblyError> {
        match self {
            Stepper::LinearModes(moving, metric) => Ok(moving.at(0.0, *metric, state)?),
            _ => Ok(()),
        }
    }

    /// Moves the state by the scene's step `h`, to the time `to`.
    pub(crate) fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        to: f64,
    ) -> Result<Stepped, StepFailure> {
        let done = Stepped::done;
        match self {
            Stepper::Equal(integrator) => Ok(done(integrator.step(state, h)?)),
            Stepper::Adaptive(reading) => Ok(done(reading.step(state, to)?)),
            Stepper::Constrained(integrator) => {
                let report = integrator.step(state, h)?;
                Ok(done(counted(report.differentials, report.iterations)))
            }
            Stepper::Impacting(impacting) => {
                let met = impacting.step(state, h)?;
                Ok(Stepped::met(met.impacts, met.last_impact))
            }
            Stepper::LinearModes(moving, metric) => {
                moving.at(to, *metric, state)?;
                Ok(done(StepReport::default()))
            }
            Stepper::Rattle(rattle) => {
                let (report, broken) = rattle.step_and_break(state, h, Many::default())?;
                let broken = broken.map(|broken| BrokenRod {
                    rod: broken.index,
                    time: to,
                    tension: broken.tension,
                });
                let report = counted(report.differentials, report.iterations);
                Ok(Stepped { broken, ..done(report) })
            }
        }
    }

    /// The multipliers of the rods that are left, none where rods are not held by forces.
    pub(crate) fn multipliers(&self) -> &[f64] {
        match self {
            Stepper::Equal(_)
            | Stepper::Adaptive(_)
            | Stepper::LinearModes(..)
            | Stepper::Impacting(_) => &[],
            Stepper::Constrained(integrator) => integrator.multipliers(),
            Stepper::Rattle(rattle) => rattle.multipliers(),
        }
    }
}

/// A step towards a feasible configuration counts as a solve.
fn counted(differentials: u32, iterations: u32) -> StepReport {
    StepReport { differentials, hessians: iterations, ..StepReport::default() }
}

/// An integrator behind a pointer is one.
struct Owned<'s>(Box<dyn Integrator<Vec<f64>> + 's>);

impl Integrator<Vec<f64>> for Owned<'_> {
    fn facts(&self) -> Facts {
        self.0.facts()
    }

    fn step(&mut self, state: &mut State<Vec<f64>>, h: f64) -> Result<StepReport, StepError> {
        self.0.step(state, h)
    }

    fn save(&self) -> Saved {
        self.0.save()
    }

    fn load(&mut self, saved: &Saved) -> Result<(), StepError> {
        self.0.load(saved)
    }
}

/// The method of equal steps that takes the force of drag.
fn held_back<'s, const D: usize>(
    method: Method,
    problem: &'s SceneProblem<D>,
    coefficient: f64,
) -> Result<Box<dyn Integrator<Vec<f64>> + 's>, AssemblyError> {
    let system = &problem.system;
    // The scene has been asked whether its method takes forces.
    let weights = method.newmark_weights().unwrap_or(NewmarkWeights::AVERAGE_ACCELERATION);
    let drag = drag(system, coefficient)?;
    if crate::system::few(system.dim()) {
        return Ok(Box::new(Newmark::with_force(system, weights, drag)?));
    }
    let pattern = DampedPattern { potential: system.potential(), force: &drag };
    let solver = SparseSolver::new(system.metric(), &pattern, &problem.initial.q)?;
    Ok(Box::new(Newmark::with_force_and_solver(system, weights, drag, solver)?))
}

fn drag<const D: usize>(
    system: &System<Masses, ScenePotential<D>>,
    coefficient: f64,
) -> Result<Drag<Vec<f64>>, AssemblyError> {
    Ok(Drag::new(vec![coefficient; system.dim()])?)
}

/// The method that chooses its own steps, at the scene's start.
fn adaptive<'s, const D: usize>(
    method: Adaptive,
    problem: &'s SceneProblem<D>,
    coefficient: Option<f64>,
    tolerance: f64,
) -> Result<Box<dyn AdaptiveMethod<Vec<f64>> + 's>, AssemblyError> {
    let system = &problem.system;
    let drag = coefficient.map(|coefficient| drag(system, coefficient)).transpose()?;
    let field = MechanicalField::forced(system, drag)?;
    let initial = &problem.initial;
    let y = initial.q.iter().chain(initial.p.components()).copied().collect();
    let start = Moment::new(0.0, y);
    let control =
        StepControl::from(Tolerance::componentwise(tolerance, allowed(problem, tolerance))?);
    Ok(match method {
        Adaptive::DormandPrince853 => Box::new(DormandPrince853::new(field, control, start)?),
        Adaptive::RadauIia5 => Box::new(RadauIia5::new(field, control, start)?),
        Adaptive::BackwardDifferences => Box::new(BackwardDifferences::new(field, control, start)?),
    })
}

/// The absolute tolerance of each position and momentum: that part of the scene's size, and of each
/// particle's momentum at the scene's fastest speed, or where all is at rest at its size over its
/// horizon.
fn allowed<const D: usize>(problem: &SceneProblem<D>, tolerance: f64) -> Vec<f64> {
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

impl Reading<'_> {
    /// Steps past the time `to` where that is needed, and reads the state there.
    fn step(&mut self, state: &mut State<Vec<f64>>, to: f64) -> Result<StepReport, AdaptiveError> {
        let before = *self.method.work();
        while self.method.moment().t < to {
            self.before.clear();
            self.method.visit(&mut |number| self.before.push(*number));
            self.method.step(self.end)?;
        }
        self.method.interpolate(to, &mut self.y)?;
        let (q, p) = self.y.split_at(state.q.len());
        state.q.copy_from_slice(q);
        state.p.components_mut().copy_from_slice(p);
        let after = self.method.work();
        let since = |count: fn(&Work) -> u64| (count(after) - count(&before)) as u32;
        Ok(StepReport {
            differentials: since(|work| work.evaluations),
            hessians: since(|work| work.factorizations),
            ..StepReport::default()
        })
    }
}
