//! Random scenes of particles: on springs and rods, and under gravity.

use std::f64::consts::{PI, TAU};
use std::fmt::Write;

use stationary_trials::Draw;

use super::{head, rounded, uniform, vector};

/// Beads on springs, soft and stiff, about pins; some with drag, with weight, or at rest.
pub(super) fn springs(draw: &mut Draw) -> (String, Vec<String>) {
    let dimension = draw.between(1, 3);
    let (beads, pins) = (draw.between(1, 3), draw.between(1, 2));
    let (mut particles, mut springs) = (String::new(), String::new());
    let still = draw.chance(0.1);
    let mut names = Vec::new();
    let mut places: Vec<Vec<f64>> = Vec::new();
    for pin in 0..pins {
        let mut place = vec![0.0; dimension];
        place[0] = 4.0 * pin as f64 - 2.0;
        writeln!(
            particles,
            "    {{ name = \"pin{pin}\", pinned = true, position = {} }},",
            vector(&place)
        )
        .ok();
        places.push(place);
        names.push(format!("pin{pin}"));
    }
    let (mut fastest, mut slowest) = (0.0_f64, f64::INFINITY);
    let mut masses = vec![f64::INFINITY; pins];
    for bead in 0..beads {
        let mut place = uniform(draw, dimension, 0.3);
        place[0] += bead as f64 - 0.5 * (beads - 1) as f64;
        let velocity = if still { vec![0.0; dimension] } else { uniform(draw, dimension, 2.0) };
        let mass = if draw.chance(0.2) { draw.log_uniform(0.01, 1.0) } else { 1.0 };
        writeln!(
            particles,
            "    {{ name = \"bead{bead}\", mass = {:?}, position = {}, velocity = {} }},",
            rounded(mass),
            vector(&place),
            vector(&velocity)
        )
        .ok();
        places.push(place);
        masses.push(mass);
        names.push(format!("bead{bead}"));
    }
    let mut link = |draw: &mut Draw, a: usize, b: usize| {
        let stiffness = if draw.chance(0.3) {
            draw.log_uniform(100.0, 1e5)
        } else {
            draw.log_uniform(1.0, 100.0)
        };
        let far = places[a].iter().zip(&places[b]).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        let rest = far.sqrt() * if still { 1.0 } else { draw.uniform(0.5, 1.2) };
        let rate = (stiffness / masses[a].min(masses[b])).sqrt();
        (fastest, slowest) = (fastest.max(rate), slowest.min(rate));
        let (a, b) = (&names[a], &names[b]);
        let rest =
            if still { String::new() } else { format!(", rest_length = {:?}", rounded(rest)) };
        writeln!(
            springs,
            "    {{ between = [\"{a}\", \"{b}\"], stiffness = {:?}{rest} }},",
            rounded(stiffness)
        )
        .ok();
    };
    link(draw, 0, pins);
    for bead in 1..beads {
        link(draw, pins + bead - 1, pins + bead);
    }
    if pins == 2 {
        link(draw, 1, pins + beads - 1);
    }
    let turns = draw.log_uniform(0.5, 20.0);
    let horizon = (turns * TAU / slowest).min(2000.0 / fastest);
    let drag = draw.chance(0.3);
    let mut text = head(dimension, if drag { "newmark" } else { "stormer-verlet" }, horizon);
    if drag {
        let rate = draw.log_uniform(0.01, 1.0) * slowest;
        writeln!(text, "drag = {{ coefficient = {:?} }}", rounded(rate)).ok();
    }
    if !still && draw.chance(0.5) {
        let mut weight = vec![0.0; dimension];
        weight[dimension - 1] = -9.81;
        writeln!(text, "uniform_gravity = {{ acceleration = {} }}", vector(&weight)).ok();
    }
    write!(text, "particles = [\n{particles}]\nsprings = [\n{springs}]\n").ok();
    let mut observables = observables(&names[pins..], dimension);
    if beads > 1 {
        observables.push("distance=bead0,bead1".to_owned());
    }
    (text, observables)
}

fn observables(names: &[String], dimension: usize) -> Vec<String> {
    let mut all: Vec<String> =
        ["energy", "kinetic-energy", "potential-energy"].map(String::from).to_vec();
    if dimension > 1 {
        all.push("angular-momentum".to_owned());
    }
    for name in names {
        all.push(format!("position={name}"));
        all.push(format!("position={name}"));
        all.push(format!("velocity={name}"));
    }
    all
}

