//! The picture of a run: paths, springs or edges of bodies at the start and at the end, names, and
//! a length to compare.
//!
//! One SVG file that needs nothing else, light on paper and dark where the reader prefers that.
//! Drawn are the paths of the particles that are written out or observed; a net is drawn by its
//! springs, faint where it starts and strong where it ends.

use std::fmt;

use crate::error::COORDINATES;
use crate::ink::{COLOURS, escaped};
use crate::projection::{Extent, round_length};
use crate::sheet::{Axes, Sheet, styles};
use crate::{Motion, Run};

/// The paper, and the part of it that the scene may use.
const WIDTH: f64 = 900.0;
const MARGIN: f64 = 40.0;
const HEADER: f64 = 76.0;
const FOOTER: f64 = 70.0;
const TALLEST: f64 = 720.0;
const FLATTEST: f64 = 240.0;

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

    /// Springs and rods at the start and at the end; a rod that broke is missing there.
    fn links(&self, f: &mut fmt::Formatter<'_>, sheet: &Sheet<'_>) -> fmt::Result {
        sheet.walls(f, &self.walls)?;
        sheet.lines(f, 0, "start")?;
        sheet.faces(f, self.samples() - 1)?;
        sheet.lines(f, self.samples() - 1, "end")
    }

    /// Followed particles that move, as many as have a path.
    fn moving(&self) -> Vec<usize> {
        self.run.scene.moving(POINTS / 4)
    }

    fn spots(&self, f: &mut fmt::Formatter<'_>, sheet: &Sheet<'_>) -> fmt::Result {
        let moving = self.moving();
        for (turn, &particle) in moving.iter().enumerate() {
            let (turn, [x, y]) = (turn % COLOURS.len(), sheet.spot(0, particle));
            writeln!(f, "<circle class=\"first c{turn}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\"/>")?;
        }
        sheet.spots(f, self.samples() - 1, &moving, 4.0)?;
        sheet.pins(f)
    }

    /// Names beside the ends of paths, each where it covers no other.
    fn names(&self, f: &mut fmt::Formatter<'_>, sheet: &Sheet<'_>) -> fmt::Result {
        let last = self.samples() - 1;
        let mut taken: Vec<[f64; 4]> = Vec::new();
        let followed = self.run.scene().followed();
        if followed.len() > NAMES {
            return Ok(());
        }
        for &particle in &followed {
            let [x, y] = sheet.spot(last, particle);
            taken.push([x - 5.0, y - 5.0, x + 5.0, y + 5.0]);
        }
        for &particle in &followed {
            let name = &self.run.scene().particles()[particle].name;
            let [x, y] = sheet.spot(last, particle);
            let width = 7.5 * name.chars().count() as f64;
            let places =
                [[8.0, 4.0], [-8.0 - width, 4.0], [-0.5 * width, -9.0], [-0.5 * width, 19.0]]
                    .into_iter()
                    .chain([[8.0, 18.0], [8.0, -10.0], [-8.0 - width, 18.0], [-8.0 - width, -10.0]])
                    .map(|[dx, dy]| [x + dx, y + dy - 12.0, x + dx + width, y + dy + 3.0]);
            let free = |b: &[f64; 4]| {
                let inside = b[0] > 4.0 && b[2] < WIDTH - 4.0;
                inside
                    && !taken
                        .iter()
                        .any(|t| b[0] < t[2] && t[0] < b[2] && b[1] < t[3] && t[1] < b[3])
            };
            let chosen = places.clone().find(free).or_else(|| places.clone().next());
            let Some(chosen) = chosen else { continue };
            taken.push(chosen);
            let (x, y) = (chosen[0], chosen[3] - 3.0);
            writeln!(f, "<text class=\"name\" x=\"{x:.1}\" y=\"{y:.1}\">{}</text>", escaped(name))?;
        }
        Ok(())
    }

    fn header(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let scene = self.run.scene();
        let unit = &scene.units().time;
        let end = self.run.times().last().copied().unwrap_or_default();
        writeln!(
            f,
            "<text class=\"title\" x=\"{MARGIN}\" y=\"36\">{}</text>",
            escaped(scene.title())
        )?;
        let line = format!(
            "{}, {} steps of {} {unit}, to t = {end} {unit}",
            scene.stepping(),
            self.run.cost().steps,
            scene.timing().step(),
        );
        writeln!(f, "<text class=\"soft\" x=\"{MARGIN}\" y=\"56\">{}</text>", escaped(&line))
    }

    /// A bar of a round length at the lower left; on a line, a second one for time.
    fn bars(&self, f: &mut fmt::Formatter<'_>, sheet: &Sheet<'_>) -> fmt::Result {
        let (units, graph) = (self.run.scene().units(), sheet.axes == Axes::Graph);
        let (x, y) = (MARGIN, self.height - 24.0);
        let unit = if graph { &units.time } else { &units.length };
        let length = round_length(180.0 / sheet.scale[0]);
        let end = x + length * sheet.scale[0];
        writeln!(
            f,
            "<path class=\"bar\" d=\"M{x:.1} {:.1}V{y:.1}H{end:.1}V{:.1}\"/>",
            y - 5.0,
            y - 5.0
        )?;
        let text = escaped(&format!("{length} {unit}"));
        writeln!(f, "<text class=\"soft\" x=\"{x:.1}\" y=\"{:.1}\">{text}</text>", y - 10.0)?;
        if graph {
            let length = round_length(120.0 / sheet.scale[1]);
            let (x, top) = (16.0, y - 60.0 - length * sheet.scale[1]);
            let foot = y - 60.0;
            writeln!(
                f,
                "<path class=\"bar\" d=\"M{:.1} {top:.1}H{x:.1}V{foot:.1}H{:.1}\"/>",
                x + 5.0,
                x + 5.0
            )?;
            let text = escaped(&format!("{length} {}", units.length));
            writeln!(
                f,
                "<text class=\"soft\" x=\"{:.1}\" y=\"{:.1}\">{text}</text>",
                x - 4.0,
                top - 6.0
            )?;
        }
        Ok(())
    }

    /// The three axes as they are seen, at the lower right.
    fn axes(&self, f: &mut fmt::Formatter<'_>, sheet: &Sheet<'_>) -> fmt::Result {
        const ARM: f64 = 24.0;
        let Axes::Seen(projection) = sheet.axes else { return Ok(()) };
        let (x, y) = (WIDTH - MARGIN - ARM, self.height - 38.0);
        for (c, axis) in COORDINATES.iter().enumerate().take(self.run.scene().dimension()) {
            let [right, up] = projection.of(std::array::from_fn(|i| f64::from(u8::from(i == c))));
            if right.hypot(up) < 0.15 {
                continue;
            }
            let end = [x + ARM * right, y - ARM * up];
            writeln!(f, "<path class=\"bar\" d=\"M{x:.1} {y:.1}L{:.1} {:.1}\"/>", end[0], end[1])?;
            let at = [x + (ARM + 9.0) * right, y - (ARM + 9.0) * up + 4.0];
            writeln!(
                f,
                "<text class=\"soft mid\" x=\"{:.1}\" y=\"{:.1}\">{axis}</text>",
                at[0], at[1]
            )?;
        }
        Ok(())
    }

    /// What the marks mean, in the middle of the foot: only those that are there.
    fn legend(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let scene = self.run.scene();
        let y = self.height - 28.0;
        let mut x = MARGIN + 230.0;
        let mut entry = |f: &mut fmt::Formatter<'_>, mark: &str, words: &str| -> fmt::Result {
            writeln!(f, "<g transform=\"translate({x:.1} {y:.1})\">{mark}")?;
            writeln!(f, "<text class=\"soft\" x=\"26\" y=\"4\">{words}</text></g>")?;
            x += 40.0 + 7.0 * words.len() as f64;
            Ok(())
        };
        // Half of the line faint, as at the start, and half strong, as at the end.
        let bar = |kind: &str| {
            let line = |class, from| format!("<path class=\"{kind} {class}\" d=\"M{from} 0h11\"/>");
            line("start", 0) + &line("end", 11)
        };
        if !self.moving().is_empty() {
            entry(f, "<circle class=\"first ink\" cx=\"12\" cy=\"0\" r=\"3\"/>", "start")?;
            entry(f, "<circle class=\"last\" cx=\"12\" cy=\"0\" r=\"4\"/>", "end")?;
        }
        if scene.lines().next().is_some() {
            let words = if scene.bodies().is_empty() { "springs" } else { "bodies" };
            entry(f, &bar("springs"), words)?;
        }
        if !scene.rods().is_empty() {
            entry(f, &bar("rods"), "rods")?;
        }
        if scene.particles().iter().any(|particle| particle.motion == Motion::Pinned) {
            let mark = "<rect class=\"pin\" x=\"9\" y=\"-3.5\" width=\"7\" height=\"7\"/>";
            entry(f, mark, "pinned")?;
        }
        Ok(())
    }
}

