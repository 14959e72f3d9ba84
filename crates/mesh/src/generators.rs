//! Shapes that everyone needs: lines, rectangles, discs, boxes, cylinders, balls and their
//! surfaces.

mod benchmarks;
mod flat;
mod round;
mod solid;

pub use benchmarks::{curved_elliptic_membrane, elliptic_membrane, tapered_membrane};
pub(crate) use flat::check_rectangle;
pub use flat::{Diagonals, bar, circle, curved_disc, disc, rectangle, segment};
pub use round::{ball, curved_ball, curved_sphere, curved_torus, icosphere, torus};
pub use solid::{cuboid, curved_cylinder, cylinder, extruded};

use nalgebra::SVector;

use crate::MeshError;
use crate::mesh::FARTHEST;

/// An error unless a size is positive, finite and within what coordinates may be.
fn check_size(what: &'static str, value: f64) -> Result<(), MeshError> {
    if value > 0.0 && value <= FARTHEST { Ok(()) } else { Err(MeshError::Size { what, value }) }
}

/// An error if there are fewer than that.
fn check_cells(what: &'static str, given: usize, least: usize) -> Result<(), MeshError> {
    if given >= least { Ok(()) } else { Err(MeshError::TooFew { what, given, least }) }
}

/// The unit vector to a place other than the origin, which may be so near that its square is no number.
fn direction<const D: usize>(place: SVector<f64, D>) -> SVector<f64, D> {
    let reach = place.amax();
    if reach > NEAR { place.normalize() } else { (place / reach).normalize() }
}

/// Squares of what is nearer lose digits.
const NEAR: f64 = 1e-140;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curved_shapes_are_those_of_radius_one_however_small_they_are() {
        for k in [100, 520, 531, 700, 1000] {
            let small = 2.0_f64.powi(-k);
            let same = |one: &[SVector<f64, 3>], other: &[SVector<f64, 3>]| {
                one.iter().zip(other).all(|(a, b)| (a / small - b).amax() < 1e-14)
            };
            let [disc, unit_disc] = [small, 1.0].map(|r| curved_disc(r, 2).unwrap());
            let flat = |x: &SVector<f64, 2>| SVector::from([x.x, x.y, 0.0]);
            let [disc, unit_disc] = [disc, unit_disc].map(|disc| disc.mapped(flat).unwrap());
            assert!(same(disc.nodes(), unit_disc.nodes()), "disc 2^-{k}");
            let [sphere, unit_sphere] = [small, 1.0].map(|r| curved_sphere(r, 1).unwrap());
            assert!(same(sphere.nodes(), unit_sphere.nodes()), "sphere 2^-{k}");
            let [ball, unit_ball] = [small, 1.0].map(|r| curved_ball(r, 1).unwrap());
            assert!(same(ball.nodes(), unit_ball.nodes()), "ball 2^-{k}");
            let torus = |r: f64| curved_torus([r, r / 4.0], [3, 4]).unwrap();
            assert!(same(torus(small).nodes(), torus(1.0).nodes()), "torus 2^-{k}");
            let cylinder = |r: f64| curved_cylinder(r, r, 1, 1).unwrap();
            assert!(same(cylinder(small).nodes(), cylinder(1.0).nodes()), "cylinder 2^-{k}");
        }
    }
}
