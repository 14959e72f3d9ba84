//! The palette: every colour of every picture, on light and on dark paper, and the style sheet.
//!
//! ```text
//! .s0{color:#1769c4}                                              what any renderer understands
//! @supports (color:var(--s0)){ :root{--s0:#1769c4} .s0{color:var(--s0)} }      what a page may theme
//! ```
//! A declaration with a variable is never beside its plain value in one rule: renderers that know no
//! variables (resvg) take the last declaration and paint what they cannot read in black. They skip
//! what stands within `@supports`, and browsers do not.

use std::fmt::Write;

/// How many hues there are before they repeat.
pub const HUES: usize = 8;

/// Colours after Okabe and Ito, moved in lightness so that a line has contrast 3 and a text 4.5 on
/// both papers, and so that neighbours differ in lightness for those who see fewer hues.
const HUE: [Hue; HUES] = [
    Hue { line: "#1769c4", text: "#155fb3", dark: "#4c95ec" },
    Hue { line: "#cf4a0a", text: "#b84108", dark: "#f3672f" },
    Hue { line: "#0c8a68", text: "#0a7458", dark: "#45d3a6" },
    Hue { line: "#8c1d64", text: "#8c1d64", dark: "#c77fb0" },
    Hue { line: "#c38410", text: "#8f6008", dark: "#ecb240" },
    Hue { line: "#4699cf", text: "#23749f", dark: "#8cd6f6" },
    Hue { line: "#5e4a12", text: "#5e4a12", dark: "#f9eb9a" },
    Hue { line: "#3d4349", text: "#3d4349", dark: "#dfe3e8" },
];

/// What is no hue: the variable, its value on light and on dark paper.
const TONES: [(&str, &str, &str); 15] = [
    ("paper", "#ffffff", "#15181c"),
    ("ink", "#1d2126", "#eceff2"),
    ("muted", "#5a626b", "#a3abb4"),
    ("strong", "#565b62", "#b9bec5"),
    ("faint", "#c2c6cc", "#4a5057"),
    ("grid", "#e8eaed", "#272c32"),
    ("axis", "#9aa1a9", "#626a73"),
    ("rest", "#b4bac1", "#4d545c"),
    ("halo", "#f6d98b", "#6a5620"),
    ("lane", "#fbf3f0", "#251d1b"),
    ("o0", "#cfe3f4", "#1c3850"),
    ("o1", "#f1b79a", "#7d3a1d"),
    ("o2", "#f7e3a4", "#655419"),
    ("o3", "#e3bfd6", "#603350"),
    ("o4", "#d5d8dc", "#444a51"),
];

/// One hue on light paper, as line and as text, and on dark paper.
#[derive(Clone, Copy, Debug)]
struct Hue {
    line: &'static str,
    text: &'static str,
    dark: &'static str,
}

/// What a line or an area of a [`Canvas`](crate::Canvas) is painted with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// One of the [`HUES`] hues; they repeat.
    Hue(usize),
    /// As strong as text.
    Ink,
    /// Between ink and muted: what is there now.
    Strong,
    /// Of scales and captions.
    Muted,
    /// Of frames, and of what was there before.
    Faint,
}

impl Tone {
    /// The class that has this tone as its current colour.
    pub(crate) fn class(self) -> String {
        match self {
            Tone::Hue(hue) => format!("s{}", hue % HUES),
            Tone::Ink => "ref".to_owned(),
            Tone::Strong => "strong".to_owned(),
            Tone::Muted => "soft".to_owned(),
            Tone::Faint => "faint".to_owned(),
        }
    }

    /// The plain value of the tone on light paper, as `#rrggbb`: what a renderer without variables
    /// shows.
    #[must_use]
    pub fn on_light_paper(self) -> &'static str {
        let named = |name: &str| TONES.iter().find(|tone| tone.0 == name).map_or("", |tone| tone.1);
        match self {
            Tone::Hue(hue) => HUE[hue % HUES].line,
            Tone::Ink => named("ink"),
            Tone::Strong => named("strong"),
            Tone::Muted => named("muted"),
            Tone::Faint => named("faint"),
        }
    }
}

