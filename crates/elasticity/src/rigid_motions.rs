//! The motions that strain nothing, whether supports forbid them all, and where a load turns a body
//! that may only turn.
//!
//! ```text
//! v(x) = e_i,   v(x) = e_j (x_k - c_k) - e_k (x_j - c_j)     D translations, D (D - 1)/2 rotations
//! A z                 what each motion z does to all coordinates of a piece
//! B z                 what it does to those that are held
//! free motions        B z = 0,  A z != 0
//!
//! a hinge  x = a + s w     V(t) = -sum f . R(t) (x - a) = -C cos t - S sin t,    t = atan2(S, C)
//! ```
//! `c` the middle of the piece. A body may come in pieces, which no element joins: each needs its own
//! supports. A straight bar has no rotation about itself, a point none at all, which is what the rank of
//! A takes off. Motions are named where they are along the axes or about them; of others only the
//! number is known.
//!
//! No dead load brings to rest what may shift, but one of two bodies that may turn: what hangs below its
//! hinge stays there. So a free translation is refused, and so is a rotation that the load does not
//! turn back; a body on a hinge, on two pins or on an edge is turned as a whole to where its load hangs
//! lowest, which is a good place for Newton's method to start from.

use nalgebra::{DMatrix, DVector, Vector3};
use stationary_calculus::array;

use crate::{DeadLoad, ElasticityError, Material, Solid};

/// Held coordinates that move less than this part of the largest motion do not hold.
const HOLDS: f64 = 1e-9;

/// A piece thinner than this part of its length has no thickness.
const THIN: f64 = 1e-6;

/// A moment that is this part of what the forces could have at their distances is none.
const BALANCED: f64 = 1e-9;

/// A piece of a body, and how it may turn.
struct Piece<const D: usize> {
    /// Its number, from 0, and how many there are.
    number: usize,
    count: usize,
    members: Vec<usize>,
    held: Vec<(usize, usize)>,
    free: FreeMotions<D>,
}

/// The rigid motions that the supports of a piece leave free.
struct FreeMotions<const D: usize> {
    count: usize,
    names: Vec<&'static str>,
    /// A point and a turning velocity of each, where none of them is a shift.
    turns: Option<Vec<Turn<D>>>,
}

/// `v(x) = v_a + w x (x - a)`.
struct Turn<const D: usize> {
    about: [f64; D],
    velocity: Vector3<f64>,
    shift: Vector3<f64>,
}

fn in_space<const D: usize>(x: &[f64; D]) -> Vector3<f64> {
    Vector3::from_fn(|i, _| if i < D { x[i] } else { 0.0 })
}

impl<const D: usize> Piece<D> {
    fn refused(&self) -> ElasticityError {
        ElasticityError::RigidMotions {
            piece: self.number + 1,
            pieces: self.count,
            vertex: self.members[0],
            count: self.free.count,
            names: self.free.names.join(", "),
        }
    }

    /// The axis of a body that may turn about it through any angle: a point and a unit vector.
    fn hinge(&self, positions: &[[f64; D]]) -> Option<(Vector3<f64>, Vector3<f64>)> {
        let [turn] = self.free.turns.as_deref()? else { return None };
        let axis = turn.velocity.normalize();
        // Where the velocity vanishes but for a shift along the axis, which no support allows here.
        let speed = turn.velocity.norm();
        let point = in_space(&turn.about) + axis.cross(&turn.shift) / speed;
        let size = self.members.iter().map(|&v| (in_space(&positions[v]) - point).norm());
        let size = size.fold(0.0, f64::max);
        let on_axis = self.held.iter().all(|&(vertex, component)| {
            let arm = in_space(&positions[vertex]) - point;
            let across = arm - axis * axis.dot(&arm);
            // A coordinate along the axis stays wherever its vertex is.
            axis[component].abs() > 1.0 - HOLDS || across.norm() <= THIN * size
        });
        (on_axis && axis.dot(&turn.shift).abs() <= HOLDS * speed * size).then_some((point, axis))
    }

