//! A set of constraints is a constraint: tuples of different ones, and lists of one kind.
//!
//! ```text
//! g = (g_1, g_2, ...),    J = the rows of J_1, then those of J_2, ...
//! ```

use stationary_calculus::{Sink, SizeError};

use crate::{Constraint, ConstraintOn, Rows, Scale, check_multipliers, check_values};

/// Rows of a member, counted from where it starts in the set.
struct From<'a, R> {
    start: usize,
    rows: &'a mut R,
}

impl<R: Rows> Rows for From<'_, R> {
    #[inline]
    fn add(&mut self, row: usize, freedom: usize, value: f64) {
        self.rows.add(self.start + row, freedom, value);
    }
}

macro_rules! set_of_constraints {
    ($($name:ident . $index:tt),+) => {
        impl<S, $($name: ConstraintOn<S>),+> ConstraintOn<S> for ($($name,)+) {}

        /// Its members' equations one after another; its dimension is the largest of theirs.
        impl<$($name: Constraint),+> Constraint for ($($name,)+) {
            fn dim(&self) -> usize {
                [$(self.$index.dim()),+].into_iter().max().unwrap_or(0)
            }

            fn count(&self) -> usize {
                0 $(+ self.$index.count())+
            }

            #[inline]
            fn value(&self, t: f64, q: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
                check_values(self.count(), g)?;
                let mut rest = g;
                $(
                    let (own, others) = rest.split_at_mut(self.$index.count());
                    self.$index.value(t, q, own)?;
                    rest = others;
                )+
                let _ = rest;
                Ok(())
            }

            #[inline]
            fn differential(
                &self,
                t: f64,
                q: &[f64],
                rows: &mut impl Rows,
            ) -> Result<(), SizeError> {
                let mut start = 0;
                $(
                    self.$index.differential(t, q, &mut From { start, rows: &mut *rows })?;
                    start += self.$index.count();
                )+
                let _ = start;
                Ok(())
            }

            fn add_hessian(
                &self,
                t: f64,
                q: &[f64],
                lambda: &[f64],
                hessian: &mut impl Sink,
            ) -> Result<(), SizeError> {
                check_multipliers(self.count(), lambda)?;
                let mut rest = lambda;
                $(
                    let (own, others) = rest.split_at(self.$index.count());
                    self.$index.add_hessian(t, q, own, hessian)?;
                    rest = others;
                )+
                let _ = rest;
                Ok(())
            }

            fn rate(&self, t: f64, q: &[f64], rate: &mut [f64]) -> Result<(), SizeError> {
                check_values(self.count(), rate)?;
                let mut rest = rate;
                $(
                    let (own, others) = rest.split_at_mut(self.$index.count());
                    self.$index.rate(t, q, own)?;
                    rest = others;
                )+
                let _ = rest;
                Ok(())
            }

            fn scale(&self, row: usize) -> Scale {
                let mut row = row;
                $(
                    if row < self.$index.count() {
                        return self.$index.scale(row);
                    }
                    row -= self.$index.count();
                )+
                let _ = row;
                Scale::default()
            }
        }
    };
}

set_of_constraints!(A.0, B.1);
set_of_constraints!(A.0, B.1, C.2);
set_of_constraints!(A.0, B.1, C.2, D.3);

impl<S, K: ConstraintOn<S>> ConstraintOn<S> for Vec<K> {}

/// Its members' equations one after another; an empty list asks nothing.
impl<K: Constraint> Constraint for Vec<K> {
    fn dim(&self) -> usize {
        self.iter().map(K::dim).max().unwrap_or(0)
    }

    fn count(&self) -> usize {
        self.iter().map(K::count).sum()
    }

    fn value(&self, t: f64, q: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
        check_values(self.count(), g)?;
        let mut rest = g;
        for member in self {
            let (own, others) = rest.split_at_mut(member.count());
            member.value(t, q, own)?;
            rest = others;
        }
        Ok(())
    }

    fn differential(&self, t: f64, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        let mut start = 0;
        for member in self {
            member.differential(t, q, &mut From { start, rows: &mut *rows })?;
            start += member.count();
        }
        Ok(())
    }

    fn add_hessian(
        &self,
        t: f64,
        q: &[f64],
        lambda: &[f64],
        hessian: &mut impl Sink,
    ) -> Result<(), SizeError> {
        check_multipliers(self.count(), lambda)?;
        let mut rest = lambda;
        for member in self {
            let (own, others) = rest.split_at(member.count());
            member.add_hessian(t, q, own, hessian)?;
            rest = others;
        }
        Ok(())
    }

    fn rate(&self, t: f64, q: &[f64], rate: &mut [f64]) -> Result<(), SizeError> {
        check_values(self.count(), rate)?;
        let mut rest = rate;
        for member in self {
            let (own, others) = rest.split_at_mut(member.count());
            member.rate(t, q, own)?;
            rest = others;
        }
        Ok(())
    }

    fn scale(&self, row: usize) -> Scale {
        let mut row = row;
        for member in self {
            if row < member.count() {
                return member.scale(row);
            }
            row -= member.count();
        }
        Scale::default()
    }
}
