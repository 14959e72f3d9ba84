//! `NAME=FROM:TO:COUNT`, the values of a parameter; or `NAME=VALUE`, one.
//!
//! ```text
//! x_i = (1 - s) from + s to      s = i / (count - 1),      i = 0, ..., count - 1
//! ```

use std::fmt;
use std::ops;
use std::str::FromStr;

/// A parameter and its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Range {
    /// The parameter.
    pub name: String,
    /// Its first value.
    pub from: f64,
    /// Its last value.
    pub to: f64,
    /// How many there are.
    pub count: usize,
    /// What was written.
    text: String,
}

/// A range that cannot be, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RangeError {
    text: String,
    place: ops::Range<usize>,
    reason: String,
}

impl std::error::Error for RangeError {}

impl fmt::Display for RangeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let before = self.text[..self.place.start].chars().count();
        let under = self.text[self.place.clone()].chars().count().max(1);
        let (blank, carets) = (" ".repeat(before), "^".repeat(under));
        write!(f, "{}\n  --set {}\n        {blank}{carets}", self.reason, self.text)
    }
}

impl FromStr for Range {
    type Err = RangeError;

    fn from_str(text: &str) -> Result<Self, RangeError> {
        let wrong = |place: ops::Range<usize>, reason: String| RangeError {
            text: text.to_owned(),
            place,
            reason,
        };
        let shape = "expected NAME=FROM:TO:COUNT, such as L=0.1:1.0:10, or NAME=VALUE";
        let whole = || wrong(0..text.len(), shape.to_owned());
        let (name, _) = text.split_once('=').ok_or_else(whole)?;
        if name.trim().is_empty() {
            return Err(whole());
        }
        let mut start = name.len() + 1;
        let mut parts = Vec::new();
        for part in text[start..].split(':') {
            parts.push((start..start + part.len(), part.trim()));
            start += part.len() + 1;
        }
        let number = |(place, part): &(ops::Range<usize>, &str)| {
            let number = part.parse::<f64>().ok().filter(|number| number.is_finite());
            number.ok_or_else(|| wrong(place.clone(), format!("`{part}` is not a finite number")))
        };
        let (from, to, count) = match parts.as_slice() {
            [one] => (number(one)?, number(one)?, 1),
            [from, to, (place, count)] => {
                let reason = || format!("`{count}` is not a count from 1");
                let count = count.parse::<usize>().ok().filter(|&count| count > 0);
                let count = count.ok_or_else(|| wrong(place.clone(), reason()))?;
                let (first, last) = (number(from)?, number(to)?);
                let both = from.0.start..to.0.end;
                if first > last || (first == last && count > 1) {
                    let reason = format!("the range is empty: {first} is not below {last}");
                    return Err(wrong(both, reason));
                }
                if first < last && count == 1 {
                    return Err(wrong(place.clone(), "a range has two ends, so 2 or more".into()));
                }
                (first, last, count)
            }
            _ => return Err(whole()),
        };
        Ok(Range { name: name.trim().to_owned(), from, to, count, text: text.to_owned() })
    }
}

impl Range {
    /// The i-th value, from 0.
    pub fn value(&self, i: usize) -> f64 {
        if i + 1 >= self.count.max(2) {
            return self.to;
        }
        let s = i as f64 / (self.count.max(2) - 1) as f64;
        (1.0 - s) * self.from + s * self.to
    }

    /// What is wrong with its name.
    pub(super) fn misnamed(&self, reason: String) -> RangeError {
        let start = self.text.find(&self.name).unwrap_or(0);
        RangeError { text: self.text.clone(), place: start..start + self.name.len(), reason }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_has_its_ends_and_equal_steps() {
        let range: Range = " L = 0.25:1.0:4".parse().unwrap();
        assert_eq!(range.name, "L");
        let values: Vec<f64> = (0..range.count).map(|i| range.value(i)).collect();
        assert_eq!(values, [0.25, 0.5, 0.75, 1.0]);
        let wide: Range = "x=-1e308:1e308:3".parse().unwrap();
        assert_eq!((0..3).map(|i| wide.value(i)).collect::<Vec<_>>(), [-1e308, 0.0, 1e308]);
        let one: Range = "x=3".parse().unwrap();
        assert_eq!((one.count, one.value(0)), (1, 3.0));
        let same: Range = "x=3:3:1".parse().unwrap();
        assert_eq!((same.count, same.value(0)), (1, 3.0));
    }

    #[test]
    fn what_is_no_range_is_answered_at_its_place() {
        let cases = [
            ("L", "expected NAME=FROM", 0, 1),
            ("=1:2:3", "expected NAME=FROM", 0, 6),
            ("L=1:2", "expected NAME=FROM", 0, 5),
            ("L=1:2:3:4", "expected NAME=FROM", 0, 9),
            ("L=0.1:nan:10", "`nan` is not a finite number", 6, 3),
            ("L=inf:1:10", "`inf` is not a finite number", 2, 3),
            ("L=1e999:1:10", "`1e999` is not a finite number", 2, 5),
            ("L=a", "`a` is not a finite number", 2, 1),
            ("L=", "`` is not a finite number", 2, 1),
            ("L=0:1:0", "`0` is not a count from 1", 6, 1),
            ("L=0:1:-2", "`-2` is not a count from 1", 6, 2),
            ("L=0:1:2.5", "`2.5` is not a count from 1", 6, 3),
            ("L=1:0.1:5", "the range is empty: 1 is not below 0.1", 2, 5),
            ("L=1:1:5", "the range is empty: 1 is not below 1", 2, 3),
            ("L=0:1:1", "a range has two ends", 6, 1),
            ("é=1:ü:5", "`ü` is not a finite number", 4, 1),
        ];
        for (text, reason, before, under) in cases {
            let said = text.parse::<Range>().unwrap_err().to_string();
            let lines: Vec<&str> = said.lines().collect();
            assert!(lines[0].starts_with(reason), "{said}");
            assert_eq!(lines[1], format!("  --set {text}"));
            assert_eq!(lines[2], format!("{}{}", " ".repeat(8 + before), "^".repeat(under)));
        }
    }
}
