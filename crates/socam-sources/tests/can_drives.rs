//! Drives on a simulated CAN bus behind a simulated adapter, in simulated time.

#![cfg(feature = "can")]

use proptest::prelude::*;
use socam_core::{Command, Profile, Shape};
use socam_sources::can::canopen::{Canopen, CanopenDrive, Objects};
use socam_sources::can::odrive::OdriveCan;
use socam_sources::can::{Access, opening};
use socam_sources::simulators::{
    BusSimulator, CanopenSimulator, Firmware, Frame, Inertia, Mishap, Motor, Node, OdriveCanSimulator,
};
use socam_sources::{Chunk, Commanded, Commands, Device, Heard, Limits, Row};

const PERIOD_US: u32 = 2000;
const WATCHDOG_S: f64 = 0.25;
/// Bytes of a line per time, ns: those of an adapter on USB.
const STEP_NS: i64 = 500_000;

fn odrive(node: u8) -> OdriveCan {
    OdriveCan::new(node, i64::from(PERIOD_US) * 1000, opening(Some(500_000), Access::Send).unwrap()).unwrap()
}

fn simulated(firmware: Firmware) -> BusSimulator<OdriveCanSimulator> {
    BusSimulator::new(OdriveCanSimulator::new(3, firmware, Motor::at_rest(Inertia::SMALL, 0.1)))
}

/// A sine of 10 rad/s for 2 s.
fn sine() -> Profile {
    let shape =
        Shape::Sine { offset_micro: 0, amplitude_micro: 10_000_000, frequency_uhz: 1_000_000, periods: None };
    Profile {
        command: Command::SpeedClosedLoop,
        shape,
        ramp_us: 200_000,
        limit_micro: 12_000_000,
        slew_micro_s: 200_000_000,
        duration_us: 2_000_000,
    }
}

fn commanded() -> Commanded {
    Commanded::new(Box::new(odrive(3)), &sine(), PERIOD_US, limits(Commands::Speeds)).unwrap()
}

fn limits(commands: Commands) -> Limits {
    Limits { speed_rad_s: 15.0, effort: 5.0, commands, acceleration_rad_s2: 200.0, watchdog_s: WATCHDOG_S }
}

/// A constant torque, N m, or a sine of it at 4 Hz.
fn torques(amplitude_nm: f64, is_constant: bool) -> Commanded {
    let amplitude_micro = (amplitude_nm * 1e6) as i32;
    let shape = if is_constant {
        Shape::Constant { level_micro: amplitude_micro }
    } else {
        Shape::Sine { offset_micro: 0, amplitude_micro, frequency_uhz: 4_000_000, periods: None }
    };
    let profile = Profile {
        command: Command::Voltage,
        shape,
        ramp_us: 200_000,
        limit_micro: 400_000,
        slew_micro_s: 40_000_000,
        duration_us: 2_000_000,
    };
    Commanded::new(Box::new(odrive(3)), &profile, PERIOD_US, limits(Commands::Torques)).unwrap()
}

/// What happened to a run.
#[derive(Debug)]
struct Ran {
    heard: Vec<Heard>,
    /// Why it became unusable, or ended before its profile.
    reason: Option<String>,
    end_s: f64,
}

impl Ran {
    fn rows(&self) -> Vec<&Row> {
        self.heard
            .iter()
            .filter_map(|heard| if let Heard::Row(row) = heard { Some(row) } else { None })
            .collect()
    }

    fn reason(&self) -> &str {
        self.reason.as_deref().unwrap_or("none")
    }

    fn damaged(&self) -> usize {
        self.heard.iter().filter(|heard| matches!(heard, Heard::Damaged(_))).count()
    }
}

