//! Rows of joints and of contacts, solved together by what answers to their impulses.
//!
//! ```text
//! v+ = v + A^-1 J^T x,   u = J v+ - w          the laws of the rows between x and u
//! W = J A^-1 J^T                               dense, in islands of rows that answer to one another
//! ```
//! `x` impulses (N s), `v` velocities (m/s, rad/s), `w` what the rows ask for, `A` what answers
//! ([`Response`]). An equality gives any impulse, a limit pushes only, what is bounded gives at most its
//! bound, a contact stays in Coulomb's cone ([`RowLaw`]). Islands share no freedom that an impulse
//! reaches; each is solved to rounding where its laws have an answer, by Newton's method on the
//! active, sticking and sliding sets, and where those do not come by Lemke's pivots. What is left is reported.
//! A row along which nothing gives way has no impulse.
//!
//! The work grows with the cube of an island's rows, and there is a bound on them; an island of equalities
//! alone between masses that are not coupled is solved by `constraints` instead, however many there are
//! (`equalities.rs`). Source: Moreau 1988; Stewart and Trinkle 1996.

use stationary_calculus::{SizeError, Vector};
use stationary_constraints::{RowLaw, VelocityRows};

use crate::coupled::coupled_rows::CoupledRows;
use crate::coupled::equalities;
use crate::coupled::response::Response;
use crate::error::check_finite;
use crate::impact::inverse_mass::Groups;
use crate::{ContactError, ContactRows};

/// The most rows of an island that has other laws than equalities: a dense system of as many takes about a second.
pub const COUPLED_ROWS: usize = 1_000;

/// What a solution took and left.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RowsReport {
    /// Islands of rows that answer to one another.
    pub islands: usize,
    /// Dense systems solved.
    pub solved: usize,
    /// Whether no more is left than was asked for.
    pub settled: bool,
    /// How far equalities, limits and normals are from their laws, m/s or rad/s.
    pub residual: f64,
    /// How far friction of joints and contacts is from its law, m/s or rad/s.
    pub friction_residual: f64,
}

/// Solves rows: changes a velocity by their impulses, from and into which `impulses` are guessed and
/// written, one a row; no more than `tolerance` (m/s) is to be left.
///
/// # Errors
/// [`ContactError::Rows`] for a row that names a freedom that does not answer;
/// [`ContactError::Size`] for another number of velocities than of freedoms, of impulses than of rows,
/// and for an island of more rows than [`COUPLED_ROWS`] that are not all equalities;
/// [`ContactError::NonFinite`] for velocities, impulses and what answers;
/// [`ContactError::Settling`] for a tolerance that is negative or no number.
/// Velocity and impulses are then as they were.
pub fn solve_rows(
    rows: &VelocityRows,
    response: &mut impl Response,
    tolerance: f64,
    impulses: &mut [f64],
    v: Vector<&mut [f64]>,
) -> Result<RowsReport, ContactError> {
    if tolerance.is_nan() || tolerance < 0.0 {
        return Err(ContactError::Settling(tolerance));
    }
    rows.check(response.freedoms())?;
    SizeError::check("velocities", response.freedoms(), v.0.len())?;
    SizeError::check("the guessed impulses", rows.rows(), impulses.len())?;
    check_finite("the velocity", v.0)?;
    check_finite("a guessed impulse", impulses)?;
    let lifted = lifted(rows, response)?;
    let mut report = RowsReport { settled: true, ..RowsReport::default() };
    let mut found = vec![0.0; impulses.len()];
    let mut coupled = CoupledRows::default();
    let mut change = vec![0.0; v.0.len()];
    // Rows that were solved as equalities alone.
    let mut held = Vec::new();
    let masses = response.inverse_masses();
    for blocks in islands(rows, &lifted) {
        let own: Vec<usize> = blocks.iter().flat_map(|(_, rows)| rows.clone()).collect();
        report.islands += 1;
        let equal = blocks.iter().all(|(law, _)| *law == RowLaw::Equality);
        if equal
            && let Some(masses) = &masses
            && let Some(x) = equalities::solve(rows, &own, masses, v.0)
        {
            own.iter().zip(&x).for_each(|(&row, &x)| found[row] = x);
            report.solved += 1;
            held.extend(own);
            continue;
        }
        if own.len() > COUPLED_ROWS {
            let (what, expected) = ("the rows of an island", COUPLED_ROWS);
            return Err(SizeError { what, expected, got: own.len() }.into());
        }
        coupled.clear();
        for (law, block) in &blocks {
            coupled.push(*law, block.clone().map(|row| rows.lack(row, Vector(&*v.0))));
        }
        let mut last = None;
        coupled.couple(|i, j| {
            if last.replace(i) != Some(i) {
                change.fill(0.0);
                lifted.row(own[i]).for_each(|(freedom, value)| change[freedom] += value);
            }
            rows.row(own[j]).map(|(freedom, value)| value * change[freedom]).sum()
        });
        let mut x: Vec<f64> = own.iter().map(|&row| impulses[row]).collect();
        let (left, solved) = coupled.solve(&mut x, tolerance);
        own.iter().zip(&x).for_each(|(&row, &x)| found[row] = x);
        report.solved += solved;
        report.settled &= left.worst() <= tolerance;
        report.residual = report.residual.max(left.normal);
        report.friction_residual = report.friction_residual.max(left.friction);
    }
    for (row, &x) in found.iter().enumerate().filter(|(_, x)| **x != 0.0) {
        lifted.row(row).for_each(|(freedom, value)| v.0[freedom] += value * x);
    }
    let left = held.iter().map(|&row| rows.lack(row, Vector(&*v.0)).abs()).fold(0.0, f64::max);
    report.settled &= left <= tolerance;
    report.residual = report.residual.max(left);
    impulses.copy_from_slice(&found);
    Ok(report)
}

