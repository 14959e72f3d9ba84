//! How contacts are taken to grip, until it is known which of them do.
//!
//! ```text
//! x = a - u/e                         holds
//! x_n = a_n - u_n/e,   x_t = 0        supports
//! x = 0                               lets go
//! ```
//! `a` impulses (N s), `u` rates (m/s), `e` a small compliance, 1/kg. What holds and would pull lets go, and what would
//! rub beyond its reach only supports; what has let go and closes supports. The sets that push are found within a few
//! turns. Source: Hintermueller, Ito and Kunisch 2003.

use crate::solve::friction::square_across;
use crate::solve::rigid_contact::RigidContact;
use stationary_calculus::array;

/// How a contact is taken to grip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Grip {
    /// It pushes and sticks.
    Holds,
    /// It pushes, and does not rub: what others hold.
    Supports,
    /// It does nothing.
    LetsGo,
}

impl Grip {
    /// What a contact answers, whatever it takes.
    pub(crate) fn answer<const F: usize, const D: usize>(
        self,
        contact: &RigidContact<F, D>,
        a: &[f64; D],
        rates: [f64; D],
        firm: f64,
    ) -> [f64; D] {
        let stiffness = self.stiffness(contact, firm);
        let along = |k: usize| a[k] - rates[k] * stiffness[k][k];
        match self {
            Grip::Holds => array(along),
            Grip::Supports => array(|k| if k == 0 { along(0) } else { 0.0 }),
            Grip::LetsGo => [0.0; D],
        }
    }

    /// How stiffly it answers.
    pub(crate) fn stiffness<const F: usize, const D: usize>(
        self,
        contact: &RigidContact<F, D>,
        firm: f64,
    ) -> [[f64; D]; D] {
        let mass = &contact.compliance;
        let mut stiff = [[0.0; D]; D];
        if self == Grip::Holds {
            stiff.iter_mut().enumerate().for_each(|(k, row)| row[k] = firm * mass.across_mass);
        }
        if self != Grip::LetsGo {
            stiff[0][0] = firm * mass.normal_mass;
        }
        stiff
    }

    /// How a contact grips next that answered so to a normal rate.
    pub(crate) fn next<const D: usize>(self, x: &[f64; D], rate: f64, friction: f64) -> Self {
        let reach = friction * x[0];
        match self {
            Grip::LetsGo if rate < 0.0 => Grip::Supports,
            Grip::LetsGo => Grip::LetsGo,
            _ if x[0] <= 0.0 => Grip::LetsGo,
            Grip::Holds if square_across(x) > reach * reach => Grip::Supports,
            other => other,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_pulls_lets_go_what_slides_only_supports_and_what_closes_supports_again() {
        let friction = 0.5;
        let next = |grip: Grip, x: [f64; 3], rate| grip.next(&x, rate, friction);
        for grip in [Grip::Holds, Grip::Supports] {
            assert_eq!(next(grip, [-1.0, 0.0, 0.0], 0.1), Grip::LetsGo);
            assert_eq!(next(grip, [1.0, 0.3, 0.3], -0.1), grip);
        }
        assert_eq!(next(Grip::Holds, [1.0, 0.4, 0.4], 0.0), Grip::Supports);
        assert_eq!(next(Grip::LetsGo, [0.0; 3], -0.1), Grip::Supports);
        assert_eq!(next(Grip::LetsGo, [0.0; 3], 0.1), Grip::LetsGo);
    }
}
