//! `diagnose` on recordings that other laboratories published. Each diagnosis starts from a model that lacks a part known to be
//! there.

use std::path::Path;

use serde_json::Value;
use socam_tests::{data_set, run};

/// The servo axis of Janot, Gautier and Brunot, "Data Set and Reference Models of EMPS" (2019), as a mass with viscous friction.
const AXIS: &str = r#"
schema = "socam.model/1"
name = "axis"
description = "A mass with viscous friction"
motion = "translation"

[parameters]
mass = { value = 90, unit = "kg", bounds = [1, 1e4], source = "guess" }
viscous = { value = 300, unit = "N s/m", bounds = [0, 1e5], source = "guess" }

[[nodes]]
name = "carriage"
inertia = "mass"

[[bearings]]
name = "guide"
at = "carriage"
damping = "viscous"

[channels.force]
role = "input"
quantity = "force"
at = "carriage"
[channels.position]
role = "output"
quantity = "position"
at = "carriage"
"#;

/// The electronic oscillator of Wigren and Schoukens, "Three free data sets for development and benchmarking in nonlinear system
/// identification" (2013), as mass, spring and damper.
const OSCILLATOR: &str = r#"
schema = "socam.model/1"
name = "oscillator"
description = "Mass, spring and damper"
motion = "translation"

[parameters]
m = { value = 5e-6, unit = "kg", bounds = [1e-8, 1e-2], source = "guess" }
c = { value = 2e-4, unit = "N s/m", bounds = [0, 1], source = "guess" }
k = { value = 1.0, unit = "N/m", bounds = [1e-3, 1e3], source = "guess" }

[[nodes]]
name = "mass"
inertia = "m"

[[springs]]
name = "spring"
from = "mass"
to = "ground"
stiffness = "k"
damping = "c"

[channels.u]
role = "input"
quantity = "force"
at = "mass"
column = "u_V"
scale = 1
[channels.y]
role = "output"
quantity = "position"
at = "mass"
column = "y_V"
scale = 1
"#;

fn file(folder: &Path, model: &str) -> String {
    let path = folder.join("model.toml");
    std::fs::write(&path, model).unwrap();
    path.to_str().unwrap().into()
}

fn found(document: &Value) -> Vec<(&str, &str)> {
    let findings = document["findings"].as_array().unwrap();
    findings.iter().map(|one| (one["effect"].as_str().unwrap(), one["location"].as_str().unwrap())).collect()
}

/// Value and interval of a finding's first parameter.
fn size(document: &Value, effect: &str) -> (f64, [f64; 2]) {
    let findings = document["findings"].as_array().unwrap();
    let own = &findings.iter().find(|one| one["effect"] == effect).unwrap()["parameters"][0];
    let end = |k: usize| own["ci95"][k].as_f64().unwrap();
    (own["value"].as_f64().unwrap(), [end(0), end(1)])
}

/// Published (inverse dynamics): Coulomb friction 20.39 N, viscous 203.5 N s/m.
#[test]
fn a_servo_axis_is_found_to_rub_and_to_be_pulled_one_way() {
    let Some(data) = data_set("emps") else { return };
    let folder = tempfile::tempdir().unwrap();
    let [train, test] = emps(&data);
    let model = file(folder.path(), AXIS);
    let document = servo_axis(&[train.clone(), test.clone()], &model);
    let found = found(&document);
    assert!(found.contains(&("coulomb_friction", "guide")), "{found:?}");
    let (torque, _) = size(&document, "coulomb_friction");
    assert!((torque - 20.39).abs() < 1.0, "{torque}");
    let (mass, viscous) = (parameter(&document, "mass", "after"), parameter(&document, "viscous", "after"));
    assert!((mass - 95.1).abs() < 1.0, "{mass}");
    assert!((parameter(&document, "viscous", "before") - 203.5).abs() > 100.0);
    // At half and at the whole of the largest speed; the two coefficients alone are less certain than their sum.
    for speed in [0.05, 0.1] {
        let (found, published) = (torque + viscous * speed, 20.39 + 203.5 * speed);
        assert!((found / published - 1.0).abs() < 0.02, "{speed} m/s: {found} N for {published} N");
    }
    let fit = &document["fit"]["channels"]["position"];
    let [before, after] = ["holdout_rms_before", "holdout_rms_after"].map(|when| fit[when].as_f64().unwrap());
    assert!(after < 0.2 * before, "{before} {after}");
    // Share of the force that inverse dynamics leaves, in training and held out: as begun, and with Coulomb friction and the force's offset
    // (published 4.08 and 5.98 %). The corrected model's friction has presliding and its force has an offset, which no regression of the force on the motion holds.
    let published = [(&*model, 17.9, 17.8), ("emps", 4.0, 6.0)];
    for (model, in_training, held_out) in published {
        let mut arguments = vec!["identify", &train, "--validate", &test, "--model", model];
        arguments.extend(["--method", "inverse-dynamics", "--json"]);
        let document = run(arguments).json();
        let errors =
            ["training", "validation"].map(|part| document[part][0]["force_error_percent"].as_f64().unwrap());
        assert!(
            (errors[0] - in_training).abs() < 0.06 && (errors[1] - held_out).abs() < 0.06,
            "{model}: {errors:?}"
        );
    }
}

