//! Right derivatives that a check must not blame, and what it says of them.

use super::*;
use crate::FIXED;

#[test]
fn right_derivatives_of_any_size_and_number_of_freedoms_pass() {
    for n in [1, 2, 3, 32, 33, 200, 1000] {
        for size in [0.0, 1e-17, 1e-9, 1e-3, 1.0, 30.0] {
            let report = check_potential(&chain(n, 1.0), &configuration(n, size)).unwrap();
            // Below a millionth nothing tells a displacement from a small problem: the report says so.
            let limit = if size == 1e-9 { 0.1 } else { 2e-6 };
            assert!(report.unseen() < limit, "{n} {size}\n{report}");
        }
    }
}

#[test]
fn energies_of_any_magnitude_pass_and_hide_nothing() {
    for scale in [1e-12, 1e-6, 1e6, 1e12] {
        let report = check_potential(&chain(40, scale), &configuration(40, 0.7)).unwrap();
        assert!(report.unseen() < 2e-6, "{scale}\n{report}");
    }
}

#[test]
fn errors_below_the_tolerance_are_hidden_and_hardly_larger_ones() {
    for n in [5, 1000] {
        let report = check_potential(&chain(n, 1.0), &configuration(n, 0.7)).unwrap();
        let tolerance = DerivativeCheck::default().tolerance;
        assert!((1.0..1.1).contains(&(report.unseen() / tolerance)), "{n}\n{report}");
    }
}

#[test]
fn many_seeds_raise_no_false_alarm() {
    for seed in 0..300 {
        let check = DerivativeCheck { seed, ..DerivativeCheck::default() };
        let mut random = SplitMix64::new(seed);
        let q: Vec<f64> = (0..6).map(|_| 10_f64.powf(3.0 * random.symmetric())).collect();
        check.potential(&chain(6, 1.0), &q).unwrap();
        check.potential(&chain(40, 1.0), &configuration(40, 1.0)).unwrap();
    }
}

#[test]
fn a_configuration_a_hundred_million_from_the_origin_passes() {
    let gravity = || given(4, |q| 9.81 * q.iter().sum::<f64>(), |_| vec![9.81; 4], |_| Vec::new());
    let well = || {
        let diagonal = |_: &[f64]| (0..4).map(|i| (vec![i], vec![3.0])).collect();
        let square = |q: &[f64]| 1.5 * q.iter().map(|q| q * q).sum::<f64>();
        given(4, square, |q| q.iter().map(|q| 3.0 * q).collect(), diagonal)
    };
    let q: Vec<f64> = configuration(4, 1.0).iter().map(|x| 1e8 + x).collect();
    assert_derivatives(&chain(4, 1.0), &q);
    assert_derivatives(&gravity(), &q);
    assert_derivatives(&well(), &q);
    assert_derivatives(&(gravity(), chain(4, 1.0)), &q);
}

#[test]
fn constant_and_linear_functions_pass_and_say_that_they_do_not_bend() {
    for scale in [0.0, 1e-12, 1.0, 1e12] {
        let linear = given(
            3,
            move |q| scale * (1.0 + 2.0 * q[0] - q[2]),
            move |_| vec![2.0 * scale, 0.0, -scale],
            |_| vec![(vec![0, 2], vec![0.0; 4])],
        );
        let report = check_potential(&linear, &[0.3, 0.1, -0.7]).unwrap();
        assert!(report.to_string().contains("no truncation regime"), "{report}");
        assert_eq!(report.agreements[0].differences.forward_slope(), None);
    }
}

