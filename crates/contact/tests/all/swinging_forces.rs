//! Steps chosen by error under forces that swing: what their means hide is not stepped over.

use nalgebra::Vector2;
use stationary_calculus::{Covector, DiagonalMetric, Force, System, Vector};
use stationary_contact::{
    ErrorControlled, PlanarCollider, PlanarDetector, PlanarShape, PlanarWorld, StepForces,
};
use stationary_integrators::State;
use stationary_measure::SplitMix64;
use stationary_rigid::{LieGroup, PlanarMotion, PlanarWeight};

const G: f64 = 10.0;

/// A pull of `size sin(omega t)` along a freedom of a body of 1 kg, N.
#[derive(Clone, Copy)]
struct Pull {
    freedom: usize,
    size: f64,
    omega: f64,
    /// Over the step.
    mean: f64,
    h: f64,
}

impl Pull {
    fn at(&self, t: f64) -> f64 {
        self.size * (self.omega * t).sin()
    }
}

impl Force for Pull {
    fn dim(&self) -> usize {
        3
    }

    fn add_force(&self, _: f64, _: &[f64], _: Vector<&[f64]>, f: Covector<&mut [f64]>) {
        f.0[self.freedom] += self.mean;
    }
}

impl StepForces for Pull {
    fn prepare(&mut self, state: &mut State<Vec<f64>>, h: f64) {
        let [before, after] = [state.t, state.t + h].map(|t| (self.omega * t).cos());
        (self.mean, self.h) = (self.size * (before - after) / (self.omega * h), h);
    }

    fn add_works(&self, _: [&State<Vec<f64>>; 2], _: Vector<&[f64]>, _: &mut [f64]) {}

    fn add_swings(&self, start: &State<Vec<f64>>, swings: &mut [f64]) {
        // No more than the slope allows, and no more than from trough to crest.
        let slope = self.size * self.omega * self.h;
        let ends = [start.t, start.t + self.h].map(|t| (self.at(t) - self.mean).abs());
        swings[self.freedom] += slope.min(2.0 * self.size).max(ends[0]).max(ends[1]);
    }

    fn next_corner(&self, _: f64) -> Option<f64> {
        None
    }
}

/// The largest error of a place along the way, where a step of the referee leads from place and velocity to the next.
fn worst(pull: Pull, friction: f64, accuracy: f64, step: impl Fn(&mut [f64; 2], f64, f64)) -> f64 {
    let floor = PlanarShape::half_plane(Vector2::y()).unwrap();
    let colliders = vec![
        PlanarCollider::on_body(0, PlanarShape::cuboid([0.5, 0.05]).unwrap())
            .with_friction(friction),
        PlanarCollider::fixed(PlanarMotion::identity(), floor).with_friction(friction),
    ];
    let system = System::new(
        DiagonalMetric::new(vec![1.0, 1.0, 0.1]).unwrap(),
        PlanarWeight { gravity: Vector2::y() * -G, masses: vec![1.0] },
    )
    .unwrap();
    let world = PlanarWorld::new(system, PlanarDetector::new(colliders, 1).unwrap()).unwrap();
    let mut chosen = ErrorControlled::new(world, accuracy).unwrap();
    let mut state = State::new(vec![0.0, 0.05, 0.0], Covector(vec![0.0; 3]));
    let rest = state.q[pull.freedom];
    let (mut pulling, mut referee, mut worst) = (pull, [0.0; 2], 0.0_f64);
    for tenth in 1..=20 {
        chosen.advance_under(&mut state, 0.1, &mut pulling).unwrap();
        let h = 1e-6;
        for k in 0..100_000 {
            let t = 0.1 * f64::from(tenth - 1) + h * (f64::from(k) + 0.5);
            step(&mut referee, pull.at(t), h);
        }
        worst = worst.max((state.q[pull.freedom] - rest - referee[0]).abs());
    }
    worst
}

#[test]
fn a_pull_beyond_friction_for_a_part_of_a_step_moves_what_sticks() {
    let mut random = SplitMix64::new(3);
    let mut slipped = 0;
    for case in 0..12 {
        let mut draw = |a: f64, b: f64| a + 0.5 * (b - a) * (1.0 + random.symmetric());
        let friction = draw(0.2, 0.5);
        // Just enough to slip, or twice as much.
        let size = friction * G * draw(0.9, if case % 2 == 0 { 1.2 } else { 2.0 });
        let pull = Pull { freedom: 0, size, omega: draw(3.0, 40.0), mean: 0.0, h: 0.0 };
        let slide = |x: &mut [f64; 2], force: f64, h: f64| {
            let free = x[1] + h * force;
            x[1] = free.signum() * (free.abs() - h * friction * G).max(0.0);
            x[0] += h * x[1];
        };
        for accuracy in [1e-3, 1e-5] {
            let worst = worst(pull, friction, accuracy, slide);
            assert!(worst < accuracy, "{size} {} {friction} {accuracy}: {worst:e}", pull.omega);
        }
        slipped += usize::from(size > friction * G);
    }
    assert!(slipped > 6, "{slipped}");
}

