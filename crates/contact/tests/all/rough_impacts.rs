//! Impacts with friction: closed forms of a disc and a rod, and energy that never grows.

use nalgebra::Vector2;
use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_contact::{
    Painleve, PlanarCollider, PlanarDetector, PlanarShape, PlanarWorld, World, WorldReport,
};
use stationary_integrators::State;
use stationary_measure::SplitMix64;
use stationary_rigid::{LieGroup, PlanarMotion, PlanarWeight};

/// One body of 1 kg over a floor, without gravity.
fn over_floor(shape: PlanarShape, inertia: f64, c: f64, mu: f64) -> PlanarWorld<PlanarWeight> {
    let metric = DiagonalMetric::new(vec![1.0, 1.0, inertia]).unwrap();
    let weight = PlanarWeight { gravity: Vector2::zeros(), masses: vec![1.0] };
    let floor = PlanarShape::half_plane(Vector2::y()).unwrap();
    let colliders = vec![
        PlanarCollider::on_body(0, shape).with_restitution(c).with_friction(mu),
        PlanarCollider::fixed(PlanarMotion::identity(), floor).with_friction(mu),
    ];
    let detector = PlanarDetector::new(colliders, 1).unwrap();
    World::new(System::new(metric, weight).unwrap(), detector).unwrap()
}

/// The velocity after an impact at the step's start, and the normal and friction impulses.
fn hit(world: &mut PlanarWorld<PlanarWeight>, q: [f64; 3], p: [f64; 3]) -> (Vec<f64>, f64, f64) {
    let mut state = State::new(q.to_vec(), Covector(p.to_vec()));
    let report = world.step(&mut state, 1e-6).unwrap();
    assert!(report.settled, "{report:?}");
    let normal = world.touches().map(|touch| touch.impact + touch.normal).sum();
    // The floor is the second of the two.
    let friction = world.touches().map(|touch| -touch.friction.x).sum();
    (state.p.0, normal, friction)
}

/// A disc: its point of contact slides at `v + r w`, and gives way by `1 + m r^2/I` times as much
/// as its centre. Garwin 1969; Brogliato 2016, 4.2.
#[test]
fn a_disc_that_bounces_with_spin_slides_or_grips_as_the_closed_form_says() {
    let (r, inertia, c) = (0.5, 0.125, 0.6);
    for mu in [0.0, 0.1, 0.3, 2.0] {
        for (vx, spin) in [(3.0, 0.0), (0.0, 4.0), (1.0, -8.0), (-2.0, 3.0), (0.5, 0.0)] {
            let fall = 2.0;
            let mut world = over_floor(PlanarShape::disc(r).unwrap(), inertia, c, mu);
            let (p, normal, friction) = hit(&mut world, [0.0, r, 0.0], [vx, -fall, inertia * spin]);
            let (pushed, slip, gives) = ((1.0 + c) * fall, vx + r * spin, 1.0 + r * r / inertia);
            let grips = slip.abs() <= mu * pushed * gives;
            let rubbed = if grips { -slip / gives } else { -mu * pushed * slip.signum() };
            let expected = [vx + rubbed, c * fall, inertia * spin + r * rubbed];
            for (p, expected) in p.iter().zip(expected) {
                assert!((p - expected).abs() < 1e-9, "{mu} {vx} {spin}: {p} {expected}");
            }
            assert!((normal - pushed).abs() < 1e-9 && (friction - rubbed).abs() < 1e-9);
        }
    }
}

#[test]
fn a_trace_of_restitution_changes_an_impact_by_a_trace() {
    let thrown = |c: f64| {
        let shape = PlanarShape::cuboid([0.5; 2]).unwrap();
        let mut world = over_floor(shape, 1.0 / 6.0, c, 0.5);
        hit(&mut world, [0.0, 0.5, 0.0], [5.0, -3.0, 0.0]).0
    };
    let (without, with) = (thrown(0.0), thrown(1e-12));
    assert!((without[0] - 3.5).abs() < 1e-9, "{without:?}");
    assert!(without.iter().zip(&with).all(|(a, b)| (a - b).abs() < 1e-9), "{without:?} {with:?}");
}

const HALF: [f64; 2] = [1.0, 0.05];
const INERTIA: f64 = (HALF[0] * HALF[0] + HALF[1] * HALF[1]) / 3.0;

/// A rod that leans on its lower right end: from its centre to that end, and how it gives way
/// along the normal, across, and from one to the other.
fn rod(angle: f64) -> ([f64; 2], [f64; 3]) {
    let (s, c) = angle.sin_cos();
    let arm = [HALF[0] * c - HALF[1] * s, -HALF[0] * s - HALF[1] * c];
    let gives = [
        1.0 + arm[0] * arm[0] / INERTIA,
        1.0 + arm[1] * arm[1] / INERTIA,
        -arm[0] * arm[1] / INERTIA,
    ];
    (arm, gives)
}

