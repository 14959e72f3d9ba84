//! Roots that are known, of functions of every scale, and functions without a root.

use nalgebra::{DMatrix, DVector};
use stationary_calculus::{FunctionEquation, Newton, NewtonMemory, SparseEquation};

use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "newton",
    krate: "calculus",
    rule: "Ok where there is no root, or where the residual exceeds both the tolerance and a thousand \
           roundings of its terms; an error from a guess beside a simple root",
    in_tests: 500,
    trial,
};

/// f_i(x) = s_i (g_i(x) - g_i(root)), with g = A x + c * a function of each.
struct System {
    a: DMatrix<f64>,
    bend: f64,
    root: DVector<f64>,
    scale: f64,
    shape: usize,
}

impl System {
    fn one(&self, x: f64) -> [f64; 2] {
        match self.shape {
            0 => [x * x, 2.0 * x],
            1 => [x * x * x, 3.0 * x * x],
            2 => [x.sin(), x.cos()],
            _ => [x.exp(), x.exp()],
        }
    }

    fn value(&self, x: &[f64]) -> DVector<f64> {
        let x = DVector::from_column_slice(x);
        let bend = |x: &DVector<f64>| x.map(|x| self.bend * self.one(x)[0]);
        (&self.a * (&x - &self.root) + bend(&x) - bend(&self.root)) * self.scale
    }

    fn matrix(&self, x: &[f64]) -> DMatrix<f64> {
        let mut df = self.a.clone();
        for (i, &x) in x.iter().enumerate() {
            df[(i, i)] += self.bend * self.one(x)[1];
        }
        df * self.scale
    }

    /// The size of the numbers that a residual is the sum of.
    fn terms(&self, x: &[f64]) -> f64 {
        let x = DVector::from_column_slice(x);
        let both = x.abs() + self.root.abs();
        let each = |x: f64| (self.bend * self.one(x)[0]).abs() + (x * self.one(x)[1]).abs();
        let bends = x.map(each).amax() + self.root.map(each).amax();
        ((self.a.abs() * both).amax() + bends) * self.scale
    }
}

fn trial(draw: &mut Draw) -> Verdict {
    if draw.chance(0.25) { without_a_root(draw) } else { with_a_root(draw) }
}

fn scale(draw: &mut Draw) -> f64 {
    match draw.below(3) {
        0 => 1.0,
        _ => 10.0_f64.powf(draw.uniform(-280.0, 280.0)),
    }
}

fn with_a_root(draw: &mut Draw) -> Verdict {
    let n = draw.one_of(&[1, 1, 2, 3, 5, 12]);
    let scale = scale(draw);
    let far = draw.one_of(&[1.0, 1.0, 1e-3, 10.0]);
    let root = DVector::from_fn(n, |_, _| {
        let x = draw.uniform(0.5, 2.0) * far;
        if draw.chance(0.3) { -x } else { x }
    });
    let mut a = DMatrix::from_fn(n, n, |_, _| draw.symmetric());
    for i in 0..n {
        // Dominant, so that the root is simple and near guesses lead to it.
        a[(i, i)] += n as f64 + 1.0;
    }
    let (bend, shape) = (0.1 * draw.symmetric(), draw.below(4));
    let mut system = System { a, bend, root, scale, shape };
    // The bends' slopes stay far below what dominates the matrix.
    let steepest = system.root.map(|x| system.one(1.2 * x)[1].abs()).amax();
    system.bend /= steepest.max(1.0);
    let guess: Vec<f64> = system.root.iter().map(|x| x * (1.0 + 0.1 * draw.symmetric())).collect();
    let tolerance = draw.one_of(&[0.0, 0.0, 1e-14, 1e-10]) * system.terms(&guess);
    let newton = Newton { tolerance, iterations: draw.one_of(&[50, 30]) };
    draw.note(format!("n {n}, scale {scale:e}, shape {}, bend {}", system.shape, system.bend));
    draw.note(format!("root {:?}, guess {guess:?}, {newton:?}", system.root.as_slice()));
    let mut x = guess.clone();
    let solved = solve(draw, &system, newton, &mut x);
    match solved {
        Err(error) => Verdict::wrong(format!("from beside a simple root: {error}")),
        Ok(()) => {
            let residual = (system.value(&x) / system.scale).norm();
            let rounding = 1e3 * f64::EPSILON * system.terms(&x) / system.scale * n as f64;
            let promised = rounding.max(tolerance / system.scale * (1.0 + 1e-9));
            Verdict::of(residual, promised, "the residual")
        }
    }
}

fn solve(
    draw: &mut Draw,
    system: &System,
    newton: Newton,
    x: &mut [f64],
) -> Result<(), Box<dyn std::error::Error>> {
    let n = x.len();
    let f = |x: &[f64], f: &mut [f64]| f.copy_from_slice(system.value(x).as_slice());
    let mut memory =
        NewtonMemory::<Vec<f64>>::new(n, newton.iterations).ok_or("no memory for the unknowns")?;
    if draw.chance(0.5) {
        let df = |x: &[f64], df: &mut [f64]| df.copy_from_slice(system.matrix(x).as_slice());
        newton.solve(&mut FunctionEquation::new(n, f, df), x, &mut memory)?;
    } else {
        let df = |x: &[f64], df: &mut stationary_calculus::JacobianEntries<'_>| {
            let matrix = system.matrix(x);
            for j in 0..n {
                (0..n).for_each(|i| df.add(i, j, matrix[(i, j)]));
            }
        };
        let mut equation = SparseEquation::new(x, f, df)?;
        newton.solve(&mut equation, x, &mut memory)?;
    }
    Ok(())
}

/// s (x^2 + c), s (1 + x^4), s exp(x), s cosh(x): never zero.
fn without_a_root(draw: &mut Draw) -> Verdict {
    let scale = scale(draw);
    let c = draw.log_uniform(1e-6, 1e3);
    let shape = draw.below(3);
    let guess = draw.one_of(&[1.0, 10.0]) * draw.symmetric();
    draw.note(format!("no root: shape {shape}, scale {scale:e}, c {c}, guess {guess}"));
    let at = |x: f64| match shape {
        0 => [x * x + c, 2.0 * x],
        1 => [c + x.powi(4), 4.0 * x.powi(3)],
        _ => [c * x.cosh(), c * x.sinh()],
    };
    let mut equation = FunctionEquation::new(
        1,
        |x: &[f64], f: &mut [f64]| f[0] = scale * at(x[0])[0],
        |x: &[f64], df: &mut [f64]| df[0] = scale * at(x[0])[1],
    );
    let Some(mut memory) = NewtonMemory::<[f64; 1]>::new(1, 50) else {
        return Verdict::wrong("no memory for one unknown");
    };
    let mut x = [guess];
    match Newton::default().solve(&mut equation, &mut x, &mut memory) {
        Ok(report) => Verdict::wrong(format!("a root of what has none, at {x:?}: {report:?}")),
        Err(_) => Verdict::due(),
    }
}
