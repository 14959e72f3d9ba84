//! What a run comes to, rounded to the digits that another processor reproduces: a user's test of a
//! scene is one line that compares this text with a stored one.

use stationary_calculus::array;
use std::fmt;

use stationary_integrators::Evaluation;
use stationary_measure::{Cell, Column, Table};

use crate::model::claim::{Event, Measured, Scale};
use crate::model::observable::Observable;
use crate::model::particle::Motion;
use crate::model::stepping::CONTACT_STEPS;
use crate::run::claims::Verdict;
use crate::run::samples::{ChosenSteps, LastingContact, Run};
use crate::text::limits;

/// The tables of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    title: String,
    /// Sizes and cost.
    pub cost: Table,
    /// Energy and momenta at the start and at the end, and how far they strayed between.
    pub invariants: Table,
    /// What was built, a row for each structure. It is no part of the text.
    pub built: Table,
    /// The observables at the start and at the end, and their least and largest values.
    pub observables: Table,
    /// The works of what acts beside the potential and what is left of the energy's balance, where anything
    /// acts.
    pub budget: Option<Table>,
    /// The scene's claims with what was measured, where it makes any.
    pub claims: Option<Table>,
    /// How many of the claims do not hold.
    pub broken_claims: usize,
    /// Steps whose contact conditions were not met as far as asked, where there are any.
    pub unsettled: Option<String>,
    /// Steps in which contact lasted where that is stepped otherwise than flight, if there are any.
    pub lasting: Option<String>,
    /// Steps that were chosen by their error, where there are any.
    pub chosen: Option<String>,
    /// What the files of the run leave out, where they leave out anything.
    pub left_out: Option<String>,
}

/// Below this part of its scale a number is what rounding makes of zero.
const ROUNDING: f64 = 1e-11;

impl Summary {
    pub(crate) fn of(run: &Run) -> Self {
        let (scene, timing) = (run.scene(), run.scene().timing());
        let end = run.times().last().copied().unwrap_or_default();
        let unit = &scene.units().time;
        Summary {
            title: format!(
                "{}\n{}, {} of {} steps of {} {unit}, to {end} {unit}",
                scene.title(),
                scene.stepping(),
                run.cost().steps,
                timing.steps(),
                timing.step(),
            ),
            cost: cost(run),
            invariants: invariants(run),
            built: run.built().table(),
            observables: observables(run),
            budget: budget(run),
            claims: claims(run),
            broken_claims: run
                .claims()
                .iter()
                .filter(|answer| answer.verdict == Verdict::DoesNotHold)
                .count(),
            unsettled: (run.unsettled().steps > 0).then(|| unsettled(run)),
            lasting: (run.lasting_contact().steps > 0).then(|| lasting(run)),
            chosen: (run.chosen_steps().accepted > 0).then(|| chosen(run)),
            left_out: run.contact_impulses_end().map(|end| {
                format!(
                    "contacts.csv ends at t = {end} {unit}: it has at most {} rows; sample less often\n",
                    limits::CONTACT_ROWS
                )
            }),
        }
    }
}

/// The energy's change, the works that made it, and what is left: the integrator's defect, and with
/// impacts and friction what they took.
fn budget(run: &Run) -> Option<Table> {
    let (works, scene) = (run.works(), run.scene());
    if works.is_empty() || scene.heat().is_some() {
        return None;
    }
    let mut table =
        Table::new([Column::exact("energy's budget"), Column::rounded("work", DIGITS, 0.0)]);
    let energies = run.energies();
    let change = energies.last().copied().unwrap_or_default() - energies.first().copied()?;
    let kinetic = run.kinetic_energies().iter().copied().fold(0.0, f64::max);
    let scale = works.iter().fold(kinetic, |scale, (_, work)| scale.max(work.abs()));
    let left = works.iter().fold(change, |left, (_, work)| left - work);
    for (name, work) in works {
        table.push([name.into(), above_rounding(work, scale)]);
    }
    let rest = match scene.contact() {
        Some(_) if scene.chooses_contact_steps() => "error of the chosen steps".to_owned(),
        _ if scene.has_inequalities() => "defect of the steps, of order 1".to_owned(),
        Some(_) => format!("impacts, and the defect of {}", scene.stepping()),
        None => format!("defect of {}", scene.stepping()),
    };
    let left = match left.abs() / scale {
        _ if scale == 0.0 => "0".to_owned(),
        // Its digits are those of rounding.
        part if part < ROUNDING => format!("<{ROUNDING:.0e} of the largest"),
        part => format!("{part:.0e} of the largest"),
    };
    table.push([rest.into(), left.into()]);
    table.push(["change of the energy".into(), above_rounding(change, scale)]);
    Some(table)
}

