//! Vectors and covectors: two kinds of arrays that only a metric turns into each other.
//!
//! ```text
//! <nu, v> = nu_1 v_1 + ... + nu_n v_n        the only product
//! ```
//! Velocities are vectors; momenta, differentials and forces are covectors (notes 1.2, 4.1). A
//! configuration is neither: it is a point, a plain slice of numbers, and on curved spaces it may
//! store more of them than the system has freedoms.
//!
//! Either kind wraps any storage that lends a slice: `[f64; N]` on the stack, `Vec<f64>`, or a
//! borrowed part of a larger state. Vectors and covectors do not add to each other, and there is
//! no product of two vectors: that is [`Metric::inner`](crate::Metric::inner).
//!
//! ```compile_fail
//! use stationary_calculus::{Covector, Vector};
//! let mut v = Vector([1.0, 2.0]);
//! v.add_scaled(1.0, Covector([0.0, 1.0]).view());
//! ```

/// Owned numbers that a state or a workspace consists of: `[f64; N]` or `Vec<f64>`.
pub trait Storage: Clone + PartialEq + AsRef<[f64]> + AsMut<[f64]> {
    /// A square matrix, n columns of n numbers each: on the stack where a column is.
    type Columns: Clone + std::fmt::Debug + AsRef<[Self]> + AsMut<[Self]>;

    /// As many columns of zeros as a column has numbers.
    fn columns(n: usize) -> Option<Self::Columns>;

    /// `n` zeros, or `None` where the type holds another number of them or there is no memory for so
    /// many.
    fn zeros(n: usize) -> Option<Self>;

    /// Lends itself by value, so that an array used as scratch memory lives in registers while a
    /// vector's memory is only moved. To be given back by [`Storage::put_back`].
    fn lend(&mut self) -> Self;

    /// Takes back the memory that was lent. What an array holds is then undefined.
    fn put_back(&mut self, lent: Self);
}

impl<const N: usize> Storage for [f64; N] {
    type Columns = [[f64; N]; N];

    fn columns(n: usize) -> Option<Self::Columns> {
        (n == N).then_some([[0.0; N]; N])
    }

    fn zeros(n: usize) -> Option<Self> {
        (n == N).then_some([0.0; N])
    }

    #[inline]
    fn lend(&mut self) -> Self {
        [0.0; N]
    }

    #[inline]
    fn put_back(&mut self, _lent: Self) {}
}

impl Storage for Vec<f64> {
    type Columns = Vec<Vec<f64>>;

    fn columns(n: usize) -> Option<Self::Columns> {
        Some(vec![vec![0.0; n]; n])
    }

    fn zeros(n: usize) -> Option<Self> {
        let mut zeros = Vec::new();
        zeros.try_reserve_exact(n).ok()?;
        zeros.resize(n, 0.0);
        Some(zeros)
    }

    #[inline]
    fn lend(&mut self) -> Self {
        std::mem::take(self)
    }

    #[inline]
    fn put_back(&mut self, lent: Self) {
        *self = lent;
    }
}

macro_rules! linear_object {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Copy, Debug, Default, PartialEq)]
        pub struct $name<C>(pub C);

        impl<C: Clone> Clone for $name<C> {
            #[inline]
            fn clone(&self) -> Self {
                $name(self.0.clone())
            }

            /// Reuses the memory that is there.
            #[inline]
            fn clone_from(&mut self, source: &Self) {
                self.0.clone_from(&source.0);
            }
        }

        impl<C: AsRef<[f64]>> $name<C> {
            /// The same object, borrowed.
            #[inline]
            pub fn view(&self) -> $name<&[f64]> {
                $name(self.0.as_ref())
            }

            /// Its components in the chosen basis.
            #[inline]
            pub fn components(&self) -> &[f64] {
                self.0.as_ref()
            }
        }

        impl<C: AsMut<[f64]>> $name<C> {
            /// The same object, borrowed for writing.
            #[inline]
            pub fn view_mut(&mut self) -> $name<&mut [f64]> {
                $name(self.0.as_mut())
            }

            /// Its components, for writing.
            #[inline]
            pub fn components_mut(&mut self) -> &mut [f64] {
                self.0.as_mut()
            }

            /// Sets every component to minus zero, to which a sum may be added without being rounded
            /// or waited for: x + (-0.0) is x, and a compiler knows.
            #[inline]
            pub fn clear(&mut self) {
                self.0.as_mut().fill(-0.0);
            }

            /// Adds `scale` times an object of the same kind and length.
            #[inline]
            pub fn add_scaled(&mut self, scale: f64, other: $name<&[f64]>) {
                add_scaled(self.0.as_mut(), scale, other.0);
            }

            /// Copies an object of the same kind and length.
            #[inline]
            pub fn copy_from(&mut self, other: $name<&[f64]>) {
                self.0.as_mut().copy_from_slice(other.0);
            }
        }
    };
}

