//! What keeps a description from being a scene.

use stationary_rigid::RigidError;

/// A description that is no scene.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// The file is none of its kind.
    #[error("not readable as {format}: {message}")]
    Syntax {
        /// `URDF` or `MJCF`.
        format: &'static str,
        /// What its reader says.
        message: String,
    },
    /// A joint names a link that is not there.
    #[error("joint `{joint}` names link `{link}`, which does not exist")]
    UnknownLink {
        /// The joint.
        joint: String,
        /// The link.
        link: String,
    },
    /// A loop, or a pair that does not touch, names a body that is not there.
    #[error("{what} names body `{body}`, which does not exist")]
    UnknownBody {
        /// The element, and its name where it has one.
        what: String,
        /// The body.
        body: String,
    },
    /// A link hangs on two joints, or links hang on one another in a circle.
    #[error(
        "link `{link}` is the child of joint `{first}` and of joint `{second}`; links must form a tree"
    )]
    TwoParents {
        /// The link.
        link: String,
        /// One joint.
        first: String,
        /// The other.
        second: String,
    },
    /// Two parts have one name.
    #[error("{what} `{name}` is defined twice, or has a name that is taken")]
    Duplicate {
        /// `link`, `body`, `joint` or `geom`.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// No link is the root, or several are.
    #[error("{count} links have no parent ({names}); one link must be the root")]
    Roots {
        /// How many there are.
        count: usize,
        /// Their names.
        names: String,
    },
    /// A part that moves has no mass.
    #[error("`{name}` moves and has no mass; give it a positive mass, or fix it to what has one")]
    Massless {
        /// The part.
        name: String,
    },
    /// No body has such a mass or such moments.
    #[error("`{name}` is no body: {source}")]
    Body {
        /// The part.
        name: String,
        /// Why.
        source: Box<RigidError>,
    },
    /// A number is no number, or too large for one.
    #[error("{what} of `{name}` is not finite")]
    NonFinite {
        /// What it is.
        what: &'static str,
        /// Whose.
        name: String,
    },
    /// A number below zero where no scene has one.
    #[error("{what} of `{name}` is {value:?}; it must not be negative")]
    Negative {
        /// What it is.
        what: &'static str,
        /// Whose.
        name: String,
        /// The number.
        value: f64,
    },
    /// An axis of length zero.
    #[error("joint `{joint}` has an axis of length zero")]
    Axis {
        /// The joint.
        joint: String,
    },
    /// Without this the motion could not be told.
    #[error("{what} (`{name}`): a scene has nothing for it")]
    Unsupported {
        /// What it is.
        what: &'static str,
        /// Whose.
        name: String,
    },
    /// What the format itself does not allow.
    #[error("{what} (`{name}`): {format} does not allow it")]
    NotAllowed {
        /// `URDF` or `MJCF`.
        format: &'static str,
        /// What it is.
        what: &'static str,
        /// Where it stands.
        name: String,
    },
    /// There is nothing that moves.
    #[error("nothing moves: every link is fixed to the world")]
    Empty,
}
