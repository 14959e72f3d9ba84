//! What kind of equilibrium it is: the second derivative test, counted.
//!
//! ```text
//! negative eigenvalues of H + sigma M  =  number of lambda < -sigma
//! negative eigenvalues of H - sigma M  =  number of lambda <  sigma
//! ```
//! A free body's Hessian is singular, and the signs of its zeros are rounding; so both counts are
//! taken a little off zero, and the eigenvalues between them are the flat directions. Sigma falls
//! until only the rigid motions are flat, which is then well below the first elastic eigenvalue;
//! but not into rounding, nor to what the rigid motions themselves cost. Where there are more flat
//! directions to the end the test has nothing to say: `V = x^3` and `V = x^4` look alike; nor has
//! it where elimination cannot be trusted to count. Source: notes 14.1; errata 14.1.

use stationary_calculus::{Metric, Potential, SparseError};

use crate::{Linearized, ModalError, RigidMotions, dense};

/// The kind of an equilibrium.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Every direction but the rigid motions costs energy: a minimum.
    Stable,
    /// Every direction but the rigid motions lowers the energy.
    Maximum {
        /// How many directions lower the energy.
        descents: usize,
    },
    /// Some directions cost energy, some give it.
    Saddle {
        /// How many directions lower the energy.
        descents: usize,
    },
    /// Second derivatives do not tell: there are flat directions that are no rigid motions, or what
    /// is flat cannot be told from what is not.
    Undecided {
        /// How many flat directions there are, rigid motions included; `None` where no count could
        /// be trusted.
        flat: Option<usize>,
    },
}

/// Sigma at first and at last, relative to the scale, and the factor from one to the next.
const FIRST: f64 = 1e-9;
const LAST: f64 = 0.5e-13;
const FALL: f64 = 1e-2;
/// Sigma is at least this many times what a rigid motion costs.
const CLEAR: f64 = 10.0;

/// Numbers of eigenvalues below, about and above zero.
struct Signs {
    descents: usize,
    flat: usize,
    ascents: usize,
}

impl Signs {
    fn kind(&self, rigid: usize) -> Kind {
        let Signs { descents, flat, ascents } = *self;
        match (descents, ascents) {
            (1.., 1..) => Kind::Saddle { descents },
            (1.., 0) if flat <= rigid => Kind::Maximum { descents },
            (0, 1..) if flat <= rigid => Kind::Stable,
            _ => Kind::Undecided { flat: Some(flat) },
        }
    }
}

impl<M: Metric, P: Potential> Linearized<'_, M, P> {
    /// The kind of the equilibrium, rigid motions aside.
    ///
    /// # Errors
    /// Those of the sparse matrices, and of rigid motions of another system; counts that cannot be trusted are [`Kind::Undecided`].
    pub fn kind(&mut self, rigid: &RigidMotions) -> Result<Kind, ModalError> {
        rigid.check(self)?;
        let least = (LAST * self.scale()).max(CLEAR * self.effort(rigid)?);
        let mut sigma = (FIRST * self.scale()).max(least);
        let mut found = Kind::Undecided { flat: None };
        loop {
            if let Some(signs) = self.signs(sigma)? {
                found = signs.kind(rigid.len());
                if signs.flat <= rigid.len() {
                    return Ok(found);
                }
            }
            sigma *= FALL;
            // Where the scale is among the least numbers both come down to zero.
            if sigma < least || sigma == 0.0 {
                return Ok(found);
            }
        }
    }

    /// The largest lambda, in size, of a rigid motion: zero but for rounding and what is missing to
    /// the equilibrium.
    fn effort(&self, rigid: &RigidMotions) -> Result<f64, ModalError> {
        let mut largest = 0.0_f64;
        for motion in rigid.columns.chunks_exact(self.dim().max(1)) {
            let mut moved = vec![0.0; motion.len()];
            self.stiffness().add_product(1.0, motion, &mut moved)?;
            largest = largest.max(dense::dot(motion, &moved).abs());
        }
        Ok(largest)
    }

    /// The counts at a limit, or `None` where one of them cannot be trusted.
    fn signs(&mut self, sigma: f64) -> Result<Option<Signs>, ModalError> {
        let mut below = [0; 2];
        for (count, limit) in below.iter_mut().zip([-sigma, sigma]) {
            *count = match self.count_below(limit) {
                Ok(count) => count,
                Err(ModalError::Sparse(SparseError::Singular)) => return Ok(None),
                Err(error) => return Err(error),
            };
        }
        let [descents, below_both] = below;
        // Counts that contradict each other were both wrong.
        Ok(below_both.checked_sub(descents).map(|flat| Signs {
            descents,
            flat,
            ascents: self.dim() - below_both,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stationary_calculus::{Covector, DiagonalMetric, Sink};

    /// `1/2 sum_i a_i x_i^2`.
    struct Bowl(Vec<f64>);

    impl Potential for Bowl {
        fn dim(&self) -> usize {
            self.0.len()
        }

        fn energy(&self, q: &[f64]) -> f64 {
            self.0.iter().zip(q).map(|(a, x)| 0.5 * a * x * x).sum()
        }

        fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
            for ((dv, a), x) in dv.0.iter_mut().zip(&self.0).zip(q) {
                *dv += a * x;
            }
        }

        fn add_hessian(&self, _: &[f64], hessian: &mut impl Sink) {
            self.0.iter().enumerate().for_each(|(i, a)| hessian.add_symmetric(&[i], &[*a]));
        }
    }

    fn kind(curvatures: &[f64]) -> Kind {
        let bowl = Bowl(curvatures.to_vec());
        let n = curvatures.len();
        let metric = DiagonalMetric::new(vec![1.0; n]).unwrap();
        let mut at_rest = Linearized::at(&metric, &bowl, &vec![0.0; n], 0.0).unwrap();
        at_rest.kind(&RigidMotions::none()).unwrap()
    }

    #[test]
    fn a_soft_direction_beside_a_stiff_one_counts_with_its_sign() {
        assert_eq!(kind(&[-1e4, 1e-3]), Kind::Saddle { descents: 1 });
        assert_eq!(kind(&[-1e4, -1e-3, 1.0]), Kind::Saddle { descents: 2 });
        assert_eq!(kind(&[-1e4, -1e-3]), Kind::Maximum { descents: 2 });
        assert_eq!(kind(&[1e6, 1e-5]), Kind::Stable);
        assert_eq!(kind(&[1e6, -1e-5]), Kind::Saddle { descents: 1 });
        assert_eq!(kind(&[1.0, 1e-17]), Kind::Undecided { flat: Some(1) });
        assert_eq!(kind(&[-1.0, 0.0]), Kind::Undecided { flat: Some(1) });
    }

    #[test]
    fn eigenvalues_on_every_limit_leave_the_kind_undecided() {
        let mut curvatures = vec![1.0, FIRST];
        while let Some(&limit) = curvatures.last().filter(|limit| **limit * FALL >= LAST) {
            curvatures.push(limit * FALL);
        }
        assert!(curvatures.len() >= 3);
        assert_eq!(kind(&curvatures), Kind::Undecided { flat: None });
        // With one of the limits free it is decided there.
        curvatures[1] *= 2.0;
        assert_eq!(kind(&curvatures), Kind::Undecided { flat: Some(curvatures.len() - 2) });
    }
}
