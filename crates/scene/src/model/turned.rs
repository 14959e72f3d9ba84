//! Vectors turned by a quaternion of length one, scalar first.

use stationary_calculus::array;

/// `x + 2 r x (r x x + w x)`, r the quaternion's vector part.
pub(crate) fn turn([w, i, j, k]: [f64; 4], x: [f64; 3]) -> [f64; 3] {
    let r = [i, j, k];
    let inner = cross(r, x);
    let outer = cross(r, array(|c| inner[c] + w * x[c]));
    array(|c| x[c] + 2.0 * outer[c])
}

/// The same turn backward.
pub(crate) fn turn_back([w, i, j, k]: [f64; 4], x: [f64; 3]) -> [f64; 3] {
    turn([w, -i, -j, -k], x)
}

/// The cross product.
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_turn_about_the_third_axis_takes_the_first_axis_to_the_second() {
        let half = 0.5_f64.sqrt();
        let quarter = [half, 0.0, 0.0, half];
        let near = |x: [f64; 3], y: [f64; 3]| x.iter().zip(y).all(|(x, y)| (x - y).abs() < 1e-15);
        assert!(near(turn(quarter, [1.0, 0.0, 0.0]), [0.0, 1.0, 0.0]));
        assert!(near(turn_back(quarter, [0.0, 1.0, 0.0]), [1.0, 0.0, 0.0]));
    }
}
