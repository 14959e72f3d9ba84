//! Springs between points that bodies carry, and to places of the world.
//!
//! ```text
//! V(x_1(q), x_2(q)),     dV = sum f_i dx_i,     f_i = dV/dx_i
//! d2V = sum dx_i^T (d2V/dx_i dx_j) dx_j + sum f_i d2x_i
//! f d2x = -f.R c                              in the plane, by the angle twice
//! f d2x = (G.a)(b.c)/2 + (a.c)(G.b)/2 - (G.c)(a.b),     G = R^T f     in space, by turns a and b
//! ```
//! `c` the point and `a b` in body axes. Of the [`Spring`] the law alone is taken.

use stationary_calculus::{Covector, Curvature, Potential, PotentialOn, Sink, Stencil, array};
use stationary_elasticity::Spring;
use stationary_rigid::Poses;

use crate::assemble::anchor::Anchor;
use crate::assemble::error::AssemblyError;
use crate::assemble::vertices::Vertices;
use crate::model::scene::Scene;
use crate::model::turned::turn_back;

/// The potential of springs between points of bodies that have `each` freedoms.
#[derive(Clone, Debug)]
pub(crate) struct PointSprings {
    freedoms: usize,
    each: usize,
    springs: Vec<(Spring, [Anchor; 2])>,
}

impl Scene {
    /// The springs of a scene of bodies, but for those to pins that move.
    pub(crate) fn point_springs(&self, each: usize) -> Result<PointSprings, AssemblyError> {
        let vertices = Vertices::new(self);
        let still = self.links.iter().filter(|l| l.ends.iter().all(|&end| !self.drives.moves(end)));
        let springs = still.map(|link| {
            let spring = Spring::new([0, 1], link.rest_length, link.stiffness, link.strain)?;
            Ok((spring, link.ends.map(|end| self.anchor(end, &vertices))))
        });
        let springs = springs.collect::<Result<_, AssemblyError>>()?;
        Ok(PointSprings { freedoms: each * self.bodies.len(), each, springs })
    }
}

impl PointSprings {
    fn places(&self, ends: &[Anchor; 2], q: &[f64]) -> [[f64; 3]; 2] {
        ends.each_ref().map(|end| end.place(q, self.each))
    }

    /// How an end moves with the freedoms of its body, and what its acceleration adds to the Hessian.
    fn moves(&self, end: &Anchor, q: &[f64], force: [f64; 3]) -> (Vec<(usize, [f64; 3])>, Turns) {
        let mut columns: Vec<(usize, [f64; 3])> = Vec::new();
        for c in 0..3 {
            let mut unit = [0.0; 3];
            unit[c] = 1.0;
            end.pull(q, self.each, &unit, &mut |freedom, along| match columns
                .iter_mut()
                .find(|(other, _)| *other == freedom)
            {
                Some((_, column)) => column[c] = along,
                None => {
                    let mut column = [0.0; 3];
                    column[c] = along;
                    columns.push((freedom, column));
                }
            });
        }
        let Anchor::Body(body, c) = *end else { return (columns, Turns::default()) };
        if self.each == 3 {
            let centre = Anchor::Body(body, [0.0; 3]).place(q, 3);
            let arm = end.place(q, 3);
            let along = (0..2).map(|k| force[k] * (arm[k] - centre[k])).sum::<f64>();
            return (columns, Turns { first: 3 * body + 2, block: vec![-along] });
        }
        let g = turn_back(array(|k| q[7 * body + 3 + k]), force);
        let along: f64 = (0..3).map(|k| g[k] * c[k]).sum();
        let block = (0..9).map(|entry| {
            let (i, j) = (entry % 3, entry / 3);
            0.5 * (g[i] * c[j] + c[i] * g[j]) - if i == j { along } else { 0.0 }
        });
        (columns, Turns { first: 6 * body + 3, block: block.collect() })
    }
}

/// What a force at an end adds to the Hessian by the turns of its body.
#[derive(Default)]
struct Turns {
    first: usize,
    block: Vec<f64>,
}

impl PotentialOn<Poses> for PointSprings {}

impl Potential for PointSprings {
    fn dim(&self) -> usize {
        self.freedoms
    }

    fn energy(&self, q: &[f64]) -> f64 {
        let energy = |(spring, ends): &(Spring, [Anchor; 2])| {
            Stencil::<2, 3>::energy(spring, &self.places(ends, q))
        };
        self.springs.iter().map(energy).sum()
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        for (spring, ends) in &self.springs {
            let forces = Stencil::<2, 3>::differential(spring, &self.places(ends, q));
            for (end, force) in ends.iter().zip(&forces) {
                end.pull(q, self.each, force, &mut |freedom, f| dv.0[freedom] += f);
            }
        }
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        for (spring, ends) in &self.springs {
            let places = self.places(ends, q);
            let forces = Stencil::<2, 3>::differential(spring, &places);
            let curved = Stencil::<2, 3>::hessian(spring, &places, Curvature::Exact);
            let moved = [0, 1].map(|end| self.moves(&ends[end], q, forces[end]));
            let columns: Vec<(usize, usize, [f64; 3])> = [0, 1]
                .into_iter()
                .flat_map(|end| moved[end].0.iter().map(move |&(f, column)| (end, f, column)))
                .collect();
            let freedoms: Vec<usize> = columns.iter().map(|&(_, freedom, _)| freedom).collect();
            let mut block = Vec::with_capacity(columns.len() * columns.len());
            for &(b, _, along) in &columns {
                for &(a, _, across) in &columns {
                    let terms =
                        (0..9).map(|k| along[k / 3] * curved[b][k / 3][a][k % 3] * across[k % 3]);
                    block.push(terms.sum());
                }
            }
            hessian.add_symmetric(&freedoms, &block);
            // What stays has no turns.
            for (_, Turns { first, block }) in moved.iter().filter(|(_, t)| !t.block.is_empty()) {
                let turns = if block.len() == 9 { 3 } else { block.len() };
                let freedoms: Vec<usize> = (*first..first + turns).collect();
                hessian.add_symmetric(&freedoms, block);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use stationary_calculus::{Flat, assert_derivatives_on};
    use stationary_elasticity::Strain;

    use super::*;

    fn springs(each: usize) -> PointSprings {
        let (a, b) = ([0.3, -0.2, 0.5], [-0.4, 0.1, 0.2]);
        let flat = |[x, y, z]: [f64; 3]| [x, y, if each == 3 { 0.0 } else { z }];
        let law = |strain| Spring::new([0, 1], 0.7, 3.0, strain).unwrap();
        let springs = vec![
            (law(Strain::Cauchy), [Anchor::Body(0, flat(a)), Anchor::Body(1, flat(b))]),
            (law(Strain::Green), [Anchor::World(flat([2.0, 1.0, 1.0])), Anchor::Body(1, flat(a))]),
            (
                law(Strain::Cauchy),
                [Anchor::Body(0, flat(b)), Anchor::World(flat([-1.0, 1.0, 2.0]))],
            ),
        ];
        PointSprings { freedoms: 2 * each, each, springs }
    }

    #[test]
    fn differentials_and_hessians_are_those_of_the_energy_in_the_plane_and_in_space() {
        assert_derivatives_on(&Flat, &springs(3), &[0.1, 0.2, 0.7, 1.3, -0.4, -2.1]);
        let q = [0.1, 0.2, 0.3, 0.8, 0.0, 0.36, 0.48, 1.5, -0.5, 0.3, 0.6, 0.48, 0.64, 0.0];
        assert_derivatives_on(&Poses, &springs(6), &q);
    }
}
