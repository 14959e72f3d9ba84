//! Area, centre and polar inertia of a polygon, by Stokes's theorem.
//!
//! ```text
//! A = 1/2 sum p x q          A c = 1/6 sum (p + q)(p x q)
//! J = 1/12 sum (p.p + p.q + q.q)(p x q)                        over edges from p to q
//! ```
//! `p q` corners (m) seen from the middle of the shape, `p x q` the number `px qy - py qx`; mass,
//! inertia follow with the density (kg/m^2). Loops may wind either way and come in any order: a
//! loop inside an odd number of others is a hole. Loops that cross themselves or each other are
//! refused, by a test of every pair of edges. Source: notes 7.1-7.3; errata chapter 7.

use nalgebra::Vector2;

use crate::error::check_finite;
use crate::mass_properties::check_density;
use crate::{PlanarMass, RigidError};

/// The mass properties of the shape between loops, each a list of corners.
pub fn polygon_mass(density: f64, loops: &[&[Vector2<f64>]]) -> Result<PlanarMass, RigidError> {
    check_density(density)?;
    for (outline, corners) in loops.iter().enumerate() {
        if corners.len() < 3 {
            return Err(RigidError::ShortLoop { outline, vertices: corners.len() });
        }
        for corner in *corners {
            check_finite("a corner", corner.as_slice())?;
        }
    }
    check_simple(loops)?;
    let middle = middle(loops);
    let (mut area, mut first, mut second) = (0.0, Vector2::zeros(), 0.0);
    for (k, corners) in loops.iter().enumerate() {
        let (signed, f, s) = moments(corners, &middle);
        let within = |other: &&&[Vector2<f64>]| contains(other, &corners[0]);
        let others = loops.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, other)| other);
        let solid = others.filter(within).count() % 2 == 0;
        // The signed area tells how the loop winds, its depth how it should.
        let sign = if (signed > 0.0) == solid { 1.0 } else { -1.0 };
        area += sign * signed;
        first += f * sign;
        second += sign * s;
    }
    if area.is_nan() || area <= 0.0 {
        return Err(RigidError::Empty("outline"));
    }
    let offset = first / area;
    let inertia = density * (second - area * offset.norm_squared());
    Ok(PlanarMass { mass: density * area, centre: middle + offset, inertia })
}

/// The middle of the corners' extent.
fn middle(loops: &[&[Vector2<f64>]]) -> Vector2<f64> {
    let corners = || loops.iter().copied().flatten();
    let low = corners().fold(Vector2::repeat(f64::INFINITY), |low, p| low.inf(p));
    let high = corners().fold(Vector2::repeat(f64::NEG_INFINITY), |high, p| high.sup(p));
    low + (high - low) * 0.5
}

/// Area, first moment and polar second moment of a loop, with the sign of its winding.
fn moments(corners: &[Vector2<f64>], middle: &Vector2<f64>) -> (f64, Vector2<f64>, f64) {
    let (mut area, mut first, mut second) = (0.0, Vector2::zeros(), 0.0);
    for (p, q) in edges(corners) {
        let (p, q) = (p - middle, q - middle);
        let cross = p.perp(&q);
        area += cross / 2.0;
        first += (p + q) * (cross / 6.0);
        second += (p.dot(&p) + p.dot(&q) + q.dot(&q)) * (cross / 12.0);
    }
    (area, first, second)
}

fn edges(corners: &[Vector2<f64>]) -> impl Iterator<Item = (&Vector2<f64>, &Vector2<f64>)> {
    corners.iter().zip(corners.iter().cycle().skip(1))
}

/// Whether a ray to the right of the point leaves the loop an odd number of times.
fn contains(corners: &[Vector2<f64>], point: &Vector2<f64>) -> bool {
    let crosses = |(p, q): &(&Vector2<f64>, &Vector2<f64>)| {
        let side = (*q - *p).perp(&(point - *p));
        (p.y > point.y) != (q.y > point.y) && (side > 0.0) == (q.y > p.y)
    };
    edges(corners).filter(crosses).count() % 2 == 1
}

/// An error that names two edges that cross.
fn check_simple(loops: &[&[Vector2<f64>]]) -> Result<(), RigidError> {
    let all: Vec<_> = loops.iter().flat_map(|corners| edges(corners)).collect();
    for (edge, a) in all.iter().enumerate() {
        for (other, b) in all.iter().enumerate().skip(edge + 1) {
            if cross(a, b) {
                return Err(RigidError::Crossing { edge, other });
            }
        }
    }
    Ok(())
}

type Edge<'a> = (&'a Vector2<f64>, &'a Vector2<f64>);

