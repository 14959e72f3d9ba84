//! How a series looks: a colour, a marker and a dash that follow its name through the whole report.

use std::collections::{BTreeMap, BTreeSet};

use crate::canvas::number;
use crate::palette::HUES;
use crate::path::polyline;

const MARKERS: usize = 8;
/// Names that are no method: what measured ones are compared with. They are drawn in ink.
const NEUTRAL: [&str; 2] = ["exact", "reference"];
/// The place after the palette stands for ink.
const INK: usize = HUES;

/// The look of one name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Style {
    pub(crate) colour: usize,
    marker: usize,
    dash: usize,
}

impl Style {
    /// The look that a place in the list of known names gives.
    fn listed(place: usize) -> Self {
        let round = place / HUES;
        Style { colour: place % HUES, marker: (place + round) % MARKERS, dash: round % 3 }
    }

    /// The classes of everything drawn for the name.
    pub(crate) fn class(&self) -> String {
        match self.dash {
            _ if self.colour == INK => "ref".to_owned(),
            0 => format!("s{}", self.colour),
            dash => format!("s{} dash{dash}", self.colour),
        }
    }

    /// The marker as an element, centred at the origin and this much larger than usual.
    pub(crate) fn mark(&self, larger: f64) -> String {
        let outline = self.outline((0.0, 0.0));
        match larger {
            1.0 => format!(r#"<path class="mk" d="{outline}"/>"#),
            _ => format!(r#"<path class="mk" transform="scale({larger})" d="{outline}"/>"#),
        }
    }

    /// Path data of the marker.
    pub(crate) fn outline(&self, centre: (f64, f64)) -> String {
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
    let colour = (0..HUES).min_by_key(|&colour| uses(colour)).unwrap_or(0);
    let marked = |marker: usize| taken.iter().filter(|style| style.marker == marker).count();
    // A marker of its own even where the colour is free: it is all that is left without hue.
    let marker = (0..MARKERS)
        .map(|shift| (colour + shift) % MARKERS)
        .min_by_key(|&marker| marked(marker))
        .unwrap_or(0);
    Style { colour, marker, dash: uses(colour) % 3 }
}

#[cfg(test)]
mod tests {
    use super::*;

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
