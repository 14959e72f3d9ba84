//! The broad phase: which pairs can touch at all, by a hierarchy of boxes that is refitted.
//!
//! ```text
//! all pairs of n boxes that overlap, in about n log n steps                                 (11.1)
//! ```
//! The hierarchy is built once and refitted to the boxes of each step; a few of its branches are
//! rebalanced every time. Half-spaces have no box: each is compared with every other shape. The
//! pairs come out sorted, so that nothing later depends on the shape of the tree.

use parry3d_f64::bounding_volume::{Aabb, BoundingVolume};
use parry3d_f64::math::Pose;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};

use crate::Collider;
use crate::convert::vector;

pub(crate) struct BroadPhase {
    tree: Bvh,
    workspace: BvhWorkspace,
    boxes: Vec<Option<Aabb>>,
    /// Which collider each leaf is.
    leaves: Vec<usize>,
    planes: Vec<usize>,
    built: bool,
}

impl BroadPhase {
    pub(crate) fn new(colliders: &[Collider]) -> Self {
        let plane = |&i: &usize| colliders[i].shape.plane().is_some();
        let (planes, leaves) = (0..colliders.len()).partition(plane);
        BroadPhase {
            tree: Bvh::new(),
            workspace: BvhWorkspace::default(),
            boxes: vec![None; colliders.len()],
            leaves,
            planes,
            built: false,
        }
    }

    /// The pairs of colliders whose boxes, `margin` larger, overlap: smaller number first, sorted.
    pub(crate) fn pairs(
        &mut self,
        colliders: &[Collider],
        poses: &[Pose],
        margin: f64,
        pairs: &mut Vec<(usize, usize)>,
    ) {
        pairs.clear();
        self.refit(colliders, poses, 0.5 * margin);
        let leaves = &self.leaves;
        self.tree.traverse_bvtt_single_tree::<false>(&mut self.workspace, &mut |a, b| {
            let (a, b) = (leaves[a as usize], leaves[b as usize]);
            pairs.push((a.min(b), a.max(b)));
        });
        for &plane in &self.planes {
            self.pairs_of_plane(plane, colliders, poses, margin, pairs);
        }
        let can_meet = |&(a, b): &(usize, usize)| colliders[a].carrier != colliders[b].carrier;
        pairs.retain(can_meet);
        pairs.sort_unstable();
    }

    fn refit(&mut self, colliders: &[Collider], poses: &[Pose], margin: f64) {
        for &i in &self.leaves {
            let aabb = colliders[i].shape.geometry().compute_aabb(&poses[i]);
            self.boxes[i] = Some(aabb.loosened(margin));
        }
        let boxes =
            self.leaves.iter().enumerate().filter_map(|(leaf, &i)| Some((leaf, self.boxes[i]?)));
        if self.built {
            for (leaf, aabb) in boxes {
                self.tree.insert_or_update_partially(aabb, leaf as u32, 0.0);
            }
            self.tree.refit(&mut self.workspace);
            self.tree.optimize_incremental(&mut self.workspace);
        } else {
            self.tree = Bvh::from_iter(BvhBuildStrategy::Binned, boxes);
            self.built = true;
        }
    }

    fn pairs_of_plane(
        &self,
        plane: usize,
        colliders: &[Collider],
        poses: &[Pose],
        margin: f64,
        pairs: &mut Vec<(usize, usize)>,
    ) {
        let Some(normal) = colliders[plane].shape.plane() else { return };
        let normal = poses[plane].rotation * vector(&normal);
        let height = normal.dot(poses[plane].translation);
        for (i, aabb) in self.boxes.iter().enumerate() {
            let Some(aabb) = aabb else { continue };
            let lowest = normal.dot(aabb.center()) - normal.abs().dot(aabb.half_extents());
            if lowest - height <= 0.5 * margin {
                pairs.push((plane.min(i), plane.max(i)));
            }
        }
    }
}
