//! Joints and contacts of one world, solved together: a door that hits its frame, a chain draped over a drum.

use nalgebra::Vector2;
use stationary_calculus::{Covector, DiagonalMetric, Force, System, Vector};
use stationary_constraints::Constraint;
use stationary_contact::{Kept, PlanarCollider, PlanarDetector, PlanarShape, PlanarWorld};
use stationary_integrators::State;
use stationary_rigid::{
    LieGroup, PlanarEnd, PlanarJoint, PlanarJointKind, PlanarMotion, PlanarWeight,
};

type Moved = State<Vec<f64>>;

fn system(masses: &[[f64; 2]], gravity: f64) -> System<DiagonalMetric<Vec<f64>>, PlanarWeight> {
    let weight = PlanarWeight {
        gravity: Vector2::new(0.0, -gravity),
        masses: masses.iter().map(|[mass, _]| *mass).collect(),
    };
    let all = masses.iter().flat_map(|&[mass, inertia]| [mass, mass, inertia]).collect();
    System::new(DiagonalMetric::new(all).unwrap(), weight).unwrap()
}

fn pin(bodies: usize, ends: [PlanarEnd; 2]) -> PlanarJoint {
    PlanarJoint::new(bodies, PlanarJointKind::Pin, ends).unwrap()
}

fn open(joints: &impl Constraint, q: &[f64]) -> f64 {
    let mut values = vec![0.0; joints.count()];
    joints.value(0.0, q, &mut values).unwrap();
    values.iter().fold(0.0, |most, value| value.abs().max(most))
}

fn energy(masses: &[[f64; 2]], gravity: f64, state: &Moved) -> f64 {
    let bodies = masses.iter().zip(state.p.0.chunks(3)).zip(state.q.chunks(3));
    let each = bodies.map(|((&[m, i], p), q)| {
        0.5 * (p[0] * p[0] + p[1] * p[1]) / m + 0.5 * p[2] * p[2] / i + m * gravity * q[1]
    });
    each.sum()
}

/// A door of 1 m turns at 2 rad/s about a hinge at its end and hits a post at its other end: it leaves
/// with the restitution's part of its speed, whatever the hinge has to give for it.
#[test]
fn a_door_rebounds_from_its_frame_by_the_restitution_and_stays_on_its_hinge() {
    let (length, thick) = (1.0, 0.05);
    let masses = [[8.0, 8.0 * (length * length + thick * thick) / 12.0]];
    for restitution in [0.0, 0.5, 1.0] {
        let post = PlanarMotion { translation: Vector2::new(0.9, 0.6), ..PlanarMotion::identity() };
        let colliders = vec![
            PlanarCollider::on_body(0, PlanarShape::cuboid([0.5 * length, 0.5 * thick]).unwrap()),
            PlanarCollider::fixed(post, PlanarShape::disc(0.1).unwrap()),
        ];
        let colliders = colliders.into_iter().map(|c| c.with_restitution(restitution)).collect();
        let detector = PlanarDetector::new(colliders, 1).unwrap();
        let mut world = PlanarWorld::new(system(&masses, 0.0), detector).unwrap();
        let hinge =
            pin(1, [PlanarEnd::world(Vector2::zeros()), PlanarEnd::on(0, Vector2::new(-0.5, 0.0))]);
        let joints = Kept(&hinge);
        let spin = 2.0;
        let p = vec![0.0, masses[0][0] * 0.5 * spin, masses[0][1] * spin];
        let mut state = State::new(vec![0.5, 0.0, 0.0], Covector(p));
        let start = energy(&masses, 0.0, &state);
        let mut impacts = 0;
        for _ in 0..500 {
            let before = energy(&masses, 0.0, &state);
            let report = world.step_with(&mut state, 1e-3, &joints).unwrap();
            assert!(report.settled, "{report:?}");
            assert!(energy(&masses, 0.0, &state) <= before + 1e-12 * start);
            assert!(open(&hinge, &state.q) < 1e-10, "{}", open(&hinge, &state.q));
            impacts += usize::from(report.impacts > 0);
        }
        // What does not rebound comes to rest without an impact.
        assert_eq!(impacts, usize::from(restitution > 0.0), "restitution {restitution}");
        // A step turns the hinge's impulse with it no more than once, and loses (h omega)^2 of its speed.
        let left = state.p.0[2] / masses[0][1];
        assert!((left + restitution * spin).abs() < 1e-3 * spin, "{restitution}: {left}");
    }
}

