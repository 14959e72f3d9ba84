//! Contact points that are kept while two bodies hardly move against each other.
//!
//! ```text
//! g = g0 + n.(x2 - x1) - n0.(x20 - x10)     corners against a plane that has the normal n
//! kept while |t - t0| <= e r and |R - R0| <= e              e = 1e-6, in a pile 1e-4
//! ```
//! `x1 x2` the points that face each other, fixed in their bodies; `n` fixed in the body whose face
//! it is the normal of; `t` and `R` the pose of the second body as seen from the first, with zeros
//! where the points were found; `r` the smaller radius (m). A pile whose conditions are met to a part of a step's
//! weight asks for no more of its normals. A corner's distance from a plane is
//! exact however far they have moved: what the bound limits is how far points may have slid past
//! edges, and by how much another face may have become the nearest. Pairs that face each other
//! otherwise, and those that moved on, are asked for afresh.
//!
//! What is kept has been found from the relative pose alone, so that it is found again to the same
//! bits from the poses that are saved; and only pairs within the margin are kept, whatever else the
//! broad phase let through.

use stationary_integrators::StepError;
use stationary_rigid::LieGroup;

use crate::shapes::dimension::Answer;
use crate::solve::body_state::BodyState;
use crate::{ContactError, ContactIn, DetectorIn, Dimension};

/// How far bodies may move against each other, as a part of the smaller radius, and turn, radians.
pub(crate) const MOVED: f64 = 1e-6;
/// The same in a pile that is asked for nothing: at a metre a second normals that lean by this leave a tenth of a
/// millimetre a second, where a step of a millisecond leaves two and a half millimetres.
pub(crate) const MOVED_IN_PILE: f64 = 1e-4;
/// Pairs are asked for up to this many times the margin, so that a margin may grow a little.
const WIDER: f64 = 1.5;
/// Boxes are compared up to this many times the margin, so that rounding loses no pair.
const BROADER: f64 = 1.1;
/// Numbers that save a pair beside its relative pose.
const SAVED: usize = 3;

/// Contact points of a step, and those of the step before that may serve again.
#[derive(Debug)]
pub(crate) struct ContactCache<G: Dimension> {
    pairs: Vec<KeptPair<G>>,
    last: Vec<KeptPair<G>>,
    spare: Vec<Vec<KeptPoint<G>>>,
    found: Vec<ContactIn<G>>,
    /// How far bodies may move now.
    pub(crate) moved: f64,
}

impl<G: Dimension> Default for ContactCache<G> {
    fn default() -> Self {
        let (pairs, last, spare) = (Vec::new(), Vec::new(), Vec::new());
        ContactCache { pairs, last, spare, found: Vec::new(), moved: MOVED }
    }
}

/// A pair of colliders whose corners and planes face each other.
#[derive(Debug)]
struct KeptPair<G: Dimension> {
    colliders: [usize; 2],
    /// The second body's pose as seen from the first where its points were found.
    relative: G::Motion,
    /// Up to which gap they were found, m.
    margin: f64,
    /// The smaller radius of its bodies, m.
    radius: f64,
    /// In whose axes the normals are.
    side: usize,
    points: Vec<KeptPoint<G>>,
}

/// A contact point as it was found, and its gap less what the bodies' poses say of it.
#[derive(Clone, Copy, Debug)]
struct KeptPoint<G: Dimension> {
    contact: ContactIn<G>,
    offset: f64,
}

/// The two bodies of a pair, now.
struct Two<'a, G: Dimension> {
    states: [Option<&'a BodyState<G>>; 2],
    relative: G::Motion,
    /// From the centre of the first to that of the second, world axes.
    apart: G::Vector,
}

impl<'a, G: Dimension> Two<'a, G> {
    #[inline]
    fn of(bodies: [Option<usize>; 2], states: &'a [BodyState<G>], q: &[f64]) -> Self {
        let pose =
            |body: Option<usize>| body.map_or_else(G::Motion::identity, |body| G::pose(q, body));
        let (first, second) = (pose(bodies[0]), pose(bodies[1]));
        let apart = G::translation(&second) - G::translation(&first);
        let relative = G::relative(&first, &second);
        Two { states: bodies.map(|body| body.map(|body| &states[body])), relative, apart }
    }

    /// A direction of one of the bodies as seen from the world.
    #[inline]
    fn turn(&self, side: usize, direction: &G::Vector) -> G::Vector {
        self.states[side].map_or(*direction, |state| G::rotate(&state.frame, direction))
    }

