//! Equalities alone, by the solver that `constraints` has for them: sparse, of any number and any redundancy.
//!
//! ```text
//! J M^-1 J^T x = w - J v          x the shortest where equations depend on each other
//! ```
//! `M` diagonal. A chain of joints takes work that grows with its links, not with their cube.

use stationary_calculus::{Covector, DiagonalMetric, Vector};
use stationary_constraints::{
    Constraint, Linear, Multipliers, Redundancy, Solver, SparseDiagonal, VelocityRows,
};

/// Solutions with one factor: each but the first takes off what rounding of those before has left.
const SOLUTIONS: usize = 4;

/// The impulses of these rows; nothing where their rank is not clear or nothing answers to one of them.
pub(crate) fn solve(
    rows: &VelocityRows,
    own: &[usize],
    inverse_masses: &[f64],
    v: &[f64],
) -> Option<Vec<f64>> {
    // Freedoms that no row touches, or that nothing moves, stay out of it.
    let moved = |row: usize| rows.row(row).filter(|&(freedom, _)| inverse_masses[freedom] > 0.0);
    let mut freedoms: Vec<usize> = own.iter().flat_map(|&row| moved(row)).map(|(f, _)| f).collect();
    freedoms.sort_unstable();
    freedoms.dedup();
    let mut equations = Vec::with_capacity(own.len());
    for &row in own {
        let mut entries: Vec<(usize, f64)> = Vec::new();
        for (freedom, value) in moved(row) {
            let place = freedoms.binary_search(&freedom).ok()?;
            match entries.iter_mut().find(|entry| entry.0 == place) {
                Some(entry) => entry.1 += value,
                None => entries.push((place, value)),
            }
        }
        equations.push((entries, 0.0));
    }
    let masses = freedoms.iter().map(|&freedom| inverse_masses[freedom].recip()).collect();
    let lack: Vec<f64> = own.iter().map(|&row| -rows.lack(row, Vector(v))).collect();
    impulses(equations, masses, &lack)
}

fn impulses(
    equations: Vec<(Vec<(usize, f64)>, f64)>,
    masses: Vec<f64>,
    lack: &[f64],
) -> Option<Vec<f64>> {
    let lines = Linear::new(equations).ok()?;
    let q = vec![0.0; lines.dim()];
    let inverse: Vec<f64> = masses.iter().map(|mass| mass.recip()).collect();
    let metric = DiagonalMetric::new(masses).ok()?;
    let choice = SparseDiagonal(Redundancy::LeastNorm);
    let mut solver = Solver::<Vec<f64>>::analyse(&choice, &metric, &lines, 0.0, &q).ok()?;
    solver.prepare(&metric, &lines, 0.0, &q).ok()?;
    let (mut x, mut left) = (vec![0.0; lack.len()], lack.to_vec());
    let mut least = f64::INFINITY;
    for _ in 0..SOLUTIONS {
        let mut change = left.clone();
        solver.solve(&mut change).ok()?;
        let tried: Vec<f64> = x.iter().zip(&change).map(|(x, change)| x + change).collect();
        let mut motion = Covector(vec![0.0; inverse.len()]);
        solver.add_pulled_back(-1.0, &tried, motion.view_mut());
        motion.0.iter_mut().zip(&inverse).for_each(|(motion, inverse)| *motion *= inverse);
        left.copy_from_slice(lack);
        solver.add_along(Vector(&motion.0), &mut left);
        let worst = left.iter().fold(0.0, |most: f64, left| most.max(left.abs()));
        if worst >= least {
            break;
        }
        (x, least) = (tried, worst);
    }
    Some(x)
}
