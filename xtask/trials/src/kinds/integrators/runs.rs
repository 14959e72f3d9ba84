//! Every adaptive method on a problem, asked for its states at some times.

use std::ops::ControlFlow;

use stationary_calculus::{Covector, DiagonalMetric, Potential, Sink, System};
use stationary_integrators::{
    AdaptiveError, AdaptiveMethod, BackwardDifferences, DormandPrince853, Jacobian,
    MechanicalField, Moment, Nystrom, NystromMethod8, NystromMethod12, NystromPair, OutputTimes,
    Pair8, Pair12, RadauIia5, State, StepControl, Tolerance, VectorField, integrate,
};

use super::problem::InitialValue;
use crate::Draw;

/// An adaptive method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Adaptive {
    DormandPrince,
    Radau,
    /// Up to this order.
    BackwardDifferences(usize),
    Nystrom8,
    Nystrom12,
}

/// Where an implicit method's Jacobian comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Derivatives {
    Written,
    Differences,
}

/// How a Nystrom pair is run: by its own run, or as one adaptive method among the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    Run,
    Method,
}

/// A method with its settings.
#[derive(Clone, Debug)]
pub struct Setting {
    pub method: Adaptive,
    pub derivatives: Derivatives,
    pub way: Way,
    pub relative: f64,
    pub absolute: Vec<f64>,
}

/// Steps that a run may try.
const MOST_STEPS: u64 = 300_000;

impl Setting {
    /// A method that suits the problem, with tolerances of different sizes.
    pub fn draw(draw: &mut Draw, problem: &InitialValue) -> Self {
        let implicit = [Adaptive::Radau, Adaptive::BackwardDifferences(draw.one_of(&[5, 2, 5, 1]))];
        let method = match (problem.stiff, problem.masses.is_some()) {
            (true, _) => draw.one_of(&implicit),
            (false, true) => match draw.below(8) {
                0..=2 => Adaptive::Nystrom12,
                3..=5 => Adaptive::Nystrom8,
                6 => Adaptive::DormandPrince,
                _ => draw.one_of(&implicit),
            },
            (false, false) => match draw.chance(0.5) {
                false => Adaptive::DormandPrince,
                true => draw.one_of(&implicit),
            },
        };
        let finest: f64 = match method {
            Adaptive::DormandPrince | Adaptive::Nystrom8 | Adaptive::Nystrom12 => 1e-11,
            Adaptive::Radau => 1e-9,
            Adaptive::BackwardDifferences(1) => 1e-4,
            Adaptive::BackwardDifferences(2) => 1e-6,
            Adaptive::BackwardDifferences(_) => 1e-8,
        };
        // Loose tolerances are where an estimate fails.
        let loose = problem.stiff && draw.chance(0.5);
        let finest = if loose { finest.max(1e-4) } else { finest };
        let relative = draw.log_uniform(1e-2, finest);
        let common = if draw.chance(0.5) { draw.log_uniform(1.0, 1e-4) } else { 1.0 };
        let one_by_one = draw.chance(0.3);
        let mut part = |size: &f64| {
            let own = if one_by_one { draw.log_uniform(1.0, 1e-3) } else { 1.0 };
            relative * common * own * size
        };
        let absolute = problem.sizes.iter().map(&mut part).collect();
        let derivatives =
            if draw.chance(0.5) { Derivatives::Differences } else { Derivatives::Written };
        let way = if draw.chance(0.5) { Way::Method } else { Way::Run };
        Setting { method, derivatives, way, relative, absolute }
    }

    /// What is tolerated in each component of a state, in units of the relative tolerance.
    pub fn scale(&self, y: &[f64]) -> Vec<f64> {
        let parts = self.absolute.iter().zip(y);
        parts.map(|(a, y)| a / self.relative + y.abs()).collect()
    }

    /// The states at ascending times, the last of which is the end.
    pub fn states(
        &self,
        problem: &InitialValue,
        times: &[f64],
    ) -> Result<Vec<Vec<f64>>, AdaptiveError> {
        let control = |absolute: &[f64]| {
            let tolerance = Tolerance::componentwise(self.relative, absolute.to_vec());
            let control = StepControl::from(tolerance.expect("tolerances in their ranges"));
            control.most_steps(MOST_STEPS).expect("a bound above zero")
        };
        let control = control(&self.absolute);
        let start = Moment::new(0.0, problem.start.clone());
        let masses = problem.masses.as_ref().filter(|_| {
            matches!(self.method, Adaptive::Nystrom8 | Adaptive::Nystrom12)
                || self.way == Way::Method
        });
        if let Some(masses) = masses {
            let metric = DiagonalMetric::new(masses.clone()).expect("positive masses");
            let system = System::new(metric, Forces(problem)).expect("one size");
            return match (self.method, self.way) {
                (Adaptive::Nystrom8, Way::Method) => {
                    read(NystromMethod8::new(&system, control, start)?, times)
                }
                (Adaptive::Nystrom12, Way::Method) => {
                    read(NystromMethod12::new(&system, control, start)?, times)
                }
                (Adaptive::Nystrom8, _) => nystrom::<Pair8, 9>(&system, control, &start, times),
                (Adaptive::Nystrom12, _) => nystrom::<Pair12, 17>(&system, control, &start, times),
                _ => self.first_order(&MechanicalField::new(&system), control, start, times),
            };
        }
        let field = Field { problem, derivatives: self.derivatives };
        self.first_order(&field, control, start, times)
    }

