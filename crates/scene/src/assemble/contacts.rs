//! What touches what: walls, fixed balls, particles and bodies with a size, and the law of impact.
//!
//! ```text
//! wall        normal . (x - at) >= r              ball        |x - at| >= r + radius
//! particles   |x_i - x_j| >= r_i + r_j            r the `radius` of a particle, none of a point
//! ```
//! `restitution` is separating over approaching speed; `friction` acts between bodies alone. A
//! `law` says what happens where several contacts meet, and for particles `when` says at which
//! moment. Or particles overlap a little, and springs of a `stiffness` k push them apart, with the
//! energy `k/2 min(gap, 0)^2`.

use stationary_contact::{Balls, ContactError, FixedBall, Inequality, OneSidedPenalty, Wall};

use crate::assemble::vertices::{Vertices, leading};
use crate::model::built::Built;
use crate::model::items::SceneWall;
use crate::model::particle::{Motion, Particle};
use crate::model::scene::Scene;
use crate::text::fault::Fault;
use crate::text::limits;

/// The springs that push apart particles which overlap.
pub(crate) type Penalty<const D: usize> = OneSidedPenalty<Balls<D>>;

impl Scene {
    /// The springs between particles that overlap, where they touch by springs.
    pub(crate) fn penalty<const D: usize>(
        &self,
        built: &mut Built,
    ) -> Result<Option<Penalty<D>>, ContactError> {
        let Some(stiffness) = self.contact.as_ref().and_then(|contact| contact.stiffness) else {
            return Ok(None);
        };
        let Some(gaps) = self.gaps::<D>()? else { return Ok(None) };
        built.gaps += gaps.gaps(0.0, &self.coordinates::<D>(&Vertices::new(self))).len() as u64;
        Ok(Some(OneSidedPenalty::new(gaps, stiffness)?))
    }

    /// The coordinates of the free particles at the start.
    fn coordinates<const D: usize>(&self, vertices: &Vertices) -> Vec<f64> {
        let place = |&particle: &usize| leading::<D>(self.particles[particle].position);
        vertices.particles[..vertices.free].iter().flat_map(place).collect()
    }

    /// The gaps between the particles of a scene with contact, and to what is fixed.
    pub(crate) fn gaps<const D: usize>(
        &self,
    ) -> Result<Option<Inequality<Balls<D>>>, ContactError> {
        let Some(contact) = &self.contact else {
            return Ok(None);
        };
        let vertices = Vertices::new(self);
        let free = &vertices.particles[..vertices.free];
        let radii = free.iter().map(|&particle| self.particles[particle].radius).collect();
        let flat = |wall: &SceneWall| Wall { normal: leading(wall.normal), offset: wall.offset };
        let walls = contact.walls.iter().map(flat).collect();
        let ball = |centre: [f64; 3], radius| FixedBall { centre: leading(centre), radius };
        let pinned = self.round_pins().map(|pin| &self.particles[pin]);
        let fixed = contact.balls.iter().map(|fixed| ball(fixed.centre, fixed.radius));
        let fixed = fixed.chain(pinned.map(|p| ball(p.position, p.radius))).collect();
        Ok(Some(Inequality(Balls::<D>::new(radii, walls)?.with_fixed(fixed)?)))
    }

    /// The pinned particles that have a size.
    pub(crate) fn round_pins(&self) -> impl Iterator<Item = usize> {
        let round = |&pin: &usize| self.particles[pin].radius > 0.0;
        self.pins().filter(round)
    }

    /// An error where more may touch than can be looked at, or a particle starts inside of
    /// something.
    pub(crate) fn check_apart(&self) -> Result<(), Fault> {
        let pairs = self.pairs();
        if pairs > limits::PAIRS {
            let what = "pairs that may touch";
            return Err(Fault::TooMany { what, count: pairs, limit: limits::PAIRS });
        }
        match self.dimension {
            1 => self.check_apart_in::<1>(),
            2 => self.check_apart_in::<2>(),
            _ => self.check_apart_in::<3>(),
        }
    }

    /// How many pairs of particles, and of particles and what is fixed, may touch.
    fn pairs(&self) -> u64 {
        let Some(contact) = &self.contact else { return 0 };
        let count = |of: fn(&&Particle) -> bool| self.particles.iter().filter(of).count() as u64;
        let free = count(|p| p.motion != Motion::Pinned);
        let round = count(|p| p.motion != Motion::Pinned && p.radius > 0.0);
        let pins = count(|p| p.motion == Motion::Pinned && p.radius > 0.0);
        let fixed = (contact.walls.len() + contact.balls.len()) as u64 + pins;
        free.saturating_mul(fixed.saturating_add(round))
    }

    fn check_apart_in<const D: usize>(&self) -> Result<(), Fault> {
        /// Overlap that is rounding, relative to where things are.
        const ROUNDING: f64 = 1e-12;
        let gaps = self.gaps::<D>().map_err(|error| Fault::Shape(error.to_string()))?;
        let Some(gaps) = gaps else { return Ok(()) };
        let vertices = Vertices::new(self);
        let q = self.coordinates::<D>(&vertices);
        let size = q.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
        let all = gaps.gaps(0.0, &q);
        let Some(first) = all.iter().position(|&gap| gap < -ROUNDING * size) else {
            return Ok(());
        };
        let row = gaps.rows(0.0, &q, &[first]);
        let freedom = row.row(0).next().map_or(0, |(freedom, _)| freedom);
        let name = self.particles[vertices.particles[freedom / D]].name.clone();
        Err(Fault::Overlap { name, depth: -all[first] })
    }
}
