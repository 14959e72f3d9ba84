//! Worlds of the plane and of space: cradles, racks, stacks, inclines and an arch.

use nalgebra::{Vector2, Vector3};
use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_contact::{
    Arch, Collider, ContactError, Detector, ImpactLaw, PlanarCollider, PlanarDetector, PlanarShape,
    PlanarWorld, Shape, SpatialWorld, World, WorldReport, problems::nine_ball_break,
};
use stationary_integrators::State;
use stationary_measure::SplitMix64;
use stationary_mesh::Polygon;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, Free, LieGroup, PlanarMass, PlanarMotion, PlanarRotation,
    PlanarWeight, PointMass, Poses, RigidMotion, Rotation, Weight,
};

const G: f64 = 10.0;

type Table = PlanarWorld<PlanarWeight>;

/// Bodies of these masses and moments of inertia, with their shapes, over fixed ones.
fn planar(bodies: &[(f64, f64)], gravity: Vector2<f64>, colliders: Vec<PlanarCollider>) -> Table {
    let inertia = bodies.iter().flat_map(|&(m, i)| [m, m, i]).collect::<Vec<_>>();
    let masses = bodies.iter().map(|body| body.0).collect();
    let metric = DiagonalMetric::new(inertia).unwrap();
    let system = System::new(metric, PlanarWeight { gravity, masses }).unwrap();
    World::new(system, PlanarDetector::new(colliders, bodies.len()).unwrap()).unwrap()
}

fn ground(friction: f64) -> PlanarCollider {
    let shape = PlanarShape::half_plane(Vector2::y()).unwrap();
    PlanarCollider::fixed(PlanarMotion::identity(), shape).with_friction(friction)
}

fn disc(body: usize, radius: f64) -> PlanarCollider {
    PlanarCollider::on_body(body, PlanarShape::disc(radius).unwrap())
}

const DISC: (f64, f64) = (1.0, 0.125);

/// Elastic discs of 0.5 m without friction on a table.
fn rack(centres: &[[f64; 2]]) -> (Table, State<Vec<f64>>) {
    let colliders = (0..centres.len()).map(|k| disc(k, 0.5).with_restitution(1.0)).collect();
    let world = planar(&vec![DISC; centres.len()], Vector2::zeros(), colliders);
    let q: Vec<f64> = centres.iter().flat_map(|&[x, y]| [x, y, 0.0]).collect();
    let p = vec![0.0; q.len()];
    (world, State::new(q, Covector(p)))
}

#[test]
fn as_many_discs_leave_newtons_cradle_as_arrive() {
    for moving in 1..=3 {
        for gap in [0.0, 1e-9, 0.013] {
            let centres: Vec<_> = (0..5).map(|k| [f64::from(k) * (1.0 + gap), 0.0]).collect();
            let (mut world, mut state) = rack(&centres);
            (0..moving).for_each(|ball| state.p.0[3 * ball] = 1.0);
            let mut impacts = 0;
            for _ in 0..200 {
                impacts += world.step(&mut state, 1e-3).unwrap().impacts;
            }
            assert!(impacts >= 4, "{impacts}");
            for (ball, p) in state.p.0.chunks_exact(3).enumerate() {
                let expected = if ball >= 5 - moving { 1.0 } else { 0.0 };
                assert!((p[0] - expected).abs() < 1e-12 && p[1].abs() < 1e-12, "{ball} {p:?}");
            }
        }
    }
}

