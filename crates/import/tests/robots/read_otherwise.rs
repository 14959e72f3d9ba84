//! What the reader of models takes for another.

use stationary_import::{scene_of_mjcf, scene_of_urdf};

const GEOM: &str = r#"<geom type="box" size="0.1 0.2 0.3"/>"#;

fn body(more: &str, inside: &str) -> String {
    format!(
        "<worldbody>\n<body name=\"b\" {more}><joint axis=\"0 1 0\"/>{inside}</body></worldbody>"
    )
}

fn error(model: &str) -> String {
    let read = scene_of_mjcf(&format!("<mujoco>{model}</mujoco>"), ".");
    read.map(|read| panic!("{model}\n{}", read.text)).unwrap_err().to_string()
}

fn text(model: &str) -> String {
    let read = scene_of_mjcf(&format!("<mujoco>{model}</mujoco>"), ".");
    read.unwrap_or_else(|error| panic!("{model}\n{error}")).text
}

/// MuJoCo turns a z axis that points straight down about x, its reader about y.
#[test]
fn turns_that_the_reader_takes_for_others_are_refused_with_their_line() {
    let down = "a z axis straight down, which leaves the others open (`body, line 2`)";
    let none = "a turn about no axis (`body, line 2`)";
    for (more, expected) in [
        ("zaxis=\"0 0 -2\"", down),
        ("zaxis=\"1e-12 0 -1\"", down),
        ("quat=\"0 0 0 0\"", none),
        ("axisangle=\"0 0 0 30\"", none),
        ("xyaxes=\"1 0 0 2 0 0\"", none),
        ("zaxis=\"0 0 0\"", none),
        ("euler=\"1 2 3\" quat=\"1 0 0 0\"", "several turns of one frame (`body, line 2`)"),
    ] {
        let said = error(&body(more, GEOM));
        assert!(said.contains(expected), "{more}: {said}");
    }
    for sequence in ["xy", "abc", "xyzx"] {
        let said = error(&(format!("<compiler eulerseq=\"{sequence}\"/>") + &body("", GEOM)));
        let expected = "that is not three of x, y, z, X, Y, Z (`compiler, line 1`)";
        assert!(said.contains(expected), "{said}");
    }
    // Of a shape either half turn is the same, and an axis that is not quite down leaves nothing open.
    text(&body("", r#"<geom type="box" size="0.1 0.2 0.3" zaxis="0 0 -1"/>"#));
    text(&body("zaxis=\"0.001 0 -1\"", GEOM));
}

#[test]
fn what_is_of_a_class_that_nothing_defines_is_refused_with_its_line() {
    let classes = r#"<default><default class="light"><geom density="10"/></default></default>"#;
    let light = text(&(classes.to_owned() + &body("childclass=\"light\"", GEOM)));
    assert!(light.contains("mass = 0.48"), "{light}");
    for (more, inside, tag) in [
        ("childclass=\"lihgt\"", GEOM.to_owned(), "body"),
        ("", GEOM.replace("<geom", "<geom class=\"lihgt\""), "geom"),
    ] {
        let said = error(&(classes.to_owned() + &body(more, &inside)));
        let expected = format!("a class that nothing defines (`{tag}, line 2`)");
        assert!(said.contains(&expected), "{said}");
    }
}

/// MuJoCo reads settings first, wherever they stand.
#[test]
fn settings_that_the_reader_meets_too_late_are_refused_with_their_line() {
    let folder = std::env::temp_dir().join(format!("stationary-order-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let write = |name: &str, inside: &str| {
        std::fs::write(folder.join(name), format!("<mujoco>\n{inside}</mujoco>")).unwrap();
    };
    write("robot.xml", &body("euler=\"0.1 0 0\"", GEOM));
    write("settings.xml", r#"<compiler angle="radian"/><default><geom density="10"/></default>"#);
    let (robot, settings) = (r#"<include file="robot.xml"/>"#, r#"<include file="settings.xml"/>"#);
    let radian = r#"<compiler angle="radian"/>"#;
    let class = r#"<default class="a"><joint damping="1"/></default>"#;
    let angles = "angles of a compiler after what is measured in them";
    let wrong = [
        (format!("{robot}\n{radian}"), format!("{angles} (`compiler, line 2`)")),
        (format!("{robot}{settings}"), format!("{angles} (`compiler, line 2 of settings.xml`)")),
        (
            format!("<default><geom euler=\"1 0 0\"/></default>{radian}") + &body("", GEOM),
            format!("{angles} (`compiler, line 1`)"),
        ),
        (
            format!("{robot}<default>{class}</default>"),
            "classes after a file with bodies (`default, line 1`)".to_owned(),
        ),
        (
            format!("<default>{class}</default>\n<default><geom density=\"10\"/></default>")
                + &body("childclass=\"a\"", GEOM),
            "what all classes have after classes (`default, line 2`)".to_owned(),
        ),
        (
            "<equality><connect body1=\"b\" anchor=\"0 0 1\"/></equality>
            <default><equality active=\"false\"/></default>"
                .to_owned()
                + &body("", GEOM),
            "a class of equalities after these (`default, line 2`)".to_owned(),
        ),
    ];
    let right = [
        format!("{settings}{robot}"),
        format!("{robot}<compiler autolimits=\"true\"/><option timestep=\"0.01\"/>"),
        format!("<default>{class}<geom density=\"10\"/></default>{radian}") + &body("", GEOM),
    ];
    let read = |inside: &str| scene_of_mjcf(&format!("<mujoco>{inside}</mujoco>"), &folder);
    let wrong = wrong.map(|(model, expected)| (read(&model), expected));
    let right = right.map(|model| read(&model));
    std::fs::remove_dir_all(&folder).unwrap();
    for (read, expected) in wrong {
        let said = read.map(|read| panic!("{expected}\n{}", read.text)).unwrap_err().to_string();
        assert!(said.contains(&expected), "{said}\nnot: {expected}");
    }
    for read in right {
        let text = read.unwrap().text;
        assert!(text.contains("mass = "), "{text}");
    }
}

/// The word says that shapes are weighed; where there is none, the mass that is written stands.
#[test]
fn a_body_without_shapes_keeps_its_mass_where_the_compiler_weighs_shapes() {
    let own = r#"<inertial pos="0 0 0" mass="7" diaginertia="1 1 1"/>"#;
    let weighs = "<compiler inertiafromgeom=\"true\"/>";
    let alone = text(&(weighs.to_owned() + &body("", own)));
    assert!(alone.contains("mass = 7.0"), "{alone}");
    let fixed = body("", &format!("{GEOM}<body>{own}</body>"));
    let whole = text(&(weighs.to_owned() + &fixed));
    assert!(whole.contains("mass = 55.0"), "{whole}");
    let shaped = text(&(weighs.to_owned() + &body("", &format!("{own}{GEOM}"))));
    assert!(shaped.contains("mass = 48.0"), "{shaped}");
}

#[test]
fn a_weld_in_a_pose_of_few_numbers_is_refused_with_its_line() {
    let weld = "<equality><weld body1=\"b\" relpose=\"0 0 5\"/></equality>";
    let said = error(&(weld.to_owned() + &body("", GEOM)));
    let expected = "a pose of a weld that is not seven numbers (`weld, line 1`)";
    assert!(said.contains(expected), "{said}");
}

#[test]
fn numbers_of_a_joint_that_are_not_finite_are_refused_by_its_body() {
    let expected = "the spring, the damper or the friction at the joint of `b` is not finite";
    for more in ["damping=\"nan\"", "frictionloss=\"inf\"", "stiffness=\"1\" springref=\"nan\""] {
        let said = error(&body("", GEOM).replace("<joint", &format!("<joint {more}")));
        assert_eq!(said, expected, "{more}");
    }
    let limits =
        text(&body("", GEOM).replace("<joint", "<joint type=\"slide\" range=\"-inf inf\""));
    assert!(limits.contains("# - limits of joint `joint of b`"), "{limits}");
    let arm = r#"<robot name="r"><link name="a"/><link name="b"><inertial><mass value="1"/>
      <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="j" type="continuous"><parent link="a"/><child link="b"/>
      <dynamics damping="NaN"/></joint></robot>"#;
    assert_eq!(scene_of_urdf(arm).unwrap_err().to_string(), expected);
}
