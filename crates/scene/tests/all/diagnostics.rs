//! Every kind of mistake in a scene's text: what is said of it, where, and what is suggested.
//!
//! In these texts `<<` and `>>` stand around the word that the caret must be under.

use stationary_scene::{Fault, Scene, SceneError};

const HEAD: &str = "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.1\nhorizon = 1\n";

const BALL: &str = "[[particles]]\nname = \"ball\"\nmass = 1\nposition = [0, 0]\n";

const HOOK: &str = "[[particles]]\nname = \"hook\"\nposition = [0, 1]\npinned = true\n";

const NET: &str = "[[nets]]\nname = \"net\"\nrows = 3\ncolumns = 3\nspacing = 0.1\norigin = [0, 0]\n\
                   particle_mass = 1\nstiffness = 9\n";

/// The whole error for a text, which must be wrong.
fn error(text: &str) -> SceneError {
    Scene::parse("scene.toml", text).expect_err("the text is wrong")
}

/// Asserts the message, the place, the line and the caret; returns the whole for further questions.
#[track_caller]
fn refused(marked: &str, message: &str) -> String {
    let (before, rest) = marked.split_once("<<").expect("a mark");
    let (word, after) = rest.split_once(">>").expect("the end of the mark");
    let text = format!("{before}{word}{after}");
    let shown = error(&text).to_string();

    let line = before.matches('\n').count() + 1;
    let in_line = before.rsplit('\n').next().unwrap_or_default();
    let column = in_line.chars().count();
    let (margin, word) = (line.to_string().len(), word.lines().next().unwrap_or_default());
    let source = text.lines().nth(line - 1).unwrap_or_default();
    let expected = [
        format!("error: {message}"),
        format!("{:margin$}--> scene.toml:{line}:{}", "", column + 1),
        format!("{:margin$} |", ""),
        format!("{line} | {source}"),
        format!("{:margin$} | {:column$}{}", "", "", "^".repeat(word.chars().count().max(1))),
    ];
    let expected = expected.join("\n");
    assert!(shown.starts_with(&expected), "\n{shown}\n\nexpected\n\n{expected}\n");
    assert!(!shown[expected.len()..].starts_with('^'), "the caret is too long:\n{shown}");
    shown
}

/// The same, and the nearest word and the words allowed.
#[track_caller]
fn suggested(marked: &str, message: &str, nearest: &str, allowed: &str) {
    let shown = refused(marked, message);
    assert!(shown.contains(&format!("^ did you mean `{nearest}`?")), "{shown}");
    assert!(shown.contains(&format!("= allowed here: {allowed}")), "{shown}");
}

#[test]
fn an_unknown_field_is_shown_with_the_nearest_one() {
    let message = |word| format!("unknown field `{word}`");
    suggested(
        &format!("{HEAD}<<sample-every>> = 2\n{BALL}"),
        &message("sample-every"),
        "sample_every",
        "`title`, `parameters`, `dimension`, `integrator`",
    );
    suggested(
        &format!("{HEAD}{BALL}<<velosity>> = [0, 0]\n"),
        &message("velosity"),
        "velocity",
        "`name`, `mass`, `position`, `velocity`, `momentum`, `pinned`",
    );
    suggested(
        &format!("{HEAD}{BALL}[[springs]]\n<<stiffnes>> = 1\n"),
        &message("stiffnes"),
        "stiffness",
        "`between`, `stiffness`, `rest_length`, `damping`, `strain`",
    );
    suggested(
        &format!("{HEAD}{NET}<<spcing>> = 1\n"),
        &message("spcing"),
        "spacing",
        "`name`, `rows`, `columns`",
    );
    suggested(
        &format!("{HEAD}[units]\n<<lenght>> = \"m\"\n"),
        &message("lenght"),
        "length",
        "`length`, `time`, `mass`",
    );
    suggested(
        &format!("{HEAD}[<<uniform_gravty>>]\nacceleration = [0, 0]\n"),
        &message("uniform_gravty"),
        "uniform_gravity",
        "`title`",
    );
    // One word is allowed there; it is far from the mistake.
    let shown = refused(&format!("{HEAD}[newtonian_gravity]\n<<G>> = 1\n"), "unknown field `G`");
    assert!(shown.ends_with("^\n  = allowed here: `constant`"), "{shown}");
}

