//! The picture of a run: paths, springs or edges of bodies at the start and at the end, names, and
//! a length to compare.
//!
//! One SVG file that needs nothing else, light on paper and dark where the reader prefers that.
//! Drawn are the paths of the particles that are written out or observed; a net is drawn by its
//! springs, faint where it starts and strong where it ends.

use stationary_calculus::array;
use stationary_chart::{Anchor, Canvas, Lettering, Medium, Path, Tone, significant};

use crate::model::particle::Motion;
use crate::model::scene::COORDINATES;
use crate::run::samples::Run;
use crate::show::projection::{Extent, round_length};
use crate::show::sheet::{Axes, Edges, Sheet, THICK, THIN, square};

/// The paper, and the part of it that the scene may use.
const WIDTH: f64 = 900.0;
const MARGIN: f64 = 40.0;
const HEADER: f64 = 76.0;
const FOOTER: f64 = 70.0;
const TALLEST: f64 = 720.0;
const FLATTEST: f64 = 240.0;

/// The width of a scale.
const SCALE: f64 = 1.4;

/// Points of all paths together, and paths with a name; beyond these numbers only a part is drawn,
/// evenly chosen.
const POINTS: usize = 60_000;
const NAMES: usize = 40;

/// A run on paper.
#[derive(Debug)]
pub(crate) struct Picture<'a> {
    run: &'a Run,
    walls: Vec<[[f64; 2]; 4]>,
    /// `None` where the scene's size is not finite.
    sheet: Option<Sheet<'a>>,
    height: f64,
}

impl<'a> Picture<'a> {
    /// The picture of a run.
    pub(crate) fn of(run: &'a Run) -> Self {
        let axes = if run.scene.dimension == 1 { Axes::Graph } else { Axes::of(run) };
        let heights = match axes {
            Axes::Graph => 0.5 * TALLEST..=0.5 * TALLEST,
            Axes::Seen(_) => FLATTEST..=TALLEST,
        };
        let walls = axes.of_walls(run);
        let points = everything(run, axes).chain(walls.iter().copied().flatten());
        let sheet = Extent::of(points).map(|extent| {
            Sheet::new(run, axes, extent, [MARGIN, HEADER], WIDTH - 2.0 * MARGIN, heights)
        });
        let height = HEADER + sheet.as_ref().map_or(FLATTEST, |sheet| sheet.height) + FOOTER;
        Picture { run, walls, sheet, height }
    }

    fn samples(&self) -> usize {
        self.run.times().len()
    }

    /// The text of the SVG file.
    pub(crate) fn svg(&self) -> String {
        let mut canvas = Canvas::new(WIDTH, self.height.ceil());
        self.header(&mut canvas);
        match &self.sheet {
            Some(sheet) => {
                self.links(&mut canvas, sheet);
                sheet.paths(&mut canvas, 0..=self.samples() - 1, &self.moving(), POINTS);
                self.spots(&mut canvas, sheet);
                self.names(&mut canvas, sheet);
                self.bars(&mut canvas, sheet);
                self.axes(&mut canvas, sheet);
                self.legend(&mut canvas);
            }
            None => {
                let words = "The scene is too large to draw.";
                canvas.text(Lettering::Remark, (MARGIN, 110.0), Anchor::Start, words);
            }
        }
        canvas.svg(Medium::File, self.run.scene().title())
    }

    /// Springs and rods at the start and at the end; a rod that broke is missing there.
    fn links(&self, canvas: &mut Canvas, sheet: &Sheet<'_>) {
        let last = self.samples() - 1;
        sheet.walls(canvas, &self.walls);
        sheet.fixed_balls(canvas);
        sheet.lines(canvas, 0, Tone::Faint, &Edges::new());
        sheet.silhouettes(canvas, 0, Tone::Faint);
        let drawn = sheet.faces(canvas, last);
        sheet.silhouettes(canvas, last, Tone::Strong);
        sheet.lines(canvas, last, Tone::Strong, &drawn);
    }

