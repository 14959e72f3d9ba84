//! Random scenes of bodies and of balls: in flight, at walls, and on a slope.

use std::fmt::Write;

use stationary_trials::Draw;

use super::{head, rounded, uniform, vector};

/// A rigid body, thrown, or on a joint in its weight.
pub(super) fn body(draw: &mut Draw) -> (String, Vec<String>) {
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

/// A ball between walls, or one that falls onto a floor again and again.
pub(super) fn impacts(draw: &mut Draw) -> (String, Vec<String>) {
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
pub(super) fn friction(draw: &mut Draw) -> (String, Vec<String>) {
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
