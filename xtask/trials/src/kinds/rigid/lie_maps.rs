//! exp, log and the tangent maps of rotations and motions, against 32 digits.

use nalgebra::{DMatrix, Matrix3, Vector3, Vector6};
use stationary_rigid::{
    LieGroup, PlanarMotion, RigidMotion, Rotation, left_jacobian, left_jacobian_inverse,
    matrix_exponential, matrix_logarithm, right_jacobian, right_jacobian_derivative,
    right_jacobian_inverse,
};

use super::double_double::{Triple, Twofold, add, cross, dot, scaled, triple};
use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "lie-maps",
    krate: "rigid",
    rule: "a component of exp or log is off by more than six roundings of itself and 1e-31 of the angle; a tangent map, its \
           inverse or its derivative by 1e-14 of its largest entry; a motion by 1e-14 of its size",
    in_tests: 1000,
    trial,
};

/// A few roundings.
const FEW: f64 = 6.0 * f64::EPSILON;
/// What the page promises of tangent maps.
const TANGENT: f64 = 1e-14;

/// A turn of any size, often beside a half or a whole one.
fn turn(draw: &mut Draw) -> Vector3<f64> {
    let mut axis = Vector3::from_fn(|_, _| draw.symmetric());
    if draw.chance(0.3) {
        let thin = draw.log_uniform(1e-12, 1.0);
        axis[draw.below(3)] *= thin;
        axis[draw.below(3)] *= thin;
    }
    if axis.norm() < 1e-3 {
        axis = Vector3::from_fn(|k, _| if k == 0 { 1.0 } else { 0.0 });
    }
    let axis = axis.normalize();
    let angle = match draw.below(6) {
        0 => draw.log_uniform(1e-300, 1e-3),
        1 => draw.log_uniform(1e-3, 10.0),
        2 => draw.log_uniform(1.0, 1e6),
        kind => {
            let halves = match kind {
                3 => draw.one_of(&[1.0, 2.0]),
                4 => draw.between(1, 12) as f64,
                _ => draw.log_uniform(1.0, 3e5).round(),
            };
            let off = draw.one_of(&[0.0, 1.0, -1.0]) * draw.log_uniform(1e-17, 0.1);
            std::f64::consts::PI * halves * (1.0 + off)
        }
    };
    axis * angle
}

/// The length of a vector, and it divided by a power of two that makes it about one.
fn length(v: &Vector3<f64>) -> Twofold {
    let power = exponent(v);
    let small = triple((v / power).into());
    dot(&small, &small).sqrt() * power
}

fn exponent(v: &Vector3<f64>) -> f64 {
    let largest = v.amax();
    if largest == 0.0 { 1.0 } else { 2.0_f64.powi(largest.log2().floor() as i32) }
}

/// `c_0` to `c_5` of Stumpff at an angle.
fn stumpff(angle: Twofold) -> [Twofold; 6] {
    let s = angle * angle;
    let mut c = [Twofold::from(0.0); 6];
    if angle.hi < 2.0 {
        for (n, c) in c.iter_mut().enumerate() {
            let mut term = Twofold::from(1.0);
            (2..=n).for_each(|k| term = term / Twofold::from(k as f64));
            for k in 0..30 {
                *c += term;
                let next = ((2 * k + n + 1) * (2 * k + n + 2)) as f64;
                term = -(term * s) / Twofold::from(next);
            }
        }
        return c;
    }
    let (sine, cosine) = angle.sin_cos();
    let half = (angle * 0.5).sin_cos().0;
    c[0] = cosine;
    c[1] = sine / angle;
    c[2] = half * half * 2.0 / s;
    c[3] = (Twofold::from(1.0) - c[1]) / s;
    c[4] = (Twofold::from(0.5) - c[2]) / s;
    c[5] = (Twofold::from(1.0) / Twofold::from(6.0) - c[3]) / s;
    c
}

/// `v + b theta x v + c theta x (theta x v)`
fn polynomial(theta: &Triple, b: Twofold, c: Twofold, v: &Triple) -> Triple {
    let once = cross(theta, v);
    let twice = cross(theta, &once);
    add(&add(v, &scaled(&once, b)), &scaled(&twice, c))
}