    /// Followed particles that move, as many as have a path.
    fn moving(&self) -> Vec<usize> {
        self.run.scene.moving(POINTS / 4)
    }

    fn spots(&self, canvas: &mut Canvas, sheet: &Sheet<'_>) {
        let moving = self.moving();
        for (turn, &particle) in moving.iter().enumerate() {
            canvas.ring(Tone::Hue(turn), sheet.spot(0, particle), 3.0);
        }
        sheet.spots(canvas, self.samples() - 1, &moving, 4.0);
        sheet.pins(canvas);
    }

    /// Names beside the ends of paths, each where it covers no other.
    fn names(&self, canvas: &mut Canvas, sheet: &Sheet<'_>) {
        let last = self.samples() - 1;
        let mut taken: Vec<[f64; 4]> = Vec::new();
        let followed = self.run.scene().followed();
        if followed.len() > NAMES {
            return;
        }
        for &particle in &followed {
            let (x, y) = sheet.spot(last, particle);
            taken.push([x - 5.0, y - 5.0, x + 5.0, y + 5.0]);
        }
        for &particle in &followed {
            let name = &self.run.scene().particles()[particle].name;
            let (x, y) = sheet.spot(last, particle);
            let width = 7.5 * name.chars().count() as f64;
            let places =
                [[8.0, 4.0], [-8.0 - width, 4.0], [-0.5 * width, -9.0], [-0.5 * width, 19.0]]
                    .into_iter()
                    .chain([[8.0, 18.0], [8.0, -10.0], [-8.0 - width, 18.0], [-8.0 - width, -10.0]])
                    .map(|[dx, dy]| [x + dx, y + dy - 12.0, x + dx + width, y + dy + 3.0]);
            let inside = |b: &[f64; 4]| b[0] > 4.0 && b[2] < WIDTH - 4.0;
            let covers = |b: &[f64; 4], t: &[f64; 4]| {
                b[0] < t[2] && t[0] < b[2] && b[1] < t[3] && t[1] < b[3]
            };
            let free = |b: &[f64; 4]| inside(b) && !taken.iter().any(|t| covers(b, t));
            let mut beside = places.clone();
            let chosen = beside.find(free).or_else(|| places.clone().find(inside));
            let Some(chosen) = chosen else { continue };
            taken.push(chosen);
            canvas.text(Lettering::Name, (chosen[0], chosen[3] - 3.0), Anchor::Start, name);
        }
    }

    fn header(&self, canvas: &mut Canvas) {
        let scene = self.run.scene();
        let unit = &scene.units().time;
        let end = significant(self.run.times().last().copied().unwrap_or_default(), 6);
        canvas.text(Lettering::Heading, (MARGIN, 36.0), Anchor::Start, scene.title());
        let line = format!(
            "{}, {} steps of {} {unit}, to t = {end} {unit}",
            scene.stepping(),
            self.run.cost().steps,
            significant(scene.timing().step(), 6),
        );
        canvas.text(Lettering::Remark, (MARGIN, 56.0), Anchor::Start, &line);
    }

    /// A bar of a round length at the lower left; on a line, a second one for time.
    fn bars(&self, canvas: &mut Canvas, sheet: &Sheet<'_>) {
        let (units, graph) = (self.run.scene().units(), sheet.axes == Axes::Graph);
        let (x, y) = (MARGIN, self.height - 24.0);
        let unit = if graph { &units.time } else { &units.length };
        let length = round_length(180.0 / sheet.scale[0]);
        let end = x + length * sheet.scale[0];
        let bar = [(x, y - 5.0), (x, y), (end, y), (end, y - 5.0)];
        canvas.stroke(Tone::Muted, SCALE, &Path::line(&bar));
        let text = format!("{length} {unit}");
        canvas.text(Lettering::Remark, (x, y - 10.0), Anchor::Start, &text);
        if graph {
            let length = round_length(120.0 / sheet.scale[1]);
            let (x, foot) = (16.0, y - 60.0);
            let top = foot - length * sheet.scale[1];
            let bar = [(x + 5.0, top), (x, top), (x, foot), (x + 5.0, foot)];
            canvas.stroke(Tone::Muted, SCALE, &Path::line(&bar));
            let text = format!("{length} {}", units.length);
            canvas.text(Lettering::Remark, (x - 4.0, top - 6.0), Anchor::Start, &text);
        }
    }

