//! A factor or iteration: which solves a step of statics sooner, by the size of the body.

use std::time::Instant;

use stationary_calculus::{
    ConjugateGradient, DiagonalMetric, HessianSolver, IterativeSolver, Ordering, SparseSolver,
};
use stationary_chart::{Axis, Lines, Series};
use stationary_elasticity::{
    ElasticityError, Elements, Freedoms, Lame, LinearTetrahedron, NeoHookean, Solid, lumped_mass,
};
use stationary_measure::{Column, Table, loglog_slope};
use stationary_mesh::cuboid;

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Work, time and memory of both against freedoms.
pub const STUDY: Entry<'static> = Entry {
    id: "factor-or-iterate",
    krate: "elasticity",
    chapter: "A.1",
    kind: Kind::WorkPrecision,
    title: "Cube of rubber: cost of a factor and of iteration against freedoms",
    tested: Tested::Claims,
    run: &study,
};

/// When iteration has arrived: a residual of this part of the load.
const TOLERANCE: f64 = 1e-8;

/// Runs of which the shortest time counts.
const RUNS: usize = 3;

/// A cube of rubber clamped at one side, and a load on its freedoms.
struct Cube {
    solid: Solid<NeoHookean<3>, 4, 3, 3, 1>,
    metric: DiagonalMetric<Vec<f64>>,
    q: Vec<f64>,
    load: Vec<f64>,
}

impl Cube {
    fn new(cells: usize) -> Result<Self, ElasticityError> {
        let mesh = cuboid([1.0; 3], [cells; 3])?;
        let freedoms = Freedoms::<3>::held_where(&mesh.nodes(), |x, _| x[0] == 0.0)?;
        let metric = lumped_mass(LinearTetrahedron, &mesh, [1e3, 1.0], &freedoms)?;
        let rubber = NeoHookean::new(Lame::<3>::from_young_poisson(1e6, 0.3)?)?;
        let q = freedoms.gathered(&mesh.nodes())?;
        let solid = Solid::new(LinearTetrahedron, &mesh, 1.0, rubber, freedoms)?;
        let load = (0..q.len()).map(|i| if i % 3 == 2 { -1.0 } else { 0.0 }).collect();
        Ok(Cube { solid, metric, q, load })
    }

    /// The answer of a solver that is made already, and the shortest time that it took.
    fn solved(&self, solver: &mut impl HessianSolver) -> Result<(Vec<f64>, f64), StudyError> {
        let (mut answer, mut least) = (Vec::new(), f64::INFINITY);
        for _ in 0..RUNS {
            answer.clone_from(&self.load);
            let start = Instant::now();
            let rung = solver.factor_weighted(0.0, &self.metric, 1.0, &self.solid, &self.q);
            rung.map_err(StudyError::at("the matrix of a cube"))?;
            solver.solve(&mut answer);
            least = least.min(start.elapsed().as_secs_f64());
        }
        Ok((answer, least))
    }
}

/// What one step costs by a factor and by iteration.
struct Cost {
    freedoms: f64,
    multiplications: [f64; 2],
    seconds: [f64; 2],
    /// Numbers that are kept: the factor's, the matrix's.
    entries: [f64; 2],
    iterations: f64,
    gap: f64,
}

fn cost(cells: usize) -> Result<Cost, StudyError> {
    let cube = Cube::new(cells).map_err(StudyError::at("a cube"))?;
    let Cube { solid, metric, q, .. } = &cube;
    let order = Ordering::NestedDissection;
    let mut direct = SparseSolver::by_ordering(metric, solid, q, order)
        .map_err(StudyError::at("the pattern of a cube"))?;
    let method = ConjugateGradient { tolerance: TOLERANCE, iterations: 10_000 };
    let mut iterative = IterativeSolver::new(method, metric, solid, q)
        .map_err(StudyError::at("the pattern of a cube"))?;
    let (by_factor, factor_seconds) = cube.solved(&mut direct)?;
    let (by_iteration, iteration_seconds) = cube.solved(&mut iterative)?;
    let end = iterative.last().transpose().map_err(StudyError::at("conjugate gradients"))?;
    let iterations = end.map_or(f64::NAN, |end| end.iterations as f64);
    let n = q.len() as f64;
    let entries = [direct.cholesky().factor_len(), iterative.matrix().values().len()];
    let [factor, matrix] = entries.map(|entries| entries as f64);
    // Of each iteration: the product, the blocks of three freedoms back and forth, five vectors.
    let iteration = 2.0 * matrix + 4.0 * n + 5.0 * n;
    let largest = by_factor.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    let gaps = by_factor.iter().zip(&by_iteration).map(|(a, b)| (a - b).abs() / largest);
    Ok(Cost {
        freedoms: n,
        multiplications: [
            direct.cholesky().multiplications() + 2.0 * factor,
            iterations * iteration,
        ],
        seconds: [factor_seconds, iteration_seconds],
        entries: [factor, matrix],
        iterations,
        gap: gaps.fold(0.0, f64::max),
    })
}

