//! What a method leaves behind, to go on from later.
//!
//! With the feature `serde` it saves and loads, as does [`State`](crate::State). Numbers are
//! written as text, the shortest that reads back to the same bits, because readers of some formats
//! round.

use crate::StepError;

/// Everything on which the next steps of a method depend: `save` makes it, `load` takes it back.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Saved {
    /// The name of the method.
    pub method: String,
    /// Its numbers, in the method's order.
    #[cfg_attr(feature = "serde", serde(with = "text"))]
    pub numbers: Vec<f64>,
}

impl Saved {
    /// An error unless it was saved by the method of this name, which remembers nothing.
    ///
    /// # Errors
    /// Another method's name, or numbers.
    pub fn check_empty(&self, method: &str) -> Result<(), StepError> {
        if self.method != method {
            return Err(StepError::Saved("it is another method's"));
        }
        match self.numbers.is_empty() {
            true => Ok(()),
            false => Err(StepError::Saved("it has numbers, of which the method has none")),
        }
    }
}

#[cfg(feature = "serde")]
pub(crate) mod text {
    use serde::{Deserialize, Deserializer, Serializer, de::Error};

    pub(crate) fn serialize<S: Serializer>(numbers: &[f64], s: S) -> Result<S::Ok, S::Error> {
        s.collect_seq(numbers.iter().map(f64::to_string))
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(d: D) -> Result<Vec<f64>, D::Error> {
        let words = Vec::<String>::deserialize(d)?;
        words.iter().map(|word| word.parse().map_err(D::Error::custom)).collect()
    }
}

#[cfg(feature = "serde")]
mod state {
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};
    use stationary_calculus::{Covector, Storage};

    use crate::State;

    #[derive(Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Written {
        #[serde(with = "super::text")]
        t: Vec<f64>,
        #[serde(with = "super::text")]
        q: Vec<f64>,
        #[serde(with = "super::text")]
        p: Vec<f64>,
    }

    impl<C: Storage> Serialize for State<C> {
        fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
            let [q, p] = [&self.q, &self.p.0].map(|numbers| numbers.as_ref().to_vec());
            Written { t: vec![self.t], q, p }.serialize(s)
        }
    }

    impl<'de, C: Storage> Deserialize<'de> for State<C> {
        fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
            let Written { t, q, p } = Written::deserialize(d)?;
            let [t] = t[..] else { return Err(D::Error::invalid_length(t.len(), &"one time")) };
            let stored = |numbers: Vec<f64>| {
                let mut c = C::zeros(numbers.len()).ok_or_else(|| {
                    D::Error::invalid_length(numbers.len(), &"the size of the storage")
                })?;
                c.as_mut().copy_from_slice(&numbers);
                Ok(c)
            };
            Ok(State { t, q: stored(q)?, p: Covector(stored(p)?) })
        }
    }
}
