//! Step against stiffness: where each method survives, where it should, and where it should but
//! does not.

use stationary_calculus::{Covector, Metric, Potential};
use stationary_chart::{Axis, Map};
use stationary_integrators::problems::{Problem, oscillator, spring_pendulum};
use stationary_integrators::{Method, Stability, State};
use stationary_measure::{Column, Table};

use crate::studies::spaced::spaced;
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// The linear oscillator.
pub const OSCILLATOR: Entry<'static> = Entry {
    id: "oscillator-stability",
    krate: "integrators",
    chapter: "4.5",
    kind: Kind::StabilityMap,
    title: "Oscillator: which steps are stable, against stiffness",
    tested: Tested::Claims,
    run: &linear,
};

/// The spring that also swings.
pub const SPRING_PENDULUM: Entry<'static> = Entry {
    id: "spring-pendulum-stability",
    krate: "integrators",
    chapter: "4.5",
    kind: Kind::StabilityMap,
    title: "Stiff spring that swings: which implicit steps are stable, against stiffness",
    tested: Tested::Claims,
    run: &nonlinear,
};

/// The methods whose maps differ; the others are in the table and the claims.
const CHARTED: [Method; 4] =
    [Method::StormerVerlet, Method::RungeKutta4, Method::ExplicitEuler, Method::ImplicitEuler];

/// What becomes of a motion.
const SURVIVES: &str = "survives";
const FADES: &str = "fades away";
const BLOWS_UP: &str = "blows up";
const NO_SOLUTION: &str = "no solution found";

/// Steps taken: enough for a growth of 2 % a step to show.
const STEPS: usize = 400;

/// Runs a problem and says what became of its energy, counted from its lowest possible value.
fn outcome<M: Metric, P: Potential, const N: usize>(
    problem: &Problem<M, P, [f64; N]>,
    start: &State<[f64; N]>,
    lowest: f64,
    method: Method,
    h: f64,
) -> Result<&'static str, StudyError> {
    let mut integrator =
        method.integrator(&problem.system).map_err(StudyError::at(method.facts().name))?;
    let mut state = start.clone();
    let energy = problem.energy(&state) - lowest;
    for _ in 0..STEPS {
        if integrator.step(&mut state, h).is_err() {
            return Ok(NO_SOLUTION);
        }
        let now = problem.energy(&state) - lowest;
        // A stable symplectic method may multiply the energy near its limit, but not without bound.
        if now.is_nan() || now > 1e4 * energy {
            return Ok(BLOWS_UP);
        }
    }
    let left = (problem.energy(&state) - lowest) / energy;
    Ok(if left < 1e-3 { FADES } else { SURVIVES })
}

fn linear(size: Size) -> Result<Study, StudyError> {
    let count = match size {
        Size::Default => 25,
        Size::Full => 61,
    };
    let mut table = Table::new([
        Column::exact("method"),
        Column::rounded("step [s]", 3, 0.0),
        Column::rounded("stiffness [N/m]", 3, 0.0),
        Column::exact("outcome"),
    ]);
    let (mut charts, mut claims) = (Vec::new(), Vec::new());
    for method in Method::TABLE_4_1 {
        let facts = method.facts();
        let axes = (Axis::log("step", "s"), Axis::log("stiffness", "N/m"));
        let mut map =
            Map::new(facts.name, axes.0, axes.1, [SURVIVES, FADES, BLOWS_UP, NO_SOLUTION]);
        let (mut agree, mut cells) = (0_u32, 0_u32);
        for k in spaced(1.0, 1e6, count) {
            let problem = oscillator(k.sqrt()).map_err(StudyError::at("the oscillator"))?;
            for h in spaced(1e-3, 1.0, count) {
                // In general position: no coincidence of the start hides a growing mode.
                let start = State::new([1.0], Covector([0.3 * k.sqrt()]));
                let outcome = outcome(&problem, &start, 0.0, method, h)?;
                map.cell(h, k, outcome);
                table.push([facts.name.into(), h.into(), k.into(), outcome.into()]);
                let h_omega = h * k.sqrt();
                let predicted = match facts.stability {
                    Stability::Below(limit) => Some(h_omega < limit),
                    Stability::Always => Some(true),
                    // It grows at each step, but where h omega is small too slowly to be seen.
                    Stability::Never => (h_omega > 0.2).then_some(false),
                };
                let near = match facts.stability {
                    Stability::Below(limit) => (h_omega / limit - 1.0).abs() < 0.02,
                    _ => false,
                };
                if let (Some(predicted), false) = (predicted, near) {
                    cells += 1;
                    agree += u32::from(predicted == (outcome == SURVIVES || outcome == FADES));
                }
            }
        }
        if let Stability::Below(limit) = facts.stability {
            let border = spaced(1e-3, 1.0, 60).map(|h| (h, (limit / h).powi(2)));
            let label = format!("h ω = {limit:.3}");
            map = map.border(&label, border.filter(|&(_, k)| (1.0..=1e6).contains(&k)));
        }
        let expected = match facts.stability {
            Stability::Below(limit) => format!("survives for h ω < {limit:.3}"),
            Stability::Always => "survives at every step".to_owned(),
            Stability::Never => "survives at no step".to_owned(),
        };
        claims.push(Claim::number(
            format!("part of the map on which {} does as predicted", facts.name),
            expected,
            f64::from(agree) / f64::from(cells),
            (1.0, 1.0),
        ));
        if CHARTED.contains(&method) {
            charts.push(map.into());
        }
    }
    Ok(Study {
        conclusion: format!(
            "A unit mass on a spring, {STEPS} steps. Symplectic methods survive below h ω = 2, RK4 \
             below 2√2, explicit Euler nowhere: where it seems to, its growth is too slow to be \
             seen in {STEPS} steps. On this linear system the trapezoid and midpoint rules survive \
             every step, as does implicit Euler, which pays with the motion itself."
        ),
        table,
        charts,
        claims,
        ..OSCILLATOR.heading()
    })
}

