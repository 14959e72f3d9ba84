//! From declarations to a scene: every value checked, every name resolved, nothing left to doubt.

use std::collections::HashMap;
use std::path::Path;

#[cfg(not(feature = "laplacian"))]
use crate::model::elastic_body::Heated;
use crate::model::items::RigidBody;
use crate::model::particle::Motion;
use crate::model::scene::{Gravity, Scene};
use crate::model::timing::Timing;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::text::file_error::SceneError;
use crate::text::number::Count;
use crate::text::source::diagnose;
use crate::text::{check, limits, source};
use crate::words::declaration::Declaration;
use crate::words::laid_shape::Solids;
use crate::words::particles::Roster;
use crate::words::{features, integrator, observables, particles, rods, units};

impl Scene {
    /// The scene that a text describes. `name` stands in errors where a file's name would, and for
    /// a title where the text gives none. Such a scene has no folder to find meshes in.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] with the [`Fault`] and its place; [`SceneError::TooLarge`] beyond
    /// [`limits::FILE_BYTES`].
    pub fn parse(name: &str, text: &str) -> Result<Scene, SceneError> {
        Scene::parse_in(None, name, text)
    }

    /// The scene that a text describes, as if it stood in the file of this path: meshes are those
    /// beside it.
    ///
    /// # Errors
    /// Those of [`Scene::parse`].
    pub fn parse_at(path: impl AsRef<Path>, text: &str) -> Result<Scene, SceneError> {
        let path = path.as_ref();
        Scene::parse_in(path.parent(), &path.display().to_string(), text)
    }

    fn parse_in(folder: Option<&Path>, name: &str, text: &str) -> Result<Scene, SceneError> {
        let bytes = text.len() as u64;
        if bytes > limits::FILE_BYTES {
            return Err(SceneError::TooLarge { name: name.to_owned(), bytes });
        }
        let scene = source::parse(text).and_then(|declared| assemble(name, folder, &declared));
        scene.map_err(|located| diagnose(name, text, *located))
    }

    /// The scene that a file describes.
    ///
    /// # Errors
    /// [`SceneError::Read`], [`SceneError::NotAFile`] and [`SceneError::NotUtf8`] for the file;
    /// those of [`Scene::parse`] for its text.
    pub fn read(path: impl AsRef<Path>) -> Result<Scene, SceneError> {
        let path = path.as_ref();
        Scene::parse_at(path, &source::read(path)?)
    }

    /// The scene that a text describes, once `change` has been made to its declarations.
    pub(crate) fn parse_changed(
        name: &str,
        text: &str,
        change: impl FnOnce(&mut Declaration),
    ) -> Result<Scene, SceneError> {
        let changed = |mut declared: Declaration| -> Checked<Scene> {
            change(&mut declared);
            assemble(name, None, &declared)
        };
        source::parse(text).and_then(changed).map_err(|located| diagnose(name, text, *located))
    }
}

