//! A wall of bricks in the plane, struck by a heavy one: ours, rapier2d-f64 and box2d-rust.

use nalgebra::Vector2;
use rapier2d_f64::prelude::{
    ColliderBuilder, PhysicsWorld, RigidBodyBuilder, RigidBodyHandle, Vector,
};
use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_contact::problems::{FRICTION, GRAVITY};
use stationary_contact::{PlanarCollider, PlanarDetector, PlanarShape, PlanarWorld};
use stationary_integrators::State;
use stationary_rigid::{LieGroup, PlanarMotion, PlanarWeight};

use crate::box2d::{Box2d, Brick};
use crate::quality::{Seen, look};
use crate::{LOOKS, Row, STEP};

/// Half a brick, m; its mass is 1 kg.
const BRICK: [f64; 2] = [0.5, 0.25];
/// Half of what strikes, a square, its mass and its speed.
const STRIKER: f64 = 1.0;
const STRIKER_MASS: f64 = 10.0;
const SPEED: f64 = 10.0;

/// Rows of so many bricks, every other set off by half of one, then the striker.
fn places(long: usize, high: usize) -> Vec<[f64; 2]> {
    let brick = |k: usize| {
        let (row, column) = (k / long, k % long);
        [column as f64 + 0.5 * (row % 2) as f64, BRICK[1] * (2 * row + 1) as f64]
    };
    let striker = [-3.0, 0.5 * high as f64 * BRICK[1] * 2.0];
    (0..long * high).map(brick).chain([striker]).collect()
}

fn inertia(mass: f64, half: [f64; 2]) -> f64 {
    mass * (half[0] * half[0] + half[1] * half[1]) / 3.0
}

pub fn struck(long: usize, high: usize, time: f64) -> Vec<Row> {
    let places = places(long, high);
    let bricks = long * high;
    let of = |body: usize| match body < bricks {
        true => (1.0, BRICK),
        false => (STRIKER_MASS, [STRIKER; 2]),
    };
    let masses: Vec<f64> = (0..=bricks).map(|body| of(body).0).collect();
    let stored = |body: usize| {
        let (mass, half) = of(body);
        [mass, mass, inertia(mass, half)]
    };
    let diagonal: Vec<f64> = (0..=bricks).flat_map(stored).collect();
    let lightness: Vec<f64> = diagonal.iter().map(|mass| mass.recip()).collect();
    let weight = PlanarWeight { gravity: Vector2::y() * -GRAVITY, masses };
    let system = System::new(DiagonalMetric::new(diagonal.clone()).expect("masses"), weight)
        .expect("a system");
    let detector = || {
        let shape = |body: usize| PlanarShape::cuboid(of(body).1).expect("a box");
        let on_body = |body| PlanarCollider::on_body(body, shape(body)).with_friction(FRICTION);
        let floor = PlanarShape::half_plane(Vector2::y()).expect("a floor");
        let floor = PlanarCollider::fixed(PlanarMotion::identity(), floor).with_friction(FRICTION);
        PlanarDetector::new((0..=bricks).map(on_body).chain([floor]).collect(), bricks + 1)
            .expect("colliders")
    };
    let mut ours = PlanarWorld::new(system, detector()).expect("a world");
    let start: Vec<f64> = places.iter().flat_map(|[x, y]| [*x, *y, 0.0]).collect();
    let mut p = vec![0.0; start.len()];
    p[3 * bricks] = STRIKER_MASS * SPEED;
    let mut state = State::new(start.clone(), Covector(p));
    let (mut world, handles) = rapier(&places, bricks);
    let mut third = Box2d::new(places.iter().enumerate().map(|(body, &at)| {
        let (mass, half) = of(body);
        Brick { at, half, mass, speed: if body < bricks { 0.0 } else { SPEED } }
    }));
    let mut watch = detector();
    let kick = [0.0, -GRAVITY * STEP, 0.0].repeat(bricks + 1);
    let mut rows = ["ours", "rapier2d-f64", "box2d-rust"].map(Row::named);
    let velocities =
        |p: &[f64]| -> Vec<f64> { p.iter().zip(&lightness).map(|(p, light)| p * light).collect() };
    for step in 1..=(time / STEP).round() as usize {
        let was =
            (step % LOOKS == 0).then(|| (state.clone(), states(&world, &handles), third.states()));
        rows[0].timed(|| ours.step(&mut state, STEP)).expect("a step");
        rows[1].timed(|| world.step());
        rows[2].timed(|| third.step());
        let Some((own, (q, v), (q3, v3))) = was else { continue };
        let mut seen = |q: &[f64], before: &[f64], after: &[f64]| {
            look(
                &mut watch,
                &Seen { q, before, after, kick: &kick, lightness: &lightness, h: STEP },
            )
        };
        let left = seen(&own.q, &velocities(&own.p.0), &velocities(&state.p.0));
        rows[0].left = rows[0].left.or_worse(left);
        rows[1].left = rows[1].left.or_worse(seen(&q, &v, &states(&world, &handles).1));
        rows[2].left = rows[2].left.or_worse(seen(&q3, &v3, &third.states().1));
    }
    let drift = |q: &[f64]| {
        let moved = |(q, from): (&[f64], &[f64])| (q[0] - from[0]).hypot(q[1] - from[1]);
        q.chunks_exact(3).zip(start.chunks_exact(3)).map(moved).fold(0.0, f64::max)
    };
    rows[0].drift = drift(&state.q);
    rows[1].drift = drift(&states(&world, &handles).0);
    rows[2].drift = drift(&third.states().0);
    rows.to_vec()
}

fn rapier(places: &[[f64; 2]], bricks: usize) -> (PhysicsWorld, Vec<RigidBodyHandle>) {
    let gravity = Vector::Y * -GRAVITY;
    let mut world = PhysicsWorld { gravity, ..PhysicsWorld::default() };
    world.integration_parameters.dt = STEP;
    let floor = ColliderBuilder::cuboid(1000.0, 1.0).translation(Vector::Y * -1.0);
    world.insert(RigidBodyBuilder::fixed(), floor.friction(FRICTION));
    let insert = |(body, [x, y]): (usize, &[f64; 2])| {
        let (half, mass, speed) = match body < bricks {
            true => (BRICK, 1.0, 0.0),
            false => ([STRIKER; 2], STRIKER_MASS, SPEED),
        };
        let density = mass / (4.0 * half[0] * half[1]);
        let moving = RigidBodyBuilder::dynamic()
            .translation(Vector::new(*x, *y))
            .linvel(Vector::new(speed, 0.0))
            .can_sleep(false);
        let cuboid = ColliderBuilder::cuboid(half[0], half[1]).friction(FRICTION).density(density);
        world.insert(moving, cuboid).0
    };
    let handles = places.iter().enumerate().map(insert).collect();
    (world, handles)
}

fn states(world: &PhysicsWorld, handles: &[RigidBodyHandle]) -> (Vec<f64>, Vec<f64>) {
    let (mut q, mut v) = (Vec::new(), Vec::new());
    for handle in handles {
        let body = &world.bodies[*handle];
        let (at, linear) = (body.translation(), body.linvel());
        q.extend([at.x, at.y, body.rotation().angle()]);
        v.extend([linear.x, linear.y, body.angvel()]);
    }
    (q, v)
}
