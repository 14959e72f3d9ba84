//! The tennis racket: how long a body spins about its middle axis before it flips over.

use nalgebra::Vector3;
use stationary_chart::{Axis, Lines, Series};
use stationary_measure::{Cell, Column, Table};
use stationary_rigid::problems::thrown_racket;
use stationary_rigid::{BodyMethod, FreeTop, LieGroup, Rotation};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// The time between flips against how far the throw is off the axis.
pub const RACKET: Entry<'static> = Entry {
    id: "tennis-racket",
    krate: "rigid",
    chapter: "9.4",
    kind: Kind::Convergence,
    title: "Tennis racket: time to its flip against the disturbance",
    tested: Tested::Claims,
    run: &study,
};

/// The spin about the middle axis, rad/s.
const SPIN: f64 = 10.0;
/// The step, seconds.
const STEP: f64 = 2e-4;
/// Flips to take the mean of: the first comes after half the time.
const FLIPS: usize = 4;

/// The mean time between flips of an integration, seconds.
fn measured(method: BodyMethod, wobble: f64) -> Result<f64, StudyError> {
    let racket = thrown_racket().map_err(StudyError::at("the racket"))?;
    let name = method.facts().name;
    let mut integrator = method.integrator(&racket.system).map_err(StudyError::at(name))?;
    let mut state = racket.initial.clone();
    let moments = racket.body().moments();
    state.p.0.copy_from_slice(&[wobble * moments.x, SPIN * moments.y, 0.0]);
    let mut flips = Vec::new();
    for _ in 0..400_000 {
        let (before, t) = (state.p.0[1], state.t);
        integrator.step(&mut state, STEP).map_err(StudyError::at(name))?;
        let after = state.p.0[1];
        if before * after < 0.0 {
            // Between two steps the momentum is as good as linear.
            flips.push(t + STEP * before / (before - after));
        }
        if flips.len() > FLIPS {
            return Ok((flips[FLIPS] - flips[0]) / FLIPS as f64);
        }
    }
    Ok(f64::NAN)
}

fn study(_: Size) -> Result<Study, StudyError> {
    let racket = thrown_racket().map_err(StudyError::at("the racket"))?;
    let methods = [BodyMethod::VariationalRotation, BodyMethod::AxisRotations];
    let mut table = Table::new([
        Column::rounded("off the axis [rad/s]", 2, 0.0),
        Column::rounded("closed form [s]", 6, 0.0),
        Column::rounded("variational [s]", 4, 0.0),
        Column::rounded("axis rotations [s]", 4, 0.0),
    ]);
    let mut exact = Vec::new();
    let mut points = [Vec::new(), Vec::new()];
    let mut worst = 0.0_f64;
    for wobble in [1.0, 0.3, 0.1, 0.03, 0.01, 3e-3, 1e-3, 1e-4, 1e-5] {
        let w = Vector3::new(wobble, SPIN, 0.0);
        let top = FreeTop::new(*racket.body(), Rotation::identity(), w)
            .map_err(StudyError::at("the closed form"))?;
        let between = 0.5 * top.period().unwrap_or(f64::NAN);
        let mut row = vec![wobble, between];
        for (method, points) in methods.into_iter().zip(&mut points) {
            let time = measured(method, wobble)?;
            worst = worst.max((time / between - 1.0).abs());
            points.push((wobble, time));
            row.push(time);
        }
        exact.push((wobble, between));
        table.push(row.into_iter().map(Cell::from));
    }
    let [(_, late), (_, later)] = [exact[exact.len() - 2], exact[exact.len() - 1]];
    let moments = racket.body().moments();
    let rate =
        SPIN * ((moments.y - moments.x) * (moments.z - moments.y) / (moments.x * moments.z)).sqrt();
    let claims = vec![
        Claim::number(
            "the time gained by a throw that is ten times better, times the rate of growth",
            "2 ln 10 = 4.605",
            (later - late) * rate,
            (4.604, 4.606),
        ),
        Claim::number(
            "the largest error of an integrated time between flips",
            "below a thousandth",
            worst,
            (0.0, 1e-3),
        ),
    ];
    let mut chart =
        Lines::new("Flips", Axis::log("off the axis", "rad/s"), Axis::linear("time", "s"))
            .curve("closed form", exact);
    for (method, points) in methods.into_iter().zip(points) {
        chart = chart.with(Series::new(method.facts().name, points));
    }
    Ok(Study {
        conclusion: format!(
            "A racket of moments 1 : 6 : 7 spins at {SPIN} rad/s about its middle axis, nearly. What \
             it is off grows like exp(a t), with a = {rate:.2} per second for the linear equations, and \
             when it has grown up the racket flips: a throw ten times better gains 2 ln 10 / a. The \
             closed form says when, and steps of {:.1} ms follow it from flip to flip.",
            1e3 * STEP
        ),
        table,
        charts: vec![chart.into()],
        claims,
        ..RACKET.heading()
    })
}
