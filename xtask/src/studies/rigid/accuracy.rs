//! exp, log and the Jacobians of rotations against references of 120 digits.

use nalgebra::{Matrix3, Vector3};
use stationary_chart::{Axis, Lines, Series};
use stationary_measure::{Cell, Column, Table};
use stationary_rigid::problems::{LOGARITHMS, REFERENCES};
use stationary_rigid::{
    LieGroup, Rotation, right_jacobian, right_jacobian_derivative, right_jacobian_inverse,
};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Relative errors at every angle.
pub const ACCURACY: Entry<'static> = Entry {
    id: "rotation-accuracy",
    krate: "rigid",
    chapter: "9.3",
    kind: Kind::Derivative,
    title: "Rotations: error of exp, log and T against the angle",
    tested: Tested::Claims,
    run: &study,
};

/// The largest error relative to the largest entry.
fn relative(got: &[f64], expected: &[f64]) -> f64 {
    let largest = expected.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let off = got.iter().zip(expected).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
    off / largest
}

/// What T differs from the identity by, across its diagonal: half the angle, if it is small.
fn twist(m: &[f64]) -> [f64; 3] {
    [m[7] - m[5], m[2] - m[6], m[3] - m[1]]
}

fn by_rows(m: &Matrix3<f64>) -> Vec<f64> {
    m.transpose().as_slice().to_vec()
}

/// T as textbooks print it, with `(1 - cos a)/a^2` and `(a - sin a)/a^3` as they stand.
fn as_printed(theta: &Vector3<f64>) -> Matrix3<f64> {
    let (a, x) = (theta.norm(), theta.cross_matrix());
    let (c2, c3) = ((1.0 - a.cos()) / (a * a), (a - a.sin()) / (a * a * a));
    Matrix3::identity() - x * c2 + x * x * c3
}

fn study(_: Size) -> Result<Study, StudyError> {
    let mut table = Table::new([
        Column::rounded("angle [rad]", 6, 0.0),
        Column::rounded("exp", 1, 1e-15),
        Column::rounded("T", 1, 1e-15),
        Column::rounded("T beyond the identity", 1, 1e-15),
        Column::rounded("inverse of T", 1, 1e-14),
        Column::rounded("derivative of T", 1, 1e-15),
        Column::rounded("T as printed, beyond the identity", 1, 1e-14),
    ]);
    let mut lines = ["exp", "T beyond the identity", "T as printed"].map(|n| (n, Vec::new()));
    let mut worst = [0.0_f64; 4];
    let (v, delta) = (Vector3::new(0.3, -1.1, 0.7), Vector3::new(-0.6, 0.2, 0.9));
    for reference in REFERENCES.iter().filter(|r| r.theta != [0.0; 3]) {
        let theta = Vector3::from(reference.theta);
        // The norm of a vector below 1e-160 underflows where it is squared.
        let angle = (theta / theta.amax()).norm() * theta.amax();
        let exp = relative(&Rotation::exp(theta).quaternion(), &reference.exp);
        let t = by_rows(&right_jacobian(&theta));
        let beyond = relative(&twist(&t), &twist(&reference.jacobian));
        let inverse = relative(&by_rows(&right_jacobian_inverse(&theta)), &reference.inverse);
        let derivative = right_jacobian_derivative(&theta, &v, &delta);
        let derivative = relative(derivative.as_slice(), &reference.derivative);
        let printed = relative(&twist(&by_rows(&as_printed(&theta))), &twist(&reference.jacobian));
        let printed = if printed.is_finite() { printed.min(1.0) } else { 1.0 };
        let whole = relative(&t, &reference.jacobian);
        let cells = [angle, exp, whole, beyond, inverse, derivative, printed];
        table.push(cells.map(Cell::from));
        for ((_, points), error) in lines.iter_mut().zip([exp, beyond, printed]) {
            // One decade of angles below 1e-16 looks like the next.
            if angle > 1e-17 {
                points.push((angle, error.max(1e-17)));
            }
        }
        worst[0] = worst[0].max(exp / (1.0 + angle));
        worst[1] = worst[1].max(if angle < 1.0 { beyond } else { whole });
        worst[2] = worst[2].max(derivative);
        worst[3] = worst[3].max(if angle < 1.0 { printed } else { 0.0 });
    }
    let log = LOGARITHMS.iter().try_fold(0.0_f64, |worst, reference| {
        let rotation = Rotation::from_quaternion(reference.quaternion)
            .map_err(StudyError::at("a quaternion of the references"))?;
        Ok::<_, StudyError>(worst.max(relative(rotation.log().as_slice(), &reference.log)))
    })?;
    let ours = |what: &str, worst: f64, bound: f64| {
        Claim::number(
            format!("{what}: the largest relative error"),
            "rounding",
            worst,
            (0.0, bound),
        )
    };
    let claims = vec![
        ours("exp, of the angle's rounding", worst[0], 1e-15),
        ours("log", log, 1e-15),
        ours("T, at small angles of what differs from the identity", worst[1], 1e-14),
        ours("the derivative of T", worst[2], 1e-14),
        Claim::number(
            "T as printed, below a radian: the largest error of what differs from the identity",
            "all of it",
            worst[3],
            (0.99, 1.0),
        ),
    ];
    let axes = (Axis::log("angle", "rad"), Axis::log("relative error", ""));
    let chart = lines
        .into_iter()
        .fold(Lines::new("Errors", axes.0, axes.1), |c, (name, p)| c.with(Series::new(name, p)));
    Ok(Study {
        conclusion: "Against references of 120 digits exp, log, the differential T and its derivative \
             err by rounding at every angle from 1e-300 to beyond three whole turns. The closed form \
             of T cancels at small angles: of what distinguishes it from the identity nothing is left \
             at 1e-8, and an identity of size 1 hides that from every check of the whole matrix. The \
             inverse is lost at whole turns, as it must be."
            .into(),
        table,
        charts: vec![chart.into()],
        claims,
        ..ACCURACY.heading()
    })
}
