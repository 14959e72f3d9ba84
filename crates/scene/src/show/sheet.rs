//! A rectangle of paper and the scene's place on it: what the picture and the film strip share.
//!
//! Lines are drawn at one sample, in a tone: springs and edges of bodies thin, rods thick, those that
//! broke not at all. Pinned particles are squares, followed ones spots of a colour each.

use stationary_calculus::array;
use std::collections::BTreeSet;
use std::ops::RangeInclusive;

use stationary_chart::{Canvas, Path, Tone};

use crate::run::samples::Run;
use crate::show::projection::{Extent, Projection};
use crate::show::silhouette::Outlines;

/// Widths of springs and edges of bodies, of rods, and of paths.
pub(crate) const THIN: f64 = 0.9;
pub(crate) const THICK: f64 = 2.0;
const PATH: f64 = 1.2;
/// How much of a face and of a wall is seen.
pub(crate) const FACE: f64 = 0.16;
const WALL: f64 = 0.5;

/// Lines of a kind drawn at one time; beyond this number only a part is drawn, evenly chosen.
pub(crate) const LINES: usize = 20_000;

/// Edges by their lesser end first.
pub(crate) type Edges = BTreeSet<[usize; 2]>;

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

    /// The corners of the paper that what reaches so far about a place needs.
    pub(crate) fn about(&self, [x, y]: [f64; 2], reach: f64) -> [[f64; 2]; 2] {
        let reach = if *self == Axes::Graph { 0.0 } else { reach };
        [[x - reach, y - reach], [x + reach, y + reach]]
    }

    /// The corners of the paper that balls which stay need.
    pub(crate) fn of_fixed_balls(&self, run: &Run) -> Vec<[f64; 2]> {
        match self {
            Axes::Graph => Vec::new(),
            Axes::Seen(projection) => run.fixed_balls(projection).concat(),
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
    pub(crate) run: &'a Run,
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
        let middle = array(|c| extent.least[c] + 0.5 * (extent.largest[c] - extent.least[c]));
        let centre = [corner[0] + 0.5 * width, corner[1] + 0.5 * height];
        Sheet { run, axes, middle, scale, centre, height }
    }

    /// Where a particle is on paper.
    pub(crate) fn spot(&self, sample: usize, particle: usize) -> (f64, f64) {
        self.on_paper(self.axes.of_particle(self.run, sample, particle))
    }

    fn on_paper(&self, x: [f64; 2]) -> (f64, f64) {
        (
            self.centre[0] + self.scale[0] * (x[0] - self.middle[0]),
            self.centre[1] - self.scale[1] * (x[1] - self.middle[1]),
        )
    }

    /// What nothing enters.
    pub(crate) fn walls(&self, canvas: &mut Canvas, walls: &[[[f64; 2]; 4]]) {
        for corners in walls {
            let mut path = Path::new();
            path.outline(&corners.map(|corner| self.on_paper(corner)));
            canvas.fill(Tone::Faint, WALL, &path);
        }
    }

    /// Balls that stay, which nothing enters either.
    pub(crate) fn fixed_balls(&self, canvas: &mut Canvas) {
        let Axes::Seen(projection) = self.axes else { return };
        let outlines = self.run.fixed_balls(&projection);
        if !outlines.is_empty() {
            canvas.fill(Tone::Faint, WALL, &self.outlined(&outlines));
        }
    }

    /// The outlines of balls, discs and solids; filled where they are seen through.
    pub(crate) fn silhouettes(&self, canvas: &mut Canvas, sample: usize, tone: Tone) {
        let Axes::Seen(projection) = self.axes else { return };
        let outlines = self.run.silhouettes(sample, &projection);
        if outlines.is_empty() || outlines.len() > LINES {
            return;
        }
        let path = self.outlined(&outlines);
        if tone == Tone::Strong {
            canvas.fill(Tone::Hue(0), FACE, &path);
        }
        canvas.stroke(tone, THIN, &path);
    }

    fn outlined(&self, outlines: &Outlines) -> Path {
        let mut path = Path::new();
        for outline in outlines {
            let corners: Vec<_> = outline.iter().map(|&corner| self.on_paper(corner)).collect();
            path.outline(&corners);
        }
        path
    }

    /// Springs, edges of bodies that are not drawn yet, and the rods that are left.
    pub(crate) fn lines(&self, canvas: &mut Canvas, sample: usize, tone: Tone, drawn: &Edges) {
        let left = |[a, b]: &[usize; 2]| !drawn.contains(&[*a.min(b), *a.max(b)]);
        let springs: Vec<[usize; 2]> = self.run.scene.lines().filter(left).collect();
        let rods: Vec<[usize; 2]> = self.run.rods_at(sample).collect();
        for (width, lines) in [(THIN, springs), (THICK, rods)] {
            let mut path = Path::new();
            for ends in lines.iter().step_by(lines.len().div_ceil(LINES).max(1)) {
                path.through(ends.map(|end| self.spot(sample, end)));
            }
            if !path.is_empty() {
                canvas.stroke(tone, width, &path);
            }
        }
    }

    /// How a scene in space is seen.
    pub(crate) fn in_space(&self) -> Option<Projection> {
        match self.axes {
            Axes::Seen(projection) if self.run.scene.dimension == 3 => Some(projection),
            _ => None,
        }
    }

    /// Paths of particles, of which the first has the first hue, with about so many points in all.
    pub(crate) fn paths(
        &self,
        canvas: &mut Canvas,
        samples: RangeInclusive<usize>,
        particles: &[usize],
        points: usize,
    ) {
        let (first, last) = samples.into_inner();
        let stride = ((last - first + 1) * particles.len()).div_ceil(points).max(1);
        for (turn, &particle) in particles.iter().enumerate() {
            let samples = (first..last).step_by(stride).chain([last]);
            let mut path = Path::new();
            path.through(samples.map(|sample| self.spot(sample, particle)));
            canvas.stroke(Tone::Hue(turn), PATH, &path);
        }
    }

    /// Spots of particles, of which the first has the first hue.
    pub(crate) fn spots(
        &self,
        canvas: &mut Canvas,
        sample: usize,
        particles: &[usize],
        radius: f64,
    ) {
        for (turn, &particle) in particles.iter().enumerate() {
            canvas.dot(Tone::Hue(turn), self.spot(sample, particle), radius);
        }
    }

    /// Squares where particles are pinned.
    pub(crate) fn pins(&self, canvas: &mut Canvas) {
        for pin in self.run.scene.pins() {
            canvas.fill(Tone::Ink, 1.0, &square(self.spot(0, pin)));
        }
    }
}

/// The mark of what is pinned.
pub(crate) fn square((x, y): (f64, f64)) -> Path {
    const HALF: f64 = 3.5;
    let mut path = Path::new();
    path.outline(
        &[(-HALF, -HALF), (HALF, -HALF), (HALF, HALF), (-HALF, HALF)]
            .map(|(right, down)| (x + right, y + down)),
    );
    path
}
