use super::*;
use crate::Sink;
use nalgebra::DMatrix;

type Blocks = Vec<(Vec<usize>, Vec<f64>)>;

/// Where the unknowns of a chain are numbered.
#[derive(Clone, Copy, Debug)]
enum Numbering {
    LinkByLink,
    MultipliersLast,
    MultipliersFirst,
}

/// The saddle system of a planar chain of n links: unit masses, and for each link a row of
/// the constraint's differential, `2 (x_i - x_(i-1))`, with zeros on its diagonal.
fn chain(n: usize, numbering: Numbering) -> Blocks {
    let number = |link: usize, c: usize| match numbering {
        Numbering::LinkByLink => 3 * link + c,
        Numbering::MultipliersLast if c == 2 => 2 * n + link,
        Numbering::MultipliersLast => 2 * link + c,
        Numbering::MultipliersFirst if c == 2 => link,
        Numbering::MultipliersFirst => n + 2 * link + c,
    };
    let mut blocks = Vec::new();
    for link in 0..n {
        let angle = 0.3 * link as f64;
        let d = [2.0 * angle.cos(), 2.0 * angle.sin()];
        let lambda = number(link, 2);
        for (c, &d) in d.iter().enumerate() {
            blocks.push((vec![number(link, c)], vec![1.0]));
            blocks.push((vec![number(link, c), lambda], vec![0.0, d, d, 0.0]));
            if link > 0 {
                let before = number(link - 1, c);
                blocks.push((vec![before, lambda], vec![0.0, -d, -d, 0.0]));
            }
        }
    }
    blocks
}

fn assembled(n: usize, blocks: &Blocks) -> (SymmetricMatrix, SparseIndefinite) {
    let matrix = SymmetricMatrix::from_blocks(n, blocks).unwrap();
    let solver = SparseIndefinite::analyse(&matrix).unwrap();
    (matrix, solver)
}

fn relative_residual(matrix: &SymmetricMatrix, x: &[f64], b: &[f64]) -> f64 {
    let mut residual = b.to_vec();
    matrix.add_product(-1.0, x, &mut residual).unwrap();
    let largest = |x: &[f64]| largest_or_nan(x.iter().map(|x| x.abs()));
    largest(&residual) / largest(b)
}

#[test]
fn chains_are_solved_however_they_are_numbered() {
    for links in [1, 2, 30, 1000] {
        for numbering in
            [Numbering::LinkByLink, Numbering::MultipliersLast, Numbering::MultipliersFirst]
        {
            let n = 3 * links;
            let (matrix, mut solver) = assembled(n, &chain(links, numbering));
            let pivoting = solver.factor(&matrix).unwrap();
            let b: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
            let mut x = b.clone();
            let refined = solver.solve(&matrix, &mut x).unwrap();
            assert_eq!(pivoting, Pivoting::Symmetric, "{links} {numbering:?}");
            assert!(relative_residual(&matrix, &x, &b) < 1e-13);
            assert!(refined.relative_residual < 1e-13);
        }
    }
}

#[test]
fn the_solution_agrees_with_a_dense_one() {
    let (n, blocks) = (30, chain(10, Numbering::LinkByLink));
    let (matrix, mut solver) = assembled(n, &blocks);
    solver.factor(&matrix).unwrap();
    let mut dense = DMatrix::<f64>::zeros(n, n);
    for (freedoms, entries) in &blocks {
        for (k, entry) in entries.iter().enumerate() {
            let (i, j) = (freedoms[k % freedoms.len()], freedoms[k / freedoms.len()]);
            dense[(i, j)] += entry;
        }
    }
    let inverse = dense.try_inverse().unwrap();
    for j in 0..n {
        let mut x = vec![0.0; n];
        x[j] = 1.0;
        solver.solve(&matrix, &mut x).unwrap();
        for (x, exact) in x.iter().zip(inverse.column(j).iter()) {
            assert!((x - exact).abs() < 1e-12);
        }
    }
}

#[test]
fn a_zero_diagonal_is_no_obstacle() {
    for n in [2, 200] {
        // Pairs that only know each other: [0 k; k 0].
        let blocks: Blocks = (0..n / 2)
            .map(|i| (vec![i, n - 1 - i], vec![0.0, 1.0 + i as f64, 1.0 + i as f64, 0.0]))
            .collect();
        let (matrix, mut solver) = assembled(n, &blocks);
        solver.factor(&matrix).unwrap();
        let mut x: Vec<f64> = (0..n).map(|i| 1.0 + i as f64).collect();
        solver.solve(&matrix, &mut x).unwrap();
        for (i, x) in x.iter().take(n / 2).enumerate() {
            assert!((x * (1.0 + i as f64) - (n - i) as f64).abs() < 1e-12);
        }
    }
}

