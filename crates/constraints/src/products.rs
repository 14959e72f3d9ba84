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
    /// Of each group where the products of two equations go, first those of the first with itself. What comes to
    /// its place before all others has [`FIRST`] in it.
    slots: Arc<[u32]>,
    /// The places to which none goes.
    empty: Arc<[u32]>,
}

/// The first product of an entry.
const FIRST: u32 = 1 << 31;

/// Adds a product to its entry, or begins that.
#[inline]
fn put(product: f64, slot: u32, values: &mut [f64]) {
    let value = &mut values[(slot & !FIRST) as usize];
    let before = if slot & FIRST == 0 { *value } else { 0.0 };
    *value = before + product;
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
            put(product, slot, values);
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
            put(product.sum(), slot, values);
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
        let mut is_empty = vec![true; elimination.len() + elimination.order.len()];
        for slot in &mut slots {
            if std::mem::replace(&mut is_empty[*slot as usize], false) {
                *slot |= FIRST;
            }
        }
        let empty = (0..is_empty.len() as u32).filter(|&slot| is_empty[slot as usize]);
        Products { empty: empty.collect(), slots: slots.into() }
    }

    /// Writes S.
    #[inline]
    pub(crate) fn write(&self, entries: &Entries, inverse_mass: &[f64], values: &mut [f64]) {
        self.empty.iter().for_each(|&slot| values[slot as usize] = 0.0);
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
