//! Every kind of joint under every stepper: RATTLE, composed, adaptive, a world's rows, a tree by adaptive
//! methods and by its variational step, all from one start and against one reference of order 8.

use nalgebra::Vector3;
use stationary_calculus::{Covector, System};
use stationary_constraints::{
    Adaptive, Composed, ConstrainedIntegrator, Rattle, Redundancy, SparseDiagonal, StepTolerance,
};
use stationary_contact::{Detector, Kept, SpatialWorld};
use stationary_integrators::{
    AdaptiveMethod, DormandPrince853, Integrator, Moment, Scheme, State, Tolerance,
};
use stationary_rigid::tree::{
    Tree, TreeBuilder, TreeError, TreeField, TreeForces, TreeLoops, TreeMotion, TreeVariational,
};
use stationary_rigid::{
    Body, BodyMetric, BodySpace, ConstantVelocity, ExactRotation, FreeBodies, Joint, JointEnd,
    JointFault, JointKind, LieGroup, PointMass, Poses, RigidMotion, Rotation, Weight,
};

use crate::apart::{off, order};

type V = Vector3<f64>;
type Joints = Vec<Joint<Poses>>;
type Stored = State<Vec<f64>>;

const A: V = V::new(0.6, 0.0, 0.8);
const B: V = V::new(0.3, 1.0, -0.2);
const KINDS: [JointKind; 12] = [
    JointKind::Weld,
    JointKind::Hinge { axis: A },
    JointKind::Slider { axis: A },
    JointKind::Screw { axis: A, pitch: 0.3 },
    JointKind::Cylinder { axis: A },
    JointKind::Universal { axes: [A, B] },
    JointKind::Planar { axes: [A, B] },
    JointKind::Ball,
    JointKind::Free,
    JointKind::Rod { length: 0.7 },
    JointKind::OnLine { axis: A },
    JointKind::OnCircle { axis: A, radius: 0.4 },
];
const GRAVITY: V = V::new(0.0, 0.0, -9.81);
const TIME: f64 = 0.4;
const ARM: V = V::new(0.1, -0.2, 0.5);

fn body() -> Body {
    Body::solid_box(1.5, [0.2, 0.3, 0.4]).unwrap()
}

/// The ends of the second joint; the first is a ball that holds body 0 to the world's origin.
fn ends() -> [JointEnd; 2] {
    let first = JointEnd::on(0, V::new(0.1, 0.4, -0.3)).turned(Rotation::exp(B));
    [first, JointEnd::on(1, V::new(-0.2, 0.3, 0.6)).turned(Rotation::exp(-A))]
}

/// Where the second frame of what is told by rows alone stands, as seen from the first.
fn apart(kind: JointKind) -> RigidMotion {
    let translation = match kind {
        JointKind::Rod { length } => B.normalize() * length,
        JointKind::OnLine { axis } => axis * 0.3,
        JointKind::OnCircle { axis, radius } => axis.cross(&B).normalize() * radius,
        _ => V::zeros(),
    };
    RigidMotion { translation, rotation: Rotation::exp(V::new(0.5, -0.2, 0.1)) }
}

/// What stands with the second joint closed, at rest: as a tree that hangs by joints, or is closed by loops.
struct Hung {
    tree: Tree,
    loops: Option<TreeLoops>,
    q: Vec<f64>,
    start: Stored,
}

