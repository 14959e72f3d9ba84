//! The files of a run.

use std::io::Write;
use std::path::Path;

use crate::run::samples::Run;
use crate::show::csv::write_file;
use crate::show::summary::Summary;
use crate::show::{csv, field_tables, film, picture, player, vtk};
use crate::text::file_error::WriteError;

impl Run {
    /// The files that runs write, each run those that its scene has something for.
    pub const FILES: [&str; 14] = [
        "trajectory.csv",
        "observables.csv",
        "velocity.csv",
        "bodies.csv",
        "displacement.csv",
        "stress.csv",
        "temperature.csv",
        "contacts.csv",
        "events.csv",
        "summary.txt",
        "picture.svg",
        "film.svg",
        "player.html",
        "trajectory.pvd",
    ];

    /// Writes into a folder, which is made where it is missing:
    ///
    /// | file | |
    /// | --- | --- |
    /// | `trajectory.csv`, `observables.csv` | every sample |
    /// | `velocity.csv` | of particles |
    /// | `bodies.csv` | place, orientation and velocities of bodies |
    /// | `displacement.csv`, `stress.csv` | of the vertices and of the elements of solids |
    /// | `temperature.csv` | of the vertices of heat |
    /// | `contacts.csv` | impulses between what touches, from sample to sample |
    /// | `events.csv` | rods that broke, where rods can; impacts, where things touch |
    /// | `summary.txt` | the summary, and what was built |
    /// | `picture.svg`, `film.svg` | paths from the start to the end, and moments side by side |
    /// | `player.html` | a page that plays the motion |
    ///
    /// # Errors
    /// [`WriteError`] at the first folder or file that cannot be written.
    pub fn write(&self, folder: impl AsRef<Path>) -> Result<(), WriteError> {
        let folder = folder.as_ref();
        std::fs::create_dir_all(folder)
            .map_err(|source| WriteError { path: folder.to_owned(), source })?;
        write_file(&folder.join("trajectory.csv"), |out| csv::trajectory(self, out))?;
        write_file(&folder.join("observables.csv"), |out| csv::observables(self, out))?;
        field_tables::write(self, folder)?;
        if self.scene.rods.iter().any(|rod| rod.strength.is_finite()) {
            write_file(&folder.join("events.csv"), |out| csv::broken_rods(self, out))?;
        }
        if self.scene.contact.is_some() {
            write_file(&folder.join("events.csv"), |out| csv::impacts(self, out))?;
        }
        write_file(&folder.join("summary.txt"), |out| {
            let summary = self.summary();
            write!(out, "{summary}\n{}", summary.built)
        })?;
        write_file(&folder.join("picture.svg"), |out| out.write_all(self.picture().as_bytes()))?;
        write_file(&folder.join("film.svg"), |out| out.write_all(self.film().as_bytes()))?;
        write_file(&folder.join("player.html"), |out| player::write(self, out))
    }

    /// Writes `trajectory.pvd` and the files that it names, for ParaView, into a folder, which is
    /// made where it is missing.
    ///
    /// # Errors
    /// [`WriteError`] at the first folder or file that cannot be written.
    pub fn write_vtk(&self, folder: impl AsRef<Path>) -> Result<(), WriteError> {
        vtk::write(self, folder.as_ref())
    }

    /// The picture of the run, as the text of an SVG file.
    pub fn picture(&self) -> String {
        picture::Picture::of(self).svg()
    }

    /// A few moments of the run side by side, as the text of an SVG file.
    pub fn film(&self) -> String {
        film::Film::of(self).svg()
    }

    /// What the run comes to, in numbers that another processor reproduces.
    pub fn summary(&self) -> Summary {
        Summary::of(self)
    }
}
