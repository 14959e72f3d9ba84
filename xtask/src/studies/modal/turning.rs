//! How far a beam may swing before its modes leave it, and what modal derivatives add.

use stationary_calculus::{
    Covector, DiagonalMetric, Metric, MetricError, Potential, SizeError, System, Vector,
};
use stationary_chart::{Axis, Lines, Series};
use stationary_elasticity::{
    ElasticityError, Freedoms, Lame, QuadraticTriangle, SaintVenantKirchhoff, Solid, lumped_mass,
};
use stationary_integrators::{Integrator, State, StepError, StormerVerlet};
use stationary_measure::{Column, Table, loglog_slope};
use stationary_mesh::{Diagonals, MeshError, QuadraticTriangles, rectangle};
use stationary_modal::{Linearized, ModalError, Motion, RigidMotions, Subspace};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Error of three reductions against the amplitude.
pub const STUDY: Entry<'static> = Entry {
    id: "modal-derivatives",
    krate: "modal",
    chapter: "14.3",
    kind: Kind::Ladder,
    title: "Swinging beam: error of modes and of their derivatives against the amplitude",
    tested: Tested::Claims,
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
    Metric(#[from] MetricError),
    #[error(transparent)]
    Size(#[from] SizeError),
    #[error(transparent)]
    Step(#[from] StepError),
}

const LENGTH: f64 = 10.0;
/// Modes whose derivatives are taken: 2 + 3 columns.
const BENT: usize = 2;
const STRAIGHT: usize = BENT + BENT * (BENT + 1) / 2;
const NAMES: [&str; 3] =
    ["5 modes, closed form", "5 modes, true energy", "2 modes and 3 derivatives"];

struct Beam {
    solid: Solid<SaintVenantKirchhoff<2>, 6, 2, 2, 3>,
    metric: DiagonalMetric<Vec<f64>>,
    q: Vec<f64>,
    tip: [usize; 2],
}

/// Where the tip is, at some times.
type Path = Vec<[f64; 2]>;

impl Beam {
    fn new() -> Result<Self, Failed> {
        let mesh = rectangle([LENGTH, 1.0], [10, 1], Diagonals::Alternating)?;
        let mesh = QuadraticTriangles::straight(&mesh);
        let nodes: Vec<[f64; 2]> = mesh.nodes().iter().map(|x| (*x).into()).collect();
        let freedoms = Freedoms::held_where(&nodes, |x, _| x[0] == 0.0)?;
        let tip = nodes.iter().position(|x| *x == [LENGTH, 0.5]).unwrap_or(0);
        let rubber =
            SaintVenantKirchhoff::new(Lame::<3>::from_young_poisson(1.0, 0.3)?.plane_stress());
        Ok(Beam {
            metric: lumped_mass(QuadraticTriangle, &mesh, [1.0, 1.0], &freedoms)?,
            q: freedoms.gathered(&nodes)?,
            tip: freedoms.of(tip),
            solid: Solid::new(QuadraticTriangle, &mesh, 1.0, rubber, freedoms)?,
        })
    }

    /// The motion of the whole body from rest with a momentum.
    fn whole(&self, p: &[f64], times: Times) -> Result<Path, Failed> {
        let system = System::new(self.metric.clone(), &self.solid)?;
        let mut verlet = StormerVerlet::new(&system)?;
        let mut state = State::new(self.q.clone(), Covector(p.to_vec()));
        let mut path = Path::new();
        for _ in 0..times.frames {
            for _ in 0..times.steps {
                verlet.step(&mut state, times.step)?;
            }
            path.push(self.tip.map(|freedom| state.q[freedom]));
        }
        Ok(path)
    }

    /// The same on a subspace.
    fn within<P: Potential>(
        &self,
        subspace: &Subspace<'_, P>,
        p: &[f64],
        times: Times,
    ) -> Result<Path, Failed> {
        let unit = DiagonalMetric::new(vec![1.0; subspace.dim()])?;
        let system = System::new(unit, subspace)?;
        let mut verlet = StormerVerlet::new(&system)?;
        let p = subspace.pulled_back(Covector(p))?;
        let mut state = State::new(vec![0.0; subspace.dim()], p);
        let (mut path, mut q) = (Path::new(), self.q.clone());
        for _ in 0..times.frames {
            for _ in 0..times.steps {
                verlet.step(&mut state, times.step)?;
            }
            subspace.configuration(&state.q, &mut q)?;
            path.push(self.tip.map(|freedom| q[freedom]));
        }
        Ok(path)
    }
}

/// When to look, and the steps between.
#[derive(Clone, Copy)]
struct Times {
    frames: usize,
    steps: usize,
    step: f64,
}

/// The largest distance of two paths, relative to the amplitude.
fn error(path: &Path, exact: &Path, amplitude: f64) -> f64 {
    let off = |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]).hypot(a[1] - b[1]);
    path.iter().zip(exact).map(off).fold(0.0, f64::max) / amplitude
}

