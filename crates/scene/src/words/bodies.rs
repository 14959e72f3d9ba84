//! Rigid bodies, with the points of them that are followed.
//!
//! ```text
//! x = position + R c,    R = exp(rotation)          a point c of the body (body axes)
//! ```
//! Body axes are principal axes. In the plane a body turns about the third axis: its rotation and
//! angular velocity are numbers there. Angular velocities are in body axes. A body's centre and its
//! points are particles of the scene that follow it: `name`, `name.0`, `name.1`, ...
//!
//! A hull and parts are written in any axes. What the text says of such a body (its rotation, angular
//! velocity, points) is of those; what is kept is of the principal ones, which are the same where the
//! inertia is diagonal in them.

#[cfg(feature = "rigid")]
use crate::words::body_shape::ShapeWords;
#[cfg(feature = "rigid")]
use crate::words::draft::DeclaredBody;
#[cfg(feature = "rigid")]
use stationary_calculus::array;
use std::ops::Range;

use toml::Spanned;

use crate::text::diagnostic::Checked;
use crate::text::number::{Components, Number};
use crate::text::turn::Turn;
use crate::words::body_tables::{ConeDeclaration, LongDeclaration, PartDeclaration, shaped_table};
use crate::words::draft::Draft;
use crate::words::table::Kind;
use crate::words::word::{Feature, Of, RIGID, Word};

shaped_table! {
    /// A rigid body: of one shape, of several parts, or of given moments. Its points are called name.0,
    /// name.1 and so on, after the corners of its shape.
    pub(crate) struct BodyDeclaration = "a body" {
        /// A name.
        name: Spanned<String> = Kind::Name,
        /// Its mass; of a body of parts theirs together, and not said again.
        mass: Option<Spanned<Number>> = Kind::Positive,
    } {
        /// Shapes that are one body.
        parts: Option<Spanned<Vec<PartDeclaration>>> = Kind::List(&Kind::Table(&PartDeclaration::TABLE)),
        /// The principal moments of inertia; one in the plane.
        moments: Option<Turn> = Kind::Turn,
        /// Points that are followed and drawn, in body axes.
        points: Option<Vec<Components>> = Kind::List(&Kind::Vector),
        /// Where its centre of mass starts; a polygon, a hull and parts may go without, and stay where they are drawn.
        position: Option<Components> = Kind::Vector,
        /// How it is turned at the start: axis times angle; in the plane an angle.
        rotation: Option<Turn> = Kind::Turn,
        /// The velocity of its centre; where it is missing, what its joints determine, else
        /// zero.
        velocity: Option<Components> = Kind::Vector,
        /// Its angular velocity, in space in body axes; where it is missing, zero, or what its joints determine.
        angular_velocity: Option<Turn> = Kind::Turn,
    }
}

impl Word for Vec<BodyDeclaration> {
    const FEATURE: Option<Feature> = Some(RIGID);
    const OF: Of = Of::Bodies;

    fn place(&self) -> Option<Range<usize>> {
        self.first().map(|first| first.name.span())
    }

    fn declare(&self, draft: &mut Draft<'_>) -> Checked<()> {
        #[cfg(feature = "rigid")]
        {
            let (bodies, edges) = declare(&mut draft.particles, draft.dimension, self)?;
            (draft.bodies, draft.solids.edges) = (bodies, edges);
        }
        #[cfg(not(feature = "rigid"))]
        let _ = draft;
        Ok(())
    }
}

impl BodyDeclaration {
    /// Where the text places the body.
    pub(crate) fn place(&self) -> Range<usize> {
        self.position.as_ref().map_or(self.name.span(), |position| position.span())
    }
}

#[cfg(feature = "rigid")]
pub(crate) use compiled::*;

/// What is compiled with the crate that the word is about.
#[cfg(feature = "rigid")]
mod compiled {
    use super::*;
    use stationary_rigid::{Body, LieGroup, Rotation};

    use crate::model::items::RigidBody;
    use crate::model::particle::{Motion, Particle};
    use crate::text::diagnostic::{Checked, at};
    use crate::text::fault::{BodyFault, Fault};
    use crate::text::turn::Turn;
    use crate::text::{check, limits};
    use crate::words::body_shape::Shaped;
    use crate::words::particle_table::ParticleTable;
    use crate::words::{body_parts, body_shape};

    /// Which of a body's points are joined in the picture.
    type Edges = Vec<[usize; 2]>;

    /// Adds bodies to the table, centres first; and the edges between their points.
    pub(crate) fn declare(
        table: &mut ParticleTable,
        dimension: usize,
        all: &[BodyDeclaration],
    ) -> Checked<(Vec<DeclaredBody>, Edges)> {
        let mut bodies = Vec::new();
        for declared in all {
            if dimension < 2 {
                return Err(at(declared.name.span(), BodyFault::BodyDimension));
            }
            let body = body(dimension, declared)?;
            let name = body.body.name.clone();
            if name == WORLD {
                return Err(at(declared.name.span(), BodyFault::WorldName));
            }
            let motion = Motion::Carried { body: bodies.len(), point: [0.0; 3] };
            let (position, radius) = (body.body.position, body.body.shape.radius());
            let particle = Particle { name: name.clone(), position, motion, radius };
            if table.add(particle, declared.place()).is_none() {
                return Err(at(declared.name.span(), BodyFault::DuplicateBody(name)));
            }
            bodies.push(body);
        }
        let mut edges = Vec::new();
        for (index, (declared, body)) in all.iter().zip(&bodies).enumerate() {
            let first = table.particles.len();
            let count = (first + body.body.points.len()) as u64;
            if count > limits::PARTICLES {
                let fault = Fault::TooMany { what: "particles", count, limit: limits::PARTICLES };
                return Err(at(declared.name.span(), fault));
            }
            for (number, &point) in body.body.points.iter().enumerate() {
                let name = format!("{}.{number}", body.body.name);
                let motion = Motion::Carried { body: index, point };
                let particle =
                    Particle { name, position: body.body.place(point), motion, radius: 0.0 };
                if let Some(&value) = particle.position.iter().find(|x| !x.is_finite()) {
                    let fault = Fault::NotFinite { what: "a point of the body", value };
                    return Err(at(declared.place(), fault));
                }
                // A name with a dot is given to points of bodies alone, and bodies differ.
                table.add(particle, declared.place());
            }
            let joined = edges_of(&body.body, dimension);
            edges.extend(joined.into_iter().map(|ends| ends.map(|end| first + end)));
        }
        Ok((bodies, edges))
    }

