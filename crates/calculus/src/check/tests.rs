//! What the tests of the checks share: potentials of closures, and a right one to spoil.

mod curved;
mod mistakes;
mod right;

use super::*;
use crate::{Covector, Sink};

type Block = (Vec<usize>, Vec<f64>);
type Function<F> = Box<dyn Fn(&[f64]) -> F>;

/// A potential of closures: energy, differential, blocks of the Hessian.
struct Given {
    freedoms: usize,
    energy: Function<f64>,
    differential: Function<Vec<f64>>,
    hessian: Function<Vec<Block>>,
}

fn given(
    freedoms: usize,
    energy: impl Fn(&[f64]) -> f64 + 'static,
    differential: impl Fn(&[f64]) -> Vec<f64> + 'static,
    hessian: impl Fn(&[f64]) -> Vec<Block> + 'static,
) -> Given {
    let (energy, differential, hessian) =
        (Box::new(energy), Box::new(differential), Box::new(hessian));
    Given { freedoms, energy, differential, hessian }
}

impl Given {
    /// The same potential with a differential that is spoiled after it is computed.
    fn with_differential(self, spoil: impl Fn(&mut [f64]) + 'static) -> Given {
        let differential = move |q: &[f64]| {
            let mut dv = (self.differential)(q);
            spoil(&mut dv);
            dv
        };
        Given { differential: Box::new(differential), ..self }
    }

    /// The same potential with a Hessian that is spoiled after it is computed.
    fn with_hessian(self, spoil: impl Fn(&mut Vec<Block>) + 'static) -> Given {
        let hessian = move |q: &[f64]| {
            let mut blocks = (self.hessian)(q);
            spoil(&mut blocks);
            blocks
        };
        Given { hessian: Box::new(hessian), ..self }
    }
}

impl Potential for Given {
    fn dim(&self) -> usize {
        self.freedoms
    }

    fn energy(&self, q: &[f64]) -> f64 {
        (self.energy)(q)
    }

    fn add_differential(&self, q: &[f64], mut dv: Covector<&mut [f64]>) {
        dv.add_scaled(1.0, Covector(&(self.differential)(q)));
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        for (freedoms, block) in (self.hessian)(q) {
            hessian.add_symmetric(&freedoms, &block);
        }
    }
}

/// Masses on a line between springs that stiffen, each in a well: V = sum of (x/2)^2 + x^4/4 over
/// the distances x, and of 1 - cos q; all of it times `scale`. The Hessian's blocks are those of the
/// n wells, then those of the n - 1 springs.
fn chain(n: usize, scale: f64) -> Given {
    let energy = move |q: &[f64]| {
        let link = |x: f64| 0.25 * x * x + 0.25 * x.powi(4);
        let links: f64 = q.windows(2).map(|q| link(q[1] - q[0])).sum();
        scale * (links + q.iter().map(|q| 1.0 - q.cos()).sum::<f64>())
    };
    let differential = move |q: &[f64]| {
        let mut dv: Vec<f64> = q.iter().map(|q| scale * q.sin()).collect();
        for (i, q) in q.windows(2).enumerate() {
            let x = q[1] - q[0];
            let force = scale * (0.5 * x + x.powi(3));
            dv[i] -= force;
            dv[i + 1] += force;
        }
        dv
    };
    let hessian = move |q: &[f64]| {
        let wells = q.iter().enumerate().map(|(i, q)| (vec![i], vec![scale * q.cos()]));
        let links = q.windows(2).enumerate().map(|(i, q)| {
            let k = scale * (0.5 + 3.0 * (q[1] - q[0]).powi(2));
            (vec![i, i + 1], vec![k, -k, -k, k])
        });
        wells.chain(links).collect()
    };
    given(n, energy, differential, hessian)
}

fn configuration(n: usize, size: f64) -> Vec<f64> {
    let mut random = SplitMix64::new(7);
    (0..n).map(|_| size * random.symmetric()).collect()
}

fn largest(numbers: &[f64]) -> f64 {
    numbers.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// The wrong entry that the check names.
#[track_caller]
fn wrong(checked: Result<Report, DerivativeError>) -> WrongEntry {
    match checked {
        Err(DerivativeError::Wrong(entry)) => *entry,
        other => panic!("expected a wrong entry, got {other:?}"),
    }
}
