//! Which scene does a robot's description tell? Bodies and joints of URDF and MJCF files, as the text of a scene.
//!
//! ```text
//! T_child = T_parent T_joint                   where links and bodies are, all joints at zero
//! m, c, J of all pieces as one                 links that are fixed to one another: one body
//! J = R diag(J_1, J_2, J_3) R^T                its principal axes, which are those of the scene's body
//! ```
//! `T` poses in the world, `m` masses (kg), `c` centres (m), `J` inertia tensors (kg m^2), `R` the axes. Masses and
//! moments are the crate rigid's.
//!
//! ```
//! # #[cfg(feature = "urdf")] {
//! let robot = r#"<robot name="swing">
//!   <link name="base"/>
//!   <link name="arm"><inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
//!     <inertia ixx="0.1" iyy="0.1" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
//!   <joint name="shoulder" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/></joint>
//! </robot>"#;
//! let scene = stationary_import::scene_of_urdf(robot)?;
//! assert!(scene.left_out.is_empty() && scene.text.contains("kind = \"hinge\""));
//! # }
//! # Ok::<(), stationary_import::ImportError>(())
//! ```
//!
//! Reading order: what a [`Description`] holds, `scene_of_urdf` and `scene_of_mjcf`, each behind the feature of its
//! name. What only a scene lacks is left out and named, in the text as well, since a motion without it is
//! another one: limits that the start is beyond, armature, actuators, shapes of other kinds. What cannot be told without it
//! is an [`ImportError`]: several joints of one body, joints that follow another, masses of surfaces.

mod error;
#[cfg(any(feature = "urdf", feature = "mjcf"))]
mod robot;
#[cfg(any(feature = "urdf", feature = "mjcf"))]
mod text;
#[cfg(feature = "urdf")]
mod urdf;
#[cfg(feature = "urdf")]
mod urdf_words;
#[cfg(feature = "mjcf")]
mod mjcf;
#[cfg(any(feature = "urdf", feature = "mjcf"))]
mod unread;
#[cfg(feature = "mjcf")]
mod known_words;
#[cfg(feature = "mjcf")]
mod not_allowed;
#[cfg(feature = "mjcf")]
mod passed_over;
#[cfg(feature = "mjcf")]
mod reading_order;
#[cfg(feature = "mjcf")]
mod shapes;
#[cfg(feature = "mjcf")]
mod turns;

pub use error::ImportError;
#[cfg(feature = "mjcf")]
pub use mjcf::scene_of_mjcf;
#[cfg(feature = "urdf")]
pub use urdf::scene_of_urdf;

/// A scene that a description tells.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// The text of the scene.
    pub text: String,
    /// What the description has and the scene has not, each with its name.
    pub left_out: Vec<String>,
}
