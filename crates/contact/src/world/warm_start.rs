//! The impulses of the last step, found again by the identifiers of contacts.
//!
//! ```text
//! x = h/h_last (J.n, J.t1, J.t2)          what the last step's impulse J would be in this one
//! ```
//! `J` is kept in world axes (N s), so that tangents may be chosen afresh; a force that lasts gives
//! impulses in proportion to the step. Both lists of contacts are sorted. Nothing else is carried
//! from step to step, so that these numbers are all that a run needs beside its state to go on to
//! the same bits.

use stationary_integrators::StepError;

use crate::{ContactId, ContactIn, Dimension};

/// What contacts pushed in the last step.
#[derive(Clone, Debug)]
pub(crate) struct WarmStart<G: Dimension> {
    by_contact: Vec<(ContactId, G::Vector)>,
    step: f64,
}

/// Numbers of an identifier.
const NAMED: usize = 6;

impl<G: Dimension> Default for WarmStart<G> {
    fn default() -> Self {
        WarmStart { by_contact: Vec::new(), step: 0.0 }
    }
}

impl<G: Dimension> WarmStart<G> {
    /// A guess of each contact's impulse on its second body in a step of `h` seconds, world axes;
    /// none where a contact is new or does not push any more.
    #[inline]
    pub(crate) fn guess<'a>(
        &'a self,
        contacts: impl Iterator<Item = &'a ContactIn<G>>,
        h: f64,
    ) -> impl Iterator<Item = Option<G::Vector>> {
        let mut last = self.by_contact.iter().peekable();
        let scale = h / self.step;
        contacts.map(move |contact| {
            while last.next_if(|(id, _)| *id < contact.id).is_some() {}
            let (_, impulse) = last.next_if(|(id, _)| *id == contact.id)?;
            (G::dot(impulse, &contact.normal) > 0.0).then(|| *impulse * scale)
        })
    }

    /// How many contacts the step had.
    pub(crate) fn len(&self) -> usize {
        self.by_contact.len()
    }

    /// How long the step took whose impulses these are, s.
    pub(crate) fn step(&self) -> f64 {
        self.step
    }

    /// Keeps the impulses of a step of `h` seconds.
    #[inline]
    pub(crate) fn keep(&mut self, h: f64, impulses: impl Iterator<Item = (ContactId, G::Vector)>) {
        self.step = h;
        self.by_contact.clear();
        self.by_contact.extend(impulses);
    }

    /// Everything as numbers: the step, then the identifier and the impulse of each contact.
    pub(crate) fn save(&self) -> impl Iterator<Item = f64> {
        let numbers = self.by_contact.iter().flat_map(|(id, impulse)| {
            let names = [id.colliders, id.parts, id.features];
            let names = names.into_iter().flatten().map(f64::from);
            names.chain((0..G::TRANSLATION).map(|k| impulse[k]))
        });
        std::iter::once(self.step).chain(numbers)
    }

    /// What the numbers say that were saved. Contacts of one name follow each other, as they are found.
    pub(crate) fn load(numbers: &[f64]) -> Result<Self, StepError> {
        let refused = Err(StepError::Saved("it has numbers that no contacts leave behind"));
        let Some((&step, rest)) = numbers.split_first() else { return refused };
        let contacts = rest.chunks_exact(NAMED + G::TRANSLATION);
        if !contacts.remainder().is_empty() || !step.is_finite() {
            return refused;
        }
        let by_contact: Option<Vec<_>> = contacts.map(contact::<G>).collect();
        match by_contact {
            Some(by_contact) if by_contact.is_sorted_by(|a, b| a.0 <= b.0) => {
                match step > 0.0 || (step == 0.0 && by_contact.is_empty()) {
                    true => Ok(WarmStart { by_contact, step }),
                    false => refused,
                }
            }
            _ => refused,
        }
    }
}

/// An identifier and an impulse.
fn contact<G: Dimension>(numbers: &[f64]) -> Option<(ContactId, G::Vector)> {
    let whole = |&x: &f64| (f64::from(x as u32) == x).then_some(x as u32);
    let (names, components) = numbers.split_at(NAMED);
    let names: Vec<u32> = names.iter().map(whole).collect::<Option<_>>()?;
    let [a, b, c, d, e, f] = names[..] else { return None };
    let mut impulse = G::Vector::default();
    for (k, &component) in components.iter().enumerate().filter(|(_, x)| x.is_finite()) {
        impulse[k] = component;
    }
    let id = ContactId { colliders: [a, b], parts: [c, d], features: [e, f] };
    components.iter().all(|x| x.is_finite()).then_some((id, impulse))
}

#[cfg(all(test, feature = "2d"))]
mod tests {
    use super::*;

    type Last = WarmStart<crate::Planar>;

    #[test]
    fn what_was_saved_loads_to_the_same_and_numbers_that_were_not_saved_are_refused() {
        let id = |b| ContactId { colliders: [0, b], parts: [0, 3], features: [7, u32::MAX] };
        let mut last = Last::default();
        let impulse = nalgebra::Vector2::new(-0.3, 0.1);
        let all = |last: &Last| last.save().collect::<Vec<f64>>();
        assert_eq!(all(&Last::load(&all(&last)).unwrap()), all(&last));
        last.keep(1e-3, [(id(1), impulse), (id(2), impulse)].into_iter());
        let saved = all(&last);
        assert_eq!(all(&Last::load(&saved).unwrap()), saved);
        let changed = |place: usize, to: f64| {
            let mut other = saved.clone();
            other[place] = to;
            other
        };
        for bad in [
            saved[1..].to_vec(),
            Vec::new(),
            changed(0, 0.0),
            changed(0, f64::NAN),
            changed(1, 0.5),
            changed(1, -1.0),
            changed(2, 9.0),
            changed(7, f64::INFINITY),
        ] {
            assert!(matches!(Last::load(&bad), Err(StepError::Saved(_))), "{bad:?}");
        }
    }
}
