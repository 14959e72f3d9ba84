//! A particle flies at a plate: what detection at the ends of steps sees, and what times of impact
//! see.

use nalgebra::Vector3;
use stationary_chart::{Axis, Map};
use stationary_contact::{Closeness, Moving, particle_meets_triangle};
use stationary_measure::{Column, Table};

use crate::studies::spaced::spaced;
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Speed against thickness.
pub const TUNNELLING: Entry<'static> = Entry {
    id: "tunnelling",
    krate: "contact",
    chapter: "11.1",
    kind: Kind::StabilityMap,
    title: "Thin plate: particles missed against speed and thickness",
    tested: Tested::Claims,
    run: &study,
};

const SEEN: &str = "seen from every start";
const SOMETIMES: &str = "missed from some starts";
const NEVER: &str = "missed from nearly all";
const STEP: f64 = 1e-3;
const STARTS: usize = 40;
/// How close the particle has to come, and how exactly, m.
const TOLERANCE: f64 = 1e-9;

/// Whether the particle is inside the plate at the end of any step.
fn seen_at_ends(start: f64, speed: f64, thickness: f64) -> bool {
    let first = ((start - thickness) / (speed * STEP)).floor().max(0.0);
    let inside = |k: f64| {
        let z = start - speed * STEP * k;
        (0.0..=thickness).contains(&z)
    };
    [first, first + 1.0].into_iter().any(inside)
}

/// Whether some step's motion meets the plate's upper face, a triangle.
fn seen_on_the_way(start: f64, speed: f64, thickness: f64) -> Result<bool, StudyError> {
    let still = |x: f64, y: f64| {
        let place = Vector3::new(x, y, thickness);
        Moving { start: place, end: place }
    };
    let plate = [still(-1.0, -1.0), still(2.0, -1.0), still(-1.0, 2.0)];
    let close = Closeness { thickness: 0.0, tolerance: TOLERANCE };
    let step = ((start - thickness) / (speed * STEP)).floor().max(0.0);
    let at = |k: f64| Vector3::new(0.1, 0.2, start - speed * STEP * k);
    for k in [step - 1.0, step, step + 1.0] {
        let particle = Moving { start: at(k), end: at(k + 1.0) };
        let hit = particle_meets_triangle(&particle, &plate, close);
        if hit.map_err(StudyError::at("a time of impact"))?.is_some() {
            return Ok(true);
        }
    }
    Ok(false)
}

fn study(size: Size) -> Result<Study, StudyError> {
    let count = match size {
        Size::Default => 21,
        Size::Full => 61,
    };
    let mut table = Table::new([
        Column::rounded("speed [m/s]", 3, 0.0),
        Column::rounded("thickness [m]", 3, 0.0),
        Column::rounded("part missed at ends of steps", 3, 0.0),
        Column::exact("missed on the way"),
    ]);
    let axes = (Axis::log("thickness", "m"), Axis::log("speed", "m/s"));
    let mut map =
        Map::new("Seen at the ends of steps of 1 ms", axes.0, axes.1, [SEEN, SOMETIMES, NEVER]);
    let (mut missed, mut wrong, mut largest) = (0_u32, 0.0_f64, 0.0_f64);
    for speed in spaced(0.1, 1e3, count) {
        for thickness in spaced(1e-5, 1e-1, count) {
            let (mut at_ends, mut on_the_way) = (0_u32, 0_u32);
            for k in 0..STARTS {
                let start = 0.3 + speed * STEP * (k as f64 + 0.5) / STARTS as f64;
                at_ends += u32::from(!seen_at_ends(start, speed, thickness));
                on_the_way += u32::from(!seen_on_the_way(start, speed, thickness)?);
            }
            let part = f64::from(at_ends) / STARTS as f64;
            let predicted = (1.0 - thickness / (speed * STEP)).max(0.0);
            wrong = wrong.max((part - predicted).abs());
            largest = largest.max(speed * STEP / thickness);
            missed += on_the_way;
            let outcome = match part {
                0.0 => SEEN,
                part if part < 0.9 => SOMETIMES,
                _ => NEVER,
            };
            map.cell(thickness, speed, outcome);
            table.push([speed.into(), thickness.into(), part.into(), u64::from(on_the_way).into()]);
        }
    }
    let border = spaced(1e-4, 1e-1, 30).map(|w| (w, w / STEP));
    map = map.border("thickness a step", border);
    let claims = vec![
        Claim::number("flights missed by times of impact", "0", f64::from(missed), (0.0, 0.0)),
        Claim::number(
            "largest distance of the part missed at ends from 1 - thickness/(speed step)",
            "below 1 of 40 starts",
            wrong,
            (0.0, 1.01 / STARTS as f64),
        ),
        Claim::number("most thicknesses in a step", "1e5", largest, (0.99e5, 1.01e5)),
    ];
    Ok(Study {
        conclusion:
            "A particle flies straight at a plate from forty starts. Looked at only at the \
                     ends of steps, it is missed as soon as it moves more than a thickness a step, \
                     and as often as the thickness is smaller than the step. The time of impact \
                     misses none, at speeds up to a hundred thousand thicknesses a step."
                .into(),
        table,
        charts: vec![map.into()],
        claims,
        ..TUNNELLING.heading()
    })
}
