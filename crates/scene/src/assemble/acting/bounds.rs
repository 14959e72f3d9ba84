//! How large what acts may be between two times, where bodies are at one of them.
//!
//! ```text
//! |F_k| <= max |s| |f_k|         s over all of the interval; of a point its torque at most its arm times |f|
//! ```
//! Of pins that move the pull from anywhere on their way is counted, of drag, dampers and frames that at the velocity
//! there.

use super::{Act, Acting, What};
use crate::assemble::acting::rate::Rate;
use crate::assemble::anchor::Anchor;

impl Acting {
    /// Adds to each freedom by how much what acts leaves its mean in a step of `h` from `t`, where bodies are at its
    /// start; of pins that move by how much their pull changes between the start, the middle and the end.
    pub(crate) fn add_swings(&self, (t, h): (f64, f64), q: &[f64], swings: &mut [f64]) {
        for Act { strength, what, .. } in &self.acts {
            if what.follows_pins() {
                let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; self.inverse.len()];
                for now in [t, t + 0.5 * h, t + h] {
                    let mut pulls = vec![0.0; self.inverse.len()];
                    what.forces((now, q), &self.inverse, self.each, &mut |freedom, force| {
                        pulls[freedom] += force;
                    });
                    for (range, pull) in ranges.iter_mut().zip(pulls) {
                        *range = [range[0].min(pull), range[1].max(pull)];
                    }
                }
                for (swing, [least, most]) in swings.iter_mut().zip(ranges) {
                    *swing += most - least;
                }
            } else if let swing @ f64::MIN_POSITIVE.. = strength.swing(t, t + h) {
                what.forces((t, q), &self.inverse, self.each, &mut |freedom, force| {
                    swings[freedom] += swing * force.abs();
                });
            }
        }
    }

    /// Adds to the bound of each freedom.
    pub(crate) fn add_bounds(
        &self,
        between: (f64, f64),
        (t, q, p): (f64, &[f64], &[f64]),
        bounds: &mut [f64],
    ) {
        let each = self.each;
        let p = &p[..self.inverse.len()];
        for Act { strength, what, .. } in &self.acts {
            let largest = strength.largest(between.0, between.1);
            match what {
                What::Drag(c) => {
                    for freedom in super::shifts(p.len(), each, self.dimension) {
                        bounds[freedom] += c * (p[freedom] * self.inverse[freedom]).abs();
                    }
                }
                What::Frame(frame) => {
                    for (k, (seen, p)) in frame.seen(q).zip(p.chunks_exact(each)).enumerate() {
                        let inverse = &self.inverse[each * k..][..each];
                        let mut v = [0.0; 6];
                        let rates = p.iter().zip(inverse).map(|(p, inverse)| p * inverse);
                        v.iter_mut().zip(rates).for_each(|(v, rate)| *v = rate);
                        let aside = frame.aside(&seen, &v[..each], inverse);
                        let outward = frame.outward(&seen, inverse);
                        let own = &mut bounds[each * k..][..each];
                        for ((bound, a), b) in own.iter_mut().zip(aside).zip(outward) {
                            *bound += a.abs() + b.abs();
                        }
                    }
                }
                What::Damper(c, rate) => {
                    let now = rate.now(t, q, each);
                    let [own, ..] = now.of_momenta(p, &self.inverse);
                    let most = c * (own.abs() + rate.fastest_told(between));
                    match rate {
                        Rate::Freedoms(entries) => entries
                            .iter()
                            .for_each(|&(freedom, part)| bounds[freedom] += most * part.abs()),
                        Rate::Distance(_) => {
                            rate.anchors().for_each(|anchor| add_pull(anchor, most, each, bounds))
                        }
                    }
                }
                What::Point { body, point, force, torque } => {
                    let own = &mut bounds[each * body..][..each];
                    let turns = size(point) * size(force) + size(torque);
                    for (k, bound) in own.iter_mut().enumerate() {
                        let shift = k < self.dimension;
                        *bound += largest * if shift { force[k].abs() } else { turns };
                    }
                }
                What::Weight(_) | What::Freedoms(_) => {
                    what.forces((t, q), &self.inverse, each, &mut |freedom, force| {
                        bounds[freedom] += largest * force.abs();
                    });
                }
                #[cfg(feature = "elasticity")]
                What::ByPins(led) => {
                    let add = &mut |anchor: &Anchor, most| add_pull(anchor, most, each, bounds);
                    led.largest_pulls(between, (t, q), each, add);
                }
            }
        }
    }
}

fn size(x: &[f64; 3]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Adds what a pull of so many newtons in any direction does to a body.
fn add_pull(anchor: &Anchor, most: f64, each: usize, bounds: &mut [f64]) {
    let Anchor::Body(body, point) = anchor else { return };
    let shifts = if each == 3 { 2 } else { 3 };
    for (k, bound) in bounds[each * body..][..each].iter_mut().enumerate() {
        *bound += if k < shifts { most } else { size(point) * most };
    }
}
