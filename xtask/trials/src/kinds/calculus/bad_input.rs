//! Numbers that are none, sizes that do not fit, and nothing at all, for every public function.

use nalgebra::{DMatrix, DVector};
use stationary_calculus::{
    Agreement, Automatic, BilinearForm, ChangeOfBasis, ConjugateGradient, ContravariantTensor,
    Covector, DenseLu, DenseMetric, DenseSink, DenseSolver, DerivativeCheck, DiagonalMetric,
    Energy, Equation, Equilibrium, FunctionEquation, HessianSolver, IterativeSolver,
    LinearTransformation, Metric, Newton, NewtonMemory, Number, Potential, ProductSink, Report,
    Sink, SparseCholesky, SparseEquation, SparseIndefinite, SparseJacobian, SparseMetric,
    SparseSolver, Stencil, StencilHessian, Stencils, SymmetricMatrix, System, Vector, angle,
    differences, least_norm, loglog_slope, project_semidefinite, signed_angle, truncation_regime,
};

use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "bad-input-calculus",
    krate: "calculus",
    rule: "a panic; Ok with a number that is not finite in the answer; Ok of a solve or a check whose \
           tolerance is not a number, or of sizes that do not fit",
    in_tests: 4000,
    trial,
};

fn trial(draw: &mut Draw) -> Verdict {
    let call = draw.below(CALLS.len());
    let (name, call) = CALLS[call];
    draw.note(name);
    call(draw)
}

type Call = fn(&mut Draw) -> Verdict;

const CALLS: &[(&str, Call)] = &[
    ("Newton::solve, settings", newton_settings),
    ("Newton::solve, sizes", newton_sizes),
    ("Newton::solve, numbers", newton_numbers),
    ("NewtonMemory::new", newton_memory),
    ("SparseEquation", sparse_equation),
    ("Equilibrium::find, sizes", equilibrium_sizes),
    ("Equilibrium::find, numbers", equilibrium_numbers),
    ("Equilibrium, solver of another size", equilibrium_of_another_solver),
    ("SparseSolver::new", sparse_solver),
    ("IterativeSolver::new", iterative_solver),
    ("DenseSolver", dense_solver),
    ("SymmetricMatrix::hessian", hessian_of_sizes),
    ("SymmetricMatrix::from_blocks", from_blocks),
    ("SparseCholesky, SparseIndefinite", factors),
    ("ConjugateGradient::solve", conjugate_gradient),
    ("SparseJacobian", sparse_jacobian),
    ("check_potential, sizes", check_sizes),
    ("check_potential, settings", check_settings),
    ("check_potential, blocks", check_blocks),
    ("check_jacobian", check_jacobian),
    ("differences", figure),
    ("metrics", metrics),
    ("Stencils", stencils),
    ("sinks", sinks),
    ("least_norm", shortest),
    ("eigenpairs, changes of basis", matrices),
    ("angles", angles),
    ("slopes", slopes),
    ("project_semidefinite", semidefinite),
    ("DenseLu", dense_lu),
    ("Automatic", automatic),
];

/// A spring from each freedom to the origin and to the next one; reads all of its n numbers.
struct Springs {
    stiffness: Vec<f64>,
}

impl Potential for Springs {
    fn dim(&self) -> usize {
        self.stiffness.len()
    }

    fn energy(&self, q: &[f64]) -> f64 {
        self.stiffness.iter().enumerate().map(|(i, k)| 0.5 * k * q[i] * q[i]).sum()
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        for (i, k) in self.stiffness.iter().enumerate() {
            dv.0[i] += k * q[i];
        }
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        for (i, k) in self.stiffness.iter().enumerate() {
            hessian.add_symmetric(&[i], &[k + 0.0 * q[i]]);
        }
    }
}

fn springs(n: usize) -> Springs {
    Springs { stiffness: (0..n).map(|i| 1.0 + i as f64).collect() }
}

fn any_springs(draw: &mut Draw, n: usize) -> Springs {
    Springs { stiffness: any_vector(draw, n) }
}

/// Mostly plain numbers, any double among them.
fn any(draw: &mut Draw) -> f64 {
    if draw.chance(0.4) { draw.any_f64() } else { draw.symmetric() }
}

fn any_vector(draw: &mut Draw, n: usize) -> Vec<f64> {
    (0..n).map(|_| any(draw)).collect()
}

fn size(draw: &mut Draw) -> usize {
    draw.below(5)
}

fn unit(n: usize) -> DiagonalMetric<Vec<f64>> {
    match DiagonalMetric::new(vec![1.0; n]) {
        Ok(metric) => metric,
        Err(error) => panic!("{error}"),
    }
}