    /// The three axes as they are seen, at the lower right.
    fn axes(&self, canvas: &mut Canvas, sheet: &Sheet<'_>) {
        const ARM: f64 = 24.0;
        let Axes::Seen(projection) = sheet.axes else { return };
        let (x, y) = (WIDTH - MARGIN - ARM, self.height - 38.0);
        for (c, axis) in COORDINATES.iter().enumerate().take(self.run.scene().dimension()) {
            let [right, up] = projection.of(array(|i| f64::from(u8::from(i == c))));
            if right.hypot(up) < 0.15 {
                continue;
            }
            let arm = [(x, y), (x + ARM * right, y - ARM * up)];
            canvas.stroke(Tone::Muted, SCALE, &Path::line(&arm));
            let at = (x + (ARM + 9.0) * right, y - (ARM + 9.0) * up + 4.0);
            canvas.text(Lettering::Remark, at, Anchor::Middle, axis);
        }
    }

    /// What the marks mean, in the middle of the foot: only those that are there.
    fn legend(&self, canvas: &mut Canvas) {
        let scene = self.run.scene();
        let y = self.height - 28.0;
        let mut x = MARGIN + 230.0;
        let mut entry = |words: &str, mark: &dyn Fn(&mut Canvas, f64)| {
            mark(canvas, x);
            canvas.text(Lettering::Remark, (x + 26.0, y + 4.0), Anchor::Start, words);
            x += 40.0 + 7.0 * words.len() as f64;
        };
        // Half of the line faint, as at the start, and half strong, as at the end.
        let line = |width: f64| {
            move |canvas: &mut Canvas, x: f64| {
                for (tone, from) in [(Tone::Faint, x), (Tone::Strong, x + 11.0)] {
                    canvas.stroke(tone, width, &Path::line(&[(from, y), (from + 11.0, y)]));
                }
            }
        };
        if !self.moving().is_empty() {
            entry("start", &|canvas, x| canvas.ring(Tone::Ink, (x + 12.0, y), 3.0));
            entry("end", &|canvas, x| canvas.dot(Tone::Ink, (x + 12.0, y), 4.0));
        }
        let words = match (scene.rigid_bodies() > 0, scene.links().is_empty()) {
            (true, true) => "bodies",
            (true, false) => "bodies, springs",
            (false, _) => "springs",
        };
        if scene.lines().next().is_some() {
            entry(words, &line(THIN));
        }
        if !scene.rods().is_empty() {
            entry("rods", &line(THICK));
        }
        if scene.particles().iter().any(|particle| particle.motion == Motion::Pinned) {
            entry("pinned", &|canvas, x| canvas.fill(Tone::Ink, 1.0, &square((x + 12.5, y))));
        }
    }
}

/// All that is drawn: the start and the end of every particle with what it reaches, the paths, and balls
/// that stay.
fn everything(run: &Run, axes: Axes) -> impl Iterator<Item = [f64; 2]> {
    let (all, last) = (run.scene().particles().len(), run.times().len() - 1);
    let reaches = run.reaches();
    let paths = run.scene().followed().into_iter().map(|p| (p, reaches[p])).collect::<Vec<_>>();
    let at = move |sample: usize, (particle, reach): (usize, f64)| {
        axes.about(axes.of_particle(run, sample, particle), reach)
    };
    let ends = (0..all).zip(reaches).flat_map(move |p| [at(0, p), at(last, p)]);
    let paths = paths.into_iter().flat_map(move |p| (0..=last).map(move |i| at(i, p)));
    ends.chain(paths).flatten().chain(axes.of_fixed_balls(run))
}
