//! Differentials of gaps: sparse rows, one for each contact.
//!
//! ```text
//! u_i = dg_i v        the relative velocity of contact i, m/s; negative where it closes   (11.4.1)
//! p += lambda_i dg_i    an impulse of the contact, a covector
//! ```
//! Columns belong to the freedoms of velocities, so that `dg v` is the rate of the gap; a row names
//! the freedoms of the two bodies that meet, no others.

use stationary_calculus::{Covector, Vector};

use crate::ContactError;
use crate::error::check_finite;

/// The differentials of some gaps, row after row.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactRows {
    starts: Vec<usize>,
    freedoms: Vec<usize>,
    values: Vec<f64>,
}

impl Default for ContactRows {
    fn default() -> Self {
        ContactRows { starts: vec![0], freedoms: Vec::new(), values: Vec::new() }
    }
}

impl ContactRows {
    /// No rows yet.
    pub fn new() -> Self {
        ContactRows::default()
    }

    /// No rows yet, with room for some rows and entries.
    pub fn with_room(rows: usize, entries: usize) -> Self {
        let mut starts = Vec::with_capacity(rows + 1);
        starts.push(0);
        let (freedoms, values) = (Vec::with_capacity(entries), Vec::with_capacity(entries));
        ContactRows { starts, freedoms, values }
    }

    /// Removes all rows, and keeps their room.
    pub(crate) fn clear(&mut self) {
        self.starts.truncate(1);
        self.freedoms.clear();
        self.values.clear();
    }

    /// How many entries there are.
    pub fn entries(&self) -> usize {
        self.values.len()
    }

    /// Appends a row: pairs of a freedom and the derivative of the gap with respect to it.
    pub fn push(&mut self, entries: impl IntoIterator<Item = (usize, f64)>) {
        for (freedom, value) in entries {
            self.freedoms.push(freedom);
            self.values.push(value);
        }
        self.starts.push(self.freedoms.len());
    }

    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The entries of a row.
    #[inline]
    pub fn row(&self, contact: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.starts[contact]..self.starts[contact + 1];
        self.freedoms[range.clone()].iter().copied().zip(self.values[range].iter().copied())
    }

    /// The relative velocity `dg_i v`.
    #[inline]
    pub fn along(&self, contact: usize, v: Vector<&[f64]>) -> f64 {
        self.row(contact).map(|(freedom, value)| value * v.0[freedom]).sum()
    }

    /// Adds `scale dg_i` to a covector.
    #[inline]
    pub fn add_row(&self, contact: usize, scale: f64, p: Covector<&mut [f64]>) {
        for (freedom, value) in self.row(contact) {
            p.0[freedom] += scale * value;
        }
    }

    /// The rows in another order.
    pub fn reordered(&self, order: &[usize]) -> Self {
        let mut rows = ContactRows::new();
        order.iter().for_each(|&contact| rows.push(self.row(contact)));
        rows
    }

    /// An error unless every entry is finite and names one of the system's freedoms.
    pub(crate) fn check(&self, freedoms: usize) -> Result<(), ContactError> {
        check_finite("a gap's differential", &self.values)?;
        for contact in 0..self.len() {
            if let Some((freedom, _)) = self.row(contact).find(|&(f, _)| f >= freedoms) {
                return Err(ContactError::NoSuchFreedom { contact, freedom, freedoms });
            }
        }
        Ok(())
    }
}