/// Ok hides no number that is not finite.
fn finite<E>(answer: Result<&[f64], E>) -> Verdict {
    match answer {
        Ok(x) if x.iter().all(|x| x.is_finite()) => Verdict::due(),
        Ok(x) => Verdict::wrong(format!("Ok, with {x:?}")),
        Err(_) => Verdict::due(),
    }
}

fn due_unless(wrong: bool, what: &str) -> Verdict {
    if wrong { Verdict::wrong(what) } else { Verdict::due() }
}

fn square_root_of_two() -> impl Equation {
    FunctionEquation::new(
        1,
        |x: &[f64], f: &mut [f64]| f[0] = x[0] * x[0] - 2.0,
        |x: &[f64], df: &mut [f64]| df[0] = 2.0 * x[0],
    )
}

fn newton_settings(draw: &mut Draw) -> Verdict {
    let tolerance = draw.any_f64();
    let newton = Newton { tolerance, iterations: draw.one_of(&[0, 1, 50, 1 << 16]) };
    draw.note(format!("{newton:?}"));
    let mut memory = match NewtonMemory::<[f64; 1]>::new(1, 50) {
        Some(memory) => memory,
        None => return Verdict::wrong("no memory for one unknown"),
    };
    let mut x = [2.0];
    match newton.solve(&mut square_root_of_two(), &mut x, &mut memory) {
        Err(_) => Verdict::due(),
        Ok(report) => {
            let residual = (x[0] * x[0] - 2.0).abs();
            let promised = tolerance.max(1e-15 * 4.0);
            due_unless(
                residual.is_nan() || residual > promised,
                &format!("Ok with a residual of {residual}: {report:?}"),
            )
        }
    }
}

fn newton_sizes(draw: &mut Draw) -> Verdict {
    let (n, m, k) = (size(draw), size(draw), size(draw));
    draw.note(format!("{n} equations, {m} in memory, {k} unknowns"));
    let mut equation = FunctionEquation::new(
        n,
        |x: &[f64], f: &mut [f64]| {
            for i in 0..n {
                f[i] = x[i] - 1.0;
            }
        },
        |_: &[f64], df: &mut [f64]| (0..n).for_each(|i| df[i + n * i] = 1.0),
    );
    let Some(mut memory) = NewtonMemory::<Vec<f64>>::new(m, 50) else {
        return Verdict::wrong("no memory for a few unknowns");
    };
    let mut x = vec![0.5; k];
    let solved = Newton::default().solve(&mut equation, &mut x, &mut memory);
    match solved {
        Ok(_) if n == m && m == k => due_unless(x.iter().any(|&x| x != 1.0), "no root"),
        Ok(_) => Verdict::wrong("Ok of sizes that do not fit"),
        Err(error) if n == m && m == k => Verdict::wrong(error),
        Err(_) => Verdict::due(),
    }
}

fn newton_numbers(draw: &mut Draw) -> Verdict {
    let (a, b, guess) = (any(draw), any(draw), any(draw));
    draw.note(format!("{a} x + {b} = 0 from {guess}"));
    let mut equation = FunctionEquation::new(
        1,
        |x: &[f64], f: &mut [f64]| f[0] = a * x[0] + b,
        |_: &[f64], df: &mut [f64]| df[0] = a,
    );
    let Some(mut memory) = NewtonMemory::<[f64; 1]>::new(1, 50) else {
        return Verdict::wrong("no memory for one unknown");
    };
    let mut x = [guess];
    let solved = Newton::default().solve(&mut equation, &mut x, &mut memory);
    let finite_answer = finite(solved.as_ref().map(|_| &x[..]));
    let residual = finite(solved.as_ref().map(|report| std::slice::from_ref(&report.residual)));
    finite_answer.and(residual)
}

fn newton_memory(draw: &mut Draw) -> Verdict {
    let (n, iterations) = (draw.between(0, 1 << 16), draw.between(0, 1 << 20));
    let made = NewtonMemory::<Vec<f64>>::new(n, iterations).is_some();
    let other = NewtonMemory::<[f64; 2]>::new(n, iterations).is_some();
    due_unless(!made || other != (n == 2), "memory of another size")
}

