//! Whatever the corners, a polygon has finite moments and positive area, or an error has words.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nalgebra::Vector2;
use stationary_mesh::Polygon;

// Whole numbers: corners meet, and edges lie on each other, far more often than on floating-point ones.
fuzz_target!(|outlines: Vec<Vec<[i8; 2]>>| {
    let corner = |[x, y]: [i8; 2]| Vector2::new(f64::from(x), f64::from(y));
    let outlines = outlines.into_iter().map(|corners| corners.into_iter().map(corner).collect());
    match Polygon::new(outlines.collect()) {
        Ok(polygon) => {
            let area = polygon.moments().measure;
            assert!(area > 0.0 && area.is_finite());
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
