//! A sheet of vertices with a sparse mass that lands on a box, with friction: the sheet answers by a
//! factor that is handed in, the box by its mass.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use stationary_calculus::{DiagonalMetric, Vector};
use stationary_constraints::{RowLaw, VelocityRows};
use stationary_contact::{ContactError, FactorResponse, InverseMass, RowsSolver, SideBySide};

/// Vertices along a side, and of all.
const SIDE: usize = 5;
const VERTICES: usize = SIDE * SIDE;
const N: usize = 3 * VERTICES;
const SHEET_MASS: f64 = 0.2;
const BOX_MASS: f64 = 0.6;
const STIFFNESS: f64 = 5.0;
/// Of the box, the same about all axes, kg m^2.
const INERTIA: f64 = 0.08;
const MU: f64 = 0.4;
const G: f64 = 9.81;
const H: f64 = 5e-3;

/// Mass and stiffness of the sheet: linear triangles, and springs along their edges that pull towards
/// the shape that it starts with. Neither is diagonal.
fn sheet() -> (DMatrix<f64>, DMatrix<f64>) {
    let at = |i: usize, j: usize| i * SIDE + j;
    let (mut m, mut k) = (DMatrix::zeros(N, N), DMatrix::zeros(N, N));
    let part = SHEET_MASS / (2 * (SIDE - 1) * (SIDE - 1)) as f64;
    for (i, j) in (0..SIDE - 1).flat_map(|i| (0..SIDE - 1).map(move |j| (i, j))) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        for triangle in [[a, b, c], [a, c, d]] {
            for (p, q) in triangle.into_iter().flat_map(|p| triangle.map(|q| (p, q))) {
                for axis in 0..3 {
                    let (p, q) = (3 * p + axis, 3 * q + axis);
                    m[(p, q)] += part * if p == q { 2.0 } else { 1.0 } / 12.0;
                    k[(p, q)] += STIFFNESS * if p == q { 2.0 } else { -1.0 };
                }
            }
        }
    }
    (m, k)
}

struct Scene {
    mass: DMatrix<f64>,
    stiffness: DMatrix<f64>,
    factor: Cholesky<f64, Dyn>,
    rest: DVector<f64>,
    /// The sheet's places and velocities, and those of the box: its centre and its spin.
    x: DVector<f64>,
    v: DVector<f64>,
    centre: [f64; 3],
    along: Vec<f64>,
}

impl Scene {
    fn new(sideways: f64) -> Scene {
        let (mass, stiffness) = sheet();
        let factor = Cholesky::new(&mass + &stiffness * (H * H)).unwrap();
        let place = |i: usize| {
            let (vertex, axis) = (i / 3, i % 3);
            let cell = 0.4 / (SIDE - 1) as f64;
            match axis {
                0 => cell * (vertex / SIDE) as f64 - 0.2,
                1 => cell * (vertex % SIDE) as f64 - 0.2,
                // A little wavy, so that it does not land all at once.
                _ => 0.5 + 0.05 + 0.01 * (vertex as f64).cos(),
            }
        };
        let x = DVector::from_fn(N, |i, _| place(i));
        let v = DVector::from_fn(N, |i, _| if i % 3 == 0 { sideways } else { 0.0 });
        let (centre, along) = ([0.0, 0.0, 0.25], vec![0.0; 6]);
        Scene { mass, stiffness, factor, rest: x.clone(), x, v, centre, along }
    }

    fn energy(&self) -> f64 {
        let off = &self.x - &self.rest;
        let falls: f64 = (0..VERTICES).map(|i| self.weight(i) * self.x[3 * i + 2]).sum();
        let spins: f64 = (3..6).map(|k| self.along[k] * self.along[k] * INERTIA).sum();
        let moves: f64 = (0..3).map(|k| self.along[k] * self.along[k] * BOX_MASS).sum();
        0.5 * self.v.dot(&(&self.mass * &self.v))
            + 0.5 * off.dot(&(&self.stiffness * &off))
            + falls
            + 0.5 * (moves + spins)
            + BOX_MASS * G * self.centre[2]
    }

