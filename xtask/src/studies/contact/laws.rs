//! The impact laws, scored on impacts whose answers or invariants are known.

mod rough;

use stationary_calculus::Vector;
use stationary_chart::{Axis, BarSeries, Bars};
use stationary_contact::problems::{
    ImpactProblem, ball_in_corner, bernoulli_wedge, listed_twice, newtons_cradle, nine_ball_break,
    three_balls,
};
use stationary_contact::{ContactError, ImpactLaw};
use stationary_measure::{Cell, Column, Table};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Each law on each impact.
pub const IMPACT_LAWS: Entry<'static> = Entry {
    id: "impact-laws",
    krate: "contact",
    chapter: "11.5",
    kind: Kind::Ladder,
    title: "Simultaneous impacts: velocities after, by five laws",
    tested: Tested::Table,
    run: &study,
};

/// Below it a number is rounding.
const ROUNDING: f64 = 1e-12;
/// The same of impacts with friction, which are iterated.
const ROUGH_ROUNDING: f64 = 1e-9;

/// What a law did to an impact.
struct Score {
    velocity: Vec<f64>,
    energy: f64,
    momentum: f64,
    asymmetry: f64,
    order: f64,
    passes: usize,
    solves: usize,
}

fn score(law: ImpactLaw, problem: &ImpactProblem) -> Result<Score, ContactError> {
    let mut v = Vector(problem.velocity.clone());
    let report = law.apply(&problem.impact()?, v.view_mut())?;
    let energy = problem.kinetic_energy(&problem.velocity);
    let moved = problem.total_momentum(&v.0);
    let momentum = problem
        .total_momentum(&problem.velocity)
        .iter()
        .zip(&moved)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    let symmetric = problem.asymmetry(&problem.velocity) == 0.0;
    Ok(Score {
        energy: problem.kinetic_energy(&v.0) / energy - 1.0,
        momentum,
        asymmetry: if symmetric { problem.asymmetry(&v.0) } else { 0.0 },
        order: order_dependence(law, problem, &v.0)?,
        passes: report.passes,
        solves: report.solves,
        velocity: v.0,
    })
}

/// How far the answer moves when the contacts are listed from back to front.
fn order_dependence(
    law: ImpactLaw,
    problem: &ImpactProblem,
    v: &[f64],
) -> Result<f64, ContactError> {
    let reversed: Vec<usize> = (0..problem.rows.len()).rev().collect();
    let mut other = Vector(problem.velocity.clone());
    law.apply(&problem.impact_in_order(&reversed)?, other.view_mut())?;
    Ok(v.iter().zip(&other.0).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max))
}

fn problems() -> Vec<(String, ImpactProblem)> {
    let mut problems: Vec<_> = (1..=3)
        .map(|moving| (format!("cradle, {moving} of 5"), newtons_cradle(5, moving)))
        .collect();
    problems.push(("three balls".into(), three_balls()));
    problems.push(("wedge".into(), bernoulli_wedge(0.7)));
    problems.push(("nine-ball break".into(), nine_ball_break()));
    problems.push(("corner, c = 0.8".into(), ball_in_corner().with_restitution(0.8)));
    problems.push(("wall listed twice".into(), listed_twice()));
    problems
}

