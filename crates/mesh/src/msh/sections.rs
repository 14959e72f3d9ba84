//! The sections of an MSH file: its format, nodes and elements; others are passed over.

use std::collections::HashMap;
use std::io::BufRead;

use nalgebra::Vector3;

use super::lines::{Lines, Words, shown};
use super::{Msh, MshError};

/// Which format.
#[derive(Clone, Copy, PartialEq)]
enum Version {
    /// 2.2: a node or an element a line.
    Two,
    /// 4.1: in blocks, one for each part of the geometry.
    Four,
}

/// Numbers of nodes by their tags.
type Numbers = HashMap<u64, usize>;

pub(super) fn parse(mut lines: Lines<impl BufRead>) -> Result<Msh, MshError> {
    let (mut version, mut numbers, mut msh) = (None, None, Msh::default());
    let (mut finished, mut parametric) = (false, None);
    while let Some(words) = lines.next()? {
        let line = words.number;
        let out_of_place = |section: &'static str| MshError::OutOfPlace { line, section };
        match (words.line, version, &numbers) {
            ("$MeshFormat", None, _) => version = Some(format(&mut lines)?),
            ("$MeshFormat", ..) => return Err(out_of_place("$MeshFormat")),
            ("$Nodes", Some(version), None) => {
                numbers = Some(nodes(version, &mut lines, &mut msh)?);
            }
            ("$Nodes", ..) => return Err(out_of_place("$Nodes")),
            ("$Elements", Some(version), Some(numbers)) if !finished => {
                elements(version, &mut lines, numbers, &mut msh)?;
                finished = true;
            }
            ("$Elements", ..) => {
                return Err(match parametric.filter(|_| numbers.is_none()) {
                    Some(line) => MshError::ParametricNodes { line },
                    None => out_of_place("$Elements"),
                });
            }
            (section, ..) => {
                parametric = parametric.or((section == "$ParametricNodes").then_some(line));
                pass_over(&mut lines)?;
            }
        }
    }
    let sections = [
        ("$MeshFormat", version.is_some()),
        ("$Nodes", numbers.is_some()),
        ("$Elements", finished),
    ];
    match sections.into_iter().find(|(_, there)| !there) {
        Some((section, _)) => Err(MshError::Missing { section }),
        None => Ok(msh),
    }
}

/// Goes on to the end of the section that the current line begins.
fn pass_over(lines: &mut Lines<impl BufRead>) -> Result<(), MshError> {
    let words = lines.current();
    let name = words.line.strip_prefix('$').filter(|name| !name.starts_with("End"));
    let Some(name) = name else { return Err(words.unexpected("a section", words.line)) };
    let end = format!("$End{name}");
    while lines.required("the end of the section")?.line != end {}
    Ok(())
}

fn format(lines: &mut Lines<impl BufRead>) -> Result<Version, MshError> {
    let mut words = lines.required("a version")?;
    let version = match words.word("a version")? {
        "2.2" => Version::Two,
        "4.1" => Version::Four,
        other => {
            return Err(MshError::Version { line: words.number, version: shown(other) });
        }
    };
    match words.number("0, for text")? {
        0 => {}
        1 => return Err(MshError::Binary { line: words.number }),
        other => return Err(words.unexpected("0, for text", &u64::to_string(&other))),
    }
    words.number::<u64>("the size of numbers")?;
    words.end()?;
    lines.required_line("$EndMeshFormat")?;
    Ok(version)
}

/// The numbers of a section's first line: how many blocks and how many members.
fn announced(
    version: Version,
    lines: &mut Lines<impl BufRead>,
    what: &'static str,
) -> Result<[u64; 2], MshError> {
    let mut words = lines.required(what)?;
    let counts = match version {
        Version::Two => [0, words.number(what)?],
        Version::Four => {
            let counts = [words.number("a number of blocks")?, words.number(what)?];
            words.number::<u64>("the least tag")?;
            words.number::<u64>("the largest tag")?;
            counts
        }
    };
    words.end()?;
    Ok(counts)
}

fn nodes(
    version: Version,
    lines: &mut Lines<impl BufRead>,
    msh: &mut Msh,
) -> Result<Numbers, MshError> {
    let mut numbers = Numbers::new();
    let [blocks, count] = announced(version, lines, "a number of nodes")?;
    match version {
        Version::Two => {
            for _ in 0..count {
                let mut words = lines.required("a node")?;
                number(&mut numbers, &mut msh.tags, &mut words)?;
                msh.nodes.push(place(&mut words, 0)?);
            }
        }
        Version::Four => {
            for _ in 0..blocks {
                node_block(lines, &mut numbers, msh)?;
            }
        }
    }
    finish(lines, "nodes", "$EndNodes", [count, msh.nodes.len() as u64])?;
    Ok(numbers)
}

