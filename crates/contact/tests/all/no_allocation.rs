//! A step takes no memory once as many contacts have been met: counted by an allocator.

use allocation_counter::measure;
use nalgebra::Vector3;
use stationary_contact::problems::{Boxes, falling_boxes};
use stationary_contact::{
    Collider, Detector, EventDriven, EventDrivenReport, FlightOrder, Shape, Spatial, SpatialWorld,
};
use stationary_integrators::State;
use stationary_rigid::{LieGroup, RigidMotion, Rotation};

/// Boxes on a floor that is a box: the geometry library makes a list for each box on a half-space.
fn detector(count: usize) -> Detector {
    detector_with(count, 0.0)
}

fn detector_with(count: usize, restitution: f64) -> Detector {
    let cube = Shape::cuboid([0.5; 3]).unwrap();
    let on_body = |body| {
        let cube = Collider::on_body(body, cube.clone()).with_friction(0.5);
        cube.with_restitution(restitution)
    };
    let mut colliders: Vec<_> = (0..count).map(on_body).collect();
    let below = RigidMotion { translation: -Vector3::z(), rotation: Rotation::identity() };
    let floor = Collider::fixed(below, Shape::cuboid([50.0, 50.0, 1.0]).unwrap());
    colliders.push(floor.with_friction(0.5));
    Detector::new(colliders, count).unwrap()
}

/// Allocations in the last of the steps and contacts relaxed there, the second time that they are
/// taken.
fn allocations(boxes: &Boxes, steps: usize, last: usize) -> (u64, usize) {
    let detector = detector(boxes.starts.len());
    let mut bodies = SpatialWorld::new(boxes.system.clone(), detector).unwrap();
    let run = |bodies: &mut SpatialWorld<_>, state: &mut State<Vec<f64>>, steps: usize| {
        (0..steps).map(|_| bodies.step(state, 2e-3).unwrap().relaxed).sum::<usize>()
    };
    run(&mut bodies, &mut boxes.state.clone(), steps);
    let mut again = boxes.state.clone();
    run(&mut bodies, &mut again, steps - last);
    let mut visits = 0;
    let used = measure(|| visits = run(&mut bodies, &mut again, last)).count_total;
    (used, visits)
}

#[test]
fn sweeps_take_no_memory_once_as_many_contacts_have_been_met() {
    let boxes = falling_boxes(8).unwrap();
    let (used, visits) = allocations(&boxes, 300, 40);
    assert!(used == 0 && visits > 0, "{used} {visits}");
    // And at rest.
    assert_eq!(allocations(&boxes, 500, 40), (0, 0));
}

/// Boxes that fall onto a floor, bounce and come to rest, by impacts at their instant; how many allocations the
/// second time takes from a moment on, and what it did.
fn event_driven(restitution: f64, steps: usize, last: usize) -> (u64, EventDrivenReport) {
    let boxes = falling_boxes(2).unwrap();
    let mut bodies = EventDriven::<Spatial, _>::new(
        boxes.system.clone(),
        detector_with(2, restitution),
        FlightOrder::Second,
        2e-3,
    )
    .unwrap();
    let mut run = |state: &mut State<Vec<f64>>, steps: usize| {
        let mut all = EventDrivenReport::default();
        for _ in 0..steps {
            let report = bodies.step(state, 1e-2).unwrap();
            all.impacts += report.impacts;
            all.flights += report.flights;
            all.contact_steps += report.contact_steps;
        }
        all
    };
    run(&mut boxes.state.clone(), steps);
    let mut again = boxes.state.clone();
    run(&mut again, steps - last);
    let mut done = EventDrivenReport::default();
    let used = measure(|| done = run(&mut again, last)).count_total;
    (used, done)
}

#[test]
fn flights_between_impacts_and_rest_after_them_take_no_memory() {
    let (used, done) = event_driven(0.5, 400, 20);
    assert!(done.contact_steps > 0 && done.impacts == 0, "{done:?}");
    assert_eq!(used, 0, "at rest: {done:?}");
    let (used, done) = event_driven(0.5, 20, 15);
    assert!(done.flights == 15 && done.impacts == 0, "{done:?}");
    assert_eq!(used, 0, "in flight: {done:?}");
}
