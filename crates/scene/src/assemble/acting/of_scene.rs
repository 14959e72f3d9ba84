//! What acts on a scene, made from its words: loads, motors, dampers, and what depends on pins that move.

use super::rate::{End, Rate};
use super::{Act, Acting, What};
#[cfg(feature = "elasticity")]
use crate::assemble::acting::by_pins::{Attracted, ByPins, MovingPin};
#[cfg(feature = "elasticity")]
use crate::assemble::anchor::Anchor;
use crate::assemble::vertices::Vertices;
#[cfg(feature = "elasticity")]
use crate::model::drives::PinMotion;
use crate::model::drives::{Motor, MotorDrive, SceneLoad};
#[cfg(feature = "elasticity")]
use crate::model::elastic_body::ElasticBody;
use crate::model::items::{RigidBody, SceneJoint};
use crate::model::particle::Motion;
use crate::model::scene::Scene;
use crate::model::strength::Strength;
#[cfg(feature = "elasticity")]
use stationary_elasticity::Spring;

/// Names as a sentence lists them.
fn listed(names: &[&str]) -> Option<String> {
    match names.split_last()? {
        (last, []) => Some((*last).to_owned()),
        (last, rest) => Some(format!("{} and {last}", rest.join(", "))),
    }
}

impl Scene {
    /// What each work of a run is of: what acts, and the motors with a speed.
    pub(crate) fn works_of(&self) -> Vec<String> {
        if self.heat.is_some() {
            return self.drives.sources.iter().map(|_| "sources".to_owned()).collect();
        }
        let acts = Acting::of(self).map_or(Vec::new(), |acting| acting.acts);
        let mut names: Vec<String> = acts.into_iter().map(|act| act.name).collect();
        names.extend(self.works_of_steps());
        names
    }

    /// The names of the works that steps report themselves.
    fn works_of_steps(&self) -> Vec<String> {
        let mut driven = Vec::new();
        driven.extend(self.drives.has_speeds().then_some("motors with a speed"));
        driven.extend(self.moves_rods().then_some("pins that move rods"));
        if !self.has_inequalities() {
            return listed(&driven).into_iter().collect();
        }
        let mut names = Vec::new();
        if self.touches_as_bodies() {
            names.extend(["friction", "impacts"]);
        }
        #[cfg(feature = "contact")]
        names.extend(self.obstacles().next().map(|_| "pins that move and touch"));
        names.push("lifting out of overlap");
        if self.joints.iter().any(|joint| joint.friction > 0.0) {
            names.push("friction of joints");
        }
        let mut held = vec!["joints"];
        if self.joints.iter().any(|joint| joint.limits.is_some()) {
            held.push("their limits");
        }
        held.extend(driven);
        let held = listed(&held).filter(|_| self.has_joints());
        names.into_iter().map(str::to_owned).chain(held).collect()
    }

    /// Freedoms of a particle or a body.
    pub(super) fn freedoms_of_each(&self) -> usize {
        match (self.bodies.is_empty(), self.dimension) {
            (true, dimension) => dimension,
            (false, 3) => 6,
            (false, _) => 3,
        }
    }

    /// A vector as it stands in the freedoms of each particle or body.
    pub(super) fn repeated(&self, x: [f64; 3]) -> Vec<f64> {
        let each = self.freedoms_of_each();
        (0..each).map(|c| if c < self.dimension { x[c] } else { 0.0 }).collect()
    }

    /// One over the mass of each freedom.
    pub(super) fn inverse_masses(&self) -> Vec<f64> {
        if self.bodies.is_empty() {
            let mass = |&particle: &usize| match self.particles[particle].motion {
                Motion::Free { mass, .. } => mass,
                _ => f64::INFINITY,
            };
            let vertices = Vertices::new(self);
            let masses = vertices.particles[..vertices.free].iter().map(mass);
            return masses.flat_map(|mass| vec![1.0 / mass; self.dimension]).collect();
        }
        let masses = |body: &RigidBody| {
            let (m, [i, j, k]) = (body.mass, body.moments);
            if self.dimension == 3 { vec![m, m, m, i, j, k] } else { vec![m, m, k] }
        };
        self.bodies.iter().flat_map(masses).map(|mass| 1.0 / mass).collect()
    }

