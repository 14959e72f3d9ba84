//! A million steps: what each method does to energy, momentum and the planet's place.

use stationary_chart::{Axis, Chart, Lines, Series};
use stationary_integrators::problems::kepler;
use stationary_integrators::{
    Conservation, EnergyBehavior, Integrator, Method, State, Symplecticity, angular_momentum,
};
use stationary_measure::{Cell, Column, Table, loglog_slope};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Energy, angular momentum and error over many orbits.
pub const KEPLER: Entry<'static> = Entry {
    id: "kepler-long-run",
    krate: "integrators",
    chapter: "4.5",
    kind: Kind::LongRun,
    title: "Eccentric orbit: energy, momentum and error over a million steps",
    tested: Tested::ByReport,
    run: &study,
};

/// Steps an orbit.
const STEPS: u64 = 500;

/// Rounding of energy and momentum over so many steps.
const ROUNDING: f64 = 1e-11;

/// The worst of everything up to a number of orbits.
#[derive(Clone, Copy, Default)]
struct Worst {
    orbits: f64,
    energy: f64,
    momentum: f64,
    error: f64,
}

/// What became of a method.
struct Course {
    method: Method,
    marks: Vec<Worst>,
    failure: Option<(f64, String)>,
}

fn study(size: Size) -> Result<Study, StudyError> {
    let orbits = match size {
        Size::Default => 2_000,
        Size::Full => 20_000,
    };
    let mut courses = Vec::new();
    for method in Method::TABLE_4_1 {
        courses.push(follow(method, orbits)?);
    }
    let mut table = Table::new([
        Column::exact("method"),
        Column::exact("orbits"),
        Column::rounded("energy error", 2, ROUNDING),
        Column::rounded("angular momentum error", 2, ROUNDING),
        Column::rounded("error", 2, ROUNDING),
    ]);
    for course in &courses {
        let name = course.method.facts().name;
        for mark in course.marks.iter().filter(|mark| mark.orbits.log10().fract() == 0.0) {
            let mut cells: Vec<Cell> = vec![name.into(), (mark.orbits as u64).into()];
            cells.extend([mark.energy, mark.momentum, mark.error].map(Cell::from));
            table.push(cells);
        }
        if let Some((orbits, reason)) = &course.failure {
            table.push([name.into(), (*orbits as u64).into(), reason.clone().into()]);
        }
    }
    let charts = vec![
        chart("Energy", "largest energy error", &courses, |worst| worst.energy),
        chart("Angular momentum", "largest angular momentum error", &courses, |worst| {
            worst.momentum
        }),
        with_slopes(chart("Place", "largest error", &courses, |worst| worst.error)),
    ];
    Ok(Study {
        conclusion: format!(
            "An orbit of eccentricity 0.6 in {STEPS} steps, {orbits} times. The energy of symplectic \
             methods, and of the trapezoid rule, which is conjugate to one, oscillates and stays; \
             so the planet falls behind in proportion to time. RK4 starts four digits ahead, but \
             loses energy at every perihelion, and its error grows with the square of time. \
             Explicit Euler flings the planet out, implicit Euler drops it into the sun, where \
             Newton's method no longer finds a solution."
        ),
        table,
        claims: claims(&courses, orbits),
        charts,
        ..KEPLER.heading()
    })
}

fn follow(method: Method, orbits: u64) -> Result<Course, StudyError> {
    let problem = kepler(0.6).map_err(StudyError::at("the orbit"))?;
    let h = problem.period / STEPS as f64;
    let mut integrator: Box<dyn Integrator<[f64; 2]>> =
        method.integrator(&problem.system).map_err(StudyError::at(method.facts().name))?;
    let mut state = problem.initial.clone();
    let momentum = |state: &State<[f64; 2]>| angular_momentum::<2>(state)[2];
    let (energy_0, momentum_0) = (problem.energy(&state), momentum(&state));
    let mut worst = Worst::default();
    let mut course = Course { method, marks: Vec::new(), failure: None };
    let mut next_mark = 1.0_f64;
    for orbit in 1..=orbits {
        for step in 1..=STEPS {
            if let Err(error) = integrator.step(&mut state, h) {
                course.failure = Some((orbit as f64, error.to_string()));
                return Ok(course);
            }
            worst.energy = worst.energy.max((problem.energy(&state) / energy_0 - 1.0).abs());
            worst.momentum = worst.momentum.max((momentum(&state) / momentum_0 - 1.0).abs());
            // Around the orbit, but not at each step: the solution costs more than the step.
            if step % 20 == 0 {
                let time = problem.period * (step as f64 / STEPS as f64);
                worst.error = worst.error.max(problem.error(time, &state.q).unwrap_or(f64::NAN));
            }
        }
        worst.orbits = orbit as f64;
        if worst.orbits >= next_mark || orbit == orbits {
            course.marks.push(worst);
            next_mark = (worst.orbits * 1.25).floor().max(worst.orbits + 1.0);
            // Powers of ten are always marked, for the table.
            let power = 10.0_f64.powi(worst.orbits.log10().floor() as i32 + 1);
            if worst.orbits < power && next_mark > power {
                next_mark = power;
            }
        }
    }
    Ok(course)
}