/// The largest difference from a matrix given by its action, over its largest entry.
fn off(matrix: &Matrix3<f64>, action: impl Fn(&Triple) -> Triple) -> f64 {
    let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
    for j in 0..3 {
        let mut e = [0.0; 3];
        e[j] = 1.0;
        let column = action(&triple(e));
        for (i, exact) in column.iter().enumerate() {
            let error = (*exact - Twofold::from(matrix[(i, j)])).abs().hi;
            worst = if error.is_nan() { f64::NAN } else { worst.max(error) };
            largest = largest.max(exact.hi.abs());
        }
    }
    worst / largest
}

/// The largest difference of vectors.
fn apart(got: &[f64], exact: &[Twofold]) -> f64 {
    let errors = got.iter().zip(exact).map(|(a, b)| (*b - Twofold::from(*a)).abs().hi);
    errors.fold(0.0, |m, e| if e.is_nan() || e > m { e } else { m })
}

/// Component by component; what may have lost bits to underflow is left aside.
fn by_component(got: &[f64], exact: &[Twofold], floor: f64, what: &str) -> Verdict {
    let mut verdict = Verdict::due();
    for (got, exact) in got.iter().zip(exact) {
        if exact.hi.abs() > 1e-290 {
            let error = (*exact - Twofold::from(*got)).abs().hi;
            verdict = verdict.and(Verdict::of(error, FEW * exact.hi.abs() + floor, what));
        }
    }
    verdict
}

fn trial(draw: &mut Draw) -> Verdict {
    let theta = turn(draw);
    let angle = length(&theta);
    let beside = (angle.hi / std::f64::consts::PI).round() * std::f64::consts::PI;
    draw.note(format!("theta {theta:?}, angle {:e}, {:e} past", angle.hi, angle.hi - beside));
    let exact = triple(theta.into());
    let c = stumpff(angle);
    let mut verdict = rotation(&theta, angle);
    let jacobian = |sign: f64| move |v: &Triple| polynomial(&exact, c[2] * sign, c[3], v);
    for (matrix, sign) in [(right_jacobian(&theta), -1.0), (left_jacobian(&theta), 1.0)] {
        let off = off(&matrix, jacobian(sign));
        verdict = verdict.and(Verdict::of(off, TANGENT, "a tangent map"));
    }
    // (1 - a/2 cot a/2)/a^2, where a whole turn is not hit to rounding.
    if c[2].hi * angle.hi * angle.hi > 1e-25 || angle.hi < 1.0 {
        let inverse = (c[3] - c[4] * 2.0) / (c[2] * 2.0);
        let action =
            |sign: f64| move |v: &Triple| polynomial(&exact, Twofold::from(0.5 * sign), inverse, v);
        for (matrix, sign) in
            [(right_jacobian_inverse(&theta), 1.0), (left_jacobian_inverse(&theta), -1.0)]
        {
            let off = off(&matrix, action(sign));
            verdict = verdict.and(Verdict::of(off, TANGENT, "an inverse tangent map"));
        }
    }
    verdict = verdict.and(derivative(draw, &theta, angle));
    verdict.and(motions(draw, &theta, &c)).and(matrices(&theta, angle))
}

fn rotation(theta: &Vector3<f64>, angle: Twofold) -> Verdict {
    let turned = Rotation::exp(*theta);
    let [w, x, y, z] = turned.quaternion();
    let (sine, cosine) = (angle * 0.5).sin_cos();
    // The sine's quotient by the angle, also where the angle's square underflows.
    let ratio = match angle.hi < 1e-12 {
        true => Twofold::from(0.5),
        false => sine / angle,
    };
    let exact = triple((*theta).into());
    let expected = [cosine, exact[0] * ratio, exact[1] * ratio, exact[2] * ratio];
    let verdict = by_component(&[w, x, y, z], &expected, 1e-31 * angle.hi, "a component of exp");
    // The logarithm of what was got, whose length is one to rounding.
    let power = exponent(&Vector3::new(x, y, z));
    let v = triple([x / power, y / power, z / power]);
    let size = dot(&v, &v).sqrt() * power;
    if size.hi == 0.0 {
        return verdict;
    }
    let half = match size.hi < 1e-12 {
        true => size,
        false => size.atan2(Twofold::from(w.abs())),
    };
    let side = if w < 0.0 { -1.0 } else { 1.0 };
    if w == 0.0 {
        return verdict;
    }
    let factor = half * (2.0 * side) / size;
    let expected: Vec<Twofold> = [x, y, z].iter().map(|&x| factor * x).collect();
    verdict.and(by_component(turned.log().as_slice(), &expected, 0.0, "a component of log"))
}

