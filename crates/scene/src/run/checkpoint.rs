//! A checkpoint: all that a run needs to go on to the same bits.
//!
//! ```text
//! stationary checkpoint VERSION \n      then numbers of 8 bytes, the least significant first:
//! the scene's fingerprint, the step k, state k-1, what the method remembers there, rods broken by
//! then, state k, counts, samples up to k; and last the checksum of every byte before
//! ```
//! Lists are preceded by their lengths. Fingerprint and checksum are FNV-1a with 64 bits: a changed
//! byte always changes them, but they keep out no forger. The fingerprint is that of the checked scene
//! with its method and step, not of the file's text, so that comments may change. A file is written
//! under another name and renamed once it is whole.

mod bytes;

#[cfg(feature = "constraints")]
use stationary_constraints::ConstraintError;
use std::ffi::OsStr;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::{fs, io};

use bytes::{Fnv, Reader, Writer};
use stationary_integrators::{AdaptiveError, Cost, Saved, State, StepError};

use crate::assemble::error::AssemblyError;
use crate::model::contact_side::ContactSide;
use crate::model::scene::{Scene, numbers_of_a_body};
use crate::run::contact_impulses::{ContactImpulse, ContactRows};
use crate::run::samples::{BrokenRod, ChosenSteps, Impacts, LastingContact, Samples, Unsettled};
use crate::text::file_error::WriteError;
use crate::text::limits;

/// A moment of a run from which it can go on.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    pub(crate) scene: u64,
    /// The step after which it was made.
    pub(crate) step: u64,
    pub(crate) before: Before,
    pub(crate) after: State<Vec<f64>>,
    pub(crate) cost: Cost,
    pub(crate) samples: Samples,
}

/// The start of a checkpoint's step.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Before {
    pub(crate) state: State<Vec<f64>>,
    pub(crate) memory: Saved,
    pub(crate) broken: Vec<BrokenRod>,
}

