//! Which words go together: every pair of them is run for two steps, in the plane and in space.

use std::fmt::Write;

use stationary_scene::{Scene, SceneError};

use crate::schema::check_file;

/// Words that put something into a scene, in the order of the page.
const WORDS: [&str; 21] = [
    "particles",
    "springs",
    "rods",
    "chains",
    "nets",
    "solids",
    "heat",
    "bodies",
    "joints",
    "joint limits",
    "joint friction",
    "motors",
    "breaking rods",
    "contact",
    "uniform_gravity",
    "newtonian_gravity",
    "drag",
    "frame",
    "loads",
    "motions",
    "modes",
];

/// Methods that are tried, one after the other.
const METHODS: [&str; 8] = [
    "\"stormer-verlet\"",
    "\"variational-rotation\"",
    "\"rattle\"",
    "\"dormand-prince-853\"\ntolerance = 1e-6",
    "\"newmark\"",
    "\"implicit-midpoint\"",
    "\"implicit-euler\"",
    "\"linear-modes\"\nmodes = 1",
];

/// A scene with two words, and with what they need to be about.
struct Pair<'a> {
    words: [&'a str; 2],
    dimension: usize,
}

impl Pair<'_> {
    fn says(&self, word: &str) -> bool {
        self.words.contains(&word)
    }

    fn says_one_of(&self, words: &[&str]) -> bool {
        words.iter().any(|word| self.says(word))
    }

    fn at(&self, x: f64, y: f64) -> String {
        if self.dimension == 3 { format!("[{x}, {y}, 0]") } else { format!("[{x}, {y}]") }
    }

    fn has_bodies(&self) -> bool {
        self.says("bodies") || self.has_joints()
    }

    fn has_joints(&self) -> bool {
        self.says_one_of(&["joints", "joint limits", "joint friction", "motors"])
    }

    fn has_rods(&self) -> bool {
        self.says_one_of(&["rods", "breaking rods"])
    }

    /// What is written out beside the two words: what they are about.
    fn has_particles(&self) -> bool {
        let other = self.says_one_of(&["nets", "solids", "heat"]) || self.has_bodies();
        let about =
            ["springs", "rods", "breaking rods", "contact", "uniform_gravity", "drag", "frame"];
        let about = [&about[..], &["loads", "modes"]].concat();
        self.says_one_of(&["particles", "chains", "motions", "newtonian_gravity"])
            || (self.says_one_of(&about) && !other)
    }

    fn text(&self, method: &str) -> String {
        let at = |x: f64, y: f64| self.at(x, y);
        let mut text = format!(
            "dimension = {}\nintegrator = {method}\nstep = 0.001\nhorizon = 0.002\n",
            self.dimension
        );
        let mut say = |line: String| writeln!(text, "{line}").unwrap();
        // The ends of springs and rods, and what is loaded.
        let (first, second) = match (self.has_particles(), self.has_bodies()) {
            (true, true) => ("p", "a"),
            (false, true) => ("a", "b"),
            _ if self.has_particles() => ("p", "q"),
            _ if self.says("nets") => ("net.0.0", "net.1.1"),
            _ => ("beam.0", "beam.3"),
        };
        if self.has_particles() {
            // A pin without a mass does not attract.
            let hook = !self.says("newtonian_gravity") || self.says_one_of(&["chains", "motions"]);
            let hook = if hook {
                format!("{{ name = \"hook\", pinned = true, position = {} }},", at(0.0, 1.0))
            } else {
                String::new()
            };
            say(format!(
                "particles = [{hook} {{ name = \"p\", mass = 1, radius = 0.1, position = {} }}, \
                 {{ name = \"q\", mass = 1, radius = 0.1, position = {} }}]",
                at(0.0, 0.0),
                at(1.0, 0.0)
            ));
        }
        let spring = self.says_one_of(&["springs", "motions", "modes"]) && !self.says("heat");
        if self.says("springs") || (spring && self.has_particles()) {
            // Modes are about a rest, which what falls has not.
            let hung = self.says("motions") || self.says("modes") && self.says("uniform_gravity");
            let hung = if hung { "{ between = [\"hook\", \"p\"], stiffness = 5 }," } else { "" };
            say(format!(
                "springs = [{hung} {{ between = [\"{first}\", \"{second}\"], stiffness = 5 }}]"
            ));
        }
        if self.has_rods() {
            let strength = if self.says("breaking rods") { ", strength = 1e3" } else { "" };
            say(format!("rods = [{{ between = [\"{first}\", \"{second}\"]{strength} }}]"));
        }
        if self.says("chains") {
            say("chains = [{ name = \"chain\", between = [\"hook\", \"q\"], links = 2, \
                 particle_mass = 0.1 }]"
                .to_owned());
        }
        if self.says("nets") {
            say(format!(
                "nets = [{{ name = \"net\", rows = 2, columns = 2, spacing = 0.5, origin = {}, \
                 across = {}, down = {}, particle_mass = 0.1, stiffness = 9{} }}]",
                at(5.0, 0.0),
                at(1.0, 0.0),
                at(0.0, -1.0),
                if self.says("modes") { ", pinned = [\"top\"]" } else { "" }
            ));
        }
        if self.says("solids") {
            say(format!(
                "solids = [{{ name = \"beam\", shape = {{ kind = \"rectangle\", size = [1, 0.5], \
                 cells = [1, 1], origin = {} }}, thickness = 0.1, density = 10, young = 1e3, \
                 poisson = 0.3 }}]",
                at(9.0, 0.0)
            ));
        }
        if self.says("heat") {
            say(format!(
                "heat = {{ name = \"plate\", shape = {{ kind = \"rectangle\", size = [1, 1], \
                 cells = [2, 2] }}, diffusivity = 1, warm = [{{ at = {}, radius = 0.1, \
                 temperature = 1 }}] }}",
                at(0.0, 0.0)
            ));
        }
        if self.has_bodies() {
            let shape = match self.dimension {
                // Of what is in space balls attract.
                3 if self.says("newtonian_gravity") => "ball = 0.2",
                3 => "box = [0.4, 0.4, 0.4]",
                _ => "box = [0.4, 0.4]",
            };
            say(format!(
                "bodies = [{{ name = \"a\", mass = 1, {shape}, position = {} }}, \
                 {{ name = \"b\", mass = 1, {shape}, position = {} }}]",
                at(3.0, 0.0),
                at(3.0, 1.0)
            ));
        }
        if self.has_joints() {
            let (kind, axis) =
                if self.dimension == 3 { ("hinge", ", axis = [0, 0, 1]") } else { ("pin", "") };
            let limits = if self.says("joint limits") { ", limits = [-1, 1]" } else { "" };
            let friction = if self.says("joint friction") { ", friction = 0.1" } else { "" };
            say(format!(
                "joints = [{{ kind = \"{kind}\", between = [\"world\", \"a\"], at = {}{axis}{limits}{friction} }}]",
                at(3.2, 0.0)
            ));
        }
        if self.says("motors") {
            say("motors = [{ between = [\"world\", \"a\"], torque = 1 }]".to_owned());
        }
        if self.says("contact") {
            let wall = format!("{{ normal = {}, at = {} }}", at(0.0, 1.0), at(0.0, -5.0));
            say(format!("contact = {{ restitution = 0.5, walls = [{wall}] }}"));
        }
        if self.says("uniform_gravity") {
            say(format!("uniform_gravity = {{ acceleration = {} }}", at(0.0, -9.81)));
        }
        if self.says("newtonian_gravity") {
            say("newtonian_gravity = { constant = 1 }".to_owned());
        }
        if self.says("drag") {
            say("drag = { coefficient = 0.1 }".to_owned());
        }
        if self.says("frame") {
            let turning = if self.dimension == 3 { "[0, 0, 0.1]" } else { "0.1" };
            say(format!("frame = {{ angular_velocity = {turning} }}"));
        }
        if self.says("loads") {
            say(format!("loads = [{{ on = \"{first}\", force = {} }}]", at(1.0, 0.0)));
        }
        if self.says("motions") {
            say(format!(
                "motions = [{{ of = \"hook\", shift = {}, strength = {{ ramp = [0, 1], from = 0.001, to = 1 }} }}]",
                at(0.0, 0.1)
            ));
        }
        text
    }

    /// Nothing where one of the methods runs it; else why the one that comes nearest does not.
    fn refused(&self) -> Option<String> {
        let mut why: Option<(usize, String)> = None;
        for method in METHODS {
            if self.says("modes") != method.contains("modes") {
                continue;
            }
            let text = self.text(method);
            let (rank, error) = match Scene::parse("pair.toml", &text) {
                Ok(scene) => match scene.run() {
                    Ok(run) => {
                        assert_eq!(run.cost().steps, 2, "{text}");
                        return None;
                    }
                    // What follows has the digits of a residual.
                    Err(error) => (3, error.to_string().split(':').next().unwrap().to_owned()),
                },
                Err(SceneError::Invalid(error)) => {
                    assert!(error.place.is_some(), "{error}\n{text}");
                    let said = error.fault.to_string();
                    let of_method =
                        said.contains("unknown integrator") || said.contains("does not move");
                    (usize::from(!of_method) + 1, said)
                }
                Err(error) => panic!("{error}\n{text}"),
            };
            if why.as_ref().is_none_or(|(best, _)| rank > *best) {
                why = Some((rank, error));
            }
        }
        why.map(|(_, error)| error)
    }
}

