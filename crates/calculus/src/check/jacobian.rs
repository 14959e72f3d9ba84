//! The matrix of the differential of any function, against the function.

use std::cell::Cell;

use nalgebra::{DMatrix, DVectorView};

use super::examine::Claim;
use super::ladder::Scale;
use super::record::Record;
use super::report::{Derivative, DerivativeError, Report};
use super::{DerivativeCheck, finite, moved};
use crate::{Flat, SizeError, first_non_finite};
use stationary_measure::SplitMix64;

pub(super) fn check(
    settings: &DerivativeCheck,
    f: &dyn Fn(&[f64]) -> Vec<f64>,
    df: &dyn Fn(&[f64]) -> DMatrix<f64>,
    q: &[f64],
) -> Result<Report, DerivativeError> {
    settings.validate()?;
    let n = q.len();
    let m = finite("the function", q, f(q))?.len();
    let mut random = SplitMix64::new(settings.seed);
    // Who gives another number of values later is told so at the end.
    let other = Cell::new(m);
    let f = |q: &[f64]| {
        let value = f(q);
        if value.len() == m {
            return value;
        }
        other.set(value.len());
        vec![f64::NAN; m]
    };
    let defined = |q: &[f64]| first_non_finite(&f(q)).is_none();
    let mut record = Record::new(Derivative::Jacobian, n);
    for q in settings.configurations(&Flat, n, q, &defined, &mut random) {
        let matrix = df(&q);
        SizeError::check("the Jacobian's rows", m, matrix.nrows())?;
        SizeError::check("the Jacobian's columns", n, matrix.ncols())?;
        if let Some(place) = first_non_finite(matrix.as_slice()) {
            return Err(DerivativeError::NotFinite { what: "the Jacobian", place: place % m, q });
        }
        let largest: Vec<f64> = matrix.row_iter().map(|row| row.amax()).collect();
        let claim = Claim {
            freedoms: n,
            largest: &largest,
            floor: 0.0,
            scale: &Scale::of(&q, settings.length),
            value: &|w, h| f(&moved(&Flat, &q, w, h)),
            product: &|w| (&matrix * DVectorView::from_slice(w, n)).data.into(),
        };
        let differences = || {
            let place = matrix.iter().position(|entry| entry.abs() == matrix.amax())?;
            Some(claim.differences(place % m, place / m))
        };
        let finding = claim.examine(settings.tolerance, &mut random);
        SizeError::check("the function's numbers", m, other.get())?;
        record.add(finding, &q, differences)?;
    }
    SizeError::check("the function's numbers", m, other.get())?;
    Ok(Report { agreements: vec![record.agreement()] })
}
