//! Rolling and torsional friction: how far a ball rolls against the step, and which heaps of boxes are not settled.

use nalgebra::Vector3;
use stationary_chart::{Axis, Lines, Series};
use stationary_contact::problems::falling_boxes;
use stationary_contact::{Collider, ContactError, Detector, Shape, SpatialWorld, WorldReport};
use stationary_integrators::State;
use stationary_measure::{Column, SplitMix64, Table, loglog_slope};
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, LieGroup, PointMass, Poses, RigidMotion, Rotation, Weight,
};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// The error of a ball's way against the number of steps, and what heaps of boxes leave.
pub const ROLLING_FRICTION: Entry<'static> = Entry {
    id: "rolling-friction",
    krate: "contact",
    chapter: "friction",
    kind: Kind::Limit,
    title: "Rolling friction: the way of a ball against the step, and heaps that are not settled",
    tested: Tested::Claims,
    run: &study,
};

const GRAVITY: f64 = 9.81;
const RADIUS: f64 = 0.2;
const MASS: f64 = 3.0;
/// Length of rolling friction of the ball, m, and its speed, m/s.
const LENGTH: f64 = 0.01;
const SPEED: f64 = 1.5;
/// Steps of a heap, and their length, s.
const STEPS: usize = 25;
const STEP: f64 = 0.01;
/// The longest length of rolling and torsional friction in a heap, m; half a box's side is 0.5 m.
const LONGEST: f64 = 0.1;
const BOXES: [usize; 4] = [1, 2, 4, 8];
/// Masses are within so many powers of ten of 1 kg.
const SPREADS: [f64; 3] = [0.0, 1.5, 3.0];

type World = SpatialWorld<Weight<Poses>>;

fn world(
    bodies: Vec<Body>,
    motions: &[BodyMotion],
    detector: Detector,
) -> Result<(World, State<Vec<f64>>), ContactError> {
    let still = Vector3::zeros();
    let masses = bodies.iter().map(|body| PointMass { mass: body.mass(), point: still }).collect();
    let weight = Weight { gravity: -Vector3::z() * GRAVITY, masses, space: Poses };
    let metric = BodyMetric::<Poses>::new(bodies);
    let state = metric.state(motions)?;
    Ok((SpatialWorld::new(metric.under(weight)?, detector)?, state))
}

/// How far a ball has rolled when it rests, m, and how many systems a step took.
fn way(h: f64) -> Result<[f64; 2], ContactError> {
    let moment = 0.4 * MASS * RADIUS * RADIUS;
    let (ball, floor) = (Shape::ball(RADIUS)?, Shape::half_space(Vector3::z())?);
    let colliders = vec![
        Collider::on_body(0, ball).with_friction(0.8),
        Collider::fixed(RigidMotion::identity(), floor).with_friction(0.8),
    ];
    let detector = Detector::new(colliders, 1)?.with_rolling([0, 1], LENGTH, 0.0)?;
    let pose = RigidMotion { translation: Vector3::z() * RADIUS, rotation: Rotation::identity() };
    let motion = BodyMotion {
        pose,
        velocity: Vector3::x() * SPEED,
        angular_velocity: Vector3::y() * (SPEED / RADIUS),
    };
    let (mut world, mut state) = world(vec![Body::new(MASS, [moment; 3])?], &[motion], detector)?;
    let rests = SPEED * RADIUS * 1.4 / (GRAVITY * LENGTH) + 0.2;
    let steps = (rests / h).ceil() as usize;
    let mut solved = 0;
    for _ in 0..steps {
        solved += world.step(&mut state, h)?.solved;
    }
    Ok([state.q[0], solved as f64 / steps as f64])
}

/// The reports of a heap of boxes that falls on a floor, each pair with lengths of its own, and the most that a step
/// gained of energy, J, relative to what there was.
fn heap(
    boxes: usize,
    spread: f64,
    random: &mut SplitMix64,
) -> Result<(Vec<WorldReport>, f64), ContactError> {
    let falling = falling_boxes(boxes)?;
    let mut detector = falling.detector()?;
    for (a, b) in (0..=boxes).flat_map(|a| (0..a).map(move |b| (a, b))) {
        let lengths = [0; 2].map(|_| LONGEST * random.symmetric().abs());
        detector = detector.with_rolling([b, a], lengths[0], lengths[1])?;
    }
    let any = |random: &mut SplitMix64| Vector3::from_fn(|_, _| random.symmetric());
    let (mut bodies, mut motions) = (Vec::new(), Vec::new());
    for mut pose in falling.starts {
        pose.translation.z -= 0.4;
        bodies.push(Body::solid_box(10.0_f64.powf(spread * random.symmetric()), [0.5; 3])?);
        motions.push(BodyMotion { pose, velocity: any(random), angular_velocity: any(random) });
    }
    let (mut world, mut state) = world(bodies, &motions, detector)?;
    let (mut reports, mut gained) = (Vec::new(), f64::NEG_INFINITY);
    let mut before = world.system().energy(&state.q, state.p.view());
    for _ in 0..STEPS {
        let report = world.step(&mut state, STEP)?;
        let after = world.system().energy(&state.q, state.p.view());
        gained = gained.max((after - before - report.lifting_energy) / before.abs());
        before = after;
        reports.push(report);
    }
    Ok((reports, gained))
}

