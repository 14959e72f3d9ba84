//! Modes against known spectra, and where they fail.

use proptest::prelude::*;
use stationary_calculus::{
    Covector, DiagonalMetric, FIXED, Potential, Sink, SparseError, SymmetricMatrix, Vector,
};
use stationary_elasticity::{Net, Spring, Strain, net};
use stationary_modal::problems::{SpringProblem, fixed_chain, free_chain, membrane};
use stationary_modal::{Kind, Linearized, ModalError, Modes, Motion, Reduced, RigidMotions};

fn at_rest(
    problem: &SpringProblem,
) -> Linearized<'_, DiagonalMetric<Vec<f64>>, impl Potential + '_> {
    Linearized::at(&problem.metric, &problem.potential, &problem.q, 1e-12).unwrap()
}

/// The worst of all modes, which the library reports mode by mode; checked against sums of our own.
fn orthogonality(modes: &Modes, mass: &SymmetricMatrix) -> f64 {
    let reported = modes.orthogonality(mass).unwrap();
    let mut worst = 0.0_f64;
    for (i, reported) in reported.iter().enumerate() {
        let mut mv = vec![0.0; modes.dim()];
        mass.add_product(1.0, modes.vector(i).unwrap().0, &mut mv).unwrap();
        let off = |j: usize| {
            let product = Covector(&mv[..]).apply(&modes.vector(j).unwrap());
            (product - if i == j { 1.0 } else { 0.0 }).abs()
        };
        let own = (0..modes.len()).map(off).fold(0.0, f64::max);
        assert!((own - reported).abs() < 1e-13, "{i}: {own:e} {reported:e}");
        worst = worst.max(own);
    }
    worst
}

fn check(problem: &SpringProblem, count: usize, rigid: &RigidMotions, skipped: usize) {
    let mut linearized = at_rest(problem);
    let modes = linearized.lowest(count, rigid).unwrap();
    assert_eq!(modes.len(), count);
    for (i, exact) in problem.spectrum[skipped..skipped + count].iter().enumerate() {
        let off = (modes.values()[i] - exact).abs();
        assert!(
            off < 1e-13 * linearized.scale() && off <= modes.residuals()[i] + 1e-14,
            "{i} {off:e}"
        );
        assert!(modes.residuals()[i] < 1e-10 * linearized.scale(), "{:?}", modes.residuals());
    }
    assert!(orthogonality(&modes, linearized.mass()) < 1e-12);
}

#[test]
fn a_chain_between_walls_has_its_known_modes() {
    for (n, count) in [(1, 1), (2, 2), (7, 7), (50, 12), (1000, 20)] {
        check(&fixed_chain(n).unwrap(), count, &RigidMotions::none(), 0);
    }
}

#[test]
fn modes_of_multiplicity_two_are_found_twice() {
    check(&membrane(15).unwrap(), 20, &RigidMotions::none(), 0);
}

#[test]
fn all_modes_of_a_small_body_are_found() {
    check(&membrane(6).unwrap(), 36, &RigidMotions::none(), 0);
}

#[test]
fn a_free_chain_drifts_and_that_is_its_only_rigid_motion() {
    let problem = free_chain(40).unwrap();
    let positions: Vec<f64> = (0..40).map(f64::from).collect();
    let rigid = RigidMotions::of_points::<1>(&at_rest(&problem), positions.as_chunks().0).unwrap();
    assert_eq!(rigid.len(), 1);
    check(&problem, 10, &rigid, 1);
    // Asked for without being removed, it comes as a mode of frequency zero.
    let modes = at_rest(&problem).lowest(3, &RigidMotions::none()).unwrap();
    assert!(
        modes.values()[0].abs() < 1e-12 && (modes.values()[1] - problem.spectrum[1]).abs() < 1e-12
    );
}

