//! Every public function of mesh with bad numbers, sizes and empty lists.

use nalgebra::{SVector, Vector2, Vector3};
use stationary_mesh as mesh;
use stationary_mesh::{
    ClosedSurface, Diagonals, IntrinsicSurface, IntrinsicTriangle, Mesh, MeshError, Moments,
    Polygon, Quadratic, Quality, Simplex, Split, VtkField, write_vtk,
};

use crate::{Draw, Verdict};

fn number(draw: &mut Draw) -> f64 {
    if draw.chance(0.3) { draw.any_f64() } else { draw.symmetric() * 10.0 }
}

fn place<const D: usize>(draw: &mut Draw, bad: bool) -> SVector<f64, D> {
    let whole = draw.chance(0.3);
    SVector::from_fn(|_, _| match (bad, whole) {
        (true, _) => number(draw),
        (_, true) => draw.below(4) as f64,
        _ => draw.symmetric(),
    })
}

fn places<const D: usize>(draw: &mut Draw) -> Vec<SVector<f64, D>> {
    let bad = draw.chance(0.2);
    (0..draw.below(9)).map(|_| place(draw, bad)).collect()
}

/// Simplices over so many vertices, now and then over others.
fn simplices<const N: usize>(draw: &mut Draw, vertices: usize) -> Vec<[usize; N]> {
    let wild = draw.chance(0.1);
    (0..draw.below(8))
        .map(|_| {
            let mut corners = [0; N];
            let start = draw.below(vertices.max(1));
            for (k, corner) in corners.iter_mut().enumerate() {
                *corner = match (wild, draw.chance(0.6)) {
                    (true, _) => draw.one_of(&[0, 1, vertices, usize::MAX]),
                    (_, true) => (start + k) % vertices.max(1),
                    _ => draw.below(vertices.max(1)),
                };
            }
            corners
        })
        .collect()
}

fn finite(what: &str, numbers: impl IntoIterator<Item = f64>) -> Verdict {
    match numbers.into_iter().find(|x| !x.is_finite()) {
        None => Verdict::due(),
        Some(x) => Verdict::wrong(format!("Ok with {x} in {what}")),
    }
}

fn of_moments<const D: usize>(what: &str, moments: &Moments<D>) -> Verdict {
    let numbers = std::iter::once(moments.measure)
        .chain(moments.first.iter().copied())
        .chain(moments.second.iter().copied())
        .chain(moments.about.iter().copied());
    finite(what, numbers)
}

pub(super) fn trial(draw: &mut Draw) -> Verdict {
    match draw.below(9) {
        0 => any_mesh::<1, 2>(draw).and(any_mesh::<2, 2>(draw)),
        1 => any_mesh::<2, 3>(draw),
        2 => any_mesh::<3, 4>(draw),
        3 => surface(draw),
        4 => polygon(draw),
        5 => generators(draw),
        6 => texts(draw),
        7 => quadratic(draw),
        _ => small(draw),
    }
}

fn any_mesh<const D: usize, const K: usize>(draw: &mut Draw) -> Verdict
where
    [usize; K]: Simplex,
{
    let vertices = places::<D>(draw);
    let simplices = simplices::<K>(draw, vertices.len());
    draw.note(format!("{D} dimensions: {vertices:?} {simplices:?}"));
    let Ok(mesh) = Mesh::new(vertices, simplices) else { return Verdict::due() };
    let _ = (mesh.components(), mesh.edges(), mesh.simplices_at_vertices().get(draw.below(9)));
    let _ = (mesh.euler_characteristic(), mesh.facet_uses(), mesh.neighbours());
    let _ = (mesh.boundary_facets(), mesh.check_closed(), mesh.check_oriented(), mesh.oriented());
    let _ = (mesh.check_referenced(), mesh.referenced(), mesh.reversed(), mesh.beside(&mesh));
    let _ = (mesh.check_nondegenerate(), mesh.refined());
    let bad = number(draw);
    let _ = mesh.mapped(|x| x * bad);
    finite("measures", mesh.measures())
        .and(finite("the measure", [mesh.measure()]))
        .and(of_moments("moments", &mesh.moments()))
}

