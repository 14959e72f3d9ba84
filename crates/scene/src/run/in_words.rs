//! What fails in a run, in the names of its scene: rods, joints, bodies and vertices instead of the rows
//! of equations and the freedoms by which the crates below count.

use stationary_calculus::Readable;
use stationary_integrators::{AdaptiveError, StepError};

use crate::assemble::error::AssemblyError;
use crate::assemble::vertices::Vertices;
use crate::model::drives::MotorDrive;
use crate::model::items::{JointKind, SceneJoint};
use crate::model::particle::Motion;
use crate::model::scene::{COORDINATES, Scene};
use crate::run::error::{RunError, StepFailure};
#[cfg(feature = "constraints")]
use stationary_constraints::ConstraintError;
#[cfg(feature = "contact")]
use stationary_contact::ContactError;
#[cfg(feature = "laplacian")]
use stationary_laplacian::LaplacianError;
#[cfg(feature = "modal")]
use stationary_modal::ModalError;

impl Scene {
    /// The same error in the scene's names.
    pub(crate) fn named(&self, error: RunError) -> RunError {
        let RunError::Assembly(source) = error else { return error };
        let words = match &source {
            #[cfg(feature = "constraints")]
            AssemblyError::Constraint(error) => {
                self.constraint_in_words(error, &(0..self.rods.len()).collect::<Vec<_>>())
            }
            #[cfg(feature = "contact")]
            AssemblyError::Contact(error) => self.contact_in_words(error),
            #[cfg(feature = "modal")]
            AssemblyError::Modal(ModalError::NoEquilibrium { residual, freedom, tolerance }) => {
                self.particle_of(*freedom).map(|(particle, axis)| {
                    format!(
                        "no equilibrium was found: the residual is {residual:e}, largest at \
                         `{particle}` in {axis}; at most {tolerance:e} is allowed"
                    )
                })
            }
            AssemblyError::Adaptive(error) => self.adaptive_named(error),
            AssemblyError::Equilibrium { freedom, freedoms, .. } => {
                self.searched(*freedom, *freedoms).map(|(particle, axis)| {
                    format!(
                        "{source}; the largest acceleration left is that of `{particle}` in {axis}"
                    )
                })
            }
            _ => None,
        };
        RunError::Assembly(match words {
            Some(words) => AssemblyError::Named { words, source: Box::new(source) },
            None => source,
        })
    }

    /// What a failed step says, where it counts equations or freedoms; `left` are the rods that have not
    /// broken.
    pub(crate) fn failure_named(&self, failure: &StepFailure, left: &[usize]) -> Option<String> {
        // Without constraints there are no rods.
        let _ = left;
        match failure {
            StepFailure::Step(StepError::NonFiniteConfiguration { freedom }) => {
                self.body_of(*freedom, Numbers::Stored).map(|body| not_finite("position", body))
            }
            StepFailure::Step(StepError::NonFiniteMomentum { freedom }) => {
                self.body_of(*freedom, Numbers::Freedoms).map(|body| not_finite("momentum", body))
            }
            #[cfg(feature = "constraints")]
            StepFailure::Constraint(error) => self.constraint_in_words(error, left),
            #[cfg(feature = "contact")]
            StepFailure::Contact(ContactError::Rows(error)) => {
                self.constraint_in_words(error, left)
            }
            #[cfg(feature = "contact")]
            StepFailure::Contact(error) => self.contact_in_words(error),
            #[cfg(feature = "laplacian")]
            StepFailure::Laplacian(LaplacianError::NonFinite { freedom, value }) => {
                self.warmed(*freedom).map(|vertex| {
                    format!("the temperature of `{vertex}` is {value}; it must be finite")
                })
            }
            StepFailure::Adaptive(error) => self.adaptive_named(error),
            _ => None,
        }
    }

    /// A state of positions and momenta that is not finite.
    fn adaptive_named(&self, error: &AdaptiveError) -> Option<String> {
        let AdaptiveError::NonFinite { what, t, component } = error else { return None };
        let (particle, axis) = self.particle_of(component % self.freedoms().max(1))?;
        let (t, time) = (Readable(t), &self.units.time);
        Some(format!("{what} is not finite at t = {t} {time}, first of `{particle}` in {axis}"))
    }

    /// The particle and the axis of a freedom of a scene of particles.
    fn particle_of(&self, freedom: usize) -> Option<(&str, &'static str)> {
        if !self.bodies.is_empty() || self.heat.is_some() {
            return None;
        }
        let vertices = Vertices::new(self);
        let &particle = vertices.particles.get(freedom / self.dimension)?;
        Some((&self.particles[particle].name, COORDINATES[freedom % self.dimension]))
    }

