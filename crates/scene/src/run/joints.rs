//! Steps of bodies that joints hold: RATTLE along their free motion.

use stationary_calculus::{Metric, Potential, Space, System};
use stationary_constraints::{ConstraintOn, Few, FreeMotion, Many, Rattle, Redundancy, Straight};
use stationary_integrators::State;
use stationary_rigid::{
    AxisRotations, BodyMethod, ConstantVelocity, ExactRotation, FreeBodies, Joint, PlanarJoint,
    Poses,
};

use crate::assemble::body_system::{PlanarSystem, SpatialSystem};
use crate::assemble::error::AssemblyError;
use crate::model::built::Built;
use crate::run::lasting::Lasting;
use crate::run::stepper::Stepper;

type Made<'a> = Result<Box<dyn Stepper + 'a>, AssemblyError>;

/// Of bodies in space, along the free motion that the method is named after.
pub(crate) fn in_space<'a>(
    method: BodyMethod,
    system: &'a SpatialSystem,
    joints: &'a Vec<Joint<Poses>>,
    initial: &State<Vec<f64>>,
) -> Made<'a> {
    match method {
        BodyMethod::AxisRotations => held(FreeBodies(AxisRotations), system, joints, initial),
        BodyMethod::ExactRotation => held(FreeBodies(ExactRotation), system, joints, initial),
        _ => held(FreeBodies(ConstantVelocity), system, joints, initial),
    }
}

/// Of bodies in the plane.
pub(crate) fn in_the_plane<'a>(
    system: &'a PlanarSystem,
    joints: &'a Vec<PlanarJoint>,
    initial: &State<Vec<f64>>,
) -> Made<'a> {
    held(Straight, system, joints, initial)
}

/// Equations up to which every one may depend on others, as in a planar loop of hinges.
const FEW: usize = 24;

/// RATTLE with a solver that fits the number of equations.
fn held<'a, M: Metric, P: Potential, S: Space, K: ConstraintOn<S>>(
    motion: impl FreeMotion<M, S> + Clone + 'a,
    system: &'a System<M, P, S>,
    joints: &'a K,
    initial: &State<Vec<f64>>,
) -> Made<'a> {
    let equations = joints.count();
    let built = Built { equations: equations as u64, ..Built::default() };
    if equations > FEW {
        let many = Many(Redundancy::LeastNorm);
        let integrator = Box::new(Rattle::along(motion, system, joints, initial, many)?);
        return Ok(Box::new(Lasting { integrator, built: Built { sparse_solvers: 1, ..built } }));
    }
    let few = Few::<FEW>(Redundancy::LeastNorm);
    let integrator = Box::new(Rattle::along(motion, system, joints, initial, few)?);
    Ok(Box::new(Lasting { integrator, built }))
}
