//! The word `chains`: particles joined one to the next by rods, on the line between two others.
//!
//! ```text
//! x_k = x_a + k/n (x_b - x_a),    k = 1 ... n-1          n `links`, rods of length |x_b - x_a|/n
//! ```
//! Its particles are called `name.1` to `name.n-1`; they move at the start as the line does between
//! the velocities of its ends.

use stationary_calculus::array;
use std::ops::Range;

use toml::Spanned;

use crate::model::items::Rod;
use crate::model::particle::{Motion, Particle};
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::text::number::{Count, Number};
use crate::text::{check, limits};
use crate::words::draft::Draft;
use crate::words::table::{Kind, table};
use crate::words::word::{CONSTRAINTS, Feature, Of, Word};

table! {
    /// Particles joined by rods, on the line between two others.
    pub(crate) struct ChainDeclaration = "a chain" {
        /// Its name; its particles are called `name.1`, `name.2` and so on.
        name: Spanned<String> = Kind::Name,
        /// The particles at its ends, written out.
        between: Spanned<Vec<Spanned<String>>> = Kind::Pair,
        /// How many rods it has; it has one particle fewer.
        links: Spanned<Count> = Kind::Count(1),
        /// The mass of each of its particles.
        particle_mass: Spanned<Number> = Kind::Positive,
    }
}

impl Word for Vec<ChainDeclaration> {
    const FEATURE: Option<Feature> = Some(CONSTRAINTS);
    const OF: Of = Of::Load;

    fn place(&self) -> Option<Range<usize>> {
        self.first().map(|first| first.name.span())
    }

    fn declare(&self, draft: &mut Draft<'_>) -> Checked<()> {
        self.iter().try_for_each(|chain| declare(draft, chain))
    }
}

fn declare(draft: &mut Draft<'_>, declared: &ChainDeclaration) -> Checked<()> {
    let name = check::name(&declared.name)?;
    let mass = check::positive("the mass", &declared.particle_mass)?;
    let table = &mut draft.particles;
    let ends = table.pair("a chain", &declared.between)?;
    let links = links(table.particles.len(), &declared.links)?;
    let [x, y] = ends.map(|end| table.particles[end].position);
    let [u, v] = ends.map(|end| velocity(&table.particles[end].motion));
    let between = |a: [f64; 3], b: [f64; 3], part: f64| -> [f64; 3] {
        array(|c| a[c] + part * (b[c] - a[c]))
    };
    let mut last = ends[0];
    for link in 1..=links {
        let part = link as f64 / links as f64;
        let next = if link == links {
            ends[1]
        } else {
            let momentum = between(u, v, part).map(|v| mass * v);
            let particle = Particle {
                name: format!("{name}.{link}"),
                position: between(x, y, part),
                motion: Motion::Free { mass, momentum },
                radius: 0.0,
            };
            let added = table.add(particle, declared.between.span());
            added.ok_or_else(|| at(declared.name.span(), Fault::DuplicateName(name.clone())))?
        };
        let [a, b] = [last, next].map(|end| table.particles[end].position);
        let length = (0..3).map(|c| (b[c] - a[c]) * (b[c] - a[c])).sum::<f64>().sqrt();
        if !(length > 0.0 && length.is_finite()) {
            return Err(at(declared.between.span(), Fault::RodLength(length)));
        }
        draft.rods.push(Rod { ends: [last, next], length, strength: f64::INFINITY });
        last = next;
    }
    Ok(())
}

/// The number of links, so that their particles may be made.
fn links(particles: usize, declared: &Spanned<Count>) -> Checked<u64> {
    let Count(links) = *declared.get_ref();
    let count = links.saturating_add(particles as u64);
    if links == 0 {
        let fault = Fault::NotPositive { what: "`links`", value: 0.0 };
        return Err(at(declared.span(), fault));
    }
    if count > limits::PARTICLES {
        let fault = Fault::TooMany { what: "particles", count, limit: limits::PARTICLES };
        return Err(at(declared.span(), fault));
    }
    Ok(links)
}

fn velocity(motion: &Motion) -> [f64; 3] {
    match *motion {
        Motion::Free { mass, momentum } => momentum.map(|p| p / mass),
        Motion::Pinned | Motion::Carried { .. } => [0.0; 3],
    }
}
