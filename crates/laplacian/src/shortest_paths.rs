//! The shortest way along a surface of triangles, exact to rounding.
//!
//! ```text
//! window  (side, [b0, b1], S, sigma):   d(x) = sigma + |S - x|      x on the side, b0 <= x <= b1
//! S the last source or corner of the path, unfolded into the plane of the triangle ahead
//! ```
//! A shortest path is straight inside of a face and across an edge, once the two faces are laid flat;
//! it bends only at vertices with more than a full turn about them, at boundary vertices with more
//! than half a turn, and where two sheets touch at a point. So paths from a vertex are carried from
//! triangle to triangle as windows, nearest first, and begin anew where they may bend. A window dies
//! where a vertex next to it offers a way to all of its points that is no longer; of two windows that
//! see one corner through one side, the farther goes on to one side of the corner only. Each number
//! is the length of a path that exists, so an error of rounding never makes a distance too short by
//! more than rounding. The number of windows grows like `V^1.5` on most surfaces of `V` vertices, and
//! like `V^2` on the worst. Source: Mitchell, Mount and Papadimitriou 1987; Chen and Han 1990 (one
//! angle, one split); Xin and Wang 2009 (which windows die).

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f64::consts::{PI, TAU};

use stationary_mesh::{IntrinsicSurface, Side};

use crate::LaplacianError;

/// The triangles of a surface, laid out side by side for paths across them.
#[derive(Clone, Debug)]
pub struct ShortestPaths {
    sides: Vec<LaidSide>,
    /// For each vertex the sides that face it, one a corner: from `starts[v]` to `starts[v + 1]`.
    facing: Vec<usize>,
    starts: Vec<usize>,
    /// Whether shortest paths may bend at a vertex.
    bends: Vec<bool>,
}

/// A side of a triangle from its first end at the origin along the first axis, the triangle above.
#[derive(Clone, Copy, Debug)]
struct LaidSide {
    ends: [usize; 2],
    length: f64,
    apex_vertex: usize,
    apex: [f64; 2],
    /// The sides from the second end to the apex and from the apex to the first end.
    others: [usize; 2],
    across: Option<usize>,
}

/// Distances along a surface, and what they cost.
#[derive(Clone, Debug, PartialEq)]
pub struct ShortestDistances {
    /// The distance of each vertex to the nearest source, metres; infinite where no path leads.
    pub distance: Vec<f64>,
    /// How many windows were carried across a triangle.
    pub windows: usize,
}

/// Paths that meet a side of a triangle from below.
#[derive(Clone, Copy, Debug)]
struct Window {
    side: usize,
    interval: [f64; 2],
    /// Where they come from, unfolded: below the side.
    from: [f64; 2],
    /// How far that is from the nearest source.
    before: f64,
}

impl Window {
    /// How far it is from the sources to a place on the side.
    fn through(&self, place: f64) -> f64 {
        self.before + length([place - self.from[0], self.from[1]])
    }
}

/// What is next: a vertex that was reached, or a window.
#[derive(Clone, Copy, Debug)]
enum Front {
    Vertex(usize),
    Window(Window),
}

/// A front and how far it is from the sources.
#[derive(Clone, Copy, Debug)]
struct Event {
    distance: f64,
    front: Front,
}