/// How a rod that leans by `-angle` leaves the floor: momenta, normal and friction impulse.
fn thrown_rod(angle: f64, v: [f64; 3], c: f64, mu: f64) -> (Vec<f64>, f64, f64) {
    let mut world = over_floor(PlanarShape::cuboid(HALF).unwrap(), INERTIA, c, mu);
    let (arm, _) = rod(angle);
    hit(&mut world, [0.0, -arm[1], -angle], [v[0], v[1], INERTIA * v[2]])
}

fn kinetic(p: &[f64]) -> f64 {
    0.5 * (p[0] * p[0] + p[1] * p[1] + p[2] * p[2] / INERTIA)
}

#[test]
fn a_rod_on_a_rough_floor_stays_in_the_cone_and_never_gains_energy() {
    let mut random = SplitMix64::new(31);
    let (mut gripped, mut slid) = (0, 0);
    for _ in 0..400 {
        let angle = 0.8 + 0.6 * random.symmetric();
        let v = [3.0, 2.0, 2.0].map(|by| by * random.symmetric());
        let (c, mu) = (random.symmetric().abs(), 1.5 * random.symmetric().abs());
        let (arm, [normal_gives, gives, couples]) = rod(angle);
        let u = [v[1] + arm[0] * v[2], v[0] - arm[1] * v[2]];
        if u[0] > -0.05 {
            continue;
        }
        let (p, normal, friction) = thrown_rod(angle, v, c, mu);
        let before = kinetic(&[v[0], v[1], INERTIA * v[2]]);
        assert!(kinetic(&p) <= before * (1.0 + 1e-9), "{angle} {v:?}: {} {before}", kinetic(&p));
        assert!(friction.abs() <= mu * normal * (1.0 + 1e-9), "{friction} {normal}");
        // The closed form: gripping where the cone lets it, else sliding on or turned back.
        let grip = |pushed: f64| -(u[1] + couples * pushed) / gives;
        let at = |sign: f64| (-u[0] / (normal_gives + sign * mu * couples), sign * mu);
        let stuck = (-u[0] + couples * u[1] / gives) / (normal_gives - couples * couples / gives);
        let compressed = if grip(stuck).abs() <= mu * stuck {
            stuck
        } else {
            let slides = |&(pushed, part): &(f64, f64)| {
                pushed > 0.0 && (u[1] + couples * pushed + gives * part * pushed) * part <= 0.0
            };
            let Some((pushed, _)) = [at(-1.0), at(1.0)].into_iter().find(slides) else { continue };
            pushed
        };
        let whole = (1.0 + c) * compressed;
        let rubbed = grip(whole).clamp(-mu * whole, mu * whole);
        let after = u[0] + normal_gives * whole + couples * rubbed;
        if after > 1e-3 {
            assert!(
                (normal / whole - 1.0).abs() < 1e-6,
                "{angle} {v:?} {c} {mu}: {normal} {whole}"
            );
            assert!((friction - rubbed).abs() < 1e-6 * whole, "{friction} {rubbed}");
            if rubbed.abs() < mu * whole { gripped += 1 } else { slid += 1 }
        }
    }
    assert!(gripped > 30 && slid > 30, "{gripped} {slid}");
}

/// Kane and Levinson 1985: with Newton's ratio of velocities, a rod whose end is turned back by
/// friction leaves with more energy than it brought.
#[test]
fn newtons_ratio_gains_energy_where_poissons_does_not() {
    let (mut newton, mut poisson) = (0.0_f64, f64::NEG_INFINITY);
    for step in 0..40 {
        let (angle, c, mu) = (0.6 + 0.02 * f64::from(step), 0.9, 1.0);
        let (arm, [normal_gives, gives, couples]) = rod(angle);
        for slip in [-0.2, 0.2, 0.5, 1.0, -0.5, -1.0] {
            // The end comes down at 1 m/s and slides; the rod does not turn.
            let v = [slip, -1.0, 0.0];
            let u = [v[1] + arm[0] * v[2], v[0] - arm[1] * v[2]];
            let before = kinetic(&[v[0], v[1], INERTIA * v[2]]);
            // Newton: u_n+ = -c u_n-, friction gripping at the end or at its bound.
            let stuck = (-(1.0 + c) * u[0] + couples * u[1] / gives)
                / (normal_gives - couples * couples / gives);
            let grip = -(u[1] + couples * stuck) / gives;
            if grip.abs() <= mu * stuck {
                let (x, y) = (grip, stuck);
                let p = [v[0] + x, v[1] + y, INERTIA * v[2] + arm[0] * y - arm[1] * x];
                newton = newton.max(kinetic(&p) / before - 1.0);
            }
            let (p, ..) = thrown_rod(angle, v, c, mu);
            poisson = poisson.max(kinetic(&p) / before - 1.0);
        }
    }
    println!("Newton gains {newton}, Poisson {poisson}");
    assert!(newton > 0.05 && poisson <= 1e-9, "{newton} {poisson}");
}

