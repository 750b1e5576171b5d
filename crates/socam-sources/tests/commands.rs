//! Drives that follow a profile, against their simulations in simulated time: what they do, and what stops them.

use socam_core::{Command, Profile, Shape};
use socam_sources::moteus::Moteus;
use socam_sources::odrive::Odrive;
use socam_sources::simulators::{Firmware, Inertia, Mishap, MoteusSimulator, Motor, OdriveSimulator};
use socam_sources::{Chunk, Commanded, Commands, Device, Drive, Heard, Limits, Row};

const PERIOD_US: u32 = 2000;
/// Time from question to answer, ns.
const ROUND_NS: i64 = 400_000;
const WATCHDOG_S: f64 = 0.25;

/// A sine of 10 rad/s at 1 Hz for 2 s.
fn profile() -> Profile {
    Profile {
        command: Command::SpeedClosedLoop,
        shape: Shape::Sine {
            offset_micro: 0,
            amplitude_micro: 10_000_000,
            frequency_uhz: 1_000_000,
            periods: None,
        },
        ramp_us: 200_000,
        limit_micro: 12_000_000,
        slew_micro_s: 200_000_000,
        duration_us: 2_000_000,
    }
}

fn limits(effort: f64) -> Limits {
    let commands = Commands::Speeds;
    Limits { speed_rad_s: 15.0, effort, commands, acceleration_rad_s2: 200.0, watchdog_s: WATCHDOG_S }
}

fn commanded(drive: impl Drive + 'static, effort: f64) -> Commanded {
    Commanded::new(Box::new(drive), &profile(), PERIOD_US, limits(effort)).unwrap()
}

fn moteus() -> Commanded {
    commanded(Moteus::new(1, i64::from(PERIOD_US) * 1000).unwrap(), 0.5)
}

fn odrive() -> Commanded {
    commanded(Odrive::new(0, i64::from(PERIOD_US) * 1000).unwrap(), 5.0)
}

fn motor() -> Motor {
    Motor::at_rest(Inertia::SMALL, 0.1)
}

/// What happened to a run.
#[derive(Debug)]
struct Ran {
    rows: Vec<Row>,
    /// Its end, if it had one: the reason, or what made it unusable.
    end: Option<Option<String>>,
    end_s: f64,
    sent: Vec<u8>,
}

impl Ran {
    fn reason(&self) -> &str {
        self.end.as_ref().and_then(Option::as_deref).unwrap_or("none")
    }

    fn column(&self, index: usize) -> Vec<f64> {
        self.rows.iter().map(|row| row.values[index]).collect()
    }
}

/// Runs a device for some seconds. `drive` gets time and bytes, and answers.
fn run(device: &mut dyn Device, seconds: f64, mut drive: impl FnMut(f64, &[u8]) -> Vec<u8>) -> Ran {
    let (mut now_ns, mut heard, mut sent) = (1_i64, Vec::new(), Vec::new());
    let mut failed = None;
    while (now_ns as f64) < seconds * 1e9 && !heard.iter().any(|heard| matches!(heard, Heard::End { .. })) {
        let mut question = Vec::new();
        let next_ns = match device.poll(now_ns, &mut question) {
            Ok(next_ns) => next_ns.unwrap(),
            Err(error) => {
                failed = Some(Some(error.to_string()));
                break;
            }
        };
        sent.extend_from_slice(&question);
        let answer = drive(now_ns as f64 * 1e-9, &question);
        if answer.is_empty() {
            now_ns = next_ns.clamp(now_ns + 100_000, now_ns + 2_000_000);
            continue;
        }
        device.receive(Chunk { bytes: &answer, from_ns: now_ns, until_ns: now_ns + ROUND_NS }, &mut heard);
        now_ns += ROUND_NS;
    }
    let end = heard.iter().find_map(|heard| match heard {
        Heard::End { reason, .. } => Some(reason.clone()),
        _ => None,
    });
    let rows =
        heard.into_iter().filter_map(|heard| if let Heard::Row(row) = heard { Some(row) } else { None });
    Ran { rows: rows.collect(), end: failed.or(end), end_s: now_ns as f64 * 1e-9, sent }
}

/// Runs a moteus to which something happens at a time.
fn moteus_with(mishap: Mishap, at_s: f64) -> (Ran, MoteusSimulator) {
    let (mut device, mut drive) = (moteus(), MoteusSimulator::new(1, motor()));
    let ran = run(&mut device, 8.0, |time_s, bytes| {
        drive.mishap = (time_s >= at_s).then_some(mishap);
        drive.receive(time_s, bytes)
    });
    (ran, drive)
}