impl PartialEq for Event {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Event {}

impl PartialOrd for Event {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Event {
    /// The nearest is the greatest, so that a heap gives it first.
    fn cmp(&self, other: &Self) -> Ordering {
        other.distance.total_cmp(&self.distance)
    }
}

/// Angles beyond half or a full turn by less than this are flat: what is lost is its square.
const FLAT: f64 = 1e-10;
/// Relative to lengths, what may be rounding: a way is shorter only by more than this.
const ROUNDING: f64 = 1e-13;
/// Windows narrower than this part of their side end: the ways beside them are as short.
const NARROW: f64 = 1e-14;
/// Paths that cross a side this near to each other, relative to its length, may be one line.
const SAME_WAY: f64 = 1e-9;

impl ShortestPaths {
    /// Lays out the triangles of a surface.
    pub fn new(surface: &IntrinsicSurface) -> Self {
        let number = |side: Side| 3 * side.triangle + side.side;
        let mut sides = Vec::with_capacity(3 * surface.triangles().len());
        let mut angles = vec![0.0; surface.vertices()];
        let mut starts = vec![0; surface.vertices() + 1];
        for (t, corners) in surface.triangles().iter().enumerate() {
            let (shape, lengths) = (surface.shape(t), surface.lengths()[t]);
            for (&vertex, angle) in corners.iter().zip(shape.angles()) {
                angles[vertex] += angle;
                starts[vertex + 1] += 1;
            }
            for k in 0..3 {
                let [ab, bc, ca] = [0, 1, 2].map(|steps| lengths[(k + steps) % 3]);
                let along = (ab + (ca - bc) * ((ca + bc) / ab)) / 2.0;
                sides.push(LaidSide {
                    ends: [corners[k], corners[(k + 1) % 3]],
                    length: ab,
                    apex_vertex: corners[(k + 2) % 3],
                    apex: [along, 2.0 * shape.area() / ab],
                    others: [3 * t + (k + 1) % 3, 3 * t + (k + 2) % 3],
                    across: surface.across(Side { triangle: t, side: k }).map(number),
                });
            }
        }
        for vertex in 0..surface.vertices() {
            starts[vertex + 1] += starts[vertex];
        }
        let (mut facing, mut next) = (vec![0; sides.len()], starts.clone());
        for (side, laid) in sides.iter().enumerate() {
            facing[next[laid.apex_vertex]] = side;
            next[laid.apex_vertex] += 1;
        }
        let mut paths = ShortestPaths { sides, facing, starts, bends: Vec::new() };
        paths.bends = (0..angles.len()).map(|v| paths.may_bend(v, angles[v])).collect();
        paths
    }

    /// How many vertices there are.
    pub fn vertices(&self) -> usize {
        self.bends.len()
    }

    /// The distance of every vertex to the nearest of these.
    ///
    /// # Errors
    /// [`LaplacianError::NoSources`] and [`LaplacianError::NoSuchVertex`].
    pub fn from(&self, sources: &[usize]) -> Result<ShortestDistances, LaplacianError> {
        let vertices = self.vertices();
        if sources.is_empty() {
            return Err(LaplacianError::NoSources);
        }
        if let Some(&vertex) = sources.iter().find(|&&vertex| vertex >= vertices) {
            return Err(LaplacianError::NoSuchVertex { vertex, vertices });
        }
        let mut search = Search {
            paths: self,
            distance: vec![f64::INFINITY; vertices],
            nearest: vec![(f64::INFINITY, 0.0); self.sides.len()],
            events: BinaryHeap::new(),
            windows: 0,
        };
        sources.iter().for_each(|&source| search.reach(source, 0.0));
        while let Some(event) = search.events.pop() {
            match event.front {
                Front::Vertex(vertex) if event.distance > search.distance[vertex] => {}
                Front::Vertex(vertex) => search.leave(vertex),
                Front::Window(window) => search.carry(&window),
            }
        }
        Ok(ShortestDistances { distance: search.distance, windows: search.windows })
    }

    fn facing(&self, vertex: usize) -> &[usize] {
        &self.facing[self.starts[vertex]..self.starts[vertex + 1]]
    }

    fn may_bend(&self, vertex: usize, angle: f64) -> bool {
        let corners = self.facing(vertex);
        let Some(&first) = corners.first() else { return false };
        let on_boundary = corners
            .iter()
            .any(|&side| self.sides[side].others.iter().any(|&o| self.sides[o].across.is_none()));
        let turn = if on_boundary { PI } else { TAU };
        angle > turn + FLAT || self.fan(first) < corners.len()
    }

