//! Devices that misbehave, against each protocol: nothing panics, no sample is wrong, memory is bounded, and what is wrong is said.
//!
//! Each device turns at an even speed, so that its position says when it was measured: a row must lie between its question and its answer.
//! `cargo test -p socam-sources --test hostile -- --nocapture` prints what was sent and said; `docs/devices.md` has it in short.

#![cfg(feature = "can")]

mod asked;
mod talking;

use std::sync::{Mutex, MutexGuard};

use cap::Cap;
use socam_sources::{Chunk, Device, Heard};

#[global_allocator]
static MEMORY: Cap<std::alloc::System> = Cap::new(std::alloc::System, usize::MAX);
/// Memory is counted for the whole program, so that its tests run one after the other.
static ALONE: Mutex<()> = Mutex::new(());

/// When a device is hostile, steps.
const HOSTILE: std::ops::Range<i64> = 2000..4000;
const END: i64 = 7000;

fn alone() -> MutexGuard<'static, ()> {
    ALONE.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

fn line(text: &str) -> Vec<u8> {
    text.as_bytes().to_vec()
}

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

/// A hundred megabytes of nonsense leave nothing behind.
#[test]
fn memory_is_bounded_whatever_arrives() {
    let _alone = alone();
    let mut devices: Vec<(&str, Box<dyn Device>)> =
        asked::rigs(1).into_iter().map(|rig| (rig.name, rig.device)).collect();
    devices.extend(talking::talkers().into_iter().map(|talker| (talker.name, talker.device)));
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
