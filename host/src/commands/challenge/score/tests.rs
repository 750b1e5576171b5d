use serde_json::{Value, json};

use socam_sim::challenge::{Background, family_of};

use super::*;

fn finding(effect: &str, location: &str, rivals: &[(&str, &str)]) -> Value {
    let rivals: Vec<Value> = rivals
        .iter()
        .map(|(effect, location)| json!({"effect": effect, "location": location, "weight": 0.3}))
        .collect();
    json!({
        "effect": effect, "location": location, "components": [], "curve": null, "rivals": rivals,
        "parameters": [
            {"name": "torque", "value": 0.3, "unit": "N m", "ci95": [0.29, 0.31]},
            {"name": "phase", "value": -0.1, "unit": "rad", "ci95": [-0.2, 0.1]},
        ],
        "region": {"speed_rad_s": null, "torque_Nm": null, "frequency_Hz": null, "time_s": null, "text": ""},
        "evidence": {"p_value": null, "chi2_gain": null, "holdout_gain_percent": null},
        "sentence": "", "equation": "",
    })
}

fn diagnosis(findings: &[Value], holdout_rms_after: f64) -> Result<Diagnosis, String> {
    let channel = json!({
        "noise_std": 0.01, "rms_before": 0.1, "rms_after": 0.01, "holdout_rms_before": 0.1,
        "holdout_rms_after": holdout_rms_after,
    });
    serde_json::from_value(json!({
        "schema": "socam.diagnosis/1", "verdict": "missing_physics", "false_alarm_rate": 0.01, "validation": "holdout",
        "findings": findings, "fit": {"channels": {"torque_out": channel}}, "parameters": [], "not_found": [],
        "suggested_experiment": null, "cpu_s": 2.0, "warnings": [],
    }))
    .map_err(|error| error.to_string())
}

fn case(kind: CaseKind, hidden: &[(&str, &str)]) -> Case {
    let on_default_bench = |number: &u64| family_of(1, *number) == "speed-o-cam";
    let mut case = Case::draw(1, (0..400).find(on_default_bench).unwrap()).unwrap();
    (case.kind, case.background) = (kind, Background::default());
    case.hidden = hidden
        .iter()
        .map(|(effect, place)| Hidden {
            effect: (*effect).into(),
            place: (*place).into(),
            parameters: vec![("torque".into(), 0.3), ("phase".into(), std::f64::consts::TAU)],
            own: Vec::new(),
        })
        .collect();
    case
}

fn score(kind: CaseKind, hidden: &[(&str, &str)], findings: &[Value]) -> Score {
    let oracle = Oracle { gain: vec![Some(100.0); hidden.len()], misfit: Some(1.0) };
    Score::new(&case(kind, hidden), (&diagnosis(findings, 0.0114), 2.0), oracle, &same_effect)
}

/// Replaces the comparison by recordings: places of one effect are equivalent.
fn same_effect(finding: &Finding, _: usize) -> bool {
    finding.effect == "missing_inertia" || finding.effect == "coupling_slip"
}

#[test]
fn the_first_finding_counts() {
    let truth = [("gravity_unbalance", "load")];
    let right = finding("gravity_unbalance", "load", &[]);
    let wrong = finding("sensor_gain", "torque_out", &[("gravity_unbalance", "load")]);
    let first = score(CaseKind::Single, &truth, &[right.clone(), wrong.clone()]);
    // Gravity does not tie with the wrong name: 0.7 beside 0.3 is more than twice as much.
    assert!(first.right && first.wrong_name && first.detectable);
    assert_eq!(
        (first.probability, first.statements),
        (vec![1.0], vec![(1.0, true), (0.7, false), (0.3, true)])
    );
    assert_eq!(first.at_the_floor, Some(true));
    assert_eq!(first.intervals, [("torque".to_owned(), true), ("phase".to_owned(), true)]);
    let second = score(CaseKind::Single, &truth, &[wrong, right]);
    assert!(!second.right && second.at_the_floor.is_none());
    let elsewhere = score(CaseKind::Single, &truth, &[finding("gravity_unbalance", "disk", &[])]);
    assert!(!elsewhere.right && elsewhere.intervals.is_empty());
    assert!(!score(CaseKind::Single, &truth, &[]).right);
}

