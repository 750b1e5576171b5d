use super::*;

/// The document in the form of the contract, without any of the fields added later.
const CONTRACT: &str = r#"{
  "schema": "socam.diagnosis/1", "verdict": "missing_physics", "false_alarm_rate": 0.01, "validation": "leave_one_out",
  "findings": [{
    "effect": "coulomb_friction", "location": "cam_bearing",
    "parameters": [{"name": "torque", "value": 0.05, "unit": "N m", "ci95": [0.04, null]}],
    "components": [], "curve": {"over": "speed", "unit": "rad/s", "x": [-1.0, 1.0], "torque": [0.05, null]},
    "region": {"speed_rad_s": [-1.0, 1.0], "torque_Nm": null, "frequency_Hz": [0.0, 5.0], "time_s": null, "text": "slow"},
    "evidence": {"p_value": 1e-9, "chi2_gain": 812.0, "holdout_gain_percent": 93.0},
    "rivals": [{"effect": "stribeck_friction", "location": "cam_bearing", "weight": 0.2}],
    "sentence": "It rubs.", "equation": "T = -Tc sign(w)"}],
  "fit": {"channels": {"zeta": {"noise_std": 0.1, "rms_before": 0.3, "rms_after": 0.11, "holdout_rms_before": 0.3,
    "holdout_rms_after": null}, "alpha": {"noise_std": 1.0, "rms_before": 3.0, "rms_after": 1.1,
    "holdout_rms_before": 3.0, "holdout_rms_after": 1.2}}},
  "parameters": [{"name": "k1", "unit": "N m/rad", "before": null, "after": 71.0, "ci95": [70.0, 72.0],
    "identifiable": true}],
  "not_found": [{"effect": "backlash", "location": "mesh", "parameter": "gap", "smallest_detectable": 0.0004,
    "unit": "rad"}],
  "suggested_experiment": null, "cpu_s": 2.5, "warnings": []
}"#;

#[test]
fn the_contract_is_read_and_written() {
    let diagnosis: Diagnosis = serde_json::from_str(CONTRACT).unwrap();
    assert_eq!(diagnosis.verdict, Verdict::MissingPhysics);
    assert_eq!(diagnosis.findings[0].region.frequency_hz, Some([0.0, 5.0]));
    let names: Vec<_> = diagnosis.fit.channels.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["zeta", "alpha"], "channels keep the model's order");

    let written = serde_json::to_string(&diagnosis).unwrap();
    assert_eq!(serde_json::from_str::<Diagnosis>(&written).unwrap(), diagnosis);
    let contract: serde_json::Value = serde_json::from_str(CONTRACT).unwrap();
    assert_contains(&serde_json::from_str(&written).unwrap(), &contract, "$");
}

#[test]
fn numbers_are_finite_or_null() {
    let mut diagnosis: Diagnosis = serde_json::from_str(CONTRACT).unwrap();
    diagnosis.findings[0].evidence.chi2_gain = Some(f64::NAN);
    diagnosis.findings[0].parameters[0].ci95[1] = Some(f64::INFINITY);
    let written = serde_json::to_string(&diagnosis).unwrap();
    let back: Diagnosis = serde_json::from_str(&written).unwrap();
    assert_eq!(back.findings[0].evidence.chi2_gain, None);
    assert_eq!(back.findings[0].parameters[0].ci95[1], None);
}

/// Asserts that `actual` contains everything in `expected`; it may contain more.
fn assert_contains(actual: &serde_json::Value, expected: &serde_json::Value, at: &str) {
    use serde_json::Value;
    match (actual, expected) {
        (Value::Object(actual), Value::Object(expected)) => {
            for (key, value) in expected {
                let found = actual.get(key).unwrap_or_else(|| panic!("{at}.{key} is gone"));
                assert_contains(found, value, &format!("{at}.{key}"));
            }
        }
        (Value::Array(actual), Value::Array(expected)) => {
            assert_eq!(actual.len(), expected.len(), "{at}");
            for (index, (actual, expected)) in actual.iter().zip(expected).enumerate() {
                assert_contains(actual, expected, &format!("{at}[{index}]"));
            }
        }
        _ => assert_eq!(actual, expected, "{at}"),
    }
}
