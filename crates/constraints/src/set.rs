//! A set of constraints is a constraint: tuples of different ones, and lists of one kind.
//!
//! ```text
//! g = (g_1, g_2, ...),    J = the rows of J_1, then those of J_2, ...
//! ```

use stationary_calculus::Sink;

use crate::{Constraint, ConstraintOn, Rows, Scale};

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

/// What of a list of numbers, one for each equation, is a member's, and the rest; a list that is too
/// short leaves the last members with fewer.
fn split<T>(numbers: &[T], count: usize) -> (&[T], &[T]) {
    numbers.split_at(count.min(numbers.len()))
}

/// The same of numbers to write.
fn split_mut<T>(numbers: &mut [T], count: usize) -> (&mut [T], &mut [T]) {
    numbers.split_at_mut(count.min(numbers.len()))
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
            fn value(&self, t: f64, q: &[f64], g: &mut [f64]) {
                let mut rest = g;
                $(
                    let (own, others) = split_mut(rest, self.$index.count());
                    self.$index.value(t, q, own);
                    rest = others;
                )+
                let _ = rest;
            }

            #[inline]
            fn differential(&self, t: f64, q: &[f64], rows: &mut impl Rows) {
                let mut start = 0;
                $(
                    self.$index.differential(t, q, &mut From { start, rows: &mut *rows });
                    start += self.$index.count();
                )+
                let _ = start;
            }

            fn add_hessian(&self, t: f64, q: &[f64], lambda: &[f64], hessian: &mut impl Sink) {
                let mut rest = lambda;
                $(
                    let (own, others) = split(rest, self.$index.count());
                    self.$index.add_hessian(t, q, own, hessian);
                    rest = others;
                )+
                let _ = rest;
            }

            fn rate(&self, t: f64, q: &[f64], rate: &mut [f64]) {
                let mut rest = rate;
                $(
                    let (own, others) = split_mut(rest, self.$index.count());
                    self.$index.rate(t, q, own);
                    rest = others;
                )+
                let _ = rest;
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

    fn value(&self, t: f64, q: &[f64], g: &mut [f64]) {
        let mut rest = g;
        for member in self {
            let (own, others) = split_mut(rest, member.count());
            member.value(t, q, own);
            rest = others;
        }
    }

    fn differential(&self, t: f64, q: &[f64], rows: &mut impl Rows) {
        let mut start = 0;
        for member in self {
            member.differential(t, q, &mut From { start, rows: &mut *rows });
            start += member.count();
        }
    }

    fn add_hessian(&self, t: f64, q: &[f64], lambda: &[f64], hessian: &mut impl Sink) {
        let mut rest = lambda;
        for member in self {
            let (own, others) = split(rest, member.count());
            member.add_hessian(t, q, own, hessian);
            rest = others;
        }
    }

    fn rate(&self, t: f64, q: &[f64], rate: &mut [f64]) {
        let mut rest = rate;
        for member in self {
            let (own, others) = split_mut(rest, member.count());
            member.rate(t, q, own);
            rest = others;
        }
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
