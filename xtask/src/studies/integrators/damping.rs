//! Step against damping: where each way to step a damped oscillator keeps it bounded.
//!
//! ```text
//! q.. = -w^2 q - c q.,      roots s of s^2 + c s + w^2 = 0       w = 1/s
//! ```

use nalgebra::Complex;
use stationary_calculus::{Covector, Energy, Number};
use stationary_chart::{Axis, Map};
use stationary_integrators::problems::oscillator;
use stationary_integrators::{
    AdaptiveMethod, DormandPrince853, Drag, Integrator, Mechanical, MechanicalField, Moment,
    Newmark, NewmarkWeights, Quadrature, RadauIia5, Sampled, State, StepControl, Tolerance,
    Variational,
};
use stationary_measure::{Column, Table};

use super::stability_regions::dormand_prince_growth;
use crate::studies::spaced::spaced;
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// The damped oscillator.
pub const STUDY: Entry<'static> = Entry {
    id: "damping-stability",
    krate: "integrators",
    chapter: "10.1",
    kind: Kind::StabilityMap,
    title: "Oscillator with drag: which steps are stable, against damping",
    tested: Tested::Claims,
    run: &study,
};

const SURVIVES: &str = "stays bounded";
const BLOWS_UP: &str = "blows up";

/// Steps taken: enough for a growth of 5 % a step to show.
const STEPS: u32 = 200;
/// A state that has grown by this factor has blown up.
const GROWN: f64 = 1e3;

/// A unit mass on a spring of stiffness 1.
#[derive(Clone, Copy, Debug)]
struct Spring;

impl Energy<1> for Spring {
    fn energy<R: Number>(&self, [q]: [R; 1]) -> R {
        q * q * 0.5
    }
}

/// A way to step with drag.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    Variational,
    Newmark,
    DormandPrince,
    Radau,
}

const WAYS: [Way; 4] = [Way::Variational, Way::DormandPrince, Way::Newmark, Way::Radau];

impl Way {
    fn name(self) -> &'static str {
        match self {
            Way::Variational => "stormer-verlet, drag on the step's mean velocity",
            Way::Newmark => "newmark",
            Way::DormandPrince => "dormand-prince-853, equal steps",
            Way::Radau => "radau-iia-5, equal steps",
        }
    }

    /// Whether theory keeps the motion bounded; `None` too near to the border to tell.
    fn predicted(self, h: f64, c: f64) -> Option<bool> {
        match self {
            Way::Variational => told(variational_growth(h, c)),
            Way::DormandPrince => told(explicit_growth(h, c)),
            Way::Newmark | Way::Radau => Some(true),
        }
    }

    fn outcome(self, h: f64, c: f64) -> Result<&'static str, StudyError> {
        let problem = oscillator(1.0).map_err(StudyError::at("the oscillator"))?;
        let drag = Drag::new([c]).map_err(StudyError::at("the drag"))?;
        let start = State::new([1.0], Covector([0.3]));
        let system = &problem.system;
        let stays = match self {
            Way::Variational => {
                let spring = Mechanical::new([1.0], Spring).map_err(StudyError::at("a mass"))?;
                let lagrangian = Sampled { lagrangian: spring, quadrature: Quadrature::Ends };
                let integrator = Variational::forced(lagrangian, drag);
                stays(integrator.map_err(StudyError::at(self.name()))?, start, h)
            }
            Way::Newmark => {
                let weights = NewmarkWeights::AVERAGE_ACCELERATION;
                let integrator = Newmark::with_force(system, weights, drag);
                stays(integrator.map_err(StudyError::at(self.name()))?, start, h)
            }
            Way::DormandPrince | Way::Radau => {
                let field = MechanicalField::forced(system, drag);
                let field = field.map_err(StudyError::at("the field"))?;
                let control = Tolerance::new(1e-8, 1e-8).map(StepControl::from);
                let control = control.and_then(|control| control.constant_step(h));
                let control = control.map_err(StudyError::at("a step"))?;
                let moment = Moment::new(0.0, [1.0, 0.3]);
                let method: Box<dyn AdaptiveMethod<[f64; 2]>> = match self {
                    Way::Radau => Box::new(
                        RadauIia5::new(field, control, moment).map_err(StudyError::at("radau"))?,
                    ),
                    _ => Box::new(
                        DormandPrince853::new(field, control, moment)
                            .map_err(StudyError::at("dormand-prince"))?,
                    ),
                };
                stays_at_equal_steps(method, h)
            }
        };
        Ok(if stays { SURVIVES } else { BLOWS_UP })
    }
}

