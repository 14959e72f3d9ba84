//! Hamilton's principle: impulses as the limit of forces, and what kind of point a motion is.

use std::f64::consts::PI;
use std::ops::ControlFlow;

use stationary_calculus::{Covector, Energy, Number};
use stationary_chart::{Axis, BarSeries, Bars, Lines, Series, significant};
use stationary_integrators::problems::pendulum;
use stationary_integrators::{
    Action, Horizon, Impulse, Integrator, Load, Mechanical, Observation, Quadrature, Sampled,
    State, Stationary, Variational, bump, simulate, simulate_with_impulses,
};
use stationary_measure::{Column, Table, loglog_slope};

use crate::study::{Claim, Entry, Kind, Study, StudyError, Tested};

/// A short force against the impulse that it tends to.
pub const IMPULSE_LIMIT: Entry<'static> = Entry {
    id: "impulse-limit",
    krate: "integrators",
    chapter: "10.2",
    kind: Kind::Convergence,
    title: "Short force: distance from the impulse against its duration",
    tested: Tested::Claims,
    run: &|_| impulse_limit(),
};

/// Index and action of motions between two ends.
pub const BOUNDARY_VALUE: Entry<'static> = Entry {
    id: "action-boundary-value",
    krate: "integrators",
    chapter: "5.4",
    kind: Kind::Convergence,
    title: "Least action: in how many ways it can be lowered, against the duration",
    tested: Tested::Claims,
    run: &|_| boundary_value(),
};

/// A unit mass on a spring of stiffness 1.
#[derive(Clone, Copy)]
struct Spring;

impl Energy<1> for Spring {
    fn energy<R: Number>(&self, [q]: [R; 1]) -> R {
        q * q * 0.5
    }
}

/// A unit pendulum.
#[derive(Clone, Copy)]
struct Rod;

impl Energy<1> for Rod {
    fn energy<R: Number>(&self, [theta]: [R; 1]) -> R {
        -theta.cos()
    }
}

type Recipe<E> = Sampled<Mechanical<E, 1>>;

fn recipe<E: Energy<1>>(energy: E) -> Result<Recipe<E>, StudyError> {
    let lagrangian = Mechanical::new([1.0], energy).map_err(StudyError::at("a unit mass"))?;
    Ok(Sampled { lagrangian, quadrature: Quadrature::Middle })
}

/// When the impulse arrives, how large it is, and when the two motions are compared.
const ARRIVAL: f64 = 1.0;
const IMPULSE: f64 = 1.0;
const END: f64 = 3.0;

/// Steps over the width of the bump: their sum over a parabola is off by 1/(2 STEPS^2).
const STEPS: u64 = 4000;
/// Steps before the bump, and after it.
const AROUND: u64 = 200;

/// Where a bump lies relative to the arrival of the impulse.
#[derive(Clone, Copy)]
enum Place {
    Starts,
    Centred,
}

