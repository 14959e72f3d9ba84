//! Settings of MJCF that its reader meets too late: MuJoCo takes those of all files before any body, the reader takes
//! each file as it comes, its bodies last.

use roxmltree::{Document, Node};

/// What was read before.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Before {
    /// Bodies of a file that ended.
    bodies: bool,
    /// Turns by angles, in a class.
    turns: bool,
    /// Classes, which have what all have from then on.
    classes: bool,
    equalities: bool,
}

/// The first element that comes too late, in which file, and what it is; `included` finds the file that another
/// includes.
pub(crate) fn late<'d, 'i>(
    file: usize,
    included: &impl Fn(usize, &str) -> Option<usize>,
    read: &'d [Document<'i>],
    before: &mut Before,
) -> Option<(usize, Node<'d, 'i>, &'static str)> {
    let mut bodies = false;
    for node in read[file].root_element().children() {
        let what = match node.tag_name().name() {
            "include" => {
                let other = node.attribute("file").and_then(|name| included(file, name));
                let found = other.and_then(|other| late(other, included, read, before));
                if found.is_some() {
                    return found;
                }
                None
            }
            "compiler" => {
                let turns = ["angle", "eulerseq"].iter().any(|turn| node.has_attribute(*turn));
                let late = turns && (before.bodies || before.turns);
                late.then_some("angles of a compiler after what is measured in them")
            }
            "default" => default(node, before),
            "equality" => {
                before.equalities = true;
                None
            }
            "worldbody" => {
                bodies = true;
                None
            }
            _ => None,
        };
        if let Some(what) = what {
            return Some((file, node, what));
        }
    }
    before.bodies |= bodies;
    None
}

/// Why a class comes too late.
fn default(node: Node<'_, '_>, before: &mut Before) -> Option<&'static str> {
    let moves = ["joint", "geom", "equality", "pair"];
    let of_all = node.children().any(|child| moves.contains(&child.tag_name().name()));
    let tells = |tag: &str| node.descendants().any(|below| below.has_tag_name(tag));
    if before.bodies {
        return Some("classes after a file with bodies");
    }
    if before.equalities && tells("equality") {
        return Some("a class of equalities after these");
    }
    if before.classes && of_all {
        return Some("what all classes have after classes");
    }
    before.classes |= node.children().any(|child| child.has_tag_name("default"));
    before.turns |= node.descendants().any(|below| {
        below.has_tag_name("geom")
            && ["euler", "axisangle"].iter().any(|turn| below.has_attribute(*turn))
    });
    None
}
