//! Rates that dampers hold back: of the distance of two points, or of a turn.
//!
//! ```text
//! r = J v,    J M^-1 J^T        what a unit impulse along it changes of it
//! ```

use crate::assemble::anchor::Anchor;

/// A rate that a damper holds back.
#[derive(Clone, Debug)]
pub(super) enum Rate {
    /// Of the distance of two points.
    Distance([Anchor; 2]),
    /// A sum of the rates of freedoms.
    Freedoms(Vec<(usize, f64)>),
}

impl Rate {
    /// How it depends on the rates of freedoms; on none where two points meet.
    pub(super) fn entries(&self, q: &[f64], each: usize) -> Vec<(usize, f64)> {
        let ends = match self {
            Rate::Freedoms(entries) => return entries.clone(),
            Rate::Distance(ends) => ends,
        };
        let [a, b] = ends.each_ref().map(|end| end.place(q, each));
        let way: [f64; 3] = std::array::from_fn(|c| b[c] - a[c]);
        let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
        let mut entries = Vec::new();
        if length > 0.0 {
            for (end, sign) in ends.iter().zip([-1.0, 1.0]) {
                let along = way.map(|x| sign * x / length);
                end.pull(q, each, &along, &mut |freedom, part| entries.push((freedom, part)));
            }
        }
        entries
    }
}

/// A rate where momenta are `p`, and what a unit impulse along it changes of it.
pub(super) fn rate_of(entries: &[(usize, f64)], p: &[f64], inverse: &[f64]) -> [f64; 2] {
    let mut rate = [0.0; 2];
    for &(freedom, part) in entries {
        rate[0] += part * inverse[freedom] * p[freedom];
        rate[1] += part * inverse[freedom] * part;
    }
    rate
}
