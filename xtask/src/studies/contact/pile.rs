//! A pile of discs lands on the ground at once: four solvers on a growing number of contacts.

use nalgebra::Vector2;
use stationary_calculus::{Covector, DiagonalMetric, System, Vector};
use stationary_chart::{Axis, Lines, Series};
use stationary_contact::problems::{ImpactProblem, landing_pile};
use stationary_contact::{
    ContactError, ImpactLaw, PlanarCollider, PlanarDetector, PlanarShape, World, residual,
};
use stationary_integrators::State;
use stationary_measure::{Column, Table, loglog_slope};
use stationary_rigid::{LieGroup, PlanarMotion, PlanarWeight};

use crate::studies::cheapest::{known_as, part};
use crate::study::{Answer, Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Work of each solver, and what it leaves, against the number of contacts.
pub const PILE_SOLVERS: Entry<'static> = Entry {
    id: "pile-solvers",
    krate: "contact",
    chapter: "11.5.1",
    kind: Kind::WorkPrecision,
    title: "Pile that lands: work and residual of four solvers against contacts",
    tested: Tested::Table,
    run: &study,
};

/// Passes after which a solver is stopped.
const PASSES: usize = 100_000;

/// The step of the world, s.
const STEP: f64 = 1e-3;

/// What a solver took and left.
struct Landing {
    passes: usize,
    /// Contacts or systems solved.
    solves: usize,
    /// How far the conditions (11.2) are from being met, m/s; none where it was stopped.
    residual: Option<f64>,
    /// The kinetic energy after over that before.
    energy: f64,
}

fn land(law: ImpactLaw, pile: &ImpactProblem) -> Result<Landing, ContactError> {
    let impact = pile.impact()?;
    let mut v = Vector(pile.velocity.clone());
    let (passes, solves, residual) = match law.apply_within(&impact, PASSES, v.view_mut()) {
        Ok(report) => {
            let residual = residual(&impact, &report.impulses, v.view());
            (report.passes, report.solves, Some(residual))
        }
        Err(ContactError::NotConverged { velocity, iterations, .. }) => {
            v.0 = velocity;
            (iterations, iterations * impact.len(), None)
        }
        Err(error) => return Err(error),
    };
    let energy = pile.kinetic_energy(&v.0) / pile.kinetic_energy(&pile.velocity);
    Ok(Landing { passes, solves, residual, energy })
}

/// The same pile as discs of a world, in one step: what a scene does.
fn land_in_a_world(base: usize) -> Result<Landing, ContactError> {
    let row = |r: usize| (0..base - r).map(move |k| (k as f64 + 0.5 * r as f64, r as f64));
    let discs: Vec<(f64, f64)> = (0..base).flat_map(row).collect();
    let rise = 3.0_f64.sqrt() / 2.0;
    let q = discs.iter().flat_map(|&(x, r)| [x, 0.5 + rise * r, 0.0]).collect();
    let p: Vec<f64> = discs.iter().flat_map(|_| [0.0, -1.0, 0.0]).collect();
    let metric = DiagonalMetric::new([1.0, 1.0, 0.125].repeat(discs.len()))?;
    let weight = PlanarWeight { gravity: Vector2::zeros(), masses: vec![1.0; discs.len()] };
    let disc = PlanarShape::disc(0.5)?;
    let mut colliders: Vec<_> =
        (0..discs.len()).map(|body| PlanarCollider::on_body(body, disc.clone())).collect();
    let ground = PlanarShape::half_plane(Vector2::y())?;
    colliders.push(PlanarCollider::fixed(PlanarMotion::identity(), ground));
    let detector = PlanarDetector::new(colliders, discs.len())?;
    let mut world = World::new(System::new(metric, weight)?, detector)?;
    let mut state = State::new(q, Covector(p));
    let report = world.step(&mut state, STEP)?;
    let energy = |p: &[f64]| p.iter().map(|p| p * p).sum::<f64>() / discs.len() as f64;
    Ok(Landing {
        passes: 1,
        solves: report.relaxed + report.solved,
        residual: report.settled.then_some(report.residual),
        energy: energy(&state.p.0),
    })
}

/// The power with which work grows on the larger half of the piles.
fn growth(works: &[(f64, f64)]) -> f64 {
    loglog_slope(&works[works.len() / 2..]).unwrap_or(f64::NAN)
}

/// The solver with the least work on the largest pile, and its work over that of the next.
fn answer(cost: &Lines) -> Option<Answer> {
    let last = |series: &'_ Series| series.points.last().copied();
    let mut works: Vec<(&str, f64, f64)> = cost
        .series
        .iter()
        .filter_map(|series| last(series).map(|(size, work)| (series.name.as_str(), size, work)))
        .collect();
    works.sort_by(|a, b| a.2.total_cmp(&b.2));
    let [(best, contacts, least), (next, _, work), ..] = works[..] else { return None };
    Some(Answer {
        question: format!("Impacts of a pile, {contacts} contacts at once"),
        method: known_as(best),
        figure: format!("at {} of the solves of {next}", part(least / work)),
    })
}

