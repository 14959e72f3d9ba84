//! The largest eigenvalue of the Laplacian, from above: what an explicit step is bounded by.
//!
//! ```text
//! W v = lambda M v
//! Lanczos:    M^-1 W x_k = b_k x_(k+1) + a_k x_k + b_(k-1) x_(k-1),    theta the largest of the a, b
//! chance:     theta + spread (ln(1.648 sqrt(n) 1e9)/(2 k - 1))^2 is exceeded once in 1e9 starts
//! rows:       lambda <= max_i (|W| y)_i / (c D_i y_i) for any y > 0,   M >= c D, D the diagonal of M
//! ```
//! `W` the Hessian of the Dirichlet energy, `M` the mass; `lambda` in 1/m^2. A value from below would make
//! a step unstable. Where many eigenvalues crowd below the largest, Lanczos is slow to reach it; there the
//! rows or the chance tell what it does not exceed. Of lumped masses, and weights that are not negative
//! between vertices of two colours, the rows meet it.
//! Source: Parlett, The symmetric eigenvalue problem, 1980; Kuczynski and Wozniakowski, Estimating the
//! largest eigenvalue by the power and Lanczos algorithms with a random start, 1992; Collatz 1942.

use stationary_calculus::{
    Covector, FIXED, Metric, Potential, ProductSink, Sink, SizeError, Vector,
};
use stationary_measure::SplitMix64;

use crate::LaplacianError;

/// Steps of Lanczos, at most, and how many lie between two looks.
const STEPS: usize = 400;
const LOOK: usize = 8;
/// The largest is met where its residual is below this part of it.
const MET: f64 = 1e-13;
/// Starts for each that may miss the bound by chance.
const STARTS: f64 = 1e9;
/// Weights of the rows that are tried, each from the one before.
const WEIGHTS: usize = 30;

/// The largest eigenvalue, or what it does not exceed, rounding aside.
///
/// It is met to 1e-13 where the iteration converges, which it does unless many eigenvalues lie within a
/// thousandth of the largest, and where the bound by rows is sharp. Elsewhere the value is above it, by no
/// more than a quarter of a percent of the whole spectrum.
///
/// # Errors
/// [`LaplacianError::Size`], and [`LaplacianError::Parameter`] for masses too large for a number.
pub fn largest_eigenvalue(
    metric: &impl Metric,
    dirichlet: &impl Potential,
) -> Result<f64, LaplacianError> {
    let n = metric.dim();
    SizeError::check("the energy's freedoms", n, dirichlet.dim())?;
    let ones = vec![1.0; n];
    let mut mass = Sizes::beside(&ones);
    metric.add_matrix(&mut mass);
    let mut random = SplitMix64::new(15);
    // A power of two about the largest mass, by which nothing leaves the range of numbers.
    let heaviest = mass.diagonal.iter().fold(0.0_f64, |most, m| most.max(*m));
    let unit = 2.0_f64.powi(heaviest.log2().floor().clamp(-1000.0, 1023.0) as i32);
    let mut x: Vec<f64> =
        mass.diagonal.iter().map(|m| random.symmetric() * (unit / m).sqrt()).collect();
    let size = length(metric, unit, &x)?;
    if size == 0.0 {
        return Ok(0.0);
    }
    x.iter_mut().for_each(|x| *x /= size);
    let (mut before, mut small) = (vec![0.0; n], Tridiagonal::default());
    let mut beta = 0.0;
    let by_chance = loop {
        let (mut dv, mut next) = (Covector(vec![0.0; n]), Vector(vec![0.0; n]));
        if let Some(mut sink) = ProductSink::new(1.0, &x, &mut dv.0) {
            dirichlet.add_hessian(&ones, &mut sink);
        }
        metric.sharp(dv.view(), next.view_mut());
        next.0.iter_mut().for_each(|next| *next *= unit);
        let alpha = dv.apply(&Vector(&x));
        for (next, (x, before)) in next.0.iter_mut().zip(x.iter().zip(&before)) {
            *next -= alpha * x + beta * before;
        }
        beta = length(metric, unit, &next.0)?;
        small.push(alpha, beta);
        let steps = small.steps.len();
        let is_whole = beta <= MET * small.scale();
        if is_whole || steps % LOOK == 0 || steps >= STEPS {
            let (theta, residual) = small.largest();
            if is_whole || residual <= MET * theta.abs() {
                break theta + residual;
            }
            if steps >= STEPS {
                let chance = (1.648 * (n as f64).sqrt() * STARTS).ln() / (2 * steps - 1) as f64;
                break theta + residual.max(small.spread(theta) * chance * chance);
            }
        }
        next.0.iter_mut().for_each(|next| *next /= beta);
        before = std::mem::replace(&mut x, next.0);
    };
    Ok((by_chance / unit).min(by_rows(&mass, dirichlet)).max(0.0))
}

