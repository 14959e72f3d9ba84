//! Joints as data: what each leaves free, and the equations that follow from it.
//!
//! ```text
//! x_1 - x_2                     origins of the joint's frames that stay together     3 rows
//! <n_1, x_1 - x_2>              an origin in a plane of the other end                1
//! <a_1, b_2> - <a, b>           directions that keep their angle                     1
//! (|x_1 - x_2|^2 - L^2)/2L      origins that keep their distance                     1
//! <n_1, x_2 - x_1> - p angle    a shift in proportion to a turn                      1
//! ```
//! Each end has a frame, told in the axes of its body or of the world; a joint's axes are told in
//! the frames, which coincide where its coordinates are zero ([`JointKind`]). Full coordinates keep
//! the rows ([`Joint`]), joint coordinates move along what the rows leave ([`tree`](crate::tree)),
//! and loops of a tree are closed by the same rows.
//!
//! | joint | rows | together | in a plane | angle | other |
//! | --- | --- | --- | --- | --- | --- |
//! | weld | 6 | 3 | | 3 | |
//! | hinge | 5 | 3 | | 2 | |
//! | slider | 5 | | 2 | 3 | |
//! | screw | 5 | | 2 | 2 | shift to turn |
//! | cylinder | 4 | | 2 | 2 | |
//! | universal | 4 | 3 | | 1 | |
//! | planar | 3 | | 1 | 2 | |
//! | ball | 3 | 3 | | | |
//! | rod | 1 | | | | distance |
//! | on a line | 2 | | 2 | | |
//! | on a circle | 2 | | 1 | | distance |
//! | free | 0 | | | | |
//!
//! Source: notes 6, 9.2; Haug, Computer Aided Kinematics and Dynamics (1989), 9.4.

mod constraint;
mod end;
mod fault;
mod kind;
mod row;
mod drive;
mod coordinate;
mod bound;
mod torsion_spring;

pub use bound::{JointFriction, JointLimits};
pub use constraint::Joint;
pub use coordinate::{Drive, JointCoordinate};
pub use drive::{DrivenCoordinate, PrescribedCoordinate, Schedule, Steady};
pub use end::JointEnd;
pub use fault::{JointFault, JointName};
pub use kind::JointKind;
pub use row::Along;
pub use torsion_spring::TorsionSpring;

pub(crate) use end::{Placed, body_freedoms, pair_freedoms};
pub(crate) use kind::unit;
pub(crate) use row::{Local, Row, along, curvature, triad};
