//! Derivative checks: one line in a test that finds a wrong entry and names it.
//!
//! ```text
//! dV  against  (V(q + h w) - V(q - h w)) / (2 h)            each freedom, or random w
//! H w against  (dV(q + h w) - dV(q - h w)) / (2 h)          row by row, no dense H
//! [df] w against the same difference of f                   check_jacobian
//! B = B^T for each block that reaches the sink
//! ```
//! `V` joules, `w` a direction, `h` a range of steps over ten decades. The checks run at the given
//! configuration and at seeded random ones around it, near and far, so that neither a symmetric nor
//! an unstrained configuration hides a mistake. [`Ladder`](ladder) says how a derivative is measured
//! and how well it is known, [`examine`] how one wrong entry among thousands is found.
//!
//! An entry is wrong when it misses the measured one by a millionth of its row's largest entry or
//! more, beyond what truncation and rounding explain. Functions without truncation error (constant,
//! linear), of any magnitude, and far from the origin are judged at their rounding.
//!
//! What a check cannot see: errors below a millionth of the row's largest entry, so freedoms whose
//! units make their entries tiny beside others; entries below the function's own noise
//! ([`Report::unseen`] says how much); features far smaller than the typical length, 1 by default.
//! Where a function has a kink between the steps, it is checked on the near side; on the kink itself
//! (a contact that just touches) there is no derivative and the check may fail.
//!
//! On a curved space configurations move by [`Space::advance`] along unit velocities, and of the
//! Hessian the symmetric quadratic form is checked (see [`hessian`]).
//! Source: notes 2.5, 2.4, figure 2.1; errata chapter 2.
//!
//! ```
//! use stationary_calculus::{Covector, Potential, Sink, check_potential};
//! /// V = q^4, with a factor lost in the Hessian.
//! struct Quartic;
//! impl Potential for Quartic {
//!     fn dim(&self) -> usize {
//!         1
//!     }
//!     fn energy(&self, q: &[f64]) -> f64 {
//!         q[0].powi(4)
//!     }
//!     fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
//!         dv.0[0] += 4.0 * q[0].powi(3);
//!     }
//!     fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
//!         hessian.add_symmetric(&[0], &[6.0 * q[0].powi(2)]);
//!     }
//! }
//! let error = check_potential(&Quartic, &[1.0]).unwrap_err().to_string();
//! assert!(error.starts_with("the Hessian is wrong at row 0, column 0"));
//! assert!(error.contains("measured  2.000000 times the claim"));
//! ```

mod differences;
mod examine;
mod hessian;
mod ladder;
mod report;

use nalgebra::{DMatrix, DVectorView};

use crate::{Covector, Flat, Potential, SizeError, Space, SplitMix64, Vector, first_non_finite};
use examine::{Claim, Finding};
use hessian::{Blocks, Entries, QuadraticClaim};
use ladder::{SAFETY, Scale};

pub use differences::{Difference, Differences, differences};
pub use report::{Agreement, Derivative, DerivativeError, Report, WrongEntry};

/// Panics with the full message unless the potential's differential and Hessian are right.
#[track_caller]
pub fn assert_derivatives(potential: &impl Potential, q: &[f64]) {
    agrees(check_potential(potential, q));
}

/// [`assert_derivatives`] on a space where configurations do not add.
#[track_caller]
pub fn assert_derivatives_on(space: &impl Space, potential: &impl Potential, q: &[f64]) {
    agrees(check_potential_on(space, potential, q));
}

/// Panics with the full message unless `df` is the matrix of the differential of `f`.
#[track_caller]
pub fn assert_jacobian(
    f: impl Fn(&[f64]) -> Vec<f64>,
    df: impl Fn(&[f64]) -> DMatrix<f64>,
    q: &[f64],
) {
    agrees(check_jacobian(f, df, q));
}

#[track_caller]
fn agrees(checked: Result<Report, DerivativeError>) {
    if let Err(error) = checked {
        panic!("{error}");
    }
}

