//! A rectangle of paper and the scene's place on it: what the picture and the film strip share.
//!
//! Lines are drawn at one sample, in a tone: springs and edges of bodies thin, rods thick, those that
//! broke not at all. Pinned particles are squares, followed ones spots of a colour each.

use std::fmt;
use std::ops::RangeInclusive;

use crate::Run;
use crate::ink::{self, COLOURS};
use crate::projection::{Extent, Projection};

/// Lines of a kind drawn at one time; beyond this number only a part is drawn, evenly chosen.
const LINES: usize = 20_000;

/// What runs to the right and upward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Axes {
    /// Time and the position on a line, each to its own scale.
    Graph,
    /// Two directions of the scene, to one scale.
    Seen(Projection),
}

impl Axes {
    /// Those of the scene as it asks to be seen.
    pub(crate) fn of(run: &Run) -> Self {
        match run.scene.dimension {
            3 => Axes::Seen(Projection::toward(run.scene.view)),
            _ => Axes::Seen(Projection::FLAT),
        }
    }

    /// Where the corners of walls are on paper, in the scene's units.
    pub(crate) fn of_walls(&self, run: &Run) -> Vec<[[f64; 2]; 4]> {
        match self {
            Axes::Graph => Vec::new(),
            Axes::Seen(projection) => {
                run.walls().into_iter().map(|wall| wall.map(|x| projection.of(x))).collect()
            }
        }
    }

    /// Where a particle is on paper, in the scene's units.
    pub(crate) fn of_particle(&self, run: &Run, sample: usize, particle: usize) -> [f64; 2] {
        let x = run.position(sample, particle);
        match self {
            Axes::Graph => [run.times().get(sample).copied().unwrap_or_default(), x[0]],
            Axes::Seen(projection) => projection.of(x),
        }
    }
}

/// A rectangle of paper with the scene on it.
#[derive(Debug)]
pub(crate) struct Sheet<'a> {
    run: &'a Run,
    pub(crate) axes: Axes,
    /// What is in the middle, in the scene's units.
    middle: [f64; 2],
    /// Paper a unit, to the right and upward.
    pub(crate) scale: [f64; 2],
    centre: [f64; 2],
    /// The height of the rectangle.
    pub(crate) height: f64,
}

impl<'a> Sheet<'a> {
    /// The sheet of this width, as high as the extent needs within bounds.
    pub(crate) fn new(
        run: &'a Run,
        axes: Axes,
        extent: Extent,
        corner: [f64; 2],
        width: f64,
        heights: RangeInclusive<f64>,
    ) -> Self {
        let [across, upward] = extent.size().map(|size| if size > 0.0 { size } else { 1.0 });
        let (height, scale) = match axes {
            Axes::Graph => (*heights.end(), [width / across, heights.end() / upward]),
            Axes::Seen(_) => {
                let height = (upward * (width / across)).clamp(*heights.start(), *heights.end());
                (height, [(width / across).min(height / upward); 2])
            }
        };
        let middle =
            std::array::from_fn(|c| extent.least[c] + 0.5 * (extent.largest[c] - extent.least[c]));
        let centre = [corner[0] + 0.5 * width, corner[1] + 0.5 * height];
        Sheet { run, axes, middle, scale, centre, height }
    }

    /// Where a particle is on paper.
    pub(crate) fn spot(&self, sample: usize, particle: usize) -> [f64; 2] {
        self.on_paper(self.axes.of_particle(self.run, sample, particle))
    }

    fn on_paper(&self, x: [f64; 2]) -> [f64; 2] {
        [
            self.centre[0] + self.scale[0] * (x[0] - self.middle[0]),
            self.centre[1] - self.scale[1] * (x[1] - self.middle[1]),
        ]
    }

    /// What nothing enters.
    pub(crate) fn walls(&self, f: &mut fmt::Formatter<'_>, walls: &[[[f64; 2]; 4]]) -> fmt::Result {
        for corners in walls {
            let [a, b, c, d] = corners.map(|corner| self.on_paper(corner));
            write!(f, "<path class=\"wall\" d=\"M{:.1} {:.1}L{:.1} {:.1}", a[0], a[1], b[0], b[1])?;
            writeln!(f, "L{:.1} {:.1}L{:.1} {:.1}Z\"/>", c[0], c[1], d[0], d[1])?;
        }
        Ok(())
    }

    /// Springs, edges of bodies, and the rods that are left.
    pub(crate) fn lines(
        &self,
        f: &mut fmt::Formatter<'_>,
        sample: usize,
        tone: &str,
    ) -> fmt::Result {
        let springs: Vec<[usize; 2]> = self.run.scene.lines().collect();
        let rods: Vec<[usize; 2]> = self.run.rods_at(sample).collect();
        for (kind, lines) in [("springs", springs), ("rods", rods)] {
            if lines.is_empty() {
                continue;
            }
            write!(f, "<path class=\"{kind} {tone}\" d=\"")?;
            for ends in lines.iter().step_by(lines.len().div_ceil(LINES)) {
                let [a, b] = ends.map(|end| self.spot(sample, end));
                write!(f, "M{:.1} {:.1}L{:.1} {:.1}", a[0], a[1], b[0], b[1])?;
            }
            writeln!(f, "\"/>")?;
        }
        Ok(())
    }

