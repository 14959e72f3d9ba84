//! A chart inside the page, whose script shows the numbers of its marks.
//!
//! A file of its own says them in `<title>` elements. In the page they are attributes, a mark is one
//! element, and the chart can be reached by the keyboard.

use std::fmt::Write;

/// The chart of a file that is [inline](stationary_chart::Medium::Inline), as the page has it.
pub(super) fn inline(svg: &str) -> String {
    let mut text = String::with_capacity(svg.len());
    let mut rest = svg;
    // Text of a chart is escaped, so these letters stand for elements alone.
    while let Some((before, titled)) = rest.split_once("><title>") {
        let (start, tag) = before.split_at(before.rfind('<').unwrap_or(0));
        let (said, after) = titled.split_once("</title>").unwrap_or((titled, ""));
        text.push_str(start);
        rest = match lone_mark(tag, after) {
            Some((class, mark, after)) => {
                let tag = tag.trim_start_matches("<g ").replacen(
                    r#"class="pt"#,
                    &format!(r#"class="pt {class}"#),
                    1,
                );
                // Writing to a String cannot fail.
                let _ = write!(text, r#"<{} {tag} data-says="{said}"{}/>"#, mark.0, mark.1);
                after
            }
            None => {
                let _ = write!(text, r#"{tag} data-says="{said}">"#);
                after
            }
        };
    }
    text.push_str(rest);
    text.replacen("<svg ", r#"<svg tabindex="0" aria-describedby="keys" "#, 1)
}

/// The class, the element with its other attributes, and what follows, where a group of a mark holds
/// one element.
fn lone_mark<'a>(tag: &str, after: &'a str) -> Option<(&'a str, (&'a str, &'a str), &'a str)> {
    let (inside, after) = tag.starts_with("<g ").then(|| after.split_once("</g>"))??;
    let element = inside.strip_prefix('<')?.strip_suffix("/>")?;
    let (name, attributes) = element.split_once(r#" class=""#)?;
    let (class, attributes) = attributes.split_once('"')?;
    (!attributes.contains('<')).then_some((class, (name, attributes), after))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mark_is_one_element_that_says_its_numbers() {
        let svg = "<svg class=\"chart\"><g class=\"pt \" transform=\"translate(1 2)\"><title>a\n\
                   x: 1</title><path class=\"mk\" d=\"M0 0z\"/></g></svg>";
        let own = "<svg tabindex=\"0\" aria-describedby=\"keys\" class=\"chart\"><path \
                   class=\"pt mk \" transform=\"translate(1 2)\" data-says=\"a\nx: 1\" d=\"M0 \
                   0z\"/></svg>";
        assert_eq!(inline(svg), own);
    }

    #[test]
    fn a_mark_of_two_elements_stays_a_group() {
        let svg = "<g class=\"pt \"><title>a</title><path class=\"off\"/><path class=\"hid\"/></g>";
        assert_eq!(
            inline(svg),
            "<g class=\"pt \" data-says=\"a\"><path class=\"off\"/><path class=\"hid\"/></g>"
        );
    }

    #[test]
    fn a_cell_says_its_outcome() {
        assert_eq!(
            inline("<path class=\"cell\" d=\"M0 0z\"><title>holds</title></path>"),
            "<path class=\"cell\" d=\"M0 0z\" data-says=\"holds\"></path>"
        );
    }
}
