//! Where two convex solids face each other, along the direction in which they are farthest apart.
//!
//! ```text
//! min |x2 - x1 - s n|        x1 x2 of what reaches farthest along n of the first, against n of the second
//! x = sum_k w_k y_k,   y_k = x2_k - x1_k - s n,   sum w_k = 1,  w_k >= 0            at most four y_k
//! ```
//! `s` the separation of the hulls along the unit normal `n`, m, so that the least is zero but for rounding.
//! The point of a set that is nearest to zero is looked for among the differences: the one that lies
//! farthest against `x` joins, then `x` goes to the nearest point of the plane of those that have joined,
//! or as far as its weights stay positive. What comes out are means of points of the solids, and so
//! belongs to them whatever rounding does. Source: Wolfe 1976 (the nearest point of a polytope).

use nalgebra::Vector3;

use crate::detect::separation::{Direction, MET, direction_near, separate};
use crate::shapes::solid::{Part, Placed};

type V = Vector3<f64>;

/// What reaches as far as the farthest within this part of the sizes may take part.
const LEVEL: f64 = 1e-9;
/// Distances below this part of the sizes are zero.
const ZERO: f64 = 1e-15;
/// Circles at a larger sine to the direction have one farthest point, to rounding; at a smaller one all of the disc
/// may be met, or that point.
const TILTED: f64 = 1e-2;
/// Points that join at most.
const ROUNDS: usize = 60;
/// Turns at the end, by what points are off.
const TURNS: usize = 4;
/// Points of a plane, in space.
const MOST: usize = 4;

/// A difference of two points, and its weight in their mean.
#[derive(Clone, Copy)]
struct Member {
    off: V,
    points: [V; 2],
    weight: f64,
}

/// Points of the hulls of two solids across the direction between them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facing {
    /// The separation of the hulls along it, m.
    pub(crate) separation: f64,
    pub(crate) normal: V,
    pub(crate) points: [V; 2],
    /// How far the points are from being across the separation along the normal, m.
    off: f64,
}

/// The closest points of two solids that are apart; none where they overlap.
pub(crate) fn closest_points(solids: [&Placed; 2]) -> Option<[V; 2]> {
    let [a, b] = solids;
    let direction = separate(solids, f64::INFINITY)?;
    let facing = facing_points(solids, &direction);
    let Facing { points: [x1, x2], normal, separation, .. } = facing;
    let apart = separation - a.rounding - b.rounding > 0.0;
    apart.then(|| [x1 + normal * a.rounding, x2 - normal * b.rounding])
}

/// Points of the hulls of two solids that face each other along a direction across a separation. Of hulls that
/// are apart they are the closest, and say the direction where the search for it left more to find.
pub(crate) fn facing_points(solids: [&Placed; 2], direction: &Direction) -> Facing {
    let [a, b] = solids;
    let scale = a.size + b.size + (b.centre - a.centre).norm();
    let n = direction.normal;
    let along = |n: &V| -b.farthest(&-n).1 - a.farthest(n).1;
    let separation = direction.gap + a.rounding + b.rounding;
    if let Some(points) = direction.met {
        return Facing { separation, normal: n, points, off: MET * scale };
    }
    let mut found = across(solids, n, separation, scale);
    if found.off <= MET * scale {
        return found;
    }
    let mut start = direction.beside_face.unwrap_or(n);
    if let Some(n) = direction.beside_face {
        let other = across(solids, n, along(&n), scale);
        found = if other.off < found.off { other } else { found };
    }
    let better = |one: &Facing, other: &Facing| {
        one.separation >= other.separation - MET * scale && one.off < other.off
    };
    if found.separation > 0.0 && found.off > MET * scale {
        let points = nearest([&a.parts, &b.parts], &n, &V::zeros(), scale);
        let way = points[1] - points[0];
        if let Some(normal) = way.try_normalize(ZERO * scale) {
            let separation = along(&normal);
            let off = (way - normal * separation).norm();
            let primal = Facing { separation, normal, points, off };
            start = normal;
            // Their points may face each other across the best direction as well.
            let off = (way - found.normal * found.separation).norm();
            let held = Facing { points, off, ..found };
            found = if better(&held, &found) { held } else { found };
            found = if better(&primal, &found) { primal } else { found };
        }
    }
    // Of a short way rounding leaves no direction, but one from which to look for it.
    if found.off > MET * scale {
        let n = direction_near(solids, &start);
        let other = across(solids, n, along(&n), scale);
        found = if better(&other, &found) { other } else { found };
    }
    let bend = |solid: &Placed, n: &V| solid.parts[solid.farthest(n).0].bend(n);
    for _ in 0..TURNS {
        let off = found.points[1] - found.points[0] - found.normal * found.separation;
        // Where the hulls bend their points follow a turn; as far as they do the turn takes what they are off.
        let n = found.normal;
        let bends = bend(a, &n) + bend(b, &-n);
        let follow = off.dot(&(bends * off)) + found.separation * off.norm_squared();
        if found.off <= MET * scale || follow <= 0.0 {
            break;
        }
        let n = (n + off * (off.norm_squared() / follow)).normalize();
        let other = across(solids, n, along(&n), scale);
        if !better(&other, &found) {
            break;
        }
        found = other;
    }
    found
}