fn surface(draw: &mut Draw) -> Verdict {
    let vertices = places::<3>(draw);
    let triangles = simplices::<3>(draw, vertices.len());
    let made = match draw.below(3) {
        0 => mesh::icosphere(1.0, 1),
        1 => mesh::cuboid([1.0, 2.0, 3.0], [1, 1, 1]).map(|solid| solid.boundary().mesh),
        _ => Mesh::new(vertices.clone(), triangles.clone()),
    };
    draw.note(format!("{vertices:?} {triangles:?}"));
    let Ok(made) = made else { return Verdict::due() };
    let moved: Vec<_> = made
        .vertices()
        .iter()
        .map(|x| if draw.chance(0.1) { place(draw, true) } else { *x })
        .collect();
    draw.note(format!("moved {moved:?}"));
    let Ok(moved) = Mesh::new(moved, made.simplices().to_vec()) else { return Verdict::due() };
    let _ = (moved.boundary(), moved.check_manifold());
    for quality in [Quality::MeanRatio, Quality::RadiusRatio, Quality::AspectRatio] {
        if moved.quality(quality).iter().any(|q| q.is_nan()) {
            return Verdict::wrong(format!("{quality:?} is NaN"));
        }
    }
    let closed = match ClosedSurface::new(moved.clone()) {
        Ok(closed) => Ok(closed),
        Err(_) => ClosedSurface::oriented(&moved),
    };
    match closed {
        Ok(closed) => {
            let bad = draw.chance(0.5);
            let point: Vector3<f64> = place(draw, bad);
            let finite_point = point.iter().all(|x| x.is_finite());
            let winding = closed.winding_number(&point);
            of_moments("a closed surface's moments", &closed.moments()).and(if finite_point {
                finite("a winding number", [winding])
            } else {
                Verdict::due()
            })
        }
        Err(_) => Verdict::due(),
    }
}

fn polygon(draw: &mut Draw) -> Verdict {
    let outlines: Vec<Vec<Vector2<f64>>> = (0..draw.below(3)).map(|_| places::<2>(draw)).collect();
    draw.note(format!("{outlines:?}"));
    match Polygon::new(outlines) {
        Ok(polygon) => {
            let _ = polygon.contains(&place(draw, true));
            let _ = polygon.boundary();
            of_moments("a polygon's moments", &polygon.moments())
        }
        Err(_) => Verdict::due(),
    }
}

/// A count that is usually small.
fn cells(draw: &mut Draw) -> usize {
    if draw.chance(0.1) {
        draw.one_of(&[usize::MAX, usize::MAX / 2, 1 << 40, 1 << 33])
    } else {
        draw.below(5)
    }
}

fn generators(draw: &mut Draw) -> Verdict {
    let x = [number(draw), number(draw), number(draw)];
    let n = [cells(draw), cells(draw), cells(draw)];
    let kind = draw.below(16);
    draw.note(format!("generator {kind}: {x:?} {n:?}"));
    let size = x.map(f64::abs);
    fn of<const D: usize, const K: usize>(made: Result<Mesh<D, K>, MeshError>) -> Verdict {
        made.map_or(Verdict::due(), |mesh| finite("measures", mesh.measures()))
    }
    fn curved<const D: usize, const K: usize, const N: usize>(
        made: Result<Quadratic<D, K, N>, MeshError>,
    ) -> Verdict
    where
        [usize; K]: Simplex,
    {
        made.map_or(Verdict::due(), |mesh| {
            finite("nodes", mesh.nodes().iter().flat_map(|x| x.iter().copied().collect::<Vec<_>>()))
        })
    }
    let plate = mesh::rectangle([1.0, 2.0], [2, 1], Diagonals::Same);
    match kind {
        0 => of(mesh::bar(x[0], n[0])),
        1 => of(mesh::segment::<3>(Vector3::from(x), Vector3::from([x[1], x[2], x[0]]), n[0])),
        2 => of(mesh::circle(x[0], n[0])),
        3 => of(mesh::rectangle([x[0], x[1]], [n[0], n[1]], Diagonals::Same)),
        4 => of(mesh::disc(x[0], n[0])),
        5 => curved(mesh::curved_disc(x[0], n[0])),
        6 => of(mesh::icosphere(x[0], n[0])),
        7 => curved(mesh::curved_sphere(x[0], n[0])),
        8 => of(mesh::ball(x[0], n[0])),
        9 => curved(mesh::curved_ball(x[0], n[0])),
        10 => of(mesh::torus([x[0], x[1]], [n[0], n[1]])),
        11 => curved(mesh::curved_torus([size[0], size[1]], [n[0], n[1]])),
        12 => of(mesh::cuboid(x, n)),
        13 => plate.map_or(Verdict::wrong("a plate"), |p| of(mesh::extruded(&p, x[0], n[0]))),
        14 => {
            of(mesh::elliptic_membrane([n[0], n[1]])).and(of(mesh::tapered_membrane([n[0], n[1]])))
        }
        _ => curved(mesh::curved_elliptic_membrane([n[0], n[1]])),
    }
}

