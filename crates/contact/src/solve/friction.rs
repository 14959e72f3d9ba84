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

use crate::solve::rigid_contact::{Compliance, RigidContact};
use stationary_calculus::array;

impl<const F: usize, const D: usize> RigidContact<F, D> {
    /// Changes the impulses of this contact to what the others leave to it; says by how much.
    #[inline]
    pub(crate) fn relax(&self, x: &mut [f64; D], w: &mut [[f64; F]]) -> [f64; D] {
        let change = self.visit(w, x, |rates| self.stagger(rates, x));
        x.iter_mut().zip(&change).for_each(|(x, change)| *x += change);
        change
    }

    #[inline]
    fn stagger(&self, mut rates: [f64; D], x: &[f64; D]) -> [f64; D] {
        let Compliance { normal, normal_mass, .. } = self.compliance;
        let push = (x[0] - rates[0] * normal_mass).max(0.0) - x[0];
        let radius = self.friction * (x[0] + push);
        let mut change: [f64; D] = array(|k| -x[k]);
        if radius > 0.0 {
            (1..D).for_each(|k| rates[k] += normal[k] * push);
            let rubbed = self.rub(x, rates, radius);
            change = array(|k| rubbed[k] - x[k]);
        }
        change[0] = push;
        change
    }

    /// The impulses with the friction within a disc of this radius, from the rates of sliding.
    #[inline]
    fn rub(&self, x: &[f64; D], rates: [f64; D], radius: f64) -> [f64; D] {
        let Compliance { tangent_mass, across_mass, .. } = self.compliance;
        let mut stuck = *x;
        for k in 1..D {
            // Of two tangents, the other one.
            let other = if D > 2 { tangent_mass[0] * rates[D - k] } else { 0.0 };
            stuck[k] -= tangent_mass[k] * rates[k] + other;
        }
        if tangent_mass[1] > 0.0 && square_across(&stuck) <= radius * radius {
            return stuck;
        }
        disc(array(|k| x[k] - rates[k] * across_mass), radius)
    }

    /// The energy of a change of impulses, J.
    #[inline]
    pub(crate) fn energy(&self, x: &[f64; D]) -> f64 {
        let Compliance { normal, across, .. } = self.compliance;
        normal[0] * x[0] * x[0] + across * square_across(x)
    }

    /// A change of impulses as a velocity, m/s.
    #[inline]
    pub(crate) fn speed(&self, x: &[f64; D]) -> f64 {
        let Compliance { normal, across, .. } = self.compliance;
        (1..D).fold(normal[0] * x[0].abs(), |most, k| larger(most, across * x[k].abs()))
    }

    /// How far the normal conditions and Coulomb's law are from being met, m/s.
    #[inline]
    pub(crate) fn residuals(&self, x: &[f64; D], w: &[[f64; F]]) -> [f64; 2] {
        let rates = self.rates(w);
        let Compliance { normal, across, across_mass, .. } = self.compliance;
        let wanted: [f64; D] = disc(array(|k| x[k] - rates[k] * across_mass), self.friction * x[0]);
        let off = square_across(&array::<_, D>(|k| x[k] - wanted[k]));
        [(normal[0] * x[0]).min(rates[0]).abs(), off.sqrt() * across]
    }
}

/// The larger of two numbers, in one instruction where both are some.
#[inline]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The square of what is across the normal.
#[inline]
pub(crate) fn square_across<const D: usize>(x: &[f64; D]) -> f64 {
    x[1..].iter().map(|x| x * x).sum()
}

/// Impulses that do not pull, with friction within what they allow.
pub(crate) fn into_cone<const D: usize>(mut x: [f64; D], friction: f64) -> [f64; D] {
    x[0] = x[0].max(0.0);
    disc(x, friction * x[0])
}

/// The least square of an impulse that is known to all its digits: less is nothing, N^2 s^2.
const LEAST_SQUARE: f64 = 1e-290;

/// The impulses whose part across the normal is the nearest point of a disc about zero.
#[inline]
pub(crate) fn disc<const D: usize>(mut x: [f64; D], radius: f64) -> [f64; D] {
    let square = square_across(&x);
    if square < LEAST_SQUARE {
        x[1..].fill(0.0);
    } else if square > radius * radius {
        let scale = radius / square.sqrt();
        x[1..].iter_mut().for_each(|x| *x *= scale);
    }
    x
}

#[cfg(all(test, feature = "3d"))]
mod tests {
    use nalgebra::Vector3;
    use stationary_calculus::{DiagonalMetric, Vector};
    use stationary_rigid::{Body, BodyMetric};

    use super::*;
    use crate::solve::body_state::BodyState;
    use crate::solve::rigid_contact::Directions;
    use crate::{
        ContactId, ContactPoint, ContactRows, Dimension, Impact, InverseMass, Spatial, project,
    };

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
        let scale = Spatial::scales(&BodyMetric::new(vec![body]))[0];
        let states = [BodyState::<Spatial>::new(0, scale, &q, &velocity)];
        let directions = Spatial::directions(&point.normal);
        let mut contact = RigidContact::NONE;
        contact.set(&point, &Directions::of(directions, &point, &states), 0.0, &states);
        let (mut x, mut w) = ([0.0; 3], [[0.0; 6]; 2]);
        contact.relax(&mut x, &mut w);
        let after = [0, 1, 2].map(|k| v[k] + scale[k] * w[0][k]);
        (after, contact.residuals(&x, &w))
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
    fn impulses_outside_of_the_cone_are_taken_back_into_it() {
        assert_eq!(into_cone([5.0, 6.0, 8.0], 1.0), [5.0, 3.0, 4.0]);
        assert_eq!(into_cone([-1e-17, 0.0, 1e-17], 1.0), [0.0; 3]);
        assert_eq!(into_cone([1.0, 0.5, 0.0], 1.0), [1.0, 0.5, 0.0]);
        // The squares of what is left of many rebounds are all zero.
        assert_eq!(into_cone([1e-170, 3e-164, 0.0], 1.0), [1e-170, 0.0, 0.0]);
    }

    #[test]
    fn what_separates_feels_nothing_and_what_only_touches_does_not_rub() {
        for up in [0.0, 1.0] {
            let (v, residuals) = rub(0.5, [3.0, 0.0, up]);
            assert_eq!((v, residuals), ([3.0, 0.0, up], [0.0; 2]));
        }
    }
}
