//! A random scene, and its text as it is seen.

use std::fmt::Write as _;

use nalgebra::Vector3;

use super::seen::{
    ACCELERATION, DAMPING, ENERGY, FORCE, LENGTH, MASS, NUMBER, STIFFNESS, Seen, TIME, TURNING,
    VELOCITY,
};
use crate::Draw;

const OF_PARTICLES: [&str; 12] = [
    "stormer-verlet",
    "symplectic-euler-drift-kick",
    "runge-kutta-4",
    "nystrom-4",
    "suzuki-4",
    "blanes-moan-nystrom-6",
    "kahan-li-8",
    "implicit-midpoint",
    "trapezoid",
    "gauss-legendre-4",
    "newmark",
    "generalized-alpha",
];
/// Those that take drag and dampers.
const DRAGGED: [&str; 4] =
    ["stormer-verlet", "symplectic-euler-drift-kick", "newmark", "generalized-alpha"];
const OF_BODIES: [&str; 3] = ["variational-rotation", "axis-rotations", "exact-rotation"];

/// A table of the scene, a line each; what stands in it depends on how it is seen.
type Line = Box<dyn Fn(&Seen) -> String>;

/// A random scene.
pub(super) struct Drawn {
    pub(super) dimension: usize,
    method: &'static str,
    step: f64,
    steps: usize,
    /// What has an order, by the word of its list.
    pub(super) lists: Vec<(&'static str, Vec<Line>)>,
    rest: Vec<Line>,
}

impl Drawn {
    /// The text as it is seen, with lists in these orders.
    pub(super) fn text(&self, seen: &Seen, orders: &[Vec<usize>]) -> String {
        let (step, method, steps) = (seen.number(self.step, TIME), self.method, self.steps);
        let mut out = format!(
            "dimension = {}\nintegrator = \"{method}\"\nstep = {step}\nhorizon = \"= {steps}*{step}\"\n",
            self.dimension
        );
        for line in &self.rest {
            let _ = writeln!(out, "{}", line(seen));
        }
        for ((word, lines), order) in self.lists.iter().zip(orders) {
            let lines: Vec<_> = order.iter().map(|&k| lines[k](seen)).collect();
            let _ = writeln!(out, "{word} = [\n    {},\n]", lines.join(",\n    "));
        }
        out
    }
}

fn vector(draw: &mut Draw, dimension: usize, size: f64) -> Vector3<f64> {
    let mut x = Vector3::zeros();
    x.iter_mut().take(dimension).for_each(|x| *x = size * draw.symmetric());
    x
}

/// What is turned by in the plane is the third axis.
fn turning(draw: &mut Draw, dimension: usize, size: f64) -> Vector3<f64> {
    let turn = vector(draw, 3, size);
    if dimension == 2 { Vector3::z() * turn.z } else { turn }
}

/// Where the k-th thing is: so far from the others that nothing overlaps.
fn apart(draw: &mut Draw, k: usize, dimension: usize, jitter: f64) -> Vector3<f64> {
    let cell = Vector3::new((k % 2) as f64, (k / 2) as f64, 0.0);
    cell * 1.5 + vector(draw, dimension, jitter)
}

/// A random scene; places are off by `off` of it, each to a side.
pub(super) fn drawn(draw: &mut Draw, off: f64) -> Drawn {
    let dimension = draw.between(2, 3);
    let bodies = draw.chance(0.6);
    let (step, steps) = (draw.log_uniform(1e-3, 2e-2), draw.between(5, 60));
    let mut scene = Drawn {
        dimension,
        method: "stormer-verlet",
        step,
        steps,
        lists: Vec::new(),
        rest: Vec::new(),
    };
    if draw.chance(0.7) {
        let g = vector(draw, dimension, 10.0);
        scene.rest.push(Box::new(move |seen| {
            format!("uniform_gravity = {{ acceleration = {} }}", seen.vector(g, ACCELERATION))
        }));
    }
    let dragged = draw.chance(0.3);
    if dragged {
        let drag = draw.log_uniform(1e-2, 1.0);
        scene.rest.push(Box::new(move |seen| {
            format!("drag = {{ coefficient = {} }}", seen.number(drag, DAMPING))
        }));
    }
    if bodies {
        of_bodies(draw, &mut scene, off)
    } else {
        of_particles(draw, &mut scene, dragged, off)
    }
    let (force, on) = (vector(draw, dimension, 5.0), if bodies { "b0" } else { "p0" });
    if draw.chance(0.3) && (bodies || dragged || scene.method == "stormer-verlet") {
        let (amplitude, frequency) = (draw.symmetric(), draw.log_uniform(0.1, 5.0));
        let load = move |seen: &Seen| {
            let strength = format!(
                "{{ sine = {amplitude:?}, frequency = {} }}",
                seen.number(frequency, TURNING)
            );
            format!(
                "{{ on = \"{on}\", force = {}, strength = {strength} }}",
                seen.vector(force, FORCE)
            )
        };
        scene.lists.push(("loads", vec![Box::new(load)]));
    }
    draw.note(scene.text(&Seen::plainly(dimension), &in_order(&scene)));
    scene
}

/// The orders in which lists were drawn.
pub(super) fn in_order(scene: &Drawn) -> Vec<Vec<usize>> {
    scene.lists.iter().map(|(_, lines)| (0..lines.len()).collect()).collect()
}

fn of_particles(draw: &mut Draw, scene: &mut Drawn, dragged: bool, off: f64) {
    let (dimension, count) = (scene.dimension, draw.between(1, 5));
    scene.method = if dragged { draw.one_of(&DRAGGED) } else { draw.one_of(&OF_PARTICLES) };
    let (mut all, mut springs): (Vec<Line>, Vec<Line>) = (Vec::new(), Vec::new());
    for k in 0..count {
        let x =
            apart(draw, k, dimension, 0.5) + Vector3::repeat(off * (1.0 - 2.0 * (k % 2) as f64));
        let v = vector(draw, dimension, 3.0);
        let mass = draw.log_uniform(0.1, 10.0);
        all.push(Box::new(move |seen| {
            let (x, v, m) = (seen.place(x), seen.vector(v, VELOCITY), seen.number(mass, MASS));
            format!("{{ name = \"p{k}\", mass = {m}, position = {x}, velocity = {v} }}")
        }));
        if k > 0 && draw.chance(0.7) {
            let (stiffness, rest) = (draw.log_uniform(1.0, 100.0), draw.uniform(0.5, 2.0));
            let damped = dragged && draw.chance(0.5);
            let damping = if damped { draw.uniform(0.0, 1.0) } else { 0.0 };
            let strain = if draw.chance(0.3) { "green" } else { "cauchy" };
            springs.push(Box::new(move |seen| {
                let [c, l] = [seen.number(stiffness, STIFFNESS), seen.number(rest, LENGTH)];
                let d = seen.number(damping, DAMPING);
                format!(
                    "{{ between = [\"p{}\", \"p{k}\"], stiffness = {c}, rest_length = {l}, damping = {d}, \
                     strain = \"{strain}\" }}",
                    k - 1
                )
            }));
        }
    }
    if count > 1 && draw.chance(0.3) {
        let constant = draw.log_uniform(0.1, 5.0);
        scene.rest.push(Box::new(move |seen| {
            format!("newtonian_gravity = {{ constant = {} }}", seen.number(constant, [3, -2, -1]))
        }));
    }
    scene.lists.push(("particles", all));
    if !springs.is_empty() {
        scene.lists.push(("springs", springs));
    }
}

fn of_bodies(draw: &mut Draw, scene: &mut Drawn, off: f64) {
    let (dimension, count) = (scene.dimension, draw.between(1, 3));
    let (jointed, touching) = (draw.chance(0.5), draw.chance(0.5));
    if dimension == 3 {
        let free = !jointed && !touching;
        scene.method = if free { draw.one_of(&OF_BODIES) } else { OF_BODIES[0] };
    }
    let (mut all, mut joints): (Vec<Line>, Vec<Line>) = (Vec::new(), Vec::new());
    for k in 0..count {
        let x =
            apart(draw, k, dimension, 0.1) + Vector3::repeat(off * (1.0 - 2.0 * (k % 2) as f64));
        let (turn, mass) = (turning(draw, dimension, 2.0), draw.log_uniform(0.1, 10.0));
        let sides: Vec<f64> = (0..3).map(|_| draw.uniform(0.2, 0.7)).collect();
        let shape = draw.below(3);
        let (v, w) = (vector(draw, dimension, 3.0), turning(draw, dimension, 3.0));
        all.push(Box::new(move |seen| {
            let [a, b] = [seen.number(sides[0], LENGTH), seen.number(0.4 * sides[1], LENGTH)];
            let shape = match shape {
                0 => format!("box = {}", seen.own(&sides[..seen.dimension], LENGTH)),
                1 => format!("ball = {b}"),
                _ => format!("capsule = {{ length = {a}, radius = {b} }}"),
            };
            let (x, r, m) = (seen.place(x), seen.rotation(turn), seen.number(mass, MASS));
            let w = match seen.dimension {
                2 => seen.number(w.z, TURNING),
                _ => seen.own(w.as_slice(), TURNING),
            };
            let moves =
                format!(", velocity = {}, angular_velocity = {w}", seen.vector(v, VELOCITY));
            let moves = if jointed { String::new() } else { moves };
            format!(
                "{{ name = \"b{k}\", mass = {m}, {shape}, position = {x}, rotation = {r}{moves} }}"
            )
        }));
        if jointed && draw.chance(0.7) {
            joints.push(joint(draw, dimension, k));
        }
    }
    scene.lists.push(("bodies", all));
    if !joints.is_empty() {
        scene.lists.push(("joints", joints));
    }
    if touching {
        let (restitution, friction) = (draw.unit(), draw.uniform(0.05, 1.0));
        let (normal, at) = (Vector3::y(), Vector3::y() * -1.1);
        scene.rest.push(Box::new(move |seen| {
            let wall = format!("{{ normal = {}, at = {} }}", seen.vector(normal, NUMBER), seen.place(at));
            format!(
                "contact = {{ restitution = {restitution:?}, friction = {friction:?}, walls = [{wall}] }}"
            )
        }));
    }
}

fn joint(draw: &mut Draw, dimension: usize, k: usize) -> Line {
    let kinds = if dimension == 2 { ["pin", "slider", "pin"] } else { ["ball", "slider", "hinge"] };
    let (kind, at, axis) =
        (draw.one_of(&kinds), vector(draw, dimension, 1.0), vector(draw, dimension, 1.0));
    let axis = axis + Vector3::x() * 2.0;
    let above = if k == 0 || draw.chance(0.3) { "world".to_owned() } else { format!("b{}", k - 1) };
    let [stiffness, damping, rest] =
        [draw.uniform(1.0, 20.0), draw.uniform(0.0, 1.0), draw.symmetric()];
    let sprung = draw.chance(0.4);
    Box::new(move |seen| {
        let mut more = String::new();
        if kind == "slider" || kind == "hinge" {
            let _ = write!(more, ", axis = {}", seen.vector(axis, NUMBER));
        }
        if sprung && (kind == "pin" || kind == "hinge") {
            let [c, d] = [seen.number(stiffness, ENERGY), seen.number(damping, [2, -1, 1])];
            let _ = write!(more, ", stiffness = {c}, damping = {d}, rest = {rest:?}");
        }
        format!(
            "{{ kind = \"{kind}\", between = [\"{above}\", \"b{k}\"], at = {}{more} }}",
            seen.place(at)
        )
    })
}
