//! What the counted work of choosing was spent on.

use std::fmt;

/// What work is spent on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Purpose {
    /// Runs that the reference is made of.
    Reference,
    /// Runs of what may be chosen.
    Search,
    /// What is to be chosen, within its steps.
    WithinChoice,
    /// The reference, within these.
    WithinReference,
    /// Runs of another kind, to confirm the reference.
    Confirmation,
    /// These, within the steps of the choice.
    WithinOther,
    /// Runs on finer meshes.
    Mesh,
}

impl Purpose {
    /// All of them.
    pub const ALL: [Purpose; 7] = [
        Purpose::Reference,
        Purpose::Search,
        Purpose::WithinChoice,
        Purpose::WithinReference,
        Purpose::Confirmation,
        Purpose::WithinOther,
        Purpose::Mesh,
    ];

    /// In words.
    pub fn word(self) -> &'static str {
        match self {
            Purpose::Reference => "reference",
            Purpose::Search => "search",
            Purpose::WithinChoice => "within the choice's steps",
            Purpose::WithinReference => "the reference within them",
            Purpose::Confirmation => "confirmation",
            Purpose::WithinOther => "that within them",
            Purpose::Mesh => "finer meshes",
        }
    }
}

/// Counted work by purpose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort([u64; Purpose::ALL.len()]);

impl Effort {
    /// Adds work.
    pub fn add(&mut self, purpose: Purpose, work: u64) {
        self.0[purpose as usize] += work;
    }

    /// The work spent on one of them.
    pub fn on(&self, purpose: Purpose) -> u64 {
        self.0[purpose as usize]
    }

    /// All of it.
    pub fn total(&self) -> u64 {
        self.0.iter().sum()
    }

    /// In words, in runs of so much work.
    pub fn in_runs(&self, work: u64) -> impl fmt::Display {
        let runs = |purpose: &Purpose| self.on(*purpose) as f64 / work.max(1) as f64;
        let spent = Purpose::ALL.iter().filter(|purpose| self.on(**purpose) > 0);
        let parts: Vec<String> =
            spent.map(|purpose| format!("{} {:.1}", purpose.word(), runs(purpose))).collect();
        parts.join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_told_apart_by_what_it_was_spent_on() {
        let mut effort = Effort::default();
        effort.add(Purpose::Reference, 30);
        effort.add(Purpose::Search, 10);
        effort.add(Purpose::Reference, 5);
        assert_eq!((effort.on(Purpose::Reference), effort.total()), (35, 45));
        assert_eq!(effort.in_runs(10).to_string(), "reference 3.5, search 1.0");
    }
}
