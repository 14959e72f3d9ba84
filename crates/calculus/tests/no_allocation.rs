//! What is done in every step takes no memory: counted by an allocator.
//!
//! Memory is taken when a solver is made; after that, refilling, factoring and solving count zero.

use std::hint::black_box;

use allocation_counter::measure;
use stationary_calculus::{
    Curvature, DenseSolver, DiagonalMetric, FunctionEquation, HessianSolver, Newton, NewtonMemory,
    Rung, Stencil, StencilHessian, Stencils,
};

/// A spring of stiffness 1 and length 1 between two vertices in the plane.
struct Spring([usize; 2]);

impl Stencil<2, 2> for Spring {
    fn vertices(&self) -> [usize; 2] {
        self.0
    }

    fn energy(&self, [x, y]: &[[f64; 2]; 2]) -> f64 {
        0.5 * ((y[0] - x[0]).hypot(y[1] - x[1]) - 1.0).powi(2)
    }

    fn differential(&self, [x, y]: &[[f64; 2]; 2]) -> [[f64; 2]; 2] {
        let d = [y[0] - x[0], y[1] - x[1]];
        let length = d[0].hypot(d[1]);
        let force = d.map(|d| (1.0 - 1.0 / length) * d);
        [force.map(|f| -f), force]
    }

    fn hessian(&self, [x, y]: &[[f64; 2]; 2], _: Curvature) -> StencilHessian<2, 2> {
        let d = [y[0] - x[0], y[1] - x[1]];
        let length = d[0].hypot(d[1]);
        let mut hessian = StencilHessian::default();
        for (b, column) in hessian.as_flattened_mut().iter_mut().enumerate() {
            for (a, entry) in column.as_flattened_mut().iter_mut().enumerate() {
                let (i, j) = (a % 2, b % 2);
                let along = d[i] * d[j] / (length * length * length);
                let across = if i == j { 1.0 - 1.0 / length } else { 0.0 };
                *entry = if a / 2 == b / 2 { across + along } else { -across - along };
            }
        }
        hessian
    }
}

/// A hanging net of `side` x `side` vertices, slightly stretched, its first row pinned.
fn net(side: usize) -> (DiagonalMetric<Vec<f64>>, Stencils<Spring, 2, 2>, Vec<f64>) {
    let free = (side - 1) * side;
    let vertex = |row: usize, column: usize| {
        if row == 0 { free + column } else { (row - 1) * side + column }
    };
    let position = |row: usize, column: usize| [1.1 * column as f64, -1.2 * row as f64];
    let mut springs = Vec::new();
    let mut q = Vec::new();
    for row in 0..side {
        for column in 0..side {
            if row > 0 {
                springs.push(Spring([vertex(row - 1, column), vertex(row, column)]));
                q.extend(position(row, column));
            }
            if column > 0 {
                springs.push(Spring([vertex(row, column - 1), vertex(row, column)]));
            }
        }
    }
    let pins = (0..side).map(|column| position(0, column)).collect();
    let metric = DiagonalMetric::particles::<2>(&vec![1.0; free]).unwrap();
    (metric, Stencils::new(free, pins, springs).unwrap(), q)
}

#[test]
fn the_counter_counts() {
    assert_eq!(measure(|| drop(black_box(vec![1.0; 3]))).count_total, 1);
}

#[test]
fn newtons_method_solves_without_allocation() {
    let mut equation = FunctionEquation::new(
        2,
        |x: &[f64], f: &mut [f64]| {
            f.copy_from_slice(&[x[0] * x[0] + x[1] * x[1] - 4.0, x[0] * x[1] - 1.0]);
        },
        |x: &[f64], df: &mut [f64]| df.copy_from_slice(&[2.0 * x[0], x[1], 2.0 * x[1], x[0]]),
    );
    let newton = Newton::default();
    let mut memory = NewtonMemory::<[f64; 2]>::new(2, newton.iterations).unwrap();
    let solve = || newton.solve(&mut equation, &mut [2.5, 0.2], &mut memory).map(drop);
    assert_eq!(measure(|| assert_eq!({ solve }(), Ok(()))).count_total, 0);
}

