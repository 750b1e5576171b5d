//! Simulates every effect of the catalogue in motion. The fast predictor and the simulator's solver, which have only the equations
//! in common, must agree, and the effect must be visible.

use socam_identify::{Intersample, Predictor, Start};
use socam_model::{Model, Quantity, effects};
use socam_sim::Plant;

const STEP_S: f64 = 1e-3;
const ROWS: usize = 1200;

/// Speed of the driven shaft, rad/s: it reverses through standstill and has components up to 30 Hz.
fn speed(time_s: f64) -> f64 {
    let wave =
        |amplitude: f64, frequency_hz: f64| amplitude * (std::f64::consts::TAU * frequency_hz * time_s).sin();
    (wave(60.0, 1.3) + wave(15.0, 7.7) + wave(4.0, 23.0)) * (time_s / 0.1).min(1.0)
}

/// Inputs of the model, sample by sample: the driven quantity, and its clocks.
fn inputs(model: &Model) -> Vec<Vec<f64>> {
    let time = |k: usize| k as f64 * STEP_S;
    let turned = (0..ROWS).scan(0.0, |angle, k| {
        *angle += if k == 0 { 0.0 } else { 0.5 * STEP_S * (speed(time(k - 1)) + speed(time(k))) };
        Some(*angle)
    });
    let turned: Vec<f64> = turned.collect();
    let of = |quantity: Quantity| match quantity {
        Quantity::Time => (0..ROWS).map(time).collect(),
        Quantity::Turned => turned.clone(),
        Quantity::Change => {
            (0..ROWS).map(|k| (speed(time(k) + 1e-6) - speed(time(k) - 1e-6)) / 2e-6).collect()
        }
        _ => (0..ROWS).map(|k| speed(time(k))).collect::<Vec<f64>>(),
    };
    model.inputs().map(|input| of(input.quantity)).collect()
}

fn predicted(model: &Model) -> Vec<Vec<f64>> {
    let inputs = inputs(model);
    let slices: Vec<&[f64]> = inputs.iter().map(Vec::as_slice).collect();
    let predictor = Predictor::new(model, &model.values(), STEP_S).unwrap();
    let still = vec![0.0; predictor.states()];
    predictor.run(&slices, &vec![Intersample::Linear; slices.len()], Start::State(&still)).unwrap().outputs
}

fn simulated(model: &Model) -> Vec<Vec<f64>> {
    let inputs = inputs(model);
    let plant = Plant::new(model, &model.values()).unwrap();
    let mut trajectory = plant.start().unwrap();
    let at = |k: usize| inputs.iter().map(|input| input[k]).collect::<Vec<f64>>();
    trajectory.set_input(&at(0));
    let mut values = vec![0.0; model.outputs().count()];
    let mut outputs = vec![Vec::new(); values.len()];
    for k in 0..ROWS {
        if k > 0 {
            trajectory.ramp(k as f64 * STEP_S, &at(k)).unwrap();
        }
        trajectory.outputs(&mut values);
        outputs.iter_mut().zip(&values).for_each(|(output, value)| output.push(*value));
    }
    outputs
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value * value, count + 1.0));
    f64::sqrt(sum / f64::max(count, 1.0))
}

/// Effect, place, parameters.
type Case = (&'static str, &'static str, &'static [(&'static str, f64)]);

