//! A scene in contact's hands: what it says of a step, in terms that the plane and space share.
//!
//! Everything is in space and in world axes; in the plane the last coordinate is zero, and bodies turn
//! about it alone.

use nalgebra::{Matrix3, Vector3};
use stationary_contact::{ContactError, ImpactLaw, WorldReport};
use stationary_integrators::StepError;

use super::case::{Case, Form, Law, Thing};
use super::hull::{Hull, Pose};

/// A body as the referee knows it.
#[derive(Clone, Debug)]
pub(super) struct Body {
    pub(super) hull: Hull,
    pub(super) mass: f64,
    /// About the axes in which it turns, kg m^2; none of the plane's first two.
    pub(super) moments: [Option<f64>; 3],
    /// Nothing slows it down.
    pub(super) pushed: bool,
}

/// How a body moves: momentum, N s, and angular momentum about its centre, N s m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    pub(super) pose: Pose,
    pub(super) p: Vector3<f64>,
    pub(super) l: Vector3<f64>,
}

/// What touched in a step, as it says, and where.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub(super) bodies: [Option<usize>; 2],
    pub(super) normal: Vector3<f64>,
    pub(super) points: [Vector3<f64>; 2],
    /// The same from the centres of the bodies: far from the origin they know it better.
    pub(super) arms: [Vector3<f64>; 2],
    pub(super) gap: f64,
    pub(super) friction: f64,
    /// On the second body, N s: along the normal of impacts and of rest, and across.
    pub(super) impact: f64,
    pub(super) rest: f64,
    pub(super) rubbed: Vector3<f64>,
    /// Of rolling and of torsional friction, N s m.
    pub(super) moment: Vector3<f64>,
}

/// A scene that can be moved on.
pub(super) trait Engine {
    fn step(&mut self, h: f64) -> Result<WorldReport, ContactError>;
    /// Goes on from what it has saved.
    fn reload(&mut self) -> Result<(), StepError>;
    fn motions(&self) -> Vec<Motion>;
    fn touches(&self) -> Vec<Seen>;
}

impl Body {
    /// The bodies of a scene.
    pub(super) fn all(case: &Case) -> Vec<Body> {
        let body = |(k, thing): (usize, &Thing)| Body {
            hull: Hull::of(thing, case.flat),
            mass: thing.mass,
            moments: moments(thing, case.flat),
            pushed: case.pushed && k == 0,
        };
        case.things.iter().enumerate().map(body).collect()
    }

    /// What turns angular momentum into angular velocity, world axes; also of what is pushed.
    fn lightness(&self, r: &Matrix3<f64>) -> Matrix3<f64> {
        let inverse = Vector3::from(self.moments.map(|i| i.map_or(0.0, f64::recip)));
        r * Matrix3::from_diagonal(&inverse) * r.transpose()
    }

    pub(super) fn spin(&self, r: &Matrix3<f64>, l: &Vector3<f64>) -> Vector3<f64> {
        self.lightness(r) * l
    }

    /// J.
    pub(super) fn kinetic(&self, r: &Matrix3<f64>, p: &Vector3<f64>, l: &Vector3<f64>) -> f64 {
        0.5 * (p.norm_squared() / self.mass + l.dot(&self.spin(r, l)))
    }

    /// What an impulse along `a` at the end of an arm changes of the velocity along `b` there, 1/kg.
    pub(super) fn gives(
        &self,
        r: &Matrix3<f64>,
        arm: &Vector3<f64>,
        [a, b]: [&Vector3<f64>; 2],
    ) -> f64 {
        if self.pushed {
            return 0.0;
        }
        a.dot(b) / self.mass + arm.cross(b).dot(&(self.lightness(r) * arm.cross(a)))
    }
}

/// Moments of inertia, kg m^2.
fn moments(thing: &Thing, flat: bool) -> [Option<f64>; 3] {
    let Thing { half: [a, b, c], mass, .. } = *thing;
    let [aa, bb, cc] = [a * a, b * b, c * c].map(|x| x * mass);
    match (thing.form, flat) {
        (Form::Box, true) => [None, None, Some((aa + bb) / 3.0)],
        (Form::Round, true) => [None, None, Some(0.5 * aa)],
        (Form::Simplex, true) => [None, None, Some(0.25 * aa)],
        (Form::Box, false) => [Some((bb + cc) / 3.0), Some((aa + cc) / 3.0), Some((aa + bb) / 3.0)],
        (Form::Round, false) => [Some(0.4 * aa); 3],
        (Form::Simplex, false) => [Some(2.0 / 15.0 * aa); 3],
    }
}

pub(super) fn law(law: Law) -> ImpactLaw {
    match law {
        Law::Reflections => ImpactLaw::GeneralizedReflections,
        Law::GaussSeidel => ImpactLaw::GaussSeidel,
        Law::Blended => ImpactLaw::Blended,
        Law::Inelastic => ImpactLaw::Inelastic,
    }
}