fn sparse_equation(draw: &mut Draw) -> Verdict {
    let (n, k) = (size(draw), size(draw));
    let diagonal = any_vector(draw, n);
    let Ok(mut equation) = SparseEquation::new(
        &vec![0.0; n],
        |x: &[f64], f: &mut [f64]| (0..n).for_each(|i| f[i] = diagonal[i] * x[i] - 1.0),
        |_: &[f64], df: &mut stationary_calculus::JacobianEntries<'_>| {
            (0..n).for_each(|i| df.add(i, i, diagonal[i]));
        },
    ) else {
        return Verdict::wrong("not analysed");
    };
    let Some(mut memory) = NewtonMemory::<Vec<f64>>::new(k, 50) else {
        return Verdict::wrong("no memory for a few unknowns");
    };
    draw.note(format!("{n} equations, {k} unknowns, {diagonal:?}"));
    let mut x = vec![0.5; k];
    match Newton::default().solve(&mut equation, &mut x, &mut memory) {
        Ok(_) if n != k => Verdict::wrong("Ok of sizes that do not fit"),
        solved => finite(solved.map(|_| &x[..])),
    }
}

fn equilibrium_sizes(draw: &mut Draw) -> Verdict {
    let (n, k) = (size(draw), size(draw));
    draw.note(format!("{n} freedoms, a q of {k}"));
    let (metric, potential) = (unit(n), springs(n));
    let mut q = vec![0.5; k];
    let found = if draw.chance(0.5) {
        let Some(solver) = DenseSolver::<Vec<f64>>::new(n) else {
            return Verdict::wrong("no solver");
        };
        search(&metric, &potential, solver, &mut q)
    } else {
        match SparseSolver::new(&metric, &potential, &vec![0.0; n]) {
            Ok(solver) => search(&metric, &potential, solver, &mut q),
            Err(error) => return Verdict::wrong(error),
        }
    };
    due_unless(found != (n == k), "sizes that do not fit, or fit and are refused")
}

/// Whether an equilibrium was found.
fn search(
    metric: &impl Metric,
    potential: &impl Potential,
    solver: impl HessianSolver,
    q: &mut [f64],
) -> bool {
    let search = Equilibrium::new(metric, potential, solver, Newton::default());
    search.is_ok_and(|mut search| search.find(q).is_ok())
}

fn equilibrium_numbers(draw: &mut Draw) -> Verdict {
    let n = draw.between(1, 3);
    let potential = any_springs(draw, n);
    let mut q = any_vector(draw, n);
    let tolerance = if draw.chance(0.5) { 0.0 } else { draw.any_f64() };
    draw.note(format!("k {:?}, q {q:?}, tolerance {tolerance}", potential.stiffness));
    let metric = unit(n);
    let Some(solver) = DenseSolver::<Vec<f64>>::new(n) else { return Verdict::wrong("no solver") };
    let newton = Newton { tolerance, iterations: 50 };
    let found = match Equilibrium::new(&metric, &potential, solver, newton) {
        Ok(mut search) => search.find(&mut q).map(|report| report.newton.residual),
        Err(error) => return Verdict::wrong(error),
    };
    if found.is_ok() && tolerance.is_nan() {
        return Verdict::wrong("Ok to a tolerance that is not a number");
    }
    finite(found.as_ref().map(std::slice::from_ref)).and(finite(found.as_ref().map(|_| &q[..])))
}

fn equilibrium_of_another_solver(draw: &mut Draw) -> Verdict {
    let (n, k) = (size(draw), size(draw));
    draw.note(format!("{n} freedoms, a solver of {k}"));
    let (metric, potential) = (unit(n), springs(n));
    let mut q = vec![0.5; n];
    let found = if draw.chance(0.5) {
        let Some(solver) = DenseSolver::<Vec<f64>>::new(k) else {
            return Verdict::wrong("no solver");
        };
        search(&metric, &potential, solver, &mut q)
    } else {
        match SparseSolver::new(&unit(k), &springs(k), &vec![0.0; k]) {
            Ok(solver) => search(&metric, &potential, solver, &mut q),
            Err(error) => return Verdict::wrong(error),
        }
    };
    due_unless(found != (n == k), "sizes that do not fit, or fit and are refused")
}

fn sparse_solver(draw: &mut Draw) -> Verdict {
    let (n, k, l) = (size(draw), size(draw), size(draw));
    draw.note(format!("a metric of {n}, a potential of {k}, a q of {l}"));
    let made = SparseSolver::new(&unit(n), &springs(k), &vec![0.0; l]).is_ok();
    due_unless(made && (k > n || l < k), "made of sizes that do not fit")
}

