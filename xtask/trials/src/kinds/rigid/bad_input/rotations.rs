//! Rotations and matrices of bad numbers.

use nalgebra::{DMatrix, Vector3};
use stationary_rigid::{
    EulerAngles, LieGroup, Rotation, matrix_exponential, matrix_logarithm, null_space,
};

use super::{finite, number, unit, vector};
use crate::{Draw, Verdict};

pub(super) fn rotations(draw: &mut Draw) -> Verdict {
    let v = vector(draw, 0.6);
    let angle = number(draw, 0.3, 0.4);
    draw.note(format!("{v:?}, {angle:e}"));
    let made = match draw.below(4) {
        0 => Rotation::about(v, angle),
        1 => Rotation::from_quaternion([angle, v.x, v.y, v.z]),
        2 => EulerAngles { roll: v.x, pitch: angle, yaw: v.z }.rotation(),
        _ => {
            let mut matrix = Rotation::exp(Vector3::new(0.3, 0.2, -1.0)).matrix();
            if draw.chance(0.5) {
                matrix[(draw.below(3), draw.below(3))] = angle;
            }
            if draw.chance(0.2) {
                matrix *= -1.0;
            }
            Rotation::from_matrix(&matrix)
        }
    };
    match made {
        Ok(rotation) => {
            let right = unit(&rotation.quaternion());
            let _ = (rotation.axis_angle(), EulerAngles::of(&rotation));
            if right { Verdict::due() } else { Verdict::wrong("a rotation that is none") }
        }
        Err(_) => Verdict::due(),
    }
}

pub(super) fn matrices(draw: &mut Draw) -> Verdict {
    let (rows, columns) = (draw.between(0, 4), draw.between(0, 4));
    let size = draw.one_of(&[1.0, 1e-160, 1e160, 1e-310, 1e300]);
    let bad = draw.chance(0.3);
    let square = draw.chance(0.7);
    let columns = if square { rows } else { columns };
    let matrix = DMatrix::from_fn(rows, columns, |_, _| {
        if bad && draw.chance(0.3) { draw.any_f64() } else { size * draw.symmetric() }
    });
    draw.note(format!("{matrix:?}"));
    let made = match draw.below(3) {
        0 => matrix_exponential(&matrix),
        1 => matrix_logarithm(&matrix),
        _ => null_space(&matrix),
    };
    match made {
        Ok(result) if !finite(result.as_slice()) => {
            Verdict::wrong("Ok with numbers that are not finite")
        }
        Ok(_) if !finite(matrix.as_slice()) => {
            Verdict::wrong("a matrix that is not finite is taken")
        }
        _ => Verdict::due(),
    }
}
