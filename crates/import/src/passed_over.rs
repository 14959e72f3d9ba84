//! What the reader of MJCF passes over or takes for another: told, or refused where bodies would be elsewhere.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};

use mjcf_rs::Model;
use roxmltree::{Document, Node};

use crate::ImportError;
use crate::known_words::MJCF;
use crate::not_allowed::not_allowed;
use crate::reading_order::{Before, late};
use crate::turns::{TURNS, turn_refused};
use crate::unread::unread;

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

/// Models that are parts of others, one in the other and all together, at most: the reader reads each anew.
const DEEPEST: usize = 16;
const MOST: usize = 256;

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
    /// Where it is, without links; empty of the first.
    path: PathBuf,
    folder: PathBuf,
    text: String,
}

impl File {
    /// An element, as errors name it.
    fn place(&self, node: Node<'_, '_>) -> String {
        let line = node.document().text_pos_at(node.range().start).row;
        format!("{}, line {line}{}", node.tag_name().name(), self.name)
    }
}

/// The files of the models that a model is part of, and how many were read.
#[derive(Default)]
struct Above {
    files: Vec<PathBuf>,
    read: usize,
}

/// A model that another names, to attach bodies of it.
struct Attachable {
    name: String,
    file: File,
}

/// What is said of a shape by itself or by a class.
#[derive(Clone, Debug, Default)]
pub(crate) struct Said {
    /// Whether a place, a turn, two ends.
    pub(crate) pose: [bool; 3],
    /// How many numbers of its size.
    sizes: usize,
    pub(crate) kind: Option<String>,
    mesh: bool,
}

/// What a class says of its shapes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Class {
    above: Option<String>,
    said: Said,
}

/// What the reader passes over in a text and in the files that it names in `folder`.
pub(crate) fn passed_over(text: &str, folder: &Path) -> Result<PassedOver, ImportError> {
    let (name, path) = (String::new(), PathBuf::new());
    let file = File { name, path, folder: folder.to_owned(), text: text.to_owned() };
    model(file, &mut Above::default())
}

fn document(text: &str) -> Result<Document<'_>, ImportError> {
    Document::parse(text)
        .map_err(|error| ImportError::Syntax { format: "MJCF", message: error.to_string() })
}

