//! A potential's differential against its energy, and its Hessian against its differential.

use super::bend::second_derivative;
use super::blocks::{Blocks, Entries, first_change};
use super::examine::{Claim, unit};
use super::finding::Finding;
use super::ladder::{Estimate, Ladder, SAFETY, Scale};
use super::quadratic::QuadraticClaim;
use super::record::Record;
use super::report::{Derivative, DerivativeError, Report};
use super::{DerivativeCheck, finite, moved};
use crate::{Covector, Potential, SizeError, Space, Vector};
use stationary_measure::SplitMix64;

/// How a Hessian is compared with differences.
#[derive(Clone, Copy)]
pub(super) enum Comparison {
    /// Row by row, where velocities at neighbouring configurations are the same vectors.
    Rows,
    /// As a quadratic form, on any space.
    Form,
}

/// Which of two derivatives that do not go together is wrong.
#[derive(Clone, Copy)]
enum Culprit {
    Differential,
    Hessian,
    /// Nothing tells.
    Either,
}

/// Entries of a row whose mirrors are looked at.
const MIRRORS: usize = 3;

/// A potential as the check asks it: by its address, so that the check is compiled once and not for
/// every potential.
pub(super) trait Examined {
    fn freedoms(&self) -> usize;
    fn energy_at(&self, q: &[f64]) -> f64;
    fn add_differential_at(&self, q: &[f64], dv: Covector<&mut [f64]>);
    fn add_hessian_at(&self, q: &[f64], blocks: &mut Blocks);
}

impl<P: Potential> Examined for P {
    fn freedoms(&self) -> usize {
        self.dim()
    }

    fn energy_at(&self, q: &[f64]) -> f64 {
        self.energy(q)
    }

    fn add_differential_at(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        self.add_differential(q, dv);
    }

    fn add_hessian_at(&self, q: &[f64], blocks: &mut Blocks) {
        self.add_hessian(q, blocks);
    }
}

pub(super) fn check(
    settings: &DerivativeCheck,
    space: &dyn Space,
    potential: &dyn Examined,
    q: &[f64],
    comparison: Comparison,
) -> Result<Report, DerivativeError> {
    settings.validate()?;
    let n = potential.freedoms();
    SizeError::check("the configuration's numbers", space.stored(n), q.len())?;
    finite("the energy", q, vec![potential.energy_at(q)])?;
    let mut random = SplitMix64::new(settings.seed);
    // Beyond that, differentials overflow where energies do not yet.
    let defined = |q: &[f64]| potential.energy_at(q).abs() < 1e150;
    let mut first = Record::new(Derivative::Differential, n);
    let mut second = Record::new(Derivative::Hessian, n);
    let mut visit = None;
    for q in settings.configurations(space, n, q, &defined, &mut random) {
        let scale = Scale::of(&q, settings.length);
        let at = At { space, potential, q: &q, scale: &scale, tolerance: settings.tolerance };
        // A wrong differential is the first thing to say, even where the Hessian is not usable.
        let hessian = at.hessian(&mut visit);
        let norm = hessian.as_ref().map_or(0.0, Entries::norm);
        at.check_differential(norm, &mut first, &mut random)?;
        let hessian = hessian?;
        match comparison {
            Comparison::Rows => at.check_rows(&hessian, [&mut first, &mut second], &mut random)?,
            Comparison::Form => at.check_form(&hessian, [&mut first, &mut second], &mut random)?,
        }
    }
    Ok(Report { agreements: vec![first.agreement(), second.agreement()] })
}

/// A potential at one configuration.
struct At<'a> {
    space: &'a dyn Space,
    potential: &'a dyn Examined,
    q: &'a [f64],
    scale: &'a Scale,
    tolerance: f64,
}

