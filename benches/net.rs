//! A spring net of 100 x 100 vertices: the cost of an implicit step, split, and of an explicit one.
//!
//! `cargo bench --bench net` prints the parts of an implicit Euler step, then ratios of runs taken in
//! turn: our factorization over faer called directly, and a typed step over one by hand.

mod in_turn;

use std::hint::black_box;

use criterion::Criterion;
use faer::Side;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Par, linalg::cholesky::llt::factor::LltRegularization};
use stationary_calculus::{
    Covector, DiagonalMetric, HessianSolver, Metric, Potential, SparseCholesky, SparseSolver,
    Stencils, SymmetricMatrix, System,
};
use stationary_elasticity::{Net, Spring, Strain, net};
use stationary_integrators::{ImplicitEuler, Integrator, State, StormerVerlet, UniformGravity};

const SIDE: usize = 100;
const MASS: f64 = 1e-3;
const STIFFNESS: f64 = 100.0;
const SPACING: f64 = 0.01;
const H: f64 = 1e-3;
const GRAVITY: f64 = -9.81;

type Springs<const D: usize> = Stencils<Spring, 2, D>;
type Hanging<const D: usize> = System<DiagonalMetric<Vec<f64>>, (Springs<D>, UniformGravity<D>)>;

/// A net whose first row is held, a little out of shape so that nothing is zero by accident.
fn hanging<const D: usize>(side: usize) -> (Hanging<D>, State<Vec<f64>>) {
    let size = Net {
        rows: side + 1,
        columns: side,
        spacing: SPACING,
        stiffness: STIFFNESS,
        strain: Strain::Cauchy,
    };
    let place = |vertex: usize| -> [f64; D] {
        let (row, column) = (vertex / side, vertex % side);
        let flat = [column as f64, -(row as f64), 0.0];
        std::array::from_fn(|c| SPACING * (flat[c] + 0.02 * ((vertex * D + c) as f64).sin()))
    };
    // The generator counts from the top; fixed vertices come last, so the rows are turned over.
    let turned = |vertex: usize| (side - vertex / side) * side + vertex % side;
    let springs = net(size).expect("a net");
    let springs: Vec<Spring> = springs
        .iter()
        .map(|spring| {
            let ends = stationary_calculus::Stencil::<2, D>::vertices(spring).map(turned);
            Spring::new(ends, spring.rest_length(), spring.stiffness(), Strain::Cauchy)
                .expect("a spring")
        })
        .collect();
    let free = side * side;
    let position = |vertex: usize| place(turned(vertex));
    let fixed = (free..free + side).map(position).collect();
    let springs = Stencils::new(free, fixed, springs).expect("known vertices");
    let acceleration = std::array::from_fn(|c| if c == 1 { GRAVITY } else { 0.0 });
    let gravity = UniformGravity { acceleration, masses: vec![MASS; free] };
    let metric = DiagonalMetric::particles::<D>(&vec![MASS; free]).expect("masses");
    let system = System::new(metric, (springs, gravity)).expect("one size");
    let q: Vec<f64> = (0..free).flat_map(position).collect();
    let p = vec![0.0; q.len()];
    (system, State::new(q, Covector(p)))
}

fn implicit<const D: usize>(criterion: &mut Criterion) {
    let (system, state) = hanging::<D>(SIDE);
    let (metric, potential) = (system.metric(), system.potential());
    let mut group = criterion.benchmark_group(format!("implicit Euler, net in {D}D"));
    group.sample_size(10);

    let fill = |matrix: &mut SymmetricMatrix| {
        let filled = matrix.refill(|sink| {
            metric.add_matrix(sink.weighted(1.0));
            potential.add_hessian(&state.q, sink.weighted(H * H));
        });
        filled.expect("the pattern that was analysed");
    };
    let analyse = || {
        SymmetricMatrix::analyse(metric.dim(), |sink| {
            metric.add_matrix(sink);
            potential.add_hessian(&state.q, sink);
        })
        .expect("a pattern")
    };
    let mut matrix = analyse();
    fill(&mut matrix);
    let mut cholesky = SparseCholesky::analyse(&matrix).expect("an ordering");
    let mut b = state.q.clone();

    group.bench_function("analysis, once", |bench| {
        bench.iter(|| SparseCholesky::analyse(&analyse()).expect("an ordering"));
    });
    group.bench_function("assembly", |bench| bench.iter(|| fill(&mut matrix)));
    group.bench_function("factor", |bench| {
        bench.iter(|| cholesky.factor(&matrix).expect("positive definite"));
    });
    group.bench_function("solve", |bench| bench.iter(|| cholesky.solve(black_box(&mut b))));
    let solver = SparseSolver::new(metric, potential, &state.q).expect("a solver");
    let mut method = ImplicitEuler::with_solver(&system, solver).expect("one size");
    group.bench_function("whole step", |bench| {
        bench.iter(|| {
            let mut state = state.clone();
            method.step(&mut state, H).expect("a step");
            state
        });
    });
    group.finish();

    println!("\nratios in {D}D, median of pairs (quartiles)");
    in_turn::ratio(
        "factor / faer called directly",
        {
            let (mut cholesky, matrix) = (cholesky.clone(), matrix.clone());
            move || cholesky.factor(&matrix).expect("positive definite")
        },
        directly(&matrix),
    );
    let mut whole = SparseSolver::new(metric, potential, &state.q).expect("a solver");
    let mut r = state.q.clone();
    let mut filled = matrix.clone();
    in_turn::ratio(
        "assembly / assembly, factor and solve",
        || fill(&mut filled),
        || {
            whole.factor(metric, potential, &state.q, H * H).expect("positive definite");
            whole.solve(&mut r);
        },
    );
}

