//! `identify` and `info` for scripts: one JSON document, and nothing claimed that the recording does not determine.

use std::collections::BTreeMap;

use serde_json::Value;
use socam_tests::bench::{BENCH, Noise};
use socam_tests::{Ran, data_set, run, socam_host};

/// Parameters, or anything else with a name, by their names.
fn by_name(list: &Value) -> BTreeMap<&str, &Value> {
    list.as_array().unwrap().iter().map(|entry| (entry["name"].as_str().unwrap(), entry)).collect()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Whether the true value lies within 5 standard deviations of the estimate.
fn holds(entry: &Value, truth: f64) -> bool {
    (number(&entry["value"]) - truth).abs() < 5.0 * number(&entry["std"])
}

#[track_caller]
fn assert_between(value: &Value, low: f64, high: f64) {
    let value = number(value);
    assert!((low..=high).contains(&value), "{value} is not in [{low}, {high}]");
}

#[test]
fn identify_says_what_a_recording_determines_and_what_not() {
    let folder = tempfile::tempdir().unwrap();
    let recording = folder.path().join("run.csv");
    std::fs::write(&recording, BENCH.csv(4.0, 1)).unwrap();
    let recording = recording.to_str().unwrap();
    let result = run(["identify", recording, "--json"]).json();

    assert_eq!(result["schema"], "socam.identification/1");
    assert_eq!(result["method"], "output-error");
    assert_eq!(result["model"], "speed-o-cam");
    assert_eq!(result["recordings"], serde_json::json!([recording]));
    assert_eq!(result["converged"], true);
    assert!(result["end"].is_string() && result["warnings"].is_array());
    assert_between(&result["iterations"], 1.0, 1000.0);
    assert_between(&result["cpu_s"], 0.0, 600.0);

    let parameters = by_name(&result["parameters"]);
    let names = ["J2", "J3", "J4", "N", "c2", "c3", "c4", "c5", "k1", "k2", "k3", "k4"];
    assert!(parameters.keys().eq(&names), "{parameters:?}");
    for (name, parameter) in &parameters {
        let fixed = name.starts_with(['J', 'N']);
        assert_eq!(parameter["source"] == "fixed", fixed, "{name}");
        assert!(parameter["unit"].is_string() && parameter["note"].is_string(), "{name}");
        assert!(parameter["determined_with"].is_array(), "{name}");
        assert_eq!(parameter["ci95"].as_array().map(Vec::len), Some(2), "{name}");
        let determined = parameter["identifiable"].as_bool().unwrap();
        assert!(
            determined || fixed || parameter["value"].is_null(),
            "{name} is not determined, yet has a number"
        );
    }
    // The thesis' headline stiffness moves nothing, and couplings 1 and 2 may be swapped.
    for name in ["k1", "k2", "k3"] {
        assert_eq!(parameters[name]["identifiable"], false, "{name}");
    }
    for (name, truth) in [("k4", BENCH.k4), ("c4", BENCH.c4), ("c5", BENCH.c5)] {
        assert_eq!(parameters[name]["identifiable"], true, "{name}");
        assert!(holds(parameters[name], truth), "{truth}: {}", parameters[name]);
    }
    let series = by_name(&result["combinations"])["k_series_12"];
    assert!(holds(series, BENCH.k_series_12()), "{}: {series}", BENCH.k_series_12());
    assert!(series["expression"].is_string() && series["unit"].is_string());
    // White noise of a known size was added: the residual is that, no more and no less.
    for (channel, std) in [("output_speed", 0.01), ("torque_in", 0.005), ("torque_out", 0.02)] {
        let fit = &result["fit"]["channels"][channel];
        assert_between(&fit["rms"], 0.95 * std, 1.05 * std);
        assert_between(&fit["noise_std"], 0.95 * std, 1.05 * std);
        assert_between(&fit["nrmse_percent"], 0.0, 20.0);
        assert_between(&fit["vaf_percent"], 96.0, 100.0);
    }
}

/// At rest the law is sharply curved: if start states were moved as if it were linear, no step of the other parameters would reduce
/// the cost.
/// Of five samples two are lost: steps of one and two samples, and no grid of gaps.
#[test]
fn a_recording_with_uneven_stamps_determines_what_an_even_one_does() {
    let folder = tempfile::tempdir().unwrap();
    let recording = folder.path().join("uneven.csv");
    let whole = BENCH.csv(4.0, 1);
    let kept = whole.lines().enumerate().filter(|(line, _)| *line == 0 || [1, 2, 4].contains(&(line % 5)));
    std::fs::write(&recording, kept.map(|(_, line)| format!("{line}\n")).collect::<String>()).unwrap();
    let recording = recording.to_str().unwrap();
    let result = run(["identify", recording, "--json"]).json();
    assert_eq!(result["fit_verdict"], "explained");
    let parameters = by_name(&result["parameters"]);
    for (name, truth) in [("k4", BENCH.k4), ("c4", BENCH.c4), ("c5", BENCH.c5)] {
        assert!(holds(parameters[name], truth), "{truth}: {}", parameters[name]);
    }
    // The motion has lines up to a sixth of the mean rate, between whose samples a polynomial errs by a little.
    let series = &by_name(&result["combinations"])["k_series_12"]["value"];
    assert_between(series, 0.997 * BENCH.k_series_12(), 1.003 * BENCH.k_series_12());
    let Ran { stdout, stderr, .. } = run(["diagnose", recording]);
    assert!(stderr.contains("integrated from stamp to stamp"), "{stderr}");
    assert!(stdout.contains("Nothing is missing that"), "{stdout}");
}

#[test]
fn a_loss_in_the_mesh_is_identified_from_a_start_at_rest() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).display().to_string();
    let (recording, model) = (file("steps.csv"), file("model.toml"));
    let mut simulate: Vec<&str> = "simulate --profile steps --duration 6s --seed 102 -o".split(' ').collect();
    simulate.extend([recording.as_str(), "--hide", "mesh_loss@mesh:fraction=0.05"]);
    let truth = ["k1=75", "k2=50", "k4=120", "c2=0.03", "c3=0.015", "c4=0.1", "c5=0.04"];
    simulate.extend(truth.iter().flat_map(|setting| ["--set", setting]));
    let _ = run(simulate).done();
    let (_, text) = socam_model::BUILTIN.iter().find(|(name, _)| *name == "speed-o-cam").unwrap();
    let starts = [
        ("1.24", "1.237"),
        ("0.95", "0.908"),
        ("916", "1413"),
        ("1.92", "2.093"),
        ("0.08", "0.0999"),
        ("0.05", "0.03995"),
    ];
    let text = starts.iter().fold((*text).to_owned(), |text, (file, near)| {
        text.replacen(&format!("value = {file},"), &format!("value = {near},"), 1)
    });
    let law = r#"
