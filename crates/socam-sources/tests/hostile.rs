//! Devices that misbehave, against each protocol: nothing panics, no sample is wrong, memory is bounded, and what is wrong is said.
//!
//! Each device turns at an even speed, so that its position says when it was measured: a row must lie between its question and its answer.
//! `cargo test -p socam-sources --test hostile -- --nocapture` prints what was sent and said; `docs/devices.md` has it in short.

#![cfg(feature = "can")]

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard};

use cap::Cap;
use socam_import::CanSignals;
use socam_sources::can::canopen::{Canopen, Objects};
use socam_sources::can::odrive::OdriveCan;
use socam_sources::can::{Access, CanBus, opening, survey};
use socam_sources::dynamixel::Dynamixel;
use socam_sources::moteus::Moteus;
use socam_sources::odrive::Odrive;
use socam_sources::simulators::{
    BusSimulator, CanopenSimulator, DynamixelSimulator, Firmware, MoteusSimulator, Motor, OdriveCanSimulator,
    OdriveSimulator,
};
use socam_sources::text::{Bounds, TextDevice};
use socam_sources::{Chunk, Description, Device, Heard, Placed, Timeline};

#[global_allocator]
static MEMORY: Cap<std::alloc::System> = Cap::new(std::alloc::System, usize::MAX);
/// Memory is counted for the whole program, so that its tests run one after the other.
static ALONE: Mutex<()> = Mutex::new(());

const STEP_NS: i64 = 500_000;
const PERIOD_NS: i64 = 4_000_000;
const SPEED_RAD_S: f64 = 12.5;
/// Error of a time that a position states, ns: an encoder's step, and half a step of the simulation.
const EXACT_NS: f64 = 600_000.0;
/// When a device is hostile, steps.
const HOSTILE: std::ops::Range<i64> = 2000..4000;
const END: i64 = 7000;

fn alone() -> MutexGuard<'static, ()> {
    ALONE.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

type Answer = Box<dyn FnMut(f64, &[u8]) -> Vec<u8>>;

/// A device that is asked, with what answers it.
struct Rig {
    name: &'static str,
    device: Box<dyn Device>,
    answer: Answer,
    /// The channel of the position.
    position: usize,
    /// An answer with a number that is none, and one of another length whose checksum is right.
    bad: [Vec<u8>; 2],
}

fn line(text: &str) -> Vec<u8> {
    text.as_bytes().to_vec()
}

/// The packet of a Dynamixel whose parameters are one byte too few, and whose checksum is right.
fn short_packet() -> Vec<u8> {
    let mut packet = vec![0xff, 0xff, 0xfd, 0, 1, 24, 0, 0x55, 0];
    packet.extend([0; 20]);
    packet.extend(crc::Crc::<u16>::new(&crc::CRC_16_UMTS).checksum(&packet).to_le_bytes());
    packet
}

/// All devices that are asked, as the node of a number.
fn rigs(id: u8) -> Vec<Rig> {
    let motor = Motor::turning(SPEED_RAD_S, 0.25, 24.0);
    let mut moteus = MoteusSimulator::new(id, motor);
    let mut odrive = OdriveSimulator::new(Firmware::Late, motor);
    let mut dynamixel = DynamixelSimulator::new(id, 1020, motor);
    let mut odrive_can = BusSimulator::new(OdriveCanSimulator::new(id, Firmware::Late, motor));
    let mut canopen = BusSimulator::new(CanopenSimulator::new(id, motor));
    let objects = "schema = \"socam.canopen/1\"\n[channels.position]\nsignal = \"6064:00 i32\"\nunit = \"counts\"\n\
        counts_per_turn = 4096\n[channels.status]\nsignal = \"6041:00 u16\"\nunit = \"1\"\n";
    let open = |access| opening(Some(500_000), access).unwrap();
    let nan = format!("rcv {id:02X}00 21000A2D010000C07F2D0200000040 E B F\r\n");
    let node = u32::from(id);
    vec![
        Rig {
            name: "moteus",
            device: Box::new(Moteus::new(id, PERIOD_NS).unwrap()),
            answer: Box::new(move |time_s, bytes| moteus.receive(time_s, bytes)),
            position: 1,
            bad: [line(&nan), line(&format!("rcv {id:02X}00 21000A2D0100 E B F\r\n"))],
        },
        Rig {
            name: "ODrive, text",
            device: Box::new(Odrive::new(0, PERIOD_NS).unwrap()),
            answer: Box::new(move |time_s, bytes| odrive.receive(time_s, bytes)),
            position: 0,
            bad: [line("nan 1e999\r\n0\r\n24\r\n0\r\n"), line("1.5 2 3\r\n0\r\n24\r\n0\r\n")],
        },
        Rig {
            name: "Dynamixel",
            device: Box::new(Dynamixel::new(id, PERIOD_NS).unwrap()),
            answer: Box::new(move |time_s, bytes| dynamixel.receive(time_s, bytes)),
            position: 0,
            bad: [short_packet(), short_packet()],
        },
        Rig {
            name: "ODrive, CAN",
            device: Box::new(OdriveCan::new(id, PERIOD_NS, open(Access::Send)).unwrap()),
            answer: Box::new(move |time_s, bytes| odrive_can.receive(time_s, bytes)),
            position: 0,
            bad: [
                line(&format!("t{:03X}80000C07F0000C07F\r", node << 5 | 0x09)),
                line(&format!("t{:03X}70000C07F0000C0\r", node << 5 | 0x09)),
            ],
        },
        Rig {
            name: "CANopen",
            device: Box::new(
                Canopen::new(id, Objects::parse(objects).unwrap(), PERIOD_NS, open(Access::Send)).unwrap(),
            ),
            answer: Box::new(move |time_s, bytes| canopen.receive(time_s, bytes)),
            position: 0,
            bad: [
                line(&format!("t{:03X}84B646000FFFF0000\r", 0x580 + node)),
                line(&format!("t{:03X}743646000FFFFFF\r", 0x580 + node)),
            ],
        },
    ]
}