/// What unit impulses of the rows change of the velocities.
fn lifted(rows: &VelocityRows, response: &mut impl Response) -> Result<ContactRows, ContactError> {
    let mut lifted = ContactRows::new();
    let (mut entries, mut change) = (Vec::new(), Vec::new());
    for row in 0..rows.rows() {
        entries.clear();
        entries.extend(rows.row(row));
        change.clear();
        response.respond(&entries, &mut change);
        if let Some(index) = change.iter().position(|(_, value)| !value.is_finite()) {
            let (what, value) = ("the answer to an impulse", change[index].1);
            return Err(ContactError::NonFinite { what, index, value });
        }
        lifted.push(change.iter().copied());
    }
    lifted.check(response.freedoms())?;
    Ok(lifted)
}

/// A block's law and its rows.
type Block = (RowLaw, std::ops::Range<usize>);

/// Blocks that share freedoms that impulses reach; those that reach none belong to no island.
fn islands(rows: &VelocityRows, lifted: &ContactRows) -> Vec<Vec<Block>> {
    let freedoms = |block: &Block| {
        block.1.clone().flat_map(|row| lifted.row(row).map(|(freedom, _)| freedom)).collect()
    };
    let blocks: Vec<(Block, Vec<usize>)> =
        rows.blocks().map(|block| (block.clone(), freedoms(&block))).collect();
    let most = blocks.iter().flat_map(|(_, reached)| reached).max().map_or(0, |most| most + 1);
    let mut groups = Groups::new(most);
    for (_, reached) in &blocks {
        reached.iter().for_each(|&freedom| groups.join(reached[0], freedom));
    }
    let mut island_of = vec![usize::MAX; most];
    let mut islands: Vec<Vec<Block>> = Vec::new();
    for (block, reached) in blocks {
        let Some(root) = reached.first().map(|&freedom| groups.find(freedom)) else { continue };
        if island_of[root] == usize::MAX {
            island_of[root] = islands.len();
            islands.push(Vec::new());
        }
        islands[island_of[root]].push(block);
    }
    islands
}