/// The same factorization by faer's own functions.
fn directly(matrix: &SymmetricMatrix) -> impl FnMut() {
    let (n, values) = (matrix.dim(), matrix.values().to_vec());
    let pattern = SymbolicSparseColMat::<u32>::new_checked(
        n,
        n,
        matrix.column_starts().to_vec(),
        None,
        matrix.rows().to_vec(),
    );
    let symbolic = factorize_symbolic_cholesky(
        pattern.as_ref(),
        Side::Lower,
        SymmetricOrdering::Amd,
        CholeskySymbolicParams::default(),
    )
    .expect("an ordering");
    let mut factor = vec![0.0; symbolic.len_val()];
    let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, faer::Spec::default());
    let mut memory = MemBuffer::new(scratch);
    move || {
        symbolic
            .factorize_numeric_llt(
                &mut factor,
                SparseColMatRef::new(pattern.as_ref(), &values),
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                faer::Spec::default(),
            )
            .expect("positive definite");
        black_box(&factor);
    }
}

/// One Stormer-Verlet step of the net in the plane over plain arrays.
struct ByHand {
    springs: Vec<([usize; 2], f64)>,
    q: Vec<f64>,
    p: Vec<f64>,
    dv: Vec<f64>,
    fixed: Vec<f64>,
}

impl ByHand {
    fn new(side: usize) -> Self {
        let (system, State { q, p, .. }) = hanging::<2>(side);
        let list = system.potential().0.stencils();
        let ends = |spring: &Spring| stationary_calculus::Stencil::<2, 2>::vertices(spring);
        let springs = list.iter().map(|spring| (ends(spring), spring.rest_length())).collect();
        let fixed = (0..side)
            .flat_map(|column| {
                let vertex = column;
                [0, 1].map(|c| {
                    let flat = [column as f64, 0.0];
                    SPACING * (flat[c] + 0.02 * ((vertex * 2 + c) as f64).sin())
                })
            })
            .collect();
        let dv = vec![0.0; q.len()];
        let mut net = ByHand { springs, q, p: p.0, dv, fixed };
        net.force();
        net
    }

    fn force(&mut self) {
        let n = self.q.len();
        for dv in self.dv.chunks_exact_mut(2) {
            dv[0] = 0.0;
            dv[1] = -MASS * GRAVITY;
        }
        for &([i, j], rest) in &self.springs {
            let at = |v: usize| {
                let from = if 2 * v < n { &self.q[2 * v..] } else { &self.fixed[2 * v - n..] };
                [from[0], from[1]]
            };
            let (a, b) = (at(i), at(j));
            let d = [b[0] - a[0], b[1] - a[1]];
            let length = (d[0] * d[0] + d[1] * d[1]).sqrt();
            let tension = STIFFNESS * (length - rest) / length;
            for (c, d) in d.into_iter().enumerate() {
                if 2 * i < n {
                    self.dv[2 * i + c] -= tension * d;
                }
                if 2 * j < n {
                    self.dv[2 * j + c] += tension * d;
                }
            }
        }
    }

    fn step(&mut self, h: f64) {
        let kick = |p: &mut [f64], dv: &[f64]| {
            for (p, dv) in p.iter_mut().zip(dv) {
                *p -= 0.5 * h * dv;
            }
        };
        kick(&mut self.p, &self.dv);
        for (q, p) in self.q.iter_mut().zip(&self.p) {
            *q += h / MASS * p;
        }
        self.force();
        kick(&mut self.p, &self.dv);
        let finite = |x: &[f64]| x.iter().fold(true, |all, x| all & x.is_finite());
        assert!(finite(&self.q) && finite(&self.p));
    }
}

fn explicit(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("Stormer-Verlet, net in 2D");
    println!("\nratios, median of pairs (quartiles)");
    for side in [23, 100] {
        let (system, state) = hanging::<2>(side);
        let mut verlet = StormerVerlet::new(&system).expect("one size");
        let mut ours = state.clone();
        let mut by_hand = ByHand::new(side);
        for _ in 0..100 {
            verlet.step(&mut ours, 1e-4).expect("a step");
            by_hand.step(1e-4);
        }
        let apart = ours.q.iter().zip(&by_hand.q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-12, "the two nets must do the same: {apart:e}");
        let freedoms = 2 * side * side;
        group.bench_function(format!("{freedoms} freedoms, typed"), |bench| {
            bench.iter(|| verlet.step(&mut ours, 1e-4).expect("a step"));
        });
        group.bench_function(format!("{freedoms} freedoms, by hand"), |bench| {
            bench.iter(|| by_hand.step(1e-4));
        });
        in_turn::ratio(
            &format!("Stormer-Verlet / by hand, {freedoms} freedoms in a Vec"),
            || {
                for _ in 0..50 {
                    verlet.step(&mut ours, 1e-4).expect("a step");
                }
            },
            || (0..50).for_each(|_| by_hand.step(1e-4)),
        );
    }
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    explicit(&mut criterion);
    implicit::<2>(&mut criterion);
    implicit::<3>(&mut criterion);
    criterion.final_summary();
}