/// What a device does for a while.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Hostility {
    Noise,
    EndlessLine,
    Flood,
    Unasked,
    OtherNumber,
    Late,
    Cut,
    NoNumber,
    Length,
}

const ASKED: [(Hostility, &str); 9] = [
    (Hostility::Noise, "random bytes between answers"),
    (Hostility::EndlessLine, "a line that never ends"),
    (Hostility::Flood, "each answer 100 times"),
    (Hostility::Unasked, "answers to questions of another host"),
    (Hostility::OtherNumber, "answers of another drive"),
    (Hostility::Late, "answers 130 ms late"),
    (Hostility::Cut, "the link breaks within an answer"),
    (Hostility::NoNumber, "NaN or infinite numbers"),
    (Hostility::Length, "a right checksum around a wrong length"),
];

/// What was recorded of a device, and said.
#[derive(Debug, Default)]
struct Exposed {
    before: usize,
    during: usize,
    after: usize,
    damaged: usize,
    said: Vec<String>,
}

impl Exposed {
    fn take(&mut self, heard: &[Heard], step: i64) -> usize {
        let mut rows = 0;
        for one in heard {
            let said = match one {
                Heard::Row(_) => {
                    rows += 1;
                    continue;
                }
                Heard::Damaged(why) => {
                    self.damaged += 1;
                    (*why).to_owned()
                }
                Heard::Fault(text) => text.clone(),
                Heard::Talk(_) | Heard::End { .. } => continue,
            };
            if !self.said.contains(&said) {
                self.said.push(said);
            }
        }
        *match step {
            step if step < HOSTILE.start => &mut self.before,
            step if step < HOSTILE.end => &mut self.during,
            _ => &mut self.after,
        } += rows;
        rows
    }

    fn print(&self, device: &str, sent: &str) {
        let said = if self.said.is_empty() { "nothing".to_owned() } else { self.said.join("; ") };
        println!("| {device} | {sent} | {} | {said} |", self.during);
    }
}

/// A number that looks random.
fn random(seed: &mut u32) -> u32 {
    *seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    *seed >> 8
}

