//! How near an interior point comes, and where it has nothing to find.

use stationary_calculus::Vector;
use stationary_measure::SplitMix64;

use crate::coupled::interior_point::InteriorPoint;
use crate::coupled::row_laws::{BlockLaw, RowLaws};
use crate::problems::{LandingChain, landing_chain};

/// The rows of a chain with their compliance.
fn rows_of(chain: &LandingChain) -> RowLaws {
    let LandingChain { rows, masses, velocity } = chain;
    let mut laws = RowLaws::default();
    laws.clear();
    for (law, block) in rows.blocks() {
        laws.push(law.into(), block.map(|row| rows.lack(row, Vector(&velocity[..]))));
    }
    laws.couple(|row, line| {
        let mut answer = vec![0.0; masses.len()];
        rows.row(row).for_each(|(freedom, value)| answer[freedom] = value / masses[freedom]);
        for (to, column) in line.iter_mut().zip(row..) {
            *to = rows.row(column).map(|(freedom, value)| value * answer[freedom]).sum();
        }
    });
    laws
}

#[test]
fn the_way_inside_leads_close_to_an_answer_in_few_steps() {
    let mut random = SplitMix64::new(20290905);
    let mut inside = InteriorPoint::default();
    let (mut near, mut worst) = (0, 0.0_f64);
    for case in 0..200 {
        let mut rows = rows_of(&landing_chain(3 + case % 4, 1.5, &mut random).unwrap());
        let mut x = vec![0.0; rows.rows()];
        assert!(inside.start(&rows));
        let (steps, there) = inside.go_on(&rows, 1e-9, &mut x);
        assert!(steps <= 101 && x.iter().all(|x| x.is_finite()), "{case}: {steps}");
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
    rows.push(BlockLaw::Limit, [0.0]);
    rows.couple(|_, line| line[0] = 1.0);
    assert!(!InteriorPoint::default().start(&rows));
}