/// Painleve 1895: where `mu` times the coupling exceeds how the rod gives way along the normal, a
/// rod that slides presses itself into the floor, however slowly it approaches: it jams.
#[test]
fn painleves_rod_jams_with_an_impulse_in_the_cone_and_no_energy_gained() {
    let angle = 1.0;
    let (arm, [normal_gives, _, couples]) = rod(angle);
    assert!(couples > 0.0);
    let mu = 1.5 * normal_gives / couples;
    for approach in [1e-3, 0.1, 1.0] {
        // It slides against the way in which friction lifts it.
        let v = [2.0, -approach, 0.0];
        let (p, normal, friction) = thrown_rod(angle, v, 0.3, mu);
        let before = kinetic(&[v[0], v[1], 0.0]);
        assert!(kinetic(&p) <= before * (1.0 + 1e-9), "{} {before}", kinetic(&p));
        assert!(friction.abs() <= mu * normal * (1.0 + 1e-9) && friction < 0.0);
        let slip = p[0] - arm[1] * p[2] / INERTIA;
        let closes = p[1] + arm[0] * p[2] / INERTIA;
        assert!(slip.abs() < 1e-6 && closes > -1e-9, "jammed: {slip} {closes}");
        let smooth = 1.3 * approach / normal_gives;
        assert!(normal > 1.2 * smooth, "{normal} {smooth}");
    }
}

/// A rod that leans on its end and slides on a floor, with a weight or without, after a step of 1e-6 s.
fn sliding_rod(angle: f64, mu: f64, slip: f64, c: f64, gravity: f64) -> (Vec<f64>, WorldReport) {
    let metric = DiagonalMetric::new(vec![1.0, 1.0, INERTIA]).unwrap();
    let weight = PlanarWeight { gravity: Vector2::y() * -gravity, masses: vec![1.0] };
    let floor = PlanarShape::half_plane(Vector2::y()).unwrap();
    let shape = PlanarShape::cuboid(HALF).unwrap();
    let colliders = vec![
        PlanarCollider::on_body(0, shape).with_restitution(c).with_friction(mu),
        PlanarCollider::fixed(PlanarMotion::identity(), floor).with_friction(mu),
    ];
    let detector = PlanarDetector::new(colliders, 1).unwrap();
    let mut world: PlanarWorld<PlanarWeight> =
        World::new(System::new(metric, weight).unwrap(), detector).unwrap();
    let (arm, _) = rod(angle);
    let fall = if gravity > 0.0 { 0.0 } else { 0.1 };
    let mut state = State::new(vec![0.0, -arm[1], -angle], Covector(vec![slip, -fall, 0.0]));
    let report = world.step(&mut state, 1e-6).unwrap();
    let (normal, friction) = world.touches().fold((0.0, 0.0), |(normal, friction), touch| {
        (normal + touch.impact + touch.normal, friction - touch.friction.x)
    });
    assert!(friction.abs() <= mu * normal * (1.0 + 1e-9), "{friction} {normal}");
    let work = 1e-6 * gravity * (fall + state.p.0[1].abs());
    let before = kinetic(&[slip, -fall, 0.0]);
    assert!(kinetic(&state.p.0) <= (before + work) * (1.0 + 1e-9), "{:?} {before}", state.p.0);
    (state.p.0, report)
}

/// The critical friction of a configuration is `W_nn/W_nt`: at it and beyond the report names the
/// paradox, below and for the other way of sliding it does not.
#[test]
fn the_report_names_painleves_paradox_at_and_beyond_the_critical_friction_and_not_below() {
    for angle in [0.8, 1.0, 1.2] {
        let (_, [normal_gives, _, couples]) = rod(angle);
        let critical = normal_gives / couples;
        for (c, gravity) in [(0.0, 0.0), (0.3, 0.0), (0.0, 9.81), (0.3, 9.81)] {
            for (part, named) in
                [(0.5, false), (1.0 - 1e-6, false), (1.0, true), (1.0 + 1e-6, true), (2.0, true)]
            {
                let mu = part * critical;
                let (after, report) = sliding_rod(angle, mu, 2.0, c, gravity);
                let found = report.painleve;
                assert_eq!(found.is_some(), named, "{angle} {c} {gravity} {part}: {report:?}");
                let expected = normal_gives - mu * couples;
                let off = |found: Painleve| (found.compliance - expected).abs();
                assert!(found.is_none_or(|found| off(found) < 1e-9), "{found:?} {expected}");
                // It jams: the end is stopped by an impulse, whatever presses it.
                let slip = after[0] - rod(angle).0[1] * after[2] / INERTIA;
                assert!(part < 1.5 || slip.abs() < 1e-6, "{angle} {c} {gravity} {part}: {slip}");
                let (_, other) = sliding_rod(angle, mu, -2.0, c, gravity);
                assert_eq!(other.painleve, None, "the other way");
            }
        }
    }
    let mut world = over_floor(PlanarShape::cuboid([0.5; 2]).unwrap(), 1.0 / 6.0, 0.0, 1.0);
    let mut state = State::new(vec![0.0, 0.5, 0.0], Covector(vec![5.0, -1.0, 0.0]));
    assert_eq!(world.step(&mut state, 1e-6).unwrap().painleve, None);
}