[parameters.share]
value = 0.03
unit = "1"
bounds = [0, 1]
[[effects]]
effect = "mesh_loss"
at = "mesh"
parameters = { fraction = "share" }
"#;
    std::fs::write(&model, text + law).unwrap();
    let result = run(["identify", &recording, "--model", &model, "--starts", "1", "--json"]).json();
    let share = by_name(&result["parameters"])["share"];
    assert!(holds(share, 0.05), "{share:#}");
}

#[test]
fn identify_prints_the_same_digits_whatever_the_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let paths: Vec<_> = [(3.0, 1), (1.5, 2), (0.8, 3)]
        .into_iter()
        .map(|(seconds, seed)| {
            let path = folder.path().join(format!("run{seed}.csv"));
            std::fs::write(&path, BENCH.csv(seconds, seed)).unwrap();
            path
        })
        .collect();
    let printed = |threads: &str| {
        let mut command = socam_host();
        command.arg("identify").args(&paths).args(["--starts", "2", "--json"]);
        let ran = Ran::from(command.env("RAYON_NUM_THREADS", threads).output().unwrap());
        let digits = |line: &&str| !line.contains("\"cpu_s\"");
        ran.done().lines().filter(digits).map(str::to_owned).collect::<Vec<_>>()
    };
    let alone = printed("1");
    assert!(alone.len() > 100);
    assert_eq!(alone, printed("2"));
    assert_eq!(alone, printed("5"));
}

