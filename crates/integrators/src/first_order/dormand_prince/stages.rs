//! The stages of a step of DOP853, each of those before it.
//!
//! ```text
//! k_s = f(t + c_s h, y + h sum_j a_sj k_j)
//! ```

use stationary_calculus::Storage;

use super::coefficients::*;
use crate::VectorField;

/// Evaluates stages 2 to 12 of a step of `h` from y at t, where the first one is f.
#[inline(always)]
pub(super) fn evaluate_stages<S: Storage>(
    field: &impl VectorField,
    t: f64,
    y: &[f64],
    h: f64,
    k: &mut [S; 13],
    stage: &mut [f64],
) {
    macro_rules! stages {
        ($($s:literal $row:ident $at:expr;)+) => {$(
            combine(stage, y, h, &$row, k, $at);
            field.evaluate(t + C[$s - 1] * h, stage, k[$s - 1].as_mut());
        )+};
    }
    stages! {
        2 A2 [1];
        3 A3 [1, 2];
        4 A4 [1, 3];
        5 A5 [1, 3, 4];
        6 A6 [1, 4, 5];
        7 A7 [1, 4, 5, 6];
        8 A8 [1, 4, 5, 6, 7];
        9 A9 [1, 4, 5, 6, 7, 8];
        10 A10 [1, 4, 5, 6, 7, 8, 9];
        11 A11 [1, 4, 5, 6, 7, 8, 9, 10];
        12 A12 [1, 4, 5, 6, 7, 8, 9, 10, 11];
    }
}

/// Writes y + h sum a_j k_j over the stages `at`, counted from 1. The newest one comes last, with
/// nothing left to wait for but one product and one sum.
#[inline(always)]
pub(super) fn combine<C: Storage, const S: usize>(
    out: &mut [f64],
    y: &[f64],
    h: f64,
    a: &[f64; S],
    k: &[C; 13],
    at: [usize; S],
) {
    let n = out.len();
    let (y, k) = (&y[..n], at.map(|s| &k[s - 1].as_ref()[..n]));
    let (newest, last) = (S - 1, h * a[S - 1]);
    for i in 0..n {
        let mut sum = 0.0;
        for j in 0..newest {
            sum += a[j] * k[j][i];
        }
        out[i] = (y[i] + h * sum) + last * k[newest][i];
    }
}
