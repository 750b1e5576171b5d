//! Faults at the emulated board: the output is at 0 V and the drive disabled in time, the cause is reported afterwards, and the
//! bench does not move before the host asks for it again.
//! movement before the host asks for it anew.

mod failures;

use failures::{
    AFTER_S, answer, blinks, board, error, first, record, remembers, status, stop_in_turn, stops,
};
use socam_core::{Fault, Refusal, Request};
use socam_tests::emulator::{Emulator, bench};
use socam_tests::{firmware, run};

/// Samples that are not read fill the board's buffer; in the thesis' program the buffer had no bound and two sizes.
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
    let silent = Fault::HostSilent { timeout_us: 500_000 }.to_string();
    // The host's last word was up to 0.1 s before.
    let failures = ["host=nothing", "host=garbage"].map(|what| (what, 0.502, silent.as_str(), "host=alone"));
    stop_in_turn(&mut board, &failures);
}

/// The thesis' program waited for ever for a converter, and took 0xffff for a voltage. An input that never changes cannot be
/// distinguished from a quiet one at once: a hundred conversions, 25 ms, are allowed.
#[test]
fn a_converter_that_fails_stops_the_bench() {
    let Some(mut board) = board() else { return };
    let [input, output] = [Fault::ConverterSilent, Fault::OutputSilent].map(|fault| fault.to_string());
    let failures = [
        ("input=low", 0.002, input.as_str(), "input=well"),
        ("input=high", 0.002, &input, "input=well"),
        ("input=frozen", 0.002, &input, "input=well"),
        ("both=high", 0.002, &output, "both=well"),
        ("both=low", 0.002, &output, "both=well"),
        ("output=low", 0.002, &output, "output=well"),
        ("output=high", 0.002, &output, "output=well"),
        ("input=stuck", 0.002, "all inputs read the same", "input=well"),
        ("reading=2@1", 0.027, "torque_in is stuck", "reading=2"),
    ];
    stop_in_turn(&mut board, &failures);
}

/// The processor's clock fails and the timer's does not: 31 MHz, and the crystal's own 12 MHz.
#[test]
fn a_clock_that_slows_down_stops_the_bench() {
    let Some(mut board) = board() else { return };
    let off = Fault::ClockOff.to_string();
    let failures = ["slow=1.1", "slow=4", "slow=10.4"].map(|what| (what, 0.002, off.as_str(), "slow=1"));
    stop_in_turn(&mut board, &failures);
}

/// A crystal that stops takes processor and watchdog with it; only a watchdog outside of the board disables the drive.
#[test]
fn a_crystal_that_stops_is_the_external_watchdogs() {
    let Some(mut board) = board() else { return };
    board.inject("fit-guard", None);
    assert_eq!(record(&board, &[]).code, Some(0), "the external watchdog lets a run be");
    board.inject("stop-crystal", Some(AFTER_S));
    let ran = record(&board, &[]);
    assert!(ran.code == Some(1) && ran.stderr.contains("fell silent"), "{ran:?}");
    let log = board.log();
    let injected = log.iter().rfind(|entry| entry.what == "injected").unwrap().at_s;
    let disabled = first(&log, injected, "enable", |on| on == false).unwrap_or_else(|| panic!("{log:?}"));
    println!("measured: stop-crystal: drive disabled after {:.3} ms", (disabled - injected) * 1e3);
    assert!(disabled - injected <= 0.002, "{log:?}");
}

