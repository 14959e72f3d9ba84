//! Solid bodies that are round: mass and principal moments in closed form.
//!
//! ```text
//! ball        2/5 m r^2
//! ellipsoid   m/5 (b^2 + c^2) about the first axis, and so on
//! cylinder    m r^2/2 about its axis,      m (r^2/4 + a^2/3) across
//! cone        3/10 m r^2 about its axis,   3/80 m (4 r^2 + l^2) across
//! capsule     m_c r^2/2 + 2/5 m_s r^2,     m_c (r^2/4 + a^2/3) + m_s (2/5 r^2 + a^2 + 3/4 a r)
//! ```
//! Of constant density and about their centres of mass; the axis is z. `r` radius, `a` half length,
//! `l` height (m); `m_c` and `m_s` the masses of a capsule's cylinder and of its two ends, which are as
//! `2 a` to `4/3 r`. Source: Landau and Lifshitz, Mechanics, section 32, problem 2.

use crate::{Body, RigidError};

fn check(what: &'static str, value: f64) -> Result<(), RigidError> {
    if value > 0.0 && value.is_finite() { Ok(()) } else { Err(RigidError::Length { what, value }) }
}

impl Body {
    /// A solid ball of this radius (m).
    ///
    /// # Errors
    /// A mass or a radius that is not positive and finite.
    pub fn solid_ball(mass: f64, radius: f64) -> Result<Self, RigidError> {
        check("radius of a ball", radius)?;
        Body::solid_ellipsoid(mass, [radius; 3])
    }

    /// A solid ellipsoid of these half axes (m).
    ///
    /// # Errors
    /// A mass or a half axis that is not positive and finite.
    pub fn solid_ellipsoid(mass: f64, half_axes: [f64; 3]) -> Result<Self, RigidError> {
        half_axes.into_iter().try_for_each(|half| check("half axis of an ellipsoid", half))?;
        let [x, y, z] = half_axes.map(|a| a * a);
        Body::new(mass, [y + z, z + x, x + y].map(|sum| mass * sum / 5.0))
    }

    /// A solid cylinder about z of this half length and radius (m).
    ///
    /// # Errors
    /// A mass, a half length or a radius that is not positive and finite.
    pub fn solid_cylinder(mass: f64, half_length: f64, radius: f64) -> Result<Self, RigidError> {
        check("radius of a cylinder", radius)?;
        check("half length of a cylinder", half_length)?;
        let across = mass * (radius * radius / 4.0 + half_length * half_length / 3.0);
        Body::new(mass, [across, across, 0.5 * mass * radius * radius])
    }

    /// A solid cone about z of this height and radius of its base (m).
    ///
    /// # Errors
    /// A mass, a height or a radius that is not positive and finite.
    pub fn solid_cone(mass: f64, height: f64, radius: f64) -> Result<Self, RigidError> {
        check("radius of a cone", radius)?;
        check("height of a cone", height)?;
        let square = radius * radius;
        let across = mass * (4.0 * square + height * height) * 3.0 / 80.0;
        Body::new(mass, [across, across, 0.3 * mass * square])
    }

    /// A solid capsule about z: all points within a radius of a segment of this half length (m).
    ///
    /// # Errors
    /// A mass, a half length or a radius that is not positive and finite.
    pub fn solid_capsule(mass: f64, half_length: f64, radius: f64) -> Result<Self, RigidError> {
        check("radius of a capsule", radius)?;
        check("half length of a capsule", half_length)?;
        let (a, r) = (half_length, radius);
        let ends = mass * (2.0 / 3.0 * r) / (a + 2.0 / 3.0 * r);
        let middle = mass - ends;
        let along = middle * r * r / 2.0 + ends * 0.4 * r * r;
        let across =
            middle * (r * r / 4.0 + a * a / 3.0) + ends * (0.4 * r * r + a * a + 0.75 * a * r);
        Body::new(mass, [across, across, along])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    /// The moments about x and z, over the mass, of what holds points, by a fine sum.
    fn summed(low: [f64; 3], high: [f64; 3], holds: impl Fn(&Vector3<f64>) -> bool) -> [f64; 2] {
        const N: usize = 160;
        let at = |k: usize, i: usize| low[k] + (high[k] - low[k]) * (i as f64 + 0.5) / N as f64;
        let (mut count, mut first, mut moments) = (0.0, Vector3::zeros(), [0.0; 2]);
        for i in 0..N {
            for j in 0..N {
                for k in 0..N {
                    let p = Vector3::new(at(0, i), at(1, j), at(2, k));
                    if holds(&p) {
                        count += 1.0;
                        first += p;
                        moments[0] += p.y * p.y + p.z * p.z;
                        moments[1] += p.x * p.x + p.y * p.y;
                    }
                }
            }
        }
        let centre = first / count;
        assert!(centre.norm() < 2e-3, "{centre:?}");
        moments.map(|moment| moment / count)
    }

    #[test]
    fn moments_of_round_bodies_are_those_of_a_fine_sum() {
        let around = |p: &Vector3<f64>| p.x.hypot(p.y);
        type Case<'a> = (Body, [f64; 3], [f64; 3], &'a dyn Fn(&Vector3<f64>) -> bool);
        let holds: [Case<'_>; 5] = [
            (Body::solid_ball(2.0, 0.7).unwrap(), [-0.7; 3], [0.7; 3], &|p| p.norm() <= 0.7),
            (
                Body::solid_ellipsoid(2.0, [0.5, 0.8, 1.1]).unwrap(),
                [-0.5, -0.8, -1.1],
                [0.5, 0.8, 1.1],
                &|p| Vector3::new(p.x / 0.5, p.y / 0.8, p.z / 1.1).norm() <= 1.0,
            ),
            (
                Body::solid_cylinder(2.0, 0.9, 0.4).unwrap(),
                [-0.4, -0.4, -0.9],
                [0.4, 0.4, 0.9],
                &|p| around(p) <= 0.4,
            ),
            (Body::solid_cone(2.0, 1.2, 0.5).unwrap(), [-0.5, -0.5, -0.3], [0.5, 0.5, 0.9], &|p| {
                around(p) <= 0.5 * (0.75 - p.z / 1.2)
            }),
            (
                Body::solid_capsule(2.0, 0.6, 0.4).unwrap(),
                [-0.4, -0.4, -1.0],
                [0.4, 0.4, 1.0],
                &|p| Vector3::new(p.x, p.y, p.z - p.z.clamp(-0.6, 0.6)).norm() <= 0.4,
            ),
        ];
        for (body, low, high, holds) in holds {
            let [across, along] = summed(low, high, holds).map(|moment| 2.0 * moment);
            let moments = body.moments();
            assert!((moments.x / across - 1.0).abs() < 2e-3, "{} {across}", moments.x);
            assert!((moments.z / along - 1.0).abs() < 2e-3, "{} {along}", moments.z);
        }
    }

    #[test]
    fn round_bodies_without_a_size_or_a_mass_are_refused_by_name() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            for body in [
                Body::solid_ball(1.0, bad),
                Body::solid_ellipsoid(1.0, [1.0, bad, 1.0]),
                Body::solid_cylinder(1.0, bad, 1.0),
                Body::solid_cylinder(1.0, 1.0, bad),
                Body::solid_cone(1.0, bad, 1.0),
                Body::solid_capsule(1.0, 1.0, bad),
            ] {
                assert!(matches!(body, Err(RigidError::Length { .. })), "{bad}");
            }
            assert!(matches!(Body::solid_cone(bad, 1.0, 1.0), Err(RigidError::Mass(_))));
        }
    }
}
