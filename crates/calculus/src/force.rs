//! Forces that no potential gives: drag, motors, loads that change with time.
//!
//! ```text
//! p. = -dV(q) + F(t, q, v)         F a covector (n), newtons where q is a length
//! C = -dF/dv                       damping, n x n, for those who solve with it
//! ```
//! `t` seconds, `q` a configuration, `v` a velocity (n). The power that a force puts into the
//! system is `<F, v>` (notes 10.1). Forces are added, never assigned: a tuple of them is their sum.

use crate::{Covector, Sink, Vector};

/// A force on the configurations of a system with [`dim`](Force::dim) freedoms.
pub trait Force {
    /// The number of freedoms n.
    fn dim(&self) -> usize;

    /// Adds F(t, q, v) to `f`.
    fn add_force(&self, t: f64, q: &[f64], v: Vector<&[f64]>, f: Covector<&mut [f64]>);

    /// Adds the symmetric part of -dF/dv, block by block, in the same order for every q and v.
    ///
    /// What an unsymmetric dF/dv leaves out costs Newton's method iterations, not correctness.
    fn add_damping(&self, _t: f64, _q: &[f64], _v: Vector<&[f64]>, _damping: &mut impl Sink) {}

    /// Adds the symmetric part of -dF/dq, block by block, in the same order for every q.
    ///
    /// What it leaves out costs Newton's method iterations, not correctness.
    fn add_stiffness(&self, _t: f64, _q: &[f64], _stiffness: &mut impl Sink) {}

    /// How many powers it tells apart, one for each thing that acts; none unless it says so.
    fn works(&self) -> usize {
        0
    }

    /// Adds the power `<F_k(t, q, v), u>`, watts, of each thing that acts along a velocity u.
    fn add_powers(
        &self,
        _t: f64,
        _q: &[f64],
        _v: Vector<&[f64]>,
        _u: Vector<&[f64]>,
        _powers: &mut [f64],
    ) {
    }
}

impl<F: Force> Force for &F {
    fn dim(&self) -> usize {
        F::dim(self)
    }

    fn add_force(&self, t: f64, q: &[f64], v: Vector<&[f64]>, f: Covector<&mut [f64]>) {
        F::add_force(self, t, q, v, f);
    }

    fn add_damping(&self, t: f64, q: &[f64], v: Vector<&[f64]>, damping: &mut impl Sink) {
        F::add_damping(self, t, q, v, damping);
    }

    fn add_stiffness(&self, t: f64, q: &[f64], stiffness: &mut impl Sink) {
        F::add_stiffness(self, t, q, stiffness);
    }

    fn works(&self) -> usize {
        F::works(self)
    }

    fn add_powers(
        &self,
        t: f64,
        q: &[f64],
        v: Vector<&[f64]>,
        u: Vector<&[f64]>,
        powers: &mut [f64],
    ) {
        F::add_powers(self, t, q, v, u, powers);
    }
}

/// Nothing where there is none, as a part of a system that may be missing.
impl<F: Force> Force for Option<F> {
    fn dim(&self) -> usize {
        self.as_ref().map_or(0, F::dim)
    }

    fn add_force(&self, t: f64, q: &[f64], v: Vector<&[f64]>, f: Covector<&mut [f64]>) {
        if let Some(force) = self {
            force.add_force(t, q, v, f);
        }
    }

    fn add_damping(&self, t: f64, q: &[f64], v: Vector<&[f64]>, damping: &mut impl Sink) {
        if let Some(force) = self {
            force.add_damping(t, q, v, damping);
        }
    }

    fn add_stiffness(&self, t: f64, q: &[f64], stiffness: &mut impl Sink) {
        if let Some(force) = self {
            force.add_stiffness(t, q, stiffness);
        }
    }

    fn works(&self) -> usize {
        self.as_ref().map_or(0, F::works)
    }

    fn add_powers(
        &self,
        t: f64,
        q: &[f64],
        v: Vector<&[f64]>,
        u: Vector<&[f64]>,
        powers: &mut [f64],
    ) {
        if let Some(force) = self {
            force.add_powers(t, q, v, u, powers);
        }
    }
}

macro_rules! sum_of_forces {
    ($($name:ident . $index:tt),*) => {
        /// The sum of its members; its dimension is the largest of theirs. The empty sum is no force.
        impl<$($name: Force),*> Force for ($($name,)*) {
            fn dim(&self) -> usize {
                [0 $(, self.$index.dim())*].into_iter().max().unwrap_or(0)
            }

            #[inline]
            fn add_force(
                &self,
                _t: f64,
                _q: &[f64],
                _v: Vector<&[f64]>,
                mut _f: Covector<&mut [f64]>,
            ) {
                $(self.$index.add_force(_t, _q, _v, _f.view_mut());)*
            }

            #[inline]
            fn add_damping(
                &self,
                _t: f64,
                _q: &[f64],
                _v: Vector<&[f64]>,
                _damping: &mut impl Sink,
            ) {
                $(self.$index.add_damping(_t, _q, _v, _damping);)*
            }

            fn add_stiffness(&self, _t: f64, _q: &[f64], _stiffness: &mut impl Sink) {
                $(self.$index.add_stiffness(_t, _q, _stiffness);)*
            }

            fn works(&self) -> usize {
                0 $(+ self.$index.works())*
            }

            fn add_powers(
                &self,
                _t: f64,
                _q: &[f64],
                _v: Vector<&[f64]>,
                _u: Vector<&[f64]>,
                _powers: &mut [f64],
            ) {
                let rest = _powers;
                $(
                    let (own, rest) = rest.split_at_mut(self.$index.works());
                    self.$index.add_powers(_t, _q, _v, _u, own);
                )*
                let _ = rest;
            }
        }
    };
}

