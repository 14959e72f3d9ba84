//! What MuJoCo refuses and the reader takes: an element that says two things at once, or too few.

use std::collections::HashMap;

use roxmltree::Node;

use crate::passed_over::{Class, levels};
use crate::turns::TURNS;

/// Numbers of a size and of a friction, at most.
const MOST: usize = 3;

/// Why MJCF does not allow an element.
pub(crate) fn not_allowed(
    node: Node<'_, '_>,
    classes: &HashMap<String, Class>,
) -> Option<&'static str> {
    let inside = |tag: &str| node.parent_element().is_some_and(|above| above.has_tag_name(tag));
    match node.tag_name().name() {
        "inertial" => {
            let turned = TURNS.iter().any(|turn| node.has_attribute(*turn));
            let first = node.prev_siblings().skip(1).all(|other| !other.has_tag_name("inertial"));
            let whole = ["pos", "mass"].iter().all(|word| node.has_attribute(*word));
            match node.has_attribute("fullinertia") {
                _ if !first => Some("two masses of one body"),
                _ if !whole => Some("a mass without `pos` or `mass`"),
                true if node.has_attribute("diaginertia") => Some("a tensor beside moments"),
                true if turned => Some("a tensor beside a turn"),
                _ => None,
            }
        }
        "geom" => {
            let many =
                |word| node.attribute(word).is_some_and(|x| x.split_whitespace().count() > MOST);
            if ["size", "friction"].into_iter().any(many) {
                return Some("more than three numbers of a size or a friction");
            }
            if inside("default") {
                return None;
            }
            let levels = levels(node, classes);
            let says = |k: usize| levels.iter().any(|said| said.pose[k]);
            let kind = levels.iter().find_map(|said| said.kind.as_deref()).unwrap_or("sphere");
            let long = ["capsule", "cylinder", "box", "ellipsoid"].contains(&kind);
            match says(2) {
                true if says(0) => Some("a place beside two ends"),
                true if !long => Some("two ends of a shape that has none"),
                _ => None,
            }
        }
        _ => None,
    }
}
