//! Mechanisms that the multibody community publishes, in joint coordinates and in full ones.

mod runs;

use std::hint::black_box;

use stationary_chart::{Axis, Chart, Lines, Series};
use stationary_constraints::ConstraintError;
use stationary_integrators::Scheme;
use stationary_measure::{Cell, Column, Table, loglog_slope};
use stationary_rigid::problems::{bricard, four_bars, governor, squeezer};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};
use crate::timing::median_wall;
use runs::{Point, Run, Seen};

/// Error against work and time of published mechanisms.
pub const PUBLISHED: Entry<'static> = Entry {
    id: "published-mechanisms",
    krate: "rigid",
    chapter: "6.5",
    kind: Kind::WorkPrecision,
    title: "Published mechanisms: error against cost at orders 2, 4 and 6, reduced beside full",
    tested: Tested::LongTable,
    run: &study,
};

/// Errors below this are rounding, and tell no order.
const ROUNDING: f64 = 3e-13;
const REDUCED: &str = "dormand-prince-853, joint coordinates";
/// The damping with which the governor was published, N s/m.
const DAMPING: f64 = 4e4;

type Way = (&'static str, Option<Scheme>, f64);

const ORDERS: [Way; 3] = [
    ("RATTLE, order 2", None, 2.0),
    ("RATTLE, order 4", Some(Scheme::Suzuki4), 4.0),
    ("RATTLE, order 6", Some(Scheme::KahanLi6), 6.0),
];

/// A mechanism in both ways.
struct Both<'a> {
    name: &'static str,
    time: f64,
    full: &'a dyn Fn(Option<Scheme>, u32) -> Result<Run, ConstraintError>,
    reduced: &'a dyn Fn(f64) -> Result<Run, StudyError>,
}

struct Page {
    table: Table,
    charts: Vec<Chart>,
    claims: Vec<Claim>,
    named: u32,
}

impl Page {
    /// One mechanism in full coordinates and as a tree, which at the first tolerance is the truth.
    fn told_twice(
        &mut self,
        name: &'static str,
        seen: &Seen<'_>,
        orders: &[Way],
        (finest, steps): (f64, &[u32]),
    ) -> Result<(), StudyError> {
        let (full, reduced) =
            (&|scheme, steps| seen.full(scheme, steps), &|tolerance| seen.tree(tolerance));
        let both = Both { name, time: seen.time, full, reduced };
        self.measure(&both, orders, &seen.tree(finest)?, steps)
    }

    /// One mechanism in full coordinates at these orders, and reduced at three tolerances.
    fn measure(
        &mut self,
        both: &Both<'_>,
        orders: &[Way],
        truth: &Run,
        steps: &[u32],
    ) -> Result<(), StudyError> {
        let &Both { name, time, full, reduced } = both;
        let error = || Axis::log("error of a place on the way", "m");
        let mut counted =
            Lines::new(&format!("{name}, by work"), Axis::log("joints solved for", ""), error());
        let mut timed = Lines::new(&format!("{name}, by time"), Axis::log("time", "s"), error());
        for &(way, scheme, order) in orders {
            let (mut by_step, mut by_work, mut by_time) = (Vec::new(), Vec::new(), Vec::new());
            for &steps in steps {
                let mut last = None;
                let wall = median_wall(|| last = Some(black_box(full(scheme, steps))));
                let run = match last.unwrap_or_else(|| full(scheme, steps)) {
                    Ok(run) => run,
                    Err(ConstraintError::SingularPosition { .. }) => {
                        self.named += 1;
                        self.row(name, way, format!("{steps} steps"), None, wall.median);
                        continue;
                    }
                    Err(error) => return Err(StudyError::at("a full run")(error)),
                };
                let error = run.error(truth);
                self.row(name, way, format!("{steps} steps"), Some((run.work, error)), wall.median);
                if error > ROUNDING {
                    by_step.push((time / f64::from(steps), error));
                }
                by_work.push((run.work as f64, error));
                by_time.push((wall.median, error));
            }
            let slope = loglog_slope(&by_step).unwrap_or(f64::NAN);
            let band = (order - 0.4, order + 0.6);
            let text = format!("{name}; {way}: order of the place");
            self.claims.push(Claim::number(text, format!("{order}"), slope, band));
            counted = counted.with(Series::new(way, by_work));
            timed = timed.with(Series::new(way, by_time));
        }
        let (mut by_work, mut by_time, mut least) = (Vec::new(), Vec::new(), f64::INFINITY);
        for tolerance in [1e-5, 1e-7, 1e-9] {
            let mut last = None;
            let wall = median_wall(|| last = Some(black_box(reduced(tolerance))));
            let run = last.unwrap_or_else(|| reduced(tolerance))?;
            let (setting, error) = (format!("{tolerance:.0e}"), run.error(truth));
            self.row(name, REDUCED, setting, Some((run.work, error)), wall.median);
            by_work.push((run.work as f64, error));
            by_time.push((wall.median, error));
            least = least.min(error);
        }
        let text = format!("{name}; {REDUCED}: error at the finest tolerance, m");
        self.claims.push(Claim::number(text, "less than 1e-6", least, (0.0, 1e-6)));
        self.charts.push(counted.with(Series::new(REDUCED, by_work)).into());
        self.charts.push(timed.with(Series::new(REDUCED, by_time)).into());
        Ok(())
    }

