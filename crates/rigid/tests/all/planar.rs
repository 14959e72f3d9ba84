//! Bodies in the plane: their metric is flat, so the methods of flat space move them (7.4).

use nalgebra::Vector2;
use stationary_calculus::{Automatic, Covector, Energy, Number, System};
use stationary_integrators::{Integrator, State, StormerVerlet, SymplecticEulerDriftKick};
use stationary_mesh::Polygon;
use stationary_rigid::PlanarMass;

/// A spring from the origin to the body's point c: `k/2 |t + R(theta) c|^2`.
struct Tether {
    stiffness: f64,
    point: [f64; 2],
}

impl Energy<3> for Tether {
    fn energy<R: Number>(&self, [x, y, theta]: [R; 3]) -> R {
        let (s, c) = (theta.sin(), theta.cos());
        let [a, b] = self.point;
        let (x, y) = (x + c * a - s * b, y + s * a + c * b);
        (x * x + y * y) * (0.5 * self.stiffness)
    }
}

#[test]
fn a_planar_body_on_a_spring_keeps_its_angular_momentum_with_the_update_of_7_4() {
    let l = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 4.0], [0.0, 4.0]];
    let l: Vec<Vector2<f64>> = l.iter().map(|&p| p.into()).collect();
    let mass = PlanarMass::of(0.3, &Polygon::new(vec![l]).unwrap().moments()).unwrap();
    let corner = -mass.centre;
    let potential = Automatic(Tether { stiffness: 4.0, point: [corner.x, corner.y] });
    let system = System::new(mass.metric().unwrap(), potential).unwrap();
    let start = State::new([1.0, -0.5, 0.3], Covector([0.2, 0.9, -1.5]));
    let angular = |s: &State<[f64; 3]>| s.q[0] * s.p.0[1] - s.q[1] * s.p.0[0] + s.p.0[2];
    let mut first = SymplecticEulerDriftKick::new(&system).unwrap();
    let mut second = StormerVerlet::new(&system).unwrap();
    let integrators: [&mut dyn Integrator<[f64; 3]>; 2] = [&mut first, &mut second];
    for (integrator, order) in integrators.into_iter().zip([1.0, 2.0]) {
        let mut worst = |h: f64, steps: usize| {
            let (mut state, mut worst) = (start.clone(), 0.0_f64);
            let energy = system.energy(&state.q, state.p.view());
            for _ in 0..steps {
                integrator.step(&mut state, h).unwrap();
                assert!((angular(&state) - angular(&start)).abs() < 1e-12);
                worst = worst.max((system.energy(&state.q, state.p.view()) - energy).abs());
            }
            worst
        };
        let measured = (worst(2e-3, 10_000) / worst(1e-3, 20_000)).log2();
        assert!((measured - order).abs() < 0.1, "{measured}");
    }
}
