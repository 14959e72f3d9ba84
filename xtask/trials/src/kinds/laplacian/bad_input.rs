//! Numbers that are none, wrong sizes, vertices that do not exist.

use nalgebra::Vector3;
use stationary_calculus::{Covector, DiagonalMetric};
use stationary_laplacian::{
    Domain, Elements, ExactHeat, GeodesicDistance, Heat, HeatMethod, LaplacianError,
    MeanCurvatureFlow, Poisson, ShortestPaths, harmonic, laplacian, largest_eigenvalue,
    lowest_modes, problems,
};
use stationary_mesh::{IntrinsicSurface, Mesh};

use super::shapes::{self, Shape};
use crate::{Draw, Kind, Verdict};

pub const KIND: Kind = Kind {
    name: "bad-input-laplacian",
    krate: "laplacian",
    rule: "a panic, or an Ok that holds a number that is none",
    in_tests: 600,
    trial,
};

fn trial(draw: &mut Draw) -> Verdict {
    match draw.below(8) {
        0 => mended(on_domains(draw)),
        1 => mended(on_heat(draw)),
        2 => mended(on_modes(draw)),
        3 => mended(on_poisson(draw)),
        4 => mended(on_flow(draw)),
        5 => mended(on_distances(draw)),
        6 => mended(on_far_places(draw)),
        _ => mended(on_problems(draw)),
    }
}

/// Any error is a due refusal.
fn mended(result: Result<Verdict, LaplacianError>) -> Verdict {
    result.unwrap_or_else(|_| Verdict::due())
}

fn finite<'a>(what: &str, values: impl IntoIterator<Item = &'a f64>) -> Verdict {
    match values.into_iter().find(|x| !x.is_finite()) {
        Some(x) => Verdict::wrong(format!("{what}: {x} in an Ok")),
        None => Verdict::due(),
    }
}

/// Mostly ordinary numbers, one of them any.
fn values(draw: &mut Draw, n: usize) -> Vec<f64> {
    let mut values = draw.vector(n);
    if n > 0 && draw.chance(0.7) {
        let place = draw.below(n);
        values[place] = draw.any_f64();
        draw.note(format!("value {place} of {n} is {}", values[place]));
    }
    values
}

/// Mostly the right number of them.
fn count(draw: &mut Draw, right: usize) -> usize {
    if draw.chance(0.8) { right } else { draw.between(0, 2 * right) }
}

/// Now and then a number that is any.
fn number(draw: &mut Draw, what: &str) -> f64 {
    let number = if draw.chance(0.5) { draw.any_f64() } else { draw.log_uniform(1e-3, 1e3) };
    draw.note(format!("{what} {number:e}"));
    number
}

fn domain(draw: &mut Draw) -> Result<Domain<3>, LaplacianError> {
    let shape = shapes::surface(draw);
    let elements = Elements::of(&shape.mesh()?)?;
    if draw.chance(0.5) {
        return Domain::free(elements);
    }
    Domain::held(elements, &[(0, draw.symmetric()), (2, draw.symmetric())])
}

fn on_domains(draw: &mut Draw) -> Result<Verdict, LaplacianError> {
    draw.note("domains");
    let shape = shapes::surface(draw);
    let n = shape.vertices.len();
    let mut elements = Elements::of(&shape.mesh()?)?;
    if draw.chance(0.3) {
        elements = elements.scaled(number(draw, "coefficient"))?;
    }
    let held: Vec<(usize, f64)> = (0..draw.between(0, n + 1))
        .map(|_| {
            let vertex = if draw.chance(0.1) { draw.word() as usize } else { draw.below(n) };
            (vertex, if draw.chance(0.1) { draw.any_f64() } else { draw.symmetric() })
        })
        .collect();
    let domain = Domain::held(elements, &held)?;
    let word = draw.word() as usize;
    let _ = (domain.freedom(word), domain.elements().measure(), domain.galerkin()?);
    let metric = domain.lumped()?;
    let size = count(draw, domain.dim());
    let f = values(draw, size);
    let lap = laplacian(&metric, domain.dirichlet(), &f)?;
    let verdict = finite("the Laplacian", &lap);
    let largest = largest_eigenvalue(&metric, domain.dirichlet())?;
    let verdict = verdict.and(finite("the largest eigenvalue", [&largest]));
    if f.iter().all(|x| x.is_finite()) {
        let back = domain.on_freedoms(&domain.on_vertices(&f)?)?;
        return Ok(if back == f { verdict } else { Verdict::wrong("values are not kept") });
    }
    Ok(verdict)
}

