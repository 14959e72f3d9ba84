//! Which scene does a robot's description tell? Bodies and joints of URDF and MJCF files, as the text of a scene.
//!
//! ```text
//! m = sum m_k,   c = sum m_k c_k / m                       links that are fixed to one another: one body
//! J = sum J_k + m_k (|d_k|^2 1 - d_k d_k^T),  d_k = c_k - c          their moments, by the parallel axes
//! J = R diag(J_1, J_2, J_3) R^T,   J_1 <= J_2 + J_3, and so on       principal axes; a body can have no others
//! ```
//! `m` masses (kg), `c` centres (m), `J` moments about them (kg m^2) in axes of the world, `R` the axes of the body
//! that the scene has.
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
//! another one: limits and friction of joints, actuators, shapes of other kinds. What cannot be told without it
//! is an [`ImportError`]: several joints of one body, joints that follow another, masses of surfaces.

mod error;
#[cfg(any(feature = "urdf", feature = "mjcf"))]
mod inertia;
#[cfg(any(feature = "urdf", feature = "mjcf"))]
mod robot;
#[cfg(any(feature = "urdf", feature = "mjcf"))]
mod text;
#[cfg(feature = "urdf")]
mod urdf;
#[cfg(feature = "mjcf")]
mod mjcf;

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
