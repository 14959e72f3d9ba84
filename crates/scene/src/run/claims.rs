//! What a run answers to the claims of its scene.

use crate::model::claim::{Claim, Event, Measured, SAME_TIME, Scale};
use crate::run::samples::Run;

/// A claim, and what the run has to say of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer<'a> {
    /// The claim.
    pub claim: &'a Claim,
    /// The number that was measured, where there is one.
    pub measured: Option<f64>,
    /// Whether it is what was claimed.
    pub verdict: Verdict,
}

/// Whether a claim is true of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It is.
    Holds,
    /// It is not.
    DoesNotHold,
    /// The run did not come so far, or took no sample at that time.
    NotReached,
}

impl Run {
    /// What the run says of each of the scene's claims, in their order.
    pub fn claims(&self) -> Vec<Answer<'_>> {
        self.scene().claims().iter().map(|claim| self.answer(claim)).collect()
    }

    fn answer<'a>(&self, claim: &'a Claim) -> Answer<'a> {
        let end = claim.until * (1.0 + SAME_TIME);
        let samples = self.times().iter().take_while(|&&time| time <= end).count();
        let last = samples.checked_sub(1).map_or(0.0, |last| self.times()[last]);
        let whole = last >= claim.until * (1.0 - SAME_TIME);
        let measured = match &claim.of {
            &Measured::Value { column, time } => self
                .sample_at(time, claim.until)
                .map(|sample| self.observed(sample).get(column).copied().unwrap_or(f64::NAN)),
            Measured::Time(event) => self.first(*event).filter(|&time| time <= end),
            over_time if whole => Some(self.over_time(over_time, samples)),
            _ => None,
        };
        let verdict = match measured {
            Some(measured) if (measured - claim.is).abs() <= claim.within => Verdict::Holds,
            Some(_) => Verdict::DoesNotHold,
            None if whole && matches!(claim.of, Measured::Time(_)) => Verdict::DoesNotHold,
            None => Verdict::NotReached,
        };
        Answer { claim, measured, verdict }
    }

    fn sample_at(&self, time: f64, horizon: f64) -> Option<usize> {
        let near = |&sampled: &f64| (sampled - time).abs() <= 2.0 * SAME_TIME * horizon;
        self.times().iter().position(near)
    }

    fn first(&self, event: Event) -> Option<f64> {
        match event {
            Event::FirstImpact => self.impacts().first().map(|impacts| impacts.time),
            Event::FirstBreak => self.broken().first().map(|broken| broken.time),
        }
    }

    /// What takes all of the first samples. A number that is not finite stays in the answer.
    fn over_time(&self, what: &Measured, samples: usize) -> f64 {
        let column = |column: usize| (0..samples).map(move |i| self.observed(i)[column]);
        let rows = || (0..samples).map(|i| self.observed(i));
        match what {
            &Measured::Least { column: c } => {
                -column(c).map(|x| -x).fold(f64::NEG_INFINITY, larger)
            }
            &Measured::Largest { column: c } => column(c).fold(f64::NEG_INFINITY, larger),
            &Measured::Rise { column: c } => {
                let mut least = f64::INFINITY;
                column(c).fold(0.0, |rise: f64, now| {
                    least = least.min(now);
                    larger(rise, now - least)
                })
            }
            Measured::Drift { columns, over } => {
                let start = &self.observed(0)[columns.clone()];
                let away = |row: &[f64]| -> f64 {
                    let row = row[columns.clone()].iter().zip(start);
                    row.map(|(now, start)| (now - start) * (now - start)).sum::<f64>().sqrt()
                };
                let size =
                    |row: &[f64]| row[columns.clone()].iter().map(|x| x * x).sum::<f64>().sqrt();
                let drift = rows().map(away).fold(0.0, larger);
                let scale = match over {
                    Scale::One => 1.0,
                    Scale::KineticEnergy => {
                        self.kinetic_energies()[..samples].iter().copied().fold(0.0, f64::max)
                    }
                    Scale::LinearMomentum => self.momentum_scales()[0],
                    Scale::AngularMomentum => self.momentum_scales()[1],
                    Scale::Itself => rows().map(size).fold(0.0, f64::max),
                };
                if scale > 0.0 { drift / scale } else { drift }
            }
            Measured::Value { .. } | Measured::Time(_) => f64::NAN,
        }
    }
}

/// The larger number, or the one that is none.
fn larger(most: f64, x: f64) -> f64 {
    if most.is_nan() || x <= most { most } else { x }
}
