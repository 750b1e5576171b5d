//! `compare`: a recording beside the output of a user's simulator.

use std::fmt::Write as _;

use socam_tests::{path, run};

/// A table of a speed and a torque at 1 kHz; the torque has a friction, and noise that is the same for the same `noise`.
fn table(rows: u32, friction: f64, noise: u32, start_s: f64) -> String {
    let mut text = String::from("t_s,speed_rad_s,torque_Nm\n");
    let mut state = u64::from(noise) * 2_654_435_761 + 1;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
    };
    for row in 0..rows {
        let t = 1e-3 * f64::from(row);
        let speed = 8.0 * (3.0 * t).sin() + 2.0 * (17.0 * t).sin();
        let slope = 24.0 * (3.0 * t).cos() + 34.0 * (17.0 * t).cos();
        let noise = if noise == 0 { 0.0 } else { 0.01 * random() };
        let torque = 0.01 * slope + 0.03 * speed + friction * speed.signum() + noise;
        writeln!(text, "{},{speed},{torque}", t + start_s).unwrap();
    }
    text
}

#[test]
fn a_friction_is_found_without_a_model_and_a_right_simulation_agrees() {
    let folder = tempfile::tempdir().unwrap();
    let (recording, simulation, report) =
        (path(&folder, "run.csv"), path(&folder, "sim.csv"), path(&folder, "report"));
    std::fs::write(&simulation, table(6000, 0.0, 0, 0.0)).unwrap();
    std::fs::write(&recording, table(6000, 0.2, 7, 0.0)).unwrap();
    let text = run(["compare", &recording, &simulation, "--report", &report]).done();
    assert!(text.contains("differs from the recording in 1 of 1 channels"), "{text}");
    assert!(text.contains("it follows the sign of speed (0.2"), "{text}");
    assert!(text.contains("`speed` is the same in both, as an input of the simulator is"), "{text}");
    let page = std::fs::read_to_string(folder.path().join("report/index.html")).unwrap();
    let (whole, over) = (page.find("torque measured and simulated"), page.find("Error of torque over speed"));
    assert!(whole.is_some() && over.is_some() && whole < over);

    std::fs::write(&recording, table(6000, 0.0, 8, 0.0)).unwrap();
    let json = run(["compare", &recording, &simulation, "--json"]).done();
    let document: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!((&document["schema"], &document["verdict"]), (&"socam.compare/1".into(), &"agree".into()));
}

#[test]
fn what_cannot_be_compared_is_refused_in_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = path(&folder, name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let run_csv = file("run.csv", &table(1000, 0.2, 7, 0.0));
    let good = table(1000, 0.0, 0, 0.0);
    let sim = file("sim.csv", &good);
    let later = file("later.csv", &table(1000, 0.0, 0, 50.0));
    let other =
        file("other.csv", &good.replace("speed_rad_s", "omega_rad_s").replace("torque_Nm", "moment_Nm"));
    let units = file("units.csv", &good.replace("torque_Nm", "torque_N"));
    let one = file("one.csv", "t_s,speed_rad_s\n0,1\n");
    let constant = file(
        "constant.csv",
        &(0..600).fold(String::from("t_s,torque_Nm\n"), |text, k| text + &format!("{k},1\n")),
    );
    let empty = file("empty.csv", "");
    let text = file("text.csv", "t_s,torque_Nm\n0,a\n");
    let missing = path(&folder, "missing.csv");
    let cases: [(&[&str], i32, &str); 12] = [
        (&[&run_csv, &missing], 1, "no such file"),
        (&[&run_csv, &empty], 1, "is empty"),
        (&[&run_csv, &text], 1, "holds no"),
        (&[&run_csv, &one], 1, "fewer than 256 rows in common"),
        (&[&run_csv, &later], 1, "fewer than 256 rows in common; give a simulation of the same time"),
        (
            &[&run_csv, &other],
            1,
            "have no channel of the same name and unit: one has `speed_rad_s`, `torque_Nm`, the other `omega_rad_s`, `moment_Nm`",
        ),
        (&[&run_csv, &sim, "--map", "omega=speed"], 1, "--map omega=speed: `"),
        (
            &[&run_csv, &units, "--map", "torque=torque"],
            1,
            "one is in N, the other in N m; convert one of them",
        ),
        (&[&constant, &constant, "--map", "speed=torque"], 1, "has no channel `speed`"),
        (&[&run_csv, &sim, "--false-alarm-rate", "2"], 2, "expected a number between 0 and 1"),
        (&[&run_csv, &sim, "--offset", "inf"], 2, "--offset inf: expected seconds"),
        (&[&run_csv, &sim, "--model", "no-such-model"], 2, "there is no model file `no-such-model`"),
    ];
    for (arguments, code, mention) in cases {
        let ran = run([&["compare"], arguments].concat());
        let sentence = ran.refusal(code);
        assert!(sentence.contains(mention), "{arguments:?} does not say `{mention}`: {sentence}");
    }
}
