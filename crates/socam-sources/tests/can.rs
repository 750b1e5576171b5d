//! A CAN bus behind a simulated adapter: what is recorded of it, and when.

#![cfg(feature = "can")]

use std::sync::Arc;

use proptest::prelude::*;
use socam_import::CanSignals;
use socam_sources::can::{Access, CanBus, opening, survey};
use socam_sources::simulators::SlcanSimulator;
use socam_sources::{Chunk, Device, Heard, Numbering, Row};

const DBC: &str = "VERSION \"\"\n\nBU_: A\n\nBO_ 257 Motor: 4 A\n SG_ motor_speed : 0|16@1- (0.01,0) [0|0] \"rad/s\" A\n \
    SG_ state : 16|8@1+ (1,0) [0|0] \"\" A\n\nBO_ 258 Load: 2 A\n SG_ torque : 7|16@0- (0.001,0) [0|0] \"Nm\" A\n SG_ mood : 8|8@1+ (1,0) [0|0] \"furlong\" A\n\n\
    BO_ 259 Slow: 1 A\n SG_ temperature : 0|8@1+ (1,-40) [0|0] \"degC\" A\n";

fn signals() -> Arc<CanSignals> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bus.dbc");
    std::fs::write(&path, DBC).unwrap();
    Arc::new(CanSignals::open(&path).unwrap())
}

/// Bytes of a bus for some seconds, in reads of one ms: speed at 500 Hz, torque at 400 Hz, temperature at 10 Hz, and a frame of a stranger.
fn bus(adapter: &mut SlcanSimulator, from_ms: u64, until_ms: u64) -> Vec<(Vec<u8>, i64)> {
    let mut reads = Vec::new();
    for half_ms in 2 * from_ms..2 * until_ms {
        let time_s = half_ms as f64 * 5e-4;
        let mut bytes = Vec::new();
        if half_ms % 4 == 0 {
            let speed = (time_s * 400.0) as i16;
            bytes.extend(adapter.frame(time_s, 257, &[speed.to_le_bytes()[0], speed.to_le_bytes()[1], 3, 0]));
        }
        if half_ms % 5 == 0 {
            bytes.extend(adapter.frame(time_s, 258, &((time_s * 400.0) as i16).to_be_bytes()));
        }
        if half_ms % 200 == 50 {
            bytes.extend(adapter.frame(time_s, 259, &[60]));
        }
        if half_ms % 1000 == 1 {
            bytes.extend(adapter.frame(time_s, 0x7ff, &[1]));
        }
        if !bytes.is_empty() {
            reads.push((bytes, (time_s * 1e9) as i64 + 300_000));
        }
    }
    reads
}

fn chunk((bytes, until_ns): &(Vec<u8>, i64)) -> Chunk<'_> {
    Chunk { bytes, from_ns: *until_ns, until_ns: *until_ns }
}

fn rows(heard: &[Heard]) -> Vec<&Row> {
    heard.iter().filter_map(|heard| if let Heard::Row(row) = heard { Some(row) } else { None }).collect()
}

fn record(has_stamps: bool) -> (CanBus, Vec<Heard>, Vec<String>, SlcanSimulator) {
    let mut adapter = SlcanSimulator::new(has_stamps);
    let opening = opening(Some(500_000), Access::Listen).unwrap();
    adapter.receive(&opening);
    let first = bus(&mut adapter, 0, 1500);
    let found = survey(&first.iter().map(chunk).collect::<Vec<_>>(), signals()).unwrap();
    let notes = found.notes.clone();
    let mut device = CanBus::new(found, opening);
    let mut heard = Vec::new();
    first.iter().for_each(|read| device.receive(chunk(read), &mut heard));
    for ms in 1500..70_000 {
        if ms == 2000 {
            adapter.flags = 8;
        }
        for read in bus(&mut adapter, ms, ms + 1) {
            device.receive(chunk(&read), &mut heard);
        }
        let mut out = Vec::new();
        device.poll(ms as i64 * 1_000_000, &mut out).unwrap();
        let answer = adapter.receive(&out);
        device.receive(chunk(&(answer, ms as i64 * 1_000_000 + 400_000)), &mut heard);
    }
    (device, heard, notes, adapter)
}

