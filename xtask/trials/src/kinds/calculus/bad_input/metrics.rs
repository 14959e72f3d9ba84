//! Metrics, stencils, and the sinks that they are written to.

use nalgebra::{DMatrix, DVector};
use stationary_calculus::{
    Curvature, DenseMetric, DenseSink, DerivativeCheck, DiagonalMetric, Metric, ProductSink,
    SparseMetric, Stencil, StencilHessian, Stencils, SymmetricMatrix, System, project_semidefinite,
};

use super::{any, any_vector, due_unless, size, springs, unit};
use crate::{Draw, Verdict};

pub(super) fn metrics(draw: &mut Draw) -> Verdict {
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

    fn hessian(&self, _: &[[f64; 1]; 2], _: Curvature) -> StencilHessian<2, 1> {
        [[[[1.0], [-1.0]]], [[[-1.0], [1.0]]]]
    }
}

pub(super) fn stencils(draw: &mut Draw) -> Verdict {
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

pub(super) fn sinks(draw: &mut Draw) -> Verdict {
    let (n, k, l) = (size(draw), draw.below(20), size(draw));
    draw.note(format!("n {n}, {k} values, a vector of {l}"));
    let mut values = vec![0.0; k];
    let dense = DenseSink::new(any(draw), n, &mut values).is_some();
    let x = vec![0.0; n];
    let mut y = vec![0.0; l];
    let product = ProductSink::new(any(draw), &x, &mut y).is_some();
    due_unless(dense != (k == n * n) || product != (n == l), "made of sizes that do not fit")
}

pub(super) fn semidefinite(draw: &mut Draw) -> Verdict {
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
