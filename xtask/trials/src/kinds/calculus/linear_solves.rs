//! Linear equations of every solver, of which it is known whether the matrix is definite, regular or
//! singular: whole numbers of small rank, or products with prescribed factors.

mod matrices;

use nalgebra::{DMatrix, DVector};
use stationary_calculus::{
    ConjugateGradient, Covector, DenseLu, DenseSolver, DiagonalMetric, HessianSolver, Ladder,
    LeastNormError, Potential, Rung, Sink, SparseCholesky, SparseError, SparseIndefinite,
    SparseSolver, SymmetricMatrix, least_norm,
};

use crate::{Draw, Kind, Verdict};
use matrices::{definite, indefinite, singular};

pub(super) const KIND: Kind = Kind {
    name: "linear-solves",
    krate: "calculus",
    rule: "an answer that is not finite or whose residual, over |A||x| + |b|, exceeds 1e-9 (1e-7 where \
           the solver promises 1e-8 of b); a singular matrix taken for regular, an indefinite one for \
           definite, a definite one of condition below 1e10 for none; a wrong count of signs",
    in_tests: 800,
    trial,
};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Class {
    Definite,
    Indefinite,
    Singular,
}

/// A matrix times a power of ten, and what it is.
struct Case {
    class: Class,
    a: DMatrix<f64>,
    /// Its scale, a power of two.
    scale: f64,
    b: DVector<f64>,
}

fn trial(draw: &mut Draw) -> Verdict {
    let n = draw.one_of(&[0, 1, 2, 3, 4, 6, 10, 20, 80]);
    let class = draw.one_of(&[Class::Definite, Class::Indefinite, Class::Singular]);
    let a = match class {
        _ if n == 0 => DMatrix::zeros(0, 0),
        Class::Definite => definite(draw, n),
        Class::Indefinite => indefinite(draw, n),
        Class::Singular => singular(draw, n),
    };
    let class = if n == 0 { Class::Definite } else { class };
    let wanted = 2.0_f64.powi(draw.one_of(&[0, 0, 1, -1]) * draw.between(0, 1000) as i32);
    let scale = if (&a * wanted).iter().all(|entry| entry.is_finite()) { wanted } else { 1.0 };
    let b = match draw.below(4) {
        0 => DVector::zeros(n),
        1 => DVector::from_vec(draw.vector(n)) * 2.0_f64.powi(draw.between(0, 200) as i32 - 100),
        _ => &a * DVector::from_vec(draw.vector(n)),
    };
    let load = if (&b * scale).iter().all(|b| b.is_finite()) { scale } else { 1.0 };
    let case = Case { class, a: a * scale, scale, b: b * load };
    draw.note(format!("{class:?}, {n} x {n}, scale {scale:e}"));
    if n <= 6 {
        draw.note(format!("A / scale = {:?}", (&case.a / case.scale).as_slice()));
        draw.note(format!("b / scale = {:?}", (&case.b / case.scale).as_slice()));
    }
    let solver = draw.below(8);
    draw.note(format!("solver {solver}"));
    match solver {
        0 => dense(&case, draw),
        1 => sparse(&case, Ladder::Descent, draw),
        2 => sparse(&case, Ladder::Exact, draw),
        3 => cholesky(&case),
        4 => by_exchanges(&case),
        5 => lu(&case),
        6 => iteration(&case),
        _ => shortest(&case),
    }
}

/// The entries of a matrix as a potential's Hessian, pair by pair.
struct Entries<'a>(&'a DMatrix<f64>);

impl Potential for Entries<'_> {
    fn dim(&self) -> usize {
        self.0.nrows()
    }

    fn energy(&self, _: &[f64]) -> f64 {
        0.0
    }

    fn add_differential(&self, _: &[f64], _: Covector<&mut [f64]>) {}

    fn add_hessian(&self, _: &[f64], hessian: &mut impl Sink) {
        for j in 0..self.0.ncols() {
            hessian.add_symmetric(&[j], &[self.0[(j, j)]]);
            for i in 0..j {
                let entry = self.0[(i, j)];
                if entry != 0.0 {
                    hessian.add_symmetric(&[i, j], &[0.0, entry, entry, 0.0]);
                }
            }
        }
    }
}

/// The residual over the size of its terms, all computed at scale one.
fn residual(case: &Case, x: &[f64], promised: f64) -> Verdict {
    if x.iter().any(|x| !x.is_finite()) {
        return Verdict::wrong(format!("x is {:?}", &x[..x.len().min(6)]));
    }
    let (a, b) = (&case.a / case.scale, &case.b / case.scale);
    let x = DVector::from_column_slice(x);
    let r = &a * &x - &b;
    let size = a.abs() * x.abs();
    let largest = size.amax().max(b.amax());
    // Numbers below the normal ones are multiples of a smallest one, b's own among them.
    let spacing = 4.0 * a.nrows() as f64 * (f64::MIN_POSITIVE * f64::EPSILON / case.scale);
    Verdict::of(r.amax(), promised * largest + spacing, "the residual")
}

