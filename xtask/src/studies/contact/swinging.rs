//! A block under a pull that beats friction for a part of each swing: error against work.

use nalgebra::Vector2;
use stationary_calculus::{Covector, DiagonalMetric, Force, System, Vector};
use stationary_chart::{Axis, Lines, Series};
use stationary_contact::{
    ContactError, ErrorControlled, PlanarCollider, PlanarDetector, PlanarShape, PlanarWorld,
    StepForces,
};
use stationary_integrators::State;
use stationary_measure::{Column, Table, loglog_slope};
use stationary_rigid::{LieGroup, PlanarMotion, PlanarWeight};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Fixed steps, steps chosen by error, and such that are told means alone.
pub const SWINGING_PULL: Entry<'static> = Entry {
    id: "swinging-pull",
    krate: "contact",
    chapter: "11.5",
    kind: Kind::WorkPrecision,
    title: "A block under a pull that swings: error against work, with and without what means leave out",
    tested: Tested::Claims,
    run: &study,
};

const GRAVITY: f64 = 10.0;
const FRICTION: f64 = 0.3;
/// The pull, N, of a block of 1 kg: a tenth more than friction, so that it slips for a part of each swing.
const SIZE: f64 = 1.1 * FRICTION * GRAVITY;
/// Nearly three swings in a second.
const OMEGA: f64 = 17.0;
/// Moments at which places are compared, and how far apart they are, s.
const MOMENTS: usize = 20;
const APART: f64 = 0.1;
/// Parts of a swing in which the closed form looks for an end of slip.
const PARTS: f64 = 500.0;

/// The pull `SIZE sin(OMEGA t)` along the table, which may keep to itself by how much it leaves its mean.
#[derive(Clone, Copy)]
struct Pull {
    mean: f64,
    h: f64,
    says_swings: bool,
}

fn pull(t: f64) -> f64 {
    SIZE * (OMEGA * t).sin()
}

impl Force for Pull {
    fn dim(&self) -> usize {
        3
    }

    fn add_force(&self, _: f64, _: &[f64], _: Vector<&[f64]>, force: Covector<&mut [f64]>) {
        force.0[0] += self.mean;
    }
}

impl StepForces for Pull {
    fn prepare(&mut self, state: &mut State<Vec<f64>>, h: f64) {
        let [from, to] = [state.t, state.t + h].map(|t| (OMEGA * t).cos());
        (self.mean, self.h) = (SIZE * (from - to) / (OMEGA * h), h);
    }

    fn add_works(&self, _: [&State<Vec<f64>>; 2], _: Vector<&[f64]>, _: &mut [f64]) {}

    fn add_swings(&self, _: &State<Vec<f64>>, swings: &mut [f64]) {
        if self.says_swings {
            swings[0] += (SIZE * OMEGA * self.h).min(2.0 * SIZE);
        }
    }

    fn next_corner(&self, _: f64) -> Option<f64> {
        None
    }
}

/// Where the block is at the moments: it sticks until the pull beats friction, then
/// `v = v0 + SIZE/OMEGA (cos(OMEGA t0) - cos(OMEGA t)) -+ FRICTION GRAVITY (t - t0)` until that is zero.
fn known() -> Vec<f64> {
    let bound = FRICTION * GRAVITY;
    let part = std::f64::consts::TAU / OMEGA / PARTS;
    let root = |mut low: f64, mut high: f64, is_before: &dyn Fn(f64) -> bool| {
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if is_before(middle) { low = middle } else { high = middle }
        }
        high
    };
    let (mut t, mut x, mut places) = (0.0, 0.0, Vec::new());
    // Sticking from `t` at `x`; each turn adds one slip.
    while places.len() < MOMENTS {
        let mut start = t;
        while pull(start).abs() <= bound {
            start += part;
        }
        // What beats friction when it comes to rest goes on the other way at once.
        let start =
            if start > t { root(start - part, start, &|t| pull(t).abs() <= bound) } else { t };
        let sign = pull(start + 1e-9).signum();
        let speed = |t: f64| {
            SIZE / OMEGA * ((OMEGA * start).cos() - (OMEGA * t).cos()) - sign * bound * (t - start)
        };
        let mut end = start + part;
        while sign * speed(end) > 0.0 {
            end += part;
        }
        let end = root(end - part, end, &|t| sign * speed(t) > 0.0);
        let at = |t: f64| {
            let t = t.clamp(start, end);
            let swung = ((OMEGA * t).sin() - (OMEGA * start).sin()) / OMEGA;
            let fell = 0.5 * sign * bound * (t - start) * (t - start);
            x + SIZE / OMEGA * ((OMEGA * start).cos() * (t - start) - swung) - fell
        };
        while places.len() < MOMENTS && (places.len() + 1) as f64 * APART <= end {
            places.push(at((places.len() + 1) as f64 * APART));
        }
        (t, x) = (end, at(end));
    }
    places
}