fn impulse_limit() -> Result<Study, StudyError> {
    let widths: Vec<f64> = (1..=6).map(|i| 0.5_f64.powi(i)).collect();
    let mut table = Table::new([
        Column::rounded("width [s]", 6, 0.0),
        Column::rounded("distance, bump starts then", 3, 1e-7),
        Column::rounded("distance, bump centred then", 3, 1e-7),
    ]);
    let (mut starting, mut centred) = (Vec::new(), Vec::new());
    for &width in &widths {
        let distances = [distance(width, Place::Starts)?, distance(width, Place::Centred)?];
        starting.push((width, distances[0]));
        centred.push((width, distances[1]));
        table.push([width.into(), distances[0].into(), distances[1].into()]);
    }
    let slope = |points: &[(f64, f64)]| loglog_slope(points).unwrap_or(f64::NAN);
    let constant = |points: &[(f64, f64)], power| match points.last() {
        Some((width, distance)) => distance / (IMPULSE * width.powi(power)),
        None => f64::NAN,
    };
    let claims = vec![
        Claim::number(
            "slope of the distance where the bump starts with the impulse",
            "1",
            slope(&starting),
            (0.98, 1.02),
        ),
        Claim::number(
            "that distance over impulse and width: the bump's mean delay",
            "1/2",
            constant(&starting, 1),
            (0.495, 0.505),
        ),
        Claim::number(
            "slope of the distance where the bump is centred on the impulse",
            "2",
            slope(&centred),
            (1.98, 2.02),
        ),
        Claim::number(
            "that distance over impulse and squared width: half the bump's variance",
            "1/40",
            constant(&centred, 2),
            (0.0245, 0.0255),
        ),
    ];
    let chart = Lines::new(
        "",
        Axis::log("width of the bump", "s"),
        Axis::log("distance from the motion with the impulse", ""),
    )
    .with(Series::new("bump starts with the impulse", starting))
    .with(Series::new("bump centred on the impulse", centred))
    .slope(1.0, (0.05, 0.035))
    .slope(2.0, (0.05, 5e-5));
    Ok(Study {
        conclusion: "An oscillator is struck once: by an impulse, which splits a step, or by a \
                     parabolic bump of force with the same integral. As the bump narrows, the two \
                     motions approach each other with slope 1, because the bump acts half its \
                     width later on average. A bump that is centred on the impulse is not late, \
                     and the slope is 2."
            .into(),
        table,
        charts: vec![chart.into()],
        claims,
        ..IMPULSE_LIMIT.heading()
    })
}

/// How far apart in phase space a bump and the impulse leave the oscillator, over the same steps.
fn distance(width: f64, place: Place) -> Result<f64, StudyError> {
    let (start, stage) = match place {
        Place::Starts => (ARRIVAL, "a bump that starts with the impulse"),
        Place::Centred => (ARRIVAL - 0.5 * width, "a bump that is centred on the impulse"),
    };
    let strength = bump(start, width).map_err(StudyError::at(stage))?;
    let load = Load { direction: Covector([IMPULSE]), strength };
    let mut forced = Variational::forced(recipe(Spring)?, load).map_err(StudyError::at(stage))?;
    let mut free = Variational::new(recipe(Spring)?).map_err(StudyError::at(stage))?;
    let impulse = Impulse { time: ARRIVAL, momentum: Covector([IMPULSE]) };
    let (mut pushed, mut struck) =
        (State::new([1.0], Covector([0.0])), State::new([1.0], Covector([0.0])));
    let parts = [
        (0.0, start, AROUND, None),
        (start, start + width, STEPS, Some(impulse)),
        (start + width, END, AROUND, None),
    ];
    for (from, to, steps, impulse) in parts {
        let horizon = Horizon::divided(to - from, steps).map_err(StudyError::at(stage))?;
        let horizon = horizon.starting(from);
        let go_on = |_: Observation<'_, _>| ControlFlow::Continue(());
        simulate(&mut forced, &mut pushed, horizon, go_on).map_err(StudyError::at(stage))?;
        simulate_with_impulses(&mut free, &mut struck, horizon, impulse.as_slice(), go_on)
            .map_err(StudyError::at(stage))?;
    }
    Ok((pushed.q[0] - struck.q[0]).hypot(pushed.p.0[0] - struck.p.0[0]))
}

/// Steps of a path.
const POINTS: usize = 200;

/// How far the guess lies from the motion, in the middle, radians or metres.
const ASTRAY: f64 = 0.01;

/// A motion between two ends, found as a boundary-value problem.
struct Found {
    /// Half periods.
    duration: f64,
    index: usize,
    /// Zeros of the motion's derivative by its first momentum: conjugate points passed.
    passed: usize,
    kind: Stationary,
    /// The largest distance from the motion of the initial-value problem.
    off: f64,
    /// The largest differential of the action.
    differential: f64,
}