    #[inline]
    fn centre(&self, side: usize) -> G::Vector {
        self.states[side].map_or_else(G::Vector::default, |state| state.centre)
    }
}

impl<G: Dimension> KeptPair<G> {
    /// Whether its points serve at the poses of now, up to a margin, where bodies may move so far.
    #[inline]
    fn serves(&self, now: &G::Motion, margin: f64, most: f64) -> bool {
        let [moved, turned] = G::apart(now, &self.relative);
        let bound = most * self.radius;
        turned <= most && moved <= bound && margin + 4.0 * bound <= self.margin
    }

    /// Appends its contacts within a margin as they are now; says whether there are any.
    fn append(&self, two: &Two<G>, margin: f64, found: &mut Vec<ContactIn<G>>) -> bool {
        let centres = [two.centre(0), two.centre(1)];
        let first = found.len();
        for KeptPoint { contact, offset } in &self.points {
            let arms = [two.turn(0, &contact.arms[0]), two.turn(1, &contact.arms[1])];
            let normal = two.turn(self.side, &contact.normal);
            let gap = offset + G::dot(&normal, &(two.apart + arms[1] - arms[0]));
            if gap <= margin {
                let points = [centres[0] + arms[0], centres[1] + arms[1]];
                found.push(ContactIn { gap, normal, points, ..*contact });
            }
        }
        found.len() > first
    }

    fn save(&self) -> impl Iterator<Item = f64> {
        let [a, b] = self.colliders;
        [a as f64, b as f64, self.margin].into_iter().chain(G::numbers(&self.relative))
    }
}

impl<G: Dimension> ContactCache<G> {
    /// The contact points whose gap is at most what both bodies may move, as
    /// [`DetectorIn::detect`] finds them but for what is kept.
    pub(crate) fn detect(
        &mut self,
        detector: &mut DetectorIn<G>,
        states: &[BodyState<G>],
        q: &[f64],
        reach: &[f64],
    ) -> Result<(), ContactError> {
        self.detect_of(detector, states, q, reach, |_| true)
    }

    /// The same for the pairs with a body that is asked for; what is kept of the others stays.
    pub(crate) fn detect_of(
        &mut self,
        detector: &mut DetectorIn<G>,
        states: &[BodyState<G>],
        q: &[f64],
        reach: &[f64],
        asked: impl Fn(usize) -> bool,
    ) -> Result<(), ContactError> {
        let of = |body: Option<usize>| body.map_or(0.0, |body| reach[body]);
        detector.find_candidates(q, |body| BROADER * of(body))?;
        std::mem::swap(&mut self.pairs, &mut self.last);
        self.pairs.clear();
        self.found.clear();
        let (mut last, spare) = (self.last.drain(..).peekable(), &mut self.spare);
        for k in 0..detector.candidates().len() {
            let (a, b) = detector.candidates()[k];
            while let Some(gone) = last.next_if(|kept| kept.colliders < [a, b]) {
                spare.push(gone.points);
            }
            let bodies = [a, b].map(|i| detector.colliders()[i].body());
            if !bodies.iter().flatten().any(|&body| asked(body)) {
                self.pairs.extend(last.next_if(|kept| kept.colliders == [a, b]));
                continue;
            }
            let two = Two::of(bodies, states, q);
            let margin = of(bodies[0]) + of(bodies[1]);
            if let Some(kept) = last.next_if(|kept| kept.colliders == [a, b]) {
                if kept.serves(&two.relative, margin, self.moved) {
                    match kept.append(&two, margin, &mut self.found) {
                        true => self.pairs.push(kept),
                        false => spare.push(kept.points),
                    }
                    continue;
                }
                spare.push(kept.points);
            }
            let points = spare.pop().unwrap_or_default();
            let wide = WIDER * margin + 4.0 * self.moved * radius(detector, [a, b]);
            let (found, lasts) = find_within(detector, [a, b], two.relative, wide, points)?;
            if found.append(&two, margin, &mut self.found) && lasts {
                self.pairs.push(found);
            } else {
                spare.push(found.points);
            }
        }
        spare.extend(last.map(|gone| gone.points));
        Ok(())
    }

    /// What [`ContactCache::detect`] found last.
    pub(crate) fn found(&self) -> &[ContactIn<G>] {
        &self.found
    }