#[test]
fn info_prints_one_document() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(path("run.csv"), BENCH.csv(0.5, 1)).unwrap();
    std::fs::write(path("points.csv"), "point_1,torque_in_Nm\n1,0.6900\n2,0.6846\n").unwrap();
    let _ = run(["import", &path("run.csv")]).done();
    let info = run(["info", "--json", &path("run.csv"), &path("run.mcap"), &path("points.csv")]).json();
    assert_eq!(info["schema"], "socam.info/1");
    let [csv, mcap, points] = info["recordings"].as_array().unwrap().as_slice() else { panic!("{info}") };
    assert_eq!(csv["channels"], mcap["channels"], "a conversion changes no value");
    for recording in [csv, mcap] {
        assert_eq!(recording["rows"], 500);
        assert_between(&recording["rate_hz"], 999.999, 1000.001);
        assert_eq!(recording["gaps"], serde_json::json!([]));
    }
    assert_eq!(mcap["lost_samples"], 0);
    assert_eq!(points["rows"], 2);
}

/// A pendulum of springs that is let go: stiffness and damping follow if the inertia is known, and their ratios to it otherwise.
#[test]
fn a_free_swing_needs_no_input() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (inertia, stiffness, damping): (f64, f64, f64) = (0.02, 8.0, 0.03);
    let decay = 0.5 * damping / inertia;
    let turns = (stiffness / inertia - decay * decay).sqrt();
    let mut noise = Noise(11);
    let mut csv = String::from("t_s,disc_angle_rad\n");
    for k in 0..2500 {
        let t = 0.002 * f64::from(k);
        let angle = 0.7 * (-decay * t).exp() * (turns * t + 0.4).cos() + 3e-4 * noise.draw();
        csv += &format!("{t:.3},{angle:.6}\n");
    }
    std::fs::write(path("swing.csv"), csv).unwrap();
    let model = |fixed: &str| {
        format!(
            r#"schema = "socam.model/1"
name = "swing"
motion = "rotation"
[parameters]
J = {{ value = 0.02, unit = "kg m2"{fixed} }}
k = {{ value = 3, unit = "N m/rad" }}
c = {{ value = 0.1, unit = "N m s/rad" }}
[[nodes]]
name = "disc"
inertia = "J"
[[springs]]
name = "spring"
from = "disc"
to = "ground"
stiffness = "k"
damping = "c"
[channels.disc_angle]
role = "output"
quantity = "angle"
at = "disc"
"#
        )
    };
    std::fs::write(path("known.toml"), model(", fixed = true")).unwrap();
    std::fs::write(path("unknown.toml"), model("")).unwrap();
    let swing = path("swing.csv");
    let known = run(["identify", &swing, "--model", &path("known.toml"), "--json"]).json();
    let parameters = by_name(&known["parameters"]);
    assert!(holds(parameters["k"], stiffness) && holds(parameters["c"], damping), "{parameters:?}");
    let unknown = run(["identify", &swing, "--model", &path("unknown.toml"), "--json"]).json();
    for parameter in unknown["parameters"].as_array().unwrap() {
        assert_eq!(
            (&parameter["identifiable"], &parameter["value"]),
            (&false.into(), &Value::Null),
            "{parameter}"
        );
    }
    let ratios = by_name(&unknown["combinations"]);
    assert!(
        holds(ratios["k/J"], stiffness / inertia) && holds(ratios["c/J"], damping / inertia),
        "{ratios:?}"
    );
    let diagnosed = run(["diagnose", &swing, "--model", &path("known.toml"), "--json"]).json();
    assert_eq!(diagnosed["verdict"], "adequate", "{}", diagnosed["findings"]);
    let refused =
        run(["simulate", "--profile", "sine", "--model", &path("known.toml"), "-o", &path("no.csv")]);
    assert!(
        refused.code == Some(1) && refused.stderr.contains("no input that a profile"),
        "{}",
        refused.stderr
    );
}

