//! The page that plays a run: one HTML file that needs nothing else, no network and no library.
//!
//! ```text
//! player/page.html       what stands where            player/page.css      how it looks
//! player/motion.js       the samples, and numbers     player/camera.js     from space to the canvas
//! player/stage.js        a moment of the scene        player/names.js      names where there is room
//! player/surface.js      solids, with a depth buffer  player/shaders.js    its programs
//! player/painter.js      solids, far ones first       player/balls.js      balls and their spin
//! player/colours.js      light, a field's scale       player/graph.js      a scene on a line
//! player/charts.js       energy and observables       player/controls.js   time, pointer, keys
//! ```
//! Solids are drawn by WebGL; where a browser has none, by the painter on a canvas of two dimensions.
//! The samples travel in the page as 32 bit numbers from a middle that has 64, in base64: seven
//! digits of the scene's size. An observable travels as its changes since the start, so that a drift
//! of one part in 1e12 is seen. A page has at most about 10 MB: of a longer run samples are shown
//! evenly thinned, and the page says so; a scene of too many particles is not played.

mod charts;

use std::io;
use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use charts::{Chart, charts};
use serde::Serialize;
use stationary_chart::{escaped, significant, variables};

use crate::model::particle::Motion;
use crate::run::samples::Run;
use crate::show::body_surface::BodySurface;
use crate::show::drawing::{Face, thinned};

/// Particles, lines and faces of a scene that is played.
const PARTICLES: usize = 30_000;
const PIECES: usize = 250_000;

/// Coordinates that travel in the page.
const NUMBERS: usize = 1 << 20;

/// Samples of a chart, and charts.
const CHART_SAMPLES: usize = 2_000;
const CHARTS: usize = 24;

/// Paths in the page's colours.
const FOLLOWED: usize = 60;

const PAGE: &str = include_str!("player/page.html");
const STYLE: &str = include_str!("player/page.css");
const SCRIPTS: [&str; 12] = [
    include_str!("player/motion.js"),
    include_str!("player/camera.js"),
    include_str!("player/stage.js"),
    include_str!("player/colours.js"),
    include_str!("player/balls.js"),
    include_str!("player/painter.js"),
    include_str!("player/shaders.js"),
    include_str!("player/surface.js"),
    include_str!("player/names.js"),
    include_str!("player/graph.js"),
    include_str!("player/charts.js"),
    include_str!("player/controls.js"),
];

/// What the page's scripts read.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Data<'a> {
    dimension: usize,
    units: Units<'a>,
    view: [f64; 3],
    /// The height of a floor, where the scene has a downward direction and no walls.
    floor: Option<f64>,
    names: Vec<&'a str>,
    followed: Vec<usize>,
    /// The radius of each followed particle's mark, where it has none of its own.
    sizes: Vec<f64>,
    /// Particles that have a radius, and it, in the scene's units.
    round: String,
    radii: String,
    /// How each of them is turned at each sample, where they are bodies, and then each body with a
    /// surface: an angle in the plane, a quaternion in space, scalar first.
    turns: String,
    /// Bodies that are seen by a surface, whose points are counted after the particles.
    surfaces: Vec<Surface>,
    pinned: Vec<usize>,
    /// Centres and radii of what nothing enters.
    balls: Vec<([f64; 3], f64)>,
    /// Corners of what is drawn of walls, which nothing enters either.
    walls: Vec<[[f64; 3]; 4]>,
    /// Pairs of particles; faces are three particles and a colour.
    springs: String,
    rods: String,
    edges: String,
    faces: String,
    /// Whether the sides of faces are drawn.
    wired: bool,
    /// Rods that broke, and when.
    broken: Vec<(usize, f64)>,
    times: String,
    /// The middle, from which positions count.
    origin: [f64; 3],
    positions: String,
    /// What colours the vertices, where heat flows.
    field: Option<Field>,
    chart_times: String,
    charts: Vec<Chart>,
}

/// Points of a body in its axes, and the particle at its centre.
#[derive(Serialize)]
struct Surface {
    centre: usize,
    points: String,
}