impl At<'_> {
    /// The configuration moved by h along w.
    fn moved(&self, w: &[f64], h: f64) -> Vec<f64> {
        moved(self.space, self.q, w, h)
    }

    fn differential(&self, q: &[f64]) -> Vec<f64> {
        self.added_to(q, vec![0.0; self.potential.freedoms()])
    }

    /// What becomes of numbers to which the differential is added.
    fn added_to(&self, q: &[f64], before: Vec<f64>) -> Vec<f64> {
        let mut dv = Covector(before);
        self.potential.add_differential_at(q, dv.view_mut());
        dv.0
    }

    /// The Hessian, finite and with symmetric blocks.
    fn hessian(&self, visit: &mut Option<Vec<usize>>) -> Result<Entries, DerivativeError> {
        let freedoms = self.potential.freedoms();
        let mut blocks = Blocks::new(freedoms);
        self.potential.add_hessian_at(self.q, &mut blocks);
        if let Some((block, freedoms, entries)) = blocks.misfit {
            return Err(DerivativeError::BlockSize { block, entries, freedoms });
        }
        let before = visit.get_or_insert_with(|| blocks.visit.clone());
        if let Some(block) = first_change(before, &blocks.visit) {
            return Err(DerivativeError::PatternChanged { block, q: self.q.to_vec() });
        }
        if let Some(freedom) = blocks.unknown {
            return Err(DerivativeError::UnknownFreedom { freedom, freedoms });
        }
        if let Some((place, _)) = blocks.not_finite {
            let (what, q) = ("the Hessian", self.q.to_vec());
            return Err(DerivativeError::NotFinite { what, place, q });
        }
        match blocks.asymmetry {
            Some(worst) if worst.relative > 0.5 * self.tolerance => {
                Err(DerivativeError::NotSymmetric {
                    row: worst.row,
                    column: worst.column,
                    entry: worst.entry,
                    mirror: worst.mirror,
                })
            }
            _ => Ok(blocks.sum()),
        }
    }

    /// The differential against the energy. Arguments are rounded by eps L, which moves the
    /// differential by the Hessian's norm times that: at rest it is all that there is of it.
    fn check_differential(
        &self,
        hessian_norm: f64,
        record: &mut Record,
        random: &mut SplitMix64,
    ) -> Result<(), DerivativeError> {
        let dv = finite("the differential", self.q, self.differential(self.q))?;
        let largest = dv.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        self.check_that_it_is_added(&dv, largest.max(hessian_norm * self.scale.arguments))?;
        let claim = Claim {
            freedoms: dv.len(),
            largest: &[largest],
            floor: SAFETY * f64::EPSILON * self.scale.arguments * hessian_norm,
            scale: self.scale,
            value: &|w, h| vec![self.potential.energy_at(&self.moved(w, h))],
            product: &|w| vec![Covector(&dv).apply(&Vector(w))],
        };
        let differences = || {
            let column = dv.iter().position(|x| x.abs() == largest)?;
            Some(claim.differences(0, column))
        };
        record.add(claim.examine(self.tolerance, random), self.q, differences)
    }

    /// Adds the differential to numbers far larger than its terms: they are still there, or were
    /// written over.
    fn check_that_it_is_added(&self, dv: &[f64], terms: f64) -> Result<(), DerivativeError> {
        let size = if terms > 0.0 { 1e3 * terms } else { 1.0 };
        let before: Vec<f64> =
            (0..dv.len()).map(|i| size * (1.0 + 0.25 * (i % 4) as f64)).collect();
        let after = self.added_to(self.q, before.clone());
        let kept = |i: usize| (after[i] - dv[i] - before[i]).abs() < 0.5 * before[i];
        match (0..dv.len()).find(|&i| !kept(i)).filter(|_| size.is_finite()) {
            Some(freedom) => Err(DerivativeError::Assigned { freedom }),
            None => Ok(()),
        }
    }

    /// Whose mistake it is that the Hessian is not the differential's derivative: the energy's second
    /// derivative tells, and where it is too noisy, the differential's own slopes, which are symmetric.
    fn blame(&self, finding: &mut Finding, hessian: &Entries, comparison: Comparison) -> Culprit {
        let Some(worst) = &mut finding.worst else { return Culprit::Hessian };
        let (i, j) = (worst.row, worst.column);
        let (claim, slope) = (worst.claimed, worst.measured.value);
        let Estimate { value, bar } = self.bend(i, j);
        let gap = (claim - slope).abs();
        let agrees = |other: f64| bar < 0.25 * gap && (other - value).abs() < 0.25 * gap;
        if agrees(claim) {
            worst.along = Some(j);
            (worst.row, worst.column) = (0, i);
            (worst.claimed, worst.measured) = (slope, Estimate { value, bar });
            return Culprit::Differential;
        }
        if agrees(slope) {
            return Culprit::Hessian;
        }
        let asymmetry = match comparison {
            Comparison::Rows => self.asymmetry(i, hessian),
            Comparison::Form => None,
        };
        match asymmetry {
            Some((along, slope, mirror)) => {
                worst.along = Some(along);
                (worst.row, worst.column) = (0, i);
                (worst.claimed, worst.measured) = (slope, mirror);
                Culprit::Differential
            }
            None => Culprit::Either,
        }
    }

    /// The second derivative of the energy by the freedoms i and j.
    fn bend(&self, i: usize, j: usize) -> Estimate {
        let n = self.potential.freedoms();
        let along = |w: &[f64]| {
            let energy = |h: f64| self.potential.energy_at(&self.moved(w, h));
            let steps = self.scale.steps(w);
            let range = (steps[0], steps[steps.len() - 1]);
            second_derivative(range, self.scale.arguments, energy)
        };
        let (one, other) = (along(&unit(n, i)), along(&unit(n, j)));
        if i == j {
            return one;
        }
        let both: Vec<f64> = (0..n).map(|k| f64::from(u8::from(k == i || k == j))).collect();
        let both = along(&both);
        let value = 0.5 * (both.value - one.value - other.value);
        Estimate { value, bar: 0.5 * (both.bar + one.bar + other.bar) }
    }

    /// A freedom k along which the differential's component i changes otherwise than component k does
    /// along i, where the Hessian sides with the latter: component i is no derivative of an energy. With
    /// both slopes.
    fn asymmetry(&self, i: usize, hessian: &Entries) -> Option<(usize, f64, Estimate)> {
        let n = self.potential.freedoms();
        let columns = |k: usize| {
            let w = unit(n, k);
            Ladder::climb(self.scale, &w, |h| self.differential(&self.moved(&w, h)))
        };
        let own = columns(i);
        hessian.largest_beside(i, MIRRORS).into_iter().find_map(|(k, entry)| {
            let (slope, mirror) = (columns(k).estimate(i), own.estimate(k));
            let gap = (slope.value - mirror.value).abs();
            let is_seen = gap > 4.0 * (slope.bar + mirror.bar);
            let sides = (entry - mirror.value).abs() < 0.25 * gap;
            (is_seen && sides).then_some((k, slope.value, mirror))
        })
    }

    /// The Hessian against the differential, row by row.
    fn check_rows(
        &self,
        hessian: &Entries,
        [first, second]: [&mut Record; 2],
        random: &mut SplitMix64,
    ) -> Result<(), DerivativeError> {
        let claim = Claim {
            freedoms: self.potential.freedoms(),
            largest: &hessian.largest(),
            floor: 0.0,
            scale: self.scale,
            value: &|w, h| self.differential(&self.moved(w, h)),
            product: &|w| hessian.product(w),
        };
        let differences = || {
            let (row, column) = hessian.place_of_largest()?;
            Some(claim.differences(row, column))
        };
        let mut finding = claim.examine(self.tolerance, random);
        match self.blame(&mut finding, hessian, Comparison::Rows) {
            Culprit::Differential => first.blame(finding, self.q, second.configurations()),
            Culprit::Either => second.blame_either(finding, self.q),
            Culprit::Hessian => second.add(finding, self.q, differences),
        }
    }

    /// The Hessian against the differential, as a quadratic form.
    fn check_form(
        &self,
        hessian: &Entries,
        [first, second]: [&mut Record; 2],
        random: &mut SplitMix64,
    ) -> Result<(), DerivativeError> {
        let claim = QuadraticClaim {
            hessian,
            largest: &hessian.largest(),
            scale: self.scale,
            value: &|w, h| Covector(self.differential(&self.moved(w, h))).apply(&Vector(w)),
        };
        let differences = || {
            let (row, _) = hessian.place_of_largest()?;
            Some(claim.differences(row))
        };
        let mut finding = claim.examine(self.tolerance, random);
        match self.blame(&mut finding, hessian, Comparison::Form) {
            Culprit::Differential => first.blame(finding, self.q, second.configurations()),
            Culprit::Either => second.blame_either(finding, self.q),
            Culprit::Hessian => second.add(finding, self.q, differences),
        }
    }
}
