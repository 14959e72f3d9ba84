//! Every public function with bad numbers, wrong sizes and empty input: it may refuse, but neither
//! panic nor hide a number that is not finite behind an Ok.

use std::fmt::Debug;
use std::ops::ControlFlow;

use nalgebra::DMatrix;
use stationary_calculus::{
    BilinearForm, Covector, DiagonalMetric, Energy, Metric, Number, Potential, Sink, System, Vector,
};
use stationary_integrators::problems;
use stationary_integrators::*;

use crate::{Draw, Verdict};

/// Draws one of the functions.
pub fn trial(draw: &mut Draw) -> Verdict {
    let functions: [fn(&mut Draw) -> Verdict; 16] = [
        fixed_step,
        horizons,
        adaptive,
        saved,
        empty,
        nystrom,
        outputs_and_events,
        impulses,
        forces,
        weights,
        known_problems,
        lagrangians,
        reversible,
        split,
        momenta,
        controls,
    ];
    let function = draw.below(functions.len());
    draw.note(format!("function {function}"));
    functions[function](draw)
}

/// Mostly harmless, sometimes anything.
fn number(draw: &mut Draw) -> f64 {
    if draw.chance(0.3) { draw.any_f64() } else { draw.symmetric() }
}

fn positive(draw: &mut Draw) -> f64 {
    if draw.chance(0.4) { draw.any_f64() } else { draw.log_uniform(1e-2, 10.0) }
}

fn numbers(draw: &mut Draw, n: usize) -> Vec<f64> {
    (0..n).map(|_| number(draw)).collect()
}

/// The right length, mostly.
fn length(draw: &mut Draw, n: usize) -> usize {
    if draw.chance(0.2) { draw.below(n + 3) } else { n }
}

fn are_finite<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> bool {
    numbers.into_iter().all(|x| x.is_finite())
}

/// An error is right; an answer must be finite.
fn judge<E: Debug>(what: &str, answer: Result<Vec<f64>, E>) -> Verdict {
    match answer {
        Ok(answer) if !are_finite(&answer) => Verdict::wrong(format!("{what}: Ok with {answer:?}")),
        _ => Verdict::due(),
    }
}

fn of_state(state: &State<Vec<f64>>) -> Vec<f64> {
    let numbers = state.q.iter().chain(state.p.components());
    numbers.copied().chain([state.t]).collect()
}

fn planet() -> System<DiagonalMetric<[f64; 2]>, CentralGravity<2>> {
    let metric = DiagonalMetric::new([1.0; 2]).expect("masses");
    System::new(metric, CentralGravity { strength: 1.0 }).expect("one size")
}

fn state(draw: &mut Draw, n: usize) -> State<Vec<f64>> {
    let [q, p] = [length(draw, n), length(draw, n)].map(|n| numbers(draw, n));
    let mut state = State::new(q, Covector(p));
    state.t = number(draw);
    state
}

fn fixed_step(draw: &mut Draw) -> Verdict {
    let method = draw.one_of(Method::ALL);
    let (mut now, h) = (state(draw, 2), positive(draw));
    draw.note(format!("{method}, {now:?}, step {h}"));
    let system = planet();
    let mut stepper = match method.integrator::<_, _, Vec<f64>>(&system) {
        Ok(stepper) => stepper,
        Err(error) => return Verdict::wrong(format!("a right size is refused: {error}")),
    };
    let before = format!("{now:?}");
    let answer = stepper.step(&mut now, h);
    if answer.is_err() && format!("{now:?}") != before {
        return Verdict::wrong("an error changed the state");
    }
    judge("step", answer.map(|_| now.q.iter().chain(now.p.components()).copied().collect()))
}

fn horizons(draw: &mut Draw) -> Verdict {
    let duration = positive(draw);
    let horizon = match draw.chance(0.5) {
        true => Horizon::divided(duration, draw.below(20) as u64),
        false => {
            let step = if draw.chance(0.5) { duration / 4.0 } else { positive(draw) };
            Horizon::new(duration, step)
        }
    };
    let start = if draw.chance(0.3) { draw.any_f64() } else { 0.0 };
    let done = draw.below(5) as u64;
    draw.note(format!("{horizon:?} starting at {start}, resumed at {done}"));
    let Ok(horizon) = horizon else { return Verdict::due() };
    let horizon = horizon.resumed(done).starting(start);
    if horizon.steps() > 1000 {
        return judge("a horizon", Ok::<_, ()>(vec![horizon.step()]));
    }
    let system = planet();
    let mut verlet = StormerVerlet::new(&system).expect("one size");
    let mut now = State::new(vec![1.0, 0.0], Covector(vec![0.0, 1.0]));
    let answer = simulate(&mut verlet, &mut now, horizon, |_| ControlFlow::Continue(()));
    judge("simulate", answer.map(|_| of_state(&now)))
}

