//! A spring between two vertices in D dimensions.
//!
//! ```text
//! x = x_1 - x_0,  l = |x|,  u = x/l
//! Cauchy    V = 1/2 k (l - L)^2                  dV/dx = k (l - L) u^T
//!           d2V/dx2 = k u u^T + k (1 - L/l) (I - u u^T)
//! Green     V = 1/2 k L^2 eps^2                  dV/dx = k eps x^T,    eps = (l^2 - L^2)/(2 L^2)
//!           d2V/dx2 = k x x^T / L^2 + k eps I
//! ```
//! `L` rest length in metres, `k` stiffness in N/m; a wire of axial stiffness EA has k = EA/L. The
//! differential by the other end is the opposite: what one end feels, the other feels reversed.
//!
//! With Cauchy strain and L > 0 the energy has a spike where the ends meet (notes 3.2): it has no
//! differential there, and a curvature `k (1 - L/l)` without bound nearby. The spike is refused,
//! not hidden: at l = 0 the differential is NaN, which a step reports by the freedom's number. A
//! spring without rest length has no spike, nor has Green strain; see
//! `coincident_ends_have_no_force_where_there_is_a_spike`. Source: notes 3.1-3.2; errata 3. Does
//! not model plasticity or rupture.

use stationary_calculus::{Curvature, Stencil, StencilHessian};

use crate::SpringError;

/// The measure of stretch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Strain {
    /// `(l - L)/L`: Hooke's law at every length.
    #[default]
    Cauchy,
    /// `(l^2 - L^2)/(2 L^2)`: a polynomial, smooth where the ends meet.
    Green,
}

/// A spring between two vertices: a [`Stencil`] in any number of dimensions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    vertices: [usize; 2],
    rest_length: f64,
    stiffness: f64,
    strain: Strain,
}

impl Spring {
    /// A spring of rest length L in metres and stiffness k in N/m.
    ///
    /// # Errors
    /// [`SpringError::Loop`], [`SpringError::Stiffness`] and [`SpringError::RestLength`].
    pub fn new(
        vertices: [usize; 2],
        rest_length: f64,
        stiffness: f64,
        strain: Strain,
    ) -> Result<Self, SpringError> {
        if vertices[0] == vertices[1] {
            return Err(SpringError::Loop(vertices[0]));
        }
        if !(stiffness > 0.0 && stiffness.is_finite()) {
            return Err(SpringError::Stiffness(stiffness));
        }
        let positive = rest_length > 0.0 || (rest_length == 0.0 && strain == Strain::Cauchy);
        if !(positive && rest_length.is_finite()) {
            return Err(SpringError::RestLength(rest_length));
        }
        Ok(Spring { vertices, rest_length, stiffness, strain })
    }

    /// The rest length L, metres.
    pub fn rest_length(&self) -> f64 {
        self.rest_length
    }

    /// The stiffness k, N/m.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// `(l^2 - L^2)/(2 L^2)`, factored so that small strains keep their digits.
    #[inline]
    fn green(&self, length: f64) -> f64 {
        let rest = self.rest_length;
        0.5 * ((length - rest) / rest) * ((length + rest) / rest)
    }

    /// The force along x per unit of x: `dV/dx = tension x^T`.
    #[inline]
    fn tension(&self, length: f64) -> f64 {
        match self.strain {
            Strain::Cauchy if self.rest_length == 0.0 => self.stiffness,
            Strain::Cauchy => self.stiffness * (length - self.rest_length) / length,
            Strain::Green => self.stiffness * self.green(length),
        }
    }
}

#[inline]
fn across<const D: usize>(x: &[[f64; D]; 2]) -> ([f64; D], f64) {
    let mut apart = [0.0; D];
    let mut square = 0.0;
    for c in 0..D {
        apart[c] = x[1][c] - x[0][c];
        square += apart[c] * apart[c];
    }
    (apart, square.sqrt())
}

impl<const D: usize> Stencil<2, D> for Spring {
    #[inline]
    fn vertices(&self) -> [usize; 2] {
        self.vertices
    }

    #[inline]
    fn energy(&self, x: &[[f64; D]; 2]) -> f64 {
        let (_, length) = across(x);
        let stretch = match self.strain {
            Strain::Cauchy => length - self.rest_length,
            Strain::Green => self.green(length) * self.rest_length,
        };
        0.5 * self.stiffness * stretch * stretch
    }

    #[inline]
    fn differential(&self, x: &[[f64; D]; 2]) -> [[f64; D]; 2] {
        let (apart, length) = across(x);
        let tension = self.tension(length);
        let end = apart.map(|x| tension * x);
        [end.map(|x| -x), end]
    }

