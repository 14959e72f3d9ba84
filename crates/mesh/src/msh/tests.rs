//! What is written is read, and what is no MSH file is refused by line.

use std::fmt::Write;

use nalgebra::Vector3;
use proptest::prelude::*;

use super::{Msh, MshError, parse_msh, read_msh};
use crate::{MeshError, QuadraticTetrahedra, QuadraticTriangles, ball, curved_ball, disc};

/// Gmsh's type of an element, its number of nodes as Gmsh orders them, and its dimension.
fn kinds(msh: &Msh) -> Vec<(u64, u64, Vec<Vec<usize>>)> {
    fn lists<const N: usize>(elements: &[[usize; N]]) -> Vec<Vec<usize>> {
        elements.iter().map(|nodes| nodes.to_vec()).collect()
    }
    let mut ten = lists(&msh.quadratic_tetrahedra);
    ten.iter_mut().for_each(|nodes| nodes.swap(8, 9));
    vec![
        (15, 0, vec![vec![0]]),
        (1, 1, lists(&msh.segments)),
        (2, 2, lists(&msh.triangles)),
        (4, 3, lists(&msh.tetrahedra)),
        (8, 1, lists(&msh.quadratic_segments)),
        (9, 2, lists(&msh.quadratic_triangles)),
        (11, 3, ten),
    ]
}

const TAG: fn(usize) -> usize = |node| 7 * node + 3;

fn element(number: usize, head: &str, nodes: &[usize]) -> String {
    let tags: Vec<String> = nodes.iter().map(|&node| TAG(node).to_string()).collect();
    format!("{number}{head} {}\n", tags.join(" "))
}

fn format(version: &str) -> String {
    format!("$MeshFormat\n{version} 0 8\n$EndMeshFormat\n")
}

/// As Gmsh writes version 2.2.
fn two(msh: &Msh) -> String {
    let mut text = format("2.2") + "$PhysicalNames\n1\n2 1 \"a b\"\n$EndPhysicalNames\n$Nodes\n";
    writeln!(text, "{}", msh.nodes.len()).unwrap();
    for (node, x) in msh.nodes.iter().enumerate() {
        writeln!(text, "{} {} {} {}", TAG(node), x.x, x.y, x.z).unwrap();
    }
    let count: usize = kinds(msh).iter().map(|(_, _, elements)| elements.len()).sum();
    writeln!(text, "$EndNodes\n$Elements\n{count}").unwrap();
    for (kind, _, elements) in kinds(msh) {
        for (number, nodes) in elements.iter().enumerate() {
            text += &element(number + 1, &format!(" {kind} 2 0 -1"), nodes);
        }
    }
    text + "$EndElements\n"
}

/// As Gmsh writes version 4.1: nodes in two blocks, the second with parameters.
fn four(msh: &Msh) -> String {
    let mut text = format("4.1") + "$Entities\n1 0 0 0\n1 0 0 0 0\n$EndEntities\n$Nodes\n";
    let (count, half) = (msh.nodes.len(), msh.nodes.len() / 2);
    writeln!(text, "2 {count} 3 {}", TAG(count)).unwrap();
    for (block, more) in [(0..half, ""), (half..count, " 0.5 -1e-3")] {
        writeln!(text, "2 1 {} {}", u8::from(!more.is_empty()), block.len()).unwrap();
        block.clone().for_each(|node| writeln!(text, "{}", TAG(node)).unwrap());
        for x in &msh.nodes[block] {
            writeln!(text, "{} {} {}{more}", x.x, x.y, x.z).unwrap();
        }
    }
    let kinds = kinds(msh);
    let count: usize = kinds.iter().map(|(_, _, elements)| elements.len()).sum();
    writeln!(text, "$EndNodes\n\n$Elements\n{} {count} 1 {count}", kinds.len()).unwrap();
    for (kind, dimension, elements) in kinds {
        writeln!(text, "{dimension} 1 {kind} {}", elements.len()).unwrap();
        for (number, nodes) in elements.iter().enumerate() {
            text += &element(number + 1, "", nodes);
        }
    }
    text + "$EndElements\r\n"
}