/// The scene that is declared. `name` stands for a title where there is none, `folder` is that of the
/// scene's file.
pub(crate) fn assemble(
    name: &str,
    folder: Option<&Path>,
    declared: &Declaration,
) -> Checked<Scene> {
    let dimension = match *declared.dimension.get_ref() {
        Count(dimension @ 1..=3) => dimension as usize,
        Count(other) => return Err(at(declared.dimension.span(), Fault::Dimension(other))),
    };
    #[cfg(not(any(feature = "elasticity", feature = "laplacian")))]
    let _ = folder;
    check_what_is_there(declared)?;
    features::check(declared)?;
    let stepping = integrator::declare(declared, dimension)?;
    let mut roster = Roster::default();
    #[cfg(feature = "rigid")]
    let (bodies, joints, edges) = {
        let (mut bodies, edges) =
            crate::words::bodies::declare(&mut roster, dimension, &declared.bodies)?;
        let joints = crate::words::joints::declare(dimension, &mut bodies, &declared.joints)?;
        let bodies: Vec<RigidBody> = bodies.into_iter().map(|declared| declared.body).collect();
        (bodies, joints, edges)
    };
    #[cfg(not(feature = "rigid"))]
    let (bodies, joints, edges) = (Vec::<RigidBody>::new(), Vec::new(), Vec::new());
    for particle in &declared.particles {
        particles::declare(&mut roster, dimension, particle)?;
    }
    #[cfg(feature = "laplacian")]
    let heated = match &declared.heat {
        Some(heat) => Some(crate::words::heat::declare(&mut roster, dimension, folder, heat)?),
        None => None,
    };
    #[cfg(not(feature = "laplacian"))]
    let heated: Option<Heated> = None;
    let written_out = if heated.is_some() {
        0
    } else if bodies.is_empty() {
        roster.particles.len()
    } else {
        bodies.len()
    };
    #[cfg_attr(not(feature = "elasticity"), expect(unused_mut))]
    let mut links = Vec::new();
    #[cfg(feature = "elasticity")]
    for net in &declared.nets {
        crate::words::nets::declare(&mut roster, &mut links, dimension, net)?;
    }
    let mut elastic = Solids { edges, ..Solids::default() };
    #[cfg(feature = "elasticity")]
    for solid in &declared.solids {
        crate::words::solids::declare(&mut roster, &mut elastic, dimension, folder, solid)?;
    }
    #[cfg(feature = "elasticity")]
    for spring in &declared.springs {
        links.push(crate::words::springs::declare(&roster, spring)?);
    }
    let mut rods = Vec::new();
    for rod in &declared.rods {
        rods.push(rods::declare(&roster, &rods, rod)?);
    }
    let heat = heated.map(|(body, edges, faces)| {
        (elastic.edges, elastic.faces) = (edges, faces);
        body
    });
    #[cfg(feature = "contact")]
    let contact = crate::words::contact::declare(declared, dimension)?;
    #[cfg(not(feature = "contact"))]
    let contact = None;
    let gravity = gravity(declared, dimension, &roster)?;
    let drag = declared.drag.as_ref();
    let drag =
        drag.map(|drag| check::positive("the coefficient", &drag.coefficient)).transpose()?;
    check_that_something_moves(declared, &roster)?;

    let observables = observables::declare_all(declared, &roster, &rods)?;
    let scene = Scene {
        title: check::title("a title", declared.title.as_ref(), name)?,
        dimension,
        units: units::declare(&declared.units)?,
        stepping,
        timing: timing(declared)?,
        gravity,
        drag,
        contact,
        particles: roster.particles,
        written_out,
        links,
        rods,
        bodies,
        joints,
        solids: elastic.bodies,
        heat,
        hung: elastic.hung,
        edges: elastic.edges,
        faces: elastic.faces,
        observables,
        view: view(declared, dimension)?,
    };
    scene.check_stepping().map_err(|fault| at(declared.integrator.span(), fault))?;
    #[cfg(feature = "contact")]
    if scene.bodies.is_empty() {
        let place = declared.contact.as_ref().and_then(|contact| contact.place());
        let place = place.unwrap_or(declared.step.span());
        scene.check_apart().map_err(|fault| at(place, fault))?;
    }
    let place = declared.sample_every.as_ref().map_or(declared.step.span(), |every| every.span());
    scene.check_samples().map_err(|fault| at(place, fault))?;
    Ok(scene)
}