/// A stiff spring of length 1 between two points of the plane, unstretched up to rounding.
#[test]
fn a_body_at_rest_passes_though_its_forces_are_all_rounding() {
    fn length(q: &[f64]) -> f64 {
        (q[2] - q[0]).hypot(q[3] - q[1])
    }
    let differential = |q: &[f64]| {
        let l = length(q);
        let force = 1e6 * (l - 1.0) / l;
        let (x, y) = (force * (q[2] - q[0]), force * (q[3] - q[1]));
        vec![-x, -y, x, y]
    };
    let hessian = |q: &[f64]| {
        let l = length(q);
        let u = [(q[2] - q[0]) / l, (q[3] - q[1]) / l];
        let entry = |e: usize| {
            let (i, j) = (e % 4, e / 4);
            let (delta, uu) = (f64::from(u8::from(i % 2 == j % 2)), u[i % 2] * u[j % 2]);
            let entry = 1e6 * (uu + (1.0 - 1.0 / l) * (delta - uu));
            if i / 2 == j / 2 { entry } else { -entry }
        };
        vec![(vec![0, 1, 2, 3], (0..16).map(entry).collect())]
    };
    let spring = given(4, |q| 0.5e6 * (length(q) - 1.0).powi(2), differential, hessian);
    for turn in 0..500 {
        let (s, c) = (0.0126 * f64::from(turn)).sin_cos();
        let far = 10_f64.powi(turn % 4);
        assert_derivatives(&spring, &[far, -far, far + c, s - far]);
    }
}

#[test]
fn barriers_contacts_and_fixed_freedoms_pass() {
    let barrier = given(
        2,
        |q| -1e-3 * q[0].ln() + 0.5e6 * q[1].min(0.0).powi(2),
        |q| vec![-1e-3 / q[0], 1e6 * q[1].min(0.0)],
        |q| {
            let stiffness = if q[1] < 0.0 { 1e6 } else { 0.0 };
            let block = vec![1e-3 / (q[0] * q[0]), 0.0, 0.0, 0.0, stiffness, 7.0, 0.0, 7.0, 7.0];
            vec![(vec![0, 1, FIXED], block)]
        },
    );
    for q in [[1e-3, 0.1], [0.5, 1e-6], [2.0, -0.1], [1e-6, -1e-6]] {
        assert_derivatives(&barrier, &q);
    }
}

#[test]
fn a_constant_that_dwarfs_the_function_blurs_the_check_and_the_report_says_so() {
    let offset = given(
        1,
        |q| 1e9 + q[0].cos(),
        |q| vec![-q[0].sin()],
        |q| vec![(vec![0], vec![-q[0].cos()])],
    );
    let report = check_potential(&offset, &[1.0]).unwrap();
    assert!((1e-5..1e-3).contains(&report.unseen()), "{report}");
}

#[test]
fn the_report_shows_slopes_one_and_two() {
    let report = check_potential(&chain(3, 1.0), &[0.3, -0.2, 0.5]).unwrap();
    let expected = "\
differential: right at 4 configurations of 3 freedoms, \
but for errors below about 1e-6 of a row's largest entry
step     forward error  centred error
2.5e-1   3.6e-1         5.8e-2
3.1e-2   5.1e-2         9.0e-4
3.9e-3   6.5e-3         1.4e-5
4.9e-4   8.1e-4         2.2e-7
6.1e-5   1.0e-4         3.4e-9
7.6e-6   1.3e-5         rounding
9.5e-7   1.6e-6         rounding
1.2e-7   2.0e-7         rounding
1.5e-8   rounding       rounding
1.9e-9   rounding       rounding
2.3e-10  rounding       rounding
2.9e-11  rounding       rounding
3.6e-12  rounding       rounding
4.5e-13  rounding       rounding
5.7e-14  rounding       rounding
7.1e-15  rounding       rounding
slope of the forward error: 1.0
slope of the centred error: 2.0
Hessian: right at 4 configurations of 3 freedoms, ";
    let text = report.to_string();
    assert!(text.starts_with(expected), "{text}");
    assert_eq!(text.matches("slope of the centred error: 2.0\n").count(), 2, "{text}");
}

#[test]
fn a_thousand_freedoms_are_checked_as_one_is() {
    let (potential, q) = (chain(1000, 1.0), configuration(1000, 1.0));

    assert_derivatives(&potential, &q);
}

