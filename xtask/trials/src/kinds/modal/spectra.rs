//! Modes of matrices that were made from their spectra.

use stationary_calculus::{Covector, Metric, Vector};
use stationary_modal::{Linearized, Modes, RigidMotions};

use super::prescribed::{Mass, Quadratic, chains, dense, sparse};
use crate::{Draw, Verdict};

/// A list of eigenvalues, ugly ones over-represented.
fn spectrum(draw: &mut Draw, n: usize) -> (&'static str, Vec<f64>) {
    let ones = vec![1.0; n];
    match draw.below(8) {
        0 => {
            let values: Vec<f64> =
                (0..draw.between(1, 5)).map(|_| draw.log_uniform(0.1, 1e3)).collect();
            ("few distinct values", ones.iter().map(|_| draw.one_of(&values)).collect())
        }
        1 => {
            let multiplicity = draw.between(1, 50.min(n));
            let rest = (multiplicity..n).map(|_| draw.uniform(1.001, 50.0));
            ("the lowest many times", ones[..multiplicity].iter().copied().chain(rest).collect())
        }
        2 => ("a range of 1e12", ones.iter().map(|_| draw.log_uniform(1e-6, 1e6)).collect()),
        3 => ("even", ones.iter().map(|_| draw.uniform(0.1, 1.0)).collect()),
        4 => {
            let width = draw.log_uniform(1e-14, 1e-2);
            let size = draw.between(1, n);
            let cluster = ones[..size].iter().map(|_| 1.0 + width * draw.unit());
            let cluster: Vec<f64> = cluster.collect();
            let rest = (size..n).map(|_| draw.uniform(0.5, 20.0));
            ("a cluster", cluster.into_iter().chain(rest).collect())
        }
        5 => {
            let zeros = draw.between(1, n);
            let rest = (zeros..n).map(|_| draw.log_uniform(1e-3, 10.0));
            ("zero modes", vec![0.0; zeros].into_iter().chain(rest).collect())
        }
        6 => {
            // Shifts that make such a stiffness definite come near to these.
            let below = draw.between(1, 3.min(n));
            let negative: Vec<f64> = (0..below).map(|_| -draw.log_uniform(1e-12, 10.0)).collect();
            let rest = (below..n).map(|_| draw.log_uniform(1e-6, 10.0));
            ("some below zero", negative.into_iter().chain(rest).collect())
        }
        _ => {
            let gap = draw.log_uniform(1e-15, 1e-3);
            ("pairs", (0..n).map(|i| (1 + i / 2) as f64 * (1.0 + gap * (i % 2) as f64)).collect())
        }
    }
}

fn count(draw: &mut Draw, n: usize) -> usize {
    match draw.below(4) {
        _ if n > 600 => draw.between(1, 60),
        0 => draw.between(1, 3.min(n)),
        1 => draw.between(1, n),
        2 => draw.between(1, 20.min(n)),
        _ => n,
    }
}