#[test]
fn an_unknown_integrator_is_shown_with_the_nearest_one() {
    let text = HEAD.replace("\"stormer-verlet\"", "<<\"stormer-verlat\">>");
    suggested(
        &format!("{text}{BALL}"),
        "unknown integrator `stormer-verlat`",
        "stormer-verlet",
        "`explicit-euler`, `implicit-euler`",
    );
    let text = HEAD.replace("\"stormer-verlet\"", "<<\"verlet\">>");
    suggested(&text, "unknown integrator `verlet`", "stormer-verlet", "`explicit-euler`");
}

#[test]
fn an_unknown_strain_corner_or_observable_is_shown_with_the_nearest_one() {
    let spring = "[[springs]]\nbetween = [\"hook\", \"ball\"]\nstiffness = 1\n";
    suggested(
        &format!("{HEAD}{BALL}{HOOK}{spring}strain = <<\"caucy\">>\n"),
        "unknown strain `caucy`",
        "cauchy",
        "`cauchy`, `green`",
    );
    suggested(
        &format!("{HEAD}{NET}pinned = [\"top-left\", <<\"topright\">>]\n"),
        "unknown corner or side `topright`",
        "top-right",
        "`top-left`, `top-right`, `bottom-left`, `bottom-right`, `top`",
    );
    suggested(
        &format!("{HEAD}observables = [\"energy\", <<\"angular_momentum\">>]\n{BALL}"),
        "unknown observable `angular_momentum`",
        "angular-momentum",
        "`energy`, `kinetic-energy`",
    );
    suggested(
        &format!("{HEAD}observables = [<<\"position\">>]\n{BALL}"),
        "unknown observable `position`",
        "{ position = \"a name\" }",
        "`energy`",
    );
    suggested(
        &format!("{HEAD}observables = [{{ <<postion>> = \"ball\" }}]\n{BALL}"),
        "unknown field `postion`",
        "position",
        "`position`, `velocity`, `distance`",
    );
}

#[test]
fn an_unknown_particle_is_shown_with_the_nearest_one() {
    let allowed = "`ball`, `hook`";
    let text = format!(
        "{HEAD}{BALL}{HOOK}[[springs]]\nstiffness = 1\nbetween = [\"hook\", <<\"bal\">>]\n"
    );
    suggested(&text, "unknown particle `bal`", "ball", allowed);
    for observable in ["position = <<\"balll\">>", "velocity = <<\"balll\">>"] {
        let text = format!("{HEAD}observables = [{{ {observable} }}]\n{BALL}{HOOK}");
        suggested(&text, "unknown particle `balll`", "ball", allowed);
    }
    let text =
        format!("{HEAD}observables = [{{ distance = [<<\"bell\">>, \"hook\"] }}]\n{BALL}{HOOK}");
    suggested(&text, "unknown particle `bell`", "ball", allowed);
    // A net has nine vertices here, and their names are known as well.
    let text = format!("{HEAD}observables = [{{ position = <<\"net.0.3\">> }}]\n{NET}");
    let shown = refused(&text, "unknown particle `net.0.3`");
    assert!(shown.contains("did you mean `net.0."), "{shown}");
}

#[test]
fn a_value_of_the_wrong_kind_says_what_is_expected() {
    let wrong = |text: &str, message: &str| refused(&format!("{HEAD}{BALL}{text}"), message);
    wrong("velocity = [0, <<\"1\">>]\n", "expected a number, got the text \"1\"");
    wrong("velocity = <<1>>\n", "expected a list in brackets, got 1");
    wrong("pinned = <<1>>\n", "expected `true` or `false`, got 1");
    let head = HEAD.replace("dimension = 2", "dimension = <<2.5>>");
    refused(&head, "expected a whole number, got 2.5");
    let head = HEAD.replace("dimension = 2", "dimension = <<-2>>");
    refused(&head, "expected a whole number, got -2");
    refused(
        &format!("{HEAD}observables = [<<3>>]\n"),
        "expected an observable such as \"energy\" or { position = \"a name\" }, got 3",
    );
    refused(&format!("<<>>{}", HEAD.replace("step = 0.1\n", "")), "missing field `step`");
    refused(&format!("{HEAD}<<[[particles]]>>\nname = \"a\"\n"), "missing field `position`");
}

#[test]
fn what_is_not_toml_is_shown_where_it_stops_to_be() {
    refused("dimension = <<>>#\n", "string values must be quoted, expected literal string");
    refused("dimension = 1\n<<dimension>> = 2\n", "duplicate key");
    refused("<<>>", "missing field `dimension`");
    assert!(error("title = \"open\n").to_string().contains("scene.toml:1:"));
    assert!(error("\u{0}").to_string().contains("scene.toml:1:"));
}