sum_of_forces!();
sum_of_forces!(A.0, B.1);
sum_of_forces!(A.0, B.1, C.2);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DenseSink;

    /// `F = strength t - c v` on each of two freedoms.
    struct Servo {
        strength: f64,
        c: f64,
    }

    impl Force for Servo {
        fn dim(&self) -> usize {
            2
        }

        fn add_force(&self, t: f64, _q: &[f64], v: Vector<&[f64]>, f: Covector<&mut [f64]>) {
            for (f, v) in f.0.iter_mut().zip(v.0) {
                *f += self.strength * t - self.c * v;
            }
        }

        fn add_damping(&self, _: f64, _: &[f64], _: Vector<&[f64]>, damping: &mut impl Sink) {
            (0..2).for_each(|freedom| damping.add_symmetric(&[freedom], &[self.c]));
        }

        fn works(&self) -> usize {
            2
        }

        fn add_powers(
            &self,
            t: f64,
            _: &[f64],
            v: Vector<&[f64]>,
            u: Vector<&[f64]>,
            powers: &mut [f64],
        ) {
            let along: f64 = u.0.iter().sum();
            powers[0] += self.strength * t * along;
            powers[1] -= self.c * v.0.iter().zip(u.0).map(|(v, u)| v * u).sum::<f64>();
        }
    }

    #[test]
    fn a_tuple_of_forces_is_their_sum() {
        let sum = (Servo { strength: 1.0, c: 2.0 }, (), Servo { strength: -3.0, c: 0.5 });
        let (q, v) = ([0.0; 2], Vector([1.0, -2.0]));
        let mut f = Covector([10.0, 20.0]);
        sum.add_force(4.0, &q, v.view(), f.view_mut());
        assert_eq!(f.0, [10.0 - 8.0 - 2.5, 20.0 - 8.0 + 5.0]);
        let mut damping = [0.0; 4];
        sum.add_damping(4.0, &q, v.view(), &mut DenseSink::new(1.0, 2, &mut damping).unwrap());
        assert_eq!(damping, [2.5, 0.0, 0.0, 2.5]);
        assert_eq!(sum.dim(), 2);
    }

    #[test]
    fn a_tuple_tells_the_powers_of_its_members_apart_and_their_sum_is_that_of_the_force() {
        let sum = (Servo { strength: 1.0, c: 2.0 }, (), Servo { strength: -3.0, c: 0.5 });
        let (q, v, u) = ([0.0; 2], Vector([1.0, -2.0]), Vector([3.0, 0.5]));
        let (mut f, mut powers) = (Covector([0.0; 2]), vec![0.0; sum.works()]);
        sum.add_force(4.0, &q, v.view(), f.view_mut());
        sum.add_powers(4.0, &q, v.view(), u.view(), &mut powers);
        assert_eq!(powers, [14.0, -4.0, -42.0, -1.0]);
        assert_eq!(powers.iter().sum::<f64>(), f.0[0] * u.0[0] + f.0[1] * u.0[1]);
    }

    #[test]
    fn the_empty_sum_is_no_force() {
        let mut f = Covector([7.0]);
        ().add_force(1.0, &[0.0], Vector([1.0]).view(), f.view_mut());
        assert_eq!((f.0, ().dim()), ([7.0], 0));
    }

    #[test]
    fn a_reference_to_a_force_and_one_that_may_be_missing_are_that_force() {
        fn both(force: impl Force) -> ([f64; 2], [f64; 4], usize) {
            let (mut f, mut damping) = (Covector([0.0; 2]), [0.0; 4]);
            let (q, v) = ([0.0; 2], Vector([1.0, -2.0]));
            force.add_force(4.0, &q, v.view(), f.view_mut());
            let mut sink = DenseSink::new(1.0, 2, &mut damping).unwrap();
            force.add_damping(4.0, &q, v.view(), &mut sink);
            (f.0, damping, force.dim())
        }
        let servo = || Servo { strength: 1.0, c: 2.0 };
        let expected = ([2.0, 8.0], [2.0, 0.0, 0.0, 2.0], 2);
        let force = servo();
        assert_eq!(both(&force), expected);
        assert_eq!(both(force), expected);
        assert_eq!(both(Some(servo())), expected);
        assert_eq!(both(None::<Servo>), ([0.0; 2], [0.0; 4], 0));
    }
}