/// Runs a device for some seconds against a bus, to whose node something may happen.
fn run<N: Node>(
    device: &mut dyn Device,
    seconds: f64,
    bus: &mut BusSimulator<N>,
    mut happen: impl FnMut(f64, &mut N),
) -> Ran {
    let (mut now_ns, mut heard, mut reason) = (1_i64, Vec::new(), None);
    while (now_ns as f64) < seconds * 1e9 {
        let mut question = Vec::new();
        if let Err(error) = device.poll(now_ns, &mut question) {
            reason = Some(error.to_string());
            break;
        }
        let time_s = now_ns as f64 * 1e-9;
        happen(time_s, &mut bus.node);
        let answer = bus.receive(time_s, &question);
        device.receive(Chunk { bytes: &answer, from_ns: now_ns, until_ns: now_ns + STEP_NS / 2 }, &mut heard);
        now_ns += STEP_NS;
        if let Some(Heard::End { reason: end, .. }) = heard.last() {
            reason.clone_from(end);
            break;
        }
    }
    Ran { heard, reason, end_s: now_ns as f64 * 1e-9 }
}

#[test]
fn an_odrive_of_either_firmware_is_asked_and_not_commanded() {
    for firmware in [Firmware::Early, Firmware::Late] {
        let mut bus = simulated(firmware);
        bus.node.motor = Motor::turning(12.5, 0.25, 24.0);
        let ran = run(&mut odrive(3), 2.0, &mut bus, |_, _| {});
        let rows = ran.rows();
        // 2 s at 500 Hz, but for the time that the question for the firmware takes where nothing answers it.
        assert!((900..=1000).contains(&rows.len()) && ran.damaged() == 0, "{} {ran:?}", rows.len());
        for row in &rows {
            assert!((row.values[1] - 12.5).abs() < 1e-5 && row.values[2..5] == [0.25, 24.0, 0.5], "{row:?}");
            assert!(row.values[6].is_nan() && row.spread_ns <= STEP_NS, "{row:?}");
        }
        let warm = rows.iter().filter(|row| (row.values[5] - 304.65).abs() < 1e-9).count();
        let cold = rows.iter().filter(|row| row.values[5].is_nan()).count();
        assert_eq!(warm + cold, rows.len());
        assert_eq!(warm > 30, firmware == Firmware::Late, "{warm}");
        let errors = rows.iter().filter(|row| row.values[7] == 0.0).count();
        assert!((15..=20).contains(&errors), "{errors}");
        let says_so = ran.heard.contains(&Heard::Talk("firmware 0.6.10".into()));
        assert_eq!(says_so, firmware == Firmware::Late);
        assert!(bus.node.commands == 0 && bus.sent.iter().all(|frame| frame.is_remote));
        assert_eq!(bus.adapter.commands[..5], ["", "C", "S6", "Z1", "O"]);
    }
}

#[test]
fn an_odrive_follows_a_profile_once_its_watchdog_was_seen_to_act() {
    for firmware in [Firmware::Early, Firmware::Late] {
        let (mut device, mut bus) = (commanded(), simulated(firmware));
        let mut kept = (0.0, 0.0);
        let ran = run(&mut device, 8.0, &mut bus, |_, node| {
            if node.motor.speed_rad_s.abs() > 5.0 {
                kept = node.limits;
            }
        });
        assert_eq!(ran.reason, None, "{firmware:?} {}", ran.end_s);
        assert!(ran.heard.contains(&Heard::End { reason: None, by_operator: false }), "{}", ran.end_s);
        let rows = ran.rows();
        let top = rows.iter().map(|row| row.values[1]).fold(0.0, f64::max);
        let worst = rows.iter().map(|row| (row.values[1] - row.values[8]).abs()).fold(0.0, f64::max);
        assert!(top > 9.0 && worst < 3.0, "{top} {worst}");
        assert!((kept.0 - 15.0 / std::f64::consts::TAU).abs() < 1e-6 && kept.1 == 5.0, "{kept:?}");
        assert_eq!((bus.node.state, bus.node.error), (1, 0));
        // The expiry that the trial provoked is no fault of the drive.
        assert!(!ran.heard.iter().any(|heard| matches!(heard, Heard::Fault(_))));
    }
}

