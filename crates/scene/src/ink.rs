//! Colours of drawings, for light and for dark paper, and text that cannot end its element.

/// Colours of what moves, in turn, on light and on dark paper.
pub(crate) const COLOURS: [(&str, &str); 7] = [
    ("#2a6fbb", "#6cb0f5"),
    ("#c8501e", "#f59a6e"),
    ("#2f8a5b", "#6fcf9f"),
    ("#8a4fb0", "#c79be8"),
    ("#b0871a", "#e5c463"),
    ("#b83a6b", "#f08fb4"),
    ("#4d7580", "#9cc3cd"),
];

const LIGHT: &str = "--paper:#fdfcf9;--ink:#22211e;--soft:#6b6963;--start:#c4c0b5;--end:#5b5850;";
const DARK: &str = "--paper:#17181a;--ink:#ebe9e4;--soft:#a19e96;--start:#4c4d50;--end:#b9b6ae;";

/// Rules that give the elements of this name the colours as variables.
pub(crate) fn variables(element: &str) -> String {
    let numbered = |pick: fn(&(&'static str, &'static str)) -> &'static str| -> String {
        let all = COLOURS.iter().enumerate();
        all.map(|(i, pair)| format!("--c{i}:{};", pick(pair))).collect()
    };
    let (light, dark) = (numbered(|pair| pair.0), numbered(|pair| pair.1));
    format!(
        "{element}{{{LIGHT}{light}}}\n\
         @media(prefers-color-scheme:dark){{{element}{{{DARK}{dark}}}}}\n"
    )
}

/// The text, with the characters that mean something in XML written otherwise.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // Characters that XML does not allow in any form.
            '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_title_cannot_end_its_element() {
        let title = "</text><script>&\"";
        assert_eq!(escaped(title), "&lt;/text&gt;&lt;script&gt;&amp;&quot;");
    }
}