/// The motion from zero with a momentum, as configurations.
fn motion<E: Energy<1>>(energy: E, momentum: f64, h: f64) -> Result<Vec<[f64; 1]>, StudyError> {
    let mut integrator = Variational::new(recipe(energy)?).map_err(StudyError::at("the motion"))?;
    let mut state = State::new([0.0], Covector([momentum]));
    let mut path = vec![state.q];
    for _ in 0..POINTS {
        integrator.step(&mut state, h).map_err(StudyError::at("the motion"))?;
        path.push(state.q);
    }
    Ok(path)
}

fn found<E: Energy<1> + Copy>(
    energy: E,
    momentum: f64,
    half_period: f64,
    duration: f64,
) -> Result<Found, StudyError> {
    let stage = "the boundary-value problem";
    let h = duration * half_period / POINTS as f64;
    let path = motion(energy, momentum, h)?;
    let [less, more] = [-1e-6, 1e-6].map(|by| motion(energy, momentum + by, h));
    let spread: Vec<f64> = less?.iter().zip(more?).map(|(a, b)| b[0] - a[0]).collect();
    let passed = spread[1..].windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count();
    let action = Action::new(recipe(energy)?, vec![h; POINTS]).map_err(StudyError::at(stage))?;
    let bent = |(i, q): (usize, &[f64; 1])| [q[0] + ASTRAY * wave(1, i)];
    let guess = path.iter().enumerate().map(bent).collect();
    let solution = action.stationary_path(guess).map_err(StudyError::at(stage))?;
    let differential = action.differential(&solution.path).map_err(StudyError::at(stage))?;
    let off = solution.path.iter().zip(&path).map(|(a, b)| (a[0] - b[0]).abs());
    Ok(Found {
        duration,
        index: solution.index,
        passed,
        kind: solution.kind(),
        off: off.fold(0.0, f64::max),
        differential: differential.iter().map(|d| d.0[0].abs()).fold(0.0, f64::max),
    })
}

/// A wave of this many half lengths, zero at both ends of a path.
fn wave(halves: usize, point: usize) -> f64 {
    (PI * (halves * point) as f64 / POINTS as f64).sin()
}

/// What bending an oscillator's motion by s times a wave adds to its action.
fn bent_action(duration: f64, halves: usize, s: f64) -> Result<f64, StudyError> {
    let stage = "the action of a bent path";
    let h = duration * PI / POINTS as f64;
    let path = motion(Spring, 1.0, h)?;
    let bent: Vec<[f64; 1]> =
        path.iter().enumerate().map(|(i, q)| [q[0] + s * wave(halves, i)]).collect();
    let action = Action::new(recipe(Spring)?, vec![h; POINTS]).map_err(StudyError::at(stage))?;
    let of = |path: &[[f64; 1]]| action.of(path).map_err(StudyError::at(stage));
    Ok(of(&bent)? - of(&path)?)
}

/// What theory says of it: `s^2 T/4 ((k pi/T)^2 - 1)` for k half waves over T seconds.
fn bent_action_in_theory(duration: f64, halves: usize, s: f64) -> f64 {
    let (time, k) = (duration * PI, halves as f64);
    0.25 * s * s * time * ((k * PI / time).powi(2) - 1.0)
}

/// The bends that the chart shows: half periods, half waves.
const BENDS: [(&str, f64, usize); 3] = [
    ("0.8 half periods, one half wave", 0.8, 1),
    ("1.5 half periods, one half wave", 1.5, 1),
    ("1.5 half periods, two half waves", 1.5, 2),
];

