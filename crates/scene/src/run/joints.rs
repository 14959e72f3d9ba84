//! Steps of bodies that joints hold: RATTLE along their free motion.

use stationary_calculus::{Metric, Potential, Space, System};
use stationary_constraints::{
    ConstraintOn, FreeMotion, Rattle, Redundancy, SparseDiagonal, Straight,
};
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

/// RATTLE whose solver lets equations depend on others, as in a planar loop of hinges.
fn held<'a, M: Metric, P: Potential, S: Space, K: ConstraintOn<S>>(
    motion: impl FreeMotion<M, S> + Clone + 'a,
    system: &'a System<M, P, S>,
    joints: &'a K,
    initial: &State<Vec<f64>>,
) -> Made<'a> {
    let built = Built { equations: joints.count() as u64, sparse_solvers: 1, ..Built::default() };
    let shared = SparseDiagonal(Redundancy::LeastNorm);
    let integrator = Box::new(Rattle::along(motion, system, joints, initial, shared)?);
    Ok(Box::new(Lasting { integrator, built }))
}
