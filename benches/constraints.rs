//! A hanging chain of rods: a step with multipliers, and how it grows with the links.
//!
//! `cargo bench --bench constraints` prints, for a chain of 10,000 links, the ratio of a RATTLE
//! step to one factorization and solve of `J M^-1 J^T` by faer called directly, taken in turn, then
//! nanoseconds a link for chains of growing length and the fitted exponent.

mod in_turn;

use std::hint::black_box;
use std::time::Instant;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side, Spec};
use stationary_constraints::problems::{RodProblem, writhing_chain};
use stationary_constraints::{ConstrainedIntegrator, Rattle, SparseDiagonal};
use stationary_measure::loglog_slope;

/// How fast the links turn, radians a second: the step is then short enough for the tension of the
/// longest chain, which would otherwise make it whirl.
const RATE: f64 = 100.0;

/// Runs steps of a writhing chain, one each call: its links turn by up to a hundredth of a radian a
/// step.
fn steps(n: usize, mut each: impl FnMut(&mut dyn FnMut() -> u32)) {
    let RodProblem { system, rods, initial } = writhing_chain(n, RATE).expect("a chain");
    let mut state = initial.clone();
    let mut rattle =
        Rattle::new(&system, rods, &initial, SparseDiagonal::default()).expect("a feasible state");
    let h = 0.01 / RATE;
    for _ in 0..3 {
        rattle.step(&mut state, h).expect("a step");
    }
    // To and fro, so that the motion stays as lively as it is: RATTLE undoes its steps.
    let mut count = 0_u32;
    each(&mut || {
        count += 1;
        if count.is_multiple_of(4) {
            state.p.0.iter_mut().for_each(|p| *p = -*p);
        }
        rattle.step(&mut state, h).expect("a step").iterations
    });
}

/// Factor and solve of the chain's Schur complement by faer's own functions: unit masses and unit
/// links in a line, so 8 on the diagonal (4 at the hook) and -4 beside it.
fn directly(n: usize) -> impl FnMut() {
    let starts = (0..=n as u32).map(|j| if j < n as u32 { 2 * j } else { 2 * j - 1 }).collect();
    let rows = (0..n as u32).flat_map(|j| [j, j + 1]).take(2 * n - 1).collect();
    let diagonal = |j: usize| if j == 0 { 4.0 } else { 8.0 };
    let values: Vec<f64> = (0..n).flat_map(|j| [diagonal(j), -4.0]).take(2 * n - 1).collect();
    let pattern = SymbolicSparseColMat::<u32>::new_checked(n, n, starts, None, rows);
    let symbolic = factorize_symbolic_cholesky(
        pattern.as_ref(),
        Side::Lower,
        SymmetricOrdering::Amd,
        CholeskySymbolicParams::default(),
    )
    .expect("an ordering");
    let mut factor = vec![0.0; symbolic.len_val()];
    let sizes = [
        symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default()),
        symbolic.solve_in_place_scratch::<f64>(1, Par::Seq),
    ];
    let mut memory = MemBuffer::new(faer::dyn_stack::StackReq::any_of(&sizes));
    let mut b = vec![1.0; n];
    move || {
        symbolic
            .factorize_numeric_llt(
                &mut factor,
                SparseColMatRef::new(pattern.as_ref(), &values),
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Spec::default(),
            )
            .expect("positive definite");
        b.fill(1.0);
        LltRef::new(&symbolic, &factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut b, n, 1),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        black_box(&b);
    }
}

fn main() {
    let n = 10_000;
    steps(n, |step| {
        println!("iterations in a step of {n} links: {}", step());
        in_turn::ratio(
            &format!("RATTLE step / factor and solve by faer, {n} links"),
            || {
                black_box(step());
            },
            directly(n),
        );
    });
    let mut points = Vec::new();
    for n in [100, 1_000, 10_000, 100_000] {
        steps(n, |step| {
            let repeats = 2_000_000 / n;
            let mut times: Vec<f64> = (0..5)
                .map(|_| {
                    let start = Instant::now();
                    for _ in 0..repeats {
                        black_box(step());
                    }
                    start.elapsed().as_secs_f64() / repeats as f64
                })
                .collect();
            times.sort_by(f64::total_cmp);
            println!("{n:>7} links: {:.1} ns a link, median of 5", times[2] / n as f64 * 1e9);
            points.push((n as f64, times[2]));
        });
    }
    let exponent = loglog_slope(&points).unwrap_or(f64::NAN);
    println!("time of a step grows as links to the power {exponent:.3}");
}
