//! Checks of derivatives, and derivatives made automatically.

use nalgebra::DMatrix;
use stationary_calculus::{
    Agreement, Automatic, Covector, DerivativeCheck, Energy, Flat, Number, Potential, Report, Sink,
    Vector, check_potential_on, differences,
};

use super::{any_vector, blocks, due_unless, size, springs};
use crate::{Draw, Verdict};

pub(super) fn check_sizes(draw: &mut Draw) -> Verdict {
    let (n, k) = (size(draw), size(draw));
    draw.note(format!("a potential of {n}, a q of {k}"));
    let checked = DerivativeCheck::default().potential(&springs(n), &vec![0.5; k]);
    due_unless(checked.is_ok() != (n == k), "sizes that do not fit, or fit and are refused")
}

/// On a space of any size with any potential at any numbers.
pub(super) fn check_on_space(draw: &mut Draw) -> Verdict {
    let (n, k) = (size(draw), size(draw));
    let q = if draw.chance(0.5) { vec![0.5; k] } else { any_vector(draw, k) };
    draw.note(format!("a potential of {n} on a flat space, q {q:?}"));
    let fits = n == k && q.iter().all(|&x| x == 0.5);
    match check_potential_on(&Flat, &springs(n), &q) {
        Err(_) => due_unless(fits, "what fits is refused"),
        Ok(_) => due_unless(n != k || q.iter().any(|x| !x.is_finite()), "Ok of what does not fit"),
    }
}

/// V = x^2/2 with a differential of another slope.
struct Steep(f64);

impl Potential for Steep {
    fn dim(&self) -> usize {
        1
    }

    fn energy(&self, q: &[f64]) -> f64 {
        0.5 * q[0] * q[0]
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        dv.0[0] += self.0 * q[0];
    }

    fn add_hessian(&self, _: &[f64], hessian: &mut impl Sink) {
        hessian.add_symmetric(&[0], &[self.0]);
    }
}

pub(super) fn check_settings(draw: &mut Draw) -> Verdict {
    let usual = DerivativeCheck::default();
    let check = DerivativeCheck {
        tolerance: if draw.chance(0.5) { draw.any_f64() } else { usual.tolerance },
        length: draw.chance(0.5).then(|| draw.any_f64()),
        configurations: draw.below(6),
        seed: draw.word(),
    };
    draw.note(format!("{check:?}"));
    let slope = draw.one_of(&[2.0, 0.5, -1.0]);
    let ratio = (slope - 1.0_f64).abs() / slope.abs();
    let blind = check.tolerance >= ratio || check.length.is_some_and(|l| !(1e-3..1e3).contains(&l));
    match check.potential(&Steep(slope), &[0.7]) {
        Err(_) => Verdict::due(),
        Ok(report) if check.tolerance.is_nan() => {
            Verdict::wrong(format!("passes to a tolerance of NaN, unseen {}", report.unseen()))
        }
        Ok(report) => {
            let unseen = report.unseen();
            let told = blind && (check.tolerance >= ratio || unseen >= 0.1 || !unseen.is_finite());
            due_unless(!told, &format!("passes {slope} for 1, unseen {unseen}"))
        }
    }
}

/// A potential without energy that gives any blocks.
struct AnyBlocks(usize, Vec<(Vec<usize>, Vec<f64>)>);

impl Potential for AnyBlocks {
    fn dim(&self) -> usize {
        self.0
    }

    fn energy(&self, _: &[f64]) -> f64 {
        0.0
    }

    fn add_differential(&self, _: &[f64], _: Covector<&mut [f64]>) {}

    fn add_hessian(&self, _: &[f64], hessian: &mut impl Sink) {
        for (freedoms, entries) in &self.1 {
            hessian.add_symmetric(freedoms, entries);
        }
    }
}

pub(super) fn check_blocks(draw: &mut Draw) -> Verdict {
    let n = size(draw);
    let potential = AnyBlocks(n, blocks(draw, n));
    draw.note(format!("{n} freedoms, {:?}", potential.1));
    let fits = potential.1.iter().all(|(freedoms, entries)| {
        entries.len() == freedoms.len() * freedoms.len() && freedoms.iter().all(|&f| f < n)
    });
    // Below the normal numbers all is rounding.
    let none = |x: &f64| x.abs() < f64::MIN_POSITIVE;
    let nothing = potential.1.iter().all(|(_, entries)| entries.iter().all(none));
    let checked = DerivativeCheck::default().potential(&potential, &vec![0.5; n]);
    // Blocks that cancel are no mistake, and these are too few to.
    due_unless(
        checked.is_ok() && (!fits || potential.1.len() == 1 && !nothing),
        "passes blocks that do not fit",
    )
}

pub(super) fn check_jacobian(draw: &mut Draw) -> Verdict {
    let (n, m, rows, columns) = (size(draw), size(draw), size(draw), size(draw));
    let later = if draw.chance(0.3) { size(draw) } else { m };
    draw.note(format!("q of {n}, f of {m} and then {later}, a matrix of {rows} x {columns}"));
    let q = vec![0.5; n];
    let f = |x: &[f64]| vec![0.0; if x == q.as_slice() { m } else { later }];
    let df = |_: &[f64]| DMatrix::zeros(rows, columns);
    let checked = DerivativeCheck::default().jacobian(f, df, &q);
    let fits = rows == m && columns == n && (later == m || n == 0);
    due_unless(checked.is_ok() != fits, "sizes that do not fit, or fit and are refused")
}

pub(super) fn figure(draw: &mut Draw) -> Verdict {
    let (n, m, k) = (size(draw), size(draw), size(draw));
    let (rows, columns) = (size(draw), size(draw));
    let later = if draw.chance(0.3) { size(draw) } else { m };
    draw.note(format!("q of {n}, w of {k}, f of {m} and then {later}, {rows} x {columns}"));
    let q = vec![0.5; n];
    let f = |x: &[f64]| vec![1.0; if x == q.as_slice() { m } else { later }];
    let steps = any_vector(draw, 3);
    let w = vec![1.0; k];
    let made = differences(f, &DMatrix::zeros(rows, columns), &q, Vector(&w[..]), &steps);
    match made {
        Ok(_) if rows != m || columns != n || k != n => {
            Verdict::wrong("Ok of sizes that do not fit")
        }
        Ok(made) => {
            // Whatever the steps were, what is printed of them is text.
            due_unless(made.to_string().is_empty(), "nothing is printed")
        }
        Err(_) => Verdict::due(),
    }
}

struct Well;

impl Energy<2> for Well {
    fn energy<R: Number>(&self, [x, y]: [R; 2]) -> R {
        (x * x - 1.0).powi(2) + y * y
    }
}

pub(super) fn automatic(draw: &mut Draw) -> Verdict {
    let k = size(draw);
    let q = any_vector(draw, k);
    draw.note(format!("q {q:?}"));
    let well = Automatic(Well);
    let checked = DerivativeCheck::default().potential(&well, &q);
    let Ok(report) = checked else { return Verdict::due() };
    if k != 2 {
        return Verdict::wrong("Ok of another size");
    }
    let Report { agreements } = report;
    let blind = |part: &Agreement| part.unseen.is_nan();
    due_unless(agreements.iter().any(blind), "blind to NaN")
}
