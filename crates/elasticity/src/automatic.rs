//! Materials of one's own: the energy density written once, its derivatives exact.
//!
//! ```text
//! W(F + eps_1 A + eps_2 B) = W + eps_1 P:A + eps_2 P:B + eps_1 eps_2 A:(dP/dF):B
//! ```
//! A [`Density`] is a formula over any [`Number`]; [`AutomaticMaterial`] makes a [`Material`] of
//! it. In space a stress costs 9 evaluations and a second derivative 45, a hundred times a closed
//! form: for experiments, and as the oracle of what is written by hand. Whether W is frame
//! invariant, zero at rest and nonnegative is the author's business. Source: notes 13.1, laws 1-4.

use num_dual::{Dual64, HyperDual64};
use stationary_calculus::Number;

use crate::{FullTangent, Material, Real};

/// An energy density of one's own.
pub trait Density<const D: usize, const R: usize>: Copy + Send + Sync {
    /// `W(F)`, J/m^3, of F by columns.
    fn density<N: Number>(&self, f: [[N; D]; R]) -> N;
}

/// The material of a [`Density`].
///
/// ```
/// use stationary_calculus::Number;
/// use stationary_elasticity::{AutomaticMaterial, Density, Material};
/// /// A membrane that costs its own area, like a film of soap: W = tension sqrt(det F^T F).
/// #[derive(Clone, Copy)]
/// struct Soap { tension: f64 }
/// impl Density<3, 2> for Soap {
///     fn density<N: Number>(&self, [a, b]: [[N; 3]; 2]) -> N {
///         let dot = |x: [N; 3], y: [N; 3]| x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
///         (dot(a, a) * dot(b, b) - dot(a, b) * dot(a, b)).sqrt() * self.tension
///     }
/// }
/// let film = AutomaticMaterial(Soap { tension: 0.05 });
/// let stress = film.stress(&[[2.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
/// assert!((stress[1][1] - 0.1).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AutomaticMaterial<W>(pub W);

impl<W: Density<D, R>, const D: usize, const R: usize> Material<D, R> for AutomaticMaterial<W> {
    type Tangent<T: Real> = FullTangent<T, D, R>;
    type Semidefinite<T: Real> = FullTangent<T, D, R>;

    fn energy<T: Real>(&self, f: &[[T; D]; R]) -> T {
        let mut energy = T::splat(0.0);
        for lane in 0..T::WIDTH {
            energy.set_lane(lane, self.0.density(numbers(f, lane)));
        }
        energy
    }

    fn stress<T: Real>(&self, f: &[[T; D]; R]) -> [[T; D]; R] {
        let mut stress = *f;
        for lane in 0..T::WIDTH {
            let f = numbers(f, lane).map(|column| column.map(Dual64::from_re));
            for (k, column) in stress.iter_mut().enumerate() {
                for (i, entry) in column.iter_mut().enumerate() {
                    let mut f = f;
                    f[k][i].eps = 1.0;
                    entry.set_lane(lane, self.0.density(f).eps);
                }
            }
        }
        stress
    }

    fn tangent<T: Real>(&self, f: &[[T; D]; R], weight: T) -> FullTangent<T, D, R> {
        let mut tangent = FullTangent([[[[T::splat(0.0); D]; R]; D]; R]);
        for lane in 0..T::WIDTH {
            let f = numbers(f, lane).map(|column| column.map(HyperDual64::from_re));
            for first in 0..D * R {
                for second in 0..=first {
                    let ((k, i), (l, j)) = ((first / D, first % D), (second / D, second % D));
                    let mut f = f;
                    (f[k][i].eps1, f[l][j].eps2) = (1.0, 1.0);
                    let entry = self.0.density(f).eps1eps2 * weight.lane(lane);
                    tangent.0[l][j][k][i].set_lane(lane, entry);
                    tangent.0[k][i][l][j].set_lane(lane, entry);
                }
            }
        }
        tangent
    }

    fn semidefinite<T: Real>(&self, f: &[[T; D]; R], weight: T) -> FullTangent<T, D, R> {
        self.tangent(f, weight).projected()
    }
}

fn numbers<T: Real, const D: usize, const R: usize>(f: &[[T; D]; R], lane: usize) -> [[f64; D]; R] {
    f.map(|column| column.map(|entry| entry.lane(lane)))
}