/// Whether two edges have a point inside both.
fn cross((a, b): &Edge<'_>, (c, d): &Edge<'_>) -> bool {
    let side = |p: &Vector2<f64>, q: &Vector2<f64>, x: &Vector2<f64>| (q - p).perp(&(x - p));
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LieGroup, PlanarMotion};

    fn corners(list: &[[f64; 2]]) -> Vec<Vector2<f64>> {
        list.iter().map(|&p| p.into()).collect()
    }

    fn rectangle(x: f64, y: f64, a: f64, b: f64) -> Vec<Vector2<f64>> {
        corners(&[[x, y], [x + a, y], [x + a, y + b], [x, y + b]])
    }

    #[test]
    fn a_rectangle_has_its_textbook_inertia_whichever_way_it_winds() {
        let mut shape = rectangle(1.0, 2.0, 3.0, 4.0);
        for _ in 0..2 {
            let got = polygon_mass(2.0, &[&shape]).unwrap();
            assert!((got.mass - 24.0).abs() < 1e-14);
            assert!((got.centre - Vector2::new(2.5, 4.0)).norm() < 1e-15);
            assert!((got.inertia - 24.0 * 25.0 / 12.0).abs() < 1e-13);
            assert!((got.about(&Vector2::new(1.0, 2.0)) - 24.0 * 25.0 / 3.0).abs() < 1e-12);
            shape.reverse();
        }
    }

    #[test]
    fn a_shape_that_is_not_convex_is_the_sum_of_its_triangles() {
        let l = corners(&[[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 4.0], [0.0, 4.0]]);
        let whole = polygon_mass(1.5, &[&l]).unwrap();
        let pieces = [rectangle(0.0, 0.0, 3.0, 1.0), rectangle(0.0, 1.0, 1.0, 3.0)];
        let pieces = pieces.map(|piece| polygon_mass(1.5, &[&piece]).unwrap());
        let sum = PlanarMass::composite(&pieces).unwrap();
        assert!((whole.mass - sum.mass).abs() < 1e-14);
        assert!((whole.centre - sum.centre).norm() < 1e-15);
        assert!((whole.inertia - sum.inertia).abs() < 1e-13);
    }

    #[test]
    fn a_hole_takes_away_and_an_island_in_it_adds_whichever_way_they_wind() {
        let outer = rectangle(0.0, 0.0, 6.0, 6.0);
        let hole = rectangle(1.0, 1.0, 3.0, 4.0);
        let island = rectangle(2.0, 2.0, 1.0, 1.0);
        let reversed: Vec<_> = hole.iter().rev().copied().collect();
        for hole in [&hole, &reversed] {
            let got = polygon_mass(1.0, &[&island, hole, &outer]).unwrap();
            assert!((got.mass - (36.0 - 12.0 + 1.0)).abs() < 1e-14);
            let origin = Vector2::zeros();
            let one = |shape: &[Vector2<f64>]| polygon_mass(1.0, &[shape]).unwrap().about(&origin);
            let expected = one(&outer) - one(hole) + one(&island);
            assert!((got.about(&origin) - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn far_from_the_origin_no_digit_is_lost() {
        let near = polygon_mass(1.0, &[&rectangle(0.0, 0.0, 1.0, 1.0)]).unwrap();
        let far = polygon_mass(1.0, &[&rectangle(1e6, -1e6, 1.0, 1.0)]).unwrap();
        assert!((far.inertia - near.inertia).abs() < 1e-15);
        let by = PlanarMotion::exp(nalgebra::Vector3::new(1e6, -1e6, 0.0));
        assert!((near.moved(&by).centre - far.centre).norm() < 1e-9);
    }

    #[test]
    fn what_encloses_nothing_or_crosses_itself_is_refused() {
        let bow = corners(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]);
        let error = polygon_mass(1.0, &[&bow]).unwrap_err();
        assert_eq!(error, RigidError::Crossing { edge: 0, other: 2 });
        let flat = corners(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]);
        assert_eq!(polygon_mass(1.0, &[&flat]), Err(RigidError::Empty("outline")));
        let two = corners(&[[0.0, 0.0], [1.0, 0.0]]);
        assert!(matches!(polygon_mass(1.0, &[&two]), Err(RigidError::ShortLoop { .. })));
        let nan = corners(&[[0.0, 0.0], [1.0, f64::NAN], [0.0, 1.0]]);
        assert!(matches!(polygon_mass(1.0, &[&nan]), Err(RigidError::NonFinite { .. })));
        let square = rectangle(0.0, 0.0, 1.0, 1.0);
        assert_eq!(polygon_mass(0.0, &[&square]), Err(RigidError::Density(0.0)));
        assert_eq!(polygon_mass(1.0, &[]), Err(RigidError::Empty("outline")));
    }
}
