//! Joints of bad numbers and of absent bodies.

use stationary_calculus::{Covector, System};
use stationary_constraints::{Rattle, Redundancy, SparseDiagonal};
use stationary_integrators::State;
use stationary_rigid::{
    BodyMetric, ConstantVelocity, Free, FreeBodies, Joint, JointEnd, JointKind, Poses,
};

use super::{box_of_one, finite, vector};
use crate::{Draw, Verdict};

fn is_direction(axis: &nalgebra::Vector3<f64>) -> bool {
    finite(axis.as_slice()) && axis.amax() > 0.0
}

pub(super) fn joints(draw: &mut Draw) -> Verdict {
    let bodies = draw.between(0, 2);
    let end = |draw: &mut Draw| match draw.chance(0.3) {
        true => JointEnd::world(vector(draw, 0.3)),
        false => JointEnd::on(draw.between(0, 3), vector(draw, 0.3)),
    };
    let ends = [end(draw), end(draw)];
    draw.note(format!("{ends:?} of {bodies}"));
    let named = |end: &JointEnd| {
        end.body.is_none_or(|body| body < bodies) && finite(end.frame.translation.as_slice())
    };
    let (axes, length) = ([vector(draw, 0.4), vector(draw, 0.4)], draw.symmetric());
    let [axis, _] = axes;
    let (kind, told) = match draw.below(7) {
        0 => (JointKind::Ball, true),
        1 => (JointKind::Hinge { axis }, is_direction(&axis)),
        2 => (JointKind::Universal { axes }, axes.iter().all(is_direction)),
        3 => (JointKind::Planar { axes }, axes.iter().all(is_direction)),
        4 => (JointKind::Screw { axis, pitch: length }, is_direction(&axis)),
        5 => (JointKind::Rod { length }, length > 0.0),
        _ => (JointKind::OnCircle { axis, radius: length }, is_direction(&axis) && length > 0.0),
    };
    match Joint::new(Poses, bodies, kind, ends) {
        Ok(_) if !ends.iter().all(named) => Verdict::wrong("a joint at no body or no point"),
        Ok(_) if !told => Verdict::wrong("a joint of no axis or no length"),
        Ok(joint) => {
            // Of a system that has fewer bodies.
            let metric = BodyMetric::<Poses>::new(vec![box_of_one()]);
            let Ok(system) = System::on(Poses, metric, Free { freedoms: 6 }) else {
                return Verdict::wrong("no system");
            };
            let state = State::new(vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], Covector(vec![0.0; 6]));
            let motion = FreeBodies(ConstantVelocity);
            let few = SparseDiagonal(Redundancy::Refuse);
            match Rattle::along(motion, &system, &joint, &state, few) {
                Ok(_) if bodies > 1 => Verdict::wrong("a joint of more bodies than there are"),
                _ => Verdict::due(),
            }
        }
        Err(_) => Verdict::due(),
    }
}
