//! Newton's method and its equations.

use stationary_calculus::{
    Equation, FunctionEquation, JacobianEntries, Newton, NewtonMemory, SparseEquation,
};

use super::{any, any_vector, due_unless, finite, size};
use crate::{Draw, Verdict};

fn square_root_of_two() -> impl Equation {
    FunctionEquation::new(
        1,
        |x: &[f64], f: &mut [f64]| f[0] = x[0] * x[0] - 2.0,
        |x: &[f64], df: &mut [f64]| df[0] = 2.0 * x[0],
    )
}

pub(super) fn newton_settings(draw: &mut Draw) -> Verdict {
    let tolerance = draw.any_f64();
    let newton = Newton { tolerance, iterations: draw.one_of(&[0, 1, 50, 1 << 16]) };
    draw.note(format!("{newton:?}"));
    let mut memory = match NewtonMemory::<[f64; 1]>::new(1, 50) {
        Some(memory) => memory,
        None => return Verdict::wrong("no memory for one unknown"),
    };
    let mut x = [2.0];
    match newton.solve(&mut square_root_of_two(), &mut x, &mut memory) {
        Err(_) => Verdict::due(),
        Ok(report) => {
            let residual = (x[0] * x[0] - 2.0).abs();
            let promised = tolerance.max(1e-15 * 4.0);
            due_unless(
                residual.is_nan() || residual > promised,
                &format!("Ok with a residual of {residual}: {report:?}"),
            )
        }
    }
}

pub(super) fn newton_sizes(draw: &mut Draw) -> Verdict {
    let (n, m, k) = (size(draw), size(draw), size(draw));
    draw.note(format!("{n} equations, {m} in memory, {k} unknowns"));
    let mut equation = FunctionEquation::new(
        n,
        |x: &[f64], f: &mut [f64]| {
            for i in 0..n {
                f[i] = x[i] - 1.0;
            }
        },
        |_: &[f64], df: &mut [f64]| (0..n).for_each(|i| df[i + n * i] = 1.0),
    );
    let Some(mut memory) = NewtonMemory::<Vec<f64>>::new(m, 50) else {
        return Verdict::wrong("no memory for a few unknowns");
    };
    let mut x = vec![0.5; k];
    let solved = Newton::default().solve(&mut equation, &mut x, &mut memory);
    match solved {
        Ok(_) if n == m && m == k => due_unless(x.iter().any(|&x| x != 1.0), "no root"),
        Ok(_) => Verdict::wrong("Ok of sizes that do not fit"),
        Err(error) if n == m && m == k => Verdict::wrong(error),
        Err(_) => Verdict::due(),
    }
}

pub(super) fn newton_numbers(draw: &mut Draw) -> Verdict {
    let (a, b, guess) = (any(draw), any(draw), any(draw));
    draw.note(format!("{a} x + {b} = 0 from {guess}"));
    let mut equation = FunctionEquation::new(
        1,
        |x: &[f64], f: &mut [f64]| f[0] = a * x[0] + b,
        |_: &[f64], df: &mut [f64]| df[0] = a,
    );
    let Some(mut memory) = NewtonMemory::<[f64; 1]>::new(1, 50) else {
        return Verdict::wrong("no memory for one unknown");
    };
    let mut x = [guess];
    let solved = Newton::default().solve(&mut equation, &mut x, &mut memory);
    let finite_answer = finite(solved.as_ref().map(|_| &x[..]));
    let residual = finite(solved.as_ref().map(|report| std::slice::from_ref(&report.residual)));
    finite_answer.and(residual)
}

pub(super) fn newton_memory(draw: &mut Draw) -> Verdict {
    let (n, iterations) = (draw.between(0, 1 << 16), draw.between(0, 1 << 20));
    let made = NewtonMemory::<Vec<f64>>::new(n, iterations).is_some();
    let other = NewtonMemory::<[f64; 2]>::new(n, iterations).is_some();
    due_unless(!made || other != (n == 2), "memory of another size")
}

pub(super) fn sparse_equation(draw: &mut Draw) -> Verdict {
    let (n, k) = (size(draw), size(draw));
    let diagonal = any_vector(draw, n);
    let Ok(mut equation) = SparseEquation::new(
        &vec![0.0; n],
        |x: &[f64], f: &mut [f64]| (0..n).for_each(|i| f[i] = diagonal[i] * x[i] - 1.0),
        |_: &[f64], df: &mut JacobianEntries<'_>| {
            (0..n).for_each(|i| df.add(i, i, diagonal[i]));
        },
    ) else {
        return Verdict::wrong("not analysed");
    };
    let Some(mut memory) = NewtonMemory::<Vec<f64>>::new(k, 50) else {
        return Verdict::wrong("no memory for a few unknowns");
    };
    draw.note(format!("{n} equations, {k} unknowns, {diagonal:?}"));
    let mut x = vec![0.5; k];
    match Newton::default().solve(&mut equation, &mut x, &mut memory) {
        Ok(_) if n != k => Verdict::wrong("Ok of sizes that do not fit"),
        solved => finite(solved.map(|_| &x[..])),
    }
}
