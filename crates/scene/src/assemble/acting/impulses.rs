//! The impulses of a step, told apart by what gives them.

/// What acts gives in a step: impulses on freedoms, those of each thing after one another.
#[derive(Clone, Debug, Default)]
pub(crate) struct Impulses {
    pub(super) dim: usize,
    pub(super) entries: Vec<(usize, f64)>,
    /// Where those of each thing end.
    pub(super) ends: Vec<usize>,
}

impl Impulses {
    pub(crate) fn clear(&mut self) {
        self.entries.clear();
        self.ends.clear();
    }

    pub(crate) fn dim(&self) -> usize {
        self.dim
    }

    pub(crate) fn entries(&self) -> &[(usize, f64)] {
        &self.entries
    }

    /// The work of each thing along a velocity.
    pub(crate) fn works<'a>(
        &'a self,
        velocity: impl Fn(usize) -> f64 + 'a,
    ) -> impl Iterator<Item = f64> + 'a {
        let starts = [0].into_iter().chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(move |(start, &end)| {
            self.entries[start..end].iter().map(|&(f, impulse)| impulse * velocity(f)).sum()
        })
    }
}
