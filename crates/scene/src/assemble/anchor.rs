//! Where an end of a spring or a damper is: in the world, at a particle, or at a point of a body.
//!
//! ```text
//! dx = v              of a particle
//! dx = v + w Z R c    of a body in the plane,      dx = v + R (w x c)    in space, w in body axes
//! ```
//! `c` the point in body axes, `Z` a quarter turn. A force `f` there acts on the freedoms by `f dx`.

#[cfg(feature = "elasticity")]
use stationary_calculus::Sink;
use stationary_calculus::array;

use crate::assemble::vertices::Vertices;
use crate::model::particle::{Motion, Particle};
use crate::model::scene::Scene;
use crate::model::turned::{cross, turn, turn_back};

/// An end of a spring or a damper.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Anchor {
    /// A place of the world.
    World([f64; 3]),
    /// A particle, by its first freedom.
    Particle(usize),
    /// A point of a body, in its axes.
    Body(usize, [f64; 3]),
}

impl Scene {
    /// Where a particle is held, among the freedoms of the scene.
    pub(crate) fn anchor(&self, particle: usize, vertices: &Vertices) -> Anchor {
        let Particle { position, motion, .. } = &self.particles[particle];
        match *motion {
            Motion::Carried { body, point } => Anchor::Body(body, point),
            Motion::Pinned => Anchor::World(*position),
            Motion::Free { .. } => {
                Anchor::Particle(self.dimension * vertices.of_particle[particle])
            }
        }
    }
}

impl Anchor {
    /// Where it is, of particles or bodies with `each` freedoms.
    pub(crate) fn place(&self, q: &[f64], each: usize) -> [f64; 3] {
        match *self {
            Anchor::World(place) => place,
            Anchor::Particle(first) => array(|c| if c < each { q[first + c] } else { 0.0 }),
            Anchor::Body(body, point) if each == 3 => {
                let (sin, cos) = q[3 * body + 2].sin_cos();
                let [a, b, _] = point;
                [q[3 * body] + cos * a - sin * b, q[3 * body + 1] + sin * a + cos * b, 0.0]
            }
            Anchor::Body(body, point) => {
                let arm = turn(array(|k| q[7 * body + 3 + k]), point);
                array(|c| q[7 * body + c] + arm[c])
            }
        }
    }

    /// Tells what a force there does to each freedom.
    pub(crate) fn pull(
        &self,
        q: &[f64],
        each: usize,
        force: &[f64; 3],
        tell: &mut dyn FnMut(usize, f64),
    ) {
        match self {
            Anchor::World(_) => {}
            Anchor::Particle(first) => {
                force.iter().take(each).enumerate().for_each(|(c, &f)| tell(first + c, f));
            }
            Anchor::Body(body, point) => {
                let wrench = wrench(q, *body, each, point, force, &[0.0; 3]);
                wrench.iter().take(each).enumerate().for_each(|(c, &f)| tell(each * body + c, f));
            }
        }
    }
}

#[cfg(feature = "elasticity")]
impl Anchor {
    /// Adds a symmetric matrix of its place to one of the freedoms, where it is a particle of so many.
    pub(crate) fn add_symmetric(&self, each: usize, of: [[f64; 3]; 3], to: &mut impl Sink) {
        let Anchor::Particle(first) = *self else { return };
        let mut block = [0.0; 9];
        for (entry, k) in block.iter_mut().zip(0..each * each) {
            *entry = of[k / each][k % each];
        }
        let freedoms = [first, first + 1, first + 2];
        to.add_symmetric(&freedoms[..each], &block[..each * each]);
    }
}

/// A force and a torque at a point of a body, as they act on its freedoms, of which it has `each`:
/// (F, c x R^T F + R^T m).
pub(crate) fn wrench(
    q: &[f64],
    body: usize,
    each: usize,
    point: &[f64; 3],
    force: &[f64; 3],
    torque: &[f64; 3],
) -> [f64; 6] {
    if each == 3 {
        let (sin, cos) = q[3 * body + 2].sin_cos();
        let arm = [cos * point[0] - sin * point[1], sin * point[0] + cos * point[1]];
        let moment = arm[0] * force[1] - arm[1] * force[0] + torque[2];
        return [force[0], force[1], moment, 0.0, 0.0, 0.0];
    }
    let turn = array(|k| q[7 * body + 3 + k]);
    let (own, moment) = (turn_back(turn, *force), turn_back(turn, *torque));
    let turning = cross(*point, own);
    array(|c| if c < 3 { force[c] } else { turning[c - 3] + moment[c - 3] })
}
