//! `watch` and `record --watch` as processes: a change that begins in mid-run raises an alarm, a healthy bench does not, and the alarm is
//! in the recording.

use serde_json::Value;
use socam_tests::{path, run};

/// Time at which the friction begins, s.
const BEGINS_S: f64 = 14.0;
const CHANGE: [&str; 4] = ["--hide", "coulomb_friction@load_bearing:torque=0.1", "--begin-at", "14s"];

fn simulate(log: &str, duration: &str, more: &[&str]) {
    let arguments = ["simulate", "--profile", "multisine", "--duration", duration, "-o", log];
    let _ = run(arguments.iter().chain(more)).done();
}

/// Checks an alarm of the change.
fn assert_names_the_friction(alarm: &Value) {
    let number = |name: &str| alarm[name].as_f64().unwrap();
    assert!((BEGINS_S - 0.6..BEGINS_S + 3.0).contains(&number("time_s")), "{alarm}");
    assert!((number("onset_s") - BEGINS_S).abs() < 1.5, "{alarm}");
    let causes = alarm["naming"]["causes"].as_array().unwrap();
    let is_friction = |cause: &Value| cause["effect"] == "coulomb_friction";
    assert!(causes.iter().any(is_friction), "{alarm}");
}

#[test]
fn a_replayed_log_raises_an_alarm_where_it_changes() {
    let folder = tempfile::tempdir().unwrap();
    let [healthy, well, changed] =
        ["healthy", "well", "changed"].map(|name| path(&folder, &format!("{name}.mcap")));
    simulate(&healthy, "40s", &[]);
    simulate(&well, "24s", &["--seed", "2"]);
    simulate(&changed, "24s", &[&CHANGE[..], &["--seed", "3"]].concat());
    let found = run(["watch", &well, &changed, "--baseline", &healthy, "--json"]).json();
    assert_eq!(found["schema"], "socam.watch/1");
    assert_eq!(found["recordings"][0]["alarms"], Value::Array(Vec::new()));
    assert_eq!(found["recordings"][0]["blocks_not_judged"], 0);
    let alarms = found["recordings"][1]["alarms"].as_array().unwrap();
    assert_eq!(alarms.len(), 1, "{found}");
    assert_names_the_friction(&alarms[0]);
    // Without healthy recordings the beginning of the recording is the baseline.
    let said = run(["watch", &changed, "--learn", "10s"]);
    assert!(said.stderr.contains("baseline: 10.0 s of the healthy bench, 20 blocks"), "{}", said.stderr);
    assert!(said.stderr.contains("warning: 20 blocks are few"), "{}", said.stderr);
    let said = said.done();
    assert!(said.contains(": 1 alarm in 24") && said.contains("cause of alarm 1: "), "{said}");
}

#[test]
fn an_alarm_of_a_run_is_an_event_of_its_recording() {
    let folder = tempfile::tempdir().unwrap();
    let [healthy, log] = ["healthy", "run"].map(|name| path(&folder, &format!("{name}.mcap")));
    simulate(&healthy, "40s", &[]);
    let arguments = ["record", "-o", &log, "--device", "sim", "--profile", "multisine", "--duration", "24s"];
    let watch = ["--seed", "4", "--watch", "speed-o-cam", "--baseline", &healthy];
    let ran = run(arguments.iter().chain(&CHANGE).chain(&watch));
    assert!(ran.stderr.contains("alarm 1 at "), "{}", ran.stderr);
    let _ = ran.done();
    let info = run(["info", "--json", &log]).json();
    let events = info["recordings"][0]["log"]["events"].as_array().unwrap();
    let alarms: Vec<&Value> = events.iter().filter(|event| event["kind"] == "alarm").collect();
    assert_eq!(alarms.len(), 2, "{events:?}");
    let time_s = alarms[0]["device_time_ns"].as_f64().unwrap() * 1e-9;
    assert!((BEGINS_S - 0.6..BEGINS_S + 3.0).contains(&time_s), "{alarms:?}");
    assert!(alarms[1]["text"].as_str().unwrap().starts_with("cause of alarm 1: "), "{alarms:?}");
}

#[test]
fn slips_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let log = path(&folder, "run.mcap");
    let record = ["record", "-o", &log, "--device", "sim", "--profile", "steps"];
    let refused = |more: &[&str]| run(record.iter().chain(more)).refusal(2).to_owned();
    assert!(refused(&["--learn", "10s"]).contains("name its model with --watch"));
    assert!(refused(&["--begin-at", "5s"]).contains("--begin-at needs a --set or --hide"));
    assert!(
        run(record.iter().chain(&["--begin-at", "5s", "--hide", "backlash@mesh:gap=0.002"]))
            .refusal(1)
            .contains("mid-run")
    );
}

#[test]
fn rules_of_the_users_own_decide_the_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let [run_csv, rules] = ["run.csv", "rules.toml"].map(|name| path(&folder, name));
    let row = |k: u32| {
        let torque = if (200..260).contains(&k) { 1.2 } else { 0.5 };
        format!("{:.2},{torque},{}\n", 0.01 * f64::from(k), f64::from(k % 50))
    };
    let rows: String = (0..500).map(row).collect();
    std::fs::write(&run_csv, format!("time_s,motor_torque_Nm,motor_speed_rad_s\n{rows}")).unwrap();
    let limit = |for_s: f64| {
        format!(
            "[rules.overload]\nformula = \"abs(motor_torque)\"\nunit = \"mN m\"\nbelow = 900\nfor_s = {for_s}\n"
        )
    };
    let check = || run(["check", &run_csv, "--input", "motor_torque", "--rules", &rules]);
    std::fs::write(&rules, limit(0.3)).unwrap();
    let broken = check();
    assert_eq!(broken.code, Some(4), "{}", broken.stderr);
    let said = "rule overload: broken from 2 s to 2.59 s, worst 1200 mN m at 2 s";
    assert!(broken.stdout.contains(said), "{}", broken.stdout);
    let json = run(["check", &run_csv, "--input", "motor_torque", "--rules", &rules, "--json"]);
    let document: Value = serde_json::from_str(&json.stdout).unwrap();
    assert_eq!(document["rules"][0]["verdicts"][0]["keeping"], "broken");
    assert_eq!((&document["schema"], json.code), (&Value::from("socam.check/1"), Some(4)));
    std::fs::write(&rules, limit(0.8)).unwrap();
    assert!(check().done().contains("rule overload: kept"));
    std::fs::write(&rules, limit(0.3).replace("motor_torque", "motor_torqe")).unwrap();
    let refused = check();
    assert!(
        refused.stderr.contains("rules.toml`: line 2: rules.overload.formula names motor_torqe"),
        "{}",
        refused.stderr
    );
}
