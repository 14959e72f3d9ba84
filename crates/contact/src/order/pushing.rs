//! What pushes in a step of a world, and how it rubs: two steps of the same motion see the same.
//!
//! ```text
//! |t| >= (1 - 1e-6) mu n        slides, if |u| > 1e-4 mu n/m as well: of two corners that stick one may be at its bound
//! min(n, mu n - |t|)/h          by how much forces may grow before a pair parts, or slips where it sticks
//! u.(u + (w2 - w1)/2) <= 0      turns around after the step has looked
//! ```
//! `t n` impulses along surfaces and across them (N s), `mu` the friction, `m` the mass of all that moves, `u` slip and
//! `w1 w2` the speeds of an obstacle in both halves (m/s).

use stationary_calculus::Potential;
use stationary_constraints::RowLaw;

use crate::{Dimension, World};

/// The part of Coulomb's bound from which friction slides.
const SLIDES: f64 = 1.0 - 1e-6;
/// Slip of less than this part of what friction changes of the velocity of all that moves is the solver's.
const SLIP: f64 = 1e-4;
/// The cosine of the angle by which friction turns at most in smooth sliding.
const STRAIGHT: f64 = 0.9;

/// Two colliders that push each other, and how they rub.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pushing<G: Dimension> {
    pub(super) colliders: [u32; 2],
    pub(super) bodies: [Option<usize>; 2],
    pub(super) slides: bool,
    pub(super) friction: G::Vector,
    pub(super) impulse: G::Vector,
    /// The normal impulse, and by how much friction may grow, N s.
    normal: f64,
    grip: f64,
    /// On an obstacle how fast it slips at the step's end, and what of that the obstacle is, m/s.
    slip: Option<[G::Vector; 2]>,
}

impl<G: Dimension> Pushing<G> {
    pub(super) fn same(&self, other: &Self) -> bool {
        let straight = || {
            let length = |v: &G::Vector| G::dot(v, v).sqrt();
            let [a, b] = [&self.friction, &other.friction];
            G::dot(a, b) >= STRAIGHT * length(a) * length(b)
        };
        self.slides == other.slides && (!self.slides || straight())
    }

    /// Whether slip turns around in the last quarter of a step whose halves these are: an obstacle has its mean speed in
    /// each.
    fn turns_around(&self, later: &Self) -> bool {
        let (Some([_, first]), Some([slip, second])) = (self.slip, later.slip) else {
            return false;
        };
        let rubs = later.slides && G::dot(&later.friction, &later.friction) > 0.0;
        rubs && G::dot(&slip, &(slip + (second - first) * 0.5)) <= 0.0
    }
}

/// What pushes in a step.
#[derive(Clone, Debug)]
pub(super) struct Seen<G: Dimension> {
    /// Sorted as contacts are.
    pub(super) pairs: Vec<Pushing<G>>,
    /// The largest of their gaps where the step starts, m.
    pub(super) gap: f64,
    /// By how much what hits is early at most, m: it turns back before its gap is closed.
    pub(super) early: f64,
    /// By how much forces may grow before a pair or a limit of joints parts, or what sticks slips, N.
    pub(super) margin: f64,
    /// Which limits of joints push, and which way dry friction of joints slides: zero where it sticks.
    limits: Vec<bool>,
    slides: Vec<i8>,
}

impl<G: Dimension> Default for Seen<G> {
    fn default() -> Self {
        let (pairs, limits, slides) = (Vec::new(), Vec::new(), Vec::new());
        Seen { pairs, gap: 0.0, early: 0.0, margin: f64::INFINITY, limits, slides }
    }
}

