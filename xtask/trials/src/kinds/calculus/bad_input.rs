//! Numbers that are none, sizes that do not fit, and nothing at all, for every public function: a file for
//! each family of functions, and here what they share.

mod newton;
mod equilibrium;
mod solvers;
mod sparse;
mod checks;
mod metrics;
mod linear_algebra;

use stationary_calculus::{Covector, DiagonalMetric, Potential, Sink};

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
    ("Newton::solve, settings", newton::newton_settings),
    ("Newton::solve, sizes", newton::newton_sizes),
    ("Newton::solve, numbers", newton::newton_numbers),
    ("NewtonMemory::new", newton::newton_memory),
    ("SparseEquation", newton::sparse_equation),
    ("Equilibrium::find, sizes", equilibrium::equilibrium_sizes),
    ("Equilibrium::find, numbers", equilibrium::equilibrium_numbers),
    ("Equilibrium, solver of another size", equilibrium::equilibrium_of_another_solver),
    ("SparseSolver::new", solvers::sparse_solver),
    ("IterativeSolver::new", solvers::iterative_solver),
    ("DenseSolver", solvers::dense_solver),
    ("SymmetricMatrix::hessian", sparse::hessian_of_sizes),
    ("SymmetricMatrix::from_blocks", sparse::from_blocks),
    ("SparseCholesky, SparseIndefinite", sparse::factors),
    ("ConjugateGradient::solve", solvers::conjugate_gradient),
    ("SparseJacobian", sparse::sparse_jacobian),
    ("check_potential, sizes", checks::check_sizes),
    ("check_potential_on", checks::check_on_space),
    ("check_potential, settings", checks::check_settings),
    ("check_potential, blocks", checks::check_blocks),
    ("check_jacobian", checks::check_jacobian),
    ("differences", checks::figure),
    ("metrics", metrics::metrics),
    ("Stencils", metrics::stencils),
    ("sinks", metrics::sinks),
    ("least_norm", linear_algebra::shortest),
    ("eigenpairs, changes of basis", linear_algebra::matrices),
    ("angles", linear_algebra::angles),
    ("slopes", linear_algebra::slopes),
    ("project_semidefinite", metrics::semidefinite),
    ("DenseLu", solvers::dense_lu),
    ("Automatic", checks::automatic),
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

fn blocks(draw: &mut Draw, n: usize) -> Vec<(Vec<usize>, Vec<f64>)> {
    let block = |draw: &mut Draw| {
        let k = draw.below(4);
        let entries = if draw.chance(0.8) { k * k } else { draw.below(12) };
        let freedoms = (0..k).map(|_| draw.below(n + 1)).collect();
        (freedoms, any_vector(draw, entries))
    };
    (0..draw.below(4)).map(|_| block(draw)).collect()
}
