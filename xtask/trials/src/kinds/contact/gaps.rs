//! Gaps of solids with flat faces, and of polygons, against exact arithmetic.
//!
//! ```text
//! gap = max s(n)/|n| over all ways      the best by 32 digits, and what is as good but for rounding, in fractions
//! ```

use nalgebra::Vector2;
use stationary_contact::{
    Collider, ColliderIn, ContactError, DetectorIn, Dimension, PlanarCollider, PlanarShape,
};

use super::exact::{ExactHulls, Place};
use super::hulls::{Hull, Way, farthest};
use super::points::{Pair, SolidKind, configuration, form, placed, shape};
use super::solids::Form;
use crate::kinds::rigid::double_double::Twofold;
use crate::{Draw, Kind, Verdict};

pub(super) const SPATIAL: Kind = Kind {
    name: "polytope-gaps",
    krate: "contact",
    rule: "boxes and hulls, in exact fractions; with P = 1e-12 of the larger of the pair's size and coordinate: \
           the least gap off the exact one (the distance, or less than zero the least way out) by more than P; \
           an overlap told of solids that are exactly apart by more than P, none told of an overlap deeper than \
           P; no contact where the exact gap is below the margin by P, one beyond the margin",
    in_tests: 300,
    trial: spatial,
};

pub(super) const PLANAR: Kind = Kind {
    name: "polygon-gaps",
    krate: "contact",
    rule: "the same of convex polygons of the plane",
    in_tests: 1000,
    trial: planar,
};

/// What is as good as the best by 32 digits to this part of the size is looked at in fractions.
const AS_GOOD: f64 = 1e-13;

fn spatial(draw: &mut Draw) -> Verdict {
    let size = draw.log_uniform(1e-6, 1e6);
    let ratio = if draw.chance(0.3) { draw.log_uniform(1e-2, 1.0) } else { 1.0 };
    let forms =
        [size, size * ratio].map(|size| form(draw, size, &[SolidKind::Box, SolidKind::Hull]));
    let Pair { forms, poses, margin, .. } = placed(draw, forms, size);
    let [first, second] = match forms.each_ref().map(shape) {
        [Ok(first), Ok(second)] => [first, second],
        // A hull may be too thin to be one.
        [Err(ContactError::Flat { .. }), _] | [_, Err(ContactError::Flat { .. })] => {
            return Verdict::due();
        }
        [Err(error), _] | [_, Err(error)] => return Verdict::refused(error),
    };
    let colliders = vec![Collider::on_body(0, first), Collider::on_body(1, second)];
    let corners = forms.each_ref().map(Form::corners);
    let hulls = [0, 1].map(|k| Hull::core(&forms[k], &poses[k]));
    let exact = ExactHulls::new([0, 1].map(|k| Place {
        corners: &corners[k],
        translation: poses[k].translation.into(),
        quaternion: poses[k].rotation.quaternion(),
    }));
    let sizes = forms.iter().map(Form::size).sum();
    judge(colliders, &configuration(&poses), [margin, sizes], &hulls, &exact)
}

/// Corners of a rectangle, or on an ellipse, turned: convex, and no two close to each other.
fn polygon(draw: &mut Draw, size: f64) -> Vec<[f64; 3]> {
    let thin = if draw.chance(0.3) { draw.log_uniform(1e-4, 1.0) } else { draw.uniform(0.3, 1.0) };
    let short = size * thin;
    let own: Vec<[f64; 2]> = match draw.below(2) {
        0 => vec![[-size, -short], [size, -short], [size, short], [-size, short]],
        _ => {
            let count = draw.between(3, 8);
            let step = std::f64::consts::TAU / count as f64;
            let corner = |k: usize, draw: &mut Draw| {
                let (s, c) = (step * (k as f64 + 0.4 * draw.symmetric())).sin_cos();
                [size * c, short * s]
            };
            (0..count).map(|k| corner(k, draw)).collect()
        }
    };
    let angle = match draw.below(3) {
        0 => 0.0,
        1 => draw.symmetric() * draw.log_uniform(1e-17, 1e-2),
        _ => 3.2 * draw.symmetric(),
    };
    let (s, c) = angle.sin_cos();
    own.iter().map(|[x, y]| [c * x - s * y, s * x + c * y, 0.0]).collect()
}

