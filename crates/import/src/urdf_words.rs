//! What the reader of URDF passes over: words that it does not know, what is no number among numbers; and turns by
//! quaternions, which it takes by way of angles.

use roxmltree::{Document, Node, ParsingOptions};
use stationary_rigid::Rotation;

use crate::ImportError;
use crate::unread::{Inside, Words, says, unread};

/// What is looked at in each element.
const INSIDE: [Inside; 6] = [
    ("robot", &["link", "joint"]),
    ("link", &["inertial", "collision"]),
    ("inertial", &["origin", "mass", "inertia"]),
    ("collision", &["origin", "geometry"]),
    ("geometry", &["box", "cylinder", "sphere", "capsule", "mesh"]),
    ("joint", &["origin", "parent", "child", "axis", "limit", "dynamics", "mimic"]),
];

/// What no motion shows where nothing drives a joint.
const ALONE: [(&str, &str); 4] = [
    ("robot", "material transmission"),
    ("link", "visual"),
    ("joint", "calibration safety_controller"),
    ("collision", "verbose"),
];

/// What an element says that is read, or that no motion shows.
const SAID: [(&str, &str); 18] = [
    ("robot", "name version"),
    ("link", "name"),
    ("collision", "name"),
    ("origin", "xyz rpy"),
    ("mass", "value"),
    ("inertia", "ixx ixy ixz iyy iyz izz"),
    ("box", "size"),
    ("cylinder", "radius length"),
    ("capsule", "radius length"),
    ("sphere", "radius"),
    ("mesh", "filename scale"),
    ("joint", "name type"),
    ("parent", "link"),
    ("child", "link"),
    ("axis", "xyz"),
    ("limit", "lower upper effort velocity acceleration deceleration jerk"),
    ("dynamics", "damping friction"),
    ("mimic", "joint multiplier offset"),
];

/// The words of version 1.0.
const URDF: Words = Words {
    inside: &INSIDE,
    is_left_alone: |tag, child| says(&ALONE, tag, child),
    is_read: |tag, word, _| says(&SAID, tag, word),
};

/// Those since version 1.1.
const URDF_1_1: Words = Words {
    is_read: |tag, word, _| says(&SAID, tag, word) || (tag == "origin" && word == "quat_xyzw"),
    ..URDF
};

/// Three numbers of an element.
const THREE: [(&str, &str); 3] = [("origin", "xyz rpy"), ("axis", "xyz"), ("box", "size")];

/// A description, searched for what its reader passes over.
pub(crate) struct Source<'d> {
    document: Document<'d>,
    quaternions: bool,
}

fn place(node: Node<'_, '_>) -> String {
    let line = node.document().text_pos_at(node.range().start).row;
    format!("{}, line {line}", node.tag_name().name())
}

impl<'d> Source<'d> {
    pub(crate) fn new(text: &'d str) -> Result<Self, ImportError> {
        let syntax = |message| ImportError::Syntax { format: "URDF", message };
        let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
        let document = Document::parse_with_options(text, options)
            .map_err(|error| syntax(error.to_string()))?;
        let version = document.root_element().attribute("version").and_then(|version| {
            let (major, minor) = version.trim().split_once('.')?;
            Some((major.parse::<u32>().ok()?, minor.parse::<u32>().ok()?))
        });
        let quaternions = version >= Some((1, 1));
        for node in document.descendants().filter(Node::is_element) {
            for said in node.attributes() {
                let (tag, word, value) = (node.tag_name().name(), said.name(), said.value());
                let wanted = match quaternions && tag == "origin" && word == "quat_xyzw" {
                    true => 4,
                    false if says(&THREE, tag, word) => 3,
                    false => continue,
                };
                let numbers = value.split_whitespace().map(str::parse::<f64>);
                if numbers.clone().count() != wanted || numbers.clone().any(|x| x.is_err()) {
                    let at = place(node);
                    let message =
                        format!("`{word}` of {at} is `{value}`; it must be {wanted} numbers");
                    return Err(syntax(message));
                }
            }
        }
        Ok(Source { document, quaternions })
    }

    /// What nothing reads.
    pub(crate) fn unread(&self) -> Vec<String> {
        let words = if self.quaternions { &URDF_1_1 } else { &URDF };
        unread(self.document.root_element(), words, place)
    }

    /// The frame of each joint, and of each link those of its inertia and of what it touches, where a quaternion
    /// turns them.
    pub(crate) fn turned(&self) -> Result<Turned, ImportError> {
        let mut all = Turned::default();
        for node in self.document.root_element().children() {
            let of =
                |tag: &'static str| node.children().filter(move |child| child.has_tag_name(tag));
            match node.tag_name().name() {
                "joint" => all.joints.push(self.rotation(Some(node))?),
                "link" => {
                    all.inertias.push(self.rotation(of("inertial").next())?);
                    let touching = of("collision").map(|collision| self.rotation(Some(collision)));
                    all.touching.push(touching.collect::<Result<_, _>>()?);
                }
                _ => {}
            }
        }
        Ok(all)
    }

    /// How a quaternion turns the frame of an element.
    fn rotation(&self, of: Option<Node<'_, '_>>) -> Result<Option<Rotation>, ImportError> {
        let origin = of.and_then(|of| of.children().find(|child| child.has_tag_name("origin")));
        let said = origin.and_then(|origin| Some((origin, origin.attribute("quat_xyzw")?)));
        let Some((origin, text)) = said.filter(|_| self.quaternions) else { return Ok(None) };
        let parts: Vec<f64> = text.split_whitespace().filter_map(|x| x.parse().ok()).collect();
        let length = parts.iter().map(|x| x * x).sum::<f64>().sqrt();
        let no_turn = || ImportError::NotAllowed {
            format: "URDF",
            what: "a turn by no quaternion",
            name: place(origin),
        };
        let &[x, y, z, w] = &parts[..] else { return Err(no_turn()) };
        let unit = [w, x, y, z].map(|part| part / length);
        Rotation::from_quaternion(unit).map(Some).map_err(|_| no_turn())
    }
}

/// Turns by quaternions; nothing where there is none.
#[derive(Debug, Default)]
pub(crate) struct Turned {
    pub(crate) joints: Vec<Option<Rotation>>,
    pub(crate) inertias: Vec<Option<Rotation>>,
    pub(crate) touching: Vec<Vec<Option<Rotation>>>,
}
