//! Heat, stepped and in closed form, against dense linear algebra.

use nalgebra::{DMatrix, DVector};
use stationary_calculus::Metric;
use stationary_laplacian::{
    Domain, Elements, ExactHeat, Heat, HeatMethod, LaplacianError, lowest_modes,
};
use stationary_mesh::{IntrinsicSurface, Simplex};

use super::matrices::{Matrices, part, solve};
use super::shapes::{self, Shape};
use crate::{Draw, Kind, Verdict};

pub const KIND: Kind = Kind {
    name: "heat",
    krate: "laplacian",
    rule: "a temperature off by more than the condition number times rounding (1e-13, and 1e-14 for \
           each time that a simplex is longer than high); free heat that changes its amount by more; implicit Euler with lumped mass and no negative weight \
           that leaves the range of its start; modes that leave out more or less than is said",
    in_tests: 300,
    trial,
};

fn trial(draw: &mut Draw) -> Verdict {
    match draw.below(4) {
        0 => {
            let shape = shapes::in_pieces(draw, shapes::line).placed(draw);
            flow(draw, &shape)
        }
        1 => {
            let shape = shapes::in_pieces(draw, shapes::surface).placed(draw);
            flow(draw, &shape)
        }
        2 => {
            let shape = shapes::in_pieces(draw, shapes::solid).placed(draw);
            flow(draw, &shape)
        }
        _ => in_range(draw),
    }
}

/// On a surface with Delaunay edges and split obtuse boundary sides no weight is negative: implicit
/// Euler with lumped mass keeps the range of its start, whatever the step.
fn in_range(draw: &mut Draw) -> Verdict {
    let shape = shapes::in_pieces(draw, shapes::surface).placed(draw);
    let shape_of = Matrices::of(&shape).shape;
    if shape_of < 1e-5 {
        return Verdict::not_judged("too flat for lengths alone");
    }
    let surface = shape.mesh().and_then(|mesh| {
        let mut surface = IntrinsicSurface::of(&mesh)?;
        surface.split_obtuse_boundary()?;
        Ok(surface)
    });
    let surface = match surface {
        Ok(surface) => surface,
        Err(error) => return Verdict::refused(error),
    };
    let repeats = surface.triangles().iter().any(|&[a, b, c]| a == b || b == c || c == a);
    match before_and_after(draw, &surface) {
        Ok((before, f)) => {
            let least = |f: &[f64]| f.iter().copied().fold(f64::INFINITY, f64::min);
            let most = |f: &[f64]| f.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let outside = (least(&before) - least(&f)).max(most(&f) - most(&before)).max(0.0);
            Verdict::of(outside, 1e-11, "the range of the start")
        }
        // A triangle that names a vertex twice has no sparse matrix: the page says so.
        Err(_) if repeats => Verdict::due(),
        Err(error) => Verdict::refused(error),
    }
}

/// Some steps of implicit Euler with lumped mass.
fn before_and_after(
    draw: &mut Draw,
    surface: &IntrinsicSurface,
) -> Result<(Vec<f64>, Vec<f64>), LaplacianError> {
    let domain = Domain::free(Elements::of_surface(surface)?)?;
    let metric = domain.lumped()?;
    let mut f = vec![0.0; domain.dim()];
    if draw.chance(0.5) {
        f[draw.below(domain.dim())] = 1.0;
    } else {
        f = draw.vector(domain.dim());
    }
    let before = f.clone();
    let h = draw.log_uniform(1e-8, 1e4) * surface.area();
    draw.note(format!("on {} vertices with Delaunay edges, h {h:.2e}", f.len()));
    let method = HeatMethod::ImplicitEuler;
    let mut heat = Heat::new(&metric, domain.dirichlet(), method, 1.0, h)?;
    for _ in 0..draw.between(1, 4) {
        heat.step(&mut f)?;
    }
    Ok((before, f))
}

/// What flows, in the referee's words: on the free vertices, about held values.
struct Problem {
    stiffness: DMatrix<f64>,
    mass: DMatrix<f64>,
    /// The differential of the energy where all free values are zero.
    pull: DVector<f64>,
    held: Vec<f64>,
    lumped: bool,
    /// Rounding of a matrix of simplices of such a shape.
    rounding: f64,
}