    /// The same of a search for rest with so many freedoms, in which what is hung may have been held.
    fn searched(&self, freedom: usize, freedoms: usize) -> Option<(&str, &'static str)> {
        if freedoms == self.freedoms() {
            return self.particle_of(freedom);
        }
        let mut moved = self.particles.iter().enumerate().filter(|(number, particle)| {
            matches!(particle.motion, Motion::Free { .. }) && !self.hung.contains(number)
        });
        let (_, particle) = moved.nth(freedom / self.dimension)?;
        Some((&particle.name, COORDINATES[freedom % self.dimension]))
    }

    /// What a step of bodies says in which a rotation was not found: that of the body which turns the most
    /// in it, by so many radians.
    pub(crate) fn turn_named(&self, failure: &StepFailure, turns: &[f64]) -> Option<String> {
        let StepFailure::Step(StepError::Newton(error)) = failure else { return None };
        let largest = (0..turns.len()).max_by(|&a, &b| turns[a].total_cmp(&turns[b]))?;
        let (body, turn) = (&self.bodies.get(largest)?.name, turns[largest]);
        Some(format!(
            "the implicit step was not solved: {error}; `{body}` turns the most in it, by {turn:.2} \
             radians; take a smaller step"
        ))
    }

    /// The body to which a number belongs.
    fn body_of(&self, number: usize, of: Numbers) -> Option<&str> {
        let each = match (self.dimension, of) {
            (3, Numbers::Stored) => 7,
            (3, Numbers::Freedoms) => 6,
            _ => 3,
        };
        self.bodies.get(number / each).map(|body| body.name.as_str())
    }

    /// The vertex of a freedom of heat: held ones have none.
    fn warmed(&self, freedom: usize) -> Option<&str> {
        let held = &self.heat.as_ref()?.held;
        let vertex = (0..held.len()).filter(|&vertex| !held[vertex]).nth(freedom)?;
        Some(&self.particles[vertex].name)
    }

    /// A joint, by what it joins.
    fn joint(&self, joint: &SceneJoint) -> String {
        let kind = match (joint.kind, self.dimension) {
            (JointKind::Hinge, _) => "hinge",
            (JointKind::Slider, _) => "slider",
            (JointKind::Ball, 3) => "ball joint",
            (JointKind::Ball, _) => "pin",
            (JointKind::Fixed, 3) => "fixed joint",
            (JointKind::Fixed, _) => "weld",
        };
        let [a, b] = self.ends_named(joint);
        format!("the {kind} between `{a}` and `{b}`")
    }

    /// The rod or the joint of an equation: those of joints come first, motors with a speed last.
    fn holder(&self, row: usize, left: &[usize]) -> Option<String> {
        let mut before = 0;
        let joint = self.joints.iter().find_map(|joint| {
            before += self.rows_of(joint);
            (row < before).then(|| self.joint(joint))
        });
        if joint.is_some() {
            return joint;
        }
        let row = row - before;
        if let Some(&rod) = left.get(row) {
            let [a, b] = self.rods[rod].ends.map(|end| &self.particles[end].name);
            return Some(format!("the rod from `{a}` to `{b}`"));
        }
        let drives = self.drives.motors.iter().filter(|motor| motor.drive == MotorDrive::Speed);
        let motor = drives.into_iter().nth(row - left.len())?;
        let [a, b] = self.ends_named(&self.joints[motor.joint]);
        Some(format!("the motor between `{a}` and `{b}`"))
    }

    /// Rods or joints that cannot be held.
    #[cfg(feature = "constraints")]
    fn constraint_in_words(&self, error: &ConstraintError, left: &[usize]) -> Option<String> {
        let what = crate::run::rods::equation(error).and_then(|row| self.holder(row, left));
        let what = what.as_deref();
        let velocity = self.units.velocity();
        Some(match error {
            ConstraintError::Infeasible { violation, allowed, .. } => format!(
                "{} is off by {violation:e} of its length at the start; at most {allowed:e} is rounding",
                what?
            ),
            ConstraintError::InfeasibleVelocity { rate, allowed, .. } => format!(
                "the velocities at the start are against {} by {rate:e} {velocity}; at most \
                 {allowed:e} is rounding",
                what?
            ),
            ConstraintError::Singular { ratio, .. } => format!(
                "{} and others hold the same motion, so that their forces are not determined \
                 (singular values down to {ratio:e} of the largest); leave one of them out",
                what?
            ),
            ConstraintError::Dependent { row: Some(_) } => format!(
                "{} holds what others hold already, to working precision; leave one of them out",
                what?
            ),
            ConstraintError::Dependent { row: None } => format!(
                "the {} hold the same motion more than once, to working precision; leave one of them \
                 out",
                match (self.joints.is_empty(), self.rods.is_empty()) {
                    (true, _) => "rods",
                    (false, true) => "joints",
                    (false, false) => "joints and rods",
                }
            ),
            ConstraintError::NotConverged { iterations, violation, .. } => format!(
                "{} is still off by {violation:e} of its length after {iterations} iterations; take a \
                 smaller step",
                what?
            ),
            ConstraintError::Diverged { violation, .. } => format!(
                "{} cannot be held: the iterations went away from it, which was off by \
                 {violation:e} of its length before them; take a smaller step",
                what?
            ),
            _ => return None,
        })
    }

