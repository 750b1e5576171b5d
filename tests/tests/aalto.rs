//! The torsional drivetrain bench of Aalto University: the published chain of 22 inertias.

use std::collections::BTreeMap;

use serde_json::Value;
use socam_model::Model;
use socam_tests::{data_set, run};

#[test]
fn the_published_chain_has_its_published_modes() {
    let mut model = Model::parse(include_str!("../models/aalto.toml")).unwrap();
    // Published are the modes of the undamped chain.
    for parameter in &mut model.parameters {
        if parameter.unit == "N m s/rad" {
            parameter.value = 0.0;
        }
    }
    let modes = model.equations(&model.values()).unwrap().modes();
    let mut frequencies: Vec<f64> = modes.iter().map(|mode| mode.natural_frequency_hz).collect();
    // The free rotation comes first.
    frequencies.retain(|frequency| *frequency > 1.0);
    assert!(frequencies.len() >= 4, "{frequencies:?}");
    for (found, published) in frequencies.iter().zip([29.62, 39.65, 77.61, 359.7]) {
        assert!((found - published).abs() < 0.1, "{found} Hz is not {published} Hz");
    }
}

const RECORDINGS: [&str; 3] = [
    "aalto/aalto_ice3200_offset0pct.csv",
    "aalto/aalto_ice3200_offset1pct.csv",
    "aalto/aalto_ice3200_offset5pct.csv",
];

/// Identifies on two recordings and predicts the third, as docs/aalto.md does.
fn leave_out(recordings: [&str; 3], held_out: usize) -> Value {
    let train = |nth: usize| recordings[(held_out + nth) % 3];
    let mut arguments = vec!["identify", train(1), train(2), "--validate", train(0)];
    arguments.extend(["--model", concat!(env!("CARGO_MANIFEST_DIR"), "/models/aalto-mesh.toml")]);
    arguments.extend(["--noise", "upper_torque=0.2", "--noise", "lower_torque=0.8"]);
    arguments.extend(["--start", "equilibrium", "--starts", "2", "--band", "2..80", "--json"]);
    run(arguments).json()
}

#[test]
#[cfg_attr(not(feature = "full"), ignore = "full tier")]
fn two_recordings_predict_the_shaft_torques_of_the_third() {
    let mut paths = Vec::new();
    for recording in RECORDINGS {
        let Some(path) = data_set(recording) else { return };
        paths.push(path);
    }
    let recordings = [0, 1, 2].map(|index: usize| paths[index].to_str().unwrap());
    // docs/aalto.md has the other two turns.
    let result = leave_out(recordings, 2);
    assert_eq!(result["converged"], true, "{}", result["end"]);

    let band = &result["validation"][0]["band"];
    assert_eq!((&band["low_hz"], &band["high_hz"]), (&2.0.into(), &80.0.into()));
    for torque in ["upper_torque", "lower_torque"] {
        let fit = band["channels"][torque]["fit_percent"].as_f64().unwrap();
        assert!((50.0..90.0).contains(&fit), "{torque} is predicted by {fit} %");
    }

    let parameters = result["parameters"].as_array().unwrap().iter();
    let parameters: BTreeMap<&str, &Value> =
        parameters.map(|parameter| (parameter["name"].as_str().unwrap(), parameter)).collect();
    for name in ["d12", "d22", "c19", "c21"] {
        let parameter = parameters[name];
        assert_eq!(parameter["identifiable"], false, "{parameter}");
        assert!(parameter["value"].is_null(), "{parameter}");
        assert!(parameter["note"].as_str().unwrap().starts_with("not determined"), "{parameter}");
    }
    for (name, low, high) in [("J12h", 2.5e-4, 4e-4), ("k5", 60.0, 130.0), ("k21", 3000.0, 6000.0)] {
        let value = parameters[name]["value"].as_f64();
        assert!(value.is_some_and(|value| (low..high).contains(&value)), "{}", parameters[name]);
    }
}
