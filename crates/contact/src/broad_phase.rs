//! The broad phase: which pairs can touch at all, by a hierarchy of boxes that is refitted.
//!
//! ```text
//! all pairs of n boxes that overlap, in about n log n steps                                 (11.1)
//! ```
//! The hierarchy is built once and refitted to the boxes of each step; a few of its branches are
//! rebalanced every time. Half-spaces have no box: each is compared with every other shape. The
//! pairs come out sorted, so that nothing later depends on the shape of the tree. The geometry
//! library of the plane is that of space compiled again, and so is the tree here.

use crate::{ColliderIn, Dimension};

pub(crate) struct BroadPhase<G: Dimension> {
    tree: G::Tree,
    /// Which collider each leaf is.
    leaves: Vec<usize>,
    planes: Vec<usize>,
}

/// A hierarchy of boxes about shapes, the leaves.
#[doc(hidden)]
pub trait BoxTree<G: Dimension>: Default {
    /// Fits the boxes to shapes where they are now, `margin` larger on every side.
    fn fit<'a>(&mut self, leaves: impl Iterator<Item = (&'a G::Shape, G::Pose)>, margin: f64);

    /// Calls `found` with every pair of leaves whose boxes overlap.
    fn each_pair(&mut self, found: impl FnMut(usize, usize));

    /// Calls `found` with every leaf whose box reaches down to `height` along a direction.
    fn each_below(&self, direction: &G::Vector, height: f64, found: impl FnMut(usize));
}

impl<G: Dimension> BroadPhase<G> {
    pub(crate) fn new(colliders: &[ColliderIn<G>]) -> Self {
        let plane = |&i: &usize| G::plane(&colliders[i].shape).is_some();
        let (planes, leaves) = (0..colliders.len()).partition(plane);
        BroadPhase { tree: G::Tree::default(), leaves, planes }
    }

    /// The pairs of colliders whose boxes, `margin` larger, overlap: smaller number first, sorted.
    pub(crate) fn pairs(
        &mut self,
        colliders: &[ColliderIn<G>],
        placed: &[G::Motion],
        poses: &[G::Pose],
        margin: f64,
        pairs: &mut Vec<(usize, usize)>,
    ) {
        pairs.clear();
        let leaves = &self.leaves;
        let shapes = leaves.iter().map(|&i| (&colliders[i].shape, poses[i]));
        self.tree.fit(shapes, 0.5 * margin);
        self.tree.each_pair(|a, b| {
            let (a, b) = (leaves[a], leaves[b]);
            pairs.push((a.min(b), a.max(b)));
        });
        for &plane in &self.planes {
            let Some(normal) = G::plane(&colliders[plane].shape) else { continue };
            let normal = G::turn(&placed[plane], &normal);
            let origin = G::apply(&placed[plane], &(normal * 0.0));
            let height = G::dot(&normal, &origin) + 0.5 * margin;
            self.tree.each_below(&normal, height, |leaf| {
                pairs.push((plane.min(leaves[leaf]), plane.max(leaves[leaf])));
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
                    ),
                >,
                margin: f64,
            ) {
                use $library::bounding_volume::BoundingVolume;
                use $library::partitioning::{Bvh, BvhBuildStrategy};
                let built = !self.boxes.is_empty();
                self.boxes.clear();
                self.boxes
                    .extend(leaves.map(|(shape, pose)| {
                        shape.geometry().compute_aabb(&pose).loosened(margin)
                    }));
                let boxes = self.boxes.iter().copied().enumerate();
                if built {
                    for (leaf, aabb) in boxes {
                        self.tree.insert_or_update_partially(aabb, leaf as u32, 0.0);
                    }
                    self.tree.refit(&mut self.workspace);
                    self.tree.optimize_incremental(&mut self.workspace);
                } else {
                    self.tree = Bvh::from_iter(BvhBuildStrategy::Binned, boxes);
                }
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
                let normal = crate::$convert::vector(direction);
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
