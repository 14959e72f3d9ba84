//! The impact laws on impacts with known answers (notes 11.5, errata 11.5.1).

use stationary_calculus::Vector;
use stationary_contact::problems::{
    ImpactProblem, ball_in_corner, bernoulli_wedge, box_on_plane, landing_pile, listed_twice,
    newtons_cradle, nine_ball_break, three_balls,
};
use stationary_contact::{ContactError, ImpactLaw, project};
use stationary_measure::SplitMix64;

fn after(law: ImpactLaw, problem: &ImpactProblem) -> Vec<f64> {
    let mut v = Vector(problem.velocity.clone());
    law.apply(&problem.impact().unwrap(), v.view_mut()).unwrap();
    v.0
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn as_many_balls_leave_newtons_cradle_as_arrive_by_the_laws_that_let_contacts_break_away() {
    for moving in 1..=3 {
        let cradle = newtons_cradle(5, moving);
        let expected: Vec<f64> =
            (0..5).map(|ball| if ball >= 5 - moving { 1.0 } else { 0.0 }).collect();
        for &law in ImpactLaw::ALL {
            let right = distance(&after(law, &cradle), &expected) < 1e-13;
            assert_eq!(right, law.facts().breaks_away, "{} with {moving}", law.facts().name);
        }
    }
}

#[test]
fn three_balls_swap_their_ends_by_reflections_and_stop_by_jacobi() {
    for law in [ImpactLaw::GeneralizedReflections, ImpactLaw::Blended, ImpactLaw::GaussSeidel] {
        assert!(distance(&after(law, &three_balls()), &[-1.0, 0.0, 1.0]) < 1e-14);
    }
    assert_eq!(after(ImpactLaw::Jacobi, &three_balls()), [0.0; 3]);
}

#[test]
fn a_wall_that_is_listed_twice_counts_once_except_by_jacobi() {
    for &law in ImpactLaw::ALL {
        let expected = match law {
            ImpactLaw::Jacobi => 3.0,
            ImpactLaw::Inelastic => 0.0,
            _ => 1.0,
        };
        assert!((after(law, &listed_twice())[0] - expected).abs() < 1e-15, "{law:?}");
    }
}

/// For normals that lean by the angle a from the vertical, the falling ball of unit mass gets
/// -2 lambda cos a along its fall and each other ball lambda; energy fixes lambda.
#[test]
fn the_bernoulli_wedge_obeys_its_closed_form() {
    for angle in [std::f64::consts::FRAC_PI_6, 0.7, 1.2] {
        let (s, c) = angle.sin_cos();
        let lambda = 2.0 * c / (2.0 * c * c + 1.0);
        let expected =
            [0.0, 2.0 * lambda * c - 1.0, -lambda * s, -lambda * c, lambda * s, -lambda * c];
        let got = after(ImpactLaw::GeneralizedReflections, &bernoulli_wedge(angle));
        assert!(distance(&got, &expected) < 1e-14, "{got:?} {expected:?}");
    }
}

#[test]
fn reflections_keep_energy_and_momentum_to_1e_minus_12_and_symmetry_in_every_impact() {
    let mut problems = vec![three_balls(), nine_ball_break()];
    problems.extend((1..=3).map(|moving| newtons_cradle(5, moving)));
    problems.extend([0.6, 0.9, 1.3].map(bernoulli_wedge));
    problems.extend([ball_in_corner().with_restitution(1.0), listed_twice()]);
    problems.push(landing_pile(4).with_restitution(1.0));
    for problem in problems {
        let v = after(ImpactLaw::GeneralizedReflections, &problem);
        let energy = problem.kinetic_energy(&problem.velocity);
        assert!((problem.kinetic_energy(&v) / energy - 1.0).abs() < 1e-12, "{}", problem.name);
        let before = problem.total_momentum(&problem.velocity);
        assert!(distance(&problem.total_momentum(&v), &before) < 1e-12, "{}", problem.name);
        if problem.asymmetry(&problem.velocity) == 0.0 {
            assert!(problem.asymmetry(&v) < 1e-12, "{}: {}", problem.name, problem.asymmetry(&v));
        }
    }
}

#[test]
fn a_pile_that_lands_is_stopped_at_once_and_stays_symmetric() {
    for base in 2..6 {
        let pile = landing_pile(base);
        let v = after(ImpactLaw::Inelastic, &pile);
        assert_eq!((pile.asymmetry(&pile.velocity), pile.velocity.len()), (0.0, base * (base + 1)));
        assert!(pile.asymmetry(&v) < 1e-13 && distance(&v, &pile.velocity) > 0.5);
        assert!(pile.impact().unwrap().approach(Vector(&v)) < 1e-13);
    }
}

#[test]
fn each_law_keeps_what_its_facts_say_on_the_nine_ball_break() {
    let problem = nine_ball_break();
    let energy = problem.kinetic_energy(&problem.velocity);
    let contacts = problem.rows.len();
    let reversed: Vec<usize> = (0..contacts).rev().collect();
    for &law in ImpactLaw::ALL {
        let (facts, v) = (law.facts(), after(law, &problem));
        let change = problem.kinetic_energy(&v) / energy - 1.0;
        assert_eq!(change.abs() < 1e-12, facts.keeps_energy, "{}: {change}", facts.name);
        assert_eq!(problem.asymmetry(&v) < 1e-12, facts.symmetric, "{}", facts.name);
        let mut other = Vector(problem.velocity.clone());
        law.apply(&problem.impact_in_order(&reversed).unwrap(), other.view_mut()).unwrap();
        assert_eq!(distance(&other.0, &v) < 1e-12, facts.order_free, "{}", facts.name);
    }
}

#[test]
fn energy_never_grows_by_the_laws_that_say_so_whatever_the_restitutions() {
    let mut random = SplitMix64::new(3);
    let mut gained = [false; 5];
    for _ in 0..300 {
        let mut problem = nine_ball_break();
        problem.velocity.iter_mut().for_each(|v| *v = random.symmetric());
        problem.restitution.iter_mut().for_each(|c| *c = random.symmetric().abs());
        problem.masses.chunks_mut(2).for_each(|m| m.fill(1.0 + random.symmetric().abs() * 9.0));
        let impact = problem.impact().unwrap();
        let energy = problem.kinetic_energy(&problem.velocity);
        for (&law, gained) in ImpactLaw::ALL.iter().zip(&mut gained) {
            let mut v = Vector(problem.velocity.clone());
            match law.apply(&impact, v.view_mut()) {
                Ok(_) => *gained |= problem.kinetic_energy(&v.0) > energy * (1.0 + 1e-12),
                Err(error) => assert!(law == ImpactLaw::Jacobi, "{law:?}: {error}"),
            }
        }
    }
    for (law, gained) in ImpactLaw::ALL.iter().zip(gained) {
        assert!(!(gained && law.facts().energy_never_grows), "{law:?} gains energy");
    }
    assert!(gained[1], "Jacobi's gains are seen");
}

#[test]
fn a_ball_in_a_corner_turns_each_component_back_by_its_walls_restitution() {
    for c in [0.0, 0.3, 0.8, 1.0] {
        let mut problem = ball_in_corner();
        problem.restitution = vec![c, 0.5 * c];
        for law in [ImpactLaw::GaussSeidel, ImpactLaw::Jacobi, ImpactLaw::GeneralizedReflections] {
            let v = after(law, &problem);
            assert!(distance(&v, &[c, c]) < 1e-15, "{law:?} {v:?}");
        }
    }
}

#[test]
fn a_box_on_a_hundred_points_stops_with_a_kkt_residual_below_1e_minus_10() {
    let problem = box_on_plane();
    let mut v = Vector(problem.velocity.clone());
    let done = project(&problem.impact().unwrap(), v.view_mut()).unwrap();
    assert!(done.residual < 1e-10, "{}", done.residual);
    assert!(done.impulses.iter().all(|&lambda| lambda >= 0.0));
    let total: f64 = done.impulses.iter().sum();
    assert!((total - 1.0).abs() < 1e-12, "the whole momentum of the fall: {total}");
    assert!(distance(&v.0, &[0.1, 0.0, 0.0, 0.0, 0.0, 0.05]) < 1e-13, "{:?}", v.0);
}

#[test]
fn the_projection_is_closer_than_any_other_velocity_that_no_contact_forbids() {
    let mut random = SplitMix64::new(9);
    for _ in 0..200 {
        let mut problem = nine_ball_break();
        problem.velocity.iter_mut().for_each(|v| *v = random.symmetric());
        problem.masses.iter_mut().for_each(|m| *m = 1.5 + random.symmetric());
        let impact = problem.impact().unwrap();
        let mut v = Vector(problem.velocity.clone());
        let done = project(&impact, v.view_mut()).unwrap();
        assert!(done.residual < 1e-13, "{}", done.residual);
        let cost = |w: &[f64]| {
            let off: Vec<f64> = w.iter().zip(&problem.velocity).map(|(a, b)| a - b).collect();
            problem.kinetic_energy(&off)
        };
        let kick: Vec<f64> = (0..v.0.len()).map(|_| 1e-3 * random.symmetric()).collect();
        let mut other = Vector(v.0.iter().zip(&kick).map(|(v, k)| v + k).collect::<Vec<_>>());
        project(&impact, other.view_mut()).unwrap();
        assert!(cost(&other.0) >= cost(&v.0));
    }
}

#[test]
fn an_impact_that_hits_its_bound_carries_its_residual_and_leaves_the_velocity() {
    let cradle = newtons_cradle(5, 1);
    let mut v = Vector(cradle.velocity.clone());
    let law = ImpactLaw::GeneralizedReflections;
    let error = law.apply_within(&cradle.impact().unwrap(), 2, v.view_mut()).unwrap_err();
    let ContactError::NotConverged { iterations: 2, residual, velocity, .. } = error else {
        panic!("{error}");
    };
    assert!((residual - 1.0).abs() < 1e-15);
    assert!(distance(&velocity, &[0.0, 0.0, 1.0, 0.0, 0.0]) < 1e-15);
    assert_eq!(v.0, cradle.velocity);
    v.0[3] = f64::NAN;
    assert!(law.apply(&cradle.impact().unwrap(), v.view_mut()).is_err());
}

#[test]
fn a_mass_that_is_none_is_named_and_no_balls_meet() {
    let mut cradle = newtons_cradle(3, 1);
    cradle.masses[1] = -1.0;
    assert_eq!(cradle.impact().unwrap_err(), ContactError::Mass { freedom: 1 });
    for (balls, moving) in [(0, 0), (1, 1)] {
        assert!(newtons_cradle(balls, moving).impact().unwrap().is_empty());
    }
}
