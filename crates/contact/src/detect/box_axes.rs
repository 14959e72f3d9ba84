//! The axes of two boxes: along which of them are they farthest apart?
//!
//! ```text
//! s(n) = |n.t| - sum_k a_k |n_k| - sum_k b_k |n.r_k|
//! n = e_i,   r_j,   e_i x r_j/|e_i x r_j|             faces of the first, of the second, edges
//! ```
//! `a b` half sizes (m), `t` the centre of the second and `r_j` its axes, in those of the first,
//! `e_i`. If two boxes are apart, one of the fifteen axes says so. The first of them that says more
//! than `margin` ends the search. Source: Gottschalk, Lin and Manocha 1996.

use parry3d_f64::math::Vector;

/// An axis and how far apart boxes are along it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axis {
    /// Less than zero where they overlap, m.
    pub(crate) separation: f64,
    /// From the first to the second, of length 1, axes of the first.
    pub(crate) normal: Vector,
    /// Whose face it is the normal of, the first's (0) or the second's (1).
    pub(crate) face: Option<usize>,
}

/// Separations this part of a box apart are the same, and the first axis is taken: that of a face.
const TIE: f64 = 1e-13;
/// Edges at a smaller sine to each other are parallel: faces have their axis.
const PARALLEL: f64 = 1e-15;

/// The axis along which boxes of these half sizes are farthest apart, the second with these axes and its centre at
/// `from`; none if by more than `margin`.
pub(crate) fn farthest(
    halves: [Vector; 2],
    axes: &[Vector; 3],
    from: Vector,
    margin: f64,
) -> Option<Axis> {
    let [a, b] = halves.map(|half| half.to_array());
    let (t, r) = (from.to_array(), axes.map(|axis| axis.to_array()));
    let dot = |x: &[f64; 3], y: &[f64; 3]| x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
    let size = r.map(|axis| axis.map(f64::abs));
    let mut best = (f64::NEG_INFINITY, 0.0, [0.0; 3], None);
    let tie = TIE * a[0].max(a[1]).max(a[2]).max(b[0]).max(b[1]).max(b[2]);
    let try_axis = |best: &mut (_, _, _, _), separation: f64, along: f64, axis: [f64; 3], face| {
        if separation > best.0 + tie {
            *best = (separation, along, axis, face);
        }
        separation <= margin
    };
    for i in 0..3 {
        let reach = a[i] + (b[0] * size[0][i] + b[1] * size[1][i] + b[2] * size[2][i]);
        let mut axis = [0.0; 3];
        axis[i] = 1.0;
        if !try_axis(&mut best, t[i].abs() - reach, t[i], axis, Some(0)) {
            return None;
        }
    }
    for j in 0..3 {
        let along = dot(&t, &r[j]);
        if !try_axis(&mut best, along.abs() - (b[j] + dot(&a, &size[j])), along, r[j], Some(1)) {
            return None;
        }
    }
    for i in 0..3 {
        let (k, l) = ((i + 1) % 3, (i + 2) % 3);
        for edge in &r {
            let square = edge[k] * edge[k] + edge[l] * edge[l];
            if square < PARALLEL * PARALLEL {
                continue;
            }
            // What is far less than the best, before it is known to all digits.
            let reach = |r: &[f64; 3]| (edge[k] * r[l] - edge[l] * r[k]).abs();
            let second = b[0] * reach(&r[0]) + b[1] * reach(&r[1]) + b[2] * reach(&r[2]);
            let first = a[k] * edge[l].abs() + a[l] * edge[k].abs();
            let most = reach(&t) - (first + second) + tie;
            if most < 0.0 && (best.0 >= 0.0 || most * most > best.0 * best.0 * square) {
                continue;
            }
            let sine = square.sqrt();
            let mut n = [0.0; 3];
            (n[k], n[l]) = (-edge[l] / sine, edge[k] / sine);
            // Not by the components of `edge` again: nearly parallel, they have lost their digits.
            let reach = |r: &[f64; 3]| (n[k] * r[k] + n[l] * r[l]).abs();
            let second = b[0] * reach(&r[0]) + b[1] * reach(&r[1]) + b[2] * reach(&r[2]);
            let along = n[k] * t[k] + n[l] * t[l];
            let first = a[k] * n[k].abs() + a[l] * n[l].abs();
            if !try_axis(&mut best, along.abs() - (first + second), along, n, None) {
                return None;
            }
        }
    }
    let (separation, along, [x, y, z], face) = best;
    let sign = if along < 0.0 { -1.0 } else { 1.0 };
    Some(Axis { separation, normal: Vector::new(x, y, z) * sign, face })
}

#[cfg(test)]
mod tests {
    use super::*;
    use parry3d_f64::math::Pose;
    use parry3d_f64::query::sat;
    use parry3d_f64::shape::Cuboid;
    use stationary_measure::SplitMix64;

    #[test]
    fn the_farthest_axis_is_that_of_the_geometry_library_and_its_separation_that_of_the_corners() {
        let mut random = SplitMix64::new(3);
        let (mut apart, mut by_edges) = (0, 0);
        for _ in 0..2_000 {
            let mut three = |scale: f64, shift: f64| {
                Vector::new(random.symmetric(), random.symmetric(), random.symmetric()) * scale
                    + Vector::splat(shift)
            };
            let halves = [three(0.4, 0.6), three(0.4, 0.6)];
            let pose = Pose::new(three(1.6, 0.0), three(2.0, 0.0));
            let axes = [Vector::X, Vector::Y, Vector::Z].map(|axis| pose.rotation * axis);
            let axis = farthest(halves, &axes, pose.translation, f64::INFINITY).unwrap();
            let corners = |half: Vector| {
                (0..8).map(move |k: u32| {
                    let sign = |bit: u32| if k & bit == 0 { 1.0 } else { -1.0 };
                    half * Vector::new(sign(1), sign(2), sign(4))
                })
            };
            let reaches = corners(halves[0]).map(|c| c.dot(axis.normal));
            let farthest_of_first = reaches.fold(f64::NEG_INFINITY, f64::max);
            let reaches = corners(halves[1]).map(|c| (pose * c).dot(axis.normal));
            let separation = reaches.fold(f64::INFINITY, f64::min) - farthest_of_first;
            assert!((axis.separation - separation).abs() < 1e-14);
            let [first, second] = halves.map(Cuboid::new);
            let (edges, _) =
                sat::cuboid_cuboid_find_local_separating_edge_twoway(&first, &second, &pose);
            let face = |first: &Cuboid, second: &Cuboid, pose: &Pose| {
                sat::cuboid_cuboid_find_local_separating_normal_oneway(first, second, pose).0
            };
            let faces = face(&first, &second, &pose).max(face(&second, &first, &pose.inverse()));
            apart += u32::from(axis.separation > 0.0);
            if axis.separation < 0.0 {
                assert!((axis.separation - edges.max(faces)).abs() < 2e-13);
                by_edges += u32::from(edges > faces);
            }
        }
        assert!(apart > 200 && by_edges > 100, "{apart} {by_edges}");
    }
}
