//! Searches for equilibria.

use stationary_calculus::{
    DenseSolver, Equilibrium, HessianSolver, Metric, Newton, Potential, SparseSolver,
};

use super::{any_springs, any_vector, due_unless, finite, size, springs, unit};
use crate::{Draw, Verdict};

pub(super) fn equilibrium_sizes(draw: &mut Draw) -> Verdict {
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

pub(super) fn equilibrium_numbers(draw: &mut Draw) -> Verdict {
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

pub(super) fn equilibrium_of_another_solver(draw: &mut Draw) -> Verdict {
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
