//! The convex hull of points in space.
//!
//! ```text
//! n.(x - a) > 1e-13 size        a point that is outside of a triangle, and belongs to the hull
//! n.(x - a) > 0                 a triangle that it sees, and takes the place of: decided exactly
//! ```
//! Triangles counterclockwise as seen from outside. A point that is within rounding of the hull so far
//! belongs to it; every other one replaces the triangles that see it by those to their rim. Places are
//! rounded to a grid of 2^-50 of the size, on which signs of volumes are exact: what a point sees is one
//! disc then, however close to one plane the points are. Source: the beneath-beyond method, Preparata and
//! Shamos, Computational Geometry (1985), section 3.4.

use std::collections::BTreeSet;

use nalgebra::Vector3;

type V = Vector3<f64>;

/// A distance relative to the size below which a point is on a plane.
const ON: f64 = 1e-13;

/// Places on the grid are this power of two from the first at most: their differences are whole numbers.
const REACH: i32 = 51;

/// A volume that is this small against the product of its edges is computed in whole numbers.
const UNSURE: f64 = 1e-14;

/// Triangles of the convex hull of points (m), by their numbers, counterclockwise from outside: a closed
/// convex surface that contains all points to 1e-13 of their size.
///
/// `None` where the points are flat or not finite. The work grows with the points times the triangles.
pub fn convex_hull(points: &[V]) -> Option<Vec<[usize; 3]>> {
    let points = on_grid(points)?;
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
    // Again until no point is outside: a triangle that comes late may pass below one that was inside before.
    let mut grew = true;
    while grew {
        grew = false;
        for &p in &order {
            grew |= add(&points, &mut triangles, p, ON * size);
        }
    }
    is_sphere(&triangles).then_some(triangles)
}

/// The points relative to the first in whole numbers, the farthest at the grid's reach; none where they
/// are not finite, or all in one place.
fn on_grid(points: &[V]) -> Option<Vec<V>> {
    if points.iter().any(|p| !p.iter().all(|x| x.is_finite())) {
        return None;
    }
    let points = brought_to(0, points.to_vec())?;
    let first = points[0];
    let beside = brought_to(REACH, points.iter().map(|p| p - first).collect())?;
    Some(beside.into_iter().map(|p| p.map(f64::round)).collect())
}

/// The points times a power of two, so that the largest coordinate is below this one; none where all are
/// zero.
fn brought_to(power: i32, mut points: Vec<V>) -> Option<Vec<V>> {
    let most = points.iter().map(|p| p.amax()).fold(0.0, f64::max);
    if most == 0.0 {
        return None;
    }
    let power = power - 1 - most.log2().floor() as i32;
    // By halves: the power itself may be out of range.
    for half in [power / 2, power - power / 2] {
        points.iter_mut().for_each(|p| *p *= 2.0_f64.powi(half));
    }
    Some(points)
}

/// Puts a point on the hull that is farther outside of a triangle than `on`; whether it was.
fn add(points: &[V], triangles: &mut Vec<[usize; 3]>, p: usize, on: f64) -> bool {
    let off = |[a, b, c]: &[usize; 3]| {
        let [u, v, w] = [b, c, &p].map(|&k| points[k] - points[*a]);
        (volume(&u, &v, &w), u.cross(&v).norm_squared())
    };
    let offs: Vec<(f64, f64)> = triangles.iter().map(off).collect();
    let is_out =
        |&(volume, square): &(f64, f64)| volume > 0.0 && volume * volume > on * on * square;
    if !offs.iter().any(is_out) {
        return false;
    }
    let sides = |[a, b, c]: [usize; 3]| [[a, b], [b, c], [c, a]];
    let seen = triangles.iter().zip(&offs).filter(|(_, (volume, _))| *volume > 0.0);
    let all: BTreeSet<[usize; 2]> = seen.flat_map(|(t, _)| sides(*t)).collect();
    let mut of = offs.iter();
    triangles.retain(|_| of.next().is_some_and(|(volume, _)| *volume <= 0.0));
    let rim = all.iter().filter(|[a, b]| !all.contains(&[*b, *a]));
    triangles.extend(rim.map(|&[a, b]| [a, b, p]));
    true
}

/// The volume that three vectors of whole numbers span; its sign is exact.
fn volume(u: &V, v: &V, w: &V) -> f64 {
    let volume = u.cross(v).dot(w);
    let edges = u.norm_squared() * v.norm_squared() * w.norm_squared();
    if volume * volume > UNSURE * UNSURE * edges {
        return volume;
    }
    let [u, v, w] = [u, v, w].map(|x| [x.x, x.y, x.z].map(|x| x as i128));
    // Products of two have 107 binary digits; those of three are put together from halves.
    let normal = [[1, 2], [2, 0], [0, 1]].map(|[b, c]| u[b] * v[c] - u[c] * v[b]);
    let half = u64::MAX as i128;
    let low: i128 = normal.iter().zip(w).map(|(n, w)| (n & half) * w).sum();
    let high: i128 = normal.iter().zip(w).map(|(n, w)| (n >> 64) * w).sum::<i128>() + (low >> 64);
    if high.abs() < 1 << 62 {
        ((high << 64) + (low & half)) as f64
    } else {
        high as f64 * 2.0_f64.powi(64)
    }
}

