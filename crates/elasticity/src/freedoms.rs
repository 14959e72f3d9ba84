//! Which coordinates move, and where the others are held: Dirichlet data.
//!
//! ```text
//! vertex a, component c   ->   freedom i of n            free
//!                         ->   its place (m)             held
//! ```
//! Free coordinates are numbered vertex by vertex, so that a vertex that is wholly free has D
//! freedoms in a row. A held coordinate costs no freedom; it may be moved between steps. Solids,
//! masses, loads and statics share one numbering, cloned from one another: its tables are shared,
//! its places are not.

use std::sync::Arc;

use stationary_calculus::{FIXED, array};

use crate::ElasticityError;

/// A coordinate that does not move freely.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// The vertex.
    pub vertex: usize,
    /// Which of its coordinates.
    pub component: usize,
    /// Where that coordinate is, m.
    pub place: f64,
}

/// The free and the held coordinates of some vertices in `D` dimensions.
#[derive(Clone, Debug, PartialEq)]
pub struct Freedoms<const D: usize> {
    free: usize,
    numbering: Arc<Numbering<D>>,
    /// The places of the held coordinates, in their order.
    places: Vec<f64>,
}

#[derive(Debug, PartialEq)]
struct Numbering<const D: usize> {
    /// The first freedom of each vertex that is wholly free; `free` and its place in `mixed` after.
    starts: Vec<u32>,
    /// The coordinates of the other vertices.
    mixed: Vec<[Coordinate; D]>,
    /// The vertex and component of each held coordinate.
    held: Vec<(usize, usize)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Coordinate {
    Free(u32),
    Held(u32),
}

impl<const D: usize> Freedoms<D> {
    /// Vertices of which some coordinates are held.
    ///
    /// # Errors
    /// [`ElasticityError::Held`] for a coordinate that does not exist, is held twice or at a place
    /// that is not finite; [`ElasticityError::TooMany`] for more vertices than 32-bit indices can
    /// tell apart.
    pub fn new(vertices: usize, held: &[Held]) -> Result<Self, ElasticityError> {
        if vertices >= u32::MAX as usize / (2 * D) {
            return Err(ElasticityError::TooMany { vertices });
        }
        let mut holding = vec![[None; D]; vertices];
        let mut places = Vec::with_capacity(held.len());
        for &Held { vertex, component, place } in held {
            let known = vertex < vertices && component < D && place.is_finite();
            if !known || holding[vertex][component].is_some() {
                return Err(ElasticityError::Held { vertex, component, place });
            }
            holding[vertex][component] = Some(places.len() as u32);
            places.push(place);
        }
        let held = held.iter().map(|held| (held.vertex, held.component)).collect();
        let (free, starts, mixed) = number(&holding);
        Ok(Freedoms { free, numbering: Arc::new(Numbering { starts, mixed, held }), places })
    }

    /// The vertices of a mesh, of which those coordinates are held where they are that `holds` says
    /// yes to, by the vertex' place and the component.
    ///
    /// # Errors
    /// [`ElasticityError::Held`] for places that are not finite, and [`ElasticityError::TooMany`].
    pub fn held_where(
        places: &[[f64; D]],
        holds: impl Fn(&[f64; D], usize) -> bool,
    ) -> Result<Self, ElasticityError> {
        let mut held = Vec::new();
        for (vertex, x) in places.iter().enumerate() {
            let components = (0..D).filter(|&component| holds(x, component));
            let at = |component: usize| Held { vertex, component, place: x[component] };
            held.extend(components.map(at));
        }
        Freedoms::new(places.len(), &held)
    }

    /// Vertices that are all free.
    ///
    /// # Errors
    /// [`ElasticityError::TooMany`] for more vertices than 32-bit indices can tell apart.
    pub fn free(vertices: usize) -> Result<Self, ElasticityError> {
        Freedoms::new(vertices, &[])
    }

    /// The number of freedoms n.
    pub fn dim(&self) -> usize {
        self.free
    }

    /// The number of vertices.
    pub fn vertices(&self) -> usize {
        self.numbering.starts.len()
    }

    /// Vertex and component of each held coordinate, in the order in which they were given.
    pub fn held(&self) -> &[(usize, usize)] {
        &self.numbering.held
    }

    /// The places of the held coordinates, m.
    pub fn places(&self) -> &[f64] {
        &self.places
    }

    /// Moves the held coordinates, all of them, in their order.
    ///
    /// # Errors
    /// [`ElasticityError::HeldPlaces`] for another number of places; [`ElasticityError::Held`] for
    /// the first one that is not finite. All are then where they were.
    pub fn hold_at(&mut self, places: &[f64]) -> Result<(), ElasticityError> {
        let (expected, got) = (self.places.len(), places.len());
        if expected != got {
            return Err(ElasticityError::HeldPlaces { expected, got });
        }
        if let Some(k) = places.iter().position(|place| !place.is_finite()) {
            let (vertex, component) = self.numbering.held[k];
            return Err(ElasticityError::Held { vertex, component, place: places[k] });
        }
        self.places.copy_from_slice(places);
        Ok(())
    }

