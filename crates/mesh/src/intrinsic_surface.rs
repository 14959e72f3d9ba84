//! A surface known by its edge lengths alone: what a Laplacian sees of it.
//!
//! ```text
//! triangle t: vertices v0 v1 v2, sides 01 12 20 with lengths, each glued to a side or to nothing
//! cut along ab, c and d opposite:  |cd| from both triangles laid side by side in the plane
//! Delaunay: alpha + beta <= pi opposite every inner edge,  that is  cot alpha + cot beta >= 0
//! ```
//! Sides are glued head to tail, so a surface is oriented. A triangle may be glued to itself, and
//! two vertices may be joined by several edges: a flat torus may have one vertex. Flipping an edge
//! changes neither the surface nor its metric, only which straight lines are called edges; a finite
//! number of flips makes all of them Delaunay. Source: Bobenko and Springborn 2007; Fisher,
//! Springborn, Schroeder and Bobenko 2007; Sharp and Crane 2020 (mollification).

use crate::intrinsic::IntrinsicTriangle;
use crate::mesh::Mesh;
use crate::{MeshError, Places};

/// A side of a triangle: from its corner `side` to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Side {
    /// Which triangle.
    pub triangle: usize,
    /// Which side, 0 to 2.
    pub side: usize,
}

impl Side {
    /// The side after this one, or the one before it: two steps are one back.
    pub(crate) fn after(self, steps: usize) -> Self {
        Side { triangle: self.triangle, side: (self.side + steps) % 3 }
    }
}

/// Triangles by their edge lengths, glued side to side.
#[derive(Clone, Debug, PartialEq)]
pub struct IntrinsicSurface {
    pub(crate) vertices: usize,
    pub(crate) triangles: Vec<[usize; 3]>,
    pub(crate) glued: Vec<[Option<Side>; 3]>,
    pub(crate) lengths: Vec<[f64; 3]>,
}

impl IntrinsicSurface {
    /// The surface of a mesh.
    ///
    /// # Errors
    /// [`MeshError::NonManifold`], [`MeshError::Inconsistent`] and, where rounding or coincident
    /// vertices leave lengths that no triangle has, [`MeshError::TriangleInequality`].
    pub fn of<const D: usize>(mesh: &Mesh<D, 3>) -> Result<Self, MeshError> {
        mesh.check_oriented()?;
        let length = |a: usize, b: usize| (mesh.vertices()[a] - mesh.vertices()[b]).norm();
        let sides = |&[a, b, c]: &[usize; 3]| [length(a, b), length(b, c), length(c, a)];
        let mut glued = vec![[None; 3]; mesh.simplices().len()];
        for shared in mesh.facet_uses().chunk_by(|a, b| a.facet == b.facet) {
            if let [one, other] = shared {
                let [one, other] = [one, other]
                    .map(|side| Side { triangle: side.simplex, side: (side.opposite + 1) % 3 });
                glued[one.triangle][one.side] = Some(other);
                glued[other.triangle][other.side] = Some(one);
            }
        }
        let lengths = mesh.simplices().iter().map(sides).collect();
        let vertices = mesh.vertices().len();
        let surface =
            IntrinsicSurface { vertices, triangles: mesh.simplices().to_vec(), glued, lengths };
        surface.check_lengths()?;
        Ok(surface)
    }

    /// A rectangle whose opposite sides are one, in equal cells of two triangles. Vertex
    /// `i + j m` is at `(i a/m, j b/n)`.
    ///
    /// # Errors
    /// [`MeshError::Size`], [`MeshError::TooFew`] and [`MeshError::TooMany`].
    pub fn flat_torus(size: [f64; 2], cells: [usize; 2]) -> Result<Self, MeshError> {
        crate::generators::check_rectangle(size, cells)?;
        let [m, n] = cells;
        let [a, b] = [size[0] / m as f64, size[1] / n as f64];
        let diagonal = a.hypot(b);
        let (mut triangles, mut glued, mut lengths) = (Vec::new(), Vec::new(), Vec::new());
        for (j, i) in (0..n).flat_map(|j| (0..m).map(move |i| (j, i))) {
            let vertex = |i: usize, j: usize| i % m + (j % n) * m;
            let lower = |i: usize, j: usize| 2 * vertex(i, j);
            let corners = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
            triangles.extend([
                [corners[0], corners[1], corners[2]],
                [corners[0], corners[2], corners[3]],
            ]);
            let to = |triangle: usize, side: usize| Some(Side { triangle, side });
            glued.push([
                to(lower(i, j + n - 1) + 1, 1),
                to(lower(i + 1, j) + 1, 2),
                to(lower(i, j) + 1, 0),
            ]);
            glued.push([to(lower(i, j), 2), to(lower(i, j + 1), 0), to(lower(i + m - 1, j), 1)]);
            lengths.extend([[a, b, diagonal], [diagonal, a, b]]);
        }
        Ok(IntrinsicSurface { vertices: m * n, triangles, glued, lengths })
    }

