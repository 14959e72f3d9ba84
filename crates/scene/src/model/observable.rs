//! What a run writes down of a state besides the positions.
//!
//! ```text
//! T = sum_i |p_i|^2 / 2 m_i      kinetic energy        V(q)     potential energy     E = T + V
//! P = sum_i p_i                  linear momentum       L = sum_i q_i x p_i    about the origin
//! ```
//! Sums over the particles that are free: a pinned one has no momentum. Of a scene of heat
//! ```text
//! H = int f      heat            V = 1/2 int |grad f|^2      Dirichlet energy
//! ```

use toml::Spanned;

use crate::model::scene::Scene;
use crate::run::error::COORDINATES;
use crate::text::check;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::words::declaration::{Declaration, ObservableDeclaration, ObservableTable};
use crate::words::particles::{Motion, Roster};
use crate::words::rods::Rod;

/// A number, or a vector, of a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Observable {
    /// E, the sum of the two below.
    Energy,
    /// T.
    KineticEnergy,
    /// V.
    PotentialEnergy,
    /// P, a component a column.
    LinearMomentum,
    /// L, one column in the plane, three in space, none on a line.
    AngularMomentum,
    /// Where a particle is.
    Position(usize),
    /// How fast a particle moves, a component a column.
    Velocity(usize),
    /// How far apart two particles are.
    Distance([usize; 2]),
    /// The tension of a rod, negative for a thrust: that of the mean force over the last step.
    Tension(usize),
    /// How fast a body turns, in body axes; one column in the plane.
    AngularVelocity(usize),
    /// H.
    Heat,
    /// V of a scene of heat.
    DirichletEnergy,
    /// How warm a vertex is.
    Temperature(usize),
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

/// The observables that are declared, or the usual ones.
pub(crate) fn declare_all(
    declared: &Declaration,
    roster: &Roster,
    rods: &[Rod],
) -> Checked<Vec<Observable>> {
    let of_heat = declared.heat.is_some();
    let Some(all) = &declared.observables else {
        return Ok(if of_heat { USUAL_OF_HEAT.to_vec() } else { USUAL.to_vec() });
    };
    let one = |declared: &Spanned<ObservableDeclaration>| {
        let observable = declare(roster, rods, declared)?;
        if observable.of_heat() != of_heat {
            let scenes = if of_heat { "heat scenes" } else { "scenes without heat" };
            return Err(at(declared.span(), Fault::ObservableOfAnother(scenes)));
        }
        Ok(observable)
    };
    all.iter().map(one).collect()
}