linear_object! {
    /// A tangent vector: a velocity, a direction, a displacement. Contravariant, a column.
    Vector
}

linear_object! {
    /// A linear function of vectors: a momentum, a differential, a force. Covariant, a row.
    Covector
}

impl<C: AsRef<[f64]>> Covector<C> {
    /// The covector applied to a vector of the same length: the number `<nu, v>`.
    #[inline]
    pub fn apply<D: AsRef<[f64]>>(&self, v: &Vector<D>) -> f64 {
        let (nu, v) = (self.components(), v.components());
        debug_assert_eq!(nu.len(), v.len());
        nu.iter().zip(v).map(|(a, b)| a * b).sum()
    }
}

/// `y += scale x`, with the lengths tied so that no bounds are checked inside.
#[inline]
pub(crate) fn add_scaled(y: &mut [f64], scale: f64, x: &[f64]) {
    debug_assert_eq!(y.len(), x.len());
    let x = &x[..y.len()];
    for (y, x) in y.iter_mut().zip(x) {
        *y += scale * x;
    }
}

/// The index of the first entry that is not finite.
///
/// Branch-free over the whole slice where all is well, so that it costs next to nothing in a step.
#[expect(clippy::eq_op, reason = "a number less itself is zero where it is finite")]
#[inline]
pub fn first_non_finite(numbers: &[f64]) -> Option<usize> {
    // By comparisons, numbers in registers would be taken apart.
    let (eights, rest) = numbers.as_chunks::<8>();
    let mut sums = [0.0; 8];
    for eight in eights {
        for (sum, x) in sums.iter_mut().zip(eight) {
            *sum += x - x;
        }
    }
    let sum = rest.iter().fold(sums.iter().sum::<f64>(), |sum, x| sum + (x - x));
    if sum == 0.0 { None } else { numbers.iter().position(|x| !x.is_finite()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_first_number_that_is_not_finite_is_found_at_every_place() {
        for (n, bad) in (0..20).flat_map(|n| (0..n).map(move |bad| (n, bad))) {
            let mut numbers = vec![f64::MAX; n];
            assert_eq!(first_non_finite(&numbers), None);
            for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                numbers[bad..].fill(wrong);
                assert_eq!(first_non_finite(&numbers), Some(bad));
            }
        }
    }

    proptest! {
        #[test]
        fn applying_a_covector_is_linear(
            nu in prop::array::uniform3(-1e3..1e3),
            v in prop::array::uniform3(-1e3..1e3),
            w in prop::array::uniform3(-1e3..1e3),
            a in -1e3..1e3,
        ) {
            let (nu, mut sum) = (Covector(nu), Vector(v));
            sum.add_scaled(a, Vector(w).view());
            let expected = nu.apply(&Vector(v)) + a * nu.apply(&Vector(w));
            prop_assert!((nu.apply(&sum) - expected).abs() <= 1e-4);
        }
    }

    #[test]
    fn the_first_bad_number_is_found() {
        assert_eq!(first_non_finite(&[0.0, f64::INFINITY, f64::NAN]), Some(1));
        assert_eq!(first_non_finite(&[0.0, f64::NAN]), Some(1));
        assert_eq!(first_non_finite(&[-0.0, f64::MAX, f64::MIN_POSITIVE]), None);
    }

    #[test]
    fn arrays_hold_their_own_number_of_components_only() {
        assert_eq!(<[f64; 2]>::zeros(2), Some([0.0; 2]));
        assert_eq!(<[f64; 2]>::zeros(3), None);
        assert_eq!(Vec::zeros(3), Some(vec![0.0; 3]));
    }
}
