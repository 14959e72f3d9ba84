//! Rods between points in the plane: open, closed, redundant, folded, heavy beside light, and starts
//! that break them.

use nalgebra::DVector;
use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_constraints::{
    ConstrainedHamilton, ConstrainedIntegrator, ConstraintError, Projection, Rattle, Redundancy,
    Rod, Rods, SparseDiagonal, SparseGeneral, StepAndProject,
};
use stationary_integrators::{State, StormerVerlet, UniformGravity};

use super::net::{Net, Shape};
use super::reduced_chain::Chain;
use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "rods",
    krate: "constraints",
    rule: "a step's rods, velocities or momenta are off by more than the page says; a hung chain is \
           not where its angles are, to the differences of three steps; a start that breaks rods is \
           taken; a step within the documented bound is refused; an error names an absurd violation",
    in_tests: 300,
    trial,
};

/// The largest turn of a step, radians.
const TURN: f64 = 0.4;

/// Up to this part of the regularity the turn of a step (radians), times the root of the ratio of
/// masses, has a solution.
const BOUND: f64 = 0.5;

type Problem = System<DiagonalMetric<Vec<f64>>, UniformGravity<2>>;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    Rattle,
    Hamilton,
    Projected,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Solved {
    Diagonal,
    General,
}

type Made<'s> = Result<Box<dyn ConstrainedIntegrator<Vec<f64>> + 's>, ConstraintError>;

fn method<'s>(
    (way, solved, redundancy): (Way, Solved, Redundancy),
    system: &'s Problem,
    rods: &Rods<2>,
    state: &State<Vec<f64>>,
) -> Made<'s> {
    macro_rules! with {
        ($choice:expr) => {
            match way {
                Way::Rattle => Box::new(Rattle::new(system, rods.clone(), state, $choice)?),
                Way::Hamilton => {
                    Box::new(ConstrainedHamilton::new(system, rods.clone(), state, $choice)?)
                }
                Way::Projected => {
                    let verlet = StormerVerlet::new(system).map_err(|_| absent())?;
                    Box::new(StepAndProject::new(verlet, system, rods.clone(), state, $choice)?)
                }
            }
        };
    }
    Ok(match solved {
        Solved::Diagonal => with!(SparseDiagonal(redundancy)),
        Solved::General => with!(SparseGeneral),
    })
}

fn absent() -> ConstraintError {
    ConstraintError::NonFinite { what: "method", index: 0 }
}

/// An error that names a violation of more lengths than anything can have is no help.
fn is_absurd(error: &ConstraintError) -> bool {
    let violation = match *error {
        ConstraintError::NotConverged { violation, .. }
        | ConstraintError::Diverged { violation, .. }
        | ConstraintError::Infeasible { violation, .. } => violation,
        _ => 0.0,
    };
    violation.is_nan() || violation > 1e6
}

