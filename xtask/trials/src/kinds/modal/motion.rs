//! Oscillators in closed form: damped and undamped, drifting, for long times.
//!
//! ```text
//! x'' + 2 zeta w x' + w^2 x = 0
//! ```
//! The referee's solutions are exponentials of both roots, or of the critical one with its series.

use stationary_calculus::{Covector, SymmetricMatrix, Vector};
use stationary_modal::{Linearized, ModalError, Modes, Motion, Reduced, RigidMotions};

use super::prescribed::sparse;
use crate::{Draw, Verdict};

/// What becomes of `x(0) = 1, x'(0) = 0` and of `x(0) = 0, x'(0) = 1`, with the size that their
/// terms have.
struct Form {
    x: [f64; 2],
    v: [f64; 2],
    sizes: [f64; 4],
}

/// `(1 - e^-y)/y`.
fn mean_decay(y: f64) -> f64 {
    if y == 0.0 { 1.0 } else { -(-y).exp_m1() / y }
}

fn closed_form(lambda: f64, zeta: f64, t: f64) -> Form {
    let w = lambda.abs().sqrt();
    if lambda == 0.0 {
        return Form { x: [1.0, t], v: [0.0, 1.0], sizes: [1.0, t.abs(), 0.0, 1.0] };
    }
    if lambda < 0.0 {
        let (up, down) = ((w * t).exp(), (-w * t).exp());
        let (c, s) = (0.5 * (up + down), 0.5 * (up - down));
        return Form { x: [c, s / w], v: [w * s, c], sizes: [c, c / w, w * c, c] };
    }
    if zeta < 1.0 {
        let root = ((1.0 - zeta) * (1.0 + zeta)).sqrt();
        let (turned, decay) = (w * root * t, (-zeta * w * t).exp());
        let s = decay * if turned.abs() < 1e-8 { w * t } else { turned.sin() / root };
        let c = decay * turned.cos();
        let (x, v) = ([c + zeta * s, s / w], [-w * s, c - zeta * s]);
        let most = decay * (1.0 + zeta * (1.0 / root).min(w * t.abs()));
        let part = decay * (1.0 / root).min(w * t.abs());
        return Form { x, v, sizes: [most, part / w, w * part, most] };
    }
    // Decay rates of both exponentials, slow and fast, relative to w; their product is 1.
    let root = ((zeta - 1.0).sqrt()) * ((zeta + 1.0).sqrt());
    let (slow, fast) = (1.0 / (zeta + root), zeta + root);
    let gap = 2.0 * root * w * t;
    let (e, f) = ((-slow * w * t).exp(), (-fast * w * t).exp());
    // (e^-slow - e^-fast)/(fast - slow), in units of 1/w.
    let s = if gap.abs() < 1.0 { e * w * t * mean_decay(gap) } else { (e - f) / (2.0 * root) };
    let c = e + slow * s;
    let rate = if gap.abs() < 1.0 { e - fast * s } else { (fast * f - slow * e) / (2.0 * root) };
    let rate_size =
        if gap.abs() < 1.0 { e + fast * s } else { (fast * f + slow * e) / (2.0 * root) };
    Form { x: [c, s / w], v: [-w * s, rate], sizes: [c.abs(), s.abs() / w, w * s.abs(), rate_size] }
}

fn ratio(draw: &mut Draw) -> f64 {
    match draw.below(7) {
        0 => 0.0,
        1 => 1.0,
        2 => draw.uniform(0.0, 1.0),
        3 => draw.uniform(1.0, 5.0),
        4 => draw.log_uniform(1.0, 1e8),
        5 => 1.0 + draw.log_uniform(1e-16, 1e-1),
        _ => 1.0 - draw.log_uniform(1e-16, 1e-1),
    }
}

fn time(draw: &mut Draw) -> f64 {
    match draw.below(5) {
        0 => draw.uniform(0.0, 10.0),
        1 => draw.log_uniform(1e-12, 1.0),
        2 => draw.log_uniform(1.0, 1e8),
        3 => draw.log_uniform(1e3, 1e20),
        _ => -draw.log_uniform(1e-3, 30.0),
    }
}

