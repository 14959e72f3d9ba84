//! A step takes no memory once as many contacts have been met: counted by an allocator.

use allocation_counter::measure;
use nalgebra::Vector3;
use stationary_contact::problems::{Boxes, columns_of_boxes, falling_boxes};
use stationary_contact::{
    Collider, Detector, ErrorControlled, EventDriven, FlightOrder, Shape, Spatial, SpatialWorld,
};
use stationary_integrators::State;
use stationary_rigid::{LieGroup, RigidMotion, Rotation};

use crate::jointed_space::hung_chain;

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
    allocations_of(detector(boxes.starts.len()), boxes, steps, last)
}

fn allocations_of(detector: Detector, boxes: &Boxes, steps: usize, last: usize) -> (u64, usize) {
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

/// Twenty-seven boxes have more than a hundred contacts when they have landed: what is solved, lifted and looked at
/// again in a pile takes none either, but for a contact more than the first time.
#[test]
fn a_pile_takes_no_memory_once_as_many_contacts_have_been_met() {
    let boxes = falling_boxes(27).unwrap();
    let (used, visits) = allocations(&boxes, 360, 120);
    assert!(used < 4 && visits > 50_000, "{used} {visits}");
}

/// Steps chosen by their error, with the works and impulses that they keep, of a box that slides: a call copies what
/// pushed last, its steps take nothing.
#[test]
fn chosen_steps_take_no_memory_once_as_many_were_taken() {
    let boxes = columns_of_boxes(1, 1).unwrap();
    let mut first = boxes.state.clone();
    first.p.0[0] = 2.0;
    let world = SpatialWorld::new(boxes.system.clone(), detector(1)).unwrap();
    let mut chosen = ErrorControlled::new(world, 1e-6).unwrap();
    let mut steps = 0;
    let mut run = |chosen: &mut ErrorControlled<Spatial, _>| {
        steps = chosen.advance(&mut first.clone(), 0.1).unwrap().steps;
    };
    (0..2).for_each(|_| run(&mut chosen));
    let used = measure(|| run(&mut chosen)).count_total;
    // Two of the state, one of what pushed.
    assert!(used <= 3 && steps > 20, "{used} {steps}");
}

/// Two boxes that fall and come to rest: where they land without rubbing they are projected exactly, and small islands
/// are polished.
#[test]
fn chosen_steps_of_boxes_that_land_take_no_memory_once_as_many_were_taken() {
    let boxes = falling_boxes(2).unwrap();
    let world = SpatialWorld::new(boxes.system.clone(), detector(2)).unwrap();
    let mut chosen = ErrorControlled::new(world, 1e-3).unwrap();
    let (mut state, mut steps) = (boxes.state.clone(), 0);
    let mut run = |chosen: &mut ErrorControlled<Spatial, _>| {
        state.clone_from(&boxes.state);
        steps = chosen.advance(&mut state, 2.0).unwrap().steps;
    };
    (0..3).for_each(|_| run(&mut chosen));
    let used = measure(|| run(&mut chosen)).count_total;
    // One of what pushed last.
    assert!(used <= 1 && steps > 100, "{used} {steps}");
}

#[test]
fn moments_of_rolling_take_no_memory_once_as_many_contacts_have_been_met() {
    let boxes = falling_boxes(2).unwrap();
    let pairs = [[0, 1], [0, 2], [1, 2]].into_iter();
    let detector =
        pairs.fold(detector(2), |detector, pair| detector.with_rolling(pair, 0.05, 0.02).unwrap());
    let (used, _) = allocations_of(detector, &boxes, 400, 100);
    assert_eq!(used, 0);
}

/// A chain of three boxes that is hung from the world, in the air and lying on the floor: what was found about the
/// places of its joints is kept, and rows of joints and contacts have their room.
#[test]
fn chains_take_no_memory_once_as_many_contacts_have_been_met() {
    for above in [2.0, 0.1] {
        let (mut chain, mut contacts) = (hung_chain(3, above), 0);
        let mut run = |steps: usize| {
            (0..steps).for_each(|_| contacts = chain.step(2e-3).contacts);
        };
        run(400);
        let used = measure(|| run(20)).count_total;
        assert_eq!((used, contacts > 0), (0, above < 1.0), "{contacts}");
    }
}

/// Two boxes in flight, by impacts at their instant.
#[test]
fn flights_take_no_memory() {
    let boxes = falling_boxes(2).unwrap();
    let mut bodies = EventDriven::<Spatial, _>::new(
        boxes.system.clone(),
        detector(2),
        FlightOrder::Second,
        2e-3,
    )
    .unwrap();
    let mut run = |state: &mut State<Vec<f64>>, steps: usize| -> usize {
        (0..steps).map(|_| bodies.step(state, 1e-2).unwrap().flights).sum()
    };
    run(&mut boxes.state.clone(), 20);
    let mut again = boxes.state.clone();
    let mut flights = 0;
    let used = measure(|| flights = run(&mut again, 20)).count_total;
    assert_eq!((used, flights), (0, 20));
}

/// Boxes with restitution that rest: nothing hits, and impacts need no room.
#[test]
fn what_could_bounce_and_does_not_takes_no_memory() {
    let boxes = columns_of_boxes(2, 2).unwrap();
    let mut bodies = SpatialWorld::new(boxes.system.clone(), detector_with(4, 0.5)).unwrap();
    let mut state = boxes.state.clone();
    let mut run =
        |steps: usize| (0..steps).all(|_| bodies.step(&mut state, 2e-3).unwrap().impacts == 0);
    assert!(run(20));
    let mut calm = false;
    let used = measure(|| calm = run(20)).count_total;
    assert_eq!((used, calm), (0, true));
}

/// Boxes at rest that are stepped by impacts at their instant: each step takes contact steps.
#[test]
fn rest_between_instants_of_impact_takes_no_memory() {
    let boxes = columns_of_boxes(1, 2).unwrap();
    let detector = detector_with(2, 0.5);
    let mut bodies =
        EventDriven::<Spatial, _>::new(boxes.system.clone(), detector, FlightOrder::Second, 2e-3)
            .unwrap();
    let mut state = boxes.state.clone();
    let mut run = |steps: usize| -> usize {
        (0..steps).map(|_| bodies.step(&mut state, 1e-2).unwrap().contact_steps).sum()
    };
    run(20);
    let mut steps = 0;
    let used = measure(|| steps = run(20)).count_total;
    assert!(used == 0 && steps >= 100, "{used} {steps}");
}
