//! The coefficients of the Radau IIA method of order 5, and the transformation that splits its
//! stages.
//!
//! ```text
//! T^-1 A^-1 T = [ GAMMA          ]
//!               [   ALPHA  -BETA ]
//!               [   BETA   ALPHA ]
//! ```
//! `A` the Runge-Kutta matrix (3 x 3) of collocation at `C`. Source: Hairer and Wanner, Solving
//! Ordinary Differential Equations II (1996), IV.8; checked below.

/// Where in the step the first two stages stand; the third stands at its end.
pub(super) const C1: f64 = 0.155_051_025_721_682_2;
pub(super) const C2: f64 = 0.644_948_974_278_317_8;

/// The real eigenvalue of A^-1.
pub(super) const GAMMA: f64 = 3.637_834_252_744_496;
/// The complex pair of eigenvalues, ALPHA +- i BETA.
pub(super) const ALPHA: f64 = 2.681_082_873_627_752_3;
pub(super) const BETA: f64 = 3.050_430_199_247_410_5;

/// The transformation, by rows.
pub(super) const T: [[f64; 3]; 3] = [
    [0.091_232_394_870_892_94, -0.141_255_295_020_954_2, -0.030_029_194_105_147_424],
    [0.241_717_932_707_107, 0.204_129_352_293_799_94, 0.382_942_112_757_261_9],
    [0.966_048_182_615_093, 1.0, 0.0],
];

/// Its inverse, by rows.
pub(super) const T_INVERSE: [[f64; 3]; 3] = [
    [4.325_579_890_063_155, 0.339_199_251_815_809_84, 0.541_770_539_935_874_9],
    [-4.178_718_591_551_905, -0.327_682_820_761_062_4, 0.476_623_554_500_550_44],
    [-0.502_872_634_945_786_9, 2.571_926_949_855_605, -0.596_039_204_828_224_9],
];

/// The weights of the stages in the error estimate, of order 3.
pub(super) const E: [f64; 3] = [-10.048_809_399_827_414, 1.382_142_733_160_749, -1.0 / 3.0];

#[cfg(test)]
mod tests {
    use super::*;

    fn product(a: [[f64; 3]; 3], b: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
        a.map(|row| std::array::from_fn(|j| (0..3).map(|k| row[k] * b[k][j]).sum()))
    }

    fn distance(a: [[f64; 3]; 3], b: [[f64; 3]; 3]) -> f64 {
        let pairs = a.as_flattened().iter().zip(b.as_flattened());
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    /// The Runge-Kutta matrix: integrals from 0 to c_i of the Lagrange polynomials at the nodes.
    fn runge_kutta_matrix() -> [[f64; 3]; 3] {
        let c = [C1, C2, 1.0];
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let (k, l) = ((j + 1) % 3, (j + 2) % 3);
                let x = c[i];
                let integral = x.powi(3) / 3.0 - 0.5 * (c[k] + c[l]) * x * x + c[k] * c[l] * x;
                integral / ((c[j] - c[k]) * (c[j] - c[l]))
            })
        })
    }

    #[test]
    fn the_nodes_are_those_of_radau() {
        // Zeros of the second derivative of x^2 (x - 1)^3: 10 x^2 - 8 x + 1, and 1.
        for c in [C1, C2] {
            assert!((10.0 * c * c - 8.0 * c + 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn the_transformation_splits_the_inverse_of_the_runge_kutta_matrix() {
        let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert!(distance(product(T, T_INVERSE), identity) < 1e-14);
        let blocks = [[GAMMA, 0.0, 0.0], [0.0, ALPHA, -BETA], [0.0, BETA, ALPHA]];
        let inverse = product(product(T, blocks), T_INVERSE);
        let found = distance(product(inverse, runge_kutta_matrix()), identity);
        assert!(found < 5e-14, "{found:e}");
    }

    #[test]
    fn the_error_estimate_sees_order_three_and_no_less() {
        // h f0 + e.z, with z_i = y(c_i h) - y0, vanishes for y = x, x^2, x^3 and no further.
        let c = [C1, C2, 1.0];
        let defect = |power: i32| {
            let derivative = if power == 1 { 1.0 } else { 0.0 };
            let sum: f64 = E.iter().zip(c).map(|(e, c)| e * c.powi(power)).sum();
            derivative + sum
        };
        for power in 1..=3 {
            assert!(defect(power).abs() < 1e-14, "{power}: {:e}", defect(power));
        }
        assert!(defect(4).abs() > 1e-3);
    }
}
