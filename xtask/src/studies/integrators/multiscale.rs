//! A stiff and a soft motion that are coupled: which steps survive, and where they resonate.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use nalgebra::dmatrix;
use stationary_calculus::{BilinearForm, Covector, DiagonalMetric, Potential, Sink, System};
use stationary_chart::{Axis, Map};
use stationary_integrators::{Filter, Gautschi, Imex, Integrator, State, StormerVerlet};
use stationary_measure::{Column, Table};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Step against frequency ratio.
pub const STUDY: Entry<'static> = Entry {
    id: "multiscale-stability",
    krate: "integrators",
    chapter: "4.5",
    kind: Kind::StabilityMap,
    title: "Fast springs in long steps: which are stable, against step and frequency ratio",
    tested: Tested::ByReport,
    run: &study,
};

/// Two unit masses: `k/2 y^2` on the second alone, `1/2 x^2 + 1/2 (x - y)^2` on both.
#[derive(Clone, Copy)]
struct Springs {
    stiff: f64,
    soft: f64,
}

impl Springs {
    /// The matrix by columns.
    fn matrix(self) -> [f64; 4] {
        let Springs { stiff, soft } = self;
        [2.0 * soft, -soft, -soft, soft + stiff]
    }
}

impl Potential for Springs {
    fn dim(&self) -> usize {
        2
    }

    fn energy(&self, q: &[f64]) -> f64 {
        let [a, b, _, d] = self.matrix();
        0.5 * (a * q[0] * q[0] + d * q[1] * q[1]) + b * q[0] * q[1]
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let [a, b, c, d] = self.matrix();
        dv.0[0] += a * q[0] + c * q[1];
        dv.0[1] += b * q[0] + d * q[1];
    }

    fn add_hessian(&self, _: &[f64], hessian: &mut impl Sink) {
        hessian.add_symmetric(&[0, 1], &self.matrix());
    }
}

/// The schemes, and the resonances at which a growing motion is expected.
const SCHEMES: [(&str, &str); 6] = [
    ("stormer-verlet", ""),
    ("imex", "none"),
    ("impulse", "h (ω + μ) = 2π, h (ω + μ) = 4π, h ω = 1π, h ω = 2π, h ω = 3π"),
    ("gautschi", "h ω = 1π, h ω = 3π"),
    ("mollified-impulse", "h (ω + μ) = 2π, h (ω + μ) = 4π"),
    ("hairer-lubich", "none"),
];

/// The angular frequency of the soft springs where the stiff one holds still.
const SOFT: f64 = std::f64::consts::SQRT_2;

/// The resonance that a growing motion at `x = h w/pi` belongs to: they lie within 1/w and 2/w of
/// theirs.
fn resonance(x: f64, w: f64) -> Option<String> {
    let own = x.round();
    let sum = 0.5 * x * (w + SOFT) / w;
    if (x - own).abs() * w < 1.0 {
        Some(format!("h ω = {own}π"))
    } else if (sum - sum.round()).abs() * 2.0 * w < 2.0 {
        Some(format!("h (ω + μ) = {}π", 2.0 * sum.round()))
    } else {
        None
    }
}

const SURVIVES: &str = "survives";
const BLOWS_UP: &str = "blows up";

/// Steps taken: enough for a growth of one percent a step to show.
const STEPS: usize = 1200;

