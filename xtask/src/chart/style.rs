//! How a series looks: a colour, a marker and a dash that follow its name through the whole report.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use super::canvas::{number, polyline};

/// Colours after Okabe and Ito, moved in lightness so that a line has contrast 3 and a text 4.5 on
/// both papers, and so that neighbours differ in lightness for those who see fewer hues.
pub(super) const PALETTE: [Colour; 8] = [
    Colour { line: "#1769c4", text: "#155fb3", dark: "#4c95ec" },
    Colour { line: "#cf4a0a", text: "#b84108", dark: "#f3672f" },
    Colour { line: "#0c8a68", text: "#0a7458", dark: "#45d3a6" },
    Colour { line: "#8c1d64", text: "#8c1d64", dark: "#c77fb0" },
    Colour { line: "#c38410", text: "#8f6008", dark: "#ecb240" },
    Colour { line: "#4699cf", text: "#23749f", dark: "#8cd6f6" },
    Colour { line: "#5e4a12", text: "#5e4a12", dark: "#f9eb9a" },
    Colour { line: "#3d4349", text: "#3d4349", dark: "#dfe3e8" },
];

/// Paper in light and in dark.
pub(super) const PAPER: (&str, &str) = ("#ffffff", "#15181c");

/// One hue on light paper, as line and as text, and on dark paper.
#[derive(Clone, Copy, Debug)]
pub(super) struct Colour {
    pub(super) line: &'static str,
    pub(super) text: &'static str,
    pub(super) dark: &'static str,
}

const MARKERS: usize = 8;
/// Names that are no method: what measured ones are compared with. They are drawn in ink.
const NEUTRAL: [&str; 2] = ["exact", "reference"];
/// The place after the palette stands for ink.
const INK: usize = PALETTE.len();

/// The look of one name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Style {
    pub(super) colour: usize,
    marker: usize,
    dash: usize,
}

impl Style {
    /// The look that a place in the list of known names gives.
    fn listed(place: usize) -> Self {
        let round = place / PALETTE.len();
        Style { colour: place % PALETTE.len(), marker: (place + round) % MARKERS, dash: round % 3 }
    }

    /// The classes of everything drawn for the name.
    pub(super) fn class(&self) -> String {
        match self.dash {
            _ if self.colour == INK => "ref".to_owned(),
            0 => format!("s{}", self.colour),
            dash => format!("s{} dash{dash}", self.colour),
        }
    }

    /// The marker as an element, centred at the origin.
    pub(super) fn mark(&self) -> String {
        format!(r#"<path class="mk" d="{}"/>"#, self.outline((0.0, 0.0)))
    }

    /// Path data of the marker.
    pub(super) fn outline(&self, centre: (f64, f64)) -> String {
        match self.marker {
            0 => circle(centre, 4.2),
            1 => polygon(centre, 5.2, 4, 45.0),
            2 => polygon(centre, 5.6, 3, -90.0),
            3 => polygon(centre, 5.4, 4, 0.0),
            4 => polygon(centre, 5.6, 3, 90.0),
            5 => polygon(centre, 5.2, 6, 0.0),
            6 => star(centre, 6.2, 2.6, 5),
            _ => star(centre, 6.0, 2.2, 4),
        }
    }
}

fn circle((x, y): (f64, f64), r: f64) -> String {
    let (left, d) = (number(x - r), number(2.0 * r));
    let (r, y) = (number(r), number(y));
    format!("M{left} {y}a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0z")
}

fn polygon(centre: (f64, f64), r: f64, corners: usize, first_degrees: f64) -> String {
    let corner = |i: usize| {
        let angle = (first_degrees + 360.0 * i as f64 / corners as f64).to_radians();
        (centre.0 + r * angle.cos(), centre.1 + r * angle.sin())
    };
    polyline(&(0..corners).map(corner).collect::<Vec<_>>()) + "z"
}

fn star(centre: (f64, f64), outer: f64, inner: f64, points: usize) -> String {
    let corner = |i: usize| {
        let r = if i.is_multiple_of(2) { outer } else { inner };
        let angle = std::f64::consts::PI * i as f64 / points as f64 - std::f64::consts::FRAC_PI_2;
        (centre.0 + r * angle.cos(), centre.1 + r * angle.sin())
    };
    polyline(&(0..2 * points).map(corner).collect::<Vec<_>>()) + "z"
}

/// The look of every name in a report.
#[derive(Clone, Debug, Default)]
pub struct Styles(BTreeMap<String, Style>);

impl Styles {
    /// Listed names take their place's look; each other name, in order of appearance, takes the
    /// first colour that no name on a chart with it has, and the first marker that keeps it apart.
    pub fn assign(listed: &[&str], charts: &[Vec<String>]) -> Self {
        let mut styles: BTreeMap<String, Style> = listed
            .iter()
            .enumerate()
            .map(|(place, name)| ((*name).to_owned(), Style::listed(place)))
            .collect();
        for name in charts.iter().flatten().filter(|name| !NEUTRAL.contains(&name.as_str())) {
            if !styles.contains_key(name) {
                let neighbours: BTreeSet<&String> =
                    charts.iter().filter(|names| names.contains(name)).flatten().collect();
                let taken: Vec<Style> =
                    neighbours.iter().filter_map(|other| styles.get(*other).copied()).collect();
                styles.insert(name.clone(), unlike(&taken));
            }
        }
        Styles(styles)
    }

