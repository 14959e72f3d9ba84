//! Every kind of joint of the plane under every stepper, from one start: RATTLE, composed, adaptive and a world's rows
//! against one reference of order 8, and that against a tree of space whose joints keep it in a plane.

use nalgebra::{Vector2, Vector3};
use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_constraints::{
    Adaptive, Composed, ConstrainedIntegrator, Rattle, Redundancy, SparseDiagonal, StepTolerance,
};
use stationary_contact::{Kept, PlanarDetector, PlanarWorld};
use stationary_integrators::{AdaptiveMethod, DormandPrince853, Moment, Scheme, State, Tolerance};
use stationary_rigid::tree::{Tree, TreeBuilder, TreeField, TreeForces, TreeLoops, TreeMotion};
use stationary_rigid::{
    Body, JointEnd, JointKind, LieGroup, PlanarEnd, PlanarJoint, PlanarJointKind, PlanarMotion,
    PlanarRotation, PlanarWeight, RigidMotion, Rotation,
};

use crate::apart::{off, order};

type Stored = State<Vec<f64>>;

const AXIS: Vector2<f64> = Vector2::new(0.6, 0.8);
const RADIUS: f64 = 0.4;
const LENGTH: f64 = 0.7;
const KINDS: [PlanarJointKind; 6] = [
    PlanarJointKind::Pin,
    PlanarJointKind::Weld,
    PlanarJointKind::Slider { axis: AXIS },
    PlanarJointKind::PinInSlot { axis: AXIS },
    PlanarJointKind::Rod { length: LENGTH },
    PlanarJointKind::Rolling { axis: AXIS, radius: RADIUS },
];
const GRAVITY: Vector2<f64> = Vector2::new(0.0, -9.81);
const TIME: f64 = 0.4;
const MASS: f64 = 1.5;
/// Where the first body is pinned to the origin, and how it stands.
const ARM: Vector2<f64> = Vector2::new(0.1, 0.5);
const TURNED: f64 = 0.7;
/// Where the joint is on either body, and how it is turned there.
const POINTS: [(Vector2<f64>, f64); 2] =
    [(Vector2::new(-0.3, -0.4), 0.5), (Vector2::new(0.2, 0.6), -0.4)];

fn body() -> Body {
    Body::solid_box(MASS, [0.2, 0.3, 0.4]).unwrap()
}

fn ends() -> [PlanarEnd; 2] {
    [0, 1].map(|body| PlanarEnd::on(body, POINTS[body].0).turned(POINTS[body].1))
}

/// A motion of the plane by its angle and shift.
fn motion(angle: f64, translation: Vector2<f64>) -> PlanarMotion {
    PlanarMotion { translation, rotation: PlanarRotation::exp(angle) }
}

/// The angle and place of the second frame as seen from the first, where the joint is closed.
fn apart(kind: PlanarJointKind) -> (f64, Vector2<f64>) {
    let across = Vector2::new(-AXIS.y, AXIS.x);
    match kind {
        PlanarJointKind::Pin => (0.5, Vector2::zeros()),
        PlanarJointKind::Weld => (0.0, Vector2::zeros()),
        PlanarJointKind::Slider { .. } => (0.0, AXIS * 0.4),
        PlanarJointKind::PinInSlot { .. } => (0.5, AXIS * 0.4),
        PlanarJointKind::Rod { .. } => (0.5, Vector2::new(LENGTH, 0.0)),
        PlanarJointKind::Rolling { .. } => (-0.4 / RADIUS, across * RADIUS + AXIS * 0.4),
    }
}

/// Both bodies at rest with both joints closed.
fn start(kind: PlanarJointKind) -> Stored {
    let first = motion(TURNED, -PlanarRotation::exp(TURNED).rotate(&ARM));
    let (angle, place) = apart(kind);
    let frame = |end: PlanarEnd| motion(end.angle, end.point);
    let [on, to] = ends();
    let second = first.compose(&frame(on)).compose(&motion(angle, place));
    let second = second.compose(&frame(to).inverse());
    let turned = TURNED + on.angle + angle - to.angle;
    let (a, b) = (first.translation, second.translation);
    State::new(vec![a.x, a.y, TURNED, b.x, b.y, turned], Covector(vec![0.0; 6]))
}

