//! Eigenvalues and eigenvectors of symmetric matrices of at most three columns.
//!
//! ```text
//! S = Q diag(l) Q^T             S symmetric R x R, Q a rotation
//! S = m I + q N,  m = tr S/3,  q^2 = |S - m I|^2/6,   x^3 - 3 x = 2 h,  h = det N/2    three columns
//! ```
//! By Jacobi's rotations of pairs of columns, whose number is bounded, and for three columns in
//! closed form: of N's eigenvalues x the one that stands apart, at least sqrt 3 from both others,
//! has its eigenvector in the columns of adj(N - x I); a single rotation does for the other two.
//! No two eigenvalues are too close for that, and all branches are choices in a lane. Exact to
//! rounding relative to the largest eigenvalue, where Jacobi's rotations leave rounding relative to
//! each. What is not finite comes out as NaN. Source: Smith, Eigenvalues of a Symmetric 3 x 3 Matrix
//! (1961); Eberly, A Robust Eigensolver for 3 x 3 Symmetric Matrices (2014); Duff et al., Building an
//! Orthonormal Basis, Revisited (2017); Golub and Van Loan, Matrix Computations, 8.5.

use crate::Real;
use crate::tensor::{apply, dot, product, scaled, shifted, trace};

/// More sweeps than any finite matrix of three columns needs.
pub(crate) const SWEEPS: usize = 30;

/// Cosine and sine of the rotation that makes a 2 x 2 symmetric matrix `[a b; b c]` diagonal.
#[inline(always)]
pub(crate) fn rotation<T: Real>(a: T, b: T, c: T) -> (T, T) {
    let (gap, twice) = (c - a, b + b);
    let size = gap.multiply_add(gap, twice * twice).square_root();
    // The smallest number keeps zero over zero out: nothing is rotated where b is zero.
    let whole = gap.magnitude() + size + T::splat(f64::MIN_POSITIVE);
    let tangent = (twice * whole.reciprocal()).signed_by(gap);
    let cosine = tangent.multiply_add(tangent, T::splat(1.0)).square_root().reciprocal();
    (cosine, cosine * tangent)
}

/// Turns columns p and q by an angle.
#[inline(always)]
pub(crate) fn rotate<T: Real, const D: usize, const R: usize>(
    columns: &mut [[T; D]; R],
    (p, q): (usize, usize),
    (cosine, sine): (T, T),
) {
    for i in 0..D {
        let (x, y) = (columns[p][i], columns[q][i]);
        columns[p][i] = cosine.multiply_add(x, -(sine * y));
        columns[q][i] = sine.multiply_add(x, cosine * y);
    }
}

#[inline(always)]
fn rotate_rows<T: Real, const R: usize>(
    s: &mut [[T; R]; R],
    (p, q): (usize, usize),
    (cosine, sine): (T, T),
) {
    for column in s {
        let (x, y) = (column[p], column[q]);
        column[p] = cosine.multiply_add(x, -(sine * y));
        column[q] = sine.multiply_add(x, cosine * y);
    }
}

#[inline(always)]
pub(crate) fn identity<T: Real, const R: usize>() -> [[T; R]; R] {
    let mut columns = [[T::splat(0.0); R]; R];
    for (k, column) in columns.iter_mut().enumerate() {
        column[k] = T::splat(1.0);
    }
    columns
}

/// `Q diag(l) Q^T` of columns q_k.
#[inline(always)]
pub(crate) fn spectral<T: Real, const R: usize>(q: &[[T; R]; R], l: &[T; R]) -> [[T; R]; R] {
    let mut s = *q;
    for j in 0..R {
        for i in 0..R {
            let mut sum = l[0] * (q[0][i] * q[0][j]);
            for m in 1..R {
                sum = l[m].multiply_add(q[m][i] * q[m][j], sum);
            }
            s[j][i] = sum;
        }
    }
    s
}

/// The eigenvalues of a symmetric matrix and its eigenvectors by columns.
#[inline]
pub(crate) fn symmetric_eigen<T: Real, const R: usize>(s: &[[T; R]; R]) -> ([T; R], [[T; R]; R]) {
    let (mut s, mut q) = started(s);
    for _ in 0..SWEEPS {
        let mut rotated = false;
        for p in 0..R {
            for r in p + 1..R {
                let (a, off, c) = (s[p][p], s[p][r], s[r][r]);
                let close = (a.magnitude() + c.magnitude()) * (0.25 * f64::EPSILON);
                if (off.magnitude() - close).any(|x| x > 0.0) {
                    rotated = true;
                    let turn = rotation(a, off, c);
                    rotate(&mut s, (p, r), turn);
                    rotate_rows(&mut s, (p, r), turn);
                    rotate(&mut q, (p, r), turn);
                }
            }
        }
        if !rotated {
            break;
        }
    }
    let mut values = [T::splat(0.0); R];
    for k in 0..R {
        values[k] = s[k][k];
    }
    (values, q)
}

