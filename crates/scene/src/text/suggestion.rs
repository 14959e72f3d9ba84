//! The word that may have been meant.

use strsim::damerau_levenshtein;

use crate::text::limits;

/// The allowed word nearest to `word`: within a third of its letters, or else one that contains it
/// or is contained in it.
pub(crate) fn nearest<'a>(
    word: &str,
    allowed: impl Iterator<Item = &'a str> + Clone,
) -> Option<&'a str> {
    let length = word.chars().count();
    if length > limits::NAME {
        return None;
    }
    let close = allowed
        .clone()
        .filter(|candidate| candidate.len().abs_diff(word.len()) <= word.len())
        .map(|candidate| (damerau_levenshtein(word, candidate), candidate))
        .min_by_key(|&(distance, _)| distance)
        .filter(|&(distance, _)| distance <= length.div_ceil(3));
    let part = |candidate: &&str| {
        length >= 3
            && (candidate.contains(word) || (candidate.len() >= 3 && word.contains(*candidate)))
    };
    close.map(|(_, candidate)| candidate).or_else(|| allowed.clone().find(part))
}

/// The word, or its beginning where it is long.
pub(crate) fn shortened(word: &str) -> String {
    if word.chars().count() <= limits::NAME {
        return word.to_owned();
    }
    word.chars().take(limits::NAME).chain("...".chars()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const WORDS: [&str; 4] = ["stormer-verlet", "runge-kutta-4", "stiffness", "strain"];

    fn suggest(word: &str) -> Option<&'static str> {
        nearest(word, WORDS.into_iter())
    }

    #[test]
    fn a_slip_of_the_finger_finds_its_word() {
        assert_eq!(suggest("stiffnes"), Some("stiffness"));
        assert_eq!(suggest("stomrer-verlet"), Some("stormer-verlet"));
        assert_eq!(suggest("runge_kutta_4"), Some("runge-kutta-4"));
        assert_eq!(suggest("verlet"), Some("stormer-verlet"));
    }

    #[test]
    fn a_word_unlike_all_others_finds_none() {
        assert_eq!(suggest("colour"), None);
        assert_eq!(suggest(""), None);
        assert_eq!(suggest(&"strain".repeat(1_000_000)), None);
    }
}
