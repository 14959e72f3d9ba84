//! Discrete Lagrangians from continuous ones: where in a step the Lagrangian is looked at.
//!
//! ```text
//! v = (q1 - q0)/h
//! start      L_d = L(q0, v)                        V(q0): kick-drift symplectic Euler
//! end        L_d = L(q1, v)                        V(q1): drift-kick symplectic Euler
//! middle     L_d = L((q0 + q1)/2, v)               implicit midpoint
//! ends       L_d = 1/2 L(q0, v) + 1/2 L(q1, v)     Stormer-Verlet, not the trapezoid rule
//! ```
//! The methods on the right come out for masses that do not depend on q, with momenta by the
//! discrete Legendre transforms; a kinetic energy that depends on q is looked at where V is, and
//! the step is then implicit for every choice. Orders 1, 1, 2, 2; the last two are symmetric.
//! Source: notes 5.4, 5.5; errata 5 ("trapezoid rule comes out of the recipe" is wrong, and so is
//! `p = M (q1 - q0)/h` for the midpoint).

use stationary_calculus::{Number, array};

use crate::{Damping, DiscreteLagrangian, Facts, Lagrangian, Stability, VARIATIONAL};

/// Where in a step the Lagrangian is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quadrature {
    /// Where the step starts.
    Start,
    /// Where it ends.
    End,
    /// Midway between the two configurations.
    Middle,
    /// At both ends, and the mean is taken.
    Ends,
}

impl Quadrature {
    /// Every choice.
    pub const ALL: [Quadrature; 4] =
        [Quadrature::Start, Quadrature::End, Quadrature::Middle, Quadrature::Ends];
}

/// A continuous Lagrangian, made discrete by a quadrature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampled<L> {
    /// The continuous Lagrangian.
    pub lagrangian: L,
    /// Where it is looked at.
    pub quadrature: Quadrature,
}

impl<L: Lagrangian<N>, const N: usize> DiscreteLagrangian<N> for Sampled<L> {
    fn value<R: Number>(&self, q0: [R; N], q1: [R; N], h: f64) -> R {
        let v: [R; N] = array(|i| (q1[i] - q0[i]) / h);
        let at = |q| self.lagrangian.value(q, v);
        match self.quadrature {
            Quadrature::Start => at(q0),
            Quadrature::End => at(q1),
            Quadrature::Middle => at(array(|i| (q0[i] + q1[i]) * 0.5)),
            Quadrature::Ends => (at(q0) + at(q1)) * 0.5,
        }
    }

    fn facts(&self) -> Facts {
        let first = Facts { stability: Stability::Below(2.0), ..VARIATIONAL };
        let second = Facts { order: 2, symmetric: true, ..first };
        match self.quadrature {
            Quadrature::Start => Facts { name: "variational-start", ..first },
            Quadrature::End => Facts { name: "variational-end", ..first },
            Quadrature::Ends => Facts { name: "variational-ends", ..second },
            Quadrature::Middle => Facts {
                name: "variational-middle",
                stability: Stability::Always,
                damping: Damping::AStable,
                ..second
            },
        }
    }
}
