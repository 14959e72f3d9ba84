//! Checks on the space of rotations, where configurations do not add.

use super::*;

/// Rotations as unit quaternions, scalar first, moved by q <- q exp(h w/2): w in body axes.
struct Rotations;

fn product(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

impl Space for Rotations {
    fn stored(&self, freedoms: usize) -> usize {
        freedoms / 3 * 4
    }

    fn advance(&self, q: &mut [f64], h: f64, v: Vector<&[f64]>) {
        let (bodies, _) = q.as_chunks_mut::<4>();
        for (q, w) in bodies.iter_mut().zip(v.0.as_chunks::<3>().0) {
            let angle = h * w[0].hypot(w[1]).hypot(w[2]);
            let half = if angle == 0.0 { 0.5 * h } else { h * (0.5 * angle).sin() / angle };
            *q = product(*q, [(0.5 * angle).cos(), half * w[0], half * w[1], half * w[2]]);
        }
    }
}

const ARM: [f64; 3] = [0.3, -0.2, 0.7];
const WEIGHT: [f64; 3] = [1.0, 2.0, -9.0];

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The weight in body axes, `g_b = R^T g`, of each body.
fn weights(q: &[f64]) -> Vec<[f64; 3]> {
    let in_body = |q: &[f64; 4]| {
        let conjugate = [q[0], -q[1], -q[2], -q[3]];
        let [_, x, y, z] = product(product(conjugate, [0.0, WEIGHT[0], WEIGHT[1], WEIGHT[2]]), *q);
        [x, y, z]
    };
    q.as_chunks::<4>().0.iter().map(in_body).collect()
}

/// Bodies that hang from a point each, by an arm r fixed in the body.
///
/// ```text
/// V = - g . R r,    dV w = - g_b . (w x r) = - (r x g_b) . w
/// w^T H w = - g_b . (w x (w x r)) = (g_b . r) (w . w) - (g_b . w) (r . w)
/// ```
fn hanging(bodies: usize) -> Given {
    let r = ARM;
    let energy = move |q: &[f64]| -weights(q).into_iter().map(|g| dot(g, r)).sum::<f64>();
    let differential = move |q: &[f64]| {
        let torque = |g: [f64; 3]| {
            [g[1] * r[2] - g[2] * r[1], g[2] * r[0] - g[0] * r[2], g[0] * r[1] - g[1] * r[0]]
        };
        weights(q).into_iter().flat_map(torque).collect()
    };
    let hessian = move |q: &[f64]| {
        let block = |(body, g): (usize, [f64; 3])| {
            let entry = |e: usize| {
                let (i, j) = (e % 3, e / 3);
                let diagonal = if i == j { dot(g, r) } else { 0.0 };
                diagonal - 0.5 * (g[i] * r[j] + g[j] * r[i])
            };
            ((3 * body..3 * body + 3).collect(), (0..9).map(entry).collect())
        };
        weights(q).into_iter().enumerate().map(block).collect()
    };
    given(3 * bodies, energy, differential, hessian)
}

fn orientations(bodies: usize) -> Vec<f64> {
    let mut q = [1.0, 0.0, 0.0, 0.0].repeat(bodies);
    Rotations.advance(&mut q, 1.0, Vector(&configuration(3 * bodies, 2.0)));
    q
}

#[test]
fn bodies_that_hang_from_a_point_pass() {
    for bodies in [1, 4, 20, 100] {
        for seed in 0..10 {
            let check = DerivativeCheck { seed, ..DerivativeCheck::default() };
            let report = check.potential_on(&Rotations, &hanging(bodies), &orientations(bodies));
            let report = report.unwrap();
            assert!(report.unseen() < 1e-5, "{bodies}\n{report}");
        }
    }
}

#[test]
fn the_rows_of_a_hessian_are_not_derivatives_of_the_differential() {
    // The commutator of two turns is a turn: only the quadratic form can be compared.
    let q = orientations(1);
    let at = |w: &[f64], h: f64| Vector((hanging(1).differential)(&moved(&Rotations, &q, w, h)));
    let row = |i: usize, j: usize| {
        let mut w = [0.0; 3];
        w[j] = 1.0;
        (at(&w, 1e-5).0[i] - at(&w, -1e-5).0[i]) / 2e-5
    };
    assert!((row(0, 1) - row(1, 0)).abs() > 0.1);
}

#[test]
fn a_wrong_entry_is_named() {
    for bodies in [1, 4, 100] {
        let q = orientations(bodies);
        let twisted = hanging(bodies).with_hessian(|blocks| {
            let (_, last) = &mut blocks[0];
            (last[1], last[3]) = (last[1] + 1e-4, last[3] + 1e-4);
        });
        let entry = wrong(check_potential_on(&Rotations, &twisted, &q));
        assert_eq!(entry.derivative, Derivative::Hessian);
        assert_eq!((entry.row.min(entry.column), entry.row.max(entry.column)), (0, 1));

        let last = 3 * bodies - 1;
        let inverted = hanging(bodies).with_differential(move |dv| dv[last] = -dv[last]);
        let entry = wrong(check_potential_on(&Rotations, &inverted, &q));
        assert_eq!((entry.derivative, entry.column), (Derivative::Differential, last));
    }
}
