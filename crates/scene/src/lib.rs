//! Given a few lines that say what is there, where does everything go? A scene file, checked and run.
//!
//! ```
//! use stationary_scene::Scene;
//!
//! let scene = Scene::parse("pendulum.toml", r#"
//!     dimension = 2
//!     integrator = "stormer-verlet"
//!     step = 0.001
//!     horizon = 10
//!     uniform_gravity = { acceleration = [0, -9.81] }
//!     particles = [
//!         { name = "hook", position = [0, 0], pinned = true },
//!         { name = "bob", position = [1, 0], mass = 0.2 },
//!     ]
//!     springs = [{ between = ["hook", "bob"], stiffness = 500 }]
//! "#)?;
//! let run = scene.run()?;
//! assert_eq!(run.times().len(), 10_001);
//! assert!(run.energies().iter().all(|energy| energy.abs() < 1e-3));
//! println!("{}", run.summary());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The vocabulary
//!
//! Keys join words by underscores, names join them by hyphens. Vectors have as many components as the
//! scene has dimensions. Any units will do that fit together; without `[units]` they are called m, s, kg.
//!
//! [`vocabulary`] makes the schema and a page of every table and key from what the reader reads.
//!
//! | key | value | |
//! | --- | --- | --- |
//! | `title` | a text | the file's name where it is missing |
//! | `dimension` | 1, 2 or 3 | |
//! | `integrator` | a method of [`stationary_integrators::Method`], `"dormand-prince-853"`, `"dormand-prince-54"`, `"radau-iia-5"`, `"bdf-5"`, `"rattle"`, `"constrained-hamilton"` or `"linear-modes"`; of bodies in space one of [`stationary_rigid::BodyMethod`], in the coordinates of their joints `"joint-coordinates"` or one of the first two of these, with impacts at their instant `"event-driven-2"` or `"event-driven-4"`, in steps chosen by their error `"error-controlled"`; of heat one of [`stationary_laplacian::HeatMethod`] or `"linear-modes"` | such as `"stormer-verlet"`, `"variational-rotation"`, `"implicit-euler"`; the two before `"linear-modes"` are for rods |
//! | `tolerance` | below 1 | for those that choose their own steps, and only for them |
//! | `modes` | a number | how many of them `"linear-modes"` adds up |
//! | `step`, `horizon` | times | the horizon is a whole number of steps; a method that chooses its own is read off at them |
//! | `sample_every` | a number of steps | 1 where it is missing; the end is always sampled |
//! | `observables` | `"energy"`, `"kinetic-energy"`, `"potential-energy"`, `"linear-momentum"`, `"angular-momentum"`, `{ position = NAME }`, `{ velocity = NAME }`, `{ distance = [NAME, NAME] }`, `{ tension = [NAME, NAME] }`, `{ angular_velocity = NAME }`; of heat `"heat"`, `"dirichlet-energy"`, `{ temperature = NAME }` | energy and momenta where it is missing |
//! | `view` | a vector to the eye | for the picture of a scene in space |
//! | `[[claims]]` | `of` and `component`, or an `event`; `what`, `at`, `is`, `within`, `source` | sentences about the run that it checks |
//! | `[parameters]` | numbers by name | for arithmetic wherever a number may stand |
//! | `[units]` | `length`, `time`, `mass` | words for headings; they change no number |
//! | `[uniform_gravity]` | `acceleration`, `strength` | a vector, and how strong it is in time |
//! | `[newtonian_gravity]` | `constant` | between every two particles and, in space, bodies that are a `ball`, outside of each other; a particle that is pinned and has a mass attracts, and stays |
//! | `[drag]` | `coefficient` | holds back every free particle and the centre of every body by the coefficient times its velocity; for methods of order up to 2, those that choose their own steps and flight between impacts |
//! | `[frame]` | `angular_velocity` | of a frame that turns about the origin, in which everything is seen |
//! | `[contact]` | `restitution`, `friction`, `law`, `when`, `stiffness`, `walls`, `balls` | what has a radius touches: see below |
//! | `[[particles]]` | `name`, `mass`, `position`, `velocity` or `momentum`, `pinned`, `radius` | at rest where neither is given; `pinned = true` needs no mass; a point without a radius |
//! | `[[springs]]` | `between`, `stiffness`, `rest_length`, `damping`, `strain` | between particles and points of bodies; at rest at the start where no rest length is given; strain `"cauchy"` or `"green"` |
//! | `[[rods]]` | `between`, `strength` | as long as at the start; breaks beyond the strength, with `rattle` or beside bodies; other methods of equal steps are followed by a projection |
//! | `[[chains]]` | `name`, `between`, `links`, `particle_mass` | particles called `name.1`, `name.2`, ..., joined by rods, on the line between two others |
//! | `[[nets]]` | `name`, `rows`, `columns`, `spacing`, `origin`, `across`, `down`, `particle_mass`, `stiffness`, `strain`, `pinned` | its vertices are called `name.row.column`, from 0; pinned are corners such as `"top-left"` and sides such as `"top"` |
//! | `[[solids]]` | `name`, `shape`, `section` or `thickness`, `density`, `element`, `material`, `young`, `poisson`, `bending`, `pinned`, `hung`, `velocity`, `struck`, `marks` | elastic: a bar with its section, a sheet with its thickness, or a block, of elements `"linear"` or `"quadratic"`; its vertices are called `name.0`, `name.1`, ... and `name.MARK` |
//! | `[heat]` | `name`, `shape`, `diffusivity`, `warm`, `held`, `sources`, `marks` | heat that flows through a shape, and nothing else |
//! | `[[bodies]]` | `name`, `mass`, a shape or `moments`, `points`, `position`, `rotation`, `velocity`, `angular_velocity` | the shape is a `box` by its sides, a `ball` (in the plane a disc), a `polygon`, a `capsule`, in space a `cylinder`, `cone`, `ellipsoid` or `hull`, or `parts` with masses of their own; polygons, hulls and parts are laid with their centre of mass at the position, or without one stay where they are drawn; moments are about the body's axes (one in the plane); points in body axes are called `name.0`, `name.1`, after the corners; a rotation is axis times angle, in the plane a number, as is an angular velocity, which in space is in body axes |
//! | `[[joints]]` | `kind`, `between`, `at`, `axis`, `stiffness`, `rest`, `damping`, `limits`, `friction` | in space `"ball"`, `"hinge"`, `"slider"` (with their axis) or `"fixed"`, in the plane `"pin"`, `"slider"` or `"weld"`, between two bodies or a body and `"world"`; place and axis are those of the start, in the world; a pin or a hinge may have a spring and a damper; these and sliders limits and dry friction |
//! | `[[motors]]` | `between`, `torque` or `speed` | at a pin or a hinge: of the second against the first, a number or a strength in time |
//! | `[[loads]]` | `on`, `force`, `torque`, `strength` | on a particle, a body, or a point of a body, in world axes |
//! | `[[motions]]` | `of`, `shift`, `strength` | a pinned particle that moves, pulls at its springs and rods, and pushes what its radius meets |
//!
//! A text that begins with `=` is arithmetic wherever a number may stand, with the numbers of
//! `[parameters]`: `position = ["= 2*L", 0]`. [`Scene::read_with`] gives parameters other values.
//!
//! A `strength` is a number or one of `{ step = [0, 1], at = 2 }`, `{ ramp = [0, 1], from = 0, to = 2 }`,
//! `{ sine = 1, frequency = 50 }` and `{ table = "load.csv" }`, times and values in a file beside the scene's.
//! The summary closes the energy's budget with the works of all that acts.
//!
//! A claim is `of` one of the observables, with the `component` of a vector: its `value` `at` a sample's time or
//! at the end, its `least` or `largest` is a number; its `rise`, `drift` or `relative-drift` is nothing; or an
//! `event` has a time. Each has a band and a `source`. [`Run::claims`] says which hold.
//!
//! A `shape` has a `kind` with its `size` and its `cells`, or is what a `file` beside the scene's holds:
//! the surface of an OBJ file, or the tetrahedra of Gmsh's MSH file, or its triangles where it has no
//! tetrahedra. It starts at its `origin` and runs along `across` and `up`.
//!
//! | kind | size | cells | dimensions |
//! | --- | --- | --- | --- |
//! | `"bar"` | length | along it | 1, 2, 3 |
//! | `"rectangle"`, `"disc"` | two sides; radius | along each; rings | 2, 3 |
//! | `"box"`, `"ball"` | three sides; radius | along each; refinements | 3 |
//! | `"sphere"`, `"torus"` | radius; radii of its circle and its tube | refinements; around each | 3 |
//!
//! Parts of a shape are `"left"`, `"right"`, `"bottom"`, `"top"`, `"front"`, `"back"`, what is in several
//! of them, as `"top-left"`, the `"rim"` of a sheet, and `"all"`. A solid is pinned at such parts, or
//! `hung` from them: held until everything is at rest, and let go at the start. It is
//! `struck = { at, radius, velocity }`; `marks = { NAME = PLACE }` name its nearest vertices.
//! Quadratic elements have vertices in the middle of their edges too, and are curved where the shape
//! is round or its MSH file says so; a sheet of them has no `bending`. Materials are `"saint-venant-kirchhoff"`, which is the usual one, and of what fills its space also
//! `"neo-hookean"`, `"fixed-corotated"` and `"linear"`.
//!
//! In `[contact]` the `restitution` is separating over approaching speed, `law` one of
//! [`stationary_contact::ImpactLaw`] and, for particles, `when` one of [`stationary_contact::When`];
//! `walls = [{ normal, at }]` and `balls = [{ at, radius }]` are what nothing enters. Particles that
//! touch take `"stormer-verlet"`; with a `stiffness` they are pushed apart by springs instead of
//! impulses, and take any explicit method.
//!
//! Particles beside bodies are point masses that do not turn. Bodies whose `velocity` is missing move as
//! their joints have them move. Joints are held by RATTLE, for which the integrator is `"stormer-verlet"` in
//! the plane, and in space a method that turns bodies symplectically; with contact they are solved together
//! with it, in steps of order 1 of `"stormer-verlet"` or `"variational-rotation"`, as are limits and
//! friction of joints and rods that break beside bodies.
//!
//! A file that says something else gets an answer like this one:
//!
//! ```
//! # use stationary_scene::Scene;
//! let error = Scene::parse("a.toml", "dimension = 2\nintegrator = \"velvet\"\nstep = 1\nhorizon = 1\n");
//! let expected = "\
//! error: unknown integrator `velvet`
//!  --> a.toml:2:14
//!   |
//! 2 | integrator = \"velvet\"
//!   |              ^^^^^^^^";
//! assert!(error.unwrap_err().to_string().starts_with(expected));
//! ```
//!
//! # Only what a scene names
//!
//! Each crate above the integrators is a cargo feature, all of them on by default. Without any, there
//! are particles, gravity and drag.
//!
//! | feature | is needed for | turns on |
//! | --- | --- | --- |
//! | `constraints` | rods, chains; with `rigid`, joints | |
//! | `rigid` | bodies | |
//! | `contact` | contact | `constraints`, `rigid` |
//! | `elasticity` | springs, nets, solids | |
//! | `modal` | the integrator `"linear-modes"`; with `elasticity`, solids that are hung | |
//! | `laplacian` | heat | `modal` |
//! | `choose` | [`choose`], the cheapest way to run a scene for a question | all of them |
//!
//! A file is read alike under any of them: a word whose feature is not on is answered by
//! [`Fault::NotCompiled`] at its place. Without a crate its methods are no variants of [`Stepping`],
//! and its errors none of the errors'. [`Run::built`] says what a scene had built
//! of what is compiled: what it does not name is zero.
//!
//! # A test of a scene is one line
//!
//! The summary has only the digits that another processor reproduces:
//!
//! ```text
//! insta::assert_snapshot!(Scene::read("pendulum.toml")?.run()?.summary());
//! ```
//!
//! # Reading order
//!
//! [`Scene`] is what a file has said, checked. [`Scene::run`] makes a [`Run`] of it (and
//! [`Scene::run_from`] goes on from a [`Checkpoint`]), whose
//! [`Summary`] is one line of a test and whose [`Run::write`] leaves tables, pictures and a page that
//! plays the motion.
//! [`Scene::problem`] is for studies: the system itself, for any method and step, also of the scenes
//! in [`problems`]. [`Diagnostic`] is the answer to a wrong file; a file is not trusted, and
//! [`limits`] says how large it may be.
//!
//! The crate assembles and asks; it contains no mathematics of motion.