/// A field of any size with a mass matrix of any size.
struct AnyField {
    n: usize,
    bad: Option<f64>,
    mass: Option<Vec<f64>>,
}

impl VectorField for AnyField {
    fn dim(&self) -> usize {
        self.n
    }

    fn evaluate(&self, t: f64, y: &[f64], f: &mut [f64]) {
        for (f, y) in f.iter_mut().zip(y) {
            *f = t.cos() - y + self.bad.unwrap_or(0.0);
        }
    }

    fn mass(&self) -> Option<&[f64]> {
        self.mass.as_deref()
    }
}

fn field(draw: &mut Draw) -> AnyField {
    let n = draw.below(4);
    let bad = draw.chance(0.2).then(|| draw.any_f64());
    let mass = draw.chance(0.3).then(|| {
        let count = length(draw, n * n);
        numbers(draw, count)
    });
    AnyField { n, bad, mass }
}

fn control(draw: &mut Draw, n: usize) -> Result<StepControl, ControlError> {
    let relative = if draw.chance(0.1) { draw.any_f64() } else { draw.log_uniform(1e-2, 1e-12) };
    let tolerance = match draw.chance(0.5) {
        true => Tolerance::new(relative, if draw.chance(0.2) { draw.any_f64() } else { 1e-3 }),
        false => {
            let n = length(draw, n);
            Tolerance::componentwise(relative, (0..n).map(|_| draw.unit() + 1e-9).collect())
        }
    }?;
    let mut control = StepControl::from(tolerance).most_steps(2000)?;
    if draw.chance(0.1) {
        control = control.first_step(positive(draw))?;
    }
    if draw.chance(0.1) {
        control = control.longest_step(positive(draw))?;
    }
    if draw.chance(0.1) {
        control = control.constant_step(positive(draw))?;
    }
    Ok(control)
}

fn controls(draw: &mut Draw) -> Verdict {
    let n = draw.below(4);
    judge("control", control(draw, n).map(|_| Vec::new()))
}

type Boxed<'f> = Box<dyn AdaptiveMethod<Vec<f64>> + 'f>;

fn any_method<'f>(
    draw: &mut Draw,
    field: &'f AnyField,
    control: StepControl,
    start: Moment<Vec<f64>>,
) -> Result<Boxed<'f>, AdaptiveError> {
    Ok(match draw.below(3) {
        0 => Box::new(DormandPrince853::new(field, control, start)?),
        1 => Box::new(RadauIia5::new(field, control, start)?),
        _ => {
            let highest = draw.below(8);
            Box::new(BackwardDifferences::of_order_at_most(highest, field, control, start)?)
        }
    })
}

fn of_moment(method: &dyn AdaptiveMethod<Vec<f64>>) -> Vec<f64> {
    let Moment { t, y } = method.moment();
    y.iter().copied().chain([*t]).collect()
}

fn adaptive(draw: &mut Draw) -> Verdict {
    let field = field(draw);
    let Ok(control) = control(draw, field.n) else { return Verdict::due() };
    let n = length(draw, field.n);
    let start = Moment::new(number(draw), numbers(draw, n));
    draw.note(format!("{} unknowns, mass {:?}, {control:?}, {start:?}", field.n, field.mass));
    let Ok(mut method) = any_method(draw, &field, control, start) else { return Verdict::due() };
    for _ in 0..4 {
        let verdict = match draw.below(4) {
            0 | 1 => {
                let end = method.moment().t + positive(draw);
                draw.note(format!("step to {end}"));
                let answer = method.step(end);
                judge("step", answer.map(|()| of_moment(&*method)))
            }
            2 => {
                let n = length(draw, field.n);
                let t = match (draw.below(3), method.last_begin()) {
                    (0, _) => draw.any_f64(),
                    (_, Some(begin)) => begin + draw.unit() * (method.moment().t - begin),
                    _ => method.moment().t,
                };
                draw.note(format!("interpolate at {t}"));
                let mut y = vec![0.0; n];
                judge("interpolate", method.interpolate(t, &mut y).map(|()| y))
            }
            _ => {
                let n = length(draw, field.n);
                let moment = Moment::new(number(draw), numbers(draw, n));
                draw.note(format!("restart from {moment:?}"));
                judge("restart", method.restart(&moment).map(|()| of_moment(&*method)))
            }
        };
        if matches!(verdict, Verdict::Wrong { .. }) {
            return verdict;
        }
    }
    Verdict::due()
}