fn flow<const K: usize>(draw: &mut Draw, shape: &Shape<K>) -> Verdict
where
    [usize; K]: Simplex,
{
    let matrices = Matrices::of(shape);
    if matrices.shape.is_nan() || matrices.shape < 1e-9 {
        return Verdict::not_judged("a simplex of hardly any size");
    }
    let n = shape.vertices.len();
    let count = if draw.chance(0.4) { draw.between(1, n.div_ceil(2)) } else { 0 };
    let mut all: Vec<usize> = (0..n).collect();
    let held: Vec<(usize, f64)> =
        (0..count).map(|_| (all.remove(draw.below(all.len())), 3.0 * draw.symmetric())).collect();
    let (places, values): (Vec<usize>, Vec<f64>) = held.iter().copied().unzip();
    let lumped = draw.chance(0.5);
    draw.note(format!("{count} held, {} mass", if lumped { "lumped" } else { "exact" }));
    let pull = part(&matrices.stiffness, &all, &places) * DVector::from_vec(values.clone());
    let problem = Problem {
        stiffness: part(&matrices.stiffness, &all, &all),
        mass: part(if lumped { &matrices.lumped } else { &matrices.galerkin }, &all, &all),
        pull,
        held: values,
        lumped,
        rounding: 1e-13 + 1e-14 / matrices.shape,
    };
    let mesh = match shape.mesh() {
        Ok(mesh) => mesh,
        Err(error) => return Verdict::refused(error),
    };
    let domain = match Elements::of(&mesh).and_then(|e| Domain::held(e, &held)) {
        Ok(domain) => domain,
        Err(error) => return Verdict::refused(error),
    };
    if lumped {
        match domain.lumped() {
            Ok(metric) => on_domain(draw, &problem, &domain, &metric),
            Err(error) => Verdict::refused(error),
        }
    } else {
        match domain.galerkin() {
            Ok(metric) => on_domain(draw, &problem, &domain, &metric),
            Err(error) => Verdict::refused(error),
        }
    }
}

fn on_domain<const K: usize>(
    draw: &mut Draw,
    problem: &Problem,
    domain: &Domain<K>,
    metric: &impl Metric,
) -> Verdict {
    let size = if draw.chance(0.2) { draw.log_uniform(1e-8, 1e8) } else { 1.0 };
    let start: Vec<f64> = draw.vector(domain.dim()).into_iter().map(|f| size * f).collect();
    if draw.chance(0.4) {
        in_modes(draw, problem, domain, metric, &start)
    } else {
        stepped(draw, problem, domain, metric, start)
    }
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().map(f64::abs).fold(0.0, f64::max)
}

fn stepped<const K: usize>(
    draw: &mut Draw,
    problem: &Problem,
    domain: &Domain<K>,
    metric: &impl Metric,
    mut f: Vec<f64>,
) -> Verdict {
    let method = draw.one_of(&HeatMethod::ALL);
    let alpha = draw.log_uniform(1e-3, 1e3);
    // From steps that hardly move to steps that do all: in units of the fastest mode.
    let n = f.len();
    let fastest =
        (0..n).map(|i| problem.stiffness[(i, i)] / problem.mass[(i, i)]).fold(0.0, f64::max);
    if fastest == 0.0 {
        return Verdict::not_judged("nothing flows");
    }
    let reach = if method == HeatMethod::ExplicitEuler { 3.0 } else { 1e8 };
    let h = draw.log_uniform(1e-4, reach) / (alpha * fastest);
    let steps = draw.between(1, 6);
    draw.note(format!("{}, alpha {alpha:.2e}, h {h:.2e}, {steps} steps", method.name()));
    let mut heat = match Heat::new(metric, domain.dirichlet(), method, alpha, h) {
        Ok(heat) => heat,
        Err(error) => return Verdict::refused(error),
    };
    let theta = match method {
        HeatMethod::ExplicitEuler => 0.0,
        HeatMethod::CrankNicolson => 0.5,
        HeatMethod::ImplicitEuler => 1.0,
    };
    let matrix = &problem.mass + &problem.stiffness * (theta * alpha * h);
    let mut expected = DVector::from_vec(f.clone());
    let before = f.clone();
    let (mut condition, mut scale) = (1.0_f64, largest(f.iter().copied()));
    for _ in 0..steps {
        let load = -(&problem.stiffness * &expected + &problem.pull) * (alpha * h);
        let (change, kappa) = solve(&matrix, &load);
        expected += &change;
        condition = condition.max(kappa);
        scale = scale.max(largest(expected.iter().copied())).max(largest(change.iter().copied()));
        if let Err(error) = heat.step(&mut f) {
            return Verdict::refused(error);
        }
    }
    scale = scale.max(largest(problem.held.iter().copied()));
    if condition > 1e9 {
        return Verdict::not_judged("a matrix too close to singular for the referee");
    }
    let promised = problem.rounding * condition * scale;
    let error = largest(f.iter().zip(expected.iter()).map(|(a, b)| a - b));
    let mut verdict = Verdict::of(error, promised, "a temperature");
    if problem.held.is_empty() {
        let ones = DVector::from_element(n, 1.0);
        let amount =
            |f: &[f64]| (problem.mass.transpose() * &ones).dot(&DVector::from_column_slice(f));
        let total = problem.mass.sum() * scale;
        let error = (amount(&f) - amount(&before)).abs();
        verdict = verdict.and(Verdict::of(
            error,
            problem.rounding * condition * total,
            "the amount of heat",
        ));
    }
    let negative = (0..n).any(|i| (0..n).any(|j| i != j && problem.stiffness[(i, j)] > 0.0));
    if problem.lumped && method == HeatMethod::ImplicitEuler && problem.held.is_empty() && !negative
    {
        let bounds = |f: &[f64]| {
            f.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| (l.min(x), h.max(x)))
        };
        let ((low, high), (lowest, highest)) = (bounds(&before), bounds(&f));
        let outside = (low - lowest).max(highest - high).max(0.0);
        let what = "the maximum principle";
        verdict = verdict.and(Verdict::of(outside, problem.rounding * condition * scale, what));
    }
    verdict
}

