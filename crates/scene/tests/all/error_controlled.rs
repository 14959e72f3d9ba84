//! Bodies of scenes that touch in steps chosen by their error: closed forms, the accuracy that was asked for, reading
//! off, resuming, refusals.

use stationary_scene::{Control, Observer, Progress, Run, Scene};

use crate::body_diagnostics::refused;
use crate::checkpoints::assert_resumes;

const G: f64 = 10.0;

/// A box that is pushed over a floor in the plane, on two corners or as a disc that does not turn.
fn sliding(tolerance: f64, step: f64) -> String {
    format!(
        "dimension = 2\nintegrator = \"error-controlled\"\ntolerance = {tolerance:e}\nstep = {step}\nhorizon = 2\n\
         uniform_gravity = {{ acceleration = [0, -{G}] }}\n\
         bodies = [{{ name = \"block\", mass = 2, box = [0.6, 0.8], position = [0, 0.4], velocity = [3, 0] }}]\n\
         [contact]\nfriction = 0.25\nwalls = [{{ normal = [0, 1], at = [0, 0] }}]\n"
    )
}

/// The block's size: the distance of its corners from its centre.
const SIZE: f64 = 0.5;

/// `x = 3 t - 5/4 t^2` until it stops at `t = 1.2`: 1.8 m in all.
fn slid(t: f64) -> f64 {
    let t = t.min(1.2);
    3.0 * t - 1.25 * t * t
}

fn dropped(tolerance: f64, step: f64) -> String {
    format!(
        "dimension = 3\nintegrator = \"error-controlled\"\ntolerance = {tolerance:e}\nstep = {step}\nhorizon = 1\n\
         uniform_gravity = {{ acceleration = [0, 0, -{G}] }}\n\
         bodies = [{{ name = \"ball\", mass = 2, ball = 0.1, position = [0, 0, 1.1], velocity = [0.3, 0, 0] }}]\n\
         [contact]\nrestitution = 0.5\nwalls = [{{ normal = [0, 0, 1], at = [0, 0, 0] }}]\n"
    )
}

/// The height of the ball, whose second bounce comes `sqrt(20)/10` s after the first.
fn height(t: f64) -> f64 {
    let (fall, speed) = (0.2_f64.sqrt(), 20.0_f64.sqrt());
    let up = |speed: f64, t: f64| 0.1 + speed * t - 5.0 * t * t;
    match t {
        t if t < fall => 1.1 - 5.0 * t * t,
        t if t < 2.0 * fall => up(0.5 * speed, t - fall),
        t => up(0.25 * speed, t - 2.0 * fall),
    }
}

fn run(text: &str) -> Run {
    Scene::parse("a.toml", text).unwrap().run().unwrap()
}

fn worst(run: &Run, coordinate: usize, truth: fn(f64) -> f64) -> f64 {
    let off = |k: usize| (run.positions(k)[coordinate] - truth(run.times()[k])).abs();
    (0..run.times().len()).map(off).fold(0.0, f64::max)
}

#[test]
fn a_block_slides_to_rest_as_coulomb_says_to_the_accuracy_that_is_asked_for() {
    let mut before = f64::INFINITY;
    for tolerance in [1e-2, 1e-3, 1e-4, 1e-5] {
        let run = run(&sliding(tolerance, 0.05));
        let off = worst(&run, 0, slid);
        assert!(off < SIZE * tolerance, "{tolerance}: {off}");
        assert!(off < 0.5 * before, "{tolerance}: {off} after {before}");
        before = off;
        assert!(run.chosen_steps().accepted > 0 && run.unsettled().steps == 0);
    }
}

#[test]
fn a_ball_bounces_as_galileo_says_to_the_accuracy_that_is_asked_for() {
    let mut before = f64::INFINITY;
    // A ball alone has no size but one.
    for tolerance in [1e-2, 1e-3, 1e-4, 1e-5] {
        let run = run(&dropped(tolerance, 0.05));
        let off = worst(&run, 2, height);
        assert!(off < 4.0 * tolerance, "{tolerance}: {off}");
        assert!(off < 0.5 * before, "{tolerance}: {off} after {before}");
        before = off;
        let [first, second] = [run.impacts()[0].time, run.impacts()[1].time];
        let fall = 0.2_f64.sqrt();
        assert!((first - fall).abs() < tolerance && (second - 2.0 * fall).abs() < 4.0 * tolerance);
    }
}