#[test]
fn an_odrive_whose_watchdog_does_not_act_in_time_is_not_commanded() {
    for watchdog_s in [None, Some(0.7)] {
        let (mut device, mut bus) = (commanded(), simulated(Firmware::Late));
        bus.node.watchdog_s = watchdog_s;
        let ran = run(&mut device, 8.0, &mut bus, |_, _| {});
        assert!(ran.reason().contains("watchdog did not act within 0.25 s of silence"), "{}", ran.reason());
        assert_eq!(bus.node.motor.angle_rad, 0.0);
        // It was never asked to obey.
        assert!(!bus.sent.iter().any(|frame| frame.id == 0x67 && frame.bytes[0] == 8));
    }
}

#[test]
fn a_fault_a_runaway_or_a_second_master_ends_the_run() {
    for (mishap, sentence) in [
        (Mishap::Fault(0x1000), "the ODrive reports error 0x1000 (limit of current violated)"),
        (Mishap::RunsAway, "the drive states a speed of "),
        (Mishap::Dies, "the drive has not answered for 0.2"),
    ] {
        let (mut device, mut bus) = (commanded(), simulated(Firmware::Late));
        let ran = run(&mut device, 8.0, &mut bus, |time_s, node| {
            node.mishap = (time_s > 1.6).then_some(mishap);
        });
        assert!(ran.reason().contains(sentence), "{mishap:?}: {}", ran.reason());
        let last = bus.sent.iter().rev().find(|frame| !frame.is_remote && frame.id == 0x67).unwrap();
        assert_eq!(last.bytes[0], 1, "{mishap:?}");
    }
    let (mut device, mut bus) = (commanded(), simulated(Firmware::Late));
    let first = run(&mut device, 1.6, &mut bus, |_, _| {});
    assert!(first.rows().iter().any(|row| row.values[8] != 0.0));
    let mut heard = Vec::new();
    let rival = bus.adapter.frame(1.6, 0x6d, &[0; 8]);
    let until_ns = 1_600_500_000;
    device.receive(Chunk { bytes: &rival, from_ns: until_ns, until_ns }, &mut heard);
    assert_eq!(heard, [Heard::Fault("another program on the bus commands this ODrive".into())]);
}

/// Without another byte of the host the drive stops by itself.
#[test]
fn an_odrive_whose_host_is_gone_is_idle_after_its_watchdogs_time() {
    let (mut device, mut bus) = (commanded(), simulated(Firmware::Early));
    let ran = run(&mut device, 1.6, &mut bus, |_, _| {});
    assert_eq!(bus.node.state, 8);
    bus.node.advance(ran.end_s + 0.19);
    assert_eq!(bus.node.state, 8);
    bus.node.advance(ran.end_s + 0.21);
    assert_eq!((bus.node.state, bus.node.error), (1, 0x800));
}

/// The limit of speed is the drive's own where it has one for torques, and this program's in any case.
#[test]
fn an_odrive_follows_torques_and_is_stopped_where_it_does_not_limit_its_speed() {
    let (mut device, mut bus) = (torques(0.04, false), simulated(Firmware::Late));
    let ran = run(&mut device, 8.0, &mut bus, |_, _| {});
    assert!(ran.heard.contains(&Heard::End { reason: None, by_operator: false }), "{}", ran.reason());
    let rows = ran.rows();
    // A current by 0.1 N m/A, measured as the command arrives.
    let worst =
        rows.windows(2).map(|pair| (0.1 * pair[1].values[2] - pair[0].values[8]).abs()).fold(0.0, f64::max);
    let top = rows.iter().map(|row| row.values[1].abs()).fold(0.0, f64::max);
    assert!(worst < 0.01 && (1.0..15.0).contains(&top), "{worst} {top}");
    assert_eq!(device.channels().last().unwrap().column_name(), "command_Nm");
    for is_torque_limited in [true, false] {
        let (mut device, mut bus) = (torques(0.1, true), simulated(Firmware::Late));
        bus.node.is_torque_limited = is_torque_limited;
        let mut fastest = 0_f64;
        let ran = run(&mut device, 8.0, &mut bus, |_, node| fastest = fastest.max(node.motor.speed_rad_s));
        if is_torque_limited {
            assert!(ran.reason.is_none() && (10.0..15.0).contains(&fastest), "{} {fastest}", ran.reason());
        } else {
            // Two periods of 0.1 N m on 4e-4 kg m2 beyond the limit.
            assert!(
                ran.reason().contains("beyond the limit of 15 rad/s") && fastest < 16.0,
                "{} {fastest}",
                ran.reason()
            );
        }
        assert_eq!((bus.node.state, bus.node.error), (1, 0));
    }
}

