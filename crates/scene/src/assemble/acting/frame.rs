//! A frame that turns: what acts on particles and bodies that are seen in it.
//!
//! ```text
//! F = -2 W x p - m W x (W x x)            W the frame's angular velocity, about the origin
//! p <- R(-2 W t) p                        Coriolis' force alone for a time t
//! T = 2 w x S W - W x I W                 on a body, in its axes; S = 1/2 tr(I) - I, w its angular velocity
//! L <- I^1/2 R(-2 c t) I^-1/2 L           its first part alone: c = det(I)^-1/2 I^1/2 S W
//! ```
//! Coriolis' force and torque do no work, and the turns keep `|p|` and `<L, I^-1 L>`; the centrifugal ones do,
//! as any other does. Source: Landau and Lifshitz, Mechanics, section 39, summed over the points of a body.

use crate::model::turned::{cross, turn_back};
use stationary_calculus::array;

/// A frame, and what is seen in it: things of `each` freedoms, of which the first are shifts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    /// Its angular velocity; in the plane the third component.
    pub(crate) turning: [f64; 3],
    pub(crate) each: usize,
    pub(crate) dimension: usize,
}

/// A particle or a body in a frame.
pub(crate) struct Seen {
    place: [f64; 3],
    /// The frame's angular velocity in the axes of a body that turns in space.
    own: Option<[f64; 3]>,
}

impl Frame {
    /// All that is seen at a configuration, in order.
    pub(crate) fn seen(self, q: &[f64]) -> impl Iterator<Item = Seen> {
        let turns = self.turns();
        q.chunks_exact(if turns { 7 } else { self.each }).map(move |q| Seen {
            place: self.shifts(q),
            own: turns.then(|| turn_back(array(|k| q[3 + k]), self.turning)),
        })
    }

    /// Whether what is seen turns in space.
    fn turns(self) -> bool {
        self.each == 6
    }

    /// The shifts among numbers, as a vector in space.
    fn shifts(self, x: &[f64]) -> [f64; 3] {
        array(|c| if c < self.dimension { x[c] } else { 0.0 })
    }

    /// Turns a momentum as Coriolis' force and torque alone do for a time.
    pub(crate) fn turn(self, time: f64, seen: &Seen, p: &mut [f64], inverse: &[f64]) {
        let turned = about(self.turning, -2.0 * time, self.shifts(p));
        p[..self.dimension].copy_from_slice(&turned[..self.dimension]);
        if let Some(own) = seen.own {
            let [roots, spread] = [roots(inverse), spread(inverse)];
            let least = 1.0 / roots.iter().product::<f64>();
            let axis = array(|k| least * roots[k] * spread[k] * own[k]);
            let even = array(|k| p[3 + k] / roots[k]);
            let turned = about(axis, -2.0 * time, even);
            (0..3).for_each(|k| p[3 + k] = roots[k] * turned[k]);
        }
    }

    /// Coriolis' force and torque at a velocity.
    pub(crate) fn aside(self, seen: &Seen, v: &[f64], inverse: &[f64]) -> [f64; 6] {
        let force = cross(self.turning, self.shifts(v)).map(|a| -2.0 * a);
        let torque = seen.own.map_or([0.0; 3], |own| {
            let spread = spread(inverse);
            let w = array(|k| v[3 + k]);
            cross(w, array(|k| 2.0 * spread[k] * own[k]))
        });
        self.on_freedoms(force, torque, inverse)
    }

    /// The centrifugal force and torque.
    pub(crate) fn outward(self, seen: &Seen, inverse: &[f64]) -> [f64; 6] {
        let force = cross(self.turning, cross(self.turning, seen.place)).map(|a| -a);
        let torque =
            seen.own.map_or([0.0; 3], |own| cross(own, array(|k| -own[k] / inverse[3 + k])));
        self.on_freedoms(force, torque, inverse)
    }

    /// An acceleration and a torque, as they act on the freedoms of a thing.
    fn on_freedoms(self, a: [f64; 3], torque: [f64; 3], inverse: &[f64]) -> [f64; 6] {
        array(|freedom| match freedom {
            shift if shift < self.dimension => a[shift] / inverse[shift],
            turn if turn >= 3 => torque[turn - 3],
            _ => 0.0,
        })
    }
}

/// The roots of a body's moments.
fn roots(inverse: &[f64]) -> [f64; 3] {
    array(|k| 1.0 / inverse[3 + k].sqrt())
}

