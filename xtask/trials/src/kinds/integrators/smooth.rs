//! Families of smooth problems: linear ones with prescribed rates, and some that oscillate.

use nalgebra::{DMatrix, DVector};

use super::problem::{Derivative, Energy, InitialValue, Slope, mechanics, motion};
use crate::Draw;

/// A random orthogonal matrix.
pub fn orthogonal(draw: &mut Draw, n: usize) -> DMatrix<f64> {
    let random = DMatrix::from_fn(n, n, |i, j| draw.normal() + if i == j { 1e-3 } else { 0.0 });
    random.qr().q()
}

/// One rate, or a pair of rates `re +- i im`, of a linear system.
#[derive(Clone, Copy, Debug)]
struct Rate {
    re: f64,
    im: Option<f64>,
}

/// `y' = S D S^-1 y` with prescribed rates; the stiff ones decay over up to six decades of rates.
pub fn linear(draw: &mut Draw, stiff: bool) -> InitialValue {
    let mut rates = Vec::new();
    let blocks = draw.between(1, 3);
    for block in 0..blocks {
        let re = match stiff {
            true if block == 0 => -draw.log_uniform(0.1, 3.0),
            true => -draw.log_uniform(1.0, 1e6),
            false => draw.uniform(-3.0, 0.5),
        };
        let oscillates = draw.chance(0.5);
        let im = oscillates.then(|| match stiff {
            true => -re * draw.uniform(0.0, 1.0),
            false => draw.log_uniform(0.3, 20.0),
        });
        rates.push(Rate { re, im });
    }
    let n: usize = rates.iter().map(|rate| 1 + usize::from(rate.im.is_some())).sum();
    let scale = DMatrix::from_diagonal(&DVector::from_fn(n, |_, _| draw.log_uniform(0.1, 10.0)));
    let s = orthogonal(draw, n) * scale;
    let inverse = s.clone().try_inverse().expect("an orthogonal matrix, scaled");
    let start: Vec<f64> = (0..n).map(|_| draw.normal()).collect();
    let end = draw.uniform(0.3, 4.0);
    draw.note(format!("linear, rates {rates:?}, until {end}"));
    let block_diagonal = |at: &dyn Fn(&Rate) -> [f64; 2]| {
        let mut d = DMatrix::zeros(n, n);
        let mut i = 0;
        for rate in &rates {
            let [a, b] = at(rate);
            d[(i, i)] = a;
            if rate.im.is_some() {
                d[(i + 1, i + 1)] = a;
                d[(i, i + 1)] = -b;
                d[(i + 1, i)] = b;
                i += 1;
            }
            i += 1;
        }
        d
    };
    let a = &s * block_diagonal(&|rate| [rate.re, rate.im.unwrap_or(0.0)]) * &inverse;
    let columns = a.clone();
    let slope: Slope = Box::new(move |_, y, f| {
        let product = &a * DVector::from_column_slice(y);
        f.copy_from_slice(product.as_slice());
    });
    let derivative: Derivative = Box::new(move |_, _, df| df.copy_from_slice(columns.as_slice()));
    let start_again = DVector::from_column_slice(&start);
    let rates = rates.clone();
    InitialValue {
        name: "linear",
        slope,
        derivative,
        end,
        sizes: vec![1.0; n],
        truth: Some(Box::new(move |t| {
            let mut d = DMatrix::zeros(n, n);
            let mut i = 0;
            for rate in &rates {
                let grown = (rate.re * t).exp();
                let (sin, cos) = (rate.im.unwrap_or(0.0) * t).sin_cos();
                d[(i, i)] = grown * cos;
                if rate.im.is_some() {
                    d[(i + 1, i + 1)] = grown * cos;
                    d[(i, i + 1)] = -grown * sin;
                    d[(i + 1, i)] = grown * sin;
                    i += 1;
                }
                i += 1;
            }
            (&s * (d * (&inverse * &start_again))).as_slice().to_vec()
        })),
        stiff,
        masses: None,
        energy: None,
        start,
    }
}

/// Predators and prey: `x' = a x - b x y`, `y' = -c y + d x y`.
pub fn predators(draw: &mut Draw) -> InitialValue {
    let [a, b, c, d]: [f64; 4] = std::array::from_fn(|_| draw.log_uniform(0.3, 3.0));
    let start = vec![draw.log_uniform(0.3, 5.0), draw.log_uniform(0.3, 5.0)];
    let end = draw.uniform(1.0, 10.0);
    draw.note(format!("predators {a} {b} {c} {d} from {start:?} until {end}"));
    InitialValue {
        name: "predators",
        slope: Box::new(move |_, y, f| {
            f[0] = a * y[0] - b * y[0] * y[1];
            f[1] = -c * y[1] + d * y[0] * y[1];
        }),
        derivative: Box::new(move |_, y, df| {
            df.copy_from_slice(&[a - b * y[1], d * y[1], -b * y[0], -c + d * y[0]]);
        }),
        sizes: start.clone(),
        start,
        end,
        truth: None,
        stiff: false,
        masses: None,
        energy: None,
    }
}

/// Lorenz's equations over a short time.
pub fn lorenz(draw: &mut Draw) -> InitialValue {
    let [s, r, b] = [draw.uniform(5.0, 15.0), draw.uniform(10.0, 40.0), draw.uniform(1.0, 4.0)];
    let start = vec![draw.uniform(-10.0, 10.0), draw.uniform(-10.0, 10.0), draw.uniform(5.0, 30.0)];
    let end = draw.uniform(0.2, 4.0);
    draw.note(format!("lorenz {s} {r} {b} from {start:?} until {end}"));
    InitialValue {
        name: "lorenz",
        slope: Box::new(move |_, y, f| {
            f[0] = s * (y[1] - y[0]);
            f[1] = r * y[0] - y[1] - y[0] * y[2];
            f[2] = y[0] * y[1] - b * y[2];
        }),
        derivative: Box::new(move |_, y, df| {
            df.copy_from_slice(&[-s, r - y[2], y[1], s, -1.0, y[0], 0.0, -y[0], -b]);
        }),
        sizes: vec![10.0; 3],
        start,
        end,
        truth: None,
        stiff: false,
        masses: None,
        energy: None,
    }
}

