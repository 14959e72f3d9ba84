//! An impact: contacts that touch, the mass that they move, and one contact solved.
//!
//! ```text
//! u = dg v                        relative velocities, m/s                                (11.4.1)
//! v+ = v- + M^-1 dg^T lambda      impulses lambda >= 0, N s                               (11.4.2)
//! lambda = -(1 + c) u/d,   d = dg M^-1 dg^T                one contact, restitution c
//! T+ - T- = 1/2 lambda (u- + u+) = -(1 - c^2) u^2/(2 d)    what it costs, J
//! ```
//! `dg` sparse rows, `M` the mass, `c` the ratio of separating to approaching speed, 0 to 1 (the
//! ratio of heights is `c^2`, errata 11.4.2), each contact its own. A contact approaches where
//! `u < 0`; how much of that is rounding is judged by [`Impact::rounding`].

pub(crate) mod rows;
pub(crate) mod inverse_mass;
pub(crate) mod active_set;
pub(crate) mod projection;
pub(crate) mod gauss_seidel;
pub(crate) mod jacobi;
pub(crate) mod reflection;
pub(crate) mod law;
#[cfg(any(feature = "2d", feature = "3d"))]
pub(crate) mod rough;
#[cfg(any(feature = "2d", feature = "3d"))]
pub(crate) mod jointed;
#[cfg(any(feature = "2d", feature = "3d"))]
pub(crate) mod rounds;
#[cfg(any(feature = "2d", feature = "3d"))]
pub(crate) mod touching;

use stationary_calculus::Vector;

use crate::error::check_finite;
use crate::{ContactError, ContactRows, InverseMass};

/// Contacts that touch, ready to be given impulses.
#[derive(Clone, Debug)]
pub struct Impact {
    rows: ContactRows,
    lifted: ContactRows,
    compliance: Vec<f64>,
    restitution: Vec<f64>,
    freedoms: usize,
}

impl Impact {
    /// Contacts with these differentials between things of this mass, each with its restitution.
    ///
    /// # Errors
    /// [`ContactError::Size`] unless each row has a restitution; [`ContactError::Restitution`]
    /// outside of 0 to 1; [`ContactError::NoSuchFreedom`]; [`ContactError::NonFinite`] for an entry
    /// or a compliance; [`ContactError::Immovable`] for a row along which nothing can move.
    pub fn new(
        rows: ContactRows,
        mass: &InverseMass,
        restitution: Vec<f64>,
    ) -> Result<Self, ContactError> {
        stationary_calculus::SizeError::check("coefficients", rows.len(), restitution.len())?;
        let mut impact = Impact { rows, restitution, ..Impact::empty() };
        impact.lift(mass, &mut Lifting::default())?;
        Ok(impact)
    }

    /// Nothing that touches.
    pub(crate) fn empty() -> Self {
        let [rows, lifted] = [ContactRows::new(), ContactRows::new()];
        Impact { rows, lifted, compliance: Vec::new(), restitution: Vec::new(), freedoms: 0 }
    }

    /// Other contacts that do not bounce, in the same memory.
    #[cfg(any(feature = "2d", feature = "3d"))]
    pub(crate) fn refill(
        &mut self,
        mass: &InverseMass,
        lifting: &mut Lifting,
        fill: impl FnOnce(&mut ContactRows),
    ) -> Result<(), ContactError> {
        self.rows.clear();
        fill(&mut self.rows);
        self.restitution.clear();
        self.restitution.resize(self.rows.len(), 0.0);
        self.lift(mass, lifting)
    }

