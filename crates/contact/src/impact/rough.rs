//! Impact with Coulomb's friction and restitution, all approaching contacts at once.
//!
//! ```text
//! compression   min T over lambda >= 0 with beta kept,  min T over |beta| <= mu lambda with lambda
//!               kept, by turns                                             v= from v-
//! restitution   lambda <- (1 + s c) lambda,  min T over |beta| <= mu lambda      v+
//! T+ - T- <= (1 + c) <v=, v= - v->_M - (1 - c^2)/2 |v= - v-|_M^2 <= 0       one c, s = 1
//! ```
//! `T` kinetic energy (J), `lambda` normal and `beta` friction impulses (N s), `mu` friction, `c`
//! restitution: the ratio of the impulse after the deepest compression to that before it (Poisson's).
//! At the end of compression `<v=, v= - v->_M = lambda.u_n + beta.u_t`, where the first product is
//! zero and friction opposes what still slides, so that energy never grows; the last minimum only
//! lowers it. Contacts whose restitutions differ could gain: `s` is halved until they do not. Without
//! friction this is the pass of generalized reflections. Newton's ratio of velocities in the place of
//! Poisson's gains energy (Kane and Levinson 1985), as a test shows.
//!
//! Compression is Coulomb's law of all rows of an island at once ([`CoupledRows`]); in islands of many
//! rows, and where that does not lead to it, the two minima by turns. Where the turns have not converged at their bound the pass says so; its impulses are in the cone
//! all the same, and where they would give energy it is one without friction.
//! Source: Glocker and Pfeiffer 1995 (Poisson's law with friction); Kaufman, Sueda, James and Pai
//! 2008 (staggered projections); the bound and the last minimum are ours.

use stationary_calculus::Vector;
use stationary_constraints::RowLaw;

use crate::coupled::coupled_rows::CoupledRows;
use crate::impact::projection::{Islands, all, project_with};
use crate::{ContactError, Impact};

/// Islands of no more rows are compressed at once, by Newton's method; larger ones by turns.
const ROWS: usize = 300;
/// Turns of compression after which it is taken as it is.
const TURNS: usize = 100;
/// Sweeps over the contacts in one friction projection: of a turn, and the last.
const TURN_SWEEPS: usize = 10;
const SWEEPS: usize = 100;
/// Changes of impulses, as velocities, relative to the fastest relative velocity, that end both, and
/// with which compression counts as converged.
const SETTLED: f64 = 1e-9;
const CONVERGED: f64 = 1e-6;
/// Energy gained that is rounding, relative to the terms of its sum.
const ENERGY_ROUNDING: f64 = 1e-11;
/// How often restitution is halved before there is none.
const HALVINGS: i32 = 40;

/// Contacts that approach, and as many rows across each as there are directions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RoughContacts<'a> {
    pub(crate) normal: &'a Impact,
    pub(crate) tangent: &'a Impact,
    pub(crate) friction: &'a [f64],
}

/// What a pass gave.
#[derive(Debug)]
pub(crate) struct RoughPass {
    /// Normal impulses, one a contact, and friction impulses, one a row across, N s.
    pub(crate) normal: Vec<f64>,
    pub(crate) friction: Vec<f64>,
    /// Whether compression converged.
    pub(crate) converged: bool,
}

