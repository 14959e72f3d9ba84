//! Sheets and blocks of random size, cells, law and moduli.

use nalgebra::SVector;
use stationary_elasticity::{
    FixedCorotated, Held, Lame, Linear, LinearTetrahedron, LinearTriangle, Material, NeoHookean,
    Reference, SaintVenantKirchhoff,
};
use stationary_mesh::{Diagonals, Mesh, cuboid, rectangle};

use super::super::body::{Body, moduli};
use super::super::law::{Law, Moduli, with_material};
use super::problem::{Problem, plain};
use crate::{Draw, Verdict};

/// A block or a sheet: its mesh, its size, its law.
pub struct Block<const D: usize, const K: usize> {
    pub mesh: Mesh<D, K>,
    pub size: [f64; D],
    pub cells: [usize; D],
    pub law: Law,
    pub lame: Lame<D>,
    pub density: f64,
    pub steps: usize,
}

impl<const D: usize, const K: usize> Block<D, K> {
    pub fn new(
        draw: &mut Draw,
        most: usize,
        make: impl Fn([f64; D], [usize; D]) -> Option<Mesh<D, K>>,
    ) -> Option<Self> {
        let length = draw.log_uniform(1e-6, 1e6);
        let mut size = [length; D];
        for side in &mut size[1..] {
            *side *= if draw.chance(0.5) { draw.log_uniform(0.05, 1.0) } else { 1.0 };
        }
        let mut cells = [1; D];
        for count in &mut cells {
            *count = draw.between(1, most);
        }
        let law = draw.one_of(&Law::ALL);
        let [young, poisson] = moduli(draw);
        let lame = Lame::<D>::from_young_poisson(young, poisson).ok()?;
        let (density, steps) = (draw.log_uniform(1e-3, 1e4), draw.between(1, 3));
        draw.note(format!(
            "{law:?}, {size:?} m in {cells:?} cells, E = {young:e}, nu = {poisson}, {steps} steps"
        ));
        Some(Block { mesh: make(size, cells)?, size, cells, law, lame, density, steps })
    }

    pub fn pair(&self) -> Moduli {
        Moduli { lambda: self.lame.lambda(), mu: self.lame.mu() }
    }

    pub fn places(&self) -> Vec<[f64; D]> {
        self.mesh.vertices().iter().map(|x| (*x).into()).collect()
    }

    pub fn body(&self) -> Body {
        let rest = plain(&self.places());
        let elements = self.mesh.simplices().iter().map(|nodes| nodes.to_vec());
        Body::new((self.law, self.pair()), &rest, elements, 1.0)
    }

    /// Whether the vertex is on the hull.
    pub fn is_outer(&self, x: &SVector<f64, D>) -> bool {
        (0..D).any(|c| x[c] <= 1e-9 * self.size[c] || x[c] >= (1.0 - 1e-9) * self.size[c])
    }

    /// The block held at some coordinates, which go where they end.
    pub fn held<'a>(&self, held: &'a [Held], ends: &'a [f64]) -> Problem<'a, D> {
        Problem { held, ends, density: self.density, section: 1.0, steps: self.steps }
    }
}

fn sheet(size: [f64; 2], cells: [usize; 2]) -> Option<Mesh<2, 3>> {
    rectangle(size, cells, Diagonals::Alternating).ok()
}

fn block(size: [f64; 3], cells: [usize; 3]) -> Option<Mesh<3, 4>> {
    cuboid(size, cells).ok()
}

/// What is asked of blocks and sheets of any material.
pub trait OnBlock {
    fn of<F, M, const D: usize, const K: usize>(
        draw: &mut Draw,
        block: &Block<D, K>,
        family: F,
        material: M,
    ) -> Verdict
    where
        F: Reference<K, D, 1> + Copy,
        M: Material<D, D>;
}

/// Asks it of a block or a sheet with at most so many cells along a side.
pub fn in_plane_or_space<A: OnBlock>(draw: &mut Draw, most: usize) -> Verdict {
    match draw.chance(0.5) {
        true => match Block::<3, 4>::new(draw, most, block) {
            Some(block) => of_its_law::<A, _, 3, 4>(draw, &block, LinearTetrahedron),
            None => Verdict::not_judged("no such block"),
        },
        false => match Block::<2, 3>::new(draw, most, sheet) {
            Some(sheet) => of_its_law::<A, _, 2, 3>(draw, &sheet, LinearTriangle),
            None => Verdict::not_judged("no such sheet"),
        },
    }
}

fn of_its_law<A: OnBlock, F, const D: usize, const K: usize>(
    draw: &mut Draw,
    block: &Block<D, K>,
    family: F,
) -> Verdict
where
    F: Reference<K, D, 1> + Copy,
    Linear<D>: Material<D, D>,
    SaintVenantKirchhoff<D>: Material<D, D>,
    NeoHookean<D>: Material<D, D>,
    FixedCorotated<D>: Material<D, D>,
{
    with_material!(block.law, block.lame, D, material => A::of(draw, block, family, material))
}
