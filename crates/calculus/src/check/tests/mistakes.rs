//! The mistakes that a check must find and name.

use super::*;

#[test]
fn one_wrong_sign_among_a_thousand_entries_is_named() {
    for bad in [0, 1, 499, 777, 999] {
        let potential = chain(1000, 1.0).with_differential(move |dv| dv[bad] = -dv[bad]);
        let entry = wrong(check_potential(&potential, &configuration(1000, 1.0)));
        assert_eq!((entry.derivative, entry.column), (Derivative::Differential, bad));
        assert!(entry.to_string().contains("measured  -1.000000 times the claim"), "{entry}");
    }
}

#[test]
fn one_wrong_coupling_among_a_thousand_rows_of_a_hessian_is_named() {
    let potential = chain(1000, 1.0).with_hessian(|blocks| {
        let (_, spring) = &mut blocks[1000 + 640];
        (spring[1], spring[2]) = (-spring[1], -spring[2]);
    });
    let entry = wrong(check_potential(&potential, &configuration(1000, 1.0)));
    assert_eq!(entry.derivative, Derivative::Hessian);
    assert_eq!((entry.row.min(entry.column), entry.row.max(entry.column)), (640, 641));
    assert_eq!(entry.others, 1);
}

#[test]
fn a_lost_factor_of_two_is_named_with_its_ratio() {
    for n in [5, 100] {
        let halved = |dv: &mut [f64]| dv.iter_mut().for_each(|x| *x *= 0.5);
        let potential = chain(n, 1.0).with_differential(halved);
        let entry = wrong(check_potential(&potential, &configuration(n, 1.0)));
        assert!((entry.measured / entry.claimed - 2.0).abs() < 1e-6, "{entry}");
    }
}

#[test]
fn an_error_of_a_millionth_of_the_largest_entry_is_found_and_one_of_a_billionth_is_not() {
    for n in [8, 1000] {
        for (epsilon, found) in [(1e-6, true), (1e-9, false)] {
            let off = move |dv: &mut [f64]| dv[n / 3] += epsilon * largest(dv);
            let potential = chain(n, 1.0).with_differential(off);
            let checked = check_potential(&potential, &configuration(n, 1.0));
            assert_eq!(checked.is_err(), found);
            if found {
                assert_eq!(wrong(checked).column, n / 3);
            }
            // No entry of the Hessian at this configuration exceeds 3.
            let extra = 3.0 * epsilon;
            let coupled = move |blocks: &mut Vec<Block>| {
                blocks.push((vec![2, 5], vec![0.0, extra, extra, 0.0]));
            };
            let potential = chain(n, 1.0).with_hessian(coupled);
            let checked = check_potential(&potential, &configuration(n, 0.2));
            assert_eq!(checked.is_err(), found);
            if found {
                let entry = wrong(checked);
                assert_eq!((entry.row.min(entry.column), entry.row.max(entry.column)), (2, 5));
            }
        }
    }
}

/// V = x^T B y for two points of space, with a coupling B that is not symmetric.
#[test]
fn a_transposed_block_is_found_though_the_whole_stays_symmetric() {
    fn coupling(b: fn(usize, usize) -> f64) -> Vec<f64> {
        let entry = |e: usize| match (e % 6, e / 6) {
            (i @ 0..3, j @ 3..) => b(i, j - 3),
            (i @ 3.., j @ 0..3) => b(j, i - 3),
            _ => 0.0,
        };
        (0..36).map(entry).collect()
    }
    let b = |i: usize, j: usize| (1 + i + 3 * j) as f64;
    let transposed = |i: usize, j: usize| (1 + j + 3 * i) as f64;
    let blocks = move |matrix: Vec<f64>| move |_: &[f64]| vec![((0..6).collect(), matrix.clone())];
    let differential = move |q: &[f64]| -> Vec<f64> {
        let matrix = coupling(b);
        (0..6).map(|i| (0..6).map(|j| matrix[i + 6 * j] * q[j]).sum()).collect()
    };
    let energy =
        move |q: &[f64]| 0.5 * differential(q).iter().zip(q).map(|(a, b)| a * b).sum::<f64>();
    let q = configuration(6, 1.0);
    assert_derivatives(&given(6, energy, differential, blocks(coupling(b))), &q);
    let mistaken = given(6, energy, differential, blocks(coupling(transposed)));
    let entry = wrong(check_potential(&mistaken, &q));
    assert_eq!((entry.derivative, entry.row / 3 + entry.column / 3), (Derivative::Hessian, 1));
    // Of 18 entries the 6 on the diagonal of B are right.
    assert_eq!(entry.others, 11);
}