fn study(size: Size) -> Result<Study, StudyError> {
    let sizes: &[usize] = match size {
        Size::Default => &[2, 3, 4, 6, 8, 11],
        Size::Full => &[2, 3, 4, 6, 8, 11, 16, 22],
    };
    let mut table = Table::new([
        Column::exact("solver"),
        Column::exact("discs"),
        Column::exact("contacts"),
        Column::exact("passes"),
        Column::exact("contacts or systems solved"),
        Column::rounded("KKT residual [m/s]", 2, 1e-11),
        Column::rounded("energy left, part", 2, 1e-11),
    ]);
    let contacts = || Axis::log("contacts", "");
    let work = Axis::log("contacts or systems solved", "");
    let mut cost = Lines::new("Work until nothing approaches", contacts(), work);
    let left = Axis::log("KKT residual", "m/s");
    let mut quality = Lines::new("Residual of the conditions", contacts(), left);
    let mut claims = Vec::new();
    let laws = [ImpactLaw::GaussSeidel, ImpactLaw::Jacobi, ImpactLaw::Inelastic];
    for law in laws.map(Some).into_iter().chain([None]) {
        let name = law.map_or("world", |law| law.facts().name);
        let (mut works, mut lefts) = (Vec::new(), Vec::new());
        for &base in sizes {
            let pile = landing_pile(base);
            let contacts = pile.rows.len();
            let done = law.map_or_else(|| land_in_a_world(base), |law| land(law, &pile));
            let done = done.map_err(StudyError::at(name))?;
            if let Some(residual) = done.residual {
                works.push((contacts as f64, done.solves as f64));
                lefts.push((contacts as f64, residual.max(f64::EPSILON)));
            }
            table.push([
                name.into(),
                (pile.velocity.len() as u64 / 2).into(),
                (contacts as u64).into(),
                (done.passes as u64).into(),
                // What the exact projection of an island solves in itself is not told.
                if law.is_none() && done.solves == 0 {
                    "one projection".into()
                } else {
                    (done.solves as u64).into()
                },
                done.residual.map_or("stopped".into(), Into::into),
                done.energy.into(),
            ]);
        }
        let residuals = || lefts.iter().map(|point| point.1);
        match law {
            None => {
                let most = residuals().fold(0.0, f64::max);
                let text = "world: the largest residual of its normal conditions, m/s";
                claims.push(Claim::number(text, "below 1e-10", most, (0.0, 1e-10)));
                let text = "world: piles that it settles";
                let settled = lefts.len() as f64;
                let all = sizes.len() as f64;
                claims.push(Claim::number(text, "all", settled, (all, all)));
            }
            Some(ImpactLaw::Inelastic) => {
                let most = residuals().fold(0.0, f64::max);
                let text = "inelastic: the largest KKT residual, m/s";
                claims.push(Claim::number(text, "below 1e-10", most, (0.0, 1e-10)));
            }
            Some(ImpactLaw::GaussSeidel) => {
                let text = "gauss-seidel: power of the number of contacts with which work grows";
                claims.push(Claim::number(text, "2", growth(&works), (1.5, 2.5)));
                let least = residuals().fold(f64::INFINITY, f64::min);
                let text = "gauss-seidel: the least KKT residual, m/s";
                claims.push(Claim::number(text, "above 1e-3", least, (1e-3, 10.0)));
            }
            _ => {
                let text = "jacobi: the same power";
                claims.push(Claim::number(text, "2", growth(&works), (1.5, 2.5)));
            }
        }
        if law.is_some() {
            cost = cost.with(Series::new(name, works));
        }
        quality = quality.with(Series::new(name, lefts));
    }
    Ok(Study {
        answers: answer(&cost).into_iter().collect(),
        conclusion: "Discs stacked in a triangle land on the ground all at once, without \
                     restitution. Gauss-Seidel and Jacobi solve one contact at a time, and their \
                     work grows with nearly the square of the number of contacts; the projection \
                     takes one pass, in which it solves about as many systems as there are \
                     contacts, each of the contacts that push. Where Gauss-Seidel has stopped all \
                     approach, contacts that separate have pushed: that is another answer, with \
                     up to five parts in a hundred more energy than the least. Jacobi comes nearer \
                     to the least, and the projection is there to rounding. A world lands the same \
                     pile in one step by that projection."
            .into(),
        table,
        charts: vec![cost.into(), quality.into()],
        claims,
        ..PILE_SOLVERS.heading()
    })
}
