//! Equalities alone: of any number, dependent or not, by masses that do not couple freedoms.

use nalgebra::{DMatrix, DVector, Vector2};
use stationary_calculus::{Covector, DiagonalMetric, System, Vector};
use stationary_constraints::{RowLaw, VelocityRows};
use stationary_contact::{InverseMass, Kept, PlanarDetector, PlanarWorld, RowsSolver};
use stationary_integrators::State;
use stationary_measure::SplitMix64;
use stationary_rigid::{PlanarEnd, PlanarJoint, PlanarJointKind, PlanarWeight};

/// Random rows, of which a third are sums of others, masses of 1e-3 to 1e3, and a freedom that is held: velocities
/// meet what is asked for, by the least change in the mass metric.
#[test]
fn velocities_meet_equalities_by_the_least_change_though_some_depend_on_others() {
    let mut solver = RowsSolver::default();
    for seed in 0..200 {
        let mut noise = SplitMix64::new(seed);
        let mut unit = || 0.5 + 0.5 * noise.symmetric();
        let (count, n) = (1 + (unit() * 12.0) as usize, 14 + (unit() * 10.0) as usize);
        let mut a = DMatrix::<f64>::zeros(count, n);
        for row in 0..count {
            if row > 1 && unit() < 0.3 {
                let sum = a.row(row - 1) + a.row(row - 2) * 0.7;
                a.row_mut(row).copy_from(&sum);
            } else {
                (0..3)
                    .for_each(|_| a[(row, 1 + (unit() * (n - 1) as f64) as usize)] = unit() - 0.5);
            }
        }
        let masses: Vec<f64> = (0..n).map(|_| 10_f64.powf(6.0 * unit() - 3.0)).collect();
        let metric = DiagonalMetric::new(masses.clone()).unwrap();
        let mut mass = InverseMass::of(&metric).unwrap().holding([0]);
        let before: Vec<f64> = (0..n).map(|_| unit() - 0.5).collect();
        // What some motion meets, so that sums of rows do not contradict their terms.
        let wanted = &a * DVector::from_fn(n, |freedom, _| if freedom == 0 { 0.0 } else { unit() });
        let mut rows = VelocityRows::default();
        for row in 0..count {
            let entries: Vec<_> = (0..n).map(|k| (k, a[(row, k)])).filter(|e| e.1 != 0.0).collect();
            rows.push(RowLaw::Equality, &[(&entries, wanted[row])]).unwrap();
        }
        let (mut x, mut v) = (vec![0.0; count], before.clone());
        let report = solver.solve(&rows, &mut mass, 1e-9, &mut x, Vector(&mut v)).unwrap();
        assert!(report.settled && report.residual < 1e-10, "{seed}: {report:?}");
        let change = DVector::from_fn(n, |k, _| v[k] - before[k]);
        let pulled = a.transpose() * DVector::from_vec(x);
        for k in 0..n {
            let expected = if k == 0 { 0.0 } else { pulled[k] / masses[k] };
            assert!((change[k] - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{seed}: {k}");
        }
    }
}

/// Two rows that ask for what contradicts itself: the answer says by how much they stay apart.
#[test]
fn what_contradicts_itself_is_not_settled() {
    let mut mass = InverseMass::of(&DiagonalMetric::new([2.0]).unwrap()).unwrap();
    let mut rows = VelocityRows::default();
    for asked in [1.0, 2.0] {
        rows.push(RowLaw::Equality, &[(&[(0, 1.0)], asked)]).unwrap();
    }
    let (mut x, mut v) = ([0.0; 2], [0.0]);
    let mut solver = RowsSolver::default();
    let report = solver.solve(&rows, &mut mass, 1e-9, &mut x, Vector(&mut v)).unwrap();
    assert!(!report.settled && report.residual > 0.4, "{report:?}");
}

/// A straight chain that is let go, of more rows than a dense system may have. Far from its pin it falls freely; the
/// forces of its joints fall off by `r = 3^1/2 - 2` from one to the next, the first being `m g / (2 3^1/2)`.
#[test]
fn a_chain_of_eight_hundred_links_hangs_together_where_it_touches_nothing() {
    const LINKS: usize = 800;
    let (mass, half) = (0.1, 0.05);
    let weight = PlanarWeight { gravity: Vector2::new(0.0, -9.81), masses: vec![mass; LINKS] };
    let inertia = mass * 4.0 * half * half / 12.0;
    let masses = (0..LINKS).flat_map(|_| [mass, mass, inertia]).collect();
    let system = System::new(DiagonalMetric::new(masses).unwrap(), weight).unwrap();
    let mut joints = Vec::new();
    for link in 0..LINKS {
        let before = match link.checked_sub(1) {
            None => PlanarEnd::world(Vector2::zeros()),
            Some(before) => PlanarEnd::on(before, Vector2::new(half, 0.0)),
        };
        let ends = [before, PlanarEnd::on(link, Vector2::new(-half, 0.0))];
        joints.push(PlanarJoint::new(LINKS, PlanarJointKind::Pin, ends).unwrap());
    }
    let q = (0..LINKS).flat_map(|link| [(2 * link + 1) as f64 * half, 0.0, 0.0]).collect();
    let mut state = State::new(q, Covector(vec![0.0; 3 * LINKS]));
    let detector = PlanarDetector::new(Vec::new(), LINKS).unwrap();
    let mut world = PlanarWorld::new(system, detector).unwrap();
    let (mut speeds, h) = ([0.0; 2], 1e-3);
    for step in 0..5 {
        let report = world.step_with(&mut state, h, &Kept(&joints)).unwrap();
        assert!(report.settled && report.residual < 1e-9, "{report:?}");
        if step == 0 {
            speeds = [0, LINKS - 1].map(|link| state.p.0[3 * link + 1] / mass);
        }
    }
    let root = 3_f64.sqrt();
    let pulled = (3.0 - root) / (2.0 * root);
    for (speed, expected) in speeds.into_iter().zip([1.0 - pulled, 1.0]) {
        assert!((speed + expected * 9.81 * h).abs() < 1e-12, "{speed} {expected}");
    }
}

#[test]
fn what_held_freedoms_cannot_give_is_not_settled() {
    let mass = InverseMass::of(&DiagonalMetric::new([1.0, 1.0]).unwrap()).unwrap().holding([1]);
    let asks = [
        (RowLaw::Equality, 0.25, 0.25),
        (RowLaw::Limit, 0.25, 0.25),
        (RowLaw::Cone(0.5), 0.25, 0.25),
        // What holds lacks nothing, and nobody asks bounded friction to stop what is held.
        (RowLaw::Limit, -0.25, 0.0),
        (RowLaw::Cone(0.5), -0.25, 0.0),
        (RowLaw::Bounded(1.0), 0.25, 0.0),
    ];
    for (law, asked, lacks) in asks {
        let mut rows = VelocityRows::default();
        rows.push(law, &[(&[(1, 1.0)], asked)]).unwrap();
        let (mut x, mut v) = ([0.0], [0.0; 2]);
        let mut solver = RowsSolver::default();
        let report = solver.solve(&rows, &mut &mass, 1e-12, &mut x, Vector(&mut v[..])).unwrap();
        assert_eq!((report.settled, report.residual), (lacks == 0.0, lacks), "{law:?} {asked}");
        assert_eq!((x, v), ([0.0], [0.0; 2]));
    }
}