/// Whether each side of a triangle is another one's, turned round, and there are as many corners as a
/// sphere has: V - E + F = 2.
fn is_sphere(triangles: &[[usize; 3]]) -> bool {
    let sides = || triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let all: BTreeSet<[usize; 2]> = sides().collect();
    let corners: BTreeSet<usize> = triangles.iter().flatten().copied().collect();
    let closes = all.len() == 3 * triangles.len() && sides().all(|[a, b]| all.contains(&[b, a]));
    closes && 2 * corners.len() == 4 + triangles.len()
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

    /// How far a point is outside of a hull at most, and the hull's area.
    fn outermost(points: &[V], triangles: &[[usize; 3]]) -> (f64, f64) {
        let (mut outermost, mut area) = (0.0_f64, 0.0);
        for [a, b, c] in triangles {
            let n = (points[*b] - points[*a]).cross(&(points[*c] - points[*a]));
            area += 0.5 * n.norm();
            let off = points.iter().map(|p| n.normalize().dot(&(p - points[*a])));
            // A sliver's own plane is known to rounding over its height only.
            if n.norm() > 1e-6 {
                outermost = outermost.max(off.fold(0.0, f64::max));
            }
        }
        (outermost, area)
    }

    #[test]
    fn points_that_are_coplanar_but_for_rounding_make_no_surface_that_folds() {
        let points = [
            [1.0000000000096, -8.956691006277348e-12, 2.000000000004776],
            [1.9999999999994753, -2.5905705595583626e-12, 2.000000000005321],
            [1.0000000000010079, 1.0000000000016809, 1.9999999999944778],
            [-4.600444393964795e-12, 2.1493079967314244e-12, 2.00000000000385],
            [8.984147238563046e-12, 1.9999999999965539, 2.000000000000501],
            [1.9999999999985982, 2.000000000008094, 1.0000000000049805],
        ]
        .map(V::from);
        let (out, area) = outermost(&points, &convex_hull(&points).unwrap());
        // A square's half and what is between it and the point below.
        assert!(out < 1e-11 && (area - 8.92).abs() < 0.01, "{out:e} {area}");
    }

    #[test]
    fn lattices_with_noise_of_any_size_have_the_hull_of_their_corners() {
        let mut random = SplitMix64::new(4);
        let lattice =
            || (0..27).map(|k| V::new((k % 3) as f64, (k / 3 % 3) as f64, (k / 9) as f64));
        for noise in [0.0, 1e-16, 1e-15, 1e-14, 1e-13, 3e-13, 1e-12, 1e-11] {
            for trial in 0..200 {
                let mut noisy = |x: V| x.map(|x| x + noise * random.symmetric());
                let points: Vec<V> = lattice().map(&mut noisy).collect();
                let (out, area) = outermost(&points, &convex_hull(&points).unwrap());
                assert!(
                    out < 1e-11 && (area - 24.0).abs() < 1e-9,
                    "{noise} {trial} {out:e} {area}"
                );
                // Some of them only: nothing is known of the area, but all are inside.
                let some: Vec<V> =
                    points.iter().copied().filter(|_| random.symmetric() > 0.4).collect();
                if let Some(triangles) = convex_hull(&some) {
                    assert!(outermost(&some, &triangles).0 < 1e-10, "{noise} {trial}");
                }
            }
        }
    }

    #[test]
    fn a_hull_does_not_depend_on_the_unit_of_length() {
        let mut random = SplitMix64::new(5);
        let points: Vec<V> =
            (0..30).map(|_| V::from_fn(|_, _| random.symmetric())).chain([V::zeros()]).collect();
        let there = convex_hull(&points).unwrap();
        for power in [-1060, -332, -1, 266, 1000] {
            let [half, rest] = [power / 2, power - power / 2].map(|power| 2.0_f64.powi(power));
            let scaled: Vec<V> = points.iter().map(|p| p * half * rest).collect();
            let here = convex_hull(&scaled).unwrap();
            // Among the least numbers places have few digits.
            assert!(here == there || power == -1060, "2^{power}");
        }
    }

    #[test]
    fn signs_of_volumes_are_those_of_whole_numbers() {
        let far = 2.0_f64.powi(52);
        let [u, v] = [V::new(far, far - 1.0, 1.0), V::new(far - 1.0, far - 2.0, 1.0)];
        // u x v = (1, -1, -1)
        for (w, exact) in
            [([0.0, 0.0, 0.0], 0.0), ([far, far - 1.0, 1.0], 0.0), ([far, far - 1.0, 2.0], -1.0)]
        {
            assert_eq!(volume(&u, &v, &V::from(w)), exact);
        }
        assert_eq!(volume(&V::x(), &(V::y() * far), &(V::z() * -far)), -far * far);
    }
}
