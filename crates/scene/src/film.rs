//! The film strip of a run: a handful of moments side by side, all seen alike.
//!
//! ```text
//! t_k = k T/5,   k = 0 .. 5        the samples nearest before, T the end
//! ```
//! Each shows the paths since the one before. One SVG file like the picture, whose lines and colours
//! it shares.

use std::fmt;

use crate::Run;
use crate::drawing::thinned;
use crate::ink::escaped;
use crate::projection::Extent;
use crate::sheet::{Axes, Sheet, styles};

/// Moments, and how many stand side by side.
const MOMENTS: usize = 6;
const ACROSS: usize = 3;

/// Paper of a moment, and round them all.
const WIDTH: f64 = 300.0;
const TALLEST: f64 = 300.0;
const FLATTEST: f64 = 90.0;
const GAP: f64 = 16.0;
const MARGIN: f64 = 28.0;
const HEADER: f64 = 62.0;
const CAPTION: f64 = 30.0;

/// Spots beyond this number would hide what they mark.
const SPOTS: usize = 60;

/// Points of the paths since the moment before.
const POINTS: usize = 10_000;

/// A run as a strip of moments.
#[derive(Debug)]
pub(crate) struct Film<'a> {
    run: &'a Run,
    samples: Vec<usize>,
    walls: Vec<[[f64; 2]; 4]>,
    /// `None` where the scene's size is not finite.
    sheet: Option<Sheet<'a>>,
}

impl<'a> Film<'a> {
    /// The film strip of a run.
    pub(crate) fn of(run: &'a Run) -> Self {
        let (samples, axes) = (thinned(run.times().len(), MOMENTS), Axes::of(run));
        let all = 0..run.scene.particles.len();
        let at = |sample: usize, particle: usize| axes.of_particle(run, sample, particle);
        let moments = samples
            .iter()
            .flat_map(|&sample| all.clone().map(move |particle| at(sample, particle)));
        let moving = run.scene.moving(SPOTS);
        let paths = moving.iter().flat_map(|&p| (0..run.times().len()).map(move |i| at(i, p)));
        let walls = axes.of_walls(run);
        let points = moments.chain(paths).chain(walls.iter().copied().flatten());
        let inner = WIDTH - 2.0 * GAP;
        let sheet = Extent::of(points)
            .map(|extent| Sheet::new(run, axes, extent, [GAP; 2], inner, FLATTEST..=TALLEST));
        Film { run, samples, walls, sheet }
    }

    fn frame_height(&self) -> f64 {
        self.sheet.as_ref().map_or(FLATTEST, |sheet| sheet.height) + 2.0 * GAP
    }

    fn size(&self) -> [f64; 2] {
        let rows = self.samples.len().div_ceil(ACROSS) as f64;
        let columns = self.samples.len().min(ACROSS) as f64;
        let width = columns * WIDTH + (columns - 1.0) * GAP + 2.0 * MARGIN;
        [width, HEADER + rows * (self.frame_height() + CAPTION) + MARGIN]
    }

    fn moment(&self, f: &mut fmt::Formatter<'_>, place: usize, sheet: &Sheet<'_>) -> fmt::Result {
        let (row, column) = (place / ACROSS, place % ACROSS);
        let x = MARGIN + column as f64 * (WIDTH + GAP);
        let y = HEADER + row as f64 * (self.frame_height() + CAPTION);
        let (sample, height) = (self.samples[place], self.frame_height());
        writeln!(f, "<g transform=\"translate({x:.1} {y:.1})\">")?;
        let frame = format!("width=\"{WIDTH}\" height=\"{height:.1}\" rx=\"4\"");
        writeln!(f, "<rect class=\"frame\" {frame}/>")?;
        let moving = self.run.scene.moving(SPOTS);
        let before = place.checked_sub(1).map_or(sample, |before| self.samples[before]);
        sheet.walls(f, &self.walls)?;
        sheet.faces(f, sample)?;
        sheet.paths(f, before..=sample, &moving, POINTS)?;
        sheet.lines(f, sample, "end")?;
        sheet.spots(f, sample, &moving, 3.5)?;
        sheet.pins(f)?;
        let time = self.run.times().get(sample).copied().unwrap_or_default();
        let caption = format!("t = {} {}", rounded(time), self.run.scene.units.time);
        let at = format!("x=\"{:.1}\" y=\"{:.1}\"", 0.5 * WIDTH, height + 19.0);
        writeln!(f, "<text class=\"mid\" {at}>{}</text>\n</g>", escaped(&caption))
    }
}

/// The number with four digits, and no more zeros than it needs.
fn rounded(x: f64) -> String {
    let digits: f64 = format!("{x:.3e}").parse().unwrap_or(x);
    if digits != 0.0 && !(1e-4..1e9).contains(&digits.abs()) {
        return format!("{digits:e}");
    }
    digits.to_string()
}

impl fmt::Display for Film<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([width, height], title) = (self.size(), escaped(self.run.scene().title()));
        let height = height.ceil();
        writeln!(
            f,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
             width=\"{width}\" height=\"{height}\" role=\"img\" aria-label=\"{title}\">"
        )?;
        writeln!(f, "<title>{title}</title>")?;
        styles(f)?;
        writeln!(f, "<rect class=\"paper\" width=\"{width}\" height=\"{height}\"/>")?;
        writeln!(f, "<text class=\"title\" x=\"{MARGIN}\" y=\"38\">{title}</text>")?;
        match &self.sheet {
            Some(sheet) => {
                for place in 0..self.samples.len() {
                    self.moment(f, place, sheet)?;
                }
            }
            None => writeln!(
                f,
                "<text class=\"soft\" x=\"{MARGIN}\" y=\"90\">The scene is too large to draw.</text>"
            )?,
        }
        writeln!(f, "</svg>")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_rounded_to_four_digits() {
        let all = [0.0, 0.1 + 0.2, 40_000.0, 123_456.0, 1.5e-9, 2.0e12];
        let texts = all.map(rounded);
        assert_eq!(texts, ["0", "0.3", "40000", "123500", "1.5e-9", "2e12"]);
    }
}