/// A net of springs in D dimensions, its vertices in the first two.
fn framework<const D: usize>(rows: usize, columns: usize) -> (impl Potential, Vec<f64>) {
    let size = Net { rows, columns, spacing: 1.0, stiffness: 2.0, strain: Strain::Green };
    let mut springs = net(size).unwrap();
    // Apexes above the net make it a body in space.
    let vertices = rows * columns;
    let mut q: Vec<f64> = (0..vertices)
        .flat_map(|v| {
            let x = [(v % columns) as f64, (v / columns) as f64, 0.0];
            x.into_iter().take(D)
        })
        .collect();
    let mut free = vertices;
    if D == 3 {
        for (apex, height) in [2.0, -1.5, 1.0].into_iter().enumerate() {
            let x = [0.7 * apex as f64 + 0.4, 0.3 * apex as f64 + 0.2, height];
            for v in 0..free {
                let square: f64 = (0..3).map(|c| (x[c] - q[3 * v + c]).powi(2)).sum();
                springs.push(Spring::new([v, free], square.sqrt(), 1.0, Strain::Green).unwrap());
            }
            q.extend(x);
            free += 1;
        }
    }
    (stationary_calculus::Stencils::<_, 2, D>::new(free, Vec::new(), springs).unwrap(), q)
}

#[test]
fn a_free_body_has_three_rigid_motions_in_the_plane_and_six_in_space() {
    let (plane, q) = framework::<2>(4, 5);
    let metric = DiagonalMetric::new(vec![1.0; q.len()]).unwrap();
    let mut linearized = Linearized::at(&metric, &plane, &q, 1e-9).unwrap();
    let rigid = RigidMotions::of_points::<2>(&linearized, q.as_chunks().0).unwrap();
    assert_eq!((rigid.len(), linearized.kind(&rigid).unwrap()), (3, Kind::Stable));
    assert_eq!(linearized.kind(&RigidMotions::none()).unwrap(), Kind::Undecided { flat: Some(3) });

    let (space, q) = framework::<3>(3, 3);
    let metric = DiagonalMetric::new(vec![1.0; q.len()]).unwrap();
    let mut linearized = Linearized::at(&metric, &space, &q, 1e-9).unwrap();
    let rigid = RigidMotions::of_points::<3>(&linearized, q.as_chunks().0).unwrap();
    assert_eq!((rigid.len(), linearized.kind(&rigid).unwrap()), (6, Kind::Stable));
    let modes = linearized.lowest(4, &rigid).unwrap().with_rigid(&rigid).unwrap();
    assert_eq!(modes.len(), 10);
    assert!(orthogonality(&modes, linearized.mass()) < 1e-12);
}

#[test]
fn vertices_on_one_line_have_five_rigid_motions_in_space() {
    let springs = vec![Spring::new([0, 1], 1.0, 1.0, Strain::Green).unwrap()];
    let bar = stationary_calculus::Stencils::<_, 2, 3>::new(2, Vec::new(), springs).unwrap();
    let q = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    let metric = DiagonalMetric::new(vec![1.0; 6]).unwrap();
    let linearized = Linearized::at(&metric, &bar, &q, 1e-12).unwrap();
    assert_eq!(RigidMotions::of_points::<3>(&linearized, q.as_chunks().0).unwrap().len(), 5);
}

/// `1/2 (a x^2 + b y^2) + x^3`.
struct Surface([f64; 2]);

impl Potential for Surface {
    fn dim(&self) -> usize {
        2
    }

    fn energy(&self, q: &[f64]) -> f64 {
        0.5 * (self.0[0] * q[0] * q[0] + self.0[1] * q[1] * q[1]) + q[0].powi(3)
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        dv.0[0] += self.0[0] * q[0] + 3.0 * q[0] * q[0];
        dv.0[1] += self.0[1] * q[1];
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        hessian.add_symmetric(&[0], &[self.0[0] + 6.0 * q[0]]);
        hessian.add_symmetric(&[1], &[self.0[1]]);
    }
}

#[test]
fn equilibria_are_told_apart_by_their_second_derivatives() {
    let metric = DiagonalMetric::new(vec![1.0, 2.0]).unwrap();
    let kind = |curvatures| {
        let surface = Surface(curvatures);
        let mut linearized = Linearized::at(&metric, &surface, &[0.0, 0.0], 1e-12).unwrap();
        linearized.kind(&RigidMotions::none()).unwrap()
    };
    assert_eq!(kind([1.0, 3.0]), Kind::Stable);
    assert_eq!(kind([-1.0, 3.0]), Kind::Saddle { descents: 1 });
    assert_eq!(kind([-1.0, -3.0]), Kind::Maximum { descents: 2 });
    assert_eq!(kind([0.0, 3.0]), Kind::Undecided { flat: Some(1) });
}