    /// Whether the same coordinates are held, in the same order: whether what is numbered by one fits
    /// the other.
    pub fn is_numbered_as(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.numbering, &other.numbering) || self.numbering == other.numbering
    }

    /// The same numbering, of velocities: those of held coordinates are zero.
    pub(crate) fn resting(&self) -> Self {
        Freedoms { places: vec![0.0; self.places.len()], ..self.clone() }
    }

    /// The freedoms of a vertex; [`FIXED`] where it is held.
    ///
    /// # Panics
    /// Where there is no such vertex, as an index does.
    pub fn of(&self, vertex: usize) -> [usize; D] {
        self.freedoms(self.numbering.starts[vertex])
    }

    /// The free coordinates out of all of them.
    ///
    /// # Errors
    /// [`ElasticityError::Vertices`] for another number of positions.
    pub fn gathered(&self, positions: &[[f64; D]]) -> Result<Vec<f64>, ElasticityError> {
        self.check_vertices(positions.len())?;
        let mut q = vec![0.0; self.free];
        for (vertex, position) in positions.iter().enumerate() {
            for (freedom, x) in self.of(vertex).into_iter().zip(position) {
                if freedom != FIXED {
                    q[freedom] = *x;
                }
            }
        }
        Ok(q)
    }

    /// All coordinates of all vertices, from the free ones.
    ///
    /// # Errors
    /// [`ElasticityError::Freedoms`] unless `q` has a number for each freedom.
    pub fn positions(&self, q: &[f64]) -> Result<Vec<[f64; D]>, ElasticityError> {
        self.check(q.len())?;
        Ok(self.numbering.starts.iter().map(|&start| self.position(start, q)).collect())
    }

    pub(crate) fn check(&self, got: usize) -> Result<(), ElasticityError> {
        let expected = self.free;
        if expected == got { Ok(()) } else { Err(ElasticityError::Freedoms { expected, got }) }
    }

    pub(crate) fn check_vertices(&self, got: usize) -> Result<(), ElasticityError> {
        let expected = self.vertices();
        if expected == got { Ok(()) } else { Err(ElasticityError::Vertices { expected, got }) }
    }

    /// What stands for a vertex in the tables of elements.
    #[inline]
    pub(crate) fn start(&self, vertex: usize) -> u32 {
        self.numbering.starts[vertex]
    }

    /// The position of a vertex, by what stands for it.
    #[inline(always)]
    pub(crate) fn position(&self, start: u32, q: &[f64]) -> [f64; D] {
        let start = start as usize;
        match q.get(start..start + D) {
            Some(position) => array(|c| position[c]),
            None => self.mixed_position(start, q),
        }
    }

    #[cold]
    fn mixed_position(&self, start: usize, q: &[f64]) -> [f64; D] {
        self.numbering.mixed[start - self.free].map(|coordinate| match coordinate {
            Coordinate::Free(freedom) => q[freedom as usize],
            Coordinate::Held(place) => self.places[place as usize],
        })
    }

    /// Adds to the free components of a covector.
    #[inline(always)]
    pub(crate) fn add(&self, start: u32, part: &[f64; D], dv: &mut [f64]) {
        let start = start as usize;
        match dv.get_mut(start..start + D) {
            Some(sum) => {
                for c in 0..D {
                    sum[c] += part[c];
                }
            }
            None => self.add_mixed(start, part, dv),
        }
    }

    #[cold]
    fn add_mixed(&self, start: usize, part: &[f64; D], dv: &mut [f64]) {
        for (coordinate, part) in self.numbering.mixed[start - self.free].iter().zip(part) {
            if let Coordinate::Free(freedom) = coordinate {
                dv[*freedom as usize] += part;
            }
        }
    }

    /// Adds to those free components of which `dv`, from the freedom `first` on, holds the sums.
    #[inline(always)]
    pub(crate) fn add_within(&self, start: u32, part: &[f64; D], first: usize, dv: &mut [f64]) {
        let from = (start as usize).wrapping_sub(first);
        match dv.get_mut(from..from.wrapping_add(D)) {
            Some(sum) => {
                for c in 0..D {
                    sum[c] += part[c];
                }
            }
            None => self.add_mixed_within(start as usize, part, first, dv),
        }
    }

