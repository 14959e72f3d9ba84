//! The fields of a run as tables, beside the trajectory: only those that the scene has.
//!
//! ```text
//! velocity.csv        time, particle, v                         of particles that are none of a body
//! bodies.csv          time, body, x, quaternion or angle, v, w  w in body axes
//! displacement.csv    time, vertex, u                           from where the solid is at rest
//! stress.csv          time, solid, element, sigma               Cauchy's, elements counted from 0
//! temperature.csv     time, vertex, temperature
//! contacts.csv        time, last moment, the two, point, normal, impulse on the second
//! ```
//! A row for each sample and thing. `contacts.csv` has a row for each two things that gave each other
//! an impulse since the sample before, whose sum it is.

use std::io;
use std::io::Write;
use std::path::Path;

use crate::model::scene::COORDINATES;
use crate::run::samples::Run;
use crate::show::csv::{quoted, write_file};
use crate::text::file_error::WriteError;

/// Writes the tables into a folder.
pub(crate) fn write(run: &Run, folder: &Path) -> Result<(), WriteError> {
    let scene = &run.scene;
    if scene.heat.is_none() && of_no_body(run).next().is_some() {
        write_file(&folder.join("velocity.csv"), |out| velocities(run, out))?;
    }
    if scene.rigid_bodies() > 0 {
        write_file(&folder.join("bodies.csv"), |out| bodies(run, out))?;
    }
    if !scene.solids.is_empty() {
        write_file(&folder.join("displacement.csv"), |out| displacements(run, out))?;
        let path = folder.join("stress.csv");
        let stress = run.stress_to(&path)?;
        write_file(&path, |out| {
            let (names, numbers) = elements(run);
            let components: &[usize] = match scene.dimension {
                1 => &[0],
                2 => &[0, 1, 3],
                _ => &[0, 1, 2, 3, 4, 5],
            };
            let unit = scene.units.stress();
            let headings = components.iter().map(|&c| format!("stress {} [{unit}]", STRESS[c]));
            head(run, out, &["solid", "element"], headings)?;
            for (sample, time) in run.times().iter().enumerate() {
                let all = stress(run.positions(sample));
                for ((stress, name), number) in all.iter().zip(&names).zip(&numbers) {
                    write!(out, "{time:?},{name},{number}")?;
                    row(out, components.iter().map(|&c| stress[c]))?;
                }
            }
            Ok(())
        })?;
    }
    if scene.heat.is_some() {
        write_file(&folder.join("temperature.csv"), |out| temperatures(run, out))?;
    }
    if scene.has_impulses() {
        write_file(&folder.join("contacts.csv"), |out| contacts(run, out))?;
    }
    Ok(())
}

/// The components of a stress.
pub(crate) const STRESS: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "xz"];

/// The solid of every element, and its number there.
fn elements(run: &Run) -> (Vec<&str>, Vec<usize>) {
    let of = |solid: &crate::ElasticBody| 0..solid.simplices.len();
    let solids = run.scene.solids.iter();
    let all = solids.flat_map(|solid| of(solid).map(move |element| (solid.name.as_str(), element)));
    all.unzip()
}

/// The first line.
fn head(
    run: &Run,
    out: &mut impl Write,
    names: &[&str],
    numbers: impl IntoIterator<Item = String>,
) -> io::Result<()> {
    write!(out, "{}", quoted(&format!("time [{}]", run.scene.units.time)))?;
    names.iter().try_for_each(|name| write!(out, ",{name}"))?;
    numbers.into_iter().try_for_each(|heading| write!(out, ",{}", quoted(&heading)))?;
    writeln!(out)
}

/// The numbers of a line, and its end.
fn row(out: &mut impl Write, numbers: impl IntoIterator<Item = f64>) -> io::Result<()> {
    numbers.into_iter().try_for_each(|number| write!(out, ",{number:?}"))?;
    writeln!(out)
}

/// The headings of a vector's components.
fn vector(run: &Run, what: &str, unit: &str) -> Vec<String> {
    let heading = |axis: &&str| match (what, unit) {
        ("", _) => format!("{axis} [{unit}]"),
        (_, "") => format!("{what} {axis}"),
        _ => format!("{what} {axis} [{unit}]"),
    };
    COORDINATES[..run.scene.dimension].iter().map(heading).collect()
}