/// Numbers that were saved, one of them changed.
fn saved(draw: &mut Draw) -> Verdict {
    let field = AnyField { n: draw.between(1, 3), bad: None, mass: None };
    let control = StepControl::from(Tolerance::new(1e-6, 1e-6).expect("a tolerance"));
    let start = Moment::new(0.0, vec![1.0; field.n]);
    let control = control.most_steps(10_000).expect("a bound");
    let Ok(mut method) = any_method(draw, &field, control, start) else { return Verdict::due() };
    for _ in 0..draw.below(6) {
        if method.step(10.0).is_err() {
            return Verdict::wrong("a decay is not followed");
        }
    }
    let mut saved = method.save();
    if draw.chance(0.1) {
        saved.numbers.truncate(draw.below(saved.numbers.len()));
        draw.note("truncated");
        return match method.load(&saved) {
            Err(_) => Verdict::due(),
            Ok(()) => Verdict::wrong("load: too few numbers are accepted"),
        };
    }
    let slot = draw.below(saved.numbers.len());
    let value = draw.any_f64();
    draw.note(format!("{} of {} numbers is {value}", slot, saved.numbers.len()));
    saved.numbers[slot] = value;
    if method.load(&saved).is_err() {
        return Verdict::due();
    }
    if !value.is_finite() {
        return Verdict::wrong(format!("load: {value} is accepted"));
    }
    if method.save().numbers != saved.numbers {
        return Verdict::wrong(format!("load: {value} is accepted and read as another number"));
    }
    let end = method.moment().t + 1.0;
    judge("step after load", method.step(end).map(|()| of_moment(&*method)))
}

/// A system without freedoms: time passes, or the error says why it cannot.
fn empty(draw: &mut Draw) -> Verdict {
    let control = StepControl::from(Tolerance::new(1e-6, 1e-6).expect("a tolerance"));
    let which = draw.below(3 + Method::ALL.len());
    draw.note(format!("an empty system, method {which}"));
    if which < 2 {
        let field = AnyField { n: 0, bad: None, mass: draw.chance(0.5).then(Vec::new) };
        let start = Moment::new(0.0, Vec::new());
        let answer = any_method(draw, &field, control, start).and_then(|mut method| {
            integrate(&mut *method, 1.0, |_| ControlFlow::Continue(()))?;
            Ok(of_moment(&*method))
        });
        return match answer {
            Err(error @ AdaptiveError::StepTooSmall { .. }) => {
                Verdict::wrong(format!("nothing at all is a singularity: {error}"))
            }
            answer => judge("an empty system", answer),
        };
    }
    let metric = DiagonalMetric::new(Vec::new());
    let Ok(metric) = metric else { return Verdict::due() };
    let system = System::new(metric, Nothing).expect("one size");
    let mut now = State::new(Vec::new(), Covector(Vec::new()));
    if which == 2 {
        let answer = Nystrom8::new(&system, control).map_err(AdaptiveError::from);
        let answer = answer
            .and_then(|mut nystrom| nystrom.run(&mut now, 1.0, |_| ControlFlow::Continue(())));
        return match answer {
            Err(error @ AdaptiveError::StepTooSmall { .. }) => {
                Verdict::wrong(format!("nothing at all is a singularity: {error}"))
            }
            answer => judge("an empty system", answer.map(|_| of_state(&now))),
        };
    }
    let stepper = Method::ALL[which - 3].integrator::<_, _, Vec<f64>>(&system);
    let Ok(mut stepper) = stepper else { return Verdict::due() };
    judge("an empty system", stepper.step(&mut now, 0.1).map(|_| of_state(&now)))
}

