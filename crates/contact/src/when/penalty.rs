//! The penalty potential of gaps: a spring that pushes and never pulls.
//!
//! ```text
//! V = k/2 sum_i min(g_i, 0)^2,    dV = k sum min(g_i, 0) dg_i                               (11.3)
//! d2V = k sum_(g_i < 0) (dg_i^T dg_i + g_i d2g_i)           jumps where a gap closes (errata 11.3)
//! omega = sqrt(k d),   d = dg M^-1 dg^T,   h omega < 2       the stable step of Stormer-Verlet
//! depth <= u / omega,   time of contact pi / omega           of an impact at the speed u
//! ```
//! `k` N/m, `g` gaps in metres. A hit at speed u sinks in by u/omega, so that the rigid limit is
//! reached like `k^-1/2`, and a larger k asks for a smaller step. Elastic only. Source: notes 11.3.

use stationary_calculus::{Covector, Potential, Sink};
use stationary_constraints::Constraint;

use crate::{ContactError, ContactRows, Impact, Inequality, InverseMass};

/// One-sided springs on gaps that do not change with time.
#[derive(Clone, Debug)]
pub struct OneSidedPenalty<K> {
    gaps: Inequality<K>,
    stiffness: f64,
}

impl<K: Constraint> OneSidedPenalty<K> {
    /// Springs of this stiffness, N/m.
    ///
    /// # Errors
    /// [`ContactError::Stiffness`] unless it is positive and finite.
    pub fn new(gaps: Inequality<K>, stiffness: f64) -> Result<Self, ContactError> {
        if stiffness > 0.0 && stiffness.is_finite() {
            return Ok(OneSidedPenalty { gaps, stiffness });
        }
        Err(ContactError::Stiffness(stiffness))
    }

    /// The angular frequency of each of these contacts on its own, rad/s.
    ///
    /// # Errors
    /// [`ContactError::Size`] for a contact named twice or not there; [`ContactError::Immovable`]
    /// for a gap that nothing movable closes; [`ContactError::NoSuchFreedom`] and
    /// [`ContactError::NonFinite`] of its differential.
    pub fn frequencies(
        &self,
        mass: &InverseMass,
        q: &[f64],
        contacts: &[usize],
    ) -> Result<Vec<f64>, ContactError> {
        let mut sorted = contacts.to_vec();
        sorted.sort_unstable();
        let rows = self.gaps.rows(0.0, q, &sorted);
        let impact = Impact::new(rows, mass, vec![1.0; contacts.len()])?;
        let place = |contact: &usize| sorted.partition_point(|other| other < contact);
        let frequency = |contact| (self.stiffness * impact.compliance(place(contact))).sqrt();
        Ok(contacts.iter().map(frequency).collect())
    }

    /// The gaps that are closed, and the differentials of those.
    fn closed(&self, q: &[f64]) -> (Vec<(usize, f64)>, ContactRows) {
        let gaps = self.gaps.gaps(0.0, q);
        let closed: Vec<_> = gaps.into_iter().enumerate().filter(|&(_, g)| g < 0.0).collect();
        let wanted: Vec<usize> = closed.iter().map(|&(i, _)| i).collect();
        let rows = self.gaps.rows(0.0, q, &wanted);
        (closed, rows)
    }
}

impl<K: Constraint> Potential for OneSidedPenalty<K> {
    fn dim(&self) -> usize {
        self.gaps.0.dim()
    }

    fn energy(&self, q: &[f64]) -> f64 {
        let square = |g: f64| g.min(0.0).powi(2);
        0.5 * self.stiffness * self.gaps.gaps(0.0, q).into_iter().map(square).sum::<f64>()
    }