    /// Turns the piece about its hinge to where its load hangs lowest.
    fn turn_down(
        &self,
        (point, axis): (Vector3<f64>, Vector3<f64>),
        load: &DeadLoad<D>,
        positions: &mut [[f64; D]],
    ) {
        let (mut along, mut across) = (0.0, 0.0);
        for &vertex in &self.members {
            let (f, arm) = (in_space(&load.forces()[vertex]), in_space(&positions[vertex]) - point);
            let arm = arm - axis * axis.dot(&arm);
            along += f.dot(&arm);
            across += f.dot(&axis.cross(&arm));
        }
        let (sine, cosine) = across.atan2(along).sin_cos();
        for &vertex in &self.members {
            let arm = in_space(&positions[vertex]) - point;
            let up = axis * axis.dot(&arm);
            let turned = point + up + (arm - up) * cosine + axis.cross(&arm) * sine;
            positions[vertex] = array(|i| turned[i]);
        }
    }
}

/// Refuses what may shift, and turns each piece that may turn about a hinge to where the load hangs
/// lowest.
pub(crate) fn hang<M, const N: usize, const D: usize, const R: usize, const Q: usize>(
    solid: &Solid<M, N, D, R, Q>,
    load: &DeadLoad<D>,
    q: &mut [f64],
) -> Result<(), ElasticityError>
where
    M: Material<D, R>,
{
    let mut positions = solid.freedoms().positions(q)?;
    let mut hinged = Vec::new();
    for piece in turning_pieces(solid, &positions)? {
        if let Some(hinge) = piece.hinge(&positions) {
            piece.turn_down(hinge, load, &mut positions);
            hinged.push(piece);
        }
    }
    if hinged.is_empty() {
        return Ok(());
    }
    q.copy_from_slice(&solid.freedoms().gathered(&positions)?);
    check_hanging(&hinged, &positions, load)
}

/// Refuses a rest in which a piece may turn without the load turning it back.
pub(crate) fn check_hung<M, const N: usize, const D: usize, const R: usize, const Q: usize>(
    solid: &Solid<M, N, D, R, Q>,
    load: &DeadLoad<D>,
    q: &[f64],
) -> Result<(), ElasticityError>
where
    M: Material<D, R>,
{
    let positions = solid.freedoms().positions(q)?;
    check_hanging(&turning_pieces(solid, &positions)?, &positions, load)
}

/// ```text
/// V'' = -sum f . w x (w x (x - a))        positive for every free turn w
/// ```
fn check_hanging<const D: usize>(
    pieces: &[Piece<D>],
    positions: &[[f64; D]],
    load: &DeadLoad<D>,
) -> Result<(), ElasticityError> {
    for piece in pieces {
        let Some(turns) = &piece.free.turns else { return Err(piece.refused()) };
        let mut most = 0.0;
        let mut stiffness = DMatrix::zeros(turns.len(), turns.len());
        for &vertex in &piece.members {
            let f = in_space(&load.forces()[vertex]);
            // Where a turn's own motion takes the vertex, to second order.
            for (a, one) in turns.iter().enumerate() {
                for (b, other) in turns.iter().enumerate() {
                    let arm = in_space(&positions[vertex]) - in_space(&one.about);
                    let moved = other.shift + other.velocity.cross(&arm);
                    stiffness[(a, b)] -= f.dot(&one.velocity.cross(&moved));
                    most += f.norm() * one.velocity.norm() * moved.norm();
                }
            }
        }
        let symmetric = (&stiffness + stiffness.transpose()) * 0.5;
        // A load of nothing turns nothing back.
        let least = symmetric.symmetric_eigenvalues().min();
        if least.is_nan() || least <= BALANCED * most {
            return Err(piece.refused());
        }
    }
    Ok(())
}