fn on_heat(draw: &mut Draw) -> Result<Verdict, LaplacianError> {
    draw.note("heat");
    let domain = domain(draw)?;
    let wrong = DiagonalMetric::new(vec![1.0; count(draw, domain.dim())])?;
    let metric = if draw.chance(0.2) { wrong } else { domain.lumped()? };
    let method = draw.one_of(&HeatMethod::ALL);
    let (alpha, h) = (number(draw, "alpha"), number(draw, "h"));
    let mut heat = Heat::new(&metric, domain.dirichlet(), method, alpha, h)?;
    let size = count(draw, domain.dim());
    let mut f = values(draw, size);
    heat.step(&mut f)?;
    Ok(finite("heat", &f))
}

fn on_modes(draw: &mut Draw) -> Result<Verdict, LaplacianError> {
    draw.note("modes");
    let domain = domain(draw)?;
    let metric = domain.lumped()?;
    let n = domain.dim();
    let number_of = if draw.chance(0.2) { draw.word() as usize } else { draw.between(0, n + 1) };
    let modes = lowest_modes(&domain, &metric, number_of)?;
    let size = count(draw, n);
    let f = values(draw, size);
    let exact = ExactHeat::new(&modes, &metric, number(draw, "alpha"), &f)?;
    let verdict = finite("what is left out", [&exact.left_out()]);
    let t = number(draw, "t");
    Ok(verdict.and(finite("exact heat", &exact.at(t)?)))
}

fn on_poisson(draw: &mut Draw) -> Result<Verdict, LaplacianError> {
    draw.note("poisson");
    let domain = domain(draw)?;
    let metric = domain.lumped()?;
    let mut poisson = Poisson::new(&domain, &metric)?;
    let size = count(draw, domain.dim());
    let source = values(draw, size);
    let u = match draw.below(3) {
        0 => poisson.solve(&source)?,
        1 => poisson.solve_load(Covector(source))?,
        _ => harmonic(&domain)?,
    };
    Ok(finite("a solution", &u))
}

fn on_flow(draw: &mut Draw) -> Result<Verdict, LaplacianError> {
    draw.note("flow");
    let shape = shapes::surface(draw);
    let mut flow = MeanCurvatureFlow::new(shape.mesh()?)?;
    for _ in 0..draw.between(1, 4) {
        flow.step(number(draw, "h"))?;
    }
    let vertices: Vec<f64> = flow.mesh().vertices().iter().flat_map(|x| [x.x, x.y, x.z]).collect();
    Ok(finite("a surface", &vertices))
}