#[test]
fn frames_of_several_rates_become_rows_of_the_fastest() {
    for has_stamps in [true, false] {
        let (device, heard, notes, adapter) = record(has_stamps);
        let names: Vec<String> =
            device.channels().iter().map(socam_recording::Channel::column_name).collect();
        assert_eq!(names, ["motor_speed_rad_s", "state_1", "torque_Nm", "temperature_K"]);
        assert_eq!(device.numbering(), if has_stamps { Numbering::Clock } else { Numbering::Arrival });
        let rows = rows(&heard);
        // All of 70 s but those that wait for frames behind them.
        assert!((34_980..=35_000).contains(&rows.len()), "{}", rows.len());
        let mut warm = 0;
        for row in &rows[10..] {
            let time_s = row.device_s.unwrap_or((row.arrival_ns - 300_000) as f64 * 1e-9);
            // Both rise evenly; numbers are whole, and time stamps have 1 ms.
            assert!(
                (row.values[0] - 4.0 * time_s).abs() < 0.02 && row.values[1] == 3.0,
                "{has_stamps} {time_s} {row:?}"
            );
            assert!((row.values[2] - 0.4 * time_s).abs() < 0.003, "{has_stamps} {time_s} {row:?}");
            warm += usize::from((row.values[3] - 293.15).abs() < 1e-9);
        }
        assert!((690..=700).contains(&warm), "{warm}");
        assert!(
            notes.iter().any(|note| note.contains("7FF (3 times)"))
                && notes.iter().any(|note| note.contains("`mood` (furlong)"))
        );
        assert!(heard.contains(&Heard::Fault("the adapter reports: frames were lost (data overrun)".into())));
        assert!(!heard.iter().any(|heard| matches!(heard, Heard::Damaged(_))));
        // It was opened to listen, and got nothing but its settings and questions for flags.
        let mut commands = adapter.commands.clone();
        commands.retain(|command| command != "F");
        assert_eq!(commands, ["", "C", "S6", "Z1", "L"]);
    }
}

#[test]
fn a_bus_without_known_frames_is_refused_by_its_reason() {
    let refused = |bytes: &[u8]| {
        let chunk = Chunk { bytes, from_ns: 0, until_ns: 1_000_000 };
        survey(&[chunk], signals()).err().unwrap().to_string()
    };
    assert!(
        refused(b"t2221FF\rt2221FF\rt3331FF\r")
            .contains("none of the 3 frames that arrived is in the DBC, but 222 (2 times), 333 (1 times)")
    );
    assert!(refused(b"\r\r\x07").contains("the adapter answers, and no frame arrives"));
    assert!(refused(b"").contains("the adapter says nothing"));
    assert!(refused(b"motor 5\r\nhello\r\n").contains("what arrives is not slcan"));
    assert!(opening(Some(123), Access::Listen).unwrap_err().contains("no bit rate of 123"));
}

#[test]
fn a_dead_bus_ends_the_recording_though_its_adapter_answers() {
    let (mut device, ..) = record(true);
    let poll = |device: &mut CanBus, s: i64| device.poll(s * 1_000_000_000, &mut Vec::new());
    assert!(poll(&mut device, 75).is_ok());
    assert!(
        poll(&mut device, 81).unwrap_err().to_string().contains("no frame of the DBC has arrived for 10 s")
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn any_bytes_of_an_adapter_are_survived(bytes in proptest::collection::vec(any::<u8>(), 0..200), text in "[tTrRdDbBF0-9A-F\r]{0,100}") {
        let known = b"t101400010203\rt102212AB\r".to_vec();
        for bytes in [bytes, text.into_bytes()] {
            let all = [known.clone(), bytes].concat();
            let chunk = Chunk { bytes: &all, from_ns: 0, until_ns: 1_000_000_000 };
            let found = survey(&[chunk], signals()).unwrap();
            let mut device = CanBus::new(found, opening(Some(500_000), Access::Listen).unwrap());
            let mut heard = Vec::new();
            device.receive(chunk, &mut heard);
            for row in rows(&heard) {
                prop_assert_eq!(row.values.len(), device.channels().len());
            }
        }
    }
}

/// Frames at 1 kHz whose stamps of 1 ms two of them share now and then, as those of a real adapter do: each gives a row, and none is lost.
#[test]
fn frames_that_share_a_time_stamp_all_give_rows() {
    let mut adapter = SlcanSimulator::new(true);
    let opening = opening(Some(500_000), Access::Listen).unwrap();
    adapter.receive(&opening);
    let reads: Vec<(Vec<u8>, i64)> = (0..3000_u32)
        .map(|k| {
            // Each tenth frame comes so early that it has the stamp of the one before.
            let time_s = 1e-3 * f64::from(k) + if k % 10 == 0 { -2e-4 } else { 1e-4 };
            (adapter.frame(time_s.max(0.0), 257, &[k as u8, 0, 3, 0]), (1e9 * time_s) as i64 + 300_000)
        })
        .collect();
    let found = survey(&reads[..1500].iter().map(chunk).collect::<Vec<_>>(), signals()).unwrap();
    let mut device = CanBus::new(found, opening);
    let mut timeline = socam_sources::Timeline::new(device.numbering(), None);
    let mut heard = Vec::new();
    reads.iter().for_each(|read| device.receive(chunk(read), &mut heard));
    let numbers: Vec<u64> = rows(&heard)
        .into_iter()
        .filter_map(|row| match timeline.place(row) {
            socam_sources::Placed::At { sequence, .. } => Some(sequence),
            _ => None,
        })
        .collect();
    assert!(
        numbers.len() >= 2990 && timeline.counts().repeated == 0,
        "{} {:?}",
        numbers.len(),
        timeline.counts()
    );
    let lost = numbers[numbers.len() - 1] + 1 - numbers.len() as u64;
    assert_eq!(lost, 0);
}