/// Checks a potential's differential and Hessian on flat space, with the default settings.
pub fn check_potential(potential: &impl Potential, q: &[f64]) -> Result<Report, DerivativeError> {
    DerivativeCheck::default().potential(potential, q)
}

/// Checks a potential's differential and Hessian on any space, with the default settings.
pub fn check_potential_on(
    space: &impl Space,
    potential: &impl Potential,
    q: &[f64],
) -> Result<Report, DerivativeError> {
    DerivativeCheck::default().potential_on(space, potential, q)
}

/// Checks the matrix of the differential of any function, with the default settings.
pub fn check_jacobian(
    f: impl Fn(&[f64]) -> Vec<f64>,
    df: impl Fn(&[f64]) -> DMatrix<f64>,
    q: &[f64],
) -> Result<Report, DerivativeError> {
    DerivativeCheck::default().jacobian(f, df, q)
}

/// The settings of a check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DerivativeCheck {
    /// Entries off by this much of their row's largest are found, where noise lets them.
    pub tolerance: f64,
    /// A typical length of the problem, in the units of q. Without one it is read off q: its
    /// magnitude, and 1.
    pub length: Option<f64>,
    /// Random configurations, beside the given one.
    pub configurations: usize,
    /// The seed of the random configurations and directions.
    pub seed: u64,
}

impl Default for DerivativeCheck {
    /// A millionth, the length that q shows, three random configurations.
    fn default() -> Self {
        DerivativeCheck { tolerance: 1e-6, length: None, configurations: 3, seed: 1 }
    }
}

/// How a Hessian is compared with differences.
#[derive(Clone, Copy)]
enum Comparison {
    /// Row by row, where velocities at neighbouring configurations are the same vectors.
    Rows,
    /// As a quadratic form.
    Form,
}

impl DerivativeCheck {
    /// Checks a potential's differential and Hessian on flat space.
    pub fn potential(
        &self,
        potential: &impl Potential,
        q: &[f64],
    ) -> Result<Report, DerivativeError> {
        self.compare(&Flat, potential, q, Comparison::Rows)
    }

    /// Checks a potential's differential and Hessian on any space.
    pub fn potential_on(
        &self,
        space: &impl Space,
        potential: &impl Potential,
        q: &[f64],
    ) -> Result<Report, DerivativeError> {
        self.compare(space, potential, q, Comparison::Form)
    }

    /// Checks the matrix of the differential of any function of q.
    pub fn jacobian(
        &self,
        f: impl Fn(&[f64]) -> Vec<f64>,
        df: impl Fn(&[f64]) -> DMatrix<f64>,
        q: &[f64],
    ) -> Result<Report, DerivativeError> {
        let n = q.len();
        let m = finite("the function", q, f(q))?.len();
        let mut random = SplitMix64::new(self.seed);
        let defined = |q: &[f64]| first_non_finite(&f(q)).is_none();
        let mut record = Record::new(Derivative::Jacobian, n);
        let all = self.configurations(&Flat, n, q, defined, &mut random);
        for (number, q) in all.into_iter().enumerate() {
            let matrix = df(&q);
            SizeError::check("the Jacobian's rows", m, matrix.nrows())?;
            SizeError::check("the Jacobian's columns", n, matrix.ncols())?;
            if let Some(place) = first_non_finite(matrix.as_slice()) {
                return Err(DerivativeError::NotFinite {
                    what: "the Jacobian",
                    place: place % m,
                    q,
                });
            }
            let largest: Vec<f64> = matrix.row_iter().map(|row| row.amax()).collect();
            let claim = Claim {
                freedoms: n,
                largest: &largest,
                floor: 0.0,
                value: &|w, h| f(&moved(&Flat, &q, w, h)),
                product: &|w| (&matrix * DVectorView::from_slice(w, n)).data.into(),
            };
            let scale = Scale::of(&q, self.length);
            record.add(claim.examine(&scale, self.tolerance, &mut random), &largest, number, &q)?;
            if number == 0 && n * m > 0 {
                let (row, column) = matrix.map(f64::abs).iamax_full();
                record.differences = claim.differences(&scale, row, column);
            }
        }
        Ok(Report { agreements: vec![record.agreement()] })
    }

