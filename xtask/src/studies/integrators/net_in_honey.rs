//! Error against cost on two stiff scenes: a net with drag so strong that it creeps, and a line of unlike masses
//! with a damper beside each spring.

use stationary_chart::{Axis, Lines, Series};
use stationary_measure::{Cell, Column, Table};
use stationary_scene::{Run, Scene, SceneError};

use crate::studies::cheapest::cost_at;
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};
use crate::timing::median_wall;

/// A spring net with drag.
pub const STUDY: Entry<'static> = Entry {
    id: "net-in-honey",
    krate: "scene",
    chapter: "10.1",
    kind: Kind::WorkPrecision,
    title: "Net that sinks in honey: error against cost",
    tested: Tested::ByReport,
    run: &study,
};

/// Samples over the horizon, at which errors are taken.
const SAMPLES: u64 = 20;
/// The side of the net, against which errors are judged, metres.
const SIDE: f64 = 0.15;

/// The net with the lines that say how it is stepped.
fn net(stepping: &str, steps: u64) -> Result<Scene, SceneError> {
    let (step, every) = (HORIZON / steps as f64, steps / SAMPLES);
    Scene::parse(
        "net-in-honey.toml",
        &format!(
            r#"
            dimension = 3
            {stepping}
            step = {step:e}
            horizon = {HORIZON}
            sample_every = {every}
            observables = []
            uniform_gravity = {{ acceleration = [0, 0, -9.81] }}
            drag = {{ coefficient = 20 }}

            [[nets]]
            name = "net"
            rows = 4
            columns = 4
            spacing = 0.05
            origin = [0, 0, 0]
            across = [1, 0, 0]
            down = [0, 1, 0]
            particle_mass = 0.025
            stiffness = 400
            pinned = ["top-left", "top-right"]
            "#
        ),
    )
}

/// The time over which it sinks, seconds.
const HORIZON: f64 = 10.0;

/// A line between two hooks, every second mass a hundred times the others, that is let go and falls.
fn line(stepping: &str, steps: u64) -> Result<Scene, SceneError> {
    let mass = |k: u32| match k {
        0 | LINKS => "pinned = true".to_owned(),
        _ => format!("mass = {}", if k.is_multiple_of(2) { 0.0025 } else { 0.25 }),
    };
    let particle =
        |k| format!("{{ name = \"{k}\", position = [{}, 0], {} }}", 0.05 * f64::from(k), mass(k));
    let particles: Vec<String> = (0..=LINKS).map(particle).collect();
    let spring =
        |k| format!("{{ between = [\"{k}\", \"{}\"], stiffness = 400, damping = 20 }}", k + 1);
    let springs: Vec<String> = (0..LINKS).map(spring).collect();
    Scene::parse(
        "damped-line.toml",
        &format!(
            "dimension = 2\n{stepping}\nstep = {:e}\nhorizon = {FALL}\nsample_every = {}\nobservables = []\n\
             uniform_gravity = {{ acceleration = [0, -9.81] }}\nparticles = [{}]\nsprings = [{}]\n",
            FALL / steps as f64,
            steps / SAMPLES,
            particles.join(", "),
            springs.join(", "),
        ),
    )
}

/// The links of the line, their length together, metres, and the time over which it falls, seconds.
const LINKS: u32 = 9;
const LENGTH: f64 = 0.45;
const FALL: f64 = 1.0;

/// A scene with the lines that say how it is stepped.
type Made = fn(&str, u64) -> Result<Scene, SceneError>;

/// A method with the ways to ask it for more.
#[derive(Clone)]
struct Contender {
    name: &'static str,
    /// Numbers of steps, for methods of equal steps.
    steps: Vec<u64>,
    /// Exponents of tolerances, for those that choose their own.
    digits: std::ops::RangeInclusive<i32>,
}

fn contenders(size: Size) -> [Contender; 5] {
    let (doublings, digits) = match size {
        Size::Default => (4, 7),
        Size::Full => (7, 9),
    };
    let equal = || (0..doublings).map(|k| SAMPLES << k).collect();
    let one = |name, steps, digits| Contender { name, steps, digits };
    #[expect(clippy::reversed_empty_ranges)]
    let none = 1..=0;
    [
        one("newmark", equal(), none.clone()),
        one("generalized-alpha", equal(), none),
        one("radau-iia-5", Vec::new(), 2..=digits),
        one("bdf-5", Vec::new(), 2..=digits),
        one("dormand-prince-853", Vec::new(), 4..=4),
    ]
}

/// Those of the line: steps that are stable, and all that have kicks.
fn of_the_line(size: Size) -> Vec<Contender> {
    let halved = |contender: Contender| Contender {
        steps: contender.steps.iter().map(|steps| 16 * steps).collect(),
        ..contender
    };
    let mut all: Vec<Contender> = contenders(size).into_iter().map(halved).collect();
    all.push(Contender { name: "stormer-verlet", ..all[0].clone() });
    all
}

/// The largest distance of a particle from where it is in the reference, over a size of the scene.
fn error(run: &Run, reference: &Run, scale: f64) -> f64 {
    let samples = 0..run.times().len();
    let of = |sample: usize| {
        let pairs = run.positions(sample).iter().zip(reference.positions(sample));
        pairs.map(|(a, b)| (a - b) * (a - b)).fold(0.0, f64::max).sqrt()
    };
    samples.map(of).fold(0.0, f64::max) / scale
}

fn reference(made: Made, name: &str, tolerance: &str) -> Result<Run, StudyError> {
    let stepping = format!("integrator = \"{name}\"\ntolerance = {tolerance}");
    let scene = made(&stepping, SAMPLES).map_err(StudyError::at("the scene"))?;
    scene.run().map_err(StudyError::at("the reference"))
}