/// A host that is gone leaves a motor without torque after the watchdog's time.
#[test]
fn an_odrive_with_a_torque_is_idle_after_its_watchdogs_time() {
    let (mut device, mut bus) = (torques(0.04, false), simulated(Firmware::Late));
    let ran = run(&mut device, 1.6, &mut bus, |_, _| {});
    assert!(bus.node.state == 8 && bus.node.motor.torque_nm != 0.0);
    bus.node.advance(ran.end_s + 0.21);
    bus.node.advance(ran.end_s + 0.22);
    assert_eq!((bus.node.state, bus.node.motor.torque_nm), (1, 0.0));
}

#[test]
fn a_node_that_is_not_there_is_said_after_ten_seconds_with_those_that_are() {
    let mut bus = simulated(Firmware::Late);
    let ran = run(&mut odrive(5), 12.0, &mut bus, |_, _| {});
    assert!(
        ran.reason().contains("node 5 has said nothing for 10 s; frames like those of nodes 3 arrive"),
        "{}",
        ran.reason()
    );
    assert!(ran.rows().is_empty() && bus.node.commands == 0);
    assert!(OdriveCan::new(64, 1, Vec::new()).is_err());
}

/// Objects of a drive; the speed is in tenths of a revolution a minute.
const OBJECTS: &str = "schema = \"socam.canopen/1\"\n[channels.speed]\nsignal = \"606C:00 i32\"\nunit = \"rpm\"\nscale = 0.1\n\
    [channels.torque]\nsignal = \"6077:0 i16\"\nunit = \"N m\"\nscale = 0.002\n\
    [channels.position]\nsignal = \"6064:0 i32\"\nunit = \"counts\"\ncounts_per_turn = 4096\n\
    [channels.status]\nsignal = \"6041:0 u16\"\nunit = \"1\"\n";

fn canopen(node: u8, objects: &str) -> Canopen {
    let opening = opening(None, Access::Send).unwrap();
    Canopen::new(node, Objects::parse(objects).unwrap(), i64::from(PERIOD_US) * 2000, opening).unwrap()
}

fn turning() -> BusSimulator<CanopenSimulator> {
    BusSimulator::new(CanopenSimulator::new(5, Motor::turning(12.5, 0.25, 24.0)))
}

/// Only the objects whose names are given.
fn only(names: &[&str]) -> String {
    let tables = OBJECTS.split_inclusive("\n[").map(|table| table.strip_suffix('[').unwrap_or(table));
    let is_kept = |table: &&str| names.iter().any(|name| table.starts_with(&format!("channels.{name}")));
    let kept: String = tables.filter(is_kept).map(|table| format!("[{table}\n")).collect();
    format!("schema = \"socam.canopen/1\"\n{kept}")
}

