//! Square frequencies of hanging links, from full coordinates: how many digits, for how many links and masses.

use std::hint::black_box;

use nalgebra::{DMatrix, Vector3};
use stationary_chart::{Axis, Lines, Series};
use stationary_measure::{Column, Table, loglog_slope};
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, Joint, JointEnd, JointKind, LieGroup, PointMass, Poses,
    RigidMotion, Rotation, Weight, linearize,
};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};
use crate::timing::median_wall;

/// Error against masses and links, and time against links.
pub const SMALL_MOTIONS: Entry<'static> = Entry {
    id: "small-motions",
    krate: "rigid",
    chapter: "14.2",
    kind: Kind::WorkPrecision,
    title: "Small motions of hanging links: digits of their frequencies against masses and links",
    tested: Tested::ByReport,
    run: &study,
};

/// Half a link, m, and how thick it is: half of both sides, m.
const HALF: f64 = 0.5;
const THICK: [f64; 2] = [0.02, 0.03];
const G: f64 = 9.81;
/// What is off by no more is shown there.
const FLOOR: f64 = 1e-16;
/// Powers of ten by which the lower link is lighter and heavier, at most.
const DECADES: i32 = 24;

/// The moment of a link about its centre, kg m^2.
fn moment(mass: f64) -> f64 {
    mass / 3.0 * (HALF * HALF + THICK[0] * THICK[0])
}

/// Ascending square frequencies of links that hang from one another, by `linearize`.
fn full(masses: &[f64]) -> Result<Vec<f64>, StudyError> {
    let n = masses.len();
    let (z, at) = (Vector3::z(), || StudyError::at("the links"));
    let (mut bodies, mut joints, mut motions, mut points) = (vec![], vec![], vec![], vec![]);
    for (k, &mass) in masses.iter().enumerate() {
        bodies.push(Body::solid_box(mass, [THICK[0], THICK[1], HALF]).map_err(at())?);
        let up = match k.checked_sub(1) {
            Some(parent) => JointEnd::on(parent, -z * HALF),
            None => JointEnd::world(Vector3::zeros()),
        };
        let hinge = JointKind::Hinge { axis: Vector3::y() };
        let ends = [up, JointEnd::on(k, z * HALF)];
        joints.push(Joint::new(Poses, n, hinge, ends).map_err(StudyError::at("a hinge"))?);
        let translation = -z * (HALF * (2 * k + 1) as f64);
        let pose = RigidMotion { translation, rotation: Rotation::identity() };
        let still = Vector3::zeros();
        motions.push(BodyMotion { pose, velocity: still, angular_velocity: still });
        points.push(PointMass { mass, point: Vector3::zeros() });
    }
    let metric = BodyMetric::<Poses>::new(bodies);
    let q = metric.state(&motions).map_err(StudyError::at("the pose"))?.q;
    let weight = Weight { gravity: z * -G, masses: points, space: Poses };
    let system = metric.under(weight).map_err(StudyError::at("the weight"))?;
    let found = linearize(&system, &joints, 0.0, &q).map_err(StudyError::at("small motions"))?;
    Ok(ascending(&found.stiffness))
}