fn expose(rig: &mut Rig, hostility: Hostility, stranger: &mut Rig) -> Exposed {
    let (mut exposed, mut seed, mut asked) = (Exposed::default(), 1, Vec::new());
    let mut waiting: VecDeque<(i64, Vec<u8>)> = VecDeque::new();
    for step in 0..END {
        let (now_ns, is_hostile) = (1 + step * STEP_NS, HOSTILE.contains(&step));
        let time_s = now_ns as f64 * 1e-9;
        let mut question = Vec::new();
        rig.device.poll(now_ns, &mut question).unwrap();
        if question.len() > 2 {
            asked.clone_from(&question);
        }
        let mut bytes = (rig.answer)(time_s, &question);
        let mut heard = Vec::new();
        match hostility {
            _ if !is_hostile => {}
            Hostility::Noise => {
                bytes.splice(
                    0..0,
                    (0..random(&mut seed) % 40).map(|_| random(&mut seed) as u8).collect::<Vec<_>>(),
                );
            }
            Hostility::EndlessLine => bytes = vec![b'A'; 1 << 12],
            Hostility::Flood => bytes = bytes.repeat(100),
            Hostility::Unasked if random(&mut seed) % 3 == 0 => bytes.extend((rig.answer)(time_s, &asked)),
            Hostility::OtherNumber => {
                let mut question = Vec::new();
                stranger.device.poll(now_ns, &mut question).unwrap();
                // It turns the other way, so that a row of it is noticed.
                let theirs = (stranger.answer)(-time_s, &question);
                let chunk = Chunk { bytes: &theirs, from_ns: now_ns, until_ns: now_ns };
                stranger.device.receive(chunk, &mut Vec::new());
                bytes.splice(0..0, theirs);
            }
            Hostility::Late => waiting.push_back((now_ns + 130_000_000, std::mem::take(&mut bytes))),
            Hostility::Cut if step % 100 == 0 && !bytes.is_empty() => {
                let half = bytes.len() / 2;
                let chunk = Chunk { bytes: &bytes[..half], from_ns: now_ns, until_ns: now_ns };
                rig.device.receive(chunk, &mut heard);
                rig.device.interrupted(&mut heard);
                bytes.drain(..half);
            }
            Hostility::NoNumber if !bytes.is_empty() => bytes.clone_from(&rig.bad[0]),
            Hostility::Length if !bytes.is_empty() => bytes.clone_from(&rig.bad[1]),
            _ => {}
        }
        while waiting.front().is_some_and(|(due_ns, _)| *due_ns <= now_ns) {
            bytes.extend(waiting.pop_front().into_iter().flat_map(|(_, bytes)| bytes));
        }
        let chunk = Chunk { bytes: &bytes, from_ns: now_ns, until_ns: now_ns + STEP_NS / 2 };
        rig.device.receive(chunk, &mut heard);
        exposed.take(&heard, step);
        for one in &heard {
            let Heard::Row(row) = one else { continue };
            let measured_ns = row.values[rig.position] / SPEED_RAD_S * 1e9;
            let (from_ns, until_ns) = ((row.arrival_ns - row.spread_ns) as f64, row.arrival_ns as f64);
            assert!(
                measured_ns >= from_ns - EXACT_NS && measured_ns <= until_ns + EXACT_NS,
                "{} {hostility:?}: measured at {measured_ns}, stated {from_ns} to {until_ns}: {row:?}",
                rig.name
            );
        }
    }
    exposed
}

#[test]
fn devices_that_are_asked_record_no_wrong_sample_whatever_they_send() {
    let _alone = alone();
    println!("| device | sent | rows meanwhile | said |\n|---|---|---|---|");
    for (hostility, sent) in ASKED {
        for (mut rig, mut stranger) in rigs(1).into_iter().zip(rigs(2)) {
            // The protocol of text has no numbers of drives: its line is its number. Some drives send whole numbers only.
            let applies = match hostility {
                Hostility::OtherNumber => rig.name != "ODrive, text",
                Hostility::NoNumber => !["Dynamixel", "CANopen"].contains(&rig.name),
                _ => true,
            };
            if !applies {
                continue;
            }
            let exposed = expose(&mut rig, hostility, &mut stranger);
            exposed.print(rig.name, sent);
            let all = (HOSTILE.start * STEP_NS / PERIOD_NS) as usize;
            assert!(exposed.before > all * 8 / 10, "{} {hostility:?} {exposed:?}", rig.name);
            // It comes back when the device does.
            assert!(exposed.after > all, "{} {hostility:?} {exposed:?}", rig.name);
            // What is no packet of a Dynamixel is skipped up to the next header.
            // That a link broke is said by who reads it.
            let is_quiet = matches!(
                (hostility, rig.name),
                (Hostility::OtherNumber | Hostility::Flood | Hostility::Unasked | Hostility::Cut, _)
                    | (Hostility::Noise, "Dynamixel")
            );
            assert!(exposed.damaged > 0 || is_quiet, "{} {hostility:?} {exposed:?}", rig.name);
        }
    }
}

/// A device that sends by itself: lines with a clock and a number, frames with a checksum, or frames of a bus.
struct Talker {
    name: &'static str,
    device: Box<dyn Device>,
    timeline: Timeline,
    /// The bytes of a message: what its clock, us, and its number say, and its value.
    message: fn(i64, i64, f64) -> Vec<u8>,
}

