//! What stood: a step that changed nothing is not taken again.
//!
//! ```text
//! (q, p, x) -> (q, p, x)   under h and dv,   then again under the same h and dv
//! ```
//! `q` poses, `p` momenta, `x` impulses of contacts, `h` the step, `dv` the velocity increment. A step is a
//! function of these alone, so that one which has left all of them to the last bit leaves them again, with the
//! same report: time goes on, and nothing is looked for. Impulses are as they were where none was solved for.
//! Whatever changes a pose, a momentum, a force or the step is seen by comparing them.

use stationary_calculus::Potential;
use stationary_integrators::State;

use crate::error::check_time;
use crate::world::memory::Memory;
use crate::{ContactError, Dimension, World, WorldReport};

/// The last step, if it changed nothing.
#[derive(Debug, Default)]
pub(super) struct Standing {
    step: f64,
    q: Vec<f64>,
    p: Vec<f64>,
    increment: Vec<f64>,
    /// Whether forces were part of the increment, beside those of the potential.
    forced: bool,
    report: WorldReport,
    /// Whether it did; what is above is of no use otherwise.
    stood: bool,
}

impl Standing {
    /// Looks at a step's start again where something else may have changed.
    pub(super) fn forget(&mut self) {
        self.stood = false;
    }
}

impl<G: Dimension, P: Potential> World<G, P> {
    /// Takes a step from where the last one changed nothing; none where anything differs from it, under forces the
    /// velocity increment as well.
    pub(super) fn stand(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        forced: bool,
    ) -> Result<Option<WorldReport>, ContactError> {
        let World { standing, memory, .. } = self;
        let same = standing.stood
            && standing.step == h
            && memory.joints.rows() == 0
            && standing.q == state.q
            && standing.p == state.p.0
            && match forced {
                true => standing.increment == memory.increment.0,
                false => !standing.forced,
            };
        if !same {
            standing.stood = false;
            return Ok(None);
        }
        check_time(state.t + h)?;
        state.t += h;
        Ok(Some(standing.report))
    }

    /// Remembers a step from `state` to the next one of the memory, whose impulses are kept for steps of
    /// `before` seconds, if it changed nothing.
    pub(super) fn see_standing(
        &mut self,
        state: &State<Vec<f64>>,
        [before, h]: [f64; 2],
        forced: bool,
        report: &WorldReport,
    ) {
        let World { standing, memory, .. } = self;
        let Memory { next, increment, joints, .. } = memory;
        let solved = report.relaxed + report.solved + report.projected + report.impacts;
        standing.stood = solved == 0
            && before == h
            && joints.rows() == 0
            && state.q == next.q
            && state.p.0 == next.p.0;
        if standing.stood {
            standing.step = h;
            standing.forced = forced;
            standing.q.clone_from(&state.q);
            standing.p.clone_from(&state.p.0);
            standing.increment.clone_from(&increment.0);
            standing.report = *report;
        }
    }
}
