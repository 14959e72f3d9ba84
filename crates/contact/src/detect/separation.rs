//! The direction along which two convex solids are farthest apart.
//!
//! ```text
//! s(n) = min over parts j, i of n.(x2_j(n) - x1_i(n)),    |n| = 1,    gap = max s(n) - r1 - r2
//! s(n + d) ~ min (s_k + b_k.d) + d^T Q d/2,    Q = -sum l_k (H_k + s I),    d across n
//! ```
//! `x1 x2` the farthest points of the solids' parts along `n` and `-n`, which move along circles and
//! ellipsoids as `n` turns (`H` their Hessians). Each pair of parts that was farthest is kept; the
//! least of their models is maximized within a bound on `|d|`, the bound shrinks where the model does
//! not hold. `l` the weights of the pairs that meet at the maximum; there `x2 - x1 = s n`, so that
//! solids that are apart have their closest points and no other maximum. Solids that overlap may have
//! several: each face and axis is tried, and the best ones are followed. Near the maximum the
//! iteration is Newton's, along the curve on which pairs meet as well: each step is brought back onto it.
//! Source: Gilbert, Johnson and Keerthi 1988 for the parts that are kept; Hiriart-Urruty and Lemarechal 1993,
//! chapter XV for the model.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

use crate::detect::cut_model::{Bends, Cut, MOST, maximize, weigh};
use crate::detect::flush::{Met, flush};
use crate::shapes::solid::{Part, Placed};

type V = Vector3<f64>;

/// Along which direction two solids are closest, or least deep in each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Direction {
    /// Less than zero where they overlap, m.
    pub(crate) gap: f64,
    /// From the first to the second, of length 1.
    pub(crate) normal: V,
    /// What the search came to where that is the normal of a face which is as good to rounding: what is
    /// closest beside the face faces the other along this one.
    pub(crate) beside_face: Option<V>,
    /// Points of the hulls that face each other along it, where the search knows such.
    pub(crate) met: Option<[V; 2]>,
}

/// Where a point and a solid are closest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Separation {
    pub(crate) gap: f64,
    pub(crate) normal: V,
    /// On their surfaces.
    pub(crate) points: [V; 2],
}

/// Iterations of one search; it takes about ten.
const ITERATIONS: usize = 100;
/// Increases below this part of the size are rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Closer to the axis of a circle, in radians, no point of it reaches farthest.
const NO_AZIMUTH: f64 = 1e-6;
/// Parts that reach as far as the farthest within this part of the size may come to do so.
const LEVEL: f64 = 1e-10;
/// Points that are across a separation to this part of the sizes face each other.
pub(crate) const MET: f64 = 1e-13;
/// Turns below this, radians, are taken though rounding hides what they gain.
const SMALL: f64 = 1e-6;
/// The first bound on a turn, radians.
const BOUND: f64 = 0.7;
/// Searches of solids that overlap start from so many directions; of those that do by a larger part of the smaller
/// size, from all there are.
const STARTS: usize = 16;
const DEEP: f64 = 1e-3;
/// Starts along the axis of a circle lean by so much, radians: there its farthest point is none.
const LEAN: f64 = 1e-2;

/// Where a search ends.
#[derive(Clone, Copy, Debug)]
struct Top {
    value: f64,
    normal: V,
    /// Whether no turn leads upwards by more than rounding.
    converged: bool,
}

/// Where a search stands.
struct Search<'a> {
    solids: [&'a Placed; 2],
    /// The scale of rounding, m.
    scale: f64,
}