/// `q^T K q / 2`.
pub fn quadratic(stiffness: &DMatrix<f64>) -> Energy {
    let stiffness = stiffness.clone();
    Box::new(move |q| {
        let q = DVector::from_column_slice(q);
        0.5 * q.dot(&(&stiffness * &q))
    })
}

/// Masses on springs in any directions: `M q'' = -K q`, whose motion is known.
pub fn oscillators(draw: &mut Draw) -> InitialValue {
    let n = draw.between(1, 4);
    let masses: Vec<f64> = (0..n).map(|_| draw.log_uniform(0.1, 10.0)).collect();
    let frequencies: Vec<f64> = (0..n).map(|_| draw.log_uniform(0.3, 10.0)).collect();
    let modes = orthogonal(draw, n);
    let start: Vec<f64> = (0..2 * n).map(|_| draw.normal()).collect();
    // Over at most eight turns: the errors of all steps add up.
    let fastest = frequencies.iter().copied().fold(0.0, f64::max);
    let end = draw.uniform(0.5, 10.0).min(50.0 / fastest);
    draw.note(format!("oscillators, masses {masses:?}, frequencies {frequencies:?}, until {end}"));
    let roots = DMatrix::from_diagonal(&DVector::from_fn(n, |i, _| masses[i].sqrt()));
    let squares = DVector::from_fn(n, |i, _| frequencies[i] * frequencies[i]);
    let stiffness = &roots * &modes * DMatrix::from_diagonal(&squares) * modes.transpose() * &roots;
    let (hessian, stiffness_again) = (stiffness.clone(), stiffness.clone());
    let field = mechanics(
        masses.clone(),
        move |q, dv| {
            dv.copy_from_slice((&stiffness * DVector::from_column_slice(q)).as_slice());
        },
        move |_, h| h.copy_from_slice(hessian.as_slice()),
    );
    let energy = quadratic(&stiffness_again);
    let begin = start.clone();
    let by_root = masses.clone();
    let truth = move |t: f64| {
        let x = DVector::from_fn(n, |i, _| begin[i] * by_root[i].sqrt());
        let v = DVector::from_fn(n, |i, _| begin[n + i] / by_root[i].sqrt());
        let (x, v) = (modes.tr_mul(&x), modes.tr_mul(&v));
        let turned = |i: usize| {
            let w: f64 = frequencies[i];
            let (sin, cos) = (w * t).sin_cos();
            [x[i] * cos + v[i] / w * sin, v[i] * cos - x[i] * w * sin]
        };
        let x = &modes * DVector::from_fn(n, |i, _| turned(i)[0]);
        let v = &modes * DVector::from_fn(n, |i, _| turned(i)[1]);
        let q = (0..n).map(|i| x[i] / by_root[i].sqrt());
        q.chain((0..n).map(|i| v[i] * by_root[i].sqrt())).collect()
    };
    let course = (start, vec![1.0; 2 * n], end);
    let problem = motion("oscillators", masses, field, Some(energy), course);
    InitialValue { truth: Some(Box::new(truth)), ..problem }
}

/// A row of masses between walls on springs that stiffen: `V = sum k d^2 / 2 + b d^4 / 4`.
pub fn stiffening_chain(draw: &mut Draw) -> InitialValue {
    let n = draw.between(1, 4);
    let masses: Vec<f64> = (0..n).map(|_| draw.log_uniform(0.3, 3.0)).collect();
    let (k, b) = (draw.log_uniform(0.1, 10.0), draw.log_uniform(0.1, 10.0));
    let start: Vec<f64> = (0..2 * n).map(|_| draw.normal()).collect();
    let end = draw.uniform(0.5, 10.0);
    draw.note(format!("stiffening chain, masses {masses:?}, {k} {b}, from {start:?} until {end}"));
    let stretch = |q: &[f64], i: usize| {
        let right = if i < q.len() { q[i] } else { 0.0 };
        right - if i > 0 { q[i - 1] } else { 0.0 }
    };
    let field = mechanics(
        masses.clone(),
        move |q, dv| {
            for (i, dv) in dv.iter_mut().enumerate() {
                let [left, right] = [stretch(q, i), stretch(q, i + 1)];
                *dv = k * (left - right) + b * (left.powi(3) - right.powi(3));
            }
        },
        move |q, h| {
            h.fill(0.0);
            for i in 0..=n {
                let d = stretch(q, i);
                let stiffness = k + 3.0 * b * d * d;
                for (row, sign_row) in [(i.wrapping_sub(1), -1.0), (i, 1.0)] {
                    for (column, sign) in [(i.wrapping_sub(1), -1.0), (i, 1.0)] {
                        if row < n && column < n {
                            h[row + n * column] += sign_row * sign * stiffness;
                        }
                    }
                }
            }
        },
    );
    let energy: Energy = Box::new(move |q| {
        let stretches = (0..=n).map(|i| stretch(q, i));
        stretches.map(|d| 0.5 * k * d * d + 0.25 * b * d.powi(4)).sum()
    });
    motion("stiffening chain", masses, field, Some(energy), (start, vec![1.0; 2 * n], end))
}