#[test]
fn an_unsymmetric_hessian_is_named_by_the_entry_and_its_mirror() {
    let lower_only = chain(5, 1.0).with_hessian(|blocks| blocks[5 + 2].1[2] = 0.0);
    let error = check_potential(&lower_only, &configuration(5, 1.0)).unwrap_err();
    let named =
        matches!(error, DerivativeError::NotSymmetric { row: 3, column: 2, mirror: 0.0, .. });
    assert!(named, "{error}");
}

#[test]
fn a_differential_that_is_right_only_at_zero_is_found_from_zero() {
    for n in [3, 100] {
        let right = chain(n, 1.0);
        let potential = given(n, right.energy, move |_| vec![0.0; n], |_| Vec::new());
        let entry = wrong(check_potential(&potential, &vec![0.0; n]));
        assert_eq!(entry.derivative, Derivative::Differential);
        assert!(entry.configuration > 0, "{entry}");
    }
}

#[test]
fn a_projected_hessian_is_not_the_second_derivative() {
    let cosine = given(
        1,
        |q| q[0].cos(),
        |q| vec![-q[0].sin()],
        |q| vec![(vec![0], vec![(-q[0].cos()).max(0.0)])],
    );
    assert_eq!(wrong(check_potential(&cosine, &[0.5])).derivative, Derivative::Hessian);
}

#[test]
fn what_cannot_be_checked_is_refused_by_name() {
    let root = given(
        1,
        |q| q[0].abs().sqrt(),
        |q| vec![0.5 / q[0].sqrt()],
        |_| vec![(vec![3], vec![0.0])],
    );
    let not_finite = |q: f64| match check_potential(&root, &[q]) {
        Err(DerivativeError::NotFinite { what, .. }) => what,
        other => panic!("{other:?}"),
    };
    assert_eq!(not_finite(f64::NAN), "the energy");
    assert_eq!(not_finite(0.0), "the differential");
    let error = check_potential(&root, &[1.0]).unwrap_err();
    assert_eq!(error, DerivativeError::UnknownFreedom { freedom: 3, freedoms: 1 });
    assert!(matches!(check_potential(&root, &[1.0, 2.0]), Err(DerivativeError::Size(_))));
}

#[test]
fn a_jacobian_is_checked_row_by_row() {
    let f = |q: &[f64]| vec![q[0] * q[1], 1e9 * q[1].sin(), q[0] - q[2]];
    let df = |q: &[f64]| {
        nalgebra::dmatrix![
            q[1], q[0], 0.0;
            0.0, 1e9 * q[1].cos(), 0.0;
            1.0, 0.0, -1.0
        ]
    };
    let q = [0.3, 0.8, 0.1];
    assert_jacobian(f, df, &q);
    assert!(check_jacobian(f, |q| df(q).transpose(), &q).is_err());
    // A small row is judged by itself, not by the large one beside it.
    let off = |q: &[f64]| {
        let mut matrix = df(q);
        matrix[(2, 1)] = 2e-6;
        matrix
    };
    let entry = wrong(check_jacobian(f, off, &q));
    assert_eq!((entry.row, entry.column, entry.claimed), (2, 1, 2e-6));
    let narrow = |q: &[f64]| df(q).columns(0, 2).into_owned();
    assert!(matches!(check_jacobian(f, narrow, &q), Err(DerivativeError::Size(_))));
    assert_jacobian(|_| Vec::new(), |_| DMatrix::zeros(0, 3), &q);
}

