//! Loads: a force of fixed direction whose strength is a function of time.
//!
//! ```text
//! F(t) = s(t) f
//! bump    s(t) = 6 (t - a)(a + tau - t)/tau^3   for a <= t <= a + tau, else 0
//! ```
//! `f` a covector (n), newtons where q is a length; `s` its strength at the time t, a pure number.
//! The bump starts at `a`, lasts `tau` seconds and has the integral 1, so that `f` is then an
//! impulse, in newton seconds, to which the load tends with tau. Source: notes 10.1, 10.2.

use stationary_calculus::{Covector, Force, Storage, Vector};

use crate::ForceError;

/// A force of fixed direction and changing strength.
#[derive(Clone, Debug, PartialEq)]
pub struct Load<C, S> {
    /// The force where the strength is 1.
    pub direction: Covector<C>,
    /// The strength at a time in seconds.
    pub strength: S,
}

impl<C: Storage, S: Fn(f64) -> f64> Force for Load<C, S> {
    fn dim(&self) -> usize {
        self.direction.components().len()
    }

    #[inline]
    fn add_force(&self, t: f64, _q: &[f64], _v: Vector<&[f64]>, mut f: Covector<&mut [f64]>) {
        f.add_scaled((self.strength)(t), self.direction.view());
    }
}

/// The strength, in 1/s, of a bump that starts at a time and lasts for `width` seconds.
///
/// # Errors
/// Where the width is not positive, or a number is not finite.
pub fn bump(start: f64, width: f64) -> Result<impl Fn(f64) -> f64 + Copy, ForceError> {
    if !(start.is_finite() && width > 0.0 && width.is_finite()) {
        return Err(ForceError::Bump { start, width });
    }
    Ok(move |t: f64| {
        let part = (t - start) / width;
        if (0.0..=1.0).contains(&part) { 6.0 * part * (1.0 - part) / width } else { 0.0 }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bump_of_any_width_has_the_integral_one() {
        for width in [1e-6, 0.1, 7.0] {
            let strength = bump(2.0, width).unwrap();
            // Simpson's rule is exact for a parabola.
            let [a, b, c] = [0.0, 0.5, 1.0].map(|part| strength(2.0 + part * width));
            assert!(((a + 4.0 * b + c) * width / 6.0 - 1.0).abs() < 1e-9, "width {width}");
            assert_eq!((strength(2.0 - 0.01 * width), strength(2.0 + 1.01 * width)), (0.0, 0.0));
        }
    }

    #[test]
    fn a_load_pushes_along_its_direction() {
        let load = Load { direction: Covector([3.0, -1.0]), strength: |t: f64| t.sin() };
        let mut f = Covector([10.0, 20.0]);
        load.add_force(0.5, &[0.0; 2], Vector([1.0; 2]).view(), f.view_mut());
        assert_eq!(f.0, [10.0 + 0.5_f64.sin() * 3.0, 20.0 - 0.5_f64.sin()]);
        assert_eq!(load.dim(), 2);
    }

    #[test]
    fn a_bump_without_width_is_refused() {
        for (start, width) in [(0.0, 0.0), (0.0, -1.0), (f64::NAN, 1.0), (0.0, f64::NAN)] {
            assert!(matches!(bump(start, width), Err(ForceError::Bump { .. })));
        }
    }
}
