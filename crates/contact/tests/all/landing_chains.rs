//! Joints, dry friction and corners of one moment, by the laws of each row.

use stationary_calculus::{DiagonalMetric, Vector};
use stationary_constraints::RowLaw;
use stationary_contact::problems::{LandingChain, landing_chain};
use stationary_contact::{InverseMass, RowsMethod, RowsReport, RowsSolver};
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

/// Solves a chain, and asks each law whether no more is left than is said.
fn solve(chain: &LandingChain, solver: &mut RowsSolver) -> RowsReport {
    let mass = InverseMass::of(&DiagonalMetric::new(chain.masses.clone()).unwrap()).unwrap();
    let rows = &chain.rows;
    let (mut x, mut v) = (vec![0.0; rows.rows()], Vector(chain.velocity.clone()));
    let report = solver.solve(rows, &mut &mass, 1e-10, &mut x, v.view_mut()).unwrap();
    assert_eq!(report.islands, 1);
    let left = report.residual.max(report.friction_residual);
    assert_eq!(report.settled, left <= 1e-10);
    for (law, block) in rows.blocks() {
        let u: Vec<f64> = block.clone().map(|row| rows.lack(row, v.view())).collect();
        let own = |row: usize| rows.row(row).map(|(f, value)| value * value / chain.masses[f]);
        let scale = block.clone().flat_map(own).sum();
        let off = distance_to_law(law, &x[block], &u, scale);
        assert!(off <= 10.0 * left + 1e-9, "{law:?} {off:e}, said {left:e}");
    }
    report
}

#[test]
fn nearly_every_chain_finds_impulses_that_meet_its_laws_to_rounding() {
    let mut random = SplitMix64::new(20290904);
    let mut solver = RowsSolver::default();
    let mut unsettled = 0;
    let mut methods = [0; 4];
    for case in 0..400 {
        let chain = landing_chain(3 + case % 4, 1.5, &mut random).unwrap();
        let report = solve(&chain, &mut solver);
        methods[report.method as usize] += 1;
        if !report.settled {
            unsettled += 1;
            assert_eq!(report.method, RowsMethod::Sweeps);
        }
    }
    assert!(unsettled <= 8, "{unsettled} of 400");
    // Each method has chains that those before leave to it.
    assert!(methods.iter().all(|chains| *chains > 0), "{methods:?}");
}

#[test]
fn long_chains_are_settled_by_interior_points_whose_factors_are_bands() {
    let mut random = SplitMix64::new(20291012);
    let mut solver = RowsSolver::default();
    for boxes in [12, 24] {
        let chains: Vec<_> =
            (0..30).map(|_| landing_chain(boxes, 1.5, &mut random).unwrap()).collect();
        let settled = chains.iter().map(|chain| solve(chain, &mut solver));
        let inside = settled.filter(|report| report.method == RowsMethod::InteriorPoint).count();
        assert!(inside >= 25, "{inside} of 30 chains of {boxes}");
    }
}