fn iterative_solver(draw: &mut Draw) -> Verdict {
    let (n, k, l) = (size(draw), size(draw), size(draw));
    let method = ConjugateGradient { tolerance: any(draw), iterations: draw.below(100) };
    draw.note(format!("a metric of {n}, a potential of {k}, a q of {l}, {method:?}"));
    let (metric, potential, q) = (unit(n), springs(k), vec![0.0; l]);
    let Ok(mut solver) = IterativeSolver::new(method, &metric, &potential, &q) else {
        return Verdict::due();
    };
    if k > n || l < k {
        return Verdict::wrong("made of sizes that do not fit");
    }
    let mut r = any_vector(draw, n);
    let given = r.clone();
    if solver.factor(&metric, &potential, &q, 1.0).is_err() {
        return Verdict::wrong("a definite matrix is refused");
    }
    solver.solve(&mut r);
    match solver.last() {
        Some(Ok(_)) if method.tolerance.is_nan() => {
            Verdict::wrong("Ok to a tolerance that is not a number")
        }
        Some(Ok(_)) => finite(Ok::<_, ()>(&r[..])),
        Some(Err(_)) => Verdict::due(),
        None => Verdict::wrong(format!("no end of a solve of {given:?}")),
    }
}

fn dense_solver(draw: &mut Draw) -> Verdict {
    let (n, k, l) = (size(draw), size(draw), size(draw));
    draw.note(format!("a solver of {n}, a metric of {k}, a potential of {l}"));
    let Some(mut solver) = DenseSolver::<Vec<f64>>::new(n) else {
        return Verdict::wrong("no solver");
    };
    let potential = any_springs(draw, l);
    let [m, a] = [any(draw), any(draw)];
    let metric = unit(k);
    let q = vec![0.0; l];
    match solver.factor_weighted(m, &metric, a, &potential, &q) {
        Err(_) => Verdict::due(),
        Ok(_) if n != k || l > n => Verdict::wrong("Ok of sizes that do not fit"),
        Ok(rung) => {
            let mut r = vec![1e-3; n];
            solver.solve(&mut r);
            let all = r.iter().all(|x| x.is_nan()) || r.iter().all(|x| x.is_finite());
            due_unless(r.iter().any(|x| x.is_nan()) && !all, &format!("{rung:?}: {r:?}"))
        }
    }
}

fn hessian_of_sizes(draw: &mut Draw) -> Verdict {
    let (n, k) = (size(draw), size(draw));
    draw.note(format!("a potential of {n}, a q of {k}"));
    let made = SymmetricMatrix::hessian(&springs(n), &vec![0.0; k]).is_ok();
    due_unless(made && k < n, "made of sizes that do not fit")
}

fn blocks(draw: &mut Draw, n: usize) -> Vec<(Vec<usize>, Vec<f64>)> {
    let block = |draw: &mut Draw| {
        let k = draw.below(4);
        let entries = if draw.chance(0.8) { k * k } else { draw.below(12) };
        let freedoms = (0..k).map(|_| draw.below(n + 1)).collect();
        (freedoms, any_vector(draw, entries))
    };
    (0..draw.below(4)).map(|_| block(draw)).collect()
}

fn from_blocks(draw: &mut Draw) -> Verdict {
    let n = size(draw);
    let blocks = blocks(draw, n);
    draw.note(format!("{n} freedoms, {blocks:?}"));
    let fits = blocks.iter().all(|(freedoms, entries)| {
        entries.len() == freedoms.len() * freedoms.len() && freedoms.iter().all(|&f| f < n)
    });
    match SymmetricMatrix::from_blocks(n, &blocks) {
        Ok(_) if !fits => Verdict::wrong("made of blocks that do not fit"),
        _ => Verdict::due(),
    }
}

fn factors(draw: &mut Draw) -> Verdict {
    let n = draw.between(1, 4);
    let entries: Vec<([usize; 1], [f64; 1])> = (0..n).map(|i| ([i], [any(draw)])).collect();
    draw.note(format!("diagonal {entries:?}"));
    let Ok(matrix) = SymmetricMatrix::from_blocks(n, &entries) else {
        return Verdict::wrong("not assembled");
    };
    let (Ok(mut cholesky), Ok(mut indefinite)) =
        (SparseCholesky::analyse(&matrix), SparseIndefinite::analyse(&matrix))
    else {
        return Verdict::wrong("not analysed");
    };
    let length = size(draw);
    let mut b = any_vector(draw, length);
    let positive = entries.iter().all(|(_, [x])| *x > 0.0 && x.is_finite());
    if cholesky.factor(&matrix).is_ok() != positive {
        return Verdict::wrong("definite and refused, or not and factored");
    }
    let counted = cholesky.inertia(&matrix);
    if counted.is_ok() && entries.iter().any(|(_, [x])| *x == 0.0 || !x.is_finite()) {
        return Verdict::wrong(format!("counted {counted:?}"));
    }
    let solved = indefinite.factor(&matrix).and_then(|_| indefinite.solve(&matrix, &mut b));
    if solved.is_ok() && length != n {
        return Verdict::wrong("Ok of sizes that do not fit");
    }
    finite(solved.map(|_| &b[..]))
}

