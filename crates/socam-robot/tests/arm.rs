//! One arm of two links in three syntaxes, against its numbers by hand.

use socam_model::Model;
use socam_robot::{Corrections, JointModel, Robot, RobotError, patch};

const URDF: &str = r#"<?xml version="1.0"?>
<robot name="arm">
  <link name="base"/>
  <link name="upper">
    <inertial><origin xyz="0 0 -0.15"/><mass value="2"/><inertia ixx="0.02" iyy="0.02" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <link name="lower">
    <inertial><origin xyz="0.1 0 -0.1" rpy="0 0 1.5707963267948966"/><mass value="1"/><inertia ixx="0.005" iyy="0.004" izz="0.002" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0 1"/><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit effort="20" velocity="3" lower="-2" upper="2"/><dynamics damping="0.3" friction="0.2"/>
  </joint>
  <joint name="elbow" type="continuous">
    <origin xyz="0 0 -0.3"/><parent link="upper"/><child link="lower"/><axis xyz="0 2 0"/>
  </joint>
  <transmission name="t"><joint name="shoulder"/><actuator name="m"><mechanicalReduction>50</mechanicalReduction></actuator></transmission>
</robot>"#;

const MJCF: &str = r#"<mujoco model="arm">
  <compiler angle="degree"/>
  <default><default class="drive"><joint damping="0.3" frictionloss="0.2"/></default></default>
  <worldbody>
    <frame pos="0 0 0.4">
      <body name="upper" pos="0 0 0.6" childclass="drive">
        <joint name="shoulder" axis="0 1 0" range="-114.59 114.59"/>
        <inertial pos="0 0 -0.15" mass="2" diaginertia="0.02 0.02 0.001"/>
        <body name="lower" pos="0 0 -0.3">
          <joint name="elbow" axis="0 1 0" damping="0" frictionloss="0"/>
          <inertial pos="0.1 0 -0.1" euler="0 0 90" mass="1" diaginertia="0.005 0.004 0.002"/>
        </body>
      </body>
    </frame>
  </worldbody>
  <actuator><motor name="m" joint="shoulder" gear="50"/></actuator>
</mujoco>"#;

const SDF: &str = r#"<sdf version="1.9"><world name="w"><gravity>0 0 -9.81</gravity><model name="arm">
  <link name="base"/>
  <link name="upper"><pose>0 0 1 0 0 0</pose>
    <inertial><pose>0 0 -0.15 0 0 0</pose><mass>2</mass><inertia><ixx>0.02</ixx><iyy>0.02</iyy><izz>0.001</izz></inertia></inertial></link>
  <link name="lower"><pose relative_to="elbow"/>
    <inertial><pose degrees="true">0.1 0 -0.1 0 0 90</pose><mass>1</mass><inertia><ixx>0.005</ixx><iyy>0.004</iyy><izz>0.002</izz></inertia></inertial></link>
  <joint name="shoulder" type="revolute"><parent>base</parent><child>upper</child>
    <axis><xyz>0 1 0</xyz><dynamics><damping>0.3</damping><friction>0.2</friction></dynamics></axis></joint>
  <joint name="elbow" type="revolute"><pose relative_to="upper">0 0 -0.3 0 0 0</pose><parent>upper</parent><child>lower</child><axis><xyz>0 1 0</xyz></axis></joint>
</model></world></sdf>"#;

fn joint(text: &str, name: &str) -> JointModel {
    Robot::parse(text, &|_| None).unwrap().joint(Some(name)).unwrap()
}

#[test]
fn an_arm_has_the_same_numbers_in_every_syntax() {
    for text in [URDF, MJCF, SDF] {
        let (shoulder, elbow) = (joint(text, "shoulder"), joint(text, "elbow"));
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-8, "{a} for {b}");
        near(shoulder.behind.value, 0.24);
        near(elbow.behind.value, 0.025);
        near(shoulder.damping.value, 0.3);
        near(shoulder.friction.as_ref().unwrap().value, 0.2);
        let (weight, phase) = shoulder.weight.clone().unwrap();
        near(weight.value, 9.81 * 0.5_f64.sqrt());
        near(phase, -(0.1 / 0.5_f64.sqrt()).asin());
        assert!(elbow.friction.is_none() && elbow.damping.value == 0.0);
        assert!(shoulder.left_out.iter().any(|text| text.contains("(elbow)")), "{:?}", shoulder.left_out);
        let file = shoulder.model_file("arm");
        let model = Model::parse(&file).unwrap_or_else(|error| panic!("{error}\n{file}"));
        let value = |name: &str| model.parameters[model.parameter(name).unwrap()].value;
        near(value("inertia"), 0.24);
        near(value("weight_phase"), phase);
    }
    assert!(joint(URDF, "shoulder").model_file("arm").contains("# scale = 50.0"));
}

