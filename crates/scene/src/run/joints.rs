//! Steps of bodies that joints hold: RATTLE along their free motion.

use stationary_calculus::{Metric, Potential, Space, System};
use stationary_constraints::{
    ConstraintOn, FreeMotion, Rattle, Redundancy, SparseDiagonal, Straight,
};
use stationary_integrators::State;
use stationary_rigid::{AxisRotations, BodyMethod, ConstantVelocity, ExactRotation, FreeBodies};

use crate::assemble::body_system::{PlanarJoints, PlanarSystem, SpatialJoints, SpatialSystem};
use crate::assemble::error::AssemblyError;
use crate::model::built::Built;
use crate::run::driven::{Application, Driven, Kicked, Shared};
use crate::run::lasting::Lasting;
use crate::run::stepper::Stepper;

type Made<'a> = Result<Box<dyn Stepper + 'a>, AssemblyError>;

/// Of bodies in space, along the free motion that the method is named after.
pub(crate) fn in_space<'a>(
    method: BodyMethod,
    system: &'a SpatialSystem,
    joints: &'a SpatialJoints,
    (initial, acting): (&State<Vec<f64>>, Option<Shared>),
) -> Made<'a> {
    let start = (initial, acting);
    match method {
        BodyMethod::AxisRotations => held(FreeBodies(AxisRotations), system, joints, start),
        BodyMethod::ExactRotation => held(FreeBodies(ExactRotation), system, joints, start),
        _ => held(FreeBodies(ConstantVelocity), system, joints, start),
    }
}

/// Of bodies in the plane.
pub(crate) fn in_the_plane<'a>(
    system: &'a PlanarSystem,
    joints: &'a PlanarJoints,
    start: (&State<Vec<f64>>, Option<Shared>),
) -> Made<'a> {
    held(Straight, system, joints, start)
}

/// RATTLE whose solver lets equations depend on others, as in a planar loop of hinges.
fn held<'a, M: Metric, P: Potential, S: Space, K: ConstraintOn<S>>(
    motion: impl FreeMotion<M, S> + Clone + 'a,
    system: &'a System<M, P, S>,
    joints: &'a K,
    (initial, acting): (&State<Vec<f64>>, Option<Shared>),
) -> Made<'a> {
    let built = Built { equations: joints.count() as u64, sparse_solvers: 1, ..Built::default() };
    let shared = SparseDiagonal(Redundancy::LeastNorm);
    let motion = Kicked { motion, acting: acting.clone() };
    let integrator = Box::new(Rattle::along(motion, system, joints, initial, shared)?);
    let lasting = Box::new(Lasting::new(integrator, built));
    Ok(match acting {
        Some(acting) => Driven::new(lasting, acting, Application::Within),
        None => lasting,
    })
}
