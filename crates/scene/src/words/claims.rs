//! The word `claims`: what a scene says of its own run, and who says so.

use std::ops::Range;

use toml::Spanned;

use crate::model::claim::{Claim, Event, Measured, SAME_TIME, Scale};
use crate::model::observable::Observable;
use crate::model::scene::COORDINATES;
use crate::model::timing::Timing;
use crate::text::check;
use crate::text::diagnostic::{Checked, Located, at};
use crate::text::fault::ClaimFault;
use crate::text::number::Number;
use crate::words::draft::Draft;
use crate::words::observables::{self, ObservableDeclaration};
use crate::words::table::{Kind, table};

table! {
    /// A sentence about the run, which is checked at its end.
    pub(crate) struct ClaimDeclaration = "a claim" {
        /// What it is about: one of the scene's observables.
        of: Option<Spanned<ObservableDeclaration>> = Kind::Observable,
        /// Which component of it, where it has several; a drift is that of all together.
        component: Option<Spanned<String>> = Kind::OneOf(&["x", "y", "z"]),
        /// What is asked of it; `value` where it is missing. A drift is the largest distance from
        /// the start; relative to the largest kinetic energy, to the sums of the magnitudes of momenta, or of
        /// another observable to its own largest magnitude. A rise is the most by which it is above any earlier
        /// sample.
        what: Option<Spanned<String>> = Kind::OneOf(&["value", "least", "largest", "rise", "drift", "relative-drift"]),
        /// An event instead of an observable: its time is claimed.
        event: Option<Spanned<String>> = Kind::OneOf(&["first-impact", "first-break"]),
        /// When the value is taken, the time of a sample; at the end where it is missing.
        at: Option<Spanned<Number>> = Kind::NotNegative,
        /// What it is; of a drift and of a rise zero.
        is: Option<Spanned<Number>> = Kind::Number,
        /// How far off it may be.
        within: Spanned<Number> = Kind::NotNegative,
        /// Why that is so: a conservation law, a closed form, a measurement.
        source: Spanned<String> = Kind::Text,
    }
}

/// What may be asked of an observable.
#[derive(Clone, Copy, PartialEq, Eq)]
enum What {
    Value,
    Least,
    Largest,
    Rise,
    Drift,
    RelativeDrift,
}

const WHATS: [(&str, What); 6] = [
    ("value", What::Value),
    ("least", What::Least),
    ("largest", What::Largest),
    ("rise", What::Rise),
    ("drift", What::Drift),
    ("relative-drift", What::RelativeDrift),
];

const EVENTS: [(&str, Event); 2] =
    [("first-impact", Event::FirstImpact), ("first-break", Event::FirstBreak)];

/// The claims that are declared about these observables.
pub(crate) fn declare_all(
    declared: &[ClaimDeclaration],
    draft: &Draft<'_>,
    observed: &[Observable],
    timing: Timing,
) -> Checked<Vec<Claim>> {
    declared.iter().map(|one| declare(one, draft, observed, timing)).collect()
}

fn declare(
    declared: &ClaimDeclaration,
    draft: &Draft<'_>,
    observed: &[Observable],
    timing: Timing,
) -> Checked<Claim> {
    let within = check::finite("the band", &declared.within)?;
    if within < 0.0 {
        return Err(at(declared.within.span(), ClaimFault::NegativeBand(within)));
    }
    let source = check::title("a source", Some(&declared.source), "")?;
    let is = declared.is.as_ref().map(|is| check::finite("what is claimed", is)).transpose()?;
    let place = declared.source.span();
    let (of, needs_number) = match (&declared.of, &declared.event) {
        (Some(of), None) => of_observable(declared, of, draft, observed, timing)?,
        (None, Some(event)) => (Measured::Time(of_event(declared, event, draft)?), true),
        _ => return Err(at(place, ClaimFault::OfOrEvent)),
    };
    let is = match (is, needs_number) {
        (Some(is), true) => is,
        (None, false) => 0.0,
        (None, true) => return Err(at(place, ClaimFault::NothingClaimed)),
        (Some(_), false) => return Err(unasked("is", declared.is.as_ref().map(Spanned::span))),
    };
    Ok(Claim { of, is, within, source, until: timing.horizon() })
}

/// A key that the claim has no use for.
fn unasked(key: &'static str, place: Option<Range<usize>>) -> Box<Located> {
    at(place.unwrap_or_default(), ClaimFault::UnusedInClaim(key))
}