#[test]
fn a_drive_with_canopen_is_read_by_sdo_and_by_its_own_pdos() {
    for pdo_s in [None, Some(0.002)] {
        let mut bus = turning();
        bus.node.pdo_s = pdo_s;
        let ran = run(&mut canopen(5, OBJECTS), 2.0, &mut bus, |time_s, node| {
            node.status = if time_s < 1.0 { 0x0237 } else { 0x0218 };
        });
        let rows = ran.rows();
        assert!((450..=500).contains(&rows.len()) && ran.damaged() == 0, "{pdo_s:?} {} {ran:?}", rows.len());
        for row in &rows[1..] {
            let time_s = row.arrival_ns as f64 * 1e-9;
            assert!((row.values[0] - 12.5).abs() < 0.006 && row.values[1] == 0.25, "{row:?}");
            assert!((row.values[2] - 12.5 * time_s).abs() < 0.02, "{time_s} {row:?}");
            assert!([f64::from(0x0237), f64::from(0x0218)].contains(&row.values[3]), "{row:?}");
        }
        let by =
            if pdo_s.is_some() { "by the PDOs 185; by SDO: 6077:00, 6064:00" } else { "by SDO: 606C:00" };
        let says =
            |text: &str| ran.heard.iter().any(|one| matches!(one, Heard::Talk(said) if said.contains(text)));
        assert!(says(by) && says("the node is operational") && says("the drive is enabled"), "{ran:?}");
        assert!(ran.heard.contains(&Heard::Fault("the drive is in a fault".into())));
        // Nothing is written: each frame is a question for an object.
        assert!(bus.sent.iter().all(|frame| frame.id == 0x605 && frame.bytes[0] == 0x40));
    }
}

#[test]
fn pdos_alone_give_rows_at_the_drives_rhythm_or_at_that_of_sync() {
    let mut bus = turning();
    bus.node.pdo_s = Some(0.001);
    let ran = run(&mut canopen(5, &only(&["speed", "status"])), 2.0, &mut bus, |_, _| {});
    assert!((1850..=2000).contains(&ran.rows().len()) && ran.damaged() == 0, "{}", ran.rows().len());

    let (mut bus, synced) = (turning(), only(&["torque"]).replacen('\n', "\nsync = true\n", 1));
    bus.node.follows_sync = true;
    let ran = run(&mut canopen(5, &synced), 2.0, &mut bus, |_, _| {});
    assert!((450..=500).contains(&ran.rows().len()) && ran.damaged() == 0, "{ran:?}");
    assert!(bus.sent.iter().all(|frame| frame.id == 0x80 || frame.bytes[0] == 0x40));
}

#[test]
fn a_list_that_is_not_the_drives_is_refused_by_its_line() {
    for (list, sentence) in [
        (
            OBJECTS.replace("606C:00 i32", "606C:00 i16"),
            "states 606C:00 with 4 bytes; line 2 of the list says 2",
        ),
        (
            OBJECTS.replace("6077:0", "6078:0"),
            "does not give 6078:00 (line 6 of the list): there is no such object",
        ),
    ] {
        let ran = run(&mut canopen(5, &list), 2.0, &mut turning(), |_, _| {});
        assert!(ran.reason().contains(sentence) && ran.rows().is_empty(), "{}", ran.reason());
    }
    let mut bus = turning();
    bus.node.pdo_s = Some(0.001);
    let ran = run(&mut canopen(5, &only(&["status"]).replace("u16", "u32")), 2.0, &mut bus, |_, _| {});
    assert!(ran.reason().contains("sends 6041:00 with 16 bits from bit 0 of a PDO"), "{}", ran.reason());
    for (list, sentence) in [
        (OBJECTS.replace("606C:00 i32", "606C i32"), "line 3: `signal` is \"606C i32\"; expected index"),
        (
            OBJECTS.replace("6077:0 i16", "606C:0 i32"),
            "line 6: `torque` has the object or the name of line 2",
        ),
        (OBJECTS.replace("\"rpm\"", "\"?\""), "not known yet"),
        ("schema = \"socam.canopen/1\"\n".into(), "it names no channel"),
    ] {
        let refused = Objects::parse(&list).unwrap_err().to_string();
        assert!(refused.contains(sentence), "{refused}");
    }
}

#[test]
fn a_drive_that_sends_no_pdo_or_is_not_there_is_said() {
    let mut bus = turning();
    (bus.node.pdo_s, bus.node.is_operational) = (Some(0.001), false);
    let ran = run(&mut canopen(5, &only(&["speed"])), 15.0, &mut bus, |_, _| {});
    assert!(
        ran.reason().contains("node 5 has given no row for 10 s: it is pre-operational and sends no PDO"),
        "{}",
        ran.reason()
    );
    let ran = run(&mut canopen(6, OBJECTS), 15.0, &mut turning(), |_, _| {});
    assert!(ran.reason().contains("node 6 does not answer") && ran.end_s < 2.0, "{}", ran.reason());
}

