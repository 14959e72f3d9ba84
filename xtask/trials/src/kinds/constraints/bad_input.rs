//! Every constructor and function of the crate with bad numbers and sizes.

use nalgebra::DVector;
use stationary_calculus::{
    Automatic, Covector, DiagonalMetric, Energy, Newton, Number, Potential, System, Vector,
};
use stationary_constraints::{
    ArcsinePendulum, ConstrainedHamilton, ConstrainedIntegrator, Constraint, ConstraintError,
    Dense, FixedPoint, Function, FunctionConstraint, Level, LevelSet, Linear, Links, Pairing,
    Penalty, Projection, Rattle, Reduced, Redundancy, Rod, Rods, Rows, Sampling, SparseDiagonal,
    SparseGeneral, StepAndProject, Weight, critical_point, problems,
};
use stationary_integrators::{State, StormerVerlet, UniformGravity};

use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "bad-input-constraints",
    krate: "constraints",
    rule: "a panic; Ok where numbers or sizes are bad, or Ok with a state that is not finite",
    in_tests: 2000,
    trial,
};

fn trial(draw: &mut Draw) -> Verdict {
    match draw.below(8) {
        0 => states(draw),
        1 => constructors(draw),
        2 => short(draw),
        3 => optimization(draw),
        4 => coordinates(draw),
        5 => penalties(draw),
        6 => pendulums(draw),
        _ => sizes(draw),
    }
}

/// A finite number, or any.
fn number(draw: &mut Draw, good: f64, bad: f64) -> f64 {
    if draw.chance(bad) { draw.any_f64() } else { good }
}

fn finite(state: &State<Vec<f64>>) -> bool {
    state.t.is_finite() && state.q.iter().chain(&state.p.0).all(|x| x.is_finite())
}

type Gravity = System<DiagonalMetric<Vec<f64>>, UniformGravity<2>>;

fn hanging(n: usize) -> Option<Gravity> {
    let metric = DiagonalMetric::new(vec![1.0; 2 * n]).ok()?;
    let gravity = UniformGravity { acceleration: [0.0, -1.0], masses: vec![1.0; n] };
    System::new(metric, gravity).ok()
}

/// A double pendulum from a state with a bad number, by every method and solver.
fn states(draw: &mut Draw) -> Verdict {
    let Some(system) = hanging(2) else { return Verdict::wrong("no system") };
    let rods = vec![Rod::new([2, 0], 1.0), Rod::new([0, 1], 1.0)];
    let Ok(rods) = Rods::new(2, vec![[0.0; 2]], rods) else { return Verdict::wrong("no rods") };
    let mut state =
        State { t: 0.0, q: vec![0.0, -1.0, 1.0, -1.0], p: Covector(vec![0.2, 0.0, 0.2, 0.1]) };
    let mut h = 0.01;
    let bad = draw.any_f64();
    let place = draw.below(10);
    match place {
        0..=3 => state.q[place] = bad,
        4..=7 => state.p.0[place - 4] = bad,
        8 => state.t = bad,
        _ => h = bad,
    }
    let late = draw.chance(0.5);
    let (way, solver) = (draw.below(4), draw.below(3));
    draw.note(format!("{bad:e} at {place}, h {h:e}, late {late}, way {way}, solver {solver}"));
    let good =
        State { t: 0.0, q: vec![0.0, -1.0, 1.0, -1.0], p: Covector(vec![0.2, 0.0, 0.2, 0.1]) };
    let start = if late { &good } else { &state };
    type Made<'s> = Result<Box<dyn ConstrainedIntegrator<Vec<f64>> + 's>, ConstraintError>;
    macro_rules! with {
        ($choice:expr) => {
            match way {
                0 => Rattle::new(&system, rods, start, $choice)
                    .map(|m| Box::new(m) as Box<dyn ConstrainedIntegrator<Vec<f64>>>),
                1 => ConstrainedHamilton::new(&system, rods, start, $choice)
                    .map(|m| Box::new(m) as Box<dyn ConstrainedIntegrator<Vec<f64>>>),
                2 => match StormerVerlet::new(&system) {
                    Ok(verlet) => StepAndProject::new(verlet, &system, rods, start, $choice)
                        .map(|m| Box::new(m) as Box<dyn ConstrainedIntegrator<Vec<f64>>>),
                    Err(_) => return Verdict::wrong("no method"),
                },
                _ => {
                    let projected = Projection::new(&system, rods, start, $choice)
                        .and_then(|mut projection| projection.project(&mut state));
                    return match projected {
                        Ok(_) if !finite(&state) => {
                            Verdict::wrong("projects to what is not finite")
                        }
                        _ => Verdict::due(),
                    };
                }
            }
        };
    }
    let made: Made<'_> = match solver {
        0 => with!(Dense::<2>(Redundancy::Refuse)),
        1 => with!(SparseDiagonal(Redundancy::LeastNorm)),
        _ => with!(SparseGeneral),
    };
    let Ok(mut method) = made else { return Verdict::due() };
    if !finite(start) {
        return Verdict::wrong("starts from what is not finite");
    }
    let d = [start.q[2] - start.q[0], start.q[3] - start.q[1]];
    let p = &start.p.0;
    let rates =
        [start.q[0] * p[0] + start.q[1] * p[1], d[0] * (p[2] - p[0]) + d[1] * (p[3] - p[1])];
    let fast = p.iter().fold(1e-3_f64, |a, p| a.max(p.abs()));
    if rates.iter().any(|rate| rate.abs() > 1e-6 * fast) {
        return Verdict::wrong(format!("starts with rods that are stretched at {rates:?}"));
    }
    for _ in 0..3 {
        let before = state.clone();
        match method.step(&mut state, h) {
            Ok(report) => {
                let told = report.violation.is_finite() && report.work.is_finite();
                let multipliers = method.multipliers().iter().all(|l| l.is_finite());
                if !(finite(&state) && told && multipliers) {
                    return Verdict::wrong("a step leads to what is not finite");
                }
            }
            Err(_) => {
                let same =
                    |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits());
                return match same(&state.q, &before.q) && same(&state.p.0, &before.p.0) {
                    true => Verdict::due(),
                    false => Verdict::wrong("a failed step moved the state"),
                };
            }
        }
    }
    Verdict::due()
}