/// The pieces that may turn; an error where one may shift.
fn turning_pieces<M, const N: usize, const D: usize, const R: usize, const Q: usize>(
    solid: &Solid<M, N, D, R, Q>,
    positions: &[[f64; D]],
) -> Result<Vec<Piece<D>>, ElasticityError>
where
    M: Material<D, R>,
{
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
    let mut turning = Vec::new();
    for (number, (members, held)) in members.into_iter().zip(held).enumerate() {
        let free = free_motions(positions, &members, &held);
        let piece = Piece { number, count, members, held, free };
        if piece.free.count > 0 {
            if piece.free.turns.is_none() {
                return Err(piece.refused());
            }
            turning.push(piece);
        }
    }
    Ok(turning)
}

/// The motions of a piece that its held coordinates leave free.
fn free_motions<const D: usize>(
    positions: &[[f64; D]],
    members: &[usize],
    held: &[(usize, usize)],
) -> FreeMotions<D> {
    let (motions, middle, size) = motions(members.iter().map(|&vertex| positions[vertex]));
    let count = motions.len();
    let all = members.iter().flat_map(|&vertex| (0..D).map(move |c| (vertex, c)));
    let gram = all.fold(DMatrix::zeros(count, count), |mut gram: DMatrix<f64>, (vertex, c)| {
        let row = motions.iter().map(|(_, motion)| motion(&positions[vertex])[c]);
        let row = DVector::from_iterator(count, row);
        gram.ger(1.0, &row, &row, 1.0);
        gram
    });
    let largest = gram.diagonal().max();
    let moves = |square: f64| square > THIN * THIN * largest;
    let entry = |row: usize, motion: usize| {
        let (vertex, component) = held[row];
        motions[motion].1(&positions[vertex])[component]
    };
    let matrix = DMatrix::from_fn(held.len().max(count), count, |row, motion| {
        if row < held.len() { entry(row, motion) } else { 0.0 }
    });
    // Motions that the supports allow, and of those the ones that move anything.
    let decomposition = matrix.clone().svd(false, true);
    let values = &decomposition.singular_values;
    let allowed: Vec<DVector<f64>> = decomposition.v_t.map_or(Vec::new(), |rows| {
        let row = |k: usize| rows.row(k).transpose();
        (0..count).filter(|&k| values[k] <= HOLDS).map(row).collect()
    });
    let free = moving(&gram, &allowed, moves);
    let named = (0..count).filter(|&motion| {
        let still = matrix.column(motion).amax() <= HOLDS;
        still && moves_some(&motions[motion].1, positions, members)
    });
    let mut names: Vec<&str> = named.map(|motion| motions[motion].0).collect();
    names.truncate(free.len());
    if names.len() < free.len() {
        names.push("others that are not along an axis");
    }
    let turns = turns(&free, middle, size);
    FreeMotions { count: free.len(), names, turns }
}

/// Combinations of some motions that move the piece, as many as are independent.
fn moving(
    gram: &DMatrix<f64>,
    allowed: &[DVector<f64>],
    moves: impl Fn(f64) -> bool,
) -> Vec<DVector<f64>> {
    if allowed.is_empty() {
        return Vec::new();
    }
    let basis = DMatrix::from_columns(allowed);
    let eigen = (basis.transpose() * gram * &basis).symmetric_eigen();
    let columns = eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter());
    columns.filter(|(square, _)| moves(**square)).map(|(_, column)| &basis * column).collect()
}

