//! Shapes of MJCF: where they are, how they touch, and what they weigh.

use std::f64::consts::PI;

use mjcf_rs::body::{Geom, GeomType};
use nalgebra::Vector3;
use stationary_rigid::{Body as Solid, LieGroup, RigidError, RigidMotion, Rotation};

use crate::ImportError;
use crate::robot::Outline;

/// A shape that scenes have.
pub(crate) fn outline(geom: &Geom) -> Option<Outline> {
    match geom.type_ {
        GeomType::Sphere => Some(Outline::Ball(geom.size[0])),
        GeomType::Box => Some(Outline::Box(sides(geom).map(|half| 2.0 * half))),
        GeomType::Cylinder => Some(Outline::Cylinder(long(geom))),
        GeomType::Capsule => Some(Outline::Capsule(long(geom))),
        GeomType::Ellipsoid => Some(Outline::Ellipsoid(sides(geom))),
        _ => None,
    }
}

/// A frame in its parent's.
pub(crate) fn motion(name: &str, pose: &mjcf_rs::Pose) -> Result<RigidMotion, ImportError> {
    let (t, r) = (pose.translation, pose.rotation);
    let length = (r.w * r.w + r.x * r.x + r.y * r.y + r.z * r.z).sqrt();
    let rotation = Rotation::from_quaternion([r.w, r.x, r.y, r.z].map(|part| part / length))
        .map_err(|_| ImportError::NonFinite { what: "the orientation", name: name.to_owned() })?;
    Ok(RigidMotion { translation: Vector3::new(t.x, t.y, t.z), rotation })
}

/// Its name, or that it has none.
pub(crate) fn named(geom: &Geom) -> &str {
    geom.name.as_deref().unwrap_or("without a name")
}

/// The frame of a shape in that of its body.
pub(crate) fn frame(geom: &Geom, name: &str) -> Result<RigidMotion, ImportError> {
    match geom.fromto {
        Some(ends) => Ok(between(&ends)),
        None => motion(name, &geom.pose),
    }
}

/// The frame whose z leads from the second end to the first, at their middle: a box has its sides by it.
fn between(&[a, b, c, d, e, f]: &[f64; 6]) -> RigidMotion {
    let (from, to) = (Vector3::new(a, b, c), Vector3::new(d, e, f));
    let along = from - to;
    let across = Vector3::z().cross(&along);
    let angle = across.norm().atan2(along.z);
    // Straight up or down, any axis across will do.
    let rotation = Rotation::about(across, angle)
        .unwrap_or_else(|_| Rotation::exp(Vector3::x() * if along.z < 0.0 { PI } else { 0.0 }));
    RigidMotion { translation: (from + to) * 0.5, rotation }
}

/// The length and the radius of a cylinder or a capsule.
fn long(geom: &Geom) -> [f64; 2] {
    let length = match geom.fromto {
        Some([a, b, c, d, e, f]) => Vector3::new(d - a, e - b, f - c).norm(),
        None => 2.0 * geom.size[1],
    };
    [length, geom.size[0]]
}

/// Half sides of a box, half axes of an ellipsoid: between two ends its section is square, or round.
fn sides(geom: &Geom) -> [f64; 3] {
    let r = geom.size[0];
    geom.fromto.map_or(geom.size, |_| [r, r, 0.5 * long(geom)[0]])
}

/// A solid shape in its own frame; none of a surface.
pub(crate) fn solid(geom: &Geom, density: f64) -> Option<Result<Solid, RigidError>> {
    let ([length, r], [a, b, c]) = (long(geom), sides(geom));
    let half = 0.5 * length;
    let mass = |volume: f64| geom.mass.unwrap_or(density * volume);
    let (tube, ball) = (2.0 * PI * r * r * half, 4.0 / 3.0 * PI * r.powi(3));
    Some(match geom.type_ {
        GeomType::Sphere => Solid::solid_ball(mass(ball), r),
        GeomType::Box => Solid::solid_box(mass(8.0 * a * b * c), [a, b, c]),
        GeomType::Ellipsoid => Solid::solid_ellipsoid(mass(4.0 / 3.0 * PI * a * b * c), [a, b, c]),
        GeomType::Cylinder => Solid::solid_cylinder(mass(tube), half, r),
        GeomType::Capsule => Solid::solid_capsule(mass(tube + ball), half, r),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mass of slices across z: a disc of radius r(z) each.
    fn slices(density: f64, reach: f64, radius: impl Fn(f64) -> f64) -> f64 {
        let n = 200_000;
        let dz = 2.0 * reach / f64::from(n);
        let at = |k: u32| -reach + dz * (f64::from(k) + 0.5);
        (0..n).map(|k| density * PI * radius(at(k)).powi(2) * dz).sum()
    }

    #[test]
    fn masses_of_shapes_are_those_of_their_slices() {
        let (r, half, density) = (0.3, 0.5, 700.0);
        let tube = |_: f64| r;
        let capsule = |z: f64| {
            let beyond = (z.abs() - half).max(0.0);
            (r * r - beyond * beyond).max(0.0).sqrt()
        };
        let round = |z: f64| r * (1.0 - (z / half).powi(2)).max(0.0).sqrt();
        let ball = |z: f64| (r * r - z * z).max(0.0).sqrt();
        for (type_, size, expected) in [
            (GeomType::Cylinder, [r, half, 0.0], slices(density, half, tube)),
            (GeomType::Capsule, [r, half, 0.0], slices(density, half + r, capsule)),
            (GeomType::Ellipsoid, [r, r, half], slices(density, half, round)),
            (GeomType::Sphere, [r, 0.0, 0.0], slices(density, r, ball)),
        ] {
            let geom = Geom { type_, size, ..Geom::default() };
            let mass = solid(&geom, density).unwrap().unwrap().mass();
            assert!((mass / expected - 1.0).abs() < 1e-8, "{type_:?}: {mass} {expected}");
        }
    }

    #[test]
    fn what_lies_between_two_points_has_its_axis_along_them() {
        for ends in [
            [1.0, 0.0, 0.0, 3.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0, 0.0, -1.0],
            [0.0, 0.0, -1.0, 0.0, 0.0, 1.0],
            [0.2, -0.3, 0.5, -0.7, 0.1, -0.9],
        ] {
            let [from, to] = [&ends[..3], &ends[3..]].map(Vector3::from_column_slice);
            let (frame, half) = (between(&ends), 0.5 * (to - from).norm());
            assert!((frame.apply(&(Vector3::z() * half)) - from).norm() < 1e-15, "{ends:?}");
            assert!((frame.apply(&(Vector3::z() * -half)) - to).norm() < 1e-15, "{ends:?}");
        }
    }
}