/// Two bounces take 3/4 of 20 J and of the 5 J that are left; what is left of the budget falls with the tolerance.
#[test]
fn the_work_of_impacts_closes_the_budget_to_the_tolerance() {
    let mut before = f64::INFINITY;
    for tolerance in [1e-2, 1e-4, 1e-6] {
        let run = run(&dropped(tolerance, 0.05));
        let energies = run.energies();
        let change = energies[energies.len() - 1] - energies[0];
        let works: f64 = run.works().iter().map(|(_, work)| work).sum();
        let left = (change - works).abs();
        assert!((works + 18.75).abs() < 200.0 * tolerance, "{tolerance}: {works}");
        assert!(left < 0.2 * before, "{tolerance}: {left} after {before}");
        before = left;
    }
}

/// What is read off where nothing ends is as near to the truth, and costs no steps.
#[test]
fn a_fine_step_costs_none_and_is_as_accurate() {
    let [coarse, fine] = [0.05, 0.000_5].map(|step| run(&sliding(1e-4, step)));
    assert!(worst(&fine, 0, slid) < SIZE * 1e-4);
    let [few, many] = [&coarse, &fine].map(|run| run.chosen_steps().accepted);
    assert!(many < 2 * few, "{many} and {few}");
    assert_eq!(fine.times().len(), 4001);
}

#[test]
fn it_resumes_to_the_same_bits() {
    for (name, text) in
        [("chosen-slide", sliding(1e-3, 0.005)), ("chosen-bounce", dropped(1e-3, 0.005))]
    {
        assert_resumes(&Scene::parse("a.toml", &text).unwrap(), &[2, 3, 50, 117, 199], name);
    }
}

/// Looks within every step.
struct Looks(Vec<(f64, f64)>);

impl Observer for Looks {
    fn stepped(&mut self, _: Progress<'_>) -> Control {
        Control::Continue
    }

    fn keep(&mut self, _: &stationary_scene::Checkpoint) {}

    fn parts(&mut self, _: u64) -> &[f64] {
        &[0.25, 0.75, 1.0]
    }

    fn inside(&mut self, time: f64, observed: &[f64]) {
        self.0.push((time, observed[2]));
    }
}

#[test]
fn what_is_within_a_step_is_read_off_and_changes_nothing() {
    let text =
        dropped(1e-4, 0.05).replace("horizon", "observables = [{ position = \"ball\" }]\nhorizon");
    let scene = Scene::parse("a.toml", &text).unwrap();
    let mut looks = Looks(Vec::new());
    let run = scene.run_from(None, &mut looks).unwrap();
    assert_eq!(looks.0.len(), 60);
    for (time, found) in looks.0 {
        assert!((found - height(time)).abs() < 4e-4, "{time}: {found}");
    }
    let last = run.times().len() - 1;
    assert_eq!(run.positions(last), scene.run().unwrap().positions(last));
}

#[test]
fn the_summary_says_how_many_steps_were_chosen_and_what_the_budget_leaves_out() {
    let words = run(&sliding(1e-3, 0.05)).summary().to_string();
    assert!(words.contains("steps chosen by their error"), "{words}");
    assert!(words.contains("friction that lasts, and the error of the steps"), "{words}");
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("error-controlled");
    run(&sliding(1e-3, 0.05)).write(&folder).unwrap();
    assert!(folder.join("events.csv").exists() && !folder.join("contacts.csv").exists());
}

#[test]
fn what_it_has_no_place_for_is_refused() {
    let word = "\"error-controlled\"";
    let marked = dropped(1e-3, 0.125).replace(word, &format!("<<{word}>>"));
    let joint = "[[joints]]\nkind = \"ball\"\nbetween = [\"ball\", \"world\"]\nat = [0, 0, 1.1]\n";
    refused(
        &format!("{}{joint}", marked.replace("velocity = [0.3, 0, 0]", "velocity = [0, 0, 0]")),
        "`error-controlled` cannot step joints or rods: name `variational-rotation`",
    );
    refused(
        &format!("drag = {{ coefficient = 1 }}\n{marked}"),
        "`error-controlled` cannot step loads, motors, drag, dampers, a frame that turns or changing gravity: \
         name `variational-rotation`",
    );
    refused(
        marked.split("[contact]").next().unwrap(),
        "`error-controlled` cannot step bodies that never meet: add `[contact]`, or name `variational-rotation`",
    );
    refused(
        &marked.replace("tolerance = 1e-3\n", ""),
        "this integrator chooses its own steps and needs a `tolerance`",
    );
    let wide = dropped(1e-3, 0.125).replace("1e-3", "<<2>>");
    refused(&wide, "the tolerance is 2e0; it must be at least 1e-14 and below 1");
}

/// The rounding of a place is no accuracy: it is refused, not missed.
#[test]
fn a_tolerance_below_the_rounding_of_places_is_an_error() {
    let far = dropped(1e-12, 0.125).replace("[0, 0, 1.1]", "[1e6, 0, 1.1]");
    let error = Scene::parse("a.toml", &far).unwrap().run().unwrap_err();
    assert!(error.to_string().contains("above the rounding of the coordinates"), "{error}");
}
