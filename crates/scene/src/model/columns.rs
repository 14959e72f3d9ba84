//! The columns of an observable: their headings, and the numbers of a state.

use crate::model::observable::Observable;
use crate::model::scene::{COORDINATES, Scene};

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
