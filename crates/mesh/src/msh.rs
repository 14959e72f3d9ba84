//! Reading meshes from Gmsh's MSH files, versions 4.1 and 2.2, in text.
//!
//! ```text
//! $Nodes      tag x y z                 a node             (4.1: in blocks, tags before places)
//! $Elements   tag type ... nodes        an element of Gmsh's type 1 2 4 (segments, triangles,
//!                                       tetrahedra) or 8 9 11 (the same with middle nodes)
//! ```
//! Tags are any numbers; nodes are numbered anew in their order, and [`Tagged`] keeps their tags. Points (type 15) and
//! all other sections, physical groups among them, are left out. Gmsh numbers the last two edges of a
//! tetrahedron the other way round; that is put right here. A file is not trusted: at most 256 MB
//! are read, nothing is reserved for a number before the lines are there, and what is wrong is
//! named with its line. A reader of its own, because the crates that read the format bring parsers
//! of their own. Source: Gmsh reference manual, "MSH file format".

mod lines;
mod sections;

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};

use nalgebra::Vector3;

use crate::mesh::Mesh;
use crate::{MeshError, QuadraticSegments, QuadraticTetrahedra, QuadraticTriangles};

/// A file that is no MSH file, or none that is read.
#[derive(Debug, thiserror::Error)]
pub enum MshError {
    /// The file cannot be opened.
    #[error("{}: {source}", path.display())]
    Open {
        /// Which file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A line cannot be read.
    #[error("line {line}: {source}")]
    Read {
        /// Which line, from 1.
        line: usize,
        /// What the system says.
        source: io::Error,
    },
    /// The file is longer than a mesh may be.
    #[error("the file is longer than {limit} bytes")]
    TooLong {
        /// The limit.
        limit: u64,
    },
    /// Something else stands where the format has its place.
    #[error("line {line}: {expected} is expected, not {found}")]
    Unexpected {
        /// Which line, from 1.
        line: usize,
        /// What belongs there.
        expected: &'static str,
        /// What is there.
        found: String,
    },
    /// A version of the format that is not read.
    #[error("line {line}: version {version} of the format is not read, only 4.1 and 2.2 are")]
    Version {
        /// Which line, from 1.
        line: usize,
        /// The version.
        version: String,
    },
    /// A file of bytes instead of text.
    #[error("line {line}: the file is binary, only text is read")]
    Binary {
        /// Which line, from 1.
        line: usize,
    },
    /// Elements that are not read.
    #[error("line {line}: elements of type {kind} are not read, only 1, 2, 4, 8, 9 and 11 are")]
    ElementType {
        /// Which line, from 1.
        line: usize,
        /// Gmsh's number of the type.
        kind: u64,
    },
    /// An element names a node that there is not.
    #[error("line {line}: there is no node {tag}")]
    NoSuchNode {
        /// Which line, from 1.
        line: usize,
        /// The node's tag.
        tag: u64,
    },
    /// Two nodes of one tag.
    #[error("line {line}: there are two nodes {tag}")]
    RepeatedNode {
        /// Which line, from 1.
        line: usize,
        /// The node's tag.
        tag: u64,
    },
    /// A section has more or fewer members than it says.
    #[error("line {line}: the section has {found} {what}, but announces {announced}")]
    Count {
        /// Where the section ends, from 1.
        line: usize,
        /// Members of what kind.
        what: &'static str,
        /// How many it says.
        announced: u64,
        /// How many there are.
        found: u64,
    },
    /// A section comes twice, or before one that it rests on.
    #[error("line {line}: section {section} is out of place")]
    OutOfPlace {
        /// Which line, from 1.
        line: usize,
        /// The section.
        section: &'static str,
    },
    /// The nodes are in a section that is not read.
    #[error("line {line}: section $ParametricNodes is not read, only nodes in $Nodes are")]
    ParametricNodes {
        /// Which line, from 1.
        line: usize,
    },
    /// A section is not there.
    #[error("there is no section {section}")]
    Missing {
        /// The section.
        section: &'static str,
    },
}

/// What an MSH file holds: nodes in space, and elements of six kinds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Msh {
    nodes: Vec<Vector3<f64>>,
    tags: Vec<u64>,
    segments: Vec<[usize; 2]>,
    triangles: Vec<[usize; 3]>,
    tetrahedra: Vec<[usize; 4]>,
    quadratic_segments: Vec<[usize; 3]>,
    quadratic_triangles: Vec<[usize; 6]>,
    quadratic_tetrahedra: Vec<[usize; 10]>,
}

