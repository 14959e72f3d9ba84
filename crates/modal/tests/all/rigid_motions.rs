//! How many motions cost nothing: under stress, on pins, under loads, and with a mass that is none.

use stationary_calculus::{
    Covector, DiagonalMetric, FIXED, Metric, Potential, Sink, SparseError, Stencils, Vector,
};
use stationary_elasticity::{
    Freedoms, Lame, Linear, LinearTetrahedron, Solid, Spring, Strain, lumped_mass,
};
use stationary_mesh::cuboid;
use stationary_modal::problems::fixed_chain;
use stationary_modal::{Linearized, ModalError, RigidMotions};

/// The place where a function of one number has its zero, which it passes from below.
fn zero(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

fn spring(ends: [usize; 2], rest: f64, stiffness: f64) -> Spring {
    Spring::new(ends, rest, stiffness, Strain::Green).unwrap()
}

/// Corners of a cube of D dimensions with sides that are too long and diagonals that are too short,
/// at the size where they are at rest against each other; and how hard its first corner is pulled
/// by its sides alone.
fn stressed<const D: usize>() -> (Stencils<Spring, 2, D>, Vec<f64>) {
    let corners = 1_usize << D;
    let place = |v: usize, c: usize| (v >> c & 1) as f64;
    let mut springs = Vec::new();
    for (a, b) in (0..corners).flat_map(|b| (0..b).map(move |a| (a, b))) {
        let axes = (a ^ b).count_ones();
        let rest = f64::from(axes).sqrt() * if axes == 1 { 1.2 } else { 0.9 };
        springs.push(spring([a, b], rest, 1.0));
    }
    let cube = Stencils::<_, 2, D>::new(corners, Vec::new(), springs).unwrap();
    let sized = |s: f64| -> Vec<f64> {
        (0..corners).flat_map(|v| (0..D).map(move |c| s * (place(v, c) - 0.5))).collect()
    };
    let outward = |s: f64| {
        let mut dv = Covector(vec![0.0; corners * D]);
        cube.add_differential(&sized(s), dv.view_mut());
        // The last corner is the one whose coordinates are all positive.
        dv.0[corners * D - 1]
    };
    let q = sized(zero(outward, 0.5, 2.0));
    (cube, q)
}

#[test]
fn a_body_under_stress_of_its_own_still_turns_for_free() {
    let (square, q) = stressed::<2>();
    let metric = DiagonalMetric::new(vec![1.0; q.len()]).unwrap();
    let near_rest = Linearized::at(&metric, &square, &q, 1e-12).unwrap();
    assert_eq!(RigidMotions::of_points::<2>(&near_rest, q.as_chunks().0).unwrap().len(), 3);
    let (cube, q) = stressed::<3>();
    let metric = DiagonalMetric::new(vec![1.0; q.len()]).unwrap();
    let near_rest = Linearized::at(&metric, &cube, &q, 1e-12).unwrap();
    assert_eq!(RigidMotions::of_points::<3>(&near_rest, q.as_chunks().0).unwrap().len(), 6);
    // The stress is there: without the diagonals the sides would push.
    let force = 1.2 - (q[3] - q[0]).abs();
    assert!(force > 0.05, "{force}");
}

/// Springs and a weight on every second freedom, N.
struct Weighed(Stencils<Spring, 2, 2>, f64);

impl Potential for Weighed {
    fn dim(&self) -> usize {
        self.0.dim()
    }

    fn energy(&self, q: &[f64]) -> f64 {
        self.0.energy(q) + self.1 * q.iter().skip(1).step_by(2).sum::<f64>()
    }

    fn add_differential(&self, q: &[f64], mut dv: Covector<&mut [f64]>) {
        self.0.add_differential(q, dv.view_mut());
        dv.0.iter_mut().skip(1).step_by(2).for_each(|f| *f += self.1);
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        self.0.add_hessian(q, hessian);
    }
}

#[test]
fn a_pin_leaves_the_turn_about_it_and_a_weight_takes_that_too() {
    let hanging = |weight: f64| {
        let pinned = spring([0, 1], 1.0, 3.0);
        let body = Stencils::<_, 2, 2>::new(1, vec![[0.0, 0.0]], vec![pinned]).unwrap();
        let body = Weighed(body, weight);
        let up = |y: f64| {
            let mut dv = Covector(vec![0.0; 2]);
            body.add_differential(&[0.0, y], dv.view_mut());
            dv.0[1]
        };
        let q = [0.0, zero(up, -3.0, -0.9)];
        let metric = DiagonalMetric::new(vec![2.0; 2]).unwrap();
        let near_rest = Linearized::at(&metric, &body, &q, 1e-12).unwrap();
        RigidMotions::of_points::<2>(&near_rest, q.as_chunks().0).unwrap().len()
    };
    assert_eq!((hanging(0.0), hanging(0.5)), (1, 0));
}

/// `1/2 v^2` on all freedoms, but with this much between the first two: definite below 1.
struct Coupled(usize, f64);

impl Metric for Coupled {
    fn dim(&self) -> usize {
        self.0
    }

    fn flat(&self, v: Vector<&[f64]>, p: Covector<&mut [f64]>) {
        p.0.copy_from_slice(v.0);
        p.0[0] += self.1 * v.0[1];
        p.0[1] += self.1 * v.0[0];
    }

    fn sharp(&self, p: Covector<&[f64]>, v: Vector<&mut [f64]>) {
        v.0.copy_from_slice(p.0);
        let determinant = 1.0 - self.1 * self.1;
        v.0[0] = (p.0[0] - self.1 * p.0[1]) / determinant;
        v.0[1] = (p.0[1] - self.1 * p.0[0]) / determinant;
    }

    fn add_matrix(&self, sink: &mut impl Sink) {
        sink.add_symmetric(&[0, 1], &[1.0, self.1, self.1, 1.0]);
        (2..self.0).for_each(|freedom| sink.add_symmetric(&[freedom], &[1.0]));
    }
}

#[test]
fn single_components_that_are_held_leave_the_motions_that_spare_them() {
    // A triangle of springs; each freedom's number, or FIXED.
    let places = [[0.0, 0.0], [2.0, 0.0], [0.5, 1.5]];
    let left = |held: &[(usize, usize)]| {
        let mut freedoms = [[FIXED; 2]; 3];
        let mut n = 0;
        for (vertex, freedoms) in freedoms.iter_mut().enumerate() {
            for (axis, freedom) in freedoms.iter_mut().enumerate() {
                if !held.contains(&(vertex, axis)) {
                    *freedom = n;
                    n += 1;
                }
            }
        }
        let triangle = Triangle { places, freedoms, n };
        let metric = DiagonalMetric::new(vec![1.5; n]).unwrap();
        let near_rest = Linearized::at(&metric, &triangle, &vec![0.0; n], 1e-12).unwrap();
        // Without the map the freedoms cannot be taken for those of whole vertices.
        assert_eq!(RigidMotions::of_points(&near_rest, &places).is_ok(), n == 6);
        RigidMotions::of_freedoms(&near_rest, &places, &freedoms).unwrap().len()
    };
    assert_eq!(left(&[]), 3);
    assert_eq!(left(&[(0, 0)]), 2);
    assert_eq!(left(&[(0, 1), (1, 1), (2, 1)]), 1);
    assert_eq!(left(&[(0, 0), (0, 1)]), 1);
    assert_eq!(left(&[(0, 0), (0, 1), (1, 1)]), 0);
    // Three held components that a turn about a point spares.
    assert_eq!(left(&[(0, 0), (0, 1), (1, 0)]), 1);
}

/// Springs of 1 N/m along the sides of a triangle, linear about its places.
struct Triangle {
    places: [[f64; 2]; 3],
    freedoms: [[usize; 2]; 3],
    n: usize,
}

impl Triangle {
    /// The freedoms of a side's ends and what they stretch it by.
    fn sides(&self) -> impl Iterator<Item = ([usize; 4], [f64; 4])> {
        [[0, 1], [1, 2], [2, 0]].into_iter().map(|[a, b]| {
            let along = [0, 1].map(|c| self.places[b][c] - self.places[a][c]);
            let [x, y] = along.map(|x| x / along[0].hypot(along[1]));
            let [a, b] = [self.freedoms[a], self.freedoms[b]];
            ([a[0], a[1], b[0], b[1]], [-x, -y, x, y])
        })
    }
}

impl Potential for Triangle {
    fn dim(&self) -> usize {
        self.n
    }

    fn energy(&self, q: &[f64]) -> f64 {
        let stretch = |(freedoms, by): ([usize; 4], [f64; 4])| -> f64 {
            freedoms.iter().zip(by).filter(|(f, _)| **f != FIXED).map(|(&f, by)| by * q[f]).sum()
        };
        self.sides().map(|side| 0.5 * stretch(side).powi(2)).sum()
    }

    /// At the places only, which is where it is asked for.
    fn add_differential(&self, q: &[f64], _: Covector<&mut [f64]>) {
        assert!(q.iter().all(|x| *x == 0.0));
    }

    fn add_hessian(&self, _: &[f64], hessian: &mut impl Sink) {
        for (freedoms, by) in self.sides() {
            let block: Vec<f64> = by.iter().flat_map(|x| by.iter().map(move |y| x * y)).collect();
            hessian.add_symmetric(&freedoms, &block);
        }
    }
}

/// A body on springs from each of its freedoms to the ground, which are at rest where it is.
struct Grounded<B> {
    body: B,
    stiffness: f64,
}

impl<B: Potential> Potential for Grounded<B> {
    fn dim(&self) -> usize {
        self.body.dim()
    }

    fn energy(&self, q: &[f64]) -> f64 {
        self.body.energy(q)
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        self.body.add_differential(q, dv);
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        self.body.add_hessian(q, hessian);
        (0..q.len()).for_each(|i| hessian.add_symmetric(&[i], &[self.stiffness]));
    }
}

#[test]
fn a_steel_block_on_soft_springs_moves_as_a_whole_but_not_for_free() {
    let mesh = cuboid([0.1, 0.1, 0.02], [5, 5, 2]).unwrap();
    let nodes: Vec<[f64; 3]> = mesh.vertices().iter().map(|x| [x.x, x.y, x.z]).collect();
    let free = Freedoms::<3>::free(nodes.len()).unwrap();
    let steel = Linear::new(Lame::<3>::from_young_poisson(2e11, 0.3).unwrap());
    let mass = lumped_mass(LinearTetrahedron, &mesh, [7800.0, 1.0], &free).unwrap();
    let q = free.gathered(&nodes).unwrap();
    for all in [0.0, 1e2, 1e4] {
        let body = Solid::new(LinearTetrahedron, &mesh, 1.0, steel, free.clone()).unwrap();
        let block = Grounded { body, stiffness: all / nodes.len() as f64 };
        let mut near_rest = Linearized::at(&mass, &block, &q, 1e-3).unwrap();
        let rigid = RigidMotions::of_points(&near_rest, &nodes).unwrap();
        assert_eq!(rigid.len(), if all == 0.0 { 6 } else { 0 });
        let modes = near_rest.lowest(1, &rigid).unwrap().with_rigid(&rigid).unwrap();
        if all == 0.0 {
            let rounding = 1e-13 * near_rest.scale();
            let is_shown = |residual: &f64| *residual > 0.0 && *residual < rounding;
            assert!(modes.residuals()[..6].iter().all(is_shown), "{:?}", modes.residuals());
        }
        // The springs are as strong at light vertices as at heavy ones: translations tilt the block a little.
        let whole = all / (7800.0 * 0.1 * 0.1 * 0.02);
        let off = (modes.values()[0] - whole).abs();
        assert!(off <= 1e-3 * whole + modes.residuals()[0], "{all}: {:?}", modes.values());
    }
}

#[test]
fn a_mass_that_is_not_positive_definite_is_an_error_that_names_a_freedom() {
    let problem = fixed_chain(5).unwrap();
    let at = |coupling: f64| {
        let metric = Coupled(5, coupling);
        Linearized::at(&metric, &problem.potential, &problem.q, 1e-12).map(|_| ())
    };
    assert_eq!(at(0.5), Ok(()));
    let refused = at(2.0);
    let freedom = |error: &ModalError| match error {
        ModalError::Mass(SparseError::NotPositiveDefinite { freedom }) => Some(*freedom),
        _ => None,
    };
    assert!(refused.as_ref().is_err_and(|e| freedom(e).is_some_and(|f| f < 2)), "{refused:?}");
}
