//! Which joints the bodies of a scene hang by, and which close loops.
//!
//! Joints with a motor of given speed come first, then those that take most freedoms: so loops are closed by few
//! equations. Each body hangs from the world, or from another, by its joint; one that no joint leads to moves
//! freely.

use crate::model::drives::MotorDrive;
use crate::model::scene::Scene;

/// A body in the order of the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Hung {
    pub(crate) body: usize,
    /// The joint from which it hangs, and which of its ends is the body; none of what moves freely.
    pub(crate) by: Option<(usize, usize)>,
}

/// Every body after what it hangs from, and the joints that are left.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct SpanningTree {
    pub(crate) hung: Vec<Hung>,
    pub(crate) closing: Vec<usize>,
}

/// Bodies and the world, by what they hang together with.
struct Together(Vec<usize>);

impl Together {
    fn root(&mut self, mut one: usize) -> usize {
        while self.0[one] != one {
            self.0[one] = self.0[self.0[one]];
            one = self.0[one];
        }
        one
    }

    /// Joins two; whether they were apart.
    fn join(&mut self, [a, b]: [usize; 2]) -> bool {
        let [a, b] = [self.root(a), self.root(b)];
        self.0[a] = b;
        a != b
    }
}

impl Scene {
    /// Whether a motor gives a joint its speed.
    fn has_speed(&self, joint: usize) -> bool {
        let drives = &self.drives.motors;
        drives.iter().any(|motor| motor.joint == joint && motor.drive == MotorDrive::Speed)
    }

    /// The joint that closes a loop of joints that all follow motors: its speed follows from the others'.
    pub(crate) fn driven_closing_joint(&self) -> Option<usize> {
        self.spanning_tree().closing.into_iter().find(|&joint| self.has_speed(joint))
    }

    /// Its bodies as a tree.
    pub(crate) fn spanning_tree(&self) -> SpanningTree {
        let world = self.bodies.len();
        let mut together = Together((0..=world).collect());
        let mut first: Vec<usize> = (0..self.joints.len()).collect();
        first.sort_by_key(|&joint| {
            (!self.has_speed(joint), usize::MAX - self.rows_of(&self.joints[joint]))
        });
        let mut closing = Vec::new();
        let mut joints_of = vec![Vec::new(); world + 1];
        for joint in first {
            let ends = self.joints[joint].between.map(|end| end.unwrap_or(world));
            if together.join(ends) {
                ends.into_iter().for_each(|end| joints_of[end].push(joint));
            } else {
                closing.push(joint);
            }
        }
        joints_of.iter_mut().for_each(|joints| joints.sort_unstable());
        closing.sort_unstable();
        let (mut hung, mut seen) = (Vec::new(), vec![false; world]);
        self.hang(&joints_of[world], &mut seen, &mut hung);
        let (mut next, mut root) = (0, 0);
        loop {
            if next == hung.len() {
                root += seen[root..].iter().take_while(|seen| **seen).count();
                if root == world {
                    return SpanningTree { hung, closing };
                }
                seen[root] = true;
                hung.push(Hung { body: root, by: None });
            }
            self.hang(&joints_of[hung[next].body], &mut seen, &mut hung);
            next += 1;
        }
    }

    /// Hangs the bodies that these joints lead to.
    fn hang(&self, joints: &[usize], seen: &mut [bool], hung: &mut Vec<Hung>) {
        for &joint in joints {
            for (end, body) in self.joints[joint].between.into_iter().enumerate() {
                if let Some(body) = body.filter(|&body| !seen[body]) {
                    seen[body] = true;
                    hung.push(Hung { body, by: Some((joint, end)) });
                }
            }
        }
    }
}
