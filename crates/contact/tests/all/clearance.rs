//! What passes with clearance is not deflected, and no contact is lost, however far a step goes.

use nalgebra::{Vector2, Vector3};
use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_contact::{
    Collider, Detector, PlanarCollider, PlanarDetector, PlanarShape, PlanarWorld, Shape,
    SpatialWorld,
};
use stationary_integrators::State;
use stationary_measure::SplitMix64;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, LieGroup, PlanarMotion, PlanarRotation, PlanarWeight, PointMass,
    Poses, RigidMotion, Rotation, Weight,
};

type V = Vector3<f64>;

/// A number from one to another, evenly on a scale of powers.
fn power(from: f64, to: f64, random: &mut SplitMix64) -> f64 {
    from * (to / from).powf(random.symmetric().abs())
}

fn turn(random: &mut SplitMix64) -> Rotation {
    Rotation::exp(V::from_fn(|_, _| 2.0 * random.symmetric()))
}

/// One body of 1 kg among what is fixed, without gravity, after a step: velocity and place.
fn thrown(shape: Shape, fixed: Vec<Collider>, motion: BodyMotion, h: f64) -> (V, V) {
    let metric = BodyMetric::<Poses>::new(vec![Body::new(1.0, [0.1, 0.11, 0.12]).unwrap()]);
    let mut state = metric.state(&[motion]).unwrap();
    let masses = vec![PointMass { mass: 1.0, point: V::zeros() }];
    let weight = Weight { gravity: V::zeros(), masses, space: Poses };
    let colliders = fixed.into_iter().chain([Collider::on_body(0, shape)]).collect();
    let detector = Detector::new(colliders, 1).unwrap();
    let mut world = SpatialWorld::new(metric.under(weight).unwrap(), detector).unwrap();
    world.step(&mut state, h).unwrap();
    (V::from_column_slice(&state.p.0[..3]), V::from_column_slice(&state.q[..3]))
}

/// A solid, and how far it reaches from its centre at most and along its own z.
fn solid(random: &mut SplitMix64) -> (Shape, f64, f64) {
    let half = V::from_fn(|_, _| power(0.2, 1.0, random));
    let sign = |k: u32, i: usize| if k >> i & 1 == 0 { -1.0 } else { 1.0 };
    let corners: Vec<V> = (0..8).map(|k| V::from_fn(|i, _| half[i] * sign(k, i))).collect();
    match random.bits() % 3 {
        0 => (Shape::ball(half.z).unwrap(), half.z, half.z),
        1 => (Shape::cuboid(half.into()).unwrap(), half.norm(), half.z),
        _ => (Shape::convex(&corners).unwrap(), half.norm(), half.z),
    }
}

/// A floor in the plane z = 0 of some axes, and what stands on it lower than a height.
fn floor(turn: &Rotation, size: f64, random: &mut SplitMix64) -> Vec<Collider> {
    let place = |x: V| RigidMotion { translation: turn.rotate(&x), rotation: *turn };
    let cuts = |random: &mut SplitMix64| -> Vec<f64> {
        let mut cuts: Vec<f64> = (0..6).map(|_| size * random.symmetric()).collect();
        cuts.extend([-size, size]);
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|a, b| *a - *b < 1e-3 * size);
        cuts
    };
    match random.bits() % 3 {
        0 => vec![Collider::fixed(place(V::zeros()), Shape::half_space(V::z()).unwrap())],
        1 => {
            let (xs, ys) = (cuts(random), cuts(random));
            let tile = |x: &[f64], y: &[f64]| {
                let half = [0.5 * (x[1] - x[0]), 0.5 * (y[1] - y[0]), 1.0];
                let middle = V::new(0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1]), -1.0);
                Collider::fixed(place(middle), Shape::cuboid(half).unwrap())
            };
            xs.windows(2).flat_map(|x| ys.windows(2).map(move |y| tile(x, y))).collect()
        }
        _ => {
            let (xs, ys) = (cuts(random), cuts(random));
            let vertices: Vec<V> =
                xs.iter().flat_map(|&x| ys.iter().map(move |&y| V::new(x, y, 0.0))).collect();
            let rows = ys.len() as u32;
            let cell = |i: u32, j: u32| {
                let [a, b, c, d] = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
                let [a, b, c, d] = [a, b, c, d].map(|(i, j)| i * rows + j);
                [[a, b, c], [a, c, d]]
            };
            let triangles: Vec<_> = (0..xs.len() as u32 - 1)
                .flat_map(|i| (0..rows - 1).flat_map(move |j| cell(i, j)))
                .collect();
            let mesh = Shape::mesh(&vertices, &triangles).unwrap();
            vec![Collider::fixed(place(V::zeros()), mesh)]
        }
    }
}

#[test]
fn what_passes_a_solid_with_clearance_is_not_deflected_up_to_a_thousand_diameters_a_step() {
    let mut random = SplitMix64::new(41);
    for k in 0..600 {
        let ((shape, radius, _), (other, far, _)) = (solid(&mut random), solid(&mut random));
        let axes = turn(&mut random);
        let clearance = radius * power(1e-4, 1.0, &mut random);
        let way = 2.0 * radius * power(0.1, 1e3, &mut random);
        let past = random.symmetric() * way;
        let from = V::new(-0.5 * (way + past), radius + far + clearance, 0.0);
        let h = power(1e-4, 1.0, &mut random);
        let motion = BodyMotion {
            pose: RigidMotion { translation: axes.rotate(&from), rotation: turn(&mut random) },
            velocity: axes.rotate(&V::x()) * (way / h),
            angular_velocity: V::from_fn(|_, _| random.symmetric() / h),
        };
        let rotation = turn(&mut random);
        let place = RigidMotion { translation: V::zeros(), rotation };
        let (v, _) = thrown(shape, vec![Collider::fixed(place, other)], motion, h);
        let off = (v - motion.velocity).norm() / motion.velocity.norm();
        assert!(off < 1e-12, "{k}: by {off:e}, {way:e} at a clearance of {clearance:e}");
    }
}