    /// How many vertices there are.
    pub fn vertices(&self) -> usize {
        self.vertices
    }

    /// The corners of each triangle.
    pub fn triangles(&self) -> &[[usize; 3]] {
        &self.triangles
    }

    /// The lengths of the sides of each triangle.
    pub fn lengths(&self) -> &[[f64; 3]] {
        &self.lengths
    }

    /// The side that a side is glued to; `None` on the boundary.
    ///
    /// # Panics
    /// If there is no such side.
    pub fn across(&self, side: Side) -> Option<Side> {
        self.glued[side.triangle][side.side]
    }

    /// The shape of a triangle.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn shape(&self, triangle: usize) -> IntrinsicTriangle {
        IntrinsicTriangle::known(self.lengths[triangle])
    }

    /// The area of the whole.
    pub fn area(&self) -> f64 {
        (0..self.triangles.len()).map(|triangle| self.shape(triangle).area()).sum()
    }

    pub(crate) fn sides(&self) -> impl Iterator<Item = Side> + use<> {
        let triangles = 0..self.triangles.len();
        triangles.flat_map(|triangle| (0..3).map(move |side| Side { triangle, side }))
    }

    fn check_lengths(&self) -> Result<(), MeshError> {
        let none = |lengths: &&[f64; 3]| IntrinsicTriangle::new(**lengths).is_none();
        let numbered = self.lengths.iter().enumerate();
        let missing = numbered.filter(|(_, lengths)| none(lengths)).map(|(triangle, _)| triangle);
        Places::refuse(missing.collect(), MeshError::TriangleInequality)
    }

    /// The cotangent of the angle opposite to a side.
    pub(crate) fn cotangent(&self, side: Side) -> f64 {
        self.shape(side.triangle).cotangents()[side.after(2).side]
    }

    /// Half the sum of the cotangents opposite to the edge of this side: its weight in the
    /// Laplacian, negative where the edge is not Delaunay, or where it bounds the surface and faces
    /// an obtuse angle.
    pub fn weight(&self, side: Side) -> f64 {
        let other = self.across(side).map_or(0.0, |other| self.cotangent(other));
        0.5 * (self.cotangent(side) + other)
    }

    /// Boundary sides opposite to an obtuse angle: no flip makes their weights positive, a split does.
    pub fn obtuse_boundary(&self) -> Vec<Side> {
        let bad = |side: &Side| self.across(*side).is_none() && self.cotangent(*side) < 0.0;
        self.sides().filter(bad).collect()
    }

    /// Flips edges until all inner ones are Delaunay, and tells how many flips that took.
    ///
    /// # Errors
    /// [`MeshError::TooManyFlips`].
    pub fn flip_to_delaunay(&mut self) -> Result<usize, MeshError> {
        let mut next: Vec<Side> = self.sides().filter(|&side| self.is_owner(side)).collect();
        let limit = 64 + next.len().saturating_mul(next.len());
        let mut flips = 0;
        while let Some(side) = next.pop() {
            if !self.wants_flip(side) {
                continue;
            }
            if flips == limit {
                return Err(MeshError::TooManyFlips { limit });
            }
            next.extend(self.flip(side));
            flips += 1;
        }
        Ok(flips)
    }

    /// Of the two sides of an inner edge, the one that stands for it.
    fn is_owner(&self, side: Side) -> bool {
        let key = |side: Side| (side.triangle, side.side);
        self.across(side).is_some_and(|other| key(side) < key(other))
    }

    fn wants_flip(&self, side: Side) -> bool {
        // Two angles of one triangle never add up to more than pi.
        let two = self.across(side).is_some_and(|other| other.triangle != side.triangle);
        two && self.weight(side) < -DELAUNAY
    }

    /// Replaces the edge of this side by the other diagonal of its two triangles, and names the
    /// four edges around them, which may now want a flip themselves.
    fn flip(&mut self, side: Side) -> Vec<Side> {
        let Some(other) = self.across(side) else { return Vec::new() };
        let (t, u) = (side.triangle, other.triangle);
        let ([a, b], c) = (self.ends(side), self.triangles[t][side.after(2).side]);
        let d = self.triangles[u][other.after(2).side];
        let place = |triangle: usize, side: usize| Side { triangle, side };
        // Around the quadrilateral a, d, b, c: where each side was, and where it goes.
        let moved = [
            (other.after(1), place(t, 0)),
            (other.after(2), place(u, 0)),
            (side.after(1), place(u, 1)),
            (side.after(2), place(t, 2)),
        ];
        let to = |old: Side| moved.iter().find(|m| m.0 == old).map_or(old, |m| m.1);
        let partners = moved.map(|(old, _)| self.across(old).map(to));
        let [ad, db, bc, ca] = moved.map(|(old, _)| self.lengths[old.triangle][old.side]);
        let ab = self.lengths[t][side.side];
        let cd = other_diagonal(ab, [bc, ca], [ad, db]);
        (self.triangles[t], self.lengths[t]) = ([a, d, c], [ad, cd, ca]);
        (self.triangles[u], self.lengths[u]) = ([d, b, c], [db, bc, cd]);
        for ((_, new), partner) in moved.into_iter().zip(partners) {
            self.glued[new.triangle][new.side] = partner;
            if let Some(partner) = partner {
                self.glued[partner.triangle][partner.side] = Some(new);
            }
        }
        self.glued[t][1] = Some(place(u, 2));
        self.glued[u][2] = Some(place(t, 1));
        moved.map(|(_, new)| new).to_vec()
    }

    pub(crate) fn ends(&self, side: Side) -> [usize; 2] {
        let corners = self.triangles[side.triangle];
        [corners[side.side], corners[(side.side + 1) % 3]]
    }

    /// The surface with every edge made longer by the same least amount that leaves each triangle
    /// a defect `a + b - c` of at least this part of the mean length: slivers get area, and a flat
    /// triangle becomes one.
    ///
    /// # Errors
    /// [`MeshError::Size`].
    pub fn mollified(mut self, part: f64) -> Result<Self, MeshError> {
        let count = (3 * self.lengths.len()).max(1) as f64;
        let mean = self.lengths.iter().flatten().sum::<f64>() / count;
        if !(part > 0.0 && part < 1.0) {
            return Err(MeshError::Size { what: "the part of the mean length", value: part });
        }
        let defect =
            |l: &[f64; 3]| l.iter().sum::<f64>() - 2.0 * l.iter().fold(0.0, |m, &x| x.max(m));
        let least = self.lengths.iter().map(defect).fold(f64::INFINITY, f64::min);
        let longer = (part * mean - least).max(0.0);
        self.lengths.iter_mut().flatten().for_each(|length| *length += longer);
        Ok(self)
    }
}

/// Weights above minus this are Delaunay: four points on a circle are not flipped to and fro.
const DELAUNAY: f64 = 1e-12;

/// The distance of the corners `c` and `d` of two triangles with the common side ab: `[bc, ca]` and
/// `[ad, db]` their other sides.
fn other_diagonal(ab: f64, [bc, ca]: [f64; 2], [ad, db]: [f64; 2]) -> f64 {
    let apex = |from_a: f64, from_b: f64| {
        let along = (ab + (from_a - from_b) * ((from_a + from_b) / ab)) / 2.0;
        let area = IntrinsicTriangle::known([ab, from_b, from_a]).area();
        (along, 2.0 * area / ab)
    };
    let (above, below) = (apex(ca, bc), apex(ad, db));
    (above.0 - below.0).hypot(above.1 + below.1)
}

#[cfg(test)]
#[path = "intrinsic_surface_tests.rs"]
mod tests;
