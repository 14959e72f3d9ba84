//! A mechanical system as a first-order one.
//!
//! ```text
//! y = (q, p),      q' = M^-1 p,      p' = -dV(q) + F(t, q, M^-1 p)
//!
//! df/dy = [  0          M^-1    ]
//!         [ -d2V - K   -C M^-1  ]
//! ```
//! `q` the configuration (n), `p` the momentum (n), `M` the metric, `V` the potential in joules,
//! `F` a force with stiffness `K = -dF/dq` and damping `C = -dF/dv` (n x n), their symmetric parts: what
//! they leave out costs implicit methods iterations, not correctness. On flat spaces only.

use stationary_calculus::{
    Covector, FIXED, Force, Metric, Potential, ProductSink, Sink, SizeError, System, Vector,
};

use super::{Jacobian, VectorField};

/// The field of a mechanical system, with y = (q, p).
#[derive(Clone, Debug)]
pub struct MechanicalField<'s, M, P, F = ()> {
    system: &'s System<M, P>,
    force: F,
}

impl<'s, M: Metric, P: Potential> MechanicalField<'s, M, P> {
    /// The field of a system on which no other force acts.
    pub fn new(system: &'s System<M, P>) -> Self {
        MechanicalField { system, force: () }
    }
}

impl<'s, M: Metric, P: Potential, F: Force> MechanicalField<'s, M, P, F> {
    /// The field of a system under a force, which may be none: an option of a force, or `()`.
    ///
    /// # Errors
    /// [`SizeError`] for a force that has freedoms, but not as many as the system.
    pub fn forced(system: &'s System<M, P>, force: F) -> Result<Self, SizeError> {
        if force.dim() > 0 {
            SizeError::check("the force's freedoms", system.dim(), force.dim())?;
        }
        Ok(MechanicalField { system, force })
    }
}

impl<M: Metric, P: Potential, F: Force> VectorField for MechanicalField<'_, M, P, F> {
    #[inline]
    fn dim(&self) -> usize {
        2 * self.system.dim()
    }

    #[inline]
    fn evaluate(&self, t: f64, y: &[f64], f: &mut [f64]) {
        let n = self.system.dim();
        let (q, p) = y.split_at(n);
        let (dq, dp) = f.split_at_mut(n);
        self.system.metric().sharp(Covector(p), Vector(&mut *dq));
        dp.fill(-0.0);
        self.system.potential().add_differential(q, Covector(&mut *dp));
        dp.iter_mut().for_each(|dp| *dp = -*dp);
        self.force.add_force(t, q, Vector(dq), Covector(dp));
    }

    fn jacobian(&self, t: f64, y: &[f64], df: &mut [f64]) -> Jacobian {
        let n = self.system.dim();
        let (q, p) = y.split_at(n);
        df.fill(0.0);
        let (by_q, by_p) = df.split_at_mut(2 * n * n);
        // The velocity is written where zeros must stand in the end.
        let (v, columns) = by_q.split_at_mut(n);
        self.system.metric().sharp(Covector(p), Vector(&mut *v));
        for (j, column) in by_p.chunks_exact_mut((2 * n).max(1)).enumerate() {
            let (top, bottom) = column.split_at_mut(n);
            bottom[j] = 1.0;
            self.system.metric().sharp(Covector(&*bottom), Vector(&mut *top));
            bottom[j] = 0.0;
            if let Some(mut sink) = ProductSink::new(-1.0, top, bottom) {
                self.force.add_damping(t, q, Vector(&*v), &mut sink);
            }
        }
        v.fill(0.0);
        let mut lower = LowerBlock { n, columns };
        self.system.potential().add_hessian(q, &mut lower);
        self.force.add_stiffness(t, q, &mut lower);
        Jacobian::Written
    }
}

/// Subtracts what it is given from the lower half of columns of height 2n, from their middle on.
struct LowerBlock<'a> {
    n: usize,
    columns: &'a mut [f64],
}

impl Sink for LowerBlock<'_> {
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        for (&j, column) in freedoms.iter().zip(block.chunks_exact(freedoms.len().max(1))) {
            for (&i, entry) in freedoms.iter().zip(column) {
                if i != FIXED && j != FIXED {
                    self.columns[i + 2 * self.n * j] -= entry;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stationary_calculus::DiagonalMetric;

    /// A spring on the first freedom; what acts on no freedom brings an empty block.
    struct Spring(usize);

    impl Potential for Spring {
        fn dim(&self) -> usize {
            self.0
        }

        fn energy(&self, q: &[f64]) -> f64 {
            q.first().map_or(0.0, |q| 1.5 * q * q)
        }

        fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
            if let (Some(q), Some(dv)) = (q.first(), dv.0.first_mut()) {
                *dv += 3.0 * q;
            }
        }

        fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
            hessian.add_symmetric(&[], &[]);
            if !q.is_empty() {
                hessian.add_symmetric(&[0], &[3.0]);
            }
        }
    }

    #[test]
    fn an_empty_block_of_the_hessian_is_nothing() {
        let system = System::new(DiagonalMetric::new([2.0]).unwrap(), Spring(1)).unwrap();
        let mut df = [f64::NAN; 4];
        MechanicalField::new(&system).jacobian(0.0, &[0.3, 0.1], &mut df);
        assert_eq!(df, [0.0, -3.0, 0.5, 0.0]);
    }

    #[test]
    fn a_system_without_freedoms_has_an_empty_jacobian() {
        let system = System::new(DiagonalMetric::new(vec![]).unwrap(), Spring(0)).unwrap();
        MechanicalField::new(&system).jacobian(0.0, &[], &mut []);
    }
}