/// The freedoms at which the factor begins to cost more, between two neighbours on logarithmic
/// axes.
fn crossing(costs: &[Cost], of: impl Fn(&Cost) -> [f64; 2]) -> Option<f64> {
    let excess = |cost: &Cost| {
        let [factor, iteration] = of(cost);
        (factor / iteration).ln()
    };
    costs.windows(2).rev().find_map(|pair| {
        let [a, b] = [excess(&pair[0]), excess(&pair[1])];
        let t = a / (a - b);
        let between = pair[0].freedoms.ln() * (1.0 - t) + pair[1].freedoms.ln() * t;
        (a <= 0.0 && b > 0.0).then(|| between.exp())
    })
}

fn table(costs: &[Cost]) -> Table {
    let mut table = Table::new([
        Column::exact("freedoms"),
        Column::rounded("multiplications, factor", 3, 0.0),
        Column::rounded("multiplications, iteration", 3, 0.0),
        Column::exact("iterations"),
        Column::exact("numbers of the factor"),
        Column::exact("numbers of the matrix"),
        Column::rounded("gap", 1, 1e-5),
        Column::volatile("time, factor [s]"),
        Column::volatile("time, iteration [s]"),
    ]);
    for cost in costs {
        table.push([
            (cost.freedoms as u64).into(),
            cost.multiplications[0].into(),
            cost.multiplications[1].into(),
            (cost.iterations as u64).into(),
            (cost.entries[0] as u64).into(),
            (cost.entries[1] as u64).into(),
            cost.gap.into(),
            cost.seconds[0].into(),
            cost.seconds[1].into(),
        ]);
    }
    table
}

/// The two lines of a chart.
fn lines(title: &str, axis: Axis, costs: &[Cost], of: impl Fn(&Cost) -> [f64; 2]) -> Lines {
    let series = |name: &str, k: usize| {
        Series::new(name, costs.iter().map(|cost| (cost.freedoms, of(cost)[k])))
    };
    Lines::new(title, Axis::log("freedoms", ""), axis)
        .with(series("factor", 0))
        .with(series("conjugate gradients", 1))
}

fn study(size: Size) -> Result<Study, StudyError> {
    let sides: &[usize] =
        if size == Size::Full { &[2, 3, 4, 6, 9, 13, 18, 26] } else { &[2, 3, 4, 6, 9, 12] };
    let costs = sides.iter().map(|&cells| cost(cells)).collect::<Result<Vec<_>, _>>()?;
    let power = |of: fn(&Cost) -> f64| {
        let points: Vec<_> = costs.iter().skip(2).map(|cost| (cost.freedoms, of(cost))).collect();
        loglog_slope(&points).unwrap_or(f64::NAN)
    };
    let fill = power(|cost| cost.entries[0]);
    let work = power(|cost| cost.multiplications[0]);
    let iterations = power(|cost| cost.iterations);
    let crossed = crossing(&costs, |cost| cost.multiplications).unwrap_or(f64::NAN);
    let gap = costs.iter().map(|cost| cost.gap).fold(0.0, f64::max);
    Ok(Study {
        conclusion: format!(
            "One step of Newton's method for a cube of rubber, clamped at one side: by Cholesky's \
             factor in an order of nested dissection, and by conjugate gradients with the blocks \
             of the vertices as preconditioner, to a residual of {TOLERANCE:e}. Counted in \
             multiplications the lines cross at {crossed:.0} freedoms. In time they cross far \
             later, at some 40,000 freedoms (the full size shows it), because a factor multiplies \
             dense panels, many times as fast as a sparse product. Beyond, the factor loses \
             twice: its numbers grow as the power {fill:.2} of the freedoms and its \
             multiplications as {work:.2}, while iteration keeps the matrix alone and takes \
             {iterations:.2} for the power of its count. Thin or nearly incompressible bodies \
             take many more iterations, and many right-hand sides share one factor: both move the \
             crossing up."
        ),
        table: table(&costs),
        charts: vec![
            lines("Work", Axis::log("multiplications", ""), &costs, |c| c.multiplications).into(),
            lines("Time", Axis::log("time of one step", "s"), &costs, |c| c.seconds).into(),
            lines("Memory", Axis::log("numbers kept", ""), &costs, |c| c.entries).into(),
        ],
        claims: vec![
            Claim::number("largest gap between the two answers", "below 1e-5", gap, (0.0, 1e-5)),
            Claim::number(
                "freedoms at which the factor begins to take more multiplications",
                "some hundreds",
                crossed,
                (100.0, 2000.0),
            ),
            Claim::number(
                "power of the freedoms in the factor's numbers",
                "4/3",
                fill,
                (1.25, 1.7),
            ),
            Claim::number(
                "power of the freedoms in the factor's multiplications",
                "2",
                work,
                (1.8, 2.5),
            ),
            Claim::number(
                "power of the freedoms in the iterations",
                "1/3",
                iterations,
                (0.2, 0.45),
            ),
        ],
        ..STUDY.heading()
    })
}