#[test]
fn a_lift_beyond_the_weight_for_a_part_of_a_step_raises_what_rests() {
    for (size, omega) in [(10.2, 6.0), (11.0, 31.0), (15.0, 4.0), (30.0, 50.0), (9.9, 20.0)] {
        let pull = Pull { freedom: 1, size, omega, mean: 0.0, h: 0.0 };
        let hop = |y: &mut [f64; 2], force: f64, h: f64| {
            y[1] += h * (force - G);
            y[0] += h * y[1];
            if y[0] <= 0.0 {
                *y = [0.0, y[1].max(0.0)];
            }
        };
        for accuracy in [1e-3, 1e-5] {
            let worst = worst(pull, 0.3, accuracy, hop);
            assert!(worst < accuracy, "{size} {omega} {accuracy}: {worst:e}");
        }
    }
}

/// A table that is shaken: its speed is `size sin(omega t)`, m/s.
#[derive(Clone, Copy)]
struct Shaking {
    size: f64,
    omega: f64,
    h: f64,
}

impl Shaking {
    fn place(&self, t: f64) -> f64 {
        self.size / self.omega * (1.0 - (self.omega * t).cos())
    }
}

impl Force for Shaking {
    fn dim(&self) -> usize {
        6
    }

    fn add_force(&self, _: f64, _: &[f64], _: Vector<&[f64]>, _: Covector<&mut [f64]>) {}
}

impl StepForces for Shaking {
    fn prepare(&mut self, state: &mut State<Vec<f64>>, h: f64) {
        let [from, to] = [state.t, state.t + h].map(|t| self.place(t));
        state.q[3] = from;
        state.p.0[3] = (to - from) / h;
        self.h = h;
    }

    fn add_works(&self, _: [&State<Vec<f64>>; 2], _: Vector<&[f64]>, _: &mut [f64]) {}

    fn add_swings(&self, _: &State<Vec<f64>>, swings: &mut [f64]) {
        // The acceleration changes no faster than this.
        swings[3] += self.size * self.omega.powi(2) * self.h;
    }

    fn next_corner(&self, _: f64) -> Option<f64> {
        None
    }
}

#[test]
fn a_table_that_is_shaken_beyond_friction_for_a_part_of_a_step_slips_beneath_what_it_carries() {
    let mut random = SplitMix64::new(5);
    for case in 0..12 {
        let mut draw = |a: f64, b: f64| a + 0.5 * (b - a) * (1.0 + random.symmetric());
        let (friction, omega) = (draw(0.2, 0.5), draw(3.0, 40.0));
        let size = friction * G * draw(0.9, if case % 2 == 0 { 1.2 } else { 3.0 }) / omega;
        for accuracy in [1e-3, 1e-5] {
            let mut shaking = Shaking { size, omega, h: 0.0 };
            let colliders = vec![
                PlanarCollider::on_body(0, PlanarShape::cuboid([0.5, 0.05]).unwrap())
                    .with_friction(friction),
                PlanarCollider::on_body(1, PlanarShape::cuboid([9.0, 1.0]).unwrap())
                    .with_friction(friction),
            ];
            let masses = vec![1.0, 1.0, 0.1, 1.0, 1.0, 1.0];
            let system = System::new(
                DiagonalMetric::new(masses).unwrap(),
                PlanarWeight { gravity: Vector2::y() * -G, masses: vec![1.0; 2] },
            )
            .unwrap();
            let detector = PlanarDetector::new(colliders, 2).unwrap();
            let world = PlanarWorld::new(system, detector).unwrap();
            let world = world.with_obstacles(vec![1]).unwrap();
            let mut chosen = ErrorControlled::new(world, accuracy).unwrap();
            let mut state =
                State::new(vec![0.0, 0.05, 0.0, 0.0, -1.0, 0.0], Covector(vec![0.0; 6]));
            let (mut x, mut worst) = ([0.0; 2], 0.0_f64);
            for tenth in 1..=20 {
                chosen.advance_under(&mut state, 0.1, &mut shaking).unwrap();
                let h = 1e-6;
                for k in 0..100_000 {
                    let t = 0.1 * f64::from(tenth - 1) + h * f64::from(k + 1);
                    let slip = size * (omega * t).sin() - x[1];
                    x[1] += slip.signum() * slip.abs().min(h * friction * G);
                    x[0] += h * x[1];
                }
                worst = worst.max((state.q[0] - x[0]).abs());
            }
            assert!(worst < accuracy, "{friction} {omega} {size} {accuracy}: {worst:e}");
        }
    }
}
