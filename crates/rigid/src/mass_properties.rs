//! What of a shape matters to its motion: mass, centre and inertia, and how pieces add up.
//!
//! ```text
//! m = rho V,      c = o + f/V,      I = rho (tr(C') 1 - C')       C' second moments about c
//! m = sum m_k,    c = sum m_k c_k / m
//! I about c = sum I_k + m_k (|d|^2 - d d^T),   d = c_k - c        the parallel-axis rule
//! R I R^T                                                          turned with the piece
//! ```
//! `V f C` the area or volume of a shape and its moments about a point `o`, `rho` the density
//! (kg/m^2 or kg/m^3), `m` kg, `c` metres, `I` kg m^2; in the plane `I` is the polar moment and
//! the rule `m |d|^2`. Pieces may have densities of their own. Only differences of centres enter,
//! so pieces far from the origin lose no digits. The moments of polygons, closed surfaces and
//! solids, and what may be wrong with those, are the crate mesh's. Source: notes 7.2, 7.3, 9.4.

use nalgebra::{Matrix3, Vector2, Vector3};
use stationary_calculus::DiagonalMetric;
use stationary_mesh::Moments;

use crate::error::check_finite;
use crate::{Body, LieGroup, PlanarMotion, PrincipalFrame, RigidError, RigidMotion};

/// Mass, centre and polar inertia of a planar shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarMass {
    /// kg, or kg per metre of depth.
    pub mass: f64,
    /// The centre of mass, metres.
    pub centre: Vector2<f64>,
    /// The polar moment about the centre, kg m^2.
    pub inertia: f64,
}

impl PlanarMass {
    /// A shape of the plane, known by its moments, made of a plate of this density (kg/m^2).
    ///
    /// # Errors
    /// [`RigidError::Density`] and [`RigidError::NoMeasure`]; [`RigidError::Mass`] for a mass that
    /// overflows or rounds to zero; [`RigidError::NonFinite`] for a centre or an inertia.
    pub fn of(density: f64, shape: &Moments<2>) -> Result<Self, RigidError> {
        let central = central(density, shape)?;
        let mass = total([density * central.measure].into_iter())?;
        let inertia = density * central.polar();
        check_finite("the centre", central.about.as_slice())?;
        check_finite("the inertia", &[inertia])?;
        Ok(PlanarMass { mass, centre: central.about, inertia })
    }

    /// The polar moment about any point.
    pub fn about(&self, point: &Vector2<f64>) -> f64 {
        self.inertia + self.mass * (self.centre - point).norm_squared()
    }

    /// The same shape elsewhere.
    pub fn moved(&self, motion: &PlanarMotion) -> Self {
        PlanarMass { centre: motion.apply(&self.centre), ..*self }
    }

    /// All pieces as one.
    ///
    /// # Errors
    /// A mass of all that is not positive and finite, and numbers that are not finite.
    pub fn composite(pieces: &[PlanarMass]) -> Result<Self, RigidError> {
        let mass = total(pieces.iter().map(|piece| piece.mass))?;
        let first = pieces[0].centre;
        let weighted = |piece: &PlanarMass| (piece.centre - first) * (piece.mass / mass);
        let centre = first + pieces.iter().map(weighted).sum::<Vector2<f64>>();
        let inertia = pieces.iter().map(|piece| piece.about(&centre)).sum();
        check_finite("the centre", centre.as_slice())?;
        check_finite("the inertia", &[inertia])?;
        Ok(PlanarMass { mass, centre, inertia })
    }

    /// The metric of the body's freedoms (tx, ty, theta) about its centre: constant, so that the
    /// methods of flat space apply, 7.4's explicit update among them.
    ///
    /// # Errors
    /// [`MetricError::NotAMass`](stationary_calculus::MetricError::NotAMass) for a mass or an
    /// inertia that is not positive and finite.
    pub fn metric(&self) -> Result<DiagonalMetric<[f64; 3]>, stationary_calculus::MetricError> {
        DiagonalMetric::new([self.mass, self.mass, self.inertia])
    }
}

