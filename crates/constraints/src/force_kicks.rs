//! The two kicks that a force gives in a step, and the work of each.
//!
//! ```text
//! p* = p + h/2 F(t, q, v*),           v* = M^-1 p*              before the motion, solved for p*
//! p' = p^ + h/2 F(t + h, q', v^),     v^ = M^-1 p^              after it
//! W_k = h/2 <F_k(t, q, v*), (v + v*)/2> + h/2 <F_k(t + h, q', v^), (v^ + v')/2>
//! ```
//! `q` configuration, `v` velocity, `p` momentum covector (n), `M` the metric, `h` seconds; `F` the sum
//! of forces `F_k` that no potential gives. It is the discrete Lagrange-d'Alembert principle with the
//! impulses `h/2 F` at either end of a step, at the velocities with which the step's own motion leaves
//! and arrives. The second kick is the first one backward: symmetric, and so of order 2 whatever a
//! force depends on. What forces share out among bodies sums to zero to rounding, and so do momenta.
//!
//! The works are the kinetic energy that the kicks bring, to rounding: what is left of the energy's
//! balance is the defect of the motion without forces, of order h^2.
//!
//! Of a force linear in v the first kick takes one solve, and the pair multiplies `p` by
//! `(1 - x)/(1 + x)`, `x = h c/2m`: stable at every step. In general the first kick is Newton's method
//! with the symmetric part of `-dF/dv`, by conjugate gradients with the metric in front. Source: notes
//! 10.1; Marsden and West (2001), 3.2.

use stationary_calculus::{
    Covector, Force, Metric, NewtonError, NewtonFailure, ProductSink, SizeError, Vector,
};
use stationary_integrators::StepError;

/// Newton iterations at most.
const ITERATIONS: usize = 50;
/// A residual of this size, relative to the momenta, is rounding.
const ROUNDING: f64 = 4e-16;
/// The linear equation is solved to this part of the residual.
const SOLVED: f64 = 1e-10;

/// Forces beside the potential, with the memory of their kicks.
#[derive(Clone, Debug, Default)]
pub struct ForceKicks<F> {
    force: F,
    works: Vec<f64>,
    /// The works of the step that is made.
    found: Vec<f64>,
    /// Before a kick, and after it.
    velocity: Vector<Vec<f64>>,
    moved: Vector<Vec<f64>>,
    impulse: Covector<Vec<f64>>,
    residual: Covector<Vec<f64>>,
    step: Vector<Vec<f64>>,
    direction: Vector<Vec<f64>>,
    product: Covector<Vec<f64>>,
    preconditioned: Vector<Vec<f64>>,
}

/// `sqrt(<p, M^-1 p>)`, of a momentum and its velocity; not a number if a component is not.
fn norm(p: &Covector<Vec<f64>>, v: &Vector<Vec<f64>>) -> f64 {
    p.apply(v).abs().sqrt()
}

impl<F: Force> ForceKicks<F> {
    /// The kicks of a force.
    pub fn new(force: F) -> Self {
        let n = force.dim();
        let (vector, covector) = (Vector(vec![0.0; n]), Covector(vec![0.0; n]));
        ForceKicks {
            works: vec![0.0; force.works()],
            found: vec![0.0; force.works()],
            force,
            velocity: vector.clone(),
            moved: vector.clone(),
            impulse: covector.clone(),
            residual: covector.clone(),
            step: vector.clone(),
            direction: vector.clone(),
            product: covector,
            preconditioned: vector,
        }
    }

    /// The force.
    pub fn force(&self) -> &F {
        &self.force
    }

    /// The work of each thing that acts, in the last step that was accepted, joules.
    pub fn works(&self) -> &[f64] {
        &self.works
    }

    /// Takes the works of the two kicks for those of a step: it is made, and nothing failed.
    pub fn accept(&mut self) {
        self.works.copy_from_slice(&self.found);
    }

    /// Whether there is none.
    fn none(&self) -> bool {
        self.force.dim() == 0
    }

    /// Begins a step with the kick before its motion, of half of `h`; Newton iterations that it took.
    ///
    /// # Errors
    /// A force of another size than the metric's; [`StepError::Newton`] where no momentum after the
    /// kick is found.
    pub fn before(
        &mut self,
        metric: &impl Metric,
        (t, h): (f64, f64),
        q: &[f64],
        p: &mut Covector<&mut [f64]>,
    ) -> Result<u32, StepError> {
        self.found.fill(0.0);
        if self.none() {
            return Ok(0);
        }
        SizeError::check("the force's freedoms", metric.dim(), self.force.dim())?;
        metric.sharp(p.view(), self.velocity.view_mut());
        self.moved.0.copy_from_slice(&self.velocity.0);
        let (mut last, mut history) = (f64::INFINITY, [0.0; ITERATIONS]);
        for iteration in 0..ITERATIONS {
            let (size, scale) = self.evaluate(metric, (t, h), q, p);
            history[iteration] = size;
            if !size.is_finite() {
                return Err(failed(NewtonFailure::NonFinite(0), &history[..=iteration]));
            }
            if size <= ROUNDING * scale || (size >= 0.5 * last && size <= 1e-13 * scale) {
                p.add_scaled(1.0, self.impulse.view());
                self.work(t, q, h);
                return Ok(iteration as u32);
            }
            last = size;
            self.solve(metric, (t, h), q, size);
            self.moved.add_scaled(1.0, self.step.view());
        }
        Err(failed(NewtonFailure::NotConverged, &history))
    }

