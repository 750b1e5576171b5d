//! The model files of docs/machines.md: each loads, is simulated, and is identified from that simulation.

use socam_identify::{Options, Problem, output_error};
use socam_model::{Model, Quantity};
use socam_recording::{Channel, Dataset};
use socam_sim::{Replay, Start, Truth};

const DOCUMENT: &str = include_str!("../../docs/machines.md");
const STEP_S: f64 = 1e-3;
const ROWS: usize = 4000;

/// Uniform in -1..1, by a congruential generator.
fn draw(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// Size of an input, SI: what moves each machine by its usual speeds and angles.
fn size(model: &str, quantity: Quantity) -> f64 {
    match (model, quantity) {
        ("two-motors", _) => 2.0,
        ("wrist", _) => 0.05,
        ("belt", _) => 1.0,
        ("link", _) => 9.0,
        (_, Quantity::Voltage) => 12.0,
        (_, Quantity::Reference) => 0.5,
        (name, quantity) => panic!("no size of {quantity:?} for {name}"),
    }
}

/// A sum of slow and fast parts, piecewise linear as the model takes it.
fn waveform(seed: u64, size: f64) -> Vec<f64> {
    let mut random = seed;
    let (mut slow, mut fast) = (0.0, 0.0);
    let rows = (0..ROWS).map(|_| {
        slow = 0.99 * slow + 0.08 * draw(&mut random);
        fast = 0.5 * fast + 0.5 * draw(&mut random);
        size * (slow + fast)
    });
    rows.collect()
}

/// The model's channels, driven from rest, with noise of a thousandth of their standard deviation.
fn recording(model: &Model, seed: u64) -> Dataset {
    let column = |name: &str| Channel::from_column_name(name).unwrap();
    let inputs: Vec<_> = model.inputs().filter(|input| !input.quantity.is_clock()).collect();
    let time_s: Vec<f64> = (0..ROWS).map(|k| k as f64 * STEP_S).collect();
    let columns = inputs.iter().map(|input| column(&input.column)).collect();
    let waveforms =
        inputs.iter().zip(1..).map(|(input, n)| waveform(7 * seed + n, size(&model.name, input.quantity)));
    let driven = Dataset::from_columns("inputs", columns, time_s, waveforms.collect()).unwrap();
    let truth = Truth::new(model, &[], &[]).unwrap();
    let replayed = Replay { truth, disturbances: Vec::new(), start: Start::Rest }.run(&driven).unwrap();
    let mut random = seed;
    let mut values = replayed.values;
    for output in values.iter_mut().skip(inputs.len()) {
        let mean = output.iter().sum::<f64>() / ROWS as f64;
        let std = (output.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / ROWS as f64).sqrt();
        for value in output {
            let normal = (0..12).map(|_| draw(&mut random)).sum::<f64>() / 2.0;
            *value += 1e-3 * std * normal;
        }
    }
    Dataset::from_columns(format!("run {seed}"), replayed.columns, replayed.time_s, values).unwrap()
}

fn blocks() -> impl Iterator<Item = &'static str> {
    DOCUMENT.split("```toml\n").skip(1).map(|rest| rest.split("```").next().unwrap())
}

fn identify(text: &str) {
    let model = Model::parse(text).unwrap();
    assert_eq!(model.warnings(), Vec::<String>::new(), "{}", model.name);
    let data = [recording(&model, 1)];
    let mut guess = model.clone();
    guess.parameters.iter_mut().filter(|own| !own.fixed).for_each(|own| own.value *= 1.25);
    // A link that turns over has minima where it has turned less often: the usual number of starts is for these.
    let found = output_error(&Problem::new(&guess, &data, Options::default()).unwrap()).unwrap();
    for (own, estimate) in model.parameters.iter().zip(&found.parameters).filter(|(own, _)| !own.fixed) {
        assert_eq!(own.name, estimate.name);
        let what = format!("{}: {} is {}, found {estimate:?}", model.name, own.name, own.value);
        let [Some(low), Some(high)] = estimate.ci95 else { panic!("{what}") };
        let off = (2.0 * own.value - low - high).abs() / (high - low);
        assert!(off < 2.0, "{what}");
        assert!(high - low < 0.2 * own.value, "{what}");
    }
}

#[test]
fn every_machine_of_the_document_is_simulated_and_identified() {
    let names: Vec<String> = blocks().map(|text| Model::parse(text).unwrap().name).collect();
    assert_eq!(names, ["two-motors", "wrist", "belt", "link", "voltage", "servo"]);
    blocks().for_each(identify);
}
