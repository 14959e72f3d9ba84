//! Rows of joints in one unit: what turns is measured at the end of an arm.
//!
//! ```text
//! l = max(|J_turn|, radii of the bodies)                   an arm, m
//! u -> l u,   x -> x / l,   b -> b / l                     of a row that moves no place, as that of a hinge's axis
//! ```
//! `u` a rate (rad/s, then m/s) or an opening (rad, then m), `x` an impulse (N m s, then N s) and `b` its bound. One
//! tolerance is right for both then, at any size: 1e-9 m/s is nothing for doors and much for what has 1e-9 m.

use stationary_constraints::VelocityRows;

use crate::Dimension;
use crate::detect::detection::DetectorIn;

/// The longest arm of rows between bodies, and the largest of these, m; one metre where there is none.
pub(super) fn arm<G: Dimension>(rows: &VelocityRows, detector: &DetectorIn<G>) -> f64 {
    let mut arm = 0.0_f64;
    for row in 0..rows.rows() {
        let of_length = is_length::<G>(rows, row);
        for (freedom, value) in rows.row(row) {
            arm = arm.max(detector.radius_of(freedom / G::FREEDOMS));
            if of_length && turns::<G>(freedom) {
                arm = arm.max(value.abs());
            }
        }
    }
    if arm > 0.0 { arm } else { 1.0 }
}

/// The farthest from the origin that rows name a body, m.
pub(super) fn farthest<G: Dimension>(rows: &VelocityRows, q: &[f64]) -> f64 {
    let named = (0..rows.rows()).flat_map(|row| rows.row(row));
    let places = named.filter(|entry| !turns::<G>(entry.0)).map(|(freedom, _)| {
        let (body, axis) = (freedom / G::FREEDOMS, freedom % G::FREEDOMS);
        q[G::STORED * body + axis].abs()
    });
    places.fold(0.0, f64::max)
}

/// What a row is multiplied by to be measured at the end of an arm.
pub(super) fn measure<G: Dimension>(rows: &VelocityRows, row: usize, arm: f64) -> f64 {
    if is_length::<G>(rows, row) { 1.0 } else { arm }
}

/// Appends rows, measured at the end of an arm.
pub(super) fn append<G: Dimension>(more: &VelocityRows, arm: f64, rows: &mut VelocityRows) {
    rows.extend_in_units(more, |row| measure::<G>(more, row, arm));
}

/// Whether a row moves places of bodies.
fn is_length<G: Dimension>(rows: &VelocityRows, row: usize) -> bool {
    rows.row(row).any(|(freedom, _)| !turns::<G>(freedom))
}

fn turns<G: Dimension>(freedom: usize) -> bool {
    freedom % G::FREEDOMS >= G::TRANSLATION
}
