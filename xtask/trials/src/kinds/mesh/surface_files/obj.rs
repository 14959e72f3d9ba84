//! OBJ: triangles and polygons over shared and repeated vertices.

use nalgebra::{Vector2, Vector3};
use stationary_mesh::{Obj, parse_obj};

use super::{names_line, written};
use crate::{Draw, Verdict};

/// A face by the numbers of its vertices in the file, and the normal of its plane where it has one.
struct Face {
    corners: Vec<usize>,
    area: Option<Vector3<f64>>,
}

struct Text {
    lines: Vec<String>,
    vertices: Vec<Vector3<f64>>,
    faces: Vec<Face>,
    textures: usize,
    normals: usize,
}

pub(in crate::kinds::mesh) fn trial(draw: &mut Draw) -> Verdict {
    let plain = draw.chance(0.2);
    let mut text = Text {
        lines: Vec::new(),
        vertices: Vec::new(),
        faces: Vec::new(),
        textures: 0,
        normals: 0,
    };
    for _ in 0..draw.between(0, 4) {
        text.vertex(draw, plain);
    }
    for _ in 0..draw.between(1, 6) {
        if !plain {
            text.aside(draw);
        }
        match draw.below(3) {
            0 => text.triangle(draw, plain),
            1 => text.polygon(draw, plain),
            _ => text.strip(draw, plain),
        }
    }
    let broken = draw.chance(0.15).then(|| text.spoil(draw));
    let ending = if draw.chance(0.2) { "\r\n" } else { "\n" };
    let mut whole = if !plain && draw.chance(0.15) { "\u{feff}".to_owned() } else { String::new() };
    whole.push_str(&text.lines.join("\n").replace('\n', ending));
    if draw.chance(0.7) {
        whole.push_str(ending);
    }
    draw.note(format!("{whole:?}"));
    let read = parse_obj(whole.as_bytes());
    match (read, broken) {
        (Ok(_), Some((line, what))) => Verdict::wrong(format!("{what} in line {line} is accepted")),
        (Err(error), Some((line, what))) => {
            let words = error.to_string();
            if names_line(&words, line) {
                Verdict::due()
            } else {
                Verdict::wrong(format!("{what} in line {line}: only `{words}`"))
            }
        }
        (Err(_), None) if text.faces.is_empty() => Verdict::due(),
        (Err(error), None) => Verdict::wrong(format!("refused: {error}")),
        (Ok(obj), None) => judge(&text, &obj),
    }
}

impl Text {
    /// A vertex line, with what may follow the coordinates; lines may go on after a backslash.
    fn vertex(&mut self, draw: &mut Draw, plain: bool) -> usize {
        let place = Vector3::<f64>::from_fn(|_, _| draw.symmetric() * 10.0);
        let mut words = vec!["v".to_owned()];
        let mut value = Vector3::zeros();
        for c in 0..3 {
            let (word, number) =
                if plain { (format!("{:?}", place[c]), place[c]) } else { written(draw, place[c]) };
            words.push(word);
            value[c] = number;
        }
        if !plain && draw.chance(0.1) {
            words.push("1.0".to_owned());
        } else if !plain && draw.chance(0.1) {
            words.extend(["0.2", "0.4", "1"].map(str::to_owned));
        }
        self.line(draw, &words, plain);
        self.vertices.push(value);
        self.vertices.len() - 1
    }

    /// Words as a line, with blanks, comments and continuations.
    fn line(&mut self, draw: &mut Draw, words: &[String], plain: bool) {
        if plain {
            return self.lines.push(words.join(" "));
        }
        let mut line = if draw.chance(0.1) { "  ".to_owned() } else { String::new() };
        for (k, word) in words.iter().enumerate() {
            if k > 0 {
                line.push_str(match draw.below(12) {
                    0 => "\t",
                    1 => "   ",
                    2 if draw.chance(0.5) => " \\\n ",
                    3 if draw.chance(0.3) => " \\\n",
                    _ => " ",
                });
            }
            line.push_str(word);
        }
        match draw.below(10) {
            0 => line.push_str(" # said at the end"),
            1 => line.push_str("  "),
            2 if draw.chance(0.5) => line.push_str(" #"),
            _ => {}
        }
        self.lines.push(line);
    }