    pub(super) fn loads(&self) -> Vec<Act> {
        let vertices = Vertices::new(self);
        let act = |load: &SceneLoad| {
            let particle = &self.particles[load.on];
            let what = match particle.motion {
                Motion::Carried { body, point } => {
                    What::Point { body, point, force: load.force, torque: load.torque }
                }
                _ => {
                    let first = self.dimension * vertices.of_particle[load.on];
                    let force = &load.force[..self.dimension];
                    What::Freedoms((first..).zip(force.iter().copied()).collect())
                }
            };
            let name = format!("load on {}", particle.name);
            Act { name, strength: load.strength.clone(), what }
        };
        self.drives.loads.iter().map(act).collect()
    }

    /// Motors with a torque: about an axis that both bodies keep.
    pub(super) fn motors(&self) -> Vec<Act> {
        let torques = self.drives.motors.iter().filter(|motor| motor.drive == MotorDrive::Torque);
        let act = |motor: &Motor| {
            let all = self.turn_between(&self.joints[motor.joint]);
            let strength = motor.strength.clone();
            Act { name: self.motor_named(motor), strength, what: What::Freedoms(all) }
        };
        torques.map(act).collect()
    }

    /// How fast the second body turns against the first about the axis of their joint, by the rates of
    /// freedoms: both bodies keep the axis.
    fn turn_between(&self, joint: &SceneJoint) -> Vec<(usize, f64)> {
        let each = self.freedoms_of_each();
        let mut all = Vec::new();
        for (end, sign) in joint.between.into_iter().zip([-1.0, 1.0]) {
            let Some(body) = end else { continue };
            if self.dimension == 2 {
                all.push((each * body + 2, sign));
                continue;
            }
            #[cfg(feature = "rigid")]
            for (c, axis) in self.bodies[body].in_axes(joint.axis).into_iter().enumerate() {
                all.push((each * body + 3 + c, sign * axis));
            }
        }
        all
    }

    /// The names of what a joint joins.
    pub(crate) fn ends_named(&self, joint: &SceneJoint) -> [&str; 2] {
        joint.between.map(|end| end.map_or("world", |body| self.bodies[body].name.as_str()))
    }

    /// A motor, by what it joins.
    pub(crate) fn motor_named(&self, motor: &Motor) -> String {
        let [a, b] = self.ends_named(&self.joints[motor.joint]);
        format!("motor between {a} and {b}")
    }

    /// Springs and joints that are damped.
    pub(super) fn dampers(&self) -> Vec<Act> {
        let vertices = Vertices::new(self);
        let act = |name, damping, rate| {
            let strength = Strength::constant(1.0);
            Act { name, strength, what: What::Damper(damping, rate) }
        };
        let damped = self.links.iter().filter(|link| link.damping > 0.0);
        let springs = damped.map(|link| {
            let [a, b] = link.ends.map(|end| self.particles[end].name.as_str());
            let ends = link.ends.map(|end| self.end(end, &vertices));
            act(format!("damper between {a} and {b}"), link.damping, Rate::Distance(ends))
        });
        let damped = self.joints.iter().filter(|joint| joint.damping > 0.0);
        let joints = damped.map(|joint| {
            let [a, b] = self.ends_named(joint);
            let rate = Rate::Freedoms(self.turn_between(joint));
            act(format!("damper between {a} and {b}"), joint.damping, rate)
        });
        springs.chain(joints).collect()
    }

    /// An end of a damped spring.
    fn end(&self, particle: usize, vertices: &Vertices) -> End {
        match self.drives.motion_of(particle) {
            Some(pin) => End::Moved(pin.clone(), self.particles[particle].position),
            None => End::Held(self.anchor(particle, vertices)),
        }
    }