/// The direction along which two solids are farthest apart; none where they are by more than `margin`.
pub(crate) fn separate(solids: [&Placed; 2], margin: f64) -> Option<Direction> {
    let [a, b] = solids;
    let centres = b.centre - a.centre;
    let scale = a.size + b.size + centres.norm();
    let search = Search { solids, scale };
    let rounding = a.rounding + b.rounding;
    let mut starts = Vec::with_capacity(a.faces.len() + b.faces.len() + 12);
    starts.extend(a.faces.iter().copied());
    starts.extend(b.faces.iter().map(|n| -n));
    let kinks = starts.len();
    starts.extend(centres.try_normalize(0.0));
    for axis in [a.axis, b.axis].into_iter().flatten() {
        let across = centres - axis * centres.dot(&axis);
        starts.extend(across.try_normalize(1e-9 * scale));
        starts.extend([axis, -axis]);
    }
    if let [Some(one), Some(other)] = [a.axis, b.axis]
        && let Some(across) = one.cross(&other).try_normalize(1e-9)
    {
        starts.extend([across, -across]);
    }
    let all = [V::x(), V::y(), V::z()];
    starts.extend(all.iter().flat_map(|n| [*n, -n]));
    let signs = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
    starts.extend(signs.iter().flat_map(|[x, y]| {
        let n = V::new(*x, *y, 1.0).normalize();
        [n, -n]
    }));
    let mut order: Vec<(f64, usize)> =
        starts.iter().enumerate().map(|(k, n)| (search.value(n), k)).collect();
    order.sort_by(|x, y| y.0.total_cmp(&x.0).then(x.1.cmp(&y.1)));
    if order[0].0 - rounding > margin {
        return None;
    }
    let mut best: Option<Top> = None;
    let deep = -DEEP * a.size.min(b.size);
    for (tried, &(_, k)) in order.iter().enumerate() {
        if tried >= STARTS && best.is_some_and(|best| best.value - rounding > deep) {
            break;
        }
        let found = search.climb(starts[k]);
        if best.is_none_or(|best| found.value > best.value + ROUNDING * scale) {
            best = Some(found);
        }
        // Solids that are apart have one maximum.
        if best.is_some_and(|best| best.value > 0.0 && best.converged) {
            break;
        }
    }
    let Top { mut value, mut normal, .. } = best?;
    let mut beside_face = None;
    // Faces are kinks that a search comes near to, and that say themselves where they are.
    for &(there, k) in &order {
        if k < kinks && there >= value - ROUNDING * scale && normal.dot(&starts[k]) > 0.9 {
            beside_face = Some(normal);
            (value, normal) = (there, starts[k]);
            break;
        }
    }
    let gap = value - rounding;
    let found = Direction { gap, normal, beside_face, met: None };
    let found = at_faces(solids, found);
    (found.gap <= margin).then_some(found)
}

/// The same direction, or a better one where faces all but lie on each other and say more of it than values do.
pub(crate) fn at_faces(solids: [&Placed; 2], direction: Direction) -> Direction {
    let [a, b] = solids;
    let scale = a.size + b.size + (b.centre - a.centre).norm();
    let rounding = a.rounding + b.rounding;
    let Direction { gap, normal, .. } = direction;
    match flush(solids, normal, MET * scale) {
        Some(Met { separation, normal, points, .. })
            if separation >= gap + rounding - MET * scale =>
        {
            let gap = separation - rounding;
            Direction { gap, normal, met: Some(points), ..direction }
        }
        _ => direction,
    }
}

/// The direction near another along which two solids are farthest apart.
pub(crate) fn direction_near(solids: [&Placed; 2], start: &V) -> V {
    let [a, b] = solids;
    let scale = a.size + b.size + (b.centre - a.centre).norm();
    Search { solids, scale }.climb_within(*start, LEAN).normal
}

/// The separation near a direction of a point, and what is within its rounding, from a solid; of the
/// pair in its order.
pub(crate) fn separate_point(solids: [&Placed; 2], point: usize, start: &V) -> Separation {
    let [a, b] = solids;
    let scale = a.size + b.size + (b.centre - a.centre).norm();
    let search = Search { solids, scale };
    let Top { value, normal, .. } = search.climb(*start);
    // Of a point on a rim many directions are as good: that of the start stays, unless its place on the other solid is
    // another one. Beside a rim the search begins elsewhere, and may end lower than where it was to begin.
    let there = search.value(start);
    let rounding = ROUNDING * scale;
    let elsewhere = value.abs() * (normal - start).norm() > MET * scale;
    let better = value > there + rounding || (elsewhere && value >= there - rounding);
    let (value, normal) = if better { (value, normal) } else { (there, *start) };
    let place = solids[point].centre;
    let [first, second] = match point {
        0 => [place, place + normal * value],
        _ => [place - normal * value, place],
    };
    let points = [first + normal * a.rounding, second - normal * b.rounding];
    Separation { gap: value - a.rounding - b.rounding, normal, points }
}

/// Two unit vectors across a third and each other.
fn across(n: &V) -> [V; 2] {
    let first = n.cross(&V::ith(n.iamin(), 1.0)).normalize();
    [first, n.cross(&first)]
}

