//! The past of a multistep method as backward differences on a grid of equal steps.
//!
//! ```text
//! d_0 = y_n,   d_m = D^m y_n,      y(t_n + x h) = sum_m d_m x (x + 1) ... (x + m - 1) / m!
//! ```
//! When the step or the order changes, the differences become those of the same polynomial on the
//! new grid: d' = (R(factor) U)^T d with two small triangular matrices.

use stationary_calculus::{SizeError, Storage, array};

use crate::integrator::zeros;

/// The highest order: the formula of order 6 is stable in a narrow sector only, that of order 7
/// nowhere.
pub(super) const HIGHEST: usize = 5;
const SIZE: usize = HIGHEST + 1;

/// 1 + 1/2 + ... + 1/k
pub(super) fn harmonic(k: usize) -> f64 {
    (1..=k).map(|m| 1.0 / m as f64).sum()
}

/// The differences at the last moment.
#[derive(Clone, Debug)]
pub(super) struct History<C> {
    /// The grid's step.
    pub(super) h: f64,
    /// The order of the polynomial that is carried on.
    pub(super) order: usize,
    /// Steps taken on this grid with this order.
    pub(super) equal_steps: u64,
    /// Differences 0 to order + 2; those above the order serve estimates of the error.
    pub(super) d: [C; HIGHEST + 3],
    pub(super) scratch: C,
}

impl<C: Storage> History<C> {
    pub(super) fn new(n: usize) -> Result<Self, SizeError> {
        let zero: C = zeros(n)?;
        let d = std::array::from_fn(|_| zero.clone());
        Ok(History { h: 1.0, order: 1, equal_steps: 0, d, scratch: zero })
    }

    /// The past of a straight line through `y` with the slope `f`.
    pub(super) fn restart(&mut self, y: &C, f: &C, h: f64) {
        (self.h, self.order, self.equal_steps) = (h, 1, 0);
        for d in &mut self.d {
            d.as_mut().fill(0.0);
        }
        self.d[0].clone_from(y);
        self.d[1].as_mut().iter_mut().zip(f.as_ref()).for_each(|(d, f)| *d = h * f);
    }

    /// Whether the grid and the order are these already.
    pub(super) fn keeps(&self, h: f64, order: usize) -> bool {
        h == self.h && order == self.order
    }

    /// Changes to a grid of steps `h` and to an order at most one higher.
    pub(super) fn regrid(&mut self, h: f64, order: usize) {
        if self.keeps(h, order) {
            return;
        }
        self.equal_steps = 0;
        self.order = order;
        if h == self.h {
            return;
        }
        let (r, u) = (change(h / self.h), change(1.0));
        self.h = h;
        let k = order;
        for i in 0..self.scratch.as_ref().len() {
            let old: [f64; SIZE] = array(|m| self.d[m].as_ref()[i]);
            let mut moved = [0.0; SIZE];
            for (column, moved) in moved.iter_mut().enumerate().take(k + 1) {
                *moved = (0..=k).map(|row| r[row][column] * old[row]).sum();
            }
            for (column, d) in self.d.iter_mut().enumerate().take(k + 1) {
                d.as_mut()[i] = (0..=k).map(|row| u[row][column] * moved[row]).sum();
            }
        }
    }

    /// Writes the polynomial at the next grid point, and psi = sum harmonic(m) d_m / harmonic(k).
    pub(super) fn predict(&self, y: &mut C, psi: &mut C) {
        let k = self.order;
        y.clone_from(&self.d[0]);
        psi.as_mut().fill(0.0);
        for (m, d) in self.d.iter().enumerate().take(k + 1).skip(1) {
            let weight = harmonic(m) / harmonic(k);
            let both = y.as_mut().iter_mut().zip(psi.as_mut()).zip(d.as_ref());
            both.for_each(|((y, psi), d)| {
                *y += d;
                *psi += weight * d;
            });
        }
    }

    /// Moves to the next grid point, whose state differs from the prediction by `by`.
    pub(super) fn accept(&mut self, by: &C) {
        let k = self.order;
        self.equal_steps += 1;
        let (low, high) = self.d.split_at_mut(k + 2);
        let sums = high[0].as_mut().iter_mut().zip(low[k + 1].as_ref()).zip(by.as_ref());
        sums.for_each(|((d, last), by)| *d = by - last);
        low[k + 1].clone_from(by);
        for m in (0..=k).rev() {
            let (low, high) = self.d.split_at_mut(m + 1);
            let sums = low[m].as_mut().iter_mut().zip(high[0].as_ref());
            sums.for_each(|(d, next)| *d += next);
        }
    }

