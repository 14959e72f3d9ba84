//! Words that nothing reads, names that are alike, and numbers that no scene has.

use stationary_import::{scene_of_mjcf, scene_of_urdf};
use stationary_scene::Scene;

const GEOM: &str = r#"<geom type="box" size="0.1 0.2 0.3"/>"#;

fn read(model: &str) -> stationary_import::Description {
    let read = scene_of_mjcf(&format!("<mujoco>{model}</mujoco>"), ".");
    let read = read.unwrap_or_else(|error| panic!("{model}\n{error}"));
    Scene::parse("a.toml", &read.text).unwrap_or_else(|error| panic!("{}\n{error}", read.text));
    read
}

fn error(model: &str) -> String {
    let read = scene_of_mjcf(&format!("<mujoco>{model}</mujoco>"), ".");
    read.map(|read| panic!("{model}\n{}", read.text)).unwrap_err().to_string()
}

fn arm(joint: &str, inside: &str) -> String {
    format!(
        "<worldbody>\n<body name=\"b\"><joint axis=\"0 1 0\" {joint}/>{inside}</body></worldbody>"
    )
}

#[test]
fn words_that_nothing_reads_are_told_with_their_line() {
    let box_with = |more: &str| format!(r#"<geom type="box" size="0.1 0.2 0.3" {more}/>"#);
    for (model, expected) in [
        (arm("dampng=\"3\"", GEOM), "`dampng` of joint, line 2"),
        (arm("springyield=\"1\" stiffness=\"2\"", GEOM), "`springyield` of joint, line 2"),
        (arm("", &box_with("Mass=\"3\"")), "`Mass` of geom, line 2"),
        (arm("", &box_with("margin=\"0.1\"")), "`margin` of geom, line 2"),
        (arm("", &box_with("surfacevel=\"1 0 0\"")), "`surfacevel` of geom, line 2"),
        (arm("", &(GEOM.to_owned() + "<goem size=\"1\"/>")), "unknown element goem, line 2"),
        (
            "<worldbody><joint/></worldbody>".to_owned() + &arm("", GEOM),
            "unknown element joint, line 1",
        ),
        ("<wordbody/>".to_owned() + &arm("", GEOM), "unknown element wordbody, line 1"),
        ("<option gravty=\"0 0 -1\"/>".to_owned() + &arm("", GEOM), "`gravty` of option, line 1"),
        (
            "<default><joint dampng=\"3\"/></default>".to_owned() + &arm("", GEOM),
            "`dampng` of joint, line 1",
        ),
    ] {
        assert_eq!(read(&model).left_out, [expected], "{model}");
    }
    // What no motion shows, or a zero, is no matter.
    let quiet = r#"<visual><global fovy="3"/></visual><option solver="CG"/><asset><texture name="t" builtin="flat"/>
      </asset>
      <default><site rgba="1 0 0 1"/><motor gear="2"/><geom margin="0" solref="0.02 1"/></default>
      <sensor><gyro site="s"/></sensor>"#;
    let told =
        read(&(quiet.to_owned() + &arm("group=\"1\"", &(GEOM.to_owned() + "<site name=\"s\"/>"))))
            .left_out;
    assert!(told.is_empty(), "{told:?}");
}

#[test]
fn names_that_are_alike_to_a_scene_are_counted() {
    let free =
        |name: &str, x: f64| format!("<body {name} pos=\"{x} 0 0\"><freejoint/>{GEOM}</body>");
    let long = "n".repeat(70);
    let named = |name: &str| format!("name=\"{name}\"");
    let all = [
        free("", 0.0),
        free(&named("body 1"), 1.0),
        free(&named("a.b"), 2.0),
        free(&named("a/b"), 3.0),
        free(&named("wall 1"), 4.0),
        free(&named(""), 5.0),
        free(&named(&long), 6.0),
    ];
    let plane = r#"<geom type="plane" size="1 1 1" pos="0 0 -9"/>"#;
    let read = read(&format!("<worldbody>{plane}{}</worldbody>", all.concat()));
    let scene = Scene::parse("a.toml", &read.text).unwrap();
    let names: Vec<_> = scene.bodies().iter().map(|body| body.name.as_str()).collect();
    let shortened = "n".repeat(64);
    assert_eq!(names, ["body 1 2", "body 1", "a_b", "a_b 2", "wall 1 2", "body 6", &shortened]);
    let mass = r#"<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>"#;
    let robot = format!(
        r#"<robot name="r"><link name="a.b">{mass}</link><link name="a/b">{mass}</link>
          <joint name="j" type="floating"><parent link="a.b"/><child link="a/b"/></joint></robot>"#
    );
    let text = scene_of_urdf(&robot).unwrap().text;
    assert!(text.contains("name = \"a_b\"") && text.contains("name = \"a_b 2\""), "{text}");
}

/// MuJoCo 3: a section of the first size in both directions, and z from the second end to the first.
#[test]
fn boxes_and_ellipsoids_between_two_ends_are_square_and_round() {
    for (kind, mass) in [("box", 95.833_188), ("ellipsoid", 50.178_140)] {
        let shape = format!(r#"<geom type="{kind}" size="0.1 0.2" fromto="0.1 0.2 0.3 1 2 -1"/>"#);
        let scene = read(&format!("<worldbody><body><freejoint/>{shape}</body></worldbody>")).text;
        let scene = Scene::parse("a.toml", &scene).unwrap();
        let body = &scene.bodies()[0];
        assert!((body.mass - mass).abs() < 1e-5, "{kind}: {}", body.mass);
    }
}

#[test]
fn numbers_that_no_scene_has_are_refused_or_told() {
    let negative = [
        ("damping", "the damping"),
        ("frictionloss", "the friction"),
        ("stiffness", "the stiffness"),
    ];
    for (word, what) in negative {
        let said = error(&arm(&format!("{word}=\"-2\""), GEOM));
        assert_eq!(said, format!("{what} at the joint of `b` is -2.0; it must not be negative"));
    }
    let far = read(&arm("stiffness=\"2\" springref=\"300\" name=\"j\"", GEOM));
    assert_eq!(far.left_out, ["spring, which rests beyond half a turn, of joint `j`"]);
    let short = read(&("<option timestep=\"1e-12\"/>".to_owned() + &arm("", GEOM)));
    assert!(short.text.contains("sample_every = "), "{}", short.text);
}

#[test]
fn loops_of_sites_and_of_bodies_that_are_not_there_are_refused_by_name() {
    let sites = "<equality>\n<connect site1=\"s\" site2=\"t\"/></equality>";
    let said = error(&(sites.to_owned() + &arm("", GEOM)));
    assert!(said.contains("a loop that is closed between sites (`connect, line 2`)"), "{said}");
    let absent = "<equality><connect name=\"loop\" body1=\"c\" anchor=\"0 0 0\"/></equality>";
    let said = error(&(absent.to_owned() + &arm("", GEOM)));
    assert_eq!(said, "equality `loop` names body `c`, which does not exist");
    let none = r#"<equality><weld body1="b" relpose="0 1 0 0 0 0 0"/></equality>"#;
    let welded = read(&(none.to_owned() + &arm("", GEOM)));
    assert!(welded.text.contains("kind = \"fixed\""), "{}", welded.text);
    // A part of `b`: a scene has no joint within a body.
    let own = r#"<equality><weld body1="b" body2="hand"/><connect body1="hand" body2="b" anchor="1 0 0"/></equality>"#;
    let one =
        read(&(own.to_owned() + &arm("", &format!("{GEOM}<body name=\"hand\">{GEOM}</body>"))));
    assert_eq!(one.text.matches("[[joints]]").count(), 1, "{}", one.text);
}