#[test]
fn over_speed_and_over_torque_stop_the_bench() {
    let Some(mut board) = board() else { return };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("limits.toml");
    let text = run(["template", "calibration"]).done();
    let text = text
        .replacen("full_scale_V = 10\n", "full_scale_V = 10.24\n", 1)
        .replacen("limit = 1.425", "limit = 1.1", 1)
        .replacen("limit = 38", "limit = 20", 1);
    std::fs::write(&file, text).unwrap();
    for (what, says) in
        [("reading=0@9.95", "over-speed: motor_speed"), ("reading=3@9.9", "over-torque: torque_out")]
    {
        let ran = stops(&mut board, what, 0.002, &["--calibration", file.to_str().unwrap()]);
        assert!(error(&ran).contains(says), "{ran:?}");
        board.inject(what.split_once('@').unwrap().0, None);
        board.run_for(0.01);
    }
    remembers(&mut board, "over-torque: torque_out");
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
        assert!(error(&ran).contains(&Fault::Watchdog.to_string()), "{what}: {ran:?}");
    }
    let ran = stops(&mut board, "press-reset", 0.002, &[]);
    assert!(ran.stderr.contains("remembers an earlier fault"), "{ran:?}");
    assert!(error(&ran).contains(&Fault::Reset.to_string()), "{ran:?}");
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

/// A pad or a line that is held high keeps the drive enabled. Only a person or a relay can disable it, so the fault must be
/// reported.
#[test]
fn an_enable_line_that_does_not_follow_is_told() {
    let Some(mut board) = board() else { return };
    let [low, high] = [false, true].map(|is_on| Fault::EnableStuck { is_on }.to_string());
    let ran = stops(&mut board, "pad=low", 0.002, &[]);
    assert!(ran.stderr.contains(&low), "{ran:?}");
    board.inject("pad=well", None);

    // In a run the line is where it should be; at the end of the run it is not.
    board.inject("pad=high", Some(AFTER_S));
    let ran = record(&board, &[]);
    assert!(ran.code == Some(1) && ran.stderr.contains(&high), "{ran:?}");
    assert_eq!(board.log().iter().rfind(|entry| entry.what == "volts").unwrap().value, 0);
    // At rest the fault comes back, so that no run begins.
    let ran = record(&board, &[]);
    assert!(ran.code == Some(1) && ran.stderr.contains(&high), "{ran:?}");
    board.inject("pad=well", None);
    remembers(&mut board, &high);

    // Only the feedback wire detects a fault behind the pad, and the host is told whether there is such a wire.
    board.inject("drive=high", None);
    let ran = record(&board, &[]);
    assert_eq!(ran.code, Some(0), "the pad itself is well");
    assert!(ran.stderr.contains("read back at the board's pin only"), "{ran:?}");
    board.inject("drive=well", None);
    board.inject("wire-feedback", None);
    board.run_for(0.1);
    let ran = stops(&mut board, "drive=low", 0.002, &[]);
    assert!(ran.stderr.contains(&low) && ran.stderr.contains("read back at the drive"), "{ran:?}");
    board.inject("drive=high", None);
    let ran = record(&board, &[]);
    assert!(ran.code == Some(1) && ran.stderr.contains(&high), "{ran:?}");
}

/// An interrupt's vector that nothing uses.
const UNUSED_VECTOR: u32 = 0x100 + 0x40 + 4 * 29;

#[test]
fn a_damaged_program_never_moves_the_bench() {
    let Some(image) = firmware::image() else { return };
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("INFO_UF2.TXT"), "Board-ID: RPI-RP2\r\n").unwrap();
    let _ = run(["flash".as_ref(), image.as_os_str(), "--drive".as_ref(), folder.path().as_os_str()]).done();
    let Some(mut board) = Emulator::start_flashed(bench(&[], 3), &folder.path().join("socam.uf2")) else {
        return;
    };
    let ran = record(&board, &[]);
    assert!(ran.code == Some(0) && !ran.stderr.contains("carries no checksum"), "{ran:?}");
    board.inject(&format!("damage-flash={UNUSED_VECTOR}"), None);
    board.run_for(0.3);
    let ran = record(&board, &[]);
    assert_eq!(ran.refusal(1), Fault::ImageDamaged.to_string());
    let (log, damaged) = (board.log(), Fault::ImageDamaged);
    let from_s = log.iter().rfind(|entry| entry.what == "boot").unwrap().at_s;
    assert_eq!(first(&log, from_s, "enable", |on| on == true), None);
    // The board itself refuses, whatever its host makes of what it says.
    assert_eq!(answer(&board, Request::ClearFault), Err(Refusal::Faulted(damaged)));
    assert_eq!(status(&board).board.fault, Some(damaged));
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