impl fmt::Display for Picture<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (height, title) = (self.height.ceil(), escaped(self.run.scene().title()));
        writeln!(
            f,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" \
             width=\"{WIDTH}\" height=\"{height}\" role=\"img\" aria-label=\"{title}\">"
        )?;
        writeln!(f, "<title>{title}</title>")?;
        styles(f)?;
        writeln!(f, "<rect class=\"paper\" width=\"{WIDTH}\" height=\"{height}\"/>")?;
        self.header(f)?;
        match &self.sheet {
            Some(sheet) => {
                self.links(f, sheet)?;
                sheet.paths(f, 0..=self.samples() - 1, &self.moving(), POINTS)?;
                self.spots(f, sheet)?;
                self.names(f, sheet)?;
                self.bars(f, sheet)?;
                self.axes(f, sheet)?;
                self.legend(f)?;
            }
            None => writeln!(
                f,
                "<text class=\"soft\" x=\"{MARGIN}\" y=\"110\">The scene is too large to draw.</text>"
            )?,
        }
        writeln!(f, "</svg>")
    }
}

/// All that is drawn: the start and the end of every particle, and the paths.
fn everything(run: &Run, axes: Axes) -> impl Iterator<Item = [f64; 2]> {
    let (all, last) = (run.scene().particles().len(), run.times().len() - 1);
    let at = move |sample: usize, particle: usize| axes.of_particle(run, sample, particle);
    let ends = (0..all).flat_map(move |p| [at(0, p), at(last, p)]);
    let paths = run.scene().followed().into_iter();
    ends.chain(paths.flat_map(move |p| (0..=last).map(move |i| at(i, p))))
}
