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

/// The lowest angular frequencies of [`sliding_block`], rad/s.
///
/// # Errors
/// None.
pub fn sliding_block_frequencies(
    size: [f64; 3],
    count: usize,
) -> Result<Vec<f64>, ElasticityError> {
    let lame = block_pair()?;
    let speeds = [(lame.lambda() + 2.0 * lame.mu()).sqrt(), lame.mu().sqrt()];
    let mut all = Vec::new();
    // Indices above the count belong to higher frequencies than that many others.
    let side = count + 1;
    for index in 0..side.pow(3) {
        let k = [index / (side * side), index / side % side, index % side];
        let waves = k.iter().zip(size).map(|(&k, size)| PI * k as f64 / size);
        let length = waves.map(|k| k * k).sum::<f64>().sqrt();
        let shears = k.iter().filter(|&&k| k > 0).count();
        if shears > 0 {
            all.push(speeds[0] * length);
            all.extend((1..shears).map(|_| speeds[1] * length));
        }
    }
    all.sort_by(f64::total_cmp);
    all.truncate(count);
    Ok(all)
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

/// The k-th angular frequency (k = 1, 2, ...) of [`vibrating_bar`] of a length, rad/s: of the
/// continuum, and of n linear cells with lumped and with Galerkin's mass.
pub fn bar_frequencies(length: f64, cells: usize, k: usize) -> [f64; 3] {
    let n = cells as f64;
    let t = (k as f64 - 0.5) * PI / n;
    let galerkin = (6.0 * (1.0 - t.cos()) / (2.0 + t.cos())).sqrt();
    [t, 2.0 * (0.5 * t).sin(), galerkin].map(|w| w * n / length)
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
}
