//! What the last steps' impulses change: the number of iterations, and nothing that is seen.

use stationary_constraints::problems::{RodProblem, chain, writhing_chain};
use stationary_constraints::{
    Composed, ConstrainedHamilton, ConstrainedIntegrator, Rattle, Redundancy, SparseDiagonal,
};
use stationary_integrators::{Scheme, State};

const REFUSE: SparseDiagonal = SparseDiagonal(Redundancy::Refuse);

/// The most iterations of the steps after the fourth, and the last state.
fn moved(again: bool) -> (u32, State<Vec<f64>>) {
    let RodProblem { system, rods, initial } = writhing_chain(40, 100.0).unwrap();
    let make = |state: &State<Vec<f64>>| Rattle::new(&system, rods.clone(), state, REFUSE).unwrap();
    let (mut state, mut rattle, mut most) = (initial.clone(), make(&initial), 0);
    for k in 0..40 {
        if again {
            rattle = make(&state);
        }
        let iterations = rattle.step(&mut state, 1e-4).unwrap().iterations;
        most = if k < 4 { 0 } else { most.max(iterations) };
    }
    (most, state)
}

#[test]
fn a_chain_is_where_it_would_be_without_memory_to_rounding_in_at_least_two_iterations_fewer() {
    let ((warm, state), (cold, same)) = (moved(false), moved(true));
    assert!(warm + 2 <= cold, "{warm} iterations, without memory {cold}");
    let off = state.q.iter().zip(&same.q).fold(0.0_f64, |off, (a, b)| off.max((a - b).abs()));
    assert!(off < 1e-11, "{off:e}");
}

/// Goes on from what was saved after some steps, beside a method that was not interrupted.
fn goes_on<I: ConstrainedIntegrator<Vec<f64>>>(make: impl Fn(&State<Vec<f64>>) -> I) {
    let initial = writhing_chain(12, 100.0).unwrap().initial;
    let (mut state, mut method) = (initial.clone(), make(&initial));
    for _ in 0..7 {
        method.step(&mut state, 1e-4).unwrap();
    }
    let (mut resumed, mut second) = (state.clone(), make(&initial));
    second.load(&method.save()).unwrap();
    for _ in 0..7 {
        let report = method.step(&mut state, 1e-4).unwrap();
        // The first step counts the differential where it begins.
        let own = second.step(&mut resumed, 1e-4).unwrap();
        assert_eq!((own.iterations, own.violation), (report.iterations, report.violation));
        assert_eq!(state, resumed);
    }
    // Numbers of another chain, and another method's.
    let RodProblem { system, rods, initial } = writhing_chain(13, 100.0).unwrap();
    let mut other = Rattle::new(&system, rods, &initial, REFUSE).unwrap();
    assert!(other.load(&method.save()).is_err());
    let mut foreign = method.save();
    foreign.method.push('x');
    assert!(method.load(&foreign).is_err());
}

#[test]
fn what_was_saved_goes_on_to_the_same_bits() {
    let RodProblem { system, rods, .. } = writhing_chain(12, 100.0).unwrap();
    goes_on(|state| Rattle::new(&system, rods.clone(), state, REFUSE).unwrap());
    goes_on(|state| ConstrainedHamilton::new(&system, rods.clone(), state, REFUSE).unwrap());
    goes_on(|state| {
        let rattle = Rattle::new(&system, rods.clone(), state, REFUSE).unwrap();
        Composed::new(rattle, Scheme::Suzuki4, state).unwrap()
    });
}

#[test]
fn a_state_that_was_thrown_elsewhere_is_held_as_if_nothing_were_remembered() {
    let RodProblem { system, rods, initial } = chain(10, 0.3).unwrap();
    let mut rattle = Rattle::new(&system, rods.clone(), &initial, REFUSE).unwrap();
    let mut state = initial.clone();
    for _ in 0..6 {
        rattle.step(&mut state, 1e-3).unwrap();
    }
    // The time of the last step with the momenta of no step: turned back, and a hundred times as fast.
    state.p.0.iter_mut().for_each(|p| *p *= -100.0);
    let (mut here, mut fresh) = (state.clone(), state);
    rattle.step(&mut here, 1e-3).unwrap();
    Rattle::new(&system, rods, &fresh, REFUSE).unwrap().step(&mut fresh, 1e-3).unwrap();
    let off = here.q.iter().zip(&fresh.q).fold(0.0_f64, |off, (a, b)| off.max((a - b).abs()));
    assert!(off < 1e-12, "{off:e}");
}

#[test]
fn a_step_that_is_refused_changes_no_bit_of_the_next() {
    let RodProblem { system, rods, initial } = writhing_chain(12, 100.0).unwrap();
    let mut state = initial.clone();
    let mut rattle = Rattle::new(&system, rods, &initial, REFUSE).unwrap();
    for _ in 0..7 {
        rattle.step(&mut state, 1e-4).unwrap();
    }
    let (mut refused, mut other) = (rattle.clone(), state.clone());
    for h in [1.0, 1e5, f64::NAN] {
        assert!(refused.step(&mut other, h).is_err());
    }
    for _ in 0..5 {
        rattle.step(&mut state, 1e-4).unwrap();
        refused.step(&mut other, 1e-4).unwrap();
        assert_eq!(state, other);
    }
}