#[test]
fn as_many_balls_of_space_leave_newtons_cradle_as_arrive() {
    for moving in 1..=3 {
        let metric = BodyMetric::<Poses>::new(vec![Body::new(1.0, [0.1; 3]).unwrap(); 5]);
        let motion = |k: usize| BodyMotion {
            pose: RigidMotion {
                translation: Vector3::x() * k as f64,
                rotation: Rotation::identity(),
            },
            velocity: if k < moving { Vector3::x() } else { Vector3::zeros() },
            angular_velocity: Vector3::zeros(),
        };
        let mut state = metric.state(&(0..5).map(motion).collect::<Vec<_>>()).unwrap();
        let ball = Shape::ball(0.5).unwrap();
        let on = |body| Collider::on_body(body, ball.clone()).with_restitution(1.0);
        let detector = Detector::new((0..5).map(on).collect(), 5).unwrap();
        let free = metric.under(Free { freedoms: 30 }).unwrap();
        let mut world = SpatialWorld::new(free, detector).unwrap();
        for _ in 0..100 {
            world.step(&mut state, 1e-3).unwrap();
        }
        for (ball, p) in state.p.0.chunks_exact(6).enumerate() {
            let expected = if ball >= 5 - moving { 1.0 } else { 0.0 };
            assert!((p[0] - expected).abs() < 1e-12, "{ball} {p:?}");
        }
    }
}

#[test]
fn a_rack_of_nine_breaks_symmetrically_and_keeps_energy_and_momentum() {
    let mut centres = vec![[-0.3, 0.0]];
    for (rank, balls) in [1, 2, 3, 2, 1].into_iter().enumerate() {
        for ball in 0..balls {
            let y = f64::from(ball) - 0.5 * f64::from(balls - 1);
            centres.push([1.0 + 0.75_f64.sqrt() * rank as f64, y]);
        }
    }
    let (mut world, mut state) = rack(&centres);
    state.p.0[0] = 1.0;
    for _ in 0..1000 {
        world.step(&mut state, 1e-3).unwrap();
    }
    let energy: f64 = state.p.0.iter().map(|p| 0.5 * p * p).sum();
    assert!((energy - 0.5).abs() < 1e-12, "{energy}");
    let total: f64 = state.p.0.iter().step_by(3).sum();
    assert!((total - 1.0).abs() < 1e-12, "{total}");
    let mirror = nine_ball_break().mirror;
    for (ball, _) in centres.iter().enumerate() {
        let twin = mirror[2 * ball].0 / 2;
        let [x, y] = [0, 1].map(|k| state.q[3 * ball + k]);
        let [u, v] = [0, 1].map(|k| state.q[3 * twin + k]);
        assert!((x - u).abs() < 1e-9 && (y + v).abs() < 1e-9, "{ball} and {twin}");
    }
    let far = state.q[3 * 9] - centres[9][0];
    assert!(far > 0.1, "the last ball has left: {far}");
}

#[test]
fn a_box_of_elastic_discs_keeps_its_energy_at_every_step_down_to_a_microsecond() {
    for h in [1e-2, 1e-3, 1e-4, 1e-5, 1e-6] {
        // Gaps of some thirty steps, so that they hit each other and the walls often.
        let gap = 30.0 * h;
        let place = |k: usize| 0.5 * gap + 0.1 + (0.2 + gap) * k as f64;
        let far = 3.0 * (0.2 + gap);
        let wall = |x: f64, y: f64, along: f64| {
            let place = PlanarMotion {
                translation: -Vector2::new(x, y) * along,
                rotation: PlanarRotation::identity(),
            };
            PlanarCollider::fixed(place, PlanarShape::half_plane(Vector2::new(x, y)).unwrap())
        };
        let walls =
            [wall(1.0, 0.0, 0.0), wall(0.0, 1.0, 0.0), wall(-1.0, 0.0, far), wall(0.0, -1.0, far)];
        let discs = (0..9).map(|body| disc(body, 0.1).with_restitution(1.0));
        let mut world = planar(&[DISC; 9], Vector2::zeros(), discs.chain(walls).collect());
        let q = (0..9).flat_map(|k| [place(k % 3), place(k / 3), 0.0]).collect();
        let mut random = SplitMix64::new(6);
        let p = (0..27).map(|k| if k % 3 < 2 { random.symmetric() } else { 0.0 }).collect();
        let mut state = State::new(q, Covector(p));
        let energy = |state: &State<Vec<f64>>| state.p.0.iter().map(|p| 0.5 * p * p).sum::<f64>();
        let (start, mut impacts) = (energy(&state), 0);
        for _ in 0..2_000 {
            impacts += world.step(&mut state, h).unwrap().impacts;
        }
        assert!(impacts > 200, "{h}: {impacts}");
        assert!((energy(&state) / start - 1.0).abs() < 1e-9, "{h}: {}", energy(&state) / start);
        let deepest = world.detector().overlaps(&state.q, 1e-9).unwrap();
        assert!(deepest.is_empty(), "{h}: {deepest:?}");
    }
}