pub(super) fn trial(draw: &mut Draw) -> Verdict {
    // What grows would drown the others.
    let n = if draw.chance(0.7) { 1 } else { draw.between(1, 5) };
    let size = if draw.chance(0.3) { draw.log_uniform(1e-10, 1e10) } else { 1.0 };
    let spectrum: Vec<f64> = (0..n)
        .map(|_| match draw.below(6) {
            0 => 0.0,
            1 if n == 1 => -size * draw.uniform(0.1, 2.0),
            _ => size * draw.log_uniform(1e-2, 1e2),
        })
        .collect();
    draw.note(format!("lambda {spectrum:?}"));
    let (mass, potential) = sparse(draw, &spectrum);
    let mut system = match Linearized::at(&mass, &potential, &vec![0.0; n], 0.0) {
        Ok(system) => system,
        Err(_) if spectrum.iter().all(|value| *value == 0.0) => return Verdict::due(),
        Err(error) => return Verdict::refused(error),
    };
    let modes = match system.lowest(n, &RigidMotions::none()) {
        Ok(modes) => modes,
        Err(error) => return Verdict::refused(error),
    };
    if draw.chance(0.2) {
        return reduced(draw, &modes);
    }
    // Alone: what must be right for each mode must be right for their sum.
    let mode = draw.below(n);
    let column = modes.vector(mode).expect("a mode").0;
    let (x, rate) = (draw.symmetric(), draw.symmetric() * size.sqrt());
    let d: Vec<f64> = column.iter().map(|v| x * v).collect();
    let v: Vec<f64> = column.iter().map(|v| rate * v).collect();
    let ratios: Vec<f64> = (0..n).map(|_| ratio(draw)).collect();
    let (lambda, zeta) = (modes.values()[mode], ratios[mode]);
    let w = lambda.abs().sqrt();
    let t = time(draw) / if w > 0.0 && draw.chance(0.5) { w } else { 1.0 };
    // Back in time what is damped grows, and drowns the others.
    let t = if n > 1 { t.abs() } else { t };
    draw.note(format!("mode {mode}, lambda {lambda:e}, zeta {zeta}, t {t:e}, start {x} {rate}"));
    match moved(&modes, system.mass(), &ratios, (&d, &v), t) {
        Ok((end, speed)) => {
            judge(&modes, system.mass(), mode, (x, rate), (lambda, zeta, t), (&end, &speed))
        }
        Err(error) => {
            let form = closed_form(lambda, zeta, t);
            let ends = [form.x[0] * x + form.x[1] * rate, form.v[0] * x + form.v[1] * rate];
            let too_long = lambda > 0.0 && zeta < 1.0 && f64::EPSILON * w * t.abs() > 1e-4;
            if too_long || ends.iter().any(|x| x.abs() > 1e150 || x.is_nan()) {
                Verdict::due()
            } else {
                Verdict::refused(format!("{error} (t = {t:e})"))
            }
        }
    }
}

type State = (Vec<f64>, Vec<f64>);

fn moved(
    modes: &Modes,
    mass: &SymmetricMatrix,
    ratios: &[f64],
    (d, v): (&[f64], &[f64]),
    t: f64,
) -> Result<State, ModalError> {
    let motion = Motion::new(modes, mass, Vector(d), Vector(v))?.with_damping(ratios)?;
    let (mut end, mut speed) = (vec![0.0; d.len()], vec![0.0; d.len()]);
    motion.at(t, Vector(&mut end), Vector(&mut speed))?;
    Ok((end, speed))
}

