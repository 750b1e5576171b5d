//! A motor on a bearing, integrated here by small Euler steps.

use socam_model::Model;
use socam_recording::{Channel, Dataset, Unit};

const STEP_S: f64 = 5e-3;
const PARTS: u32 = 100;
/// Inertia and damping.
pub(crate) const TRUTH: [f64; 2] = [0.01, 0.02];

/// The model of a motor whose times, speeds and torques are these times as large.
pub(crate) fn sized([time, speed, torque]: [f64; 3]) -> Model {
    let (inertia, damping) = (torque * time / speed, torque / speed);
    let text = format!(
        r#"
schema = "socam.model/1"
name = "motor"
motion = "rotation"
[parameters]
inertia = {{ value = {:e}, unit = "kg m2", bounds = [{:e}, {:e}] }}
damping = {{ value = {:e}, unit = "N m s/rad", bounds = [0, {:e}] }}
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
        0.02 * inertia,
        1e-4 * inertia,
        inertia,
        0.05 * damping,
        10.0 * damping,
    );
    Model::parse(&text).unwrap()
}

/// A motor whose torque is held; the tachometer has a noise of 0.02 rad/s.
pub(crate) fn recording(seed: u64, friction: f64) -> Dataset {
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