#[test]
fn where_exchanges_inside_of_panels_break_down_any_rows_are_exchanged() {
    // Random matrices with nothing on the diagonal.
    let mut state = 1_u64;
    let mut random = |bound: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 33) as usize % bound
    };
    let mut rows = 0;
    for _ in 0..100 {
        let n = 10 + random(50);
        let mut blocks = Blocks::new();
        for i in 0..2 * n {
            let (i, j) = (i % n, (i + 1 + random(n - 1)) % n);
            if i != j {
                let entry = random(1000) as f64 / 500.0 - 1.0;
                blocks.push((vec![i, j], vec![0.0, entry, entry, 0.0]));
            }
        }
        let (matrix, mut solver) = assembled(n, &blocks);
        match solver.factor(&matrix) {
            Ok(Pivoting::Symmetric) => {}
            Ok(Pivoting::Rows) => rows += 1,
            Err(error) => {
                assert_eq!(error, SparseError::Singular);
                continue;
            }
        }
        let mut x = vec![1.0; n];
        match solver.solve(&matrix, &mut x) {
            Ok(_) => assert!(relative_residual(&matrix, &x, &vec![1.0; n]) <= TRUSTED),
            Err(SparseError::Untrusted { relative_residual }) => {
                assert!(relative_residual > TRUSTED);
            }
            Err(error) => panic!("{error}"),
        }
    }
    assert!(rows > 50, "{rows}");
}

/// Right sides near the smallest numbers, whose residual is a few of these.
#[test]
fn right_sides_without_all_their_digits_are_solved() {
    let (n, blocks) = (30, chain(10, Numbering::LinkByLink));
    let (matrix, mut solver) = assembled(n, &blocks);
    solver.factor(&matrix).unwrap();
    for size in [1e-300, 1e-310, 1e-320, 5e-324] {
        let mut x: Vec<f64> = (0..n).map(|i| size * (i as f64).cos()).collect();
        solver.solve(&matrix, &mut x).unwrap();
        assert!(x.iter().all(|x| x.abs() < 1e5 * size), "{x:?}");
    }
}

#[test]
fn singular_systems_are_refused() {
    // A constraint listed twice, a chain of springs that nothing holds, an unknown without a row.
    let mut twice = chain(5, Numbering::LinkByLink);
    for (freedoms, entries) in twice.clone() {
        if freedoms.len() == 2 && freedoms[1] == 8 {
            twice.push((vec![freedoms[0], 15], entries));
        }
    }
    let free: Blocks = (0..15).map(|i| (vec![i, i + 1], vec![0.1, -0.1, -0.1, 0.1])).collect();
    let empty: Blocks = (0..15).map(|i| (vec![i], vec![1.0])).collect();
    for blocks in [twice, free, empty] {
        let (matrix, mut solver) = assembled(16, &blocks);
        assert_eq!(solver.factor(&matrix), Err(SparseError::Singular));
    }
}

#[test]
fn what_is_not_solved_is_refused_and_left_as_it_was() {
    let (matrix, mut solver) = assembled(15, &chain(5, Numbering::LinkByLink));
    let mut b = [1.0; 15];
    let error = solver.solve(&matrix, &mut b).unwrap_err();
    assert_eq!(error, SparseError::NotFactored);
    assert_eq!(b, [1.0; 15]);
}

#[test]
fn numbers_that_are_not_finite_never_pass() {
    let mut blocks = chain(5, Numbering::LinkByLink);
    blocks[4].1[0] = f64::NAN;
    let (matrix, mut solver) = assembled(15, &blocks);
    assert_eq!(solver.factor(&matrix), Err(SparseError::NonFinite));
    let (matrix, mut solver) = assembled(15, &chain(5, Numbering::LinkByLink));
    solver.factor(&matrix).unwrap();
    let error = solver.solve(&matrix, &mut [f64::NAN; 15]).unwrap_err();
    assert!(matches!(error, SparseError::Untrusted { .. }));
}

/// A saddle matrix of entries whose products leave the range of numbers.
#[test]
fn entries_of_any_size_are_solved() {
    for scale in [1e-290, 1e-170, 1e170, 1e290] {
        let mut blocks = chain(30, Numbering::LinkByLink);
        blocks.iter_mut().flat_map(|(_, entries)| entries).for_each(|entry| *entry *= scale);
        let (matrix, mut solver) = assembled(90, &blocks);
        solver.factor(&matrix).unwrap();
        let b: Vec<f64> = (0..90).map(|i| (i as f64).cos()).collect();
        let mut x = b.clone();
        solver.solve(&matrix, &mut x).unwrap();
        assert!(relative_residual(&matrix, &x, &b) < 1e-12, "{scale}");
    }
}

#[test]
fn a_solution_with_a_matrix_of_another_analysis_is_refused() {
    let (matrix, mut solver) = assembled(30, &chain(10, Numbering::LinkByLink));
    solver.factor(&matrix).unwrap();
    for links in [9, 10, 11] {
        let (other, _) = assembled(3 * links, &chain(links, Numbering::LinkByLink));
        for n in [30, 3 * links] {
            let mut b = vec![1.0; n];
            assert_eq!(solver.solve(&other, &mut b), Err(SparseError::OtherPattern));
            assert_eq!(b, vec![1.0; n]);
        }
    }
    assert!(solver.solve(&matrix, &mut [1.0; 30]).is_ok());
}

