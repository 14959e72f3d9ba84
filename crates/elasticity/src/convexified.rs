//! An isotropic second derivative less its negative part, direction by direction.
//!
//! ```text
//! A+ = A + sum_n max(-l_n, 0) E_n (x) E_n                  E_n orthonormal D x D
//! K+(a, b) = K(a, b) + sum_n y_n(a) y_n(b)^T,              y_n(a) = (max(-l_n, 0))^(1/2) E_n a
//! ```
//! `E_n` the twists and flips of [`crate::isotropic`], `l_n` their eigenvalues (Pa). A twist's is
//! about half the sum of two principal stresses: the first to become negative, under any pressure,
//! where flips and scalings do so only under a crushing one. So as long as the scalings are positive
//! the closed form of A and a product for each negative direction are a good deal cheaper than A+
//! put together out of all of them, which is left for the rest, and for sheets and bars, whose
//! normal directions are not a sum of products. Exact to rounding relative to A. Source: Smith, de
//! Goes and Kim, Analytic Eigensystems for Isotropic Distortion Energies (2019).

use crate::isotropic::{Isotropic, PrincipalCurvature, PrincipalTangent};
use crate::material::TakesTangent;
use crate::singular::{Singular, singular};
use crate::tensor::{apply, is_positive};
use crate::{Material, Real, Tangent};

/// Hands over the second derivative of an isotropic material, and what makes it positive
/// semidefinite.
#[inline(always)]
pub(crate) fn hand_semidefinite<M, T: Real, const D: usize, const R: usize>(
    material: &M,
    f: &[[T; D]; R],
    weight: T,
    taker: &mut impl TakesTangent<T, D, R>,
) where
    M: Isotropic<R> + Material<D, R>,
{
    let frame = singular(f);
    let curvature = material.curvature(&frame.values);
    if D != R || !is_positive(&curvature.scaling) {
        return by_all_directions(&frame, &curvature, weight, taker);
    }
    taker.take(&material.tangent(f, weight));
    for i in 1..R {
        for j in 0..i {
            let twist = || frame.pair((i, j), T::splat(-1.0));
            add_negative(curvature.twist[i][j] * 0.5, weight, twist, taker);
            let flip = || frame.pair((i, j), T::splat(1.0));
            add_negative(curvature.flip[i][j] * 0.5, weight, flip, taker);
        }
    }
}

/// Adds the negative part of `l E (x) E`.
#[inline(always)]
fn add_negative<T: Real, const D: usize, const R: usize>(
    eigenvalue: T,
    weight: T,
    direction: impl Fn() -> [[T; D]; R],
    taker: &mut impl TakesTangent<T, D, R>,
) {
    if eigenvalue.any(|l| l < 0.0) {
        let root = ((-eigenvalue).positive_part() * weight).square_root();
        taker.add(&Product(crate::tensor::scaled(&direction(), root)));
    }
}

/// Puts it together out of all its directions.
#[cold]
#[inline(never)]
fn by_all_directions<T: Real, const D: usize, const R: usize>(
    frame: &Singular<T, D, R>,
    curvature: &PrincipalCurvature<T, R>,
    weight: T,
    taker: &mut impl TakesTangent<T, D, R>,
) {
    taker.take(&PrincipalTangent::new(frame, &curvature.projected(), weight));
}

impl<T: Real, const D: usize, const R: usize> Singular<T, D, R> {
    /// `u_i v_j^T + sign u_j v_i^T`.
    #[inline(always)]
    fn pair(&self, (i, j): (usize, usize), sign: T) -> [[T; D]; R] {
        let mut sum = [[T::splat(0.0); D]; R];
        for k in 0..R {
            let (of_i, of_j) = (self.right[j][k], self.right[i][k] * sign);
            for d in 0..D {
                sum[k][d] = self.left[i][d].multiply_add(of_i, self.left[j][d] * of_j);
            }
        }
        sum
    }
}

/// `E (x) E`.
struct Product<T, const D: usize, const R: usize>([[T; D]; R]);

impl<T: Real, const D: usize, const R: usize> Tangent<T, D, R> for Product<T, D, R> {
    /// `E a`.
    type Node = [T; D];

    #[inline(always)]
    fn node(&self, gradient: &[T; R]) -> [T; D] {
        apply(&self.0, gradient)
    }

    #[inline(always)]
    fn block(&self, a: &[T; D], b: &[T; D]) -> [[T; D]; D] {
        let mut block = [*a; D];
        for j in 0..D {
            for i in 0..D {
                block[j][i] = a[i] * b[j];
            }
        }
        block
    }
}
