//! Whether the place where a search ended is known, and a last correction where it is not.
//!
//! ```text
//! d2V(x) d = dV(x) - f           how far the rest is from x, to first order
//! |d| <= |u|/1000                known
//! |u| <= 4 eps |x|               still: to the places' digits nothing moves, and x may not have moved either
//! d2V(x) u = f                   how far the load leads; or as far as the supports were moved
//! ```
//! `|.|` the largest component. A residual says nothing of this by itself: of a slender beam a small one may be the
//! whole of its load. Where d is too large x is corrected by it, for as long as it halves: to what rounding leaves.
//!
//! Of a body so slender that rounding makes its Hessian indefinite there is no factor. There d is found by conjugate
//! gradients, with products element by element, which keep the digits that the assembled matrix loses; they
//! are preconditioned by the factor of `d2V + sigma M`, with the smallest sigma that makes it definite.
//! Source: Hestenes and Stiefel (1952); Higham, Accuracy and Stability (2002), chapter 12.

use stationary_calculus::{
    Covector, DiagonalMetric, HessianSolver, Metric, Potential, ProductSink, Rung, Sink, Vector,
};

/// An error of this part of the displacement is noticed.
pub(crate) const NOTICED: f64 = 1e-3;
/// Of a body that nothing loads or moves the place must be known to this part of its size.
const UNLOADED: f64 = 1e-8;
/// Roundings of the largest place that a load may lead by, and the search have moved a body by, where it is still.
const DIGITS: f64 = 4.0 * f64::EPSILON;
const WANDERED: f64 = 64.0 * f64::EPSILON;
/// Corrections in all.
const CORRECTIONS: usize = 30;
/// The first shift by the mass, of the Hessian's scale, and how often it is tenfold.
const SHIFT: f64 = 1e-16;
const SHIFTS: i32 = 7;
/// Conjugate gradients: the part of the first residual, squared, at which they end, and the bound on them.
const SMALL: f64 = 1e-24;
const ITERATIONS: usize = 2000;

/// What is asked of the solver.
pub(crate) struct Settle<'a, L, P> {
    pub(crate) solver: &'a mut L,
    pub(crate) metric: &'a DiagonalMetric<Vec<f64>>,
    pub(crate) potential: &'a P,
}

/// What the displacement is measured by.
pub(crate) struct Displacement<'a> {
    /// Where the search began.
    pub(crate) start: &'a [f64],
    /// How far the supports were moved, and the largest of their places, m.
    pub(crate) held: [f64; 2],
    /// The load on the free coordinates, newtons.
    pub(crate) load: &'a [f64],
}

/// What is known of a place.
pub(crate) enum Settled {
    /// It is the rest.
    Known,
    /// It is the rest to the places' digits, of a load that leads by less.
    Still,
    /// It is this far from the rest, of so large a displacement, m.
    Off([f64; 2]),
    /// The linearized equation has no solution that can be told.
    Unsolved,
}