/// The page: a table of all pairs, and the reasons by number.
fn page() -> String {
    let mut page = String::from(
        "# What goes together in a scene\n\n\
         Made by running every pair of words, with what they are about, for two steps in the plane and in \
         space\n(`crates/scene/tests/all/word_pairs.rs`): `+` where a method runs it, else the number of the \
         reason below. `modes` is\n`linear-modes`.\n\n|",
    );
    WORDS.iter().for_each(|word| write!(page, " | `{word}`").unwrap());
    page += " |\n| --- |";
    WORDS.iter().for_each(|_| page += " --- |");
    page += "\n";
    let mut reasons: Vec<String> = Vec::new();
    for (row, a) in WORDS.iter().enumerate() {
        write!(page, "| `{a}` |").unwrap();
        for b in &WORDS[..=row] {
            let of = [2, 3].map(|dimension| Pair { words: [a, b], dimension }.refused());
            let mut number = |why: &String| {
                let place = reasons.iter().position(|other| other == why);
                place.unwrap_or_else(|| {
                    reasons.push(why.clone());
                    reasons.len() - 1
                }) + 1
            };
            let cell = match &of {
                [None, None] => "+".to_owned(),
                [Some(why), None] => format!("{} in the plane", number(why)),
                [None, Some(why)] => format!("{} in space", number(why)),
                [Some(why), Some(other)] if why == other => number(why).to_string(),
                [Some(why), Some(other)] => format!("{}, {}", number(why), number(other)),
            };
            write!(page, " {cell} |").unwrap();
        }
        page += &" |".repeat(WORDS.len() - row - 1);
        page += "\n";
    }
    page += "\n";
    for (number, why) in reasons.iter().enumerate() {
        writeln!(page, "{}. {why}", number + 1).unwrap();
    }
    page
}

#[test]
fn the_table_of_pairs_is_what_running_them_says() {
    check_file("../../docs/src/scene-pairs.md", &page());
}
