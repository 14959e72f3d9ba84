//! Random loads and supports: one more Newton step, dense, moves nothing.

use stationary_elasticity::{DeadLoad, Freedoms, Held, Material, Reference};

use super::block::{Block, OnBlock};
use super::rest::judged;
use crate::{Draw, Verdict};

/// Random loads and supports: what is found is at rest, and stays there.
pub struct Loaded;

impl OnBlock for Loaded {
    fn of<F, M, const D: usize, const K: usize>(
        draw: &mut Draw,
        block: &Block<D, K>,
        family: F,
        material: M,
    ) -> Verdict
    where
        F: Reference<K, D, 1> + Copy,
        M: Material<D, D>,
    {
        let strain = draw.log_uniform(1e-9, 0.05);
        let places = block.places();
        let mut held = Vec::new();
        for (vertex, x) in places.iter().enumerate() {
            let clamped = x[0] <= 1e-9 * block.size[0];
            let also = draw.chance(0.1);
            for component in 0..D {
                if clamped || (also && draw.chance(0.5)) {
                    held.push(Held { vertex, component, place: x[component] });
                }
            }
        }
        let area: f64 = block.size[1..].iter().product();
        let thin = block.size.iter().copied().fold(f64::INFINITY, f64::min) / block.size[0];
        let force = strain * block.lame.young() * area * thin / places.len() as f64;
        let forces: Vec<[f64; D]> = places
            .iter()
            .map(|_| {
                let f = draw.vector(D);
                std::array::from_fn(|i| force * f[i])
            })
            .collect();
        draw.note(format!("{} coordinates held, forces of {force:e} N", held.len()));
        let ends: Vec<f64> = held.iter().map(|h| h.place).collect();
        let problem = block.held(&held, &ends);
        let load = |freedoms: &Freedoms<D>| DeadLoad::new(freedoms, forces.clone());
        let solved = problem.solve(family, &block.mesh, material, &places, &load);
        judged(solved, &block.body(), &places, &forces, &held)
    }
}