/// Texts that are nearly OBJ or MSH.
fn texts(draw: &mut Draw) -> Verdict {
    const WORDS: [&str; 30] = [
        "v",
        "f",
        "vt",
        "vn",
        "l",
        "usemtl",
        "mtllib",
        "\n",
        "\n",
        "\n",
        "\\\n",
        "#",
        "1",
        "2",
        "3",
        "-1",
        "0",
        "1/2/3",
        "1//",
        "/",
        "99999999999999999999",
        "-9223372036854775808",
        "nan",
        "1e400",
        "0.5",
        "\u{feff}",
        "\u{0}",
        "$Nodes",
        "f 1 2 3\n",
        "v 0 0 1\n",
    ];
    let mut text: Vec<u8> = Vec::new();
    let msh = draw.chance(0.4);
    if msh {
        text.extend(b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n");
    }
    for _ in 0..draw.below(30) {
        if draw.chance(0.02) {
            text.push(draw.below(256) as u8);
        } else {
            text.extend(draw.one_of(&WORDS).bytes());
            text.push(b' ');
        }
    }
    draw.note(format!("{:?}", String::from_utf8_lossy(&text)));
    if draw.chance(0.05) {
        return files(draw, &text, msh);
    }
    if msh {
        return match mesh::parse_msh(&text[..]) {
            Ok(msh) => {
                let _ = (msh.segments(), msh.triangles(), msh.tetrahedra());
                let _ = (msh.quadratic_segments(), msh.quadratic_triangles());
                let _ = msh.quadratic_tetrahedra();
                Verdict::due()
            }
            Err(_) => Verdict::due(),
        };
    }
    match mesh::parse_obj(&text[..]) {
        Ok(obj) => finite("measures", obj.mesh.measures()),
        Err(_) => Verdict::due(),
    }
}

/// A file is read as its text is; a folder, and what is not there, not at all.
fn files(draw: &mut Draw, text: &[u8], msh: bool) -> Verdict {
    let folder = std::env::temp_dir();
    let name = format!("stationary-trial-{}-{:x}", std::process::id(), draw.word());
    let file = folder.join(name);
    let (is_read, is_parsed) = match draw.below(3) {
        0 => (mesh::read_obj(&folder).is_ok() || mesh::read_msh(&folder).is_ok(), false),
        1 => (mesh::read_obj(&file).is_ok() || mesh::read_msh(&file).is_ok(), false),
        _ => {
            if std::fs::write(&file, text).is_err() {
                return Verdict::not_judged("no folder to write to");
            }
            let read =
                if msh { mesh::read_msh(&file).is_ok() } else { mesh::read_obj(&file).is_ok() };
            let parsed =
                if msh { mesh::parse_msh(text).is_ok() } else { mesh::parse_obj(text).is_ok() };
            let _ = std::fs::remove_file(&file);
            (read, parsed)
        }
    };
    if is_read == is_parsed {
        Verdict::due()
    } else {
        Verdict::wrong("a file read as other than its text")
    }
}

fn quadratic(draw: &mut Draw) -> Verdict {
    let nodes = places::<2>(draw);
    let elements = simplices::<6>(draw, nodes.len());
    draw.note(format!("{nodes:?} {elements:?}"));
    let bad = place(draw, true);
    if let Ok(plate) = mesh::rectangle([1.0, 1.0], [1, 1], Diagonals::Same) {
        let curved = Quadratic::<2, 3, 6>::curved(&plate, |_, x| x + bad);
        if let Ok(curved) = &curved {
            let checked = finite("a measure", [curved.measure()]);
            if checked != Verdict::due() {
                return checked;
            }
        }
    }
    match Quadratic::<2, 3, 6>::new(nodes, elements) {
        Ok(made) => {
            let _ = (made.check_positive(), made.corners(), made.mapped(|x| x + bad));
            finite("a measure", [made.measure()]).and(of_moments("moments", &made.moments()))
        }
        Err(_) => Verdict::due(),
    }
}

fn small(draw: &mut Draw) -> Verdict {
    let lengths = [number(draw), number(draw), number(draw)];
    let part = number(draw);
    draw.note(format!("lengths {lengths:?}, part {part:e}"));
    let verdict = match IntrinsicTriangle::new(lengths) {
        Some(triangle) => {
            finite("an area", [triangle.area()]).and(finite("angles", triangle.angles()))
        }
        None => Verdict::due(),
    };
    let _ = Split { ends: [0, 1], part: 0.5 }.between(lengths[0], lengths[1]);
    let flat = IntrinsicSurface::flat_torus([lengths[0], lengths[1]], [cells(draw).min(50), 3]);
    let verdict = match flat.and_then(|flat| flat.mollified(part)) {
        Ok(surface) => verdict.and(finite("an area", [surface.area()])),
        Err(_) => verdict,
    };
    let points = [[number(draw), number(draw)]; 2];
    let cell = [[draw.below(4), draw.below(4)]];
    let values = vec![number(draw); draw.below(4)];
    let mut file = Vec::new();
    let fields = [VtkField::Numbers("a b\n", &values)];
    let _ = write_vtk(&mut file, "t\n", &points, &cell, &fields);
    for degree in [0, 1, 2, 5] {
        let weights = mesh::simplex_quadrature::<3>(degree);
        let sum: f64 = weights.iter().map(|(_, w)| w).sum();
        if !sum.is_finite() {
            return Verdict::wrong("a rule without weights");
        }
    }
    verdict
}