    /// How many corners follow each other around the apex of a side, back and forth from it.
    fn fan(&self, side: usize) -> usize {
        let mut count = 1;
        for direction in [0, 1] {
            let mut at = side;
            // Over the side that begins or ends at the apex lies the next triangle of the fan.
            while let Some(over) = self.sides[self.sides[at].others[direction]].across {
                at = self.sides[over].others[direction];
                if at == side {
                    return count;
                }
                count += 1;
            }
        }
        count
    }
}

/// Paths on their way.
struct Search<'a> {
    paths: &'a ShortestPaths,
    distance: Vec<f64>,
    /// For each side the nearest window that has seen its apex: how far the apex is that way, and
    /// where that path crosses the side.
    nearest: Vec<(f64, f64)>,
    events: BinaryHeap<Event>,
    windows: usize,
}

impl Search<'_> {
    fn reach(&mut self, vertex: usize, distance: f64) {
        // Of two ways that differ by rounding the second one begins nothing.
        let known = self.distance[vertex];
        if distance < known * (1.0 - ROUNDING) || (known.is_infinite() && distance.is_finite()) {
            self.distance[vertex] = distance;
            self.events.push(Event { distance, front: Front::Vertex(vertex) });
        }
    }

    /// Ways along the edges of a vertex, and where paths may bend or begin across its triangles.
    fn leave(&mut self, vertex: usize) {
        let paths = self.paths;
        let here = self.distance[vertex];
        for &side in paths.facing(vertex) {
            let laid = &paths.sides[side];
            let [to_second, to_first] = laid.others.map(|other| paths.sides[other].length);
            self.reach(laid.ends[1], here + to_second);
            self.reach(laid.ends[0], here + to_first);
            if let (Some(over), true) = (laid.across, paths.bends[vertex] || here == 0.0) {
                let from = [laid.length - laid.apex[0], -laid.apex[1]];
                let interval = [0.0, laid.length];
                self.push(Window { side: over, interval, from, before: here });
            }
        }
    }

    /// A window that may hold a shortest path waits for its turn.
    fn push(&mut self, window: Window) {
        let [low, high] = window.interval;
        if high - low > NARROW * self.paths.sides[window.side].length && !self.is_beaten(&window) {
            let distance = window.through(window.from[0].clamp(low, high));
            self.events.push(Event { distance, front: Front::Window(window) });
        }
    }

    /// Whether an end of its side offers a shorter way to all of a window: then to the farthest point
    /// of it, and along the side.
    fn is_beaten(&self, window: &Window) -> bool {
        let laid = &self.paths.sides[window.side];
        let ([low, high], [first, second]) =
            (window.interval, laid.ends.map(|end| self.distance[end]));
        is_shorter(first + high, window.through(high))
            || is_shorter(second + (laid.length - low), window.through(low))
    }

    /// Carries a window across the triangle ahead.
    fn carry(&mut self, window: &Window) {
        self.windows += 1;
        // What was the shortest way when the window was made may not be any more.
        if self.is_beaten(window) {
            return;
        }
        let laid = &self.paths.sides[window.side];
        let ([low, high], apex, from) = (window.interval, laid.apex, window.from);
        let rise = apex[1] - from[1];
        let crossing =
            if rise > 0.0 { from[0] - (apex[0] - from[0]) * (from[1] / rise) } else { apex[0] };
        let is_seen = low <= crossing && crossing <= high;
        let to_apex = if is_seen {
            window.before + length([apex[0] - from[0], rise])
        } else {
            let bend = crossing.clamp(low, high);
            window.through(bend) + length([apex[0] - bend, apex[1]])
        };
        self.reach(laid.apex_vertex, to_apex);
        let (mut left, mut right) = (crossing > low, crossing < high);
        if is_seen {
            let (nearest, there) = self.nearest[window.side];
            if is_shorter(nearest, to_apex) {
                // One angle, one split: on the apex' other side the nearer window is nearer still, but
                // not where one lies behind the other.
                let same = SAME_WAY * laid.length;
                left &= crossing < there + same;
                right &= crossing > there - same;
            } else if to_apex < nearest {
                self.nearest[window.side] = (to_apex, crossing);
            }
        }
        if left {
            self.pass(window, crossing, Turn::Left);
        }
        if right {
            self.pass(window, crossing, Turn::Right);
        }
    }

