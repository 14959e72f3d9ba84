//! Derivative checks: one line in a test that finds a wrong entry and names it.
//!
//! ```text
//! dV     against  (V(q + h w) - V(q - h w)) / (2 h)         each freedom, or random w
//! H w    against  (dV(q + h w) - dV(q - h w)) / (2 h)       row by row, no dense H
//! [df] w against  (f(q + h w) - f(q - h w)) / (2 h)
//! B = B^T for each block that reaches the sink
//! ```
//! `V` joules, `w` a direction, `h` a range of steps over ten decades. The parts, from below:
//!
//! - `ladder`: one direction, all steps; a derivative and how well it is known.
//! - `examine`, `quadratic`: a claimed derivative against ladders; one wrong entry among thousands.
//! - `blocks`: the Hessian as it arrives. `bend`: which of two derivatives belongs to the energy.
//! - `potential`, `jacobian`: what is compared with what, at which configurations.
//! - `finding`, `record`, `report`: what is said of it. `differences`: figure 2.1.
//!
//! Source: notes 2.4, 2.5, figure 2.1; errata chapter 2.

mod bend;
mod blocks;
mod differences;
mod examine;
mod finding;
mod jacobian;
mod ladder;
mod potential;
mod quadratic;
mod record;
mod report;

use nalgebra::DMatrix;

use crate::{Flat, Potential, Space, Vector, first_non_finite};
use examine::part;
use ladder::Scale;
use potential::Comparison;
use stationary_measure::SplitMix64;

pub use differences::{Difference, Differences, differences};
pub use report::{Agreement, Derivative, DerivativeError, Report, WrongEntry};

/// Panics with the full message unless the potential's differential and Hessian are right; see
/// [`DerivativeCheck`] for what right means.
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
///
/// ```
/// use stationary_calculus::{Covector, Potential, Sink, check_potential};
/// /// V = q^4, with a factor lost in the Hessian.
/// struct Quartic;
/// impl Potential for Quartic {
///     fn dim(&self) -> usize {
///         1
///     }
///     fn energy(&self, q: &[f64]) -> f64 {
///         q[0].powi(4)
///     }
///     fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
///         dv.0[0] += 4.0 * q[0].powi(3);
///     }
///     fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
///         hessian.add_symmetric(&[0], &[6.0 * q[0].powi(2)]);
///     }
/// }
/// let error = check_potential(&Quartic, &[1.0]).unwrap_err().to_string();
/// assert!(error.starts_with("the Hessian is wrong at row 0, column 0"));
/// assert!(error.contains("measured  2.000000 times the claim"));
/// ```
///
/// # Errors
/// Those of [`DerivativeCheck::potential`] but for the settings, which are valid.
pub fn check_potential(potential: &impl Potential, q: &[f64]) -> Result<Report, DerivativeError> {
    DerivativeCheck::default().potential(potential, q)
}

/// Checks a potential's differential and Hessian on any space, with the default settings.
///
/// # Errors
/// Those of [`DerivativeCheck::potential_on`] but for the settings, which are valid.
pub fn check_potential_on(
    space: &impl Space,
    potential: &impl Potential,
    q: &[f64],
) -> Result<Report, DerivativeError> {
    DerivativeCheck::default().potential_on(space, potential, q)
}

/// Checks the matrix of the differential of any function, with the default settings.
///
/// # Errors
/// Those of [`DerivativeCheck::jacobian`] but for the settings, which are valid.
pub fn check_jacobian(
    f: impl Fn(&[f64]) -> Vec<f64>,
    df: impl Fn(&[f64]) -> DMatrix<f64>,
    q: &[f64],
) -> Result<Report, DerivativeError> {
    DerivativeCheck::default().jacobian(f, df, q)
}

/// A check of derivatives, and its settings.
///
/// It compares at the given configuration and at seeded random ones: near it, and away from it by half a
/// typical length to a whole one in every freedom, once to either side, so that neither symmetry nor rest
/// nor a branch hides a mistake. An entry is wrong when it misses
/// the measured one by a millionth of its row's largest entry or more (a differential is one row),
/// beyond what truncation and rounding explain. Functions without truncation error, of any
/// magnitude, and far from the origin are judged at their rounding. The differential must be added to
/// what is there, and the Hessian's blocks must come in one order at all configurations. Where a Hessian
/// and a differential do not go together, the energy's second derivative says which of them is wrong, or
/// the symmetry of the differential's slopes; where the energy is too noisy for the one and the other shows
/// nothing, neither is blamed ([`Derivative::DifferentialOrHessian`]).
///
/// What it cannot see:
/// - errors below a millionth of the row's largest entry: freedoms whose units make their entries
///   tiny beside the others of their row hide theirs;
/// - where no length is given and all of q is below a millionth, what is farther away than q is large,
///   and errors below the rounding of a body of length 1, whose displacements q may be: give the length;
/// - errors below the function's own noise, if a large constant or cancellation makes it noisy:
///   [`Report::unseen`] says how large, and a caller who wants to be sure looks at it;
/// - features far smaller than the typical length (by ten decades; far from the origin, than q by
///   ten decades): give the length;
/// - kinks. The check judges the side of a kink that it stands on; within a few roundings of one (a
///   contact that just touches) there is no derivative to compare, and it may fail.
///
/// A Hessian that is projected on purpose is not the second derivative, and fails.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DerivativeCheck {
    /// Entries off by this much of their row's largest are found, where noise lets them.
    pub tolerance: f64,
    /// A typical length of the problem, in the units of q, positive. Without one it is read off q:
    /// its magnitude, and 1.
    pub length: Option<f64>,
    /// At most so many random configurations, beside the given one: one near it; two away from it by
    /// the magnitude of q; two by 1, where that is more than twice as far. Where it is less, these two
    /// stand for both.
    pub configurations: usize,
    /// The seed of the random configurations and directions.
    pub seed: u64,
}

