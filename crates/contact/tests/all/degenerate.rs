//! Erleben's degenerate configurations: what meets there at a corner or an edge has no normal of its own. Bodies
//! come to rest on them, and energy never grows.
//!
//! Source: Erleben 2018, Methodology for assessing mesh-based contact point methods.

use nalgebra::Vector3;
use stationary_calculus::{Metric, Potential};
use stationary_contact::{Collider, Detector, Shape, SpatialWorld};
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, LieGroup, PointMass, Poses, RigidMotion, Rotation, Weight,
};

type V = Vector3<f64>;

const GRAVITY: f64 = 9.81;
const FRICTION: f64 = 0.5;
/// Longer than anything here takes to fall off and come to rest, s.
const TIME: f64 = 3.0;
const MASS: f64 = 2.0;

/// What moves, about its centre of mass: half sizes 0.5 m, and a spike and a wedge 1 m high, pointing down.
#[derive(Clone, Copy)]
enum Moving {
    Cube,
    Spike,
    Wedge,
}

impl Moving {
    fn corners(self) -> Vec<V> {
        match self {
            Moving::Cube => block([-0.5; 3], [0.5; 3]),
            Moving::Spike => spike(0.5, -1.0, -0.75),
            Moving::Wedge => wedge(0.5, 0.5, -1.0, -2.0 / 3.0),
        }
    }

    fn body(self) -> Body {
        let moments = match self {
            Moving::Cube => [1.0 / 6.0; 3],
            // Side 1 and height 1.
            Moving::Spike => [7.0 / 80.0, 7.0 / 80.0, 0.1],
            // Mean squares of x, y and z: 1/24, 1/12 and 1/18.
            Moving::Wedge => [5.0 / 36.0, 7.0 / 72.0, 1.0 / 8.0],
        };
        Body::new(MASS, moments.map(|moment| MASS * moment)).unwrap()
    }
}

fn block(low: [f64; 3], high: [f64; 3]) -> Vec<V> {
    (0..8).map(|k| V::from_fn(|c, _| if k >> c & 1 == 0 { low[c] } else { high[c] })).collect()
}

/// A pyramid on a square of these half sides; its height is negative where it points down.
fn spike(half: f64, height: f64, tip: f64) -> Vec<V> {
    let base = tip - height;
    let mut corners: Vec<V> = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]]
        .map(|[x, y]| V::new(half * x, half * y, base))
        .into();
    corners.push(V::z() * tip);
    corners
}

/// A prism along y whose edge is at the height of `tip`.
fn wedge(half: f64, length: f64, height: f64, tip: f64) -> Vec<V> {
    [-length, length]
        .into_iter()
        .flat_map(|y| {
            let base = tip - height;
            [V::new(half, y, base), V::new(-half, y, base), V::new(0.0, y, tip)]
        })
        .collect()
}

fn turned(corners: Vec<V>) -> Vec<V> {
    corners.into_iter().map(|c| V::new(-c.y, c.x, c.z)).collect()
}

/// Triangles of a square floor, whose inner edges nothing may feel.
fn tiles(top: f64) -> Shape {
    let count = 9;
    let at = |k: usize| 0.5 * (k as f64 - 4.0);
    let vertices: Vec<V> =
        (0..count * count).map(|k| V::new(at(k % count), at(k / count), top)).collect();
    let mut triangles = Vec::new();
    for row in 0..count - 1 {
        for column in 0..count - 1 {
            let corner = |i: usize, j: usize| ((row + i) * count + column + j) as u32;
            triangles.push([corner(0, 0), corner(0, 1), corner(1, 1)]);
            triangles.push([corner(0, 0), corner(1, 1), corner(1, 0)]);
        }
    }
    Shape::mesh(&vertices, &triangles).unwrap()
}