    fn compare(
        &self,
        space: &impl Space,
        potential: &impl Potential,
        q: &[f64],
        comparison: Comparison,
    ) -> Result<Report, DerivativeError> {
        let n = potential.dim();
        SizeError::check("the configuration's numbers", space.stored(n), q.len())?;
        finite("the energy", q, vec![potential.energy(q)])?;
        let mut random = SplitMix64::new(self.seed);
        let defined = |q: &[f64]| potential.energy(q).abs() < 1e150;
        let mut first = Record::new(Derivative::Differential, n);
        let mut second = Record::new(Derivative::Hessian, n);
        let all = self.configurations(space, n, q, defined, &mut random);
        for (number, q) in all.into_iter().enumerate() {
            let scale = Scale::of(&q, self.length);
            let at = At { space, potential, q: &q, scale: &scale };

            let dv = finite("the differential", &q, at.differential(&q))?;
            let hessian = at.hessian(self.tolerance);
            let largest = [dv.iter().fold(0.0_f64, |m, x| m.max(x.abs()))];
            // Arguments are rounded by eps L, which at rest is all that the differential shows.
            let norm = hessian.as_ref().map_or(0.0, Entries::norm);
            let claim = Claim {
                freedoms: n,
                largest: &largest,
                floor: SAFETY * f64::EPSILON * scale.arguments * norm,
                value: &|w, h| vec![potential.energy(&moved(space, &q, w, h))],
                product: &|w| vec![Covector(&dv).apply(&Vector(w))],
            };
            first.add(claim.examine(&scale, self.tolerance, &mut random), &largest, number, &q)?;
            let place = dv.iter().position(|x| x.abs() == largest[0]);
            if let (0, Some(column)) = (number, place) {
                first.differences = claim.differences(&scale, 0, column);
            }

            let hessian = hessian?;
            let (finding, differences) = match comparison {
                Comparison::Rows => at.rows(&hessian, self.tolerance, &mut random),
                Comparison::Form => at.form(&hessian, self.tolerance, &mut random),
            };
            second.add(finding, &hessian.largest(), number, &q)?;
            if number == 0 {
                second.differences = differences;
            }
        }
        Ok(Report { agreements: vec![first.agreement(), second.agreement()] })
    }

    /// The given configuration and random ones: near it, around it, and a typical length away, moved
    /// less far where the function is not defined.
    fn configurations(
        &self,
        space: &impl Space,
        freedoms: usize,
        q: &[f64],
        defined: impl Fn(&[f64]) -> bool,
        random: &mut SplitMix64,
    ) -> Vec<Vec<f64>> {
        let Scale { near, far, .. } = Scale::of(q, self.length);
        let spreads = [near / 32.0, near / 4.0, far / 4.0].into_iter().cycle();
        let mut all = vec![q.to_vec()];
        for spread in spreads.take(self.configurations) {
            let w: Vec<f64> = (0..freedoms).map(|_| random.symmetric()).collect();
            let shorter = |k| moved(space, q, &w, spread * 0.25_f64.powi(k));
            all.extend((0..20).map(shorter).find(|q| defined(q)));
        }
        all
    }
}

/// A potential at one configuration.
struct At<'a, S, P> {
    space: &'a S,
    potential: &'a P,
    q: &'a [f64],
    scale: &'a Scale,
}