/// Points of what reaches farthest along a direction, as far from being across a separation as need be.
fn across(solids: [&Placed; 2], n: V, separation: f64, scale: f64) -> Facing {
    let [a, b] = solids;
    let facing = |[level, tilted]: [f64; 2]| {
        let ends = [ends_of(a, &n, level * scale, tilted), ends_of(b, &-n, level * scale, tilted)];
        let points = nearest([&ends[0], &ends[1]], &n, &(n * separation), scale);
        let off = (points[1] - points[0] - n * separation).norm();
        Facing { separation, normal: n, points, off }
    };
    // Of ends that all but reach as far, rounding hides which way leads to those that do.
    let [first, others @ ..] = [[LEVEL, TILTED], [LEVEL, 0.0], [MET, TILTED], [MET, 0.0]];
    let mut found = facing(first);
    for ends in others {
        if found.off <= MET * scale {
            break;
        }
        let other = facing(ends);
        found = if other.off < found.off { other } else { found };
    }
    found
}

/// Points of two hulls of parts whose difference is nearest to a shift, beginning along a direction.
pub(crate) fn nearest(parts: [&[Part]; 2], n: &V, shift: &V, scale: f64) -> [V; 2] {
    let farthest_against = |d: &V| {
        let points = [farthest(parts[0], d), farthest(parts[1], &-d)];
        Member { off: points[1] - points[0] - shift, points, weight: 0.0 }
    };
    let mut members = Vec::with_capacity(MOST + 1);
    members.push(Member { weight: 1.0, ..farthest_against(n) });
    let mut best = (f64::INFINITY, [V::zeros(); 2]);
    for _ in 0..ROUNDS {
        let mean = |part: &dyn Fn(&Member) -> V| -> V {
            members.iter().map(|member| part(member) * member.weight).sum()
        };
        let off = mean(&|member| member.off);
        let distance = off.norm();
        if distance < best.0 {
            best = (distance, [0, 1].map(|side| mean(&|member| member.points[side])));
        }
        if distance <= ZERO * scale {
            break;
        }
        let next = farthest_against(&(off / distance));
        if off.dot(&(off - next.off)) <= ZERO * scale * distance || members.len() > MOST {
            break;
        }
        members.push(next);
        approach(&mut members);
    }
    best.1
}

/// The parts of a solid that reach farthest along a direction; circles that are tilted by less are whole.
fn ends_of(solid: &Placed, n: &V, level: f64, tilted: f64) -> Vec<Part> {
    let reach = solid.farthest(n).1 - level;
    let near = solid.parts.iter().filter(|part| part.reach(n) >= reach);
    let end = |part: &Part| match part {
        Part::Circle { axis, .. } if axis.cross(n).norm() < tilted => *part,
        _ => Part::Point(part.point(n)),
    };
    near.map(end).collect()
}

/// The point of some parts that lies farthest along a direction.
fn farthest(parts: &[Part], d: &V) -> V {
    let mut best = (f64::NEG_INFINITY, V::zeros());
    for part in parts {
        let reach = part.reach(d);
        if reach > best.0 {
            best = (reach, part.point(d));
        }
    }
    best.1
}

