//! `import-model` and `export-model --into`: a joint of a robot by way of MuJoCo, which moves it as the model does, before and after correction; an axis by its
//! gains and settings.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use socam_tests::readers::{python, scripts};
use socam_tests::{run, skip};

const ARM: &str = r#"<mujoco model="arm">
  <!-- Two links; the elbow's axis is not where its body's frame is. -->
  <compiler angle="degree"/>
  <default><default class="drive"><joint damping="0.05" armature="0.01"/></default></default>
  <worldbody>
    <frame pos="0 0 1" euler="0 0 30">
      <body name="upper" childclass="drive">
        <joint name="shoulder" axis="0 1 0"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.3" size="0.03" mass="2"/>
        <body name="lower" pos="0 0 -0.35" euler="0 20 0">
          <joint name="elbow" axis="0 1 0" pos="0 0 0.05"/>
          <geom type="capsule" fromto="0 0 0.05 0.25 0 0" size="0.02" density="900"/>
          <body name="hand" pos="0.25 0 0">
            <inertial pos="0.05 0 0" mass="0.4" diaginertia="4e-4 3e-4 2e-4"/>
          </body>
        </body>
      </body>
    </frame>
  </worldbody>
  <actuator><position name="servo" joint="elbow" kp="20"/></actuator>
</mujoco>
"#;

/// Torques of 4 s at 1 kHz.
fn torque(slower: f64) -> String {
    let mut text = String::from("t_s,torque_Nm\n");
    for row in 0..4000 {
        let t = 1e-3 * f64::from(row);
        let wave = |amplitude: f64, hz: f64| amplitude * (std::f64::consts::TAU * hz * slower * t + hz).sin();
        let _ = writeln!(text, "{t},{}", wave(0.25, 0.5) + wave(0.3, 1.3) + wave(0.25, 2.9));
    }
    text
}

fn angles(path: &Path) -> Vec<f64> {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let at = lines.next().unwrap().split(',').position(|name| name == "angle_rad").unwrap();
    lines.map(|line| line.split(',').nth(at).unwrap().parse().unwrap()).collect()
}

/// Rms of the difference over the rms of the first.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let sum = |values: &mut dyn Iterator<Item = f64>| values.map(|value| value * value).sum::<f64>();
    (sum(&mut a.iter().zip(b).map(|(a, b)| a - b)) / sum(&mut a.iter().copied())).sqrt()
}

#[test]
fn a_joint_moves_as_in_mujoco_and_takes_its_corrections_back() {
    let Some(python) = python() else { return skip("no Python with mujoco (SOCAM_PYTHON names one)") };
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let text = |name: &str| path(name).to_str().unwrap().to_owned();
    std::fs::write(path("arm.xml"), ARM).unwrap();
    let real = ARM.replace("name=\"elbow\" axis", "name=\"elbow\" damping=\"0.12\" armature=\"0.02\" axis");
    std::fs::write(path("real.xml"), real).unwrap();
    for (name, slower) in [("torque-1.csv", 1.0), ("torque-2.csv", 0.7)] {
        std::fs::write(path(name), torque(slower)).unwrap();
    }
    let mujoco = |robot: &str, torque: &str, motion: &str, noise: &[&str]| {
        let script = scripts().join("robot.py");
        let arguments = [text(robot), "elbow".into(), text(torque), text(motion)];
        let output = Command::new(&python).arg(script).args(arguments).args(noise).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        angles(&path(motion))
    };
    let socam = |arguments: &[&str]| {
        let ran = run(arguments.iter().map(|text| (*text).to_owned()));
        assert_eq!(ran.code, Some(0), "{}", ran.stderr);
        ran
    };
    let ran = socam(&["import-model", &text("arm.xml"), "--joint", "elbow", "-o", &text("elbow.toml")]);
    assert!(
        ran.stderr.contains("left out: the actuator `servo` is a <position> (kp = 20)"),
        "{}",
        ran.stderr
    );
    let there = mujoco("arm.xml", "torque-1.csv", "there.csv", &[]);
    socam(&[
        "simulate",
        "--input",
        &text("there.csv"),
        "--model",
        &text("elbow.toml"),
        "--from-rest",
        "-o",
        &text("here.csv"),
    ]);
    let apart = difference(&there, &angles(&path("here.csv")));
    println!("measured: import-model: relative difference to MuJoCo {apart:.1e}");
    assert!(apart < 1e-3, "{apart}");

    mujoco("real.xml", "torque-1.csv", "measured-1.csv", &["1e-3", "1"]);
    let held_out = mujoco("real.xml", "torque-2.csv", "measured-2.csv", &["1e-3", "2"]);
    socam(&[
        "identify",
        &text("measured-1.csv"),
        "--model",
        &text("elbow.toml"),
        "--write-model",
        &text("fit.toml"),
    ]);
    let into = ["export-model", &text("fit.toml"), "--into", &text("arm.xml"), "--joint", "elbow", "-o"]
        .map(str::to_owned);
    socam(&into.iter().map(String::as_str).chain([text("new.xml").as_str()]).collect::<Vec<_>>());
    let patched = std::fs::read_to_string(path("new.xml")).unwrap();
    assert_eq!(ARM.lines().zip(patched.lines()).filter(|(a, b)| a != b).count(), 1, "{patched}");
    let error =
        |robot: &str, motion: &str| difference(&held_out, &mujoco(robot, "torque-2.csv", motion, &[]));
    let (before, after) = (error("arm.xml", "before.csv"), error("new.xml", "after.csv"));
    println!("measured: export-model --into: held-out error {before:.1e} before, {after:.1e} after");
    assert!(after < 0.02 * before, "{before} before, {after} after");
}

