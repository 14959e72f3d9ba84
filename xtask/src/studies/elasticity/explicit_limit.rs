//! How large an explicit step may be: predicted from the mesh and the material, and measured.

use stationary_calculus::{
    Covector, DiagonalMetric, Metric, Potential, ProductSink, SizeError, System, Vector,
};
use stationary_chart::{Axis, Lines, Mark, Series};
use stationary_elasticity::{
    ElasticityError, Elements, Freedoms, Lame, LinearTriangle, SaintVenantKirchhoff, Solid,
    lumped_mass,
};
use stationary_integrators::{Integrator, State, StormerVerlet};
use stationary_measure::{Column, SplitMix64, Table, loglog_slope};
use stationary_mesh::{Diagonals, rectangle};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// The largest stable step against the size of the triangles, for three stiffnesses.
pub const STUDY: Entry<'static> = Entry {
    id: "explicit-limit",
    krate: "elasticity",
    chapter: "4.2",
    kind: Kind::Limit,
    title: "Square of rubber: largest explicit step against the smallest triangle",
    tested: Tested::ByReport,
    run: &study,
};

type Sheet = System<DiagonalMetric<Vec<f64>>, Solid<SaintVenantKirchhoff<2>, 3, 2, 2, 1>>;

/// A free square of rubber of density one, and where it rests.
fn sheet(cells: usize, lame: Lame<2>) -> Result<(Sheet, Vec<f64>), StudyError> {
    let mesh = rectangle([1.0, 1.0], [cells; 2], Diagonals::Alternating);
    let mesh = mesh.map_err(StudyError::at("a square"))?;
    let body = || {
        let freedoms = Freedoms::<2>::free(mesh.vertices().len())?;
        let metric = lumped_mass(LinearTriangle, &mesh, [1.0, 1.0], &freedoms)?;
        let rubber = SaintVenantKirchhoff::new(lame);
        Ok((metric, Solid::new(LinearTriangle, &mesh, 1.0, rubber, freedoms)?))
    };
    let (metric, solid) = body().map_err(StudyError::at::<ElasticityError>("a sheet"))?;
    let system = System::new(metric, solid).map_err(StudyError::at("a sheet"))?;
    Ok((system, mesh.nodes().into_flattened()))
}

/// `2 / omega` of the fastest mode, by power iteration on M^-1 K.
fn predicted(sheet: &Sheet, rest: &[f64]) -> f64 {
    let (metric, mut random) = (sheet.metric(), SplitMix64::new(1));
    let mut v: Vec<f64> = rest.iter().map(|_| random.symmetric()).collect();
    let mut square = 0.0;
    for _ in 0..300 {
        let mut f = vec![0.0; v.len()];
        if let Some(mut sink) = ProductSink::new(1.0, &v, &mut f) {
            sheet.potential().add_hessian(rest, &mut sink);
        }
        let energy = Covector(&f[..]).apply(&Vector(&v[..]));
        square = energy / metric.inner(Vector(&v), Vector(&v));
        metric.sharp(Covector(&f), Vector(&mut v));
        let size = v.iter().fold(0.0, |size: f64, v| size.max(v.abs()));
        v.iter_mut().for_each(|v| *v /= size);
    }
    2.0 / square.sqrt()
}

/// How far the sheet is disturbed, and how far it may go, in sides of the square.
const DISTURBED: f64 = 1e-9;
const LOST: f64 = 1e-6;

/// Whether a small disturbance stays small at this step.
fn survives(sheet: &Sheet, rest: &[f64], h: f64) -> Result<bool, SizeError> {
    let mut random = SplitMix64::new(2);
    let q: Vec<f64> = rest.iter().map(|q| q + DISTURBED * random.symmetric()).collect();
    let mut state = State::new(q, Covector(vec![0.0; rest.len()]));
    let mut method = StormerVerlet::new(sheet)?;
    for _ in 0..1000 {
        let stepped = method.step(&mut state, h).is_ok();
        if !stepped || state.q.iter().zip(rest).any(|(q, x)| (q - x).abs() > LOST) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// The largest step that survives, by bisection around a guess.
fn measured(sheet: &Sheet, rest: &[f64], guess: f64) -> Result<f64, SizeError> {
    let (mut low, mut high) = (0.9 * guess, 1.1 * guess);
    for _ in 0..6 {
        let middle = 0.5 * (low + high);
        if survives(sheet, rest, middle)? {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(0.5 * (low + high))
}

fn study(size: Size) -> Result<Study, StudyError> {
    let finest = if size == Size::Full { 64 } else { 16 };
    let mut table = Table::new([
        Column::exact("Young's modulus [Pa]"),
        Column::exact("cells"),
        Column::rounded("altitude / speed of sound [s]", 3, 0.0),
        Column::rounded("2 / omega [s]", 3, 0.0),
        Column::rounded("measured limit [s]", 2, 0.0),
    ]);
    let mut chart = Lines::new(
        "",
        Axis::log("shortest altitude / speed of sound", "s"),
        Axis::log("largest stable step", "s"),
    );
    let (mut worst, mut all) = (0.0_f64, Vec::new());
    for young in [1e2, 1e4, 1e6] {
        let lame = Lame::<3>::from_young_poisson(young, 0.3)
            .map_err(StudyError::at("the material"))?
            .plane_strain();
        let mut points = Vec::new();
        let mut cells = 2;
        while cells <= finest {
            let (sheet, rest) = sheet(cells, lame)?;
            let altitude = 0.5_f64.sqrt() / cells as f64;
            let crossing = altitude / (lame.lambda() + 2.0 * lame.mu()).sqrt();
            let predicted = predicted(&sheet, &rest);
            let measured =
                measured(&sheet, &rest, predicted).map_err(StudyError::at("its steps"))?;
            worst = worst.max((measured / predicted - 1.0).abs());
            table.push([
                young.into(),
                (cells as u64).into(),
                crossing.into(),
                predicted.into(),
                measured.into(),
            ]);
            points.push((crossing, measured));
            cells *= 2;
        }
        all.extend(points.iter().copied());
        chart = chart
            .with(Series::new(&format!("E = {young:e} Pa"), points).marked(Mark::LineAndMarkers));
    }
    let slope = loglog_slope(&all).unwrap_or(f64::NAN);
    let shares: Vec<f64> = all.iter().map(|(crossing, limit)| limit / crossing).collect();
    let (least, most) =
        shares.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), &x| (a.min(x), b.max(x)));
    Ok(Study {
        conclusion: format!(
            "Stormer-Verlet on a square of rubber with lumped mass, disturbed by {DISTURBED:e} of \
             its side and given up when it moves by {LOST:e}. The largest step that survives is \
             2/omega of the fastest mode, which is always one of a few triangles and goes with \
             their size and with the root of density over stiffness: between {least:.2} and \
             {most:.2} times the shortest altitude over the speed of pressure waves. A mesh twice \
             as fine, or a material four times as stiff, takes twice the steps, and one flat \
             triangle sets the step of the whole: where that is far shorter than the motion asks \
             for, implicit steps pay."
        ),
        table,
        charts: vec![chart.into()],
        claims: vec![
            Claim::number(
                "the largest gap between the measured limit and 2/omega",
                "below 2 %, what the bisection resolves",
                worst,
                (0.0, 0.02),
            ),
            Claim::number(
                "order of the limit in altitude over speed, all stiffnesses together",
                "1",
                slope,
                (0.97, 1.03),
            ),
        ],
        ..STUDY.heading()
    })
}