/// What is measured of an observable, and whether a number is claimed of it.
fn of_observable(
    declared: &ClaimDeclaration,
    of: &Spanned<ObservableDeclaration>,
    draft: &Draft<'_>,
    observed: &[Observable],
    timing: Timing,
) -> Checked<(Measured, bool)> {
    let observable = observables::declare_one(of, draft)?;
    let what = match &declared.what {
        Some(what) => check::word("claim", what.get_ref(), what.span(), &WHATS)?,
        None => What::Value,
    };
    let place = observed.iter().position(|&other| other == observable);
    let place = place.ok_or_else(|| at(of.span(), ClaimFault::ClaimOfUnobserved))?;
    let before: usize = observed[..place].iter().map(|o| o.columns(draft.dimension)).sum();
    let columns = before..before + observable.columns(draft.dimension);
    if let (Some(time), false) = (&declared.at, what == What::Value) {
        return Err(unasked("at", Some(time.span())));
    }
    if matches!(what, What::Drift | What::RelativeDrift) {
        if let Some(component) = &declared.component {
            return Err(unasked("component", Some(component.span())));
        }
        let over = match (what, observable) {
            (What::Drift, _) => Scale::One,
            (_, Observable::Energy | Observable::KineticEnergy | Observable::PotentialEnergy) => {
                Scale::KineticEnergy
            }
            (_, Observable::LinearMomentum) => Scale::LinearMomentum,
            (_, Observable::AngularMomentum) => Scale::AngularMomentum,
            _ => Scale::Itself,
        };
        return Ok((Measured::Drift { columns, over }, false));
    }
    let column = component(declared, of, &columns)?;
    Ok(match what {
        What::Least => (Measured::Least { column }, true),
        What::Largest => (Measured::Largest { column }, true),
        What::Rise => (Measured::Rise { column }, false),
        _ => {
            let time = declared.at.as_ref().map(|time| sampled(time, timing)).transpose()?;
            (Measured::Value { column, time: time.unwrap_or(timing.horizon()) }, true)
        }
    })
}

/// The one of the columns that is meant.
fn component(
    declared: &ClaimDeclaration,
    of: &Spanned<ObservableDeclaration>,
    columns: &Range<usize>,
) -> Checked<usize> {
    let several = columns.len() > 1;
    match (&declared.component, several) {
        (Some(word), true) => {
            let axes: Vec<_> = COORDINATES.into_iter().zip(columns.clone()).collect();
            check::word("component", word.get_ref(), word.span(), &axes)
        }
        (Some(word), false) => Err(unasked("component", Some(word.span()))),
        (None, true) => Err(at(of.span(), ClaimFault::NoComponent(columns.len()))),
        (None, false) if columns.is_empty() => Err(at(of.span(), ClaimFault::NoComponent(0))),
        (None, false) => Ok(columns.start),
    }
}

/// The time of a sample.
fn sampled(time: &Spanned<Number>, timing: Timing) -> Checked<f64> {
    let t = check::finite("the time of a claim", time)?;
    let (horizon, every) = (timing.horizon(), timing.step() * timing.sample_every() as f64);
    let same = SAME_TIME * horizon;
    if !(-same..=horizon + same).contains(&t) {
        return Err(at(time.span(), ClaimFault::ClaimBeyond { time: t, horizon }));
    }
    let nearest = (t / every).round() * every;
    if (t - nearest).abs() > same && (t - horizon).abs() > same {
        return Err(at(time.span(), ClaimFault::ClaimBetweenSamples { time: t, nearest }));
    }
    Ok(t)
}

/// An event that may happen in the scene.
fn of_event(
    declared: &ClaimDeclaration,
    event: &Spanned<String>,
    draft: &Draft<'_>,
) -> Checked<Event> {
    let keys = [
        ("component", declared.component.as_ref().map(Spanned::span)),
        ("what", declared.what.as_ref().map(Spanned::span)),
        ("at", declared.at.as_ref().map(Spanned::span)),
    ];
    if let Some((key, place)) = keys.into_iter().find(|(_, place)| place.is_some()) {
        return Err(unasked(key, place));
    }
    let found = check::word("event", event.get_ref(), event.span(), &EVENTS)?;
    let possible = match found {
        Event::FirstImpact => draft.contact.as_ref().is_some_and(|c| c.stiffness.is_none()),
        Event::FirstBreak => draft.rods.iter().any(|rod| rod.strength.is_finite()),
    };
    if !possible {
        return Err(at(event.span(), ClaimFault::NoSuchEvent(event.get_ref().clone())));
    }
    Ok(found)
}