impl Default for DerivativeCheck {
    /// A millionth, the length that q shows, five random configurations.
    fn default() -> Self {
        DerivativeCheck { tolerance: 1e-6, length: None, configurations: 5, seed: 1 }
    }
}

impl DerivativeCheck {
    /// Checks a potential's differential and Hessian on flat space.
    ///
    /// # Errors
    /// [`DerivativeError::Setting`] out of range; [`DerivativeError::Size`] unless q stores a
    /// configuration; [`DerivativeError::NotFinite`] for the energy at q, a differential or a
    /// Hessian. All other variants for derivatives that are wrong.
    pub fn potential(
        &self,
        potential: &impl Potential,
        q: &[f64],
    ) -> Result<Report, DerivativeError> {
        potential::check(self, &Flat, potential, q, Comparison::Rows)
    }

    /// Checks a potential's differential and Hessian on any space. Configurations move by
    /// [`Space::advance`]; of the Hessian the quadratic form `w^T H w` is compared with the second
    /// derivative of V along the motion w, which determines the symmetric H.
    ///
    /// # Errors
    /// Those of [`DerivativeCheck::potential`].
    pub fn potential_on(
        &self,
        space: &impl Space,
        potential: &impl Potential,
        q: &[f64],
    ) -> Result<Report, DerivativeError> {
        potential::check(self, space, potential, q, Comparison::Form)
    }

    /// Checks the matrix of the differential of any function of q, M x N for M numbers.
    ///
    /// # Errors
    /// [`DerivativeError::Setting`] out of range; [`DerivativeError::Size`] where the matrix is not
    /// M x N or the number of values changes; [`DerivativeError::NotFinite`] for the values at q or
    /// a matrix; [`DerivativeError::Wrong`] for an entry that disagrees with differences.
    pub fn jacobian(
        &self,
        f: impl Fn(&[f64]) -> Vec<f64>,
        df: impl Fn(&[f64]) -> DMatrix<f64>,
        q: &[f64],
    ) -> Result<Report, DerivativeError> {
        jacobian::check(self, &f, &df, q)
    }

    /// An error unless the settings are numbers that a check can use.
    fn validate(&self) -> Result<(), DerivativeError> {
        let setting = |setting, value, rule| Err(DerivativeError::Setting { setting, value, rule });
        if !(self.tolerance > 0.0 && self.tolerance < 1.0) {
            return setting("tolerance", self.tolerance, "positive and below 1");
        }
        match self.length {
            Some(length) if !(length > 0.0 && (1e-250..1e250).contains(&length)) => {
                setting("length", length, "positive, and between 1e-250 and 1e250")
            }
            _ => Ok(()),
        }
    }

    /// The given configuration and random ones: near it, and a typical length away to either side, moved
    /// less far where the function is not defined.
    fn configurations(
        &self,
        space: &dyn Space,
        freedoms: usize,
        q: &[f64],
        defined: &dyn Fn(&[f64]) -> bool,
        random: &mut SplitMix64,
    ) -> Vec<Vec<f64>> {
        let Scale { near, far, .. } = Scale::of(q, self.length);
        let near_by: Vec<f64> = (0..freedoms).map(|_| random.symmetric()).collect();
        let away: Vec<f64> = (0..freedoms)
            .map(|_| {
                let way = random.symmetric();
                way.signum() * (0.5 + 0.5 * way.abs())
            })
            .collect();
        // A problem so small that q is below a millionth is another one at a distance of 1.
        let spreads: &[f64] = if near <= 1e-6 && near < far {
            &[near / 32.0, near, -near]
        } else if far > 2.0 * near {
            &[near / 32.0, near, -near, far, -far]
        } else {
            &[near / 32.0, far, -far]
        };
        let another = |&spread: &f64| {
            let w = if spread.abs() < near { &near_by } else { &away };
            as_far_as_defined(space, q, w, spread, defined)
        };
        let others = spreads.iter().take(self.configurations);
        std::iter::once(q.to_vec()).chain(others.map(another)).collect()
    }
}

/// Groups of freedoms that are moved apart from each other where they cannot be moved together.
const GROUPS: usize = 64;

/// The configuration moved by h along w; where the function is not defined there, half by half of the
/// freedoms, and a group of them that meets the edge of what is defined less far than to the edge, so
/// that the others have room: one freedom beside a wall does not hold back all.
fn as_far_as_defined(
    space: &dyn Space,
    q: &[f64],
    w: &[f64],
    h: f64,
    defined: &dyn Fn(&[f64]) -> bool,
) -> Vec<f64> {
    let smallest = w.len().div_ceil(GROUPS).max(1);
    let mut here = q.to_vec();
    let mut groups = vec![(0, w.len())];
    while let Some((from, to)) = groups.pop() {
        let group = part(w, from, to);
        let next = moved(space, &here, &group, h);
        if defined(&next) {
            here = next;
        } else if to - from > smallest {
            let middle = usize::midpoint(from, to);
            groups.extend([(middle, to), (from, middle)]);
        } else {
            let shorter = |k: i32| moved(space, &here, &group, h * 0.25_f64.powi(k));
            let inside = (1..20).find(|&k| defined(&shorter(k)));
            let well_inside = inside.map(|k| shorter(k + 1)).filter(|q| defined(q));
            here = well_inside.unwrap_or(here);
        }
    }
    here
}

/// The configuration moved by h along w.
fn moved(space: &dyn Space, q: &[f64], w: &[f64], h: f64) -> Vec<f64> {
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
