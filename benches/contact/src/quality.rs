//! What a step leaves of the contact conditions, whoever took it.
//!
//! ```text
//! closes        max -dg v+ - max(g, 0)/h
//! unexplained   min |v+ - v- - k - M^-1 J^T x| over x in Coulomb's cones, at the contacts within reach
//! ```
//! `v- v+` velocities before and after a step from the poses `q`, `k` what gravity adds. The second is
//! found by sweeps of projections on the cones, and is the largest of all freedoms (turns times half a
//! metre); it counts friction beyond its bound, and impulses where nothing touches.

use stationary_calculus::Vector;
use stationary_contact::{ContactRows, DetectorIn, Dimension, gap_rows};

/// Contacts within this gap may have pushed, m.
const REACH: f64 = 0.02;
/// Sweeps over the contacts.
const SWEEPS: usize = 300;
/// Half a box, m.
const ARM: f64 = 0.5;

/// What is left at worst.
#[derive(Clone, Copy, Debug, Default)]
pub struct Left {
    pub closes: f64,
    pub unexplained: f64,
    pub overlap: f64,
}

impl Left {
    pub fn or_worse(self, other: Left) -> Left {
        Left {
            closes: self.closes.max(other.closes),
            unexplained: self.unexplained.max(other.unexplained),
            overlap: self.overlap.max(other.overlap),
        }
    }
}

/// A step of bodies: poses and velocities before it, velocities after, what gravity adds, and one over
/// the mass of each freedom.
pub struct Seen<'a> {
    pub q: &'a [f64],
    pub before: &'a [f64],
    pub after: &'a [f64],
    pub kick: &'a [f64],
    pub lightness: &'a [f64],
    pub h: f64,
}

/// Looks at a step.
pub fn look<G: Dimension>(detector: &mut DetectorIn<G>, seen: &Seen) -> Left {
    let mut left = Left::default();
    let contacts = detector.detect(seen.q, REACH).expect("detection");
    let (rows, mut across) = (gap_rows(contacts, seen.q), ContactRows::new());
    contacts.iter().for_each(|contact| contact.push_tangents(seen.q, &mut across));
    for (i, contact) in contacts.iter().enumerate() {
        let closes = -rows.along(i, Vector(seen.after)) - contact.gap.max(0.0) / seen.h;
        left.closes = left.closes.max(closes);
        left.overlap = left.overlap.max(-contact.gap);
    }
    // What is still to be explained, and impulses that explain the rest.
    let moved = seen.after.iter().zip(seen.before).zip(seen.kick);
    let mut rest: Vec<f64> = moved.map(|((after, before), kick)| after - before - kick).collect();
    let directions = G::TRANSLATION - 1;
    let row = |k: usize, i: usize| -> Vec<(usize, f64)> {
        let of = if k == 0 { rows.row(i) } else { across.row(i * directions + k - 1) };
        of.collect()
    };
    let packed: Vec<Vec<Vec<(usize, f64)>>> =
        (0..contacts.len()).map(|i| (0..=directions).map(|k| row(k, i)).collect()).collect();
    let mut x = vec![[0.0; 3]; contacts.len()];
    for _ in 0..SWEEPS {
        for (i, contact) in contacts.iter().enumerate() {
            let gives: f64 = packed[i]
                .iter()
                .map(|row| row.iter().map(|(f, a)| a * a * seen.lightness[*f]).sum::<f64>())
                .sum();
            let mut wanted = x[i];
            for (k, row) in packed[i].iter().enumerate() {
                wanted[k] += row.iter().map(|(f, a)| a * rest[*f]).sum::<f64>() / gives;
            }
            let fit = in_cone(wanted, contact.friction);
            for (k, row) in packed[i].iter().enumerate() {
                let change = fit[k] - x[i][k];
                row.iter().for_each(|(f, a)| rest[*f] -= seen.lightness[*f] * a * change);
            }
            x[i] = fit;
        }
    }
    let arm = |f: usize| if f % G::FREEDOMS < G::TRANSLATION { 1.0 } else { ARM };
    let speeds = rest.iter().enumerate().map(|(f, rest)| (arm(f) * rest).abs());
    left.unexplained = speeds.fold(0.0, f64::max);
    left
}

/// The nearest point of the cone `|x_t| <= mu x_n`.
fn in_cone(x: [f64; 3], mu: f64) -> [f64; 3] {
    let across = x[1].hypot(x[2]);
    if across <= mu * x[0] {
        return x;
    }
    if mu * across <= -x[0] {
        return [0.0; 3];
    }
    let normal = (x[0] + mu * across) / (1.0 + mu * mu);
    let scale = mu * normal / across;
    [normal, scale * x[1], scale * x[2]]
}