#[test]
fn motion_in_closed_form_keeps_every_mode_s_energy_at_any_time() {
    let problem = membrane(5).unwrap();
    let mut linearized = at_rest(&problem);
    let modes = linearized.lowest(25, &RigidMotions::none()).unwrap();
    let d: Vec<f64> = (0..25).map(|i| (i as f64).sin()).collect();
    let v: Vec<f64> = (0..25).map(|i| (1.7 * i as f64).cos()).collect();
    let motion = Motion::new(&modes, linearized.mass(), Vector(&d[..]), Vector(&v[..])).unwrap();
    assert!(motion.left_out() < 1e-12);
    let (mut d1, mut v1) = (Vector(vec![0.0; 25]), Vector(vec![0.0; 25]));
    motion.at(0.0, d1.view_mut(), v1.view_mut()).unwrap();
    assert!(d1.0.iter().zip(&d).chain(v1.0.iter().zip(&v)).all(|(a, b)| (a - b).abs() < 1e-12));
    for t in [1.0, 1e6] {
        motion.at(t, d1.view_mut(), v1.view_mut()).unwrap();
        let total: f64 = (0..25).map(|i| motion.energy(i, t).unwrap()).sum();
        let kinetic: f64 = v1.0.iter().map(|v| 0.5 * v * v).sum();
        let energy = kinetic + problem.potential.energy(&d1.0);
        let start = 0.5 * v.iter().map(|v| v * v).sum::<f64>() + problem.potential.energy(&d);
        assert!((energy / start - 1.0).abs() < 1e-11 && (total / start - 1.0).abs() < 1e-11);
    }
    // It satisfies the equation of motion: M d'' = -H d, by a difference in time.
    let step = 1e-4;
    let at = |t: f64| {
        let (mut d, mut v) = (Vector(vec![0.0; 25]), Vector(vec![0.0; 25]));
        motion.at(t, d.view_mut(), v.view_mut()).unwrap();
        (d.0, v.0)
    };
    let (before, (here, _), after) = (at(3.0 - step), at(3.0), at(3.0 + step));
    let mut force = Covector(vec![0.0; 25]);
    problem.potential.add_differential(&here, force.view_mut());
    for i in 0..25 {
        let acceleration = (after.1[i] - before.1[i]) / (2.0 * step);
        assert!((acceleration + force.0[i]).abs() < 1e-6);
    }
}

#[test]
fn a_rigid_mode_drifts_in_proportion_to_time() {
    let problem = free_chain(4).unwrap();
    let mut linearized = at_rest(&problem);
    let rigid =
        RigidMotions::of_points::<1>(&linearized, &[0.0, 1.0, 2.0, 3.0].map(|x| [x])).unwrap();
    let modes = linearized.lowest(3, &rigid).unwrap().with_rigid(&rigid).unwrap();
    let push = [1.0, 0.0, 0.0, 0.0];
    let motion = Motion::new(&modes, linearized.mass(), Vector(&[0.0; 4]), Vector(&push)).unwrap();
    let (mut d, mut v) = (Vector(vec![0.0; 4]), Vector(vec![0.0; 4]));
    motion.at(1e9, d.view_mut(), v.view_mut()).unwrap();
    let middle = d.0.iter().sum::<f64>() / 4.0;
    assert!((middle / 0.25e9 - 1.0).abs() < 1e-12, "{middle}");
}

#[test]
fn damping_makes_a_mode_decay_at_its_rate() {
    let problem = fixed_chain(1).unwrap();
    let mut linearized = at_rest(&problem);
    let modes = linearized.lowest(1, &RigidMotions::none()).unwrap();
    let omega = modes.frequencies().next().unwrap();
    let start = Motion::new(&modes, linearized.mass(), Vector(&[1.0]), Vector(&[0.0])).unwrap();
    for zeta in [0.1, 1.0, 3.0] {
        let motion = start.clone().with_damping(&[zeta]).unwrap();
        let at = |t: f64| {
            let (mut d, mut v) = (Vector([0.0]), Vector([0.0]));
            motion.at(t, d.view_mut(), v.view_mut()).unwrap();
            (d.0[0], v.0[0])
        };
        let step = 1e-4;
        for t in [0.0, 0.3, 2.0] {
            let ((x, v), (x1, v1), (x0, v0)) = (at(t), at(t + step), at(t - step));
            assert!(((x1 - x0) / (2.0 * step) - v).abs() < 1e-7);
            let acceleration = (v1 - v0) / (2.0 * step);
            let residual = acceleration + 2.0 * zeta * omega * v + omega * omega * x;
            assert!(residual.abs() < 1e-5, "{zeta} {t} {residual:e}");
        }
    }
    let negative = start.with_damping(&[-0.1]);
    assert_eq!(negative, Err(ModalError::Parameter { what: "a damping ratio", value: -0.1 }));
}