// Without one of the features, what is there for its scenes alone is not used.
#![cfg_attr(not(feature = "default"), allow(dead_code))]

mod text {
    pub mod limits;
    pub(crate) mod number;
    pub(crate) mod turn;
    pub(crate) mod expression;
    pub(crate) mod parameters;
    pub(crate) mod suggestion;
    pub(crate) mod fault;
    pub(crate) mod diagnostic;
    pub(crate) mod file_error;
    pub(crate) mod beside;
    pub(crate) mod csv_table;
    pub(crate) mod check;
    pub(crate) mod parser_words;
    pub(crate) mod source;
}

mod model {
    pub(crate) mod particle;
    pub(crate) mod contact_side;
    pub(crate) mod items;
    pub(crate) mod strength;
    pub(crate) mod turned;
    pub(crate) mod drives;
    pub(crate) mod body_shape;
    pub(crate) mod simplices;
    pub(crate) mod elastic_body;
    pub(crate) mod units;
    pub(crate) mod observable;
    pub(crate) mod claim;
    pub(crate) mod timing;
    pub(crate) mod stepping;
    pub(crate) mod scene;
    pub(crate) mod columns;
    pub(crate) mod changed;
    pub(crate) mod built;
    pub(crate) mod serialized;
}

mod words;

mod assemble {
    pub(crate) mod error;
    pub(crate) mod scene;
    pub(crate) mod vertices;
    #[cfg(feature = "elasticity")]
    pub(crate) mod springs;
    #[cfg(feature = "contact")]
    pub(crate) mod contacts;
    #[cfg(feature = "elasticity")]
    pub(crate) mod elastic;
    #[cfg(feature = "constraints")]
    pub(crate) mod rods;
    pub(crate) mod acceleration;
    pub(crate) mod anchor;
    pub(crate) mod acting;
    #[cfg(all(feature = "elasticity", feature = "rigid"))]
    pub(crate) mod point_springs;
    #[cfg(feature = "modal")]
    pub(crate) mod rest;
    pub(crate) mod system;
    pub(crate) mod stable_step;
    #[cfg(feature = "modal")]
    pub(crate) mod linear_modes;
    pub(crate) mod particle_system;
    #[cfg(feature = "rigid")]
    pub(crate) mod turn_springs;
    #[cfg(feature = "rigid")]
    pub(crate) mod body_system;
    #[cfg(feature = "rigid")]
    pub(crate) mod led;
    #[cfg(feature = "rigid")]
    pub(crate) mod attraction;
    #[cfg(feature = "rigid")]
    pub(crate) mod spanning_tree;
    #[cfg(feature = "rigid")]
    pub(crate) mod joint_tree;
    #[cfg(feature = "contact")]
    pub(crate) mod colliders;
    #[cfg(feature = "contact")]
    pub(crate) mod placing;
    #[cfg(feature = "contact")]
    pub(crate) mod obstacles;
}

