//! Reading surfaces from Wavefront OBJ files, through the crate tobj.
//!
//! ```text
//! v x y z            a vertex                    f a b c ...        a polygon, cut into a fan
//! ```
//! All groups and objects become one mesh; materials, normals and texture coordinates are left
//! out. Vertices at the same place become one, because exporters repeat them for the sake of
//! normals and groups, and a surface that repeats them is open. A file is not trusted: at most
//! 256 MB are read, and the mesh is checked as any other.

use std::collections::HashMap;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

use nalgebra::Vector3;

use crate::mesh::Mesh;
use crate::{MOST_SIMPLICES, MeshError};

/// A file that holds no mesh.
#[derive(Debug, thiserror::Error)]
pub enum ObjError {
    /// The file cannot be opened.
    #[error("{}: {source}", path.display())]
    Open {
        /// Which file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The text is no OBJ file.
    #[error("not an OBJ file: {0}")]
    Parse(#[from] tobj::LoadError),
    /// What it holds is no mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The file is longer than a mesh may be.
    #[error("the file is longer than {limit} bytes")]
    TooLong {
        /// The limit.
        limit: u64,
    },
}

/// The longest file that is read.
const LONGEST: u64 = 256 << 20;

/// The surface in an OBJ file.
///
/// # Errors
/// [`ObjError`].
pub fn read_obj(path: impl AsRef<Path>) -> Result<Mesh<3, 3>, ObjError> {
    let path = path.as_ref();
    let open = |source| ObjError::Open { path: path.to_path_buf(), source };
    parse_obj(BufReader::new(File::open(path).map_err(open)?))
}

/// The surface in the text of an OBJ file.
///
/// # Errors
/// [`ObjError`], but for [`ObjError::Open`].
pub fn parse_obj(text: impl BufRead) -> Result<Mesh<3, 3>, ObjError> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..Default::default()
    };
    let mut bounded = text.take(LONGEST);
    let no_materials = |_: &Path| Ok(Default::default());
    let (models, _) = tobj::load_obj_buf(&mut bounded, &options, no_materials)?;
    if bounded.limit() == 0 {
        return Err(ObjError::TooLong { limit: LONGEST });
    }
    joined(&models)
}

/// All models as one mesh, vertices at the same place as one.
fn joined(models: &[tobj::Model]) -> Result<Mesh<3, 3>, ObjError> {
    let mut numbers = HashMap::new();
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for tobj::Model { mesh, .. } in models {
        let mut places = Vec::with_capacity(mesh.positions.len() / 3);
        for position in mesh.positions.chunks_exact(3) {
            // Adding zero makes one of the two zeros.
            let bits = [0, 1, 2].map(|c| (position[c] + 0.0).to_bits());
            let next = vertices.len();
            let number = *numbers.entry(bits).or_insert(next);
            if number == next {
                vertices.push(Vector3::new(position[0], position[1], position[2]));
            }
            places.push(number);
        }
        for triangle in mesh.indices.chunks_exact(3) {
            triangles.push([0, 1, 2].map(|k| places[triangle[k] as usize]));
        }
    }
    if triangles.len() > MOST_SIMPLICES {
        let (what, limit) = ("the file", MOST_SIMPLICES);
        return Err(MeshError::TooMany { what, limit }.into());
    }
    if triangles.is_empty() {
        return Err(MeshError::Empty.into());
    }
    Ok(Mesh::new(vertices, triangles)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ClosedSurface;

    /// A unit cube of six quadrilaterals in two groups, numbered from 1 and from the end.
    const CUBE: &str = "# a cube\no cube\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n\
        v 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nvn 0 0 1\ng one\nf 4 3 2 1\nf 5 6 7 8\n\
        f 1 2 6 5\ng two\nf 2 3 7 6\nf 3 4 8 7\nf -8 -4 -1 -5\n";

    #[test]
    fn a_cube_in_two_groups_is_one_closed_surface() {
        let mesh = parse_obj(CUBE.as_bytes()).unwrap();
        assert_eq!((mesh.vertices().len(), mesh.simplices().len()), (8, 12));
        let surface = ClosedSurface::new(mesh).unwrap();
        assert!((surface.moments().measure - 1.0).abs() < 1e-15);
    }

    #[test]
    fn coordinates_keep_all_their_digits() {
        let text = "v 0.1 1e-7 123456.789012345\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        let mesh = parse_obj(text.as_bytes()).unwrap();
        assert_eq!(mesh.vertices()[0], Vector3::new(0.1, 1e-7, 123456.789012345));
    }

    #[test]
    fn what_is_no_mesh_is_named() {
        let parse = |text: &str| parse_obj(text.as_bytes()).unwrap_err();
        assert!(matches!(parse("v 0 0 zero\nf 1 1 1\n"), ObjError::Parse(_)));
        assert!(matches!(parse("v 0 0 0\nf 1 2 3\n"), ObjError::Parse(_)));
        assert!(matches!(parse(""), ObjError::Mesh(MeshError::Empty)));
        assert!(matches!(parse("garbage \u{0}\u{1}"), ObjError::Mesh(_) | ObjError::Parse(_)));
        let nan = "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        assert!(matches!(parse(nan), ObjError::Mesh(MeshError::NonFinite { .. })));
        let needle = "v 0 0 0\nv 0 0 0\nv 0 1 0\nf 1 2 3\n";
        assert!(matches!(parse(needle), ObjError::Mesh(MeshError::RepeatedVertex(_))));
        let missing = read_obj("no/such/file.obj").unwrap_err();
        assert!(missing.to_string().starts_with("no/such/file.obj: "), "{missing}");
    }
}
