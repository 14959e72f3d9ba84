//! MSH, versions 2.2 and 4.1: nodes with any tags, elements of two kinds, sections to pass over.

use nalgebra::Vector3;
use stationary_mesh::parse_msh;

use super::{names_line, written};
use crate::{Draw, Verdict};

pub(in crate::kinds::mesh) fn trial(draw: &mut Draw) -> Verdict {
    let old = draw.chance(0.5);
    let n = draw.between(4, 12);
    let mut tags: Vec<u64> = Vec::new();
    while tags.len() < n {
        let last = tags.last().copied().unwrap_or(0);
        tags.push(last + 1 + if draw.chance(0.3) { draw.below(1 << 40) as u64 } else { 0 });
    }
    if draw.chance(0.3) {
        tags.reverse();
    }
    let mut words = Vec::new();
    let nodes: Vec<Vector3<f64>> = (0..n)
        .map(|_| {
            let mut place = Vector3::zeros();
            let mut line = String::new();
            for c in 0..3 {
                let x = draw.symmetric() * 10.0;
                let (word, value) = written(draw, x);
                line.push_str(&word);
                line.push(if c < 2 { ' ' } else { '\n' });
                place[c] = value;
            }
            words.push(line.trim_end().to_owned());
            place
        })
        .collect();
    let distinct = |draw: &mut Draw, count: usize| {
        let first = draw.below(n);
        (0..count).map(|k| (first + k) % n).collect::<Vec<usize>>()
    };
    let triangles: Vec<Vec<usize>> = (0..draw.between(0, 4)).map(|_| distinct(draw, 3)).collect();
    let tetrahedra: Vec<Vec<usize>> = (0..draw.between(0, 4)).map(|_| distinct(draw, 4)).collect();
    let mut lines: Vec<String> = Vec::new();
    if draw.chance(0.2) {
        lines.extend(["$Comments", "of no use $Nodes", "$EndComments"].map(str::to_owned));
    }
    lines.push("$MeshFormat".to_owned());
    lines.push(if old { "2.2 0 8" } else { "4.1 0 8" }.to_owned());
    lines.push("$EndMeshFormat".to_owned());
    if draw.chance(0.3) {
        lines.extend(
            ["$PhysicalNames", "1", "2 1 \"a face\"", "$EndPhysicalNames"].map(str::to_owned),
        );
    }
    let nodes_begin = lines.len();
    lines.push("$Nodes".to_owned());
    let elements = [(2, &triangles), (4, &tetrahedra)];
    let all = triangles.len() + tetrahedra.len();
    let named = |corners: &[usize]| {
        corners.iter().map(|&c| tags[c].to_string()).collect::<Vec<_>>().join(" ")
    };
    if old {
        lines.push(n.to_string());
        lines.extend((0..n).map(|k| format!("{} {}", tags[k], words[k])));
        lines.extend(["$EndNodes".to_owned(), "$Elements".to_owned(), all.to_string()]);
        let mut tag = 0;
        for (kind, list) in elements {
            for corners in list {
                tag += 1;
                lines.push(format!("{tag} {kind} 2 0 1 {}", named(corners)));
            }
        }
    } else {
        let half = draw.between(0, n);
        let (least, most) = (tags.iter().min().expect("tags"), tags.iter().max().expect("tags"));
        lines.push(format!("2 {n} {least} {most}"));
        for part in [0..half, half..n] {
            lines.push(format!("2 1 0 {}", part.len()));
            lines.extend(part.clone().map(|k| tags[k].to_string()));
            lines.extend(part.map(|k| words[k].clone()));
        }
        lines.extend(["$EndNodes".to_owned(), "$Elements".to_owned()]);
        lines.push(format!("2 {all} 1 {all}"));
        let mut tag = 0;
        for (kind, list) in elements {
            lines.push(format!("{} 1 {kind} {}", kind / 2 + 1, list.len()));
            for corners in list {
                tag += 1;
                lines.push(format!("{tag} {}", named(corners)));
            }
        }
    }
    lines.push("$EndElements".to_owned());
    let broken = draw.chance(0.15).then(|| {
        // A line of numbers with a word too many.
        let numbers: Vec<usize> = (0..lines.len())
            .filter(|&k| lines[k].starts_with(|c: char| c.is_ascii_digit() || c == '-'))
            .filter(|&k| k > nodes_begin)
            .collect();
        let line = numbers[draw.below(numbers.len())];
        lines[line].push_str(" x");
        line + 1
    });
    let ending = if draw.chance(0.2) { "\r\n" } else { "\n" };
    let mark = if draw.chance(0.1) { "\u{feff}" } else { "" };
    let text = format!("{mark}{}{ending}", lines.join(ending));
    draw.note(text.clone());
    let msh = match (parse_msh(text.as_bytes()), broken) {
        (Ok(_), Some(line)) => return Verdict::wrong(format!("a word in line {line} is accepted")),
        (Err(error), Some(line)) => {
            return if names_line(&error.to_string(), line) {
                Verdict::due()
            } else {
                Verdict::wrong(format!("line {line}: only `{error}`"))
            };
        }
        (Err(error), None) => return Verdict::wrong(format!("refused: {error}")),
        (Ok(msh), None) => msh,
    };
    // Each corner as its place and its tag.
    let places =
        |corners: &[usize]| corners.iter().map(|&c| (nodes[c], tags[c])).collect::<Vec<_>>();
    let read_triangles = msh.triangles().map_or(Vec::new(), |read| {
        let corner = |&c: &usize| (read.mesh.vertices()[c], read.tags[c]);
        read.mesh.simplices().iter().map(|t| t.iter().map(corner).collect()).collect()
    });
    let read_tetrahedra = msh.tetrahedra().map_or(Vec::new(), |read| {
        let corner = |&c: &usize| (read.mesh.vertices()[c], read.tags[c]);
        read.mesh.simplices().iter().map(|t| t.iter().map(corner).collect()).collect()
    });
    let equal = |list: &[Vec<usize>], read: &[Vec<(Vector3<f64>, u64)>]| {
        list.len() == read.len() && list.iter().zip(read).all(|(corners, x)| places(corners) == *x)
    };
    if equal(&triangles, &read_triangles) && equal(&tetrahedra, &read_tetrahedra) {
        Verdict::due()
    } else {
        Verdict::wrong("other elements than were written")
    }
}
