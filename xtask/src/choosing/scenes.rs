//! Random scenes as the text of files, and a random question to each.

use std::f64::consts::{PI, TAU};
use std::fmt::Write;

use stationary_trials::Draw;

/// A scene and what is asked of it.
pub struct Asked {
    /// Which sort of scene it is.
    pub family: &'static str,
    /// The scene's file.
    pub text: String,
    /// The observable as a word of the command line.
    pub observable: String,
    /// The error that may be made.
    pub tolerance: f64,
}

type Family = (&'static str, fn(&mut Draw) -> (String, Vec<String>));

const FAMILIES: [Family; 9] = [
    ("springs", springs),
    ("oscillator", oscillator),
    ("encounter", encounter),
    ("rods", rods),
    ("body", body),
    ("heat", heat),
    ("impacts", impacts),
    ("friction", friction),
    ("elastic", elastic),
];

/// A case. Particles are drawn twice as often as the rest.
pub fn asked(draw: &mut Draw) -> Asked {
    let (family, scene) = FAMILIES[[0, 1, 2, 0, 1, 2, 3, 4, 5, 6, 7, 8][draw.below(12)]];
    let (text, observables) = scene(draw);
    let observable = draw.one_of(&observables);
    let tolerance = rounded(10.0_f64.powf(-draw.uniform(1.0, 6.0)));
    let asked = Asked { family, text, observable, tolerance };
    draw.note(format!("choose --observable {} --tolerance {tolerance:e}", asked.observable));
    asked.text.lines().for_each(|line| draw.note(line));
    asked
}

/// Three digits are enough, and short to read.
fn rounded(x: f64) -> f64 {
    format!("{x:.2e}").parse().unwrap_or(x)
}

fn vector(x: &[f64]) -> String {
    let numbers: Vec<String> = x.iter().map(|&x| format!("{:?}", rounded(x))).collect();
    format!("[{}]", numbers.join(", "))
}

/// The keys of the whole scene; a step that divides the horizon, which the chooser replaces.
fn head(dimension: usize, integrator: &str, horizon: f64) -> String {
    let step = rounded(horizon / 100.0);
    format!(
        "dimension = {dimension}\nintegrator = \"{integrator}\"\nstep = {step:?}\n\
         horizon = {:?}\n",
        step * 100.0
    )
}

fn uniform(draw: &mut Draw, dimension: usize, size: f64) -> Vec<f64> {
    (0..dimension).map(|_| size * draw.symmetric()).collect()
}

/// Beads on springs, soft and stiff, about pins; some with drag, with weight, or at rest.
fn springs(draw: &mut Draw) -> (String, Vec<String>) {
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
fn oscillator(draw: &mut Draw) -> (String, Vec<String>) {
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
fn encounter(draw: &mut Draw) -> (String, Vec<String>) {
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
fn rods(draw: &mut Draw) -> (String, Vec<String>) {
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

/// A rigid body, thrown, or on a joint in its weight.
fn body(draw: &mut Draw) -> (String, Vec<String>) {
    let dimension = draw.between(2, 3);
    let jointed = draw.chance(0.5);
    let horizon = draw.log_uniform(0.3, 4.0);
    let integrator = if dimension == 3 { "variational-rotation" } else { "stormer-verlet" };
    let mut text = head(dimension, integrator, horizon);
    let mut weight = vec![0.0; dimension];
    weight[dimension - 1] = -9.81;
    if jointed || draw.chance(0.5) {
        writeln!(text, "uniform_gravity = {{ acceleration = {} }}", vector(&weight)).ok();
    }
    let mass = rounded(draw.log_uniform(0.1, 10.0));
    let sides: Vec<f64> = (0..dimension).map(|_| rounded(draw.uniform(0.1, 1.0))).collect();
    let place = uniform(draw, dimension, 1.0);
    let turn = if draw.chance(0.3) { draw.log_uniform(5.0, 50.0) } else { 3.0 };
    let (rotation, spin) = if dimension == 3 {
        (vector(&uniform(draw, 3, 1.5)), vector(&uniform(draw, 3, turn)))
    } else {
        (
            format!("{:?}", rounded(draw.symmetric())),
            format!("{:?}", rounded(turn * draw.symmetric())),
        )
    };
    let velocity = if jointed {
        String::new()
    } else {
        format!("velocity = {}\n", vector(&uniform(draw, dimension, 2.0)))
    };
    let point: Vec<f64> = sides.iter().map(|side| 0.5 * side).collect();
    write!(
        text,
        "[[bodies]]\nname = \"box\"\nmass = {mass:?}\nbox = {}\npoints = [{}]\nposition = {}\n\
         rotation = {rotation}\nangular_velocity = {spin}\n{velocity}",
        vector(&sides),
        vector(&point),
        vector(&place)
    )
    .ok();
    if jointed {
        let kind = if dimension == 3 { "ball" } else { "pin" };
        write!(
            text,
            "[[joints]]\nkind = \"{kind}\"\nbetween = [\"world\", \"box\"]\nat = {}\n",
            vector(&vec![0.0; dimension])
        )
        .ok();
    }
    let all =
        ["energy", "kinetic-energy", "position=box", "position=box.0", "angular_velocity=box"];
    (text, all.map(String::from).to_vec())
}

/// A bar or a plate, warm somewhere, held at some of its sides.
fn heat(draw: &mut Draw) -> (String, Vec<String>) {
    let dimension = draw.between(1, 2);
    let diffusivity = rounded(draw.log_uniform(0.01, 10.0));
    let cells = 2 * draw.between(1, 5);
    let horizon = draw.log_uniform(0.01, 3.0) / diffusivity;
    let mut text = head(dimension, "implicit-euler", horizon);
    let (shape, middle) = match dimension {
        1 => (format!("{{ kind = \"bar\", size = [1], cells = [{cells}] }}"), vec![0.5]),
        _ => {
            let across = 2 * draw.between(1, 2);
            let shape =
                format!("{{ kind = \"rectangle\", size = [1, 0.5], cells = [{cells}, {across}] }}");
            (shape, vec![0.5, 0.25])
        }
    };
    write!(text, "[heat]\nname = \"plate\"\nshape = {shape}\ndiffusivity = {diffusivity:?}\n").ok();
    let held = draw.below(4);
    if held != 1 {
        let radius = rounded(draw.uniform(0.3, 0.8));
        let at: Vec<f64> = middle.iter().map(|x| x * draw.uniform(0.5, 1.5)).collect();
        writeln!(
            text,
            "warm = [{{ at = {}, radius = {radius:?}, temperature = 10 }}]",
            vector(&at)
        )
        .ok();
    }
    let part = |part: &str, temperature: f64| {
        format!("{{ part = \"{part}\", temperature = {temperature:?} }}")
    };
    match held {
        0 => {}
        1 => {
            writeln!(text, "held = [{}, {}]", part("left", 0.0), part("right", 20.0)).ok();
        }
        2 => {
            writeln!(text, "held = [{}]", part("left", 0.0)).ok();
        }
        _ => {
            let warmth = rounded(10.0 * draw.symmetric());
            writeln!(text, "held = [{}, {}]", part("left", warmth), part("right", 5.0)).ok();
        }
    }
    writeln!(text, "marks = {{ middle = {} }}", vector(&middle)).ok();
    let all = ["temperature=plate.middle", "temperature=plate.middle", "heat", "dirichlet-energy"];
    (text, all.map(String::from).to_vec())
}

/// A ball between walls, or one that falls onto a floor again and again.
fn impacts(draw: &mut Draw) -> (String, Vec<String>) {
    let dimension = draw.between(1, 2);
    let falls = draw.chance(0.5);
    let restitution = if draw.chance(0.4) { 1.0 } else { rounded(draw.uniform(0.4, 1.0)) };
    let radius = 0.1;
    let mut place = vec![0.0; dimension];
    let mut velocity = vec![0.0; dimension];
    let mut walls = Vec::new();
    for axis in 0..dimension {
        place[axis] = draw.uniform(0.5, 2.5);
        velocity[axis] = 3.0 * draw.symmetric();
        let mut normal = vec![0.0; dimension];
        let mut at = vec![0.0; dimension];
        normal[axis] = 1.0;
        walls.push(format!("{{ normal = {}, at = {} }}", vector(&normal), vector(&at)));
        if !falls {
            (normal[axis], at[axis]) = (-1.0, 3.0);
            walls.push(format!("{{ normal = {}, at = {} }}", vector(&normal), vector(&at)));
        }
        if falls && dimension == 2 && axis == 0 {
            walls.pop();
        }
    }
    let horizon = draw.log_uniform(0.5, 6.0);
    let mut text = head(dimension, "stormer-verlet", horizon);
    if falls {
        let mut weight = vec![0.0; dimension];
        weight[dimension - 1] = -9.81;
        writeln!(text, "uniform_gravity = {{ acceleration = {} }}", vector(&weight)).ok();
    }
    write!(
        text,
        "particles = [{{ name = \"ball\", mass = 2, radius = {radius}, position = {}, velocity = {} }}]\n\
         [contact]\nrestitution = {restitution:?}\n",
        vector(&place),
        vector(&velocity)
    )
    .ok();
    if draw.chance(0.7) {
        writeln!(text, "when = \"at-the-instant\"").ok();
    }
    writeln!(text, "walls = [{}]", walls.join(", ")).ok();
    (text, ["position=ball", "position=ball", "energy"].map(String::from).to_vec())
}

/// A block that slides on a slope, or stays.
fn friction(draw: &mut Draw) -> (String, Vec<String>) {
    let angle = draw.uniform(0.0, 0.7);
    let friction = rounded(draw.uniform(0.05, 0.9));
    let size = [0.4, 0.3, 0.2];
    let speed = if draw.chance(0.5) { 0.0 } else { draw.uniform(0.2, 3.0) };
    let (along, normal) = ([angle.cos(), angle.sin()], [-angle.sin(), angle.cos()]);
    let place =
        [2.0 * along[0] + 0.5 * size[2] * normal[0], 2.0 * along[1] + 0.5 * size[2] * normal[1]];
    let mut text = head(3, "variational-rotation", draw.log_uniform(0.3, 2.0));
    write!(
        text,
        "uniform_gravity = {{ acceleration = [0, 0, -9.81] }}\n[[bodies]]\nname = \"block\"\nmass = 2\n\
         box = {}\nposition = [{:?}, 0, {:?}]\nrotation = [0, {:?}, 0]\nvelocity = [{:?}, 0, {:?}]\n\
         [contact]\nfriction = {friction:?}\nwalls = [{{ normal = [{:?}, 0, {:?}], at = [0, 0, 0] }}]\n",
        vector(&size),
        place[0],
        place[1],
        -angle,
        -speed * along[0],
        -speed * along[1],
        normal[0],
        normal[1]
    )
    .ok();
    (text, ["position=block", "velocity=block"].map(String::from).to_vec())
}

/// A bar along a line, or a strip in the plane, that swings at its held end.
fn elastic(draw: &mut Draw) -> (String, Vec<String>) {
    let dimension = draw.between(1, 2);
    let young = rounded(draw.log_uniform(1e3, 1e7));
    let crossing = (1000.0 / young).sqrt();
    let horizon = draw.log_uniform(0.5, 10.0) * crossing;
    let mut text = head(dimension, "stormer-verlet", horizon);
    let speed = draw.log_uniform(1e-3, 0.2) / crossing;
    let (shape, size, velocity, tip) = match dimension {
        1 => {
            let cells = 1 << draw.between(0, 3);
            (
                format!("\"bar\", size = [1], cells = [{cells}]"),
                "section = 0.01",
                vec![speed],
                vec![1.0],
            )
        }
        _ => {
            let cells = 2 * draw.between(1, 3);
            let shape = format!("\"rectangle\", size = [1, 0.25], cells = [{cells}, 1]");
            (shape, "thickness = 0.1", vec![0.3 * speed, 0.2 * speed], vec![1.0, 0.25])
        }
    };
    let materials: &[&str] = match dimension {
        1 => &["saint-venant-kirchhoff"],
        _ => &["saint-venant-kirchhoff", "neo-hookean", "linear"],
    };
    let material = draw.one_of(materials);
    write!(
        text,
        "[[solids]]\nname = \"bar\"\nshape = {{ kind = {shape} }}\n{size}\ndensity = 1000\n\
         material = \"{material}\"\nyoung = {young:?}\npoisson = 0.3\n{}velocity = {}\nmarks = {{ tip = {} }}\n",
        if draw.chance(0.7) { "pinned = [\"left\"]\n" } else { "" },
        vector(&velocity),
        vector(&tip)
    )
    .ok();
    let all =
        ["position=bar.tip", "position=bar.tip", "energy", "kinetic-energy", "velocity=bar.tip"];
    (text, all.map(String::from).to_vec())
}