fn constructors(draw: &mut Draw) -> Verdict {
    let (bad, vertex) = (draw.any_f64(), draw.one_of(&[0, 1, 2, 3, usize::MAX / 4]));
    let good = bad.is_finite();
    draw.note(format!("{bad:e}, vertex {vertex}"));
    match draw.below(5) {
        0 => {
            let rod = Rod::new([draw.below(4), vertex], bad).with_strength(draw.any_f64());
            let made = Rods::<2>::new(2, vec![[0.0; 2]; 1], vec![rod]);
            match made {
                Ok(_) if !(bad > 0.0 && good) || vertex > 2 => Verdict::wrong("a bad rod is taken"),
                _ => Verdict::due(),
            }
        }
        1 => match Rods::<2>::new(1, vec![[bad, 0.0]], vec![Rod::new([0, 1], 1.0)]) {
            Ok(_) if !good => Verdict::wrong("a hook that is not finite is taken"),
            _ => Verdict::due(),
        },
        2 => match FixedPoint::new(vertex.min(3), [bad, 0.0]) {
            Ok(_) if !good => Verdict::wrong("a place that is not finite is taken"),
            _ => Verdict::due(),
        },
        3 => match Linear::new(vec![(vec![(0, bad), (vertex.min(3), 1.0)], draw.any_f64())]) {
            Ok(_) if !good => Verdict::wrong("a coefficient that is not finite is taken"),
            _ => Verdict::due(),
        },
        _ => match problems::pendulum(bad) {
            Ok(made) if !finite_all(&[&made.problem.initial.q, &made.problem.initial.p.0]) => {
                Verdict::wrong("a pendulum that is not finite")
            }
            _ => Verdict::due(),
        },
    }
}

fn finite_all(numbers: &[&[f64]]) -> bool {
    numbers.iter().all(|numbers| numbers.iter().all(|x| x.is_finite()))
}

#[derive(Debug)]
struct Circle;

impl Function<2, 1> for Circle {
    fn value<R: Number>(&self, t: R, [x, y]: [R; 2]) -> [R; 1] {
        [x * x + y * y - t.cos()]
    }
}

impl Level<2> for Circle {
    fn value<R: Number>(&self, t: R, [x, y]: [R; 2]) -> R {
        x * x + y * y - t.cos()
    }
}

struct Count(usize);

impl Rows for Count {
    fn add(&mut self, _: usize, _: usize, _: f64) {
        self.0 += 1;
    }
}

/// Numbers of a sum of second differentials, looked at and forgotten.
struct Blocks;

impl stationary_calculus::Sink for Blocks {
    fn add_symmetric(&mut self, _: &[usize], _: &[f64]) {}
}