fn hung(kind: JointKind) -> Hung {
    let first = Rotation::exp(V::new(0.3, -0.2, 0.4));
    let pose = RigidMotion { translation: -first.rotate(&ARM), rotation: first };
    let [on, to] = ends().map(|end| end.frame);
    let at_arm = RigidMotion { translation: ARM, rotation: Rotation::identity() };
    let mut builder = TreeBuilder::default();
    builder.hang(None, JointKind::Ball, [RigidMotion::identity(), at_arm], body());
    let rows_only = kind.freedoms() > 3 && kind != JointKind::Free;
    let mut q = first.quaternion().to_vec();
    if rows_only {
        builder.hang(None, JointKind::Free, [RigidMotion::identity(); 2], body());
        let other = pose.compose(&on).compose(&apart(kind)).compose(&to.inverse());
        q.extend_from_slice(other.translation.as_slice());
        q.extend(other.rotation.quaternion());
    } else {
        builder.hang(Some(0), kind, [on, to], body());
        match kind {
            JointKind::Ball => q.extend(Rotation::exp(B).quaternion()),
            JointKind::Free => {
                q.extend([0.2, -0.1, 0.3]);
                q.extend(Rotation::exp(B).quaternion());
            }
            _ => q.extend([0.4, 0.2, -0.3].iter().take(kind.freedoms())),
        }
    }
    let tree = builder.build().unwrap();
    let loops = rows_only.then(|| {
        let mut loops = TreeLoops::new(&tree);
        loops.join(&tree, kind, ends()).unwrap();
        loops
    });
    let mut motion = TreeMotion::new(tree.clone());
    motion.place(&q, &vec![0.0; tree.speeds()]).unwrap();
    let motions = [0, 1].map(|body| motion.body(body).unwrap());
    let start = BodyMetric::<Poses>::new(vec![body(); 2]).state(&motions).unwrap();
    Hung { tree, loops, q, start }
}

fn system() -> System<BodyMetric<Poses>, Weight<Poses>, Poses> {
    let masses = vec![PointMass { mass: body().mass(), point: V::zeros() }; 2];
    let weight = Weight { gravity: GRAVITY, masses, space: Poses };
    BodyMetric::new(vec![body(); 2]).under(weight).unwrap()
}

fn joints(kind: JointKind) -> Joints {
    let ball = [JointEnd::world(V::zeros()), JointEnd::on(0, ARM)];
    [(JointKind::Ball, ball), (kind, ends())]
        .map(|(kind, ends)| Joint::new(Poses, 2, kind, ends).unwrap())
        .into()
}

/// Both centres, and both bodies' axes.
fn places(q: &[f64]) -> Vec<f64> {
    let one = |body| {
        let RigidMotion { translation, rotation } = Poses::pose_at(q, body);
        let rotation = rotation.normalized();
        [translation, rotation.rotate(&V::x()), rotation.rotate(&V::y())]
    };
    [one(0), one(1)].concat().iter().flat_map(|v| [v.x, v.y, v.z]).collect()
}

/// The places after equal steps.
fn stepped(start: &Stored, steps: u32, mut step: impl FnMut(&mut Stored, f64)) -> Vec<f64> {
    let mut state = start.clone();
    (0..steps).for_each(|_| step(&mut state, TIME / f64::from(steps)));
    places(&state.q)
}

fn tree_places(tree: &Tree, q: &[f64]) -> Vec<f64> {
    let mut motion = TreeMotion::new(tree.clone());
    motion.place(q, &vec![0.0; tree.speeds()]).unwrap();
    let pose = |body| {
        let RigidMotion { translation, rotation } = motion.pose(body).unwrap();
        [translation.as_slice(), &rotation.quaternion()].concat()
    };
    places(&[pose(0), pose(1)].concat())
}

