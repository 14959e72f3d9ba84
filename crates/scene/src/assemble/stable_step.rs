//! The longest step at which a method is stable on the vibrations of a scene.
//!
//! ```text
//! H v = omega^2 M v,    h <= limit/omega         H at the start, limit 2 of Stormer-Verlet
//! h <= 2/(alpha lambda)                          of explicit heat, lambda the largest of the mesh
//! ```
//! The largest eigenvalue is found by Lanczos' method. `omega` is that of the start: where springs
//! stiffen, steps must be shorter still. Springs of touch, which are none at the start, count as those
//! between two of the lightest particles, `omega^2 = 2 k/m`. Rigid bodies have no vibrations here.

use std::fmt;

use stationary_calculus::Readable;

use crate::assemble::error::AssemblyError;
use crate::model::scene::Scene;
#[cfg(feature = "laplacian")]
use {
    crate::assemble::system::SceneProblem,
    crate::model::drives::Drives,
    crate::{Motion, Stepping},
    stationary_calculus::{Covector, Potential, Sink},
    stationary_integrators::Stability,
    stationary_laplacian::largest_eigenvalue,
};

/// A step beyond what the method is stable at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnstableStep {
    /// The method's name.
    pub method: &'static str,
    /// The scene's step.
    pub step: f64,
    /// The longest that is stable; zero where none is.
    pub stable: f64,
}

impl fmt::Display for UnstableStep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let UnstableStep { method, step, stable } = self;
        let step = Readable(step);
        if *stable > 0.0 {
            return write!(
                f,
                "the step {step} is unstable: `{method}` is stable up to a step of {:e} on the fastest \
                 vibration at the start; take a smaller step, or an implicit method",
                rounded_down(*stable)
            );
        }
        write!(
            f,
            "`{method}` is unstable at any step where things vibrate; take another method, such as \
             `stormer-verlet`"
        )
    }
}

/// The number with two digits, not above it.
fn rounded_down(x: f64) -> f64 {
    let unit = 10.0_f64.powf(x.log10().floor() - 1.0);
    // Through text, which rounds what powers of ten leave.
    format!("{:.1e}", (x / unit).floor() * unit).parse().unwrap_or(x)
}

impl Scene {
    /// The scene's step where it is beyond what its method is stable at; none where it is not, and
    /// where that is not known.
    pub fn unstable_step(&self) -> Option<UnstableStep> {
        let (stable, step) = (self.stable_step().ok().flatten()?, self.timing.step());
        let method = self.stepping.name();
        (step > stable).then_some(UnstableStep { method, step, stable })
    }
}

#[cfg(not(feature = "laplacian"))]
impl Scene {
    /// None is known without the crate that finds eigenvalues.
    ///
    /// # Errors
    /// None.
    pub fn stable_step(&self) -> Result<Option<f64>, AssemblyError> {
        Ok(None)
    }
}

#[cfg(feature = "laplacian")]
impl Scene {
    /// The longest step at which the scene's method is stable on its fastest vibration at the start:
    /// zero where no step is; none where every step is, where nothing vibrates, of methods that choose
    /// their steps, and without the feature `laplacian`.
    ///
    /// # Errors
    /// Those of [`Scene::problem`].
    pub fn stable_step(&self) -> Result<Option<f64>, AssemblyError> {
        let limit = match self.stepping {
            Stepping::Heat(method) => return self.stable_heat_step(method),
            Stepping::Equal(method) if self.bodies.is_empty() => match method.facts().stability {
                Stability::Below(limit) => limit,
                Stability::Never => 0.0,
                Stability::Always => return Ok(None),
            },
            _ => return Ok(None),
        };
        // Springs to pins that move vibrate like others.
        let still = Scene { drives: Drives::default(), ..self.clone() };
        let square = fastest(&still.problem()?)?.max(self.touch_square());
        Ok((square > 0.0 && square.is_finite()).then(|| limit / square.sqrt()))
    }

    /// omega^2 of two of the lightest particles that touch by springs.
    fn touch_square(&self) -> f64 {
        let stiffness = self.contact.as_ref().and_then(|contact| contact.stiffness);
        let masses = self.particles.iter().filter_map(|particle| match particle.motion {
            Motion::Free { mass, .. } => Some(mass),
            _ => None,
        });
        stiffness.map_or(0.0, |k| 2.0 * k / masses.fold(f64::INFINITY, f64::min))
    }
}

/// The largest omega^2 at the start.
#[cfg(feature = "laplacian")]
fn fastest(problem: &SceneProblem) -> Result<f64, AssemblyError> {
    let system = &problem.system;
    let there = Quadratic { potential: system.potential(), q: &problem.initial.q };
    Ok(largest_eigenvalue(system.metric(), &there)?)
}

/// The second differential of a potential at one place, as the potential of that matrix.
#[cfg(feature = "laplacian")]
struct Quadratic<'a, P> {
    potential: &'a P,
    q: &'a [f64],
}

#[cfg(feature = "laplacian")]
impl<P: Potential> Potential for Quadratic<'_, P> {
    fn dim(&self) -> usize {
        self.potential.dim()
    }

    fn energy(&self, x: &[f64]) -> f64 {
        let mut dv = Covector(vec![0.0; self.dim()]);
        self.add_differential(x, dv.view_mut());
        0.5 * dv.0.iter().zip(x).map(|(dv, x)| dv * x).sum::<f64>()
    }

    fn add_differential(&self, x: &[f64], dv: Covector<&mut [f64]>) {
        if let Some(mut sink) = stationary_calculus::ProductSink::new(1.0, x, dv.0) {
            self.add_hessian(x, &mut sink);
        }
    }

    fn add_hessian(&self, _: &[f64], hessian: &mut impl Sink) {
        self.potential.add_hessian(self.q, hessian);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_that_is_told_is_one_that_can_be_taken() {
        for (x, told) in [(0.12649, 0.12), (1.0, 1.0), (9.99e-5, 9.9e-5), (2.0e-7, 2.0e-7)] {
            assert!(rounded_down(x) <= x * (1.0 + 1e-12));
            assert!((rounded_down(x) / told - 1.0).abs() < 0.06, "{x}: {}", rounded_down(x));
        }
    }
}