/// A constraint asked of too few numbers, or too many.
fn short(draw: &mut Draw) -> Verdict {
    let stored = draw.below(7);
    let q: Vec<f64> = (0..stored).map(|_| draw.any_f64()).collect();
    let given = draw.below(5);
    let t = draw.any_f64();
    let which = draw.below(7);
    draw.note(format!("constraint {which}, q {q:?}, {given} values"));
    let rods =
        Rods::<2>::new(2, vec![[0.0; 2]], vec![Rod::new([2, 0], 1.0), Rod::new([0, 1], 1.0)]);
    let line = || Linear::new(vec![(vec![(1, 1.0), (3, 2.0)], 0.5)]);
    let (Ok(rods), Ok(line), Ok(point), Ok(two)) =
        (rods, line(), FixedPoint::new(1, [0.0, 0.5]), FunctionConstraint::new(Circle, [1, 3]))
    else {
        return Verdict::wrong("good constraints are refused");
    };
    match which {
        0 => asked(&rods, t, &q, given),
        1 => asked(&line, t, &q, given),
        2 => asked(&point, t, &q, given),
        3 => asked(&two, t, &q, given),
        4 => asked(&LevelSet::new(1, Circle), t, &q, given),
        5 => asked(&(rods, line, point), t, &q, given),
        _ => asked(&vec![point, point], t, &q, given),
    }
}

fn asked(constraint: &impl Constraint, t: f64, q: &[f64], given: usize) -> Verdict {
    let mut g = vec![0.0; given];
    let (enough, fit) = (q.len() >= constraint.dim(), given == constraint.count());
    let mut count = Count(0);
    let asked = [
        ("a value", enough && fit, constraint.value(t, q, &mut g).is_ok()),
        ("a differential", enough, constraint.differential(t, q, &mut count).is_ok()),
        (
            "a second differential",
            enough && fit,
            constraint.add_hessian(t, q, &g, &mut Blocks).is_ok(),
        ),
    ];
    if let Some((what, possible, _)) = asked.into_iter().find(|&(_, possible, is)| is != possible) {
        return Verdict::wrong(match possible {
            true => format!("{what} of right sizes is refused"),
            false => format!("{what} of sizes that do not fit"),
        });
    }
    if !fit && constraint.rate(t, q, &mut g).is_ok() {
        return Verdict::wrong("a rate of sizes that do not fit");
    }
    for row in [0, 1, 7] {
        let scale = constraint.scale(row);
        if !(scale.slope > 0.0 && scale.length > 0.0) {
            return Verdict::wrong("a scale that is not positive");
        }
    }
    let Ok(pairing) = Pairing::new(constraint, g, t) else {
        return if fit { Verdict::wrong("good multipliers are refused") } else { Verdict::due() };
    };
    if !fit {
        return Verdict::wrong("multipliers that do not fit are taken");
    }
    let mut dv = vec![0.0; constraint.dim()];
    if !enough && pairing.energy(q).is_finite() {
        return Verdict::wrong("too few numbers have a pairing");
    }
    pairing.add_differential(q, Covector(&mut dv));
    pairing.add_hessian(q, &mut Blocks);
    Verdict::due()
}

struct Bowl;

impl Energy<2> for Bowl {
    fn energy<R: Number>(&self, [x, y]: [R; 2]) -> R {
        x * x + y * y * 2.0 + x
    }
}

fn optimization(draw: &mut Draw) -> Verdict {
    let mut guess = vec![0.3, 0.8, 0.1];
    guess.truncate(draw.between(0, 3));
    if let Some(first) = guess.first_mut() {
        *first = number(draw, 0.3, 0.8);
    }
    let tolerance = number(draw, Newton::default().tolerance, 0.3);
    let newton = Newton { tolerance, ..Newton::default() };
    draw.note(format!("guess {guess:?}, tolerance {tolerance:e}"));
    match critical_point(&Automatic(Bowl), &LevelSet::new(0, Circle), &guess, newton) {
        Ok(point) => {
            let finite = finite_all(&[&point.q, &point.multipliers, &point.curvatures]);
            let on = (point.q[0].hypot(point.q[1]) - 1.0).abs() < 1e-6;
            match finite && (on || tolerance > 1e-6) {
                true => Verdict::due(),
                false => Verdict::wrong(format!("a critical point that is none: {point:?}")),
            }
        }
        Err(_) => Verdict::due(),
    }
}

fn coordinates(draw: &mut Draw) -> Verdict {
    let masses = [number(draw, 1.0, 0.3), 1.0, 1.0, number(draw, 2.0, 0.3)];
    let lengths = [number(draw, 1.0, 0.3), 0.5];
    let weight = Weight { masses: [1.0, 1.0], gravity: number(draw, 1.0, 0.3) };
    let s = [number(draw, 0.4, 0.3), -0.3];
    draw.note(format!("masses {masses:?}, lengths {lengths:?}, {weight:?}, s {s:?}"));
    let made = Reduced::<_, _, 2, 4>::new(Links::new(lengths), masses, weight, Sampling::Both);
    let Ok(reduced) = made else { return Verdict::due() };
    let rate = Vector([0.1, number(draw, 0.2, 0.3)]);
    let _ = (reduced.places(s), reduced.momentum(s, rate), reduced.total_energy(s, rate));
    match reduced.metric(s) {
        Ok(metric) => {
            let momentum = Covector([1.0, 1.0]);
            let energy = stationary_calculus::Metric::kinetic_energy(&metric, momentum.view());
            match energy.is_finite() && energy > 0.0 {
                true => Verdict::due(),
                false => Verdict::wrong(format!("a metric that is none: energy {energy}")),
            }
        }
        Err(_) => Verdict::due(),
    }
}

