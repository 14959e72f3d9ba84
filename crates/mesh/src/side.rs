//! On which side of a line, or of a plane, does a point lie? Signs that can be trusted.
//!
//! ```text
//! plane: sign of |b - a, c - a|, exact      space: sign of |a - d, b - d, c - d|, or "too close"
//! ```
//! In the plane the determinant is expanded into products, each split without error into two
//! numbers (`x y = p + e` by a fused multiply-add), and the twelve are summed without error; a
//! first look with an error bound settles most cases. In space there is the first look only.
//! Exact while no product leaves the range of f64: coordinates up to 1e50, and zero or above
//! 1e-140 in size. Source: Shewchuk, Adaptive precision floating-point arithmetic, 1997 (the
//! bounds and the sums).

use std::cmp::Ordering;

use nalgebra::{Vector2, Vector3};

/// Half the distance from 1 to the next number.
const HALF_ULP: f64 = f64::EPSILON / 2.0;
const BOUND_2: f64 = (3.0 + 16.0 * HALF_ULP) * HALF_ULP;
const BOUND_3: f64 = (7.0 + 56.0 * HALF_ULP) * HALF_ULP;

/// `Greater` if `c` lies to the left of the line from `a` to `b`, `Equal` if on it.
pub(crate) fn side_of_line(a: &Vector2<f64>, b: &Vector2<f64>, c: &Vector2<f64>) -> Ordering {
    let (left, right) = ((a.x - c.x) * (b.y - c.y), (a.y - c.y) * (b.x - c.x));
    let determinant = left - right;
    if determinant.abs() > BOUND_2 * (left.abs() + right.abs()) {
        return determinant.total_cmp(&0.0);
    }
    let products = [(a.x, b.y), (-a.y, b.x), (b.x, c.y), (-b.y, c.x), (c.x, a.y), (-c.y, a.x)];
    sign_of_sum(&products.map(|(x, y)| (x * y, x.mul_add(y, -(x * y)))))
}

/// The sign of a sum of pairs, found without rounding.
fn sign_of_sum(pairs: &[(f64, f64); 6]) -> Ordering {
    // Components that do not overlap, from small to large: the last one that is not zero decides.
    let mut components: Vec<f64> = Vec::with_capacity(12);
    for mut term in pairs.iter().flat_map(|&(product, error)| [error, product]) {
        for component in &mut components {
            let sum = term + *component;
            let part = sum - term;
            *component = (term - (sum - part)) + (*component - part);
            term = sum;
        }
        components.push(term);
    }
    let largest = components.iter().rev().find(|component| **component != 0.0);
    largest.map_or(Ordering::Equal, |component| component.total_cmp(&0.0))
}

/// The side of the plane through `a`, `b`, `c` on which `d` lies: `Greater` where it sees them
/// counterclockwise, `Equal` where rounding could have decided.
pub(crate) fn side_of_plane(
    a: &Vector3<f64>,
    b: &Vector3<f64>,
    c: &Vector3<f64>,
    d: &Vector3<f64>,
) -> Ordering {
    let (a, b, c) = (a - d, b - d, c - d);
    let minor = |p: &Vector3<f64>, q: &Vector3<f64>| (p.x * q.y, p.y * q.x);
    let terms = [(c.z, minor(&a, &b)), (a.z, minor(&b, &c)), (b.z, minor(&c, &a))];
    let determinant: f64 = terms.iter().map(|(z, (p, q))| z * (p - q)).sum();
    let size: f64 = terms.iter().map(|(z, (p, q))| z.abs() * (p.abs() + q.abs())).sum();
    if determinant.abs() > BOUND_3 * size {
        0.0_f64.total_cmp(&determinant)
    } else {
        Ordering::Equal
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Vector2, Vector3};
    use proptest::prelude::*;

    #[test]
    fn the_last_bit_of_a_coordinate_decides_in_the_plane() {
        let (a, b) = (Vector2::new(0.1, 0.1), Vector2::new(24.3, 24.3));
        for k in 0..200 {
            let on = 0.1 + 0.1 * f64::from(k);
            assert_eq!(side_of_line(&a, &b, &Vector2::new(on, on)), Ordering::Equal);
            assert_eq!(side_of_line(&a, &b, &Vector2::new(on, on.next_up())), Ordering::Greater);
            assert_eq!(side_of_line(&a, &b, &Vector2::new(on.next_up(), on)), Ordering::Less);
        }
    }

    #[test]
    fn the_plain_determinant_gets_some_of_these_wrong() {
        let (a, b) = (Vector2::new(0.1, 0.1), Vector2::new(24.3, 24.3));
        let plain = |c: Vector2<f64>| (a.x - c.x) * (b.y - c.y) - (a.y - c.y) * (b.x - c.x);
        let wrong = |k: &i32| {
            let on = 0.1 + 0.1 * f64::from(*k);
            plain(Vector2::new(on, on.next_up())) <= 0.0
        };
        assert!((0..200).filter(wrong).count() > 0);
    }

    #[test]
    fn a_point_above_a_counterclockwise_triangle_is_seen_as_such() {
        let [a, b, c] = [Vector3::zeros(), Vector3::x(), Vector3::y()];
        assert_eq!(side_of_plane(&a, &b, &c, &Vector3::new(0.2, 0.2, 1e-300)), Ordering::Greater);
        assert_eq!(side_of_plane(&a, &b, &c, &Vector3::new(0.2, 0.2, -1.0)), Ordering::Less);
        assert_eq!(side_of_plane(&a, &b, &c, &Vector3::new(0.2, 0.2, 0.0)), Ordering::Equal);
    }

    proptest! {
        #[test]
        fn integers_agree_with_whole_number_arithmetic(
            n in proptest::array::uniform6(-(1_i64 << 52)..(1 << 52)),
        ) {
            let [a, b, c] = [0, 2, 4].map(|k| Vector2::new(n[k] as f64, n[k + 1] as f64));
            let n = n.map(i128::from);
            let exact = (n[2] - n[0]) * (n[5] - n[1]) - (n[3] - n[1]) * (n[4] - n[0]);
            prop_assert_eq!(side_of_line(&a, &b, &c), exact.cmp(&0));
            // A collinear triple of the same size: the midpoint of even ends.
            let (p, q) = (a * 2.0 - b * 2.0, b * 2.0 - a * 2.0);
            prop_assert_eq!(side_of_line(&p, &q, &((p + q) / 2.0)), Ordering::Equal);
        }
    }
}
