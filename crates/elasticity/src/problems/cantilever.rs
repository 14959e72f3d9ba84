//! A beam, clamped at one end and pushed sideways at the other.
//!
//! ```text
//! tip = P L^3/(3 E I) + 6 P L/(5 G A),   I = b h^3/12,  A = b h         Timoshenko
//! ```
//! `L h b` length, height and thickness (m), `P` the push (N), in linear elasticity. Beam theory
//! knows nothing of the clamp's corners, so elements converge to a slightly stiffer answer: a fine
//! mesh of quadratic elements is the reference. In plane strain E becomes E/(1 - nu^2), and as nu
//! goes to 1/2 linear triangles lock: they have no way to bend without changing their area. They do
//! so where all cells are cut alike; cut in turn one way and the other, four triangles around a
//! vertex find a way. Source: Timoshenko (1921); Hughes, The Finite Element Method (2000).

use stationary_mesh::{Diagonals, QuadraticTriangles, rectangle};

use crate::{
    DeadLoad, ElasticityError, Elements, Freedoms, Lame, Linear, LinearSegment, LinearTriangle,
    QuadraticSegment, QuadraticTriangle, Reference, Solid, Statics, curved_boundary, lumped_mass,
    straight_boundary,
};

/// Which triangles a sheet is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SheetFamily {
    /// Three nodes, constant strain.
    Linear,
    /// Six nodes.
    Quadratic,
}

/// What a sheet of some freedoms says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    /// The freedoms that were solved for.
    pub freedoms: usize,
    /// The answer: a stress (Pa) or a deflection (m).
    pub value: f64,
}

/// A beam of unit thickness in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Length and height, m.
    pub size: [f64; 2],
    /// The pair of the plane.
    pub lame: Lame<2>,
    /// The push, N.
    pub push: f64,
    /// How its cells are cut into triangles.
    pub diagonals: Diagonals,
}

impl Beam {
    /// The deflection of the tip by Timoshenko's theory, m.
    pub fn deflection(&self) -> f64 {
        let [length, height] = self.size;
        let inertia = height.powi(3) / 12.0;
        // In the plane, Young's modulus is that of the plane's own pair.
        let bending = self.push * length.powi(3) / (3.0 * self.lame.young() * inertia);
        bending + 1.2 * self.push * length / (self.lame.mu() * height)
    }

    /// The deflection of the middle of the tip by elements, m.
    ///
    /// # Errors
    /// [`ElasticityError::Mesh`] for sizes and cells that make no sheet; [`ElasticityError::Load`]
    /// for a push that is not finite; [`ElasticityError::Statics`] where no rest is found.
    pub fn solved(&self, family: SheetFamily, cells: [usize; 2]) -> Result<Sheet, ElasticityError> {
        let mesh = rectangle(self.size, cells, self.diagonals)?;
        match family {
            SheetFamily::Linear => {
                let rim = straight_boundary(&mesh)?;
                self.tip((LinearTriangle, &mesh), (LinearSegment, &rim))
            }
            SheetFamily::Quadratic => {
                let mesh = QuadraticTriangles::straight(&mesh);
                let rim = curved_boundary(&mesh)?;
                self.tip((QuadraticTriangle, &mesh), (QuadraticSegment, &rim))
            }
        }
    }

    fn tip<F, S, const N: usize, const Q: usize, const B: usize, const P: usize>(
        &self,
        (family, mesh): (F, &impl Elements<2, N>),
        (edge, rim): (S, &impl Elements<2, B>),
    ) -> Result<Sheet, ElasticityError>
    where
        F: Reference<N, 2, Q> + Copy,
        S: Reference<B, 1, P>,
    {
        let nodes = mesh.nodes();
        let freedoms = Freedoms::held_where(&nodes, |x, _| x[0] == 0.0)?;
        let mut solid = Solid::new(family, mesh, 1.0, Linear::new(self.lame), freedoms.clone())?;
        let shear = self.push / self.size[1];
        let load = DeadLoad::traction(edge, rim, 1.0, &freedoms, |_, normal| {
            [0.0, if normal[0] > 0.999 { shear } else { 0.0 }]
        })?;
        let metric = lumped_mass(family, mesh, [1.0, 1.0], &freedoms)?;
        let mut q = freedoms.gathered(&nodes)?;
        let places = freedoms.places().to_vec();
        Statics::default().solve(&mut solid, &load, &metric, &places, &mut q)?;
        let positions = freedoms.positions(&q)?;
        // Cells side by side end at the length but for rounding.
        let end = nodes.iter().map(|node| node[0]).fold(0.0, f64::max);
        let tip: Vec<f64> = (0..nodes.len())
            .filter(|&node| nodes[node][0] == end)
            .map(|node| positions[node][1] - nodes[node][1])
            .collect();
        let value = tip.iter().sum::<f64>() / tip.len() as f64;
        Ok(Sheet { freedoms: freedoms.dim(), value })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_that_cells_miss_by_a_rounding_has_a_tip() {
        let missed = |length: &f64| length * 3.0 / 3.0 != *length;
        let lengths = (1..100).map(|k| 0.45 + 1e-3 * f64::from(k) / 7.0).filter(missed);
        for length in lengths.take(3) {
            let lame = Lame::from_young_poisson(1e6, 0.3).unwrap();
            let beam = Beam { size: [length, 0.1], lame, push: 1.0, diagonals: Diagonals::Same };
            for family in [SheetFamily::Linear, SheetFamily::Quadratic] {
                let value = beam.solved(family, [3, 1]).unwrap().value;
                assert!(value > 0.1 * beam.deflection(), "{length}: {value:e}");
            }
        }
    }
}
