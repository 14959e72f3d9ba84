//! The chooser on scenes whose answers are known.

use std::time::Duration;

use stationary_choose::{
    Extrapolated, Judgement, MeasuredRuns, Reference, Verdict, answer, preferred, refer,
};
use stationary_scene::Scene;
use stationary_scene::choose::{Change, Question, changed, emitted, scene_ladder};

use super::{LONG, asked, bounded_runs, ladder};

/// A planet on an ellipse about a heavy sun: e = 0.6, one year of 2 pi, three years.
const PLANET: &str = r#"
title = "A planet"
dimension = 2
integrator = "explicit-euler"
step = 0.01
horizon = 18.84
newtonian_gravity = { constant = 1 }
particles = [
    { name = "sun", mass = 1, position = [0, 0], velocity = [0, -2e-6] },
    { name = "planet", mass = 1e-6, position = [0.4, 0], velocity = [0, 2] },
]
"#;

/// A bob on a rod.
const PENDULUM: &str = r#"
dimension = 2
integrator = "rattle"
step = 0.001
horizon = 2
uniform_gravity = { acceleration = [0, -9.81] }
particles = [
    { name = "hook", position = [0, 0], pinned = true },
    { name = "bob", position = [1, 0], mass = 1 },
]
rods = [{ between = ["hook", "bob"] }]
"#;

/// A bob on two springs, of which one is stiff and the knot between them light.
const STIFF: &str = r#"
dimension = 2
integrator = "stormer-verlet"
step = 0.001
horizon = 3
uniform_gravity = { acceleration = [0, -9.81] }
particles = [
    { name = "hook", position = [0, 0], pinned = true },
    { name = "knot", position = [1, 0], mass = 0.01 },
    { name = "bob", position = [2, 0], mass = 1 },
]
springs = [
    { between = ["hook", "knot"], stiffness = 1000, rest_length = 1 },
    { between = ["knot", "bob"], stiffness = 10, rest_length = 1 },
]
"#;

#[test]
fn the_choice_keeps_its_promise_by_a_far_better_reference() {
    for text in [PLANET, PENDULUM] {
        let observable = if text == PLANET { "position=planet" } else { "position=bob" };
        for tolerance in [1e-1, 1e-2, 1e-3] {
            let (answer, mut runs) = asked(text, observable, tolerance);
            assert!(matches!(answer.verdict, Verdict::Chosen(_)), "{answer}");
            let families = preferred(&runs, 1e-3 * tolerance);
            let truth = refer(&mut runs, &families, 1e-3 * tolerance).unwrap();
            assert!(truth.uncertainty <= 1e-3 * tolerance);
            let at = answer.choice().unwrap().at;
            let course = runs.measure(at).whole().unwrap().clone();
            let error = truth.error(&course).unwrap();
            assert!(error <= tolerance, "{error:e}\n{answer}");
        }
    }
}

/// A planet on a circle, for a little less than a year.
const CIRCLE: &str = r#"
dimension = 2
integrator = "explicit-euler"
step = 0.01
horizon = 6
newtonian_gravity = { constant = 1 }
particles = [
    { name = "sun", mass = 1, position = [0, 0] },
    { name = "planet", mass = 1e-6, position = [1, 0], velocity = [0, 1] },
]
"#;

#[test]
fn the_deterministic_columns_are_these() {
    let (answer, _) = asked(CIRCLE, "position=planet", 1e-2);
    let expected = "\
method                       setting           work   error   verdict
explicit-euler               step = 0.3        1.0e0  2.2e-2  misses it, stopped at 1 of 20
symplectic-euler-drift-kick  step = 0.3        1.0e0  2.2e-2  misses it, stopped at 1 of 20
symplectic-euler-kick-drift  step = 0.3        1.0e0  2.3e-2  misses it, stopped at 1 of 20
stormer-verlet               step = 0.3        2.1e1  9.6e-2  misses it
stormer-verlet               step = 0.15       4.1e1  2.4e-2  misses it
nystrom-4                    step = 0.3        6.0e1  1.3e-3  meets it
dormand-prince-853           tolerance = 1e-4  9.0e1  1.6e-4  meets it
dormand-prince-853           tolerance = 1e-5  1.2e2  1.6e-4  meets it
";
    assert_eq!(answer.table().to_string(), expected);
    assert_eq!(answer.choice().unwrap().method, "nystrom-4");
}

#[test]
fn no_rung_is_recommended_that_was_not_run() {
    let (answer, runs) = asked(PLANET, "position=planet", 1e-2);
    let at = answer.choice().unwrap().at;
    assert!(runs.used().any(|(own, run)| own == at && run.whole().is_some()));
    for row in answer.runners_up() {
        assert!(row.work >= answer.choice().unwrap().work);
    }
}

