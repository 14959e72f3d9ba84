//! Mass properties of bad numbers.

use nalgebra::{Matrix3, Vector3};
use stationary_rigid::{LieGroup, PlanarMass, PrincipalFrame, SpatialMass};

use super::{finite, number, vector};
use crate::{Draw, Verdict};

pub(super) fn masses(draw: &mut Draw) -> Verdict {
    let size = draw.one_of(&[1.0, 1e-160, 1e160, 1e-310, 1e300]);
    match draw.below(3) {
        0 => {
            let mut tensor = Matrix3::from_fn(|_, _| 0.1 * draw.symmetric());
            tensor = (tensor + tensor.transpose()) * 0.5 + Matrix3::identity();
            tensor *= size;
            if draw.chance(0.4) {
                tensor[(draw.below(3), draw.below(3))] = draw.any_f64();
            }
            draw.note(format!("{tensor:?}"));
            match PrincipalFrame::of(&tensor) {
                Ok(frame) => {
                    // The largest doubles leave a product no room for rounding.
                    let (q, largest) = (frame.rotation.matrix(), tensor.amax());
                    let moments = Matrix3::from_diagonal(&Vector3::from(frame.moments));
                    let back = q * (moments / largest) * q.transpose();
                    Verdict::of((back - tensor / largest).amax(), 1e-11, "a principal frame")
                }
                Err(_) => Verdict::due(),
            }
        }
        1 => {
            let mut piece = SpatialMass {
                mass: number(draw, 1.0, 0.3),
                centre: vector(draw, 0.3),
                inertia: Matrix3::identity() * size,
            };
            if draw.chance(0.3) {
                piece.inertia[draw.below(9)] = draw.any_f64();
            }
            let count = draw.between(0, 3);
            draw.note(format!("{count} of {piece:?}"));
            if let Ok(all) = SpatialMass::composite(&vec![piece; count]) {
                let numbers = finite(all.centre.as_slice()) && finite(all.inertia.as_slice());
                if !numbers {
                    return Verdict::wrong("a composite that is not finite");
                }
            }
            match piece.body() {
                Ok((_, pose)) if !finite(pose.translation.as_slice()) => {
                    Verdict::wrong("a body's centre is not finite")
                }
                _ => Verdict::due(),
            }
        }
        _ => {
            let piece = PlanarMass {
                mass: number(draw, 1.0, 0.4),
                centre: vector(draw, 0.4).xy(),
                inertia: number(draw, 1.0, 0.4),
            };
            let count = draw.between(0, 3);
            draw.note(format!("{count} of {piece:?}"));
            match PlanarMass::composite(&vec![piece; count]) {
                Ok(all) if !(finite(all.centre.as_slice()) && all.inertia.is_finite()) => {
                    Verdict::wrong("a composite that is not finite")
                }
                _ => Verdict::due(),
            }
        }
    }
}
