//! Rows of all laws that answer to one another, solved together: semismooth Newton to rounding, from what the guess,
//! Lemke's pivots, an interior point or sweeps lead to.
//!
//! The laws, and what is left of them, are those of `row_laws.rs`. Each of Newton's steps solves the equations of the
//! sets that it finds, linearized (`set_equations.rs`). Redundant rows make `W` singular: a small compliance keeps
//! their impulses where they are, and as what is left is measured without it, it has no say in what comes out. Sets
//! are judged where equalities keep what they ask for; where those of the guess lead nowhere, pivots find others
//! (`lemke.rs`), and where those go in circles, a way that chooses none (`interior_point.rs`). Coulomb's law has no
//! energy that all of this would lower, so that nothing is taken on trust: only impulses that leave less than those
//! before are kept.

use stationary_constraints::RowLaw;

use crate::coupled::interior_point::InteriorPoint;
use crate::coupled::lemke::Lemke;
use crate::coupled::reduced_rows::ReducedRows;
use crate::coupled::row_laws::{BlockLaw, Left, RowLaws};
use crate::coupled::set_equations::{Judging, SetEquations};

/// The most steps of Newton's method. Sets that change still after these go in circles.
const NEWTONS: usize = 12;
/// What is left twice, to this part of it, comes again and again.
const AGAIN: f64 = 1e-6;
/// As little compliance as leaves redundant rows a factor.
const FIRM: Judging = Judging { softness: 1e-13, pushing: 1.0, rubbing: 1.0 };
/// Tries of Newton's method. The compliance is at first far above the rounding of a factor, so that redundant rows
/// have one, and so small that few steps take off what it leaves; then less, where masses differ much.
const TRIES: [Judging; 3] = [
    Judging { softness: 1e-10, ..FIRM },
    FIRM,
    Judging { softness: 1e-15, pushing: 0.1, rubbing: 0.1 },
];
/// The same where pivots have found what pushes, and no more than that is to push.
const HELD: Judging = Judging { pushing: 0.0, ..FIRM };
/// What is left relative to the fastest rate before any impulse that is rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// The most rows for which Lemke's pivots are tried: their work grows with the cube as well, and there are many.
const PIVOTED: usize = 150;
/// The most multiplications of a factor of an interior point, which takes some hundred: those of 150 rows of which each
/// answers to each, or of a thousand in a chain. Moments double the rows of a contact.
const INSIDE_WORK: usize = 1_200_000;
const INSIDE_WORK_WITH_MOMENTS: usize = 8 * INSIDE_WORK;
/// The most pyramids in the place of cones: the friction that one finds turns the next.
const PYRAMIDS: usize = 6;
/// How far an interior point goes, as parts of where it begins, before Newton's method is tried from there.
const INSIDE: [f64; 6] = [1e-6, 1e-8, 1e-10, 1e-12, 1e-14, 1e-16];
/// The tries from each of these places, and compliances for the best of them: near an answer much compliance keeps
/// impulses of redundant rows from running off.
const FROM_INSIDE: [Judging; 2] = [FIRM, Judging { softness: 1e-7, ..FIRM }];
const SOFTNESSES: [f64; 6] = [1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-10];
/// The most rounds of these.
const SOFT_ROUNDS: usize = 6;
/// Sweeps that find the sets before each try of Newton's method, the first and the last: each try
/// begins with twice as many.
const FIRST_SWEEPS: usize = 16;
const LAST_SWEEPS: usize = 1024;

/// What led to impulses, from the cheapest to the dearest: each is tried where those before leave too much.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum RowsMethod {
    /// Newton's method from the guess, or a sparse factor where all are equalities.
    #[default]
    Newton,
    /// The same from the sets of Lemke's pivots.
    Pivots,
    /// The same from an interior point.
    InteriorPoint,
    /// The same between sweeps.
    Sweeps,
}

/// What a solution took and left.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Solved {
    pub(crate) left: Left,
    /// How many systems were solved.
    pub(crate) systems: usize,
    /// The dearest that was tried.
    pub(crate) method: RowsMethod,
}

/// Rows that are solved together, and the memory of solving them.
#[derive(Debug, Default)]
pub(crate) struct CoupledRows {
    rows: RowLaws,
    equations: SetEquations,
    /// The impulses that left the least so far, and those that are tried.
    best: Vec<f64>,
    tried: Vec<f64>,
    found: Vec<f64>,
    inside: Vec<f64>,
    lemke: Lemke,
    interior: InteriorPoint,
    reduced: ReducedRows,
    /// The rows of equalities.
    equal: Vec<usize>,
}

impl CoupledRows {
    /// Forgets all rows.
    pub(crate) fn clear(&mut self) {
        self.rows.clear();
    }

