//! Constructors, detectors and steps with bad numbers and sizes.

use nalgebra::Vector2;
use stationary_calculus::{Covector, DiagonalMetric, System, Vector};
use stationary_contact::{
    ContactError, ContactRows, Impact, InverseMass, MeshFilter, PlanarCollider, PlanarDetector,
    PlanarShape, PlanarWorld, World, push_apart,
};
use stationary_integrators::State;
use stationary_rigid::{LieGroup, PlanarMotion, PlanarRotation, PlanarWeight};

use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "bad-input-contact",
    krate: "contact",
    rule: "a panic or a hang; Ok where a number is out of its range, a size does not fit or a body \
           is absent, or Ok with numbers that are not finite; a failed step that changes its state",
    in_tests: 2000,
    trial,
};

fn number(draw: &mut Draw, good: f64) -> f64 {
    if draw.chance(0.3) { draw.any_f64() } else { good }
}

/// Refused where it is bad, taken where it is good.
fn judged<T>(good: bool, result: Result<T, ContactError>, what: &str) -> Verdict {
    match (good, result) {
        (true, Ok(_)) | (false, Err(_)) => Verdict::due(),
        (true, Err(error)) => Verdict::refused(error),
        (false, Ok(_)) => Verdict::wrong(format!("taken: {what}")),
    }
}

fn colliders(count: usize) -> Result<Vec<PlanarCollider>, ContactError> {
    let square = PlanarShape::cuboid([0.5; 2])?;
    let floor = PlanarShape::half_plane(Vector2::y())?;
    let on = |body| PlanarCollider::on_body(body, square.clone()).with_friction(0.5);
    let floor = PlanarCollider::fixed(PlanarMotion::identity(), floor);
    Ok((0..count).map(on).chain([floor]).collect())
}

fn system(count: usize) -> System<DiagonalMetric<Vec<f64>>, PlanarWeight> {
    let metric = DiagonalMetric::new([1.0, 1.0, 0.2].repeat(count)).expect("masses");
    let weight = PlanarWeight { gravity: -Vector2::y(), masses: vec![1.0; count] };
    System::new(metric, weight).expect("as many freedoms")
}

fn world(count: usize) -> PlanarWorld<PlanarWeight> {
    let detector = PlanarDetector::new(colliders(count).expect("shapes"), count).expect("bodies");
    World::new(system(count), detector).expect("as many bodies")
}

fn trial(draw: &mut Draw) -> Verdict {
    match draw.below(8) {
        0 => surfaces(draw),
        1 => places(draw),
        2 => margins(draw),
        3 => steps(draw),
        4 => settings(draw),
        5 => apart(draw),
        6 => impacts(draw),
        _ => filters(draw),
    }
}

fn surfaces(draw: &mut Draw) -> Verdict {
    let (c, mu) = (number(draw, 0.5), number(draw, 0.5));
    draw.note(format!("restitution {c}, friction {mu}"));
    let good = (0.0..=1.0).contains(&c) && mu >= 0.0 && mu.is_finite();
    let mut all = colliders(2).expect("shapes");
    if draw.chance(0.5) {
        let detector = PlanarDetector::new(all, 2).expect("two bodies");
        return judged(good, detector.with_pair([0, 1], c, mu), "a pair's surface");
    }
    all[1] = all[1].clone().with_restitution(c).with_friction(mu);
    judged(good, PlanarDetector::new(all, 2), "a surface")
}

fn places(draw: &mut Draw) -> Verdict {
    let mut all = colliders(2).expect("shapes");
    match draw.below(3) {
        0 => {
            let [x, y, angle] = [(); 3].map(|()| number(draw, 0.1));
            draw.note(format!("place {x} {y} {angle}"));
            let good = [x, y, angle].iter().all(|x| x.is_finite());
            all[0].place = PlanarMotion {
                translation: Vector2::new(x, y),
                rotation: PlanarRotation::exp(angle),
            };
            judged(good, PlanarDetector::new(all, 2), "a place")
        }
        1 => {
            let bodies = draw.below(4);
            draw.note(format!("{bodies} bodies for 2 colliders"));
            judged(bodies >= 2, PlanarDetector::new(all, bodies), "a body that is absent")
        }
        _ => {
            let carried = draw.chance(0.5);
            let plane = PlanarShape::half_plane(Vector2::x()).expect("a half-plane");
            all.push(match carried {
                true => PlanarCollider::on_body(0, plane),
                false => PlanarCollider::fixed(PlanarMotion::identity(), plane),
            });
            draw.note(format!("two half-planes, one carried: {carried}"));
            judged(!carried, PlanarDetector::new(all, 2), "half-planes against each other")
        }
    }
}

fn margins(draw: &mut Draw) -> Verdict {
    let mut detector = PlanarDetector::new(colliders(2).expect("shapes"), 2).expect("bodies");
    let mut q = vec![0.0, 0.5, 0.0, 0.0, 1.6, 0.0];
    let mut good = true;
    if draw.chance(0.3) {
        q.truncate(draw.below(6));
        good = false;
    } else if draw.chance(0.3) {
        let (at, bad) = (draw.below(6), draw.any_f64());
        q[at] = bad;
        good = bad.is_finite();
    }
    let margin = number(draw, 0.1);
    draw.note(format!("margin {margin}, poses {q:?}"));
    good &= margin >= 0.0 && margin.is_finite();
    match draw.below(3) {
        0 => judged(good, detector.detect(&q, margin).map(|_| ()), "a margin or poses"),
        1 => judged(good, detector.overlaps(&q, margin), "a depth or poses"),
        _ => {
            let body = draw.below(12);
            judged(body < 2, detector.radius(body), "a body that is absent")
        }
    }
}