fn ascending(matrix: &DMatrix<f64>) -> Vec<f64> {
    let mut values: Vec<f64> = matrix.symmetric_eigenvalues().iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Those of two links in closed form, without a difference of numbers that are alike.
///
/// ```text
/// det(K - x M) = a x^2 - b x + c,    b^2 - 4 a c = (M11 K2 - M22 K1)^2 + 4 K1 K2 M12^2
/// ```
fn of_two(masses: [f64; 2]) -> [f64; 2] {
    let [i, j] = masses.map(|mass| moment(mass) + mass * HALF * HALF);
    let (length, heavy) = (2.0 * HALF, masses[1]);
    let k = [G * (masses[0] * HALF + heavy * length), G * heavy * HALF];
    let m = [i + heavy * length * length, j, heavy * HALF * length];
    let a = i * j + heavy * length * length * moment(heavy);
    let b = m[0] * k[1] + m[1] * k[0];
    let root = (m[0] * k[1] - m[1] * k[0]).hypot(2.0 * (k[0] * k[1]).sqrt() * m[2]);
    [2.0 * k[0] * k[1] / (b + root), (b + root) / (2.0 * a)]
}

/// Those of equal links, of 1 kg each, by the mass and stiffness matrices of the angles from hanging.
fn of_equal(n: usize) -> Option<Vec<f64>> {
    let length = 2.0 * HALF;
    let below = |k: usize| (n - 1 - k) as f64;
    let stiffness = |k: usize| G * (HALF + below(k) * length);
    let mass = DMatrix::from_fn(n, n, |i, j| {
        let far = i.max(j);
        let own = if i == j { moment(1.0) + HALF * HALF } else { HALF * length };
        own + below(far) * length * length
    });
    let factor = mass.cholesky()?;
    let mut k = DMatrix::from_fn(n, n, |i, j| if i == j { stiffness(i) } else { 0.0 });
    factor.l_dirty().solve_lower_triangular_mut(&mut k).then_some(())?;
    k.transpose_mut();
    factor.l_dirty().solve_lower_triangular_mut(&mut k).then_some(())?;
    Some(ascending(&k))
}

/// Largest errors of the slow and of the fast motion of two links, by the mass of the lower one.
fn by_mass(per_decade: i32) -> Result<Vec<(f64, [f64; 2])>, StudyError> {
    let mut rows = Vec::new();
    for k in -DECADES * per_decade..=DECADES * per_decade {
        let ratio = 10.0_f64.powf(f64::from(k) / f64::from(per_decade));
        let (found, truth) = (full(&[1.0, ratio])?, of_two([1.0, ratio]));
        rows.push((ratio, [0, 1].map(|i| (found[i] / truth[i] - 1.0).abs())));
    }
    Ok(rows)
}

fn study(size: Size) -> Result<Study, StudyError> {
    let (per_decade, counts): (i32, &[usize]) = match size {
        Size::Default => (1, &[1, 2, 4, 8, 16]),
        Size::Full => (2, &[1, 2, 4, 8, 16, 32]),
    };
    let mut table = Table::new([
        Column::exact("links"),
        Column::rounded("lower mass over upper", 3, 0.0),
        Column::rounded("largest error, a part", 0, FLOOR),
        Column::volatile("time [s]"),
    ]);
    let rows = by_mass(per_decade)?;
    for (ratio, off) in &rows {
        table.push([2_u64.into(), (*ratio).into(), off[0].max(off[1]).into(), "".into()]);
    }
    let worst = |is: &dyn Fn(f64) -> bool| {
        let inside = rows.iter().filter(|(ratio, _)| is(*ratio));
        inside.fold(0.0, |worst: f64, (_, off)| worst.max(off[0]).max(off[1]))
    };
    let known = worst(&|ratio| (0.9e-9..1.1e9).contains(&ratio));
    let (heavy, light) = (worst(&|ratio| ratio > 0.9), worst(&|ratio| ratio < 1.1e-18));
    let losing: Vec<_> = rows
        .iter()
        .filter(|(ratio, _)| (0.9e-14..1.1e-5).contains(ratio))
        .map(|(ratio, off)| (*ratio, off[0].max(off[1])))
        .collect();
    let loss = loglog_slope(&losing).unwrap_or(f64::NAN);
    let (mut errors, mut walls) = (Vec::new(), Vec::new());
    for &n in counts {
        let masses = vec![1.0; n];
        let found = full(&masses)?;
        let truth = of_equal(n).ok_or_else(|| {
            StudyError::Elsewhere("the links' mass matrix has no factor".to_owned())
        })?;
        let off = found.iter().zip(&truth).map(|(found, truth)| (found / truth - 1.0).abs());
        let off = off.fold(0.0, f64::max);
        let wall = median_wall(|| {
            black_box(full(&masses).is_ok());
        });
        table.push([(n as u64).into(), 1.0.into(), off.into(), wall.median.into()]);
        errors.push((n as f64, off.max(FLOOR)));
        walls.push((n as f64, wall.median));
    }
    let equal = errors.iter().fold(0.0, |worst: f64, (_, off)| worst.max(*off));
    let slope = loglog_slope(&walls[2..]).unwrap_or(f64::NAN);
    let of = |motion: usize| rows.iter().map(move |(ratio, off)| (*ratio, off[motion].max(FLOOR)));
    let axis = || Axis::log("square frequency off, a part of it", "");
    let charts = vec![
        Lines::new("Two links", Axis::log("mass of the lower link over the upper", ""), axis())
            .with(Series::new("slow", of(0)))
            .with(Series::new("fast", of(1)))
            .slope(-0.5, (1e-12, 1e-10))
            .into(),
        Lines::new("Equal links", Axis::log("links", ""), axis())
            .with(Series::new("the worst of all", errors))
            .into(),
        Lines::new("Time of equal links", Axis::log("links", ""), Axis::log("time", "s"))
            .with(Series::new("full coordinates", walls))
            .slope(3.0, (8.0, 2e-3))
            .into(),
    ];
    Ok(Study {
        conclusion: format!(
            "Links that hang from one another on hinges, as bodies in full coordinates whose joints are rows: two \
             against their closed form, equal ones against the matrices in their angles. Equal links are known to \
             {equal:.0e}, and the work grows with the cube of them. A heavy link below a light one costs no digit. A \
             light one below a heavy one costs as many as the root of the ratio has. Up to masses 1e9 apart \
             {known:.0e} is lost, from 1e18 on {light:.0e}."
        ),
        table,
        charts,
        claims: vec![
            Claim::number(
                "masses up to 1e9 apart: square frequencies are off by at most a part of",
                "below 1e-11",
                known,
                (0.0, 1e-11),
            ),
            Claim::number(
                "a lower link as heavy as one likes: off by at most a part of",
                "below 1e-13",
                heavy,
                (0.0, 1e-13),
            ),
            Claim::number(
                "a lighter one costs digits: the error grows as the ratio to a power",
                "-0.5",
                loss,
                (-0.65, -0.35),
            ),
            Claim::number(
                "a lower link lighter by 1e18 and more: off by a part of more than",
                "1e-8",
                light,
                (1e-8, 1e-2),
            ),
            Claim::number(
                "equal links: off by at most a part of",
                "below 1e-12",
                equal,
                (0.0, 1e-12),
            ),
            Claim::number("time grows with the links to a power", "3", slope, (2.2, 3.8)),
        ],
        ..SMALL_MOTIONS.heading()
    })
}
