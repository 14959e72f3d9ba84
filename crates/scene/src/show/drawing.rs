//! What a drawing of a run shows, whoever draws it: which lines and faces, whose paths, which moments.
//!
//! ```text
//! springs, edges of bodies     all the time
//! rods                         until they break
//! faces                        sides of boxes, whose corners are their first 2^D points, counted by bits;
//!                              triangles of hulls;
//!                              what a chain of points encloses that returns to where it was; cells of nets
//! ```

use nalgebra::Vector3;

use crate::model::body_shape::BodyShape;
use crate::model::items::RigidBody;
use crate::model::particle::Motion;
use crate::model::scene::Scene;
use crate::run::samples::Run;

/// A triangle between particles, and the body to which it belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Face {
    pub(crate) corners: [usize; 3],
    pub(crate) body: usize,
}

/// Samples to show where at most so many can be, evenly chosen, the first and the last among them.
pub(crate) fn thinned(samples: usize, most: usize) -> Vec<usize> {
    if samples <= most.max(2) {
        return (0..samples).collect();
    }
    let last = most.max(2) - 1;
    // Without overflow: a run has less than 2^32 samples.
    (0..=last).map(|k| k * (samples - 1) / last).collect()
}

impl Run {
    /// The place among the samples' times after which each rod is gone.
    pub(crate) fn rods_at(&self, sample: usize) -> impl Iterator<Item = [usize; 2]> {
        let time = self.times().get(sample).copied().unwrap_or_default();
        let rods = self.scene.rods.iter().enumerate();
        let gone = move |rod: usize| self.broken.iter().any(|b| b.rod == rod && b.time <= time);
        rods.filter(move |&(rod, _)| !gone(rod)).map(|(_, rod)| rod.ends)
    }
}

impl Scene {
    /// Followed particles that move, evenly chosen where they are more than `most`.
    pub(crate) fn moving(&self, most: usize) -> Vec<usize> {
        let free = |&p: &usize| self.particles[p].motion != Motion::Pinned;
        let moving: Vec<usize> = self.followed().into_iter().filter(free).collect();
        let stride = moving.len().div_ceil(most).max(1);
        moving.into_iter().step_by(stride).collect()
    }

    /// Particles that stay.
    pub(crate) fn pins(&self) -> impl Iterator<Item = usize> {
        let all = self.particles.iter().enumerate();
        all.filter(|(_, particle)| particle.motion == Motion::Pinned).map(|(index, _)| index)
    }

    /// Faces: sides of boxes, what closed chains of points enclose, and the cells of nets.
    pub(crate) fn surface(&self) -> Vec<Face> {
        if self.bodies.is_empty() {
            let outside = self.faces.iter().map(|&corners| Face { corners, body: 0 });
            return self.cells().into_iter().chain(outside).collect();
        }
        let mut first = self.rigid_bodies();
        let mut faces = Vec::new();
        for (body, RigidBody { points, shape, .. }) in self.bodies.iter().enumerate() {
            let mut add = |corners: [usize; 3]| {
                faces.push(Face { corners: corners.map(|corner| first + corner), body });
            };
            if let BodyShape::Hull { triangles, .. } = shape {
                triangles.iter().copied().for_each(&mut add);
            } else if is_box(points, self.dimension) {
                let sides = sides(self.dimension);
                sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).for_each(&mut add);
            } else if let Some((start, end)) =
                closed(points).filter(|&(a, b)| convex(&points[a..b]))
            {
                (start + 2..end).for_each(|corner| add([start, corner - 1, corner]));
            }
            first += points.len();
        }
        faces.extend(self.cells());
        faces
    }

    /// Springs that are drawn as lines: those of nets are drawn as the sides of their cells.
    pub(crate) fn wires(&self) -> impl Iterator<Item = [usize; 2]> {
        let net = |end: usize| end >= self.written_out && !self.is_point_of_a_body(end);
        let of_net = move |ends: &[usize; 2]| {
            ends.iter().all(|&end| net(end) && vertex(&self.particles[end].name).is_some())
        };
        self.links.iter().map(|link| link.ends).filter(move |ends| !of_net(ends))
    }

    /// The cells of nets, two triangles each.
    pub(crate) fn cells(&self) -> Vec<Face> {
        let (mut faces, mut columns) = (Vec::new(), 0);
        let all = self.particles.iter().enumerate().skip(self.written_out);
        for (index, name) in all.map(|(index, particle)| (index, particle.name.as_str())) {
            if self.is_point_of_a_body(index) {
                continue;
            }
            let Some([row, column]) = vertex(name) else { continue };
            if row == 0 {
                columns = column + 1;
            }
            if row == 0 || column == 0 {
                continue;
            }
            // A net's vertices stand row after row.
            let [above, left, corner] = [columns, 1, columns + 1].map(|back| index - back);
            faces.push(Face { corners: [corner, above, index], body: 0 });
            faces.push(Face { corners: [corner, index, left], body: 0 });
        }
        faces
    }
}

