//! What a scene cannot tell, by name.

use stationary_import::{ImportError, scene_of_mjcf, scene_of_urdf};

const MASS: &str = r#"<inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>"#;

fn urdf(inside: &str) -> Result<stationary_import::Description, ImportError> {
    let text = inside.replace("MASS", MASS);
    scene_of_urdf(&format!("<robot name=\"r\">{text}</robot>"))
}

fn joint(name: &str, type_: &str, parent: &str, child: &str, more: &str) -> String {
    format!(
        r#"<joint name="{name}" type="{type_}"><parent link="{parent}"/><child link="{child}"/>{more}</joint>"#
    )
}

fn mjcf(bodies: &str) -> Result<stationary_import::Description, ImportError> {
    scene_of_mjcf(&format!("<mujoco><worldbody>{bodies}</worldbody></mujoco>"), ".")
}

#[test]
fn trees_that_are_none_are_refused_by_name() {
    let two = r#"<link name="a">MASS</link><link name="b">MASS</link>"#;
    let wrong = [
        (two.to_owned(), "2 links have no parent (a, b)"),
        (two.to_owned() + &joint("j", "floating", "a", "c", ""), "joint `j` names link `c`"),
        (
            two.to_owned()
                + &joint("j", "floating", "a", "b", "")
                + &joint("k", "floating", "a", "b", ""),
            "link `b` is the child of joint `j` and of joint `k`",
        ),
        (
            two.to_owned()
                + &joint("j", "floating", "a", "b", "")
                + &joint("k", "floating", "b", "a", ""),
            "0 links have no parent",
        ),
        (
            r#"<link name="a">MASS</link><link name="a">MASS</link>"#.to_owned(),
            "link `a` is defined twice",
        ),
        (
            two.replace("name=\"b\"", "name=\"world\"") + &joint("j", "floating", "a", "world", ""),
            "link `world` is defined twice, or has a name that is taken",
        ),
        (
            r#"<link name="r"/>"#.to_owned()
                + two
                + &joint("i", "fixed", "r", "r2", "")
                + r#"<link name="r2"/>"#
                + &joint("j", "floating", "a", "b", "")
                + &joint("k", "floating", "b", "a", ""),
            "0 links have no parent",
        ),
    ];
    for (text, expected) in wrong {
        let error = urdf(&text).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}\nnot: {expected}");
    }
}