    fn weight(&self, vertex: usize) -> f64 {
        G * (0..VERTICES).map(|other| self.mass[(3 * vertex, 3 * other)]).sum::<f64>()
    }

    fn momentum(&self) -> [f64; 3] {
        let sheet = &self.mass * &self.v;
        [0, 1, 2].map(|k| {
            (0..VERTICES).map(|i| sheet[3 * i + k]).sum::<f64>() + BOX_MASS * self.along[k]
        })
    }

    /// The velocities before contacts: an implicit step of the sheet, and the box falls.
    fn free(&self) -> Vec<f64> {
        let pull = &self.stiffness * (&self.x - &self.rest);
        let mut load = &self.mass * &self.v - pull * H;
        (0..VERTICES).for_each(|i| load[3 * i + 2] -= H * self.weight(i));
        self.factor.solve_mut(&mut load);
        let mut free: Vec<f64> = load.iter().chain(&self.along).copied().collect();
        free[N + 2] -= H * G;
        free
    }

    /// Vertices on the box, then its corners on the floor, which is smooth.
    fn rows(&self) -> (VelocityRows, usize) {
        let mut rows = VelocityRows::default();
        let (top, mut vertices) = (self.centre[2] + 0.25, 0);
        for i in 0..VERTICES {
            let arm = [0, 1, 2].map(|k| self.x[3 * i + k] - self.centre[k]);
            let gap = self.x[3 * i + 2] - top;
            assert!(arm[0].abs() < 0.5 && arm[1].abs() < 0.5, "over the edge");
            let entries = |axis: usize| {
                let mut entries = vec![(3 * i + axis, 1.0), (N + axis, -1.0)];
                // -(e x arm), as the point of the box moves with its spin.
                let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
                entries.extend([(N + 3 + next, -arm[last]), (N + 3 + last, arm[next])]);
                entries
            };
            let [x, y, z] = [0, 1, 2].map(entries);
            rows.push(RowLaw::Cone(MU), &[(&z, -gap / H), (&x, 0.0), (&y, 0.0)]).unwrap();
            vertices += 1;
        }
        for (x, y) in [(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)] {
            let gap = self.centre[2] - 0.25;
            let entries = [(N + 2, 1.0), (N + 3, y), (N + 4, -x)];
            rows.push(RowLaw::Limit, &[(&entries, -gap / H)]).unwrap();
        }
        (rows, vertices)
    }
}

fn box_mass() -> InverseMass {
    let (m, i) = (BOX_MASS, INERTIA);
    InverseMass::of(&DiagonalMetric::new([m, m, m, i, i, i]).unwrap()).unwrap()
}