impl RoughContacts<'_> {
    /// Changes a velocity by compression and restitution.
    pub(crate) fn reflect(&self, v: &mut Vector<Vec<f64>>) -> Result<RoughPass, ContactError> {
        let before = v.clone();
        let settled = SETTLED * self.speed(v.view());
        let mut islands = Islands::default();
        islands.find(self.normal, &all(self.normal.len()));
        let directions = self.tangent.len() / self.normal.len();
        let small = islands.iter().all(|island| (1 + directions) * island.len() <= ROWS);
        let at_once = small.then(|| self.compress_at_once(&islands, &before, settled, v));
        let mut rough = match at_once.filter(|pass| pass.converged) {
            Some(pass) => pass,
            None => self.compress(&before, settled, v)?,
        };
        if let Some(pass) = self.restore(&rough, &before, settled, v) {
            return Ok(pass);
        }
        // Without friction, compression is a projection, and gives no energy.
        let none = vec![0.0; self.normal.len()];
        rough.normal = self.project(&before, &none, v)?;
        rough.friction.fill(0.0);
        rough.converged = false;
        Ok(self.restore(&rough, &before, settled, v).unwrap_or(rough))
    }

    /// Restitution after compression; none where even compression alone gives energy.
    fn restore(
        &self,
        compressed: &RoughPass,
        before: &Vector<Vec<f64>>,
        settled: f64,
        v: &mut Vector<Vec<f64>>,
    ) -> Option<RoughPass> {
        let restitution = self.normal.restitution();
        let rubs = compressed.friction.iter().any(|&beta| beta != 0.0);
        for halving in 0..=HALVINGS {
            let part = if halving == HALVINGS { 0.0 } else { 0.5_f64.powi(halving) };
            let whole = |i: usize| 1.0 + part * restitution[i];
            let normal: Vec<f64> =
                compressed.normal.iter().enumerate().map(|(i, lambda)| whole(i) * lambda).collect();
            let mut friction = compressed.friction.clone();
            for i in 0..self.normal.len() {
                self.across(i).for_each(|row| friction[row] *= whole(i));
            }
            v.copy_from(before.view());
            normal.iter().enumerate().for_each(|(i, &l)| self.normal.push(i, l, v.view_mut()));
            friction.iter().enumerate().for_each(|(i, &b)| self.tangent.push(i, b, v.view_mut()));
            if rubs {
                self.rub(&normal, settled, SWEEPS, &mut friction, v);
            }
            if !self.gains(&normal, &friction, before, v) {
                return Some(RoughPass { normal, friction, converged: compressed.converged });
            }
        }
        None
    }

    /// The impulses of compression, all rows of an island at once.
    fn compress_at_once(
        &self,
        islands: &Islands,
        before: &Vector<Vec<f64>>,
        settled: f64,
        v: &mut Vector<Vec<f64>>,
    ) -> RoughPass {
        let mut pass = RoughPass {
            normal: vec![0.0; self.normal.len()],
            friction: vec![0.0; self.tangent.len()],
            converged: true,
        };
        v.copy_from(before.view());
        let mut coupled = CoupledRows::default();
        let mut change = Vector(vec![0.0; self.normal.freedoms()]);
        for island in islands.iter() {
            // The rows of each contact, its normal first.
            let rows: Vec<(&Impact, usize)> = island
                .iter()
                .flat_map(|&i| {
                    let across = self.across(i).map(|row| (self.tangent, row));
                    [(self.normal, i)].into_iter().chain(across)
                })
                .collect();
            coupled.clear();
            let block = rows.len() / island.len();
            for (&i, rows) in island.iter().zip(rows.chunks_exact(block)) {
                let rate = |&(impact, row): &(&Impact, usize)| {
                    impact.relative_velocity(row, before.view())
                };
                coupled.push(RowLaw::Cone(self.friction[i]), rows.iter().map(rate));
            }
            coupled.couple(|i, compliances| {
                let (impact, row) = rows[i];
                change.0.fill(0.0);
                impact.push(row, 1.0, change.view_mut());
                for (&(impact, row), w) in rows[i..].iter().zip(compliances) {
                    *w = impact.relative_velocity(row, change.view());
                }
            });
            let mut x = vec![0.0; rows.len()];
            let left = coupled.solve(&mut x, settled).left;
            pass.converged &= left.worst() * SETTLED <= settled * CONVERGED;
            for (&(impact, row), &x) in rows.iter().zip(&x) {
                impact.push(row, x, v.view_mut());
            }
            for (&i, x) in island.iter().zip(x.chunks_exact(block)) {
                pass.normal[i] = x[0];
                self.across(i).zip(&x[1..]).for_each(|(row, &x)| pass.friction[row] = x);
            }
        }
        pass
    }

    /// The impulses of compression, by turns.
    fn compress(
        &self,
        before: &Vector<Vec<f64>>,
        settled: f64,
        v: &mut Vector<Vec<f64>>,
    ) -> Result<RoughPass, ContactError> {
        let mut pass = RoughPass {
            normal: vec![0.0; self.normal.len()],
            friction: vec![0.0; self.tangent.len()],
            converged: false,
        };
        for _ in 0..TURNS {
            v.copy_from(before.view());
            let friction = pass.friction.iter().enumerate();
            friction.for_each(|(row, &beta)| self.tangent.push(row, beta, v.view_mut()));
            let now = v.clone();
            let next = self.project(&now, &pass.normal, v)?;
            let moved =
                |(i, (a, b)): (usize, (&f64, &f64))| (a - b).abs() * self.normal.compliance(i);
            let moved = next.iter().zip(&pass.normal).enumerate().map(moved).fold(0.0, f64::max);
            pass.normal = next;
            let rubbed = self.rub(&pass.normal, settled, TURN_SWEEPS, &mut pass.friction, v);
            let changed = moved.max(rubbed);
            pass.converged = changed * SETTLED <= settled * CONVERGED;
            if changed <= settled {
                break;
            }
        }
        Ok(pass)
    }

    /// The normal impulses of the inelastic projection.
    fn project(
        &self,
        from: &Vector<Vec<f64>>,
        guess: &[f64],
        v: &mut Vector<Vec<f64>>,
    ) -> Result<Vec<f64>, ContactError> {
        let contacts = all(self.normal.len());
        let none = vec![0.0; contacts.len()];
        v.copy_from(from.view());
        Ok(project_with(self.normal, &contacts, &none, guess, v.view_mut())?.impulses)
    }

    /// Whether impulses give energy, by more than rounding.
    fn gains(
        &self,
        normal: &[f64],
        friction: &[f64],
        before: &Vector<Vec<f64>>,
        after: &Vector<Vec<f64>>,
    ) -> bool {
        let (mut sum, mut terms) = (0.0, 0.0);
        for (impact, impulses) in [(self.normal, normal), (self.tangent, friction)] {
            for (i, impulse) in impulses.iter().enumerate() {
                for v in [before, after] {
                    let term = 0.5 * impulse * impact.relative_velocity(i, v.view());
                    (sum, terms) = (sum + term, terms + term.abs());
                }
            }
        }
        sum > ENERGY_ROUNDING * terms
    }

    /// The fastest of the relative velocities, m/s.
    fn speed(&self, v: Vector<&[f64]>) -> f64 {
        let fastest = |impact: &Impact| {
            (0..impact.len()).map(|i| impact.relative_velocity(i, v).abs()).fold(0.0, f64::max)
        };
        fastest(self.normal).max(fastest(self.tangent))
    }

    /// The rows across a contact.
    fn across(&self, contact: usize) -> std::ops::Range<usize> {
        let directions = self.tangent.len() / self.normal.len();
        contact * directions..(contact + 1) * directions
    }

    /// The friction projection: contact after contact to the nearest point of its disc. Says how
    /// far the first sweep moved, m/s.
    fn rub(
        &self,
        lambda: &[f64],
        settled: f64,
        sweeps: usize,
        beta: &mut [f64],
        v: &mut Vector<Vec<f64>>,
    ) -> f64 {
        let mut first = 0.0_f64;
        for sweep in 0..sweeps {
            let mut moved = 0.0_f64;
            for (i, &normal) in lambda.iter().enumerate() {
                let d: f64 = self.across(i).map(|row| self.tangent.compliance(row)).sum();
                let mut wanted = [0.0; 2];
                for (row, wanted) in self.across(i).zip(&mut wanted) {
                    *wanted = beta[row] - self.tangent.relative_velocity(row, v.view()) / d;
                }
                let (radius, length) = (self.friction[i] * normal, wanted[0].hypot(wanted[1]));
                let scale = if length > radius { radius / length } else { 1.0 };
                for (row, wanted) in self.across(i).zip(wanted) {
                    let change = scale * wanted - beta[row];
                    self.tangent.push(row, change, v.view_mut());
                    beta[row] += change;
                    moved = moved.max(change.abs() * d);
                }
            }
            if sweep == 0 {
                first = moved;
            }
            if moved <= settled {
                break;
            }
        }
        first
    }
}
