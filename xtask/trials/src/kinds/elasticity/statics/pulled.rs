//! A body that is pulled at one face: `P_11 = t`, `P_22 = P_33 = 0`, solved by a Newton's method of the
//! trial's own.

use stationary_elasticity::{DeadLoad, Freedoms, Held, Material, Reference};

use super::super::law::{Law, Moduli, density, derivatives, unit};
use super::EPS;
use super::block::{Block, OnBlock};
use crate::{Draw, Verdict};

/// One face is pulled, the opposite one slides on its plane.
pub struct Pulled;

impl OnBlock for Pulled {
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
        let strain = draw.log_uniform(1e-9, 0.15) * if draw.chance(0.3) { -1.0 } else { 1.0 };
        let traction = strain * block.lame.young();
        draw.note(format!("pulled with {traction:e} N/m^2, strain of {strain:e}"));
        let guess = [1.0 + strain, 1.0 - block.lame.poisson() * strain];
        let Some([along, across]) = uniaxial(block.law, block.pair(), D, traction, guess) else {
            return Verdict::not_judged("no stretch bears this load");
        };
        let mut held = Vec::new();
        for (vertex, x) in block.mesh.vertices().iter().enumerate() {
            let on_planes = (0..D).filter(|&c| x[c] <= 1e-9 * block.size[c]);
            held.extend(on_planes.map(|component| Held { vertex, component, place: x[component] }));
        }
        let ends: Vec<f64> = held.iter().map(|h| h.place).collect();
        let problem = block.held(&held, &ends);
        let places = block.places();
        // Each facet of the far face hands an equal share of its load to its corners.
        let facets = facets_at_end(block);
        let area: f64 = block.size[1..].iter().product();
        let load = |freedoms: &Freedoms<D>| {
            let mut forces = vec![[0.0; D]; places.len()];
            for facet in &facets {
                for &vertex in facet {
                    forces[vertex][0] += traction * area / (facets.len() * D) as f64;
                }
            }
            DeadLoad::new(freedoms, forces)
        };
        let rest = match problem.solve(family, &block.mesh, material, &places, &load) {
            Ok(rest) => rest,
            Err(error) => return Verdict::refused(error),
        };
        let length = block.size[0];
        let error = rest.positions.iter().zip(&places).flat_map(|(got, x)| {
            (0..D).map(move |i| (got[i] - x[i] * if i == 0 { along } else { across }).abs())
        });
        let thin = length / block.size.iter().copied().fold(f64::INFINITY, f64::min);
        let promised = 1e-6 * strain.abs() * length + 1e3 * EPS * length * thin * thin;
        let verdict = Verdict::of(error.fold(0.0, f64::max), promised, "place of a vertex");
        let along = held.iter().zip(&rest.reactions).filter(|(h, _)| h.component == 0);
        let sum: f64 = along.map(|(_, f)| f).sum();
        let promised = 1e-7 * traction.abs() * area + 1e3 * EPS * block.pair().size() * area * thin;
        verdict.and(Verdict::of((sum + traction * area).abs(), promised, "reaction"))
    }
}

/// The stretches at which a law has the stress `t` along the first direction and none across.
fn uniaxial(law: Law, pair: Moduli, d: usize, t: f64, guess: [f64; 2]) -> Option<[f64; 2]> {
    let [mut along, mut across] = guess;
    let mut last = f64::INFINITY;
    for _ in 0..60 {
        let f: Vec<Vec<f64>> = (0..d)
            .map(|k| {
                (0..d)
                    .map(|i| {
                        if i != k {
                            0.0
                        } else if k == 0 {
                            along
                        } else {
                            across
                        }
                    })
                    .collect()
            })
            .collect();
        let first = unit(&f, (0, 0));
        let mut others = unit(&f, (1, 1));
        if d == 3 {
            others[2][2] = 1.0;
        }
        let of = |a: &[Vec<f64>], b: &[Vec<f64>]| {
            derivatives::<f64>(&f, [a, b], |f| density(law, pair, f))
        };
        let (aa, ab, bb) = (of(&first, &first), of(&first, &others), of(&others, &others));
        let (r, s) = (aa.first - t, bb.first);
        let det = aa.both * bb.both - ab.both * ab.both;
        let step = [(bb.both * r - ab.both * s) / det, (aa.both * s - ab.both * r) / det];
        along -= step[0];
        across -= step[1];
        let size = step[0].abs().max(step[1].abs());
        if size >= last && size < 1e-14 {
            let stable = aa.both > 0.0 && det > 0.0;
            return (stable && along > 0.0 && across > 0.0).then_some([along, across]);
        }
        last = size;
    }
    None
}

/// The facets of the face at the far end of the first direction, by their corners.
fn facets_at_end<const D: usize, const K: usize>(block: &Block<D, K>) -> Vec<Vec<usize>> {
    let at_end = |v: &&usize| block.mesh.vertices()[**v][0] >= (1.0 - 1e-9) * block.size[0];
    let facets = block.mesh.simplices().iter().filter_map(|nodes| {
        let facet: Vec<usize> = nodes.iter().filter(at_end).copied().collect();
        (facet.len() == D).then_some(facet)
    });
    let facets: Vec<_> = facets.collect();
    debug_assert!(facets.len() >= block.cells[1]);
    facets
}
