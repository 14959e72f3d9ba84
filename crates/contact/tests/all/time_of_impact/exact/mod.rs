//! Whether moving corners with integer coordinates meet, decided in exact arithmetic.
//!
//! ```text
//! n.(p - a) = 0 at some 0 <= t <= 1 where p is inside: a cubic's roots, isolated by Sturm
//! ```
//! The set of times of contact is closed, so that it is empty unless it holds an end of the motion
//! or a root of one of the polynomials that bound it. Each such root is an algebraic number: a
//! square-free polynomial and an interval that holds no other root of it.

pub mod polynomial;

use polynomial::{Polynomial, Root};

/// A corner: start and end, integers.
pub type Corner = [[i64; 3]; 2];
type Path = [Polynomial; 3];

fn path(corner: &Corner) -> Path {
    std::array::from_fn(|k| Polynomial::linear(corner[0][k], corner[1][k] - corner[0][k]))
}

fn minus(a: &Path, b: &Path) -> Path {
    std::array::from_fn(|k| a[k].minus(&b[k]))
}

fn dot(a: &Path, b: &Path) -> Polynomial {
    let product = |k: usize| a[k].times(&b[k]);
    product(0).plus(&product(1)).plus(&product(2))
}

fn cross(a: &Path, b: &Path) -> Path {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        a[i].times(&b[j]).minus(&a[j].times(&b[i]))
    })
}

/// A point on a segment, as polynomials: three that vanish and one that is not positive.
struct OnSegment {
    off: Path,
    between: Polynomial,
}

impl OnSegment {
    fn new(p: &Path, a: &Path, b: &Path) -> Self {
        let off = cross(&minus(b, a), &minus(p, a));
        OnSegment { off, between: dot(&minus(p, a), &minus(p, b)) }
    }

    fn holds(&self, root: &mut Root) -> bool {
        self.off.iter().all(|w| root.sign_of(w) == 0) && root.sign_of(&self.between) <= 0
    }

    fn polynomials(&self) -> impl Iterator<Item = &Polynomial> {
        self.off.iter().chain([&self.between])
    }
}

/// The conditions of a meeting at a time.
struct Meeting {
    /// Vanishes where the four corners are in a plane.
    flat: Polynomial,
    /// The squared length of the normal.
    normal: Polynomial,
    /// Not negative where the place is inside, if there is a normal.
    inside: Vec<Polynomial>,
    /// One of them holds where they meet, if there is no normal.
    collapsed: Vec<OnSegment>,
}

impl Meeting {
    fn holds(&self, root: &mut Root) -> bool {
        if root.sign_of(&self.flat) != 0 {
            return false;
        }
        if root.sign_of(&self.normal) == 0 {
            return self.collapsed.iter().any(|segment| segment.holds(root));
        }
        self.inside.iter().all(|w| root.sign_of(w) >= 0)
    }

    fn happens(&self) -> bool {
        let mut times = vec![Root::rational(0), Root::rational(1)];
        if self.flat.is_zero() {
            let bounds = self.inside.iter().chain([&self.normal]);
            let collapsed = self.collapsed.iter().flat_map(OnSegment::polynomials);
            for bound in bounds.chain(collapsed).filter(|bound| !bound.is_zero()) {
                times.extend(bound.roots_in_unit_interval());
            }
        } else {
            times.extend(self.flat.roots_in_unit_interval());
        }
        times.iter_mut().any(|time| self.holds(time))
    }
}

/// Whether a particle meets a triangle.
pub fn particle_meets_triangle([p, a, b, c]: &[Corner; 4]) -> bool {
    let [p, a, b, c] = [p, a, b, c].map(path);
    let normal = cross(&minus(&b, &a), &minus(&c, &a));
    let inside = |a: &Path, b: &Path| dot(&cross(&minus(b, a), &minus(&p, a)), &normal);
    Meeting {
        flat: dot(&normal, &minus(&p, &a)),
        inside: vec![inside(&a, &b), inside(&b, &c), inside(&c, &a)],
        collapsed: [(&a, &b), (&b, &c), (&c, &a)].map(|(a, b)| OnSegment::new(&p, a, b)).into(),
        normal: dot(&normal, &normal),
    }
    .happens()
}

/// Whether an edge meets another.
pub fn edge_meets_edge([a, b, c, d]: &[Corner; 4]) -> bool {
    let [a, b, c, d] = [a, b, c, d].map(path);
    let (e, f, r) = (minus(&b, &a), minus(&d, &c), minus(&c, &a));
    let normal = cross(&e, &f);
    let square = dot(&normal, &normal);
    let (u, v) = (dot(&cross(&r, &f), &normal), dot(&cross(&r, &e), &normal));
    Meeting {
        flat: dot(&normal, &r),
        inside: vec![square.minus(&u), square.minus(&v), u, v],
        collapsed: vec![
            OnSegment::new(&c, &a, &b),
            OnSegment::new(&d, &a, &b),
            OnSegment::new(&a, &c, &d),
            OnSegment::new(&b, &c, &d),
        ],
        normal: square,
    }
    .happens()
}
