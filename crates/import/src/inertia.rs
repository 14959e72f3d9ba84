//! Mass, centre and moments, of one part and of several.

use nalgebra::{Isometry3, Matrix3, Rotation3, SymmetricEigen, UnitQuaternion, Vector3};

use crate::ImportError;

/// Moments that differ from the principal ones by less than this part of the largest are principal.
const DIAGONAL: f64 = 1e-12;
/// By so much, relative, a moment may exceed the sum of the other two: digits of a file.
const DIGITS: f64 = 1e-6;

/// Mass (kg), centre (m), and moments about the centre (kg m^2), in some frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Inertia {
    pub(crate) mass: f64,
    pub(crate) centre: Vector3<f64>,
    pub(crate) moments: Matrix3<f64>,
}

impl Inertia {
    pub(crate) const NONE: Self = Inertia {
        mass: 0.0,
        centre: Vector3::new(0.0, 0.0, 0.0),
        moments: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    };

    /// Moments about three axes of a part whose centre is the origin.
    pub(crate) fn about_axes(mass: f64, moments: [f64; 3]) -> Self {
        let moments = Matrix3::from_diagonal(&Vector3::from(moments));
        Inertia { mass, centre: Vector3::zeros(), moments }
    }

    /// The same part as the frame sees it in which its own frame has this pose.
    pub(crate) fn seen(&self, pose: &Isometry3<f64>) -> Self {
        let r = pose.rotation.to_rotation_matrix();
        Inertia {
            mass: self.mass,
            centre: pose.transform_point(&self.centre.into()).coords,
            moments: r * self.moments * r.transpose(),
        }
    }

    /// Both as one part.
    pub(crate) fn with(&self, other: &Self) -> Self {
        let mass = self.mass + other.mass;
        if mass == 0.0 {
            return *self;
        }
        let centre = (self.centre * self.mass + other.centre * other.mass) / mass;
        let moved = |part: &Self| {
            let d = part.centre - centre;
            part.moments + (Matrix3::identity() * d.norm_squared() - d * d.transpose()) * part.mass
        };
        Inertia { mass, centre, moments: moved(self) + moved(other) }
    }

    /// The principal moments, and the pose of their axes at the centre.
    pub(crate) fn principal(&self, name: &str) -> Result<([f64; 3], Isometry3<f64>), ImportError> {
        let finite = self.mass.is_finite()
            && self.centre.iter().chain(self.moments.iter()).all(|x| x.is_finite());
        if !finite {
            return Err(ImportError::NonFinite { what: "the inertia", name: name.to_owned() });
        }
        let largest = self.moments.amax();
        let off = [(0, 1), (0, 2), (1, 2)].map(|at| self.moments[at].abs());
        let (moments, axes) = if off.into_iter().all(|off| off <= DIAGONAL * largest) {
            (self.moments.diagonal(), UnitQuaternion::identity())
        } else {
            let SymmetricEigen { eigenvalues, mut eigenvectors } =
                SymmetricEigen::new(self.moments);
            if eigenvectors.determinant() < 0.0 {
                eigenvectors.column_mut(2).neg_mut();
            }
            let axes = Rotation3::from_matrix_unchecked(eigenvectors);
            (eigenvalues, UnitQuaternion::from_rotation_matrix(&axes))
        };
        let [a, b, c]: [f64; 3] = moments.into();
        let sum = a + b + c;
        if [a, b, c].iter().any(|&m| !(m > 0.0 && 2.0 * m <= sum * (1.0 + DIGITS))) {
            return Err(ImportError::Moments { name: name.to_owned(), moments: [a, b, c] });
        }
        Ok(([a, b, c], Isometry3::from_parts(self.centre.into(), axes)))
    }
}

/// A solid box of these sides.
pub(crate) fn solid_box(mass: f64, [a, b, c]: [f64; 3]) -> Inertia {
    let over = |x: f64, y: f64| mass * (x * x + y * y) / 12.0;
    Inertia::about_axes(mass, [over(b, c), over(a, c), over(a, b)])
}

/// A solid ball.
pub(crate) fn solid_ball(mass: f64, radius: f64) -> Inertia {
    Inertia::about_axes(mass, [0.4 * mass * radius * radius; 3])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box cut in two along its first side is the box.
    #[test]
    fn two_halves_are_the_whole() {
        let half = |x: f64| {
            let pose = Isometry3::translation(x, 0.0, 0.0);
            solid_box(1.5, [0.4, 0.3, 0.2]).seen(&pose)
        };
        let (both, whole) = (half(-0.2).with(&half(0.2)), solid_box(3.0, [0.8, 0.3, 0.2]));
        assert!((both.moments - whole.moments).amax() < 1e-15 && both.centre.norm() < 1e-15);
        assert_eq!(both.mass, 3.0);
    }

    #[test]
    fn turned_moments_have_the_principal_ones_and_their_axes() {
        let turn = UnitQuaternion::from_euler_angles(0.3, -0.8, 1.9);
        let pose = Isometry3::from_parts(Vector3::new(1.0, 2.0, 3.0).into(), turn);
        let seen = solid_box(2.0, [0.7, 0.2, 0.4]).seen(&pose);
        let (moments, axes) = seen.principal("box").unwrap();
        let again = Inertia::about_axes(2.0, moments).seen(&axes);
        assert!((again.moments - seen.moments).amax() < 1e-15, "{again:?} {seen:?}");
        assert!((axes.translation.vector - Vector3::new(1.0, 2.0, 3.0)).norm() < 1e-15);
    }

    #[test]
    fn moments_that_no_body_has_are_refused() {
        for bad in [[1.0, 1.0, 3.0], [1.0, 1.0, 0.0], [1.0, -1.0, 1.0]] {
            let refused = Inertia::about_axes(1.0, bad).principal("arm");
            assert!(matches!(refused, Err(ImportError::Moments { name, .. }) if name == "arm"));
        }
        let nan = Inertia::about_axes(f64::NAN, [1.0; 3]).principal("arm");
        assert!(matches!(nan, Err(ImportError::NonFinite { .. })));
    }
}