/// Twelve links over a drum, hinged to each other: they fall onto it and what lies on it stays, while both ends
/// hang and swing. Hinges stay closed, energy never grows, and nothing is pressed into the drum.
#[test]
fn a_chain_draped_over_a_drum_stays_where_it_lies_with_its_hinges_closed() {
    const LINKS: usize = 12;
    let (length, thick, gravity) = (0.2, 0.04, 9.81);
    let masses = [[0.5, 0.5 * (length * length + thick * thick) / 12.0]; LINKS];
    let mut colliders: Vec<_> = (0..LINKS)
        .map(|body| {
            // Shorter than the link: neighbours share a hinge and do not touch.
            let shape = PlanarShape::cuboid([0.35 * length, 0.5 * thick]).unwrap();
            PlanarCollider::on_body(body, shape)
        })
        .collect();
    colliders
        .push(PlanarCollider::fixed(PlanarMotion::identity(), PlanarShape::disc(0.5).unwrap()));
    let colliders = colliders.into_iter().map(|c| c.with_friction(0.8)).collect();
    let mut detector = PlanarDetector::new(colliders, LINKS).unwrap();
    for (a, b) in (0..LINKS).flat_map(|a| (0..a).map(move |b| (a, b))) {
        detector = detector.without_pair([a, b]).unwrap();
    }
    let mut world = PlanarWorld::new(system(&masses, gravity), detector).unwrap();
    let end = |body, side: f64| PlanarEnd::on(body, Vector2::new(side * 0.5 * length, 0.0));
    let joints: Vec<_> = (1..LINKS).map(|k| pin(LINKS, [end(k - 1, 1.0), end(k, -1.0)])).collect();
    let place = |k: usize| [length * (k as f64 - 0.5 * (LINKS - 1) as f64), 0.55, 0.0];
    let q = (0..LINKS).flat_map(place).collect();
    let mut state = State::new(q, Covector(vec![0.0; 3 * LINKS]));
    let kept = Kept(&joints);
    let (mut unsettled, mut most_open, mut most_deep) = (0, 0.0_f64, 0.0_f64);
    let mut middle = Vec::new();
    for step in 0..1500 {
        if step == 1000 {
            middle = state.q[15..21].to_vec();
        }
        let before = energy(&masses, gravity, &state);
        let report = world.step_with(&mut state, 2e-3, &kept).unwrap();
        let gained = energy(&masses, gravity, &state) - before;
        // Closing and lifting move bodies against their weight, and say so.
        let moved = report.joint_energy.max(0.0) + report.lifting_energy.max(0.0);
        assert!(gained < moved + 1e-9, "{step}: {gained} J, {report:?}");
        unsettled += usize::from(!report.settled);
        most_open = most_open.max(open(&joints, &state.q));
        most_deep = most_deep.max(world.touches().map(|t| -t.contact.gap).fold(0.0, f64::max));
    }
    assert!(most_open < 1e-6 && most_deep < 1e-3, "{most_open} {most_deep}");
    let moved = middle.iter().zip(&state.q[15..21]).map(|(a, b)| (a - b).abs());
    let moved = moved.fold(0.0, f64::max);
    assert!(moved < 1e-3, "{moved}");
    assert!(unsettled < 150, "{unsettled}");
}

/// A force that lasts through a step.
struct Push(Vec<f64>);

