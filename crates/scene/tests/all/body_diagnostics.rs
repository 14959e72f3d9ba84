//! Every mistake in the words for bodies and joints: what is said of it, and where.

use stationary_scene::{Scene, SceneError};

const HEAD: &str = "dimension = 3\nintegrator = \"axis-rotations\"\nstep = 0.1\nhorizon = 1\n";
const BOX: &str = "[[bodies]]\nname = \"crate\"\nmass = 1\nbox = [1, 2, 3]\nposition = [0, 0, 0]\n";
const PLANE: &str = "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.1\nhorizon = 1\n";

/// Asserts the message and the place of a mistake; `<<` and `>>` stand around the word.
#[track_caller]
pub(crate) fn refused(marked: &str, message: &str) {
    let (before, rest) = marked.split_once("<<").expect("a mark");
    let (word, after) = rest.split_once(">>").expect("the end of the mark");
    let text = format!("{before}{word}{after}");
    let Err(SceneError::Invalid(diagnostic)) = Scene::parse("scene.toml", &text) else {
        panic!("the text is right")
    };
    assert_eq!(diagnostic.fault.to_string(), message);
    let place = diagnostic.place.as_ref().expect("a place");
    let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
    let line = before.matches('\n').count() + 1;
    assert_eq!((place.line, place.column), (line, column), "{diagnostic}");
}

#[test]
fn a_body_that_cannot_be_is_refused_where_it_says_so() {
    let body = |name: &str, rest: &str| format!("[[bodies]]\nname = {name}\nmass = 1\n{rest}");
    let lone = body("<<\"stone\">>", "position = [0, 0, 0]\n");
    let message = "`stone` needs one of `box`, `ball`, `polygon`, `capsule`, `cylinder`, `cone`, `ellipsoid`, \
                   `hull`, `parts` and its `moments` of inertia";
    refused(&format!("{HEAD}{lone}"), message);
    refused(&format!("{HEAD}{lone}box = [1, 1, 1]\nmoments = [1, 1, 1]\n"), message);
    let thin = body("\"stone\"", "box = [1, <<0>>, 1]\nposition = [0, 0, 0]\n");
    refused(&format!("{HEAD}{thin}"), "the side of a box is 0; it must be positive and finite");
    let odd = body("\"stone\"", "moments = <<[1, 1, 3]>>\nposition = [0, 0, 0]\n");
    let message = "moment 2 of [1.0, 1.0, 3.0] exceeds the sum of the others: no mass \
                   is distributed like that";
    refused(&format!("{HEAD}{odd}"), message);
    let flat = "the rotation is a vector in a scene of dimension 3";
    refused(&format!("{HEAD}{BOX}rotation = <<1>>\n"), flat);
    let plate = body("\"card\"", "box = [1, 2]\nposition = [0, 0]\n");
    let number = "the angular velocity is a number in a scene of dimension 2";
    refused(&format!("{PLANE}{plate}angular_velocity = <<[0, 0, 1]>>\n"), number);
    let twice = body("<<\"crate\">>", "box = [1, 1, 1]\nposition = [1, 0, 0]\n");
    refused(&format!("{HEAD}{BOX}{twice}"), "there is already a body called `crate`");
    let world = body("<<\"world\">>", "box = [1, 1, 1]\nposition = [1, 0, 0]\n");
    let message = "`world` is what joints call the frame that does not move; no body has this name";
    refused(&format!("{HEAD}{world}"), message);
    let line = "dimension = 1\nintegrator = \"stormer-verlet\"\nstep = 0.1\nhorizon = 1\n";
    let on_a_line = body("<<\"bead\">>", "box = [1]\nposition = [0]\n");
    refused(&format!("{line}{on_a_line}"), "a body needs a scene of dimension 2 or 3");
    let gravity = "[newtonian_gravity]\nconstant = <<1>>\n";
    let message = "`crate` does not attract as a point: `newtonian_gravity` is between particles and, in space, balls; the \
                   attraction of other bodies, such as a disc in the plane, depends on how their mass is distributed";
    refused(&format!("{HEAD}{BOX}{gravity}"), message);
    refused(&format!("{HEAD}{BOX}<<wieght>> = 1\n"), "unknown field `wieght`");
    let head = HEAD.replace("\"axis-rotations\"", "<<\"stormer-verlet\">>");
    refused(&format!("{head}{BOX}"), "unknown integrator `stormer-verlet`");
    let particle = "[[particles]]\nname = \"ball\"\nmass = 1\nposition = [0, 0]\n";
    let observed = "observables = [{ angular_velocity = <<\"ball\">> }]\n";
    let message = "`ball` is no body, and has no angular velocity";
    refused(&format!("{PLANE}{observed}{particle}"), message);
}

