//! Rows of joints and of contacts, solved together by what answers to their impulses.
//!
//! ```text
//! v+ = v + A^-1 J^T x,   u = J v+ - w          the laws of the rows between x and u
//! W = J A^-1 J^T                               dense, in islands of rows that answer to one another
//! ```
//! `x` impulses (N s), `v` velocities (m/s, rad/s), `w` what the rows ask for, `A` what answers
//! ([`Response`]). An equality gives any impulse, a limit pushes only, what is bounded gives at most its
//! bound, a contact stays in Coulomb's cone ([`RowLaw`]). Islands share no freedom that an impulse
//! reaches; each is solved to rounding as far as an answer is found, by Newton's method on the active, sticking and
//! sliding sets, and where those do not come by pivots, an interior point and sweeps ([`RowsMethod`]). What is
//! left is reported. A row along which nothing gives way has no impulse.
//!
//! The work grows with the cube of an island's rows, and there is a bound on them; an island of equalities
//! alone between masses that are not coupled is solved by `constraints` instead, however many there are
//! (`equalities.rs`). Source: Moreau 1988; Stewart and Trinkle 1996.

use std::ops::Range;

use stationary_calculus::{SizeError, Vector};
use stationary_constraints::{RowLaw, VelocityRows};

use crate::coupled::coupled_rows::{CoupledRows, RowsMethod};
use crate::coupled::equalities::Equalities;
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
    /// The dearest method that an island asked for.
    pub method: RowsMethod,
    /// Whether no more is left than was asked for.
    pub settled: bool,
    /// How far equalities, limits and normals are from their laws, m/s or rad/s.
    pub residual: f64,
    /// How far friction of joints and contacts is from its law, m/s or rad/s.
    pub friction_residual: f64,
}

/// Solves rows, again and again: the memory is kept, and where the rows of an island of equalities meet.
#[derive(Debug, Default)]
pub struct RowsSolver {
    /// What unit impulses of the rows change of the velocities.
    lifted: ContactRows,
    entries: Vec<(usize, f64)>,
    answer: Vec<(usize, f64)>,
    inverse_masses: Vec<f64>,
    islands: RowIslands,
    coupled: CoupledRows,
    /// Of the islands of equalities, in their order.
    equalities: Vec<Equalities>,
    /// The rows of an island, and their impulses.
    own: Vec<usize>,
    x: Vec<f64>,
    /// Rows that were solved as equalities alone.
    held: Vec<usize>,
    found: Vec<f64>,
    /// The first and the last freedom of each row of an island.
    reaches: Vec<[usize; 2]>,
    change: Vec<f64>,
}

impl RowsSolver {
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
    pub fn solve(
        &mut self,
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
        self.lift(rows, response)?;
        let diagonal = response.inverse_masses(&mut self.inverse_masses);
        let mut report = RowsReport { settled: true, ..RowsReport::default() };
        let RowsSolver {
            lifted,
            islands,
            coupled,
            equalities,
            own,
            x,
            held,
            found,
            reaches,
            change,
            ..
        } = self;
        let inverse_masses = diagonal.then_some(&self.inverse_masses[..]);
        held.clear();
        found.clear();
        found.resize(impulses.len(), 0.0);
        change.clear();
        change.resize(v.0.len(), 0.0);
        islands.find(rows, lifted);
        let mut equal_islands = 0;
        for blocks in islands.each() {
            own.clear();
            own.extend(blocks.iter().flat_map(|block| block.rows.clone()));
            x.clear();
            x.extend(own.iter().map(|&row| impulses[row]));
            report.islands += 1;
            if let Some(inverse_masses) = inverse_masses
                && blocks.iter().all(|block| block.law == RowLaw::Equality)
            {
                equal_islands += 1;
                if equalities.len() < equal_islands {
                    equalities.push(Equalities::default());
                }
                if equalities[equal_islands - 1].solve(rows, own, inverse_masses, v.0, x).is_some()
                {
                    own.iter().zip(&*x).for_each(|(&row, &x)| found[row] = x);
                    report.solved += 1;
                    held.extend_from_slice(own);
                    continue;
                }
            }
            if own.len() > COUPLED_ROWS {
                let (what, expected) = ("the rows of an island", COUPLED_ROWS);
                return Err(SizeError { what, expected, got: own.len() }.into());
            }
            coupled.clear();
            for block in blocks {
                let lacks = block.rows.clone().map(|row| rows.lack(row, Vector(&*v.0)));
                coupled.push(block.law, lacks);
            }
            let reach = |freedoms: &mut dyn Iterator<Item = (usize, f64)>| {
                freedoms.fold([usize::MAX, 0], |[low, high], (f, _)| [low.min(f), high.max(f)])
            };
            reaches.clear();
            reaches.extend(own.iter().map(|&row| reach(&mut rows.row(row))));
            coupled.couple(|i, compliances| {
                lifted.row(own[i]).for_each(|(freedom, value)| change[freedom] += value);
                let [low, high] = reach(&mut lifted.row(own[i]));
                for ((&row, of), w) in own[i..].iter().zip(&reaches[i..]).zip(compliances) {
                    if of[0] <= high && of[1] >= low {
                        *w = rows.row(row).map(|(freedom, value)| value * change[freedom]).sum();
                    }
                }
                lifted.row(own[i]).for_each(|(freedom, _)| change[freedom] = 0.0);
            });
            let solved = coupled.solve(x, tolerance);
            own.iter().zip(&*x).for_each(|(&row, &x)| found[row] = x);
            report.solved += solved.systems;
            report.method = report.method.max(solved.method);
            report.settled &= solved.left.worst() <= tolerance;
            report.residual = report.residual.max(solved.left.normal);
            report.friction_residual = report.friction_residual.max(solved.left.friction);
        }
        for (row, &x) in found.iter().enumerate().filter(|(_, x)| **x != 0.0) {
            lifted.row(row).for_each(|(freedom, value)| v.0[freedom] += value * x);
        }
        let left = held.iter().map(|&row| rows.lack(row, Vector(&*v.0)).abs()).fold(0.0, f64::max);
        // What nothing can be done about is told: friction without an impulse lacks nothing.
        let stays = islands.fixed.iter().map(|&(law, row)| {
            let lack = rows.lack(row, Vector(&*v.0));
            match law {
                RowLaw::Equality => lack.abs(),
                RowLaw::Limit | RowLaw::Cone(_) => (-lack).max(0.0),
                RowLaw::Bounded(_) => 0.0,
            }
        });
        let left = stays.fold(left, f64::max);
        report.settled &= left <= tolerance;
        report.residual = report.residual.max(left);
        impulses.copy_from_slice(found);
        Ok(report)
    }

