//! Shapes from files beside the scene's.
//!
//! ```text
//! .msh      Gmsh's: its tetrahedra, or where there are none its triangles
//! others    OBJ: a surface in space
//! ```
//! Triangles all of which have z = 0 are a sheet in the plane where the scene is. Where quadratic
//! elements are asked for, those of a file are read as they are, and straight ones get nodes halfway
//! along their edges.

use std::path::Path;

use nalgebra::Vector3;
use stationary_mesh::{Mesh, MeshError, Msh, Quadratic, Simplex, Tagged, read_msh, read_obj};
use toml::Spanned;

use crate::text::beside::{failed, found};
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::text::limits;
use crate::words::laid_shape::{Element, Shape, block, sheet};
use crate::words::quadratic_shape::{curved_block, curved_sheet};

/// The mesh in a file beside the scene's.
pub(crate) fn loaded(
    dimension: usize,
    element: Element,
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
        return of_msh(dimension, element, &msh, file);
    }
    let obj = read_obj(&path).map_err(|error| failed(file, error.to_string()))?;
    surface(&obj.mesh, element, file)
}

fn of_msh(dimension: usize, element: Element, msh: &Msh, file: &Spanned<String>) -> Checked<Shape> {
    let of_file = |error: MeshError| failed(file, error.to_string());
    if element == Element::Quadratic {
        if let Some(elements) = there(msh.quadratic_tetrahedra(), file)? {
            check_space(dimension, file)?;
            return curved(&elements, file, curved_block);
        }
        if let Some(elements) = there(msh.quadratic_triangles(), file)? {
            if dimension == 3 {
                return curved(&elements, file, curved_sheet);
            }
            check_plane(elements.nodes(), file)?;
            return curved(&elements.mapped(|x| x.xy()).map_err(of_file)?, file, curved_sheet);
        }
    }
    if let Some(mesh) = there(msh.tetrahedra(), file)? {
        check_space(dimension, file)?;
        return match element {
            Element::Linear => shape(&mesh, file, block),
            Element::Quadratic => {
                shape(&mesh, file, |mesh| curved_block(&Quadratic::straight(mesh)))
            }
        };
    }
    let middles = msh.quadratic_tetrahedra().is_ok() || msh.quadratic_triangles().is_ok();
    match msh.triangles().map(|triangles| triangles.mesh) {
        Ok(mesh) if dimension == 3 => surface(&mesh, element, file),
        Ok(mesh) => {
            check_plane(mesh.vertices(), file)?;
            surface(&mesh.mapped(|x| x.xy()).map_err(of_file)?, element, file)
        }
        Err(MeshError::Empty) if middles => Err(at(file.span(), Fault::QuadraticMesh)),
        Err(error) => Err(of_file(error)),
    }
}

/// Elements of a kind, where the file has some.
fn there<T>(elements: Result<Tagged<T>, MeshError>, file: &Spanned<String>) -> Checked<Option<T>> {
    match elements {
        Ok(elements) => Ok(Some(elements.mesh)),
        Err(MeshError::Empty) => Ok(None),
        Err(error) => Err(failed(file, error.to_string())),
    }
}

fn check_space(dimension: usize, file: &Spanned<String>) -> Checked<()> {
    if dimension == 3 {
        return Ok(());
    }
    Err(failed(file, "its tetrahedra do not fit into the plane".to_owned()))
}

fn check_plane(places: &[Vector3<f64>], file: &Spanned<String>) -> Checked<()> {
    if places.iter().all(|x| x.z == 0.0) {
        return Ok(());
    }
    Err(failed(file, "its triangles are not in the plane z = 0".to_owned()))
}

fn surface<const D: usize>(
    mesh: &Mesh<D, 3>,
    element: Element,
    file: &Spanned<String>,
) -> Checked<Shape> {
    match element {
        Element::Linear => shape(mesh, file, sheet),
        Element::Quadratic => shape(mesh, file, |mesh| curved_sheet(&Quadratic::straight(mesh))),
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
    check_count(mesh.vertices().len(), file)?;
    let whole = mesh.check_referenced().and_then(|()| mesh.check_nondegenerate());
    let upright = whole.and_then(|()| mesh.check_positive());
    upright.and_then(|()| make(mesh)).map_err(|error| failed(file, error.to_string()))
}

/// The shape of curved elements without flaws.
fn curved<const D: usize, const K: usize, const N: usize>(
    elements: &Quadratic<D, K, N>,
    file: &Spanned<String>,
    make: impl FnOnce(&Quadratic<D, K, N>) -> Result<Shape, MeshError>,
) -> Checked<Shape>
where
    [usize; K]: Simplex,
{
    check_count(elements.nodes().len(), file)?;
    let whole = elements.corners().check_nondegenerate();
    let upright = whole.and_then(|()| elements.check_positive());
    upright.and_then(|()| make(elements)).map_err(|error| failed(file, error.to_string()))
}

fn check_count(vertices: usize, file: &Spanned<String>) -> Checked<()> {
    let count = vertices as u64;
    if count <= limits::PARTICLES {
        return Ok(());
    }
    let fault = Fault::TooMany { what: "particles", count, limit: limits::PARTICLES };
    Err(at(file.span(), fault))
}