#[test]
fn deep_nesting_is_refused_without_deep_recursion() {
    for (open, close) in [("[", "]"), ("{a=", "}")] {
        for depth in [1_000, 100_000] {
            let text = format!("{HEAD}view = {}1{}", open.repeat(depth), close.repeat(depth));
            let shown = error(&text).to_string();
            assert!(shown.contains("max recursion depth met"), "{shown}");
            assert!(shown.contains("--> scene.toml:5:"), "{shown}");
            assert!(shown.lines().all(|line| line.chars().count() < 200));
        }
    }
    let shown = error(&format!("{HEAD}{}b = 1", "a.".repeat(100_000))).to_string();
    assert!(shown.contains("recursion limit") && shown.contains("--> scene.toml"), "{shown}");
}

#[test]
fn numbers_that_are_not_finite_or_not_positive_are_refused() {
    for value in ["nan", "inf", "-inf"] {
        let shown = value.replace("nan", "NaN");
        for field in ["velocity", "momentum"] {
            let text = format!("{HEAD}{BALL}{field} = [0, <<{value}>>]\n");
            refused(&text, &format!("the {field} is {shown}; it must be finite"));
        }
        let ball = BALL.replace("[0, 0]", &format!("[<<{value}>>, 0]"));
        refused(&format!("{HEAD}{ball}"), &format!("the position is {shown}; it must be finite"));
        let text = format!("{HEAD}{BALL}[uniform_gravity]\nacceleration = [<<{value}>>, 0]\n");
        refused(&text, &format!("the acceleration is {shown}; it must be finite"));
    }
    for value in ["nan", "inf", "-1", "0", "1e-320"] {
        let shown = value.replace("nan", "NaN");
        let must = |what: &str| format!("{what} is {shown}; it must be positive and finite");
        let ball = BALL.replace("mass = 1", &format!("mass = <<{value}>>"));
        refused(&format!("{HEAD}{ball}"), &must("the mass"));
        for field in ["step", "horizon"] {
            let old = if field == "step" { "step = 0.1" } else { "horizon = 1" };
            let head = HEAD.replace(old, &format!("{field} = <<{value}>>"));
            refused(&format!("{head}{BALL}"), &must(&format!("the {field}")));
        }
        let text = format!("{HEAD}{BALL}[newtonian_gravity]\nconstant = <<{value}>>\n");
        refused(&text, &must("the constant"));
        let text = format!(
            "{HEAD}{BALL}{HOOK}[[springs]]\nbetween = [\"ball\", \"hook\"]\nstiffness = <<{value}>>\n"
        );
        refused(&text, &must("the stiffness"));
        for (field, old) in [("spacing", "0.1"), ("stiffness", "9"), ("particle_mass", "1")] {
            let net = NET.replace(&format!("{field} = {old}"), &format!("{field} = <<{value}>>"));
            let what = field.trim_start_matches("particle_");
            refused(&format!("{HEAD}{net}"), &must(&format!("the {what}")));
        }
    }
    let text = format!("{HEAD}sample_every = <<0>>\n{BALL}");
    refused(&text, "`sample_every` is 0; it must be positive and finite");
    let text =
        format!("{HEAD}{}velocity = <<[1e300, 0]>>\n", BALL.replace("mass = 1", "mass = 1e300"));
    refused(&text, "the momentum is inf; it must be finite");
    let net = NET.replace("spacing = 0.1", "spacing = <<1.7e308>>");
    refused(&format!("{HEAD}{net}"), "the far corner of the net is inf; it must be finite");
}

#[test]
fn a_vector_has_as_many_components_as_the_scene_has_dimensions() {
    for (vector, got) in [("[]", 0), ("[1]", 1), ("[1, 2, 3]", 3)] {
        let message = |what| format!("{what} has {got} components in a scene of dimension 2");
        let ball = BALL.replace("[0, 0]", &format!("<<{vector}>>"));
        refused(&format!("{HEAD}{ball}"), &message("the position"));
        refused(&format!("{HEAD}{BALL}velocity = <<{vector}>>\n"), &message("the velocity"));
        let text = format!("{HEAD}{BALL}[uniform_gravity]\nacceleration = <<{vector}>>\n");
        refused(&text, &message("the acceleration"));
        refused(&format!("{HEAD}{NET}across = <<{vector}>>\n"), &message("`across`"));
    }
    for dimension in ["0", "4"] {
        let head = HEAD.replace("dimension = 2", &format!("dimension = <<{dimension}>>"));
        refused(&head, &format!("the dimension is {dimension}; it must be 1, 2 or 3"));
    }
    let head = format!("{HEAD}view = <<[0, 0, 1]>>\n");
    refused(&format!("{head}{BALL}"), "a view needs a scene of dimension 3");
    let text = format!("{HEAD}view = <<[0, 0, 0]>>\n{BALL}")
        .replace("dimension = 2", "dimension = 3")
        .replace("position = [0, 0]", "position = [0, 0, 0]");
    refused(&text, "the view has no direction: all its components are zero");
}