/// A list that allows commands.
fn marked() -> String {
    format!(
        "{OBJECTS}[commands]\nmay_be_written = true\nunit = \"rpm\"\nscale = 0.1\nlimits = [\"607F\", \"6072\"]\n"
    )
}

fn drive() -> BusSimulator<CanopenSimulator> {
    BusSimulator::new(CanopenSimulator::disabled(5, Motor::at_rest(Inertia::SMALL, 0.1)))
}

/// Follows a sine of 10 rad/s for 2 s, at an interval.
fn following(list: &str, period_us: u32) -> Commanded {
    let opening = opening(None, Access::Send).unwrap();
    let objects = Objects::parse(list).unwrap();
    let drive = CanopenDrive::new(5, objects, i64::from(period_us) * 1000, opening).unwrap();
    let limits = Limits { effort: 0.5, ..limits(Commands::Speeds) };
    Commanded::new(Box::new(drive), &sine(), period_us, limits).unwrap()
}

#[test]
fn a_drive_with_canopen_follows_a_profile_once_its_heartbeat_was_seen_to_be_missed() {
    let (mut device, mut bus) = (following(&marked(), 5000), drive());
    // The limit of torque is above its own, 0.4 N m, which stays.
    bus.node.set(0x6072, 0, 200);
    let mut kept = (0, 0, 0);
    let (mut was_enabled, mut was_tried) = (false, false);
    let ran = run(&mut device, 8.0, &mut bus, |_, node| {
        was_enabled |= node.status & 0x6f == 0x27;
        // Not enabled any more before it has turned at all.
        was_tried |= was_enabled && node.status & 0x6f == 0x40 && node.motor.angle_rad == 0.0;
        if node.motor.speed_rad_s.abs() > 5.0 {
            kept = (node.setting(0x607f, 0), node.setting(0x6072, 0), node.setting(0x1016, 1));
        }
    });
    assert_eq!(ran.reason, None, "{} {:?}", ran.end_s, ran.heard.last());
    assert!(ran.heard.contains(&Heard::End { reason: None, by_operator: false }) && was_tried);
    let rows = ran.rows();
    let top = rows.iter().map(|row| row.values[0]).fold(0.0, f64::max);
    let worst = rows.iter().map(|row| (row.values[0] - row.values[4]).abs()).fold(0.0, f64::max);
    assert!(top > 9.0 && worst < 3.0, "{top} {worst}");
    // 15 rad/s in tenths of a revolution a minute; node 127 and 0.2 s.
    assert_eq!(kept, (1432, 200, 127 << 16 | 200));
    // What it had before, but for the target.
    let settings = [(0x607f, 0), (0x6072, 0), (0x1016, 1), (0x6007, 0), (0x6060, 0), (0x60ff, 0)];
    assert_eq!(settings.map(|(index, sub)| bus.node.setting(index, sub)), [30_000, 200, 0, 1, 0, 0]);
    assert!(bus.node.status & 0x6f == 0x40, "{:x}", bus.node.status);
    // The reaction that the trial provoked is no fault of the drive.
    assert!(ran.damaged() == 0 && !ran.heard.iter().any(|heard| matches!(heard, Heard::Fault(_))));
    let commands = bus.sent.iter().filter(|frame| frame.id == 0x605 && frame.bytes[1..3] == [0xff, 0x60]);
    // 200 a second for 2.2 s, and what comes before and after.
    let count = commands.count();
    assert!((430..=460).contains(&count), "{count}");
}

