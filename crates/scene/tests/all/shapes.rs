//! Capsules, cylinders, cones, ellipsoids, hulls and bodies of parts: how they roll, tip and balance.
//!
//! ```text
//! a = g sin(alpha) / (1 + I/(m r^2))       rolls down a slope of angle alpha without slipping
//! tan(alpha) = r/h                         tips over: h the height of the centre over the edge
//! ```

use std::fs;

use stationary_scene::{BodyFault, Fault, Run, Scene, SceneError};

const G: f64 = 9.81;

fn parsed(text: &str) -> Scene {
    Scene::parse("shapes.toml", text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn run(text: &str) -> Run {
    parsed(text).run().unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// A body on a floor under gravity that is tilted by an angle about the second axis, downhill along the
/// first, for half a second.
fn on_a_slope(angle: f64, body: &str, friction: f64) -> String {
    let (s, c) = angle.sin_cos();
    format!(
        "dimension = 3\nintegrator = \"variational-rotation\"\nstep = 0.002\nhorizon = 0.5\n\
         uniform_gravity = {{ acceleration = [{}, 0, {}] }}\n\
         bodies = [{{ name = \"it\", position = [0, 0, 3], {body} }}]\n\
         [contact]\nfriction = {friction}\ntouching = [[\"it\", \"floor\"]]\n\
         walls = [{{ name = \"floor\", normal = [0, 0, 1], at = [0, 0, 0] }}]\n",
        G * s,
        -G * c
    )
}

/// The velocity of the only body at the end, and how it is turned there.
fn end(run: &Run) -> ([f64; 3], [f64; 4]) {
    let field = run.bodies(run.times().len() - 1)[0];
    (field.velocity, field.orientation)
}

#[test]
fn round_bodies_roll_down_a_slope_as_their_moments_say() {
    let angle = 0.3_f64;
    // About an axis along the slope's level lines: a quarter turn about the first axis lays it down.
    let laid = "rotation = [1.5707963267948966, 0, 0]";
    let (a, r) = (0.4_f64, 0.2_f64);
    let ends = (2.0 / 3.0 * r) / (a + 2.0 / 3.0 * r);
    let of_capsule = 0.5 * (1.0 - ends) + 0.4 * ends;
    let bodies = [
        ("cylinder = { length = 0.8, radius = 0.2 }", laid, 0.5),
        ("capsule = { length = 0.8, radius = 0.2 }", laid, of_capsule),
        ("ellipsoid = [0.2, 0.5, 0.2]", "rotation = [0, 0, 0]", 0.4),
        (
            "parts = [{ mass = 1, ball = 0.2, at = [0, 0.4, 0] }, { mass = 1, ball = 0.2, at = [0, -0.4, 0] }]",
            "rotation = [0, 0, 0]",
            0.4,
        ),
    ];
    for (shape, turned, part) in bodies {
        let mass = if shape.starts_with("parts") { "" } else { "mass = 2, " };
        let run = run(&on_a_slope(angle, &format!("{mass}{shape}, {turned}"), 0.9));
        let expected = G * angle.sin() / (1.0 + part) * 0.5;
        let ([along, across, up], _) = end(&run);
        assert!((along / expected - 1.0).abs() < 2e-3, "{shape}: {along} {expected}");
        assert!(across.abs() < 1e-6 && up.abs() < 1e-6, "{shape}: {across} {up}");
    }
}

#[test]
fn a_cylinder_and_a_cone_tip_where_their_centre_passes_the_edge() {
    let (radius, length, height) = (0.1_f64, 0.5_f64, 0.6_f64);
    let bodies = [
        (format!("mass = 1, cylinder = {{ length = {length}, radius = {radius} }}"), 0.5 * length),
        (format!("mass = 1, cone = {{ height = {height}, radius = {radius} }}"), 0.25 * height),
    ];
    for (body, centre) in bodies {
        let border = (radius / centre).atan();
        for (part, tips) in [(0.95, false), (1.05, true)] {
            let run = run(&on_a_slope(part * border, &body, 5.0));
            let (velocity, orientation) = end(&run);
            let turned = 2.0 * orientation[1].hypot(orientation[2]).asin();
            let speed = velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
            if tips {
                assert!(turned > 0.02 && speed > 0.02, "{body}: {turned} {speed}");
            } else {
                assert!(turned < 1e-6 && speed < 1e-6, "{body}: {turned} {speed}");
            }
        }
    }
}

#[test]
fn a_hull_moves_as_the_box_whose_corners_it_has_however_it_is_drawn() {
    let half = [0.3, 0.2, 0.1];
    let corner = |k: usize| -> [f64; 3] {
        std::array::from_fn(|c| if k >> c & 1 == 1 { half[c] } else { -half[c] })
    };
    // Drawn about another place, in axes turned by an angle about the third.
    let (sin, cos) = 0.7_f64.sin_cos();
    let drawn = |[x, y, z]: [f64; 3]| [cos * x - sin * y + 4.0, sin * x + cos * y - 1.0, z + 2.0];
    let corners: Vec<[f64; 3]> = (0..8).map(|k| drawn(corner(k))).collect();
    let hull = format!("mass = 2, hull = {corners:?}, velocity = [0.4, 0.3, 0]");
    let cuboid =
        "mass = 2, box = [0.6, 0.4, 0.2], rotation = [0, 0, 0.7], velocity = [0.4, 0.3, 0]";
    let [one, other] = [hull.as_str(), cuboid].map(|body| run(&on_a_slope(0.2, body, 0.3)));
    let [mut own, mut moments] = [&one, &other].map(|run| run.scene().bodies()[0].moments);
    own.sort_by(f64::total_cmp);
    moments.sort_by(f64::total_cmp);
    for (own, moment) in own.iter().zip(moments) {
        assert!((own / moment - 1.0).abs() < 1e-12, "{own} {moment}");
    }
    let last = one.times().len() - 1;
    let place = |run: &Run| -> [f64; 3] { std::array::from_fn(|c| run.positions(last)[c]) };
    let [one_end, other_end] = [&one, &other].map(place);
    for c in 0..3 {
        assert!((one_end[c] - other_end[c]).abs() < 1e-6, "{one_end:?} {other_end:?}");
    }
}

#[test]
fn parts_add_up_by_the_parallel_axis_rule_in_the_plane_and_in_space() {
    let head = |dimension: usize, method: &str| {
        format!("dimension = {dimension}\nintegrator = \"{method}\"\nstep = 0.1\nhorizon = 0.1\n")
    };
    let two = "bodies = [{ name = \"it\", parts = [{ mass = 3, ball = 0.2, at = [1, 0] }, \
               { mass = 1, box = [0.6, 0.3], at = [3, 0], rotation = 1 }] }]";
    let scene = parsed(&(head(2, "stormer-verlet") + two));
    let body = &scene.bodies()[0];
    let expected = 3.0 * (0.02 + 0.25) + (0.36 + 0.09) / 12.0 + 1.5 * 1.5;
    assert!((body.moments[2] / expected - 1.0).abs() < 1e-14, "{:?}", body.moments);
    assert_eq!((body.mass, body.position), (4.0, [1.5, 0.0, 0.0]));
    let bar = "bodies = [{ name = \"it\", position = [0, 0, 0], parts = [\
               { mass = 2, ball = 0.5, at = [1, 1, 0] }, { mass = 2, ball = 0.5, at = [-1, -1, 0] }] }]";
    let scene = parsed(&(head(3, "variational-rotation") + bar));
    let mut moments = scene.bodies()[0].moments;
    moments.sort_by(f64::total_cmp);
    let own = 0.4 * 4.0 * 0.25;
    for (found, expected) in moments.iter().zip([own, own + 8.0, own + 8.0]) {
        assert!((found / expected - 1.0).abs() < 1e-14, "{moments:?}");
    }
}

#[test]
fn a_planar_capsule_has_the_moment_of_the_plate_that_it_is() {
    // Against a polygon of many corners.
    let (a, r, n) = (0.7, 0.25, 4000);
    let corner = |k: usize| {
        let angle = std::f64::consts::TAU * (k as f64 + 0.5) / n as f64;
        let side = if angle.cos() > 0.0 { a } else { -a };
        [side + r * angle.cos(), r * angle.sin()]
    };
    let corners: Vec<[f64; 2]> = (0..n).map(corner).collect();
    let head = "dimension = 2\nintegrator = \"stormer-verlet\"\nstep = 0.1\nhorizon = 0.1\n";
    let [capsule, polygon] = [
        format!("capsule = {{ length = {}, radius = {r} }}", 2.0 * a),
        format!("polygon = {corners:?}"),
    ]
    .map(|shape| {
        let body = format!("name = \"it\", mass = 2, position = [0, 0], {shape}");
        parsed(&format!("{head}bodies = [{{ {body} }}]")).bodies()[0].moments[2]
    });
    assert!((capsule / polygon - 1.0).abs() < 1e-6, "{capsule} {polygon}");
}

#[test]
fn what_is_no_shape_is_refused_where_it_stands() {
    let fault = |dimension: usize, body: &str| {
        let method = if dimension == 3 { "variational-rotation" } else { "stormer-verlet" };
        let at = if dimension == 3 { "[0, 0, 0]" } else { "[0, 0]" };
        let text = format!(
            "dimension = {dimension}\nintegrator = \"{method}\"\nstep = 0.1\nhorizon = 1\n\
             bodies = [{{ name = \"it\", position = {at}, {body} }}]"
        );
        match Scene::parse("bad.toml", &text) {
            Err(SceneError::Invalid(diagnostic)) => {
                let place = diagnostic.place.as_ref().map(|place| place.line);
                assert_eq!(place, Some(5), "{diagnostic}");
                diagnostic.fault.clone()
            }
            other => panic!("{body}: {other:?}"),
        }
    };
    for (shape, what) in [
        ("cylinder = { length = -1, radius = 1 }", "the length"),
        ("cylinder = { length = 1, radius = 0 }", "the radius"),
        ("capsule = { length = 0, radius = 1 }", "the length"),
        ("cone = { height = -2, radius = 1 }", "the height"),
        ("cone = { height = 2, radius = -1 }", "the radius"),
        ("ellipsoid = [1, -1, 1]", "the half axis of an ellipsoid"),
        ("parts = [{ mass = 0, ball = 1 }]", "the mass"),
        ("parts = [{ mass = 1, ball = -1 }]", "the radius"),
    ] {
        let mass = if shape.starts_with("parts") { "" } else { "mass = 1, " };
        let fault = fault(3, &format!("{mass}{shape}"));
        assert!(matches!(fault, Fault::NotPositive { what: of, .. } if of == what), "{fault}");
    }
    let flat = "[[0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1]]";
    assert_eq!(fault(3, &format!("mass = 1, hull = {flat}")), Fault::Bodies(BodyFault::FlatHull));
    assert_eq!(fault(3, "mass = 1, hull = []"), Fault::Bodies(BodyFault::FlatHull));
    assert_eq!(
        fault(3, "mass = 1, hull = [[0, 0, 0], [1, 0, 0]]"),
        Fault::Bodies(BodyFault::FlatHull)
    );
    let many = format!("mass = 1, hull = {:?}", vec![[0.5_f64; 3]; 501]);
    assert!(matches!(fault(3, &many), Fault::TooMany { count: 501, .. }));
    for word in ["cylinder", "cone", "ellipsoid", "hull"] {
        let shape = match word {
            "cylinder" => "{ length = 1, radius = 1 }",
            "cone" => "{ height = 1, radius = 1 }",
            _ => "[]",
        };
        let fault = fault(2, &format!("mass = 1, {word} = {shape}"));
        assert_eq!(fault, Fault::Bodies(BodyFault::SolidInThePlane(word)));
    }
    assert_eq!(fault(3, "mass = 1"), Fault::Bodies(BodyFault::BodyShape("it".to_owned())));
    assert_eq!(
        fault(3, "mass = 1, ball = 1, box = [1, 1, 1]"),
        Fault::Bodies(BodyFault::BodyShape("it".to_owned()))
    );
    assert_eq!(fault(3, "ball = 1"), Fault::NoMass("it".to_owned()));
    assert_eq!(fault(3, "parts = []"), Fault::Bodies(BodyFault::NoParts));
    assert_eq!(fault(3, "parts = [{ mass = 1 }]"), Fault::Bodies(BodyFault::PartShape));
    assert_eq!(
        fault(3, "mass = 1, parts = [{ mass = 1, ball = 1 }]"),
        Fault::Bodies(BodyFault::MassOfParts)
    );
    let both = fault(3, "ball = 1, parts = [{ mass = 1, ball = 1 }]");
    assert_eq!(both, Fault::Bodies(BodyFault::BodyShape("it".to_owned())));
    let missing = fault(3, "mass = 1, cylinder = { length = 1 }").to_string();
    assert!(missing.contains("radius"), "{missing}");
}

#[test]
fn round_bodies_are_drawn_in_the_picture_the_page_and_for_paraview() {
    let folder = std::env::temp_dir().join(format!("stationary-shapes-{}", std::process::id()));
    let bodies = [
        "mass = 1, cylinder = { length = 0.8, radius = 0.2 }",
        "mass = 1, cone = { height = 0.8, radius = 0.2 }",
        "mass = 1, capsule = { length = 0.8, radius = 0.2 }",
        "mass = 1, ellipsoid = [0.1, 0.2, 0.3]",
        "parts = [{ mass = 1, box = [1, 1, 1] }, { mass = 1, ball = 0.3, at = [0, 0, 1] }]",
    ];
    for body in bodies {
        let run = run(&on_a_slope(0.1, body, 0.5));
        let out = folder.join("out");
        let _ = fs::remove_dir_all(&out);
        run.write(&out).unwrap();
        run.write_vtk(&out).unwrap();
        let picture = run.picture();
        assert!(!picture.contains("NaN"), "{body}");
        // An outline of the body at the end, filled.
        assert!(picture.matches("opacity=\"0.16\"").count() >= 1, "{body}\n{picture}");
        let grid = fs::read_to_string(out.join("trajectory/000000.vtu")).unwrap();
        let number = |name: &str| -> usize {
            let from = grid.find(name).unwrap() + name.len() + 2;
            grid[from..].split('"').next().unwrap().parse().unwrap()
        };
        let points = number("NumberOfPoints");
        assert!(points > 33 && number("NumberOfCells") > 60, "{body}: {points}");
        for array in ["\"particle\"", "\"orientation\"", "\"velocity\""] {
            let from = grid.find(&format!("Name={array}")).unwrap();
            let inside = grid[from..].split('>').nth(1).unwrap().split('<').next().unwrap();
            let each = match array {
                "\"particle\"" => 1,
                "\"orientation\"" => 4,
                _ => 3,
            };
            assert_eq!(inside.split_whitespace().count(), each * points, "{body}: {array}");
        }
        let page = fs::read_to_string(out.join("player.html")).unwrap();
        assert!(page.contains("\"surfaces\":[{\"centre\":0,"), "{body}");
    }
    fs::remove_dir_all(&folder).unwrap();
}