const LINES: &str = "[lines]\nform = \"csv\"\nnames = [\"t\", \"n\", \"x\"]\n[clock]\nsignal = \"t\"\nunit = \"us\"\n\
    [number]\nsignal = \"n\"\n[channels.speed]\nsignal = \"x\"\nunit = \"rad/s\"\n";
const FRAMES: &str = "[lines]\nform = \"frames\"\nfields = [\"u32 t\", \"u32 n\", \"f32 x\"]\nchecksum = \"crc16\"\n\
    [clock]\nsignal = \"t\"\nunit = \"us\"\n[number]\nsignal = \"n\"\n[channels.speed]\nsignal = \"x\"\nunit = \"rad/s\"\n";
const DBC: &str =
    "VERSION \"\"\n\nBU_: A\n\nBO_ 257 Motor: 4 A\n SG_ speed : 0|32@1- (0.0001,0) [0|0] \"rad/s\" A\n";

fn frame(raw: &[u8]) -> Vec<u8> {
    let checksum = crc::Crc::<u16>::new(&crc::CRC_16_IBM_3740);
    let whole = [raw, &checksum.checksum(raw).to_le_bytes()].concat();
    let mut encoded = vec![0; whole.len() + 2];
    let length = cobs::try_encode(&whole, &mut encoded).unwrap();
    encoded.truncate(length);
    encoded.push(0);
    encoded
}

fn bus_line(time_us: i64, value: f64) -> Vec<u8> {
    let data: String =
        ((value * 1e4).round() as i32).to_le_bytes().iter().map(|byte| format!("{byte:02X}")).collect();
    line(&format!("t1014{data}{:08X}\r", time_us as u32))
}

