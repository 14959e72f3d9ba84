//! The mass matrix, by the inertias of branches as rigid bodies.
//!
//! ```text
//! I = own + sum of the children's I, shifted           a branch, all its joints held
//! f = I s_k,     M_jk = s_j^T X^T ... X^T f             down the way from k to the root
//! ```
//! `T = 1/2 v^T M v`. Entries of joints of which neither is on the other's way are zero: time grows
//! with the bodies times the depth. Source: Walker and Orin 1982; Featherstone 2008, 6.2.

use stationary_calculus::SizeError;

use super::error::{TreeError, check_numbers};
use super::motion::TreeMotion;

impl TreeMotion {
    /// Writes the mass matrix, n x n; it is symmetric.
    ///
    /// # Errors
    /// Another size, numbers that are not finite.
    pub fn mass_matrix(&mut self, matrix: &mut [f64]) -> Result<(), TreeError> {
        let n = self.columns.len();
        SizeError::check("the mass matrix's numbers", n * n, matrix.len())?;
        matrix.fill(0.0);
        self.set_inertias();
        for body in (0..self.placed.len()).rev() {
            let link = &self.tree.links[body];
            let inertia = self.inertias[body];
            for k in link.speeds.clone() {
                let mut f = inertia.times(&self.columns[k]);
                let mut on_the_way = Some(body);
                while let Some(at) = on_the_way {
                    let link = &self.tree.links[at];
                    for j in link.speeds.clone() {
                        let entry = f.along(&self.columns[j]);
                        matrix[j + n * k] = entry;
                        matrix[k + n * j] = entry;
                    }
                    f = f.inward(&self.placed[at].offset());
                    on_the_way = link.parent;
                }
            }
            if let Some(parent) = link.parent {
                self.inertias[parent].add_inward(&inertia, &self.placed[body].offset());
            }
        }
        check_numbers("the mass matrix", n * n, matrix)
    }
}
