//! The entries of S: products of the equations' rows over masses.
//!
//! ```text
//! S = sum over freedoms f of  J_f J_f^T / m_f         m x m, sparse, symmetric
//! ```
//! `J_f` the column of a freedom, `m_f` its mass. Columns of freedoms that the same equations touch (the
//! coordinates of a body) make a group, whose products are summed before they go to S. Where they go is
//! found once.

use std::sync::Arc;

use crate::elimination::Elimination;
use crate::entries::Entries;

/// Freedoms that the same equations touch.
#[derive(Clone, Copy, Debug)]
struct Group {
    freedoms: usize,
    equations: usize,
}

/// Which entries make S, and in which order. Copies share it.
#[derive(Clone, Debug)]
pub(crate) struct Products {
    pattern: Arc<Pattern>,
    /// The rows of one group, and the same over masses.
    block: Vec<f64>,
    weighted: Vec<f64>,
}

#[derive(Debug, Default)]
struct Pattern {
    groups: Vec<Group>,
    /// Of each group, equation after equation, its entries; and of each freedom one over its mass.
    entries: Vec<u32>,
    inverse_mass: Vec<f64>,
    /// Of each group where the products of two equations go, first those of the first with itself.
    slots: Vec<u32>,
}

/// Of each freedom its equations and entries, by equations.
pub(crate) fn columns(entries: &Entries, freedoms: usize) -> Vec<Vec<(u32, u32)>> {
    let mut columns: Vec<Vec<(u32, u32)>> = vec![Vec::new(); freedoms];
    for (index, &(row, freedom)) in entries.places.iter().enumerate() {
        columns[freedom as usize].push((row, index as u32));
    }
    columns.iter_mut().for_each(|column| column.sort_unstable());
    columns
}

/// Adds the products of rows of F numbers, each with itself and those before it.
#[inline]
fn add_products<const F: usize>(
    weighted: &[f64],
    block: &[f64],
    slots: &[u32],
    values: &mut [f64],
) {
    let (weighted, block) = (weighted.as_chunks::<F>().0, block.as_chunks::<F>().0);
    let mut slots = slots.iter();
    for (i, a) in weighted.iter().enumerate() {
        for (b, &slot) in block[..=i].iter().zip(&mut slots) {
            let mut product = a[0] * b[0];
            for f in 1..F {
                product += a[f] * b[f];
            }
            values[slot as usize] += product;
        }
    }
}

impl Products {
    pub(crate) fn of(columns: &[Vec<(u32, u32)>], mass: &[f64], elimination: &Elimination) -> Self {
        let mut products = Pattern::default();
        let equations = |column: &[(u32, u32)]| column.iter().map(|c| c.0).collect::<Vec<u32>>();
        let used: Vec<usize> = (0..mass.len()).filter(|&f| !columns[f].is_empty()).collect();
        for group in used.chunk_by(|&a, &b| equations(&columns[a]) == equations(&columns[b])) {
            let own = equations(&columns[group[0]]);
            let place = |equation: u32| elimination.place[equation as usize];
            for (i, &a) in own.iter().enumerate() {
                products.entries.extend(group.iter().map(|&f| columns[f][i].1));
                let slot = |&b: &u32| elimination.slot(place(a), place(b)) as u32;
                products.slots.extend(own[..=i].iter().map(slot));
            }
            products.inverse_mass.extend(group.iter().map(|&f| mass[f].recip()));
            products.groups.push(Group { freedoms: group.len(), equations: own.len() });
        }
        let sizes = products.groups.iter().map(|group| group.freedoms * group.equations);
        let block = vec![0.0; sizes.max().unwrap_or(0)];
        Products { weighted: block.clone(), block, pattern: Arc::new(products) }
    }

    /// Writes S.
    #[inline]
    pub(crate) fn write(&mut self, entries: &Entries, values: &mut [f64]) {
        values.fill(0.0);
        let Products { pattern, block, weighted } = self;
        let Pattern { groups, inverse_mass, slots, entries: all } = &**pattern;
        let (mut masses, mut slots, mut places) = (&inverse_mass[..], &slots[..], &all[..]);
        for &Group { freedoms, equations } in groups {
            let (own, rest) = places.split_at(freedoms * equations);
            let (inverse, others) = masses.split_at(freedoms);
            let (block, weighted) = (&mut block[..own.len()], &mut weighted[..own.len()]);
            for (at, &entry) in own.iter().enumerate() {
                block[at] = entries.values[entry as usize];
            }
            for (weighted, row) in
                weighted.chunks_exact_mut(freedoms).zip(block.chunks_exact(freedoms))
            {
                for (w, (value, inverse)) in weighted.iter_mut().zip(row.iter().zip(inverse)) {
                    *w = value * inverse;
                }
            }
            let (own_slots, left) = slots.split_at(equations * (equations + 1) / 2);
            match freedoms {
                1 => add_products::<1>(weighted, block, own_slots, values),
                2 => add_products::<2>(weighted, block, own_slots, values),
                3 => add_products::<3>(weighted, block, own_slots, values),
                6 => add_products::<6>(weighted, block, own_slots, values),
                _ => {
                    let mut slots = own_slots.iter();
                    for (i, a) in weighted.chunks_exact(freedoms).enumerate() {
                        let before = block.chunks_exact(freedoms).take(i + 1);
                        for (b, &slot) in before.zip(&mut slots) {
                            let product = a.iter().zip(b).map(|(a, b)| a * b);
                            values[slot as usize] += product.sum::<f64>();
                        }
                    }
                }
            }
            slots = left;
            (places, masses) = (rest, others);
        }
    }
}
