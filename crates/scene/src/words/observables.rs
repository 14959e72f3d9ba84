//! The word `observables`: what a run writes down of a state.

use std::fmt;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use toml::Spanned;

use crate::model::items::Rod;
use crate::model::observable::Observable;
use crate::model::particle::Motion;
use crate::text::check;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::words::draft::{DeclaredBody, Draft};
use crate::words::particle_table::ParticleTable;
use crate::words::table::{Kind, table};

table! {
    /// An observable of particles or bodies.
    pub(crate) struct ObservableTable = "an observable" {
        /// A name.
        position: Option<Spanned<String>> = Kind::Name,
        /// A name.
        velocity: Option<Spanned<String>> = Kind::Name,
        /// Two names.
        distance: Option<Spanned<Vec<Spanned<String>>>> = Kind::Pair,
        /// Two names.
        tension: Option<Spanned<Vec<Spanned<String>>>> = Kind::Pair,
        /// A name.
        angular_velocity: Option<Spanned<String>> = Kind::Name,
        /// A name.
        temperature: Option<Spanned<String>> = Kind::Name,
    }
}

/// One of `observables`: a word alone, or a word with the particles that it is about.
#[derive(Clone, Debug)]
pub(crate) enum ObservableDeclaration {
    Word(String),
    About(Box<ObservableTable>),
}

impl<'de> Deserialize<'de> for ObservableDeclaration {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct WordOrTable;
        impl<'de> Visitor<'de> for WordOrTable {
            type Value = ObservableDeclaration;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an observable such as \"energy\" or { position = \"a name\" }")
            }

            fn visit_str<E: Error>(self, word: &str) -> Result<ObservableDeclaration, E> {
                Ok(ObservableDeclaration::Word(word.to_owned()))
            }

            fn visit_map<A: MapAccess<'de>>(
                self,
                map: A,
            ) -> Result<ObservableDeclaration, A::Error> {
                let table = ObservableTable::deserialize(MapAccessDeserializer::new(map))?;
                Ok(ObservableDeclaration::About(Box::new(table)))
            }
        }
        deserializer.deserialize_any(WordOrTable)
    }
}

/// The observables of a scene that names none.
const USUAL: [Observable; 3] =
    [Observable::Energy, Observable::LinearMomentum, Observable::AngularMomentum];

/// The observables of a scene of heat that names none.
const USUAL_OF_HEAT: [Observable; 2] = [Observable::Heat, Observable::DirichletEnergy];

/// The words that an observable may be. Those in braces stand here for the sake of errors: they are
/// never found, since no word has blanks and quotes in it.
const WORDS: [(&str, Observable); 13] = [
    ("energy", Observable::Energy),
    ("kinetic-energy", Observable::KineticEnergy),
    ("potential-energy", Observable::PotentialEnergy),
    ("linear-momentum", Observable::LinearMomentum),
    ("angular-momentum", Observable::AngularMomentum),
    ("{ position = \"a name\" }", Observable::Position(0)),
    ("{ velocity = \"a name\" }", Observable::Velocity(0)),
    ("{ distance = [\"a name\", \"a name\"] }", Observable::Distance([0, 0])),
    ("{ tension = [\"a name\", \"a name\"] }", Observable::Tension(0)),
    ("{ angular_velocity = \"a name\" }", Observable::AngularVelocity(0)),
    ("heat", Observable::Heat),
    ("dirichlet-energy", Observable::DirichletEnergy),
    ("{ temperature = \"a name\" }", Observable::Temperature(0)),
];

/// The observables that are a word alone.
pub(crate) fn words() -> impl Iterator<Item = &'static str> {
    WORDS.iter().map(|&(word, _)| word).filter(|word| !word.starts_with('{'))
}

/// The observables that are declared, or the usual ones.
pub(crate) fn declare_all(
    declared: Option<&[Spanned<ObservableDeclaration>]>,
    draft: &Draft<'_>,
) -> Checked<Vec<Observable>> {
    match declared {
        Some(all) => all.iter().map(|declared| declare_one(declared, draft)).collect(),
        None if draft.heat.is_some() => Ok(USUAL_OF_HEAT.to_vec()),
        None => Ok(USUAL.to_vec()),
    }
}

/// An observable that is one of this kind of scene.
pub(crate) fn declare_one(
    declared: &Spanned<ObservableDeclaration>,
    draft: &Draft<'_>,
) -> Checked<Observable> {
    let of_heat = draft.heat.is_some();
    let observable = declare(&draft.particles, (&draft.rods, &draft.bodies), declared)?;
    if observable.of_heat() != of_heat {
        let scenes = if of_heat { "heat scenes" } else { "scenes without heat" };
        return Err(at(declared.span(), Fault::ObservableOfAnother(scenes)));
    }
    Ok(observable)
}

/// The observable that is declared.
fn declare(
    particles: &ParticleTable,
    (rods, bodies): (&[Rod], &[DeclaredBody]),
    declared: &Spanned<ObservableDeclaration>,
) -> Checked<Observable> {
    let table = match declared.get_ref() {
        ObservableDeclaration::Word(word) => {
            let found = check::word("observable", word, declared.span(), &WORDS)?;
            return Ok(found);
        }
        ObservableDeclaration::About(table) => table,
    };
    let words =
        table.names().into_iter().flatten().count() + table.pairs().into_iter().flatten().count();
    if words != 1 {
        return Err(at(declared.span(), Fault::NotOneObservable(words)));
    }
    if let Some(names) = &table.distance {
        return Ok(Observable::Distance(particles.pair("a distance", names)?));
    }
    if let Some(names) = &table.tension {
        let [a, b] = particles.pair("a tension", names)?;
        let rod = rods.iter().position(|rod| rod.ends == [a, b] || rod.ends == [b, a]);
        return rod.map(Observable::Tension).ok_or_else(|| at(names.span(), Fault::NoRod));
    }
    let find =
        |name: &Option<Spanned<String>>| name.as_ref().map(|name| particles.find(name)).transpose();
    let found = [find(&table.position)?, find(&table.velocity)?, find(&table.temperature)?];
    match (found, &table.angular_velocity) {
        ([Some(particle), ..], _) => Ok(Observable::Position(particle)),
        ([_, Some(particle), _], _) => Ok(Observable::Velocity(particle)),
        ([.., Some(particle)], _) => Ok(Observable::Temperature(particle)),
        (_, Some(name)) => match particles.particles[particles.find(name)?].motion {
            Motion::Carried { body, .. } if !bodies[body].body.point_mass => {
                Ok(Observable::AngularVelocity(body))
            }
            _ => Err(at(name.span(), Fault::NotABody(name.get_ref().clone()))),
        },
        (_, None) => Err(at(declared.span(), Fault::NotOneObservable(0))),
    }
}

impl ObservableTable {
    fn names(&self) -> [Option<&Spanned<String>>; 4] {
        [&self.position, &self.velocity, &self.angular_velocity, &self.temperature]
            .map(Option::as_ref)
    }

    fn pairs(&self) -> [Option<&Spanned<Vec<Spanned<String>>>>; 2] {
        [&self.distance, &self.tension].map(Option::as_ref)
    }
}
