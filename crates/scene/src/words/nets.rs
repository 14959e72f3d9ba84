//! Nets: rows and columns of particles, joined by springs along the sides and across every cell.
//!
//! ```text
//! vertex (row, column)  =  origin + spacing (column across + row down)
//! ```
//! `across` and `down` are unit vectors at a right angle; by default the first axis, and against
//! the last. The springs are those of [`stationary_elasticity::net`], at rest at the start.

use std::ops::Range;

use toml::Spanned;

use crate::text::diagnostic::Checked;
use crate::text::number::{Components, Count, Number};
use crate::words::draft::Draft;
use crate::words::table::{Kind, table};
use crate::words::word::{ELASTICITY, Feature, Of, Word};

table! {
    /// A net; its vertices are called name.row.column, from 0.
    pub(crate) struct NetDeclaration = "a net" {
        /// A name.
        name: Spanned<String> = Kind::Name,
        /// How many rows.
        rows: Spanned<Count> = Kind::Count(2),
        /// How many columns.
        columns: Spanned<Count> = Kind::Count(2),
        /// The side of a cell.
        spacing: Spanned<Number> = Kind::Positive,
        /// Where row 0 and column 0 meet.
        origin: Components = Kind::Vector,
        /// The direction along a row; the first axis where it is missing.
        across: Option<Components> = Kind::Vector,
        /// The direction down a column; against the last axis where it is missing.
        down: Option<Components> = Kind::Vector,
        /// The mass of each vertex.
        particle_mass: Spanned<Number> = Kind::Positive,
        /// The stiffness of each spring.
        stiffness: Spanned<Number> = Kind::Positive,
        /// The measure of stretch; cauchy where it is missing.
        strain: Option<Spanned<String>> = Kind::OneOf(&["cauchy", "green"]),
        /// Corners and sides that stay.
        pinned: Option<Spanned<Vec<Spanned<String>>>> = Kind::List(&Kind::OneOf(&["top-left", "top-right", "bottom-left", "bottom-right", "top", "bottom", "left", "right"])),
    }
}

impl Word for Vec<NetDeclaration> {
    const FEATURE: Option<Feature> = Some(ELASTICITY);
    const OF: Of = Of::Particles;

    fn place(&self) -> Option<Range<usize>> {
        self.first().map(|first| first.name.span())
    }

    fn declare(&self, draft: &mut Draft<'_>) -> Checked<()> {
        #[cfg(feature = "elasticity")]
        for net in self {
            declare(&mut draft.particles, &mut draft.links, draft.dimension, net)?;
        }
        #[cfg(not(feature = "elasticity"))]
        let _ = draft;
        Ok(())
    }
}

#[cfg(feature = "elasticity")]
pub(crate) use compiled::*;

/// What is compiled with the crate that the word is about.
#[cfg(feature = "elasticity")]
mod compiled {
    use super::*;
    use std::ops::Range;

    use stationary_calculus::Stencil;
    use stationary_elasticity::{Net, net};

    use crate::model::items::Link;
    use crate::model::particle::{Motion, Particle};
    use crate::text::diagnostic::{Checked, at};
    use crate::text::fault::Fault;
    use crate::text::number::Count;
    use crate::text::{check, limits};
    use crate::words::particle_table::ParticleTable;
    use crate::words::springs::strain;

