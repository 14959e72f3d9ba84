//! Five scenes of the study of contact beside drake's error-controlled steps (Kurtz and Castro 2025): error against
//! time, each engine against its own limit of small steps.
//!
//! Drake's bodies sink into each other by micrometres and creep where they stick; so each engine has a limit of its
//! own, and a block's stop in closed form says how far that is from Coulomb's law.

use std::fs;
use std::process::Command;

use nalgebra::Vector3;
use stationary_rigid::Rotation;

use self::scenes::{Scene, scenes};
use self::ways::{MOMENTS, Way, apart, limit, run};
use crate::on_processor;

#[path = "../../../xtask/src/studies/contact/work_precision/scenes.rs"]
mod scenes;
#[path = "../../../xtask/src/studies/contact/work_precision/ways.rs"]
mod ways;

/// The scenes, and their shapes in the words of the script.
const SHAPES: [(&str, &str); 5] = [
    ("block", "box 0.5 0.5 0.5"),
    ("rocking block", "box 0.1 0.05 0.4"),
    ("Euler's disc", "cylinder 0.005 0.1 0"),
    ("rattleback", "ellipsoid 0.1 0.02 0.015"),
    ("pile", "box 0.5 0.5 0.5"),
];
/// What drake is asked for, the last for its limit.
const ACCURACIES: [f64; 7] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8];
const ERRORS: [f64; 5] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5];

/// Points of bodies at the moments.
type Places = Vec<Vec<Vector3<f64>>>;

/// What a setting took, and how far it was from its engine's limit and from the closed form, in sizes.
struct Point {
    engine: &'static str,
    setting: String,
    seconds: f64,
    error: f64,
    closed: Option<f64>,
}

/// A scene as the script reads it.
fn text(scene: &Scene, shape: &str) -> String {
    let numbers = |v: &[f64]| v.iter().map(|x| format!("{x:e}")).collect::<Vec<_>>().join(" ");
    let mut text = format!("gravity {}\n", numbers(scene.gravity.as_slice()));
    text += &format!("duration {} {MOMENTS}\n", scene.duration);
    for ((body, motion), collider) in scene.bodies.iter().zip(&scene.motions).zip(&scene.colliders)
    {
        let friction = collider.friction;
        let turned = numbers(&collider.place.rotation.quaternion());
        let (mass, moments) = (body.mass(), numbers(body.moments().as_slice()));
        text += &format!("body {mass:e} {moments} {shape} {friction} {turned}\n");
        let pose = &motion.pose;
        let turned = numbers(&pose.rotation.quaternion());
        let at = [pose.translation, motion.velocity, motion.angular_velocity];
        let [place, velocity, spin] = at.map(|v| numbers(v.as_slice()));
        text += &format!("at {place} {turned} {velocity} {spin}\n");
    }
    text + &format!("floor {} 0 0 1\n", scene.colliders[0].friction)
}

/// The points that errors are of, from poses (place and quaternion) of all bodies at all moments.
fn points(scene: &Scene, poses: &[f64]) -> Places {
    let of = |pose: &[f64]| {
        let centre = Vector3::from_column_slice(&pose[..3]);
        let turn = [pose[3], pose[4], pose[5], pose[6]];
        let turn = Rotation::from_quaternion(turn).expect("a quaternion");
        [centre, centre + turn.rotate(&(Vector3::x() * scene.size))]
    };
    let moment = |poses: &[f64]| poses.chunks_exact(7).flat_map(of).collect();
    poses.chunks_exact(7 * scene.bodies.len()).map(moment).collect()
}

/// Where the closed form has the points, where there is one.
fn closed(scene: &Scene) -> Option<Places> {
    let known = scene.known?;
    let moment = |k: usize| {
        let t = scene.duration * k as f64 / MOMENTS as f64;
        (0..scene.bodies.len())
            .flat_map(|b| [known(b, t), known(b, t) + Vector3::x() * scene.size])
            .collect()
    };
    Some((1..=MOMENTS).map(moment).collect())
}