#[test]
fn joints_and_masses_that_no_scene_has_are_refused_by_name() {
    let two = r#"<link name="a"/><link name="b">MASS</link>"#;
    let light = r#"<link name="a"/><link name="b"/>"#;
    let thin = MASS.replace("ixx=\"1\"", "ixx=\"3\"");
    let wrong = [
        (two.to_owned() + &joint("j", "planar", "a", "b", ""), "a planar joint (`j`)"),
        (
            two.to_owned() + &joint("j", "continuous", "a", "b", r#"<mimic joint="k"/>"#),
            "a joint that follows another (`j`)",
        ),
        (
            two.to_owned() + &joint("j", "continuous", "a", "b", r#"<axis xyz="0 0 0"/>"#),
            "joint `j` has an axis of length zero",
        ),
        (light.to_owned() + &joint("j", "continuous", "a", "b", ""), "`b` moves and has no mass"),
        (light.to_owned() + &joint("j", "fixed", "a", "b", ""), "nothing moves"),
        (two.replace("MASS", &thin) + &joint("j", "floating", "a", "b", ""), "`b` is no body"),
        (
            two.replace("MASS", &MASS.replace("value=\"1\"", "value=\"NaN\""))
                + &joint("j", "floating", "a", "b", ""),
            "`b`",
        ),
    ];
    for (text, expected) in wrong {
        let error = urdf(&text).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}\nnot: {expected}");
    }
    let geom = r#"<geom size="0.1"/>"#;
    let wrong = [
        (
            format!(r#"<body name="b"><joint type="slide"/><joint type="hinge"/>{geom}</body>"#),
            "several joints of one body (`b`)",
        ),
        (
            r#"<body name="b"><freejoint/><geom name="g" type="mesh" mesh="m"/></body>"#.to_owned(),
            "the mass of a surface (`geom g of b`)",
        ),
        (
            format!(r#"<body name="b" mocap="true">{geom}</body>"#),
            "a body that follows a motion (`b`)",
        ),
        (r#"<body name="b"><freejoint/></body>"#.to_owned(), "`b` moves and has no mass"),
        (
            format!(
                r#"<body name="b"><freejoint/>{geom}</body><body name="b"><freejoint/>{geom}</body>"#
            ),
            "body `b` is defined twice",
        ),
    ];
    for (text, expected) in wrong {
        let error = mjcf(&text).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}\nnot: {expected}");
    }
}

#[test]
fn files_of_another_kind_are_refused_and_none_panics() {
    for text in ["", "<robot", "<sdf/>", "{}", "<robot name=\"r\"><link/></robot>", "\u{0}"] {
        assert!(
            matches!(
                scene_of_urdf(text),
                Err(ImportError::Syntax { .. } | ImportError::Roots { .. })
            ),
            "{text}"
        );
        assert!(scene_of_mjcf(text, ".").is_err(), "{text}");
    }
}

#[test]
fn what_is_left_out_is_named_in_the_list_and_in_the_text() {
    let limit = r#"<limit lower="1" upper="2" effort="10" velocity="1"/>"#;
    let robot = r#"<link name="a"/><link name="b">MASS</link>"#.to_owned()
        + &joint("elbow", "revolute", "a", "b", limit);
    let left = urdf(&robot).unwrap();
    assert_eq!(left.left_out, ["limits of joint `elbow`"].map(str::to_owned));
    let model = r#"<mujoco><worldbody><geom type="plane" size="1 1 1"/>
      <body name="leg"><joint name="hip" frictionloss="1" armature="0.1" range="10 20"/>
        <geom type="capsule" size="0.1 0.2"/><geom type="box" size="0.1 0.1 0.1"/></body></worldbody>
      <actuator><motor name="drive" joint="hip"/></actuator></mujoco>"#;
    let left = scene_of_mjcf(model, ".").unwrap();
    for what in [
        "limits of joint `hip`",
        "armature of joint `hip`",
        "actuator `drive`",
        "what `leg` touches",
    ] {
        assert!(left.left_out.iter().any(|left| left == what), "{what} not in {:?}", left.left_out);
        assert!(left.text.contains(&format!("# - {what}")), "{}", left.text);
    }
}

#[test]
fn what_touches_a_link_that_stands_still_is_told() {
    let shape = r#"<collision><geometry><box size="9 9 0.1"/></geometry></collision>"#;
    let robot = format!(
        r#"<link name="base">{shape}</link><link name="table">{shape}</link>
          <link name="post"/><link name="b">MASS</link>"#
    ) + &joint("f", "fixed", "base", "table", "")
        + &joint("g", "fixed", "base", "post", "")
        + &joint("j", "floating", "base", "b", "");
    let left = urdf(&robot).unwrap().left_out;
    assert_eq!(left, ["what touches link `base`", "what touches link `table`"].map(str::to_owned));
}

#[test]
fn what_touches_a_body_that_stands_still_is_told_and_its_planes_are_walls() {
    let left = mjcf(
        r#"<body name="table" pos="0 0 0.5"><geom name="top" type="box" size="1 1 0.1"/>
          <geom type="box" size="2 2 0.1" contype="0" conaffinity="0"/>
          <body pos="0 0 -0.5"><geom type="plane" size="1 1 1"/></body></body>
          <body name="ball" pos="0 0 2"><freejoint/><geom size="0.1"/></body>"#,
    )
    .unwrap();
    assert_eq!(left.left_out, ["what touches geom `top`".to_owned()]);
    assert!(left.text.contains("normal = [0.0, 0.0, 1.0]\nat = [0.0, 0.0, 0.0]"), "{}", left.text);
}

#[test]
fn pairs_of_contact_and_friction_that_resists_turning_are_told() {
    let model = r#"<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1"/>
      <body name="a" pos="0 0 1"><freejoint/><geom name="g" size="0.1" condim="6"/></body></worldbody>
      <contact><pair geom1="floor" geom2="g" friction="0.1"/></contact></mujoco>"#;
    let left = scene_of_mjcf(model, ".").unwrap().left_out;
    let told = ["contact pair of `floor` and `g`", "torsional and rolling friction of shapes"];
    assert_eq!(left, told.map(str::to_owned));
    let wrong = model.replace("pair geom1=\"floor\" geom2", "exclude body1=\"a\" body2");
    let error = scene_of_mjcf(&wrong, ".").unwrap_err().to_string();
    assert!(error.contains("exclude names body `g`"), "{error}");
}

#[test]
fn a_range_is_no_limit_where_the_joint_says_so() {
    let model = |limited: &str| {
        let text = format!(
            r#"<mujoco><compiler autolimits="false"/><worldbody>
              <body><joint axis="0 1 0" range="-10 10" limited="{limited}"/><geom size="0.1" pos="1 0 0"/></body>
              </worldbody></mujoco>"#
        );
        scene_of_mjcf(&text, ".").unwrap().text
    };
    assert!(model("true").contains("limits = ["));
    assert!(!model("false").contains("limits = ["));
}

#[test]
fn what_the_reader_of_models_takes_for_another_is_refused_with_its_line() {
    let geom = r#"<geom type="box" size="0.1 0.1 0.1"/>"#;
    let rod = r#"<geom type="capsule" size="0.1" fromto="0 0 0 1 0 0"/>"#;
    let body = |inside: &str| {
        format!("<worldbody>\n<body><joint axis=\"0 1 0\"/>{inside}</body></worldbody>")
    };
    let classes = |inside: &str| {
        format!(
            "<default><geom type=\"box\" size=\"0.1 0.1 0.1\"/><default class=\"a\">{inside}</default></default>"
        )
    };
    let turned = r#"<geom euler="0 90 0"/>"#;
    let moved = r#"<geom class="a" pos="0 0 -1"/>"#;
    let wrong = [
        (
            body(&format!("<replicate count=\"3\">{geom}</replicate>")),
            "copies of a part (`replicate, line 2`)",
        ),
        (body(&format!("{geom}<composite/>")), "a part of many bodies (`composite, line 2`)"),
        (body(&format!("{geom}<flexcomp/>")), "a part of many bodies (`flexcomp, line 2`)"),
        (
            body(&format!("<frame pos=\"1 0 0\">{rod}</frame>")),
            "ends of a shape in a frame (`geom, line 2`)",
        ),
        (
            body(&format!("{geom}<body><frame euler=\"90 0 0\"><joint/></frame>{geom}</body>")),
            "what is in a frame and is no shape (`joint, line 2`)",
        ),
        (classes(turned) + &body(moved), "a pose that is partly of a class (`geom, line 2`)"),
        (
            classes(turned) + &body(r#"<body childclass="a"><geom pos="0 0 1"/></body>"#),
            "a pose that is partly of a class (`geom, line 2`)",
        ),
        (
            format!("<default class=\"top\">{turned}</default>") + &body(geom),
            "a class of all that is not called main (`default, line 1`)",
        ),
        (body(r#"<geom size="0.1" shellinertia="true"/>"#), "the mass of a shell (`geom, line 2`)"),
        (
            "<compiler inertiagrouprange=\"0 1\"/>".to_owned() + &body(geom),
            "masses of some groups of shapes (`compiler, line 1`)",
        ),
        (
            "<compiler balanceinertia=\"true\"/>".to_owned() + &body(geom),
            "moments that the compiler balances (`compiler, line 1`)",
        ),
        (
            classes(turned) + &body(r#"<geom size="0.2"/>"#),
            "a size that is partly of a class (`geom, line 2`)",
        ),
        (
            body(r#"<geom type="sphere" size="0.1" mesh="m"/>"#),
            "a shape that is fitted to a mesh (`geom, line 2`)",
        ),
    ];
    for (text, expected) in wrong {
        let text = format!("<mujoco>{text}</mujoco>");
        let error = scene_of_mjcf(&text, ".").unwrap_err().to_string();
        assert!(error.contains(expected), "{error}\nnot: {expected}");
    }
    let right = [
        classes(turned) + &body(r#"<geom pos="0 0 -1"/>"#),
        classes(turned) + &body(r#"<geom class="a" pos="0 0 -1" euler="0 0 90"/>"#),
        classes(turned) + &body(&rod.replace("<geom", "<geom class=\"a\"")),
        classes(turned) + &body(r#"<geom type="sphere" size="0.2" pos="0 0 -1"/>"#),
        body(&format!("<frame pos=\"1 0 0\">{geom}</frame>")),
        body(
            r#"<inertial pos="1 0 0" mass="1" diaginertia="1 1 1"/><geom size="0.1" shellinertia="true"/>"#,
        ),
    ];
    for text in right {
        let read = scene_of_mjcf(&format!("<mujoco>{text}</mujoco>"), ".");
        assert!(read.is_ok(), "{text}: {}", read.unwrap_err());
    }
}

#[test]
fn media_and_switches_of_a_model_are_told_with_their_lines() {
    let model = r#"<mujoco><option density="1.2" viscosity="0" wind="0 1 0">
      <flag contact="disable" limit="enable" gravity="disable"/></option>
      <worldbody><body name="a"><freejoint/><geom size="0.1"/></body></worldbody>
      <tendon><spatial><site site="s"/></spatial></tendon></mujoco>"#;
    let read = scene_of_mjcf(model, ".").unwrap();
    let told = [
        "`density` of option, line 1",
        "`wind` of option, line 1",
        "`contact` disabled by flag, line 2",
        "tendon in space: spatial, line 4",
    ];
    assert_eq!(read.left_out, told.map(str::to_owned));
    assert!(!read.text.contains("[uniform_gravity]"), "{}", read.text);
}

/// Lines are those of the file that says it.
#[test]
fn files_that_a_model_includes_are_searched_too() {
    let folder = std::env::temp_dir().join(format!("stationary-import-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let part = "<mujoco>\n<option density=\"1\"/></mujoco>";
    std::fs::write(folder.join("part.xml"), part).unwrap();
    let model = r#"<mujoco><include file="part.xml"/><worldbody>
      <body name="a"><freejoint/><geom size="0.1"/></body></worldbody></mujoco>"#;
    let read = scene_of_mjcf(model, &folder);
    let include = r#"<include file="part.xml"/>"#;
    let inside =
        model.replace(include, "").replace("<freejoint/>", &format!("<freejoint/>{include}"));
    let refused = scene_of_mjcf(&inside, &folder);
    std::fs::remove_dir_all(&folder).unwrap();
    assert_eq!(read.unwrap().left_out, ["`density` of option, line 2 of part.xml".to_owned()]);
    let error = refused.unwrap_err().to_string();
    assert!(error.contains("a file inside of an element (`include, line 2`)"), "{error}");
}

/// The reader follows a model that is a part of itself until its stack is full, and passes over what it does not find.
#[test]
fn models_whose_bodies_are_attached_are_there_and_no_part_of_themselves() {
    let folder = std::env::temp_dir().join(format!("stationary-attach-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("parts")).unwrap();
    let part = r#"<mujoco><worldbody><body name="tip"><freejoint/><geom size="0.1"/></body></worldbody></mujoco>"#;
    let naming = |file: &str| {
        part.replace(
            "<worldbody>",
            &format!(r#"<asset><model name="m" file="{file}"/></asset><worldbody>"#),
        )
    };
    let files = [
        ("part.xml", part.to_owned()),
        ("itself.xml", naming("../parts/itself.xml")),
        ("here.xml", naming("there.xml")),
        ("there.xml", naming("here.xml")),
        ("broken.xml", part.replace("0.1", "wide")),
        (
            "twice.xml",
            part.replace(
                "<worldbody>",
                &(r#"<include file="part.xml"/>"#.repeat(2) + "<worldbody>"),
            ),
        ),
    ];
    let write =
        |name: &str, text: &str| std::fs::write(folder.join("parts").join(name), text).unwrap();
    files.iter().for_each(|(name, text)| write(name, text));
    // Each names the next one twice: a billion readings.
    for k in 0..30 {
        let next = format!(r#"<model name="x" file="tree{}.xml"/>"#, k + 1);
        write(
            &format!("tree{k}.xml"),
            &naming("part.xml").replace("<asset>", &("<asset>".to_owned() + &next.repeat(2))),
        );
    }
    write("tree30.xml", part);
    let attached = |file: &str, body: &str| {
        let model = format!(
            r#"<mujoco><asset><model name="m" file="parts/{file}"/></asset>
            <worldbody><attach model="m" body="{body}" prefix="a_"/></worldbody></mujoco>"#
        );
        scene_of_mjcf(&model, &folder)
    };
    let whole = attached("part.xml", "tip");
    let refused = [
        ("itself.xml", "tip", "a model that is a part of itself"),
        ("here.xml", "tip", "a model that is a part of itself"),
        ("absent.xml", "tip", "a model whose file cannot be read"),
        ("part.xml", "top", "a body that the attached model has not"),
        ("broken.xml", "tip", "not readable as MJCF: m: "),
        ("twice.xml", "tip", "a file that is included twice"),
        ("tree0.xml", "tip", "so many models as parts of others"),
    ]
    .map(|(file, body, why)| (attached(file, body), why));
    let unnamed = r#"<mujoco><worldbody><attach model="m" body="tip"/></worldbody></mujoco>"#;
    let unnamed = scene_of_mjcf(unnamed, &folder);
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(whole.unwrap().text.contains("a_tip"));
    for (refused, why) in refused {
        let error = refused.unwrap_err().to_string();
        assert!(error.contains(why), "{why}: {error}");
    }
    let error = unnamed.unwrap_err().to_string();
    assert!(error.contains("a model that is not named"), "{error}");
}
