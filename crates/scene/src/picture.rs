//! The picture of a run: paths, springs or edges of bodies at the start and at the end, names, and
//! a length to compare.
//!
//! One SVG file that needs nothing else, light on paper and dark where the reader prefers that.
//! Drawn are the paths of the particles that are written out or observed; a net is drawn by its
//! springs, faint where it starts and strong where it ends.

use std::fmt;

use crate::error::COORDINATES;
use crate::projection::{Extent, Projection, round_length};
use crate::{Motion, Run};

/// The paper, and the part of it that the scene may use.
const WIDTH: f64 = 900.0;
const MARGIN: f64 = 40.0;
const HEADER: f64 = 76.0;
const FOOTER: f64 = 70.0;
const TALLEST: f64 = 720.0;
const FLATTEST: f64 = 240.0;

/// Points of all paths together, springs drawn at one time, and paths with a name; beyond these
/// numbers only a part is drawn, evenly chosen.
const POINTS: usize = 60_000;
const SPRINGS: usize = 20_000;
const NAMES: usize = 40;

/// Colours of paths, in turn, on light and on dark paper.
const COLOURS: [(&str, &str); 7] = [
    ("#2a6fbb", "#6cb0f5"),
    ("#c8501e", "#f59a6e"),
    ("#2f8a5b", "#6fcf9f"),
    ("#8a4fb0", "#c79be8"),
    ("#b0871a", "#e5c463"),
    ("#b83a6b", "#f08fb4"),
    ("#4d7580", "#9cc3cd"),
];

/// A run on paper.
#[derive(Debug)]
pub(crate) struct Picture<'a> {
    run: &'a Run,
    projection: Projection,
    /// What the scene needs; `None` where that is not finite.
    extent: Option<Extent>,
    /// Paper a unit, to the right and upward.
    scale: [f64; 2],
    height: f64,
}

impl<'a> Picture<'a> {
    /// The picture of a run.
    pub(crate) fn of(run: &'a Run) -> Self {
        let projection = match run.scene().dimension() {
            3 => Projection::toward(run.scene().view),
            _ => Projection::FLAT,
        };
        let mut picture = Picture {
            run,
            projection,
            extent: None,
            scale: [1.0; 2],
            height: HEADER + FLATTEST + FOOTER,
        };
        picture.extent = Extent::of(picture.everything());
        if let Some(extent) = picture.extent {
            picture.fit(extent);
        }
        picture
    }

    /// Chooses the paper's height and scale.
    fn fit(&mut self, extent: Extent) {
        let width = WIDTH - 2.0 * MARGIN;
        let [across, upward] = extent.size().map(|size| if size > 0.0 { size } else { 1.0 });
        if self.graph() {
            self.height = HEADER + 0.5 * TALLEST + FOOTER;
            self.scale = [width / across, 0.5 * TALLEST / upward];
            return;
        }
        let tall = (upward * (width / across)).clamp(FLATTEST, TALLEST);
        let scale = (width / across).min(tall / upward);
        self.height = HEADER + tall + FOOTER;
        self.scale = [scale; 2];
    }

    /// True where time runs to the right: on a line.
    fn graph(&self) -> bool {
        self.run.scene().dimension() == 1
    }

    fn samples(&self) -> usize {
        self.run.times().len()
    }

    /// Where a particle is on paper, in the scene's units.
    fn projected(&self, sample: usize, particle: usize) -> [f64; 2] {
        let x = self.run.position(sample, particle);
        if self.graph() {
            return [self.run.times().get(sample).copied().unwrap_or_default(), x[0]];
        }
        self.projection.of(x)
    }

    /// All that is drawn: the start and the end of every particle, and the paths.
    fn everything(&self) -> impl Iterator<Item = [f64; 2]> {
        let (all, last) = (self.run.scene().particles().len(), self.samples() - 1);
        let ends = (0..all).flat_map(move |p| [self.projected(0, p), self.projected(last, p)]);
        let paths = self.run.scene().followed().into_iter();
        ends.chain(paths.flat_map(move |p| (0..=last).map(move |i| self.projected(i, p))))
    }

    /// Where something is on paper.
    fn on_paper(&self, extent: &Extent, x: [f64; 2]) -> [f64; 2] {
        let middle: [f64; 2] =
            std::array::from_fn(|c| extent.least[c] + 0.5 * (extent.largest[c] - extent.least[c]));
        let centre = [0.5 * WIDTH, HEADER + 0.5 * (self.height - HEADER - FOOTER)];
        [
            centre[0] + self.scale[0] * (x[0] - middle[0]),
            centre[1] - self.scale[1] * (x[1] - middle[1]),
        ]
    }