fn length(metric: &impl Metric, unit: f64, x: &[f64]) -> Result<f64, LaplacianError> {
    let size = (metric.inner(Vector(x), Vector(x)).max(0.0) / unit).sqrt();
    let is_number = size.is_finite() && x.iter().all(|x| x.is_finite());
    let what = "the length of a vector in the metric";
    if is_number { Ok(size) } else { Err(LaplacianError::Parameter { what, value: size }) }
}

/// What Lanczos makes: for each step its diagonal entry, and the entry that couples it to the next.
#[derive(Default)]
struct Tridiagonal {
    steps: Vec<[f64; 2]>,
}

impl Tridiagonal {
    fn push(&mut self, alpha: f64, beta: f64) {
        self.steps.push([alpha, beta]);
    }

    /// The couplings to the step before and to the one after it, of those that are inside.
    fn beside(&self, k: usize) -> f64 {
        let before = if k == 0 { 0.0 } else { self.steps[k - 1][1] };
        before + if k + 1 == self.steps.len() { 0.0 } else { self.steps[k][1] }
    }

    fn scale(&self) -> f64 {
        self.steps.iter().fold(0.0, |scale, [alpha, beta]| scale.max(alpha.abs()).max(*beta))
    }

    /// At least how far the eigenvalues reach down from the largest.
    fn spread(&self, theta: f64) -> f64 {
        let low = (0..self.steps.len()).map(|k| self.steps[k][0] - self.beside(k));
        theta - low.fold(f64::INFINITY, f64::min)
    }

    /// The largest eigenvalue and the size of its residual: the last coupling times the last component of
    /// its vector.
    fn largest(&self) -> (f64, f64) {
        let entries = || self.steps.iter().enumerate();
        let mut low = entries().fold(f64::NEG_INFINITY, |low, (_, [alpha, _])| low.max(*alpha));
        let mut high = entries()
            .map(|(k, [alpha, _])| alpha + self.beside(k))
            .fold(f64::NEG_INFINITY, f64::max);
        // Halving ends where no number lies between.
        loop {
            let middle = low + 0.5 * (high - low);
            if !(low < middle && middle < high) {
                break;
            }
            if self.pivots(middle).is_some() {
                high = middle;
            } else {
                low = middle;
            }
        }
        let last = self.steps.last().map_or(0.0, |[_, beta]| *beta);
        // Where the vector's last component is below all numbers so is the residual.
        (high, self.pivots(high).map_or(0.0, |size| last / size))
    }

    /// The size of the vector with the last component 1 that elimination from below gives at x; none
    /// where x is not above all eigenvalues.
    fn pivots(&self, x: f64) -> Option<f64> {
        let (mut component, mut size) = (1.0_f64, 1.0_f64);
        let mut above: Option<(f64, f64)> = None;
        for [alpha, beta] in self.steps.iter().rev() {
            let mut pivot = x - alpha;
            if let Some((below, _)) = above {
                pivot -= beta * (beta / below);
                component *= below / beta;
                size = size.hypot(component);
            }
            // At the largest eigenvalue itself the first pivot is zero.
            if pivot < 0.0 {
                return None;
            }
            above = Some((pivot, component));
        }
        Some(size)
    }
}

/// What rows of sizes say that the largest eigenvalue does not exceed: infinity where masses beside the
/// diagonal outweigh it.
fn by_rows(mass: &Sizes, dirichlet: &impl Potential) -> f64 {
    let beside = |(sum, diagonal): (&f64, &f64)| 2.0 - sum / diagonal;
    let definite = mass.product.iter().zip(&mass.diagonal).map(beside).fold(1.0, f64::min);
    if definite <= 0.0 || definite.is_nan() {
        return f64::INFINITY;
    }
    let mut y = vec![1.0; mass.diagonal.len()];
    let mut least = f64::INFINITY;
    for _ in 0..WEIGHTS {
        let mut moved = Sizes::beside(&y);
        dirichlet.add_hessian(mass.x, &mut moved);
        let rates: Vec<f64> =
            (0..y.len()).map(|i| moved.product[i] / (mass.diagonal[i] * y[i])).collect();
        let largest = rates.iter().fold(0.0_f64, |largest, rate| largest.max(*rate));
        if !(largest > 0.0 && largest.is_finite()) || rates.iter().any(|rate| rate.is_nan()) {
            break;
        }
        least = least.min(largest);
        // Never zero: a weight that falls faster than the others stops at this.
        y.iter_mut().zip(&rates).for_each(|(y, rate)| *y *= (rate / largest).max(1e-3));
        let most = y.iter().fold(0.0_f64, |most, y| most.max(*y));
        y.iter_mut().for_each(|y| *y = (*y / most).max(1e-100));
    }
    least / definite
}

/// Sums of the sizes of a matrix's entries: `|A| x`, and its diagonal.
struct Sizes<'a> {
    x: &'a [f64],
    product: Vec<f64>,
    diagonal: Vec<f64>,
}

impl<'a> Sizes<'a> {
    fn beside(x: &'a [f64]) -> Self {
        Sizes { x, product: vec![0.0; x.len()], diagonal: vec![0.0; x.len()] }
    }
}

