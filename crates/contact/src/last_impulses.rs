//! The impulses of the last step, found again by the identifiers of contacts.
//!
//! ```text
//! x = h/h_last (J.n, J.t1, J.t2)          what the last step's impulse J would be in this one
//! ```
//! `J` is kept in world axes (N s), so that tangents may be chosen afresh; a force that lasts gives
//! impulses in proportion to the step. Both lists of contacts are sorted.

use nalgebra::Vector3;

use crate::{ContactId, ContactPoint};

/// What contacts pushed in the last step.
#[derive(Clone, Debug, Default)]
pub(crate) struct LastImpulses {
    by_contact: Vec<(ContactId, Vector3<f64>)>,
    step: f64,
}

impl LastImpulses {
    /// A guess of the impulses in a step of `h` seconds: normal and tangents, zeros where a contact
    /// is new.
    pub(crate) fn guess(&self, contacts: &[ContactPoint], h: f64, x: &mut Vec<[f64; 3]>) {
        let mut last = self.by_contact.iter().peekable();
        let scale = h / self.step;
        x.clear();
        x.extend(contacts.iter().map(|contact| {
            while last.next_if(|(id, _)| *id < contact.id).is_some() {}
            let same = last.next_if(|(id, _)| *id == contact.id);
            let along = |impulse: &Vector3<f64>| {
                let [s, t] = contact.tangents();
                [contact.normal, s, t].map(|direction| scale * impulse.dot(&direction))
            };
            match same.map_or([0.0; 3], |(_, impulse)| along(impulse)) {
                [n, s, t] if n > 0.0 => [n, s, t],
                _ => [0.0; 3],
            }
        }));
    }

    /// Keeps the impulses of a step.
    pub(crate) fn keep(&mut self, contacts: &[ContactPoint], h: f64, x: &[[f64; 3]]) {
        self.step = h;
        self.by_contact.clear();
        let whole = |(contact, x): (&ContactPoint, &[f64; 3])| (contact.id, impulse(contact, x));
        self.by_contact.extend(contacts.iter().zip(x).map(whole));
    }
}

/// The impulse on the second body of a contact, world axes, N s.
pub(crate) fn impulse(contact: &ContactPoint, [n, s, t]: &[f64; 3]) -> Vector3<f64> {
    let [first, second] = contact.tangents();
    contact.normal * *n + first * *s + second * *t
}
