//! The impacts of a step: what closes its gap, and what that brings to close.
//!
//! ```text
//! contact i hits where   g_i + h dg_i (v + k) < 0   and   dg_i v < -max(2 |dg_i k|, still_i)
//! ```
//! `g` gaps (m), `v` the velocity before the increment `k` (m/s), `h` the step (s), `still` a small part of how
//! fast the bodies of the contact move where they meet (m/s). Approach of the order of an increment is rest and
//! has no restitution. A contact that an impact brings to approach takes part in it:
//! the law is applied again to it and to those that hit before, each with its own restitution, until no
//! contact is added. So a row of balls that touch passes a blow on, and a stack at rest stays at rest.
//!
//! Friction acts in every impact but by Jacobi's law, by the passes of `rough.rs`: of one contact after
//! another where the law is Gauss-Seidel's, else of all that approach. With joints every impact is of all
//! that approach, by `jointed.rs`.

use stationary_calculus::Vector;
use stationary_constraints::{RowLaw, VelocityRows};

use crate::impact::jointed::JointedPass;
use crate::impact::rough::RoughContacts;
use crate::{ContactError, ContactIn, ContactRows, Dimension, Impact, ImpactLaw, InverseMass};

/// Approach below this part of the speed of what meets is rest: gaps have rounding of their own, which a short
/// step turns into velocity.
const REST_APPROACH: f64 = 1e-9;
/// What of it may be left by an impact: velocities after a step have the rounding of its increment, beside
/// which the impacts of what all but rests are smaller still.
const LEFT: f64 = 1e-3;
/// What approaches slower than this part of the fastest approach waits for a pass of its own.
const SLOW: f64 = 1e-9;
/// Passes with friction after which what still approaches is stopped as resting contact.
const PASSES: usize = 20;

/// Contacts about to be stepped over.
pub(crate) struct ImpactRounds<'a, G: Dimension> {
    pub(crate) contacts: &'a [ContactIn<G>],
    /// Normals, and the rows across each; none where nothing rubs.
    pub(crate) rows: &'a ContactRows,
    pub(crate) across: &'a ContactRows,
    pub(crate) gap: &'a [f64],
    pub(crate) restitution: &'a [f64],
    pub(crate) friction: &'a [f64],
    pub(crate) mass: &'a InverseMass,
    /// Rows of joints, which hold in every impact.
    pub(crate) joints: &'a VelocityRows,
    pub(crate) law: ImpactLaw,
    pub(crate) increment: &'a Vector<Vec<f64>>,
    pub(crate) h: f64,
}

/// What the impacts of a step gave.
#[derive(Debug)]
pub(crate) struct Given {
    /// Normal impulses, one a contact, and friction impulses, one a row across, N s.
    pub(crate) normal: Vec<f64>,
    pub(crate) friction: Vec<f64>,
    pub(crate) passes: usize,
    /// Whether compression and the law converged.
    pub(crate) converged: bool,
    /// The fastest approach that is left after the last pass, whose restitution is not given, m/s.
    pub(crate) left: f64,
}