    /// Appends a block, by the rates of its rows before any impulse.
    pub(crate) fn push(&mut self, law: RowLaw, free: impl IntoIterator<Item = f64>) {
        self.rows.push(law.into(), free);
    }

    /// Appends the rows of moments that go so far as a part of the impulse of another row.
    #[cfg(any(feature = "2d", feature = "3d"))]
    pub(crate) fn push_disc(
        &mut self,
        normal: usize,
        part: f64,
        free: impl IntoIterator<Item = f64>,
    ) {
        self.rows.push(BlockLaw::Disc { normal, part }, free);
    }

    /// Takes the compliance between each row and those from it on, written in the place of zeros.
    pub(crate) fn couple(&mut self, write: impl FnMut(usize, &mut [f64])) {
        self.rows.couple(write);
        self.equations.forget();
    }

    /// Takes impulses to admissible ones.
    #[cfg(any(feature = "2d", feature = "3d"))]
    pub(crate) fn admit(&self, x: &mut [f64]) {
        self.rows.admit(x);
    }

    /// Solves the rows from a guess of their impulses until no more than `enough` (m/s) is left, or as
    /// far as they let themselves.
    pub(crate) fn solve(&mut self, x: &mut [f64], enough: f64) -> Solved {
        let mut solved = self.solve_by_sets(x, enough);
        let mut sweeps = FIRST_SWEEPS;
        let mut swept = std::mem::take(&mut self.found);
        while solved.left.worst() > enough && sweeps <= LAST_SWEEPS {
            solved.method = RowsMethod::Sweeps;
            swept.clear();
            swept.extend_from_slice(x);
            self.rows.sweep(&mut swept, sweeps);
            solved.systems += self.newton(&mut swept, enough).1;
            let left = self.rows.left(&swept);
            if left.worst() < solved.left.worst() {
                solved.left = left;
                x.copy_from_slice(&swept);
            }
            sweeps *= 2;
        }
        self.found = swept;
        solved
    }

    /// The same without sweeps.
    pub(crate) fn solve_by_sets(&mut self, x: &mut [f64], enough: f64) -> Solved {
        self.equal.clear();
        let equal = self.rows.blocks().filter(|(law, _)| *law == BlockLaw::Equality);
        self.equal.extend(equal.flat_map(|(_, rows)| rows));
        self.hold(x);
        let (mut least, mut systems) = self.newton_by(TRIES[0], x, enough);
        let mut method = RowsMethod::Newton;
        if least > enough {
            method = RowsMethod::Pivots;
            let pivoted = self.pivot(x, enough);
            (least, systems) = (pivoted.0, systems + pivoted.1);
        }
        if least > enough {
            method = RowsMethod::InteriorPoint;
            let tried = self.go_inside(x, enough);
            (least, systems) = (tried.0, systems + tried.1);
        }
        for by in &TRIES[1..] {
            if least > enough {
                let tried = self.newton_by(*by, x, enough);
                (least, systems) = (tried.0, systems + tried.1);
            }
        }
        Solved { left: self.rows.left(x), systems, method }
    }

    /// Gives equalities the impulses by which they keep what they ask for beside those of the others: sets are
    /// judged by rates.
    fn hold(&mut self, x: &mut [f64]) {
        if !self.equal.is_empty() {
            self.rows.find_rates(x);
            self.equations.stop(&self.rows, &self.equal, TRIES[0].softness, x);
        }
    }

    /// The same by sets that Lemke's pivots find, again and again: the first edges of each pyramid are along the
    /// friction that the one before has found. Says what is left, and how many systems were solved.
    fn pivot(&mut self, x: &mut [f64], enough: f64) -> (f64, usize) {
        let (mut least, mut solved) = (self.rows.left(x).worst(), 0);
        let others = self.rows.rows() - self.equal.len();
        if others == 0 || others > PIVOTED {
            return (least, solved);
        }
        let mut found = std::mem::take(&mut self.found);
        found.clear();
        found.extend_from_slice(x);
        for _ in 0..PYRAMIDS {
            self.rows.find_rates(&found);
            self.reduced.find(&self.rows);
            self.reduced.turn(&found, &self.rows.rates);
            if !self.lemke.pivot(&mut self.reduced) {
                break;
            }
            self.reduced.put_back(&mut found);
            self.rows.admit(&mut found);
            self.hold(&mut found);
            let (mut left, systems) = self.newton_by(HELD, &mut found, enough);
            solved += systems;
            if left > enough {
                let tried = self.newton_by(FIRM, &mut found, enough);
                (left, solved) = (tried.0, solved + tried.1);
            }
            let last = left <= enough || left > 0.5 * least;
            if left < least {
                least = left;
                x.copy_from_slice(&found);
            }
            if last {
                break;
            }
        }
        self.found = found;
        (least, solved)
    }