    /// What [`ContactCache::detect`] found last, to be given back by [`ContactCache::put_back`].
    pub(crate) fn take_found(&mut self) -> Vec<ContactIn<G>> {
        std::mem::take(&mut self.found)
    }

    /// Reuses the memory of contacts that are no longer needed.
    pub(crate) fn put_back(&mut self, found: Vec<ContactIn<G>>) {
        self.found = found;
    }

    /// From which relative poses the points that are kept were found.
    pub(crate) fn save(&self) -> impl Iterator<Item = f64> {
        self.pairs.iter().flat_map(KeptPair::save)
    }

    /// What was saved, found again.
    pub(crate) fn load(numbers: &[f64], detector: &mut DetectorIn<G>) -> Result<Self, StepError> {
        const REFUSED: StepError = StepError::Saved("it has poses at which no contacts are kept");
        let saved = numbers.chunks_exact(SAVED + G::STORED);
        if !saved.remainder().is_empty() {
            return Err(REFUSED);
        }
        let mut kept = ContactCache::default();
        for numbers in saved {
            let pair = read(numbers, detector).ok_or(REFUSED)?;
            if kept.pairs.last().is_some_and(|last| last.colliders >= pair.colliders) {
                return Err(REFUSED);
            }
            kept.pairs.push(pair);
        }
        Ok(kept)
    }
}

fn read<G: Dimension>(numbers: &[f64], detector: &mut DetectorIn<G>) -> Option<KeptPair<G>> {
    let &[a, b, wide, ref pose @ ..] = numbers else { return None };
    let colliders = [a, b].map(|x| x as usize);
    let [first, second] = colliders;
    let named = [first as f64, second as f64] == [a, b] && first < second;
    let there = named && second < detector.colliders().len();
    let finite = wide > 0.0 && wide.is_finite();
    if !(there && finite && G::check(pose).is_ok()) {
        return None;
    }
    let relative = G::pose(pose, 0);
    let (pair, lasts) = find_within(detector, colliders, relative, wide, Vec::new()).ok()?;
    (lasts && !pair.points.is_empty()).then_some(pair)
}

/// The smaller radius of the bodies of two colliders, m.
fn radius<G: Dimension>(detector: &DetectorIn<G>, colliders: [usize; 2]) -> f64 {
    let bodies = colliders.iter().filter_map(|&i| detector.colliders()[i].body());
    bodies.map(|body| detector.radius_of(body)).fold(f64::INFINITY, f64::min)
}

/// The points of a pair within a margin, and whether they may be kept.
fn find_within<G: Dimension>(
    detector: &mut DetectorIn<G>,
    colliders: [usize; 2],
    relative: G::Motion,
    margin: f64,
    mut points: Vec<KeptPoint<G>>,
) -> Result<(KeptPair<G>, bool), ContactError> {
    let radius = radius(detector, colliders);
    let (answer, found) = detector.meet_alone(colliders, &relative, margin)?;
    let (side, lasts) = match answer {
        Answer::Plane(side) => (side, true),
        Answer::Now | Answer::None => (0, false),
    };
    let seen = G::frame(&relative);
    points.clear();
    points.extend(found.iter().map(|point| {
        let [from, to] = point.points;
        let normal = if side == 0 { point.normal } else { G::rotate_back(&seen, &point.normal) };
        let offset = point.gap - G::dot(&point.normal, &(to - from));
        KeptPoint { contact: ContactIn { normal, ..*point }, offset }
    }));
    Ok((KeptPair { colliders, relative, margin, radius, side, points }, lasts))
}

#[cfg(all(test, feature = "3d"))]
mod tests {
    use stationary_calculus::{Space, Vector};
    use stationary_measure::SplitMix64;

    use super::*;
    use stationary_rigid::Poses;

    use crate::problems::columns_of_boxes;
    use crate::{ContactPoint, Detector, Spatial};

    /// Two boxes on each other and on the floor, shifted a little, and what finds their contacts.
    fn stacked() -> (Vec<f64>, Detector) {
        let boxes = columns_of_boxes(1, 2).unwrap();
        let mut q = boxes.state.q.clone();
        Poses.advance(&mut q, 1.0, Vector(&[0.0; 12]));
        (q[7], q[8]) = (0.2, -0.13);
        (q, boxes.detector().unwrap())
    }

