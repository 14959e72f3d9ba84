//! Boxes of the plane in Box2D, as its port to Rust has it: numbers of 32 bits, four substeps a step, as its manual
//! says.

use box2d_rust::body::{
    body_get_angular_velocity, body_get_linear_velocity, body_get_position, body_get_rotation,
    create_body,
};
use box2d_rust::geometry::make_box;
use box2d_rust::id::BodyId;
use box2d_rust::math_functions::{Pos, Vec2};
use box2d_rust::shape::create_polygon_shape;
use box2d_rust::types::{BodyType, default_body_def, default_shape_def, default_world_def};
use box2d_rust::world::{World, world_step};
use stationary_contact::problems::{FRICTION, GRAVITY};

use crate::{STEP, SUBSTEPS};

/// A box: where its centre is, m, half its sides, m, its mass, kg, and its speed along x, m/s.
pub struct Brick {
    pub at: [f64; 2],
    pub half: [f64; 2],
    pub mass: f64,
    pub speed: f64,
}

/// Boxes on a floor.
pub struct Box2d {
    world: World,
    bodies: Vec<BodyId>,
}

impl Box2d {
    pub fn new(bricks: impl Iterator<Item = Brick>) -> Self {
        let mut definition = default_world_def();
        definition.gravity = Vec2 { x: 0.0, y: -GRAVITY as f32 };
        definition.enable_sleep = false;
        let mut world = World::new(&definition);
        let mut shape = default_shape_def();
        shape.material.friction = FRICTION as f32;
        let mut floor = default_body_def();
        floor.position = Pos { x: 0.0, y: -1.0 };
        let ground = create_body(&mut world, &floor);
        create_polygon_shape(&mut world, ground, &shape, &make_box(1000.0, 1.0));
        let insert = |brick: Brick| {
            let [a, b] = brick.half;
            let mut body = default_body_def();
            body.type_ = BodyType::Dynamic;
            body.position = Pos { x: brick.at[0] as f32, y: brick.at[1] as f32 };
            body.linear_velocity = Vec2 { x: brick.speed as f32, y: 0.0 };
            shape.density = (brick.mass / (4.0 * a * b)) as f32;
            let body = create_body(&mut world, &body);
            create_polygon_shape(&mut world, body, &shape, &make_box(a as f32, b as f32));
            body
        };
        let bodies = bricks.map(insert).collect();
        Box2d { world, bodies }
    }

    pub fn step(&mut self) {
        world_step(&mut self.world, STEP as f32, SUBSTEPS);
    }

    /// Places and velocities as ours are.
    pub fn states(&self) -> (Vec<f64>, Vec<f64>) {
        let (mut q, mut v) = (Vec::new(), Vec::new());
        for &body in &self.bodies {
            let (at, turn) =
                (body_get_position(&self.world, body), body_get_rotation(&self.world, body));
            let linear = body_get_linear_velocity(&self.world, body);
            q.extend([at.x, at.y, turn.s.atan2(turn.c)].map(f64::from));
            let spin = body_get_angular_velocity(&self.world, body);
            v.extend([linear.x, linear.y, spin].map(f64::from));
        }
        (q, v)
    }
}