/// Changes weights until their mean is the point of the hull of the members that is nearest to zero; who
/// has none left leaves. The last one has just joined.
fn approach(members: &mut Vec<Member>) {
    while members.len() > 1 {
        let wanted = nearest_of_plane(members);
        let mut part = 1.0;
        for (member, wanted) in members.iter().zip(&wanted) {
            if *wanted <= 0.0 {
                part = f64::min(part, member.weight / (member.weight - wanted));
            }
        }
        for (member, wanted) in members.iter_mut().zip(&wanted) {
            member.weight += part * (wanted - member.weight);
        }
        if part >= 1.0 {
            break;
        }
        // Who reached zero first leaves, whatever rounding says.
        let least = (0..members.len())
            .filter(|&k| wanted[k] <= 0.0)
            .min_by(|&i, &j| members[i].weight.total_cmp(&members[j].weight));
        let Some(least) = least else { break };
        members.remove(least);
        members.iter_mut().for_each(|member| member.weight = member.weight.max(0.0));
    }
    let sum: f64 = members.iter().map(|member| member.weight).sum();
    members.iter_mut().for_each(|member| member.weight /= sum);
}

/// The weights, of sum 1, of the point nearest to zero of the line, plane or space of some points.
fn nearest_of_plane(members: &[Member]) -> Vec<f64> {
    let (origin, rest) = (members[0].off, &members[1..]);
    // Orthonormal directions of the plane, and the sides in their terms.
    let mut directions: Vec<V> = Vec::with_capacity(3);
    let mut weights = vec![0.0; members.len()];
    let mut kept = Vec::with_capacity(3);
    for (k, member) in rest.iter().enumerate() {
        let side = member.off - origin;
        let mut across = side;
        for _ in 0..2 {
            directions.iter().for_each(|d| across -= d * across.dot(d));
        }
        // What lies in the plane of those before it adds nothing.
        if across.norm() > 1e-12 * side.norm() && directions.len() < 3 {
            directions.push(across.normalize());
            kept.push(k);
        }
    }
    // From the last direction back: the sides are triangular in them.
    let mut left = -origin;
    for (i, &k) in kept.iter().enumerate().rev() {
        let side = rest[k].off - origin;
        let weight = left.dot(&directions[i]) / side.dot(&directions[i]);
        weights[k + 1] = weight;
        left -= side * weight;
    }
    weights[0] = 1.0 - weights[1..].iter().sum::<f64>();
    weights
}

#[cfg(test)]
mod tests {
    use super::*;
    use parry3d_f64::math::{Pose, Rotation, Vector};
    use stationary_measure::SplitMix64;

    use crate::shapes::polytope::Polytope;
    use crate::shapes::solid::Solid;

    #[test]
    fn the_points_of_a_disc_on_an_edge_are_on_both_and_face_each_other() {
        let (cylinder, mut disc) = (Solid::cylinder(1.0, 2.0), Placed::default());
        cylinder.place(&Pose::IDENTITY, &mut disc);
        let edge = |ends: [V; 2]| Placed {
            parts: ends.map(Part::Point).to_vec(),
            size: 5.0,
            ..Placed::default()
        };
        for tilt in [0.0, 1e-12, 1e-9, 1e-6] {
            let n = V::new(tilt, 0.0, 1.0).normalize();
            // Above the disc, or above its rim.
            for across in [0.3, 1.9] {
                let along = V::y() * 3.0;
                let middle = V::new(across, 0.0, 1.5);
                let other = edge([middle - along, middle + along]);
                let gap = -other.farthest(&-n).1 - disc.farthest(&n).1;
                let direction = Direction { gap, normal: n, beside_face: None, met: None };
                let Facing { points: [x1, x2], normal: n, separation, .. } =
                    facing_points([&disc, &other], &direction);
                let on_disc = x1.xy().norm() <= 2.0 + 1e-12 && (x1.z - 1.0).abs() < 1e-12;
                let on_edge = (x2.x - across).abs() < 1e-12 && x2.y.abs() <= 3.0;
                let off = (x2 - x1 - n * separation).norm();
                // A tilted disc reaches farthest at its rim, and is not met there.
                let tolerance = 1e-12 + 2.0 * tilt;
                assert!(on_disc && on_edge && off < tolerance, "{tilt:e} {across} {off:e}");
            }
        }
    }

