//! Bodies of springs between all pairs of points, some of their coordinates held: how many rigid
//! motions are left is a matter of ranks.
//!
//! ```text
//! number = rank C - rank (rows of C that are held)        C the candidates at all vertices
//! ```

use nalgebra::DMatrix;
use stationary_calculus::{Covector, DiagonalMetric, FIXED, Metric, Vector};
use stationary_modal::{Linearized, RigidMotions};

use super::prescribed::Quadratic;
use crate::{Draw, Verdict};

pub(super) fn trial(draw: &mut Draw) -> Verdict {
    match draw.between(1, 3) {
        1 => body::<1>(draw),
        2 => body::<2>(draw),
        _ => body::<3>(draw),
    }
}

fn body<const D: usize>(draw: &mut Draw) -> Verdict {
    let vertices = draw.between(if D == 1 { 1 } else { 2 }, 7);
    let size = if draw.chance(0.3) { draw.log_uniform(1e-6, 1e6) } else { 1.0 };
    let origin: [f64; D] = std::array::from_fn(|_| draw.symmetric() * 10.0 * size);
    let place = |draw: &mut Draw| -> [f64; D] {
        std::array::from_fn(|c| origin[c] + size * draw.symmetric())
    };
    let mut places: Vec<[f64; D]> = (0..vertices).map(|_| place(draw)).collect();
    let on_a_line = draw.chance(0.15);
    if on_a_line {
        let ends = [places[0], places[vertices - 1]];
        for x in &mut places {
            let l = draw.unit();
            *x = std::array::from_fn(|c| ends[0][c] + l * (ends[1][c] - ends[0][c]));
        }
    }
    let held = held::<D>(draw, vertices, on_a_line);
    let apart = |a: &[f64; D], b: &[f64; D]| (0..D).any(|c| (a[c] - b[c]).abs() > 1e-2 * size);
    if (0..vertices).any(|b| (0..b).any(|a| !apart(&places[a], &places[b]))) {
        // Springs of no length hold nothing.
        return Verdict::not_judged("points on each other");
    }
    let mut freedoms = vec![[FIXED; D]; vertices];
    let mut n = 0;
    for (freedom, _) in
        freedoms.as_flattened_mut().iter_mut().zip(held.as_flattened()).filter(|(_, held)| !**held)
    {
        *freedom = n;
        n += 1;
    }
    draw.note(format!("{D} dimensions, line {on_a_line}, places {places:?}, held {held:?}"));
    if n == 0 {
        return Verdict::due();
    }
    let candidates = candidates(&places);
    let flags = held.as_flattened();
    let chosen: Vec<usize> = (0..flags.len()).filter(|&i| flags[i]).collect();
    let (Some(all), Some(taken)) = (rank(&candidates), rank(&candidates.select_rows(&chosen)))
    else {
        return Verdict::not_judged("ranks in doubt");
    };
    let expected = all - taken;
    let potential = springs(draw, &places, &freedoms, n);
    let masses = (0..n).map(|_| draw.log_uniform(0.1, 10.0)).collect();
    let metric = DiagonalMetric::new(masses).expect("positive masses");
    let q = potential.q0.clone();
    let system = match Linearized::at(&metric, &potential, &q, 0.0) {
        Ok(system) => system,
        Err(_) if potential.blocks.iter().all(|(_, b)| b.iter().all(|x| *x == 0.0)) => {
            return Verdict::due();
        }
        Err(error) => return Verdict::refused(error),
    };
    let rigid = match RigidMotions::of_freedoms(&system, &places, &freedoms) {
        Ok(rigid) => rigid,
        Err(error) => return Verdict::refused(error),
    };
    // Points nearly in a row, of which some are held, are held sideways by next to nothing.
    let stiffness = DMatrix::from_fn(n, n, |i, j| {
        potential.times(&(0..n).map(|k| f64::from(k == j)).collect::<Vec<_>>())[i]
    });
    let efforts = stiffness.symmetric_eigenvalues() / system.scale();
    if efforts.iter().any(|effort| (1e-12..1e-7).contains(&effort.abs())) {
        return Verdict::not_judged("efforts in doubt");
    }
    if rigid.len() != expected {
        return Verdict::wrong(format!("{} rigid motions instead of {expected}", rigid.len()));
    }
    judge(&metric, &potential, system.scale(), system, &rigid)
}

/// Which components are held: none, whole vertices, an axis, single ones.
fn held<const D: usize>(draw: &mut Draw, vertices: usize, on_a_line: bool) -> Vec<[bool; D]> {
    let mut held = vec![[false; D]; vertices];
    if on_a_line {
        // Points on a line that are held give way sideways at no cost: no rigid motion, but as free.
        return held;
    }
    match draw.below(4) {
        0 => {}
        1 => held[..draw.between(1, vertices)].iter_mut().for_each(|held| *held = [true; D]),
        2 => {
            let axis = draw.below(D);
            held.iter_mut().for_each(|held| held[axis] = true);
        }
        _ => {
            for _ in 0..draw.between(1, 2 * D) {
                let (vertex, axis) = (draw.below(vertices), draw.below(D));
                held[vertex][axis] = true;
            }
        }
    }
    held
}

