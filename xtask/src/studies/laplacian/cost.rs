//! Four ways to let heat flow, by what they cost.

use stationary_calculus::{Potential, SparseCholesky, SymmetricMatrix};
use stationary_chart::{Axis, Lines, Series};
use stationary_laplacian::problems::{Spectral, square};
use stationary_laplacian::{ExactHeat, Heat, HeatMethod, LaplacianError, lowest_modes};
use stationary_measure::{Column, Table, loglog_slope};

use crate::studies::cheapest::Asked;
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Error against counted multiplications.
pub const STUDY: Entry<'static> = Entry {
    id: "heat-work-precision",
    krate: "laplacian",
    chapter: "15.2-15.3",
    kind: Kind::WorkPrecision,
    title: "Heat on a square: error of four methods against cost",
    tested: Tested::Claims,
    run: &study,
};

const TIME: f64 = 0.05;

/// A square with one warm half.
struct Scene {
    problem: Spectral<2, 3>,
    start: Vec<f64>,
}

/// Multiplications and errors of one method.
type Points = Vec<(f64, f64)>;

impl Scene {
    fn new(n: usize) -> Result<Self, LaplacianError> {
        let problem = square(n)?;
        let warm = |x: &nalgebra::Vector2<f64>| if x.x + 0.3 * x.y < 0.6 { 1.0 } else { 0.0 };
        let start = problem.mesh.vertices().iter().map(warm).collect();
        Ok(Scene { problem, start })
    }

    /// Entries of the matrix and of its factor.
    fn entries(&self) -> Result<[f64; 2], LaplacianError> {
        let dirichlet = self.problem.domain.dirichlet();
        let matrix = SymmetricMatrix::hessian(dirichlet, &vec![0.0; dirichlet.dim()])?;
        let factor = SparseCholesky::analyse(&matrix)?.factor_len();
        Ok([matrix.values().len() as f64, factor as f64])
    }

    fn stepped(
        &self,
        method: HeatMethod,
        exact: &[f64],
        least: usize,
    ) -> Result<Points, LaplacianError> {
        let metric = self.problem.domain.lumped()?;
        let dirichlet = self.problem.domain.dirichlet();
        let [matrix, factor] = self.entries()?;
        let step = match method {
            HeatMethod::ExplicitEuler => 2.0 * matrix,
            _ => 2.0 * matrix + 2.0 * factor,
        };
        let mut points = Vec::new();
        for steps in (0..8).map(|k| least << k) {
            let h = TIME / steps as f64;
            let mut heat = Heat::new(&metric, dirichlet, method, 1.0, h)?;
            let mut f = self.start.clone();
            (0..steps).try_for_each(|_| heat.step(&mut f))?;
            points.push((steps as f64 * step, largest_difference(&f, exact)));
        }
        Ok(points)
    }

    fn by_modes(&self, counts: &[usize], exact: &[f64]) -> Result<Points, LaplacianError> {
        let metric = self.problem.domain.lumped()?;
        let mut points = Vec::new();
        for &count in counts {
            let modes = lowest_modes(&self.problem.domain, &metric, count)?;
            let f = ExactHeat::new(&modes, &metric, 1.0, &self.start)?.at(TIME)?;
            let work = 2.0 * (count * self.start.len()) as f64;
            points.push((work, largest_difference(&f, exact)));
        }
        Ok(points)
    }
}

fn largest_difference(f: &[f64], g: &[f64]) -> f64 {
    f.iter().zip(g).map(|(f, g)| (f - g).abs()).fold(0.0, f64::max)
}

fn study(size: Size) -> Result<Study, StudyError> {
    let n = match size {
        Size::Default => 12,
        Size::Full => 24,
    };
    let at = StudyError::at::<LaplacianError>;
    let scene = Scene::new(n).map_err(at("the square"))?;
    let metric = scene.problem.domain.lumped().map_err(at("the mass"))?;
    let all = lowest_modes(&scene.problem.domain, &metric, scene.start.len());
    let all = all.map_err(at("all modes"))?;
    let exact = ExactHeat::new(&all, &metric, 1.0, &scene.start).and_then(|heat| heat.at(TIME));
    let exact = exact.map_err(at("the reference"))?;
    let mut table = Table::new([
        Column::exact("method"),
        Column::rounded("multiplications", 3, 0.0),
        Column::rounded("error", 2, 1e-9),
    ]);
    let mut chart =
        Lines::new("", Axis::log("multiplications", ""), Axis::log("largest error", ""));
    let mut claims = Vec::new();
    for (method, order) in HeatMethod::ALL.into_iter().zip([1.0, 1.0, 2.0]) {
        // The explicit method needs some steps for any answer at all.
        let least = if method == HeatMethod::ExplicitEuler { 2 * n * n / 5 } else { 4 };
        let points = scene.stepped(method, &exact, least).map_err(at(method.name()))?;
        let slope = loglog_slope(&points[4..]).unwrap_or(f64::NAN);
        claims.push(Claim::number(
            format!("{}: the error falls with the work to a power", method.name()),
            format!("-{order}"),
            slope,
            (-order - 0.1, -order + 0.1),
        ));
        push(&mut table, &mut chart, method.name(), points);
    }
    let stepped = chart.clone();
    let counts = [2, 4, 8, 16, 32, 64];
    let points = scene.by_modes(&counts, &exact).map_err(at("modes"))?;
    let few = points[4];
    claims.push(Claim::number("thirty-two modes are off by less than", "1e-6", few.1, (0.0, 1e-6)));
    push(&mut table, &mut chart, "exact, few modes", points);
    let asked = Asked {
        question: "Heat in steps, to 1e-4",
        error: 1e-4,
        cost: "multiplications",
        rival: "explicit-euler",
    };
    let answers = asked.of(&stepped).into_iter().collect();
    Ok(Study {
        answers,
        conclusion: format!(
            "A square of {n} x {n} cells, one half of it warm, after {TIME} s, against the discrete \
             Laplacian's exact flow. Explicit steps are cheap but must be short; implicit Euler \
             buys a digit with ten times the work, Crank-Nicolson two digits. The spectral basis \
             wins once its modes are there, because what is missing is what heat kills first; \
             finding the modes and factoring the matrix, once for any number of starts, are not \
             counted."
        ),
        table,
        charts: vec![chart.mark_front().into()],
        claims,
        ..STUDY.heading()
    })
}

fn push(table: &mut Table, chart: &mut Lines, name: &str, points: Points) {
    for &(work, error) in &points {
        table.push([name.into(), work.into(), error.into()]);
    }
    let points = points.into_iter().filter(|(_, error)| *error > 1e-13);
    *chart = chart.clone().with(Series::new(name, points));
}
