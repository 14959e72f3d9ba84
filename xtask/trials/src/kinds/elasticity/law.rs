//! Energy densities as textbooks write them, over any number: the trials' own materials.
//!
//! ```text
//! C = F^T F - I = G + G^T + G^T G,  F = I + G;      J - 1 = tr G + II(G) + det G
//! quadratic   mu/4 tr C^2 + lambda/8 (tr C)^2        linear  mu tr e^2 + lambda/2 (tr e)^2
//! neo-Hookean m/2 [I - d - log((I + 1)/(d + 1))] + l/2 (J - 1)^2 - mu (J - 1)
//! corotated   mu |F - R|^2 + lambda/2 (J - 1)^2
//! ```
//! Of the neo-Hookean law the terms of first order are taken out by hand, so that 32 digits do at
//! strains of 1e-12.

use super::field::{Field, Hyper};

/// The crate's isotropic laws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    Linear,
    Quadratic,
    NeoHookean,
    Corotated,
}

impl Law {
    pub const ALL: [Law; 4] = [Law::Linear, Law::Quadratic, Law::NeoHookean, Law::Corotated];
}

/// Lame's pair.
#[derive(Clone, Copy, Debug)]
pub struct Moduli {
    pub lambda: f64,
    pub mu: f64,
}

impl Moduli {
    pub fn size(&self) -> f64 {
        self.lambda.abs() + 2.0 * self.mu
    }
}

/// F by columns: R of D entries.
pub type Columns<S> = Vec<Vec<S>>;

fn sum<S: Field>(terms: impl Iterator<Item = S>) -> S {
    terms.fold(S::of(0.0), |sum, term| sum + term)
}

fn dot<S: Field>(a: &[S], b: &[S]) -> S {
    sum(a.iter().zip(b).map(|(&a, &b)| a * b))
}

/// `F - I`, of the first R directions where the body is thinner than its space.
fn beyond<S: Field>(f: &Columns<S>) -> Columns<S> {
    let mut g = f.clone();
    for (k, column) in g.iter_mut().enumerate() {
        column[k] = column[k] - S::of(1.0);
    }
    g
}

/// `F^T F - I`.
pub fn twice_green<S: Field>(f: &Columns<S>) -> Columns<S> {
    let g = beyond(f);
    let r = g.len();
    (0..r).map(|k| (0..r).map(|l| g[k][l] + g[l][k] + dot(&g[k], &g[l])).collect()).collect()
}

/// `J - 1`.
pub fn growth<S: Field>(f: &Columns<S>) -> S {
    let g = beyond(f);
    let minor = |i: usize, j: usize| g[i][i] * g[j][j] - g[i][j] * g[j][i];
    match g.len() {
        1 => g[0][0],
        2 => g[0][0] + g[1][1] + minor(0, 1),
        _ => {
            let trace = g[0][0] + g[1][1] + g[2][2];
            trace + minor(0, 1) + minor(1, 2) + minor(2, 0) + determinant(&g)
        }
    }
}

pub fn determinant<S: Field>(f: &Columns<S>) -> S {
    match f.len() {
        1 => f[0][0],
        2 => f[0][0] * f[1][1] - f[0][1] * f[1][0],
        _ => sum((0..3).map(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            f[0][i] * (f[1][j] * f[2][k] - f[1][k] * f[2][j])
        })),
    }
}

/// `F^-T`, of two or three columns.
fn inverse_transposed<S: Field>(f: &Columns<S>) -> Columns<S> {
    let d = determinant(f);
    if f.len() == 2 {
        return vec![vec![f[1][1] / d, -f[1][0] / d], vec![-f[0][1] / d, f[0][0] / d]];
    }
    let cofactor = |k: usize, i: usize| {
        let (l, m) = ((k + 1) % 3, (k + 2) % 3);
        let (a, b) = ((i + 1) % 3, (i + 2) % 3);
        f[l][a] * f[m][b] - f[l][b] * f[m][a]
    };
    (0..3).map(|k| (0..3).map(|i| cofactor(k, i) / d).collect()).collect()
}

/// The rotation nearest to F: by Newton's iteration in space, where J > 0.
fn rotation<S: Field>(f: &Columns<S>) -> Columns<S> {
    if f.len() == 2 {
        let (a, b) = (f[0][0] + f[1][1], f[0][1] - f[1][0]);
        let length = (a * a + b * b).root();
        let (a, b) = (a / length, b / length);
        return vec![vec![a, b], vec![-b, a]];
    }
    let mut x = f.clone();
    let mut since = 0;
    for _ in 0..200 {
        let inverse = inverse_transposed(&x);
        let mut change = 0.0_f64;
        for (column, other) in x.iter_mut().zip(&inverse) {
            for (entry, &other) in column.iter_mut().zip(other) {
                let next = (*entry + other) * S::of(0.5);
                change = change.max((next - *entry).near().abs());
                *entry = next;
            }
        }
        since = if change < 1e-13 { since + 1 } else { 0 };
        // Derivatives are one and two steps behind.
        if since == 5 {
            break;
        }
    }
    x
}

