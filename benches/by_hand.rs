//! What a careful programmer writes for one planet: plain arrays, one loop, the same finite check.

/// A planet's configuration and momentum.
pub type Planet = ([f64; 2], [f64; 2]);

#[inline(always)]
fn dv(q: &[f64; 2]) -> [f64; 2] {
    let r2 = q[0] * q[0] + q[1] * q[1];
    let factor = 1.0 / (r2 * r2.sqrt());
    [factor * q[0], factor * q[1]]
}

#[inline(always)]
fn energy(q: &[f64; 2]) -> f64 {
    -1.0 / (q[0] * q[0] + q[1] * q[1]).sqrt()
}

#[inline(always)]
fn hessian(q: &[f64; 2]) -> [f64; 3] {
    let r2 = q[0] * q[0] + q[1] * q[1];
    let factor = 1.0 / (r2 * r2.sqrt());
    let three = 3.0 * factor / r2;
    [factor - three * q[0] * q[0], -three * q[0] * q[1], factor - three * q[1] * q[1]]
}

#[inline(always)]
fn add(x: &mut [f64; 2], scale: f64, y: &[f64; 2]) {
    x[0] += scale * y[0];
    x[1] += scale * y[1];
}

pub fn explicit_euler((q, p): &mut Planet, _: &mut [f64; 2], h: f64) {
    let force = dv(q);
    add(q, h, &{ *p });
    add(p, -h, &force);
}

pub fn drift_kick((q, p): &mut Planet, _: &mut [f64; 2], h: f64) {
    add(q, h, p);
    add(p, -h, &dv(q));
}

pub fn kick_drift((q, p): &mut Planet, _: &mut [f64; 2], h: f64) {
    add(p, -h, &dv(q));
    add(q, h, p);
}

pub fn stormer_verlet((q, p): &mut Planet, last: &mut [f64; 2], h: f64) {
    add(p, -0.5 * h, last);
    add(q, h, p);
    *last = dv(q);
    add(p, -0.5 * h, last);
}

pub fn runge_kutta_4((q, p): &mut Planet, _: &mut [f64; 2], h: f64) {
    let (q0, p0) = (*q, *p);
    let (mut a, mut b) = (q0, p0);
    for (stage, weight) in [(0.5 * h, h / 6.0), (0.5 * h, h / 3.0), (h, h / 3.0), (0.0, h / 6.0)] {
        let (velocity, force) = (b, dv(&a));
        add(q, weight, &velocity);
        add(p, -weight, &force);
        (a, b) = (q0, p0);
        add(&mut a, stage, &velocity);
        add(&mut b, -stage, &force);
    }
}

/// Solves `x - y + a dV(x) = 0` from x = y, with the iterations, the stops and the line search's first
/// test of [`stationary_calculus::Newton`]. It leaves out what this orbit does not need: a shift where
/// the matrix is not positive definite, the shorter steps of the line search, the check of each step
/// for finite numbers, the record of residuals, and the search that ends above its first residual.
#[inline(always)]
fn newton(y: &[f64; 2], a: f64) -> [f64; 2] {
    let residual = |x: &[f64; 2]| {
        let force = dv(x);
        [x[0] - y[0] + a * force[0], x[1] - y[1] + a * force[1]]
    };
    let size = |f: &[f64; 2]| (f[0] * f[0] + f[1] * f[1]).sqrt();
    let mut x = *y;
    let mut f = residual(&x);
    let mut before = size(&f);
    for _ in 0..50 {
        if before == 0.0 {
            break;
        }
        let [xx, xy, yy] = hessian(&x).map(|entry| a * entry);
        let l0 = (1.0 + xx).sqrt();
        let l1 = xy / l0;
        let l2 = (1.0 + yy - l1 * l1).sqrt();
        let z0 = f[0] / l0;
        let z1 = (f[1] - l1 * z0) / l2;
        let s1 = z1 / l2;
        let s0 = (z0 - l1 * s1) / l0;
        let relative = s0.abs().max(s1.abs()) / x[0].abs().max(x[1].abs());
        let next = [x[0] - s0, x[1] - s1];
        let g = residual(&next);
        let after = size(&g);
        if after > 0.5 * before {
            if relative > 1e-9 {
                assert!(energy(&next).is_finite(), "a line search would be needed");
            } else if after > before {
                break;
            }
        }
        (x, f, before) = (next, g, after);
        if relative <= 4.0 * f64::EPSILON {
            break;
        }
    }
    x
}

pub fn implicit_euler((q, p): &mut Planet, _: &mut [f64; 2], h: f64) {
    add(q, h, p);
    *q = newton(q, h * h);
    add(p, -h, &dv(q));
}

pub fn trapezoid((q, p): &mut Planet, last: &mut [f64; 2], h: f64) {
    add(p, -0.25 * h, last);
    add(q, h, p);
    add(p, -0.25 * h, last);
    *q = newton(q, 0.25 * h * h);
    *last = dv(q);
    add(p, -0.5 * h, last);
}

pub fn implicit_midpoint((q, p): &mut Planet, _: &mut [f64; 2], h: f64) {
    let start = *q;
    add(q, 0.5 * h, p);
    let force = dv(&newton(q, 0.25 * h * h));
    add(p, -0.5 * h, &force);
    *q = start;
    add(q, h, p);
    add(p, -0.5 * h, &force);
}

/// Steps a planet, checking after each step that it is still finite.
#[inline(always)]
pub fn run(
    planet: &mut Planet,
    h: f64,
    steps: usize,
    step: impl Fn(&mut Planet, &mut [f64; 2], f64),
) {
    let mut last = dv(&planet.0);
    for _ in 0..steps {
        step(planet, &mut last, h);
        let (q, p) = &planet;
        assert!(q[0].is_finite() & q[1].is_finite() & p[0].is_finite() & p[1].is_finite());
    }
}
