//! The words for units in headings. They change no number: a scene may state its data in any
//! units that fit together.

use serde::Serialize;

/// What lengths, times and masses are called.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Units {
    /// The unit of length, such as `m`.
    pub length: String,
    /// The unit of time, such as `s`.
    pub time: String,
    /// The unit of mass, such as `kg`.
    pub mass: String,
}

impl Units {
    /// Length over time.
    pub fn velocity(&self) -> String {
        format!("{}/{}", self.length, self.time)
    }

    /// Mass times length over time.
    pub fn momentum(&self) -> String {
        format!("{} {}/{}", self.mass, self.length, self.time)
    }

    /// Mass times length over time squared.
    pub fn force(&self) -> String {
        format!("{} {}/{}^2", self.mass, self.length, self.time)
    }

    /// Force over area.
    pub fn stress(&self) -> String {
        format!("{}/({} {}^2)", self.mass, self.length, self.time)
    }

    /// Mass times length squared over time.
    pub fn angular_momentum(&self) -> String {
        format!("{} {}^2/{}", self.mass, self.length, self.time)
    }

    /// Mass times length squared over time squared.
    pub fn energy(&self) -> String {
        format!("{} {}^2/{}^2", self.mass, self.length, self.time)
    }
}
