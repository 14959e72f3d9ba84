//! What a choice was found to be over its whole way, and what else of it is off.

use crate::ladder::At;
use crate::look::Look;
use crate::measured::distance;

/// What a choice was found to be over its whole way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// At how many moments it was looked at.
    pub moments: usize,
    /// Every so manieth step was looked at.
    pub every: usize,
    /// Into so many steps; nothing where into all of them.
    pub steps: Option<usize>,
    /// Its error in the observable.
    pub error: f64,
    /// How far its energy is off, relative to the largest kinetic energy.
    pub energy: Option<f64>,
    /// How far its places are off, relative to the largest way of one.
    pub places: Option<f64>,
    /// The thing whose place is off the most.
    pub place: Option<PlaceOff>,
    /// How far a run of another kind is from the reference, and which; nothing where there is none.
    pub other: Option<(At, f64)>,
}

impl Seen {
    /// The same, and what was seen in another look.
    pub(crate) fn and(self, other: Seen) -> Seen {
        let larger = |a: Option<f64>, b: Option<f64>| a.zip(b).map(|(a, b)| a.max(b));
        Seen {
            moments: self.moments + other.moments,
            error: self.error.max(other.error),
            energy: larger(self.energy, other.energy),
            places: larger(self.places, other.places),
            place: if other.places > self.places { other.place } else { self.place },
            ..self
        }
    }
}

/// A thing whose place is off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaceOff {
    /// Which of the things that are looked at.
    pub thing: usize,
    /// By how much.
    pub off: f64,
    /// How far it truly goes from its start.
    pub way: f64,
}

/// The largest distance of a coordinate from where it should be, relative to the largest way of one, and of so
/// many things the one that is off the most; nothing where there are no places.
pub(crate) fn off_places(
    own: &Look,
    truth: &Look,
    things: usize,
) -> Option<(f64, Option<PlaceOff>)> {
    let (first, wanted) = (own.places.first()?, truth.places.first()?);
    if first.is_empty() || first.len() != wanted.len() {
        return None;
    }
    let rows = || own.places.iter().zip(&truth.places);
    let largest =
        |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
    let off = rows().map(|(own, truth)| largest(own, truth)).fold(0.0, f64::max);
    let way = rows().map(|(_, truth)| largest(truth, wanted)).fold(f64::MIN_POSITIVE, f64::max);
    let each = first.len().checked_div(things).filter(|each| each * things == first.len());
    let of = |thing: usize, each: usize| {
        let part = thing * each..(thing + 1) * each;
        let off = rows().map(|(own, truth)| distance(&own[part.clone()], &truth[part.clone()]));
        let way = rows().map(|(_, truth)| distance(&truth[part.clone()], &wanted[part.clone()]));
        PlaceOff { thing, off: off.fold(0.0, f64::max), way: way.fold(0.0, f64::max) }
    };
    let all = each.into_iter().flat_map(|each| (0..things).map(move |thing| of(thing, each)));
    Some((off / way, all.max_by(|a, b| a.off.total_cmp(&b.off))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::Samples;

    #[test]
    fn of_two_points_the_one_that_is_off_the_most_is_told_with_its_own_way() {
        let look = |rows: &[[f64; 4]]| {
            let mut samples = Samples::default();
            rows.iter().for_each(|places| samples.push(&[0.0], None, places));
            Look::of(&samples, 0)
        };
        let truth = look(&[[0.0; 4], [3.0, 4.0, 0.3, 0.0]]);
        let own = look(&[[0.0; 4], [3.0, 4.1, 0.0, 0.4]]);
        let (off, place) = off_places(&own, &truth, 2).unwrap();
        assert!((off - 0.1).abs() < 1e-12, "{off}");
        let PlaceOff { thing, off, way } = place.unwrap();
        assert!(thing == 1 && (off - 0.5).abs() < 1e-12 && (way - 0.3).abs() < 1e-12);
        // Names that do not fit name nothing.
        assert_eq!(off_places(&own, &truth, 3).unwrap().1, None);
        assert!(off_places(&look(&[[0.0; 4]]), &Look::of(&Samples::default(), 0), 2).is_none());
    }
}