    /// The part of a window that leaves the triangle ahead on one side of the apex, which is seen
    /// where the side below is crossed.
    fn pass(&mut self, window: &Window, crossing: f64, turn: Turn) {
        let paths = self.paths;
        let below = &paths.sides[window.side];
        let ([low, high], corners) = (window.interval, [[0.0, 0.0], [below.length, 0.0]]);
        // The way out as seen from beyond: from a start to an end, each known to be the window's own
        // or not. Behind lies the end of the side below that the way out does not touch.
        let (out, [start, end], own, behind) = match turn {
            Turn::Left => (1, [corners[0], below.apex], [low <= 0.0, crossing < high], 1),
            Turn::Right => (0, [below.apex, corners[1]], [crossing > low, high >= below.length], 0),
        };
        let laid = &paths.sides[below.others[out]];
        let Some(side) = laid.across else { return };
        let along = [(end[0] - start[0]) / laid.length, (end[1] - start[1]) / laid.length];
        let turned = |x: [f64; 2]| {
            let off = [x[0] - start[0], x[1] - start[1]];
            [off[0] * along[0] + off[1] * along[1], along[0] * off[1] - along[1] * off[0]]
        };
        let from = turned(window.from);
        let from = [from[0], from[1].min(0.0)];
        // Where the ray through a place on the side below crosses the way out.
        let crossed = |place: f64| {
            let on = turned([place, 0.0]);
            let rise = on[1] - from[1];
            let part = if rise > 0.0 { -from[1] / rise } else { 1.0 };
            (from[0] + (on[0] - from[0]) * part).clamp(0.0, laid.length)
        };
        let first = if own[0] { 0.0 } else { crossed(low) };
        let last = if own[1] { laid.length } else { crossed(high) };
        let next = Window { side, interval: [first, last], from, before: window.before };
        // The vertex behind may offer a shorter way to the point that is farthest around from it: then
        // to all of the window.
        let far = [last, first][behind];
        let seen = turned(corners[behind]);
        let that_way = self.distance[below.ends[behind]] + length([far - seen[0], seen[1]]);
        if !is_shorter(that_way, next.through(far)) {
            self.push(next);
        }
    }
}

/// On which side of the apex a path leaves a triangle.
#[derive(Clone, Copy, Debug)]
enum Turn {
    Left,
    Right,
}

fn length(x: [f64; 2]) -> f64 {
    (x[0] * x[0] + x[1] * x[1]).sqrt()
}

