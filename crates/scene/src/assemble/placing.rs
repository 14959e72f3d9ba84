//! Bodies that are placed by what they touch: the first of two is moved straight until the gap is closed.
//!
//! ```text
//! x <- x + gap n       n from the first to the second, where they are nearest
//! ```
//! One after the other, in the order of the file, so that a stack is placed from below. Of convex shapes the
//! first move closes the gap but for rounding, and the next ones that.

use std::ops::Range;

use nalgebra::Vector3;
use stationary_contact::{ColliderIn, ContactError, DetectorIn, Dimension};

use crate::assemble::colliders::Colliders;
use crate::assemble::error::AssemblyError;
use crate::model::contact_side::ContactSide;
use crate::model::particle::Motion;
use crate::model::scene::Scene;
use crate::text::fault::Fault;

/// Moves of one body, at most.
const MOVES: usize = 8;
/// A gap that is rounding, relative to places and sizes.
const CLOSED: f64 = 4.0 * f64::EPSILON;
/// The same where it closes no more.
const ENOUGH: f64 = 1e-12;

impl Scene {
    /// Places what touches; where that fails, the number of the pair.
    pub(crate) fn place_touching(&mut self) -> Result<(), (usize, Fault)> {
        let pairs = self.contact.as_ref().map_or(Vec::new(), |contact| contact.touching.clone());
        for (number, pair) in pairs.into_iter().enumerate() {
            self.place(pair).map_err(|fault| (number, fault))?;
        }
        Ok(())
    }

    fn place(&mut self, pair: [ContactSide; 2]) -> Result<(), Fault> {
        let ContactSide::Body(body) = pair[0] else { return Err(Fault::PlacedFixed) };
        let mut best = f64::INFINITY;
        for _ in 0..MOVES {
            let nearest =
                if self.dimension == 3 { self.in_space_apart(pair) } else { self.apart(pair) };
            let (gap, normal, size) = nearest
                .map_err(|error| Fault::Shape(error.to_string()))?
                .ok_or(Fault::NotPlaced { gap: f64::NAN })?;
            if gap.abs() <= CLOSED * size || (gap.abs() >= best && best <= ENOUGH * size) {
                return Ok(());
            }
            best = best.min(gap.abs());
            self.shift(body, normal * gap);
        }
        Err(Fault::NotPlaced { gap: best })
    }

    /// Moves a body with its points.
    fn shift(&mut self, index: usize, way: Vector3<f64>) {
        let body = &mut self.bodies[index];
        (0..3).for_each(|c| body.position[c] += way[c]);
        let body = &self.bodies[index];
        for particle in &mut self.particles {
            match particle.motion {
                Motion::Carried { body: own, point } if own == index => {
                    particle.position = body.place(point);
                }
                _ => {}
            }
        }
    }

    fn in_space_apart(&self, pair: [ContactSide; 2]) -> Result<Option<Apart>, AssemblyError> {
        let Some(contact) = &self.contact else { return Ok(None) };
        let all = self.colliders(contact)?;
        let pair = pair.map(|side| Colliders::of(&all, contact).of_side(side, &all));
        let q = self.in_space()?.initial.q;
        Ok(apart(&all, pair, self.bodies.len(), &q, |n| *n)?)
    }

    fn apart(&self, pair: [ContactSide; 2]) -> Result<Option<Apart>, AssemblyError> {
        let Some(contact) = &self.contact else { return Ok(None) };
        let all = self.planar_colliders(contact)?;
        let pair = pair.map(|side| Colliders::of(&all, contact).of_side(side, &all));
        let q = self.in_the_plane()?.initial.q;
        Ok(apart(&all, pair, self.bodies.len(), &q, |n| Vector3::new(n.x, n.y, 0.0))?)
    }
}

/// The least gap of two, the normal there from the first to the second, and the size of what is compared.
type Apart = (f64, Vector3<f64>, f64);

fn apart<G: Dimension>(
    all: &[ColliderIn<G>],
    pair: [Range<usize>; 2],
    bodies: usize,
    q: &[f64],
    in_space: impl Fn(&G::Vector) -> Vector3<f64>,
) -> Result<Option<Apart>, ContactError> {
    // What has nothing that touches is nowhere near.
    let two: Vec<ColliderIn<G>> = pair.into_iter().flat_map(|own| all[own].to_vec()).collect();
    let radii = two.iter().filter_map(ColliderIn::body);
    let radii: Vec<usize> = radii.collect();
    let mut detector = DetectorIn::new(two, bodies)?;
    let mut size = q.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    for body in radii {
        size = size.max(detector.radius(body)?);
    }
    // As far as they can be from each other.
    let mut reach = 4.0 * size;
    for _ in 0..4 {
        let contacts = detector.detect(q, reach)?;
        let nearest = contacts.iter().min_by(|a, b| a.gap.total_cmp(&b.gap));
        if let Some(nearest) = nearest {
            // Colliders come in their order; the first is moved along the normal, the second against it.
            return Ok(Some((nearest.gap, in_space(&nearest.normal), size)));
        }
        reach *= 16.0;
    }
    Ok(None)
}