    /// Contact that cannot be.
    #[cfg(feature = "contact")]
    fn contact_in_words(&self, error: &ContactError) -> Option<String> {
        match error {
            &ContactError::Overlap { count, first, second, depth } => {
                let [a, b] = [self.collider(first)?, self.collider(second)?];
                let more = match count {
                    0 | 1 => String::new(),
                    _ => format!("; {count} pairs overlap"),
                };
                Some(format!(
                    "{a} and {b} overlap by {depth:.2e} {} at the start{more}; what may pass through each \
                     other is a pair of [contact] with `meet = false`",
                    self.units.length
                ))
            }
            &ContactError::NonFinite { what, index, value } => {
                let of = match what {
                    "the configuration" => Numbers::Stored,
                    _ => Numbers::Freedoms,
                };
                let body = self.body_of(index, of).or_else(|| Some(self.particle_of(index)?.0));
                body.map(|name| format!("{what} of `{name}` is {value}; it must be finite"))
            }
            &ContactError::Turn { body, angle } => {
                let name = &self.bodies.get(body)?.name;
                Some(format!(
                    "`{name}` turns by up to {angle:.1e} rad in a step; take a smaller step"
                ))
            }
            ContactError::Step(error) => self.failure_named(&StepFailure::Step(error.clone()), &[]),
            _ => None,
        }
    }

    /// The body, wall or ball of a shape: those of bodies come first.
    #[cfg(feature = "contact")]
    fn collider(&self, number: usize) -> Option<String> {
        let contact = self.contact.as_ref()?;
        let colliders = |body: &crate::RigidBody| match &body.shape {
            crate::BodyShape::Moments => usize::from(body.point_mass),
            crate::BodyShape::Parts(parts) => parts.len(),
            _ => 1,
        };
        let names = self
            .bodies
            .iter()
            .flat_map(|body| std::iter::repeat_n(format!("`{}`", body.name), colliders(body)));
        // Obstacles are bodies to who detects.
        let pins = self.obstacles().map(|pin| format!("`{}`", self.particles[pin].name));
        let called = |kind: &str, name: &Option<String>, number: usize| match name {
            Some(name) => format!("`{name}`"),
            None => format!("{kind} {}", number + 1),
        };
        let walls = contact.walls.iter().enumerate().map(|(k, w)| called("wall", &w.name, k));
        let balls = contact.balls.iter().enumerate().map(|(k, b)| called("ball", &b.name, k));
        names.chain(pins).chain(walls).chain(balls).nth(number)
    }
}

/// How bodies are counted.
#[derive(Clone, Copy)]
enum Numbers {
    /// By the numbers that store a configuration.
    Stored,
    /// By freedoms.
    Freedoms,
}

fn not_finite(what: &str, body: &str) -> String {
    format!("the {what} of `{body}` is not finite")
}

#[cfg(all(test, feature = "default"))]
mod tests {
    use stationary_calculus::{NewtonError, NewtonFailure};

    use super::*;
    use crate::BodyShape;
    use crate::model::drives::Drives;
    use crate::model::items::RigidBody;
    use crate::model::particle::Particle;
    use crate::model::scene::Gravity;
    use crate::model::stepping::Stepping;
    use crate::model::timing::Timing;
    use crate::model::units::Units;

    /// A scene with nothing in it. None is read from a text here: the whole reader would be compiled once
    /// more for these tests.
    fn empty(dimension: usize) -> Scene {
        Scene {
            title: String::new(),
            dimension,
            units: Units { length: "m".into(), time: "s".into(), mass: "kg".into() },
            stepping: Stepping::LinearModes { count: 1 },
            timing: Timing::new(1.0, 1.0, 1).unwrap(),
            gravity: Gravity { acceleration: None, constant: None, fixed: Vec::new() },
            drag: None,
            frame: None,
            drives: Drives::default(),
            contact: None,
            particles: Vec::new(),
            written_out: 0,
            links: Vec::new(),
            rods: Vec::new(),
            bodies: Vec::new(),
            joints: Vec::new(),
            solids: Vec::new(),
            heat: None,
            hung: Vec::new(),
            edges: Vec::new(),
            faces: Vec::new(),
            observables: Vec::new(),
            view: [0.0; 3],
            claims: Vec::new(),
        }
    }

