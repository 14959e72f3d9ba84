//! How large a scene may be: a file comes from a stranger, and memory and patience are finite.

/// Bytes of a scene file. A parsed file takes up to some eighty times its size in memory; this many
/// bytes hold about forty thousand particles that are each written out.
pub const FILE_BYTES: u64 = 4 << 20;

/// Particles, the vertices of nets included.
pub const PARTICLES: u64 = 1_000_000;

/// Points of a hull: each is looked at from every face.
pub const HULL_POINTS: u64 = 500;

/// Parts of a body.
pub const PARTS: u64 = 500;

/// Bytes of a mesh file.
pub const MESH_BYTES: u64 = 64 << 20;

/// Freedoms of a scene that an implicit adaptive method steps: it factors full matrices.
pub const FULL_MATRIX_FREEDOMS: usize = 1_000;

/// Modes of a scene that is moved by them.
pub const MODES: u64 = 1_000;

/// The smallest tolerance; below it rounding decides.
pub const TOLERANCE: f64 = 1e-14;

/// Steps to the horizon.
pub const STEPS: u64 = 10_000_000_000;

/// Steps with impacts of which a run keeps the time; of later ones it keeps none.
pub const IMPACTS: usize = 1 << 20;

/// Rows of contact impulses that a run keeps: one for every two things that touch between two samples.
pub const CONTACT_ROWS: usize = 1 << 20;

/// Pairs of things that may touch: each is looked at in every step.
pub const PAIRS: u64 = 4_000_000;

/// Numbers of all modes of a scene that is moved by them, 8 bytes each.
pub const MODE_NUMBERS: u64 = 1 << 26;

/// Numbers that a run keeps in memory, 8 bytes each: positions, velocities and observables of every
/// sample.
pub const SAMPLED_NUMBERS: u64 = 1 << 26;

/// Bytes of a checkpoint: every number that is kept, twice the state, and some more.
pub const CHECKPOINT_BYTES: u64 = 1 << 30;

/// Characters of a name.
pub const NAME: usize = 64;

/// Characters of a title or of a unit's name.
pub const TITLE: usize = 200;
