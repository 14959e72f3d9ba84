//! What implicit methods leave of an oscillation that their steps do not resolve.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, matrix};
use stationary_calculus::Covector;
use stationary_chart::{Axis, Lines, Series};
use stationary_integrators::problems::oscillator;
use stationary_integrators::{
    ImplicitEuler, Integrator, Newmark, NewmarkWeights, ParameterError, State, Trapezoid,
};
use stationary_measure::{Column, Table};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Spectral radius against h omega.
pub const STUDY: Entry<'static> = Entry {
    id: "newmark-damping",
    krate: "integrators",
    chapter: "4.5",
    kind: Kind::Limit,
    title: "Newmark's methods: what a step leaves of an oscillation, against its frequency",
    tested: Tested::Claims,
    run: &study,
};

/// A method, its name, and what theory leaves of an oscillation at h omega.
struct Candidate {
    name: String,
    weights: Option<NewmarkWeights>,
    predicted: Box<dyn Fn(f64) -> f64>,
}

/// The largest root in size of the characteristic equation of Newmark's family at `x = h omega`,
///
/// ```text
/// ((1 - am) l + am) (l - 1)^2
///   + x^2 ((1 - af) l + af) ((1 - g) + g l + ((1/2 - b) + b l) (l - 1)) = 0
/// ```
fn spectral_radius([am, af, b, g]: [f64; 4], x: f64) -> f64 {
    let multiply = |p: [f64; 2], q: [f64; 3]| {
        [p[0] * q[0], p[0] * q[1] + p[1] * q[0], p[0] * q[2] + p[1] * q[1], p[1] * q[2]]
    };
    let inertia = multiply([1.0 - am, am], [1.0, -2.0, 1.0]);
    let force = multiply([1.0 - af, af], [b, g + 0.5 - 2.0 * b, 0.5 - g + b]);
    let c: [f64; 4] = std::array::from_fn(|i| inertia[i] + x * x * force[i]);
    let companion: Matrix3<f64> = matrix![
        -c[1] / c[0], -c[2] / c[0], -c[3] / c[0];
        1.0, 0.0, 0.0;
        0.0, 1.0, 0.0
    ];
    companion.complex_eigenvalues().iter().map(|root| root.norm()).fold(0.0, f64::max)
}

fn candidates() -> Result<Vec<Candidate>, ParameterError> {
    let mut candidates = Vec::new();
    for radius in [0.0, 0.5, 0.8] {
        let (am, af) = ((2.0 * radius - 1.0) / (radius + 1.0), radius / (radius + 1.0));
        let (b, g) = (0.25 * (1.0 - am + af) * (1.0 - am + af), 0.5 - am + af);
        candidates.push(Candidate {
            name: format!("generalized-alpha, r = {radius}"),
            weights: Some(NewmarkWeights::generalized_alpha(radius)?),
            predicted: Box::new(move |x| spectral_radius([am, af, b, g], x)),
        });
    }
    for (b, g) in [(0.25, 0.5), (0.3025, 0.6)] {
        candidates.push(Candidate {
            name: format!("newmark, β = {b}, γ = {g}"),
            weights: Some(NewmarkWeights::newmark(b, g)?),
            predicted: Box::new(move |x| spectral_radius([0.0, 0.0, b, g], x)),
        });
    }
    candidates.push(Candidate {
        name: "implicit-euler".into(),
        weights: None,
        predicted: Box::new(|x| (1.0 + x * x).sqrt().recip()),
    });
    Ok(candidates)
}

/// Methods that leave less than this a step: after 120 steps it underflows.
const LEAST: f64 = 0.03;

/// The sizes `|(q, p)|` of an oscillation of angular frequency 1 after each step, and q itself.
fn motion(
    weights: Option<NewmarkWeights>,
    h: f64,
    steps: usize,
) -> Result<Vec<[f64; 2]>, StudyError> {
    let spring = oscillator(1.0).map_err(StudyError::at("the oscillator"))?;
    let mut method: Box<dyn Integrator<[f64; 1]> + '_> = match weights {
        Some(weights) => {
            Box::new(Newmark::new(&spring.system, weights).map_err(StudyError::at("newmark"))?)
        }
        None => Box::new(ImplicitEuler::new(&spring.system).map_err(StudyError::at("euler"))?),
    };
    let mut state = State::new([1.0], Covector([0.0]));
    let mut sizes = Vec::new();
    for _ in 0..steps {
        method.step(&mut state, h).map_err(StudyError::at("a step"))?;
        sizes.push([state.q[0].hypot(state.p.0[0]), state.q[0]]);
    }
    Ok(sizes)
}

/// What a step leaves, from the largest size in two windows 60 steps apart.
fn measured(weights: Option<NewmarkWeights>, h: f64) -> Result<f64, StudyError> {
    let sizes = motion(weights, h, 120)?;
    let largest = |window: &[[f64; 2]]| window.iter().map(|size| size[0]).fold(0.0, f64::max);
    Ok((largest(&sizes[100..]) / largest(&sizes[40..60])).powf(1.0 / 60.0))
}