    /// Two bodies, `a` and `b`, and joints between them and the world.
    fn joined(dimension: usize, joints: &[(JointKind, [Option<usize>; 2])]) -> Scene {
        let body = |name: &str| RigidBody {
            name: name.into(),
            mass: 1.0,
            shape: BodyShape::Moments,
            moments: [1.0; 3],
            position: [1.0, 0.0, 0.0],
            rotation: [0.0; 3],
            velocity: [0.0; 3],
            angular_velocity: [0.0; 3],
            points: Vec::new(),
            point_mass: false,
        };
        let joint = |&(kind, between)| SceneJoint {
            kind,
            between,
            place: [0.0; 3],
            axis: [0.0, 0.0, 1.0],
            stiffness: 0.0,
            rest: 0.0,
            damping: 0.0,
            limits: None,
            friction: 0.0,
        };
        let joints = joints.iter().map(joint).collect();
        Scene { bodies: vec![body("a"), body("b")], joints, ..empty(dimension) }
    }

    #[test]
    fn an_equation_that_is_not_solved_is_told_as_its_joint() {
        use JointKind::{Ball, Fixed, Hinge};
        let (from_world, between, to_world) =
            ([None, Some(0)], [Some(0), Some(1)], [Some(1), None]);
        let in_space = [(Ball, from_world), (Hinge, between), (Fixed, to_world)];
        let in_the_plane = [(Fixed, from_world), (Ball, between)];
        let ball = "the ball joint between `world` and `a`";
        let hinge = "the hinge between `a` and `b`";
        let fixed = "the fixed joint between `b` and `world`";
        let (weld, pin) = ("the weld between `world` and `a`", "the pin between `a` and `b`");
        for (dimension, joints, rows) in [
            (
                3,
                &in_space[..],
                &[(0, ball), (2, ball), (3, hinge), (7, hinge), (8, fixed), (13, fixed)][..],
            ),
            (2, &in_the_plane, &[(0, weld), (2, weld), (3, pin), (4, pin)]),
        ] {
            let scene = joined(dimension, joints);
            for &(row, name) in rows {
                let error = ConstraintError::NotConverged { iterations: 50, row, violation: 0.5 };
                let words = scene.failure_named(&StepFailure::Constraint(error), &[]).unwrap();
                let rest =
                    "is still off by 5e-1 of its length after 50 iterations; take a smaller step";
                assert_eq!(words, format!("{name} {rest}"));
            }
        }
    }

    #[test]
    fn a_rest_that_is_not_found_is_told_with_the_particle_that_is_farthest_from_it() {
        let particles = ["a", "b", "c"].map(|name| Particle {
            name: name.into(),
            position: [0.0; 3],
            motion: Motion::Free { mass: 1.0, momentum: [0.0; 3] },
            radius: 0.0,
        });
        let scene = Scene { hung: vec![1], particles: particles.into(), ..empty(2) };
        let source = NewtonError { failure: NewtonFailure::Unbounded, history: Vec::new() };
        let error = AssemblyError::Equilibrium { freedom: 3, freedoms: 4, source };
        let words = scene.named(RunError::Assembly(error)).to_string();
        let told = "the largest acceleration left is that of `c` in y";
        assert!(words.ends_with(told), "{words}");
    }

    #[test]
    fn numbers_that_are_not_finite_are_told_with_their_body() {
        let scene = joined(3, &[]);
        let words = |failure| scene.failure_named(&failure, &[]).unwrap();
        let moved = StepError::NonFiniteConfiguration { freedom: 7 };
        assert_eq!(words(StepFailure::Step(moved)), "the position of `b` is not finite");
        let momentum = StepError::NonFiniteMomentum { freedom: 5 };
        assert_eq!(words(StepFailure::Step(momentum)), "the momentum of `a` is not finite");
        let value = f64::INFINITY;
        let contact = ContactError::NonFinite { what: "the momentum", index: 6, value };
        let told = "the momentum of `b` is inf; it must be finite";
        assert_eq!(words(StepFailure::Contact(contact)), told);
    }

    #[test]
    fn a_body_that_turns_too_far_is_told_by_its_name() {
        let failure = StepFailure::Contact(ContactError::Turn { body: 1, angle: 42.0 });
        let told = "`b` turns by up to 4.2e1 rad in a step; take a smaller step";
        assert_eq!(joined(3, &[]).failure_named(&failure, &[]).unwrap(), told);
    }
}