#[test]
fn a_drive_with_canopen_that_does_not_keep_its_promises_is_not_commanded() {
    type Wrong = fn(&mut CanopenSimulator);
    let cases: [(Wrong, &str); 6] = [
        (|node| node.is_deaf = true, "still enabled 0.25 s after the last heartbeat of this computer"),
        (
            |node| node.ignores_limits = true,
            "was told 1432 in 607F:00 (its largest profile velocity) and states",
        ),
        (|node| node.set(0x1016, 1, 3 << 16 | 500), "waits for the heartbeat of node 3 already"),
        (|node| node.status = 0x0237, "the drive obeys another program already"),
        (|node| node.mishap = Some(Mishap::Fault(0x7305)), "error 7305 (603F); clear it first"),
        (|node| node.set(0x6072, 0, 0), "the limit in 6072:00 is 0"),
    ];
    for (wrong, sentence) in cases {
        let (mut device, mut bus) = (following(&marked(), 5000), drive());
        wrong(&mut bus.node);
        let ran = run(&mut device, 8.0, &mut bus, |_, _| {});
        assert!(ran.reason().contains(sentence), "{sentence}: {}", ran.reason());
        assert_eq!(bus.node.motor.angle_rad, 0.0, "{sentence}");
        let is_target = |frame: &&Frame| {
            frame.id == 0x605 && frame.bytes[..3] == [0x23, 0xff, 0x60] && frame.bytes[4..] != [0; 4]
        };
        assert!(!bus.sent.iter().any(|frame| is_target(&frame)), "{sentence}");
        if sentence.contains("still enabled") {
            assert!(bus.node.status & 0x6f == 0x40 && bus.node.setting(0x1016, 1) == 0, "{bus:?}");
        }
    }
}

#[test]
fn a_drive_with_canopen_that_is_moved_while_it_is_held_is_stopped() {
    let (mut device, mut bus) = (following(&marked(), 5000), drive());
    let ran = run(&mut device, 8.0, &mut bus, |_, node| {
        if node.status & 0x6f == 0x27 {
            node.motor.speed_rad_s = 4.0;
        }
    });
    assert!(ran.reason().contains("rad/s while it is held at 0"), "{}", ran.reason());
    assert_eq!(bus.node.status & 0x6f, 0x40);
}

#[test]
fn a_fault_a_runaway_or_a_second_master_ends_the_run_of_a_drive_with_canopen() {
    for (mishap, sentence) in [
        (Mishap::Fault(0x7305), "the drive is in a fault with error 7305 (603F)"),
        (Mishap::RunsAway, "beyond the limit of 15 rad/s"),
        (Mishap::Dies, "the drive has not answered for 0.2"),
        (Mishap::Freezes, "the drive has not answered for 0.2"),
    ] {
        let (mut device, mut bus) = (following(&marked(), 5000), drive());
        let mut fastest = 0_f64;
        let ran = run(&mut device, 12.0, &mut bus, |_, node| {
            if node.motor.speed_rad_s > 6.0 {
                node.mishap = Some(mishap);
            }
            fastest = fastest.max(node.motor.speed_rad_s);
        });
        assert!(ran.reason().contains(sentence), "{mishap:?}: {}", ran.reason());
        let word = |frame: &&Frame| frame.id == 0x605 && frame.bytes[..3] == [0x2b, 0x40, 0x60];
        let last = bus.sent.iter().rfind(word).unwrap();
        assert!([0, 2].contains(&last.bytes[4]), "{mishap:?} {last:?}");
        assert!(fastest < 17.0, "{mishap:?} {fastest}");
    }
    let (mut device, mut bus) = (following(&marked(), 5000), drive());
    let ran = run(&mut device, 8.0, &mut bus, |_, node| {
        node.refuses_targets = node.motor.speed_rad_s > 6.0;
    });
    assert!(ran.reason().contains("the drive does not take 60FF:00: "), "{}", ran.reason());
    assert!(bus.node.status & 0x6f == 0x40 && bus.node.motor.speed_rad_s.abs() < 1.0, "{bus:?}");
    for (id, bytes, sentence) in [
        (0x605, [0x2b, 0x40, 0x60, 0, 0x0f, 0, 0, 0], "another program on the bus commands this drive"),
        (0x77f, [5, 0, 0, 0, 0, 0, 0, 0], "another program on the bus sends the heartbeat of node 127"),
    ] {
        let (mut device, mut bus) = (following(&marked(), 5000), drive());
        let first = run(&mut device, 1.6, &mut bus, |_, _| {});
        assert!(first.rows().iter().any(|row| row.values[4] != 0.0), "{:?}", first.heard.last());
        let mut heard = Vec::new();
        let rival = bus.adapter.frame(1.6, id, &bytes);
        let until_ns = 1_600_500_000;
        device.receive(Chunk { bytes: &rival, from_ns: until_ns, until_ns }, &mut heard);
        assert!(matches!(&heard[..], [Heard::Fault(said)] if said.starts_with(sentence)), "{heard:?}");
    }
}

