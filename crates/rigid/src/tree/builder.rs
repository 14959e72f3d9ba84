//! A tree of bodies: what hangs from what, by which joint, and where.
//!
//! ```text
//! F on the parent,  G on the body:       pose of the body = parent F J(q) G^-1
//! ```
//! Frames are motions from the joint's axes into those of the parent, or of the body, or the
//! world's where there is no parent. A body's axes are its principal axes, with their origin in its
//! centre, as everywhere in this crate; [`PrincipalFrame`](crate::PrincipalFrame) leads there.
//! Bodies are numbered as they were hung, and a joint has its body's number. Coordinates follow each
//! other in that order, and so do speeds.
//!
//! A body without mass is a frame between two joints: several simple joints in a row make a compound
//! one. The last body of a branch must have a mass.

use std::ops::Range;

use nalgebra::Vector3;
use stationary_calculus::SizeError;

use super::error::{Joining, TreeError, check_numbers};
use crate::{Body, JointFault, JointKind, LieGroup, RigidMotion, Rotation};

/// A body, and the joint from which it hangs.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Link {
    pub parent: Option<usize>,
    pub joint: JointKind,
    /// F on the parent.
    pub before: RigidMotion,
    /// G on the body, and back.
    pub on_body: RigidMotion,
    pub after: RigidMotion,
    /// Whether F is turned against the parent, and G against the body.
    pub turned: [bool; 2],
    /// Zero where it is a frame only.
    pub mass: f64,
    pub moments: Vector3<f64>,
    pub coordinates: Range<usize>,
    pub speeds: Range<usize>,
    /// Whether a body hangs from it that is not the next.
    pub forks: bool,
}

/// A tree of bodies with its joints.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    pub(super) links: Vec<Link>,
    coordinates: usize,
    speeds: usize,
}

/// What a tree is made of, body by body.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TreeBuilder {
    hung: Vec<Hung>,
}

/// What was asked for, unchecked. Without a body it is a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Hung {
    parent: Option<usize>,
    joint: JointKind,
    frames: [RigidMotion; 2],
    mass: Option<Body>,
}

impl TreeBuilder {
    /// Hangs a body from its parent, or from the world, by a joint whose frames on the parent and
    /// on the body are given; the body's number.
    pub fn hang(
        &mut self,
        parent: Option<usize>,
        joint: JointKind,
        frames: [RigidMotion; 2],
        body: Body,
    ) -> usize {
        self.hung.push(Hung { parent, joint, frames, mass: Some(body) });
        self.hung.len() - 1
    }

    /// Hangs a body without mass, for other bodies to hang from; its number.
    pub fn hang_frame(
        &mut self,
        parent: Option<usize>,
        joint: JointKind,
        frames: [RigidMotion; 2],
    ) -> usize {
        self.hung.push(Hung { parent, joint, frames, mass: None });
        self.hung.len() - 1
    }

    /// The tree.
    ///
    /// # Errors
    /// [`TreeError::NoSuchParent`]; [`TreeError::Circle`] for a parent that is the body itself or
    /// comes later; [`TreeError::Joint`] for one that cannot be; [`TreeError::Massless`] for one that
    /// moves bodies without mass only.
    pub fn build(self) -> Result<Tree, TreeError> {
        let bodies = self.hung.len();
        let mut tree = Tree { links: Vec::with_capacity(bodies), coordinates: 0, speeds: 0 };
        for (body, Hung { parent, joint, frames, mass }) in self.hung.into_iter().enumerate() {
            let joining = Joining { kind: joint.name(), body, parent };
            match parent {
                Some(parent) if parent >= bodies => {
                    return Err(TreeError::NoSuchParent { joining, bodies });
                }
                Some(parent) if parent >= body => return Err(TreeError::Circle { joining }),
                _ => {}
            }
            for (frame, what) in
                frames.iter().zip(["the frame on the parent", "the frame on the body"])
            {
                let numbers = frame.translation.iter().copied().chain(frame.rotation.quaternion());
                for value in numbers {
                    if !value.is_finite() {
                        let fault = JointFault::NotFinite { what, value };
                        return Err(TreeError::Joint { joining, fault });
                    }
                }
            }
            let joint = joint
                .checked()
                .and_then(JointKind::of_a_tree)
                .map_err(|fault| TreeError::Joint { joining, fault })?;
            let (q, v) = (tree.coordinates, tree.speeds);
            (tree.coordinates, tree.speeds) = (q + joint.coordinates(), v + joint.freedoms());
            tree.links.push(Link {
                parent,
                joint,
                before: frames[0],
                on_body: frames[1],
                after: frames[1].inverse(),
                turned: frames.map(|frame| frame.rotation != Rotation::identity()),
                mass: mass.map_or(0.0, |body| body.mass()),
                moments: mass.map_or(Vector3::zeros(), |body| body.moments()),
                coordinates: q..tree.coordinates,
                speeds: v..tree.speeds,
                forks: false,
            });
            if let Some(parent) = parent.filter(|parent| parent + 1 != body) {
                tree.links[parent].forks = true;
            }
        }
        tree.check_masses()?;
        Ok(tree)
    }
}

impl Tree {
    /// The number of bodies.
    pub fn bodies(&self) -> usize {
        self.links.len()
    }

    /// The number of coordinates.
    pub fn coordinates(&self) -> usize {
        self.coordinates
    }

