//! Times of impact against exact rational arithmetic, on random and nearly degenerate motions.

mod exact;

use exact::Corner;
use nalgebra::Vector3;
use stationary_contact::{Closeness, Hit, Moving, edge_meets_edge, particle_meets_triangle};
use stationary_measure::SplitMix64;

/// Coordinates are whole multiples of this, so that both sides see the same numbers.
const UNIT: f64 = 1.0 / 1024.0;
const CLOSE: Closeness = Closeness { thickness: 0.0, tolerance: 1e-8 };
/// Queries of each kind and family.
const QUERIES: usize = 1_000;

fn integer(random: &mut SplitMix64, size: i64) -> i64 {
    (random.symmetric() * (size + 1) as f64) as i64
}

fn place(random: &mut SplitMix64, size: i64) -> [i64; 3] {
    std::array::from_fn(|_| integer(random, size))
}

fn anywhere(random: &mut SplitMix64) -> [Corner; 4] {
    std::array::from_fn(|_| [place(random, 1024), place(random, 1024)])
}

/// All corners at whole multiples of a few units: many coincidences.
fn coarse(random: &mut SplitMix64) -> [Corner; 4] {
    std::array::from_fn(|_| [place(random, 2), place(random, 2)])
}

/// Everything moves in one plane.
fn coplanar(random: &mut SplitMix64) -> [Corner; 4] {
    let mut corners: [Corner; 4] = std::array::from_fn(|_| [place(random, 6), place(random, 6)]);
    corners.iter_mut().flatten().for_each(|x| x[2] = x[0] + x[1]);
    corners
}

/// The second pair of corners is the first one, shifted: edges stay parallel.
fn parallel(random: &mut SplitMix64) -> [Corner; 4] {
    let [a, b, ..] = coarse(random);
    let shifts = [place(random, 2), place(random, 2)];
    let shifted = |corner: Corner| {
        std::array::from_fn(|end| std::array::from_fn(|k| corner[end][k] + shifts[end][k]))
    };
    [a, b, shifted(a), shifted(b)]
}

/// A meeting in the middle of the motion, missed by a unit or none.
fn nearly_meeting(random: &mut SplitMix64) -> [Corner; 4] {
    let [_, a, b, c] = anywhere(random);
    // Half of corner a's motion, then a unit off.
    let middle: [i64; 3] = std::array::from_fn(|k| (a[0][k] + a[1][k]) / 2);
    let go = place(random, 512);
    let off = place(random, 1);
    let p =
        [0, 1].map(|end: i64| std::array::from_fn(|k| middle[k] + (2 * end - 1) * go[k] + off[k]));
    [p, a, b, c]
}

/// Nothing but the first corner moves, and it ends within a unit of the plane of the others.
fn grazing(random: &mut SplitMix64) -> [Corner; 4] {
    let mut corners = coarse(random);
    for corner in &mut corners[1..] {
        let flat = [corner[0][0] * 300, corner[0][1] * 300, 0];
        *corner = [flat, flat];
    }
    corners[0][0] = place(random, 600);
    corners[0][1] = [integer(random, 600), integer(random, 600), integer(random, 1)];
    corners
}

