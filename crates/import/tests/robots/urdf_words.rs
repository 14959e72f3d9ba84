//! What the reader of URDF passes over, or takes by way of something else.

use stationary_import::{Description, ImportError, scene_of_urdf};
use stationary_scene::Scene;

const MASS: &str = r#"<inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>"#;

fn arm(version: &str, inside: &str, more: &str) -> Result<Description, ImportError> {
    scene_of_urdf(&format!(
        "<robot name=\"r\" version=\"{version}\"><link name=\"a\"/><link name=\"b\">{MASS}</link>
        <joint name=\"j\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/>\n{inside}</joint>{more}</robot>"
    ))
}

#[test]
fn words_that_nothing_reads_are_told_with_their_line() {
    for (inside, more, expected) in [
        (r#"<orgin xyz="1 2 3"/>"#, "", "unknown element orgin, line 4"),
        (r#"<origin xzy="1 2 3"/>"#, "", "`xzy` of origin, line 4"),
        (r#"<origin quat_xyzw="0 1 0 0"/>"#, "", "`quat_xyzw` of origin, line 4"),
        (r#"<dynamics dampng="3"/>"#, "", "`dampng` of dynamics, line 4"),
        ("", r#"<gazebo reference="b"><mu1>0.2</mu1></gazebo>"#, "unknown element gazebo, line 4"),
        ("", r#"<Link name="c"/>"#, "unknown element Link, line 4"),
    ] {
        assert_eq!(arm("1.0", inside, more).unwrap().left_out, [expected], "{inside}{more}");
    }
    // What no motion shows.
    let quiet = r#"<material name="red"><color rgba="1 0 0 1"/></material><transmission name="t"><actuator name="m"/>
      </transmission>"#;
    let quiet = arm("1.0", r#"<safety_controller k_velocity="1"/>"#, quiet).unwrap().left_out;
    assert!(quiet.is_empty(), "{quiet:?}");
}

#[test]
fn what_is_no_number_and_a_joint_that_stands_twice_are_refused() {
    for xyz in ["1 2 abc 3", "1 2 3 x", "1, 2, 3", "1 2"] {
        let error = arm("1.0", &format!(r#"<origin xyz="{xyz}"/>"#), "").unwrap_err().to_string();
        let expected = format!("`xyz` of origin, line 4 is `{xyz}`; it must be 3 numbers");
        assert!(error.ends_with(&expected), "{error}");
    }
    let twice = r#"<joint name="j" type="fixed"><parent link="b"/><child link="c"/></joint><link name="c"/>"#;
    let error = arm("1.0", "", twice).unwrap_err().to_string();
    assert!(error.starts_with("joint `j` is defined twice"), "{error}");
}

/// The reader takes a pitch within 0.26 degrees of a right angle for one.
#[test]
fn a_turn_by_a_quaternion_is_that_turn() {
    let pitch = 1.57_f64;
    let (sin, cos) = (0.5 * pitch).sin_cos();
    let joint =
        format!(r#"<origin quat_xyzw="0 {} 0 {}"/><axis xyz="0 0 1"/>"#, 2.0 * sin, 2.0 * cos);
    let read = arm("1.1", &joint, "").unwrap();
    assert!(read.left_out.is_empty(), "{:?}", read.left_out);
    let scene = Scene::parse("arm.toml", &read.text).unwrap();
    let expected = [pitch.sin(), 0.0, pitch.cos()];
    let off = scene.joints()[0].axis.iter().zip(expected).map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f64::max) < 1e-15, "{:?}", scene.joints()[0].axis);
    let none = arm("1.1", r#"<origin quat_xyzw="0 0 0 0"/>"#, "").unwrap_err().to_string();
    assert!(none.starts_with("a turn by no quaternion (`origin, line 4`)"), "{none}");
}

#[test]
fn a_joint_without_limits_leaves_none_out() {
    let limit = |said: &str| {
        let joint = format!(
            r#"<joint name="k" type="prismatic"><parent link="b"/><child link="c"/><limit {said}/></joint>"#
        );
        arm("1.2", "", &format!(r#"<link name="c">{MASS}</link>{joint}"#)).unwrap().left_out
    };
    assert!(limit("effort=\"1\"").is_empty());
    assert_eq!(limit("lower=\"-1\""), ["limits of joint `k`"]);
}
