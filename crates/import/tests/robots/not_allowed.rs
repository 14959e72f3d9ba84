//! What MuJoCo 4.0 refuses, as it does, and what it takes.

use stationary_import::{Description, ImportError, scene_of_mjcf};

const MASS: &str = r#"pos="0 0 0" mass="1""#;
const BALL: &str = r#"<geom size="0.1"/>"#;

fn model(before: &str, joint: &str, inside: &str) -> Result<Description, ImportError> {
    let text = format!(
        "<mujoco>{before}<worldbody>\n<body name=\"b\"><joint name=\"j\" axis=\"0 1 0\" {joint}/>{inside}</body>
        </worldbody></mujoco>"
    );
    scene_of_mjcf(&text, ".")
}

#[track_caller]
fn refused(read: Result<Description, ImportError>, expected: &str) {
    let error = read.unwrap_err().to_string();
    assert!(error.starts_with(expected), "{error}\nnot: {expected}");
}

#[test]
fn an_element_that_says_two_things_at_once_is_refused_with_its_line() {
    let rod = r#"type="capsule" size="0.1" fromto="0 0 0 1 0 0""#;
    for (before, inside, expected) in [
        ("", format!(r#"<geom {rod} pos="1 0 0"/>"#), "a place beside two ends (`geom, line 2`)"),
        (
            r#"<default><geom pos="1 0 0"/></default>"#,
            format!("<geom {rod}/>"),
            "a place beside two ends (`geom, line 2`)",
        ),
        (
            "",
            r#"<geom size="0.1" fromto="0 0 0 1 0 0"/>"#.to_owned(),
            "two ends of a shape that has none (`geom, line 2`)",
        ),
        (
            "",
            r#"<geom type="box" size="1 1 1 1"/>"#.to_owned(),
            "more than three numbers of a size or a friction (`geom, line 2`)",
        ),
        (
            "",
            format!(r#"<inertial {MASS} fullinertia="1 1 1 0 0 0" euler="9 0 0"/>"#),
            "a tensor beside a turn (`inertial, line 2`)",
        ),
        (
            "",
            format!(r#"<inertial {MASS} fullinertia="1 1 1 0 0 0" diaginertia="1 1 1"/>"#),
            "a tensor beside moments (`inertial, line 2`)",
        ),
        (
            "",
            format!(r#"<inertial {MASS} diaginertia="1 1 1"/>"#).repeat(2),
            "two masses of one body (`inertial, line 2`)",
        ),
        (
            "",
            r#"<inertial mass="1" diaginertia="1 1 1"/>"#.to_owned(),
            "a mass without `pos` or `mass` (`inertial, line 2`)",
        ),
        (
            r#"<default><default class="a"/><default class="a"/></default>"#,
            BALL.to_owned(),
            "a class that is defined twice, or has no name (`default, line 1`)",
        ),
        (
            r#"<default><default><geom density="1"/></default></default>"#,
            BALL.to_owned(),
            "a class that is defined twice, or has no name (`default, line 1`)",
        ),
    ] {
        refused(model(before, "", &inside), expected);
    }
    // A turn beside two ends is passed over, and the class of all may be told in parts.
    let turned = model("", "", &format!(r#"<geom {rod} euler="9 8 7"/>"#)).unwrap();
    assert_eq!(turned, model("", "", &format!("<geom {rod}/>")).unwrap());
    let parts = r#"<default><geom density="1"/></default><default class="main"><geom condim="4"/></default>"#;
    assert!(model(parts, "", BALL).is_ok());
}

#[test]
fn a_range_that_does_not_grow_is_no_limit_and_refused_where_it_is_said_to_be_one() {
    let unsaid = r#"<compiler autolimits="false"/>"#;
    for (before, joint, expected) in [
        ("", r#"limited="true" range="10 -10""#, "limits that do not grow (`j`)"),
        ("", r#"limited="true""#, "limits that do not grow (`j`)"),
        (unsaid, r#"range="-10 10""#, "a range of which nothing says whether it limits (`j`)"),
        (
            unsaid,
            r#"range="9 8" limited="auto""#,
            "a range of which nothing says whether it limits",
        ),
    ] {
        refused(model(before, joint, BALL), expected);
    }
    for (before, joint) in [
        ("", r#"range="10 -10""#),
        ("", r#"range="10 10""#),
        ("", r#"range="-10 10" limited="false""#),
        ("", r#"type="free" range="-10 10""#),
        (unsaid, r#"range="0 0""#),
    ] {
        let read = model(before, joint, BALL).unwrap();
        assert!(
            read.left_out.is_empty() && !read.text.contains("limits"),
            "{joint}: {}",
            read.text
        );
    }
}

#[test]
fn planes_that_move_free_joints_within_bodies_and_names_that_stand_twice_are_refused() {
    let plane = r#"<geom type="plane" size="1 1 1"/>"#;
    let below = format!("{BALL}<body name=\"c\"><freejoint/>{BALL}</body>");
    for (inside, expected) in [
        (format!("{BALL}{plane}"), "a plane that moves (`b`)"),
        (below, "a free joint within a body (`c`)"),
        (format!("{BALL}<body><joint name=\"j\"/>{BALL}</body>"), "joint `j` is defined twice"),
        (r#"<geom name="g" size="0.1"/>"#.repeat(2), "geom `g` is defined twice"),
    ] {
        refused(model("", "", &inside), expected);
    }
}
