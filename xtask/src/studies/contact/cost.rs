//! What detection costs as the number of balls grows at a fixed density.

use nalgebra::Vector3;
use stationary_calculus::{Column, SplitMix64, Table, loglog_slope};
use stationary_contact::{Collider, Detector, Shape};

use crate::chart::{Axis, Lines, Series};
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError};
use crate::timing::median_wall;

/// Time and pairs against the number of balls.
pub const DETECTION_COST: Entry<'static> = Entry {
    id: "detection-cost",
    krate: "contact",
    chapter: "11.1",
    kind: Kind::WorkPrecision,
    title: "Who can touch whom",
    run: &study,
};

/// Balls of radius 0.3 m at one to a cubic metre.
const RADIUS: f64 = 0.3;

fn place(random: &mut SplitMix64, balls: usize) -> Vec<f64> {
    let half = 0.5 * (balls as f64).cbrt();
    let pose = |_| {
        let c = Vector3::from_fn(|_, _| half * random.symmetric());
        [c.x, c.y, c.z, 1.0, 0.0, 0.0, 0.0]
    };
    (0..balls).flat_map(pose).collect()
}

fn study(size: Size) -> Result<Study, StudyError> {
    let counts: &[usize] = match size {
        Size::Default => &[100, 300, 1_000, 3_000, 10_000],
        Size::Full => &[100, 300, 1_000, 3_000, 10_000, 30_000, 100_000],
    };
    let mut table = Table::new([
        Column::exact("balls"),
        Column::exact("pairs after the broad phase"),
        Column::exact("contacts"),
        Column::volatile("wall a step [s]"),
        Column::volatile("fastest [s]"),
        Column::volatile("slowest [s]"),
    ]);
    let mut random = SplitMix64::new(4);
    let (mut walls, mut pairs) = (Vec::new(), Vec::new());
    for &balls in counts {
        let shape = Shape::ball(RADIUS).map_err(StudyError::at("a ball"))?;
        let colliders = (0..balls).map(|body| Collider::on_body(body, shape.clone())).collect();
        let mut detector = Detector::new(colliders, balls).map_err(StudyError::at("a detector"))?;
        let mut q = place(&mut random, balls);
        let contacts = detector.detect(&q, 0.0).map_err(StudyError::at("detection"))?.len();
        let left = detector.candidates().len();
        let mut failed = None;
        let wall = median_wall(5, || {
            // A step: everything moves by a hundredth of a radius.
            q.chunks_exact_mut(7).for_each(|q| {
                q[..3].iter_mut().for_each(|x| *x += 0.01 * RADIUS * random.symmetric());
            });
            failed = detector.detect(&q, 0.0).err().or(failed.take());
        });
        if let Some(error) = failed {
            return Err(StudyError::at("detection")(error));
        }
        let n = balls as f64;
        walls.push((n, wall.median));
        pairs.push((n, left as f64));
        let counts = [balls, left, contacts].map(|count| (count as u64).into());
        let times = [wall.median, wall.min, wall.max].map(Into::into);
        table.push(counts.into_iter().chain(times));
    }
    let measured = loglog_slope(&walls).unwrap_or(f64::NAN);
    let exponent = loglog_slope(&pairs).unwrap_or(f64::NAN);
    let claims = vec![Claim::number(
        "exponent of the pairs left by the broad phase against the number of balls",
        "1, and a little more as fewer lie at the surface",
        exponent,
        (0.95, 1.2),
    )];
    let axes = (Axis::log("balls", ""), Axis::log("wall time of a step", "s"));
    let chart = Lines::new("Broad and narrow phase", axes.0, axes.1)
        .with(Series::new("detection", walls.iter().copied()))
        .slope(1.0, (1e3, walls[2].1));
    Ok(Study {
        id: DETECTION_COST.id,
        krate: DETECTION_COST.krate,
        chapter: DETECTION_COST.chapter,
        kind: DETECTION_COST.kind,
        title: DETECTION_COST.title.into(),
        conclusion: format!(
            "Balls at one to a cubic metre, everything moving, the hierarchy refitted in each step. \
             Pairs left to look at grow with the number of balls, not with its square; so does the \
             time, here like its power {measured:.2} (shown, not asserted)."
        ),
        table,
        charts: vec![chart.into()],
        claims,
    })
}