/// A curved ball and its flat corners, a few segments of both kinds.
fn everything() -> Msh {
    let curved = curved_ball(1.0, 1).unwrap();
    let corners = |nodes: &[usize; 10]| [nodes[0], nodes[1], nodes[2], nodes[3]];
    let faces = |nodes: &[usize; 10]| [nodes[0], nodes[1], nodes[2]];
    Msh {
        nodes: curved.nodes().to_vec(),
        tags: (0..curved.nodes().len()).map(|node| TAG(node) as u64).collect(),
        segments: vec![[0, 1], [2, 1]],
        triangles: curved.elements().iter().map(faces).collect(),
        tetrahedra: curved.elements().iter().map(corners).collect(),
        quadratic_segments: vec![[0, 1, 5]],
        quadratic_triangles: vec![[0, 1, 2, 9, 8, 7]],
        quadratic_tetrahedra: curved.elements().to_vec(),
    }
}

#[test]
fn what_is_written_in_either_version_is_read_to_the_last_bit() {
    let msh = everything();
    assert_eq!(parse_msh(four(&msh).as_bytes()).unwrap(), msh);
    assert_eq!(parse_msh(two(&msh).as_bytes()).unwrap(), msh);
}

#[test]
fn a_byte_order_mark_before_the_text_is_read_over() {
    let msh = everything();
    assert_eq!(parse_msh(format!("\u{feff}{}", two(&msh)).as_bytes()).unwrap(), msh);
}

#[test]
fn each_kind_becomes_a_mesh_of_the_nodes_that_it_names() {
    let msh = everything();
    let curved = curved_ball(1.0, 1).unwrap();
    assert_eq!(msh.quadratic_tetrahedra().unwrap().mesh, curved);
    assert!(
        (msh.tetrahedra().unwrap().mesh.moments().measure - curved.corners().moments().measure)
            .abs()
            < 1e-14
    );
    assert!(msh.tetrahedra().unwrap().mesh.check_referenced().is_ok());
    assert_eq!(msh.segments().unwrap().mesh.vertices(), &msh.nodes[..3]);
    assert_eq!(msh.quadratic_segments().unwrap().mesh.elements(), [[0, 1, 2]]);
    assert_eq!(msh.quadratic_triangles().unwrap().mesh.nodes().len(), 6);
    let tags = |nodes: &[usize]| nodes.iter().map(|&node| TAG(node) as u64).collect::<Vec<_>>();
    assert_eq!(msh.segments().unwrap().tags, tags(&[0, 1, 2]));
    assert_eq!(msh.quadratic_triangles().unwrap().tags, tags(&[0, 1, 2, 7, 8, 9]));
    let empty = Msh { triangles: Vec::new(), ..msh };
    assert_eq!(empty.triangles(), Err(MeshError::Empty));
}

#[test]
fn gmshs_tetrahedron_of_ten_nodes_is_straight_in_our_order() {
    // The reference element of Gmsh's manual: nodes 8 and 9 halfway along 2-3 and 1-3.
    let corners = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]].map(Vector3::from);
    let edges = [[0, 1], [1, 2], [2, 0], [3, 0], [2, 3], [1, 3]];
    let mut text = format("2.2") + "$Nodes\n10\n";
    let middles = edges.map(|[a, b]: [usize; 2]| (corners[a] + corners[b]) / 2.0);
    for (tag, x) in corners.iter().chain(&middles).enumerate() {
        writeln!(text, "{tag} {} {} {}", x.x, x.y, x.z).unwrap();
    }
    text += "$EndNodes\n$Elements\n1\n1 11 0 0 1 2 3 4 5 6 7 8 9\n$EndElements\n";
    let element = parse_msh(text.as_bytes()).unwrap().quadratic_tetrahedra().unwrap().mesh;
    let straight = QuadraticTetrahedra::straight(&element.corners());
    let ours = |mesh: &QuadraticTetrahedra<3>| mesh.elements()[0].map(|node| mesh.nodes()[node]);
    assert_eq!(ours(&element), ours(&straight));
}

#[test]
fn a_flat_mesh_is_laid_into_the_plane_by_a_map() {
    let disc = disc(1.0, 3).unwrap();
    let flat = Msh {
        nodes: disc.vertices().iter().map(|x| x.push(0.0)).collect(),
        tags: (0..disc.vertices().len()).map(|node| TAG(node) as u64).collect(),
        triangles: disc.simplices().to_vec(),
        ..Msh::default()
    };
    let read = parse_msh(four(&flat).as_bytes()).unwrap();
    assert_eq!(read.triangles().unwrap().mesh.mapped(|x| x.xy()).unwrap(), disc);
    let curved = QuadraticTriangles::straight(&disc);
    assert!((curved.measure() - disc.moments().measure).abs() < 1e-14);
}

fn refused(text: &str) -> String {
    parse_msh(text.as_bytes()).unwrap_err().to_string()
}

