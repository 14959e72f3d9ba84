//! Words of MJCF that nothing here reads: told, unless they change no motion.

use crate::unread::{Words, says};

/// Elements that change no motion, or that are told or refused as a whole: nothing in them is looked at.
const WHOLE: [&str; 23] = [
    "visual",
    "statistic",
    "size",
    "asset",
    "custom",
    "sensor",
    "keyframe",
    "actuator",
    "tendon",
    "extension",
    "lengthrange",
    "camera",
    "light",
    "site",
    "skin",
    "plugin",
    "replicate",
    "composite",
    "flexcomp",
    "flex",
    "pair",
    "include",
    "attach",
];

/// What stands in an element, as the reader or this crate has it.
const INSIDE: [(&str, &[&str]); 8] = [
    (
        "mujoco",
        &["compiler", "option", "default", "worldbody", "deformable", "contact", "equality"],
    ),
    ("option", &["flag"]),
    ("default", &["default", "joint", "geom"]),
    ("worldbody", &["body", "frame", "geom"]),
    ("body", &["body", "frame", "geom", "joint", "freejoint", "inertial"]),
    ("frame", &["body", "frame", "geom", "joint", "freejoint", "inertial"]),
    ("contact", &["exclude"]),
    ("equality", &["connect", "weld"]),
];

/// Elements that are left alone where they stand in these: classes of what changes no motion or is told by itself,
/// and what follows another, which is refused.
const ALONE: [(&str, &[&str]); 2] = [("default", &OF_CLASSES), ("equality", &["joint"])];

/// Classes of what changes no motion, or is told or refused by itself.
const OF_CLASSES: [&str; 16] = [
    "mesh",
    "texture",
    "material",
    "equality",
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "orientation",
    "pid",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
    "dcmotor",
];

/// What any element may say and no motion shows, names and how soft contacts, limits and loops are among it.
const ANYWHERE: [&str; 14] = [
    "name",
    "class",
    "childclass",
    "user",
    "group",
    "rgba",
    "material",
    "solref",
    "solimp",
    "solmix",
    "solreflimit",
    "solimplimit",
    "solreffriction",
    "solimpfriction",
];

/// Where a frame is in its parent's.
const POSE: [&str; 6] = ["pos", "quat", "axisangle", "euler", "xyaxes", "zaxis"];

/// What else an element says that is read, told elsewhere, or changes no motion.
const SAID: [(&str, &str); 12] = [
    ("mujoco", "model"),
    (
        "compiler",
        "angle assetdir autolimits balanceinertia boundinertia boundmass coordinate discardvisual eulerseq \
         inertiafromgeom inertiagrouprange meshdir settotalmass strippath texturedir usethread convexhull \
         exactmeshinertia fusestatic alignfree conflict fitaabb saveinertial savecompiled savecanonical passthrough",
    ),
    (
        "option",
        "timestep gravity density viscosity wind integrator solver cone jacobian impratio iterations tolerance \
         ls_iterations ls_tolerance noslip_iterations noslip_tolerance ccd_iterations ccd_tolerance mpr_iterations \
         mpr_tolerance sdf_iterations sdf_initpoints sleep_tolerance actuatorgroupdisable magnetic apirate \
         o_margin o_solref o_solimp o_friction",
    ),
    (
        "flag",
        "constraint equality frictionloss limit contact passive spring damper filterparent gravity override \
         actuation autoreset clampctrl diagexact energy eulerdamp fwdinv invdiscrete ipc island midphase multiccd \
         nativeccd refsafe sensor sleep speculative warmstart",
    ),
    ("body", "mocap gravcomp sleep simple fuse"),
    ("freejoint", "align"),
    ("inertial", "mass diaginertia fullinertia"),
    (
        "joint",
        "type pos axis limited range stiffness damping springref springdamper armature frictionloss ref \
         actuatorfrclimited actuatorfrcrange actuatorgravcomp",
    ),
    (
        "geom",
        "type size fromto mass density friction contype conaffinity condim priority mesh hfield shellinertia \
         fitscale fluidshape fluidcoef castshadow",
    ),
    ("exclude", "body1 body2"),
    ("connect", "active body1 body2 anchor site1 site2"),
    ("weld", "active body1 body2 anchor relpose torquescale site1 site2"),
];

/// What changes nothing where it is zero.
const UNLESS_ZERO: [&str; 5] = ["margin", "gap", "adhesion", "surfacevel", "springyield"];

/// The words of MJCF.
pub(crate) const MJCF: Words = Words {
    inside: &INSIDE,
    is_left_alone: |tag, child| {
        let alone = ALONE.iter().any(|(name, alone)| *name == tag && alone.contains(&child));
        alone || WHOLE.contains(&child)
    },
    is_read,
};

/// Whether what an element says is read, or changes no motion.
fn is_read(tag: &str, word: &str, value: &str) -> bool {
    let posed = ["body", "frame", "geom", "inertial"].contains(&tag);
    ANYWHERE.contains(&word)
        || (posed && POSE.contains(&word))
        || says(&SAID, tag, word)
        || (UNLESS_ZERO.contains(&word) && value.split_whitespace().all(|x| x.parse() == Ok(0.0)))
}
