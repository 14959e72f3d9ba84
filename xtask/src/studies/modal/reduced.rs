//! A reduced body beside the whole one, stepped implicitly.

use std::time::Instant;

use stationary_calculus::{Covector, DiagonalMetric, SparseSolver, System, Vector};
use stationary_chart::{Axis, Lines, Series};
use stationary_elasticity::problems::{Ends, vibrating_beam};
use stationary_elasticity::{DeadLoad, ElasticityError, Linear, QuadraticTriangle, Solid};
use stationary_integrators::{ImplicitMidpoint, Integrator, State, StepError};
use stationary_measure::{Column, Table, loglog_slope};
use stationary_mesh::{Diagonals, MeshError, QuadraticTriangles, rectangle};
use stationary_modal::{Answer, Linearized, ModalError, Modes, Reduced, RigidMotions};

use crate::studies::cheapest::part;
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Error of a beam's tip against modes and against multiplications.
pub const STUDY: Entry<'static> = Entry {
    id: "reduced-beam",
    krate: "modal",
    chapter: "14.3",
    kind: Kind::WorkPrecision,
    title: "Pushed beam: error against cost, of few modes and of implicit steps",
    tested: Tested::ByReport,
    run: &study,
};

#[derive(Debug, thiserror::Error)]
enum Failed {
    #[error(transparent)]
    Mesh(#[from] MeshError),
    #[error(transparent)]
    Elasticity(#[from] ElasticityError),
    #[error(transparent)]
    Modal(#[from] ModalError),
    #[error(transparent)]
    Size(#[from] stationary_calculus::SizeError),
    #[error(transparent)]
    Sparse(#[from] stationary_calculus::SparseError),
    #[error(transparent)]
    Step(#[from] StepError),
}

/// Frames of the motion, over two periods of the lowest mode.
const FRAMES: usize = 100;
const COUNTS: [usize; 9] = [1, 2, 3, 5, 8, 13, 21, 34, 55];

/// A clamped sheet, pushed at its tip from the first moment on.
struct Scene {
    solid: Solid<Linear<2>, 6, 2, 2, 3>,
    metric: DiagonalMetric<Vec<f64>>,
    load: DeadLoad<2>,
    force: Vec<f64>,
    q: Vec<f64>,
    /// The freedom that is looked at.
    tip: usize,
}

impl Scene {
    fn new(across: usize) -> Result<Self, Failed> {
        let size = [8.0, 1.0];
        let mesh = rectangle(size, [8 * across, across], Diagonals::Alternating)?;
        let mesh = QuadraticTriangles::straight(&mesh);
        let body = vibrating_beam(QuadraticTriangle, &mesh, Ends::Clamped)?;
        let freedoms = body.solid.freedoms().clone();
        let corner = mesh.nodes().iter().position(|x| x.x == size[0] && x.y == size[1]);
        let corner = corner.unwrap_or(0);
        let mut forces = vec![[0.0; 2]; mesh.nodes().len()];
        forces[corner] = [0.0, -1e-4];
        let force = freedoms.gathered(&forces)?;
        let load = DeadLoad::new(&freedoms, forces)?;
        let tip = freedoms.of(corner)[1];
        Ok(Scene { solid: body.solid, metric: body.lumped, load, force, q: body.q, tip })
    }

    /// Where the tip is in each frame, by these modes.
    fn by_modes(&self, modes: &Modes, frame: f64) -> Result<Vec<f64>, Failed> {
        let mut body = Reduced::at_rest(modes);
        let mut d = Vector(vec![0.0; modes.dim()]);
        let mut tip = Vec::with_capacity(FRAMES);
        for _ in 0..FRAMES {
            body.step(frame, Covector(&self.force))?;
            body.displacement(d.view_mut())?;
            tip.push(d.0[self.tip]);
        }
        Ok(tip)
    }

    /// The same by implicit midpoint on all freedoms, in some steps a frame, and the multiplications
    /// of one step with a factor that is kept.
    fn by_steps(&self, frame: f64, steps: u32) -> Result<(Vec<f64>, f64), Failed> {
        let system = System::new(self.metric.clone(), (&self.solid, &self.load))?;
        let solver = SparseSolver::new(&self.metric, &(&self.solid, &self.load), &self.q)?;
        let entries = solver.cholesky().factor_len() + solver.matrix().values().len();
        let mut midpoint = ImplicitMidpoint::with_solver(&system, solver)?;
        let mut state = State::new(self.q.clone(), Covector(vec![0.0; self.q.len()]));
        let mut tip = Vec::with_capacity(FRAMES);
        for _ in 0..FRAMES {
            for _ in 0..steps {
                midpoint.step(&mut state, frame / f64::from(steps))?;
            }
            tip.push(state.q[self.tip] - self.q[self.tip]);
        }
        Ok((tip, 2.0 * entries as f64))
    }
}

fn largest(tip: &[f64]) -> f64 {
    tip.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()))
}

fn error(tip: &[f64], exact: &[f64]) -> f64 {
    let off = tip.iter().zip(exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    off / largest(exact)
}

/// What was measured: multiplications a frame, milliseconds in all, and the error of the tip.
struct Point {
    label: u64,
    work: f64,
    time: f64,
    error: f64,
}

/// All that the study shows.
struct Measured {
    freedoms: usize,
    answer: Answer,
    scale: f64,
    reduced: Vec<Point>,
    stepped: Vec<Point>,
}

fn measure(across: usize) -> Result<Measured, Failed> {
    let scene = Scene::new(across)?;
    let mut beam = Linearized::at(&scene.metric, &scene.solid, &scene.q, 1e-9)?;
    let all = beam.lowest(beam.dim(), &RigidMotions::none())?;
    let period = std::f64::consts::TAU / all.values()[0].sqrt();
    let frame = 2.0 * period / FRAMES as f64;
    let exact = scene.by_modes(&all, frame)?;
    let mut observable = vec![0.0; scene.q.len()];
    observable[scene.tip] = 1.0;
    let answer = beam.answer(&all, Covector(&scene.force), Covector(&observable))?;
    let mut reduced = Vec::new();
    for count in COUNTS {
        let start = Instant::now();
        let modes = beam.lowest(count, &RigidMotions::none())?;
        let tip = scene.by_modes(&modes, frame)?;
        reduced.push(Point {
            label: count as u64,
            // The force onto the modes, and the modes onto the body.
            work: 2.0 * (count * scene.q.len()) as f64,
            time: 1e3 * start.elapsed().as_secs_f64(),
            error: error(&tip, &exact),
        });
    }
    let mut stepped = Vec::new();
    for steps in [1, 2, 4, 8, 16] {
        let start = Instant::now();
        let (tip, step) = scene.by_steps(frame, steps)?;
        stepped.push(Point {
            label: u64::from(steps),
            work: f64::from(steps) * step,
            time: 1e3 * start.elapsed().as_secs_f64(),
            error: error(&tip, &exact),
        });
    }
    let scale = answer.whole.abs() / largest(&exact);
    Ok(Measured { freedoms: scene.q.len(), answer, scale, reduced, stepped })
}

fn study(size: Size) -> Result<Study, StudyError> {
    let across = match size {
        Size::Default => 2,
        Size::Full => 6,
    };
    let found = measure(across).map_err(StudyError::at("the beam"))?;
    let mut table = Table::new([
        Column::exact("method"),
        Column::exact("modes or steps a frame"),
        Column::rounded("multiplications a frame", 3, 0.0),
        Column::rounded("error of the tip", 3, 1e-12),
        Column::volatile("time with set-up [ms]"),
    ]);
    let names = ["lowest modes, exact steps", "whole body, implicit midpoint"];
    for (name, points) in names.iter().zip([&found.reduced, &found.stepped]) {
        for point in points {
            let Point { label, work, time, error } = *point;
            table.push([(*name).into(), label.into(), work.into(), error.into(), time.into()]);
        }
    }
    let bounds: Vec<(f64, f64)> =
        COUNTS.iter().map(|&n| (n as f64, found.answer.bounds[n] * found.scale)).collect();
    let measured: Vec<(f64, f64)> =
        found.reduced.iter().map(|point| (point.label as f64, point.error)).collect();
    let modes = Lines::new("By modes", Axis::log("modes", ""), Axis::log("error of the tip", ""))
        .with(Series::new("measured", measured.clone()))
        .with(Series::new("promised", bounds.clone()));
    let of = |points: &[Point]| -> Vec<(f64, f64)> {
        points.iter().map(|point| (point.work, point.error)).collect()
    };
    let work = Axis::log("multiplications a frame", "");
    let work = Lines::new("By work", work, Axis::log("error of the tip", ""))
        .with(Series::new(names[0], of(&found.reduced)))
        .with(Series::new(names[1], of(&found.stepped)));
    // The least work within a percent.
    let within = |points: &[Point]| {
        let good = points.iter().filter(|point| point.error <= 0.01);
        good.map(|point| point.work).fold(f64::INFINITY, f64::min)
    };
    let steps: Vec<_> =
        found.stepped.iter().map(|point| (1.0 / point.label as f64, point.error)).collect();
    let kept = measured.iter().zip(&bounds).all(|((_, error), (_, bound))| error <= bound);
    let least = found.answer.least_modes_in_motion(0.01 / found.scale);
    let first = COUNTS.iter().zip(&found.reduced).find(|(_, point)| point.error <= 0.01);
    let enough = first.map_or(f64::NAN, |(count, _)| *count as f64);
    let promised = least.map_or(f64::NAN, |least| least as f64);
    let vibration = crate::study::Answer {
        question: "Small vibrations of a solid, to one percent".into(),
        method: format!("{enough} modes"),
        figure: format!(
            "at {} of the multiplications of implicit midpoint",
            part(within(&found.reduced) / within(&found.stepped))
        ),
    };
    Ok(Study {
        answers: vec![vibration],
        conclusion: format!(
            "A clamped sheet of {} freedoms, pushed at a corner of its tip from the first moment on, over \
             two periods of its lowest mode in {FRAMES} frames, against all its modes. {enough} modes are \
             within a percent; {promised} promise it beforehand, from one solve and no motion. \
             The whole body in implicit steps must resolve what it shows, step by step, and pays for \
             its factor in each; modes are exact in time, and what they leave out is the load's, not \
             the step's. Finding them, once for any number of motions, is in the last column \
             and not in the chart; so is the factor.",
            found.freedoms
        ),
        table,
        charts: vec![modes.slope(-2.0, (10.0, 1e-2)).into(), work.mark_front().into()],
        claims: vec![
            Claim::words(
                "what the modes leave out of the motion stays below what was promised",
                "at every number of modes",
                if kept { "at every number of modes" } else { "not everywhere" },
            ),
            Claim::number("modes within a percent", "at most 8", enough, (1.0, 8.0)),
            Claim::number(
                "modes that promise it, over those that do it",
                "less than 10",
                promised / enough,
                (1.0, 10.0),
            ),
            Claim::number(
                "within a percent, the work of implicit steps over that of modes",
                "more than 3",
                within(&found.stepped) / within(&found.reduced),
                (3.0, 1e3),
            ),
            Claim::number(
                "implicit midpoint comes closer with a power of its step",
                "between 1 and 2: a load put on at once moves modes that no step resolves",
                loglog_slope(&steps[2..]).unwrap_or(f64::NAN),
                (0.8, 2.2),
            ),
        ],
        ..STUDY.heading()
    })
}
