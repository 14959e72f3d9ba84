//! Joints of bad numbers and of absent bodies.

use stationary_calculus::{Covector, System};
use stationary_constraints::{Few, Rattle, Redundancy};
use stationary_integrators::State;
use stationary_rigid::{Attachment, BodyMetric, ConstantVelocity, Free, FreeBodies, Joint, Poses};

use super::{box_of_one, finite, vector};
use crate::{Draw, Verdict};

pub(super) fn joints(draw: &mut Draw) -> Verdict {
    let bodies = draw.between(0, 2);
    let end = |draw: &mut Draw| match draw.chance(0.3) {
        true => Attachment::World(vector(draw, 0.3)),
        false => Attachment::Body(draw.between(0, 3), vector(draw, 0.3)),
    };
    let ends = [end(draw), end(draw)];
    draw.note(format!("{ends:?} of {bodies}"));
    let named = |end: &Attachment| match *end {
        Attachment::World(v) => finite(v.as_slice()),
        Attachment::Body(body, v) => body < bodies && finite(v.as_slice()),
    };
    let axes = [vector(draw, 0.4), vector(draw, 0.4)];
    let made = match draw.below(2) {
        0 => Joint::ball(Poses, bodies, ends),
        _ => Joint::hinge(Poses, bodies, ends, axes),
    };
    match made {
        Ok(_) if !ends.iter().all(named) => Verdict::wrong("a joint at no body or no point"),
        Ok(joint) => {
            // Of a system that has fewer bodies.
            let metric = BodyMetric::<Poses>::new(vec![box_of_one()]);
            let Ok(system) = System::on(Poses, metric, Free { freedoms: 6 }) else {
                return Verdict::wrong("no system");
            };
            let state = State::new(vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], Covector(vec![0.0; 6]));
            let motion = FreeBodies(ConstantVelocity);
            let few = Few::<6>(Redundancy::Refuse);
            match Rattle::along(motion, &system, &joint, &state, few) {
                Ok(_) if bodies > 1 => Verdict::wrong("a joint of more bodies than there are"),
                _ => Verdict::due(),
            }
        }
        Err(_) => Verdict::due(),
    }
}
