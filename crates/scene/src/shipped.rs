//! What ships with the crate beside its code: scenes to begin with, and the words of a scene.

/// A scene that ships with the crate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shipped {
    /// Its name, that of its file without the ending.
    pub name: &'static str,
    /// The text of the file.
    pub text: &'static str,
}

macro_rules! shipped {
    ($($name:literal),* $(,)?) => {
        /// The scenes that need no other file, in alphabetical order.
        pub const SCENES: &[Shipped] = &[$(
            Shipped { name: $name, text: include_str!(concat!("../scenes/", $name, ".toml")) },
        )*];
    };
}

shipped!(
    "ball-strikes-a-pendulum",
    "billiard-with-spin",
    "block-on-incline",
    "box-stack",
    "breaking-bridge",
    "cantilever",
    "cloth-on-a-ball",
    "domino-row",
    "foucault-pendulum",
    "four-bar-pushes-a-crate",
    "galton-board",
    "heavy-top",
    "masonry-arch",
    "newtons-cradle",
    "newtons-cradle-on-rods",
    "nine-ball-break",
    "outer-solar-system",
    "pendulum-chain",
    "plunger-shoots-a-ball",
    "slider-crank-with-stop",
    "slinky-release",
    "spring-net",
    "sprung-door",
    "thrown-racket",
    "tippe-top",
    "tumbling-wrench",
    "warm-sphere",
    "wheel-over-a-bump",
);

/// The JSON schema of a scene's file: every word, what it means and what it may be.
pub const SCHEMA: &str = include_str!("../scene.schema.json");

impl Shipped {
    /// What the scene is: the first sentence of the comment at its head.
    pub fn summary(&self) -> String {
        let comment = self.text.lines().skip_while(|line| !line.starts_with("# "));
        let lines = comment.map_while(|line| line.strip_prefix("# "));
        let text = lines.collect::<Vec<_>>().join(" ");
        // A point within a number ends no sentence.
        let end = text.find(". ").map_or(text.len(), |last| last + 1);
        text[..end].to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_says_at_its_head_what_it_is() {
        for scene in SCENES {
            assert!(scene.summary().len() > 20, "{}: {}", scene.name, scene.summary());
        }
    }
}
