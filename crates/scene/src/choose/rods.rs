//! Rods for stiff springs: what their swing is too fast for the question to see.
//!
//! ```text
//! w^2 = k (1/m_a + 1/m_b),   w T > 2 pi n         a rod for the spring k that swings n times and more
//! |x_b - x_a| = l,   (x_b - x_a) (v_b - v_a) = 0  at the start, as rods keep it
//! ```
//! `T` the horizon, `m` the masses at the ends, `l` the length at rest. A spring that starts stretched, or is being
//! stretched, swings by itself: no rod stands for it.

use stationary_calculus::array;
use std::f64::consts::TAU;

use toml::{Table, Value};

use crate::model::items::Link;
use crate::model::particle::Motion;
use crate::model::scene::Scene;

/// Swings within the horizon, from which on a rod is tried.
const SWINGS: f64 = 50.0;
/// What a stretch may be, and its rate over a swing, relative to the length at rest.
const STRETCH: f64 = 1e-9;

/// The springs of the file that rods may stand for, by their places there.
pub(super) fn stiff(table: &Table, scene: &Scene) -> Vec<usize> {
    let Some(declared) = table.get("springs").and_then(Value::as_array) else { return Vec::new() };
    if !scene.bodies().is_empty() || scene.contact().is_some() {
        return Vec::new();
    }
    // Those of nets come first.
    let links = &scene.links()[scene.links().len().saturating_sub(declared.len())..];
    let fast = SWINGS * TAU / scene.timing().horizon();
    (0..links.len()).filter(|&spring| is_rigid(scene, &links[spring], fast)).collect()
}

/// Whether a spring starts at rest and swings faster than this, in radians a unit of time.
fn is_rigid(scene: &Scene, link: &Link, fast: f64) -> bool {
    let ends = link.ends.map(|end| &scene.particles()[end]);
    let mut yields = 0.0;
    let velocity = ends.map(|end| match end.motion {
        Motion::Free { mass, momentum } => {
            yields += 1.0 / mass;
            momentum.map(|p| p / mass)
        }
        _ => [0.0; 3],
    });
    let [x, v] =
        [ends.map(|end| end.position), velocity].map(|[a, b]| array::<f64, 3>(|c| b[c] - a[c]));
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|c| a[c] * b[c]).sum::<f64>();
    let (length, omega) = (dot(x, x).sqrt(), (link.stiffness * yields).sqrt());
    let allowed = STRETCH * link.rest_length;
    omega > fast
        && (length - link.rest_length).abs() < allowed
        && dot(x, v).abs() < allowed * omega * length
}

/// The scene with rods for these springs, held by their forces.
pub(super) fn with_rods(table: &Table, springs: &[usize]) -> Option<Table> {
    let mut other = table.clone();
    let declared = other.remove("springs")?;
    let (mut left, mut rods) = (Vec::new(), Vec::new());
    for (place, spring) in declared.as_array()?.iter().enumerate() {
        if !springs.contains(&place) {
            left.push(spring.clone());
            continue;
        }
        let between = spring.get("between")?.clone();
        rods.push(Value::Table(Table::from_iter([("between".to_owned(), between)])));
    }
    if !left.is_empty() {
        other.insert("springs".to_owned(), Value::Array(left));
    }
    match other.get_mut("rods") {
        Some(own) => own.as_array_mut()?.extend(rods),
        None => drop(other.insert("rods".to_owned(), Value::Array(rods))),
    }
    for key in ["tolerance", "modes"] {
        other.remove(key);
    }
    other.insert("integrator".to_owned(), "rattle".into());
    Some(other)
}