#[test]
fn what_slides_past_a_floor_with_clearance_is_not_deflected() {
    let mut random = SplitMix64::new(42);
    for k in 0..300 {
        let (shape, radius, low) = solid(&mut random);
        let axes = turn(&mut random);
        let way = 2.0 * radius * power(0.1, 1e3, &mut random);
        let ground = floor(&axes, 2.0 * way + 2.0, &mut random);
        let clearance = radius * power(1e-4, 1.0, &mut random);
        // Down towards the floor, and not down to it.
        let (start, drop) = (low + clearance * 2.0, clearance);
        let h = power(1e-4, 1.0, &mut random);
        let yaw = Rotation::exp(V::z() * random.symmetric());
        let motion = BodyMotion {
            pose: RigidMotion {
                translation: axes.rotate(&V::new(-0.5 * way, 0.1 * way, start)),
                rotation: axes.compose(&yaw),
            },
            velocity: axes.rotate(&V::new(way, 0.3 * way, -drop)) / h,
            angular_velocity: V::zeros(),
        };
        let (v, _) = thrown(shape, ground, motion, h);
        let off = (v - motion.velocity).norm() / motion.velocity.norm();
        assert!(off < 1e-12, "{k}: by {off:e}, {way:e} at a clearance of {clearance:e}");
    }
}

#[test]
fn what_reaches_a_floor_of_tiles_or_triangles_stays_above_it_however_far_it_goes() {
    let mut random = SplitMix64::new(43);
    for k in 0..600 {
        let (shape, radius, low) = solid(&mut random);
        let axes = turn(&mut random);
        let way = 2.0 * radius * power(0.1, 1e3, &mut random);
        let ground = floor(&axes, 2.0 * way + 2.0, &mut random);
        let gap = [0.0, 1e-9, 1e-3, 0.5][k % 4] * low;
        let yaw = Rotation::exp(V::z() * random.symmetric());
        let h = power(1e-4, 1.0, &mut random);
        let drop = gap + way * power(1e-3, 1.0, &mut random);
        let motion = BodyMotion {
            pose: RigidMotion {
                translation: axes.rotate(&V::new(-0.5 * way, 0.1 * way, low + gap)),
                rotation: axes.compose(&yaw),
            },
            velocity: axes.rotate(&V::new(way, 0.3 * way, -drop)) / h,
            angular_velocity: V::zeros(),
        };
        let (v, x) = thrown(shape, ground, motion, h);
        let height = axes.rotate_back(&x).z - low;
        assert!(height > -1e-9 * radius, "{k}: {height:e} below, {way:e} a step, gap {gap:e}");
        let along = axes.rotate_back(&(v * h)).x / way;
        assert!((along - 1.0).abs() < 1e-9, "{k}: {along}");
    }
}

/// A post that stands on the floor is passed, and the floor in front of it is met.
#[test]
fn what_passes_a_post_on_the_way_to_the_floor_lands_undeflected() {
    let mut random = SplitMix64::new(44);
    for k in 0..200 {
        let (radius, side) = (0.1, if k % 2 == 0 { 1.0 } else { -1.0 });
        let way = 2.0 * radius * power(1.0, 1e2, &mut random);
        let post = PlanarMotion {
            translation: Vector2::new(0.3 * way * random.symmetric(), 0.05 * way),
            rotation: PlanarRotation::identity(),
        };
        let height = 0.05 * way;
        let clearance = radius * power(1e-3, 1.0, &mut random);
        // Over the top of the post and then down to the floor, seen from the side.
        let top = post.translation.y + height + radius + clearance;
        let from = Vector2::new(post.translation.x - 0.45 * way * side, top);
        let velocity = Vector2::new(way * side, -0.0);
        let floor = PlanarShape::half_plane(Vector2::y()).unwrap();
        let colliders = vec![
            PlanarCollider::fixed(post, PlanarShape::cuboid([0.01 * way, height]).unwrap()),
            PlanarCollider::fixed(PlanarMotion::identity(), floor),
            PlanarCollider::on_body(0, PlanarShape::disc(radius).unwrap()),
        ];
        let metric = DiagonalMetric::new(vec![1.0, 1.0, 0.1]).unwrap();
        let weight = PlanarWeight { gravity: Vector2::zeros(), masses: vec![1.0] };
        let system = System::new(metric, weight).unwrap();
        let mut world =
            PlanarWorld::new(system, PlanarDetector::new(colliders, 1).unwrap()).unwrap();
        let mut state = State::new(
            vec![from.x, from.y, 0.0],
            Covector(vec![velocity.x, velocity.y, 0.1 * random.symmetric()]),
        );
        world.step(&mut state, 1.0).unwrap();
        let v = Vector2::new(state.p.0[0], state.p.0[1]);
        assert!((v - velocity).norm() < 1e-12 * way, "{k}: {v} instead of {velocity}");
    }
}