/// Each claim with what the run says of it.
fn claims(run: &Run) -> Option<Table> {
    let answers = run.claims();
    if answers.is_empty() {
        return None;
    }
    let mut table = Table::new([
        Column::exact("claim"),
        Column::rounded("said", DIGITS + 1, 0.0),
        Column::rounded("within", 2, 0.0),
        Column::rounded("measured", DIGITS, 0.0),
        Column::exact("verdict"),
        Column::exact("source"),
    ]);
    let (headings, unit) = (run.headings(), &run.scene().units().time);
    let size = |column: usize| {
        let all = (0..run.times().len()).map(|i| run.observed(i)[column].abs());
        all.fold(0.0, f64::max)
    };
    for answer in answers {
        let claim = answer.claim;
        let (what, scale) = match &claim.of {
            &Measured::Value { column, time } => {
                (format!("{} at {time} {unit}", headings[column]), size(column))
            }
            &Measured::Least { column } => (format!("least {}", headings[column]), size(column)),
            &Measured::Largest { column } => {
                (format!("largest {}", headings[column]), size(column))
            }
            &Measured::Rise { column } => (format!("rise of {}", headings[column]), size(column)),
            Measured::Drift { columns, over } => {
                let name = headings.get(columns.start).map_or("", String::as_str);
                let name = if columns.len() > 1 {
                    name.replacen(" x [", " [", 1)
                } else {
                    name.to_owned()
                };
                match over {
                    Scale::One => {
                        (format!("drift of {name}"), columns.clone().map(size).fold(0.0, f64::max))
                    }
                    _ => (format!("relative drift of {name}"), 1.0),
                }
            }
            Measured::Time(Event::FirstImpact) => (format!("first impact [{unit}]"), claim.until),
            Measured::Time(Event::FirstBreak) => {
                (format!("first rod breaks [{unit}]"), claim.until)
            }
        };
        let scale = scale.max(claim.is.abs());
        let measured = match answer.measured {
            // Where nothing is claimed, what is far within the band may be rounding alone.
            Some(measured) if claim.is == 0.0 && measured.abs() < claim.within / 100.0 => {
                format!("<{:.0e}", claim.within / 100.0).into()
            }
            Some(measured) => above_rounding(measured, scale),
            None => "".into(),
        };
        let verdict = match answer.verdict {
            Verdict::Holds => "holds",
            Verdict::DoesNotHold => "does not hold",
            Verdict::NotReached => "not reached",
        };
        table.push([
            what.into(),
            claim.is.into(),
            claim.within.into(),
            measured,
            verdict.into(),
            claim.source.as_str().into(),
        ]);
    }
    Some(table)
}

fn unsettled(run: &Run) -> String {
    let (found, units) = (run.unsettled(), run.scene().units());
    let missed = match found.residual {
        0.0 => String::new(),
        residual => format!(", by at most {residual:.0e} {}", units.velocity()),
    };
    format!("contact: {} of {} steps are not settled{missed}\n", found.steps, run.cost().steps)
}

/// Rounding decides where a step is long enough: the counts have one digit.
fn chosen(run: &Run) -> String {
    let ChosenSteps { accepted, rejected } = run.chosen_steps();
    format!(
        "contact: about {:.0e} steps chosen by their error, {:.0e} rejected\n",
        accepted as f64, rejected as f64
    )
}

fn lasting(run: &Run) -> String {
    let (LastingContact { steps, time }, unit) = (run.lasting_contact(), &run.scene().units().time);
    format!(
        "contact lasted in {steps} of {} steps, for {time:.2} {unit} in all: there the order is 1, at a {}th of \
         the step\n",
        run.cost().steps,
        CONTACT_STEPS,
    )
}