/// The row and the column in the name of a net's vertex.
fn vertex(name: &str) -> Option<[usize; 2]> {
    let (net, column) = name.rsplit_once('.')?;
    let (_, row) = net.rsplit_once('.')?;
    Some([row.parse().ok()?, column.parse().ok()?])
}

/// The first chain of points that returns to where it was: from its first point to before that comes
/// again.
fn closed(points: &[[f64; 3]]) -> Option<(usize, usize)> {
    (0..points.len()).find_map(|start| {
        let again = (start + 3..points.len()).find(|&end| points[end] == points[start])?;
        Some((start, again))
    })
}

/// Whether a polygon in space turns the same way at each corner.
pub(crate) fn convex(corners: &[[f64; 3]]) -> bool {
    let n = corners.len();
    let at = |k: usize| Vector3::from(corners[k % n]);
    let turn = |k: usize| (at(k + 1) - at(k)).cross(&(at(k + 2) - at(k + 1)));
    let normal: Vector3<f64> = (0..n).map(turn).sum();
    (0..n).all(|k| turn(k).dot(&normal) >= 0.0)
}

/// Whether the first points are the corners of a box about the centre.
fn is_box(points: &[[f64; 3]], dimension: usize) -> bool {
    let Some(corners) = points.get(..1 << dimension) else { return false };
    let half = corners[corners.len() - 1];
    let sign = |corner: usize, c: usize| if corner >> c & 1 == 1 { 1.0 } else { -1.0 };
    let is_corner = |(corner, point): (usize, &[f64; 3])| {
        (0..dimension).all(|c| half[c] > 0.0 && point[c] == sign(corner, c) * half[c])
    };
    corners.iter().enumerate().all(is_corner)
}

/// Corners round each side of a box.
pub(crate) fn sides(dimension: usize) -> Vec<[usize; 4]> {
    if dimension == 2 {
        return vec![[0, 1, 3, 2]];
    }
    let across = [(0, 1, 2), (1, 2, 0), (2, 0, 1)];
    let pair = |(a, b, c): (usize, usize, usize)| {
        [0, 1].map(|high| {
            let base = high << c;
            [base, base | 1 << a, base | 1 << a | 1 << b, base | 1 << b]
        })
    };
    across.into_iter().flat_map(pair).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinned_samples_have_both_ends_and_are_even() {
        assert_eq!(thinned(5, 9), [0, 1, 2, 3, 4]);
        assert_eq!(thinned(101, 5), [0, 25, 50, 75, 100]);
        assert_eq!(thinned(10, 0), [0, 9]);
        let chosen = thinned(1000, 300);
        let gaps: Vec<usize> = chosen.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert_eq!((chosen.len(), chosen[299]), (300, 999));
        assert!(gaps.iter().all(|gap| (3..=4).contains(gap)));
    }
}
