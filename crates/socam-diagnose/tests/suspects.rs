//! What a fit says of effects that its model leaves out, on a motor with dry friction that this file integrates by small Euler steps.

use socam_diagnose::suspects;
use socam_identify::{Identification, Options, Problem, output_error};
use socam_model::Model;
use socam_recording::{Channel, Dataset, Unit};

const STEP_S: f64 = 5e-3;
const PARTS: u32 = 100;
const TRUTH: [f64; 2] = [0.01, 0.02];

fn model() -> Model {
    Model::parse(
        r#"
schema = "socam.model/1"
name = "motor"
motion = "rotation"
[parameters]
inertia = { value = 0.02, unit = "kg m2", bounds = [1e-4, 1] }
damping = { value = 0.05, unit = "N m s/rad", bounds = [0, 10] }
[[nodes]]
name = "motor"
inertia = "inertia"
[[bearings]]
name = "bearing"
at = "motor"
damping = "damping"
[channels.torque]
role = "input"
quantity = "torque"
at = "motor"
[channels.speed]
role = "output"
quantity = "speed"
at = "motor"
"#,
    )
    .unwrap()
}

/// A motor whose torque is held; the tachometer has a noise of 0.02 rad/s.
fn recording(seed: u64, friction: f64) -> Dataset {
    let mut state = seed;
    let mut draw = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    let levels: Vec<f64> = (0..100).map(|_| 2.0 * draw()).collect();
    let torque: Vec<f64> = (0..2000).map(|k| levels[k / 20]).collect();
    let mut speed = 0.0_f64;
    let mut measured = Vec::new();
    for torque in &torque {
        measured.push(speed + 0.034 * draw());
        for _ in 0..PARTS {
            let rubbing = friction * (speed / 1e-3).tanh();
            speed += STEP_S / f64::from(PARTS) * (torque - TRUTH[1] * speed - rubbing) / TRUTH[0];
        }
    }
    let time_s = (0..torque.len()).map(|k| STEP_S * k as f64).collect();
    let channels = vec![Channel::new("torque", Unit::Nm), Channel::new("speed", Unit::RadPerS)];
    Dataset::from_columns(format!("run {seed}"), channels, time_s, vec![torque, measured]).unwrap()
}

fn fitted(data: &[Dataset]) -> Identification {
    output_error(&Problem::new(&model(), data, Options::default()).unwrap()).unwrap()
}

/// Whether the interval of a parameter holds its true value; `None` without an interval.
fn holds(found: &Identification, index: usize) -> Option<bool> {
    let [low, high] = found.parameters[index].ci95;
    Some((low?..=high?).contains(&TRUTH[index]))
}

#[test]
fn intervals_hold_what_missing_friction_does_to_the_damping() {
    for seed in 1..4 {
        let data = [recording(seed, 0.2)];
        let mut found = fitted(&data);
        assert_eq!(holds(&found, 1), Some(false), "without the allowance: {:?}", found.parameters);
        let suspected = suspects(&model(), &data, &found, &Options::default()).unwrap();
        let friction = suspected.iter().find(|one| one.effect == "coulomb_friction").expect("suspected");
        let (_, damping) = friction.moves.iter().find(|(name, _)| name == "damping").unwrap();
        let error = damping.to - TRUTH[1];
        assert!(error.abs() < 0.35 * (damping.to - damping.from).abs(), "{damping:?}, off by {error}");
        found.allow_for(&model(), suspected);
        assert_ne!(holds(&found, 0), Some(false), "{:?}", found.parameters);
        assert_ne!(holds(&found, 1), Some(false), "{:?}", found.parameters);
        assert!(found.warnings.last().unwrap().contains("looks most like"), "{:?}", found.warnings);
    }
}

#[test]
fn a_complete_model_is_not_suspected() {
    let data = [recording(7, 0.0)];
    let suspected = suspects(&model(), &data, &fitted(&data), &Options::default()).unwrap();
    assert!(suspected.is_empty(), "{suspected:?}");
}
