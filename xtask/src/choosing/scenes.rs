//! Random scenes as the text of files, and a random question to each.

mod bodies;
mod continua;
mod particles;

use stationary_trials::Draw;

use bodies::{body, friction, impacts};
use continua::{elastic, heat};
use particles::{encounter, oscillator, rods, springs};

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