fn on_distances(draw: &mut Draw) -> Result<Verdict, LaplacianError> {
    draw.note("distances");
    let mut surface = if draw.chance(0.3) {
        let cells = [draw.between(0, 4), draw.between(0, 4)];
        let size = [number(draw, "width"), number(draw, "height")];
        IntrinsicSurface::flat_torus(size, cells)?
    } else {
        IntrinsicSurface::of(&shapes::surface(draw).mesh()?)?
    };
    if draw.chance(0.3) {
        surface = surface.mollified(number(draw, "part"))?;
    }
    if draw.chance(0.3) {
        surface.flip_to_delaunay()?;
        surface.split_obtuse_boundary()?;
    }
    let advised = GeodesicDistance::advised_time(&surface);
    let time = if draw.chance(0.5) { advised } else { number(draw, "time") };
    let mut distance = GeodesicDistance::new(&surface, time)?;
    let n = surface.vertices();
    let sources: Vec<usize> = (0..draw.between(0, 4))
        .map(|_| if draw.chance(0.1) { draw.word() as usize } else { draw.below(n) })
        .collect();
    draw.note(format!("sources {sources:?} of {n}"));
    let exact = ShortestPaths::new(&surface).from(&sources)?.distance;
    let unmeasured = distance.unmeasured(&sources)?;
    let found = distance.from(&sources)?;
    let verdict = finite("a distance", &found.distance).and(finite("an estimate", &found.estimate));
    Ok(verdict.and(finite("a shortest path", &exact)).and(finite("unmeasured", &unmeasured)))
}

/// Tiny, huge and mixed coordinates.
fn on_far_places(draw: &mut Draw) -> Result<Verdict, LaplacianError> {
    draw.note("far places");
    let mut shape: Shape<3> = shapes::surface(draw);
    let scale = draw.log_uniform(1e-320, 1e49);
    let stretch = if draw.chance(0.5) { draw.log_uniform(1e-20, 1.0) } else { 1.0 };
    draw.note(format!("scale {scale:e}, stretch {stretch:e}"));
    shape.vertices.iter_mut().for_each(|x| *x = Vector3::new(x.x, x.y * stretch, x.z) * scale);
    if draw.chance(0.3) {
        let place = draw.below(shape.vertices.len());
        shape.vertices[place].x = draw.any_f64();
    }
    let mesh = Mesh::new(shape.vertices, shape.simplices)?;
    let domain = Domain::free(Elements::of(&mesh)?)?;
    let metric = domain.lumped()?;
    let f = draw.vector(domain.dim());
    let lap = laplacian(&metric, domain.dirichlet(), &f)?;
    let mut verdict = finite("the Laplacian", &lap);
    let largest = largest_eigenvalue(&metric, domain.dirichlet())?;
    verdict = verdict.and(finite("the largest eigenvalue", [&largest]));
    let mut heated = f.clone();
    let method = draw.one_of(&HeatMethod::ALL);
    let mut heat =
        Heat::new(&metric, domain.dirichlet(), method, 1.0, draw.log_uniform(1e-9, 1e9))?;
    heat.step(&mut heated)?;
    verdict = verdict.and(finite("heat", &heated));
    let surface = IntrinsicSurface::of(&mesh)?;
    let time = GeodesicDistance::advised_time(&surface);
    let found = GeodesicDistance::new(&surface, time)?.from(&[0])?;
    Ok(verdict.and(finite("a distance", &found.distance)))
}

fn on_problems(draw: &mut Draw) -> Result<Verdict, LaplacianError> {
    draw.note("problems");
    let n = draw.below(12);
    let spectrum = match draw.below(5) {
        0 => problems::interval(n)?.spectrum,
        1 => problems::square(n)?.spectrum,
        2 => problems::disc(n)?.spectrum,
        3 => problems::sphere(n % 4)?.spectrum,
        _ => problems::lumped_interval_spectrum(n),
    };
    let rising = spectrum.windows(2).all(|w| w[0] <= w[1]);
    let verdict = if rising { Verdict::due() } else { Verdict::wrong("a spectrum does not rise") };
    // A factor has a pole where theta z is one, which no eigenvalue reaches: they are not positive.
    let z = -draw.any_f64().abs();
    let method = draw.one_of(&HeatMethod::ALL);
    let factor = method.amplification(z);
    let bounded =
        method == HeatMethod::ExplicitEuler || !z.is_finite() || factor.abs() <= 1.0 + 1e-12;
    Ok(verdict.and(finite("a spectrum", &spectrum)).and(if bounded {
        Verdict::due()
    } else {
        Verdict::wrong(format!("an implicit method's factor at {z:e} is {factor:e}"))
    }))
}
