//! A frame that turns: what acts on particles that are seen in it.
//!
//! ```text
//! F = -2 W x p - m W x (W x x)          W the frame's angular velocity, about the origin
//! p <- R(-W h) p                        Coriolis' force over half a step of h: a turn by twice W h/2
//! ```
//! Coriolis' force does no work, and the turn keeps `|p|`; the centrifugal force does, as any other does.
//! Source: Landau and Lifshitz, Mechanics, section 39.

use crate::model::turned::cross;

/// The angular velocity of a frame; in the plane its third component.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame(pub(crate) [f64; 3]);

impl Frame {
    /// The first components of a vector that has so many, as one in space.
    fn in_space(x: &[f64]) -> [f64; 3] {
        std::array::from_fn(|c| x.get(c).copied().unwrap_or(0.0))
    }

    /// Turns a momentum as Coriolis' force does in half a step of `h`, by Rodrigues' formula.
    pub(crate) fn turn(&self, h: f64, p: &mut [f64]) {
        let size = self.0.iter().map(|w| w * w).sum::<f64>().sqrt();
        if size == 0.0 {
            return;
        }
        let axis = self.0.map(|w| w / size);
        let (sin, cos) = (-size * h).sin_cos();
        let old = Frame::in_space(p);
        let (around, along) = (cross(axis, old), (0..3).map(|c| axis[c] * old[c]).sum::<f64>());
        for (c, p) in p.iter_mut().enumerate() {
            *p = cos * old[c] + sin * around[c] + (1.0 - cos) * along * axis[c];
        }
    }

    /// Coriolis' force over the mass at a velocity.
    pub(crate) fn aside(&self, v: &[f64]) -> [f64; 3] {
        cross(self.0, Frame::in_space(v)).map(|x| -2.0 * x)
    }

    /// The centrifugal force over the mass at a place.
    pub(crate) fn outward(&self, x: &[f64]) -> [f64; 3] {
        cross(self.0, cross(self.0, Frame::in_space(x))).map(|x| -x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_over_a_short_time_is_the_force_and_keeps_the_length() {
        let frame = Frame([0.3, -0.4, 1.2]);
        let p = [0.7, -0.2, 0.5];
        let length = |p: &[f64; 3]| p.iter().map(|x| x * x).sum::<f64>().sqrt();
        for h in [1e-3, 1e-4, 1e-5] {
            let mut turned = p;
            frame.turn(h, &mut turned);
            assert!((length(&turned) - length(&p)).abs() < 1e-15);
            for c in 0..3 {
                let rate = (turned[c] - p[c]) / (0.5 * h);
                assert!((rate - frame.aside(&p)[c]).abs() < 5.0 * h, "{h}: {rate}");
            }
        }
    }
}
