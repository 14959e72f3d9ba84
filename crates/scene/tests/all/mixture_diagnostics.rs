//! Every mistake in mixtures of particles, bodies, joints and contact: what is said of it, and where.

use crate::body_diagnostics::refused;

const PLANE: &str = "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.1\nhorizon = 1\n";
const BOX: &str = "[[bodies]]\nname = \"crate\"\nmass = 1\nbox = [1, 2]\nposition = [0, 0]\n";
const PIN: &str = "[[joints]]\nkind = \"pin\"\nbetween = [\"world\", \"crate\"]\nat = [0, 1]\n";
const BEAD: &str = "[[particles]]\nname = \"bead\"\nmass = 1\nposition = [5, 0]\nradius = 0.1\n";
const HOOK: &str = "[[particles]]\nname = \"hook\"\npinned = true\nposition = [5, 5]\n";

#[test]
fn ends_of_springs_and_rods_that_hold_nothing_are_refused() {
    let same = "`crate.0` and `crate` are points of one body, whose distance nothing changes";
    let spring = "[[springs]]\nbetween = <<[\"crate.0\", \"crate\"]>>\nstiffness = 1\n";
    refused(&format!("{PLANE}{BOX}{spring}"), same);
    let rod = "[[rods]]\nbetween = <<[\"crate.0\", \"crate\"]>>\n";
    refused(&format!("{PLANE}{BOX}{rod}"), same);
    let far = "[[rods]]\nbetween = [\"crate.4\", <<\"crate.9\">>]\n";
    let points = BOX.to_owned() + "points = [[0, 0.5]]\n";
    refused(&format!("{PLANE}{points}{far}"), "unknown particle `crate.9`");
    let pins = "[[rods]]\nbetween = <<[\"hook\", \"other\"]>>\n";
    let other = HOOK.replace("hook", "other").replace("[5, 5]", "[6, 5]");
    let message = "both ends of the rod are pinned";
    refused(&format!("{PLANE}{BOX}{HOOK}{other}{pins}"), message);
}

#[test]
fn damping_that_cannot_be_is_refused() {
    let spring = |rest: &str| {
        format!("[[springs]]\nbetween = [\"crate\", \"bead\"]\nstiffness = 1\n{rest}\n")
    };
    let negative = spring("damping = <<-2>>");
    refused(&format!("{PLANE}{BOX}{BEAD}{negative}"), "the damping is -2; it must not be negative");
    let joint = |rest: &str| format!("{PLANE}{BOX}{PIN}{rest}\n");
    refused(&joint("stiffness = <<-1>>"), "the stiffness is -1; it must not be negative");
    refused(&joint("rest = <<0.5>>"), "`rest` is of a spring: this joint has no `stiffness`");
    let far = "the turn is 4 radians; it must be within half a turn, from -pi to pi";
    refused(&joint("stiffness = 1\nrest = <<4>>"), far);
    let axis = "`stiffness`, `rest` and `damping` are of a `pin` or a `hinge`; this joint has no one axis to \
                turn about";
    let weld = PIN.replace("pin", "weld") + "damping = <<1>>\n";
    refused(&format!("{PLANE}{BOX}{weld}"), axis);
}

#[test]
fn a_particle_beside_bodies_is_asked_for_nothing_that_turns() {
    let load = "[[loads]]\non = \"bead\"\ntorque = <<1>>\n";
    let message = "`bead` is a particle, which does not turn; only a body takes a `torque`";
    refused(&format!("{PLANE}{BOX}{BEAD}{load}"), message);
    let observed = "observables = [{ angular_velocity = <<\"bead\">> }]\n";
    let message = "`bead` is no body, and has no angular velocity";
    refused(&format!("{PLANE}{observed}{BOX}{BEAD}"), message);
    let joint = "[[joints]]\nkind = \"pin\"\nbetween = [\"crate\", <<\"bead\">>]\nat = [5, 0]\n";
    refused(&format!("{PLANE}{BOX}{BEAD}{joint}"), "unknown body `bead`");
    let twice = BEAD.replace("\"bead\"", "<<\"crate\">>");
    refused(&format!("{PLANE}{BOX}{twice}"), "there is already a particle called `crate`");
}

#[test]
fn mixtures_that_physics_does_not_have_are_refused_with_the_reason() {
    let gravity = "[newtonian_gravity]\nconstant = <<1>>\n";
    let message = "`crate` does not attract as a point: `newtonian_gravity` is between particles and, in space, balls; the \
                   attraction of other bodies, such as a disc in the plane, depends on how their mass is distributed";
    refused(&format!("{PLANE}{BOX}{BEAD}{gravity}"), message);
    let contact = "[contact]\nrestitution = 0.5\n";
    let solid = "[[solids]]\nname = <<\"beam\">>\nshape = { kind = \"rectangle\", size = [1, 1], \
                 cells = [1, 1] }\nthickness = 1\ndensity = 1\nyoung = 1\npoisson = 0.3\n";
    let message = "elastic and rigid bodies are not coupled yet, and there are rigid bodies already; leave one of them out";
    refused(&format!("{PLANE}{BOX}{solid}"), message);
    let marked = PLANE.replace("\"stormer-verlet\"", "<<\"stormer-verlet\">>");
    let rod = "[[rods]]\nbetween = [\"crate\", \"bead\"]\n";
    let breaks = format!("{rod}strength = 5\n");
    let other = PLANE.replace("\"stormer-verlet\"", "<<\"implicit-midpoint\">>");
    let message = "`implicit-midpoint` cannot step limits and friction of joints, or rods that break beside \
                   bodies: name `stormer-verlet`";
    refused(&format!("{other}{BOX}{BEAD}{breaks}"), message);
    let when = "[contact]\nwhen = <<\"at-the-instant\">>\n";
    let hung = "[[rods]]\nbetween = [\"hook\", \"bead\"]\n";
    refused(&format!("{PLANE}{HOOK}{BEAD}{hung}{when}"), "`when` applies to particles only");
    let springs = "[contact]\nstiffness = 9\n";
    let message =
        "`stormer-verlet` cannot step rods beside contact by springs: leave `stiffness` out";
    refused(&format!("{marked}{HOOK}{BEAD}{hung}{springs}"), message);
    let line = "dimension = 1\nintegrator = <<\"stormer-verlet\">>\nstep = 0.1\nhorizon = 1\n";
    let on_a_line = |text: &str| text.replace("[5, 5]", "[5]").replace("[5, 0]", "[4]");
    let text = on_a_line(&format!("{HOOK}{BEAD}{hung}{contact}"));
    let message = "`stormer-verlet` cannot step contact with rods on a line, where a rod leaves its ends \
                   nothing to do: leave one of them out";
    refused(&format!("{line}{text}"), message);
    let method = PLANE.replace("\"stormer-verlet\"", "<<\"rattle\">>");
    refused(&format!("{method}{BOX}{BEAD}{rod}"), "rattle does not move what is in this scene");
    let method = PLANE.replace("\"stormer-verlet\"", "<<\"runge-kutta-4\">>");
    refused(&format!("{method}{BOX}{BEAD}{rod}"), "runge-kutta-4 does not hold joints");
    let pair = "[contact]\npairs = [{ of = [\"bead\", <<\"ball\">>], friction = 0.1 }]\n";
    refused(&format!("{PLANE}{BOX}{BEAD}{pair}"), "unknown body, wall or ball `ball`");
}