fn study(_: Size) -> Result<Study, StudyError> {
    let mut table = Table::new([
        Column::exact("law"),
        Column::exact("impact"),
        Column::rounded("energy gained", 3, ROUNDING),
        Column::rounded("momentum gained [N s]", 3, ROUNDING),
        Column::rounded("asymmetry [m/s]", 3, ROUNDING),
        Column::rounded("order dependence [m/s]", 3, ROUNDING),
        Column::exact("passes"),
        Column::exact("contacts or systems solved"),
        Column::rounded("energy gained, friction 0.2", 3, ROUGH_ROUNDING),
        Column::rounded("energy gained, friction 0.5", 3, ROUGH_ROUNDING),
        Column::rounded("outside of the cone, part", 3, ROUGH_ROUNDING),
        Column::rounded("off the closed form [m/s]", 3, ROUGH_ROUNDING),
    ]);
    let mut cradle = Bars::new(
        "Two balls arrive at a cradle of five",
        "ball",
        (1..=5).map(|ball: u32| ball.to_string()),
        Axis::linear("velocity after", "m/s"),
    );
    let mut claims = Vec::new();
    for &law in ImpactLaw::ALL {
        let facts = law.facts();
        let mut worst = [0.0_f64; 4];
        let mut gained = 0.0_f64;
        let mut breaks_away = true;
        for (name, problem) in problems() {
            let score = score(law, &problem).map_err(StudyError::at(facts.name))?;
            let elastic = problem.restitution.iter().all(|&c| c == 1.0);
            let numbers = [score.energy, score.momentum, score.asymmetry, score.order];
            let counted =
                [if elastic { score.energy } else { 0.0 }, numbers[1], numbers[2], numbers[3]];
            worst.iter_mut().zip(counted).for_each(|(w, x)| *w = w.max(x.abs()));
            gained = gained.max(score.energy);
            if let Some(rest) = name.strip_prefix("cradle, ") {
                let moving: usize = rest[..1].parse().unwrap_or(0);
                let right = |(ball, v): (usize, &f64)| {
                    (v - f64::from(u8::from(ball >= 5 - moving))).abs() < ROUNDING
                };
                breaks_away &= score.velocity.iter().enumerate().all(right);
                if moving == 2 {
                    let velocities = score.velocity.iter().copied();
                    cradle = cradle.with(BarSeries::new(facts.name, velocities));
                }
            }
            let mut cells: Vec<Cell> = vec![facts.name.into(), name.into()];
            cells.extend(numbers.map(Cell::from));
            cells.extend([Cell::from(score.passes as u64), Cell::from(score.solves as u64)]);
            cells.extend([(); 4].map(|()| Cell::from("-")));
            table.push(cells);
        }
        if law != ImpactLaw::Jacobi {
            let rough = rough::scored(law).map_err(StudyError::at(facts.name))?;
            claims.extend(rough::claims(law, &rough));
            rough.iter().for_each(|score| table.push(score.cells(law)));
        }
        let words = |yes: bool| if yes { "yes" } else { "no" };
        let small = |x: f64| words(x < ROUNDING);
        for (text, promised, measured) in [
            ("never gains energy", facts.energy_never_grows, small(gained)),
            ("keeps energy where c = 1", facts.keeps_energy, small(worst[0])),
            ("keeps symmetry", facts.symmetric, small(worst[2])),
            ("does not depend on the order", facts.order_free, small(worst[3])),
            ("lets contacts break away", facts.breaks_away, words(breaks_away)),
        ] {
            let claim = format!("{} {text}", facts.name);
            claims.push(Claim::words(claim, words(promised), measured));
        }
        let claim = format!("{} keeps momentum", facts.name);
        claims.push(Claim::number(claim, "below 1e-12", worst[1], (0.0, ROUNDING)));
    }
    Ok(Study {
        conclusion: "Newton's cradles, the three balls of 11.5, a ball between two others, a rack \
                     of nine, a corner, and a wall that is listed twice. Only generalized \
                     reflections keep all of energy, momentum and symmetry, do not care in which \
                     order contacts are listed, and send out as many balls as arrive. Gauss-Seidel \
                     depends on the order, Jacobi gains energy, and what projects on all contacts \
                     at once moves balls that only touch. With friction, which acts in every \
                     impact but by Jacobi's law, none gains energy or leaves Coulomb's cone, and \
                     a disc that bounces with spin leaves as the closed form says."
            .into(),
        table,
        charts: vec![cradle.into()],
        claims,
        ..IMPACT_LAWS.heading()
    })
}
