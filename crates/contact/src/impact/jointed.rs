//! Impacts of things that joints hold: contacts and joints at once, by Poisson's law.
//!
//! ```text
//! closing       joints alone                                     v-
//! compression   the laws of all rows between x and v=            joints, and cones of what approaches
//! restitution   x_c <- (1 + s c) x_c,   joints again             v+
//! ```
//! `x_c` the impulses of contacts (N s), `c` their restitution. One `c` and closed joints give
//! `v+ = v= + c (v= - v-)`, which keeps joints and gains no energy, as friction opposes what slides at the
//! end of compression; where the restitutions differ `s` is the largest part, up to 1, that gains none.
//! Source: as in `rough.rs`.

use stationary_calculus::Vector;
use stationary_constraints::{RowLaw, VelocityRows};

use crate::{ContactError, InverseMass, RowsSolver};

/// What may be left, relative to the fastest rate of a row.
const SETTLED: f64 = 1e-9;
/// How often the part of the restitution that gains nothing is looked for, how closely it is found, and energy
/// that is rounding.
const HALVINGS: usize = 40;
const TOLERANCE: f64 = 1e-6;
const ENERGY_ROUNDING: f64 = 1e-11;

/// A pass over some contacts: their cones behind the rows of joints.
pub(crate) struct JointedPass<'a> {
    pub(crate) joints: &'a VelocityRows,
    pub(crate) contacts: &'a VelocityRows,
    /// One of each contact.
    pub(crate) restitution: &'a [f64],
    pub(crate) mass: &'a InverseMass,
}

impl JointedPass<'_> {
    /// Changes a velocity; says the impulses of the contacts' rows, and whether the laws were met.
    pub(crate) fn reflect(
        &self,
        v: &mut Vector<Vec<f64>>,
    ) -> Result<(Vec<f64>, bool), ContactError> {
        let held = instantaneous(self.joints, v.0.len())?;
        let mut rows = held.clone();
        append(self.contacts, &mut rows)?;
        let mut solver = RowsSolver::default();
        // What joints are off by would come back magnified, and as energy.
        let mut closing = vec![0.0; held.rows()];
        solver.solve(&held, &mut &*self.mass, 0.0, &mut closing, v.view_mut())?;
        let before = v.clone();
        let rate = |row| rows.lack(row, before.view()).abs();
        let enough = SETTLED * (0..rows.rows()).map(rate).fold(0.0, f64::max);
        let mut x = vec![0.0; rows.rows()];
        let done = solver.solve(&rows, &mut &*self.mass, enough, &mut x, v.view_mut())?;
        let compressed = x.split_off(held.rows());
        let mut settled = done.settled;
        // Between the largest part that is known to gain nothing and the smallest that gains.
        let (mut least, mut most) = (0.0, 1.0);
        let mut part = 1.0;
        for halving in 0..=HALVINGS {
            let mut impulses = compressed.clone();
            for ((_, block), c) in self.contacts.blocks().zip(self.restitution) {
                impulses[block].iter_mut().for_each(|x| *x *= 1.0 + part * c);
            }
            v.copy_from(before.view());
            for (row, x) in impulses.iter().enumerate() {
                let entries = self.contacts.row(row);
                self.mass.lift(entries, |freedom, value| v.0[freedom] += x * value);
            }
            let mut holding = vec![0.0; held.rows()];
            let kept = solver.solve(&held, &mut &*self.mass, enough, &mut holding, v.view_mut())?;
            let mut gained = [0.0_f64; 2];
            for (rows, x) in [(self.contacts, &impulses), (&held, &holding)] {
                for (row, x) in x.iter().enumerate() {
                    let mean = rows.row(row).map(|(f, value)| value * (v.0[f] + before.0[f]));
                    let term = 0.5 * x * mean.sum::<f64>();
                    gained = [gained[0] + term, gained[1] + term.abs()];
                }
            }
            let gains = gained[0] > ENERGY_ROUNDING * gained[1];
            if halving == HALVINGS || (!gains && (part == 1.0 || most - part <= TOLERANCE)) {
                settled &= kept.settled;
                return Ok((impulses, settled));
            }
            if gains {
                most = part;
            } else {
                least = part;
            }
            // The last try is one that is known.
            let last = halving + 1 == HALVINGS;
            part = if last { least } else { 0.5 * (least + most) };
        }
        Ok((compressed, settled))
    }
}

/// What joints ask for in an instant: equalities. Friction has no impulse then, and limits wait for the
/// rest of the step.
fn instantaneous(joints: &VelocityRows, freedoms: usize) -> Result<VelocityRows, ContactError> {
    let zero = vec![0.0; freedoms];
    let mut held = VelocityRows::default();
    for (law, block) in joints.blocks() {
        let row = block.start;
        let entries: Vec<_> = joints.row(row).collect();
        if law == RowLaw::Equality {
            held.push(law, &[(&entries, -joints.lack(row, Vector(&zero)))])?;
        }
    }
    Ok(held)
}

fn append(more: &VelocityRows, rows: &mut VelocityRows) -> Result<(), ContactError> {
    for (law, block) in more.blocks() {
        let entries: Vec<Vec<_>> = block.map(|row| more.row(row).collect()).collect();
        let block: Vec<(&[(usize, f64)], f64)> =
            entries.iter().map(|entries| (&entries[..], 0.0)).collect();
        rows.push(law, &block)?;
    }
    Ok(())
}
