//! Towers of boxes that lean: how far they creep, against the work, the height and what statics says.
//!
//! A tower stands if the middle of what is above each joint is over what its two boxes share ([`Boxes::margin`]).

use stationary_chart::{Axis, Lines, Mark, Series};
use stationary_contact::problems::{Boxes, leaning_tower};
use stationary_contact::{ContactError, SpatialWorld};
use stationary_measure::{Column, SplitMix64, Table};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Creep of towers against work, and which of them stand.
pub const TOWERS: Entry<'static> = Entry {
    id: "towers",
    krate: "contact",
    chapter: "11.5",
    kind: Kind::WorkPrecision,
    title: "Towers of boxes: how far they creep, against work, and which of them stand",
    tested: Tested::ByReport,
    run: &study,
};

/// The step and how many are taken.
const STEP: f64 = 1e-3;
const STEPS: usize = 50;
/// A sparse system counts as so many visits of each contact.
const SYSTEM: usize = 8;
/// Boxes have a side of 1 m; less is rounding.
const LEAST: f64 = 1e-17;
/// A middle that is closer to an edge is over it, m.
const OVER_EDGE: f64 = 1e-3;
/// Up to how many boxes towers are let fall.
const LOW: usize = 100;
/// How far boxes are off from each other where work is compared.
const OFF: f64 = 1e-3;

/// What a tower did.
struct Stood {
    /// The farthest that a box has gone, m.
    crept: f64,
    /// Visits of a contact in a step, systems counted as visits.
    work: f64,
    unsettled: usize,
    /// Whether the last step solved nothing.
    rests: bool,
}

fn tower(high: usize, off: f64, seed: u64) -> Result<Boxes, ContactError> {
    leaning_tower(high, off, &mut SplitMix64::new(seed))
}

fn stand(boxes: &Boxes, tolerance: Option<f64>) -> Result<Stood, ContactError> {
    let mut state = boxes.state.clone();
    let mut world = SpatialWorld::new(boxes.system.clone(), boxes.detector()?)?;
    if let Some(tolerance) = tolerance {
        world = world.with_tolerance(tolerance)?;
    }
    let mut stood = Stood { crept: 0.0, work: 0.0, unsettled: 0, rests: false };
    for _ in 0..STEPS {
        let report = world.step(&mut state, STEP)?;
        let contacts = report.contacts.max(1) as f64;
        stood.work += report.relaxed as f64 / contacts + (SYSTEM * report.solved) as f64;
        stood.unsettled += usize::from(!report.settled);
        stood.rests = report.relaxed + report.solved == 0;
    }
    stood.work /= STEPS as f64;
    for (now, before) in state.q.chunks_exact(7).zip(boxes.state.q.chunks_exact(7)) {
        let gone = (0..3).map(|k| (now[k] - before[k]).powi(2)).sum::<f64>().sqrt();
        stood.crept = stood.crept.max(gone);
    }
    Ok(stood)
}

fn study(size: Size) -> Result<Study, StudyError> {
    let heights: &[usize] = match size {
        Size::Default => &[10, 20, 50, 100, 300],
        Size::Full => &[10, 20, 50, 100, 300, 1_000],
    };
    let mut table = Table::new([
        Column::exact("boxes"),
        Column::exact("off by [m]"),
        Column::rounded("margin of statics [m]", 2, 1e-4),
        Column::exact("asked [m/s]"),
        Column::rounded("farthest creep [m]", 1, 1e-12),
        Column::rounded("visits of a contact and step", 2, 1e-3),
        Column::exact("steps not settled"),
        Column::exact("rests"),
    ]);
    let mut row = |high: usize, off: f64, margin: f64, asked: Option<f64>, stood: &Stood| {
        table.push([
            (high as u64).into(),
            off.into(),
            margin.into(),
            asked.map_or("nothing".into(), Into::into),
            stood.crept.into(),
            stood.work.into(),
            (stood.unsettled as u64).into(),
            if stood.rests { "yes" } else { "no" }.into(),
        ]);
    };
    let at = |high: usize| StudyError::at(format!("a tower of {high}"));
    let creep = || Axis::log("farthest creep", "m");
    let work = Axis::log("visits of a contact and step", "");
    let mut cost = Lines::new("Creep against work, by what is asked for", work, creep());
    let mut free = Vec::new();
    for high in [100, 200, 400] {
        let boxes = tower(high, OFF, 5).map_err(at(high))?;
        let (mut points, mut notes) = (Vec::new(), Vec::new());
        for digits in 2..=10 {
            let asked = 10.0_f64.powi(-digits);
            let stood = stand(&boxes, Some(asked)).map_err(at(high))?;
            points.push((stood.work, stood.crept.max(LEAST)));
            notes.push(format!("{asked:.0e} m/s asked"));
            row(high, OFF, boxes.margin(), Some(asked), &stood);
        }
        let stood = stand(&boxes, None).map_err(at(high))?;
        free.push((stood.work, stood.crept.max(LEAST)));
        let series = Series::new(&format!("{high} boxes"), points);
        cost = cost.with(series.marked(Mark::Markers).noted(notes));
    }
    cost = cost.with(Series::new("nothing asked", free).marked(Mark::Markers));
    let mut edge = Lines::new(
        "Creep against what statics leaves, nothing asked",
        Axis::linear("margin of statics", "m"),
        creep(),
    );
    let (mut most, mut least, mut stand_by_statics, mut rest) = (0.0_f64, f64::INFINITY, 0, 0);
    for &high in heights {
        let mut points = Vec::new();
        for (seed, off) in [OFF, 0.1, 0.2, 0.3, 0.4, 0.45].into_iter().enumerate() {
            let boxes = tower(high, off, 5 + seed as u64).map_err(at(high))?;
            let margin = boxes.margin();
            // A high one that falls costs much, and shows nothing that low ones do not.
            if margin < 0.0 && high > LOW {
                continue;
            }
            let stood = stand(&boxes, None).map_err(at(high))?;
            points.push((margin, stood.crept.max(LEAST)));
            row(high, off, margin, None, &stood);
            if margin > OVER_EDGE {
                most = most.max(stood.crept);
                stand_by_statics += 1;
                rest += usize::from(stood.rests && stood.unsettled == 0);
            } else if margin < -OVER_EDGE {
                least = least.min(stood.crept);
            }
        }
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        edge = edge.with(Series::new(&format!("{high} boxes"), points).marked(Mark::Markers));
    }
    Ok(Study {
        conclusion: format!(
            "Cubes of 1 m and 1 kg on each other, each off the middle by as much at random, for {STEPS} steps of \
             {STEP:e} s. First contacts are taken to hold, all of them and then those that push, which is a few \
             sparse systems: that leaves rounding, whatever the height. What is left is far less than was asked for, \
             so there is no reason to ask for less. Towers of 10 and 20 are projected exactly, without a visit. The \
             margin is how far the middle of what is above a joint is inside of what its two boxes share: whatever \
             it is, a tower stands where it is positive, and falls where it is not."
        ),
        table,
        charts: vec![cost.into(), edge.into()],
        claims: vec![
            Claim::number(
                "towers that stand by statics: farthest creep, m",
                "below 1e-8",
                most,
                (0.0, 1e-8),
            ),
            Claim::number(
                "of them, those that are settled in every step and rest at last",
                "all",
                rest as f64,
                (stand_by_statics as f64, stand_by_statics as f64),
            ),
            Claim::number(
                "towers that fall by statics: least motion, m",
                "above 1e-6",
                least,
                (1e-6, 1.0),
            ),
        ],
        ..TOWERS.heading()
    })
}