/// Every variable with its value on light and on dark paper.
fn values() -> Vec<(String, &'static str, &'static str)> {
    let hues = HUE.iter().enumerate().flat_map(|(i, hue)| {
        [(format!("s{i}"), hue.line, hue.dark), (format!("t{i}"), hue.text, hue.dark)]
    });
    hues.chain(TONES.iter().map(|&(name, light, dark)| (name.to_owned(), light, dark))).collect()
}

/// Rules that give the elements that a selector names the palette as variables, in light and in dark:
/// `--paper`, `--ink`, `--muted`, `--strong`, `--faint`, `--grid`, `--axis`, the hues `--s0` to `--s7`
/// of lines and `--t0` to `--t7` of text.
///
/// For a page whose own drawings share the palette; [`sheet`] holds them already.
///
/// ```
/// assert!(stationary_chart::variables(":root").starts_with(":root{--s0:#1769c4;"));
/// ```
#[must_use]
pub fn variables(selector: &str) -> String {
    let (mut light, mut dark) = (String::new(), String::new());
    for (name, on_light, on_dark) in values() {
        // Writing to a String cannot fail.
        let _ = write!(light, "--{name}:{on_light};");
        let _ = write!(dark, "--{name}:{on_dark};");
    }
    format!(
        "{selector}{{{light}}}\n@media screen and (prefers-color-scheme:dark){{{selector}{{{dark}}}}}\n"
    )
}

/// The style sheet of every chart, once for a page that holds charts of
/// [`Medium::Inline`](crate::Medium::Inline): plain colours first, then the same rules with variables for whoever knows
/// those. The page may set the variables that [`variables`] lists to values of its own.
#[must_use]
pub fn sheet() -> String {
    let themed = rules();
    let plain = values().iter().fold(themed.clone(), |css, (name, light, _)| {
        css.replace(&format!("var(--{name})"), light)
    });
    let coloured: String = themed.lines().filter(|rule| rule.contains("var(")).collect();
    format!("{plain}@supports (color:var(--ink)){{\n{}{coloured}\n}}\n", variables(":root"))
}

/// The rules, one a line, with variables.
fn rules() -> String {
    let mut rules = String::new();
    for i in 0..HUES {
        let _ = writeln!(rules, ".s{i}{{color:var(--s{i})}}");
        let _ = writeln!(rules, ".chart .s{i} text{{fill:var(--t{i})}}");
    }
    rules + include_str!("chart.css")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// WCAG 2 relative luminance.
    fn luminance(hex: &str) -> f64 {
        let channel = |i: usize| {
            let c = f64::from(u8::from_str_radix(&hex[i..i + 2], 16).unwrap()) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5)
    }

    fn contrast(a: &str, b: &str) -> f64 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn lines_and_texts_have_contrast_on_both_papers() {
        let (_, light, dark) = TONES[0];
        for hue in HUE {
            assert!(contrast(hue.line, light) >= 3.0, "{hue:?}");
            assert!(contrast(hue.text, light) >= 4.5, "{hue:?}");
            assert!(contrast(hue.dark, dark) >= 4.5, "{hue:?}");
        }
    }

    #[test]
    fn every_colour_has_a_plain_value_before_its_variable() {
        let sheet = sheet();
        let (plain, themed) = sheet.split_once("@supports").unwrap();
        assert!(!plain.contains("var("), "{plain}");
        assert!(themed.contains("prefers-color-scheme:dark"));
        for used in themed.split("var(--").skip(2).map(|rest| rest.split(')').next().unwrap()) {
            assert!(themed.contains(&format!("--{used}:#")), "--{used} has no value");
        }
        let declarations = |css: &str| css.matches(":#").count();
        assert!(declarations(plain) > 40);
    }

    #[test]
    fn braces_of_the_sheet_are_closed() {
        let depth = sheet().chars().fold(0_i32, |depth, letter| match letter {
            '{' => depth + 1,
            '}' => depth - 1,
            _ => depth,
        });
        assert_eq!(depth, 0);
    }
}
