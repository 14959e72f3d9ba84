//! What contact, joints and forces did in the steps that were taken, told of any interval.
//!
//! ```text
//! W = 2 (W_a + W_b) - W_w,    J = 2 (J_a + J_b) - J_w      where the step is extrapolated; else of its halves
//! W(s) = a s + b s^2,         J(s) = s J                   s of a step whose momentum changes evenly
//! W(s) = W,                   J(s) = J                     of one in which something hits: that of its end
//! ```
//! `W` works, `J` impulses of contacts, `w` the whole step, `a` and `b` its halves; `W(1/2)` is `W_a` and half of
//! what extrapolation adds. Impulses of joints are kept as works are; their forces are `dW/ds` over the step's length
//! where the step is extrapolated, else those of its halves. So at any time works and impulses are those of the
//! momentum that is read there.

use crate::{Dimension, Touch};

/// The works of friction, impacts, obstacles, lifting with closing, dry friction of joints and joints themselves, which
/// stand before those of forces.
pub(crate) const OF_CONTACT: usize = 6;

/// A step that was taken.
#[derive(Clone, Copy, Debug)]
struct Entry {
    from: f64,
    to: f64,
    even: bool,
    extrapolated: bool,
    /// Where its touches end.
    touches: usize,
}

impl Entry {
    /// The parts of it at which an interval starts and ends.
    fn parts(&self, from: f64, to: f64) -> [f64; 2] {
        if self.even {
            return [from, to].map(|t| ((t - self.from) / (self.to - self.from)).clamp(0.0, 1.0));
        }
        [from, to].map(|t| if t > self.from { 1.0 } else { 0.0 })
    }
}

/// Works and touches of consecutive steps; their memory is kept from call to call.
#[derive(Debug)]
pub(crate) struct Ledger<G: Dimension> {
    entries: Vec<Entry>,
    /// Of each step those up to its middle, and all of them.
    works: Vec<f64>,
    width: usize,
    touches: Vec<Touch<G>>,
}

impl<G: Dimension> Default for Ledger<G> {
    fn default() -> Self {
        Ledger { entries: Vec::new(), works: Vec::new(), width: OF_CONTACT, touches: Vec::new() }
    }
}

impl<G: Dimension> Ledger<G> {
    /// Forgets all steps.
    pub(crate) fn clear(&mut self) {
        self.entries.clear();
        self.works.clear();
        self.touches.clear();
    }

    /// Adds a step with the works of the whole one and of its halves, and what touched in the halves, extrapolated
    /// where it is.
    pub(crate) fn push(
        &mut self,
        (from, to): (f64, f64),
        [even, extrapolated]: [bool; 2],
        [whole, first, second]: [&[f64]; 3],
        touches: impl Iterator<Item = Touch<G>>,
    ) {
        if self.entries.is_empty() {
            self.width = whole.len();
        }
        let beyond = |k: usize| if extrapolated { first[k] + second[k] - whole[k] } else { 0.0 };
        self.works.extend((0..self.width).map(|k| first[k] + 0.5 * beyond(k)));
        self.works.extend((0..self.width).map(|k| first[k] + second[k] + beyond(k)));
        self.touches.extend(touches);
        let touches = self.touches.len();
        self.entries.push(Entry { from, to, even, extrapolated, touches });
    }

    /// The steps that an interval meets.
    fn within(&self, from: f64, to: f64) -> std::ops::Range<usize> {
        let first = self.entries.partition_point(|entry| entry.to <= from);
        let last = self.entries.partition_point(|entry| entry.from < to);
        first..last.max(first)
    }

    /// Adds the works of an interval.
    pub(crate) fn add_works(&self, (from, to): (f64, f64), works: &mut [f64]) {
        for step in self.within(from, to) {
            let [a, b] = self.entries[step].parts(from, to);
            let (middle, end) =
                self.works[2 * self.width * step..][..2 * self.width].split_at(self.width);
            for ((work, middle), end) in works.iter_mut().zip(middle).zip(end) {
                let (slope, curve) = (4.0 * middle - end, 2.0 * end - 4.0 * middle);
                *work += (b - a) * (slope + curve * (a + b));
            }
        }
    }

    /// Writes how fast the works from a column on grow at a time, of a step that ends there if one does.
    pub(crate) fn rates(&self, t: f64, first: usize, rates: &mut Vec<f64>) {
        rates.clear();
        let step = self.entries.partition_point(|entry| entry.to < t);
        let Some(&Entry { from, to, extrapolated, .. }) = self.entries.get(step) else { return };
        let (part, length) = (((t - from) / (to - from)).clamp(0.0, 1.0), to - from);
        let (middle, end) =
            self.works[2 * self.width * step..][..2 * self.width].split_at(self.width);
        rates.extend(middle.iter().zip(end).skip(first).map(|(middle, end)| {
            let rate = match extrapolated {
                true => 4.0 * middle - end + 4.0 * part * (end - 2.0 * middle),
                false if part <= 0.5 => 2.0 * middle,
                false => 2.0 * (end - middle),
            };
            rate / length
        }));
    }

    /// Shows what touched in an interval, with the part of its impulses that fell into it and the time of the last.
    pub(crate) fn show(&self, (from, to): (f64, f64), see: &mut dyn FnMut(f64, &Touch<G>)) {
        for step in self.within(from, to) {
            let entry = &self.entries[step];
            let [a, b] = entry.parts(from, to);
            let first = step.checked_sub(1).map_or(0, |before| self.entries[before].touches);
            for touch in self.touches[first..entry.touches].iter().filter(|_| b > a) {
                let part = Touch {
                    impact: touch.impact * (b - a),
                    normal: touch.normal * (b - a),
                    friction: touch.friction * (b - a),
                    moment: touch.moment * (b - a),
                    ..*touch
                };
                see(entry.to.min(to), &part);
            }
        }
    }
}
