//! HIRES: eight reactions by which light steers a plant's growth (high irradiance response).
//!
//! ```text
//! y' = f(y),   8 concentrations;   y6 + y8 -> y7 at the rate 280 y6 y8, the rest linear
//! ```
//! Moderately stiff: rates from 0.04 to about 10 and the fast one. The state at t = 321.8122 is
//! that of the Test Set for IVP Solvers (Bari, release 2.4), confirmed to 10 digits by Radau IIA
//! and to 9 by BDF. Source: Schaefer, Photochemistry and Photobiology 21 (1975) 251; Hairer and
//! Wanner, Solving Ordinary Differential Equations II (1996), IV.10.

use super::StiffProblem;
use crate::{Jacobian, Moment, VectorField};

/// The right-hand side of HIRES.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HiresField;

/// The linear rates as (row, column, rate), rows and columns counted from 0.
const RATES: [(usize, usize, f64); 20] = [
    (0, 0, -1.71),
    (0, 1, 0.43),
    (0, 2, 8.32),
    (1, 0, 1.71),
    (1, 1, -8.75),
    (2, 2, -10.03),
    (2, 3, 0.43),
    (2, 4, 0.035),
    (3, 1, 8.32),
    (3, 2, 1.71),
    (3, 3, -1.12),
    (4, 4, -1.745),
    (4, 5, 0.43),
    (4, 6, 0.43),
    (5, 3, 0.69),
    (5, 4, 1.71),
    (5, 5, -0.43),
    (5, 6, 0.69),
    (6, 6, -1.81),
    (7, 6, 1.81),
];
/// The rate at which species 6 and 8 become species 7: (row, sign).
const BINDING: f64 = 280.0;
const BOUND: [(usize, f64); 3] = [(5, -1.0), (6, 1.0), (7, -1.0)];

impl VectorField for HiresField {
    fn dim(&self) -> usize {
        8
    }

    #[inline]
    fn evaluate(&self, _t: f64, y: &[f64], f: &mut [f64]) {
        f.fill(0.0);
        f[0] = 0.0007;
        for (row, column, rate) in RATES {
            f[row] += rate * y[column];
        }
        for (row, sign) in BOUND {
            f[row] += sign * BINDING * y[5] * y[7];
        }
    }

    fn jacobian(&self, _t: f64, y: &[f64], df: &mut [f64]) -> Jacobian {
        df.fill(0.0);
        for (row, column, rate) in RATES {
            df[row + 8 * column] += rate;
        }
        for (row, sign) in BOUND {
            df[row + 8 * 5] += sign * BINDING * y[7];
            df[row + 8 * 7] += sign * BINDING * y[5];
        }
        Jacobian::Written
    }
}

/// The response from darkness, over 321.8122 s.
pub fn hires() -> StiffProblem<HiresField, 8> {
    StiffProblem {
        name: "hires",
        field: HiresField,
        initial: Moment::new(0.0, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0057]),
        end: 321.8122,
        scale: [1e-3; 8],
        solution: Some([
            0.737_131_257_332_566_8e-3,
            0.144_248_572_631_618_5e-3,
            0.588_872_974_096_757_5e-4,
            0.117_565_134_328_314_9e-2,
            0.238_635_619_883_133_1e-2,
            0.623_896_825_274_279_6e-2,
            0.284_999_839_518_576_9e-2,
            0.285_000_160_481_423_1e-2,
        ]),
        solution_error: 1e-10,
    }
}
