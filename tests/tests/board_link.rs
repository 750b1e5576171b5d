//! A minute on a link that flips, drops, doubles and delays bytes: what arrives is right, and what does not is counted.

use std::collections::BTreeMap;

use serde_json::json;
use socam_recording::{Calibration, Dataset};
use socam_tests::emulator::{Emulator, bench};
use socam_tests::run;
use socam_wire::{Decoder, ToHost};

const COLUMNS: [&str; 5] =
    ["command_V", "motor_speed_rad_s", "output_speed_rad_s", "torque_in_Nm", "torque_out_Nm"];

fn from_hex(text: &str) -> Vec<u8> {
    text.as_bytes()
        .chunks_exact(2)
        .map(|pair| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap())
        .collect()
}

/// Values that the board sent while the drive was enabled, by tick, before the link damaged them.
fn said(bytes: &[u8], calibration: &Calibration) -> BTreeMap<u32, Vec<f64>> {
    let mut decoder = Decoder::<ToHost>::new();
    let mut bytes = bytes;
    let mut rows = BTreeMap::new();
    while let Some(item) = decoder.next(&mut bytes) {
        if let Ok(ToHost::Samples(batch)) = item {
            for sample in batch.samples() {
                let values = calibration.values(sample.output_count, &sample.counts[..4]).collect();
                if sample.flags.state().is_some_and(socam_core::State::is_live) {
                    rows.insert(sample.tick, values);
                }
            }
        }
    }
    rows
}

#[test]
fn a_bad_link_costs_samples_that_are_counted_and_falsifies_none() {
    let Some(mut board) = Emulator::start(bench(&[], 5)) else { return };
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("run.mcap").to_str().unwrap().to_owned();
    let _ = board.ask(&json!({ "ask": "keep" }));
    let _ = board.ask(&json!({ "ask": "damage", "toBoard": 5e-3, "toHost": 5e-3, "seed": 11 }));
    let ran = run([
        "record",
        "-o",
        &log,
        "--device",
        &board.device,
        "--profile",
        "triangle",
        "--duration",
        "12s",
        "--json",
    ]);
    assert_eq!(ran.code, Some(3), "{ran:?}");
    let report: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    let damaged = board.ask(&json!({ "ask": "damaged" }));
    println!("measured: link damage {damaged}");
    for kind in ["flipped", "dropped", "doubled", "delayed"] {
        assert!(damaged["toHost"][kind].as_u64().unwrap() > 20, "{damaged}");
    }

    let mut calibration = Calibration::default();
    calibration.input.full_scale_v = 10.24;
    let said = said(&from_hex(board.ask(&json!({ "ask": "said" })).as_str().unwrap()), &calibration);
    let data = Dataset::open(&log).unwrap();
    let (start, loaded) = (*said.keys().next().unwrap(), data.load(&COLUMNS).unwrap());
    let times = loaded.time_s;
    // The first sample of the run may be lost too: then the recording's time counts from a later one.
    let rows = times.len() as u64;
    let offset = (0..2000).find(|offset| {
        said.get(&(start + offset))
            .is_some_and(|row| row.iter().zip(&loaded.columns).all(|(a, c)| *a == c.values()[0]))
    });
    let offset = offset.expect("the first recorded sample is one that the board sent");
    let mut live = 0;
    for (row, time) in times.iter().enumerate() {
        let tick = start + offset + (time * 1e3).round() as u32;
        let Some(sent) = said.get(&tick) else { continue };
        live += 1;
        for (value, column) in sent.iter().zip(&loaded.columns) {
            assert_eq!(*value, column.values()[row], "tick {tick}");
        }
    }
    assert!(live + 2 >= rows, "{live} of {rows} rows are the board's");
    assert_eq!(report["lost"], data.lost_samples());
    let span = (times[times.len() - 1] * 1e3).round() as u64 + 1;
    assert_eq!(rows + report["lost"].as_u64().unwrap(), span);
    println!("measured: {rows} rows right, {} lost and counted", report["lost"]);
}
