//! What takes part in a contact, by its place in the scene.

use serde::Serialize;

/// What takes part in a contact. What does not move comes first in the order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub enum ContactSide {
    /// A wall of [`SceneContact`](crate::SceneContact), by its place there.
    Wall(usize),
    /// A ball of [`SceneContact`](crate::SceneContact), by its place there.
    Ball(usize),
    /// A particle that is pinned, by its place in [`Scene::particles`](crate::Scene::particles).
    Pin(usize),
    /// A body, by its place in [`Scene::bodies`](crate::Scene::bodies).
    Body(usize),
    /// A particle that moves, by its place in [`Scene::particles`](crate::Scene::particles).
    Particle(usize),
}

impl ContactSide {
    pub(crate) fn moves(self) -> bool {
        matches!(self, ContactSide::Body(_) | ContactSide::Particle(_))
    }

    /// Its kind and its place, as a checkpoint writes them.
    pub(crate) fn numbers(self) -> (u64, usize) {
        match self {
            ContactSide::Wall(place) => (0, place),
            ContactSide::Ball(place) => (1, place),
            ContactSide::Pin(place) => (2, place),
            ContactSide::Body(place) => (3, place),
            ContactSide::Particle(place) => (4, place),
        }
    }

    /// The side of this kind and place.
    pub(crate) fn of_numbers(kind: u64, place: usize) -> Option<Self> {
        let kinds: [fn(usize) -> ContactSide; 5] = [
            ContactSide::Wall,
            ContactSide::Ball,
            ContactSide::Pin,
            ContactSide::Body,
            ContactSide::Particle,
        ];
        kinds.get(usize::try_from(kind).ok()?).map(|side| side(place))
    }
}
