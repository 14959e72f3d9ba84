//! What things that touch give each other, summed from one sample to the next.
//!
//! ```text
//! J = sum J_i,   x = sum |J_i| x_i / sum |J_i|,   n along sum |J_i| n_i     over all impulses i
//! ```
//! between the same two since the sample before: a row for each two, so that a run of many steps
//! keeps no more than its samples do. `J` is what the second is given and the first loses (mass times
//! velocity, world axes), friction included; what does not move stands first. The sum of all `J` on a
//! body is what contact changed its momentum by.

use crate::model::contact_side::ContactSide;
use crate::model::items::SceneContact;
use crate::model::scene::Scene;
use crate::text::limits;

impl ContactSide {
    /// Its name; walls and balls that have none are counted from 1.
    pub fn name(self, scene: &Scene) -> String {
        let contact = scene.contact.as_ref();
        match self {
            ContactSide::Wall(wall) => {
                let own = contact.and_then(|contact| contact.walls.get(wall)?.name.clone());
                own.unwrap_or_else(|| format!("wall {}", wall + 1))
            }
            ContactSide::Ball(ball) => {
                let own = contact.and_then(|contact| contact.balls.get(ball)?.name.clone());
                own.unwrap_or_else(|| format!("ball {}", ball + 1))
            }
            ContactSide::Body(body) => scene.bodies()[body].name.clone(),
            ContactSide::Pin(particle) | ContactSide::Particle(particle) => {
                scene.particles()[particle].name.clone()
            }
        }
    }

    /// Whether the scene has it.
    pub(crate) fn is_in(self, scene: &Scene) -> bool {
        let of_contact =
            |count: fn(&SceneContact) -> usize| scene.contact.as_ref().map_or(0, count);
        let (place, count) = match self {
            ContactSide::Wall(place) => (place, of_contact(|contact| contact.walls.len())),
            ContactSide::Ball(place) => (place, of_contact(|contact| contact.balls.len())),
            ContactSide::Body(place) => (place, scene.bodies.len()),
            ContactSide::Pin(place) | ContactSide::Particle(place) => {
                (place, scene.particles.len())
            }
        };
        place < count
    }
}

/// The impulses between two things since the sample before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactImpulse {
    /// The sample at the end of the interval.
    pub sample: usize,
    /// The two.
    pub between: [ContactSide; 2],
    /// The last moment at which there was an impulse.
    pub last: f64,
    /// Where: the mean of the points, each counted by the size of its impulse.
    pub point: [f64; 3],
    /// The mean normal from the first to the second, counted alike; of length one where it is the
    /// same for all of them.
    pub normal: [f64; 3],
    /// What the second was given.
    pub impulse: [f64; 3],
    /// The sum of the sizes of the impulses.
    pub magnitude: f64,
}

/// An impulse that a step gives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Push {
    pub(crate) between: [ContactSide; 2],
    pub(crate) time: f64,
    pub(crate) point: [f64; 3],
    /// From the first to the second.
    pub(crate) normal: [f64; 3],
    /// On the second.
    pub(crate) impulse: [f64; 3],
}

impl Push {
    /// The same, with what does not move first, or else what the scene has first.
    fn in_order(self) -> Self {
        let [a, b] = self.between;
        if (a.moves(), a) <= (b.moves(), b) {
            return self;
        }
        let turned = |x: [f64; 3]| x.map(|x| -x);
        let (normal, impulse) = (turned(self.normal), turned(self.impulse));
        Push { between: [b, a], normal, impulse, ..self }
    }
}

impl ContactImpulse {
    /// Whether it is between things of the scene.
    pub(crate) fn fits(&self, scene: &Scene) -> bool {
        self.between.iter().all(|side| side.is_in(scene))
    }

    fn add(&mut self, push: &Push, size: f64) {
        self.last = push.time;
        self.magnitude += size;
        let share = size / self.magnitude;
        for c in 0..3 {
            self.point[c] += share * (push.point[c] - self.point[c]);
            self.normal[c] += share * (push.normal[c] - self.normal[c]);
            self.impulse[c] += push.impulse[c];
        }
    }

