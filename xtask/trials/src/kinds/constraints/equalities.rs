//! Random sparse equations, redundant and nearly so, under masses of any ratio: the solver of any number
//! of equations against a dense singular value decomposition.

use nalgebra::{DMatrix, DVector};
use stationary_calculus::{Covector, DiagonalMetric, Metric, Vector};
use stationary_constraints::{
    ConstraintError, Linear, Multipliers, Redundancy, Solver, SparseDiagonal,
};

use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "equalities",
    krate: "constraints",
    rule: "three solves leave a rate of more than 1e-9 of the largest velocity, 1e-5 where singular values \
           go below 1e-5 of the largest (a step then finds it and is an error); shared multipliers do to the \
           masses what the others did not, by more than 1e-7 of what the largest does, or where the singular \
           values leave no doubt are not the shortest to 1e-8 of the multipliers that were shared; equations \
           whose singular values leave no doubt are refused",
    in_tests: 300,
    trial,
};

/// Equations, and how many of them were made to depend on others exactly.
struct Equations {
    a: DMatrix<f64>,
    masses: Vec<f64>,
    redundant: usize,
    /// The smallest part by which one that nearly depends on others is independent.
    gap: f64,
}

impl Equations {
    fn draw(draw: &mut Draw) -> Self {
        let m = draw.between(1, 30);
        let n = draw.between(2, 60);
        let ratio = draw.one_of(&[1.0, 1.0, 1e2, 1e2, 1e6, 1e12]);
        let masses = (0..n).map(|_| draw.log_uniform(1.0, ratio * 1.000_001)).collect();
        let mut a = DMatrix::zeros(m, n);
        let (mut redundant, mut gap) = (0, 1.0_f64);
        let often = draw.one_of(&[0.0, 0.1, 0.1, 0.4]);
        let nearly = draw.one_of(&[0.0, 0.0, 0.3]);
        for row in 0..m {
            if row > 1 && draw.chance(often) {
                for _ in 0..draw.between(1, 3) {
                    let (other, factor) = (draw.below(row), draw.one_of(&[1.0, -1.0, 0.5]));
                    let sum = a.row(row) + factor * a.row(other);
                    a.row_mut(row).copy_from(&sum);
                }
                if draw.chance(nearly) {
                    let part = draw.log_uniform(1e-12, 1.0);
                    a[(row, draw.below(n))] += part;
                    gap = gap.min(part);
                } else {
                    redundant += 1;
                }
            }
            if a.row(row).amax() == 0.0 {
                // Neighbours, as in a chain, or any.
                let near = (row * n / m).min(n - 1);
                for step in 0..draw.between(1, 4) {
                    let any = draw.below(n);
                    let freedom = if draw.chance(0.8) { (near + step) % n } else { any };
                    a[(row, freedom)] = draw.one_of(&[1.0, -1.0, 0.3]) + 0.1 * draw.symmetric();
                }
            }
            let size = draw.log_uniform(1e-3, 1e3);
            a.row_mut(row).scale_mut(size);
        }
        Equations { a, masses, redundant, gap }
    }

    /// J in reference scales, without masses.
    fn scaled(&self, slopes: &[f64]) -> DMatrix<f64> {
        DMatrix::from_fn(self.a.nrows(), self.a.ncols(), |i, f| {
            self.a[(i, f)] / slopes[i] / self.masses[f].sqrt()
        })
    }
}