    /// The number of speeds: the freedoms.
    pub fn speeds(&self) -> usize {
        self.speeds
    }

    /// The joint from which a body hangs, its axes of length 1, and what it hangs from.
    ///
    /// # Errors
    /// [`TreeError::NoSuchBody`].
    pub fn joint(&self, body: usize) -> Result<(&JointKind, Option<usize>), TreeError> {
        let link = self.link(body)?;
        Ok((&link.joint, link.parent))
    }

    /// Where the coordinates of a body's joint stand among all.
    ///
    /// # Errors
    /// [`TreeError::NoSuchBody`].
    pub fn coordinates_of(&self, body: usize) -> Result<Range<usize>, TreeError> {
        Ok(self.link(body)?.coordinates.clone())
    }

    /// Where the speeds of a body's joint stand among all.
    ///
    /// # Errors
    /// [`TreeError::NoSuchBody`].
    pub fn speeds_of(&self, body: usize) -> Result<Range<usize>, TreeError> {
        Ok(self.link(body)?.speeds.clone())
    }

    /// The coordinates at which the two frames of every joint coincide.
    pub fn rest(&self) -> Vec<f64> {
        let mut q = vec![0.0; self.coordinates];
        self.links.iter().for_each(|link| link.joint.rest(&mut q[link.coordinates.clone()]));
        q
    }

    /// The coordinates' rates at these speeds.
    ///
    /// # Errors
    /// Sizes that do not fit, numbers that are not finite.
    pub fn rates(&self, q: &[f64], v: &[f64], rates: &mut [f64]) -> Result<(), TreeError> {
        self.check_coordinates(q)?;
        self.check_speeds("the speeds", v)?;
        SizeError::check("the rates", self.coordinates, rates.len())?;
        self.write_rates(q, v, rates);
        Ok(())
    }

    /// Moves the coordinates along a displacement in the axes of the speeds; quaternions come out
    /// with length 1.
    ///
    /// # Errors
    /// Sizes that do not fit, numbers that are not finite, a quaternion without a direction.
    pub fn advance(&self, q: &mut [f64], by: &[f64]) -> Result<(), TreeError> {
        self.check_coordinates(q)?;
        self.check_speeds("the displacement", by)?;
        self.move_along(q, by);
        Ok(())
    }

    #[inline]
    pub(super) fn write_rates(&self, q: &[f64], v: &[f64], rates: &mut [f64]) {
        for Link { joint, coordinates, speeds, .. } in &self.links {
            let (q, rates) = (&q[coordinates.clone()], &mut rates[coordinates.clone()]);
            joint.rate(q, &v[speeds.clone()], rates);
        }
    }

    #[inline]
    pub(super) fn move_along(&self, q: &mut [f64], by: &[f64]) {
        for Link { joint, coordinates, speeds, .. } in &self.links {
            joint.advance(&mut q[coordinates.clone()], &by[speeds.clone()]);
        }
    }

    #[inline]
    pub(super) fn check_coordinates(&self, q: &[f64]) -> Result<(), TreeError> {
        check_numbers("the coordinates", self.coordinates, q)?;
        for (body, link) in self.links.iter().enumerate() {
            if let Some(length) = link.joint.lost_quaternion(&q[link.coordinates.clone()]) {
                return Err(TreeError::Quaternion { joining: self.joining(body), length });
            }
        }
        Ok(())
    }

    #[inline]
    pub(super) fn check_speeds(&self, what: &'static str, v: &[f64]) -> Result<(), TreeError> {
        check_numbers(what, self.speeds, v)
    }

    pub(super) fn link(&self, body: usize) -> Result<&Link, TreeError> {
        let bodies = self.links.len();
        self.links.get(body).ok_or(TreeError::NoSuchBody { body, bodies })
    }

    /// The bodies from which another hangs than the next.
    pub(super) fn forks(&self) -> Vec<usize> {
        (0..self.links.len()).filter(|&body| self.links[body].forks).collect()
    }

    /// The largest radius of gyration of a body, metres.
    pub(super) fn radius(&self) -> f64 {
        let massive = self.links.iter().filter(|link| link.mass > 0.0);
        let radius = |link: &Link| (0.5 * link.moments.sum() / link.mass).sqrt();
        massive.map(radius).fold(0.0, f64::max)
    }

    /// The number of bodies on the longest branch.
    pub(super) fn depth(&self) -> usize {
        let mut depths = vec![1; self.links.len()];
        for (body, link) in self.links.iter().enumerate() {
            depths[body] = 1 + link.parent.map_or(0, |parent| depths[parent]);
        }
        depths.into_iter().max().unwrap_or(0)
    }

    pub(super) fn joining(&self, body: usize) -> Joining {
        let link = &self.links[body];
        Joining { kind: link.joint.name(), body, parent: link.parent }
    }

    /// Every joint that moves must move some mass.
    fn check_masses(&self) -> Result<(), TreeError> {
        let mut heavy: Vec<bool> = self.links.iter().map(|link| link.mass > 0.0).collect();
        for (body, link) in self.links.iter().enumerate().rev() {
            match link.parent {
                Some(parent) if heavy[body] => heavy[parent] = true,
                _ => {}
            }
        }
        let idle = |&body: &usize| !heavy[body] && !self.links[body].speeds.is_empty();
        match (0..self.links.len()).find(idle) {
            Some(body) => Err(TreeError::Massless { joining: self.joining(body) }),
            None => Ok(()),
        }
    }
}