/// A light disc on the floor below a heavy one that falls on it, all elastic: they bounce off each other and the
/// floor in turn, `tan a = sqrt(m/M)`, and after `n` bounces of both
/// `V = -cos 2na`, `v = sin 2na/tan a`. The first pass has their contact alone, and twenty with friction follow, ten of
/// them on the floor: the report says that the light one approaches it still. Without friction the law ends by
/// itself.
#[test]
fn what_all_passes_of_an_impact_leave_is_said_by_the_report_as_the_closed_form_has_it() {
    let (light, radius) = (1e-4, 0.1);
    let disc = |body, friction: f64| {
        let disc = PlanarCollider::on_body(body, PlanarShape::disc(radius).unwrap());
        disc.with_restitution(1.0).with_friction(friction)
    };
    for friction in [0.5, 0.0] {
        let floor = PlanarShape::half_plane(Vector2::y()).unwrap();
        let floor = PlanarCollider::fixed(PlanarMotion::identity(), floor);
        let floor = floor.with_restitution(1.0).with_friction(friction);
        let colliders = vec![disc(0, friction), disc(1, friction), floor];
        let moments = [light, 1.0].map(|m: f64| [m, m, 0.5 * m * radius * radius]).concat();
        let weight = PlanarWeight { gravity: Vector2::zeros(), masses: vec![light, 1.0] };
        let system = System::new(DiagonalMetric::new(moments).unwrap(), weight).unwrap();
        let mut world =
            PlanarWorld::new(system, PlanarDetector::new(colliders, 2).unwrap()).unwrap();
        let q = vec![0.0, radius, 0.0, 0.0, 3.0 * radius, 0.0];
        let mut state = State::new(q, Covector(vec![0.0, 0.0, 0.0, 0.0, -1.0, 0.0]));
        let report = world.step(&mut state, 1e-3).unwrap();
        let half = light.sqrt().atan();
        let expected = if friction > 0.0 { (22.0 * half).sin() / half.tan() } else { 0.0 };
        assert!(
            (report.impact_residual - expected).abs() <= 1e-9 * expected,
            "{friction}: {expected} {report:?}"
        );
        let energy = 0.5 * (state.p.0[1].powi(2) / light + state.p.0[4].powi(2));
        assert!(energy <= 0.5 + 1e-12, "{friction}: {energy}");
        assert!(friction > 0.0 || (energy - 0.5).abs() < 1e-9, "{energy}");
    }
}

#[test]
fn the_report_of_painleves_paradox_does_not_depend_on_the_unit_of_length() {
    for unit in [1.0, 1.0 / 1_048_576.0, 1e-9] {
        let rod = PlanarShape::capsule(0.5 * unit, 1e-3 * unit).unwrap();
        let ground = PlanarShape::half_plane(Vector2::y()).unwrap();
        let colliders = vec![
            PlanarCollider::on_body(0, rod).with_friction(3.0),
            PlanarCollider::fixed(PlanarMotion::identity(), ground).with_friction(3.0),
        ];
        let moment = unit * unit / 12.0;
        let metric = DiagonalMetric::new(vec![1.0, 1.0, moment]).unwrap();
        let weight = PlanarWeight { gravity: Vector2::new(0.0, -9.81 * unit), masses: vec![1.0] };
        let system = System::new(metric, weight).unwrap();
        let detector = PlanarDetector::new(colliders, 1).unwrap();
        let mut world = PlanarWorld::new(system, detector).unwrap();
        let (angle, spin) = (1.1_f64, -50.0);
        let arm = Vector2::new(angle.cos(), angle.sin()) * (-0.5 * unit);
        // The lower end slides slowly, beside a spin in rad/s that is large.
        let v = Vector2::new(spin * arm.y + 0.02 * unit, -spin * arm.x);
        let q = vec![0.0, 1e-3 * unit - arm.y, angle];
        let mut state = State::new(q, Covector(vec![v.x, v.y, moment * spin]));
        let report = world.step(&mut state, 1e-4).unwrap();
        assert!(report.painleve.is_some(), "{unit:e}");
    }
}