#[test]
fn the_message_names_the_entry_and_shows_errors_that_do_not_fall() {
    let cubic = given(
        1,
        |q| q[0].powi(3),
        |q| vec![-3.0 * q[0] * q[0]],
        |q| vec![(vec![0], vec![6.0 * q[0]])],
    );
    let message = check_potential(&cubic, &[1.0]).unwrap_err().to_string();
    let start = "\
the differential is wrong at freedom 0
  claimed   -3.000000e0
  measured  3.000000e0, within ";
    assert!(message.starts_with(start), "{message}");
    let middle = "
  off by    -6.000e0
  measured  -1.000000 times the claim
  where     at the given configuration
  q         [1.0]
errors of differences against the claim, over the row's largest entry:
step     forward error  centred error
2.5e-1   2.3e0          2.0e0
3.1e-2   2.0e0          2.0e0
3.9e-3   2.0e0          2.0e0
";
    assert!(message.contains(middle), "{message}");
}

#[test]
#[should_panic(expected = "the differential is wrong at freedom 1")]
fn the_assertion_fails_a_test_with_the_message() {
    let potential = chain(3, 1.0).with_differential(|dv| dv[1] += 1e-3);
    assert_derivatives(&potential, &[0.3, -0.2, 0.5]);
}

#[test]
#[should_panic(expected = "the differential is wrong at freedom 1")]
fn the_assertion_on_a_space_fails_a_test_with_the_message() {
    let potential = chain(3, 1.0).with_differential(|dv| dv[1] += 1e-3);
    assert_derivatives_on(&Flat, &potential, &[0.3, -0.2, 0.5]);
}

#[test]
fn a_branch_within_half_a_length_is_found_with_every_seed() {
    for seed in 0..50 {
        let check = DerivativeCheck { seed, ..DerivativeCheck::default() };
        for (q, bound) in [(-0.3, 0.0), (0.3, 0.0), (-0.3, -0.75), (5.0, 7.4)] {
            let beyond = move |x: f64| (x > bound) != (q > bound);
            let branch = given(
                1,
                |q| q[0].powi(4) + q[0],
                move |q| vec![if beyond(q[0]) { 1.0 } else { 4.0 * q[0].powi(3) + 1.0 }],
                |q| vec![(vec![0], vec![12.0 * q[0] * q[0]])],
            );
            let entry = wrong(check.potential(&branch, &[q]));
            assert_eq!(entry.derivative, Derivative::Differential, "{seed} {q} {bound}");
        }
    }
}

/// A square in each freedom that writes over what was there.
struct Assigns(usize);

impl Potential for Assigns {
    fn dim(&self) -> usize {
        3
    }

    fn energy(&self, q: &[f64]) -> f64 {
        0.5 * q.iter().map(|q| q * q).sum::<f64>()
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        for (i, (dv, q)) in dv.0.iter_mut().zip(q).enumerate() {
            if i == self.0 { *dv = *q } else { *dv += q }
        }
    }

    fn add_hessian(&self, _: &[f64], hessian: &mut impl Sink) {
        (0..3).for_each(|i| hessian.add_symmetric(&[i], &[1.0]));
    }
}

#[test]
fn a_differential_that_is_assigned_and_not_added_is_named() {
    for freedom in 0..3 {
        for q in [[0.3, -0.2, 0.5], [0.0; 3], [1e6, -1e-6, 0.0]] {
            let error = check_potential(&Assigns(freedom), &q).unwrap_err();
            assert_eq!(error, DerivativeError::Assigned { freedom });
        }
    }
    assert_derivatives(&Assigns(3), &[0.3, -0.2, 0.5]);
}

#[test]
fn blocks_whose_order_depends_on_q_are_named() {
    let ordered = |keeps: bool| {
        given(
            2,
            |q| 0.5 * q[0] * q[0] + q[1] * q[1],
            |q| vec![q[0], 2.0 * q[1]],
            move |q| {
                let mut blocks = vec![(vec![0], vec![1.0]), (vec![1], vec![2.0])];
                if q[0] > 0.0 && !keeps {
                    blocks.reverse();
                }
                blocks
            },
        )
    };
    let error = check_potential(&ordered(false), &[-0.3, 0.2]).unwrap_err();
    assert!(matches!(error, DerivativeError::PatternChanged { block: 0, .. }), "{error}");
    assert_derivatives(&ordered(true), &[-0.3, 0.2]);
}

