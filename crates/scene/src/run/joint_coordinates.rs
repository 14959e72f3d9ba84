//! Steps of bodies in the coordinates of their joints: as many numbers as there are freedoms, beside loops.
//!
//! ```text
//! joint-coordinates      -D1 L(q, q') = p,  p' = D2 L(q, q')        equal steps, order 2
//! dormand-prince-853     v. = M(q)^-1 (f - C(q, v))                 steps chosen to a tolerance
//! dormand-prince-54      the same
//! W = h/2 (F u + F' u')                                             of what acts, in an equal step
//! ```
//! `q v p` coordinates, speeds and momenta of joints, `f` what potentials and all else give them: the forces
//! `F` on the bodies, whose velocities are `u`, along the joints. No joint can come apart but those that close
//! loops, which are held as rods are: to rounding at the end of each equal step, and where other steps are read.

mod equal_steps;
mod forces;
mod reader;

use stationary_integrators::{
    AdaptiveMethod, DormandPrince54, DormandPrince853, Moment, StepControl, Tolerance,
};
use stationary_rigid::tree::{TreeField, TreeForces};

use crate::assemble::acting::Acting;
use crate::assemble::body_system::BodySystem;
use crate::assemble::error::AssemblyError;
use crate::model::scene::Scene;
use crate::model::stepping::{Adaptive, Stepping};
use crate::run::adaptive::read_off;
use crate::run::stepper::Stepper;
use equal_steps::EqualSteps;
use forces::Forces;
use reader::JointReader;

/// What steps the bodies of a scene in the coordinates of their joints.
pub(crate) fn stepper<'a>(
    scene: &Scene,
    system: &'a dyn BodySystem,
) -> Result<Box<dyn Stepper + 'a>, AssemblyError> {
    let joints = scene.joint_tree()?;
    let [q, v] = joints.start(scene)?;
    let acting = Acting::of(scene);
    let Stepping::Adaptive { method, tolerance } = scene.stepping else {
        return Ok(Box::new(EqualSteps::new(scene, system, joints, [&q, &v])?));
    };
    let scales = joints.scales(scene.scale(), scene.timing.horizon(), &v)?;
    let allowed: Vec<f64> = scales.into_iter().map(|scale| scale * tolerance).collect();
    let control = StepControl::from(Tolerance::componentwise(tolerance, allowed.clone())?);
    let state = [q, v].concat();
    let field = || {
        let none = TreeForces::none(&joints.tree);
        let drive = Forces::new(&joints, system, acting.clone()).drive();
        let field = TreeField::driven(joints.tree.clone(), none, drive)?;
        let field =
            if joints.loops.rows() > 0 { field.closed(joints.loops.clone()) } else { field };
        field.prescribed(joints.drives.clone())
    };
    // What cannot begin says why: a field alone has no word but NaN.
    field()?.loop_forces(0.0, &state, &mut vec![0.0; joints.loops.rows()])?;
    let start = Moment::new(0.0, state);
    let reader = Box::new(JointReader::new(joints.clone(), field()?, allowed)?);
    let method: Box<dyn AdaptiveMethod<Vec<f64>>> = match method {
        Adaptive::DormandPrince54 => Box::new(DormandPrince54::new(field()?, control, start)?),
        _ => Box::new(DormandPrince853::new(field()?, control, start)?),
    };
    Ok(read_off(scene, system.initial(), method, reader, acting))
}
