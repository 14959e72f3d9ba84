//! Impacts at the instant do not depend on where a scene is, which way it is turned, or in which units it is given.

use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_contact::{Balls, FixedBall, ImpactLaw, Impacting, Inequality, Wall, When};
use stationary_integrators::{State, UniformGravity};

/// Balls above a floor, pushed about for a while.
#[derive(Clone)]
struct Scene<const D: usize> {
    masses: Vec<f64>,
    radii: Vec<f64>,
    walls: Vec<Wall<D>>,
    fixed: Vec<FixedBall<D>>,
    gravity: [f64; D],
    q: Vec<f64>,
    v: Vec<f64>,
    restitution: f64,
    h: f64,
    steps: usize,
}

impl<const D: usize> Scene<D> {
    fn new(masses: &[f64], radii: &[f64], q: &[f64], v: &[f64], restitution: f64) -> Self {
        let [masses, radii, q, v] = [masses, radii, q, v].map(<[f64]>::to_vec);
        let (walls, fixed, gravity, h, steps) = (vec![], vec![], [0.0; D], 1.0 / 64.0, 32);
        Scene { masses, radii, walls, fixed, gravity, q, v, restitution, h, steps }
    }

    fn floor(mut self) -> Self {
        let mut normal = [0.0; D];
        normal[D - 1] = 1.0;
        self.walls.push(Wall { normal, offset: 0.0 });
        self
    }

    fn gravity(mut self, g: f64) -> Self {
        self.gravity[D - 1] = -g;
        self
    }

    fn fixed(mut self, centre: [f64; D], radius: f64) -> Self {
        self.fixed.push(FixedBall { centre, radius });
        self
    }

    fn scaled(mut self, length: f64, time: f64) -> Self {
        self.radii.iter_mut().chain(&mut self.q).for_each(|x| *x *= length);
        self.walls.iter_mut().for_each(|wall| wall.offset *= length);
        for ball in &mut self.fixed {
            ball.radius *= length;
            ball.centre = ball.centre.map(|x| length * x);
        }
        self.v.iter_mut().for_each(|v| *v *= length / time);
        self.gravity = self.gravity.map(|g| g * length / (time * time));
        Scene { h: self.h * time, ..self }
    }

    fn shifted(mut self, by: f64) -> Self {
        self.q.iter_mut().for_each(|x| *x += by);
        self.walls.iter_mut().for_each(|wall| wall.offset += by * wall.normal.iter().sum::<f64>());
        self.fixed.iter_mut().for_each(|ball| ball.centre = ball.centre.map(|x| x + by));
        self
    }

    /// Places and velocities at the end.
    fn run(&self) -> (Vec<f64>, Vec<f64>) {
        let masses: Vec<f64> = self.masses.iter().flat_map(|&m| [m; D]).collect();
        let gravity = UniformGravity { masses: self.masses.clone(), acceleration: self.gravity };
        let system = System::new(DiagonalMetric::new(masses.clone()).unwrap(), gravity).unwrap();
        let balls = Balls::new(self.radii.clone(), self.walls.clone()).unwrap();
        let gaps = Inequality(balls.with_fixed(self.fixed.clone()).unwrap());
        let (law, when) = (ImpactLaw::GeneralizedReflections, When::AtTheInstant);
        let mut method = Impacting::new(&system, &gaps, self.restitution, law, when).unwrap();
        let p = self.v.iter().zip(&masses).map(|(v, m)| v * m).collect();
        let mut state = State::new(self.q.clone(), Covector(p));
        for _ in 0..self.steps {
            method.step(&mut state, self.h).unwrap();
        }
        (state.q, state.p.0.iter().zip(&masses).map(|(p, m)| p / m).collect())
    }
}

