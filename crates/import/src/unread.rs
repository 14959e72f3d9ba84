//! What nothing reads of a file: elements, and what the others say.

use roxmltree::Node;

/// What stands in an element.
pub(crate) type Inside = (&'static str, &'static [&'static str]);

/// The words of a format.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Words {
    /// What is looked at in each element.
    pub(crate) inside: &'static [Inside],
    /// Whether an element of this name, in one of the first, is left alone with all that stands in it.
    pub(crate) is_left_alone: fn(&str, &str) -> bool,
    /// Whether an element's word with this value is read, or changes no motion.
    pub(crate) is_read: fn(&str, &str, &str) -> bool,
}

/// Whether the words of an element, parted by blanks, have this one.
pub(crate) fn says(all: &[(&str, &str)], tag: &str, word: &str) -> bool {
    let own = all.iter().filter(|(name, _)| *name == tag);
    own.flat_map(|(_, said)| said.split_whitespace()).any(|own| own == word)
}

/// What nothing reads of a file; `place` names an element.
pub(crate) fn unread(
    root: Node<'_, '_>,
    words: &Words,
    place: impl Fn(Node<'_, '_>) -> String,
) -> Vec<String> {
    let (mut waiting, mut out) = (vec![root], Vec::new());
    while let Some(node) = waiting.pop() {
        let tag = node.tag_name().name();
        let said =
            node.attributes().filter(|said| !(words.is_read)(tag, said.name(), said.value()));
        out.extend(said.map(|said| format!("`{}` of {}", said.name(), place(node))));
        let inside = words.inside.iter().find(|(name, _)| *name == tag);
        let inside = inside.map_or(&[][..], |(_, inside)| inside);
        let mut next = Vec::new();
        for child in node.children().filter(Node::is_element) {
            let name = child.tag_name().name();
            if inside.contains(&name) {
                next.push(child);
            } else if !(words.is_left_alone)(tag, name) {
                out.push(format!("unknown element {}", place(child)));
            }
        }
        // In the order of the file.
        waiting.extend(next.into_iter().rev());
    }
    out
}
