//! What happened at an instant.

/// What happened at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// When, s.
    pub time: f64,
    /// What it was.
    pub kind: EventKind,
    /// The bodies of the contact that took the largest impulse; none where a fixed shape took part.
    pub bodies: [Option<usize>; 2],
    /// The kinetic energy that it took, J.
    pub energy: f64,
}

/// The kinds of events.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EventKind {
    /// Bodies hit each other.
    Impact,
    /// Contact lasts from here on.
    ContactStarts,
    /// Nothing touches any more.
    ContactEnds,
}
