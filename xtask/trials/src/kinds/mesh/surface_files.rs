//! Texts of OBJ and MSH files, with all that the formats allow, written from meshes that are known.

mod msh;
mod obj;

use crate::{Draw, Verdict};

pub(super) fn trial(draw: &mut Draw) -> Verdict {
    if draw.chance(0.7) { obj::trial(draw) } else { msh::trial(draw) }
}

/// A coordinate in one of the ways in which numbers are written, and its value.
fn written(draw: &mut Draw, x: f64) -> (String, f64) {
    let text = match draw.below(4) {
        0 => format!("{x:?}"),
        1 => format!("{x:e}"),
        2 => format!("{x:.3}"),
        _ => format!("{x:.6E}"),
    };
    let value = text.parse().expect("a number");
    (text, value)
}

/// Whether the words of an error name a line.
fn names_line(words: &str, line: usize) -> bool {
    let mut rest = words;
    while let Some(place) = rest.find("line ") {
        rest = &rest[place + 5..];
        let number: String = rest.chars().take_while(char::is_ascii_digit).collect();
        if number == line.to_string() {
            return true;
        }
    }
    false
}