/// Solids whose mass is their volume's: 1000 kg/m3.
#[test]
fn masses_come_from_solids_where_none_is_stated() {
    let one = |geom: &str| {
        let text = format!(
            r#"<mujoco><worldbody><body><joint name="j" type="hinge" axis="0 0 1"/><geom {geom}/></body></worldbody></mujoco>"#
        );
        joint(&text, "j").behind.value
    };
    let pi = std::f64::consts::PI;
    let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-9, "{a} for {b}");
    near(one(r#"type="cylinder" size="0.1 0.2""#), 0.5 * 1000.0 * pi * 0.01 * 0.4 * 0.01);
    near(one(r#"type="box" size="0.1 0.2 0.3" mass="6""#), 2.0 * (0.01 + 0.04));
    near(one(r#"size="0.1""#), 0.4 * 1000.0 * 4.0 / 3.0 * pi * 1e-3 * 0.01);
    // A capsule is a cylinder and two half balls.
    near(
        one(r#"type="capsule" size="0.1 0.2""#),
        0.5 * 1000.0 * pi * 0.01 * 0.4 * 0.01 + 0.4 * 1000.0 * 4.0 / 3.0 * pi * 1e-3 * 0.01,
    );
    // Beside the axis, by Steiner.
    near(one(r#"type="box" size="0.1 0.2 0.3" mass="6" pos="1 0 0""#), 2.0 * (0.01 + 0.04) + 6.0);
}

#[test]
fn a_spring_that_rests_elsewhere_pulls_at_zero() {
    let with = |spring: &str| MJCF.replace("name=\"shoulder\"", &format!("name=\"shoulder\" {spring}"));
    let preloaded = joint(&with("stiffness=\"5\" springref=\"90\""), "shoulder");
    let file = preloaded.model_file("arm");
    let model = Model::parse(&file).unwrap_or_else(|error| panic!("{error}\n{file}"));
    // It drives forward, and `preload` counts against.
    let preload = model.parameters[model.parameter("preload").unwrap()].value;
    assert!((preload + 5.0 * std::f64::consts::FRAC_PI_2).abs() < 1e-6, "{preload}");
    assert!(joint(&with("stiffness=\"5\""), "shoulder").preload.is_none());
}

#[test]
fn corrected_numbers_go_back_and_nothing_else_changes() {
    let corrected =
        Corrections { inertia: Some(0.29), damping: Some(0.45), friction: Some(0.125), stiffness: None };
    for (text, armature) in [(URDF, 0.0), (MJCF, 0.05), (SDF, 0.0)] {
        let (patched, left_out) = patch(text, "shoulder", 0.24, &corrected).unwrap();
        let after = joint(&patched, "shoulder");
        assert!((after.damping.value, after.friction.unwrap().value) == (0.45, 0.125), "{patched}");
        let found = after.armature.map_or(0.0, |armature| armature.value);
        assert!((found - armature).abs() < 1e-12, "{patched}");
        assert_eq!(left_out.len(), usize::from(armature == 0.0), "{left_out:?}");
        assert_eq!(joint(&patched, "elbow"), joint(text, "elbow"));
        // The lines of all else are the same to the byte.
        let differ = text.lines().zip(patched.lines()).filter(|(a, b)| a != b).count();
        assert!(differ == 1 && text.lines().count() == patched.lines().count(), "{patched}");
    }
    let same = Corrections { damping: Some(0.3), friction: Some(0.2), ..Corrections::default() };
    assert_eq!(patch(URDF, "shoulder", 0.24, &same).unwrap().0, URDF);
    let elbow = patch(URDF, "elbow", 0.025, &same).unwrap().0;
    assert_eq!(joint(&elbow, "elbow").damping.value, 0.3);
}

#[test]
fn what_is_no_robot_is_refused_in_a_sentence() {
    let said = |text: &str| {
        Robot::parse(text, &|_| None).and_then(|robot| robot.joint(None)).unwrap_err().to_string()
    };
    assert!(said("no xml").starts_with("is no XML"));
    assert!(said("<house/>").contains("<house>; expected <robot>"));
    assert!(said(URDF).contains("name one by --joint: `shoulder`, `elbow`"), "{}", said(URDF));
    assert!(said(&URDF.replace("value=\"2\"", "value=\"two\"")).starts_with("line 5: `value` holds `two`"));
    assert!(said(&URDF.replace("link=\"lower\"", "link=\"hand\"")).contains("names the link `hand`"));
    assert!(
        said(&MJCF.replace("<worldbody>", "<include file=\"x.xml\"/><worldbody>"))
            .contains("includes `x.xml`")
    );
    assert!(said("<robot name='a'><link name='l'/></robot>").contains("no joint with one degree of freedom"));
    let circle = SDF.replace("<pose relative_to=\"elbow\"/>", "<pose relative_to=\"lower\"/>");
    assert!(said(&circle).contains("relative to itself"), "{}", said(&circle));
    let deep = "<body>".repeat(100_000) + &"</body>".repeat(100_000);
    assert!(
        said(&format!("<mujoco><worldbody>{deep}</worldbody></mujoco>"))
            .contains("elements stand in one another")
    );
    let massless = URDF.replace("<inertial>", "<other>").replace("</inertial>", "</other>");
    let error = Robot::parse(&massless, &|_| None).unwrap().joint(Some("elbow")).unwrap_err();
    assert!(
        matches!(&error, RobotError::Whole(text) if text.contains("nothing behind the joint `elbow` has a mass")),
        "{error}"
    );
}
