//! The film strip of a run: a handful of moments side by side, all seen alike.
//!
//! ```text
//! t_k = k T/5,   k = 0 .. 5        the samples nearest before, T the end
//! ```
//! Each shows the paths since the one before. One SVG file like the picture, whose lines and colours
//! it shares.

use stationary_chart::{Anchor, Canvas, Lettering, Medium, Path, Tone, significant};

use crate::run::samples::Run;
use crate::show::drawing::thinned;
use crate::show::projection::Extent;
use crate::show::sheet::{Axes, Sheet};

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
        let reaches = run.reaches();
        let reaches = reaches.as_slice();
        let at = |sample: usize, particle: usize| {
            axes.about(axes.of_particle(run, sample, particle), reaches[particle])
        };
        let moments = samples
            .iter()
            .flat_map(|&sample| all.clone().map(move |particle| at(sample, particle)));
        let moving = run.scene.moving(SPOTS);
        let paths = moving.iter().flat_map(|&p| (0..run.times().len()).map(move |i| at(i, p)));
        let walls = axes.of_walls(run);
        let fixed = walls.iter().copied().flatten().chain(axes.of_fixed_balls(run));
        let points = moments.chain(paths).flatten().chain(fixed);
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

    /// The text of the SVG file.
    pub(crate) fn svg(&self) -> String {
        let [width, height] = self.size();
        let mut canvas = Canvas::new(width, height);
        let title = self.run.scene().title();
        canvas.text(Lettering::Heading, (MARGIN, 38.0), Anchor::Start, title);
        match &self.sheet {
            Some(sheet) => {
                (0..self.samples.len()).for_each(|place| self.moment(&mut canvas, place, sheet));
            }
            None => {
                let words = "The scene is too large to draw.";
                canvas.text(Lettering::Remark, (MARGIN, 90.0), Anchor::Start, words);
            }
        }
        canvas.svg(Medium::File, title)
    }

    fn moment(&self, canvas: &mut Canvas, place: usize, sheet: &Sheet<'_>) {
        let (row, column) = (place / ACROSS, place % ACROSS);
        let x = MARGIN + column as f64 * (WIDTH + GAP);
        let y = HEADER + row as f64 * (self.frame_height() + CAPTION);
        let (sample, height) = (self.samples[place], self.frame_height());
        let moving = self.run.scene.moving(SPOTS);
        let before = place.checked_sub(1).map_or(sample, |before| self.samples[before]);
        let time = self.run.times().get(sample).copied().unwrap_or_default();
        let caption = format!("t = {} {}", significant(time, 4), self.run.scene.units.time);
        canvas.moved((x, y), |canvas| {
            let mut frame = Path::new();
            frame.outline(&[(0.0, 0.0), (WIDTH, 0.0), (WIDTH, height), (0.0, height)]);
            canvas.stroke(Tone::Faint, 1.0, &frame);
            sheet.walls(canvas, &self.walls);
            sheet.fixed_balls(canvas);
            let drawn = sheet.faces(canvas, sample);
            sheet.silhouettes(canvas, sample, Tone::Strong);
            sheet.paths(canvas, before..=sample, &moving, POINTS);
            sheet.lines(canvas, sample, Tone::Strong, &drawn);
            sheet.spots(canvas, sample, &moving, 3.5);
            sheet.pins(canvas);
            let at = (0.5 * WIDTH, height + 19.0);
            canvas.text(Lettering::Plain, at, Anchor::Middle, &caption);
        });
    }
}
