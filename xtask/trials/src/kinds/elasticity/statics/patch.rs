//! The patch test: the hull follows a uniform deformation `F X + t`, and so does the inside.

use nalgebra::Cholesky;
use stationary_elasticity::{DeadLoad, Freedoms, Material, Reference};

use super::EPS;
use super::block::{Block, OnBlock};
use super::problem::{clamp, free, plain};
use crate::{Draw, Verdict};

/// The hull follows a uniform deformation; so does the inside.
pub struct Patch;

impl OnBlock for Patch {
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
        let strain = draw.log_uniform(1e-9, 0.15);
        let gradient: Vec<Vec<f64>> =
            (0..D).map(|_| draw.vector(D).into_iter().map(|x| strain * x).collect()).collect();
        draw.note(format!("patch of displacement gradient {gradient:?}"));
        let shift: Vec<f64> = draw.vector(D);
        let moved = |x: &[f64; D]| -> [f64; D] {
            std::array::from_fn(|i| {
                let along: f64 = (0..D).map(|k| gradient[k][i] * x[k]).sum();
                x[i] + along + strain * block.size[0] * shift[i]
            })
        };
        let places = block.places();
        let outer = |&vertex: &usize| block.is_outer(&block.mesh.vertices()[vertex]);
        let held = clamp((0..places.len()).filter(outer), &places);
        let ends: Vec<f64> = held.iter().map(|h| moved(&places[h.vertex])[h.component]).collect();
        let problem = block.held(&held, &ends);
        let none = |freedoms: &Freedoms<D>| DeadLoad::new(freedoms, vec![[0.0; D]; places.len()]);
        let rest = match problem.solve(family, &block.mesh, material, &places, &none) {
            Ok(rest) => rest,
            Err(error) => return Verdict::refused(error),
        };
        let length = block.size[0];
        let error = rest.positions.iter().zip(&places).flat_map(|(got, x)| {
            let expected = moved(x);
            (0..D).map(move |i| (got[i] - expected[i]).abs())
        });
        let thin = length / block.size.iter().copied().fold(f64::INFINITY, f64::min);
        let promised = 1e-7 * strain * length + 1e3 * EPS * length * thin;
        let error = error.fold(0.0, f64::max);
        if error > promised {
            // What is pressed so far that it buckles rests elsewhere.
            let uniform: Vec<[f64; D]> = places.iter().map(moved).collect();
            let free = free(places.len(), D, &held);
            let stiffness = block.body().hessian(&plain(&uniform));
            let stiffness = stiffness.select_rows(&free).select_columns(&free);
            if Cholesky::new(stiffness).is_none() {
                return Verdict::not_judged("the uniform state buckles");
            }
        }
        let verdict = Verdict::of(error, promised, "place of an inner vertex");
        // No load: the supports push against one another.
        let volume: f64 = block.size.iter().product();
        let scale = block.pair().size() * volume / (length / thin);
        (0..D).fold(verdict, |verdict, c| {
            let along = held.iter().zip(&rest.reactions).filter(|(h, _)| h.component == c);
            let sum: f64 = along.map(|(_, f)| f).sum();
            let promised = (1e-9 * strain + 1e4 * EPS) * scale;
            verdict.and(Verdict::of(sum.abs(), promised, "sum of the reactions"))
        })
    }
}
