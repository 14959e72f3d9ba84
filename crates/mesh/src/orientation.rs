//! Do neighbours agree on which side is which, and can they be made to?
//!
//! ```text
//! two simplices agree where they see their shared facet with opposite signs
//! ```
//! A mesh that is not oriented can be, one component after the other, each after its first
//! simplex; or it cannot, like a Moebius strip. Elements that fill their space (triangles in the
//! plane, tetrahedra) have a sign of their own, and are made positive.

use crate::facets::{named, refuse_more_than_two};
use crate::measure::measure;
use crate::mesh::Mesh;
use crate::simplex::Simplex;
use crate::{MeshError, Places};

impl<const D: usize, const K: usize> Mesh<D, K>
where
    [usize; K]: Simplex,
{
    /// An error that lists the facets whose two simplices are oriented against each other.
    ///
    /// # Errors
    /// [`MeshError::Inconsistent`], and [`MeshError::NonManifold`].
    pub fn check_oriented(&self) -> Result<(), MeshError> {
        let uses = self.facet_uses();
        refuse_more_than_two(&uses)?;
        let against = uses
            .chunk_by(|a, b| a.facet == b.facet)
            .filter(|shared| shared.len() == 2 && shared[0].even == shared[1].even)
            .map(|shared| named(shared[0].facet));
        Places::refuse(against.collect(), MeshError::Inconsistent)
    }

    /// The mesh with simplices turned over until neighbours agree. Simplices that fill their space
    /// are made positive; otherwise each component follows its first simplex.
    ///
    /// # Errors
    /// [`MeshError::Degenerate`] for simplices that fill their space and have no sign, else
    /// [`MeshError::NonManifold`] and [`MeshError::NotOrientable`].
    pub fn oriented(&self) -> Result<Self, MeshError> {
        let turned = if K == D + 1 { self.negative()? } else { self.disagreeing()? };
        let simplices = self.simplices().iter().zip(turned);
        let simplices = simplices.map(|(&s, turn)| if turn { s.reversed() } else { s });
        Ok(Mesh::known(self.vertices().to_vec(), simplices.collect()))
    }

    /// Which simplices have a negative size.
    fn negative(&self) -> Result<Vec<bool>, MeshError> {
        self.check_nondegenerate()?;
        Ok(self.simplices().iter().map(|s| measure(&self.corners(s)) < 0.0).collect())
    }

    /// Which simplices must turn over to agree with the first one of their component.
    fn disagreeing(&self) -> Result<Vec<bool>, MeshError> {
        let uses = self.facet_uses();
        refuse_more_than_two(&uses)?;
        let pairs = || uses.chunk_by(|a, b| a.facet == b.facet).filter(|shared| shared.len() == 2);
        let mut neighbours = vec![[None; K]; self.simplices().len()];
        for shared in pairs() {
            for (one, other) in [(0, 1), (1, 0)].map(|(i, j)| (shared[i], shared[j])) {
                neighbours[one.simplex][one.opposite] =
                    Some((other.simplex, one.even == other.even));
            }
        }
        let turned = spread(&neighbours);
        let contradictions = pairs().filter(|shared| {
            let [a, b] = [shared[0], shared[1]];
            (turned[a.simplex] != turned[b.simplex]) != (a.even == b.even)
        });
        let contradictions = contradictions.map(|shared| named(shared[0].facet)).collect();
        Places::refuse(contradictions, MeshError::NotOrientable)?;
        Ok(turned)
    }
}

/// Carries a choice from the first simplex of each piece across its facets; each neighbour is given
/// with whether it must differ.
fn spread<const K: usize>(neighbours: &[[Option<(usize, bool)>; K]]) -> Vec<bool> {
    let mut choices = vec![None; neighbours.len()];
    for first in 0..neighbours.len() {
        let mut next = vec![(first, false)];
        while let Some((simplex, choice)) = next.pop() {
            if choices[simplex].is_some() {
                continue;
            }
            choices[simplex] = Some(choice);
            let others = neighbours[simplex].iter().flatten();
            next.extend(others.map(|&(other, differ)| (other, choice != differ)));
        }
    }
    choices.into_iter().map(|choice| choice.unwrap_or(false)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Diagonals, icosphere, rectangle};
    use nalgebra::{Vector2, Vector3};

    /// A band of n quadrilaterals, closed with or without a half twist.
    fn band(n: usize, twisted: bool) -> Mesh<3, 3> {
        let vertices = (0..2 * n).map(|k| Vector3::new(k as f64, (k * k) as f64, (k % 2) as f64));
        let mut triangles = Vec::new();
        for k in 0..n {
            let (a, b) = (2 * k, 2 * k + 1);
            let (c, d) = match (k + 1 == n, twisted) {
                (true, true) => (1, 0),
                (true, false) => (0, 1),
                _ => (2 * k + 2, 2 * k + 3),
            };
            triangles.extend([[a, c, b], [b, c, d]]);
        }
        Mesh::new(vertices.collect(), triangles).unwrap()
    }

    #[test]
    fn a_moebius_strip_has_no_orientation_and_a_plain_band_has() {
        assert!(band(5, false).oriented().unwrap().check_oriented().is_ok());
        let error = band(5, true).oriented().unwrap_err();
        assert!(matches!(error, MeshError::NotOrientable(places) if places.0.len() == 1));
    }

    #[test]
    fn scrambled_triangles_of_a_sphere_agree_again() {
        let sphere = icosphere(1.0, 2).unwrap();
        let scrambled = sphere.simplices().iter().enumerate();
        let scrambled = scrambled.map(|(k, &t)| if k * k % 7 == 1 { t.reversed() } else { t });
        let scrambled = Mesh::new(sphere.vertices().to_vec(), scrambled.collect()).unwrap();
        assert!(matches!(scrambled.check_oriented(), Err(MeshError::Inconsistent(_))));
        assert_eq!(scrambled.oriented().unwrap(), sphere);
    }

    #[test]
    fn elements_of_the_plane_are_made_positive() {
        let square = rectangle([2.0, 1.0], [3, 2], Diagonals::Alternating).unwrap();
        assert_eq!(square.check_oriented(), Ok(()));
        let oriented = square.reversed().oriented().unwrap();
        assert_eq!(oriented, square);
        let flat = Mesh::new(
            vec![Vector2::new(0.0, 0.0), Vector2::new(1.0, 1.0), Vector2::new(2.0, 2.0)],
            vec![[0, 1, 2]],
        );
        assert_eq!(flat.unwrap().oriented(), Err(MeshError::Degenerate(Places(vec![0]))));
    }

    #[test]
    fn each_piece_follows_its_own_first_simplex() {
        let sphere = icosphere(1.0, 0).unwrap();
        let inward = sphere.reversed().mapped(|x| x + Vector3::repeat(9.0)).unwrap();
        let both = sphere.beside(&inward);
        assert_eq!(both.oriented().unwrap(), both);
    }
}