/// Elements of one kind, and what the file calls their nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Tagged<T> {
    /// The elements.
    pub mesh: T,
    /// The tag of each of their nodes, in the order of the nodes' numbers.
    pub tags: Vec<u64>,
}

/// Each kind of element with the nodes that it names, in their order, and no others. A mesh in the
/// plane is `mapped` there.
impl Msh {
    /// The segments.
    ///
    /// # Errors
    /// [`MeshError::Empty`] where there are none, and those of [`Mesh::new`].
    pub fn segments(&self) -> Result<Tagged<Mesh<3, 2>>, MeshError> {
        self.named(&self.segments, Mesh::new)
    }

    /// The triangles.
    ///
    /// # Errors
    /// [`MeshError::Empty`] where there are none, and those of [`Mesh::new`].
    pub fn triangles(&self) -> Result<Tagged<Mesh<3, 3>>, MeshError> {
        self.named(&self.triangles, Mesh::new)
    }

    /// The tetrahedra.
    ///
    /// # Errors
    /// [`MeshError::Empty`] where there are none, and those of [`Mesh::new`].
    pub fn tetrahedra(&self) -> Result<Tagged<Mesh<3, 4>>, MeshError> {
        self.named(&self.tetrahedra, Mesh::new)
    }

    /// The segments of three nodes.
    ///
    /// # Errors
    /// [`MeshError::Empty`] where there are none, and those of
    /// [`QuadraticSegments::new`](crate::Quadratic::new).
    pub fn quadratic_segments(&self) -> Result<Tagged<QuadraticSegments<3>>, MeshError> {
        self.named(&self.quadratic_segments, QuadraticSegments::new)
    }

    /// The triangles of six nodes.
    ///
    /// # Errors
    /// [`MeshError::Empty`] where there are none, and those of
    /// [`QuadraticTriangles::new`](crate::Quadratic::new).
    pub fn quadratic_triangles(&self) -> Result<Tagged<QuadraticTriangles<3>>, MeshError> {
        self.named(&self.quadratic_triangles, QuadraticTriangles::new)
    }

    /// The tetrahedra of ten nodes.
    ///
    /// # Errors
    /// [`MeshError::Empty`] where there are none, and those of
    /// [`QuadraticTetrahedra::new`](crate::Quadratic::new).
    pub fn quadratic_tetrahedra(&self) -> Result<Tagged<QuadraticTetrahedra<3>>, MeshError> {
        self.named(&self.quadratic_tetrahedra, QuadraticTetrahedra::new)
    }

    fn named<const N: usize, T>(
        &self,
        elements: &[[usize; N]],
        make: impl FnOnce(Vec<Vector3<f64>>, Vec<[usize; N]>) -> Result<T, MeshError>,
    ) -> Result<Tagged<T>, MeshError> {
        if elements.is_empty() {
            return Err(MeshError::Empty);
        }
        let mut numbers = vec![usize::MAX; self.nodes.len()];
        for &node in elements.as_flattened() {
            numbers[node] = 0;
        }
        let (mut nodes, mut tags) = (Vec::new(), Vec::new());
        let tagged = self.nodes.iter().zip(&self.tags);
        for (number, (node, tag)) in numbers.iter_mut().zip(tagged).filter(|(n, _)| **n == 0) {
            *number = nodes.len();
            nodes.push(*node);
            tags.push(*tag);
        }
        let elements = elements.iter().map(|element| element.map(|node| numbers[node]));
        Ok(Tagged { mesh: make(nodes, elements.collect())?, tags })
    }
}

/// What an MSH file holds.
///
/// # Errors
/// [`MshError`].
pub fn read_msh(path: impl AsRef<Path>) -> Result<Msh, MshError> {
    let path = path.as_ref();
    let open = |source| MshError::Open { path: path.to_path_buf(), source };
    parse_msh(BufReader::new(File::open(path).map_err(open)?))
}

/// What the text of an MSH file holds.
///
/// # Errors
/// [`MshError`], but for [`MshError::Open`].
pub fn parse_msh(text: impl BufRead) -> Result<Msh, MshError> {
    sections::parse(lines::Lines::new(text))
}

#[cfg(test)]
mod tests;