fn planar(draw: &mut Draw) -> Verdict {
    let size = draw.log_uniform(1e-6, 1e6);
    let ratio = if draw.chance(0.3) { draw.log_uniform(1e-2, 1.0) } else { 1.0 };
    let polygons = [polygon(draw, size), polygon(draw, size * ratio)];
    let n = match draw.below(3) {
        0 => Vector2::y(),
        1 => {
            // Across a side of the second.
            let k = draw.below(polygons[1].len());
            let [from, to] = [k, (k + 1) % polygons[1].len()].map(|k| polygons[1][k]);
            Vector2::new(from[1] - to[1], to[0] - from[0])
        }
        _ => Vector2::from_fn(|_, _| draw.symmetric()),
    };
    let n = n.try_normalize(1e-300).unwrap_or(Vector2::y());
    let reach = |k: usize, n: Vector2<f64>| {
        polygons[k].iter().map(|c| c[0] * n.x + c[1] * n.y).fold(f64::NEG_INFINITY, f64::max)
    };
    let gap = match draw.below(4) {
        0 => 0.0,
        1 => size * draw.symmetric() * draw.log_uniform(1e-18, 1e-9),
        2 => size * draw.symmetric() * draw.log_uniform(1e-9, 1e-2),
        _ => size * draw.symmetric(),
    };
    let shift = if draw.chance(0.3) { 0.0 } else { size * ratio * draw.symmetric() };
    let far = if draw.chance(0.3) { size * draw.log_uniform(1.0, 1e4) } else { 0.0 };
    let second = Vector2::from_fn(|_, _| draw.symmetric()) * far;
    let first = second - n * (reach(0, n) + reach(1, -n) + gap) + Vector2::new(-n.y, n.x) * shift;
    let margin = size * draw.one_of(&[0.1, 1e-3, 1e-6]);
    let places = [first, second];
    for (corners, place) in polygons.iter().zip(&places) {
        draw.note(format!("{corners:?} at {place:?}"));
    }
    draw.note(format!("gap {gap:e} along {n:?}, margin {margin:e}"));
    let shapes = polygons.each_ref().map(|corners| {
        let corners: Vec<_> = corners.iter().map(|[x, y, _]| Vector2::new(*x, *y)).collect();
        PlanarShape::polygon(&corners)
    });
    let [first, second] = match shapes {
        [Ok(first), Ok(second)] => [first, second],
        [Err(error), _] | [_, Err(error)] => return Verdict::refused(error),
    };
    let colliders = vec![PlanarCollider::on_body(0, first), PlanarCollider::on_body(1, second)];
    let exact = ExactHulls::new([0, 1].map(|k| Place {
        corners: &polygons[k],
        translation: [places[k].x, places[k].y, 0.0],
        quaternion: [1.0, 0.0, 0.0, 0.0],
    }));
    let hulls = [0, 1].map(|k| {
        let there = |c: &[f64; 3]| {
            let at = [places[k].x, places[k].y, 0.0];
            [0, 1, 2].map(|i| Twofold::from(c[i]) + Twofold::from(at[i]))
        };
        Hull::polygon(polygons[k].iter().map(there).collect())
    });
    let size =
        |corners: &Vec<[f64; 3]>| corners.iter().map(|c| c[0].hypot(c[1])).fold(0.0, f64::max);
    let sizes = polygons.iter().map(size).sum();
    let q = [places[0].x, places[0].y, 0.0, places[1].x, places[1].y, 0.0];
    judge(colliders, &q, [margin, sizes], &hulls, &exact)
}

fn judge<G: Dimension>(
    colliders: Vec<ColliderIn<G>>,
    q: &[f64],
    [margin, sizes]: [f64; 2],
    hulls: &[Hull<Twofold>; 2],
    exact: &ExactHulls,
) -> Verdict {
    let far = hulls.iter().flat_map(|hull| hull.corners.iter().flatten());
    let promised = 1e-12 * far.fold(sizes, |most, x| most.max(x.value().abs()));
    let best = farthest([&hulls[0], &hulls[1]]);
    let Some(&(first, _)) = best.first() else { return Verdict::wrong("no direction") };
    let as_good = |(value, _): &&(Twofold, Way)| (first - *value).value() <= AS_GOOD * sizes;
    let truths = best.iter().take_while(as_good).filter_map(|(_, way)| exact.separation(*way));
    let gap = truths.fold(f64::NEG_INFINITY, f64::max);
    let mut detector = match DetectorIn::new(colliders, 2) {
        Ok(detector) => detector,
        Err(error) => return Verdict::refused(error),
    };
    let mut least = |margin: f64| {
        let gaps = detector.detect(q, margin)?.iter().map(|contact| contact.gap);
        Ok::<f64, ContactError>(gaps.fold(f64::INFINITY, f64::min))
    };
    let (all, near) = match (least(20.0 * (sizes + margin)), least(margin)) {
        (Ok(all), Ok(near)) => (all, near),
        (Err(error), _) | (_, Err(error)) => return Verdict::refused(error),
    };
    let overlaps = match detector.overlaps(q, 0.0) {
        Ok(found) => !found.is_empty(),
        Err(error) => return Verdict::refused(error),
    };
    let mut verdict = Verdict::of((all - gap).abs(), promised, "the least gap");
    if near < f64::INFINITY {
        let off = (near - gap).abs();
        verdict = verdict.and(Verdict::of(off, promised, "the gap within another margin"));
    } else if gap < margin - promised {
        verdict = verdict.and(Verdict::wrong(format!("lost: a gap of {gap:e}")));
    }
    if near > margin && near < f64::INFINITY {
        verdict = verdict.and(Verdict::wrong("a gap beyond the margin"));
    }
    if gap.abs() > promised && overlaps != (gap < 0.0) {
        let told = if overlaps { "an overlap" } else { "none" };
        verdict = verdict.and(Verdict::wrong(format!("{told} is told of a gap of {gap:e}")));
    }
    verdict
}
