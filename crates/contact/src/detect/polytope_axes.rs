//! Along which direction are two convex solids with flat faces farthest apart, of those that their faces
//! and pairs of edges give?
//!
//! ```text
//! s(n) = min n.x2 - max n.x1          n = +n1, -n2, e1 x e2/|e1 x e2|
//! ```
//! `n1 n2` the normals of both solids' faces, `e1 e2` their edges. `s` is taken over all corners for every
//! `n`, and so no direction, however badly rounded, promises more than it holds. Of directions that are as good
//! a triangle's own comes first: across its sides what touches it would lean.

use nalgebra::Vector3;

use crate::shapes::polytope::{Edge, Polytope};

type V = Vector3<f64>;

/// A direction that parts the solids, and whose.
#[derive(Clone, Copy)]
pub(crate) struct Axis {
    pub(crate) separation: f64,
    pub(crate) normal: V,
    pub(crate) from: Source,
}

#[derive(Clone, Copy)]
pub(crate) enum Source {
    First(usize),
    Second(usize),
    Edges(Edge, Edge),
}

/// Edges that fall short of supporting by more ties do not support.
const SUPPORT: f64 = 1e4;
/// Edges at a smaller sine to each other are parallel: faces have their axis.
pub(crate) const PARALLEL: f64 = 1e-15;
/// Products of normals below this may be zero: arcs that end on each other cross.
const TOUCHING: f64 = 1e-10;
/// A solid as the pair's axes see it.
#[derive(Clone, Copy)]
pub(crate) struct Seen<'a> {
    pub(crate) solid: &'a Polytope,
    pub(crate) corners: &'a [V],
    pub(crate) normals: &'a [V],
}

impl Seen<'_> {
    /// How far it reaches along a direction.
    pub(crate) fn reach(&self, n: &V) -> f64 {
        self.corners.iter().map(|c| c.dot(n)).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Of the faces at the corner that reaches farthest, that which looks most along a direction.
    pub(crate) fn facing(&self, n: &V, slack: f64) -> usize {
        let reach = self.reach(n) - slack;
        let at_end =
            |f: &usize| self.solid.around(*f).iter().any(|&c| self.corners[c].dot(n) >= reach);
        let faces = (0..self.normals.len()).filter(at_end);
        faces
            .max_by(|&f, &g| self.normals[f].dot(n).total_cmp(&self.normals[g].dot(n)))
            .unwrap_or(0)
    }
}

/// How far apart two solids are along a direction from the first to the second.
pub(crate) fn separation([a, b]: [Seen<'_>; 2], n: &V) -> f64 {
    -b.reach(&-n) - a.reach(n)
}

/// The direction along which two solids are farthest apart; none if by more than `margin`.
pub(crate) fn farthest(a: Seen<'_>, b: Seen<'_>, tie: f64, margin: f64) -> Option<Axis> {
    let separation = |n: &V| separation([a, b], n);
    let mut best =
        Axis { separation: f64::NEG_INFINITY, normal: V::zeros(), from: Source::First(0) };
    let mut take = |normal: V, from: Source| {
        let separation = separation(&normal);
        if separation > best.separation + tie {
            best = Axis { separation, normal, from };
        }
        best.separation
    };
    let mut so_far = f64::NEG_INFINITY;
    let triangle = b.normals.len() == 2;
    for side in if triangle { [1, 0] } else { [0, 1] } {
        for (f, n) in [a, b][side].normals.iter().enumerate() {
            so_far = match side {
                0 => take(*n, Source::First(f)),
                _ => take(-n, Source::Second(f)),
            };
        }
    }
    if so_far > margin {
        return None;
    }
    // The core of a capsule has no faces: any edge may support beside it.
    let free = a.normals.is_empty() || b.normals.is_empty();
    let normals = |seen: &Seen<'_>, edge: Edge| {
        edge.faces.map(|f| seen.normals.get(f).copied().unwrap_or_default())
    };
    for &one in &a.solid.edges {
        let e1 = a.corners[one.corners[1]] - a.corners[one.corners[0]];
        let [n1, n2] = normals(&a, one);
        for &other in &b.solid.edges {
            let [m1, m2] = normals(&b, other).map(|m| -m);
            let e2 = b.corners[other.corners[1]] - b.corners[other.corners[0]];
            if !free && !arcs_cross([n1, n2], [m1, m2]) {
                continue;
            }
            let Some(across) = across_both(&e1, &e2) else { continue };
            let n = across * (n1 + n2).dot(&across).signum();
            for n in [n, -n].into_iter().take(if free || n1 == -n2 { 2 } else { 1 }) {
                let here = (b.corners[other.corners[0]] - a.corners[one.corners[0]]).dot(&n);
                // Arcs of a triangle's edge, whose sides are both outside, and arcs that end on each other's
                // circles do not say whether edges support.
                let supports = || separation(&n) > here - SUPPORT * tie;
                if here > so_far + tie && supports() {
                    so_far = take(n, Source::Edges(one, other));
                    if so_far > margin {
                        return None;
                    }
                }
            }
        }
    }
    Some(best)
}

/// The unit vector across two edges; none where they are parallel. Of edges that are nearly so the product has few
/// digits: what is left of it along either is taken out.
pub(crate) fn across_both(e: &V, f: &V) -> Option<V> {
    let product = e.cross(f);
    if product.norm() <= PARALLEL * e.norm() * f.norm() {
        return None;
    }
    let off = |n: V, e: &V| n - e * (n.dot(e) / e.norm_squared());
    let across = off(product.normalize(), f);
    off(off(across, e), e).try_normalize(0.0)
}

/// Whether the arcs between two pairs of normals cross on the sphere, or nearly.
fn arcs_cross([a, b]: [V; 2], [c, d]: [V; 2]) -> bool {
    let (ab, cd) = (b.cross(&a), d.cross(&c));
    let (cba, dba, adc, bdc) = (c.dot(&ab), d.dot(&ab), a.dot(&cd), b.dot(&cd));
    cba * dba <= TOUCHING && adc * bdc <= TOUCHING && cba * bdc >= -TOUCHING
}
