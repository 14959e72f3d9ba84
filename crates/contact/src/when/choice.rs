//! The three choices of when an impulse is given (notes 11.4).

/// When an impulse is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum When {
    /// At the end of a step at which things overlap.
    AfterOverlap,
    /// At the moment within the step at which they touch.
    AtTheInstant,
    /// Before a step that would make them overlap.
    VelocityFilter,
}

impl When {
    /// All three, in the order of the notes.
    pub const ALL: &'static [When] =
        &[When::AfterOverlap, When::AtTheInstant, When::VelocityFilter];

    /// Its name, lower case and with hyphens.
    pub fn name(self) -> &'static str {
        match self {
            When::AfterOverlap => "after-overlap",
            When::AtTheInstant => "at-the-instant",
            When::VelocityFilter => "velocity-filter",
        }
    }
}
