//! From space to paper: where a point of the scene is drawn.
//!
//! ```text
//! on a line     time to the right, position upward, each to its own scale
//! in a plane    x to the right, y upward
//! in space      along the unit vector w toward the eye:  right = up x w,  up = z less its part along w
//! ```
//! Parallel lines stay parallel and lengths at right angles to w keep their proportions.

use stationary_calculus::array;

/// Two directions in space that become the paper's right and upward directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Projection {
    right: [f64; 3],
    up: [f64; 3],
}

impl Projection {
    /// The view of a plane from its third axis.
    pub(crate) const FLAT: Projection = Projection { right: [1.0, 0.0, 0.0], up: [0.0, 1.0, 0.0] };

    /// The view of space along a unit vector that points to the eye.
    pub(crate) fn toward(w: [f64; 3]) -> Self {
        /// A view this close to straight down has y upward instead of z.
        const STRAIGHT: f64 = 0.999;
        let axis = if w[2].abs() > STRAIGHT { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] };
        let right = unit(cross(axis, w));
        Projection { right, up: unit(cross(w, right)) }
    }

    /// How near the eye a point is, along the direction to it.
    pub(crate) fn nearness(&self, x: [f64; 3]) -> f64 {
        dot(cross(self.right, self.up), x)
    }

    /// The point's distances to the right and upward.
    pub(crate) fn of(&self, x: [f64; 3]) -> [f64; 2] {
        [dot(self.right, x), dot(self.up, x)]
    }
}

/// A rectangle of numbers, which a drawing has to show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Extent {
    pub(crate) least: [f64; 2],
    pub(crate) largest: [f64; 2],
}

impl Extent {
    /// The smallest rectangle about some points; `None` where that is not finite, or without points.
    pub(crate) fn of(points: impl Iterator<Item = [f64; 2]>) -> Option<Self> {
        let nothing = Extent { least: [f64::INFINITY; 2], largest: [f64::NEG_INFINITY; 2] };
        let extent = points.fold(nothing, |extent, x| Extent {
            least: [extent.least[0].min(x[0]), extent.least[1].min(x[1])],
            largest: [extent.largest[0].max(x[0]), extent.largest[1].max(x[1])],
        });
        extent.size().iter().all(|size| size.is_finite()).then_some(extent)
    }

    /// Its width and height.
    pub(crate) fn size(&self) -> [f64; 2] {
        array(|c| self.largest[c] - self.least[c])
    }
}

/// A round length, 1, 2 or 5 times a power of ten, that is at most `length`.
pub(crate) fn round_length(length: f64) -> f64 {
    let power = 10.0_f64.powf(length.log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|n| n * power).find(|&round| round <= length).unwrap_or(power)
}

fn dot(x: [f64; 3], y: [f64; 3]) -> f64 {
    (0..3).map(|c| x[c] * y[c]).sum()
}

fn cross(x: [f64; 3], y: [f64; 3]) -> [f64; 3] {
    array(|c| {
        let (a, b) = ((c + 1) % 3, (c + 2) % 3);
        x[a] * y[b] - x[b] * y[a]
    })
}

fn unit(x: [f64; 3]) -> [f64; 3] {
    let length = dot(x, x).sqrt();
    x.map(|x| x / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_from_above_is_a_map() {
        let map = Projection::toward([0.0, 0.0, 1.0]);
        assert_eq!(map.of([3.0, 4.0, 5.0]), [3.0, 4.0]);
        assert_eq!(map.nearness([3.0, 4.0, 5.0]), 5.0);
        let front = Projection::toward([0.0, -1.0, 0.0]);
        assert_eq!(front.of([3.0, 4.0, 5.0]), [3.0, 5.0]);
    }

    #[test]
    fn a_view_keeps_lengths_across_it() {
        let w = unit([0.3, -0.8, 0.4]);
        let view = Projection::toward(w);
        let along = view.of(w);
        assert!(along[0].abs() < 1e-15 && along[1].abs() < 1e-15);
        let across = view.of(unit(cross(w, [0.2, 0.5, -0.1])));
        assert!((across[0].hypot(across[1]) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn round_lengths_are_one_two_or_five_times_a_power_of_ten() {
        assert_eq!(round_length(9.9), 5.0);
        assert_eq!(round_length(4.9), 2.0);
        assert_eq!(round_length(1.9), 1.0);
        assert_eq!(round_length(0.03), 0.02);
        assert_eq!(round_length(7e9), 5e9);
    }
}