/// The free motions as turns, or `None` where some combination of them is a shift.
fn turns<const D: usize>(
    free: &[DVector<f64>],
    about: [f64; D],
    size: f64,
) -> Option<Vec<Turn<D>>> {
    if free.is_empty() {
        return Some(Vec::new());
    }
    if D == 1 {
        return None;
    }
    let rotations = DMatrix::from_columns(free).rows(D, free[0].len() - D).into_owned();
    let independent = rotations.singular_values().iter().filter(|s| **s > HOLDS).count();
    if independent < free.len() {
        return None;
    }
    let turn = |z: &DVector<f64>| {
        let about_axis = |k: usize| match (D, k) {
            (2, 2) => z[D] / size,
            (2, _) => 0.0,
            _ => z[D + k] / size,
        };
        let shift = Vector3::from_fn(|k, _| if k < D { z[k] } else { 0.0 });
        Turn { about, velocity: Vector3::from_fn(|k, _| about_axis(k)), shift }
    };
    Some(free.iter().map(turn).collect())
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

/// Each motion with its name, scaled so that none moves the piece by more than about one; the middle
/// of the piece and its size.
fn motions<const D: usize>(
    positions: impl Iterator<Item = [f64; D]> + Clone,
) -> (Vec<(&'static str, Motion<D>)>, [f64; D], f64) {
    let extent: [[f64; 2]; D] = array(|c| {
        let coordinates = positions.clone().map(|x| x[c]);
        let low = coordinates.clone().fold(f64::INFINITY, f64::min);
        [low, coordinates.fold(f64::NEG_INFINITY, f64::max)]
    });
    let middle: [f64; D] = extent.map(|[low, high]| 0.5 * (low + high));
    let size = extent.iter().map(|[low, high]| high - low).fold(f64::MIN_POSITIVE, f64::max);
    let mut motions: Vec<(&'static str, Motion<D>)> = Vec::new();
    for c in 0..D {
        let along: Motion<D> = Box::new(move |_| array(|i| f64::from(i == c)));
        motions.push((TRANSLATIONS[c], along));
    }
    let axes: &[(usize, usize, usize)] = match D {
        1 => &[],
        2 => &[(2, 0, 1)],
        _ => &[(0, 1, 2), (1, 2, 0), (2, 0, 1)],
    };
    for &(axis, j, k) in axes {
        let about: Motion<D> = Box::new(move |x| {
            array(|i| match i {
                i if i == j => -(x[k] - middle[k]) / size,
                i if i == k => (x[j] - middle[j]) / size,
                _ => 0.0,
            })
        });
        motions.push((ROTATIONS[axis], about));
    }
    (motions, middle, size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Freedoms;

    fn piece<const D: usize>(positions: &[[f64; D]], held: Vec<(usize, usize)>) -> Piece<D> {
        let members: Vec<usize> = (0..positions.len()).collect();
        let free = free_motions(positions, &members, &held);
        Piece { number: 0, count: 1, members, held, free }
    }

    #[test]
    fn a_pendulum_hangs_below_its_pin_and_not_above_it() {
        let load = DeadLoad::new(&Freedoms::free(2).unwrap(), vec![[0.0, -1.0]; 2]).unwrap();
        for (place, hangs) in [([0.0, -1.0], true), ([0.0, 1.0], false), ([1.0, 0.0], false)] {
            let positions = [[0.0, 0.0], place];
            let pinned = piece(&positions, vec![(0, 0), (0, 1)]);
            assert_eq!(pinned.free.names, ["others that are not along an axis"]);
            let checked = check_hanging(&[pinned], &positions, &load);
            assert_eq!(checked.is_ok(), hangs, "{place:?}: {checked:?}");
        }
    }

    #[test]
    fn what_is_held_along_a_hinge_may_be_beside_it() {
        let o = [0.0, 0.0, 0.0];
        let positions = [o, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        let ends = [(0, 0), (0, 2), (1, 0), (1, 2)];
        let with = |beside: (usize, usize)| piece(&positions, [&ends[..], &[beside]].concat());
        let (point, axis) = with((2, 1)).hinge(&positions).unwrap();
        assert!((axis.y.abs() - 1.0).abs() < 1e-12 && axis.cross(&point).norm() < 1e-12);
        assert_eq!(with((2, 2)).free.count, 1, "it may shift along the hinge");
        assert!(with((2, 2)).hinge(&positions).is_none());
    }
}
