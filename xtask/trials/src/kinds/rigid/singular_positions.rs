//! Linkages of random sizes that turn through a position from which they may go on in two ways, without weight.
//!
//! Parallelograms through where they lie flat, slider-cranks of equal lengths through where the piston stands on the
//! crank's pivot; in the plane and in space.

use stationary_constraints::ConstraintError;

use super::two_ways::{Linkage, Shape};
use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "singular-positions",
    krate: "rigid",
    rule: "a parallelogram or a slider-crank of equal lengths that turns through its singular position, in steps \
           that end before, at and beyond it, leaves by more than 1e-6 rad what the same step does with the \
           crank's angle alone, or an error is none that names a singular position and its joints; where steps \
           end more than 0.2 of a step from it, in steps that turn less than 0.1 rad, it must pass",
    in_tests: 60,
    trial,
};

fn trial(draw: &mut Draw) -> Verdict {
    let ratio = draw.one_of(&[1.0 + 1e-9, 1e1, 1e3]);
    let shape = match draw.chance(0.5) {
        true => Shape::Parallelogram { ground: draw.log_uniform(0.3, 3.0) },
        false => Shape::SliderCrank,
    };
    let linkage = Linkage {
        shape,
        crank: draw.log_uniform(0.3, 3.0),
        masses: [0; 3].map(|_| draw.log_uniform(1.0, ratio)),
        speed: draw.log_uniform(0.3, 3.0) * draw.one_of(&[1.0, -1.0]),
    };
    let h = draw.log_uniform(1e-4, 0.1) / linkage.speed.abs();
    let part = match draw.below(3) {
        0 => draw.uniform(-0.5, 0.5),
        1 => draw.log_uniform(1e-10, 0.5),
        _ => 0.0,
    };
    let before = draw.between(1, 6);
    let singular = draw.one_of(&linkage.singular());
    let plane = draw.chance(0.5);
    draw.note(format!(
        "{linkage:?}, h {h}, lands {part} of a step beside {singular} after {before}, in the plane {plane}"
    ));
    // Led back from where it is to land: the steps are the same in both directions.
    let back = Linkage { speed: -linkage.speed, ..linkage };
    let beside = singular + part * h * linkage.speed;
    let Some(way) = back.along(beside, h, before) else {
        return Verdict::not_judged("the way back is not found");
    };
    let start = way[before - 1];
    let next = if before > 1 { way[before - 2] } else { beside };
    let linkage = Linkage { speed: linkage.speed_between(start, next, h), ..linkage };
    let Some(right) = linkage.along(start, h, before + 6) else {
        return Verdict::not_judged("the way is not found");
    };
    let turn = right[before] - right[before - 1];
    let found = match plane {
        true => linkage.in_the_plane(start, h, before + 6),
        false => linkage.in_space(start, h, before + 6),
    };
    match found {
        Ok(angles) => {
            let off = angles.iter().zip(&right).map(|(angles, right)| linkage.off(*right, *angles));
            Verdict::of(off.fold(0.0, f64::max), 1e-6, "angles of crank and coupler")
        }
        Err((step, ConstraintError::SingularPosition { names, rows, .. })) => {
            let named = names.contains("between body") || names.contains("between the world");
            let here = step.abs_diff(before) <= 1;
            let away = right.iter().map(|x| (x - singular).abs()).fold(f64::INFINITY, f64::min);
            if away > 0.2 * turn.abs() && turn.abs() < 0.1 {
                Verdict::refused(format!(
                    "a step that ends {away:e} rad from the position, at {step}"
                ))
            } else if named && here && !rows.is_empty() {
                Verdict::due()
            } else {
                Verdict::wrong(format!("{names} at step {step}"))
            }
        }
        Err((0, error @ ConstraintError::Singular { .. })) => Verdict::wrong(error),
        Err((step, error)) => Verdict::wrong(format!("{error} at step {step}")),
    }
}