/// The angular velocity of the swing at its fastest, from the side through the bottom: sqrt(2 g/L).
const SWING: f64 = std::f64::consts::SQRT_2;

/// The energy of the swing, joules: the fall from the side to the bottom.
const ENERGY: f64 = 1.0;

/// The step at which a chord of the swing sags so far that the spring, held at its rest length in the
/// middle of the step, is stretched at both ends by as much energy as the swing has:
/// `k/2 ((h W)^2/8)^2 = E`.
fn sagging_step(k: f64) -> f64 {
    (128.0 * ENERGY / k).sqrt().sqrt() / SWING
}

fn nonlinear(size: Size) -> Result<Study, StudyError> {
    let count = match size {
        Size::Default => 25,
        Size::Full => 61,
    };
    let mut table = Table::new([
        Column::exact("method"),
        Column::rounded("step [s]", 3, 0.0),
        Column::rounded("stiffness [N/m]", 3, 0.0),
        Column::exact("outcome"),
    ]);
    let (mut charts, mut claims) = (Vec::new(), Vec::new());
    for method in [Method::ImplicitMidpoint, Method::Trapezoid, Method::ImplicitEuler] {
        let name = method.facts().name;
        let axes = (Axis::log("step", "s"), Axis::log("stiffness", "N/m"));
        let mut map = Map::new(name, axes.0, axes.1, [SURVIVES, FADES, BLOWS_UP, NO_SOLUTION]);
        let (mut resolved, mut unresolved) = (0_u32, 0_u32);
        let mut measured = Vec::new();
        for k in spaced(1e2, 1e8, count) {
            let problem = spring_pendulum(k).map_err(StudyError::at("the spring pendulum"))?;
            // The lowest energy, hanging at rest, where the spring has stretched by m g / k.
            let lowest = -1.0 - 0.5 / k;
            let mut first_failure = None;
            for h in spaced(1e-3, 1.0, count) {
                let outcome = outcome(&problem, &problem.initial, lowest, method, h)?;
                map.cell(h, k, outcome);
                table.push([name.into(), h.into(), k.into(), outcome.into()]);
                if h * k.sqrt() < 1.0 {
                    resolved += u32::from(outcome != SURVIVES && outcome != FADES);
                } else {
                    unresolved += u32::from(outcome == BLOWS_UP);
                }
                if outcome == BLOWS_UP && first_failure.is_none() {
                    first_failure = Some(h);
                }
            }
            measured.extend(first_failure.map(|h| h / sagging_step(k)));
        }
        map = map.border(
            "h ω = 1: the spring is resolved below",
            spaced(1e-3, 0.1, 40).map(|h| (h, h.powi(-2))).filter(|&(_, k)| k >= 1e2),
        );
        claims.push(Claim::number(
            format!("cells where {name} fails although it resolves the spring"),
            "none",
            f64::from(resolved),
            (0.0, 0.0),
        ));
        let (expected, band) = match method {
            Method::ImplicitEuler => ("none", (0.0, 0.0)),
            _ => ("some: linear stability does not carry over", (1.0, f64::INFINITY)),
        };
        claims.push(Claim::number(
            format!("cells where {name} blows up at larger steps"),
            expected,
            f64::from(unresolved),
            band,
        ));
        if method == Method::ImplicitMidpoint {
            let sag = spaced(1e2, 1e8, 40).map(|k| (sagging_step(k), k));
            map = map.border("the sag of a step stores the swing's energy", sag);
            let worst =
                measured.iter().copied().max_by(|a, b| a.ln().abs().total_cmp(&b.ln().abs()));
            claims.push(Claim::number(
                "measured over predicted border of implicit-midpoint, where they differ most",
                "1, to a factor of 2",
                worst.unwrap_or(f64::NAN),
                (0.5, 2.0),
            ));
        }
        charts.push(map.into());
    }
    Ok(Study {
        conclusion: format!(
            "A unit mass on a stiff spring of unit length, let go sideways, {STEPS} steps; the swing \
             turns at up to {SWING:.2} rad/s. Linear theory says that all three methods survive \
             everywhere. They do while the step resolves the spring, and well beyond; but once the \
             spring turns far enough within a step, the midpoint and trapezoid rules feed energy \
             from the swing into the spring until both are lost, with every step solved to \
             rounding. The midpoint rule holds the spring's length in the middle of a step, where \
             the chord sags: its ends are then stretched, and the border lies where that stores as \
             much energy as the swing has. Implicit Euler never gains energy; where its step is so large that Newton's \
             method cannot follow the narrow valley of the stretched spring in 50 iterations, it \
             says so."
        ),
        table,
        charts,
        claims,
        ..SPRING_PENDULUM.heading()
    })
}
