//! A body cut into parts: which freedoms and which elements are whose.
//!
//! ```text
//! freedoms   0 .. n = part 0 | part 1 | ...      as many corners of elements in each, about
//! elements   those with a freedom of the part    in the order of the mesh
//! ```
//! Elements at a border belong to both sides. Cut between vertices, by their numbers: how many
//! elements are shared depends on how the mesh is numbered.

use stationary_calculus::FIXED;

use crate::Freedoms;
use crate::group::Group;

/// Parts of a body, or the whole of it.
#[derive(Clone, Debug)]
pub(crate) struct Division {
    bounds: Vec<usize>,
    /// The groups of elements of each part, ascending; none for the whole.
    groups: Vec<Vec<u32>>,
}

impl Division {
    /// One part of so many freedoms.
    pub(crate) fn whole(freedoms: usize) -> Self {
        Division { bounds: vec![0, freedoms], groups: Vec::new() }
    }

    pub(crate) fn new<const D: usize, const N: usize, const R: usize, const Q: usize>(
        freedoms: &Freedoms<D>,
        groups: &[Group<N, R, Q>],
        count: usize,
    ) -> Self {
        if count < 2 {
            return Division::whole(freedoms.dim());
        }
        // How many elements each freedom meets.
        let mut met = vec![0; freedoms.dim()];
        let mut meet = |freedom: usize| met[freedom] += 1;
        for group in groups {
            named(freedoms, group).for_each(&mut meet);
        }
        let total: usize = met.iter().sum();
        let (mut bounds, mut sum) = (vec![0], 0);
        for vertex in 0..freedoms.vertices() {
            let of_vertex = freedoms.of(vertex).into_iter().filter(|&freedom| freedom != FIXED);
            for (c, freedom) in of_vertex.enumerate() {
                if c == 0 && bounds.len() < count && sum * count >= total * bounds.len() {
                    bounds.push(freedom);
                }
                sum += met[freedom];
            }
        }
        bounds.resize(count + 1, freedoms.dim());
        let mut parts = vec![Vec::new(); count];
        for (number, group) in groups.iter().enumerate() {
            for freedom in named(freedoms, group) {
                let part: &mut Vec<u32> =
                    &mut parts[bounds.partition_point(|&bound| bound <= freedom) - 1];
                if part.last() != Some(&(number as u32)) {
                    part.push(number as u32);
                }
            }
        }
        Division { bounds, groups: parts }
    }

    pub(crate) fn is_whole(&self) -> bool {
        self.groups.is_empty()
    }

    pub(crate) fn bounds(&self) -> &[usize] {
        &self.bounds
    }

    pub(crate) fn groups(&self, part: usize) -> &[u32] {
        &self.groups[part]
    }
}

/// The freedoms of the elements of a group, some of them more than once.
fn named<'a, const D: usize, const N: usize, const R: usize, const Q: usize>(
    freedoms: &'a Freedoms<D>,
    group: &'a Group<N, R, Q>,
) -> impl Iterator<Item = usize> + 'a {
    let nodes = group.nodes.as_flattened().iter();
    nodes.flat_map(|&node| freedoms.freedoms(node)).filter(|&freedom| freedom != FIXED)
}
