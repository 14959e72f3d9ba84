//! One face is moved through the opposite one: no answer, as elements turn inside out.

use stationary_elasticity::{DeadLoad, Freedoms, Material, Reference};

use super::super::law::Law;
use super::super::shapes::rotation;
use super::block::{Block, OnBlock};
use super::problem::{clamp, plain};
use crate::{Draw, Verdict};

/// One face is moved through the opposite one: no answer, as elements turn inside out.
pub struct Crushed;

impl OnBlock for Crushed {
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
        let places = block.places();
        let at_face = |&vertex: &usize| {
            let along = places[vertex][0] / block.size[0];
            along <= 1e-9 || along >= 1.0 - 1e-9
        };
        let held = clamp((0..places.len()).filter(at_face), &places);
        let way = draw.uniform(1.05, 2.0);
        let turned = rotation(draw, D);
        let turn = draw.chance(0.3);
        draw.note(format!("crushed: one face goes {way} of the length, turned: {turn}"));
        let ends: Vec<f64> = held
            .iter()
            .map(|h| {
                let x = places[h.vertex];
                if x[0] <= 1e-9 * block.size[0] {
                    return h.place;
                }
                let mut x = x;
                x[0] -= way * block.size[0];
                if turn {
                    let y: [f64; D] =
                        std::array::from_fn(|i| (0..D).map(|j| turned[j][i] * x[j]).sum());
                    x = y;
                }
                x[h.component]
            })
            .collect();
        let problem = block.held(&held, &ends);
        let none = |freedoms: &Freedoms<D>| DeadLoad::new(freedoms, vec![[0.0; D]; places.len()]);
        match problem.solve(family, &block.mesh, material, &places, &none) {
            Ok(rest) => {
                let least = block.body().least_volume(&plain(&rest.positions));
                // The linear law knows of no volume: its answer is the linear one.
                if least > 0.0 || block.law == Law::Linear {
                    Verdict::due()
                } else {
                    Verdict::wrong(format!("Ok with an element of {least:e} times its volume"))
                }
            }
            Err(_) => Verdict::due(),
        }
    }
}