/// Whether the first way is shorter by more than rounding.
fn is_shorter(way: f64, other: f64) -> bool {
    way < other * (1.0 - ROUNDING)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Vector2, Vector3};
    use stationary_mesh::{Diagonals, Mesh, icosphere, rectangle};

    fn from(surface: &IntrinsicSurface, sources: &[usize]) -> ShortestDistances {
        ShortestPaths::new(surface).from(sources).unwrap()
    }

    fn worst(found: &[f64], exact: impl Iterator<Item = f64>) -> f64 {
        found.iter().zip(exact).map(|(d, e)| (d - e).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn in_a_thin_rectangle_distances_are_straight_lines_to_rounding() {
        for stretch in [1.0, 100.0, 1000.0] {
            let mesh = rectangle([1.0, 1.0], [12, 9], Diagonals::Alternating).unwrap();
            let map = |x: &Vector2<f64>| Vector2::new(stretch * x.x + 0.7 * x.y, x.y);
            let mesh = mesh.mapped(map).unwrap();
            let surface = IntrinsicSurface::of(&mesh).unwrap();
            for source in [0, 60] {
                let found = from(&surface, &[source]).distance;
                let place = mesh.vertices()[source];
                let exact = mesh.vertices().iter().map(|x| (x - place).norm());
                assert!(worst(&found, exact) < 1e-11 * stretch);
            }
        }
    }

    #[test]
    fn around_a_corner_the_path_bends_there() {
        // A square without its upper right quarter.
        let mesh = rectangle([2.0, 2.0], [8, 8], Diagonals::Same).unwrap();
        let inside = |t: &&[usize; 3]| {
            let middle = t.iter().map(|&v| mesh.vertices()[v]).sum::<Vector2<f64>>() / 3.0;
            !(middle.x > 1.0 && middle.y > 1.0)
        };
        let kept = mesh.simplices().iter().filter(inside).copied().collect();
        let shape = Mesh::new(mesh.vertices().to_vec(), kept).unwrap();
        let surface = IntrinsicSurface::of(&shape).unwrap();
        let at = |x: f64, y: f64| {
            let here = |p: &&Vector2<f64>| (*p - Vector2::new(x, y)).norm() < 1e-9;
            mesh.vertices().iter().position(|p| here(&p)).unwrap()
        };
        let found = from(&surface, &[at(2.0, 0.25)]).distance;
        let exact = 1.0_f64.hypot(0.75) + 1.0_f64.hypot(0.75);
        assert!((found[at(0.25, 2.0)] - exact).abs() < 1e-12);
        // A vertex that no triangle names is reached by nothing.
        assert_eq!(found[at(2.0, 2.0)], f64::INFINITY);
    }

    #[test]
    fn over_the_edge_of_a_box_the_path_is_straight_once_unfolded() {
        // From the middle of a face of a cube to the middle of the opposite one: 2.
        let ball = icosphere(1.0, 1).unwrap();
        let surface = IntrinsicSurface::of(&ball).unwrap();
        assert_eq!(from(&surface, &[0]).distance[0], 0.0);
        let c = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
        let corners = vec![
            c(0.0, 0.0, 0.0),
            c(1.0, 0.0, 0.0),
            c(1.0, 1.0, 0.0),
            c(0.0, 1.0, 0.0),
            c(0.0, 0.0, 1.0),
            c(1.0, 0.0, 1.0),
            c(1.0, 1.0, 1.0),
            c(0.0, 1.0, 1.0),
        ];
        let faces =
            [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
        let halves = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        let cube = Mesh::new(corners, halves.collect()).unwrap();
        let surface = IntrinsicSurface::of(&cube).unwrap();
        let found = from(&surface, &[0]).distance;
        // The far corner of a unit cube is sqrt 5 away.
        assert!((found[6] - 5.0_f64.sqrt()).abs() < 1e-14);
        assert!((found[2] - 2.0_f64.sqrt()).abs() < 1e-14);
    }

    #[test]
    fn a_flat_torus_has_the_distances_of_its_plane() {
        let (m, n) = (7, 5);
        let torus = IntrinsicSurface::flat_torus([1.0, 0.3], [m, n]).unwrap();
        let found = from(&torus, &[3]).distance;
        let around = |i: usize, j: usize, of: usize| {
            (i.abs_diff(j).min(of - i.abs_diff(j))) as f64 / of as f64
        };
        let exact = (0..m * n).map(|v| around(v % m, 3, m).hypot(0.3 * around(v / m, 0, n)));
        assert!(worst(&found, exact) < 1e-14);
        // One vertex, one cell: every way leads home.
        let one = IntrinsicSurface::flat_torus([1.0, 1.0], [1, 1]).unwrap();
        assert_eq!(from(&one, &[0]).distance, [0.0]);
    }

    #[test]
    fn windows_are_few() {
        for levels in 2..5 {
            let ball = icosphere(1.0, levels).unwrap();
            let found = from(&IntrinsicSurface::of(&ball).unwrap(), &[0]);
            let vertices = found.distance.len() as f64;
            assert!((found.windows as f64) < 4.0 * vertices.powf(1.5), "{}", found.windows);
        }
    }
}
