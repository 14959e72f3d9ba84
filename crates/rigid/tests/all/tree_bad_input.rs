//! What is no tree is refused, by the joint and its bodies.

use nalgebra::Vector3;
use stationary_integrators::{Integrator, StepError};
use stationary_rigid::tree::{
    Tree, TreeBuilder, TreeError, TreeField, TreeForces, TreeMotion, TreeVariational,
};
use stationary_rigid::{Body, JointFault, JointKind, LieGroup, RigidMotion};

const HERE: fn() -> [RigidMotion; 2] = || [RigidMotion::identity(); 2];
const HINGE: JointKind = JointKind::Hinge { axis: Vector3::new(0.0, 0.0, 1.0) };

fn body() -> Body {
    Body::solid_box(1.0, [0.1, 0.2, 0.3]).unwrap()
}

/// Two bodies, the second on the given joint.
fn second(parent: Option<usize>, joint: JointKind) -> Result<Tree, TreeError> {
    let mut builder = TreeBuilder::default();
    builder.hang(None, JointKind::Ball, HERE(), body());
    builder.hang(parent, joint, HERE(), body());
    builder.build()
}

#[test]
fn absent_parents_and_circles_are_refused_by_the_name_of_the_joint() {
    let absent = second(Some(5), HINGE).unwrap_err();
    assert!(matches!(absent, TreeError::NoSuchParent { bodies: 2, .. }));
    assert!(absent.to_string().starts_with("joint 1 (hinge, body 1 to body 5): "), "{absent}");
    let own = second(Some(1), HINGE).unwrap_err();
    assert!(matches!(own, TreeError::Circle { .. }), "{own}");
    let mut builder = TreeBuilder::default();
    builder.hang(Some(1), HINGE, HERE(), body());
    builder.hang(Some(0), HINGE, HERE(), body());
    let circle = builder.build().unwrap_err();
    assert!(matches!(circle, TreeError::Circle { joining } if joining.body == 0), "{circle}");
}

#[test]
fn axes_without_direction_and_parallel_axes_are_refused() {
    for axis in [Vector3::zeros(), Vector3::new(0.0, f64::NAN, 1.0), Vector3::x() * f64::INFINITY] {
        for joint in [
            JointKind::Hinge { axis },
            JointKind::Slider { axis },
            JointKind::Screw { axis, pitch: 1.0 },
            JointKind::Cylinder { axis },
            JointKind::Universal { axes: [Vector3::x(), axis] },
            JointKind::Planar { axes: [axis, Vector3::x()] },
        ] {
            let error = second(Some(0), joint).unwrap_err();
            let axisless = |fault| matches!(fault, JointFault::NoAxis(_));
            assert!(matches!(error, TreeError::Joint { fault, .. } if axisless(fault)), "{error}");
            assert!(error.to_string().contains(joint.name()), "{error}");
        }
    }
    let parallel = JointKind::Universal { axes: [Vector3::x(), Vector3::x() * -3.0] };
    let fault = |joint| match second(Some(0), joint) {
        Err(TreeError::Joint { fault, .. }) => fault,
        other => panic!("{other:?}"),
    };
    assert!(matches!(fault(parallel), JointFault::Parallel(_)));
    let screw = JointKind::Screw { axis: Vector3::x(), pitch: f64::NAN };
    assert!(matches!(fault(screw), JointFault::NotFinite { what: "the pitch", .. }));
    // By a rod, or on a curve, nothing hangs.
    for joint in [
        JointKind::Rod { length: 1.0 },
        JointKind::OnLine { axis: Vector3::x() },
        JointKind::OnCircle { axis: Vector3::x(), radius: 1.0 },
    ] {
        assert_eq!(fault(joint), JointFault::RowsOnly);
    }
    // An axis may have any length.
    let tiny = JointKind::Hinge { axis: Vector3::x() * 1e-300 };
    assert!(second(Some(0), tiny).is_ok());
}

#[test]
fn a_frame_that_is_not_finite_is_refused() {
    let mut builder = TreeBuilder::default();
    let nowhere = RigidMotion { translation: Vector3::x() * f64::NAN, ..RigidMotion::identity() };
    builder.hang(None, HINGE, [RigidMotion::identity(), nowhere], body());
    let error = builder.build().unwrap_err();
    let TreeError::Joint { fault, .. } = error else { panic!("{error}") };
    assert!(matches!(fault, JointFault::NotFinite { what: "the frame on the body", .. }));
}