fn chart(title: &str, y: &str, courses: &[Course], of: fn(&Worst) -> f64) -> Chart {
    let mut chart = Lines::new(title, Axis::log("orbits", ""), Axis::log(y, ""));
    for course in courses {
        let points = course.marks.iter().map(|mark| (mark.orbits, of(mark).max(1e-16)));
        let mut series = Series::new(course.method.facts().name, points);
        if let Some((orbits, reason)) = &course.failure {
            series = series.failed(*orbits, reason.clone());
        }
        chart = chart.with(series);
    }
    chart.into()
}

fn with_slopes(chart: Chart) -> Chart {
    match chart {
        Chart::Lines(lines) => lines.slope(1.0, (2.0, 2e-3)).slope(2.0, (10.0, 1e-6)).into(),
        other => other,
    }
}

fn claims(courses: &[Course], orbits: u64) -> Vec<Claim> {
    let mut claims = Vec::new();
    for Course { method, marks, failure } in courses {
        let facts = method.facts();
        let name = facts.name;
        if facts.symplecticity == Symplecticity::No && facts.order == 1 {
            let verdict = if failure.is_some() { "fails" } else { "loses the orbit" };
            let lost = marks.last().is_some_and(|mark| mark.error > 1.0);
            let verdict = if failure.is_some() || lost { verdict } else { "keeps the orbit" };
            let expected =
                if facts.energy == EnergyBehavior::Grows { "loses the orbit" } else { "fails" };
            claims.push(Claim::words(format!("{name} on {orbits} orbits"), expected, verdict));
            continue;
        }
        let (Some(last), Some(tenth)) =
            (marks.last(), marks.iter().find(|mark| mark.orbits * 10.0 >= orbits as f64))
        else {
            continue;
        };
        if facts.energy == EnergyBehavior::Bounded {
            let text = format!("energy error of {name}: after all orbits, over that after a tenth");
            claims.push(Claim::number(text, "1", last.energy / tenth.energy, (1.0, 1.05)));
        }
        // Order 1 leaves a bounded error of the size of h beside the growing one, which hides it.
        if facts.order > 1 {
            let (expected, band) = match facts.symplecticity {
                Symplecticity::No => ("2", (1.6, 2.1)),
                _ => ("1", (0.9, 1.1)),
            };
            let text = format!("error of {name} grows as this power of time");
            let power = growth(marks, |mark| mark.error);
            claims.push(Claim::number(text, expected, power, band));
        }
        let text = format!("angular momentum error of {name}");
        claims.push(match facts.angular_momentum {
            Conservation::Exact => Claim::number(text, "rounding", last.momentum, (0.0, ROUNDING)),
            _ => Claim::number(text, "more than rounding", last.momentum, (1e-9, 1.0)),
        });
    }
    claims
}

/// The power of time by which a quantity grows over the last decade before it is as large as the
/// orbit.
fn growth(marks: &[Worst], of: fn(&Worst) -> f64) -> f64 {
    let small: Vec<_> = marks.iter().filter(|mark| of(mark) < 0.5).collect();
    let Some(last) = small.last() else { return f64::NAN };
    let decade = small.iter().filter(|mark| mark.orbits * 10.0 >= last.orbits);
    let points: Vec<_> = decade.map(|mark| (mark.orbits, of(mark))).collect();
    loglog_slope(&points).unwrap_or(f64::NAN)
}
