//! Gravity: the potentials that the notes begin with (0.3) and the one that moves the planets.
//!
//! ```text
//! uniform      V = - sum_i m_i <g, q_i>              g in m/s^2 (errata 0.3)
//! central      V = - mu m / |q|                      about the origin, mu in m^3/s^2
//! Newtonian    V = - sum_{i<j} G m_i m_j / |q_i - q_j| - sum_{i,k} G m_i M_k / |q_i - X_k|
//! ```
//! `q_i` positions in D dimensions, `m_i` masses; `M_k` masses that stay at `X_k`. The last two are singular
//! where particles meet: the energy there is not finite, and a step that arrives there is an error.

use stationary_calculus::{Covector, Potential, Sink, array};

/// A uniform field on particles.
#[derive(Clone, Debug, PartialEq)]
pub struct UniformGravity<const D: usize> {
    /// The acceleration g, m/s^2.
    pub acceleration: [f64; D],
    /// The mass of each particle, kg.
    pub masses: Vec<f64>,
}

impl<const D: usize> Potential for UniformGravity<D> {
    fn dim(&self) -> usize {
        D * self.masses.len()
    }

    #[inline]
    fn energy(&self, q: &[f64]) -> f64 {
        let mut energy = 0.0;
        for (q, m) in q.as_chunks::<D>().0.iter().zip(&self.masses) {
            energy -= m * dot(&self.acceleration, q);
        }
        energy
    }

    #[inline]
    fn add_differential(&self, _q: &[f64], dv: Covector<&mut [f64]>) {
        for (row, m) in dv.0.as_chunks_mut::<D>().0.iter_mut().zip(&self.masses) {
            for (row, g) in row.iter_mut().zip(&self.acceleration) {
                *row -= m * g;
            }
        }
    }

    fn add_hessian(&self, _q: &[f64], _hessian: &mut impl Sink) {}
}

/// The field of a mass at the origin, on one particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CentralGravity<const D: usize> {
    /// Strength of the field times the particle's mass: G m_0 m, in kg m^3/s^2.
    pub strength: f64,
}

impl<const D: usize> Potential for CentralGravity<D> {
    fn dim(&self) -> usize {
        D
    }

    #[inline]
    fn energy(&self, q: &[f64]) -> f64 {
        -self.strength / dot::<D>(leading(q), leading(q)).sqrt()
    }

    #[inline]
    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let q = leading::<D>(q);
        let r2 = dot(q, q);
        let factor = self.strength / (r2 * r2.sqrt());
        for (row, q) in dv.0.iter_mut().zip(q) {
            *row += factor * q;
        }
    }

    #[inline]
    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        let block = attraction_hessian(self.strength, leading::<D>(q));
        hessian.add_symmetric(&array::<_, D>(|i| i), block.as_flattened());
    }
}

/// The attraction of every two particles, and of each by masses that stay where they are.
#[derive(Clone, Debug, PartialEq)]
pub struct NewtonianGravity<const D: usize> {
    /// The constant of gravitation G, m^3/(kg s^2) or in the problem's own units.
    pub constant: f64,
    /// The mass of each particle, kg or in the problem's own units.
    pub masses: Vec<f64>,
    /// Masses that have no freedoms, and their places.
    pub fixed: Vec<(f64, [f64; D])>,
}

impl<const D: usize> NewtonianGravity<D> {
    /// Calls `visit` with i, j, G m_i m_j and `q_i - q_j` for every pair, in a fixed order.
    #[inline]
    fn for_pairs(&self, q: &[f64], mut visit: impl FnMut(usize, usize, f64, [f64; D])) {
        let q = &q.as_chunks::<D>().0[..self.masses.len()];
        for (i, (qi, mi)) in q.iter().zip(&self.masses).enumerate() {
            for (j, (qj, mj)) in q.iter().zip(&self.masses).enumerate().take(i) {
                let apart = array(|c| qi[c] - qj[c]);
                visit(i, j, self.constant * mi * mj, apart);
            }
        }
    }

    /// Calls `visit` with i, G m_i M_k and `q_i - X_k` for every particle and fixed mass, in a fixed order.
    #[inline]
    fn for_fixed(&self, q: &[f64], mut visit: impl FnMut(usize, f64, [f64; D])) {
        for (mk, xk) in &self.fixed {
            for (i, (qi, mi)) in q.as_chunks::<D>().0.iter().zip(&self.masses).enumerate() {
                visit(i, self.constant * mi * mk, array(|c| qi[c] - xk[c]));
            }
        }
    }
}

