//! Attraction between bodies that are balls or particles, and by pins that have a mass.
//!
//! ```text
//! V = - sum_{i<j} G m_i m_j / |x_i - x_j| - sum_{i,k} G m_i M_k / |x_i - X_k|
//! ```
//! `x` centres, `m` masses. Outside of a ball whose mass lies alike in all directions the attraction is that of a point
//! at its centre (Newton), so that it makes no torque; inside it is not, and a step that ends there fails.

use stationary_calculus::{Covector, Potential, PotentialOn, Sink, array};
use stationary_integrators::CentralGravity;
use stationary_rigid::Poses;

use crate::assemble::anchor::Anchor;
use crate::model::particle::Motion;
use crate::model::scene::Scene;

/// The potential of bodies that have `each` freedoms and attract as points at their centres do.
#[derive(Clone, Debug)]
pub(crate) struct BodyAttraction {
    freedoms: usize,
    each: usize,
    /// What attracts: bodies, then pins.
    all: Vec<Attracting>,
    bodies: usize,
    constant: f64,
}

#[derive(Clone, Debug)]
struct Attracting {
    mass: f64,
    at: Anchor,
    /// Up to here it is a ball.
    radius: f64,
}

/// What balls may overlap where they touch, as a part of their radii: the attraction changes by its square.
const OVERLAP: f64 = 1e-3;

impl Scene {
    /// The attraction between its bodies, where there is any.
    pub(crate) fn body_attraction(&self, each: usize) -> Option<BodyAttraction> {
        let constant = self.gravity.constant?;
        // Every body carries its centre, but for obstacles.
        let carried = self.particles.iter().filter_map(|particle| match particle.motion {
            Motion::Carried { body, .. } => Some(body + 1),
            _ => None,
        });
        let own = &self.bodies[..carried.max().unwrap_or(0)];
        let bodies = own.iter().enumerate().map(|(index, body)| Attracting {
            mass: body.mass,
            at: Anchor::Body(index, [0.0; 3]),
            radius: body.attracting_radius(),
        });
        let pins = self.still_attractors().map(|(pin, mass)| Attracting {
            mass,
            at: Anchor::World(self.particles[pin].position),
            radius: 0.0,
        });
        Some(BodyAttraction {
            freedoms: each * self.bodies.len(),
            each,
            all: bodies.chain(pins).collect(),
            bodies: own.len(),
            constant,
        })
    }

    /// The name of what attracts.
    pub(crate) fn attracting(&self, number: usize) -> &str {
        match number.checked_sub(self.bodies.len()) {
            None => &self.bodies[number].name,
            Some(pin) => {
                let (particle, _) = self.still_attractors().nth(pin).unwrap_or_default();
                &self.particles[particle].name
            }
        }
    }
}

impl BodyAttraction {
    /// Shows every pair, the body first, with the way from the second to the first.
    fn pairs(&self, q: &[f64], mut see: impl FnMut([usize; 2], [f64; 3])) {
        let place = |number: usize| self.all[number].at.place(q, self.each);
        for first in 0..self.bodies {
            let x = place(first);
            for second in first + 1..self.all.len() {
                let y = place(second);
                see([first, second], array(|c| x[c] - y[c]));
            }
        }
    }

    fn law(&self, pair: [usize; 2]) -> CentralGravity<3> {
        let [a, b] = pair.map(|number| self.all[number].mass);
        CentralGravity { strength: self.constant * a * b }
    }

    /// The first freedom of a body, none of a pin, and how many shifts it has.
    fn first(&self, number: usize) -> Option<usize> {
        (number < self.bodies).then_some(self.each * number)
    }

    fn shifts(&self) -> usize {
        if self.each == 6 { 3 } else { 2 }
    }

    /// The first two of which one's centre is within the other, or that overlap; the distance of their centres, and
    /// the sum of their radii.
    pub(crate) fn inside(&self, q: &[f64]) -> Option<([usize; 2], [f64; 2])> {
        let mut inside = None;
        self.pairs(q, |pair, apart| {
            let distance = apart.iter().map(|x| x * x).sum::<f64>().sqrt();
            let [a, b] = pair.map(|number| self.all[number].radius);
            if distance < (1.0 - OVERLAP) * (a + b) && inside.is_none() {
                inside = Some((pair, [distance, a + b]));
            }
        });
        inside
    }
}

impl PotentialOn<Poses> for BodyAttraction {}

impl Potential for BodyAttraction {
    fn dim(&self) -> usize {
        self.freedoms
    }

    fn energy(&self, q: &[f64]) -> f64 {
        let mut energy = 0.0;
        self.pairs(q, |pair, apart| energy += self.law(pair).energy(&apart));
        energy
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        self.pairs(q, |pair, apart| {
            let mut force = [0.0; 3];
            self.law(pair).add_differential(&apart, Covector(&mut force));
            for (number, sign) in pair.into_iter().zip([1.0, -1.0]) {
                let Some(first) = self.first(number) else { continue };
                for (row, f) in dv.0[first..][..self.shifts()].iter_mut().zip(force) {
                    *row += sign * f;
                }
            }
        });
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        let shifts = self.shifts();
        self.pairs(q, |pair, apart| {
            let mut own = Block([0.0; 9]);
            self.law(pair).add_hessian(&apart, &mut own);
            let ends = pair.into_iter().zip([1.0, -1.0]);
            let ends: Vec<(usize, f64)> =
                ends.filter_map(|(number, sign)| Some((self.first(number)?, sign))).collect();
            let all = || ends.iter().flat_map(|&(f, sign)| (0..shifts).map(move |c| (f, c, sign)));
            let freedoms: Vec<usize> = all().map(|(first, c, _)| first + c).collect();
            let column = |(_, d, of): (usize, usize, f64)| {
                all().map(move |(_, c, sign)| of * sign * own.0[3 * d + c])
            };
            let block: Vec<f64> = all().flat_map(column).collect();
            hessian.add_symmetric(&freedoms, &block);
        });
    }
}

/// The one block of a law.
#[derive(Clone, Copy)]
struct Block([f64; 9]);

impl Sink for Block {
    fn add_symmetric(&mut self, _: &[usize], block: &[f64]) {
        self.0.iter_mut().zip(block).for_each(|(sum, entry)| *sum += entry);
    }
}

#[cfg(test)]
mod tests {
    use stationary_calculus::{Flat, assert_derivatives_on};

    use super::*;

    fn attraction(each: usize) -> BodyAttraction {
        let of = |mass: f64, at| Attracting { mass, at, radius: 0.0 };
        let z = if each == 3 { 0.0 } else { 0.4 };
        let all = vec![
            of(1.5, Anchor::Body(0, [0.0; 3])),
            of(0.7, Anchor::Body(1, [0.0; 3])),
            of(2.0, Anchor::World([-1.0, 2.0, z])),
        ];
        BodyAttraction { freedoms: 2 * each, each, all, bodies: 2, constant: 1.3 }
    }

    #[test]
    fn differentials_and_hessians_are_those_of_the_energy_in_the_plane_and_in_space() {
        assert_derivatives_on(&Flat, &attraction(3), &[0.1, 0.2, 0.7, 1.3, -0.4, -2.1]);
        let q = [0.1, 0.2, 0.3, 0.8, 0.0, 0.36, 0.48, 1.5, -0.5, 0.3, 0.6, 0.48, 0.64, 0.0];
        assert_derivatives_on(&Poses, &attraction(6), &q);
    }
}
