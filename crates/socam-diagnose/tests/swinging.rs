//! A joint that swings under gravity and turns over, integrated by Euler steps: a free run from values that are nearly right ends turns away.

use socam_diagnose::{HeldOut, Options, diagnose};
use socam_model::Model;
use socam_recording::{Channel, Dataset, Unit};

const MODEL: &str = r#"
schema = "socam.model/1"
name = "elbow"
motion = "rotation"

[parameters]
inertia = { value = 0.058, unit = "kg m2", bounds = [0.0006, 5.8] }
damping = { value = 0.05, unit = "N m s/rad", bounds = [0, 5.8] }
weight = { value = 2.8, unit = "N m", bounds = [0, 280] }
weight_phase = { value = 0, unit = "rad" }
a = { value = 0.3, unit = "N m", bounds = [0, 5] }
b = { value = 0.2, unit = "rad/s", bounds = [0.005, 5] }
c = { value = 0.1, unit = "1", bounds = [0, 2] }
e = { value = 0.02, unit = "rad/s", bounds = [0.002, 5] }

[[nodes]]
name = "elbow"
inertia = "inertia"

[[bearings]]
name = "bearing"
at = "elbow"
damping = "damping"

[[effects]]
effect = "gravity_unbalance"
at = "elbow"
parameters = { torque = "weight", phase = "weight_phase" }

[[laws]]
name = "load_friction"
at = "bearing"
formula = "-a*tanh(speed/b) - c*load*tanh(speed/e)"
candidate = true

[channels.torque]
role = "input"
quantity = "torque"
at = "elbow"
[channels.load]
role = "input"
quantity = "signal"
at = "elbow"
column = "load_Nm"
[channels.angle]
role = "output"
quantity = "angle"
at = "elbow"
[channels.speed]
role = "output"
quantity = "speed"
at = "elbow"
"#;

/// 0.078 kg m2, 0.06 N m s/rad and 2.825 N m, with a = 0.35, b = 0.25, c = 0.22 and e = 0.02; `pace` shifts frequencies and phases.
fn recording(name: &str, pace: f64) -> Dataset {
    const SAMPLE_S: f64 = 2e-3;
    const PARTS: u32 = 40;
    let torque = |t: f64| -> f64 {
        let tones = [(0.25, 1.6), (0.6, 1.2), (1.1, 0.9), (1.9, 0.7), (3.1, 0.5), (4.7, 0.4)];
        let of = |(k, (hz, size)): (usize, (f64, f64))| {
            size * (std::f64::consts::TAU * hz * (1.0 + 0.05 * pace) * t + 1.7 * pace * (k + 1) as f64).sin()
        };
        tones.into_iter().enumerate().map(of).sum()
    };
    let load = |t: f64| 1.2 + 0.9 * (2.5 * t + pace).sin() + 0.4 * (8.2 * t).sin();
    let (mut angle, mut speed) = (0.2_f64, 0.0_f64);
    let mut state = 41 + (100.0 * pace) as u64;
    let mut noise = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / 2f64.powi(53) - 0.5
    };
    let (mut time_s, mut columns) = (Vec::new(), vec![Vec::new(); 4]);
    for k in 0..4000 {
        let start_s = SAMPLE_S * f64::from(k);
        time_s.push(start_s);
        let row = [torque(start_s), load(start_s), angle + 6e-4 * noise(), speed + 0.01 * noise()];
        columns.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
        for part in 0..PARTS {
            let step_s = SAMPLE_S / f64::from(PARTS);
            let t = start_s + step_s * f64::from(part);
            let friction = 0.35 * (speed / 0.25).tanh() + 0.22 * load(t) * (speed / 0.02).tanh();
            speed += step_s * (torque(t) - 0.06 * speed - 2.825 * angle.sin() - friction) / 0.078;
            angle += step_s * speed;
        }
    }
    let units = [("torque", Unit::Nm), ("load", Unit::Nm), ("angle", Unit::Rad), ("speed", Unit::RadPerS)];
    let channels = units.map(|(name, unit)| Channel::new(name, unit)).to_vec();
    Dataset::from_columns(name, channels, time_s, columns).unwrap()
}

#[test]
fn a_law_of_a_joint_that_turns_over_is_found_with_its_values() {
    let model = Model::parse(MODEL).unwrap();
    let training = [("a", 0.3), ("b", 1.1), ("c", 2.4)].map(|(name, pace)| recording(name, pace));
    let options = Options { most_effects: 1, ..Options::default() };
    let answer = diagnose(&model, &training, HeldOut::none(), &options).unwrap();
    let [found] = &answer.diagnosis.findings[..] else { panic!("{:?}", answer.diagnosis.findings) };
    println!("{:?}, {} CPU s", found.parameters, answer.diagnosis.cpu_s);
    assert_eq!((found.effect.as_str(), found.location.as_str()), ("load_friction", "bearing"));
    for (name, truth) in [("a", 0.35), ("b", 0.25), ("c", 0.22)] {
        let own = found.parameters.iter().find(|own| own.name == name).unwrap();
        assert!((own.value.unwrap() / truth - 1.0).abs() < 0.02, "{own:?}");
    }
}