    fn first_order(
        &self,
        field: &impl VectorField,
        control: StepControl,
        start: Moment<Vec<f64>>,
        times: &[f64],
    ) -> Result<Vec<Vec<f64>>, AdaptiveError> {
        match self.method {
            Adaptive::Radau => read(RadauIia5::new(field, control, start)?, times),
            Adaptive::BackwardDifferences(highest) => {
                let method = BackwardDifferences::of_order_at_most(highest, field, control, start)?;
                read(method, times)
            }
            _ => read(DormandPrince853::new(field, control, start)?, times),
        }
    }
}

/// The states that dense output gives at these times; the last is the end itself.
fn read(
    mut method: impl AdaptiveMethod<Vec<f64>>,
    times: &[f64],
) -> Result<Vec<Vec<f64>>, AdaptiveError> {
    let mut output = OutputTimes::new(method.moment().y.len(), times)?;
    let mut states = Vec::new();
    let mut fault = None;
    let end = *times.last().expect("a time");
    integrate(&mut method, end, |mut step| {
        match output.within(&mut step, |_, y| states.push(y.to_vec())) {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                fault = Some(error);
                ControlFlow::Break(())
            }
        }
    })?;
    fault.map_or(Ok(states), Err)
}

fn nystrom<T: NystromPair<S>, const S: usize>(
    system: &System<DiagonalMetric<Vec<f64>>, Forces<'_>>,
    control: StepControl,
    start: &Moment<Vec<f64>>,
    times: &[f64],
) -> Result<Vec<Vec<f64>>, AdaptiveError> {
    let n = start.y.len() / 2;
    let (q, p) = start.y.split_at(n);
    let mut state = State::new(q.to_vec(), p.to_vec());
    let mut within = state.clone();
    let mut nystrom = Nystrom::<T, _, _, _, S>::new(system, control)?;
    let (mut states, mut fault, mut ahead) = (Vec::new(), None, times);
    nystrom.run(&mut state, *times.last().expect("a time"), |mut step| {
        while let [t, rest @ ..] = ahead {
            if *t > step.after.t {
                break;
            }
            if let Err(error) = step.at(*t, &mut within) {
                fault = Some(error);
                return ControlFlow::Break(());
            }
            states.push([&within.q[..], within.p.components()].concat());
            ahead = rest;
        }
        ControlFlow::Continue(())
    })?;
    fault.map_or(Ok(states), Err)
}

/// A problem as a field.
pub struct Field<'a> {
    pub problem: &'a InitialValue,
    pub derivatives: Derivatives,
}

impl VectorField for Field<'_> {
    fn dim(&self) -> usize {
        self.problem.dim()
    }

    fn evaluate(&self, t: f64, y: &[f64], f: &mut [f64]) {
        (self.problem.slope)(t, y, f);
    }

    fn jacobian(&self, t: f64, y: &[f64], df: &mut [f64]) -> Jacobian {
        if self.derivatives == Derivatives::Differences {
            return Jacobian::Unknown;
        }
        (self.problem.derivative)(t, y, df);
        Jacobian::Written
    }
}

/// A mechanical problem as a potential.
pub struct Forces<'a>(pub &'a InitialValue);

impl Potential for Forces<'_> {
    fn dim(&self) -> usize {
        self.0.dim() / 2
    }

    fn energy(&self, q: &[f64]) -> f64 {
        self.0.energy.as_ref().map_or(f64::NAN, |energy| energy(q))
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let n = q.len();
        let mut y = vec![0.0; 4 * n];
        y[..n].copy_from_slice(q);
        let (y, f) = y.split_at_mut(2 * n);
        (self.0.slope)(0.0, y, f);
        dv.0.iter_mut().zip(&f[n..]).for_each(|(dv, force)| *dv -= force);
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        let n = q.len();
        let mut y = vec![0.0; 2 * n];
        y[..n].copy_from_slice(q);
        let mut df = vec![0.0; 4 * n * n];
        (self.0.derivative)(0.0, &y, &mut df);
        let freedoms: Vec<usize> = (0..n).collect();
        let block: Vec<f64> = (0..n * n).map(|at| -df[n + at % n + 2 * n * (at / n)]).collect();
        hessian.add_symmetric(&freedoms, &block);
    }
}