/// The energy density of a law.
pub fn density<S: Field>(law: Law, pair: Moduli, f: &Columns<S>) -> S {
    let (lambda, mu) = (S::of(pair.lambda), S::of(pair.mu));
    let half = S::of(0.5);
    let quadratic = |e: &Columns<S>| {
        let square = sum(e.iter().map(|column| dot(column, column)));
        let trace = sum((0..e.len()).map(|k| e[k][k]));
        mu * square + half * lambda * trace * trace
    };
    let halved = |c: Columns<S>| -> Columns<S> {
        c.into_iter().map(|column| column.into_iter().map(|x| x * half).collect()).collect()
    };
    match law {
        Law::Linear => {
            let g = beyond(f);
            let r = g.len();
            quadratic(&halved(
                (0..r).map(|k| (0..r).map(|l| g[k][l] + g[l][k]).collect()).collect(),
            ))
        }
        Law::Quadratic => quadratic(&halved(twice_green(f))),
        Law::NeoHookean => {
            let d = f.len() as f64;
            let m = mu * S::of(d + 1.0) / S::of(d);
            let l = lambda + mu - S::of(2.0) * mu / S::of(d * (d + 1.0));
            let g = beyond(f);
            let c = twice_green(f);
            let trace = sum((0..c.len()).map(|k| c[k][k]));
            let grown = growth(f);
            let square = sum(g.iter().map(|column| dot(column, column)));
            // (I - d)/2 - (J - 1): the traces of G cancel.
            let plain = sum((0..c.len()).map(|k| g[k][k]));
            let mixed = half * square - (grown - plain);
            let y = trace / S::of(d + 1.0);
            mu * mixed + half * m * y.excess_over_log() + half * l * grown * grown
        }
        Law::Corotated => {
            let r = rotation(f);
            let difference = f
                .iter()
                .zip(&r)
                .map(|(f, r)| sum(f.iter().zip(r).map(|(&f, &r)| (f - r) * (f - r))));
            let grown = growth(f);
            mu * sum(difference) + half * lambda * grown * grown
        }
    }
}

/// A function of F with its derivatives along two directions.
pub fn derivatives<S: Field>(
    f: &[Vec<f64>],
    [a, b]: [&[Vec<f64>]; 2],
    of: impl Fn(&Columns<Hyper<S>>) -> Hyper<S>,
) -> Hyper<S> {
    let entry = |k: usize, i: usize| Hyper {
        value: S::of(f[k][i]),
        first: S::of(a[k][i]),
        second: S::of(b[k][i]),
        both: S::of(0.0),
    };
    let f = (0..f.len()).map(|k| (0..f[k].len()).map(|i| entry(k, i)).collect()).collect();
    of(&f)
}

/// The unit direction of one entry.
pub fn unit(shape: &[Vec<f64>], (k, i): (usize, usize)) -> Columns<f64> {
    let mut unit: Columns<f64> = shape.iter().map(|column| vec![0.0; column.len()]).collect();
    unit[k][i] = 1.0;
    unit
}

/// The stress of a density, by columns.
pub fn stress<S: Field>(
    f: &[Vec<f64>],
    of: impl Fn(&Columns<Hyper<S>>) -> Hyper<S>,
) -> Columns<f64> {
    (0..f.len())
        .map(|k| {
            let entry = |i| {
                let unit = unit(f, (k, i));
                derivatives(f, [&unit, &unit], &of).first.near()
            };
            (0..f[k].len()).map(entry).collect()
        })
        .collect()
}

/// Runs what follows with the material of a law.
macro_rules! with_material {
    ($law:expr, $lame:expr, $d:tt, $material:ident => $body:expr) => {
        match $law {
            Law::Linear => {
                let $material = Linear::<$d>::new($lame);
                $body
            }
            Law::Quadratic => {
                let $material = SaintVenantKirchhoff::<$d>::new($lame);
                $body
            }
            Law::NeoHookean => match NeoHookean::<$d>::new($lame) {
                Ok($material) => $body,
                Err(error) => return Verdict::refused(error),
            },
            Law::Corotated => match FixedCorotated::<$d>::new($lame) {
                Ok($material) => $body,
                Err(error) => return Verdict::refused(error),
            },
        }
    };
}
pub(super) use with_material;