    /// The edge of a face leans towards a cylinder's side and along it, by 3e-10: they touch at the rim, which reaches
    /// farther than the other one by less than a difference of points shows.
    #[test]
    fn an_edge_that_all_but_follows_the_side_of_a_cylinder_faces_it_at_the_rim() {
        let mut cylinder = Placed::default();
        Solid::cylinder(4.767502064361965e-6, 9.53884762526194e-6)
            .place(&Pose::IDENTITY, &mut cylinder);
        let corners = [
            V::new(-9.002534220645164e-6, -3.1534095291124723e-6, 3.5888003280029404e-15),
            V::new(-9.002534217897967e-6, -3.153409526099453e-6, 9.538847628850743e-6),
            V::new(-1.2155943749164674e-5, 5.849124689839865e-6, 1.653370065833622e-15),
            V::new(-1.7661983870622203e-5, -6.186643324601486e-6, 7.040833182533513e-15),
        ];
        let hull = Placed {
            parts: corners.map(Part::Point).to_vec(),
            faces: vec![V::new(0.9437758702750139, 0.33058600497698115, -3.762300644638561e-10)],
            centre: corners[0],
            size: corners[1].z,
            ..Placed::default()
        };
        let direction = separate([&cylinder, &hull], 0.0).unwrap();
        let found = facing_points([&cylinder, &hull], &direction);
        let [x1, x2] = found.points;
        let off = (x2 - x1 - found.normal * found.separation).norm();
        assert!(off < 1e-20, "{off:e}");
        assert!((x1.z - 4.767502064361965e-6).abs() < 1e-12, "{x1:?}");
    }

    /// Where edges, rims and sides meet on a curve, the top along it is found to rounding, however deep they overlap.
    #[test]
    fn points_of_two_solids_that_overlap_anywhere_face_each_other() {
        let mut random = SplitMix64::new(5);
        let shape = |random: &mut SplitMix64| {
            let mut uniform = || 0.5 * (random.symmetric() + 1.0);
            let thin =
                if uniform() < 0.25 { 1e-4_f64.powf(uniform()) } else { 0.3 + 0.7 * uniform() };
            let (a, b) = if uniform() < 0.5 { (1.0, thin) } else { (thin, 1.0) };
            match (4.0 * uniform()) as usize {
                0 => Solid::cylinder(a, b),
                1 => Solid::polytope(&Polytope::cuboid([a, b, 1.0]).unwrap()),
                2 => Solid::ellipsoid([a, b, 1.0]),
                _ => Solid::cone(a, b),
            }
        };
        let mut met = 0;
        while met < 3_000 {
            let solids = [shape(&mut random), shape(&mut random)];
            let mut vector =
                |size: f64| Vector::new(0.0, 0.0, 0.0).map(|_| size * random.symmetric());
            let turned = Rotation::from_scaled_axis(vector(3.0));
            let pose = Pose { rotation: turned, translation: vector(1.2) };
            let mut placed = [Placed::default(), Placed::default()];
            solids[0].place(&Pose::IDENTITY, &mut placed[0]);
            solids[1].place(&pose, &mut placed[1]);
            let [a, b] = &placed;
            let Some(direction) = separate([a, b], 0.0) else { continue };
            met += 1;
            let Facing { points: [x1, x2], normal, separation, .. } =
                facing_points([a, b], &direction);
            let off = (x2 - x1 - normal * separation).norm();
            assert!(off < 1e-10 * (a.size + b.size), "{met}: {off:e} of {a:?} {b:?}");
        }
    }

    /// The tip of a cone in a small one: along the curve on which its rim and its tip reach as far, a straight turn
    /// falls beside it by more than it gains.
    #[test]
    fn a_cone_faces_what_its_tip_is_in_although_its_rim_is_far() {
        let pose = |[x, y, z]: [f64; 3], [w, i, j, k]: [f64; 4]| Pose {
            rotation: Rotation::from_xyzw(i, j, k, w).normalize(),
            translation: Vector::new(x, y, z),
        };
        let large = pose(
            [0.05227302539869844, 0.038928766502992936, -7.759825607522511],
            [0.9579922069967443, 0.0, 0.0, -0.28679423169496876],
        );
        let small = pose(
            [0.0; 3],
            [0.20953157608841946, 0.5096172638461857, 0.3703181940081275, 0.7478309957459566],
        );
        let (mut a, mut b) = (Placed::default(), Placed::default());
        Solid::cone(9.882599231122018, 16.24920089504104).place(&Pose::IDENTITY, &mut a);
        Solid::cone(0.13093740910092988, 0.37238163802022145).place(&large.inv_mul(&small), &mut b);
        let direction = separate([&a, &b], 0.0).unwrap();
        let Facing { points: [x1, x2], normal, separation, .. } =
            facing_points([&a, &b], &direction);
        let off = (x2 - x1 - normal * separation).norm();
        assert!(off < 1e-13 * (a.size + b.size), "{off:e}");
    }
}