pub(super) fn trial(draw: &mut Draw) -> Verdict {
    // Too large to be solved whole where iteration fails.
    let is_large = draw.chance(0.03);
    let (mass, potential, mut exact) = if draw.chance(0.15) {
        let (copies, length) =
            (draw.between(1, if is_large { 300 } else { 60 }), draw.between(1, 8));
        draw.note(format!("{copies} equal chains of {length}"));
        chains(draw, copies, length)
    } else {
        let is_dense = draw.chance(0.5) && !is_large;
        let n = match draw.below(3) {
            _ if is_large => draw.between(601, 1200),
            0 => draw.between(1, 12),
            1 => draw.between(40, 60),
            _ => draw.between(1, if is_dense { 90 } else { 250 }),
        };
        let (words, mut values) = spectrum(draw, n);
        let size = if draw.chance(0.3) { draw.log_uniform(1e-9, 1e9) } else { 1.0 };
        values.iter_mut().for_each(|value| *value *= size);
        let build = if is_dense { "dense" } else { "sparse" };
        draw.note(format!("{build}, {n} freedoms: {words}, times {size:e}"));
        let (mass, potential) = if is_dense { dense(draw, &values) } else { sparse(draw, &values) };
        (mass, potential, values)
    };
    exact.sort_by(f64::total_cmp);
    let n = exact.len();
    let count = count(draw, n);
    draw.note(format!("{count} modes; lowest {:.17?}", &exact[..8.min(n)]));
    let largest = exact.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let at_rest = vec![0.0; n];
    let mut system = match Linearized::at(&mass, &potential, &at_rest, 0.0) {
        Ok(system) => system,
        Err(_) if largest == 0.0 => return Verdict::due(),
        Err(error) => return Verdict::refused(error),
    };
    let modes = match system.lowest(count, &RigidMotions::none()) {
        Ok(modes) => modes,
        Err(error) => return Verdict::refused(shape(&error.to_string())),
    };
    let kept = draw.between(0, count);
    // A wrong mode is told before a wrong certificate of it.
    let verdict = judge(&mass, &potential, &exact, largest, count, &modes);
    if matches!(verdict, Verdict::Wrong { .. }) {
        return verdict;
    }
    let verdict = verdict.and(certificate(&exact, largest, &modes, "of lowest"));
    let mut fewer = modes;
    fewer.truncate(kept);
    verdict.and(certificate(&exact, largest, &fewer, "after truncate"))
}

/// An error's words without its numbers, so that equal ones are counted together.
fn shape(words: &str) -> String {
    words.chars().filter(|c| !c.is_ascii_digit()).collect()
}

fn judge(
    mass: &Mass,
    potential: &Quadratic,
    exact: &[f64],
    largest: f64,
    count: usize,
    modes: &Modes,
) -> Verdict {
    if modes.len() != count {
        return Verdict::wrong(format!("{} modes instead of {count}", modes.len()));
    }
    let n = exact.len();
    let rounding = 1e-12 * n as f64 * largest;
    let mut verdict = Verdict::due();
    let columns: Vec<&[f64]> = (0..count).map(|i| modes.vector(i).expect("a mode").0).collect();
    let mut moved = vec![vec![0.0; n]; count];
    for (x, mx) in columns.iter().zip(&mut moved) {
        mass.flat(Vector(x), Covector(mx));
    }
    for i in 0..count {
        let (value, stated) = (modes.values()[i], modes.residuals()[i]);
        let mut r = potential.times(columns[i]);
        r.iter_mut().zip(&moved[i]).for_each(|(r, mx)| *r -= value * mx);
        let mut a = vec![0.0; n];
        mass.sharp(Covector(&r), Vector(&mut a));
        let own = r.iter().zip(&a).map(|(r, a)| r * a).sum::<f64>().max(0.0).sqrt();
        let off = (value - exact[i]).abs();
        let product = |j: usize| columns[j].iter().zip(&moved[i]).map(|(x, y)| x * y).sum::<f64>();
        let skew = (0..=i).map(|j| (product(j) - if i == j { 1.0 } else { 0.0 }).abs());
        let skew = skew.fold(0.0, |worst, x| if x <= worst { worst } else { x });
        verdict = verdict
            .and(Verdict::of(off, stated + rounding, &format!("value {i} ({value:e})")))
            .and(Verdict::of(own, 1e-8 * largest, &format!("the residual of mode {i}")))
            .and(Verdict::of((own - stated).abs(), 1e-3 * own + rounding, "the stated residual"))
            .and(Verdict::of(skew, 1e-9, "products in the mass"));
    }
    verdict
}

/// Below `complete_below` are no more prescribed values than modes; both are counted so that rounding
/// of the construction does not decide.
fn certificate(exact: &[f64], largest: f64, modes: &Modes, when: &str) -> Verdict {
    let limit = modes.complete_below();
    if limit.is_nan() {
        return Verdict::refused("no certificate");
    }
    let rounding = 1e-12 * exact.len() as f64 * largest;
    let there = exact.iter().filter(|value| **value < limit - rounding).count();
    let given = modes.values().iter().filter(|value| **value < limit + rounding).count();
    if there <= given {
        Verdict::due()
    } else {
        Verdict::wrong(format!("{when}: complete below {limit:e} with {given} of {there} modes"))
    }
}
