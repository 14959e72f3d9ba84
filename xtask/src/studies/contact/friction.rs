//! A block on an incline: how fast it slides, against Coulomb's law.

use nalgebra::Vector3;
use stationary_chart::{Axis, Lines, Series};
use stationary_contact::{Collider, ContactError, Detector, Shape, SpatialWorld};
use stationary_measure::{Column, Table};
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, LieGroup, PointMass, Poses, RigidMotion, Rotation, Weight,
};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Acceleration against the angle.
pub const FRICTION_THRESHOLD: Entry<'static> = Entry {
    id: "friction-threshold",
    krate: "contact",
    chapter: "friction",
    kind: Kind::Limit,
    title: "Block on an incline: acceleration against the angle",
    tested: Tested::Claims,
    run: &study,
};

const GRAVITY: f64 = 9.81;

/// The mean acceleration, the largest gap (m) and the largest residual of Coulomb's law (m/s).
fn slide(angle: f64, mu: f64, steps: u32) -> Result<[f64; 3], ContactError> {
    let rotation = Rotation::exp(Vector3::y() * angle);
    let normal = rotation.rotate(&Vector3::z());
    let pose = RigidMotion { translation: normal * 0.1, rotation };
    let still = Vector3::zeros();
    let metric = BodyMetric::<Poses>::new(vec![Body::solid_box(1.0, [0.2, 0.2, 0.1])?]);
    let mut state =
        metric.state(&[BodyMotion { pose, velocity: still, angular_velocity: still }])?;
    let masses = vec![PointMass { mass: 1.0, point: still }];
    let weight = Weight { gravity: -Vector3::z() * GRAVITY, masses, space: Poses };
    let system = metric.under(weight)?;
    let block = Collider::on_body(0, Shape::cuboid([0.2, 0.2, 0.1])?).with_friction(mu);
    let slope = Collider::fixed(RigidMotion::identity(), Shape::half_space(normal)?);
    let detector = Detector::new(vec![block, slope.with_friction(mu)], 1)?;
    let mut bodies = SpatialWorld::new(system, detector)?;
    let (mut gap, mut residual) = (0.0_f64, 0.0_f64);
    for _ in 0..steps {
        residual = residual.max(bodies.step(&mut state, 1e-3)?.coulomb);
        let contacts = bodies.detector().detect(&state.q, 1e-2)?;
        gap = contacts.iter().map(|contact| contact.gap.abs()).fold(gap, f64::max);
    }
    let speed = Vector3::from_column_slice(&state.p.0[..3]).norm();
    Ok([speed / (1e-3 * f64::from(steps)), gap, residual])
}

fn study(size: Size) -> Result<Study, StudyError> {
    let (angles, steps) = match size {
        Size::Default => (24, 200),
        Size::Full => (120, 2000),
    };
    let mut table = Table::new([
        Column::rounded("friction", 3, 0.0),
        Column::rounded("angle [degrees]", 3, 0.0),
        Column::rounded("acceleration [m/s^2]", 4, 1e-9),
        Column::rounded("Coulomb's [m/s^2]", 4, 1e-9),
    ]);
    let axes = (Axis::linear("angle", "degrees"), Axis::linear("acceleration", "m/s²"));
    let mut chart = Lines::new("", axes.0, axes.1);
    let [mut off, mut gap, mut residual] = [0.0_f64; 3];
    for mu in [0.0, 0.3, 0.6] {
        let expected = |angle: f64| (GRAVITY * (angle.sin() - mu * angle.cos())).max(0.0);
        let mut points = Vec::new();
        for k in 1..=angles {
            let degrees = 60.0 * f64::from(k) / f64::from(angles);
            let angle = degrees.to_radians();
            let got = slide(angle, mu, steps).map_err(StudyError::at("a block on an incline"))?;
            off = off.max((got[0] - expected(angle)).abs());
            (gap, residual) = (gap.max(got[1]), residual.max(got[2]));
            points.push((degrees, got[0]));
            table.push([mu.into(), degrees.into(), got[0].into(), expected(angle).into()]);
        }
        let law = (0..=120).map(|k| 0.5 * f64::from(k));
        let law = law.map(|degrees| (degrees, expected(degrees.to_radians())));
        chart = chart.with(Series::new(&format!("μ = {mu}"), points)).curve("", law);
    }
    let claims = vec![
        Claim::number("largest error of the acceleration, m/s^2", "below 1e-6", off, (0.0, 1e-6)),
        Claim::number("largest gap while sliding, m", "below 1e-9", gap, (0.0, 1e-9)),
        Claim::number("residual of Coulomb's law, m/s", "below 1e-10", residual, (0.0, 1e-10)),
    ];
    Ok(Study {
        conclusion: "A block is let go on an incline. Below the angle whose tangent is the \
                     friction it stays, above it accelerates with g (sin - mu cos), and it never \
                     leaves the plane: staggered projections do not lift what slides."
            .into(),
        table,
        charts: vec![chart.into()],
        claims,
        ..FRICTION_THRESHOLD.heading()
    })
}