/// Largest distance between the commands and the measured speeds, of which all but the last row are.
fn worst_rad_s(ran: &Ran, speed: usize, command: usize) -> f64 {
    let pairs = ran.column(speed).into_iter().zip(ran.column(command));
    pairs.map(|(speed, command)| (speed - command).abs()).fold(0.0, f64::max)
}

#[test]
fn a_moteus_follows_a_profile_and_is_stopped_at_its_end() {
    let (mut device, mut drive) = (moteus(), MoteusSimulator::new(1, motor()));
    let ran = run(&mut device, 8.0, |time_s, bytes| drive.receive(time_s, bytes));
    assert_eq!(ran.end, Some(None), "{}", ran.reason());
    assert_eq!((device.channels().last().unwrap().column_name().as_str(), drive.mode), ("command_rad_s", 0));
    let command = ran.column(8);
    let top = command.iter().copied().fold(0.0, f64::max);
    assert!((top - 10.0).abs() < 0.05 && command[..50].iter().all(|value| *value == 0.0), "{top}");
    let worst = worst_rad_s(&ran, 2, 8);
    assert!(worst < 3.0, "{worst}");
    // A row has the time at which its command left: by the profile's own time, its sine is known at each.
    let start = ran.rows.iter().position(|row| row.values[8] != 0.0).unwrap();
    let begin_ns = ran.rows[start].arrival_ns;
    for row in &ran.rows[start + 150..start + 900] {
        let time_s = (row.arrival_ns - begin_ns) as f64 * 1e-9;
        let expected = 10.0 * (std::f64::consts::TAU * time_s).sin();
        assert!((row.values[8] - expected).abs() < 0.3, "{time_s} {} {expected}", row.values[8]);
    }
    assert!((2.3..3.2).contains(&ran.end_s), "{}", ran.end_s);
}

#[test]
fn an_odrive_of_either_generation_follows_a_profile_and_gets_its_settings_back() {
    for firmware in [Firmware::Early, Firmware::Late] {
        let (mut device, mut drive) = (odrive(), OdriveSimulator::new(firmware, motor()));
        let mut kept = Vec::new();
        let ran = run(&mut device, 8.0, |time_s, bytes| {
            let answer = drive.receive(time_s, bytes);
            if drive.motor.speed_rad_s.abs() > 5.0 && kept.is_empty() {
                kept = ["controller.config.vel_limit", "config.watchdog_timeout", "config.enable_watchdog"]
                    .map(|name| drive.property(&format!("axis0.{name}")).unwrap())
                    .to_vec();
            }
            answer
        });
        assert_eq!(ran.end, Some(None), "{}", ran.reason());
        assert!(worst_rad_s(&ran, 1, 5) < 3.0 && ran.column(1).into_iter().fold(0.0, f64::max) > 8.0);
        // While it moved it had the limits and the watchdog; afterwards what it had before.
        assert!(
            (kept[0] - 15.0 / std::f64::consts::TAU).abs() < 1e-4 && kept[1..] == [WATCHDOG_S, 1.0],
            "{kept:?}"
        );
        let after = [
            "controller.config.vel_limit",
            "config.enable_watchdog",
            "current_state",
            "controller.config.control_mode",
        ]
        .map(|name| drive.property(&format!("axis0.{name}")).unwrap());
        assert_eq!(after, [20.0, 0.0, 1.0, 3.0]);
    }
}

/// A sine of torque that stays within the speed, or a constant one that does not.
fn torques(drive: impl Drive + 'static, effort: f64, is_too_long: bool) -> Commanded {
    let shape = if is_too_long {
        Shape::Constant { level_micro: 40_000 }
    } else {
        Shape::Sine { offset_micro: 0, amplitude_micro: 40_000, frequency_uhz: 4_000_000, periods: None }
    };
    let profile = Profile { command: Command::Voltage, shape, limit_micro: 50_000, ..profile() };
    let limits = Limits { commands: Commands::Torques, ..limits(effort) };
    Commanded::new(Box::new(drive), &profile, PERIOD_US, limits).unwrap()
}