#[test]
fn a_differential_too_little_wrong_to_be_seen_is_blamed_and_not_the_hessian() {
    // Beside a load of 1e7 the force sin q is nothing, but its slope is not.
    let loaded = given(
        2,
        |q| 1e7 * q[0] - q[1].cos(),
        |q| vec![1e7, 1.3 * q[1].sin()],
        |q| vec![(vec![1], vec![q[1].cos()])],
    );
    let entry = wrong(check_potential(&loaded, &[0.2, 0.4]));
    assert_eq!((entry.derivative, entry.column), (Derivative::Differential, 1));
    assert_eq!(entry.along, Some(1));
    assert!((entry.claimed / entry.measured - 1.3).abs() < 1e-3, "{entry}");
}

#[test]
fn settings_that_are_no_numbers_are_refused() {
    let steep = chain(2, 1.0).with_differential(|dv| dv.iter_mut().for_each(|x| *x *= 3.5));
    for tolerance in [f64::NAN, 0.0, -1.0, 1.0, f64::INFINITY] {
        let check = DerivativeCheck { tolerance, ..DerivativeCheck::default() };
        let error = check.potential(&steep, &[0.3, 0.1]).unwrap_err();
        assert!(matches!(error, DerivativeError::Setting { setting: "tolerance", .. }), "{error}");
    }
    for length in [f64::NAN, 0.0, -1.0, f64::INFINITY] {
        let check = DerivativeCheck { length: Some(length), ..DerivativeCheck::default() };
        let error = check.potential(&steep, &[0.3, 0.1]).unwrap_err();
        assert!(matches!(error, DerivativeError::Setting { setting: "length", .. }), "{error}");
    }
}

#[test]
fn blocks_and_values_of_other_sizes_are_refused() {
    let blocks = chain(2, 1.0).with_hessian(|blocks| blocks[1].1 = vec![1.0, 2.0]);
    let error = check_potential(&blocks, &[0.3, 0.1]).unwrap_err();
    assert_eq!(error, DerivativeError::BlockSize { block: 1, entries: 2, freedoms: 1 });
    let changing = |q: &[f64]| vec![1.0; if q[0] > 0.4 { 2 } else { 1 }];
    let error = check_jacobian(changing, |_| DMatrix::zeros(1, 1), &[0.3]).unwrap_err();
    assert!(matches!(error, DerivativeError::Size(_)), "{error}");
}

/// The chain of 40 freedoms, one of them in a well with a wall so steep that half a length away from it
/// the energy is out of all bounds.
#[test]
fn one_freedom_beside_a_wall_does_not_hide_what_depends_on_the_others() {
    let n = 40;
    let wall = |_: &[f64]| {
        given(
            1,
            |q| (1e6 * q[0]).exp(),
            |q| vec![1e6 * (1e6 * q[0]).exp()],
            |q| vec![(vec![0], vec![1e12 * (1e6 * q[0]).exp()])],
        )
    };
    let walled = wall(&[]);
    let potential = || {
        let (walled, chain) = (wall(&[]), chain(n, 1.0));
        let (energy, other) = (chain.energy, walled.energy);
        let (differential, push) = (chain.differential, walled.differential);
        let (hessian, stiffness) = (chain.hessian, walled.hessian);
        given(
            n,
            move |q| energy(q) + other(q),
            move |q| {
                let mut dv = differential(q);
                dv[0] += push(q)[0];
                dv
            },
            move |q| [hessian(q), stiffness(q)].concat(),
        )
    };
    let mut q = configuration(n, 1.0);
    q[0] = -1e-6;
    assert!(!walled.energy(&[0.5]).is_finite());
    check_potential(&potential(), &q).unwrap();
    let whole = potential();
    let hessian = whole.hessian;
    let mistaken = Given {
        hessian: Box::new(move |q: &[f64]| {
            let mut blocks = hessian(q);
            if q[17] > 1.2 {
                blocks.reverse();
            }
            blocks
        }),
        ..whole
    };
    q[17] = 0.9;
    let error = check_potential(&mistaken, &q).unwrap_err();
    assert!(matches!(error, DerivativeError::PatternChanged { .. }), "{error}");
}