impl<G: Dimension> Seen<G> {
    /// Looks at the last step of a world, of `h` seconds.
    pub(super) fn look<P: Potential>(&mut self, world: &World<G, P>, h: f64) {
        self.look_at_joints(world, h);
        let Seen { pairs, gap, early, margin, .. } = self;
        pairs.clear();
        *early = 0.0;
        for touch in world.touches().filter(|touch| touch.impact > 0.0) {
            *early = early.max((1.0 + touch.contact.restitution) * touch.contact.gap);
        }
        let all = world.mass_that_moves();
        for touch in world.touches().filter(|touch| touch.normal > 0.0) {
            *gap = gap.max(touch.contact.gap);
            let rubbed = G::dot(&touch.friction, &touch.friction).sqrt();
            let bound = touch.contact.friction * touch.normal;
            let along = touch.contact.normal;
            let across = |u: G::Vector| u - along * G::dot(&u, &along);
            let slides = bound == 0.0
                || (rubbed >= SLIDES * bound && {
                    let slip = across(world.rate_at(&touch.contact)[0]);
                    G::dot(&slip, &slip).sqrt() > SLIP * bound / all
                });
            let colliders = touch.contact.id.colliders;
            let impulse = touch.contact.normal * touch.normal + touch.friction;
            let (normal, grip) = (touch.normal, (bound - rubbed).max(0.0));
            match pairs.last_mut().filter(|last| last.colliders == colliders) {
                Some(last) => {
                    last.slides |= slides;
                    last.friction = last.friction + touch.friction;
                    last.impulse = last.impulse + impulse;
                    last.normal += normal;
                    last.grip += grip;
                }
                None => {
                    let (bodies, friction) = (touch.contact.bodies, touch.friction);
                    let on_obstacle = bodies.iter().flatten().any(|&body| world.is_obstacle(body));
                    let slip = on_obstacle.then(|| world.rate_at(&touch.contact).map(across));
                    pairs.push(Pushing {
                        colliders,
                        bodies,
                        slides,
                        friction,
                        impulse,
                        normal,
                        grip,
                        slip,
                    });
                }
            }
        }
        for pair in pairs {
            let least = if pair.slides { pair.normal } else { pair.normal.min(pair.grip) };
            *margin = margin.min(least / h);
        }
    }

    /// Looks at what of joints pushes one way only, or slides.
    fn look_at_joints<P: Potential>(&mut self, world: &World<G, P>, h: f64) {
        let Seen { gap, margin, limits, slides, .. } = self;
        limits.clear();
        slides.clear();
        (*gap, *margin) = (0.0, f64::INFINITY);
        let (rows, impulses) = world.joint_rows();
        for (law, block) in rows.blocks() {
            let x = impulses.get(block.start).copied().unwrap_or(0.0);
            match law {
                RowLaw::Limit => {
                    limits.push(x > 0.0);
                    if x > 0.0 {
                        *margin = margin.min(x / world.joint_arm(block.start) / h);
                        // A limit asks for the velocity that closes what is left of it.
                        *gap = gap.max(-h * rows.asked(block.start));
                    }
                }
                RowLaw::Bounded(bound) => {
                    let slips = x.abs() >= SLIDES * bound;
                    slides.push(if slips { x.signum() as i8 } else { 0 });
                    if !slips {
                        *margin = margin.min((bound - x.abs()) / world.joint_arm(block.start) / h);
                    }
                }
                RowLaw::Equality | RowLaw::Cone(_) => {}
            }
        }
    }

    /// Whether what pushes closes a gap of more than `least` (m).
    pub(super) fn closes(&self, least: f64) -> bool {
        self.gap > least
    }

    /// Whether the same surfaces and limits push.
    pub(super) fn pushes_as(&self, other: &Self) -> bool {
        let colliders = |pair: &Pushing<G>| pair.colliders;
        let same = self.pairs.iter().map(colliders).eq(other.pairs.iter().map(colliders));
        same && self.limits.iter().eq(&other.limits)
    }

    /// Whether slip turns around in the last quarter of a step whose halves these are.
    pub(super) fn turns_around(&self, later: &Self) -> bool {
        self.pairs.iter().zip(&later.pairs).any(|(first, second)| first.turns_around(second))
    }

    /// Whether these stick or slide the same way.
    pub(super) fn rubs_as(&self, other: &Self) -> bool {
        self.slides == other.slides && self.pairs.iter().zip(&other.pairs).all(|(a, b)| a.same(b))
    }
}
