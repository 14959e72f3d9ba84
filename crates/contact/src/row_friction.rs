//! Coulomb's friction on rows: staggered projections, of normal impulses and of friction within
//! what they allow.
//!
//! ```text
//! normal     min 1/2 |v - v_f|_M^2,   dg v + bias >= 0         v_f with the friction impulses kept
//! friction   min 1/2 |v|_M^2 over |beta_i| <= mu_i lambda_i      v with the normal impulses kept
//! residual = max_i |beta_i - ball_i(beta_i - T_i v/d_i)| d_i    Coulomb's law, m/s
//! ```
//! `lambda` normal impulses (N s), `beta_i` a friction impulse for each direction across the
//! contact, one in the plane and two in space, `T` their rows, `ball_i` the nearest point no longer
//! than `mu_i lambda_i`, `d_i` a bound on the compliance across. Each projection is convex; a point
//! that both leave is Coulomb's law: friction opposes sliding, as far as the normal impulse lets
//! it.
//!
//! The turns need not converge; they are bounded, and what is left of Coulomb's law is reported.
//! The last projection is the normal one, so that gaps are kept however friction comes out. Kinetic
//! energy does not grow by friction. Source: Kaufman, Sueda, James and Pai 2008.

use stationary_calculus::Vector;

use crate::projection::{all, project_with};
use crate::{ContactError, Impact};

/// What the contacts' impulses came out as.
pub(crate) struct Rubbed {
    /// Normal impulse of each contact, N s.
    pub(crate) normal: Vec<f64>,
    /// Friction impulses, one a row, N s.
    pub(crate) friction: Vec<f64>,
    /// How far the normal conditions are from being met, m/s.
    pub(crate) residual: f64,
    /// How far Coulomb's law is from being met, m/s.
    pub(crate) coulomb: f64,
}

/// Turns after which friction is taken as it is.
const TURNS: usize = 60;
/// Sweeps over the contacts in one friction projection.
const SWEEPS: usize = 100;
/// Changes of impulses, as velocities, relative to the largest relative velocity, that end both.
pub(crate) const SETTLED: f64 = 1e-11;

/// Contacts with friction: their normals, as many tangents for each, and their coefficients.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowFriction<'a> {
    pub(crate) normal: &'a Impact,
    pub(crate) tangent: &'a Impact,
    /// How much of each gap is left, over the step: `dg v + bias >= 0`, m/s.
    pub(crate) bias: &'a [f64],
    pub(crate) friction: &'a [f64],
}

impl RowFriction<'_> {
    /// Changes a velocity by normal and friction impulses, from guesses of both.
    pub(crate) fn stagger(
        &self,
        mut lambda: Vec<f64>,
        mut beta: Vec<f64>,
        mut v: Vector<&mut [f64]>,
    ) -> Result<Rubbed, ContactError> {
        let start = Vector(v.0.to_vec());
        let settled = SETTLED * self.speed(start.view());
        let (mut rubbed, mut residual) = (f64::INFINITY, 0.0);
        for turn in 0..TURNS {
            if turn > 0 {
                rubbed = self.rub(&lambda, settled, &mut beta, v.view_mut());
            }
            v.copy_from(start.view());
            for (row, &impulse) in beta.iter().enumerate() {
                self.tangent.push(row, impulse, v.view_mut());
            }
            let contacts = all(self.normal.len());
            let done = project_with(self.normal, &contacts, self.bias, &lambda, v.view_mut())?;
            let before = std::mem::replace(&mut lambda, done.impulses);
            residual = done.residual;
            let moved =
                |(i, (a, b)): (usize, (&f64, &f64))| (a - b).abs() * self.normal.compliance(i);
            let moved = lambda.iter().zip(&before).enumerate().map(moved).fold(0.0, f64::max);
            let rubs = self.friction.iter().zip(&lambda).any(|(mu, l)| mu * l > 0.0);
            if !rubs || moved.max(rubbed) <= settled {
                break;
            }
        }
        let off = |i| self.towards(i, &lambda, &beta, Vector(v.0)).1;
        let coulomb = (0..self.normal.len()).map(off).fold(0.0, f64::max);
        Ok(Rubbed { normal: lambda, friction: beta, residual, coulomb })
    }

    /// The fastest of the relative velocities, m/s.
    fn speed(&self, v: Vector<&[f64]>) -> f64 {
        let fastest = |impact: &Impact| {
            (0..impact.len()).map(|i| impact.relative_velocity(i, v).abs()).fold(0.0, f64::max)
        };
        fastest(self.normal).max(fastest(self.tangent))
    }

    /// The rows across a contact.
    fn across(&self, contact: usize) -> std::ops::Range<usize> {
        let directions = self.tangent.len() / self.normal.len();
        contact * directions..(contact + 1) * directions
    }

    /// The friction projection: contact after contact to the nearest point of its ball. Says how
    /// far the last sweep still moved, m/s.
    fn rub(
        &self,
        lambda: &[f64],
        settled: f64,
        beta: &mut [f64],
        mut v: Vector<&mut [f64]>,
    ) -> f64 {
        let mut moved = f64::INFINITY;
        for _ in 0..SWEEPS {
            moved = 0.0_f64;
            for i in 0..self.normal.len() {
                let (wanted, change) = self.towards(i, lambda, beta, Vector(v.0));
                for (row, to) in self.across(i).zip(wanted) {
                    self.tangent.push(row, to - beta[row], v.view_mut());
                    beta[row] = to;
                }
                moved = moved.max(change);
            }
            if moved <= settled {
                break;
            }
        }
        moved
    }

    /// Where a contact's friction wants to be, and how far off it is as a velocity.
    fn towards(
        &self,
        i: usize,
        lambda: &[f64],
        beta: &[f64],
        v: Vector<&[f64]>,
    ) -> ([f64; 2], f64) {
        let d: f64 = self.across(i).map(|row| self.tangent.compliance(row)).sum();
        let mut wanted = [0.0; 2];
        for (row, wanted) in self.across(i).zip(&mut wanted) {
            *wanted = beta[row] - self.tangent.relative_velocity(row, v) / d;
        }
        let reach = self.friction[i] * lambda[i];
        let length = wanted[0].hypot(wanted[1]);
        let scale = if length > reach { reach / length } else { 1.0 };
        let wanted = wanted.map(|x| x * scale);
        let off = self.across(i).zip(wanted).map(|(row, x)| (x - beta[row]).powi(2)).sum::<f64>();
        (wanted, off.sqrt() * d)
    }
}
