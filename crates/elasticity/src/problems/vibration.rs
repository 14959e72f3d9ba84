//! Bodies at rest whose frequencies are known, in linear elasticity.
//!
//! ```text
//! bar     w_k = t_k c n/L,  t_k = (k - 1/2) pi/n,  c^2 = E/rho            held at one end
//!         n linear cells:  lumped 2 sin(t_k/2) c n/L   Galerkin sqrt(6 (1 - cos t_k)/(2 + cos t_k)) c n/L
//! block   w^2 = c_p^2 |k|^2 once, c_s^2 |k|^2 twice,  k = pi (l/a, m/b, n/c)      on six sliding faces
//!         with one index zero once each, with two only the first
//! FV32    10 m long, 5 m high at the wall and 1 m at the tip, 0.05 m thick, plane stress
//!         E = 200 GPa, nu = 0.3, rho = 8000 kg/m^3
//! ```
//! `w` angular frequencies (rad/s), `L` and `a b c` lengths (m), `c_p^2 = (lambda + 2 mu)/rho` and
//! `c_s^2 = mu/rho` speeds of pressure and shear waves. Each body comes with both masses; with
//! Galerkin's the frequencies are above those of the continuum on any mesh, with the lumped mass
//! nothing is promised but on the bar. Source: NAFEMS, The standard NAFEMS benchmarks (1990), test
//! FV32; the wave equation.

use std::f64::consts::PI;

use stationary_calculus::{DiagonalMetric, SparseMetric};

use crate::{
    ElasticityError, Elements, Freedoms, Lame, Linear, Reference, Solid, galerkin_mass, lumped_mass,
};

/// A body at rest, its two masses and the numbers of its freedoms.
#[derive(Clone, Debug)]
pub struct Vibration<const N: usize, const D: usize, const Q: usize> {
    /// The elastic energy.
    pub solid: Solid<Linear<D>, N, D, D, Q>,
    /// The mass of the continuum.
    pub galerkin: SparseMetric,
    /// The mass shared out to the nodes.
    pub lumped: DiagonalMetric<Vec<f64>>,
    /// Where the free coordinates are at rest, m.
    pub q: Vec<f64>,
}

/// The frequencies that NAFEMS gives for FV32, hertz.
pub const FV32_HERTZ: [f64; 6] = [44.623, 130.03, 162.70, 246.05, 379.90, 391.44];

impl<const N: usize, const D: usize, const Q: usize> Vibration<N, D, Q> {
    /// A body of these elements, of which the coordinates that `holds` names are held at rest. The
    /// section is that of [`Solid::new`].
    ///
    /// # Errors
    /// Those of [`Solid::new`] and of the masses.
    pub fn new<F: Reference<N, D, Q> + Copy>(
        family: F,
        mesh: &impl Elements<D, N>,
        lame: Lame<D>,
        [density, section]: [f64; 2],
        holds: impl Fn(&[f64; D], usize) -> bool,
    ) -> Result<Self, ElasticityError> {
        let nodes = mesh.nodes();
        let freedoms = Freedoms::held_where(&nodes, holds)?;
        Ok(Vibration {
            solid: Solid::new(family, mesh, section, Linear::new(lame), freedoms.clone())?,
            galerkin: galerkin_mass(family, mesh, [density, section], &freedoms)?,
            lumped: lumped_mass(family, mesh, [density, section], &freedoms)?,
            q: freedoms.gathered(&nodes)?,
        })
    }
}

/// A bar along the first axis, of density, section and Young's modulus 1, held at x = 0.
///
/// # Errors
/// Those of [`Vibration::new`].
pub fn vibrating_bar<F: Reference<N, 1, Q> + Copy, const N: usize, const Q: usize>(
    family: F,
    mesh: &impl Elements<1, N>,
) -> Result<Vibration<N, 1, Q>, ElasticityError> {
    let lame = Lame::from_young_poisson(1.0, 0.0)?;
    Vibration::new(family, mesh, lame, [1.0, 1.0], |x, _| x[0] == 0.0)
}

