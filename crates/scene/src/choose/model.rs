//! The models of a scene: itself, and ever simpler ones that a question may get by with.
//!
//! ```text
//! cells      every shape with a half, a quarter, ... of its cells;  to see the mesh's own error, with
//!            twice and four times as many
//! elements   quadratic ones in a half, a quarter, ... of the cells; linear ones for quadratic
//! contact    impulses at another moment, or by another law;  springs,  k = m (pi n/T)^2
//! rods       for springs that swing so fast that the question cannot see it
//! rigid      M = sum m_i,  c = sum m_i x_i / M,  I = sum m_i (|r|^2 - r r^T),  r = x_i - c
//!            v = sum p_i / M,  w = I^-1 sum r x p_i                 a body for each elastic one
//! points     M at c with v: every place of a body moves as its centre does
//! ```
//! A spring of touch lasts an n-th of the horizon T, n = 100, 1000, ..., of the lightest mass m.
//! Each is a scene's text that can be run, and what is asked for is asked of it. The scene itself
//! is what all are judged by: where its own mesh is too coarse, that is not found out here.

use std::f64::consts::PI;

use toml::{Table, Value};

use super::observable::observed;
use super::{rods, surrogate};
use crate::model::elastic_body::ElasticBody;
use crate::model::particle::Motion;
use crate::model::scene::Scene;
use crate::model::simplices::Simplices;

/// What a model makes of the scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Simplification {
    /// Itself.
    AsWritten,
    /// Shapes of fewer cells: so many halvings.
    Halved(u32),
    /// Shapes of more cells, to see the mesh's own error: each halved in length so often.
    Refined(u32),
    /// Elastic bodies of other elements, in cells after so many halvings.
    Elements {
        /// `linear` or `quadratic`.
        word: &'static str,
        /// Of the cells.
        halvings: u32,
    },
    /// Another word in `[contact]`.
    Contact {
        /// `when` or `law`.
        key: &'static str,
        /// What it says.
        word: &'static str,
    },
    /// Springs instead of impulses that are elastic.
    Springs {
        /// Force per depth.
        stiffness: f64,
    },
    /// Rods for stiff springs, by their places in the file.
    Rods(Vec<usize>),
    /// Rigid bodies for elastic ones.
    Rigid,
    /// Point masses for bodies.
    Points,
}

/// A way to see a scene.
#[derive(Clone, Debug)]
pub struct Model {
    /// What it makes of the scene.
    pub simplification: Simplification,
    /// In words, such as `with 10 x 1 cells`; none of the scene itself.
    pub words: String,
    /// The scene's text, seen so.
    pub text: String,
    /// The scene, seen so.
    pub scene: Scene,
    /// Elements, in linear ones, or bodies, of a scene that has models of several sizes; else one.
    pub pieces: u64,
}

/// Halvings of the number of cells that are tried.
const HALVINGS: u32 = 4;
/// Halvings of their length.
const REFINEMENTS: u32 = 2;
/// Elements of a refined mesh, at most.
const MOST_ELEMENTS: u64 = 1 << 18;
/// How near a place must be to another to be the same, relative to the scene.
const SAME: f64 = 1e-9;

impl Model {
    /// The scene itself, and then its models from the finest to the simplest.
    pub fn all(name: &str, text: &str, scene: &Scene) -> Vec<Model> {
        let written =
            Model::new(Simplification::AsWritten, String::new(), text.to_owned(), scene.clone());
        let mut models = vec![written];
        let Ok(table) = toml::from_str::<Table>(text) else { return models };
        for halvings in 1..=HALVINGS {
            models.extend(halved(name, &table, scene, halvings));
        }
        for (word, least) in [("linear", 0), ("quadratic", 1)] {
            // More nodes than the scene itself has cost more and are not it.
            for halvings in least..=HALVINGS {
                models.extend(of_elements(name, &table, scene, word, halvings));
            }
        }
        models.extend(other_contacts(name, &table, scene));
        models.extend(springs(name, &table, scene));
        models.extend(of_rods(name, &table, scene));
        for simplification in [Simplification::Rigid, Simplification::Points] {
            models.extend(simplified(name, &table, scene, simplification));
        }
        let written = models[0].pieces;
        if models.iter().all(|model| model.pieces == written) {
            models.iter_mut().for_each(|model| model.pieces = 1);
        }
        models
    }