/// Boxes of 1 m on each other.
fn stack(count: usize) -> (Table, State<Vec<f64>>) {
    let square = PlanarShape::cuboid([0.5; 2]).unwrap();
    let on = |body| PlanarCollider::on_body(body, square.clone()).with_friction(0.5);
    let colliders = (0..count).map(on).chain([ground(0.5)]).collect();
    let world = planar(&vec![(1.0, 1.0 / 6.0); count], -Vector2::y() * G, colliders);
    let q = (0..count).flat_map(|k| [0.0, 0.5 + k as f64, 0.0]).collect();
    (world, State::new(q, Covector(vec![0.0; 3 * count])))
}

#[test]
fn ten_boxes_of_the_plane_stand_and_every_joint_carries_what_is_above_it() {
    let (mut world, mut state) = stack(10);
    let start = state.clone();
    let mut worst = WorldReport::default();
    let h = 1e-3;
    for _ in 0..2_000 {
        let report = world.step(&mut state, h).unwrap();
        worst.residual = worst.residual.max(report.residual);
        worst.coulomb = worst.coulomb.max(report.coulomb);
    }
    let drift = state.q.iter().zip(&start.q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let speed = state.p.0.iter().fold(0.0_f64, |m, p| m.max(p.abs()));
    assert!(drift < 1e-9 && speed < 1e-9, "{drift} {speed}");
    assert!(worst.residual < 1e-10 && worst.coulomb < 1e-10, "{worst:?}");
    let touches: Vec<_> = world.touches().collect();
    assert_eq!(touches.len(), 20);
    for joint in 0..9_u32 {
        let between = touches.iter().filter(|t| t.contact.id.colliders == [joint, joint + 1]);
        let carried: f64 = between.map(|touch| touch.normal).sum();
        assert!((carried - f64::from(9 - joint) * G * h).abs() < 1e-9, "{joint}: {carried}");
    }
}

#[test]
fn a_block_of_the_plane_sticks_below_the_friction_angle_and_slides_above_it() {
    let mu = 0.5_f64;
    for angle in [0.2, mu.atan() - 1e-3, mu.atan() + 1e-3, 0.9] {
        let turn = PlanarRotation::exp(angle);
        let normal = turn.rotate(&Vector2::y());
        let slope = PlanarShape::half_plane(normal).unwrap();
        let block = PlanarShape::cuboid([0.5, 0.2]).unwrap();
        let colliders = vec![
            PlanarCollider::on_body(0, block).with_friction(mu),
            PlanarCollider::fixed(PlanarMotion::identity(), slope).with_friction(mu),
        ];
        let mut world = planar(&[(2.0, 0.2)], -Vector2::y() * G, colliders);
        let centre = normal * 0.2;
        let mut state = State::new(vec![centre.x, centre.y, angle], Covector(vec![0.0; 3]));
        for _ in 0..1000 {
            let report = world.step(&mut state, 1e-3).unwrap();
            assert!(report.coulomb < 1e-10 && report.residual < 1e-10, "{report:?}");
        }
        let speed = state.p.0[0].hypot(state.p.0[1]) / 2.0;
        let expected = (G * (angle.sin() - mu * angle.cos())).max(0.0);
        assert!((speed - expected).abs() < 1e-6, "{angle}: {speed} {expected}");
        let off = Vector2::new(state.q[0], state.q[1]).dot(&normal) - 0.2;
        assert!(off.abs() < 1e-9, "{off}");
        let touch = world.touches().next().unwrap();
        let rubs = touch.friction.norm();
        assert!(rubs <= mu * touch.normal + 1e-12 && rubs > 0.0, "{touch:?}");
    }
}

#[test]
fn a_world_of_space_rests_slides_and_bounces_by_the_same_rules() {
    let mu = 0.4_f64;
    let angle = 0.7_f64;
    let rotation = Rotation::exp(Vector3::y() * angle);
    let normal = rotation.rotate(&Vector3::z());
    let still = |translation| BodyMotion {
        pose: RigidMotion { translation, rotation },
        velocity: Vector3::zeros(),
        angular_velocity: Vector3::zeros(),
    };
    let body = Body::solid_box(1.0, [0.5, 0.4, 0.3]).unwrap();
    let metric = BodyMetric::<Poses>::new(vec![body; 2]);
    let high = normal * 2.0 + Vector3::y() * 5.0;
    let mut state = metric.state(&[still(normal * 0.3), still(high)]).unwrap();
    let masses = vec![PointMass { mass: 1.0, point: Vector3::zeros() }; 2];
    let weight = Weight { gravity: -Vector3::z() * G, masses, space: Poses };
    let block = Shape::cuboid([0.5, 0.4, 0.3]).unwrap();
    let slope = Shape::half_space(normal).unwrap();
    let colliders = vec![
        Collider::on_body(0, block.clone()).with_friction(mu),
        Collider::on_body(1, block),
        Collider::fixed(RigidMotion::identity(), slope).with_friction(mu),
    ];
    let detector = Detector::new(colliders, 2).unwrap().with_pair([1, 2], 0.5, 0.0).unwrap();
    let mut world = SpatialWorld::new(metric.under(weight).unwrap(), detector).unwrap();
    let (mut hit, mut rebound) = (0.0, 0.0_f64);
    for _ in 0..1000 {
        let before = Vector3::from_column_slice(&state.p.0[6..9]).dot(&normal);
        let report = world.step(&mut state, 1e-3).unwrap();
        assert!(report.residual < 1e-10 && report.coulomb < 1e-10, "{report:?}");
        if world.touches().any(|t| t.contact.bodies == [Some(1), None] && t.impact > 0.0)
            && hit == 0.0
        {
            hit = before;
            rebound = Vector3::from_column_slice(&state.p.0[6..9]).dot(&normal);
        }
    }
    let speed = Vector3::from_column_slice(&state.p.0[..3]).norm();
    let expected = G * (angle.sin() - mu * angle.cos());
    assert!((speed - expected).abs() < 1e-6, "{speed} {expected}");
    assert!(hit < -1.0 && (rebound + 0.5 * hit).abs() < 0.02, "{hit} {rebound}");
}

#[test]
fn an_obstacle_of_the_plane_pushes_and_reports_its_work() {
    let square = PlanarShape::cuboid([0.5; 2]).unwrap();
    let colliders = (0..2).map(|body| PlanarCollider::on_body(body, square.clone())).collect();
    let world = planar(&[(1.0, 1.0 / 6.0); 2], Vector2::zeros(), colliders);
    let mut world = world.with_obstacles(vec![0]).unwrap();
    let mut state = State::new(
        vec![0.0, 0.0, 0.0, 1.2, 0.0, 0.0],
        Covector(vec![0.5, 0.0, 0.0, 0.0, 0.0, 0.0]),
    );
    let work: f64 = (0..1000).map(|_| world.step(&mut state, 1e-3).unwrap().work).sum();
    assert_eq!(state.p.0[0], 0.5, "nothing slows it down");
    assert!((state.p.0[3] - 0.5).abs() < 1e-12 && (work - 0.25).abs() < 1e-12, "{work}");
}

/// A block on a conveyor belt that rises or sinks, of a half-plane or of a long box: it is taken along by friction, and
/// lies flat.
#[test]
fn a_block_on_a_half_plane_that_moves_is_taken_along_as_on_a_long_box() {
    let (mu, mass, speed, steps, h) = (0.4, 2.0, 2.0, 300, 1e-3);
    let long = PlanarShape::cuboid([5.0, 1.0]).unwrap();
    for (floor, top) in [(PlanarShape::half_plane(Vector2::y()).unwrap(), 0.0), (long, 1.0)] {
        for rise in [0.0, 0.5, -0.5] {
            let block = PlanarShape::cuboid([0.5, 0.05]).unwrap();
            let shapes = [floor.clone(), block].into_iter().enumerate();
            let colliders = shapes.map(|(body, shape)| PlanarCollider::on_body(body, shape));
            let colliders = colliders.map(|c| c.with_friction(mu)).collect();
            let world = planar(&[(7.0, 1.0), (mass, 0.3)], Vector2::y() * -G, colliders);
            let mut world = world.with_obstacles(vec![0]).unwrap();
            let q = vec![0.0, -top, 0.0, 0.0, 0.05, 0.0];
            let p = vec![7.0 * speed, 7.0 * rise, 0.0, 0.0, mass * rise, 0.0];
            let (mut state, mut work) = (State::new(q, Covector(p)), 0.0);
            for _ in 0..steps {
                let report = world.step(&mut state, h).unwrap();
                assert!(report.settled && report.overlap < 1e-12, "{report:?}");
                work += report.work;
            }
            let time = f64::from(steps) * h;
            assert!((state.p.0[3] / mass - mu * G * time).abs() < 1e-12, "{:?}", state.p);
            assert!((state.q[4] - rise * time - 0.05).abs() < 1e-12 && state.q[5].abs() < 1e-12);
            let expected = mass * G * time * (mu * speed + rise);
            assert!((work - expected).abs() < 1e-10, "{work} {expected}");
        }
    }
}

/// A tray that tilts about the world's origin, of a half-plane or of a long box.
#[test]
fn a_block_on_a_half_plane_that_turns_moves_as_on_a_long_box() {
    let long = PlanarShape::cuboid([5.0, 1.0]).unwrap();
    let run = |floor: PlanarShape, top: f64| {
        let place = PlanarMotion {
            translation: Vector2::new(0.0, -top),
            rotation: PlanarRotation::identity(),
        };
        let tray = PlanarCollider { place, ..PlanarCollider::on_body(0, floor) };
        let block = PlanarCollider::on_body(1, PlanarShape::cuboid([0.2, 0.1]).unwrap());
        let colliders = [tray, block].map(|c| c.with_friction(0.3)).to_vec();
        let world = planar(&[(1.0, 1.0), (2.0, 0.3)], Vector2::y() * -G, colliders);
        let mut world = world.with_obstacles(vec![0]).unwrap();
        let q = vec![0.0, 0.0, 0.0, 1.5, 0.1, 0.0];
        let p = vec![0.0, 0.0, 0.5, 0.0, 0.5 * 1.5 * 2.0, 0.0];
        let mut state = State::new(q, Covector(p));
        for _ in 0..1_000 {
            assert!(world.step(&mut state, 1e-3).unwrap().settled);
        }
        state
    };
    let plane = run(PlanarShape::half_plane(Vector2::y()).unwrap(), 0.0);
    let tray = run(long, 1.0);
    assert!(tray.q[3] < 1.3, "it slides down: {:?}", tray.q);
    for (a, b) in plane.q.iter().zip(&tray.q) {
        assert!((a - b).abs() < 1e-6, "{:?} {:?}", plane.q, tray.q);
    }
}

#[test]
fn bad_steps_leave_the_state_and_what_touched() {
    let (mut world, mut state) = stack(2);
    world.step(&mut state, 1e-3).unwrap();
    let (start, touches) = (state.clone(), world.touches().collect::<Vec<_>>());
    assert!(matches!(world.step(&mut state, f64::NAN), Err(ContactError::Step(_))));
    state.p.0[3] = f64::NAN;
    assert!(matches!(world.step(&mut state, 1e-3), Err(ContactError::NonFinite { .. })));
    state.p.0.pop();
    assert!(matches!(world.step(&mut state, 1e-3), Err(ContactError::Size(_))));
    assert_eq!((&state.q, world.touches().collect()), (&start.q, touches));
    let (world, _) = stack(2);
    assert!(matches!(world.with_obstacles(vec![2]), Err(ContactError::Size(_))));
}

#[test]
fn jacobis_law_stops_two_discs_that_hit_one_between_them() {
    let (world, mut state) = rack(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]);
    let mut world = world.with_law(ImpactLaw::Jacobi);
    (state.p.0[0], state.p.0[6]) = (1.0, -1.0);
    world.step(&mut state, 1e-3).unwrap();
    assert!(state.p.0.iter().all(|p| p.abs() < 1e-12), "{:?}", state.p.0);
}

