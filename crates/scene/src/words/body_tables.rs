//! Tables of shapes that bodies and their parts share.

use toml::Spanned;

use crate::text::number::{Components, Number};
use crate::text::turn::Turn;
use crate::words::table::{Kind, table};

table! {
    /// A length along an axis and a radius about it.
    pub(crate) struct LongDeclaration = "a table with `length` and `radius`" {
        /// Of a cylinder from end to end, of a capsule that of its straight part.
        length: Spanned<Number> = Kind::Positive,
        /// How far it reaches from its axis.
        radius: Spanned<Number> = Kind::Positive,
    }

    /// A cone.
    pub(crate) struct ConeDeclaration = "a table with `height` and `radius`" {
        /// From the base to the apex.
        height: Spanned<Number> = Kind::Positive,
        /// The radius of the base.
        radius: Spanned<Number> = Kind::Positive,
    }
}

/// A table with the shapes that a body and a part may have, between its own keys.
macro_rules! shaped_table {
    (
        $(#[doc = $says:literal])*
        pub(crate) struct $name:ident = $expecting:literal { $($first:tt)* } { $($last:tt)* }
    ) => {
        $crate::words::table::table! {
            $(#[doc = $says])*
            pub(crate) struct $name = $expecting {
                $($first)*
                /// The sides of a solid box.
                sides as "box": Option<Components> = Kind::Vector,
                /// The radius of a solid ball; in the plane a disc.
                ball: Option<Spanned<Number>> = Kind::Positive,
                /// The corners of a plate in the plane.
                polygon: Option<Spanned<Vec<Components>>> = Kind::List(&Kind::Vector),
                /// A solid capsule along the third axis, in the plane a plate along the first.
                capsule: Option<LongDeclaration> = Kind::Table(&LongDeclaration::TABLE),
                /// A solid cylinder about the third axis, in space.
                cylinder: Option<LongDeclaration> = Kind::Table(&LongDeclaration::TABLE),
                /// A solid cone about the third axis, in space; its centre of mass is a quarter of the height above the base.
                cone: Option<ConeDeclaration> = Kind::Table(&ConeDeclaration::TABLE),
                /// The half axes of a solid ellipsoid, in space.
                ellipsoid: Option<Components> = Kind::Vector,
                /// Points in space of which it is the solid convex hull.
                hull: Option<Spanned<Vec<Components>>> = Kind::List(&Kind::Vector),
                $($last)*
            }
        }

        #[cfg(feature = "rigid")]
        impl $name {
            /// What it says of its shape, but for moments.
            pub(crate) fn shape(&self) -> $crate::words::body_shape::ShapeWords<'_> {
                $crate::words::body_shape::ShapeWords {
                    sides: self.sides.as_ref(),
                    ball: self.ball.as_ref(),
                    polygon: self.polygon.as_ref(),
                    capsule: self.capsule.as_ref(),
                    cylinder: self.cylinder.as_ref(),
                    cone: self.cone.as_ref(),
                    ellipsoid: self.ellipsoid.as_ref(),
                    hull: self.hull.as_ref(),
                    moments: None,
                }
            }
        }
    };
}
pub(crate) use shaped_table;

shaped_table! {
    /// A shape that is part of a body. Where parts overlap there is the mass of both.
    pub(crate) struct PartDeclaration = "a part with its `mass` and a shape" {
        /// Its mass.
        mass: Spanned<Number> = Kind::Positive,
    } {
        /// Where its centre of mass is, as the body is drawn; a polygon and a hull may go without.
        at: Option<Components> = Kind::Vector,
        /// How it is turned there: axis times angle; in the plane an angle.
        rotation: Option<Turn> = Kind::Turn,
    }
}