    #[inline]
    fn hessian(&self, x: &[[f64; D]; 2], curvature: Curvature) -> StencilHessian<2, D> {
        let (apart, length) = across(x);
        // d2V = sideways (I - u u^T) + lengthways u u^T, by the two eigenvalues.
        let mut sideways = self.tension(length);
        let mut lengthways = match self.strain {
            Strain::Cauchy => self.stiffness,
            Strain::Green => {
                let ratio = length / self.rest_length;
                self.stiffness * ratio * ratio + sideways
            }
        };
        if curvature == Curvature::Semidefinite {
            sideways = sideways.max(0.0);
            lengthways = lengthways.max(0.0);
        }
        let rank_one = if length > 0.0 { (lengthways - sideways) / (length * length) } else { 0.0 };
        let mut block = [[[[0.0; D]; 2]; D]; 2];
        for d in 0..D {
            for c in 0..D {
                let identity = if c == d { sideways } else { 0.0 };
                let entry = identity + rank_one * apart[c] * apart[d];
                block[0][d][0][c] = entry;
                block[1][d][1][c] = entry;
                block[0][d][1][c] = -entry;
                block[1][d][0][c] = -entry;
            }
        }
        block
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use stationary_calculus::{Covector, DenseSink, Potential, Stencils};

    fn spring(rest_length: f64, strain: Strain) -> Spring {
        Spring::new([0, 1], rest_length, 3.0, strain).unwrap()
    }

    fn free(spring: Spring) -> Stencils<Spring, 2, 3> {
        Stencils::new(2, Vec::new(), vec![spring]).unwrap()
    }

    #[test]
    fn green_and_cauchy_springs_agree_to_second_order_in_the_stretch() {
        let gap = |stretch: f64| {
            let x = [[0.0; 3], [0.0, 2.0 + stretch, 0.0]];
            let energy = |strain| spring(2.0, strain).energy(&x);
            (energy(Strain::Green) - energy(Strain::Cauchy)).abs()
        };
        // Green's energy has d2/(2 L^3) (l - L)^3 more, with d2 = k L^2 (notes 3, bonus).
        let slope = (gap(0.02) / gap(0.01)).log2();
        assert!((slope - 3.0).abs() < 0.02, "{slope}");
        assert!((gap(1e-3) / (3.0 * 4.0 / (2.0 * 8.0) * 1e-9) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn coincident_ends_have_no_force_where_there_is_a_spike() {
        let x = [[1.0, 2.0, 3.0]; 2];
        let force = |spring: Spring| Stencil::<2, 3>::differential(&spring, &x)[1][0];
        assert!(force(spring(1.0, Strain::Cauchy)).is_nan());
        assert_eq!(force(spring(0.0, Strain::Cauchy)), 0.0);
        assert_eq!(force(spring(1.0, Strain::Green)), 0.0);
        // Just beside the spike the force is k L, and the sideways curvature grows like k L / l.
        let close = [[0.0; 3], [1e-9, 0.0, 0.0]];
        let spike = spring(1.0, Strain::Cauchy);
        assert!((spike.differential(&close)[1][0] + 3.0).abs() < 1e-8);
        let sideways = spike.hessian(&close, Curvature::Exact)[1][1][1][1];
        assert!((sideways / -3e9 - 1.0).abs() < 1e-8);
    }

    #[test]
    fn a_compressed_spring_has_a_negative_eigenvalue_that_the_projection_removes() {
        let x = [[0.0; 3], [0.5, 0.0, 0.0]];
        let sideways = |strain, curvature| spring(1.0, strain).hessian(&x, curvature)[1][1][1][1];
        for strain in [Strain::Cauchy, Strain::Green] {
            assert!(sideways(strain, Curvature::Exact) < 0.0);
            assert_eq!(sideways(strain, Curvature::Semidefinite), 0.0);
        }
    }

    #[test]
    fn springs_that_cannot_be_are_refused() {
        let new = |vertices, length, stiffness, strain| {
            Spring::new(vertices, length, stiffness, strain).unwrap_err()
        };
        assert_eq!(new([4, 4], 1.0, 1.0, Strain::Cauchy), SpringError::Loop(4));
        assert_eq!(new([0, 1], 1.0, 0.0, Strain::Cauchy), SpringError::Stiffness(0.0));
        assert_eq!(new([0, 1], -1.0, 1.0, Strain::Cauchy), SpringError::RestLength(-1.0));
        assert_eq!(new([0, 1], 0.0, 1.0, Strain::Green), SpringError::RestLength(0.0));
        let error = new([0, 1], f64::NAN, 1.0, Strain::Cauchy);
        assert!(matches!(error, SpringError::RestLength(length) if length.is_nan()));
    }

    proptest! {
        #[test]
        fn ends_feel_opposite_forces_along_the_spring(
            q in prop::array::uniform6(-1.0..1.0_f64), green: bool,
        ) {
            let strain = if green { Strain::Green } else { Strain::Cauchy };
            let mut dv = Covector([0.0; 6]);
            free(spring(0.7, strain)).add_differential(&q, dv.view_mut());
            for c in 0..3 {
                prop_assert_eq!(dv.0[c], -dv.0[c + 3]);
                let (a, b) = ((c + 1) % 3, (c + 2) % 3);
                let one = (q[a + 3] - q[a]) * dv.0[b + 3];
                let other = (q[b + 3] - q[b]) * dv.0[a + 3];
                prop_assert!((one - other).abs() <= 1e-14 * one.abs().max(other.abs()));
            }
        }

        #[test]
        fn rigid_translations_cost_no_curvature(
            q in prop::array::uniform6(-1.0..1.0_f64), green: bool,
        ) {
            let strain = if green { Strain::Green } else { Strain::Cauchy };
            let mut h = [0.0; 36];
            let mut sink = DenseSink::new(1.0, 6, &mut h).unwrap();
            free(spring(0.7, strain)).add_hessian(&q, &mut sink);
            for (i, column) in h.chunks_exact(6).enumerate() {
                for c in 0..3 {
                    prop_assert_eq!(column[c] + column[c + 3], 0.0, "column {}", i);
                }
            }
        }
    }
}