#[test]
fn names_are_plain_and_unlike_each_other() {
    let rule = "a name is 1 to 64 letters, digits, spaces, `-` and `_`, and starts with a letter or a digit";
    let long = "a".repeat(65);
    for name in ["", " a", "a,b", "a.b", "=a", "a\\n", "<b", long.as_str()] {
        refused(&format!("{HEAD}{}", BALL.replace("\"ball\"", &format!("<<\"{name}\">>"))), rule);
    }
    let again = BALL.replace("\"ball\"", "<<\"ball\">>");
    refused(&format!("{HEAD}{BALL}{again}"), "there is already a particle called `ball`");
    let again = NET.replace("\"net\"", "<<\"net\">>");
    refused(&format!("{HEAD}{NET}{again}"), "there is already a net called `net`");
    let rule = |what| format!("{what} is 1 to 200 characters, none of them a control character");
    refused(&format!("title = <<\"a\\tb\">>\n{HEAD}{BALL}"), &rule("a title"));
    refused(&format!("{HEAD}{BALL}[units]\ntime = <<\"\">>\n"), &rule("a unit"));
}

#[test]
fn a_particle_has_a_mass_and_one_way_to_start() {
    let ball = BALL.replace("mass = 1\n", "").replace("\"ball\"", "<<\"ball\">>");
    let message = "`ball` has no mass; only a pinned particle may go without";
    refused(&format!("{HEAD}{ball}"), message);
    refused(
        &format!("{HEAD}{BALL}velocity = [0, 0]\nmomentum = <<[0, 0]>>\n"),
        "`ball` has a velocity and a momentum; give one of them",
    );
    let text = format!("{HEAD}{HOOK}velocity = <<[0, 0]>>\n");
    refused(&text, "`hook` is pinned and cannot move");
}

#[test]
fn particles_that_attract_each_other_are_apart() {
    let gravity = "[newtonian_gravity]\nconstant = 1\n";
    let twin = BALL.replace("ball", "twin").replace("[0, 0]", "<<[-0.0, 0]>>");
    refused(
        &format!("{HEAD}{BALL}{twin}{gravity}"),
        "`twin` is in the same place as `ball`, where their attraction is infinite",
    );
    // A pin attracts where it has a mass, and may be anywhere where it has none.
    let hook = HOOK.replace("[0, 1]", "<<[0, 0]>>");
    refused(
        &format!("{HEAD}{BALL}{hook}mass = 2\n{gravity}"),
        "`hook` is in the same place as `ball`, where their attraction is infinite",
    );
    let text = format!("{HEAD}{BALL}{}{gravity}", HOOK.replace("[0, 1]", "[0, 0]"));
    assert!(Scene::parse("hook", &text).unwrap().gravity().fixed.is_empty());
}

#[test]
fn a_spring_has_two_ends_and_a_length() {
    let spring = |between: &str, rest: &str| {
        format!("{HEAD}{BALL}{HOOK}{}[[springs]]\nstiffness = 1\nbetween = {between}\n{rest}", {
            BALL.replace("ball", "twin")
        })
    };
    refused(&spring("<<[\"ball\", \"ball\"]>>", ""), "both ends of the spring are `ball`");
    refused(&spring("<<[\"ball\"]>>", ""), "a spring is between two particles, not 1");
    for strain in ["", "strain = \"green\"\n"] {
        refused(
            &spring("<<[\"ball\", \"twin\"]>>", strain),
            "the ends start in the same place, so that the spring needs a rest length",
        );
    }
    refused(
        &spring("<<[\"ball\", \"twin\"]>>", "rest_length = 1\n"),
        "the spring starts with length zero, where its force has no direction",
    );
    let message = |value| {
        format!("the rest length is {value}; it must be positive, or zero with Cauchy strain")
    };
    refused(&spring("[\"ball\", \"hook\"]", "rest_length = <<-1>>\n"), &message("-1"));
    let green = "strain = \"green\"\nrest_length = <<0>>\n";
    refused(&spring("[\"ball\", \"hook\"]", green), &message("0"));
    let text = spring("[\"ball\", \"hook\"]", "rest_length = <<nan>>\n");
    refused(&text, "the rest length is NaN; it must be finite");
    let text = format!("{HEAD}observables = [{{ distance = <<[]>> }}]\n{BALL}");
    refused(&text, "a distance is between two particles, not 0");
    let text = format!("{HEAD}observables = [<<{{}}>>]\n{BALL}");
    let message = "an observable has one word, such as `{ position = \"a name\" }`, not 0";
    refused(&text, message);
    // Two springs between the same particles are as strong as both.
    let twice = spring(
        "[\"ball\", \"hook\"]",
        "[[springs]]\nstiffness = 2\nbetween = [\"hook\", \"ball\"]\n",
    );
    assert_eq!(Scene::parse("twice", &twice).unwrap().links().len(), 2);
}

