//! From declarations to a scene: every value checked, every name resolved.

use std::collections::BTreeMap;
use std::path::Path;

use crate::model::particle::Motion;
use crate::model::scene::Scene;
use crate::model::timing::Timing;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::{BodyFault, Fault};
use crate::text::file_error::SceneError;
use crate::text::number::Count;
use crate::text::parameters::Parameters;
use crate::text::source::diagnose;
use crate::text::{check, limits, source};
use crate::words::draft::Draft;
use crate::words::particle_table::ParticleTable;
use crate::words::word::Of;
use crate::words::{Declaration, claims, integrator, observables, units};

impl Scene {
    /// The scene that a text describes. `name` stands in errors where a file's name would, and for
    /// a title where the text gives none. Such a scene has no folder to find meshes in.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] with the [`Fault`] and its place; [`SceneError::TooLarge`] beyond
    /// [`limits::FILE_BYTES`].
    pub fn parse(name: &str, text: &str) -> Result<Scene, SceneError> {
        Scene::parse_in(None, name, text, &Parameters::new())
    }

    /// The scene that a text describes, as if it stood in the file of this path: meshes are those
    /// beside it.
    ///
    /// # Errors
    /// Those of [`Scene::parse`].
    pub fn parse_at(path: impl AsRef<Path>, text: &str) -> Result<Scene, SceneError> {
        let path = path.as_ref();
        Scene::parse_in(path.parent(), &path.display().to_string(), text, &Parameters::new())
    }

    /// The scene that a text describes, as if it stood in the file of this path, with other values
    /// for its parameters.
    ///
    /// # Errors
    /// Those of [`Scene::parse`]; [`Fault::UnknownWord`] for a parameter that the text does not have.
    pub fn parse_with(
        path: impl AsRef<Path>,
        text: &str,
        parameters: &Parameters,
    ) -> Result<Scene, SceneError> {
        let path = path.as_ref();
        Scene::parse_in(path.parent(), &path.display().to_string(), text, parameters)
    }

    /// The scene that a file describes, with other values for its parameters.
    ///
    /// # Errors
    /// Those of [`Scene::read`] and of [`Scene::parse_with`].
    pub fn read_with(path: impl AsRef<Path>, parameters: &Parameters) -> Result<Scene, SceneError> {
        let path = path.as_ref();
        Scene::parse_with(path, &source::read(path)?, parameters)
    }

    fn parse_in(
        folder: Option<&Path>,
        name: &str,
        text: &str,
        parameters: &Parameters,
    ) -> Result<Scene, SceneError> {
        let bytes = text.len() as u64;
        if bytes > limits::FILE_BYTES {
            return Err(SceneError::TooLarge { name: name.to_owned(), bytes });
        }
        let scene =
            source::parse(text, parameters).and_then(|declared| assemble(name, folder, &declared));
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
        source::parse(text, &Parameters::new())
            .and_then(changed)
            .map_err(|located| diagnose(name, text, *located))
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
    for value in declared.parameters.iter().flat_map(BTreeMap::values) {
        check::finite("the parameter", value)?;
    }
    check_what_is_there(declared)?;
    declared.check_features()?;
    let stepping = integrator::declare(declared, dimension)?;
    let mut draft = Draft::new(dimension, folder);
    declared.declare(&mut draft)?;
    check_that_something_moves(declared, &draft.particles)?;
    let observables = observables::declare_all(declared.observables.as_deref(), &draft)?;
    let timing = timing(declared)?;
    let claims = claims::declare_all(&declared.claims, &draft, &observables, timing)?;
    #[cfg_attr(not(feature = "contact"), expect(unused_mut))]
    let mut scene = Scene {
        title: check::title("a title", declared.title.as_ref(), name)?,
        dimension,
        units: units::declare(&declared.units)?,
        stepping,
        timing,
        gravity: draft.gravity,
        drag: draft.drag,
        frame: draft.frame,
        drives: draft.drives,
        contact: draft.contact,
        particles: draft.particles.particles,
        written_out: draft.written_out,
        links: draft.links,
        rods: draft.rods,
        bodies: draft.bodies.into_iter().map(|declared| declared.body).collect(),
        joints: draft.joints,
        solids: draft.solids.bodies,
        heat: draft.heat,
        hung: draft.solids.hung,
        edges: draft.solids.edges,
        faces: draft.solids.faces,
        observables,
        view: view(declared, dimension)?,
        claims,
    };
    scene.check_stepping().map_err(|fault| at(declared.integrator.span(), fault))?;
    #[cfg(feature = "contact")]
    if !scene.bodies.is_empty() {
        let pairs = declared.contact.as_ref().and_then(|contact| contact.touching.as_deref());
        let place = |pair: usize| pairs.and_then(|pairs| pairs.get(pair)).map(|pair| pair.span());
        let placed = scene.place_touching();
        placed.map_err(|(pair, fault)| at(place(pair).unwrap_or(declared.step.span()), fault))?;
    } else {
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
    let particles = declared.first(Of::Particles);
    let attraction = declared.first(Of::Attraction);
    let (bodies, joints) = (declared.first(Of::Bodies), declared.first(Of::Joints));
    let (weight, load) = (declared.first(Of::Weight), declared.first(Of::Load));
    if declared.heat.is_some() {
        let elastic = declared.first(Of::Elastic);
        let all = [particles, elastic, attraction, bodies, joints, weight, load];
        let others = all.into_iter().flatten().next();
        return others.map_or(Ok(()), |place| Err(at(place, Fault::MixedWithHeat)));
    }
    let elastic = declared.first(Of::Elastic);
    match (bodies, joints, elastic) {
        (None, Some(joint), _) => Err(at(joint, BodyFault::NoBodies)),
        (Some(_), _, Some(elastic)) => Err(at(elastic, Fault::ElasticBesideRigid)),
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

fn check_that_something_moves(declared: &Declaration, table: &ParticleTable) -> Checked<()> {
    let free = |motion: &Motion| *motion != Motion::Pinned;
    if declared.heat.is_some() || table.particles.iter().any(|particle| free(&particle.motion)) {
        return Ok(());
    }
    match &table.first_pin {
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