impl<const D: usize> Potential for NewtonianGravity<D> {
    fn dim(&self) -> usize {
        D * self.masses.len()
    }

    #[inline]
    fn energy(&self, q: &[f64]) -> f64 {
        let mut energy = 0.0;
        self.for_pairs(q, |_, _, strength, apart| energy -= strength / dot(&apart, &apart).sqrt());
        self.for_fixed(q, |_, strength, apart| energy -= strength / dot(&apart, &apart).sqrt());
        energy
    }

    #[inline]
    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let rows = &mut dv.0.as_chunks_mut::<D>().0[..self.masses.len()];
        self.for_pairs(q, |i, j, strength, apart| {
            let r2 = dot(&apart, &apart);
            let factor = strength / (r2 * r2.sqrt());
            for c in 0..D {
                let part = factor * apart[c];
                rows[i][c] += part;
                rows[j][c] -= part;
            }
        });
        self.for_fixed(q, |i, strength, apart| {
            let r2 = dot(&apart, &apart);
            let factor = strength / (r2 * r2.sqrt());
            rows[i].iter_mut().zip(&apart).for_each(|(row, x)| *row += factor * x);
        });
    }

    #[inline]
    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        self.for_pairs(q, |i, j, strength, apart| {
            let block = attraction_hessian(strength, &apart);
            let mut pair = [[[[0.0; D]; 2]; D]; 2];
            for (b, columns) in pair.iter_mut().enumerate() {
                for (column, entries) in columns.iter_mut().zip(&block) {
                    for (a, rows) in column.iter_mut().enumerate() {
                        *rows = entries.map(|entry| if a == b { entry } else { -entry });
                    }
                }
            }
            let freedoms = [i, j].map(|v| array::<_, D>(|c| D * v + c));
            let pair = pair.as_flattened().as_flattened().as_flattened();
            hessian.add_symmetric(freedoms.as_flattened(), pair);
        });
        self.for_fixed(q, |i, strength, apart| {
            let block = attraction_hessian(strength, &apart);
            hessian.add_symmetric(&array::<_, D>(|c| D * i + c), block.as_flattened());
        });
    }
}

/// The Hessian of `-k/|x|`: `k (I - 3 u u^T) / |x|^3` with `u = x/|x|`, by columns.
#[inline]
fn attraction_hessian<const D: usize>(k: f64, x: &[f64; D]) -> [[f64; D]; D] {
    let r2 = dot(x, x);
    let factor = k / (r2 * r2.sqrt());
    let three = 3.0 * factor / r2;
    let mut block = [[0.0; D]; D];
    for d in 0..D {
        for c in 0..D {
            block[d][c] = -three * x[c] * x[d];
        }
        block[d][d] += factor;
    }
    block
}

#[inline]
fn dot<const D: usize>(x: &[f64; D], y: &[f64; D]) -> f64 {
    let mut sum = 0.0;
    for c in 0..D {
        sum += x[c] * y[c];
    }
    sum
}

/// The first D numbers, which a configuration has by the time it reaches a potential.
#[inline]
fn leading<const D: usize>(q: &[f64]) -> &[f64; D] {
    &q.as_chunks::<D>().0[0]
}

#[cfg(test)]
mod tests {
    use stationary_calculus::assert_derivatives;

    use super::*;

    #[test]
    fn masses_that_are_free_and_that_stay_attract_by_their_energy() {
        let fixed = vec![(0.7, [1.0, 0.3]), (2.0, [-0.5, -1.0])];
        let gravity = NewtonianGravity::<2> { constant: 0.8, masses: vec![1.5, 0.4], fixed };
        assert_derivatives(&gravity, &[0.2, 0.1, -0.3, 0.9]);
        // 0.8 (1.5 0.4/d + 0.7 (1.5/a + 0.4/b) + 2 (1.5/c + 0.4/e))
        let q = [1.0, 1.3, 2.0, 0.3];
        let [d, a, b] = [2_f64.sqrt(), 1.0, 1.0];
        let [c, e] = [1.5_f64.hypot(2.3), 2.5_f64.hypot(1.3)];
        let energy = -0.8 * (0.6 / d + 0.7 * (1.5 / a + 0.4 / b) + 2.0 * (1.5 / c + 0.4 / e));
        assert!((gravity.energy(&q) - energy).abs() < 1e-14);
    }
}
