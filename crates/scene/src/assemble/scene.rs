//! From declarations to a scene: every value checked, every name resolved, nothing left to doubt.

use std::collections::HashMap;
use std::path::Path;

use crate::assemble::{contacts, springs};
use crate::model::observable;
use crate::model::scene::{Gravity, Scene, Timing};
use crate::model::things::{RigidBody, SceneJoint};
use crate::model::units::Units;
use crate::text::check;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::text::number::Count;
use crate::words::declaration::Declaration;
use crate::words::particles;
use crate::words::particles::{Motion, Roster};
use crate::words::solids::Solids;
use crate::words::{bodies, features, heat, integrator, nets, rods, solids};

/// What rigid bodies bring into a scene.
#[derive(Default)]
pub(crate) struct Moved {
    pub(crate) bodies: Vec<RigidBody>,
    pub(crate) joints: Vec<SceneJoint>,
    /// Which of their points are joined in the picture.
    pub(crate) edges: Vec<[usize; 2]>,
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
    check_what_is_there(declared)?;
    features::check(declared)?;
    let stepping = integrator::declare(declared, dimension)?;
    let mut roster = Roster::default();
    let Moved { bodies, joints, edges } = bodies::declare(&mut roster, dimension, declared)?;
    for particle in &declared.particles {
        particles::declare(&mut roster, dimension, particle)?;
    }
    let heated = declared.heat.as_ref();
    let heated =
        heated.map(|heat| heat::declare(&mut roster, dimension, folder, heat)).transpose()?;
    let written_out = if heated.is_some() {
        0
    } else if bodies.is_empty() {
        roster.particles.len()
    } else {
        bodies.len()
    };
    let mut links = Vec::new();
    for net in &declared.nets {
        nets::declare(&mut roster, &mut links, dimension, net)?;
    }
    let mut elastic = Solids { edges, ..Solids::default() };
    for solid in &declared.solids {
        solids::declare(&mut roster, &mut elastic, dimension, folder, solid)?;
    }
    for spring in &declared.springs {
        links.push(springs::declare(&roster, spring)?);
    }
    let mut rods = Vec::new();
    for rod in &declared.rods {
        rods.push(rods::declare(&roster, &rods, rod)?);
    }
    let heat = heated.map(|(body, edges, faces)| {
        (elastic.edges, elastic.faces) = (edges, faces);
        body
    });
    let contact = contacts::declare(declared, dimension)?;
    let gravity = gravity(declared, dimension, &roster)?;
    let drag = declared.drag.as_ref();
    let drag =
        drag.map(|drag| check::positive("the coefficient", &drag.coefficient)).transpose()?;
    check_that_something_moves(declared, &roster)?;

    let observables = observable::declare_all(declared, &roster, &rods)?;
    let scene = Scene {
        title: check::title("a title", declared.title.as_ref(), name)?,
        dimension,
        units: Units::declare(&declared.units)?,
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