fn trial(draw: &mut Draw) -> Verdict {
    let net = Net::draw(draw);
    let n = net.masses.len();
    let way = draw.one_of(&[Way::Rattle, Way::Rattle, Way::Rattle, Way::Hamilton, Way::Projected]);
    let redundant = net.shape == Shape::Braced;
    let share = redundant && draw.chance(0.8);
    let solved = match share {
        true => Solved::Diagonal,
        false => draw.one_of(&[Solved::Diagonal, Solved::Diagonal, Solved::General]),
    };
    let redundancy = if share { Redundancy::LeastNorm } else { Redundancy::Refuse };
    let turn = match draw.chance(0.5) {
        true => draw.log_uniform(1e-4, TURN),
        false => draw.log_uniform(1e-4, TURN) / net.mass_ratio().sqrt(),
    };
    let gravity = if draw.chance(0.5) { net.size() * draw.unit() } else { 0.0 };
    draw.note(format!(
        "{:?} {way:?} {solved:?} {redundancy:?}, masses {:?}, turn {turn:.3e}, gravity {gravity:.1e}",
        net.shape, net.masses
    ));
    draw.note(format!("at {:?}, hooks {:?}, rods {:?}", net.q, net.hooks, net.rods));
    if net.is_degenerate() {
        return Verdict::due();
    }
    // A velocity that stretches nothing, the fastest rod turning by 1 rad/s.
    let mut v = DVector::from_fn(2 * n, |_, _| draw.symmetric());
    net.project_velocity(&mut v);
    let fastest = net.fastest_turn(&v).max(1e-3 * v.amax() / net.size());
    if fastest > 1e-9 {
        v /= fastest;
    } else {
        v.fill(0.0);
    }
    let mut q = net.q.clone();
    let (mut moved, mut leaves) = (0.0, 0.0);
    match draw.below(8) {
        6 => {
            moved = draw.log_uniform(1e-9, 0.1);
            q.iter_mut().for_each(|x| *x += moved * net.size() * draw.symmetric());
        }
        7 => {
            leaves = draw.log_uniform(1e-7, 1.0);
            v.iter_mut().for_each(|v| *v += leaves * net.size() * draw.symmetric());
        }
        _ => {}
    }
    let free = 2 * n;
    let p: Vec<f64> = (0..free).map(|f| net.mass(f) * v[f]).collect();
    let masses = (0..free).map(|f| net.mass(f)).collect();
    let Ok(metric) = DiagonalMetric::new(masses) else { return Verdict::wrong("no metric") };
    let field = UniformGravity { acceleration: [0.0, -gravity], masses: net.masses.clone() };
    let Ok(system) = System::new(metric, field) else { return Verdict::wrong("no system") };
    let made = net.rods.iter().map(|&(ends, length)| Rod::new(ends, length)).collect();
    let rods = match Rods::new(n, net.hooks.clone(), made) {
        Ok(rods) => rods,
        Err(error) => return Verdict::wrong(format!("no rods: {error}")),
    };
    let mut state = State::new(q, Covector(p));
    let regularity = net.regularity(&state.q);
    draw.note(format!("regularity {regularity:.1e}, moved {moved:.1e}, leaves {leaves:.1e}"));
    let choice = (way, solved, redundancy);
    let stretch = relative_stretch(&net, &state.q);
    let rate = stretching(&net, &state.q, &state.p.0);
    match method(choice, &system, &rods, &state) {
        Err(error) if is_absurd(&error) => return Verdict::wrong(format!("says: {error}")),
        Err(error) => {
            // Redundant equations that may not share, and folded ones, are to be refused.
            let singular = regularity < 1e-6 || (redundant && !share);
            let infeasible = matches!(error, ConstraintError::Infeasible { .. }) && stretch > 1e-13;
            let leaving =
                matches!(error, ConstraintError::InfeasibleVelocity { .. }) && rate > 1e-10;
            if !(infeasible || leaving) {
                return if singular { Verdict::due() } else { Verdict::refused(error) };
            }
        }
        Ok(_) if stretch > 1e-10 => {
            return Verdict::wrong(format!("starts though rods are off by {stretch:.1e}"));
        }
        Ok(_) if rate > 1e-6 => {
            return Verdict::wrong(format!("starts though rods are stretched at {rate:.1e}/s"));
        }
        Ok(_) if redundant && !share => {
            // Six rods on four points: rounding leaves a rank that need not be full.
            return Verdict::wrong("redundant rods are taken as independent");
        }
        Ok(_) => {}
    }
    if stretch > 1e-13 || rate > 1e-10 {
        return projected(&net, &system, &rods, &mut state, redundancy);
    }
    let mut verdict = stepped(draw, &net, &system, &rods, &state, choice, turn, regularity);
    let smooth = turn * net.mass_ratio().sqrt() < 0.05;
    // A velocity may stretch rods by 1e-12 m/s, which is much for a chain of micrometres.
    let tangent = leaves == 0.0 && matches!(verdict, Verdict::Right { .. });
    if net.shape == Shape::HungChain && n <= 3 && smooth && tangent {
        verdict = verdict.and(in_angles(&net, &system, &rods, &state, choice, turn, gravity));
    }
    verdict
}

/// The largest `||d|/L - 1|`, beyond the rounding of the places.
fn relative_stretch(net: &Net, q: &[f64]) -> f64 {
    let largest = q.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
    let stretches = net.stretches(q);
    let one = |(stretch, rod): (&f64, &([usize; 2], f64))| {
        (stretch.abs() - 8.0 * f64::EPSILON * largest).max(0.0) / rod.1
    };
    stretches.iter().zip(&net.rods).map(one).fold(0.0, f64::max)
}