#[test]
fn a_sheet_that_lands_on_a_box_takes_it_along_and_no_law_is_broken() {
    let sideways = 1.0;
    let mut scene = Scene::new(sideways);
    let mass = box_mass();
    let factor = scene.factor.clone();
    let solve = |load: &mut [f64]| {
        let mut x = DVector::from_column_slice(load);
        factor.solve_mut(&mut x);
        load.copy_from_slice(x.as_slice());
    };
    let mut response = SideBySide { first: FactorResponse::new(N, solve), second: mass };
    let mut solver = RowsSolver::default();
    let mut impulses = vec![0.0; 3 * VERTICES + 4];
    let (mut slid, mut stuck) = (0, 0);
    for step in 0..400 {
        let (energy, before) = (scene.energy(), scene.momentum());
        let mut v = scene.free();
        let (rows, vertices) = scene.rows();
        let report =
            solver.solve(&rows, &mut response, 1e-9, &mut impulses, Vector(&mut v)).unwrap();
        assert!(report.settled, "{step}: {report:?}");
        for (i, x) in impulses[..3 * vertices].chunks_exact(3).enumerate() {
            let across = x[1].hypot(x[2]);
            assert!(x[0] >= 0.0 && across <= (MU + 1e-12) * x[0], "{step}: {x:?}");
            // What slides is opposed, by all that the cone gives.
            let slip = [1, 2].map(|k| rows.lack(3 * i + k, Vector(&v)));
            let speed = slip[0].hypot(slip[1]);
            if x[0] > 1e-9 && speed > 1e-6 {
                let power = x[1] * slip[0] + x[2] * slip[1];
                assert!((power + MU * x[0] * speed).abs() < 1e-6 * x[0] * speed + 1e-11);
                slid += 1;
            } else if x[0] > 1e-9 {
                stuck += 1;
            }
        }
        for row in rows.blocks().map(|(_, rows)| rows.start) {
            assert!(rows.lack(row, Vector(&v)) > -1e-9, "through at {step}");
        }
        scene.v = DVector::from_column_slice(&v[..N]);
        scene.along.copy_from_slice(&v[N..]);
        scene.x += &scene.v * H;
        (0..3).for_each(|k| scene.centre[k] += H * v[N + k]);
        // The box lies flat: its corners hold it.
        assert!(scene.along[3..5].iter().all(|w| w.abs() < 1e-8), "{:?}", scene.along);
        let floor: f64 = impulses[3 * VERTICES..].iter().sum();
        let weight = H * G * (SHEET_MASS + BOX_MASS);
        let expected = [before[0], before[1], before[2] + floor - weight];
        for (now, expected) in scene.momentum().iter().zip(expected) {
            assert!((now - expected).abs() < 1e-12, "{step}: {now} {expected}");
        }
        let gained = scene.energy() - energy;
        assert!(gained < 1e-9, "{step}: {gained} J");
    }
    assert!(slid > 100 && stuck > 1000, "{slid} {stuck}");
    let common = SHEET_MASS * sideways / (SHEET_MASS + BOX_MASS);
    assert!((scene.along[0] - common).abs() < 1e-5, "{} {common}", scene.along[0]);
    let apart = (0..VERTICES).map(|i| (scene.v[3 * i] - common).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-3, "{apart}");
}

#[test]
fn rows_that_make_no_sense_are_refused_and_change_nothing() {
    let mut mass = box_mass();
    let mut rows = VelocityRows::default();
    rows.push(RowLaw::Limit, &[(&[(2, 1.0)], 0.5)]).unwrap();
    let start = [0.0, 0.0, -1.0, 0.0, 0.0, 0.0];
    let mut solve = |rows: &VelocityRows, tolerance: f64, v: &mut [f64]| {
        let mut x = vec![0.0; rows.rows()];
        let report = RowsSolver::default().solve(rows, &mut mass, tolerance, &mut x, Vector(v));
        report.map(|report| (x, report.settled))
    };
    let mut v = start;
    assert!(matches!(solve(&rows, f64::NAN, &mut v), Err(ContactError::Settling(_))));
    assert!(matches!(solve(&rows, 0.0, &mut v[..5]), Err(ContactError::Size(_))));
    let mut nan = start;
    nan[4] = f64::NAN;
    assert!(matches!(solve(&rows, 0.0, &mut nan), Err(ContactError::NonFinite { .. })));
    let mut far = rows.clone();
    far.push(RowLaw::Equality, &[(&[(6, 1.0)], 0.0)]).unwrap();
    assert!(matches!(solve(&far, 0.0, &mut v), Err(ContactError::Rows(_))));
    assert_eq!(v, start);
    // Two equalities that contradict each other are not settled, and say so.
    let mut torn = rows.clone();
    torn.push(RowLaw::Equality, &[(&[(0, 1.0)], 1.0)]).unwrap();
    torn.push(RowLaw::Equality, &[(&[(0, 1.0)], -1.0)]).unwrap();
    assert!(!solve(&torn, 1e-9, &mut v).unwrap().1);
    let mut v = start;
    let (x, settled) = solve(&rows, 1e-12, &mut v).unwrap();
    assert!(settled && (x[0] - 1.5 * BOX_MASS).abs() < 1e-12 && (v[2] - 0.5).abs() < 1e-12);
}