/// V = c + f x + (x - y)^2/2 + y^2/2, whose second component is off by a hundredth: too little beside load
/// and constant to be seen in the differential itself.
#[test]
fn a_component_beside_a_load_is_blamed_and_not_the_hessian() {
    let loaded = |constant: f64, load: f64| {
        given(
            2,
            move |q| constant + load * q[0] + 0.5 * (q[0] - q[1]).powi(2) + 0.5 * q[1] * q[1],
            move |q| vec![load + q[0] - q[1], 1.01 * (2.0 * q[1] - q[0])],
            |_| vec![(vec![0, 1], vec![1.0, -1.0, -1.0, 2.0])],
        )
    };
    // Beside the constant the energy tells nothing, but the slopes are not symmetric.
    for (constant, load) in [(0.0, 1e5), (0.0, 1e9), (1e13, 1.0)] {
        let entry = wrong(check_potential(&loaded(constant, load), &[0.7, 0.3]));
        assert_eq!((entry.derivative, entry.column), (Derivative::Differential, 1), "{entry}");
    }
}

/// The same without a coupling.
#[test]
fn where_neither_the_energy_nor_symmetry_tells_neither_derivative_is_blamed() {
    let loaded = given(
        2,
        |q| 1e13 * q[0] + q[1] * q[1],
        |q| vec![1e13, 2.02 * q[1]],
        |_| vec![(vec![0, 1], vec![0.0, 0.0, 0.0, 2.0])],
    );
    let entry = wrong(check_potential(&loaded, &[0.7, 0.3]));
    assert_eq!(entry.derivative, Derivative::DifferentialOrHessian, "{entry}");
    assert!(entry.to_string().starts_with("the differential or the Hessian is wrong at row 1"));
}

/// Two short waves, of whose Hessian one block is missing. Over steps of 1 the energy does not bend.
#[test]
fn a_forgotten_block_of_a_short_wave_is_not_blamed_on_the_differential() {
    let l = 2e-6;
    let waves = given(
        2,
        move |q| (q[0] / l).cos() + (q[1] / l).cos(),
        move |q| q.iter().map(|q| -(q / l).sin() / l).collect(),
        move |q| vec![(vec![0], vec![-(q[0] / l).cos() / (l * l)])],
    );
    let entry = wrong(check_potential(&waves, &[1.7e-6, 0.6e-6]));
    assert_eq!((entry.derivative, entry.row), (Derivative::Hessian, 1), "{entry}");
}

/// The ripple is 1e-8 of the differential, its slope a hundred thousandth of the Hessian.
#[test]
fn a_ripple_a_thousand_times_shorter_than_the_length_is_found() {
    for at in [0.0, 0.36, 1.1] {
        let rippled = given(
            1,
            |q| 10.0 * q[0] + 0.5 * q[0] * q[0],
            |q| vec![10.0 + q[0] + 1e-7 * (1e3 * q[0]).sin()],
            |_| vec![(vec![0], vec![1.0])],
        );
        let entry = wrong(check_potential(&rippled, &[at]));
        assert_eq!(entry.derivative, Derivative::Differential, "{at} {entry}");
    }
}

/// q is 0.52 large, so that half a length is 0.5 and not 0.26.
#[test]
fn a_branch_half_a_length_away_is_found_where_q_is_a_little_smaller_than_the_length() {
    let branched = given(
        2,
        |q| 0.5 * (q[0] * q[0] + q[1] * q[1]),
        |q| q.to_vec(),
        |q| {
            let zero = (vec![0], vec![0.0]);
            let identity = (vec![0, 1], vec![1.0, 0.0, 0.0, 1.0]);
            if q[1] > 0.97 { vec![zero, identity] } else { vec![identity] }
        },
    );
    for seed in 0..50 {
        let check = DerivativeCheck { seed, ..DerivativeCheck::default() };
        let error = check.potential(&branched, &[0.3, 0.52]).unwrap_err();
        assert!(matches!(error, DerivativeError::PatternChanged { .. }), "{seed}: {error}");
    }
}
