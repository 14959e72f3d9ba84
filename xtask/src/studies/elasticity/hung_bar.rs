//! What a rest costs and how exact it is: a bar under its own weight, whose rest is known.

use stationary_calculus::{Covector, Metric, Newton, Vector};
use stationary_chart::{Axis, Lines, Series};
use stationary_elasticity::{
    DeadLoad, ElasticityError, Freedoms, Held, Lame, LinearSegment, SaintVenantKirchhoff, Solid,
    Statics, lumped_mass,
};
use stationary_measure::{Column, Table};
use stationary_mesh::bar;

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Error of a rest against Newton's steps and against the number of elements.
pub const STUDY: Entry<'static> = Entry {
    id: "hung-bar",
    krate: "elasticity",
    chapter: "4.4",
    kind: Kind::Limit,
    title: "Bar under its weight: error of its rest against Newton's steps and against elements",
    tested: Tested::Claims,
    run: &study,
};

/// A rest that was looked for.
struct Hung {
    iterations: u32,
    /// The largest distance from the rest, over the displacement of the end.
    error: f64,
    /// What the support misses of the weight, over it.
    missing: f64,
}

/// A bar of unit length and stiffness EA under a weight, until the residual is this part of the load's.
fn hung(weight: f64, cells: usize, steps: usize, part: f64) -> Result<Hung, ElasticityError> {
    let mesh = bar(1.0, cells)?;
    let freedoms = Freedoms::<1>::new(cells + 1, &[Held { vertex: 0, component: 0, place: 0.0 }])?;
    let pair = Lame::<3>::from_young_poisson(1.0, 0.3)?.uniaxial_stress();
    let metric = lumped_mass(LinearSegment, &mesh, [1.0, 1.0], &freedoms)?;
    let load = DeadLoad::body(LinearSegment, &mesh, 1.0, &freedoms, |_| [weight])?;
    let law = SaintVenantKirchhoff::new(pair);
    let mut solid = Solid::new(LinearSegment, &mesh, 1.0, law, freedoms.clone())?;
    let forces = freedoms.gathered(load.forces())?;
    let mut accelerations = vec![0.0; forces.len()];
    metric.sharp(Covector(&forces), Vector(&mut accelerations));
    let size = forces.iter().zip(&accelerations).map(|(f, a)| f * a).sum::<f64>().sqrt();
    let newton = Newton { tolerance: part * size, ..Statics::default().newton };
    let statics = Statics { steps, newton, ..Statics::default() };
    let places: Vec<[f64; 1]> = mesh.vertices().iter().map(|x| [x.x]).collect();
    let mut q = freedoms.gathered(&places)?;
    let rest = statics.solve(&mut solid, &load, &metric, &[0.0], &mut q)?;
    // Each element bears what hangs below its middle.
    let side = 1.0 / cells as f64;
    let (mut moved, mut off) = (0.0, 0.0_f64);
    for (i, x) in q.iter().enumerate() {
        moved += side * stretched(weight * (1.0 - side * (i as f64 + 0.5)));
        off = off.max((x - side * (i as f64 + 1.0) - moved).abs());
    }
    let missing = (rest.reactions[0] + weight).abs() / weight;
    Ok(Hung { iterations: rest.iterations(), error: off / moved, missing })
}

/// The strain e at which `1/2 e (1 + e) (2 + e)`, the force over EA, is this: Newton's method, from above.
fn stretched(force: f64) -> f64 {
    let mut e = force;
    for _ in 0..60 {
        let value = 0.5 * e * (1.0 + e) * (2.0 + e) - force;
        e -= value / (1.0 + 3.0 * e + 1.5 * e * e);
    }
    e
}

/// What the residual may be of the load's, from none of the way to rounding.
const PARTS: [f64; 8] = [0.5, 0.1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-9, 0.0];

