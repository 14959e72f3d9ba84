//! One polynomial, one evaluation, one inner product, in two bases: what changes and what does not.
//!
//! `cargo run -p stationary-calculus --example change_of_basis`

use nalgebra::{DMatrix, dmatrix};
use stationary_calculus::{BilinearForm, ChangeOfBasis, Covector, LinearTransformation, Vector};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The columns: x^2 - 1, x + 1 and x - 1 in the basis 1, x, x^2 (notes 1.1).
    let t = ChangeOfBasis::new(dmatrix![-1.0, 1.0, -1.0; 0.0, 1.0, 1.0; 1.0, 0.0, 0.0])?;
    let v = Vector(vec![1.0, -2.0, 1.0]);
    let nu = Covector(vec![1.0, 2.0, 4.0]);
    let g = BilinearForm(DMatrix::from_fn(3, 3, |i, j| 1.0 / (i + j + 1) as f64));
    let (v_new, nu_new, g_new) = (t.vector(&v)?, t.covector(&nu)?, t.form(&g)?);

    println!("                              in 1, x, x^2      in x^2 - 1, x + 1, x - 1");
    println!("x^2 - 2x + 1, a vector        {:<16}  {:?}", format!("{:?}", v.0), v_new.0);
    println!("value at 2, a covector        {:<16}  {:?}", format!("{:?}", nu.0), nu_new.0);
    println!("its value at 2, natural       {:<16}  {}", nu.apply(&v), nu_new.apply(&v_new));
    let squares = [g.apply(&v, &v)?, g_new.apply(&v_new, &v_new)?];
    println!("its square over [0, 1]        {:<16.6}  {:.6}", squares[0], squares[1]);
    let transposed = t.covector(&Covector(v.0.clone()))?;
    println!("the column v laid on its side {:<16}  {:?}", format!("{:?}", v.0), transposed.0);
    println!("                              a pairing of vectors with covectors by transposing");
    println!("                              depends on the basis; only a metric pairs them.\n");

    // -(x (1 - x) v')' in the basis 1, x, x^2: self-adjoint, with a matrix that is not symmetric.
    let m = LinearTransformation(dmatrix![0.0, -1.0, 0.0; 0.0, 2.0, -4.0; 0.0, 0.0, 6.0]);
    println!("v -> -(x (1 - x) v')' is self-adjoint: {}", m.is_self_adjoint(&g)?);
    let pairs = m.eigenpairs(&g)?;
    let tidy = |x: f64| (1e4 * x).round() / 1e4 + 0.0;
    for (lambda, v) in pairs.values.iter().zip(pairs.vectors.column_iter()) {
        println!(
            "  eigenvalue {:.3}: {:+.4} {:+.4} x {:+.4} x^2",
            tidy(*lambda),
            tidy(v[0]),
            tidy(v[1]),
            tidy(v[2])
        );
    }
    println!("  the Legendre polynomials of [0, 1], of unit length\n");

    // Two balls on a line (notes 0.1): centre p = (c1 + c2)/2 and separation s = c2 - c1.
    let t = ChangeOfBasis::new(dmatrix![1.0, -0.5; 1.0, 0.5])?;
    let mass = t.form(&BilinearForm(dmatrix![2.0, 0.0; 0.0, 2.0]))?.0;
    println!("two balls of 2 kg by centre and separation weigh{mass}total and reduced mass");
    Ok(())
}
