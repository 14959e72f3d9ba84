//! A thin sheet that is hit: nothing passes, whatever the speed (notes 11.1, 11.4).

use nalgebra::Vector3;
use stationary_calculus::Vector;
use stationary_contact::{ContactError, MeshFilter};
use stationary_measure::SplitMix64;

/// Cells along a side of the sheet.
const SIDE: usize = 5;
/// What the sheet would be thick, m: the unit of speeds.
const THICKNESS: f64 = 1e-3;

/// A square sheet of 1 m in the plane z = 0, and a tetrahedron above it.
struct Scene {
    q: Vec<f64>,
    triangles: Vec<[usize; 3]>,
    masses: Vec<f64>,
    pinned: Vec<bool>,
    first: usize,
}

fn scene(pin: impl Fn(usize, usize) -> bool) -> Scene {
    let at = |i: usize, j: usize| i * (SIDE + 1) + j;
    let (mut q, mut pinned, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for (i, j) in (0..=SIDE).flat_map(|i| (0..=SIDE).map(move |j| (i, j))) {
        q.extend([i as f64 / SIDE as f64 - 0.5, j as f64 / SIDE as f64 - 0.5, 0.0]);
        pinned.push(pin(i, j));
        if i < SIDE && j < SIDE {
            triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    let first = pinned.len();
    let corners = [[0.03, 0.05, 0.1], [0.25, 0.0, 0.3], [-0.1, 0.2, 0.3], [-0.1, -0.15, 0.35]];
    corners.into_iter().for_each(|corner| q.extend(corner));
    pinned.extend([false; 4]);
    let [a, b, c, d] = [0, 1, 2, 3].map(|k| first + k);
    triangles.extend([[a, b, c], [a, c, d], [a, d, b], [b, d, c]]);
    let mut masses = vec![0.01; first];
    masses.extend([0.25; 4]);
    Scene { q, triangles, masses, pinned, first }
}

/// The signed volumes that a passage would turn: of the tetrahedron's corners over the sheet's
/// cells below them, for a sheet that stays a graph.
fn lowest_above_sheet(scene: &Scene, q: &[f64]) -> f64 {
    let place = |vertex: usize| Vector3::from_column_slice(&q[3 * vertex..][..3]);
    let sheet = scene.triangles.iter().filter(|t| t.iter().all(|&v| v < scene.first));
    let mut lowest = f64::INFINITY;
    for &[a, b, c] in sheet {
        let (a, b, c) = (place(a), place(b), place(c));
        let n = (b - a).cross(&(c - a));
        for p in (scene.first..scene.first + 4).map(place) {
            let weight = |x: &Vector3<f64>, y: &Vector3<f64>| (x - p).cross(&(y - p)).z / n.z;
            if weight(&a, &b) >= 0.0 && weight(&b, &c) >= 0.0 && weight(&c, &a) >= 0.0 {
                lowest = lowest.min(n.dot(&(p - a)) / n.z);
            }
        }
    }
    lowest
}

#[test]
fn a_pinned_sheet_is_never_passed_at_speeds_up_to_ten_thousand_thicknesses_a_step() {
    for speed in [1.0, 1e2, 1e4] {
        let Scene { q, triangles, masses, pinned, .. } = scene(|_, _| true);
        let scene = scene(|_, _| true);
        let filter = MeshFilter::new(masses, pinned, triangles, 1e-9).unwrap();
        let mut q = q;
        let mut v = Vector(vec![0.0; q.len()]);
        for vertex in scene.first..scene.first + 4 {
            v.0[3 * vertex..][..3].copy_from_slice(&[0.0, 0.0, -speed * THICKNESS]);
        }
        let h = 1.0;
        for _ in 0..30 {
            for vertex in scene.first..scene.first + 4 {
                v.0[3 * vertex + 2] -= 0.01 * speed * THICKNESS;
            }
            filter.filter(&q, h, v.view_mut()).unwrap();
            Vector(&mut q[..]).add_scaled(h, v.view());
            assert!(lowest_above_sheet(&scene, &q) > 0.0, "{speed}");
        }
    }
}

#[test]
fn a_free_sheet_takes_the_blow_and_momentum_is_kept() {
    let mut random = SplitMix64::new(5);
    for speed in [10.0, 1e3, 1e4] {
        let scene = scene(|_, _| false);
        let filter = MeshFilter::new(
            scene.masses.clone(),
            scene.pinned.clone(),
            scene.triangles.clone(),
            1e-9,
        )
        .unwrap();
        let mut v = Vector(vec![0.0; scene.q.len()]);
        for vertex in scene.first..scene.first + 4 {
            let wobble = 0.1 * speed * THICKNESS * random.symmetric();
            v.0[3 * vertex..][..3].copy_from_slice(&[wobble, wobble, -speed * THICKNESS]);
        }
        let sum = |v: &[f64], k: usize| -> f64 {
            scene.masses.iter().enumerate().map(|(i, m)| m * v[3 * i + k]).sum()
        };
        let energy = |v: &[f64]| -> f64 {
            v.iter().enumerate().map(|(i, v)| 0.5 * scene.masses[i / 3] * v * v).sum()
        };
        let (before, start) = ([0, 1, 2].map(|k| sum(&v.0, k)), energy(&v.0));
        let report = filter.filter(&scene.q, 1.0, v.view_mut()).unwrap();
        for (k, before) in before.into_iter().enumerate() {
            assert!((sum(&v.0, k) - before).abs() < 1e-12 * speed, "{speed} {report:?}");
        }
        assert!(energy(&v.0) <= start * (1.0 + 1e-12) && !report.held);
        // What was found free is free: filtered again, nothing changes.
        let again = v.clone();
        let second = filter.filter(&scene.q, 1.0, v.view_mut()).unwrap();
        assert_eq!((second.contacts, v), (0, again), "{speed}");
        assert!(speed < 1e3 || report.contacts > 0);
    }
}

#[test]
fn loose_triangles_thrown_at_each_other_are_stopped_or_move_as_one() {
    let mut random = SplitMix64::new(12);
    let mut zoned = [0; 2];
    for k in 0..40 {
        let rounds = [0, 20][k % 2];
        let (mut q, mut triangles) = (Vec::new(), Vec::new());
        for k in 0..8_usize {
            let centre = [0, 1, 2].map(|axis| (k >> axis & 1) as f64);
            for _ in 0..3 {
                q.extend(centre.map(|c| c + 0.4 * random.symmetric()));
            }
            triangles.push([3 * k, 3 * k + 1, 3 * k + 2]);
        }
        let filter = MeshFilter::new(vec![1.0; 24], vec![false; 24], triangles, 1e-9)
            .unwrap()
            .with_rounds(rounds);
        let mut v = Vector((0..72).map(|_| 3.0 * random.symmetric()).collect::<Vec<_>>());
        let report = filter.filter(&q, 1.0, v.view_mut()).unwrap();
        zoned[k % 2] += report.zoned;
        assert!(!report.held);
        let again = filter.filter(&q, 1.0, v.view_mut()).unwrap();
        assert_eq!(again.contacts, 0, "{report:?}");
    }
    assert!(
        zoned[0] > 100 && zoned[1] < 10,
        "projections leave little to the last resort: {zoned:?}"
    );
}

#[test]
fn meshes_that_make_no_sense_are_refused_by_name() {
    let three = || (vec![1.0; 3], vec![false; 3]);
    let new = |triangles: Vec<[usize; 3]>| {
        let (masses, pinned) = three();
        MeshFilter::new(masses, pinned, triangles, 1e-9).unwrap_err()
    };
    assert!(matches!(new(vec![[0, 1, 3]]), ContactError::NoSuchVertex { vertex: 3, .. }));
    assert!(matches!(new(vec![[0, 1, 1]]), ContactError::Flat { shape: "triangle" }));
    let error = MeshFilter::new(vec![1.0, -1.0], vec![false; 2], vec![], 1e-9).unwrap_err();
    assert!(matches!(error, ContactError::Mass { freedom: 3 }), "{error}");
    for tolerance in [f64::NAN, 0.0, -1.0, f64::INFINITY] {
        let (masses, pinned) = three();
        let error = MeshFilter::new(masses, pinned, vec![[0, 1, 2]], tolerance).unwrap_err();
        assert!(matches!(error, ContactError::Tolerance(_)), "{error}");
    }
    let (masses, pinned) = three();
    let filter = MeshFilter::new(masses, pinned, vec![[0, 1, 2]], 1e-9).unwrap();
    let q = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    for h in [f64::NAN, 0.0, -1.0, f64::INFINITY] {
        let error = filter.filter(&q, h, Vector(&mut [0.0; 9])).unwrap_err();
        assert!(matches!(error, ContactError::Step(_)), "{error}");
    }
}

/// A corner in the plane of a triangle has no side on which to stay; what is never met may lie there.
#[test]
fn what_starts_at_distance_0_is_refused_by_its_vertices_and_the_velocities_stay() {
    let filter = MeshFilter::new(vec![1.0; 4], vec![false; 4], vec![[1, 2, 3]], 1e-9).unwrap();
    let corner = |x: f64, z: f64| [x, 0.2, z, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    for speed in [2.0, -2.0, 1e-3] {
        let mut v = [0.0; 12];
        v[2] = speed;
        let before = v;
        let error = filter.filter(&corner(0.2, 0.0), 0.1, Vector(&mut v)).unwrap_err();
        assert!(matches!(error, ContactError::Touching { vertices: [0, 1, 2, 3] }), "{error}");
        assert_eq!(v, before);
        assert_eq!(filter.filter(&corner(1.2, 0.0), 0.1, Vector(&mut v)).unwrap().contacts, 0);
    }
    for height in [1e-12, -1e-12] {
        let (q, mut v) = (corner(0.2, height), [0.0; 12]);
        v[2] = -2.0 * height.signum();
        filter.filter(&q, 0.1, Vector(&mut v)).unwrap();
        assert!((height + 0.1 * (v[2] - v[5])) * height > 0.0, "{height} {v:?}");
    }
}