    /// The kick after the motion, of half of `h`, which ends the step at the time `t + h`.
    pub fn after(
        &mut self,
        metric: &impl Metric,
        (t, h): (f64, f64),
        q: &[f64],
        p: &mut Covector<&mut [f64]>,
    ) {
        if self.none() {
            return;
        }
        metric.sharp(p.view(), self.moved.view_mut());
        self.push(t + h, q, h);
        p.add_scaled(1.0, self.impulse.view());
        metric.sharp(p.view(), self.velocity.view_mut());
        self.work(t + h, q, h);
    }

    /// The impulse of half a step at the velocity `moved`.
    fn push(&mut self, t: f64, q: &[f64], h: f64) {
        self.impulse.clear();
        self.force.add_force(t, q, self.moved.view(), self.impulse.view_mut());
        self.impulse.0.iter_mut().for_each(|f| *f *= 0.5 * h);
    }

    /// The residual `p + h/2 F(v) - M v` at `moved`, its size and that of its terms.
    fn evaluate(
        &mut self,
        metric: &impl Metric,
        (t, h): (f64, f64),
        q: &[f64],
        p: &Covector<&mut [f64]>,
    ) -> (f64, f64) {
        self.push(t, q, h);
        metric.sharp(self.impulse.view(), self.preconditioned.view_mut());
        let pushed = norm(&self.impulse, &self.preconditioned);
        metric.flat(self.moved.view(), self.residual.view_mut());
        let scale = norm(&self.residual, &self.moved) + pushed;
        let terms = self.residual.0.iter_mut().zip(p.0.iter().zip(&self.impulse.0));
        terms.for_each(|(r, (p, f))| *r = p + f - *r);
        metric.sharp(self.residual.view(), self.preconditioned.view_mut());
        (norm(&self.residual, &self.preconditioned), scale)
    }

    /// `(M + h/2 C) step = residual` by conjugate gradients, with M in front; where C makes the matrix
    /// indefinite, as far as they lead downhill.
    fn solve(&mut self, metric: &impl Metric, (t, h): (f64, f64), q: &[f64], size: f64) {
        let ForceKicks { force, moved, residual, step, direction, product, preconditioned, .. } =
            self;
        step.clear();
        direction.0.copy_from_slice(&preconditioned.0);
        let mut square = residual.apply(preconditioned);
        for round in 0..=2 * direction.0.len() {
            metric.flat(direction.view(), product.view_mut());
            if let Some(mut sink) = ProductSink::new(0.5 * h, &direction.0, &mut product.0) {
                force.add_damping(t, q, moved.view(), &mut sink);
            }
            let curvature = product.apply(direction);
            if curvature.is_nan() || curvature <= 0.0 {
                if round == 0 {
                    step.0.copy_from_slice(&direction.0);
                }
                return;
            }
            let length = square / curvature;
            step.add_scaled(length, direction.view());
            residual.add_scaled(-length, product.view());
            metric.sharp(residual.view(), preconditioned.view_mut());
            let next = residual.apply(preconditioned);
            if next.is_nan() || next.abs().sqrt() <= SOLVED * size {
                return;
            }
            let turn = next / square;
            direction.0.iter_mut().zip(&preconditioned.0).for_each(|(d, z)| *d = z + turn * *d);
            square = next;
        }
    }

    /// Adds the works of the impulse at `moved`, along the mean of the velocities before and after it.
    fn work(&mut self, t: f64, q: &[f64], h: f64) {
        if self.found.is_empty() {
            return;
        }
        let ForceKicks { force, found, velocity, moved, step, .. } = self;
        let means =
            velocity.0.iter().zip(&moved.0).map(|(before, after)| 0.25 * h * (before + after));
        step.0.iter_mut().zip(means).for_each(|(step, mean)| *step = mean);
        force.add_powers(t, q, moved.view(), step.view(), found);
    }
}

#[cold]
fn failed(failure: NewtonFailure, history: &[f64]) -> StepError {
    NewtonError { failure, history: history.to_vec() }.into()
}
