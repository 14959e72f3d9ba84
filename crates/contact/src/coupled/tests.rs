//! Chains of boxes that lie on a floor with all of their corners, and rub.

use nalgebra::{DMatrix, DVector, Vector3};
use stationary_constraints::RowLaw;
use stationary_measure::SplitMix64;

use crate::coupled::coupled_rows::CoupledRows;
use crate::coupled::interior_point::InteriorPoint;
use crate::coupled::row_laws::RowLaws;

/// Blocks of rows with their laws, their differentials, the inverse masses and the velocity.
struct Chain {
    laws: Vec<(RowLaw, usize)>,
    rows: DMatrix<f64>,
    inverse_masses: DVector<f64>,
    v: DVector<f64>,
    /// What gaps leave to corners, m/s.
    gaps: DVector<f64>,
}

impl Chain {
    /// Bodies on ball joints, with four corners each on a floor and dry friction about each joint's upright.
    fn new(random: &mut SplitMix64, bodies: usize) -> Self {
        let mut laws = Vec::new();
        let mut rows: Vec<Vec<f64>> = Vec::new();
        let mut line = |parts: &[(usize, Vector3<f64>, Vector3<f64>)]| {
            let mut line = vec![0.0; 6 * bodies];
            for (body, along, turn) in parts {
                line[6 * body..][..3].copy_from_slice(along.as_slice());
                line[6 * body + 3..][..3].copy_from_slice(turn.as_slice());
            }
            rows.push(line);
        };
        let axes = [Vector3::z(), Vector3::x(), Vector3::y()];
        for body in 1..bodies {
            for axis in axes {
                laws.push((RowLaw::Equality, 1));
                let arm = Vector3::x() * 0.2;
                line(&[(body, axis, (-arm).cross(&axis)), (body - 1, -axis, -arm.cross(&axis))]);
            }
            laws.push((RowLaw::Bounded(0.02), 1));
            let none = Vector3::zeros();
            line(&[(body, none, Vector3::z()), (body - 1, none, -Vector3::z())]);
        }
        let friction = 0.55 + 0.45 * random.symmetric();
        for body in 0..bodies {
            for [x, y] in [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]] {
                laws.push((RowLaw::Cone(friction), 3));
                let arm = Vector3::new(0.15 * x, 0.05 * y, -0.05);
                for axis in axes {
                    line(&[(body, axis, arm.cross(&axis))]);
                }
            }
        }
        let mass = |_| 10.0_f64.powf(1.5 * random.symmetric());
        let masses: Vec<f64> = (0..bodies).map(mass).collect();
        let own = [1.0, 1.0, 1.0, 1.0 / 0.0017, 1.0 / 0.0083, 1.0 / 0.0083];
        let inverse_masses = DVector::from_fn(6 * bodies, |i, _| own[i % 6] / masses[i / 6]);
        let v = DVector::from_fn(6 * bodies, |i, _| {
            let falls = if i % 6 == 2 { 0.3 } else { 0.0 };
            [0.1, 0.1, 0.05, 0.1, 0.1, 0.5][i % 6] * random.symmetric() - falls
        });
        let rows = DMatrix::from_fn(rows.len(), 6 * bodies, |i, j| rows[i][j]);
        let mut gaps = DVector::zeros(rows.nrows());
        let mut first = 0;
        for &(law, count) in &laws {
            if matches!(law, RowLaw::Cone(_)) {
                gaps[first] = 0.2 * random.symmetric().max(0.0);
            }
            first += count;
        }
        Chain { laws, rows, inverse_masses, v, gaps }
    }

    fn compliance(&self) -> DMatrix<f64> {
        &self.rows * DMatrix::from_diagonal(&self.inverse_masses) * self.rows.transpose()
    }

    /// Hands the rows on: law by law, then row by row.
    fn write(&self, mut push: impl FnMut(RowLaw, Vec<f64>), couple: impl FnOnce(DMatrix<f64>)) {
        let rates = &self.rows * &self.v + &self.gaps;
        let mut first = 0;
        for &(law, count) in &self.laws {
            push(law, rates.as_slice()[first..first + count].to_vec());
            first += count;
        }
        couple(self.compliance());
    }
}