/// Without another byte of the host the drive brakes by itself.
#[test]
fn a_drive_with_canopen_whose_host_is_gone_is_at_rest_after_its_time() {
    let (mut device, mut bus) = (following(&marked(), 5000), drive());
    let ran = run(&mut device, 1.7, &mut bus, |_, _| {});
    assert!(bus.node.status & 0x6f == 0x27 && bus.node.motor.speed_rad_s.abs() > 1.0, "{bus:?}");
    for step in 1..=260 {
        bus.node.advance(ran.end_s + f64::from(step) * 1e-3);
        assert!(step > 190 || bus.node.status & 0x6f == 0x27, "{step}");
    }
    assert!(bus.node.status & 0x6f == 0x40 && bus.node.motor.speed_rad_s.abs() < 0.1, "{bus:?}");
}

#[test]
fn a_list_that_does_not_mark_commands_is_refused_by_what_it_lacks() {
    let opening = || opening(None, Access::Send).unwrap();
    for (list, sentence) in [
        (OBJECTS.to_owned(), "add a table [commands] with `may_be_written = true`"),
        (marked().replace("= true", "= false"), "add a table [commands] with `may_be_written = true`"),
        (marked().replace("6041:0", "6040:0"), "its statusword (6041): add those that are missing"),
        (marked().replace("6072", "6073"), "`limits` of the list of objects names 6073"),
        (
            marked() + "heartbeat_node = 5\n",
            "`heartbeat_node` of the list of objects is 5, which is the drive itself",
        ),
    ] {
        let refused = CanopenDrive::new(5, Objects::parse(&list).unwrap(), 5_000_000, opening()).unwrap_err();
        assert!(refused.to_string().contains(sentence), "{refused}");
    }
    for (list, sentence) in [
        (marked().replace("6072", "6071"), "`limits` holds \"6071\"; expected \"607F\""),
        (
            marked().replace("unit = \"rpm\"\nscale = 0.1\nlimits", "unit = \"Nm\"\nlimits"),
            "expected that of the target velocity",
        ),
        (marked().replace("scale = 0.1\nlimits", "scale = 0\nlimits"), "`scale` is 0"),
        (marked().replace("may_be", "might_be"), "may_be_written"),
    ] {
        let refused = Objects::parse(&list).unwrap_err().to_string();
        assert!(refused.contains(sentence), "{refused}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn any_frames_of_a_node_are_survived(frames in proptest::collection::vec((0_u32..32, proptest::collection::vec(any::<u8>(), 0..=8)), 0..40)) {
        let mut device = odrive(3);
        let (mut heard, mut out) = (Vec::new(), Vec::new());
        for (index, (number, bytes)) in frames.iter().enumerate() {
            let now_ns = index as i64 * 20_000_000;
            let _ = device.poll(now_ns, &mut out);
            let data: String = bytes.iter().map(|byte| format!("{byte:02X}")).collect();
            let line = format!("t{:03X}{}{data}\r", 3 << 5 | number, bytes.len());
            device.receive(Chunk { bytes: line.as_bytes(), from_ns: now_ns, until_ns: now_ns }, &mut heard);
        }
        for one in heard {
            if let Heard::Row(row) = one {
                prop_assert_eq!(row.values.len(), 8);
                prop_assert!(row.values[..5].iter().all(|value| value.is_finite()));
            }
        }
    }
}
