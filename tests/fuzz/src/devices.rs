//! What devices other than the own board send.

use std::path::Path;
use std::sync::Arc;

use socam_import::CanSignals;
use socam_sources::can::canopen::{Canopen, Objects};
use socam_sources::can::odrive::OdriveCan;
use socam_sources::can::{CanBus, Gateway, survey};
use socam_sources::moteus::Moteus;
use socam_sources::odrive::Odrive;
use socam_sources::simulators::{DynamixelSimulator, FeetechSimulator, Motor};
use socam_sources::text::{Bounds, TextDevice, probe};
use socam_sources::{Chunk, Description, Device, Heard, dynamixel, feetech};

use crate::Input;

/// Frames of two numbers with a checksum.
const FRAMES: &str = "[lines]\nform = \"frames\"\nfields = [\"u16 n\", \"f32 torque\"]\nchecksum = \"crc16\"\n\
    [channels.torque]\nsignal = \"torque\"\nunit = \"N m\"\n";

/// The bits of the rows of a device, whose bytes arrive in pieces of a size.
fn rows(mut device: impl Device, bytes: &[u8], size: usize) -> Vec<Vec<u64>> {
    let (mut heard, mut now_ns) = (Vec::new(), 0);
    let width = device.channels().len();
    for bytes in bytes.chunks(size.max(1)) {
        device.receive(Chunk { bytes, from_ns: now_ns, until_ns: now_ns + 1000 }, &mut heard);
        now_ns += 1000;
    }
    device.interrupted(&mut heard);
    let rows = heard.into_iter().filter_map(|one| if let Heard::Row(row) = one { Some(row) } else { None });
    let rows: Vec<Vec<u64>> =
        rows.map(|row| row.values.iter().map(|value| value.to_bits()).collect()).collect();
    assert!(rows.iter().all(|row| row.len() == width), "values of a row");
    rows
}

/// Rows do not depend on how their bytes arrive. Says whether there is one.
fn is_heard<D: Device>(bytes: &[u8], device: impl Fn() -> D) -> bool {
    let whole = rows(device(), bytes, bytes.len());
    assert_eq!(whole, rows(device(), bytes, 7), "rows of whole and of divided bytes");
    !whole.is_empty()
}

/// Lines of text, of which the form is found first.
pub(crate) fn lines(input: Input<'_>) -> bool {
    let bytes = input.bytes;
    let chunk = Chunk { bytes, from_ns: 0, until_ns: 1_500_000_000 };
    let Ok(found) = probe(&[chunk], Bounds::Ends, true) else { return false };
    let Ok(description) = found.description() else { return false };
    is_heard(bytes, || TextDevice::new(description.clone(), Bounds::Ends))
}

/// Frames of bytes by a description.
pub(crate) fn frames(input: Input<'_>) -> bool {
    let Ok(description) = Description::parse(FRAMES) else { return false };
    is_heard(input.bytes, || TextDevice::new(description.clone(), Bounds::Ends))
}

/// Answers of a moteus, of an ODrive, and of servos, which are asked between them.
pub(crate) fn drives(input: Input<'_>) -> bool {
    let (Ok(moteus), Ok(odrive)) = (Moteus::new(1, 1), Odrive::new(0, 1)) else { return false };
    let (Ok(dynamixels), Ok(feetechs)) = (dynamixel::servos(&[1, 2], 1), feetech::servos(&[1, 2], 1)) else {
        return false;
    };
    let (bytes, end) = (input.bytes, b'\n');
    let drives = is_answered(moteus, bytes, end) | is_answered(odrive, bytes, end);
    drives | is_answered(dynamixels, bytes, end) | is_answered(feetechs, bytes, end)
}

