//! Woven cloth: stiff along two threads at right angles, soft between them.
//!
//! ```text
//! S = 1/2 (F^T F - I) in the frame of the threads      warp 1, weft 2
//! W = 1/2 (c11 S11^2 + 2 c12 S11 S22 + c22 S22^2) + 2 g S12^2
//! c11 = E1/(1 - nu12 nu21),  c22 = E2/(1 - nu12 nu21),  c12 = nu12 c22,   nu21 = nu12 E2/E1
//! ```
//! `E1 E2` Young's moduli along warp and weft (Pa), `nu12` the thinning along the weft for a
//! stretch along the warp, `g` the shear modulus, all of plane stress. Positive for every strain if
//! the moduli are and nu12^2 < E1/E2. Quadratic in the entries of S and not in eigenvalues and an
//! angle, which has no value at zero strain (errata 13.1). With E1 = E2 and g = E/(2 (1 + nu)) it
//! is the isotropic sheet. For sheets in the plane and membranes in space; for small strains,
//! however large the motion.

use crate::tensor::{apply, dot, green};
use crate::{ElasticityError, FullTangent, Material, Real, Tangent};
use stationary_calculus::array;

/// Moduli of a woven sheet in plane stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weave {
    /// Young's modulus along the warp, Pa.
    pub warp: f64,
    /// Young's modulus along the weft, Pa.
    pub weft: f64,
    /// Thinning along the weft for a stretch along the warp.
    pub poisson: f64,
    /// Shear modulus, Pa.
    pub shear: f64,
    /// The angle from the first reference direction to the warp, radians.
    pub angle: f64,
}

/// The quadratic material of a woven sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orthotropic {
    /// c11, c22, c12 and g.
    stiffness: [f64; 4],
    /// Cosine and sine of the angle of the warp.
    warp: [f64; 2],
}

impl Orthotropic {
    /// The material of a weave.
    ///
    /// # Errors
    /// [`ElasticityError::Weave`] for moduli that are not positive and finite, that give energy
    /// away for some strain or whose stresses overflow, and for an angle that is not finite.
    pub fn new(weave: Weave) -> Result<Self, ElasticityError> {
        let Weave { warp, weft, poisson, shear, angle } = weave;
        let one = 1.0 - poisson * poisson * weft / warp;
        let positive = |modulus: f64| modulus > 0.0 && modulus.is_finite();
        if !([warp, weft, shear, one].into_iter().all(positive) && angle.is_finite()) {
            return Err(ElasticityError::Weave(weave));
        }
        let c22 = weft / one;
        let stiffness = [warp / one, c22, poisson * c22, shear];
        // Moduli so large that stresses overflow.
        if stiffness.iter().any(|c| c.abs() > 1e300) {
            return Err(ElasticityError::Weave(weave));
        }
        Ok(Orthotropic { stiffness, warp: [angle.cos(), angle.sin()] })
    }

    /// A reference vector by its components along warp and weft.
    #[inline(always)]
    fn along_threads<T: Real>(&self, g: &[T; 2]) -> [T; 2] {
        let [c, s] = self.warp;
        [g[0] * c + g[1] * s, g[1] * c - g[0] * s]
    }

    /// The images of unit vectors along warp and weft.
    #[inline(always)]
    fn threads<T: Real, const D: usize>(&self, f: &[[T; D]; 2]) -> [[T; D]; 2] {
        let [c, s] = self.warp.map(T::splat);
        [apply(f, &[c, s]), apply(f, &[-s, c])]
    }

    /// Strain S11, S22 and 2 S12, and the stress that goes with each.
    #[inline(always)]
    fn strain_and_stress<T: Real, const D: usize>(&self, f: &[[T; D]; 2]) -> [[T; 3]; 2] {
        let [c, s] = self.warp;
        let e = green(f);
        let sheared = e[0][1] * (2.0 * c * s);
        let strain = [
            e[0][0] * (c * c) + sheared + e[1][1] * (s * s),
            e[0][0] * (s * s) - sheared + e[1][1] * (c * c),
            (e[1][1] - e[0][0]) * (2.0 * c * s) + e[0][1] * (2.0 * (c * c - s * s)),
        ];
        [strain, self.stress_of(&strain)]
    }

