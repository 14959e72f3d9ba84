//! Potentials: an energy on configurations, its differential and its Hessian.
//!
//! ```text
//! V(q)                 energy, joules
//! dV(q)                differential, a covector: the force is -dV (notes 2, errata 9.4)
//! d2V(q)               Hessian, a symmetric bilinear form (notes 2.4)
//! ```
//! Contributions are added, never assigned (notes 3.3): a sum of potentials is a potential, here a list or a
//! tuple of them. Hot potentials write the three functions by hand, most of them as a list of
//! [`Stencils`](crate::Stencils); all others get them from [`Automatic`](crate::Automatic).

use crate::{Covector, Sink};

/// An energy on the configurations of a system with [`dim`](Potential::dim) freedoms.
///
/// `q` is a configuration of that system; on flat spaces it has `dim` numbers. Lengths are checked
/// once, when a [`System`](crate::System) is made, and not again here.
pub trait Potential {
    /// The number of freedoms n.
    fn dim(&self) -> usize;

    /// The energy V(q), in joules. Not finite where V is not defined.
    fn energy(&self, q: &[f64]) -> f64;

    /// Adds dV(q) to `dv`, which has n components.
    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>);

    /// Adds d2V(q) to `hessian`, block by block, in the same order for every q.
    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink);
}

impl<P: Potential> Potential for &P {
    fn dim(&self) -> usize {
        (**self).dim()
    }

    #[inline]
    fn energy(&self, q: &[f64]) -> f64 {
        (**self).energy(q)
    }

    #[inline]
    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        (**self).add_differential(q, dv);
    }

    #[inline]
    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        (**self).add_hessian(q, hessian);
    }
}

/// A potential that may be absent: `None` has no freedoms of its own and adds nothing.
impl<P: Potential> Potential for Option<P> {
    fn dim(&self) -> usize {
        self.as_ref().map_or(0, Potential::dim)
    }

    #[inline]
    fn energy(&self, q: &[f64]) -> f64 {
        self.as_ref().map_or(0.0, |potential| potential.energy(q))
    }

    #[inline]
    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        if let Some(potential) = self {
            potential.add_differential(q, dv);
        }
    }

    #[inline]
    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        if let Some(potential) = self {
            potential.add_hessian(q, hessian);
        }
    }
}

/// The sum of a list; its dimension is the largest of theirs.
impl<P: Potential> Potential for Vec<P> {
    fn dim(&self) -> usize {
        self.iter().map(Potential::dim).max().unwrap_or(0)
    }

    #[inline]
    fn energy(&self, q: &[f64]) -> f64 {
        self.iter().map(|potential| potential.energy(q)).sum()
    }

    #[inline]
    fn add_differential(&self, q: &[f64], mut dv: Covector<&mut [f64]>) {
        self.iter().for_each(|potential| potential.add_differential(q, dv.view_mut()));
    }

    #[inline]
    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        self.iter().for_each(|potential| potential.add_hessian(q, hessian));
    }
}

macro_rules! sum_of_potentials {
    ($($name:ident . $index:tt),+) => {
        /// The sum of its members; its dimension is the largest of theirs.
        impl<$($name: Potential),+> Potential for ($($name,)+) {
            fn dim(&self) -> usize {
                [$(self.$index.dim()),+].into_iter().max().unwrap_or(0)
            }

            #[inline]
            fn energy(&self, q: &[f64]) -> f64 {
                0.0 $(+ self.$index.energy(q))+
            }

            #[inline]
            fn add_differential(&self, q: &[f64], mut dv: Covector<&mut [f64]>) {
                $(self.$index.add_differential(q, dv.view_mut());)+
            }

            #[inline]
            fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
                $(self.$index.add_hessian(q, hessian);)+
            }
        }
    };
}

sum_of_potentials!(A.0, B.1);
sum_of_potentials!(A.0, B.1, C.2);
