//! A rigid body: its mass and its moments of inertia about its principal axes.
//!
//! ```text
//! T = 1/2 m |t.|^2 + 1/2 <I w, w>,      I = diag(I1, I2, I3)                        (9.4)
//! I1 + I2 >= I3, and in turn                what every distribution of mass obeys
//! Q^T I Q diagonal                          Q the principal frame of a full tensor
//! ```
//! `m` kg; `I` kg m^2 about the point that the body turns about, its centre of mass if it is free;
//! `t` that point, `w` the angular velocity in body axes (rad/s). Body axes are principal axes
//! here: the metric is diagonal in them, and splittings turn about them. [`PrincipalFrame`] leads
//! there from any other axes. Source: notes 9.4, 7.3.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use crate::error::check_finite;
use crate::twofold::power_below;
use crate::{RigidError, Rotation};

/// The mass and principal moments of a body, with their inverses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    mass: f64,
    moments: Vector3<f64>,
    inverse_mass: f64,
    inverse_moments: Vector3<f64>,
}

/// How far a moment may exceed the sum of the other two: rounding, as of a flat body's.
const TRIANGLE: f64 = 1e-12;

impl Body {
    /// A body of this mass (kg) and these principal moments (kg m^2), all positive.
    ///
    /// # Errors
    /// [`RigidError::Mass`], [`RigidError::Moment`] and [`RigidError::TriangleInequality`].
    pub fn new(mass: f64, moments: [f64; 3]) -> Result<Self, RigidError> {
        if !(mass > 0.0 && mass.is_finite() && mass.recip().is_finite()) {
            return Err(RigidError::Mass(mass));
        }
        for (axis, &moment) in moments.iter().enumerate() {
            if !(moment > 0.0 && moment.is_finite() && moment.recip().is_finite()) {
                return Err(RigidError::Moment { axis, moment });
            }
        }
        for axis in 0..3 {
            let others = moments[(axis + 1) % 3] + moments[(axis + 2) % 3];
            if moments[axis] > others * (1.0 + TRIANGLE) {
                return Err(RigidError::TriangleInequality { axis, moments });
            }
        }
        let moments = Vector3::from(moments);
        let inverse_moments = moments.map(f64::recip);
        Ok(Body { mass, moments, inverse_mass: mass.recip(), inverse_moments })
    }

    /// A solid box of these half sizes (m); one of them may be zero, as of a plate.
    ///
    /// # Errors
    /// A mass that is not positive and finite, a half size that is negative or not finite, a rod
    /// without thickness.
    pub fn solid_box(mass: f64, half: [f64; 3]) -> Result<Self, RigidError> {
        for (axis, &half) in half.iter().enumerate() {
            if !(half >= 0.0 && half.is_finite()) {
                return Err(RigidError::HalfSize { axis, half });
            }
        }
        let square = half.map(|a| a * a);
        let [x, y, z] = square;
        Body::new(mass, [y + z, z + x, x + y].map(|sum| mass * sum / 3.0))
    }

    /// The mass, kg.
    #[inline]
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// The principal moments, kg m^2.
    #[inline]
    pub fn moments(&self) -> Vector3<f64> {
        self.moments
    }

    /// The angular momentum of an angular velocity, both in body axes.
    #[inline]
    pub fn angular_momentum(&self, w: &Vector3<f64>) -> Vector3<f64> {
        self.moments.component_mul(w)
    }

    /// The angular velocity of an angular momentum, both in body axes.
    #[inline]
    pub fn angular_velocity(&self, m: &Vector3<f64>) -> Vector3<f64> {
        self.inverse_moments.component_mul(m)
    }

    /// One over the mass.
    #[inline]
    pub(crate) fn inverse_mass(&self) -> f64 {
        self.inverse_mass
    }

    /// One over each moment.
    #[inline]
    pub(crate) fn inverse_moments(&self) -> Vector3<f64> {
        self.inverse_moments
    }
}

