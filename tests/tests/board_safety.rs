//! Everything that can go wrong at the emulated board: output at 0 V and drive disabled in time, the cause told afterwards, and no
//! movement before the host asks for it anew.

use std::io::Read;
use std::net::TcpStream;
use std::time::Duration;

use socam_core::Fault;
use socam_tests::emulator::{Emulator, Happened, bench};
use socam_tests::{Ran, run};
use socam_wire::{BoardStatus, Decoder, ToHost};

/// Into the run.
const AFTER_S: f64 = 0.4;

fn board() -> Option<Emulator> {
    Emulator::start(bench(&[], 3))
}

fn record(board: &Emulator, more: &[&str]) -> Ran {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("run.mcap").to_str().unwrap().to_owned();
    let arguments = ["record", "-o", &log, "--device", &board.device, "--profile", "steps"];
    let duration: &[&str] = if more.contains(&"--duration") { &[] } else { &["--duration", "2s"] };
    run(arguments.iter().chain(duration).chain(more))
}

/// When it happened first after `from_s`.
fn first(log: &[Happened], from_s: f64, what: &str, is: impl Fn(&serde_json::Value) -> bool) -> Option<f64> {
    log.iter()
        .find(|entry| entry.at_s >= from_s && entry.what == what && is(&entry.value))
        .map(|entry| entry.at_s)
}

