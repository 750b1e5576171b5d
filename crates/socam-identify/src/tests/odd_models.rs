//! Unusual models and recordings.

use socam_model::Model;
use socam_recording::{Channel, Dataset, Unit};

use crate::tests::*;

/// Two driven ends with a mass between them: only relative angles matter, and both absolute ones are states.
const TWO_ENDS: &str = r#"
schema = "socam.model/1"
name = "two-ends"
motion = "rotation"
[parameters]
ka = { value = 100, unit = "N m/rad", bounds = [1, 1e4] }
kb = { value = 100, unit = "N m/rad", bounds = [1, 1e4] }
c = { value = 0.02, unit = "N m s/rad", bounds = [0, 1] }
unused = { value = 0.1, unit = "N m s/rad", bounds = [0, 1] }
J = { value = 1e-3, unit = "kg m2", fixed = true }
[[nodes]]
name = "left"
[[nodes]]
name = "middle"
inertia = "J"
[[nodes]]
name = "right"
[[springs]]
name = "a"
from = "left"
to = "middle"
stiffness = "ka"
[[springs]]
name = "b"
from = "middle"
to = "right"
stiffness = "kb"
damping = "c"
[channels.left_speed]
role = "input"
quantity = "speed"
at = "left"
[channels.right_speed]
role = "input"
quantity = "speed"
at = "right"
[channels.torque]
role = "output"
quantity = "torque"
at = "a"
"#;

/// A recording of this model by semi-implicit steps of a microsecond, with noise of 0.01 N m.
fn two_ends(ka: f64, kb: f64, c: f64) -> Dataset {
    let inputs =
        |t: f64| [3.0 * (20.0 * t).sin() + (170.0 * t).sin(), 2.0 * (31.0 * t).cos() + 10.0 * t.cos()];
    let (mut twist_a, mut twist_b, mut speed) = (0.0, 0.0, 0.0);
    let mut random = Lcg(3);
    let (mut time, mut columns) = (Vec::new(), vec![Vec::new(); 3]);
    for k in 0..6000 {
        let t = f64::from(k) * STEP_S;
        let [left, right] = inputs(t);
        time.push(t);
        let measured = [left, right, ka * twist_a + 0.01 * random.normal()];
        columns.iter_mut().zip(measured).for_each(|(column, value)| column.push(value));
        for part in 0..1000 {
            let [left, right] = inputs(t + (f64::from(part) + 0.5) * 1e-6);
            speed += 1e-6 * (ka * twist_a - kb * twist_b - c * (speed - right)) / 1e-3;
            twist_a += 1e-6 * (left - speed);
            twist_b += 1e-6 * (speed - right);
        }
    }
    let names = [("left_speed", Unit::RadPerS), ("right_speed", Unit::RadPerS), ("torque", Unit::Nm)];
    let channels = names.map(|(name, unit)| Channel::new(name, unit)).to_vec();
    Dataset::from_columns("two ends", channels, time, columns).unwrap()
}

#[test]
fn start_states_and_parameters_that_nothing_shows_harm_no_others() {
    let model = Model::parse(TWO_ENDS).unwrap();
    let data = [two_ends(150.0, 60.0, 0.05)];
    let options = Options { starts: 1, ..Options::default() };
    let result = output_error(&Problem::new(&model, &data, options).unwrap()).unwrap();
    assert!(result.converged, "{:?}", result.end);
    for (name, truth) in [("ka", 150.0), ("kb", 60.0), ("c", 0.05)] {
        let found = result.parameters.iter().find(|p| p.name == name).unwrap();
        assert!((found.value.unwrap() / truth - 1.0).abs() < 0.02, "{found:?}");
        assert!(found.std.unwrap() > 1e-6 * truth, "{found:?}");
    }
    let unused = result.parameters.iter().find(|p| p.name == "unused").unwrap();
    assert!(
        !unused.identifiable && unused.value.is_none() && unused.note.contains("next to nothing"),
        "{unused:?}"
    );
}

/// A motor of which only the speed is measured.
const NOTHING_MOVES: &str = r#"
schema = "socam.model/1"
name = "shaft"
motion = "rotation"
[parameters]
d = { value = 1, unit = "N m s/rad", bounds = [0, 10] }
[[nodes]]
name = "motor"
[[bearings]]
name = "bearing"
at = "motor"
damping = "d"
[channels.left_speed]
role = "input"
quantity = "speed"
at = "motor"
[channels.right_speed]
role = "output"
quantity = "speed"
at = "motor"
"#;

#[test]
fn a_model_without_states_is_predicted() {
    let model = Model::parse(NOTHING_MOVES).unwrap();
    let data = [two_ends(150.0, 60.0, 0.05)];
    let result = output_error(&Problem::new(&model, &data, Options::default()).unwrap()).unwrap();
    assert!(!result.parameters[0].identifiable, "{:?}", result.parameters);
}

#[test]
fn a_dead_channel_is_named() {
    let live = bench(TRUTH, 3.0, 1.0, 4);
    let loaded = live.load(&["motor_speed", "output_speed", "torque_in", "torque_out"]).unwrap();
    let mut model = model(|text| text);
    fix(&mut model, &[("k2", 54.4), ("k3", 52485.0), ("c3", 0.02)]);
    for dead in [0.0, 7.5, f64::NAN] {
        let mut columns: Vec<Vec<f64>> = loaded.columns.iter().map(|c| c.values().to_vec()).collect();
        columns[2].fill(dead);
        let data =
            [Dataset::from_columns("dead", live.channels().to_vec(), loaded.time_s.clone(), columns)
                .unwrap()];
        let options = Options { starts: 1, ..Options::default() };
        let result = output_error(&Problem::new(&model, &data, options).unwrap()).unwrap();
        assert!(result.warnings.iter().any(|w| w.starts_with("torque_in")), "{dead}: {:?}", result.warnings);
        assert!(result.point.iter().all(|value| value.is_finite()));
        let k4 = &result.parameters[model.parameter("k4").unwrap()];
        assert!(!dead.is_nan() || k4.value.is_some_and(|k4| (k4 / 110.0 - 1.0).abs() < 0.02), "{k4:?}");
        let (_, fit) = &result.fit.channels[1];
        assert_eq!(fit.rms.is_nan(), dead.is_nan(), "{fit:?}");
    }
}

#[test]
fn starts_and_options_that_cannot_be_meant_are_refused() {
    let model = model(|text| text);
    let data = [bench(TRUTH, 0.1, 0.0, 1)];
    let refused =
        |model: &Model, options: Options| Problem::new(model, &data, options).unwrap_err().to_string();
    let mut outside = model.clone();
    let k4 = model.parameter("k4").unwrap();
    outside.parameters[k4].value = 10.0 * model.parameters[k4].bounds.1;
    assert!(refused(&outside, Options::default()).starts_with("k4 starts at"));
    let levels =
        [(vec![0.1], 0.0), (vec![0.1, 0.0, 0.1], 0.0), (vec![f64::NAN; 3], 0.0), (vec![0.1; 3], -1.0)];
    for (outputs, input) in levels {
        let noise = Noise::Given(NoiseLevels { outputs, inputs: vec![input] });
        assert!(refused(&model, Options { noise, ..Options::default() }).contains("noise"));
    }
    for (index, lower, upper) in [(99, 0.0, 1.0), (0, 1.0, 0.0)] {
        let constraints = vec![Constraint { terms: vec![(index, 1.0)], lower, upper }];
        assert!(refused(&model, Options { constraints, ..Options::default() }).contains("constraint"));
    }
}
