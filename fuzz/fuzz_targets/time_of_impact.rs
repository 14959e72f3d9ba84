//! Whatever the corners and their motions, a hit lies within the motion and as close as promised, or
//! an error has words.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nalgebra::Vector3;
use stationary_contact::{Closeness, Moving, edge_meets_edge, particle_meets_triangle};

/// The distance that may be left at a hit is three tolerances; the search ends where boxes run out.
const CLOSE: Closeness = Closeness { thickness: 0.0, tolerance: 1e-6 };

fuzz_target!(|corners: [[[i8; 3]; 2]; 4]| {
    let [a, b, c, d] = corners.map(|[start, end]| {
        let [start, end] = [start, end].map(|x| Vector3::from(x.map(f64::from)));
        Moving { start, end }
    });
    let met = |hit: &stationary_contact::Hit| (0.0..=1.0).contains(&hit.time);
    match particle_meets_triangle(&a, &[b, c, d], CLOSE) {
        Ok(hit) => {
            let Some(hit) = hit else { return };
            let [p, b, c, d] = [a, b, c, d].map(|corner| corner.at(hit.time));
            let [u, v] = hit.place;
            let apart = (p - (b + (c - b) * u + (d - b) * v)).norm();
            assert!(met(&hit) && (!hit.settled || apart <= 4.0 * CLOSE.tolerance), "{apart}");
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
    match edge_meets_edge(&[a, b], &[c, d], CLOSE) {
        Ok(hit) => assert!(hit.as_ref().is_none_or(met)),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