/// An error where what does not go together is there.
fn check_what_is_there(declared: &Declaration) -> Checked<()> {
    let particles = [
        declared.particles.first().map(|particle| particle.name.span()),
        declared.nets.first().map(|net| net.name.span()),
        declared.solids.first().map(|solid| solid.name.span()),
        declared.springs.first().map(|spring| spring.between.span()),
        declared.rods.first().map(|rod| rod.between.span()),
        declared.drag.as_ref().map(|drag| drag.coefficient.span()),
    ];
    let particles = particles.into_iter().flatten().next();
    let attraction = declared.newtonian_gravity.as_ref().map(|gravity| gravity.constant.span());
    let bodies = declared.bodies.first().map(|body| body.name.span());
    let joints = declared.joints.first().map(|joint| joint.kind.span());
    let weight = declared.uniform_gravity.as_ref().map(|gravity| gravity.acceleration.span());
    if declared.heat.is_some() {
        let others = [particles, attraction, bodies, joints, weight].into_iter().flatten().next();
        return others.map_or(Ok(()), |place| Err(at(place, Fault::MixedWithHeat)));
    }
    match (bodies, joints, particles, attraction) {
        (None, Some(joint), ..) => Err(at(joint, Fault::NoBodies)),
        (Some(_), _, Some(particle), _) => Err(at(particle, Fault::Mixed)),
        (Some(_), _, None, Some(attraction)) => Err(at(attraction, Fault::BodyAttraction)),
        _ => Ok(()),
    }
}

fn timing(declared: &Declaration) -> Checked<Timing> {
    let step = check::positive("the step", &declared.step)?;
    let horizon = check::positive("the horizon", &declared.horizon)?;
    let sample_every = match &declared.sample_every {
        Some(every) if every.get_ref().0 == 0 => {
            let fault = Fault::NotPositive { what: "`sample_every`", value: 0.0 };
            return Err(at(every.span(), fault));
        }
        Some(every) => every.get_ref().0,
        None => 1,
    };
    Timing::new(step, horizon, sample_every).map_err(|fault| at(declared.horizon.span(), fault))
}

fn gravity(declared: &Declaration, dimension: usize, roster: &Roster) -> Checked<Gravity> {
    let mut gravity = Gravity { acceleration: None, constant: None };
    if let Some(uniform) = &declared.uniform_gravity {
        let g = check::vector("the acceleration", dimension, &uniform.acceleration)?;
        gravity.acceleration = Some(g);
    }
    if let Some(newtonian) = &declared.newtonian_gravity {
        gravity.constant = Some(check::positive("the constant", &newtonian.constant)?);
        if let Some((pinned, place)) = &roster.first_pin {
            let name = roster.particles[*pinned].name.clone();
            return Err(at(place.clone(), Fault::PinnedAttraction(name)));
        }
        check_that_no_two_meet(roster)?;
    }
    Ok(gravity)
}

fn check_that_no_two_meet(roster: &Roster) -> Checked<()> {
    let mut by_position = HashMap::new();
    for (index, particle) in roster.particles.iter().enumerate() {
        // Adding zero turns the negative zero into the positive one.
        let bits = particle.position.map(|x| (x + 0.0).to_bits());
        if let Some(first) = by_position.insert(bits, index) {
            let first = roster.particles[first].name.clone();
            let fault = Fault::SamePlace { first, second: particle.name.clone() };
            return Err(at(roster.places[index].clone(), fault));
        }
    }
    Ok(())
}

fn check_that_something_moves(declared: &Declaration, roster: &Roster) -> Checked<()> {
    let free = |motion: &Motion| *motion != Motion::Pinned;
    if declared.heat.is_some() || roster.particles.iter().any(|particle| free(&particle.motion)) {
        return Ok(());
    }
    match &roster.first_pin {
        Some((_, place)) => Err(at(place.clone(), Fault::AllPinned)),
        None => Err(at(declared.dimension.span(), Fault::Empty)),
    }
}

/// The direction from which a scene in space is seen.
fn view(declared: &Declaration, dimension: usize) -> Checked<[f64; 3]> {
    /// From the front and the right, and from above.
    const USUAL: [f64; 3] = [0.42, -0.78, 0.46];
    match &declared.view {
        Some(view) if dimension != 3 => Err(at(view.span(), Fault::ViewDimension)),
        Some(view) => check::direction("the view", dimension, view),
        None => Ok(USUAL),
    }
}
