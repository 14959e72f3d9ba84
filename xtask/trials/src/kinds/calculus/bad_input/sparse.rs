//! Sparse matrices, their blocks and their factors.

use stationary_calculus::{
    JacobianEntries, SparseCholesky, SparseIndefinite, SparseJacobian, SymmetricMatrix,
};

use super::{any, any_vector, blocks, due_unless, finite, size, springs};
use crate::{Draw, Verdict};

pub(super) fn hessian_of_sizes(draw: &mut Draw) -> Verdict {
    let (n, k) = (size(draw), size(draw));
    draw.note(format!("a potential of {n}, a q of {k}"));
    let made = SymmetricMatrix::hessian(&springs(n), &vec![0.0; k]).is_ok();
    due_unless(made && k < n, "made of sizes that do not fit")
}

pub(super) fn from_blocks(draw: &mut Draw) -> Verdict {
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

pub(super) fn factors(draw: &mut Draw) -> Verdict {
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

pub(super) fn sparse_jacobian(draw: &mut Draw) -> Verdict {
    let (rows, columns) = (size(draw), size(draw));
    let entries: Vec<(usize, usize, f64)> = (0..draw.below(5))
        .map(|_| (draw.below(rows + 1), draw.below(columns + 1), any(draw)))
        .collect();
    draw.note(format!("{rows} x {columns}, {entries:?}"));
    let visit = |sink: &mut JacobianEntries<'_>| {
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
