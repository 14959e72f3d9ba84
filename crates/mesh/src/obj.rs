//! Reading surfaces from Wavefront OBJ files.
//!
//! ```text
//! v x y z            a vertex; a weight or a colour may follow
//! f a b c ...        a polygon of vertices, from 1 or, negative, from the end; a/t, a//n, a/t/n too
//! ```
//! All groups and objects become one mesh; materials, normals, texture coordinates, points, lines and
//! free-form surfaces are left out, and a word that the format does not have is an error. Polygons are
//! cut into triangles that have their area, concave ones too. Vertices at the same place become one,
//! because exporters repeat them for the sake of normals and groups, and a surface that repeats them is
//! open; vertices that no face names are left out; [`Obj::numbers`] tells where each went. A file is not
//! trusted: at most 256 MB are read, what is wrong is named with its line and column, and the mesh is
//! checked as any other. Source: Bourke, "Object Files (.obj)"; the appendix of Wavefront's manual.

mod lines;

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};

use nalgebra::Vector3;

use crate::mesh::{FARTHEST, Mesh};
use crate::triangulation::{MOST_CORNERS, NoTriangles, triangulated};
use crate::{MOST_SIMPLICES, MeshError};
use lines::{Statements, Word, Words};

/// A file that holds no mesh.
#[derive(Debug, thiserror::Error)]
pub enum ObjError {
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
    #[error("line {line}, column {column}: {expected} is expected, not {found}")]
    Unexpected {
        /// Which line, from 1.
        line: usize,
        /// Which character, from 1.
        column: usize,
        /// What belongs there.
        expected: &'static str,
        /// What is there.
        found: String,
    },
    /// A face names a vertex that is not there, or not yet.
    #[error("line {line}, column {column}: there is no vertex {vertex}, only {vertices} before it")]
    NoSuchVertex {
        /// Which line, from 1.
        line: usize,
        /// Which character, from 1.
        column: usize,
        /// The vertex as it is named.
        vertex: i64,
        /// How many vertices come before.
        vertices: usize,
    },
    /// A face with two corners at one place, one after the other.
    #[error("line {line}, column {column}: the corner is where the one before it is")]
    RepeatedCorner {
        /// Which line, from 1.
        line: usize,
        /// Which character, from 1.
        column: usize,
    },
    /// A face that crosses itself or has no area, and more than three corners.
    #[error("line {line}: the face crosses itself or has no area")]
    NotSimple {
        /// Which line, from 1.
        line: usize,
    },
    /// A concave face of too many corners.
    #[error("line {line}: the face is not convex and has {corners} corners; the limit is {limit}")]
    TooManyCorners {
        /// Which line, from 1.
        line: usize,
        /// How many it has.
        corners: usize,
        /// The limit.
        limit: usize,
    },
    /// What the file holds is no mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// What an OBJ file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Obj {
    /// Its faces as triangles, in their order, over the vertices that they name, in theirs.
    pub mesh: Mesh<3, 3>,
    /// For each vertex of the file its number in the mesh, which those at the same place share; `None`
    /// for what no face names.
    pub numbers: Vec<Option<usize>>,
}

/// The surface in an OBJ file.
///
/// # Errors
/// [`ObjError`].
pub fn read_obj(path: impl AsRef<Path>) -> Result<Obj, ObjError> {
    let path = path.as_ref();
    let open = |source| ObjError::Open { path: path.to_path_buf(), source };
    parse_obj(BufReader::new(File::open(path).map_err(open)?))
}

/// The surface in the text of an OBJ file.
///
/// # Errors
/// [`ObjError`], but for [`ObjError::Open`].
pub fn parse_obj(text: impl BufRead) -> Result<Obj, ObjError> {
    let mut statements = Statements::new(text);
    let mut surface = Surface::default();
    while let Some(mut words) = statements.next(is_name)? {
        let keyword = words.required("a statement")?;
        match keyword.text {
            "v" => surface.vertex(&mut words)?,
            "f" | "fo" => surface.face(&keyword, &mut words)?,
            word if LEFT_OUT.contains(&word) => {}
            _ => return Err(keyword.unexpected("a statement of the format")),
        }
    }
    surface.obj()
}

/// Statements whose words are names, which may be paths and end with a backslash.
fn is_name(keyword: &str) -> bool {
    const NAMES: [&str; 10] = [
        "g",
        "o",
        "usemtl",
        "mtllib",
        "usemap",
        "maplib",
        "shadow_obj",
        "trace_obj",
        "call",
        "csh",
    ];
    NAMES.contains(&keyword)
}