fn far(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn turned(x: [f64; 2]) -> [f64; 2] {
    let (s, c) = 0.001_f64.sin_cos();
    [c * x[0] - s * x[1], s * x[0] + c * x[1]]
}

fn all_turned(x: &[f64]) -> Vec<f64> {
    x.chunks(2).flat_map(|x| turned([x[0], x[1]])).collect()
}

fn pile() -> Scene<1> {
    let (m, r) = ([1.0, 3.0, 2.0], [0.125, 0.25, 0.125]);
    Scene::new(&m, &r, &[0.125, 1.0, 1.375], &[0.0, -1.0, -1.0], 0.5).floor().gravity(9.75)
}

#[test]
fn balls_that_land_and_rest_do_the_same_in_units_of_any_power_of_two() {
    let (m, r, q) = ([3.0, 1.0, 3.0], [0.25, 0.375, 0.375], [0.5, 1.125, 1.875]);
    let dropped = Scene::new(&m, &r, &q, &[0.0; 3], 0.0).floor().gravity(9.75);
    for scene in [pile(), dropped] {
        let (q, v) = scene.run();
        for (length, time) in [(-28, 0), (28, 0), (0, -28), (0, 28), (-40, 7)] {
            let [length, time] = [length, time].map(|k| 2.0_f64.powi(k));
            let (other_q, other_v) = scene.clone().scaled(length, time).run();
            let other_q: Vec<f64> = other_q.iter().map(|q| q / length).collect();
            let other_v: Vec<f64> = other_v.iter().map(|v| v * (time / length)).collect();
            let off = far(&q, &other_q).max(far(&v, &other_v));
            assert!(off < 1e-12, "{length:e} {time:e}: {off:e}");
        }
    }
}

#[test]
fn balls_that_meet_without_bouncing_fall_on_together_as_free_as_before() {
    for by in [0.0, 0.5, 0.3, 100.0] {
        let scene = Scene::<1>::new(&[1.0, 3.0], &[0.25, 0.125], &[0.0, 0.5], &[1.0, -0.5], 0.0);
        let scene = scene.gravity(9.75).shifted(by);
        let (q, v) = scene.run();
        let t = scene.h * 32.0;
        // The centre of mass is at 0.375 at first, and moves at -0.125.
        let middle = by + 0.375 - 0.125 * t - 0.5 * 9.75 * t * t;
        let off = far(&q, &[middle - 0.75 * 0.375, middle + 0.25 * 0.375]);
        assert!(off < 1e-12 * by.max(1.0), "{by}: {off:e}");
        assert!(far(&v, &[-0.125 - 9.75 * t; 2]) < 1e-12, "{by}: {v:?}");
    }
}

#[test]
fn a_disc_that_slides_along_a_wall_meets_the_next_one_where_it_does_in_a_turned_scene() {
    let (m, r) = ([1.0, 3.0, 2.0], [0.25, 0.375, 0.25]);
    let q = [0.875, 1.625, -1.375, 0.875, 0.375, 0.25];
    let v = [2.5, -0.75, 2.0, -2.75, -0.375, -2.375];
    let scene = Scene::<2>::new(&m, &r, &q, &v, 0.0).floor();
    let (q, v) = scene.run();
    let mut other = Scene { q: all_turned(&scene.q), v: all_turned(&scene.v), ..scene };
    other.walls.iter_mut().for_each(|wall| wall.normal = turned(wall.normal));
    let (other_q, other_v) = other.run();
    let off = far(&all_turned(&q), &other_q).max(far(&all_turned(&v), &other_v));
    assert!(off < 1e-12, "{off:e}");
}

#[test]
fn a_ball_far_away_changes_nothing() {
    let scene = pile();
    let (q, v) = scene.run();
    let mut other = scene.clone();
    for (list, x) in [(&mut other.masses, 1.0), (&mut other.radii, 0.25)] {
        list.push(x);
    }
    other.q.push(1e6);
    other.v.push(0.0);
    let (other_q, other_v) = other.run();
    let off = far(&q, &other_q[..3]).max(far(&v, &other_v[..3]));
    assert!(off < 1e-12, "{off:e}");
}

#[test]
fn what_rests_elsewhere_leaves_a_ball_its_parabola_and_its_bounce() {
    // One slides on the floor, pressed by its weight; the other falls beside it.
    let q = [-2.0, 0.25, 1.0, 1.25];
    let scene = Scene::<2>::new(&[1.0, 2.0], &[0.25, 0.25], &q, &[0.5, 0.0, 0.25, 0.0], 0.5);
    let scene = Scene { steps: 40, ..scene.floor().gravity(8.0) };
    let (q, v) = scene.run();
    // It falls 1 m in 0.5 s, and leaves at half of 4 m/s.
    let after = 40.0 / 64.0 - 0.5;
    let height = 0.25 + 2.0 * after - 4.0 * after * after;
    let ends = [-2.0 + 0.5 * 0.625, 0.25, 1.0 + 0.25 * 0.625, height];
    assert!(far(&q, &ends) < 1e-12, "{q:?} {ends:?}");
    assert!(far(&v, &[0.5, 0.0, 0.25, 2.0 - 8.0 * after]) < 1e-12, "{v:?}");
}

#[test]
fn an_impact_whose_speeds_grow_ends_at_their_rounding() {
    let q = [-0.875, 0.375, -1.75, 0.125, 0.125, 0.375, -1.75, 0.375];
    let v = [-0.875, -1.125, 0.875, 0.0, -0.25, 0.625, 1.875, 0.625];
    let scene = Scene::<2>::new(&[3.0, 1.0, 1.0, 3.0], &[0.375, 0.125, 0.375, 0.125], &q, &v, 0.0);
    let (q, v) = scene.floor().gravity(9.75).fixed([-1.375, -1.875], 0.25).run();
    assert!(q.iter().chain(&v).all(|x| x.is_finite()));
}