fn system() -> System<DiagonalMetric<Vec<f64>>, PlanarWeight> {
    let moment = body().moments().z;
    let metric = DiagonalMetric::new([MASS, MASS, moment].repeat(2)).unwrap();
    System::new(metric, PlanarWeight { gravity: GRAVITY, masses: vec![MASS; 2] }).unwrap()
}

fn joints(kind: PlanarJointKind) -> Vec<PlanarJoint> {
    let pin = [PlanarEnd::world(Vector2::zeros()), PlanarEnd::on(0, ARM)];
    [(PlanarJointKind::Pin, pin), (kind, ends())]
        .map(|(kind, ends)| PlanarJoint::new(2, kind, ends).unwrap())
        .into()
}

/// The places after equal steps.
fn stepped(start: &Stored, steps: u32, mut step: impl FnMut(&mut Stored, f64)) -> Vec<f64> {
    let mut state = start.clone();
    (0..steps).for_each(|_| step(&mut state, TIME / f64::from(steps)));
    state.q
}

fn raised(point: Vector2<f64>, angle: f64) -> RigidMotion {
    let rotation = Rotation::exp(Vector3::z() * angle);
    RigidMotion { translation: point.push(0.0), rotation }
}

/// The same two bodies in space as a tree with its coordinates: the second hangs by the same joint, or it is free and a
/// row holds it, where nothing pushes it out of the plane.
fn in_space(kind: PlanarJointKind) -> Option<(Tree, Option<TreeLoops>, Vec<f64>)> {
    let hinge = JointKind::Hinge { axis: Vector3::z() };
    let (angle, place) = apart(kind);
    let (hung, row) = match kind {
        PlanarJointKind::Pin => (Some((hinge, vec![angle])), None),
        PlanarJointKind::Weld => (Some((JointKind::Weld, vec![])), None),
        PlanarJointKind::Slider { axis } => {
            (Some((JointKind::Slider { axis: axis.push(0.0) }, vec![place.dot(&axis)])), None)
        }
        PlanarJointKind::PinInSlot { axis } => {
            (None, Some(JointKind::OnLine { axis: axis.push(0.0) }))
        }
        PlanarJointKind::Rod { length } => (None, Some(JointKind::Rod { length })),
        PlanarJointKind::Rolling { .. } => return None,
    };
    let frames = ends().map(|end| raised(end.point, end.angle));
    let mut builder = TreeBuilder::default();
    builder.hang(None, hinge, [RigidMotion::identity(), raised(ARM, 0.0)], body());
    let own = match hung {
        Some((kind, own)) => {
            builder.hang(Some(0), kind, frames, body());
            own
        }
        None => {
            builder.hang(None, JointKind::Free, [RigidMotion::identity(); 2], body());
            let [.., x, y, turned] = start(kind).q[..] else { unreachable!("two bodies") };
            let RigidMotion { translation, rotation } = raised(Vector2::new(x, y), turned);
            [translation.as_slice(), &rotation.quaternion()].concat()
        }
    };
    let tree = builder.build().unwrap();
    let loops = row.map(|row| {
        let mut loops = TreeLoops::new(&tree);
        let ends = [0, 1].map(|body| JointEnd { body: Some(body), frame: frames[body] });
        loops.join(&tree, row, ends).unwrap();
        loops
    });
    Some((tree, loops, [vec![TURNED], own].concat()))
}

/// The centre and first axis of each body of the plane.
fn places(q: &[f64]) -> Vec<f64> {
    let one = |q: &[f64]| [q[0], q[1], q[2].cos(), q[2].sin()];
    q.chunks_exact(3).flat_map(one).collect()
}