/// Frames of an adapter of CAN, by the DBC of the other parsers.
pub(crate) fn slcan(input: Input<'_>) -> bool {
    let dbc = input.path.with_extension("dbc");
    if !dbc.exists() && std::fs::write(&dbc, crate::seeds::DBC).is_err() {
        return false;
    }
    let Ok(signals) = CanSignals::open(&dbc) else { return false };
    let (signals, bytes) = (Arc::new(signals), input.bytes);
    let chunk = Chunk { bytes, from_ns: 0, until_ns: 1_500_000_000 };
    let found = || survey(&[chunk], signals.clone());
    if found().is_err() {
        return false;
    }
    let bus = || CanBus::new(found().expect("what was found once"), Vec::new());
    let _ = rows(bus(), bytes, 7);
    !rows(bus(), bytes, bytes.len()).is_empty()
}

/// Objects of a drive with CANopen.
const OBJECTS: &str = "schema = \"socam.canopen/1\"\n[channels.speed]\nsignal = \"606C:00 i32\"\nunit = \"rpm\"\n\
    [channels.torque]\nsignal = \"6077:00 f32\"\nunit = \"N m\"\n[channels.status]\nsignal = \"6041:00 u16\"\nunit = \"1\"\n";

/// Frames of an ODrive and of a drive with CANopen, which are asked between them; and the same bytes as commands to a gateway.
pub(crate) fn can_drives(input: Input<'_>) -> bool {
    let Ok(objects) = Objects::parse(OBJECTS) else { return false };
    let (Ok(odrive), Ok(canopen)) =
        (OdriveCan::new(1, 1, Vec::new()), Canopen::new(1, objects, 1, Vec::new()))
    else {
        return false;
    };
    let mut gateway = Gateway::default();
    gateway.take(b"O\r");
    let _ = gateway.take(input.bytes);
    is_answered(odrive, input.bytes, b'\r') | is_answered(canopen, input.bytes, b'\r')
}

/// Polls a device before each line with this end; says whether there is a row. Numbers of its rows are finite or missing.
fn is_answered(mut device: impl Device, bytes: &[u8], end: u8) -> bool {
    let (mut heard, mut out, mut now_ns) = (Vec::new(), Vec::new(), 1);
    let width = device.channels().len();
    for bytes in bytes.split_inclusive(|byte| *byte == end) {
        if device.poll(now_ns, &mut out).is_err() {
            break;
        }
        out.clear();
        device.receive(Chunk { bytes, from_ns: now_ns, until_ns: now_ns + 1000 }, &mut heard);
        now_ns += 10_000_000;
    }
    device.interrupted(&mut heard);
    let rows = heard.into_iter().filter_map(|one| if let Heard::Row(row) = one { Some(row) } else { None });
    let rows: Vec<_> = rows.collect();
    let is_right = |value: &f64| !value.is_infinite();
    assert!(rows.iter().all(|row| row.values.len() == width && row.values.iter().all(is_right)), "values");
    !rows.is_empty()
}

pub(crate) fn can_drive_seeds(_: &Path) -> Vec<Vec<u8>> {
    let answers =
        "t02180000000001000000\rt02980000803F00000040\rt03480000000000008040\rt03780000C0410000003F\r";
    // The firmware is asked for first.
    let odrive = "\r".repeat(20) + &answers.repeat(3);
    let value = |place: &str, bytes: &str| format!("t5818{place}{bytes}\r");
    let abort = |number: u8| value(&format!("80{number:02X}1801"), "00000206");
    let torque = value("43776000", "0000803F");
    let canopen = "\r".to_owned()
        + &value("43001801", "81010000")
        + &value("4F001A00", "02000000")
        + &value("43001A01", "10004160")
        + &value("43001A02", "20006C60")
        + &(1..8).map(abort).collect::<String>()
        + &torque
        + &format!("t181637020A000000\r{torque}").repeat(4);
    vec![odrive.into_bytes(), canopen.into_bytes()]
}

/// A list of objects.
pub(crate) fn objects(input: Input<'_>) -> bool {
    let Ok(text) = std::str::from_utf8(input.bytes) else { return false };
    Objects::parse(text).is_ok_and(|objects| !objects.channels().is_empty())
}

pub(crate) fn object_seeds(_: &Path) -> Vec<Vec<u8>> {
    vec![OBJECTS.as_bytes().to_vec(), format!("{OBJECTS}wrap = 65536\n").into_bytes()]
}

