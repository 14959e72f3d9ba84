//! The velocity filter where a step is longer than the way between two walls.

use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_contact::{Balls, FixedBall, ImpactLaw, Impacting, Inequality, Wall, When};
use stationary_integrators::{State, UniformGravity};

const LAWS: [ImpactLaw; 3] =
    [ImpactLaw::GaussSeidel, ImpactLaw::Blended, ImpactLaw::GeneralizedReflections];

/// A ball of 1 kg and radius 0.1 m, 0.2 m above a floor and beneath something, 0.5 m apart, at 8 m/s upwards.
fn after(
    gaps: Balls<2>,
    (restitution, law, when): (f64, ImpactLaw, When),
    steps: usize,
) -> State<Vec<f64>> {
    let gravity = UniformGravity { masses: vec![1.0], acceleration: [0.0, 0.0] };
    let metric = DiagonalMetric::new(vec![1.0; 2]).unwrap();
    let system = System::new(metric, gravity).unwrap();
    let gaps = Inequality(gaps);
    let mut method = Impacting::new(&system, &gaps, restitution, law, when).unwrap();
    let mut state = State::new(vec![0.0, 0.2], Covector(vec![0.0, 8.0]));
    for _ in 0..steps {
        method.step(&mut state, 1.0 / 16.0).unwrap();
        assert!(gaps.gaps(state.t, &state.q).iter().all(|gap| *gap >= -1e-12));
    }
    state
}

fn floor() -> Wall<2> {
    Wall { normal: [0.0, 1.0], offset: 0.0 }
}

#[test]
fn an_elastic_ball_between_a_floor_and_a_ceiling_or_a_fixed_ball_keeps_its_speed() {
    let ceiling = Wall { normal: [0.0, -1.0], offset: -0.5 };
    let above = FixedBall { centre: [0.0, 0.75], radius: 0.25 };
    for law in LAWS {
        let how = (1.0, law, When::VelocityFilter);
        let walls = Balls::new(vec![0.1], vec![floor(), ceiling]).unwrap();
        let ball = Balls::new(vec![0.1], vec![floor()]).unwrap().with_fixed(vec![above]).unwrap();
        for gaps in [walls, ball] {
            let state = after(gaps, how, 8);
            assert!((state.p.0[1].abs() - 8.0).abs() < 1e-12, "{law:?}: {:?}", state.p);
        }
    }
}

#[test]
fn a_ball_that_bounces_to_and_fro_in_a_step_loses_what_its_bounces_cost_and_no_more() {
    let ceiling = Wall { normal: [0.0, -1.0], offset: -0.5 };
    for law in LAWS {
        let bounces = |when| {
            let walls = Balls::new(vec![0.1], vec![floor(), ceiling]).unwrap();
            let speed = after(walls, (0.9, law, when), 4).p.0[1].abs();
            (speed / 8.0).ln() / 0.9_f64.ln()
        };
        let (filtered, exact) = (bounces(When::VelocityFilter), bounces(When::AtTheInstant));
        assert!((filtered - filtered.round()).abs() < 1e-9, "{law:?}: {filtered} bounces");
        assert!((filtered - exact).abs() < 2.5, "{law:?}: {filtered} bounces for {exact}");
    }
}