    /// Finds what unit impulses of the rows change of the velocities.
    fn lift(
        &mut self,
        rows: &VelocityRows,
        response: &mut impl Response,
    ) -> Result<(), ContactError> {
        let RowsSolver { lifted, entries, answer, .. } = self;
        lifted.clear();
        for row in 0..rows.rows() {
            entries.clear();
            entries.extend(rows.row(row));
            answer.clear();
            response.respond(entries, answer);
            if let Some(index) = answer.iter().position(|(_, value)| !value.is_finite()) {
                let (what, value) = ("the answer to an impulse", answer[index].1);
                return Err(ContactError::NonFinite { what, index, value });
            }
            lifted.push(answer.iter().copied());
        }
        lifted.check(response.freedoms())
    }
}

/// A block of rows, and its island by the order of their first blocks.
#[derive(Clone, Debug)]
struct Block {
    island: usize,
    law: RowLaw,
    /// The lowest freedom that its impulses reach: what is joined to its neighbours alone makes a band.
    lowest: usize,
    rows: Range<usize>,
}

/// Blocks that share freedoms that impulses reach; those that reach none belong to no island, and are kept apart.
#[derive(Debug, Default)]
struct RowIslands {
    blocks: Vec<Block>,
    /// The first row and the law of what no impulse changes.
    fixed: Vec<(RowLaw, usize)>,
    groups: Groups,
    /// The island of the freedoms that a group stands for.
    island_of: Vec<usize>,
}

impl RowIslands {
    fn find(&mut self, rows: &VelocityRows, lifted: &ContactRows) {
        let RowIslands { blocks, fixed, groups, island_of } = self;
        let reached =
            |rows: Range<usize>| rows.flat_map(|row| lifted.row(row)).map(|(freedom, _)| freedom);
        let count = reached(0..lifted.len()).max().map_or(0, |most| most + 1);
        groups.reset(count);
        for (_, rows) in rows.blocks() {
            let mut reached = reached(rows);
            if let Some(first) = reached.next() {
                reached.for_each(|freedom| groups.join(first, freedom));
            }
        }
        island_of.clear();
        island_of.resize(count, usize::MAX);
        blocks.clear();
        fixed.clear();
        let mut islands = 0;
        for (law, rows) in rows.blocks() {
            let Some(first) = reached(rows.clone()).next() else {
                fixed.push((law, rows.start));
                continue;
            };
            let island = &mut island_of[groups.find(first)];
            if *island == usize::MAX {
                *island = islands;
                islands += 1;
            }
            let lowest = reached(rows.clone()).min().unwrap_or(first);
            blocks.push(Block { island: *island, law, lowest, rows });
        }
        blocks.sort_unstable_by_key(|block| (block.island, block.lowest, block.rows.start));
    }

    /// The blocks of each island.
    fn each(&self) -> impl Iterator<Item = &[Block]> {
        self.blocks.chunk_by(|a, b| a.island == b.island)
    }
}