/// The observable that is declared.
fn declare(
    roster: &Roster,
    rods: &[Rod],
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
        return Ok(Observable::Distance(roster.pair("a distance", names)?));
    }
    if let Some(names) = &table.tension {
        let [a, b] = roster.pair("a tension", names)?;
        let rod = rods.iter().position(|rod| rod.ends == [a, b] || rod.ends == [b, a]);
        return rod.map(Observable::Tension).ok_or_else(|| at(names.span(), Fault::NoRod));
    }
    let find =
        |name: &Option<Spanned<String>>| name.as_ref().map(|name| roster.find(name)).transpose();
    let particles = [find(&table.position)?, find(&table.velocity)?, find(&table.temperature)?];
    match (particles, &table.angular_velocity) {
        ([Some(particle), ..], _) => Ok(Observable::Position(particle)),
        ([_, Some(particle), _], _) => Ok(Observable::Velocity(particle)),
        ([.., Some(particle)], _) => Ok(Observable::Temperature(particle)),
        (_, Some(name)) => match roster.particles[roster.find(name)?].motion {
            Motion::Carried { body, .. } => Ok(Observable::AngularVelocity(body)),
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

/// A state, seen from every side that an observable may ask for.
#[derive(Debug, Default)]
pub(crate) struct Moment<'a> {
    pub(crate) kinetic: f64,
    pub(crate) potential: f64,
    pub(crate) linear: [f64; 3],
    pub(crate) angular: [f64; 3],
    /// Positions of all particles, in the scene's order.
    pub(crate) positions: &'a [[f64; 3]],
    /// Velocities of all particles, in the scene's order.
    pub(crate) velocities: &'a [[f64; 3]],
    /// Orientation and velocities of all bodies, as a sample keeps them.
    pub(crate) bodies: &'a [f64],
    /// Tensions of all rods, in the scene's order; zero before the first step and once broken.
    pub(crate) tensions: &'a [f64],
    /// Angular velocities of all bodies, in body axes.
    pub(crate) angular_velocities: &'a [[f64; 3]],
    /// Temperatures of all particles of a scene of heat, whose potential energy is the Dirichlet
    /// energy.
    pub(crate) temperatures: &'a [f64],
    pub(crate) heat: f64,
}

impl Observable {
    /// Whether it is an observable of scenes of heat, which have no other.
    fn of_heat(self) -> bool {
        matches!(self, Observable::Heat | Observable::DirichletEnergy | Observable::Temperature(_))
    }

    /// The headings of its columns, with units.
    pub fn headings(&self, scene: &Scene) -> Vec<String> {
        let units = scene.units();
        let name = |particle: usize| &scene.particles()[particle].name;
        let components = |what: String, unit: String| -> Vec<String> {
            let axes = &COORDINATES[..scene.dimension()];
            axes.iter().map(|axis| format!("{what} {axis} [{unit}]")).collect()
        };
        match *self {
            Observable::Energy => vec![format!("energy [{}]", units.energy())],
            Observable::KineticEnergy => vec![format!("kinetic energy [{}]", units.energy())],
            Observable::PotentialEnergy => vec![format!("potential energy [{}]", units.energy())],
            Observable::LinearMomentum => {
                components("linear momentum".to_owned(), units.momentum())
            }
            Observable::AngularMomentum => match scene.dimension() {
                1 => Vec::new(),
                2 => vec![format!("angular momentum [{}]", units.angular_momentum())],
                _ => components("angular momentum".to_owned(), units.angular_momentum()),
            },
            Observable::Position(particle) => {
                components(format!("position of {}", name(particle)), units.length.clone())
            }
            Observable::Velocity(particle) => {
                components(format!("velocity of {}", name(particle)), units.velocity())
            }
            Observable::Distance([a, b]) => {
                vec![format!("distance {} to {} [{}]", name(a), name(b), units.length)]
            }
            Observable::Tension(rod) => {
                let [a, b] = scene.rods()[rod].ends;
                vec![format!("tension {} to {} [{}]", name(a), name(b), units.force())]
            }
            Observable::Heat => vec!["heat".to_owned()],
            Observable::DirichletEnergy => vec!["Dirichlet energy".to_owned()],
            Observable::Temperature(particle) => vec![format!("temperature of {}", name(particle))],
            Observable::AngularVelocity(body) => {
                let what = format!("angular velocity of {}", scene.bodies()[body].name);
                let unit = format!("rad/{}", units.time);
                match scene.dimension() {
                    3 => components(what, unit),
                    _ => vec![format!("{what} [{unit}]")],
                }
            }
        }
    }

    /// Its numbers, as many as it has headings.
    pub(crate) fn append(&self, moment: &Moment<'_>, dimension: usize, row: &mut Vec<f64>) {
        match *self {
            Observable::Energy => row.push(moment.kinetic + moment.potential),
            Observable::KineticEnergy => row.push(moment.kinetic),
            Observable::PotentialEnergy | Observable::DirichletEnergy => row.push(moment.potential),
            Observable::Heat => row.push(moment.heat),
            Observable::Temperature(particle) => row.push(moment.temperatures[particle]),
            Observable::LinearMomentum => row.extend(&moment.linear[..dimension]),
            Observable::AngularMomentum => row.extend(match dimension {
                1 => &[],
                2 => &moment.angular[2..],
                _ => &moment.angular[..],
            }),
            Observable::Position(particle) => {
                row.extend(&moment.positions[particle][..dimension]);
            }
            Observable::Velocity(particle) => {
                row.extend(&moment.velocities[particle][..dimension]);
            }
            Observable::Tension(rod) => row.push(moment.tensions[rod]),
            Observable::Distance([a, b]) => {
                let (a, b) = (moment.positions[a], moment.positions[b]);
                row.push((0..3).map(|c| (a[c] - b[c]) * (a[c] - b[c])).sum::<f64>().sqrt());
            }
            Observable::AngularVelocity(body) => row.extend(match dimension {
                3 => &moment.angular_velocities[body][..],
                _ => &moment.angular_velocities[body][2..],
            }),
        }
    }
}
