//! What detection costs as the number of discs or balls grows at a fixed density.

use stationary_chart::{Axis, Lines, Series};
use stationary_contact::{
    ColliderIn, ContactError, DetectorIn, Dimension, Planar, PlanarShape, Shape, Spatial,
};
use stationary_measure::{Column, SplitMix64, Table, loglog_slope};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};
use crate::timing::{Wall, median_wall};

/// Time and pairs against the number of balls.
pub const DETECTION_COST: Entry<'static> = Entry {
    id: "detection-cost",
    krate: "contact",
    chapter: "11.1",
    kind: Kind::WorkPrecision,
    title: "Broad phase: cost against the number of shapes",
    tested: Tested::Claims,
    run: &study,
};

/// Discs and balls of this radius at one to a square or cubic metre, m.
const RADIUS: f64 = 0.3;

/// What a step of detection took and found.
struct Measured {
    pairs: usize,
    contacts: usize,
    wall: Wall,
}

/// Balls of the plane or of space at random places of a square or a cube.
fn measure<G: Dimension>(
    balls: usize,
    shape: &G::Shape,
    upright: &[f64],
    random: &mut SplitMix64,
) -> Result<Measured, ContactError> {
    let half = 0.5 * (balls as f64).powf(1.0 / G::TRANSLATION as f64);
    let mut q = Vec::with_capacity(G::STORED * balls);
    for _ in 0..balls {
        q.extend((0..G::TRANSLATION).map(|_| half * random.symmetric()));
        q.extend_from_slice(upright);
    }
    let colliders = (0..balls).map(|body| ColliderIn::on_body(body, shape.clone())).collect();
    let mut detector = DetectorIn::<G>::new(colliders, balls)?;
    let contacts = detector.detect(&q, 0.0)?.len();
    let pairs = detector.candidates().len();
    let mut failed = None;
    let wall = median_wall(|| {
        // A step: everything moves by a hundredth of a radius.
        q.chunks_exact_mut(G::STORED).for_each(|q| {
            q[..G::TRANSLATION].iter_mut().for_each(|x| *x += 0.01 * RADIUS * random.symmetric());
        });
        failed = detector.detect(&q, 0.0).err().or(failed.take());
    });
    failed.map_or(Ok(Measured { pairs, contacts, wall }), Err)
}

fn study(size: Size) -> Result<Study, StudyError> {
    let counts: &[usize] = match size {
        Size::Default => &[100, 300, 1_000, 3_000, 10_000],
        Size::Full => &[100, 300, 1_000, 3_000, 10_000, 30_000, 100_000],
    };
    let mut table = Table::new([
        Column::exact("shapes"),
        Column::exact("number"),
        Column::exact("pairs after the broad phase"),
        Column::exact("contacts"),
        Column::volatile("wall a step [s]"),
        Column::volatile("fastest [s]"),
        Column::volatile("slowest [s]"),
    ]);
    let axes = (Axis::log("number", ""), Axis::log("wall time of a step", "s"));
    let mut chart = Lines::new("Broad and narrow phase", axes.0, axes.1);
    let (mut claims, mut growth) = (Vec::new(), Vec::new());
    let disc = PlanarShape::disc(RADIUS).map_err(StudyError::at("a disc"))?;
    let ball = Shape::ball(RADIUS).map_err(StudyError::at("a ball"))?;
    for shapes in ["discs", "balls"] {
        let mut random = SplitMix64::new(4);
        let (mut walls, mut pairs) = (Vec::new(), Vec::new());
        for &number in counts {
            let measured = match shapes {
                "discs" => measure::<Planar>(number, &disc, &[0.0], &mut random),
                _ => measure::<Spatial>(number, &ball, &[1.0, 0.0, 0.0, 0.0], &mut random),
            };
            let Measured { pairs: left, contacts, wall } =
                measured.map_err(StudyError::at("detection"))?;
            walls.push((number as f64, wall.median));
            pairs.push((number as f64, left as f64));
            let counted = [number, left, contacts].map(|count| (count as u64).into());
            let times = [wall.median, wall.min, wall.max].map(Into::into);
            table.push([shapes.into()].into_iter().chain(counted).chain(times));
        }
        growth.push(loglog_slope(&walls).unwrap_or(f64::NAN));
        claims.push(Claim::number(
            format!("{shapes}: exponent of the pairs left by the broad phase against their number"),
            "1, and a little more as fewer lie at the border; at most 1.2",
            loglog_slope(&pairs).unwrap_or(f64::NAN),
            (0.95, 1.2),
        ));
        chart = chart.with(Series::new(shapes, walls.iter().copied()));
        if shapes == "balls" {
            chart = chart.slope(1.0, (1e3, walls[2].1));
        }
    }
    Ok(Study {
        conclusion: format!(
            "Discs at one to a square metre and balls at one to a cubic metre, everything moving, \
             the hierarchy refitted in each step. Pairs left to look at grow with the number of \
             shapes, not with its square; so does the time, here like its powers {:.2} and {:.2} \
             (shown, not asserted).",
            growth[0], growth[1]
        ),
        table,
        charts: vec![chart.into()],
        claims,
        ..DETECTION_COST.heading()
    })
}