/// The largest rate at which a rod is stretched, beyond 1e-12 m/s, over the largest velocity, or that of a turn of 1 rad
/// in a month.
fn stretching(net: &Net, q: &[f64], p: &[f64]) -> f64 {
    let v = DVector::from_fn(q.len(), |f, _| p[f] / net.mass(f));
    ((net.differential(q) * &v).amax() - 1e-12).max(0.0) / v.amax().max(1e-6 * net.size())
}

/// A start that is not feasible, after its projection.
fn projected(
    net: &Net,
    system: &Problem,
    rods: &Rods<2>,
    state: &mut State<Vec<f64>>,
    redundancy: Redundancy,
) -> Verdict {
    let given = state.clone();
    let done = Projection::new(system, rods.clone(), state, SparseDiagonal(redundancy))
        .and_then(|mut projection| projection.project(state));
    match done {
        Err(error) if is_absurd(&error) => Verdict::wrong(format!("projection says: {error}")),
        Err(_) if *state != given => Verdict::wrong("a failed projection moved the state"),
        // Rods that were made to depend on each other need not close again.
        Err(error) if net.regularity(&given.q) < 1e-2 || net.shape == Shape::Braced => {
            let _ = error;
            Verdict::due()
        }
        Err(error) => Verdict::refused(error),
        Ok(_) => {
            let rate = stretching(net, &state.q, &state.p.0);
            // Where it has come to: rods in a line were bent by what moved them.
            let regularity = net.regularity(&state.q).max(1e-8);
            let (rounding, ratio) = (1e-12 / regularity, net.mass_ratio().sqrt());
            Verdict::of(relative_stretch(net, &state.q), 1.1e-12, "a rod after projection")
                .and(Verdict::of(rate, rounding * ratio, "a velocity after projection"))
        }
    }
}

fn sum(p: &[f64], c: usize) -> f64 {
    p.iter().skip(c).step_by(2).sum()
}

fn spin(q: &[f64], p: &[f64]) -> f64 {
    q.chunks_exact(2).zip(p.chunks_exact(2)).map(|(x, p)| x[0] * p[1] - x[1] * p[0]).sum()
}

/// Twenty steps, each looked at.
#[expect(clippy::too_many_arguments, reason = "one case in its parts")]
fn stepped(
    draw: &mut Draw,
    net: &Net,
    system: &Problem,
    rods: &Rods<2>,
    start: &State<Vec<f64>>,
    choice: (Way, Solved, Redundancy),
    h: f64,
    regularity: f64,
) -> Verdict {
    let mut state = start.clone();
    let mut method = match method(choice, system, rods, &state) {
        Ok(method) => method,
        Err(error) => return Verdict::refused(error),
    };
    let mut verdict = Verdict::due();
    let size = |s: &State<Vec<f64>>| s.p.0.iter().fold(0.0, |a, p| a + p.abs());
    let reach = start.q.iter().fold(net.size(), |a, x| a.max(x.abs()));
    for step in 0..20 {
        let before = state.clone();
        match method.step(&mut state, h) {
            Err(error) => {
                draw.note(format!("step {step}: {error}"));
                if state != before {
                    return Verdict::wrong("a failed step moved the state");
                }
                if is_absurd(&error) {
                    return Verdict::wrong(format!("step {step} says: {error}"));
                }
                return refusal(net, &before, system, (h, regularity), error);
            }
            Ok(report) if !report.violation.is_finite() => {
                return Verdict::wrong("the report is not finite");
            }
            Ok(_) => {}
        }
        let rod = Verdict::of(relative_stretch(net, &state.q), 1.1e-12, "a rod after a step");
        verdict = verdict.and(rod);
        if choice.0 != Way::Hamilton {
            // Impulses round, too, and light points are moved by what heavy ones leave.
            let rate = stretching(net, &state.q, &state.p.0);
            // Well within the 1e-9 of the page; the solver of coupled freedoms keeps a digit less.
            let kept = if choice.1 == Solved::General { 1e-11 } else { 1e-12 };
            let allowed = kept * net.mass_ratio().sqrt() / regularity.max(1e-8);
            verdict = verdict.and(Verdict::of(rate, allowed, "a velocity after a step"));
        }
        if matches!(verdict, Verdict::Wrong { .. }) {
            return verdict;
        }
    }
    let free = net.hooks.is_empty() && system.potential().acceleration == [0.0; 2];
    let scale = size(start).max(size(&state));
    // A velocity that is a difference of places has their rounding, and forces that all but cancel
    // magnify it.
    let of_places = if choice.0 == Way::Projected {
        let heaviest = state.q.iter().enumerate().map(|(f, q)| net.mass(f) * q.abs());
        let rounding = 4.0 * f64::EPSILON * heaviest.fold(0.0, f64::max) / h;
        rounding / regularity.max(1e-3)
    } else {
        0.0
    };
    if free {
        for c in 0..2 {
            let off = (sum(&state.p.0, c) - sum(&start.p.0, c)).abs();
            verdict = verdict.and(Verdict::of(off, 1e-12 * scale + of_places, "linear momentum"));
        }
        if choice.0 != Way::Projected {
            let off = (spin(&state.q, &state.p.0) - spin(&start.q, &start.p.0)).abs();
            verdict = verdict.and(Verdict::of(off, 1e-12 * scale * reach, "angular momentum"));
        }
    }
    verdict
}