    fn row(
        &mut self,
        name: &str,
        way: &str,
        setting: String,
        found: Option<(u64, f64)>,
        time: f64,
    ) {
        let (work, error): (Cell, Cell) = match found {
            // Rounded: how many iterations a step takes may differ by one between processors.
            Some((work, error)) => ((work as f64).into(), error.into()),
            None => ("-".into(), "singular position named".into()),
        };
        self.table.push([name.into(), way.into(), setting.into(), work, error, time.into()]);
    }
}

fn study(size: Size) -> Result<Study, StudyError> {
    let (halvings, time) = match size {
        Size::Default => (3, 2.0),
        Size::Full => (5, 10.0),
    };
    let doubled = |coarsest: u32| -> Vec<u32> { (0..halvings).map(|k| coarsest << k).collect() };
    let mut page = Page {
        table: Table::new([
            Column::exact("mechanism"),
            Column::exact("way"),
            Column::exact("setting"),
            Column::rounded("joints solved for", 2, 0.0),
            Column::rounded("error [m]", 1, 1e-8),
            Column::volatile("time [s]"),
        ]),
        charts: Vec::new(),
        claims: Vec::new(),
        named: 0,
    };
    let per_second = (time / 2.0) as u32;
    let point = Point::new(time)?;
    let both = Both {
        name: "point on a rod",
        time,
        full: &|scheme, steps| point.full(scheme, steps),
        reduced: &|tolerance| point.by_angle(tolerance),
    };
    page.measure(&both, &ORDERS, &point.truth(), &doubled(80 * per_second))?;

    let bars = four_bars(2).map_err(StudyError::at("the four-bars"))?;
    let seen = Seen::new(&bars, (0, time))?;
    let both = Both {
        name: "two four-bars",
        time,
        full: &|scheme, steps| seen.full(scheme, steps),
        reduced: &|tolerance| runs::four_bars_by_angle(2, time, tolerance),
    };
    let truth = (both.reduced)(1e-13)?;
    page.measure(&both, &ORDERS, &truth, &doubled(104 * per_second))?;

    let six = bricard().map_err(StudyError::at("the six-bar"))?;
    let seen = Seen::new(&six, (2, time))?;
    page.told_twice("Bricard's six-bar", &seen, &ORDERS, (1e-13, &doubled(80 * per_second)))?;

    // Dampers act backward in the backward parts of composed steps: orders 4 and 6 are measured without.
    for (name, damping, orders) in
        [("governor", DAMPING, &ORDERS[..1]), ("governor without dampers", 0.0, &ORDERS[..])]
    {
        let governor = governor(damping).map_err(StudyError::at("the governor"))?;
        let seen = Seen::new(&governor, (1, 0.125))?;
        page.told_twice(name, &seen, orders, (1e-12, &doubled(200)))?;
    }

    let seven = squeezer().map_err(StudyError::at("the squeezer"))?;
    let seen = Seen::new(&seven, (2, seven.horizon))?;
    page.told_twice("Andrews' squeezer", &seen, &ORDERS, (1e-13, &doubled(200)))?;

    let Page { table, charts, claims, named, .. } = page;
    Ok(Study {
        conclusion: format!(
            "A point on a rod, two four-bars, Bricard's redundant six-bar and a flyball governor, told as the \
             benchmark library of the multibody community tells them (IFToMM, A01, A02, A04, A05; the governor for \
             an eighth of a second, the others for {time} s), and Andrews' squeezer for its 0.03 s, in full \
             coordinates at orders 2, 4 and 6, and in few coordinates. Redundant equations do no harm to any order. \
             The four-bars pass where they lie flat, and may go on in two ways there, on their branch; {named} runs \
             ended a step too close to it, and named it. Orders 4 and 6 need less work than order 2 for less than \
             about 1e-4 m; with stiff dampers, which composed steps take backward, only order 2 is of use. In joint \
             coordinates each took less time at every error."
        ),
        table,
        charts,
        claims,
        ..PUBLISHED.heading()
    })
}
