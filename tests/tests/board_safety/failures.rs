//! Failures of an emulated board in a run, and the reports on them.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Duration;

use socam_core::{Refusal, Request};
use socam_tests::emulator::{Emulator, Happened, bench};
use socam_tests::{Ran, run};
use socam_wire::{BoardStatus, Decoder, Encoder, MAX_FRAME, ToBoard, ToHost};

/// Into the run.
pub(super) const AFTER_S: f64 = 0.4;

pub(super) fn board() -> Option<Emulator> {
    Emulator::start(bench(&[], 3))
}

pub(super) fn record(board: &Emulator, more: &[&str]) -> Ran {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("run.mcap").to_str().unwrap().to_owned();
    let arguments = ["record", "-o", &log, "--device", &board.device, "--profile", "steps"];
    let duration: &[&str] = if more.contains(&"--duration") { &[] } else { &["--duration", "2s"] };
    run(arguments.iter().chain(duration).chain(more))
}

/// Time of the first such event after `from_s`.
pub(super) fn first(
    log: &[Happened],
    from_s: f64,
    what: &str,
    is: impl Fn(&serde_json::Value) -> bool,
) -> Option<f64> {
    log.iter()
        .find(|entry| entry.at_s >= from_s && entry.what == what && is(&entry.value))
        .map(|entry| entry.at_s)
}

/// Lets `what` happen in a run: the drive must be off and the output at 0 V within `within_s`, and stay so.
#[track_caller]
pub(super) fn stops(board: &mut Emulator, what: &str, within_s: f64, more: &[&str]) -> Ran {
    board.inject(what, Some(AFTER_S));
    let ran = record(board, more);
    board.run_for(0.1);
    let log = board.log();
    let injected =
        log.iter().rfind(|entry| entry.what == "injected").unwrap_or_else(|| panic!("{what}: {ran:?}")).at_s;
    let disabled =
        first(&log, injected, "enable", |on| on == false).unwrap_or_else(|| panic!("{what}: {log:?}"));
    let zero =
        first(&log, injected, "volts", |volts| volts == 0).unwrap_or_else(|| panic!("{what}: {log:?}"));
    println!(
        "measured: {what}: drive disabled after {:.3} ms, output at 0 V after {:.3} ms",
        (disabled - injected) * 1e3,
        (zero - injected) * 1e3
    );
    assert!(disabled - injected <= within_s && zero - injected <= within_s, "{what}: {log:?}");
    assert_eq!(first(&log, disabled, "enable", |on| on == true), None, "{what}: it moved again");
    assert_eq!(ran.code, Some(1), "{what}: {ran:?}");
    ran
}

/// The error in which a run ended.
pub(super) fn error(ran: &Ran) -> &str {
    ran.stderr.lines().rfind(|line| line.starts_with("error: ")).unwrap_or_else(|| panic!("{ran:?}"))
}

/// Tests failures in turn. Each has a name, the time within which it must stop the bench, its message, and the injection that
/// repairs it. The next run's host first receives the fault that the board remembers.
#[track_caller]
pub(super) fn stop_in_turn(board: &mut Emulator, failures: &[(&str, f64, &str, &str)]) {
    let mut remembered: Option<&str> = None;
    for (what, within_s, says, mend) in failures {
        let ran = stops(board, what, *within_s, &[]);
        assert!(error(&ran).contains(says), "{what}: {ran:?}");
        if let Some(fault) = remembered {
            let is_told = |line: &str| line.contains("remembers an earlier fault") && line.contains(fault);
            assert!(ran.stderr.lines().any(is_told), "{what}: {ran:?}");
        }
        board.inject(mend, None);
        remembered = Some(says);
    }
    remembers(board, remembered.unwrap_or_default());
}

/// The next run succeeds, and its host first receives the fault that the board remembers.
#[track_caller]
pub(super) fn remembers(board: &mut Emulator, fault: &str) {
    let ran = record(board, &[]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(ran.stderr.contains("remembers an earlier fault") && ran.stderr.contains(fault), "{ran:?}");
}

/// Number of blinks of the light between two long pauses, after a given time.
pub(super) fn blinks(log: &[Happened], from_s: f64) -> usize {
    let changes: Vec<_> = log.iter().filter(|entry| entry.what == "light" && entry.at_s >= from_s).collect();
    let pauses: Vec<usize> =
        (1..changes.len()).filter(|&i| changes[i].at_s - changes[i - 1].at_s > 1.5).collect();
    (pauses[1] - pauses[0]) / 2
}

/// Status that the board sends unasked; the first one is skipped, since it may date from before the line was opened.
pub(super) fn status(board: &Emulator) -> BoardStatus {
    let mut line = TcpStream::connect(("127.0.0.1", board.port)).unwrap();
    line.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
    let (mut decoder, mut buffer, mut times) = (Decoder::<ToHost>::new(), [0; 4096], 0);
    loop {
        let count = line.read(&mut buffer).unwrap();
        let mut bytes = &buffer[..count];
        while let Some(item) = decoder.next(&mut bytes) {
            if let Ok(ToHost::Status(status)) = item {
                times += 1;
                if times == 3 {
                    return status;
                }
            }
        }
    }
}

/// The board's answer to a request.
pub(super) fn answer(board: &Emulator, request: Request) -> Result<(), Refusal> {
    let mut line = TcpStream::connect(("127.0.0.1", board.port)).unwrap();
    line.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
    let mut frame = [0; MAX_FRAME];
    let mut encoder = Encoder::new();
    // The first frame may have the number of the last host's only one, which is not heard twice.
    for message in [ToBoard::Hello, ToBoard::Request { number: 1, request }] {
        let len = encoder.encode(&message, &mut frame).unwrap();
        line.write_all(&frame[..len]).unwrap();
    }
    let (mut decoder, mut buffer) = (Decoder::<ToHost>::new(), [0; 4096]);
    loop {
        let count = line.read(&mut buffer).unwrap();
        let mut bytes = &buffer[..count];
        while let Some(item) = decoder.next(&mut bytes) {
            if let Ok(ToHost::Answer { number: 1, result }) = item {
                return result;
            }
        }
    }
}
