//! Which steps explicit heat survives.

use std::f64::consts::PI;

use stationary_calculus::{Metric, Vector};
use stationary_chart::{Axis, Lines, Map, Series};
use stationary_laplacian::problems::interval;
use stationary_laplacian::{Heat, HeatMethod, LaplacianError, largest_eigenvalue};
use stationary_measure::{Column, SplitMix64, Table, loglog_slope};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Step against mesh size.
pub const STUDY: Entry<'static> = Entry {
    id: "heat-border",
    krate: "laplacian",
    chapter: "15.3",
    kind: Kind::Limit,
    title: "Explicit heat: which steps are stable, against mesh size",
    tested: Tested::Claims,
    run: &study,
};

const ALPHA: f64 = 0.5;
const STEPS: usize = 600;
const SURVIVES: &str = "survives";
const BLOWS_UP: &str = "blows up";

/// Whether a random function grows, on an interval of n segments.
fn grows(n: usize, method: HeatMethod, h: f64) -> Result<bool, LaplacianError> {
    let problem = interval(n)?;
    let metric = problem.domain.lumped()?;
    let mut heat = Heat::new(&metric, problem.domain.dirichlet(), method, ALPHA, h)?;
    let mut random = SplitMix64::new(n as u64);
    let mut f: Vec<f64> = (0..=n).map(|_| random.symmetric()).collect();
    for _ in 0..STEPS {
        if heat.step(&mut f).is_err() {
            return Ok(true);
        }
    }
    Ok(f.iter().any(|x| x.abs() > 2.0))
}

fn predicted(n: usize) -> Result<f64, LaplacianError> {
    let problem = interval(n)?;
    let largest = largest_eigenvalue(&problem.domain.lumped()?, problem.domain.dirichlet())?;
    Ok(2.0 / (ALPHA * largest))
}

/// The border between steps that decay and steps that grow, by bisection.
fn measured(n: usize, near: f64) -> Result<f64, LaplacianError> {
    let (mut low, mut high) = (0.5 * near, 2.0 * near);
    for _ in 0..12 {
        let middle = (low * high).sqrt();
        *(if grows(n, HeatMethod::ExplicitEuler, middle)? { &mut high } else { &mut low }) = middle;
    }
    Ok((low * high).sqrt())
}

/// Segments, steps, and parts of the border at which one mode is followed.
const FOLLOWED: usize = 32;
const FOLLOWED_STEPS: u32 = 500;
const PARTS: [f64; 2] = [0.95, 1.05];
/// What cannot be told from nothing.
const NOTHING: f64 = 1e-20;

/// How much of the fastest mode there is after each step, in heat that starts as the slowest mode, of
/// which the fastest is no part.
fn fastest(part: f64) -> Result<Vec<(f64, f64)>, LaplacianError> {
    let n = FOLLOWED;
    let problem = interval(n)?;
    let metric = problem.domain.lumped()?;
    let h = part * predicted(n)?;
    let method = HeatMethod::ExplicitEuler;
    let mut heat = Heat::new(&metric, problem.domain.dirichlet(), method, ALPHA, h)?;
    let mut f: Vec<f64> = (0..=n).map(|k| (PI * k as f64 / n as f64).cos()).collect();
    let zigzag: Vec<f64> = (0..=n).map(|k| if k % 2 == 0 { 1.0 } else { -1.0 }).collect();
    let mut content = Vec::new();
    for step in 1..=FOLLOWED_STEPS {
        heat.step(&mut f)?;
        let there = metric.inner(Vector(&zigzag), Vector(&f)).abs();
        content.push((f64::from(step), there.max(NOTHING)));
    }
    Ok(content)
}