const ARCH: Arch = Arch { wedges: 11, radius: 1.0, thickness: 0.3, friction: 0.6, gravity: G };

#[test]
fn an_arch_stands_with_friction_and_falls_without() {
    let (mut world, mut state) = ARCH.built().unwrap();
    let start = state.clone();
    let mut worst = WorldReport::default();
    for _ in 0..1000 {
        let report = world.step(&mut state, 1e-3).unwrap();
        worst.residual = worst.residual.max(report.residual);
        worst.coulomb = worst.coulomb.max(report.coulomb);
    }
    let drift = state.q.iter().zip(&start.q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!("drift {drift:e}, {worst:?}");
    assert!(drift < 1e-6, "{drift}");
    let slippery = Arch { friction: 0.0, ..ARCH };
    let (mut world, mut state) = slippery.built().unwrap();
    for _ in 0..500 {
        world.step(&mut state, 1e-3).unwrap();
    }
    assert!(slippery.sunk(&start, &state) > 0.3, "{}", slippery.sunk(&start, &state));
}

/// Two cards that lean on each other over a floor, apex at (x, y + 1); feet 0.3 m off.
fn tent(x: f64, y: f64) -> [Vec<Vector2<f64>>; 2] {
    let (foot, wide, high) = (0.3, 0.02, 1.0);
    let cut = high * wide / (foot + wide);
    let left = [[-foot - wide, 0.0], [-foot, 0.0], [0.0, high - cut], [0.0, high]];
    [-1.0, 1.0].map(|side| {
        left.iter().map(|corner| Vector2::new(x - side * corner[0], y + corner[1])).collect()
    })
}

/// Two tents, a card across, and a tent on it.
fn card_house(friction: f64) -> (Table, State<Vec<f64>>) {
    let [wide, thick] = [0.8, 0.02];
    let across = [[-wide, 1.0], [wide, 1.0], [wide, 1.0 + thick], [-wide, 1.0 + thick]];
    let mut outlines = [tent(-0.4, 0.0), tent(0.4, 0.0), tent(0.0, 1.0 + thick)].concat();
    outlines.push(across.iter().map(|&[x, y]| Vector2::new(x, y)).collect());
    let (mut bodies, mut colliders, mut q) = (Vec::new(), Vec::new(), Vec::new());
    for (body, corners) in outlines.into_iter().enumerate() {
        let moments = Polygon::new(vec![corners.clone()]).unwrap().moments();
        let mass = PlanarMass::of(50.0, &moments).unwrap();
        let own: Vec<_> = corners.iter().map(|corner| corner - mass.centre).collect();
        let card = PlanarShape::polygon(&own).unwrap();
        colliders.push(PlanarCollider::on_body(body, card).with_friction(friction));
        bodies.push((mass.mass, mass.inertia));
        q.extend([mass.centre.x, mass.centre.y, 0.0]);
    }
    colliders.push(ground(friction));
    let rest = vec![0.0; q.len()];
    (planar(&bodies, -Vector2::y() * G, colliders), State::new(q, Covector(rest)))
}

#[test]
fn a_house_of_seven_cards_stands_on_rough_ground_and_slides_apart_on_smooth() {
    for (friction, stands) in [(0.6, true), (0.1, false)] {
        let (mut world, mut state) = card_house(friction);
        let start = state.clone();
        for _ in 0..300 {
            world.step(&mut state, 1e-3).unwrap();
        }
        let sunk = start.q[3 * 6 + 1] - state.q[3 * 6 + 1];
        println!("friction {friction}: sunk by {sunk:e}");
        assert!(if stands { sunk.abs() < 1e-6 } else { sunk > 0.05 }, "{friction}: {sunk}");
    }
}