/// What growth in a step shows in as many steps, and no slower one.
fn told(growth: f64) -> Option<bool> {
    ((growth - 1.0).abs() > 0.05).then_some(growth < 1.0)
}

/// The largest root of `(1 + hc/2) z^2 - (2 - h^2) z + (1 - hc/2) = 0`, the centred difference of
/// the equation of motion. Both are inside the unit circle for h w < 2, and close to it otherwise
/// where drag is strong.
fn variational_growth(h: f64, c: f64) -> f64 {
    let (middle, last) = (2.0 - h * h, 1.0 - 0.5 * h * c);
    let first = 1.0 + 0.5 * h * c;
    let root = Complex::from(middle * middle - 4.0 * first * last).sqrt();
    [root, -root]
        .map(|root| ((root + middle) / (2.0 * first)).norm())
        .into_iter()
        .fold(0.0, f64::max)
}

/// The growth in a step of the faster of the oscillator's two roots.
fn explicit_growth(h: f64, c: f64) -> f64 {
    let root = (Complex::from(0.25 * c * c - 1.0)).sqrt();
    let roots = [Complex::from(-0.5 * c) + root, Complex::from(-0.5 * c) - root];
    roots.map(|s| dormand_prince_growth(s * h)).into_iter().fold(0.0, f64::max)
}

fn stays(mut integrator: impl Integrator<[f64; 1]>, mut state: State<[f64; 1]>, h: f64) -> bool {
    (0..STEPS).all(|_| {
        integrator.step(&mut state, h).is_ok() && state.q[0].hypot(state.p.components()[0]) < GROWN
    })
}

fn stays_at_equal_steps(mut method: Box<dyn AdaptiveMethod<[f64; 2]> + '_>, h: f64) -> bool {
    let end = h * f64::from(STEPS);
    (0..STEPS - 1).all(|_| {
        let stepped = method.step(end).is_ok();
        let [q, p] = method.moment().y;
        stepped && q.hypot(p) < GROWN
    })
}

/// The step at which the explicit method's growth passes 1, for a drag.
fn explicit_border(c: f64) -> f64 {
    let (mut low, mut high) = (1e-6_f64, 1e2_f64);
    for _ in 0..60 {
        let middle = (low * high).sqrt();
        if explicit_growth(middle, c) <= 1.0 { low = middle } else { high = middle }
    }
    high
}

fn study(size: Size) -> Result<Study, StudyError> {
    let count = match size {
        Size::Default => 25,
        Size::Full => 61,
    };
    let mut table = Table::new([
        Column::exact("method"),
        Column::rounded("step [s]", 3, 0.0),
        Column::rounded("drag [kg/s]", 3, 0.0),
        Column::exact("outcome"),
    ]);
    let (mut charts, mut claims) = (Vec::new(), Vec::new());
    for way in WAYS {
        let axes = (Axis::log("step", "s"), Axis::log("drag", "kg/s"));
        let mut map = Map::new(way.name(), axes.0, axes.1, [SURVIVES, BLOWS_UP]);
        let (mut agree, mut cells) = (0_u32, 0_u32);
        for c in spaced(1e-2, 1e3, count) {
            for h in spaced(1e-3, 1e1, count) {
                let outcome = way.outcome(h, c)?;
                map.cell(h, c, outcome);
                table.push([way.name().into(), h.into(), c.into(), outcome.into()]);
                if let Some(predicted) = way.predicted(h, c) {
                    cells += 1;
                    agree += u32::from(predicted == (outcome == SURVIVES));
                }
            }
        }
        map = match way {
            Way::Variational => map.border("h ω = 2", spaced(1e-2, 1e3, 2).map(|c| (2.0, c))),
            Way::DormandPrince => {
                map.border("|R| = 1", spaced(1e-2, 1e3, 120).map(|c| (explicit_border(c), c)))
            }
            Way::Newmark | Way::Radau => map,
        };
        claims.push(Claim::number(
            format!("part of the map on which {} does as predicted", way.name()),
            "1",
            f64::from(agree) / f64::from(cells),
            (1.0, 1.0),
        ));
        charts.push(map.into());
    }
    Ok(Study {
        conclusion: format!(
            "A unit mass on a spring of 1 N/m with drag, {STEPS} steps. Where drag enters by the \
             discrete principle, on the mean velocity of the step, the border of Störmer-Verlet stays \
             at h ω = 2 however strong it is; beyond, strong drag only slows the growth. The price is an equation in each step. A method that is \
             explicit in the drag as well must resolve it: beyond c = 2 kg/s its step shrinks as \
             6/c. Newmark's method and Radau IIA survive every step; only Radau also forgets at once \
             what drag has damped."
        ),
        table,
        charts,
        claims,
        ..STUDY.heading()
    })
}