/// Statements that are passed over.
const LEFT_OUT: [&str; 42] = [
    "vt",
    "vn",
    "vp",
    "p",
    "l",
    "g",
    "s",
    "o",
    "mg",
    "usemtl",
    "mtllib",
    "usemap",
    "maplib",
    "cstype",
    "deg",
    "bmat",
    "step",
    "curv",
    "curv2",
    "surf",
    "parm",
    "trim",
    "hole",
    "scrv",
    "sp",
    "end",
    "con",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
    "call",
    "csh",
    "bsp",
    "bzp",
    "cdc",
    "cdp",
    "res",
];

/// The surface as far as it was read.
#[derive(Default)]
struct Surface {
    places: Vec<Vector3<f64>>,
    /// For each vertex the first one at its place.
    firsts: Vec<usize>,
    numbers: HashMap<[u64; 3], usize>,
    /// By the numbers of those first ones.
    triangles: Vec<[usize; 3]>,
    /// The corners of a face, and their places.
    corners: Vec<usize>,
    outline: Vec<Vector3<f64>>,
}

impl Surface {
    fn vertex(&mut self, words: &mut Words) -> Result<(), ObjError> {
        let mut place = Vector3::zeros();
        for x in place.iter_mut() {
            *x = coordinate(&words.required(COORDINATE)?)?;
        }
        while let Some(word) = words.next() {
            coordinate(&word)?;
        }
        // Adding zero makes one of the two zeros.
        let bits = [0, 1, 2].map(|c| (place[c] + 0.0).to_bits());
        let number = self.places.len();
        self.firsts.push(*self.numbers.entry(bits).or_insert(number));
        self.places.push(place);
        Ok(())
    }

    fn face(&mut self, keyword: &Word, words: &mut Words) -> Result<(), ObjError> {
        self.corners.clear();
        while let Some(word) = words.next() {
            let corner = self.corner(&word)?;
            if self.corners.last() == Some(&corner) {
                return Err(ObjError::RepeatedCorner { line: word.line, column: word.column });
            }
            self.corners.push(corner);
        }
        while self.corners.len() < 3 {
            words.required("a face's third corner")?;
        }
        let line = keyword.line;
        if self.corners.first() == self.corners.last() {
            return Err(ObjError::RepeatedCorner { line, column: keyword.column });
        }
        let count = self.triangles.len() + self.corners.len() - 2;
        if count > MOST_SIMPLICES {
            return Err(MeshError::TooMany { what: "the file", limit: MOST_SIMPLICES }.into());
        }
        self.outline.clear();
        self.outline.extend(self.corners.iter().map(|&corner| self.places[corner]));
        let triangles = triangulated(&self.outline).map_err(|no| match no {
            NoTriangles::NotSimple => ObjError::NotSimple { line },
            NoTriangles::TooManyCorners => {
                let corners = self.corners.len();
                ObjError::TooManyCorners { line, corners, limit: MOST_CORNERS }
            }
        })?;
        self.triangles.extend(triangles.iter().map(|triangle| triangle.map(|k| self.corners[k])));
        Ok(())
    }

    /// The first vertex at the place of the one that a word such as `3`, `-1` or `3/1/2` names.
    fn corner(&self, word: &Word) -> Result<usize, ObjError> {
        const EXPECTED: &str = "a corner such as 3, -1 or 3/1/2";
        let mut parts = word.text.split('/');
        let number = |part: &str| part.parse::<i64>().map_err(|_| word.unexpected(EXPECTED));
        let vertex = number(parts.next().unwrap_or_default())?;
        for part in parts.by_ref().take(2).filter(|part| !part.is_empty()) {
            number(part)?;
        }
        if parts.next().is_some() {
            return Err(word.unexpected(EXPECTED));
        }
        let vertices = self.places.len();
        let known = match vertex {
            1.. => usize::try_from(vertex).ok().map(|vertex| vertex - 1),
            0 => None,
            _ => usize::try_from(vertex.unsigned_abs()).ok().and_then(|k| vertices.checked_sub(k)),
        };
        match known.and_then(|vertex| self.firsts.get(vertex)) {
            Some(&first) => Ok(first),
            None => {
                let Word { line, column, .. } = *word;
                Err(ObjError::NoSuchVertex { line, column, vertex, vertices })
            }
        }
    }

    /// The triangles with only the vertices that they name, and where each vertex went.
    fn obj(self) -> Result<Obj, ObjError> {
        if self.triangles.is_empty() {
            return Err(MeshError::Empty.into());
        }
        let part = Mesh::new(self.places, self.triangles)?.referenced();
        let mut renumbered = vec![None; self.firsts.len()];
        for (new, &old) in part.vertices.iter().enumerate() {
            renumbered[old] = Some(new);
        }
        let numbers = self.firsts.iter().map(|&first| renumbered[first]).collect();
        Ok(Obj { mesh: part.mesh, numbers })
    }
}

const COORDINATE: &str = "a coordinate, finite and at most 1e50 in size,";