/// The particles that are no points of a body that turns.
fn of_no_body(run: &Run) -> impl Iterator<Item = usize> {
    (0..run.scene.particles.len()).filter(|&particle| !run.scene.is_point_of_a_body(particle))
}

fn velocities(run: &Run, out: &mut impl Write) -> io::Result<()> {
    let d = run.scene.dimension;
    head(run, out, &["particle"], vector(run, "velocity", &run.scene.units.velocity()))?;
    for (sample, time) in run.times().iter().enumerate() {
        let velocities = run.velocities(sample);
        for particle in of_no_body(run) {
            write!(out, "{time:?},{}", run.scene.particles[particle].name)?;
            row(out, velocities[particle].into_iter().take(d))?;
        }
    }
    Ok(())
}

fn bodies(run: &Run, out: &mut impl Write) -> io::Result<()> {
    let (scene, d) = (&run.scene, run.scene.dimension);
    let (units, rate) = (&scene.units, format!("rad/{}", scene.units.time));
    let mut headings = vector(run, "", &units.length);
    match d {
        3 => headings.extend(["w", "x", "y", "z"].map(|part| format!("quaternion {part}"))),
        _ => headings.push("angle [rad]".to_owned()),
    }
    headings.extend(vector(run, "velocity", &units.velocity()));
    match d {
        3 => headings.extend(vector(run, "angular velocity in body axes", &rate)),
        _ => headings.push(format!("angular velocity [{rate}]")),
    }
    head(run, out, &["body"], headings)?;
    for (sample, time) in run.times().iter().enumerate() {
        // The centres of bodies are the first particles.
        for (body, field) in run.bodies(sample).iter().enumerate().take(scene.rigid_bodies()) {
            write!(out, "{time:?},{}", scene.bodies[body].name)?;
            let angle = [field.angle];
            let (turned, turning) = match d {
                3 => (&field.orientation[..], &field.angular_velocity[..]),
                _ => (&angle[..], &field.angular_velocity[2..]),
            };
            let place = run.position(sample, body);
            let numbers = place[..d].iter().chain(turned).chain(&field.velocity[..d]);
            row(out, numbers.chain(turning).copied())?;
        }
    }
    Ok(())
}

fn displacements(run: &Run, out: &mut impl Write) -> io::Result<()> {
    let (scene, d) = (&run.scene, run.scene.dimension);
    head(run, out, &["vertex"], vector(run, "displacement", &scene.units.length))?;
    for (sample, time) in run.times().iter().enumerate() {
        let all = run.displacements(sample);
        for vertex in scene.solids.iter().flat_map(|s| s.first..s.first + s.rest.len()) {
            write!(out, "{time:?},{}", scene.particles[vertex].name)?;
            row(out, all[vertex].into_iter().take(d))?;
        }
    }
    Ok(())
}

fn temperatures(run: &Run, out: &mut impl Write) -> io::Result<()> {
    head(run, out, &["vertex"], ["temperature".to_owned()])?;
    for (sample, time) in run.times().iter().enumerate() {
        for (vertex, &temperature) in run.scene.particles.iter().zip(run.temperatures(sample)) {
            write!(out, "{time:?},{}", vertex.name)?;
            row(out, [temperature])?;
        }
    }
    Ok(())
}

fn contacts(run: &Run, out: &mut impl Write) -> io::Result<()> {
    let (scene, d) = (&run.scene, run.scene.dimension);
    let units = &scene.units;
    let mut headings = vector(run, "point", &units.length);
    headings.extend(vector(run, "normal", ""));
    headings.extend(vector(run, "impulse on the second", &units.momentum()));
    let last = format!("last moment [{}]", units.time);
    head(run, out, &[&quoted(&last), "first", "second"], headings)?;
    for contact in run.contact_impulses() {
        // Each interval ends with a sample.
        let Some(time) = run.times().get(contact.sample) else { break };
        let [first, second] = contact.between.map(|side| side.name(scene));
        write!(out, "{time:?},{:?},{first},{second}", contact.last)?;
        let vectors = [contact.point, contact.direction(), contact.impulse];
        row(out, vectors.into_iter().flat_map(|x| x.into_iter().take(d)))?;
    }
    Ok(())
}