pub(crate) fn slcan_seeds(_: &Path) -> Vec<Vec<u8>> {
    let frame = |k: u32| format!("t1018{k:02X}00010203040506{:04X}\rF00\r", 2 * k);
    vec![
        (0..40).map(frame).collect::<String>().into_bytes(),
        (0..20).map(|k| format!("t1018{k:02X}00010203040506\r")).collect::<String>().into_bytes(),
    ]
}

pub(crate) fn line_seeds(_: &Path) -> Vec<Vec<u8>> {
    let rows = |row: &dyn Fn(u32) -> String| (0..40).map(row).collect::<String>().into_bytes();
    vec![
        rows(&|k| format!("{},{k},{}.5,0.25\n", 2000 * k, k)),
        rows(&|k| format!("t_us:{},speed_rad_s:{k}\r\n", 2000 * k)),
        rows(&|k| format!("{{\"timestamp\":{},\"motor\":{{\"speed_rpm\":{k}}}}}\n", 0.002 * f64::from(k))),
    ]
}

pub(crate) fn frame_seeds(_: &Path) -> Vec<Vec<u8>> {
    let checksum = crc::Crc::<u16>::new(&crc::CRC_16_IBM_3740);
    let frame = |number: u16| {
        let mut raw = number.to_le_bytes().to_vec();
        raw.extend(0.25_f32.to_le_bytes());
        raw.extend(checksum.checksum(&raw).to_le_bytes());
        let mut encoded = vec![0; raw.len() + 2];
        let length = cobs::try_encode(&raw, &mut encoded).unwrap_or_default();
        encoded.truncate(length);
        encoded.push(0);
        encoded
    };
    // The first frame may have begun before.
    vec![std::iter::once(0).chain((0..8).flat_map(frame)).collect()]
}

pub(crate) fn drive_seeds(_: &Path) -> Vec<Vec<u8>> {
    let motor = Motor::turning(2.0, 0.25, 12.0);
    let (mut first, mut second) =
        (DynamixelSimulator::new(1, 1020, motor), DynamixelSimulator::new(2, 1060, motor));
    let dynamixels = dynamixel::servos(&[1, 2], 1).map(|device| {
        answers(device, |time_s, bytes| {
            [first.receive(time_s, bytes), second.receive(time_s, bytes)].concat()
        })
    });
    let (mut first, mut second) = (FeetechSimulator::new(1, motor), FeetechSimulator::new(2, motor));
    let feetechs = feetech::servos(&[1, 2], 1).map(|device| {
        answers(device, |time_s, bytes| {
            [first.receive(time_s, bytes), second.receive(time_s, bytes)].concat()
        })
    });
    let mut seeds: Vec<Vec<u8>> = dynamixels.into_iter().chain(feetechs).collect();
    seeds.extend([
        b"OK\r\nrcv 0100 21000A2D0100004841 2D0200000040 E B F\r\nrcv 0100 23000A0102 E B F\r\nrcv 0100 21000A2D01000048412D0200000040210F00 E B F\r\n".to_vec(),
        b"1.5 2.0\r\n0.25\r\n24.0\r\n0\r\n1.6 2.0\r\ninvalid property\r\n24.0\r\n2048\r\n".to_vec(),
    ]);
    seeds
}

/// What a bus answers to some questions.
fn answers(mut device: impl Device, mut bus: impl FnMut(f64, &[u8]) -> Vec<u8>) -> Vec<u8> {
    let (mut all, mut heard) = (Vec::new(), Vec::new());
    for turn in 0..10_i64 {
        let (now_ns, mut question) = (turn * 1_000_000, Vec::new());
        if device.poll(now_ns, &mut question).is_err() {
            return all;
        }
        let bytes = bus(now_ns as f64 * 1e-9, &question);
        device.receive(Chunk { bytes: &bytes, from_ns: now_ns, until_ns: now_ns }, &mut heard);
        all.extend(bytes);
    }
    all
}