/// The axes in which an inertia tensor is diagonal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipalFrame {
    /// The principal moments, ascending, kg m^2.
    pub moments: [f64; 3],
    /// Turns vectors in principal axes into those of the tensor's axes.
    pub rotation: Rotation,
}

/// How far mirror entries of a tensor may differ, relative to its largest: rounding.
const SYMMETRIC: f64 = 1e-12;

impl PrincipalFrame {
    /// The principal frame of a symmetric inertia tensor (kg m^2).
    ///
    /// Where two moments agree to rounding, any axes in their plane will do, and these are what the
    /// tensor's rounding made of them.
    ///
    /// # Errors
    /// [`RigidError::NonFinite`] for a tensor or moments that are not; [`RigidError::NotSymmetric`]
    /// for mirror entries that differ by more than rounding.
    pub fn of(tensor: &Matrix3<f64>) -> Result<Self, RigidError> {
        check_finite("the inertia tensor", tensor.as_slice())?;
        for (row, column) in [(1, 0), (2, 0), (2, 1)] {
            let (entry, mirror) = (tensor[(row, column)], tensor[(column, row)]);
            if (entry - mirror).abs() > SYMMETRIC * tensor.amax() {
                return Err(RigidError::NotSymmetric { row, column, entry, mirror });
            }
        }
        // Entries of a normal size, by a power of two.
        let size = if tensor.amax() > 0.0 { power_below(tensor.amax()) } else { 1.0 };
        let symmetric = (tensor + tensor.transpose()) * 0.5;
        let eigen = SymmetricEigen::new(symmetric / size);
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let column = |k: usize| eigen.eigenvectors.column(order[k]).into_owned();
        // The third axis completes a right-handed frame; a principal axis has no sign.
        let (first, second) = (column(0), column(1));
        let frame = Matrix3::from_columns(&[first, second, first.cross(&second)]);
        let moments = order.map(|k| eigen.eigenvalues[k] * size);
        check_finite("the principal moments", &moments)?;
        Ok(PrincipalFrame { moments, rotation: Rotation::from_matrix(&frame)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LieGroup;

    #[test]
    fn the_principal_frame_makes_the_tensor_diagonal() {
        let turn = Rotation::exp(Vector3::new(0.3, 1.2, -0.7)).matrix();
        let moments = [0.05, 0.1, 0.13];
        let tensor = turn * Matrix3::from_diagonal(&Vector3::from(moments)) * turn.transpose();
        let frame = PrincipalFrame::of(&(0.5 * (tensor + tensor.transpose()))).unwrap();
        let q = frame.rotation.matrix();
        let back = q.transpose() * tensor * q;
        assert!((back - Matrix3::from_diagonal(&Vector3::from(moments))).amax() < 1e-16);
        assert!((Vector3::from(frame.moments) - Vector3::from(moments)).amax() < 1e-16);
    }

    #[test]
    fn what_is_no_body_is_refused_by_name() {
        for mass in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(Body::new(mass, [1.0; 3]), Err(RigidError::Mass(_))));
        }
        let flat = Body::new(1.0, [0.0, 1.0, 1.0]);
        assert_eq!(flat, Err(RigidError::Moment { axis: 0, moment: 0.0 }));
        let odd = Body::new(1.0, [1.0, 1.0, 2.1]).unwrap_err();
        assert!(matches!(odd, RigidError::TriangleInequality { axis: 2, .. }), "{odd}");
        assert!(Body::new(1.0, [0.1, 0.2, 0.1 + 0.2]).is_ok(), "a flat plate");
        let mut tensor = Matrix3::identity();
        tensor[(2, 0)] = 1e-3;
        let skew = PrincipalFrame::of(&tensor).unwrap_err();
        assert!(matches!(skew, RigidError::NotSymmetric { row: 2, column: 0, .. }), "{skew}");
        tensor[(2, 0)] = f64::NAN;
        assert!(matches!(PrincipalFrame::of(&tensor), Err(RigidError::NonFinite { .. })));
    }
}