/// Whether a step may be refused.
fn refusal(
    net: &Net,
    state: &State<Vec<f64>>,
    system: &Problem,
    (h, regularity): (f64, f64),
    error: ConstraintError,
) -> Verdict {
    let v = DVector::from_fn(state.q.len(), |f, _| state.p.0[f] / net.mass(f));
    let turn = h * net.fastest_turn(&v);
    let here = net.regularity(&state.q).min(regularity);
    if here > 1e-3 && turn * net.mass_ratio().sqrt() < BOUND * here {
        return Verdict::wrong(format!("refuses a turn of {turn:.1e} rad a step: {error}"));
    }
    let mut kicked = Covector(state.p.0.clone());
    let mut dv = Covector(vec![0.0; state.q.len()]);
    stationary_calculus::Potential::add_differential(system.potential(), &state.q, dv.view_mut());
    kicked.add_scaled(-0.5 * h, dv.view());
    match net.step_has_a_solution(&state.q, &kicked.0, h) {
        true => Verdict::refused(error),
        false => Verdict::due(),
    }
}

/// A hung chain against its angles.
fn in_angles(
    net: &Net,
    system: &Problem,
    rods: &Rods<2>,
    start: &State<Vec<f64>>,
    choice: (Way, Solved, Redundancy),
    h: f64,
    gravity: f64,
) -> Verdict {
    let steps = 10;
    let run = |parts: usize| -> Result<Vec<f64>, ConstraintError> {
        let mut state = start.clone();
        let mut method = method(choice, system, rods, &state)?;
        for _ in 0..parts * steps {
            method.step(&mut state, h / parts as f64)?;
        }
        Ok(state.q)
    };
    let (coarse, fine, finest) = match (run(1), run(2), run(4)) {
        (Ok(coarse), Ok(fine), Ok(finest)) => (coarse, fine, finest),
        (Err(error), ..) | (_, Err(error), _) | (.., Err(error)) => return Verdict::refused(error),
    };
    let lengths = net.rods.iter().map(|rod| rod.1).collect();
    let chain = Chain { lengths, masses: net.masses.clone(), gravity };
    let v: Vec<f64> = (0..start.q.len()).map(|f| start.p.0[f] / net.mass(f)).collect();
    let Some(exact) = chain.run(&start.q, &v, h / 16.0, 16 * steps) else {
        return Verdict::not_judged("the mass matrix of the angles is singular");
    };
    let off = |a: &[f64], b: &[f64]| {
        a.iter().zip(b).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / net.size()
    };
    // Errors a h + b h^2 may be the same at two steps: a h/4 + b h^2/16 is (5 d - D)/3 of the differences
    // D of the first two and d of the last two.
    let apart = off(&coarse, &fine) + off(&fine, &finest);
    Verdict::of(off(&finest, &exact), 2.0 * apart + 1e-9, "the chain's place")
}
