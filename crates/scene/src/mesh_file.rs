//! Shapes from files beside the scene's.
//!
//! ```text
//! .msh      Gmsh's: its tetrahedra, or where there are none its triangles
//! others    OBJ: a surface in space
//! ```
//! Triangles all of which have z = 0 are a sheet in the plane where the scene is. Elements with
//! nodes in the middle of their edges have no shape here. Nothing outside the scene's folder is
//! opened.

use std::path::{Component, Path, PathBuf};

use stationary_mesh::{Mesh, MeshError, Msh, Simplex, read_msh, read_obj};
use toml::Spanned;

use crate::diagnostic::{Checked, Located, at};
use crate::shape::{Shape, block, sheet};
use crate::source::shortened;
use crate::{Fault, limits};

/// The mesh in a file beside the scene's.
pub(crate) fn loaded(
    dimension: usize,
    folder: Option<&Path>,
    file: &Spanned<String>,
) -> Checked<Shape> {
    let name = Path::new(file.get_ref());
    let is_msh = name.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("msh"));
    if dimension < if is_msh { 2 } else { 3 } {
        let fault = Fault::ShapeDimension { kind: "file".to_owned(), dimension };
        return Err(at(file.span(), fault));
    }
    let path = found(folder, file)?;
    if is_msh {
        let msh = read_msh(&path).map_err(|error| failed(file, error.to_string()))?;
        return of_msh(dimension, &msh, file);
    }
    let mesh = read_obj(&path).map_err(|error| failed(file, error.to_string()))?;
    shape(&mesh, file, sheet)
}

fn of_msh(dimension: usize, msh: &Msh, file: &Spanned<String>) -> Checked<Shape> {
    let of_file = |error: MeshError| failed(file, error.to_string());
    match msh.tetrahedra() {
        Ok(_) if dimension < 3 => {
            Err(failed(file, "its tetrahedra do not fit into the plane".to_owned()))
        }
        Ok(mesh) => shape(&mesh, file, block),
        Err(MeshError::Empty) => {
            let mesh = msh.triangles().map_err(of_file)?;
            if dimension == 3 {
                return shape(&mesh, file, sheet);
            }
            if mesh.vertices().iter().any(|x| x.z != 0.0) {
                return Err(failed(file, "its triangles are not in the plane z = 0".to_owned()));
            }
            shape(&mesh.mapped(|x| x.xy()).map_err(of_file)?, file, sheet)
        }
        Err(error) => Err(of_file(error)),
    }
}

/// The shape of a mesh without flaws.
fn shape<const D: usize, const K: usize>(
    mesh: &Mesh<D, K>,
    file: &Spanned<String>,
    make: impl FnOnce(&Mesh<D, K>) -> Result<Shape, MeshError>,
) -> Checked<Shape>
where
    [usize; K]: Simplex,
{
    let count = mesh.vertices().len() as u64;
    if count > limits::PARTICLES {
        let fault = Fault::TooMany { what: "particles", count, limit: limits::PARTICLES };
        return Err(at(file.span(), fault));
    }
    let whole = mesh.check_referenced().and_then(|()| mesh.check_nondegenerate());
    let upright = whole.and_then(|()| mesh.check_positive());
    upright.and_then(|()| make(mesh)).map_err(|error| failed(file, error.to_string()))
}

/// Where a file in the scene's folder is.
fn found(folder: Option<&Path>, file: &Spanned<String>) -> Checked<PathBuf> {
    let outside = || at(file.span(), Fault::OutsideFolder(shortened(file.get_ref())));
    let name = Path::new(file.get_ref());
    let inside = name.components().all(|part| matches!(part, Component::Normal(_)));
    let Some(folder) = folder.filter(|_| inside && !file.get_ref().is_empty()) else {
        return Err(outside());
    };
    let path = folder.join(name);
    let folder = if folder == Path::new("") { Path::new(".") } else { folder };
    let real = |path: &Path| path.canonicalize().map_err(|error| failed(file, error.to_string()));
    if !real(&path)?.starts_with(real(folder)?) {
        return Err(outside());
    }
    let bytes = path.metadata().map_err(|error| failed(file, error.to_string()))?;
    if !bytes.is_file() || bytes.len() > limits::MESH_BYTES {
        let why = format!("it is no file of at most {} bytes", limits::MESH_BYTES);
        return Err(failed(file, why));
    }
    Ok(path)
}

fn failed(file: &Spanned<String>, why: String) -> Box<Located> {
    at(file.span(), Fault::MeshFile { file: shortened(file.get_ref()), why })
}
