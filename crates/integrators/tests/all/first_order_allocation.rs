//! No step of a first-order method allocates, nor does dense output or the search for an event.

use std::ops::ControlFlow;

use allocation_counter::measure;
use stationary_calculus::Storage;
use stationary_integrators::problems::{constrained_robertson, spring_pendulum, van_der_pol};
use stationary_integrators::{
    AdaptiveMethod, BackwardDifferences, Direction, DormandPrince54, DormandPrince853, Event,
    FunctionField, MechanicalField, Moment, OutputTimes, RadauIia5, StepControl, Tolerance,
    VectorField, integrate,
};

#[test]
fn the_counter_counts() {
    assert_eq!(measure(|| drop(std::hint::black_box(vec![1.0; 3]))).count_total, 1);
}

/// Allocations in a run with output at given times and an event that is looked for in every step.
fn allocations<C: Storage>(mut method: impl AdaptiveMethod<C>, end: f64) -> u64 {
    let start = method.moment().clone();
    let times: Vec<f64> = (0..50).map(|i| start.t + 0.02 * f64::from(i) * end).collect();
    let mut output = OutputTimes::<C>::new(start.y.as_ref().len(), &times).unwrap();
    let (mut crossings, mut seen) = (0, 0);
    let half = 0.5 * start.y.as_ref()[0];
    let function = |_t: f64, y: &[f64]| y[0] - half;
    let mut event = Event::new(Direction::Any, &start, function).looking_at(2);
    let used = measure(|| {
        integrate(&mut method, end, |mut step| {
            output.within(&mut step, |_, _| seen += 1).unwrap();
            crossings += u32::from(event.crossing(&mut step).unwrap());
            ControlFlow::Continue(())
        })
        .unwrap();
    });
    let steps = method.work().steps;
    assert!(crossings > 0 && seen == 50 && steps > 5, "{crossings} {seen} {steps}");
    used.count_total
}

fn control() -> StepControl {
    Tolerance::new(1e-7, 1e-9).unwrap().into()
}

fn checked<F: VectorField, C: Storage>(field: &F, start: &Moment<C>, end: f64) {
    if field.mass().is_none() {
        let dop = DormandPrince853::new(field, control(), start.clone()).unwrap();
        assert_eq!(allocations(dop, end), 0);
        let low = DormandPrince54::new(field, control(), start.clone()).unwrap();
        assert_eq!(allocations(low, end), 0);
    }
    assert_eq!(allocations(RadauIia5::new(field, control(), start.clone()).unwrap(), end), 0);
    let bdf = BackwardDifferences::new(field, control(), start.clone()).unwrap();
    assert_eq!(allocations(bdf, end), 0);
}

#[test]
fn no_first_order_method_allocates_in_a_step() {
    let oscillator = van_der_pol(5.0).unwrap();
    let [x, v] = oscillator.initial.y;
    checked(&oscillator.field, &Moment::new(0.0, [x, v]), 10.0);
    checked(&oscillator.field, &Moment::new(0.0, vec![x, v]), 10.0);
    let reactions = constrained_robertson();
    checked(&reactions.field, &reactions.initial, 1e4);
    let pendulum = spring_pendulum(50.0).unwrap();
    let [q, p] = [pendulum.initial.q, pendulum.initial.p.0];
    let start = Moment::new(0.0, [q[0], q[1], p[0], p[1]]);
    checked(&MechanicalField::new(&pendulum.system), &start, 5.0);
    let bare = FunctionField::new(2, |_t, y: &[f64], f: &mut [f64]| {
        f.copy_from_slice(&[y[1], -y[0]]);
    });
    checked(&bare, &Moment::new(0.0, [1.0, 0.0]), 10.0);
}