/// Amplitudes over the length, each with the errors of the three.
fn errors(beam: &Beam) -> Result<Vec<(f64, [f64; 3])>, Failed> {
    let mut near_rest = Linearized::at(&beam.metric, &beam.solid, &beam.q, 1e-10)?;
    let modes = near_rest.lowest(STRAIGHT, &RigidMotions::none())?;
    let mut few = modes.clone();
    few.truncate(BENT);
    let line = near_rest.subspace(&modes)?;
    let bent = near_rest.subspace_with_derivatives(&few, 0.01)?;
    let omega = modes.values()[0].sqrt();
    let half = std::f64::consts::PI / omega;
    let (frames, step) = (40, 0.05);
    let steps = (half / (frames as f64 * step)).ceil() as usize;
    let times = Times { frames, steps, step: half / (frames * steps) as f64 };
    let shape = modes.vector(0).map_or(&[][..], |v| v.0);
    let mut found = Vec::new();
    for k in 0..7 {
        let part = 0.4 * 0.5_f64.powi(k);
        let scale = omega * part * LENGTH / shape[beam.tip[1]].abs();
        let v: Vec<f64> = shape.iter().map(|x| scale * x).collect();
        let mut p = Covector(vec![0.0; v.len()]);
        beam.metric.flat(Vector(&v), p.view_mut());
        let exact = beam.whole(&p.0, times)?;
        let rest = vec![0.0; v.len()];
        let motion = Motion::new(&modes, near_rest.mass(), Vector(&rest), Vector(&v))?;
        let (mut d, mut rate) = (Vector(rest.clone()), Vector(rest.clone()));
        let mut linear = Path::new();
        for frame in 1..=frames {
            motion.at(half * frame as f64 / frames as f64, d.view_mut(), rate.view_mut())?;
            linear.push(beam.tip.map(|freedom| beam.q[freedom] + d.0[freedom]));
        }
        let paths = [linear, beam.within(&line, &p.0, times)?, beam.within(&bent, &p.0, times)?];
        found.push((part, paths.map(|path| error(&path, &exact, part * LENGTH))));
    }
    Ok(found)
}

fn study(_: Size) -> Result<Study, StudyError> {
    let beam = Beam::new().map_err(StudyError::at("the beam"))?;
    let found = errors(&beam).map_err(StudyError::at("its motion"))?;
    let mut table = Table::new([
        Column::rounded("amplitude / length", 3, 0.0),
        Column::rounded(NAMES[0], 3, 1e-7),
        Column::rounded(NAMES[1], 3, 1e-7),
        Column::rounded(NAMES[2], 3, 1e-7),
    ]);
    let of = |which: usize| -> Vec<(f64, f64)> {
        found.iter().map(|(part, errors)| (*part, errors[which])).collect()
    };
    let mut chart = Lines::new(
        "",
        Axis::log("amplitude of the tip / length", ""),
        Axis::log("error of the tip / amplitude", ""),
    );
    for (which, name) in NAMES.iter().enumerate() {
        chart = chart.with(Series::new(name, of(which)));
    }
    for &(part, [a, b, c]) in &found {
        table.push([part.into(), a.into(), b.into(), c.into()]);
    }
    // The largest amplitude that was tried within a tenth.
    let within = |which: usize| {
        let good = found.iter().filter(|(_, errors)| errors[which] <= 0.1);
        good.map(|(part, _)| *part).fold(0.0, f64::max)
    };
    let small = |which: usize| loglog_slope(&of(which)[3..]).unwrap_or(f64::NAN);
    let tenth = found[2].1;
    let factors = found.iter().map(|(_, errors)| errors[0] / errors[2]);
    let closer = factors.fold(f64::INFINITY, f64::min);
    let farthest = found.first().map_or(f64::NAN, |(_, errors)| 100.0 * errors[2]);
    Ok(Study {
        conclusion: format!(
            "A clamped sheet, ten times as long as high, starts at rest with the velocity of its lowest \
             mode and swings for half a period, against the whole body of {} freedoms with large turns. \
             Five linear modes leave the tip in proportion to the amplitude, because they do not bring \
             it back along its arc: within a tenth up to {:.2} of the length. The true energy in the \
             span of the same modes is worse and not better: where the tip cannot come back, the \
             beam must stretch. Two modes with their three derivatives, also five numbers, follow the arc: \
             they are within {:.1} % even at {:.2} of the length.",
            beam.q.len(),
            within(0),
            farthest,
            within(2)
        ),
        table,
        charts: vec![chart.slope(1.0, (0.03, 0.03)).into()],
        claims: vec![
            Claim::number(
                "closed form: the relative error grows with a power of the amplitude",
                "1: the arc that straight lines lack",
                small(0),
                (0.9, 1.2),
            ),
            Claim::number(
                "the least factor by which derivatives come closer than the closed form",
                "more than 30",
                closer,
                (30.0, 1e4),
            ),
            Claim::number(
                "at a tenth of the length, error of the true energy on modes over that with derivatives",
                "more than 10",
                tenth[1] / tenth[2],
                (10.0, 1e4),
            ),
        ],
        ..STUDY.heading()
    })
}
