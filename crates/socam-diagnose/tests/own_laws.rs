//! Candidates of a model file, and a curve that becomes a law of the corrected one, on a carriage that this file integrates by Euler steps.

use socam_diagnose::{HeldOut, Options, diagnose};
use socam_model::Model;
use socam_recording::{Channel, Dataset, Unit};

const MODEL: &str = r#"
schema = "socam.model/1"
name = "axis"
motion = "translation"

[parameters]
mass = { value = 10, unit = "kg", bounds = [1, 100] }
viscous = { value = 20, unit = "N s/m", bounds = [0, 1000] }
share = { value = 0.1, unit = "1", bounds = [0, 2], prior = { value = 0.3, std = 0.3 } }
width = { value = 1e-3, unit = "m/s", fixed = true }

[[nodes]]
name = "carriage"
inertia = "mass"

[[bearings]]
name = "guide"
at = "carriage"
damping = "viscous"

[[laws]]
name = "clamped"
at = "guide"
formula = "-share*clamp*tanh(speed/width)"
candidate = true

[channels.force]
role = "input"
quantity = "force"
at = "carriage"
[channels.clamp]
role = "input"
quantity = "signal"
at = "carriage"
column = "clamp_N"
[channels.speed]
role = "output"
quantity = "speed"
at = "carriage"
"#;

/// 2 s of a carriage of 12 kg and 25 N s/m with a force `brake` (speed, clamp force); `pace` shifts the frequencies of the drive.
fn recording(name: &str, pace: f64, brake: impl Fn(f64, f64) -> f64) -> Dataset {
    let (mut speed, mut noise) = (0.0_f64, 1_u64);
    let mut time_s = Vec::new();
    let mut columns = vec![Vec::new(), Vec::new(), Vec::new()];
    let force = |t: f64| 30.0 * ((9.0 + pace) * t).sin() + 20.0 * ((23.0 - pace) * t).sin();
    let clamp = |t: f64| 15.0 + 12.0 * ((2.3 + pace) * t).sin();
    for k in 0..400 {
        let t = 5e-3 * f64::from(k);
        noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        time_s.push(t);
        let read = speed + 2e-3 * ((noise >> 11) as f64 / 2f64.powi(53) - 0.5);
        columns.iter_mut().zip([force(t), clamp(t), read]).for_each(|(column, value)| column.push(value));
        for part in 0..100 {
            let t = t + 5e-5 * f64::from(part);
            speed += 5e-5 * (force(t) - 25.0 * speed + brake(speed, clamp(t))) / 12.0;
        }
    }
    let channels = vec![
        Channel::new("force", Unit::N),
        Channel::new("clamp", Unit::N),
        Channel::new("speed", Unit::MPerS),
    ];
    Dataset::from_columns(name, channels, time_s, columns).unwrap()
}

fn recordings(brake: impl Fn(f64, f64) -> f64 + Copy) -> [Dataset; 4] {
    [("a", 0.0), ("b", 1.5), ("c", 3.0), ("d", 2.0)].map(|(name, pace)| recording(name, pace, brake))
}

#[test]
fn a_candidate_of_the_file_is_found_by_its_name() {
    let model = Model::parse(MODEL).unwrap();
    let all = recordings(|speed, clamp| -0.3 * clamp * (speed / 1e-3).tanh());
    let (training, held_out) = all.split_at(3);
    let options = Options { most_effects: 1, ..Options::default() };
    let answer = diagnose(&model, training, HeldOut::in_memory(held_out), &options).unwrap();
    let found = &answer.diagnosis.findings[0];
    assert_eq!((found.effect.as_str(), found.location.as_str()), ("clamped", "guide"), "{found:?}");
    let share = found.parameters.iter().find(|own| own.name == "share").unwrap();
    assert!((share.value.unwrap() - 0.3).abs() < 0.02, "{share:?}");
    let corrected = Model::parse(&answer.model_toml).unwrap();
    let index = corrected.parameter("guide_clamped_share").unwrap();
    assert!((corrected.parameters[index].value - 0.3).abs() < 0.02);
    assert!(corrected.parameters[corrected.parameter("guide_clamped_width").unwrap()].fixed);
}

#[test]
fn a_curve_without_a_name_becomes_a_law_of_the_corrected_file() {
    let text =
        MODEL.replace("candidate = true\n", "").replace("-share*clamp*tanh(speed/width)", "0*share*clamp");
    let model = Model::parse(&text).unwrap();
    // Two humps of drag that no law of the catalogue has.
    let hump = |speed: f64| 12.0 * (-((speed.abs() - 0.25) / 0.07).powi(2)).exp();
    let all = recordings(move |speed, _| -hump(speed) * (speed / 0.02).tanh());
    let (training, held_out) = all.split_at(3);
    let answer = diagnose(&model, training, HeldOut::in_memory(held_out), &Options::default()).unwrap();
    let found = answer.diagnosis.findings.iter().find(|finding| finding.curve.is_some());
    let found = found.unwrap_or_else(|| panic!("{:?}", answer.diagnosis.findings));
    assert!(found.sentence.contains("corrected model file holds it as a law"), "{}", found.sentence);
    let corrected = Model::parse(&answer.model_toml).unwrap();
    let law = corrected.effects.iter().find(|used| used.effect.id == "unexplained").unwrap();
    assert_eq!(law.place, found.location);
    assert!(law.parameters.len() >= 8, "{}", law.parameters.len());
    assert!(answer.model_toml.contains("source = \"diagnosis\""));
}
