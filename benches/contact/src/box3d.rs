//! Boxes of space in Box3D, as its port to Rust has it: numbers of 32 bits, four substeps a step, as its manual says.

use box3d_rust::body::{
    body_get_angular_velocity, body_get_linear_velocity, body_get_transform, create_body,
};
use box3d_rust::hull::make_box_hull;
use box3d_rust::shape::create_hull_shape;
use box3d_rust::types::{BodyType, default_body_def, default_shape_def, default_world_def};
use box3d_rust::world::World;
use box3d_rust::{BodyId, Pos, Quat, Vec3};
use nalgebra::Vector3;
use stationary_contact::problems::{FRICTION, GRAVITY};
use stationary_rigid::{LieGroup, RigidMotion, Rotation};

use crate::{STEP, SUBSTEPS};

/// Cubes of a side of 1 m and of 1 kg on a floor, at rest.
pub struct Box3d {
    world: World,
    bodies: Vec<BodyId>,
}

impl Box3d {
    pub fn new(starts: &[RigidMotion], can_sleep: bool) -> Self {
        let mut definition = default_world_def();
        definition.gravity = Vec3 { x: 0.0, y: 0.0, z: -GRAVITY as f32 };
        definition.enable_sleep = can_sleep;
        let mut world = World::new(&definition);
        let mut shape = default_shape_def();
        shape.density = 1.0;
        shape.base_material.friction = FRICTION as f32;
        let mut floor = default_body_def();
        floor.position = Pos { x: 0.0, y: 0.0, z: -1.0 };
        let ground = create_body(&mut world, &floor);
        create_hull_shape(&mut world, ground, &shape, &make_box_hull(1000.0, 1000.0, 1.0).base);
        let cube = make_box_hull(0.5, 0.5, 0.5);
        let insert = |start: &RigidMotion| {
            let [w, x, y, z] = start.rotation.quaternion().map(|c| c as f32);
            let at = start.translation.map(|c| c as f32);
            let mut body = default_body_def();
            body.type_ = BodyType::Dynamic;
            body.position = Pos { x: at.x, y: at.y, z: at.z };
            body.rotation = Quat { v: Vec3 { x, y, z }, s: w };
            let body = create_body(&mut world, &body);
            create_hull_shape(&mut world, body, &shape, &cube.base);
            body
        };
        let bodies = starts.iter().map(insert).collect();
        Box3d { world, bodies }
    }

    pub fn step(&mut self) {
        self.world.step(STEP as f32, SUBSTEPS);
    }

    /// Poses and velocities as ours are.
    pub fn states(&self) -> (Vec<f64>, Vec<f64>) {
        let (mut q, mut v) = (Vec::new(), Vec::new());
        let wide = |a: Vec3| Vector3::new(f64::from(a.x), f64::from(a.y), f64::from(a.z));
        for &body in &self.bodies {
            let place = body_get_transform(&self.world, body);
            let (at, turn) = (wide(place.p), wide(place.q.v));
            let w = f64::from(place.q.s);
            let length = (w * w + turn.norm_squared()).sqrt();
            let quaternion = [w, turn.x, turn.y, turn.z].map(|c| c / length);
            q.extend([at.x, at.y, at.z]);
            q.extend(quaternion);
            let spin = wide(body_get_angular_velocity(&self.world, body));
            let back = Rotation::exp(2.0 * w.clamp(-1.0, 1.0).acos() * unit(turn)).inverse();
            let (linear, spin) =
                (wide(body_get_linear_velocity(&self.world, body)), back.rotate(&spin));
            v.extend([linear.x, linear.y, linear.z, spin.x, spin.y, spin.z]);
        }
        (q, v)
    }
}

fn unit(a: Vector3<f64>) -> Vector3<f64> {
    a.try_normalize(0.0).unwrap_or_default()
}