/// One bead whose period is a whole part of the horizon: often that of a twentieth.
pub(super) fn oscillator(draw: &mut Draw) -> (String, Vec<String>) {
    let dimension = draw.between(1, 2);
    let stiffness = rounded(draw.log_uniform(0.1, 1e3));
    let mass = rounded(draw.log_uniform(0.1, 10.0));
    let period = TAU * (mass / stiffness).sqrt();
    let periods = if draw.chance(0.6) { 20.0 } else { draw.between(1, 60) as f64 };
    let nudge = if draw.chance(0.5) { 1.0 } else { draw.uniform(0.9, 1.1) };
    let horizon = periods * nudge * period;
    let amplitude = rounded(draw.log_uniform(1e-3, 0.9));
    let mut place = vec![0.0; dimension];
    place[0] = 1.0 + amplitude;
    let mut velocity = vec![0.0; dimension];
    if draw.chance(0.5) {
        velocity[dimension - 1] = draw.symmetric() * amplitude * (stiffness / mass).sqrt();
    }
    let rest = if draw.chance(0.3) { 0.0 } else { 1.0 };
    let weak = draw.chance(0.4);
    let mut text = head(dimension, if weak { "newmark" } else { "stormer-verlet" }, horizon);
    // The horizon is to be met to the last digit here.
    let step = horizon / 100.0;
    text = format!(
        "{}step = {step:?}\nhorizon = {:?}\n",
        text.split("step").next().unwrap_or_default(),
        100.0 * step
    );
    if weak {
        let coefficient = rounded(draw.log_uniform(1e-4, 0.5) * (stiffness * mass).sqrt());
        writeln!(text, "drag = {{ coefficient = {coefficient:?} }}").ok();
    }
    writeln!(
        text,
        "particles = [\n    {{ name = \"pin\", pinned = true, position = {} }},\n    \
         {{ name = \"bead\", mass = {mass:?}, position = {}, velocity = {} }},\n]\n\
         springs = [{{ between = [\"pin\", \"bead\"], stiffness = {stiffness:?}, rest_length = {rest:?} }}]",
        vector(&vec![0.0; dimension]),
        vector(&place),
        vector(&velocity)
    )
    .ok();
    (text, observables(&["bead".to_owned()], dimension))
}

/// Two or three masses that attract each other: orbits, and falls from rest that end close by.
pub(super) fn encounter(draw: &mut Draw) -> (String, Vec<String>) {
    let dimension = draw.between(2, 3);
    let mut bodies: Vec<(f64, Vec<f64>, Vec<f64>)> = Vec::new();
    let horizon;
    if draw.chance(0.5) {
        let (e, light) = (draw.uniform(0.0, 0.95), draw.log_uniform(1e-6, 1.0));
        let speed = ((1.0 + light) * (1.0 + e) / (1.0 - e)).sqrt();
        let mut place = vec![0.0; dimension];
        place[0] = 1.0 - e;
        let mut velocity = vec![0.0; dimension];
        velocity[1] = speed;
        bodies.push((1.0, vec![0.0; dimension], vec![0.0; dimension]));
        bodies.push((light, place, velocity));
        horizon = draw.log_uniform(0.2, 10.0) * TAU / (1.0 + light).sqrt();
    } else {
        let fall = draw.chance(0.5);
        for _ in 0..3 {
            let mass = draw.log_uniform(0.2, 5.0);
            let place = uniform(draw, dimension, 3.0);
            let velocity = if fall { vec![0.0; dimension] } else { uniform(draw, dimension, 1.0) };
            bodies.push((mass, place, velocity));
        }
        horizon = draw.log_uniform(0.5, 12.0);
    }
    let mut text = head(dimension, "stormer-verlet", horizon);
    writeln!(text, "newtonian_gravity = {{ constant = 1 }}\nparticles = [").ok();
    let mut names = Vec::new();
    for (number, (mass, place, velocity)) in bodies.iter().enumerate() {
        writeln!(
            text,
            "    {{ name = \"star{number}\", mass = {:?}, position = {}, velocity = {} }},",
            rounded(*mass),
            vector(place),
            vector(velocity)
        )
        .ok();
        names.push(format!("star{number}"));
    }
    writeln!(text, "]").ok();
    let mut observables = observables(&names[1..], dimension);
    observables.push("distance=star0,star1".to_owned());
    (text, observables)
}

/// A chain of rods that swings from a hook.
pub(super) fn rods(draw: &mut Draw) -> (String, Vec<String>) {
    let dimension = draw.between(2, 3);
    let count = draw.between(1, 3);
    let mut place = vec![0.0; dimension];
    let mut particles =
        format!("    {{ name = \"hook\", pinned = true, position = {} }},\n", vector(&place));
    let (mut rods, mut before) = (String::new(), "hook".to_owned());
    let mut names = Vec::new();
    let momentum = draw.chance(0.3);
    for number in 0..count {
        let (angle, length) = (PI * draw.symmetric(), draw.uniform(0.3, 1.5));
        place[0] += length * angle.sin();
        place[1] -= length * angle.cos();
        let mass = draw.log_uniform(0.1, 10.0);
        let mut velocity = String::new();
        if momentum && number == 0 {
            // Along the circle; in space also out of its plane.
            let speed = 3.0 * draw.symmetric();
            let mut v = vec![0.0; dimension];
            match dimension {
                2 => (v[0], v[1]) = (speed * angle.cos(), speed * angle.sin()),
                _ => v[2] = speed,
            }
            if count == 1 {
                let exact: Vec<String> = v.iter().map(|x| format!("{x:?}")).collect();
                velocity = format!(", velocity = [{}]", exact.join(", "));
            }
        }
        let exact: Vec<String> = place.iter().map(|x| format!("{x:?}")).collect();
        writeln!(
            particles,
            "    {{ name = \"bob{number}\", mass = {:?}, position = [{}]{velocity} }},",
            rounded(mass),
            exact.join(", ")
        )
        .ok();
        writeln!(rods, "    {{ between = [\"{before}\", \"bob{number}\"] }},").ok();
        before = format!("bob{number}");
        names.push(before.clone());
    }
    let horizon = draw.log_uniform(0.2, 4.0);
    let mut text = head(dimension, "rattle", horizon);
    let mut weight = vec![0.0; dimension];
    weight[1] = -9.81;
    write!(
        text,
        "uniform_gravity = {{ acceleration = {} }}\nparticles = [\n{particles}]\nrods = [\n{rods}]\n",
        vector(&weight)
    )
    .ok();
    (text, observables(&names, dimension))
}
