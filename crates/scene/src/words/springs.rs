//! The word `springs`.

use std::ops::Range;

use toml::Spanned;

use crate::text::diagnostic::Checked;
use crate::text::number::Number;
use crate::words::draft::Draft;
use crate::words::table::{Kind, table};
use crate::words::word::{ELASTICITY, Feature, Of, Word};

table! {
    /// A spring.
    pub(crate) struct SpringDeclaration = "a spring" {
        /// Two names.
        between: Spanned<Vec<Spanned<String>>> = Kind::Pair,
        /// Force over length.
        stiffness: Spanned<Number> = Kind::Positive,
        /// Its length at rest; that of the start where it is missing.
        rest_length: Option<Spanned<Number>> = Kind::Number,
        /// Of a damper along it: force over the rate of its length. None where it is missing.
        damping: Option<Spanned<Number>> = Kind::NotNegative,
        /// The measure of stretch; cauchy where it is missing.
        strain: Option<Spanned<String>> = Kind::OneOf(&["cauchy", "green"]),
    }
}

impl Word for Vec<SpringDeclaration> {
    const FEATURE: Option<Feature> = Some(ELASTICITY);
    const OF: Of = Of::Load;

    fn place(&self) -> Option<Range<usize>> {
        self.first().map(|first| first.between.span())
    }

    fn declare(&self, draft: &mut Draft<'_>) -> Checked<()> {
        #[cfg(feature = "elasticity")]
        for spring in self {
            draft.links.push(declare(&draft.particles, spring)?);
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
    use stationary_elasticity::Strain;
    use stationary_elasticity::{Spring, SpringError};

    use crate::model::items::Link;
    use crate::text::check;
    use crate::text::diagnostic::{Checked, at};
    use crate::text::fault::Fault;
    use crate::words::particle_table::ParticleTable;

    /// The strains by name.
    const STRAINS: [(&str, Strain); 2] = [("cauchy", Strain::Cauchy), ("green", Strain::Green)];

    /// The strain of this name, Cauchy's where there is none.
    pub(crate) fn strain(name: Option<&toml::Spanned<String>>) -> Checked<Strain> {
        match name {
            Some(name) => check::word("strain", name.get_ref(), name.span(), &STRAINS),
            None => Ok(Strain::default()),
        }
    }

    /// The spring that is declared; its rest length is that at the start unless it is given.
    pub(crate) fn declare(table: &ParticleTable, declared: &SpringDeclaration) -> Checked<Link> {
        let ends = table.pair("a spring", &declared.between)?;
        let stiffness = check::positive("the stiffness", &declared.stiffness)?;
        let damping = declared.damping.as_ref();
        let damping = damping.map(|given| check::not_negative("the damping", given)).transpose()?;
        let damping = damping.unwrap_or(0.0);
        let strain = strain(declared.strain.as_ref())?;
        let [x, y] = ends.map(|end| table.particles[end].position);
        let start = (0..3).map(|c| (y[c] - x[c]) * (y[c] - x[c])).sum::<f64>().sqrt();
        if !start.is_finite() {
            let fault =
                Fault::NotFinite { what: "the square of the spring's length", value: start };
            return Err(at(declared.between.span(), fault));
        }
        let (rest_length, place) = match &declared.rest_length {
            Some(length) => (check::finite("the rest length", length)?, length.span()),
            None => (start, declared.between.span()),
        };
        let same = |end: usize| table.particles[end].name.clone();
        table.check_apart(ends, &declared.between)?;
        Spring::new(ends, rest_length, stiffness, strain).map_err(|error| match error {
            SpringError::Loop(end) => at(declared.between.span(), Fault::Loop(same(end))),
            _ if declared.rest_length.is_none() => at(place.clone(), Fault::NoRestLength),
            _ => at(place.clone(), Fault::RestLength(rest_length)),
        })?;
        match (start == 0.0, strain) {
            (true, _) if declared.rest_length.is_none() => Err(at(place, Fault::NoRestLength)),
            (true, Strain::Cauchy) if rest_length > 0.0 => {
                Err(at(declared.between.span(), Fault::Spike))
            }
            _ => Ok(Link { ends, rest_length, stiffness, damping, strain }),
        }
    }
}