impl<G: Dimension> ImpactRounds<'_, G> {
    /// Whether there is an impact at all: something that has restitution hits.
    pub(crate) fn hits(&self, v: &Vector<Vec<f64>>) -> bool {
        (0..self.rows.len()).any(|i| self.restitution[i] > 0.0 && self.hit(i, v))
    }

    /// Whether a contact closes in the step, faster than rest.
    fn hit(&self, i: usize, v: &Vector<Vec<f64>>) -> bool {
        let (own, by_increment) =
            (self.rows.along(i, v.view()), self.rows.along(i, self.increment.view()));
        let reaches = self.gap[i] + self.h * (own + by_increment) < 0.0;
        reaches && own < -(2.0 * by_increment.abs()).max(self.still(i, v))
    }

    /// Applies the impacts to the velocity before the increment.
    pub(crate) fn apply(&self, v: &mut Vector<Vec<f64>>) -> Result<Given, ContactError> {
        let count = self.rows.len();
        let mut given = Given {
            normal: vec![0.0; count],
            friction: vec![0.0; self.across.len()],
            passes: 0,
            converged: true,
            left: 0.0,
        };
        let mut closing: Vec<usize> = Vec::new();
        let mut closes = vec![false; count];
        // Each round adds a contact.
        for _ in 0..count {
            let new: Vec<usize> = (0..count).filter(|&i| !closes[i] && self.hit(i, v)).collect();
            if !new.iter().any(|&i| self.restitution[i] > 0.0) {
                break;
            }
            new.iter().for_each(|&i| closes[i] = true);
            closing.extend(new);
            closing.sort_unstable();
            let still = closing.iter().map(|&i| self.still(i, v)).fold(0.0, f64::max);
            if self.joints.rows() > 0 {
                self.reflect_jointed(&closing, LEFT * still, v, &mut given)?;
                continue;
            }
            let rubs = closing.iter().any(|&i| self.friction[i] > 0.0);
            if rubs && self.law != ImpactLaw::Jacobi {
                self.rub(&closing, LEFT * still, v, &mut given)?;
                continue;
            }
            let impact = self.impact(&closing)?;
            match self.law.apply_down_to(&impact, LEFT * still, v.view_mut()) {
                Ok(done) => {
                    given.passes += done.passes;
                    for (&i, impulse) in closing.iter().zip(&done.impulses) {
                        given.normal[i] += impulse;
                    }
                }
                Err(ContactError::NotConverged { .. }) => given.converged = false,
                Err(error) => return Err(error),
            }
        }
        closing.retain(|&i| -self.rows.along(i, v.view()) > self.still(i, v));
        given.left = self.fastest_approach(&closing, v);
        Ok(given)
    }

    fn impact(&self, contacts: &[usize]) -> Result<Impact, ContactError> {
        Impact::new(self.rows.reordered(contacts), self.mass, self.restitutions(contacts))
    }

    fn restitutions(&self, contacts: &[usize]) -> Vec<f64> {
        let restitution = |&i: &usize| match self.law {
            ImpactLaw::Inelastic => 0.0,
            _ => self.restitution[i],
        };
        contacts.iter().map(restitution).collect()
    }

    /// Those that approach, but for what is slow beside the fastest.
    fn approaching(&self, closing: &[usize], still: f64, v: &Vector<Vec<f64>>) -> Vec<usize> {
        let least = still.max(SLOW * self.fastest_approach(closing, v));
        closing.iter().copied().filter(|&i| self.rows.along(i, v.view()) < -least).collect()
    }

    /// Approach of a contact that is rest, m/s: by its own bodies, whatever goes on elsewhere.
    fn still(&self, i: usize, v: &Vector<Vec<f64>>) -> f64 {
        let contact = &self.contacts[i];
        REST_APPROACH * (contact.speed(&v.0) + contact.speed(&self.increment.0))
    }

    fn fastest_approach(&self, closing: &[usize], v: &Vector<Vec<f64>>) -> f64 {
        closing.iter().map(|&i| -self.rows.along(i, v.view())).fold(0.0, f64::max)
    }

    /// Passes with joints until none of these contacts approaches.
    fn reflect_jointed(
        &self,
        closing: &[usize],
        still: f64,
        v: &mut Vector<Vec<f64>>,
        given: &mut Given,
    ) -> Result<(), ContactError> {
        let directions = self.across.len() / self.rows.len();
        for _ in 0..PASSES {
            let approaching = self.approaching(closing, still, v);
            if approaching.is_empty() {
                return Ok(());
            }
            let mut contacts = VelocityRows::default();
            for &i in &approaching {
                let across = (i * directions..(i + 1) * directions).map(|row| self.across.row(row));
                let entries: Vec<Vec<_>> = std::iter::once(self.rows.row(i).collect())
                    .chain(across.map(Iterator::collect))
                    .collect();
                let block: Vec<(&[(usize, f64)], f64)> =
                    entries.iter().map(|entries| (&entries[..], 0.0)).collect();
                contacts.push(RowLaw::Cone(self.friction[i]), &block)?;
            }
            let restitution = self.restitutions(&approaching);
            let pass = JointedPass {
                joints: self.joints,
                contacts: &contacts,
                restitution: &restitution,
                mass: self.mass,
            };
            let (impulses, settled) = pass.reflect(v)?;
            given.passes += 1;
            given.converged &= settled;
            for (&i, x) in approaching.iter().zip(impulses.chunks_exact(1 + directions)) {
                given.normal[i] += x[0];
                let across = &mut given.friction[i * directions..(i + 1) * directions];
                across.iter_mut().zip(&x[1..]).for_each(|(sum, x)| *sum += x);
            }
        }
        // What approaches still is stopped by resting contact, and told.
        Ok(())
    }

    /// Passes with friction until none of these contacts approaches.
    fn rub(
        &self,
        closing: &[usize],
        still: f64,
        v: &mut Vector<Vec<f64>>,
        given: &mut Given,
    ) -> Result<(), ContactError> {
        let directions = self.across.len() / self.rows.len();
        for _ in 0..PASSES {
            let mut approaching = self.approaching(closing, still, v);
            if self.law == ImpactLaw::GaussSeidel {
                approaching.truncate(1);
            }
            if approaching.is_empty() {
                return Ok(());
            }
            let normal = self.impact(&approaching)?;
            let rows: Vec<usize> =
                approaching.iter().flat_map(|&i| i * directions..(i + 1) * directions).collect();
            let none = vec![0.0; rows.len()];
            let tangent = Impact::new(self.across.reordered(&rows), self.mass, none)?;
            let friction: Vec<f64> = approaching.iter().map(|&i| self.friction[i]).collect();
            let rough = RoughContacts { normal: &normal, tangent: &tangent, friction: &friction };
            let before = v.clone();
            let pass = match rough.reflect(v) {
                Ok(pass) => pass,
                Err(ContactError::NotConverged { .. }) => {
                    v.copy_from(before.view());
                    given.converged = false;
                    break;
                }
                Err(error) => return Err(error),
            };
            given.passes += 1;
            given.converged &= pass.converged;
            approaching.iter().zip(pass.normal).for_each(|(&i, x)| given.normal[i] += x);
            rows.iter().zip(pass.friction).for_each(|(&i, x)| given.friction[i] += x);
        }
        // What approaches still is stopped by resting contact, and told.
        Ok(())
    }
}