    /// The look of a name: ink for `exact` and `reference`; a name that was not assigned has the
    /// first look.
    pub fn of(&self, name: &str) -> Style {
        if NEUTRAL.contains(&name) {
            return Style { colour: INK, ..Style::default() };
        }
        self.0.get(name).copied().unwrap_or_default()
    }
}

/// The first look whose colour, then marker, is least taken.
fn unlike(taken: &[Style]) -> Style {
    let uses = |colour: usize| taken.iter().filter(|style| style.colour == colour).count();
    let colour = (0..PALETTE.len()).min_by_key(|&colour| uses(colour)).unwrap_or(0);
    let marked = |marker: usize| taken.iter().filter(|style| style.marker == marker).count();
    // A marker of its own even where the colour is free: it is all that is left without hue.
    let marker = (0..MARKERS)
        .map(|shift| (colour + shift) % MARKERS)
        .min_by_key(|&marker| marked(marker))
        .unwrap_or(0);
    Style { colour, marker, dash: uses(colour) % 3 }
}

/// The style sheet of every chart. Plain values come before the variables, for viewers that know no
/// variables.
pub(crate) fn sheet() -> String {
    let mut light = String::new();
    let mut dark = String::new();
    let mut rules = String::new();
    // Writing to a String cannot fail.
    for (i, Colour { line, text, dark: bright }) in PALETTE.iter().enumerate() {
        let _ = write!(light, "--s{i}:{line};--t{i}:{text};");
        let _ = write!(dark, "--s{i}:{bright};--t{i}:{bright};");
        let _ = writeln!(
            rules,
            ".s{i}{{color:{line};color:var(--s{i})}} .chart .s{i} text{{fill:{text};fill:var(--t{i})}}"
        );
    }
    let (paper, night) = PAPER;
    format!(
        ":root{{--paper:{paper};{light}{LIGHT}}}\n\
         @media screen and (prefers-color-scheme:dark){{:root{{--paper:{night};{dark}{DARK}}}}}\n\
         {rules}{}",
        include_str!("chart.css")
    )
}

const LIGHT: &str = "--ink:#1d2126;--muted:#5a626b;--grid:#e8eaed;--axis:#9aa1a9;--halo:#f6d98b;\
    --lane:#fbf3f0;--o0:#cfe3f4;--o1:#f1b79a;--o2:#f7e3a4;--o3:#e3bfd6;--o4:#d5d8dc;";
const DARK: &str = "--ink:#eceff2;--muted:#a3abb4;--grid:#272c32;--axis:#626a73;--halo:#6a5620;\
    --lane:#251d1b;--o0:#1c3850;--o1:#7d3a1d;--o2:#655419;--o3:#603350;--o4:#444a51;";

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
        for colour in PALETTE {
            assert!(contrast(colour.line, PAPER.0) >= 3.0, "{colour:?}");
            assert!(contrast(colour.text, PAPER.0) >= 4.5, "{colour:?}");
            assert!(contrast(colour.dark, PAPER.1) >= 4.5, "{colour:?}");
        }
    }

    fn names(names: &[&str]) -> Vec<String> {
        names.iter().map(|name| (*name).to_owned()).collect()
    }

    #[test]
    fn a_name_looks_the_same_on_every_chart_and_unlike_its_neighbours() {
        let charts = [names(&["a", "b"]), names(&["c", "a"]), names(&["b", "c", "d"])];
        let styles = Styles::assign(&[], &charts);
        for chart in &charts {
            let looks: BTreeSet<usize> = chart.iter().map(|n| styles.of(n).colour).collect();
            assert_eq!(looks.len(), chart.len());
        }
    }

    #[test]
    fn listed_names_look_the_same_in_every_report() {
        let listed = ["verlet", "rk4"];
        let all = Styles::assign(&listed, &[names(&["x", "rk4", "verlet"])]);
        let one = Styles::assign(&listed, &[names(&["rk4"])]);
        assert_eq!(all.of("rk4"), one.of("rk4"));
    }

    #[test]
    fn what_methods_are_compared_with_takes_no_colour_of_theirs() {
        let styles = Styles::assign(&[], &[names(&["exact", "a"])]);
        assert_eq!(
            (styles.of("exact").class(), styles.of("a").class()),
            ("ref".into(), "s0".into())
        );
    }

    #[test]
    fn more_names_than_colours_still_differ() {
        let many: Vec<String> = (0..20).map(|i| format!("method {i}")).collect();
        let styles = Styles::assign(&[], std::slice::from_ref(&many));
        let looks: BTreeSet<String> = many.iter().map(|n| format!("{:?}", styles.of(n))).collect();
        assert_eq!(looks.len(), many.len());
    }
}