fn judge(
    modes: &Modes,
    mass: &SymmetricMatrix,
    mode: usize,
    (x, rate): (f64, f64),
    (lambda, zeta, t): (f64, f64, f64),
    (end, speed): (&[f64], &[f64]),
) -> Verdict {
    let n = end.len();
    let form = closed_form(lambda, zeta, t);
    let w = lambda.abs().sqrt();
    let is_periodic = lambda > 0.0 && zeta < 1.0;
    let sizes = [
        form.sizes[0] * x.abs() + form.sizes[1] * rate.abs(),
        form.sizes[2] * x.abs() + form.sizes[3] * rate.abs(),
    ];
    if !sizes.iter().all(|size| size.is_finite()) {
        return Verdict::not_judged("the referee's terms leave the range of numbers");
    }
    let phase = w * t.abs();
    let is_gone = sizes[0] <= 1e-12 * (x.abs() + rate.abs() / w);
    if is_periodic && f64::EPSILON * phase > 1.0 && !is_gone {
        return Verdict::wrong("an answer where no digit of the phase is left");
    }
    // A decay is known to as many digits as its exponent leaves.
    let exponent = if is_periodic || lambda <= 0.0 {
        4.0 * phase
    } else {
        let fast = zeta + (zeta - 1.0).sqrt() * (zeta + 1.0).sqrt();
        10.0 + 2.0 * phase * if t < 0.0 { fast } else { 1.0 / fast }
    };
    let relative = 1e-11 + 8.0 * f64::EPSILON * exponent;
    let column = modes.vector(mode).expect("a mode").0;
    let mut mv = vec![0.0; n];
    mass.add_product(1.0, column, &mut mv).expect("the size");
    let part = |y: &[f64]| y.iter().zip(&mv).map(|(y, m)| y * m).sum::<f64>();
    let exact = [form.x[0] * x + form.x[1] * rate, form.v[0] * x + form.v[1] * rate];
    // What other modes get from the rounding of the start, and what is below the least number.
    let spill = if n > 1 { 1e-27 } else { 0.0 };
    let start = x.abs() + rate.abs() * (t.abs() + 1.0) / w.clamp(1e-9, 1.0);
    let least = 1e-290 + spill * start;
    let fastest = modes.values().iter().fold(1.0_f64, |most, l| most.max(l.abs().sqrt()));
    let off = [(part(end) - exact[0]).abs(), (part(speed) - exact[1]).abs()];
    Verdict::of(off[0], relative * sizes[0] + least, "the displacement").and(Verdict::of(
        off[1],
        relative * sizes[1] + least * fastest,
        "the velocity",
    ))
}

/// Steps under a constant force: the force moves the place about which the body swings.
fn reduced(draw: &mut Draw, modes: &Modes) -> Verdict {
    let n = modes.dim();
    let force: Vec<f64> = draw.vector(n);
    let steps = draw.between(1, 5);
    let w = modes.values().iter().fold(0.0_f64, |w, lambda| w.max(lambda.abs())).sqrt();
    let h = draw.log_uniform(1e-6, 1e6) / if w > 0.0 { w } else { 1.0 };
    draw.note(format!("reduced: {steps} steps of {h:e} under {force:?}"));
    let mut body = Reduced::at_rest(modes);
    for _ in 0..steps {
        if let Err(error) = body.step(h, Covector(&force)) {
            let grows = modes.values().iter().any(|lambda| *lambda < 0.0);
            return if grows && w * h > 100.0 { Verdict::due() } else { Verdict::refused(error) };
        }
    }
    let t = h * steps as f64;
    let mut verdict = Verdict::due();
    for (i, &lambda) in modes.values().iter().enumerate() {
        let column = modes.vector(i).expect("a mode").0;
        let f: f64 = column.iter().zip(&force).map(|(v, f)| v * f).sum();
        let size: f64 = column.iter().zip(&force).map(|(v, f)| (v * f).abs()).sum();
        let half = 0.5 * lambda.abs().sqrt() * t;
        let sinc = match lambda {
            l if l > 0.0 => half.sin() / half,
            l if l < 0.0 => half.sinh() / half,
            _ => 1.0,
        };
        let envelope = match lambda {
            l if l > 0.0 => (1.0 / half).min(1.0),
            _ => sinc,
        };
        // Not a square by itself, which may be larger than what is sought.
        let exact = 0.5 * f * (t * sinc) * (t * sinc);
        let relative = 1e-11 + 50.0 * f64::EPSILON * half;
        let promised = 0.5 * size * (t * envelope) * relative * (t * envelope);
        verdict =
            verdict.and(Verdict::of((body.alpha()[i] - exact).abs(), promised + 1e-290, "alpha"));
    }
    verdict
}
