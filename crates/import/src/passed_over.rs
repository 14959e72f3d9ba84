//! What the reader of MJCF passes over or takes for another: told, or refused where bodies would be elsewhere.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};

use roxmltree::{Document, Node};

use crate::ImportError;

/// Forces of a medium.
const MEDIUM: [&str; 3] = ["density", "viscosity", "wind"];
/// What flags switch off, so that the motion is another one.
const SWITCHES: [&str; 9] = [
    "constraint",
    "equality",
    "frictionloss",
    "limit",
    "contact",
    "passive",
    "spring",
    "damper",
    "filterparent",
];

/// What only the file itself says.
#[derive(Debug, Default)]
pub(crate) struct PassedOver {
    pub(crate) left_out: Vec<String>,
    /// Gravity is switched off.
    pub(crate) weightless: bool,
}

struct File {
    /// What tells it from the first, which has no name.
    name: String,
    folder: PathBuf,
    text: String,
}

/// What a class says of where its shapes are: a place, a turn, or two ends.
#[derive(Clone, Debug, Default)]
struct Class {
    above: Option<String>,
    says: [bool; 3],
}

/// What the reader passes over in a text and in the files that it names in `folder`.
pub(crate) fn passed_over(text: &str, folder: &Path) -> Result<PassedOver, ImportError> {
    model(text.to_owned(), String::new(), folder.to_owned(), &mut HashSet::new())
}

fn document(text: &str) -> Result<Document<'_>, ImportError> {
    Document::parse(text)
        .map_err(|error| ImportError::Syntax { format: "MJCF", message: error.to_string() })
}

/// A model of one file and of those that it includes; classes are its own.
fn model(
    text: String,
    name: String,
    folder: PathBuf,
    seen: &mut HashSet<PathBuf>,
) -> Result<PassedOver, ImportError> {
    let mut files = vec![File { name, folder, text }];
    let mut parts = Vec::new();
    let mut next = 0;
    while let Some(file) = files.get(next) {
        let (folder, mut more) = (file.folder.clone(), Vec::new());
        let read = document(&file.text)?;
        for node in read.descendants() {
            let Some(name) = node.attribute("file") else { continue };
            let into = match node.tag_name().name() {
                "include" => &mut more,
                "model" => &mut parts,
                _ => continue,
            };
            let path = folder.join(name);
            // A file that is not there is the reader's to refuse.
            if let Some(text) =
                seen.insert(path.clone()).then(|| fs::read_to_string(&path).ok()).flatten()
            {
                let folder = path.parent().unwrap_or(Path::new(".")).to_owned();
                into.push(File { name: format!(" of {name}"), folder, text });
            }
        }
        files.extend(more);
        next += 1;
    }
    let read = files.iter().map(|file| document(&file.text)).collect::<Result<Vec<_>, _>>()?;
    let mut classes = HashMap::new();
    for node in read.iter().flat_map(|document| document.root_element().children()) {
        if node.has_tag_name("default") {
            class(node, None, &mut classes);
        }
    }
    let mut out = PassedOver::default();
    for (file, read) in files.iter().zip(&read) {
        for node in read.descendants().filter(Node::is_element) {
            let (tag, line) = (node.tag_name().name(), read.text_pos_at(node.range().start).row);
            let place = format!("{tag}, line {line}{}", file.name);
            if let Some(what) = refused(node, &classes) {
                return Err(ImportError::Unsupported { what, name: place });
            }
            told(node, &place, &mut out);
        }
    }
    for part in parts {
        out.left_out.extend(model(part.text, part.name, part.folder, seen)?.left_out);
    }
    Ok(out)
}

/// What a shape says itself of where it is.
fn says(geom: Node<'_, '_>) -> [bool; 3] {
    let turns = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];
    let turned = turns.iter().any(|turn| geom.has_attribute(*turn));
    [geom.has_attribute("pos"), turned, geom.has_attribute("fromto")]
}