/// `Q^T S Q` and Q: three columns are diagonal to rounding of the largest entry from the start.
#[inline(always)]
fn started<T: Real, const R: usize>(s: &[[T; R]; R]) -> ([[T; R]; R], [[T; R]; R]) {
    let mut q = identity();
    if R != 3 {
        return (*s, q);
    }
    let mut largest = T::splat(f64::MIN_POSITIVE);
    for entry in s.as_flattened() {
        largest = largest.larger(entry.magnitude());
    }
    frame_of(&scaled(s, largest.reciprocal()), &mut q);
    let images = product(s, &q);
    let mut turned = *s;
    for i in 0..R {
        for j in 0..=i {
            turned[i][j] = dot(&q[i], &images[j]);
            turned[j][i] = turned[i][j];
        }
    }
    (turned, q)
}

/// [`frame`] where the compiler does not know yet that there are three columns.
#[inline(always)]
pub(crate) fn frame_of<T: Real, const R: usize>(s: &[[T; R]; R], q: &mut [[T; R]; R]) {
    let mut three = [[T::splat(0.0); 3]; 3];
    for (column, of_s) in three.iter_mut().zip(s) {
        column.copy_from_slice(&of_s[..3]);
    }
    for (column, of_frame) in q.iter_mut().zip(frame(&three)) {
        column[..3].copy_from_slice(&of_frame);
    }
}

/// The eigenvectors of a symmetric matrix whose largest entry is about one, in closed form: columns
/// of a rotation.
#[inline(always)]
pub(crate) fn frame<T: Real>(s: &[[T; 3]; 3]) -> [[T; 3]; 3] {
    let n = normalized(s);
    let h = dot(&n[0], &adjugate(&n)[0]) * 0.5;
    let apart = standing_apart(h.magnitude()).signed_by(h);
    let first = widest_direction(&adjugate(&shifted(n, -apart)));
    let mut others = complement(&first);
    let images = [apply(&n, &others[0]), apply(&n, &others[1])];
    let entry = |i: usize, j: usize| dot(&others[i], &images[j]);
    let turn = rotation(entry(0, 0), entry(0, 1), entry(1, 1));
    rotate(&mut others, (0, 1), turn);
    [first, others[0], others[1]]
}

/// `N`, or nearly zero where all eigenvalues are the same to rounding.
#[inline(always)]
fn normalized<T: Real>(s: &[[T; 3]; 3]) -> [[T; 3]; 3] {
    /// Far below the rounding of entries of about one, and yet no square of it vanishes.
    const NOTHING: f64 = 1e-30;
    let n = shifted(*s, trace(s) * (-1.0 / 3.0));
    let on = [n[0][0], n[1][1], n[2][2]];
    let off = [n[0][1], n[0][2], n[1][2]];
    let square = (dot(&off, &off) * 2.0 + dot(&on, &on)) * (1.0 / 6.0);
    scaled(&n, (square.square_root() + T::splat(NOTHING)).reciprocal())
}

/// The largest root of `x^3 - 3 x = 2 h` for h from 0 to 1: `2 cos(acos(h)/3)`, from 3^(1/2) to 2.
#[inline(always)]
fn standing_apart<T: Real>(h: T) -> T {
    /// The polynomial through the root at five Chebyshev points: off by at most 1e-5.
    const START: [f64; 5] = [1.732_060_86, 0.332_823_44, -0.091_843_87, 0.035_024_38, -0.008_070_8];
    let mut x = T::splat(START[4]);
    for k in (0..4).rev() {
        x = x.multiply_add(h, T::splat(START[k]));
    }
    // Halley's step for f = x^3 - 3 x - 2 h: it cubes what the polynomial is off by.
    let third_of_slope = x.multiply_add(x, T::splat(-1.0));
    let f = x.multiply_add(third_of_slope + T::splat(-2.0), h * -2.0);
    let whole = third_of_slope.multiply_add(third_of_slope * 3.0, -(x * f));
    x - f * third_of_slope * whole.reciprocal()
}

/// The adjugate of a symmetric matrix, symmetric.
#[inline(always)]
fn adjugate<T: Real>(s: &[[T; 3]; 3]) -> [[T; 3]; 3] {
    let minor = |i: usize, j: usize| {
        let ([a, b], [c, d]) = ([(i + 1) % 3, (i + 2) % 3], [(j + 1) % 3, (j + 2) % 3]);
        // The lower triangle only, so that symmetry is to the last bit.
        let at = |i: usize, j: usize| s[i.max(j)][i.min(j)];
        at(a, c).multiply_add(at(b, d), -(at(a, d) * at(b, c)))
    };
    let mut adjugate = *s;
    for i in 0..3 {
        for j in 0..=i {
            adjugate[i][j] = minor(i, j);
            adjugate[j][i] = adjugate[i][j];
        }
    }
    adjugate
}