    /// What depends on pins that move: springs to them, elements that have them as vertices, their attraction.
    pub(super) fn by_pins(&self) -> Vec<Act> {
        #[cfg(not(feature = "elasticity"))]
        return Vec::new();
        #[cfg(feature = "elasticity")]
        {
            let mut acts = self.pulled();
            if !self.drives.motions.is_empty() {
                acts.extend(self.moved_elements());
                acts.extend(self.moved_attraction());
            }
            acts
        }
    }
}

#[cfg(feature = "elasticity")]
impl Scene {
    fn moving_pin(&self, motion: &PinMotion) -> MovingPin {
        let start = self.particles[motion.particle].position;
        MovingPin { motion: motion.clone(), start }
    }

    fn act_of_pins(name: String, what: ByPins) -> Act {
        Act { name, strength: Strength::constant(1.0), what: What::ByPins(what) }
    }

    /// The springs to pins that move.
    fn pulled(&self) -> Vec<Act> {
        let mut acts = Vec::new();
        let vertices = Vertices::new(self);
        for link in &self.links {
            let [a, b] = link.ends;
            let motion = |end| self.drives.motion_of(end);
            let (pin, other) = match (motion(a), motion(b)) {
                (Some(pin), None) => (pin, b),
                (None, Some(pin)) => (pin, a),
                _ => continue,
            };
            let pulled = self.anchor(other, &vertices);
            let made = Spring::new([0, 1], link.rest_length, link.stiffness, link.strain);
            let fixed = matches!(pulled, Anchor::World(_));
            let (false, Ok(spring)) = (fixed, made) else { continue };
            let name = format!("motion of {}", self.particles[pin.particle].name);
            let what = ByPins::Spring { spring, pulled, pin: self.moving_pin(pin) };
            acts.push(Scene::act_of_pins(name, what));
        }
        acts
    }

    /// The elements that have vertices which move, of each solid.
    fn moved_elements(&self) -> Vec<Act> {
        let act = |solid: &ElasticBody| {
            let vertices = Vertices::with_moving(self);
            let elastic = self.moved_part(solid, &vertices).ok().flatten()?;
            let pins = vertices.particles[..vertices.free].iter();
            let pins = pins.filter_map(|&p| Some(self.moving_pin(self.drives.motion_of(p)?)));
            let what =
                ByPins::Elements { elastic, pins: pins.collect(), dimension: self.dimension };
            Some(Scene::act_of_pins(format!("motion of vertices of {}", solid.name), what))
        };
        self.solids.iter().filter_map(act).collect()
    }

    /// What attracts and moves.
    fn moved_attraction(&self) -> Vec<Act> {
        let (Some(constant), vertices) = (self.gravity.constant, Vertices::new(self)) else {
            return Vec::new();
        };
        let attracted = |mass: f64| {
            let strength = |own: f64| constant * own * mass;
            if self.bodies.is_empty() {
                let free = vertices.particles[..vertices.free].iter();
                let one = |&number: &usize| {
                    let Motion::Free { mass, .. } = self.particles[number].motion else {
                        return None;
                    };
                    let at = self.anchor(number, &vertices);
                    Some(Attracted { at, number, strength: strength(mass), radius: 0.0 })
                };
                return free.filter_map(one).collect();
            }
            let one = |(number, body): (usize, &RigidBody)| Attracted {
                at: Anchor::Body(number, [0.0; 3]),
                number,
                strength: strength(body.mass),
                radius: body.attracting_radius(),
            };
            self.bodies.iter().enumerate().map(one).collect::<Vec<_>>()
        };
        let act = |&(pin, mass): &(usize, f64)| {
            let pin = self.moving_pin(self.drives.motion_of(pin)?);
            let name = format!("motion of {}", self.particles[pin.motion.particle].name);
            Some(Scene::act_of_pins(name, ByPins::Attraction { pin, all: attracted(mass) }))
        };
        self.gravity.fixed.iter().filter_map(act).collect()
    }
}