#[test]
fn functions_that_end_or_bend_very_near_pass() {
    // |q|^1.5, a spring that only pushes, and a wall, each a nanometre from where it bends or ends.
    let bent = || {
        given(
            3,
            |q| {
                let [x, y, z] = [q[0].abs(), q[1].min(0.0), q[2] - 1.0];
                x.powf(1.5) + 50.0 * y * y - z.ln()
            },
            |q| {
                let x = 1.5 * q[0].abs().sqrt() * q[0].signum();
                vec![x, 100.0 * q[1].min(0.0), -1.0 / (q[2] - 1.0)]
            },
            |q| {
                let stiffness = if q[1] < 0.0 { 100.0 } else { 0.0 };
                let wall = (q[2] - 1.0).powi(-2);
                let one = |k: usize, h: f64| (vec![k], vec![h]);
                vec![one(0, 0.75 / q[0].abs().sqrt()), one(1, stiffness), one(2, wall)]
            },
        )
    };
    for d in [1e-9, -1e-9, 1e-7, 1e-4] {
        assert_derivatives(&bent(), &[d, d, 1.0 + d.abs()]);
    }
}

#[test]
fn a_gas_in_si_units_passes() {
    // Argon: 0.34 nm, 1.65e-21 J.
    let (sigma, epsilon) = (3.4e-10, 1.65e-21);
    let pair = move |q: &[f64]| (q[0] - q[1]) / sigma;
    let gas = given(
        2,
        move |q| 4.0 * epsilon * (pair(q).powi(-12) - pair(q).powi(-6)),
        move |q| {
            let r = pair(q);
            let f = 4.0 * epsilon / sigma * (-12.0 * r.powi(-13) + 6.0 * r.powi(-7));
            vec![f, -f]
        },
        move |q| {
            let r = pair(q);
            let k = 4.0 * epsilon / sigma / sigma * (156.0 * r.powi(-14) - 42.0 * r.powi(-8));
            vec![(vec![0, 1], vec![k, -k, -k, k])]
        },
    );
    for r in [0.95, 1.12, 1.5, 2.0] {
        assert_derivatives(&gas, &[r * sigma, 0.1 * sigma]);
    }
}

/// What |x|^1.5 does within a nanometre of its kink is below the rounding of the other term; beyond, its
/// slope is none to any step.
#[test]
fn a_kink_closer_than_the_rounding_of_the_energy_shows_is_no_false_alarm() {
    for distance in [1.3e-10, -1.4e-9, 6e-10] {
        let sum = given(
            2,
            |q| 11.0 * q[0].abs().powf(1.5) + 42.0 * q[1].powf(1.5),
            |q| vec![16.5 * q[0].abs().sqrt() * q[0].signum(), 63.0 * q[1].sqrt()],
            |q| {
                vec![(vec![0], vec![8.25 / q[0].abs().sqrt()]), (vec![1], vec![31.5 / q[1].sqrt()])]
            },
        );
        check_potential(&sum, &[distance, 0.12]).unwrap();
    }
}

/// Two atoms of argon all but level: the energy is even in the height, over all steps that show anything.
#[test]
fn a_gas_all_but_level_passes() {
    let (sigma, epsilon) = (1e-10, 1e-23);
    let apart = |q: &[f64]| [q[2] - q[0], q[3] - q[1]];
    let force = move |r: f64| 4.0 * epsilon * (-12.0 * r.powi(-13) + 6.0 * r.powi(-7)) / sigma;
    let length = move |q: &[f64]| apart(q)[0].hypot(apart(q)[1]);
    let gas = given(
        4,
        move |q| {
            let r = length(q) / sigma;
            4.0 * epsilon * (r.powi(-12) - r.powi(-6))
        },
        move |q| {
            let (l, [x, y]) = (length(q), apart(q));
            let f = force(l / sigma) / l;
            vec![-f * x, -f * y, f * x, f * y]
        },
        move |q| {
            let (l, d) = (length(q), apart(q));
            let r = l / sigma;
            let along = 4.0 * epsilon * (156.0 * r.powi(-14) - 42.0 * r.powi(-8)) / sigma / sigma;
            let across = force(r) / l;
            let entry = |e: usize| {
                let (i, j) = (e % 4, e / 4);
                let uu = d[i % 2] * d[j % 2] / l / l;
                let delta = f64::from(u8::from(i % 2 == j % 2));
                let entry = along * uu + across * (delta - uu);
                if i / 2 == j / 2 { entry } else { -entry }
            };
            vec![((0..4).collect(), (0..16).map(entry).collect())]
        },
    );
    for height in [5e-17, 1e-16, 1e-15, 1e-13] {
        assert_derivatives(&gas, &[0.0, 2e-12, 1e-10, 2e-12 + height]);
    }
}