/// Matrices of whole numbers whose last row is a sum of multiples of the others. Rounding leaves some of them
/// a last pivot and finds a vector again: the first is one of these.
#[test]
fn singular_matrices_of_whole_numbers_are_refused() {
    let mut state = 5_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 33) as i64 % 10 - 5
    };
    let luck = [-8, -2, 9, 0, 3, -9].map(|entry| entry as f64 * 2.0_f64.powi(-849));
    let mut cases = vec![luck];
    for _ in 0..20_000 {
        let (a, b, c, u, v) = (random(), random(), random(), random(), random());
        let (d, e) = (a * u + b * v, b * u + c * v);
        cases.push([a, b, d, c, e, d * u + e * v].map(|entry| entry as f64));
    }
    let whole = |[a, b, d, c, e, f]: [f64; 6]| vec![a, b, d, b, c, e, d, e, f];
    let (mut matrix, mut solver) = assembled(3, &vec![(vec![0, 1, 2], whole(luck))]);
    for case in cases {
        matrix.refill(|sink| sink.add_symmetric(&[0, 1, 2], &whole(case))).unwrap();
        assert_eq!(solver.factor(&matrix), Err(SparseError::Singular), "{case:?}");
    }
}

/// `[1 1; 1 1 + x]`, whose inverse is `[1 + x, -1; -1, 1]/x`.
#[test]
fn what_rounding_moves_is_estimated_and_decides_what_is_singular() {
    let block = |x: f64| vec![1.0, 1.0, 1.0, 1.0 + x];
    let (mut matrix, mut solver) = assembled(2, &vec![(vec![0, 1], block(1.0))]);
    for exponent in [-3, -10, -30, -36, -46, -50] {
        let x = 2.0_f64.powi(exponent);
        matrix.refill(|sink| sink.add_symmetric(&[0, 1], &block(x))).unwrap();
        // |A| v, and the largest component of |A^-1| |A| v.
        let terms = [known(0) + known(1), known(0) + (1.0 + x) * known(1)];
        let exact = f64::EPSILON * ((1.0 + x) * terms[0] + terms[1]) / x;
        let factored = solver.factor(&matrix);
        assert_eq!(factored.is_ok(), exact < FOUND_AGAIN, "{exponent}: {factored:?}");
        if let Ok(pivoting) = factored {
            let moved = solver.moved_by_rounding(pivoting, &matrix);
            assert!((moved / exact - 1.0).abs() < 1e-3, "{exponent}: {moved} of {exact}");
        }
    }
}

/// A saddle matrix of condition 32, in whose `L B L^T` entries of L grow to 1e8.
#[test]
fn a_solution_that_exchanges_in_panels_leave_untrusted_is_found_by_exchanges_of_any_rows() {
    let entries = [
        (0, 0, -0.679_445_147_846_913_2),
        (1, 0, 0.940_827_517_994_546_7),
        (1, 1, 1.986_621_104_631_041_4),
        (2, 0, -0.122_878_654_207_780_88),
        (2, 2, 1.683_598_509_153_991_6),
        (3, 0, 0.102_353_202_747_826),
        (3, 3, 1.606_008_483_522_287),
        (4, 4, 1.318_727_022_460_414_6),
        (5, 4, -0.982_753_708_937_529_6),
        (6, 0, -0.531_704_160_088_819_7),
        (6, 1, 0.399_244_808_567_571_7),
        (6, 2, 0.738_791_709_930_658),
        (7, 1, 0.874_698_012_380_167_1),
        (7, 2, 0.814_510_190_280_998_1),
        (7, 4, -0.865_359_161_099_435_6),
    ];
    let blocks: Blocks = entries.map(|(i, j, a)| entry(i, j, a)).to_vec();
    let (matrix, mut solver) = assembled(8, &blocks);
    assert_eq!(solver.factor(&matrix), Ok(Pivoting::Symmetric));
    let given = [-0.91, 0.56, 0.26, 0.12, -0.54, -0.71, 0.83, 0.02];
    for _ in 0..2 {
        let mut b = given;
        solver.solve(&matrix, &mut b).unwrap();
        assert!(relative_residual(&matrix, &b, &given) < 1e-14);
    }
    assert!(solver.known_vector_error() < 1e-12);
}

/// A block of one entry and its mirror.
fn entry(i: usize, j: usize, a: f64) -> (Vec<usize>, Vec<f64>) {
    if i == j { (vec![i], vec![a]) } else { (vec![i, j], vec![0.0, a, a, 0.0]) }
}

#[test]
fn a_solution_too_large_for_a_number_is_refused_and_has_no_residual() {
    let (matrix, mut solver) = assembled(2, &vec![entry(0, 1, 1e-200)]);
    solver.factor(&matrix).unwrap();
    let mut b = [1e200, 1.0];
    let error = solver.solve(&matrix, &mut b).unwrap_err();
    assert_eq!(error, SparseError::Untrusted { relative_residual: f64::INFINITY });
    assert_eq!(b, [1e200, 1.0]);
}