mod run {
    pub(crate) mod scene_run;
    pub(crate) mod samples;
    pub(crate) mod claims;
    pub(crate) mod contact_impulses;
    pub(crate) mod checkpoint;
    pub(crate) mod error;
    pub(crate) mod in_words;
    pub(crate) mod observer;
    pub(crate) mod stepper;
    pub(crate) mod recorder;
    pub(crate) mod engine;
    pub(crate) mod own_samples;
    pub(crate) mod revisit;
    pub(crate) mod start;
    pub(crate) mod equal;
    pub(crate) mod driven;
    pub(crate) mod adaptive;
    #[cfg(feature = "constraints")]
    pub(crate) mod lasting;
    #[cfg(feature = "constraints")]
    pub(crate) mod rods;
    #[cfg(feature = "contact")]
    pub(crate) mod impacts;
    #[cfg(feature = "modal")]
    pub(crate) mod linear_modes;
    pub(crate) mod particles;
    #[cfg(all(feature = "rigid", feature = "constraints"))]
    pub(crate) mod joints;
    #[cfg(feature = "contact")]
    pub(crate) mod joint_set;
    #[cfg(feature = "contact")]
    pub(crate) mod event_driven;
    #[cfg(feature = "contact")]
    pub(crate) mod error_controlled;
    #[cfg(feature = "contact")]
    pub(crate) mod given;
    #[cfg(feature = "contact")]
    pub(crate) mod touching;
    #[cfg(feature = "rigid")]
    pub(crate) mod joint_coordinates;
    #[cfg(feature = "rigid")]
    pub(crate) mod bodies;
    #[cfg(feature = "laplacian")]
    pub(crate) mod heat;
    pub(crate) mod fields;
}

