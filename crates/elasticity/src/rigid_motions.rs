//! The motions that strain nothing, and whether supports forbid them all.
//!
//! ```text
//! v(x) = e_i,   v(x) = e_j (x_k - c_k) - e_k (x_j - c_j)         D translations, D (D - 1)/2 rotations
//! B z = 0       B (m x rigid motions): what each motion does to the m held coordinates
//! ```
//! `c` the middle of the body. Motions z in the kernel of B are free. They are named where they are
//! along the axes or about them; of others only the number is known.

use nalgebra::DMatrix;

use crate::{ElasticityError, Material, Solid};

/// Held coordinates that move less than this part of the largest motion do not hold.
const HOLDS: f64 = 1e-9;

/// An error that names the rigid motions that are free.
pub(crate) fn check_held<M, const N: usize, const D: usize, const R: usize, const Q: usize>(
    solid: &Solid<M, N, D, R, Q>,
    q: &[f64],
) -> Result<(), ElasticityError>
where
    M: Material<D, R>,
{
    let positions = solid.freedoms().positions(q)?;
    let held = solid.freedoms().held();
    let motions = motions(&positions);
    let count = motions.len();
    let entry = |row: usize, motion: usize| {
        let (vertex, component) = held[row];
        motions[motion].1(&positions[vertex])[component]
    };
    let matrix = DMatrix::from_fn(held.len().max(count), count, |row, motion| {
        if row < held.len() { entry(row, motion) } else { 0.0 }
    });
    let free = count - matrix.clone().singular_values().iter().filter(|s| **s > HOLDS).count();
    if free == 0 {
        return Ok(());
    }
    let named = (0..count).filter(|&motion| matrix.column(motion).amax() <= HOLDS);
    let mut names: Vec<&str> = named.map(|motion| motions[motion].0).collect();
    if names.len() < free {
        names.push("others that are not along an axis");
    }
    Err(ElasticityError::RigidMotions { count: free, names: names.join(", ") })
}

type Motion<const D: usize> = Box<dyn Fn(&[f64; D]) -> [f64; D]>;

const TRANSLATIONS: [&str; 3] = ["translation x", "translation y", "translation z"];
const ROTATIONS: [&str; 3] = ["rotation about x", "rotation about y", "rotation about z"];

/// Each motion with its name, scaled so that none moves the body by more than about one.
fn motions<const D: usize>(positions: &[[f64; D]]) -> Vec<(&'static str, Motion<D>)> {
    let extent: [[f64; 2]; D] = std::array::from_fn(|c| {
        let coordinates = positions.iter().map(|x| x[c]);
        let low = coordinates.clone().fold(f64::INFINITY, f64::min);
        [low, coordinates.fold(f64::NEG_INFINITY, f64::max)]
    });
    let middle: [f64; D] = extent.map(|[low, high]| 0.5 * (low + high));
    let size = extent.iter().map(|[low, high]| high - low).fold(f64::MIN_POSITIVE, f64::max);
    let mut motions: Vec<(&'static str, Motion<D>)> = Vec::new();
    for c in 0..D {
        let along: Motion<D> = Box::new(move |_| std::array::from_fn(|i| f64::from(i == c)));
        motions.push((TRANSLATIONS[c], along));
    }
    let axes: &[(usize, usize, usize)] = match D {
        1 => &[],
        2 => &[(2, 0, 1)],
        _ => &[(0, 1, 2), (1, 2, 0), (2, 0, 1)],
    };
    for &(axis, j, k) in axes {
        let about: Motion<D> = Box::new(move |x| {
            std::array::from_fn(|i| match i {
                i if i == j => -(x[k] - middle[k]) / size,
                i if i == k => (x[j] - middle[j]) / size,
                _ => 0.0,
            })
        });
        motions.push((ROTATIONS[axis], about));
    }
    motions
}
