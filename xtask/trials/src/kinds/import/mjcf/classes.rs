//! What elements say, said by classes in their place.

use super::super::element::Element;
use crate::Draw;

/// Words that a class may say, with a value that is another.
const OF_JOINTS: [(&str, &str); 7] = [
    ("axis", "0.6 0 0.8"),
    ("pos", "3 2 1"),
    ("damping", "11"),
    ("stiffness", "12"),
    ("frictionloss", "13"),
    ("ref", "0.5"),
    ("springref", "0.25"),
];
const OF_SHAPES: [(&str, &str); 3] = [("density", "17"), ("contype", "1"), ("conaffinity", "1")];

/// Moves some of what joints and shapes say into classes, below classes that say other things; and the defaults.
pub(super) fn classes(draw: &mut Draw, world: &mut Element) -> Element {
    let mut main = Element::new("default");
    let mut count = 0;
    visit(draw, world, &mut main, &mut count);
    main
}

fn visit(draw: &mut Draw, element: &mut Element, main: &mut Element, count: &mut usize) {
    let words: &[(&'static str, &str)] = match element.tag {
        "joint" => &OF_JOINTS,
        "geom" => &OF_SHAPES,
        _ => &[],
    };
    let said = words.iter().filter(|(word, _)| element.said.iter().any(|(own, _)| own == word));
    let said: Vec<_> = said.copied().collect();
    if !said.is_empty() && draw.chance(0.4) {
        *count += 1;
        let (mut above, mut class) = (Element::new(element.tag), Element::new(element.tag));
        for (word, other) in said {
            let place = element.said.iter().position(|(own, _)| *own == word);
            let Some(place) = place else { continue };
            match draw.below(4) {
                // It overrules a class, and that one the class above.
                0 => class = class.says(word, other),
                1 => class.said.push(element.said.remove(place)),
                2 => {
                    class.said.push(element.said.remove(place));
                    above = above.says(word, other);
                }
                _ => above.said.push(element.said.remove(place)),
            }
        }
        let [outer, inner] = ["outer", "inner"].map(|name| format!("{name}{count}"));
        let class = Element::new("default").says("class", &inner).with(class);
        let above = Element::new("default").says("class", outer).with(above).with(class);
        main.inside.push(above);
        element.said.push(("class", inner));
    }
    let inside = std::mem::take(&mut element.inside);
    for mut inside in inside {
        visit(draw, &mut inside, main, count);
        element.inside.push(inside);
    }
}
