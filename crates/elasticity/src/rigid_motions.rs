//! The motions that strain nothing, and whether supports forbid them all.
//!
//! ```text
//! v(x) = e_i,   v(x) = e_j (x_k - c_k) - e_k (x_j - c_j)     D translations, D (D - 1)/2 rotations
//! A z                 what each motion z does to all coordinates of a piece
//! B z                 what it does to those that are held
//! free motions        rank A - rank B
//! ```
//! `c` the middle of the piece. A body may come in pieces, which no element joins: each needs its own
//! supports. A straight bar has no rotation about itself, a point none at all, which is what the rank of
//! A takes off. Motions are named where they are along the axes or about them; of others only the
//! number is known.

use nalgebra::{DMatrix, DVector};

use crate::{ElasticityError, Material, Solid};

/// Held coordinates that move less than this part of the largest motion do not hold.
const HOLDS: f64 = 1e-9;

/// A piece thinner than this part of its length has no thickness.
const THIN: f64 = 1e-6;

/// An error that names the rigid motions that are free, of the first piece that has some.
pub(crate) fn check_held<M, const N: usize, const D: usize, const R: usize, const Q: usize>(
    solid: &Solid<M, N, D, R, Q>,
    q: &[f64],
) -> Result<(), ElasticityError>
where
    M: Material<D, R>,
{
    let positions = solid.freedoms().positions(q)?;
    let pieces = solid.pieces();
    let count = pieces.iter().max().map_or(0, |last| last + 1);
    let mut members = vec![Vec::new(); count];
    for (vertex, &piece) in pieces.iter().enumerate() {
        members[piece].push(vertex);
    }
    let mut held = vec![Vec::new(); count];
    for &(vertex, component) in solid.freedoms().held() {
        held[pieces[vertex]].push((vertex, component));
    }
    for (piece, (members, held)) in members.iter().zip(&held).enumerate() {
        let (free, names) = free_motions(&positions, members, held);
        if free > 0 {
            let names = names.join(", ");
            let vertex = members[0];
            let piece = piece + 1;
            return Err(ElasticityError::RigidMotions {
                piece,
                pieces: count,
                vertex,
                count: free,
                names,
            });
        }
    }
    Ok(())
}

/// How many motions of a piece its held coordinates leave free, and their names.
fn free_motions<const D: usize>(
    positions: &[[f64; D]],
    members: &[usize],
    held: &[(usize, usize)],
) -> (usize, Vec<&'static str>) {
    let motions = motions(members.iter().map(|&vertex| positions[vertex]));
    let count = motions.len();
    let all = members.iter().flat_map(|&vertex| (0..D).map(move |c| (vertex, c)));
    let gram = all.fold(DMatrix::zeros(count, count), |mut gram: DMatrix<f64>, (vertex, c)| {
        let row = motions.iter().map(|(_, motion)| motion(&positions[vertex])[c]);
        let row = DVector::from_iterator(count, row);
        gram.ger(1.0, &row, &row, 1.0);
        gram
    });
    let largest = gram.diagonal().max();
    let moving = gram.symmetric_eigenvalues();
    let moving = moving.iter().filter(|&&square| square > THIN * THIN * largest).count();
    let entry = |row: usize, motion: usize| {
        let (vertex, component) = held[row];
        motions[motion].1(&positions[vertex])[component]
    };
    let matrix = DMatrix::from_fn(held.len().max(count), count, |row, motion| {
        if row < held.len() { entry(row, motion) } else { 0.0 }
    });
    let forbidden = matrix.clone().singular_values().iter().filter(|s| **s > HOLDS).count();
    let free = moving.saturating_sub(forbidden);
    let named = (0..count).filter(|&motion| {
        let still = matrix.column(motion).amax() <= HOLDS;
        still && moves_some(&motions[motion].1, positions, members)
    });
    let mut names: Vec<&str> = named.map(|motion| motions[motion].0).collect();
    names.truncate(free);
    if names.len() < free {
        names.push("others that are not along an axis");
    }
    (free, names)
}

/// Whether a motion moves any of the vertices.
fn moves_some<const D: usize>(
    motion: &Motion<D>,
    positions: &[[f64; D]],
    members: &[usize],
) -> bool {
    members.iter().any(|&vertex| motion(&positions[vertex]).iter().any(|x| x.abs() > THIN))
}

type Motion<const D: usize> = Box<dyn Fn(&[f64; D]) -> [f64; D]>;

const TRANSLATIONS: [&str; 3] = ["translation x", "translation y", "translation z"];
const ROTATIONS: [&str; 3] = ["rotation about x", "rotation about y", "rotation about z"];

/// Each motion with its name, scaled so that none moves the piece by more than about one.
fn motions<const D: usize>(
    positions: impl Iterator<Item = [f64; D]> + Clone,
) -> Vec<(&'static str, Motion<D>)> {
    let extent: [[f64; 2]; D] = std::array::from_fn(|c| {
        let coordinates = positions.clone().map(|x| x[c]);
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
