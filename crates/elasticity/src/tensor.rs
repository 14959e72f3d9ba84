//! Small matrices by columns, over any [`Real`]: what kernels are made of.
//!
//! ```text
//! F[k][i] = F_ik       D x R, column k the image of the k-th reference direction
//! ```

use crate::Real;
use stationary_calculus::array;

/// The inner product.
#[inline(always)]
pub(crate) fn dot<T: Real, const D: usize>(a: &[T; D], b: &[T; D]) -> T {
    let mut sum = a[0] * b[0];
    for i in 1..D {
        sum = a[i].multiply_add(b[i], sum);
    }
    sum
}

/// `F g`.
#[inline(always)]
pub(crate) fn apply<T: Real, const D: usize, const R: usize>(
    f: &[[T; D]; R],
    g: &[T; R],
) -> [T; D] {
    let mut image = f[0];
    for entry in &mut image {
        *entry = *entry * g[0];
    }
    for k in 1..R {
        for i in 0..D {
            image[i] = f[k][i].multiply_add(g[k], image[i]);
        }
    }
    image
}

/// `F^T F`, symmetric.
#[inline(always)]
pub(crate) fn gram<T: Real, const D: usize, const R: usize>(f: &[[T; D]; R]) -> [[T; R]; R] {
    let mut product = [[T::splat(0.0); R]; R];
    for k in 0..R {
        for l in 0..=k {
            product[k][l] = dot(&f[k], &f[l]);
            product[l][k] = product[k][l];
        }
    }
    product
}

/// `F F^T`, symmetric.
#[inline(always)]
pub(crate) fn outer_gram<T: Real, const D: usize, const R: usize>(f: &[[T; D]; R]) -> [[T; D]; D] {
    let mut product = [[T::splat(0.0); D]; D];
    for i in 0..D {
        for j in 0..=i {
            let mut sum = f[0][i] * f[0][j];
            for column in &f[1..] {
                sum = column[i].multiply_add(column[j], sum);
            }
            product[i][j] = sum;
            product[j][i] = sum;
        }
    }
    product
}

/// `F S`, column by column.
#[inline(always)]
pub(crate) fn product<T: Real, const D: usize, const R: usize>(
    f: &[[T; D]; R],
    s: &[[T; R]; R],
) -> [[T; D]; R] {
    let mut columns = [[T::splat(0.0); D]; R];
    for (column, s) in columns.iter_mut().zip(s) {
        *column = apply(f, s);
    }
    columns
}

/// The sum of the diagonal.
#[inline(always)]
pub(crate) fn trace<T: Real, const R: usize>(s: &[[T; R]; R]) -> T {
    let mut sum = s[0][0];
    for k in 1..R {
        sum += s[k][k];
    }
    sum
}

/// `tr A^T B`.
#[inline(always)]
pub(crate) fn inner<T: Real, const D: usize, const R: usize>(
    a: &[[T; D]; R],
    b: &[[T; D]; R],
) -> T {
    let mut sum = dot(&a[0], &b[0]);
    for k in 1..R {
        sum += dot(&a[k], &b[k]);
    }
    sum
}

/// The cross product, in space.
#[inline(always)]
pub(crate) fn cross<T: Real, const D: usize>(a: &[T; D], b: &[T; D]) -> [T; D] {
    let mut product = *a;
    for (i, entry) in product.iter_mut().enumerate() {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        *entry = a[j].multiply_add(b[k], -(a[k] * b[j]));
    }
    product
}

/// The matrix of cofactors, dJ/dF, of a square matrix of one, two or three columns.
#[inline(always)]
pub(crate) fn cofactor<T: Real, const D: usize>(f: &[[T; D]; D]) -> [[T; D]; D] {
    const { assert!(1 <= D && D <= 3, "space has one, two or three dimensions") };
    match D {
        1 => [[T::splat(1.0); D]; D],
        2 => array(|k| {
            let other = &f[1 - k];
            let sign = if k == 0 { 1.0 } else { -1.0 };
            array(|i| if i == 0 { other[1] * sign } else { other[0] * -sign })
        }),
        _ => {
            let mut columns = *f;
            for (k, column) in columns.iter_mut().enumerate() {
                *column = cross(&f[(k + 1) % 3], &f[(k + 2) % 3]);
            }
            columns
        }
    }
}

/// The determinant, from the first column and its cofactors.
#[inline(always)]
pub(crate) fn determinant<T: Real, const D: usize>(f: &[[T; D]; D]) -> T {
    dot(&f[0], &cofactor(f)[0])
}

/// `S + shift I`.
#[inline(always)]
pub(crate) fn shifted<T: Real, const R: usize>(mut s: [[T; R]; R], shift: T) -> [[T; R]; R] {
    for (k, column) in s.iter_mut().enumerate() {
        column[k] += shift;
    }
    s
}