#[test]
#[ignore = "not reached: 214.2 N s/m, 10.7 from what was published; until the fits converged by their start states too it was 211.4"]
fn a_servo_axis_has_the_published_viscous_friction() {
    let Some(data) = data_set("emps") else { return };
    let folder = tempfile::tempdir().unwrap();
    let document = servo_axis(&emps(&data), &file(folder.path(), AXIS));
    let viscous = parameter(&document, "viscous", "after");
    assert!((viscous - 203.5).abs() < 10.0, "{viscous}");
}

/// The training and the held-out recording of the servo axis.
fn emps(data: &Path) -> [String; 2] {
    ["emps_train", "emps_test_pulses"].map(|name| format!("{}/{name}.csv", data.display()))
}

fn servo_axis([train, test]: &[String; 2], model: &str) -> Value {
    run(["diagnose", train, "--holdout", test, "--model", model, "--most", "2", "--json"]).json()
}

fn parameter(document: &Value, name: &str, when: &str) -> f64 {
    let own = document["parameters"].as_array().unwrap().iter().find(|p| p["name"] == name).unwrap();
    own[when].as_f64().unwrap()
}

#[test]
#[ignore = "not reached: the hardening is found at 2.57 per m2 instead of 3 to 4.5, beside two offsets that are not there"]
fn an_oscillator_is_found_to_harden() {
    let Some(data) = data_set("silverbox") else { return };
    let folder = tempfile::tempdir().unwrap();
    let record = format!("{}/silverbox_SNLS80mV.csv", data.display());
    let part = |range: &str| format!("{record}@{range}");
    let (train, multisine, arrow) = (part("66.6..86"), part("173.3..208.8"), part("0.17..66.4"));
    let model = file(folder.path(), OSCILLATOR);
    let document =
        run(["diagnose", &train, "--holdout", &multisine, "--holdout", &arrow, "--model", &model, "--json"])
            .json();
    let found = found(&document);
    assert!(found.contains(&("stiffness_hardening", "spring")), "{found:?}");
    let (cubic, [low, high]) = size(&document, "stiffness_hardening");
    assert!(3.0 < cubic && cubic < 4.5 && low < cubic && cubic < high, "{cubic}");
    // A difference equation fitted by least squares leaves 7 and 14 mV without the cube, 1.1 and 1.8 mV with it.
    let fit = &document["fit"]["channels"]["y"];
    let [before, after] = ["holdout_rms_before", "holdout_rms_after"].map(|when| fit[when].as_f64().unwrap());
    assert!(before > 0.01 && after < 0.001, "{before} {after}");
}

/// By manual analysis (docs/aalto.md), most of the effect that the published chain lacks repeats with every turn of the middle
/// shaft, whose mesh 1 does not roll true. The encoder's angle gives the position in its turn at which each recording begins. All
/// recordings ran at one speed, at which a load that varies four times a turn has the same effect. So the line and its shaft are
/// found, either place may come first, and the other is a rival.
#[test]
#[ignore = "takes minutes: cargo test --release -p socam-tests -- --ignored"]
fn a_reduction_is_found_not_to_roll_true() {
    let Some(data) = data_set("aalto") else { return };
    let [train, more, test] =
        ["0", "1", "5"].map(|offset| format!("{}/aalto_ice3200_offset{offset}pct.csv", data.display()));
    let model = concat!(env!("CARGO_MANIFEST_DIR"), "/models/aalto-disc.toml");
    let mut arguments = vec!["diagnose", &train, &more, "--holdout", &test, "--model", model];
    arguments.extend(["--start", "equilibrium", "--most", "1", "--json"]);
    let document = run(arguments).json();
    let finding = &document["findings"][0];
    let all = std::iter::once(finding).chain(finding["rivals"].as_array().unwrap());
    let all: Vec<_> =
        all.map(|one| [&one["effect"], &one["location"]].map(|name| name.as_str().unwrap())).collect();
    assert!(
        all.contains(&["kinematic_error", "mesh_1"]) && all.contains(&["torque_ripple", "load"]),
        "{all:?}"
    );
    // Turns of the middle shaft for one of the shaft that the order counts.
    let (turns, size) =
        if all[0][1].starts_with("mesh") { (1.0 / 3.0, 1.2e-3..2.0e-3) } else { (4.0, 0.18..0.3) };
    let parameter = |k: usize| finding["parameters"][k]["value"].as_f64().unwrap();
    assert!((parameter(0) / turns - 1.0).abs() < 1e-3, "{} {all:?}", parameter(0));
    assert!(size.contains(&parameter(1)), "{} {all:?}", parameter(1));
    assert!(finding["evidence"]["holdout_gain_percent"].as_f64().unwrap() > 30.0);
}
