//! Turns of MJCF that its reader takes for others.

use nalgebra::Vector3;
use roxmltree::Node;

/// Attributes that turn a frame.
pub(crate) const TURNS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];
/// Lengths below this have no direction.
const NO_LENGTH: f64 = 1e-14;
/// The sine below which the reader takes an axis for one that points straight down.
const STRAIGHT: f64 = 1e-7;

/// Why a frame would be turned another way than the description says.
pub(crate) fn turn_refused(node: Node<'_, '_>) -> Option<&'static str> {
    let tag = node.tag_name().name();
    if tag == "compiler" {
        let sequence = node.attribute("eulerseq")?;
        let right = sequence.len() == 3 && sequence.chars().all(|axis| "xyzXYZ".contains(axis));
        return (!right).then_some("a sequence of turns that is not three of x, y, z, X, Y, Z");
    }
    if !["body", "frame", "geom", "inertial"].contains(&tag) {
        return None;
    }
    let mut turns = TURNS.into_iter().filter_map(|turn| Some((turn, node.attribute(turn)?)));
    let (turn, text) = turns.next()?;
    if turns.next().is_some() {
        return Some("several turns of one frame");
    }
    // What is no number the reader refuses.
    let numbers: Vec<f64> = text.split_whitespace().filter_map(|x| x.parse().ok()).collect();
    let none = |length: f64| length <= NO_LENGTH;
    let no_turn = match (turn, &numbers[..]) {
        ("quat", quat) => none(quat.iter().map(|x| x * x).sum::<f64>().sqrt()),
        ("axisangle", &[x, y, z, _]) => none(Vector3::new(x, y, z).norm()),
        ("xyaxes", &[a, b, c, d, e, f]) => {
            let (x, y) = (Vector3::new(a, b, c), Vector3::new(d, e, f));
            none(x.norm()) || none(x.normalize().cross(&y).norm())
        }
        ("zaxis", &[x, y, z]) => {
            // Of a shape the half turn that is left open changes nothing.
            let down = z < 0.0 && x.hypot(y) <= STRAIGHT * -z;
            if down && ["body", "frame"].contains(&tag) {
                return Some("a z axis straight down, which leaves the others open");
            }
            none(Vector3::new(x, y, z).norm())
        }
        _ => false,
    };
    no_turn.then_some("a turn about no axis")
}