/// The part from the diagonal on.
fn upper(w: &DMatrix<f64>, row: usize, line: &mut [f64]) {
    line.iter_mut().zip(row..).for_each(|(to, column)| *to = w[(row, column)]);
}

#[test]
fn nearly_every_chain_finds_impulses_that_meet_its_laws_to_rounding() {
    let mut random = SplitMix64::new(20290904);
    let mut coupled = CoupledRows::default();
    let mut unsettled = 0;
    for case in 0..400 {
        let chain = Chain::new(&mut random, 3 + case % 4);
        coupled.clear();
        let mut blocks = Vec::new();
        let mut compliance = DMatrix::zeros(0, 0);
        chain.write(|law, rates| blocks.push((law, rates)), |w| compliance = w);
        blocks.into_iter().for_each(|(law, rates)| coupled.push(law, rates));
        coupled.couple(|row, line| upper(&compliance, row, line));
        let mut x = vec![0.0; chain.rows.nrows()];
        let (left, _) = coupled.solve(&mut x, 1e-10);
        // What is said to be left is left: each law by the velocity after it.
        let rates =
            &chain.rows * &chain.v + &chain.gaps + &compliance * DVector::from_column_slice(&x);
        let mut first = 0;
        for &(law, count) in &chain.laws {
            let (x, u) = (&x[first..first + count], &rates.as_slice()[first..first + count]);
            first += count;
            let slack = left.worst() + 1e-9;
            match law {
                RowLaw::Equality => assert!(u[0].abs() <= slack, "{case}: {law:?} {u:?}"),
                RowLaw::Bounded(bound) => assert!(x[0].abs() <= bound * (1.0 + 1e-12)),
                RowLaw::Cone(m) => {
                    let rubs = x[1].hypot(x[2]);
                    assert!(x[0] >= 0.0 && rubs <= m * x[0] * (1.0 + 1e-12), "{case}: {x:?}");
                    assert!(u[0] >= -slack, "{case}: {law:?} {u:?}");
                }
                RowLaw::Limit => unreachable!("there is none"),
            }
        }
        unsettled += usize::from(left.worst() > 1e-10);
    }
    assert!(unsettled <= 8, "{unsettled} of 400");
}

#[test]
fn the_way_inside_leads_close_to_an_answer_in_few_steps() {
    let mut random = SplitMix64::new(20290905);
    let mut inside = InteriorPoint::default();
    let (mut near, mut worst) = (0, 0.0_f64);
    for case in 0..200 {
        let chain = Chain::new(&mut random, 3 + case % 4);
        let mut rows = RowLaws::default();
        rows.clear();
        let mut compliance = DMatrix::zeros(0, 0);
        chain.write(|law, rates| rows.push(law, rates), |w| compliance = w);
        rows.couple(|row, line| upper(&compliance, row, line));
        let mut x = vec![0.0; rows.rows()];
        assert!(inside.start(&rows));
        let (steps, there) = inside.go_on(&rows, 1e-9, &mut x);
        assert!(steps <= 61 && x.iter().all(|x| x.is_finite()), "{case}: {steps}");
        let left = rows.left(&x).worst();
        if there {
            worst = worst.max(left);
            near += usize::from(left < 1e-3);
        }
    }
    assert!(near >= 190, "{near} of 200, {worst:e}");
}

#[test]
fn rows_that_nothing_moves_along_have_nothing_to_find() {
    let mut rows = RowLaws::default();
    rows.clear();
    rows.push(RowLaw::Limit, [0.0]);
    rows.couple(|_, line| line[0] = 1.0);
    assert!(!InteriorPoint::default().start(&rows));
}
