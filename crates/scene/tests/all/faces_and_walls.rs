//! What is drawn of surfaces and walls has the sizes of what it stands for.

use std::fs;

use nalgebra::Vector3;
use stationary_scene::Scene;

use crate::output::{array, folder, page};

/// VTK's number for a triangle.
const TRIANGLE: f64 = 5.0;

/// The area of each triangle of a scene at its start.
fn areas(name: &str, text: &str) -> Vec<f64> {
    let method = if text.contains("bodies") { "axis-rotations" } else { "stormer-verlet" };
    let head = format!("dimension = 3\nintegrator = \"{method}\"\nstep = 0.1\nhorizon = 0.1\n");
    let out = folder(name);
    Scene::parse("scene", &(head + text)).unwrap().run().unwrap().write_vtk(&out).unwrap();
    let index = fs::read_to_string(out.join("trajectory.pvd")).unwrap();
    let (_, rest) = index.split_once("file=\"").unwrap();
    let start = fs::read_to_string(out.join(rest.split('"').next().unwrap())).unwrap();
    let points: Vec<Vector3<f64>> =
        array(&start, "points").as_chunks::<3>().0.iter().map(|&x| x.into()).collect();
    let (corners, types) = (array(&start, "connectivity"), array(&start, "types"));
    let offsets = array(&start, "offsets");
    let triangles = types.iter().zip(&offsets).filter(|&(&kind, _)| kind == TRIANGLE);
    let area = |(_, &end): (&f64, &f64)| {
        let corner = |k: usize| points[corners[end as usize - k] as usize];
        0.5 * (corner(2) - corner(3)).cross(&(corner(1) - corner(3))).norm()
    };
    triangles.map(area).collect()
}

#[test]
fn the_faces_of_a_box_have_its_area() {
    let text = "bodies = [{ name = \"a\", mass = 1, box = [1, 2, 3], position = [0, 0, 0] }]";
    let areas = areas("box", text);
    assert_eq!(areas.len(), 12);
    assert!((areas.iter().sum::<f64>() - 22.0).abs() < 1e-12);
}

#[test]
fn a_chain_of_points_that_returns_encloses_a_face_where_it_is_convex() {
    let with = |points: &str| {
        let body = "name = \"a\", mass = 1, moments = [1, 1, 1], position = [0, 0, 0]";
        areas("points", &format!("bodies = [{{ {body}, points = [{points}] }}]"))
    };
    let square = with("[5, 5, 5], [0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [0, 0, 0]");
    assert!((square.iter().sum::<f64>() - 4.0).abs() < 1e-12);
    assert_eq!(with("[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]"), [0.0; 0]);
    assert_eq!(with("[0, 0, 0], [2, 1, 0], [0, 2, 0], [1, 1, 0], [0, 0, 0]"), [0.0; 0]);
}

#[test]
fn the_cells_of_a_net_have_its_area() {
    let areas = areas(
        "net",
        "particles = [{ name = \"a\", mass = 1, position = [9, 9, 9] }]\n\
         nets = [{ name = \"net\", rows = 4, columns = 6, spacing = 0.5, origin = [0, 0, 0],\n\
         particle_mass = 1, stiffness = 1 }]",
    );
    assert!((areas.iter().sum::<f64>() - 1.5 * 2.5).abs() < 1e-12);
}

/// The corners of the wall that is drawn, if any.
fn walls(name: &str, dimension: usize, normal: &str, at: &str) -> Vec<[[f64; 3]; 4]> {
    let place = |x: f64| format!("{:?}", &[x, 2.0, 1.0][..dimension]);
    let text = format!(
        "dimension = {dimension}\nintegrator = \"stormer-verlet\"\nstep = 0.1\nhorizon = 1\n\
         particles = [{{ name = \"a\", mass = 1, position = {} }},\n\
         {{ name = \"b\", mass = 1, position = {} }}]\n\
         contact = {{ walls = [{{ normal = {normal}, at = {at} }}] }}",
        place(0.0),
        place(4.0)
    );
    let run = Scene::parse("scene", &text).unwrap().run().unwrap();
    serde_json::from_value(page(&run, name).0["walls"].take()).unwrap()
}

#[test]
fn a_wall_in_the_plane_is_a_band_below_its_line() {
    let [corners] = walls("band", 2, "[0, 1]", "[7, 1]")[..] else { panic!("one wall") };
    for [x, y, z] in corners {
        assert!((-0.17..4.17).contains(&x) && (0.9..=1.0).contains(&y) && z == 0.0);
    }
    assert!(corners.iter().filter(|x| x[1] == 1.0).count() == 2);
}

#[test]
fn a_wall_in_space_lies_in_its_plane() {
    let [corners] = walls("plane", 3, "[0, 0.6, 0.8]", "[0, 0, 0]")[..] else { panic!("one wall") };
    for [x, y, z] in corners {
        assert!((0.6 * y + 0.8 * z).abs() < 1e-12 && (-0.2..4.2).contains(&x));
    }
}

#[test]
fn a_wall_far_from_everything_is_not_drawn() {
    assert_eq!(walls("far", 2, "[0, 1]", "[0, -3]"), [] as [[[f64; 3]; 4]; 0]);
}