    /// The scene on finer meshes, each of half the length of the one before, to see its own error.
    pub fn finer(name: &str, written: &Model) -> Vec<Model> {
        let Ok(table) = toml::from_str::<Table>(&written.text) else { return Vec::new() };
        let refined = |halvings| refined(name, &table, &written.scene, halvings);
        let mut models: Vec<Model> = (1..=REFINEMENTS).filter_map(refined).collect();
        let own = Model::new(
            Simplification::AsWritten,
            String::new(),
            String::new(),
            written.scene.clone(),
        );
        for model in &mut models {
            model.pieces = (model.pieces * written.pieces).div_ceil(own.pieces);
        }
        models
    }

    fn new(simplification: Simplification, words: String, text: String, scene: Scene) -> Self {
        let elements = scene.solids().iter().map(in_linear_elements);
        let heated = scene.heat().map(|body| body.simplices.len() as f64);
        let elements = elements.chain(heated).sum::<f64>().round() as u64;
        let pieces = elements.max(scene.bodies().len() as u64).max(1);
        Model { simplification, words, text, scene, pieces }
    }

    /// How much simpler than the scene itself: of runs that cost the same, the simplest is chosen.
    pub fn simplicity(&self) -> u32 {
        match &self.simplification {
            Simplification::AsWritten
            | Simplification::Refined(_)
            | Simplification::Contact { .. }
            | Simplification::Springs { .. } => 0,
            Simplification::Halved(halvings) | Simplification::Elements { halvings, .. } => {
                *halvings
            }
            Simplification::Rods(_) => 1,
            Simplification::Rigid => HALVINGS + 1,
            Simplification::Points => HALVINGS + 2,
        }
    }

    /// Another text of the scene seen so, where it can be: with more observables, or comments.
    pub fn seen(&self, text: &str) -> Option<String> {
        match self.simplification {
            Simplification::AsWritten => Some(text.to_owned()),
            Simplification::Rods(ref springs) => {
                written(&rods::with_rods(&toml::from_str(text).ok()?, springs)?)
            }
            Simplification::Halved(halvings) => {
                written(&with_fewer_cells(&toml::from_str(text).ok()?, halvings)?)
            }
            Simplification::Elements { word, halvings } => {
                written(&with_elements(&toml::from_str(text).ok()?, word, halvings)?)
            }
            Simplification::Contact { key, word } => {
                written(&with_contact(&toml::from_str(text).ok()?, key, word)?)
            }
            Simplification::Springs { stiffness } => {
                written(&with_springs(&toml::from_str(text).ok()?, stiffness)?)
            }
            // Nobody asks for more than is written, and bodies have no other places than the observed.
            Simplification::Refined(_) | Simplification::Rigid | Simplification::Points => None,
        }
    }
}

/// Things whose places are compared beside the observable.
const PLACES: usize = 6;

/// The first things that move, whose places are compared; none of what stands for something else.
pub(super) fn moved(model: &Model) -> Vec<usize> {
    let moves = |(_, particle): &(usize, &crate::Particle)| particle.motion != Motion::Pinned;
    let particles = model.scene.particles().iter().enumerate().filter(moves);
    match model.simplification {
        Simplification::AsWritten
        | Simplification::Contact { .. }
        | Simplification::Springs { .. }
        | Simplification::Rods(_) => particles.map(|(number, _)| number).take(PLACES).collect(),
        _ => Vec::new(),
    }
}

fn written(table: &Table) -> Option<String> {
    toml::to_string(table).ok()
}

fn parsed(name: &str, table: &Table) -> Option<(String, Scene)> {
    let text = written(table)?;
    let scene = Scene::parse_at(name, &text).ok()?;
    Some((text, scene))
}

/// What an element of a body counts, in linear ones of its dimension: as many times the instructions
/// of a differential, counted by callgrind over meshes of a thousand and more.
const QUADRATIC: [f64; 3] = [2.3, 4.1, 6.0];

fn in_linear_elements(body: &ElasticBody) -> f64 {
    let quadratic = match &body.simplices {
        Simplices::Segments(_) => QUADRATIC[0],
        Simplices::Triangles(_) => QUADRATIC[1],
        Simplices::Tetrahedra(_) => QUADRATIC[2],
    };
    let each = if body.middles.is_empty() { 1.0 } else { quadratic };
    each * body.simplices.len() as f64
}

/// The scene with shapes of fewer cells, where these have the observed places too.
fn halved(name: &str, table: &Table, scene: &Scene, halvings: u32) -> Option<Model> {
    let fewer = with_fewer_cells(table, halvings)?;
    let words = format!("with {} cells", cells_of(&fewer));
    otherwise(name, &fewer, scene, Simplification::Halved(halvings), words)
}

