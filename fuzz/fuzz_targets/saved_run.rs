//! Whatever was saved, a method that takes it back goes on with finite numbers, or says why not and
//! is where it was.
#![no_main]

use libfuzzer_sys::fuzz_target;
use stationary_integrators::problems::van_der_pol;
use stationary_integrators::{AdaptiveMethod, RadauIia5, Saved, Tolerance};

fuzz_target!(|changes: Vec<(u8, f64)>| {
    let problem = van_der_pol(10.0).unwrap();
    let tolerance = Tolerance::new(1e-6, 1e-6).unwrap();
    let mut method = RadauIia5::new(&problem.field, tolerance.into(), problem.initial.clone()).unwrap();
    method.step(problem.end).unwrap();
    let Saved { method: name, mut numbers } = method.save();
    for (place, number) in changes {
        let place = usize::from(place) % numbers.len();
        numbers[place] = number;
    }
    let before = method.moment().clone();
    match method.load(&Saved { method: name, numbers }) {
        Ok(()) => {
            let _ = method.step(problem.end);
            assert!(method.moment().y.iter().all(|y| y.is_finite()));
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            assert_eq!(*method.moment(), before);
        }
    }
});