#[test]
fn a_wrong_answer_says_where_the_truth_was_lost() {
    let truth = [("gravity_unbalance", "load"), ("backlash", "mesh")];
    let mut answer = diagnosis(&[finding("sensor_gain", "torque_out", &[])], 0.02).unwrap();
    answer.candidates = serde_json::from_value(json!([
        {"effect": "sensor_gain", "location": "torque_out", "stage": "found", "step": 1, "sentence": "Found"},
        {"effect": "gravity_unbalance", "location": "load", "stage": "raced_out", "step": 1, "sentence": "Given up"},
    ]))
    .unwrap();
    let oracle = Oracle { gain: vec![Some(100.0); 2], misfit: Some(1.0) };
    let case = case(CaseKind::Double, &truth);
    let score = Score::new(&case, (&Ok(answer), 2.0), oracle, &same_effect);
    let lost: Vec<_> = score.lost.iter().map(|one| (one.effect.as_str(), one.stage)).collect();
    assert_eq!(lost, [("gravity_unbalance", Stage::RacedOut), ("backlash", Stage::NotProposed)]);
    let text = crate::commands::challenge::report::Report::new(1, vec![score]).text();
    assert!(text.contains("given up during its fit: 1") && text.contains("never proposed: 1"), "{text}");
    assert!(text.contains("gravity_unbalance@load: given up during its fit. Given up"), "{text}");
}

#[test]
fn a_twin_counts_if_it_owns_up() {
    let truth = [("missing_inertia", "cam_shaft")];
    let named = |rivals: &[(&str, &str)]| finding("missing_inertia", "disk", rivals);
    assert!(score(CaseKind::Single, &truth, &[named(&[("missing_inertia", "cam_shaft")])]).right);
    assert!(!score(CaseKind::Single, &truth, &[named(&[])]).right);
    let slip = finding("coupling_slip", "coupling_2", &[("coupling_slip", "coupling_1")]);
    assert!(score(CaseKind::Single, &[("coupling_slip", "coupling_1")], &[slip]).right);
}

#[test]
fn a_wrong_name_beside_a_tying_right_rival_is_no_wrong_name() {
    let truth = [("constant_load", "load")];
    let mut wrong = finding("sensor_offset", "torque_out", &[("constant_load", "load")]);
    assert!(score(CaseKind::Single, &truth, &[wrong.clone()]).wrong_name);
    wrong["rivals"][0]["weight"] = json!(0.4);
    let tied = score(CaseKind::Single, &truth, &[wrong]);
    assert!(!tied.right && !tied.wrong_name && tied.probability == [0.4]);
}

#[test]
fn the_background_is_no_false_alarm() {
    let mut case = case(CaseKind::Clean, &[]);
    case.background.friction = vec![("load_bearing".into(), 0.01)];
    let named = |place: &str| {
        let answer = diagnosis(&[finding("coulomb_friction", place, &[])], 0.1);
        let score = Score::new(&case, (&answer, 1.0), Oracle::default(), &same_effect);
        (score.right, score.background_named)
    };
    assert_eq!((named("load_bearing"), named("cam_bearing")), ((true, 1), (false, 0)));
}

/// A realistic case with one late sensor, friction at the load and a wrong torque constant.
fn realistic(kind: CaseKind, hidden: &[(&str, &str)]) -> Case {
    let mut case = case(kind, hidden);
    case.realistic = true;
    case.background.friction = vec![("load_bearing".into(), 0.05)];
    case.background.delays = vec![("torque_out".into(), 1.5)];
    case
}

#[test]
fn the_background_may_come_before_what_is_hidden() {
    let case = realistic(CaseKind::Single, &[("gravity_unbalance", "load")]);
    let friction = finding("coulomb_friction", "load_bearing", &[]);
    let of = |findings: &[Value]| {
        Score::new(&case, (&diagnosis(findings, 0.1), 1.0), Oracle::default(), &same_effect)
    };
    let gravity = || finding("gravity_unbalance", "load", &[]);
    let after = of(&[friction.clone(), gravity()]);
    assert!(after.right && !after.wrong_name);
    // Both statements are true: the background has friction there.
    assert_eq!(after.statements, [(1.0, true), (1.0, true)]);
    let elsewhere = finding("coulomb_friction", "cam_bearing", &[]);
    assert!(!of(&[elsewhere, gravity()]).right);
}