/// The scene with shapes of more cells, where these have the observed places too.
fn refined(name: &str, table: &Table, scene: &Scene, halvings: u32) -> Option<Model> {
    let of_heat = scene.heat().map_or(0, |body| body.simplices.len());
    let elements = scene.solids().iter().map(|body| body.simplices.len()).sum::<usize>() + of_heat;
    let grown = (elements as u64) << (scene.dimension() as u32 * halvings);
    if grown > MOST_ELEMENTS {
        return None;
    }
    let more = with_other_cells(table, |levels, count| match levels {
        true => Some(count + i64::from(halvings)),
        false => count.checked_mul(1 << halvings),
    })?;
    let words = format!("with {} cells", cells_of(&more));
    otherwise(name, &more, scene, Simplification::Refined(halvings), words)
}

/// The scene with elastic bodies of other elements, where these have the observed places too.
fn of_elements(
    name: &str,
    table: &Table,
    scene: &Scene,
    word: &'static str,
    halvings: u32,
) -> Option<Model> {
    let other = with_elements(table, word, halvings)?;
    let words = format!("with {} {word} cells", cells_of(&other));
    otherwise(name, &other, scene, Simplification::Elements { word, halvings }, words)
}

/// A scene of other shapes, where these have the observed places too.
fn otherwise(
    name: &str,
    table: &Table,
    scene: &Scene,
    simplification: Simplification,
    words: String,
) -> Option<Model> {
    let (text, coarse) = parsed(name, table)?;
    let place =
        |scene: &Scene, particle: usize| scene.particles().get(particle).map(|p| p.position);
    let size =
        scene.particles().iter().flat_map(|p| p.position).fold(0.0, |a: f64, x| a.max(x.abs()));
    let (ours, theirs) = (observed(scene), observed(&coarse));
    let same = ours.iter().zip(&theirs).all(|(&a, &b)| {
        let (Some(a), Some(b)) = (place(scene, a), place(&coarse, b)) else { return false };
        a.iter().zip(b).all(|(a, b)| (a - b).abs() <= SAME * size)
    });
    same.then(|| Model::new(simplification, words, text, coarse))
}

/// Elements of bodies that are not all of this kind already, in cells halved so often.
fn with_elements(table: &Table, word: &str, halvings: u32) -> Option<Table> {
    let cells = if halvings == 0 { None } else { Some(with_fewer_cells(table, halvings)?) };
    let mut other = cells.unwrap_or_else(|| table.clone());
    let mut changes = false;
    for solid in other.get_mut("solids")?.as_array_mut()? {
        let before = solid.as_table_mut()?.insert("element".to_owned(), word.into());
        changes |= before.as_ref().and_then(Value::as_str).unwrap_or("linear") != word;
    }
    changes.then_some(other)
}

/// The tables of shapes.
fn shapes(table: &mut Table) -> Vec<&mut Table> {
    let mut found = Vec::new();
    for (key, value) in table.iter_mut() {
        let owners = match (key.as_str(), value) {
            ("solids", Value::Array(all)) => all.as_mut_slice(),
            ("heat", one) => std::slice::from_mut(one),
            _ => continue,
        };
        let shapes = owners.iter_mut().filter_map(|owner| owner.get_mut("shape")?.as_table_mut());
        found.extend(shapes);
    }
    found
}

/// The cells of all shapes halved so often, where each has cells and one can be halved.
fn with_fewer_cells(table: &Table, halvings: u32) -> Option<Table> {
    let fewer = |levels: bool, count: i64| match levels {
        true => Some(count - i64::from(halvings)).filter(|&coarse| coarse >= 0),
        false if count == 1 => Some(1),
        false => {
            let coarse = count >> halvings;
            (coarse > 0 && coarse << halvings == count).then_some(coarse)
        }
    };
    with_other_cells(table, fewer)
}

/// Other numbers of cells of all shapes, where each has some; those of balls and spheres are levels.
fn with_other_cells(table: &Table, of: impl Fn(bool, i64) -> Option<i64>) -> Option<Table> {
    let mut other = table.clone();
    for shape in shapes(&mut other) {
        let levels = matches!(shape.get("kind")?.as_str()?, "ball" | "sphere");
        let Some(Value::Array(cells)) = shape.get_mut("cells") else { return None };
        for cell in cells {
            *cell = Value::Integer(of(levels, cell.as_integer()?)?);
        }
    }
    (other != *table).then_some(other)
}