/// A sheet of thickness, density and Young's modulus 1 in plane stress, with Poisson's ratio 0 so
/// that a clamp has no singular corners, and held as `ends` says.
///
/// # Errors
/// Those of [`Vibration::new`].
pub fn vibrating_beam<F: Reference<N, 2, Q> + Copy, const N: usize, const Q: usize>(
    family: F,
    mesh: &impl Elements<2, N>,
    ends: super::Ends,
) -> Result<Vibration<N, 2, Q>, ElasticityError> {
    let lame = Lame::<3>::from_young_poisson(1.0, 0.0)?.plane_stress();
    Vibration::new(family, mesh, lame, [1.0, 1.0], |x, _| {
        ends == super::Ends::Clamped && x[0] == 0.0
    })
}

/// The pair of the sliding block.
fn block_pair() -> Result<Lame<3>, ElasticityError> {
    Lame::from_young_poisson(1.0, 0.3)
}

/// A block with a corner at the origin, of density and Young's modulus 1 and Poisson's ratio 0.3,
/// whose faces slide along themselves and do not leave their planes.
///
/// # Errors
/// Those of [`Vibration::new`].
pub fn sliding_block<F: Reference<N, 3, Q> + Copy, const N: usize, const Q: usize>(
    family: F,
    mesh: &impl Elements<3, N>,
    size: [f64; 3],
) -> Result<Vibration<N, 3, Q>, ElasticityError> {
    Vibration::new(family, mesh, block_pair()?, [1.0, 1.0], |x, c| x[c] == 0.0 || x[c] == size[c])
}

/// No list of frequencies is longer.
const MOST: usize = 1_000_000;
/// From one bound of the search to the next: of waves of three dimensions about twice as many are below it.
const WIDER: f64 = 1.25;

/// The lowest angular frequencies of [`sliding_block`], rad/s.
///
/// # Errors
/// [`ElasticityError::Count`] for more than a million of them; [`ElasticityError::Length`] for sizes that are
/// not positive and finite, or whose frequencies or their squares leave the range of numbers.
pub fn sliding_block_frequencies(
    size: [f64; 3],
    count: usize,
) -> Result<Vec<f64>, ElasticityError> {
    if count > MOST {
        return Err(ElasticityError::Count { asked: count, least: 0, most: MOST });
    }
    let lame = block_pair()?;
    let speeds = [(lame.lambda() + 2.0 * lame.mu()).sqrt(), lame.mu().sqrt()];
    if let Some(&length) = size.iter().find(|&&length| !(length > 0.0 && length.is_finite())) {
        return Err(ElasticityError::Length(length));
    }
    let longest = size.into_iter().fold(0.0, f64::max);
    let mut bound = 2.0 * PI / longest;
    // The squares of the bounds of a million waves, up and down.
    if !(1e-280..1e280).contains(&(bound * bound)) {
        return Err(ElasticityError::Length(longest));
    }
    loop {
        let mut all = waves_below(bound, size, speeds);
        if all.len() >= count {
            all.sort_by(f64::total_cmp);
            all.truncate(count);
            return Ok(all);
        }
        bound *= WIDER;
    }
}

/// The frequencies of a block that are not above the bound times the speed of shear.
fn waves_below(bound: f64, size: [f64; 3], speeds: [f64; 2]) -> Vec<f64> {
    // A wave's part along an axis, up to the bound.
    let parts = |axis: usize| {
        let part = move |k: usize| PI * k as f64 / size[axis];
        (0..).map(part).take_while(move |&part| part <= bound)
    };
    let mut all = Vec::new();
    for x in parts(0) {
        for y in parts(1) {
            for z in parts(2) {
                let length = [x, y, z].map(|k| k * k).iter().sum::<f64>().sqrt();
                if length > bound {
                    break;
                }
                let shears = [x, y, z].iter().filter(|&&k| k > 0.0).count();
                if shears > 0 && speeds[0] * length <= speeds[1] * bound {
                    all.push(speeds[0] * length);
                }
                all.extend((1..shears).map(|_| speeds[1] * length));
            }
        }
    }
    all
}

/// The membrane of NAFEMS FV32, on a mesh of its shape.
///
/// # Errors
/// Those of [`Vibration::new`].
pub fn fv32<F: Reference<N, 2, Q> + Copy, const N: usize, const Q: usize>(
    family: F,
    mesh: &impl Elements<2, N>,
) -> Result<Vibration<N, 2, Q>, ElasticityError> {
    let lame = Lame::<3>::from_young_poisson(200e9, 0.3)?.plane_stress();
    Vibration::new(family, mesh, lame, [8e3, 0.05], |x, _| x[0] == 0.0)
}