/// The servo axis of Janot, Gautier and Brunot, "Data Set and Reference Models of EMPS" (2019): mass 95.1089 kg, viscous
/// 203.5034 N s/m, Coulomb 20.3935 N, offset -3.1648 N; the force's error 4.0834 % fitted and 5.9824 % not fitted. Their recipe
/// on the same data, run anew in Python: 95.116, 203.375, 20.409, -3.170; 4.039 % and 5.953 %. Both brackets are about as
/// wide as these two differ.
#[test]
fn inverse_dynamics_of_a_real_axis_repeats_what_was_published() {
    let (Some(train), Some(test)) = emps() else { return };
    let arguments = [
        "identify",
        &train,
        "--model",
        "emps",
        "--method",
        "inverse-dynamics",
        "--validate",
        &test,
        "--json",
    ];
    let result = run(arguments).json();
    let parameters = by_name(&result["parameters"]);
    assert_between(&parameters["mass"]["value"], 95.1089 * 0.999, 95.1089 * 1.001);
    assert_between(&parameters["viscous"]["value"], 203.5034 * 0.997, 203.5034 * 1.003);
    assert_between(&parameters["coulomb"]["value"], 20.3935 * 0.997, 20.3935 * 1.003);
    assert_between(&parameters["offset"]["value"], -3.1648 * 1.003, -3.1648 * 0.997);
    assert_between(&result["fit"]["channels"]["force"]["relative_error_percent"], 4.02, 4.06);
    assert_between(&result["validation"][0]["force_error_percent"], 5.93, 5.97);
}

#[test]
fn output_error_intervals_of_a_real_axis_hold_what_was_published() {
    let (Some(train), _) = emps() else { return };
    let result = run(["identify", &train, "--model", "emps", "--json"]).json();
    let parameters = by_name(&result["parameters"]);
    for (name, published) in
        [("mass", 95.1089), ("viscous", 203.5034), ("coulomb", 20.3935), ("offset", -3.1648)]
    {
        let ci95 = &parameters[name]["ci95"];
        // The published value has an interval too: inverse dynamics gives 0.2 kg for the mass. Our interval begins 0.08 kg above
        // it.
        let own = if name == "mass" { 0.2 } else { 0.0 };
        assert!(
            number(&ci95[0]) < published + own && published < number(&ci95[1]),
            "{name}: {ci95} has no {published}"
        );
        // An interval that holds everything proves nothing. The widest is 0.35 of its value: it allows for what the model leaves out.
        assert!(number(&ci95[1]) - number(&ci95[0]) < 0.4 * published.abs(), "{name}: {ci95}");
    }
}

/// 25 s of a double integrator from its measured force alone: the best published neural model is 74 mm off (root mean
/// square, of a stroke of 0.25 m). Half of what we reach would be as suspicious as twice.
#[test]
fn the_free_run_of_a_real_axis_stays_within_millimetres() {
    let (Some(train), Some(test)) = emps() else { return };
    // The force taken as known: nothing but the position's error counts.
    let exact = ["--noise", "position=0.001", "--noise", "force=0"];
    let arguments = ["identify", &train, "--model", "emps", "--validate", &test, "--json"];
    let result = run(arguments.into_iter().chain(exact)).json();
    assert_between(&result["fit"]["channels"]["position"]["rms"], 1.2e-3, 2.6e-3);
    assert_between(&result["validation"][0]["fit"]["channels"]["position"]["rms"], 2.5e-3, 5e-3);
}

fn emps() -> (Option<String>, Option<String>) {
    let path = data_set("emps").map(|folder| folder.to_str().unwrap().to_owned());
    (
        path.as_ref().map(|path| format!("{path}/emps_train.csv")),
        path.map(|path| format!("{path}/emps_test_pulses.csv")),
    )
}
