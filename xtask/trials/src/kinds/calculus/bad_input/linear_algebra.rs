//! Full matrices, angles and slopes.

use nalgebra::{DMatrix, DVector};
use stationary_calculus::{
    BilinearForm, ChangeOfBasis, ContravariantTensor, Covector, LinearTransformation, Vector,
    angle, least_norm, signed_angle,
};
use stationary_measure::{loglog_slope, truncation_regime};

use super::{any, any_vector, due_unless, finite, size};
use crate::{Draw, Verdict};

pub(super) fn shortest(draw: &mut Draw) -> Verdict {
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

pub(super) fn matrices(draw: &mut Draw) -> Verdict {
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

pub(super) fn angles(draw: &mut Draw) -> Verdict {
    let [u, v, n]: [[f64; 3]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| any(draw)));
    draw.note(format!("{u:?} {v:?} {n:?}"));
    let found = [angle(&u, &v), signed_angle(&u, &v, &n)];
    let limit = std::f64::consts::PI;
    let wrong = |angle: &f64| !angle.is_finite() || angle.abs() > limit;
    due_unless(found.iter().flatten().any(wrong), &format!("angles {found:?}"))
}

pub(super) fn slopes(draw: &mut Draw) -> Verdict {
    let points: Vec<(f64, f64)> =
        (0..draw.below(6)).map(|_| (any(draw).abs(), any(draw).abs())).collect();
    draw.note(format!("{points:?}"));
    let kept = truncation_regime(&points);
    let slope = loglog_slope(kept).or(loglog_slope(&points));
    due_unless(slope.is_some_and(|slope| !slope.is_finite()), &format!("a slope of {slope:?}"))
}
