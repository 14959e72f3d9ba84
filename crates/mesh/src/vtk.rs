//! Writing meshes with what was computed on them, for ParaView: legacy VTK files in ASCII.
//!
//! ```text
//! # vtk DataFile Version 3.0          points, cells, numbers and vectors at the points
//! ```
//! Points of fewer than three coordinates get zeros for the others. Numbers are written so that they
//! read back to the last bit. Our quadratic elements number their nodes as VTK does: corners first,
//! then the edges in the order of [`Simplex::EDGES`](crate::Simplex). A writer of its own, because the
//! format is thirty lines and the crates that read it bring a parser along.
//! Source: VTK File Formats (Kitware).

use std::io::{self, Write};

/// What is known at the points of a mesh. Names are single words to VTK: spaces become underscores.
#[derive(Clone, Copy, Debug)]
pub enum VtkField<'a, const D: usize> {
    /// A number at each point.
    Numbers(&'a str, &'a [f64]),
    /// A vector at each point.
    Vectors(&'a str, &'a [[f64; D]]),
}

/// The type of a cell by its dimension and its number of nodes.
const fn cell_type(nodes: usize) -> Option<u8> {
    match nodes {
        2 => Some(3),
        3 => Some(5),
        4 => Some(10),
        6 => Some(22),
        10 => Some(24),
        _ => None,
    }
}

/// Writes points and cells of `N` nodes each: 2 for segments, 3 and 6 for triangles, 4 and 10 for
/// tetrahedra.
///
/// # Errors
/// Of the writer; and of kind [`io::ErrorKind::InvalidInput`] where a cell names no point, and where a
/// field has no name or not one value for each point.
pub fn write_vtk<const D: usize, const N: usize>(
    mut out: impl Write,
    title: &str,
    points: &[[f64; D]],
    cells: &[[usize; N]],
    fields: &[VtkField<'_, D>],
) -> io::Result<()> {
    const {
        assert!(D >= 1 && D <= 3, "points have one, two or three coordinates");
        assert!(cell_type(N).is_some(), "segments, triangles and tetrahedra");
    }
    check(points.len(), cells, fields)?;
    let title: String = title.chars().filter(|c| !c.is_control()).take(255).collect();
    writeln!(out, "# vtk DataFile Version 3.0\n{title}\nASCII\nDATASET UNSTRUCTURED_GRID")?;
    writeln!(out, "POINTS {} double", points.len())?;
    points.iter().try_for_each(|point| write_vector(&mut out, point))?;
    writeln!(out, "CELLS {} {}", cells.len(), cells.len() * (N + 1))?;
    for cell in cells {
        write!(out, "{N}")?;
        cell.iter().try_for_each(|node| write!(out, " {node}"))?;
        writeln!(out)?;
    }
    writeln!(out, "CELL_TYPES {}", cells.len())?;
    let kind = cell_type(N).unwrap_or(0);
    cells.iter().try_for_each(|_| writeln!(out, "{kind}"))?;
    if !fields.is_empty() {
        writeln!(out, "POINT_DATA {}", points.len())?;
    }
    for field in fields {
        match field {
            VtkField::Numbers(name, numbers) => {
                writeln!(out, "SCALARS {} double 1\nLOOKUP_TABLE default", word(name))?;
                numbers.iter().try_for_each(|number| writeln!(out, "{number:?}"))?;
            }
            VtkField::Vectors(name, vectors) => {
                writeln!(out, "VECTORS {} double", word(name))?;
                vectors.iter().try_for_each(|vector| write_vector(&mut out, vector))?;
            }
        }
    }
    out.flush()
}

fn check<const D: usize, const N: usize>(
    points: usize,
    cells: &[[usize; N]],
    fields: &[VtkField<'_, D>],
) -> io::Result<()> {
    let invalid = |what: String| Err(io::Error::new(io::ErrorKind::InvalidInput, what));
    for (number, cell) in cells.iter().enumerate() {
        if let Some(node) = cell.iter().find(|&&node| node >= points) {
            return invalid(format!("cell {number} names point {node}; there are {points}"));
        }
    }
    for (number, field) in fields.iter().enumerate() {
        let (name, values) = match field {
            VtkField::Numbers(name, numbers) => (name, numbers.len()),
            VtkField::Vectors(name, vectors) => (name, vectors.len()),
        };
        // What comes after it would be read as its name.
        if word(name).is_empty() {
            return invalid(format!("field {number} has no name"));
        }
        if values != points {
            return invalid(format!("{name} has {values} values for {points} points"));
        }
    }
    Ok(())
}

fn word(name: &str) -> String {
    name.split_whitespace().collect::<Vec<_>>().join("_")
}

fn write_vector<const D: usize>(out: &mut impl Write, vector: &[f64; D]) -> io::Result<()> {
    let at = |c: usize| vector.get(c).copied().unwrap_or(0.0);
    writeln!(out, "{:?} {:?} {:?}", at(0), at(1), at(2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{QuadraticTriangles, disc};

    #[test]
    fn a_triangle_is_written_as_vtk_reads_it() {
        let points = [[0.0, 0.0], [1.0, 0.0], [0.1, 1e-300]];
        let fields = [
            VtkField::Numbers("energy density", &[1.0, f64::NAN, -0.0]),
            VtkField::Vectors("u", &points),
        ];
        let mut text = Vec::new();
        write_vtk(&mut text, "one\ntriangle", &points, &[[0, 1, 2]], &fields).unwrap();
        let vectors = "0.0 0.0 0.0\n1.0 0.0 0.0\n0.1 1e-300 0.0\n";
        let expected = format!(
            "# vtk DataFile Version 3.0\nonetriangle\nASCII\nDATASET UNSTRUCTURED_GRID\n\
             POINTS 3 double\n{vectors}CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n5\nPOINT_DATA 3\n\
             SCALARS energy_density double 1\nLOOKUP_TABLE default\n1.0\nNaN\n-0.0\n\
             VECTORS u double\n{vectors}"
        );
        assert_eq!(String::from_utf8(text).unwrap(), expected);
    }

    #[test]
    fn middles_of_edges_follow_the_corners_in_the_order_of_vtk() {
        let round = QuadraticTriangles::straight(&disc(1.0, 2).unwrap());
        for nodes in round.elements() {
            // VTK's quadratic triangle: 0, 1, 2, then between 0 and 1, 1 and 2, 2 and 0.
            for (k, [a, b]) in [[0, 1], [1, 2], [2, 0]].into_iter().enumerate() {
                let middle = (round.nodes()[nodes[a]] + round.nodes()[nodes[b]]) * 0.5;
                assert!((round.nodes()[nodes[3 + k]] - middle).norm() < 1e-15);
            }
        }
    }

    #[test]
    fn what_is_not_of_the_mesh_is_refused() {
        let points = [[0.0; 3]; 4];
        let refused = |cells: &[[usize; 4]], fields: &[VtkField<'_, 3>]| {
            write_vtk(Vec::new(), "", &points, cells, fields).unwrap_err().to_string()
        };
        let error = refused(&[[0, 1, 2, 3], [0, 1, 2, 4]], &[]);
        assert_eq!(error, "cell 1 names point 4; there are 4");
        let error = refused(&[[0, 1, 2, 3]], &[VtkField::Numbers("p", &[1.0; 3])]);
        assert_eq!(error, "p has 3 values for 4 points");
        let error = refused(&[[0, 1, 2, 3]], &[VtkField::Numbers(" \t", &[1.0; 4])]);
        assert_eq!(error, "field 0 has no name");
    }
}