fn dense(case: &Case, draw: &mut Draw) -> Verdict {
    let n = case.a.nrows();
    let Some(mut solver) = DenseSolver::<Vec<f64>>::new(n) else {
        return Verdict::wrong("no solver");
    };
    ladder(case, &mut solver, draw, false)
}

fn sparse(case: &Case, rungs: Ladder, draw: &mut Draw) -> Verdict {
    let metric = metric(draw, case);
    let entries = Entries(&case.a);
    match SparseSolver::new(&metric, &entries, &vec![0.0; case.a.nrows()]) {
        Ok(solver) => {
            ladder_of(case, &mut solver.with_ladder(rungs), &metric, rungs == Ladder::Exact)
        }
        Err(error) => Verdict::wrong(format!("not analysed: {error}")),
    }
}

fn metric(draw: &mut Draw, case: &Case) -> DiagonalMetric<Vec<f64>> {
    let common = 10.0_f64.powi(draw.one_of(&[0, 0, 6, -6, -200, 200]));
    let mass = (0..case.a.nrows()).map(|_| common * draw.log_uniform(0.1, 10.0)).collect();
    match DiagonalMetric::new(mass) {
        Ok(metric) => metric,
        Err(error) => panic!("{error}"),
    }
}

fn ladder(case: &Case, solver: &mut impl HessianSolver, draw: &mut Draw, exact: bool) -> Verdict {
    let metric = metric(draw, case);
    ladder_of(case, solver, &metric, exact)
}

fn ladder_of(
    case: &Case,
    solver: &mut impl HessianSolver,
    metric: &DiagonalMetric<Vec<f64>>,
    exact: bool,
) -> Verdict {
    let entries = Entries(&case.a);
    let q = vec![0.0; case.a.nrows()];
    let rung = solver.factor_weighted(0.0, metric, 1.0, &entries, &q);
    let mut x = case.b.as_slice().to_vec();
    match (rung, case.class) {
        (Ok(Rung::Cholesky), Class::Definite) => {
            solver.solve(&mut x);
            residual(case, &x, 1e-9)
        }
        (Ok(Rung::Cholesky), class) => Verdict::wrong(format!("{class:?} taken for definite")),
        (Ok(rung), Class::Definite) => Verdict::wrong(format!("definite, but {rung:?}")),
        (Ok(Rung::Indefinite), Class::Indefinite) => {
            solver.solve(&mut x);
            if x.iter().all(|x| x.is_nan()) && !x.is_empty() {
                return Verdict::refused("no solution can be trusted");
            }
            residual(case, &x, 1e-7)
        }
        (Ok(Rung::Indefinite), Class::Singular) => {
            solver.solve(&mut x);
            if x.iter().all(|x| x.is_nan()) {
                Verdict::due()
            } else {
                Verdict::wrong(format!("singular, and solved to {:?}", &x[..x.len().min(6)]))
            }
        }
        (Ok(rung), _) if exact => Verdict::wrong(format!("the exact ladder ends at {rung:?}")),
        (Ok(Rung::Shifted { .. }), _) => {
            solver.solve(&mut x);
            // In units of their own, so that the product does not leave the range of numbers.
            let unit = |x: DVector<f64>| if x.amax() > 0.0 { &x / x.amax() } else { x };
            let (b, x) = (unit(case.b.clone()), unit(DVector::from_vec(x)));
            let descent = b.dot(&x);
            if !descent.is_finite() {
                Verdict::wrong(format!("<b, x> is {descent}"))
            } else if descent > 0.0 || b.amax() == 0.0 || x.amax() == 0.0 {
                Verdict::due()
            } else {
                Verdict::wrong(format!("does not descend: <b, x> = {descent:e}"))
            }
        }
        (Err(_), Class::Singular) => Verdict::due(),
        (Err(error), Class::Definite) => Verdict::wrong(format!("definite: {error}")),
        (Err(error), Class::Indefinite) => Verdict::refused(error),
    }
}

fn matrix(case: &Case) -> Result<SymmetricMatrix, SparseError> {
    SymmetricMatrix::hessian(&Entries(&case.a), &vec![0.0; case.a.nrows()])
}