    /// What carries no geometry.
    fn aside(&mut self, draw: &mut Draw) {
        for _ in 0..draw.below(3) {
            let line = match draw.below(14) {
                0 => "# a comment",
                1 => "#",
                2 => "usemtl",
                3 => "usemtl steel",
                4 => "mtllib none.mtl other.mtl",
                5 => "g",
                6 => "g one two",
                7 => "o a body",
                8 => "s off",
                9 => "s 1",
                10 => "",
                11 => "\t ",
                12 => "o",
                _ => "vp 0.5 0.5",
            };
            self.lines.push(line.to_owned());
        }
        if draw.chance(0.2) {
            self.textures += 1;
            self.lines.push("vt 0.5 0.25".to_owned());
        }
        if draw.chance(0.2) {
            self.normals += 1;
            self.lines.push("vn 0 0 1".to_owned());
        }
        if draw.chance(0.1) && self.vertices.len() > 1 {
            self.lines.push("l 1 2".to_owned());
        }
        if draw.chance(0.1) && !self.vertices.is_empty() {
            self.lines.push("p -1".to_owned());
        }
        if draw.chance(0.2) {
            // Nobody names it, or it is in the place of another.
            let again = !self.vertices.is_empty() && draw.chance(0.5);
            let place = if again {
                self.vertices[draw.below(self.vertices.len())]
            } else {
                Vector3::zeros()
            };
            self.repeated(draw, place, again);
        }
    }

    /// A vertex, exactly in its place where it repeats another.
    fn repeated(&mut self, draw: &mut Draw, place: Vector3<f64>, again: bool) -> usize {
        if !again {
            return self.vertex(draw, false);
        }
        self.lines.push(format!("v {:?} {:?} {:?}", place.x, place.y, place.z));
        self.vertices.push(place);
        self.vertices.len() - 1
    }

    fn face(
        &mut self,
        draw: &mut Draw,
        corners: Vec<usize>,
        area: Option<Vector3<f64>>,
        plain: bool,
    ) {
        let from_end = draw.chance(0.4);
        let form = if plain { 0 } else { draw.below(4) };
        let mut words = vec!["f".to_owned()];
        for &corner in &corners {
            let back = (self.vertices.len() - corner) as i64;
            let v = if from_end { -back } else { corner as i64 + 1 };
            words.push(match form {
                1 if self.textures > 0 => format!("{v}/{}", self.textures),
                2 if self.normals > 0 => format!("{v}//{}", self.normals),
                3 if self.textures > 0 && self.normals > 0 => format!("{v}/-1/-1"),
                _ => v.to_string(),
            });
        }
        self.line(draw, &words, plain);
        self.faces.push(Face { corners, area });
    }

    fn triangle(&mut self, draw: &mut Draw, plain: bool) {
        while self.vertices.len() < 3 {
            self.vertex(draw, plain);
        }
        let n = self.vertices.len();
        let mut corners = vec![draw.below(n)];
        for _ in 0..2 {
            let place = self.vertices[draw.below(n)];
            let fits =
                |k: &usize| corners.iter().all(|c: &usize| self.vertices[*c] != self.vertices[*k]);
            let start = (0..n).find(|&k| self.vertices[k] == place).unwrap_or(0);
            let Some(next) = (0..n).map(|k| (start + k) % n).find(fits) else { return };
            corners.push(next);
        }
        self.face(draw, corners, None, plain);
    }

    /// A polygon in a plane, convex or not, on vertices of its own.
    fn polygon(&mut self, draw: &mut Draw, plain: bool) {
        let outline = outline(draw);
        let axis = Vector3::from_fn(|_, _| draw.symmetric());
        let e = if axis.norm() > 0.1 { axis.normalize() } else { Vector3::x() };
        let f = e.cross(&if e.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() }).normalize();
        let middle = Vector3::from_fn(|_, _| draw.symmetric() * 20.0);
        let flat = draw.chance(0.5);
        let corners: Vec<usize> = outline
            .iter()
            .map(|p| {
                let x = if flat {
                    Vector3::new(p.x, p.y, 0.0) + middle
                } else {
                    middle + e * p.x + f * p.y
                };
                // Digits are kept, so that the polygon stays in its plane.
                self.lines.push(format!("v {:?} {:?} {:?}", x.x, x.y, x.z));
                self.vertices.push(x);
                self.vertices.len() - 1
            })
            .collect();
        let area =
            outline.iter().zip(outline.iter().cycle().skip(1)).map(|(p, q)| p.perp(q)).sum::<f64>();
        let normal = if flat { Vector3::z() } else { e.cross(&f) };
        self.face(draw, corners, Some(normal * (0.5 * area)), plain);
    }

    /// Two triangles that share an edge, of which one may be named from the end.
    fn strip(&mut self, draw: &mut Draw, plain: bool) {
        let first: Vec<usize> = (0..4).map(|_| self.vertex(draw, plain)).collect();
        let distinct = |k: [usize; 3]| {
            let x = k.map(|k| self.vertices[first[k]]);
            x[0] != x[1] && x[1] != x[2] && x[2] != x[0]
        };
        if distinct([0, 1, 2]) && distinct([1, 3, 2]) {
            self.face(draw, vec![first[0], first[1], first[2]], None, plain);
            self.face(draw, vec![first[1], first[3], first[2]], None, plain);
        }
    }

    /// Breaks one line, and says which.
    fn spoil(&mut self, draw: &mut Draw) -> (usize, &'static str) {
        let n = self.vertices.len();
        let (line, what) = match draw.below(8) {
            0 => ("v 1 2".to_owned(), "a vertex of two numbers"),
            1 => ("v 0 zero 1".to_owned(), "a word for a number"),
            2 => (format!("f 1 2 {}", n + 1 + draw.below(5)), "a vertex that does not exist"),
            3 => ("f 1 0 1".to_owned(), "the vertex 0"),
            4 => ("f 1 2".to_owned(), "a face of two corners"),
            5 => (format!("f 1 2 -{}", n + 1), "a vertex before the first"),
            6 => ("v 1 inf 0".to_owned(), "an infinite coordinate"),
            _ => ("f 1 2 x".to_owned(), "a word for a vertex"),
        };
        self.lines.push(line);
        let count = self.lines.iter().map(|line| 1 + line.matches('\n').count()).sum();
        (count, what)
    }
}