/// Triangles of a block with a square hole: its top, around it, and the hole's walls.
fn holed(half: f64, outer: f64, top: f64) -> Shape {
    let square = |half: f64, z: f64| {
        [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]]
            .map(|[x, y]| V::new(half * x, half * y, z))
    };
    let vertices = [square(half, top), square(outer, top), square(half, 0.0)].concat();
    let sides = (0..4_u32).flat_map(|k| {
        let next = (k + 1) % 4;
        let strip = |low: u32, high: u32| {
            let [a, b, c, d] = [low + k, low + next, high + next, high + k];
            [[a, c, b], [a, d, c]]
        };
        [strip(0, 4), strip(8, 0)].concat()
    });
    Shape::mesh(&vertices, &sides.collect::<Vec<_>>()).unwrap()
}

struct Configuration {
    name: &'static str,
    moving: Moving,
    /// Of the centre of mass.
    start: [f64; 3],
    velocity: [f64; 3],
    fixed: Vec<Shape>,
}

fn configurations() -> Vec<Configuration> {
    let hull = |corners: Vec<V>| Shape::convex(&corners).unwrap();
    let still = [0.0; 3];
    let mut all = Vec::new();
    let mut add = |name, moving, start, velocity, fixed| {
        all.push(Configuration { name, moving, start, velocity, fixed });
    };
    let spike_up = || vec![hull(spike(0.5, 1.0, 1.0))];
    add("spike on spike", Moving::Spike, [0.0, 0.0, 1.76], still, spike_up());
    add("spike beside spike", Moving::Spike, [1e-3, 0.0, 1.76], still, spike_up());
    let groove = |half: f64| {
        let side = |sign: f64| {
            let corner = |x: f64, y: f64, z: f64| V::new(sign * x, y, z);
            let ends = [-1.0, 1.0];
            hull(
                ends.into_iter()
                    .flat_map(|y| [corner(1.0, y, 0.0), corner(0.0, y, 0.0), corner(1.0, y, half)])
                    .collect(),
            )
        };
        vec![side(1.0), side(-1.0)]
    };
    add("spike in groove", Moving::Spike, [0.0, 0.0, 0.9], still, groove(0.8));
    add("wedge in groove", Moving::Wedge, [0.0, 0.0, 0.8], still, groove(0.8));
    let hole = [
        block([0.2, -1.0, 0.0], [1.0, 1.0, 0.6]),
        block([-1.0, -1.0, 0.0], [-0.2, 1.0, 0.6]),
        block([-0.2, 0.2, 0.0], [0.2, 1.0, 0.6]),
        block([-0.2, -1.0, 0.0], [0.2, -0.2, 0.6]),
    ];
    add("spike in hole", Moving::Spike, [0.0, 0.0, 1.2], still, hole.map(hull).into());
    let mesh = vec![holed(0.2, 1.0, 0.6)];
    add("spike in a hole of a mesh", Moving::Spike, [0.0, 0.0, 1.2], still, mesh);
    let edge = wedge(0.5, 0.5, 1.0, 1.0);
    add("wedge along wedge", Moving::Wedge, [0.0, 0.0, 1.68], still, vec![hull(edge.clone())]);
    add(
        "wedge across wedge",
        Moving::Wedge,
        [0.0, 0.0, 1.68],
        still,
        vec![hull(turned(edge.clone()))],
    );
    add("wedge beside wedge", Moving::Wedge, [1e-3, 0.0, 1.68], still, vec![hull(edge)]);
    let cliff = || vec![hull(block([-1.0, -1.0, 0.0], [0.0, 1.0, 0.5]))];
    add("on a cliff's edge", Moving::Cube, [-0.05, 0.0, 1.01], still, cliff());
    add("off a cliff's edge", Moving::Cube, [0.05, 0.0, 1.01], still, cliff());
    add("on the edge of balance", Moving::Cube, [0.0, 0.0, 1.01], still, cliff());
    add("inner edges", Moving::Cube, [-0.3, 0.1, 1.0], [1.0, 0.3, 0.0], vec![tiles(0.5)]);
    let crack = || {
        vec![
            hull(block([-1.0, -1.0, 0.0], [-5e-4, 1.0, 0.5])),
            hull(block([5e-4, -1.0, 0.0], [1.0, 1.0, 0.5])),
        ]
    };
    add("cube over a crack", Moving::Cube, [0.0, 0.0, 1.01], still, crack());
    add("spike in a crack", Moving::Spike, [0.0, 0.0, 1.26], still, crack());
    let same = vec![hull(block([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0]))];
    add("parallel edges", Moving::Cube, [0.0, 0.0, 1.51], still, same);
    all
}