fn coordinate(word: &Word) -> Result<f64, ObjError> {
    let number = word.text.parse().ok().filter(|x: &f64| x.abs() <= FARTHEST);
    number.ok_or_else(|| word.unexpected(COORDINATE))
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
        let mesh = parse_obj(CUBE.as_bytes()).unwrap().mesh;
        assert_eq!((mesh.vertices().len(), mesh.simplices().len()), (8, 12));
        let surface = ClosedSurface::new(mesh).unwrap();
        assert!((surface.moments().measure - 1.0).abs() < 1e-15);
    }

    #[test]
    fn coordinates_keep_all_their_digits() {
        let text = "v 0.1 1e-7 123456.789012345\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        let mesh = parse_obj(text.as_bytes()).unwrap().mesh;
        assert_eq!(mesh.vertices()[0], Vector3::new(0.1, 1e-7, 123456.789012345));
    }

    #[test]
    fn comments_continuations_marks_and_bare_names_are_read_over() {
        let text = "\u{feff}mtllib a.mtl\nusemtl\ng\nv 0 0 0 # here\nv 1 \\\n 0 0 1.0\n\
            usemtl C:\\steel\\\nv 0 1 0 0.5 0.5 0.5\r\ns off\nf 1//1 \\\n2//1 3//1#end\nl 1 2\n";
        let mesh = parse_obj(text.as_bytes()).unwrap().mesh;
        assert_eq!(mesh.simplices(), [[0, 1, 2]]);
        assert_eq!(mesh.vertices()[2], Vector3::y());
    }

    #[test]
    fn free_form_statements_of_several_lines_are_passed_over() {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\ncstype bspline\nsurf 0 1 0 1 1\\\n 2 3\n\
            parm u 0 0.25\\\n 0.5\ntrim 0 1\\\n1\nend\ncdp 1 2 3\nf 1 2 3\n";
        assert_eq!(parse_obj(text.as_bytes()).unwrap().mesh.simplices(), [[0, 1, 2]]);
    }

    #[test]
    fn where_each_vertex_of_the_file_went_is_told() {
        let text =
            "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nv 1 1 0\nf 3 4 2\nf 3 6 4\nf 5 3 4\n";
        let obj = parse_obj(text.as_bytes()).unwrap();
        assert_eq!(obj.numbers, [None, Some(0), Some(1), Some(2), Some(0), Some(3)]);
        assert_eq!(obj.mesh.simplices(), [[1, 2, 0], [1, 3, 2], [0, 1, 2]]);
        assert_eq!(obj.mesh.vertices()[3], Vector3::new(1.0, 1.0, 0.0));
    }

    #[test]
    fn what_is_wrong_is_named_by_line_and_column() {
        let told = |text: &str| parse_obj(text.as_bytes()).unwrap_err().to_string();
        let three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
        let after = |line: &str| told(&format!("{three}{line}\n"));
        let coordinate = "a coordinate, finite and at most 1e50 in size, is expected";
        assert_eq!(told("v 0 0 zero\n"), format!("line 1, column 7: {coordinate}, not `zero`"));
        assert_eq!(after("v 1 inf 0"), format!("line 4, column 5: {coordinate}, not `inf`"));
        assert_eq!(
            after("v 1 \\\n 2"),
            format!("line 5, column 3: {coordinate}, not the end of the line")
        );
        assert_eq!(after("f 1 2 4"), "line 4, column 7: there is no vertex 4, only 3 before it");
        assert_eq!(after("f 0 1 2"), "line 4, column 3: there is no vertex 0, only 3 before it");
        assert_eq!(after("f -4 1 2"), "line 4, column 3: there is no vertex -4, only 3 before it");
        assert!(after("f 1 2").starts_with("line 4, column 6: a face's third corner is expected"));
        assert!(after("f 1 2 3/1/1/1").starts_with("line 4, column 7: a corner such as"));
        assert_eq!(after("f 1 2 2"), "line 4, column 7: the corner is where the one before it is");
        assert!(after("ff 1 2 3").ends_with("a statement of the format is expected, not `ff`"));
        let bow = "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 1 0\nf 1 2 3 4\n";
        assert_eq!(told(bow), "line 5: the face crosses itself or has no area");
    }

    #[test]
    fn what_is_no_mesh_is_named() {
        let parse = |text: &str| parse_obj(text.as_bytes()).unwrap_err();
        assert!(matches!(parse(""), ObjError::Mesh(MeshError::Empty)));
        assert!(matches!(parse("garbage \u{0}\u{1}"), ObjError::Unexpected { line: 1, .. }));
        let needle = "v 0 0 0\nv 0 0 0\nv 0 1 0\nf 1 2 3\n";
        assert!(matches!(parse(needle), ObjError::RepeatedCorner { line: 4, column: 5 }));
        let missing = read_obj("no/such/file.obj").unwrap_err();
        assert!(missing.to_string().starts_with("no/such/file.obj: "), "{missing}");
    }
}
