//! Devices that send by themselves: each states a speed that rises evenly, and so says when it was measured.

use std::sync::Arc;

use socam_import::CanSignals;
use socam_sources::can::{CanBus, survey};
use socam_sources::text::{Bounds, TextDevice};
use socam_sources::{Chunk, Description, Device, Heard, Placed, Timeline};

use crate::{END, Exposed, HOSTILE, alone, line, random};

/// A device that sends by itself: lines with a clock and a number, frames with a checksum, or frames of a bus.
pub(crate) struct Talker {
    pub(crate) name: &'static str,
    pub(crate) device: Box<dyn Device>,
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

pub(crate) fn talkers() -> Vec<Talker> {
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