/// What a run came to.
struct Outcome {
    /// The most that energy grew in a step beside what lifting out of overlap gave, J.
    growth: f64,
    /// At the end, m/s and m.
    speed: f64,
    deepest: f64,
    unsettled: usize,
}

fn run(configuration: &Configuration, h: f64) -> Outcome {
    let moving = configuration.moving;
    let mut colliders = vec![Collider::on_body(0, Shape::convex(&moving.corners()).unwrap())];
    let floor = Shape::half_space(V::z()).unwrap();
    let fixed = configuration.fixed.iter().cloned().chain([floor]);
    colliders.extend(fixed.map(|shape| Collider::fixed(RigidMotion::identity(), shape)));
    let colliders = colliders.into_iter().map(|c| c.with_friction(FRICTION)).collect();
    let metric = BodyMetric::<Poses>::new(vec![moving.body()]);
    let start = BodyMotion {
        pose: RigidMotion {
            translation: V::from(configuration.start),
            rotation: Rotation::identity(),
        },
        velocity: V::from(configuration.velocity),
        angular_velocity: V::zeros(),
    };
    let mut state = metric.state(&[start]).unwrap();
    let weight = Weight {
        gravity: V::z() * -GRAVITY,
        masses: vec![PointMass { mass: MASS, point: V::zeros() }],
        space: Poses,
    };
    let system = metric.clone().under(weight).unwrap();
    let mut world = SpatialWorld::new(system, Detector::new(colliders, 1).unwrap()).unwrap();
    let mut outcome = Outcome { growth: 0.0, speed: 0.0, deepest: 0.0, unsettled: 0 };
    let energy = |world: &SpatialWorld<_>, state: &stationary_integrators::State<Vec<f64>>| {
        let system = world.system();
        let potential: &Weight<Poses> = system.potential();
        metric.kinetic_energy(state.p.view()) + potential.energy(&state.q)
    };
    let mut before = energy(&world, &state);
    for _ in 0..(TIME / h).round() as usize {
        let report = world.step(&mut state, h).unwrap();
        let after = energy(&world, &state);
        outcome.growth = outcome.growth.max(after - before - report.lifting_energy);
        outcome.unsettled += usize::from(!report.settled);
        before = after;
    }
    outcome.speed = (2.0 * metric.kinetic_energy(state.p.view()) / MASS).sqrt();
    let gaps = world.detector().detect(&state.q, 1e-3).unwrap().iter().map(|contact| contact.gap);
    outcome.deepest = gaps.fold(0.0, f64::min);
    outcome
}

/// Steps that may say that they are not settled.
const UNSETTLED: usize = 10;

#[test]
fn bodies_come_to_rest_on_degenerate_configurations_and_energy_never_grows() {
    let mut wrong = Vec::new();
    for configuration in configurations() {
        let name = configuration.name;
        for h in [1e-2, 1e-3, 2e-4] {
            let Outcome { growth, speed, deepest, unsettled } = run(&configuration, h);
            let grows = growth > 1e-12 * MASS * GRAVITY;
            if grows || speed > 1e-9 || deepest < -1e-4 || unsettled > UNSETTLED {
                wrong.push(format!(
                    "{name}, h {h:e}: growth {growth:e}, {speed:e}, {deepest:e}, {unsettled}"
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
