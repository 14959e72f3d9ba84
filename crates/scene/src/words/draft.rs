//! A scene while its words are declared, one after the other.

use std::path::Path;

use crate::model::drives::Drives;
use crate::model::elastic_body::HeatedBody;
use crate::model::items::{Link, RigidBody, Rod, SceneContact, SceneJoint};
use crate::model::scene::Gravity;
use crate::words::laid_shape::Solids;
use crate::words::particle_table::ParticleTable;

/// What the words of a scene have added so far.
pub(crate) struct Draft<'a> {
    pub(crate) dimension: usize,
    /// The folder of the scene's file, where it has one.
    pub(crate) folder: Option<&'a Path>,
    pub(crate) particles: ParticleTable,
    /// How many of the particles are written out, or are centres of bodies.
    pub(crate) written_out: usize,
    pub(crate) links: Vec<Link>,
    pub(crate) rods: Vec<Rod>,
    pub(crate) bodies: Vec<DeclaredBody>,
    pub(crate) joints: Vec<SceneJoint>,
    pub(crate) solids: Solids,
    pub(crate) heat: Option<HeatedBody>,
    pub(crate) contact: Option<SceneContact>,
    pub(crate) gravity: Gravity,
    pub(crate) drag: Option<f64>,
    pub(crate) frame: Option<[f64; 3]>,
    pub(crate) drives: Drives,
}

/// A body with what only its declaration knows.
#[derive(Clone, Debug)]
pub(crate) struct DeclaredBody {
    pub(crate) body: RigidBody,
    /// Whether its velocity was given; if not, joints determine it.
    pub(crate) has_velocity: bool,
    /// Whether its angular velocity was.
    pub(crate) has_spin: bool,
}

impl<'a> Draft<'a> {
    pub(crate) fn new(dimension: usize, folder: Option<&'a Path>) -> Self {
        Draft {
            dimension,
            folder,
            particles: ParticleTable::default(),
            written_out: 0,
            links: Vec::new(),
            rods: Vec::new(),
            bodies: Vec::new(),
            joints: Vec::new(),
            solids: Solids::default(),
            heat: None,
            contact: None,
            gravity: Gravity { acceleration: None, constant: None, fixed: Vec::new() },
            drag: None,
            frame: None,
            drives: Drives::default(),
        }
    }
}
