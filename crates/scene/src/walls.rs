//! Walls as they are drawn: the part of each that lies beside what moves.
//!
//! ```text
//! in the plane    a band along the wall, on the side where nothing is
//! in space        a rectangle of the wall, below what moves
//! ```
//! A little longer than the motion is wide. A wall that is further from everything than the motion is
//! wide is not drawn, which would make the motion small.

use nalgebra::Vector3;

use crate::drawing::thinned;
use crate::{Run, Scene};

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

#[cfg(all(test, feature = "default"))]
mod tests {
    use super::*;

    fn walls(dimension: usize, normal: &str, at: &str) -> Vec<[[f64; 3]; 4]> {
        let place = |x: f64| format!("{:?}", &[x, 2.0, 1.0][..dimension]);
        let text = format!(
            "dimension = {dimension}\nintegrator = \"stormer-verlet\"\nstep = 0.1\nhorizon = 1\n\
             particles = [{{ name = \"a\", mass = 1, position = {} }},\n\
             {{ name = \"b\", mass = 1, position = {} }}]\n\
             contact = {{ walls = [{{ normal = {normal}, at = {at} }}] }}",
            place(0.0),
            place(4.0)
        );
        Scene::parse("scene", &text).unwrap().run().unwrap().walls()
    }

    #[test]
    fn a_wall_in_the_plane_is_a_band_below_its_line() {
        let [corners] = walls(2, "[0, 1]", "[7, 1]")[..] else { panic!("one wall") };
        for [x, y, z] in corners {
            assert!((-0.17..4.17).contains(&x) && (0.9..=1.0).contains(&y) && z == 0.0);
        }
        assert!(corners.iter().filter(|x| x[1] == 1.0).count() == 2);
    }

    #[test]
    fn a_wall_in_space_lies_in_its_plane() {
        let [corners] = walls(3, "[0, 0.6, 0.8]", "[0, 0, 0]")[..] else { panic!("one wall") };
        for [x, y, z] in corners {
            assert!((0.6 * y + 0.8 * z).abs() < 1e-12 && (-0.2..4.2).contains(&x));
        }
    }

    #[test]
    fn a_wall_far_from_everything_is_not_drawn() {
        assert_eq!(walls(2, "[0, 1]", "[0, -3]"), [] as [[[f64; 3]; 4]; 0]);
    }
}