    fn add_differential(&self, q: &[f64], mut dv: Covector<&mut [f64]>) {
        let (closed, rows) = self.closed(q);
        for (row, (_, gap)) in closed.into_iter().enumerate() {
            rows.add_row(row, self.stiffness * gap, dv.view_mut());
        }
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        // Open gaps too, with zeros: blocks come in the same order at every configuration.
        let gaps = self.gaps.gaps(0.0, q);
        let all: Vec<usize> = (0..gaps.len()).collect();
        let rows = self.gaps.rows(0.0, q, &all);
        for (contact, gap) in gaps.iter().enumerate() {
            let (freedoms, values): (Vec<usize>, Vec<f64>) = rows.row(contact).unzip();
            let entry = |a: &f64, b: &f64| if *gap < 0.0 { self.stiffness * a * b } else { 0.0 };
            let block: Vec<f64> =
                values.iter().flat_map(|a| values.iter().map(move |b| entry(a, b))).collect();
            hessian.add_symmetric(&freedoms, &block);
        }
        let lambda: Vec<f64> = gaps.iter().map(|gap| self.stiffness * gap.min(0.0)).collect();
        if self.gaps.0.add_hessian(0.0, q, &lambda, hessian).is_err() {
            hessian.add_symmetric(&[0], &[f64::NAN]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Balls, Wall};
    use stationary_calculus::{DiagonalMetric, System, assert_derivatives};
    use stationary_integrators::{Integrator, State, StormerVerlet};

    fn balls(stiffness: f64) -> OneSidedPenalty<Balls<2>> {
        let wall = Wall { normal: [0.0, 1.0], offset: 0.0 };
        let balls = Balls::new(vec![0.5, 0.5], vec![wall]).unwrap();
        OneSidedPenalty::new(Inequality(balls), stiffness).unwrap()
    }

    #[test]
    fn its_derivatives_are_right_where_gaps_are_open_and_where_they_are_closed() {
        for q in [[0.0, 0.4, 0.8, 0.7], [0.0, 0.6, 2.0, 0.7], [0.0, 0.3, 0.5, 0.2]] {
            assert_derivatives(&balls(3.0), &q);
        }
    }

    /// One ball pressed against a wall by nothing: half an oscillation, out at the speed it came
    /// in.
    fn rebound(stiffness: f64, h: f64) -> f64 {
        let wall = Wall { normal: [1.0], offset: 0.0 };
        let balls = Balls::new(vec![1.0], vec![wall]).unwrap();
        let penalty = OneSidedPenalty::new(Inequality(balls), stiffness).unwrap();
        let system = System::new(DiagonalMetric::new(vec![1.0]).unwrap(), penalty).unwrap();
        let mut state = State::new(vec![1.0 + 0.3 * h], Covector(vec![-1.0]));
        let mut verlet = StormerVerlet::new(&system).unwrap();
        for _ in 0..10_000 {
            verlet.step(&mut state, h).unwrap();
            if state.q[0] > 1.0 && state.p.0[0] > 0.0 {
                break;
            }
        }
        state.p.0[0]
    }

    #[test]
    fn a_resolved_penalty_gives_the_speed_back_and_one_beyond_its_border_gains() {
        let omega = 100.0_f64;
        assert!((rebound(omega * omega, 0.01 / omega) - 1.0).abs() < 1e-2);
        assert!(rebound(omega * omega, 2.5 / omega) > 1.5, "one kick more than turns it round");
        let inverse = InverseMass::of(&DiagonalMetric::new([4.0, 4.0, 1.0, 1.0]).unwrap()).unwrap();
        let q = [0.0, 0.4, 0.8, 0.7];
        let omega = balls(16.0).frequencies(&inverse, &q, &[0, 2]).unwrap();
        assert!((omega[0] - 2.0).abs() < 1e-15, "k/m of a wall");
        assert!((omega[1] - 20.0_f64.sqrt()).abs() < 1e-14, "k (1/m1 + 1/m2) of two balls");
        let turned = balls(16.0).frequencies(&inverse, &q, &[2, 0]).unwrap();
        assert_eq!(turned, [omega[1], omega[0]]);
    }

    #[test]
    fn a_stiffness_that_is_not_positive_is_refused() {
        let gaps = Inequality(Balls::<1>::new(vec![1.0], vec![]).unwrap());
        let error = OneSidedPenalty::new(gaps, -1.0).unwrap_err();
        assert_eq!(error, ContactError::Stiffness(-1.0));
    }
}