/// The direction of the longest column of a matrix `c v v^T`, `c > 0`.
#[inline(always)]
fn widest_direction<T: Real>(s: &[[T; 3]; 3]) -> [T; 3] {
    let (mut longest, mut column) = (s[0][0], s[0]);
    for k in 1..3 {
        for i in 0..3 {
            column[i] = s[k][k].where_above(longest, s[k][i], column[i]);
        }
        longest = longest.larger(s[k][k]);
    }
    let inverse = dot(&column, &column).square_root().reciprocal();
    column.map(|x| x * inverse)
}

/// Two directions that make a unit vector v the first column of a rotation.
#[inline(always)]
fn complement<T: Real>([x, y, z]: &[T; 3]) -> [[T; 3]; 2] {
    let one = T::splat(1.0);
    let sign = one.signed_by(*z);
    let a = -(sign + *z).reciprocal();
    let b = *x * *y * a;
    let (xx, yy) = (*x * *x * a, *y * *y * a);
    [[sign.multiply_add(xx, one), sign * b, -(sign * *x)], [b, sign + yy, -*y]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Lanes;
    use proptest::prelude::*;

    type Three = [[f64; 3]; 3];

    /// The frame is a rotation that makes the matrix diagonal.
    fn assert_frames(s: &Three) {
        let q = frame(s);
        for k in 0..3 {
            let image = apply(s, &q[k]);
            for l in 0..3 {
                let unit = if k == l { 1.0 } else { 0.0 };
                assert!((dot(&q[k], &q[l]) - unit).abs() < 3e-15, "{s:?}: {q:?}");
                assert!(k == l || dot(&q[l], &image).abs() < 3e-15, "{s:?}: {q:?}");
            }
        }
        assert!(crate::tensor::determinant(&q) > 0.0, "{s:?}: {q:?}");
    }

    fn matrix() -> impl Strategy<Value = Three> {
        prop::array::uniform3(prop::array::uniform3(-1.0..1.0))
    }

    fn symmetric(f: &Three) -> Three {
        std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (f[i][j] + f[j][i])))
    }

    proptest! {
        #[test]
        fn the_closed_form_makes_a_matrix_diagonal(f in matrix(), small in -18.0..0.0_f64) {
            let s = symmetric(&f);
            assert_frames(&s);
            // Eigenvalues as close to each other as one likes: around one, and two of the three.
            let size = 10.0_f64.powf(small);
            assert_frames(&shifted(scaled(&s, size), 1.0));
            let nearly: Three = std::array::from_fn(|i| {
                std::array::from_fn(|j| f[0][i] * f[0][j] + size * s[i][j])
            });
            assert_frames(&nearly);
            assert_frames(&scaled(&nearly, -1.0));
        }

        #[test]
        fn symmetric_matrices_have_their_eigenvalues(f in matrix()) {
            let s = crate::tensor::gram(&f.map(|column| column.map(|x| 2.0 * x)));
            let shifted = shifted(s, -3.0);
            let (values, vectors) = symmetric_eigen(&shifted);
            let again = spectral(&vectors, &values);
            for k in 0..3 {
                for i in 0..3 {
                    prop_assert!((again[k][i] - shifted[k][i]).abs() < 1e-13);
                }
            }
        }
    }

    #[test]
    fn every_lane_has_its_own_frame_and_degenerate_matrices_have_one() {
        let of = |lane: usize| -> Three {
            match lane {
                0 => identity(),
                1 => [[1.0, 1e-170, 0.0], [1e-170, 1.0, 0.0], [0.0, 0.0, 1.0]],
                2 => [[0.0; 3]; 3],
                _ => {
                    [[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [3.0, 6.0, 9.0]].map(|c| c.map(|x| x / 9.0))
                }
            }
        };
        (0..4).for_each(|lane| assert_frames(&of(lane)));
        let lanes: [[Lanes; 3]; 3] = std::array::from_fn(|k| {
            std::array::from_fn(|i| Lanes::from(std::array::from_fn(|lane| of(lane)[k][i])))
        });
        let together = frame(&lanes);
        for lane in 0..4 {
            assert_eq!(together.map(|column| column.map(|x| x.lane(lane))), frame(&of(lane)));
        }
        let bad = frame(&[[f64::NAN, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        assert!(bad.as_flattened().iter().any(|x| x.is_nan()));
    }
}
