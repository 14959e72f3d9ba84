//! Problems with known spectra: one definition each for tests, studies and benches.
//!
//! | problem | held | lambda |
//! | --- | --- | --- |
//! | [`interval`] | nothing | `n^2 pi^2`, n = 0, 1, ... |
//! | [`square`] | nothing | `(m^2 + n^2) pi^2` |
//! | [`disc`] | the rim, at zero | squares of the zeros of Bessel's functions, twice for m > 0 |
//! | [`sphere`] | nothing | `l (l + 1)`, 2 l + 1 times |
//!
//! Unit lengths and radii. Eigenvalues are those of minus the Laplacian, 1/m^2, ascending.

use std::f64::consts::PI;

use stationary_mesh::{Diagonals, Mesh, bar, icosphere, rectangle};

use crate::{Domain, Elements, LaplacianError};

/// A domain and the lowest eigenvalues of the continuum that it stands for.
#[derive(Clone, Debug)]
pub struct Spectral<const D: usize, const K: usize> {
    /// The mesh.
    pub mesh: Mesh<D, K>,
    /// The domain.
    pub domain: Domain<K>,
    /// The lowest eigenvalues, at least twenty.
    pub spectrum: Vec<f64>,
}

/// The unit interval in n equal segments.
///
/// # Errors
/// Those of [`bar`].
pub fn interval(n: usize) -> Result<Spectral<1, 2>, LaplacianError> {
    let mesh = bar(1.0, n)?;
    let domain = Domain::free(Elements::of(&mesh)?)?;
    let spectrum = (0..20).map(|k| f64::from(k * k) * PI * PI).collect();
    Ok(Spectral { mesh, domain, spectrum })
}

/// The eigenvalues of the Laplacian of [`interval`] with lumped mass: `4 N^2 sin^2(k pi / 2N)`; none
/// where there is no segment.
pub fn lumped_interval_spectrum(n: usize) -> Vec<f64> {
    if n == 0 {
        return Vec::new();
    }
    let value = |k: usize| 4.0 * (n * n) as f64 * (k as f64 * PI / (2 * n) as f64).sin().powi(2);
    (0..=n).map(value).collect()
}

/// The unit square in n by n cells with alternating diagonals.
///
/// # Errors
/// Those of [`rectangle`].
pub fn square(n: usize) -> Result<Spectral<2, 3>, LaplacianError> {
    let mesh = rectangle([1.0, 1.0], [n, n], Diagonals::Alternating)?;
    let domain = Domain::free(Elements::of(&mesh)?)?;
    let pairs = (0..8).flat_map(|m| (0..8).map(move |n| f64::from(m * m + n * n) * PI * PI));
    let mut spectrum: Vec<f64> = pairs.collect();
    spectrum.sort_by(f64::total_cmp);
    spectrum.truncate(40);
    Ok(Spectral { mesh, domain, spectrum })
}

/// The unit disc in n rings, its rim held at zero.
///
/// # Errors
/// Those of [`stationary_mesh::disc`].
pub fn disc(n: usize) -> Result<Spectral<2, 3>, LaplacianError> {
    let mesh = stationary_mesh::disc(1.0, n)?;
    let rim: Vec<_> = mesh.boundary().vertices.into_iter().map(|vertex| (vertex, 0.0)).collect();
    let domain = Domain::held(Elements::of(&mesh)?, &rim)?;
    let mut spectrum = Vec::new();
    for m in 0..16 {
        for zero in bessel_zeros(m, 16.0) {
            spectrum.extend(vec![zero * zero; if m == 0 { 1 } else { 2 }]);
        }
    }
    spectrum.sort_by(f64::total_cmp);
    Ok(Spectral { mesh, domain, spectrum })
}

/// The unit sphere: an icosahedron refined this many times.
///
/// # Errors
/// Those of [`icosphere`].
pub fn sphere(levels: usize) -> Result<Spectral<3, 3>, LaplacianError> {
    let mesh = icosphere(1.0, levels)?;
    let domain = Domain::free(Elements::of(&mesh)?)?;
    let spectrum =
        (0..7_u8).flat_map(|l| vec![f64::from(l) * f64::from(l + 1); 2 * usize::from(l) + 1]);
    Ok(Spectral { mesh, domain, spectrum: spectrum.collect() })
}

/// `J_m(x) = 1/pi int_0^pi cos(m t - x sin t) dt`, by the trapezoid rule: the integrand is
/// periodic and smooth, so the error is below rounding.
fn bessel(m: u32, x: f64) -> f64 {
    const POINTS: u32 = 128;
    let at = |k: u32| {
        let t = 2.0 * PI * f64::from(k) / f64::from(POINTS);
        (f64::from(m) * t - x * t.sin()).cos()
    };
    (0..POINTS).map(at).sum::<f64>() / f64::from(POINTS)
}

/// The positive zeros of `J_m` below a bound, by bisection between changes of sign.
fn bessel_zeros(m: u32, bound: f64) -> Vec<f64> {
    let steps = (10.0 * bound) as u32;
    let at = |k: u32| 0.1 * f64::from(k);
    let changes = (5..steps).filter(|&k| bessel(m, at(k)) * bessel(m, at(k + 1)) < 0.0);
    // J_m is positive up to its first zero, which lies above m: noise below that is no zero.
    let changes = changes.filter(|&k| at(k + 1) > f64::from(m));
    let bisected = changes.map(|k| {
        let (mut low, mut high) = (at(k), at(k + 1));
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let same = bessel(m, low) * bessel(m, middle) > 0.0;
            *(if same { &mut low } else { &mut high }) = middle;
        }
        0.5 * (low + high)
    });
    bisected.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_of_bessel_functions_are_those_of_the_tables() {
        // Abramowitz and Stegun, table 9.5.
        let known = [(0, 0, 2.404_825_557_7), (1, 0, 3.831_705_970_2), (2, 1, 8.417_244_140_4)];
        for (m, k, zero) in known {
            assert!((bessel_zeros(m, 16.0)[k] - zero).abs() < 1e-10);
        }
        assert_eq!(bessel_zeros(0, 16.0).len(), 5);
        assert_eq!(bessel_zeros(15, 16.0).len(), 0);
    }
}