fn conjugate_gradient(draw: &mut Draw) -> Verdict {
    let (n, k) = (size(draw), size(draw));
    let method = ConjugateGradient { tolerance: any(draw), iterations: draw.below(100) };
    let (metric, potential) = (unit(n), any_springs(draw, n));
    let (r, length) = (any_vector(draw, n), size(draw));
    let mut x = vec![0.0; k];
    draw.note(format!(
        "{n}, x of {k}, q of {length}, {method:?}, {:?}, {r:?}",
        potential.stiffness
    ));
    let q = vec![0.0; length];
    let solved = method.solve(any(draw), &metric, 1.0, &potential, &q, &r, &mut x);
    match solved {
        Ok(_) if n != k || length < n => Verdict::wrong("Ok of sizes that do not fit"),
        Ok(_) if method.tolerance.is_nan() => Verdict::wrong("Ok to a tolerance that is none"),
        solved => finite(solved.map(|_| &x[..])),
    }
}

fn sparse_jacobian(draw: &mut Draw) -> Verdict {
    let (rows, columns) = (size(draw), size(draw));
    let entries: Vec<(usize, usize, f64)> = (0..draw.below(5))
        .map(|_| (draw.below(rows + 1), draw.below(columns + 1), any(draw)))
        .collect();
    draw.note(format!("{rows} x {columns}, {entries:?}"));
    let visit = |sink: &mut stationary_calculus::JacobianEntries<'_>| {
        entries.iter().for_each(|&(i, j, value)| sink.add(i, j, value));
    };
    let fits = entries.iter().all(|&(i, j, _)| i < rows && j < columns);
    let Ok(mut jacobian) = SparseJacobian::analyse(rows, columns, visit) else {
        return due_unless(fits, "refused");
    };
    let (k, l) = (size(draw), size(draw));
    let filled = jacobian.refill(visit).is_ok();
    let fitted = jacobian.add_product(1.0, &vec![1.0; k], &mut vec![0.0; l]).is_ok();
    let turned = jacobian.add_transposed_product(1.0, &vec![1.0; k], &mut vec![0.0; l]).is_ok();
    let wrong = !fits
        || !filled
        || fitted != (k == columns && l == rows)
        || turned != (k == rows && l == columns);
    due_unless(wrong, "sizes that do not fit, or fit and are refused")
}

fn check_sizes(draw: &mut Draw) -> Verdict {
    let (n, k) = (size(draw), size(draw));
    draw.note(format!("a potential of {n}, a q of {k}"));
    let checked = DerivativeCheck::default().potential(&springs(n), &vec![0.5; k]);
    due_unless(checked.is_ok() != (n == k), "sizes that do not fit, or fit and are refused")
}

/// V = x^2/2 with a differential of another slope.
struct Steep(f64);

impl Potential for Steep {
    fn dim(&self) -> usize {
        1
    }

    fn energy(&self, q: &[f64]) -> f64 {
        0.5 * q[0] * q[0]
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        dv.0[0] += self.0 * q[0];
    }

    fn add_hessian(&self, _: &[f64], hessian: &mut impl Sink) {
        hessian.add_symmetric(&[0], &[self.0]);
    }
}

fn check_settings(draw: &mut Draw) -> Verdict {
    let usual = DerivativeCheck::default();
    let check = DerivativeCheck {
        tolerance: if draw.chance(0.5) { draw.any_f64() } else { usual.tolerance },
        length: draw.chance(0.5).then(|| draw.any_f64()),
        configurations: draw.below(6),
        seed: draw.word(),
    };
    draw.note(format!("{check:?}"));
    let slope = draw.one_of(&[2.0, 0.5, -1.0]);
    let ratio = (slope - 1.0_f64).abs() / slope.abs();
    let blind = check.tolerance >= ratio || check.length.is_some_and(|l| !(1e-3..1e3).contains(&l));
    match check.potential(&Steep(slope), &[0.7]) {
        Err(_) => Verdict::due(),
        Ok(report) if check.tolerance.is_nan() => {
            Verdict::wrong(format!("passes to a tolerance of NaN, unseen {}", report.unseen()))
        }
        Ok(report) => {
            let unseen = report.unseen();
            let told = blind && (check.tolerance >= ratio || unseen >= 0.1 || !unseen.is_finite());
            due_unless(!told, &format!("passes {slope} for 1, unseen {unseen}"))
        }
    }
}