#[test]
fn a_joint_that_cannot_be_is_refused_where_it_says_so() {
    let two = format!("{HEAD}{BOX}{}", BOX.replace("crate", "lid"));
    let joint = |kind: &str, between: &str, rest: &str| {
        format!("[[joints]]\nkind = {kind}\nbetween = {between}\n{rest}\n")
    };
    let both = "[\"crate\", \"lid\"]";
    let unknown = joint("<<\"bal\">>", both, "at = [0, 0, 0]");
    refused(&format!("{two}{unknown}"), "unknown joint `bal`");
    let nobody = joint("\"ball\"", "[\"crate\", <<\"lidd\">>]", "at = [0, 0, 0]");
    refused(&format!("{two}{nobody}"), "unknown body `lidd`");
    let itself = joint("\"ball\"", "<<[\"lid\", \"lid\"]>>", "at = [0, 0, 0]");
    refused(&format!("{two}{itself}"), "both sides of the joint are `lid`");
    let three = joint("\"ball\"", "<<[\"crate\"]>>", "at = [0, 0, 0]");
    refused(
        &format!("{two}{three}"),
        "a joint is between two bodies, or a body and `world`, not 1",
    );
    let axisless = joint("<<\"hinge\">>", both, "at = [0, 0, 0]");
    refused(&format!("{two}{axisless}"), "a hinge or a slider needs an `axis`");
    let axis = joint("\"ball\"", both, "at = [0, 0, 0]\naxis = <<[0, 0, 1]>>");
    refused(&format!("{two}{axis}"), "only a hinge or a slider has an axis");
    let zero = joint("\"hinge\"", both, "at = [0, 0, 0]\naxis = <<[0, 0, 0]>>");
    refused(&format!("{two}{zero}"), "the axis has no direction: all its components are zero");
    let moving = format!("{two}velocity = [2, 0, 0]\n");
    let held = joint("\"ball\"", "[\"lid\", \"world\"]", "at = <<[0, 0, 0]>>");
    let message = "`lid` and `world` move apart at 2 a unit of time where they are joined: velocities that are \
                   given must fit there, and those that are not must follow from them";
    refused(&format!("{moving}{held}"), message);
    let still = format!("{BOX}angular_velocity = [0, 0, 0]\n");
    let lid = BOX.replace("crate", "lid");
    let turning = format!("{HEAD}{still}{lid}angular_velocity = [0, 0, 2]\n");
    let fixed = joint("\"fixed\"", "<<[\"lid\", \"crate\"]>>", "at = [0, 0, 0]");
    let message =
        "the two sides turn against each other at 2 radians a unit of time, as the joint forbids";
    refused(&format!("{turning}{fixed}"), message);
    let alone = "[[joints]]\nkind = <<\"ball\">>\nbetween = [\"a\", \"b\"]\nat = [0, 0, 0]\n";
    refused(
        &format!("{}{alone}", HEAD.replace("axis-rotations", "stormer-verlet")),
        "joints need [[bodies]] to join",
    );
    let head = HEAD.replace("\"axis-rotations\"", "<<\"munthe-kaas-4\">>");
    let ball = joint("\"ball\"", both, "at = [0, 0, 0]");
    let other = BOX.replace("crate", "lid");
    refused(&format!("{head}{BOX}{other}{ball}"), "munthe-kaas-4 does not hold joints");
}