fn study(_: Size) -> Result<Study, StudyError> {
    let mut table = Table::new([
        Column::exact("weight / EA"),
        Column::exact("elements"),
        Column::exact("load steps"),
        Column::rounded("residual / load", 1, 0.0),
        Column::exact("Newton steps"),
        Column::rounded("error", 2, 1e-12),
    ]);
    let mut by_steps =
        Lines::new("", Axis::log("Newton steps", ""), Axis::log("error / displacement", ""));
    let mut by_cells =
        Lines::new("", Axis::log("elements", ""), Axis::log("error / displacement", ""));
    let (mut missing, mut finishing, mut dearer) = (0.0_f64, 0, f64::INFINITY);
    let mut worst = [0.0_f64; 2];
    for (weight, name) in [(0.01, "weight 0.01"), (1.0, "weight 1"), (100.0, "weight 100")] {
        let mut to_rounding = [0; 2];
        for (k, steps) in [1, 4].into_iter().enumerate() {
            let mut curve = Vec::new();
            let mut nearly = 0;
            for part in PARTS {
                let rest = hung(weight, 100, steps, part).map_err(StudyError::at("the bar"))?;
                if part == 1e-3 {
                    nearly = rest.iterations;
                }
                table.push([
                    weight.into(),
                    100_u64.into(),
                    (steps as u64).into(),
                    part.into(),
                    u64::from(rest.iterations).into(),
                    rest.error.into(),
                ]);
                curve.push((f64::from(rest.iterations), rest.error.max(1e-17)));
                to_rounding[k] = rest.iterations;
            }
            if steps == 1 {
                finishing = finishing.max(to_rounding[0] - nearly);
            }
            let label = format!("{name}, {steps} load step{}", if steps == 1 { "" } else { "s" });
            by_steps = by_steps.with(Series::new(&label, curve));
        }
        dearer = dearer.min(f64::from(to_rounding[1]) / f64::from(to_rounding[0]));
        let mut curve = Vec::new();
        for cells in [10, 100, 1000, 10_000] {
            let rest = hung(weight, cells, 1, 0.0).map_err(StudyError::at("a long bar"))?;
            table.push([
                weight.into(),
                (cells as u64).into(),
                1_u64.into(),
                0.0.into(),
                u64::from(rest.iterations).into(),
                rest.error.into(),
            ]);
            missing = missing.max(rest.missing);
            worst[usize::from(cells > 100)] = worst[usize::from(cells > 100)].max(rest.error);
            curve.push((cells as f64, rest.error.max(1e-17)));
        }
        by_cells = by_cells.with(Series::new(name, curve));
    }
    Ok(Study {
        conclusion: format!(
            "A bar of unit stiffness EA hangs under its weight; each element bears what hangs below its \
             middle, so that the rest of the elements is known. From a residual of a thousandth of the load \
             Newton's method takes {finishing} steps or fewer to rounding. Load steps only cost: four take at \
             least {dearer:.1} times the Newton steps of one, because each is solved to the same tolerance. \
             At rounding a bar of up to a hundred elements is off by {:.0e} of its displacement, one of up to ten \
             thousand by {:.0e}.",
            worst[0], worst[1]
        ),
        table,
        charts: vec![by_steps.into(), by_cells.into()],
        claims: vec![
            Claim::number(
                "the error at rounding, over the displacement, of up to a hundred elements",
                "rounding: 1e-12 or less",
                worst[0],
                (0.0, 1e-12),
            ),
            Claim::number(
                "the error at rounding, over the displacement, of up to ten thousand elements",
                "rounding: 1e-9 or less; a thousandth is promised",
                worst[1],
                (0.0, 1e-9),
            ),
            Claim::number(
                "Newton steps from a residual of a thousandth of the load to rounding, at most",
                "4: quadratic convergence",
                f64::from(finishing),
                (1.0, 4.0),
            ),
            Claim::number(
                "Newton steps of four load steps over those of one, at least",
                "1 or more",
                dearer,
                (1.0, 8.0),
            ),
            Claim::number(
                "what the support misses of the weight, over it",
                "rounding",
                missing,
                (0.0, 1e-6),
            ),
        ],
        ..STUDY.heading()
    })
}