/// A simple polygon around the origin: regular, a star, or an L, a comb, a spiral's arm.
fn outline(draw: &mut Draw) -> Vec<Vector2<f64>> {
    let points = |list: &[[f64; 2]]| list.iter().map(|&p| Vector2::from(p)).collect::<Vec<_>>();
    let mut corners = match draw.below(5) {
        0 => points(&[[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 4.0], [0.0, 4.0]]),
        1 => {
            let teeth = draw.between(1, 4);
            let mut list = vec![[2.0 * teeth as f64, -1.0], [0.0, -1.0]];
            for k in 0..teeth {
                let x = 2.0 * k as f64;
                list.extend([[x, 3.0], [x + 1.0, 3.0], [x + 1.0, 0.0], [x + 2.0, 0.0]]);
            }
            list.dedup();
            list.reverse();
            points(&list)
        }
        2 => points(&[[0.0, 0.0], [2.0, 1.0], [4.0, 0.0], [2.0, 4.0]]),
        _ => {
            let n = draw.between(3, 12);
            let least = draw.one_of(&[0.15, 1.0]);
            (0..n)
                .map(|k| {
                    let (s, c) = (std::f64::consts::TAU * k as f64 / n as f64).sin_cos();
                    Vector2::new(c, s) * draw.uniform(least, 1.0) * 2.0
                })
                .collect()
        }
    };
    let turn = draw.below(corners.len());
    corners.rotate_left(turn);
    if draw.chance(0.3) {
        corners.reverse();
    }
    corners
}

/// The triangles of the mesh in the order of the faces: n - 2 for a face of n corners.
fn judge(text: &Text, Obj { mesh, numbers }: &Obj) -> Verdict {
    let count: usize = text.faces.iter().map(|face| face.corners.len() - 2).sum();
    if text.faces.is_empty() {
        return Verdict::wrong("a mesh of no faces");
    }
    if mesh.simplices().len() != count {
        return Verdict::wrong(format!("{} triangles instead of {count}", mesh.simplices().len()));
    }
    if numbers.len() != text.vertices.len() {
        return Verdict::wrong(format!("{} of {} numbers", numbers.len(), text.vertices.len()));
    }
    for (vertex, (number, place)) in numbers.iter().zip(&text.vertices).enumerate() {
        // Used where a face names it, or another vertex at its place.
        let is_here = |corner: &usize| text.vertices[*corner] == *place;
        let used = text.faces.iter().any(|face| face.corners.iter().any(is_here));
        let right = match number {
            Some(number) => used && mesh.vertices().get(*number) == Some(place),
            None => !used,
        };
        if !right {
            return Verdict::wrong(format!(
                "vertex {vertex} of the file is {number:?} of the mesh"
            ));
        }
    }
    let mut triangles = mesh.simplices().iter();
    let mut verdict = Verdict::due();
    for face in &text.faces {
        let own: Vec<_> = triangles.by_ref().take(face.corners.len() - 2).collect();
        let places: Vec<[Vector3<f64>; 3]> = own.iter().map(|t| mesh.corners(t)).collect();
        let is_corner = |x: &Vector3<f64>| face.corners.iter().any(|&c| text.vertices[c] == *x);
        if !places.iter().flatten().all(is_corner) {
            return Verdict::wrong("a triangle with a corner that its face has not");
        }
        match face.area {
            None => {
                let written: Vec<_> = face.corners.iter().map(|&c| text.vertices[c]).collect();
                if !(0..3).any(|k| (0..3).all(|i| written[(i + k) % 3] == places[0][i])) {
                    return Verdict::wrong("another triangle than was written");
                }
            }
            Some(area) => {
                let size = area.norm();
                let normal = area / size;
                let pieces: Vec<f64> = places
                    .iter()
                    .map(|[a, b, c]| 0.5 * (b - a).cross(&(c - a)).dot(&normal))
                    .collect();
                let sum: f64 = pieces.iter().map(|piece| piece.abs()).sum();
                verdict = verdict.and(Verdict::of(
                    (sum - size).abs(),
                    1e-9 * size,
                    "the area of a polygon's triangles",
                ));
            }
        }
    }
    verdict
}