impl<L: HessianSolver, P: Potential> Settle<'_, L, P> {
    /// Corrects x until it is known.
    pub(crate) fn settle(&mut self, x: &mut [f64], of: &Displacement<'_>) -> Settled {
        let mut known = None;
        let mut left = f64::INFINITY;
        let mut known_at: Option<Vec<f64>> = None;
        for _ in 0..CORRECTIONS {
            let mut residual = vec![0.0; x.len()];
            self.potential.add_differential(x, Covector(&mut residual[..]));
            let Some(rung) = self.factor(x) else { return Settled::Unsolved };
            let Some(correction) = self.solution(x, rung, residual) else {
                return Settled::Unsolved;
            };
            let size = largest(&correction);
            let displacement = match known {
                Some(displacement) => displacement,
                None => {
                    let Some(displacement) = self.displacement(x, rung, of) else {
                        return Settled::Unsolved;
                    };
                    *known.insert(displacement)
                }
            };
            let farthest = largest(x).max(of.held[1]);
            let moved = difference(x, of.start);
            let is_still = displacement.max(size) <= DIGITS * farthest;
            if displacement > 0.0 && is_still && moved <= WANDERED * farthest {
                return Settled::Still;
            }
            let allowed = if displacement > 0.0 {
                NOTICED * displacement
            } else {
                (NOTICED * moved).max(UNLOADED * farthest)
            };
            // So written that NaN ends it.
            let halves = size < 0.5 * left;
            let is_known = size <= allowed;
            let is_first = left == f64::INFINITY;
            if !halves || is_known && is_first {
                return match known_at {
                    _ if is_known => Settled::Known,
                    Some(place) => {
                        x.copy_from_slice(&place);
                        Settled::Known
                    }
                    None => Settled::Off([size, displacement]),
                };
            }
            // A correction may leave a larger force behind: it goes on to what rounding leaves.
            if is_known {
                known_at = Some(x.to_vec());
            }
            left = size;
            x.iter_mut().zip(&correction).for_each(|(x, d)| *x -= d);
        }
        known_at.map_or(Settled::Off([left, known.unwrap_or(0.0)]), |_| Settled::Known)
    }

    /// How far the load leads or the supports were moved.
    fn displacement(&mut self, x: &[f64], rung: Rung, of: &Displacement<'_>) -> Option<f64> {
        if largest(of.load) == 0.0 {
            return Some(of.held[0]);
        }
        let led = self.solution(x, rung, of.load.to_vec())?;
        Some(largest(&led).max(of.held[0]))
    }

    /// Factors the Hessian, or what stands for it where it is not definite.
    fn factor(&mut self, x: &[f64]) -> Option<Rung> {
        let rung = self.solver.factor_weighted(0.0, self.metric, 1.0, self.potential, x).ok()?;
        if rung != Rung::Cholesky {
            self.factor_shifted(x)?;
        }
        Some(rung)
    }

    /// The solution of the linearized equation, once it was factored.
    fn solution(&mut self, x: &[f64], rung: Rung, mut r: Vec<f64>) -> Option<Vec<f64>> {
        if largest(&r) == 0.0 {
            return Some(r);
        }
        match rung {
            Rung::Cholesky => self.solver.solve(&mut r),
            _ => r = self.iterated(x, r)?,
        }
        r.iter().all(|d| d.is_finite()).then_some(r)
    }

    /// The same by conjugate gradients.
    fn iterated(&mut self, x: &[f64], mut r: Vec<f64>) -> Option<Vec<f64>> {
        let n = r.len();
        let (mut d, mut z, mut product) = (vec![0.0; n], r.clone(), vec![0.0; n]);
        self.solver.solve(&mut z);
        let mut direction = z.clone();
        let mut square = dot(&r, &z);
        let first = square;
        for _ in 0..ITERATIONS {
            product.fill(0.0);
            self.potential.add_hessian(x, &mut ProductSink::new(1.0, &direction, &mut product)?);
            let curvature = dot(&direction, &product);
            // Neither is positive in a direction in which the energy falls, and NaN is not either.
            if !(square > 0.0 && curvature > 0.0) {
                return None;
            }
            let length = square / curvature;
            for k in 0..n {
                d[k] += length * direction[k];
                r[k] -= length * product[k];
            }
            z.copy_from_slice(&r);
            self.solver.solve(&mut z);
            let next = dot(&r, &z);
            if next <= SMALL * first {
                return Some(d);
            }
            for k in 0..n {
                direction[k] = z[k] + next / square * direction[k];
            }
            square = next;
        }
        None
    }

    /// Factors the Hessian with the smallest shift that makes it definite.
    fn factor_shifted(&mut self, x: &[f64]) -> Option<()> {
        let mut rows = RowSizes { rows: vec![0.0; x.len()] };
        self.potential.add_hessian(x, &mut rows);
        let mut scaled = vec![0.0; x.len()];
        self.metric.sharp(Covector(&rows.rows), Vector(&mut scaled));
        let scale = largest(&scaled);
        for tries in 0..SHIFTS {
            let sigma = SHIFT * scale * 10.0_f64.powi(tries);
            let factored = self.solver.factor_weighted(sigma, self.metric, 1.0, self.potential, x);
            if factored.ok()? == Rung::Cholesky {
                return Some(());
            }
        }
        None
    }
}

/// Sums the sizes of the entries of each row.
pub(crate) struct RowSizes {
    pub(crate) rows: Vec<f64>,
}

impl Sink for RowSizes {
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        for column in block.chunks_exact(freedoms.len()) {
            for (&row, entry) in freedoms.iter().zip(column) {
                if let Some(sum) = self.rows.get_mut(row) {
                    *sum += entry.abs();
                }
            }
        }
    }
}

pub(crate) fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |largest, x| x.abs().max(largest))
}

/// The largest difference of two lists' numbers.
pub(crate) fn difference(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).fold(0.0, |largest, (x, y)| (x - y).abs().max(largest))
}

fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}