/// Tags first, then places, which may be followed by as many parameters as the geometry has.
fn node_block(
    lines: &mut Lines<impl BufRead>,
    numbers: &mut Numbers,
    msh: &mut Msh,
) -> Result<(), MshError> {
    let mut words = lines.required("a block of nodes")?;
    let dimension = dimension(&mut words)?;
    let parameters = match words.number("0 or 1, for parameters")? {
        0 => 0,
        1 => dimension,
        other => return Err(words.unexpected("0 or 1, for parameters", &u64::to_string(&other))),
    };
    let count: u64 = words.number("a number of nodes")?;
    words.end()?;
    for _ in 0..count {
        let mut words = lines.required("a node's tag")?;
        number(numbers, &mut msh.tags, &mut words)?;
        words.end()?;
    }
    for _ in 0..count {
        msh.nodes.push(place(&mut lines.required("a node's place")?, parameters)?);
    }
    Ok(())
}

/// The next node gets the next number.
fn number(numbers: &mut Numbers, tags: &mut Vec<u64>, words: &mut Words) -> Result<(), MshError> {
    let tag = words.number("a node's tag")?;
    let next = numbers.len();
    match numbers.insert(tag, next) {
        None => {
            tags.push(tag);
            Ok(())
        }
        Some(_) => Err(MshError::RepeatedNode { line: words.number, tag }),
    }
}

fn place(words: &mut Words, parameters: u64) -> Result<Vector3<f64>, MshError> {
    let place = [words.coordinate()?, words.coordinate()?, words.coordinate()?];
    for _ in 0..parameters {
        words.coordinate()?;
    }
    words.end()?;
    Ok(place.into())
}

/// Dimension and tag of the part of the geometry that a block belongs to.
fn dimension(words: &mut Words) -> Result<u64, MshError> {
    let dimension: u64 = words.number("a dimension")?;
    if dimension > 3 {
        return Err(words.unexpected("a dimension", &dimension.to_string()));
    }
    words.number::<i64>("the tag of a part")?;
    Ok(dimension)
}

fn elements(
    version: Version,
    lines: &mut Lines<impl BufRead>,
    numbers: &Numbers,
    msh: &mut Msh,
) -> Result<(), MshError> {
    let [blocks, count] = announced(version, lines, "a number of elements")?;
    let mut found = 0;
    match version {
        Version::Two => {
            for _ in 0..count {
                let mut words = lines.required("an element")?;
                words.number::<u64>("an element's tag")?;
                let kind = words.number("a type of element")?;
                let tags: u64 = words.number("a number of tags")?;
                for _ in 0..tags {
                    words.number::<i64>("a tag")?;
                }
                msh.add(kind, &mut words, numbers)?;
                found += 1;
            }
        }
        Version::Four => {
            for _ in 0..blocks {
                let mut words = lines.required("a block of elements")?;
                dimension(&mut words)?;
                let kind = words.number("a type of element")?;
                let count: u64 = words.number("a number of elements")?;
                words.end()?;
                for _ in 0..count {
                    let mut words = lines.required("an element")?;
                    words.number::<u64>("an element's tag")?;
                    msh.add(kind, &mut words, numbers)?;
                    found += 1;
                }
            }
        }
    }
    finish(lines, "elements", "$EndElements", [count, found])
}

fn finish(
    lines: &mut Lines<impl BufRead>,
    what: &'static str,
    end: &'static str,
    [announced, found]: [u64; 2],
) -> Result<(), MshError> {
    lines.required_line(end)?;
    let line = lines.current().number;
    if announced == found { Ok(()) } else { Err(MshError::Count { line, what, announced, found }) }
}

impl Msh {
    /// Adds the element whose nodes the rest of a line names.
    fn add(&mut self, kind: u64, words: &mut Words, numbers: &Numbers) -> Result<(), MshError> {
        match kind {
            1 => self.segments.push(named(words, numbers)?),
            2 => self.triangles.push(named(words, numbers)?),
            4 => self.tetrahedra.push(named(words, numbers)?),
            8 => self.quadratic_segments.push(named(words, numbers)?),
            9 => self.quadratic_triangles.push(named(words, numbers)?),
            11 => {
                let mut nodes: [usize; 10] = named(words, numbers)?;
                // Gmsh has edge 23 before edge 13.
                nodes.swap(8, 9);
                self.quadratic_tetrahedra.push(nodes);
            }
            POINT => {
                named::<1>(words, numbers)?;
            }
            kind => return Err(MshError::ElementType { line: words.number, kind }),
        }
        Ok(())
    }
}

/// Gmsh's type of a single node as an element.
const POINT: u64 = 15;

/// The nodes that the rest of a line names.
fn named<const N: usize>(words: &mut Words, numbers: &Numbers) -> Result<[usize; N], MshError> {
    let mut nodes = [0; N];
    for node in &mut nodes {
        let tag = words.number("a node's tag")?;
        let line = words.number;
        *node = *numbers.get(&tag).ok_or(MshError::NoSuchNode { line, tag })?;
    }
    words.end()?;
    Ok(nodes)
}