fn block() -> Result<(PlanarWorld<PlanarWeight>, State<Vec<f64>>), ContactError> {
    let floor = PlanarShape::half_plane(Vector2::y())?;
    let colliders = vec![
        PlanarCollider::on_body(0, PlanarShape::cuboid([0.5, 0.05])?).with_friction(FRICTION),
        PlanarCollider::fixed(PlanarMotion::identity(), floor).with_friction(FRICTION),
    ];
    let weight = PlanarWeight { gravity: Vector2::y() * -GRAVITY, masses: vec![1.0] };
    let system = System::new(DiagonalMetric::new(vec![1.0, 1.0, 0.1])?, weight)?;
    let world = PlanarWorld::new(system, PlanarDetector::new(colliders, 1)?)?;
    Ok((world, State::new(vec![0.0, 0.05, 0.0], Covector(vec![0.0; 3]))))
}

/// Steps of a world that all moments take, and the largest error there, m.
fn measured(
    known: &[f64],
    mut advance: impl FnMut(&mut State<Vec<f64>>) -> Result<usize, ContactError>,
) -> Result<(f64, f64), ContactError> {
    let (_, mut state) = block()?;
    let (mut work, mut worst) = (0, 0.0_f64);
    for place in known {
        work += advance(&mut state)?;
        worst = worst.max((state.q[0] - place).abs());
    }
    Ok((work as f64, worst))
}

fn fixed(known: &[f64], h: f64) -> Result<(f64, f64), ContactError> {
    let mut world = block()?.0;
    let mut pull = Pull { mean: 0.0, h, says_swings: false };
    let steps = (APART / h).round() as usize;
    measured(known, |state| {
        for _ in 0..steps {
            let h = APART / steps as f64;
            pull.prepare(state, h);
            world.step_under(state, h, &(), &pull)?;
        }
        Ok(steps)
    })
}

fn chosen(known: &[f64], accuracy: f64, says_swings: bool) -> Result<(f64, f64), ContactError> {
    let mut chosen = ErrorControlled::new(block()?.0, accuracy)?;
    let mut pull = Pull { mean: 0.0, h: 0.0, says_swings };
    measured(known, |state| Ok(chosen.advance_under(state, APART, &mut pull)?.world_steps))
}

fn study(size: Size) -> Result<Study, StudyError> {
    let count = match size {
        Size::Default => 5,
        Size::Full => 7,
    };
    let settings = |from: f64| (0..count).map(move |k| from * 10_f64.powf(-0.5 * f64::from(k)));
    let known = known();
    let mut table = Table::new([
        Column::exact("way"),
        Column::rounded("setting [s or m]", 2, 0.0),
        Column::rounded("steps of the world", 1, 1.0),
        Column::rounded("largest error [m]", 1, 1e-9),
    ]);
    let axes = (Axis::log("steps of the world", ""), Axis::log("largest error", "m"));
    let mut chart = Lines::new("", axes.0, axes.1);
    let mut over = [0.0_f64; 2];
    let mut order = f64::NAN;
    for (k, way) in ["fixed", "chosen", "chosen, told means alone"].into_iter().enumerate() {
        let mut points = Vec::new();
        for setting in settings(if k == 0 { 1e-2 } else { 1e-3 }) {
            let run = match k {
                0 => fixed(&known, setting),
                _ => chosen(&known, setting, k == 1),
            };
            let (work, error) = run.map_err(StudyError::at(way))?;
            table.push([way.into(), setting.into(), (work as u64).into(), error.into()]);
            points.push((work, error));
            if k > 0 {
                over[k - 1] = over[k - 1].max(error / setting);
            }
        }
        if k == 0 {
            order = loglog_slope(&points).map_or(f64::NAN, |slope| -slope);
        }
        chart = chart.with(Series::new(way, points));
    }
    Ok(Study {
        conclusion: "A pull that swings beats friction by a tenth for a part of each swing, and the block slips then \
                     alone. Steps chosen by error keep to the accuracy that is asked for where the pull says by how \
                     much it leaves its mean over a step. Told means alone they step over a slip, and are off by \
                     it whatever is asked for. Fixed steps are of order 1: the least work down to errors of 5e-6 m, \
                     and six times that of chosen ones at 5e-7 m."
            .into(),
        table,
        charts: vec![chart.into()],
        claims: vec![
            Claim::number(
                "chosen: the largest error over the accuracy asked for",
                "below 1",
                over[0],
                (0.0, 1.0),
            ),
            Claim::number(
                "told means alone: the largest error over the accuracy asked for",
                "above 3",
                over[1],
                (3.0, 1e6),
            ),
            Claim::number("order of fixed steps, by work", "1", order, (0.7, 2.3)),
        ],
        ..SWINGING_PULL.heading()
    })
}
