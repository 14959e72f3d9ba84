//! Questions about where colliders are: rays, closest points, what a shape overlaps, and what sensors feel.
//!
//! ```text
//! o + t d,   0 <= t <= l                    a ray: the least t at which it is in a collider (`ray.rs`)
//! ```
//! Each question looks at each collider: for many rays and bodies a hierarchy of the caller's own is cheaper.

use stationary_calculus::array;
use stationary_rigid::LieGroup;

use crate::error::{check_finite, check_length};
use crate::shapes::dimension::Answer;
use crate::{ColliderIn, ContactError, ContactIn, DetectorIn, Dimension};

/// Where a ray first meets a collider.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHitIn<G: Dimension> {
    /// The collider.
    pub collider: usize,
    /// How far from the ray's start, m; zero where it starts inside.
    pub distance: f64,
    /// The place, world axes.
    pub point: G::Vector,
    /// Out of the collider, of length 1, world axes; against the ray where that starts inside.
    pub normal: G::Vector,
}

/// Where a ray in space first meets a collider.
#[cfg(feature = "3d")]
pub type RayHit = RayHitIn<crate::Spatial>;
/// Where a ray in the plane first meets a collider.
#[cfg(feature = "2d")]
pub type PlanarRayHit = RayHitIn<crate::Planar>;

impl<G: Dimension> DetectorIn<G> {
    /// The first collider, sensors among them, that a ray meets within a length (m): of those at the same
    /// distance that of the smallest number. The length of `direction` does not matter.
    ///
    /// # Errors
    /// [`ContactError::NonFinite`] for a start that is not finite; [`ContactError::Length`] for a direction whose
    /// length is zero or not finite; [`ContactError::Margin`] for a length of the ray that is negative or not
    /// finite; those of [`DetectorIn::broad_phase`] for `q`.
    pub fn cast_ray(
        &mut self,
        q: &[f64],
        start: G::Vector,
        direction: G::Vector,
        longest: f64,
    ) -> Result<Option<RayHitIn<G>>, ContactError> {
        let numbers =
            |v: &G::Vector| -> [f64; 3] { array(|k| if k < G::TRANSLATION { v[k] } else { 0.0 }) };
        check_finite("the start of a ray", &numbers(&start))?;
        // Squares of what is tiny or huge are no numbers.
        let largest = numbers(&direction).iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        check_length("ray", "direction", largest)?;
        let direction = direction * largest.recip();
        let length = G::dot(&direction, &direction).sqrt();
        check_length("ray", "direction", length)?;
        if !(longest >= 0.0 && longest.is_finite()) {
            return Err(ContactError::Margin(longest));
        }
        self.place(q)?;
        let direction = direction * length.recip();
        let mut first: Option<RayHitIn<G>> = None;
        for (collider, (of, placed)) in self.colliders().iter().zip(&self.placed).enumerate() {
            let seen = placed.inverse();
            let most = first.as_ref().map_or(longest, |hit| hit.distance);
            let (from, along) = (G::apply(&seen, &start), G::turn(&seen, &direction));
            if let Some((distance, normal)) = G::cast(&of.shape, &from, &along, most)
                && first.as_ref().is_none_or(|first| distance < first.distance)
            {
                let point = start + direction * distance;
                first =
                    Some(RayHitIn { collider, distance, point, normal: G::turn(placed, &normal) });
            }
        }
        Ok(first)
    }

