//! The entries of S: products of the equations' rows over masses.
//!
//! ```text
//! S = sum over freedoms f of  J_f J_f^T / m_f         m x m, sparse, symmetric
//! ```
//! `J_f` the column of a freedom, `m_f` its mass. Products of a group of freedoms that the same equations touch are
//! summed before they go to S. Where they go is found once.

use std::sync::Arc;

use crate::elimination::Elimination;
use crate::entries::{Block, Entries};

/// Which entries make S. Copies share it.
#[derive(Clone, Debug)]
pub(crate) struct Products {
    /// Of each group where the products of two equations go, first those of the first with itself.
    slots: Arc<[u32]>,
}

/// Adds the products of rows of F numbers over masses, each with itself and those before it.
#[inline]
fn add_products<const F: usize>(
    block: &Block<'_>,
    inverse_mass: &[f64],
    mut slots: &[u32],
    values: &mut [f64],
) {
    let Some(inverse) = inverse_mass.first_chunk::<F>() else { return };
    let rows = block.values.as_chunks::<F>().0;
    for (i, row) in rows.iter().enumerate() {
        let mut a = *row;
        (0..F).for_each(|f| a[f] *= inverse[f]);
        let (own, later) = slots.split_at(i + 1);
        slots = later;
        for (b, &slot) in rows[..=i].iter().zip(own) {
            let mut product = a[0] * b[0];
            (1..F).for_each(|f| product += a[f] * b[f]);
            values[slot as usize] += product;
        }
    }
}

/// The same of rows of any length.
fn add_long_products(block: &Block<'_>, inverse_mass: &[f64], slots: &[u32], values: &mut [f64]) {
    let rows = || block.values.chunks_exact(block.freedoms);
    let mut slots = slots.iter();
    for (i, a) in rows().enumerate() {
        for (b, &slot) in rows().take(i + 1).zip(&mut slots) {
            let product = a.iter().zip(inverse_mass).zip(b).map(|((a, w), b)| a * w * b);
            values[slot as usize] += product.sum::<f64>();
        }
    }
}

impl Products {
    pub(crate) fn of(entries: &Entries, elimination: &Elimination) -> Self {
        let mut slots = Vec::new();
        let place = |equation: u32| elimination.place[equation as usize];
        for block in entries.blocks() {
            for (i, &a) in block.equations.iter().enumerate() {
                let slot = |&b: &u32| elimination.slot(place(a), place(b)) as u32;
                slots.extend(block.equations[..=i].iter().map(slot));
            }
        }
        Products { slots: slots.into() }
    }

    /// Writes S.
    #[inline]
    pub(crate) fn write(&self, entries: &Entries, inverse_mass: &[f64], values: &mut [f64]) {
        values.fill(0.0);
        let mut slots = &self.slots[..];
        for block in entries.blocks() {
            let equations = block.equations.len();
            let inverse = &inverse_mass[block.first..][..block.freedoms];
            let (own, left) = slots.split_at(equations * (equations + 1) / 2);
            match block.freedoms {
                1 => add_products::<1>(&block, inverse, own, values),
                2 => add_products::<2>(&block, inverse, own, values),
                3 => add_products::<3>(&block, inverse, own, values),
                6 => add_products::<6>(&block, inverse, own, values),
                _ => add_long_products(&block, inverse, own, values),
            }
            slots = left;
        }
    }
}