/// Whether the steps at angular frequency `w` keep the energy within a factor of a million.
fn survives(scheme: &str, w: f64, h: f64) -> Result<bool, StudyError> {
    let metric = || DiagonalMetric::new([1.0; 2]).map_err(StudyError::at("the masses"));
    let system = |springs| System::new(metric()?, springs).map_err(StudyError::at("the springs"));
    let both = system(Springs { stiff: w * w, soft: 1.0 })?;
    let stiff = system(Springs { stiff: w * w, soft: 0.0 })?;
    let soft = system(Springs { stiff: 0.0, soft: 1.0 })?;
    let stiffness = BilinearForm(dmatrix![0.0, 0.0; 0.0, w * w]);
    let trigonometric = |filter| {
        Gautschi::new(&soft, &stiffness, filter).map_err(StudyError::at("the trigonometric method"))
    };
    let mut method: Box<dyn Integrator<[f64; 2]> + '_> = match scheme {
        "imex" => Box::new(
            Imex::new(&stiff, Springs { stiff: 0.0, soft: 1.0 }).map_err(StudyError::at("imex"))?,
        ),
        "impulse" => Box::new(trigonometric(Filter::Impulse)?),
        "gautschi" => Box::new(trigonometric(Filter::Gautschi)?),
        "mollified-impulse" => Box::new(trigonometric(Filter::Mollified)?),
        "hairer-lubich" => Box::new(trigonometric(Filter::Long)?),
        _ => Box::new(StormerVerlet::new(&both).map_err(StudyError::at("Stormer-Verlet"))?),
    };
    let mut state = State::new([1.0, 1.0 / w], Covector([0.3, 0.7]));
    let energy = |state: &State<[f64; 2]>| both.energy(&state.q, state.p.view());
    let start = energy(&state);
    for _ in 0..STEPS {
        if method.step(&mut state, h).is_err() || energy(&state) > 1e6 * start {
            return Ok(false);
        }
    }
    Ok(true)
}

fn study(size: Size) -> Result<Study, StudyError> {
    let (columns, rows) = match size {
        Size::Default => (560, 4),
        Size::Full => (1120, 16),
    };
    let mut table = Table::new([
        Column::exact("scheme"),
        Column::rounded("h w/pi", 3, 0.0),
        Column::rounded("frequency ratio", 3, 0.0),
        Column::exact("outcome"),
    ]);
    let (mut charts, mut claims) = (Vec::new(), Vec::new());
    for (scheme, resonances) in SCHEMES {
        let axes = (Axis::linear("h ω/π", ""), Axis::log("frequency ratio ω", ""));
        let mut map = Map::new(scheme, axes.0, axes.1, [SURVIVES, BLOWS_UP]);
        let (mut seen, mut astray, mut wrong) = (BTreeSet::new(), 0_u32, 0_u32);
        for row in 0..rows {
            let w = 10.0 * 4_f64.powf(f64::from(row) / f64::from(rows - 1));
            for column in 1..=columns {
                let x = 3.5 * f64::from(column) / f64::from(columns);
                let h = x * PI / w;
                let outcome = survives(scheme, w, h)?;
                map.cell(x, w, if outcome { SURVIVES } else { BLOWS_UP });
                let word = if outcome { SURVIVES } else { BLOWS_UP };
                table.push([scheme.into(), x.into(), w.into(), word.into()]);
                if scheme == "stormer-verlet" {
                    // The largest frequency of both potentials, to first order in 1/w^2.
                    let fastest = h * (w * w + 1.0).sqrt();
                    wrong +=
                        u32::from((fastest / 2.0 - 1.0).abs() > 0.02 && outcome != (fastest < 2.0));
                } else if !outcome {
                    match resonance(x, w) {
                        Some(name) => {
                            seen.insert(name);
                        }
                        None => astray += 1,
                    }
                }
            }
        }
        if scheme == "stormer-verlet" {
            let text = "cells where stormer-verlet does not end at h ω = 2";
            claims.push(Claim::number(text, "none", f64::from(wrong), (0.0, 0.0)));
        } else {
            let names: Vec<String> = seen.into_iter().collect();
            let seen = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            claims.push(Claim::words(format!("resonances of {scheme}"), resonances, seen));
            let text = format!("cells away from a resonance where {scheme} blows up");
            claims.push(Claim::number(text, "none", f64::from(astray), (0.0, 0.0)));
        }
        charts.push(map.into());
    }
    Ok(Study {
        conclusion: "A stiff spring of angular frequency ω coupled to soft ones of frequency \
                     about 1, 1200 steps. Störmer-Verlet ends at h ω = 2. The trigonometric \
                     methods take steps that are longer than the fast oscillation, but a kick \
                     without a filter pushes the spring in step with it where h ω is a multiple \
                     of π, and more strongly where the sum with the soft frequency, h (ω + μ), \
                     is one of 2π; Gautschi's filter leaves the odd multiples; the mollified \
                     kick vanishes at all of them, and leaves narrow bands of the sum. The \
                     implicit midpoint rule for the stiff spring never turns it by half a turn, \
                     and has no resonance at all."
            .into(),
        table,
        charts,
        claims,
        ..STUDY.heading()
    })
}
