//! NAFEMS LE1: the stress at the corner of an elliptic membrane, with two families of triangles.
//!
//! `cargo run --example elliptic_membrane -p stationary-elasticity`

use stationary_elasticity::problems::{LE1_STRESS, SheetFamily, elliptic_membrane_stress};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("sigma_yy at (2, 0); NAFEMS gives {:.1} MPa", 1e-6 * LE1_STRESS);
    println!("{:>10} {:>10} {:>12} {:>10}", "triangles", "freedoms", "MPa", "error");
    for family in [SheetFamily::Linear, SheetFamily::Quadratic] {
        for n in [4, 8, 16] {
            let sheet = elliptic_membrane_stress(family, [2 * n, 3 * n])?;
            println!(
                "{:>10} {:10} {:12.2} {:9.2} %",
                format!("{family:?}").to_lowercase(),
                sheet.freedoms,
                1e-6 * sheet.value,
                100.0 * (sheet.value / LE1_STRESS - 1.0)
            );
        }
    }
    Ok(())
}