#[test]
fn a_first_order_method_is_not_the_choice_for_four_digits() {
    let (answer, _) = asked(PLANET, "position=planet", 1e-4);
    let row = answer.choice().unwrap();
    assert!(!row.method.contains("euler"), "{answer}");
    let advice = answer.tolerances();
    assert!(
        advice.iter().any(|line| line.contains("dormand-prince-853 needs `tolerance = 1e-")),
        "{advice:?}"
    );
}

#[test]
fn the_emitted_scene_is_the_measured_run_and_says_why() {
    for (text, observable) in [(PLANET, "position=planet"), (PENDULUM, "energy")] {
        let ladder = ladder(text, &Question::new(observable));
        let mut runs = MeasuredRuns::new(ladder, LONG).unwrap();
        let answer = answer(&mut runs, 1e-2).unwrap();
        let row = answer.choice().unwrap().clone();
        let emitted = emitted("a.toml", text, &answer, ladder).unwrap().unwrap();
        assert!(emitted.contains("# Chosen by measurement"), "{emitted}");
        assert!(emitted.lines().all(|line| line.chars().count() <= 100), "{emitted}");
        let scene = Scene::parse("b.toml", &emitted).unwrap();
        assert_eq!(scene.stepping().name(), row.method);
        // The motion is that of the measured run, wherever both are sampled.
        let word = if observable == "energy" { "\"energy\"" } else { "{ position = \"planet\" }" };
        let emitted = changed(&emitted, &[Change::to("observables", format!("[{word}]"))]);
        let run = Scene::parse("c.toml", &emitted).unwrap().run().unwrap();
        let course = runs.measure(row.at).whole().unwrap().clone();
        let last = run.observed(run.times().len() - 1);
        let measured = course.values.last().unwrap();
        let off = last.iter().zip(measured).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off <= 1e-12 * course.scale, "{off:e}");
    }
}

#[test]
fn a_budget_that_is_over_recommends_nothing_that_did_not_run() {
    let ladder = ladder(PLANET, &Question::new("position=planet"));
    let mut runs = MeasuredRuns::new(ladder, Duration::from_nanos(1)).unwrap();
    let answer = answer(&mut runs, 1e-3).unwrap();
    assert!(answer.choice().is_none(), "{answer}");
    assert!(!answer.to_string().contains("cheapest within"));
}

#[test]
fn a_conserved_momentum_is_kept_by_the_coarsest_rung_that_is_another_motion_nowhere() {
    let (answer, _) = asked(PLANET, "angular-momentum", 1e-3);
    let row = answer.choice().unwrap();
    assert!(matches!(row.judgement, Some(Judgement::Meets(_))));
    // Far coarser steps keep it as well, to a planet that has left its orbit.
    let mut wrong = answer.rows.iter().filter(|row| row.word().starts_with("wrong physics"));
    assert!(wrong.next().is_some(), "{}", answer.table());
}

/// Twenty methods step back to the rods and err alike: one that is too coarse says so for all.
#[test]
fn what_confirms_a_long_swing_costs_no_more_than_64_runs_of_the_choice() {
    for horizon in [2.0, 8.0, 20.0] {
        let question = Question { horizon: Some(horizon), ..Question::new("position=bob") };
        let mut runs = MeasuredRuns::new(ladder(PENDULUM, &question), LONG).unwrap();
        let answer = answer(&mut runs, 1e-2).unwrap();
        assert!(matches!(answer.verdict, Verdict::Chosen(_)), "{answer}");
        let work = answer.choice().unwrap().work;
        assert!(answer.spent.total() <= 64 * work, "{horizon} s\n{answer}");
    }
}

/// A step of one's own choice costs many of what is just stable, and how many is seen on the way.
#[test]
fn what_is_just_stable_is_chosen_in_no_more_than_64_runs_of_it() {
    for tolerance in [1e-1, 1e-2, 1e-3, 1e-4] {
        let (answer, _) = asked(STIFF, "position=bob", tolerance);
        assert!(matches!(answer.verdict, Verdict::Chosen(_)), "{answer}");
        let work = answer.choice().unwrap().work;
        assert!(answer.spent.total() <= 64 * work, "{tolerance}\n{answer}");
    }
}

#[test]
fn the_horizon_is_a_parameter() {
    let question = Question { horizon: Some(1.0), ..Question::new("position=planet") };
    let mut runs = MeasuredRuns::new(ladder(PLANET, &question), LONG).unwrap();
    let answer = answer(&mut runs, 1e-3).unwrap();
    assert!(answer.heading.contains("up to 1 s"), "{}", answer.heading);
}