fn class(node: Node<'_, '_>, above: Option<&str>, classes: &mut HashMap<String, Class>) {
    let name = node.attribute("class").or(above).unwrap_or("main");
    let own = classes.entry(name.to_owned()).or_default();
    own.above = above.filter(|above| *above != name).map(str::to_owned);
    for geom in node.children().filter(|child| child.has_tag_name("geom")) {
        let said = says(geom);
        own.says = [0, 1, 2].map(|k| own.says[k] || said[k]);
    }
    for below in node.children().filter(|child| child.has_tag_name("default")) {
        class(below, Some(name), classes);
    }
}

/// What a shape and its classes say of where it is, its own words first.
fn levels(geom: Node<'_, '_>, classes: &HashMap<String, Class>) -> Vec<[bool; 3]> {
    let ambient = || geom.ancestors().find_map(|above| above.attribute("childclass"));
    let mut name = geom.attribute("class").or_else(ambient).unwrap_or("main");
    let mut out = vec![says(geom)];
    // No chain is longer than all classes, even where they go in a circle.
    for _ in 0..=classes.len() {
        let own = classes.get(name);
        out.extend(own.map(|class| class.says));
        match own.and_then(|class| class.above.as_deref()) {
            Some(above) => name = above,
            None if name != "main" => name = "main",
            None => break,
        }
    }
    out
}

/// Why bodies would be elsewhere, or have other masses, than the description says.
fn refused(node: Node<'_, '_>, classes: &HashMap<String, Class>) -> Option<&'static str> {
    let tag = node.tag_name().name();
    let parent = node.parent_element();
    let inside = |tag: &str| parent.is_some_and(|parent| parent.has_tag_name(tag));
    match tag {
        "replicate" => Some("copies of a part"),
        "composite" | "flexcomp" | "flex" => Some("a part of many bodies"),
        "include" if !inside("mujoco") => Some("a file inside of an element"),
        "joint" | "freejoint" | "inertial" | "attach" if inside("frame") => {
            Some("what is in a frame and is no shape")
        }
        "default" if inside("mujoco") => {
            let own = node.attribute("class").is_some_and(|class| class != "main");
            own.then_some("a class of all that is not called main")
        }
        "worldbody" if node.has_attribute("childclass") => Some("a class of the whole world"),
        "compiler" if node.has_attribute("inertiagrouprange") => {
            Some("masses of some groups of shapes")
        }
        "geom" => {
            let hollow = node.attribute("shellinertia") == Some("true");
            let weighed = |body: Node<'_, '_>| body.children().any(|c| c.has_tag_name("inertial"));
            if hollow && !parent.is_some_and(weighed) {
                return Some("the mass of a shell");
            }
            if inside("default") {
                return None;
            }
            let levels = levels(node, classes);
            if levels.iter().any(|says| says[2]) {
                // Two ends say all of the pose.
                return inside("frame").then_some("ends of a shape in a frame");
            }
            // The reader takes the whole pose of the first level that says anything of it.
            let mut saying = levels.iter().skip_while(|says| !(says[0] || says[1]));
            let first = saying.next()?;
            let more = saying.any(|says| (says[0] && !first[0]) || (says[1] && !first[1]));
            more.then_some("a pose that is partly of a class")
        }
        _ => None,
    }
}

/// Forces that the scene has not.
fn told(node: Node<'_, '_>, place: &str, out: &mut PassedOver) {
    let zero = |text: &str| text.split_whitespace().all(|x| x.parse() == Ok(0.0));
    match node.tag_name().name() {
        "option" => {
            for name in MEDIUM {
                if node.attribute(name).is_some_and(|value| !zero(value)) {
                    out.left_out.push(format!("`{name}` of {place}"));
                }
            }
        }
        "flag" => {
            if let Some(gravity) = node.attribute("gravity") {
                out.weightless = gravity == "disable";
            }
            for name in SWITCHES {
                if node.attribute(name) == Some("disable") {
                    out.left_out.push(format!("`{name}` disabled by {place}"));
                }
            }
            if node.attribute("override") == Some("enable") {
                out.left_out.push(format!("`override` enabled by {place}"));
            }
        }
        "spatial" => out.left_out.push(format!("tendon in space: {place}")),
        "plugin" if node.parent_element().is_some_and(|parent| parent.has_tag_name("body")) => {
            out.left_out.push(format!("forces of {place}"));
        }
        _ => {}
    }
}