/// Counts of an explicit method are exact; those of an implicit one depend on when rounding ends
/// Newton's method.
fn cost(run: &Run) -> Table {
    let scene = run.scene();
    let pinned = scene.particles().iter().filter(|p| p.motion == Motion::Pinned).count();
    let implicit = scene.stepping().evaluation() == Evaluation::Implicit;
    let counted = |name| if implicit { Column::rounded(name, 1, 0.0) } else { Column::exact(name) };
    let count = |n: u64| if implicit { Cell::Number(n as f64) } else { Cell::Count(n) };
    if let Some(body) = scene.heat() {
        let mut table = Table::new([
            Column::exact("vertices"),
            Column::exact("simplices"),
            Column::exact("held"),
            Column::exact("freedoms"),
        ]);
        table.push([
            (body.start.len() as u64).into(),
            (body.simplices.len() as u64).into(),
            (body.held.iter().filter(|&&held| held).count() as u64).into(),
            (scene.freedoms() as u64).into(),
        ]);
        return table;
    }
    if !scene.bodies().is_empty() {
        let rigid = scene.rigid_bodies();
        let of = |name, number: usize| (Column::exact(name), Cell::from(number as u64));
        let mut columns = vec![of("bodies", rigid), of("joints", scene.joints().len())];
        // Only what is there beside them.
        let beside = [
            ("particles", scene.bodies().len() - rigid + pinned),
            ("pinned", pinned),
            ("springs", scene.links().len()),
            ("rods", scene.rods().len()),
        ];
        columns.extend(beside.iter().filter(|(_, n)| *n > 0).map(|&(name, n)| of(name, n)));
        columns.push(of("freedoms", scene.freedoms()));
        columns.push((counted("differentials"), count(run.cost().differentials)));
        let (headings, cells): (Vec<Column>, Vec<Cell>) = columns.into_iter().unzip();
        let mut table = Table::new(headings);
        table.push(cells);
        return table;
    }
    let mut table = Table::new([
        Column::exact("particles"),
        Column::exact("pinned"),
        Column::exact("springs"),
        Column::exact("rods"),
        Column::exact("elements"),
        Column::exact("freedoms"),
        counted("differentials"),
        counted("hessians"),
    ]);
    table.push([
        (scene.particles().len() as u64).into(),
        (pinned as u64).into(),
        (scene.links().len() as u64).into(),
        (scene.rods().len() as u64).into(),
        (scene.solids().iter().map(|solid| solid.simplices.len() as u64).sum::<u64>()).into(),
        (scene.freedoms() as u64).into(),
        count(run.cost().differentials),
        count(run.cost().hessians),
    ]);
    table
}

/// Heat, the Dirichlet energy and the extreme temperatures: the first is kept where nothing is held,
/// the second falls, and the last two draw together.
fn heat_invariants(run: &Run, held: bool) -> Table {
    let mut table = Table::new([
        Column::exact("quantity"),
        Column::rounded("at the start", 5, 0.0),
        Column::rounded("at the end", 5, 0.0),
        Column::rounded("largest drift", 2, ROUNDING),
        Column::exact("relative to"),
    ]);
    let last = run.times().len().saturating_sub(1);
    let (heat, energy) = (&run.samples.heat, &run.samples.potential);
    let extreme = |sample: usize, of: fn(f64, f64) -> f64, from: f64| {
        run.temperatures(sample).iter().copied().fold(from, of)
    };
    let least = [0, last].map(|sample| extreme(sample, f64::min, f64::INFINITY));
    let largest = [0, last].map(|sample| extreme(sample, f64::max, f64::NEG_INFINITY));
    let scale = heat.iter().fold(0.0_f64, |scale, heat| scale.max(heat.abs()));
    let drift = heat.iter().map(|now| (now - heat[0]).abs()).fold(0.0, f64::max);
    let (drift, why) = if held {
        (Cell::from(""), "changed by what is held")
    } else {
        (relative(drift, scale), "the most heat")
    };
    table.push([
        "heat".into(),
        above_rounding(heat[0], scale),
        above_rounding(heat[last], scale),
        drift,
        why.into(),
    ]);
    let rows = [
        ("Dirichlet energy", [energy[0], energy[last]], energy[0].abs()),
        ("least temperature", least, largest[0].abs().max(least[0].abs())),
        ("largest temperature", largest, largest[0].abs().max(least[0].abs())),
    ];
    for (name, [start, end], scale) in rows {
        let [start, end] = [start, end].map(|x| above_rounding(x, scale));
        table.push([name.into(), start, end, "".into(), "".into()]);
    }
    table
}