    fn spot(&self, extent: &Extent, sample: usize, particle: usize) -> [f64; 2] {
        self.on_paper(extent, self.projected(sample, particle))
    }

    /// Springs and rods at the start and at the end; a rod that broke is missing there.
    fn links(&self, f: &mut fmt::Formatter<'_>, extent: &Extent) -> fmt::Result {
        let (scene, last) = (self.run.scene(), self.samples() - 1);
        let springs: Vec<[usize; 2]> = scene.lines().collect();
        let broken = |rod: &usize| self.run.broken().iter().any(|broken| broken.rod == *rod);
        let ends = |rod: usize| scene.rods()[rod].ends;
        let all = 0..scene.rods().len();
        let rods: Vec<[usize; 2]> = all.clone().map(ends).collect();
        let left: Vec<[usize; 2]> = all.filter(|rod| !broken(rod)).map(ends).collect();
        for (class, sample, bars) in [
            ("springs start", 0, &springs),
            ("springs end", last, &springs),
            ("rods start", 0, &rods),
            ("rods end", last, &left),
        ] {
            if bars.is_empty() {
                continue;
            }
            write!(f, "<path class=\"{class}\" d=\"")?;
            for ends in bars.iter().step_by(bars.len().div_ceil(SPRINGS)) {
                let [a, b] = ends.map(|end| self.spot(extent, sample, end));
                write!(f, "M{:.1} {:.1}L{:.1} {:.1}", a[0], a[1], b[0], b[1])?;
            }
            writeln!(f, "\"/>")?;
        }
        Ok(())
    }

    fn paths(&self, f: &mut fmt::Formatter<'_>, extent: &Extent) -> fmt::Result {
        let followed = self.free_followed();
        let stride = (self.samples() * followed.len()).div_ceil(POINTS).max(1);
        let last = self.samples() - 1;
        for (turn, &particle) in followed.iter().enumerate() {
            write!(f, "<path class=\"path c{}\" d=\"", turn % COLOURS.len())?;
            let mut pen = 'M';
            let mut before = String::new();
            for sample in (0..last).step_by(stride).chain([last]) {
                let [x, y] = self.spot(extent, sample, particle);
                let point = format!("{x:.1} {y:.1}");
                if point != before {
                    write!(f, "{pen}{point}")?;
                    (pen, before) = ('L', point);
                }
            }
            writeln!(f, "\"/>")?;
        }
        Ok(())
    }

    /// Followed particles that move, as many as have a path.
    fn free_followed(&self) -> Vec<usize> {
        let free = |&p: &usize| self.run.scene().particles()[p].motion != Motion::Pinned;
        let followed: Vec<usize> = self.run.scene().followed().into_iter().filter(free).collect();
        let stride = followed.len().div_ceil(POINTS / 4).max(1);
        followed.into_iter().step_by(stride).collect()
    }

    fn spots(&self, f: &mut fmt::Formatter<'_>, extent: &Extent) -> fmt::Result {
        let last = self.samples() - 1;
        for (turn, particle) in self.free_followed().into_iter().enumerate() {
            let turn = turn % COLOURS.len();
            let ([x, y], [ex, ey]) =
                (self.spot(extent, 0, particle), self.spot(extent, last, particle));
            writeln!(f, "<circle class=\"first c{turn}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\"/>")?;
            writeln!(f, "<circle class=\"last f{turn}\" cx=\"{ex:.1}\" cy=\"{ey:.1}\" r=\"4\"/>")?;
        }
        for (index, particle) in self.run.scene().particles().iter().enumerate() {
            if particle.motion == Motion::Pinned {
                let [x, y] = self.spot(extent, last, index);
                let corner = [x - 3.5, y - 3.5];
                writeln!(
                    f,
                    "<rect class=\"pin\" x=\"{:.1}\" y=\"{:.1}\" width=\"7\" height=\"7\"/>",
                    corner[0], corner[1]
                )?;
            }
        }
        Ok(())
    }

