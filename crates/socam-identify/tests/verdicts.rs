//! What a fit says of itself, on a motor that this file integrates by small Euler steps: how its torque runs between samples, a sensor with
//! the wrong sign, a model that lacks friction, and a swing that begins in its middle.

use socam_identify::{
    BetweenSource, Explained, Identification, Intersample, Options, Problem, output_error, settled_inputs,
};
use socam_model::Model;
use socam_recording::{Channel, Dataset, Unit};

const STEP_S: f64 = 5e-3;
const PARTS: u32 = 200;
const NOISE: f64 = 0.02;
const INERTIA: f64 = 0.01;
const DAMPING: f64 = 0.02;

/// A free motor; `extra` is what else acts at its bearing.
fn model(extra: &str) -> Model {
    Model::parse(&format!(
        r#"
schema = "socam.model/1"
name = "motor"
motion = "rotation"
[parameters]
inertia = {{ value = 0.02, unit = "kg m2", bounds = [1e-4, 1] }}
damping = {{ value = 0.05, unit = "N m s/rad", bounds = [0, 10] }}
[[nodes]]
name = "motor"
inertia = "inertia"
[[bearings]]
name = "bearing"
at = "motor"
damping = "damping"
{extra}
[channels.torque]
role = "input"
quantity = "torque"
at = "motor"
[channels.speed]
role = "output"
quantity = "speed"
at = "motor"
"#
    ))
    .unwrap()
}

