//! Eigenvalues that come many times, and what is certified where a count cuts them.

use stationary_calculus::{Covector, DiagonalMetric, Potential, Sink};
use stationary_modal::{Linearized, ModalError, Modes, RigidMotions};

/// `1/2 d^T H d`, H a sum of blocks.
struct Blocks(usize, Vec<(Vec<usize>, Vec<f64>)>);

impl Potential for Blocks {
    fn dim(&self) -> usize {
        self.0
    }

    fn energy(&self, q: &[f64]) -> f64 {
        let mut dv = Covector(vec![0.0; q.len()]);
        self.add_differential(q, dv.view_mut());
        dv.0.iter().zip(q).map(|(f, x)| 0.5 * f * x).sum()
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        for (freedoms, entries) in &self.1 {
            for (&j, column) in freedoms.iter().zip(entries.chunks_exact(freedoms.len())) {
                freedoms.iter().zip(column).for_each(|(&i, entry)| dv.0[i] += entry * q[j]);
            }
        }
    }

    fn add_hessian(&self, _: &[f64], hessian: &mut impl Sink) {
        self.1.iter().for_each(|(freedoms, entries)| hessian.add_symmetric(freedoms, entries));
    }
}

/// Stiffnesses on freedoms of their own.
fn alone(values: &[f64]) -> Blocks {
    let blocks = values.iter().enumerate().map(|(i, value)| (vec![i], vec![*value]));
    Blocks(values.len(), blocks.collect())
}

/// Equal chains between walls, and their spectrum.
fn chains(copies: usize, length: usize) -> (Blocks, Vec<f64>) {
    let mut blocks = Vec::new();
    for first in (0..copies).map(|copy| copy * length) {
        blocks.extend((first..first + length).map(|i| (vec![i], vec![2.0])));
        let springs = first..first + length - 1;
        blocks.extend(springs.map(|i| (vec![i, i + 1], vec![0.0, -1.0, -1.0, 0.0])));
    }
    let angle = |k: usize| 0.5 * std::f64::consts::PI * k as f64 / (length + 1) as f64;
    let value = |k: usize| 4.0 * angle(k).sin().powi(2);
    let spectrum = (1..=length).flat_map(|k| std::iter::repeat_n(value(k), copies)).collect();
    (Blocks(copies * length, blocks), spectrum)
}

fn lowest(blocks: &Blocks, mass: f64, count: usize) -> Modes {
    let n = blocks.dim();
    let metric = DiagonalMetric::new(vec![mass; n]).unwrap();
    let mut system = Linearized::at(&metric, blocks, &vec![0.0; n], 0.0).unwrap();
    let modes = system.lowest(count, &RigidMotions::none()).unwrap();
    let skew = modes.orthogonality(system.mass()).unwrap().into_iter().fold(0.0, f64::max);
    assert!(skew < 1e-11, "{skew:e}");
    modes
}

#[test]
fn a_single_value_of_any_multiplicity_is_found_as_often_as_it_is_there() {
    for n in [2, 48, 49, 60, 100] {
        for count in [1, 2, 9, n] {
            let modes = lowest(&alone(&vec![12.0; n]), 3.0, count.min(n));
            assert!(modes.values().iter().all(|value| (value - 4.0).abs() < 1e-12), "{n} {count}");
        }
    }
}

#[test]
fn equal_bodies_side_by_side_have_each_mode_once_for_each_of_them() {
    for (copies, length) in [(40, 3), (30, 20), (200, 4)] {
        let (blocks, spectrum) = chains(copies, length);
        for count in [1, 10, copies + 5] {
            let modes = lowest(&blocks, 1.0, count);
            for (value, exact) in modes.values().iter().zip(&spectrum) {
                assert!((value - exact).abs() < 1e-12, "{copies} {count}: {value} {exact}");
            }
        }
    }
}

#[test]
fn where_the_count_cuts_a_cluster_the_certificate_ends_below_it() {
    for n in [20, 80] {
        let mut values = vec![5.0; n];
        values[..12].fill(2.0);
        values[7] = 1.0;
        let blocks = alone(&values);
        for (count, below, least) in [(1, 2.0, 1.0), (5, 2.0, 1.9), (12, 5.0, 2.0), (13, 5.0, 4.9)]
        {
            let limit = lowest(&blocks, 1.0, count).complete_below();
            assert!(least < limit && limit < below, "{n} {count}: {limit}");
        }
        assert!(lowest(&blocks, 1.0, n).complete_below() > 5.0);
    }
}

#[test]
fn what_is_truncated_is_no_longer_certified() {
    let mut modes = lowest(&alone(&[1.0, 2.0, 2.0, 3.0, 4.0]), 1.0, 4);
    assert!(modes.complete_below() > 3.0);
    for (kept, first_missing) in [(4, 4.0), (3, 3.0), (2, 2.0), (1, 2.0), (0, 1.0)] {
        modes.truncate(kept);
        assert!(modes.complete_below() <= first_missing, "{kept}");
        assert!(modes.complete_below() > first_missing - 1.1, "{kept}");
    }
}

#[test]
fn zero_modes_are_exactly_zero_and_of_any_number() {
    for n in [30, 120] {
        let values: Vec<f64> = (0..n).map(|i| if i < 20 { 0.0 } else { i as f64 }).collect();
        let modes = lowest(&alone(&values), 1.0, 25);
        assert!(modes.values()[..20].iter().all(|value| *value == 0.0));
        assert!((modes.values()[20] - 20.0).abs() < 1e-10);
    }
}

#[test]
fn rigid_motions_of_another_system_are_refused() {
    let chain = |n: usize| {
        let springs = (1..n).map(|i| (vec![i - 1, i], vec![1.0, -1.0, -1.0, 1.0]));
        Blocks(n, springs.collect())
    };
    let metrics = [6, 9].map(|n| DiagonalMetric::new(vec![1.0; n]).unwrap());
    let heavy = DiagonalMetric::new(vec![2.0; 6]).unwrap();
    let (free, longer, held) = (chain(6), chain(9), chains(1, 6).0);
    let places: Vec<[f64; 1]> = (0..6).map(|i| [f64::from(i)]).collect();
    let mut there = Linearized::at(&metrics[0], &free, &[0.0; 6], 0.0).unwrap();
    let rigid = RigidMotions::of_points(&there, &places).unwrap();
    assert_eq!(rigid.len(), 1);
    let mut here = Linearized::at(&metrics[0], &held, &[0.0; 6], 0.0).unwrap();
    assert!(matches!(here.lowest(1, &rigid), Err(ModalError::NotRigid { motion: 0, .. })));
    assert!(matches!(here.kind(&rigid), Err(ModalError::NotRigid { motion: 0, .. })));
    let mut here = Linearized::at(&metrics[1], &longer, &[0.0; 9], 0.0).unwrap();
    assert!(matches!(here.lowest(1, &rigid), Err(ModalError::Size(_))));
    let mut here = Linearized::at(&heavy, &free, &[0.0; 6], 0.0).unwrap();
    assert!(matches!(here.lowest(1, &rigid), Err(ModalError::NotOrthonormal { .. })));
    // Nor may they be put beside modes that have them, or were found without them.
    let modes = there.lowest(2, &rigid).unwrap().with_rigid(&rigid).unwrap();
    assert!(modes.with_rigid(&rigid).is_err());
    let modes = there.lowest(2, &RigidMotions::none()).unwrap();
    assert_eq!(modes.with_rigid(&rigid), Err(ModalError::OtherMotions { found: 0, given: 1 }));
}