/// By differences of the tangent map in 32 digits.
fn derivative(draw: &mut Draw, theta: &Vector3<f64>, angle: Twofold) -> Verdict {
    let v = Vector3::from_fn(|_, _| draw.symmetric());
    let delta = Vector3::from_fn(|_, _| draw.symmetric());
    let step = Twofold::from(1e-10 * angle.hi.clamp(1e-3, 1.0));
    let at = |side: f64| {
        let moved = add(&triple((*theta).into()), &scaled(&triple(delta.into()), step * side));
        let c = stumpff(dot(&moved, &moved).sqrt());
        polynomial(&moved, -c[2], c[3], &triple(v.into()))
    };
    let difference = add(&at(1.0), &scaled(&at(-1.0), Twofold::from(-1.0)));
    let exact = difference.map(|x| x / (step * 2.0));
    let got = right_jacobian_derivative(theta, &v, &delta);
    // The derivative's own size: it falls with one over the angle.
    let size = v.norm() * delta.norm() / (2.0 + angle.hi);
    Verdict::of(apart(got.as_slice(), &exact), TANGENT * size + 1e-300, "the derivative")
}

fn motions(draw: &mut Draw, theta: &Vector3<f64>, c: &[Twofold; 6]) -> Verdict {
    let v = Vector3::from_fn(|_, _| draw.symmetric()) * draw.log_uniform(1e-6, 1e6);
    let motion = RigidMotion::exp(Vector6::new(v.x, v.y, v.z, theta.x, theta.y, theta.z));
    let exact = polynomial(&triple((*theta).into()), c[2], c[3], &triple(v.into()));
    let error = apart(motion.translation.as_slice(), &exact);
    let mut verdict = Verdict::of(error, TANGENT * v.norm(), "a motion's translation");
    if theta.norm() < 3.1 {
        let back = motion.log();
        let off = (back.fixed_rows::<3>(0) - v).norm();
        verdict = verdict.and(Verdict::of(off, 1e-13 * v.norm(), "a motion's logarithm"));
    }
    // In the plane: t = (sin a/a) v + ((1 - cos a)/a) Z v.
    let a = theta.amax().copysign(theta.sum());
    let angle = Twofold::from(a);
    let (sine, half) = (angle.sin_cos().0, (angle * 0.5).sin_cos().0);
    let tiny = a.abs() < 1e-12;
    let along = if tiny { Twofold::from(1.0) } else { sine / angle };
    let across = if tiny { angle * 0.5 } else { half * half * 2.0 / angle };
    let exact = [along * v.x - across * v.y, along * v.y + across * v.x];
    let motion = PlanarMotion::exp(Vector3::new(v.x, v.y, a));
    let size = (along.hi.hypot(across.hi) * v.xy().norm()).max(1e-300);
    // Each of the two parts to a few roundings.
    let error = apart(motion.translation.as_slice(), &exact);
    verdict = verdict.and(Verdict::of(error, 2.0 * FEW * size, "a planar motion's translation"));
    if a.abs() < 3.1 {
        let back = motion.log();
        let off = (back.xy() - v.xy()).norm();
        verdict = verdict.and(Verdict::of(off, 1e-13 * v.xy().norm(), "a planar logarithm"));
    }
    verdict
}

fn matrices(theta: &Vector3<f64>, angle: Twofold) -> Verdict {
    if angle.hi > 20.0 {
        return Verdict::due();
    }
    let hat = DMatrix::from_column_slice(3, 3, theta.cross_matrix().as_slice());
    let turned = Rotation::exp(*theta).matrix();
    match matrix_exponential(&hat) {
        Err(error) => Verdict::refused(error),
        Ok(exponential) => {
            let off = (exponential - DMatrix::from_column_slice(3, 3, turned.as_slice())).amax();
            let verdict = Verdict::of(off, 1e-13 * (1.0 + angle.hi), "a matrix exponential");
            if angle.hi > 3.1 {
                return verdict;
            }
            match matrix_logarithm(&DMatrix::from_column_slice(3, 3, turned.as_slice())) {
                Err(error) => Verdict::refused(error),
                Ok(log) => verdict.and(Verdict::of((log - hat).amax(), 1e-9, "a matrix logarithm")),
            }
        }
    }
}