struct Nothing;

impl Potential for Nothing {
    fn dim(&self) -> usize {
        0
    }

    fn energy(&self, _q: &[f64]) -> f64 {
        0.0
    }

    fn add_differential(&self, _q: &[f64], _dv: Covector<&mut [f64]>) {}

    fn add_hessian(&self, _q: &[f64], _hessian: &mut impl Sink) {}
}

fn nystrom(draw: &mut Draw) -> Verdict {
    let system = planet();
    let Ok(control) = control(draw, 2) else { return Verdict::due() };
    let mut now = state(draw, 2);
    let end = number(draw) + 1.0;
    draw.note(format!("{now:?} to {end}, {control:?}"));
    let Ok(mut nystrom) = Nystrom12::new(&system, control) else { return Verdict::due() };
    let n = length(draw, 2);
    let mut within = State::new(vec![0.0; n], Covector(vec![0.0; n]));
    let part = if draw.chance(0.3) { draw.any_f64() } else { draw.unit() };
    let mut inside = Verdict::due();
    let answer = nystrom.run(&mut now, end, |mut step| {
        let t = step.before.t + part * (step.after.t - step.before.t);
        inside = judge("at", step.at(t, &mut within).map(|()| of_state(&within)));
        match inside {
            Verdict::Wrong { .. } => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    });
    inside.and(judge("run", answer.map(|_| of_state(&now))))
}

fn outputs_and_events(draw: &mut Draw) -> Verdict {
    let n = draw.below(4);
    let times: Vec<f64> = (0..draw.below(4)).map(|_| positive(draw)).collect();
    let field = AnyField { n: 2, bad: None, mass: None };
    let control = StepControl::from(Tolerance::new(1e-6, 1e-6).expect("a tolerance"));
    let control = control.most_steps(10_000).expect("a bound");
    let start = Moment::new(0.0, vec![1.0, 0.0]);
    let mut method = any_method(draw, &field, control, start.clone());
    let Ok(method) = &mut method else { return Verdict::due() };
    draw.note(format!("times {times:?} of {n} numbers"));
    if draw.chance(0.5) {
        let Ok(mut output) = OutputTimes::new(n, &times) else { return Verdict::due() };
        let (mut seen, mut fault) = (Vec::new(), Ok(()));
        let answer = integrate(&mut **method, 2.0, |mut step| {
            fault = output.within(&mut step, |t, y| {
                seen.push(t);
                seen.extend_from_slice(y);
            });
            if fault.is_ok() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        return judge("output", answer.and(fault).map(|()| seen));
    }
    let (level, value) = (number(draw), draw.any_f64());
    let direction = draw.one_of(&[Direction::Rising, Direction::Falling, Direction::Any]);
    let points = draw.below(4) as u32;
    let like = Moment::new(0.0, vec![0.0; length(draw, 2)]);
    let late = draw.chance(0.3);
    let mut event =
        Event::new(
            direction,
            &like,
            move |t, y: &[f64]| {
                if late && t > 0.5 { value } else { y[0] - level }
            },
        )
        .looking_at(points);
    let end = positive(draw);
    draw.note(format!("event at {level}, later {value}: {late}, until {end}, {}", like.y.len()));
    let answer = integrate_to_event(&mut **method, end, &mut event, |_| ());
    judge("event", answer.map(|()| of_moment(&**method)))
}

fn impulses(draw: &mut Draw) -> Verdict {
    let system = planet();
    let mut verlet = StormerVerlet::new(&system).expect("one size");
    let mut now = state(draw, 2);
    let impulses: Vec<Impulse<Vec<f64>>> = (0..draw.below(4))
        .map(|_| {
            let n = length(draw, 2);
            Impulse { time: positive(draw), momentum: Covector(numbers(draw, n)) }
        })
        .collect();
    draw.note(format!("{now:?}, {impulses:?}"));
    let horizon = Horizon::new(1.0, 0.1).expect("ten steps");
    let observe = |_: Observation<'_, _>| ControlFlow::Continue(());
    let answer = simulate_with_impulses(&mut verlet, &mut now, horizon, &impulses, observe);
    judge("impulses", answer.map(|_| of_state(&now)))
}

fn forces(draw: &mut Draw) -> Verdict {
    let system = planet();
    let coefficients: Vec<f64> = (0..length(draw, 2)).map(|_| positive(draw)).collect();
    let (start, width) = (number(draw), positive(draw));
    let t = start + draw.unit() * width;
    draw.note(format!("drag {coefficients:?}, bump from {start} for {width} at {t}"));
    let bumped = judge("bump", bump(start, width).map(|strength| vec![strength(t)]));
    let Ok(drag) = Drag::new(coefficients) else { return bumped };
    let weights = NewmarkWeights::generalized_alpha(0.5).expect("a radius");
    let Ok(mut newmark) = Newmark::<_, _, Vec<f64>, _>::with_force(&system, weights, &drag) else {
        return bumped;
    };
    let mut now = state(draw, 2);
    let answer = newmark.step(&mut now, 0.1);
    let stepped = judge(
        "a step with drag",
        answer.map(|_| now.q.iter().chain(now.p.components()).copied().collect()),
    );
    let Ok(field) = MechanicalField::forced(&system, &drag) else { return bumped.and(stepped) };
    let control = StepControl::from(Tolerance::new(1e-6, 1e-6).expect("a tolerance"));
    let y = numbers(draw, 4);
    let answer =
        RadauIia5::new(&field, control.most_steps(500).expect("a bound"), Moment::new(0.0, y));
    let answer = answer.and_then(|mut radau| {
        radau.step(1.0)?;
        Ok(of_moment(&radau))
    });
    bumped.and(stepped).and(judge("radau with drag", answer))
}

fn weights(draw: &mut Draw) -> Verdict {
    let weights = match draw.chance(0.5) {
        true => NewmarkWeights::newmark(positive(draw), draw.uniform(0.4, 1.1)),
        false => NewmarkWeights::generalized_alpha(positive(draw)),
    };
    draw.note(format!("{weights:?}"));
    let Ok(weights) = weights else { return Verdict::due() };
    let system = planet();
    let mut now = State::new(vec![1.0, 0.0], Covector(vec![0.0, 1.0]));
    let answer = Newmark::<_, _, Vec<f64>>::new(&system, weights).expect("one size");
    let mut newmark = answer;
    let answer = newmark.step(&mut now, 0.1);
    let facts = newmark.facts();
    if let Stability::Below(limit) = facts.stability
        && (limit.is_nan() || limit <= 0.0)
    {
        return Verdict::wrong(format!("weights: stable below {limit}"));
    }
    judge("weights", answer.map(|_| of_state(&now)))
}

fn of_problem<M: Metric, P: Potential, C: AsRef<[f64]>>(
    draw: &mut Draw,
    problem: &problems::Problem<M, P, C>,
) -> Vec<f64> {
    let mut numbers = problem.initial.q.as_ref().to_vec();
    numbers.extend_from_slice(problem.initial.p.components());
    numbers.extend([problem.energy(&problem.initial), problem.horizon, problem.period]);
    let t = problem.horizon * draw.unit();
    if let Some(solution) = (problem.solution)(t) {
        numbers.extend_from_slice(solution.as_ref());
    }
    numbers
}

fn known_problems(draw: &mut Draw) -> Verdict {
    let x = positive(draw);
    let count = draw.below(6);
    let which = draw.below(7);
    draw.note(format!("problem {which} at {x}, {count}"));
    let answer = match which {
        0 => problems::kepler(x).map(|problem| of_problem(draw, &problem)),
        1 => problems::oscillator(x).map(|problem| of_problem(draw, &problem)),
        2 => problems::pendulum(x).map(|problem| of_problem(draw, &problem)),
        3 => problems::spring_pendulum(x).map(|problem| of_problem(draw, &problem)),
        4 => problems::spring_chain(count, x).map(|problem| of_problem(draw, &problem)),
        5 => problems::fermi_pasta_ulam(x).map(|problem| of_problem(draw, &problem)),
        _ => problems::henon_heiles(x).map(|problem| of_problem(draw, &problem)),
    };
    judge("a problem", answer)
}

/// `V = x^4 - x y`.
#[derive(Clone, Copy, Debug)]
struct Well;

impl Energy<2> for Well {
    fn energy<R: Number>(&self, [x, y]: [R; 2]) -> R {
        x.powi(4) - x * y
    }
}

fn lagrangians(draw: &mut Draw) -> Verdict {
    let mass = [positive(draw), positive(draw)];
    let pair = |draw: &mut Draw| [number(draw), number(draw)];
    let (q, v) = (pair(draw), pair(draw));
    let h = positive(draw);
    let path: Vec<[f64; 2]> = (0..draw.below(5)).map(|_| pair(draw)).collect();
    let steps: Vec<f64> = (0..draw.below(4)).map(|_| positive(draw)).collect();
    draw.note(format!("masses {mass:?}, {q:?}, {v:?}, step {h}, path {path:?}, steps {steps:?}"));
    let Ok(lagrangian) = Mechanical::new(mass, Well) else { return Verdict::due() };
    let mut equations = EulerLagrange::new(lagrangian);
    let a = judge("acceleration", equations.acceleration(q, Vector(v)).map(|a| a.0.to_vec()));
    let b = judge("velocity", equations.velocity(q, Covector(v)).map(|v| v.0.to_vec()));
    let quadrature = draw.one_of(&Quadrature::ALL);
    let sampled = Sampled { lagrangian, quadrature };
    let mut now = State::new(q, Covector(v));
    let c = match Variational::new(sampled) {
        Err(_) => Verdict::due(),
        Ok(mut variational) => {
            let answer = variational.step(&mut now, h);
            judge("variational", answer.map(|_| now.q.iter().chain(&now.p.0).copied().collect()))
        }
    };
    let d = match Action::new(sampled, steps) {
        Err(_) => Verdict::due(),
        Ok(action) => {
            let _ = (action.of(&path), action.differential(&path));
            let answer = action.stationary_path(path);
            judge("a stationary path", answer.map(|path| path.path.concat()))
        }
    };
    a.and(b).and(c).and(d)
}

fn reversible(draw: &mut Draw) -> Verdict {
    let system = planet();
    let verlet = StormerVerlet::new(&system).expect("one size");
    let (power, scale) = (positive(draw), positive(draw));
    let density = PotentialPower { potential: *system.potential(), power, scale };
    let mut now = state(draw, 2);
    draw.note(format!("density {power} {scale}, {now:?}"));
    let Ok(mut steps) = ReversibleSteps::new(&system, verlet, density) else {
        return Verdict::due();
    };
    for _ in 0..3 {
        let answer = steps.advance(&mut now);
        let verdict = judge("advance", answer.map(|_| of_state(&now)));
        if matches!(verdict, Verdict::Wrong { .. }) {
            return verdict;
        }
    }
    Verdict::due()
}

fn split(draw: &mut Draw) -> Verdict {
    let system = planet();
    let (rows, columns) = (length(draw, 2), length(draw, 2));
    let mut stiffness = DMatrix::from_fn(rows, columns, |_, _| number(draw));
    if rows == columns && draw.chance(0.7) {
        stiffness = &stiffness * stiffness.transpose();
    }
    let filter = draw.one_of(&[Filter::Impulse, Filter::Mollified, Filter::Gautschi]);
    let (mut now, h) = (state(draw, 2), positive(draw));
    draw.note(format!("{filter:?} {stiffness} {now:?} step {h}"));
    let answer = Gautschi::<_, _, Vec<f64>>::new(&system, &BilinearForm(stiffness), filter);
    let Ok(mut gautschi) = answer else { return Verdict::due() };
    let answer = gautschi.step(&mut now, h);
    judge("gautschi", answer.map(|_| now.q.iter().chain(now.p.components()).copied().collect()))
}

fn momenta(draw: &mut Draw) -> Verdict {
    let now = state(draw, 3);
    draw.note(format!("{now:?}"));
    let _ = linear_momentum::<1>(&now);
    let _ = linear_momentum::<2>(&now);
    let _ = linear_momentum::<3>(&now);
    let _ = angular_momentum::<1>(&now);
    let _ = angular_momentum::<2>(&now);
    let _ = angular_momentum::<3>(&now);
    let _ = linear_momentum_scale::<2>(&now) + angular_momentum_scale::<3>(&now);
    let system = planet();
    let symmetry = Rotation::<2> { axis: [0.0, 0.0, number(draw)] };
    let (q, v) = (&now.q, Vector(now.p.components()));
    let answer = Asymmetry::of_system(&system, &symmetry, q, v);
    let _ = answer.map(|asymmetry| asymmetry.relative());
    Verdict::due()
}