#[test]
fn every_kind_of_joint_moves_alike_under_every_stepper() {
    let system = system();
    let choice = SparseDiagonal(Redundancy::Refuse);
    for kind in KINDS {
        let (Hung { tree, loops, q, start }, joints) = (hung(kind), joints(kind));
        let name = joints[1].name();
        let exact =
            || Rattle::along(FreeBodies(ExactRotation), &system, &joints, &start, choice).unwrap();
        let composed = |scheme| Composed::new(exact(), scheme, &start).unwrap();
        let mut eighth = composed(Scheme::KahanLi8);
        let truth = stepped(&start, 40, |state, h| _ = eighth.step(state, h).unwrap());
        assert!(off(&truth, &places(&start.q)) > 0.1, "{name}: it has not moved");

        let rattle = |steps| {
            let free = FreeBodies(ConstantVelocity);
            let mut rattle = Rattle::along(free, &system, &joints, &start, choice).unwrap();
            stepped(&start, steps, |state, h| _ = rattle.step(state, h).unwrap())
        };
        let second = order(|steps| off(&rattle(steps), &truth), 100);
        assert!((second - 2.0).abs() < 0.1, "{name}: RATTLE of order {second}");

        let fourth = order(
            |steps| {
                let mut method = composed(Scheme::Suzuki4);
                let found = stepped(&start, steps, |state, h| _ = method.step(state, h).unwrap());
                off(&found, &truth)
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
        let adaptive = off(&places(&state.q), &truth);
        assert!(adaptive < 1e-7, "{name}: adaptive off by {adaptive:e}");

        let first = order(
            |steps| {
                let detector = Detector::new(Vec::new(), 2).unwrap();
                let mut world = SpatialWorld::new(self::system(), detector).unwrap();
                let kept = Kept(&joints);
                let found = stepped(&start, steps, |state, h| {
                    _ = world.step_with(state, h, &kept).unwrap();
                });
                off(&found, &truth)
            },
            400,
        );
        assert!((first - 1.0).abs() < 0.15, "{name}: a world's rows of order {first}");

        let weight = TreeForces::weight(&tree, GRAVITY).unwrap();
        let mut field = TreeField::new(tree.clone(), weight).unwrap();
        let closed = loops.is_some();
        if let Some(loops) = loops.clone() {
            field = field.closed(loops);
        }
        let rest = vec![0.0; tree.speeds()];
        let tolerance = Tolerance::new(1e-12, 1e-12).unwrap();
        let begin = Moment::new(0.0, [&q[..], &rest].concat());
        let mut method = DormandPrince853::new(field, tolerance.into(), begin).unwrap();
        while method.moment().t < TIME {
            method.step(TIME).unwrap();
        }
        let reduced = off(&tree_places(&tree, &method.moment().y[..q.len()]), &truth);
        assert!(reduced < 1e-8, "{name}: a tree by the adaptive method off by {reduced:e}");

        // A joint of rows alone closes a loop: a tree does not hang by it.
        if closed {
            let mut builder = TreeBuilder::default();
            builder.hang(None, kind, ends().map(|end| end.frame), body());
            let error = builder.build().unwrap_err();
            assert!(
                matches!(error, TreeError::Joint { fault: JointFault::RowsOnly, .. }),
                "{name}: {error}"
            );
        }
        let mut method = TreeVariational::new(tree.clone(), GRAVITY).unwrap();
        if let Some(loops) = loops {
            method = method.closed(loops).unwrap();
        }
        let mut state = method.state(&q, &rest).unwrap();
        for _ in 0..100 {
            method.step(&mut state, TIME / 100.0).unwrap();
        }
        let apart = off(&tree_places(&tree, &state.q), &rattle(100));
        assert!(apart < 1e-9, "{name}: the tree's variational step is {apart:e} from RATTLE's");
    }
}

#[test]
fn a_state_that_a_joint_does_not_allow_is_refused_by_rattle_for_every_kind() {
    let system = system();
    for kind in KINDS.into_iter().filter(|kind| *kind != JointKind::Free) {
        let joints = joints(kind);
        let mut start = hung(kind).start;
        let mut p = start.p.0.clone();
        (6..12).for_each(|k| p[k] = 0.3 + 0.1 * k as f64);
        start.p = Covector(p);
        let free = FreeBodies(ConstantVelocity);
        let choice = SparseDiagonal(Redundancy::Refuse);
        let error = Rattle::along(free, &system, &joints, &start, choice).unwrap_err();
        assert!(error.to_string().starts_with("the velocity violates equation"), "{error}");
    }
}
