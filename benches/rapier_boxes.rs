//! Boxes in rapier3d-f64 as they are in ours.

use rapier3d_f64::prelude::{
    ColliderBuilder, PhysicsWorld, RigidBodyBuilder, RigidBodyHandle, Vector,
};
use stationary_contact::problems::{FRICTION, GRAVITY};
use stationary_rigid::{LieGroup, RigidMotion};

/// The step, seconds.
pub const STEP: f64 = 1e-3;

/// Cubes of a side of 1 m on a floor, at rest, one solver thread.
pub fn rapier(starts: &[RigidMotion], can_sleep: bool) -> (PhysicsWorld, Vec<RigidBodyHandle>) {
    let gravity = Vector::Z * -GRAVITY;
    let mut world = PhysicsWorld { gravity, ..PhysicsWorld::default() };
    world.integration_parameters.dt = STEP;
    let floor = ColliderBuilder::cuboid(1000.0, 1000.0, 1.0).translation(Vector::Z * -1.0);
    world.insert(RigidBodyBuilder::fixed(), floor.friction(FRICTION));
    let insert = |start: &RigidMotion| {
        let [x, y, z] = start.translation.into();
        let turn = start.rotation.log();
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::new(x, y, z))
            .rotation(Vector::new(turn.x, turn.y, turn.z))
            .can_sleep(can_sleep);
        let cube = ColliderBuilder::cuboid(0.5, 0.5, 0.5).friction(FRICTION);
        world.insert(body, cube).0
    };
    let handles = starts.iter().map(insert).collect();
    (world, handles)
}