#[test]
fn a_joint_that_moves_no_mass_is_refused_when_it_is_built_or_where_it_is_met() {
    let mut builder = TreeBuilder::default();
    builder.hang(None, HINGE, HERE(), body());
    builder.hang_frame(Some(0), HINGE, HERE());
    let error = builder.build().unwrap_err();
    assert!(matches!(error, TreeError::Massless { joining } if joining.body == 1), "{error}");
    // A frame that is welded on moves nothing.
    let mut builder = TreeBuilder::default();
    builder.hang(None, HINGE, HERE(), body());
    builder.hang_frame(Some(0), JointKind::Weld, HERE());
    assert!(builder.build().is_ok());
    // Two hinges in one line: the frame between them is turned by no force.
    let mut builder = TreeBuilder::default();
    builder.hang_frame(None, HINGE, HERE());
    builder.hang(Some(0), HINGE, HERE(), body());
    let tree = builder.build().unwrap();
    let none = TreeForces::none(&tree);
    let mut motion = TreeMotion::new(tree);
    motion.place(&[0.3, 0.8], &[0.0, 1.0]).unwrap();
    let error = motion.forward_dynamics(&none, &mut [0.0; 2]).unwrap_err();
    assert!(matches!(error, TreeError::Singular { joining, .. } if joining.body == 0), "{error}");
}

#[test]
fn sizes_and_numbers_that_do_not_fit_are_refused() {
    let tree = second(Some(0), HINGE).unwrap();
    assert_eq!((tree.bodies(), tree.coordinates(), tree.speeds()), (2, 5, 4));
    let none = TreeForces::none(&tree);
    let mut motion = TreeMotion::new(tree.clone());
    let q = tree.rest();
    assert!(matches!(motion.place(&q[1..], &[0.0; 4]), Err(TreeError::Size(_))));
    assert!(matches!(motion.place(&q, &[0.0; 3]), Err(TreeError::Size(_))));
    assert!(matches!(motion.place(&q, &[f64::NAN; 4]), Err(TreeError::NonFinite { .. })));
    assert!(matches!(motion.place(&[0.0; 5], &[0.0; 4]), Err(TreeError::Quaternion { .. })));
    assert!(matches!(motion.mass_matrix(&mut [0.0; 15]), Err(TreeError::Size(_))));
    assert!(matches!(motion.forward_dynamics(&none, &mut [0.0; 5]), Err(TreeError::Size(_))));
    assert!(matches!(motion.pose(2), Err(TreeError::NoSuchBody { body: 2, bodies: 2 })));
    let other = TreeForces::none(&TreeBuilder::default().build().unwrap());
    assert!(matches!(motion.forward_dynamics(&other, &mut [0.0; 4]), Err(TreeError::Size(_))));
    assert!(TreeField::new(tree.clone(), other).is_err());
    assert!(TreeForces::weight(&tree, Vector3::x() * f64::NAN).is_err());
    assert!(TreeVariational::new(tree, Vector3::x() * f64::NAN).is_err());
}

#[test]
fn a_step_that_cannot_be_taken_leaves_the_state() {
    let tree = second(Some(0), HINGE).unwrap();
    let mut method = TreeVariational::new(tree.clone(), Vector3::z() * -9.81).unwrap();
    let state = method.state(&tree.rest(), &[0.1, 0.2, -0.3, 0.4]).unwrap();
    let mut moved = state.clone();
    for h in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(method.step(&mut moved, h), Err(StepError::Step(_))));
    }
    // Several turns in one step.
    assert!(method.step(&mut moved, 60.0).is_err());
    assert_eq!(moved, state);
    moved.q[0] = 0.9;
    let stretched = method.step(&mut moved, 0.1);
    assert!(matches!(stretched, Err(StepError::Configuration { number: 0 })), "{stretched:?}");
}

#[test]
fn rates_are_written_whatever_stood_in_their_place() {
    let tree = second(Some(0), HINGE).unwrap();
    let (q, mut rates) = (tree.rest(), [f64::NAN; 5]);
    tree.rates(&q, &[0.1, 0.2, 0.3, 0.4], &mut rates).unwrap();
    assert_eq!(rates, [0.0, 0.05, 0.1, 0.15, 0.4]);
}