#[test]
fn both_numerics_agree_on_every_effect() {
    let cases: &[Case] = &[
        ("coulomb_friction", "load_bearing", &[("torque", 0.4)]),
        ("coulomb_friction", "cam_bearing", &[("torque", 0.05)]),
        (
            "stribeck_friction",
            "load_bearing",
            &[("torque", 0.3), ("static_torque", 0.6), ("stribeck_speed", 0.8)],
        ),
        ("quadratic_drag", "load_bearing", &[("coefficient", 0.01)]),
        ("damping_drift", "load_bearing", &[("rate", 0.1)]),
        ("direction_dependence", "load_bearing", &[("torque_difference", 0.3), ("damping_difference", 0.02)]),
        ("velocity_weakening", "load_bearing", &[("torque", 0.3), ("fall_speed", 2.0)]),
        ("constant_load", "load", &[("torque", 0.5)]),
        ("mesh_loss", "mesh", &[("fraction", 0.1)]),
        ("mesh_loss", "mesh", &[("fraction", 0.1), ("back_fraction", 0.4)]),
        ("mesh_loss", "mesh", &[("fraction", 0.2), ("deflection", 0.01)]),
        ("backlash", "mesh", &[("gap", 5e-3)]),
        ("kinematic_error", "mesh", &[("order", 1.0), ("amplitude", 1e-3), ("phase", 0.5)]),
        ("stiffness_hardening", "coupling_3", &[("cubic", 60.0)]),
        ("stiffness_hardening", "coupling_1", &[("cubic", 300.0)]),
        ("hysteresis", "coupling_3", &[("torque", 0.3), ("deflection", 0.01)]),
        ("missing_compliance", "load_shaft", &[("stiffness", 300.0), ("damping", 0.05)]),
        ("missing_inertia", "load", &[("inertia", 3e-3)]),
        ("missing_inertia", "cam_shaft", &[("inertia", 3e-5)]),
        ("missing_inertia", "torque_sensor_in", &[("inertia", 2e-5)]),
        ("coupling_slip", "coupling_3", &[("torque", 3.0)]),
        ("coupling_slip", "coupling_2", &[("torque", 0.6)]),
        ("gravity_unbalance", "load", &[("torque", 0.5), ("phase", 0.4)]),
        ("external_disturbance", "load", &[("torque", 0.3), ("frequency", 17.0), ("phase", 1.0)]),
        ("sensor_gain", "torque_out", &[("gain", 0.97)]),
        ("sensor_gain", "motor_speed", &[("gain", 0.97)]),
        ("sensor_offset", "motor_speed", &[("offset", 1.0)]),
        ("sensor_offset", "torque_in", &[("offset", 0.1)]),
        ("sensor_lag", "output_speed", &[("time_constant", 3e-3)]),
        ("sensor_delay", "output_speed", &[("delay", 3e-3)]),
        ("sensor_delay", "motor_speed", &[("delay", -1e-3)]),
        ("sensor_saturation", "torque_out", &[("limit", 1.0)]),
        ("sensor_fold", "output_speed", &[("share", 1.0)]),
        ("direction_gain", "torque_out", &[("difference", 0.05)]),
        ("direction_gain", "motor_speed", &[("difference", 0.02)]),
        ("sensor_hum", "torque_in", &[("amplitude", 0.05), ("frequency", 50.0)]),
        ("sensor_ripple", "motor_speed", &[("amplitude", 0.5), ("order", 2.0)]),
        ("sensor_ripple", "output_speed", &[("amplitude", 0.1), ("order", 1.0)]),
    ];
    for effect in effects::CATALOGUE {
        // The motor's speed is prescribed here: no torque moves it. See below.
        assert!(
            ["torque_ripple", "drive_limit", "mounting_compliance"].contains(&effect.id)
                || cases.iter().any(|(id, ..)| *id == effect.id),
            "{} has no case in `both_numerics_agree_on_every_effect`; add one in tests/tests/catalogue.rs",
            effect.id
        );
    }
    let base = Model::builtin("speed-o-cam").unwrap();
    for (id, place, values) in cases {
        check(&base, id, place, values);
    }
}

#[test]
fn a_drives_torque_ends() {
    check(&Model::builtin("two-mass").unwrap(), "drive_limit", "motor_torque", &[("limit", 50.0)]);
}

#[test]
fn a_mounting_gives_way() {
    check(
        &Model::builtin("two-mass").unwrap(),
        "mounting_compliance",
        "motor",
        &[("stiffness", 3e3), ("frequency", 9.0), ("damping_ratio", 0.05)],
    );
}

#[test]
fn a_motors_torque_ripples() {
    check(
        &Model::builtin("two-mass").unwrap(),
        "torque_ripple",
        "motor",
        &[("order", 6.0), ("torque", 2.0), ("phase", 0.3)],
    );
}

fn check(base: &Model, id: &str, place: &str, values: &[(&str, f64)]) {
    let what = format!("{id} at {place}");
    let model = base.with_effect(id, place, values).unwrap();
    let plain = predicted(base);
    let fast = predicted(&model);
    let slow = simulated(&model);
    let mut shows = 0.0_f64;
    for ((fast, slow), plain) in fast.iter().zip(&slow).zip(&plain) {
        let size = rms(slow.iter().copied());
        let miss = rms(fast.iter().zip(slow).map(|(a, b)| a - b)) / size;
        shows = shows.max(rms(fast.iter().zip(plain).map(|(a, b)| a - b)) / size);
        assert!(miss < 2e-4, "{what}: the two numerics differ by {miss:.1e}");
    }
    assert!(shows > 5e-4, "{what} does not show: {shows:.1e}");
}