fn trial(draw: &mut Draw) -> Verdict {
    let equations = Equations::draw(draw);
    let Equations { a, masses, redundant, gap } = &equations;
    let (m, n) = a.shape();
    let heaviest = masses.iter().fold(0.0_f64, |x, m| x.max(*m));
    let lightest = masses.iter().fold(f64::INFINITY, |x, m| x.min(*m));
    let ratio = heaviest / lightest;
    draw.note(format!(
        "{m} equations, {n} freedoms, masses 1 to {ratio:.0e}, {redundant} redundant"
    ));
    draw.note(format!("nearly redundant by {gap:.1e}"));
    let slopes: Vec<f64> = a.row_iter().map(|row| row.norm()).collect();
    let scaled = equations.scaled(&slopes);
    // Square, so that all that no force feels is among its vectors. nalgebra's vectors of other singular values are
    // off by up to 2 in one of a hundred matrices that are not regular; those of zero are not.
    let square = scaled.transpose().resize_vertically(n.max(m), 0.0);
    let svd = square.svd(false, true);
    let (Some(vectors), sigma) = (svd.v_t, svd.singular_values) else {
        return Verdict::not_judged("no decomposition");
    };
    let largest = sigma.max();
    let rounding = 1e-13 * largest;
    // The smallest singular value that is none of rounding, where masses are left aside.
    let smallest = sigma.iter().filter(|s| **s > rounding).fold(largest, |x, s| x.min(*s));
    let clear = smallest > 1e-3 * largest && *gap > 1e-3 && ratio < 1e3;
    draw.note(format!("singular values from {smallest:.1e} to {largest:.1e}"));

    let rows = a.row_iter().map(|row| {
        let entries = row.iter().copied().enumerate().filter(|entry| entry.1 != 0.0);
        (entries.collect(), 0.0)
    });
    let Ok(lines) = Linear::new(rows.collect()) else { return Verdict::wrong("no equations") };
    let Ok(metric) = DiagonalMetric::new(masses.clone()) else {
        return Verdict::wrong("no metric");
    };
    let q = vec![0.0; n];
    let choice = SparseDiagonal(Redundancy::LeastNorm);
    let analysed = Solver::<Vec<f64>>::analyse(&choice, &metric, &lines, 0.0, &q);
    let mut solver = match analysed {
        Ok(solver) => solver,
        Err(error) => return Verdict::wrong(format!("is not analysed: {error}")),
    };
    let refused = |error: ConstraintError| match clear {
        true => Verdict::wrong(format!("refuses what is clear: {error}")),
        false => Verdict::refused(error),
    };
    if let Err(error) = solver.prepare(&metric, &lines, 0.0, &q) {
        return refused(error);
    }
    let mut v = Vector(draw.vector(n));
    let start = v.clone();
    let mut lambda = vec![0.0; m];
    for _ in 0..3 {
        let mut rates = vec![0.0; m];
        solver.add_along(v.view(), &mut rates);
        if let Err(error) = solver.solve(&mut rates) {
            return refused(error);
        }
        let (mut p, mut change) = (Covector(vec![0.0; n]), Vector(vec![0.0; n]));
        solver.add_pulled_back(-1.0, &rates, p.view_mut());
        metric.sharp(p.view(), change.view_mut());
        v.0.iter_mut().zip(&change.0).for_each(|(v, change)| *v += change);
        lambda.iter_mut().zip(&rates).for_each(|(sum, part)| *sum += part);
    }
    let speed = |v: &Vector<Vec<f64>>| v.0.iter().fold(0.0_f64, |x, v| x.max(v.abs()));
    let velocity = DVector::from_column_slice(&v.0);
    let rate = (a * velocity).iter().zip(&slopes).fold(0.0_f64, |x, (r, s)| x.max((r / s).abs()));
    let kept = if smallest > 1e-5 * largest { 1e-9 } else { 1e-5 };
    let fastest = speed(&v).max(speed(&start));
    let verdict = Verdict::of(rate, kept * fastest, "a rate that is left");
    let mut shared = lambda.clone();
    if let Err(error) = solver.share(&mut shared) {
        return verdict.and(refused(error));
    }
    let force = |lambda: &[f64]| a.transpose() * DVector::from_column_slice(lambda);
    // What a force does to a heavy freedom is little, and so is what another one does otherwise.
    let root = DVector::from_fn(n, |f, _| masses[f].sqrt());
    let felt = |row: usize| {
        let touched = (0..n).filter(|f| a[(row, *f)] != 0.0);
        slopes[row] / touched.fold(0.0_f64, |x, f| x.max(root[f]))
    };
    let largest_of = |unit: &dyn Fn(usize) -> f64| {
        let sizes = (0..m).map(|row| lambda[row].abs().max(shared[row].abs()) * unit(row));
        sizes.fold(0.0_f64, f64::max)
    };
    let off = (force(&shared) - force(&lambda)).component_div(&root).amax();
    let promised = 1e-7 * largest_of(&felt);
    let verdict = verdict.and(Verdict::of(off, promised, "what shared multipliers do"));
    let size = largest_of(&|row| slopes[row]);
    if !clear {
        return verdict;
    }
    // What no force feels is not in the shortest: they are in the range of J.
    let forces = DVector::from_fn(m, |i, _| shared[i] * slopes[i]);
    let mut unfelt = DVector::zeros(m);
    for (k, _) in sigma.iter().enumerate().filter(|(_, sigma)| **sigma <= rounding) {
        let still = vectors.row(k).transpose();
        if scaled.tr_mul(&still).amax() > 10.0 * rounding {
            return verdict.and(Verdict::not_judged("its singular vectors are off"));
        }
        unfelt += &still * still.dot(&forces);
    }
    verdict.and(Verdict::of(unfelt.amax(), 1e-8 * size, "a part that no force feels"))
}