type Family = (&'static str, fn(&mut SplitMix64) -> [Corner; 4]);

const FAMILIES: [Family; 6] = [
    ("anywhere", anywhere),
    ("coarse", coarse),
    ("coplanar", coplanar),
    ("parallel", parallel),
    ("nearly meeting", nearly_meeting),
    ("grazing", grazing),
];

fn moving(corner: &Corner) -> Moving {
    let [start, end] = corner.map(|x| Vector3::from(x.map(|k| k as f64 * UNIT)));
    Moving { start, end }
}

fn distance(corners: &[Moving; 4], edges: bool, hit: &Hit) -> f64 {
    let [a, b, c, d] = corners.map(|corner| corner.at(hit.time));
    let [u, v] = hit.place;
    if edges {
        (a + (b - a) * u - c - (d - c) * v).norm()
    } else {
        (a - b - (c - b) * u - (d - b) * v).norm()
    }
}

#[derive(Default, Debug)]
struct Score {
    queries: usize,
    meetings: usize,
    missed: usize,
    invented: usize,
    unsettled: usize,
    boxes: usize,
}

fn score(family: &Family, edges: bool) -> Score {
    let mut random = SplitMix64::new(77);
    let mut score = Score::default();
    for _ in 0..QUERIES {
        let corners = (family.1)(&mut random);
        let moves: [Moving; 4] = std::array::from_fn(|k| moving(&corners[k]));
        let [a, b, c, d] = moves;
        let (truth, hit) = if edges {
            (exact::edge_meets_edge(&corners), edge_meets_edge(&[a, b], &[c, d], CLOSE))
        } else {
            let hit = particle_meets_triangle(&a, &[b, c, d], CLOSE);
            (exact::particle_meets_triangle(&corners), hit)
        };
        let hit = hit.unwrap();
        score.queries += 1;
        score.meetings += usize::from(truth);
        score.missed += usize::from(truth && hit.is_none());
        score.invented += usize::from(!truth && hit.is_some());
        if let Some(hit) = hit {
            score.boxes = score.boxes.max(hit.boxes);
            let far = distance(&moves, edges, &hit);
            assert!(!hit.settled || far <= 3.0 * CLOSE.tolerance, "{}: {far} {hit:?}", family.0);
            score.unsettled += usize::from(!hit.settled);
        }
    }
    score
}

#[test]
fn no_meeting_of_a_particle_and_a_triangle_is_missed() {
    for family in &FAMILIES {
        let score = score(family, false);
        println!("{}: {score:?}", family.0);
        assert_eq!(score.missed, 0, "{}", family.0);
        // Integers of this size that miss, miss by more than the tolerance. The bound on the boxes
        // is hit where parallel edges and collapsed triangles meet, and only there.
        assert_eq!(score.invented, 0, "{}", family.0);
        assert!(score.unsettled * 50 <= score.queries, "{}: {score:?}", family.0);
        assert!(score.meetings * 100 > score.queries, "{}: {score:?}", family.0);
    }
}

#[test]
fn no_meeting_of_two_edges_is_missed() {
    for family in &FAMILIES {
        let score = score(family, true);
        println!("{}: {score:?}", family.0);
        assert_eq!(score.missed, 0, "{}", family.0);
        assert_eq!(score.invented, 0, "{}", family.0);
        assert!(score.unsettled * 50 <= score.queries, "{}: {score:?}", family.0);
        assert!(score.meetings * 100 > score.queries, "{}: {score:?}", family.0);
    }
}

/// A corner passes a corner, and an edge's end that of another, a little farther than the thickness and a little
/// closer, in any direction.
#[test]
fn what_passes_a_corner_beyond_the_thickness_is_no_hit() {
    let mut random = SplitMix64::new(9);
    let mut vector = || Vector3::from_fn(|_, _| random.symmetric());
    for query in 0..1_000 {
        let out = vector().normalize();
        let along = out.cross(&vector()).normalize();
        let size = 10.0_f64.powf(6.0 * vector().x);
        let close = Closeness { thickness: 0.3 * size, tolerance: 1e-6 * size };
        // All else lies behind the corner at the origin.
        let mut behind = || {
            let way = vector();
            way - out * (way.dot(&out) + way.norm())
        };
        let corners = [Vector3::zeros(), behind(), behind()].map(|x| x * size);
        let still = corners.map(|start| Moving { start, end: start });
        for (part, meets) in [(1.0 + 1e-4, false), (1.0 - 1e-4, true)] {
            let [start, end] = [-2.0, 2.0].map(|t| (out * (0.3 * part) + along * t) * size);
            let passing = Moving { start, end };
            let ahead = (out + along * 0.1) * size;
            let other = Moving { start: start + ahead, end: end + ahead };
            let hits = [
                particle_meets_triangle(&passing, &still, close).unwrap(),
                edge_meets_edge(&[passing, other], &[still[0], still[1]], close).unwrap(),
            ];
            for hit in hits {
                assert_eq!(hit.is_some(), meets, "{query} {part}: {hit:?}");
                assert!(hit.is_none_or(|hit| hit.settled), "{query} {part}: {hit:?}");
            }
        }
    }
}
