//! The convex hull of points in space.
//!
//! ```text
//! n.(x - a) > 1e-13 size        a point that a triangle sees, and that takes its place
//! ```
//! Triangles counterclockwise as seen from outside. A point that is within rounding of the hull so far
//! belongs to it; every other one replaces the triangles that see it by those to their rim. Source:
//! the beneath-beyond method, Preparata and Shamos, Computational Geometry (1985), section 3.4.

use std::collections::BTreeSet;

use nalgebra::Vector3;

type V = Vector3<f64>;

/// A distance relative to the size below which a point is on a plane.
const ON: f64 = 1e-13;

/// Triangles of the convex hull of points (m), by their numbers, counterclockwise from outside.
///
/// `None` where the points are flat or not finite, or where rounding leaves no closed surface. The work
/// grows with the points times the triangles.
pub fn convex_hull(points: &[V]) -> Option<Vec<[usize; 3]>> {
    if points.iter().any(|p| !p.iter().all(|x| x.is_finite())) {
        return None;
    }
    let far = |off: &dyn Fn(&V) -> f64| {
        (0..points.len()).max_by(|&i, &j| off(&points[i]).total_cmp(&off(&points[j])))
    };
    let first = far(&|p| p.x)?;
    let a = points[first];
    let second = far(&|p| (p - a).norm())?;
    let b = points[second];
    let size = (b - a).norm();
    let third = far(&|p| (b - a).cross(&(p - a)).norm())?;
    let normal = (b - a).cross(&(points[third] - a)).try_normalize(0.0)?;
    let fourth = far(&|p| normal.dot(&(p - a)).abs())?;
    let up = normal.dot(&(points[fourth] - a));
    if up.is_nan() || up.abs() <= ON * size {
        return None;
    }
    let [i, j, k, l] =
        if up < 0.0 { [first, second, third, fourth] } else { [first, third, second, fourth] };
    let mut triangles = vec![[i, j, k], [i, l, j], [j, l, k], [k, l, i]];
    let mut order: Vec<usize> = (0..points.len()).collect();
    let middle = [i, j, k, l].iter().map(|&k| points[k]).sum::<V>() / 4.0;
    // The farthest first: what comes later is mostly inside.
    order.sort_by(|&s, &t| {
        let off = |k: usize| (points[k] - middle).norm();
        off(t).total_cmp(&off(s)).then(s.cmp(&t))
    });
    for p in order {
        let above = |[a, b, c]: &[usize; 3]| {
            let (u, v) = (points[*b] - points[*a], points[*c] - points[*a]);
            let n = (u / size).cross(&(v / size));
            let length = n.norm();
            // A sliver has no plane that could be trusted.
            length > 0.0 && n.dot(&(points[p] - points[*a])) > ON * size * length
        };
        let (seen, kept): (Vec<_>, Vec<_>) = triangles.iter().partition(|t| above(t));
        if seen.is_empty() {
            continue;
        }
        let sides = |[a, b, c]: [usize; 3]| [[a, b], [b, c], [c, a]];
        let all: BTreeSet<[usize; 2]> = seen.iter().flat_map(|t| sides(*t)).collect();
        triangles = kept;
        let rim = all.iter().filter(|[a, b]| !all.contains(&[*b, *a]));
        triangles.extend(rim.map(|&[a, b]| [a, b, p]));
    }
    closes(&triangles).then_some(triangles)
}

/// Whether each side of a triangle is another one's, turned round.
fn closes(triangles: &[[usize; 3]]) -> bool {
    let sides = || triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let all: BTreeSet<[usize; 2]> = sides().collect();
    all.len() == 3 * triangles.len() && sides().all(|[a, b]| all.contains(&[b, a]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use stationary_measure::SplitMix64;

    #[test]
    fn no_point_is_outside_of_a_hull_however_thin_it_is() {
        let mut random = SplitMix64::new(8);
        for k in 0..400 {
            let thin = [1.0, 1e-2, 1e-4, 1e-6][k % 4];
            let size = [1e-6, 1.0, 1e6][k % 3];
            let count = 4 + k % 40;
            let points: Vec<V> = (0..count)
                .map(|_| {
                    V::new(random.symmetric(), random.symmetric(), thin * random.symmetric()) * size
                })
                .collect();
            let triangles = convex_hull(&points).unwrap();
            let mut outermost = 0.0_f64;
            for [a, b, c] in triangles {
                let n = (points[b] - points[a]).cross(&(points[c] - points[a])).normalize();
                let off = points.iter().map(|p| n.dot(&(p - points[a])));
                outermost = outermost.max(off.fold(0.0, f64::max));
            }
            assert!(outermost < 1e-11 * size, "{outermost:e} of {size:e}, thin {thin:e}");
        }
    }

    #[test]
    fn points_in_a_plane_have_no_hull() {
        let points: Vec<V> =
            (0..9).map(|k| V::new(f64::from(k % 3), f64::from(k / 3), 0.0)).collect();
        assert!(convex_hull(&points).is_none());
        assert!(convex_hull(&points[..1]).is_none() && convex_hull(&[]).is_none());
        let infinite = [V::zeros(), V::x(), V::y(), V::z() * f64::INFINITY];
        assert!(convex_hull(&infinite).is_none());
    }
}
