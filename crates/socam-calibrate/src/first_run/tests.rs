use std::f64::consts::TAU;

use super::*;

const PERIOD_S: f64 = 1e-3;

/// A motor of 3 ohm, 1 mH and 0.02 V s/rad on a staircase of 4 V: its samples, as a board with `calibration` gives them. `wiring` changes
/// angle (turns) and current before they are measured.
fn samples(calibration: &Calibration, wiring: impl Fn(f64, f64) -> (f64, f64), per_turn: f64) -> Vec<Sample> {
    let (mut rad_s, mut amperes, mut turns, mut last_turn) = (0.0f64, 0.0f64, 0.0f64, 0i64);
    let levels = [-4.0, -1.5, 1.5, 4.0];
    let sample = |row: usize| {
        let volts = levels[row / 500];
        for _ in 0..100 {
            amperes += (volts - 3.0 * amperes - 0.02 * rad_s) / 1e-3 * 1e-5;
            rad_s += (0.02 * amperes - 1e-3 * (rad_s / 0.1).tanh()) / 5e-6 * 1e-5;
            turns += rad_s / TAU * 1e-5;
        }
        let (turns, measured) = wiring(turns, amperes);
        let passed = turns.floor() as i64 != std::mem::replace(&mut last_turn, turns.floor() as i64);
        let sensor = |channel: GearmotorChannel, value: f64| {
            let sensor = calibration.channels[channel.index()].sensor;
            i32::from(calibration.input.count(sensor.volts(value)))
        };
        let mut counts = [0; 8];
        counts[0] = (turns * per_turn * 16.0).round() as i32;
        counts[2] = (turns / 30.0 * 2400.0 * 16.0).round() as i32;
        counts[4] = sensor(GearmotorChannel::MotorCurrent, measured);
        counts[6] = sensor(GearmotorChannel::SupplyVoltage, 12.0);
        counts[7] = sensor(GearmotorChannel::MotorVoltage, volts);
        let [index, _] = Flags::INPUTS;
        let flags = Flags::new(State::Running).with(index, passed && row > 0);
        Sample {
            tick: row as u32,
            seq: row as u32,
            counts,
            segment: (row / 500) as u16,
            flags,
            ..Sample::default()
        }
    };
    (0..2000).map(sample).collect()
}

fn start() -> Calibration {
    Calibration::parse(Calibration::gearmotor_text()).unwrap()
}

#[test]
fn swapped_wires_counts_and_winding_are_found_and_written() {
    let samples = samples(&start(), |turns, amperes| (-turns, 0.02 - amperes), 48.0);
    let found = FirstRun::of(&samples, PERIOD_S, &start(), Told::default()).unwrap();
    assert_eq!((found.counts_per_turn, found.by_index, found.current_is_reversed), (-48.0, true, true));
    assert_eq!(found.output_counts_per_turn, Some(-2400.0));
    assert!((found.ratio.unwrap() - 30.0).abs() < 0.05, "{:?}", found.ratio);
    for (measured, truth) in
        [(found.resistance_ohm, 3.0), (found.back_emf_v_s, 0.02), (found.current_offset_a, 0.02)]
    {
        assert!(
            (measured.value - truth).abs() < 0.03 * truth.abs().max(0.02),
            "{measured:?} instead of {truth}"
        );
    }
    let text = found.edit(Calibration::gearmotor_text()).unwrap();
    let written = Calibration::parse(&text).unwrap();
    assert!(text.contains("# 10 kOhm and 2 kOhm"), "{text}");
    // Read with what was written, the same samples have the right signs.
    let last = &samples[samples.len() - 1];
    let values: Vec<f64> = written.values(0, &last.counts).collect();
    let before: Vec<f64> = written.values(0, &samples[samples.len() - 100].counts).collect();
    assert!(values[1] > before[1] && values[3] > before[3], "{values:?}");
    assert!((values[5] - 0.05).abs() < 0.01, "{values:?}");
    assert!((written.winding.unwrap().resistance_ohm - 3.0).abs() < 0.1);
    assert!(
        written.motor.offset_rpm < 0.0 && (written.motor.rpm_per_volt - 477.0).abs() < 10.0,
        "{:?}",
        written.motor
    );
}

#[test]
fn what_is_missing_is_named() {
    let calibration = start();
    let found = |samples: &[Sample], told| FirstRun::of(samples, PERIOD_S, &calibration, told);
    let problem = |samples: &[Sample]| found(samples, Told::default()).unwrap_err().to_string();
    let whole = samples(&calibration, |turns, amperes| (turns, amperes), 64.0);
    assert!(problem(&whole[..100]).contains("has 100 samples"));
    assert!(
        problem(&samples(&calibration, |_, amperes| (0.0, amperes), 64.0)).contains("counted 0 while 4.0 V")
    );
    let one_track = samples(&calibration, |turns, amperes| ((turns * 40.0).sin() / 10.0, amperes), 64.0);
    assert!(problem(&one_track).contains("up and down whatever the voltage"), "{}", problem(&one_track));
    let mut without_index = whole.clone();
    without_index.iter_mut().for_each(|sample| sample.flags = Flags::new(State::Running));
    assert!(problem(&without_index).contains("index was passed 0 times"));
    let told = Told { counts_per_turn: Some(64.0), output_counts_per_turn: None };
    let known = found(&without_index, told).unwrap();
    assert_eq!((known.counts_per_turn, known.by_index), (64.0, false));
    let mut no_shunt = whole.clone();
    no_shunt.iter_mut().for_each(|sample| sample.counts[4] = 16_384);
    assert!(problem(&no_shunt).contains("do not follow a winding"), "{}", problem(&no_shunt));
}