impl Search<'_> {
    fn value(&self, n: &V) -> f64 {
        let [a, b] = self.solids;
        -b.farthest(&-n).1 - a.farthest(n).1
    }

    /// The pair of parts that is farthest.
    fn parts(&self, n: &V) -> [usize; 2] {
        let [a, b] = self.solids;
        [a.farthest(n).0, b.farthest(&-n).0]
    }

    fn cut(&self, n: &V, basis: &[V; 2], parts: [usize; 2], weight: f64) -> Cut {
        let [a, b] = self.solids;
        let apart = b.parts[parts[1]].point(&-n) - a.parts[parts[0]].point(n);
        let value = -b.parts[parts[1]].reach(&-n) - a.parts[parts[0]].reach(n);
        let slope = Vector2::new(apart.dot(&basis[0]), apart.dot(&basis[1]));
        Cut { parts, value, slope, weight }
    }

    /// The largest value that is reached by turning from a direction. Along the axis of a circle the
    /// value has a peak of its own, from which the slope leads down, or up in some directions alone.
    fn climb(&self, start: V) -> Top {
        let top = match self.circle_along(&start) {
            None => self.climb_from(start + across(&start)[0] * LEAN),
            // The peak is at the axis, which a start that is nearly along it is not.
            Some(axis) => {
                let peak = |n: V| Top { value: self.value(&n), normal: n, converged: true };
                let (here, there) = (peak(start), peak(axis));
                if there.value > here.value { there } else { here }
            }
        };
        let Some(axis) = self.circle_along(&top.normal) else { return top };
        let ways = self.ways_down(&axis);
        let aside = ways.iter().map(|way| (axis + way * LEAN, BOUND));
        let between = if ways.is_empty() { Vec::new() } else { self.nearly_along(&axis) };
        let halfway = between.iter().map(|way| (axis + way * 0.5, way.norm()));
        aside.chain(halfway).fold(top, |best, (start, bound)| {
            let other = self.climb_within(start, bound);
            if other.value > best.value { other } else { best }
        })
    }

    /// From the axis of a circle to the normals of faces, discs and edges that all but agree with it: what lies
    /// on a disc and is turned against it by little has its top in between.
    fn nearly_along(&self, axis: &V) -> Vec<V> {
        let mut ways = Vec::new();
        for (solid, sign) in self.solids.into_iter().zip([1.0, -1.0]) {
            let normals =
                solid.faces.iter().copied().chain(solid.axis.into_iter().flat_map(|n| [n, -n]));
            ways.extend(normals.map(|n| n * sign - axis));
            let lowest = solid.farthest(&(axis * sign)).0;
            let Part::Point(from) = solid.parts[lowest] else { continue };
            for part in &solid.parts {
                let Part::Point(to) = part else { continue };
                let edge = (to - from).try_normalize(0.0).unwrap_or_default();
                ways.push(edge * -edge.dot(axis));
            }
        }
        ways.retain(|way| (1e-15..LEAN).contains(&way.norm()));
        ways
    }

    /// The axis of a circle that reaches farthest along it, near to a direction.
    fn circle_along(&self, n: &V) -> Option<V> {
        let [a, b] = self.solids;
        let of = |solid: &Placed, n: &V| match solid.parts[solid.farthest(n).0] {
            Part::Circle { axis, .. } if axis.cross(n).norm() < NO_AZIMUTH => {
                Some(axis * axis.dot(n).signum())
            }
            _ => None,
        };
        of(a, n).or_else(|| of(b, &-n).map(|axis| -axis))
    }

    /// Directions across the axis of a circle in which the value may grow; none where the circle holds
    /// what lies on it.
    fn ways_down(&self, n: &V) -> Vec<V> {
        let [a, b] = self.solids;
        // The one that reaches farthest comes first: it alone says what the least turn gains.
        let ends = |solid: &Placed, n: &V| -> (Vec<V>, f64) {
            let (k, reach) = solid.farthest(n);
            if let Part::Circle { centre, axis, radius } = solid.parts[k]
                && axis.cross(n).norm() < NO_AZIMUTH
            {
                return (vec![centre], radius);
            }
            let near = |&i: &usize| i != k && solid.parts[i].reach(n) >= reach - LEVEL * self.scale;
            let others = (0..solid.parts.len()).filter(near);
            let points = std::iter::once(k).chain(others).map(|i| solid.parts[i].point(n));
            (points.collect(), 0.0)
        };
        let ((own, one), (others, other)) = (ends(a, n), ends(b, &-n));
        let mut ways = Vec::with_capacity(own.len() * others.len());
        for p in &own {
            for q in &others {
                let way = q - p;
                ways.push(way - n * way.dot(n));
            }
        }
        if ways[0].norm() <= one + other {
            return Vec::new();
        }
        ways.retain(|way| way.norm() > one + other);
        ways.sort_by(|v, w| v.norm().total_cmp(&w.norm()));
        ways.truncate(3);
        ways.iter().map(|way| way.normalize()).collect()
    }

    fn climb_from(&self, start: V) -> Top {
        self.climb_within(start, BOUND)
    }

    /// The same where the first turn is no larger than this, radians.
    fn climb_within(&self, start: V, mut bound: f64) -> Top {
        let tiny = ROUNDING * self.scale;
        let mut n = start.normalize();
        let mut value = self.value(&n);
        let (mut last, mut converged) = (f64::INFINITY, false);
        let mut cuts = vec![self.cut(&n, &across(&n), self.parts(&n), 1.0)];
        for _ in 0..ITERATIONS {
            let basis = across(&n);
            for cut in &mut cuts {
                *cut = self.cut(&n, &basis, cut.parts, cut.weight);
            }
            let own = self.bend(&n, &basis, &cuts);
            let bends = Bends::new(own, self.scale);
            let Some((d, used, promised)) = maximize(&cuts, &bends, bound) else { break };
            // Cuts that meet above the least one say nothing of how the value bends.
            if d.norm() < SMALL && used.iter().any(|&k| cuts[k].value > value + SMALL * self.scale)
            {
                let least = self.parts(&n);
                cuts.iter_mut().for_each(|cut| cut.weight = f64::from(cut.parts == least));
                continue;
            }
            weigh(&mut cuts, &used, &d, &bends.model);
            let mut next = (n + basis[0] * d.x + basis[1] * d.y).normalize();
            let mut there = self.value(&next);
            if let Some(level) = self.levelled(&next, &cuts, &used) {
                let value = self.value(&level);
                if value > there {
                    (next, there) = (level, value);
                }
            }
            let turn = d.norm();
            let farthest = self.parts(&next);
            let known = cuts.iter().any(|cut| cut.parts == farthest);
            let small = known && turn < SMALL && there >= value - tiny;
            if there > value || small {
                if turn > 0.7 * bound && there - value > 0.3 * (promised - value) {
                    bound = (2.0 * bound).min(BOUND);
                }
                n = next;
                value = value.max(there);
            } else {
                bound = if known { 0.3 * turn.min(bound) } else { 0.8 * bound };
            }
            let ends = small && (promised - value).abs() <= tiny && turn < 0.9 * bound;
            if ends {
                converged = true;
                // Newton's steps go on while they shrink: the place is not as flat as the value.
                if turn > 0.5 * last || turn < 1e-16 {
                    break;
                }
                last = turn;
            } else if bound < 1e-15 {
                break;
            }
            if !known {
                if cuts.len() == MOST {
                    let idle = cuts.iter().position(|cut| cut.weight == 0.0).unwrap_or(0);
                    cuts.remove(idle);
                }
                cuts.push(self.cut(&n, &basis, farthest, 0.0));
            }
        }
        Top { value: self.value(&n), normal: n, converged }
    }

    /// The direction near another where cuts that are to meet do: where they meet is curved, and a straight turn
    /// along it falls beside it.
    fn levelled(&self, n: &V, cuts: &[Cut], used: &[usize]) -> Option<V> {
        let basis = across(n);
        let cut = |k: usize| self.cut(n, &basis, cuts[k].parts, 0.0);
        let turn = match *used {
            [i, j] => {
                let (one, other) = (cut(i), cut(j));
                let off = other.slope - one.slope;
                off * ((one.value - other.value) / off.norm_squared())
            }
            [i, j, k] => {
                let (one, others) = (cut(i), [cut(j), cut(k)]);
                let off = others.map(|other| (other.slope - one.slope).transpose());
                let step = others.map(|other| one.value - other.value);
                Matrix2::from_rows(&off).try_inverse()? * Vector2::from(step)
            }
            _ => return None,
        };
        (n + basis[0] * turn.x + basis[1] * turn.y).try_normalize(0.0)
    }

    /// The second derivative along turns of the cuts by their weights.
    fn bend(&self, n: &V, basis: &[V; 2], cuts: &[Cut]) -> Matrix2<f64> {
        let [a, b] = self.solids;
        let mut sum = Matrix3::zeros();
        let mut height = 0.0;
        for cut in cuts.iter().filter(|cut| cut.weight > 0.0) {
            let [i, j] = cut.parts;
            sum += (a.parts[i].bend(n) + b.parts[j].bend(&-n)) * cut.weight;
            height += cut.value * cut.weight;
        }
        let at = |i: usize, j: usize| basis[i].dot(&(sum * basis[j]));
        -Matrix2::new(at(0, 0) + height, at(0, 1), at(1, 0), at(1, 1) + height)
    }
}
