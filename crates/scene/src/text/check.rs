//! Checks of single values: a number, a vector, a word, a name.

use std::ops::Range;

use toml::Spanned;

use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::text::limits;
use crate::text::number::{Components, Number};
use crate::text::suggestion::{nearest, shortened};

/// A finite number.
pub(crate) fn finite(what: &'static str, number: &Spanned<Number>) -> Checked<f64> {
    let value = number.get_ref().0;
    if value.is_finite() {
        return Ok(value);
    }
    Err(at(number.span(), Fault::NotFinite { what, value }))
}

/// A positive number that is finite, and one over it as well.
pub(crate) fn positive(what: &'static str, number: &Spanned<Number>) -> Checked<f64> {
    let value = number.get_ref().0;
    if value > 0.0 && value.is_finite() && value.recip().is_finite() {
        return Ok(value);
    }
    Err(at(number.span(), Fault::NotPositive { what, value }))
}

/// A finite number that is not negative.
pub(crate) fn not_negative(what: &'static str, number: &Spanned<Number>) -> Checked<f64> {
    match finite(what, number)? {
        value if value >= 0.0 => Ok(value),
        value => Err(at(number.span(), Fault::Negative { what, value })),
    }
}

/// A finite vector of the scene's dimension, as a vector in space.
pub(crate) fn vector(
    what: &'static str,
    dimension: usize,
    components: &Components,
) -> Checked<[f64; 3]> {
    let got = components.get_ref().len();
    if got != dimension {
        let fault = Fault::VectorLength { what, expected: dimension, got };
        return Err(at(components.span(), fault));
    }
    let mut x = [0.0; 3];
    for (x, component) in x.iter_mut().zip(components.get_ref()) {
        *x = finite(what, component)?;
    }
    Ok(x)
}

/// A vector of unit length.
pub(crate) fn direction(
    what: &'static str,
    dimension: usize,
    components: &Components,
) -> Checked<[f64; 3]> {
    let x = vector(what, dimension, components)?;
    let largest = x.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    if largest == 0.0 {
        return Err(at(components.span(), Fault::NoDirection { what }));
    }
    let x = x.map(|x| x / largest);
    let length = x.iter().map(|x| x * x).sum::<f64>().sqrt();
    Ok(x.map(|x| x / length))
}

/// Two unit vectors at a right angle, each as it is given or else as it usually is.
pub(crate) fn right_angle(
    dimension: usize,
    place: Range<usize>,
    both: [(&'static str, &Option<Components>, [f64; 3]); 2],
) -> Checked<[[f64; 3]; 2]> {
    /// The cosine of an angle that is a right one but for rounding.
    const RIGHT: f64 = 1e-9;
    let (mut place, mut directions) = (place, both.map(|(_, _, usual)| usual));
    for (unit, (what, given, _)) in directions.iter_mut().zip(&both) {
        if let Some(given) = given {
            *unit = direction(what, dimension, given)?;
            place = given.span();
        }
    }
    let [a, b] = directions;
    let cosine: f64 = a.iter().zip(&b).map(|(a, b)| a * b).sum();
    if cosine.abs() > RIGHT {
        return Err(at(place, Fault::NotPerpendicular));
    }
    Ok(directions)
}

/// The one of `all` that the word names.
pub(crate) fn word<T: Copy>(
    kind: &'static str,
    word: &str,
    span: Range<usize>,
    all: &[(&'static str, T)],
) -> Checked<T> {
    if let Some(&(_, meaning)) = all.iter().find(|(name, _)| *name == word) {
        return Ok(meaning);
    }
    Err(at(span, unknown(kind, word, all.iter().map(|&(name, _)| name), all.len())))
}

/// Names listed in an error; more would not help.
pub(crate) const LISTED: usize = 12;

/// What the name stands for.
pub(crate) fn named<T: Copy>(
    kind: &'static str,
    name: &Spanned<String>,
    all: &[(&str, T)],
) -> Checked<T> {
    let word = name.get_ref();
    if let Some(&(_, meaning)) = all.iter().find(|(other, _)| other == word) {
        return Ok(meaning);
    }
    Err(at(name.span(), unknown(kind, word, all.iter().map(|&(name, _)| name), LISTED)))
}

/// A word that is none of these, which are listed if they are no more than so many.
pub(crate) fn unknown<'a>(
    kind: &'static str,
    word: &str,
    words: impl Iterator<Item = &'a str> + Clone,
    listed: usize,
) -> Fault {
    let nearest = nearest(word, words.clone()).map(str::to_owned);
    let few = words.clone().nth(listed).is_none();
    let allowed = words.filter(|_| few).map(str::to_owned).collect();
    Fault::UnknownWord { kind, word: shortened(word), nearest, allowed }
}

/// A name that can stand in a heading without quotes, and cannot be taken for a net's vertex.
pub(crate) fn name(name: &Spanned<String>) -> Checked<String> {
    let text = name.get_ref();
    let start = text.chars().next().is_some_and(char::is_alphanumeric);
    let plain = |c: char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    if start && text.chars().all(plain) && text.chars().count() <= limits::NAME {
        return Ok(text.clone());
    }
    Err(at(name.span(), Fault::Name))
}

/// A title or a unit, or what stands for it where none is given.
pub(crate) fn title(
    what: &'static str,
    title: Option<&Spanned<String>>,
    otherwise: &str,
) -> Checked<String> {
    let Some(title) = title else {
        return Ok(otherwise.to_owned());
    };
    let text = title.get_ref();
    let length = text.chars().count();
    if (1..=limits::TITLE).contains(&length) && !text.contains(char::is_control) {
        return Ok(text.clone());
    }
    Err(at(title.span(), Fault::Title { what }))
}