    /// The rows `M^-1 dg^T`, each freedom once, and the compliances.
    fn lift(&mut self, mass: &InverseMass, lifting: &mut Lifting) -> Result<(), ContactError> {
        let Impact { rows, lifted, compliance, restitution, freedoms } = self;
        *freedoms = mass.dim();
        rows.check(*freedoms)?;
        if let Some(contact) = restitution.iter().position(|c| !(0.0..=1.0).contains(c)) {
            return Err(ContactError::Restitution { contact, value: restitution[contact] });
        }
        let Lifting { entries, met, scratch } = lifting;
        met.clear();
        met.resize(*freedoms, (usize::MAX, 0));
        scratch.clear();
        scratch.resize(*freedoms, 0.0);
        lifted.clear();
        compliance.clear();
        for contact in 0..rows.len() {
            entries.clear();
            mass.lift(rows.row(contact), |freedom, x| match met[freedom] {
                (row, place) if row == contact => entries[place].1 += x,
                _ => {
                    met[freedom] = (contact, entries.len());
                    entries.push((freedom, x));
                }
            });
            lifted.push(entries.iter().copied());
            entries.iter().for_each(|&(freedom, x)| scratch[freedom] = x);
            let one = rows.row(contact).map(|(freedom, value)| value * scratch[freedom]).sum();
            compliance.push(one);
            entries.iter().for_each(|&(freedom, _)| scratch[freedom] = 0.0);
        }
        if let Some(contact) = compliance.iter().position(|&d| d <= 0.0) {
            return Err(ContactError::Immovable { contact });
        }
        check_finite("the compliance of contacts", compliance)
    }

    /// How many contacts touch.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether nothing touches.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The number of freedoms.
    pub fn freedoms(&self) -> usize {
        self.freedoms
    }

    /// The differentials.
    pub fn rows(&self) -> &ContactRows {
        &self.rows
    }

    /// The restitution of each contact.
    pub fn restitution(&self) -> &[f64] {
        &self.restitution
    }

    /// How much an impulse of 1 N s at a contact changes its relative velocity, 1/kg.
    pub fn compliance(&self, contact: usize) -> f64 {
        self.compliance[contact]
    }

    /// The relative velocity of a contact, m/s.
    #[inline]
    pub fn relative_velocity(&self, contact: usize, v: Vector<&[f64]>) -> f64 {
        self.rows.along(contact, v)
    }

    /// Gives a contact an impulse: `v += M^-1 dg^T lambda`.
    #[inline]
    pub fn push(&self, contact: usize, lambda: f64, v: Vector<&mut [f64]>) {
        for (freedom, value) in self.lifted.row(contact) {
            v.0[freedom] += lambda * value;
        }
    }

    /// Relative velocities closer to zero than this are rounding: 1e-13 of the largest sum of the
    /// terms that they consist of, m/s.
    pub fn rounding(&self, v: Vector<&[f64]>) -> f64 {
        let terms = |i| self.rows.row(i).map(|(f, value)| (value * v.0[f]).abs()).sum::<f64>();
        1e-13 * (0..self.len()).map(terms).fold(0.0, f64::max)
    }

    /// How fast the fastest of the contacts closes, m/s; zero where none does.
    pub fn approach(&self, v: Vector<&[f64]>) -> f64 {
        (0..self.len()).map(|i| -self.relative_velocity(i, v)).fold(0.0, f64::max)
    }

    /// The change of kinetic energy by these impulses on the velocity `before`, J.
    pub fn energy_change(&self, impulses: &[f64], before: Vector<&[f64]>) -> f64 {
        let mut after = before.0.to_vec();
        for (contact, &lambda) in impulses.iter().enumerate() {
            self.push(contact, lambda, Vector(&mut after));
        }
        let mean = |i| {
            let after = self.relative_velocity(i, Vector(&after));
            0.5 * (self.relative_velocity(i, before) + after)
        };
        impulses.iter().enumerate().map(|(i, lambda)| lambda * mean(i)).sum()
    }

    /// The impulse that a contact on its own asks for: none unless it approaches.
    #[inline]
    pub fn single_impulse(&self, contact: usize, v: Vector<&[f64]>) -> f64 {
        let u = self.relative_velocity(contact, v);
        if u < 0.0 {
            -(1.0 + self.restitution[contact]) * u / self.compliance[contact]
        } else {
            0.0
        }
    }