    /// What a joint calls the frame in which nothing moves.
    pub(crate) const WORLD: &str = "world";

    impl RigidBody {
        /// The rotation at the start.
        pub(crate) fn turned(&self) -> Rotation {
            Rotation::exp(self.rotation.into())
        }

        /// A direction of the world in the body's axes at the start.
        pub(crate) fn in_axes(&self, direction: [f64; 3]) -> [f64; 3] {
            self.turned().rotate_back(&direction.into()).into()
        }

        /// Where a point of the body is at the start.
        pub(crate) fn place(&self, point: [f64; 3]) -> [f64; 3] {
            let arm = self.turned().rotate(&point.into());
            array(|c| self.position[c] + arm[c])
        }
    }

    fn body(dimension: usize, declared: &BodyDeclaration) -> Checked<DeclaredBody> {
        let name = check::name(&declared.name)?;
        let (mass, Shaped { shape, moments, centre, axes, .. }) = shaped(dimension, declared)?;
        let position = match (&declared.position, centre) {
            (Some(position), _) => check::vector("the position", dimension, position)?,
            (None, Some(centre)) => centre,
            (None, None) => return Err(at(declared.name.span(), BodyFault::NoPosition(name))),
        };
        let turn = |what, given: &Option<Turn>| match given {
            Some(given) => given.components(what, dimension),
            None => Ok([0.0; 3]),
        };
        let mut rotation = turn("the rotation", &declared.rotation)?;
        let mut angular_velocity = turn("the angular velocity", &declared.angular_velocity)?;
        let velocity = match &declared.velocity {
            Some(velocity) => check::vector("the velocity", dimension, velocity)?,
            None => [0.0; 3],
        };
        let mut points = shape.corners(dimension);
        for point in declared.points.iter().flatten() {
            let point = check::vector("a point", dimension, point)?;
            points.push(axes.rotate_back(&point.into()).into());
        }
        if axes != Rotation::identity() {
            rotation = Rotation::exp(rotation.into()).compose(&axes).log().into();
            angular_velocity = axes.rotate_back(&angular_velocity.into()).into();
        }
        let has_velocity = declared.velocity.is_some();
        let has_spin = declared.angular_velocity.is_some();
        let body = RigidBody {
            name,
            mass,
            shape,
            moments,
            position,
            rotation,
            velocity,
            angular_velocity,
            points,
            point_mass: false,
        };
        Ok(DeclaredBody { body, has_velocity, has_spin })
    }

    /// The mass, the shape and the moments that a body can have.
    fn shaped(dimension: usize, declared: &BodyDeclaration) -> Checked<(f64, Shaped)> {
        let name = || declared.name.get_ref().clone();
        let words = ShapeWords { moments: declared.moments.as_ref(), ..declared.shape() };
        let (mass, shaped) = match (&declared.parts, &declared.mass) {
            (Some(_), Some(mass)) => return Err(at(mass.span(), BodyFault::MassOfParts)),
            (Some(_), None) if words.any() => {
                return Err(at(declared.name.span(), BodyFault::BodyShape(name())));
            }
            (Some(parts), None) => body_parts::declare(dimension, parts)?,
            (None, None) => return Err(at(declared.name.span(), Fault::NoMass(name()))),
            (None, Some(mass)) => {
                let mass = check::positive("the mass", mass)?;
                let shaped = body_shape::declare(dimension, mass, words)?;
                let none = || at(declared.name.span(), BodyFault::BodyShape(name()));
                (mass, shaped.ok_or_else(none)?)
            }
        };
        if dimension == 2 {
            let value = shaped.moments[2];
            let fault = Fault::NotFinite { what: "the moment", value };
            let sound = value > 0.0 && value.is_finite();
            let moments = [0.0, 0.0, value];
            return if sound {
                Ok((mass, Shaped { moments, ..shaped }))
            } else {
                Err(at(shaped.place, fault))
            };
        }
        match Body::new(mass, shaped.moments) {
            Ok(_) => Ok((mass, shaped)),
            Err(error) => Err(at(shaped.place, BodyFault::Body(error.to_string()))),
        }
    }

    /// The edges of the shape; other points are joined in their order.
    fn edges_of(body: &RigidBody, dimension: usize) -> Edges {
        let corners = body.shape.corners(dimension).len();
        let others = (corners..body.points.len()).skip(1).map(|point| [point - 1, point]);
        body.shape.edges(dimension).into_iter().chain(others).collect()
    }
}
