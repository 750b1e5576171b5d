//! A pendulum whose model lacks gravity: a free run of the model makes whole turns, but gravity holds the real arm near the bottom. The
//! inertia is known, or starts at three times the true value.

use socam_diagnose::{HeldOut, Options, diagnose};
use socam_model::Model;
use socam_recording::{Channel, Dataset, Unit};

const BASE: &str = r#"
schema = "socam.model/1"
name = "arm"
description = "A motor that swings an arm"
motion = "rotation"

[parameters]
inertia = { value = 0.007, unit = "kg m2", fixed = true, source = "drawing" }
damping = { value = 0.1, unit = "N m s/rad", bounds = [0, 10], source = "guess" }

[[nodes]]
name = "arm"
inertia = "inertia"

[[bearings]]
name = "bearing"
at = "arm"
damping = "damping"

[channels.torque]
role = "input"
quantity = "torque"
at = "arm"
[channels.angle]
role = "output"
quantity = "angle"
at = "arm"
"#;

const RATE_HZ: f64 = 200.0;
const INERTIA: f64 = 0.007;
const DAMPING: f64 = 0.03;
const GRAVITY: f64 = 0.5;

/// Torque of a recording: two sines that never repeat within it, N m.
fn torque(t: f64, seed: f64) -> f64 {
    0.35 * ((2.0 + seed) * t).sin() + 0.25 * ((5.0 - 0.7 * seed) * t + seed).sin()
}

/// One recording of 6 s: Runge-Kutta with ten steps a sample, a small Coulomb friction, and an encoder of 4096 counts.
fn record(name: &str, seed: f64) -> Dataset {
    let acceleration = |t: f64, angle: f64, speed: f64| {
        let friction = 0.004 * (speed / 0.02).tanh();
        (torque(t, seed) - DAMPING * speed - GRAVITY * angle.sin() - friction) / INERTIA
    };
    let (mut angle, mut speed) = (0.0_f64, 0.0_f64);
    let step = 0.1 / RATE_HZ;
    let count = std::f64::consts::TAU / 4096.0;
    let (mut time_s, mut torques, mut angles) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..1200 {
        let t = f64::from(k) / RATE_HZ;
        time_s.push(t);
        torques.push(torque(t, seed));
        angles.push((angle / count).round() * count);
        for part in 0..10 {
            let t = t + f64::from(part) * step;
            let (v1, a1) = (speed, acceleration(t, angle, speed));
            let (v2, a2) = {
                let v = speed + 0.5 * step * a1;
                (v, acceleration(t + 0.5 * step, angle + 0.5 * step * v1, v))
            };
            let (v3, a3) = {
                let v = speed + 0.5 * step * a2;
                (v, acceleration(t + 0.5 * step, angle + 0.5 * step * v2, v))
            };
            let (v4, a4) = {
                let v = speed + step * a3;
                (v, acceleration(t + step, angle + step * v3, v))
            };
            angle += step * (v1 + 2.0 * v2 + 2.0 * v3 + v4) / 6.0;
            speed += step * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0;
        }
    }
    let channels = vec![Channel::new("torque", Unit::Nm), Channel::new("angle", Unit::Rad)];
    Dataset::from_columns(name, channels, time_s, vec![torques, angles]).unwrap()
}

/// The diagnosis of a base model finds gravity at the arm, and the inertia within a twentieth.
fn assert_gravity_is_found(model: &Model) {
    let training = [record("a", 0.3), record("b", 1.1), record("c", 1.9)];
    let held_out = HeldOut::in_memory(&[record("d", 1.5)]);
    let options = Options { most_effects: 2, ..Options::default() };
    let answer = diagnose(model, &training, held_out, &options).unwrap().diagnosis;
    let first = &answer.findings[0];
    assert_eq!((first.effect.as_str(), first.location.as_str()), ("gravity_unbalance", "arm"));
    let torque = first.parameters.iter().find(|own| own.name == "torque").unwrap();
    assert!((torque.value.unwrap() - GRAVITY).abs() < 0.02 * GRAVITY, "{torque:?}");
    // A phase is determined although it is zero.
    let phase = first.parameters.iter().find(|own| own.name == "phase").unwrap();
    assert!(phase.value.unwrap().abs() < 0.05, "{phase:?}");
    let angle = &answer.fit.channels[0].1;
    assert!(angle.holdout_rms_after.unwrap() < 0.05 * angle.holdout_rms_before.unwrap());
}

#[test]
fn gravity_is_found_where_a_free_run_misses_by_turns() {
    assert_gravity_is_found(&Model::parse(BASE).unwrap());
}

#[test]
fn gravity_is_found_where_the_inertia_is_unknown_too() {
    let unknown = BASE.replace(
        r#"inertia = { value = 0.007, unit = "kg m2", fixed = true, source = "drawing" }"#,
        r#"inertia = { value = 0.021, unit = "kg m2", bounds = [1e-5, 1], source = "guess" }"#,
    );
    assert_ne!(unknown, BASE);
    assert_gravity_is_found(&Model::parse(&unknown).unwrap());
}