    /// Faces, of which all are seen through.
    pub(crate) fn faces(&self, f: &mut fmt::Formatter<'_>, sample: usize) -> fmt::Result {
        let faces = self.run.scene.surface();
        if faces.is_empty() || faces.len() > LINES {
            return Ok(());
        }
        write!(f, "<path class=\"face\" d=\"")?;
        for face in faces {
            let [a, b, c] = face.corners.map(|corner| self.spot(sample, corner));
            write!(f, "M{:.1} {:.1}L{:.1} {:.1}", a[0], a[1], b[0], b[1])?;
            write!(f, "L{:.1} {:.1}Z", c[0], c[1])?;
        }
        writeln!(f, "\"/>")
    }

    /// Paths of particles, of which the first has the first colour, with about so many points in all.
    pub(crate) fn paths(
        &self,
        f: &mut fmt::Formatter<'_>,
        samples: RangeInclusive<usize>,
        particles: &[usize],
        points: usize,
    ) -> fmt::Result {
        let (first, last) = samples.into_inner();
        let stride = ((last - first + 1) * particles.len()).div_ceil(points).max(1);
        for (turn, &particle) in particles.iter().enumerate() {
            write!(f, "<path class=\"path c{}\" d=\"", turn % COLOURS.len())?;
            let mut pen = 'M';
            let mut before = String::new();
            for sample in (first..last).step_by(stride).chain([last]) {
                let [x, y] = self.spot(sample, particle);
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

    /// Spots of particles, of which the first has the first colour.
    pub(crate) fn spots(
        &self,
        f: &mut fmt::Formatter<'_>,
        sample: usize,
        particles: &[usize],
        radius: f64,
    ) -> fmt::Result {
        for (turn, &particle) in particles.iter().enumerate() {
            let (turn, [x, y]) = (turn % COLOURS.len(), self.spot(sample, particle));
            writeln!(
                f,
                "<circle class=\"last f{turn}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\"/>"
            )?;
        }
        Ok(())
    }

    /// Squares where particles are pinned.
    pub(crate) fn pins(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for pin in self.run.scene.pins() {
            let [x, y] = self.spot(0, pin).map(|x| x - 3.5);
            let square = "width=\"7\" height=\"7\"";
            writeln!(f, "<rect class=\"pin\" x=\"{x:.1}\" y=\"{y:.1}\" {square}/>")?;
        }
        Ok(())
    }
}

/// Classes and colours of a drawing, for light and for dark paper.
pub(crate) fn styles(f: &mut fmt::Formatter<'_>) -> fmt::Result {
    writeln!(f, "<style>\n{}svg{{max-width:100%;max-height:100vh}}", ink::variables("svg"))?;
    writeln!(f, "text{{font:13px system-ui,sans-serif;fill:var(--ink)}}")?;
    writeln!(f, ".title{{font-size:20px;font-weight:600}}.soft{{fill:var(--soft)}}")?;
    writeln!(f, ".mid{{text-anchor:middle}}.paper{{fill:var(--paper)}}")?;
    writeln!(f, ".name{{paint-order:stroke;stroke:var(--paper);stroke-width:3px}}")?;
    let thin = ".path,.springs,.rods,.bar";
    writeln!(f, "{thin}{{fill:none;stroke-linejoin:round;stroke-linecap:round}}")?;
    writeln!(f, ".path{{stroke-width:1.2}}.springs{{stroke-width:.9}}.rods{{stroke-width:2}}")?;
    writeln!(f, ".start{{stroke:var(--start)}}.end{{stroke:var(--end)}}")?;
    writeln!(f, ".bar{{stroke:var(--soft);stroke-width:1.4}}.pin{{fill:var(--ink)}}")?;
    writeln!(f, ".frame{{fill:none;stroke:var(--start)}}.face{{fill:var(--c0);opacity:.16}}")?;
    writeln!(f, ".wall{{fill:var(--start);opacity:.5}}")?;
    writeln!(f, ".first{{fill:var(--paper);stroke-width:1.4}}.ink{{stroke:var(--ink)}}")?;
    writeln!(f, ".last{{fill:var(--ink);stroke:var(--paper);stroke-width:1.4}}")?;
    for i in 0..COLOURS.len() {
        write!(f, ".c{i}{{stroke:var(--c{i})}}.f{i}{{fill:var(--c{i})}}")?;
    }
    writeln!(f, "\n</style>")
}
