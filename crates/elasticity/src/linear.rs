//! Linear elasticity: for displacements so small that turning and stretching add up.
//!
//! ```text
//! e = 1/2 (F + F^T) - I,   W = mu tr e^2 + lambda/2 (tr e)^2,   P = 2 mu e + lambda tr e I
//! K(a, b) = lambda a b^T + mu b a^T + mu (a.b) I
//! ```
//! `(lambda, mu)` Lame's pair of d dimensions, Pa. What textbooks call linear elasticity: the
//! energy is quadratic in the displacement and one linear solve finds its equilibrium. It takes a
//! rotation by an angle t for a compression of 1 - cos t, so large turns cost energy: not
//! invariant, and said so.

use crate::material::hookean_block;
use crate::tensor::{dot, inner, scaled, trace};
use crate::{Lame, Material, Real, Tangent};

/// The linear material of bodies that fill their space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear<const D: usize> {
    lame: Lame<D>,
}

impl<const D: usize> Linear<D> {
    /// The material of a pair.
    pub fn new(lame: Lame<D>) -> Self {
        Linear { lame }
    }

    /// Its pair.
    pub fn lame(&self) -> Lame<D> {
        self.lame
    }
}

#[inline(always)]
fn strain<T: Real, const D: usize>(f: &[[T; D]; D]) -> [[T; D]; D] {
    let mut strain = [[T::splat(0.0); D]; D];
    for k in 0..D {
        for i in 0..D {
            strain[k][i] = (f[k][i] + f[i][k]) * 0.5;
        }
        strain[k][k] += T::splat(-1.0);
    }
    strain
}

impl<const D: usize> Material<D, D> for Linear<D> {
    type Tangent<T: Real> = LinearTangent<T, D>;
    type Semidefinite<T: Real> = LinearTangent<T, D>;

    const SMALL_DISPLACEMENTS: bool = true;

    #[inline(always)]
    fn energy<T: Real>(&self, f: &[[T; D]; D]) -> T {
        let strain = strain(f);
        let spread = trace(&strain);
        inner(&strain, &strain) * self.lame.mu() + spread * spread * (0.5 * self.lame.lambda())
    }

    #[inline(always)]
    fn stress<T: Real>(&self, f: &[[T; D]; D]) -> [[T; D]; D] {
        let strain = strain(f);
        let pressure = trace(&strain) * self.lame.lambda();
        let mut stress = scaled(&strain, T::splat(2.0 * self.lame.mu()));
        for (k, column) in stress.iter_mut().enumerate() {
            column[k] += pressure;
        }
        stress
    }

    #[inline(always)]
    fn tangent<T: Real>(&self, _f: &[[T; D]; D], weight: T) -> LinearTangent<T, D> {
        let mut identity = [[T::splat(0.0); D]; D];
        for (k, column) in identity.iter_mut().enumerate() {
            column[k] = T::splat(1.0);
        }
        LinearTangent { pair: [weight * self.lame.lambda(), weight * self.lame.mu()], identity }
    }

    #[inline(always)]
    fn is_semidefinite<T: Real>(&self, _f: &[[T; D]; D]) -> bool {
        true
    }

    #[inline(always)]
    fn semidefinite<T: Real>(&self, f: &[[T; D]; D], weight: T) -> LinearTangent<T, D> {
        self.tangent(f, weight)
    }
}

/// The second derivative of the linear energy, times a weight: the same everywhere.
#[derive(Clone, Copy, Debug)]
pub struct LinearTangent<T, const D: usize> {
    pair: [T; 2],
    identity: [[T; D]; D],
}

impl<T: Real, const D: usize> Tangent<T, D, D> for LinearTangent<T, D> {
    /// The gradient itself.
    type Node = [T; D];

    #[inline(always)]
    fn node(&self, gradient: &[T; D]) -> [T; D] {
        *gradient
    }

    #[inline(always)]
    fn block(&self, a: &[T; D], b: &[T; D]) -> [[T; D]; D] {
        let shear = (self.pair[1] * dot(a, b), &self.identity);
        hookean_block(self.pair, a, b, shear, T::splat(0.0))
    }
}