fn cholesky(case: &Case) -> Verdict {
    let made = matrix(case).and_then(|a| Ok((SparseCholesky::analyse(&a)?, a)));
    let (mut cholesky, matrix) = match made {
        Ok(made) => made,
        Err(error) => return Verdict::wrong(error),
    };
    let verdict = match (cholesky.factor(&matrix), case.class) {
        (Ok(()), Class::Definite) => {
            let mut x = case.b.as_slice().to_vec();
            cholesky.solve(&mut x);
            residual(case, &x, 1e-9)
        }
        (Ok(()), class) => Verdict::wrong(format!("{class:?} factored")),
        (Err(error), Class::Definite) => Verdict::wrong(format!("definite: {error}")),
        (Err(SparseError::NotPositiveDefinite { .. }), _) => Verdict::due(),
        (Err(error), class) => Verdict::wrong(format!("{class:?}: {error}")),
    };
    let counted = match (cholesky.inertia(&matrix), case.class) {
        (Err(_), Class::Singular) => Verdict::due(),
        (Ok(count), Class::Singular) => Verdict::wrong(format!("singular, counted {count:?}")),
        (Err(error), _) => Verdict::refused(error),
        (Ok(count), _) => {
            let a = &case.a / case.scale;
            let negative = match a.nrows() {
                0 => 0,
                _ => a.symmetric_eigenvalues().iter().filter(|&&value| value < 0.0).count(),
            };
            if count.negative == negative && count.positive == case.a.nrows() - negative {
                Verdict::due()
            } else {
                Verdict::wrong(format!("{negative} are negative, counted {count:?}"))
            }
        }
    };
    // A count that is refused on a regular matrix is documented: elimination without exchanges.
    match counted {
        Verdict::Refused { .. } if case.class == Class::Indefinite => verdict,
        counted => verdict.and(counted),
    }
}

fn by_exchanges(case: &Case) -> Verdict {
    let made = matrix(case).and_then(|a| Ok((SparseIndefinite::analyse(&a)?, a)));
    let (mut solver, matrix) = match made {
        Ok(made) => made,
        Err(error) => return Verdict::wrong(error),
    };
    let mut x = case.b.as_slice().to_vec();
    let solved = solver.factor(&matrix).and_then(|_| solver.solve(&matrix, &mut x));
    match (solved, case.class) {
        (Ok(_), Class::Singular) => {
            Verdict::wrong(format!("singular, and solved to {:?}", &x[..x.len().min(6)]))
        }
        (Ok(_), _) => residual(case, &x, 1e-7),
        (Err(_), Class::Singular) => Verdict::due(),
        // Rounding x alone leaves more of some b than is promised.
        (Err(error @ SparseError::Untrusted { .. }), _) => Verdict::refused(error),
        (Err(error), class) => Verdict::wrong(format!("{class:?}: {error}")),
    }
}

fn lu(case: &Case) -> Verdict {
    let mut lu = DenseLu::new(case.a.nrows());
    lu.matrix().copy_from_slice(case.a.as_slice());
    match (lu.factor(), case.class) {
        (Ok(()), Class::Singular) => Verdict::wrong("singular, and factored"),
        (Err(_), Class::Singular) => Verdict::due(),
        (Err(error), class) => Verdict::wrong(format!("{class:?}: {error}")),
        (Ok(()), _) => {
            let mut x = case.b.as_slice().to_vec();
            lu.solve(&mut x);
            residual(case, &x, 1e-9)
        }
    }
}

fn iteration(case: &Case) -> Verdict {
    let n = case.a.nrows();
    let mut x = vec![0.0; n];
    let method = ConjugateGradient { tolerance: 1e-10, iterations: 40 * n + 40 };
    let Ok(metric) = DiagonalMetric::new(vec![1.0; n]) else {
        return Verdict::not_judged("no metric");
    };
    let b = case.b.as_slice();
    let solved = method.solve(0.0, &metric, 1.0, &Entries(&case.a), &vec![0.0; n], b, &mut x);
    match (solved, case.class) {
        (Ok(report), Class::Definite) => {
            let honest = if report.relative_residual <= 1e-8 {
                Verdict::due()
            } else {
                Verdict::wrong(format!("Ok with a residual of {:e}", report.relative_residual))
            };
            honest.and(residual(case, &x, 1e-7))
        }
        // In the directions that it met the matrix was positive.
        (Ok(_), _) => residual(case, &x, 1e-7),
        (Err(SparseError::NotConverged { .. }), Class::Definite) => Verdict::due(),
        (Err(error), Class::Definite) => Verdict::wrong(format!("definite: {error}")),
        (Err(_), _) => Verdict::due(),
    }
}

fn shortest(case: &Case) -> Verdict {
    let found = match least_norm(&case.a, &case.b, 1e-12) {
        Ok(found) => found,
        // The largest singular value, at scale one, may leave the range of numbers at the case's.
        Err(LeastNormError::Overflow)
            if !((&case.a / case.scale).singular_values().amax() * case.scale).is_finite() =>
        {
            return Verdict::due();
        }
        Err(error) => return Verdict::wrong(error),
    };
    let n = case.a.nrows();
    match case.class {
        Class::Singular if found.rank == n => Verdict::wrong("singular, of full rank"),
        Class::Singular => {
            // The residual of the closest is orthogonal to the columns.
            let (a, b) = (&case.a / case.scale, &case.b / case.scale);
            let r = &a * &found.x - &b;
            let size = a.amax() * (a.abs() * found.x.abs() + b.abs()).amax() * n as f64;
            Verdict::of((a.transpose() * r).amax(), 1e-9 * size, "what the columns see of it")
        }
        _ if found.rank < n => Verdict::wrong(format!("regular, of rank {}", found.rank)),
        _ => residual(case, found.x.as_slice(), 1e-9),
    }
}
