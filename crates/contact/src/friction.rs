//! Coulomb friction at one contact, by staggered projections: the normal impulse, then friction
//! within what it allows.
//!
//! ```text
//! lambda <- max(0, lambda - u_n/W_nn)                            the normal projection
//! beta   <- beta - W_tt^-1 u_t               where that stays within |beta| <= mu lambda
//!           disc(beta - u_t/d)               elsewhere
//! off = |min(W_nn lambda, u_n)|,   off_t = |beta - disc(beta - u_t/d)| d            m/s
//! ```
//! `u` rates along the normal and the tangents (m/s), `W` their compliance (1/kg), `d` the largest
//! eigenvalue of `W_tt`, `lambda` and `beta` impulses (N s), `disc` the nearest point of the disc
//! of radius `mu lambda`. Each projection is convex and lowers the kinetic energy; a point that
//! both leave is Coulomb's law: friction opposes sliding, as far as the normal impulse lets it. One
//! projection onto the cone of both at once would instead lift what slides, by mu times its speed.
//!
//! `off` and `off_t` are how far the normal conditions and Coulomb's law are from being met; both
//! are reported. Source: Kaufman, Sueda, James and Pai 2008 (staggered projections); Jean 1999 for
//! one contact after another.

use crate::rigid_contact::{Compliance, RigidContact, Six};

impl RigidContact {
    /// Changes the impulses of this contact to what the others leave to it; says by how much.
    #[inline]
    pub(crate) fn relax(&self, x: &mut [f64; 3], w: &mut [Six]) -> [f64; 3] {
        let change = self.visit(w, x, |rates| self.stagger(rates, x));
        x.iter_mut().zip(&change).for_each(|(x, change)| *x += change);
        change
    }

    #[inline]
    fn stagger(&self, [n, s, t]: [f64; 3], x: &[f64; 3]) -> [f64; 3] {
        let Compliance { normal_mass, coupling: [a, b], .. } = self.compliance;
        let push = (x[0] - n * normal_mass).max(0.0) - x[0];
        let reach = self.friction * (x[0] + push);
        if reach <= 0.0 {
            return [push, -x[1], -x[2]];
        }
        let [p, q] = self.rub([x[1], x[2]], [s + a * push, t + b * push], reach);
        [push, p - x[1], q - x[2]]
    }

    /// The friction within a disc of radius `reach`, from the rates of sliding.
    #[inline]
    fn rub(&self, beta: [f64; 2], [s, t]: [f64; 2], reach: f64) -> [f64; 2] {
        let [xx, yy, xy] = self.compliance.tangent_mass;
        let stuck = [beta[0] - (xx * s + xy * t), beta[1] - (xy * s + yy * t)];
        if xx > 0.0 && stuck[0] * stuck[0] + stuck[1] * stuck[1] <= reach * reach {
            return stuck;
        }
        let slip = self.compliance.across_mass;
        disc([beta[0] - s * slip, beta[1] - t * slip], reach)
    }

    /// The energy of a change of impulses, J.
    #[inline]
    pub(crate) fn energy(&self, [n, s, t]: &[f64; 3]) -> f64 {
        let Compliance { normal, across, .. } = self.compliance;
        normal * n * n + across * (s * s + t * t)
    }

    /// A change of impulses as a velocity, m/s.
    #[inline]
    pub(crate) fn speed(&self, [n, s, t]: &[f64; 3]) -> f64 {
        let Compliance { normal, across, .. } = self.compliance;
        (normal * n.abs()).max(across * s.abs().max(t.abs()))
    }

    /// How far the normal conditions and Coulomb's law are from being met, m/s.
    #[inline]
    pub(crate) fn residuals(&self, x: &[f64; 3], w: &[Six]) -> [f64; 2] {
        let [n, s, t] = self.rates(w);
        let Compliance { normal, across, across_mass, .. } = self.compliance;
        let wanted = [x[1] - s * across_mass, x[2] - t * across_mass];
        let [p, q] = disc(wanted, self.friction * x[0]);
        let off = (x[1] - p).powi(2) + (x[2] - q).powi(2);
        [(normal * x[0]).min(n).abs(), off.sqrt() * across]
    }
}