/// A number a particle and a sample.
#[derive(Serialize)]
struct Field {
    title: &'static str,
    unit: &'static str,
    least: f64,
    largest: f64,
    values: String,
}

#[derive(Serialize)]
struct Units<'a> {
    length: &'a str,
    time: &'a str,
}

/// Writes the page.
pub(crate) fn write(run: &Run, out: &mut impl Write) -> io::Result<()> {
    let scene = &run.scene;
    let samples = thinned(run.times().len(), NUMBERS / numbers(run).max(1));
    let (data, note) = if too_large(run) {
        let note = "This scene has more than a page can play. The tables and the files for ParaView \
                    have all of it.";
        (None, note.to_owned())
    } else {
        (Some(data(run, &samples)), note(run, samples.len()))
    };
    let subtitle = format!(
        "{}, {} steps of {} {unit}, to t = {} {unit}",
        scene.stepping,
        run.cost.steps,
        significant(scene.timing.step(), 6),
        significant(run.times().last().copied().unwrap_or_default(), 6),
        unit = scene.units.time,
    );
    let label = format!("The motion of: {}", scene.title);
    // A closing tag in a name would end the element.
    let json = serde_json::to_string(&data)?.replace('<', "\\u003c");
    let script = if data.is_some() { SCRIPTS.concat() } else { String::new() };
    let style = variables(":root") + STYLE;
    fill(
        out,
        PAGE,
        &[
            ("title", &escaped(&scene.title)),
            ("subtitle", &escaped(&subtitle)),
            ("label", &escaped(&label)),
            ("note", &escaped(&note)),
            ("style", &style),
            ("data", &json),
            ("script", &script),
        ],
    )
}

/// The template with its `{{words}}` replaced, in one pass: values are not searched for words.
fn fill(out: &mut impl Write, template: &str, values: &[(&str, &str)]) -> io::Result<()> {
    let mut pieces = template.split("{{");
    out.write_all(pieces.next().unwrap_or_default().as_bytes())?;
    for piece in pieces {
        let (word, text) = piece.split_once("}}").unwrap_or(("", piece));
        let value = values.iter().find(|(name, _)| *name == word).map_or("", |(_, value)| value);
        out.write_all(value.as_bytes())?;
        out.write_all(text.as_bytes())?;
    }
    Ok(())
}

/// Numbers of a sample.
fn numbers(run: &Run) -> usize {
    let scene = &run.scene;
    let each = scene.dimension + usize::from(scene.heat.is_some());
    let of_a_turn = if scene.dimension == 3 { 4 } else { 1 };
    each * scene.particles.len() + of_a_turn * turning(run).len()
}

fn too_large(run: &Run) -> bool {
    let scene = &run.scene;
    let surfaces: usize = run.surfaces().flat_map(|(.., s)| s).map(|s| s.triangles.len()).sum();
    let lines = scene.lines().count() + scene.rods.len() + surfaces;
    // Faces are searched for, which of too many particles takes long.
    scene.particles.len() > PARTICLES || lines + scene.surface().len() > PIECES
}

fn note(run: &Run, shown: usize) -> String {
    let all = run.times().len();
    let samples = match shown == all {
        true => format!("All {all} samples are shown."),
        false => format!(
            "{shown} of {all} samples are shown, evenly chosen; the tables beside this page have all."
        ),
    };
    let charts = match charts(run).count() > CHARTS {
        true => format!(" The first {CHARTS} observables have charts."),
        false => String::new(),
    };
    let turns = match (turning(run).is_empty(), run.scene.dimension) {
        (true, _) => "",
        (false, 3) => ", and what is round turns the shorter way",
        // Whole turns count in the plane.
        (false, _) => ", and what is round turns evenly",
    };
    format!("{samples} Between samples points move on straight lines{turns}.{charts}")
}