fn study(size: Size) -> Result<Study, StudyError> {
    let (sizes, steps): (&[usize], i32) = match size {
        Size::Default => (&[4, 6, 8, 11, 16, 23, 32, 45, 64], 24),
        Size::Full => (&[4, 6, 8, 11, 16, 23, 32, 45, 64, 91, 128, 181, 256], 60),
    };
    let mut table = Table::new([
        Column::exact("segments"),
        Column::rounded("border, 2 / (alpha lambda)", 4, 0.0),
        Column::rounded("border, measured", 4, 0.0),
    ]);
    let axes = (Axis::log("mesh size", "m"), Axis::log("step", "s"));
    let mut map = Map::new("Which steps survive", axes.0, axes.1, [SURVIVES, BLOWS_UP]);
    let (mut borders, mut worst, mut implicit_grew) = (Vec::new(), 0.0_f64, 0_u32);
    for &n in sizes {
        let h = 1.0 / n as f64;
        let border = predicted(n).map_err(StudyError::at("the largest eigenvalue"))?;
        let found = measured(n, border).map_err(StudyError::at("the border"))?;
        worst = worst.max((found / border - 1.0).abs());
        borders.push((h, border));
        table.push([(n as u64).into(), border.into(), found.into()]);
        for k in 0..=steps {
            let step = 1e-4 * 1e3_f64.powf(f64::from(k) / f64::from(steps));
            let blown =
                grows(n, HeatMethod::ExplicitEuler, step).map_err(StudyError::at("heat"))?;
            map.cell(h, step, if blown { BLOWS_UP } else { SURVIVES });
            let implicit =
                grows(n, HeatMethod::ImplicitEuler, step).map_err(StudyError::at("heat"))?;
            implicit_grew += u32::from(implicit);
        }
    }
    let mut growth = Lines::new(
        "The fastest mode in heat that starts without it",
        Axis::linear("steps", ""),
        Axis::log("amplitude of the fastest mode", ""),
    );
    let mut followed = Vec::new();
    for part in PARTS {
        let content = fastest(part).map_err(StudyError::at("the fastest mode"))?;
        growth = growth.with(Series::new(
            &format!("step {part} of the border"),
            content.iter().copied().filter(|point| point.1 > NOTHING),
        ));
        followed.push(content);
    }
    let quiet = followed[0].iter().map(|point| point.1).fold(0.0, f64::max);
    let first = |size: f64| followed[1].iter().find(|point| point.1 > size).copied();
    let (from, seen) = (first(1e-12), first(1.0));
    let factor = match (from, seen) {
        (Some(a), Some(b)) => (b.1 / a.1).powf(1.0 / (b.0 - a.0)),
        _ => f64::NAN,
    };
    let slope = loglog_slope(&borders).unwrap_or(f64::NAN);
    Ok(Study {
        conclusion: format!(
            "Explicit heat of diffusivity {ALPHA} m^2/s on the unit interval, {STEPS} steps from \
             random values. The border is 2 / (alpha lambda) for the largest eigenvalue, the \
             square of the mesh size over 2 alpha: half the mesh size costs a quarter of the step. \
             Implicit Euler survives every step on this map. Beyond the border nothing helps that \
             the start has no part in the fastest mode: rounding brings it in, and a step of {} \
             times the border multiplies it until it is all there is, after {} steps.",
            PARTS[1],
            seen.map_or(f64::NAN, |point| point.0)
        ),
        table,
        charts: vec![map.border("2 / (alpha lambda)", borders).into(), growth.into()],
        claims: vec![
            Claim::number(
                "the measured border is off from the predicted one by at most a part of",
                "below 1 %",
                worst,
                (0.0, 0.01),
            ),
            Claim::number(
                "the border falls with the mesh size to a power",
                "2",
                slope,
                (1.99, 2.01),
            ),
            Claim::number(
                "steps at which implicit heat grew",
                "0",
                f64::from(implicit_grew),
                (0.0, 0.0),
            ),
            Claim::number(
                "below the border the fastest mode, which is not there at first, stays below",
                "1e-14",
                quiet,
                (0.0, 1e-14),
            ),
            Claim::number(
                "beyond it, it grows from rounding by a factor a step",
                "|1 - 2 * 1.05| = 1.1",
                factor,
                (1.099, 1.101),
            ),
        ],
        ..STUDY.heading()
    })
}