fn penalties(draw: &mut Draw) -> Verdict {
    let (stiffness, time) = (number(draw, 10.0, 0.6), number(draw, 0.0, 0.6));
    draw.note(format!("stiffness {stiffness:e}, time {time:e}"));
    let rods = Rods::<2>::new(1, vec![[0.0; 2]], vec![Rod::new([0, 1], 1.0)]);
    let Ok(rods) = rods else { return Verdict::wrong("no rod") };
    let Ok(penalty) = Penalty::new(rods, stiffness, time) else { return Verdict::due() };
    if !(time.is_finite() && stiffness.is_finite() && stiffness > 0.0) {
        return Verdict::wrong("a penalty at no time or of no stiffness");
    }
    let stored = draw.between(0, 3);
    let q: Vec<f64> = (0..stored).map(|k| 0.6 + 0.2 * k as f64).collect();
    let (energy, mut dv) = (penalty.energy(&q), vec![0.0; 2]);
    penalty.add_differential(&q, Covector(&mut dv));
    penalty.add_hessian(&q, &mut Blocks);
    if stored < 2 && energy.is_finite() {
        return Verdict::wrong("too few numbers have an energy");
    }
    let n = draw.between(1, 3);
    let Ok(metric) = DiagonalMetric::new(vec![2.0; n]) else { return Verdict::wrong("no metric") };
    let frequency = match penalty.highest_frequency(&metric, &q) {
        Ok(_) if n < 2 || stored < 2 => {
            return Verdict::wrong("a frequency of sizes that do not fit");
        }
        Ok(frequency) => frequency,
        Err(error) if n >= 2 && stored >= 2 => return Verdict::wrong(error),
        Err(_) => return Verdict::due(),
    };
    if n == 2 && stored == 2 && stiffness > 1e-100 && stiffness < 1e100 {
        let length = DVector::from_vec(q).norm();
        let expected = (stiffness / 2.0).sqrt() * length;
        return Verdict::of((frequency / expected - 1.0).abs(), 1e-9, "the frequency");
    }
    Verdict::due()
}

fn pendulums(draw: &mut Draw) -> Verdict {
    let (mass, length) = (number(draw, 1.0, 0.4), number(draw, 1.0, 0.4));
    let made = ArcsinePendulum::new(mass, length, number(draw, 1.0, 0.4));
    let Ok(pendulum) = made else { return Verdict::due() };
    if !(mass > 0.0 && length > 0.0) {
        return Verdict::wrong("a pendulum without mass or length");
    }
    let mut state = State::new([number(draw, 0.3, 0.3)], Covector([number(draw, 0.1, 0.3)]));
    state.t = number(draw, 0.0, 0.3);
    let h = number(draw, 0.01, 0.3);
    draw.note(format!("{pendulum:?}, {state:?}, h {h:e}"));
    match pendulum.step(&mut state, h) {
        Ok(()) if !(state.t.is_finite() && state.q[0].is_finite() && state.p.0[0].is_finite()) => {
            Verdict::wrong("a step leads to what is not finite")
        }
        _ => Verdict::due(),
    }
}

/// States, rooms and constraints of other sizes.
fn sizes(draw: &mut Draw) -> Verdict {
    let n = draw.between(0, 3);
    let Some(system) = hanging(n) else { return Verdict::due() };
    let (stored, momenta) = (draw.below(8), draw.below(8));
    let state = State::new(vec![0.5; stored], Covector(vec![0.0; momenta]));
    let point = FixedPoint::new(draw.below(4), [0.5; 2]);
    let Ok(point) = point else { return Verdict::wrong("no point") };
    draw.note(format!("{n} points, {stored} places, {momenta} momenta, {point:?}"));
    let solver = draw.below(3);
    let made = match solver {
        0 => Rattle::new(&system, point, &state, Dense::<1>(Redundancy::Refuse)).map(|_| ()),
        1 => Rattle::new(&system, point, &state, SparseDiagonal(Redundancy::Refuse)).map(|_| ()),
        _ => Projection::new(&system, point, &state, SparseGeneral).map(|_| ()),
    };
    let fits = stored == 2 * n && momenta == 2 * n && point.dim() <= 2 * n && solver != 0;
    match made {
        Ok(()) if !fits => Verdict::wrong("sizes that differ are taken"),
        Err(error) if fits => Verdict::refused(error),
        _ => Verdict::due(),
    }
}