/// A potential without energy that gives any blocks.
struct AnyBlocks(usize, Vec<(Vec<usize>, Vec<f64>)>);

impl Potential for AnyBlocks {
    fn dim(&self) -> usize {
        self.0
    }

    fn energy(&self, _: &[f64]) -> f64 {
        0.0
    }

    fn add_differential(&self, _: &[f64], _: Covector<&mut [f64]>) {}

    fn add_hessian(&self, _: &[f64], hessian: &mut impl Sink) {
        for (freedoms, entries) in &self.1 {
            hessian.add_symmetric(freedoms, entries);
        }
    }
}

fn check_blocks(draw: &mut Draw) -> Verdict {
    let n = size(draw);
    let potential = AnyBlocks(n, blocks(draw, n));
    draw.note(format!("{n} freedoms, {:?}", potential.1));
    let fits = potential.1.iter().all(|(freedoms, entries)| {
        entries.len() == freedoms.len() * freedoms.len() && freedoms.iter().all(|&f| f < n)
    });
    let nothing = potential.1.iter().all(|(_, entries)| entries.iter().all(|&x| x == 0.0));
    let checked = DerivativeCheck::default().potential(&potential, &vec![0.5; n]);
    // Blocks that cancel are no mistake, and these are too few to.
    due_unless(
        checked.is_ok() && (!fits || potential.1.len() == 1 && !nothing),
        "passes blocks that do not fit",
    )
}

fn check_jacobian(draw: &mut Draw) -> Verdict {
    let (n, m, rows, columns) = (size(draw), size(draw), size(draw), size(draw));
    let later = if draw.chance(0.3) { size(draw) } else { m };
    draw.note(format!("q of {n}, f of {m} and then {later}, a matrix of {rows} x {columns}"));
    let q = vec![0.5; n];
    let f = |x: &[f64]| vec![0.0; if x == q.as_slice() { m } else { later }];
    let df = |_: &[f64]| DMatrix::zeros(rows, columns);
    let checked = DerivativeCheck::default().jacobian(f, df, &q);
    let fits = rows == m && columns == n && (later == m || n == 0);
    due_unless(checked.is_ok() != fits, "sizes that do not fit, or fit and are refused")
}

fn figure(draw: &mut Draw) -> Verdict {
    let (n, m, k) = (size(draw), size(draw), size(draw));
    let (rows, columns) = (size(draw), size(draw));
    let later = if draw.chance(0.3) { size(draw) } else { m };
    draw.note(format!("q of {n}, w of {k}, f of {m} and then {later}, {rows} x {columns}"));
    let q = vec![0.5; n];
    let f = |x: &[f64]| vec![1.0; if x == q.as_slice() { m } else { later }];
    let steps = any_vector(draw, 3);
    let w = vec![1.0; k];
    let made = differences(f, &DMatrix::zeros(rows, columns), &q, Vector(&w[..]), &steps);
    match made {
        Ok(_) if rows != m || columns != n || k != n => {
            Verdict::wrong("Ok of sizes that do not fit")
        }
        Ok(made) => {
            // Whatever the steps were, what is printed of them is text.
            due_unless(made.to_string().is_empty(), "nothing is printed")
        }
        Err(_) => Verdict::due(),
    }
}

fn metrics(draw: &mut Draw) -> Verdict {
    let n = size(draw);
    let mass = any_vector(draw, n);
    draw.note(format!("masses {mass:?}"));
    let good = mass.iter().all(|&m| m > 0.0 && m.is_finite());
    let diagonal = DiagonalMetric::new(mass.clone());
    if diagonal.is_ok() && !good {
        return Verdict::wrong("a mass that is none");
    }
    let dense = DenseMetric::new(DMatrix::from_diagonal(&DVector::from_column_slice(&mass)));
    if dense.is_ok() && !good {
        return Verdict::wrong("a mass that is none, in a full matrix");
    }
    let rows = size(draw);
    let wide = DenseMetric::new(DMatrix::from_element(rows, n, any(draw)));
    if wide.is_ok() && rows != n {
        return Verdict::wrong("a mass matrix that is not square");
    }
    if let Ok(metric) = &dense {
        let mut values = vec![0.0; n * n];
        if let Some(mut sink) = DenseSink::new(1.0, n, &mut values) {
            metric.add_matrix(&mut sink);
        }
    }
    let blocks: Vec<([usize; 1], [f64; 1])> = (0..n).map(|i| ([i], [mass[i]])).collect();
    let sparse = SymmetricMatrix::from_blocks(n, &blocks).and_then(SparseMetric::new);
    if sparse.is_ok() && !good {
        return Verdict::wrong("a mass that is none, in a sparse matrix");
    }
    let k = size(draw);
    let system = System::new(unit(n), springs(k));
    due_unless(system.is_ok() != (n == k), "a system of sizes that do not fit")
}

