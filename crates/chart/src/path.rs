//! Where a line goes: path data, with a gap where a point has no place.

use std::fmt::Write;

use crate::canvas::number;

/// Lines and outlines of a [`Canvas`](crate::Canvas), as path data.
///
/// ```
/// use stationary_chart::Path;
///
/// let mut path = Path::line(&[(0.0, 0.0), (10.0, 5.0), (f64::NAN, 0.0), (20.0, 5.0), (30.0, 0.0)]);
/// path.outline(&[(0.0, 0.0), (4.0, 0.0), (4.0, 4.0)]);
/// assert_eq!(path.data(), "M0 0L10 5M20 5L30 0M0 0L4 0L4 4z");
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Path(String);

impl Path {
    /// Nothing yet.
    #[must_use]
    pub fn new() -> Self {
        Path::default()
    }

    /// One line through points.
    #[must_use]
    pub fn line(points: &[(f64, f64)]) -> Self {
        let mut path = Path::new();
        path.through(points.iter().copied());
        path
    }

    /// Adds a line through points. A point that is not finite is a gap; one that is drawn where the
    /// one before is says nothing more and is left out.
    pub fn through(&mut self, points: impl IntoIterator<Item = (f64, f64)>) {
        let (mut letter, mut before) = ('M', String::new());
        for (x, y) in points {
            if !(x.is_finite() && y.is_finite()) {
                (letter, before) = ('M', String::new());
                continue;
            }
            let point = format!("{} {}", number(x), number(y));
            if point != before {
                // Writing to a String cannot fail.
                let _ = write!(self.0, "{letter}{point}");
                (letter, before) = ('L', point);
            }
        }
    }

    /// Adds a closed outline; one with a corner that is not finite is left out.
    pub fn outline(&mut self, corners: &[(f64, f64)]) {
        if corners.iter().all(|(x, y)| x.is_finite() && y.is_finite()) && !corners.is_empty() {
            self.0 += &polyline(corners);
            self.0.push('z');
        }
    }

    /// Whether there is nothing to draw.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The data, as the attribute `d` of a path has it.
    #[must_use]
    pub fn data(&self) -> &str {
        &self.0
    }
}

/// Path data of a polyline whose points all have a place.
pub(crate) fn polyline(points: &[(f64, f64)]) -> String {
    let mut d = String::new();
    for (i, &(x, y)) in points.iter().enumerate() {
        let letter = if i == 0 { 'M' } else { 'L' };
        let _ = write!(d, "{letter}{} {}", number(x), number(y));
    }
    d
}
