//! Walls as they are drawn: the part of each that lies beside what moves.
//!
//! ```text
//! in the plane    a band along the wall, on the side where nothing is
//! in space        a rectangle of the wall, below what moves
//! ```
//! A little longer than the motion is wide. A wall that is further from everything than the motion is
//! wide is not drawn, which would make the motion small.

use nalgebra::Vector3;

use crate::model::scene::Scene;
use crate::run::samples::Run;
use crate::show::drawing::thinned;

/// What a band is wide, and what stands out at the ends, as parts of the motion's width.
const BAND: f64 = 0.02;
const BEYOND: f64 = 0.04;

/// Samples that are looked at for how wide the motion is.
const SAMPLES: usize = 200;

impl Run {
    /// The corners of what is drawn of each wall. None of walls on a line.
    pub(crate) fn walls(&self) -> Vec<[[f64; 3]; 4]> {
        let Scene { dimension, contact: Some(contact), .. } = &self.scene else {
            return Vec::new();
        };
        if *dimension == 1 {
            return Vec::new();
        }
        let drawn = contact.walls.iter().filter_map(|wall| {
            let normal = Vector3::from(wall.normal);
            let tangents = tangents(normal, *dimension);
            let [along, across, above] =
                [tangents[0], tangents[1], normal].map(|axis| self.range(axis));
            let wide = [along, across, above].iter().map(|[a, b]| b - a).fold(0.0, f64::max);
            if above[0] - wall.offset > wide {
                return None;
            }
            let across = match dimension {
                2 => [-BAND * wide, 0.0],
                _ => [across[0] - BEYOND * wide, across[1] + BEYOND * wide],
            };
            let along = [along[0] - BEYOND * wide, along[1] + BEYOND * wide];
            let corner = |i: usize, j: usize| {
                let [s, t] = [along[i], across[j]];
                (wall.offset * normal + s * tangents[0] + t * tangents[1]).into()
            };
            Some([corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)])
        });
        drawn
            .filter(|corners: &[[f64; 3]; 4]| corners.as_flattened().iter().all(|x| x.is_finite()))
            .collect()
    }

    /// The least and the largest distance of what moves along a direction.
    fn range(&self, axis: Vector3<f64>) -> [f64; 2] {
        let samples = thinned(self.times().len(), SAMPLES);
        let all = 0..self.scene.particles.len();
        let places = samples.into_iter().flat_map(|sample| {
            all.clone().map(move |particle| Vector3::from(self.position(sample, particle)))
        });
        places
            .map(|x| x.dot(&axis))
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)])
    }
}

/// Two directions of what is drawn: along the wall and, in the plane, out of it.
fn tangents(normal: Vector3<f64>, dimension: usize) -> [Vector3<f64>; 2] {
    if dimension == 2 {
        return [Vector3::new(-normal.y, normal.x, 0.0), normal];
    }
    let first = Vector3::ith(normal.iamin(), 1.0).cross(&normal).normalize();
    [first, normal.cross(&first)]
}
