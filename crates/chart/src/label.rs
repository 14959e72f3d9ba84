//! The text of a chart: runs of characters, some raised, whose width can be estimated without a font.

/// Size of every text in a chart, in pixels of the chart's own layout.
pub(crate) const TEXT: f64 = 13.0;
/// Size of a raised exponent, the smallest text there is.
pub(crate) const RAISED: f64 = 11.0;
/// Distance between two lines of text.
pub(crate) const LINE: f64 = 18.0;

/// A piece of a label.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Run {
    Plain(String),
    Raised(String),
}

/// One line of text.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Label(pub(crate) Vec<Run>);

impl Label {
    pub(crate) fn plain(text: impl Into<String>) -> Self {
        Label(vec![Run::Plain(text.into())])
    }

    /// `10` with an exponent; the first two powers are plain, as one writes them.
    pub(crate) fn power_of_ten(exponent: i32) -> Self {
        match exponent {
            0 => Label::plain("1"),
            1 => Label::plain("10"),
            _ => Label(vec![Run::Plain("10".into()), Run::Raised(signed(exponent))]),
        }
    }

    /// `2·10` with an exponent.
    pub(crate) fn multiple(mantissa: u32, exponent: i32) -> Self {
        if mantissa == 1 {
            return Label::power_of_ten(exponent);
        }
        Label(vec![Run::Plain(format!("{mantissa}·10")), Run::Raised(signed(exponent))])
    }

    pub(crate) fn then(mut self, other: Label) -> Self {
        self.0.extend(other.0);
        self
    }

    /// Width in pixels, rather too large than too small.
    pub(crate) fn width(&self) -> f64 {
        self.0
            .iter()
            .map(|run| match run {
                Run::Plain(text) => text_width(text, TEXT),
                Run::Raised(text) => text_width(text, RAISED),
            })
            .sum()
    }
}

/// An integer with the minus sign that is as wide as a plus.
fn signed(integer: i32) -> String {
    integer.to_string().replace('-', "−")
}

/// A number at a fixed count of decimals, with a true minus sign.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    // Rounding must not leave a minus before nothing.
    if text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') {
        return text.trim_start_matches('-').to_owned();
    }
    text.replace('-', "−")
}

/// A number with at most `digits` significant digits, for a tooltip or a table.
#[must_use]
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return value.to_string();
    }
    let scientific = format!("{value:.*e}", digits.max(1) - 1);
    let exponent: i32 = scientific.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    if value == 0.0 {
        "0".to_owned()
    } else if (-3..5).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        trimmed(&format!("{value:.decimals$}")).to_owned()
    } else {
        match scientific.split_once('e') {
            Some((mantissa, exponent)) => format!("{}e{exponent}", trimmed(mantissa)),
            None => scientific,
        }
    }
}

/// Without zeros that say nothing.
fn trimmed(number: &str) -> &str {
    if number.contains('.') { number.trim_end_matches('0').trim_end_matches('.') } else { number }
}

/// Width of a text in a sans-serif face, in pixels: a table by class of letter, on the wide side.
pub(crate) fn text_width(text: &str, size: f64) -> f64 {
    text.chars().map(letter_width).sum::<f64>() * size
}

fn letter_width(letter: char) -> f64 {
    match letter {
        'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' | ' ' | '·' => 0.33,
        'f' | 't' | 'r' | 'I' | '(' | ')' | '[' | ']' | '/' | '-' => 0.42,
        'm' | 'w' | 'M' | 'W' | '%' | '@' => 0.97,
        '+' | '=' | '<' | '>' | '−' | '×' | '≤' | '≥' => 0.84,
        'A'..='Z' => 0.74,
        _ => 0.635,
    }
}

/// Breaks a text into lines no wider than `width`, between words.
pub(crate) fn wrapped(text: &str, width: f64, size: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line)
                if text_width(line, size) + text_width(word, size) + 0.33 * size <= width =>
            {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn significant_digits_are_kept_and_empty_zeros_dropped() {
        assert_eq!(significant(0.0, 4), "0");
        assert_eq!(significant(0.25, 4), "0.25");
        assert_eq!(significant(1234.56, 4), "1235");
        assert_eq!(significant(9999.96, 5), "10000");
        assert_eq!(significant(1.5e-7, 4), "1.5e-7");
        assert_eq!(significant(-1e20, 4), "-1e20");
        assert_eq!(significant(f64::NAN, 4), "NaN");
    }

    #[test]
    fn rounding_leaves_no_negative_zero() {
        assert_eq!(fixed(-1e-9, 1), "0.0");
        assert_eq!(fixed(-0.5, 1), "−0.5");
    }

    #[test]
    fn no_wrapped_line_is_wider_than_asked_unless_it_is_one_word() {
        let lines = wrapped("energy error of a Kepler orbit over a thousand periods", 120.0, 13.0);
        assert!(lines.len() > 1);
        assert!(lines.iter().all(|l| text_width(l, 13.0) <= 120.0), "{lines:?}");
        assert_eq!(wrapped("incomprehensibilities", 20.0, 13.0).len(), 1);
    }
}