fn study(size: Size) -> Result<Study, StudyError> {
    let (halvings, count) = if size == Size::Full { (9, 40) } else { (6, 6) };
    let mut table = Table::new([
        Column::exact("scene"),
        Column::exact("largest ratio of masses"),
        Column::exact("steps"),
        Column::exact("not settled"),
        Column::rounded("systems a step", 2, 0.0),
        Column::rounded("error of the way [m]", 2, 1e-9),
        Column::rounded("residual of steps not settled [m/s], the worst", 1, 1e-9),
    ]);
    let expected = SPEED * SPEED * RADIUS * 1.4 / (2.0 * GRAVITY * LENGTH);
    let mut errors = Vec::new();
    for k in 0..halvings {
        let h = 0.02 / 2.0_f64.powi(k);
        let [way, systems] = way(h).map_err(StudyError::at("a ball that rolls"))?;
        let error = (way - expected).abs();
        errors.push((h, error));
        let steps = (SPEED * RADIUS * 1.4 / (GRAVITY * LENGTH) / h).ceil() as u64;
        table.push([
            "a ball".into(),
            1.0.into(),
            steps.into(),
            0_u64.into(),
            systems.into(),
            error.into(),
            0.0.into(),
        ]);
    }
    let axes = (Axis::log("step", "s"), Axis::log("error of the way", "m"));
    let mut precision = Lines::new("How far a ball rolls", axes.0, axes.1).slope(1.0, (3e-3, 1e-3));
    precision = precision.with(Series::new("ball", errors.clone()));
    let axes = (Axis::linear("boxes", ""), Axis::linear("part not settled", ""));
    let mut edge = Lines::new("Steps of heaps that are not settled", axes.0, axes.1);
    let mut random = SplitMix64::new(41);
    let (mut few, mut gained) = ([0, 0], f64::NEG_INFINITY);
    for spread in SPREADS {
        let ratio = 10.0_f64.powf(2.0 * spread);
        let mut curve = Vec::new();
        for boxes in BOXES {
            let (mut steps, mut unsettled, mut systems, mut worst) = (0, 0, 0, 0.0_f64);
            for _ in 0..count {
                let (reports, gain) =
                    heap(boxes, spread, &mut random).map_err(StudyError::at("a heap"))?;
                gained = gained.max(gain);
                for report in reports {
                    steps += 1;
                    systems += report.solved;
                    if !report.settled {
                        unsettled += 1;
                        worst = worst.max(report.residual.max(report.coulomb));
                    }
                }
            }
            if spread == 0.0 {
                few = [few[0] + unsettled, few[1] + steps];
            }
            curve.push((boxes as f64, unsettled as f64 / steps as f64));
            let name = if boxes == 1 { "a box".to_owned() } else { format!("{boxes} boxes") };
            table.push([
                name.as_str().into(),
                ratio.into(),
                (steps as u64).into(),
                (unsettled as u64).into(),
                (systems as f64 / steps as f64).into(),
                0.0.into(),
                worst.into(),
            ]);
        }
        let name = match spread {
            0.0 => "equal masses".to_owned(),
            _ => format!("masses up to {ratio:.0e} apart"),
        };
        edge = edge.with(Series::new(&name, curve));
    }
    let slope = loglog_slope(&errors).unwrap_or(f64::NAN);
    Ok(Study {
        conclusion: "Moments up to a length times the normal impulse oppose rolling and spinning. A ball stops where \
                     the closed form says, to the order of the step. Boxes that rock on each other have moments and \
                     friction at every corner, more rows than freedoms: they are solved at once. In heaps of \
                     eight, most of all where masses differ much, some steps are not settled and say so."
            .to_owned(),
        table,
        charts: vec![precision.into(), edge.into()],
        claims: vec![
            Claim::number("order of the ball's way", "1", slope, (0.8, 1.2)),
            Claim::number(
                "part of the steps of boxes of one mass that are settled",
                "at least 0.98",
                1.0 - few[0] as f64 / few[1] as f64,
                (0.98, 1.0),
            ),
            Claim::number(
                "energy that a step gained, of what there was",
                "below 1e-9",
                gained,
                (f64::NEG_INFINITY, 1e-9),
            ),
        ],
        ..ROLLING_FRICTION.heading()
    })
}