/// Drake's runs: seconds and places of each accuracy.
fn theirs(scene: &Scene, shape: &str) -> Option<Vec<(f64, f64, Places)>> {
    let python = std::env::var("PYTHON").ok()?;
    let file = std::env::temp_dir().join(format!("{}.scene", scene.name.replace([' ', '\''], "-")));
    fs::write(&file, text(scene, shape)).ok()?;
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/cenic.py");
    let accuracies = ACCURACIES.map(|a| format!("{a:e}"));
    let run = Command::new(python).arg(script).arg(&file).args(accuracies).output().ok()?;
    let said = String::from_utf8(run.stdout).ok()?;
    let line = |(line, accuracy): (&str, f64)| {
        let numbers: Option<Vec<f64>> = line.split(' ').map(|number| number.parse().ok()).collect();
        match numbers.as_deref() {
            Some([seconds, _, poses @ ..]) => Some((accuracy, *seconds, points(scene, poses))),
            _ => {
                println!("drake at {accuracy:e}: {line}");
                None
            }
        }
    };
    Some(said.lines().zip(ACCURACIES).filter_map(line).collect())
}

fn ours(scene: &Scene) -> Vec<(Way, f64, Places)> {
    let pile = scene.name == "pile";
    let fixed = [3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5];
    let fixed = fixed.into_iter().filter(|&h| !pile || h >= 1e-3).map(Way::Fixed);
    let chosen = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5].into_iter();
    let chosen = chosen.filter(|&a| a == 1e-1 || !(pile || scene.name == "Euler's disc"));
    let chosen = chosen.map(|a| Way::Chosen(a * scene.size));
    let instant = [1e-2, 1e-3, 1e-4].into_iter().filter(|_| !pile).map(Way::AtTheInstant);
    let took = |way: Way| {
        let start = on_processor();
        let places = run(scene, way).ok()?.places;
        Some((way, on_processor() - start, places))
    };
    fixed.chain(chosen).chain(instant).filter_map(took).collect()
}

fn measured(scene: &Scene, shape: &str) -> Vec<Point> {
    let exact = closed(scene);
    let point = |engine, setting, seconds, limit: &Places, places: &Places| Point {
        engine,
        setting,
        seconds,
        error: apart(places, limit) / scene.size,
        closed: exact.as_ref().map(|exact| apart(places, exact) / scene.size),
    };
    let mut all = Vec::new();
    if let Some(mut runs) = theirs(scene, shape)
        && let Some((_, _, limit)) = runs.pop()
    {
        let of = |(a, seconds, places): &(f64, f64, Places)| {
            point("drake", format!("accuracy {a:.0e}"), *seconds, &limit, places)
        };
        all.extend(runs.iter().map(of));
    }
    if let Ok(limit) = run(scene, limit(scene).0) {
        let of = |(way, seconds, places): &(Way, f64, Places)| {
            let setting = format!("{} {:.0e}", way.name(), way.setting());
            point("ours", setting, *seconds, &limit.places, places)
        };
        all.extend(ours(scene).iter().map(of));
    }
    all
}

/// The least time of an engine that is within an error.
fn least<'a>(points: &'a [Point], engine: &str, error: f64) -> Option<&'a Point> {
    let within = points.iter().filter(|p| p.engine == engine && p.error <= error);
    within.min_by(|a, b| a.seconds.total_cmp(&b.seconds))
}

/// Prints each run, and the least time for each error.
pub fn print() {
    let all = scenes().expect("scenes");
    for (name, shape) in SHAPES {
        let Some(scene) = all.iter().find(|scene| scene.name == name) else { continue };
        let points = measured(scene, shape);
        println!("\n{name}: {} s, errors in sizes, each against its own limit", scene.duration);
        println!("| engine | setting | time, ms | error | from the closed form |");
        println!("| --- | --- | --- | --- | --- |");
        for Point { engine, setting, seconds, error, closed } in &points {
            let closed = closed.map_or("-".to_owned(), |closed| format!("{closed:.1e}"));
            println!("| {engine} | {setting} | {:.2} | {error:.1e} | {closed} |", 1e3 * seconds);
        }
        println!("\n| error | drake, ms | ours, ms | ours over drake | ours by |");
        println!("| --- | --- | --- | --- | --- |");
        for error in ERRORS {
            let [drake, ours] = ["drake", "ours"].map(|engine| least(&points, engine, error));
            let ms =
                |p: Option<&Point>| p.map_or("-".to_owned(), |p| format!("{:.2}", 1e3 * p.seconds));
            let ratio = drake.zip(ours).map(|(drake, ours)| ours.seconds / drake.seconds);
            let ratio = ratio.map_or("-".to_owned(), |ratio| format!("{ratio:.3}"));
            let by = ours.map_or("-", |p| &p.setting);
            println!("| {error:.0e} | {} | {} | {ratio} | {by} |", ms(drake), ms(ours));
        }
    }
}