    /// Which vertices of a net are pinned.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    enum Pin {
        Corner { bottom: Side, right: Side },
        Row(Side),
        Column(Side),
    }

    /// One of two opposite sides.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    enum Side {
        First,
        Last,
    }

    const PINS: [(&str, Pin); 8] = [
        ("top-left", Pin::Corner { bottom: Side::First, right: Side::First }),
        ("top-right", Pin::Corner { bottom: Side::First, right: Side::Last }),
        ("bottom-left", Pin::Corner { bottom: Side::Last, right: Side::First }),
        ("bottom-right", Pin::Corner { bottom: Side::Last, right: Side::Last }),
        ("top", Pin::Row(Side::First)),
        ("bottom", Pin::Row(Side::Last)),
        ("left", Pin::Column(Side::First)),
        ("right", Pin::Column(Side::Last)),
    ];

    impl Side {
        fn holds(self, index: usize, count: usize) -> bool {
            match self {
                Side::First => index == 0,
                Side::Last => index + 1 == count,
            }
        }
    }

    impl Pin {
        fn holds(self, [row, column]: [usize; 2], [rows, columns]: [usize; 2]) -> bool {
            match self {
                Pin::Corner { bottom, right } => {
                    bottom.holds(row, rows) && right.holds(column, columns)
                }
                Pin::Row(side) => side.holds(row, rows),
                Pin::Column(side) => side.holds(column, columns),
            }
        }
    }

    /// Adds the net's particles to the table and its springs to the links.
    pub(crate) fn declare(
        table: &mut ParticleTable,
        links: &mut Vec<Link>,
        dimension: usize,
        declared: &NetDeclaration,
    ) -> Checked<()> {
        let name = check::name(&declared.name)?;
        if dimension < 2 {
            return Err(at(declared.name.span(), Fault::NetDimension));
        }
        let [rows, columns] = size(table, declared)?;
        let spacing = check::positive("the spacing", &declared.spacing)?;
        let mass = check::positive("the mass", &declared.particle_mass)?;
        let stiffness = check::positive("the stiffness", &declared.stiffness)?;
        let strain = strain(declared.strain.as_ref())?;
        let origin = check::vector("the origin", dimension, &declared.origin)?;
        let [across, down] = directions(dimension, declared)?;
        let pins = pins(declared)?;

        let first = table.particles.len();
        for row in 0..rows {
            for column in 0..columns {
                let position: [f64; 3] = std::array::from_fn(|c| {
                    origin[c] + spacing * (column as f64 * across[c] + row as f64 * down[c])
                });
                if let Some(&value) = position.iter().find(|x| !x.is_finite()) {
                    let fault = Fault::NotFinite { what: "the far corner of the net", value };
                    return Err(at(declared.spacing.span(), fault));
                }
                let pin = pins.iter().find(|(pin, _)| pin.holds([row, column], [rows, columns]));
                let motion = match pin {
                    Some(_) => Motion::Pinned,
                    None => Motion::Free { mass, momentum: [0.0; 3] },
                };
                let vertex = Particle {
                    name: format!("{name}.{row}.{column}"),
                    position,
                    motion,
                    radius: 0.0,
                };
                let Some(index) = table.add(vertex, declared.origin.span()) else {
                    return Err(at(declared.name.span(), Fault::DuplicateNet(name)));
                };
                if let (Some((_, place)), None) = (pin, &table.first_pin) {
                    table.first_pin = Some((index, place.clone()));
                }
            }
        }

        let springs = net(Net { rows, columns, spacing, stiffness, strain }).map_err(|error| {
            at(declared.spacing.span(), Fault::Syntax { message: error.to_string() })
        })?;
        links.extend(springs.iter().map(|spring| Link {
            damping: 0.0,
            ends: Stencil::<2, 3>::vertices(spring).map(|vertex| first + vertex),
            rest_length: spring.rest_length(),
            stiffness,
            strain,
        }));
        Ok(())
    }

    /// The net's rows and columns, bounded so that their particles may be made.
    fn size(table: &ParticleTable, declared: &NetDeclaration) -> Checked<[usize; 2]> {
        let [rows, columns] =
            [("`rows`", &declared.rows), ("`columns`", &declared.columns)].map(|(what, count)| {
                match *count.get_ref() {
                    Count(got) if got >= 2 => Ok(got),
                    Count(got) => Err(at(count.span(), Fault::NetSize { what, got })),
                }
            });
        let (rows, columns) = (rows?, columns?);
        let count = rows.saturating_mul(columns).saturating_add(table.particles.len() as u64);
        if count > limits::PARTICLES {
            let fault = Fault::TooMany { what: "particles", count, limit: limits::PARTICLES };
            return Err(at(declared.rows.span(), fault));
        }
        Ok([rows as usize, columns as usize])
    }

    /// The unit vectors along a row and down a column.
    fn directions(dimension: usize, declared: &NetDeclaration) -> Checked<[[f64; 3]; 2]> {
        let mut down = [0.0; 3];
        down[dimension - 1] = -1.0;
        check::right_angle(
            dimension,
            declared.origin.span(),
            [("`across`", &declared.across, [1.0, 0.0, 0.0]), ("`down`", &declared.down, down)],
        )
    }

    /// The pins, each with its place.
    fn pins(declared: &NetDeclaration) -> Checked<Vec<(Pin, Range<usize>)>> {
        let words = declared.pinned.iter().flat_map(|pinned| pinned.get_ref());
        words
            .map(|word| {
                let pin = check::word("corner or side", word.get_ref(), word.span(), &PINS)?;
                Ok((pin, word.span()))
            })
            .collect()
    }
}