    /// The mean normal with length one; zero where normals cancel.
    pub(crate) fn direction(&self) -> [f64; 3] {
        let length = norm(self.normal);
        if length > 0.0 { self.normal.map(|x| x / length) } else { self.normal }
    }
}

fn norm(x: [f64; 3]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Rows of contact impulses, in the order of the samples.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ContactRows {
    pub(crate) rows: Vec<ContactImpulse>,
    /// The first sample of which there are no rows any more, where there would be too many.
    pub(crate) end: Option<usize>,
}

impl ContactRows {
    /// Adds an impulse to those of the interval that ends with a sample. Those that are kept end
    /// before an interval of which there would be too many.
    pub(crate) fn push(&mut self, sample: usize, push: Push) {
        let (push, size) = (push.in_order(), norm(push.impulse));
        if self.end.is_some() || size == 0.0 {
            return;
        }
        // The rows of this interval are the last ones.
        let first = self.rows.partition_point(|row| row.sample < sample);
        let open = &self.rows[first..];
        match open.binary_search_by_key(&push.between, |row| row.between) {
            Ok(place) => self.rows[first + place].add(&push, size),
            Err(_) if self.rows.len() >= limits::CONTACT_ROWS => {
                self.rows.truncate(first);
                self.end = Some(sample);
            }
            Err(place) => {
                let Push { between, time: last, point, normal, impulse } = push;
                let row = ContactImpulse {
                    sample,
                    between,
                    last,
                    point,
                    normal,
                    impulse,
                    magnitude: size,
                };
                self.rows.insert(first + place, row);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn push(between: [ContactSide; 2], impulse: [f64; 3]) -> Push {
        Push { between, time: 0.5, point: [impulse[1]; 3], normal: [0.0, 1.0, 0.0], impulse }
    }

    #[test]
    fn what_does_not_move_stands_first_and_impulses_turn_with_it() {
        let (body, wall) = (ContactSide::Body(3), ContactSide::Wall(1));
        let mut rows = ContactRows::default();
        rows.push(0, push([body, wall], [0.0, -1.0, 0.0]));
        rows.push(0, push([wall, body], [0.0, 3.0, 0.5]));
        let [row] = rows.rows[..] else { panic!("{:?}", rows.rows) };
        assert_eq!((row.between, row.impulse), ([wall, body], [0.0, 4.0, 0.5]));
        assert_eq!(row.magnitude, 1.0 + 9.25_f64.sqrt());
    }

    #[test]
    fn the_rows_of_an_interval_are_in_the_order_of_the_two_and_begin_anew_with_the_next() {
        let [a, b, c] = [0, 1, 2].map(ContactSide::Particle);
        let mut rows = ContactRows::default();
        for between in [[b, c], [a, b], [b, c]] {
            rows.push(0, push(between, [1.0, 0.0, 0.0]));
        }
        rows.push(1, push([a, c], [1.0, 0.0, 0.0]));
        let told: Vec<_> = rows.rows.iter().map(|r| (r.sample, r.between)).collect();
        assert_eq!(told, [(0, [a, b]), (0, [b, c]), (1, [a, c])]);
        assert_eq!(rows.rows[1].impulse, [2.0, 0.0, 0.0]);
    }

    #[test]
    fn rows_end_with_a_whole_interval_where_there_would_be_too_many() {
        let [a, b, c] = [0, 1, 2].map(ContactSide::Particle);
        let mut rows = ContactRows::default();
        rows.push(0, push([a, b], [1.0, 0.0, 0.0]));
        rows.rows = vec![rows.rows[0]; limits::CONTACT_ROWS - 1];
        rows.push(1, push([a, b], [1.0, 0.0, 0.0]));
        assert_eq!(rows.end, None);
        rows.push(1, push([a, c], [1.0, 0.0, 0.0]));
        rows.push(1, push([b, c], [1.0, 0.0, 0.0]));
        assert_eq!(rows.end, Some(1));
        assert_eq!(rows.rows.len(), limits::CONTACT_ROWS - 1);
    }
}
