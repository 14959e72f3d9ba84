//! Solvers of linear equations, full, sparse and by iteration.

use stationary_calculus::{
    ConjugateGradient, DenseLu, DenseSolver, HessianSolver, IterativeSolver, SparseSolver,
};

use super::{any, any_springs, any_vector, due_unless, finite, size, springs, unit};
use crate::{Draw, Verdict};

pub(super) fn sparse_solver(draw: &mut Draw) -> Verdict {
    let (n, k, l) = (size(draw), size(draw), size(draw));
    draw.note(format!("a metric of {n}, a potential of {k}, a q of {l}"));
    let made = SparseSolver::new(&unit(n), &springs(k), &vec![0.0; l]).is_ok();
    due_unless(made && (k > n || l < k), "made of sizes that do not fit")
}

pub(super) fn iterative_solver(draw: &mut Draw) -> Verdict {
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

pub(super) fn dense_solver(draw: &mut Draw) -> Verdict {
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

pub(super) fn conjugate_gradient(draw: &mut Draw) -> Verdict {
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

pub(super) fn dense_lu(draw: &mut Draw) -> Verdict {
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
        if n > 0 && b.iter().all(|x| x.is_nan()) {
            return Verdict::refused("a component is too large");
        }
        return due_unless(b.iter().any(|x| !x.is_finite()), &format!("Ok, and solved to {b:?}"));
    }
    Verdict::due()
}
