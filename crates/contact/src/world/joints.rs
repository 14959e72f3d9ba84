//! Joints of a world's bodies: rows beside those of contacts, solved with them.
//!
//! ```text
//! J v = -dg/dt,   limits, friction        rows of the velocity over a step       (x free, x >= 0, |x| <= b)
//! J d = -g                                rows of the motion that closes joints after it
//! ```
//! `g` what joints keep at zero, `J` its differential. The world knows rows and not how joints are made:
//! any [`Constraint`] is [`Kept`], and [`JointLimits`] and [`JointFriction`] bring theirs; a list or a tuple
//! of joints is one. What turns leaves joints open by order `h^2` over a step: they are
//! closed by moving bodies, never by a velocity, as overlap is lifted, and contacts count there as well.

use stationary_constraints::{Constraint, ConstraintError, VelocityRows};
use stationary_rigid::{JointFriction, JointLimits};

/// What asks for rows beside contacts.
pub trait JointRows {
    /// Appends what is asked of the velocity in a step of `h` seconds from a configuration.
    ///
    /// # Errors
    /// Those of the rows.
    fn velocity_rows(
        &self,
        t: f64,
        q: &[f64],
        h: f64,
        rows: &mut VelocityRows,
    ) -> Result<(), ConstraintError>;

    /// Appends what closes joints by moving bodies from a configuration: equalities that ask for what
    /// is open, with its sign turned, and limits of what is left of their gaps.
    ///
    /// # Errors
    /// Those of the rows.
    fn position_rows(
        &self,
        t: f64,
        q: &[f64],
        rows: &mut VelocityRows,
    ) -> Result<(), ConstraintError>;
}

impl<J: JointRows> JointRows for &J {
    fn velocity_rows(
        &self,
        t: f64,
        q: &[f64],
        h: f64,
        rows: &mut VelocityRows,
    ) -> Result<(), ConstraintError> {
        (**self).velocity_rows(t, q, h, rows)
    }

    fn position_rows(
        &self,
        t: f64,
        q: &[f64],
        rows: &mut VelocityRows,
    ) -> Result<(), ConstraintError> {
        (**self).position_rows(t, q, rows)
    }
}

/// All of a kind.
impl<J: JointRows> JointRows for Vec<J> {
    fn velocity_rows(
        &self,
        t: f64,
        q: &[f64],
        h: f64,
        rows: &mut VelocityRows,
    ) -> Result<(), ConstraintError> {
        self.iter().try_for_each(|joint| joint.velocity_rows(t, q, h, rows))
    }

    fn position_rows(
        &self,
        t: f64,
        q: &[f64],
        rows: &mut VelocityRows,
    ) -> Result<(), ConstraintError> {
        self.iter().try_for_each(|joint| joint.position_rows(t, q, rows))
    }
}

/// No joints, or several kinds.
macro_rules! several {
    ($($name:ident)*) => {
        #[allow(non_snake_case, unused_variables)]
        impl<$($name: JointRows),*> JointRows for ($($name,)*) {
            fn velocity_rows(
                &self,
                t: f64,
                q: &[f64],
                h: f64,
                rows: &mut VelocityRows,
            ) -> Result<(), ConstraintError> {
                let ($($name,)*) = self;
                $($name.velocity_rows(t, q, h, rows)?;)*
                Ok(())
            }

            fn position_rows(
                &self,
                t: f64,
                q: &[f64],
                rows: &mut VelocityRows,
            ) -> Result<(), ConstraintError> {
                let ($($name,)*) = self;
                $($name.position_rows(t, q, rows)?;)*
                Ok(())
            }
        }
    };
}

several!();
several!(A B);
several!(A B C);

impl<C: Constraint> JointRows for JointLimits<C> {
    fn velocity_rows(
        &self,
        _: f64,
        q: &[f64],
        h: f64,
        rows: &mut VelocityRows,
    ) -> Result<(), ConstraintError> {
        self.push_rows(q, h, rows)
    }

    fn position_rows(
        &self,
        _: f64,
        q: &[f64],
        rows: &mut VelocityRows,
    ) -> Result<(), ConstraintError> {
        self.push_rows(q, 1.0, rows)
    }
}

impl<C: Constraint> JointRows for JointFriction<C> {
    fn velocity_rows(
        &self,
        _: f64,
        q: &[f64],
        h: f64,
        rows: &mut VelocityRows,
    ) -> Result<(), ConstraintError> {
        self.push_rows(q, h, rows)
    }

    /// Friction moves nothing.
    fn position_rows(
        &self,
        _: f64,
        _: &[f64],
        _: &mut VelocityRows,
    ) -> Result<(), ConstraintError> {
        Ok(())
    }
}

/// Joints that are kept: the equations of a constraint.
#[derive(Clone, Debug)]
pub struct Kept<K>(pub K);

impl<K: Constraint> JointRows for Kept<K> {
    fn velocity_rows(
        &self,
        t: f64,
        q: &[f64],
        _h: f64,
        rows: &mut VelocityRows,
    ) -> Result<(), ConstraintError> {
        rows.push_constraint(&self.0, t, q)
    }

    fn position_rows(
        &self,
        t: f64,
        q: &[f64],
        rows: &mut VelocityRows,
    ) -> Result<(), ConstraintError> {
        rows.push_closing(&self.0, t, q)
    }
}