impl<S: Space, P: Potential> At<'_, S, P> {
    fn differential(&self, q: &[f64]) -> Vec<f64> {
        let mut dv = Covector(vec![0.0; self.potential.dim()]);
        self.potential.add_differential(q, dv.view_mut());
        dv.0
    }

    /// The Hessian, finite and with symmetric blocks.
    fn hessian(&self, tolerance: f64) -> Result<Entries, DerivativeError> {
        let freedoms = self.potential.dim();
        let mut blocks = Blocks::new(freedoms);
        self.potential.add_hessian(self.q, &mut blocks);
        if let Some(freedom) = blocks.unknown {
            return Err(DerivativeError::UnknownFreedom { freedom, freedoms });
        }
        if let Some((place, _)) = blocks.not_finite {
            let (what, q) = ("the Hessian", self.q.to_vec());
            return Err(DerivativeError::NotFinite { what, place, q });
        }
        match blocks.asymmetry {
            Some(worst) if worst.relative > 0.5 * tolerance => Err(DerivativeError::NotSymmetric {
                row: worst.row,
                column: worst.column,
                entry: worst.entry,
                mirror: worst.mirror,
            }),
            _ => Ok(blocks.sum()),
        }
    }

    fn rows(
        &self,
        hessian: &Entries,
        tolerance: f64,
        random: &mut SplitMix64,
    ) -> (Finding, Differences) {
        let largest = hessian.largest();
        let claim = Claim {
            freedoms: self.potential.dim(),
            largest: &largest,
            floor: 0.0,
            value: &|w, h| self.differential(&moved(self.space, self.q, w, h)),
            product: &|w| hessian.product(w),
        };
        let finding = claim.examine(self.scale, tolerance, random);
        let differences = match hessian.place_of_largest() {
            Some((row, column)) => claim.differences(self.scale, row, column),
            None => Differences::default(),
        };
        (finding, differences)
    }

    fn form(
        &self,
        hessian: &Entries,
        tolerance: f64,
        random: &mut SplitMix64,
    ) -> (Finding, Differences) {
        let value = |w: &[f64], h: f64| {
            Covector(self.differential(&moved(self.space, self.q, w, h))).apply(&Vector(w))
        };
        let claim = QuadraticClaim { hessian, value: &value, scale: self.scale };
        let finding = claim.examine(tolerance, random);
        let differences = match hessian.place_of_largest() {
            Some((row, _)) => claim.differences(row),
            None => Differences::default(),
        };
        (finding, differences)
    }
}

/// What is learned about one derivative, configuration by configuration.
struct Record {
    derivative: Derivative,
    freedoms: usize,
    configurations: usize,
    /// For each row, the relative error that may stay unseen at the best configuration so far.
    unseen: Vec<f64>,
    differences: Differences,
}

impl Record {
    fn new(derivative: Derivative, freedoms: usize) -> Self {
        let (unseen, differences) = (Vec::new(), Differences::default());
        Record { derivative, freedoms, configurations: 0, unseen, differences }
    }

    fn add(
        &mut self,
        finding: Finding,
        largest: &[f64],
        configuration: usize,
        q: &[f64],
    ) -> Result<(), DerivativeError> {
        if let Some(suspect) = finding.suspect {
            return Err(DerivativeError::Wrong(Box::new(WrongEntry {
                derivative: self.derivative,
                row: suspect.row,
                column: suspect.column,
                claimed: suspect.claimed,
                measured: suspect.measured.value,
                uncertainty: suspect.measured.bar,
                others: suspect.others,
                q: q.to_vec(),
                configuration,
                differences: suspect.differences,
            })));
        }
        self.configurations += 1;
        self.unseen.resize(largest.len(), f64::INFINITY);
        for ((best, unseen), largest) in self.unseen.iter_mut().zip(finding.unseen).zip(largest) {
            *best = best.min(unseen / largest);
        }
        Ok(())
    }

    /// Rows that are zero everywhere have no largest entry and do not count.
    fn agreement(self) -> Agreement {
        let Record { derivative, freedoms, configurations, unseen, differences } = self;
        let unseen = unseen.into_iter().filter(|x| x.is_finite()).fold(0.0, f64::max);
        Agreement { derivative, freedoms, configurations, unseen, differences }
    }
}

/// The configuration moved by h along w.
fn moved(space: &impl Space, q: &[f64], w: &[f64], h: f64) -> Vec<f64> {
    let mut q = q.to_vec();
    space.advance(&mut q, h, Vector(w));
    q
}

fn finite(what: &'static str, q: &[f64], numbers: Vec<f64>) -> Result<Vec<f64>, DerivativeError> {
    match first_non_finite(&numbers) {
        Some(place) => Err(DerivativeError::NotFinite { what, place, q: q.to_vec() }),
        None => Ok(numbers),
    }
}

#[cfg(test)]
mod tests;