/// Lets `what` happen in a run: the drive must be off and the output at 0 V within `within_s`, and stay so.
#[track_caller]
fn stops(board: &mut Emulator, what: &str, within_s: f64, more: &[&str]) -> Ran {
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

/// The next run goes well, and its host is told first what the board remembers.
#[track_caller]
fn remembers(board: &mut Emulator, fault: &str) {
    let ran = record(board, &[]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(ran.stderr.contains("remembers an earlier fault") && ran.stderr.contains(fault), "{ran:?}");
}

/// How often the light blinks between two long pauses, from a time on.
fn blinks(log: &[Happened], from_s: f64) -> usize {
    let changes: Vec<_> = log.iter().filter(|entry| entry.what == "light" && entry.at_s >= from_s).collect();
    let pauses: Vec<usize> =
        (1..changes.len()).filter(|&i| changes[i].at_s - changes[i - 1].at_s > 1.5).collect();
    (pauses[1] - pauses[0]) / 2
}

/// What the board says of itself, unasked; not the first time, which may date from before the line was opened.
fn status(board: &Emulator) -> BoardStatus {
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

/// Samples that nobody takes fill the board's buffer; the thesis' program had one without a bound, of two sizes.
#[test]
fn a_pulled_cable_stops_the_bench() {
    let Some(mut board) = board() else { return };
    let _ = stops(&mut board, "pull-in-frame", 0.002, &[]);
    board.inject("plug-cable", None);
    remembers(&mut board, &Fault::CablePulled.to_string());
    let _ = stops(&mut board, "pull-cable", 0.002, &[]);
    board.run_for(2.0);
    board.inject("plug-cable", None);
    let told = status(&board).board;
    assert_eq!(told.fault, Some(Fault::CablePulled));
    // Samples of more than two seconds at 1 kHz, of which the buffer holds one.
    assert!((1000..told.tick).contains(&told.dropped), "{told:?}");
    remembers(&mut board, &Fault::CablePulled.to_string());
}

#[test]
fn a_host_that_falls_silent_or_mad_stops_the_bench() {
    let Some(mut board) = board() else { return };
    for what in ["host=nothing", "host=garbage"] {
        // The host's last word was up to 0.1 s before.
        let _ = stops(&mut board, what, 0.502, &[]);
        board.inject("host=alone", None);
        remembers(&mut board, &Fault::HostSilent { timeout_us: 500_000 }.to_string());
    }
}

/// The thesis' program waited for ever for a converter, and took 0xffff for a voltage.
#[test]
fn a_converter_that_does_not_answer_stops_the_bench() {
    let Some(mut board) = board() else { return };
    for what in ["input=low", "input=high", "input=frozen"] {
        let ran = stops(&mut board, what, 0.002, &[]);
        assert!(ran.stderr.contains(&Fault::ConverterSilent.to_string()), "{ran:?}");
        board.inject("input=well", None);
        remembers(&mut board, &Fault::ConverterSilent.to_string());
    }
    let _ = stops(&mut board, "both=high", 0.002, &[]);
    board.inject("both=well", None);
    for what in ["output=low", "output=high"] {
        let ran = stops(&mut board, what, 0.002, &[]);
        assert!(ran.stderr.contains(&Fault::OutputSilent.to_string()), "{ran:?}");
        board.inject("output=well", None);
        remembers(&mut board, &Fault::OutputSilent.to_string());
    }
}

#[test]
fn a_converter_that_repeats_itself_stops_the_bench() {
    let Some(mut board) = board() else { return };
    let ran = stops(&mut board, "input=stuck", 0.002, &[]);
    assert!(ran.stderr.contains("all inputs read the same"), "{ran:?}");
    board.inject("input=well", None);
    remembers(&mut board, "all inputs read the same");
}

/// One input that never changes cannot be told from a quiet one at once: a hundred conversions, 25 ms, are allowed.
#[test]
fn a_value_that_never_changes_stops_the_bench() {
    let Some(mut board) = board() else { return };
    let ran = stops(&mut board, "reading=2@1", 0.027, &[]);
    assert!(ran.stderr.contains("torque_in is stuck"), "{ran:?}");
    board.inject("reading=2", None);
    remembers(&mut board, "torque_in is stuck");
}

#[test]
fn over_speed_and_over_torque_stop_the_bench() {
    let Some(mut board) = board() else { return };
    for (what, says) in
        [("reading=0@9.95", "over-speed: motor_speed"), ("reading=3@9.9", "over-torque: torque_out")]
    {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("limits.toml");
        let text = run(["template", "calibration"]).done();
        let text = text
            .replacen("full_scale_V = 10\n", "full_scale_V = 10.24\n", 1)
            .replacen("limit = 1.425", "limit = 1.1", 1)
            .replacen("limit = 38", "limit = 20", 1);
        std::fs::write(&file, text).unwrap();
        let ran = stops(&mut board, what, 0.002, &["--calibration", file.to_str().unwrap()]);
        assert!(ran.stderr.contains(says), "{ran:?}");
        board.inject(what.split_once('@').unwrap().0, None);
        board.run_for(0.01);
        remembers(&mut board, says);
    }
}

#[test]
fn the_emergency_stop_stops_the_bench() {
    let Some(mut board) = board() else { return };
    let ran = stops(&mut board, "open-stop", 1e-6, &[]);
    assert!(ran.stderr.contains(&Fault::EmergencyStopInput.to_string()), "{ran:?}");
    let stopped_s = board.log().last().unwrap().at_s;
    board.run_for(8.0);
    assert_eq!(blinks(&board.log(), stopped_s), usize::from(Fault::EmergencyStopInput.code()));
    // While it is open nothing starts.
    let ran = record(&board, &[]);
    assert_eq!(ran.code, Some(1), "{ran:?}");
    board.inject("close-stop", None);
    remembers(&mut board, &Fault::EmergencyStopInput.to_string());
}

/// The thesis' program stopped by its timer alone.
#[test]
fn a_program_that_hangs_and_a_reset_stop_the_bench() {
    let Some(mut board) = board() else { return };
    // The overflow has one more conversion to fill the stack.
    for (what, within_s) in [
        ("halt", 0.002),
        ("panic=thread", 0.002),
        ("panic=interrupt", 0.002),
        ("hard-fault=thread", 0.002),
        ("hard-fault=interrupt", 0.002),
        ("overflow=thread", 0.002),
        ("overflow=interrupt", 0.002),
        ("hang", 0.002),
    ] {
        let ran = stops(&mut board, what, within_s, &[]);
        assert!(ran.stderr.contains(&Fault::Watchdog.to_string()), "{what}: {ran:?}");
    }
    remembers(&mut board, &Fault::Watchdog.to_string());
    let ran = stops(&mut board, "press-reset", 0.002, &[]);
    assert!(ran.stderr.contains(&Fault::Reset.to_string()), "{ran:?}");
    remembers(&mut board, &Fault::Reset.to_string());
}

/// After a short loss of the supply the board knows that it was in a run; after a long one the host sees that it came to rest.
#[test]
fn a_loss_of_the_supply_stops_the_bench_and_is_told() {
    let Some(mut board) = board() else { return };
    let ran = stops(&mut board, "brown-out", 0.002, &[]);
    assert!(ran.stderr.contains(&Fault::PowerLost.to_string()), "{ran:?}");
    remembers(&mut board, &Fault::PowerLost.to_string());
    let ran = stops(&mut board, "power-off", 0.002, &[]);
    assert!(ran.stderr.contains("as after a loss of power"), "{ran:?}");
    // Nothing is remembered, because a board that was switched on normally is the same.
    assert!(!record(&board, &[]).stderr.contains("remembers"));
}

/// A pad or a line that is held high keeps the drive enabled: nothing but a person or a relay can disable it, so it must be told.
#[test]
fn an_enable_line_that_does_not_follow_is_told() {
    let Some(mut board) = board() else { return };
    let [low, high] = [false, true].map(|is_on| Fault::EnableStuck { is_on }.to_string());
    let ran = stops(&mut board, "pad=low", 0.002, &[]);
    assert!(ran.stderr.contains(&low), "{ran:?}");
    board.inject("pad=well", None);

    // In a run it is where it should be; at its end it is not.
    board.inject("pad=high", Some(AFTER_S));
    let ran = record(&board, &[]);
    assert!(ran.code == Some(1) && ran.stderr.contains(&high), "{ran:?}");
    assert_eq!(board.log().iter().rfind(|entry| entry.what == "volts").unwrap().value, 0);
    // At rest it is a fault that comes back: no run begins.
    let ran = record(&board, &[]);
    assert!(ran.code == Some(1) && ran.stderr.contains(&high), "{ran:?}");
    board.inject("pad=well", None);
    remembers(&mut board, &high);

    // Behind the pad only the feedback wire sees it.
    board.inject("drive=high", None);
    assert_eq!(record(&board, &[]).code, Some(0), "the pad itself is well");
    board.inject("drive=well", None);
    board.inject("wire-feedback", None);
    board.run_for(0.1);
    let ran = stops(&mut board, "drive=low", 0.002, &[]);
    assert!(ran.stderr.contains(&low), "{ran:?}");
    board.inject("drive=high", None);
    let ran = record(&board, &[]);
    assert!(ran.code == Some(1) && ran.stderr.contains(&high), "{ran:?}");
}

#[test]
fn no_setting_exceeds_what_the_image_allows() {
    let Some(board) = board() else { return };
    for (arguments, says) in [
        (["--rate", "10000"], "this board's sample period is 200 us to 10000 us"),
        (["--rate", "50"], "this board's sample period is 200 us to 10000 us"),
        (["--duration", "3601s"], "it lasts longer than the 3600 s"),
    ] {
        let ran = record(&board, &arguments);
        assert!(ran.code == Some(1) && ran.stderr.contains(says), "{ran:?}");
    }
}