    #[cold]
    fn add_mixed_within(&self, start: usize, part: &[f64; D], first: usize, dv: &mut [f64]) {
        // A vertex of another part has no place among the mixed ones.
        let mixed = start.checked_sub(self.free).map(|mixed| &self.numbering.mixed[mixed]);
        for (coordinate, part) in mixed.into_iter().flatten().zip(part) {
            if let Coordinate::Free(freedom) = coordinate
                && let Some(sum) = dv.get_mut((*freedom as usize).wrapping_sub(first))
            {
                *sum += part;
            }
        }
    }

    /// Adds to the held components, in their order.
    #[inline]
    pub(crate) fn add_held(&self, start: u32, part: &[f64; D], held: &mut [f64]) {
        let Some(mixed) = (start as usize).checked_sub(self.free) else { return };
        for (coordinate, part) in self.numbering.mixed[mixed].iter().zip(part) {
            if let Coordinate::Held(place) = coordinate {
                held[*place as usize] += part;
            }
        }
    }

    /// The freedoms of a vertex, by what stands for it.
    #[inline(always)]
    pub(crate) fn freedoms(&self, start: u32) -> [usize; D] {
        let start = start as usize;
        if start < self.free {
            array(|c| start + c)
        } else {
            let coordinates = &self.numbering.mixed[start - self.free];
            array(|c| match coordinates[c] {
                Coordinate::Free(freedom) => freedom as usize,
                Coordinate::Held(_) => FIXED,
            })
        }
    }
}

/// The number of freedoms, and what stands for each vertex.
fn number<const D: usize>(holding: &[[Option<u32>; D]]) -> (usize, Vec<u32>, Vec<[Coordinate; D]>) {
    let free = holding.as_flattened().iter().filter(|held| held.is_none()).count();
    let (mut next, mut mixed) = (0, Vec::new());
    let starts = holding.iter().map(|held| {
        let first = next;
        let coordinates = held.map(|held| match held {
            Some(place) => Coordinate::Held(place),
            None => {
                next += 1;
                Coordinate::Free(next - 1)
            }
        });
        if held.iter().all(Option::is_none) {
            return first;
        }
        mixed.push(coordinates);
        (free + mixed.len() - 1) as u32
    });
    let starts = starts.collect();
    (free, starts, mixed)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn held(vertex: usize, component: usize, place: f64) -> Held {
        Held { vertex, component, place }
    }

    #[test]
    fn free_coordinates_are_numbered_and_held_ones_stay() {
        let mut freedoms = Freedoms::<2>::new(3, &[held(1, 0, 7.0), held(2, 1, -1.0)]).unwrap();
        assert_eq!(freedoms.dim(), 4);
        assert_eq!([0, 1, 2].map(|v| freedoms.of(v)), [[0, 1], [FIXED, 2], [3, FIXED]]);
        let q = [1.0, 2.0, 3.0, 4.0];
        let positions = freedoms.positions(&q).unwrap();
        assert_eq!(positions, [[1.0, 2.0], [7.0, 3.0], [4.0, -1.0]]);
        assert_eq!(freedoms.gathered(&positions).unwrap(), q);
        freedoms.hold_at(&[8.0, 9.0]).unwrap();
        assert_eq!(freedoms.positions(&q).unwrap()[2], [4.0, 9.0]);
        let mut dv = [0.0; 4];
        for vertex in 0..3 {
            freedoms.add(freedoms.start(vertex), &[10.0, 20.0], &mut dv);
        }
        assert_eq!(dv, [10.0, 20.0, 20.0, 10.0]);
    }

    #[test]
    fn coordinates_that_cannot_be_held_are_refused() {
        for bad in [held(3, 0, 0.0), held(0, 2, 0.0), held(0, 0, f64::NAN)] {
            let error = Freedoms::<2>::new(3, &[bad]).unwrap_err();
            assert!(matches!(error, ElasticityError::Held { .. }), "{error}");
        }
        let twice = Freedoms::<2>::new(3, &[held(1, 1, 0.0), held(1, 1, 0.0)]).unwrap_err();
        assert_eq!(twice, ElasticityError::Held { vertex: 1, component: 1, place: 0.0 });
        let mut freedoms = Freedoms::<2>::new(3, &[held(1, 1, 5.0)]).unwrap();
        assert!(freedoms.hold_at(&[]).is_err() && freedoms.hold_at(&[f64::NAN]).is_err());
        assert_eq!(freedoms.places(), [5.0]);
        assert!(freedoms.positions(&[0.0]).is_err() && freedoms.gathered(&[[0.0; 2]]).is_err());
    }

    #[test]
    fn more_vertices_than_indices_can_tell_apart_are_refused() {
        for vertices in [u32::MAX as usize / 6, usize::MAX] {
            let error = Freedoms::<3>::new(vertices, &[]).unwrap_err();
            assert_eq!(error, ElasticityError::TooMany { vertices });
        }
    }
}
