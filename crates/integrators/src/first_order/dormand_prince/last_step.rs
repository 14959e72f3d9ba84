//! The last step of DOP853, as far as the polynomial within it needs that.
//!
//! ```text
//! y(t + x h) = y + x (d1 + (1-x) (d2 + x (d3 + (1-x) (d4 + x (d5 + (1-x) (d6 + x d7))))))
//! ```
//! `x` from 0 to 1, `d` seven combinations of sixteen stages (n each). Three of the stages are computed
//! when a moment within the step is first asked for. Source: Hairer, Norsett, Wanner, Solving Ordinary
//! Differential Equations I (1993), II.6.

use stationary_calculus::Storage;

use super::coefficients::*;
use super::combine;
use crate::VectorField;

/// The last step.
#[derive(Clone, Debug)]
pub(super) struct LastStep<C> {
    pub(super) begin: Option<f64>,
    pub(super) h: f64,
    pub(super) polynomial: Polynomial,
    /// Stages 1 to 13; once the polynomial is known, stages 2 to 4 hold 14 to 16.
    pub(super) k: [C; 13],
    pub(super) y: C,
    dense: [C; 7],
}

/// Whether the polynomial of the last step was computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Polynomial {
    Known,
    Unknown,
}

impl<C: Storage> LastStep<C> {
    /// No step yet, of states as large as this one.
    pub(super) fn new(zero: &C) -> Self {
        LastStep {
            begin: None,
            h: 0.0,
            polynomial: Polynomial::Unknown,
            k: std::array::from_fn(|_| zero.clone()),
            y: zero.clone(),
            dense: std::array::from_fn(|_| zero.clone()),
        }
    }

    /// Computes the polynomial of the step from `begin` to the state `next`, where it is not known,
    /// and returns how often f was evaluated.
    pub(super) fn complete(
        &mut self,
        field: &impl VectorField,
        begin: f64,
        next: &[f64],
        stage: &mut [f64],
    ) -> u64 {
        if self.polynomial == Polynomial::Known {
            return 0;
        }
        let LastStep { h, k, y, dense, .. } = self;
        let (h, y) = (*h, y.as_ref());
        macro_rules! stages {
            ($($s:literal into $place:literal $row:ident $at:expr;)+) => {$(
                combine(stage, y, h, &$row, k, $at);
                field.evaluate(begin + C[$s - 1] * h, stage, k[$place - 1].as_mut());
            )+};
        }
        stages! {
            14 into 2 A14 [1, 7, 8, 9, 10, 11, 12, 13];
            15 into 3 A15 [1, 6, 7, 8, 11, 12, 13, 2];
            16 into 4 A16 [1, 6, 7, 8, 9, 13, 2, 3];
        }
        for (i, (y, next)) in y.iter().zip(next).enumerate() {
            let step = next - y;
            let bend = h * k[0].as_ref()[i] - step;
            dense[0].as_mut()[i] = step;
            dense[1].as_mut()[i] = bend;
            dense[2].as_mut()[i] = step - h * k[12].as_ref()[i] - bend;
        }
        let at = [1, 6, 7, 8, 9, 10, 11, 12, 13, 2, 3, 4];
        for (dense, row) in dense[3..].iter_mut().zip([&D4, &D5, &D6, &D7]) {
            dense.as_mut().fill(0.0);
            for (d, s) in row.iter().zip(at) {
                for (dense, k) in dense.as_mut().iter_mut().zip(k[s - 1].as_ref()) {
                    *dense += h * d * k;
                }
            }
        }
        self.polynomial = Polynomial::Known;
        3
    }

    /// Writes the state at a part `x` of the step.
    pub(super) fn at(&self, x: f64, y: &mut [f64]) {
        let rest = 1.0 - x;
        let d = self.dense.each_ref().map(C::as_ref);
        for (i, (y, start)) in y.iter_mut().zip(self.y.as_ref()).enumerate() {
            let inner = d[4][i] + rest * (d[5][i] + x * d[6][i]);
            let middle = d[2][i] + rest * (d[3][i] + x * inner);
            *y = start + x * (d[0][i] + rest * (d[1][i] + x * middle));
        }
    }
}
