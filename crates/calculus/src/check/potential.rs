//! A potential's differential against its energy, and its Hessian against its differential.

use super::blocks::{Blocks, Entries};
use super::examine::Claim;
use super::ladder::{SAFETY, Scale};
use super::quadratic::QuadraticClaim;
use super::record::Record;
use super::report::{Derivative, DerivativeError, Report};
use super::{DerivativeCheck, finite, moved};
use crate::{Covector, Potential, SizeError, Space, SplitMix64, Vector};

/// How a Hessian is compared with differences.
#[derive(Clone, Copy)]
pub(super) enum Comparison {
    /// Row by row, where velocities at neighbouring configurations are the same vectors.
    Rows,
    /// As a quadratic form, on any space.
    Form,
}

pub(super) fn check(
    settings: &DerivativeCheck,
    space: &impl Space,
    potential: &impl Potential,
    q: &[f64],
    comparison: Comparison,
) -> Result<Report, DerivativeError> {
    let n = potential.dim();
    SizeError::check("the configuration's numbers", space.stored(n), q.len())?;
    finite("the energy", q, vec![potential.energy(q)])?;
    let mut random = SplitMix64::new(settings.seed);
    // Beyond that, differentials overflow where energies do not yet.
    let defined = |q: &[f64]| potential.energy(q).abs() < 1e150;
    let mut first = Record::new(Derivative::Differential, n);
    let mut second = Record::new(Derivative::Hessian, n);
    for q in settings.configurations(space, n, q, defined, &mut random) {
        let scale = Scale::of(&q, settings.length);
        let at = At { space, potential, q: &q, scale: &scale, tolerance: settings.tolerance };
        // A wrong differential is the first thing to say, even where the Hessian is not usable.
        let hessian = at.hessian();
        let norm = hessian.as_ref().map_or(0.0, Entries::norm);
        at.check_differential(norm, &mut first, &mut random)?;
        match comparison {
            Comparison::Rows => at.check_rows(&hessian?, &mut second, &mut random)?,
            Comparison::Form => at.check_form(&hessian?, &mut second, &mut random)?,
        }
    }
    Ok(Report { agreements: vec![first.agreement(), second.agreement()] })
}

/// A potential at one configuration.
struct At<'a, S, P> {
    space: &'a S,
    potential: &'a P,
    q: &'a [f64],
    scale: &'a Scale,
    tolerance: f64,
}

impl<S: Space, P: Potential> At<'_, S, P> {
    /// The configuration moved by h along w.
    fn moved(&self, w: &[f64], h: f64) -> Vec<f64> {
        moved(self.space, self.q, w, h)
    }

    fn differential(&self, q: &[f64]) -> Vec<f64> {
        let mut dv = Covector(vec![0.0; self.potential.dim()]);
        self.potential.add_differential(q, dv.view_mut());
        dv.0
    }

    /// The Hessian, finite and with symmetric blocks.
    fn hessian(&self) -> Result<Entries, DerivativeError> {
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
        let claim = Claim {
            freedoms: dv.len(),
            largest: &[largest],
            floor: SAFETY * f64::EPSILON * self.scale.arguments * hessian_norm,
            scale: self.scale,
            value: &|w, h| vec![self.potential.energy(&self.moved(w, h))],
            product: &|w| vec![Covector(&dv).apply(&Vector(w))],
        };
        let differences = || {
            let column = dv.iter().position(|x| x.abs() == largest)?;
            Some(claim.differences(0, column))
        };
        record.add(claim.examine(self.tolerance, random), self.q, differences)
    }

    /// The Hessian against the differential, row by row.
    fn check_rows(
        &self,
        hessian: &Entries,
        record: &mut Record,
        random: &mut SplitMix64,
    ) -> Result<(), DerivativeError> {
        let claim = Claim {
            freedoms: self.potential.dim(),
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
        record.add(claim.examine(self.tolerance, random), self.q, differences)
    }

    /// The Hessian against the differential, as a quadratic form.
    fn check_form(
        &self,
        hessian: &Entries,
        record: &mut Record,
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
        record.add(claim.examine(self.tolerance, random), self.q, differences)
    }
}