fn steps(draw: &mut Draw) -> Verdict {
    let mut world = world(2);
    let (mut q, mut p) = (vec![0.0, 0.5, 0.0, 0.0, 1.6, 0.0], vec![0.0; 6]);
    let mut good = true;
    match draw.below(5) {
        0 => {
            q.truncate(draw.below(6));
            good = false;
        }
        1 => {
            p.truncate(draw.below(6));
            good = false;
        }
        2 => {
            let (at, bad) = (draw.below(6), draw.any_f64());
            q[at] = bad;
            good = bad.is_finite();
        }
        3 => {
            let (at, bad) = (draw.below(6), draw.any_f64());
            p[at] = bad;
            good = bad.is_finite();
        }
        _ => {}
    }
    let h = number(draw, 1e-2);
    good &= h > 0.0 && h.is_finite();
    draw.note(format!("h {h}, q {q:?}, p {p:?}"));
    let start = State::new(q, Covector(p));
    let mut state = start.clone();
    let bits = |state: &State<Vec<f64>>| -> Vec<u64> {
        state.q.iter().chain(&state.p.0).map(|x| x.to_bits()).collect()
    };
    match world.step(&mut state, h) {
        Ok(_) if !good => Verdict::wrong("a step of bad input"),
        Ok(_) if state.q.iter().chain(&state.p.0).any(|x| !x.is_finite()) => {
            Verdict::wrong("a state that is not finite")
        }
        Ok(_) => Verdict::due(),
        Err(_) if bits(&state) != bits(&start) => Verdict::wrong("a failed step moved the state"),
        // What is finite may still be beyond what can be computed with.
        Err(_) => Verdict::due(),
    }
}

fn settings(draw: &mut Draw) -> Verdict {
    let value = number(draw, 1e-6);
    draw.note(format!("{value}"));
    match draw.below(3) {
        0 => {
            let good = value >= 0.0 && value.is_finite();
            judged(good, world(1).with_tolerance(value), "a tolerance")
        }
        1 => judged(value >= 0.0, world(1).with_residual_limit(value), "a limit"),
        _ => {
            let body = draw.below(4);
            judged(body < 1, world(1).with_obstacles(vec![body]), "an obstacle that is absent")
        }
    }
}

fn apart(draw: &mut Draw) -> Verdict {
    let bodies = draw.between(1, 3);
    let (depth, mut q) = (number(draw, 1e-6), vec![0.0, 0.4, 0.0, 0.0, 1.2, 0.0]);
    let short = draw.chance(0.3);
    if short {
        q.truncate(draw.below(6));
    }
    draw.note(format!("a detector of {bodies} bodies for 2, depth {depth}, poses {q:?}"));
    let mut detector =
        PlanarDetector::new(colliders(bodies).expect("shapes"), bodies).expect("bodies");
    let good = bodies == 2 && !short && depth >= 0.0 && depth.is_finite();
    match push_apart::<stationary_contact::Planar, _>(&system(2), &mut detector, &mut q, depth) {
        // Contacts may lead nowhere in a hundred rounds of so small a depth.
        Err(ContactError::Overlap { .. }) if good => Verdict::due(),
        result => judged(good, result, "push_apart"),
    }
}

fn impacts(draw: &mut Draw) -> Verdict {
    let (value, c) = (number(draw, 1.0), number(draw, 0.5));
    let (freedom, count) = (draw.below(4), draw.below(3));
    draw.note(format!("entry {value} of freedom {freedom}, restitution {c}, {count} of them"));
    let mass = InverseMass::of(&DiagonalMetric::new([1.0, 2.0]).expect("masses")).expect("masses");
    let mut rows = ContactRows::new();
    rows.push([(freedom, value)]);
    let compliance = value * value / if freedom == 0 { 1.0 } else { 2.0 };
    let good = freedom < 2
        && count == 1
        && (0.0..=1.0).contains(&c)
        && compliance > 0.0
        && compliance.is_finite();
    judged(good, Impact::new(rows, &mass, vec![c; count]), "an impact")
}

fn filters(draw: &mut Draw) -> Verdict {
    let (mass, tolerance, h) = (number(draw, 1.0), number(draw, 1e-6), number(draw, 0.1));
    let above = draw.one_of(&[0.1, 0.0, 1e-9]);
    draw.note(format!("mass {mass}, tolerance {tolerance}, step {h}, {above} m above"));
    let masses = vec![mass, 1.0, 1.0, 1.0];
    let filter = MeshFilter::new(masses, vec![false; 4], vec![[1, 2, 3]], tolerance);
    let good = mass > 0.0
        && mass.is_finite()
        && mass.recip().is_finite()
        && tolerance > 0.0
        && tolerance.is_finite();
    let Ok(filter) = filter else {
        return if good { Verdict::refused("a filter") } else { Verdict::due() };
    };
    if !good {
        return Verdict::wrong("a filter of bad numbers");
    }
    let q = [0.2, 0.2, above, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut v = vec![0.0; 12];
    v[2] = -2.0;
    match filter.filter(&q, h, Vector(&mut v)) {
        Ok(_) if !(h > 0.0 && h.is_finite()) => Verdict::wrong("a step that is none"),
        Ok(_) if above == 0.0 => Verdict::wrong("a corner on the triangle that it meets"),
        Ok(_) if v.iter().any(|v| !v.is_finite()) => Verdict::wrong("not finite"),
        Ok(_) => Verdict::due(),
        Err(_) => Verdict::due(),
    }
}
