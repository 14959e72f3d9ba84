//! Bad input, item by item: each is refused by a typed error that names it, and changes nothing.

use nalgebra::{Vector2, Vector3};
use stationary_calculus::{Covector, DiagonalMetric, Force, System, Vector};
use stationary_contact::{
    Collider, ContactError, Detector, MeshFilter, Planar, PlanarCollider, PlanarDetector,
    PlanarShape, PlanarWorld, Shape, SpatialWorld, World, problems::falling_boxes, push_apart,
};
use stationary_integrators::State;
use stationary_rigid::{LieGroup, PlanarMotion, PlanarWeight, Poses, RigidMotion, Weight};

type V = Vector3<f64>;

const BAD: [f64; 4] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e-9];
/// Two squares of 1 m, one upon the other.
const POSES: [f64; 6] = [0.0, 0.5, 0.0, 0.0, 1.5, 0.0];

fn squares(count: usize) -> Vec<PlanarCollider> {
    let square = PlanarShape::cuboid([0.5; 2]).unwrap();
    let floor = PlanarShape::half_plane(Vector2::y()).unwrap();
    let floor = PlanarCollider::fixed(PlanarMotion::identity(), floor);
    (0..count).map(|body| PlanarCollider::on_body(body, square.clone())).chain([floor]).collect()
}

fn detector(count: usize) -> PlanarDetector {
    PlanarDetector::new(squares(count), count).unwrap()
}

fn system(count: usize) -> System<DiagonalMetric<Vec<f64>>, PlanarWeight> {
    let metric = DiagonalMetric::new([1.0, 1.0, 0.2].repeat(count)).unwrap();
    System::new(metric, PlanarWeight { gravity: -Vector2::y(), masses: vec![1.0; count] }).unwrap()
}

fn planar() -> PlanarWorld<PlanarWeight> {
    World::new(system(2), detector(2)).unwrap()
}

fn spatial() -> (SpatialWorld<Weight<Poses>>, State<Vec<f64>>) {
    let boxes = falling_boxes(2).unwrap();
    let detector = boxes.detector().unwrap();
    (World::new(boxes.system, detector).unwrap(), boxes.state)
}

#[test]
fn margins_that_are_negative_or_no_numbers_are_refused() {
    let (mut world, state) = spatial();
    for bad in BAD {
        let refused = detector(2).detect(&POSES, bad).unwrap_err();
        assert!(matches!(refused, ContactError::Margin(_)), "{refused}");
        let refused = world.detector().detect(&state.q, bad).unwrap_err();
        assert!(matches!(refused, ContactError::Margin(_)), "{refused}");
    }
}

#[test]
fn a_detector_of_fewer_bodies_than_the_system_is_refused() {
    let refused = World::new(system(2), detector(1)).unwrap_err();
    assert!(matches!(refused, ContactError::Size(_)), "{refused}");
    let mut q = POSES.to_vec();
    let refused = push_apart::<Planar, _>(&system(2), &mut detector(1), &mut q, 1e-6).unwrap_err();
    assert!(matches!(refused, ContactError::Size(_)) && q == POSES, "{refused}");
}

#[test]
fn states_that_are_too_short_are_refused_and_stay() {
    let (mut world, full) = spatial();
    for [q, p] in [[1, 0], [0, 1], [7, 6], [14, 0], [0, 12]] {
        let mut state = full.clone();
        state.q.truncate(full.q.len() - q);
        state.p.0.truncate(full.p.0.len() - p);
        let start = state.clone();
        let refused = world.step(&mut state, 1e-3).unwrap_err();
        assert!(matches!(refused, ContactError::Size(_)) && state == start, "{refused}");
    }
    let mut state = State::new(POSES[..5].to_vec(), Covector(vec![0.0; 6]));
    let refused = planar().step(&mut state, 1e-3).unwrap_err();
    assert!(matches!(refused, ContactError::Size(_)), "{refused}");
    let refused = detector(2).detect(&POSES[..3], 0.1).unwrap_err();
    assert!(matches!(refused, ContactError::Size(_)), "{refused}");
}

#[test]
fn the_radius_of_a_body_that_is_absent_is_refused() {
    assert!((detector(2).radius(1).unwrap() - 0.5_f64.sqrt()).abs() < 1e-12);
    for body in [2, 9, usize::MAX] {
        let refused = detector(2).radius(body).unwrap_err();
        assert!(matches!(refused, ContactError::Size(_)), "{refused}");
    }
}

#[test]
fn places_and_momenta_that_are_no_numbers_are_refused_and_stay() {
    for bad in [f64::NAN, f64::INFINITY] {
        let (mut world, full) = spatial();
        for at in 0..full.q.len() {
            let mut state = full.clone();
            state.q[at] = bad;
            world.step(&mut state, 1e-3).unwrap_err();
            assert!(state.q[at].to_bits() == bad.to_bits() && state.p == full.p, "{at}");
        }
        for at in 0..full.p.0.len() {
            let mut state = full.clone();
            state.p.0[at] = bad;
            let refused = world.step(&mut state, 1e-3).unwrap_err();
            assert!(matches!(refused, ContactError::NonFinite { .. }), "{refused}");
            assert_eq!(state.q, full.q);
        }
        for at in 0..POSES.len() {
            let mut state = State::new(POSES.to_vec(), Covector(vec![0.0; 6]));
            state.q[at] = bad;
            let refused = planar().step(&mut state, 1e-3).unwrap_err();
            assert!(matches!(refused, ContactError::NonFinite { .. }), "{refused}");
        }
    }
}

