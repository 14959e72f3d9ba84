//! Scenes of descriptions move as the descriptions say.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use stationary_import::{Description, scene_of_mjcf, scene_of_urdf};
use stationary_scene::{Run, Scene};

fn run(described: &Description, observables: &str, horizon: &str) -> Run {
    let text = described.text.replace("observables = [\"energy\"]", observables);
    let old = text.lines().find(|line| line.starts_with("horizon")).unwrap().to_owned();
    let text = text.replace(&old, &format!("horizon = {horizon}"));
    let scene =
        Scene::parse("described.toml", &text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    scene.run().unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// An arm on a hinge, its inertia turned in its frame and its frame in the joint's.
const ARM: &str = r#"<robot name="arm">
  <link name="base"/>
  <link name="arm">
    <inertial><origin xyz="0.5 0.1 -0.2" rpy="0.3 -0.4 0.9"/><mass value="2"/>
      <inertia ixx="0.11" iyy="0.09" izz="0.05" ixy="0.01" ixz="-0.02" iyz="0.005"/></inertial>
  </link>
  <joint name="shoulder" type="continuous">
    <parent link="base"/><child link="arm"/>
    <origin xyz="0.2 0.3 1" rpy="0.1 0.2 0.7"/><axis xyz="0 2 1"/>
    <dynamics damping="0.3"/>
  </joint>
</robot>"#;

/// One freedom: I phi'' = -dV/dphi - c phi', by Runge and Kutta's method of order 4.
#[test]
fn an_arm_with_a_turned_inertia_falls_as_its_one_equation_says() {
    let described = scene_of_urdf(ARM).unwrap();
    assert!(described.left_out.is_empty(), "{:?}", described.left_out);
    let frame = UnitQuaternion::from_euler_angles(0.1, 0.2, 0.7);
    let own = UnitQuaternion::from_euler_angles(0.3, -0.4, 0.9).to_rotation_matrix();
    let tensor = Matrix3::new(0.11, 0.01, -0.02, 0.01, 0.09, 0.005, -0.02, 0.005, 0.05);
    let (m, g, c) = (2.0, 9.81, 0.3);
    let axis: Vector3<f64> = Vector3::new(0.0, 2.0, 1.0).normalize();
    let lever: Vector3<f64> = Vector3::new(0.5, 0.1, -0.2);
    let moment = axis.dot(&(own * tensor * own.transpose() * axis))
        + m * (lever.norm_squared() - axis.dot(&lever).powi(2));
    let centre = |phi: f64| {
        frame * (UnitQuaternion::from_scaled_axis(axis * phi) * lever) + Vector3::new(0.2, 0.3, 1.0)
    };
    let torque = |phi: f64| {
        let arm = centre(phi) - Vector3::new(0.2, 0.3, 1.0);
        (frame * axis).dot(&arm.cross(&Vector3::new(0.0, 0.0, -m * g)))
    };
    let rate = |[phi, w]: [f64; 2]| [w, (torque(phi) - c * w) / moment];
    let (mut y, n) = ([0.0_f64; 2], 10_000);
    let h = 1.0 / f64::from(n);
    for _ in 0..n {
        let to = |k: [f64; 2], part: f64| [y[0] + part * h * k[0], y[1] + part * h * k[1]];
        let k1 = rate(y);
        let k2 = rate(to(k1, 0.5));
        let k3 = rate(to(k2, 0.5));
        let k4 = rate(to(k3, 1.0));
        let mean = |i: usize| h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        y = [y[0] + mean(0), y[1] + mean(1)];
    }
    let run = run(&described, "observables = [{ position = \"arm\" }]", "1");
    let last = run.observed(run.times().len() - 1);
    let off = (Vector3::from_column_slice(&last[..3]) - centre(y[0])).norm();
    assert!(y[0].abs() > 1.0 && off < 1e-5, "{off} after {y:?}");
}

const BOTH: [&str; 2] = [
    r#"<robot name="two">
  <link name="base"/>
  <link name="a"><inertial><origin xyz="0 0 -0.5"/><mass value="1.5"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="plate"><inertial><mass value="0.5"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="b"><inertial><origin xyz="0.3 0 0"/><mass value="1"/>
    <inertia ixx="0.02" iyy="0.05" izz="0.05" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="j" type="continuous"><parent link="base"/><child link="a"/>
    <origin xyz="0 0 2" rpy="0 0.3 0"/><axis xyz="0 1 0"/></joint>
  <joint name="f" type="fixed"><parent link="a"/><child link="plate"/><origin xyz="0.1 0 -1"/></joint>
  <joint name="s" type="spherical"><parent link="plate"/><child link="b"/><origin xyz="0 0 -0.1"/></joint>
</robot>"#,
    r#"<mujoco model="two"><compiler angle="radian"/><option timestep="0.001"/><worldbody>
  <body name="a" pos="0 0 2" euler="0 0.3 0"><joint type="hinge" axis="0 1 0"/>
    <inertial pos="0 0 -0.5" mass="1.5" diaginertia="0.1 0.1 0.02"/>
    <body name="plate" pos="0.1 0 -1"><inertial pos="0 0 0" mass="0.5" diaginertia="0.01 0.01 0.02"/>
      <body name="b" pos="0 0 -0.1"><joint type="ball"/>
        <inertial pos="0.3 0 0" mass="1" diaginertia="0.02 0.05 0.05"/></body>
    </body>
  </body>
</worldbody></mujoco>"#,
];

/// What is fixed to one another is one body, of both formats.
#[test]
fn one_robot_in_two_formats_is_one_scene() {
    let urdf = scene_of_urdf(BOTH[0]).unwrap();
    let mjcf = scene_of_mjcf(BOTH[1], ".").unwrap();
    assert_eq!(urdf.text.matches("[[bodies]]").count(), 2);
    let observed = "observables = [\"energy\", { position = \"a\" }, { position = \"b\" }]";
    let [one, other] = [&urdf, &mjcf].map(|described| run(described, observed, "1"));
    for sample in [0, one.times().len() - 1] {
        for (a, b) in one.observed(sample).iter().zip(other.observed(sample)) {
            assert!((a - b).abs() < 1e-8, "{sample}: {a} {b}\n{}\n{}", urdf.text, mjcf.text);
        }
    }
    let energy = [0, one.times().len() - 1].map(|sample| one.observed(sample)[0]);
    assert!((energy[0] - energy[1]).abs() < 1e-3, "{energy:?}");
}

#[test]
fn a_box_of_a_model_falls_onto_its_plane_and_rests_there() {
    let model = r#"<mujoco><worldbody>
      <geom name="floor" type="plane" size="5 5 1" friction="0.8"/>
      <body name="crate" pos="0 0 0.4"><freejoint/><geom type="box" size="0.1 0.2 0.3" mass="2" friction="0.8"/></body>
    </worldbody></mujoco>"#;
    let described = scene_of_mjcf(model, ".").unwrap();
    assert!(described.left_out.is_empty(), "{:?}", described.left_out);
    assert!(described.text.contains("friction = 0.8"), "{}", described.text);
    let run = run(&described, "observables = [{ position = \"crate\" }]", "0.5");
    let last = run.observed(run.times().len() - 1);
    assert!((last[2] - 0.3).abs() < 1e-9 && last[0].hypot(last[1]) < 1e-9, "{last:?}");
}

/// w^2 = k/I with a spring at the hinge; the model's reference is where it starts.
#[test]
fn a_spring_of_a_hinge_swings_about_its_reference() {
    let model = r#"<mujoco><compiler angle="radian"/><option gravity="0 0 0" timestep="0.001"/><worldbody>
      <body name="disc"><joint type="hinge" axis="0 0 1" stiffness="8" springref="0.3"/>
        <geom type="cylinder" size="0.5 0.1" mass="4"/></body>
    </worldbody></mujoco>"#;
    let described = scene_of_mjcf(model, ".").unwrap();
    let run = run(&described, "observables = [{ angular_velocity = \"disc\" }]", "1");
    let w: f64 = (8.0_f64 / 0.5).sqrt();
    for (sample, t) in run.times().iter().enumerate() {
        let spin = run.observed(sample)[2];
        assert!((spin - 0.3 * w * (w * t).sin()).abs() < 1e-5, "{t}: {spin}");
    }
}

#[test]
fn a_loop_that_a_model_closes_is_a_joint() {
    let model = r#"<mujoco><worldbody>
      <body name="a" pos="0 0 0"><joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0 0 1" size="0.05"/>
        <body name="b" pos="0 0 1"><joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 1 0 0" size="0.05"/></body>
      </body>
    </worldbody><equality><connect body1="b" anchor="1 0 0"/></equality></mujoco>"#;
    let described = scene_of_mjcf(model, ".").unwrap();
    let run = run(&described, "observables = [\"energy\", { position = \"b\" }]", "0.1");
    // The end of the upper bar stays: three bars and the ground do not move, as they stand.
    let [first, last] = [0, run.times().len() - 1].map(|sample| run.observed(sample).to_vec());
    assert!((first[0] - last[0]).abs() < 1e-6 * first[0].abs(), "{first:?} {last:?}");
    assert_eq!(described.text.matches("kind = \"ball\"").count(), 1);
}

/// A hinge falls onto its stop and stays there; one whose friction is large enough does not fall.
#[test]
fn limits_and_friction_of_joints_hold_as_the_descriptions_say() {
    let robot = |bounds: &str| {
        format!(
            r#"<robot name="gate"><link name="post"/>
              <link name="arm"><inertial><origin xyz="0.5 0 0"/><mass value="2"/>
                <inertia ixx="0.01" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>
              <joint name="stop" type="revolute"><parent link="post"/><child link="arm"/>
                <axis xyz="0 1 0"/>{bounds}</joint></robot>"#
        )
    };
    let model = |bounds: &str| {
        format!(
            r#"<mujoco><worldbody><body name="arm"><joint name="stop" axis="0 1 0" {bounds}/>
              <inertial pos="0.5 0 0" mass="2" diaginertia="0.01 0.02 0.02"/></body>
              </worldbody></mujoco>"#
        )
    };
    let stop = r#"<limit lower="-1" upper="0.5" effort="0" velocity="0"/>"#;
    let rubs =
        r#"<limit lower="-1" upper="0.5" effort="0" velocity="0"/><dynamics friction="10"/>"#;
    // m g l = 9.81 N m; 0.5 rad are 28.64788975654116 degrees.
    let (range, rubbed) =
        (r#"range="-57 28.64788975654116""#, r#"range="-57 30" frictionloss="10""#);
    let cases = [
        (scene_of_urdf(&robot(stop)), 0.5),
        (scene_of_urdf(&robot(rubs)), 0.0),
        (scene_of_mjcf(&model(range), "."), 0.5),
        (scene_of_mjcf(&model(rubbed), "."), 0.0),
    ];
    for (described, angle) in cases {
        let described = described.unwrap();
        assert!(described.left_out.is_empty(), "{:?}", described.left_out);
        let run = run(&described, "observables = [{ position = \"arm\" }]", "2");
        let at = run.positions(run.times().len() - 1);
        let expected = [0.5 * f64::cos(angle), 0.0, -0.5 * f64::sin(angle)];
        for (x, expected) in at.iter().zip(expected) {
            assert!((x - expected).abs() < 1e-6, "{at:?} {expected}\n{}", described.text);
        }
    }
}

/// A capsule rolls down a plane as a solid does: a = g sin(alpha)/(1 + I/(m r^2)).
#[test]
fn a_round_shape_rolls_on_a_plane_as_its_inertia_says() {
    let (g, sine) = (9.81, 0.1_f64.sin());
    let urdf = r#"<robot name="roller"><link name="roller">
        <inertial><mass value="2"/><inertia ixx="0.0266666666667" iyy="0.0266666666667" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
        <collision><geometry><cylinder radius="0.1" length="0.36055512754639896"/></geometry></collision></link></robot>"#;
    let described = scene_of_urdf(urdf).unwrap();
    assert!(described.text.contains("cylinder = {"), "{}", described.text);
    let model = format!(
        r#"<mujoco><option gravity="{} 0 {}" timestep="0.001"/><worldbody>
          <geom type="plane" size="5 5 1" friction="0.8"/>
          <body name="roller" pos="0 0 0.1"><freejoint/>
            <geom type="capsule" fromto="0 -0.2 0 0 0.2 0" size="0.1" mass="2" friction="0.8"/></body>
          </worldbody></mujoco>"#,
        g * sine,
        -g * 0.1_f64.cos()
    );
    let described = scene_of_mjcf(&model, ".").unwrap();
    assert!(described.left_out.is_empty(), "{:?}", described.left_out);
    assert!(described.text.contains("capsule = {"), "{}", described.text);
    let run = run(&described, "observables = [{ position = \"roller\" }]", "0.5");
    // A cylinder of mass 3 h/(3 h + 4 r) of it, and a ball: I = (mc/2 + 2/5 mb) r^2 about the axis.
    let (h, r) = (0.4, 0.1);
    let cylinder = 3.0 * h / (3.0 * h + 4.0 * r);
    let inertia = 0.5 * cylinder + 0.4 * (1.0 - cylinder);
    let expected = 0.5 * g * sine / (1.0 + inertia) * 0.25;
    let at = run.positions(run.times().len() - 1);
    assert!((at[0] - expected).abs() < 5e-3 * expected, "{} {expected}", at[0]);
}

/// A link without mass carries the joint, and the link that is fixed to it the mass.
#[test]
fn a_link_without_mass_moves_with_what_is_fixed_to_it() {
    let arm = r#"<inertial><origin xyz="0.5 0 0"/><mass value="2"/>
      <inertia ixx="0.01" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>"#;
    let hinge = r#"<axis xyz="0 1 0"/></joint>"#;
    let direct = format!(
        r#"<robot name="arm"><link name="base"/><link name="a">{arm}</link>
          <joint name="j" type="continuous"><parent link="base"/><child link="a"/>{hinge}</robot>"#
    );
    let carried = format!(
        r#"<robot name="arm"><link name="base"/><link name="a"/><link name="b">{arm}</link>
          <joint name="j" type="continuous"><parent link="base"/><child link="a"/>{hinge}
          <joint name="f" type="fixed"><parent link="a"/><child link="b"/></joint></robot>"#
    );
    let [direct, carried] = [direct, carried].map(|robot| scene_of_urdf(&robot).unwrap());
    assert_eq!(direct, carried);
}

/// Two balls fall onto a plane from one line: the upper falls through the lower, or rests on it.
#[test]
fn bodies_that_a_model_keeps_from_touching_pass_through_each_other() {
    let model = |upper: &str, contact: &str| {
        format!(
            r#"<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1"/>
              <body name="a" pos="0 0 0.1"><freejoint/><geom type="sphere" size="0.1" {upper}/></body>
              <body name="b" pos="0 0 0.35"><freejoint/><geom type="sphere" size="0.1" {upper}/></body>
              </worldbody><contact>{contact}</contact></mujoco>"#
        )
    };
    let fall = -9.81 / 2.0 * 0.36;
    let cases = [
        ("", "", [0.1, 0.3]),
        ("", r#"<exclude body1="b" body2="a"/>"#, [0.1, 0.1]),
        (r#"contype="1" conaffinity="0""#, "", [0.1, 0.1]),
        (r#"contype="2" conaffinity="2""#, "", [0.1 + fall, 0.35 + fall]),
        (
            "",
            r#"<exclude body1="world" body2="a"/><exclude body1="b" body2="a"/>"#,
            [0.1 + fall, 0.1],
        ),
    ];
    for (bits, contact, expected) in cases {
        let described = scene_of_mjcf(&model(bits, contact), ".").unwrap();
        assert!(described.left_out.is_empty(), "{:?}", described.left_out);
        let observed = "observables = [{ position = \"a\" }, { position = \"b\" }]";
        let run = run(&described, observed, "0.6");
        let last = run.observed(run.times().len() - 1);
        for (z, expected) in [last[2], last[5]].iter().zip(expected) {
            assert!((z - expected).abs() < 1e-2, "{last:?} {expected}\n{}", described.text);
        }
    }
}

/// a = g_x without friction, and a box at rest where the larger of two coefficients holds it.
#[test]
fn friction_is_that_of_what_touches_in_its_dimensions_of_contact() {
    let model = |floor: &str, crate_: &str| {
        format!(
            r#"<mujoco><option gravity="2 0 -9.81" timestep="0.001"/><worldbody>
              <geom type="plane" size="1 1 1" {floor}/>
              <geom type="box" size="1 1 1" contype="0" conaffinity="0" friction="0.1"/>
              <body name="crate" pos="0 0 0.1"><freejoint/>
                <geom type="box" size="0.1 0.1 0.1" {crate_}/></body></worldbody></mujoco>"#
        )
    };
    let slides = 0.5 * 2.0 * 0.25;
    let cases = [
        (r#"condim="1""#, r#"condim="1""#, slides),
        (r#"condim="1""#, "", 0.0),
        (r#"friction="0.1""#, r#"friction="0.8""#, 0.0),
        (r#"friction="0" priority="1""#, r#"friction="0.8""#, slides),
    ];
    for (floor, crate_, expected) in cases {
        let described = scene_of_mjcf(&model(floor, crate_), ".").unwrap();
        assert!(described.left_out.is_empty(), "{:?}", described.left_out);
        let run = run(&described, "observables = [{ position = \"crate\" }]", "0.5");
        let last = run.observed(run.times().len() - 1);
        assert!((last[0] - expected).abs() < 1e-2, "{last:?} {expected}\n{}", described.text);
    }
}