/// A model of one file and of those that it includes; classes are its own.
fn model(first: File, above: &mut Above) -> Result<PassedOver, ImportError> {
    let (mut files, mut parts, mut seen) = (vec![first], Vec::new(), HashSet::new());
    let mut next = 0;
    while let Some(file) = files.get(next) {
        let (folder, mut more) = (file.folder.clone(), Vec::new());
        let read = document(&file.text)?;
        for node in read.descendants() {
            let tag = node.tag_name().name();
            let Some(name) = node.attribute("file") else { continue };
            if !["include", "model"].contains(&tag) {
                continue;
            }
            let path = folder.join(name);
            let folder = path.parent().unwrap_or(Path::new(".")).to_owned();
            let text = fs::read_to_string(&path);
            let path = path.canonicalize().unwrap_or(path);
            let of = format!(" of {name}");
            let file = |text| File { name: of, path: path.clone(), folder, text };
            let refused = |what| ImportError::Unsupported { what, name: name.to_owned() };
            if tag == "include" {
                if !seen.insert(path.clone()) {
                    return Err(refused("a file that is included twice"));
                }
                // One that is not there is the reader's to refuse.
                more.extend(text.ok().map(file));
                continue;
            }
            if above.files.contains(&path) {
                return Err(refused("a model that is a part of itself"));
            }
            above.read += 1;
            if above.files.len() == DEEPEST || above.read > MOST {
                return Err(refused("so many models as parts of others"));
            }
            let text = text.map_err(|_| refused("a model whose file cannot be read"))?;
            let name = node.attribute("name").unwrap_or(name).to_owned();
            parts.push(Attachable { name, file: file(text) });
        }
        files.extend(more);
        next += 1;
    }
    let read = files.iter().map(|file| document(&file.text)).collect::<Result<Vec<_>, _>>()?;
    let mut classes = HashMap::new();
    for (file, document) in files.iter().zip(&read) {
        for node in document.root_element().children().filter(|node| node.has_tag_name("default")) {
            class(node, None, &mut classes).map_err(|node| ImportError::NotAllowed {
                format: "MJCF",
                what: "a class that is defined twice, or has no name",
                name: file.place(node),
            })?;
        }
    }
    let included = |file: usize, name: &str| {
        let path = files[file].folder.join(name);
        let path = path.canonicalize().unwrap_or(path);
        files.iter().position(|file| file.path == path)
    };
    if let Some((file, node, what)) = late(0, &included, &read, &mut Before::default()) {
        return Err(ImportError::Unsupported { what, name: files[file].place(node) });
    }
    let mut out = PassedOver::default();
    for (file, read) in files.iter().zip(&read) {
        for node in read.descendants().filter(Node::is_element) {
            let place = file.place(node);
            if let Some(what) = not_allowed(node, &classes) {
                return Err(ImportError::NotAllowed { format: "MJCF", what, name: place });
            }
            let what = refused(node, &classes).or_else(|| turn_refused(node));
            if let Some(what) = what.or_else(|| class_refused(node, &classes)) {
                return Err(ImportError::Unsupported { what, name: place });
            }
            told(node, &place, &mut out);
        }
        let words = unread(read.root_element(), &MJCF, |node| file.place(node));
        out.left_out.extend(words);
    }
    let mut attachable = HashMap::new();
    for Attachable { name, file } in parts {
        above.files.push(file.path.clone());
        out.left_out.extend(model(file, above)?.left_out);
        // Now that it ends: a reader would follow a model that is a part of itself for ever.
        if let Some(path) = above.files.pop() {
            let read = Model::from_file(&path).map_err(|error| ImportError::Syntax {
                format: "MJCF",
                message: format!("{name}: {error}"),
            })?;
            attachable.insert(name, read);
        }
    }
    for node in read.iter().flat_map(Document::descendants) {
        if node.has_tag_name("attach") {
            check_attached(node, &attachable)?;
        }
    }
    Ok(out)
}

/// The reader passes over what it does not find.
fn check_attached(
    node: Node<'_, '_>,
    attachable: &HashMap<String, Model>,
) -> Result<(), ImportError> {
    let [model, body] = ["model", "body"].map(|what| node.attribute(what).unwrap_or(""));
    let name = format!("body `{body}` of model `{model}`");
    let Some(found) = attachable.get(model) else {
        return Err(ImportError::Unsupported { what: "a model that is not named", name });
    };
    // The first is the world.
    let mut bodies = found.bodies.iter().skip(1);
    if bodies.any(|one| one.body.name.as_deref() == Some(body)) {
        return Ok(());
    }
    Err(ImportError::Unsupported { what: "a body that the attached model has not", name })
}

/// What a shape says itself.
fn said(geom: Node<'_, '_>) -> Said {
    let turned = TURNS.iter().any(|turn| geom.has_attribute(*turn));
    Said {
        pose: [geom.has_attribute("pos"), turned, geom.has_attribute("fromto")],
        sizes: geom.attribute("size").map_or(0, |size| size.split_whitespace().count()),
        kind: geom.attribute("type").map(str::to_owned),
        mesh: geom.has_attribute("mesh"),
    }
}

/// Takes a class and those below it; else says which of them has a name that no class may have.
fn class<'d, 'i>(
    node: Node<'d, 'i>,
    above: Option<&str>,
    classes: &mut HashMap<String, Class>,
) -> Result<(), Node<'d, 'i>> {
    let own = node.attribute("class");
    // The class of all may be told in parts.
    let taken =
        own.is_none_or(|name| name.is_empty() || name == "main" || classes.contains_key(name));
    if above.is_some() && taken {
        return Err(node);
    }
    let name = own.unwrap_or("main");
    let own = classes.entry(name.to_owned()).or_default();
    own.above = above.filter(|above| *above != name).map(str::to_owned);
    for geom in node.children().filter(|child| child.has_tag_name("geom")) {
        let more = said(geom);
        own.said = Said {
            pose: [0, 1, 2].map(|k| own.said.pose[k] || more.pose[k]),
            sizes: own.said.sizes.max(more.sizes),
            kind: more.kind.or(own.said.kind.take()),
            mesh: own.said.mesh || more.mesh,
        };
    }
    for below in node.children().filter(|child| child.has_tag_name("default")) {
        class(below, Some(name), classes)?;
    }
    Ok(())
}

