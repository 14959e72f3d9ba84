//! Random scenes of warm plates and of elastic solids.

use std::fmt::Write;

use stationary_trials::Draw;

use super::{head, rounded, vector};

/// A bar or a plate, warm somewhere, held at some of its sides.
pub(super) fn heat(draw: &mut Draw) -> (String, Vec<String>) {
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

/// A bar along a line, or a strip in the plane, that swings at its held end.
pub(super) fn elastic(draw: &mut Draw) -> (String, Vec<String>) {
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