    /// The same by what an interior point leads to. Says what is left, and how many systems were solved.
    fn go_inside(&mut self, x: &mut [f64], enough: f64) -> (f64, usize) {
        let (mut least, mut solved) = (self.rows.left(x).worst(), 0);
        let rolls = self.rows.laws.iter().any(|law| law.normals() == 0);
        let most = if rolls { INSIDE_WORK_WITH_MOMENTS } else { INSIDE_WORK };
        if self.rows.work() > most || !self.interior.start(&self.rows) {
            return (least, solved);
        }
        let mut from = std::mem::take(&mut self.inside);
        from.resize(x.len(), 0.0);
        // From place after place on the way,
        for part in INSIDE {
            let (systems, there) = self.interior.go_on(&self.rows, part, &mut from);
            solved += systems;
            for by in FROM_INSIDE {
                if least > enough {
                    solved += self.improve(&from, by, enough, x, &mut least);
                }
            }
            if least <= enough || !there {
                break;
            }
        }
        // then from the best that these tries come to, as long as that gains something.
        for _ in 0..SOFT_ROUNDS {
            let before = least;
            for softness in SOFTNESSES {
                if least > enough {
                    from.copy_from_slice(x);
                    let by = Judging { softness, ..FIRM };
                    solved += self.improve(&from, by, enough, x, &mut least);
                }
            }
            if least <= enough || least > 0.5 * before {
                break;
            }
        }
        self.inside = from;
        (least, solved)
    }

    /// Newton's method from a place, kept where it leaves less than the `least` so far; says how many systems it took.
    fn improve(
        &mut self,
        from: &[f64],
        by: Judging,
        enough: f64,
        x: &mut [f64],
        least: &mut f64,
    ) -> usize {
        let mut found = std::mem::take(&mut self.found);
        found.clear();
        found.extend_from_slice(from);
        let (left, systems) = self.newton_by(by, &mut found, enough);
        if left < *least {
            *least = left;
            x.copy_from_slice(&found);
        }
        self.found = found;
        systems
    }

    /// Changes impulses until no more than rounding is left, if it can, and by other sets where the
    /// first lead to more than `enough` (m/s); says what is left, and how many systems it solved.
    fn newton(&mut self, x: &mut [f64], enough: f64) -> (f64, usize) {
        let (mut least, mut solved) = (f64::INFINITY, 0);
        for by in TRIES {
            if least > enough {
                let tried = self.newton_by(by, x, enough);
                (least, solved) = (tried.0, solved + tried.1);
            }
        }
        (least, solved)
    }

    fn newton_by(&mut self, by: Judging, x: &mut [f64], enough: f64) -> (f64, usize) {
        let CoupledRows { rows, equations, best, tried, equal, .. } = self;
        let fastest = rows.free.iter().fold(0.0_f64, |most, rate| most.max(rate.abs()));
        let mut least = rows.left(x).worst();
        best.clear();
        best.extend_from_slice(x);
        tried.clear();
        tried.extend_from_slice(x);
        let (mut solved, mut seen) = (0, [0.0; NEWTONS]);
        while solved < NEWTONS && least > ROUNDING * fastest {
            let before = least;
            solved += 1;
            if !equations.step(rows, tried, by) {
                break;
            }
            rows.admit(tried);
            let left = rows.left(tried).worst();
            if left < least {
                least = left;
                best.copy_from_slice(tried);
            }
            let again = |seen: &f64| (seen - left).abs() <= AGAIN * left;
            if least > enough && seen[..solved - 1].iter().any(again) {
                break;
            }
            seen[solved - 1] = left;
            // Without joints all of the steps are taken: what stops comes to rest. With them as many as gain something.
            if before <= enough && left > 0.5 * before && !equal.is_empty() {
                break;
            }
        }
        x.copy_from_slice(best);
        (least, solved)
    }

    /// How far impulses are from meeting the laws, by rates that are known better than by the compliance.
    #[cfg(any(feature = "2d", feature = "3d"))]
    pub(crate) fn left_at(&mut self, x: &[f64], rates: impl Iterator<Item = f64>) -> Left {
        self.take_rates(rates);
        self.rows.left_at_rates(x)
    }

    /// One of Newton's steps from such rates; says whether it was taken.
    #[cfg(any(feature = "2d", feature = "3d"))]
    pub(crate) fn refine(&mut self, x: &mut [f64], rates: impl Iterator<Item = f64>) -> bool {
        self.take_rates(rates);
        let taken = self.equations.step(&self.rows, x, FIRM);
        if taken {
            self.rows.admit(x);
        }
        taken
    }

    #[cfg(any(feature = "2d", feature = "3d"))]
    fn take_rates(&mut self, rates: impl Iterator<Item = f64>) {
        self.rows.rates.clear();
        self.rows.rates.extend(rates);
    }
}