    /// How a unit impulse at one contact changes the relative velocity of another, for the contacts
    /// in `others`, through a scratch vector of zeros that is left as zeros.
    pub(crate) fn couple(
        &self,
        contact: usize,
        others: &[usize],
        scratch: &mut [f64],
        out: &mut Vec<f64>,
    ) {
        self.push(contact, 1.0, Vector(scratch));
        out.extend(others.iter().map(|&other| self.rows.along(other, Vector(scratch))));
        self.lifted.row(contact).for_each(|(freedom, _)| scratch[freedom] = 0.0);
    }

    /// The movable freedoms that a contact reaches.
    pub(crate) fn reached(&self, contact: usize) -> impl Iterator<Item = usize> + '_ {
        self.lifted.row(contact).map(|(freedom, _)| freedom)
    }

    pub(crate) fn check_velocity(&self, v: &[f64]) -> Result<(), ContactError> {
        stationary_calculus::SizeError::check("velocities", self.freedoms, v.len())?;
        check_finite("the velocity", v)
    }
}

/// Room for one row after another.
#[derive(Debug, Default)]
pub(crate) struct Lifting {
    entries: Vec<(usize, f64)>,
    /// In which row a freedom was last met, and where its entry is.
    met: Vec<(usize, usize)>,
    /// A number a freedom, zero between rows.
    scratch: Vec<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use stationary_calculus::DiagonalMetric;

    fn ball_on_ball(c: f64) -> Result<Impact, ContactError> {
        let mass = InverseMass::of(&DiagonalMetric::new([2.0, 3.0]).unwrap()).unwrap();
        let mut rows = ContactRows::new();
        rows.push([(0, -1.0), (1, 1.0)]);
        Impact::new(rows, &mass, vec![c])
    }

    #[test]
    fn one_contact_separates_at_c_times_its_approach_and_pays_one_minus_c_squared() {
        for c in [0.0, 0.4, 1.0] {
            let impact = ball_on_ball(c).unwrap();
            let before = Vector([3.0, -1.0]);
            let lambda = impact.single_impulse(0, before.view());
            let mut after = before;
            impact.push(0, lambda, after.view_mut());
            let u = impact.relative_velocity(0, before.view());
            assert!((impact.relative_velocity(0, after.view()) + c * u).abs() < 1e-15);
            let kinetic = |v: Vector<[f64; 2]>| v.0[0] * v.0[0] + 1.5 * v.0[1] * v.0[1];
            let cost = -(1.0 - c * c) * u * u / (2.0 * impact.compliance(0));
            assert!((kinetic(after) - kinetic(before) - cost).abs() < 1e-14);
            assert!((impact.energy_change(&[lambda], before.view()) - cost).abs() < 1e-14);
            let momentum = |v: Vector<[f64; 2]>| 2.0 * v.0[0] + 3.0 * v.0[1];
            assert!((momentum(after) - momentum(before)).abs() < 1e-14);
        }
    }

    #[test]
    fn what_separates_is_left_alone() {
        let impact = ball_on_ball(0.5).unwrap();
        assert_eq!(impact.single_impulse(0, Vector([-1.0, 1.0]).view()), 0.0);
    }

    #[test]
    fn what_is_no_impact_is_refused_by_name() {
        for c in [-0.1, 1.1, f64::NAN] {
            let error = ball_on_ball(c).unwrap_err();
            assert!(matches!(error, ContactError::Restitution { contact: 0, .. }), "{error}");
        }
        let mass = InverseMass::of(&DiagonalMetric::new([1.0, 1.0]).unwrap()).unwrap();
        let row = |freedom, value| {
            let mut rows = ContactRows::new();
            rows.push([(freedom, value)]);
            rows
        };
        let held = mass.clone().holding([0]);
        let immovable = Impact::new(row(0, 1.0), &held, vec![0.0]).unwrap_err();
        assert_eq!(immovable, ContactError::Immovable { contact: 0 });
        let outside = Impact::new(row(2, 1.0), &mass, vec![0.0]).unwrap_err();
        assert!(matches!(outside, ContactError::NoSuchFreedom { freedom: 2, .. }));
        let nan = Impact::new(row(0, f64::NAN), &mass, vec![0.0]).unwrap_err();
        assert!(matches!(nan, ContactError::NonFinite { .. }));
    }
}