/// A checkpoint from which a run does not go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The file is missing, or may not be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// More bytes than any checkpoint has.
    #[error("the checkpoint has {bytes} bytes; there are at most {}", limits::CHECKPOINT_BYTES)]
    TooLarge {
        /// How many it has.
        bytes: u64,
    },
    /// Another kind of file.
    #[error("this is no checkpoint")]
    NoCheckpoint,
    /// A checkpoint of another version of the crate, whose numbers may mean something else.
    #[error("the checkpoint is of version {found}, not {}", env!("CARGO_PKG_VERSION"))]
    Version {
        /// That version.
        found: String,
    },
    /// Bytes that were lost or changed.
    #[error("the checkpoint is damaged: {0}")]
    Damaged(&'static str),
    /// A checkpoint of another scene.
    #[error("the checkpoint is of another scene, or of this scene with another method or step")]
    Foreign,
    /// A method that does not take what was saved.
    #[error("the checkpoint does not fit the method: {0}")]
    Method(#[from] StepError),
    /// An adaptive method that does not take what was saved.
    #[error("the checkpoint does not fit the method: {0}")]
    Adaptive(#[from] AdaptiveError),
    /// Rods that do not take what was saved.
    #[cfg(feature = "constraints")]
    #[error("the checkpoint does not fit the rods: {0}")]
    Rods(#[from] ConstraintError),
    /// A scene whose rods cannot be had.
    #[error(transparent)]
    Assembly(#[from] AssemblyError),
    /// A machine, or a build, on which the run would have gone elsewhere.
    #[error("step {step}: the result differs bitwise from the checkpoint's; run the scene anew")]
    OtherBits {
        /// The step.
        step: u64,
    },
}

const MAGIC: &str = "stationary checkpoint ";

impl Checkpoint {
    /// The number of steps that are done.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// A number that tells scenes apart: the hash of the scene as JSON, whatever the order and the
    /// comments of its file.
    pub(crate) fn fingerprint(scene: &Scene) -> u64 {
        let mut hash = Fnv::default();
        // Everything that was checked is in there, every number with all its digits.
        let written = serde_json::to_writer(&mut hash, scene);
        debug_assert!(written.is_ok(), "hashing does not fail");
        hash.value()
    }

    /// Writes the checkpoint to a file, all of it or nothing: whatever happens, the file is the new
    /// checkpoint or what it was before.
    ///
    /// # Errors
    /// [`WriteError`] where the file cannot be written whole or cannot take the checkpoint's name.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), WriteError> {
        let path = path.as_ref();
        // Beside the file, under a longer name that is its own.
        let mut fresh = path.as_os_str().to_owned();
        fresh.push(".new");
        let written = self.write_whole(&fresh).and_then(|()| fs::rename(&fresh, path));
        written.map_err(|source| {
            // What is left of it is of no use; that it cannot be removed is the lesser fault.
            let _ = fs::remove_file(&fresh);
            WriteError { path: path.to_owned(), source }
        })
    }

    fn write_whole(&self, path: &OsStr) -> io::Result<()> {
        let mut out = Writer::new(BufWriter::new(File::create(path)?));
        self.put(&mut out)?;
        out.finish()?.into_inner()?.sync_all()
    }

    /// Reads a checkpoint back.
    ///
    /// # Errors
    /// [`CheckpointError::Read`] and [`CheckpointError::TooLarge`] for the file; those of
    /// [`Checkpoint::parse`] for its bytes.
    pub fn read(path: impl AsRef<Path>) -> Result<Checkpoint, CheckpointError> {
        let path = path.as_ref();
        let failed = |source| CheckpointError::Read { path: path.to_owned(), source };
        let bytes = fs::metadata(path).map_err(failed)?.len();
        if bytes > limits::CHECKPOINT_BYTES {
            return Err(CheckpointError::TooLarge { bytes });
        }
        Checkpoint::parse(&fs::read(path).map_err(failed)?)
    }

    /// The checkpoint that these bytes are.
    ///
    /// # Errors
    /// [`CheckpointError::NoCheckpoint`] for other bytes, [`CheckpointError::Version`] for those of
    /// another version, [`CheckpointError::Damaged`] where they were cut or changed.
    pub fn parse(bytes: &[u8]) -> Result<Checkpoint, CheckpointError> {
        let rest = bytes.strip_prefix(MAGIC.as_bytes()).ok_or(CheckpointError::NoCheckpoint)?;
        let end = rest.iter().take(64).position(|&byte| byte == b'\n');
        let end = end.ok_or(CheckpointError::Damaged("its first line has no end"))?;
        let found = String::from_utf8_lossy(&rest[..end]).into_owned();
        if found != env!("CARGO_PKG_VERSION") {
            return Err(CheckpointError::Version { found });
        }
        let Some((content, sum)) = bytes.split_last_chunk::<8>() else {
            return Err(CheckpointError::Damaged("it was cut"));
        };
        let mut hash = Fnv::default();
        hash.add(content);
        let start = MAGIC.len() + end + 1;
        if hash.value() != u64::from_le_bytes(*sum) || content.len() < start {
            return Err(CheckpointError::Damaged("its checksum is another"));
        }
        let mut from = Reader(&content[start..]);
        let read = Checkpoint::take(&mut from).filter(|_| from.0.is_empty());
        read.ok_or(CheckpointError::Damaged("its lists have other lengths"))
    }

    /// An error unless it is one of this scene, whose states are like this one.
    pub(crate) fn check(
        &self,
        scene: &Scene,
        state: &State<Vec<f64>>,
    ) -> Result<(), CheckpointError> {
        if self.scene != Checkpoint::fingerprint(scene) {
            return Err(CheckpointError::Foreign);
        }
        let size = |state: &State<Vec<f64>>| [state.q.len(), state.p.0.len()];
        let sizes = [&self.before.state, &self.after].map(size);
        let steps = (1..=scene.timing.steps()).contains(&self.step);
        let rods = self.before.broken.iter().all(|broken| broken.rod < scene.rods.len());
        if sizes != [size(state); 2] || !steps || !rods || !self.samples.fit(scene) {
            return Err(CheckpointError::Damaged("its lists have other lengths"));
        }
        Ok(())
    }

    fn put(&self, out: &mut Writer<impl Write>) -> io::Result<()> {
        let Checkpoint { scene, step, before, after, cost, samples } = self;
        out.put(format!("{MAGIC}{}\n", env!("CARGO_PKG_VERSION")).as_bytes())?;
        out.count(*scene)?;
        out.count(*step)?;
        out.state(&before.state)?;
        out.bytes(before.memory.method.as_bytes())?;
        out.numbers(&before.memory.numbers)?;
        out.count(before.broken.len() as u64)?;
        for &BrokenRod { rod, time, tension } in &before.broken {
            out.count(rod as u64)?;
            out.number(time)?;
            out.number(tension)?;
        }
        out.state(after)?;
        let Cost { steps, differentials, hessians, energies, most_iterations } = *cost;
        for count in [steps, differentials, hessians, energies, most_iterations.into()] {
            out.count(count)?;
        }
        samples.put(out)
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        let (scene, step, state) = (from.count()?, from.count()?, from.state()?);
        let method = String::from_utf8(from.bytes()?.to_vec()).ok()?;
        let memory = Saved { method, numbers: from.numbers()? };
        let broken = (0..from.length(24)?).map(|_| {
            let rod = usize::try_from(from.count()?).ok()?;
            Some(BrokenRod { rod, time: from.number()?, tension: from.number()? })
        });
        let broken = broken.collect::<Option<Vec<_>>>()?;
        let after = from.state()?;
        let cost = Cost {
            steps: from.count()?,
            differentials: from.count()?,
            hessians: from.count()?,
            energies: from.count()?,
            most_iterations: u32::try_from(from.count()?).ok()?,
        };
        let before = Before { state, memory, broken };
        Some(Checkpoint { scene, step, before, after, cost, samples: Samples::take(from)? })
    }
}

impl ContactImpulse {
    /// The least that a row takes.
    const BYTES: usize = 8 * 16;

    fn put(&self, out: &mut Writer<impl Write>) -> io::Result<()> {
        out.count(self.sample as u64)?;
        for side in self.between {
            let (kind, place) = side.numbers();
            out.count(kind)?;
            out.count(place as u64)?;
        }
        out.number(self.last)?;
        out.number(self.magnitude)?;
        for vector in [self.point, self.normal, self.impulse] {
            vector.iter().try_for_each(|&x| out.number(x))?;
        }
        Ok(())
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        let sample = usize::try_from(from.count()?).ok()?;
        let mut side =
            || ContactSide::of_numbers(from.count()?, usize::try_from(from.count()?).ok()?);
        let between = [side()?, side()?];
        let (last, magnitude) = (from.number()?, from.number()?);
        let mut vector = || Some([from.number()?, from.number()?, from.number()?]);
        let (point, normal, impulse) = (vector()?, vector()?, vector()?);
        Some(ContactImpulse { sample, between, last, point, normal, impulse, magnitude })
    }
}

impl Samples {
    fn put(&self, out: &mut Writer<impl Write>) -> io::Result<()> {
        let Samples { times, positions, velocities, bodies, .. } = self;
        let Samples { kinetic, potential, linear, angular, .. } = self;
        let Samples { temperatures, heat, impacts, unsettled, lasting, chosen, .. } = self;
        let Samples { works, contacts, observed, columns, linear_scale, angular_scale, .. } = self;
        for numbers in [times, positions, velocities, bodies] {
            out.numbers(numbers)?;
        }
        for numbers in [kinetic, potential, temperatures, heat, observed] {
            out.numbers(numbers)?;
        }
        out.count(impacts.len() as u64)?;
        for &Impacts { time, count } in impacts {
            out.number(time)?;
            out.count(count as u64)?;
        }
        out.count(unsettled.steps)?;
        out.number(unsettled.residual)?;
        out.count(lasting.steps)?;
        out.number(lasting.time)?;
        out.count(chosen.accepted)?;
        out.count(chosen.rejected)?;
        out.numbers(works)?;
        out.count(contacts.rows.len() as u64)?;
        contacts.rows.iter().try_for_each(|row| row.put(out))?;
        out.count(contacts.end.map_or(u64::MAX, |end| end as u64))?;
        for vectors in [linear, angular] {
            out.numbers(vectors.as_flattened())?;
        }
        out.count(*columns as u64)?;
        out.number(*linear_scale)?;
        out.number(*angular_scale)
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        let (times, positions) = (from.numbers()?, from.numbers()?);
        let (velocities, bodies) = (from.numbers()?, from.numbers()?);
        let (kinetic, potential, temperatures) =
            (from.numbers()?, from.numbers()?, from.numbers()?);
        let (heat, observed) = (from.numbers()?, from.numbers()?);
        let impacts = (0..from.length(16)?).map(|_| {
            Some(Impacts { time: from.number()?, count: usize::try_from(from.count()?).ok()? })
        });
        let impacts = impacts.collect::<Option<Vec<_>>>()?;
        let unsettled = Unsettled { steps: from.count()?, residual: from.number()? };
        let lasting = LastingContact { steps: from.count()?, time: from.number()? };
        let chosen = ChosenSteps { accepted: from.count()?, rejected: from.count()? };
        let works = from.numbers()?;
        let contacts = (0..from.length(ContactImpulse::BYTES)?).map(|_| ContactImpulse::take(from));
        let rows = contacts.collect::<Option<Vec<_>>>()?;
        let end = match from.count()? {
            u64::MAX => None,
            end => Some(usize::try_from(end).ok()?),
        };
        let mut vectors = || Some(from.numbers()?.as_chunks::<3>().0.to_vec());
        let (linear, angular) = (vectors()?, vectors()?);
        Some(Samples {
            times,
            positions,
            velocities,
            bodies,
            kinetic,
            potential,
            linear,
            angular,
            temperatures,
            heat,
            impacts,
            unsettled,
            lasting,
            chosen,
            works,
            contacts: ContactRows { rows, end },
            observed,
            columns: usize::try_from(from.count()?).ok()?,
            linear_scale: from.number()?,
            angular_scale: from.number()?,
        })
    }

    /// Whether the lists are as long as the scene's samples have them.
    fn fit(&self, scene: &Scene) -> bool {
        let n = self.times.len();
        let coordinates = scene.dimension * scene.particles.len();
        let each = [self.kinetic.len(), self.potential.len(), self.heat.len()];
        let vectors = [self.linear.len(), self.angular.len()];
        let temperatures = if scene.heat.is_some() { scene.particles.len() } else { 0 };
        let velocities = if scene.keeps_velocities() { coordinates } else { 0 };
        let bodies = numbers_of_a_body(scene.dimension) * scene.bodies.len();
        // The rows since the last sample are those of the next.
        let contacts = self.contacts.rows.iter().all(|row| row.sample <= n && row.fits(scene))
            && self.contacts.rows.is_sorted_by_key(|row| (row.sample, row.between));
        (1..=scene.timing.samples()).contains(&(n as u64))
            && each == [n; 3]
            && vectors == [n; 2]
            && self.temperatures.len() == n * temperatures
            && self.positions.len() == n * coordinates
            && self.velocities.len() == n * velocities
            && self.bodies.len() == n * bodies
            && contacts
            && self.columns == scene.no_samples().columns
            && self.works.len() == scene.no_samples().works.len()
            && self.observed.len() == n * self.columns
    }
}