#[test]
fn what_cannot_be_asked_is_answered_with_what_can() {
    let refused = |question: &Question| {
        scene_ladder("a.toml", PLANET, question).map(|_| ()).unwrap_err().to_string()
    };
    let unknown = refused(&Question::new("energie"));
    assert!(
        unknown.contains("`energie`") && unknown.contains("did you mean `energy`"),
        "{unknown}"
    );
    let name = refused(&Question::new("position=plant"));
    assert!(name.contains("did you mean `planet`"), "{name}");
    for tolerance in [0.0, -1.0, f64::NAN, 1.0, f64::INFINITY] {
        let said = answer(&mut bounded_runs(PLANET, "energy"), tolerance).unwrap_err().to_string();
        assert!(said.starts_with("the tolerance must be"), "{said}");
    }
    let none = MeasuredRuns::new(ladder(PLANET, &Question::new("energy")), Duration::ZERO);
    assert!(none.unwrap_err().to_string().starts_with("the budget must be"));
    for horizon in [0.0, f64::NAN, f64::INFINITY, -1.0] {
        let said = refused(&Question { horizon: Some(horizon), ..Question::new("energy") });
        assert!(said.starts_with("the horizon must be"), "{said}");
    }
}

#[test]
fn an_extrapolated_reference_is_no_worse_than_it_says() {
    let mut runs = bounded_runs(PLANET, "position=planet");
    let family = |runs: &MeasuredRuns<'_>, name: &str| {
        runs.ladder().families.iter().position(|family| family.name == name).unwrap()
    };
    let verlet = family(&runs, "stormer-verlet");
    let fine = Reference::make(&mut runs, &[verlet], 1e-5).unwrap();
    assert_eq!(fine.extrapolated, Extrapolated::Yes);
    let dormand = family(&runs, "dormand-prince-853");
    let truth = Reference::make(&mut runs, &[dormand], 1e-9).unwrap();
    let error = truth.error(&fine.course).unwrap();
    assert!(error <= fine.uncertainty + truth.uncertainty, "{error:e} {:e}", fine.uncertainty);
}

/// Two that are held as one are one run, which agrees with itself.
#[test]
fn no_two_tolerances_of_the_ladder_are_held_as_one() {
    let mut runs = bounded_runs(PLANET, "position=planet");
    for (name, loosest) in [
        ("dormand-prince-853", 1e-4),
        ("radau-iia-5", 1e-4),
        ("bdf-5", 1e-3),
        ("dormand-prince-54", 1e-4),
    ] {
        let family = runs.ladder().families.iter().position(|family| family.name == name).unwrap();
        assert_eq!(runs.family(family).rungs[0].setting, loosest);
        let known = Reference::at(&mut runs, family, 1).unwrap();
        assert!(known.uncertainty > 1e-9, "{name}: {:e}", known.uncertainty);
    }
}

#[test]
fn a_scene_that_names_a_tolerance_learns_which_one_to_name() {
    let text = PENDULUM
        .replace("integrator = \"rattle\"", "integrator = \"dormand-prince-853\"\ntolerance = 1e-6")
        .replace("rods = [{ between = [\"hook\", \"bob\"] }]", "")
        + "springs = [{ between = [\"hook\", \"bob\"], stiffness = 500 }]\n";
    let (answer, _) = asked(&text, "position=bob", 1e-3);
    let advice = answer.tolerances().join("\n");
    let (_, set) = advice.split_once("dormand-prince-853 needs `tolerance = ").unwrap();
    let set: f64 = set.split('`').next().unwrap().parse().unwrap();
    // What it says is true: against a run that is far better.
    let at = |tolerance: f64| {
        let changes = [
            Change::to("tolerance", format!("{tolerance:e}")),
            Change::to("observables", "[{ position = \"bob\" }]"),
        ];
        let run = Scene::parse("a.toml", &changed(&text, &changes)).unwrap().run().unwrap();
        run.observed(run.times().len() - 1).to_vec()
    };
    let off = at(set).iter().zip(at(1e-12)).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    assert!(off <= 1e-3 * 1.5, "{advice}\n{off:e}");
    assert!(answer.to_string().contains("for a true error of at most 1e-3, "), "{answer}");
}

#[test]
fn a_method_that_is_too_dear_says_so_and_is_asked_all_the_same_where_the_scene_names_it() {
    let named = STIFF.replace("\"stormer-verlet\"", "\"dormand-prince-853\"\ntolerance = 1e-6");
    let said = |text: &str| asked(text, "position=bob", 1e-2).0.tolerances().join("\n");
    let (of_another, of_its_own) = (said(STIFF), said(&named));
    assert!(
        of_another.contains("dormand-prince-853 was stopped at the cost limit"),
        "{of_another}"
    );
    assert!(of_its_own.contains("dormand-prince-853 needs `tolerance = "), "{of_its_own}");
}
