//! Coulomb friction by staggered projections: normal impulses, then friction within their cones, by
//! turns.
//!
//! ```text
//! normal     min 1/2 |v - v_f|_M^2,   dg v + bias >= 0         v_f with the friction impulses kept
//! friction   min 1/2 |v|_M^2 over |beta_i| <= mu_i lambda_i      v with the normal impulses kept
//! residual = max_i |beta_i - disc_i(beta_i - T_i v/d_i)| d_i     Coulomb's law, m/s
//! ```
//! `lambda` normal impulses (N s), `beta` friction impulses, two for each contact, `T` the rates of
//! sliding, `disc_i` the nearest point of the disc of radius `mu_i lambda_i`, `d_i` a bound on the
//! compliance across the normal. Each projection is convex; a point that both leave is Coulomb's
//! law: friction opposes sliding, as far as the normal impulse lets it. One projection onto cones
//! of both at once would instead lift what slides, by mu times its speed.
//!
//! The turns need not converge; they are bounded, and what is left of Coulomb's law is reported.
//! The last projection is the normal one, so that gaps are kept however friction comes out. Kinetic
//! energy does not grow by friction. Source: Kaufman, Sueda, James and Pai 2008 (staggered
//! projections).

use stationary_calculus::{SizeError, Vector};

use crate::projection::{all, project_with};
use crate::{ContactError, Impact};

/// What the contacts' impulses came out as.
#[derive(Clone, Debug, PartialEq)]
pub struct Staggered {
    /// Normal impulse of each contact, N s.
    pub normal: Vec<f64>,
    /// Friction impulses, two for each contact, N s.
    pub friction: Vec<f64>,
    /// How far the normal conditions are from being met, m/s.
    pub residual: f64,
    /// How far Coulomb's law is from being met, m/s.
    pub coulomb: f64,
    /// Turns taken.
    pub turns: usize,
}

/// Turns after which friction is taken as it is.
const TURNS: usize = 60;
/// Sweeps over the contacts in one friction projection.
const SWEEPS: usize = 100;
/// Changes of impulses, as velocities, relative to the largest relative velocity, that end both.
pub(crate) const SETTLED: f64 = 1e-11;

/// Contacts with friction: their normals, their tangents (two for each), and their coefficients.
#[derive(Clone, Copy, Debug)]
pub struct Frictional<'a> {
    /// The normal rows.
    pub normal: &'a Impact,
    /// The rows of sliding, two for each contact.
    pub tangent: &'a Impact,
    /// How much of each gap is left, over the step: `dg v + bias >= 0`, m/s.
    pub bias: &'a [f64],
    /// The coefficients.
    pub friction: &'a [f64],
}

impl Frictional<'_> {
    /// Changes a velocity by normal and friction impulses, from a guess of the normal ones.
    pub fn stagger(
        &self,
        guess: &[f64],
        mut v: Vector<&mut [f64]>,
    ) -> Result<Staggered, ContactError> {
        self.check(guess)?;
        let start = Vector(v.0.to_vec());
        let mut beta = vec![0.0; self.tangent.len()];
        let mut lambda = guess.to_vec();
        let settled = SETTLED * self.speed(start.view());
        let (mut turns, mut residual);
        turns = 0;
        let mut rubbed = f64::INFINITY;
        loop {
            let before = lambda;
            v.copy_from(start.view());
            push_all(self.tangent, &beta, v.view_mut());
            let done = self.project(&before, v.view_mut())?;
            (lambda, residual) = (done.0, done.1);
            turns += 1;
            let moved =
                |(i, (a, b)): (usize, (&f64, &f64))| (a - b).abs() * self.normal.compliance(i);
            let moved = lambda.iter().zip(&before).enumerate().map(moved).fold(0.0, f64::max);
            let rubs = self.friction.iter().zip(&lambda).any(|(mu, l)| mu * l > 0.0);
            if turns == TURNS || !rubs || moved.max(rubbed) <= settled {
                break;
            }
            rubbed = self.rub(&lambda, settled, &mut beta, v.view_mut());
        }
        let coulomb = (0..self.normal.len())
            .map(|i| self.towards(i, &lambda, &beta, Vector(v.0)).1)
            .fold(0.0, f64::max);
        Ok(Staggered { normal: lambda, friction: beta, residual, coulomb, turns })
    }

    fn check(&self, guess: &[f64]) -> Result<(), ContactError> {
        let contacts = self.normal.len();
        SizeError::check("the guessed impulses", contacts, guess.len())?;
        SizeError::check("the biases", contacts, self.bias.len())?;
        SizeError::check("the friction coefficients", contacts, self.friction.len())?;
        SizeError::check("the rows of sliding", 2 * contacts, self.tangent.len())?;
        match self.friction.iter().position(|mu| !(*mu >= 0.0 && mu.is_finite())) {
            Some(contact) => Err(ContactError::Friction { contact, value: self.friction[contact] }),
            None => Ok(()),
        }
    }

    fn project(
        &self,
        guess: &[f64],
        v: Vector<&mut [f64]>,
    ) -> Result<(Vec<f64>, f64), ContactError> {
        let done = project_with(self.normal, &all(self.normal.len()), self.bias, guess, v)?;
        Ok((done.impulses, done.residual))
    }

    /// The fastest of the relative velocities, m/s.
    fn speed(&self, v: Vector<&[f64]>) -> f64 {
        let fastest = |impact: &Impact| {
            (0..impact.len()).map(|i| impact.relative_velocity(i, v).abs()).fold(0.0, f64::max)
        };
        fastest(self.normal).max(fastest(self.tangent))
    }

    /// The friction projection: contact after contact to the nearest point of its disc. Says how
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
                let ([x, y], change) = self.towards(i, lambda, beta, Vector(v.0));
                for (row, to) in [(2 * i, x), (2 * i + 1, y)] {
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
        let rows = [2 * i, 2 * i + 1];
        let d = rows.iter().map(|&row| self.tangent.compliance(row)).sum::<f64>();
        let wanted = rows.map(|row| beta[row] - self.tangent.relative_velocity(row, v) / d);
        let reach = self.friction[i] * lambda[i];
        let length = wanted[0].hypot(wanted[1]);
        let scale = if length > reach { reach / length } else { 1.0 };
        let wanted = wanted.map(|x| x * scale);
        let off = (wanted[0] - beta[rows[0]]).hypot(wanted[1] - beta[rows[1]]);
        (wanted, off * d)
    }
}

fn push_all(impact: &Impact, impulses: &[f64], mut v: Vector<&mut [f64]>) {
    for (contact, &impulse) in impulses.iter().enumerate() {
        impact.push(contact, impulse, v.view_mut());
    }
}