/// The k-th angular frequency (k = 1, 2, ..., n) of [`vibrating_bar`] of a length, rad/s: of the
/// continuum, and of n linear cells with lumped and with Galerkin's mass.
///
/// # Errors
/// [`ElasticityError::Count`] for a k that is 0 or above the number of cells, whose frequencies are no more;
/// [`ElasticityError::Length`] for a length that is not positive and finite, or whose frequencies are not.
pub fn bar_frequencies(length: f64, cells: usize, k: usize) -> Result<[f64; 3], ElasticityError> {
    if !(1..=cells).contains(&k) {
        return Err(ElasticityError::Count { asked: k, least: 1, most: cells });
    }
    let n = cells as f64;
    let t = (k as f64 - 0.5) * PI / n;
    let galerkin = (6.0 * (1.0 - t.cos()) / (2.0 + t.cos())).sqrt();
    let all = [t, 2.0 * (0.5 * t).sin(), galerkin].map(|w| w * n / length);
    if length > 0.0 && all.iter().all(|w| w.is_finite() && *w > 0.0) {
        Ok(all)
    } else {
        Err(ElasticityError::Length(length))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sliding_block_has_one_wave_of_pressure_and_a_shear_wave_less_than_its_sides_with_waves() {
        let lame = block_pair().unwrap();
        let (pressure, shear) = ((lame.lambda() + 2.0 * lame.mu()).sqrt(), lame.mu().sqrt());
        // Waves of one along the long side, and of both kinds along two or three.
        let length = |squares: f64| PI * squares.sqrt();
        let mut expected = vec![pressure * length(0.25)];
        expected.extend([shear * length(1.25); 2]);
        expected.extend([shear * length(2.0); 3]);
        expected.extend([shear * length(2.25); 2]);
        let found = sliding_block_frequencies([2.0, 1.0, 1.0], 8).unwrap();
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found / expected - 1.0).abs() < 1e-14, "{found} {expected}");
        }
    }

    #[test]
    fn blocks_and_bars_without_frequencies_are_refused() {
        for length in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-200, 1e200] {
            let error = sliding_block_frequencies([length; 3], 4).unwrap_err();
            assert!(matches!(error, ElasticityError::Length(_)), "{error}");
        }
        for size in [[0.0, 1.0, 1.0], [1.0, f64::INFINITY, 1.0], [1.0, 1.0, f64::NAN]] {
            let error = sliding_block_frequencies(size, 4).unwrap_err();
            assert!(matches!(error, ElasticityError::Length(_)), "{error}");
        }
        for count in [3_000_000, usize::MAX] {
            let error = sliding_block_frequencies([1.0; 3], count).unwrap_err();
            assert!(matches!(error, ElasticityError::Count { .. }), "{error}");
        }
        for k in [0, 3, 5, usize::MAX] {
            let error = bar_frequencies(1.0, 2, k).unwrap_err();
            assert!(matches!(error, ElasticityError::Count { .. }), "{error}");
        }
        for length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = bar_frequencies(length, 2, 1).unwrap_err();
            assert!(matches!(error, ElasticityError::Length(_)), "{error}");
        }
        assert!(bar_frequencies(1.0, 2, 2).is_ok());
    }

    #[test]
    fn a_rod_of_a_block_has_the_waves_along_it_and_many_blocks_have_all_in_order() {
        let lame = block_pair().unwrap();
        let pressure = (lame.lambda() + 2.0 * lame.mu()).sqrt();
        let rod = sliding_block_frequencies([1.0, 1e-150, 1e-9], 50).unwrap();
        for (mode, omega) in rod.iter().enumerate() {
            assert!((omega / (pressure * PI * (mode + 1) as f64) - 1.0).abs() < 1e-14);
        }
        let many = sliding_block_frequencies([1.0, 0.7, 0.4], 20_000).unwrap();
        assert!(many.len() == 20_000 && many.is_sorted());
        let few = sliding_block_frequencies([1.0, 0.7, 0.4], 100).unwrap();
        assert_eq!(few, many[..100]);
    }
}
