//! Bodies of scenes whose impacts happen at their instant: closed forms, the budget of energy, resuming, refusals.

use stationary_scene::Scene;

use crate::body_diagnostics::refused;
use crate::checkpoints::assert_resumes;

const WORDS: [&str; 2] = ["event-driven-2", "event-driven-4"];

fn bouncing(method: &str, step: f64) -> String {
    format!(
        "dimension = 3\nintegrator = \"{method}\"\nstep = {step}\nhorizon = 1\n\
         uniform_gravity = {{ acceleration = [0, 0, -10] }}\n\
         bodies = [{{ name = \"ball\", mass = 2, ball = 0.1, position = [0, 0, 1.1], \
         velocity = [0.3, 0, 0] }}]\n\
         [contact]\nrestitution = 0.5\nwalls = [{{ normal = [0, 0, 1], at = [0, 0, 0] }}]\n"
    )
}

/// It falls 1 m in `sqrt(0.2)` s, and leaves with half of its speed: `v = 0.5 sqrt(20)`.
#[test]
fn a_ball_bounces_where_and_when_galileo_says_whatever_the_step() {
    for method in WORDS {
        for step in [0.031_25, 0.015_625] {
            let run = Scene::parse("a.toml", &bouncing(method, step)).unwrap().run().unwrap();
            let fall = 0.2_f64.sqrt();
            let impacts = run.impacts();
            assert_eq!(impacts[0].count, 1);
            assert!((impacts[0].time - fall).abs() < 1e-9, "{}", impacts[0].time);
            let after = 0.875 - fall;
            let sample = run.times().iter().position(|&t| t == 0.875).unwrap();
            let z = 0.1 + 0.5 * 20.0_f64.sqrt() * after - 5.0 * after * after;
            let found = run.positions(sample);
            assert!((found[2] - z).abs() < 1e-9, "{method}: {} and {z}", found[2]);
            assert!((found[0] - 0.3 * 0.875).abs() < 1e-12);
        }
    }
}

/// Two bounces in the horizon take 3/4 of 20 J and of the 5 J that are left: the works say so.
#[test]
fn the_work_of_impacts_closes_the_budget() {
    for method in WORDS {
        let run = Scene::parse("a.toml", &bouncing(method, 0.031_25)).unwrap().run().unwrap();
        let energies = run.energies();
        let change = energies[energies.len() - 1] - energies[0];
        let works: f64 = run.works().iter().map(|(_, work)| work).sum();
        assert!(
            (change + 18.75).abs() < 1e-8 && (works - change).abs() < 1e-8,
            "{method}: {works} and {change}"
        );
        let pushed: f64 = run.contact_impulses().iter().map(|row| row.impulse[2]).sum();
        assert!(pushed > 0.0, "{method}: {pushed}");
    }
}

#[test]
fn it_resumes_to_the_same_bits() {
    for method in WORDS {
        let scene = Scene::parse("a.toml", &bouncing(method, 0.031_25)).unwrap();
        assert_resumes(&scene, &[2, 15, 30], method);
    }
}

#[test]
fn what_flight_has_no_place_for_is_refused() {
    let marked =
        bouncing("event-driven-2", 0.125).replace("\"event-driven-2\"", "<<\"event-driven-2\">>");
    let joint = "[[joints]]\nkind = \"ball\"\nbetween = [\"ball\", \"world\"]\nat = [0, 0, 1.1]\n";
    let held = "`event-driven-2` cannot step joints or rods: name `variational-rotation`";
    refused(
        &format!("{}{joint}", marked.replace("velocity = [0.3, 0, 0]", "velocity = [0, 0, 0]")),
        held,
    );
    let pusher = "[[particles]]\nname = \"pusher\"\npinned = true\nradius = 0.1\nposition = [9, 0, 1]\n\
                  [[motions]]\nof = \"pusher\"\nshift = [1, 0, 0]\nstrength = { step = [0, 1], at = 0.5 }\n";
    refused(
        &format!("{marked}{pusher}"),
        "`event-driven-2` cannot step pins that jump and hold rods or touch, which takes an infinite speed: \
         make it a `ramp`",
    );
    // Nothing meets without contact.
    let alone = marked.split("[contact]").next().unwrap();
    refused(
        alone,
        "`event-driven-2` cannot step bodies that never meet: add `[contact]`, or name `variational-rotation`",
    );
}

/// A ball that is laid on a wall rests from the start; one that flies past never does.
#[test]
fn the_summary_says_where_contact_lasted() {
    for method in WORDS {
        let laid = bouncing(method, 0.031_25).replace("[0, 0, 1.1]", "[0, 0, 0.1]");
        let run = Scene::parse("a.toml", &laid).unwrap().run().unwrap();
        let lasting = run.lasting_contact();
        assert_eq!(lasting.steps, 32);
        assert!((lasting.time - 1.0).abs() < 1e-12, "{lasting:?}");
        let words = run.summary().to_string();
        let line = "contact lasted in 32 of 32 steps, for 1.00 s in all: there the order is 1, at a 64th of the step";
        assert!(words.contains(line), "{words}");
        let flying = Scene::parse("a.toml", &bouncing(method, 0.031_25)).unwrap().run().unwrap();
        assert_eq!(flying.lasting_contact().steps, 0);
        assert!(!flying.summary().to_string().contains("lasted"));
    }
}