#[test]
fn a_net_has_rows_columns_and_a_right_angle() {
    for (field, what) in [("rows", "`rows`"), ("columns", "`columns`")] {
        let net = NET.replace(&format!("{field} = 3"), &format!("{field} = <<1>>"));
        let message = format!("{what} is 1; a net has at least two rows and two columns");
        refused(&format!("{HEAD}{net}"), &message);
    }
    let skew = format!("{HEAD}{NET}across = <<[1, 1]>>\n");
    refused(&skew, "the two sides are not at a right angle");
    refused(
        &format!("{HEAD}{NET}down = <<[0, 0]>>\n"),
        "`down` has no direction: all its components are zero",
    );
    let line = HEAD.replace("dimension = 2", "dimension = 1");
    let net = NET.replace("\"net\"", "<<\"net\">>");
    refused(&format!("{line}{net}"), "a net needs a scene of dimension 2 or 3");
}

#[test]
fn something_is_there_and_can_move() {
    let empty = HEAD.replace("= 2", "= <<2>>");
    refused(
        &empty,
        "the scene has no particles: it needs [[particles]], [[nets]], [[solids]] or [[bodies]]",
    );
    let hook = HOOK.replace("true", "<<true>>");
    refused(&format!("{HEAD}{hook}"), "every particle is pinned, so that nothing can move");
}

#[test]
fn a_horizon_is_a_bounded_whole_number_of_steps() {
    let head = |step: &str, horizon: &str| {
        let head = HEAD.replace("step = 0.1", &format!("step = {step}"));
        format!("{}{BALL}", head.replace("horizon = 1", &format!("horizon = <<{horizon}>>")))
    };
    let message = "the horizon is 2.5 steps of 0.4; it must be a whole number of steps";
    refused(&head("0.4", "1"), message);
    let message = "the horizon is 0.5 steps of 2; it must be a whole number of steps";
    refused(&head("2", "1"), message);
    refused(&head("1", "1e11"), "100000000000 steps; there may be at most 10000000000");
    assert!(Scene::parse("whole", &head("0.1", "0.3").replace("<<", "").replace(">>", "")).is_ok());
}

#[test]
fn what_would_not_fit_into_memory_is_refused_before_it_is_made() {
    for (rows, columns) in [("1001", "1000"), ("9223372036854775807", "9223372036854775807")] {
        let net = NET
            .replace("rows = 3", &format!("rows = <<{rows}>>"))
            .replace("columns = 3", &format!("columns = {columns}"));
        let shown = refused(&format!("{HEAD}{net}"), &{
            let count = rows.parse::<u64>().unwrap().saturating_mul(columns.parse().unwrap());
            format!("{count} particles; there may be at most 1000000")
        });
        assert!(shown.contains("rows"));
    }
    let head = HEAD.replace("horizon = 1", "horizon = 1e6");
    let text = format!("{head}sample_every = <<1>>\n{BALL}");
    let SceneError::Invalid(diagnostic) = error(&text.replace("<<", "").replace(">>", "")) else {
        panic!("a fault with a place");
    };
    let Fault::TooManySamples { enough, .. } = diagnostic.fault else {
        panic!("{diagnostic}");
    };
    refused(&text, &diagnostic.fault.to_string());
    let thinned = text.replace("<<1>>", &enough.to_string());
    assert!(Scene::parse("thinned", &thinned).is_ok(), "the suggested distance is enough");
}

#[test]
fn a_long_word_is_not_repeated_in_full() {
    let word = "a".repeat(1_000_000);
    let texts = [
        HEAD.replace("stormer-verlet", &word),
        format!("{HEAD}{word} = 1\n"),
        HEAD.replace("step = 0.1", &format!("step = \"{word}\"")),
        format!("{HEAD}observables = [{{ position = \"{word}\" }}]\n{BALL}"),
    ];
    for text in texts {
        assert!(error(&text).to_string().len() < 1500);
    }
}
