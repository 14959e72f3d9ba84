//! Points and weights that integrate polynomials over a simplex exactly.
//!
//! ```text
//! int_s f = |s| sum_i w_i f(l_i),  sum w_i = 1         l_i barycentric coordinates, w_i > 0
//! l_1 = u_1,  l_2 = (1 - u_1) u_2,  ...                u_k Gauss's points on [0, 1]
//! ```
//! The cube is collapsed onto the simplex, so n points a side are exact up to degree 2n - d,
//! where d is the dimension: not the fewest points there are, but of any degree, and all of them
//! inside. Source: Stroud, Approximate calculation of multiple integrals, 1971.

/// Gauss's points on [0, 1] with their weights, exact up to degree 2n - 1.
fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let half = |k: usize| {
        // Newton's method on the Legendre polynomial, from Tricomi's guess; six steps are plenty.
        let mut x = (std::f64::consts::PI * (k as f64 + 0.75) / (n as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..6 {
            let (mut before, mut value) = (1.0, x);
            for j in 2..=n {
                let j = j as f64;
                (before, value) = (value, ((2.0 * j - 1.0) * x * value - (j - 1.0) * before) / j);
            }
            slope = n as f64 * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        ((1.0 - x) / 2.0, 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..n).map(half).collect()
}

/// A rule exact for polynomials of this degree over simplices of K corners: barycentric coordinates
/// and weights that sum to one.
pub fn simplex_quadrature<const K: usize>(degree: usize) -> Vec<([f64; K], f64)> {
    const { assert!(2 <= K && K <= 4, "for segments, triangles and tetrahedra") };
    let line = gauss_legendre((degree + K).div_ceil(2).max(1));
    let mut points = vec![([0.0; K], 1.0, 1.0)];
    for corner in 0..K - 1 {
        // The rest shrinks with each coordinate; its powers are the volume that the collapse
        // leaves.
        let left = (K - 1 - corner) as f64;
        points = points
            .into_iter()
            .flat_map(|(l, rest, weight)| {
                line.iter().map(move |&(u, w)| {
                    let mut l: [f64; K] = l;
                    l[corner] = rest * u;
                    let shrunk: f64 = 1.0 - u;
                    (l, rest * shrunk, weight * w * left * shrunk.powf(left - 1.0))
                })
            })
            .collect();
    }
    let with_last = |(mut l, rest, weight): ([f64; K], f64, f64)| {
        l[K - 1] = rest;
        (l, weight)
    };
    points.into_iter().map(with_last).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean of `l^a` over a simplex: `n! prod a_i! / (n + sum a_i)!`.
    fn mean<const K: usize>(powers: [usize; K]) -> f64 {
        let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
        let product: f64 = powers.iter().map(|&a| factorial(a)).product();
        factorial(K - 1) * product / factorial(K - 1 + powers.iter().sum::<usize>())
    }

    fn rule<const K: usize>(degree: usize, powers: [usize; K]) -> f64 {
        let value = |l: [f64; K]| (0..K).map(|k| l[k].powi(powers[k] as i32)).product::<f64>();
        simplex_quadrature(degree).into_iter().map(|(l, w)| w * value(l)).sum()
    }

    #[test]
    fn every_monomial_up_to_the_degree_is_exact() {
        for degree in 0..=8 {
            for a in 0..=degree {
                let line = [a, degree - a];
                assert!((rule(degree, line) / mean(line) - 1.0).abs() < 1e-13, "{line:?}");
                for b in 0..=degree - a {
                    let flat = [a, b, degree - a - b];
                    assert!((rule(degree, flat) / mean(flat) - 1.0).abs() < 1e-13, "{flat:?}");
                    for c in 0..=degree - a - b {
                        let solid = [a, b, c, degree - a - b - c];
                        assert!((rule(degree, solid) / mean(solid) - 1.0).abs() < 1e-12);
                    }
                }
            }
        }
    }

    #[test]
    fn weights_are_positive_and_sum_to_one_and_points_are_inside() {
        let rule = simplex_quadrature::<4>(7);
        assert!(rule.iter().all(|(l, w)| *w > 0.0 && l.iter().all(|&l| 0.0 < l && l < 1.0)));
        assert!((rule.iter().map(|(_, w)| w).sum::<f64>() - 1.0).abs() < 1e-14);
    }

    #[test]
    fn a_rule_of_low_degree_misses_what_is_beyond_it() {
        let beyond = [9, 0, 0];
        assert!((rule(2, beyond) / mean(beyond) - 1.0).abs() > 0.01);
    }
}