impl Force for Push {
    fn dim(&self) -> usize {
        self.0.len()
    }

    fn add_force(&self, _: f64, _: &[f64], _: Vector<&[f64]>, f: Covector<&mut [f64]>) {
        f.0.iter_mut().zip(&self.0).for_each(|(f, push)| *f += push);
    }
}

/// A block on the floor under a force: pressed down it is no impact, pushed beyond friction it slides with
/// (F - mu N)/m; the work of the force along the mean velocity is what the energy and friction account for. A
/// force that is not finite is an error, and nothing has moved.
#[test]
fn forces_beside_the_potential_are_part_of_the_velocity_increment() {
    let masses = [[2.0, 2.0 / 6.0]];
    let floor = PlanarMotion::identity();
    let colliders = vec![
        PlanarCollider::on_body(0, PlanarShape::cuboid([0.5, 0.5]).unwrap()),
        PlanarCollider::fixed(floor, PlanarShape::half_plane(Vector2::y()).unwrap()),
    ];
    let surface = |c: PlanarCollider| c.with_restitution(0.9).with_friction(0.5);
    let detector = PlanarDetector::new(colliders.into_iter().map(surface).collect(), 1).unwrap();
    let mut world = PlanarWorld::new(system(&masses, 0.0), detector).unwrap();
    let mut state = State::new(vec![0.0, 0.5, 0.0], Covector(vec![0.0; 3]));
    let (h, push) = (1e-3, Push(vec![15.0, -20.0, 0.0]));
    for step in 1..=100 {
        let before = energy(&masses, 0.0, &state);
        let report = world.step_under(&mut state, h, &(), &push).unwrap();
        assert_eq!((report.impacts, report.settled), (0, true));
        let v = state.p.0[0] / 2.0;
        assert!((v - 2.5 * h * f64::from(step)).abs() < 1e-9, "{step}: {v}");
        let [start, end] = world.velocities();
        let work: f64 = (0..3).map(|k| 0.5 * h * push.0[k] * (start.0[k] + end.0[k])).sum();
        let gained = energy(&masses, 0.0, &state) - before;
        let taken = report.friction_energy + report.impact_energy;
        assert!((gained - work + taken).abs() < 1e-12, "{step}: {gained} {work} {taken}");
    }
    let (kept, infinite) = (state.clone(), Push(vec![f64::INFINITY, 0.0, 0.0]));
    assert!(world.step_under(&mut state, h, &(), &infinite).is_err());
    assert_eq!(state, kept);
}

/// A box that is sunk into the floor, with a body welded to it that has no shape.
#[test]
fn what_overlaps_is_lifted_though_a_jointed_body_has_no_shape() {
    let half = PlanarShape::cuboid([0.5, 0.5]).unwrap();
    let ground = PlanarShape::half_plane(Vector2::y()).unwrap();
    let colliders = vec![
        PlanarCollider::on_body(0, half),
        PlanarCollider::fixed(PlanarMotion::identity(), ground),
    ];
    let detector = PlanarDetector::new(colliders, 2).unwrap();
    let mut world = PlanarWorld::new(system(&[[1.0, 0.1]; 2], 9.81), detector).unwrap();
    let q = vec![0.0, 0.49, 0.0, 0.0, 1.0, 0.0];
    let end = |k: usize| {
        let place = [q[3 * k], q[3 * k + 1], q[3 * k + 2]];
        PlanarEnd::where_it_stands(k, place, Vector2::new(0.0, 0.9))
    };
    let weld = PlanarJoint::new(2, PlanarJointKind::Weld, [end(0), end(1)]).unwrap();
    let mut state = State::new(q.clone(), Covector(vec![0.0; 6]));
    for _ in 0..200 {
        world.step_with(&mut state, 1e-3, &Kept(&weld)).unwrap();
    }
    assert!((state.q[1] - 0.5).abs() < 1e-5, "{:?}", state.q);
    assert!(open(&weld, &state.q) < 1e-9);
}