#[test]
fn a_moteus_follows_torques_and_one_that_gets_too_fast_is_stopped() {
    for is_too_long in [false, true] {
        let moteus = Moteus::new(1, i64::from(PERIOD_US) * 1000).unwrap();
        let (mut device, mut drive) = (torques(moteus, 0.05, is_too_long), MoteusSimulator::new(1, motor()));
        let mut fastest = 0_f64;
        let ran = run(&mut device, 8.0, |time_s, bytes| {
            let answer = drive.receive(time_s, bytes);
            fastest = fastest.max(drive.motor.speed_rad_s.abs());
            answer
        });
        assert_eq!(device.channels().last().unwrap().column_name(), "command_Nm");
        if is_too_long {
            assert!(ran.reason().contains("beyond the limit of 15 rad/s"), "{}", ran.reason());
            // What it gains within two periods, by 0.04 N m on 4e-4 kg m2.
            assert!(fastest < 15.5 && drive.mode == 0, "{fastest}");
        } else {
            assert_eq!(ran.end, Some(None), "{}", ran.reason());
            let (command, torque) = (ran.column(8), ran.column(3));
            assert!(command.iter().any(|value| *value > 0.039) && fastest > 2.0);
            let worst = command.iter().zip(&torque).map(|(sent, is)| (sent - is).abs()).fold(0.0, f64::max);
            assert!(worst < 0.01, "a torque is what was commanded a period ago: {worst}");
        }
    }
}

#[test]
fn an_odrive_limits_its_speed_under_a_torque_and_gets_its_settings_back() {
    for firmware in [Firmware::Early, Firmware::Late] {
        let odrive = Odrive::new(0, i64::from(PERIOD_US) * 1000).unwrap();
        let (mut device, mut drive) = (torques(odrive, 5.0, true), OdriveSimulator::new(firmware, motor()));
        let mut fastest = 0_f64;
        let ran = run(&mut device, 8.0, |time_s, bytes| {
            let answer = drive.receive(time_s, bytes);
            fastest = fastest.max(drive.motor.speed_rad_s.abs());
            answer
        });
        assert_eq!(ran.end, Some(None), "{}", ran.reason());
        assert!((10.0..15.0).contains(&fastest), "{fastest}");
        let name = |what: &str| format!("axis0.controller.config.{what}");
        let after = ["enable_torque_mode_vel_limit", "control_mode", "vel_limit"]
            .map(|what| drive.property(&name(what)).unwrap());
        assert_eq!(after, [0.0, 3.0, 20.0]);
    }
}

#[test]
fn what_is_only_asked_is_never_commanded() {
    let mut drive = MoteusSimulator::new(1, motor());
    let mut device = Moteus::new(1, 1_000_000).unwrap();
    let ran = run(&mut device, 2.0, |time_s, bytes| drive.receive(time_s, bytes));
    // A frame that commands writes the mode: its head is 01 00.
    let text = String::from_utf8(ran.sent).unwrap();
    assert!(ran.rows.len() > 1000 && drive.commands == 0 && !text.contains(" 0100"), "{}", &text[..200]);

    let mut drive = OdriveSimulator::new(Firmware::Late, motor());
    let mut device = Odrive::new(0, 1_000_000).unwrap();
    let ran = run(&mut device, 2.0, |time_s, bytes| drive.receive(time_s, bytes));
    let text = String::from_utf8(ran.sent).unwrap();
    assert!(drive.commands == 0 && text.lines().all(|line| line.starts_with("f ") || line.starts_with("r ")));
}

#[test]
fn every_command_of_a_moteus_holds_its_limits_and_its_watchdog() {
    let (mut device, mut drive) = (moteus(), MoteusSimulator::new(1, motor()));
    let ran = run(&mut device, 8.0, |time_s, bytes| drive.receive(time_s, bytes));
    let text = String::from_utf8(ran.sent).unwrap();
    let hex = |value: f64| (value as f32).to_le_bytes().map(|byte| format!("{byte:02X}")).concat();
    let held = [hex(0.5), hex(WATCHDOG_S) + &hex(15.0 / std::f64::consts::TAU)];
    let commands: Vec<&str> = text.lines().filter(|line| line.contains(" 01000A")).collect();
    assert!(commands.len() > 900 && commands.iter().all(|line| held.iter().all(|held| line.contains(held))));
}

#[test]
fn a_fault_ends_the_run_by_its_name() {
    let (ran, drive) = moteus_with(Mishap::Fault(34), 1.0);
    assert_eq!(ran.reason(), "the moteus reports fault 34 (over-voltage)");
    assert!(ran.end_s < 1.1 && ran.rows.len() > 400 && drive.motor.speed_rad_s.abs() < 10.0);
    let (mut device, mut drive) = (odrive(), OdriveSimulator::new(Firmware::Late, motor()));
    let ran = run(&mut device, 8.0, |time_s, bytes| {
        drive.mishap = (time_s >= 1.0).then_some(Mishap::Fault(0x1000));
        drive.receive(time_s, bytes)
    });
    assert_eq!(ran.reason(), "the ODrive reports error 0x1000 (limit of current violated)");
}