    #[inline(always)]
    fn stress_of<T: Real>(&self, strain: &[T; 3]) -> [T; 3] {
        let [c11, c22, c12, g] = self.stiffness;
        [strain[0] * c11 + strain[1] * c12, strain[0] * c12 + strain[1] * c22, strain[2] * g]
    }
}

impl<const D: usize> Material<D, 2> for Orthotropic {
    type Tangent<T: Real> = OrthotropicTangent<T, D>;
    type Semidefinite<T: Real> = FullTangent<T, D, 2>;

    #[inline(always)]
    fn energy<T: Real>(&self, f: &[[T; D]; 2]) -> T {
        let [strain, stress] = self.strain_and_stress(f);
        dot(&strain, &stress) * 0.5
    }

    #[inline(always)]
    fn stress<T: Real>(&self, f: &[[T; D]; 2]) -> [[T; D]; 2] {
        let threads = self.threads(f);
        let [_, [s11, s22, s12]] = self.strain_and_stress(f);
        // By columns along the threads, then turned back to the reference directions.
        let warp = apply(&threads, &[s11, s12]);
        let weft = apply(&threads, &[s12, s22]);
        let [c, s] = self.warp;
        [array(|i| warp[i] * c - weft[i] * s), array(|i| warp[i] * s + weft[i] * c)]
    }

    #[inline(always)]
    fn tangent<T: Real>(&self, f: &[[T; D]; 2], weight: T) -> OrthotropicTangent<T, D> {
        let threads = self.threads(f);
        let [_, stress] = self.strain_and_stress(f);
        OrthotropicTangent {
            material: *self,
            threads,
            stress: stress.map(|entry| entry * weight),
            weight,
        }
    }

    fn semidefinite<T: Real>(&self, f: &[[T; D]; 2], weight: T) -> FullTangent<T, D, 2> {
        FullTangent::of(&self.tangent(f, weight)).projected()
    }
}

/// The second derivative of the energy of a woven sheet, times a weight.
#[derive(Clone, Copy, Debug)]
pub struct OrthotropicTangent<T, const D: usize> {
    material: Orthotropic,
    threads: [[T; D]; 2],
    stress: [T; 3],
    weight: T,
}

/// A gradient along the threads, how it strains, and the stress of that, by components of motion.
#[derive(Clone, Copy, Debug)]
pub struct OrthotropicNode<T, const D: usize> {
    gradient: [T; 2],
    strain: [[T; 3]; D],
    stress: [[T; 3]; D],
}

impl<T: Real, const D: usize> Tangent<T, D, 2> for OrthotropicTangent<T, D> {
    type Node = OrthotropicNode<T, D>;

    #[inline(always)]
    fn node(&self, gradient: &[T; 2]) -> OrthotropicNode<T, D> {
        let g = self.material.along_threads(gradient);
        let [warp, weft] = &self.threads;
        let strain: [[T; 3]; D] =
            array(|i| [warp[i] * g[0], weft[i] * g[1], warp[i] * g[1] + weft[i] * g[0]]);
        let stress = strain.map(|s| self.material.stress_of(&s).map(|entry| entry * self.weight));
        OrthotropicNode { gradient: g, strain, stress }
    }

    #[inline(always)]
    fn block(&self, a: &OrthotropicNode<T, D>, b: &OrthotropicNode<T, D>) -> [[T; D]; D] {
        let [s11, s22, s12] = self.stress;
        let on_b =
            [s11 * b.gradient[0] + s12 * b.gradient[1], s12 * b.gradient[0] + s22 * b.gradient[1]];
        let turned = dot(&a.gradient, &on_b);
        let mut block = b.stress.map(|stress| array(|i| dot(&a.strain[i], &stress)));
        for (j, column) in block.iter_mut().enumerate() {
            column[j] += turned;
        }
        block
    }
}