#[test]
fn tolerances_and_limits_of_settling_that_are_negative_or_no_numbers_are_refused() {
    for bad in BAD {
        let refused = planar().with_tolerance(bad).unwrap_err();
        assert!(matches!(refused, ContactError::Settling(_)), "{refused}");
    }
    for bad in [f64::NAN, -1e-9] {
        let refused = planar().with_residual_limit(bad).unwrap_err();
        assert!(matches!(refused, ContactError::Settling(_)), "{refused}");
    }
}

#[test]
fn half_spaces_that_a_body_carries_against_others_are_refused() {
    let plane = || PlanarShape::half_plane(Vector2::y()).unwrap();
    let fixed = PlanarCollider::fixed(PlanarMotion::identity(), plane());
    let refused = PlanarDetector::new(vec![PlanarCollider::on_body(0, plane()), fixed], 1);
    assert!(matches!(refused, Err(ContactError::NoQuery { .. })));
    let plane = || Shape::half_space(Vector3::z()).unwrap();
    let fixed = || Collider::fixed(RigidMotion::identity(), plane());
    let refused = Detector::new(vec![Collider::on_body(0, plane()), fixed()], 1);
    assert!(matches!(refused, Err(ContactError::NoQuery { .. })));
    // Two that stay where they are never meet.
    Detector::new(vec![fixed(), fixed()], 0).unwrap();
}

#[test]
fn restitutions_outside_zero_to_one_and_frictions_that_are_none_are_refused() {
    let with = |restitution: f64, friction: f64| {
        let ball = Collider::on_body(0, Shape::ball(1.0).unwrap());
        Detector::new(vec![ball.with_restitution(restitution).with_friction(friction)], 1)
    };
    for bad in BAD.into_iter().chain([1.0 + 1e-12]) {
        let refused = with(bad, 0.5).unwrap_err();
        assert!(matches!(refused, ContactError::Restitution { .. }), "{refused}");
        let refused = detector(2).with_pair([0, 1], bad, 0.5).unwrap_err();
        assert!(matches!(refused, ContactError::Restitution { .. }), "{refused}");
    }
    for bad in BAD {
        let refused = with(0.5, bad).unwrap_err();
        assert!(matches!(refused, ContactError::Friction { .. }), "{refused}");
        let refused = detector(2).with_pair([0, 1], 0.5, bad).unwrap_err();
        assert!(matches!(refused, ContactError::Friction { .. }), "{refused}");
    }
    with(1.0, 3.0).unwrap();
}

#[test]
fn a_filter_that_starts_at_distance_0_or_gets_a_step_that_is_none_is_refused() {
    let filter = MeshFilter::new(vec![1.0; 4], vec![false; 4], vec![[1, 2, 3]], 1e-9).unwrap();
    let at = |height: f64| [0.2, 0.2, height, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut v = [0.0; 12];
    v[2] = -2.0;
    let before = v;
    let refused = filter.filter(&at(0.0), 0.1, Vector(&mut v)).unwrap_err();
    assert!(matches!(refused, ContactError::Touching { vertices: [0, 1, 2, 3] }), "{refused}");
    for h in BAD.into_iter().chain([0.0]) {
        let refused = filter.filter(&at(0.1), h, Vector(&mut v)).unwrap_err();
        assert!(matches!(refused, ContactError::Step(_)), "{refused}");
    }
    assert_eq!(v, before);
}

/// A force on more or fewer freedoms than there are.
struct Pull(usize);

impl Force for Pull {
    fn dim(&self) -> usize {
        self.0
    }

    fn add_force(&self, _: f64, _: &[f64], _: Vector<&[f64]>, f: Covector<&mut [f64]>) {
        f.0[..self.0].iter_mut().for_each(|f| *f += 1.0);
    }
}

#[test]
fn forces_of_another_number_of_freedoms_are_refused_and_the_state_stays() {
    let mut world = planar();
    let mut state = State::new(POSES.to_vec(), Covector(vec![0.0; 6]));
    let start = state.clone();
    for freedoms in [3, 7] {
        let refused = world.step_under(&mut state, 1e-3, &(), &Pull(freedoms)).unwrap_err();
        assert!(matches!(refused, ContactError::Size(_)), "{refused}");
        assert_eq!(state, start);
    }
    world.step_under(&mut state, 1e-3, &(), &Pull(6)).unwrap();
}

#[test]
fn two_meshes_that_come_near_are_refused() {
    let corners = [V::zeros(), V::x(), V::y()];
    let mesh = || Shape::mesh(&corners, &[[0, 1, 2]]).unwrap();
    let fixed = Collider::fixed(RigidMotion::identity(), mesh());
    let mut detector = Detector::new(vec![Collider::on_body(0, mesh()), fixed], 1).unwrap();
    let at = |height: f64| [0.0, 0.0, height, 1.0, 0.0, 0.0, 0.0];
    let refused = detector.closest_points(&at(0.1), [0, 1]).unwrap_err();
    assert!(matches!(refused, ContactError::NoQuery { .. }), "{refused}");
    let refused = detector.detect(&at(0.1), 0.2).unwrap_err();
    assert!(matches!(refused, ContactError::NoQuery { .. }), "{refused}");
    assert!(detector.detect(&at(10.0), 0.2).unwrap().is_empty());
}