fn boundary_value() -> Result<Study, StudyError> {
    let swing = pendulum(2.0).map_err(StudyError::at("the pendulum"))?;
    let mut table = Table::new([
        Column::exact("motion"),
        Column::rounded("duration [half periods]", 2, 0.0),
        Column::exact("index"),
        Column::exact("conjugate points passed"),
        Column::exact("kind"),
        Column::rounded("distance from the motion", 2, 1e-7),
        Column::rounded("differential of the action", 2, 1e-7),
    ]);
    let mut index = Bars::new(
        "Ways to lower the action",
        "duration [half periods]",
        durations().map(|duration| significant(duration, 2)),
        Axis::linear("index", ""),
    );
    let mut claims = Vec::new();
    for (name, course) in [
        ("oscillator", course(Spring, 1.0, PI)?),
        ("wide pendulum", course(Rod, 2.0 * 1.0_f64.sin(), 0.5 * swing.period)?),
    ] {
        for found in &course {
            let kind = match found.kind {
                Stationary::Minimum => "minimum",
                Stationary::Saddle => "saddle",
                Stationary::Maximum => "maximum",
            };
            table.push([
                name.into(),
                found.duration.into(),
                (found.index as u64).into(),
                (found.passed as u64).into(),
                kind.into(),
                found.off.into(),
                found.differential.into(),
            ]);
        }
        index = index.with(BarSeries::new(name, course.iter().map(|found| found.index as f64)));
        claims.extend(claims_of(name, &course));
    }
    let mut bends = Lines::new(
        "Action around an oscillator's motion",
        Axis::linear("amplitude of the bend", "m"),
        Axis::linear("action added", "J s"),
    );
    for (name, duration, halves) in BENDS {
        let mut points = Vec::new();
        for i in -10..=10 {
            let s = 0.1 * f64::from(i);
            points.push((s, bent_action(duration, halves, s)?));
        }
        bends = bends.with(Series::new(name, points));
        let ratio =
            bent_action(duration, halves, 1.0)? / bent_action_in_theory(duration, halves, 1.0);
        let text = format!("action added over {name}, of what theory says");
        claims.push(Claim::number(text, "1", ratio, (0.999, 1.001)));
    }
    Ok(Study {
        conclusion: "Motions that start at the lowest point, found again from both of their ends. \
                     The action's differential is zero on each, but only a motion shorter than \
                     half a period is a minimum of it. At every point conjugate to the start, \
                     where motions of slightly different momentum meet again, one more way to \
                     bend the path lowers the action. A pendulum's neighbours swing more slowly \
                     the farther they swing, so they meet later than after half a period."
            .into(),
        table,
        charts: vec![index.into(), bends.into()],
        claims,
        ..BOUNDARY_VALUE.heading()
    })
}

/// Half periods.
fn durations() -> impl Iterator<Item = f64> {
    (0..20).map(|i| 0.1 + 0.2 * f64::from(i))
}

fn course<E: Energy<1> + Copy>(
    energy: E,
    momentum: f64,
    half_period: f64,
) -> Result<Vec<Found>, StudyError> {
    durations().map(|duration| found(energy, momentum, half_period, duration)).collect()
}

fn claims_of(name: &str, course: &[Found]) -> Vec<Claim> {
    let most = |of: fn(&Found) -> f64| course.iter().map(of).fold(0.0, f64::max);
    let agree = course.iter().all(|found| found.index == found.passed);
    let first = course.iter().find(|found| found.index > 0);
    let (expected, band) =
        if name == "oscillator" { ("1", (0.9, 1.1)) } else { ("more than 1", (1.1, 2.0)) };
    vec![
        Claim::words(
            format!("index of the {name}: the number of conjugate points passed"),
            "always",
            if agree { "always" } else { "not always" },
        ),
        Claim::number(
            format!("half periods of the {name} after which it is a saddle"),
            expected,
            first.map_or(f64::NAN, |found| found.duration),
            band,
        ),
        Claim::number(
            format!("differential of the action on the {name}'s motions"),
            "rounding",
            most(|found| found.differential),
            (0.0, 1e-10),
        ),
        Claim::number(
            format!("distance of the {name}'s motions from those of the integrator"),
            "rounding",
            most(|found| found.off),
            (0.0, 1e-8),
        ),
    ]
}