/// A spring between two vertices of a line.
struct Pair([usize; 2]);

impl Stencil<2, 1> for Pair {
    fn vertices(&self) -> [usize; 2] {
        self.0
    }

    fn energy(&self, [x, y]: &[[f64; 1]; 2]) -> f64 {
        0.5 * (y[0] - x[0]).powi(2)
    }

    fn differential(&self, [x, y]: &[[f64; 1]; 2]) -> [[f64; 1]; 2] {
        [[x[0] - y[0]], [y[0] - x[0]]]
    }

    fn hessian(
        &self,
        _: &[[f64; 1]; 2],
        _: stationary_calculus::Curvature,
    ) -> StencilHessian<2, 1> {
        [[[[1.0], [-1.0]]], [[[-1.0], [1.0]]]]
    }
}

fn stencils(draw: &mut Draw) -> Verdict {
    let (free, fixed) = (size(draw), size(draw));
    let pairs: Vec<[usize; 2]> =
        (0..draw.below(4)).map(|_| [draw.below(9), draw.below(9)]).collect();
    draw.note(format!("{free} free, {fixed} fixed, {pairs:?}"));
    let known = pairs.iter().flatten().all(|&v| v < free + fixed);
    let whole = Stencils::new(free, vec![[0.0]; fixed], pairs.iter().map(|&p| Pair(p)).collect());
    match whole {
        Ok(_) if !known => Verdict::wrong("made of vertices that are not there"),
        Err(_) => due_unless(known, "refused"),
        Ok(whole) => {
            let k = size(draw);
            let checked = DerivativeCheck::default().potential(&whole, &vec![0.3; k]);
            let matrix = SymmetricMatrix::hessian(&whole, &vec![0.3; k]);
            due_unless(
                (checked.is_ok() || matrix.is_ok()) && k != free,
                "a q of another size is taken",
            )
        }
    }
}

fn sinks(draw: &mut Draw) -> Verdict {
    let (n, k, l) = (size(draw), draw.below(20), size(draw));
    draw.note(format!("n {n}, {k} values, a vector of {l}"));
    let mut values = vec![0.0; k];
    let dense = DenseSink::new(any(draw), n, &mut values).is_some();
    let x = vec![0.0; n];
    let mut y = vec![0.0; l];
    let product = ProductSink::new(any(draw), &x, &mut y).is_some();
    due_unless(dense != (k == n * n) || product != (n == l), "made of sizes that do not fit")
}

fn shortest(draw: &mut Draw) -> Verdict {
    let (rows, columns, k) = (size(draw), size(draw), size(draw));
    let a = DMatrix::from_vec(rows, columns, any_vector(draw, rows * columns));
    let b = DVector::from_vec(any_vector(draw, k));
    let tolerance = any(draw);
    draw.note(format!("{rows} x {columns} {:?}, b {:?}, {tolerance}", a.as_slice(), b.as_slice()));
    match least_norm(&a, &b, tolerance) {
        Ok(_) if k != rows || tolerance.is_nan() => Verdict::wrong("Ok of what does not fit"),
        Ok(found) => finite(Ok::<_, ()>(found.x.as_slice()))
            .and(finite(Ok::<_, ()>(found.singular_values.as_slice())))
            .and(finite(Ok::<_, ()>(&[found.residual]))),
        Err(_) => Verdict::due(),
    }
}