#[test]
fn a_drive_that_is_silent_runs_away_or_lies_is_told_to_stop() {
    for (mishap, sentence) in [
        (Mishap::Dies, "the drive has not answered for 0.2"),
        (Mishap::Freezes, "the drive did not confirm that it stopped"),
        (Mishap::RunsAway, "the drive states a speed of "),
        (Mishap::Lies, "the drive's positions move at "),
    ] {
        let (ran, drive) = moteus_with(mishap, 0.35);
        assert!(ran.reason().contains(sentence), "{mishap:?}: {}", ran.reason());
        let last = String::from_utf8(ran.sent).unwrap();
        assert!(last.trim_end().lines().any(|line| line.contains(" 010000")), "{mishap:?}");
        if matches!(mishap, Mishap::RunsAway | Mishap::Lies) {
            assert!(drive.mode == 0 && ran.end_s < 1.2, "{mishap:?} {}", ran.end_s);
        }
    }
}

/// Without another byte of the host the drive stops by itself.
#[test]
fn a_drive_whose_host_is_gone_is_at_rest_after_its_watchdogs_time() {
    let (mut device, mut drive) = (moteus(), MoteusSimulator::new(1, motor()));
    let ran = run(&mut device, 0.45, |time_s, bytes| drive.receive(time_s, bytes));
    assert!(drive.mode == 10 && drive.motor.speed_rad_s.abs() > 3.0);
    drive.advance(ran.end_s + 0.9 * WATCHDOG_S);
    assert_eq!(drive.mode, 10);
    drive.advance(ran.end_s + WATCHDOG_S + 0.01);
    assert_eq!(drive.mode, 11);
    drive.advance(ran.end_s + WATCHDOG_S + 0.3);
    assert!(drive.motor.speed_rad_s.abs() < 0.1, "{}", drive.motor.speed_rad_s);
}

#[test]
fn a_drive_that_is_not_ready_is_not_commanded() {
    // In a fault, turned by something else, or without a watchdog.
    let mut faulty = MoteusSimulator::new(1, motor());
    faulty.mishap = Some(Mishap::Fault(35));
    let ran = run(&mut moteus(), 8.0, |time_s, bytes| faulty.receive(time_s, bytes));
    assert!(ran.reason().contains("fault 35 (encoder fault); clear it first") && faulty.commands == 0);

    let mut busy = MoteusSimulator::new(1, Motor::turning(12.5, 0.1, 24.0));
    let ran = run(&mut moteus(), 8.0, |time_s, bytes| busy.receive(time_s, bytes));
    assert!(ran.reason().contains("obeys another program already") && busy.commands == 0);

    let mut plain = OdriveSimulator::new(Firmware::Early, motor());
    plain.has_no_watchdog = true;
    let ran = run(&mut odrive(), 8.0, |time_s, bytes| plain.receive(time_s, bytes));
    assert!(ran.reason().contains("does not take its limits"), "{}", ran.reason());
    assert_eq!(plain.motor.angle_rad, 0.0);

    let mut weak = OdriveSimulator::new(Firmware::Early, motor());
    let ran = run(&mut commanded(Odrive::new(0, 2_000_000).unwrap(), 50.0), 8.0, |time_s, bytes| {
        weak.receive(time_s, bytes)
    });
    assert!(
        ran.reason().contains("own limits are 125.6637 rad/s and 10.0000 A, below") && weak.commands == 0
    );
}

#[test]
fn the_operator_fades_the_profile_or_stops_at_once() {
    for (at_once, most_s) in [(false, 0.35), (true, 0.05)] {
        let (mut device, mut drive) = (moteus(), MoteusSimulator::new(1, motor()));
        let first = run(&mut device, 0.6, |time_s, bytes| drive.receive(time_s, bytes));
        assert!(device.last_words().is_some() && device.end((first.end_s * 1e9) as i64, at_once));
        let begin_ns = (first.end_s * 1e9) as i64;
        let (mut now_ns, mut heard) = (begin_ns, Vec::new());
        while !heard.iter().any(|heard| matches!(heard, Heard::End { .. })) {
            let mut question = Vec::new();
            device.poll(now_ns, &mut question).unwrap();
            let answer = drive.receive(now_ns as f64 * 1e-9, &question);
            device.receive(Chunk { bytes: &answer, from_ns: now_ns, until_ns: now_ns + 1 }, &mut heard);
            now_ns += 1_000_000;
        }
        let took_s = (now_ns - begin_ns) as f64 * 1e-9;
        assert!(took_s < most_s && drive.mode == 0, "{took_s}");
        let end = heard.into_iter().find(|heard| matches!(heard, Heard::End { .. })).unwrap();
        assert_eq!(end, Heard::End { reason: None, by_operator: true });
        assert!(device.last_words().is_none());
    }
}
