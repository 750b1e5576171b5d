//! Devices that are asked: each turns at an even speed, so that its position says when it was measured.

use std::collections::VecDeque;

use socam_sources::can::canopen::{Canopen, Objects};
use socam_sources::can::odrive::OdriveCan;
use socam_sources::can::{Access, opening};
use socam_sources::moteus::Moteus;
use socam_sources::odrive::Odrive;
use socam_sources::simulators::{
    BusSimulator, CanopenSimulator, DynamixelSimulator, FeetechSimulator, Firmware, MoteusSimulator, Motor,
    OdriveCanSimulator, OdriveSimulator,
};
use socam_sources::{Chunk, Device, Heard};
use socam_sources::{dynamixel, feetech};

use crate::{END, Exposed, HOSTILE, alone, line, random};

const STEP_NS: i64 = 500_000;
const PERIOD_NS: i64 = 4_000_000;
const SPEED_RAD_S: f64 = 12.5;
/// Error of a time that a position states, ns: an encoder's step, and half a step of the simulation.
const EXACT_NS: f64 = 600_000.0;

type Answer = Box<dyn FnMut(f64, &[u8]) -> Vec<u8>>;

/// A device that is asked, with what answers it.
pub(crate) struct Rig {
    pub(crate) name: &'static str,
    pub(crate) device: Box<dyn Device>,
    answer: Answer,
    /// The channel of the position.
    position: usize,
    /// An answer with a number that is none, and one of another length whose checksum is right.
    bad: [Vec<u8>; 2],
}

/// The packet of a Feetech whose parameters are one byte too few, and whose checksum is right.
fn short_feetech() -> Vec<u8> {
    let mut packet = vec![0xff, 0xff, 1, 16, 0];
    packet.extend([0; 14]);
    let sum = packet[2..].iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
    packet.push(!sum);
    packet
}

/// The packet of a Dynamixel whose parameters are one byte too few, and whose checksum is right.
fn short_packet() -> Vec<u8> {
    let mut packet = vec![0xff, 0xff, 0xfd, 0, 1, 24, 0, 0x55, 0];
    packet.extend([0; 20]);
    packet.extend(crc::Crc::<u16>::new(&crc::CRC_16_UMTS).checksum(&packet).to_le_bytes());
    packet
}

/// All devices that are asked, as the node of a number.
pub(crate) fn rigs(id: u8) -> Vec<Rig> {
    let motor = Motor::turning(SPEED_RAD_S, 0.25, 24.0);
    let mut moteus = MoteusSimulator::new(id, motor);
    let mut odrive = OdriveSimulator::new(Firmware::Late, motor);
    let mut dynamixel = DynamixelSimulator::new(id, 1020, motor);
    let mut feetech = FeetechSimulator::new(id, motor);
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
            device: Box::new(dynamixel::servos(&[id], PERIOD_NS).unwrap()),
            answer: Box::new(move |time_s, bytes| dynamixel.receive(time_s, bytes)),
            position: 0,
            bad: [short_packet(), short_packet()],
        },
        Rig {
            name: "Feetech",
            device: Box::new(feetech::servos(&[id], PERIOD_NS).unwrap()),
            answer: Box::new(move |time_s, bytes| feetech.receive(time_s, bytes)),
            position: 0,
            bad: [short_feetech(), short_feetech()],
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
            Hostility::Unasked if random(&mut seed).is_multiple_of(3) => {
                bytes.extend((rig.answer)(time_s, &asked))
            }
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
            let (from_ns, until_ns) = ((row.arrival_ns - row.spread_ns) as f64, row.arrival_ns as f64);
            let mut measured_ns = row.values[rig.position] / SPEED_RAD_S * 1e9;
            if rig.name == "Feetech" {
                // It counts a single turn.
                let turn_ns = std::f64::consts::TAU / SPEED_RAD_S * 1e9;
                measured_ns += turn_ns * ((until_ns - measured_ns) / turn_ns).round();
            }
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
                Hostility::NoNumber => !["Dynamixel", "Feetech", "CANopen"].contains(&rig.name),
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
            // What is no packet of a servo is skipped up to the next header.
            // That a link broke is said by who reads it.
            let is_quiet = matches!(
                (hostility, rig.name),
                (Hostility::OtherNumber | Hostility::Flood | Hostility::Unasked | Hostility::Cut, _)
                    | (Hostility::Noise, "Dynamixel" | "Feetech")
            );
            assert!(exposed.damaged > 0 || is_quiet, "{} {hostility:?} {exposed:?}", rig.name);
        }
    }
}