/// `scale S`.
#[inline(always)]
pub(crate) fn scaled<T: Real, const D: usize, const R: usize>(
    s: &[[T; D]; R],
    scale: T,
) -> [[T; D]; R] {
    let mut product = *s;
    for column in &mut product {
        for entry in column {
            *entry = *entry * scale;
        }
    }
    product
}

/// Whether a symmetric matrix is positive definite, in every lane: by its leading minors.
#[inline(always)]
pub(crate) fn is_positive<T: Real, const R: usize>(s: &[[T; R]; R]) -> bool {
    let positive = |x: f64| x > 0.0;
    let corner = s[0][0].all(positive);
    if R == 1 {
        return corner;
    }
    let minor = |i: usize, j: usize| s[0][i] * s[j][0];
    let (a, second) = (s[0][0], s[0][0] * s[1][1] - minor(1, 1));
    if R == 2 || !corner || !second.all(positive) {
        return corner && second.all(positive);
    }
    let (third, mixed) = (a * s[2][2] - minor(2, 2), a * s[1][2] - minor(2, 1));
    (second * third - mixed * mixed).all(positive)
}

/// The displacement gradient `G = F - I`, of a body that lies along its first R directions; exact
/// near rest.
#[inline(always)]
pub(crate) fn displacement_gradient<T: Real, const D: usize, const R: usize>(
    f: &[[T; D]; R],
) -> [[T; D]; R] {
    let mut g = *f;
    for (k, column) in g.iter_mut().enumerate() {
        column[k] += T::splat(-1.0);
    }
    g
}

/// `C - I = F^T F - I = G + G^T + G^T G`: nothing of small strains is lost to the ones, and no more
/// than `F^T F - I` loses where a body is turned.
#[inline(always)]
pub(crate) fn twice_green<T: Real, const D: usize, const R: usize>(f: &[[T; D]; R]) -> [[T; R]; R] {
    let g = displacement_gradient(f);
    let mut strain = [[T::splat(0.0); R]; R];
    for k in 0..R {
        for l in 0..=k {
            strain[k][l] = dot(&g[k], &g[l]) + (g[k][l] + g[l][k]);
            strain[l][k] = strain[k][l];
        }
    }
    strain
}

/// Green's strain `1/2 (F^T F - I)`.
#[inline(always)]
pub(crate) fn green<T: Real, const D: usize, const R: usize>(f: &[[T; D]; R]) -> [[T; R]; R] {
    scaled(&twice_green(f), T::splat(0.5))
}

/// `J - 1` from G and its cofactors: `tr G + tr cof G + det G` in space, `tr G + det G` in the plane.
#[inline(always)]
pub(crate) fn growth<T: Real, const D: usize>(g: &[[T; D]; D], cofactor: &[[T; D]; D]) -> T {
    let trace = trace(g);
    match D {
        1 => trace,
        2 => dot(&g[0], &cofactor[0]) + trace,
        _ => dot(&g[0], &cofactor[0]) + (trace + self::trace(cofactor)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growth_and_strain_keep_the_digits_of_small_gradients() {
        let near = |size: f64| -> [[f64; 3]; 3] {
            [[1.0 + size, 2.0 * size, 0.0], [0.0, 1.0 - size, size], [size, 0.0, 1.0 + size]]
        };
        // With e = size: J - 1 = e - e^2 + ..., C_11 - 1 = 2 e + 5 e^2, of sizes that are doubles.
        for size in [2.0_f64.powi(-40), 2.0_f64.powi(-20), 2.0_f64.powi(-7)] {
            let f = near(size);
            let g = displacement_gradient(&f);
            let e = size;
            let exact = e - e * e + e.powi(3);
            assert!((growth(&g, &cofactor(&g)) - exact).abs() <= 1e-15 * e);
            assert!((growth(&g, &cofactor(&g)) - (determinant(&f) - 1.0)).abs() < 1e-15);
            assert!((twice_green(&f)[0][0] - (2.0 * e + 5.0 * e * e)).abs() <= 1e-15 * e);
        }
    }

    #[test]
    fn cofactors_are_the_inverse_transposed_times_the_determinant() {
        let f: [[f64; 3]; 3] = [[1.0, 0.5, -0.2], [0.3, 2.0, 0.7], [-0.4, 0.1, 1.5]];
        let (c, j) = (cofactor(&f), determinant(&f));
        let inverse = nalgebra::Matrix3::from(f).try_inverse().unwrap();
        for k in 0..3 {
            for i in 0..3 {
                assert!((c[k][i] - j * inverse[(k, i)]).abs() < 1e-14);
            }
        }
        let f: [[f64; 2]; 2] = [[1.0, 0.5], [0.3, 2.0]];
        assert_eq!(cofactor(&f), [[2.0, -0.3], [-0.5, 1.0]]);
        assert_eq!(determinant(&f), 2.0 - 0.15);
        assert_eq!(determinant(&[[-3.0]]), -3.0);
    }
}