fn invariants(run: &Run) -> Table {
    if let Some(body) = run.scene().heat() {
        return heat_invariants(run, body.held.contains(&true));
    }
    let units = run.scene().units();
    let mut table = Table::new([
        Column::exact("invariant"),
        Column::rounded("at the start", 5, 0.0),
        Column::rounded("at the end", 5, 0.0),
        Column::rounded("largest drift", 2, ROUNDING),
        Column::exact("relative to"),
    ]);
    let energies = run.energies();
    let kinetic = run.kinetic_energies().iter().copied().fold(0.0, f64::max);
    let start = energies.first().copied().unwrap_or_default();
    let end = energies.last().copied().unwrap_or_default();
    let scale = if kinetic > 0.0 { kinetic } else { start.abs() };
    let drift = energies.iter().map(|energy| (energy - start).abs()).fold(0.0, f64::max);
    table.push([
        format!("energy [{}]", units.energy()).into(),
        above_rounding(start, scale),
        above_rounding(end, scale),
        relative(drift, scale),
        "the largest kinetic energy".into(),
    ]);

    let gravity = run.scene().gravity().acceleration.is_some_and(|g| g != [0.0; 3]);
    let pinned = run.scene().particles().iter().any(|p| p.motion == Motion::Pinned);
    let held = run.scene().joints().iter().any(|joint| joint.between.contains(&None));
    let external = match (gravity, pinned, held) {
        (false, false, false) => None,
        (true, false, false) => Some("changed by gravity"),
        (false, true, _) => Some("changed by the pins"),
        (true, true, _) => Some("changed by gravity and the pins"),
        (false, false, true) => Some("changed by the joints"),
        (true, false, true) => Some("changed by gravity and the joints"),
    };
    let samples = &run.samples;
    let momenta = [
        ("linear momentum", units.momentum(), &samples.linear, samples.linear_scale, "sum |p|"),
        (
            "angular momentum",
            units.angular_momentum(),
            &samples.angular,
            samples.angular_scale,
            "sum |q| |p|",
        ),
    ];
    // On a line nothing turns.
    let shown = if run.scene().dimension() == 1 { 1 } else { 2 };
    for (name, unit, momenta, scale, relative_to) in momenta.into_iter().take(shown) {
        let [start, end] =
            [momenta.first(), momenta.last()].map(|p| p.copied().unwrap_or_default());
        let drift = momenta.iter().map(|p| norm(array(|c| p[c] - start[c])));
        let (drift, relative_to) = match external {
            Some(reason) => (Cell::from(""), reason),
            None => (relative(drift.fold(0.0, f64::max), scale), relative_to),
        };
        table.push([
            format!("{name} [{unit}]").into(),
            above_rounding(norm(start), scale),
            above_rounding(norm(end), scale),
            drift,
            relative_to.into(),
        ]);
    }
    table
}

/// Digits of an observable, chosen so that the error of rounding at the end of a long run does not
/// reach them.
const DIGITS: usize = 4;

fn observables(run: &Run) -> Table {
    let mut table = Table::new([
        Column::exact("observable"),
        Column::rounded("at the start", DIGITS, 0.0),
        Column::rounded("at the end", DIGITS, 0.0),
        Column::rounded("least", DIGITS, 0.0),
        Column::rounded("largest", DIGITS, 0.0),
    ]);
    let last = run.times().len().saturating_sub(1);
    let at = |sample: usize, column: usize| {
        run.observed(sample).get(column).copied().unwrap_or_default()
    };
    let mut column = 0;
    for observable in run.scene().observables() {
        let headings = observable.headings(run.scene());
        let columns = column..column + headings.len();
        column = columns.end;
        let all = (0..=last).flat_map(|i| columns.clone().map(move |j| at(i, j).abs()));
        let scale = match observable {
            Observable::LinearMomentum => run.samples.linear_scale,
            Observable::AngularMomentum => run.samples.angular_scale,
            // A place that stays is at zero to the rounding of the whole scene.
            Observable::Position(_) => all.fold(run.scene().scale(), f64::max),
            _ => all.fold(0.0, f64::max),
        };
        for (heading, j) in headings.into_iter().zip(columns) {
            let values = || (0..=last).map(|i| at(i, j));
            table.push([
                heading.into(),
                above_rounding(at(0, j), scale),
                above_rounding(at(last, j), scale),
                above_rounding(values().fold(f64::INFINITY, f64::min), scale),
                above_rounding(values().fold(f64::NEG_INFINITY, f64::max), scale),
            ]);
        }
    }
    table
}

/// A number, or the word zero where only rounding keeps it from that.
fn above_rounding(x: f64, scale: f64) -> Cell {
    if x.abs() <= ROUNDING * scale { "0".into() } else { x.into() }
}

fn relative(drift: f64, scale: f64) -> Cell {
    (if scale > 0.0 { drift / scale } else { drift }).into()
}

fn norm(x: [f64; 3]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}\n\n{}\n{}", self.title, self.cost, self.invariants)?;
        let notes = [&self.unsettled, &self.lasting, &self.chosen, &self.left_out];
        write!(f, "{}", self.observables)?;
        if let Some(budget) = &self.budget {
            write!(f, "\n{budget}")?;
        }
        if let Some(claims) = &self.claims {
            write!(f, "\n{claims}")?;
        }
        notes.into_iter().flatten().try_for_each(|note| f.write_str(note))
    }
}
