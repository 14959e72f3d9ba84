//! Joints, dry friction and corners of one moment, by the laws of each row.

use stationary_calculus::{DiagonalMetric, Vector};
use stationary_constraints::RowLaw;
use stationary_contact::problems::landing_chain;
use stationary_contact::{InverseMass, RowsMethod, RowsSolver};
use stationary_measure::SplitMix64;

/// How far impulses are from the nearest that obey their law, as a rate: those of a cone by De Saxce's rates
/// `u + mu |u_t| n`.
fn distance_to_law(law: RowLaw, x: &[f64], u: &[f64], scale: f64) -> f64 {
    let mut nearest: Vec<f64> = x.iter().zip(u).map(|(x, u)| x - u / scale).collect();
    if let RowLaw::Cone(friction) = law {
        nearest[0] -= friction * u[1].hypot(u[2]) / scale;
    }
    law.nearest(&mut nearest);
    nearest.iter().zip(x).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt() * scale
}

#[test]
fn nearly_every_chain_finds_impulses_that_meet_its_laws_to_rounding() {
    let mut random = SplitMix64::new(20290904);
    let mut solver = RowsSolver::default();
    let mut unsettled = 0;
    let mut methods = [0; 4];
    for case in 0..400 {
        let chain = landing_chain(3 + case % 4, 1.5, &mut random).unwrap();
        let mass = InverseMass::of(&DiagonalMetric::new(chain.masses.clone()).unwrap()).unwrap();
        let rows = &chain.rows;
        let (mut x, mut v) = (vec![0.0; rows.rows()], Vector(chain.velocity.clone()));
        let report = solver.solve(rows, &mut &mass, 1e-10, &mut x, v.view_mut()).unwrap();
        assert_eq!(report.islands, 1);
        // What is said to be left is left: each law by the velocity after it.
        let left = report.residual.max(report.friction_residual);
        assert_eq!(report.settled, left <= 1e-10);
        for (law, block) in rows.blocks() {
            let u: Vec<f64> = block.clone().map(|row| rows.lack(row, v.view())).collect();
            let own = |row: usize| rows.row(row).map(|(f, value)| value * value / chain.masses[f]);
            let scale = block.clone().flat_map(own).sum();
            let off = distance_to_law(law, &x[block], &u, scale);
            assert!(off <= 10.0 * left + 1e-9, "{case}: {law:?} {off:e}, said {left:e}");
        }
        unsettled += usize::from(!report.settled);
        methods[report.method as usize] += 1;
        if !report.settled {
            assert_eq!(report.method, RowsMethod::Sweeps);
        }
    }
    assert!(unsettled <= 8, "{unsettled} of 400");
    // Each method has chains that those before leave to it.
    assert!(methods.iter().all(|chains| *chains > 0), "{methods:?}");
}