/// A mechanism whose gains are a quarter off is simulated, and `identify` gives its own gains in the unit of SysId.
#[test]
fn gains_of_sysid_are_what_identify_returns() {
    let folder = tempfile::tempdir().unwrap();
    let text = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let mut voltage = String::from("t_s,voltage_V\n");
    for row in 0..2000 {
        let t = 2e-3 * f64::from(row);
        let _ = writeln!(voltage, "{t},{}", 6.0 * (std::f64::consts::TAU * (0.3 + 0.4 * t) * t).sin());
    }
    std::fs::write(text("voltage.csv"), voltage).unwrap();
    let socam = |arguments: &[&str]| {
        let ran = run(arguments);
        assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    };
    let import = |gains: &str, file: &str| socam(&["import-model", "--sysid", gains, "-o", &text(file)]);
    import("ks=0.12 kv=0.8 ka=0.03 unit=rotations", "real.toml");
    import("ks=0.15 kv=1.0 ka=0.04 unit=rotations", "start.toml");
    let (real, run_csv) = (text("real.toml"), text("run.csv"));
    socam(&["simulate", "--input", &text("voltage.csv"), "--model", &real, "--from-rest", "-o", &run_csv]);
    socam(&["identify", &run_csv, "--model", &text("start.toml"), "--write-model", &text("fit.toml")]);
    let fit: toml::Table = std::fs::read_to_string(text("fit.toml")).unwrap().parse().unwrap();
    for (gain, expected) in [("kS", 0.12), ("kV", 0.8), ("kA", 0.03)] {
        let found = fit["parameters"][gain]["value"].as_float().unwrap();
        assert!((found / expected - 1.0).abs() < 0.01, "{gain} {found} for {expected}");
    }
}

#[test]
fn settings_of_a_controller_become_an_axis() {
    let folder = tempfile::tempdir().unwrap();
    let settings = folder.path().join("moteus.cfg");
    std::fs::write(
        &settings,
        "motor.poles 14\nmotor.Kv 300.0\nservo.pid_position.kp 4.0\nservo.pid_position.kd 0.2\n",
    )
    .unwrap();
    let settings = settings.to_str().unwrap();
    let ran = run(["import-model", settings, "-o", "-"]);
    assert!(ran.stderr.contains("left out: friction and damping: no setting tells them"), "{}", ran.stderr);
    assert!(ran.done().contains("scale = 0.02756644"));
    let ran = run(["import-model", settings, "--drive", "voltage", "-o", "-"]);
    assert_eq!(ran.code, Some(1), "{}", ran.stderr);
    assert!(ran.stderr.contains("states no resistance above zero"), "{}", ran.stderr);
}

#[test]
fn what_cannot_be_imported_is_said_in_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let robot = folder.path().join("arm.xml");
    std::fs::write(&robot, ARM).unwrap();
    let robot = robot.to_str().unwrap();
    let elbow = folder.path().join("elbow.toml");
    let elbow = elbow.to_str().unwrap();
    assert_eq!(run(["import-model", robot, "--joint", "elbow", "-o", elbow]).code, Some(0));
    for (arguments, sentence) in [
        (vec!["import-model", robot], "has several joints; name one by --joint: `shoulder`, `elbow`"),
        (vec!["import-model", robot, "--joint", "wrist"], "has no joint `wrist`; it has `shoulder`, `elbow`"),
        (vec!["import-model", "two-mass", "--joint", "elbow"], "cannot read `two-mass`"),
        (vec!["export-model", "two-mass", "--into", robot, "--joint", "elbow", "-o", "-"], "has 2 nodes"),
        (
            vec!["export-model", elbow, "--into", robot, "--joint", "shoulder", "-o", "-"],
            "is a model of `elbow`, and `shoulder`",
        ),
    ] {
        let ran = run(arguments.iter().map(|text| (*text).to_owned()));
        assert!(ran.code == Some(2) || ran.code == Some(1), "{arguments:?}: {:?}", ran.code);
        assert!(ran.stderr.contains(sentence), "{arguments:?}: {}", ran.stderr);
        assert_eq!(ran.stderr.trim_end().lines().count(), 1, "{}", ran.stderr);
    }
}