/// Runs the contenders; by counted work and by wall time.
fn charts(
    (made, held, scale): (Made, &'static str, f64),
    contenders: impl IntoIterator<Item = Contender>,
    truth: &Run,
    table: &mut Table,
) -> Result<[Lines; 2], StudyError> {
    let error_axis = || Axis::log("largest error of a position", "sizes of the scene");
    let work = Axis::log("evaluations and factorizations", "");
    let mut counted =
        Lines::new(&format!("Held back by {held}: by counted work"), work, error_axis())
            .mark_front();
    let wall = Axis::log("wall time", "s");
    let mut timed = Lines::new(&format!("Held back by {held}: by wall time"), wall, error_axis());
    for contender in contenders {
        let (mut by_count, mut by_time) = (Vec::new(), Vec::new());
        let equal = contender.steps.iter().map(|&n| (String::new(), n, format!("{n} steps")));
        let adaptive = contender.digits.clone().map(|digits| {
            (format!("\ntolerance = 1e-{digits}"), SAMPLES, format!("tolerance 1e-{digits}"))
        });
        for (tolerance, steps, asked) in equal.chain(adaptive) {
            let stepping = format!("integrator = \"{}\"{tolerance}", contender.name);
            let scene = made(&stepping, steps).map_err(StudyError::at("the scene"))?;
            let mut last = None;
            let wall = median_wall(|| last = Some(scene.run()));
            let run = last.unwrap_or_else(|| scene.run());
            let run = run.map_err(StudyError::at(contender.name))?;
            let (error, cost) = (error(&run, truth, scale), run.cost());
            by_count.push(((cost.differentials + cost.hessians) as f64, error));
            by_time.push((wall.median, error));
            let cells: [Cell; 7] = [
                held.into(),
                contender.name.into(),
                asked.into(),
                error.into(),
                (cost.differentials as f64).into(),
                (cost.hessians as f64).into(),
                wall.median.into(),
            ];
            table.push(cells);
        }
        counted = counted.with(Series::new(contender.name, by_count));
        timed = timed.with(Series::new(contender.name, by_time));
    }
    Ok([counted, timed])
}

fn study(size: Size) -> Result<Study, StudyError> {
    let mut table = Table::new([
        Column::exact("held back by"),
        Column::exact("method"),
        Column::exact("asked for"),
        Column::rounded("error", 1, 1e-9),
        Column::rounded("evaluations", 1, 0.0),
        Column::rounded("factorizations", 1, 0.0),
        Column::volatile("wall [s]"),
    ]);
    let truth = reference(net, "radau-iia-5", "1e-10")?;
    let uncertainty = error(&reference(net, "bdf-5", "1e-9")?, &truth, SIDE);
    let [counted, timed] = charts((net, "drag", SIDE), contenders(size), &truth, &mut table)?;
    let falls = reference(line, "radau-iia-5", "1e-11")?;
    let unsure = error(&reference(line, "dormand-prince-853", "1e-10")?, &falls, LENGTH);
    let of_line: (Made, _, _) = (line, "dampers", LENGTH);
    let [damped, damped_in_time] = charts(of_line, of_the_line(size), &falls, &mut table)?;
    let of = |lines: &Lines, name: &str| {
        let series = lines.series.iter().find(|series| series.name == name);
        series.map(|series| series.points.clone()).unwrap_or_default()
    };
    let points = |name: &str| of(&counted, name);
    let kicked = of(&damped, "stormer-verlet");
    let fell = match kicked[..] {
        [.., (_, before), (_, last)] => before / last,
        _ => f64::NAN,
    };
    let least = |points: Vec<(f64, f64)>| points.iter().map(|p| p.0).fold(f64::INFINITY, f64::min);
    let at = |name| cost_at(1e-4, &points(name)).unwrap_or(f64::NAN);
    let claims = vec![
        Claim::number(
            "two methods agree on the reference, in sides of the net",
            "1e-6 or better",
            uncertainty,
            (0.0, 1e-6),
        ),
        Claim::number(
            "what the explicit method needs at any accuracy, over what radau-iia-5 needs at 1e-4",
            "above 10: the drag's rate bounds its step",
            least(points("dormand-prince-853")) / at("radau-iia-5"),
            (10.0, f64::INFINITY),
        ),
        Claim::number(
            "two methods agree on the reference of the line, in its lengths",
            "1e-7 or better",
            unsure,
            (0.0, 1e-7),
        ),
        Claim::number(
            "what halving the step divides the error of stormer-verlet by, between kicks of all dampers at once",
            "4: order 2",
            fell,
            (3.5, 4.5),
        ),
    ];
    Ok(Study {
        conclusion: format!(
            "A net of 4 x 4 particles, held at two corners and let go in drag of 20 kg/s, over \
             {HORIZON} s: it creeps, while each particle forgets its speed in a millisecond. The \
             explicit method pays for that millisecond at any accuracy. Methods of higher order that \
             choose their steps, short at the start and long in the end, need least: the formulas of \
             variable order also by the clock, while Radau IIA loses there to the full matrices that \
             it factors. Generalized-alpha's damping of what is fast costs it the start. The answer that errors are taken \
             against is Radau IIA at 1e-10; the formulas of variable order agree to {uncertainty:.0e}. \
             Dampers along springs hold back stretch alone: a line of masses of which every second weighs a hundred \
             times the others falls as a chain, and its fast stretches are damped. Kicks that solve all dampers at once \
             keep order 2 and need no matrix; methods that choose their steps need least for many digits."
        ),
        table,
        charts: vec![counted.into(), timed.into(), damped.into(), damped_in_time.into()],
        claims,
        ..STUDY.heading()
    })
}