fn data<'a>(run: &'a Run, samples: &[usize]) -> Data<'a> {
    let scene = &run.scene;
    let followed = scene.moving(FOLLOWED);
    let origin = middle(run, samples);
    let broken = run.broken.iter().map(|broken| (broken.rod, broken.time)).collect();
    let positions = samples.iter().flat_map(|&sample| {
        let axes = origin.iter().take(scene.dimension).cycle();
        run.positions(sample).iter().zip(axes).map(|(x, from)| x - from)
    });
    let chart_samples = thinned(run.times().len(), CHART_SAMPLES);
    let time = |&sample: &usize| run.times()[sample];
    let drawn = Drawn::of(run);
    Data {
        dimension: scene.dimension,
        units: Units { length: &scene.units.length, time: &scene.units.time },
        view: scene.view,
        floor: floor(run, samples),
        names: scene.particles.iter().map(|particle| particle.name.as_str()).collect(),
        sizes: sizes(run, &followed),
        round: indices(round(run)),
        radii: singles(round(run).map(|particle| scene.particles[particle].radius)),
        turns: turns(run, samples),
        surfaces: drawn.surfaces,
        followed,
        // What is heated does not move.
        pinned: scene.pins().filter(|_| scene.heat.is_none()).collect(),
        balls: balls(run),
        walls: run.walls(),
        springs: indices(scene.wires().flatten()),
        rods: indices(scene.rods.iter().flat_map(|rod| rod.ends)),
        edges: indices(scene.edges.iter().copied().chain(drawn.lines).flatten()),
        faces: indices(scene.surface().into_iter().chain(drawn.faces).flat_map(|face| {
            let [a, b, c] = face.corners;
            [a, b, c, face.body]
        })),
        wired: scene.bodies.is_empty(),
        broken,
        times: doubles(samples.iter().map(time)),
        origin,
        positions: singles(positions),
        field: scene.heat.as_ref().map(|_| temperatures(run, samples)),
        chart_times: doubles(chart_samples.iter().map(time)),
        charts: charts(run).take(CHARTS).map(|chart| chart.encoded(&chart_samples)).collect(),
    }
}

fn balls(run: &Run) -> Vec<([f64; 3], f64)> {
    let fixed = run.scene.contact.iter().flat_map(|contact| &contact.balls);
    fixed.map(|ball| (ball.centre, ball.radius)).collect()
}

/// Particles that have a radius of their own.
fn round(run: &Run) -> impl Iterator<Item = usize> {
    let all = run.scene.particles.iter().enumerate();
    all.filter(|(_, particle)| particle.radius > 0.0).map(|(index, _)| index)
}

/// Surfaces of bodies, with the lines and faces between their points, which are counted on.
#[derive(Default)]
struct Drawn {
    surfaces: Vec<Surface>,
    lines: Vec<[usize; 2]>,
    faces: Vec<Face>,
}

impl Drawn {
    fn of(run: &Run) -> Self {
        let (mut drawn, mut before) = (Drawn::default(), run.scene.particles.len());
        for (body, centre, surfaces) in run.surfaces() {
            let BodySurface { points, triangles, lines } = BodySurface::joined(surfaces);
            drawn.lines.extend(lines.into_iter().map(|ends| ends.map(|end| before + end)));
            drawn.faces.extend(
                triangles
                    .into_iter()
                    .map(|corners| Face { corners: corners.map(|corner| before + corner), body }),
            );
            before += points.len();
            let points = singles(points.into_iter().flatten());
            drawn.surfaces.push(Surface { centre, points });
        }
        drawn
    }
}

/// The bodies whose turns are drawn: round ones, then those with a surface; no particles, which do not turn.
fn turning(run: &Run) -> Vec<usize> {
    let body = |particle: usize| match run.scene.particles[particle].motion {
        Motion::Carried { body, .. } => Some(body),
        _ => None,
    };
    round(run).filter_map(body).chain(run.surfaces().map(|(body, ..)| body)).collect()
}