/// Mass, centre and inertia of a shape in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpatialMass {
    /// kg.
    pub mass: f64,
    /// The centre of mass, metres.
    pub centre: Vector3<f64>,
    /// The inertia tensor about the centre, kg m^2, in the shape's axes.
    pub inertia: Matrix3<f64>,
}

impl SpatialMass {
    /// A solid, known by its moments, made of a material of this density (kg/m^3).
    ///
    /// # Errors
    /// [`RigidError::Density`] and [`RigidError::NoMeasure`]; [`RigidError::Mass`] for a mass that
    /// overflows or rounds to zero; [`RigidError::NonFinite`] for a centre or an inertia.
    pub fn of(density: f64, shape: &Moments<3>) -> Result<Self, RigidError> {
        let central = central(density, shape)?;
        let mass = total([density * central.measure].into_iter())?;
        let inertia = central.inertia() * density;
        check_finite("the centre", central.about.as_slice())?;
        check_finite("the inertia", inertia.as_slice())?;
        Ok(SpatialMass { mass, centre: central.about, inertia })
    }

    /// The inertia tensor about any point.
    pub fn about(&self, point: &Vector3<f64>) -> Matrix3<f64> {
        let d = self.centre - point;
        self.inertia + (Matrix3::identity() * d.norm_squared() - d * d.transpose()) * self.mass
    }

    /// The same shape elsewhere.
    pub fn moved(&self, motion: &RigidMotion) -> Self {
        let turn = motion.rotation.matrix();
        SpatialMass {
            mass: self.mass,
            centre: motion.apply(&self.centre),
            inertia: turn * self.inertia * turn.transpose(),
        }
    }

    /// All pieces as one.
    ///
    /// # Errors
    /// A mass of all that is not positive and finite, and numbers that are not finite.
    pub fn composite(pieces: &[SpatialMass]) -> Result<Self, RigidError> {
        let mass = total(pieces.iter().map(|piece| piece.mass))?;
        let first = pieces[0].centre;
        let weighted = |piece: &SpatialMass| (piece.centre - first) * (piece.mass / mass);
        let centre = first + pieces.iter().map(weighted).sum::<Vector3<f64>>();
        let inertia: Matrix3<f64> = pieces.iter().map(|piece| piece.about(&centre)).sum();
        check_finite("the centre", centre.as_slice())?;
        check_finite("the inertia", inertia.as_slice())?;
        Ok(SpatialMass { mass, centre, inertia })
    }

    /// The body, and where its principal axes lie in the shape's: the centre and the principal
    /// frame.
    ///
    /// # Errors
    /// Those of [`PrincipalFrame::of`] and of [`Body::new`], and a centre that is not finite.
    pub fn body(&self) -> Result<(Body, RigidMotion), RigidError> {
        check_finite("the centre", self.centre.as_slice())?;
        let frame = PrincipalFrame::of(&self.inertia)?;
        let pose = RigidMotion { translation: self.centre, rotation: frame.rotation };
        Ok((Body::new(self.mass, frame.moments)?, pose))
    }
}

fn total(masses: impl Iterator<Item = f64>) -> Result<f64, RigidError> {
    let mass: f64 = masses.sum();
    if mass > 0.0 && mass.is_finite() { Ok(mass) } else { Err(RigidError::Mass(mass)) }
}

/// The moments about the centroid of a shape that a body can be made of.
fn central<const D: usize>(density: f64, shape: &Moments<D>) -> Result<Moments<D>, RigidError> {
    if !(density > 0.0 && density.is_finite()) {
        return Err(RigidError::Density(density));
    }
    let measure = shape.measure;
    let central = shape.central().filter(|_| measure > 0.0 && measure.is_finite());
    central.ok_or(RigidError::NoMeasure { measure })
}