#[test]
fn what_is_no_number_never_passes_through_a_motion() {
    let problem = fixed_chain(2).unwrap();
    let mut linearized = at_rest(&problem);
    let modes = linearized.lowest(1, &RigidMotions::none()).unwrap();
    let new = |d: [f64; 2], v: [f64; 2]| {
        Motion::new(&modes, linearized.mass(), Vector(&d[..]), Vector(&v[..]))
    };
    for bad in [f64::NAN, f64::INFINITY] {
        assert!(matches!(new([bad, 0.0], [0.0; 2]), Err(ModalError::Parameter { .. })));
        assert!(matches!(new([0.0; 2], [bad, 0.0]), Err(ModalError::Parameter { .. })));
    }
    let motion = new([1.0, 0.0], [0.0, 1.0]).unwrap();
    // One of two modes: half of each square is outside.
    assert!((motion.left_out().powi(2) - 0.5).abs() < 1e-15);
    assert!((motion.left_out_of_velocity().powi(2) - 0.5).abs() < 1e-15);
    let at = |motion: &Motion<'_>, t: f64| {
        let (mut d, mut v) = (Vector([0.0; 2]), Vector([0.0; 2]));
        motion.at(t, d.view_mut(), v.view_mut())
    };
    for bad in [f64::NAN, f64::INFINITY] {
        assert!(matches!(at(&motion, bad), Err(ModalError::Parameter { what: "the time", .. })));
        assert!(motion.energy(0, bad).is_err());
    }
    assert!(matches!(motion.energy(1, 0.0), Err(ModalError::Count { asked: 2, there: 1 })));
    // A turn of 1e15 radians has no phase, unless the mode has died away.
    assert!(matches!(at(&motion, 1e15), Err(ModalError::PhaseLost { mode: 0, .. })));
    assert_eq!(at(&motion.clone().with_damping(&[0.1]).unwrap(), 1e15), Ok(()));
    assert_eq!(at(&motion.with_damping(&[1e4]).unwrap(), 1e15), Ok(()));
}

#[test]
fn reduced_steps_of_any_size_end_at_the_same_place() {
    let problem = fixed_chain(30).unwrap();
    let modes = at_rest(&problem).lowest(6, &RigidMotions::none()).unwrap();
    let force: Vec<f64> = (0..30).map(|i| if i == 7 { 1.0 } else { 0.0 }).collect();
    let end = |steps: u32| {
        let mut body = Reduced::at_rest(&modes);
        for _ in 0..steps {
            body.step(100.0 / f64::from(steps), Covector(&force[..])).unwrap();
        }
        (body.alpha().to_vec(), body.energy())
    };
    let ((once, _), (often, _)) = (end(1), end(1000));
    for (a, b) in once.iter().zip(&often) {
        assert!((a - b).abs() < 1e-10, "{a} {b}");
    }
}

#[test]
fn a_far_reaching_load_needs_few_modes_and_a_point_load_many() {
    let problem = fixed_chain(99).unwrap();
    let mut linearized = at_rest(&problem);
    let modes = linearized.lowest(60, &RigidMotions::none()).unwrap();
    let observable: Vec<f64> = (0..99).map(|i| if i == 49 { 1.0 } else { 0.0 }).collect();
    let wide: Vec<f64> = vec![0.01; 99];
    let mut least = |load: &[f64], tolerance: f64| {
        let answer = linearized.answer(&modes, Covector(load), Covector(&observable[..])).unwrap();
        answer.least_modes(tolerance)
    };
    // A uniform load: 1/i^3, only odd modes. A point load: 1/i^2, so that its rest falls like 1/N.
    let (few, many) = (least(&wide, 1e-3).unwrap(), least(&observable, 1e-2).unwrap());
    assert!(few <= 9 && many >= 30, "{few} {many}");
    assert_eq!(least(&observable, 1e-6), None);
}