/// `S`: how a body's mass is spread along its axes.
fn spread(inverse: &[f64]) -> [f64; 3] {
    let moments: [f64; 3] = array(|k| 1.0 / inverse[3 + k]);
    moments.map(|moment| 0.5 * moments.iter().sum::<f64>() - moment)
}

/// A vector turned about `w` by `|w|` times a time: Rodrigues' formula.
fn about(w: [f64; 3], time: f64, x: [f64; 3]) -> [f64; 3] {
    let size = w.iter().map(|w| w * w).sum::<f64>().sqrt();
    if size == 0.0 {
        return x;
    }
    let axis = w.map(|w| w / size);
    let (sin, cos) = (size * time).sin_cos();
    let (around, along) = (cross(axis, x), (0..3).map(|c| axis[c] * x[c]).sum::<f64>());
    array(|c| cos * x[c] + sin * around[c] + (1.0 - cos) * along * axis[c])
}

#[cfg(test)]
mod tests {
    use super::*;

    const INVERSE: [f64; 6] = [0.5, 0.5, 0.5, 1.0 / 1.3, 1.0 / 0.9, 1.0 / 0.7];
    const P: [f64; 6] = [0.7, -0.2, 0.5, -0.3, 0.8, 0.4];

    fn seen() -> (Frame, Seen) {
        let frame = Frame { turning: [0.3, -0.4, 1.2], each: 6, dimension: 3 };
        // A turn by 0.6 rad about a slanted axis, and a place.
        let axis = [2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0].map(|c| c * 0.3_f64.sin());
        let q = [0.4, -0.9, 0.2, 0.3_f64.cos(), axis[0], axis[1], axis[2]];
        (frame, frame.seen(&q).next().unwrap())
    }

    #[test]
    fn a_turn_over_a_short_time_is_the_force_and_keeps_the_energy() {
        let (frame, seen) = seen();
        let energy = |p: &[f64; 6]| p.iter().zip(INVERSE).map(|(p, m)| m * p * p).sum::<f64>();
        let v: Vec<f64> = P.iter().zip(INVERSE).map(|(p, inverse)| p * inverse).collect();
        let force = frame.aside(&seen, &v, &INVERSE);
        for t in [1e-3, 1e-4, 1e-5] {
            let mut turned = P;
            frame.turn(t, &seen, &mut turned, &INVERSE);
            assert!((energy(&turned) - energy(&P)).abs() < 1e-15);
            for c in 0..6 {
                let rate = (turned[c] - P[c]) / t;
                assert!((rate - force[c]).abs() < 10.0 * t, "{t}: {c}: {rate} {}", force[c]);
            }
        }
    }

    #[test]
    fn a_body_is_pulled_as_its_points_are() {
        // Eight points whose moments are those of the body, each as a particle in the same frame.
        let (frame, seen) = seen();
        let own = seen.own.unwrap();
        let (mass, spread) = (1.0 / INVERSE[0], spread(&INVERSE));
        let w: [f64; 3] = std::array::from_fn(|k| P[3 + k] * INVERSE[3 + k]);
        let of_points = Frame { turning: own, each: 3, dimension: 3 };
        let mut torque = [0.0; 3];
        for corner in 0..8_u8 {
            let side = |k: usize| if corner >> k & 1 == 0 { 1.0 } else { -1.0 };
            let r: [f64; 3] = std::array::from_fn(|k| side(k) * (spread[k] / mass).sqrt());
            let inverse = [8.0 / mass; 3];
            let point = of_points.seen(&r).next().unwrap();
            let [aside, outward] = [
                of_points.aside(&point, &cross(w, r), &inverse),
                of_points.outward(&point, &inverse),
            ];
            let force = std::array::from_fn(|k| aside[k] + outward[k]);
            let part = cross(r, force);
            (0..3).for_each(|k| torque[k] += part[k]);
        }
        let v: Vec<f64> = P.iter().zip(INVERSE).map(|(p, inverse)| p * inverse).collect();
        let [aside, outward] = [frame.aside(&seen, &v, &INVERSE), frame.outward(&seen, &INVERSE)];
        for k in 0..3 {
            let own = aside[3 + k] + outward[3 + k];
            assert!((own - torque[k]).abs() < 1e-14, "{k}: {own} {}", torque[k]);
        }
    }
}