fn study(size: Size) -> Result<Study, StudyError> {
    let count = match size {
        Size::Default => 31,
        Size::Full => 121,
    };
    let mut table = Table::new([
        Column::exact("method"),
        Column::rounded("h omega", 3, 0.0),
        Column::rounded("predicted", 3, 1e-3),
        Column::rounded("measured", 2, 1e-3),
    ]);
    let axes = (Axis::log("h ω", ""), Axis::linear("left of an oscillation after a step", ""));
    let mut chart = Lines::new("Predicted (lines) and measured (points)", axes.0, axes.1);
    let mut claims = Vec::new();
    for Candidate { name, weights, predicted } in
        candidates().map_err(StudyError::at("the weights"))?
    {
        let (mut points, mut apart) = (Vec::new(), 0.0_f64);
        for i in 0..count {
            let h = 10_f64.powf(-1.0 + 3.0 * f64::from(i) / f64::from(count - 1));
            let (predicted, measured) = (predicted(h), measured(weights, h)?);
            if predicted > LEAST && measured.is_finite() {
                apart = apart.max((measured - predicted).abs());
                points.push((h, measured));
            }
            table.push([name.as_str().into(), h.into(), predicted.into(), measured.into()]);
        }
        let curve = (0..200).map(|i| 10_f64.powf(-1.0 + 3.0 * f64::from(i) / 199.0));
        chart = chart.curve("", curve.map(|h| (h, predicted(h))));
        chart = chart.with(Series::new(&name, points));
        let text = format!("{name}: measured from predicted, where they differ most");
        claims.push(Claim::number(text, "0, to what 60 steps tell", apart, (0.0, 0.03)));
    }
    let (ringing, chart_of_ringing) = ringing(&mut claims)?;
    claims.push(Claim::number(
        "implicit-euler at 63 steps a period: left of the amplitude after one period",
        "exp(-π/10) = 0.730",
        motion(None, TAU / 63.0, 63)?.last().map_or(f64::NAN, |last| last[0]),
        (0.72, 0.74),
    ));
    for row in ringing {
        table.push(row);
    }
    Ok(Study {
        conclusion: "The part of an undamped oscillation that is left after each step. \
                     Generalized alpha leaves slow oscillations alone and takes the fast ones \
                     down to the radius that it is given; Newmark's own damping does so at the \
                     price of an order; implicit Euler takes from all. The average \
                     acceleration, which is the trapezoid rule, takes nothing: let go of a \
                     spring that the step does not resolve, and it rings from step to step for \
                     ever."
            .into(),
        table,
        charts: vec![chart.into(), chart_of_ringing.into()],
        claims,
        ..STUDY.heading()
    })
}

/// A spring let go at q = 1 with h omega = 100: what rings on.
fn ringing(
    claims: &mut Vec<Claim>,
) -> Result<(Vec<Vec<stationary_measure::Cell>>, Lines), StudyError> {
    let title = "A spring let go, h ω = 100";
    let mut chart = Lines::new(title, Axis::linear("step", ""), Axis::linear("q", "m"));
    let half = NewmarkWeights::generalized_alpha(0.5).map_err(StudyError::at("the weights"))?;
    let trapezoid = NewmarkWeights::AVERAGE_ACCELERATION;
    let named = [
        ("trapezoid", Some(trapezoid), "1: it rings", (0.99, 1.001)),
        ("generalized-alpha, r = 0.5", Some(half), "gone", (0.0, 1e-4)),
        ("implicit-euler", None, "gone", (0.0, 1e-4)),
    ];
    let mut rows = Vec::new();
    for (name, weights, expected, band) in named {
        let course = motion(weights, 100.0, 30)?;
        let points = course.iter().enumerate().map(|(step, size)| (step as f64 + 1.0, size[1]));
        chart = chart.with(Series::new(name, points));
        let left = course.last().map_or(f64::NAN, |size| size[0]);
        let text = format!("{name} at h ω = 100: left of the amplitude after 30 steps");
        claims.push(Claim::number(text, expected, left, band));
        rows.push(vec![
            format!("{name}, left of the amplitude after 30 steps").into(),
            100.0.into(),
            "".into(),
            left.into(),
        ]);
    }
    // The average acceleration is the trapezoid rule: the same q, to rounding.
    let spring = oscillator(1.0).map_err(StudyError::at("the oscillator"))?;
    let mut rule = Trapezoid::new(&spring.system).map_err(StudyError::at("the trapezoid rule"))?;
    let mut state = State::new([1.0], Covector([0.0]));
    let mut apart = 0.0_f64;
    for size in motion(Some(trapezoid), 100.0, 30)? {
        rule.step(&mut state, 100.0).map_err(StudyError::at("a step"))?;
        apart = apart.max((state.q[0] - size[1]).abs());
    }
    let text = "newmark, average acceleration, from the trapezoid rule";
    claims.push(Claim::number(text, "rounding", apart, (0.0, 1e-10)));
    Ok((rows, chart))
}
