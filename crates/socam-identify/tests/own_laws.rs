//! Laws of a model file in a fit, on a motor that this file integrates by small Euler steps: a brake that depends on speed and on a recorded
//! load, and a formula beside the same law of the catalogue.

use socam_identify::{Identification, Options, Problem, output_error};
use socam_model::Model;
use socam_recording::{Channel, Dataset, Unit};

const STEP_S: f64 = 5e-3;
const PARTS: u32 = 100;
const NOISE: f64 = 0.02;

fn model(parameters: &str, laws: &str) -> Model {
    Model::parse(&format!(
        r#"
schema = "socam.model/1"
name = "motor"
motion = "rotation"
[parameters]
inertia = {{ value = 0.02, unit = "kg m2", bounds = [1e-4, 1] }}
damping = {{ value = 0.05, unit = "N m s/rad", bounds = [0, 10] }}
{parameters}
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
[channels.clamp]
role = "input"
quantity = "signal"
at = "motor"
column = "clamp_N"
[channels.speed]
role = "output"
quantity = "speed"
at = "motor"
{laws}
"#
    ))
    .unwrap()
}

fn draw(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// A motor of 0.01 kg m2 and 0.02 N m s/rad with `brake` (speed, clamp force), driven by two waves of torque.
fn recording(brake: impl Fn(f64, f64) -> f64) -> Dataset {
    let (mut random, mut speed) = (7, 0.0);
    let mut columns = vec![Vec::new(), Vec::new(), Vec::new()];
    let mut time_s = Vec::new();
    let torque = |t: f64| 1.2 * (4.0 * t).sin() + 0.8 * (11.0 * t).sin();
    let clamp = |t: f64| 20.0 + 15.0 * (1.7 * t).sin();
    for row in 0..1200 {
        let t = STEP_S * f64::from(row);
        time_s.push(t);
        for (column, value) in
            columns.iter_mut().zip([torque(t), clamp(t), speed + NOISE * draw(&mut random)])
        {
            column.push(value);
        }
        for part in 0..PARTS {
            let t = t + STEP_S * f64::from(part) / f64::from(PARTS);
            speed += STEP_S / f64::from(PARTS) * (torque(t) + brake(speed, clamp(t)) - 0.02 * speed) / 0.01;
        }
    }
    let channels = vec![
        Channel::new("torque", Unit::Nm),
        Channel::new("clamp", Unit::N),
        Channel::new("speed", Unit::RadPerS),
    ];
    Dataset::from_columns("run", channels, time_s, columns).unwrap()
}

fn fitted(model: &Model, recording: &Dataset) -> Identification {
    let recordings = [recording.clone()];
    output_error(&Problem::new(model, &recordings, Options::default()).unwrap()).unwrap()
}

#[test]
fn a_brake_with_a_recorded_load_is_identified_with_intervals() {
    let brake = |speed: f64, clamp: f64| -0.15 * (speed / 2.0).tanh() - 0.01 * clamp * (speed / 2.0).tanh();
    let parameters = "a = { value = 0.05, unit = \"N m\", bounds = [0, 5] }\nb = { value = 10, unit = \"rpm\", bounds = [1, 200] }\nradius = { value = 2, unit = \"mm\", bounds = [0, 100] }";
    let laws = "[[laws]]\nname = \"brake\"\nat = \"bearing\"\nformula = \"-(a + radius*load)*tanh(speed/b)\"\ninputs = { load = \"clamp\" }";
    let model = model(parameters, laws);
    let found = fitted(&model, &recording(brake));
    for (name, truth) in [("inertia", 0.01), ("damping", 0.02), ("a", 0.15), ("b", 2.0), ("radius", 0.01)] {
        let own = found.parameters.iter().find(|own| own.name == name).unwrap();
        let [Some(low), Some(high)] = own.ci95 else { panic!("{name} has no interval") };
        let margin = 0.3 * (high - low);
        assert!(low - margin < truth && truth < high + margin, "{name}: {truth} is not in {low} .. {high}");
        assert!(high - low < 0.5 * truth, "{name}: {low} .. {high}");
    }
}

#[test]
fn a_formula_and_the_same_law_of_the_catalogue_fit_alike() {
    let friction = |speed: f64, _: f64| -0.3 * (speed / 0.05).tanh();
    let parameters = "friction = { value = 0.1, unit = \"N m\", bounds = [0, 5] }\nwidth = { value = 0.05, unit = \"rad/s\", fixed = true }";
    let own = "[[laws]]\nname = \"mine\"\nat = \"bearing\"\nformula = \"-friction*tanh(speed/width)\"";
    let of_catalogue = "[[effects]]\neffect = \"coulomb_friction\"\nat = \"bearing\"\nparameters = { torque = \"friction\", transition_speed = \"width\" }";
    let recording = recording(friction);
    let [a, b] = [own, of_catalogue].map(|laws| fitted(&model(parameters, laws), &recording));
    for (own, known) in a.parameters.iter().zip(&b.parameters) {
        assert_eq!(own.name, known.name);
        let (Some(found), Some(expected)) = (own.value, known.value) else { continue };
        assert!((found / expected - 1.0).abs() < 1e-6, "{}: {found}, {expected}", own.name);
        let [[Some(low), Some(high)], [Some(least), Some(most)]] = [own.ci95, known.ci95] else { continue };
        assert!(((high - low) / (most - least) - 1.0).abs() < 1e-3, "{}", own.name);
    }
    assert!((a.point[2] / 0.3 - 1.0).abs() < 0.05, "{:?}", a.point);
}