    fn moved(q: &[f64], by: f64, random: &mut SplitMix64) -> Vec<f64> {
        let mut next = q.to_vec();
        let v: Vec<f64> = (0..12).map(|_| by * random.symmetric()).collect();
        Poses.advance(&mut next, 1.0, Vector(&v));
        next
    }

    fn see(
        kept: &mut ContactCache<Spatial>,
        detector: &mut Detector,
        q: &[f64],
    ) -> Vec<ContactPoint> {
        let placed: Vec<_> =
            (0..2).map(|body| BodyState::new(body, [1.0; 6], q, &[0.0; 12])).collect();
        kept.detect(detector, &placed, q, &[5e-5; 2]).unwrap();
        let found = kept.take_found();
        kept.put_back(found.clone());
        found
    }

    /// The largest difference of the gaps of two lists of the same contacts.
    fn apart(a: &[ContactPoint], b: &[ContactPoint]) -> f64 {
        let ids = |contacts: &[ContactPoint]| contacts.iter().map(|c| c.id).collect::<Vec<_>>();
        assert_eq!(ids(a), ids(b));
        a.iter().zip(b).map(|(a, b)| (a.gap - b.gap).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn gaps_of_what_is_kept_are_those_found_afresh_to_a_few_1e_minus_12_of_a_box() {
        let (q, mut detector) = stacked();
        let mut random = SplitMix64::new(11);
        let (mut served, mut worst) = (0, 0.0_f64);
        for _ in 0..500 {
            let mut kept = ContactCache::<Spatial>::default();
            see(&mut kept, &mut detector, &q);
            let before: Vec<f64> = kept.save().collect();
            let near = moved(&q, 4e-7, &mut random);
            let found = see(&mut kept, &mut detector, &near);
            served += usize::from(kept.save().collect::<Vec<_>>() == before);
            assert_eq!(found.len(), 8);
            worst = worst.max(apart(&found, detector.detect(&near, 1e-4).unwrap()));
        }
        println!("kept {served} of 500 times, gaps off by {worst:e}");
        assert!(served > 150 && worst < 4e-12, "{served} {worst}");
    }

    #[test]
    fn what_has_moved_is_found_afresh_and_what_has_left_is_forgotten() {
        let (q, mut detector) = stacked();
        let mut random = SplitMix64::new(12);
        let mut kept = ContactCache::<Spatial>::default();
        for _ in 0..100 {
            let far = moved(&q, 2e-5, &mut random);
            let before: Vec<f64> = kept.save().collect();
            let found = see(&mut kept, &mut detector, &far);
            assert!(kept.save().collect::<Vec<_>>() != before);
            assert!(apart(&found, detector.detect(&far, 1e-4).unwrap()) < 1e-15);
        }
        assert_eq!(kept.save().count(), 2 * (SAVED + 7));
        let mut up = q.clone();
        up[9] += 1e-3;
        assert_eq!(see(&mut kept, &mut detector, &up).len(), 4);
        assert_eq!(kept.save().count(), SAVED + 7);
    }

    #[test]
    fn what_was_saved_is_found_again_to_the_same_bits_and_numbers_that_were_not_are_refused() {
        let (q, mut detector) = stacked();
        let mut random = SplitMix64::new(13);
        let mut kept = ContactCache::<Spatial>::default();
        see(&mut kept, &mut detector, &moved(&q, 1e-5, &mut random));
        let q = moved(&q, 1e-7, &mut random);
        see(&mut kept, &mut detector, &q);
        let saved: Vec<f64> = kept.save().collect();
        let mut again = ContactCache::<Spatial>::load(&saved, &mut detector).unwrap();
        let near = moved(&q, 1e-8, &mut random);
        let both = [&mut kept, &mut again].map(|kept| see(kept, &mut detector, &near));
        assert_eq!(both[0], both[1]);
        assert_eq!(again.save().collect::<Vec<_>>(), saved);
        let changed = |place: usize, to: f64| {
            let mut other = saved.clone();
            other[place] = to;
            other
        };
        let up = saved[5] + 1.0;
        for bad in [
            saved[1..].to_vec(),
            [&saved[10..], &saved[..10]].concat(),
            changed(0, 1.0),
            changed(1, 7.0),
            changed(1, 0.5),
            changed(2, f64::NAN),
            changed(5, up),
            changed(6, 2.0),
        ] {
            let refused = ContactCache::<Spatial>::load(&bad, &mut detector).unwrap_err();
            assert!(matches!(refused, StepError::Saved(_)), "{bad:?}");
        }
    }
}
