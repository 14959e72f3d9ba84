//! A number as a message shows it: its digits, or with an exponent where these would be many zeros.

use std::fmt;

/// Shows a number like `{}` from 1e-5 to below 1e16, like `{:e}` beyond.
///
/// ```
/// use stationary_calculus::Readable;
///
/// let shown = [0.0, -2.5, 1e-5, 6e-75, -1e16].map(|x| Readable(&x).to_string());
/// assert_eq!(shown, ["0", "-2.5", "0.00001", "6e-75", "-1e16"]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Readable<'a>(pub &'a f64);

impl fmt::Display for Readable<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Readable(x) = self;
        match x.abs() {
            size if size == 0.0 || !size.is_finite() || (1e-5..1e16).contains(&size) => {
                fmt::Display::fmt(x, f)
            }
            _ => fmt::LowerExp::fmt(x, f),
        }
    }
}
