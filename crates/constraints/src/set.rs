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

            fn describe(&self, row: usize) -> Option<String> {
                let mut row = row;
                $(
                    if row < self.$index.count() {
                        return self.$index.describe(row);
                    }
                    row -= self.$index.count();
                )+
                let _ = row;
                None
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

    /// The member's name, with the equation's number in it and the member's in the list.
    fn describe(&self, row: usize) -> Option<String> {
        let mut row = row;
        for (member, constraint) in self.iter().enumerate() {
            if row < constraint.count() {
                let name = constraint.describe(row)?;
                return Some(format!("equation {row} of constraint {member}, {name}"));
            }
            row -= constraint.count();
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FixedPoint, Pairing, Rod, Rods};
    use stationary_calculus::assert_derivatives;

    /// A member of its own time and length: `g = L (q_k - u t)`, bent by `q_k^2`.
    #[derive(Clone, Debug)]
    struct Moving {
        freedom: usize,
        speed: f64,
    }

    impl<S> ConstraintOn<S> for Moving {}

    impl Constraint for Moving {
        fn dim(&self) -> usize {
            self.freedom + 1
        }

        fn count(&self) -> usize {
            2
        }

        fn value(&self, t: f64, q: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
            check_values(2, g)?;
            let x = q[self.freedom];
            (g[0], g[1]) = (x - self.speed * t, x * x);
            Ok(())
        }

        fn differential(&self, _: f64, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
            rows.add(0, self.freedom, 1.0);
            rows.add(1, self.freedom, 2.0 * q[self.freedom]);
            Ok(())
        }

        fn add_hessian(
            &self,
            _: f64,
            _: &[f64],
            lambda: &[f64],
            hessian: &mut impl Sink,
        ) -> Result<(), SizeError> {
            hessian.add_symmetric(&[self.freedom], &[2.0 * lambda[1]]);
            Ok(())
        }

        fn rate(&self, _: f64, _: &[f64], rate: &mut [f64]) -> Result<(), SizeError> {
            (rate[0], rate[1]) = (-self.speed, 0.0);
            Ok(())
        }

        fn scale(&self, row: usize) -> Scale {
            Scale { slope: self.speed + row as f64, ..Scale::default() }
        }
    }

    const Q: [f64; 4] = [0.3, -0.5, 0.9, 1.4];

    /// Values, rates and scales of each row.
    fn rows(set: &impl Constraint) -> Vec<[f64; 3]> {
        let (mut g, mut rate) = (vec![0.0; set.count()], vec![0.0; set.count()]);
        set.value(0.5, &Q, &mut g).unwrap();
        set.rate(0.5, &Q, &mut rate).unwrap();
        (0..set.count()).map(|row| [g[row], rate[row], set.scale(row).slope]).collect()
    }

    #[test]
    fn a_list_has_the_equations_of_its_members_one_after_another() {
        let members = [(1, 2.0), (3, 5.0), (0, 7.0)];
        let list: Vec<Moving> = members.map(|(freedom, speed)| Moving { freedom, speed }).to_vec();
        let tuple = (list[0].clone(), list[1].clone(), list[2].clone());
        assert_eq!((list.dim(), list.count()), (4, 6));
        let expected: Vec<[f64; 3]> = members
            .into_iter()
            .flat_map(|(freedom, speed)| {
                let x = Q[freedom];
                [[x - 0.5 * speed, -speed, speed], [x * x, 0.0, speed + 1.0]]
            })
            .collect();
        assert_eq!(rows(&list), expected);
        assert_eq!(rows(&tuple), expected);
        let multipliers = vec![0.7, -1.3, 2.0, 0.4, -0.9, 1.1];
        assert_derivatives(&Pairing::new(list, multipliers.clone(), 0.5).unwrap(), &Q);
        assert_derivatives(&Pairing::new(tuple, multipliers, 0.5).unwrap(), &Q);
    }

    #[test]
    fn members_of_different_kinds_stand_side_by_side() {
        let rods = Rods::new(2, vec![[0.0; 2]], vec![Rod::new([2, 0], 1.0), Rod::new([0, 1], 2.0)]);
        let set = (rods.unwrap(), FixedPoint::new(1, [1.0, 2.0]).unwrap());
        let pairing = Pairing::new(set, vec![0.7, -1.3, 2.0, 0.4], 0.0).unwrap();
        assert_derivatives(&pairing, &Q);
    }
}