/// The same of the tree, and how far it is out of the plane, after the time.
fn moved_in_space(tree: Tree, loops: Option<TreeLoops>, q: &[f64]) -> (Vec<f64>, f64) {
    let weight = TreeForces::weight(&tree, GRAVITY.push(0.0)).unwrap();
    let mut field = TreeField::new(tree.clone(), weight).unwrap();
    if let Some(loops) = loops {
        field = field.closed(loops);
    }
    let tolerance = Tolerance::new(1e-12, 1e-12).unwrap();
    let begin = Moment::new(0.0, [q, &vec![0.0; tree.speeds()]].concat());
    let mut method = DormandPrince853::new(field, tolerance.into(), begin).unwrap();
    while method.moment().t < TIME {
        method.step(TIME).unwrap();
    }
    let mut motion = TreeMotion::new(tree.clone());
    motion.place(&method.moment().y[..q.len()], &vec![0.0; tree.speeds()]).unwrap();
    let poses = [0, 1].map(|body| motion.pose(body).unwrap());
    let axes = poses.map(|pose| pose.rotation.normalized().rotate(&Vector3::x()));
    let out =
        poses.iter().zip(&axes).map(|(pose, axis)| pose.translation.z.abs().max(axis.z.abs()));
    let of = |(pose, axis): (&RigidMotion, &Vector3<f64>)| {
        [pose.translation.x, pose.translation.y, axis.x, axis.y]
    };
    (poses.iter().zip(&axes).flat_map(of).collect(), out.fold(0.0, f64::max))
}

#[test]
fn every_kind_of_joint_of_the_plane_moves_alike_under_every_stepper() {
    let system = system();
    let choice = SparseDiagonal(Redundancy::Refuse);
    for kind in KINDS {
        let (start, joints, name) = (start(kind), joints(kind), kind.name());
        let rattle = || Rattle::new(&system, &joints, &start, choice).unwrap();
        let composed = |scheme| Composed::new(rattle(), scheme, &start).unwrap();
        let mut eighth = composed(Scheme::KahanLi8);
        let truth = stepped(&start, 40, |state, h| _ = eighth.step(state, h).unwrap());
        assert!(off(&truth, &start.q) > 0.1, "{name}: it has not moved");
        if let Some((tree, loops, q)) = in_space(kind) {
            let (space, out) = moved_in_space(tree, loops, &q);
            let apart = off(&space, &places(&truth));
            assert!(
                apart < 1e-8 && out < 1e-9,
                "{name}: {apart:e} from space, {out:e} out of the plane"
            );
        }

        let second = order(
            |steps| {
                let mut method = rattle();
                off(&stepped(&start, steps, |state, h| _ = method.step(state, h).unwrap()), &truth)
            },
            100,
        );
        assert!((second - 2.0).abs() < 0.1, "{name}: RATTLE of order {second}");

        let fourth = order(
            |steps| {
                let mut method = composed(Scheme::Suzuki4);
                off(&stepped(&start, steps, |state, h| _ = method.step(state, h).unwrap()), &truth)
            },
            20,
        );
        assert!((fourth - 4.0).abs() < 0.4, "{name}: composed of order {fourth}");

        let tolerance = StepTolerance { absolute: 1e-10, relative: 0.0 };
        let mut own = Adaptive::new(composed(Scheme::Suzuki4), tolerance, 0.01, &start).unwrap();
        let mut state = start.clone();
        while state.t < TIME {
            own.advance(&mut state, TIME).unwrap();
        }
        let adaptive = off(&state.q, &truth);
        assert!(adaptive < 1e-7, "{name}: adaptive off by {adaptive:e}");

        let first = order(
            |steps| {
                let detector = PlanarDetector::new(Vec::new(), 2).unwrap();
                let mut world = PlanarWorld::new(self::system(), detector).unwrap();
                let kept = Kept(&joints);
                let step = |state: &mut Stored, h| _ = world.step_with(state, h, &kept).unwrap();
                off(&stepped(&start, steps, step), &truth)
            },
            400,
        );
        assert!((first - 1.0).abs() < 0.15, "{name}: a world's rows of order {first}");
    }
}
