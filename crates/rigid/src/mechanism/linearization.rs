//! A mechanism near an equilibrium as a system of few freedoms, for modes.
//!
//! ```text
//! dV + J^T lambda = 0                              the joints hold the pose
//! mass = N^T M N = 1,    stiffness = N^T (d2V + sum lambda_i d2g_i) N,      J N = 0
//! ```
//! `N` has a column for each freedom that the joints leave, normal in the metric. What the constraint's
//! bend makes of the forces in the joints is part of the stiffness: a pendulum has no other. The
//! linearization is a [`Potential`] of the displacements along N, in kg^1/2 m, and its
//! [metric](Linearization::metric) is 1: what `modal` takes.

use nalgebra::{DMatrix, DVector};
use stationary_calculus::{
    Covector, DenseSink, DiagonalMetric, MetricError, Potential, Sink, System, complement,
    independent_rows,
};
use stationary_constraints::Constraint;

use super::MechanismError;
use super::differential::{CLEAR, Held, full, geometric, inverse_roots, rank};
use super::error::check_finite;
use crate::{BodyMetric, BodySpace};

/// Small motions about an equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct Linearization {
    /// The motions of all bodies that the joints allow, n x freedoms.
    pub basis: DMatrix<f64>,
    /// The stiffness along them, 1/s^2.
    pub stiffness: DMatrix<f64>,
    /// The multipliers that hold the pose, zero for equations that others imply.
    pub multipliers: Vec<f64>,
}

/// What may be left of the forces at an equilibrium, relative to them.
const AT_REST: f64 = 1e-7;

/// The linearization of jointed bodies at an equilibrium `q`.
///
/// # Errors
/// [`MechanismError::NotAtRest`] for a pose that the joints do not hold,
/// [`MechanismError::RankUnclear`] near a singular one, sizes that do not fit, numbers that are not finite.
pub fn linearize<P: Potential, S: BodySpace>(
    system: &System<BodyMetric<S>, P, S>,
    constraint: &impl Constraint,
    t: f64,
    q: &[f64],
) -> Result<Linearization, MechanismError> {
    let n = system.dim();
    check_finite("the configuration", q)?;
    let (metric, roots) = (system.metric(), inverse_roots(system.metric()));
    let j = full(constraint, n, t, q)?;
    let g = geometric(metric, constraint, j.clone())?;
    let (rows, _) = independent_rows(&g, CLEAR);
    if rows.len() != rank(&g)? {
        return Err(MechanismError::RankUnclear { above: CLEAR, below: CLEAR });
    }
    let held = Held::new(&j, rows, &roots)?;
    let (_, span) = independent_rows(&held.b, 0.0);
    let free = complement(span, n);
    let mut dv = Covector(vec![0.0; n]);
    system.potential().add_differential(q, dv.view_mut());
    check_finite("the differential of the potential", &dv.0)?;
    let force = DVector::from_vec(dv.0).component_mul(&roots);
    let left = free.tr_mul(&force).norm();
    if left > AT_REST * force.norm() {
        return Err(MechanismError::NotAtRest { residual: left / force.norm() });
    }
    let multipliers = held.multipliers(&-force, constraint.count())?;
    let mut hessian = vec![0.0; n * n];
    if let Some(mut sink) = DenseSink::new(1.0, n, &mut hessian) {
        system.potential().add_hessian(q, &mut sink);
        constraint.add_hessian(t, q, multipliers.as_slice(), &mut sink)?;
    }
    check_finite("the Hessian", &hessian)?;
    let basis = DMatrix::from_diagonal(&roots) * free;
    let stiffness = basis.transpose() * DMatrix::from_vec(n, n, hessian) * &basis;
    let stiffness = (&stiffness + stiffness.transpose()) * 0.5;
    Ok(Linearization { basis, stiffness, multipliers: multipliers.data.into() })
}

impl Linearization {
    /// The metric of the displacements along the basis: 1.
    ///
    /// # Errors
    /// None: ones are masses.
    pub fn metric(&self) -> Result<DiagonalMetric<Vec<f64>>, MetricError> {
        DiagonalMetric::new(vec![1.0; self.dim()])
    }
}

impl Potential for Linearization {
    fn dim(&self) -> usize {
        self.stiffness.nrows()
    }

    fn energy(&self, q: &[f64]) -> f64 {
        let q = DVector::from_column_slice(q);
        0.5 * (&self.stiffness * &q).dot(&q)
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        for (row, dv) in self.stiffness.row_iter().zip(dv.0) {
            *dv += row.iter().zip(q).map(|(k, q)| k * q).sum::<f64>();
        }
    }

    fn add_hessian(&self, _q: &[f64], hessian: &mut impl Sink) {
        let freedoms: Vec<usize> = (0..self.dim()).collect();
        hessian.add_symmetric(&freedoms, self.stiffness.as_slice());
    }
}
