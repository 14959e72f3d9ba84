//! What stands is not asked again, and is the same to the last bit as if it were; whatever changes wakes it.

use stationary_calculus::{Covector, Force, Vector};
use stationary_contact::problems::columns_of_boxes;
use stationary_contact::{SpatialWorld, WorldReport};
use stationary_integrators::State;
use stationary_rigid::{Poses, Weight};

const STEP: f64 = 1e-3;

fn world() -> (SpatialWorld<Weight<Poses>>, State<Vec<f64>>) {
    let boxes = columns_of_boxes(3, 4).unwrap();
    let world = SpatialWorld::new(boxes.system.clone(), boxes.detector().unwrap()).unwrap();
    (world, boxes.state)
}

/// Pushes the first box aside from an instant on, N.
struct Push {
    from: f64,
    size: f64,
}

impl Force for Push {
    fn dim(&self) -> usize {
        72
    }

    fn add_force(&self, t: f64, _: &[f64], _: Vector<&[f64]>, force: Covector<&mut [f64]>) {
        if t >= self.from {
            force.0[0] += self.size;
        }
    }
}

/// Steps with what stood remembered, and beside it with that forgotten before each.
fn both(
    steps: usize,
    h: impl Fn(usize) -> f64,
    push: Push,
) -> [(State<Vec<f64>>, Vec<WorldReport>); 2] {
    [false, true].map(|forgets| {
        let (mut world, mut state) = world();
        let reports = (0..steps).map(|step| {
            if forgets {
                let saved = world.save();
                world.load(&saved).unwrap();
            }
            world.step_under(&mut state, h(step), &(), &push).unwrap()
        });
        let reports = reports.collect();
        (state, reports)
    })
}

#[test]
fn what_stands_is_the_same_to_the_bit_whether_it_is_asked_again_or_not() {
    let [a, b] = both(200, |_| STEP, Push { from: f64::INFINITY, size: 50.0 });
    assert_eq!(a, b);
    let last = a.1[199];
    assert!(last.settled && last.contacts == 48 && last.relaxed == 0, "{last:?}");
    assert!((a.0.t - 0.2).abs() < 1e-12, "{}", a.0.t);
}

#[test]
fn a_force_that_begins_and_another_step_wake_what_stands() {
    let [a, b] = both(200, |_| STEP, Push { from: 0.1, size: 50.0 });
    assert_eq!(a, b);
    let (_, start) = world();
    assert!(a.0.q[0] - start.q[0] > 0.02, "{} {}", a.0.q[0], start.q[0]);
    let [a, b] = both(
        200,
        |step| if step < 100 { STEP } else { 2.0 * STEP },
        Push { from: 0.15, size: 50.0 },
    );
    assert_eq!(a, b);
}

/// A push that friction holds, and that ends: without it the impulses of contacts are others.
#[test]
fn what_a_force_held_is_asked_again_when_the_force_is_gone() {
    let (mut world, mut state) = world();
    // Four boxes of 1 kg with a friction of 0.5 hold up to 19.6 N.
    let push = Push { from: 0.0, size: 5.0 };
    let reports = (0..100).map(|_| world.step_under(&mut state, STEP, &(), &push).unwrap());
    let last = reports.last().unwrap();
    assert!(last.settled && last.relaxed == 0, "{last:?}");
    let held: f64 = world.touches().map(|touch| touch.friction.norm()).sum();
    world.step(&mut state, STEP).unwrap();
    let after: f64 = world.touches().map(|touch| touch.friction.norm()).sum();
    assert!(held > 0.9 * 5.0 * STEP && after < 0.5 * held, "{held} {after}");
}

#[test]
fn what_is_pushed_by_hand_moves() {
    let (mut world, mut state) = world();
    for _ in 0..100 {
        world.step(&mut state, STEP).unwrap();
    }
    state.p.0[0] = 3.0;
    let before = state.q[0];
    world.step(&mut state, STEP).unwrap();
    assert!(state.q[0] > before);
}
