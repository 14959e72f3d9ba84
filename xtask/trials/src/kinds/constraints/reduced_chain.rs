//! A hung chain of points in its angles: the independent formulation.
//!
//! ```text
//! sum_j c_ij L_i L_j (cos(a_i - a_j) a_j'' + sin(a_i - a_j) a_j'^2) = -g L_i b_i sin a_i
//! c_ij = sum of the masses from max(i, j) on,   b_i = c_ii
//! ```
//! `a` angles from hanging, `L` lengths, `g` gravity downward; the classical Runge-Kutta method.

use nalgebra::{DMatrix, DVector};

/// A chain hung from the origin.
pub(super) struct Chain {
    pub(super) lengths: Vec<f64>,
    pub(super) masses: Vec<f64>,
    pub(super) gravity: f64,
}

impl Chain {
    fn carried(&self, i: usize, j: usize) -> f64 {
        self.masses[i.max(j)..].iter().sum()
    }

    /// Angles and their rates of points with velocities.
    pub(super) fn angles(&self, q: &[f64], v: &[f64]) -> (DVector<f64>, DVector<f64>) {
        let n = self.masses.len();
        let difference = |x: &[f64], k: usize, c: usize| {
            x[2 * k + c] - if k == 0 { 0.0 } else { x[2 * (k - 1) + c] }
        };
        let angle = |k: usize| difference(q, k, 0).atan2(-difference(q, k, 1));
        let rate = |k: usize| {
            let (sine, cosine) = angle(k).sin_cos();
            (difference(v, k, 0) * cosine + difference(v, k, 1) * sine) / self.lengths[k]
        };
        (DVector::from_fn(n, |k, _| angle(k)), DVector::from_fn(n, |k, _| rate(k)))
    }

    /// The points at angles.
    pub(super) fn places(&self, a: &DVector<f64>) -> Vec<f64> {
        let mut at = [0.0; 2];
        let mut places = Vec::new();
        for (angle, length) in a.iter().zip(&self.lengths) {
            at = [at[0] + length * angle.sin(), at[1] - length * angle.cos()];
            places.extend(at);
        }
        places
    }

    fn acceleration(&self, a: &DVector<f64>, w: &DVector<f64>) -> Option<DVector<f64>> {
        let n = a.len();
        let l = &self.lengths;
        let arm = |i: usize, j: usize| self.carried(i, j) * l[i] * l[j];
        let matrix = DMatrix::from_fn(n, n, |i, j| arm(i, j) * (a[i] - a[j]).cos());
        let right = DVector::from_fn(n, |i, _| {
            let turns = (0..n).map(|j| arm(i, j) * (a[i] - a[j]).sin() * w[j] * w[j]).sum::<f64>();
            -turns - self.gravity * l[i] * self.carried(i, i) * a[i].sin()
        });
        matrix.cholesky().map(|factor| factor.solve(&right))
    }

    /// Where the points are after `steps` steps of `h` seconds.
    pub(super) fn run(&self, q: &[f64], v: &[f64], h: f64, steps: usize) -> Option<Vec<f64>> {
        let (mut a, mut w) = self.angles(q, v);
        for _ in 0..steps {
            let k1 = (w.clone(), self.acceleration(&a, &w)?);
            let at = |k: &(DVector<f64>, DVector<f64>), s: f64| (&a + &k.0 * s, &w + &k.1 * s);
            let slope = |(a, w): (DVector<f64>, DVector<f64>)| {
                self.acceleration(&a, &w).map(|slope| (w, slope))
            };
            let k2 = slope(at(&k1, 0.5 * h))?;
            let k3 = slope(at(&k2, 0.5 * h))?;
            let k4 = slope(at(&k3, h))?;
            a += (k1.0 + (k2.0 + k3.0) * 2.0 + k4.0) * (h / 6.0);
            w += (k1.1 + (k2.1 + k3.1) * 2.0 + k4.1) * (h / 6.0);
        }
        Some(self.places(&a))
    }
}
