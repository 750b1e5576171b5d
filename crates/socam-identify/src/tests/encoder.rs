//! An encoder in place of the motor's tachometer: its angle is rounded to counts, and so the noise of its rate is blue.

use std::f64::consts::TAU;

use socam_recording::{Channel, Dataset, Unit};

use crate::{
    Identification, Options, Problem, output_error,
    tests::{TONES, TRUTH, bench, fix, model},
};

/// A bench's recording in which the motor's angle, rounded to `counts` counts per turn, replaces its speed.
fn with_encoder(data: &Dataset, counts: f64) -> Dataset {
    let loaded = data.load(&["output_speed", "torque_in", "torque_out"]).unwrap();
    let tone = |t: f64, i: usize, (f, a): (f64, f64)| -a / (TAU * f) * (TAU * f * t + i as f64).cos();
    let angle = |t: &f64| 60.0 * t + TONES.iter().enumerate().map(|(i, own)| tone(*t, i, *own)).sum::<f64>();
    let rounded = |angle: f64| (angle * counts / TAU).round() * TAU / counts;
    let angles = loaded.time_s.iter().map(|t| rounded(angle(t))).collect();
    let mut channels = data.channels().to_vec();
    channels[0] = Channel::new("motor_angle", Unit::Rad);
    let columns = std::iter::once(angles).chain(loaded.columns.iter().map(|column| column.values().to_vec()));
    Dataset::from_columns(data.name(), channels, loaded.time_s.clone(), columns.collect()).unwrap()
}

fn fitted(data: &[Dataset], take: &str) -> Identification {
    let at = "[channels.motor_speed]";
    let mut model = model(|text| text.replace(at, &format!("{at}\n{take}")));
    fix(&mut model, &[("k2", TRUTH[1]), ("k3", TRUTH[2]), ("c3", TRUTH[5])]);
    output_error(&Problem::new(&model, data, Options { starts: 1, ..Options::default() }).unwrap()).unwrap()
}

#[test]
fn counts_of_an_encoder_are_the_noise_of_its_rate() {
    let counts = 2000.0;
    let exact = [bench(TRUTH, 4.0, 1.0, 31), bench(TRUTH, 4.0, 1.0, 32)];
    let recorded = exact.each_ref().map(|data| with_encoder(data, counts));
    let found = fitted(&recorded, "column = \"motor_angle_rad\"\ntake = \"rate\"");
    // The variance of rounding is one twelfth of a squared count. A rate is computed from samples whose squared weights add up to
    // 1.80.
    let expected = (1.80_f64 / 12.0).sqrt() * TAU / counts / 1e-3;
    let noise = found.input_noise_std[0].1;
    assert!((noise / expected - 1.0).abs() < 0.03, "{noise} {expected}");
    let truths = [("k1", TRUTH[0]), ("k4", TRUTH[3]), ("c2", TRUTH[4]), ("c4", TRUTH[6]), ("c5", TRUTH[7])];
    for (name, truth) in truths {
        let own = found.parameters.iter().find(|parameter| parameter.name == name).unwrap();
        let (value, std) = (own.value.unwrap(), own.std.unwrap());
        assert!(
            (value - truth).abs() < 3.0 * std,
            "{name}: {value} +- {std}, truth {truth}; {:?}",
            found.between
        );
    }
    for ((name, fit), level) in found.fit.channels.iter().zip([0.02, 0.01, 0.05]) {
        assert!((fit.noise_std / level - 1.0).abs() < 0.05, "{name}: {} {level}", fit.noise_std);
    }
}