    /// The closest points of two colliders; where they overlap the deepest ones, with a gap below zero.
    ///
    /// # Errors
    /// [`ContactError::Size`] for a collider that is not there; [`ContactError::NoQuery`] for two half-spaces and
    /// for two meshes; those of [`DetectorIn::broad_phase`] for `q`.
    pub fn closest_points(
        &mut self,
        q: &[f64],
        colliders: [usize; 2],
    ) -> Result<ContactIn<G>, ContactError> {
        let pair = self.pair(colliders)?;
        self.place(q)?;
        let placed = pair.map(|i| self.placed[i]);
        let shapes = pair.map(|i| &self.colliders[i].shape);
        let poses = pair.map(|i| self.poses[i]);
        let way = G::translation(&placed[1]) - G::translation(&placed[0]);
        let margin = G::dot(&way, &way).sqrt() + shapes.map(size::<G>).iter().sum::<f64>();
        self.facing.clear();
        G::face(shapes, [&poses[0], &poses[1]], margin, &mut self.room, &mut self.facing);
        let nearest = self.facing.iter().min_by(|a, b| a.gap.total_cmp(&b.gap));
        let [first, second] = shapes.map(G::name);
        let nearest = nearest.ok_or(ContactError::NoQuery { first, second })?;
        Ok(self.met(pair, &placed).point(nearest))
    }

    /// The colliders, sensors among them, that a shape at a place overlaps or touches, in their order.
    ///
    /// # Errors
    /// [`ContactError::NonFinite`] for a place that is not finite; [`ContactError::NoQuery`] for a shape that comes
    /// near a collider and has no query with it; those of [`DetectorIn::broad_phase`] for `q`.
    pub fn overlapping(
        &mut self,
        q: &[f64],
        shape: &G::Shape,
        place: &G::Motion,
    ) -> Result<Vec<usize>, ContactError> {
        G::check_place(place)?;
        self.place(q)?;
        self.overlapping_with(shape, place, |_| true)
    }

    /// Those of the colliders that are asked for which a shape at a place overlaps; they have their places.
    fn overlapping_with(
        &mut self,
        shape: &G::Shape,
        place: &G::Motion,
        asked: impl Fn(&ColliderIn<G>) -> bool,
    ) -> Result<Vec<usize>, ContactError> {
        let (pose, mut found) = (G::convert(place), Vec::new());
        for (collider, of) in self.colliders.iter().enumerate() {
            let shapes = [&of.shape, shape];
            let way = G::translation(place) - G::translation(&self.placed[collider]);
            let far = G::dot(&way, &way).sqrt() > shapes.map(size::<G>).iter().sum::<f64>();
            let bounded = shapes.iter().all(|shape| G::plane(shape).is_none());
            if !asked(of) || (far && bounded) {
                continue;
            }
            self.facing.clear();
            let poses = [&self.poses[collider], &pose];
            let answer = G::face(shapes, poses, 0.0, &mut self.room, &mut self.facing);
            if answer == Answer::None {
                let [first, second] = shapes.map(G::name);
                return Err(ContactError::NoQuery { first, second });
            }
            if !self.facing.is_empty() {
                found.push(collider);
            }
        }
        Ok(found)
    }

    /// The sensors that overlap or touch a collider of another carrier, each pair in the order of its numbers;
    /// sensors feel what is in their groups, sensors too.
    ///
    /// # Errors
    /// As [`DetectorIn::overlapping`].
    pub fn sensed(&mut self, q: &[f64]) -> Result<Vec<[usize; 2]>, ContactError> {
        self.place(q)?;
        let mut pairs = Vec::new();
        for sensor in 0..self.colliders.len() {
            if !self.colliders[sensor].sensor {
                continue;
            }
            let (own, place) = (self.colliders[sensor].clone(), self.placed[sensor]);
            let felt = |other: &ColliderIn<G>| own.carrier != other.carrier && own.meets(other);
            let found = self.overlapping_with(&own.shape, &place, felt)?;
            pairs.extend(found.into_iter().map(|other| [sensor.min(other), sensor.max(other)]));
        }
        pairs.retain(|pair| !self.passing.contains(pair));
        pairs.sort_unstable();
        pairs.dedup();
        Ok(pairs)
    }
}

/// The radius of a ball about a shape's own origin that holds it, m; zero of a half-space.
fn size<G: Dimension>(shape: &G::Shape) -> f64 {
    if G::plane(shape).is_some() { 0.0 } else { G::reach(shape, &G::Motion::identity()) }
}