fn in_modes<const K: usize>(
    draw: &mut Draw,
    problem: &Problem,
    domain: &Domain<K>,
    metric: &impl Metric,
    start: &[f64],
) -> Verdict {
    let n = start.len();
    // Values and vectors of M^-1/2 W M^-1/2.
    let mass = problem.mass.clone().symmetric_eigen();
    let root = |power: f64| {
        let d = DMatrix::from_diagonal(&mass.eigenvalues.map(|m| m.powf(power)));
        &mass.eigenvectors * d * mass.eigenvectors.transpose()
    };
    let (half, back) = (root(0.5), root(-0.5));
    let symmetric = &back * &problem.stiffness * &back;
    let eigen = (0.5 * (&symmetric + symmetric.transpose())).symmetric_eigen();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| eigen.eigenvalues[i].total_cmp(&eigen.eigenvalues[j]));
    let values: Vec<f64> = order.iter().map(|&i| eigen.eigenvalues[i]).collect();
    let spread = mass.eigenvalues.max() / mass.eigenvalues.min();
    let fastest = values[n - 1];
    if spread > 1e6 || fastest <= 0.0 {
        return Verdict::not_judged("masses too unequal for the referee");
    }
    // Of modes that are equal to rounding no one may be left out alone.
    let mut count = draw.between(1, n);
    while count < n && values[count] - values[count - 1] < 1e-6 * fastest {
        count += 1;
    }
    let alpha = draw.log_uniform(1e-3, 1e3);
    let slowest = values.iter().copied().find(|&v| v > 1e-9 * fastest).unwrap_or(fastest);
    let t = if draw.chance(0.1) {
        0.0
    } else {
        draw.log_uniform(0.1 / fastest, 30.0 / slowest) / alpha
    };
    draw.note(format!("{count} of {n} modes, alpha {alpha:.2e}, t {t:.2e}"));
    let modes = match lowest_modes(domain, metric, count) {
        Ok(modes) => modes,
        Err(error) => return Verdict::refused(error),
    };
    let found = ExactHeat::new(&modes, metric, alpha, start)
        .and_then(|heat| Ok((heat.at(t)?, heat.left_out())));
    let (found, left_out) = match found {
        Ok(found) => found,
        Err(error) => return Verdict::refused(error),
    };
    let f = &half * DVector::from_column_slice(start);
    let mut kept = DVector::zeros(n);
    let mut flowed = DVector::zeros(n);
    for &i in &order[..count] {
        let vector = eigen.eigenvectors.column(i);
        let part = vector.dot(&f);
        kept += vector * part;
        flowed += vector * (part * (-alpha * t * eigen.eigenvalues[i].max(0.0)).exp());
    }
    let expected = &back * flowed;
    // Rounding of values, relative to the fastest, moves what they say at a time t.
    let moved = 1e-12 * (1.0 + alpha * t * fastest);
    // And modes just below the cut mix with those just above by as much as rounding over the gap.
    let residual = modes.residuals().iter().copied().fold(1e-11 * fastest, f64::max);
    let mixed = if count < n { 2.0 * residual / (values[count] - values[count - 1]) } else { 0.0 };
    let promised = (1e-9 + mixed + moved.min(1.0)) * spread.sqrt() * largest(start.iter().copied());
    let error = largest(found.iter().zip(expected.iter()).map(|(a, b)| a - b));
    let rest = if f.norm() > 0.0 { (&f - kept).norm() / f.norm() } else { 0.0 };
    Verdict::of(error, promised, "a temperature in modes").and(Verdict::of(
        (rest - left_out).abs(),
        1e-7 + mixed,
        "what the modes leave out",
    ))
}
