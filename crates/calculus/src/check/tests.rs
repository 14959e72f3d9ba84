//! The mistakes that a check must find, and the right derivatives that it must not blame.

use super::*;
use crate::{FIXED, Sink};

type Block = (Vec<usize>, Vec<f64>);

/// A potential of closures: energy, differential, blocks of the Hessian.
struct Given<V, D, H> {
    freedoms: usize,
    energy: V,
    differential: D,
    hessian: H,
}

impl<V, D, H> Potential for Given<V, D, H>
where
    V: Fn(&[f64]) -> f64,
    D: Fn(&[f64]) -> Vec<f64>,
    H: Fn(&[f64]) -> Vec<Block>,
{
    fn dim(&self) -> usize {
        self.freedoms
    }

    fn energy(&self, q: &[f64]) -> f64 {
        (self.energy)(q)
    }

    fn add_differential(&self, q: &[f64], mut dv: Covector<&mut [f64]>) {
        dv.add_scaled(1.0, Covector(&(self.differential)(q)));
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        for (freedoms, block) in (self.hessian)(q) {
            hessian.add_symmetric(&freedoms, &block);
        }
    }
}

/// Masses on a line between springs that stiffen, each in a well: V = sum of (x/2)^2 + x^4/4 over
/// the distances x, and of 1 - cos q; all of it times `scale`.
fn chain(
    n: usize,
    scale: f64,
) -> Given<impl Fn(&[f64]) -> f64, impl Fn(&[f64]) -> Vec<f64>, impl Fn(&[f64]) -> Vec<Block>> {
    Given {
        freedoms: n,
        energy: move |q: &[f64]| {
            let link = |x: f64| 0.25 * x * x + 0.25 * x.powi(4);
            let links: f64 = q.windows(2).map(|q| link(q[1] - q[0])).sum();
            scale * (links + q.iter().map(|q| 1.0 - q.cos()).sum::<f64>())
        },
        differential: move |q: &[f64]| {
            let mut dv: Vec<f64> = q.iter().map(|q| scale * q.sin()).collect();
            for (i, q) in q.windows(2).enumerate() {
                let x = q[1] - q[0];
                let force = scale * (0.5 * x + x.powi(3));
                dv[i] -= force;
                dv[i + 1] += force;
            }
            dv
        },
        hessian: move |q: &[f64]| {
            let wells = q.iter().enumerate().map(|(i, q)| (vec![i], vec![scale * q.cos()]));
            let links = q.windows(2).enumerate().map(|(i, q)| {
                let k = scale * (0.5 + 3.0 * (q[1] - q[0]).powi(2));
                (vec![i, i + 1], vec![k, -k, -k, k])
            });
            wells.chain(links).collect()
        },
    }
}

fn configuration(n: usize, size: f64) -> Vec<f64> {
    let mut random = SplitMix64::new(7);
    (0..n).map(|_| size * random.symmetric()).collect()
}

/// The wrong entry that the check names.
fn wrong(checked: Result<Report, DerivativeError>) -> WrongEntry {
    match checked {
        Err(DerivativeError::Wrong(entry)) => *entry,
        other => panic!("expected a wrong entry, got {other:?}"),
    }
}

