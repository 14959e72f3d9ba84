//! Methods of order 4, 6 and 8: their orders, and what digits cost with them.

use stationary_calculus::{Metric, Potential};
use stationary_chart::{Axis, Lines, Series};
use stationary_integrators::problems::{Problem, henon_heiles, kepler, pendulum};
use stationary_integrators::{Convergence, Evaluation, Method, Nodes, Scheme};
use stationary_measure::{Column, Table, loglog_slope, truncation_regime};

use super::reference::{Samples, with_reference};
use super::work_precision::{self, Contest, OUTER, PLANETS};
use crate::study::{Claim, Entry, Kind, Study, StudyError, Tested};

/// Orders on Kepler's problem at e = 0.6.
pub const KEPLER_ORDERS: Entry<'static> = Entry {
    id: "kepler-high-orders",
    krate: "integrators",
    chapter: "4.5",
    kind: Kind::Convergence,
    title: "Eccentric orbit: error against the step, orders up to eight",
    tested: Tested::Claims,
    run: &|_| {
        let mut problem = kepler(0.6).map_err(StudyError::at("the orbit"))?;
        problem.horizon = problem.period;
        let methods = beyond_table_4_1();
        orders(KEPLER_ORDERS, &problem, &methods, 1, "one orbit of eccentricity 0.6")
    },
};

/// Orders on the pendulum released from 115 degrees.
pub const PENDULUM_ORDERS: Entry<'static> = Entry {
    id: "pendulum-high-orders",
    krate: "integrators",
    chapter: "4.5",
    kind: Kind::Convergence,
    title: "Swinging pendulum: error against the step, orders up to eight",
    tested: Tested::Claims,
    run: &|_| {
        let mut problem = pendulum(2.0).map_err(StudyError::at("the pendulum"))?;
        problem.horizon = problem.period;
        let methods = beyond_table_4_1();
        let motion = "one swing of a pendulum released from 2 rad";
        orders(PENDULUM_ORDERS, &problem, &methods, 1, motion)
    },
};

/// Orders on the star of Henon and Heiles.
pub const HENON_HEILES_ORDERS: Entry<'static> = Entry {
    id: "henon-heiles-convergence",
    krate: "integrators",
    chapter: "4.5",
    kind: Kind::Convergence,
    title: "Star of Hénon and Heiles: error of every method against the step",
    tested: Tested::ByReport,
    run: &|_| {
        let mut problem = henon_heiles(0.1).map_err(StudyError::at("the star"))?;
        problem.horizon = 2.0 * problem.period;
        // Not from the middle, where the force is zero: from there symplectic Euler is Verlet.
        problem.initial.q = [0.2, 0.1];
        let at = Samples { count: 8, coarsest: 256 };
        let problem = with_reference(problem, at)?;
        let motion = "two turns of a star in the field of Hénon and Heiles, of energy 0.1";
        orders(HENON_HEILES_ORDERS, &problem, Method::ALL, at.count, motion)
    },
};

/// Work on ten orbits of eccentricity 0.6.
pub const KEPLER_WORK: Entry<'static> = Entry {
    id: "kepler-high-order-work-precision",
    krate: "integrators",
    chapter: "4.5",
    kind: Kind::WorkPrecision,
    title: "Eccentric orbit: error against cost, orders up to eight",
    tested: Tested::ByReport,
    run: &|_| {
        let problem = kepler(0.6).map_err(StudyError::at("the orbit"))?;
        let steps = |method| steps(method, 6, 18);
        let motion = "ten orbits of eccentricity 0.6";
        let cheapest = [
            (1e-3, "blanes-moan-nystrom-6"),
            (1e-6, "blanes-moan-nystrom-6"),
            (1e-9, "blanes-moan-nystrom-6"),
        ];
        work_precision::study(
            KEPLER_WORK,
            &problem,
            steps,
            &Contest { methods: CONTENDERS, cheapest, motion, asked: None },
        )
    },
};

/// Work on the outer solar system.
pub const PLANETS_WORK: Entry<'static> = Entry {
    id: "outer-solar-system-high-order-work-precision",
    krate: "scene",
    chapter: "4.5",
    kind: Kind::WorkPrecision,
    title: "Outer solar system: error against cost, orders up to eight",
    tested: Tested::ByReport,
    run: &|_| {
        let problem = stationary_scene::problems::outer_solar_system()
            .map_err(StudyError::at("the outer solar system"))?;
        let problem = with_reference(problem, OUTER)?;
        let steps = |method: Method| {
            let most = 1 << 17;
            let stages = u64::from(method.facts().stages);
            (0..=8).map(|k| OUTER.count << k).take_while(|n| n * stages <= most).collect()
        };
        let cheapest = [
            (1e-3, "blanes-moan-nystrom-4"),
            (1e-6, "blanes-moan-nystrom-6"),
            (1e-8, "blanes-moan-nystrom-6"),
        ];
        let contest = Contest { methods: CONTENDERS, cheapest, motion: PLANETS, asked: None };
        work_precision::study(PLANETS_WORK, &problem, steps, &contest)
    },
};

/// The methods that the notes do not have.
fn beyond_table_4_1() -> Vec<Method> {
    let beyond = |method: &Method| !Method::TABLE_4_1.contains(method);
    Method::ALL.iter().copied().filter(beyond).collect()
}

/// The best of each order, beside those that everybody knows.
const CONTENDERS: &[Method] = &[
    Method::StormerVerlet,
    Method::RungeKutta4,
    Method::Composition(Scheme::BlanesMoanNystrom4),
    Method::Composition(Scheme::BlanesMoanNystrom6),
    Method::Composition(Scheme::KahanLi6),
    Method::Composition(Scheme::KahanLi8),
    Method::GaussLegendre(Nodes::Three),
];