/// What a shape and its classes say, its own words first.
pub(crate) fn levels(geom: Node<'_, '_>, classes: &HashMap<String, Class>) -> Vec<Said> {
    let ambient = || geom.ancestors().find_map(|above| above.attribute("childclass"));
    let mut name = geom.attribute("class").or_else(ambient).unwrap_or("main");
    let mut out = vec![said(geom)];
    // No chain is longer than all classes, even where they go in a circle.
    for _ in 0..=classes.len() {
        let own = classes.get(name);
        out.extend(own.map(|class| class.said.clone()));
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
        "connect" | "weld"
            if node.attribute("active") != Some("false")
                && ["site1", "site2"].iter().any(|site| node.has_attribute(*site)) =>
        {
            Some("a loop that is closed between sites")
        }
        "weld" => {
            let numbers = node.attribute("relpose")?.split_whitespace().count();
            (numbers != 7).then_some("a pose of a weld that is not seven numbers")
        }
        "worldbody" if node.has_attribute("childclass") => Some("a class of the whole world"),
        "compiler" if node.has_attribute("inertiagrouprange") => {
            Some("masses of some groups of shapes")
        }
        "compiler" if node.attribute("balanceinertia") == Some("true") => {
            Some("moments that the compiler balances")
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
            shape_refused(&levels).or_else(|| {
                if levels.iter().any(|said| said.pose[2]) {
                    // Two ends say all of the pose.
                    return inside("frame").then_some("ends of a shape in a frame");
                }
                // The reader takes the whole pose of the first level that says anything of it.
                let poses = levels.iter().map(|said| said.pose);
                let mut saying = poses.skip_while(|says| !(says[0] || says[1]));
                let first = saying.next()?;
                let more = saying.any(|says| (says[0] && !first[0]) || (says[1] && !first[1]));
                more.then_some("a pose that is partly of a class")
            })
        }
        _ => None,
    }
}

/// Why what is of a class would have nothing of it: the reader takes a name that it does not know for no class.
fn class_refused(node: Node<'_, '_>, classes: &HashMap<String, Class>) -> Option<&'static str> {
    let of_one = ["joint", "geom", "connect", "weld", "pair"].contains(&node.tag_name().name());
    let own = node.attribute("class").filter(|_| of_one);
    let mut names = own.into_iter().chain(node.attribute("childclass"));
    let unknown = names.any(|name| name != "main" && !classes.contains_key(name));
    unknown.then_some("a class that nothing defines")
}

/// Why a shape would be another one: the reader takes all of a size from the first level that says anything of it,
/// and fits nothing to a mesh.
fn shape_refused(levels: &[Said]) -> Option<&'static str> {
    let kind = levels.iter().find_map(|said| said.kind.as_deref()).unwrap_or("sphere");
    let between_ends = levels.iter().any(|said| said.pose[2]);
    let needed = match kind {
        "sphere" => 1,
        "capsule" | "cylinder" | "box" | "ellipsoid" if between_ends => 1,
        "capsule" | "cylinder" => 2,
        "box" | "ellipsoid" => 3,
        _ => 0,
    };
    let mut sizes = levels.iter().map(|said| said.sizes).filter(|sizes| *sizes > 0);
    let first = sizes.next().unwrap_or(needed);
    if first < needed && sizes.any(|more| more > first) {
        return Some("a size that is partly of a class");
    }
    let fitted = kind != "mesh" && levels.iter().any(|said| said.mesh);
    fitted.then_some("a shape that is fitted to a mesh")
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