#[test]
fn a_dense_solver_factors_and_solves_without_allocation() {
    let (metric, springs, q) = net(3);
    let n = q.len();
    let mut solver = DenseSolver::<Vec<f64>>::new(n).unwrap();
    let mut r = vec![1.0; n];
    let used = measure(|| {
        assert_eq!(solver.factor(&metric, &springs, &q, 0.01), Ok(Rung::Cholesky));
        solver.solve(&mut r);
        // Squeezed springs under a long step: the ladder is climbed.
        r.iter_mut().zip(&q).for_each(|(r, q)| *r = 0.3 * q);
        let rung = solver.factor(&metric, &springs, &r, 100.0);
        assert!(matches!(rung, Ok(Rung::Shifted { .. })), "{rung:?}");
    });
    assert_eq!(used.count_total, 0);
}

#[cfg(feature = "sparse")]
mod sparse {
    use super::*;
    use stationary_calculus::{
        Covector, Metric, SparseCholesky, SparseMetric, SparseSolver, SymmetricMatrix, Vector,
    };

    /// A net that is factored column by column, and one in panels.
    const SIDES: [usize; 2] = [6, 100];

    #[test]
    fn refilling_factoring_and_solving_allocate_nothing() {
        for side in SIDES {
            let (metric, springs, q) = net(side);
            let mut solver = SparseSolver::new(&metric, &springs, &q).unwrap();
            let mut r = vec![1.0; q.len()];
            let step = |solver: &mut SparseSolver, r: &mut [f64]| {
                assert_eq!(solver.factor(&metric, &springs, &q, 0.01), Ok(Rung::Cholesky));
                solver.solve(r);
            };
            // The first product of panels takes a buffer, once a thread.
            step(&mut solver, &mut r);
            assert_eq!(measure(|| step(&mut solver, &mut r)).count_total, 0, "side {side}");
        }
    }

    #[test]
    fn the_shifted_rung_allocates_nothing() {
        let (metric, springs, q) = net(6);
        let mut solver = SparseSolver::new(&metric, &springs, &q).unwrap();
        let squeezed: Vec<f64> = q.iter().map(|q| 0.3 * q).collect();
        let used = measure(|| {
            let rung = solver.factor(&metric, &springs, &squeezed, 100.0);
            assert!(matches!(rung, Ok(Rung::Shifted { .. })), "{rung:?}");
        });
        assert_eq!(used.count_total, 0);
    }

    #[test]
    fn a_sparse_metric_turns_momenta_into_velocities_without_allocation() {
        let blocks: Vec<_> = (0..50).map(|i| ([i, i + 1], [2.0, 1.0, 1.0, 2.0])).collect();
        let metric = SparseMetric::new(SymmetricMatrix::from_blocks(51, &blocks).unwrap()).unwrap();
        let (mut p, mut v) = (Covector(vec![1.0; 51]), Vector(vec![0.0; 51]));
        let used = measure(|| {
            metric.sharp(p.view(), v.view_mut());
            metric.flat(v.view(), p.view_mut());
        });
        assert_eq!(used.count_total, 0);
    }

    #[test]
    fn a_cholesky_factor_is_refreshed_without_allocation() {
        let blocks: Vec<_> = (0..50).map(|i| ([i, i + 1], [2.0, 1.0, 1.0, 2.0])).collect();
        let matrix = SymmetricMatrix::from_blocks(51, &blocks).unwrap();
        let mut cholesky = SparseCholesky::analyse(&matrix).unwrap();
        let mut x = vec![1.0; 51];
        let used = measure(|| {
            cholesky.factor(&matrix).unwrap();
            cholesky.solve(&mut x);
        });
        assert_eq!(used.count_total, 0);
    }
}