/// Masses in a row, each held to the one before it and the last and the first to walls, by springs of so
/// many N/m.
struct Row(Vec<f64>);

impl Potential for Row {
    fn dim(&self) -> usize {
        self.0.len() - 1
    }

    fn energy(&self, q: &[f64]) -> f64 {
        let mut dv = Covector(vec![0.0; q.len()]);
        self.add_differential(q, dv.view_mut());
        0.5 * dv.apply(&Vector(q))
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let at = |i: usize| if i == 0 || i > q.len() { 0.0 } else { q[i - 1] };
        for (i, k) in self.0.iter().enumerate() {
            let force = k * (at(i + 1) - at(i));
            if i > 0 {
                dv.0[i - 1] -= force;
            }
            if i < q.len() {
                dv.0[i] += force;
            }
        }
    }

    fn add_hessian(&self, _: &[f64], hessian: &mut impl Sink) {
        let freedom = |i: usize| if i == 0 || i == self.0.len() { FIXED } else { i - 1 };
        for (i, &k) in self.0.iter().enumerate() {
            hessian.add_symmetric(&[freedom(i), freedom(i + 1)], &[k, -k, -k, k]);
        }
    }
}

#[test]
fn the_bound_is_not_below_the_error_that_rounding_leaves() {
    for k in [1.0, 1e4, 1e8, 1e10] {
        let metric = DiagonalMetric::new(vec![1.0, 3.0]).unwrap();
        let row = Row(vec![1.0, k, 0.0]);
        let mut system = Linearized::at(&metric, &row, &[0.0; 2], 0.0).unwrap();
        let modes = system.lowest(2, &RigidMotions::none()).unwrap();
        let end = Covector(&[0.0, 1.0][..]);
        let answer = system.answer(&modes, end, end).unwrap();
        assert!((answer.whole - (1.0 + 1.0 / k)).abs() < 1e-15, "{k}: {}", answer.whole);
        assert!(answer.whole_off < 1e-14, "{k}: {}", answer.whole_off);
        for (error, bound) in answer.errors.iter().zip(&answer.bounds) {
            assert!(error <= bound && *bound <= 2.0 + 1e-13, "{k}: {answer:?}");
        }
        assert!(answer.bounds[2] < 1e-14 * k.max(10.0), "{k}: {answer:?}");
        // With one mode, or both, no more can be promised than lambda has digits.
        assert_eq!(answer.least_modes_in_motion(1e-9).is_some(), k < 1e5);
        // What the second mode adds is 1/16 k of the answer, for stiff springs.
        assert!(k < 1e4 || answer.bounds[1] > 1.2e-1 / k, "{k}: {answer:?}");
    }
}

#[test]
fn the_bound_holds_for_rows_of_springs_of_very_different_strengths() {
    let mut random = stationary_measure::SplitMix64::new(3);
    let n = 60;
    for spread in [0.0, 3.0, 6.0] {
        for _ in 0..4 {
            let mut springs = vec![1.0];
            springs.extend((0..n).map(|_| 10_f64.powf(spread * random.symmetric())));
            let mass = (0..n).map(|_| 10_f64.powf(0.5 * random.symmetric())).collect();
            let metric = DiagonalMetric::<Vec<f64>>::new(mass).unwrap();
            let row = Row(springs);
            let mut system = Linearized::at(&metric, &row, &vec![0.0; n], 1e-9).unwrap();
            let modes = system.lowest(n, &RigidMotions::none()).unwrap();
            let mut drawn = || Covector((0..n).map(|_| random.symmetric()).collect::<Vec<f64>>());
            let (load, observable) = (drawn(), drawn());
            let answer = system.answer(&modes, load.view(), observable.view()).unwrap();
            let at = |i: usize, c: &Covector<Vec<f64>>| c.apply(&modes.vector(i).unwrap());
            for step in 0..100 {
                let t = 0.37 * f64::from(step);
                let mut left = 0.0;
                for (i, lambda) in modes.values().iter().enumerate().rev() {
                    let turned = 1.0 - (lambda.sqrt() * t).cos();
                    left += at(i, &load) * at(i, &observable) * turned / lambda;
                    assert!((left / answer.whole).abs() <= answer.bounds[i], "{spread} {i} {t}");
                }
            }
            for (error, bound) in answer.errors.iter().zip(&answer.bounds).skip(1) {
                assert!(error <= bound, "{spread}: {error:e} {bound:e}");
            }
            assert!(answer.bounds[n] < 1e-10 * 10_f64.powf(1.5 * spread), "{:e}", answer.bounds[n]);
        }
    }
}

