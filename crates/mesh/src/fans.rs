//! The quick half of the question whether triangles form a surface: a yes in linear time.
//!
//! ```text
//! around v:  (a1, b1), (a2, b2), ...       v a b the triangles at v, each turned to begin with v
//! a fan:     no a twice, no b twice, and from one pair to the one that begins where it ends all
//!            are met: in a circle inside, from end to end on the boundary
//! ```
//! Where every vertex has one fan the mesh is a manifold, and its triangles agree in orientation.
//! Where some vertex has none it may still be a manifold, whose triangles disagree: then the slow half
//! looks again and says where.

/// Triangles at a vertex beyond which the slow half is quicker.
const MANY: usize = 24;

/// Whether the triangles at every vertex form one fan.
pub(crate) fn all_are_fans<const K: usize>(vertices: usize, simplices: &[[usize; K]]) -> bool {
    if K != 3 || vertices > u32::MAX as usize {
        return false;
    }
    let mut ends = vec![0_usize; vertices + 1];
    simplices.iter().flatten().for_each(|&vertex| ends[vertex + 1] += 1);
    for vertex in 0..vertices {
        if ends[vertex + 1] > MANY {
            return false;
        }
        ends[vertex + 1] += ends[vertex];
    }
    let mut links = vec![[0_u32; 2]; K * simplices.len()];
    for simplex in simplices {
        for k in 0..K {
            let place = &mut ends[simplex[k]];
            links[*place] = [simplex[(k + 1) % K] as u32, simplex[(k + 2) % K] as u32];
            *place += 1;
        }
    }
    // Each start has become the next one's.
    let mut start = 0;
    ends[..vertices].iter().all(|&end| {
        let link = &links[start..end];
        start = end;
        is_fan(link)
    })
}

/// Whether pairs follow each other, all of them, none branching off.
fn is_fan(link: &[[u32; 2]]) -> bool {
    for (k, pair) in link.iter().enumerate() {
        if link[..k].iter().any(|other| other[0] == pair[0] || other[1] == pair[1]) {
            return false;
        }
    }
    let is_led_to = |pair: &[u32; 2]| link.iter().any(|other| other[1] == pair[0]);
    let Some(first) = link.iter().find(|pair| !is_led_to(pair)).or(link.first()) else {
        return true;
    };
    let mut at = first[1];
    for _ in 1..link.len() {
        match link.iter().find(|pair| pair[0] == at) {
            // Back at the beginning too early: another fan is left.
            Some(next) if next != first => at = next[1],
            _ => return false,
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mesh, MeshError, icosphere, torus};
    use nalgebra::Vector3;
    use proptest::prelude::*;

    #[test]
    fn closed_and_open_surfaces_are_fans_everywhere() {
        for surface in [icosphere(1.0, 2).unwrap(), torus([2.0, 0.7], [5, 4]).unwrap()] {
            let all = surface.simplices();
            assert!(all_are_fans(surface.vertices().len(), all));
            assert!(all_are_fans(surface.vertices().len(), &all[1..]));
        }
    }

    #[test]
    fn two_spheres_that_share_a_vertex_are_no_fan_there() {
        let ball = icosphere(1.0, 1).unwrap();
        let count = ball.vertices().len();
        let shared = |v: usize| if v == 0 { 0 } else { v + count };
        let both = ball.simplices().iter().copied();
        let both: Vec<_> = both.chain(ball.simplices().iter().map(|s| s.map(shared))).collect();
        assert!(!all_are_fans(2 * count, &both));
        let vertices = vec![Vector3::zeros(); 2 * count];
        let pinched = Mesh::new(vertices, both).unwrap().check_manifold();
        assert!(matches!(pinched, Err(MeshError::Pinched(_))));
    }

    proptest! {
        #[test]
        fn what_is_a_fan_everywhere_is_a_manifold(
            triangles in proptest::collection::vec(proptest::array::uniform3(0..6_usize), 1..9),
        ) {
            let distinct = |t: &&[usize; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
            let triangles: Vec<_> = triangles.iter().filter(distinct).copied().collect();
            if all_are_fans(6, &triangles) {
                let mesh = Mesh::new(vec![Vector3::zeros(); 6], triangles).unwrap();
                prop_assert_eq!(mesh.check_manifold_slowly(), Ok(()));
                prop_assert_eq!(mesh.check_oriented(), Ok(()));
            }
        }
    }
}