    /// Writes the polynomial `x` seconds after the last moment.
    pub(super) fn interpolate(&self, x: f64, y: &mut [f64]) {
        y.copy_from_slice(self.d[0].as_ref());
        let mut weight = 1.0;
        for (m, d) in self.d.iter().enumerate().take(self.order + 1).skip(1) {
            weight *= (x / self.h + (m - 1) as f64) / m as f64;
            y.iter_mut().zip(d.as_ref()).for_each(|(y, d)| *y += weight * d);
        }
    }

    pub(super) fn visit(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        visit(&mut self.h);
        let (mut order, mut equal_steps) = (self.order as f64, self.equal_steps as f64);
        visit(&mut order);
        visit(&mut equal_steps);
        (self.order, self.equal_steps) = (order as usize, equal_steps as u64);
        for d in &mut self.d {
            d.as_mut().iter_mut().for_each(&mut *visit);
        }
    }
}

/// R_ij = prod_{l=1..i} (l - 1 - factor j) / l: the polynomials x (x+1) ... / i! at x = -factor j.
fn change(factor: f64) -> [[f64; SIZE]; SIZE] {
    let mut r = [[1.0; SIZE]; SIZE];
    for i in 1..SIZE {
        let above = r[i - 1];
        for (j, (entry, above)) in r[i].iter_mut().zip(above).enumerate() {
            *entry = above * (i as f64 - 1.0 - factor * j as f64) / i as f64;
        }
    }
    r
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The past of y(t) = 1 + t + ... + t^k at t = 0 on a grid of steps h.
    fn polynomial(k: usize, h: f64) -> History<[f64; 1]> {
        let mut history = History::new(1).unwrap();
        (history.h, history.order) = (h, k);
        let values: Vec<f64> = (0..=k).map(|j| value(k, -(j as f64) * h)).collect();
        for m in 0..=k {
            let mut row = values.clone();
            for _ in 0..m {
                row = row.windows(2).map(|pair| pair[0] - pair[1]).collect();
            }
            history.d[m] = [row[0]];
        }
        history
    }

    fn value(k: usize, t: f64) -> f64 {
        (0..=k).map(|m| t.powi(m as i32)).sum()
    }

    #[test]
    fn a_change_of_grid_changes_no_polynomial() {
        for k in 1..=HIGHEST {
            for factor in [0.2, 0.7, 1.9, 5.0] {
                // Rounding of the differences grows with the fifth power of the factor.
                let (mut history, mut y) = (polynomial(k, 0.1), [0.0]);
                history.regrid(0.1 * factor, k);
                let expected = polynomial(k, 0.1 * factor);
                for m in 0..=k {
                    let off = (history.d[m][0] - expected.d[m][0]).abs();
                    assert!(off < 1e-10, "order {k}, factor {factor}, difference {m}: {off:e}");
                }
                for t in [-0.08, 0.03] {
                    history.interpolate(t, &mut y);
                    assert!((y[0] - value(k, t)).abs() < 1e-10);
                }
            }
        }
    }

    #[test]
    fn each_formula_is_exact_for_polynomials_of_its_order_and_no_higher() {
        // sum 1/m D^m y' = h y'(t') on y' of degree k, as predict and accept have it: with the
        // exact next state, harmonic(k) (psi + d) = h f.
        let h = 0.1;
        for k in 1..=HIGHEST {
            for (degree, holds) in [(k, true), (k + 1, false)] {
                let mut history = polynomial(degree.min(HIGHEST), h);
                if degree > HIGHEST {
                    continue;
                }
                history.order = k;
                let (mut y, mut psi) = ([0.0], [0.0]);
                history.predict(&mut y, &mut psi);
                let d = value(degree, h) - y[0];
                let slope: f64 = (1..=degree).map(|m| m as f64 * h.powi(m as i32 - 1)).sum();
                let defect = (harmonic(k) * (psi[0] + d) - h * slope).abs();
                assert_eq!(defect < 1e-13, holds, "order {k}, degree {degree}: {defect:e}");
            }
        }
    }
}
