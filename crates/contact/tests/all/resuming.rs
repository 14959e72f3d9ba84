//! Bodies that touch go on from what was saved to the same bits.

use stationary_contact::problems::falling_boxes;
use stationary_contact::{Arch, ContactError, SpatialWorld};
use stationary_integrators::{Saved, State, StepError};

/// Steps to the end, and from the middle again with what was saved there; both states.
fn twice<B>(
    mut make: impl FnMut() -> B,
    mut step: impl FnMut(&mut B, &mut State<Vec<f64>>),
    save: impl Fn(&B) -> Saved,
    load: impl Fn(&mut B, &Saved) -> Result<(), StepError>,
    start: &State<Vec<f64>>,
    steps: usize,
) -> [State<Vec<f64>>; 3] {
    let (mut whole, mut state) = (make(), start.clone());
    (0..steps).for_each(|_| step(&mut whole, &mut state));
    let (saved, middle) = (save(&whole), state.clone());
    (0..steps).for_each(|_| step(&mut whole, &mut state));
    let go_on = |remembers: bool,
                 make: &mut dyn FnMut() -> B,
                 step: &mut dyn FnMut(&mut B, &mut State<Vec<f64>>)| {
        let (mut again, mut state) = (make(), middle.clone());
        if remembers {
            load(&mut again, &saved).unwrap();
            assert_eq!(save(&again), saved);
        }
        (0..steps).for_each(|_| step(&mut again, &mut state));
        state
    };
    let [resumed, forgetful] =
        [true, false].map(|remembers| go_on(remembers, &mut make, &mut step));
    [state, resumed, forgetful]
}

#[test]
fn a_pile_and_an_arch_go_on_from_what_was_saved_to_the_same_bits_and_not_without_it() {
    let boxes = falling_boxes(12).unwrap();
    // In flight, and when some of its contacts are kept from step to step.
    for (steps, tolerance) in [(250, 3e-3), (400, 3e-4), (400, 1e-8)] {
        let [whole, resumed, forgetful] = twice(
            || {
                let detector = boxes.detector().unwrap();
                let bodies = SpatialWorld::new(boxes.system.clone(), detector).unwrap();
                bodies.with_tolerance(tolerance).unwrap()
            },
            |bodies, state| {
                bodies.step(state, 2e-3).unwrap();
            },
            |bodies| bodies.save(),
            |bodies, saved| bodies.load(saved),
            &boxes.state,
            steps,
        );
        assert!(whole == resumed && whole != forgetful, "{steps} {tolerance}");
    }
    let arch = Arch { wedges: 7, radius: 1.0, thickness: 0.3, friction: 0.6, gravity: 10.0 };
    let (_, start) = arch.built().unwrap();
    let [whole, resumed, forgetful] = twice(
        || arch.built().unwrap().0,
        |world, state| {
            world.step(state, 1e-3).unwrap();
        },
        |world| world.save(),
        |world, saved| world.load(saved),
        &start,
        20,
    );
    assert!(whole == resumed && whole != forgetful);
}

#[test]
fn what_no_bodies_leave_behind_is_refused_and_nothing_is_forgotten() -> Result<(), ContactError> {
    let boxes = falling_boxes(8)?;
    let mut bodies = SpatialWorld::new(boxes.system.clone(), boxes.detector()?)?;
    let mut state = boxes.state.clone();
    for _ in 0..400 {
        bodies.step(&mut state, 2e-3)?;
    }
    let saved = bodies.save();
    assert!(saved.numbers.len() > 9);
    let mut bad = saved.clone();
    bad.numbers.pop();
    assert!(matches!(bodies.load(&bad), Err(StepError::Saved(_))));
    assert_eq!(bodies.save(), saved);
    Ok(())
}

#[test]
fn worlds_and_bodies_refuse_a_step_at_no_time_and_stay() -> Result<(), ContactError> {
    let boxes = falling_boxes(2)?;
    let mut bodies = SpatialWorld::new(boxes.system.clone(), boxes.detector()?)?;
    let arch = Arch { wedges: 3, radius: 1.0, thickness: 0.3, friction: 0.6, gravity: 10.0 };
    let (mut world, start) = arch.built()?;
    for t in [f64::NAN, f64::INFINITY] {
        let (mut falling, mut standing) = (boxes.state.clone(), start.clone());
        (falling.t, standing.t) = (t, t);
        assert!(bodies.step(&mut falling, 1e-3).is_err() && falling.q == boxes.state.q, "{t}");
        assert!(world.step(&mut standing, 1e-3).is_err() && standing.q == start.q, "{t}");
    }
    Ok(())
}