fn matrices(draw: &mut Draw) -> Verdict {
    let (rows, columns, n) = (size(draw), size(draw), size(draw));
    let a = DMatrix::from_vec(rows, columns, any_vector(draw, rows * columns));
    let symmetric = {
        let half = DMatrix::from_vec(n, n, any_vector(draw, n * n));
        DMatrix::from_fn(n, n, |i, j| half[(i.max(j), i.min(j))])
    };
    draw.note(format!("{rows} x {columns} {:?}, {n} {:?}", a.as_slice(), symmetric.as_slice()));
    let metric = BilinearForm(if draw.chance(0.5) { symmetric.clone() } else { a.clone() });
    let mut verdict = Verdict::due();
    for pairs in [
        BilinearForm(symmetric.clone()).eigenpairs(&metric),
        BilinearForm(a.clone()).eigenpairs(&metric),
        LinearTransformation(a.clone()).eigenpairs(&metric),
        BilinearForm(symmetric.clone()).eigenpairs(&BilinearForm(DMatrix::identity(n, n))),
    ]
    .into_iter()
    .flatten()
    {
        verdict = verdict
            .and(finite(Ok::<_, ()>(pairs.values.as_slice())))
            .and(finite(Ok::<_, ()>(pairs.vectors.as_slice())));
    }
    let linear = LinearTransformation(a.clone());
    let fits = [
        linear.apply(&Vector(vec![1.0; n])).is_ok() == (columns == n),
        BilinearForm(a.clone()).apply(&Vector(vec![1.0; n]), &Vector(vec![1.0; rows])).is_ok()
            == (rows == n && columns == rows),
        linear.is_self_adjoint(&metric).is_err() || metric.0.ncols() == rows,
    ];
    if fits.contains(&false) {
        return Verdict::wrong("sizes that do not fit, or fit and are refused");
    }
    if let Ok(change) = ChangeOfBasis::new(a.clone()) {
        if rows != columns {
            return Verdict::wrong("a change of basis that is not square");
        }
        let turned = change.vector(&Vector(vec![1.0; n]));
        if turned.is_ok() && n != rows {
            return Verdict::wrong("a vector of another size");
        }
        if let Ok(turned) = turned {
            verdict = verdict.and(finite(Ok::<_, ()>(&turned.0[..])));
        }
        drop(change.covector(&Covector(vec![1.0; n])));
        drop(change.transformation(&LinearTransformation(symmetric.clone())));
        drop(change.form(&BilinearForm(symmetric.clone())));
        drop(change.contravariant(&ContravariantTensor(symmetric)));
    }
    verdict
}

fn angles(draw: &mut Draw) -> Verdict {
    let [u, v, n]: [[f64; 3]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| any(draw)));
    draw.note(format!("{u:?} {v:?} {n:?}"));
    let found = [angle(&u, &v), signed_angle(&u, &v, &n)];
    let limit = std::f64::consts::PI;
    let wrong = |angle: &f64| !angle.is_finite() || angle.abs() > limit;
    due_unless(found.iter().flatten().any(wrong), &format!("angles {found:?}"))
}

fn slopes(draw: &mut Draw) -> Verdict {
    let points: Vec<(f64, f64)> =
        (0..draw.below(6)).map(|_| (any(draw).abs(), any(draw).abs())).collect();
    draw.note(format!("{points:?}"));
    let kept = truncation_regime(&points);
    let slope = loglog_slope(kept).or(loglog_slope(&points));
    due_unless(slope.is_some_and(|slope| !slope.is_finite()), &format!("a slope of {slope:?}"))
}

fn semidefinite(draw: &mut Draw) -> Verdict {
    let half: [f64; 4] = std::array::from_fn(|_| any(draw));
    let block: StencilHessian<2, 1> = [[[[half[0]], [half[1]]]], [[[half[1]], [half[2]]]]];
    draw.note(format!("{block:?}"));
    let good = half[..3].iter().all(|x| x.is_finite());
    let block = project_semidefinite(&block);
    let numbers = block.as_flattened().as_flattened().as_flattened();
    let largest = half[..3].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    due_unless(
        good && largest < 1e300 && numbers.iter().any(|x| !x.is_finite()),
        &format!("projected to {block:?}"),
    )
}

fn dense_lu(draw: &mut Draw) -> Verdict {
    let n = draw.below(5);
    let mut lu = DenseLu::new(n);
    let entries = any_vector(draw, n * n);
    draw.note(format!("{entries:?}"));
    lu.matrix().copy_from_slice(&entries);
    let factored = lu.factor();
    if factored.is_ok() && entries.iter().any(|x| !x.is_finite()) {
        return Verdict::wrong("factored numbers that are not finite");
    }
    let mut b = vec![1.0; n];
    if factored.is_ok() {
        lu.solve(&mut b);
        return due_unless(b.iter().any(|x| x.is_nan()), &format!("Ok, and solved to {b:?}"));
    }
    Verdict::due()
}

struct Well;

impl Energy<2> for Well {
    fn energy<R: Number>(&self, [x, y]: [R; 2]) -> R {
        (x * x - 1.0).powi(2) + y * y
    }
}

fn automatic(draw: &mut Draw) -> Verdict {
    let k = size(draw);
    let q = any_vector(draw, k);
    draw.note(format!("q {q:?}"));
    let well = Automatic(Well);
    let checked = DerivativeCheck::default().potential(&well, &q);
    let Ok(report) = checked else { return Verdict::due() };
    if k != 2 {
        return Verdict::wrong("Ok of another size");
    }
    let Report { agreements } = report;
    let blind = |part: &Agreement| part.unseen.is_nan();
    due_unless(agreements.iter().any(blind), "blind to NaN")
}