/// The nearest point of a disc about zero.
#[inline]
pub(crate) fn disc([x, y]: [f64; 2], radius: f64) -> [f64; 2] {
    let square = x * x + y * y;
    if square <= radius * radius {
        return [x, y];
    }
    let scale = radius / square.sqrt();
    [x * scale, y * scale]
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use stationary_calculus::{DiagonalMetric, Vector};
    use stationary_rigid::Body;

    use super::*;
    use crate::rigid_contact::{Placed, scale};
    use crate::{ContactId, ContactPoint, ContactRows, Impact, InverseMass, project};

    /// A particle of 1 kg on a plane, after its impulses.
    fn rub(friction: f64, v: [f64; 3]) -> ([f64; 3], [f64; 2]) {
        let normal = Vector3::z();
        let point = ContactPoint {
            id: ContactId { colliders: [0, 1], parts: [0; 2], features: [0; 2] },
            bodies: [None, Some(0)],
            gap: 0.0,
            normal,
            points: [Vector3::zeros(); 2],
            arms: [Vector3::zeros(); 2],
            restitution: 0.0,
            friction,
        };
        let body = Body::new(1.0, [1.0; 3]).unwrap();
        let velocity = [v[0], v[1], v[2], 0.0, 0.0, 0.0];
        let q = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
        let placed = [Placed::new(0, scale(&body), &q, &velocity)];
        let contact = RigidContact::new(0, &point, point.tangents(), 0.0, &placed).unwrap();
        let (mut x, mut w) = ([0.0; 3], [[0.0; 6]; 2]);
        contact.relax(&mut x, &mut w);
        let [x1, y1, z1, ..] = placed[0].after(&w[0]);
        ([x1, y1, z1], contact.residuals(&x, &w))
    }

    #[test]
    fn friction_takes_mu_times_the_normal_impulse_from_what_slides_and_all_from_what_sticks() {
        let (v, [normal, coulomb]) = rub(0.5, [3.0, 4.0, -2.0]);
        // The normal impulse is 2, friction 1 of the speed 5.
        for (v, expected) in v.iter().zip([2.4, 3.2, 0.0]) {
            assert!((v - expected).abs() < 1e-14);
        }
        assert!(normal < 1e-14 && coulomb < 1e-14, "{normal} {coulomb}");
        let (v, [normal, coulomb]) = rub(0.5, [0.3, 0.4, -2.0]);
        assert!(v.iter().all(|v| v.abs() < 1e-14), "{v:?}");
        assert!(normal < 1e-14 && coulomb < 1e-14, "{normal} {coulomb}");
    }

    /// The impulses (-mu, 1) lambda of one side of the cone stop approach across it: the rows of
    /// the cone's sides, projected on at once, throw what slides upward at
    /// mu (s - mu w)/(1 + mu^2).
    #[test]
    fn a_single_projection_onto_the_cone_lifts_what_slides_and_staggered_projections_do_not() {
        let (mu, s, w) = (0.5, 3.0, 0.1);
        let mass = InverseMass::of(&DiagonalMetric::new([1.0; 2]).unwrap()).unwrap();
        let mut sides = ContactRows::new();
        [-mu, mu].into_iter().for_each(|side| sides.push([(0, side), (1, 1.0)]));
        let cone = Impact::new(sides, &mass, vec![0.0; 2]).unwrap();
        let mut lifted = Vector([s, -w]);
        project(&cone, lifted.view_mut()).unwrap();
        let expected = mu * (s - mu * w) / (1.0 + mu * mu);
        assert!((lifted.0[1] - expected).abs() < 1e-14 && expected > 1.0);
        let (kept, _) = rub(mu, [s, 0.0, -w]);
        assert!(kept[2].abs() < 1e-15 && (kept[0] - (s - mu * w)).abs() < 1e-14);
    }

    #[test]
    fn what_separates_feels_nothing_and_what_only_touches_does_not_rub() {
        for up in [0.0, 1.0] {
            let (v, residuals) = rub(0.5, [3.0, 0.0, up]);
            assert_eq!((v, residuals), ([3.0, 0.0, up], [0.0; 2]));
        }
    }
}
