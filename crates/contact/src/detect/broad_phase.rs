//! The broad phase: which pairs can touch at all, by a hierarchy of boxes that is refitted.
//!
//! ```text
//! all pairs of n boxes that overlap, in about n log n steps                                 (11.1)
//! ```
//! The hierarchy is built once. A box is a little larger than it need be, and stays as long as it
//! still holds its shape; once some do not, the tree is refitted and a few of its branches are
//! rebalanced. Until then the pairs stay too. Half-spaces have no box: each is compared with every
//! other shape. The pairs come out sorted, so that nothing later depends on the shape of the tree.
//! The geometry library of the plane is that of space compiled again, and so is the tree here.

use crate::{ColliderIn, Dimension};

pub(crate) struct BroadPhase<G: Dimension> {
    tree: G::Tree,
    /// Which collider each leaf is.
    leaves: Vec<usize>,
    planes: Vec<Plane<G>>,
}

/// A half-space, and what was compared last.
struct Plane<G: Dimension> {
    collider: usize,
    /// Its normal, how high its face was along it, and to which height above that boxes were looked
    /// at.
    seen: Option<(G::Vector, f64, f64)>,
}

/// A hierarchy of boxes about shapes, the leaves.
#[doc(hidden)]
pub trait BoxTree<G: Dimension>: Default {
    /// Fits the boxes to shapes where they are now, each at least its margin larger on every side;
    /// says whether any has changed.
    fn fit<'a>(&mut self, leaves: impl Iterator<Item = (&'a G::Shape, G::Pose, f64)>) -> bool;

    /// Calls `found` with every pair of leaves whose boxes overlap.
    fn each_pair(&mut self, found: impl FnMut(usize, usize));

    /// Calls `found` with every leaf whose box reaches down to `height` along a direction.
    fn each_below(&self, direction: &G::Vector, height: f64, found: impl FnMut(usize));
}

impl<G: Dimension> BroadPhase<G> {
    pub(crate) fn new(colliders: &[ColliderIn<G>]) -> Self {
        let plane = |&i: &usize| G::plane(&colliders[i].shape).is_some();
        let (planes, leaves): (Vec<_>, _) = (0..colliders.len()).partition(plane);
        let planes = planes.into_iter().map(|collider| Plane { collider, seen: None }).collect();
        BroadPhase { tree: G::Tree::default(), leaves, planes }
    }

    /// The pairs of colliders whose boxes, each at least its margin larger, overlap: smaller number
    /// first, sorted. They are left as they are where they are still the same.
    pub(crate) fn pairs(
        &mut self,
        colliders: &[ColliderIn<G>],
        placed: &[G::Motion],
        poses: &[G::Pose],
        margins: &[f64],
        pairs: &mut Vec<(usize, usize)>,
    ) {
        let leaves = &self.leaves;
        let shapes = leaves.iter().map(|&i| (&colliders[i].shape, poses[i], margins[i]));
        let mut changed = self.tree.fit(shapes);
        for Plane { collider, seen } in &mut self.planes {
            let Some(normal) = G::plane(&colliders[*collider].shape) else { continue };
            let normal = G::turn(&placed[*collider], &normal);
            let height = G::dot(&normal, &G::apply(&placed[*collider], &(normal * 0.0)));
            let margin = margins[*collider];
            let same =
                |&(n, at, up): &(G::Vector, f64, f64)| n == normal && at == height && margin <= up;
            if !seen.as_ref().is_some_and(same) {
                changed = true;
                *seen = Some((normal, height, 2.0 * margin));
            }
        }
        if !changed {
            return;
        }
        pairs.clear();
        self.tree.each_pair(|a, b| {
            let (a, b) = (leaves[a], leaves[b]);
            pairs.push((a.min(b), a.max(b)));
        });
        for &Plane { collider, seen } in &self.planes {
            let Some((normal, height, up)) = seen else { continue };
            self.tree.each_below(&normal, height + up, |leaf| {
                pairs.push((collider.min(leaves[leaf]), collider.max(leaves[leaf])));
            });
        }
        let can_meet = |&(a, b): &(usize, usize)| colliders[a].carrier != colliders[b].carrier;
        pairs.retain(can_meet);
        pairs.sort_unstable();
    }
}

macro_rules! box_tree {
    ($tree:ident, $dimension:ident, $library:ident, $convert:ident) => {
        #[doc(hidden)]
        #[derive(Default)]
        pub struct $tree {
            tree: $library::partitioning::Bvh,
            workspace: $library::partitioning::BvhWorkspace,
            boxes: Vec<$library::bounding_volume::Aabb>,
        }

        impl BoxTree<crate::$dimension> for $tree {
            fn fit<'a>(
                &mut self,
                leaves: impl Iterator<
                    Item = (
                        &'a <crate::$dimension as Dimension>::Shape,
                        <crate::$dimension as Dimension>::Pose,
                        f64,
                    ),
                >,
            ) -> bool {
                use $library::bounding_volume::BoundingVolume;
                use $library::partitioning::{Bvh, BvhBuildStrategy};
                let tight =
                    |(shape, pose, margin): (&<crate::$dimension as Dimension>::Shape, _, f64)| {
                        shape.aabb(&pose).loosened(margin)
                    };
                if self.boxes.is_empty() {
                    self.boxes.extend(leaves.map(|leaf| tight(leaf).loosened(leaf.2)));
                    let boxes = self.boxes.iter().copied().enumerate();
                    self.tree = Bvh::from_iter(BvhBuildStrategy::Binned, boxes);
                    return true;
                }
                let mut changed = false;
                for (leaf, (kept, shape)) in self.boxes.iter_mut().zip(leaves).enumerate() {
                    let margin = shape.2;
                    let tight = tight(shape);
                    if !kept.contains(&tight) {
                        changed = true;
                        *kept = tight.loosened(margin);
                        self.tree.insert_or_update_partially(*kept, leaf as u32, 0.0);
                    }
                }
                if changed {
                    self.tree.refit(&mut self.workspace);
                    self.tree.optimize_incremental(&mut self.workspace);
                }
                changed
            }

            fn each_pair(&mut self, mut found: impl FnMut(usize, usize)) {
                self.tree.traverse_bvtt_single_tree::<false>(&mut self.workspace, &mut |a, b| {
                    found(a as usize, b as usize);
                });
            }

            fn each_below(
                &self,
                direction: &<crate::$dimension as Dimension>::Vector,
                height: f64,
                mut found: impl FnMut(usize),
            ) {
                let normal = crate::shapes::$convert::vector(direction);
                for (leaf, aabb) in self.boxes.iter().enumerate() {
                    let lowest = normal.dot(aabb.center()) - normal.abs().dot(aabb.half_extents());
                    if lowest <= height {
                        found(leaf);
                    }
                }
            }
        }
    };
}

#[cfg(feature = "3d")]
box_tree!(SpatialTree, Spatial, parry3d_f64, convert);
#[cfg(feature = "2d")]
box_tree!(PlanarTree, Planar, parry2d_f64, planar_convert);
