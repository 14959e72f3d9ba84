//! Random initial value problems, and the state at any time by a way that no judged method goes.
//!
//! ```text
//! y' = f(t, y),   y(0) given,   0 <= t <= end
//! ```
//! `y` n numbers; mechanics is y = (q, p) with p = M q'. The truth is a closed form where there is
//! one, else an own reference integrator: extrapolation of the explicit midpoint rule, or of the
//! linearly implicit Euler method where the problem is stiff.

use super::reference::{Extrapolation, Followed, Place, follow};

/// Writes f(t, y).
pub type Slope = Box<dyn Fn(f64, &[f64], &mut [f64])>;
/// Writes df/dy by columns.
pub type Derivative = Box<dyn Fn(f64, &[f64], &mut [f64])>;
/// V(q).
pub type Energy = Box<dyn Fn(&[f64]) -> f64>;
/// The state at a time.
pub type ClosedForm = Box<dyn Fn(f64) -> Vec<f64>>;

/// A random initial value problem.
pub struct InitialValue {
    pub name: &'static str,
    pub slope: Slope,
    pub derivative: Derivative,
    pub start: Vec<f64>,
    pub end: f64,
    /// The size of each component, for absolute tolerances.
    pub sizes: Vec<f64>,
    pub truth: Option<ClosedForm>,
    /// Whether an explicit method would need very many steps.
    pub stiff: bool,
    /// The masses, where it is mechanics.
    pub masses: Option<Vec<f64>>,
    /// The potential energy, where it is known.
    pub energy: Option<Energy>,
}

impl InitialValue {
    /// The number of unknowns.
    pub fn dim(&self) -> usize {
        self.start.len()
    }

    /// Where it starts.
    pub fn begin(&self) -> Place {
        (0.0, self.start.clone())
    }

    /// The reference's states at these times from a place, to this relative error.
    pub fn reference(&self, from: &Place, times: &[f64], tolerance: f64) -> Option<Followed> {
        let rule = match self.stiff {
            true => Extrapolation::LinearlyImplicitEuler(&self.derivative),
            false => Extrapolation::Midpoint,
        };
        follow(&self.slope, rule, (from, &self.sizes), times, tolerance)
    }
}

/// A problem of mechanics without a closed form.
pub fn motion(
    name: &'static str,
    masses: Vec<f64>,
    (slope, derivative): (Slope, Derivative),
    energy: Option<Energy>,
    (start, sizes, end): (Vec<f64>, Vec<f64>, f64),
) -> InitialValue {
    let (truth, stiff, masses) = (None, false, Some(masses));
    InitialValue { name, slope, derivative, start, end, sizes, truth, stiff, masses, energy }
}

/// A system of masses with dV(q), of n freedoms, in the state (q, p). The derivative is by the
/// Hessian of V, by columns.
pub fn mechanics(
    masses: Vec<f64>,
    differential: impl Fn(&[f64], &mut [f64]) + 'static,
    hessian: impl Fn(&[f64], &mut [f64]) + 'static,
) -> (Slope, Derivative) {
    let n = masses.len();
    let by_mass = masses.clone();
    let slope: Slope = Box::new(move |_, y, f| {
        let (q, p) = y.split_at(n);
        let (dq, dp) = f.split_at_mut(n);
        differential(q, dp);
        for i in 0..n {
            dq[i] = p[i] / masses[i];
            dp[i] = -dp[i];
        }
    });
    let derivative: Derivative = Box::new(move |_, y, df| {
        let mut h = vec![0.0; n * n];
        hessian(&y[..n], &mut h);
        df.fill(0.0);
        for j in 0..n {
            for i in 0..n {
                df[n + i + 2 * n * j] = -h[i + n * j];
            }
            df[j + 2 * n * (n + j)] = 1.0 / by_mass[j];
        }
    });
    (slope, derivative)
}