fn talkers() -> Vec<Talker> {
    let text = |name, description, message| {
        let device = TextDevice::new(Description::parse(description).unwrap(), Bounds::Connected);
        let timeline = Timeline::new(device.numbering(), device.clock_wrap_s());
        Talker { name, device: Box::new(device), timeline, message }
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bus.dbc");
    std::fs::write(&path, DBC).unwrap();
    let heard: Vec<u8> = (0..100).flat_map(|k| bus_line(2000 * k, 1.0)).collect();
    let chunk = Chunk { bytes: &heard, from_ns: 0, until_ns: 200_000_000 };
    let found = survey(&[chunk], Arc::new(CanSignals::open(&path).unwrap())).unwrap();
    let bus = CanBus::new(found, Vec::new());
    let timeline = Timeline::new(bus.numbering(), None);
    vec![
        text("lines of text", LINES, |time_us, number, value| {
            line(&format!("{time_us},{number},{value:.6}\n"))
        }),
        text("frames (COBS)", FRAMES, |time_us, number, value| {
            let (time, number) = ((time_us as u32).to_le_bytes(), (number as u32).to_le_bytes());
            frame(&[&time[..], &number, &(value as f32).to_le_bytes()].concat())
        }),
        Talker {
            name: "CAN bus with DBC",
            device: Box::new(bus),
            timeline,
            message: |time_us, _, value| bus_line(time_us, value),
        },
    ]
}

/// What a device that sends by itself does for a while.
const SENT: [&str; 10] = [
    "random bytes between messages",
    "a line that never ends",
    "each message 100 times",
    "a clock that jumps back 10 s",
    "a clock that jumps ahead 1 h",
    "a clock that stands still",
    "a number that counts back again and again",
    "NaN or infinite numbers",
    "the link breaks within a message",
    "a right checksum around a wrong length",
];

/// The bytes of a step for a kind of [`SENT`].
fn hostile(kind: usize, talker: &mut Talker, step: i64, seed: &mut u32, heard: &mut Vec<Heard>) -> Vec<u8> {
    let (time_us, number, value) = (step * 1000, step, 0.004 * step as f64);
    let mut bytes = (talker.message)(time_us, number, value);
    match kind {
        0 => bytes
            .splice(0..0, (0..random(seed) % 20).map(|_| random(seed) as u8).collect::<Vec<_>>())
            .for_each(drop),
        1 => bytes = vec![b'A'; 1 << 12],
        2 => bytes = bytes.repeat(100),
        3 => bytes = (talker.message)(time_us - 10_000_000 + 60_000_000, number, value),
        4 => bytes = (talker.message)(time_us + 3_600_000_000, number, value),
        5 => bytes = (talker.message)(HOSTILE.start * 1000, number, value),
        6 => bytes = (talker.message)(time_us, HOSTILE.start + number % 10, value),
        7 if talker.name == "lines of text" => bytes = line(&format!("{time_us},{number},1e999\n")),
        7 if talker.name == "frames (COBS)" => bytes = (talker.message)(time_us, number, f64::NAN),
        8 if step % 50 == 0 => {
            let half = bytes.len() / 2;
            let now_ns = step * 1_000_000;
            let chunk = Chunk { bytes: &bytes[..half], from_ns: now_ns, until_ns: now_ns };
            talker.device.receive(chunk, heard);
            talker.device.interrupted(heard);
            bytes.drain(..half);
        }
        9 => {
            bytes = match talker.name {
                "lines of text" => line(&format!("{time_us},{number},{value},7\n")),
                "frames (COBS)" => frame(&[0; 13]),
                _ => line(&format!("t1013000000{:08X}\r", time_us as u32)),
            }
        }
        _ => {}
    }
    bytes
}

#[test]
fn devices_that_send_by_themselves_record_no_wrong_sample_whatever_they_send() {
    let _alone = alone();
    println!("| device | sent | rows meanwhile | said |\n|---|---|---|---|");
    for (kind, sent) in SENT.iter().enumerate() {
        for mut talker in talkers() {
            // Frames of a bus have no number, and whole numbers.
            if talker.name == "CAN bus with DBC" && [6, 7].contains(&kind) {
                continue;
            }
            let (mut exposed, mut seed, mut last_ns) = (Exposed::default(), 7, -1);
            for step in 0..END {
                let (now_ns, mut heard) = (step * 1_000_000, Vec::new());
                let bytes = if HOSTILE.contains(&step) {
                    hostile(kind, &mut talker, step, &mut seed, &mut heard)
                } else {
                    (talker.message)(step * 1000, step, 0.004 * step as f64)
                };
                let chunk = Chunk { bytes: &bytes, from_ns: now_ns, until_ns: now_ns };
                talker.device.receive(chunk, &mut heard);
                let mut placed = Vec::new();
                for one in heard {
                    match &one {
                        Heard::Row(row) => {
                            let Placed::At { time_ns, .. } = talker.timeline.place(row) else { continue };
                            assert!(time_ns > last_ns, "{} {sent}: {time_ns} after {last_ns}", talker.name);
                            last_ns = time_ns;
                            // The speed says when it was measured.
                            let at_ns = row.values[0] / 4.0 * 1e9;
                            let is_right =
                                row.values[0].is_nan() || (at_ns - row.arrival_ns as f64).abs() < 2e6;
                            assert!(is_right, "{} {sent}: {row:?}", talker.name);
                        }
                        Heard::Damaged(_) => talker.timeline.damaged(),
                        _ => {}
                    }
                    placed.push(one);
                }
                exposed.take(&placed, step);
            }
            let counts = talker.timeline.counts();
            for (count, what) in [
                (counts.repeated, "repeated"),
                (counts.late, "late"),
                (counts.jumps, "jumps of the clock or number"),
            ] {
                if count > 0 {
                    exposed.said.push(format!("{count} {what}"));
                }
            }
            exposed.print(talker.name, sent);
            assert!(exposed.before > 1900 && exposed.after > 2900, "{} {sent} {exposed:?}", talker.name);
        }
    }
}

/// A hundred megabytes of nonsense leave nothing behind.
#[test]
fn memory_is_bounded_whatever_arrives() {
    let _alone = alone();
    let mut devices: Vec<(&str, Box<dyn Device>)> =
        rigs(1).into_iter().map(|rig| (rig.name, rig.device)).collect();
    devices.extend(talkers().into_iter().map(|talker| (talker.name, talker.device)));
    let mut seed = 3;
    let noise: Vec<u8> = (0..1 << 16).map(|_| random(&mut seed) as u8).collect();
    let floods: [Vec<u8>; 4] = [
        vec![b'A'; 1 << 16],
        noise,
        b"t0291AA\rt5851AA\rT1FFFFFFF0\r".repeat(1 << 11),
        b"1.5\r\n".repeat(1 << 13),
    ];
    for (name, device) in &mut devices {
        for flood in &floods {
            let before = MEMORY.allocated();
            for round in 0..48_i64 {
                let mut heard = Vec::new();
                let now_ns = round * 1_000_000;
                device.receive(Chunk { bytes: flood, from_ns: now_ns, until_ns: now_ns }, &mut heard);
            }
            let grown = MEMORY.allocated().saturating_sub(before);
            assert!(grown < 1 << 18, "{name} keeps {grown} bytes");
        }
    }
}