/// Translations and rotations about the middle, in units of the body's size.
fn candidates<const D: usize>(places: &[[f64; D]]) -> DMatrix<f64> {
    let mut columns: Vec<Vec<f64>> = (0..D)
        .map(|c| places.iter().flat_map(|_| (0..D).map(move |d| f64::from(c == d))).collect())
        .collect();
    let middle: [f64; D] =
        std::array::from_fn(|c| places.iter().map(|x| x[c]).sum::<f64>() / places.len() as f64);
    let far = places.iter().flatten().zip(middle.iter().cycle()).map(|(x, m)| (x - m).abs());
    let far = far.fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    for b in 0..D {
        for c in b + 1..D {
            let turn = |x: &[f64; D]| {
                let mut r = [0.0; D];
                r[b] = (x[c] - middle[c]) / far;
                r[c] = (middle[b] - x[b]) / far;
                r
            };
            columns.push(places.iter().flat_map(turn).collect());
        }
    }
    DMatrix::from_fn(places.len() * D, columns.len(), |i, j| columns[j][i])
}

/// The rank, where no singular value leaves it in doubt.
fn rank(matrix: &DMatrix<f64>) -> Option<usize> {
    if matrix.nrows() == 0 {
        return Some(0);
    }
    let values = matrix.singular_values();
    let sure = values.iter().all(|value| *value > 1e-3 || *value < 1e-9);
    sure.then(|| values.iter().filter(|value| **value > 1e-3).count())
}

/// `1/2 k (u . (d_a - d_b))^2` for each pair.
fn springs<const D: usize>(
    draw: &mut Draw,
    places: &[[f64; D]],
    freedoms: &[[usize; D]],
    n: usize,
) -> Quadratic {
    let mut q0 = vec![0.0; n];
    for (&freedom, x) in freedoms.as_flattened().iter().zip(places.as_flattened()) {
        if freedom != FIXED {
            q0[freedom] = *x;
        }
    }
    // Every freedom is in the pattern, also those that no spring reaches.
    let mut blocks: Vec<(Vec<usize>, Vec<f64>)> = (0..n).map(|i| (vec![i], vec![0.0])).collect();
    for b in 0..places.len() {
        for a in 0..b {
            let along: [f64; D] = std::array::from_fn(|c| places[a][c] - places[b][c]);
            let length = along.iter().map(|x| x * x).sum::<f64>().sqrt();
            if length == 0.0 {
                continue;
            }
            let k = draw.log_uniform(0.3, 3.0);
            let ends = [(a, 1.0), (b, -1.0)];
            let row: Vec<(usize, f64)> = ends
                .iter()
                .flat_map(|&(v, sign)| {
                    (0..D).map(move |c| (freedoms[v][c], sign * along[c] / length))
                })
                .filter(|(freedom, _)| *freedom != FIXED)
                .collect();
            let entries =
                row.iter().flat_map(|(_, x)| row.iter().map(move |(_, y)| k * x * y)).collect();
            if !row.is_empty() {
                blocks.push((row.iter().map(|(freedom, _)| *freedom).collect(), entries));
            }
        }
    }
    Quadratic { q0, blocks }
}

/// With the rigid motions as modes of zero, they must be orthonormal and cost nothing.
fn judge(
    metric: &DiagonalMetric<Vec<f64>>,
    potential: &Quadratic,
    scale: f64,
    mut system: Linearized<'_, DiagonalMetric<Vec<f64>>, Quadratic>,
    rigid: &RigidMotions,
) -> Verdict {
    let n = potential.q0.len();
    if rigid.len() == n {
        return Verdict::due();
    }
    let modes = match system.lowest(n - rigid.len(), rigid).and_then(|m| m.with_rigid(rigid)) {
        Ok(modes) => modes,
        Err(error) => return Verdict::refused(error),
    };
    let columns: Vec<&[f64]> = (0..n).map(|i| modes.vector(i).expect("a mode").0).collect();
    let mut verdict = Verdict::due();
    for (i, column) in columns.iter().enumerate() {
        let mut p = vec![0.0; n];
        metric.flat(Vector(column), Covector(&mut p));
        for (j, other) in columns.iter().enumerate() {
            let product: f64 = p.iter().zip(*other).map(|(p, x)| p * x).sum();
            let off = (product - f64::from(i == j)).abs();
            verdict = verdict.and(Verdict::of(off, 1e-8, "products in the mass"));
        }
        let value = modes.values()[i];
        let cost: f64 = potential.times(column).iter().zip(*column).map(|(f, x)| f * x).sum();
        verdict =
            verdict.and(Verdict::of((cost - value).abs(), 1e-8 * scale, "the energy of a mode"));
    }
    verdict
}