/// How they are turned, sample after sample.
fn turns(run: &Run, samples: &[usize]) -> String {
    let turning = turning(run);
    let of_sample = |&sample: &usize| {
        let bodies = run.bodies(sample);
        let turn = |&body: &usize| match run.scene.dimension {
            3 => bodies[body].orientation.to_vec(),
            _ => vec![bodies[body].angle],
        };
        turning.iter().flat_map(turn).collect::<Vec<f64>>()
    };
    singles(samples.iter().flat_map(of_sample))
}

/// The temperatures, and the ends of their scale: those of all samples, or further apart where
/// nothing but rounding would be between them.
fn temperatures(run: &Run, samples: &[usize]) -> Field {
    let all = || samples.iter().flat_map(|&sample| run.temperatures(sample).iter().copied());
    let (least, largest) =
        all().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), x| (l.min(x), m.max(x)));
    let [least, largest] = charts::beyond_rounding([least, largest], run.cost.steps);
    Field {
        title: "temperature",
        // The vocabulary has no word for it.
        unit: "the scene's unit",
        least,
        largest,
        values: singles(all()),
    }
}

/// The middle of all positions: 32 bits from there are seven digits of the scene's size.
fn middle(run: &Run, samples: &[usize]) -> [f64; 3] {
    let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    for &sample in samples {
        for (k, &x) in run.positions(sample).iter().enumerate() {
            let [least, largest] = &mut bounds[k % run.scene.dimension];
            (*least, *largest) = (least.min(x), largest.max(x));
        }
    }
    let middle = bounds.map(|[least, largest]| least + 0.5 * (largest - least));
    middle.map(|x| if x.is_finite() { x } else { 0.0 })
}

/// Just below everything, where gravity points down the third axis.
fn floor(run: &Run, samples: &[usize]) -> Option<f64> {
    let [x, y, z] = run.scene.gravity.acceleration?;
    let walls = run.scene.contact.iter().any(|contact| !contact.walls.is_empty());
    if run.scene.dimension < 3 || z >= 0.0 || x.hypot(y) > -0.1 * z || walls {
        return None;
    }
    let heights =
        samples.iter().flat_map(|&sample| run.positions(sample).iter().skip(2).step_by(3));
    let [least, largest] = heights
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], &z| [least.min(z), most.max(z)]);
    let floor = least - 0.02 * (largest - least);
    floor.is_finite().then_some(floor)
}

/// Marks grow with the cube root of the mass.
fn sizes(run: &Run, followed: &[usize]) -> Vec<f64> {
    let mass = |particle: &usize| match run.scene.particles[*particle].motion {
        Motion::Free { mass, .. } => mass,
        _ => 0.0,
    };
    let heaviest = followed.iter().map(mass).fold(f64::MIN_POSITIVE, f64::max);
    let size = |particle| 3.2 + 3.3 * (mass(particle) / heaviest).cbrt();
    followed.iter().map(|particle| (100.0 * size(particle)).round() / 100.0).collect()
}

fn encoded<const N: usize>(numbers: impl Iterator<Item = [u8; N]>) -> String {
    STANDARD.encode(numbers.flatten().collect::<Vec<u8>>())
}

/// Numbers of 32 bits, as the page's scripts read them.
fn singles(numbers: impl Iterator<Item = f64>) -> String {
    encoded(numbers.map(|x| (x as f32).to_le_bytes()))
}

fn doubles(numbers: impl Iterator<Item = f64>) -> String {
    encoded(numbers.map(f64::to_le_bytes))
}

fn indices(numbers: impl Iterator<Item = usize>) -> String {
    encoded(numbers.map(|k| (k as u32).to_le_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_not_searched_for_words() {
        let mut out = Vec::new();
        fill(&mut out, "<{{a}}|{{b}}|{{c}}>", &[("a", "{{b}}"), ("b", "x")]).unwrap();
        assert_eq!(out, b"<{{b}}|x|>");
    }

    #[test]
    fn numbers_travel_in_little_endian_order() {
        assert_eq!(singles([1.0, -2.0].into_iter()), "AACAPwAAAMA=");
        assert_eq!(indices([1, 258].into_iter()), "AQAAAAIBAAA=");
    }
}