fn draw(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// A motor with `friction` (N m), whose torque has a new level every twenty samples; from sample to sample it is held or ramps. `sign` is that
/// of the tachometer.
fn recording(seed: u64, kind: Intersample, friction: f64, sign: f64) -> Dataset {
    let mut random = seed;
    let levels: Vec<f64> = (0..81).map(|_| 2.0 * draw(&mut random)).collect();
    // Ramps of three samples between levels, as a drive's own filter makes them.
    let torque: Vec<f64> = (0..1600)
        .map(|k| {
            let share = ((k % 20) as f64 / 3.0).min(1.0);
            levels[k / 20] + share * (levels[k / 20 + 1] - levels[k / 20])
        })
        .collect();
    let mut speed = 0.0_f64;
    let mut measured = Vec::new();
    for k in 0..torque.len() {
        measured.push(sign * speed + NOISE * 1.7 * draw(&mut random));
        let next = torque.get(k + 1).copied().unwrap_or(torque[k]);
        for part in 0..PARTS {
            let share = (f64::from(part) + 0.5) / f64::from(PARTS);
            let now =
                if kind == Intersample::Hold { torque[k] } else { torque[k] + share * (next - torque[k]) };
            let rubbing = friction * (speed / 1e-3).tanh();
            speed += STEP_S / f64::from(PARTS) * (now - DAMPING * speed - rubbing) / INERTIA;
        }
    }
    let time_s = (0..torque.len()).map(|k| STEP_S * k as f64).collect();
    let channels = vec![Channel::new("torque", Unit::Nm), Channel::new("speed", Unit::RadPerS)];
    Dataset::from_columns(format!("run {seed}"), channels, time_s, vec![torque, measured]).unwrap()
}

fn fitted(model: &Model, data: &Dataset) -> Identification {
    let problem = Problem::new(model, std::slice::from_ref(data), Options::default()).unwrap();
    output_error(&problem).unwrap()
}

fn holds(found: &Identification, name: &str, truth: f64) -> bool {
    let estimate = found.parameters.iter().find(|parameter| parameter.name == name).unwrap();
    let [low, high] = estimate.ci95.map(Option::unwrap);
    // Two thirds wider than 95 %, for the steps of this file and the number of cases.
    let room = (high - low) / 3.0;
    low - room < truth && truth < high + room
}

#[test]
fn how_a_torque_runs_between_samples_is_found_and_stated() {
    for (seed, kind) in [(1, Intersample::Hold), (2, Intersample::Linear), (3, Intersample::Hold)] {
        let data = recording(seed, kind, 0.0, 1.0);
        let found = fitted(&model(""), &data);
        let (name, between) = &found.between[0];
        assert_eq!((name.as_str(), between.kind, between.source), ("torque", kind, BetweenSource::Data));
        assert!(holds(&found, "inertia", INERTIA) && holds(&found, "damping", DAMPING), "{found:#?}");
        assert_eq!(found.verdict.as_ref().unwrap().explained, Explained::Yes, "{:?}", found.verdict);
        let written = Model::parse(&found.model_text(&model("")).unwrap()).unwrap();
        assert_eq!(written.inputs().next().unwrap().intersample(), kind);
        // The same at known values, for simulations and monitoring.
        let mut known = model("");
        known.parameters.iter_mut().zip(&found.point).for_each(|(own, value)| own.value = *value);
        let settled = settled_inputs(&known, &[data], Options::default()).unwrap();
        assert_eq!(settled.inputs().next().unwrap().intersample(), kind);
    }
}

#[test]
fn what_is_stated_is_not_tried() {
    let mut stated = model("");
    stated.set_intersample("torque", Some(Intersample::Linear)).unwrap();
    let found = fitted(&stated, &recording(4, Intersample::Hold, 0.0, 1.0));
    assert_eq!(
        (found.between[0].1.kind, found.between[0].1.source),
        (Intersample::Linear, BetweenSource::Stated)
    );
}

#[test]
fn a_held_torque_has_no_noise() {
    let found = fitted(&model(""), &recording(5, Intersample::Hold, 0.0, 1.0));
    assert_eq!(found.input_noise_std, [("torque".to_owned(), 0.0)]);
}

#[test]
fn a_model_without_friction_explains_in_part_and_says_how_far_off_it_is() {
    let found = fitted(&model(""), &recording(6, Intersample::Hold, 0.3, 1.0));
    let verdict = found.verdict.as_ref().unwrap();
    assert!(verdict.explained > Explained::Yes && verdict.times_noise.unwrap() > 5.0, "{verdict:?}");
    assert_eq!(verdict.channel.as_deref(), Some("speed"));
    let noise = verdict.noise_std.unwrap();
    assert!((0.5 * NOISE..2.0 * NOISE).contains(&noise), "{noise}");
    assert!(found.warnings.iter().any(|one| one.contains("times its noise")), "{:?}", found.warnings);
}

#[test]
fn a_model_that_is_known_is_judged() {
    let mut known = model("");
    for (parameter, value) in known.parameters.iter_mut().zip([INERTIA, DAMPING]) {
        (parameter.value, parameter.fixed) = (value, true);
    }
    known.set_intersample("torque", Some(Intersample::Hold)).unwrap();
    let explained = |friction: f64| {
        let found = fitted(&known, &recording(8, Intersample::Hold, friction, 1.0));
        assert_eq!(found.point, [INERTIA, DAMPING]);
        found.verdict.unwrap().explained
    };
    assert_eq!(explained(0.0), Explained::Yes);
    assert!(explained(0.3) > Explained::Yes);
}

/// One read of the tachometer in sixty fails, and the model lacks friction, so that its own residuals do not show them.
#[test]
fn failed_reads_are_left_out_whatever_the_model_misses() {
    for friction in [0.0, 0.3] {
        let clean = recording(9, Intersample::Hold, friction, 1.0);
        let mut columns: Vec<Vec<f64>> =
            clean.load_all().unwrap().columns.iter().map(|column| column.values().to_vec()).collect();
        columns[1].iter_mut().skip(30).step_by(61).for_each(|speed| *speed = 3276.8);
        let channels = clean.channels().to_vec();
        let time_s = (0..columns[0].len()).map(|k| STEP_S * k as f64).collect();
        let failing = Dataset::from_columns("failing", channels, time_s, columns).unwrap();
        let [found, whole] = [&failing, &clean].map(|data| fitted(&model(""), data));
        assert_eq!(found.left_out.iter().map(|one| one.samples).sum::<u64>(), 26, "{:?}", found.left_out);
        for (found, whole) in found.point.iter().zip(&whole.point) {
            assert!((found / whole - 1.0).abs() < 0.03, "{found} beside {whole}, friction {friction}");
        }
    }
}

#[test]
fn a_tachometer_with_the_wrong_sign_is_named() {
    let found = fitted(&model(""), &recording(7, Intersample::Hold, 0.0, -1.0));
    let said = found.warnings.iter().find(|one| one.contains("wrong sign")).expect("a warning");
    assert!(said.starts_with("`speed`") && said.contains("`scale = -1`"), "{said}");
    let right = fitted(&model(""), &recording(7, Intersample::Hold, 0.0, 1.0));
    assert!(!right.warnings.iter().any(|one| one.contains("wrong sign")));
}

#[test]
fn a_tachometer_in_another_unit_is_named() {
    let found = fitted(&model(""), &recording(7, Intersample::Hold, 0.0, 1000.0));
    let said = found.warnings.iter().find(|one| one.contains("times too")).expect("a warning");
    assert!(
        said.starts_with("`speed` is 1000 times too large") && said.contains("`scale = 0.001`"),
        "{said}"
    );
    let right = fitted(&model(""), &recording(7, Intersample::Hold, 0.0, 1.0));
    assert!(!right.warnings.iter().any(|one| one.contains("times too")));
}

/// A pendulum on the motor that is caught in the middle of a swing.
#[test]
fn a_swing_that_begins_in_its_middle_does_not_drag_the_parameters_away() {
    let text = model("").text.replace(
        "[channels.speed]\nrole = \"output\"\nquantity = \"speed\"",
        "[channels.angle]\nrole = \"output\"\nquantity = \"angle\"",
    );
    let model = Model::parse(&text).unwrap();
    let model = model.with_effect("gravity_unbalance", "motor", &[("torque", 1.5), ("phase", 0.0)]).unwrap();
    for begin in [[0.2, 11.0], [-1.0, 8.0], [1.2, 0.0]] {
        let [mut angle, mut speed] = begin;
        let mut random = 11;
        let (mut torque, mut measured) = (Vec::new(), Vec::new());
        for _ in 0..1500 {
            torque.push(0.0);
            measured.push(angle + 1.7e-3 * draw(&mut random));
            for _ in 0..PARTS {
                speed += STEP_S / f64::from(PARTS) * (-DAMPING * speed - 1.0 * f64::sin(angle)) / INERTIA;
                angle += STEP_S / f64::from(PARTS) * speed;
            }
        }
        let time_s = (0..torque.len()).map(|k| STEP_S * k as f64).collect();
        let channels = vec![Channel::new("torque", Unit::Nm), Channel::new("angle", Unit::Rad)];
        let data = Dataset::from_columns("swing", channels, time_s, vec![torque, measured]).unwrap();
        let mut known = model.clone();
        // Only ratios show without a torque.
        known.parameters[0].value = INERTIA;
        known.parameters[0].fixed = true;
        let found = fitted(&known, &data);
        let (_, fit) = &found.fit.channels[0];
        assert!(fit.rms < 3e-3, "from {begin:?}: {} rad left", fit.rms);
        assert!(holds(&found, "damping", DAMPING), "from {begin:?}: {:#?}", found.parameters);
    }
}
