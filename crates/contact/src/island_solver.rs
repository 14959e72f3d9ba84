//! One island of contacts, solved: projected exactly where that is enough, else settled by sweeps.
//!
//! ```text
//! x = (J.n, J.t1, J.t2),   the projection or sweeps,   J = x_n n + x_1 t1 + x_2 t2
//! ```
//! `J` impulses on second bodies in world axes (N s), from those that are guessed; `n t1 t2` normal
//! and tangents, made once for contacts that share a normal. See [`Unpushed`] and [`Sweeps`].

use nalgebra::Vector3;

use crate::exact_normals::Unpushed;
use crate::rigid_contact::{Placed, RigidContact, Six};
use crate::sweeps::{Goal, Island, Sweeps};
use crate::unsettled_parts::UnsettledParts;
use crate::{ContactError, ContactPoint, TouchingReport};

/// The contacts of one island, packed, and their impulses.
#[derive(Debug, Default)]
pub(crate) struct IslandSolver {
    contacts: Vec<RigidContact>,
    tangents: Vec<[Vector3<f64>; 2]>,
    x: Vec<[f64; 3]>,
    sweeps: Sweeps,
    parts: UnsettledParts,
}

/// What is to be met, and how far.
#[derive(Clone, Copy)]
pub(crate) struct Conditions<'a> {
    pub(crate) unpushed: Unpushed<'a>,
    pub(crate) placed: &'a [Placed],
    /// What may be left, m/s.
    pub(crate) settled: f64,
    /// What may be left of what nearly rests, m/s, if these bodies hardly move.
    pub(crate) fine: Option<f64>,
    /// The most sweeps.
    pub(crate) sweeps: usize,
}

/// What hardly moves and is off by no more than so many times what may be left will soon rest, if
/// only its impulses are good enough to be kept.
const NEAR: f64 = 30.0;

impl IslandSolver {
    /// So many bodies before any impulse.
    pub(crate) fn start(&mut self, bodies: usize) {
        self.sweeps.start(bodies);
    }

    /// Solves the contacts of these numbers between these bodies, from and into their impulses;
    /// says what is left of the normal conditions and of Coulomb's law, m/s.
    pub(crate) fn solve(
        &mut self,
        [members, bodies]: [&[usize]; 2],
        conditions: Conditions,
        pushes: &mut [Vector3<f64>],
        report: &mut TouchingReport,
    ) -> Result<[f64; 2], ContactError> {
        let Conditions { unpushed, settled, .. } = conditions;
        self.pack(members, conditions, pushes)?;
        let (x, sweeps) = (&mut self.x, &mut self.sweeps);
        let island = Island { contacts: &self.contacts, bodies };
        sweeps.push(island, x);
        let mut left = sweeps.residuals(island, x);
        let near = left.iter().all(|left| *left <= NEAR * settled);
        let fine = conditions.fine.filter(|_| near);
        let goal = fine.unwrap_or(settled);
        let met = |left: &[f64; 2]| left.iter().all(|left| *left <= goal);
        let rubs = |(contact, x): (&RigidContact, &[f64; 3])| contact.speed(&[0.0, x[1], x[2]]);
        let mut rubs = self.contacts.iter().zip(x.iter()).map(rubs);
        let smooth = left[1] <= settled && rubs.all(|speed| speed <= settled);
        if !met(&left) && smooth && unpushed.project(members, island, x, sweeps)? {
            report.projected += 1;
            left = sweeps.residuals(island, x);
        }
        if !met(&left) {
            let most = conditions.sweeps;
            let [relaxed, solved] = match fine {
                // Sweeps leave what they change slowly, and it would move what is to rest.
                Some(change) => sweeps.alternate(island, x, Goal { change, alone: 0.0 }, most),
                None => self.parts.settle(sweeps, island, x, settled, most),
            };
            report.relaxed += relaxed;
            report.solved += solved;
            left = sweeps.residuals(island, x);
        }
        for ((&i, [first, second]), [n, s, t]) in members.iter().zip(&self.tangents).zip(x) {
            pushes[i] = unpushed.points[i].normal * *n + first * *s + second * *t;
        }
        Ok(left)
    }

    /// The scaled change of a body's velocity.
    pub(crate) fn change(&self, body: usize) -> &Six {
        &self.sweeps.w[body]
    }

    fn pack(
        &mut self,
        members: &[usize],
        conditions: Conditions,
        pushes: &[Vector3<f64>],
    ) -> Result<(), ContactError> {
        let Unpushed { points, bias, .. } = conditions.unpushed;
        self.contacts.clear();
        self.tangents.clear();
        self.x.clear();
        let mut last: Option<&ContactPoint> = None;
        for &i in members {
            let (point, push) = (&points[i], &pushes[i]);
            let across = match (last, self.tangents.last()) {
                (Some(last), Some(&across)) if last.normal == point.normal => across,
                _ => point.tangents(),
            };
            last = Some(point);
            self.contacts.push(RigidContact::new(i, point, across, bias[i], conditions.placed)?);
            self.tangents.push(across);
            self.x.push([push.dot(&point.normal), push.dot(&across[0]), push.dot(&across[1])]);
        }
        Ok(())
    }
}
