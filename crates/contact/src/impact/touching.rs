//! What an impact reads of contacts, in room that is kept.

use crate::impact::rounds::Given;
use crate::{ContactIn, ContactRows, Dimension, Touch};

/// Contacts, and what an impact reads of them.
#[derive(Debug)]
pub(crate) struct Touching<G: Dimension> {
    pub(crate) contacts: Vec<ContactIn<G>>,
    pub(crate) rows: ContactRows,
    /// Rows across each contact; none where nothing rubs.
    pub(crate) across: ContactRows,
    pub(crate) gap: Vec<f64>,
    pub(crate) friction: Vec<f64>,
    pub(crate) restitution: Vec<f64>,
}

impl<G: Dimension> Default for Touching<G> {
    fn default() -> Self {
        Touching {
            contacts: Vec::new(),
            rows: ContactRows::new(),
            across: ContactRows::new(),
            gap: Vec::new(),
            friction: Vec::new(),
            restitution: Vec::new(),
        }
    }
}

impl<G: Dimension> Touching<G> {
    /// Takes over what was found at a configuration, with the gap of each.
    pub(crate) fn fill(
        &mut self,
        contacts: &[ContactIn<G>],
        q: &[f64],
        gap: impl Fn(&ContactIn<G>) -> f64,
    ) {
        self.contacts.clear();
        self.contacts.extend_from_slice(contacts);
        self.rows.clear();
        contacts.iter().for_each(|contact| contact.push_row(q, &mut self.rows));
        self.across.clear();
        if contacts.iter().any(|contact| contact.friction > 0.0) {
            contacts.iter().for_each(|contact| contact.push_tangents(q, &mut self.across));
        }
        self.gap.clear();
        self.gap.extend(contacts.iter().map(gap));
        self.friction.clear();
        self.friction.extend(contacts.iter().map(|contact| contact.friction));
        self.restitution.clear();
        self.restitution.extend(contacts.iter().map(|contact| contact.restitution));
    }

    /// The contacts with what an impact gave each.
    pub(crate) fn pushed(&self, given: &Given) -> impl Iterator<Item = Touch<G>> {
        let across = given.friction.len() / self.contacts.len();
        self.contacts.iter().zip(&given.normal).enumerate().map(move |(i, (&contact, &impact))| {
            let rubbed = contact.tangents().zip(&given.friction[across * i..][..across]);
            let friction = rubbed
                .fold(G::Vector::default(), |sum, (tangent, &impulse)| sum + tangent * impulse);
            let moment = G::Spin::default();
            Touch { contact, impact, normal: 0.0, friction, moment }
        })
    }
}