mod show {
    pub(crate) mod summary;
    pub(crate) mod folder;
    pub(crate) mod write;
    pub(crate) mod csv;
    pub(crate) mod field_tables;
    pub(crate) mod drawing;
    pub(crate) mod body_surface;
    pub(crate) mod projection;
    pub(crate) mod silhouette;
    pub(crate) mod sheet;
    pub(crate) mod painter;
    pub(crate) mod walls;
    pub(crate) mod picture;
    pub(crate) mod film;
    pub(crate) mod vtk;
    pub(crate) mod player;
}

#[cfg(feature = "choose")]
pub mod choose;
pub mod problems;
pub mod shipped;

pub use assemble::error::AssemblyError;
#[cfg(feature = "constraints")]
pub use assemble::rods::Pins;
pub use assemble::stable_step::UnstableStep;
pub use assemble::system::{ScenePotential, SceneProblem};
pub use model::body_shape::{BodyPart, BodyShape};
pub use model::built::Built;
pub use model::claim::{Claim, Event, Measured, Scale};
pub use model::contact_side::ContactSide;
pub use model::drives::{Drives, HeatSource, Motor, MotorDrive, PinMotion, SceneLoad};
pub use model::elastic_body::{ElasticBody, ElasticMaterial, HeatedBody};
pub use model::items::{
    JointKind, Link, RigidBody, Rod, SceneBall, SceneContact, SceneJoint, ScenePair, SceneWall,
};
pub use model::observable::Observable;
pub use model::particle::{Motion, Particle};
pub use model::scene::{Gravity, Scene};
pub use model::simplices::{Middles, Simplices};
#[cfg(feature = "rigid")]
pub use model::stepping::FlightSteps;
pub use model::stepping::{Adaptive, Constrained, Stepping};
pub use model::strength::{Pieces, Strength};
pub use model::timing::Timing;
pub use model::units::Units;
pub use run::checkpoint::{Checkpoint, CheckpointError};
pub use run::claims::{Answer, Verdict};
pub use run::contact_impulses::ContactImpulse;
pub use run::error::{Interruption, RunError, StepFailure, Stop};
pub use run::fields::BodyField;
pub use run::observer::{Control, Observer, Progress};
pub use run::samples::{BrokenRod, ChosenSteps, Impacts, LastingContact, Run, Unsettled};
pub use show::folder::make_folder;
pub use show::summary::Summary;
pub use text::diagnostic::{Diagnostic, Place};
pub use text::fault::{BodyFault, ClaimFault, DriveFault, Fault};
pub use text::file_error::{SceneError, WriteError};
pub use text::limits;
pub use text::parameters::Parameters;
pub use words::vocabulary;