/// The cells of the shapes in words: `20 x 2`.
fn cells_of(table: &Table) -> String {
    let mut table = table.clone();
    let cells = |shape: &mut Table| {
        let cells = shape.get("cells")?.as_array()?;
        Some(cells.iter().map(ToString::to_string).collect::<Vec<_>>().join(" x "))
    };
    shapes(&mut table).into_iter().filter_map(cells).collect::<Vec<_>>().join(" and ")
}

/// Impulses at other moments, of particles, and by other laws.
fn other_contacts(name: &str, table: &Table, scene: &Scene) -> Vec<Model> {
    let Some(contact) = scene.contact() else { return Vec::new() };
    let moments = stationary_contact::When::ALL.iter().filter(|when| **when != contact.when);
    let moments = moments.map(|when| ("when", when.name()));
    let laws = stationary_contact::ImpactLaw::ALL.iter().filter(|law| **law != contact.law);
    let laws = laws.map(|law| ("law", law.facts().name));
    let seen = |(key, word): (&'static str, &'static str)| {
        let (text, scene) = parsed(name, &with_contact(table, key, word)?)?;
        let words = format!("by `{word}`");
        Some(Model::new(Simplification::Contact { key, word }, words, text, scene))
    };
    moments.chain(laws).filter_map(seen).collect()
}

/// Horizons in the time of a touch, of the springs that are tried.
const TOUCHES: [f64; 3] = [1e2, 1e3, 1e4];

/// Springs for impulses of particles that give back what they took.
fn springs(name: &str, table: &Table, scene: &Scene) -> Vec<Model> {
    let elastic = scene.contact().is_some_and(|contact| contact.restitution == 1.0);
    let masses = scene.particles().iter().filter_map(|particle| match particle.motion {
        Motion::Free { mass, .. } => Some(mass),
        _ => None,
    });
    let Some(mass) = masses.reduce(f64::min).filter(|_| elastic) else { return Vec::new() };
    let seen = |touches: f64| {
        let stiffness = mass * (PI * touches / scene.timing().horizon()).powi(2);
        let (text, scene) = parsed(name, &with_springs(table, stiffness)?)?;
        let words = format!("by springs of {stiffness:.1e}");
        Some(Model::new(Simplification::Springs { stiffness }, words, text, scene))
    };
    TOUCHES.into_iter().filter_map(seen).collect()
}

fn with_springs(table: &Table, stiffness: f64) -> Option<Table> {
    let mut other = table.clone();
    let contact = other.get_mut("contact")?.as_table_mut()?;
    for key in ["law", "when", "restitution"] {
        contact.remove(key);
    }
    contact.insert("stiffness".to_owned(), stiffness.into());
    Some(other)
}

fn with_contact(table: &Table, key: &str, word: &str) -> Option<Table> {
    let mut other = table.clone();
    other.get_mut("contact")?.as_table_mut()?.insert(key.to_owned(), word.into());
    Some(other)
}

/// Rods for its stiff springs.
fn of_rods(name: &str, table: &Table, scene: &Scene) -> Option<Model> {
    let springs = rods::stiff(table, scene);
    if springs.is_empty() {
        return None;
    }
    let (text, scene) = parsed(name, &rods::with_rods(table, &springs)?)?;
    let words = match springs.len() {
        1 => "with a rod for a spring".to_owned(),
        some => format!("with rods for {some} springs"),
    };
    Some(Model::new(Simplification::Rods(springs), words, text, scene))
}

/// Rigid bodies or point masses, where nothing but weight acts on what they stand for.
fn simplified(
    name: &str,
    table: &Table,
    scene: &Scene,
    simplification: Simplification,
) -> Option<Model> {
    let alone =
        ["particles", "springs", "rods", "nets", "newtonian_gravity", "drag", "contact", "heat"];
    if alone.iter().any(|key| table.contains_key(*key)) {
        return None;
    }
    let (simple, words) = match simplification {
        Simplification::Rigid if !scene.solids().is_empty() => {
            (surrogate::rigid(table, scene)?, "as a rigid body")
        }
        Simplification::Points if scene.joints().is_empty() => {
            (surrogate::points(table, scene)?, "as a point mass")
        }
        _ => return None,
    };
    let (text, scene) = parsed(name, &simple)?;
    Some(Model::new(simplification, words.to_owned(), text, scene))
}
