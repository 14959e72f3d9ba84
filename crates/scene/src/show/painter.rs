//! Faces in space as a painter does them: the farthest first, each over what it hides, with its own edges.
//!
//! ```text
//! opacity = FACE + SHADE |<n, w>|        n the normal of a face, w the direction to the eye
//! ```
//! In the order of their middles: faces that cut through each other, or lie in a ring, are drawn in one order all
//! the same.

use nalgebra::Vector3;
use stationary_chart::{Canvas, Path, Tone};

use crate::show::drawing::Face;
use crate::show::projection::Projection;
use crate::show::sheet::{Edges, FACE, LINES, Sheet, THIN};

/// How much more of a face is seen that is turned to the eye.
const SHADE: f64 = 0.34;

impl Sheet<'_> {
    /// Faces at a sample with the edges about them; which edges those are. In the plane, and where they are too
    /// many, faces are seen through and none of their edges are drawn.
    pub(crate) fn faces(&self, canvas: &mut Canvas, sample: usize) -> Edges {
        let faces = self.run.scene.surface();
        if faces.is_empty() || faces.len() > LINES {
            return Edges::new();
        }
        match self.in_space() {
            Some(projection) => self.painted(canvas, sample, faces, projection),
            None => {
                let mut path = Path::new();
                for face in faces {
                    path.outline(&face.corners.map(|corner| self.spot(sample, corner)));
                }
                canvas.fill(Tone::Hue(0), FACE, &path);
                Edges::new()
            }
        }
    }

    fn painted(
        &self,
        canvas: &mut Canvas,
        sample: usize,
        faces: Vec<Face>,
        projection: Projection,
    ) -> Edges {
        let lines: Edges = self.run.scene.lines().map(|[a, b]| [a.min(b), a.max(b)]).collect();
        let place = |corner: usize| Vector3::from(self.run.position(sample, corner));
        let mut ordered: Vec<(f64, Face)> = faces
            .into_iter()
            .map(|face| {
                let middle = face.corners.iter().map(|&corner| place(corner)).sum::<Vector3<f64>>();
                (projection.nearness(middle.into()), face)
            })
            .collect();
        ordered.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let mut drawn = Edges::new();
        for (_, Face { corners: corners @ [a, b, c], .. }) in ordered {
            let normal = (place(b) - place(a)).cross(&(place(c) - place(a)));
            let turned = normal.try_normalize(0.0).unwrap_or_default();
            let shade = SHADE * projection.nearness(turned.into()).abs();
            let mut path = Path::new();
            path.outline(&corners.map(|corner| self.spot(sample, corner)));
            canvas.cover(&path);
            canvas.fill(Tone::Hue(0), FACE + shade, &path);
            let mut edges = Path::new();
            for [a, b] in [[a, b], [b, c], [c, a]] {
                let edge = [a.min(b), a.max(b)];
                if lines.contains(&edge) {
                    drawn.insert(edge);
                    edges.through(edge.map(|end| self.spot(sample, end)));
                }
            }
            if !edges.is_empty() {
                canvas.stroke(Tone::Strong, THIN, &edges);
            }
        }
        drawn
    }
}