#[test]
fn bad_input_is_a_typed_error() {
    let problem = fixed_chain(5).unwrap();
    let linearized = || at_rest(&problem);
    let none = RigidMotions::none();
    for asked in [0, 6] {
        assert_eq!(linearized().lowest(asked, &none), Err(ModalError::Count { asked, there: 5 }));
    }
    let off = Linearized::at(&problem.metric, &problem.potential, &[0.0, 0.0, 1.0, 0.0, 0.0], 1e-9);
    assert!(matches!(off, Err(ModalError::NoEquilibrium { freedom: 2, .. })), "{off:?}");
    let nan = Linearized::at(&problem.metric, &problem.potential, &[f64::NAN; 5], 1e-9);
    assert!(matches!(nan, Err(ModalError::NoEquilibrium { .. })));
    assert!(matches!(
        Linearized::at(&problem.metric, &problem.potential, &[0.0; 4], 1e-9),
        Err(ModalError::Size(_))
    ));
    let modes = linearized().lowest(2, &none).unwrap();
    assert!(modes.orthogonality(at_rest(&free_chain(4).unwrap()).mass()).is_err());
    let mut body = Reduced::at_rest(&modes);
    let before = body.clone();
    assert!(body.step(-1.0, Covector(&[0.0; 5])).is_err());
    assert!(body.step(1.0, Covector(&[f64::NAN; 5])).is_err());
    assert!(body.step(1.0, Covector(&[0.0; 4])).is_err());
    assert_eq!(body, before);
    // On an eigenvalue there is no count.
    let free = free_chain(5).unwrap();
    let count = at_rest(&free).count_below(0.0);
    assert_eq!(count, Err(ModalError::Sparse(SparseError::Singular)));
    // A body that is not held has no static answer.
    let modes = at_rest(&free).lowest(2, &none).unwrap();
    let load = [1.0; 5];
    let answer = at_rest(&free).answer(&modes, Covector(&load), Covector(&load));
    assert!(matches!(answer, Err(ModalError::Parameter { value: 0.0, .. })), "{answer:?}");
    let rigid = RigidMotions::of_points(&at_rest(&free), &[0.0, 1.0, 2.0, 3.0, 4.0].map(|x| [x]));
    let elastic = at_rest(&free).lowest(2, &rigid.unwrap()).unwrap();
    let answer = at_rest(&free).answer(&elastic, Covector(&load), Covector(&load));
    assert!(matches!(answer, Err(ModalError::Stiffness(_))), "{answer:?}");
    // Loads and observables that are no numbers, or have no answer to be relative to.
    let modes = linearized().lowest(2, &none).unwrap();
    for (load, observable) in
        [([f64::NAN; 5], [1.0; 5]), ([1.0; 5], [f64::NAN; 5]), ([0.0; 5], load)]
    {
        let answer = linearized().answer(&modes, Covector(&load), Covector(&observable));
        assert!(matches!(answer, Err(ModalError::Parameter { .. })), "{answer:?}");
    }
}

proptest! {
    #[test]
    fn counts_agree_with_the_spectrum_everywhere(n in 1_usize..60, mu in 0.001_f64..4.5) {
        let problem = fixed_chain(n).unwrap();
        let exact = problem.spectrum.iter().filter(|lambda| **lambda < mu).count();
        let close = problem.spectrum.iter().any(|lambda| (lambda - mu).abs() < 1e-9);
        prop_assume!(!close);
        prop_assert_eq!(at_rest(&problem).count_below(mu), Ok(exact));
    }
}
