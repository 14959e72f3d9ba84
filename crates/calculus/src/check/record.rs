//! What is learned about one derivative, configuration by configuration.

use super::differences::Differences;
use super::finding::Finding;
use super::report::{Agreement, Derivative, DerivativeError, WrongEntry};

/// The findings so far, all of them right.
#[derive(Debug)]
pub(super) struct Record {
    derivative: Derivative,
    freedoms: usize,
    configurations: usize,
    /// For each row, the relative error that may stay unseen where it is seen best.
    unseen: Vec<Option<f64>>,
    differences: Differences,
}

impl Record {
    pub fn new(derivative: Derivative, freedoms: usize) -> Self {
        let (unseen, differences) = (Vec::new(), Differences::default());
        Record { derivative, freedoms, configurations: 0, unseen, differences }
    }

    /// Adds what was found at one more configuration, or says what is wrong there. The first one's
    /// `differences` are kept for the report.
    pub fn add(
        &mut self,
        finding: Finding,
        q: &[f64],
        differences: impl FnOnce() -> Option<Differences>,
    ) -> Result<(), DerivativeError> {
        if finding.worst.is_some() {
            return self.blame(finding, q, self.configurations);
        }
        if self.configurations == 0 {
            self.differences = differences().unwrap_or_default();
        }
        self.configurations += 1;
        self.unseen.resize(finding.unseen.len(), None);
        for (best, unseen) in self.unseen.iter_mut().zip(finding.unseen) {
            *best = [*best, unseen].into_iter().flatten().reduce(f64::min);
        }
        Ok(())
    }

    /// Says what is wrong at the configuration of this number.
    pub fn blame(
        &self,
        finding: Finding,
        q: &[f64],
        configuration: usize,
    ) -> Result<(), DerivativeError> {
        wrong(self.derivative, finding, q, configuration)
    }

    /// Says that this derivative, or the one that it is compared with, is wrong at the next
    /// configuration.
    pub fn blame_either(&self, finding: Finding, q: &[f64]) -> Result<(), DerivativeError> {
        wrong(Derivative::DifferentialOrHessian, finding, q, self.configurations)
    }
    /// How many configurations were found right.
    pub fn configurations(&self) -> usize {
        self.configurations
    }

    pub fn agreement(self) -> Agreement {
        Agreement {
            derivative: self.derivative,
            freedoms: self.freedoms,
            configurations: self.configurations,
            unseen: self.unseen.into_iter().flatten().fold(0.0, f64::max),
            differences: self.differences,
        }
    }
}

/// Nothing where nothing disagrees.
fn wrong(
    derivative: Derivative,
    finding: Finding,
    q: &[f64],
    configuration: usize,
) -> Result<(), DerivativeError> {
    let Some(worst) = finding.worst else { return Ok(()) };
    Err(DerivativeError::Wrong(Box::new(WrongEntry {
        derivative,
        row: worst.row,
        column: worst.column,
        claimed: worst.claimed,
        measured: worst.measured.value,
        uncertainty: worst.measured.bar,
        along: worst.along,
        others: finding.wrong.saturating_sub(1),
        q: q.to_vec(),
        configuration,
        differences: worst.differences,
    })))
}