/// Powers of two of steps whose evaluations lie between two powers of two; implicit methods, whose
/// every step is several evaluations and a factorization, get fewer.
fn steps(method: Method, least: u32, most: u32) -> Vec<u64> {
    let facts = method.facts();
    let most = if facts.evaluation == Evaluation::Implicit { most - 3 } else { most };
    let within = |n: &u64| *n * u64::from(facts.stages) <= 1 << most;
    (least..=most).map(|k| 1_u64 << k).take_while(within).collect()
}

/// An error above this, of motions of size one, is of none at all, and would leave the others no
/// room on a chart.
const LOST: f64 = 1e3;
/// Errors between these show the order of a method of order above 4: three decades above rounding.
const DECADES: std::ops::Range<f64> = 2e-12..2e-9;

/// The slope of the largest error: over halvings in which it obeys one power law up to order 4, over
/// three decades for higher orders, which leave no room for more.
fn order(method: Method, errors: &[(f64, f64)]) -> Option<f64> {
    if method.facts().order <= 4 {
        return loglog_slope(truncation_regime(errors));
    }
    let points: Vec<_> = errors.iter().copied().filter(|e| DECADES.contains(&e.1)).collect();
    (points.len() >= 4).then(|| loglog_slope(&points)).flatten()
}

/// An error at which methods of one order are compared.
const ENOUGH: f64 = 1e-6;

/// All but the best of each order as the rest: it takes the largest step for an error that is enough,
/// or where none is, has the least error.
fn best_of_each_order(curves: Vec<(u32, Series)>) -> Vec<Series> {
    let merit = |series: &Series| {
        let enough = series.points.iter().filter(|(_, error)| *error <= ENOUGH);
        let step = enough.map(|(step, _)| *step).fold(0.0, f64::max);
        let least = series.points.iter().map(|(_, error)| *error).fold(f64::INFINITY, f64::min);
        (step, -least)
    };
    let merits: Vec<(u32, (f64, f64))> =
        curves.iter().map(|(order, series)| (*order, merit(series))).collect();
    let is_best = |order: u32, own: (f64, f64)| {
        merits.iter().all(|(other, merit)| *other != order || *merit <= own)
    };
    let weighed = curves.into_iter().map(|(order, series)| match is_best(order, merit(&series)) {
        true => series,
        false => series.as_rest(),
    });
    weighed.collect()
}

fn orders<M: Metric, P: Potential, const N: usize>(
    entry: Entry<'_>,
    problem: &Problem<M, P, [f64; N]>,
    methods: &[Method],
    samples: u64,
    motion: &str,
) -> Result<Study, StudyError> {
    let mut curves = Vec::new();
    let mut table = Table::new([
        Column::exact("method"),
        Column::exact("claimed order"),
        Column::rounded("measured order", 2, 0.0),
    ]);
    let mut claims = Vec::new();
    for &method in methods {
        let facts = method.facts();
        // Steps that grow by 2^(1/4) for high orders: three decades are little more than one halving
        // of order 8. Low orders need more steps until their error follows its law.
        let steps = match facts.order {
            5.. => (0..=44).map(|k| 2_f64.powf(f64::from(k) / 4.0).round() as u64).collect(),
            1 => (0..=16).map(|k| 1_u64 << k).collect(),
            _ => (0..=14).map(|k| 1_u64 << k).collect::<Vec<_>>(),
        };
        let mut steps: Vec<u64> =
            steps.into_iter().map(|n| samples * n).filter(|n| (16..=1 << 17).contains(n)).collect();
        steps.dedup();
        let measured =
            Convergence::measure(problem, method, steps).map_err(StudyError::at(facts.name))?;
        let errors = measured.errors();
        let slope = order(method, &errors).unwrap_or(f64::NAN);
        table.push([facts.name.into(), u64::from(facts.order).into(), slope.into()]);
        let (lost, kept): (Vec<_>, Vec<_>) = errors.into_iter().partition(|(_, e)| *e > LOST);
        let mut series = Series::new(facts.name, kept);
        for (step, error) in lost {
            series = series.failed(step, format!("thrown out: the error is {error:.0e}"));
        }
        for row in &measured.rows {
            if let Err(failure) = &row.outcome {
                series = series.failed(row.horizon.step(), failure.to_string());
            }
        }
        curves.push((facts.order, series));
        let (claimed, band) = (f64::from(facts.order), if facts.order <= 4 { 0.1 } else { 0.3 });
        claims.push(Claim::number(
            format!("{} has order {}", facts.name, facts.order),
            format!("{claimed}"),
            slope,
            (claimed - band, claimed + band),
        ));
    }
    let chart = best_of_each_order(curves)
        .into_iter()
        .fold(Lines::new("", Axis::log("step", "s"), Axis::log("largest error", "")), Lines::with)
        .slope(4.0, (1e-2, 1e-8))
        .slope(6.0, (3e-2, 1e-10))
        .slope(8.0, (6e-2, 1e-11));
    Ok(Study {
        conclusion: format!(
            "The largest error along {motion}, against the step. Compositions of one order differ by \
             a factor of a hundred and more in the size of their error: the longer their steps \
             backward, the worse. Orders above four have a few halvings between an error as large \
             as the motion and rounding. In colour is the best of each order, which takes the \
             largest step for an error of {ENOUGH:e}; the others are grey and say their names when \
             pointed at."
        ),
        table,
        charts: vec![chart.into()],
        claims,
        ..entry.heading()
    })
}