#[test]
fn what_is_no_mesh_is_refused_by_line() {
    let tetrahedra = Msh {
        nodes: ball(1.0, 0).unwrap().vertices().to_vec(),
        tetrahedra: ball(1.0, 0).unwrap().simplices().to_vec(),
        ..Msh::default()
    };
    let text = two(&tetrahedra);
    let with = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        refused(&text.replacen(from, to, 1))
    };
    assert_eq!(with("2.2 0", "2.2 1"), "line 2: the file is binary, only text is read");
    assert_eq!(
        with("2.2 0", "4.0 0"),
        "line 2: version `4.0` of the format is not read, only 4.1 and 2.2 are"
    );
    assert_eq!(with("2.2 0 8", "2.2 0 8 9"), "line 2: the end of the line is expected, not `9`");
    let line_of = |start: &str| text.lines().position(|line| line.starts_with(start)).unwrap() + 1;
    let point = line_of("1 15 2");
    assert_eq!(
        with("1 15 2", "1 3 2"),
        format!("line {point}: elements of type 3 are not read, only 1, 2, 4, 8, 9 and 11 are")
    );
    assert_eq!(with("\n3 ", "\n4 "), format!("line {point}: there is no node 3"));
    let first = line_of("3 ");
    assert_eq!(with("\n3 ", "\n10 "), format!("line {}: there are two nodes 10", first + 1));
    let error = with("\n3 ", "\n3 nan ");
    assert_eq!(error, format!("line {first}: a coordinate is expected, not `nan`"));
    let end = line_of("$EndNodes");
    let error = with("$EndNodes", "7 0 0 0");
    assert_eq!(error, format!("line {end}: $EndNodes is expected, not `7 0 0 0`"));
    let past = text.lines().count() + 1;
    let error = with("$Nodes", "$Knots");
    let end_of = "the end of the section is expected, not the end of the file";
    assert_eq!(error, format!("line {past}: {end_of}"));
    assert_eq!(refused(""), "there is no section $MeshFormat");
    assert_eq!(refused(&format("4.1")), "there is no section $Nodes");
    assert_eq!(refused("hello\n"), "line 1: a section is expected, not `hello`");
    assert_eq!(refused("$Nodes\n"), "line 1: section $Nodes is out of place");
    let twice = format("4.1") + &format("4.1");
    assert_eq!(refused(&twice), "line 4: section $MeshFormat is out of place");
    let nodes = "$ParametricNodes\n1\n1 0 0 0 0 1\n$EndParametricNodes\n";
    let parametric = format("2.2") + nodes + "$Elements\n0\n$EndElements\n";
    let error = "line 4: section $ParametricNodes is not read, only nodes in $Nodes are";
    assert_eq!(refused(&parametric), error);
    let missing = read_msh("no/such/file.msh").unwrap_err();
    assert!(missing.to_string().starts_with("no/such/file.msh: "), "{missing}");
}

#[test]
fn a_count_that_no_lines_bear_out_is_refused_and_takes_no_memory() {
    let many = u64::MAX;
    let nodes = format!("$Nodes\n1 {many} 1 {many}\n3 1 0 {many}\n1\n");
    let error = refused(&(format("4.1") + &nodes));
    assert_eq!(error, "line 8: a node's tag is expected, not the end of the file");
    let nodes = "$Nodes\n1 2 1 2\n0 1 0 1\n1\n0 0 0\n$EndNodes\n";
    let error = refused(&(format("4.1") + nodes));
    assert_eq!(error, "line 9: the section has 1 nodes, but announces 2");
}

proptest! {
    #[test]
    fn any_bytes_are_a_mesh_or_an_error_with_words(
        bytes in prop::collection::vec(any::<u8>(), 0..300),
    ) {
        if let Err(error) = parse_msh(&bytes[..]) {
            prop_assert!(!error.to_string().is_empty());
        }
    }

    #[test]
    fn a_file_in_which_lines_were_changed_is_a_mesh_or_an_error_that_names_one_of_them(
        old in any::<bool>(),
        changes in prop::collection::vec(
            (any::<prop::sample::Index>(), "[ 0-9.$eE+-]{0,12}"),
            1..4,
        ),
    ) {
        let msh = everything();
        let text = if old { two(&msh) } else { four(&msh) };
        let mut lines: Vec<&str> = text.lines().collect();
        for (place, line) in &changes {
            *place.get_mut(&mut lines[..]) = line;
        }
        match parse_msh(lines.join("\n").as_bytes()) {
            Ok(_) | Err(MshError::Missing { .. }) => {}
            Err(error) => prop_assert!(error.to_string().starts_with("line "), "{}", error),
        }
    }
}