impl Sink for Sizes<'_> {
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        for (&j, column) in freedoms.iter().zip(block.chunks_exact(freedoms.len().max(1))) {
            for (&i, entry) in freedoms.iter().zip(column).filter(|_| j != FIXED) {
                if i != FIXED {
                    self.product[i] += entry.abs() * self.x[j];
                }
                if i == j {
                    self.diagonal[i] += entry;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::{interval, lumped_interval_spectrum, square};
    use crate::{Domain, Elements};
    use stationary_calculus::DiagonalMetric;
    use stationary_mesh::bar;

    #[test]
    fn the_largest_eigenvalue_is_refused_where_masses_are_too_large_and_zero_of_nothing() {
        let domain = Domain::free(Elements::of(&bar(1.0, 4).unwrap()).unwrap()).unwrap();
        let heavy = DiagonalMetric::new(vec![1.7e308; domain.dim()]).unwrap();
        let refused = largest_eigenvalue(&heavy, domain.dirichlet());
        assert!(matches!(refused, Err(LaplacianError::Parameter { .. })), "{refused:?}");
        let none = DiagonalMetric::new(Vec::<f64>::new()).unwrap();
        let nothing = Option::<&crate::Dirichlet<1>>::None;
        assert_eq!(largest_eigenvalue(&none, &nothing).unwrap(), 0.0);
    }

    #[test]
    fn masses_of_any_size_have_their_largest_eigenvalue() {
        let domain = Domain::free(Elements::of(&bar(1.0, 4).unwrap()).unwrap()).unwrap();
        for mass in [1e-300, 1e-10, 1.0, 1e100, 1e306] {
            let metric = DiagonalMetric::new(vec![mass; domain.dim()]).unwrap();
            let largest = largest_eigenvalue(&metric, domain.dirichlet()).unwrap();
            // Of a path of five vertices: 4 n sin^2(4 pi/10).
            let exact = 16.0 * (0.4 * std::f64::consts::PI).sin().powi(2);
            assert!((largest * mass / exact - 1.0).abs() < 1e-12, "{mass:e} {largest:e}");
        }
    }

    #[test]
    fn the_largest_eigenvalue_of_a_surface_is_that_of_its_dense_matrix() {
        let mesh = stationary_mesh::icosphere(1.0, 2).unwrap();
        let mut random = SplitMix64::new(6);
        for _ in 0..5 {
            let mesh = mesh.mapped(|x| x * (1.0 + 0.3 * random.symmetric())).unwrap();
            let domain = Domain::free(Elements::of(&mesh).unwrap()).unwrap();
            let (n, metric) = (domain.dim(), domain.lumped().unwrap());
            let mut values = vec![0.0; n * n];
            let mut sink = stationary_calculus::DenseSink::new(1.0, n, &mut values).unwrap();
            domain.dirichlet().add_hessian(&vec![0.0; n], &mut sink);
            let root = |i: usize| metric.masses()[i].sqrt();
            let dense =
                nalgebra::DMatrix::from_fn(n, n, |i, j| values[i + n * j] / root(i) / root(j));
            let exact = dense.symmetric_eigenvalues().max();
            let largest = largest_eigenvalue(&metric, domain.dirichlet()).unwrap();
            assert!((largest / exact - 1.0).abs() < 1e-12, "{largest} {exact}");
        }
    }

    #[test]
    fn however_many_eigenvalues_crowd_below_it_the_largest_is_not_missed_from_below() {
        for n in [1, 2, 3, 20, 100, 500, 2000, 10000] {
            let domain = interval(n).unwrap().domain;
            let exact = lumped_interval_spectrum(n)[n];
            let lumped = largest_eigenvalue(&domain.lumped().unwrap(), domain.dirichlet()).unwrap();
            assert!((lumped / exact - 1.0).abs() < 1e-12, "{n}: {lumped}");
            let galerkin = domain.galerkin().unwrap();
            let off = largest_eigenvalue(&galerkin, domain.dirichlet()).unwrap() / (3.0 * exact);
            assert!((off - 1.0).abs() < 1e-12, "{n}: {off}");
        }
        // Vertices of 4 and of 8 triangles by turns: 9 n^2.
        for n in [10, 50, 120] {
            let domain = square(n).unwrap().domain;
            let lumped = largest_eigenvalue(&domain.lumped().unwrap(), domain.dirichlet()).unwrap();
            let off = lumped / (9 * n * n) as f64 - 1.0;
            assert!((-1e-12..1e-3).contains(&off), "{n}: {off:e}");
            // Of this mass the rows say nothing.
            let galerkin = domain.galerkin().unwrap();
            let largest = largest_eigenvalue(&galerkin, domain.dirichlet()).unwrap();
            let rate = largest / (n * n) as f64;
            assert!((36.0 - 1e-10..36.1).contains(&rate), "{n} {rate}");
        }
    }
}