    /// Names beside the ends of paths, each where it covers no other.
    fn names(&self, f: &mut fmt::Formatter<'_>, extent: &Extent) -> fmt::Result {
        let last = self.samples() - 1;
        let mut taken: Vec<[f64; 4]> = Vec::new();
        let followed = self.run.scene().followed();
        if followed.len() > NAMES {
            return Ok(());
        }
        for &particle in &followed {
            let [x, y] = self.spot(extent, last, particle);
            taken.push([x - 5.0, y - 5.0, x + 5.0, y + 5.0]);
        }
        for &particle in &followed {
            let name = &self.run.scene().particles()[particle].name;
            let [x, y] = self.spot(extent, last, particle);
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
    fn bars(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let units = self.run.scene().units();
        let (x, y) = (MARGIN, self.height - 24.0);
        let unit = if self.graph() { &units.time } else { &units.length };
        let length = round_length(180.0 / self.scale[0]);
        let end = x + length * self.scale[0];
        writeln!(
            f,
            "<path class=\"bar\" d=\"M{x:.1} {:.1}V{y:.1}H{end:.1}V{:.1}\"/>",
            y - 5.0,
            y - 5.0
        )?;
        let text = escaped(&format!("{length} {unit}"));
        writeln!(f, "<text class=\"soft\" x=\"{x:.1}\" y=\"{:.1}\">{text}</text>", y - 10.0)?;
        if self.graph() {
            let length = round_length(120.0 / self.scale[1]);
            let (x, top) = (16.0, y - 60.0 - length * self.scale[1]);
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
    fn axes(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const ARM: f64 = 24.0;
        if self.graph() {
            return Ok(());
        }
        let (x, y) = (WIDTH - MARGIN - ARM, self.height - 38.0);
        for (c, axis) in COORDINATES.iter().enumerate().take(self.run.scene().dimension()) {
            let [right, up] =
                self.projection.of(std::array::from_fn(|i| f64::from(u8::from(i == c))));
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
        if !self.free_followed().is_empty() {
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
        match &self.extent {
            Some(extent) => {
                self.links(f, extent)?;
                self.paths(f, extent)?;
                self.spots(f, extent)?;
                self.names(f, extent)?;
                self.bars(f)?;
                self.axes(f)?;
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

/// Classes and colours, for light and for dark paper.
fn styles(f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let colours = |pick: fn(&(&'static str, &'static str)) -> &'static str| -> String {
        let numbered = COLOURS.iter().enumerate();
        numbered.map(|(i, pair)| format!("--c{i}:{};", pick(pair))).collect()
    };
    writeln!(f, "<style>")?;
    let light = "--paper:#fdfcf9;--ink:#22211e;--soft:#6b6963;--start:#c4c0b5;--end:#5b5850;";
    let dark = "--paper:#17181a;--ink:#ebe9e4;--soft:#a19e96;--start:#4c4d50;--end:#b9b6ae;";
    writeln!(f, "svg{{max-width:100%;max-height:100vh;{light}{}}}", colours(|pair| pair.0))?;
    writeln!(f, "@media(prefers-color-scheme:dark){{svg{{{dark}{}}}}}", colours(|pair| pair.1))?;
    writeln!(f, "text{{font:13px system-ui,sans-serif;fill:var(--ink)}}")?;
    writeln!(f, ".title{{font-size:20px;font-weight:600}}.soft{{fill:var(--soft)}}")?;
    writeln!(f, ".mid{{text-anchor:middle}}.paper{{fill:var(--paper)}}")?;
    writeln!(f, ".name{{paint-order:stroke;stroke:var(--paper);stroke-width:3px}}")?;
    writeln!(
        f,
        ".path,.springs,.rods,.bar{{fill:none;stroke-linejoin:round;stroke-linecap:round}}"
    )?;
    writeln!(f, ".path{{stroke-width:1.2}}.springs{{stroke-width:.9}}.rods{{stroke-width:2}}")?;
    writeln!(f, ".start{{stroke:var(--start)}}.end{{stroke:var(--end)}}")?;
    writeln!(f, ".bar{{stroke:var(--soft);stroke-width:1.4}}.pin{{fill:var(--ink)}}")?;
    writeln!(f, ".first{{fill:var(--paper);stroke-width:1.4}}.ink{{stroke:var(--ink)}}")?;
    writeln!(f, ".last{{fill:var(--ink);stroke:var(--paper);stroke-width:1.4}}")?;
    for i in 0..COLOURS.len() {
        write!(f, ".c{i}{{stroke:var(--c{i})}}.f{i}{{fill:var(--c{i})}}")?;
    }
    writeln!(f, "\n</style>")
}

/// The text, with the characters that mean something in XML written otherwise.
fn escaped(text: &str) -> String {
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
