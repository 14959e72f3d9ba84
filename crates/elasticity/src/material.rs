//! What a material is: an energy density, its stress, and how the stress changes.
//!
//! ```text
//! F = d phi                      D x R: how a body of R dimensions is laid out in D       (13.1)
//! W(F)                           J/m^3 (per length or area: the section is the element's)
//! P = dW/dF                      D x R, Pa: the first Piola-Kirchhoff stress
//! A_ikjl = d2W/dF_ik dF_jl       Pa
//! K(a, b)_ij = sum_kl a_k A_ikjl b_l         D x D, for gradients a and b of shape functions
//! ```
//! An element needs A only between the gradients of its shape functions, which most materials give
//! in closed form and far more cheaply than the whole of A: hence [`Tangent`]. Kernels are written
//! over any [`Real`], so that four elements go side by side.
//!
//! Knows nothing of elements, meshes or assembly. Source: notes 13.1; Bonet and Wood (2008).

use crate::Real;

/// A hyperelastic material of bodies of `R` dimensions in `D`.
pub trait Material<const D: usize, const R: usize>: Copy + Send + Sync {
    /// The second derivative at one F.
    type Tangent<T: Real>: Tangent<T, D, R>;
    /// Its nearest positive semidefinite neighbour.
    type Semidefinite<T: Real>: Tangent<T, D, R>;

    /// Whether the law takes places now for places at rest, as linear elasticity does: `P` is then
    /// Cauchy's stress as well, and no element is ever inside out to it.
    const SMALL_DISPLACEMENTS: bool = false;

    /// The energy density `W(F)`, J/m^3.
    fn energy<T: Real>(&self, f: &[[T; D]; R]) -> T;

    /// The energy densities at several F, that of number k being `f(k)`.
    ///
    /// The same as [`Material::energy`] of each, which it falls back to; but where a number has to
    /// be waited for, the others need not wait with it.
    #[inline(always)]
    fn energies<T: Real>(&self, mut f: impl FnMut(usize) -> [[T; D]; R], densities: &mut [T]) {
        for (k, density) in densities.iter_mut().enumerate() {
            *density = self.energy(&f(k));
        }
    }

    /// The stress `P`, Pa, by columns.
    fn stress<T: Real>(&self, f: &[[T; D]; R]) -> [[T; D]; R];

    /// The second derivative, times a weight.
    fn tangent<T: Real>(&self, f: &[[T; D]; R], weight: T) -> Self::Tangent<T>;

    /// Whether the second derivative is known to be positive semidefinite at F, for every element
    /// of the lanes. `false` where it would have to be computed.
    #[inline(always)]
    fn is_semidefinite<T: Real>(&self, _f: &[[T; D]; R]) -> bool {
        false
    }

    /// The second derivative's nearest positive semidefinite neighbour, times a weight.
    fn semidefinite<T: Real>(&self, f: &[[T; D]; R], weight: T) -> Self::Semidefinite<T>;

    /// Hands that neighbour over as the sum that is cheapest at this F.
    #[inline(always)]
    fn hand_semidefinite<T: Real>(
        &self,
        f: &[[T; D]; R],
        weight: T,
        taker: &mut impl TakesTangent<T, D, R>,
    ) {
        taker.take(&self.semidefinite(f, weight));
    }
}

/// Takes a second derivative in whatever form it comes.
pub trait TakesTangent<T: Real, const D: usize, const R: usize> {
    /// Takes the first part of it.
    fn take(&mut self, tangent: &impl Tangent<T, D, R>);

    /// Adds another part.
    fn add(&mut self, tangent: &impl Tangent<T, D, R>);
}

/// A second derivative of an energy density, asked for between gradients of shape functions.
pub trait Tangent<T: Real, const D: usize, const R: usize> {
    /// What is computed once for each gradient.
    type Node: Copy;

    /// Prepares a gradient.
    fn node(&self, gradient: &[T; R]) -> Self::Node;

    /// `K(a, b)`, indexed `[j][i]`: rows i belong to a, columns j to b.
    fn block(&self, a: &Self::Node, b: &Self::Node) -> [[T; D]; D];
}

/// The matrix `sum of weights times outer products` that isotropic Hookean blocks share.
///
/// `lambda x y^T + mu y x^T + mu s M + t I` with `x = F a`, `y = F b`, by columns.
#[inline(always)]
pub(crate) fn hookean_block<T: Real, const D: usize>(
    [lambda, mu]: [T; 2],
    x: &[T; D],
    y: &[T; D],
    (s, m): (T, &[[T; D]; D]),
    t: T,
) -> [[T; D]; D] {
    let mut block = [[T::splat(0.0); D]; D];
    for j in 0..D {
        let (of_x, of_y) = (lambda * y[j], mu * x[j]);
        for i in 0..D {
            let sum = s.multiply_add(m[j][i], of_y * y[i]);
            block[j][i] = of_x.multiply_add(x[i], sum);
        }
        block[j][j] += t;
    }
    block
}