#[test]
fn right_derivatives_of_any_size_and_number_of_freedoms_pass() {
    for n in [1, 2, 3, 32, 33, 200, 1000] {
        for size in [0.0, 1e-9, 1e-3, 1.0, 30.0] {
            let report = check_potential(&chain(n, 1.0), &configuration(n, size)).unwrap();
            assert!(report.unseen() < 2e-6, "{n} {size}\n{report}");
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
    let q: Vec<f64> = configuration(4, 1.0).iter().map(|x| 1e8 + x).collect();
    check_potential(&chain(4, 1.0), &q).unwrap();
    let gravity = Given {
        freedoms: 4,
        energy: |q: &[f64]| 9.81 * q.iter().sum::<f64>(),
        differential: |_: &[f64]| vec![9.81; 4],
        hessian: |_: &[f64]| vec![],
    };
    check_potential(&gravity, &q).unwrap();
    check_potential(&(gravity, chain(4, 1.0)), &q).unwrap();
}

#[test]
fn constant_and_linear_functions_pass_and_say_that_they_do_not_bend() {
    for scale in [0.0, 1e-12, 1.0, 1e12] {
        let linear = Given {
            freedoms: 3,
            energy: |q: &[f64]| scale * (1.0 + 2.0 * q[0] - q[2]),
            differential: |_: &[f64]| vec![2.0 * scale, 0.0, -scale],
            hessian: |_: &[f64]| vec![(vec![0, 2], vec![0.0; 4])],
        };
        let report = check_potential(&linear, &[0.3, 0.1, -0.7]).unwrap();
        assert!(report.to_string().contains("no truncation regime"), "{report}");
        assert_eq!(report.agreements[0].differences.forward_slope(), None);
    }
}

#[test]
fn a_body_at_rest_passes_though_its_forces_are_all_rounding() {
    // A spring of length 1 between two points of the plane, unstretched up to rounding.
    let length = |q: &[f64]| (q[2] - q[0]).hypot(q[3] - q[1]);
    let spring = Given {
        freedoms: 4,
        energy: |q: &[f64]| 0.5e6 * (length(q) - 1.0).powi(2),
        differential: |q: &[f64]| {
            let l = length(q);
            let force = 1e6 * (l - 1.0) / l;
            let (x, y) = (force * (q[2] - q[0]), force * (q[3] - q[1]));
            vec![-x, -y, x, y]
        },
        hessian: |q: &[f64]| {
            let l = length(q);
            let u = [(q[2] - q[0]) / l, (q[3] - q[1]) / l];
            let k = |i: usize, j: usize| {
                let delta = if i % 2 == j % 2 { 1.0 } else { 0.0 };
                let uu = u[i % 2] * u[j % 2];
                let entry = 1e6 * (uu + (1.0 - 1.0 / l) * (delta - uu));
                if i / 2 == j / 2 { entry } else { -entry }
            };
            vec![(vec![0, 1, 2, 3], (0..16).map(|e| k(e % 4, e / 4)).collect())]
        },
    };
    for turn in 0..500 {
        let (s, c) = (0.0126 * f64::from(turn)).sin_cos();
        let far = 10_f64.powi(turn % 4);
        assert_derivatives(&spring, &[far, -far, far + c, s - far]);
    }
}

#[test]
fn one_wrong_sign_among_a_thousand_entries_is_named() {
    for bad in [0, 1, 499, 777, 999] {
        let right = chain(1000, 1.0);
        let differential = |q: &[f64]| {
            let mut dv = (right.differential)(q);
            dv[bad] = -dv[bad];
            dv
        };
        let potential =
            Given { freedoms: 1000, energy: &right.energy, differential, hessian: &right.hessian };
        let entry = wrong(check_potential(&potential, &configuration(1000, 1.0)));
        assert_eq!((entry.derivative, entry.column), (Derivative::Differential, bad));
        assert!((entry.measured / entry.claimed + 1.0).abs() < 1e-6, "{entry}");
        assert!(entry.to_string().contains("measured  -1.000000 times the claim"), "{entry}");
    }
}

#[test]
fn one_wrong_entry_among_a_thousand_rows_of_a_hessian_is_named() {
    let right = chain(1000, 1.0);
    let hessian = |q: &[f64]| {
        let mut blocks = (right.hessian)(q);
        blocks[1000 + 640].1[1] *= -1.0;
        blocks[1000 + 640].1[2] *= -1.0;
        blocks
    };
    let potential =
        Given { freedoms: 1000, energy: &right.energy, differential: &right.differential, hessian };
    let entry = wrong(check_potential(&potential, &configuration(1000, 1.0)));
    assert_eq!(entry.derivative, Derivative::Hessian);
    let place = (entry.row.min(entry.column), entry.row.max(entry.column));
    assert_eq!(place, (640, 641));
    assert_eq!(entry.others, 1);
}

#[test]
fn a_lost_factor_of_two_is_named_with_its_ratio() {
    for n in [5, 100] {
        let right = chain(n, 1.0);
        let potential = Given {
            freedoms: n,
            energy: &right.energy,
            differential: |q: &[f64]| (right.differential)(q).iter().map(|x| 0.5 * x).collect(),
            hessian: &right.hessian,
        };
        let entry = wrong(check_potential(&potential, &configuration(n, 1.0)));
        assert!((entry.measured / entry.claimed - 2.0).abs() < 1e-6, "{entry}");
    }
}

#[test]
fn errors_of_a_millionth_of_the_largest_entry_are_found() {
    for n in [8, 1000] {
        for (epsilon, found) in [(1e-6, true), (1e-9, false)] {
            let right = chain(n, 1.0);
            let off = |q: &[f64]| {
                let mut dv = (right.differential)(q);
                let largest = dv.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
                dv[n / 3] += epsilon * largest;
                dv
            };
            let potential = Given {
                freedoms: n,
                energy: &right.energy,
                differential: off,
                hessian: |_: &[f64]| vec![],
            };
            let checked = check_potential(&potential, &configuration(n, 1.0));
            match (found, checked) {
                (true, checked) => assert_eq!(wrong(checked).column, n / 3),
                (false, checked) => assert_eq!(wrong(checked).derivative, Derivative::Hessian),
            }

            let hessian = |q: &[f64]| {
                let mut blocks = (right.hessian)(q);
                let k = 3.0;
                blocks.push((vec![2, 5], vec![0.0, k * epsilon, k * epsilon, 0.0]));
                blocks
            };
            let potential = Given {
                freedoms: n,
                energy: &right.energy,
                differential: &right.differential,
                hessian,
            };
            let checked = check_potential(&potential, &configuration(n, 0.2));
            assert_eq!(checked.is_err(), found, "{checked:?}");
        }
    }
}

/// V = x^T B y for two points of space, with a coupling B that is not symmetric.
fn coupling(q: &[f64], transposed: bool) -> Vec<Block> {
    let _ = q;
    let b = |i: usize, j: usize| (1 + i + 3 * j) as f64;
    let entry = |i: usize, j: usize| match (i / 3, j / 3, transposed) {
        (0, 1, false) => b(i, j - 3),
        (1, 0, false) => b(j, i - 3),
        (0, 1, true) => b(j - 3, i),
        (1, 0, true) => b(i - 3, j),
        _ => 0.0,
    };
    vec![((0..6).collect(), (0..36).map(|e| entry(e % 6, e / 6)).collect())]
}

fn coupled(q: &[f64]) -> Vec<f64> {
    let (freedoms, block) = coupling(q, false).remove(0);
    freedoms.iter().map(|&i| (0..6).map(|j| block[i + 6 * j] * q[j]).sum()).collect()
}

#[test]
fn a_transposed_block_is_found_though_the_whole_stays_symmetric() {
    let q = configuration(6, 1.0);
    for transposed in [false, true] {
        let potential = Given {
            freedoms: 6,
            energy: |q: &[f64]| 0.5 * coupled(q).iter().zip(q).map(|(a, b)| a * b).sum::<f64>(),
            differential: coupled,
            hessian: |q: &[f64]| coupling(q, transposed),
        };
        match check_potential(&potential, &q) {
            Err(DerivativeError::Wrong(entry)) => {
                assert!(transposed && entry.derivative == Derivative::Hessian && entry.others > 0);
            }
            checked => assert!(!transposed && checked.is_ok(), "{checked:?}"),
        }
    }
}

#[test]
fn an_unsymmetric_hessian_is_named_by_the_entry_and_its_mirror() {
    let right = chain(5, 1.0);
    let lower_only = |q: &[f64]| {
        let mut blocks = (right.hessian)(q);
        blocks[7].1[2] = 0.0;
        blocks
    };
    let potential = Given {
        freedoms: 5,
        energy: &right.energy,
        differential: &right.differential,
        hessian: lower_only,
    };
    let error = check_potential(&potential, &configuration(5, 1.0)).unwrap_err();
    assert!(
        matches!(error, DerivativeError::NotSymmetric { row: 3, column: 2, mirror: 0.0, .. }),
        "{error}"
    );
}

#[test]
fn a_differential_that_is_right_only_at_zero_is_found_from_zero() {
    for n in [3, 100] {
        let right = chain(n, 1.0);
        let potential = Given {
            freedoms: n,
            energy: &right.energy,
            differential: |_: &[f64]| vec![0.0; n],
            hessian: |_: &[f64]| vec![],
        };
        let entry = wrong(check_potential(&potential, &vec![0.0; n]));
        assert!(entry.configuration > 0 && entry.derivative == Derivative::Differential);
    }
}

#[test]
fn constants_that_dwarf_the_function_blur_the_check_and_the_report_says_so() {
    let offset = Given {
        freedoms: 1,
        energy: |q: &[f64]| 1e9 + q[0].cos(),
        differential: |q: &[f64]| vec![-q[0].sin()],
        hessian: |q: &[f64]| vec![(vec![0], vec![-q[0].cos()])],
    };
    let report = check_potential(&offset, &[1.0]).unwrap();
    assert!((1e-5..1e-3).contains(&report.unseen()), "{report}");
}

#[test]
fn a_projected_hessian_is_not_the_second_derivative() {
    let cosine = Given {
        freedoms: 1,
        energy: |q: &[f64]| q[0].cos(),
        differential: |q: &[f64]| vec![-q[0].sin()],
        hessian: |q: &[f64]| vec![(vec![0], vec![(-q[0].cos()).max(0.0)])],
    };
    assert_eq!(wrong(check_potential(&cosine, &[0.5])).derivative, Derivative::Hessian);
}

#[test]
fn barriers_contacts_and_fixed_freedoms_pass() {
    let barrier = Given {
        freedoms: 2,
        energy: |q: &[f64]| -1e-3 * q[0].ln() + 0.5e6 * q[1].min(0.0).powi(2),
        differential: |q: &[f64]| vec![-1e-3 / q[0], 1e6 * q[1].min(0.0)],
        hessian: |q: &[f64]| {
            let stiffness = if q[1] < 0.0 { 1e6 } else { 0.0 };
            let block = vec![1e-3 / (q[0] * q[0]), 0.0, 0.0, 0.0, stiffness, 7.0, 0.0, 7.0, 7.0];
            vec![(vec![0, 1, FIXED], block)]
        },
    };
    for q in [[1e-3, 0.1], [0.5, 1e-6], [2.0, -0.1], [1e-6, -1e-6]] {
        assert_derivatives(&barrier, &q);
    }
}

#[test]
fn what_cannot_be_checked_is_refused_by_name() {
    let root = Given {
        freedoms: 1,
        energy: |q: &[f64]| q[0].abs().sqrt(),
        differential: |q: &[f64]| vec![0.5 / q[0].sqrt()],
        hessian: |_: &[f64]| vec![(vec![3], vec![0.0])],
    };
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
    let transposed = |q: &[f64]| df(q).transpose();
    assert!(check_jacobian(f, transposed, &q).is_err());
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
    assert_jacobian(|_| vec![], |_| DMatrix::zeros(0, 3), &q);
}

#[test]
fn the_message_names_the_entry_and_shows_errors_that_do_not_fall() {
    let cubic = Given {
        freedoms: 1,
        energy: |q: &[f64]| q[0].powi(3),
        differential: |q: &[f64]| vec![-3.0 * q[0] * q[0]],
        hessian: |q: &[f64]| vec![(vec![0], vec![6.0 * q[0]])],
    };
    let message = check_potential(&cubic, &[1.0]).unwrap_err().to_string();
    let start = "the differential is wrong at freedom 0\n  claimed   -3.000000e0\n  \
         measured  3.000000e0, within ";
    assert!(message.starts_with(start), "{message}");
    let end = "\
        1.2e-10  2.0e0          2.0e0\n\
        1.5e-11  2.0e0          2.0e0\n";
    let _ = end;
    assert!(message.contains("3.1e-2   2.0e0          2.0e0\n"), "{message}");
}

#[test]
fn the_report_shows_slopes_one_and_two() {
    let right = chain(3, 1.0);
    let report = check_potential(&right, &[0.3, -0.2, 0.5]).unwrap();
    let text = report.to_string();
    println!("{text}");
    assert!(text.starts_with(
        "differential: right at 4 configurations of 3 freedoms, \
         but for errors below about 1e-6 of a row's largest entry\n\
         step     forward error  centred error\n\
         2.5e-1"
    ));
    assert_eq!(text.matches("slope of the forward error: 1.0\n").count(), 2, "{text}");
    assert_eq!(text.matches("slope of the centred error: 2.0\n").count(), 2, "{text}");
}

#[test]
#[should_panic(expected = "the differential is wrong at freedom 1")]
fn the_assertion_fails_a_test_with_the_message() {
    let right = chain(3, 1.0);
    let shifted = |q: &[f64]| {
        let mut dv = (right.differential)(q);
        dv[1] += 1e-3;
        dv
    };
    let potential = Given {
        freedoms: 3,
        energy: &right.energy,
        differential: shifted,
        hessian: &right.hessian,
    };
    assert_derivatives(&potential, &[0.3, -0.2, 0.5]);
}

/// Rotations as unit quaternions, scalar first, moved by q <- q exp(h w/2): w in body axes.
struct Rotations;

fn product(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

impl Space for Rotations {
    fn stored(&self, freedoms: usize) -> usize {
        freedoms / 3 * 4
    }

    fn advance(&self, q: &mut [f64], h: f64, v: Vector<&[f64]>) {
        for (q, w) in q.chunks_exact_mut(4).zip(v.0.chunks_exact(3)) {
            let angle = h * (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]).sqrt();
            let half = if angle == 0.0 { 0.5 * h } else { h * (0.5 * angle).sin() / angle };
            let turn = [(0.5 * angle).cos(), half * w[0], half * w[1], half * w[2]];
            q.copy_from_slice(&product([q[0], q[1], q[2], q[3]], turn));
        }
    }
}

/// The vector in body axes: R^T g.
fn in_body(q: &[f64], g: [f64; 3]) -> [f64; 3] {
    let conjugate = [q[0], -q[1], -q[2], -q[3]];
    let [_, x, y, z] =
        product(product(conjugate, [0.0, g[0], g[1], g[2]]), [q[0], q[1], q[2], q[3]]);
    [x, y, z]
}

const ARM: [f64; 3] = [0.3, -0.2, 0.7];
const WEIGHT: [f64; 3] = [1.0, 2.0, -9.0];

/// V = - sum over bodies of G . R r, differential (G_body x r) by body: dV w = -G_b . (w x r).
fn hanging(
    bodies: usize,
    twist: f64,
) -> Given<impl Fn(&[f64]) -> f64, impl Fn(&[f64]) -> Vec<f64>, impl Fn(&[f64]) -> Vec<Block>> {
    let r = ARM;
    Given {
        freedoms: 3 * bodies,
        energy: move |q: &[f64]| {
            let each =
                |q: &[f64]| in_body(q, WEIGHT).iter().zip(r).map(|(g, r)| g * r).sum::<f64>();
            -q.chunks_exact(4).map(each).sum::<f64>()
        },
        differential: move |q: &[f64]| {
            let each = |q: &[f64]| {
                let g = in_body(q, WEIGHT);
                // -g . (w x r) = -(r x g) . w
                [
                    -(r[1] * g[2] - r[2] * g[1]),
                    -(r[2] * g[0] - r[0] * g[2]),
                    -(r[0] * g[1] - r[1] * g[0]),
                ]
            };
            q.chunks_exact(4).flat_map(each).collect()
        },
        hessian: move |q: &[f64]| {
            // d2/dh2 of -g . exp(h [w]) r at 0 is -g . (w x (w x r)) = (g.r) w.w - (g.w) (w.r).
            let each = |(body, q): (usize, &[f64])| {
                let g = in_body(q, WEIGHT);
                let dot: f64 = g.iter().zip(r).map(|(g, r)| g * r).sum();
                let entry = |e: usize| {
                    let (i, j) = (e % 3, e / 3);
                    let diagonal = if i == j { dot } else { twist };
                    diagonal - 0.5 * (g[i] * r[j] + g[j] * r[i])
                };
                ((3 * body..3 * body + 3).collect(), (0..9).map(entry).collect())
            };
            q.chunks_exact(4).enumerate().map(each).collect()
        },
    }
}

fn orientations(bodies: usize) -> Vec<f64> {
    let mut q = [1.0, 0.0, 0.0, 0.0].repeat(bodies);
    Rotations.advance(&mut q, 1.0, Vector(&configuration(3 * bodies, 2.0)));
    q
}

#[test]
fn a_body_that_hangs_from_a_point_passes_on_the_space_of_rotations() {
    for bodies in [1, 4, 20, 100] {
        let report = check_potential_on(&Rotations, &hanging(bodies, 0.0), &orientations(bodies));
        assert!(report.unwrap().unseen() < 1e-5);
    }
}

#[test]
fn on_the_space_of_rotations_a_wrong_entry_is_named() {
    for bodies in [1, 4, 100] {
        let q = orientations(bodies);
        let entry = wrong(check_potential_on(&Rotations, &hanging(bodies, 1e-4), &q));
        assert_eq!(entry.derivative, Derivative::Hessian);
        assert!(entry.row / 3 == entry.column / 3 && entry.row != entry.column, "{entry}");
        let right = hanging(bodies, 0.0);
        let inverted = |q: &[f64]| {
            let mut dv = (right.differential)(q);
            let last = dv.len() - 1;
            dv[last] = -dv[last];
            dv
        };
        let potential = Given {
            freedoms: 3 * bodies,
            energy: &right.energy,
            differential: inverted,
            hessian: &right.hessian,
        };
        let entry = wrong(check_potential_on(&Rotations, &potential, &q));
        assert_eq!((entry.derivative, entry.column), (Derivative::Differential, 3 * bodies - 1));
    }
}

#[test]
fn a_thousand_freedoms_take_well_under_a_second() {
    let (potential, q) = (chain(1000, 1.0), configuration(1000, 1.0));
    let start = std::time::Instant::now();
    check_potential(&potential, &q).unwrap();
    let elapsed = start.elapsed().as_secs_f64();
    println!("a thousand freedoms: {elapsed:.3} s");
    assert!(elapsed < 5.0, "{elapsed} s");
}