#[test]
fn delays_are_relative() {
    let case = realistic(CaseKind::Clean, &[]);
    let of = |place: &str, delay_s: f64| {
        let mut named = finding("sensor_delay", place, &[]);
        named["parameters"][0] =
            json!({"name": "delay", "value": delay_s, "unit": "s", "ci95": [null, null]});
        Score::new(&case, (&diagnosis(&[named], 0.1), 1.0), Oracle::default(), &same_effect).right
    };
    let input = case.machine.input.name.as_str();
    // A late sensor, or all other channels early.
    assert!(of("torque_out", 1e-3) && of(input, -1e-3));
    assert!(!of("torque_out", -1e-3) && !of(input, 1e-3));
}

#[test]
fn friction_of_the_background_adds_to_a_hidden_one() {
    let case = realistic(CaseKind::Single, &[("coulomb_friction", "load_bearing")]);
    let of = |value: f64| {
        let mut named = finding("coulomb_friction", "load_bearing", &[]);
        named["parameters"][0]["ci95"] = json!([value - 0.01, value + 0.01]);
        let score = Score::new(&case, (&diagnosis(&[named], 0.1), 1.0), Oracle::default(), &same_effect);
        score.intervals[0].1
    };
    assert!(of(0.35) && !of(0.3));
}

#[test]
fn small_masses_are_there() {
    let truth = [("constant_load", "load")];
    let load = || finding("constant_load", "load", &[]);
    let inertia = |place| finding("missing_inertia", place, &[]);
    assert!(!score(CaseKind::Single, &truth, &[load(), inertia("torque_sensor_out")]).wrong_name);
    assert!(score(CaseKind::Single, &truth, &[load(), inertia("disk")]).wrong_name);
    assert!(score(CaseKind::Single, &truth, &[inertia("torque_sensor_out")]).wrong_name);
    assert!(score(CaseKind::Clean, &[], &[inertia("torque_sensor_out")]).wrong_name);
}

#[test]
fn two_effects_count_in_any_order_but_before_others() {
    let truth = [("constant_load", "load"), ("backlash", "mesh")];
    let found = truth.map(|(effect, place)| finding(effect, place, &[]));
    let extra = finding("sensor_gain", "torque_in", &[]);
    let [load, play] = found;
    assert!(score(CaseKind::Double, &truth, &[play.clone(), load.clone()]).right);
    assert!(score(CaseKind::Double, &truth, &[load.clone(), play.clone(), extra.clone()]).right);
    assert!(!score(CaseKind::Double, &truth, &[load.clone(), extra, play]).right);
    assert!(!score(CaseKind::Double, &truth, &[load]).right);
}

#[test]
fn nothing_is_to_be_found_on_a_clean_bench() {
    assert!(score(CaseKind::Clean, &[], &[]).right);
    let alarm = score(CaseKind::Clean, &[], &[finding("sensor_gain", "torque_in", &[])]);
    assert!(!alarm.right && alarm.wrong_name);
}

#[test]
fn outside_the_catalogue_the_place_is_enough_and_so_is_not_knowing() {
    let truth = [("eddy_current_brake", "load_bearing")];
    let unexplained = finding(UNEXPLAINED, "torque_out", &[]);
    let elsewhere = finding("sensor_gain", "torque_out", &[]);
    assert!(score(CaseKind::Outside, &truth, std::slice::from_ref(&unexplained)).right);
    assert!(score(CaseKind::Outside, &truth, &[finding("stribeck_friction", "load_bearing", &[])]).right);
    assert!(score(CaseKind::Outside, &truth, &[finding("constant_load", "load", &[])]).right);
    let wrong = score(CaseKind::Outside, &truth, std::slice::from_ref(&elsewhere));
    assert!(!wrong.right && wrong.wrong_name);
    assert!(!score(CaseKind::Outside, &truth, &[elsewhere, unexplained]).wrong_name);
}

#[test]
fn a_failed_diagnosis_is_wrong_and_small_effects_do_not_count() {
    let failed =
        Score::new(&case(CaseKind::Clean, &[]), (&Err("no".into()), 1.0), Oracle::default(), &same_effect);
    assert!(!failed.right && failed.error.is_some());
    let oracle = Oracle { gain: vec![Some(24.0)], misfit: Some(1.0) };
    let truth = case(CaseKind::Single, &[("backlash", "mesh")]);
    assert!(!Score::new(&truth, (&diagnosis(&[], 0.1), 1.0), oracle, &same_effect).detectable);
}
